"""A sequence that many write: the same bytes whoever makes which units, and nothing of it lost or damaged unseen."""

from __future__ import annotations

import errno
import logging
import os
import shutil
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import replace
from hashlib import sha256
from pathlib import Path

import numpy as np
import pytest
import toy_store
import zarr
from toy_store import COLUMNS, ROWS, frame, layout, pixels

from seaglint.base.errors import BackendError, DataError, StorageError
from seaglint.base.machine import processor
from seaglint.cluster import LocalProcesses
from seaglint.store.location import place_of
from seaglint.store.missing_frames import UnitTask, unit_maker
from seaglint.store.sequence_store import Interrupted, finish_sequence, open_sequence, partial_path, write_sequence
from seaglint.store.shards import Shards, UnitFailure
from seaglint.store.writers import Share, exclusive
from seaglint.studies.sequence.sequence_work import spread_over


def files(store: Path) -> dict[str, str]:
    """Checksum of every file."""
    found = sorted(path for path in store.rglob("*") if path.is_file())
    return {str(path.relative_to(store)): sha256(path.read_bytes()).hexdigest() for path in found}


@pytest.fixture
def output(tmp_path: Path) -> Path:
    return tmp_path / "run.zarr"


@pytest.fixture(scope="module")
def whole(tmp_path_factory) -> dict[str, str]:
    """Files of a sequence of 23 frames in shards of 4, made in one go."""
    return files(write_sequence(tmp_path_factory.mktemp("whole") / "run.zarr", layout(), frame))


@contextmanager
def elsewhere(task: UnitTask, units) -> Iterator:
    """Has units made in the order of their numbers backwards, each by a maker of its own."""

    def outcomes():
        for unit in reversed(units):
            try:
                yield unit_maker(task, layout(), toy_store.raising)(unit)
            except RuntimeError as error:
                yield UnitFailure(unit, f"RuntimeError: {error}", "Traceback of it")

    yield outcomes()


def test_ten_thousand_frames_are_hundreds_of_files_whose_number_the_part_asked_for_does_not_change():
    small = replace(layout(), frames_per_unit=1)
    assert [small.in_units(frames).frames_per_unit for frames in (1, 256, 257, 512, 513, 10_000)] == [1, 1, 2, 2, 3, 40]
    assert replace(small, frames=range(3, 5)).in_units(10_000).frames_per_unit == 40
    # 2000 x 2000 float32 are 16 MB: 16 of them come closest to 256 MB.
    large = replace(small, azimuth_deg=np.zeros(2000), elevation_deg=np.zeros(2000))
    assert large.in_units(10_000).frames_per_unit == 16


def test_a_file_holds_the_frames_of_a_unit_and_no_other(output, whole):
    images = [name for name in whole if name.startswith("radiance/c/")]
    assert sorted(images, key=lambda name: int(name.split("/")[2])) == [f"radiance/c/{unit}/0/0" for unit in range(6)]
    for name in ("frame_done", "frame_checksum", "saturated_share"):
        assert len([found for found in whole if found.startswith(f"{name}/c/")]) == 6


def test_what_is_written_in_shards_is_what_is_read(output):
    write_sequence(output, layout(), frame)
    with open_sequence(output) as found:
        np.testing.assert_array_equal(found["radiance"], np.stack([pixels(n) for n in range(23)]))
        np.testing.assert_array_equal(found["saturated_share"], np.arange(23, dtype=np.float32) / 32)
        assert len(set(found["frame_checksum"].to_numpy().tolist())) == 23
        assert found.attrs["processor"] == processor()
        assert "processors_mixed" not in found.attrs
        assert "unfinished" not in found.attrs


@pytest.mark.parametrize("order", [[0, 1], [1, 0]])
def test_shares_in_any_order_make_the_same_files(output, whole, order):
    for index in order:
        write_sequence(output, layout(), frame, share=Share(index, 2))
        assert not output.exists()
    assert finish_sequence(output)
    assert files(output) == whole
    assert not finish_sequence(output)
    assert [path.name for path in output.parent.iterdir()] == ["run.zarr"]


def test_shares_without_units_succeed_and_finish_names_whose_frames_are_missing(output, whole):
    for index in (8, 0, 1, 2, 3, 5):  # the units are 0 to 5
        write_sequence(output, layout(), frame, share=Share(index, 9))
    with pytest.raises(DataError, match=r"4 of 23 frames are missing: 16-19 \(of shares 4/9\); run these shares again"):
        finish_sequence(output)
    write_sequence(output, layout(), frame, share=Share(4, 9))
    write_sequence(output, layout(), lambda number: pytest.fail("made twice"), share=Share(4, 9))
    finish_sequence(output)
    assert files(output) == whole
    write_sequence(output, layout(), lambda number: pytest.fail("finished"), share=Share(4, 9))


@pytest.mark.validation
def test_shares_at_the_same_time_make_the_same_files(output, whole):
    code = "import sys, toy_store; toy_store.share(sys.argv[1], int(sys.argv[2]), 3)"
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)}
    running = [subprocess.Popen([sys.executable, "-c", code, output, str(i)], env=environment) for i in (0, 1, 2)]
    assert [process.wait(600) for process in running] == [0, 0, 0]
    finish_sequence(output)
    assert files(output) == whole
    assert [path.name for path in output.parent.iterdir()] == ["run.zarr"]


def test_who_wants_it_alone_waits_for_shares_and_the_same_share_twice_is_refused(output):
    asked = []

    def busy(number: int):
        if not asked:
            asked.append(number)
            for other in ({"share": Share(0, 2)}, {"resume": True}):
                with pytest.raises(DataError, match="is being written by another process"):
                    write_sequence(output, layout(), frame, **other)
            with pytest.raises(DataError, match="is being written by another process"):
                finish_sequence(output)
            write_sequence(output, layout(), frame, share=Share(1, 2))
        return frame(number)

    write_sequence(output, layout(), busy, share=Share(0, 2))
    assert finish_sequence(output)


@pytest.mark.parametrize("text", ["2/2", "1", "-1/2", "0/0", "a/b", "1/2/3"])
def test_shares_that_are_none_are_refused(text):
    with pytest.raises(DataError, match="counted from 0"):
        Share.parse(text)


def test_units_made_elsewhere_are_the_same_files_and_progress_counts_frames(output, whole):
    seen = []
    write_sequence(output, layout(), frame, spread=elsewhere, progress=lambda done, total: seen.append((done, total)))
    assert files(output) == whole
    assert seen == [(n, 23) for n in (0, 3, 7, 11, 15, 19, 23)]  # the last unit, of 3 frames, came first


def test_frames_that_raise_are_named_and_the_rest_goes_on(output, whole, monkeypatch):
    monkeypatch.setattr(toy_store, "RAISES", {9})
    with pytest.raises(
        DataError, match=r"1 of 23 frames were not made: 9 \(RuntimeError: a defect\); tracebacks are in .*resume=True"
    ) as caught:
        write_sequence(output, layout(), frame, spread=elsewhere)
    assert caught.value.exit_code == 2
    assert [file.name for file in Path(f"{partial_path(output)}.errors").iterdir()] == ["frame-000009.txt"]
    monkeypatch.undo()
    asked = []
    write_sequence(output, layout(), lambda number: (asked.append(number), frame(number))[1], resume=True)
    assert asked == [9]
    assert files(output) == whole
    assert [path.name for path in output.parent.iterdir()] == ["run.zarr"]


@pytest.mark.parametrize("share", [None, Share(0, 1)])
def test_frames_that_raise_here_are_tried_again_named_and_the_rest_goes_on(output, whole, share):
    asked = []

    def raising(number: int):
        asked.append(number)
        if number in (9, 10) or (number == 20 and asked.count(20) < 3):
            raise RuntimeError(f"a defect of {number}")
        return frame(number)

    with pytest.raises(DataError, match=r"2 of 23 frames were not made: 9-10 \(RuntimeError: a defect of 9\); tracebacks are in "):
        write_sequence(output, layout(), raising, share=share, attempts=3)
    assert {number: asked.count(number) for number in set(asked)} == dict.fromkeys(range(23), 1) | dict.fromkeys((9, 10, 20), 3)
    told = Path(f"{partial_path(output)}.errors/frame-000009.txt").read_text()
    assert all(part in told for part in ("in raising", "in frame 9", "in frame 10", "a defect of 10"))
    write_sequence(output, layout(), frame, resume=True)
    assert files(output) == whole


def test_a_signal_while_frames_raise_stops(output):
    def stopping(number: int):
        if number == 5:
            os.kill(os.getpid(), signal.SIGTERM)
            raise RuntimeError("a defect")
        return frame(number)

    with pytest.raises(Interrupted, match="after 5 of 23 frames"):
        write_sequence(output, layout(), stopping, attempts=3)


def test_a_full_disk_elsewhere_stops_and_goes_on_when_it_is_freed(output, whole, monkeypatch):
    real = Shards.write

    def full(shards, unit, *rest):
        if unit == 2:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        real(shards, unit, *rest)

    monkeypatch.setattr(Shards, "write", full)
    with pytest.raises(StorageError, match=r"no room left.*resume=True"):
        write_sequence(output, layout(), frame, spread=elsewhere)
    monkeypatch.undo()
    write_sequence(output, layout(), frame, resume=True)
    assert files(output) == whole


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_in_a_unit_keeps_its_frames_and_the_files_are_the_same(output, whole, number):
    def stopping(n: int):
        if n == 5:
            os.kill(os.getpid(), number)
        return frame(n)

    with pytest.raises(Interrupted, match="after 6 of 23 frames"):
        write_sequence(output, layout(), stopping)
    asked = []
    write_sequence(output, layout(), lambda n: (asked.append(n), frame(n))[1], resume=True)
    assert asked == list(range(6, 23))
    assert files(output) == whole


def break_checksum(partial: Path) -> None:
    zarr.open_group(partial, mode="r+")["frame_checksum"][6] = 1


def break_pixel(partial: Path) -> None:
    zarr.open_group(partial, mode="r+")["radiance"][6, 0, 0] = -1.0


def cut_shard(partial: Path) -> None:
    path = partial / "radiance" / "c" / "1" / "0" / "0"
    path.write_bytes(path.read_bytes()[:50])


def remove_shard(partial: Path) -> None:
    (partial / "radiance" / "c" / "1" / "0" / "0").unlink()


@pytest.mark.parametrize(
    ("harm", "again"), [(break_checksum, [6]), (break_pixel, [6]), (cut_shard, [4, 5, 6, 7]), (remove_shard, [4, 5, 6, 7])]
)
@pytest.mark.parametrize("how", ["resume", "finish"])
def test_damaged_frames_are_made_again(output, whole, harm, again, how, caplog):
    write_sequence(output, layout(), frame, share=Share(0, 1))
    harm(partial_path(output))
    asked = []
    with caplog.at_level(logging.WARNING, logger="seaglint"):
        if how == "finish":
            with pytest.raises(DataError, match=rf"{len(again)} of 23 frames are missing: {again[0]}"):
                finish_sequence(output)
        write_sequence(output, layout(), lambda n: (asked.append(n), frame(n))[1], resume=True)
    assert asked == again
    assert len([line for line in caplog.messages if "made again" in line]) == 1
    assert files(output) == whole


def test_another_scenario_is_refused_by_its_key(output):
    write_sequence(output, layout(), frame, share=Share(0, 2))
    windy = layout(scenario_json='{"sea": {"wind": {"speed_m_s": 9.0}}}')
    for given in ({"share": Share(1, 2)}, {"resume": True}):
        with pytest.raises(DataError, match=r"was made with another sea\.wind\.speed_m_s;"):
            write_sequence(output, windy, frame, **given)
    with pytest.raises(DataError, match=r"was made with another sea\.wind\.speed_m_s;"):
        finish_sequence(output, windy.attributes["scenario"])


def test_another_version_is_refused_and_another_processor_told(output, monkeypatch, caplog):
    write_sequence(output, layout(), frame, share=Share(0, 2))
    with exclusive(partial_path(output)) as claim:
        task = UnitTask(str(output), str(claim.folder), claim.token, version="9.9")
        with pytest.raises(DataError, match=r"this worker has seaglint .* and its sender 9\.9"):
            unit_maker(task, layout(), frame)
    other = layout()
    other = replace(other, attributes={**other.attributes, "seaglint_version": "9.9"})
    monkeypatch.setattr("seaglint.store.sequence_store.__version__", "9.9")
    with pytest.raises(DataError, match="go on with that version"):
        write_sequence(output, other, frame, share=Share(1, 2))
    monkeypatch.undo()
    monkeypatch.setattr("seaglint.store.sequence_store.processor", lambda: "aarch64 other")
    with caplog.at_level(logging.WARNING, logger="seaglint"):
        write_sequence(output, layout(), frame, share=Share(1, 2))
    assert len([line for line in caplog.messages if "last bits" in line]) == 1
    finish_sequence(output)
    with open_sequence(output) as found:
        assert found.attrs["processor"] == f"aarch64 other; {processor()}"
        assert "last bits" in found.attrs["processors_mixed"]


def test_an_orphan_of_a_killed_run_writes_no_more(output):
    write_sequence(output, layout(), frame, share=Share(0, 2))
    with exclusive(partial_path(output)) as claim, place_of(output).staging(claim):
        task = UnitTask(str(output), str(claim.folder), claim.token)
        make = unit_maker(task, layout(), frame)
        make(1)
    with exclusive(partial_path(output)), pytest.raises(DataError, match="another process has taken it"):
        make(3)


def test_finish_says_what_is_not_there(output):
    with pytest.raises(DataError, match="no such unfinished sequence"):
        finish_sequence(output)
    with pytest.raises(DataError, match="share=0/2 joins"):
        write_sequence(output, layout(), frame, share=Share(0, 2), overwrite=True)


def test_truth_is_cut_alike(output):
    held = toy_store.with_truth()
    write_sequence(output, held, toy_store.true_frame)
    group = zarr.open_group(output, mode="r")
    assert {group[f"truth/{name}"].shards for name in ("object_mask", "object_id")} == {(4, 1, ROWS, COLUMNS), (4, ROWS, COLUMNS)}
    assert group["truth/range_m"].chunks == (4, 2)
    np.testing.assert_array_equal(group["truth/object_id"][:, 0, 0], np.arange(23))
    np.testing.assert_array_equal(group["truth/range_m"][:, 1], np.arange(23) + 1.0)


@pytest.mark.validation
@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="no SIGKILL here")
def test_runs_killed_at_random_moments_lose_nothing(output, whole):
    for moment in np.random.default_rng(1).permutation(np.linspace(0.01, 0.49, 8)):  # evenly over the 0.5 s of drawing and writing
        with begun("slow", output) as process:
            process.stdout.readline()
            try:
                process.wait(float(moment))
            except subprocess.TimeoutExpired:
                process.kill()
        if output.exists():
            assert files(output) == whole
            shutil.rmtree(output)
    write_sequence(output, layout(), frame, resume=True)
    assert files(output) == whole


@contextmanager
def begun(what: str, output: Path) -> Iterator[subprocess.Popen]:
    """A run in a process group of its own."""
    command = [sys.executable, "-c", f"import sys, toy_store; toy_store.{what}(sys.argv[1])", output]
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)}
    with subprocess.Popen(
        command, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True
    ) as run:
        try:
            yield run
        finally:
            run.kill()


def workers_of(process: int) -> list[int]:
    """Its children."""
    return [int(number) for number in Path(f"/proc/{process}/task/{process}/children").read_text().split()]


def end_of(processes: list[int]) -> bool:
    """Whether they end."""
    until = time.monotonic() + 600.0
    while any(Path(f"/proc/{number}/exe").exists() for number in processes) and time.monotonic() < until:
        time.sleep(0.02)
    return not any(Path(f"/proc/{number}/exe").exists() for number in processes)


@pytest.mark.validation
@pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="no /proc here")
def test_a_run_with_workers_killed_again_and_again_loses_nothing_and_leaves_no_process(output, tmp_path):
    """Eight kills, 1 to 15 units after each start: from before the first unit on, and well into the 100 units."""
    once = files(write_sequence(tmp_path / "once.zarr", toy_store.many(), frame))
    for units in (1, 15, 3, 13, 2, 11, 7, 9):
        with begun("over_workers", output) as process:
            for _ in range(units):
                process.stdout.readline()
            children = workers_of(process.pid) if process.poll() is None else []
            if process.poll() is None:
                process.kill()
        assert end_of(children)
        if output.exists():
            assert files(output) == once
            shutil.rmtree(output)
    write_sequence(output, toy_store.many(), frame, resume=True)
    assert files(output) == once


@pytest.mark.validation
@pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="no /proc here")
@pytest.mark.parametrize(("number", "group"), [(signal.SIGINT, True), (signal.SIGTERM, False), (signal.SIGTERM, True)])
def test_a_signal_to_a_run_with_workers_leaves_what_can_be_resumed_and_no_process(output, tmp_path, number, group):
    with begun("over_workers", output) as process:
        for _ in range(5):
            process.stdout.readline()
        children = workers_of(process.pid)
        os.killpg(process.pid, number) if group else process.send_signal(number)  # Ctrl-C goes to the whole group
        _, told = process.communicate(timeout=600)
        assert "Interrupted: stopped after" in told
        assert process.returncode == 1
    assert children
    assert end_of(children)
    assert not output.exists()
    asked = []
    write_sequence(output, toy_store.many(), lambda n: (asked.append(n), frame(n))[1], resume=True)
    assert 0 < len(asked) <= 300 - 3 * 4
    assert files(output) == files(write_sequence(tmp_path / "once.zarr", toy_store.many(), frame))


@pytest.mark.validation
@pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="no /proc here")
def test_a_signal_does_not_wait_for_long_units_of_workers(output):
    with begun("over_long_units", output) as process:
        process.stdout.readline()
        until = time.monotonic() + 600.0
        while len(children := workers_of(process.pid)) < 2 and time.monotonic() < until:
            time.sleep(0.05)
        os.killpg(process.pid, signal.SIGINT)
        _, told = process.communicate(timeout=600)  # of the hours that a unit takes
    assert "Interrupted: stopped after 0 of 23 frames" in told
    assert len(children) == 2
    assert end_of(children)


KILLS = 40


@pytest.mark.validation
@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="no SIGKILL here")
def test_workers_killed_at_random_moments_lose_nothing(tmp_path):
    """Forty times, while they are at work; units that were tried too often are made by the next run."""
    random, killed, ended = np.random.default_rng(2), [], threading.Event()
    many = toy_store.many()
    once = files(write_sequence(tmp_path / "once.zarr", many, frame))
    output = tmp_path / "run.zarr"
    with LocalProcesses(4) as workers:

        def kill() -> None:
            while not ended.wait(float(random.uniform(0.0, 0.2))) and len(killed) < KILLS:
                busy = [worker for worker in list(workers._workers) if worker.task is not None]
                if busy:
                    killed.append(busy[int(random.integers(len(busy)))].number)
                    os.kill(killed[-1], signal.SIGKILL)

        killer = threading.Thread(target=kill)
        killer.start()
        try:
            while not output.exists():
                with suppress(DataError, BackendError):
                    write_sequence(output, many, frame, resume=True, spread=spread_over(workers, toy_store.prepared_many, None))
                if output.exists() and len(killed) < KILLS:
                    assert files(output) == once
                    shutil.rmtree(output)
        finally:
            ended.set()
            killer.join()
    assert files(output) == once
    assert len(killed) == KILLS
