"""Commands ``seaglint info``, contents of a file, and ``seaglint doctor``, check of the installation."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from seaglint.base.errors import DataError
from seaglint.cli.terminal.messages import log, print_json, print_lines, show_logs
from seaglint.cli.terminal.options import AsJson, ProgressOption, place_given
from seaglint.cli.terminal.program import only_numpy
from seaglint.cli.terminal.progress import ProgressMode, progress


def info(
    path: Annotated[
        str, typer.Argument(metavar="FILE", help="sequence, finished or not, also a URL; mean map; scenario; recording of any format")
    ],
    variable: Annotated[str | None, typer.Option("--variable", help="which array of a recording that holds several")] = None,
    channel: Annotated[
        str | None, typer.Option("--channel", help="a colour, or the number of a channel, of a recording of several")
    ] = None,
    axes: Annotated[str | None, typer.Option("--axes", help="order of a recording's axes, e.g. yxt where time is the last")] = None,
    everything: Annotated[bool, typer.Option("--all", help="with all that was noted when it was made")] = False,
    as_json: AsJson = False,
) -> None:
    """Report the contents of a file and how it was made."""
    from seaglint.studies.file_contents import describe, describe_recording, describe_scenario, is_ours, lines

    only_numpy()
    place = place_given(path)
    if is_ours(place):
        contents = describe(place)
        text, as_plain = lines(contents, everything=everything), contents.as_dict
    else:
        assert isinstance(place, Path)
        facts = describe_scenario(place) if place.suffix.lower() == ".toml" else describe_recording(place, variable, channel, axes)
        text, as_plain = facts.lines, facts.as_dict
    if as_json:
        print_json(as_plain())
    else:
        print_lines(text)


def doctor(
    scenario: Annotated[
        Path | None, typer.Argument(metavar="[SCENARIO]", help="with --compile: the scenario; the default one if not given")
    ] = None,
    compile_kernels: Annotated[
        bool, typer.Option("--compile", help="compile all kernels of a scenario now, so that later commands and workers load them")
    ] = False,
    as_json: AsJson = False,
    show: ProgressOption = ProgressMode.AUTO,
) -> None:
    """Check the installation, or compile kernels ahead.

    The check covers versions, threads, GPU, codecs and the checksums of tables.
    """
    if compile_kernels:
        _compile(scenario, as_json, show)
        return
    if scenario is not None:
        raise DataError(f"{scenario} is given without --compile, and the checks need no scenario; add --compile or leave {scenario} out")
    from seaglint.cli.doctor import examine

    report = examine()
    if as_json:
        print_json(report.as_dict())
    else:
        print_lines(report.lines)
    if report.problems:
        for problem in report.problems:
            log(f"seaglint: {problem}")
        raise typer.Exit(2)


def _compile(scenario: Path | None, as_json: bool, show: ProgressMode) -> None:
    """Compile the kernels of a scenario and print their folder."""
    from seaglint.cli.compile_kernels import compile_kernels

    only_numpy()
    show_logs(quiet=True)
    with progress(show, "kernels") as report:
        done = compile_kernels(scenario, report)
    if as_json:
        print_json(done.as_dict())
    else:
        print_lines([done.line])
