"""Shadowing of a rough sea by itself: Smith's function, two legs, and the visible projected area.

With ``v`` the unit vector to the viewer, the projected area of facets turned to the viewer per unit area of sea is ::

    A+ = <max(0, v_z - v_h . s)> = m Phi(m/d) + d phi(m/d)
    m = v_z - v_h . <s>,  d = |v_h| sigma_1

(``sigma_1`` the rms slope along the view azimuth). Only ``m`` of it is visible, so the visible share is ``m/A+ = 1/(1 + Lambda)``.
``A+`` is smooth through the horizon, where it is ``sigma_1/sqrt(2 pi)`` (Zeisse 1995), and beyond it; ``Lambda`` is infinite there.

For a Gram-Charlier density the slope along any azimuth has a Gram-Charlier density too, of skewness ``h3`` and excess ``h4``
(:func:`visible_area`), and the integral stays closed,

    A+ = m Phi(x) + d phi(x) [1 + h3 x/6 + h4 (x^2 - 1)/24],      x = m/d.

Negative values of the series count as 0 in the density, and also in this area: their share of ``A+`` is a small function of ``x`` and the
azimuth, integrated once per set of coefficients and interpolated.

References
----------
Smith 1967, IEEE Trans. Antennas Propag. 15, 668 (Eqs. 21-24); Saunders 1967, J. Geophys. Res. 72, 4643;
Zeisse 1995, J. Opt. Soc. Am. A 12, 2022; Heitz 2014, J. Comput. Graph. Tech. 3 (2), 32.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError
from seaglint.base.jit import kernel, njit
from seaglint.sea.slopes.slope_statistics import SlopeStatistics, gram_charlier

#: Standard deviations to which negative values of a series are integrated; beyond, the density is below 1e-14 of its peak.
_REACH: Final = 8.0

_X_STEP: Final = 0.05
_TURNS: Final = 65
# With these steps the linear interpolation is within 4e-6 of A+ above the horizon; see the tests.


class _Series(NamedTuple):
    """Gram-Charlier series of normalised slopes, as the kernel reads it."""

    deviation_up: float
    deviation_cross: float
    coefficients: FloatArray  #: Gram-Charlier coefficients (c21, c03, c40, c22, c04) [1].
    mass: float  #: Mass added by setting negative values of the series to 0 [1].
    mean: float  #: First moment of the added mass towards where the wind comes FROM, in standard deviations [1].
    table: FloatArray  #: Share of the added mass in ``A+/d`` against angle (0..pi, rows) and ``x`` [1].


@kernel
def visible_area_kernel(mean: float, deviation: float) -> float:
    """Mean of ``max(0, X)`` for a normal ``X`` of given mean and standard deviation: A+ with ``m`` and ``d`` of the module's formula."""
    if deviation <= 0.0:
        return max(mean, 0.0)
    # with this x, erfc(-x)/2 is Phi(m/d)
    x = mean / (math.sqrt(2.0) * deviation)
    if x > 6.0:  # the tail is below 1e-17 of the mean
        return mean
    area = 0.5 * mean * math.erfc(-x) + deviation / math.sqrt(2.0 * math.pi) * math.exp(-x * x)
    return max(area, 0.0)


def _area_series() -> FloatArray:
    """Function ``G = x Phi + phi`` and its derivatives ``Phi, phi/2, -x phi/6`` at even nodes from -6 to 4 [(nodes, 4)]."""
    from scipy.special import ndtr

    x = np.linspace(-6.0, 4.0, 10 * _NODES_PER_DEVIATION + 1)
    phi = np.exp(-0.5 * x * x) / math.sqrt(2.0 * math.pi)
    return np.stack([x * ndtr(x) + phi, ndtr(x), 0.5 * phi, -x * phi / 6.0], axis=1)


_NODES_PER_DEVIATION: Final = 16
_AREA_SERIES: Final = _area_series()


@kernel
def quick_visible_area_kernel(mean: float, deviation: float) -> float:
    """Approximation of ``visible_area_kernel`` for inner loops: within 1e-5 from 4 deviations below the edge up, 0 from 6 below."""
    if mean >= 4.0 * deviation:
        return mean
    x = (mean / deviation + 6.0) * _NODES_PER_DEVIATION
    if x <= 0.0:
        return 0.0
    i = int(x + 0.5)
    h = (x - i) / _NODES_PER_DEVIATION
    g, slope, bend, twist = _AREA_SERIES[i, 0], _AREA_SERIES[i, 1], _AREA_SERIES[i, 2], _AREA_SERIES[i, 3]
    return float(deviation * (g + h * (slope + h * (bend + h * twist))))


@kernel
def smith_lambda_kernel(nu: float) -> float:
    """Smith's Lambda for ``nu > 0``; infinite at and past the horizon (``nu <= 0``)."""
    if nu <= 0.0:
        return math.inf
    if nu > 6.0:  # below 1e-17
        return 0.0
    return max(0.5 * (math.exp(-nu * nu) / (nu * math.sqrt(math.pi)) - math.erfc(nu)), 0.0)


@kernel
def leg_passage_kernel(relative_azimuth: float) -> float:
    """Weight ``a`` of the second leg's own shadows [1], 0 for legs on one side to 1 for opposite sides.

    The share of the facets turned to both viewer and Sun that is visible to the one and lit by the other is

    ``S = 1/[1 + max(Lambda_v, Lambda_s) + a(phi) min(Lambda_v, Lambda_s)]``,
    ``a(phi) = [4.41 phi/(4.41 phi + 1)] / [4.41 pi/(4.41 pi + 1)]``

    On the same side (``phi = 0``) facets that the lower ray reaches are reached by the higher one; at opposite azimuths the legs are
    independent given the height, ``1/(1 + Lambda_v + Lambda_s)``. The passage follows van Ginneken et al., divided by its value
    at ``pi`` (0.933) so that the opposite side is Smith's exactly. Symmetric in viewer and Sun (reciprocal).

    References
    ----------
    van Ginneken, Stavridi and Koenderink 1998, Appl. Opt. 37, 130 (passage 4.41 phi/(4.41 phi + 1)); Ross, Dion and Potvin 2005,
    J. Opt. Soc. Am. A 22, 2442 (the two limits).
    """
    turn = 2.0 * math.pi
    angle = abs(relative_azimuth - turn * math.floor(relative_azimuth / turn + 0.5))
    return angle / (4.41 * angle + 1.0) * (4.41 * math.pi + 1.0) / math.pi


@njit
def _map_lambda(nu: FloatArray, out: FloatArray) -> None:
    for i in range(nu.size):
        out[i] = smith_lambda_kernel(nu[i])


@njit
def _map_area(mean: FloatArray, deviation: FloatArray, out: FloatArray) -> None:
    for i in range(mean.size):
        out[i] = visible_area_kernel(mean[i], deviation[i])


def _flat_broadcast(*arrays: ArrayLike) -> tuple[tuple[int, ...], list[FloatArray]]:
    """Return the broadcast shape and the flattened float64 copies."""
    parts = np.broadcast_arrays(*(np.asarray(a, dtype=np.float64) for a in arrays))
    # copies: broadcast views will become read-only in NumPy, and kernels are compiled for writable arrays
    return parts[0].shape, [np.array(p, order="C").ravel() for p in parts]


def smith_lambda(nu: ArrayLike) -> FloatArray:
    """Smith's Lambda of a Gaussian surface.

    ``Lambda = [exp(-nu^2)/(nu sqrt(pi)) - erfc(nu)] / 2``

    Parameters
    ----------
    nu : array_like
        ``cot(zenith)/(sqrt(2) sigma_1)`` [1, any shape]; see ``smith_nu``.

    Returns
    -------
    ndarray
        Lambda [1]; infinite where ``nu <= 0`` (at and past the horizon).

    References
    ----------
    Smith 1967, Eq. 23.
    """
    shape, (flat_nu,) = _flat_broadcast(nu)
    out = np.empty_like(flat_nu)
    _map_lambda(flat_nu, out)
    return out.reshape(shape)


def smith_nu(zenith: ArrayLike, mss_along: ArrayLike) -> FloatArray:
    """Argument of Smith's function, ``cot(zenith)/(sqrt(2 mss_along))`` [1]; infinite for a flat sea above the horizon."""
    theta = np.asarray(zenith, dtype=np.float64)
    variance = np.asarray(mss_along, dtype=np.float64)
    _require_variance(variance)
    cosine, sine = np.cos(theta), np.sin(theta)
    with np.errstate(divide="ignore", invalid="ignore"):
        nu = cosine / (sine * np.sqrt(2.0 * variance))
    # a flat sea viewed exactly along the horizon (0/0) is past it
    return np.asarray(np.where(np.isnan(nu) & ~np.isnan(theta + variance), -np.inf, nu))


def projected_area(view_zenith: ArrayLike, mss_along: ArrayLike) -> FloatArray:
    """Projected area of the facets turned to the viewer, per unit area of sea.

    ``A+ = cos(theta) (1 + Lambda) = cos(theta) [1 + erf(nu)]/2 + sin(theta) sigma_1 exp(-nu^2)/sqrt(2 pi)``

    Parameters
    ----------
    view_zenith : array_like
        Zenith angle of the direction to the viewer [rad]; beyond pi/2 too.
    mss_along : array_like
        Slope variance along the view azimuth [1].

    Returns
    -------
    ndarray
        Area [1]; at the horizon ``sigma_1/sqrt(2 pi)``, above 0 a little past it.

    References
    ----------
    Zeisse 1995 ("ergodic area"); Heitz 2014, Eq. 7.
    """
    theta = np.asarray(view_zenith, dtype=np.float64)
    variance = np.asarray(mss_along, dtype=np.float64)
    _require_variance(variance)
    shape, (mean, deviation) = _flat_broadcast(np.cos(theta), np.sin(theta) * np.sqrt(variance))
    out = np.empty_like(mean)
    _map_area(mean, deviation, out)
    return out.reshape(shape)


@lru_cache(maxsize=64)
def _clipping(coefficients: tuple[float, float, float, float, float]) -> tuple[float, float, FloatArray]:
    """Mass, first moment and table of the negative part of a series; see ``_Series``.

    Where the wind's direction and the view's part by ``psi`` on the plane of normalised slopes, the slope along the view over its
    rms value is ``z = xi sin(psi) - eta cos(psi)``, and the table holds the integral of ``negative part * max(0, x - z)``.
    """
    step = 0.04
    axis = np.arange(-_REACH + 0.5 * step, _REACH, step)
    xi, eta = np.meshgrid(axis, axis)
    negative = np.exp(-0.5 * (xi * xi + eta * eta)) / (2.0 * np.pi) * np.maximum(-gram_charlier(xi, eta, coefficients), 0.0) * step * step
    inside = (negative > 0.0) & (xi * xi + eta * eta < _REACH**2)
    xi, eta, negative = xi[inside], eta[inside], negative[inside]
    count = round(2.0 * _REACH / _X_STEP) + 3  # a node to spare on each side
    table = np.empty((_TURNS, count))
    for row, psi in enumerate(np.linspace(0.0, np.pi, _TURNS)):
        # slopes of the negative part along the view, as cells of the table
        place = (xi * np.sin(psi) - eta * np.cos(psi) + _REACH) / _X_STEP + 1.0
        cell = np.floor(place).astype(np.intp)
        beyond = place - cell
        # split between two nodes, which keeps mass and mean; the two sums integrate twice
        density = np.bincount(cell, negative * (1.0 - beyond), count) + np.bincount(cell + 1, negative * beyond, count)[:count]
        table[row, 0] = 0.0
        table[row, 1:] = _X_STEP * np.cumsum(np.cumsum(density))[:-1]
    table.setflags(write=False)
    return float(negative.sum()), float((negative * eta).sum()), table


@kernel
def _series_area_kernel(zenith: float, turn: float, series: _Series) -> float:
    """Visible area A+ of a Gram-Charlier density from ``zenith`` at an azimuth ``turn`` from the wind's."""
    cosine, sine = math.cos(zenith), math.sin(zenith)
    up, cross = series.deviation_up * math.cos(turn), series.deviation_cross * abs(math.sin(turn))
    sigma = math.hypot(up, cross)
    p, q = up / sigma, cross / sigma
    deviation = sigma * sine
    area = visible_area_kernel(cosine, deviation)
    if deviation < 1e-12:
        return area + series.mass * max(cosine, 0.0)
    # skewness h3 and excess h4 of the slope along the view, as in the module's text
    x = cosine / deviation
    c = series.coefficients
    if abs(x) < 30.0:
        h3 = p * (p * p * c[1] + 3.0 * q * q * c[0])
        h4 = p**4 * c[4] + 6.0 * p * p * q * q * c[3] + q**4 * c[2]
        density = math.exp(-0.5 * x * x) / math.sqrt(2.0 * math.pi)
        area += deviation * density * (h3 * x / 6.0 + h4 * (x * x - 1.0) / 24.0)
    if x >= _REACH:  # all of the negative part is on the visible side
        return area + series.mass * cosine + deviation * p * series.mean
    if x > -_REACH:
        row, column = math.atan2(q, p) / math.pi * (_TURNS - 1), (x + _REACH) / _X_STEP + 1.0
        i, j = min(int(row), _TURNS - 2), min(int(column), series.table.shape[1] - 2)
        f, g = row - i, column - j
        low = (1.0 - g) * series.table[i, j] + g * series.table[i, j + 1]
        high = (1.0 - g) * series.table[i + 1, j] + g * series.table[i + 1, j + 1]
        area += deviation * ((1.0 - f) * low + f * high)
    return max(area, 0.0)


@njit
def _map_series_area(zenith: FloatArray, turn: FloatArray, series: _Series, out: FloatArray) -> None:
    for i in range(out.size):
        out[i] = _series_area_kernel(zenith[i], turn[i], series)


def visible_area(view_zenith: ArrayLike, view_azimuth: ArrayLike, slopes: SlopeStatistics) -> FloatArray:
    r"""Projected area of the facets turned to the viewer, per unit area of sea, over any slope density.

    .. math::

        A_+ = \int p(s) \max(0, v_z - v_h \cdot s) ds

    In closed form: with ``P = sigma_u cos(turn)/sigma_1``, ``Q = sigma_c sin(turn)/sigma_1``, ``turn`` the azimuth from the direction
    the wind blows TO, the slope along the view has ``h3 = P (P^2 c03 + 3 Q^2 c21)`` and ``h4 = P^4 c04 + 6 P^2 Q^2 c22 + Q^4 c40``;
    the area follows as in the module's text. It is the integral of exactly ``SlopeStatistics.density``, negative parts at 0.

    Parameters
    ----------
    view_zenith : array_like
        Zenith angle of the direction from the sea to the viewer [rad]; beyond pi/2 too.
    view_azimuth : array_like
        Azimuth of that direction, clockwise from north [rad]; broadcast against ``view_zenith``.
    slopes : SlopeStatistics
        Gaussian or not.

    Returns
    -------
    ndarray
        Area [1], broadcast shape. Reflected radiance is ``rho p E/(4 cos^4(beta) A+)`` for one shadowed leg.

    Notes
    -----
    Within 1e-5 of the integral above the horizon; past it to 1e-6 of ``sigma_1``, where the whole area soon vanishes.

    References
    ----------
    Zeisse 1995 ("ergodic area"); Cox and Munk 1954, Eq. 18.
    """
    zenith, azimuth = np.asarray(view_zenith, dtype=np.float64), np.asarray(view_azimuth, dtype=np.float64)
    shape = np.broadcast_shapes(zenith.shape, azimuth.shape)
    if slopes.is_isotropic:  # of the zenith angle alone, which may be one per row
        return np.array(np.broadcast_to(projected_area(zenith, slopes.mss_up), shape))
    if slopes.is_gaussian:
        return projected_area(zenith, slopes.mss_along(azimuth))
    mass, mean, table = _clipping(slopes.coefficients)
    series = _Series(math.sqrt(slopes.mss_up), math.sqrt(slopes.mss_cross), np.array(slopes.coefficients), mass, mean, table)
    _, (flat_zenith, turn) = _flat_broadcast(zenith, azimuth - slopes.wind_to_azimuth)
    out = np.empty_like(flat_zenith)
    _map_series_area(flat_zenith, turn, series, out)
    return out.reshape(shape)


def _require_variance(variance: FloatArray) -> None:
    if np.any(variance < 0.0):
        raise DomainError(
            f"slope variance = {float(np.min(variance)):g} is below 0; give variances of at least 0",
            name="slope_variance",
            value=float(np.min(variance)),
            allowed="0 or more",
        )
