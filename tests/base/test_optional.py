"""Optional packages: requirements as in pyproject.toml, and messages that say how to install what is missing."""

from __future__ import annotations

import ast
import shlex
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path

import pytest

from seaglint.base.errors import BackendError
from seaglint.base.optional import REQUIREMENTS, missing, optional, remedy, requirement
from seaglint.cli.doctor import EXTRAS

ROOT = Path(__file__).resolve().parents[2]
DEVELOPERS = {"dev", "bench", "docs", "bands", "readers"}
"""Extras of which no message speaks."""

NAMES = [text.split(">=")[0] for text in REQUIREMENTS]


def test_requirements_are_those_of_the_extras() -> None:
    extras = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["optional-dependencies"]
    assert list(REQUIREMENTS) == sorted(text for name, texts in extras.items() if name not in DEVELOPERS for text in texts)


@pytest.mark.parametrize("name", NAMES)
def test_a_shell_takes_the_remedy(name: str) -> None:
    assert shlex.split(remedy(name)) == ["pip", "install", requirement(name)]


def named(path: Path) -> Iterator[str]:
    """Packages that calls in a file name."""
    place = {"requirement": 0, "remedy": 0, "missing": 1, "optional": 0}
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in place and node.args:
            given = node.args[place[node.func.id]]
            if isinstance(given, ast.Constant):
                module = given.value.split(".")[0]
                yield module.replace("_", "-")


def test_every_package_that_the_source_names_has_a_requirement() -> None:
    found = {name for path in (ROOT / "src").rglob("*.py") for name in named(path)}
    assert found == set(NAMES)
    assert set(EXTRAS) <= set(NAMES)


@pytest.mark.parametrize(
    ("module", "package"),
    [("imagecodecs", "imagecodecs>=2024.6"), ("arviz_stats.base.array", "arviz-stats>=0.6"), ("dask_jobqueue", "dask-jobqueue>=0.9")],
)
def test_a_module_that_is_missing_is_one_line(module: str, package: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(BackendError) as caught:
        optional(module, "this")
    assert str(caught.value) == f"this needs {package.split('>')[0]}, which is not installed; pip install '{package}'"


def test_what_can_be_done_without_it_ends_the_line() -> None:
    assert str(missing("Parquet", "pyarrow", "or use .csv")).endswith("pip install 'pyarrow>=17', or use .csv")
