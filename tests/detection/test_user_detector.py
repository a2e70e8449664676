"""A user's own function plugs in by its module path, and what it gets wrong is said in one line."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from seaglint.analysis import AnalysisOptions, Recording, analyze
from seaglint.base.errors import DataError
from seaglint.detection.interface import Detector, UserDetector, filled, load, statistics
from seaglint.detection.named_detectors import named

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

def breaks_at_length(frames):
    raise ValueError("first\\n  second")

def turned(frames):
    return 1j * frames

class Scaled:
    name = "scaled"
    lead = 0
    calibrated = True
    def __call__(self, frames):
        return frames / 2

class Picky:
    def __init__(self, gain): ...

class Unmade:
    def __init__(self):
        raise OSError("no\\nweights")
    def __call__(self, frames):
        return frames

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
        ("my_detectors_of_test:Unmade", "no instance of the class can be made: OSError: no weights"),
    ],
)
def test_path_that_leads_nowhere_is_said(module: str, path: str, says: str) -> None:
    with pytest.raises(DataError, match=says) as error:
        named(path)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("late", "lead, now 0"),
        ("words", "array of real numbers"),
        ("turned", "array of real numbers"),
        ("breaks", "IndexError"),
        ("breaks_at_length", "ValueError: first second$"),
    ],
)
def test_wrong_results_are_said(module: str, name: str, says: str) -> None:
    with pytest.raises(DataError, match=says):
        load(f"{module}:{name}")(np.zeros((3, 4, 5), np.float32))


@pytest.mark.parametrize("name", ["ca-cfar", "OS_CFAR", "frame-difference", "integration"])
def test_our_detectors_have_names(name: str) -> None:
    detector = named(name)
    assert isinstance(detector, Detector)
    assert detector.name == name.lower().replace("_", "-")


GUIDE = Path(__file__).parents[2] / "docs" / "guide" / "clutter.md"


def sea_with_gaps() -> np.ndarray:
    """White noise below six even rows of sky, with a dead row, a missing patch and a missing frame."""
    frames = np.random.default_rng(5).normal(100.0, 5.0, (20, 64, 64)).astype(np.float32)
    frames[:, :6] = 7.0
    frames[:, 40] = 0.0
    frames[3, 20:24, 20:30] = np.nan
    frames[8] = np.nan
    return frames


def test_the_detector_of_the_guide_works_on_sky_dead_lines_and_nan(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    code = GUIDE.read_text(encoding="utf-8").split("```python\n# mine.py\n")[1].split("```")[0]
    (tmp_path / "mine_of_the_guide.py").write_text(code)
    monkeypatch.chdir(tmp_path)
    frames = sea_with_gaps()
    recording = Recording("made here", *frames.shape, read_block=lambda start, stop: frames[start:stop], frame_rate=20.0)
    found = analyze(recording, AnalysisOptions(detectors=(named("mine_of_the_guide:detector"),)))
    alarms = found.regions["all"].alarms["mine_of_the_guide:detector"]
    # 57 rows of 64 pixels in 19 frames, less the patch: what is missing is not counted, what is there is, all of it
    assert alarms.pixels == 57 * 64 * 19 - 40
    # Gaussian tail at 3 sigma, 94 expected: 4 standard deviations
    assert alarms.rates()[0].exceedances == pytest.approx(1.349898e-3 * alarms.pixels, abs=4 * 94**0.5)
    assert not any("gave no pixel" in note for note in found.notes)


def test_gaps_take_the_nearest_value_and_what_is_said_of_them_does_not_count() -> None:
    frames = sea_with_gaps()[2:5]
    whole = filled(frames)
    gap = np.isnan(frames)
    assert np.isfinite(whole).all()
    assert np.array_equal(whole[~gap], frames[~gap])
    assert whole[1, 20, 25] == frames[1, 19, 25]
    assert whole[1, 21, 20] == frames[1, 21, 19]
    step = UserDetector(lambda x: x[1:] - x[:-1], "step", lead=1)
    assert np.array_equal(np.isnan(step(frames)), gap[1:] | gap[:-1])
    assert np.isnan(UserDetector(lambda x: x, "own", takes_nan=True)(frames)).sum() == 40
    assert filled(np.full((2, 3, 3), np.nan, np.float32)).tolist() == np.zeros((2, 3, 3)).tolist()


def test_a_detector_without_numbers_is_named() -> None:
    frames = sea_with_gaps()
    recording = Recording("made here", *frames.shape, read_block=lambda start, stop: frames[start:stop])
    notes = analyze(recording, AnalysisOptions(detectors=(UserDetector(lambda x: np.nan * x, "mute"),))).notes
    assert any(note.startswith("detector mute gave no pixel") for note in notes)
