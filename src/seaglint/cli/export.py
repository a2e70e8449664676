"""Commands that write files for other programs: ``seaglint export``, ``export-sea`` and ``labels``.

They export a run, the sea at one instant, and the truth of a sequence's objects.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer

from seaglint.cli.terminal.messages import files_read, log, naming_file
from seaglint.cli.terminal.options import Overwrite, ProgressOption, ScenarioArgument, parse_frames
from seaglint.cli.terminal.program import derived_help, listed, only_numpy
from seaglint.cli.terminal.progress import ProgressMode, patient_progress
from seaglint.cli.terminal.record_options import takes_records
from seaglint.studies.study_requests import ExportRequest


def _endings() -> str:
    """Return the endings of all files that can be written, with remarks; second endings of a format's files are left out."""
    from seaglint.formats.export import FORMATS
    from seaglint.plot.video_formats import VIDEO_ENDINGS

    numbers = (f"{ending} ({form.note})" if form.note else ending for form in FORMATS for ending in form.endings)
    return listed((*numbers, *VIDEO_ENDINGS))


def _videos() -> str:
    from seaglint.plot.video_formats import VIDEO_ENDINGS

    return listed(VIDEO_ENDINGS, "and")


Command = derived_help(endings=_endings, videos=_videos)


@takes_records(order="run output")
def export(
    run: Annotated[Path, typer.Argument(metavar="RUN.zarr", help="finished sequence of 'seaglint render'")],
    output: Annotated[Path, typer.Option("-o", "--output", help="file to write: {endings}")],
    request: ExportRequest,
    show: ProgressOption = ProgressMode.AUTO,
) -> None:
    """Write frames of a run for another program."""
    from seaglint.formats.export.stack import held_frames
    from seaglint.plot.run_export import export_run
    from seaglint.store.sequence_store import open_sequence

    only_numpy()
    with open_sequence(run) as dataset:
        numbers = parse_frames(request.frames, held_frames(dataset), steps=True)
        with patient_progress(show, "frames") as report:
            written = export_run(dataset, output, **vars(replace(request, frames=numbers)), progress=report)
    log(written.line)


def export_sea(
    scenario: ScenarioArgument,
    output: Annotated[Path, typer.Option("-o", "--output", help="file to write: .ply a triangle mesh, .nc NetCDF")],
    time: Annotated[float, typer.Option("--time", help="seconds from the start of the sequence")] = 0.0,
    extent: Annotated[
        tuple[float, float] | None,
        typer.Option("--extent", metavar="EAST NORTH", help="size of the patch in metres; 256 256, less where waves are very short"),
    ] = None,
    spacing: Annotated[
        float | None, typer.Option("--spacing", help="distance of its points in metres; a quarter of the shortest wave")
    ] = None,
    centre: Annotated[
        tuple[float, float], typer.Option("--centre", metavar="EAST NORTH", help="middle of the patch in metres from the sensor's foot")
    ] = (0.0, 0.0),
    lattices: Annotated[bool, typer.Option("--lattices/--no-lattices", help="with the periodic tiles beside the patch (.nc)")] = True,
    overwrite: Overwrite = False,
) -> None:
    """Write heights, slopes and roughness of the sea at one time."""
    from seaglint.scenario.load import load_scenario
    from seaglint.store.outputs import refuse_existing
    from seaglint.studies.sequence.sea_export import export_sea as export
    from seaglint.studies.sequence.sea_export import require_sea_name, write_sea

    require_sea_name(output)
    loaded = load_scenario(scenario)
    refuse_existing(output, overwrite=overwrite, inputs=files_read(scenario, loaded))
    with naming_file(scenario, loaded):
        sea = export(loaded, time, centre=centre, extent=extent, spacing=spacing)
    rows, columns = sea.patch.shape
    write_sea(sea, output, lattices=lattices, overwrite=overwrite)
    log(f"{output} written: {columns} x {rows} points every {sea.patch.spacing:.4g} m")
    finest = sea.tiles[-1].spacing
    if sea.patch.spacing > 2.0 * finest:
        log(f"{output}: points are {sea.patch.spacing:.4g} m apart, waves down to {4.0 * finest:.4g} m are sampled, not smoothed")


def labels(
    run: Annotated[Path, typer.Argument(metavar="RUN.zarr", help="finished sequence of 'seaglint render' with objects")],
    output: Annotated[Path, typer.Option("-o", "--output", help="file to write: .json (COCO) or .csv")],
    masks: Annotated[str, typer.Option(help="response: of an object after the optics; geometric: pixels that it touches")] = "response",
    overwrite: Overwrite = False,
) -> None:
    """Write places, masks and contrasts of objects, by frame.

    'seaglint labels run.zarr -o labels.csv' writes a row for each object and frame, 'seaglint labels run.zarr -o labels.json' COCO's
    annotations with masks, boxes and track numbers.
    """
    from seaglint.formats.object_labels import Labels, report_never_seen, require_labels_name, write_labels
    from seaglint.store.outputs import refuse_existing

    refuse_existing(require_labels_name(output), overwrite=overwrite, inputs=[run])
    truth = Labels.of(run, masks)
    report_never_seen(truth)
    write_labels(truth, output, overwrite=overwrite)
    log(f"{output} written: {len(truth.names)} object{'s' * (len(truth.names) != 1)} in {len(truth.frames)} frames")
    if truth.masks != masks:
        log("its masks are geometric: the sequence was rendered without [sensor.optics] and [sensor.detector]")
    if output.suffix.lower() == ".json":
        log("its images have no file_name, as no pictures are written (id is the frame's number); 'seaglint dataset' writes them")
