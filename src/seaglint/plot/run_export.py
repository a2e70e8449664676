"""A run in the format of a file's ending: numbers by :mod:`seaglint.files.export`, moving pictures by :mod:`seaglint.plot.video`."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, get_args

from seaglint.base.conventions import Progress
from seaglint.base.errors import DataError
from seaglint.base.optional import missing
from seaglint.files.export import endings
from seaglint.files.export.encoding import Kind as NumberKind
from seaglint.files.export.encoding import check_limits
from seaglint.files.export.stack import Exported, Stack, select
from seaglint.files.export.stack_writing import write_stack
from seaglint.files.outputs import refuse_existing
from seaglint.plot import video
from seaglint.plot.scale import Kind as ScaleKind
from seaglint.plot.video_formats import VIDEO_ENDINGS, video_format

if TYPE_CHECKING:
    import xarray as xr


def export_run(
    dataset: xr.Dataset,
    output: str | Path,
    *,
    variable: str | None = None,
    frames: range | None = None,
    dtype: NumberKind | None = None,
    limits: tuple[float, float] | None = None,
    colours: video.Colours | None = None,
    rate: float | None = None,
    scale: ScaleKind | None = None,
    overwrite: bool = False,
    progress: Progress | None = None,
) -> Exported:
    """Write frames of a run, one in memory at a time.

    Parameters
    ----------
    dataset : xarray.Dataset
        A run, opened lazily.
    output : path
        File to write; its ending is the format: one of :func:`seaglint.files.export.endings` or of a video.
    variable, frames
        As in :func:`seaglint.files.export.stack.select`.
    dtype, limits
        As for :func:`seaglint.files.export.stack_writing.write_stack`;
        ``limits`` are also the ends of a video's scale, which is then linear.
    colours, rate, scale
        As in :func:`seaglint.plot.video.write_video`.
    overwrite : bool
        Replace what is there.
    progress : callable, optional
        ``progress(done, total)``.

    Raises
    ------
    DataError
        An ending, choice or combination that cannot be; an output that exists, or lies inside the run.
    BackendError
        A library that is not installed.
    StorageError
        No room or no rights; nothing is left behind.
    """
    output = Path(output)
    ending = output.suffix.lower()
    allowed = (*endings(), *VIDEO_ENDINGS)
    if ending not in allowed:
        raise DataError(f"{output}: the ending says what is written; allowed are {', '.join(allowed)}")
    shows = ending in VIDEO_ENDINGS
    _require_unused(output, {"dtype": dtype} if shows else {"colours": colours, "rate": rate, "scale": scale}, shows=shows)
    source = str(dataset.encoding.get("source", "dataset"))
    if Path(source).resolve() in output.resolve().parents:
        raise DataError(f"{output}: lies inside the run {source}; choose another place")
    stack = select(dataset, variable, frames, source=source)
    if not shows:
        return write_stack(stack, output, dtype=dtype, limits=limits, overwrite=overwrite, progress=progress)
    return _show(stack, output, limits, colours or "white-hot", rate, scale, overwrite, progress)


def _require_unused(output: Path, choices: Mapping[str, Any], *, shows: bool) -> None:
    given = [name for name, value in choices.items() if value is not None]
    if given:
        kind = "shows levels of brightness" if shows else "holds numbers"
        others = ", ".join(endings() if shows else VIDEO_ENDINGS)
        raise DataError(f"{output}: {output.suffix} {kind} and takes no `{given[0]}`; leave it out, or choose {others}")


def _show(
    stack: Stack,
    output: Path,
    limits: tuple[float, float] | None,
    colours: video.Colours,
    rate: float | None,
    scale: ScaleKind | None,
    overwrite: bool,
    progress: Progress | None,
) -> Exported:
    if colours not in get_args(video.Colours):
        raise DataError(f"map = {colours!r}; allowed are {', '.join(get_args(video.Colours))}")
    if scale is not None and scale not in get_args(ScaleKind):
        raise DataError(f"scale = {scale!r}; allowed are {', '.join(get_args(ScaleKind))}")
    if limits is not None:
        limits = check_limits(limits)
        if scale == "log":
            raise DataError("range gives the ends of a linear scale, and scale = 'log' chooses its own; give one of the two")
    low, high = video_format(output.suffix.lower()).rates
    if rate is not None and not low <= rate <= high:
        raise DataError(
            f"fps = {rate:g} is outside {low:g}-{high:g}, the frames per second that {output.suffix} holds; give a rate within them"
        )
    if not video.video_available():
        raise missing(f"{output}: a video", "av")
    refuse_existing(output, overwrite=overwrite)
    shown = rate or video.shown_rate(stack.dataset, stack.variable, output.suffix.lower())
    video.write_video(
        stack.dataset, output, scale or "auto", variable=stack.variable, colours=colours, limits=limits, rate=shown, progress=progress
    )
    own = stack.frame_rate
    other = f" (the run has {own:g})" if own is not None and abs(shown / own - 1.0) > 1e-3 else ""
    return Exported((output,), stack.variable, stack.units, stack.shape, f"{colours} pictures, {shown:g} per second{other}")
