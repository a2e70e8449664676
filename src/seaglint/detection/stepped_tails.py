"""Tails of a statistic with few distinct values: counts of a converter, and differences of them.

Excesses over a threshold are known up to a step, and the generalised Pareto distribution is fitted to the numbers of pixels on each level:
a level's probability is the difference of the survival function at its two ends, half a step to either side. A threshold lies between two
levels, and anywhere between the same two it has the same false alarms.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.random import stream
from seaglint.clutter.exceedances import Events
from seaglint.clutter.extremes import FEWEST_EVENTS, ParetoFit, with_limits
from seaglint.clutter.false_alarms import BIN, FalseAlarms, RateCurve
from seaglint.detection.background import Background, Law
from seaglint.detection.rare_alarms import LOWEST_THRESHOLD, MOST_EVENTS, QUANTILE, RareTail, rare_tail, survival

FEWEST_LEVELS: Final = 3  #: Least number of levels for fitting a tail: one more than it has parameters.

_SAMPLE = 200_000
_SHARE = 20  # least number of values per level for a stepped statistic
_SHAPES = np.linspace(-0.6, 1.2, 181)
_SCALES = 161


@dataclass(frozen=True)
class Steps:
    """Levels of a statistic: ``level`` and whole steps from it [standard deviations]."""

    level: float
    step: float

    def below(self, threshold: float) -> float:
        """Middle between the two levels around a threshold [standard deviations]."""
        return self.level + (math.floor((threshold - self.level) / self.step + 1e-6) + 0.5) * self.step

    def above(self, threshold: float) -> float:
        """Lowest middle between two levels at or above a threshold [standard deviations]."""
        return self.level + (math.ceil((threshold - self.level) / self.step - 0.5 - 1e-6) + 0.5) * self.step


def steps_of(background: Background, law: Law) -> Steps | None:
    """Return the levels of the statistic; None where it is continuous, or has steps finer than two bins of the rate curve."""
    rows, columns = background.statistic.shape[1:]
    number = min(max(_SAMPLE // (rows * columns), 1), background.windows)
    # A sample of windows, evenly spread: levels show in few values.
    chosen = np.unique(np.linspace(0, background.windows - 1, number).astype(int))
    values = np.concatenate([background.z(int(k), law).ravel() for k in chosen]).astype(np.float64)
    values = np.sort(values[np.isfinite(values)])
    gaps = np.diff(values)
    gaps = gaps[gaps > 0.1 * BIN]
    # Too few levels, or about as many levels as values: the statistic is continuous.
    if gaps.size < FEWEST_LEVELS or _SHARE * gaps.size > values.size:
        return None
    # Missing levels give multiples of the step: the smallest gaps are single steps.
    step = float(np.median(gaps[gaps < 1.5 * gaps.min()]))
    in_steps = gaps / step
    if step < 2.0 * BIN or np.abs(in_steps - np.rint(in_steps)).max() > 0.1:
        return None
    middle = float(values[values.size // 2])
    return Steps(middle, step)


def tail_above(
    background: Background, law: Law, curve: RateCurve, events: Events, *, lowest: float = LOWEST_THRESHOLD, seed: int = 0
) -> RareTail:
    """Fit the tail of the statistic's false alarms, for stepped and continuous statistics.

    Parameters
    ----------
    background : Background
        Statistic.
    law : {"sigma", "frame", "fixed", "design"}
        Law of the threshold, whose standard deviations are the unit of the tail.
    curve, events : RateCurve, Events
        Rates, and the events above ``lowest``.
    lowest : float
        Threshold of the events [standard deviations].
    seed : int
        Seed of the draws behind tests and intervals.
    """
    steps = steps_of(background, law)
    if steps is None:
        return rare_tail(curve, events, seed=seed)
    edges = np.arange(steps.above(lowest), float(curve.threshold[-1]) + steps.step, steps.step) if curve.threshold.size else np.empty(0)
    # a bin of the curve holds at most one level: from the edge on, all values above it
    above = np.array([int(curve.exceedances[min(int(np.searchsorted(curve.threshold, e)), curve.threshold.size - 1)]) for e in edges])
    filled = np.flatnonzero(above > 0)
    if filled.size < FEWEST_LEVELS:
        return RareTail(None, float("nan"), curve.pixels, f"{filled.size} levels above {lowest:g} sigma; a tail needs {FEWEST_LEVELS}")
    edges, above = edges[: filled[-1] + 1], above[: filled[-1] + 1]
    alarms = FalseAlarms(tuple(float(e) for e in edges))
    for _ in background.add_to(alarms, law):
        pass
    note = f"fewer than {FEWEST_EVENTS} events or {FEWEST_LEVELS} levels above any threshold that leaves {MOST_EVENTS} events at most"
    for first in range(edges.size - FEWEST_LEVELS + 1):
        number = len(alarms.events(float(edges[first])))
        if number > MOST_EVENTS:
            continue
        if number < FEWEST_EVENTS:
            break
        counts = -np.diff(np.append(above[first:], 0))
        fit, p, region = fit_levels(counts, steps.step, number / float(above[first]))
        if p < 0.1:
            note = "no threshold leaves levels that follow a generalised Pareto distribution; only the measured curve is given"
            continue
        edge = int(np.searchsorted(curve.threshold, edges[first]))
        reached = steps.step * (counts.size - 0.5)
        fitted = with_limits(curve, edge, float(edges[first]), number, fit, p, reached, stream(seed, "levels of a tail"))
        return RareTail(fitted, number / float(above[first]), curve.pixels, None, region, steps)
    return RareTail(None, float("nan"), curve.pixels, note)


def fit_levels(counts: NDArray[np.int64], step: float, share: float) -> tuple[ParetoFit, float, tuple[FloatArray, FloatArray]]:
    """Fit a generalised Pareto distribution to numbers on levels, by maximum likelihood on a grid.

    Parameters
    ----------
    counts : ndarray of int, shape (levels,)
        Pixels on each level, from the threshold up.
    step : float
        Distance of levels; the threshold is half a step below the first [standard deviations].
    share : float
        Independent observations to a pixel [1].

    Returns
    -------
    ParetoFit, float, (ndarray, ndarray)
        The fit, its significance by the likelihood ratio, and the shapes and scales that are not ruled out.
    """
    from scipy.stats import chi2

    ends = step * np.arange(counts.size + 1)
    mean = step * float(counts @ (np.arange(counts.size) + 0.5)) / float(counts.sum())
    shape = np.where(np.abs(_SHAPES) < 1e-9, 1e-9, _SHAPES)[:, None] + np.zeros(_SCALES)
    scale = mean * np.exp(np.linspace(-2.5, 1.5, _SCALES)) + np.zeros((_SHAPES.size, 1))
    weight = share * counts
    likelihood = np.zeros(shape.shape)
    before = np.ones(shape.shape)
    for end, number in zip(ends[1:], weight, strict=True):
        beyond = survival(shape, scale, end)
        with np.errstate(divide="ignore"):
            likelihood += number * np.log(before - beyond) if number > 0 else 0.0
        before = beyond
    best = np.unravel_index(int(np.argmax(likelihood)), likelihood.shape)
    most = float(likelihood[best])
    near = likelihood >= most - 0.5 * QUANTILE**2
    fit = ParetoFit(float(shape[best]), float(scale[best]), most)
    # against levels with the counted shares, the rare ones and those beyond the last combined
    expected = weight.sum() * -np.diff(np.append(np.asarray(fit.survival(ends[:-1])), 0.0))
    count = max(int(np.sum(np.cumsum(expected[::-1])[::-1] >= 3.0)), 1)
    observed, predicted = (np.append(v[: count - 1], v[count - 1 :].sum()) for v in (weight, expected))
    with np.errstate(divide="ignore", invalid="ignore"):
        deviance = 2.0 * float(np.where(observed > 0, observed * np.log(observed / predicted), 0.0).sum())
    return fit, float(chi2.sf(deviance, max(observed.size - 3, 1))), (shape[near], scale[near])
