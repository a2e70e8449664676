"""A process that stops at any point and continues later changes no byte and leaves no file: real processes, stopped by signals."""

from __future__ import annotations

import os
import shutil
import signal
import threading
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import toy_store
import zarr
from frozen_workers import FreezingWorkers, Stopped, WakingWorkers, tree
from toy_store import frame, layout

from seaglint.base.errors import DataError
from seaglint.cluster import ThisProcess
from seaglint.store.missing_frames import Interrupted, unit_maker
from seaglint.store.sequence_store import finish_sequence, partial_path, write_sequence
from seaglint.store.staging import remove_folder
from seaglint.store.writers import Share, lock_path
from seaglint.studies.sequence.sequence_work import spread_over

pytestmark = pytest.mark.skipif(not hasattr(signal, "SIGSTOP"), reason="no SIGSTOP here")

#: Points at which a worker stops: while a frame is drawn, after the check of the claim before each step of writing, and before the
#: attempt gets its name.
POINTS = [
    ("toy_store:frame", 3),
    ("seaglint.store.staged_store:_write", 1),
    ("os:rename", 1),
    *(
        pytest.param(call, nth, marks=pytest.mark.validation)
        for call, nth in (("toy_store:frame", 1), ("seaglint.store.staged_store:_write", 3), ("os:mkdir", 1), ("os:mkdir", 2))
    ),
]

OTHER = '{"sea": {"wind": {"speed_m_s": 9.0}}}'


@pytest.fixture
def output(tmp_path: Path) -> Path:
    (tmp_path / "out").mkdir()
    (tmp_path / "worker").mkdir()
    return tmp_path / "out" / "run.zarr"


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    folder = tmp_path_factory.mktemp("whole")
    write_sequence(folder / "run.zarr", layout(), frame)
    return tree(folder)


@pytest.fixture(scope="module")
def other_whole(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    folder = tmp_path_factory.mktemp("other")
    write_sequence(folder / "run.zarr", layout(OTHER), toy_store.other_frame)
    return tree(folder)


@pytest.mark.parametrize(("call", "nth"), POINTS)
@pytest.mark.parametrize("moment", ["end", "overwrite", "second job"])
def test_a_worker_that_wakes_late_changes_nothing(output: Path, whole, other_whole, call: str, nth: int, moment: str) -> None:
    with FreezingWorkers(output.parents[1] / "worker", call, nth, place=2) as workers:
        write_sequence(output, layout(), frame, spread=spread_over(workers, toy_store.prepared, None))
        assert workers.stopped is not None
        assert tree(output.parent) == whole
        if moment == "end":
            workers.stopped.wake()
            assert tree(output.parent) == whole
            return
        team = ThisProcess() if moment == "overwrite" else WakingWorkers(workers.stopped.wake)
        write_sequence(output, layout(OTHER), frame, overwrite=True, spread=spread_over(team, toy_store.prepared_other, None))
        assert tree(output.parent) == other_whole
        workers.stopped.wake()
        assert tree(output.parent) == other_whole


@pytest.mark.parametrize(
    ("call", "nth"), [("toy_store:frame", 1), ("os:replace", 1), ("os:replace", 4), ("os:replace", 9), ("os:rename", 1)]
)
@pytest.mark.parametrize("moment", ["while it works", "at the end"])
def test_a_share_that_lost_its_locks_and_wakes_late_changes_nothing(output: Path, whole, call: str, nth: int, moment: str) -> None:
    """On a network disk the locks of a machine that does not answer can be given to others; here their files are removed."""
    code = "import sys, frozen_workers, toy_store; frozen_workers.share_that_stops(*sys.argv[1:])"
    worker = output.parents[1] / "worker"
    with Stopped(worker, code, worker, call, nth, output) as stopped:
        woken = []

        def waking(number: int):
            if moment == "while it works" and not woken:
                woken.append(number)
                stopped.wake()
            return frame(number)

        with pytest.raises(DataError, match="is being written by another process"):
            write_sequence(output, layout(), frame, share=Share(0, 2))
        if partial_path(output).exists():
            with pytest.raises(DataError, match="is being written by another process"):
                finish_sequence(output)
        for path in output.parent.glob("*.lock"):
            path.unlink()
        for index in (0, 1):
            write_sequence(output, layout(), waking, share=Share(index, 2))
        finish_sequence(output)
        assert tree(output.parent) == whole
        stopped.wake()
        assert tree(output.parent) == whole


def test_a_worker_never_makes_the_stage_anew(output: Path) -> None:
    """The folder of stages is removed while a worker writes: one line, and nothing is there afterwards."""

    def removing(number: int):
        if number == 5:
            shutil.rmtree(f"{partial_path(output)}.units")
        return frame(number)

    def prepared(_: None):
        return layout(), removing

    with pytest.raises(DataError, match=r"frames were not made.*something was moved or removed while it was written"):
        write_sequence(output, layout(), frame, spread=spread_over(ThisProcess(), prepared, None))
    assert sorted(path.name for path in output.parent.iterdir()) == ["run.zarr.partial", "run.zarr.partial.errors"]


def test_what_killed_processes_left_is_removed(output: Path, whole) -> None:
    worker = output.parents[1] / "worker"
    code = "import sys, frozen_workers, toy_store; frozen_workers.share_that_stops(*sys.argv[1:])"
    with Stopped(worker, code, worker, "os:replace", 9, output):
        pass
    assert lock_path(Path(f"{partial_path(output)}.share-0-of-2")).exists()
    assert os.listdir(f"{partial_path(output)}.units")
    write_sequence(output, layout(), frame, share=Share(1, 2))
    write_sequence(output, layout(), frame, resume=True)
    assert tree(output.parent) == whole


@pytest.mark.parametrize("fails", [False, True])
def test_a_late_attempt_does_not_replace_a_unit_at_an_interruption(output: Path, fails: bool) -> None:
    """The slow attempt of another processor ends after its unit was taken from the quick one, whole or with a failed frame."""
    go, begun = threading.Event(), threading.Event()

    def other(number: int):
        begun.set()
        go.wait(60.0)
        if fails and number == 2:
            raise OSError("the disk of one worker")
        return {name: values * (1 + 1e-6) for name, values in frame(number).items()}

    @contextmanager
    def spread(task, units):
        slow, quick = unit_maker(task, layout(), other), unit_maker(task, layout(), frame)

        def late() -> None:
            with suppress(OSError):
                slow(0)

        def outcomes():
            thread = threading.Thread(target=late)
            thread.start()
            begun.wait(60.0)
            yield quick(0)
            go.set()
            thread.join()
            raise KeyboardInterrupt

        yield outcomes()

    with pytest.raises(Interrupted):
        write_sequence(output, layout(), frame, spread=spread)
    group: Any = zarr.open_group(partial_path(output), mode="r")
    made = int(group["frame_done"].chunks[0])
    assert group["frame_done"][:made].all()
    for number in range(made):
        np.testing.assert_array_equal(group["radiance"][number], frame(number)["radiance"])


def test_unfinished_work_stays_if_it_cannot_be_kept(tmp_path: Path) -> None:
    folder = tmp_path / "stage"
    (folder / "scene").mkdir(parents=True)

    def keep(gone: Path) -> None:
        raise OSError("no room")

    with pytest.raises(OSError, match="no room"):
        remove_folder(folder, keep)
    (left,) = tmp_path.iterdir()
    assert (left / "scene").is_dir()
