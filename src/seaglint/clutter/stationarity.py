"""Test for equal mean and variance of clutter everywhere: neighbouring blocks must not be more similar than distant ones.

Blocks are so large, and so far apart, that under stationarity they are independent; their means and log variances are then
exchangeable, whatever the distribution and the correlation inside a block. Moran's I measures the likeness of neighbours,
and permutations of the blocks give its level exactly. Both tests together keep the level by Bonferroni's factor 2.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from seaglint.base import random
from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError
from seaglint.base.free_form import JsonObject, plain

METHOD = "likeness (Moran's I) of neighbouring independent blocks, permutation test of means and log variances"
FEWEST_BLOCKS = 12  #: Least number of blocks for a test.
SIDE_IN_LENGTHS = 4.0  #: Side of a block in correlation lengths.
GAP_IN_LENGTHS = 3.0  # an exponential correlation has fallen to 5 %, a Gaussian one to 1e-4
SMALLEST_SIDE = 8  #: Least side of a block [px].


@dataclass(frozen=True)
class Stationarity:
    """Local moments and the test of their equality."""

    stationary: bool | None  #: False if the hypothesis is rejected at 5 %; None if not decidable.
    p_mean: float  #: Level for the blocks' means by themselves [1]; NaN if not decidable.
    p_variance: float  #: Level for the blocks' variances by themselves [1]; NaN if not decidable.
    mean: FloatArray  #: Mean of the blocks, (blocks along y, blocks along x); NaN where less than half a block is in the region.
    variance: FloatArray  #: Variance of the blocks, as ``mean``.
    block: tuple[int, int]  #: Rows and columns of a block [px].
    reason: str = ""  #: Reason why it is not decidable; empty if it is.
    method: str = METHOD  #: One line for reports.

    def as_dict(self) -> JsonObject:
        """Return levels, size of a block, reason and method as plain numbers and text."""
        levels = {"p_mean": self.p_mean, "p_variance": self.p_variance, "block_px": self.block}
        return plain(levels | {"reason": self.reason or None, "method": self.method})


def stationarity(
    frames: ArrayLike, mask: NDArray[np.bool_] | None = None, *, length_x: float, length_y: float, permutations: int = 999, seed: int = 0
) -> Stationarity:
    """Test whether local means and variances are equal all over a region.

    Parameters
    ----------
    frames : array_like, shape (rows, columns) or (frames, rows, columns)
        NaN are left out; a block's moments are over its pixels and all frames.
    mask : ndarray of bool, shape (rows, columns), optional
        Pixels of the region.
    length_x, length_y : float
        Correlation lengths [px] (:func:`seaglint.clutter.correlation.spatial_correlation`); from data with a trend they come out too
        long and blocks too large, which costs power, not validity.
    permutations : int
        999 give levels down to 0.001.
    seed : int
        Seed of the permutations.

    Returns
    -------
    Stationarity
    """
    data = np.array(frames, dtype=np.float64, ndmin=3)
    if data.ndim != 3 or (mask is not None and mask.shape != data.shape[1:]):
        raise DataError(f"frames of shape {data.shape} with a mask of another; give (frames, rows, columns) and (rows, columns)")
    if mask is not None:
        data[:, ~mask] = np.nan
    nothing = np.full((0, 0), np.nan)
    if not (np.isfinite(length_x) and np.isfinite(length_y)):
        return Stationarity(None, np.nan, np.nan, nothing, nothing, (0, 0), "correlation lengths are not known")
    side = [max(int(np.ceil(SIDE_IN_LENGTHS * length)), SMALLEST_SIDE) for length in (length_y, length_x)]
    gap = [int(np.ceil(GAP_IN_LENGTHS * length)) for length in (length_y, length_x)]
    number = [max((data.shape[1 + i] + gap[i]) // (side[i] + gap[i]), 0) for i in range(2)]
    mean, variance = np.full(number, np.nan), np.full(number, np.nan)
    for row in range(number[0]):
        for column in range(number[1]):
            top, left = row * (side[0] + gap[0]), column * (side[1] + gap[1])
            block = data[:, top : top + side[0], left : left + side[1]]
            good = block[np.isfinite(block)]
            if 2 * good.size >= block.size and good.size:
                mean[row, column], variance[row, column] = good.mean(), good.var()
    used = np.isfinite(mean)
    size = (side[0], side[1])
    if used.sum() < FEWEST_BLOCKS:
        reason = f"room for {int(used.sum())} independent blocks of {side[0]} x {side[1]} px, at least {FEWEST_BLOCKS} are needed"
        return Stationarity(None, np.nan, np.nan, mean, variance, size, reason)
    if not np.all(variance[used] > 0.0):
        return Stationarity(None, np.nan, np.nan, mean, variance, size, "blocks without any variance: constant or saturated data")
    rng = random.stream(seed, "stationarity")
    p_mean = _level(mean, permutations, rng)
    p_variance = _level(np.log(variance), permutations, rng)
    # Bonferroni: each of the two tests at half of 5 %.
    return Stationarity(bool(min(p_mean, p_variance) > 0.025), p_mean, p_variance, mean, variance, size)


def _level(grid: FloatArray, permutations: int, rng: np.random.Generator) -> float:
    """Return the probability of neighbours as similar as these, or more, in a random order of the blocks."""
    used = np.isfinite(grid)
    index = np.full(grid.shape, -1)
    index[used] = np.arange(used.sum())
    pairs = np.concatenate(
        [np.stack([index[1:].ravel(), index[:-1].ravel()], axis=1), np.stack([index[:, 1:].ravel(), index[:, :-1].ravel()], axis=1)]
    )
    pairs = pairs[np.all(pairs >= 0, axis=1)]
    values = grid[used] - grid[used].mean()
    if not len(pairs) or not np.any(values):
        return 1.0
    observed = float(np.sum(values[pairs[:, 0]] * values[pairs[:, 1]]))
    shuffled = rng.permuted(np.broadcast_to(values, (permutations, values.size)), axis=1)
    null = np.sum(shuffled[:, pairs[:, 0]] * shuffled[:, pairs[:, 1]], axis=1)
    return float((1.0 + np.count_nonzero(null >= observed - 1e-12 * abs(observed))) / (permutations + 1.0))
