"""Workers of a Dask cluster, at the address of a scheduler or from a batch queue (SLURM, PBS and others) by the settings in a file.

Only units and small records are transferred.
"""

from __future__ import annotations

import logging
import pickle
import queue
import re
import shutil
import time
import tomllib
import uuid
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from seaglint.base.errors import BackendError, DataError, SeaglintError, one_line
from seaglint.base.free_form import TomlTables
from seaglint.base.optional import optional
from seaglint.cluster.job import ATTEMPTS, Done, Failed, Job, Record, Settings, Unit, outgoing
from seaglint.cluster.remote import Machine, describe, do, packed, this_machine

CONNECT: Final = 5.0  #: Time within which a scheduler must answer [s].

PATIENCE: Final = 60.0  #: Time without a scheduler or without workers after which a job is abandoned [s].

REFRESH: Final = 2.0  #: Time between two queries of the list of workers [s].

AHEAD: Final = 2  #: Units assigned to each worker in advance: one in progress, and the next.

BATCH: Final = 4  #: Divisor of the batch size: units are sent when a ``BATCH``-th of the workers need one.

TOGETHER: Final = 1e-4  #: Time for each worker in which records are gathered into one request [s]: a request costs as much as many records.

Report = Callable[[str], None]


@dataclass(eq=False)
class _DaskTask:
    unit: Any
    attempts: int = 0


class _SchedulerGoneError(Exception):
    """The connection to the scheduler is lost."""


class DaskWorkers:
    """Workers of a Dask scheduler; each process does one unit at a time, with as many threads of the kernels as Dask gives it threads.

    Parameters
    ----------
    connect : callable
        Function that returns a client; called again after a loss of the scheduler.
    report : callable
        Called with messages for the user, a line at a time.
    patience : float
        Longest time without the scheduler or without workers [s].
    """

    task = staticmethod(do)

    def __init__(self, connect: Callable[[], Any], report: Report = lambda line: None, patience: float = PATIENCE) -> None:
        self._connect, self._report, self.patience = connect, report, patience
        self._client = connect()
        self._known: dict[str, Machine] = {}
        self._present: tuple[str, ...] = ()
        self._looked = -REFRESH

    @property
    def count(self) -> int:
        """Return the number of worker processes."""
        with suppress(_SchedulerGoneError):  # the last known number; mapping raises the error
            self.look()
        return max(len(self._present), 1)

    @property
    def seen(self) -> bool:
        """Return True if a worker has ever been connected."""
        return bool(self._present)

    def wait_for_one(self) -> None:
        """Wait for the first worker.

        Raises
        ------
        BackendError
            No worker in time, or a worker that cannot be used.
        """
        until = time.monotonic() + self.patience
        while not self.look(at_once=True):
            if time.monotonic() > until:
                raise BackendError(f"no worker came within {self.patience:g} s; start some, or see whether the queue is full")
            time.sleep(0.2)

    def close(self) -> None:
        """Close the connection to the scheduler."""
        with suppress(Exception):  # a lost connection may be in any state
            self._client.close(timeout=2)

    @contextmanager
    def map(self, job: Job[Settings, Unit, Record], units: Iterable[Unit]) -> Iterator[Iterator[Done[Unit, Record] | Failed[Unit]]]:
        """Yield the outcomes of all units as they finish; see ``seaglint.cluster.job.Workers``.

        Leaving the context cancels units that have not begun. A unit in progress on another machine ends there, and its outcome is dropped.

        Raises
        ------
        BackendError
            The scheduler or all workers are lost for too long, or a worker cannot be used.
        Exception
            Error of the job's start on a worker.
        """
        mapping = _DaskMapping(self, packed(job), units)
        try:
            yield mapping.outcomes()
        finally:
            mapping.cancel()

    def look(self, *, at_once: bool = False) -> tuple[str, ...]:
        """Return the addresses of the workers; new ones are queried for their version and processor."""
        if at_once or time.monotonic() - self._looked >= REFRESH:
            try:
                self._present = tuple(self._client.nthreads())
                new = [address for address in self._present if address not in self._known]
                answers = self._client.run(describe, workers=new, on_error="return") if new else {}
            except Exception as error:
                raise _SchedulerGoneError(one_line(error)) from error
            machines = usable_workers(answers, this_machine())
            self._report_processors(machines)
            self._known |= machines
            self._looked = time.monotonic()
        return self._present

    def _report_processors(self, new: dict[str, Machine]) -> None:
        """Report once each processor type that differs from this machine's."""
        reported = {this_machine().processor} | {machine.processor for machine in self._known.values()}
        for processor in sorted({machine.processor for machine in new.values()} - reported):
            some = [address for address, machine in new.items() if machine.processor == processor]
            self._report(
                f"{len(some)} workers ({_some(some)}) have another processor type, {processor} and not {this_machine().processor}: "
                "the last bits of their frames can differ"
            )

    def reconnect(self) -> None:
        """Wait until the scheduler answers again.

        Raises
        ------
        BackendError
            It does not answer in time.
        """
        self.close()
        self._report(f"the Dask scheduler is lost; it may come back within {self.patience:g} s")
        until = time.monotonic() + self.patience
        while True:
            try:
                self._client = self._connect()
            except BackendError as error:
                if time.monotonic() > until:
                    raise BackendError(
                        f"the Dask scheduler was lost and did not come back within {self.patience:g} s; finished units remain: "
                        "start it again, and continue with resume=True"
                    ) from error
                time.sleep(0.5)
            else:
                # workers may be others now: all are queried again
                self._known.clear()
                self._looked = -REFRESH
                return

    def submit(self, units: list[bytes], content: bytes) -> list[Any]:
        """Return futures of ``seaglint.cluster.remote.do``, sent together: one by one they cost several times as much."""
        keys = [f"seaglint-{uuid.uuid4().hex}" for _ in units]
        try:
            return list(self._client.map(self.task, units, content=content, pure=False, retries=0, key=keys))
        except Exception as error:
            raise _SchedulerGoneError(one_line(error)) from error

    def gather(self, futures: list[Any]) -> list[bytes]:
        """Return the results of finished futures, in one request."""
        try:
            return list(self._client.gather(futures))
        except Exception as error:
            raise _SchedulerGoneError(one_line(error)) from error

    def cancel(self, futures: list[Any]) -> None:
        """Cancel futures that have not begun."""
        with suppress(Exception):  # the scheduler may be lost
            if futures and self._client.status == "running":
                self._client.cancel(futures, force=True)

    @property
    def connected(self) -> bool:
        """Return True while the scheduler is connected."""
        return bool(self._client.status == "running")


class _DaskMapping:
    """Progress of one job over the Dask workers."""

    def __init__(self, workers: DaskWorkers, content: bytes, units: Iterable[Any]) -> None:
        self.workers, self.content, self.source = workers, content, iter(units)
        self.again: deque[_DaskTask] = deque()
        self.flight: dict[str, tuple[Any, _DaskTask]] = {}
        """Futures and their units, by the futures' keys."""
        self.ended: queue.SimpleQueue[Any] = queue.SimpleQueue()
        self.losses = 0
        """Number of consecutive losses of the scheduler with nothing done in between."""

    def outcomes(self) -> Iterator[Done[Any, Any] | Failed[Any]]:
        """Yield the outcomes of the units."""
        last_seen = time.monotonic()
        while True:
            try:
                if not self._fill():
                    return
                ended = self._wait()
                if self.workers.look():
                    last_seen = time.monotonic()
                elif time.monotonic() - last_seen > self.workers.patience:
                    raise BackendError(
                        f"no worker was left for {self.workers.patience:g} s; finished units remain: start some, "
                        "and continue with resume=True"
                    )
                for outcome in self._read(ended):
                    self.losses = 0
                    yield outcome
            except _SchedulerGoneError as error:
                self._lost(error)
                last_seen = time.monotonic()

    def cancel(self) -> None:
        """Cancel all unfinished units."""
        futures, self.flight = [future for future, _ in self.flight.values()], {}
        self.workers.cancel(futures)

    def _fill(self) -> bool:
        """Submit units until enough are on their way; return False when nothing is left."""
        tasks: list[_DaskTask] = []
        count = self.workers.count
        room = AHEAD * count - len(self.flight)
        if room < count // BATCH:  # a call costs more than its units, and workers still have a unit in advance
            return True
        for _ in range(room):
            task = self.again.popleft() if self.again else next((_DaskTask(unit) for unit in self.source), None)
            if task is None:
                break
            tasks.append(task)
        try:
            futures = self.workers.submit([outgoing(task.unit) for task in tasks], self.content) if tasks else []
        except _SchedulerGoneError:
            self.again.extendleft(reversed(tasks))
            raise
        for future, task in zip(futures, tasks, strict=True):
            self.flight[future.key] = (future, task)
            future.add_done_callback(self.ended.put)
        return bool(self.flight)

    def _wait(self) -> list[Any]:
        """Return the futures that ended; none after a time-out."""
        ended = []
        with suppress(queue.Empty):
            ended.append(self.ended.get(timeout=0.5))
            # a short wait gathers the records of many workers in one request
            time.sleep(min(TOGETHER * self.workers.count, 0.05))
            while True:
                ended.append(self.ended.get_nowait())
        if not self.workers.connected:
            raise _SchedulerGoneError("the connection is closed")
        return [future for future in ended if future.key in self.flight]

    def _read(self, ended: list[Any]) -> Iterator[Done[Any, Any] | Failed[Any]]:
        """Yield the outcomes of futures that ended; units to be tried again are queued."""
        # the scheduler came back without its tasks
        if any(future.status in ("cancelled", "lost") for future in ended):
            raise _SchedulerGoneError("tasks are lost")
        whole = [future for future in ended if future.status == "finished"]
        for future, content in zip(whole, self.workers.gather(whole) if whole else [], strict=True):
            _, task = self.flight.pop(future.key)
            outcome = pickle.loads(content)
            # an error of the job's start may be a fault of one worker, and is tried again, unless the user must correct it
            if isinstance(outcome, Exception):
                if isinstance(outcome, SeaglintError) or task.attempts + 1 >= ATTEMPTS:
                    raise outcome
                list(self._retry(task, 1, "", ""))
            elif isinstance(outcome, Done):
                yield Done(task.unit, outcome.record, outcome.seconds, outcome.worker)
            else:
                yield from self._retry(task, 1, outcome.error, outcome.traceback)
        for future in ended:
            if future.status == "error":
                _, task = self.flight.pop(future.key)
                yield from self._retry(task, *_attempts_and_reason(future.exception()), "")

    def _retry(self, task: _DaskTask, attempts: int, error: str, where: str) -> Iterator[Failed[Any]]:
        """Queue a unit once more, or yield it as failed."""
        task.attempts += attempts
        if task.attempts >= ATTEMPTS:
            yield Failed(task.unit, error, where, task.attempts)
        else:
            self.again.append(task)

    def _lost(self, error: _SchedulerGoneError) -> None:
        """Wait for the scheduler and queue the units in flight again, without counting an attempt."""
        self.losses += 1
        if self.losses > ATTEMPTS:
            raise BackendError(
                f"the Dask scheduler was lost {self.losses} times with nothing done in between ({error}); finished units remain: "
                "find out why it ends, and continue with resume=True"
            ) from error
        self.again.extend(task for _, task in self.flight.values())
        self.flight = {}
        self.workers.reconnect()


def _attempts_and_reason(error: BaseException) -> tuple[int, str]:
    """Return the number of attempts that an error of Dask itself counts for, and its text.

    Raises
    ------
    BackendError
        The worker lacks the package.
    """
    from distributed.scheduler import KilledWorker

    if isinstance(error, KilledWorker):
        died = error.allowed_failures + 1
        return died, f"{died} worker{'s' if died > 1 else ''} died at it, the last {error.last_worker.address}"
    if isinstance(error, ImportError):
        raise BackendError(f"a worker cannot import the work: {one_line(error)}; install seaglint and its extras there as here") from error
    return 1, one_line(error)


def usable_workers(answers: dict[str, Any], mine: Machine) -> dict[str, Machine]:
    """Return the usable workers by their descriptions; workers that answered with an error are queried again later.

    Raises
    ------
    BackendError
        Workers without the package, or with another version of it.
    """
    good = {address: Machine(*details) for address, details in answers.items() if isinstance(details, tuple)}
    without = [address for address, details in answers.items() if details is None]
    if without:
        raise BackendError(
            f"{len(without)} workers have no seaglint, or one that knows no such work: {_some(without)}; install {mine.version} there"
        )
    others = {address: m for address, m in good.items() if m.version != mine.version}
    if others:
        versions = ", ".join(sorted({m.version for m in others.values()}))
        raise BackendError(
            f"{len(others)} workers have seaglint {versions} and not {mine.version}: {_some(list(others))}; install {mine.version} there"
        )
    changed = [address for address, m in good.items() if m.sources != mine.sources]
    if changed:
        raise BackendError(
            f"{len(changed)} workers have other sources of seaglint {mine.version}: {_some(changed)}; install the same ones there, "
            "and start the workers again"
        )
    return good


def _some(addresses: list[str]) -> str:
    """Return a few of many addresses as text."""
    return ", ".join(sorted(addresses)[:3]) + (f" and {len(addresses) - 3} more" if len(addresses) > 3 else "")


@contextmanager
def quiet() -> Iterator[None]:
    """Keep the logs of Dask from the terminal; its errors are raised as errors of seaglint."""
    names = [name for name in logging.root.manager.loggerDict if name.split(".")[0] in ("distributed", "tornado", "dask_jobqueue")]
    before = {name: logging.getLogger(name).level for name in {"distributed", "tornado", "dask_jobqueue", *names}}
    for name in before:
        logging.getLogger(name).setLevel(logging.CRITICAL + 1)
    try:
        yield
    finally:
        for name, level in before.items():
            logging.getLogger(name).setLevel(level)


def client_of(address: Any, shown: str) -> Any:
    """Connect a client to a scheduler.

    Raises
    ------
    BackendError
        Dask is not installed, or no scheduler answers.
    """
    import distributed

    client: Any = distributed.Client  # without types of its own
    try:
        return client(address, timeout=CONNECT, set_as_default=False, name="seaglint")
    except (OSError, TimeoutError, ValueError) as error:
        raise BackendError(
            f"{shown}: no Dask scheduler answers within {CONNECT:g} s; start one with 'dask scheduler', or see address and firewall"
        ) from error


def require_dask() -> None:
    """Check that Dask is installed.

    Raises
    ------
    BackendError
        Dask is not installed.
    """
    optional("distributed", "a Dask scheduler", "or choose workers=N, which needs no package")


@contextmanager
def connected(address: str, report: Report = lambda line: None, *, patience: float = PATIENCE) -> Iterator[DaskWorkers]:
    """Provide the workers of the scheduler at an address.

    Raises
    ------
    DataError
        A text that is no address.
    BackendError
        No scheduler, no worker, or a worker of another version.
    """
    require_dask()
    if not re.fullmatch(r"((tcp|tls|ws|wss|inproc)://)?[^/\s]+:\d+|inproc://\S+", address):
        raise DataError(f"address = {address!r} is no address of a Dask scheduler; give one such as tcp://host:8786")
    with quiet():
        workers = DaskWorkers(lambda: client_of(address, f"Dask scheduler {address}"), report, patience)
        try:
            workers.wait_for_one()
            yield workers
        except _SchedulerGoneError as error:
            raise BackendError(f"Dask scheduler {address}: it does not answer ({error}); see its log") from error
        finally:
            workers.close()


#: Classes of dask-jobqueue by the key ``kind`` of a queue.
KINDS: Final = {
    "slurm": "SLURMCluster",
    "pbs": "PBSCluster",
    "sge": "SGECluster",
    "lsf": "LSFCluster",
    "oar": "OARCluster",
    "moab": "MoabCluster",
    "htcondor": "HTCondorCluster",
}

TIMEOUT: Final = 600.0  #: Default time within which the queue must start the first worker [s].


def read_settings(path: Path) -> tuple[str, int, float, TomlTables]:
    """Read kind of queue, number of jobs, time-out [s], and the settings passed to dask-jobqueue.

    Raises
    ------
    DataError
        An unreadable file, or a wrong value.
    """
    try:
        table = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise DataError(f"{path}: cannot be read: {error.strerror}; give the file with the queue's settings") from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise DataError(f"{path}: is no TOML file: {error}") from None
    kind, jobs, timeout = table.pop("kind", "slurm"), table.pop("jobs", 1), table.pop("timeout_s", TIMEOUT)
    if kind not in KINDS:
        raise DataError(f"{path}: kind = {kind!r}; allowed are {', '.join(KINDS)}")
    if isinstance(jobs, bool) or not isinstance(jobs, int) or jobs < 1:
        raise DataError(f"{path}: jobs = {jobs!r}; give the number of batch jobs to request, 1 or more")
    if isinstance(timeout, bool) or not isinstance(timeout, int | float) or timeout <= 0:
        raise DataError(f"{path}: timeout_s = {timeout!r}; give the seconds to wait for the first worker")
    return kind, jobs, float(timeout), table


@contextmanager
def queued(path: Path, report: Report = lambda line: None) -> Iterator[DaskWorkers]:
    """Provide workers of the batch queue that a file describes; their jobs end with the context.

    Raises
    ------
    DataError
        Settings that the queue's class refuses.
    BackendError
        No queue on this machine, or it gives no worker in time.
    """
    require_dask()
    kind, jobs, timeout, options = read_settings(path)
    made = getattr(optional("dask_jobqueue", "a batch queue"), KINDS[kind])
    command = str(made.job_cls.submit_command).split()[0]
    if shutil.which(command) is None:
        raise BackendError(f"{path}: {command} is not on this machine; run this where jobs are submitted, or change kind = {kind!r}")
    with quiet():
        try:
            # the dashboard of Dask at a free port, as another run may have the usual one
            cluster = made(**{"scheduler_options": {"dashboard_address": ":0"}, **options})
        except (TypeError, ValueError, RuntimeError, OSError) as error:
            raise DataError(f"{path}: {made.__name__} refuses these settings: {one_line(error)}") from error
        try:
            cluster.scale(jobs=jobs)
            workers = DaskWorkers(lambda: client_of(cluster, str(path)), report, timeout)
            try:
                _first(workers, path, jobs, timeout)
                yield workers
            finally:
                workers.close()
        finally:
            cluster.close(timeout=10)


def _first(workers: DaskWorkers, path: Path, jobs: int, timeout: float) -> None:
    try:
        workers.wait_for_one()
    except BackendError as error:
        if workers.seen:
            raise
        raise BackendError(
            f"{path}: the queue started none of {jobs} jobs within {timeout:g} s; it may be full: try again later, "
            "raise timeout_s, or request less"
        ) from error
