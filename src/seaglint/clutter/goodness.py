"""Goodness of fit: Kolmogorov-Smirnov and Anderson-Darling distances, with levels that hold for correlated pixels.

Two things make textbook levels wrong here. Parameters were fitted to the same values, which brings the fit nearer (Lilliefors
1967): the null distribution is therefore drawn, by a parametric bootstrap that fits each replicate. And neighbouring pixels repeat
each other: of ``count`` values only ``effective_count`` are independent, so ``sqrt(m) D`` and ``A^2 m / n`` are compared with those of
replicates of ``m = effective_count`` independent values (at most 2000: beyond, both have reached their limit law).

Replicates are fitted by one Newton step from the parameters they were drawn with, which is as good as the full maximum to
first order in 1/m (Le Cam's one-step estimator) and some hundred times quicker.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from seaglint.base import random
from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError
from seaglint.clutter.fits import Fit, cdf, draw, scores

METHOD = "parametric bootstrap of the fit with the effective number of independent values"
MOST_INDEPENDENT = 2000
FEWEST_INDEPENDENT = 8
FEWEST_JUDGED = 50  #: Least number of independent values for judging a fit: with fewer, a test at 5 % does not detect a distance of 0.12.


@dataclass(frozen=True)
class Goodness:
    """Distances between sample and fit with their levels."""

    ks: float  #: Largest distance between the two distribution functions [1].
    #: ``ks_p``, ``ad_p``: Probability of such a distance or a larger one if the fit's family is right, at least ``1 / (replicates + 1)``;
    #: NaN with fewer than 8 independent values.
    ks_p: float
    ad: float  #: Anderson-Darling ``A^2`` per value times ``effective_count``: what that many independent values would show [1].
    ad_p: float  #: See ``ks_p``.
    effective_count: float  #: Independent values.
    replicates: int  #: Number of replicates of the bootstrap.
    method: str = METHOD  #: One line for reports.


def distances(probability: FloatArray, weights: FloatArray | None = None) -> tuple[FloatArray, FloatArray]:
    """Kolmogorov-Smirnov distance D and ``A^2 / n`` of fitted probabilities, sorted along the last axis.

    ``D = max(i/n - F_i, F_i - (i-1)/n)``, ``A^2/n = -1 - sum (2i-1)(ln F_i + ln(1 - F_(n+1-i))) / n^2``

    Parameters
    ----------
    probability : ndarray, shape (..., n)
        Fitted distribution function at the values in rising order; equal values in a row are one step of the sample's.
    weights : ndarray, shape (n,), optional
        Counts of cells of a histogram, for one sample only.

    Returns
    -------
    ks, ad : ndarray, shape (...)
    """
    n = probability.shape[-1]
    inside = np.clip(probability, 1e-12, 1.0 - 1e-12)
    share = np.full(n, 1.0 / n) if weights is None else weights / weights.sum()
    above = np.minimum(np.cumsum(share), 1.0)
    below = np.concatenate([[0.0], above[:-1]])
    ks = np.maximum(np.max(above - probability, axis=-1), np.max(probability - below, axis=-1))
    # Weighted form of the sum: (2i-1)/n^2 is above^2 - below^2, and the same from the other end.
    ad = -1.0 - np.sum((above**2 - below**2) * np.log(inside) + ((1.0 - below) ** 2 - (1.0 - above) ** 2) * np.log1p(-inside), axis=-1)
    return np.asarray(ks), np.asarray(ad)


def goodness(
    values: ArrayLike,
    fitted: Fit,
    *,
    weights: ArrayLike | None = None,
    effective_count: float | None = None,
    replicates: int = 199,
    seed: int = 0,
) -> Goodness:
    """Test the fit against the values it was fitted to.

    Parameters
    ----------
    values : array_like, any shape
        The sample of the fit (or its histogram's cells); NaN and values at or below the fit's ``loc`` are left out, as in the fit.
    fitted : Fit
        Fit of the same values.
    weights : array_like, shape of values, optional
        Counts of a histogram's cells; cells must be much narrower than ``1 / sqrt(effective_count)`` in probability.
    effective_count : float, optional
        Independent values; default that of the fit. From the correlation of the values it is a lower bound, which makes the
        levels larger than exact ones.
    replicates : int
        Number of replicates of the bootstrap; 199 give levels down to 0.005.
    seed : int
        Seed of the bootstrap; same seed, same levels.

    Returns
    -------
    Goodness

    Raises
    ------
    DataError
        If there is no fit.
    """
    theta, loc = fitted.parameters()
    x = np.asarray(values, dtype=np.float64).ravel()
    w = np.ones_like(x) if weights is None else np.asarray(weights, dtype=np.float64).ravel()
    if x.shape != w.shape:
        raise DataError("values and weights differ in size; give one weight per value")
    positive = fitted.family != "gaussian"
    keep = np.isfinite(x) & (w > 0.0) & ((x > loc) | (not positive))
    # Equal values (integers of a camera) make one step of the sample's distribution function, not many.
    x, place = np.unique(x[keep], return_inverse=True)
    w = np.asarray(np.bincount(place, weights=w[keep]), dtype=np.float64)
    ks, ad = (float(d) for d in distances(cdf(fitted.family, x - loc, theta), w))
    independent = min(fitted.effective_count if effective_count is None else float(effective_count), float(w.sum()))
    if independent < FEWEST_INDEPENDENT:
        return Goodness(ks, np.nan, ad * independent, np.nan, independent, 0)

    m = int(min(independent, MOST_INDEPENDENT))
    sample = draw(fitted.family, theta, (replicates, m), random.stream(seed, "goodness of " + fitted.family))
    first = theta[0] + np.zeros((replicates, 1)), theta[1] + np.zeros((replicates, 1))
    score = scores(fitted.family, sample, theta)
    information = np.einsum("irm,jrm->ij", score, score) / sample.size
    step = np.einsum("ij,jr->ir", np.linalg.inv(information), score.mean(axis=-1))[..., None]
    a = first[0] + step[0] if fitted.family == "gaussian" else first[0] * np.exp(step[0])
    null_ks, null_ad = distances(np.sort(cdf(fitted.family, sample, (a, first[1] * np.exp(step[1]))), axis=-1))
    scaled = np.sqrt(independent / m)
    ks_p = (1.0 + np.count_nonzero(null_ks >= ks * scaled)) / (replicates + 1.0)
    ad_p = (1.0 + np.count_nonzero(null_ad >= ad * scaled**2)) / (replicates + 1.0)
    return Goodness(ks, float(ks_p), ad * independent, float(ad_p), independent, replicates)
