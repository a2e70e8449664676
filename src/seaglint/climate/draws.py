"""Sampling of the probability of glint: randomised quasi-Monte Carlo points, intervals from independent scramblings, and strata.

Strata divide the draws by month, hour, bearing and latitude, and by wind and Sun.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np
from scipy.special import expit, gammainccinv, gammaincinv
from scipy.stats import t as student

from seaglint.base.conventions import FloatArray
from seaglint.base.free_form import number
from seaglint.base.random import stream
from seaglint.climate.likelihood_summary import StratumChance

SCRAMBLINGS: Final = 16  #: Least number of independent scramblings: Student's factor is 2.13 then, against 1.96 for infinitely many.

LEVEL: Final = 0.95  #: Level of the intervals [1].
_FEW: Final = 10  #: Number of hits below which a count's own interval is included: means of so few are not normal.
_AGREE: Final = 1e-12  #: Half width of an interval, relative to the largest value, below which all scramblings agree.


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
        # A power of two: the numbers of points for which a Sobol sequence is even.
        points = 2 ** max(int(math.log2(max(samples // SCRAMBLINGS, 1))), 0)
        return cls(max(math.ceil(samples / points), SCRAMBLINGS), points)

    @property
    def total(self) -> int:
        """Total number of points."""
        return self.scramblings * self.points

    def uniform(self, dimensions: int, seed: int, *, plain: bool = False, purpose: str = "likelihood") -> FloatArray:
        """Scrambled Sobol points in the unit cube [(total, dimensions)], scrambling by scrambling; ``plain`` ones are random.

        Points of another ``purpose`` are independent.
        """
        rngs = [stream(seed, purpose, i) for i in range(self.scramblings)]
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


def estimate(
    values: FloatArray, plan: SamplingPlan, *, weight: FloatArray | None = None, most: float = 1.0, heaviest: float = 1.0
) -> Estimate:
    """Estimate the mean of draws and its interval.

    ``p = sum_i w_i x_i / sum_i w_i``, with ``p +- t s / sqrt(m)`` over m scramblings whose means deviate by s.

    The means of the scramblings are independent: Student's interval. Estimates of small chances scatter more to above than to below, as
    counts do; so the interval is taken on the scale of the logarithm of odds, ``log(p / (1 - p)) +- t s / (sqrt(m) p (1 - p))``.

    This needs hits, draws above 0, and misses, draws below the largest value. The effective number of hits,
    ``(sum_i w_i x_i)^2 / sum_i (w_i x_i)^2``, is their count where all are alike. With fewer than 10 the interval includes Student's and
    that of a count [1]_ [2]_ and extends 3 hits to each side at least; without any it extends to 3 draws (the rule of three). The same
    holds for misses, and where all scramblings agree.

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
    heaviest : float
        Largest ratio of the density of even draws to that of these [1]: unseen events can weigh as much.

    Returns
    -------
    Estimate
        Mean with its 95 % interval, in the units of the values.

    References
    ----------
    .. [1] F. Garwood, Fiducial limits for the Poisson distribution, Biometrika 28 (1936) 437.
    .. [2] M. P. Fay and E. J. Feuer, Confidence intervals for directly standardized rates: a method based on the gamma distribution,
       Stat. Med. 16 (1997) 791, Sec. 3: weighted counts.

    Examples
    --------
    >>> plan = SamplingPlan(16, 64)
    >>> estimate(np.zeros(plan.total), plan)
    Estimate(value=0.0, low=0.0, high=0.0029296875)
    """
    shape = (plan.scramblings, plan.points)
    each = values if weight is None else values * weight
    numerator = each.reshape(shape).sum(axis=1)
    denominator = np.full(plan.scramblings, float(plan.points)) if weight is None else weight.reshape(shape).sum(axis=1)
    total = float(denominator.sum())
    if total <= 0.0:
        return Estimate(math.nan, math.nan, math.nan)
    mean = float(numerator.sum()) / total
    # Residuals of a ratio estimate: the scatter of each scrambling about the common mean.
    scatter = (numerator - mean * denominator) * plan.scramblings / total
    half = float(student.ppf(0.5 + 0.5 * LEVEL, plan.scramblings - 1)) * float(np.std(scatter, ddof=1)) / math.sqrt(plan.scramblings)
    if not math.isfinite(most):
        return Estimate(mean, max(mean - half, 0.0), mean + half)
    missed = most - values if weight is None else (most - values) * weight
    hits, misses = _count(each, most * heaviest), _count(missed, most * heaviest)
    low, high = mean - half, mean + half
    if half > _AGREE * most and min(hits.number, misses.number) >= _FEW:
        odds, more = mean / (most - mean), half * most / (mean * (most - mean))
        low, high = (most * float(expit(math.log(odds) + side * more)) for side in (-1.0, 1.0))
    elif half <= _AGREE * most:
        # Without any scatter the 95 % limit of a rate is 3 over the number of draws.
        more = 3.0 * max(hits.size, misses.size) / total
        low, high = mean - more, mean + more
    for few, side in ((hits, 1.0), (misses, -1.0)):
        if few.number >= _FEW:
            continue
        rate, tail = few.number * few.size / total, 0.5 * (1.0 - LEVEL)
        # Exact interval of a Poisson count, by the incomplete gamma function.
        count = (float(gammaincinv(few.number, tail)), float(gammainccinv(few.number + 1.0, tail))) if few.number > 0.0 else (0.0, 3.0)
        ends = (
            min(count[0] * few.size / total, rate - 3.0 * few.size / total),
            max(count[1] * few.size / total, rate + 3.0 * few.size / total),
        )
        ends = ends if side > 0.0 else (most - ends[1], most - ends[0])
        low, high = min(low, ends[0]), max(high, ends[1])
    return Estimate(mean, max(low, 0.0), min(high, most))


class _Count(NamedTuple):
    number: float  #: Effective number of draws with an event [1].
    size: float  #: Value of each, weight included.


def _count(each: FloatArray, otherwise: float) -> _Count:
    """Count events by the values of all draws, weights included; ``otherwise`` is the size of an event that was not seen."""
    first, second = float(each.sum()), float(each @ each)
    return _Count(first**2 / second, second / first) if first > 0.0 and second > 0.0 else _Count(0.0, otherwise)


BEARINGS: Final = np.arange(0.0, 361.0, 30.0)  #: Edges of the classes of bearings [deg].
WINDS: Final = np.array([0.0, 2.0, 4.0, 6.0, 8.0, 10.0, 14.0, 20.0, np.inf])  #: Edges of the classes of wind speed [m/s].
SUNS: Final = np.array([-90.0, 0.0, 5.0, 10.0, 20.0, 30.0, 45.0, 60.0, 90.0])  #: Edges of the classes of the Sun's elevation [deg].
LATITUDES: Final = np.arange(-90.0, 91.0, 10.0)  #: Edges of the classes of latitude [deg].


def strata(
    values: FloatArray,
    plan: SamplingPlan,
    quantities: dict[str, tuple[FloatArray, FloatArray]],
    threshold: float,
    *,
    weight: FloatArray | None = None,
    heaviest: float = 1.0,
) -> list[StratumChance]:
    """Divide draws by each quantity: values of every draw [(total,)] and the edges of its classes; NaN is in no class.

    ``threshold`` is the threshold behind the values [W m-2 sr-1], ``weight`` the weight of each draw [(total,)], equal weights without it;
    ``heaviest`` as in :func:`estimate`.
    """
    result = []
    each = np.ones(values.size) if weight is None else weight
    whole, total = float(values @ each), float(each.sum())
    for name, (quantity, edges) in quantities.items():
        place = np.digitize(quantity, edges)
        for i in range(1, edges.size):
            inside = np.where(place == i, each, 0.0)
            count = float(inside.sum())
            if count == 0.0:
                continue
            chance = estimate(values, plan, weight=inside, heaviest=heaviest)
            stratum = StratumChance(
                threshold_w_m2_sr=threshold,
                by=name,
                low=float(edges[i - 1]),
                high=number(edges[i]),
                share=count / total,
                value=chance.value,
                interval_low=chance.low,
                interval_high=chance.high,
                contribution=float(values @ inside) / whole if whole > 0.0 else None,
            )
            result.append(stratum)
    return result
