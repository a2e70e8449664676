"""Progress with rate and time left: a bar on a terminal, plain lines elsewhere, nothing on request; always on stderr."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from enum import StrEnum
from typing import TYPE_CHECKING, NamedTuple

from seaglint.cli.terminal.messages import log

if TYPE_CHECKING:
    from seaglint.base.conventions import Progress


class ProgressMode(StrEnum):
    """How progress is shown."""

    AUTO = "auto"
    BAR = "bar"
    LOG = "log"
    NONE = "none"


class Began(NamedTuple):
    """When the work of this run began, by the clock [s], and how much was done then."""

    time: float
    done: int


LOG_INTERVAL = 10.0
"""Seconds between two lines of a log: a batch job of hours stays readable."""


@contextmanager
def progress(mode: ProgressMode, what: str, began: Began | None = None, clock: Callable[[], float] = time.monotonic) -> Iterator[Progress]:
    """Function to call with (done, total): once at the start, then after each piece of work.

    ``began`` tells of work that had begun before the first call; without it, what is done then counts as done by an earlier run.
    """
    if mode is ProgressMode.AUTO:
        mode = ProgressMode.BAR if sys.stderr.isatty() else ProgressMode.LOG
    if mode is ProgressMode.BAR:
        with _bar(what) as report:
            yield report
    elif mode is ProgressMode.LOG:
        yield log_lines(what, log, clock, began)
    else:
        yield lambda done, total: None


PATIENCE = 2.0
"""Seconds that work may take before its progress is shown where most runs are short."""


@contextmanager
def patient_progress(mode: ProgressMode, what: str, clock: Callable[[], float] = time.monotonic) -> Iterator[Progress]:
    """:func:`progress` that appears only when the work has lasted :data:`PATIENCE` seconds."""
    start = clock()
    began: list[Began] = []
    shown: list[Progress] = []
    with ExitStack() as stack:

        def report(done: int, total: int) -> None:
            if not began:
                began.append(Began(start, done))
            if not shown and clock() - start >= PATIENCE and done < total:
                shown.append(stack.enter_context(progress(mode, what, began[0], clock)))
            if shown:
                shown[0](done, total)

        yield report


def duration(seconds: float) -> str:
    """Time span as people say it.

    >>> duration(42.4), duration(600), duration(7500)
    ('42 s', '10 min', '2 h 05 min')
    """
    if seconds < 99.5:
        return f"{seconds:.0f} s"
    minutes = round(seconds / 60.0)
    return f"{minutes} min" if minutes < 100 else f"{minutes // 60} h {minutes % 60:02d} min"


def log_lines(what: str, write: Callable[[str], None], clock: Callable[[], float] = time.monotonic, began: Began | None = None) -> Progress:
    """Report that writes a line at the start, at most every :data:`LOG_INTERVAL` seconds, and at the end."""
    start: list[Began] = []
    last = [0.0]

    def report(done: int, total: int) -> None:
        now = clock()
        if not start:
            start.append(began or Began(now, done))
            last[0] = now
            before = start[0].done
            if done == before:
                write(f"{what}: {total - done} to do" + (f", {done} of {total} there already" if done else ""))
                return
        elif done < total and now - last[0] < LOG_INTERVAL:
            return
        last[0] = now
        then, before = start[0]
        rate = (done - before) / max(now - then, 1e-9)
        if done < total:
            write(f"{what}: {done}/{total}, {rate:.3g} per s, {duration((total - done) / max(rate, 1e-9))} left")
        else:
            write(f"{what}: {done}/{total} in {duration(now - then)}, {rate:.3g} per s")

    return report


@contextmanager
def _bar(what: str) -> Iterator[Progress]:
    from rich.console import Console
    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        ProgressColumn,
        Task,
        TextColumn,
        TimeElapsedColumn,
        TimeRemainingColumn,
    )
    from rich.progress import (
        Progress as Bar,
    )
    from rich.text import Text

    class Rate(ProgressColumn):
        """Pieces per second since this run began."""

        def render(self, task: Task) -> Text:
            """Rate as text."""
            before = int(task.fields.get("before", 0))
            elapsed = task.finished_time if task.finished_time is not None else task.elapsed
            return Text(f"{(task.completed - before) / elapsed:.3g}/s" if elapsed and task.completed > before else "-/s")

    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), Rate(), TimeElapsedColumn(), TimeRemainingColumn())
    with Bar(*columns, console=Console(stderr=True)) as shown:
        task = shown.add_task(what, total=None)
        seen: list[int] = []

        def report(done: int, total: int) -> None:
            if not seen:
                seen.append(done)
                shown.update(task, before=done)
            shown.update(task, completed=done, total=total)

        yield report
