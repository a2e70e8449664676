"""Shards of a sequence, the units of its work: which frames exist, a checksum of each, and the making of a unit by one process."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable, Iterable, Mapping
from contextlib import AbstractContextManager, suppress
from dataclasses import dataclass
from hashlib import blake2b
from traceback import format_exception
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

DONE: Final = "frame_done"  #: Name of the array that marks the written frames.

CHECKSUM: Final = "frame_checksum"  #: Name of the array of the frames' checksums.

OVER: Final = "over"  #: Attribute of the checksums that names the arrays they cover, in order.


def frame_checksum(images: Iterable[NDArray[Any]]) -> int:
    """Return the first 64 bits of the BLAKE2b of a frame's arrays, little-endian, in the form in which the store returns them.

    All kinds of NaN count as one, and -0 as 0: chunks that hold the fill value alone are not stored.

    >>> frame_checksum([np.float32([1.0, -0.0])]) == frame_checksum([np.float32([1.0, 0.0])])
    True
    """
    digest = blake2b(digest_size=8)
    for image in images:
        values = np.asarray(image)
        if values.dtype.kind == "f":
            values = np.where(np.isnan(values), values.dtype.type(np.nan), values) + values.dtype.type(0.0)
        digest.update(np.ascontiguousarray(values, dtype=values.dtype.newbyteorder("<")).tobytes())
    return int.from_bytes(digest.digest(), "little")


def listed(numbers: Iterable[int], most: int = 8) -> str:
    """Return numbers of frames as text, with runs abbreviated.

    >>> listed([0, 1, 2, 5, 7, 8]), listed(range(0, 40, 2))
    ('0-2, 5, 7-8', '0, 2, 4, 6, 8, 10, 12, 14 and 12 more')
    """
    runs: list[list[int]] = []
    for number in map(int, numbers):
        # A number that follows the last one extends its run.
        if runs and number == runs[-1][1] + 1:
            runs[-1][1] = number
        else:
            runs.append([number, number])
    text = ", ".join(str(a) if a == b else f"{a}-{b}" for a, b in runs[:most])
    rest = sum(b - a + 1 for a, b in runs[most:])
    return f"{text} and {rest} more" if rest else text


log = logging.getLogger(__name__)

#: Callback that returns the images of a frame by variable (ny, nx), and its truth, for its number in the whole sequence.
Frame = Callable[[int], Mapping[str, NDArray[Any]]]

# A comment and no docstring: Sphinx cannot draw up a signature of an alias.
Block = dict[str, NDArray[Any]]  # arrays of a shard's frames, by path in the store


@dataclass(frozen=True)
class UnitRecord:
    """Result of a unit; it is small, since the frames themselves are in the store or in a stage."""

    unit: int
    frames: tuple[int, ...] = ()  #: Numbers of the frames that were made.
    seconds: float = 0.0  #: Duration of the work [s].
    processor: str = ""  #: Type of the processor that made it.
    no_room: str = ""  #: Reason why nothing can be written any more.
    attempt: str = ""  #: Folder of the frames in the stage; empty where they are in the store.


@dataclass(frozen=True)
class UnitFailure:
    """Unit that was not made after several attempts."""

    unit: int
    error: str
    traceback: str


class FramesRaisedError(Exception):
    """Error of frames that raised exceptions; the others are written."""

    def __init__(self, first: Exception, missing: int) -> None:
        super().__init__(str(first))
        self.first = first
        """First error; its notes name its frame, and hold the tracebacks of others."""
        self.missing = missing
        """Number of frames of the unit that are still missing."""


class Shards:
    """Arrays of an open store to which frames are written."""

    def __init__(self, group: Any) -> None:
        self.done, self.checksums = group[DONE], group[CHECKSUM]
        self.arrays = {path: group[path] for path in self.checksums.attrs[OVER].split()}
        self.frames, self.frames_per_unit = int(self.done.shape[0]), int(self.done.chunks[0])

    @property
    def count(self) -> int:
        """Return the number of units."""
        return -(-self.frames // self.frames_per_unit)

    def span(self, unit: int) -> slice:
        """Return the places of a unit's frames in the sequence."""
        return slice(unit * self.frames_per_unit, min((unit + 1) * self.frames_per_unit, self.frames))

    def missing(self, units: range | list[int]) -> list[int]:
        """Return the places of missing frames of some units."""
        absent = ~np.asarray(self.done[:], dtype=bool)
        return [int(place) for unit in units for place in np.flatnonzero(absent[self.span(unit)]) + self.span(unit).start]

    def read(self, span: slice) -> Block:
        """Return the stored arrays of some frames."""
        return {path: array[span] for path, array in self.arrays.items()}

    def blank(self, span: slice) -> Block:
        """Return empty arrays for some frames."""
        size = span.stop - span.start
        return {path: np.full((size, *array.shape[1:]), array.fill_value, array.dtype) for path, array in self.arrays.items()}

    def write(self, unit: int, block: Block, there: NDArray[np.bool_], sums: NDArray[np.uint64]) -> None:
        """Write a unit at once; its frames are marked as written last."""
        span = self.span(unit)
        for path, array in self.arrays.items():
            array[span] = block[path]
        self.checksums[span] = sums
        self.done[span] = there.astype(np.uint8)

    def erase(self, unit: int) -> None:
        """Remove the files of a unit: Zarr reads what it writes over, and fails where that is damaged."""
        from zarr.core.sync import sync

        for array in (self.done, self.checksums, *self.arrays.values()):
            place = array.store_path / array.metadata.encode_chunk_key((unit,) + (0,) * (array.ndim - 1))
            with suppress(FileNotFoundError):
                sync(place.delete())


def make_unit(
    shards: Shards,
    unit: int,
    numbers: range,
    frame: Frame,
    writing: Callable[[], AbstractContextManager[None]],
    *,
    stopped: Callable[[], bool] = lambda: False,
    report: Callable[[int], None] = lambda made: None,
    patient: bool = False,
) -> UnitRecord:
    """Make the frames of a unit that are missing and write them.

    Parameters
    ----------
    shards : Shards
    unit : int
    numbers : range
        Numbers of all frames of the store.
    frame : callable
    writing : callable
        Context of every access to the store: it checks who may write there, and reports refusals.
    stopped : callable
        Checked after each frame; if true, the finished frames of the unit are written.
    report : callable
        Called with the number of frames made so far.
    patient : bool
        Try the other frames too where one raises.

    Raises
    ------
    FramesRaisedError
        A frame raised an exception; the finished frames are written.
    """
    began, span = time.perf_counter(), shards.span(unit)
    with writing():
        there, sums = shards.done[span].astype(bool), np.asarray(shards.checksums[span])
        block = shards.read(span) if there.any() else shards.blank(span)
    # A shard is written as a whole: frames that exist are read first and written again unchanged.
    absent, made = np.flatnonzero(~there), []
    failed: Exception | None = None
    for index in absent:
        number = numbers[span.start + int(index)]
        try:
            images = frame(number)
            for path, values in block.items():
                values[index] = images[path.rpartition("/")[2]]
        except Exception as error:
            error.add_note(f"in frame {number}")
            if failed is None:
                failed = error
            else:
                failed.add_note("".join(format_exception(error)))
            if not patient or stopped():
                break
            continue
        sums[index] = frame_checksum(values[index] for values in block.values())
        made.append(int(index))
        if stopped():
            break
        if len(made) < absent.size:
            report(len(made))
    if made:
        there[made] = True
        with writing():
            shards.write(unit, block, there, sums)
        report(len(made))
    if failed is not None:
        raise FramesRaisedError(failed, absent.size - len(made)) from failed
    frames = tuple(numbers[span.start + index] for index in made)
    return UnitRecord(unit, frames, time.perf_counter() - began)


def forget_damaged(shards: Shards, units: Iterable[int], numbers: NDArray[np.int64]) -> list[int]:
    """Unmark frames that cannot be read, or do not match their checksums; ``numbers`` are the numbers of all frames.

    Returns
    -------
    list of int
        Places of these frames in the sequence.
    """
    damaged: list[int] = []
    for unit in units:
        span = shards.span(unit)
        places = np.arange(span.start, span.stop)
        try:
            there = shards.done[span].astype(bool)
            if not there.any():
                continue
            block, sums = shards.read(span), shards.checksums[span]
        except Exception:  # codecs raise nearly anything for what is cut
            log.warning("seaglint: frames %s cannot be read; they are made again", listed(numbers[places]))
            shards.erase(unit)
            damaged += places.tolist()
            continue
        wrong = [i for i in np.flatnonzero(there) if frame_checksum(block[path][i] for path in block) != int(sums[i])]
        if wrong:
            log.warning("seaglint: frames %s do not fit their checksums; they are made again", listed(numbers[places[wrong]]))
            there[wrong] = False
            shards.done[span] = there.astype(np.uint8)
            damaged += places[wrong].tolist()
    return damaged
