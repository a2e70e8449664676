r"""Glint: the share of the viewed sea that mirrors the Sun, with the Sun a disc, and the kernels that compute it.

A point of the sea shows the Sun or it does not. Viewed from the direction **v**, facets that mirror the direction **l** have the slope

.. math:: s = -\frac{v_h + l_h}{v_z + l_z}

and the share of the visible projected area that mirrors the solar disc is

.. math:: P = \int_{disc} \frac{p(s)\,S}{4 \cos^4\beta\,\cos\theta_v}\,d\Omega_l

A mirroring point shows :math:`\rho E / (\pi \epsilon^2)`. For a density much wider than the disc's image this is Eq. 8 of the source
article, ``rho p S E / (4 cos^4(beta) cos(theta_v))``; for a calm sea, where that formula exceeds any possible value, P is the
integral of the visible density over the disc and never above 1. The Sun's direction is taken relative to the vertical of the place that is
looked at (``seaglint.facet.sunlight``).

Facets of synthesised waves are in ``seaglint.facet.solar_disc``; each quadrature is the other's check.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from seaglint.air.sun_and_sky import visible_part_kernel
from seaglint.base.constants import SOLAR_ANGULAR_RADIUS
from seaglint.base.conventions import FloatArray, unit_vector
from seaglint.base.errors import DomainError
from seaglint.base.jit import in_threads, kernel, njit
from seaglint.facet.legs import NESTED, Legs, Shadowing, lean_of_legs, legs_of, local_leg, seen_and_lit_kernel
from seaglint.facet.sunlight import STEADY, SunTable, strength_kernel, turn_kernel, turned_kernel, visible_sun
from seaglint.sea.shadowing.nested import HIGHEST
from seaglint.sea.shadowing.smith import visible_area_kernel
from seaglint.sea.slopes.slope_statistics import SlopeStatistics, series_bracket

#: Ratio of the Sun's radius in slopes to the rms slope below which seven points on the disc are exact to 1e-3 even at 4 sigma.
_BROAD: Final = 0.4

_WINDOW: Final = 6.0  # standard deviations of a narrow density that are integrated; the rest holds 2e-9
_GAUSS_X, _GAUSS_W = np.polynomial.legendre.leggauss(24)

# Disc of radius 1, exact for polynomials of degree 5 (Abramowitz and Stegun 25.4.61): centre and a hexagon.
_HEX_ANGLE = np.arange(6) * np.pi / 3.0
_HEX_X = np.concatenate([[0.0], np.sqrt(2.0 / 3.0) * np.cos(_HEX_ANGLE)])
_HEX_Y = np.concatenate([[0.0], np.sqrt(2.0 / 3.0) * np.sin(_HEX_ANGLE)])
_HEX_W = np.array([0.25] + 6 * [0.125])

_NEGLIGIBLE: Final = 9.0  #: Rms slopes beyond which the density is taken as zero (3e-18 of its peak).

_series_kernel = kernel(series_bracket)


class FacetDensity(NamedTuple):
    """Slope density as kernels read it."""

    mss_up: float
    mss_cross: float
    deviation_up: float
    deviation_cross: float
    peak: float  #: Gaussian density of zero slope, over 4 [1/slope²].
    wind_sine: float
    wind_cosine: float
    is_gaussian: bool
    #: Coefficients of the Gram-Charlier series [(5,)]; an array, as parallel launchers take no tuples within tuples.
    coefficients: FloatArray


class SunDisc(NamedTuple):
    """Solar disc as kernels read it, at the sensor's foot."""

    points: FloatArray  #: Directions of the disc's centre and the hexagon about it (east, north, up) and their weights [sr, (7, 4)].
    rule: FloatArray  #: Gauss-Legendre points and weights [(2, 24)].
    first: float  #: First sine of elevation, steps and values of a ``SunTable``; an array, no nested tuple.
    per_step: float
    strength: FloatArray
    radius: float  #: Angular radius [rad].


class SunPlace(NamedTuple):
    """Place that a pixel looks at: horizontal unit vector away from the sensor, turn of the vertical, and the Sun there.

    The Sun: its centre, visible share and the middle of that part (east, north, up).
    """

    away: tuple[float, float]
    turn: tuple[float, float]
    centre: tuple[float, float, float]
    share: float
    middle: tuple[float, float, float]


def sun_disc(solar_zenith: float, solar_azimuth: float, sunlight: SunTable, radius: float = SOLAR_ANGULAR_RADIUS) -> SunDisc:
    """Return the constants of a Sun."""
    points = np.empty((_HEX_W.size, 4))
    aim_disc(points, float(solar_zenith), float(solar_azimuth), float(radius))
    return SunDisc(points, np.stack([_GAUSS_X, _GAUSS_W]), *sunlight, float(radius))


@njit
def aim_disc(points: FloatArray, solar_zenith: float, solar_azimuth: float, radius: float) -> None:
    """Fill ``SunDisc.points`` of a Sun [(7, 4)]."""
    sz, cz, sa, ca = math.sin(solar_zenith), math.cos(solar_zenith), math.sin(solar_azimuth), math.cos(solar_azimuth)
    for i in range(points.shape[0]):
        x, y = radius * _HEX_X[i], radius * _HEX_Y[i]
        norm = 1.0 / math.sqrt(1.0 + x * x + y * y)
        points[i, 0] = norm * (sz * sa + x * ca - y * cz * sa)
        points[i, 1] = norm * (sz * ca - x * sa - y * cz * ca)
        points[i, 2] = norm * (cz + y * sz)
        # norm^3: solid angle of the tangent plane, so that a calm sea's whole density adds up to 1 and no more.
        points[i, 3] = math.pi * radius**2 * _HEX_W[i] * norm**3


@kernel
def _facet_share(east: float, north: float, up: float, lean: tuple[float, float], sea: FacetDensity) -> float:
    """Share ``p(s) / (4 cos^4(beta))`` of the mirroring facet; ``(east, north, up)`` is the sum of both directions.

    ``lean`` is the shift of the density's mean, east and north.
    """
    # A horizontal look at a horizontal ray needs an upright facet: infinitely steep, density zero.
    fall = -1.0 / max(up, 1e-12)
    slope_east, slope_north = fall * east, fall * north
    from_east, from_north = slope_east - lean[0], slope_north - lean[1]
    along = (from_east * sea.wind_sine + from_north * sea.wind_cosine) / sea.deviation_up
    cross = (from_east * sea.wind_cosine - from_north * sea.wind_sine) / sea.deviation_cross
    q = along * along + cross * cross
    if q > 1400.0:
        return 0.0
    share = sea.peak * math.exp(-0.5 * q)
    if not sea.is_gaussian:
        c = sea.coefficients
        share *= max(_series_kernel(cross, -along, (c[0], c[1], c[2], c[3], c[4])), 0.0)
    secant2 = 1.0 + slope_east * slope_east + slope_north * slope_north
    return share * secant2 * secant2


@kernel
def place_kernel(away: tuple[float, float], turn: tuple[float, float], disc: SunDisc) -> SunPlace:
    """Position and strength of the Sun at a place."""
    foot = disc.points[0]
    centre = turned_kernel(foot[0], foot[1], foot[2], away, turn)
    share, lift = visible_part_kernel(centre[2])
    # a Sun that is partly visible is near the horizon: raised by so little, its horizontal part keeps its length within 1e-5
    middle = (centre[0] * (1.0 - lift * centre[2]), centre[1] * (1.0 - lift * centre[2]), centre[2] + lift)
    return SunPlace(away, turn, centre, share, middle)


@kernel
def _wide(east: float, north: float, up: float, lean: tuple[float, float], disc: SunDisc, place: SunPlace, sea: FacetDensity) -> float:
    """Integral over the whole disc of a density that varies little on it; the first arguments are the view's direction."""
    total = 0.0
    for i in range(disc.points.shape[0]):
        p = disc.points[i]
        sun = turned_kernel(p[0], p[1], p[2], place.away, place.turn)
        total += p[3] * _facet_share(east + sun[0], north + sun[1], up + sun[2], lean, sea)
    return total


@kernel
def _narrow(east: float, north: float, up: float, lean: tuple[float, float], disc: SunDisc, place: SunPlace, sea: FacetDensity) -> float:
    """Integral over the part of the disc that is above the horizon and where the density is not negligible.

    Along a line of the disc parallel to the horizon the mirroring slope moves in proportion to the distance, towards one azimuth, so the
    window of a Gaussian density on that line is exact, however grazing the light.
    """
    radius = disc.radius
    east_sun, north_sun, cz = place.centre
    sz = math.sqrt(east_sun * east_sun + north_sun * north_sun)
    # at the zenith any azimuth serves
    s, c = (east_sun / sz, north_sun / sz) if sz > 1e-9 else (0.0, 1.0)
    # Up and down the disc: the slope towards the Sun's azimuth decides; a slope of sigma turns the mirrored ray by 2 sigma.
    mirror_y = up * sz + (east * s + north * c) * cz
    to_wind, off_wind = s * sea.wind_sine + c * sea.wind_cosine, s * sea.wind_cosine - c * sea.wind_sine
    reach = 2.0 * _WINDOW * math.sqrt(sea.mss_up * to_wind**2 + sea.mss_cross * off_wind**2)
    bottom = max(-radius, -cz / sz) if sz > 0.0 else -radius
    low, high = max(mirror_y - reach, bottom), min(mirror_y + reach, radius)
    half = 0.5 * max(high - low, 0.0)
    total = 0.0
    # Across it: slope(x) = at_centre + x step, whose Gaussian has its centre and width where Q(x) = slope.C^-1.slope is least.
    # (c, -s) is the disc's right, along and across the wind:
    step_up, step_cross = c * sea.wind_sine - s * sea.wind_cosine, c * sea.wind_cosine + s * sea.wind_sine
    step_q = step_up**2 / sea.mss_up + step_cross**2 / sea.mss_cross
    for j in range(disc.rule.shape[1]):
        y = 0.5 * (high + low) + half * disc.rule[0, j]
        level = sz - y * cz
        rise = max(up + cz + y * sz, 1e-12)
        centre_east, centre_north = east + level * s, north + level * c
        centre_up = centre_east * sea.wind_sine + centre_north * sea.wind_cosine
        centre_cross = centre_east * sea.wind_cosine - centre_north * sea.wind_sine
        middle = -(centre_up * step_up / sea.mss_up + centre_cross * step_cross / sea.mss_cross) / step_q
        across = _WINDOW * rise / math.sqrt(step_q)
        chord = math.sqrt(max(radius * radius - y * y, 0.0))
        left, right = max(middle - across, -chord), min(middle + across, chord)
        width = 0.5 * max(right - left, 0.0)
        if width == 0.0:
            continue
        line = 0.0
        for i in range(disc.rule.shape[1]):
            x = 0.5 * (left + right) + width * disc.rule[0, i]
            norm = 1.0 / math.sqrt(1.0 + x * x + y * y)
            share = _facet_share(
                east + norm * (level * s + x * c), north + norm * (level * c - x * s), up + norm * (cz + y * sz), lean, sea
            )
            line += disc.rule[1, i] * share * norm**3
        total += disc.rule[1, j] * width * line
    return half * total


@kernel
def chance_kernel(
    view: tuple[float, float, float, float],
    azimuth: float,
    turn: tuple[float, float],
    area: float,
    sea: FacetDensity,
    disc: SunDisc,
    legs: Legs,
) -> tuple[float, float, float]:
    """Chance, cosine of incidence and strength of sunlight for one view, given by sine and cosine of its zenith, then of its azimuth.

    A negative ``area`` requests the A+ of a Gaussian sea.
    """
    sine, cosine, azimuth_sine, azimuth_cosine = view
    east, north = sine * azimuth_sine, sine * azimuth_cosine
    place = place_kernel((-azimuth_sine, -azimuth_cosine), turn, disc)
    sun = place.middle
    # cos(2 w) = v.l; the floor only keeps exact grazing from dividing by zero.
    cos_incidence = math.sqrt(min(max(0.5 * (1.0 + east * sun[0] + north * sun[1] + cosine * sun[2]), 1e-18), 1.0))
    # Image of the Sun's radius in slopes, its long half axis: eps/(2 cos w), over the square of the facet's upward cosine.
    rise = max(cosine + sun[2], 1e-12)
    upward = rise / (2.0 * cos_incidence)
    image = disc.radius / (2.0 * cos_incidence * upward**2)
    slope = math.sqrt(max(1.0 / upward**2 - 1.0, 0.0))
    least, most = min(sea.deviation_up, sea.deviation_cross), max(sea.deviation_up, sea.deviation_cross)
    if place.share == 0.0 or slope - 2.0 * image >= _NEGLIGIBLE * most:
        return 0.0, cos_incidence, 0.0
    to_wind = azimuth_sine * sea.wind_sine + azimuth_cosine * sea.wind_cosine
    off_wind = azimuth_sine * sea.wind_cosine - azimuth_cosine * sea.wind_sine
    deviation = math.sqrt(sea.mss_up * to_wind**2 + sea.mss_cross * off_wind**2)
    if area < 0.0:
        area = visible_area_kernel(cosine, sine * deviation)
    along = -((east + sun[0]) * azimuth_sine + (north + sun[1]) * azimuth_cosine) / (rise * deviation)
    hidden, leg_edge = local_leg(legs, sun[2])
    there = Legs(
        legs.sun, hidden, legs.azimuth, legs.sine, legs.cosine, leg_edge, legs.deviation, legs.series,
        legs.ratio, legs.coupling, legs.lean, legs.gains, legs.wind,
    )  # fmt: skip
    sunward = -((east + sun[0]) * legs.sine + (north + sun[1]) * legs.cosine) / (rise * legs.deviation)
    edge = cosine / (sine * deviation) if sine > 0.0 else HIGHEST
    lean = lean_of_legs((along, edge, deviation), azimuth, sunward, there)
    wide = place.share == 1.0 and image < _BROAD * least
    share = _wide(east, north, cosine, lean, disc, place, sea) if wide else _narrow(east, north, cosine, lean, disc, place, sea)
    share *= seen_and_lit_kernel(cosine / area, (along, edge), sunward, azimuth, there)
    return share / area, cos_incidence, strength_kernel(SunTable(disc.first, disc.per_step, disc.strength), sun[2])


#: Least rms slope of the quadrature [1]: a mirror's edge is blurred by 0.2 % of the Sun's radius and needs no separate formula.
_FLOOR: Final = 1e-3 * SOLAR_ANGULAR_RADIUS

#: Least ratio of the two rms slopes: at the roughest slopes without wind, 0.055, half of the Sun's radius in slopes.
_THINNEST: Final = 0.02

#: Depression of the Sun at the sensor's foot from which it is above no horizon in view [rad]: the horizon is this far from 250 km up.
_DUSK: Final = 0.3


@dataclass(frozen=True)
class GlintGeometry:
    """Mirrored Sun at each pixel: chance and incidence."""

    chance: FloatArray  #: P, share of the viewed area that mirrors the visible part of the Sun [1].
    cos_incidence: FloatArray  #: Cosine of the angle of incidence on the mirroring facets [1].


def direction(zenith: ArrayLike, azimuth: ArrayLike) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Unit vector (east, north, up) of a zenith angle and an azimuth [rad], broadcast."""
    z = np.asarray(zenith, dtype=np.float64)
    east, north = unit_vector(azimuth)
    return np.sin(z) * east, np.sin(z) * north, np.cos(z) + 0.0 * east


def floored(slopes: SlopeStatistics) -> SlopeStatistics:
    """Return the statistics with variances raised to the floor, so that mirrors have a density and no variance is far below the other.

    Slopes along one direction only (directional fits without wind) would leave the quadrature's window, which is set up and down the disc.
    """
    least = max(_FLOOR**2, _THINNEST**2 * max(slopes.mss_up, slopes.mss_cross))
    if min(slopes.mss_up, slopes.mss_cross) >= least:
        return slopes
    return replace(slopes, mss_up=max(slopes.mss_up, least), mss_cross=max(slopes.mss_cross, least))


@dataclass(frozen=True, eq=False)
class GlintModel:
    """Model of the mirrored Sun over a sea, for any number of views. Make it with :meth:`prepare`."""

    slopes: SlopeStatistics  #: Slopes of the sea, no variance below the quadrature's floor.
    shadowing: Shadowing  #: Legs that are shadowed, and how.
    _sea: FacetDensity
    _disc: SunDisc
    _legs: Legs

    @classmethod
    def prepare(
        cls,
        solar_zenith: float,
        solar_azimuth: float,
        slopes: SlopeStatistics,
        shadowing: Shadowing = NESTED,
        sunlight: SunTable = STEADY,
        radius: float = SOLAR_ANGULAR_RADIUS,
    ) -> GlintModel:
        """Prepare the constants of one Sun, or of a disc of another angular radius [rad], and one sea.

        The results of :meth:`grid` are weighted with ``sunlight``; other parameters and errors as in :func:`glint`.
        """
        sea = floored(slopes)
        share, centroid = visible_sun(solar_zenith)
        if share == 0.0:  # below the horizon at the foot, the Sun may be up at places towards it
            centroid = 0.5 * math.pi - SOLAR_ANGULAR_RADIUS
        s, c = math.sin(sea.wind_to_azimuth), math.cos(sea.wind_to_azimuth)
        up, cross = math.sqrt(sea.mss_up), math.sqrt(sea.mss_cross)
        peak = 1.0 / (8.0 * math.pi * up * cross)
        numbers = FacetDensity(sea.mss_up, sea.mss_cross, up, cross, peak, s, c, sea.is_gaussian, np.array(sea.coefficients))
        settled = shadowing.settled(sea, solar_azimuth)
        legs = legs_of(settled, sea, centroid, solar_azimuth, shining=solar_zenith < 0.5 * math.pi + _DUSK)
        return cls(sea, settled, numbers, sun_disc(solar_zenith, solar_azimuth, sunlight, radius), legs)

    def grid(
        self, view_zenith: FloatArray, view_azimuth: FloatArray, turn: FloatArray, terms: FloatArray
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Mirrored Sun on rows of view zenith and columns of view azimuth [rad], each result (rows, columns); 0 in rows that are NaN.

        ``view_azimuth`` is (columns,), or (rows, columns) with azimuths of every row. ``turn`` (rows,) is the turn of the vertical [rad],
        ``turn_at`` the row's arc. ``terms`` (rows, j) are Chebyshev coefficients in the cosine of
        incidence of what a mirroring point shows, as ``seaglint.optics.fresnel.ReflectanceSeries`` orders them; the results are their
        sum times the chance, the chance, and the cosine of incidence. The bytes do not depend on the number of threads.
        """
        azimuth = np.atleast_2d(view_azimuth)
        out = np.zeros((3, view_zenith.size, azimuth.shape[1]))
        if self._shines(turn):
            area = self._area(view_zenith[:, None], azimuth)
            in_threads(
                lambda part: _fill_grid(view_zenith, azimuth, turn, area, self._sea, self._disc, self._legs, terms, out, part),
                view_zenith.size,
            )
        return out[0], out[1], out[2]

    def at(self, view_zenith: FloatArray, view_azimuth: FloatArray, turn: FloatArray) -> GlintGeometry:
        """Mirrored Sun at a list of views, with the turn of the vertical at each [rad, (n,) each]."""
        chance, cosine = np.zeros(view_zenith.size), np.zeros(view_zenith.size)
        if self._shines(turn):
            area = self._area(view_zenith, view_azimuth)
            views = np.stack([view_zenith, view_azimuth, turn])
            in_threads(lambda part: _fill_list(views, area, self._sea, self._disc, self._legs, chance, cosine, part), view_zenith.size)
        return GlintGeometry(chance, cosine)

    def _shines(self, turn: FloatArray) -> bool:
        """True if the Sun may be up at a place where the vertical is turned by at most ``turn`` [rad]."""
        farthest = float(np.nanmax(turn, initial=0.0))
        return math.asin(self._disc.points[0, 2]) + farthest > -SOLAR_ANGULAR_RADIUS

    def _area(self, theta: FloatArray, azimuth: FloatArray) -> FloatArray:
        """Visible area A+ where the kernel has no closed form; empty for Gaussian slopes."""
        if self.slopes.is_gaussian:
            return np.zeros((0,) * np.broadcast(theta, azimuth).ndim)
        return self.shadowing.area(theta, azimuth, self.slopes)


def glint(
    view_zenith: ArrayLike,
    view_azimuth: ArrayLike,
    solar_zenith: float,
    solar_azimuth: float,
    slopes: SlopeStatistics,
    shadowing: Shadowing = NESTED,
    turn: ArrayLike = 0.0,
    radius: float = SOLAR_ANGULAR_RADIUS,
) -> GlintGeometry:
    """Share of the viewed sea that mirrors the Sun to the viewer, and the cosine of incidence there.

    Parameters
    ----------
    view_zenith : array_like
        Zenith angle of the direction from the sea to the sensor [rad], 0..pi/2; broadcast against ``view_azimuth``.
    view_azimuth : array_like
        Azimuth of the direction from the sea to the sensor [rad]: the azimuth of the line of sight plus pi.
    solar_zenith, solar_azimuth : float
        Direction from the sea to the Sun's centre where ``turn`` is 0 [rad]; below the horizon is valid: no glint.
    slopes : SlopeStatistics
        Slopes of the sea; a flat one mirrors the disc itself.
    shadowing : Shadowing
        Legs that are shadowed, and how.
    turn : array_like
        Turn of the vertical between the sensor's foot, where the Sun's angles hold, and the place [rad], broadcast;
        ``turn_at`` computes it from an arc. With 0 the Sun's angles hold at the place itself.
    radius : float
        Angular radius of the disc [rad].

    Returns
    -------
    GlintGeometry
        Arrays of the broadcast shape; ``chance`` is 0 for a Sun below the horizon.

    Raises
    ------
    DomainError
        View zeniths outside 0..pi/2.

    Notes
    -----
    Where the disc's image in the slope plane is small against the rms slope, seven points on the disc; elsewhere, and for a Sun cut by
    the horizon, 24 x 24 Gauss points on that part of the disc where the density is not negligible. Shadowing is taken at the middle of
    the visible part of the disc. With the viewer's leg alone energy is conserved over all positions of the Sun; with both legs the
    chance is reciprocal in viewer and Sun, within 1 % where the number of bands changes with the Sun's azimuth. The nested law holds for
    Gaussian slopes: its ratio multiplies other densities of the same variances, with the area that their visible density adds up to.

    References
    ----------
    Source article Eqs. 8 and 12; Cox and Munk 1954, J. Opt. Soc. Am. 44, 838.
    """
    theta, azimuth, psi = (np.asarray(a, dtype=np.float64) for a in (view_zenith, view_azimuth, turn))
    if not np.all((theta >= 0.0) & (theta <= 0.5 * np.pi)):
        raise DomainError("view_zenith must lie in 0..pi/2 rad: the direction from the sea to the sensor")
    shape = np.broadcast_shapes(theta.shape, azimuth.shape, psi.shape)
    views = [np.array(np.broadcast_to(a, shape), order="C").ravel() for a in (theta, azimuth, psi)]
    evaluated = GlintModel.prepare(solar_zenith, solar_azimuth, slopes, shadowing, radius=radius).at(*views)
    return GlintGeometry(evaluated.chance.reshape(shape), evaluated.cos_incidence.reshape(shape))


@njit
def _fill_grid(
    zenith: FloatArray,
    azimuth: FloatArray,
    turn: FloatArray,
    area: FloatArray,
    sea: FacetDensity,
    disc: SunDisc,
    legs: Legs,
    terms: FloatArray,
    out: FloatArray,
    part: tuple[int, int],
) -> None:
    # One row of azimuths serves all rows, or each row has separate ones: then only the rows of this part are needed.
    first, end = part if azimuth.shape[0] > 1 else (0, 1)
    sines, cosines = np.sin(azimuth[first:end]), np.cos(azimuth[first:end])
    for row in range(part[0], part[1]):
        if not zenith[row] <= 0.5 * math.pi:  # NaN: not of the sea
            continue
        sine, cosine = math.sin(zenith[row]), math.cos(zenith[row])
        here, of = turn_kernel(turn[row]), row - first if azimuth.shape[0] > 1 else 0
        for column in range(azimuth.shape[1]):
            a = area[row, column] if area.size > 0 else -1.0
            view = (sine, cosine, sines[of, column], cosines[of, column])
            chance, cos_incidence, strength = chance_kernel(view, azimuth[first + of, column], here, a, sea, disc, legs)
            # Clenshaw's sum of the series in 2 c - 1
            x, b1, b2 = 2.0 * cos_incidence - 1.0, 0.0, 0.0
            for j in range(terms.shape[1] - 1, 0, -1):
                b1, b2 = terms[row, j] + 2.0 * x * b1 - b2, b1
            out[0, row, column] = chance * strength * (terms[row, 0] + x * b1 - b2)
            out[1, row, column] = chance
            out[2, row, column] = cos_incidence


@njit
def _fill_list(
    views: FloatArray,
    area: FloatArray,
    sea: FacetDensity,
    disc: SunDisc,
    legs: Legs,
    chance: FloatArray,
    cosine: FloatArray,
    part: tuple[int, int],
) -> None:
    zenith, azimuth, turn = views[0], views[1], views[2]
    for i in range(part[0], part[1]):
        view = (math.sin(zenith[i]), math.cos(zenith[i]), math.sin(azimuth[i]), math.cos(azimuth[i]))
        chance[i], cosine[i], _ = chance_kernel(view, azimuth[i], turn_kernel(turn[i]), area[i] if area.size > 0 else -1.0, sea, disc, legs)
