"""Rare false alarms: rates below one in the data, from peaks over a threshold, and whether to believe them.

The fit is that of :mod:`seaglint.clutter.extremes`: a generalised Pareto distribution of the excess of all exceeding pixels, as uncertain
as the number of declustered events makes it. Tails of clutter approach that form slowly (a Gaussian's shape is still -0.08 at three
standard deviations), so that a fit to many exceedances is precise and wrong: no more than :data:`MOST_EVENTS` events are fitted.

References
----------
Coles 2001, An Introduction to Statistical Modeling of Extreme Values, ch. 4 and 5 (extremal index).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from seaglint.clutter.exceedances import Events
from seaglint.clutter.extremes import TailFit, fit_tail
from seaglint.clutter.false_alarms import FalseAlarms, RateCurve
from seaglint.clutter.thresholds import standardise
from seaglint.errors import DataError, DomainError

LOWEST_THRESHOLD: Final = 3.0
"""Standard deviations above which the events of a tail begin."""

MOST_EVENTS: Final = 1500
"""Largest events that are fitted: with them rates of 1e-7 from a million values cover the truth of Gaussian and gamma clutter."""

RARE: Final = (1e-4, 1e-5, 1e-6, 1e-7, 1e-8)
"""Rates whose thresholds are told [1]."""


@dataclass(frozen=True)
class RareRate:
    """Extrapolated rate of false alarms.

    Attributes
    ----------
    threshold_sigma : float
        Threshold [standard deviations].
    rate, low, high : float
        Rate per pixel and the ends of its 95 % interval [1].
    believed : bool
        Whether the interval is narrow and the data near enough for it to be believed
        (:class:`seaglint.clutter.extremes.TailFit`, ``trusted_to_rate``).
    """

    threshold_sigma: float
    rate: float
    low: float
    high: float
    believed: bool


@dataclass(frozen=True)
class RareTail:
    """Tail of a statistic on frames without objects.

    Attributes
    ----------
    fit : TailFit or None
        None where nothing can be fitted, with the reason in ``note``.
    extremal_index : float
        Events over exceedances at the threshold of the fit [1]: one over the mean size of a cluster.
    note : str or None
        Why there is no fit.
    """

    fit: TailFit | None
    extremal_index: float
    note: str | None = None

    def at(self, threshold_sigma: float) -> RareRate | None:
        """Rate at a threshold [standard deviations]; None below that of the fit."""
        if self.fit is None or threshold_sigma < self.fit.threshold:
            return None
        rate, low, high = (float(v[0]) for v in self.fit.rates(threshold_sigma))
        return RareRate(float(threshold_sigma), rate, low, high, threshold_sigma <= self.fit.trusted_to_sigma)

    def threshold_for(self, rate: float) -> RareRate | None:
        """Threshold at which the rate is ``rate`` [1]; None above the rate at the threshold of the fit, or where the tail ends before."""
        found = None if self.fit is None else self.fit.threshold_for(rate)
        return None if found is None else self.at(found)


def rare_tail(curve: RateCurve, events: Events, *, seed: int = 0) -> RareTail:
    """Tail from a rate curve and the events of one threshold of the same accumulator (:func:`seaglint.clutter.extremes.fit_tail`)."""
    if len(events) > MOST_EVENTS:
        least = float(np.partition(events.peak, -MOST_EVENTS)[-MOST_EVENTS])
        keep = events.peak >= least
        names = ("first", "duration", "size", "peak", "row", "column", "cut")
        # The threshold of the fit is an edge of the curve's bins: the first at or above the least peak.
        edge = float(curve.threshold[min(int(np.searchsorted(curve.threshold, least)), curve.threshold.size - 1)])
        events = replace(events, threshold=edge, **{name: getattr(events, name)[keep] for name in names})
    fit, note = fit_tail(curve, events, seed=seed)
    if fit is None:
        return RareTail(None, float("nan"), note)
    exceeding = float(fit.rate * curve.pixels)
    return RareTail(fit, fit.events / exceeding if exceeding else float("nan"))


def tail_of(values: ArrayLike, *, seed: int = 0) -> tuple[RareTail, float, float]:
    """Tail of a sample, and the mean and standard deviation in which its thresholds are told.

    Parameters
    ----------
    values : array_like
        A series, an image, or frames (k, rows, columns): neighbours belong to one event [u].
    seed : int
        Of the draws for test and interval.

    Raises
    ------
    DomainError
        More than three axes.
    DataError
        No variation.
    """
    x = np.asarray(values, np.float64)
    if not 1 <= x.ndim <= 3:
        raise DomainError(f"values have {x.ndim} axes; give a series, an image, or frames (k, rows, columns)")
    frames = x.reshape((1,) * (3 - x.ndim) + x.shape)
    mean, sigma = float(np.nanmean(frames)), float(np.nanstd(frames))
    if not sigma > 0:
        raise DataError("values without variation have no tail; give others")
    alarms = FalseAlarms((LOWEST_THRESHOLD,))
    alarms.add(standardise(frames - mean, scope="sequence", scale=(0.0, sigma)))
    return rare_tail(alarms.curve(), alarms.events(LOWEST_THRESHOLD), seed=seed), mean, sigma
