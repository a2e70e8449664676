"""Jobs, their outcomes, and the interface of all kinds of workers."""

from __future__ import annotations

import io
import os
import pickle
import time
import traceback
from collections.abc import Callable, Iterable, Iterator
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, Generic, Protocol, TypeVar

from seaglint.base.errors import BackendError, one_line

Settings = TypeVar("Settings")
Unit = TypeVar("Unit")
Record = TypeVar("Record")

ATTEMPTS: Final = 3  #: Number of attempts of a unit before it counts as failed.


@dataclass(frozen=True)
class Job(Generic[Settings, Unit, Record]):
    """Work of many units with one preparation in each worker."""

    #: ``start(settings)`` prepares and returns a function of a unit. It is a function of a module, so that workers can import it by name.
    start: Callable[[Settings], Callable[[Unit], Record]]
    #: Small values that pickle: text, numbers, paths, scenarios, no arrays. Relative paths count from the caller's working directory.
    settings: Settings


@dataclass(frozen=True)
class Done(Generic[Unit, Record]):
    """Outcome of a unit that is done."""

    unit: Unit
    record: Record  #: Return value of the unit's function.
    seconds: float  #: Time of the unit in its worker [s].
    worker: str  #: Name of the worker.


@dataclass(frozen=True)
class Failed(Generic[Unit]):
    """Outcome of a unit that failed ``ATTEMPTS`` times, on different workers if possible."""

    unit: Unit
    error: str  #: Last error, one line.
    traceback: str  #: Traceback of the last error; empty if the worker was lost.
    attempts: int  #: Number of attempts.


class Workers(Protocol):
    """Interface of workers that do the units of a job."""

    @property
    def count(self) -> int:
        """Return the number of units that are worked on at the same time."""
        ...

    def map(
        self, job: Job[Settings, Unit, Record], units: Iterable[Unit]
    ) -> AbstractContextManager[Iterator[Done[Unit, Record] | Failed[Unit]]]:
        """Yield the outcomes of all units as they finish, in any order; leaving the context cancels unfinished units."""
        ...


class _Outgoing(pickle.Pickler):
    """Pickler that makes paths absolute, since the reader may have another working directory."""

    def reducer_override(self, value: Any) -> Any:
        """Return constructor and argument of a path; other values are pickled as usual."""
        if isinstance(value, Path):
            return type(value), (os.path.abspath(value),)
        return NotImplemented


def outgoing(value: Any) -> bytes:
    """Pickle a value for workers.

    >>> pickle.loads(outgoing({"file": Path("waves.nc")}))["file"].is_absolute()
    True
    """
    content = io.BytesIO()
    _Outgoing(content).dump(value)
    return content.getvalue()


def attempt(work: Callable[[Unit], Record], unit: Unit, worker: str, attempts: int) -> Done[Unit, Record] | Failed[Unit]:
    """Do a unit once; errors become a ``Failed``, requests to stop are raised."""
    began = time.perf_counter()
    try:
        record = work(unit)
    except Exception as error:
        return Failed(unit, one_line(error), traceback.format_exc(), attempts)
    return Done(unit, record, time.perf_counter() - began, worker)


def record_of(outcome: Done[Unit, Record] | Failed[Unit]) -> Record:
    """Return the record of a unit; raise the error of a failed one.

    Raises
    ------
    BackendError
        The unit failed; the traceback is a note of the error.
    """
    if isinstance(outcome, Done):
        return outcome.record
    error = BackendError(f"{outcome.error}; a unit of the work ({outcome.unit}) was tried {outcome.attempts} times on the workers")
    error.add_note(outcome.traceback)
    raise error
