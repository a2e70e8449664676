"""The command ``seaglint``: parse, call a study, show.

Results that a program may read go to stdout alone; logs, progress and errors go to stderr. A command's module is imported when the command
is asked for, and what is heavy inside the command, so that ``seaglint --help`` answers at once.
"""

from __future__ import annotations

import errno
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from seaglint.base.errors import ScenarioError, SeaglintError
from seaglint.base.thread_setting import require_thread_setting
from seaglint.cli.commands import Commands, write_groups
from seaglint.cli.terminal.completion import InstallCompletion, ShowCompletion
from seaglint.cli.terminal.examples import epilog
from seaglint.cli.terminal.logs import begin_logs
from seaglint.cli.terminal.messages import log, option_names, printable, spelled_as_options
from seaglint.cli.terminal.start import collect_later


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


@contextmanager
def _printable_usage() -> Iterator[None]:
    """Let complaints about the command line repeat only what a terminal shows as it is."""
    try:
        yield
    except Exception as error:
        message = getattr(error, "message", None)
        if hasattr(error, "format_message") and isinstance(message, str):
            error.message = printable(message)  # type: ignore[attr-defined]  # of click, which Typer may bring under another name
        raise


class _Program(TyperGroup):
    """Errors that the user can mend are one line each on stderr; anything else keeps its traceback."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self.commands = Commands()  # type: ignore[assignment]

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """Write the commands by what a person wants."""
        write_groups(formatter)

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Read the program's own options."""
        with _printable_usage():
            return super().parse_args(ctx, args)

    def invoke(self, ctx: Any) -> Any:
        """Run the command chosen."""
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
            if error.errno != errno.ENAMETOOLONG:
                raise
            log(f"seaglint: {str(error.filename)[:80]}...: a name in it is too long for this file system; give a shorter one")
            sys.exit(2)
        except MemoryError as error:  # what no estimate foresaw
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
    add_completion=False,  # seaglint.cli.terminal.completion has its own
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
