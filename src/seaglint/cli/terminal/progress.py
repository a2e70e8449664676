"""Progress with rate and remaining time: a bar on a terminal, plain lines elsewhere, nothing on request; always on stderr."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from enum import StrEnum
from typing import TYPE_CHECKING

from seaglint.cli.terminal.messages import log

if TYPE_CHECKING:
    from seaglint.base.conventions import Progress


class ProgressMode(StrEnum):
    """Ways to show progress."""

    AUTO = "auto"
    BAR = "bar"
    LOG = "log"
    NONE = "none"


class Pace:
    """Pace of a piece of work, by the clock [s].

    The first piece is left out, since kernels are compiled and tables prepared in it: the rate is known from the second piece on.
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self.began = clock()
        self.before: int | None = None
        self.done = 0
        self.total = 0
        self._first: tuple[float, int] | None = None
        self._latest = self.began

    def report(self, done: int, total: int) -> None:
        """Record the number of finished pieces; the number of the first call is the work of an earlier run."""
        now = self._clock()
        if self.before is None:
            self.before = done
        # Only calls with new pieces move the clock: workers may report the same number again.
        if done > self.done or self.done == 0:
            self._latest = now
        if self._first is None and done > self.before:
            self._first = now, done
        self.done, self.total = done, total

    @property
    def elapsed(self) -> float:
        """Time since the work began [s]."""
        return self._clock() - self.began

    @property
    def rate(self) -> float | None:
        """Number of pieces per second after the first one; None while it is not known."""
        if self._first is None or self.done <= self._first[1] or self._latest <= self._first[0]:
            return None
        return (self.done - self._first[1]) / (self._latest - self._first[0])

    @property
    def left(self) -> float | None:
        """Time that the remaining pieces take at this rate [s]; None while it is not known."""
        rate = self.rate
        # Time since the latest piece has passed already; a slow piece must not make the rest negative.
        return None if rate is None else max((self.total - self.done) / rate - (self._clock() - self._latest), 0.0)


LOG_INTERVAL = 10.0  #: Least time between two lines of a log [s]: the log of a batch job of hours stays readable.


@contextmanager
def progress(mode: ProgressMode, what: str, pace: Pace | None = None, clock: Callable[[], float] = time.monotonic) -> Iterator[Progress]:
    """Provide a function to call with (done, total): once at the start, then after each piece of work.

    ``pace`` is the pace of work that began before the first call. Without it, pieces that are finished at the first call count as the work
    of an earlier run.
    """
    if mode is ProgressMode.AUTO:
        mode = ProgressMode.BAR if sys.stderr.isatty() else ProgressMode.LOG
    if mode is ProgressMode.BAR:
        with _bar(what, pace or Pace(clock)) as report:
            yield report
    elif mode is ProgressMode.LOG:
        yield log_lines(what, log, clock, pace)
    else:
        yield lambda done, total: None


PATIENCE = 2.0  #: Time before progress is shown where most runs are short [s].


@contextmanager
def patient_progress(mode: ProgressMode, what: str, clock: Callable[[], float] = time.monotonic) -> Iterator[Progress]:
    """Provide a function as ``progress`` does; it shows nothing before the work has lasted ``PATIENCE`` seconds."""
    pace = Pace(clock)
    shown: list[Progress] = []
    with ExitStack() as stack:

        def report(done: int, total: int) -> None:
            # Nothing is shown for the last piece alone: it would appear and vanish.
            if not shown and pace.before is not None and pace.elapsed >= PATIENCE and done < total:
                shown.append(stack.enter_context(progress(mode, what, pace, clock)))
            if shown:
                shown[0](done, total)
            else:
                pace.report(done, total)

        yield report


def log_lines(what: str, write: Callable[[str], None], clock: Callable[[], float] = time.monotonic, pace: Pace | None = None) -> Progress:
    """Return a function that writes a line at the start, at most every ``LOG_INTERVAL`` seconds, and at the end."""
    from seaglint.base.representation import duration

    known = pace or Pace(clock)
    last: list[float] = []

    def report(done: int, total: int) -> None:
        now, fresh = clock(), known.before is None
        known.report(done, total)
        if fresh:
            last.append(now)
            write(f"{what}: {total - done} to do" + (f", {done} of {total} there already" if done else ""))
            return
        if last and done < total and now - last[-1] < LOG_INTERVAL:
            return
        last.append(now)
        if done < total:
            left, rate = known.left, known.rate
            write(f"{what}: {done}/{total}" + ("" if left is None or rate is None else f", {rate:.3g} per s, {duration(left)} left"))
        else:
            # At the end the mean over the whole run, the first piece included.
            mean_rate = (done - (known.before or 0)) / max(known.elapsed, 1e-9)
            write(f"{what}: {done}/{total} in {duration(known.elapsed)}, {mean_rate:.3g} per s")

    return report


@contextmanager
def _bar(what: str, pace: Pace) -> Iterator[Progress]:
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, ProgressColumn, Task, TextColumn, TimeElapsedColumn
    from rich.progress import Progress as Bar
    from rich.text import Text

    from seaglint.base.representation import duration

    class Rate(ProgressColumn):
        """Column with pieces per second and remaining time; empty while they are not known."""

        def render(self, task: Task) -> Text:
            """Return rate and remaining time as text."""
            rate, left = pace.rate, pace.left
            return Text("" if rate is None or left is None or task.finished else f"{rate:.3g}/s, {duration(left)} left")

    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn(), Rate())
    with Bar(*columns, console=Console(stderr=True)) as shown:
        # A bar without a total moves until the first report.
        task = shown.add_task(what, total=None)

        def report(done: int, total: int) -> None:
            pace.report(done, total)
            shown.update(task, completed=done, total=total)

        yield report
