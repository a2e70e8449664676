"""Workers on this machine: the calling process itself, or local processes that get one unit at a time and are replaced if they die.

The pool of the standard library is no alternative: one killed process breaks it as a whole. Processes are started fresh, not forked, since
the threads of kernels do not survive a fork; each has its share of the processor's threads.
"""

from __future__ import annotations

import hashlib
import math
import os
import pickle
import signal
import socket
import struct
import subprocess
import sys
import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from multiprocessing.connection import Connection, wait
from pathlib import Path
from typing import Any, Final

from seaglint.base.errors import BackendError, DomainError, SeaglintError
from seaglint.base.reports import REPORTS
from seaglint.cluster.job import ATTEMPTS, Done, Failed, Job, Record, Settings, Unit, attempt, outgoing
from seaglint.cluster.overdue import POLL, Limits, Patience, disk_failure, silence


class ThisProcess:
    """Worker that is the calling process itself."""

    count = 1

    @contextmanager
    def map(self, job: Job[Settings, Unit, Record], units: Iterable[Unit]) -> Iterator[Iterator[Done[Unit, Record] | Failed[Unit]]]:
        """Yield the outcomes of all units in their order; see ``seaglint.cluster.job.Workers``."""
        work = job.start(job.settings)

        def outcomes() -> Iterator[Done[Unit, Record] | Failed[Unit]]:
            for unit in units:
                for tried in range(1, ATTEMPTS + 1):
                    outcome = attempt(work, unit, "here", tried)
                    if isinstance(outcome, Done):
                        break
                yield outcome

        yield outcomes()


MOST: Final = 1024  #: Largest number of processes.

GRACE: Final = 2.0  #: Time that units in progress have to end after cancellation, before their processes are killed [s].

MESSAGE: Final = 30  #: Time within which a message must be read or written once it has begun [s].

_ONE_THREAD: Final = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")


class _LostError(Exception):
    """Error of a process that has ended, or stopped within a message."""


@dataclass(eq=False)
class _LocalTask:
    """Unit in progress, in several processes if some are overdue."""

    unit: Any
    tried_by: list[int] = field(default_factory=list)  #: Process numbers of its attempts.
    ended: bool = False  #: Whether its outcome was yielded.


class _Worker:
    """One process and the pipe to it."""

    def __init__(self, threads: int) -> None:
        ours, theirs = socket.socketpair()
        for option in (socket.SO_RCVTIMEO, socket.SO_SNDTIMEO):  # a process may be frozen within a message
            ours.setsockopt(socket.SOL_SOCKET, option, struct.pack("ll", MESSAGE, 0))
        with theirs:
            number = theirs.fileno()
            # the worker finds what its parent can import
            path = os.pathsep.join(os.path.abspath(p) for p in sys.path)
            environment = os.environ | {"PYTHONPATH": path, "NUMBA_NUM_THREADS": str(threads)} | dict.fromkeys(_ONE_THREAD, "1")
            # in a new session Ctrl-C reaches only the parent; text that a unit prints goes to stderr, as stdout may have a result
            self.process = subprocess.Popen(
                [sys.executable, "-P", "-m", "seaglint.cluster.process", str(number)],
                pass_fds=[number],
                stdin=subprocess.DEVNULL,
                stdout=2,
                env=environment,
                start_new_session=True,
            )
        self.pipe = Connection(ours.detach())
        self.job: str = ""
        """Digest of the job that was sent to the process."""
        self.ready = False
        self.task: _LocalTask | None = None
        self.spent = 0
        """Processor time at the last look [ticks]."""
        self.computed = -math.inf
        """Time of the last look at which the processor time had grown, by the clock of the job [s]."""
        self.heard = 0.0
        """Time of its last answer, or of the request, by the clock of the job [s]."""
        self.overdue = False

    @property
    def number(self) -> int:
        """Return the number of the process in the system."""
        return self.process.pid

    def computes(self, now: float, within: float) -> bool:
        """Return True if the process used processor time in the last seconds of the job's clock, as far as the system shows it."""
        with suppress(OSError, ValueError, IndexError):
            fields = Path(f"/proc/{self.number}/stat").read_text(encoding="ascii", errors="replace").rpartition(")")[2].split()
            spent = int(fields[11]) + int(fields[12])  # in user and system mode
            if spent > self.spent:
                self.spent, self.computed = spent, now
        return now - self.computed <= within

    def send(self, *message: Any) -> None:
        """Send a message; the end of a process is noticed when its answer is read."""
        with suppress(OSError):
            self.pipe.send(message)

    def answer(self) -> tuple[Any, ...]:
        """Return the next message of the process.

        Raises
        ------
        _LostError
            The process has ended, or stopped within the message.
        """
        try:
            message: tuple[Any, ...] = self.pipe.recv()
        except (EOFError, OSError, pickle.UnpicklingError):
            raise _LostError from None
        return message

    def end(self) -> str:
        """Kill the process if it lives, and return the kind of its end as words."""
        self.pipe.close()
        self.process.kill()
        try:
            code = self.process.wait(GRACE)
        except subprocess.TimeoutExpired:  # it waits for a disk that does not answer, and ends when the disk does
            return "does not end"
        if code >= 0:
            return f"ended with code {code}"
        try:
            return f"was killed by {signal.Signals(-code).name}"
        except ValueError:
            return f"was killed by signal {-code}"


class LocalProcesses:
    """Processes on this machine; they remain for the next job until the context is left.

    Parameters
    ----------
    count : int
        Number of processes.
    threads : int, optional
        Threads of the kernels in each; by default the machine's threads, or as many as ``NUMBA_NUM_THREADS`` allows, divided evenly.
        Results do not depend on it.
    report : callable, optional
        Function that prints a line for the user; by default the log of seaglint.
    limits : Limits
        Times after which a process without an answer is overdue.

    Raises
    ------
    DomainError
        A count below 1 or above ``MOST``.
    """

    def __init__(
        self,
        count: int,
        *,
        threads: int | None = None,
        report: Callable[[str], None] = REPORTS.warning,
        limits: Limits = Limits(),  # noqa: B008 - it is frozen
    ) -> None:
        if not 1 <= count <= MOST:
            raise DomainError(f"{count} worker processes; give 1 to {MOST}", name="workers", value=count, allowed=(1, MOST))
        self.threads = threads_each(count) if threads is None else threads
        self._count, self._report, self._limits = count, report, limits
        self._workers: list[_Worker] = []
        self._mapping = False

    @property
    def count(self) -> int:
        """Return the number of units that are worked on at the same time."""
        return self._count

    def __enter__(self) -> LocalProcesses:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """End all processes."""
        for worker in self._workers:
            worker.end()
        self._workers.clear()

    @contextmanager
    def map(self, job: Job[Settings, Unit, Record], units: Iterable[Unit]) -> Iterator[Iterator[Done[Unit, Record] | Failed[Unit]]]:
        """Yield the outcomes of all units as they finish; see ``seaglint.cluster.job.Workers``.

        Units are taken from their iterable when a process is free for them; if the iterable ends early, the units taken before are
        finished. Leaving the context lets units in progress end within ``GRACE`` seconds.

        Raises
        ------
        BackendError
            Processes die repeatedly before they are ready.
        Exception
            Error of the job's start in a process.
        """
        if self._mapping:
            raise RuntimeError("these workers are at another job; leave its context first")
        self._mapping = True
        try:
            yield _LocalMapping(self._workers, self._count, self.threads, Patience(self._limits), self._report, job, units).outcomes()
        finally:
            try:
                self._settle()
            finally:
                for worker in [w for w in self._workers if w.task is not None or w.overdue]:
                    worker.end()
                    self._workers.remove(worker)
                for worker in self._workers[self._count :]:  # replacements of processes that answered in the end
                    worker.end()
                del self._workers[self._count :]
                self._mapping = False

    def _settle(self) -> None:
        """Wait a limited time for units in progress, not for those of overdue processes."""
        until = time.monotonic() + GRACE
        while busy := [worker for worker in self._workers if worker.task is not None and not worker.overdue]:
            ready = wait([worker.pipe for worker in busy], max(until - time.monotonic(), 0.0))
            if not ready:
                return
            for worker in busy:
                if worker.pipe in ready:
                    with suppress(_LostError):  # the next job replaces it
                        worker.answer()
                    worker.task = None


class _LocalMapping:
    """Progress of one job over the processes; ``workers`` is the owner's list, which is updated."""

    def __init__(
        self,
        workers: list[_Worker],
        count: int,
        threads: int,
        patience: Patience,
        report: Callable[[str], None],
        job: Job[Any, Any, Any],
        units: Iterable[Any],
    ) -> None:
        self.workers, self.count, self.threads = workers, count, threads
        self.patience, self.report = patience, report
        self.content = outgoing((job.start, job.settings))
        self.job = hashlib.blake2b(self.content, digest_size=16).hexdigest()
        self.source = iter(units)
        self.queue: deque[_LocalTask] = deque()
        self.exhausted = False
        self.faulty: set[int] = set()
        """Numbers of processes whose failing disk was reported."""
        self.lost_at_start = 0
        """Number of consecutive processes that ended before they were ready."""

    def outcomes(self) -> Iterator[Done[Any, Any] | Failed[Any]]:
        """Yield the outcomes of the units."""
        while True:
            self._take_units()
            if self.exhausted and not self.queue and all(worker.task is None or worker.task.ended for worker in self.workers):
                return
            self._start_workers()
            self._hand_out()
            ready = set(wait([worker.pipe for worker in self.workers], POLL))
            self.patience.tick()
            for worker in [w for w in self.workers if w.pipe in ready]:
                if worker not in self.workers:  # ended, as another process has finished its unit
                    continue
                try:
                    outcome = self._read(worker, worker.answer())
                except _LostError:
                    outcome = self._lost(worker)
                if outcome is not None:
                    yield outcome
            for worker in [w for w in self.workers if w.pipe not in ready and (w.task is not None or not w.ready)]:
                if (outcome := self._judge(worker)) is not None:
                    yield outcome

    @property
    def working(self) -> int:
        """Return the number of units in progress, without those of overdue processes."""
        return sum(worker.task is not None and not worker.overdue for worker in self.workers)

    def _take_units(self) -> None:
        """Take a unit for each idle process."""
        while not self.exhausted and len(self.queue) + self.working < self.count:
            if (task := self._next()) is not None:
                self.queue.append(task)

    def _start_workers(self) -> None:
        """Start a process for each unit and replacements of overdue ones, and send the job to all of them."""
        for worker in [w for w in self.workers if w.task is None and w.process.poll() is not None]:
            if worker.job != self.job:  # it died between two jobs: no unit is lost, and it does not count as a failed start
                worker.end()
                self.workers.remove(worker)
        overdue = sum(worker.overdue for worker in self.workers)
        # overdue processes hold memory: a limited number of them is replaced
        most = self.count + min(overdue, max(self.count, ATTEMPTS - 1))
        while len(self.workers) < min(len(self.queue) + self.working + overdue, most):
            if self.lost_at_start >= ATTEMPTS and self.workers:
                break  # more processes failed to start: continue with those that run
            self.workers.append(_Worker(self.threads))
        for worker in self.workers:
            if worker.job != self.job:
                worker.job, worker.ready, worker.heard = self.job, False, self.patience.now
                worker.send("job", self.job, self.content)

    def _hand_out(self) -> None:
        """Give each idle process a unit: preferably one that has not failed in this process."""
        for worker in self.workers:
            if worker.ready and worker.task is None and (task := self._task_for(worker)) is not None:
                worker.task, worker.heard = task, self.patience.now
                task.tried_by.append(worker.number)
                worker.send("unit", outgoing(task.unit))

    def _task_for(self, worker: _Worker) -> _LocalTask | None:
        others = [other for other in self.workers if other is not worker and not other.overdue]
        for task in self.queue:
            # a unit that failed in one process goes to another, if there is one
            if worker.number not in task.tried_by or all(other.number in task.tried_by for other in others):
                self.queue.remove(task)
                return task
        return self._next()

    def _next(self) -> _LocalTask | None:
        """Return the next new unit; None when all are taken."""
        for unit in self.source:
            return _LocalTask(unit)
        self.exhausted = True
        return None

    def _read(self, worker: _Worker, message: tuple[Any, ...]) -> Done[Any, Any] | Failed[Any] | None:
        """Handle a message of a process; return the outcome in it, if any."""
        waited, worker.heard, worker.overdue = self.patience.now - worker.heard, self.patience.now, False
        match message:
            case ("ready", job) if job == self.job:
                worker.ready, self.lost_at_start = True, 0
                self.patience.add(waited, starting=True)
            case ("refused", job, pickled, line, where) if job == self.job:
                worker.job = ""
                self.lost_at_start += 1
                # an error of the user's input is final; others may be a fault of one process
                error = pickle.loads(pickled) if pickled is not None else RuntimeError(line)
                if isinstance(error, SeaglintError):
                    raise error
                if self.lost_at_start >= ATTEMPTS:
                    error.add_note(f"raised in process {worker.number}:\n{where}")
                    raise error
            case ("outcome", content):
                task, worker.task = worker.task, None
                assert task is not None  # only a unit has an outcome
                if task.ended:  # another process was faster
                    return None
                outcome: Done[Any, Any] | Failed[Any] = pickle.loads(content)
                if isinstance(outcome, Failed):
                    failed = self._again(task, outcome.error, outcome.traceback)
                    line = disk_failure(f"worker process {worker.number}", outcome.error)
                    if line and failed is None and worker.number not in self.faulty:
                        self.faulty.add(worker.number)
                        self.report(line)
                    return failed
                self.patience.add(outcome.seconds)
                self._end(task)
                return Done(task.unit, outcome.record, outcome.seconds, outcome.worker)
        return None

    def _end(self, task: _LocalTask) -> None:
        """Take back a unit that has its outcome: overdue processes that hold it are ended."""
        task.ended = True
        if task in self.queue:
            self.queue.remove(task)
        for worker in [w for w in self.workers if w.task is task and w.overdue]:
            worker.end()
            self.workers.remove(worker)

    def _judge(self, worker: _Worker) -> Failed[Any] | None:
        """Give the unit of an overdue process to another one; return the outcome of a unit without further attempts."""
        silent, starting, task = self.patience.now - worker.heard, not worker.ready, worker.task
        if self.patience.in_time(silent, starting=starting):
            return None
        last = self.patience.last_limit(starting=starting)
        if worker.overdue and worker.computes(self.patience.now, last):  # slow, and not frozen
            last *= self.patience.limits.factor
        if silent > last:
            return self._lost(worker, f"did not answer for {silent:.0f} s and was ended")
        if worker.overdue or silent <= self.patience.limit(starting=starting):
            return None
        worker.overdue = True
        if task is None:
            effect = "another process is started"
        elif task.ended or task in self.queue or len(task.tried_by) >= ATTEMPTS:
            effect = "the command waits for it no longer" if task.ended else "its unit has no further attempts"
        else:
            self.queue.append(task)
            effect = "its unit is given to another process"
        self.report(silence(f"worker process {worker.number}", silent, effect))
        return None

    def _lost(self, worker: _Worker, how: str = "") -> Failed[Any] | None:
        """Remove a process that has ended, and queue its unit again; return the outcome of a unit without further attempts."""
        self.workers.remove(worker)
        end = worker.end()
        if (task := worker.task) is not None:
            outcome = self._again(task, f"worker process {worker.number} {how or end}", "")
            if task in self.queue:  # a unit without further attempts is reported by the caller
                self.report(f"worker process {worker.number} {how or end}; its unit is given to another process")
            return outcome
        if not worker.ready:
            self.lost_at_start += 1
            if self.lost_at_start >= ATTEMPTS and not self.workers:
                raise BackendError(
                    f"{self.lost_at_start} worker processes one after the other ended before they were ready, the last {how or end}; "
                    "try fewer workers if memory is short, or none, and see the lines above"
                )
        return None

    def _again(self, task: _LocalTask, error: str, where: str) -> Failed[Any] | None:
        """Queue a unit once more, or return it as failed if no process is at it."""
        if task.ended or task in self.queue:
            return None
        if len(task.tried_by) < ATTEMPTS:
            self.queue.append(task)
        elif not any(worker.task is task for worker in self.workers):
            task.ended = True
            return Failed(task.unit, error, where, len(task.tried_by))
        return None


def threads_each(count: int) -> int:
    """Return the number of threads for each of several processes on this machine."""
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    allowed = os.environ.get("NUMBA_NUM_THREADS", "")
    return max((int(allowed) if allowed.isdigit() else cores) // count, 1)
