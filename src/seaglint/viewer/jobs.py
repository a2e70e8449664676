"""Long computations for a page: one thread each, with progress; they end when they are cancelled or nobody requests their progress."""

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

PATIENCE: Final = 15.0  #: Time without a request after which a job is stopped, since its browser has been closed [s].

MOST: Final = 4  #: Largest number of jobs that run at the same time.


class StoppedError(Exception):
    """Error that ends a job that was cancelled, or whose result nobody waits for."""


@dataclass
class PageJob:
    """Computation in progress: numbers of steps, and finally its result or the text of its error."""

    done: int = 0
    total: int = 1
    result: JsonObject | None = None
    error: str | None = None
    requested: float = field(default_factory=time.monotonic)
    cancelled: bool = False
    finished: threading.Event = field(default_factory=threading.Event)

    def progress(self, done: int, total: int) -> None:
        """Record the progress; raise where the job was cancelled, or nobody waits for the result."""
        self.done, self.total = done, max(total, 1)
        if self.cancelled or time.monotonic() - self.requested > PATIENCE:
            raise StoppedError


class Jobs:
    """Running jobs, and the latest finished jobs."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._jobs: dict[int, PageJob] = {}
        self._numbers = itertools.count()

    def start(self, work: Callable[[Progress], JsonObject]) -> int:
        """Start ``work(progress)`` in a thread and return its number.

        Raises
        ------
        DataError
            Too many jobs run already.
        """
        with self._lock:
            if sum(not job.finished.is_set() for job in self._jobs.values()) >= MOST:
                raise DataError(f"{MOST} computations run already; wait for one of them")
            # Finished jobs are discarded from the oldest on; at most MOST run, so that one of 4 MOST is always finished.
            while len(self._jobs) >= 4 * MOST:
                self._jobs.pop(next(number for number, job in self._jobs.items() if job.finished.is_set()))
            number, job = next(self._numbers), PageJob()
            self._jobs[number] = job

        def run() -> None:
            try:
                job.result = work(job.progress)
            except StoppedError:
                job.error = "cancelled" if job.cancelled else "stopped: nobody waited for it"
            except SeaglintError as error:
                job.error = str(error)
            # The page reports the defect, and the thread's traceback is printed.
            except Exception as error:
                job.error = f"failed: {type(error).__name__}: {error}"
                raise
            finally:
                job.finished.set()

        threading.Thread(target=run, name=f"job {number}", daemon=True).start()
        return number

    def get(self, number: int) -> PageJob:
        """Return the job of a number, and restart its time-out.

        Raises
        ------
        DataError
            The number is not the number of a job.
        """
        job = self._jobs.get(number)
        if job is None:
            raise DataError(f"job {number}: is not known any more; start it again")
        job.requested = time.monotonic()
        return job
