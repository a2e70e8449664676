"""Measure how work is shared out, and write the tables into docs/performance.md.

python benchmarks/scaling.py [PART ...] [--print]

Parts: processes, overhead, tiny, startup, memory, records, thousand, files; all of them where none is named. Run it on a quiet machine: the
load is written beside the numbers.
"""

from __future__ import annotations

import argparse
import contextlib
import datetime
import math
import os
import pickle
import platform
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

import scaling_jobs
from seaglint.cluster import Job, LocalProcesses
from seaglint.cluster.dask import DaskWorkers, client_of, connected, quiet
from seaglint.cluster.job import Done
from seaglint.cluster.remote import packed
from seaglint.scenario.load import parse_scenario
from seaglint.store.layout import Layout

PAGE = Path(__file__).resolve().parents[1] / "docs" / "performance.md"

SMALL = {"sensor": {"pixels": [256, 128], "fov_deg": [16, 8], "elevation_deg": -3.6}, "wind": {"speed_m_s": 7}}
LARGE = {"sensor": {"pixels": [640, 512], "fov_deg": [16, 12.8], "elevation_deg": -6}, "wind": {"speed_m_s": 7}}

Rows = list[tuple[str, ...]]


def rendering(scenario: dict[str, Any]) -> Job[Any, int, scaling_jobs.FrameRecord]:
    """The job of a scenario's frames."""
    return Job(scaling_jobs.frames, parse_scenario(scenario))


def timed(workers: Any, job: Job[Any, Any, Any], count: int) -> tuple[float, list[Done[Any, Any]]]:
    """Wall time of some units [s], after every worker has begun, and what came of them."""
    with workers.map(job, range(2 * workers.count)) as found:
        list(found)
    began = time.perf_counter()
    with workers.map(job, range(count)) as found:
        done = list(found)
    return time.perf_counter() - began, done


def processes() -> Rows:
    """Two processes with one thread each against one with two."""
    rows: Rows = [("workers", "wall time a frame", "processor time a frame", "frames per second and core")]
    for count, threads in ((1, 1), (1, 2), (2, 1)):
        with LocalProcesses(count, threads=threads) as workers:
            wall, done = timed(workers, rendering(SMALL), 24)
        cpu = sum(one.record.cpu_seconds for one in done) / len(done)
        each, cores = wall / len(done), count * threads
        name = f"{count} process{'es' if count > 1 else ''} of {threads} thread{'s' if threads > 1 else ''}"
        rows.append((name, f"{each:.3f} s", f"{cpu:.3f} s", f"{1.0 / each / cores:.2f}"))
    return rows


@contextlib.contextmanager
def teams(count: int) -> Iterator[tuple[LocalProcesses, DaskWorkers]]:
    """Two local processes, and ``count`` workers of a scheduler."""
    with LocalProcesses(2) as local, scheduler() as address, hosts(address, count, 1, 1), connected(address) as dask:
        yield local, dask


def overhead() -> Rows:
    """What sharing out adds to frames of one second that sleep."""
    rows: Rows = [("workers", "frames of 1 s", "wall time", "over the ideal")]
    with teams(3) as (local, dask):
        for name, workers, count in (("2 local processes", local, 2), ("Dask, 3 workers", dask, 3)):
            wall, done = timed(workers, Job(scaling_jobs.sleeping, 1.0), 8 * count)
            ideal = len(done) / count
            rows.append((name, str(len(done)), f"{wall:.2f} s", f"{100 * (wall / ideal - 1):.1f} %"))
    return rows


def tiny() -> Rows:
    """Overhead of each of many units that do nothing."""
    rows: Rows = [("2 workers", "units", "wall time a unit", "processor time a unit in the requesting process")]
    with teams(2) as (local, dask):
        for name, workers, count in (("local processes", local, 100_000), ("Dask", dask, 20_000)):
            own = time.process_time()
            wall, done = timed(workers, Job(scaling_jobs.sleeping, 0.0), count)
            own = time.process_time() - own
            rows.append((name, str(len(done)), f"{1000 * wall / len(done):.2f} ms", f"{1000 * own / len(done):.2f} ms"))
    return rows


def startup() -> Rows:
    """From nothing to the first frame, kernels compiled before and not."""
    rows: Rows = [("2 local processes of 1 thread", "first frame done", "processor time of both")]
    job = rendering(SMALL)

    def first() -> tuple[float, float]:
        before, began = os.times(), time.perf_counter()
        with LocalProcesses(2, threads=1) as workers:
            with workers.map(job, range(2)) as found:
                list(found)
            wall = time.perf_counter() - began
        after = os.times()
        return wall, after.children_user + after.children_system - before.children_user - before.children_system

    first()
    wall, cpu = first()
    rows.append(("kernels stored", f"{wall:.1f} s", f"{cpu:.1f} s"))
    with tempfile.TemporaryDirectory() as folder:
        os.environ["NUMBA_CACHE_DIR"] = folder
        try:
            wall, cpu = first()
        finally:
            del os.environ["NUMBA_CACHE_DIR"]
        rows.append(("kernels to be compiled, by one for both", f"{wall:.1f} s", f"{cpu:.1f} s"))
    return rows


def memory() -> Rows:
    """Largest memory of a worker."""
    rows: Rows = [("frame", "peak memory of a worker")]
    for scenario in (SMALL, LARGE):
        with LocalProcesses(1, threads=1) as workers, workers.map(rendering(scenario), range(3)) as found:
            peak = max(one.record.peak_mb for one in found if isinstance(one, Done))
        columns, lines = scenario["sensor"]["pixels"]
        rows.append((f"{columns} x {lines}", f"{peak:.0f} MB"))
    return rows


def record_sizes() -> tuple[int, int]:
    """Bytes to a worker and back for one unit."""
    job = rendering(SMALL)
    record = Done(7, scaling_jobs.FrameRecord(7, "0" * 64, 1.0, 300.0), 1.0, "tcp://10.0.0.1:40000")
    return len(packed(job)) + len(pickle.dumps(7)), len(pickle.dumps(record))


def records() -> Rows:
    """What passes the scheduler for a unit."""
    there, back = record_sizes()
    return [("for a unit", "bytes"), ("job (compressed) and unit, to the worker", str(there)), ("record, back", str(back))]


@contextlib.contextmanager
def scheduler() -> Iterator[str]:
    """A scheduler in a process of its own."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    command = [sys.executable, "-m", "distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", str(port), "--no-dashboard"]
    process = subprocess.Popen(command, stderr=subprocess.DEVNULL)
    try:
        answers = False
        while not answers:  # on a busy machine it takes longer to start than a client waits
            with contextlib.suppress(OSError), socket.create_connection(("127.0.0.1", port)):
                answers = True
            time.sleep(0.1)
        yield f"tcp://127.0.0.1:{port}"
    finally:
        process.terminate()
        process.wait()


@contextlib.contextmanager
def hosts(address: str, processes: int, workers: int, threads: int) -> Iterator[None]:
    """Processes with many workers of a scheduler each."""
    path = os.pathsep.join(p for p in sys.path if p)
    command = [sys.executable, str(Path(scaling_jobs.__file__)), address, str(workers), str(threads)]
    made = [subprocess.Popen(command, env={**os.environ, "PYTHONPATH": path}, stderr=subprocess.DEVNULL) for _ in range(processes)]
    try:
        yield
    finally:
        for process in made:
            process.kill()
            process.wait()


class Simulated(DaskWorkers):
    """Workers of which each does many sleeping units at once."""

    slots = 1
    task = staticmethod(scaling_jobs.simulated)

    @property
    def count(self) -> int:
        """Units at the same time."""
        return self.slots


def scheduler_seconds(workers: DaskWorkers) -> float:
    """Processor time of the scheduler so far [s]."""
    return float(workers._client.run_on_scheduler(time.process_time))


def thousand(slots: tuple[int, int, int] = (1, 20, 50), rounds: int = 8) -> Rows:
    """A thousand units at the same time: what the scheduler and the one who asks have to do for each."""
    count = math.prod(slots)
    with scheduler() as address, hosts(address, *slots), quiet():
        workers = Simulated(lambda: client_of(address, address))
        while len(workers.look(at_once=True)) < slots[0] * slots[1]:
            time.sleep(0.5)
        workers.slots = count
        job = rendering(SMALL)
        with workers.map(job, range(count)) as found:
            list(found)
        before, own, began = scheduler_seconds(workers), time.process_time(), time.perf_counter()
        with workers.map(job, range(rounds * count)) as found:
            number = sum(1 for _ in found)
        wall, own = time.perf_counter() - began, time.process_time() - own
        busy = scheduler_seconds(workers) - before
        workers.close()
    per_unit, asks, rate = busy / number, own / number, number / wall
    there, back = record_sizes()
    frame = 640 * 512 * 4
    return [
        (f"{slots[0] * slots[1]} Dask workers of {slots[2]} units at once, {number} units that sleep {scaling_jobs.PAUSE:g} s", "value"),
        (f"units per second ({count / scaling_jobs.PAUSE:.0f} would be all that the workers can)", f"{rate:.0f}"),
        ("processor time of the scheduler for a unit", f"{1000 * per_unit:.2f} ms"),
        ("processor time of the requesting process for a unit", f"{1000 * asks:.2f} ms"),
        ("scheduler busy, of one processor", f"{100 * busy / wall:.0f} %"),
        ("through the scheduler", f"{1e-3 * rate * (there + back):.0f} kB/s"),
        ("model: units per second at which the scheduler's processor is full", f"{1.0 / per_unit:.0f}"),
        ("model: units per second at which the requesting process is full", f"{1.0 / asks:.0f}"),
        ("model: 1000 workers, 1 s a frame, 640 x 512: written, before compression", f"{1e-6 * 1000 * frame:.0f} MB/s"),
    ]


def files() -> Rows:
    """Number and size of the files of a store of one variable."""
    rows: Rows = [("frames of 640 x 512", "frames a file", "files", "size of a file, at most", "whole store, at most")]
    layout = Layout(np.zeros(640), np.zeros(512), range(0), 25.0, None)
    frame = layout.frame_bytes
    for count in (100, 1000, 10_000, 100_000):
        each = layout.in_units(count).frames_per_unit
        rows.append(
            (f"{count}", f"{each}", f"{math.ceil(count / each)}", f"{1e-6 * each * frame:.1f} MB", f"{1e-9 * count * frame:.2f} GB")
        )
    return rows


PARTS: dict[str, tuple[str, Callable[[], Rows]]] = {
    "processes": ("Local processes, 256 x 128 pixels", processes),
    "overhead": ("Overhead", overhead),
    "tiny": ("Many tiny units", tiny),
    "startup": ("Start", startup),
    "memory": ("Memory", memory),
    "records": ("Through the scheduler", records),
    "thousand": ("A thousand workers, simulated", thousand),
    "files": ("Files of a sequence", files),
}


def table(rows: Rows) -> str:
    """Rows as Markdown, the first as heading."""
    head, *rest = rows
    return "\n".join("| " + " | ".join(row) + " |" for row in (head, ("---",) * len(head), *rest))


def circumstances() -> str:
    """When and where it was measured."""
    load, day = os.getloadavg()[0], datetime.datetime.now(datetime.UTC)
    return f"{day:%Y-%m-%d}; {os.cpu_count()} processors, load {load:.1f} at the start; Python {platform.python_version()}."


def main() -> None:
    """Measure and write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("parts", nargs="*", metavar="PART", help=", ".join(PARTS))
    parser.add_argument("--print", action="store_true", dest="shown", help="print the tables and leave the page as it is")
    given = parser.parse_args()
    if unknown := set(given.parts) - set(PARTS):
        parser.error(f"{', '.join(sorted(unknown))}: parts are {', '.join(PARTS)}")
    for part in given.parts or PARTS:
        title, measure = PARTS[part]
        when = circumstances()
        text = f"{when}\n\n{table(measure())}\n"
        print(f"{title}\n\n{text}", flush=True)
        if not given.shown:
            begin, end = f"<!-- begin scaling {part} -->\n", f"<!-- end scaling {part} -->\n"
            page = PAGE.read_text(encoding="utf-8")
            head, rest = page.split(begin, 1)
            PAGE.write_text(f"{head}{begin}\n{text}\n{end}{rest.split(end, 1)[1]}", encoding="utf-8")


if __name__ == "__main__":
    main()
