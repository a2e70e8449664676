"""A time limit for a part of the suite, and the verdicts of a part as they come: two plugins of pytest.

``--most-seconds=N`` ends a part after N seconds, collection included. From then on no test begins. A test that is running is interrupted
by a signal; where compiled code does not return within ``GRACE`` seconds, its process is ended. Both, and the tests that did not begin,
are counted as "left out": neither passed nor failed. A test that has run for ``LONGEST`` seconds by itself hangs and has failed, whatever
the part's limit is: what hangs would be left out for ever.

``--judged=FILE`` gets a line whenever something happens ("collected", "begun" or the outcome, and the test), at once: what a part has
judged is known whatever ends it.
"""

from __future__ import annotations

import faulthandler
import os
import signal
import tempfile
import time
from collections import Counter, defaultdict
from collections.abc import Generator, Iterable
from contextlib import contextmanager
from types import FrameType
from typing import IO, Any

import pytest

GRACE = 120.0
"""How long compiled code may go on after the limit [s]."""
LONGEST = 600.0
"""Run time from which a test is taken to hang [s]."""
AGAIN = 20.0
"""Time after which a test is interrupted again [s]: a finaliser, for one, swallows exceptions."""
LEFT_OUT = "left out: the time of this part was over"
HANGS = f"has run for {LONGEST:g} s and is taken to hang; find what it waits for, or make it shorter"
SEVERITY = ("passed", "skipped", "xfailed", "xpassed", "left out", "failed")
"""Outcomes of a test's phases: the last of these is the test's."""


class CutOffError(pytest.skip.Exception):  # type: ignore[misc]
    """The part's time is over."""


def positive(text: str) -> float:
    """Seconds of the option."""
    value = float(text)
    if not 0.0 < value < float("inf"):
        raise ValueError(f"--most-seconds {text}: give a number of seconds above 0")
    return value


def add_options(parser: pytest.Parser) -> None:
    """Add the options of both plugins."""
    group = parser.getgroup("parts of the suite")
    group.addoption("--most-seconds", type=positive, metavar="N", help="begin no test, and end those that run, N seconds from now")
    group.addoption("--judged", metavar="FILE", help="write into FILE what is collected, begun and judged, as it happens")


def configure(config: pytest.Config, began: float) -> None:
    """Register the plugins that this process needs; ``began`` is the time of its start, where it is the first."""
    received: dict[str, Any] | None = getattr(config, "workerinput", None)
    limit: float | None = config.option.most_seconds
    # A long comparison may take longer than that; one that hangs is cut off and named, run after run.
    endless = bool(config.option.chosen)
    if received is not None:
        if limit:
            config.pluginmanager.register(TimeLimit(received["part_ends"], received["part_stacks"], endless), "time-limit")
        return
    if limit and not has_workers(config):
        config.pluginmanager.register(TimeLimit(began + limit, os.devnull, endless), "time-limit")
    config.pluginmanager.register(Verdicts(config.option.judged, began + limit if limit else None, endless), "verdicts")


def has_workers(config: pytest.Config) -> bool:
    """Whether other processes run the tests."""
    return bool(getattr(config.option, "numprocesses", None))


class TimeLimit:
    """The limit in a process that runs tests.

    Parameters
    ----------
    ends
        Time at which the part ends [s], by ``time.time``: other processes of this machine share it.
    stacks
        File for what a process was at that had to be ended.
    endless
        Whether a test of any run time is taken to be at work.
    """

    def __init__(self, ends: float, stacks: str, endless: bool = False) -> None:
        self.ends, self.endless = ends, endless
        self.began = 0.0
        self.interrupts = False
        self.stacks = open(stacks, "a", encoding="utf-8")  # noqa: SIM115
        self.signals = hasattr(signal, "setitimer")

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> bool | None:
        """Report a test as left out where the time is over."""
        self.began, self.interrupts = time.time(), False
        if self.began < self.ends:
            return None
        place = (str(item.path), (item.location[1] or 0) + 1, LEFT_OUT)
        report = pytest.TestReport(item.nodeid, item.location, {}, "skipped", place, "setup", left_out="not begun")
        item.ihook.pytest_runtest_logreport(report=report)
        return True

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_setup(self) -> Generator[None, Any, Any]:
        """Interrupt the fixtures."""
        with self.interrupted():
            return (yield)

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_call(self) -> Generator[None, Any, Any]:
        """Interrupt the test; what it has set up is taken down afterwards, whatever the time."""
        with self.interrupted():
            return (yield)

    @contextmanager
    def interrupted(self) -> Generator[None]:
        """Raise an exception in what runs inside when the time is over, and end the process where that does not help."""
        until = (self.ends if self.endless else min(self.ends, self.began + LONGEST)) - time.time()
        faulthandler.dump_traceback_later(max(until, 0.0) + GRACE, exit=True, file=self.stacks)
        if self.signals:
            before = signal.signal(signal.SIGALRM, self.over)
            signal.setitimer(signal.ITIMER_REAL, max(until, 0.001), AGAIN)
        try:
            yield
        finally:
            self.quiet()
            if self.signals:
                signal.signal(signal.SIGALRM, before)

    def quiet(self) -> None:
        """Interrupt nothing from now on."""
        if self.signals:
            signal.setitimer(signal.ITIMER_REAL, 0.0)
        faulthandler.cancel_dump_traceback_later()

    def over(self, number: int, frame: FrameType | None) -> None:
        """Raise what the signal stands for."""
        if not self.endless and time.time() - self.began >= LONGEST:
            pytest.fail(HANGS, pytrace=True)
        self.interrupts = True
        raise CutOffError(LEFT_OUT)

    @pytest.hookimpl(wrapper=True, tryfirst=True)
    def pytest_runtest_makereport(self, item: pytest.Item, call: pytest.CallInfo[None]) -> Generator[None, Any, pytest.TestReport]:
        """Name a test that was interrupted, also where another exception came of that.

        The exception of the interruption need not be seen: Python drops one that is raised in a callback from compiled code, such as LLVM,
        and the code that called it then fails in its own way.
        """
        self.quiet()  # once more: a signal that comes while the timer is being stopped leaves it running
        report: pytest.TestReport = yield
        if call.excinfo is not None and self.interrupts:
            report.outcome = "skipped"
            report.longrepr = (str(item.path), (item.location[1] or 0) + 1, LEFT_OUT)
            report.left_out = "cut off"  # type: ignore[attr-defined]
            vars(report).pop("wasxfail", None)
        return report


class Verdicts:
    """What a part has judged, in the process that prints it."""

    def __init__(self, judged: str | None, ends: float | None, endless: bool = False) -> None:
        self.endless = endless
        self.file: IO[str] | None = open(judged, "w", encoding="utf-8", buffering=1) if judged else None  # noqa: SIM115
        self.ends = ends
        self.begun: dict[str, float] = {}
        self.outcomes: dict[str, str] = {}
        self.collected = False
        self.stacks: dict[str, IO[str]] = {}
        self.ended = ""

    def write(self, what: str, tests: Iterable[str]) -> None:
        """Write a line for each test."""
        if self.file:
            self.file.writelines(f"{what}\t{test}\n" for test in tests)

    @pytest.hookimpl(optionalhook=True)
    def pytest_configure_node(self, node: Any) -> None:
        """Give a worker the time of the end, and where it leaves the stacks of its threads."""
        stacks = tempfile.NamedTemporaryFile("r", prefix="stacks", encoding="utf-8", errors="replace")  # noqa: SIM115
        self.stacks[node.gateway.id] = stacks
        node.workerinput |= {"part_ends": self.ends, "part_stacks": stacks.name}

    @pytest.hookimpl(optionalhook=True)
    def pytest_xdist_node_collection_finished(self, ids: list[str]) -> None:
        """Write what the first worker collected; the others collect the same."""
        if not self.collected:
            self.collected = True
            self.write("collected", ids)

    def pytest_collection_finish(self, session: pytest.Session) -> None:
        """Write what was collected where there are no workers."""
        if not has_workers(session.config):
            self.write("collected", (item.nodeid for item in session.items))

    def pytest_runtest_logstart(self, nodeid: str) -> None:
        """Write that a test begins."""
        self.begun[nodeid] = time.time()
        self.write("begun", [nodeid])

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Keep the worst outcome of a test's phases."""
        if getattr(report, "left_out", "") == "not begun":
            return
        outcome = outcome_of(report)
        if report.when in ("setup", "call", "teardown"):
            self.outcomes[report.nodeid] = max(self.outcomes.get(report.nodeid, outcome), outcome, key=SEVERITY.index)
        elif outcome != "left out":  # its process has ended: no phase follows
            self.write(outcome, [report.nodeid])

    def pytest_runtest_logfinish(self, nodeid: str) -> None:
        """Write the outcome of a test that has ended; a test that was cut off has none."""
        outcome = self.outcomes.pop(nodeid, "left out")
        if outcome != "left out":
            self.write(outcome, [nodeid])

    @pytest.hookimpl(optionalhook=True)
    def pytest_handlecrashitem(self, crashitem: str, report: pytest.TestReport) -> None:
        """Tell the test of a process that was ended for its time from one that crashed, and from one that hangs."""
        stacks = self.stacks[report.node.gateway.id].read()  # of this worker, which a new one follows
        self.ended += stacks
        if not stacks:
            return
        if not self.endless and time.time() - self.begun.get(crashitem, 0.0) >= LONGEST:
            report.longrepr = f"{crashitem} {HANGS}"
            return
        report.outcome = "skipped"
        report.longrepr = (crashitem.split("::")[0], 1, LEFT_OUT)
        report.left_out = "cut off"  # type: ignore[attr-defined]

    @pytest.hookimpl(tryfirst=True)
    def pytest_report_teststatus(self, report: pytest.TestReport) -> tuple[str, str, str] | None:
        """Count what was left out by itself; a letter for a test that was cut off, none for the others."""
        match getattr(report, "left_out", ""):
            case "cut off":
                return "left out", "c", "CUT OFF"
            case "not begun":
                return "left out", "", ""
        return None

    def pytest_terminal_summary(self, terminalreporter: pytest.TerminalReporter) -> None:
        """Print what was left out: the tests that were cut off, and a line for each room with its files."""
        left = terminalreporter.stats.get("left out", [])
        if left:
            terminalreporter.section("left out, the time of this part was over")
        for report in left:
            if report.left_out == "cut off":
                terminalreporter.write_line(f"cut off: {report.nodeid}")
        files = Counter(report.nodeid.split("::")[0] for report in left)
        rooms: dict[str, list[str]] = defaultdict(list)
        for file in sorted(files):
            rooms[room_of(file)].append(file)
        for room, names in rooms.items():
            listed = ", ".join(f"{name.rsplit('/', 1)[-1]} {files[name]}" for name in names)
            terminalreporter.write_line(f"{room}: {sum(files[name] for name in names)} ({listed})")
        if self.ended:
            terminalreporter.section("where a process was ended")
            terminalreporter.write(self.ended)


def outcome_of(report: pytest.TestReport) -> str:
    """Outcome of one phase of a test."""
    if getattr(report, "left_out", ""):
        return "left out"
    if hasattr(report, "wasxfail"):
        return "xfailed" if report.skipped else "xpassed"
    return str(report.outcome)


def room_of(file: str) -> str:
    """Room of a file of tests: its folder, or its own name where it is in none."""
    parts = file.split("/")
    return parts[1] if len(parts) > 2 else parts[-1].removesuffix(".py")
