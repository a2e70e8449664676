"""A user's own function plugs in by its module path, and what it gets wrong is said in one line."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from seaglint.detection.base import Detector, load, statistics
from seaglint.detection.choice import named
from seaglint.errors import DataError

SOURCE = """
import numpy as np

def bright(frames):
    frames -= frames.mean()
    return frames

def step(frames):
    return frames[1:] - frames[:-1]
step.lead = 1

def late(frames):
    return frames[1:]

def words(frames):
    return "many"

def breaks(frames):
    return frames[99]

class Scaled:
    name = "scaled"
    lead = 0
    calibrated = True
    def __call__(self, frames):
        return frames / 2

class Picky:
    def __init__(self, gain): ...

number = 3
"""


@pytest.fixture
def module(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    (tmp_path / "my_detectors_of_test.py").write_text(SOURCE)
    (tmp_path / "broken_of_test.py").write_text("import nothing_of_that_name\n")
    monkeypatch.chdir(tmp_path)
    return "my_detectors_of_test"


def test_function_object_and_class_plug_in(module: str) -> None:
    x = np.random.default_rng(1).standard_normal((4, 5, 6)).astype(np.float32)
    before = x.copy()
    bright, step, scaled = (named(f"{module}:{n}") for n in ("bright", "step", "Scaled"))
    assert isinstance(bright, Detector)
    assert bright(x) == pytest.approx(x - x.mean(), abs=1e-6)
    assert np.array_equal(x, before)
    assert np.array_equal(np.concatenate(list(statistics(step, [x[:2], x[2:]]))), np.diff(x, axis=0))
    assert (scaled.name, scaled.calibrated, step.lead, bright.calibrated) == ("scaled", True, 1, False)


@pytest.mark.parametrize(
    ("path", "says"),
    [
        ("nothing", "unknown; choose ca-cfar"),
        (":x", "form"),
        ("no_such_module_at_all:f", "cannot be imported"),
        ("broken_of_test:f", "nothing_of_that_name"),
        ("my_detectors_of_test:absent", "has no absent"),
        ("my_detectors_of_test:number", "cannot be called"),
        ("my_detectors_of_test:Picky", "needs arguments"),
    ],
)
def test_path_that_leads_nowhere_is_said(module: str, path: str, says: str) -> None:
    with pytest.raises(DataError, match=says) as error:
        named(path)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(("name", "says"), [("late", "lead, now 0"), ("words", "array of numbers"), ("breaks", "IndexError")])
def test_wrong_results_are_said(module: str, name: str, says: str) -> None:
    with pytest.raises(DataError, match=says):
        load(f"{module}:{name}")(np.zeros((3, 4, 5), np.float32))


@pytest.mark.parametrize("name", ["ca-cfar", "OS_CFAR", "frame-difference", "integration"])
def test_our_detectors_have_names(name: str) -> None:
    detector = named(name)
    assert isinstance(detector, Detector)
    assert detector.name == name.lower().replace("_", "-")
