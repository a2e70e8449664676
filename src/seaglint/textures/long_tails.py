"""Long tails of filtered pictures: the part that the marginal transform does not reproduce, and the slow field that does.

False alarms are counted in the Laplacian of a picture, and its tails have two sources. Pixels whose own values have a long tail, sparse
glints on a dark sea, keep it when they are filtered: the marginal transform suffices. In a bright corridor pixels are spread evenly, and
yet the Laplacian has a long tail, as rough and calm patches alternate: there the product with a slow field is needed. Its shape and lengths
are those with which a sample has the exceedances of the data at 2.5, 3 and 3.5 standard deviations, and the same clustering of them.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from seaglint.base.conventions import FloatArray
from seaglint.clutter.filters import Laplacian
from seaglint.clutter.thresholds import standardise
from seaglint.textures.gauss_markov import GaussMarkov
from seaglint.textures.marginals import Marginal
from seaglint.textures.synthesis import Modulation, density_of, filtered, latent, rough

THRESHOLDS: Final = (2.5, 3.0, 3.5)  #: Thresholds at which rates are matched [standard deviations of the filtered picture].

NEAR: Final = math.log(1.15)  #: Root mean square of the log ratios of rates below which no correction is needed.

SHAPES: Final = tuple(np.geomspace(0.12, 12.0, 15))  #: Candidate shapes of the slow field; above the last one it has almost no effect.

STRETCHES: Final = (0.5, 1.0, 2.0)  #: Candidate lengths, in times those at which the squares of the filtered data decorrelate.

PILOT: Final = 600_000  #: Number of pixels of the samples that are compared with the data.


@dataclass(frozen=True)
class Tail:
    """Tail rates and length of the filtered picture that are matched."""

    rates: FloatArray  #: Share of the pixels above each of ``THRESHOLDS`` [1, (3,)].
    counts: FloatArray  #: Pixels above. Shape (3,).
    #: Correlation of the filtered picture's absolute values at distances of 3 to 8 pixels, mean of rows and columns [1].
    clusters: FloatArray
    lengths: tuple[float, float, float]  #: Distances at which it falls to 1/e of its value next door [frames, rows, columns].


def interior(frames: ArrayLike) -> NDArray[np.float32]:
    """Return the Laplacian of the pixels away from the border, in standard deviations of their frame, (frames, rows - 2, columns - 2).

    A pixel is NaN if one of the five pixels of the filter is.
    """
    out = Laplacian().apply(np.asarray(frames, np.float32))[:, 1:-1, 1:-1]
    return standardise(out, np.ones(out.shape[1:], np.bool_))


def tail(frames: ArrayLike) -> Tail:
    """Measure the tail of a picture or sequence, shape (frames, rows, columns) [u]; pixels that are NaN do not count."""
    z = interior(frames)
    valid = np.isfinite(z)
    gaps = not valid.all() and bool(np.isnan(frames).any())
    number = int(np.count_nonzero(valid)) if gaps else z.size
    counts = np.array([np.count_nonzero(z > m) for m in THRESHOLDS], float)
    strength = np.abs(np.nan_to_num(z)).astype(np.float64)
    if gaps:
        strength = np.where(valid, strength - float(strength.sum()) / max(number, 1), 0.0)
    else:
        strength -= strength.mean()
    # Without a value a pixel has no strength: products are averaged over the pairs of which both have one.
    share = max(number / valid.size, 1e-300)
    variance = max(float(np.mean(strength**2)) / share, 1e-300)

    def along(axis: int, longest: int) -> FloatArray:
        lags = range(1, min(longest, strength.shape[axis] - 1) + 1)
        moved = np.moveaxis(strength, axis, 0)
        if gaps:
            exist = np.moveaxis(valid, axis, 0)
            pairs = [max(int(np.count_nonzero(exist[lag:] & exist[:-lag])), 1) for lag in lags]
            return np.array([float(np.sum(moved[lag:] * moved[:-lag])) / n / variance for lag, n in zip(lags, pairs, strict=True)])
        return np.array([float(np.mean(moved[lag:] * moved[:-lag])) / variance for lag in lags])

    lines = [along(axis, 16) for axis in (0, 1, 2)]
    lengths = [_length(line) for line in lines]
    wide = [np.pad(line[2:8], (0, max(6 - line[2:8].size, 0))) for line in lines[1:]]
    return Tail(counts / max(number, 1), counts, 0.5 * (wide[0] + wide[1]), (lengths[0], lengths[1], lengths[2]))


def _length(line: FloatArray) -> float:
    """Distance at which correlations fall below 1/e of the first, 1 to 16 px."""
    if line.size < 2 or line[0] <= 0.0:
        return 1.0
    below = np.flatnonzero(line < line[0] / math.e)
    return float(below[0] + 1) if below.size else float(line.size)


def misfit(sample: Tail, data: Tail) -> FloatArray:
    """Return the logarithm of the ratios of rates at the thresholds, sample over data [1]; a fraction of a pixel replaces 0."""
    return np.asarray(
        np.log(np.maximum(sample.rates, 0.3 / PILOT) / np.maximum(data.rates, 0.5 * data.rates[0] / max(data.counts[0], 1.0) + 1e-12))
    )


def find_modulation(data: ArrayLike, model: GaussMarkov, marginal: Marginal, seed: int = 0) -> tuple[Modulation | None, FloatArray]:
    """Search the slow field with which filtered samples have the tails of the data.

    Parameters
    ----------
    data : array_like, shape (frames, rows, columns)
        [u].
    model, marginal : GaussMarkov, Marginal
        Model and marginal of the texture, already fitted.
    seed : int
        Seed of the samples.

    Returns
    -------
    modulation : Modulation or None
        None where the marginal transform alone is as near, or nearer.
    misfit : ndarray, shape (3,)
        Remaining log ratios of the rates at ``THRESHOLDS``.
    """
    target = tail(data)
    shape = pilot_shape(model, np.shape(data)[0])
    # Rates of few exceedances scatter more and count less.
    weights = np.sqrt(np.maximum(target.counts, 1.0))
    plain = misfit(tail(marginal.transform(latent(model, shape, seed))), target)

    def cost(left: FloatArray) -> float:
        return float(np.average(left**2, weights=weights))

    # Too many exceedances already: a product would add to them.
    if cost(plain) < NEAR**2 or float(np.average(plain, weights=weights)) > 0.0:
        return None, plain
    density = density_of(model, shape)
    best: tuple[float, Modulation | None, FloatArray] = (cost(plain), None, plain)
    for stretch in STRETCHES:
        lengths = tuple(max(stretch * length, 0.5) for length in target.lengths)
        for nu in SHAPES:
            tried = Modulation(float(nu), lengths)  # type: ignore[arg-type]
            noise = filtered(rough(tried, shape, seed), density)
            noise /= noise.std()
            sampled = tail(marginal.transform(noise))
            left = misfit(sampled, target)
            # Tails first; of two lengths with the same tails, the one whose exceedances cluster like the data's.
            total = cost(left) + 0.25 * float(np.mean((sampled.clusters - target.clusters) ** 2))
            if total < best[0]:
                best = (total, tried, left)
    return best[1], best[2]


def pilot_shape(model: GaussMarkov, frames: int) -> Sequence[int]:
    """Torus of the samples that are compared with the data (frames, rows, columns)."""
    deep = 1 if frames == 1 and model.reach[0] == 0 else max(2 * model.reach[0] + 1, 12)
    side = int(math.sqrt(PILOT / deep) / 16) * 16
    return deep, max(side, 2 * max(model.reach) + 1), max(side, 2 * max(model.reach) + 1)
