"""Functions that run in a Dask worker: the description of its machine, and the work on a job, one unit at a time.

A description has version and sources of the package and the processor type. A worker starts a job once and then does its units.
"""

from __future__ import annotations

import hashlib
import os
import pickle
import socket
import threading
import time
import traceback
import zlib
from collections.abc import Callable
from functools import cache
from typing import Any, Final, NamedTuple

from seaglint.base.errors import one_line
from seaglint.cluster.job import Done, Failed, Job, attempt, outgoing


class Machine(NamedTuple):
    """Machine of a process, with everything that its results depend on."""

    version: str  #: Version of seaglint.
    sources: str  #: Digest of the sources of all kernels.
    processor: str  #: Type of the processor, as stores record it: the last bits of results can differ between types.
    host: str
    process: int


@cache
def this_machine() -> Machine:
    """Return the description of this process."""
    from seaglint.base.kernel_cache import sources_digest
    from seaglint.base.machine import processor
    from seaglint.version import __version__

    return Machine(__version__, sources_digest(), processor(), socket.gethostname(), os.getpid())


#: Lock that lets the threads of one worker take turns: they share the threads of kernels and of linear algebra.
_one_at_a_time: Final = threading.Lock()

_started: dict[str, Callable[[Any], Any]] = {}  #: The latest job, by its digest.


class Started(NamedTuple):
    """Message of a worker that has started a job."""

    seconds: float  #: Time of the start [s].


class Unfit(NamedTuple):
    """Answer of a worker with another version or other sources of the package: it does no unit."""


def packed(job: Job[Any, Any, Any]) -> bytes:
    """Pack a job to be sent with each unit, because workers come and go, with the version that it needs."""
    needed = this_machine()
    return pickle.dumps((needed.version, needed.sources, zlib.compress(outgoing((job.start, job.settings)))))


def packed_unit(key: str, unit: Any) -> bytes:
    """Pack a unit with the key of its task."""
    return pickle.dumps((key, outgoing(unit)))


def describe() -> tuple[Any, ...] | None:
    """Return the worker's ``seaglint.cluster.remote.Machine`` as a tuple; None for a worker without the package."""
    # The module imports itself: a global of this function would need the package before its absence can be reported.
    try:
        from seaglint.cluster import remote
    except ImportError:
        return None
    return tuple(remote.this_machine())


describe.__module__ = "__main__"  # not importable: it is sent as a whole, also to workers without the package


def do(unit: bytes, content: bytes, topic: str) -> None:
    """Do a packed unit of a packed job; publish its outcome, or the exception with which the job's start failed.

    Errors of a unit are values: an error that Dask itself reports of a task means a lost worker or one without the package. The outcome is
    no result of the task, since a result is fetched from the worker, which may be frozen by then.
    """
    from seaglint.base.reports import leave_reports_to_parent
    from seaglint.base.threads import thread_limit

    leave_reports_to_parent()
    name, threads = _worker_and_threads()
    key, pickled = pickle.loads(unit)
    version, sources, job = pickle.loads(content)
    if (version, sources) != (this_machine().version, this_machine().sources):
        return publish(topic, key, pickle.dumps(Unfit()))
    with _one_at_a_time:
        # the start of a job may load or compile kernels: it has the same limit of threads as its units
        try:
            with thread_limit(threads):
                work = _work(job, topic, key)
        except Exception as error:
            error.add_note(f"raised in {name}:\n{traceback.format_exc()}")
            return publish(topic, key, _pickled(error, RuntimeError(one_line(error))))
        parsed = pickle.loads(pickled)
        with thread_limit(threads):
            outcome = attempt(work, parsed, name, 1)
    if isinstance(outcome, Done):
        return publish(topic, key, _pickled(outcome, Failed(parsed, "the record cannot be sent: it does not pickle", "", 1)))
    return publish(topic, key, pickle.dumps(outcome))


def publish(topic: str, key: str, message: bytes) -> None:
    """Send a pickled message of a task through the scheduler to the process that subscribed to the topic."""
    from distributed import get_worker

    worker = get_worker()
    worker.log_event(topic, (key, worker.address, message))


def _work(content: bytes, topic: str, unit_key: str) -> Callable[[Any], Any]:
    key = hashlib.blake2b(content, digest_size=16).hexdigest()
    if key not in _started:
        # one job at a time: an earlier one frees its tables
        _started.clear()
        began = time.perf_counter()
        start, settings = pickle.loads(zlib.decompress(content))
        _started[key] = start(settings)
        publish(topic, unit_key, pickle.dumps(Started(time.perf_counter() - began)))
    return _started[key]


def _worker_and_threads() -> tuple[str, int]:
    """Return the worker's name, and the number of threads that it may use."""
    import numba
    from distributed import get_worker

    worker = get_worker()
    return str(worker.address), max(min(worker.state.nthreads, int(vars(numba.config)["NUMBA_NUM_THREADS"])), 1)


def _pickled(value: Any, otherwise: Any) -> bytes:
    try:
        content = pickle.dumps(value)
        if isinstance(value, BaseException):
            pickle.loads(content)  # some errors pickle and cannot be read again
    except Exception:
        return pickle.dumps(otherwise)
    return content
