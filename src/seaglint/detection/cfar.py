"""Constant-false-alarm detectors: each pixel against a ring of training pixels around it.

The ring is the square of side 2 ``training`` + 1 less the square of side 2 ``guard`` + 1, which keeps a target out of its own background.
Both give equivalent standard deviations: z with Q(z) equal to the exact probability that independent clutter of the stated kind gives the
observed ratio. Sea clutter is neither independent nor of that kind, which is what counting false alarms shows.
Pixels nearer to the border than ``training``, and rings with missing values, give NaN.

References
----------
Finn and Johnson 1968, RCA Review 29, 414 (cell averaging, exponential); Rohling 1983, IEEE Trans. AES 19, 608 (ordered statistic);
for Gaussian clutter of unknown mean and variance, Student's t with n - 1 degrees of freedom.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import lru_cache
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from seaglint._jit import njit
from seaglint.detection.base import Frames
from seaglint.errors import DomainError

Clutter = Literal["exponential", "gaussian"]
FloatArray = NDArray[np.float64]

HIGHEST: Final = 37.0
"""Largest equivalent standard deviation given out; its tail, 1e-299, is near the least number there is."""

_NODES: Final = np.linspace(-8.0, HIGHEST, 9001)


def _check(training: int, guard: int) -> None:
    if not 0 <= guard < training:
        raise DomainError(f"guard = {guard} px and training = {training} px: 0 <= guard < training is needed")


def _cells(training: int, guard: int) -> int:
    return (2 * training + 1) ** 2 - (2 * guard + 1) ** 2


@njit
def _ring_sums(frame: np.ndarray, training: int, guard: int, level: float, total: np.ndarray, squares: np.ndarray) -> None:
    """Sum and sum of squares of (x - level) over the ring of every pixel, from columns' running sums; NaN near the border."""
    rows, columns = frame.shape
    for i in range(training, rows - training):
        # Column sums over the rows beside and above or below the guard: nothing is subtracted, so a value missing in the guard stays there.
        far1, far2, near1, near2 = np.zeros(columns), np.zeros(columns), np.zeros(columns), np.zeros(columns)
        for r in range(i - training, i + training + 1):
            near = abs(r - i) <= guard
            for j in range(columns):
                x = frame[r, j] - level
                if near:
                    near1[j] += x
                    near2[j] += x * x
                else:
                    far1[j] += x
                    far2[j] += x * x
        for j in range(training, columns - training):
            a, b = 0.0, 0.0
            for c in range(j - training, j + training + 1):
                a += far1[c]
                b += far2[c]
                if abs(c - j) > guard:
                    a += near1[c]
                    b += near2[c]
            total[i, j] = a
            squares[i, j] = b


@lru_cache(maxsize=16)
def _averaging_ratios(clutter: Clutter, cells: int) -> FloatArray:
    """Ratio T with tail Q(z) at the nodes of z."""
    from scipy.special import log_ndtr
    from scipy.stats import t

    tail = log_ndtr(-_NODES)
    if clutter == "exponential":
        return np.asarray(cells * np.expm1(-tail / cells))
    # Student's quantiles from the smaller tail, for their precision.
    small = t.isf(np.exp(log_ndtr(-np.abs(_NODES))), cells - 1)
    return np.asarray(np.sign(_NODES) * small)


def _equivalent(ratio: FloatArray, nodes: FloatArray) -> Frames:
    z = np.interp(ratio, nodes, _NODES)
    return np.where(np.isnan(ratio), np.nan, z).astype(np.float32)


@dataclass(frozen=True)
class CellAveraging:
    """Cell-averaging detector.

        exponential:  T = x / mean,                    P(T > c) = (1 + c / n)^-n
        gaussian:     T = (x - mean) / (s sqrt(1 + 1/n)),  Student's t with n - 1 degrees of freedom

    for the n training pixels; x is a radiance or count above 0 in the first case.

    Parameters
    ----------
    training, guard : int
        Half sides of the two squares [px], 0 <= guard < training.
    clutter : {"gaussian", "exponential"}
        The clutter it is exact for.
    """

    training: int = 8
    guard: int = 2
    clutter: Clutter = "gaussian"
    name: str = field(default="ca-cfar", init=False)
    lead: int = field(default=0, init=False)
    calibrated: bool = field(default=True, init=False)

    def __post_init__(self) -> None:
        _check(self.training, self.guard)

    def __call__(self, frames: Frames) -> Frames:
        """Equivalent standard deviations, -8 to :data:`HIGHEST`, shape (k, rows, columns) [1]; NaN for a ring without variation."""
        n = _cells(self.training, self.guard)
        nodes = _averaging_ratios(self.clutter, n)
        out = np.empty_like(frames, np.float32)
        for k, frame in enumerate(frames):
            x = np.ascontiguousarray(frame, np.float64)
            finite = np.isfinite(x)
            level = float(x[finite].mean()) if self.clutter == "gaussian" and finite.any() else 0.0
            total, squares = np.full(x.shape, np.nan), np.full(x.shape, np.nan)
            _ring_sums(x, self.training, self.guard, level, total, squares)
            mean = total / n
            with np.errstate(invalid="ignore", divide="ignore"):
                if self.clutter == "exponential":
                    ratio = np.where(mean > 0, x / mean, np.nan)
                else:
                    variance = (squares - n * mean * mean) / (n - 1)
                    flat = variance <= 1e-12 * squares / n
                    ratio = (x - level - mean) / np.sqrt(np.where(flat, np.nan, variance) * (1 + 1 / n))
            out[k] = _equivalent(ratio, nodes)
        return out


@njit
def _ring_quantile(frame: np.ndarray, training: int, guard: int, rank: int, out: np.ndarray) -> None:
    """The value of the given rank (1 is the smallest) in the ring of every pixel; NaN near the border and where one is missing."""
    rows, columns = frame.shape
    ring = np.empty((2 * training + 1) ** 2 - (2 * guard + 1) ** 2, frame.dtype)
    for i in range(training, rows - training):
        for j in range(training, columns - training):
            n = 0
            missing = False
            for r in range(i - training, i + training + 1):
                for c in range(j - training, j + training + 1):
                    if abs(r - i) <= guard and abs(c - j) <= guard:
                        continue
                    value = frame[r, c]
                    missing = missing or np.isnan(value)
                    ring[n] = value
                    n += 1
            if missing:
                continue
            # Selection in place (Hoare): the part that holds the rank gets smaller until it is one value.
            low, high, k = 0, n - 1, rank - 1
            while low < high:
                pivot = ring[(low + high) // 2]
                a, b = low, high
                while a <= b:
                    while ring[a] < pivot:
                        a += 1
                    while ring[b] > pivot:
                        b -= 1
                    if a <= b:
                        ring[a], ring[b] = ring[b], ring[a]
                        a += 1
                        b -= 1
                if k <= b:
                    high = b
                elif k >= a:
                    low = a
                else:
                    break
            out[i, j] = ring[k]


@lru_cache(maxsize=16)
def _ordered_ratios(cells: int, rank: int) -> FloatArray:
    """Ratio T with tail Q(z) at the nodes of z: Rohling's product, inverted by Newton steps in log T."""
    from scipy.special import log_ndtr

    wanted = log_ndtr(-_NODES)
    left = cells - np.arange(rank, dtype=np.float64)[:, None]
    log_c = np.zeros(_NODES.size)
    for _ in range(200):
        c = np.exp(log_c)
        # log P = -sum log(1 + c / (n - i)), i = 0 ... k - 1: terms of one sign, where differences of log Gamma would cancel.
        step = (np.log1p(c / left).sum(0) + wanted) / (c / (left + c)).sum(0)
        log_c -= np.clip(step, -2.0, 2.0)
        if np.abs(step).max() < 1e-12:
            break
    return np.asarray(np.exp(log_c))


@dataclass(frozen=True)
class OrderedStatistic:
    """Ordered-statistic detector for exponential clutter: the pixel over the ``quantile`` of its ring, which bright neighbours do not lift.

        T = x / x_(k),  P(T > c) = n! Gamma(n - k + 1 + c) / ((n - k)! Gamma(n + 1 + c))

    with n training pixels and rank k = round(quantile n).

    Parameters
    ----------
    training, guard : int
        Half sides of the two squares [px], 0 <= guard < training.
    quantile : float
        Share of the ring below the value taken, between 0 and 1 [1].
    """

    training: int = 5
    guard: int = 2
    quantile: float = 0.75
    name: str = field(default="os-cfar", init=False)
    lead: int = field(default=0, init=False)
    calibrated: bool = field(default=True, init=False)

    def __post_init__(self) -> None:
        _check(self.training, self.guard)
        if not 0 < self.quantile < 1:
            raise DomainError(f"quantile = {self.quantile:g} is not between 0 and 1; choose e.g. 0.75")

    def __call__(self, frames: Frames) -> Frames:
        """Equivalent standard deviations, -8 to :data:`HIGHEST`, shape (k, rows, columns) [1]; NaN where the quantile is not above 0."""
        n = _cells(self.training, self.guard)
        rank = min(max(round(self.quantile * n), 1), n)
        nodes = _ordered_ratios(n, rank)
        out = np.empty_like(frames, np.float32)
        for k, frame in enumerate(frames):
            x = np.ascontiguousarray(frame, np.float32)
            level = np.full(x.shape, np.nan, np.float32)
            _ring_quantile(x, self.training, self.guard, rank, level)
            with np.errstate(invalid="ignore", divide="ignore"):
                ratio = np.where(level > 0, x.astype(np.float64) / level, np.nan)
            out[k] = _equivalent(ratio, nodes)
        return out
