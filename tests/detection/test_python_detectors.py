"""Detectors given in Python: functions, lambdas, objects and classes, with the errors of their results and the end of those that hang."""

from __future__ import annotations

import functools
import math
import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import seaglint as sg
from seaglint.base.errors import DataError
from seaglint.detection.cfar import CellAveraging
from seaglint.detection.interface import detector_of, load
from seaglint.detection.isolated import IsolatedDetector, running

NOISE = np.random.default_rng(1).normal(10.0, 0.5, (8, 64, 64)).astype(np.float32)
HOW: dict[str, Any] = {"threshold": 3.0, "injections": 60}
FRAMES = np.ones((2, 8, 8), np.float32)
GAIN = 2.0


def less_mean(frames: np.ndarray) -> np.ndarray:
    """Change the frames in place."""
    frames -= frames.mean(axis=(1, 2), keepdims=True)
    return frames


class Scaled:
    """Object with a state."""

    name = "scaled"
    reach = 0

    def __init__(self, gain: float = GAIN) -> None:
        self.gain = gain

    def __call__(self, frames: np.ndarray) -> np.ndarray:
        return self.gain * frames


def closure(gain: float) -> Any:
    return lambda frames: gain * (frames - frames.mean(axis=(1, 2), keepdims=True))


FORMS = {
    "less_mean": less_mean,
    "lambda": lambda frames: GAIN * frames,
    "closure": closure(3.0),
    "object": Scaled(3.0),
    "class": Scaled,
    "method": Scaled(2.0).__call__,
    "partial": functools.partial(less_mean),
    "of the package": CellAveraging(),
    "nothing": None,
}


@pytest.mark.parametrize("form", sorted(FORMS))
def test_every_form_of_a_detector_is_taken(form: str) -> None:
    before = NOISE.copy()
    found = sg.detect(NOISE, [1.0, 5.0], detector=FORMS[form], level=0.9, **HOW)
    assert np.array_equal(NOISE, before)
    assert found["level"] == 0.9
    assert found["sweep"][1]["p_d"] == 1.0
    # 32,768 pixels above 3 sigma: Q(3) of them, within 5 standard deviations of the count; CFAR loses its border and has heavier tails
    assert found["p_fa"] == pytest.approx(1.35e-3, abs=1.1e-3)


@pytest.mark.parametrize("form", ["closure", "less_mean", "object"])
def test_the_process_changes_no_number(form: str) -> None:
    here = sg.detect(NOISE, [1.0, 5.0], detector=FORMS[form], time_limit=math.inf, **HOW)
    assert here.as_dict() == sg.detect(NOISE, [1.0, 5.0], detector=FORMS[form], **HOW).as_dict()


def test_a_function_is_the_detector_of_its_file(tmp_path: Path) -> None:
    path = tmp_path / "of a user.py"
    path.write_text("class Made:\n    name = 'scaled'\n    reach = 0\n    def __call__(self, x):\n        return 2.0 * x\n")
    by_path = sg.detect(NOISE, [1.0, 5.0], detector=f"{path}:Made", **HOW)
    assert by_path.as_dict() == sg.detect(NOISE, [1.0, 5.0], detector=Scaled, **HOW).as_dict()
    with pytest.raises(DataError, match="has no other"):
        load(f"{path}:other")
    with pytest.raises(DataError, match="cannot be imported: FileNotFoundError"):
        load(f"{tmp_path / 'none.py'}:other")


def test_several_detectors_are_varied_and_named() -> None:
    found = sg.detect_recording(NOISE, contrast=5.0, vary={"detector": [Scaled(2.0), "matched", None]}, **HOW)
    assert [case["parameters"]["detector"] for case in found["cases"]] == ["scaled", "matched", None]
    assert [case["detector"] for case in found["cases"]] == ["scaled", "matched", "threshold"]


def test_analysis_takes_functions_and_ends_their_processes() -> None:
    found = sg.analyze(NOISE, filter="none", detectors=[less_mean, Scaled(2.0), "ca-cfar"])
    assert list(found.regions["all"].alarms)[-3:] == ["less_mean", "scaled", "ca-cfar"]
    with pytest.raises(DataError, match=r"longer than 0\.5 s"):
        sg.analyze(NOISE, filter="none", detectors=hang, time_limit=0.5)


def hang(frames: np.ndarray) -> np.ndarray:
    while frames.size:
        pass
    return frames


async def later(frames: np.ndarray) -> np.ndarray:
    return frames


def steps(frames: np.ndarray) -> Any:
    yield frames


class Lazy:
    """Array that is computed when its numbers are needed, and fails there."""

    def __array__(self, dtype: Any = None, copy: Any = None) -> np.ndarray:
        raise RuntimeError("no memory\nfor this")


WRONG = {
    "fewer rows": (lambda frames: frames[:, 1:], r"returned shape \(2, 7, 8\) for frames of shape \(2, 8, 8\)"),
    "one picture": (lambda frames: frames[0], r"returned shape \(8, 8\)"),
    "nothing": (lambda frames: None, "returned NoneType; an array of real numbers"),
    "a list": (lambda frames: [1.0, 2.0], r"returned shape \(2,\)"),
    "a ragged list": (lambda frames: [[1.0], [1.0, 2.0]], "returned list; an array"),
    "complex": (lambda frames: 1j * frames, "returned an array of complex64"),
    "objects": (lambda frames: frames.astype(object), "returned an array of object"),
    "text": (lambda frames: frames.astype(str), "returned an array of <U"),
    "lazy": (lambda frames: Lazy(), "returned Lazy: RuntimeError: no memory for this"),
    "a generator": (steps, "returned generator"),
    "an error": (lambda frames: 1 / 0, "failed on frames of shape .*ZeroDivisionError"),
    "no argument": (lambda: FRAMES, "failed on frames of shape .*TypeError"),
}


@pytest.mark.parametrize("kind", sorted(WRONG))
def test_wrong_results_are_reported_in_one_line(kind: str) -> None:
    function, message = WRONG[kind]
    detector = detector_of(function)
    assert not isinstance(detector, str | None)
    with pytest.raises(DataError, match=message) as error:
        detector(FRAMES)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("function", "message"),
    [
        (lambda frames: np.nan * frames, "gives no statistic in any pixel"),
        (lambda frames: np.full(frames.shape, 1e300), "gives no statistic in any pixel"),
        (lambda frames: 0.0 * frames, "the statistic is 0 in every pixel"),
        (lambda frames: sys.exit(3), r"ended its process \(exit code 3\)"),
        (later, "returned coroutine"),
        (lambda frames, lock=threading.Lock(): frames, "cannot be copied to another process: TypeError: .*lock.*time_limit=math.inf"),  # noqa: B008
        (3, "detector = 3 cannot be called"),
        ([less_mean], "cannot be called"),
    ],
    ids=["NaN", "infinite", "constant", "exit", "coroutine", "lock", "number", "list"],
)
def test_detectors_that_cannot_be_judged(function: Any, message: str) -> None:
    with pytest.raises(DataError, match=message) as error:
        sg.detect(NOISE, [1.0], detector=function, **HOW)
    assert "\n" not in str(error.value)


def test_an_object_that_cannot_be_copied_runs_here_without_a_limit() -> None:
    calls: list[int] = []
    lock = threading.Lock()

    def counted(frames: np.ndarray) -> np.ndarray:
        with lock:
            calls.append(len(frames))
        return frames

    assert sg.detect(NOISE, [5.0], detector=counted, time_limit=math.inf, **HOW)["p_d"] == 1.0
    assert calls


def test_a_returned_array_that_is_used_again_is_copied() -> None:
    kept = np.zeros((2, 8, 8), np.float32)
    detector = detector_of(lambda frames: np.add(frames, 0.0, out=kept))
    assert not isinstance(detector, str | None)
    first = detector(FRAMES)
    detector(2.0 * FRAMES)
    assert np.array_equal(first, FRAMES)


def fork_and_hang(frames: Any) -> Any:
    """The child holds the other end of the connection for a minute."""
    if os.fork() == 0:
        time.sleep(60.0)
        os._exit(0)
    return hang(frames)


@pytest.mark.parametrize("function", [hang, lambda frames: time.sleep(1e6), fork_and_hang], ids=["loop", "sleep", "fork"])
def test_a_detector_that_never_returns_is_ended(function: Any) -> None:
    began = time.monotonic()
    with pytest.raises(DataError, match=r"took longer than 0\.5 s on frames of shape \(8, 64, 64\)") as error:
        sg.detect(NOISE, [1.0], detector=function, time_limit=0.5, **HOW)
    assert "\n" not in str(error.value)
    assert time.monotonic() - began < 60.0  # of a million seconds


def test_a_frozen_process_is_ended_although_it_takes_no_frames() -> None:
    detector = running(detector_of(less_mean) or "", 0.5)
    assert isinstance(detector, IsolatedDetector)
    os.kill(detector._process.pid, signal.SIGSTOP)
    # more than the socket holds: the frames themselves are not taken
    with pytest.raises(DataError, match=r"took longer than 0\.5 s"):
        detector(np.ones((8, 512, 512), np.float32))


SCRIPT = """
import os, sys, time
import seaglint as sg, numpy as np
place = sys.argv[1]
def never(frames):
    with open(place, "w") as file:
        file.write(str(os.getpid()))
    while True:
        pass
noise = np.random.default_rng(1).normal(10.0, 0.5, (4, 32, 32))
sg.detect(noise, [1.0], detector=never, threshold=3.0)
"""


def ended_within(pid: int, seconds: float) -> bool:
    until = time.monotonic() + seconds
    while time.monotonic() < until:
        try:
            state = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]
        except OSError:
            return True
        if state == "Z":
            return True
        time.sleep(0.1)
    return False


@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="needs the states of processes")
@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGINT], ids=["killed", "interrupted"])
def test_the_process_of_a_detector_ends_with_the_calling_one(how: signal.Signals, tmp_path: Path) -> None:
    file = tmp_path / "pid"
    # A function of a script, which its process cannot import.
    with subprocess.Popen([sys.executable, "-", str(file)], stdin=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        assert process.stdin is not None
        assert process.stderr is not None
        process.stdin.write(SCRIPT)
        process.stdin.close()
        until = time.monotonic() + 120.0
        while not (file.exists() and file.read_text()) and process.poll() is None and time.monotonic() < until:
            time.sleep(0.1)
        process.send_signal(how)
        errors = process.stderr.read()
        process.wait()
    assert ended_within(int(file.read_text()), 20.0)
    # One traceback of the interruption, none of the detector's process.
    assert errors.count("Traceback") == (how == signal.SIGINT)


CELLS = (
    "import numpy as np, seaglint as sg\ngain = 2.0\nnoise = np.random.default_rng(1).normal(10.0, 0.5, (4, 32, 32))",
    "class Doubled:\n    def __call__(self, frames):\n        print('called')\n        return gain * frames",
    "how = dict(threshold=3.0, injections=20)\n"
    "print([sg.detect(noise, [9.0], detector=one, **how)['p_d'] for one in (Doubled(), lambda x: gain * x, None)])",
    "def never(frames):\n    while True:\n        pass",
    "try:\n    sg.detect(noise, [9.0], detector=never, time_limit=1, **how)\nexcept Exception as error:\n    print(error)",
)


def test_a_notebook_defines_its_detectors() -> None:
    nbformat, nbclient = pytest.importorskip("nbformat"), pytest.importorskip("nbclient")
    pytest.importorskip("ipykernel")
    book = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(cell) for cell in CELLS])
    nbclient.NotebookClient(book, timeout=500, kernel_name="python3").execute()
    texts = ["".join(out.get("text", "") for out in cell.outputs if out.get("name") == "stdout") for cell in book.cells]
    assert "[1.0, 1.0, 1.0]" in texts[2]
    assert "detector never took longer than 1 s" in texts[4]
