"""What ``seaglint --help`` shows: groups, lines that are not cut, completion."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest
from typer.main import get_command

from seaglint.cli.app import GROUPS, app

ROOT = get_command(app)
GROUPED = ("", *(name for name, command in ROOT.commands.items() if hasattr(command, "commands")))  # type: ignore[attr-defined]


def test_every_command_is_in_one_group(seaglint) -> None:
    named = [name for members in GROUPS.values() for name in members]
    assert len(named) == len(set(named))
    assert set(ROOT.commands) == set(named)  # type: ignore[attr-defined]
    told = seaglint("--help").out
    places = [told.index(f"\n{heading}:\n") for heading in GROUPS]
    assert places == sorted(places)
    for name in named:
        assert f"\n  {name} " in told


def test_the_list_of_commands_says_what_their_own_help_begins_with() -> None:
    said = {name: entry.summary for members in GROUPS.values() for name, entry in members.items()}
    assert {name: command.get_short_help_str(1000) for name, command in ROOT.commands.items()} == said  # type: ignore[attr-defined]
    assert [name for name, command in ROOT.commands.items() if command.hidden] == []  # type: ignore[attr-defined]


@pytest.mark.parametrize("name", GROUPED)
def test_no_line_of_a_group_is_cut_on_a_terminal_of_80_columns(name: str, seaglint, monkeypatch) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    told = seaglint(*name.split(), "--help").out
    assert "..." not in told.replace("[ARGS]...", "")
    assert max(map(len, told.splitlines())) < 80


@pytest.mark.parametrize(
    ("words", "wrong", "meant"),
    [(("anlyze",), "anlyze", "analyze"), (("texture", "comprae"), "comprae", "compare"), (("info", "--jsno"), "--jsno", "--json")],
)
def test_a_misspelt_command_or_option_is_answered_with_what_is_meant(words: tuple[str, ...], wrong: str, meant: str, seaglint) -> None:
    answer = seaglint(*words)
    assert answer.code == 2
    assert wrong in answer.err
    assert meant in answer.err


@pytest.mark.parametrize(
    ("shell", "asks"), [("bash", "complete -o default -F"), ("zsh", "#compdef seaglint"), ("fish", "complete --command seaglint")]
)
def test_completion_is_printed_for_the_shell_that_is_named(shell: str, asks: str, seaglint) -> None:
    told = seaglint("--show-completion", shell).out
    assert asks in told
    assert f"_SEAGLINT_COMPLETE=complete_{shell}" in told


def test_completion_is_put_into_the_users_files(tmp_path, seaglint, monkeypatch) -> None:
    monkeypatch.setenv("HOME", str(tmp_path))
    assert seaglint("--install-completion", "bash").code == 0
    script = tmp_path / ".bash_completions" / "seaglint.sh"
    assert str(script) in (tmp_path / ".bashrc").read_text()
    assert "complete_bash" in script.read_text()


def test_a_shell_that_is_not_known_is_refused_with_those_that_are(seaglint) -> None:
    answer = seaglint("--show-completion", "tcsh")
    assert answer.code == 2
    assert all(shell in answer.err for shell in ("tcsh", "bash", "zsh", "fish", "powershell"))


def question(shell: str, words: str) -> dict[str, str]:
    """What a shell asks in its variables when the tab key is pressed behind words."""
    more = {
        "bash": {"COMP_WORDS": words, "COMP_CWORD": str(words.count(" "))},
        "zsh": {"_TYPER_COMPLETE_ARGS": words},
        "fish": {"_TYPER_COMPLETE_ARGS": words, "_TYPER_COMPLETE_FISH_ACTION": "get-args"},
    }
    return {"_SEAGLINT_COMPLETE": f"complete_{shell}", **more[shell]}


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
@pytest.mark.parametrize(
    ("words", "found"),
    [
        ("seaglint dete", "detect"),
        ("seaglint texture co", "compare"),
        ("seaglint detect --match", "--match-radius"),
        ("seaglint detect run.zarr --match", "--match-radius"),
        ("seaglint detect ra", "range"),
        ("seaglint detect range --bear", "--bearings"),
    ],
)
def test_the_shell_completes_commands_and_options(shell: str, words: str, found: str, seaglint, monkeypatch) -> None:
    for name, value in question(shell, words).items():
        monkeypatch.setenv(name, value)
    assert found in seaglint().out


def test_the_tab_key_is_answered_without_the_pipeline() -> None:
    """The answer stands between two keystrokes: nothing heavy is loaded, and of the studies only the records of requests."""
    code = (
        "import atexit, sys; sys.argv = ['seaglint']; from seaglint.cli.app import main\n"
        "atexit.register(lambda: print(*sorted(sys.modules), file=sys.stderr)); main()"
    )
    environment = {**os.environ, **question("bash", "seaglint re")}
    done = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=False, timeout=600)
    assert sorted(done.stdout.split()) == ["render", "reproduce"]
    loaded = done.stderr.splitlines()[-1].split()
    own = {name for name in loaded if name.startswith("seaglint.") and not name.startswith("seaglint.cli")}
    studies = {name for name in own if name.startswith("seaglint.studies")}
    rooms = {name.rpartition(".")[0] for name in studies if name.endswith("requests")} | {"seaglint.studies"}
    assert {name for name in studies if not name.endswith("requests")} <= rooms
    assert own - studies <= {
        "seaglint.base",
        "seaglint.base.errors",
        "seaglint.base.optional",
        "seaglint.base.parameters",
        "seaglint.base.thread_setting",
        "seaglint.detection",  # names of detectors alone, which help pages list
        "seaglint.detection.detector_names",
    }
    assert not {"numpy", "scipy", "numba", "pandas", "xarray", "dask", "zarr", "matplotlib"} & set(loaded)
