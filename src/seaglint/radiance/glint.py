r"""Share of the viewed sea that mirrors the Sun, with the Sun a disc.

A point of the sea shows the Sun or it does not. Seen from the direction **v**, facets that mirror the direction **l** have the slope

.. math:: s = -\frac{v_h + l_h}{v_z + l_z}

and the share of the visible projected area that mirrors the solar disc is

.. math:: P = \int_{disc} \frac{p(s)\,S}{4 \cos^4\beta\,\cos\theta_v}\,d\Omega_l

A mirroring point shows :math:`\rho E / (\pi \epsilon^2)`. For a density much wider than the disc's image this is Eq. 8 of the source
article, ``rho p S E / (4 cos^4(beta) cos(theta_v))``; for a calm sea, where that formula exceeds any possible value, P is the
integral of the visible density over the disc and never above 1.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal, Protocol

import numpy as np
from numpy.typing import ArrayLike

from seaglint.constants import SOLAR_ANGULAR_RADIUS
from seaglint.conventions import FloatArray, unit_vector
from seaglint.errors import DomainError
from seaglint.sea.shadowing import bistatic, projected_area, smith_lambda, smith_nu
from seaglint.sea.slopes import SlopeStatistics

Shadowing = Literal["both", "viewer"]
"""Legs that waves shadow: viewer and Sun, or the viewer's alone (the source article)."""

_FLOOR: Final = 1e-3 * SOLAR_ANGULAR_RADIUS
"""Least rms slope of the quadrature [1]: a mirror gets an edge of 0.2 % of the Sun's radius and needs no formula of its own."""

_THINNEST: Final = 0.02
"""Least ratio of the two rms slopes: at the roughest slopes without wind, 0.055, half of the Sun's radius in slopes."""

_BROAD: Final = 0.4
"""Image of the Sun's radius in slopes over the rms slope, below which seven points on the disc are exact to 1e-3 even at 4 sigma."""

_WINDOW: Final = 6.0  # standard deviations of a narrow density that are integrated; the rest holds 2e-9
_GAUSS_X, _GAUSS_W = np.polynomial.legendre.leggauss(24)

# Disc of radius 1, exact for polynomials of degree 5 (Abramowitz and Stegun 25.4.61): centre and a hexagon.
_HEX_ANGLE = np.arange(6) * np.pi / 3.0
_HEX_X = np.concatenate([[0.0], np.sqrt(2.0 / 3.0) * np.cos(_HEX_ANGLE)])
_HEX_Y = np.concatenate([[0.0], np.sqrt(2.0 / 3.0) * np.sin(_HEX_ANGLE)])
_HEX_W = np.array([0.25] + 6 * [0.125])

_NEGLIGIBLE: Final = 9.0
"""Rms slopes beyond which the density is nothing (3e-18 of its peak) and no integral is taken."""

# Pixels taken at a time, so that their points stay near the processor: 7 and 576 points each.
_WIDE_CHUNK: Final = 8192
_NARROW_CHUNK: Final = 512


class SlopeDensity(Protocol):
    """A density of slopes, by position."""

    def __call__(self, slope_east: ArrayLike, slope_north: ArrayLike, /) -> FloatArray:
        """Density [1/slope²] of slopes (east, north), broadcast."""
        ...


@dataclass(frozen=True)
class Glint:
    """What the mirrored Sun needs at each pixel.

    Attributes
    ----------
    chance : ndarray
        P, share of the viewed area that mirrors the visible part of the Sun [1].
    cos_incidence : ndarray
        Cosine of the angle of incidence on the mirroring facets [1].
    """

    chance: FloatArray
    cos_incidence: FloatArray


def visible_sun(solar_zenith: float) -> tuple[float, float]:
    """Fraction of the disc above the horizon, and the zenith angle of that part's centroid [rad].

    A Sun cut by the horizon is cut. The zenith angle is the apparent one, at the sea. A Sun wholly below gives (0, solar_zenith).

    >>> visible_sun(1.0)
    (1.0, 1.0)
    """
    radius = SOLAR_ANGULAR_RADIUS
    chord = (solar_zenith - 0.5 * np.pi) / radius  # the horizon's height above the disc's centre, in radii
    if chord <= -1.0:
        return 1.0, float(solar_zenith)
    if chord >= 1.0:
        return 0.0, float(solar_zenith)
    rest = np.sqrt(1.0 - chord * chord)
    area = np.arccos(chord) - chord * rest
    centroid = 2.0 / 3.0 * rest**3 / area
    return float(area / np.pi), float(solar_zenith - radius * centroid)


def direction(zenith: ArrayLike, azimuth: ArrayLike) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Unit vector (east, north, up) of a zenith angle and an azimuth [rad], broadcast."""
    z = np.asarray(zenith, dtype=np.float64)
    east, north = unit_vector(azimuth)
    return np.sin(z) * east, np.sin(z) * north, np.cos(z) + 0.0 * east


def _floored(slopes: SlopeStatistics) -> SlopeStatistics:
    """The same statistics with no variance below the floor, so that mirrors have a density, nor one far below the other.

    Slopes along one direction only (directional fits without wind) would leave the quadrature's window, which is set up and down the disc.
    """
    least = max(_FLOOR**2, _THINNEST**2 * max(slopes.mss_up, slopes.mss_cross))
    if min(slopes.mss_up, slopes.mss_cross) >= least:
        return slopes
    return SlopeStatistics(max(slopes.mss_up, least), max(slopes.mss_cross, least), slopes.wind_to_azimuth)


def glint(
    view_zenith: ArrayLike,
    view_azimuth: ArrayLike,
    solar_zenith: float,
    solar_azimuth: float,
    slopes: SlopeStatistics,
    shadowing: Shadowing = "both",
) -> Glint:
    """Share of the viewed sea that mirrors the Sun to the viewer, and the incidence there.

    Parameters
    ----------
    view_zenith : array_like
        Zenith angle of the direction from the sea to the sensor [rad], 0..pi/2; broadcast against ``view_azimuth``.
    view_azimuth : array_like
        Azimuth of the direction from the sea to the sensor [rad]: that of the line of sight plus pi.
    solar_zenith, solar_azimuth : float
        Direction from the sea to the Sun's centre [rad]; below the horizon is valid: no glint.
    slopes : SlopeStatistics
        Slopes of the sea; a flat one mirrors the disc itself.
    shadowing : {"both", "viewer"}
        Legs that are shadowed.

    Returns
    -------
    Glint
        Arrays of the broadcast shape; ``chance`` is 0 for a Sun below the horizon.

    Raises
    ------
    DomainError
        View zeniths outside 0..pi/2.

    Notes
    -----
    Where the disc's image in the slope plane is small against the rms slope, seven points on the disc; elsewhere, and for a Sun cut by
    the horizon, 24 x 24 Gauss points on that part of the disc where the density is not negligible. Shadowing of the Sun's leg is
    taken at the middle of the visible part of the disc.

    References
    ----------
    Source article Eqs. 8 and 12; Cox and Munk 1954, J. Opt. Soc. Am. 44, 838.
    """
    theta, azimuth = np.asarray(view_zenith, dtype=np.float64), np.asarray(view_azimuth, dtype=np.float64)
    if not np.all((theta >= 0.0) & (theta <= 0.5 * np.pi)):
        raise DomainError("view_zenith must lie in 0..pi/2 rad: the direction from the sea to the sensor")
    shape = np.broadcast_shapes(theta.shape, azimuth.shape)
    share, centroid = visible_sun(solar_zenith)
    if share == 0.0:
        return Glint(np.zeros(shape), np.zeros(shape))
    sea = _floored(slopes)
    v = tuple(np.broadcast_to(c, shape).ravel() for c in direction(theta, azimuth))
    sun = direction(centroid, solar_azimuth)
    # cos(2 w) = v.l; the floor only keeps exact grazing from dividing by zero.
    cos_incidence = np.sqrt(np.clip(0.5 * (1.0 + v[0] * sun[0] + v[1] * sun[1] + v[2] * sun[2]), 1e-18, 1.0))

    # Image of the Sun's radius in slopes, its long half axis: eps/(2 cos w), over the square of the facet's upward cosine.
    upward = (v[2] + sun[2]) / (2.0 * cos_incidence)
    image = SOLAR_ANGULAR_RADIUS / (2.0 * cos_incidence * upward**2)
    slope = np.sqrt(np.maximum(1.0 / upward**2 - 1.0, 0.0))
    possible = slope - 2.0 * image < _NEGLIGIBLE * np.sqrt(max(sea.mss_up, sea.mss_cross))
    broad = (image < _BROAD * np.sqrt(min(sea.mss_up, sea.mss_cross))) & (share == 1.0)
    integral = np.zeros(cos_incidence.size)
    for rule, pixels, chunk in ((_wide, broad, _WIDE_CHUNK), (_narrow, ~broad, _NARROW_CHUNK)):
        wanted = np.flatnonzero(pixels & possible)
        for start in range(0, wanted.size, chunk):
            pick = wanted[start : start + chunk]
            integral[pick] = rule(tuple(c[pick] for c in v), cos_incidence[pick], solar_zenith, solar_azimuth, sea)
    chance = integral.reshape(shape) * _visibility(theta, azimuth, centroid, solar_azimuth, sea, shadowing)
    return Glint(chance, cos_incidence.reshape(shape))


def _visibility(
    theta: FloatArray, azimuth: FloatArray, solar_zenith: float, solar_azimuth: float, slopes: SlopeStatistics, shadowing: Shadowing
) -> FloatArray:
    """``S / cos(theta_v)``, finite to the horizon: 1/A+ for the viewer's leg, less by the Sun's."""
    # One number for isotropic slopes, so that what depends on the row alone is computed per row.
    variance = np.float64(slopes.mss_up) if slopes.is_isotropic else slopes.mss_along(azimuth)
    area = projected_area(theta, variance)
    if shadowing == "viewer":
        return np.asarray(1.0 / area)
    view = smith_lambda(smith_nu(theta, variance))
    sun = smith_lambda(smith_nu(solar_zenith, slopes.mss_along(solar_azimuth)))
    # Towards the horizon Lambda_v grows without bound and (1 + Lambda_v) S tends to 1.
    finite = np.where(np.isfinite(view), view, 0.0)
    both = np.where(np.isfinite(view), (1.0 + finite) * bistatic(finite, sun, azimuth - solar_azimuth), 1.0)
    return np.asarray(both / area)


def _point_density(
    v: tuple[FloatArray, ...], x: FloatArray, y: FloatArray, solar_zenith: float, solar_azimuth: float, density: SlopeDensity
) -> FloatArray:
    """``p(s) / (4 cos^4(beta))`` for points of the disc ``x`` to the right and ``y`` above the Sun's centre [rad]."""
    sun = direction(solar_zenith, solar_azimuth)
    right = (np.cos(solar_azimuth), -np.sin(solar_azimuth), 0.0)
    above = (-np.cos(solar_zenith) * np.sin(solar_azimuth), -np.cos(solar_zenith) * np.cos(solar_azimuth), np.sin(solar_zenith))
    norm = 1.0 / np.sqrt(1.0 + x * x + y * y)
    east, north, up = (v[i][:, None] + norm * (sun[i] + x * right[i] + y * above[i]) for i in range(3))
    # A horizontal look at a horizontal ray needs an upright facet: infinitely steep, density zero.
    rise = np.maximum(up, 1e-12)
    slope_east, slope_north = -east / rise, -north / rise
    secant2 = 1.0 + slope_east**2 + slope_north**2
    p = density(slope_east, slope_north)
    # norm^3: solid angle of the tangent plane, so that a calm sea's whole density adds up to 1 and no more.
    return np.asarray(np.where(p > 0.0, 0.25 * p * secant2**2 * norm**3, 0.0))


def _wide(
    v: tuple[FloatArray, ...], cos_incidence: FloatArray, solar_zenith: float, solar_azimuth: float, slopes: SlopeStatistics
) -> FloatArray:
    """Integral over the whole disc of a density that varies little on it."""
    x, y = SOLAR_ANGULAR_RADIUS * _HEX_X[None, :], SOLAR_ANGULAR_RADIUS * _HEX_Y[None, :]
    values = _point_density(v, x, y, solar_zenith, solar_azimuth, slopes.density)
    return np.asarray(np.pi * SOLAR_ANGULAR_RADIUS**2 * (values @ _HEX_W))


def _narrow(
    v: tuple[FloatArray, ...], cos_incidence: FloatArray, solar_zenith: float, solar_azimuth: float, slopes: SlopeStatistics
) -> FloatArray:
    """Integral over the part of the disc that is above the horizon and where the density is not negligible.

    Along a line of the disc parallel to the horizon the mirroring slope moves in proportion to the distance, towards one azimuth, so the
    window of a Gaussian density on that line is exact, however grazing the light.
    """
    radius = SOLAR_ANGULAR_RADIUS
    right_east, right_north = np.cos(solar_azimuth), -np.sin(solar_azimuth)
    # Up and down the disc: the slope towards the Sun's azimuth decides; a slope of sigma turns the mirrored ray by 2 sigma.
    turn = np.arctan2(v[0], v[1]) + np.pi - solar_azimuth
    sine = np.hypot(v[0], v[1])
    mirror_y = v[2] * np.sin(solar_zenith) - sine * np.cos(turn) * np.cos(solar_zenith)
    reach = 2.0 * _WINDOW * np.sqrt(float(slopes.mss_along(solar_azimuth)))
    horizon = -1.0 / np.tan(solar_zenith) if solar_zenith > 0.0 else -np.inf
    low = np.maximum(mirror_y - reach, max(-radius, horizon))
    high = np.minimum(mirror_y + reach, radius)
    half = 0.5 * np.maximum(high - low, 0.0)
    y = (0.5 * (high + low))[:, None] + half[:, None] * _GAUSS_X
    # Across it: slope(x) = at_centre + x step, whose Gaussian has its centre and width where Q(x) = slope.C^-1.slope is least.
    level = np.sin(solar_zenith) - y * np.cos(solar_zenith)
    rise = np.maximum(v[2][:, None] + np.cos(solar_zenith) + y * np.sin(solar_zenith), 1e-12)
    centre_east = -(v[0][:, None] + level * np.sin(solar_azimuth)) / rise
    centre_north = -(v[1][:, None] + level * np.cos(solar_azimuth)) / rise
    ee, en, nn = slopes.covariance()
    norm = ee * nn - en * en
    inverse = (nn / norm, -en / norm, ee / norm)
    step_q = (inverse[0] * right_east**2 + 2.0 * inverse[1] * right_east * right_north + inverse[2] * right_north**2) / rise**2
    cross_q = (
        centre_east * (inverse[0] * right_east + inverse[1] * right_north)
        + centre_north * (inverse[1] * right_east + inverse[2] * right_north)
    ) / rise
    middle, across = cross_q / step_q, _WINDOW / np.sqrt(step_q)
    chord = np.sqrt(np.maximum(radius**2 - y**2, 0.0))
    left, right = np.maximum(middle - across, -chord), np.minimum(middle + across, chord)
    width = 0.5 * np.maximum(right - left, 0.0)
    x = (0.5 * (left + right))[..., None] + width[..., None] * _GAUSS_X
    points = (v[0].size, -1)
    yy = np.broadcast_to(y[..., None], x.shape)
    values = _point_density(v, x.reshape(points), yy.reshape(points), solar_zenith, solar_azimuth, slopes.density).reshape(x.shape)
    return np.asarray(np.einsum("pij,pi,i,j->p", values, width * half[:, None], _GAUSS_W, _GAUSS_W))
