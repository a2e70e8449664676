"""Randomised quasi-Monte Carlo points, and intervals from independent scramblings.

Strata of the probability of glint: by month, hour, bearing and latitude, and by the winds and Suns that bring it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy.special import gammainccinv, gammaincinv
from scipy.stats import t as student

from seaglint.base.conventions import FloatArray
from seaglint.base.random import stream

SCRAMBLINGS: Final = 16  #: Least number of independent scramblings: Student's factor is 2.13 then, against 1.96 for infinitely many.

LEVEL: Final = 0.95
_FEW: Final = 10  #: Number of hits below which a count's own interval is included: means of so few are not normal.


@dataclass(frozen=True)
class SamplingPlan:
    """Number of points: ``scramblings`` times ``points``, the latter a power of two.

    >>> SamplingPlan.of(100_000)
    SamplingPlan(scramblings=25, points=4096)
    """

    scramblings: int
    points: int

    @classmethod
    def of(cls, samples: int) -> SamplingPlan:
        """Plan of at least ``samples`` points, in 16 to 31 scramblings (32 where rounding requires it)."""
        points = 2 ** max(int(math.log2(max(samples // SCRAMBLINGS, 1))), 0)
        return cls(max(math.ceil(samples / points), SCRAMBLINGS), points)

    @property
    def total(self) -> int:
        """Total number of points."""
        return self.scramblings * self.points

    def uniform(self, dimensions: int, seed: int, *, plain: bool = False) -> FloatArray:
        """Scrambled Sobol points in the unit cube [(total, dimensions)], scrambling by scrambling; ``plain`` ones are random."""
        rngs = [stream(seed, "likelihood", i) for i in range(self.scramblings)]
        if plain:
            return np.concatenate([rng.random((self.points, dimensions)) for rng in rngs])
        from scipy.stats import qmc

        exponent = self.points.bit_length() - 1
        return np.concatenate([qmc.Sobol(dimensions, scramble=True, rng=rng).random_base2(exponent) for rng in rngs])


@dataclass(frozen=True)
class Estimate:
    """Mean and its 95 % interval."""

    value: float
    low: float
    high: float


def estimate(values: FloatArray, plan: SamplingPlan, *, weight: FloatArray | None = None, most: float = 1.0) -> Estimate:
    """Mean of draws and its interval.

    The means of the scramblings are independent: Student's interval. Where they hardly differ, or all of them agree, as for chances of 0
    and 1, the interval is at least 3 draws wide to each side (the rule of three); few hits have the interval of their count.

    Parameters
    ----------
    values : ndarray
        Values of every draw [(total,)], between 0 and ``most``.
    plan : SamplingPlan
        Scramblings and points.
    weight : ndarray, optional
        Weights of the draws [(total,)]: the ratio of the sums is estimated, with the scatter of its numerator about it.
    most : float
        Largest value possible; infinite for radiances.

    Examples
    --------
    >>> plan = SamplingPlan(16, 64)
    >>> estimate(np.zeros(plan.total), plan)
    Estimate(value=0.0, low=0.0, high=0.0029296875)
    """
    shape = (plan.scramblings, plan.points)
    numerator = values.reshape(shape).sum(axis=1) if weight is None else (values * weight).reshape(shape).sum(axis=1)
    denominator = np.full(plan.scramblings, float(plan.points)) if weight is None else weight.reshape(shape).sum(axis=1)
    total = float(denominator.sum())
    if total <= 0.0:
        return Estimate(math.nan, math.nan, math.nan)
    mean = float(numerator.sum()) / total
    scatter = (numerator - mean * denominator) * plan.scramblings / total
    half = float(student.ppf(0.5 + 0.5 * LEVEL, plan.scramblings - 1)) * float(np.std(scatter, ddof=1)) / math.sqrt(plan.scramblings)
    if not math.isfinite(most):
        return Estimate(mean, max(mean - half, 0.0), mean + half)
    half = max(half, 3.0 * most / total)
    low, high = mean - half, mean + half
    tail, hits, misses = 0.5 * (1.0 - LEVEL), float(numerator.sum()) / most, (most * total - float(numerator.sum())) / most
    if 0.0 < hits < _FEW:
        low, high = min(low, most * float(gammaincinv(hits, tail)) / total), max(high, most * float(gammainccinv(hits + 1.0, tail)) / total)
    if 0.0 < misses < _FEW:
        low = min(low, most - most * float(gammainccinv(misses + 1.0, tail)) / total)
        high = max(high, most - most * float(gammaincinv(misses, tail)) / total)
    return Estimate(mean, max(low, 0.0), min(high, most))


BEARINGS: Final = np.arange(0.0, 361.0, 30.0)
WINDS: Final = np.array([0.0, 2.0, 4.0, 6.0, 8.0, 10.0, 14.0, 20.0, np.inf])
SUNS: Final = np.array([-90.0, 0.0, 5.0, 10.0, 20.0, 30.0, 45.0, 60.0, 90.0])
LATITUDES: Final = np.arange(-90.0, 91.0, 10.0)


@dataclass(frozen=True)
class Stratum:
    """Stratum of draws between two values of a quantity."""

    by: str  #: Quantity, with its unit.
    #: ``low``, ``high``: Its range; the upper end is outside.
    low: float
    high: float
    share: float  #: Share of all draws [1].
    #: ``value``, ``interval_low``, ``interval_high``: Chance of glint among these draws, and its 95 % interval [1].
    value: float
    interval_low: float
    interval_high: float
    contribution: float  #: Share of all glint that these draws bring [1]; NaN without any.


def strata(
    values: FloatArray,
    plan: SamplingPlan,
    quantities: dict[str, tuple[FloatArray, FloatArray]],
    most: float = 1.0,
    *,
    weight: FloatArray | None = None,
) -> list[Stratum]:
    """Strata of draws by each quantity: values of every draw [(total,)] and the edges of its classes; NaN counts nowhere.

    ``weight`` is what each draw stands for [(total,)]; all the same where it is not given.
    """
    result = []
    each = np.ones(values.size) if weight is None else weight
    whole, total = float(values @ each), float(each.sum())
    for name, (what, edges) in quantities.items():
        place = np.digitize(what, edges)
        for i in range(1, edges.size):
            inside = np.where(place == i, each, 0.0)
            count = float(inside.sum())
            if count == 0.0:
                continue
            e = estimate(values, plan, weight=inside, most=most)
            part = float(values @ inside) / whole if whole > 0.0 else float("nan")
            result.append(Stratum(name, float(edges[i - 1]), float(edges[i]), count / total, e.value, e.low, e.high, part))
    return result
