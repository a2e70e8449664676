"""Workers of a Dask cluster, at the address of a scheduler or from a batch queue (SLURM, PBS and others) by the settings in a file.

Only units and small records are transferred. Records are published through the scheduler, since a record that is fetched from its worker
would be lost with a worker that freezes in between. Every request has a time limit.
"""

from __future__ import annotations

import asyncio
import concurrent.futures
import logging
import queue
import re
import shutil
import threading
import time
import tomllib
import uuid
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, Final

from seaglint.base.errors import BackendError, DataError, one_line
from seaglint.base.free_form import TomlTables
from seaglint.base.optional import optional
from seaglint.base.reports import REPORTS
from seaglint.cluster.dask_progress import ANSWER, REFRESH, DaskMapping, SchedulerGoneError
from seaglint.cluster.job import Done, Failed, Job, Record, Settings, Unit
from seaglint.cluster.overdue import Limits
from seaglint.cluster.remote import Machine, describe, do, packed, packed_unit, this_machine

CONNECT: Final = 5.0  #: Time within which a scheduler must answer [s].

PATIENCE: Final = 60.0  #: Time without a scheduler or without workers after which a job is abandoned [s].

DESCRIPTION: Final = 10.0  #: Time within which a worker must describe itself [s].

Report = Callable[[str], None]


class DaskWorkers:
    """Workers of a Dask scheduler; each process does one unit at a time, with as many threads of the kernels as Dask gives it threads.

    Parameters
    ----------
    connect : callable
        Function that returns a client; called again after a loss of the scheduler.
    report : callable
        Called with messages for the user, a line at a time; by default the log of seaglint.
    patience : float
        Longest time without the scheduler or without workers [s].
    limits : Limits
        Times after which a worker without an answer is overdue.
    """

    task = staticmethod(do)

    def __init__(
        self,
        connect: Callable[[], Any],
        report: Report = REPORTS.warning,
        patience: float = PATIENCE,
        limits: Limits = Limits(),  # noqa: B008 - it is frozen
    ) -> None:
        self._connect, self.report, self.patience, self.limits = connect, report, patience, limits
        self.inbox: queue.SimpleQueue[Any] = queue.SimpleQueue()
        """Messages of the workers: time, and key of the task, address of the worker, content."""
        self.silent: set[str] = set()
        """Addresses of overdue workers."""
        self._topic = f"seaglint-{uuid.uuid4().hex}"
        self._known: dict[str, Machine] = {}
        self._refused: dict[str, str] = {}
        """Reasons by the addresses of workers that cannot be used."""
        self._described: dict[str, concurrent.futures.Future[dict[str, Any]]] = {}
        """Requests for descriptions that are not answered yet."""
        self._pauses: dict[str, tuple[float, float]] = {}
        """Pauses after requests without an answer, by address: end and length [s]."""
        self._unreported: list[str] = []
        self._present: tuple[str, ...] = ()
        self._looked = -REFRESH
        self._mapping = False
        self._open()

    def _open(self) -> None:
        self._client = self._connect()
        self._client.subscribe_topic(self._topic, self.inbox.put)

    @property
    def count(self) -> int:
        """Return the number of worker processes that can be used and are not overdue."""
        with suppress(SchedulerGoneError):  # the last known number; mapping raises the error
            self.look()
        return max(len(self._usable()), 1)

    @property
    def seen(self) -> bool:
        """Return True if a worker has ever been connected."""
        return bool(self._present)

    def wait_for_one(self) -> None:
        """Wait for the first worker that can be used, and a limited time for the others that are connected.

        Raises
        ------
        BackendError
            No worker in time, or none that can be used.
        """
        began = time.monotonic()
        while not self.look(at_once=True) or (self._described and time.monotonic() - began < DESCRIPTION):
            if self._refused and not self._described and len(self._refused) == len(self._present):
                raise BackendError("; ".join(dict.fromkeys(self._refused.values())))
            if time.monotonic() - began > self.patience:
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
            The scheduler or all workers are lost for too long.
        Exception
            Error of the job's start on a worker.
        """
        if self._mapping:
            raise RuntimeError("these workers are at another job; leave its context first")
        self._mapping = True
        for address in self.silent:  # one that describes itself again is used again
            self._known.pop(address, None)
        self.silent.clear()
        mapping = DaskMapping(self, packed(job), units)
        try:
            yield mapping.outcomes()
        finally:
            mapping.cancel()
            self._mapping = False

    def look(self, *, at_once: bool = False) -> tuple[str, ...]:
        """Return the addresses of the workers that can be used; new ones are queried for their version and processor."""
        if at_once or time.monotonic() - self._looked >= REFRESH:
            self._present = tuple(self._ask(self._client.nthreads))
            now = self._looked = time.monotonic()
            if self._mapping and (gone := sorted(self._known.keys() - set(self._present))):
                which = f"worker {gone[0]} has" if len(gone) == 1 else f"{len(gone)} workers ({_some(gone)}) have"
                self.report(f"{which} left the Dask scheduler; units in progress there are given to other workers")
            for states in (self._known, self._refused, self._pauses):
                for address in states.keys() - set(self._present):  # another worker may have its address later
                    del states[address]
            for address in set(self._present) - self._known.keys() - self._refused.keys() - self._described.keys():
                if now < self._pauses.get(address, (0.0, 0.0))[0]:
                    continue
                request = self._client.run(describe, workers=[address], on_error="return", asynchronous=True, callback_timeout=DESCRIPTION)
                self._described[address] = asyncio.run_coroutine_threadsafe(request, self._client.loop.asyncio_loop)
        if any(request.done() for request in self._described.values()):
            self._read_descriptions()
        return tuple(address for address in self._present if address in self._known)

    def _read_descriptions(self) -> None:
        """Sort the workers that have described themselves; report those that are left out while others can be used."""
        answers: dict[str, Any] = {}
        for address, request in list(self._described.items()):
            if request.done():
                del self._described[address]
                if request.exception() is None:
                    answers |= request.result()
                else:  # a request to a frozen worker remains in the scheduler: the next one is later
                    pause = 2 * self._pauses.get(address, (0.0, 0.5 * DESCRIPTION))[1]
                    self._pauses[address] = (time.monotonic() + pause, pause)
        usable, refused = sorted_out(answers, this_machine())
        self._report_processors(usable)
        self._known |= usable
        self._refused |= refused
        self._unreported += dict.fromkeys(refused.values())
        if self._known:
            for line in self._unreported:
                self.report(f"{line}; until then the other workers do the work")
            self._unreported.clear()

    def _report_processors(self, new: dict[str, Machine]) -> None:
        """Report once each processor type that differs from this machine's."""
        reported = {this_machine().processor} | {machine.processor for machine in self._known.values()}
        for processor in sorted({machine.processor for machine in new.values()} - reported):
            some = [address for address, machine in new.items() if machine.processor == processor]
            self.report(
                f"{len(some)} workers ({_some(some)}) have another processor type, {processor} and not {this_machine().processor}: "
                "the last bits of their frames can differ"
            )

    def _usable(self) -> frozenset[str]:
        """Return the addresses of the workers that units can be given to."""
        return frozenset(address for address in self._present if address in self._known and address not in self.silent)

    def reconnect(self) -> None:
        """Wait until the scheduler answers again.

        Raises
        ------
        BackendError
            It does not answer in time.
        """
        self.close()
        self.report(f"the Dask scheduler is lost; it may come back within {self.patience:g} s")
        until = time.monotonic() + self.patience
        while True:
            try:
                self._open()
            except BackendError as error:
                if time.monotonic() > until:
                    raise BackendError(
                        f"the Dask scheduler was lost and did not come back within {self.patience:g} s; finished units remain: "
                        "start it again, and continue with resume=True"
                    ) from error
                time.sleep(0.5)
            else:
                # workers may be others now: all are queried again
                for states in (self._known, self._refused, self._described, self._pauses):
                    states.clear()
                self.silent.clear()
                self._looked = -REFRESH
                return

    def submit(self, units: list[Any], content: bytes, avoided: frozenset[str] = frozenset()) -> tuple[list[Any], frozenset[str]]:
        """Return futures of ``seaglint.cluster.remote.do`` and the workers that may do them (empty for all).

        Units are sent together: one by one they cost several times as much. No unit is given to an overdue worker or to one that cannot be
        used; a scheduler would take them for idle. Workers to be ``avoided`` are used only if there are no others.
        """
        usable = self._usable()
        usable = usable - avoided or usable
        allowed = frozenset[str]() if len(usable) == len(self._present) else usable
        keys = [f"seaglint-{uuid.uuid4().hex}" for _ in units]
        packs = [packed_unit(key, unit) for key, unit in zip(keys, units, strict=True)]
        options = {"content": content, "topic": self._topic, "pure": False, "retries": 0, "key": keys, "workers": sorted(allowed) or None}
        try:
            return list(self._client.map(self.task, packs, **options)), allowed
        except Exception as error:
            raise SchedulerGoneError(one_line(error)) from error

    def processing(self) -> dict[str, list[str]]:
        """Return the keys of the tasks that the scheduler has given to each worker."""
        found: dict[str, list[str]] = self._ask(self._client.sync, self._client.scheduler.processing, workers=None)
        return found

    def _ask(self, call: Callable[..., Any], *arguments: Any, **options: Any) -> Any:
        """Return the scheduler's answer to a request."""
        try:
            return call(*arguments, callback_timeout=min(ANSWER, self.patience), **options)
        except Exception as error:
            raise SchedulerGoneError(one_line(error)) from error

    def cancel(self, futures: list[Any]) -> None:
        """Cancel futures that have not begun."""
        with suppress(Exception):  # the scheduler may be lost
            if futures and self._client.status == "running":
                self._client.cancel(futures, force=True)

    @property
    def connected(self) -> bool:
        """Return True while the scheduler is connected."""
        return bool(self._client.status == "running")

    @property
    def idle(self) -> bool:
        """Return True if a unit can be given to a worker."""
        return bool(self._usable())


def sorted_out(answers: dict[str, Any], mine: Machine) -> tuple[dict[str, Machine], dict[str, str]]:
    """Return the usable workers by their descriptions, and the reasons why others are not usable; errors are neither."""
    usable: dict[str, Machine] = {}
    groups: dict[str, list[str]] = {}
    for address, answer in answers.items():
        if isinstance(answer, BaseException):  # it is queried again later
            continue
        machine = None if answer is None else Machine(*answer)
        if machine is None:
            fault = "have no seaglint, or one that knows no such work: {}; install " + f"{mine.version} there"
        elif machine.version != mine.version:
            fault = f"have seaglint {machine.version} and not {mine.version}: {{}}; install {mine.version} there"
        elif machine.sources != mine.sources:
            fault = f"have other sources of seaglint {mine.version}: {{}}; install the same ones there, and start the workers again"
        else:
            usable[address] = machine
            continue
        groups.setdefault(fault, []).append(address)
    return usable, {address: f"{len(some)} workers {fault.format(_some(some))}" for fault, some in groups.items() for address in some}


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

    made: concurrent.futures.Future[Any] = concurrent.futures.Future()

    def make() -> None:
        try:
            # without types of its own
            client: Any = distributed.Client(address, timeout=CONNECT, set_as_default=False, name="seaglint")  # type: ignore[no-untyped-call]
        except BaseException as error:
            if made.set_running_or_notify_cancel():
                made.set_exception(error)
            return
        if not made.set_running_or_notify_cancel():  # it comes too late
            with suppress(Exception):
                client.close(timeout=2)
            return
        made.set_result(client)

    # The client's own limit does not cover a scheduler that is stopped: it accepts connections and answers nothing.
    threading.Thread(target=make, daemon=True).start()
    try:
        return made.result(2 * CONNECT)
    except (OSError, TimeoutError, concurrent.futures.TimeoutError, ValueError) as error:
        made.cancel()
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
def connected(
    address: str,
    report: Report = REPORTS.warning,
    *,
    patience: float = PATIENCE,
    limits: Limits = Limits(),  # noqa: B008 - it is frozen
) -> Iterator[DaskWorkers]:
    """Provide the workers of the scheduler at an address.

    Raises
    ------
    DataError
        A text that is no address.
    BackendError
        No scheduler, no worker, or none of this version.
    """
    require_dask()
    if not re.fullmatch(r"((tcp|tls|ws|wss|inproc)://)?[^/\s]+:\d+|inproc://\S+", address):
        raise DataError(f"address = {address!r} is no address of a Dask scheduler; give one such as tcp://host:8786")
    with quiet():
        workers = DaskWorkers(lambda: client_of(address, f"Dask scheduler {address}"), report, patience, limits)
        try:
            workers.wait_for_one()
            yield workers
        except SchedulerGoneError as error:
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
def queued(path: Path, report: Report = REPORTS.warning) -> Iterator[DaskWorkers]:
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
            with suppress(TimeoutError):  # jobs that the queue does not end: their scheduler is gone, and they end by themselves
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
