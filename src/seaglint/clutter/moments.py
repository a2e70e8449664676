"""Mean, standard deviation, skewness and excess kurtosis, accumulated block by block and merged in any order.

Central sums of two sets are merged by the update of Chan et al. (1983) for the variance and of Pebay (Sandia report
SAND2008-6212, Eqs. 2.1-2.9) for the third and fourth, which lose no digits to a large mean. Order and size of the blocks change the
result by rounding only (1e-12 relative).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError
from seaglint.base.jit import in_threads, njit

Sums = tuple[float, float, float, float, float]

# A spread of rounding size makes third and fourth moments pure noise: float32 data have 6e-8 of their mean.
LEAST_RELATIVE_SPREAD = 1e-12


@dataclass(frozen=True)
class Moments:
    """Moments of a set of values; add two to merge them."""

    count: int = 0  #: Values that are not NaN.
    mean: float = np.nan  #: Arithmetic mean, unit of the data; NaN for an empty set.
    sum2: float = 0.0  #: ``sum (x - mean)^2``.
    sum3: float = 0.0  #: ``sum (x - mean)^3``.
    sum4: float = 0.0  #: ``sum (x - mean)^4``.
    minimum: float = np.inf  #: Smallest value; inf for an empty set.
    maximum: float = -np.inf  #: Largest value; -inf for an empty set.

    @property
    def variance(self) -> float:
        """Population variance, ``sum2 / count``."""
        return self.sum2 / self.count if self.count else np.nan

    @property
    def std(self) -> float:
        """Standard deviation, root of :attr:`variance` [unit of the data]."""
        return float(np.sqrt(self.variance))

    @property
    def is_constant(self) -> bool:
        """True if all values are equal, to rounding."""
        return self.count > 0 and not self.std > LEAST_RELATIVE_SPREAD * abs(self.mean)

    @property
    def skewness(self) -> float:
        """Skewness ``m3 / m2^(3/2)`` [1]; NaN for a constant."""
        return np.nan if not self.count or self.is_constant else self.sum3 / self.count / self.variance**1.5

    @property
    def excess_kurtosis(self) -> float:
        """Excess kurtosis ``m4 / m2^2 - 3`` [1], 0 for a Gaussian; NaN for a constant."""
        return np.nan if not self.count or self.is_constant else self.sum4 / self.count / self.variance**2 - 3.0

    @classmethod
    def of(cls, values: ArrayLike) -> Moments:
        """Moments of an array of any shape without its NaN."""
        data = np.asarray(values).ravel()
        if data.dtype not in (np.float32, np.float64):
            data = data.astype(np.float64)
        return PixelMoments.of(data.reshape(-1, 1, 1)).region()

    def __add__(self, other: Moments) -> Moments:
        """Moments of both sets together."""
        if other.count == 0:
            return self
        if self.count == 0:
            return other
        count, mean, sum2, sum3, sum4 = _merged(
            (float(self.count), self.mean, self.sum2, self.sum3, self.sum4),
            (float(other.count), other.mean, other.sum2, other.sum3, other.sum4),
        )
        low, high = min(self.minimum, other.minimum), max(self.maximum, other.maximum)
        return Moments(round(count), mean, sum2, sum3, sum4, low, high)


@dataclass(frozen=True)
class PixelMoments:
    """Moments in time of every pixel: one pass over a recording gives the moments of every region, selected later."""

    count: NDArray[np.int64]  #: Number of values of each pixel, (rows, columns).
    mean: FloatArray  #: Mean of each pixel, unit of the data (rows, columns); 0 where ``count`` is 0.
    sum2: FloatArray  #: ``sum (x - mean)^2``, (rows, columns).
    sum3: FloatArray  #: ``sum (x - mean)^3``, (rows, columns).
    sum4: FloatArray  #: ``sum (x - mean)^4``, (rows, columns).
    minimum: FloatArray  #: Smallest value, (rows, columns); inf where ``count`` is 0.
    maximum: FloatArray  #: Largest value, (rows, columns); -inf where ``count`` is 0.

    @classmethod
    def empty(cls, rows: int, columns: int) -> PixelMoments:
        """Moments of an empty set of frames."""
        shape = (rows, columns)
        mean, sum2, sum3, sum4 = (np.zeros(shape) for _ in range(4))
        return cls(np.zeros(shape, np.int64), mean, sum2, sum3, sum4, np.full(shape, np.inf), np.full(shape, -np.inf))

    @classmethod
    def of(cls, frames: ArrayLike) -> PixelMoments:
        """Moments of one block of frames, shape (frames, rows, columns)."""
        data = np.asarray(frames)
        if data.ndim != 3:
            raise DataError(f"a block of frames has shape (frames, rows, columns), not {data.shape}")
        return cls.empty(data.shape[1], data.shape[2]).add(data)

    def add(self, frames: NDArray[np.floating]) -> PixelMoments:
        """Add further frames, shape (k, rows, columns), IN PLACE, and return the object; NaN and infinities are ignored.

        In place because seven maps per block would be most of the traffic. The kernel releases the interpreter.
        """
        if frames.ndim != 3 or frames.shape[1:] != self.mean.shape:
            raise DataError(f"block of shape {frames.shape} does not fit frames of {self.mean.shape}")
        arrays = np.ascontiguousarray(frames), self.count, self.mean, self.sum2, self.sum3, self.sum4, (self.minimum, self.maximum)
        in_threads(lambda part: _add_frames(*arrays, part), frames.shape[1])
        return self

    @property
    def std(self) -> FloatArray:
        """Standard deviation in time of each pixel, shape (rows, columns); NaN where a pixel has no value."""
        return np.where(self.count > 0, np.sqrt(self.sum2 / np.maximum(self.count, 1)), np.nan)

    @property
    def image(self) -> FloatArray:
        """Mean in time, shape (rows, columns); NaN where a pixel has no value."""
        return np.where(self.count > 0, self.mean, np.nan)

    def region(self, mask: NDArray[np.bool_] | None = None) -> Moments:
        """Moments over time and the pixels of a region, including the mean over time."""
        if mask is not None and mask.shape != self.mean.shape:
            raise DataError(f"mask of shape {mask.shape} does not fit frames of {self.mean.shape}; give one value per pixel")
        chosen = self.count > 0 if mask is None else (self.count > 0) & mask
        if not chosen.any():
            return Moments()
        n = self.count[chosen].astype(np.float64)
        total = n.sum()
        # Sums about the common mean directly: exact, and pairwise summation preserves the digits.
        mean = float(np.sum(n * self.mean[chosen]) / total)
        d, s2, s3, s4 = self.mean[chosen] - mean, self.sum2[chosen], self.sum3[chosen], self.sum4[chosen]
        return Moments(
            int(total),
            mean,
            float(np.sum(s2 + n * d**2)),
            float(np.sum(s3 + 3.0 * d * s2 + n * d**3)),
            float(np.sum(s4 + 4.0 * d * s3 + 6.0 * d**2 * s2 + n * d**4)),
            float(self.minimum[chosen].min()),
            float(self.maximum[chosen].max()),
        )


@njit
def _merged(a: Sums, b: Sums) -> Sums:
    """Count, mean and central sums of two sets together."""
    na, ma, a2, a3, a4 = a
    nb, mb, b2, b3, b4 = b
    n = na + nb
    d = mb - ma
    r = d / n
    sum3 = a3 + b3 + d * r * r * na * nb * (na - nb) + 3.0 * r * (na * b2 - nb * a2)
    product = na * na - na * nb + nb * nb
    sum4 = a4 + b4 + d * r * r * r * na * nb * product + 6.0 * r * r * (na * na * b2 + nb * nb * a2) + 4.0 * r * (na * b3 - nb * a3)
    return n, ma + r * nb, a2 + b2 + d * r * na * nb, sum3, sum4


@njit
def _add_frames(
    frames: NDArray[np.floating],
    count: NDArray[np.int64],
    mean: FloatArray,
    sum2: FloatArray,
    sum3: FloatArray,
    sum4: FloatArray,
    extremes: tuple[FloatArray, FloatArray],
    part: tuple[int, int],
) -> None:
    """Merge rows ``part = (first, end)`` of a block, row by row: the six sums of a row stay in the processor's cache."""
    low, high = extremes
    k, _, columns = frames.shape
    sums = np.empty((6, columns))
    shift, number, p1, p2, p3, p4 = sums[0], sums[1], sums[2], sums[3], sums[4], sums[5]
    for row in range(part[0], part[1]):
        # Power sums about the pixel's first good value, which is as good as its mean for the digits of a block.
        sums[:] = 0.0
        for frame in range(k):
            for column in range(columns):
                x = float(frames[frame, row, column])
                if not np.isfinite(x):
                    continue
                if number[column] == 0.0:
                    shift[column] = mean[row, column] if count[row, column] > 0 else x
                d = x - shift[column]
                q = d * d
                number[column] += 1.0
                p1[column] += d
                p2[column] += q
                p3[column] += q * d
                p4[column] += q * q
                if x < low[row, column]:
                    low[row, column] = x
                if x > high[row, column]:
                    high[row, column] = x
        for column in range(columns):
            n = number[column]
            if n == 0.0:
                continue
            # Central sums from power sums; rounding may leave the even ones slightly below 0.
            m = p1[column] / n
            b2 = max(p2[column] - n * m * m, 0.0)
            b3 = p3[column] - 3.0 * m * p2[column] + 2.0 * n * m * m * m
            b4 = max(p4[column] - 4.0 * m * p3[column] + 6.0 * m * m * p2[column] - 3.0 * n * m * m * m * m, 0.0)
            block = (n, shift[column] + m, b2, b3, b4)
            if count[row, column] > 0:
                before = (float(count[row, column]), mean[row, column], sum2[row, column], sum3[row, column], sum4[row, column])
                block = _merged(before, block)
            count[row, column] = int(block[0])
            mean[row, column] = block[1]
            sum2[row, column] = block[2]
            sum3[row, column] = block[3]
            sum4[row, column] = block[4]
