"""Rare false alarms: rates below one in the data, from peaks over a threshold, and their reliability.

The fit is explained in :mod:`seaglint.clutter.extremes`: a generalised Pareto distribution of the excess of all exceeding pixels, whose
uncertainty follows from the number of declustered events. Tails of clutter approach that form slowly (a Gaussian's shape is still -0.08 at
three standard deviations), so that a fit to many exceedances is precise and wrong: no more than ``MOST_EVENTS`` events are fitted.
Intervals follow from the profile likelihood: far beyond the data a rate depends on the shape so strongly that intervals symmetric in the
shape are too short on the side of more alarms.

References
----------
Coles 2001, An Introduction to Statistical Modeling of Extreme Values, sec. 2.6.6 and 4.3 (profile likelihood), ch. 5 (extremal index).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Final, Protocol

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.clutter.exceedances import Events
from seaglint.clutter.extremes import TRUSTED_SETS, TRUSTED_SPAN, TailFit, fit_tail
from seaglint.clutter.false_alarms import RateCurve

LOWEST_THRESHOLD: Final = 3.0  #: Threshold above which the events of a tail begin [standard deviations].

#: Number of largest events that are fitted: with them rates of 1e-7 from a million values cover the truth of Gaussian and gamma clutter.
MOST_EVENTS: Final = 1500

#: Half width of the confidence region [standard errors].
#:
#: With 1.96 a rate of 1e-7 from a million values is inside in 278 of 300 samples, as the tail is not of the fit's form yet.
QUANTILE: Final = 2.1

_GRID = 121


RARE: Final = (1e-4, 1e-5, 1e-6, 1e-7, 1e-8)  #: Rates whose thresholds are reported [1].


@dataclass(frozen=True)
class RareRate:
    """Extrapolated rate of false alarms."""

    threshold_sigma: float  #: Threshold [standard deviations].
    rate: float  #: Rate per pixel [1].
    low: float  #: Lower end of its 95 % interval [1].
    high: float  #: Upper end of its 95 % interval [1].
    #: Whether the interval is narrower than a factor of ``seaglint.clutter.extremes.TRUSTED_SPAN``, and one exceedance in
    #: ``seaglint.clutter.extremes.TRUSTED_SETS`` data sets is not undercut.
    believed: bool


class StatisticSteps(Protocol):
    """Steps of a statistic, see ``seaglint.detection.stepped_tails.Steps``."""

    def below(self, threshold: float) -> float:
        """Middle between the two levels around a threshold [standard deviations]."""
        ...

    def above(self, threshold: float) -> float:
        """Lowest middle between two levels at or above a threshold [standard deviations]."""
        ...


@dataclass(frozen=True)
class RareTail:
    """Tail of a statistic on frames without objects."""

    fit: TailFit | None  #: None where nothing can be fitted, with the reason in ``note``.
    extremal_index: float  #: Events over exceedances at the threshold of the fit [1]: one over the mean size of a cluster.
    pixels: int  #: Values it rests on.
    note: str | None = None  #: Why there is no fit.
    #: Shapes and scales whose log likelihood is within 2.2 of the largest [1, standard deviations; (points,) each].
    region: tuple[FloatArray, FloatArray] = field(default=(np.empty(0), np.empty(0)), repr=False)
    levels: StatisticSteps | None = None  #: Levels of a stepped statistic: thresholds are stated as the middle between two of them.

    def at(self, threshold_sigma: float) -> RareRate | None:
        """Return the rate at a threshold [standard deviations]; None below the threshold of the fit."""
        if self.levels is not None:
            # Between two levels of a stepped statistic the rate is constant.
            threshold_sigma = self.levels.below(threshold_sigma)
        if self.fit is None or threshold_sigma < self.fit.threshold:
            return None
        excess = float(threshold_sigma) - self.fit.threshold
        rate = self.fit.rate * float(self.fit.fit.survival(excess))
        shares = survival(*self.region, excess)
        # The number of events at the threshold of the fit is Poisson, and independent of how far they reach.
        known = QUANTILE / math.sqrt(self.fit.events)
        # Independent uncertainties add in quadrature, on the logarithm of the rate.
        low, high = (self.fit.rate * float(s) for s in (shares.min(), shares.max()))
        low = rate * math.exp(-math.hypot(math.log(rate / low), known)) if 0.0 < low <= rate else 0.0
        high = rate * math.exp(math.hypot(math.log(high / rate), known)) if rate > 0.0 else high
        believed = high < TRUSTED_SPAN * low and rate * self.pixels >= 1.0 / TRUSTED_SETS
        return RareRate(float(threshold_sigma), rate, low, min(high, 1.0), believed)

    def threshold_for(self, rate: float) -> RareRate | None:
        """Return the threshold of a rate [1]; None above the rate at the threshold of the fit, or where the tail ends before."""
        threshold = None if self.fit is None else self.fit.threshold_for(rate)
        if threshold is None:
            return None
        return self.at(threshold if self.levels is None else self.levels.above(threshold))


def rare_tail(curve: RateCurve, events: Events, *, seed: int = 0) -> RareTail:
    """Fit the tail of a rate curve and the events of one threshold of the same accumulator (:func:`seaglint.clutter.extremes.fit_tail`)."""
    if len(events) > MOST_EVENTS:
        least = float(np.partition(events.peak, -MOST_EVENTS)[-MOST_EVENTS])
        largest = events.peak >= least
        names = ("first", "duration", "size", "peak", "row", "column", "cut")
        # The threshold of the fit is an edge of the curve's bins: the first at or above the least peak.
        edge = float(curve.threshold[min(int(np.searchsorted(curve.threshold, least)), curve.threshold.size - 1)])
        events = replace(events, threshold=edge, **{name: getattr(events, name)[largest] for name in names})
    fit, note = fit_tail(curve, events, seed=seed)
    if fit is None:
        return RareTail(None, float("nan"), curve.pixels, note)
    index = fit.events / (fit.rate * curve.pixels)
    return RareTail(fit, index, curve.pixels, None, _region(curve, fit))


def survival(shape: FloatArray, scale: FloatArray, excess: FloatArray | float) -> FloatArray:
    """Return the probability P(X > excess) of generalised Pareto distributions, none of shape exactly 0 [1]."""
    inside = np.maximum(1.0 + shape * np.asarray(excess) / scale, 0.0)
    with np.errstate(divide="ignore"):
        return np.asarray(np.exp(-np.log(inside) / np.abs(shape) * np.sign(shape)))


def _region(curve: RateCurve, fit: TailFit) -> tuple[FloatArray, FloatArray]:
    """Shapes and scales that are compatible with the excesses, from the likelihood of the bins of the curve; an event counts once."""
    edge = int(np.searchsorted(curve.threshold, fit.threshold - 1e-6))
    counts = -np.diff(curve.exceedances[edge:])
    used = counts > 0
    middle = (0.5 * (curve.threshold[edge:-1] + curve.threshold[edge + 1 :]) - fit.threshold)[used]
    # Pixels of an event are not independent: the likelihood counts events.
    share = counts[used] * (fit.events / counts.sum())
    a, error = 1.0 + fit.fit.shape, 1.0 / math.sqrt(fit.events)
    # Six standard errors either way; the two are correlated, so that much of the grid is far below the threshold.
    steps = np.linspace(-6.0, 6.0, _GRID)
    shape = np.maximum(fit.fit.shape + a * error * steps, -0.99)
    # The formula has 1 / shape: 0 is replaced by a shape close to it.
    shape = np.where(np.abs(shape) < 1e-9, 1e-9, shape)[:, None] + np.zeros(_GRID)
    scale = fit.fit.scale * np.exp(math.sqrt(2.0 * a) * error * steps) + np.zeros((_GRID, 1))
    likelihood = -share.sum() * np.log(scale)
    for y, n in zip(middle, share, strict=True):
        inside = 1.0 + shape * y / scale
        with np.errstate(invalid="ignore", divide="ignore"):
            likelihood -= np.where(inside > 0, n * (1.0 + 1.0 / shape) * np.log(inside), np.inf)
    near = likelihood >= likelihood.max() - 0.5 * QUANTILE**2
    return shape[near], scale[near]
