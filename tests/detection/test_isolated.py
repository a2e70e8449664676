"""A user's detector in its own process: every fault is named as its own, and none takes the program with it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from seaglint.analysis import Recording
from seaglint.base.errors import DataError, DomainError
from seaglint.detection.isolated import IsolatedDetector
from seaglint.detection.spot import GaussianSpot
from seaglint.detection.trials import InjectedObjects
from seaglint.studies.detect.performance import DetectionOptions, detect

SOURCE = """
import os, time
import numpy as np

print("said while it is imported")

calls = 0

class Faulty:
    # Frames tell what goes wrong: one process does for all faults but those that end it.
    name = "faulty"
    reach = 0
    def __call__(self, frames):
        kind = int(frames[0, 0, 0])
        if kind == 1:
            raise KeyError("no such key")
        if kind == 2:
            return frames[:, :3]
        if kind == 3:
            return "words"
        if kind == 4:
            time.sleep(3600)
        if kind == 5:
            os._exit(7)
        return 2 * frames

def later(frames):
    global calls
    calls += 1
    if calls > 3:
        raise RuntimeError("tired")
    return frames
later.reach = 0

def silent(frames):
    return np.where(frames > 4.5, np.nan, frames)
silent.reach = 0
"""

FRAMES = np.zeros((1, 8, 8), np.float32)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("detectors")
    (folder / "isolated_of_test.py").write_text(SOURCE)
    return folder


def test_faults_are_named_and_the_next_call_is_answered(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(folder)
    detector = IsolatedDetector("isolated_of_test:Faulty", time_limit=600.0)
    assert (detector.name, detector.lead, detector.reach, detector.linear) == ("faulty", 0, 0, False)
    assert np.array_equal(detector(FRAMES + 9), 2 * (FRAMES + 9))
    for kind, says in ((1, "KeyError: 'no such key'"), (2, r"shape \(1, 3, 8\)"), (3, "returned str")):
        with pytest.raises(DataError, match=says) as error:
            detector(FRAMES + kind)
        assert "faulty" in str(error.value)
    assert np.array_equal(detector(FRAMES), FRAMES)
    detector.time_limit = 0.1  # of an hour that this call would take
    with pytest.raises(DataError, match=r"longer than 0\.1 s"):
        detector(FRAMES + 4)
    with pytest.raises(DataError, match="ended before"):
        detector(FRAMES)


def test_a_process_that_ends_is_said(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(folder)
    detector = IsolatedDetector("isolated_of_test:Faulty")
    with pytest.raises(DataError, match="exit code 7"):
        detector(FRAMES + 5)


def test_what_was_computed_before_a_fault_is_kept(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(folder)
    frames = np.random.default_rng(1).normal(0.0, 1.0, (5, 64, 64)).astype(np.float32)
    source = Recording("test", *frames.shape, lambda start, stop: frames[start:stop])
    objects = InjectedObjects(GaussianSpot(0.8), (20.0,), 400, "centre", 0.0)
    found = detect(source, DetectionOptions(objects, "isolated_of_test:later")).as_dict()
    # 36 objects of 9 px each way share a frame of 64 px; the background takes one call, and two batches are done.
    assert found["injections"] == 72
    assert found["p_d"] == 1.0
    assert any("stopped after 72 of 400" in note and "tired" in note for note in found["notes"])
    mute = detect(source, DetectionOptions(objects, "isolated_of_test:silent")).as_dict()
    assert mute["p_d"] == 0.0
    assert any("returns NaN at 400 objects" in note for note in mute["notes"])


def test_modules_that_cannot_be_used(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(folder)
    with pytest.raises(DataError, match="has no absent"):
        IsolatedDetector("isolated_of_test:absent")
    with pytest.raises(DomainError, match="above 0"):
        IsolatedDetector("isolated_of_test:silent", time_limit=0.0)
