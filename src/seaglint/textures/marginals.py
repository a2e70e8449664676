"""Marginal transforms for long tails: pixels of a Gaussian field become gamma, lognormal, K or empirical values.

``x = Q(Phi(g))`` with g standard normal and Q the required quantiles. With the Hermite polynomials He_n,
``x = sum_n c_n He_n(g)``, ``c_n = E[x He_n(g)] / n!`` by Gauss-Hermite quadrature, so two pixels with correlation r of the Gaussian field
have, of the output, the correlation ``R(r) = sum_(n>0) c_n² n! r^n / sum_(n>0) c_n² n!`` (Price 1958; Liu and Munk 1946). R is inverted, so
that the output has the required correlation; the share of the variance in the omitted terms is stated.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any, Final, Literal, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError, DomainError
from seaglint.base.free_form import JsonObject
from seaglint.base.jit import in_threads, njit

Tails = Literal["gaussian", "gamma", "lognormal", "k", "empirical"]
TAILS: Final[tuple[Tails, ...]] = get_args(Tails)

#: Number of Hermite polynomials of the expansion; a gamma distribution of shape 1/2 leaves 1e-7 of its variance in the others.
TERMS: Final = 24

NODES: Final = 120  #: Number of nodes of the Gauss-Hermite quadrature.

#: Range of the table of quantiles, -REACH to REACH standard deviations; 1e-12 of the values lie beyond and take the table's ends.
REACH: Final = 7.0

#: Number of points of the table, linear between them: error below 1e-5 of the standard deviation for a gamma of shape 1/2.
TABLE: Final = 4097

EMPIRICAL: Final = 512  #: Number of quantiles of an empirical distribution.

#: Quantiles between which a family is fitted, so that a few values of a target or a bad pixel do not determine the tail.
INNER: Final = (0.0005, 0.9995)


@njit
def _interpolate(g: np.ndarray, table: np.ndarray, out: np.ndarray, first: int, end: int) -> None:
    last = table.size - 1
    scale = np.float32(last / (2.0 * REACH))
    for i in range(first, end):
        place = (g[i] + np.float32(REACH)) * scale
        k = int(place)
        k = 0 if place < 0.0 else (last - 1 if k >= last else k)
        share = min(max(place - np.float32(k), np.float32(0.0)), np.float32(1.0))
        out[i] = table[k] + share * (table[k + 1] - table[k])


@dataclass(frozen=True)
class Marginal:
    """Distribution of a pixel.

    Raises
    ------
    DomainError
        An unknown kind, or parameters outside their range.
    """

    kind: Tails = "gaussian"  #: One of ``TAILS``.
    loc: float = 0.0  #: Location of the family [u].
    scale: float = 1.0  #: Scale of the family [u]; below 0 it reverses it: a long tail on the dark side.
    shape: float | None = None  #: Shape of gamma (k), lognormal (s of the logarithm) and K (v); None for the others.
    #: Quantiles of the empirical distribution at evenly spaced standard normal values from -4 to 4, in units of ``scale`` about ``loc``.
    quantiles: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        if self.kind not in TAILS:
            raise DomainError(f"tails = {self.kind!r}; allowed are {', '.join(TAILS)}")
        if not (math.isfinite(self.loc) and math.isfinite(self.scale) and self.scale != 0.0):
            raise DomainError(f"loc = {self.loc:g}, scale = {self.scale:g}: give finite numbers, the scale not 0")
        if self.kind in ("gamma", "lognormal", "k") and not (self.shape is not None and math.isfinite(self.shape) and self.shape > 0.0):
            raise DomainError(f"shape = {self.shape}: a {self.kind} distribution has one above 0")
        if self.kind == "empirical" and (len(self.quantiles) < 16 or np.any(np.diff(self.quantiles) < 0.0)):
            raise DomainError("quantiles: give at least 16 values of an empirical distribution in rising order")

    def __call__(self, g: ArrayLike) -> FloatArray:
        """Values of the pixels whose Gaussian field is g standard deviations above its mean [u], shape of g."""
        u = np.asarray(g, np.float64)
        return self.loc + self.scale * (_standard(self)(u if self.scale > 0.0 else -u))

    @cached_property
    def table(self) -> NDArray[np.float32]:
        """Values at evenly spaced g from -7 to 7 [u]."""
        return self(np.linspace(-REACH, REACH, TABLE)).astype(np.float32)

    def transform(self, g: NDArray[np.float32]) -> NDArray[np.float32]:
        """Transform by the table, in place and in threads [u]: same bytes for any number of them."""
        if self.kind == "gaussian":
            g *= np.float32(self.scale)
            g += np.float32(self.loc)
            return g
        flat, table = g.reshape(-1), self.table
        in_threads(lambda part: _interpolate(flat, table, flat, *part), flat.size)
        return g

    def gaussian(self, values: ArrayLike) -> FloatArray:
        """Standard normal values that the transform maps to ``values`` [1]; those beyond the table take its ends."""
        grid = np.linspace(-REACH, REACH, TABLE)
        table = self(grid)
        # Interpolation needs rising values: equal ones at the ends of the table are taken once.
        rising, places = np.unique(table, return_index=True)
        return np.interp(np.asarray(values, np.float64), rising, grid[places])

    def log_slope(self, g: ArrayLike) -> FloatArray:
        """Logarithm of ``dx/dg`` [log u], by which densities of pixels differ from the Gaussian field's."""
        step = 1e-3
        u = np.asarray(g, np.float64)
        return np.log(np.maximum((self(u + step) - self(u - step)) / (2.0 * step), 1e-300))

    @cached_property
    def hermite(self) -> FloatArray:
        """Hermite coefficients ``c_n sqrt(n!)`` for n = 0 ...

        ``TERMS`` [u]: mean, then amplitudes whose squares sum to the variance.
        """
        nodes, weights = np.polynomial.hermite_e.hermegauss(NODES)
        weights = weights / weights.sum()
        values = self(nodes) * weights
        before, now = np.zeros(NODES), np.ones(NODES)
        out = np.empty(TERMS + 1)
        for n in range(TERMS + 1):
            out[n] = float(values @ now)
            # Normalised polynomials he_n = He_n / sqrt(n!), which do not overflow.
            before, now = now, (nodes * now - math.sqrt(n) * before) / math.sqrt(n + 1)
        return out

    @cached_property
    def variance(self) -> float:
        """Variance of a pixel [u²], by quadrature."""
        nodes, weights = np.polynomial.hermite_e.hermegauss(NODES)
        values = self(nodes)
        weights = weights / weights.sum()
        return float(weights @ (values - weights @ values) ** 2)

    @property
    def mean(self) -> float:
        """Mean of a pixel [u]."""
        return float(self.hermite[0])

    @property
    def truncation(self) -> float:
        """Share of the variance in the truncated terms of the expansion [1], a bound of the error of correlations."""
        return max(1.0 - float((self.hermite[1:] ** 2).sum()) / self.variance, 0.0)

    def output_correlation(self, latent: ArrayLike) -> FloatArray:
        """Correlation of two pixels whose Gaussian fields have the correlation ``latent`` [1], shape of it."""
        weights = self.hermite[1:] ** 2
        return np.asarray(
            np.polynomial.polynomial.polyval(np.asarray(latent, np.float64), np.concatenate([[0.0], weights / weights.sum()]))
        )

    def latent_correlation(self, output: ArrayLike) -> FloatArray:
        """Correlation of the Gaussian field for a given correlation ``output`` of the pixels [1], shape of it.

        Correlations below the distribution's lower limit (-0.64 for a gamma of shape 1) give the latent correlation -1.

        Examples
        --------
        >>> gamma = Marginal("gamma", shape=1.0)
        >>> round(float(gamma.output_correlation(gamma.latent_correlation(0.5))), 6)
        0.5
        """
        grid = np.sin(np.linspace(-0.5 * np.pi, 0.5 * np.pi, 4001))
        rising, places = np.unique(np.maximum.accumulate(self.output_correlation(grid)), return_index=True)
        return np.interp(np.asarray(output, np.float64), rising, grid[places])

    def to_dict(self) -> JsonObject:
        """Return the distribution as values for JSON."""
        result: JsonObject = {"kind": self.kind, "loc": self.loc, "scale": self.scale}
        if self.shape is not None:
            result["shape"] = self.shape
        if self.quantiles:
            result["quantiles"] = list(self.quantiles)
        return result

    @classmethod
    def from_dict(cls, values: Mapping[str, Any]) -> Marginal:
        """Read the output of :meth:`to_dict`."""
        shape = values.get("shape")
        quantiles = tuple(map(float, values.get("quantiles", ())))
        return cls(values["kind"], float(values["loc"]), float(values["scale"]), None if shape is None else float(shape), quantiles)


def _standard(marginal: Marginal) -> Callable[[FloatArray], FloatArray]:
    """Quantiles of the family with loc 0 and scale 1, of standard normal values."""
    from scipy import special

    kind, shape = marginal.kind, float(marginal.shape or 0.0)
    if kind == "gaussian":
        return lambda g: g
    if kind == "lognormal":
        return lambda g: np.exp(shape * g)
    if kind == "gamma":
        # Both tails by the smaller probability, which keeps its digits.
        return lambda g: np.where(g < 0.0, special.gammaincinv(shape, special.ndtr(g)), special.gammainccinv(shape, special.ndtr(-g)))
    if kind == "k":
        return _k_quantiles(shape)
    knots = np.linspace(-4.0, 4.0, len(marginal.quantiles))
    values = np.array(marginal.quantiles)
    ends = [_tail_slope(knots, values, -1), _tail_slope(knots, values, 1)]

    def empirical(g: FloatArray) -> FloatArray:
        inside = np.interp(g, knots, values)
        # Beyond the data the quantiles continue as a straight line: a Gaussian tail of their own slope.
        return np.asarray(inside + ends[1] * np.maximum(g - 4.0, 0.0) + ends[0] * np.minimum(g + 4.0, 0.0))

    return empirical


def _tail_slope(knots: FloatArray, values: FloatArray, side: int) -> float:
    outer = side * knots > 2.5
    return max(float(np.polyfit(knots[outer], values[outer], 1)[0]), 0.0)


@lru_cache(maxsize=256)
def _k_quantiles(shape: float) -> Callable[[FloatArray], FloatArray]:
    """Quantiles of the K distribution of one look, an exponential whose mean is gamma distributed.

    ``P(above x) = 2 x^(v/2) K_v(2 sqrt x) / Gamma(v)`` (Ward, Tough and Watts 2006, Eq. 4.6).
    """
    from scipy import special

    x = np.exp(np.linspace(math.log(1e-14), math.log(4e3 * max(shape, 1.0)), 6_000))
    root = 2.0 * np.sqrt(x)
    log_above = math.log(2.0) + 0.5 * shape * np.log(x) + np.log(special.kve(shape, root)) - root - special.gammaln(shape)
    # A probability falls with x; rounding near 1 must not raise it.
    log_above = np.minimum.accumulate(np.minimum(log_above, -1e-16))
    g = np.where(log_above < -math.log(2.0), -special.ndtri_exp(log_above), special.ndtri(-np.expm1(log_above)))
    rising, places = np.unique(g, return_index=True)
    finite = np.isfinite(rising)
    log_x = np.log(x)[places]
    return lambda value: np.asarray(np.exp(np.interp(value, rising[finite], log_x[finite])))


def fit_marginal(values: ArrayLike, tails: Tails) -> Marginal:
    """Fit a family with location and scale to the quantiles of the data, by least squares.

    Parameters
    ----------
    values : array_like
        Pixels [u], of any correlation; NaN are left out.
    tails : str
        One of ``TAILS``.

    Returns
    -------
    Marginal
        Turned over where that is nearer: data with their tail on the dark side.

    Raises
    ------
    DataError
        Values that are all equal, or none.
    DomainError
        An unknown kind.
    """
    from scipy import special
    from scipy.optimize import minimize_scalar

    x = np.asarray(values, np.float64).ravel()
    x = x[np.isfinite(x)]
    mean, std = (float(x.mean()), float(x.std())) if x.size else (0.0, 0.0)
    if not std > 0.0:
        raise DataError("all values are equal: there is no distribution to fit; choose another region")
    if tails == "gaussian":
        return Marginal("gaussian", mean, std)
    if tails not in TAILS:
        raise DomainError(f"tails = {tails!r}; allowed are {', '.join(TAILS)}")
    if tails == "empirical":
        knots = np.linspace(-4.0, 4.0, EMPIRICAL)
        return Marginal("empirical", mean, std, None, tuple(map(float, (np.quantile(x, special.ndtr(knots)) - mean) / std)))
    # Even steps of probability, and more of them in both tails.
    g = np.linspace(float(special.ndtri(INNER[0])), float(special.ndtri(INNER[1])), 600)
    weight = np.exp(-0.25 * g**2)
    measured = np.quantile(x, special.ndtr(g))

    def distance(log_shape: float, side: int) -> tuple[float, Marginal]:
        basis = Marginal(tails, 0.0, float(side), math.exp(log_shape))(g)
        centre = np.average(basis, weights=weight)
        slope = float(np.average((basis - centre) * measured, weights=weight) / np.average((basis - centre) ** 2, weights=weight))
        loc = float(np.average(measured, weights=weight) - slope * centre)
        error = float(np.average((measured - loc - slope * basis) ** 2, weights=weight))
        return (error, Marginal(tails, loc, side * slope, math.exp(log_shape))) if slope > 0.0 else (math.inf, Marginal())

    # Gamma and K down to a shape of 0.05; the lognormal's s is small where the tail is short.
    low, high = (math.log(0.01), math.log(2.0)) if tails == "lognormal" else (math.log(0.05), math.log(400.0))
    candidates = []
    for side in (1, -1):
        grid = np.linspace(low, high, 25)
        best = int(np.argmin([distance(s, side)[0] for s in grid]))
        bounds = (grid[max(best - 1, 0)], grid[min(best + 1, 24)])
        place = minimize_scalar(lambda s, side=side: distance(s, side)[0], bounds=bounds, method="bounded").x
        candidates.append(distance(float(place), side))
    return min(candidates, key=lambda pair: pair[0])[1]
