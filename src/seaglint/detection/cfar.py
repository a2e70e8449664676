"""Constant-false-alarm detectors: comparison of each pixel with a ring of training pixels around it.

The ring is the square of side 2 ``training`` + 1 less the square of side 2 ``guard`` + 1, so that a target is not part of the background
with which it is compared. Both detectors give equivalent standard deviations: z with Q(z) equal to the exact probability that independent
clutter of the stated kind gives the observed ratio. Sea clutter is neither independent nor of that kind, as counts of false alarms show.
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

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError
from seaglint.base.jit import njit
from seaglint.detection.interface import GAUSSIAN_TAIL, Frames

Clutter = Literal["exponential", "gaussian"]

HIGHEST: Final = 37.0  #: Largest equivalent standard deviation; its tail, 1e-299, is near the least number there is.

_NODES: Final = np.linspace(-8.0, HIGHEST, 9001)


class RingDetector:
    """Members of both detectors, which use one frame and compare each pixel with its ring."""

    training: int
    guard: int
    clutter: Clutter

    lead: int = 0  #: Single frames are enough.
    calibrated: bool = True  #: The statistic is in equivalent standard deviations.
    linear: bool = False  #: The statistic is no sum over pixels.

    @property
    def reach(self) -> int:
        """Half side of the outer square [px]."""
        return self.training

    @property
    def null_law(self) -> str:
        """Exact distribution for independent clutter of its kind."""
        return f"{GAUSSIAN_TAIL}, independent {self.clutter} clutter"

    @property
    def cells(self) -> int:
        """Number of training pixels."""
        return (2 * self.training + 1) ** 2 - (2 * self.guard + 1) ** 2

    def __post_init__(self) -> None:
        if not 0 <= self.guard < self.training:
            raise DomainError(f"guard = {self.guard} px and training = {self.training} px: 0 <= guard < training is needed")


@njit
def _ring_sums(frame: np.ndarray, training: int, guard: int, level: float, total: np.ndarray, squares: np.ndarray) -> None:
    """Sum and sum of squares of (x - level) over the ring of every pixel, from running sums of columns; NaN near the border."""
    rows, columns = frame.shape
    for i in range(training, rows - training):
        # Column sums over the rows beside and above or below the guard: nothing is subtracted, so a value missing in the guard stays there.
        far1, far2, near1, near2 = np.zeros(columns), np.zeros(columns), np.zeros(columns), np.zeros(columns)
        for r in range(i - training, i + training + 1):
            # Rows of the guard count apart: their columns within the guard are left out below.
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

    # Logarithms of tails: the tail itself falls to 1e-299 at the last node.
    tail = log_ndtr(-_NODES)
    if clutter == "exponential":
        return np.asarray(cells * np.expm1(-tail / cells))
    # Student's quantiles from the smaller tail, for their precision.
    small = t.isf(np.exp(log_ndtr(-np.abs(_NODES))), cells - 1)
    return np.asarray(np.sign(_NODES) * small)


def _equivalent(ratio: FloatArray, nodes: FloatArray, z_nodes: FloatArray = _NODES) -> Frames:
    z = np.interp(ratio, nodes, z_nodes)
    return np.where(np.isnan(ratio), np.nan, z).astype(np.float32)


@dataclass(frozen=True)
class CellAveraging(RingDetector):
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

    def __call__(self, frames: Frames) -> Frames:
        """Equivalent standard deviations, -8 to ``HIGHEST``, shape (k, rows, columns) [1]; NaN for a ring without variation."""
        n = self.cells
        nodes = _averaging_ratios(self.clutter, n)
        out = np.empty_like(frames, np.float32)
        for k, frame in enumerate(frames):
            x = np.ascontiguousarray(frame, np.float64)
            finite = np.isfinite(x)
            # Sums about the frame's level: squares of large values would lose the digits of their differences.
            level = float(x[finite].mean()) if self.clutter == "gaussian" and finite.any() else 0.0
            total, squares = np.full(x.shape, np.nan), np.full(x.shape, np.nan)
            _ring_sums(x, self.training, self.guard, level, total, squares)
            mean = total / n
            with np.errstate(invalid="ignore", divide="ignore"):
                if self.clutter == "exponential":
                    ratio = np.where(mean > 0, x / mean, np.nan)
                else:
                    variance = (squares - n * mean * mean) / (n - 1)
                    # A ring of equal values leaves only rounding, some 1e-16 of the squares.
                    flat = variance <= 1e-12 * squares / n
                    ratio = (x - level - mean) / np.sqrt(np.where(flat, np.nan, variance) * (1 + 1 / n))
            out[k] = _equivalent(ratio, nodes)
        return out


@njit
def _select(ring: np.ndarray, low: int, high: int, k: int) -> float:
    """Return the value of rank k (0 is the smallest) of ``ring[low:high + 1]``, in place (Hoare): smaller ones come to lie before it."""
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
    return float(ring[k])


@njit
def _ring_quantiles(frame: np.ndarray, training: int, guard: int, ranks: tuple[int, int], lower: np.ndarray, upper: np.ndarray) -> None:
    """Values of two ranks (1 is the smallest), the first not above the second, in the ring of every pixel.

    NaN near the border and where one is missing.
    """
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
            # After the selection of the upper rank all smaller values lie before it: the lower rank is among them.
            upper[i, j] = _select(ring, 0, n - 1, ranks[1] - 1)
            lower[i, j] = upper[i, j] if ranks[0] == ranks[1] else _select(ring, 0, ranks[1] - 1, ranks[0] - 1)


@lru_cache(maxsize=16)
def _ordered_ratios(cells: int, rank: int) -> FloatArray:
    """Ratio T with tail Q(z) at the nodes of z: Rohling's product, inverted by Newton steps in log T."""
    from scipy.special import log_ndtr

    log_tail = log_ndtr(-_NODES)
    left = cells - np.arange(rank, dtype=np.float64)[:, None]
    log_c = np.zeros(_NODES.size)
    for _ in range(200):
        c = np.exp(log_c)
        # log P = -sum log(1 + c / (n - i)), i = 0 ... k - 1: terms of one sign, where differences of log Gamma would cancel.
        step = (np.log1p(c / left).sum(0) + log_tail) / (c / (left + c)).sum(0)
        # Bounded steps: far from the solution Newton would overshoot.
        log_c -= np.clip(step, -2.0, 2.0)
        if np.abs(step).max() < 1e-12:
            break
    return np.asarray(np.exp(log_c))


@lru_cache(maxsize=16)
def _symmetric_ratios(cells: int, rank: int) -> tuple[FloatArray, FloatArray]:
    """Ratios T of Gaussian clutter and the z with their tail Q(z), for the quantiles of ranks ``cells + 1 - rank`` and ``rank``.

    P(T > c) is Q((a + b) / 2 + c (b - a)) averaged over the joint density of the two quantiles a < b, by the trapezoidal rule on a grid of
    a fraction of their standard deviation, in logarithms. Beyond a ratio of 30 the ring's spread would have to be small by a chance that
    the grid does not resolve: there z ends.
    """
    from scipy.special import log_ndtr, logsumexp

    # Ranks as order statistics of n Gaussian values: their joint density is a product of powers of the distribution between and beyond.
    grid = np.linspace(-7.0, 7.0, 401)
    a, b = grid[:, None], grid[None, :]
    below, density = log_ndtr(grid), -0.5 * grid**2
    with np.errstate(divide="ignore", invalid="ignore"):
        between = below[None, :] + np.log1p(-np.exp(below[:, None] - below[None, :]))
    joint = (cells - rank) * (below[:, None] + log_ndtr(-grid)[None, :]) + density[:, None] + density[None, :]
    inner = 2 * rank - cells - 2  # values between the two
    joint = np.where(b > a, joint + (inner * between if inner else 0.0), -np.inf)
    joint -= logsumexp(joint)
    used = joint > -150.0
    middle, width, weight = ((a + b) / 2)[used], (b - a)[used], joint[used]
    ratio = np.concatenate([np.linspace(0.0, 4.0, 81), np.geomspace(4.2, 30.0, 40)])
    tail = np.array([logsumexp(weight + log_ndtr(-(middle + c * width))) for c in ratio])
    z = np.interp(tail, log_ndtr(-_NODES[::-1]), _NODES[::-1])
    z[0] = 0.0
    from scipy.interpolate import PchipInterpolator

    # Monotone interpolation keeps z rising with the ratio.
    fine = np.linspace(0.0, 30.0, 6001)
    fine_z = np.asarray(PchipInterpolator(ratio, z)(fine))
    # Odd about 0: the two ranks are mirror images.
    return np.concatenate([-fine[:0:-1], fine]), np.concatenate([-fine_z[:0:-1], fine_z])


@dataclass(frozen=True)
class OrderedStatistic(RingDetector):
    """Ordered-statistic detector: the pixel against quantiles of its ring, which are robust against bright neighbours.

        gaussian:     T = (x - (x_(l) + x_(k)) / 2) / (x_(k) - x_(l)),  l = n + 1 - k
        exponential:  T = x / x_(k),  P(T > c) = n! Gamma(n - k + 1 + c) / ((n - k)! Gamma(n + 1 + c))

    with n training pixels and rank k = round(quantile n). The first does not feel level and gain of the clutter; its tail on independent
    Gaussian values is an integral over the two quantiles' joint density. The second is for intensities of one look above a level of 0: any
    offset makes it deaf.

    Parameters
    ----------
    training, guard : int
        Half sides of the two squares [px], 0 <= guard < training.
    quantile : float
        Share of the ring below the value taken, between 0 and 1, for Gaussian clutter above 0.5 [1].
    clutter : {"gaussian", "exponential"}
        The clutter it is exact for.
    """

    training: int = 5
    guard: int = 2
    quantile: float = 0.75
    clutter: Clutter = "gaussian"

    def __post_init__(self) -> None:
        super().__post_init__()
        least = 0.5 if self.clutter == "gaussian" else 0.0
        if not least < self.quantile < 1:
            raise DomainError(f"quantile = {self.quantile:g} is not between {least:g} and 1; choose e.g. 0.75")

    @property
    def name(self) -> str:
        """Name in the results."""
        return "os-cfar" if self.clutter == "gaussian" else "os-cfar-exponential"

    def __call__(self, frames: Frames) -> Frames:
        """Equivalent standard deviations, shape (k, rows, columns) [1]: -8 to ``HIGHEST``, to some 13 for Gaussian clutter.

        NaN where the ring's quantiles are equal, or in the exponential case not above 0.
        """
        n = self.cells
        # A rank from 1 to n, whatever the rounding gives.
        rank = min(max(round(self.quantile * n), 1), n)
        gaussian = self.clutter == "gaussian"
        if gaussian:
            rank = max(rank, n // 2 + 1)  # rings have an even number of pixels
            ratios, z = _symmetric_ratios(n, rank)
        else:
            ratios, z = _ordered_ratios(n, rank), _NODES
        ranks = (n + 1 - rank, rank) if gaussian else (rank, rank)
        out = np.empty_like(frames, np.float32)
        for k, frame in enumerate(frames):
            x = np.ascontiguousarray(frame, np.float32)
            lower, upper = np.full(x.shape, np.nan, np.float32), np.full(x.shape, np.nan, np.float32)
            _ring_quantiles(x, self.training, self.guard, ranks, lower, upper)
            low, high = lower.astype(np.float64), upper.astype(np.float64)
            with np.errstate(invalid="ignore", divide="ignore"):
                if gaussian:
                    ratio = np.where(high > low, (x - 0.5 * (high + low)) / (high - low), np.nan)
                else:
                    ratio = np.where(high > 0, x / high, np.nan)
            out[k] = _equivalent(ratio, ratios, z)
        return out
