"""Shadowing of a Gaussian rough sea by itself: Smith's function, Saunders' factor, two legs, and the visible projected area.

With ``v`` the unit vector to the viewer, the projected area of facets turned to the viewer per unit area of sea is ::

    A+ = <max(0, v_z - v_h . s)>  =  m Phi(m/d) + d phi(m/d),      m = v_z - v_h . <s>,  d = |v_h| sigma_1

(``sigma_1`` the rms slope along the view azimuth). Only ``m`` of it can be seen, so the seen share is ``m/A+ = 1/(1 + Lambda)``.
``A+`` is smooth through the horizon, where it is ``sigma_1/sqrt(2 pi)`` (Zeisse 1995), and beyond it; ``Lambda`` is infinite there.

References
----------
Smith 1967, IEEE Trans. Antennas Propag. 15, 668 (Eqs. 21-24); Saunders 1967, J. Geophys. Res. 72, 4643;
Zeisse 1995, J. Opt. Soc. Am. A 12, 2022; Heitz 2014, J. Comput. Graph. Tech. 3 (2), 32.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from seaglint._jit import njit
from seaglint.errors import DomainError

FloatArray = NDArray[np.float64]


@njit
def visible_area_kernel(mean: float, deviation: float) -> float:
    """Mean of ``max(0, X)`` for a normal ``X`` of given mean and standard deviation: A+ with ``m`` and ``d`` of the module's formula."""
    if deviation <= 0.0:
        return max(mean, 0.0)
    x = mean / (math.sqrt(2.0) * deviation)
    if x > 6.0:  # the tail is below 1e-17 of the mean
        return mean
    area = 0.5 * mean * math.erfc(-x) + deviation / math.sqrt(2.0 * math.pi) * math.exp(-x * x)
    return max(area, 0.0)


@njit
def smith_lambda_kernel(nu: float) -> float:
    """Smith's Lambda for ``nu > 0``; infinite at and past the horizon (``nu <= 0``)."""
    if nu <= 0.0:
        return math.inf
    if nu > 6.0:  # below 1e-17
        return 0.0
    return max(0.5 * (math.exp(-nu * nu) / (nu * math.sqrt(math.pi)) - math.erfc(nu)), 0.0)


@njit
def bistatic_kernel(lambda_view: float, lambda_sun: float, relative_azimuth: float) -> float:
    """Share of facets both seen and lit; see :func:`bistatic`."""
    turn = 2.0 * math.pi
    angle = abs(relative_azimuth - turn * math.floor(relative_azimuth / turn + 0.5))
    passage = angle / (4.41 * angle + 1.0) * (4.41 * math.pi + 1.0) / math.pi
    small, large = min(lambda_view, lambda_sun), max(lambda_view, lambda_sun)
    if large == math.inf:
        return 0.0
    return 1.0 / (1.0 + large + passage * small)


@njit
def _map_lambda(nu: FloatArray, out: FloatArray) -> None:
    for i in range(nu.size):
        out[i] = smith_lambda_kernel(nu[i])


@njit
def _map_area(mean: FloatArray, deviation: FloatArray, out: FloatArray) -> None:
    for i in range(mean.size):
        out[i] = visible_area_kernel(mean[i], deviation[i])


@njit
def _map_bistatic(lambda_view: FloatArray, lambda_sun: FloatArray, azimuth: FloatArray, out: FloatArray) -> None:
    for i in range(out.size):
        out[i] = bistatic_kernel(lambda_view[i], lambda_sun[i], azimuth[i])


def _flat_broadcast(*arrays: ArrayLike) -> tuple[tuple[int, ...], list[FloatArray]]:
    """Broadcast shape and the raveled float64 copies."""
    parts = np.broadcast_arrays(*(np.asarray(a, dtype=np.float64) for a in arrays))
    # copies: broadcast views are read-only soon, and kernels are compiled for arrays that are not
    return parts[0].shape, [np.array(p, order="C").ravel() for p in parts]


def smith_lambda(nu: ArrayLike) -> FloatArray:
    """Smith's Lambda of a Gaussian surface.

    ``Lambda = [exp(-nu^2)/(nu sqrt(pi)) - erfc(nu)] / 2``

    Parameters
    ----------
    nu : array_like
        ``cot(zenith)/(sqrt(2) sigma_1)`` [1, any shape]; see :func:`smith_nu`.

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
    # a flat sea seen exactly along the horizon (0/0) is past it
    return np.asarray(np.where(np.isnan(nu) & ~np.isnan(theta + variance), -np.inf, nu))


def saunders(view_zenith: ArrayLike, mss_along: ArrayLike) -> FloatArray:
    """Saunders' shadowing factor of one leg, the seen share of facets turned to the viewer.

    ``S = 1/(1 + Lambda) = 2/[1 + erf(nu) + exp(-nu^2)/(nu sqrt(pi))]``

    Parameters
    ----------
    view_zenith : array_like
        Zenith angle of the direction to the viewer [rad].
    mss_along : array_like
        Slope variance along the view azimuth [1]; for an isotropic sea half of the total.

    Returns
    -------
    ndarray
        Factor in [0, 1]; 0 at and past the horizon.

    References
    ----------
    Saunders 1967, Eq. 9; Eq. 8 of the source article.

    Examples
    --------
    >>> import numpy as np
    >>> round(float(saunders(np.radians(85.0), 0.0316)), 5)
    0.71082
    """
    return np.asarray(1.0 / (1.0 + smith_lambda(smith_nu(view_zenith, mss_along))))


def bistatic(lambda_view: ArrayLike, lambda_sun: ArrayLike, relative_azimuth: ArrayLike) -> FloatArray:
    """Share of facets turned to both viewer and Sun that is seen by the one and lit by the other.

    ``S = 1/[1 + max(Lambda_v, Lambda_s) + a(phi) min(Lambda_v, Lambda_s)]``,
    ``a(phi) = [4.41 phi/(4.41 phi + 1)] / [4.41 pi/(4.41 pi + 1)]``

    On the same side (``phi = 0``) what is seen along the lower ray is lit by the higher one; at opposite azimuths the legs are
    independent given the height, ``1/(1 + Lambda_v + Lambda_s)``. The passage is that of van Ginneken et al., divided by its value
    at ``pi`` (0.933) so that the opposite side is Smith's exactly. Symmetric in viewer and Sun (reciprocal).

    Parameters
    ----------
    lambda_view, lambda_sun : array_like
        Smith's Lambda of the two legs [1].
    relative_azimuth : array_like
        Azimuth between the directions from the sea to the viewer and to the Sun [rad]; pi looking into the glint corridor.

    Returns
    -------
    ndarray
        Factor in [0, 1].

    References
    ----------
    van Ginneken, Stavridi and Koenderink 1998, Appl. Opt. 37, 130 (passage 4.41 phi/(4.41 phi + 1)); Ross, Dion and Potvin 2005,
    J. Opt. Soc. Am. A 22, 2442 (the two limits).
    """
    shape, (view, sun, azimuth) = _flat_broadcast(lambda_view, lambda_sun, relative_azimuth)
    out = np.empty_like(view)
    _map_bistatic(view, sun, azimuth, out)
    return out.reshape(shape)


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


def _require_variance(variance: FloatArray) -> None:
    if np.any(variance < 0.0):
        raise DomainError(f"slope variance = {float(np.min(variance)):g} is below 0; give variances of at least 0")
