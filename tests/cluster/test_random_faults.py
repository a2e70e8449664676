"""Jobs of 120 frames with a fault: the bytes of an undisturbed job, no job without an end, a line where the fault matters."""

from __future__ import annotations

import os
import signal
import sys
import threading
from contextlib import suppress

import pytest
import toy_jobs

from fault_jobs import RENDER, Site, processes_with
from fault_kinds import FOREVER, Fault, disturbed, drawn, lacking
from faults import references, row

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="stops processes that /proc lists")


@pytest.fixture(scope="module")
def expected():
    """Checksums of undisturbed outputs, each made once."""
    return references(threading.Event())


def outcome_of(fault, expected):
    if reason := lacking(fault):
        pytest.skip(reason)
    if fault.mode == "dask":
        pytest.importorskip("distributed")
    expected(fault.command, 7)
    return disturbed(fault, expected, toy_jobs.HANG)


def fault(kind, mode="local", **changes):
    usual = {"command": "render", "at": 0.3, "seconds": 0.0, "target": 1, "workers": 2, "nanny": False, "then": "wake", "amount": 0}
    return Fault(kind, mode, **(usual | changes))


@pytest.mark.parametrize(
    ("disturbance", "must_be_told"),
    [
        (fault("stop", seconds=FOREVER), True),
        (fault("stop", seconds=2.0), False),
        (fault("kill", at=0.5), False),
        (fault("clock", amount=-3600), False),
        (fault("share-twice", mode="shards"), True),
        (fault("job-twice"), True),
    ],
    ids=["stopped", "stopped-shortly", "killed", "clock", "share-twice", "job-twice"],
)
def test_a_fault_changes_no_byte(disturbance, must_be_told, expected):
    outcome = outcome_of(disturbance, expected)
    assert outcome.result == "same bytes", row(0, outcome)
    assert outcome.late or outcome.lines or not must_be_told


@pytest.mark.validation
@pytest.mark.parametrize("number", range(20))
def test_random_faults(number, expected):
    outcome = outcome_of(drawn(50, number), expected)
    assert outcome.good, row(number, outcome)


def test_a_site_leaves_no_process_behind():
    with suppress(KeyboardInterrupt), Site(RENDER) as site:
        stopped = site.help("sleep", "infinity", role="worker-0")
        site.wait(lambda: [process.number for process in processes_with(site.word)] == [stopped.pid], toy_jobs.HANG)
        os.kill(stopped.pid, signal.SIGSTOP)
        raise KeyboardInterrupt
    assert stopped.returncode == -signal.SIGKILL
    assert processes_with(site.word) == []
    assert not site.top.exists()
