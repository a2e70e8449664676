"""Threshold exceedances in time: their joint probability, their duration, and the events they form.

Accumulators take blocks of z (:mod:`seaglint.clutter.thresholds`) in order of time. Only their list of events grows with the number of
frames. The result does not depend on the division of the sequence into blocks.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from seaglint.base.errors import DataError, DomainError
from seaglint.base.jit import njit
from seaglint.clutter.filters import as_frames

MAX_LAG: Final = 255  #: Default number of lags [frames]: with the present frame four words of 64 bits per pixel.

#: De Bruijn sequence: all 64 windows of six bits of this number differ, so that its product with 2^n has n written in its top bits.
_DE_BRUIJN = np.uint64(0x03F79D71B4CB0A89)

_PLACES = np.argsort([((0x03F79D71B4CB0A89 << n) & (2**64 - 1)) >> 58 for n in range(64)])


@njit
def above(z: np.ndarray, threshold: float, index: np.ndarray) -> int:
    """Store the flat indices of the pixels of one frame with z > threshold, in order; return their number."""
    n = 0
    for i in range(z.size):
        if z[i] > threshold:
            index[n] = i
            n += 1
    return n


@njit
def _joint(index: np.ndarray, t: int, last: np.ndarray, history: np.ndarray, joint: np.ndarray) -> None:
    """Count the lags at which each pixel above the threshold exceeded it before, then store its exceedance at frame t.

    Bit b of a pixel's history means an exceedance b frames before ``last``; it is shifted only when the pixel is met again.
    """
    words = history.shape[1]
    one = np.uint64(1)
    for i in index:
        age = t - last[i]
        if last[i] >= 0 and age < 64 * words:
            jump, bits = age // 64, np.uint64(age % 64)
            for w in range(words - 1, -1, -1):
                value = np.uint64(0)
                if w >= jump:
                    value = history[i, w - jump] << bits
                    if bits > 0 and w > jump:
                        value |= history[i, w - jump - 1] >> (np.uint64(64) - bits)
                history[i, w] = value
                # From one exceedance to the next, not from frame to frame: the lowest bit that is set, and its place.
                while value != 0:
                    rest = value & (value - one)
                    joint[64 * w + _PLACES[((value ^ rest) * _DE_BRUIJN) >> np.uint64(58)]] += 1
                    value = rest
        else:
            for w in range(words):
                history[i, w] = 0
        history[i, 0] |= one
        joint[0] += 1
        last[i] = t


@dataclass(frozen=True)
class JointProbability:
    """Autocorrelation of exceedances as in the source article (Fig. 6): probability that a pixel exceeds now and ``lag`` frames later."""

    lag: NDArray[np.int64]  #: 0 ... L [frames].
    joint: NDArray[np.float64]  #: R(lag) = P(b(t) = 1 and b(t + lag) = 1) [1]; R(0) is the rate p. NaN where no pair of frames exists.
    rate: float  #: p [1].

    @property
    def correlation(self) -> NDArray[np.float64]:
        """Correlation (R(lag) - p²) / (p - p²) [1]: 1 at lag 0, 0 where exceedances are independent."""
        p = self.rate
        if not 0 < p < 1:
            return np.full(self.joint.shape, np.nan)
        return (self.joint - p * p) / (p - p * p)

    def correlation_time(self) -> tuple[float | None, str | None]:
        """Lag at which ``correlation`` first falls to 1/e, by linear interpolation [frames], or None with the reason.

        Reasons are fewer than two frames, no exceedances, a correlation that vanishes within one frame (the true time is below the frame
        interval), or one that does not fall to 1/e within the available lags.
        """
        c = self.correlation
        if np.isfinite(self.joint).sum() < 2:
            return None, "a single frame has no correlation time"
        if not np.isfinite(c[0]):
            return None, "no exceedances"
        below = np.flatnonzero(c <= math.exp(-1))
        if below.size == 0:
            return None, f"exceedances stay correlated over {int(np.isfinite(c).sum()) - 1} frames"
        k = int(below[0])
        # A value that has fallen to noise at the first lag gives an upper limit only.
        if k == 1 and c[1] < 0.1:
            return None, "exceedances are forgotten within one frame interval"
        return float(k - 1 + (c[k - 1] - math.exp(-1)) / (c[k - 1] - c[k])), None


class JointExceedances:
    """Accumulator of the joint probability of exceedances of one threshold.

    Pixels that are missing (NaN) in a frame are not counted. The number of pairs between two frames is the number of valid pixels of the
    smaller one, which is exact for fixed masks and for frames that are missing as a whole.

    Parameters
    ----------
    threshold : float
        In standard deviations [1].
    max_lag : int
        Largest stored lag [frames].
    """

    def __init__(self, threshold: float, max_lag: int = MAX_LAG) -> None:
        if max_lag < 1:
            raise DomainError(f"max_lag = {max_lag} frames; give at least 1")
        self.threshold = float(threshold)
        self.max_lag = max_lag
        self._words = max_lag // 64 + 1
        self._counts = np.zeros(64 * self._words, np.int64)
        self._recent = np.zeros(max_lag + 1, np.int64)
        self._pairs = np.zeros(max_lag + 1, np.int64)
        self._frame = 0

    def add(self, z: ArrayLike) -> None:
        """Add the next frames, shape (k, rows, columns) or (rows, columns) [standard deviations]."""
        frames = as_frames(z)
        index = np.empty(frames[0].size, np.int64)
        for frame in frames.reshape(frames.shape[0], -1):
            self._add(index[: above(frame, self.threshold, index)], frame.size, int(np.isfinite(frame).sum()))

    def _add(self, index: NDArray[np.int64], pixels: int, valid: int) -> None:
        if self._frame == 0:
            self._last = np.full(pixels, -1, np.int32)
            self._history = np.zeros((pixels, self._words), np.uint64)
        _joint(index, self._frame, self._last, self._history, self._counts)
        self._recent = np.roll(self._recent, 1)
        self._recent[0] = valid
        self._pairs += np.minimum(self._recent, valid)
        self._frame += 1

    def result(self) -> JointProbability:
        """Return the joint probability at the lags that occurred."""
        lags = min(self.max_lag, max(self._frame - 1, 0)) + 1
        pairs = self._pairs[:lags]
        joint = np.where(pairs > 0, self._counts[:lags] / np.maximum(pairs, 1), np.nan)
        return JointProbability(np.arange(lags), joint, float(joint[0]))


@dataclass(frozen=True)
class Events:
    """Events of exceedances that touch in space (eight neighbours) or from one frame to the next (same or neighbouring pixel)."""

    first: NDArray[np.int64]  #: First frame [frames].
    duration: NDArray[np.int64]  #: Number of frames from first to last [frames].
    size: NDArray[np.int64]  #: Exceeding pixels over all frames of the event [px].
    peak: NDArray[np.float64]  #: Largest z [standard deviations].
    row: NDArray[np.int64]  #: Row of the largest z [px].
    column: NDArray[np.int64]  #: Column of the largest z [px].
    cut: NDArray[np.bool_]  #: True for events in the first or the last frame: the true duration is longer or equal.
    frames: int  #: Number of examined frames.
    pixels: int  #: Valid pixels over all frames.
    threshold: float  #: In standard deviations [1].

    def __len__(self) -> int:
        """Number of events."""
        return int(self.first.size)

    @property
    def per_frame(self) -> float:
        """Number of events that begin per frame [1]; events of the first frame, which began before, count as well."""
        return len(self) / self.frames if self.frames else math.nan

    @property
    def mean_duration(self) -> float | None:
        """Mean duration, corrected for events cut by the ends of the record [frames]; None without a complete event.

        The number of frames of events that are followed by a frame, over the number of observed ends: the maximum-likelihood estimate for
        durations without memory.
        """
        ends = int((self.first + self.duration < self.frames).sum())
        return float((self.duration.sum() - (len(self) - ends)) / ends) if ends else None


@njit
def _root(parent: np.ndarray, i: int) -> int:
    # Paths are halved on the way, so that later searches are short.
    while parent[i] != i:
        parent[i] = parent[parent[i]]
        i = parent[i]
    return i


@njit
def _label(index: np.ndarray, columns: int, before: np.ndarray, now: np.ndarray, parent: np.ndarray, active: int) -> int:
    """Label the exceedances of a frame in ``now`` with 1 + an entry of ``parent``; entries below ``active`` were in the frame before."""
    rows = now.size // columns
    used = active
    for i in index:
        r, q = i // columns, i % columns
        label, known = -1, 0
        for dr in range(-1, 2):
            for dq in range(-1, 2):
                if r + dr < 0 or r + dr >= rows or q + dq < 0 or q + dq >= columns:
                    continue
                j = i + dr * columns + dq
                # In the present frame only pixels labelled already count; the other neighbours are compared later.
                for present in range(2 if j < i else 1):
                    neighbour = now[j] if present else before[j]
                    if neighbour > 0 and neighbour != known:
                        known = neighbour
                        other = _root(parent, neighbour - 1)
                        if label < 0:
                            label = other
                        elif other != label:
                            low, high = min(label, other), max(label, other)
                            parent[high] = low
                            label = low
        if label < 0:
            label = used
            parent[used] = used
            used += 1
        now[i] = label + 1
    return used


@njit
def _merge(
    index: np.ndarray, z: np.ndarray, t: int, now: np.ndarray, parent: np.ndarray, table: np.ndarray, peak: np.ndarray, number: np.ndarray
) -> int:
    """Merge events of one root, add this frame's pixels, and renumber those that continue in order of their roots; return their number.

    ``table``: first, last, size, index of the peak per entry. ``number``: the new number, -1 where an event ended, -2 where it was merged.
    """
    used = number.size
    for i in range(used):
        root = _root(parent, i)
        number[i] = -1
        if root != i:
            number[i] = -2
            table[root, 0] = min(table[root, 0], table[i, 0])
            table[root, 1] = max(table[root, 1], table[i, 1])
            table[root, 2] += table[i, 2]
            if peak[i] > peak[root]:
                peak[root] = peak[i]
                table[root, 3] = table[i, 3]
    for i in index:
        root = _root(parent, now[i] - 1)
        table[root, 0] = min(table[root, 0], t)
        table[root, 1] = t
        table[root, 2] += 1
        if z[i] > peak[root]:
            peak[root] = z[i]
            table[root, 3] = i
    alive = 0
    for i in range(used):
        if number[i] == -1 and table[i, 1] == t:
            number[i] = alive
            alive += 1
    for i in index:
        now[i] = number[_root(parent, now[i] - 1)] + 1
    return alive


class EventTracker:
    """Accumulator of events of one threshold.

    Parameters
    ----------
    threshold : float
        In standard deviations [1].
    """

    def __init__(self, threshold: float) -> None:
        self.threshold = float(threshold)
        self._frame = 0
        self._pixels = 0
        self._columns = 0
        self._table = np.empty((0, 4), np.int64)
        self._peak = np.empty(0)
        self._done: list[tuple[NDArray[np.int32], NDArray[np.float32]]] = []

    def add(self, z: ArrayLike) -> None:
        """Add the next frames, shape (k, rows, columns) or (rows, columns) [standard deviations]."""
        frames = as_frames(z)
        index = np.empty(frames[0].size, np.int64)
        for frame in frames.reshape(frames.shape[0], -1):
            self._add(index[: above(frame, self.threshold, index)], frame, frames.shape[2], int(np.isfinite(frame).sum()))

    def _add(self, index: NDArray[np.int64], frame: NDArray[np.float32], columns: int, valid: int) -> None:
        if self._frame == 0:
            self._columns = columns
            self._before, self._now = np.zeros(frame.size, np.int32), np.zeros(frame.size, np.int32)
            self._index = np.empty(0, np.int64)
        elif frame.size != self._now.size:
            raise DataError(f"a frame of {frame.size} pixels follows frames of {self._now.size}; all frames of a sequence have one size")
        active = self._peak.size
        parent = np.arange(active + index.size)
        used = _label(index, columns, self._before, self._now, parent, active)
        table = np.concatenate([self._table, np.tile(np.array([self._frame, -1, 0, 0], np.int64), (used - active, 1))])
        peak = np.concatenate([self._peak, np.full(used - active, -np.inf)])
        number = np.empty(used, np.int64)
        alive = _merge(index, frame, self._frame, self._now, parent, table, peak, number)
        ended = number == -1
        if ended.any():
            # Stored in half the size: only the list of events grows with the record, to half a million in a thousand frames.
            self._done.append((table[ended].astype(np.int32), peak[ended].astype(np.float32)))
        living = number >= 0
        self._table, self._peak = table[living], peak[living]
        assert self._peak.size == alive
        self._before[self._index] = 0
        self._before, self._now = self._now, self._before
        self._index = index.copy()
        self._frame += 1
        self._pixels += valid

    def result(self) -> Events:
        """Return the events so far, including those that continue in the last frame."""
        if len(self._done) > 1:
            self._done = [(np.concatenate([d[0] for d in self._done]), np.concatenate([d[1] for d in self._done]))]
        table = np.concatenate([*(d[0] for d in self._done), self._table])
        peak = np.concatenate([*(d[1] for d in self._done), self._peak])
        columns = max(self._columns, 1)
        # By first frame, then by place.
        order = np.argsort(table[:, 0].astype(np.int64) * max(self._now.size if self._frame else 1, 1) + table[:, 3], kind="stable")
        first, last, size, where = table[order].astype(np.int64).T
        return Events(
            first=first,
            duration=last - first + 1,
            size=size,
            peak=peak[order],
            row=where // columns,
            column=where % columns,
            cut=(first == 0) | (last == self._frame - 1),
            frames=self._frame,
            pixels=self._pixels,
            threshold=self.threshold,
        )
