"""Examples of the commands' help: each command has one, and typed in an empty folder or after others they work."""

from __future__ import annotations

import random
import shlex
import shutil
import signal
import subprocess
import sys
import urllib.request
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import typer
from typer.main import get_command

from seaglint.cli.app import app
from seaglint.cli.terminal.program import EXAMPLES

ROOT = get_command(app)
QUICK = ("init", "schema", "weather build", "weather info", "evaluate atmosphere", "evaluate emissivity", "ensemble")
ELSEWHERE = {
    "atmosphere read": "needs MODTRAN; test_atmosphere_modtran.py reads what LOWTRAN7 made of a deck",
    "view": "serves until Ctrl-C; below",
}


def commands(group: object = ROOT, before: str = "") -> dict[str, object]:
    """All commands, groups of them too, by what is typed."""
    out: dict[str, object] = {before.strip(): group}
    for name, command in getattr(group, "commands", {}).items():
        out |= commands(command, f"{before}{name} ")
    return out


def whole(lines: tuple[str, ...]) -> list[str]:
    r"""Commands, where a \ at the end of a line goes on in the next."""
    return "\n".join(lines).replace("\\\n", " ").split("\n")


def test_every_command_has_an_example_and_every_example_a_command() -> None:
    assert set(EXAMPLES) == set(commands())


@pytest.mark.parametrize("name", EXAMPLES)
def test_examples_are_understood_and_stand_at_the_end_of_the_help(name: str, seaglint) -> None:
    told = seaglint(*name.split(), "--help").out
    assert told.rstrip().endswith("\n".join(["  Example:", *(f"    {line}" for line in EXAMPLES[name])]))
    said = [line.partition(" > ")[0] for line in whole(EXAMPLES[name]) if line.startswith("seaglint ")]
    assert said[-1].startswith(f"seaglint {name}")
    for line in said:
        command, rest = ROOT, shlex.split(line)[1:]
        while hasattr(command, "commands"):
            command, rest = command.commands[rest[0]], rest[1:]
        assert isinstance(command, typer.core.TyperCommand)
        command.make_context("seaglint", list(rest))


class Typist:
    """A user who types one example after the other in one folder, and no line twice."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.typed: set[str] = set()

    def types(self, name: str) -> None:
        """Type what is new of an example."""
        program = f"{shlex.quote(sys.executable)} -m seaglint.cli.app "
        new = [line for line in whole(EXAMPLES[name]) if line not in self.typed]
        for line in new:
            done = self.shell(line.replace("seaglint ", program, 1) if line.startswith("seaglint ") else line)
            assert done.returncode == 0, f"{line}\n{done.stderr}"
            self.typed.add(line)

    def shell(self, line: str) -> subprocess.CompletedProcess[str]:
        """A line done by the shell."""
        return subprocess.run(line, shell=True, cwd=self.folder, capture_output=True, text=True, check=False, timeout=7200)


@pytest.fixture(scope="module")
def typist(tmp_path_factory) -> Typist:
    return Typist(tmp_path_factory.mktemp("examples"))


def type_here(line: str, seaglint) -> None:
    """A line in this process, which has most modules loaded; by the shell where it is none of ours."""
    if not line.startswith("seaglint "):
        subprocess.run(line, shell=True, check=True)
        return
    words, _, file = line.partition(" > ")
    answer = seaglint(*shlex.split(words)[1:])
    assert answer.code == 0, f"{line}\n{answer.err}"
    if file:
        Path(file).write_text(answer.out)


@pytest.mark.parametrize("name", QUICK)
def test_quick_examples_work_in_an_empty_folder(name: str, tmp_path: Path, seaglint, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    for line in whole(EXAMPLES[name]):
        type_here(line, seaglint)


@pytest.fixture(scope="module")
def rendered_once(tmp_path_factory) -> Callable[..., Path]:
    """The renderer, which copies the store of a scenario and frames that it made before."""
    from seaglint.studies.sequence.render_sequence import render

    folder, made = tmp_path_factory.mktemp("rendered"), {}

    def once(scenario, output: Path, *, frames: range, resume: bool = False, **more: Any) -> Path:
        key = (scenario.model_dump_json(), frames)
        if key in made and not output.exists():
            shutil.copytree(made[key], output)
            resume = True
        done = render(scenario, output, frames=frames, resume=resume, **more)
        if key not in made:
            made[key] = Path(shutil.copytree(output, folder / f"{len(made)}.zarr"))
        return Path(done)

    return once


@pytest.mark.validation
@pytest.mark.parametrize("order", [1, 2])
def test_examples_work_in_any_order_with_every_line_typed_each_time(order: int, rendered_once, tmp_path, seaglint, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("seaglint.studies.sequence.render_sequence.render", rendered_once)
    # The figures of the article, minutes each, read nothing in the folder and are typed by the tests below.
    names = [name for name in EXAMPLES if not name.startswith("reproduce")]
    random.Random(order).shuffle(names)
    for name in names:
        lines = whole(EXAMPLES[name])
        for line in lines[:-1] if name in ELSEWHERE else lines:
            type_here(line, seaglint)


@pytest.mark.validation
@pytest.mark.parametrize("name", [name for name in EXAMPLES if name not in (*QUICK, *ELSEWHERE)])
def test_all_other_examples_work_one_after_the_other(name: str, typist: Typist) -> None:
    typist.types(name)


@pytest.mark.validation
def test_the_example_of_the_viewer_serves_until_it_is_interrupted(typist: Typist) -> None:
    pytest.importorskip("nicegui")
    typist.types("info")
    command = [sys.executable, "-m", "seaglint.cli.app", *shlex.split(EXAMPLES["view"][-1])[1:], "--no-browser"]
    with subprocess.Popen(command, cwd=typist.folder, stdout=subprocess.PIPE, text=True) as server:
        assert server.stdout is not None
        try:
            address = server.stdout.readline().strip()
            with urllib.request.urlopen(address, timeout=600) as page:
                assert page.status == 200
        finally:
            server.send_signal(signal.SIGINT)
            assert server.wait(600) in (0, 130)
