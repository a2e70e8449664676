"""Limits of the time in which a worker must answer, the clock for them, and lines on workers that fail.

A worker that is frozen, swaps, or has lost its network or disk keeps its unit and reports no error. A worker without an answer for many
times the median time of the units is therefore *overdue*: its unit is given to another worker as well, and the first outcome counts. An
overdue worker continues; if it is only slow, the second computation costs time and nothing else.
"""

from __future__ import annotations

import statistics
import time
from collections import deque
from dataclasses import dataclass, field
from typing import Final

from seaglint.base.errors import StorageError

POLL: Final = 0.5  #: Longest time between two looks at the workers [s].


@dataclass(frozen=True)
class Limits:
    """Times without an answer after which a worker is overdue, and after which its unit is given up."""

    factor: float = 10.0  #: Ratio of the limit of a unit to the median time of finished units, and of the last limit to the first.
    unit_s: float = 30.0  #: Smallest limit of a unit [s].
    start_s: float = 120.0  #: Smallest limit of the start of a job in a worker [s].
    first_unit_s: float = 7200.0  #: Limit of a unit before any unit is finished [s].
    first_start_s: float = 1800.0  #: Limit of the start before any worker has started the job [s].
    last_s: float = 3600.0  #: Smallest time after which an overdue worker counts as lost [s].


@dataclass
class _Typical:
    """Limit by the median of measured times."""

    least: float
    first: float
    factor: float
    recent: deque[float] = field(default_factory=lambda: deque(maxlen=999))

    @property
    def limit(self) -> float:
        """Return the limit [s]."""
        return max(self.least, self.factor * statistics.median(self.recent)) if self.recent else self.first


class Patience:
    """Limits of one job by its measured times, and a clock that is independent of the time of day.

    Parameters
    ----------
    limits : Limits
        Smallest limits, and those without measured times.

    Notes
    -----
    The clock counts the time in which this process looks at its workers: a process that was stopped itself, or is busy with the outcomes,
    finds no worker overdue before it has read the answers that came in between.

    Examples
    --------
    >>> patience = Patience(Limits())
    >>> patience.limit(), patience.limit(starting=True)
    (7200.0, 1800.0)
    >>> for seconds in (1.0, 12.0, 90.0):
    ...     patience.add(seconds)
    >>> patience.limit(), patience.last_limit()
    (120.0, 3600.0)
    """

    def __init__(self, limits: Limits) -> None:
        self.limits = limits
        self.now = 0.0
        """Time of the clock [s]."""
        self._units = _Typical(limits.unit_s, limits.first_unit_s, limits.factor)
        self._starts = _Typical(limits.start_s, limits.first_start_s, limits.factor)
        self._read = time.monotonic()

    def tick(self) -> None:
        """Advance the clock."""
        read = time.monotonic()
        self.now += min(read - self._read, 2 * POLL)
        self._read = read

    def add(self, seconds: float, *, starting: bool = False) -> None:
        """Add the time of a finished unit, or of a start [s]."""
        (self._starts if starting else self._units).recent.append(seconds)

    def in_time(self, silent: float, *, starting: bool = False) -> bool:
        """Return True for a time without an answer below the smallest limit [s]; no median is computed for it."""
        return silent <= (self._starts if starting else self._units).least

    def limit(self, *, starting: bool = False) -> float:
        """Return the time without an answer after which a worker is overdue [s]."""
        return (self._starts if starting else self._units).limit

    def last_limit(self, *, starting: bool = False) -> float:
        """Return the time without an answer after which a worker counts as lost [s]."""
        return max(self.limits.last_s, self.limits.factor * self.limit(starting=starting))


def silence(who: str, seconds: float, effect: str) -> str:
    """Return the line that reports an overdue worker."""
    return f"{who} has not answered for {seconds:.0f} s, many times as long as usual: {effect}"


def disk_failure(who: str, error: str) -> str:
    """Return the line that reports a worker whose disk failed; empty for another error."""
    return f"{who}: {error}; its unit is given to another worker" if error.startswith(f"{StorageError.__name__}:") else ""
