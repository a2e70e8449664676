"""Computation of a store's missing frames, in this process or by workers that receive units."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager, suppress
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from traceback import format_exception
from typing import TYPE_CHECKING, Any

from seaglint.base.conventions import Progress
from seaglint.base.errors import DataError, SeaglintError, StorageError, one_line
from seaglint.base.machine import processor
from seaglint.store.layout import Layout
from seaglint.store.location import Local, Place, place_of
from seaglint.store.outputs import is_full, stop_on_signal, storage_errors
from seaglint.store.shards import Frame, FramesRaisedError, Shards, UnitFailure, UnitRecord, listed, make_unit
from seaglint.store.staging import best_attempt, take_unit
from seaglint.store.writers import Claim
from seaglint.version import __version__

if TYPE_CHECKING:
    from seaglint.store.staged_store import UnitStore

log = logging.getLogger(__name__)


class Interrupted(SeaglintError):  # noqa: N818 (an answer to a request, not a mistake)
    """Error of work that was stopped on request between two frames; finished frames stay and can be resumed."""

    exit_code = 130


@dataclass(frozen=True)
class UnitTask:
    """Description of a store for another process that writes units into it."""

    output: str  #: Name of the store.
    folder: str  #: Claimed folder; empty where there are no locks.
    token: str  #: Token of the claim.
    version: str = __version__  #: Version of the calling program.

    @classmethod
    def of(cls, place: Place, claim: Any) -> UnitTask:
        """Return the task for a claimed place."""
        return cls(place.name, "" if claim.folder is None else str(Path(claim.folder).absolute()), claim.token)


#: Callback that has units made elsewhere, by ``unit_maker``.
#:
#: It yields outcomes as they finish; leaving the context cancels the rest.
Spread = Callable[[UnitTask, Sequence[int]], AbstractContextManager[Iterator[UnitRecord | UnitFailure]]]


def unit_maker(task: UnitTask, layout: Layout, frame: Frame) -> Callable[[int], UnitRecord]:
    """Return a function that makes one unit after the other for a store that another process has claimed.

    The units remain in the stage of that process, which moves them into the store; object stores, which have no stages, are written.

    Raises
    ------
    DataError
        That process runs another version of the program; frames would not be the same.
    """
    from seaglint.store.staged_store import UnitStore  # imported here, as it loads Zarr

    require_version(task)
    place, claim = place_of(task.output), Claim(Path(task.folder), task.token) if task.folder else None
    store = UnitStore(place.work, place.stage(claim)) if isinstance(place, Local) and claim is not None else None
    shards = Shards(_group(place.work if store is None else store))

    @contextmanager
    def writing() -> Iterator[None]:
        with storage_errors(place.work, f"what is done stays in {place.work}: make room and go on with the same settings and resume=True"):
            if claim is not None:
                claim.require()
            place.require_there()
            yield

    def make(unit: int) -> UnitRecord:
        if store is not None:
            store.begin(unit)
        try:
            record = make_unit(shards, unit, layout.frames, frame, writing, patient=True)
        except FramesRaisedError as raised:
            if store is not None:
                store.end(len(layout.frames[shards.span(unit)]) - raised.missing)
            raise raised.first from None
        except Exception as error:
            if store is not None:
                store.abandon()
            if not isinstance(error, StorageError) or not is_full(error):
                raise  # the fault may be one of this machine alone
            return UnitRecord(unit, no_room=str(error))  # no other worker has more room
        if store is not None:
            record = _staged(record, store, shards, layout.frames)
        return replace(record, processor=processor())

    return make


def _staged(record: UnitRecord, store: UnitStore, shards: Shards, numbers: range) -> UnitRecord:
    """Return the record of a complete unit with its place in the stage, and all frames that the sequence itself lacks."""
    span, frames = shards.span(record.unit), record.frames
    attempt = store.end(span.stop - span.start)
    if store.earlier is not None:
        store.earlier = None
        frames = tuple(numbers[index] for index in shards.missing([record.unit]))
    return replace(record, frames=frames, attempt=attempt)


def require_version(task: UnitTask) -> None:
    """Refuse work for another version of the program."""
    if task.version != __version__:
        raise DataError(f"this worker has seaglint {__version__} and its sender {task.version}; install the same version on both")


def open_group(place: Place, stage: Any) -> Any:
    """Open the Zarr group of an unfinished sequence for writing through a stage, by its own metadata."""
    return _group(place.store(stage))


def _group(store: Any) -> Any:
    import zarr

    return zarr.open_group(store, mode="r+", zarr_format=3, use_consolidated=False)


@dataclass
class MissingUnits:
    """Units of a store that are to be made: by ``make_here`` or ``make_by_workers``, then checked by ``require_all``.

    Raises
    ------
    StorageError, Interrupted
        As ``seaglint.store.sequence_store.write_sequence``.
    """

    place: Place
    stage: Path | None  #: Stage of the claim; None where there are no locks.
    shards: Shards
    units: range  #: Units of this process's share.
    claim: Any
    numbers: range  #: Numbers of all frames of the store.
    remedy: Callable[[], str]  #: Remedy where there is no room.
    progress: Progress | None = None
    failed: list[UnitFailure] = field(default_factory=list)  #: Units with frames that failed.

    def __post_init__(self) -> None:
        self.total = sum(self.shards.span(unit).stop - self.shards.span(unit).start for unit in self.units)
        self.count = self.total - len(self._missing(self.units))
        self.report()

    @property
    def left(self) -> list[int]:
        """Return the units with missing frames."""
        return sorted({index // self.shards.frames_per_unit for index in self._missing(self.units)})

    def make_here(self, frame: Frame, attempts: int) -> None:
        """Make the units one after the other.

        Parameters
        ----------
        frame : callable
        attempts : int
            Number of attempts of a frame that raises before the others continue without it; at 1 its error is raised.
        """
        with stop_on_signal() as stopped:
            for unit in self.left:
                if stopped:
                    raise self._interrupted()
                # Finished frames of an attempt stay: a further one makes the missing frames alone.
                for tried in range(1, attempts + 1):
                    report = partial(self.report, self.count)
                    settings: dict[str, Any] = {"stopped": lambda: bool(stopped), "report": report, "patient": attempts > 1}
                    try:
                        record = make_unit(self.shards, unit, self.numbers, frame, self._writing, **settings)
                    except FramesRaisedError as raised:
                        if attempts == 1:
                            raise raised.first from None
                        self.count = self.total - len(self._missing(self.units))
                        if stopped:
                            break
                        if tried == attempts:
                            self._give_up(UnitFailure(unit, one_line(raised.first), "".join(format_exception(raised.first))))
                    else:
                        self.count += len(record.frames)
                        break
            if stopped and self.count < self.total:
                raise self._interrupted()

    def make_by_workers(self, spread: Spread, note: Callable[[str], None]) -> None:
        """Have the units made by workers; ``note`` is called with the types of processors that made them."""
        left, processors = self.left, set[str]()
        if not left:
            return
        try:
            # At once: a unit may take the workers a minute, and this process writes no part of it.
            with stop_on_signal(at_once=True), spread(UnitTask.of(self.place, self.claim), left) as outcomes:
                for outcome in outcomes:
                    if isinstance(outcome, UnitFailure):
                        self._take_begun(outcome.unit)
                        self._give_up(outcome)
                        self.count = self.total - len(self._missing(self.units))
                    elif outcome.no_room:
                        raise StorageError(outcome.no_room)
                    else:
                        self._take(outcome.attempt)
                        self.count += len(outcome.frames)
                        if outcome.processor not in processors:
                            processors.add(outcome.processor)
                            note(outcome.processor)
                    self.report()
        except BaseException as error:
            # Units that the workers finished, and could not report.
            with suppress(SeaglintError):
                for unit in self.left:  # a unit that was taken keeps its first outcome
                    self._take_begun(unit)
            if not isinstance(error, KeyboardInterrupt):
                raise
            self.count = self.total - len(self._missing(self.units))
            if self.count < self.total:
                raise self._interrupted() from None

    def _take(self, attempt: str) -> None:
        """Move the frames of a unit from the stage into the store."""
        if self.stage is not None and attempt:
            with self._writing():
                take_unit(self.stage / attempt, Path(self.place.work))

    def _take_begun(self, unit: int) -> None:
        """Move the most complete attempt of a unit that no worker finished."""
        attempt = None if self.stage is None else best_attempt(self.stage / str(unit))
        if attempt is not None:
            self._take(f"{unit}/{attempt.name}")

    def require_all(self) -> None:
        """Raise an error that names the frames that failed.

        Raises
        ------
        DataError
            Frames that raised too often; the rest is in.
        """
        names = [self.numbers[index] for index in self._missing([failure.unit for failure in self.failed])]
        if names:
            raise DataError(
                f"{len(names)} of {self.total} frames were not made: {listed(names)} ({self.failed[0].error}); tracebacks are in "
                f"{self.place.errors}, all else in {self.place.work}: go on with resume=True"
            )

    def report(self, before: int | None = None, made: int = 0) -> None:
        """Report the number of finished frames."""
        if self.progress is not None:
            self.progress((self.count if before is None else before) + made, self.total)

    def _give_up(self, failure: UnitFailure) -> None:
        absent = self._missing([failure.unit])
        number = self.numbers[absent[0] if absent else self.shards.span(failure.unit).start]
        with storage_errors(self.place.work, self.remedy):
            self.place.keep_traceback(f"frame-{number:06d}.txt", f"{failure.traceback}\n{failure.error}\n")
        log.warning("seaglint: frame %d: %s; the rest goes on", number, failure.error)
        self.failed.append(failure)

    def _missing(self, units: range | list[int]) -> list[int]:
        with storage_errors(self.place.work, self.remedy):
            return self.shards.missing(units)

    def _interrupted(self) -> Interrupted:
        state = f"stopped after {self.count} of {self.total} frames, kept in {self.place.work}"
        return Interrupted(f"{state}; go on with the same settings and resume=True")

    @contextmanager
    def _writing(self) -> Iterator[None]:
        with storage_errors(self.place.work, self.remedy):
            self.claim.require()
            self.place.require_there()
            yield
