"""Two writers never mix one sequence, and a killed one blocks nobody."""

from __future__ import annotations

import shutil
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

from seaglint.base.errors import DataError
from seaglint.optics.band import Band
from seaglint.store import writers
from seaglint.store.layout import Layout
from seaglint.store.sequence_store import open_sequence, partial_path, write_sequence
from seaglint.store.writers import exclusive, lock_path

LAYOUT = Layout(np.arange(4.0), np.arange(3.0), range(4), 25.0, Band.rectangular(3.5, 5.0))

OTHER = """
import sys
import numpy as np
from seaglint.store.layout import Layout
from seaglint.store.sequence_store import write_sequence
from seaglint.optics.band import Band

def frame(number):
    if number == 2:
        print("at 2", flush=True)
        sys.stdin.readline()
    return {"radiance": np.full((3, 4), 100 + number, np.float32)}

write_sequence(sys.argv[1], Layout(np.arange(4.0), np.arange(3.0), range(4), 25.0, Band.rectangular(3.5, 5.0)), frame)
"""


def frame(number: int) -> dict[str, np.ndarray]:
    return {"radiance": np.full((3, 4), number, np.float32)}


def never(number: int) -> np.ndarray:
    raise AssertionError("computed although another process writes there")


@pytest.fixture
def output(tmp_path: Path) -> Path:
    return tmp_path / "run.zarr"


@pytest.fixture
def other(output: Path) -> Iterator[subprocess.Popen[str]]:
    """Process that has written frames 0 and 1 and waits in frame 2 for a line."""
    with subprocess.Popen([sys.executable, "-c", OTHER, output], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "at 2\n"
        yield process
        process.kill()


def test_a_second_process_is_refused_and_the_first_one_finishes(output, other):
    for choice in ({}, {"resume": True}, {"overwrite": True}):
        with pytest.raises(DataError, match=rf"written by another process \(pid {other.pid}\); wait for it or choose another name$"):
            write_sequence(output, LAYOUT, never, **choice)
    other.communicate("go on\n", timeout=600)
    assert other.returncode == 0
    with open_sequence(output) as found:
        np.testing.assert_array_equal(found["radiance"][:, 0, 0], [100, 101, 102, 103])
    assert [file.name for file in output.parent.iterdir()] == ["run.zarr"]


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="no SIGKILL here")
def test_a_killed_process_blocks_nobody(output, other):
    other.kill()
    other.wait(600)
    assert lock_path(partial_path(output)).exists()
    write_sequence(output, LAYOUT, frame, resume=True)
    with open_sequence(output) as found:
        np.testing.assert_array_equal(found["radiance"][:, 0, 0], [100, 101, 2, 3])
    assert [file.name for file in output.parent.iterdir()] == ["run.zarr"]


def test_a_claim_ends_with_its_context_and_leaves_no_file(output):
    with exclusive(output) as first, pytest.raises(DataError, match="another process"), exclusive(output):
        pass
    with exclusive(output) as second:
        assert second.token != first.token
        assert second.holds()
        assert not first.holds()
    assert list(output.parent.iterdir()) == []


def test_without_locks_the_earlier_writer_stops(output, monkeypatch):
    monkeypatch.setattr(writers, "_lock", lambda descriptor: True)

    def taken(number: int) -> np.ndarray:
        if number == 2:
            write_sequence(output, LAYOUT, lambda other: frame(100 + other), resume=True)
        return frame(number)

    with pytest.raises(DataError, match="another process has taken it"):
        write_sequence(output, LAYOUT, taken)
    with open_sequence(output) as found:
        np.testing.assert_array_equal(found["radiance"][:, 0, 0], [0, 1, 102, 103])


def remove_a_frame(partial: Path) -> None:
    (partial / "frame_done" / "c" / "1").unlink()


def remove_all(partial: Path) -> None:
    shutil.rmtree(partial)


def remove_claim(partial: Path) -> None:
    lock_path(partial).unlink()


@pytest.mark.parametrize(
    ("harm", "words"), [(remove_a_frame, "1 of 4 frames are missing"), (remove_all, "moved or removed"), (remove_claim, "lock was removed")]
)
@pytest.mark.parametrize("at", [2, 4], ids=["between frames", "before the name is given"])
def test_what_was_tampered_with_does_not_get_its_name(output, at, harm: Callable[[Path], None], words):
    def progress(done: int, total: int) -> None:
        if done == at:
            harm(partial_path(output))

    with pytest.raises(DataError, match=words):
        write_sequence(output, LAYOUT, frame, progress=progress)
    assert not output.exists()
