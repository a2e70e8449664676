"""Progress of a job over the workers of a Dask scheduler: which units are sent, done, overdue and sent again."""

from __future__ import annotations

import pickle
import queue
import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any, Final, Protocol

from seaglint.base.errors import BackendError, SeaglintError, one_line
from seaglint.cluster.job import ATTEMPTS, Done, Failed
from seaglint.cluster.overdue import POLL, Limits, Patience, disk_failure, silence
from seaglint.cluster.remote import Started, Unfit

REFRESH: Final = 2.0  #: Time between two queries of the list of workers [s].

AHEAD: Final = 2  #: Units assigned to each worker in advance: one in progress, and the next.

BATCH: Final = 4  #: Divisor of the batch size: units are sent when a ``BATCH``-th of the workers need one.

TOGETHER: Final = 1e-4  #: Time for each worker in which records are gathered before they are read [s].

ANSWER: Final = 30.0  #: Time within which the scheduler must answer a request [s].


@dataclass(eq=False)
class _DaskTask:
    unit: Any
    attempts: int = 0  #: Number of attempts, including those in progress.
    keys: set[str] = field(default_factory=set)  #: Keys of the attempts in progress.
    failed_at: set[str] = field(default_factory=set)  #: Addresses of workers at which it failed.
    strays: int = 0  #: Number of attempts whose workers left.
    ended: bool = False  #: Whether its outcome was yielded.


@dataclass(eq=False)
class _Sent:
    """One attempt of a unit."""

    future: Any
    task: _DaskTask
    at: float  #: Time of the request, by the clock of the job [s].
    allowed: frozenset[str]  #: Addresses of the workers that may do it; empty for all.
    overdue: bool = False
    finished: bool = False  #: Whether the scheduler reported its end before its outcome arrived.


class SchedulerGoneError(Exception):
    """The connection to the scheduler is lost."""


class Connection(Protocol):
    """Workers of a scheduler as the progress of a job needs them; see ``seaglint.cluster.dask.DaskWorkers``."""

    inbox: queue.SimpleQueue[Any]
    silent: set[str]
    report: Callable[[str], None]
    patience: float
    limits: Limits

    @property
    def count(self) -> int:
        """Return the number of workers that units can be given to."""
        ...

    @property
    def idle(self) -> bool:
        """Return True if a unit can be given to a worker."""
        ...

    @property
    def connected(self) -> bool:
        """Return True while the scheduler is connected."""
        ...

    def look(self, *, at_once: bool = False) -> tuple[str, ...]:
        """Return the addresses of the workers that can be used."""
        ...

    def submit(self, units: list[Any], content: bytes, avoided: frozenset[str] = ...) -> tuple[list[Any], frozenset[str]]:
        """Return futures of units and the workers that may do them (empty for all)."""
        ...

    def processing(self) -> dict[str, list[str]]:
        """Return the keys of the tasks of each worker."""
        ...

    def cancel(self, futures: list[Any]) -> None:
        """Cancel futures."""
        ...

    def reconnect(self) -> None:
        """Wait until the scheduler answers again."""
        ...


class DaskMapping:
    """Progress of one job over the Dask workers."""

    def __init__(self, workers: Connection, content: bytes, units: Iterable[Any]) -> None:
        self.workers, self.content, self.source = workers, content, iter(units)
        self.patience = Patience(workers.limits)
        self.again: deque[_DaskTask] = deque()
        self.flight: dict[str, _Sent] = {}
        """Attempts in progress by the keys of their tasks, the oldest first."""
        self.moved: dict[str, _DaskTask] = {}
        """Units taken from overdue workers; one of them may have been in progress and sends an outcome."""
        self.heard: dict[str, float] = {}
        """Times of the workers' last messages in this job [s]."""
        self.faulty: set[str] = set()
        """Addresses of workers whose failing disk was reported."""
        self.judged = 0.0
        self.losses = 0
        """Number of consecutive losses of the scheduler with nothing done in between."""

    def outcomes(self) -> Iterator[Done[Any, Any] | Failed[Any]]:
        """Yield the outcomes of the units."""
        last_seen = time.monotonic()
        while True:
            try:
                if not self._fill():
                    with suppress(SchedulerGoneError):  # a worker that left just before the end is reported too
                        self.workers.look(at_once=True)
                    return
                messages = self._wait()
                self.patience.tick()
                if self.workers.look() and (self.flight or self.workers.idle):
                    last_seen = time.monotonic()
                elif time.monotonic() - last_seen > self.workers.patience:
                    raise BackendError(
                        f"no worker was left for {self.workers.patience:g} s; finished units remain: start some, "
                        "and continue with resume=True"
                    )
                for outcome in self._read(messages):
                    self.losses = 0
                    yield outcome
                if not messages or self.patience.now - self.judged > REFRESH:
                    self.judged = self.patience.now
                    yield from self._read_states()
                    yield from self._judge()
            except SchedulerGoneError as error:
                self._lost(error)
                last_seen = time.monotonic()

    def cancel(self) -> None:
        """Cancel all unfinished units."""
        futures, self.flight = [sent.future for sent in self.flight.values()], {}
        self.workers.cancel(futures)

    def _fill(self) -> bool:
        """Submit units until enough are on their way; return False when nothing is left."""
        tasks: list[_DaskTask] = []
        count = self.workers.count
        room = AHEAD * count - sum(not sent.overdue for sent in self.flight.values())
        if room < count // BATCH:  # a call costs more than its units, and workers still have a unit in advance
            return True
        for _ in range(room):
            task = self.again.popleft() if self.again else next((_DaskTask(unit) for unit in self.source), None)
            if task is None:
                break
            tasks.append(task)
        if tasks and not self.workers.idle:
            self.again.extendleft(reversed(tasks))
            return True
        groups: dict[frozenset[str], list[_DaskTask]] = {}
        for task in tasks:
            groups.setdefault(frozenset(task.failed_at), []).append(task)
        while groups:
            avoided, group = groups.popitem()
            try:
                futures, allowed = self.workers.submit([task.unit for task in group], self.content, avoided)
            except SchedulerGoneError:
                for rest in (*groups.values(), group):
                    self.again.extendleft(reversed(rest))
                raise
            for future, task in zip(futures, group, strict=True):
                self.flight[future.key] = _Sent(future, task, self.patience.now, allowed)
                task.keys.add(future.key)
                task.attempts += 1
        return bool(self.flight)

    def _wait(self) -> list[Any]:
        """Return the messages of workers; none after a time-out."""
        messages = []
        inbox = self.workers.inbox
        with suppress(queue.Empty):
            messages.append(inbox.get(timeout=POLL))
            # a short wait gathers the records of many workers, so that as many units are sent in one request
            time.sleep(min(TOGETHER * self.workers.count, 0.05))
            while True:
                messages.append(inbox.get_nowait())
        if not self.workers.connected:
            raise SchedulerGoneError("the connection is closed")
        return messages

    def _read(self, messages: list[Any]) -> Iterator[Done[Any, Any] | Failed[Any]]:
        """Yield the outcomes in messages; units to be tried again are queued."""
        for _, (key, address, content) in messages:
            self.workers.silent.discard(address)
            self.heard[address] = self.patience.now
            task = self.moved.pop(key, None)
            if key not in self.flight and (task is None or task.ended):  # of a cancelled attempt, or an earlier job
                continue
            outcome = pickle.loads(content)
            if isinstance(outcome, Started):
                self.patience.add(outcome.seconds, starting=True)
                continue
            if task is None:
                task = self._taken(key)
            elif not isinstance(outcome, Done):  # it is given to another worker anyway
                continue
            # an error of the job's start may be a fault of one worker, and is tried again, unless the user must correct it
            if isinstance(outcome, Exception):
                if isinstance(outcome, SeaglintError) or task.attempts >= ATTEMPTS:
                    raise outcome
                task.failed_at.add(address)
                yield from self._retry(task, "", "")
            elif isinstance(outcome, Unfit):
                self._return([task])
                self.workers.look(at_once=True)  # units go to known workers until it is described
            elif isinstance(outcome, Done):
                self.patience.add(outcome.seconds)
                task.ended = True
                self._drop(list(task.keys))
                if task in self.again:
                    self.again.remove(task)
                yield Done(task.unit, outcome.record, outcome.seconds, outcome.worker)
            else:
                task.failed_at.add(address)
                line = disk_failure(f"worker {address}", outcome.error)
                if line and task.attempts < ATTEMPTS and address not in self.faulty:
                    self.faulty.add(address)
                    self.workers.report(line)
                yield from self._retry(task, outcome.error, outcome.traceback)

    def _read_states(self) -> Iterator[Failed[Any]]:
        """Handle attempts that Dask itself has ended."""
        for key, sent in list(self.flight.items()):
            status = sent.future.status
            if status in ("cancelled", "lost"):
                raise SchedulerGoneError("tasks are lost")  # the scheduler came back without its tasks
            if status == "error":
                died, reason = _attempts_and_reason(sent.future.exception(timeout=ANSWER))
                task = self._taken(key)
                task.attempts += died - 1
                yield from self._retry(task, reason, "")
                self.workers.look(at_once=True)
            elif status == "finished" and sent.finished:  # its message comes before the state
                yield from self._retry(self._taken(key), "the worker sent no outcome", "")
            sent.finished = status == "finished"

    def _judge(self) -> Iterator[Failed[Any]]:
        """Give the units of overdue workers to others."""
        now, patience = self.patience.now, self.patience
        present = set(self.workers.look())
        astray = [key for key, sent in self.flight.items() if sent.allowed and sent.allowed.isdisjoint(present)]
        for key in astray:
            task = self._taken(key, cancel=True)
            task.strays += 1
            if task.strays <= ATTEMPTS:  # it may have waited there
                self._return([task])
            else:  # it may be what ends the workers
                yield from self._retry(task, "the workers that were given it have left the scheduler", "")
        for key, sent in list(self.flight.items()):
            if sent.overdue and now - sent.at > patience.last_limit():
                task = self._taken(key, cancel=True)
                yield from self._retry(task, f"a worker did not answer for {now - sent.at:.0f} s", "")
        limits = patience.limit(), patience.limit(starting=True)
        if all(sent.overdue or now - sent.at <= min(limits) for sent in self.flight.values()):
            return
        places = {key: address for address, keys in self.workers.processing().items() for key in keys}
        held: dict[str, list[str]] = {}
        for key, sent in self.flight.items():
            if key in places and not sent.overdue:
                held.setdefault(places[key], []).append(key)
        for address, keys in held.items():
            since = max(self.heard.get(address, 0.0), self.flight[keys[0]].at)
            if now - since > limits[address not in self.heard]:
                self._overdue(address, keys, now - since)

    def _overdue(self, address: str, held: list[str], silent: float) -> None:
        """Give the unit in progress in an overdue worker to another worker as well, and those that it has not begun to others."""
        self.workers.silent.add(address)
        first = self.flight[held[0]]  # workers do the oldest first
        first.overdue = True
        self.moved |= {key: self.flight[key].task for key in held[1:]}
        self._return([self._taken(key, cancel=True) for key in held[1:]])
        if first.task.attempts < ATTEMPTS:
            self.again.append(first.task)
            effect = f"its {len(held)} units are given to other workers" if len(held) > 1 else "its unit is given to another worker"
        else:
            effect = "its unit has no further attempts"
        self.workers.report(silence(f"worker {address}", silent, effect))

    def _taken(self, key: str, *, cancel: bool = False) -> _DaskTask:
        """Return the unit of an attempt that is no longer in progress."""
        sent = self.flight.pop(key)
        sent.task.keys.discard(key)
        if cancel:
            self.workers.cancel([sent.future])
        return sent.task

    def _drop(self, keys: list[str]) -> None:
        """Cancel attempts whose unit is finished."""
        for key in keys:
            self._taken(key, cancel=True)

    def _return(self, tasks: list[_DaskTask]) -> None:
        """Queue units whose attempt has not begun before all others."""
        for task in reversed(tasks):
            task.attempts -= 1
            if task not in self.again:
                self.again.appendleft(task)

    def _retry(self, task: _DaskTask, error: str, where: str) -> Iterator[Failed[Any]]:
        """Queue a unit once more, or yield it as failed if no worker is at it."""
        if task.attempts < ATTEMPTS:
            if task not in self.again:
                self.again.append(task)
        elif not task.keys and task not in self.again:
            task.ended = True
            yield Failed(task.unit, error, where, task.attempts)

    def _lost(self, error: SchedulerGoneError) -> None:
        """Wait for the scheduler and queue the units in flight again, without counting an attempt."""
        self.losses += 1
        if self.losses > ATTEMPTS:
            raise BackendError(
                f"the Dask scheduler was lost {self.losses} times with nothing done in between ({error}); finished units remain: "
                "find out why it ends, and continue with resume=True"
            ) from error
        self._return([self._taken(key) for key in list(self.flight)])
        self.workers.reconnect()


def _attempts_and_reason(error: BaseException) -> tuple[int, str]:
    """Return the number of attempts that an error of Dask itself counts for, and its text."""
    from distributed.scheduler import KilledWorker

    if isinstance(error, KilledWorker):
        died = error.allowed_failures + 1
        return died, f"{died} worker{'s' if died > 1 else ''} died at it, the last {error.last_worker.address}"
    if isinstance(error, ImportError):
        return 1, f"a worker cannot import the work: {one_line(error)}; install seaglint and its extras there as here"
    return 1, one_line(error)
