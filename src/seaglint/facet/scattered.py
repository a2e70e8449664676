r"""Scattered sunlight in the mean model: in paths, and in the sky that waves mirror.

The air about the Sun's direction is bright (the aureole, some ten degrees wide), so that every slope mirrors a different part of that sky:

.. math::

    L = \int \frac{p(s)\,R(s)\,\max(0, v_z - v_h \cdot s)}{A}\;\int \tau\,\rho(\omega)\,L_{scat}(r(s))\,d\nu\;ds, \qquad
    r = 2 (n \cdot v)\,n - v

over the slopes whose mirrored ray r comes from the sky; p, R and A as in :mod:`seaglint.facet.emissivity`. The disc itself is
excluded: its mirror image is the glint.

Facets of synthesised waves are in ``seaglint.facet.mirrored_haze``; each quadrature is the other's check.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Final, NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline

from seaglint.air.scattering.scattered_light import ScatteredTable, path_map, scattered_shares, shares_at, sky_map, sky_row
from seaglint.base.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.base.conventions import FloatArray
from seaglint.base.jit import in_threads, kernel, njit
from seaglint.facet.sea_view import SeaView, sea_arc
from seaglint.facet.sunlight import turn_at, turn_kernel
from seaglint.optics.fresnel import ReflectanceSeries
from seaglint.sea.shadowing.nested import between_bands, nested_ratio_kernel, ratio_table
from seaglint.sea.slopes.slope_statistics import SlopeStatistics, series_bracket

_ROWS: Final = 48  #: Number of elevations of the viewer at which the mirrored sky is tabulated.

_MIRRORED: Final = 48  #: Number of azimuth intervals of the mirrored sky, over the full circle.

#: Number of azimuth intervals of the path, on one side of the Sun. The intervals are denser near the Sun, by the factors below.
_STRAIGHT: Final = 64

_CROWDING: Final = {_MIRRORED: 3.0, _STRAIGHT: 5.0}

_TERMS: Final = 8  #: Number of Chebyshev terms of the reflectance: the scattered sky needs it within 1e-4.

_ACROSS: Final = 17
_ALONG_X, _ALONG_W = np.polynomial.legendre.leggauss(32)
_CUT: Final = 5.0  #: Largest slope that is summed, in standard deviations.

_ELEVATIONS: Final = 129
_AZIMUTHS: Final = 181  #: Numbers of nodes of the sky over the sea: even in the square root of elevation, and in azimuth.

_FEW_LINES: Final = 64  #: Number of paths up to which each is summed by itself: a table costs as much as twice as many.

_LEAST_SLOPE: Final = 1e-4  #: Least rms slope that is summed [1]: mirrors see a spot of the sky 0.01 deg wide.

_series_kernel = kernel(series_bracket)


class _Facets(NamedTuple):
    """Slopes for the sum over facets: variances along and across the wind, the wind's azimuth, the series and the nested law."""

    up: float
    cross: float
    wind: float
    is_gaussian: bool
    coefficients: np.ndarray
    ratio: np.ndarray


@njit
def _fill_sky(table: ScatteredTable, suns: np.ndarray, out: np.ndarray) -> None:
    """Fill shares of spectral shapes over the sea [(Suns, elevations, azimuths, r)]."""
    for t in range(out.shape[0]):
        for e in range(out.shape[1]):
            elevation = 0.5 * math.pi * (e / (out.shape[1] - 1)) ** 2
            row = sky_row(elevation, table)
            for a in range(out.shape[2]):
                shares_at(row, elevation, math.pi * a / (out.shape[2] - 1), suns[t], table, out[t, e, a])


@kernel
def _add_sky(sky: np.ndarray, at: tuple[float, float, float], weight: float, out: np.ndarray) -> None:
    """Add to ``out[r]`` the sky at an interpolated Sun, an elevation and an azimuth from the Sun [rad]."""
    x, y = at[0], math.sqrt(at[1] / (0.5 * math.pi)) * (sky.shape[1] - 1)
    beside = abs(at[2]) % (2.0 * math.pi)
    z = min(beside, 2.0 * math.pi - beside) / math.pi * (sky.shape[2] - 1)
    t, e, a = min(int(x), max(sky.shape[0] - 2, 0)), min(int(y), sky.shape[1] - 2), min(int(z), sky.shape[2] - 2)
    f, g = y - e, z - a
    for step in range(2 if x > t else 1):
        w = weight * (x - t if step else 1.0 - (x - t))
        for r in range(out.shape[0]):
            low = sky[t + step, e, a, r] + g * (sky[t + step, e, a + 1, r] - sky[t + step, e, a, r])
            high = sky[t + step, e + 1, a, r] + g * (sky[t + step, e + 1, a + 1, r] - sky[t + step, e + 1, a, r])
            out[r] += w * (low + f * (high - low))


@kernel
def _sun_at(zenith: float, beside: float, psi: float) -> tuple[float, float]:
    """Zenith angle of the Sun at a place and its azimuth from the line of sight [rad], ``beside`` the azimuth at the sensor's foot."""
    turn = turn_kernel(psi)
    along, aside, up = math.sin(zenith) * math.cos(beside), math.sin(zenith) * math.sin(beside), math.cos(zenith)
    lifted = along * turn[1] + up * turn[0]
    return math.acos(min(max(lifted, -1.0), 1.0)), math.atan2(aside, along * turn[0] - up * turn[1])


@njit
def _mirror(
    facets: _Facets, rule: np.ndarray, sky: np.ndarray, view: tuple[float, float], sun: tuple[float, float], out: np.ndarray
) -> None:
    """Moments of the mirrored sky ``out[j, r]``: sums over facets of their density, Chebyshev term j of the incidence and share r.

    ``view``: elevation and azimuth of the direction to the viewer. ``sun``: place among the sky's Suns, and the Sun's azimuth.
    """
    out[:] = 0.0
    sine, cosine = math.sin(view[0]), max(math.cos(view[0]), 1e-12)
    turn = view[1] - facets.wind
    s, c = math.sin(turn), math.cos(turn)
    along = facets.up * c * c + facets.cross * s * s
    mixed = (facets.cross - facets.up) * s * c
    across = facets.up * s * s + facets.cross * c * c
    # slopes along the view are Gaussian about ``lean`` times the slope across, with the variance that the covariance leaves
    lean, deviation = mixed / across, math.sqrt(along)
    spread = math.sqrt(max(along - lean * mixed, 1e-3 * along))
    tangent = sine / cosine
    count = rule.shape[1]
    shares = np.empty(out.shape[1])
    for j in range(_ACROSS):
        z = _CUT * (2.0 * j / (_ACROSS - 1) - 1.0)
        slope_across = math.sqrt(across) * z
        centre = lean * slope_across
        # slopes steeper than this one mirror the sea
        horizon = (math.sqrt(max(1.0 - sine * sine * slope_across * slope_across, 0.0)) - cosine) / max(sine, 1e-9)
        low, high = centre - _CUT * spread, min(centre + _CUT * spread, horizon, tangent)
        if high <= low:
            continue
        for i in range(count):
            a = low + 0.5 * (high - low) * (1.0 + rule[0, i])
            y = (a - centre) / spread
            density = math.exp(-0.5 * (y * y + z * z)) * rule[1, i] * (high - low) / spread * (sine - cosine * a)
            if not facets.is_gaussian:
                downwind, crosswind = a * c - slope_across * s, a * s + slope_across * c
                x = (crosswind / math.sqrt(facets.cross), -downwind / math.sqrt(facets.up))
                co = facets.coefficients
                density *= max(_series_kernel(x[0], x[1], (co[0], co[1], co[2], co[3], co[4])), 0.0)
            if density <= 0.0:
                continue
            if facets.ratio.size > 0:
                density *= nested_ratio_kernel(a, tangent, deviation, facets.ratio)
            nz = 1.0 / math.sqrt(1.0 + a * a + slope_across * slope_across)
            incidence = nz * (sine - cosine * a)
            up = 2.0 * incidence * nz - sine
            if up <= 0.0:
                continue
            azimuth = view[1] + math.atan2(-2.0 * incidence * slope_across * nz, -2.0 * incidence * a * nz - cosine)
            shares[:] = 0.0
            _add_sky(sky, (sun[0], math.asin(min(up, 1.0)), azimuth - sun[1]), density, shares)
            # Chebyshev polynomials of 2 c - 1 by their recurrence
            t, before = 1.0, 2.0 * incidence - 1.0
            chebyshev = before
            for n in range(out.shape[0]):
                for r in range(out.shape[1]):
                    out[n, r] += t * shares[r]
                t, chebyshev = chebyshev, 2.0 * before * chebyshev - t
    # (2 pi)^-1 of the density, the steps of z, and half an interval of the rule
    out *= 0.5 * (2.0 * _CUT / (_ACROSS - 1)) / (2.0 * math.pi)


@njit
def _fill_mirrored(
    rows: tuple[int, int],
    where: np.ndarray,
    azimuths: np.ndarray,
    facets: _Facets,
    rule: np.ndarray,
    sky: np.ndarray,
    sun: np.ndarray,
    sums: np.ndarray,
    out: np.ndarray,
) -> None:
    """Fill the mirrored sky in band over the area of all visible facets: rows of elevation and turn ``where``, azimuths of lines of sight.

    ``sun``: zenith angle and azimuth at the sensor's foot, first zenith angle of the sky and its nodes per rad. ``sums[i, j, r]``: sums
    over the band of reflectance and path for every row.
    """
    moments = np.empty((sums.shape[1], sums.shape[2]))
    for row in range(rows[0], rows[1]):
        for column in range(azimuths.size):
            zenith, beside = _sun_at(sun[0], sun[1] - azimuths[column], where[row, 1])
            place = min(max((zenith - sun[2]) * sun[3], 0.0), sky.shape[0] - 1.0)
            _mirror(facets, rule, sky, (where[row, 0], azimuths[column] + math.pi), (place, azimuths[column] + beside), moments)
            total = 0.0
            for j in range(moments.shape[0]):
                for r in range(moments.shape[1]):
                    total += moments[j, r] * sums[row, j, r]
            out[row, column] = total


@dataclass(frozen=True, eq=False)
class Around:
    """Azimuth nodes about the Sun, denser near it: ``azimuth = pi sinh(c u)/sinh(c)``, u in 0..1."""

    azimuth: FloatArray  #: From the Sun [rad, (nodes,)].
    _u: FloatArray
    _crowding: float

    @classmethod
    def mirrored(cls) -> Around:
        """Nodes for the mirrored sky, on both sides of the Sun, as slopes may be skewed to one."""
        return cls._of(np.linspace(-1.0, 1.0, _MIRRORED + 1), _CROWDING[_MIRRORED])

    @classmethod
    def path(cls) -> Around:
        """Nodes for paths, which are symmetric about the Sun."""
        return cls._of(np.linspace(0.0, 1.0, _STRAIGHT + 1), _CROWDING[_STRAIGHT])

    @classmethod
    def _of(cls, u: FloatArray, crowding: float) -> Around:
        return cls(np.pi * np.sinh(crowding * u) / np.sinh(crowding), u, crowding)

    def weights(self, azimuth: FloatArray) -> FloatArray:
        """Weights (nodes, columns) of the nodes' values for azimuths from the Sun [rad, (columns,)]."""
        turned = np.remainder(azimuth + np.pi, 2.0 * np.pi) - np.pi
        turned = turned if self._u[0] < 0.0 else np.abs(turned)
        u = np.arcsinh(turned / np.pi * np.sinh(self._crowding)) / self._crowding
        return np.asarray(CubicSpline(self._u, np.eye(self._u.size))(u).T)


@dataclass(frozen=True, eq=False)
class SeaRows:
    """Rows of sea: viewing geometry, and transmittance times quadrature weight [cm-1, (rows, n)].

    The geometry is elevation of the viewer and turn of the vertical at the place, elevation of the line of sight [rad] and arc [m].
    """

    gamma: FloatArray
    turn: FloatArray
    elevation: FloatArray
    arc: FloatArray
    seen: FloatArray

    @classmethod
    def of(cls, view: SeaView, gamma: FloatArray) -> SeaRows:
        """Rows for elevations of the viewer over the sea [rad]."""
        arc = sea_arc(view.sensor_height, gamma)
        seen = view.atmosphere.transmittance(view.sensor_height, arc)[..., view.in_band.grid] * view.in_band.weights
        return cls(gamma, turn_at(arc), -(gamma + arc / EFFECTIVE_EARTH_RADIUS), arc, seen)


@dataclass(frozen=True, eq=False)
class ScatteredSun:
    """Scattered sunlight over one view's sea. Make it with ``prepare``."""

    view: SeaView  #: Sensor, sea, air and Sun.
    _reflectance: ReflectanceSeries
    _facets: _Facets
    _sky: FloatArray
    _sun: FloatArray
    _spectral: FloatArray

    @classmethod
    def prepare(cls, view: SeaView, reflectance: Callable[[], ReflectanceSeries], turn: float | None = None) -> ScatteredSun | None:
        """Prepare the scattered sunlight over the sea; None if the air scatters none.

        The water's reflectance is evaluated where it matters. Places have the vertical turned by at most ``turn`` [rad]: all in view by
        default.
        """
        if view.scattered.is_dark:
            return None
        table = view.scattered.sea_sky if turn is None else view.scattered.sea_sky_within(turn)
        first, per_rad = table.suns if table.suns[1] > 0.0 else (table.solar_zenith, 0.0)
        count = table.amplitude.shape[0] if per_rad > 0.0 else 1
        suns = first + np.arange(count) / (per_rad if per_rad > 0.0 else 1.0)
        sky = np.empty((count, _ELEVATIONS, _AZIMUTHS, table.amplitude.shape[4]))
        _fill_sky(table, suns, sky)
        sun = np.array([view.solar_zenith, view.solar_azimuth, first, per_rad])
        return cls(view, reflectance(), _facets_of(view), sky, sun, view.sun_distance_factor * table.spectral)

    def mirrored(self, rows: SeaRows, azimuth: FloatArray) -> FloatArray:
        """Scattered sunlight mirrored by the sea, at the aperture in band [W m-2 sr-1, (rows, columns)].

        Azimuths of lines of sight [rad, (columns,)].
        """
        if rows.gamma.size == 0:
            return np.zeros((0, azimuth.size))
        terms = self._reflectance.coefficients[:_TERMS]
        shapes = (terms[:, None] * self._spectral).reshape(-1, rows.seen.shape[1])
        sums = np.ascontiguousarray((rows.seen @ shapes.T).reshape(rows.gamma.size, terms.shape[0], -1))
        out, rule = np.empty((rows.gamma.size, azimuth.size)), np.stack([_ALONG_X, _ALONG_W])
        where = np.stack([rows.gamma, rows.turn], axis=1)
        in_threads(lambda part: _fill_mirrored(part, where, azimuth, self._facets, rule, self._sky, self._sun, sums, out), len(where))
        area = self.view.hiding.area(0.5 * np.pi - rows.gamma[:, None], azimuth + np.pi, _rough(self.view.slopes))
        return np.asarray(np.maximum(out, 0.0) / area)

    def path(self, rows: SeaRows, azimuth: FloatArray) -> FloatArray:
        """Scattered sunlight of paths to the sea in band [W m-2 sr-1, (rows, columns)]; azimuths of lines of sight [rad, (columns,)]."""
        if rows.arc.size * azimuth.size <= _FEW_LINES:
            return self.view.sun_distance_factor * self.view.scattered.paths(rows.arc, azimuth - self.view.solar_azimuth)
        beside = azimuth - self.view.solar_azimuth
        return self.view.sun_distance_factor * path_map(rows.arc, rows.elevation, beside, self.view.scattered.path)

    def above(self, elevation: FloatArray, azimuth: FloatArray) -> FloatArray:
        """Scattered sunlight of the sky above the sensor at elevations (rows) and azimuths (columns) [rad], in band [W m-2 sr-1]."""
        if elevation.size == 0:  # the table takes longer than all that a view of the sea alone needs
            return np.zeros((0, azimuth.size))
        return self.view.sun_distance_factor * sky_map(elevation, azimuth - self.view.solar_azimuth, self.view.scattered.sky)

    def above_along(self, elevation: FloatArray, azimuth: FloatArray) -> FloatArray:
        """Scattered sunlight of the sky along a list of lines of sight, in band [W m-2 sr-1, (n,)]."""
        if elevation.size == 0:
            return np.zeros(0)
        return self.view.sun_distance_factor * scattered_shares(elevation, azimuth - self.view.solar_azimuth, self.view.scattered.sky)[:, 0]


def _rough(slopes: SlopeStatistics) -> SlopeStatistics:
    """Return the slopes with variances raised to the least that the sum resolves."""
    least = max(_LEAST_SLOPE**2, 1e-4 * max(slopes.mss_up, slopes.mss_cross))
    return replace(slopes, mss_up=max(slopes.mss_up, least), mss_cross=max(slopes.mss_cross, least))


def _facets_of(view: SeaView) -> _Facets:
    slopes = _rough(view.slopes)
    bands = view.hiding.law_bands(view.slopes)
    return _Facets(
        slopes.mss_up,
        slopes.mss_cross,
        slopes.wind_to_azimuth,
        slopes.is_gaussian,
        np.array(slopes.coefficients),
        between_bands(ratio_table, bands),
    )


@dataclass(frozen=True, eq=False)
class ScatteredMap:
    """Scattered sunlight of one view, tabulated along elevation and azimuth, so that maps of any size are quick.

    Make it with ``prepare``.

    Paths and the mirrored sky are splined over the elevation of the viewer above the horizontal at the sea, in
    ``arsinh(elevation / scale)``, and over the azimuth from the Sun.
    """

    light: ScatteredSun
    _scale: float
    _path: CubicSpline[np.float64]
    _mirrored: CubicSpline[np.float64]
    _beside: Around
    _around: Around

    @classmethod
    def prepare(cls, light: ScatteredSun, scale: float, x: FloatArray) -> ScatteredMap:
        """Tabulate at coordinates ``x`` of the elevation, the mirrored sky at fewer of them."""
        view, beside, around = light.view, Around.path(), Around.mirrored()
        few = np.linspace(x[0], x[-1], _ROWS)
        path = light.path(SeaRows.of(view, np.minimum(scale * np.sinh(x), 0.5 * np.pi)), view.solar_azimuth + beside.azimuth)
        mirrored = light.mirrored(SeaRows.of(view, np.minimum(scale * np.sinh(few), 0.5 * np.pi)), view.solar_azimuth + around.azimuth)
        return cls(light, scale, CubicSpline(x, path), CubicSpline(few, mirrored), beside, around)

    def map(self, gamma: FloatArray, azimuth: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Path and mirrored sky for elevations of the viewer (rows) and azimuths of lines of sight (columns) [rad]."""
        x, turned = np.arcsinh(gamma / self._scale), azimuth - self.light.view.solar_azimuth
        return self._path(x) @ self._beside.weights(turned), self._mirrored(x) @ self._around.weights(turned)

    def along(self, gamma: FloatArray, azimuth: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Path and mirrored sky along a list of lines of sight [(n,)]."""
        x, turned = np.arcsinh(gamma / self._scale), azimuth - self.light.view.solar_azimuth
        path = np.sum(self._path(x) * self._beside.weights(turned).T, axis=1)
        return path, np.sum(self._mirrored(x) * self._around.weights(turned).T, axis=1)
