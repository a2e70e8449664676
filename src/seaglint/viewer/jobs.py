"""Analyses that take longer than an answer may: one thread each, with progress, stopped when no browser asks for them."""

from __future__ import annotations

import itertools
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

from seaglint.base.errors import DataError, SeaglintError
from seaglint.base.free_form import JsonObject

if TYPE_CHECKING:
    from seaglint.base.conventions import Progress


PATIENCE: Final = 15.0  #: Time without a request after which a job is stopped, since its browser is closed [s].

MOST: Final = 4  #: Largest number of jobs at the same time.


class _StoppedError(Exception):
    """Error that ends a job whose result nobody waits for."""


@dataclass
class AnalysisJob:
    """One analysis: its progress, and its result or the text of its error."""

    done: int = 0
    total: int = 1
    result: JsonObject | None = None
    error: str | None = None
    asked: float = field(default_factory=time.monotonic)
    finished: threading.Event = field(default_factory=threading.Event)

    def progress(self, done: int, total: int) -> None:
        """Record the progress; raise where nobody waits for the result."""
        self.done, self.total = done, max(total, 1)
        if time.monotonic() - self.asked > PATIENCE:
            raise _StoppedError


class Jobs:
    """Running jobs and the last finished ones."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._jobs: dict[int, AnalysisJob] = {}
        self._numbers = itertools.count()

    def start(self, work: Callable[[Progress], JsonObject]) -> int:
        """Start ``work(progress)`` in a thread and return its number.

        Raises
        ------
        DataError
            Too many run already.
        """
        with self._lock:
            if sum(not job.finished.is_set() for job in self._jobs.values()) >= MOST:
                raise DataError(f"{MOST} analyses run already; wait for one of them")
            while len(self._jobs) >= 4 * MOST:
                self._jobs.pop(next(number for number, job in self._jobs.items() if job.finished.is_set()))
            number, job = next(self._numbers), AnalysisJob()
            self._jobs[number] = job

        def run() -> None:
            try:
                job.result = work(job.progress)
            except _StoppedError:
                job.error = "stopped: nobody waited for it"
            except SeaglintError as error:
                job.error = str(error)
            except Exception as error:
                job.error = f"failed: {type(error).__name__}: {error}"
                raise
            finally:
                job.finished.set()

        threading.Thread(target=run, name=f"analysis {number}", daemon=True).start()
        return number

    def get(self, number: int) -> AnalysisJob:
        """Return the job of a number, and restart its time-out.

        Raises
        ------
        DataError
            No such job.
        """
        job = self._jobs.get(number)
        if job is None:
            raise DataError(f"analysis {number}: is not known any more; start it again")
        job.asked = time.monotonic()
        return job
