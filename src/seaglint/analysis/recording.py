"""Recording to analyse, and the first pass over it.

A :class:`Recording` has the size of a sequence, its frame rate and units, and reads blocks of frames. ``survey`` reads all frames once:
it computes the moments of every pixel in time and reports defects of the data.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import Progress
from seaglint.base.errors import DataError
from seaglint.clutter.correlation import BoolArray
from seaglint.clutter.moments import PixelMoments
from seaglint.detection.sources import PlainFrames

FrameArray = NDArray[np.float32]

Prepared = TypeVar("Prepared")

SATURATED_SHARE = 1e-4  #: Least share of saturated pixels that is reported: a tail of one in 10 000 is cut.

FEWEST_IN_SPIKE = 30  #: Least number of values equal to the largest one for a spike.

SPIKE = 1.3  #: Least ratio of a spike's values to those of the next lower level: a tail that is not cut has fewer at its end, not more.

FEWEST_STEPS = 8.0  #: Number of steps of single precision within a standard deviation below which rounding is reported.

FEWEST_FOR_DEAD = 8  #: Least number of frames for calling a pixel that never changes dead rather than calm.

MOST_DEAD = 0.25  #: Largest share of dead pixels; with more never-changing pixels the scene or the recording is still.

#: Largest share of rows that never change and are left out as a sky; with more of them the scene is still, or little of it moves.
MOST_SKY = 0.75


@dataclass(frozen=True)
class Recording(PlainFrames):
    """Sequence of images that is read on demand: from a file by ``seaglint.formats.recording.open_recording``, or by a user's function."""

    source: str  #: Path and format, for reports.
    frames: int  #: Number of frames.
    rows: int  #: Number of rows.
    columns: int  #: Number of columns.
    #: ``(start, stop) -> array (stop - start, rows, columns)`` in the file's own numbers; used by :meth:`read`.
    read_block: Callable[[int, int], NDArray[Any]] = field(repr=False, compare=False)
    frame_rate: float | None = None  #: Frames per second [Hz], from the file or the user.
    units: str | None = None  #: Units of the values, from the file or the user.
    #: Value at which the format or sensor saturates: full scale of integer formats, or the user's value; less ``offset``.
    saturation: float | None = None
    notes: tuple[str, ...] = ()  #: Notes for readers of results: lossy codec, channels averaged, frames missing.
    offset: float = 0.0  #: Level that :meth:`read` subtracts from the file's numbers, so that single precision resolves their spread.
    #: Blur of the sensor beyond its pixels, a standard deviation [px]: 0 for radiance rendered without a sensor; None where it is not
    #: known.
    blur_px: float | None = None

    @property
    def blur(self) -> str:
        """Return the blur in a sentence for readers of correlation times."""
        if self.blur_px is None:
            return "not known; correlation times and lengths are those of what made these frames, its blur included"
        if self.blur_px == 0.0:
            return "none (rendered without a sensor); correlation times of a real sensor are longer"
        return f"{self.blur_px:.2g} px (standard deviation, beyond the pixel itself), that of the sensor in the file"

    def read(self, start: int, stop: int) -> FrameArray:
        """Return frames ``start`` to ``stop`` (not included) as a float32 copy (k, rows, columns); NaN where there is no value.

        Raises
        ------
        DataError
            Frames outside the file, or that cannot be decoded.
        """
        if not 0 <= start < stop <= self.frames:
            raise DataError(f"{self.source}: frames {start}:{stop} asked for, but it has 0:{self.frames}")
        stored = self.read_block(start, stop)
        if self.offset:
            stored = np.asarray(stored, np.float64) - self.offset
        with np.errstate(over="ignore"):
            block = np.ascontiguousarray(stored, dtype=np.float32)
        if not (block.flags.writeable and block.flags.owndata):
            block = block.copy()  # a file's map is read-only, and dead pixels must not be blanked in a user's array
        if block.shape != (stop - start, self.rows, self.columns):
            raise DataError(
                f"{self.source}: frames {start}:{stop} came as {block.shape}, expected {(stop - start, self.rows, self.columns)}; "
                "the file is cut or its frames differ in size"
            )
        return block

    def blocks(self, memory: float = 64e6) -> Iterator[FrameArray]:
        """Iterate over all frames in order, in blocks of about ``memory`` bytes."""
        step = max(int(memory / (4.0 * self.rows * self.columns)), 1)
        for start in range(0, self.frames, step):
            yield self.read(start, min(start + step, self.frames))

    def with_notes(self, *notes: str) -> Recording:
        """Return the recording with further notes."""
        return replace(self, notes=(*self.notes, *notes))


class Passes:
    """Progress of several passes over a recording, reported as a share of its frames."""

    def __init__(self, progress: Progress, frames: int, passes: int) -> None:
        self._progress, self._frames, self._passes, self._ended = progress, frames, passes, 0
        progress(0, frames)

    def read(self, frames: int) -> None:
        """Report frames read in the present pass."""
        self._progress((self._ended * self._frames + frames) // self._passes, self._frames)

    def end(self) -> None:
        """End the present pass."""
        self._ended += 1


@dataclass(frozen=True)
class Survey:
    """Results of the first pass."""

    moments: PixelMoments  #: In time, of every pixel.
    dead: BoolArray  #: Rows and pixels that carry no picture; they are left out of everything. Shape (rows, columns).
    #: Frames in which each pixel reaches full scale, or the largest value where that is a spike. Shape (rows, columns).
    saturated: NDArray[np.int64]
    #: Frame in the middle of the recording, whose fine structure is not averaged over time. Shape (rows, columns).
    frame: FrameArray
    ceiling: float | None  #: The value they reach, in the file's numbers; None where nothing is saturated.
    notes: tuple[str, ...]  #: Sentences for the report.


def ahead(recording: Recording, prepare: Callable[[FrameArray], Prepared], memory: float = 8e6) -> Iterator[Prepared]:
    """Iterate over blocks of a recording; the next one is read and prepared while the present one is processed."""

    def prepared(start: int) -> Prepared:
        return prepare(recording.read(start, min(start + step, recording.frames)))

    step = max(int(memory / (4.0 * recording.rows * recording.columns)), 1)
    starts = range(0, recording.frames, step)
    with ThreadPoolExecutor(1) as reader:
        pending = reader.submit(prepared, 0)
        for start in starts:
            block = pending.result()
            if start + step < recording.frames:
                pending = reader.submit(prepared, start + step)
            yield block


class _Top:
    """Largest value, next lower value, their frequencies, and the places of the largest."""

    def __init__(self, rows: int, columns: int) -> None:
        self.highest, self.second = -np.inf, -np.inf
        self.count = self.below = 0
        self.where = np.zeros(rows * columns, np.int64)

    def add(self, block: FrameArray) -> None:
        """Add a block."""
        flat = block.reshape(-1)
        # In most blocks only a few values reach the present second largest one: the rest is skipped.
        place = np.flatnonzero(flat >= self.second)
        values = flat[place]
        finite = np.isfinite(values)
        place, values = place[finite], values[finite]
        if not values.size:
            return
        levels, counts = np.unique(values, return_counts=True)
        known = {self.highest: self.count, self.second: self.below}
        for level, count in zip(levels[-2:].tolist(), counts[-2:].tolist(), strict=True):
            known[level] = known.get(level, 0) + count
        first, second = sorted({*known, -np.inf}, reverse=True)[:2]
        if first > self.highest:
            self.where[:] = 0
        self.where += np.bincount(place[values == first] % self.where.size, minlength=self.where.size)
        self.highest, self.second = first, second
        self.count, self.below = known[first], known.get(second, 0) if np.isfinite(second) else 0

    def spike(self, dead: BoolArray) -> NDArray[np.int64] | None:
        """Return the frequency of the largest value at each pixel if it is a spike, without dead pixels; else None."""
        where = np.where(dead.ravel(), 0, self.where)
        count = int(where.sum())
        # A few stuck pixels are not a ceiling; neither is a constant. Five standard deviations of the counts exclude chance.
        enough = count >= FEWEST_IN_SPIKE and np.count_nonzero(where) >= FEWEST_IN_SPIKE // 3 and self.below > 0
        more = count - self.below
        return where.reshape(dead.shape) if enough and count > SPIKE * self.below and more > 5.0 * np.sqrt(count + self.below) else None


def survey(recording: Recording, progress: Callable[[int], None]) -> Survey:
    """Read all frames once; ``progress`` receives the number of frames read.

    Raises
    ------
    DataError
        No pixel has a finite value.
    """
    shape = recording.rows, recording.columns
    moments = PixelMoments.empty(*shape)
    saturated = np.zeros(shape, np.int64)
    flat_rows, flat_columns = np.ones(recording.rows, dtype=np.bool_), np.ones(recording.columns, dtype=np.bool_)
    top = _Top(*shape)
    repeated: list[bool] = []
    done = 0
    last: FrameArray | None = None
    middle = np.full(shape, np.nan, np.float32)
    for block in ahead(recording, lambda block: block):
        if done <= recording.frames // 2 < done + block.shape[0]:
            middle[:] = block[recording.frames // 2 - done]
        moments.add(block)
        top.add(block)
        if recording.saturation is not None:
            saturated += (block >= recording.saturation).sum(axis=0)
        # A line that varies in one block is not examined again: the first block settles nearly all.
        # fmax and fmin skip missing values, which max and min would return.
        with np.errstate(invalid="ignore"):
            for flat, frames in ((flat_rows, block), (flat_columns, block.swapaxes(1, 2))):
                if flat.any():
                    lines = frames[:, flat]
                    flat[flat] = ~(np.fmax.reduce(lines, axis=2) > np.fmin.reduce(lines, axis=2)).any(axis=0)
        repeated.extend(_repeated(block, last))
        last = block[-1].copy()
        done += block.shape[0]
        progress(done)
    missing = recording.frames * recording.rows * recording.columns - int(moments.count.sum())
    if not (moments.count > 0).any():
        raise DataError(f"{recording.source}: no pixel has a finite value; nothing can be said of it")
    dead, dead_notes = _dead(recording, moments, flat_rows)
    even = flat_columns & ~dead.all(axis=0)
    if even.any() and not flat_columns.all() and not flat_rows.all():
        # Reported, not left out: a detector processes the border too, and its edge is part of the false alarms.
        where = np.flatnonzero(even)
        dead_notes.append(
            f"{where.size} columns ({_listed(where)}) have one value from top to bottom: filters take their edges for "
            "clutter; leave them out with --regions"
        )
    ceiling = recording.saturation
    full = recording.frames * recording.rows * recording.columns * SATURATED_SHARE
    # An even line is a border or a dead one, not a ceiling.
    spike = None if saturated.sum() > full else top.spike(dead | flat_columns | flat_rows[:, np.newaxis])
    if spike is not None:
        saturated, ceiling = spike, top.highest
    ceiling = ceiling + recording.offset if ceiling is not None and saturated.any() else None
    notes = _notes(recording, missing, repeated)
    cut = _saturation_note(recording, saturated, ceiling, top if spike is not None else None)
    return Survey(moments, dead, saturated, middle, ceiling, (*dead_notes, *cut, *_resolution_note(recording, moments, dead), *notes))


def _repeated(block: FrameArray, last: FrameArray | None) -> list[bool]:
    """Return for each frame of a block whether it repeats the one before, all of it: a still scene repeats most of itself.

    Bits are compared, as a missing value is unequal to itself. Nearly all frames differ in every eighth of their rows already.
    """
    bits = block.view(np.uint32)
    before = [None if last is None else last.view(np.uint32), *bits[:-1]]
    # A few rows are compared first: a whole comparison of every frame would take as long as the reading.
    step = max(block.shape[1] // 8, 1)
    return [
        old is not None and np.array_equal(new[::step], old[::step]) and np.array_equal(new, old)
        for new, old in zip(bits, before, strict=True)
    ]


def _repeats_note(repeated: list[bool]) -> str:
    """Return the note on repeated frames: their number, share and runs."""
    frames = np.array([False, *repeated, False])
    edges = np.flatnonzero(frames[1:] != frames[:-1])
    runs = edges[1::2] - edges[::2]
    count = int(runs.sum())
    where = f"in {runs.size} runs of at most {int(runs.max())}" if runs.size > 1 else f"in one run from frame {int(edges[0])} on"
    return (
        f"{count} frames repeat the one before in all pixels ({100 * count / len(repeated):.3g} % of {len(repeated)}), {where}: "
        "frames were dropped or the frame rate is wrong; times are not to be trusted"
    )


def _saturation_note(recording: Recording, saturated: NDArray[np.int64], ceiling: float | None, spike: _Top | None) -> list[str]:
    """Return the note on the share of saturated pixels and its evidence."""
    share = float(saturated.sum()) / (recording.frames * recording.rows * recording.columns)
    if ceiling is None or (spike is None and share <= SATURATED_SHARE):
        return []
    known = ""
    if spike is not None:
        known = (
            f" (the largest value; {spike.count / spike.below:.3g} times as often as the next lower one; --saturation sets the true limit)"
        )
    return [
        f"{100 * share:.3g} % of the values are saturated at {ceiling:.7g}{known}: the bright tail is cut, mean and deviation are "
        "too small, and fits, thresholds in standard deviations and rates are those of the cut values"
    ]


def _resolution_note(recording: Recording, moments: PixelMoments, dead: BoolArray) -> list[str]:
    """Return the note on rounding of single precision values, where it exceeds an eighth of the standard deviation."""
    whole = moments.region(~dead)
    step = float(np.finfo(np.float32).eps) * abs(whole.mean)
    if whole.is_constant or not 0.0 < whole.std < FEWEST_STEPS * step:
        return []
    return [
        f"the values are rounded: their standard deviation is {whole.std:.3g}, single precision at {whole.mean + recording.offset:.7g} "
        f"has steps of {step:.2g}; save them less an offset, or in double precision"
    ]


def _dead(recording: Recording, moments: PixelMoments, flat_rows: BoolArray) -> tuple[BoolArray, list[str]]:
    """Return rows without any variation, pixels that never change or never have a value, and the notes on them."""
    notes: list[str] = []
    dead = moments.count == 0
    if (moments.minimum == moments.maximum).all() and np.ptp(moments.mean[~dead]) == 0.0:
        return dead, ["all pixels of all frames are equal: there are no statistics of a constant"]
    if recording.columns > 1 and flat_rows.any() and not flat_rows.all():
        where = np.flatnonzero(flat_rows)
        dead[where] = True
        notes.append(
            f"{where.size} rows left out ({_listed(where)}): all their pixels are equal in every frame, a dead line or an even sky"
        )
    if recording.frames >= FEWEST_FOR_DEAD:
        # A pixel that has few values has had no time to change.
        still = ~dead & (moments.minimum == moments.maximum) & (moments.count >= FEWEST_FOR_DEAD)
        rows = (still | dead).all(axis=1) & still.any(axis=1)
        # A still scene is no sky: where many of the other rows are still too, no row is left out.
        rest = ~rows[:, np.newaxis] & ~dead
        moves = rows.mean() <= MOST_SKY and still[rest].sum() <= MOST_DEAD * rest.sum()
        if recording.columns > 1 and rows.any() and moves:
            dead[rows], still[rows] = True, False
            where = np.flatnonzero(rows)
            notes.append(
                f"{where.size} rows left out ({_listed(where)}): none of their pixels ever changes, as in the sky of a sequence rendered "
                "without noise"
            )
        share = still.sum() / max((~dead).sum(), 1)
        if share > MOST_DEAD:
            notes.append(
                f"{100 * share:.3g} % of the pixels never change: a still scene or repeated frames, statistics in time mean little"
            )
        elif still.any():
            dead |= still
            notes.append(f"{int(still.sum())} pixels left out: they never change, as dead ones or a sky rendered without noise")
    return dead, notes


def _listed(numbers: NDArray[np.int64], most: int = 6) -> str:
    return ", ".join(map(str, numbers[:most])) + (", ..." if numbers.size > most else "")


def _notes(recording: Recording, missing: int, repeated: list[bool]) -> list[str]:
    notes = []
    total = recording.frames * recording.rows * recording.columns
    if missing:
        notes.append(
            f"{missing} values ({100 * missing / total:.3g} %) are missing (NaN or infinite) and left out, with what filters make of them"
        )
    if any(repeated):
        notes.append(_repeats_note(repeated))
    if recording.frames > 1 and recording.frame_rate is None:
        notes.append("the frame rate is not known: correlation times are null in seconds; give --frame-rate")
    if recording.frames == 1:
        notes.append("a single frame: nothing can be said of time")
    if recording.units is None:
        notes.append("the units are not known; give --units")
    return notes
