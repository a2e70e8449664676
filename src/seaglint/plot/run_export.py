"""Export of a run in the format that belongs to the ending of a file.

``seaglint.formats.export`` writes numbers, ``seaglint.plot.video`` moving pictures. Numbers are written as stored, in single
precision, or as counts.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Any, get_args

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import Progress
from seaglint.base.errors import DataError
from seaglint.base.optional import missing
from seaglint.formats.export import endings, format_of
from seaglint.formats.export.file_formats import write_header
from seaglint.formats.export.stack import Counts, Exported, Kind, NumberFormat, Stack, check_limits, select
from seaglint.formats.export.stack import Kind as NumberKind
from seaglint.formats.recording.arrays import TYPES
from seaglint.plot import video
from seaglint.plot.scale import Kind as ScaleKind
from seaglint.plot.video_formats import VIDEO_ENDINGS, video_format
from seaglint.store.outputs import moved_when_whole, refuse_existing

if TYPE_CHECKING:
    import xarray as xr


def write_stack(
    stack: Stack,
    output: str | Path,
    *,
    dtype: Kind | None = None,
    limits: tuple[float, float] | None = None,
    overwrite: bool = False,
    progress: Progress | None = None,
) -> Exported:
    """Write images in the format of the output's ending, one frame in memory at a time.

    Parameters
    ----------
    stack : Stack
        The images.
    output : path
        File to write, with one of the endings of ``seaglint.formats.export.endings``.
    dtype : {"uint16", "float32"}, optional
        Type of the numbers; the type of the run by default. Counts of 16 bits stay unchanged, other values become
        ``Counts``.
    limits : (float, float), optional
        Range of these counts; by default the range of the values, for which all frames are read a second time.
    overwrite : bool
        Replace an existing file.
    progress : callable, optional
        ``progress(done, total)``.

    Raises
    ------
    DataError
        The ending, the type or the range is not allowed, or the output exists.
    BackendError
        A library is not installed.
    StorageError
        No room or no rights; nothing is left behind.
    """
    output = Path(output)
    form = format_of(output.suffix.lower())
    if form is None:
        raise DataError(f"{output}: the ending selects the format; allowed are {', '.join(endings())}")
    if dtype is not None and dtype not in get_args(Kind):
        raise DataError(f"dtype = {dtype!r}; allowed are {', '.join(get_args(Kind))}")
    scaled = dtype == "uint16" and stack.dtype != np.uint16
    if limits is not None:
        limits = check_limits(limits)
        if not scaled:
            raise DataError(
                "`limits` are the ends of counts made of other values; give them with dtype = 'uint16' and values of another type"
            )
    if dtype is None and stack.dtype.name not in TYPES:
        raise DataError(f"{stack.variable} is {stack.dtype}, which not all formats hold; give dtype = 'float32' or 'uint16'")
    form.require()
    header = form.header_path(output)
    files = (output,) if header is None else (output, header)
    for file in files:
        refuse_existing(file, overwrite=overwrite)
    total = stack.shape[0]
    # The range of the values is known only after a first pass over all frames.
    passes = 2 if scaled and limits is None else 1
    done = 0

    def images() -> Iterator[NDArray[Any]]:
        nonlocal done
        for position in range(total):
            yield stack[position]
            done += 1
            if progress is not None:
                progress(done, passes * total)

    if progress is not None:
        progress(0, passes * total)
    counts = Counts.over(*(limits or _range(images()))) if scaled else None
    numbers = form.stored(NumberFormat(np.dtype(dtype) if dtype is not None else stack.dtype, counts), stack)
    cut = 0

    def encoded() -> Iterator[NDArray[Any]]:
        nonlocal cut
        for image in images():
            cut += counts.beyond(image) if counts is not None else 0
            yield numbers.of(image)

    with ExitStack() as held:
        # The header gets its final name last: a file with a header is complete.
        partials = [held.enter_context(moved_when_whole(file)) for file in reversed(files)][::-1]
        for partial in partials:
            partial.unlink(missing_ok=True)  # left by a process that was killed
        if len(partials) > 1:
            write_header(partials[1], stack, numbers)
        form.write(partials[0], stack, numbers, encoded())
    scale, offset = (None, None) if counts is None else (counts.scale, counts.offset)
    return Exported(files, stack.variable, stack.units, stack.shape, numbers.dtype.name, scale, offset, cut)


def _range(images: Iterable[NDArray[Any]]) -> tuple[float, float]:
    """Return the smallest and the largest finite value; 0 and 0 without finite values."""
    low, high = np.inf, -np.inf
    for image in images:
        finite = image[np.isfinite(image)]
        if finite.size:
            low, high = min(low, float(finite.min())), max(high, float(finite.max()))
    return (low, high) if low <= high else (0.0, 0.0)


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
        File to write; its ending is the format: one of ``seaglint.formats.export.endings`` or of a video.
    variable, frames
        As in ``seaglint.formats.export.stack.select``.
    dtype, limits
        As for ``seaglint.plot.run_export.write_stack``;
        ``limits`` are also the ends of a video's scale, which is then linear.
    colours, rate, scale
        As in ``seaglint.plot.video.write_video``.
    overwrite : bool
        Replace an existing file.
    progress : callable, optional
        ``progress(done, total)``.

    Raises
    ------
    DataError
        The ending, a choice or a combination is not allowed; the output exists, or lies inside the run.
    BackendError
        A library is not installed.
    StorageError
        No room or no rights; nothing is left behind.
    """
    output = Path(output)
    ending = output.suffix.lower()
    allowed = (*endings(), *VIDEO_ENDINGS)
    if ending not in allowed:
        raise DataError(f"{output}: the ending selects the format; allowed are {', '.join(allowed)}")
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
    # A rate that differs by more than rounding is reported beside the rate of the run.
    own = stack.frame_rate
    other = f" (the run has {own:g})" if own is not None and abs(shown / own - 1.0) > 1e-3 else ""
    return Exported((output,), stack.variable, stack.units, stack.shape, f"{colours} pictures, {shown:g} per second{other}")
