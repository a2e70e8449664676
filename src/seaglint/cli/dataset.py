"""The command ``seaglint dataset``: labelled pictures of an ensemble, for training and testing detectors."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from seaglint.base.errors import DataError
from seaglint.cli.terminal.derived_help import derived_help, listed
from seaglint.cli.terminal.messages import log
from seaglint.cli.terminal.options import Overwrite, ProgressOption
from seaglint.cli.terminal.progress import ProgressMode
from seaglint.cli.terminal.workers import DaskOption, DaskSlurmOption, WorkersOption

MOST_LISTED = 20
"""Lines of what is wrong with a data set, of which more are only counted."""


def _formats() -> str:
    """Return the names of the formats with their remarks: ``coco, yolo, sirst, or zarr: the scenes' stores as they are``."""
    from seaglint.files.dataset import FORMATS

    return listed(tuple(f"{form.name}: {form.note}" if form.note else form.name for form in FORMATS))


def _bits() -> str:
    """Return the bits of a pixel that each format has by default: ``16 for coco, 8 for yolo and sirst``."""
    from seaglint.files.dataset import FORMATS

    names: dict[int, tuple[str, ...]] = {}
    for form in FORMATS:
        if form.pictures:
            names[form.bits] = (*names.get(form.bits, ()), form.name)
    return ", ".join(f"{bits} for {listed(those, 'and')}" for bits, those in names.items())


Command = derived_help(formats=_formats, bits=_bits)


def dataset(
    source: Annotated[
        Path, typer.Argument(metavar="ENSEMBLE.toml", help="ensemble file, or the folder of a rendered one; with --check a data set")
    ],
    output: Annotated[Path | None, typer.Option("-o", "--output", metavar="DIR", help="folder to make")] = None,
    form: Annotated[str, typer.Option("--format", help="{formats}")] = "coco",
    bits: Annotated[int | None, typer.Option("--bits", help="8 or 16 bits of a pixel; {bits}")] = None,
    image: Annotated[str | None, typer.Option("--image", help="png or tiff; png where nothing is said")] = None,
    workers: WorkersOption = None,
    dask: DaskOption = None,
    dask_slurm: DaskSlurmOption = None,
    threads: Annotated[
        int | None, typer.Option("--threads", min=1, help="processor threads of each process; all where nothing is said")
    ] = None,
    resume: Annotated[bool, typer.Option("--resume", help="go on with an unfinished data set")] = False,
    overwrite: Overwrite = False,
    check: Annotated[bool, typer.Option("--check", help="check a data set that is there, and make none")] = False,
    show: ProgressOption = ProgressMode.AUTO,
) -> None:
    """Render labelled pictures of an ensemble: masks, boxes, tables.

    With a data card that says what is in them; 'seaglint dataset --check DIR' checks a data set that is there.
    """
    if check:
        _check(source)
        return
    if output is None:
        raise DataError("-o is missing: the folder of the data set; give one, e.g. -o data")
    from seaglint.cli.terminal.logs import show_logs
    from seaglint.cli.terminal.progress import progress
    from seaglint.cli.terminal.workers import chosen
    from seaglint.files.dataset.check import read_about
    from seaglint.studies.ensemble.ensemble_dataset import ensemble_dataset, read_source
    from seaglint.studies.ensemble.scenes_to_dataset import DatasetOptions, require_output

    show_logs(quiet=show is ProgressMode.NONE)
    options = DatasetOptions.of(form, bits, image)
    output = Path(str(output).rstrip("/\\"))
    require_output(output, resume=resume, overwrite=overwrite)
    loaded = read_source(source)
    with chosen(workers, dask, dask_slurm, threads=threads) as hands, progress(show, "scenes") as report:
        ensemble_dataset(
            loaded,
            output,
            options,
            workers=hands,
            threads=threads,
            resume=resume,
            overwrite=overwrite,
            progress=report,
        )
    statistics = read_about(output)["statistics"]
    images, objects = (sum(statistics[name].values()) for name in ("images", "annotated_objects"))
    log(f"{output}: {images} images with {objects} annotated objects, checked; {output / 'README.md'} says what is in it")


def _check(folder: Path) -> None:
    """Say what is wrong with a data set, and leave with 2 where something is."""
    from seaglint.files.dataset.check import problems

    faults = list(problems(folder))
    for line in faults[:MOST_LISTED]:
        log(f"seaglint: {folder}: {line}")
    if len(faults) > MOST_LISTED:
        log(f"seaglint: {folder}: and {len(faults) - MOST_LISTED} more")
    if faults:
        raise typer.Exit(2)
    log(f"{folder}: is whole: files, checksums, pictures, boxes, masks and splits")
