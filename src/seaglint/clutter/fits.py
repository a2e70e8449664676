"""Distributions of clutter: maximum-likelihood fits and their goodness, with intervals and levels that hold for correlated pixels.

========= ======================================================= ================
family    density (x > 0, location 0; Gaussian: all x)            parameters
========= ======================================================= ================
gamma     ``x^(a-1) exp(-x/l) / (l^a Gamma(a))``                  shape a, scale l
lognormal ``exp(-ln(x/m)^2 / (2 s^2)) / (x s sqrt(2 pi))``        shape s, scale m
weibull   ``(c/l) (x/l)^(c-1) exp(-(x/l)^c)``                     shape c, scale l
k         ``2/(b Gamma(v)) (x/b)^((v-1)/2) K_(v-1)(2 sqrt(x/b))`` shape v, scale b
gaussian  ``exp(-(x-loc)^2 / (2 l^2)) / (l sqrt(2 pi))``          loc, scale l
========= ======================================================= ================

The source article's Fig. 9 uses the gamma density; its printed formula is garbled. The K distribution describes an intensity with one look
(Jakeman and Pusey 1976; Ward, Tough and Watts 2006, Eq. 4.5): an exponential whose mean is gamma distributed. Its variance over squared
mean is ``1 + 2/v``, at least 1, so data of less contrast have no K distribution; the fit then states this reason.

Goodness of fit is measured by Kolmogorov-Smirnov and Anderson-Darling distances. Textbook levels of these distances are wrong for two
reasons:

- Parameters were fitted to the same values, which brings the fit nearer (Lilliefors 1967). The null distribution is therefore drawn, by a
  parametric bootstrap that fits each replicate.
- Neighbouring pixels repeat each other: of ``count`` values only ``effective_count`` are independent. ``sqrt(m) D`` and ``A^2 m / n`` are
  therefore compared with replicates of ``m = effective_count`` independent values (at most 2000: beyond, both have reached their limit
  law).

Replicates are fitted by one Newton step from the parameters they were drawn with, which is as good as the full maximum to first order in
1/m (Le Cam's one-step estimator) and some hundred times quicker.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from seaglint.base import random
from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError
from seaglint.base.free_form import JsonObject, plain

Family = Literal["gamma", "lognormal", "weibull", "k", "gaussian"]
FAMILIES: tuple[Family, ...] = get_args(Family)

FEWEST_VALUES = 10
LARGEST_K_SHAPE = 200.0  # variance over squared mean within 1 % of the exponential's: no sample distinguishes the two
CONDENSED = 4000  # values to which larger samples are reduced for the K distribution's likelihood; moves the shape by 1e-3
LARGEST_EXCLUDED = 0.02  # share of values at or below loc that may be left out: zeros of integer pictures
STEP = 1e-4  # of a log parameter, for derivatives: error 1e-8 relative, far below any sampling error


@dataclass(frozen=True)
class Fit:
    """Fit of one family of distributions to one set of values."""

    family: Family  #: One of ``FAMILIES``.
    shape: float | None  #: Shape as in the module's table; None for the Gaussian, or without a fit.
    loc: float | None  #: Location as in the module's table; None without a fit.
    scale: float | None  #: Scale as in the module's table; None without a fit.
    shape_interval: tuple[float, float] | None  #: 95 % interval of the shape; None for a given or absent shape.
    loc_interval: tuple[float, float] | None  #: 95 % interval of the location; None for a given or absent one.
    scale_interval: tuple[float, float] | None  #: 95 % interval of the scale; None for a given or absent one.
    log_likelihood: float | None  #: Sum over the values, as if independent.
    count: int  #: Number of fitted values.
    effective_count: float  #: Number of independent values that the intervals assume.
    reason: str = ""  #: Reason for the absence of a fit; empty if there is a fit.
    excluded: float = 0.0  #: Share of the values that are not above ``loc`` and were left out, at most 0.02 (zeros of an integer picture).
    goodness: Goodness | None = None  #: Test of the fit; None where none was made.

    @property
    def is_valid(self) -> bool:
        """True if the fit has parameters."""
        return not self.reason

    def cdf(self, x: ArrayLike) -> FloatArray:
        """Probability of a value up to x, shape of x."""
        theta, loc = self.parameters()
        return cdf(self.family, np.asarray(x, dtype=np.float64) - loc, theta)

    def pdf(self, x: ArrayLike) -> FloatArray:
        """Density at x, per unit of the data, shape of x."""
        theta, loc = self.parameters()
        return np.exp(log_density(self.family, np.asarray(x, dtype=np.float64) - loc, theta))

    def parameters(self) -> tuple[tuple[float, float], float]:
        """Two free parameters as in ``log_density``, and the location to subtract before."""
        if self.scale is None or self.loc is None:
            raise DataError(f"there is no {self.family} fit: {self.reason}")
        if self.family == "gaussian":
            return (self.loc, self.scale), 0.0
        assert self.shape is not None
        return (self.shape, self.scale), self.loc

    def as_dict(self) -> JsonObject:
        """Return plain numbers and text; numbers that do not exist are None."""
        tested = ("ks", "ks_p", "ad", "ad_p")
        values = {
            "shape": self.shape,
            "scale": self.scale,
            "loc": self.loc,
            "shape_interval": self.shape_interval,
            "scale_interval": self.scale_interval,
            "loc_interval": self.loc_interval,
            "log_likelihood_per_value": None if self.log_likelihood is None else self.log_likelihood / max(self.count, 1),
            "effective_count": self.effective_count,
            "excluded": self.excluded,
            **{name: None if self.goodness is None else getattr(self.goodness, name) for name in tested},
            "reason": self.reason or None,
        }
        return plain(values)


def fit(
    values: ArrayLike,
    family: Family,
    *,
    loc: float = 0.0,
    weights: ArrayLike | None = None,
    effective_count: float | None = None,
    blocks: ArrayLike | None = None,
) -> Fit:
    """Fit a family by maximum likelihood.

    Parameters
    ----------
    values : array_like, any shape
        Sample, or centres of the cells of a fine histogram; NaN are left out.
    family : str
        One of ``FAMILIES``.
    loc : float
        Location of the positive families, known beforehand, unit of the data.
    weights : array_like, shape of values, optional
        Counts of a histogram's cells (cells of 1/50 of the standard deviation shift the scale by 2e-5).
    effective_count : float, optional
        Independent values in the sample (:func:`seaglint.clutter.correlation.effective_count`); intervals from the expected curvature
        of the likelihood widen by ``sqrt(count / effective_count)``. Default: all values independent.
    blocks : array_like of int, shape of values, optional
        Label of the block (some correlation lengths and times wide) each value lies in. Intervals then come from the scatter of the
        blocks' scores (Huber's sandwich, Student's t): valid under any correlation within blocks, and if the family is wrong. Ten
        blocks or more; wins over ``effective_count``.

    Returns
    -------
    Fit
        Without parameters and with a ``reason`` where the family cannot be fitted: constant data, values not above ``loc`` (filtered
        images are negative), contrast below the K distribution's.

    Raises
    ------
    DataError
        If the family is unknown or shapes differ.

    Examples
    --------
    >>> import numpy as np
    >>> sample = np.random.default_rng(1).gamma(4.0, 0.5, 100_000)
    >>> result = fit(sample, "gamma")
    >>> result.shape_interval[0] < 4.0 < result.shape_interval[1]
    True
    """
    if family not in FAMILIES:
        raise DataError(f"unknown distribution '{family}'; choose from {', '.join(FAMILIES)}")
    x = np.asarray(values, dtype=np.float64).ravel()
    w = np.ones_like(x) if weights is None else np.asarray(weights, dtype=np.float64).ravel()
    label = None if blocks is None else np.asarray(blocks).ravel()
    if w.shape != x.shape or (label is not None and label.shape != x.shape):
        raise DataError("values, weights and blocks differ in size; give one weight and one block per value")
    keep = np.isfinite(x) & (w > 0.0)
    x, w, label = x[keep], w[keep], None if label is None else label[keep]
    count = float(w.sum())
    independent = count if effective_count is None else min(max(float(effective_count), 1.0), count)

    def refused(reason: str) -> Fit:
        return Fit(family, None, None, None, None, None, None, None, round(count), independent, reason)

    if count < FEWEST_VALUES:
        return refused(f"{round(count)} values, at least {FEWEST_VALUES} are needed")
    share = 0.0
    if family != "gaussian":
        x = x - loc
        above = x > 0.0
        share = float(w[~above].sum() / count)
        if share <= LARGEST_EXCLUDED:
            x, w, label = x[above], w[above], None if label is None else label[above]
            count = float(w.sum())
        else:
            return refused(f"{100.0 * share:.3g} % of the values are not above loc = {loc:g}; give a loc below the smallest")
    mean = float(np.sum(w * x) / count)
    variance = float(np.sum(w * (x - mean) ** 2) / count)
    if not variance > (1e-12 * mean) ** 2:
        return refused("all values are equal")
    # Values of nearly no spread or huge range overflow on the way; the result is checked.
    with np.errstate(all="ignore"):
        try:
            solved = _SOLVERS[family](x, w / count, mean, variance)
            if isinstance(solved, str):
                return refused(solved)
            theta = solved
            error, quantile = _standard_errors(family, x, w, theta, independent, label)
        except (ValueError, np.linalg.LinAlgError):
            return refused("the likelihood has no maximum that floating point resolves (too little spread, or too much)")
        if not (np.isfinite(theta).all() and np.isfinite(error).all()):
            return refused("the likelihood has no maximum that floating point resolves (too little spread, or too much)")
    with np.errstate(over="ignore"):  # an interval may be infinite
        intervals = [
            (value - quantile * error[i], value + quantile * error[i])
            if family == "gaussian" and i == 0
            # On the logarithm: positive parameters stay so, and their errors are nearer to a Gaussian.
            else (value * float(np.exp(-quantile * error[i])), value * float(np.exp(quantile * error[i])))
            for i, value in enumerate(theta)
        ]
    likelihood = float(np.sum(w * log_density(family, x, theta)))
    gaussian = family == "gaussian"
    return Fit(
        family=family,
        shape=None if gaussian else theta[0],
        loc=theta[0] if gaussian else loc,
        scale=theta[1],
        shape_interval=None if gaussian else intervals[0],
        loc_interval=intervals[0] if gaussian else None,
        scale_interval=intervals[1],
        log_likelihood=likelihood,
        count=round(count),
        effective_count=independent,
        excluded=share,
    )


def log_density(family: Family, x: FloatArray, theta: tuple[ArrayLike, ArrayLike]) -> FloatArray:
    """Logarithm of the density at x (above the location), parameters broadcast against it."""
    from scipy.special import gammaln, kve, xlogy

    a, b = (np.asarray(t, dtype=np.float64) for t in theta)
    if family == "gaussian":
        return np.asarray(-0.5 * ((x - a) / b) ** 2 - np.log(b) - 0.5 * np.log(2.0 * np.pi))
    if family == "gamma":
        return np.asarray(xlogy(a - 1.0, x / b) - x / b - np.log(b) - gammaln(a))
    if family == "lognormal":
        return np.asarray(-0.5 * (np.log(x / b) / a) ** 2 - np.log(x * a) - 0.5 * np.log(2.0 * np.pi))
    if family == "weibull":
        return np.asarray(np.log(a / b) + xlogy(a - 1.0, x / b) - (x / b) ** a)
    z = 2.0 * np.sqrt(x / b)
    # kve overflows for z -> 0 at large order; there K_n(z) ~ Gamma(n)/2 (2/z)^n.
    order = np.abs(a - 1.0)
    with np.errstate(divide="ignore", over="ignore"):
        bessel = np.log(kve(order, z)) - z
        near_zero = gammaln(np.maximum(order, 1e-300)) - np.log(2.0) + order * np.log(2.0 / z)
    bessel = np.where(np.isfinite(bessel), bessel, near_zero)
    return np.asarray(np.log(2.0 / b) - gammaln(a) + 0.5 * (a - 1.0) * np.log(x / b) + bessel)


def cdf(family: Family, x: FloatArray, theta: tuple[ArrayLike, ArrayLike]) -> FloatArray:
    """Probability of a value up to x (above the location), parameters broadcast against it."""
    from scipy.special import gammainc, gammaln, kve, ndtr

    a, b = (np.asarray(t, dtype=np.float64) for t in theta)
    if family == "gaussian":
        return np.asarray(ndtr((x - a) / b))
    y = np.maximum(np.asarray(x, dtype=np.float64), 0.0) / b
    if family == "gamma":
        return np.asarray(gammainc(a, y))
    if family == "lognormal":
        with np.errstate(divide="ignore"):
            return np.asarray(ndtr(np.log(y) / a))
    if family == "weibull":
        return np.asarray(-np.expm1(-(y**a)))
    z = 2.0 * np.sqrt(y)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        tail = np.exp(np.log(2.0) - gammaln(a) + a * np.log(0.5 * z) + np.log(kve(a, z)) - z)
    return np.clip(1.0 - np.where(np.isfinite(tail), tail, 1.0), 0.0, 1.0)


def draw(family: Family, theta: tuple[float, float], size: tuple[int, ...], rng: np.random.Generator) -> FloatArray:
    """Draw independent values of a family, above the location."""
    a, b = theta
    if family == "gaussian":
        return rng.normal(a, b, size)
    if family == "gamma":
        return rng.gamma(a, b, size)
    if family == "lognormal":
        return b * np.exp(a * rng.standard_normal(size))
    if family == "weibull":
        return b * rng.weibull(a, size)
    return b * rng.gamma(a, 1.0, size) * rng.standard_exponential(size)


def _shifted(family: Family, theta: tuple[float, float], i: int, step: float) -> tuple[tuple[float, float], tuple[float, float], float]:
    """Return parameters with one shifted up and down by a step of its logarithm (Gaussian mean: in scales), and the step [1 or data]."""
    up, down = list(theta), list(theta)
    if family == "gaussian" and i == 0:
        step = step * theta[1]
        up[i], down[i] = theta[i] + step, theta[i] - step
    else:
        up[i], down[i] = theta[i] * np.exp(step), theta[i] * np.exp(-step)
    return (up[0], up[1]), (down[0], down[1]), step


def scores(family: Family, x: FloatArray, theta: tuple[float, float]) -> FloatArray:
    """Return derivatives of the log density by the parameters' logarithms (Gaussian mean: by the mean), shape ``(2, *x.shape)``."""
    out = np.empty((2, *np.shape(x)))
    for i in range(2):
        up, down, step = _shifted(family, theta, i, STEP)
        out[i] = (log_density(family, x, up) - log_density(family, x, down)) / (2.0 * step)
    return out


def _standard_errors(
    family: Family, x: FloatArray, w: FloatArray, theta: tuple[float, float], independent: float, label: NDArray[np.generic] | None
) -> tuple[FloatArray, float]:
    """Return standard errors of log parameters (Gaussian mean: of itself) and the quantile for 95 % intervals."""
    from scipy.special import stdtrit

    score = scores(family, x, theta)
    if label is None:
        return np.sqrt(np.diag(np.linalg.inv((w * score) @ score.T / w.sum())) / independent), 1.959964
    group, place = np.unique(label, return_inverse=True)
    if len(group) < 10:
        raise DataError(f"{len(group)} blocks are too few for intervals; make 10 or more, or give effective_count")
    sums = np.stack([np.bincount(place, weights=w * row) for row in score])
    between = sums @ sums.T * len(group) / (len(group) - 1.0)
    # Curvature from differences of the mean score, which does not assume that the family is right.
    curvature = np.empty((2, 2))
    for i in range(2):
        up, down, step = _shifted(family, theta, i, 1e-3)
        curvature[i] = (scores(family, x, down) @ w - scores(family, x, up) @ w) / (2.0 * step)
    bread = np.linalg.inv(0.5 * (curvature + curvature.T))
    return np.sqrt(np.diag(bread @ between @ bread)), float(stdtrit(len(group) - 1, 0.975))


def _solve_gaussian(x: FloatArray, p: FloatArray, mean: float, variance: float) -> tuple[float, float] | str:
    return mean, float(np.sqrt(variance))


def _solve_lognormal(x: FloatArray, p: FloatArray, mean: float, variance: float) -> tuple[float, float] | str:
    logarithm = np.log(x)
    centre = float(np.sum(p * logarithm))
    return float(np.sqrt(np.sum(p * (logarithm - centre) ** 2))), float(np.exp(centre))


def _solve_gamma(x: FloatArray, p: FloatArray, mean: float, variance: float) -> tuple[float, float] | str:
    from scipy.optimize import brentq
    from scipy.special import digamma

    gap = float(np.log(mean) - np.sum(p * np.log(x)))
    if not gap > 1e-13:
        return "spread below the rounding of the data"
    # ln a - digamma(a) lies between 1/(2a) and 1/a, which brackets the root.
    a = float(brentq(lambda t: np.log(t) - digamma(t) - gap, 0.49 / gap, 1.01 / gap, xtol=1e-300, rtol=1e-14))
    return a, mean / a


def _solve_weibull(x: FloatArray, p: FloatArray, mean: float, variance: float) -> tuple[float, float] | str:
    from scipy.optimize import brentq

    logarithm = np.log(x)
    centre = float(np.sum(p * logarithm))
    relative = logarithm - logarithm.max()

    def equation(c: float) -> float:
        power = p * np.exp(c * relative)
        return float(np.sum(power * logarithm) / np.sum(power) - 1.0 / c - centre)

    deviation = float(np.sqrt(np.sum(p * (logarithm - centre) ** 2)))
    low = high = 1.28 / deviation  # exact for a Weibull distribution: pi / sqrt(6) over the spread of the logarithms
    while equation(low) > 0.0:
        low *= 0.5
    while equation(high) < 0.0:
        high *= 2.0
    c = float(brentq(equation, low, high, xtol=1e-300, rtol=1e-13)) if high > low else low
    return c, float(np.exp(logarithm.max()) * np.sum(p * np.exp(c * relative)) ** (1.0 / c))


def _solve_k(x: FloatArray, p: FloatArray, mean: float, variance: float) -> tuple[float, float] | str:
    from scipy.optimize import minimize

    contrast = variance / mean**2
    # Fractions of an exponential's contrast appear by chance; the likelihood decides on them, not the moments.
    if contrast < 0.8:
        return f"variance over squared mean is {contrast:.3g}; a K distribution of one look has at least 1"
    start = (float(np.log(min(2.0 / max(contrast - 1.0, 0.05), 40.0))), float(np.log(mean)))
    y, q = (x, p) if len(x) <= CONDENSED else _condensed(x, p)

    def cost(t: FloatArray) -> float:
        v, centre = float(np.exp(np.clip(t[0], -6.0, 8.0))), float(np.exp(t[1]))
        return -float(np.sum(q * log_density("k", y, (v, centre / v))))

    best = minimize(cost, np.array(start), method="Nelder-Mead", options={"xatol": 1e-5, "fatol": 1e-10, "maxiter": 400})
    v = float(np.exp(best.x[0]))
    if not v < LARGEST_K_SHAPE:
        return "no more contrast than an exponential distribution: the shape of the K distribution has no upper limit"
    return v, float(np.exp(best.x[1])) / v


def _condensed(x: FloatArray, p: FloatArray, cells: int = CONDENSED) -> tuple[FloatArray, FloatArray]:
    """Means of consecutive groups of many sorted values, for distributions with a Bessel function per value."""
    order = np.argsort(x)
    group = np.arange(len(x)) * cells // len(x)
    weight = np.asarray(np.bincount(group, weights=p[order]), dtype=np.float64)
    return np.bincount(group, weights=(p * x)[order]) / weight, weight


_SOLVERS: dict[Family, Callable[[FloatArray, FloatArray, float, float], tuple[float, float] | str]] = {
    "gaussian": _solve_gaussian,
    "gamma": _solve_gamma,
    "lognormal": _solve_lognormal,
    "weibull": _solve_weibull,
    "k": _solve_k,
}


METHOD = "parametric bootstrap of the fit with the effective number of independent values"
MOST_INDEPENDENT = 2000  #: Largest number of values of a replicate; beyond, both distances have reached their limit law.
FEWEST_INDEPENDENT = 8  #: Least number of independent values for levels.
FEWEST_JUDGED = 50  #: Least number of independent values for judging a fit: with fewer, a test at 5 % does not detect a distance of 0.12.


@dataclass(frozen=True)
class Goodness:
    """Distances between sample and fit with their levels."""

    ks: float  #: Largest distance between the two distribution functions [1].
    #: Probability of such a distance or a larger one if the fit's family is right [1], at least ``1 / (replicates + 1)``; NaN with fewer
    #: than 8 independent values.
    ks_p: float
    ad: float  #: Anderson-Darling ``A^2`` per value times ``effective_count``: what that many independent values would show [1].
    ad_p: float  #: Probability of such an ``A^2`` or a larger one, as ``ks_p`` [1].
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
    above = np.minimum(np.cumsum(np.full(n, 1.0 / n) if weights is None else weights / weights.sum()), 1.0)
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
        Independent values; default as in the fit. From the correlation of the values it is a lower bound, which makes the levels
        larger than exact ones.
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
