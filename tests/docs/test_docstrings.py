"""The validation of docstrings finds faults, and passes what follows the house."""

from __future__ import annotations

import sys
from types import ModuleType

import pytest

docstrings = pytest.importorskip("docstrings", reason="numpydoc is not installed")

GOOD = """Add two lengths.

    Parameters
    ----------
    first : float
        First length [m].
    second : float
        Second length [m].

    Returns
    -------
    float
        Sum [m].
    """


def errors_of(text: str, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Errors in the docstring of a function of two parameters."""

    def total(first: float, second: float) -> float:
        return first + second

    total.__doc__, total.__module__, total.__qualname__ = text, "made", "total"
    module = ModuleType("made", "Made for a test.")
    module.total = total
    monkeypatch.setitem(sys.modules, "made", module)
    monkeypatch.setattr(docstrings, "SHOWN", {"made.total"})
    return list(docstrings.errors_of(module))


def test_a_good_docstring_passes(monkeypatch: pytest.MonkeyPatch) -> None:
    assert errors_of(GOOD, monkeypatch) == []


@pytest.mark.parametrize(
    ("right", "wrong", "code"),
    [
        ("Parameters\n", "Arguments\n", "Unknown section Arguments"),
        ("second : float", "third : float", "PR02"),
        ("    second : float\n        Second length [m].\n", "", "PR01"),
        ("    Returns\n    -------\n    float\n        Sum [m].\n", "", "RT01"),
        ("Add two lengths.\n\n    ", "", "SS01"),
        ("lengths.", "``lengths.", "Inline literal"),
    ],
)
def test_faults_are_found(right: str, wrong: str, code: str, monkeypatch: pytest.MonkeyPatch) -> None:
    assert right in GOOD
    found = errors_of(GOOD.replace(right, wrong, 1), monkeypatch)
    assert any(code in error for error in found), found


def test_errors_have_the_name_of_the_function(monkeypatch: pytest.MonkeyPatch) -> None:
    assert all(error.startswith("made.total: ") for error in errors_of(GOOD.replace("second :", "third :"), monkeypatch))
