"""The commands ``seaglint info`` and ``seaglint doctor``: of a recording, and of the installation."""

from __future__ import annotations

from typing import Annotated

import typer

from seaglint.cli.terminal.messages import log, print_json
from seaglint.cli.terminal.options import place_given

AsJson = Annotated[bool, typer.Option("--json", help="print JSON")]


def info(
    path: Annotated[str, typer.Argument(metavar="RUN.zarr", help="sequence, finished or not, or a mean map; also a URL of a sequence")],
    as_json: AsJson = False,
) -> None:
    """Say what a sequence or map holds and how it was made."""
    from seaglint.cli.info import describe, lines
    from seaglint.cli.terminal.start import only_numpy

    only_numpy()
    facts = describe(place_given(path))
    if as_json:
        print_json(facts.as_dict())
    else:
        typer.echo("\n".join(lines(facts)))


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
