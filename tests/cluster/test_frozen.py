"""Workers and schedulers that are stopped by SIGSTOP, for ever or for a time: each unit has one outcome, and each freeze one line."""

from __future__ import annotations

import os
import random
import signal
import socket
import subprocess
import sys
import threading
import time
from contextlib import contextmanager, suppress

import pytest
import toy_jobs

from seaglint.base.errors import BackendError
from seaglint.cluster import Done, Failed, Job, LocalProcesses
from seaglint.cluster.dask import connected
from seaglint.cluster.job import ATTEMPTS
from seaglint.cluster.overdue import Limits, Patience

#: Limits of units of some 10 ms; a machine that is busy for longer than these computes units twice, and the tests pass.
SHORT = Limits(unit_s=2.0, start_s=toy_jobs.HANG, first_unit_s=toy_jobs.HANG, first_start_s=toy_jobs.HANG, last_s=toy_jobs.HANG)

UNITS = [f"sleep 0.{k:03d}" for k in range(1, 41)]


@contextmanager
def stopped(process: int, seconds: float | None = None):
    """Stop a process, for a time or until the context is left."""
    os.kill(process, signal.SIGSTOP)
    timer = threading.Timer(seconds or toy_jobs.HANG, _send, (process, signal.SIGCONT))
    timer.daemon = True
    timer.start()
    try:
        yield
    finally:
        timer.cancel()
        _send(process, signal.SIGCONT)


def _send(process: int, number: int) -> None:
    with suppress(ProcessLookupError):
        os.kill(process, number)


def require_all(outcomes, units=UNITS):
    assert sorted(one.unit for one in outcomes) == sorted(units)
    assert all(isinstance(one, Done) and one.record == one.unit.upper() for one in outcomes)


def test_limits_follow_the_median_and_the_clock_ignores_pauses(monkeypatch):
    seconds = [100.0]
    monkeypatch.setattr("seaglint.cluster.overdue.time.monotonic", lambda: seconds[0])
    patience = Patience(Limits(factor=10.0, unit_s=30.0, first_unit_s=7200.0, last_s=3600.0))
    assert (patience.limit(), patience.last_limit()) == (7200.0, 72000.0)
    for one in (1.0, 20.0, 400.0):
        patience.add(one)
    assert (patience.limit(), patience.last_limit()) == (200.0, 3600.0)
    for step in (0.25, 0.25, 3600.0, 0.5):  # this process itself was stopped for an hour
        seconds[0] += step
        patience.tick()
    assert patience.now == 2.0


@pytest.mark.parametrize("count", [1, 2])
@pytest.mark.parametrize("seed", [0, 1, 2])
def test_a_local_process_stopped_for_ever(count, seed, tmp_path):
    said: list[str] = []
    at, done = random.Random(seed).randrange(1, len(UNITS)), []
    with LocalProcesses(count, threads=1, report=said.append, limits=SHORT) as workers:
        with workers.map(Job(toy_jobs.lines, str(tmp_path)), UNITS) as outcomes:
            for outcome in outcomes:
                done.append(outcome)
                if len(done) == at:
                    frozen = int(outcome.worker.split()[1])
                    os.kill(frozen, signal.SIGSTOP)
        require_all(done)
        if at < len(UNITS) - 2 * count:  # a later one may have had no unit
            assert any(f"worker process {frozen} has not answered for" in line for line in said)
            assert all("its unit is given to another process" in line for line in said)
        with workers.map(Job(toy_jobs.squares, 1), range(5)) as outcomes:
            assert sorted(one.record for one in outcomes) == [1, 2, 5, 10, 17]
    assert frozen not in [worker.number for worker in workers._workers]


def test_a_local_process_that_goes_on_in_time_or_later(tmp_path):
    said: list[str] = []
    done = []
    with LocalProcesses(2, threads=1, report=said.append, limits=SHORT) as workers:
        with workers.map(Job(toy_jobs.lines, str(tmp_path)), UNITS) as outcomes:
            done.append(next(outcomes))
            with stopped(int(done[0].worker.split()[1]), 0.5):
                done += outcomes
        require_all(done)
        # it continues when the limit is over, in the middle of the job
        with workers.map(Job(toy_jobs.lines, str(tmp_path)), [*UNITS, "sleep 4"]) as outcomes:
            done = [next(outcomes)]
            with stopped(int(done[0].worker.split()[1]), 3.0):
                done += outcomes
        require_all(done, [*UNITS, "sleep 4"])


def test_a_unit_that_stops_every_process_fails_and_the_rest_is_done(tmp_path):
    said: list[str] = []
    limits = Limits(unit_s=1.0, start_s=toy_jobs.HANG, first_unit_s=3.0, first_start_s=toy_jobs.HANG, last_s=4.0)
    units = ["freeze", *UNITS[:10]]
    with (
        LocalProcesses(1, threads=1, report=said.append, limits=limits) as workers,
        workers.map(Job(toy_jobs.lines, str(tmp_path)), units) as found,
    ):
        outcomes = {one.unit: one for one in found}
    failed = outcomes.pop("freeze")
    assert isinstance(failed, Failed)
    assert failed.attempts == ATTEMPTS
    assert "did not answer for" in failed.error
    require_all(outcomes.values(), UNITS[:10])
    assert len(said) >= ATTEMPTS


def test_a_process_stopped_before_it_is_ready(tmp_path):
    said: list[str] = []
    limits = Limits(start_s=3.0, first_start_s=3.0, last_s=toy_jobs.HANG)
    (tmp_path / "freeze").touch()
    with (
        LocalProcesses(1, threads=1, report=said.append, limits=limits) as workers,
        workers.map(Job(toy_jobs.freezes_at_start, str(tmp_path)), UNITS[:3]) as outcomes,
    ):
        require_all(outcomes, UNITS[:3])
    assert any("another process is started" in line for line in said)


distributed = pytest.importorskip("distributed")


class Cluster:
    """A scheduler and its workers, each a process."""

    def __init__(self) -> None:
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            self.port = int(probe.getsockname()[1])
        self.address = f"tcp://127.0.0.1:{self.port}"
        self.environment = {**os.environ, "PYTHONPATH": os.pathsep.join(p for p in sys.path if p)}
        self.scheduler = self.start("distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", str(self.port), "--no-dashboard")
        toy_jobs.until(self.listens)
        self.workers = [self.worker() for _ in range(2)]
        self.others: list[subprocess.Popen[bytes]] = []

    def start(self, module: str, *options: str) -> subprocess.Popen[bytes]:
        return subprocess.Popen([sys.executable, "-m", module, *options], env=self.environment, stderr=subprocess.DEVNULL)

    def worker(self) -> subprocess.Popen[bytes]:
        return self.start("distributed.cli.dask_worker", self.address, "--nthreads", "1", "--no-nanny", "--no-dashboard")

    def listens(self) -> bool:
        with suppress(OSError), socket.create_connection(("127.0.0.1", self.port)):
            return True
        return False

    @contextmanager
    def connected(self, said: list[str], limits: Limits = SHORT, patience: float = toy_jobs.HANG):
        with connected(self.address, said.append, patience=patience, limits=limits) as workers:
            toy_jobs.until(lambda: workers.count == 2)
            yield workers

    def close(self) -> None:
        for process in (*self.workers, *self.others, self.scheduler):
            process.kill()
            process.wait()


@pytest.fixture
def cluster(monkeypatch):
    monkeypatch.setattr("seaglint.cluster.dask.CONNECT", toy_jobs.HANG)
    made = Cluster()
    try:
        yield made
    finally:
        made.close()


@pytest.mark.validation
@pytest.mark.parametrize("seed", [0, 1, 2, 3])
def test_a_dask_worker_stopped_for_ever(seed, cluster, tmp_path):
    said: list[str] = []
    draw = random.Random(seed)
    at, pause, done = draw.randrange(2, len(UNITS) - 8), draw.uniform(0.0, 0.05), []
    with cluster.connected(said) as workers:
        with workers.map(Job(toy_jobs.lines, str(tmp_path)), UNITS) as outcomes:
            for outcome in outcomes:
                done.append(outcome)
                if len(done) == at:
                    time.sleep(pause)
                    os.kill(cluster.workers[0].pid, signal.SIGSTOP)
        require_all(done)
        assert len(said) == 1
        assert "has not answered for" in said[0]
        # the next job does without it, and without another line
        with workers.map(Job(toy_jobs.squares, 1), range(5)) as outcomes:
            assert sorted(one.record for one in outcomes) == [1, 2, 5, 10, 17]
        assert len(said) == 1


@pytest.mark.validation
def test_a_dask_worker_that_is_killed_is_reported(cluster, tmp_path):
    said: list[str] = []
    with cluster.connected(said) as workers, workers.map(Job(toy_jobs.lines, str(tmp_path)), [*UNITS, "sleep 6"]) as outcomes:
        done = [next(outcomes)]
        cluster.workers[0].kill()
        done += outcomes
        require_all(done, [*UNITS, "sleep 6"])
    assert [line for line in said if "has left the Dask scheduler; units in progress there are given to other workers" in line]


@pytest.mark.validation
def test_a_dask_worker_that_goes_on(cluster, tmp_path):
    said: list[str] = []
    with cluster.connected(said) as workers:
        for seconds in (0.5, 4.0):
            with workers.map(Job(toy_jobs.lines, str(tmp_path)), [*UNITS, "sleep 6"]) as outcomes:
                done = [next(outcomes)]
                with stopped(cluster.workers[0].pid, seconds):
                    done += outcomes
            require_all(done, [*UNITS, "sleep 6"])
        with workers.map(Job(toy_jobs.squares, 1), range(5)) as outcomes:
            toy_jobs.until(lambda: workers.count == 2)
            assert sorted(one.record for one in outcomes) == [1, 2, 5, 10, 17]


@pytest.mark.validation
def test_a_unit_that_stops_dask_workers_fails_and_the_rest_is_done(cluster, tmp_path):
    said: list[str] = []
    cluster.others = [cluster.worker() for _ in range(2)]
    limits = Limits(unit_s=1.0, start_s=toy_jobs.HANG, first_unit_s=toy_jobs.HANG, first_start_s=toy_jobs.HANG, last_s=6.0)
    units = [*UNITS[:10], "freeze", *UNITS[10:]]
    with connected(cluster.address, said.append, patience=toy_jobs.HANG, limits=limits) as workers:
        toy_jobs.until(lambda: workers.count == 4)
        with workers.map(Job(toy_jobs.lines, str(tmp_path)), units) as found:
            outcomes = {one.unit: one for one in found}
    failed = outcomes.pop("freeze")
    assert isinstance(failed, Failed)
    assert failed.attempts == ATTEMPTS
    assert "did not answer for" in failed.error
    require_all(outcomes.values())
    assert len([line for line in said if "has not answered" in line]) >= ATTEMPTS


@pytest.mark.validation
@pytest.mark.parametrize("goes_on", [True, False])
def test_a_scheduler_that_is_stopped(goes_on, cluster, tmp_path, monkeypatch):
    said: list[str] = []
    monkeypatch.setattr("seaglint.cluster.dask_progress.ANSWER", 2.0)
    monkeypatch.setattr("seaglint.cluster.dask.ANSWER", 2.0)
    with cluster.connected(said) as workers, workers.map(Job(toy_jobs.lines, str(tmp_path)), [*UNITS, *("sleep 0.1",) * 60]) as outcomes:
        done = [next(outcomes)]
        if goes_on:
            with stopped(cluster.scheduler.pid, 6.0):
                done += outcomes
            assert len(done) == len(UNITS) + 60
            assert all(isinstance(one, Done) for one in done)
        else:
            workers.patience = 3.0
            monkeypatch.setattr("seaglint.cluster.dask.CONNECT", 1.0)
            with stopped(cluster.scheduler.pid), pytest.raises(BackendError, match="did not come back within 3 s; finished units remain"):
                list(outcomes)
    assert any("scheduler is lost" in line for line in said)


OTHER = """
import asyncio, sys
import seaglint.version
seaglint.version.__version__ = "0.0.9"
from distributed import Worker
async def work():
    async with Worker(sys.argv[1], nthreads=1, dashboard=False) as worker:
        await worker.finished()
asyncio.run(work())
"""


@pytest.mark.validation
def test_a_worker_of_another_version_that_joins_is_left_out(cluster, tmp_path):
    said: list[str] = []
    units = [f"sleep 0.{k:03d}" for k in range(101, 200)]
    done = []
    with cluster.connected(said) as workers:
        with workers.map(Job(toy_jobs.lines, str(tmp_path)), units) as outcomes:
            done.append(next(outcomes))
            other = subprocess.Popen([sys.executable, "-c", OTHER, cluster.address], env=cluster.environment, stderr=subprocess.DEVNULL)
            cluster.others.append(other)
            for outcome in outcomes:
                done.append(outcome)
        require_all(done, units)
        toy_jobs.until(lambda: bool(workers.look() and said))
        assert workers.count == 2
    assert not any(other.pid in toy_jobs.attempts(tmp_path, unit) for unit in units)
    assert len(said) == 1
    assert "1 workers have seaglint 0.0.9 and not" in said[0]
    assert "the other workers do the work" in said[0]
