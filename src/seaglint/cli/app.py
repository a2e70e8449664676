"""The command ``seaglint``: its commands by groups, the module of each command, and the exit codes of errors.

Results that a program may read go to stdout alone; logs, progress and errors go to stderr.

Imports are deferred in all commands: the module of a command is imported when the command is called, and NumPy, Numba, xarray and the
studies inside the function of the command. ``seaglint --help`` then needs 0.07 s of processor time; importing what ``render``
needs takes 1.4 s more, and a mistyped option is reported before it.
"""

from __future__ import annotations

import errno
import signal
import sys
import threading
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from importlib import import_module
from typing import Annotated, Any, Final

import typer
from typer.core import TyperCommand, TyperGroup
from typer.main import get_command

from seaglint.base.errors import ScenarioError, SeaglintError
from seaglint.base.thread_setting import require_thread_setting
from seaglint.cli.terminal.messages import begin_logs, log, option_names, printable, spelled_as_options
from seaglint.cli.terminal.program import InstallCompletion, ShowCompletion, add_examples, collect_later, epilog


@dataclass(frozen=True)
class CommandEntry:
    """Entry of a command: module and function, first line of its help (listed without importing the command), and its class."""

    place: str
    summary: str
    made_by: str | None = None


#: Commands by purpose.
GROUPS: Final[dict[str, dict[str, CommandEntry]]] = {
    "Begin": {
        "init": CommandEntry("scenario_file.init", "Write a commented scenario file."),
        "schema": CommandEntry("scenario_file.schema", "JSON Schema of scenario files."),
        "doctor": CommandEntry("facts.doctor", "Check the installation, or compile kernels ahead."),
    },
    "Look": {
        "view": CommandEntry("view.view", "Look at sequences, maps and scenarios in a browser."),
        "info": CommandEntry("facts.info", "Report the contents of a file and how it was made."),
        "reproduce": CommandEntry("reproduce.reproduce", "Results of the source article, and measured spectra."),
    },
    "Compute": {
        "mean": CommandEntry("mean.mean", "Map mean radiance and apparent temperature over the view."),
        "render": CommandEntry("render.render", "Render the sequence: radiance, or counts of a detector."),
        "sense": CommandEntry("sensor.sense", "Put a sensor on recorded radiance: counts of its detector."),
        "sensor": CommandEntry("sensor.sensor", "Figures of merit of a sensor: NETD, MTF, noise budget."),
        "evaluate": CommandEntry("evaluate.evaluate", "Results for many cases, and slope variances of a sea."),
        "sweep": CommandEntry("sweep_keys.sweep", "Compute one quantity over every combination of values of keys."),
        "atmosphere": CommandEntry("atmosphere.atmosphere", "The air: soundings, files of it, and MODTRAN's files."),
        "weather": CommandEntry("weather.weather", "Tables of weather: how often which conditions come."),
        "texture": CommandEntry("texture.texture", "Statistical textures: fit, sample, compare, lay on the sea."),
        "ensemble": CommandEntry("ensemble.ensemble", "Draw scenes from laws of a scenario's keys and render each."),
    },
    "Analyse": {
        "analyze": CommandEntry("analyze.analyze", "Clutter statistics and false alarms of a recording, by region."),
        "detect": CommandEntry("detect.detect", "Probabilities of detection and false alarm of a detector."),
        "compare": CommandEntry("compare.compare", "Compare a measured spectrum with a scenario's spectrum."),
        "likelihood": CommandEntry("likelihood.likelihood", "How often glint is brighter than thresholds."),
    },
    "Share": {
        "export": CommandEntry("export.export", "Write frames of a run for another program.", "Command"),
        "export-sea": CommandEntry("export.export_sea", "Write heights, slopes and roughness of the sea at one time."),
        "labels": CommandEntry("export.labels", "Write places, masks and contrasts of objects, by frame."),
        "dataset": CommandEntry("ensemble.dataset", "Render labelled pictures of an ensemble: masks, boxes, tables.", "Command"),
    },
}

_ENTRIES: Final = {name: entry for members in GROUPS.values() for name, entry in members.items()}


def _made(name: str, entry: CommandEntry) -> Any:
    """Import a command, or a group of them."""
    module, _, attribute = entry.place.partition(".")
    defined = import_module(f"seaglint.cli.{module}")
    what = getattr(defined, attribute)
    program = typer.Typer(rich_markup_mode=None, callback=lambda: None)
    if isinstance(what, typer.Typer):
        program.add_typer(what, name=name)
    else:
        program.command(name, cls=getattr(defined, entry.made_by) if entry.made_by else None)(what)
    add_examples(program)
    commands: dict[str, Any] = get_command(program).commands  # type: ignore[attr-defined]
    return commands[name]


class Commands(Mapping[str, Any]):
    """Commands of the program by name, each imported when it is called.

    Examples
    --------
    >>> "render" in Commands(), Commands().get("rendre")
    (True, None)
    """

    def __init__(self) -> None:
        self._made: dict[str, Any] = {}

    def __getitem__(self, name: str) -> Any:
        if name not in self._made:
            self._made[name] = _made(name, _ENTRIES[name])
        return self._made[name]

    def __contains__(self, name: object) -> bool:
        return name in _ENTRIES

    def __iter__(self) -> Iterator[str]:
        return iter(_ENTRIES)

    def __len__(self) -> int:
        return len(_ENTRIES)


def write_groups(formatter: Any) -> None:
    """Write the commands under their headings."""
    # 6 columns: the indentation of a list in Click's help pages, and the gap between its columns.
    limit = formatter.width - 6 - max(map(len, _ENTRIES))
    for heading, members in GROUPS.items():
        with formatter.section(heading):
            formatter.write_dl(
                [(name, TyperCommand(name, help=entry.summary).get_short_help_str(limit)) for name, entry in members.items()]
            )


class _Terminated(BaseException):
    """SIGTERM, as Ctrl-C is a KeyboardInterrupt."""


@contextmanager
def _termination() -> Iterator[None]:
    """Let SIGTERM end a command as Ctrl-C does, with a line and a separate exit code."""

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


@contextmanager
def _printable_usage() -> Iterator[None]:
    """Let errors of the command line repeat printable characters only."""
    try:
        yield
    except Exception as error:
        message = getattr(error, "message", None)
        if hasattr(error, "format_message") and isinstance(message, str):
            error.message = printable(message)  # type: ignore[attr-defined]  # of click, which Typer may bring under another name
        raise


class _Program(TyperGroup):
    """Group of all commands. Errors that the user can correct become lines on stderr; all others keep their traceback."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self.commands = Commands()  # type: ignore[assignment]

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """Write the commands by purpose."""
        write_groups(formatter)

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Read the program's own options."""
        with _printable_usage():
            return super().parse_args(ctx, args)

    def invoke(self, ctx: Any) -> Any:
        """Run the chosen command."""
        words = [*ctx._protected_args, *ctx.args]
        begin_logs()
        try:
            require_thread_setting()
            with _termination(), _printable_usage():
                return super().invoke(ctx)
        except SeaglintError as error:
            text = spelled_as_options(str(error), option_names(self, words), of_file=isinstance(error, ScenarioError))
            for line in text.split("\n"):
                log(f"seaglint: {line}")
            sys.exit(error.exit_code)
        except OSError as error:
            # Other errors of the system are converted where their cause is known.
            if error.errno != errno.ENAMETOOLONG:
                raise
            log(f"seaglint: {str(error.filename)[:80]}...: a name in it is too long for this file system; give a shorter one")
            sys.exit(2)
        except MemoryError as error:  # no estimate foresaw it
            log(f"seaglint: the memory of this machine is not enough ({str(error) or 'it ran out'}); give fewer pixels, frames or workers")
            sys.exit(2)
        except KeyboardInterrupt:
            log("seaglint: interrupted; files with their final names are complete")
            sys.exit(130)
        except _Terminated:
            log("seaglint: terminated; files with their final names are complete")
            sys.exit(143)


app = typer.Typer(
    name="seaglint",
    cls=_Program,
    rich_markup_mode=None,
    help="Infrared ocean clutter: mean radiance, glint and calibrated image sequences of a moving sea.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    epilog=epilog(""),
    add_completion=False,  # replaced by the options of seaglint.cli.terminal.program
)


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


def main() -> None:
    """Entry point of the command ``seaglint``."""
    collect_later()
    app(prog_name="seaglint")


if __name__ == "__main__":
    main()
