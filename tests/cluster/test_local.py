"""Local processes: everything comes back, whoever dies on the way."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
import toy_jobs

from seaglint.base.errors import BackendError, DomainError
from seaglint.cluster import Done, Failed, Job, LocalProcesses, ThisProcess
from seaglint.cluster.job import ATTEMPTS


@pytest.fixture(scope="module")
def two():
    with LocalProcesses(2) as workers:
        yield workers


def outcomes(workers, start, settings, units):
    with workers.map(Job(start, settings), units) as found:
        return list(found)


def alive(process: int) -> bool:
    """Whether a process runs; one that waits for its parent to read its end does not."""
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def require_end(processes: list[int]) -> None:
    """Wait until processes have ended."""
    toy_jobs.until(lambda: not any(alive(process) for process in processes))


@pytest.mark.parametrize("kind", ["here", "local"])
@pytest.mark.parametrize("units", [range(7), [], iter([3])])
def test_each_unit_comes_back_once(kind, units, two):
    units = list(units)
    found = outcomes(ThisProcess() if kind == "here" else two, toy_jobs.squares, 5, units)
    assert all(isinstance(one, Done) and one.seconds >= 0 for one in found)
    assert sorted((one.unit, one.record) for one in found) == [(unit, 5 + unit * unit) for unit in units]


def test_processes_stay_for_the_next_job_and_share_the_work(two, tmp_path):
    first = {one.worker for one in outcomes(two, toy_jobs.lines, str(tmp_path), ["meet 2 a", "meet 2 b"])}
    then = {one.worker for one in outcomes(two, toy_jobs.squares, 1, range(20))}
    assert len(first) == 2
    assert then <= first


@pytest.mark.parametrize("kind", ["here", "local"])
def test_a_unit_that_raises_is_tried_again_and_named(kind, two, tmp_path):
    units = ["raise", "a", "b", "c"]
    found = {one.unit: one for one in outcomes(ThisProcess() if kind == "here" else two, toy_jobs.lines, str(tmp_path), units)}
    assert found.keys() == set(units)
    failed = found.pop("raise")
    assert isinstance(failed, Failed)
    assert (failed.error, failed.attempts) == ("ValueError: no waves", ATTEMPTS)
    assert "toy_jobs.py" in failed.traceback
    tried = toy_jobs.attempts(tmp_path, "raise")
    assert len(tried) == ATTEMPTS
    assert len(set(tried)) == (1 if kind == "here" else 2)
    assert all(isinstance(one, Done) for one in found.values())


def test_a_unit_that_kills_its_process_is_given_up_and_the_rest_goes_on(two, tmp_path, caplog):
    units = ["kill", *(f"unit {k}" for k in range(6)), "once"]
    found = {one.unit: one for one in outcomes(two, toy_jobs.lines, str(tmp_path), units)}
    failed = found.pop("kill")
    assert isinstance(failed, Failed)
    assert "was killed by SIGKILL" in failed.error
    assert (failed.traceback, failed.attempts) == ("", ATTEMPTS)
    assert len(set(toy_jobs.attempts(tmp_path, "kill"))) == ATTEMPTS
    assert {unit: one.record for unit, one in found.items()} == {unit: unit.upper() for unit in units[1:]}
    assert len(toy_jobs.attempts(tmp_path, "once")) == 2
    assert all(len(toy_jobs.attempts(tmp_path, f"unit {k}")) == 1 for k in range(6))
    lines = [line for line in caplog.messages if "was killed by SIGKILL; its unit is given to another process" in line]
    assert len(lines) == ATTEMPTS  # two of the unit that is given up, and the one of "once"


def test_a_process_killed_from_outside_is_replaced(two, tmp_path):
    with two.map(Job(toy_jobs.lines, str(tmp_path)), [f"sleep 0.0{k}" for k in range(1, 8)]) as found:
        first = next(found)
        os.kill(int(first.worker.split()[1]), signal.SIGKILL)
        rest = list(found)
    assert {one.unit for one in (first, *rest)} == {f"sleep 0.0{k}" for k in range(1, 8)}
    assert all(isinstance(one, Done) for one in rest)


def test_leaving_ends_a_process_that_is_at_a_long_unit(tmp_path):
    with LocalProcesses(2) as workers:
        with workers.map(Job(toy_jobs.lines, str(tmp_path)), iter(["a", "sleep 3600", "b", *["c"] * 100])) as found:
            processes = [int(next(found).worker.split()[1]) for _ in range(2)]
            toy_jobs.until(lambda: bool(toy_jobs.attempts(tmp_path, "sleep 3600")))
        # Who had waited for the unit would have left the process alive, for the next job.
        require_end(toy_jobs.attempts(tmp_path, "sleep 3600"))
        assert [one.record for one in outcomes(workers, toy_jobs.squares, 0, [3])] == [9]
    require_end(processes)


def test_units_are_taken_when_somebody_is_free_for_them(two):
    taken = []

    def units():
        for k in range(50):
            taken.append(k)
            yield k

    with two.map(Job(toy_jobs.squares, 0), units()) as found:
        next(found)
        assert len(taken) <= 4
        assert len(list(found)) == 49


@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
def test_processes_end_by_themselves_when_their_parent_is_killed(tmp_path):
    script = (
        "import sys, toy_jobs\nfrom seaglint.cluster import Job, LocalProcesses\n"
        "with LocalProcesses(2).map(Job(toy_jobs.lines, sys.argv[1]), ['sleep 3600', 'sleep 3601']) as found: next(found)\n"
    )
    path = os.pathsep.join(p for p in sys.path if p)
    parent = subprocess.Popen([sys.executable, "-c", script, str(tmp_path)], env={**os.environ, "PYTHONPATH": path})
    units = ["sleep 3600", "sleep 3601"]
    toy_jobs.until(lambda: parent.poll() is not None or all(toy_jobs.attempts(tmp_path, unit) for unit in units))
    assert parent.poll() is None
    parent.kill()
    parent.wait()
    require_end([process for unit in units for process in toy_jobs.attempts(tmp_path, unit)])


def test_processes_that_die_at_start_end_in_one_line(tmp_path):
    with LocalProcesses(2) as workers, pytest.raises(BackendError, match="ended before they were ready, the last was killed by SIGKILL"):
        outcomes(workers, toy_jobs.dies_at_start, str(tmp_path), range(5))
    assert ATTEMPTS <= len(list(tmp_path.iterdir())) <= ATTEMPTS + 2


@pytest.mark.parametrize(("kind", "expected"), [("seaglint", DomainError), ("other", KeyError)])
def test_what_the_start_refuses_is_raised_as_it_is(kind, expected, two):
    with pytest.raises(expected) as caught:
        outcomes(two, toy_jobs.refuses, kind, [1])
    if kind == "seaglint":
        assert (caught.value.name, caught.value.value) == ("wind_speed", 31.0)
    else:
        assert "toy_jobs.py" in caught.value.__notes__[0]


def test_a_record_that_cannot_be_sent_is_a_failure(two):
    (failed,) = outcomes(two, toy_jobs.unsendable, None, [1])
    assert isinstance(failed, Failed)
    assert "the record cannot be sent" in failed.error


@pytest.mark.parametrize(("count", "allowed", "expected"), [(2, "4", "2"), (2, "1", "1")])
def test_each_process_has_its_share_of_threads(count, allowed, expected, monkeypatch, tmp_path):
    monkeypatch.setenv("NUMBA_NUM_THREADS", allowed)
    with LocalProcesses(count) as workers:
        (one,) = outcomes(workers, toy_jobs.lines, str(tmp_path), ["environment"])
    assert one.record == f"{expected} 1"


@pytest.mark.parametrize("count", [0, 5000])
def test_counts_that_make_no_sense(count):
    with pytest.raises(DomainError, match="give 1 to"):
        LocalProcesses(count)
