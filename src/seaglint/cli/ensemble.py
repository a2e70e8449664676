"""The commands ``seaglint ensemble``, and ``seaglint dataset`` for labelled pictures of an ensemble, to train and test detectors."""

from __future__ import annotations

from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from seaglint.base.errors import DataError
from seaglint.cli.terminal.messages import log
from seaglint.cli.terminal.program import derived_help, listed
from seaglint.cli.terminal.progress import ProgressMode
from seaglint.cli.terminal.record_options import RunOptions, takes_records
from seaglint.studies.ensemble.ensemble_requests import DatasetRequest, EnsembleRequest

if TYPE_CHECKING:
    from seaglint.scenario.ensemble_file import Ensemble


@takes_records(order="source output workers dask dask_slurm threads resume overwrite draw_only sea_draws show")
def ensemble(
    source: Annotated[Path, typer.Argument(metavar="ENSEMBLE.toml", help="file with a base scenario and laws for its keys")],
    output: Annotated[Path, typer.Option("-o", "--output", metavar="DIR", help="folder for scenes and tables")],
    request: EnsembleRequest,
    run: RunOptions,
) -> None:
    """Draw scenes from laws of a scenario's keys and render each."""
    from seaglint.cli.terminal.messages import show_logs
    from seaglint.cli.terminal.progress import progress
    from seaglint.scenario.ensemble_file import load_ensemble
    from seaglint.studies.ensemble.ensemble_folder import Folder
    from seaglint.studies.ensemble.render_ensemble import render_ensemble

    show_logs(quiet=run.show is ProgressMode.NONE)
    loaded = load_ensemble(source)
    # The folder is checked before the cost is measured, which takes seconds.
    if not (request.resume or request.draw_only):
        Folder(output).check(resume=False, overwrite=request.overwrite)
        tell_cost(loaded, run)
    # With drawn seas a scene counts twice: when it is rendered, and when its interval is known.
    counted = "scenes" if request.sea_draws is None or request.draw_only else "scenes and their drawn seas"
    with run.chosen() as team, progress(run.show, counted) as report:
        render_ensemble(
            loaded,
            output,
            workers=team,
            threads=request.threads,
            resume=request.resume,
            overwrite=request.overwrite,
            draw_only=request.draw_only,
            sea_draws=request.sea_draws,
            progress=report,
        )
    count = loaded.ensemble.scenes
    drawn = f"drawn; render them with --resume, or one with: seaglint render {output}/scenes/0000.toml"
    outcome = drawn if request.draw_only else "rendered"
    log(f"{output}: {count} scene{'s' if count > 1 else ''} {outcome}; what was drawn is in {output / 'parameters.csv'}")
    if request.sea_draws is not None:
        log(widest_line(output))


def widest_line(folder: Path) -> str:
    """Return the interval 'sea unknown' of the scene in which the standard deviation of glint is least known, in plain words."""
    from seaglint.formats.weather.weather_cells import read_cells
    from seaglint.studies.mean.field_numbers import FIELD_NUMBERS
    from seaglint.studies.sea_draws import COUNT, HIGH, LOW, sea_line

    name, table = FIELD_NUMBERS[-1], folder / "sea_unknown.csv"
    cells = read_cells(table)
    rows = [i for i, text in enumerate(cells.text(name)) if text]
    if not rows:
        return f"{table}: no scene has sea in view"
    low, high = ([float(cells.text(f"{name}_{end}")[i]) for i in rows] for end in (LOW, HIGH))
    k = max(range(len(rows)), key=lambda i: high[i] / max(low[i], 1e-300))
    scene, value = cells.text("scene")[rows[k]], float(cells.text(name)[rows[k]])
    line = sea_line(low[k], high[k], int(cells.text(COUNT)[rows[k]]), unit="W m-2 sr-1", value=value)
    return f"{table} written; widest in scene {scene}, standard deviation of glint {value:.4g} W m-2 sr-1; {line}"


def tell_cost(loaded: Ensemble, run: RunOptions) -> None:
    """Print the expected cost of many scenes before they start; nothing for few scenes, or for a cluster."""
    from seaglint.base.representation import duration, size_text
    from seaglint.studies.ensemble.render_ensemble import MANY, expected_cost, scenes

    count = loaded.ensemble.scenes
    if count < MANY or run.show is ProgressMode.NONE or run.dask is not None or run.dask_slurm is not None:
        return
    first, second = (scene.scenario for scene in islice(scenes(loaded), 2))
    columns, rows = first.sensor.pixels
    cost = expected_cost(first, second, count)
    log(
        f"{count} scenes of {first.sensor.frames} x {columns} x {rows} pixels: about {duration(cost.seconds)} on this machine and at most "
        f"{size_text(cost.size)} of counts or radiance, judged by a frame of the first"
    )


MOST_LISTED = 20  #: Largest number of faults of a data set that are printed; more are counted.


def _formats() -> str:
    """Return the names of the formats with their remarks: ``coco, yolo, sirst, or zarr: ...``."""
    from seaglint.formats.dataset import FORMATS

    return listed(tuple(f"{form.name}: {form.note}" if form.note else form.name for form in FORMATS))


Command = derived_help(formats=_formats)


@takes_records(
    order="source output format bits image scale limits clip masks min_snr workers dask dask_slurm threads resume overwrite check show"
)
def dataset(
    source: Annotated[
        Path, typer.Argument(metavar="ENSEMBLE.toml", help="ensemble file, or the folder of a rendered one; with --check a data set")
    ],
    request: DatasetRequest,
    run: RunOptions,
    output: Annotated[Path | None, typer.Option("-o", "--output", metavar="DIR", help="folder to make")] = None,
    check: Annotated[bool, typer.Option("--check", help="check a data set that is there, and make none")] = False,
) -> None:
    """Render labelled pictures of an ensemble: masks, boxes, tables.

    With a data card that says what is in them; 'seaglint dataset --check DIR' checks a data set that is there.
    """
    if check:
        _check(source)
        return
    if output is None:
        raise DataError("-o is missing: the folder of the data set; give one, e.g. -o data")
    from seaglint.cli.terminal.messages import show_logs
    from seaglint.cli.terminal.progress import progress
    from seaglint.formats.dataset.dataset_writing import read_about
    from seaglint.studies.ensemble.ensemble_dataset import ensemble_dataset, read_source, require_output

    show_logs(quiet=run.show is ProgressMode.NONE)
    options = request.options()
    output = Path(str(output).rstrip("/\\"))
    require_output(output, resume=request.resume, overwrite=request.overwrite)
    loaded = read_source(source)
    if loaded.folder is None and not request.resume:
        tell_cost(loaded.ensemble, run)
    with run.chosen() as team, progress(run.show, "scenes") as report:
        ensemble_dataset(
            loaded,
            output,
            options,
            workers=team,
            threads=request.threads,
            resume=request.resume,
            overwrite=request.overwrite,
            progress=report,
        )
    about = read_about(output)
    statistics = about["statistics"]
    images, objects = (sum(statistics[name].values()) for name in ("images", "annotated_objects"))
    ignored = sum(statistics["ignored_objects"].values())
    if ignored:
        least = f"{about['min_snr']:g}"
        log(f"{output}: {ignored} of {objects} annotated objects have a signal-to-noise ratio below {least} and are marked ignore")
    log(f"{output}: {images} images with {objects} annotated objects, checked; {output / 'README.md'} says what is in it")


def _check(folder: Path) -> None:
    """Print the faults of a data set, and leave with 2 if it has any."""
    from seaglint.formats.dataset.dataset_writing import problems

    faults = list(problems(folder))
    for line in faults[:MOST_LISTED]:
        log(f"seaglint: {folder}: {line}")
    if len(faults) > MOST_LISTED:
        log(f"seaglint: {folder}: and {len(faults) - MOST_LISTED} more")
    if faults:
        raise typer.Exit(2)
    log(f"{folder}: is whole: files, checksums, pictures, boxes, masks and splits")
