"""The command ``seaglint``: parse, call a study, show.

Results that a program may read go to stdout alone; logs, progress and errors go to stderr. Everything heavy is imported
inside the command that needs it, so that ``seaglint --help`` answers at once.
"""

from __future__ import annotations

import errno
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from typer.core import TyperGroup

from seaglint.base.errors import DataError, ScenarioError, SeaglintError
from seaglint.cli.analyze import analyze
from seaglint.cli.atmosphere import atmosphere
from seaglint.cli.dataset import Command as DatasetCommand
from seaglint.cli.dataset import dataset
from seaglint.cli.detect import detect
from seaglint.cli.ensemble import ensemble
from seaglint.cli.evaluate import evaluate
from seaglint.cli.export import Command as ExportCommand
from seaglint.cli.export import export, export_sea
from seaglint.cli.labels import labels
from seaglint.cli.likelihood import likelihood
from seaglint.cli.reproduce import reproduce
from seaglint.cli.sensor import SensorPreset, sense, sensor
from seaglint.cli.sensor import line as counts_line
from seaglint.cli.terminal.completion import InstallCompletion, ShowCompletion
from seaglint.cli.terminal.examples import add_examples
from seaglint.cli.terminal.groups import write_groups
from seaglint.cli.terminal.messages import files_read, log, naming_file, option_names, print_json, spelled_as_options
from seaglint.cli.terminal.options import Overwrite, PreviewScale, ShardOption, place_given
from seaglint.cli.terminal.progress import ProgressMode
from seaglint.cli.terminal.records import takes_records
from seaglint.cli.terminal.run_options import RunOptions
from seaglint.cli.texture import texture
from seaglint.cli.view import view
from seaglint.cli.weather import weather
from seaglint.studies.mean.mean_requests import MeanRequest
from seaglint.studies.sequence.sequence_requests import RenderRequest

if TYPE_CHECKING:
    from seaglint.files.store.share import Share


class _Terminated(BaseException):
    """SIGTERM, as Ctrl-C is a KeyboardInterrupt."""


@contextmanager
def _termination() -> Iterator[None]:
    """Let SIGTERM end a command as Ctrl-C does, with a line and its own exit code."""

    def end(*_: object) -> None:
        raise _Terminated

    if threading.current_thread() is not threading.main_thread():
        yield  # signals reach the main thread only
        return
    before = signal.signal(signal.SIGTERM, end)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


class _Commands(TyperGroup):
    """Errors that the user can mend are one line each on stderr; anything else keeps its traceback."""

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """Write the commands by what a person wants."""
        write_groups(ctx, self, formatter)

    def invoke(self, ctx: Any) -> Any:
        """Run the command chosen."""
        words = [*ctx._protected_args, *ctx.args]
        try:
            with _termination():
                return super().invoke(ctx)
        except SeaglintError as error:
            text = spelled_as_options(str(error), option_names(self, words), of_file=isinstance(error, ScenarioError))
            for line in text.splitlines():
                log(f"seaglint: {line}")
            sys.exit(error.exit_code)
        except OSError as error:
            if error.errno != errno.ENAMETOOLONG:
                raise
            log(f"seaglint: {str(error.filename)[:80]}...: a name in it is too long for this file system; give a shorter one")
            sys.exit(2)
        except KeyboardInterrupt:
            log("seaglint: interrupted; nothing unfinished has taken its final name")
            sys.exit(130)
        except _Terminated:
            log("seaglint: terminated; nothing unfinished has taken its final name")
            sys.exit(143)


app = typer.Typer(
    name="seaglint",
    cls=_Commands,
    rich_markup_mode=None,
    help="Infrared ocean clutter: mean radiance, glint and calibrated image sequences of a moving sea.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    add_completion=False,  # seaglint.cli.terminal.completion has its own
)
app.add_typer(reproduce, name="reproduce")
app.add_typer(evaluate, name="evaluate")
app.add_typer(atmosphere, name="atmosphere")
app.add_typer(weather, name="weather")
app.add_typer(texture, name="texture")
app.add_typer(detect, name="detect")
app.command()(analyze)
app.command(cls=DatasetCommand)(dataset)
app.command()(ensemble)
app.command(cls=ExportCommand)(export)
app.command("export-sea")(export_sea)
app.command()(labels)
app.command()(sense)
app.command()(sensor)
app.command()(likelihood)
app.command()(view)

_NO_MAPS = frozenset({".zarr", ".toml", ".csv", ".png", ".mp4", ".html", ".ply", ".npy", ".json"})
"""Endings that say another kind of file is meant than a mean map."""

RenderedFile = Annotated[
    str, typer.Argument(metavar="SCENARIO.toml", help="scenario file; 'seaglint init my.toml' writes one (with --finish alone: the store)")
]
AsJson = Annotated[bool, typer.Option("--json", help="print JSON")]
ScaleOption = Annotated[
    PreviewScale, typer.Option("--scale", help="brightness of previews; auto is log where glint would leave the sea black")
]


def _version(requested: bool) -> None:
    if requested:
        from seaglint.version import __version__

        typer.echo(f"seaglint {__version__}")
        raise typer.Exit


@app.callback()
def _seaglint(
    version: Annotated[bool, typer.Option("--version", callback=_version, is_eager=True, help="print the version and leave")] = False,
    install_completion: InstallCompletion = None,
    show_completion: ShowCompletion = None,
) -> None:
    pass


def _list_presets(requested: bool) -> None:
    if requested:
        from seaglint.scenario.presets.scene_presets import PRESETS

        for name, preset in PRESETS.items():
            typer.echo(f"{name:16} {preset.title}")
        raise typer.Exit


@app.command()
def init(
    output: Annotated[Path, typer.Argument(metavar="OUTPUT.toml", help="file to write")],
    preset: Annotated[str, typer.Option("--preset", help="scene to begin with")] = "glint",
    overwrite: Overwrite = False,
    presets: Annotated[bool, typer.Option("--presets", callback=_list_presets, is_eager=True, help="list the presets and leave")] = False,
) -> None:
    """Write a commented scenario file."""
    from seaglint.files.outputs import refuse_existing
    from seaglint.scenario.text.template import write_template

    refuse_existing(output, overwrite=overwrite)
    write_template(output, preset, overwrite=overwrite)
    log(f"{output} written; next: seaglint render {output} -o {output.with_suffix('.zarr')} --preview")


@app.command()
def schema() -> None:
    """Print the JSON Schema of scenario files."""
    from seaglint.scenario.text.template import json_schema

    print_json(json_schema())


@app.command()
@takes_records(order="scenario output overwrite preview scale")
def mean(
    request: MeanRequest,
    output: Annotated[Path, typer.Option("-o", "--output", help="NetCDF file to write")],
    preview: Annotated[bool, typer.Option("--preview", help="write a picture beside the file")] = False,
    scale: ScaleOption = PreviewScale.AUTO,
) -> None:
    """Map mean radiance and apparent temperature over the view."""
    from seaglint.cli.terminal.logs import show_logs
    from seaglint.files.netcdf import write_netcdf
    from seaglint.files.outputs import refuse_existing
    from seaglint.scenario.load import load_scenario

    show_logs()
    if output.suffix.lower() in _NO_MAPS:
        sequence = "; 'seaglint render' makes sequences, in .zarr" if output.suffix.lower() == ".zarr" else ""
        raise DataError(f"{output}: a mean map is a NetCDF file; give a name that ends in .nc{sequence}")
    loaded = load_scenario(request.scenario)
    picture, inputs = output.with_suffix(".png"), files_read(request.scenario, loaded)
    refuse_existing(output, overwrite=request.overwrite, inputs=inputs)
    if preview:
        _refuse_preview(picture, request.overwrite, inputs)
    from seaglint.studies.mean.mean_map import mean as mean_map

    with naming_file(request.scenario, loaded):
        dataset = mean_map(loaded)
    write_netcdf(dataset, output, overwrite=request.overwrite)
    log(f"{output} written")
    if preview:
        from seaglint.plot.preview import write_picture

        write_picture(dataset, picture, scale.value)
        log(f"{picture} written")


@app.command()
@takes_records(
    order="scenario output frames threads resume overwrite preview scale show sensor_preset electrons radiance workers dask dask_slurm"
)
def render(
    scenario: RenderedFile,
    request: RenderRequest,
    run: RunOptions,
    output: Annotated[
        str | None, typer.Option("-o", "--output", help="Zarr store to write: run.zarr, or a URL like s3://bucket/run.zarr")
    ] = None,
    preview: Annotated[bool, typer.Option("--preview", help="write a picture and a video beside the store")] = False,
    scale: ScaleOption = PreviewScale.AUTO,
    sensor_preset: SensorPreset = None,
    shard: ShardOption = None,
    finish: Annotated[
        bool, typer.Option("--finish", help="check that all frames of a store are there, and name it: --finish RUN.zarr")
    ] = False,
) -> None:
    """Render the sequence: radiance, or counts of a detector.

    Radiance is at the aperture; where the scenario has a detector, frames are its counts. Any frame alone is the same as in the sequence.
    """
    from seaglint.cli.terminal.finish import finish_store, require_one_way, tell_share
    from seaglint.cli.terminal.frame_numbers import parse_frames
    from seaglint.cli.terminal.logs import show_logs
    from seaglint.cli.terminal.progress import progress
    from seaglint.files.store.share import Share
    from seaglint.files.store.store import check_output
    from seaglint.scenario.load import load_scenario

    show_logs(quiet=run.show is ProgressMode.NONE)
    if finish:
        require_one_way(shard=shard, overwrite=request.overwrite)
        if preview:
            _beside(place_given(output or scenario), None)  # before anything is done
        finished = finish_store(scenario, output, sensor_preset)
        if preview:
            _preview(finished, scale)
        return
    if output is None:
        raise typer.BadParameter("Missing option '-o' / '--output'.")
    share = None if shard is None else Share.parse(shard)
    file = Path(scenario)
    loaded = load_scenario(file, sensor=sensor_preset)
    numbers = parse_frames(request.frames, loaded.sensor.frames)
    store = place_given(output)
    inputs = files_read(file, loaded)
    check_output(store, resume=request.resume, overwrite=request.overwrite, inputs=inputs, share=share)
    pictures = _Pictures(_beside(store, share), inputs, replace=request.overwrite or request.resume) if preview else None
    render_sequence: Callable[..., Path | str]
    if loaded.sensor.senses or request.electrons or request.radiance:
        from seaglint.studies.sequence.sensed import render as render_counts

        render_sequence = partial(render_counts, electrons=request.electrons, radiance=request.radiance)
    else:
        from seaglint.studies.sequence.render_sequence import render as render_radiance

        render_sequence = render_radiance
    with naming_file(file, loaded), run.chosen() as others, progress(run.show, "frames") as report:
        more: dict[str, Any] = {"share": share} if share is not None else {}
        more |= {"workers": others} if others is not None else {}
        alone = None if others is not None else request.threads
        more |= {"resume": request.resume, "overwrite": request.overwrite}
        render_sequence(loaded, store, frames=numbers, threads=alone, progress=report, **more)
    if share is not None:
        tell_share(store, share)
        return
    from seaglint.files.store.store import open_sequence
    from seaglint.plot.sequence_summary import summarise

    with open_sequence(store) as dataset:
        if pictures is not None:
            pictures.write(dataset, scale)
        log(f"{store}: {summarise(dataset).line}")
        if "signal" in dataset:
            log(f"{store}: {counts_line(dataset)}")


def _preview(store: Path | str, scale: PreviewScale) -> None:
    """Write pictures of a finished store; older ones are replaced, as by --resume."""
    from seaglint.files.store.store import open_sequence

    with open_sequence(store) as dataset:
        _Pictures(_beside(store, None), [], replace=True).write(dataset, scale)


def _beside(store: Path | str, share: Share | None) -> Path:
    """Where pictures of a store go."""
    if share is not None:
        raise DataError("--preview shows a whole sequence and --shard makes a part; leave --preview out, and give it with --finish")
    if not isinstance(store, Path):
        raise DataError(f"--preview writes pictures beside a folder, and {store} is none; leave it out")
    return store


def _refuse_preview(path: Path, replace: bool, inputs: list[Path]) -> None:
    """Refuse to write a preview over what may be somebody's, and say why a name is taken that was not given."""
    from seaglint.files.outputs import refuse_existing

    if path.exists() and not replace:
        raise DataError(
            f"{path}: --preview writes this file, which exists already (of another run, or your own); "
            "replace it with --overwrite, give -o another name, or leave --preview out"
        )
    refuse_existing(path, overwrite=replace, inputs=inputs)


class _Pictures:
    """Previews beside a store, refused before the work rather than after it."""

    def __init__(self, output: Path, inputs: list[Path], *, replace: bool) -> None:
        from seaglint.plot.video import video_available

        self.picture, self.video = output.with_suffix(".png"), output.with_suffix(".mp4")
        self.with_video = video_available()
        _refuse_preview(self.picture, replace, inputs)
        if self.with_video:
            _refuse_preview(self.video, replace, inputs)
        else:
            log(f"no {self.video}: PyAV is not installed; pip install 'seaglint[video]' adds it")

    def write(self, dataset: Any, scale: PreviewScale) -> None:
        """Write the picture, and the video where PyAV is installed."""
        from seaglint.plot.preview import write_picture
        from seaglint.plot.video import write_video

        write_picture(dataset, self.picture, scale.value)
        log(f"{self.picture} written")
        if self.with_video:
            write_video(dataset, self.video, scale.value, remedy="make room and run the same command with --resume")
            log(f"{self.video} written")


@app.command()
def info(
    path: Annotated[str, typer.Argument(metavar="RUN.zarr", help="sequence, finished or not, or a mean map; also a URL of a sequence")],
    as_json: AsJson = False,
) -> None:
    """Say what a sequence or map holds and how it was made."""
    from seaglint.cli.info import describe, lines

    facts = describe(place_given(path))
    if as_json:
        print_json(facts.as_dict())
    else:
        typer.echo("\n".join(lines(facts)))


@app.command()
def doctor(as_json: AsJson = False) -> None:
    """Check versions, threads, GPU, codecs and tables' checksums."""
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


add_examples(app)


def main() -> None:
    """Entry point of the command ``seaglint``."""
    app(prog_name="seaglint")


if __name__ == "__main__":
    main()
