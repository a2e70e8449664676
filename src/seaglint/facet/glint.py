r"""Share of the viewed sea that mirrors the Sun, with the Sun a disc.

A point of the sea shows the Sun or it does not. Seen from the direction **v**, facets that mirror the direction **l** have the slope

.. math:: s = -\frac{v_h + l_h}{v_z + l_z}

and the share of the visible projected area that mirrors the solar disc is

.. math:: P = \int_{disc} \frac{p(s)\,S}{4 \cos^4\beta\,\cos\theta_v}\,d\Omega_l

A mirroring point shows :math:`\rho E / (\pi \epsilon^2)`. For a density much wider than the disc's image this is Eq. 8 of the source
article, ``rho p S E / (4 cos^4(beta) cos(theta_v))``; for a calm sea, where that formula exceeds any possible value, P is the
integral of the visible density over the disc and never above 1. The Sun is taken against the vertical of the place that is looked at
(:mod:`seaglint.facet.local_sun`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from seaglint.base.constants import SOLAR_ANGULAR_RADIUS
from seaglint.base.conventions import FloatArray, unit_vector
from seaglint.base.errors import DomainError
from seaglint.base.jit import in_threads, njit
from seaglint.facet.legs import NESTED, Legs, Shadowing, legs_of
from seaglint.facet.local_sun import STEADY, SunTable, turn_kernel, visible_sun
from seaglint.facet.mirror import FacetDensity, SunDisc, chance_kernel, sun_disc
from seaglint.sea.slopes.slope_statistics import SlopeStatistics

#: Least rms slope of the quadrature [1]: a mirror's edge is blurred by 0.2 % of the Sun's radius and needs no formula of its own.
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
    ) -> GlintModel:
        """Prepare the constants of one Sun and one sea.

        The results of :meth:`grid` are weighted with ``sunlight``; other parameters and errors as in :func:`glint`.
        """
        sea = floored(slopes)
        share, centroid = visible_sun(solar_zenith)
        if share == 0.0:  # it may be up at places towards it
            centroid = 0.5 * math.pi - SOLAR_ANGULAR_RADIUS
        s, c = math.sin(sea.wind_to_azimuth), math.cos(sea.wind_to_azimuth)
        up, cross = math.sqrt(sea.mss_up), math.sqrt(sea.mss_cross)
        peak = 1.0 / (8.0 * math.pi * up * cross)
        numbers = FacetDensity(sea.mss_up, sea.mss_cross, up, cross, peak, s, c, sea.is_gaussian, np.array(sea.coefficients))
        settled = shadowing.settled(sea, solar_azimuth)
        legs = legs_of(settled, sea, centroid, solar_azimuth, shining=solar_zenith < 0.5 * math.pi + _DUSK)
        return cls(sea, settled, numbers, sun_disc(solar_zenith, solar_azimuth, sunlight), legs)

    def grid(
        self, view_zenith: FloatArray, view_azimuth: FloatArray, turn: FloatArray, terms: FloatArray
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Mirrored Sun on rows of view zenith and columns of view azimuth [rad], each result (rows, columns); 0 in rows that are NaN.

        ``view_azimuth`` is (columns,) or of each row its own (rows, columns). ``turn`` (rows,) is that of the vertical [rad],
        :func:`~seaglint.facet.local_sun.turn_at` the row's arc. ``terms`` (rows, j) are Chebyshev coefficients in the cosine of
        incidence of what a mirroring point shows, as :class:`seaglint.optics.fresnel.ReflectanceSeries` orders them; the results are their
        sum times the chance, the chance, and the cosine of incidence. The same bytes for any number of threads.
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
) -> GlintGeometry:
    """Share of the viewed sea that mirrors the Sun to the viewer, and the cosine of incidence there.

    Parameters
    ----------
    view_zenith : array_like
        Zenith angle of the direction from the sea to the sensor [rad], 0..pi/2; broadcast against ``view_azimuth``.
    view_azimuth : array_like
        Azimuth of the direction from the sea to the sensor [rad]: that of the line of sight plus pi.
    solar_zenith, solar_azimuth : float
        Direction from the sea to the Sun's centre where ``turn`` is 0 [rad]; below the horizon is valid: no glint.
    slopes : SlopeStatistics
        Slopes of the sea; a flat one mirrors the disc itself.
    shadowing : Shadowing
        Legs that are shadowed, and how.
    turn : array_like
        Turn of the vertical between the sensor's foot, where the Sun's angles hold, and the place [rad], broadcast;
        :func:`~seaglint.facet.local_sun.turn_at` gives that of an arc. 0 takes the Sun's angles as those at the place.

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
    chance is reciprocal in viewer and Sun, within 1 % where the number of bands changes with the Sun's azimuth. The nested law is that of
    Gaussian slopes: its ratio multiplies other densities of the same variances, with the area that their own visible density adds up to.

    References
    ----------
    Source article Eqs. 8 and 12; Cox and Munk 1954, J. Opt. Soc. Am. 44, 838.
    """
    theta, azimuth, psi = (np.asarray(a, dtype=np.float64) for a in (view_zenith, view_azimuth, turn))
    if not np.all((theta >= 0.0) & (theta <= 0.5 * np.pi)):
        raise DomainError("view_zenith must lie in 0..pi/2 rad: the direction from the sea to the sensor")
    shape = np.broadcast_shapes(theta.shape, azimuth.shape, psi.shape)
    views = [np.array(np.broadcast_to(a, shape), order="C").ravel() for a in (theta, azimuth, psi)]
    evaluated = GlintModel.prepare(solar_zenith, solar_azimuth, slopes, shadowing).at(*views)
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
    # One row of azimuths serves all rows, or each row has its own: then those of this part.
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
