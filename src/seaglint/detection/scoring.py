"""Scores of injected objects, intervals of rates, and the receiver operating characteristic of one run.

The score of an object is the largest statistic within the match radius of its pixel: it is detected at every threshold below its score,
so that one run gives the rates of detections and false alarms at every threshold. Intervals follow from the scatter between cells of the
frames, or between independent sequences.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError
from seaglint.base.jit import njit
from seaglint.clutter.cluster_variance import FEW, FEWEST_COUNTS, LOWER, CorrelatedLags, effective_interval, rate_variance, score_interval
from seaglint.clutter.false_alarms import RateCurve
from seaglint.detection.injection import Batch

IntArray = NDArray[np.int64]

SEGMENTS: Final = 256  #: Largest number of time segments in which exceedances are counted.

TILES: Final = 32  #: Largest number of tiles of a frame along an axis.

COARSER: Final = 4  #: Number of tiles and segments of the background in one of the injections' cells: an object is rarer than a pixel.

FEWEST_SEQUENCES: Final = 6  #: Least number of independent sequences whose scatter alone gives the intervals.

_WINDOW = 0.25


def match_offsets(radius: float) -> IntArray:
    """Pixels within a radius of a pixel, the pixel itself first, shape (n, 2) [px].

    Examples
    --------
    >>> match_offsets(1.0).tolist()
    [[0, 0], [-1, 0], [0, -1], [0, 1], [1, 0]]
    """
    if not 0.0 <= radius <= 50.0:
        raise DomainError(f"match radius = {radius:g} px is outside 0-50 px")
    axis = np.arange(-int(radius), int(radius) + 1)
    rows, columns = (g.ravel() for g in np.meshgrid(axis, axis, indexing="ij"))
    # A disc of pixels; a stable sort puts the pixel itself first.
    inside = rows**2 + columns**2 <= radius * radius
    offsets = np.stack([rows[inside], columns[inside]], axis=1)
    return np.asarray(offsets[np.argsort((offsets**2).sum(axis=1), kind="stable")], np.int64)


def around(image: NDArray[np.floating], row: IntArray, column: IntArray, offsets: IntArray) -> FloatArray:
    """Values at given offsets from each place, shape (places, offsets); NaN beyond the frame."""
    r, c = row[:, None] + offsets[:, 0], column[:, None] + offsets[:, 1]
    inside = (r >= 0) & (r < image.shape[0]) & (c >= 0) & (c < image.shape[1])
    values = np.full(r.shape, np.nan)
    values[inside] = image[r[inside], c[inside]]
    return values


def best(values: FloatArray) -> tuple[FloatArray, IntArray]:
    """Largest value of each row and its place; NaN, 0 where a row has none."""
    known = np.where(np.isnan(values), -np.inf, values)
    where = known.argmax(axis=1)
    score = known[np.arange(values.shape[0]), where]
    return np.where(np.isneginf(score), np.nan, score), where.astype(np.int64)


@dataclass(frozen=True)
class Scores:
    """Scores of injected objects of one contrast."""

    contrast: float  #: Signal of an object in the pixel at whose centre it lies [u].
    #: Largest statistic within the match radius, in standard deviations above the mean [1]; minus infinity where the detector returns
    #: NaN at the object. Shape (n,).
    score: FloatArray
    window: IntArray  #: Window of frames that holds the object, (n,).
    row: IntArray  #: Row of the pixel that holds the object [px, (n,)].
    column: IntArray  #: Column of that pixel [px, (n,)].
    error: FloatArray  #: Estimated less true place, row and column [px]; NaN where none was estimated. Shape (n, 2).
    offset: FloatArray  #: Displacement from the pixel's centre [px, (n, 2)].

    @classmethod
    def joined(cls, contrast: float, parts: list[tuple[Batch, FloatArray, FloatArray]]) -> Scores:
        """Return the scores and errors of several batches together."""
        batches, scores, errors = zip(*parts, strict=True)
        score = np.concatenate(scores)
        return cls(
            contrast,
            np.where(np.isnan(score), -np.inf, score),
            np.concatenate([np.full(b.size, b.window, np.int64) for b in batches]),
            np.concatenate([b.row for b in batches]),
            np.concatenate([b.column for b in batches]),
            np.concatenate(errors),
            np.concatenate([b.offset for b in batches]),
        )

    def detected(self, threshold: float) -> NDArray[np.bool_]:
        """True for each object above a threshold [standard deviations]."""
        return self.score > threshold

    def density(self, threshold: float) -> float:
        """Density of the scores at a threshold [per standard deviation]."""
        return float((np.abs(self.score - threshold) <= _WINDOW).mean() / (2 * _WINDOW))


@njit
def _sum_cells(z: np.ndarray, tile: int, threshold: float, lower: float, sums: np.ndarray) -> None:
    """Add pixels, exceedances, z, z² - 1 and pixels above ``lower`` to the sums of a frame's tiles, shape (5, tile rows, tile columns)."""
    rows, columns = z.shape
    for i in range(rows):
        a = i // tile
        for start in range(0, columns, tile):
            # Sums of a tile's row stay in registers.
            number, above, over = 0, 0, 0
            total, square = 0.0, 0.0
            for j in range(start, min(start + tile, columns)):
                value = z[i, j]
                if np.isnan(value):
                    continue
                number += 1
                above += value > threshold
                over += value > lower
                total += value
                square += value * value
            b = start // tile
            sums[0, a, b] += number
            sums[1, a, b] += above
            sums[2, a, b] += total
            sums[3, a, b] += square - number
            sums[4, a, b] += over


class SegmentSums:
    """Sums over time segments and tiles, whose scatter gives the intervals of rates.

    Where the threshold m depends on the mean and standard deviation of the same pixels, a cell moves it by
    (sum z + m / 2 sum (z² - 1)) / pixels, which is part of the scatter of every rate at that threshold.

    Parameters
    ----------
    frames, rows, columns : int
        Size of the sequence.
    threshold : float
        In standard deviations [1].
    estimated : bool
        Whether the threshold depends on the mean and standard deviation of the pixels themselves.
    each : int
        Frames of one independent sequence; 0 where all belong together.
    """

    def __init__(self, frames: int, rows: int, columns: int, threshold: float, *, estimated: bool, each: int = 0) -> None:
        self.threshold, self.estimated = float(threshold), estimated
        # Few sequences do not determine the scatter between them: then all cells count.
        self.each = each if each and frames // each >= FEWEST_SEQUENCES else 0
        self._sequences = np.zeros((frames // self.each if self.each else 0, 4))
        self.per_segment = -(-frames // SEGMENTS)
        # Tiles of 4 pixels or more, and so large that there are at most TILES along an axis.
        self.tile = max(4, -(-max(rows, columns) // TILES))
        segments = -(-frames // self.per_segment)
        self.sums = np.zeros((segments, 5, -(-rows // self.tile), -(-columns // self.tile)))

    def add(self, frame: int, z: NDArray[np.float32]) -> None:
        """Add one frame of z, shape (rows, columns), NaN where missing."""
        one = np.zeros(self.sums.shape[1:])
        _sum_cells(z, self.tile, self.threshold, LOWER * self.threshold, one)
        self.sums[frame // self.per_segment] += one
        if self.each:
            self._sequences[frame // self.each] += one[:4].sum(axis=(1, 2))

    @property
    def pixels(self) -> int:
        """Number of valid pixels."""
        return int(self.sums[:, 0].sum())

    @property
    def exceedances(self) -> int:
        """Number of pixels above the threshold."""
        return int(self.sums[:, 1].sum())

    def _moved(self, threshold: float) -> FloatArray:
        """Shift of a threshold by each cell [standard deviations], times all pixels."""
        return np.asarray(self.sums[:, 2] + 0.5 * threshold * self.sums[:, 3]) * float(self.estimated)

    def _moved_by_sequences(self) -> FloatArray:
        """Shift of the threshold by each independent sequence [standard deviations], times all pixels."""
        return np.asarray(self._sequences[:, 2] + 0.5 * self.threshold * self._sequences[:, 3]) * float(self.estimated)

    def false_alarm_interval(self, density: tuple[float, float], level: float) -> Interval:
        """Interval of the rate of exceedances.

        Parameters
        ----------
        density : (float, float)
            Density of z at the threshold, and at ``LOWER`` times the threshold [per standard deviation].
        level : float
            Confidence level of the interval [1].
        """
        if self.each:
            return interval_of_sequences(self._sequences[:, 1], self._sequences[:, 0], density[0] * self._moved_by_sequences(), level)
        pixels, counts, lower = (self.sums[:, k].astype(np.int64) for k in (0, 1, 4))
        count, number = int(counts.sum()), int(pixels.sum())
        if number == 0:
            return interval(counts, pixels, None, level)
        own, below = (d * self._moved(m) for d, m in zip(density, (self.threshold, LOWER * self.threshold), strict=True))
        variance = CorrelatedLags((self.sums[:, 2], self.sums[:, 3]), pixels).alarm_variance(((counts, own), (lower, below)))
        if variance is None:
            return interval(counts, pixels, own, level)
        low, high = effective_interval(count, number, variance.inflation, variance.degrees, level)
        return Interval(count / number, low, high, variance.inflation, None if count >= FEWEST_COUNTS else FEW)

    def detection_interval(self, scores: Scores, level: float) -> Interval:
        """Interval of the share of objects above the threshold."""
        hits = scores.detected(self.threshold)
        if self.each:
            sequence, number = scores.window // self.each, self._sequences.shape[0]
            moved_all = self._moved_by_sequences() * scores.density(self.threshold) * hits.size / max(self.pixels, 1)
            tried = np.bincount(sequence, minlength=number).astype(np.float64)
            return interval_of_sequences(np.bincount(sequence, hits, number).astype(np.float64), tried, moved_all, level)
        interval = self._interval_of_cells(scores, hits, COARSER, level)
        # A small frame has too few cells of that size to estimate how hits cluster; its tiles may suffice.
        return interval if interval.ends is not None else self._interval_of_cells(scores, hits, 1, level)

    def _interval_of_cells(self, scores: Scores, hits: NDArray[np.bool_], coarser: int, level: float) -> Interval:
        """Interval of the share of objects from cells of that many tiles along an axis."""
        segment = scores.window // self.per_segment
        # Cells of objects are coarser than cells of pixels: an object is rarer.
        few = max(self.sums.shape[0] // (SEGMENTS // COARSER), 1)
        place = (segment // few, scores.row // self.tile // coarser, scores.column // self.tile // coarser)
        cell_shift = self._moved(self.threshold)
        sizes, steps = cell_shift.shape, (few, coarser, coarser)
        shape = tuple(-(-n // d) for n, d in zip(sizes, steps, strict=True))
        objects, counts, moved = np.zeros(shape, np.int64), np.zeros(shape, np.int64), np.zeros(shape)
        np.add.at(objects, place, 1)
        np.add.at(counts, place, hits)
        a, b, c = (np.arange(n) // d for n, d in zip(sizes, steps, strict=True))
        np.add.at(moved, (a[:, None, None], b[:, None], c), cell_shift)
        shift = moved * scores.density(self.threshold) * hits.size / max(self.pixels, 1)
        return interval(counts, objects, shift, level)


@dataclass(frozen=True)
class Interval:
    """Rate with its confidence interval."""

    rate: float  #: Estimated rate [1].
    low: float | None  #: Lower end [1]; None where none can be given, see ``note``.
    high: float | None  #: Upper end [1]; None where none can be given.
    inflation: float  #: Variance over that of independent trials [1]; trials / inflation is the effective number.
    note: str | None = None  #: Why there is none, or what it rests on.

    @property
    def ends(self) -> list[float] | None:
        """The two ends, for JSON."""
        return None if self.low is None or self.high is None else [self.low, self.high]


def interval(counts: IntArray, trials: IntArray, shift: FloatArray | None, level: float) -> Interval:
    """Return Wilson's interval with the effective number of trials from the scatter between cells.

    Fewer than ``FEWEST_COUNTS`` occurrences, or as few that did not occur, are taken as independent, with the exact interval
    (:func:`exact_interval`) and a note.

    Parameters
    ----------
    counts, trials : ndarray of int, shape (segments, tile rows, tile columns)
        Occurrences and trials of each cell [1].
    shift : ndarray, optional
        By how many occurrences each cell moved the total through the threshold [1].
    level : float
        Confidence level of the interval [1].
    """
    count, number = int(counts.sum()), int(trials.sum())
    if number == 0:
        return Interval(float("nan"), None, None, float("nan"), "no trials")
    rate = count / number
    if min(count, number - count) < FEWEST_COUNTS:
        low, high = exact_interval(count, number, level)
        which = "events" if count < FEWEST_COUNTS else "misses"
        return Interval(rate, low, high, 1.0, f"fewer than {FEWEST_COUNTS} {which}; the interval assumes independent trials")
    scatter = rate_variance(counts, trials, shift)
    if scatter.variance is None:
        return Interval(rate, None, None, scatter.inflation, scatter.note)
    low, high = score_interval(count, number, scatter.inflation, scatter.degrees, level)
    return Interval(rate, low, high, scatter.inflation, scatter.note)


def exact_interval(count: int, number: int, level: float) -> tuple[float, float]:
    """Exact interval of a probability at the confidence ``level`` (Clopper and Pearson, Biometrika 26, 404, 1934).

    Wilson's leaves out small chances where one or two occurred: it covers 85 % instead of 95 % where half an occurrence is expected.

    Parameters
    ----------
    count, number : int
        Occurrences, and independent trials [1].
    level : float
        Confidence level of the interval [1].

    Returns
    -------
    (float, float)
        Lower and upper bound of the probability [1].

    Examples
    --------
    >>> [round(end, 4) for end in exact_interval(0, 100, 0.95)]
    [0.0, 0.0362]
    """
    from scipy.special import betaincinv

    half = 0.5 * (1.0 - level)
    low = float(betaincinv(count, number - count + 1, half)) if count else 0.0
    high = float(betaincinv(count + 1, number - count, 1.0 - half)) if count < number else 1.0
    return low, high


def interval_of_sequences(counts: FloatArray, trials: FloatArray, shift: FloatArray | None, level: float) -> Interval:
    """Interval of a rate from the scatter between independent sequences, whatever the correlation within each.

        V = s / (s - 1) sum (counts_i - rate trials_i)² / trials²,   s sequences with trials

    Parameters
    ----------
    counts, trials : ndarray, shape (sequences,)
        Occurrences and trials of each [1].
    shift : ndarray, optional
        By how many occurrences each moved the total through the threshold [1].
    level : float
        Confidence level of the interval [1].
    """
    used = trials > 0
    count, number, sequences = round(float(counts.sum())), round(float(trials.sum())), int(used.sum())
    if number == 0:
        return Interval(float("nan"), None, None, float("nan"), "no trials")
    rate = count / number
    few = min(count, number - count) < FEWEST_COUNTS
    if few or sequences < 2:
        which = "events" if count < FEWEST_COUNTS else "misses" if few else "sequences"
        low, high = exact_interval(count, number, level)
        return Interval(rate, low, high, 1.0, f"fewer than {FEWEST_COUNTS if few else 2} {which}; the interval assumes independent trials")
    # Counts that the common threshold moves with the sequence's own mean and deviation are part of the residual.
    residual = counts - rate * trials + (0.0 if shift is None else shift)
    variance = sequences / (sequences - 1) * float((residual[used] ** 2).sum()) / number**2
    inflation = max(variance * number / (rate * (1.0 - rate)), 1e-6)
    low, high = score_interval(count, number, inflation, float(sequences - 1), level)
    return Interval(rate, low, high, inflation)


def mean_interval(values: FloatArray, level: float) -> tuple[float, float, float, float]:
    """Return mean and standard deviation of independent values, and the half widths of their intervals [unit of the values].

    The interval of the standard deviation follows from the scatter of the squares, for values of any distribution.
    """
    from scipy.special import ndtri

    n = values.size
    if n < 2:
        return (float(values.mean()) if n else float("nan"), float("nan"), float("nan"), float("nan"))
    q = float(ndtri(0.5 + level / 2))
    mean, deviation = float(values.mean()), float(values.std(ddof=1))
    squares = (values - mean) ** 2
    half = q * float(squares.std(ddof=1)) / (2.0 * deviation * np.sqrt(n)) if deviation > 0 else 0.0
    return mean, deviation, q * deviation / float(np.sqrt(n)), half


POINTS: Final = 120  #: Number of thresholds of the characteristic.


@dataclass(frozen=True)
class Roc:
    """Operating characteristic."""

    threshold: FloatArray  #: In standard deviations, rising [1].
    p_fa: FloatArray  #: Rate of false alarms per pixel [1].
    p_fa_low: FloatArray  #: Lower edge of its band [1].
    p_fa_high: FloatArray  #: Upper edge of its band [1].
    p_d: FloatArray  #: Share of objects detected [1].
    p_d_low: FloatArray  #: Lower edge of its band [1].
    p_d_high: FloatArray  #: Upper edge of its band [1].

    def columns(self) -> dict[str, FloatArray]:
        """Columns of a table."""
        names = ("threshold", "p_fa", "p_fa_low", "p_fa_high", "p_d", "p_d_low", "p_d_high")
        return {("threshold_sigma" if name == "threshold" else name): getattr(self, name) for name in names}


def roc(curve: RateCurve, scores: Scores, inflation: tuple[float, float], level: float = 0.95) -> Roc:
    """Receiver operating characteristic over the thresholds at which there are false alarms.

    Parameters
    ----------
    curve : RateCurve
        Rate curve of the statistic without objects.
    scores : Scores
        Scores of the objects.
    inflation : (float, float)
        Variance of false alarms and of detections over the variance of independent ones, used for every threshold [1].
    level : float
        Confidence level of the bands, for each rate alone [1].
    """
    # Thresholds end at the last one with a false alarm.
    last = int(np.flatnonzero(curve.exceedances)[-1]) if curve.exceedances.any() else 0
    # Even in the logarithm of the rate, where the interest is.
    rates = np.geomspace(0.999, 1.0 / max(curve.pixels, 2), POINTS)
    chosen = np.unique(np.minimum(np.searchsorted(-curve.rate, -rates), last))
    count_fa = curve.exceedances[chosen]
    threshold = curve.threshold[chosen]
    ordered = np.sort(scores.score)
    count_d = ordered.size - np.searchsorted(ordered, threshold, side="right")

    def band(counts: NDArray[np.int64], number: int, factor: float) -> tuple[FloatArray, FloatArray]:
        ends = [score_interval(int(c), number, factor if np.isfinite(factor) else 1.0, float("inf"), level) for c in counts]
        return np.array([e[0] for e in ends]), np.array([e[1] for e in ends])

    fa, d = band(count_fa, curve.pixels, inflation[0]), band(count_d, ordered.size, inflation[1])
    return Roc(threshold, count_fa / max(curve.pixels, 1), *fa, count_d / ordered.size, *d)
