"""The command ``seaglint render``."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from seaglint.base.errors import DataError
from seaglint.base.optional import remedy
from seaglint.cli.sensor import SensorPreset
from seaglint.cli.sensor import line as counts_line
from seaglint.cli.terminal.messages import files_read, log, naming_file, print_air, show_logs
from seaglint.cli.terminal.options import PreviewScale, ScaleOption, ShardOption, parse_frames, place_given, refuse_preview
from seaglint.cli.terminal.program import only_numpy
from seaglint.cli.terminal.progress import ProgressMode, progress
from seaglint.cli.terminal.record_options import RunOptions, finish_store, report_share, require_one_way, takes_records
from seaglint.studies.study_requests import RenderRequest

if TYPE_CHECKING:
    from seaglint.store.writers import Share

RenderedFile = Annotated[
    str, typer.Argument(metavar="SCENARIO.toml", help="scenario file; 'seaglint init my.toml' writes one (with --finish alone: the store)")
]


@takes_records(order="scenario output frames threads resume overwrite preview scale show sensor electrons radiance workers dask dask_slurm")
def render(
    scenario: RenderedFile,
    request: RenderRequest,
    run: RunOptions,
    output: Annotated[
        str | None, typer.Option("-o", "--output", help="Zarr store to write: run.zarr, or a URL like s3://bucket/run.zarr")
    ] = None,
    preview: Annotated[bool, typer.Option("--preview", help="write a picture and a video beside the store")] = False,
    scale: ScaleOption = PreviewScale.AUTO,
    sensor: SensorPreset = None,
    shard: ShardOption = None,
    finish: Annotated[
        bool, typer.Option("--finish", help="check that all frames of a store are there, and name it: --finish RUN.zarr")
    ] = False,
) -> None:
    """Render the sequence: radiance, or counts of a detector.

    Radiance is at the aperture; where the scenario has a detector, frames are its counts. Any frame alone is the same as in the sequence.
    """
    from seaglint.scenario.load import load_scenario
    from seaglint.store.sequence_store import check_output
    from seaglint.store.writers import Share

    show_logs(quiet=run.show is ProgressMode.NONE)
    if finish:
        only_numpy()
        require_one_way(shard=shard, overwrite=request.overwrite)
        if preview:
            _local_store(place_given(output or scenario), None)  # before anything is done
        finished = finish_store(scenario, output, sensor)
        if preview:
            _preview(finished, scale)
        return
    if output is None:
        raise typer.BadParameter("Missing option '-o' / '--output'.")
    share = None if shard is None else Share.parse(shard)
    file = Path(scenario)
    loaded = load_scenario(file, sensor=sensor)
    numbers = parse_frames(request.frames, loaded.sensor.frames)
    store = place_given(output)
    inputs = files_read(file, loaded)
    check_output(store, resume=request.resume, overwrite=request.overwrite, inputs=inputs, share=share)
    local_store = _local_store(store, share) if preview else None
    from seaglint.base.kernel_plan import start_helpers

    start_helpers("render")  # before the other imports, which take seconds: the helpers compile meanwhile
    only_numpy()
    pictures = None if local_store is None else _Pictures(local_store, inputs, replace=request.overwrite or request.resume)
    render_sequence: Callable[..., Path | str]
    if loaded.sensor.senses or request.electrons or request.radiance:
        from seaglint.studies.sequence.sensed_sequence import render as render_counts

        render_sequence = partial(render_counts, electrons=request.electrons, radiance=request.radiance)
    else:
        from seaglint.studies.sequence.render_sequence import render as render_radiance

        render_sequence = render_radiance
    with naming_file(file, loaded), run.chosen() as workers, progress(run.show, "frames") as report:
        if run.show is not ProgressMode.NONE:
            print_air(loaded)
        more: dict[str, Any] = {"share": share} if share is not None else {}
        more |= {"workers": workers} if workers is not None else {}
        # Workers have their threads from their own options.
        alone = None if workers is not None else request.threads
        more |= {"resume": request.resume, "overwrite": request.overwrite}
        render_sequence(loaded, store, frames=numbers, threads=alone, progress=report, **more)
    if share is not None:
        report_share(store, share)
        return
    from seaglint.store.sequence_store import open_sequence
    from seaglint.store.stored_images import summarise

    with open_sequence(store) as dataset:
        if pictures is not None:
            pictures.write(dataset, scale)
        log(f"{store}: {summarise(dataset).line}")
        if "signal" in dataset:
            log(f"{store}: {counts_line(dataset)}")


def _preview(store: Path | str, scale: PreviewScale) -> None:
    """Write pictures of a finished store; older pictures are replaced, as with --resume."""
    from seaglint.store.sequence_store import open_sequence

    with open_sequence(store) as dataset:
        _Pictures(_local_store(store, None), [], replace=True).write(dataset, scale)


def _local_store(store: Path | str, share: Share | None) -> Path:
    """Return the local store beside which pictures are written; refuse shares and URLs."""
    if share is not None:
        raise DataError("--preview shows a whole sequence and --shard makes a part; leave --preview out, and give it with --finish")
    if not isinstance(store, Path):
        raise DataError(f"--preview writes pictures beside a folder, and {store} is none; leave it out")
    return store


class _Pictures:
    """Previews beside a store; existing files are refused before the work begins."""

    def __init__(self, output: Path, inputs: list[Path], *, replace: bool) -> None:
        from seaglint.plot.video import video_available

        self.picture, self.video = output.with_suffix(".png"), output.with_suffix(".mp4")
        self.with_video = video_available()
        refuse_preview(self.picture, replace, inputs)
        if self.with_video:
            refuse_preview(self.video, replace, inputs)
        else:
            log(f"no {self.video}: PyAV is not installed; {remedy('av')} adds it")

    def write(self, dataset: Any, scale: PreviewScale) -> None:
        """Write the picture, and the video where there is more than one frame and PyAV is installed."""
        from seaglint.plot.preview import write_picture
        from seaglint.plot.video import write_video

        write_picture(dataset, self.picture, scale.value)
        log(f"{self.picture} written")
        if dataset.sizes["time"] == 1:
            self.video.unlink(missing_ok=True)  # of an older sequence, which this one replaces
        elif self.with_video:
            write_video(dataset, self.video, scale.value, remedy="make room and run the same command with --resume")
            log(f"{self.video} written")
