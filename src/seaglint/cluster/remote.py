"""Functions that a Dask worker runs: it starts a job once, and then its units, one at a time."""

from __future__ import annotations

import hashlib
import pickle
import threading
import traceback
import zlib
from collections.abc import Callable
from typing import Any, Final

from seaglint.base.errors import one_line
from seaglint.cluster.job import Done, Failed, Job, attempt, outgoing

#: Lock that lets the threads of one worker take turns: they share the threads of kernels and of linear algebra.
_one_at_a_time: Final = threading.Lock()

_started: dict[str, Callable[[Any], Any]] = {}  #: The latest job, by its digest.


def packed(job: Job[Any, Any, Any]) -> bytes:
    """Pack a job to be sent with each unit, because workers come and go."""
    return zlib.compress(outgoing((job.start, job.settings)))


def describe() -> tuple[Any, ...] | None:
    """Return the worker's :class:`seaglint.cluster.machine.Machine`; None where it lacks the package."""
    try:
        from seaglint.cluster.machine import this_machine
    except ImportError:
        return None
    return tuple(this_machine())


describe.__module__ = "__main__"  # of no module that can be imported: it travels as a whole, to workers without the package too


def do(unit: bytes, content: bytes) -> bytes:
    """Do a pickled unit of a packed job; return a pickled outcome, or the exception with which the job's start failed.

    Errors of a unit are values: what Dask itself reports of a task is a lost worker or one without the package.
    """
    from seaglint.base.reports import leave_reports_to_parent
    from seaglint.base.threads import thread_limit

    leave_reports_to_parent()
    name, threads = _here()
    with _one_at_a_time:
        try:
            with thread_limit(threads):
                work = _work(content)
        except Exception as error:
            error.add_note(f"raised in {name}:\n{traceback.format_exc()}")
            return _pickled(error, RuntimeError(one_line(error)))
        parsed = pickle.loads(unit)
        with thread_limit(threads):
            outcome = attempt(work, parsed, name, 1)
    if isinstance(outcome, Done):
        return _pickled(outcome, Failed(parsed, "the record cannot be sent: it does not pickle", "", 1))
    return pickle.dumps(outcome)


def _work(content: bytes) -> Callable[[Any], Any]:
    key = hashlib.blake2b(content, digest_size=16).hexdigest()
    if key not in _started:
        _started.clear()
        start, settings = pickle.loads(zlib.decompress(content))
        _started[key] = start(settings)
    return _started[key]


def _here() -> tuple[str, int]:
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
