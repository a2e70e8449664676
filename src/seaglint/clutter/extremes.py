"""Tail beyond the data: peaks over a threshold, generalised Pareto fit, rates below one per data set and their reliability.

Above a threshold u the rate of exceeding pixels is taken to fall as

    rate(m) = rate(u) (1 + xi (m - u) / beta)^(-1 / xi)

with xi and beta fitted to all exceedances of u. A fit to the peaks of events alone would describe another quantity, the rate of events, and
would be biased where chance joins events. The uncertainty takes the clustering into account: every event, connected in space and time
(:mod:`seaglint.clutter.exceedances`), counts as one observation.

References
----------
Pickands 1975, Ann. Stat. 3, 119; Smith 1985, Biometrika 72, 67 (variance of the estimates); Grimshaw 1993, Technometrics 35, 185
(likelihood in one variable); Fawcett and Walshaw 2007, Environmetrics 18, 173 (all exceedances rather than peaks).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError
from seaglint.base.free_form import JsonObject, plain
from seaglint.base.random import stream
from seaglint.clutter.exceedances import Events
from seaglint.clutter.false_alarms import BIN, RateCurve

FEWEST_EVENTS: Final = 40  #: Least number of events above u for fitting a tail: with 40 the shape is known to about 0.2.

TRUSTED_SPAN: Final = 10.0  #: Largest ratio of the ends of the 95 % interval at which an extrapolated rate is trusted.

#: Number of data sets of which an extrapolated rate has at least one exceedance to be trusted; the data do not determine a rarer tail.
TRUSTED_SETS: Final = 10.0

_DRAWS = 1000  #: Number of draws behind the intervals.
_TEST_SIZE = 300  # from about 100 on, the null distribution of the distance no longer depends on the number of values
_HOPELESS, _HEAVY = 20.0, 0.5  # of 1500 draws of 300, the largest distance is 2 to 5 for shapes up to 0.3: no need to fit draws to reject


@dataclass(frozen=True)
class ParetoFit:
    """Generalised Pareto distribution of excesses over a threshold."""

    shape: float  #: xi [1]; 0 is an exponential tail, above 0 a power law, below 0 a tail that ends at ``-scale / shape``.
    scale: float  #: beta [unit of the excesses].
    log_likelihood: float  #: At the maximum [1].

    def survival(self, excess: ArrayLike) -> FloatArray:
        """Probability P(X > excess) [1]."""
        y = np.maximum(np.asarray(excess, np.float64), 0.0) / self.scale
        if abs(self.shape) < 1e-9:
            return np.asarray(np.exp(-y))
        inside = np.maximum(1.0 + self.shape * y, 0.0)
        with np.errstate(divide="ignore"):
            return np.asarray(np.exp(-np.log(inside) / self.shape) if self.shape > 0 else inside ** (-1.0 / self.shape))


def fit_pareto(excess: ArrayLike, number: ArrayLike | None = None) -> ParetoFit:
    """Fit a generalised Pareto distribution by maximum likelihood; the shape is restricted to above -0.5, where estimates are regular.

    With theta = xi / beta the likelihood has one variable left: xi(theta) = mean(log(1 + theta y)).

    Parameters
    ----------
    excess : array_like
        Excesses over the threshold, at least 10, above 0 [any].
    number : array_like, optional
        Number of occurrences of each [1].

    Returns
    -------
    ParetoFit
        Shape [1] and scale [unit of the excesses] at the maximum.

    Raises
    ------
    DomainError
        Too few values, or values not above 0.
    """
    y = np.asarray(excess, np.float64)
    if y.size < 10 or not (y > 0).all() or not np.isfinite(y).all():
        raise DomainError(f"{y.size} excesses: give at least 10, all finite and above 0")
    share = np.full(y.size, 1.0) if number is None else np.asarray(number, np.float64)
    total = float(share.sum())
    share = share / total
    mean = float(share @ y)
    y = y / mean

    # theta > -1 / max(y); a grid in a variable that is dense towards both ends, then golden section around its best point.
    most = float(y.max())

    def profile(theta: float) -> float:
        if abs(theta) < 1e-8:
            return -1.0
        xi = float(share @ np.log1p(theta * y))
        if xi / theta <= 0 or xi < -0.5:
            return -math.inf
        return -math.log(xi / theta) - xi - 1.0

    grid = np.concatenate([(-1.0 + np.geomspace(1e-4, 0.99, 30)) / most, np.geomspace(1e-3, 50.0, 50)])
    # All points at once, for the many fits of a bootstrap; for samples of millions the matrix would be too large.
    if y.size <= 10_000:
        xis = np.log1p(grid[:, None] * y) @ share
        with np.errstate(divide="ignore", invalid="ignore"):
            likelihoods = np.where((xis / grid > 0) & (xis >= -0.5), -np.log(xis / grid) - xis - 1.0, -np.inf)
        values = [float(v) for v in likelihoods]
    else:
        values = [profile(t) for t in grid]
    best = int(np.argmax(values))
    low, high = float(grid[max(best - 1, 0)]), float(grid[min(best + 1, grid.size - 1)])
    ratio = (math.sqrt(5) - 1) / 2
    a, b = high - ratio * (high - low), low + ratio * (high - low)
    fa, fb = profile(a), profile(b)
    for _ in range(30):
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
    xi = 0.0 if abs(theta) < 1e-8 else float(share @ np.log1p(theta * y))
    return ParetoFit(xi, (1.0 if xi == 0.0 else xi / theta) * mean, total * (profile(theta) - math.log(mean)))


def _anderson_darling(excess: FloatArray, fit: ParetoFit) -> float:
    u = np.clip(1.0 - fit.survival(np.sort(excess)), 1e-12, 1 - 1e-12)
    n = u.size
    return float(-n - ((2 * np.arange(1, n + 1) - 1) * (np.log(u) + np.log1p(-u[::-1]))).sum() / n)


def _draw(fit: ParetoFit, n: int, generator: np.random.Generator) -> FloatArray:
    e = generator.standard_exponential(n)
    y = e if abs(fit.shape) < 1e-9 else np.expm1(fit.shape * e) / fit.shape
    return np.asarray(np.maximum(fit.scale * y, 1e-12 * fit.scale))


@dataclass(frozen=True)
class TailFit:
    """Extrapolated rate-threshold relation of one region and filter."""

    threshold: float  #: u, lower end of the described tail [standard deviations].
    events: int  #: Number of events above u, taken as independent observations.
    rate: float  #: Exceeding pixels per pixel and frame at u [1].
    fit: ParetoFit  #: Distribution of the pixels' excess over u.
    shape_interval: tuple[float, float]  #: 95 % interval of the shape [1].
    #: Significance of the Anderson-Darling distance between data and fit, from 99 draws from the fit that are fitted anew [1].
    goodness_p: float
    #: Threshold [standard deviations] up to which the 95 % interval of the rate spans less than a factor of ``TRUSTED_SPAN`` and one
    #: exceedance in ``TRUSTED_SETS`` data sets is not undercut; given that the form of the tail holds.
    trusted_to_sigma: float
    trusted_to_rate: float  #: Rate at that threshold [1].
    _draws: tuple[FloatArray, FloatArray, FloatArray]

    def as_dict(self) -> JsonObject:
        """Return plain numbers; ``reason``, the reason for the absence of a fit, is None."""
        values = {
            "from_sigma": self.threshold,
            "events": self.events,
            "shape": self.fit.shape,
            "shape_interval": self.shape_interval,
            "scale_sigma": self.fit.scale,
            "goodness_p": self.goodness_p,
            "trusted_to_sigma": self.trusted_to_sigma,
            "trusted_to_rate": self.trusted_to_rate,
            "reason": None,
        }
        return plain(values)

    def rates(self, threshold_sigma: ArrayLike) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Extrapolated rate and its 95 % interval [1], at thresholds of u or more [standard deviations].

        Raises
        ------
        DomainError
            A threshold below u, where the measured rate is to be used.
        """
        m = np.atleast_1d(np.asarray(threshold_sigma, np.float64))
        if (m < self.threshold).any():
            raise DomainError(f"threshold {m.min():g} is below u = {self.threshold:g}; take the measured rate there")
        rate = self.rate * self.fit.survival(m - self.threshold)
        rates, shapes, scales = self._draws
        inside = np.maximum(1.0 + (shapes / scales)[:, None] * (m - self.threshold), 0.0)
        with np.errstate(divide="ignore"):
            drawn = rates[:, None] * np.exp(-np.log(inside) / np.abs(shapes)[:, None] * np.sign(shapes)[:, None])
        low, high = np.quantile(drawn, [0.025, 0.975], axis=0)
        return rate, low, high

    def threshold_for(self, rate: float) -> float | None:
        """Threshold at which the extrapolated rate is ``rate`` [standard deviations]; None above the rate at u."""
        if not 0 < rate <= self.rate:
            return None
        x = math.log(self.rate / rate)
        y = x if abs(self.fit.shape) < 1e-9 else math.expm1(self.fit.shape * x) / self.fit.shape
        return self.threshold + self.fit.scale * y


def fit_tail(curve: RateCurve, events: Events, *, seed: int = 0) -> tuple[TailFit | None, str | None]:
    """Fit a generalised Pareto tail to a rate curve.

    u is the lowest of ten thresholds (quantiles 0, 10, ... 90 % of the events' peaks) above which the Anderson-Darling test does not reject
    the fit at 10 %, with at least ``FEWEST_EVENTS`` events above it. Intervals follow from maximum likelihood for as many observations
    as there are events above u; a sea with a brightness that changes over the record has wider ones.

    Parameters
    ----------
    curve, events : RateCurve, Events
        Rate curve and events of one accumulator (:class:`seaglint.clutter.false_alarms.FalseAlarms`).
        Their threshold is low enough to leave some events to fit, for instance 3 standard deviations.
    seed : int
        Seed of the draws for test and intervals.

    Returns
    -------
    TailFit or None, str or None
        The tail, or None with the reason.
    """
    peaks = np.sort(events.peak)
    if peaks.size < FEWEST_EVENTS:
        return None, f"{peaks.size} events above {events.threshold:g} sigma; a tail needs at least {FEWEST_EVENTS}"
    generator = stream(seed, "generalised pareto")
    counts = -np.diff(curve.exceedances)
    centres = (curve.threshold[1:] + curve.threshold[:-1]) / 2
    for quantile in np.arange(10) / 10:
        lowest = events.threshold if quantile == 0 else float(np.quantile(peaks, quantile))
        edge = int(np.searchsorted(curve.threshold, lowest - 1e-6))
        u = float(curve.threshold[min(edge, curve.threshold.size - 1)])
        number = int((peaks > u).sum())
        if number < FEWEST_EVENTS:
            break
        n = counts[edge:]
        excess, n = (centres[edge:] - u)[n > 0], n[n > 0]
        # Steps of the data as wide as a tenth of the tail leave empty bins between them; the fit would describe the steps.
        if excess.size < 20:
            filled_share = excess.size / max(round(float(excess[-1] - excess[0]) / BIN) + 1, 1)
            why = (
                f"take {excess.size} different values only (saturated or coarse steps)" if excess.size < 3 or filled_share < 0.5
                else f"end within {excess.size * BIN:.2g} sigma: the tail is too short to be continued"
            )  # fmt: skip
            return None, f"exceedances of {u:.2f} sigma {why}; no tail is fitted"
        fit = fit_pareto(excess, n)
        # As many values, evenly spread over the ranks, as there are observations; binned values are spread over their bin by the rank.
        size = min(number, _TEST_SIZE)
        ranks = (np.arange(number) + 0.5) / number
        cumulated = np.concatenate([[0.0], n.cumsum() / n.sum()])
        distance = _anderson_darling(np.interp(ranks, cumulated, np.concatenate([[excess[0] - BIN / 2], excess + BIN / 2])), fit)
        drawn = [_draw(fit, size, generator) for _ in range(99)]
        if distance > _HOPELESS and fit.shape < _HEAVY:
            continue
        p = (1 + sum(_anderson_darling(d, fit_pareto(d)) >= distance for d in drawn)) / 100
        if p >= 0.1:
            return with_limits(curve, edge, u, number, fit, p, float(excess.max()), generator), None
    return None, "no threshold leaves exceedances that follow a generalised Pareto distribution; only the measured curve is given"


def with_limits(
    curve: RateCurve, edge: int, u: float, number: int, fit: ParetoFit, p: float, reached: float, generator: np.random.Generator
) -> TailFit:
    """Return a fit with its precision by maximum likelihood.

    Parameters
    ----------
    curve : RateCurve
        Measured rates.
    edge, u : int, float
        Number of the threshold of the fit in the curve, and itself [standard deviations].
    number : int
        Events above it.
    fit, p : ParetoFit, float
        Distribution and its significance.
    reached : float
        Largest excess [standard deviations].
    generator : Generator
        Random generator of the draws behind the intervals.
    """
    # Smith 1985, for xi and log beta: [[(1 + xi)^2, -(1 + xi)], [-(1 + xi), 2 (1 + xi)]] / n; the number of events is Poisson.
    rate = float(curve.rate[edge])
    a = 1.0 + fit.shape
    root = np.linalg.cholesky(np.array([[a * a, -a], [-a, 2 * a]]) / number)
    normal = generator.standard_normal((_DRAWS, 3))
    shapes, scales = root @ normal[:, :2].T + np.array([[fit.shape], [math.log(fit.scale)]])
    rates = rate * np.exp(normal[:, 2] / math.sqrt(number))
    low, high = np.quantile(shapes, [0.025, 0.975])
    tail = TailFit(
        threshold=u,
        events=number,
        rate=rate,
        fit=fit,
        shape_interval=(float(low), float(high)),
        goodness_p=p,
        trusted_to_sigma=u,
        trusted_to_rate=rate,
        _draws=(rates, shapes, np.exp(scales)),
    )
    m = u + np.linspace(0.0, 10.0, 301) * reached
    value, least, most = tail.rates(m)
    wide = ~(most < TRUSTED_SPAN * least) | (value * curve.pixels < 1.0 / TRUSTED_SETS)
    last = max(int(np.argmax(wide)) - 1, 0) if wide.any() else m.size - 1
    return replace(tail, trusted_to_sigma=float(m[last]), trusted_to_rate=float(value[last]))
