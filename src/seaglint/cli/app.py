"""The command ``seaglint``: parse, call the pipeline, show.

Results that a program may read go to stdout alone; logs, progress and errors go to stderr. Everything heavy is imported
inside the command that needs it, so that ``seaglint --help`` answers at once.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from seaglint.cli.analyze import analyze
from seaglint.cli.atmosphere import atmosphere
from seaglint.cli.evaluate import evaluate
from seaglint.cli.export import export_sea
from seaglint.cli.messages import log, naming_file, print_json
from seaglint.cli.progress import ProgressMode
from seaglint.cli.reproduce import reproduce
from seaglint.errors import SeaglintError


class _Commands(TyperGroup):
    """Errors that the user can mend are one line each on stderr; anything else keeps its traceback."""

    def invoke(self, ctx: Any) -> Any:
        """Run the command chosen."""
        try:
            return super().invoke(ctx)
        except SeaglintError as error:
            for line in str(error).splitlines():
                log(f"seaglint: {line}")
            sys.exit(error.exit_code)
        except KeyboardInterrupt:
            log("seaglint: interrupted; nothing unfinished has taken its final name")
            sys.exit(130)


app = typer.Typer(
    name="seaglint",
    cls=_Commands,
    rich_markup_mode=None,
    help="Infrared ocean clutter: mean radiance, glint and calibrated image sequences of a moving sea.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    add_completion=False,
)
app.add_typer(reproduce, name="reproduce")
app.add_typer(evaluate, name="evaluate")
app.add_typer(atmosphere, name="atmosphere")
app.command()(analyze)
app.command("export-sea")(export_sea)

ScenarioFile = Annotated[Path, typer.Argument(metavar="SCENARIO.toml", help="scenario file; 'seaglint init my.toml' writes one")]
AsJson = Annotated[bool, typer.Option("--json", help="print JSON")]
Overwrite = Annotated[bool, typer.Option("--overwrite", help="replace what stands at the output")]
Progress = Annotated[ProgressMode, typer.Option("--progress", help="bar on a terminal, log lines elsewhere, or nothing")]


def _version(wanted: bool) -> None:
    if wanted:
        from seaglint.version import __version__

        typer.echo(f"seaglint {__version__}")
        raise typer.Exit


@app.callback()
def _seaglint(
    version: Annotated[bool, typer.Option("--version", callback=_version, is_eager=True, help="print the version and leave")] = False,
) -> None:
    pass


def _list_presets(wanted: bool) -> None:
    if wanted:
        from seaglint.scenario.presets import PRESETS

        for name, found in PRESETS.items():
            typer.echo(f"{name:16} {found.title}")
        raise typer.Exit


@app.command()
def init(
    output: Annotated[Path, typer.Argument(metavar="OUTPUT.toml", help="file to write")],
    preset: Annotated[str, typer.Option("--preset", help="scene to begin with")] = "glint",
    overwrite: Overwrite = False,
    presets: Annotated[bool, typer.Option("--presets", callback=_list_presets, is_eager=True, help="list the presets and leave")] = False,
) -> None:
    """Write a commented scenario file."""
    from seaglint.scenario.template import write_template

    write_template(output, preset, overwrite=overwrite)
    log(f"{output} written; next: seaglint render {output} -o {output.with_suffix('.zarr')} --preview")


@app.command()
def schema() -> None:
    """Print the JSON Schema of scenario files."""
    from seaglint.scenario.template import json_schema

    print_json(json_schema())


@app.command()
def mean(
    scenario: ScenarioFile,
    output: Annotated[Path, typer.Option("-o", "--output", help="NetCDF file to write")],
    overwrite: Overwrite = False,
    preview: Annotated[bool, typer.Option("--preview", help="write a picture beside the file")] = False,
) -> None:
    """Map the mean radiance and apparent temperature over the field of view."""
    from seaglint.cli.logs import show_logs
    from seaglint.io.netcdf import write_netcdf
    from seaglint.io.outputs import refuse_existing
    from seaglint.scenario.load import load_scenario

    show_logs()
    loaded = load_scenario(scenario)
    picture = output.with_suffix(".png")
    refuse_existing(output, overwrite=overwrite)
    if preview:
        refuse_existing(picture, overwrite=overwrite)
    from seaglint.pipeline.mean import mean as mean_map

    with naming_file(scenario, loaded):
        dataset = mean_map(loaded)
    write_netcdf(dataset, output, overwrite=overwrite)
    log(f"{output} written")
    if preview:
        from seaglint.plot.preview import write_picture

        write_picture(dataset, picture)
        log(f"{picture} written")


@app.command()
def render(
    scenario: ScenarioFile,
    output: Annotated[Path, typer.Option("-o", "--output", help="Zarr store to write, e.g. run.zarr")],
    frames: Annotated[str | None, typer.Option("--frames", help="frames to render: 37, 37:38 (end not included), 10:")] = None,
    threads: Annotated[int | None, typer.Option("--threads", min=1, help="processor threads; all where nothing is said")] = None,
    resume: Annotated[bool, typer.Option("--resume", help="go on with an unfinished sequence")] = False,
    overwrite: Overwrite = False,
    preview: Annotated[bool, typer.Option("--preview", help="write a picture and a video beside the store")] = False,
    show: Progress = ProgressMode.AUTO,
) -> None:
    """Render the sequence: radiance at the aperture, frame by frame."""
    from seaglint.cli.frames import parse_frames
    from seaglint.cli.logs import show_logs
    from seaglint.cli.progress import progress
    from seaglint.scenario.load import load_scenario

    show_logs(quiet=show is ProgressMode.NONE)
    loaded = load_scenario(scenario)
    wanted = parse_frames(frames, loaded.sensor.frames)
    # A trailing slash or a bare name would put the previews elsewhere than beside the store.
    output = Path(str(output).rstrip("/\\"))
    pictures = _Pictures(output, replace=overwrite or resume) if preview else None
    from seaglint.pipeline.render import render as render_sequence

    with naming_file(scenario, loaded), progress(show, "frames") as report:
        render_sequence(loaded, output, frames=wanted, threads=threads, resume=resume, overwrite=overwrite, progress=report)
    from seaglint.io.store import open_sequence
    from seaglint.plot.summary import summarise

    with open_sequence(output) as dataset:
        if pictures is not None:
            pictures.write(dataset)
        log(f"{output}: {summarise(dataset).line}")


class _Pictures:
    """Previews beside a store, refused before the work rather than after it."""

    def __init__(self, output: Path, *, replace: bool) -> None:
        from seaglint.io.outputs import refuse_existing
        from seaglint.plot.video import video_available

        self.picture, self.video = output.with_suffix(".png"), output.with_suffix(".mp4")
        self.with_video = video_available()
        refuse_existing(self.picture, overwrite=replace)
        if self.with_video:
            refuse_existing(self.video, overwrite=replace)
        else:
            log(f"no {self.video}: PyAV is not installed; pip install 'seaglint[video]' adds it")

    def write(self, dataset: Any) -> None:
        """Write the picture, and the video where PyAV is installed."""
        from seaglint.plot.preview import write_picture
        from seaglint.plot.video import write_video

        write_picture(dataset, self.picture)
        log(f"{self.picture} written")
        if self.with_video:
            write_video(dataset, self.video)
            log(f"{self.video} written")


@app.command()
def info(
    path: Annotated[Path, typer.Argument(metavar="RUN.zarr", help="sequence, finished or not, or a mean map")],
    as_json: AsJson = False,
) -> None:
    """Say what a sequence or map holds and how it was made."""
    from seaglint.cli.info import describe, lines

    found = describe(path)
    if as_json:
        print_json(found)
    else:
        typer.echo("\n".join(lines(found)))


@app.command()
def doctor(as_json: AsJson = False) -> None:
    """Check the installation: versions, threads, GPU, codecs, table checksums."""
    from seaglint.cli.doctor import examine

    report = examine()
    if as_json:
        print_json(report.as_dict())
    else:
        typer.echo("\n".join(report.lines))
    if report.problems:
        for problem in report.problems:
            log(f"seaglint: {problem}")
        raise typer.Exit(2)


def main() -> None:
    """Entry point of the command ``seaglint``."""
    app()


if __name__ == "__main__":
    main()
