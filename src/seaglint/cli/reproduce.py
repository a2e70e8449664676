"""Commands ``seaglint reproduce ...``: results of the source article, and measured spectra, computed again."""

from __future__ import annotations

from collections.abc import Sequence
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from seaglint.base.optional import remedy
from seaglint.cli.terminal.messages import log, print_json, print_lines, show_logs, table
from seaglint.cli.terminal.options import AsJson, Overwrite, ProgressOption, parse_frames
from seaglint.cli.terminal.progress import ProgressMode, progress

reproduce = typer.Typer(help="Results of the source article, and measured spectra.", no_args_is_help=True)

Folder = Annotated[Path, typer.Option("-o", "--output", metavar="DIR", help="folder for the picture and the numbers; the current one")]


class SpectroscopyChoice(StrEnum):
    """Absorptions of the air to compare."""

    LBLRTM = "lblrtm"
    LOWTRAN7 = "lowtran7"
    BOTH = "both"


@reproduce.command()
def headline(as_json: AsJson = False) -> None:
    """Headline numbers of the article beside ours."""
    from seaglint.studies.article.headline import headline as rows

    computed = rows()
    if as_json:
        print_json({name: row.as_dict() for name, row in computed.items()})
        return

    print_lines(table(computed))


@reproduce.command()
def fig2(output: Folder = Path(), overwrite: Overwrite = False, show: ProgressOption = ProgressMode.AUTO) -> None:
    """Path and boundary properties against range and wind.

    Writes DIR/fig2.png and fig2.csv.
    """
    _figure("fig2", output, overwrite, show)


@reproduce.command()
def fig3(output: Folder = Path(), overwrite: Overwrite = False, show: ProgressOption = ProgressMode.AUTO) -> None:
    """Mirrored Sun and apparent temperature against zenith angles.

    Writes DIR/fig3.png and fig3.csv.
    """
    _figure("fig3", output, overwrite, show)


@reproduce.command()
def fig4(output: Folder = Path(), overwrite: Overwrite = False, show: ProgressOption = ProgressMode.AUTO) -> None:
    """Glint images for winds: mean and standard deviation.

    Writes DIR/fig4.png and fig4.csv.
    """
    _figure("fig4", output, overwrite, show)


@reproduce.command()
def fig5(
    output: Folder = Path(),
    overwrite: Overwrite = False,
    weather: Annotated[
        Path | None, typer.Option("--weather", help="weather table, or north-atlantic, instead of the climatology of the world's seas")
    ] = None,
    spectral: Annotated[bool, typer.Option("--spectral", help="radiance per wavenumber, not the article's way")] = False,
    show: ProgressOption = ProgressMode.AUTO,
) -> None:
    """Chance of glint against the azimuth from the Sun.

    Writes DIR/fig5.png and fig5.csv (a minute).
    """
    from seaglint.formats.tables.table_text import write_columns

    picture, numbers = _outputs(output, "fig5", overwrite=overwrite, inputs=[] if weather is None else [weather])
    from seaglint.studies.article.figures_5_and_12 import PRINTED, figure_5

    with progress(show, "azimuths") as report:
        result = figure_5(weather, mode="spectral" if spectral else "article", report=report)
    write_columns(result.columns, numbers, overwrite=overwrite)
    log(f"{numbers} written")
    from seaglint.plot.environment_charts import write_fig5

    write_fig5(result.columns, picture)
    log(f"{picture} written")
    log(
        f"the caption's 0.25 W cm-2 sr-1 is {PRINTED:g} W m-2 sr-1: exceeded in {100 * result.printed:.2g} % of looks; the brightest "
        f"glint of all draws is {result.brightest:.3g} W m-2 sr-1"
    )


@reproduce.command()
def fig10(output: Folder = Path(), overwrite: Overwrite = False, show: ProgressOption = ProgressMode.AUTO) -> None:
    """Autobinomial textures, isotropic and horizontal.

    Writes DIR/fig10.png and fig10.csv.
    """
    _figure("fig10", output, overwrite, show)


@reproduce.command()
def fig12(
    output: Folder = Path(),
    frames: Annotated[str | None, typer.Option("--frames", help="frames to render: 37, 0:10 (end not included); all 100")] = None,
    pixels: Annotated[
        int | None, typer.Option("--pixels", min=16, max=512, help="pixels along each side, fewer for a quick look; 512")
    ] = None,
    resume: Annotated[bool, typer.Option("--resume", help="continue an unfinished sequence")] = False,
    overwrite: Overwrite = False,
    show: ProgressOption = ProgressMode.AUTO,
) -> None:
    """Two bodies that close over a glinting sea.

    Writes DIR/fig12.zarr, .png, .csv and .mp4 (some minutes).

    The picture shows a frame in colours and in grey, and the geometry from the side; fig12.csv has the labels of both bodies in every
    frame, fig12.mp4 the sequence (with PyAV). A quick look: seaglint reproduce fig12 --frames 60:80 --pixels 128
    """
    from seaglint.plot.video import video_available
    from seaglint.store.outputs import refuse_existing
    from seaglint.store.sequence_store import check_output
    from seaglint.studies.article import figures_5_and_12 as engagement

    show_logs(quiet=show is ProgressMode.NONE)
    selected = parse_frames(frames, engagement.FRAMES)
    _made(output)
    store = check_output(output / "fig12.zarr", resume=resume, overwrite=overwrite)
    picture, numbers, video = (refuse_existing(output / f"fig12.{kind}", overwrite=overwrite or resume) for kind in ("png", "csv", "mp4"))
    with_video = video_available()
    if not with_video:
        log(f"no {video}: PyAV is not installed; {remedy('av')} adds it")
    with progress(show, "frames") as report:
        scenario = engagement.sequence(store, selected, pixels or engagement.PIXELS, resume=resume, overwrite=overwrite, progress=report)
    log(f"{store} written")
    from seaglint.formats.object_labels import Labels, write_labels
    from seaglint.plot.article_figures import write
    from seaglint.plot.video import write_video
    from seaglint.store.sequence_store import open_sequence

    labels, shown = Labels.of(store), engagement.shown_frame(selected)
    write_labels(labels, numbers, overwrite=overwrite or resume)
    log(f"{numbers} written")
    with open_sequence(store) as dataset:
        write(
            dataset,
            shown,
            [label for label in labels if label.frame == selected[shown]],
            engagement.trajectories(scenario, selected),
            picture,
        )
        log(f"{picture} written")
        if with_video:
            write_video(dataset, video, "linear", remedy="make room and run the same command with --resume")
            log(f"{video} written")


@reproduce.command()
def table1(
    output: Annotated[Path | None, typer.Option("-o", "--output", metavar="DIR", help="folder for table1.csv; not written without")] = None,
    as_json: AsJson = False,
    overwrite: Overwrite = False,
    show: ProgressOption = ProgressMode.AUTO,
) -> None:
    """Table 1 of the article, of false alarms, beside ours.

    Renders two seconds of glint for it, twice: some ten minutes on two cores. They are counted as rendered and through a detector with a
    blur of 1.2 pixels, which is assumed: the article does not state its sensor's. Other blurs are listed below each row. Sparkles below a
    pixel have the article's correlation time of 70 ms; in the columns "waves" they follow from the waves.
    """
    from seaglint.formats.tables.table_text import write_columns
    from seaglint.store.outputs import refuse_existing

    numbers = None if output is None else refuse_existing(_made(output) / "table1.csv", overwrite=overwrite)
    from seaglint.studies.article.table1 import table1 as compute

    with progress(show, "frames") as report:
        result = compute(report)
    if numbers is not None:
        write_columns(result.columns(), numbers, overwrite=overwrite)
        log(f"{numbers} written")
    if as_json:
        rows = {name: row.as_dict() for name, row in result.rows().items()}
        print_json({"rows": rows, "settings": result.settings(), "notes": list(result.analysis.notes)})
        return

    print_lines(table(result.rows()))
    typer.echo("; ".join(f"{key} = {value}" for key, value in result.settings().items()))


@reproduce.command()
def measured(
    output: Folder = Path(),
    spectroscopy: Annotated[
        SpectroscopyChoice, typer.Option("--spectroscopy", help="absorption of the air: today's line-by-line models or LOWTRAN7's; both")
    ] = SpectroscopyChoice.BOTH,
    overwrite: Overwrite = False,
    as_json: AsJson = False,
) -> None:
    """Measured spectra of sky and sea beside ours.

    Writes DIR/measured.csv and measured.png.

    Measured are AERI's zenith sky, HIS over the sea from 20 km, IRIS from space and a wave buoy, with the skewness, the kurtosis and the
    largest crest of its record. MODTRAN 4's path and sky and RRTMGP's
    paths and skies come from models. The data come with the package, and their sources are in measured.csv.
    """
    from seaglint.store.outputs import write_text

    picture, numbers = _outputs(output, "measured", overwrite=overwrite)
    from seaglint.plot.sensor_and_spectra import write_beside
    from seaglint.studies.measured.against_measurements import against_measurements

    result = against_measurements(spectroscopy.value)
    write_text(result.csv(), numbers)
    if as_json:
        print_json([row.as_dict() for row in result.rows])
    else:
        print_lines(result.lines())
    log(f"{numbers} written")
    write_beside(result.spectra, picture)
    log(f"{picture} written")


def _made(folder: Path) -> Path:
    """Return the folder, created if it is missing."""
    from seaglint.store.outputs import made_folder, refuse_file_ending

    return made_folder(refuse_file_ending(folder, "the output"), "choose another folder with -o")


def _outputs(folder: Path, name: str, *, overwrite: bool, inputs: Sequence[Path] = ()) -> tuple[Path, Path]:
    """Return the names of picture and numbers in a folder, which is created; existing files and inputs are refused."""
    from seaglint.store.outputs import refuse_existing

    _made(folder)
    picture, numbers = (refuse_existing(folder / f"{name}.{kind}", overwrite=overwrite, inputs=inputs) for kind in ("png", "csv"))
    return picture, numbers


def _figure(name: str, folder: Path, overwrite: bool, show: ProgressMode) -> None:
    """Compute a figure, write its numbers and draw it; existing files are refused before the work."""
    from seaglint.formats.tables.table_text import write_columns

    picture, numbers = _outputs(folder, name, overwrite=overwrite)
    from seaglint.studies.article import figures

    with progress(show, "textures" if name == "fig10" else "winds") as report:
        dataset = figures.FIGURES[name](report)
    write_columns(figures.table(name, dataset), numbers, overwrite=overwrite)
    log(f"{numbers} written")
    from seaglint.plot.article_figures import write_figure

    write_figure(name, dataset, picture)
    log(f"{picture} written")
