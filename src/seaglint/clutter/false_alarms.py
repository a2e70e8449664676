"""False-alarm rates per pixel relative to the Gaussian tail, with intervals for correlated pixels, and the whole rate curve.

::

    alarms = FalseAlarms((3.0, 3.5))
    for block in blocks:                       # in order of time
        alarms.add(standardise(laplacian.apply(block), mask))
    for r in alarms.rates():
        print(r.threshold_sigma, r.rate, r.rate_low, r.rate_high, r.ratio)

One accumulator per region and filter; it holds no frames.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError, DomainError
from seaglint.base.jit import njit
from seaglint.clutter.cluster_variance import FEW, FEWEST_COUNTS, LOWER, ClusterVariance, CorrelatedLags, effective_interval, rate_variance
from seaglint.clutter.exceedances import MAX_LAG, Events, EventTracker, JointExceedances, JointProbability
from seaglint.clutter.filters import as_frames
from seaglint.clutter.thresholds import gaussian_rate

BIN: Final = 0.02  #: Width of a bin of the histogram of z [standard deviations].

LOWEST: Final = -10.0  #: Lower end of the histogram [standard deviations]; lower values are in the first bin.

#: Upper end of the histogram [standard deviations]: a single bright pixel among 22 500. Higher values are in the last bin.
HIGHEST: Final = 150.0

_PER_SIGMA: Final = 1.0 / BIN  #: Number of bins in a standard deviation, exactly 50.
_BINS = round((HIGHEST - LOWEST) / BIN)

SEGMENTS: Final = 256  #: Largest number of time segments of the counts; when it is reached, neighbours are joined.

_INDEPENDENT = f"fewer than {FEWEST_COUNTS} exceedances; the interval takes pixels as independent"

#: Lags at which clusters are counted, over those at which z is correlated, where z has the mean and deviation of the same pixels [1].
#:
#: What these leave of the scatter is small within a patch and adds up over rough and calm patches.
ESTIMATED_REACH: Final = 1.5

LONE_SHARE: Final = 0.15  #: Share of a region's exceedances above which a single row or column is examined.

LONE_TIMES: Final = 4.0  #: Ratio of the exceedances of a row or column to its neighbours' above which it is reported.


@njit
def _scan(
    z: np.ndarray, columns: int, tile: int, least: float, histogram: np.ndarray, valid: np.ndarray, sums: np.ndarray, index: np.ndarray
) -> int:
    """Add a frame to the histogram and to the valid pixels per tile; store the indices of pixels above ``least``, return their number.

    Sums of z and of z² - 1 are added to ``sums``, shape (2, tile rows, tile columns).
    """
    n = 0
    rows = z.size // columns
    for r in range(rows):
        up = r // tile
        for c0 in range(0, columns, tile):
            number, total, square = 0, 0.0, 0.0
            for c in range(c0, min(c0 + tile, columns)):
                value = z[r * columns + c]
                if np.isnan(value):
                    continue
                number += 1
                total += value
                square += value * value - 1.0
                place = (value - LOWEST) * _PER_SIGMA
                if place < 0.0:
                    histogram[0] += 1
                elif place >= _BINS:
                    histogram[_BINS - 1] += 1
                else:
                    histogram[int(place)] += 1
            valid[up, c0 // tile] += number
            sums[0, up, c0 // tile] += total
            sums[1, up, c0 // tile] += square
        for i in range(r * columns, (r + 1) * columns):
            if z[i] > least:
                index[n] = i
                n += 1
    return n


@njit
def _tally(index: np.ndarray, columns: int, tile: int, cells: np.ndarray) -> None:
    for i in index:
        cells[i // columns // tile, i % columns // tile] += 1


@dataclass(frozen=True)
class FalseAlarmRate:
    """Rate of exceedances of one threshold."""

    threshold_sigma: float  #: Threshold [standard deviations].
    exceedances: int  #: Number of pixels above it, over all frames.
    pixels: int  #: Number of examined pixels, over all frames.
    rate: float  #: Exceedances per pixel and frame [1].
    rate_low: float | None  #: Lower end of the confidence interval [1]; None without an interval, see ``note``.
    rate_high: float | None  #: Upper end of the confidence interval [1]; None without an interval.
    level: float  #: Level of the interval [1].
    gaussian_rate: float  #: One-sided Gaussian tail [1].
    inflation: float | None  #: Variance of the rate over that of independent pixels [1]; pixels / inflation is the effective number.
    correlation_time: float | None  #: 1/e time of the exceedances [frames]; None with the reason in ``correlation_note``.
    note: str | None = None  #: Reason for an absent interval, or the assumption behind the interval.
    correlation_note: str | None = None  #: Reason for an absent correlation time.
    degrees: float = math.inf  #: Degrees of freedom of ``inflation`` [1]; infinite where it is not estimated.

    @property
    def ratio(self) -> float:
        """Rate over the Gaussian tail [1]."""
        return self.rate / self.gaussian_rate


@dataclass(frozen=True)
class RateCurve:
    """Rate of exceedances at every threshold, from the histogram."""

    threshold: NDArray[np.float64]  #: Lower edges of the bins [standard deviations].
    exceedances: NDArray[np.int64]  #: Pixels at or above each.
    pixels: int  #: Number of examined pixels.

    @property
    def rate(self) -> NDArray[np.float64]:
        """Rate of exceedances per pixel and frame [1]."""
        return self.exceedances / max(self.pixels, 1)

    @property
    def gaussian_rate(self) -> NDArray[np.float64]:
        """One-sided Gaussian tail [1]."""
        return gaussian_rate(self.threshold)

    def density(self, threshold: float) -> float:
        """Density of z at a threshold [per standard deviation], over 0.2 standard deviations, as single bins may be empty."""
        if self.threshold.size < 2:
            return 0.0
        below, above = (
            float(np.interp(threshold + side * 0.1, self.threshold, self.exceedances, left=self.exceedances[0], right=0.0))
            for side in (-1, 1)
        )
        return (below - above) / 0.2 / max(self.pixels, 1)

    def threshold_for(self, rate: float) -> float | None:
        """Lowest threshold whose measured rate is at most ``rate`` [standard deviations]; None below one exceedance in the data."""
        if not 0 < rate < 1:
            raise DomainError(f"rate = {rate:g} is not between 0 and 1")
        if rate * self.pixels < 1:
            return None
        return float(self.threshold[int(np.argmax(self.rate <= rate))])


def lone_lines(counts: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the rows (or columns) with far more exceedances than their neighbours: bad lines of a sensor, edges of a picture.

    A line counts if it has at least ``LONE_SHARE`` of all exceedances and 10 of them, and ``LONE_TIMES`` as many as the lines two
    away (a filter of three pixels carries it into the next ones) and as the mean line.

    Parameters
    ----------
    counts : ndarray of int, shape (lines,)
        From :meth:`FalseAlarms.lines`.

    Returns
    -------
    ndarray of int
        Numbers of the lines, in rising order.

    Examples
    --------
    >>> lone_lines(np.array([2, 1, 3, 4, 90, 6, 2, 1, 2, 3])).tolist()
    [4]
    """
    total = int(counts.sum())
    if counts.size < 5 or total == 0:
        return np.empty(0, np.int64)
    wide = np.pad(counts, 2, mode="constant")
    neighbours = np.maximum(np.maximum(wide[:-4], wide[4:]), total / counts.size)
    return np.flatnonzero((counts >= 10) & (counts >= LONE_SHARE * total) & (counts > LONE_TIMES * neighbours))


class FalseAlarms:
    """Accumulator of the exceedances of one region's z.

    Parameters
    ----------
    thresholds : sequence of float
        In standard deviations, above 0; duplicates are taken once.
    max_lag : int
        Largest lag of the joint probability [frames].
    estimated : bool
        Whether mean and standard deviation behind z are those of the same pixels: they follow the exceedances, which makes the rate more
        certain. Each cell moves the threshold m by (sum z + m / 2 sum (z² - 1)) / pixels.

    Raises
    ------
    DomainError
        Thresholds that are missing or not above 0.
    """

    def __init__(self, thresholds: Sequence[float] = (3.0, 3.5), max_lag: int = MAX_LAG, *, estimated: bool = False) -> None:
        self.thresholds = tuple(sorted({float(m) for m in thresholds}))
        if not self.thresholds or not all(0 < m < HIGHEST for m in self.thresholds):
            raise DomainError(f"thresholds = {list(thresholds)}: give numbers of standard deviations above 0 and below {HIGHEST:g}")
        self.estimated = estimated
        # Exceedances are counted at lower thresholds as well, for the intervals.
        self._levels = tuple(sorted({f * m for m in self.thresholds for f in (1.0, LOWER)}))
        self.frames = 0
        self.empty_frames = 0
        self.histogram = np.zeros(_BINS, np.int64)
        self._joint = {m: JointExceedances(m, max_lag) for m in self.thresholds}
        self._events = {m: EventTracker(m) for m in self.thresholds}
        self._rows: NDArray[np.int64] = np.zeros((len(self.thresholds), 0), np.int64)
        self._columns: NDArray[np.int64] = self._rows
        self._per_segment = 1
        self._shape: tuple[int, ...] = ()
        self._tile = 0
        self._lags: CorrelatedLags | None = None
        self._variances: dict[float, ClusterVariance] = {}

    def add(self, z: ArrayLike) -> None:
        """Add the next frames of z, shape (k, rows, columns), NaN outside the region and where missing [standard deviations].

        Frames without any valid pixel (constant ones, for instance) are counted in ``empty_frames``.
        """
        frames = as_frames(z)
        if self.frames == 0:
            self._shape = frames.shape[1:]
            # Few enough cells for a transform at the end, small enough to resolve correlations of a few pixels.
            self._tile = max(4, -(-max(self._shape) // 32))
            self._cells = np.zeros((len(self._levels), SEGMENTS, *(-(-n // self._tile) for n in self._shape)), np.int64)
            self._valid = np.zeros(self._cells.shape[1:], np.int64)
            self._sums = np.zeros((SEGMENTS, 2, *self._cells.shape[2:]))
            self._rows, self._columns = (np.zeros((len(self.thresholds), n), np.int64) for n in self._shape)
        elif frames.shape[1:] != self._shape:
            raise DataError(f"frames of {frames.shape[1:]} pixels follow frames of {self._shape}; all frames of a sequence have one size")
        self._lags = None
        self._variances.clear()
        columns = self._shape[1]
        index = np.empty(frames[0].size, np.int64)
        for frame in frames.reshape(frames.shape[0], -1):
            if self.frames == SEGMENTS * self._per_segment:
                self._join()
            s = self.frames // self._per_segment
            before = int(self._valid[s].sum())
            least = self._levels[0]
            bright = index[: _scan(frame, columns, self._tile, least, self.histogram, self._valid[s], self._sums[s], index)]
            valid = int(self._valid[s].sum()) - before
            for level, m in enumerate(self._levels):
                exceeding = bright if level == 0 else bright[frame[bright] > m]
                _tally(exceeding, columns, self._tile, self._cells[level, s])
                if m not in self._joint:
                    continue
                k = self.thresholds.index(m)
                self._rows[k] += np.bincount(exceeding // columns, minlength=self._shape[0])
                self._columns[k] += np.bincount(exceeding % columns, minlength=columns)
                self._joint[m]._add(exceeding, frame.size, valid)
                self._events[m]._add(exceeding, frame, columns, valid)
            self.frames += 1
            self.empty_frames += valid == 0

    def _join(self) -> None:
        half = SEGMENTS // 2
        self._cells[:, :half] = self._cells[:, 0::2] + self._cells[:, 1::2]
        self._valid[:half] = self._valid[0::2] + self._valid[1::2]
        self._cells[:, half:] = 0
        self._valid[half:] = 0
        self._sums[:half] = self._sums[0::2] + self._sums[1::2]
        self._sums[half:] = 0
        self._per_segment *= 2

    @property
    def pixels(self) -> int:
        """Valid pixels over all frames."""
        return int(self.histogram.sum())

    def _variance(self, m: float) -> ClusterVariance:
        if m not in self._variances:
            # The last segment may hold fewer frames than the others; its number of pixels accounts for that.
            s = -(-self.frames // self._per_segment)
            own, lower = (self._cells[self._levels.index(f * m), :s] for f in (1.0, LOWER))
            valid = self._valid[:s]
            reach = ESTIMATED_REACH if self.estimated else 1.0
            self._lags = self._lags or CorrelatedLags((self._sums[:s, 0], self._sums[:s, 1]), valid, reach)
            moved = [self._moved(f * m, s) for f in (1.0, LOWER)]
            by_lags = self._lags.alarm_variance(((own, moved[0]), (lower, moved[1])))
            few = int(own.sum()) < FEWEST_COUNTS
            alone = ClusterVariance(0.0, math.inf, 1.0, _INDEPENDENT)
            self._variances[m] = by_lags or (alone if few else rate_variance(own, valid, moved[0]))
        return self._variances[m]

    def _moved(self, threshold: float, segments: int) -> FloatArray | None:
        """Exceedances by which each cell moves the count through the threshold [1]; None where it is known."""
        if not self.estimated:
            return None
        total, square = self._sums[:segments, 0], self._sums[:segments, 1]
        return np.asarray(self.curve().density(threshold) * (total + 0.5 * threshold * square))

    def rates(self, level: float = 0.95) -> list[FalseAlarmRate]:
        """Return the rate at each threshold with its confidence interval of a level, lowest threshold first.

        The interval has an effective number of pixels (``seaglint.clutter.cluster_variance.effective_interval``), from the clusters of
        exceedances of the threshold and of a lower one. Fewer than 10 exceedances take those of the lower threshold, or else independent
        pixels; ``note`` reports it.

        Raises
        ------
        DomainError
            A level that is not between 0 and 1.
        """
        if not 0 < level < 1:
            raise DomainError(f"level = {level:g} is not between 0 and 1; choose e.g. 0.95")
        pixels = self.pixels
        out: list[FalseAlarmRate] = []
        for m in self.thresholds:
            gaussian = float(gaussian_rate(m))
            if pixels == 0:
                empty = "no pixel with a standard deviation in the region"
                out.append(FalseAlarmRate(m, 0, 0, float("nan"), None, None, level, gaussian, None, None, empty, empty))
                continue
            count = int(self._cells[self._levels.index(m)].sum())
            time, why = self.joint(m).correlation_time()
            variance = self._variance(m)
            note = variance.note or (FEW if count < FEWEST_COUNTS else None)
            low = high = inflation = None
            if variance.variance is not None:
                inflation = variance.inflation
                low, high = effective_interval(count, pixels, inflation, variance.degrees, level)
            rate = count / pixels
            out.append(FalseAlarmRate(m, count, pixels, rate, low, high, level, gaussian, inflation, time, note, why, variance.degrees))
        return out

    def lines(self, threshold: float) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Numbers of exceedances of one of the thresholds in each row and in each column, over all frames."""
        k = self.thresholds.index(self._counted(threshold))
        return self._rows[k], self._columns[k]

    def joint(self, threshold: float) -> JointProbability:
        """Joint probability of exceedances of one of the thresholds."""
        return self._joint[self._counted(threshold)].result()

    def events(self, threshold: float) -> Events:
        """Events of one of the thresholds, up to now."""
        return self._events[self._counted(threshold)].result()

    def _counted(self, threshold: float) -> float:
        if threshold not in self._joint:
            raise DomainError(f"threshold {threshold:g} was not counted; choose one of {', '.join(f'{m:g}' for m in self.thresholds)}")
        return float(threshold)

    def curve(self) -> RateCurve:
        """Rates at every threshold from the lowest to the first without exceedances; empty without pixels."""
        filled = np.flatnonzero(self.histogram)
        last = int(filled[-1]) + 2 if filled.size else 0
        # From the second bin on: the first also holds what lies below it.
        exceedances = np.append(self.histogram[::-1].cumsum()[::-1], 0)[1:last]
        return RateCurve(np.asarray(LOWEST + BIN * np.arange(1, last), np.float64), exceedances, self.pixels)
