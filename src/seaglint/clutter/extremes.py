"""The tail beyond the data: peaks over a threshold, generalised Pareto fit, rates below one per data set and how far to trust them.

Peaks are those of declustered events (:mod:`seaglint.clutter.exceedances`), one per event, so that they are nearly independent. Above u

    P(peak > m | peak > u) = (1 + xi (m - u) / beta)^(-1 / xi)

and the rate of exceeding pixels is the measured rate at u times this: events are taken to keep the mean size they have at u.

References
----------
Pickands 1975, Ann. Stat. 3, 119; Grimshaw 1993, Technometrics 35, 185 (maximum likelihood in one variable); Choulakian and Stephens 2001,
Technometrics 43, 478 (goodness); Coles 2001, An Introduction to Statistical Modeling of Extreme Values, section 4.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from seaglint.clutter.exceedances import Events
from seaglint.clutter.false_alarms import RateCurve
from seaglint.errors import DomainError
from seaglint.random import stream

FloatArray = NDArray[np.float64]

FEWEST_PEAKS: Final = 40
"""Events above u below which no tail is fitted: with 40 the shape is known to about 0.2."""

TRUSTED_SPAN: Final = 10.0
"""An extrapolated rate is trusted as long as the ends of its 95 % interval are within this factor of each other."""

_DRAWS = 400


@dataclass(frozen=True)
class ParetoFit:
    """Generalised Pareto distribution of excesses over a threshold.

    Attributes
    ----------
    shape : float
        xi [1]; 0 is an exponential tail, above 0 a power law, below 0 a tail that ends at ``-scale / shape``.
    scale : float
        beta [unit of the excesses].
    log_likelihood : float
        At the maximum [1].
    """

    shape: float
    scale: float
    log_likelihood: float

    def survival(self, excess: ArrayLike) -> FloatArray:
        """P(X > excess) [1]."""
        y = np.maximum(np.asarray(excess, np.float64), 0.0) / self.scale
        if abs(self.shape) < 1e-9:
            return np.asarray(np.exp(-y))
        inside = np.maximum(1.0 + self.shape * y, 0.0)
        with np.errstate(divide="ignore"):
            return np.asarray(np.exp(-np.log(inside) / self.shape) if self.shape > 0 else inside ** (-1.0 / self.shape))


def fit_pareto(excess: ArrayLike) -> ParetoFit:
    """Maximum-likelihood generalised Pareto fit; the shape is kept above -0.5, where estimates are regular.

    With theta = xi / beta the likelihood has one variable left: xi(theta) = mean(log(1 + theta y)).

    Parameters
    ----------
    excess : array_like
        Excesses over the threshold, at least 10, above 0 [any].

    Raises
    ------
    DomainError
        Too few values, or values not above 0.
    """
    y = np.asarray(excess, np.float64)
    if y.size < 10 or not (y > 0).all() or not np.isfinite(y).all():
        raise DomainError(f"{y.size} excesses: give at least 10, all finite and above 0")
    mean = float(y.mean())
    y = y / mean

    # theta > -1 / max(y); a grid in a variable that is dense towards both ends, then golden section around its best point.
    most = float(y.max())

    def profile(theta: float) -> float:
        if abs(theta) < 1e-8:
            return -1.0
        xi = float(np.log1p(theta * y).mean())
        if xi / theta <= 0 or xi < -0.5:
            return -math.inf
        return -math.log(xi / theta) - xi - 1.0

    grid = np.concatenate([(-1.0 + np.geomspace(1e-4, 1.0, 30)) / most, np.geomspace(1e-3, 50.0, 50)])
    values = [profile(t) for t in grid]
    best = int(np.argmax(values))
    low, high = float(grid[max(best - 1, 0)]), float(grid[min(best + 1, grid.size - 1)])
    ratio = (math.sqrt(5) - 1) / 2
    a, b = high - ratio * (high - low), low + ratio * (high - low)
    fa, fb = profile(a), profile(b)
    for _ in range(40):
        if fa > fb:
            high, b, fb = b, a, fa
            a = high - ratio * (high - low)
            fa = profile(a)
        else:
            low, a, fa = a, b, fb
            b = low + ratio * (high - low)
            fb = profile(b)
    theta = (low + high) / 2
    if profile(theta) < values[best]:
        theta = float(grid[best])
    xi = 0.0 if abs(theta) < 1e-8 else float(np.log1p(theta * y).mean())
    scale = 1.0 if xi == 0.0 else xi / theta
    return ParetoFit(xi, scale * mean, y.size * (profile(theta) - math.log(mean)))


def _anderson_darling(excess: FloatArray, fit: ParetoFit) -> float:
    u = np.clip(1.0 - fit.survival(np.sort(excess)), 1e-12, 1 - 1e-12)
    n = u.size
    k = np.arange(1, n + 1)
    return float(-n - ((2 * k - 1) * (np.log(u) + np.log1p(-u[::-1]))).sum() / n)


def _draw(fit: ParetoFit, n: int, generator: np.random.Generator) -> FloatArray:
    e = generator.standard_exponential(n)
    y = e if abs(fit.shape) < 1e-9 else np.expm1(fit.shape * e) / fit.shape
    return np.asarray(np.maximum(fit.scale * y, 1e-12 * fit.scale))


@dataclass(frozen=True)
class TailFit:
    """Extrapolated rate-threshold relation of one region and filter.

    Attributes
    ----------
    threshold : float
        u, from which on the tail is described [standard deviations].
    peaks : int
        Events above u.
    rate : float
        Exceeding pixels per pixel and frame at u [1].
    fit : ParetoFit
        Distribution of the peaks' excess over u.
    shape_interval : (float, float)
        95 % interval of the shape [1].
    goodness_p : float
        Significance of the Anderson-Darling distance between peaks and fit, from a parametric bootstrap that fits anew [1].
    trusted_to_sigma, trusted_to_rate : float
        Threshold and rate up to which the 95 % interval of the rate spans less than a factor of :data:`TRUSTED_SPAN`.
    """

    threshold: float
    peaks: int
    rate: float
    fit: ParetoFit
    shape_interval: tuple[float, float]
    goodness_p: float
    trusted_to_sigma: float
    trusted_to_rate: float
    _draws: tuple[tuple[float, ParetoFit], ...]

    def rates(self, threshold_sigma: ArrayLike) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Extrapolated rate and the ends of its 95 % interval [1], at thresholds of u or more [standard deviations].

        Raises
        ------
        DomainError
            A threshold below u, where the data themselves speak.
        """
        m = np.atleast_1d(np.asarray(threshold_sigma, np.float64))
        if (m < self.threshold).any():
            raise DomainError(f"threshold {m.min():g} is below u = {self.threshold:g}; take the measured rate there")
        rate = self.rate * self.fit.survival(m - self.threshold)
        drawn = np.stack([r * f.survival(m - self.threshold) for r, f in self._draws])
        low, high = np.quantile(drawn, [0.025, 0.975], axis=0)
        return rate, low, high

    def threshold_for(self, rate: float) -> float | None:
        """Threshold at which the extrapolated rate is ``rate`` [standard deviations]; None above the rate at u."""
        if not 0 < rate <= self.rate:
            return None
        x = math.log(self.rate / rate)
        y = x if abs(self.fit.shape) < 1e-9 else math.expm1(self.fit.shape * x) / self.fit.shape
        return self.threshold + self.fit.scale * y


def fit_tail(events: Events, curve: RateCurve, *, seed: int = 0) -> tuple[TailFit | None, str | None]:
    """Generalised Pareto tail of the peaks of declustered events.

    u is the lowest of ten quantiles of the peaks (0, 10, ... 90 %) above which the Anderson-Darling test does not reject the fit at 10 %,
    with at least :data:`FEWEST_PEAKS` peaks above it. Intervals come from a parametric bootstrap of 400 draws, with a number of events that is
    Poisson; peaks are taken as independent, so a sea whose brightness changes over the record has wider ones.

    Parameters
    ----------
    events : Events
        Of a threshold low enough to leave events to fit, 3 standard deviations for instance.
    curve : RateCurve
        Of the same accumulator.
    seed : int
        Of the bootstrap.

    Returns
    -------
    TailFit or None, str or None
        The tail, or None and the reason.
    """
    peaks = np.sort(events.peak)
    if peaks.size < FEWEST_PEAKS:
        return None, f"{peaks.size} events above {events.threshold:g} sigma; a tail needs at least {FEWEST_PEAKS}"
    if np.unique(peaks).size < FEWEST_PEAKS // 2:
        return None, "peaks of events take too few different values (saturated or coarsely quantised); no tail is fitted"
    generator = stream(seed, "pareto bootstrap")
    for quantile in np.arange(10) / 10:
        start = int(quantile * peaks.size)
        u = events.threshold if start == 0 else float(peaks[start - 1])
        excess = peaks[peaks > u] - u
        if excess.size < FEWEST_PEAKS:
            break
        fit = fit_pareto(excess)
        distance = _anderson_darling(excess, fit)
        # Large samples are tested on a share of the bootstrap's cost; the distance's distribution no longer depends on n there.
        size = min(excess.size, 2000)
        drawn = [_draw(fit, size, generator) for _ in range(99)]
        p = (1 + sum(_anderson_darling(d, fit_pareto(d)) >= distance for d in drawn)) / 100
        if p >= 0.1:
            return _with_limits(curve, u, excess, fit, p, generator), None
    return None, "no threshold leaves peaks that follow a generalised Pareto distribution; the measured curve is all there is"


def _with_limits(curve: RateCurve, u: float, excess: FloatArray, fit: ParetoFit, p: float, generator: np.random.Generator) -> TailFit:
    rate = float(np.interp(u, curve.threshold, curve.rate))
    draws = []
    for _ in range(_DRAWS):
        number = max(int(generator.poisson(excess.size)), 10)
        draws.append((rate * number / excess.size, fit_pareto(_draw(fit, number, generator))))
    shapes = np.quantile([f.shape for _, f in draws], [0.025, 0.975])
    tail = TailFit(u, excess.size, rate, fit, (float(shapes[0]), float(shapes[1])), p, u, rate, tuple(draws))
    m = u + np.linspace(0.0, 20.0, 2001) * max(float(excess.max()), fit.scale)
    rates, low, high = tail.rates(m)
    wide = ~(high < TRUSTED_SPAN * low)
    last = max(int(np.argmax(wide)) - 1, 0) if wide.any() else m.size - 1
    return TailFit(u, excess.size, rate, fit, tail.shape_interval, p, float(m[last]), float(rates[last]), tuple(draws))
