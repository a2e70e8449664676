"""Fill a store with the frames that are missing: in this process, or by others who are handed units."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

from seaglint.errors import DataError, SeaglintError, StorageError
from seaglint.io.claim import Claim
from seaglint.io.failures import storage_errors
from seaglint.io.layout import Layout
from seaglint.io.manifest import listed
from seaglint.io.place import Place, place_of
from seaglint.io.provenance import processor
from seaglint.io.shards import Frame, Shards, UnitFailure, UnitRecord, make_unit
from seaglint.io.stopping import stop_on_signal
from seaglint.version import __version__

Progress = Callable[[int, int], None]
"""Called with (frames done, frames in all): once at the start and after each frame."""


class Interrupted(SeaglintError):  # noqa: N818 (an answer to a request, not a mistake)
    """Stopped on request between two frames; what is done stays and can be resumed."""

    exit_code = 130


@dataclass(frozen=True)
class UnitTask:
    """What another process must know to write units into a store."""

    output: str
    """Name of the store."""
    folder: str
    """What is claimed for us; empty where there are no locks."""
    token: str
    """Of the claim."""
    version: str = __version__
    """Of the program that asks."""

    @classmethod
    def of(cls, place: Place, claim: Any) -> UnitTask:
        """Of a place that is held."""
        return cls(place.name, "" if claim.folder is None else str(Path(claim.folder).absolute()), claim.token)


Spread = Callable[[UnitTask, Sequence[int]], AbstractContextManager[Iterator[UnitRecord | UnitFailure]]]
"""Has units made elsewhere, by :func:`unit_maker` there; outcomes come as they finish, and leaving the context cancels the rest."""


def unit_maker(task: UnitTask, layout: Layout, frame: Frame) -> Callable[[int], UnitRecord]:
    """Function that makes one unit after the other in a store that another process holds.

    Raises
    ------
    DataError
        That process runs another version of the program; frames would not be the same.
    """
    require_version(task)
    place = place_of(task.output)
    shards = Shards(_opened(place))

    @contextmanager
    def writing() -> Iterator[None]:
        with storage_errors(place.work, f"what is done stays in {place.work}: make room and run the same command with --resume"):
            if task.folder:
                Claim(Path(task.folder), task.token).require()
            place.require_there()
            yield

    def make(unit: int) -> UnitRecord:
        try:
            record = make_unit(shards, unit, layout.frames, frame, writing, patient=True)
        except StorageError as error:  # no other worker has more room
            return UnitRecord(unit, no_room=str(error))
        return replace(record, processor=processor())

    return make


def require_version(task: UnitTask) -> None:
    """Refuse work for another version of the program."""
    if task.version != __version__:
        raise DataError(f"this worker has seaglint {__version__} and its sender {task.version}; install the same version on both")


def _opened(place: Place) -> Any:
    import zarr

    return zarr.open_group(place.work, mode="r+", zarr_format=3, use_consolidated=False)


def fill(
    place: Place,
    shards: Shards,
    units: range,
    claim: Any,
    numbers: range,
    frame: Frame,
    remedy: Callable[[], str],
    *,
    progress: Progress | None,
    spread: Spread | None,
    note: Callable[[str], None],
) -> None:
    """Make and write the frames of some units that are missing; ``note`` is told types of processors that made them.

    Raises
    ------
    DataError
        Frames that others did not make; the rest is in.
    StorageError, Interrupted
        As :func:`seaglint.io.store.write_sequence`.
    """
    total = sum(shards.span(unit).stop - shards.span(unit).start for unit in units)
    with storage_errors(place.work, remedy):
        missing = shards.missing(units)
    left = sorted({index // shards.frames_per_unit for index in missing})
    count = total - len(missing)
    processors: set[str] = set()

    def told(done: int) -> None:
        if progress is not None:
            progress(done, total)

    def told_after(before: int, made: int) -> None:
        told(before + made)

    def interrupted() -> Interrupted:
        return Interrupted(f"stopped after {count} of {total} frames, kept in {place.work}; go on with the same command and --resume")

    @contextmanager
    def writing() -> Iterator[None]:
        with storage_errors(place.work, remedy):
            claim.require()
            place.require_there()
            yield

    told(count)
    if not left:
        return
    with stop_on_signal() as stopped:
        if spread is None:
            for unit in left:
                if stopped:
                    raise interrupted()
                report = partial(told_after, count)
                record = make_unit(shards, unit, numbers, frame, writing, stopped=lambda: bool(stopped), report=report)
                count += len(record.frames)
            if stopped and count < total:
                raise interrupted()
            return
        failed: list[UnitFailure] = []
        with spread(UnitTask.of(place, claim), left) as outcomes:
            for outcome in outcomes:
                if isinstance(outcome, UnitFailure):
                    failed.append(outcome)
                    span = shards.span(outcome.unit)
                    absent = shards.missing([outcome.unit])
                    count += sum(span.start <= index < span.stop for index in missing) - len(absent)
                    place.keep_traceback(
                        f"frame-{numbers[absent[0] if absent else span.start]:06d}.txt", f"{outcome.traceback}\n{outcome.error}\n"
                    )
                elif outcome.no_room:
                    raise StorageError(outcome.no_room)
                else:
                    count += len(outcome.frames)
                    if outcome.processor not in processors:
                        processors.add(outcome.processor)
                        note(outcome.processor)
                told(count)
                if stopped and count < total:
                    raise interrupted()
    if failed:
        names = [numbers[index] for index in shards.missing([failure.unit for failure in failed])]
        if names:
            raise DataError(
                f"{len(names)} of {total} frames were not made: {listed(names)} ({failed[0].error}); tracebacks are in {place.errors}, "
                f"all else in {place.work}: go on with --resume"
            )
