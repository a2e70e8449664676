"""A Dask cluster of three processes: everything comes back, whoever dies on the way."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
from contextlib import suppress
from types import SimpleNamespace

import pytest
import toy_jobs

from seaglint.base.errors import BackendError, DataError, DomainError
from seaglint.cluster import Done, Failed, Job
from seaglint.cluster.dask import connected, queued, read_settings, sorted_out
from seaglint.cluster.dask_progress import DaskMapping
from seaglint.cluster.job import ATTEMPTS
from seaglint.cluster.overdue import Limits
from seaglint.cluster.remote import this_machine

distributed = pytest.importorskip("distributed")


@pytest.fixture(scope="module", autouse=True)
def patient():
    """Connections that may take as long as a busy machine needs."""
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr("seaglint.cluster.dask.CONNECT", toy_jobs.HANG)
        yield


@pytest.fixture(scope="module")
def scheduler(patient):
    import dask

    path = os.pathsep.join(p for p in sys.path if p)
    with (
        dask.config.set({"distributed.scheduler.allowed-failures": 0, "distributed.nanny.environ.PYTHONPATH": path}),
        distributed.LocalCluster(
            processes=True, n_workers=3, threads_per_worker=1, dashboard_address=None, silence_logs="CRITICAL"
        ) as cluster,
    ):
        yield cluster


@pytest.fixture(scope="module")
def three(scheduler):
    with connected(scheduler.scheduler_address) as workers:
        yield workers


def outcomes(workers, start, settings, units):
    with workers.map(Job(start, settings), units) as found:
        return list(found)


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


def listens(port: int) -> bool:
    with suppress(OSError), socket.create_connection(("127.0.0.1", port)):
        return True
    return False


@pytest.mark.parametrize("units", [range(12), [], iter([3])])
def test_each_unit_comes_back_once(units, three):
    units = list(units)
    found = outcomes(three, toy_jobs.squares, 5, units)
    assert all(isinstance(one, Done) for one in found)
    assert sorted((one.unit, one.record) for one in found) == [(unit, 5 + unit * unit) for unit in units]
    assert three.count == 3


def test_a_unit_that_raises_is_tried_again_and_named(three, tmp_path):
    found = {one.unit: one for one in outcomes(three, toy_jobs.lines, str(tmp_path), ["raise", "a", "b"])}
    failed = found.pop("raise")
    assert isinstance(failed, Failed)
    assert (failed.error, failed.attempts) == ("ValueError: no waves", ATTEMPTS)
    assert "toy_jobs.py" in failed.traceback
    tried = toy_jobs.attempts(tmp_path, "raise")
    assert len(tried) == len(set(tried)) == ATTEMPTS  # each attempt at another worker, since the fault may be of one of them
    assert {unit: one.record for unit, one in found.items()} == {"a": "A", "b": "B"}


def test_a_worker_that_dies_has_its_unit_done_by_another(three, tmp_path):
    units = ["once", *(f"unit {k}" for k in range(5))]
    found = {one.unit: one for one in outcomes(three, toy_jobs.lines, str(tmp_path), units)}
    assert {unit: one.record for unit, one in found.items()} == {unit: unit.upper() for unit in units}
    first, second = toy_jobs.attempts(tmp_path, "once")
    assert first != second


@pytest.mark.validation
def test_a_unit_that_kills_its_workers_is_given_up(three, tmp_path):
    found = {one.unit: one for one in outcomes(three, toy_jobs.lines, str(tmp_path), ["kill", "a", "b"])}
    failed = found.pop("kill")
    assert isinstance(failed, Failed)
    assert failed.attempts == ATTEMPTS
    assert "1 worker died at it" in failed.error
    assert len(set(toy_jobs.attempts(tmp_path, "kill"))) == ATTEMPTS
    assert {one.record for one in found.values()} == {"A", "B"}


def test_units_for_many_workers_are_sent_together():
    class Eight:
        count, idle, limits, sent = 8, True, Limits(), []

        def submit(self, units, content, avoided):
            self.sent.append(len(units))
            return [SimpleNamespace(key=unit) for unit in units], frozenset()

    mapping = DaskMapping(Eight(), b"", range(20))
    for finished in (0, 1, 1, 14, 3):
        for key in list(mapping.flight)[:finished]:
            del mapping.flight[key]
        assert mapping._fill()
    assert Eight.sent == [16, 2, 2]
    mapping.flight.clear()
    assert not mapping._fill()


def test_leaving_takes_back_what_was_not_begun(three, tmp_path):
    units = ["a", *(f"hold {k}" for k in range(20))]
    with three.map(Job(toy_jobs.lines, str(tmp_path)), units) as found:
        assert next(found).unit == "a"
    # Each of the three workers can have begun one; the rest is taken from them before these are let go.
    toy_jobs.until(lambda: not any(three._client.run(toy_jobs.waiting).values()))
    (tmp_path / "go").touch()
    assert sorted(one.record for one in outcomes(three, toy_jobs.squares, 0, range(12))) == [k * k for k in range(12)]
    assert len(list(tmp_path.glob("hold-*"))) <= 3


def test_what_the_start_refuses_is_raised_as_it_is(three):
    with pytest.raises(DomainError) as caught:
        outcomes(three, toy_jobs.refuses, "seaglint", [1])
    assert (caught.value.name, caught.value.value) == ("wind_speed", 31.0)
    with pytest.raises(KeyError, match="lost"):
        outcomes(three, toy_jobs.refuses, "other", [1])


def test_no_scheduler_is_told(monkeypatch):
    monkeypatch.setattr("seaglint.cluster.dask.CONNECT", 0.5)
    address = f"tcp://127.0.0.1:{free_port()}"
    with pytest.raises(BackendError, match=f"{address}: no Dask scheduler answers"), connected(address):
        pass


@pytest.mark.parametrize("address", ["host", "http://host:80", "tcp://host"])
def test_what_is_no_address(address):
    with pytest.raises(DataError, match="is no address of a Dask scheduler; give one such as tcp://host:8786"), connected(address):
        pass


def test_workers_of_another_version_or_without_the_package_are_named():
    mine = this_machine()
    old, odd = mine._replace(version="0.0.9"), mine._replace(sources="0")
    answers = {"tcp://a:1": mine, "tcp://b:1": None, "tcp://c:1": old, "tcp://d:1": odd, "tcp://e:1": odd, "tcp://f:1": OSError("it went")}
    usable, refused = sorted_out(answers, mine)
    assert usable == {"tcp://a:1": mine}
    assert refused.keys() == {f"tcp://{name}:1" for name in "bcde"}
    assert refused["tcp://b:1"].startswith("1 workers have no seaglint, or one that knows no such work: tcp://b:1; install")
    assert refused["tcp://c:1"].startswith(f"1 workers have seaglint 0.0.9 and not {mine.version}: tcp://c:1; install")
    assert refused["tcp://d:1"] == refused["tcp://e:1"]
    assert refused["tcp://d:1"].startswith(f"2 workers have other sources of seaglint {mine.version}: tcp://d:1, tcp://e:1; install")


WORKER = """
import asyncio, sys
{prelude}
from distributed import Worker
async def work():
    async with Worker(sys.argv[1], nthreads=1, dashboard=False) as worker:
        await worker.finished()
asyncio.run(work())
"""


@pytest.fixture
def lone_scheduler():
    with distributed.LocalCluster(n_workers=0, processes=False, dashboard_address=None, silence_logs="CRITICAL", protocol="tcp") as cluster:
        yield cluster.scheduler_address


@pytest.mark.parametrize(
    ("prelude", "told"),
    [
        ("sys.modules['seaglint'] = None", "have no seaglint"),
        ("import seaglint.version; seaglint.version.__version__ = '0.0.9'", "have seaglint 0.0.9 and not"),
    ],
)
@pytest.mark.validation
def test_a_worker_that_cannot_do_the_work_is_refused(prelude, told, lone_scheduler):
    path = os.pathsep.join(p for p in sys.path if p)
    worker = subprocess.Popen(
        [sys.executable, "-c", WORKER.format(prelude=prelude), lone_scheduler],
        env={**os.environ, "PYTHONPATH": path},
        stderr=subprocess.DEVNULL,
    )
    try:
        with pytest.raises(BackendError, match=told), connected(lone_scheduler):
            pass
    finally:
        worker.kill()
        worker.wait()


def test_a_scheduler_without_workers_is_told(lone_scheduler):
    with pytest.raises(BackendError, match=r"no worker came within 0\.5 s"), connected(lone_scheduler, patience=0.5):
        pass


def test_another_processor_type_is_told(three):
    said = []
    three.report = said.append
    odd = this_machine()._replace(processor="x86_64 another")
    three._report_processors({"tcp://a:1": odd, "tcp://b:1": odd, "tcp://c:1": this_machine()})
    three.report = lambda line: None
    assert len(said) == 1
    assert said[0].startswith("2 workers (tcp://a:1, tcp://b:1) have another processor type, x86_64 another and not")


@pytest.mark.validation
@pytest.mark.parametrize("comes_back", [True, False])
def test_a_scheduler_that_is_lost_in_the_middle(comes_back, tmp_path, monkeypatch):
    port = free_port()
    address, path = f"tcp://127.0.0.1:{port}", os.pathsep.join(p for p in sys.path if p)
    environment = {**os.environ, "PYTHONPATH": path}

    def start() -> list[subprocess.Popen]:
        scheduler = [sys.executable, "-m", "distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", str(port), "--no-dashboard"]
        worker = [sys.executable, "-c", WORKER.format(prelude=""), address]
        return [subprocess.Popen(command, env=environment, stderr=subprocess.DEVNULL) for command in (scheduler, worker, worker)]

    processes = start()
    said: list[str] = []
    units = [f"sleep 0.{k}" for k in range(10, 30)]
    try:
        toy_jobs.until(lambda: listens(port))
        with (
            connected(address, said.append, patience=toy_jobs.HANG) as workers,
            workers.map(Job(toy_jobs.lines, str(tmp_path)), units) as found,
        ):
            done = [next(found)]
            processes[0].send_signal(signal.SIGKILL)
            processes[0].wait()
            if comes_back:
                processes += start()
                done += list(found)
                assert sorted(one.unit for one in done) == units
                assert all(isinstance(one, Done) for one in done)
            else:
                workers.patience = 3.0
                monkeypatch.setattr("seaglint.cluster.dask.CONNECT", 3.0)  # nothing answers: no machine is too busy for that
                with pytest.raises(BackendError, match="did not come back within 3 s; finished units remain"):
                    list(found)
        assert any("scheduler is lost" in line for line in said)
    finally:
        for process in processes:
            process.kill()
            process.wait()


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("kind = 'cray'", "kind = 'cray'; allowed are slurm"),
        ("jobs = 0", "jobs = 0; give the number"),
        ("timeout_s = '1 h'", "timeout_s = '1 h'; give the seconds"),
        ("jobs = ", "is no TOML file"),
    ],
)
def test_settings_of_a_queue_that_make_no_sense(text, told, tmp_path):
    path = tmp_path / "cluster.toml"
    path.write_text(text)
    with pytest.raises(DataError) as caught:
        read_settings(path)
    assert f"{path}: " in str(caught.value)
    assert told in str(caught.value)


def test_settings_of_a_queue(tmp_path):
    path = tmp_path / "cluster.toml"
    path.write_text("kind = 'pbs'\njobs = 10\ncores = 4\nqueue = 'long'\n")
    assert read_settings(path) == ("pbs", 10, 600.0, {"cores": 4, "queue": "long"})
    with pytest.raises(DataError, match="cannot be read"):
        read_settings(tmp_path / "absent.toml")


def test_no_queue_on_this_machine(tmp_path, monkeypatch):
    path = tmp_path / "cluster.toml"
    path.write_text("cores = 1\nmemory = '1GB'\n")
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(BackendError, match="sbatch is not on this machine"), queued(path):
        pass


SBATCH = "#!/bin/sh\n{work}\necho Submitted batch job 1\n"


@pytest.fixture
def slurm(tmp_path, monkeypatch):
    """Stand-ins for SLURM's commands; the argument says what sbatch does with the job's script, which is its last argument."""

    def make(work: str) -> None:
        for name, text in (("sbatch", SBATCH.format(work=work)), ("scancel", "#!/bin/sh\n")):
            command = tmp_path / name
            command.write_text(text)
            command.chmod(0o755)
        monkeypatch.setenv("PATH", f"{tmp_path}{os.pathsep}{os.environ['PATH']}")
        monkeypatch.setenv("PYTHONPATH", os.pathsep.join(p for p in sys.path if p))

    return make


@pytest.mark.validation
def test_a_full_queue_is_told(slurm, tmp_path):
    slurm("true")
    path = tmp_path / "cluster.toml"
    path.write_text("jobs = 2\ntimeout_s = 0.5\ncores = 1\nmemory = '1GB'\n")
    with pytest.raises(BackendError, match=r"the queue started none of 2 jobs within 0\.5 s; it may be full"), queued(path):
        pass
    path.write_text("jobs = 2\ncores = 1\nmemory = '1GB'\nquue = 'long'\n")
    with pytest.raises(DataError, match="SLURMCluster refuses these settings"), queued(path):
        pass


@pytest.mark.validation
def test_jobs_of_a_queue_do_the_work(slurm, tmp_path):
    slurm(f'cp "$1" {tmp_path}/job.sh; sh {tmp_path}/job.sh >/dev/null 2>&1 </dev/null &')
    path = tmp_path / "cluster.toml"
    path.write_text("jobs = 1\ntimeout_s = 600\ncores = 1\nprocesses = 1\nmemory = '1GB'\n")
    with queued(path) as workers:
        assert sorted(one.record for one in outcomes(workers, toy_jobs.squares, 1, range(4))) == [1, 2, 5, 10]
