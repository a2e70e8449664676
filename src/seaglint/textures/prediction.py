"""Prediction of pixels from their neighbours by a Gauss-Markov texture, in nat per pixel, and whether the number has a meaning.

The density of a pixel x = Q(g) given its neighbours is the density of the Gaussian field divided by dQ/dg. In three cases its logarithm is
nonsense:

- Whole-numbered values. A fitted distribution function has steps, so that dQ/dg is 0 between them. The probability of the step of a pixel
  is evaluated instead; it is 1 at most, and the density per unit of x is 1/step at most. Neighbours are the mean of g over their step.
- Values that the fitted law excludes, such as values below the smallest one of a gamma distribution. Their probability is 0 and the sum
  minus infinity. They are left out with the pixels beside them, and beyond ``MOST_OUTSIDE`` there is no number.
- A few pixels that carry the whole sum. Without the least probable thousandth the mean of Gaussian pixels changes by 0.007 nat.
  Where it changes by more than ``MOST_CARRIED``, the mean describes those pixels.

Relative to independent pixels of the same law the slopes dQ/dg cancel: the gain is the information that neighbours have on a pixel.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from seaglint.base.conventions import FloatArray
from seaglint.textures.gauss_markov import conditional
from seaglint.textures.gaussian_texture import GaussianTexture
from seaglint.textures.marginals import REACH, Marginal

MOST_OUTSIDE: Final = 0.02  #: Largest share of pixels that the fitted law excludes and that are left out of the mean.

FEW: Final = 1e-3  #: Share of the least probable pixels.

MOST_CARRIED: Final = 0.5  #: Largest change of the mean without them [nat].

#: Least step of whole-numbered data, in standard deviations; with finer ones a density has a meaning.
LEAST_STEP: Final = 1e-3

#: Width over which the density of an empirical law is averaged, in conditional standard deviations: the error is below 0.001 nat.
WIDTH: Final = 0.1

RAREST: Final = 1e-12  #: Probability of a step below which the fitted law excludes it: what lies beyond the table of quantiles.

SAMPLED: Final = 200_000  #: Number of pixels among which the step is searched.


@dataclass(frozen=True)
class Prediction:
    """Logarithm of the pseudo-likelihood per pixel of data under a texture."""

    log_pseudo_likelihood: float | None  #: Mean log density of a pixel given its neighbours [nat, of values in u]; None with a reason.
    gain: float | None  #: The same less that of independent pixels with the texture's distribution [nat].
    outside: float  #: Share of the pixels whose values the texture's distribution excludes [1].
    step: float | None  #: Step of whole-numbered data [u]; None for continuous ones.
    reason: str | None = None  #: Reason for a missing number.


def data_step(values: ArrayLike) -> float | None:
    """Return the step of which all differences of the values are multiples [u]; None for continuous values.

    Parameters
    ----------
    values : array_like
        Pixels [u]; NaN are left out.

    Examples
    --------
    >>> data_step([3.0, 1.5, 2.0, 2.0, 1.5, 3.5])
    0.5
    """
    x = np.asarray(values, np.float64).ravel()
    x = x[:: max(x.size // SAMPLED, 1)]
    levels = np.unique(x[np.isfinite(x)])
    # Values that are seldom equal have no step.
    if levels.size < 2 or 2 * levels.size > x.size + 3:
        return None
    differences = np.diff(levels)
    step = float(differences.min())
    if not step > LEAST_STEP * float(x[np.isfinite(x)].std()):
        return None
    ratios = differences / step
    return step if float(np.abs(ratios - np.rint(ratios)).max()) < 0.02 else None


def predict(texture: GaussianTexture, data: ArrayLike) -> Prediction:
    """Evaluate how well neighbours predict the pixels of data; the slow field is not used.

    ``L = mean(log N(g; m, v) - log dQ/dg)`` for pixels ``x = Q(g)``, m the expected g given the neighbours (Besag 1975, Statistician 24,
    179), and ``L = mean(log(P / h))`` for data of a step h, P the probability of the step. The gain is L less the same with N(0, 1).

    Parameters
    ----------
    texture : GaussianTexture
    data : array_like, shape (rows, columns) or (frames, rows, columns)
        [u]; NaN where a pixel does not count.

    Returns
    -------
    Prediction

    Raises
    ------
    DomainError
        A picture smaller than the neighbourhood.
    """
    x = np.array(data, np.float64, ndmin=3)
    valid = np.isfinite(x)
    step = data_step(x)
    marginal, field = texture.marginal, texture.field
    if step is None and marginal.kind != "empirical":
        g, outside = _latent(marginal, x)
        slopes = marginal.log_slope(g)
        expected, actual = conditional(field, np.where(outside, np.nan, g))
        own = -0.5 * math.log(2.0 * math.pi * field.variance) - 0.5 * (actual - expected) ** 2 / field.variance
        alone = -0.5 * math.log(2.0 * math.pi) - 0.5 * actual**2
        kept = valid & ~outside
        squares = ((actual - expected) ** 2)[np.isfinite(own)]
        density = (
            -0.5 * math.log(2.0 * math.pi * field.variance) - 0.5 * float(np.mean(squares)) / field.variance if squares.size else math.nan
        )
        density -= float(np.mean(slopes[kept])) if kept.any() else math.nan
    else:
        width = step or WIDTH * math.sqrt(field.variance * marginal.variance)
        low, high, middle = _step_ends(marginal, x, width, centred=step is not None)
        # A Gaussian law excludes nothing.
        outside = valid & (marginal.kind != "gaussian") & ~(_log_between(low, high) > math.log(RAREST))
        expected, actual = conditional(field, np.where(outside, np.nan, middle))
        inside = tuple(slice(r, n - r) for r, n in zip(field.reach, x.shape, strict=True))
        deviation = math.sqrt(field.variance)
        own = _log_between((low[inside] - expected) / deviation, (high[inside] - expected) / deviation)
        own = np.where(np.isfinite(actual), own, np.nan)
        alone = _log_between(low[inside], high[inside])
        density = float(np.mean(own[np.isfinite(own)])) - math.log(width) if np.isfinite(own).any() else math.nan
    share = int(np.count_nonzero(outside & valid)) / max(int(np.count_nonzero(valid)), 1)
    gains = (own - alone)[np.isfinite(own)]
    reason = _nonsense(marginal, share, gains)
    if reason is not None:
        return Prediction(None, None, share, step, reason)
    return Prediction(density, float(gains.mean()), share, step)


def _nonsense(marginal: Marginal, share: float, gains: FloatArray) -> str | None:
    """Return the reason why a mean has no meaning; None if it has one."""
    if share > MOST_OUTSIDE:
        return (
            f"{100.0 * share:.3g} % of the pixels have values that the fitted {marginal.kind} distribution excludes: "
            "their probability is 0, and the logarithm has no mean"
        )
    if not gains.size:
        return "no pixel has a value with all its neighbours"
    number = max(int(FEW * gains.size), 1)
    least = np.partition(gains, number - 1)[:number] if number < gains.size else gains
    mean = float(gains.mean())
    without = (float(gains.sum()) - float(least.sum())) / max(gains.size - number, 1)
    if without - mean > MOST_CARRIED:
        return (
            f"{number} of {gains.size} pixels, which their neighbours exclude, carry the sum: "
            f"without them the gain over independent pixels is {without:.3g} instead of {mean:.3g} nat"
        )
    return None


def _latent(marginal: Marginal, x: FloatArray) -> tuple[FloatArray, NDArray[np.bool_]]:
    """Return the Gaussian field of values, and those that the distribution excludes."""
    g = marginal.gaussian(x)
    if marginal.kind == "gaussian":
        # The table ends at 7 standard deviations, the distribution does not.
        exact = (x - marginal.loc) / abs(marginal.scale)
        return np.where(np.abs(exact) < REACH, g, exact), np.zeros(x.shape, np.bool_)
    ends = marginal(np.array([-REACH, REACH]))
    return g, np.asarray((x < ends[0]) | (x > ends[1]))


def _step_ends(marginal: Marginal, x: FloatArray, width: float, *, centred: bool) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the Gaussian field at both ends of the steps around values, and its mean over the step or the value at its middle."""
    levels, places = np.unique(x, return_inverse=True)
    low, high = levels - 0.5 * width, levels + 0.5 * width
    g = [_latent(marginal, end)[0] for end in (low, high)]
    if marginal.kind != "gaussian":
        ends = marginal(np.array([-REACH, REACH]))
        # The probability beyond the table is 0.
        g = [np.where(end <= ends[0], -np.inf, np.where(end >= ends[1], np.inf, value)) for end, value in zip((low, high), g, strict=True)]
    if centred:
        weight = np.exp(_log_between(g[0], g[1]))
        with np.errstate(invalid="ignore", divide="ignore", under="ignore"):
            density = [np.exp(-0.5 * end**2) / math.sqrt(2.0 * math.pi) for end in g]
            middle = np.where(weight > RAREST, (density[0] - density[1]) / weight, _latent(marginal, levels)[0])
    else:
        middle = _latent(marginal, levels)[0]
    shape = x.shape
    return g[0][places].reshape(shape), g[1][places].reshape(shape), middle[places].reshape(shape)


def _log_between(low: FloatArray, high: FloatArray) -> FloatArray:
    """Return the logarithm of the standard normal probability between two ends, with its digits in both tails."""
    from scipy.special import log_ndtr

    # Both ends on the side of the smaller probability.
    swap = low + high > 0.0
    first, last = np.where(swap, -high, low), np.where(swap, -low, high)
    with np.errstate(invalid="ignore", divide="ignore"):
        upper, lower = log_ndtr(last), log_ndtr(first)
        return np.asarray(upper + np.log1p(-np.exp(np.minimum(lower - upper, 0.0))))
