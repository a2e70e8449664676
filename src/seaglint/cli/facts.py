"""The commands ``seaglint info`` and ``seaglint doctor``: of a file, and of the installation."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from seaglint.cli.terminal.messages import log, print_json, tell
from seaglint.cli.terminal.options import place_given

AsJson = Annotated[bool, typer.Option("--json", help="print JSON")]


def info(
    path: Annotated[
        str,
        typer.Argument(metavar="FILE", help="sequence, finished or not, also a URL; mean map; scenario; recording of any format"),
    ],
    everything: Annotated[bool, typer.Option("--all", help="with all that was noted when it was made")] = False,
    as_json: AsJson = False,
) -> None:
    """Say what a file holds and how it was made."""
    from seaglint.cli.info import describe, lines
    from seaglint.cli.input_facts import describe_recording, describe_scenario, is_ours
    from seaglint.cli.terminal.start import only_numpy

    only_numpy()
    place = place_given(path)
    if is_ours(place):
        held = describe(place)
        told, plain = lines(held, everything=everything), held.as_dict
    else:
        assert isinstance(place, Path)
        facts = describe_scenario(place) if place.suffix.lower() == ".toml" else describe_recording(place)
        told, plain = facts.lines, facts.as_dict
    if as_json:
        print_json(plain())
    else:
        tell(told)


def doctor(as_json: AsJson = False) -> None:
    """Check versions, threads, GPU, codecs and tables' checksums."""
    from seaglint.cli.doctor import examine

    report = examine()
    if as_json:
        print_json(report.as_dict())
    else:
        tell(report.lines)
    if report.problems:
        for problem in report.problems:
            log(f"seaglint: {problem}")
        raise typer.Exit(2)
