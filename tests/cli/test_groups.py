"""What ``seaglint --help`` shows: groups, examples that work, completion."""

from __future__ import annotations

import os
import shlex
import subprocess
import sys
from pathlib import Path

import pytest
import typer
from typer.main import get_command

from seaglint.cli.app import app
from seaglint.cli.groups import EXAMPLES, GROUPS, OTHER

ROOT = get_command(app)
QUICK = ("init", "schema", "weather info")


def commands(group: object = ROOT, before: str = "") -> dict[str, object]:
    """All commands by what is typed."""
    out: dict[str, object] = {}
    for name, command in group.commands.items():  # type: ignore[attr-defined]
        out |= commands(command, f"{before}{name} ") if hasattr(command, "commands") else {before + name: command}
    return out


def test_every_command_is_in_one_group(seaglint) -> None:
    named = [name for members in GROUPS.values() for name in members]
    assert len(named) == len(set(named))
    assert set(ROOT.commands) <= set(named)  # type: ignore[attr-defined]
    told = seaglint("--help").out
    places = [told.index(f"\n{heading}:\n") for heading in GROUPS]
    assert places == sorted(places)
    assert f"{OTHER}:" not in told
    for name in ROOT.commands:  # type: ignore[attr-defined]
        assert f"\n  {name} " in told


@pytest.mark.parametrize("name", EXAMPLES)
def test_examples_are_understood_and_stand_at_the_end_of_the_help(name: str, seaglint) -> None:
    told = seaglint(*name.split(), "--help").out
    for line in EXAMPLES[name]:
        assert line in told
        words = shlex.split(line.partition(">")[0])
        if words[0] != "seaglint":
            continue
        command, rest = ROOT, words[1:]
        while hasattr(command, "commands"):
            command, rest = command.commands[rest[0]], rest[1:]
        assert isinstance(command, typer.core.TyperCommand)
        command.make_context("seaglint", list(rest))
    assert told.rstrip().endswith(EXAMPLES[name][-1])


def test_examples_are_of_commands_that_there_are() -> None:
    assert set(EXAMPLES) <= set(commands())


def run(lines: tuple[str, ...], folder: Path) -> None:
    seaglint = f"{shlex.quote(sys.executable)} -m seaglint.cli.app"
    script = " && ".join(line.replace("seaglint", seaglint, 1) if line.startswith("seaglint ") else line for line in lines)
    done = subprocess.run(script, shell=True, cwd=folder, capture_output=True, text=True, check=False, timeout=900)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("name", QUICK)
def test_quick_examples_work_in_an_empty_folder(name: str, tmp_path: Path) -> None:
    run(EXAMPLES[name], tmp_path)


@pytest.mark.validation
@pytest.mark.parametrize("name", [name for name in EXAMPLES if name not in QUICK])
def test_all_examples_work_in_an_empty_folder(name: str, tmp_path: Path) -> None:
    run(EXAMPLES[name], tmp_path)


@pytest.mark.parametrize(("words", "found"), [("seaglint dete", "detect"), ("seaglint detect --match", "--match-radius")])
def test_the_shell_completes_commands_and_options(words: str, found: str) -> None:
    asked = {"_SEAGLINT_COMPLETE": "complete_bash", "COMP_WORDS": words, "COMP_CWORD": str(words.count(" "))}
    command = [sys.executable, "-c", "import sys; sys.argv = ['seaglint']; from seaglint.cli.app import app; app(prog_name='seaglint')"]
    done = subprocess.run(command, env={**os.environ, **asked}, capture_output=True, text=True, check=False, timeout=300)
    assert found in done.stdout
