"""What a job is, what comes back of it, and what all kinds of workers offer."""

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

ATTEMPTS: Final = 3
"""How often a unit is tried before it counts as failed."""


@dataclass(frozen=True)
class Job(Generic[Settings, Unit, Record]):
    """Work of many units that each worker prepares for once.

    Attributes
    ----------
    start : callable
        ``start(settings)`` prepares and returns a function of a unit. A function of a module, so that workers find it by its name.
    settings : object
        Small values that pickle: text, numbers, paths, scenarios. No arrays. Relative paths count from the working directory of who asks.
    """

    start: Callable[[Settings], Callable[[Unit], Record]]
    settings: Settings


@dataclass(frozen=True)
class Done(Generic[Unit, Record]):
    """A unit that is done."""

    unit: Unit
    record: Record
    """What the unit's function returned."""
    seconds: float
    """Time of the unit in its worker [s]."""
    worker: str
    """Which worker did it."""


@dataclass(frozen=True)
class Failed(Generic[Unit]):
    """A unit that was tried :data:`ATTEMPTS` times, on other workers where there are some, and failed."""

    unit: Unit
    error: str
    """The last error, one line."""
    traceback: str
    """Where it was raised; empty where the worker vanished."""
    attempts: int
    """How often it was tried."""


class Workers(Protocol):
    """Somebody who does units of a job."""

    @property
    def count(self) -> int:
        """How many units are worked on at the same time."""
        ...

    def map(
        self, job: Job[Settings, Unit, Record], units: Iterable[Unit]
    ) -> AbstractContextManager[Iterator[Done[Unit, Record] | Failed[Unit]]]:
        """Outcomes of all units as they finish, in any order; leaving the context cancels what is not done."""
        ...


class _Outgoing(pickle.Pickler):
    """Pickles with whole paths: who reads it may have another working directory."""

    def reducer_override(self, value: Any) -> Any:
        """How a path is read back; other values are as ever."""
        if isinstance(value, Path):
            return type(value), (os.path.abspath(value),)
        return NotImplemented


def outgoing(value: Any) -> bytes:
    """A value as it is sent to workers.

    >>> pickle.loads(outgoing({"file": Path("waves.nc")}))["file"].is_absolute()
    True
    """
    content = io.BytesIO()
    _Outgoing(content).dump(value)
    return content.getvalue()


def attempt(work: Callable[[Unit], Record], unit: Unit, worker: str, attempts: int) -> Done[Unit, Record] | Failed[Unit]:
    """Do a unit once; errors become values, requests to stop go through."""
    began = time.perf_counter()
    try:
        record = work(unit)
    except Exception as error:
        return Failed(unit, one_line(error), traceback.format_exc(), attempts)
    return Done(unit, record, time.perf_counter() - began, worker)


def record_of(outcome: Done[Unit, Record] | Failed[Unit]) -> Record:
    """The record of a unit, where a result needs all of them.

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
