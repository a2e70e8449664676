"""Every command of the program has its function in ``sg``, with the same parameters and the same words."""

from __future__ import annotations

import inspect
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import seaglint as sg
from seaglint.cli.app import Commands

TERMINAL = {"view", "doctor"}
"""Commands of a terminal alone, beside completion, which is an option of the program."""

SHOWN = {"as_json", "show", "preview", "scale", "report", "plot", "every_tail", "everything", "presets", "dask", "dask_slurm", "csv"}
"""Options of what a terminal prints, draws and connects: in Python results are values with ``plot()``, and ``workers`` takes a cluster."""

RETURNED = {
    **{name: {"output", "overwrite"} for name in ("mean", "compare", "likelihood", "analyze", "weather info", "sensor")},
    **{name: {"output", "overwrite"} for name in ("atmosphere info", "atmosphere path", "atmosphere sky", "texture compare")},
    **{f"reproduce {name}": {"output", "overwrite"} for name in ("fig2", "fig3", "fig4", "fig5", "fig10", "table1", "measured")},
    **{f"detect {name}": {"output", "overwrite", "resume"} for name in ("recording", "scene", "design", "range")},
    "sweep": {"output", "overwrite", "resume"},
}
"""Options of files for results that a function returns."""


def leaves(name: str, command: Any) -> Iterator[tuple[str, Any]]:
    """Yield the commands below a command by their names."""
    inner = getattr(command, "commands", None)
    if not inner:
        yield name, command
        return
    for each, below in inner.items():
        yield from leaves(f"{name} {each}", below)


COMMANDS = dict(leaf for name, command in Commands().items() if name not in TERMINAL for leaf in leaves(name, command))


def function_of(command: str) -> Any:
    """Return the function of a command."""
    words = command.replace("-", "_").split()
    if words[0] == "detect":
        return getattr(sg, "_".join(words))
    found: Any = sg
    for word in words:
        found = getattr(found, word)
    return found


@pytest.mark.parametrize("command", COMMANDS)
def test_a_command_has_its_function_with_its_parameters(command: str) -> None:
    parameters = set(inspect.signature(function_of(command)).parameters)
    options = {parameter.name for parameter in COMMANDS[command].params} - {"help"}
    same = {"recording": "radiance"} if command == "sense" else {}
    missing = {same.get(name, name) for name in options - SHOWN - RETURNED.get(command, set())} - parameters
    assert missing == set()


PYTHON = {"progress", "workers", "output", "overwrite"}
"""Parameters of Python: reports of progress, a cluster, and a file where a command always writes or prints."""

ALLOWED = {"sweep": {"lazy"}, "sense": {"radiance", "units", "raw"}}


@pytest.mark.parametrize("command", COMMANDS)
def test_a_function_has_no_parameter_that_its_command_lacks(command: str) -> None:
    parameters = set(inspect.signature(function_of(command)).parameters)
    options = {parameter.name for parameter in COMMANDS[command].params}
    assert parameters - options - PYTHON - ALLOWED.get(command, set()) == set()


@pytest.mark.parametrize("command", COMMANDS)
def test_a_function_says_what_its_command_says(command: str) -> None:
    help_text, documentation = COMMANDS[command].help, inspect.getdoc(function_of(command))
    assert help_text is not None
    assert documentation is not None
    assert documentation.partition("\n")[0] == help_text.partition("\n")[0]


@pytest.mark.parametrize(
    "before",
    [
        "",
        "import seaglint.textures, seaglint.climate, seaglint.air",
        "import seaglint.studies.texture.texture_sequences",
        "import seaglint.api",
    ],
)
@pytest.mark.parametrize("after", ["", "import seaglint.textures, seaglint.climate, seaglint.cli.texture"])
def test_functions_of_groups_are_there_in_any_order_of_imports(before: str, after: str) -> None:
    code = (
        f"{before}\nimport seaglint as sg\n{after}\nnames = (sg.texture.fit, sg.weather.info, sg.atmosphere.sky, sg.evaluate.mean)\n"
        "print(all(map(callable, names)), callable(sg.sensor), callable(sg.detect_range))"
    )
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.strip() == "True True True"


def test_public_names_alone_are_listed() -> None:
    assert dir(sg) == sorted(sg.__all__)
    assert not [name for name in dir(sg) if name.startswith("_") and name != "__version__"]


def test_the_guide_names_every_command_and_function() -> None:
    guide = (Path(__file__).resolve().parents[1] / "docs/guide/python.md").read_text(encoding="utf-8")
    table = guide.partition("## Commands and functions")[2].partition("\n## ")[0]
    for command in COMMANDS:
        first, *rest = command.split()
        assert f"`seaglint {first}" in table
        if first != "reproduce":
            assert all(word in table for word in rest), command
