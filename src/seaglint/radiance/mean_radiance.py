r"""Mean radiance of the sea at the aperture (Eqs. 1-8 of the source article), integrated per wavenumber.

.. math:: L = L_{path} + \tau\,(\bar\epsilon B(T) + L_{sky} + L_{sun})
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import CubicSpline

from seaglint.base.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.base.conventions import FloatArray, horizon_depression, view_zenith
from seaglint.base.errors import DomainError
from seaglint.facet.glint import GlintModel
from seaglint.facet.scattered import Around, ScatteredMap, ScatteredSun, SeaRows
from seaglint.facet.sea_view import SeaView, sea_arc
from seaglint.facet.sky import thermal_at, thermal_sky
from seaglint.facet.sunlight import turn_at
from seaglint.facet.surface_spectra import SeaSurface, azimuth_weights, wind_azimuths
from seaglint.optics.blackbody import planck_wavenumber
from seaglint.optics.fresnel import ReflectanceSeries
from seaglint.radiance.foam_mean import FoamMean

NODES: Final = 160  #: Number of elevations at which a view is tabulated.

SKY_NODES: Final = 4096  #: Number of elevations at which the sky is tabulated, even in the square root of the elevation above the horizon.

_FEW: Final = 49  #: Number of azimuths up to which scattered sunlight is summed for each without interpolation.

_FINEST: Final = 2e-4  #: Least scale of the tabulated elevations [rad]: a mirror's grazing light changes over hundredths.


@dataclass(frozen=True, eq=False)
class MirroredMoon:
    """Mirrored light of the Moon beside the Sun's, as the same fields of ``SeaRadiance``."""

    sun: FloatArray
    chance: FloatArray
    cos_incidence: FloatArray


@dataclass(frozen=True, eq=False)
class SeaRadiance:
    """Band radiance at the aperture by origin [W m-2 sr-1]; arrays broadcast to (rows, columns)."""

    path: FloatArray  #: Thermal radiance of the air between sea and sensor, and sunlight that it scatters; 0 above the horizon.
    emission: FloatArray  #: Emission of the sea, attenuated; 0 above the horizon.
    sky: FloatArray  #: Sky mirrored by the sea, attenuated, with the sunlight scattered there; above the horizon the sky itself.
    sun: FloatArray  #: Sun and Moon mirrored by the sea, attenuated; the Sun itself is not drawn above the horizon.
    chance: FloatArray  #: Share of the viewed area that mirrors the Sun [1, (rows, columns)]; 0 without a Sun and above the horizon.
    cos_incidence: FloatArray  #: Cosine of the angle of incidence on the mirroring facets [1, (rows, columns)]; 0 in the same places.
    foam_sun: FloatArray | float = 0.0  #: Sunlight that foam reflects diffusely, attenuated; it is not glint and does not sparkle.
    #: The part of ``sun`` that is the Moon's where the Moon is a second light (``SeaView.lights``), its chance and incidence; None where
    #: it is not.
    moon: MirroredMoon | None = None

    @property
    def sunlight(self) -> FloatArray:
        """All sunlight that the sea reflects, glint and diffuse [W m-2 sr-1, (rows, columns)]."""
        return np.asarray(self.sun + self.foam_sun)

    @property
    def total(self) -> FloatArray:
        """Sum of all components [W m-2 sr-1, (rows, columns)]."""
        return np.asarray(self.path + self.emission + self.sky + self.sunlight)


def mean_radiance(view: SeaView, elevation: ArrayLike, azimuth: ArrayLike, surface: SeaSurface | None = None) -> SeaRadiance:
    r"""Compute the mean radiance at elevations and azimuths [W m-2 sr-1].

    .. math::

        L_{sun} = \int R\,\tau\,\frac{\rho(\omega)\,E}{\pi\epsilon^2}\,P\;d\nu

    with P of :func:`seaglint.facet.glint.glint`; for slopes much wider than the Sun's image this is Eq. 8. The Sun's direction and its
    irradiance E are taken at the place looked at, E with its spectrum at the sensor's foot.

    Parameters
    ----------
    view : SeaView
        Sensor, sea, air and Sun.
    elevation : array_like
        Elevations of the lines of sight [rad, (rows,)]; negative below the horizontal.
    azimuth : array_like
        Azimuths of the lines of sight, clockwise from north [rad, (columns,)].
    surface : SeaSurface, optional
        Water, sky and sea temperature of the view, from ``SeaSurface.create`` on the band's part of the grid (``view.in_band.grid``);
        views that share them need not compute it again.

    Returns
    -------
    SeaRadiance
        Components, each (rows, 1) or (rows, columns); ``.total`` is (rows, columns).

    Raises
    ------
    DomainError
        A band beyond the atmosphere's grid, or any value that atmosphere, water or slopes refuse.

    Notes
    -----
    Everything is integrated on the atmosphere's spectral samples; structure finer than these (20 cm-1 averages in LOWTRAN7) is not
    resolved, so correlations of absorption between sunlight and path inside them are missed. Rows above the sea horizon show the sky.
    Up to 160 rows are computed one by one, more are interpolated by ``MeanModel``, within 1e-5. With ``view.foam`` each place is a mean
    of water and foam by the mean share of foam.

    References
    ----------
    Source article Eqs. 1-8 and Fig. 1.
    """
    return SeaLines.prepare(view, elevation, azimuth, surface).under(view)


@dataclass(frozen=True, eq=False)
class SeaLines:
    """Lines of sight over one sea and air, with all quantities that do not depend on the Sun. Make it with ``prepare``."""

    surface: SeaSurface | None  #: Water, sky and sea temperature.
    _rows: FloatArray
    _columns: FloatArray
    _gamma: FloatArray
    _weights: FloatArray
    _thermal: ThermalRows | None

    @classmethod
    def prepare(cls, view: SeaView, elevation: ArrayLike, azimuth: ArrayLike, surface: SeaSurface | None = None) -> SeaLines:
        """Prepare elevations and azimuths of a view; arguments as for :func:`mean_radiance`."""
        view, _ = view.lights
        rows, columns = _lines(elevation, azimuth)
        gamma = _sea_elevation(view.sensor_height, rows)
        sea = np.isfinite(gamma)
        azimuths, weights = wind_azimuths(view.slopes), azimuth_weights(view.slopes, columns + np.pi)
        # for a few columns a sum at each costs less than the harmonics of the wind azimuth
        if columns.size < azimuths.size:
            azimuths, weights = columns + np.pi, np.eye(columns.size)
        thermal = None if np.count_nonzero(sea) > NODES else ThermalRows.of(view, gamma[sea], azimuths, surface)
        return cls(surface, rows, columns, gamma, weights, thermal)

    def under(self, view: SeaView) -> SeaRadiance:
        """Mean radiance under the lights of a view that otherwise equals the prepared one, with as many bands of nested shadowing."""
        if self._thermal is None:
            return MeanModel.prepare(view, self.surface).map(self._rows, self._columns)
        rows, columns, sea = self._rows, self._columns, np.isfinite(self._gamma)
        view, second = view.lights
        if second is not None:
            water = _assembled(second, rows, columns, self._gamma, self._thermal.under(second), self._weights, _glint_model(second))
            return _with_moon(self.under(view), self._foamed(second, water, sea))
        water = _assembled(view, rows, columns, self._gamma, self._thermal.under(view), self._weights, _glint_model(view))
        return self._foamed(view, self._with_scattered(view, water, sea), sea)

    def _foamed(self, view: SeaView, water: SeaRadiance, sea: NDArray[np.bool_]) -> SeaRadiance:
        """Mix the light of water with the foam of a view."""
        assert self._thermal is not None  # of these rows
        foam = FoamMean.prepare(view)
        return water if foam is None else _with_foam(water, foam, self._gamma[:, None], self._columns, sea, foam.rows(self._thermal.seen))

    def _with_scattered(self, view: SeaView, out: SeaRadiance, sea: NDArray[np.bool_]) -> SeaRadiance:
        """Add the scattered sunlight of a view."""
        rows, columns = self._rows, self._columns
        where = SeaRows.of(view, self._gamma[sea])
        light = _scattered(view, self.surface, float(where.turn.max(initial=0.0)))
        if light is None:
            return out
        if columns.size <= _FEW:
            scattered = light.path(where, columns), light.mirrored(where, columns)
        else:
            path_nodes, mirrored_nodes = Around.path(), Around.mirrored()
            from_sun = columns - view.solar_azimuth
            scattered = (
                light.path(where, view.solar_azimuth + path_nodes.azimuth) @ path_nodes.weights(from_sun),
                light.mirrored(where, view.solar_azimuth + mirrored_nodes.azimuth) @ mirrored_nodes.weights(from_sun),
            )
        return _with_scattered(out, sea, scattered, light.above(rows[~sea], columns))


@dataclass(frozen=True, eq=False)
class MeanModel:
    """Mean radiance of one view, tabulated along elevation and wind azimuth, so that maps of any size are quick.

    Make it with ``prepare``.

    Path, background and the Sun's spectral sums are splined over the elevation of the viewer above the horizontal at the sea, in
    ``arsinh(elevation / scale)`` with the scale of the sensor's horizon or of the slopes, whichever is finer; the glint's chance is
    computed pixel by pixel.
    """

    view: SeaView  #: Sensor, sea, air and Sun.
    _scale: float
    _spline: CubicSpline[np.float64]
    _glint: GlintModel
    _scattered: ScatteredMap | None
    _foam: tuple[FoamMean, CubicSpline[np.float64]] | None
    _moonlit: MeanModel | None = None  #: Model of the Moon where it is a second light.

    @classmethod
    def prepare(cls, view: SeaView, surface: SeaSurface | None = None) -> MeanModel:
        """Tabulate a view under its lights; ``surface`` as in :func:`mean_radiance`.

        Raises
        ------
        DomainError
            As :func:`mean_radiance`.
        """
        view, second = view.lights
        # even steps of arsinh(gamma/scale) are fine near the horizon and coarse overhead
        scale = horizon_depression(view.sensor_height)
        if not view.slopes.is_flat:
            scale = min(scale, max(np.sqrt(min(view.slopes.mss_up, view.slopes.mss_cross)), _FINEST))
        x = np.linspace(0.0, np.arcsinh(0.5 * np.pi / scale), NODES)
        gamma = np.minimum(scale * np.sinh(x), 0.5 * np.pi)
        light = _scattered(view, surface)
        scattered = None if light is None else ScatteredMap.prepare(light, scale, x)
        rows, foam = ThermalRows.of(view, gamma, wind_azimuths(view.slopes), surface), FoamMean.prepare(view)
        bubbles = None if foam is None else (foam, CubicSpline(x, foam.rows(rows.seen)))
        moonlit = None if second is None else cls.prepare(second)
        return cls(view, scale, CubicSpline(x, rows.under(view)), _glint_model(view), scattered, bubbles, moonlit)

    def map(self, elevation: ArrayLike, azimuth: ArrayLike) -> SeaRadiance:
        """Mean radiance at elevations and azimuths, as :func:`mean_radiance`; within 1e-5 of it."""
        out = self._map(elevation, azimuth)
        return out if self._moonlit is None else _with_moon(out, self._moonlit._map(elevation, azimuth))

    def _map(self, elevation: ArrayLike, azimuth: ArrayLike) -> SeaRadiance:
        rows, columns = _lines(elevation, azimuth)
        gamma = _sea_elevation(self.view.sensor_height, rows)
        sea = np.isfinite(gamma)
        interpolated = self._spline(np.arcsinh(gamma[sea] / self._scale))
        weights = azimuth_weights(self.view.slopes, columns + np.pi)
        out = _assembled(self.view, rows, columns, gamma, interpolated, weights, self._glint)
        if self._scattered is not None:
            out = _with_scattered(out, sea, self._scattered.map(gamma[sea], columns), self._scattered.light.above(rows[~sea], columns))
        return self._foamed(out, gamma[:, None], columns)

    def _foamed(self, out: SeaRadiance, gamma: FloatArray, azimuth: FloatArray) -> SeaRadiance:
        """Mean radiance with the view's foam, for elevations of the viewer (rows, 1) and azimuths that broadcast with them [rad]."""
        if self._foam is None:
            return out
        foam, spline = self._foam
        sea = np.isfinite(gamma[:, 0])
        return _with_foam(out, foam, gamma, azimuth, sea, spline(np.arcsinh(gamma[sea, 0] / self._scale)))

    def along(self, elevation: FloatArray, azimuth: FloatArray) -> SeaRadiance:
        """Mean radiance along a list of lines of sight, elevation and azimuth of each [rad, (n,)]; components are (n, 1)."""
        out = self._along(elevation, azimuth)
        return out if self._moonlit is None else _with_moon(out, self._moonlit._along(elevation, azimuth))

    def _along(self, elevation: FloatArray, azimuth: FloatArray) -> SeaRadiance:
        gamma = _sea_elevation(self.view.sensor_height, elevation)
        sea = np.isfinite(gamma)
        interpolated = self._spline(np.arcsinh(gamma[sea] / self._scale))
        weights = azimuth_weights(self.view.slopes, azimuth[sea] + np.pi)
        k = weights.shape[0]
        path, emission, sky = (np.zeros((elevation.size, 1)) for _ in range(3))
        terms = np.zeros((elevation.size, interpolated.shape[1] - 1 - 2 * k))
        path[sea], terms[sea] = interpolated[:, :1], interpolated[:, 1 + 2 * k :]
        emission[sea, 0] = np.sum(interpolated[:, 1 : 1 + k] * weights.T, axis=1)
        sky[sea, 0] = np.sum(interpolated[:, 1 + k : 1 + 2 * k] * weights.T, axis=1)
        # every line of sight has a different elevation: one interpolation per azimuth node serves all of them
        above, table = self._sky
        sky_rows = np.stack([np.interp(elevation[~sea], above, row) for row in table])
        sky[~sea, 0] = thermal_at(sky_rows, azimuth[~sea], np.arange(sky_rows.shape[1]))
        if self._scattered is not None:
            more_path, more_sky = self._scattered.along(gamma[sea], azimuth[sea])
            path[sea, 0] += more_path
            sky[sea, 0] += more_sky
            sky[~sea, 0] += self._scattered.light.above_along(elevation[~sea], azimuth[~sea])
        turn = turn_at(sea_arc(self.view.sensor_height, gamma))
        out = SeaRadiance(path, emission, sky, *self._glint.grid(0.5 * np.pi - gamma, azimuth[:, None] + np.pi, turn, terms))
        return self._foamed(out, gamma[:, None], azimuth[:, None])

    @cached_property
    def _sky(self) -> tuple[FloatArray, FloatArray]:
        """Elevations from the horizon to the zenith [rad], and the thermal sky there [W m-2 sr-1, (azimuths, elevations)]."""
        # the sky changes fastest at the horizon, where the square root crowds the nodes
        dip = horizon_depression(self.view.sensor_height)
        elevation = np.linspace(0.0, np.sqrt(0.5 * np.pi + dip), SKY_NODES) ** 2 - dip
        return elevation, thermal_sky(self.view, elevation)


def _lines(elevation: ArrayLike, azimuth: ArrayLike) -> tuple[FloatArray, FloatArray]:
    rows = np.atleast_1d(np.asarray(elevation, dtype=np.float64))
    columns = np.atleast_1d(np.asarray(azimuth, dtype=np.float64))
    if rows.ndim != 1 or columns.ndim != 1 or rows.size == 0 or columns.size == 0:
        raise DomainError(f"elevation and azimuth must be lists of angles, not of shapes {rows.shape} and {columns.shape}")
    return rows, columns


def _sea_elevation(height: float, elevation: FloatArray) -> FloatArray:
    """Elevation of the viewer above the horizontal at the sea point looked at [rad]; NaN where the line of sight misses the sea.

    ``cos(gamma) = (1 + h/R') cos(depression)`` by half angles, which keep their digits at the horizon.
    """
    excess = height / EFFECTIVE_EARTH_RADIUS
    square = np.sin(0.5 * elevation) ** 2 * (1.0 + excess) - 0.5 * excess
    with np.errstate(invalid="ignore"):
        return np.asarray(np.where(np.isfinite(view_zenith(height, -elevation)), 2.0 * np.arcsin(np.sqrt(np.maximum(square, 0.0))), np.nan))


def _with_moon(out: SeaRadiance, more: SeaRadiance) -> SeaRadiance:
    """Add the mirrored light of the Moon beside the Sun."""
    moon, foam = MirroredMoon(more.sun, more.chance, more.cos_incidence), out.foam_sun + more.foam_sun
    return replace(out, sun=out.sun + more.sun, foam_sun=foam, moon=moon)


def _glint_model(view: SeaView) -> GlintModel:
    return GlintModel.prepare(view.solar_zenith, view.solar_azimuth, view.slopes, view.shadowing, view.sun_table, view.disc.lit_radius)


def _scattered(view: SeaView, surface: SeaSurface | None, turn: float | None = None) -> ScatteredSun | None:
    """Scattered sunlight over the view's sea, or None, for places with the vertical turned by ``turn``."""
    return ScatteredSun.prepare(
        view, lambda: ReflectanceSeries.of(view.water.index(view.in_band.wavenumber_cm)) if surface is None else surface.reflectance, turn
    )


def _with_scattered(out: SeaRadiance, sea: NDArray[np.bool_], scattered: tuple[FloatArray, FloatArray], above: FloatArray) -> SeaRadiance:
    """Add scattered sunlight to path and sky components, for rows of sea and rows above."""
    path, sky = (np.broadcast_to(component, out.chance.shape).copy() for component in (out.path, out.sky))
    path[sea] += scattered[0]
    sky[sea] += scattered[1]
    sky[~sea] += above
    return replace(out, path=path, sky=sky)


def _with_foam(
    out: SeaRadiance, foam: FoamMean, gamma: FloatArray, azimuth: FloatArray, sea: NDArray[np.bool_], bubbles: FloatArray
) -> SeaRadiance:
    """Mix the light of a sea of water alone with foam, for rows of sea.

    ``gamma`` (rows, 1) and ``azimuth`` as for ``FoamMean.incidence``; ``bubbles``: ``FoamMean.rows`` of the rows of sea.
    """
    share, mirroring = foam.cover.share, foam.cover.mirroring
    emission, sky, sun, chance = (np.array(part) for part in (out.emission, out.sky, out.sun, out.chance))
    emission[sea] = mirroring * emission[sea] + share * bubbles[:, :1]
    sky[sea] = mirroring * sky[sea] + share * bubbles[:, 1:2]
    sun[sea] *= mirroring
    chance[sea] *= mirroring
    diffuse = np.zeros(sun.shape)
    lines = azimuth[sea] if azimuth.ndim > 1 else azimuth
    diffuse[sea] = share * bubbles[:, 2:] * foam.incidence(gamma[sea], lines)
    return replace(out, emission=emission, sky=sky, sun=sun, chance=chance, foam_sun=diffuse)


@dataclass(frozen=True, eq=False)
class ThermalRows:
    """Path, emission and sky of sea rows [W m-2 sr-1, (rows, 1 + 2 k)], and the path of the mirrored Sun. Make it with ``of``."""

    terms: FloatArray
    seen: FloatArray
    coefficients: FloatArray

    @classmethod
    def of(cls, view: SeaView, gamma: FloatArray, azimuths: FloatArray, surface: SeaSurface | None) -> ThermalRows:
        """Rows at elevations of the viewer and k view azimuths [rad]."""
        over, nu = view.in_band, view.in_band.wavenumber_cm
        arc = sea_arc(view.sensor_height, gamma)
        seen = view.atmosphere.transmittance(view.sensor_height, arc)[..., over.grid] * over.weights
        path = over(view.atmosphere.path_radiance(view.sensor_height, arc))[:, None]
        if view.background == "blackbody":
            emission = np.repeat((seen @ planck_wavenumber(nu, view.sea_temperature))[:, None], azimuths.size, axis=1)
            sky = np.zeros_like(emission)
            series = ReflectanceSeries.of(view.water.index(nu)) if surface is None else surface.reflectance
        else:
            if surface is None:
                surface = SeaSurface.create(view.atmosphere, view.water, view.sea_temperature, over.grid)
            leaving = surface.in_band(0.5 * np.pi - gamma, azimuths, view.slopes, seen, view.hiding.law_bands(view.slopes))
            emission, sky, series = leaving.emission, leaving.sky, surface.reflectance
        return cls(np.concatenate([path, emission, sky], axis=1), seen, series.coefficients)

    def under(self, view: SeaView) -> FloatArray:
        """Terms, followed by the terms of the mirrored Sun of a view [W m-2 sr-1, (rows, 1 + 2 k + terms)]."""
        # The spectral sum over each Chebyshev term is taken per row; the pixels then only need their angle of incidence.
        per_term = (self.seen * view.irradiance) @ self.coefficients.T / (np.pi * view.disc.lit_radius**2)
        return np.concatenate([self.terms, per_term], axis=1)


def _assembled(
    view: SeaView, rows: FloatArray, columns: FloatArray, gamma: FloatArray, sampled: FloatArray, weights: FloatArray, glint: GlintModel
) -> SeaRadiance:
    """Components on rows and columns, from the terms of the rows of sea and the weights of their azimuths (k, columns)."""
    sea = np.isfinite(gamma)
    k = weights.shape[0]
    table = np.zeros((rows.size, sampled.shape[1]))
    table[sea] = sampled
    # without any dependence on azimuth one column broadcasts over all; columns of ``table``: path, k emissions, k skies, Sun
    wide = weights[:, :1] if view.slopes.is_isotropic and view.atmosphere.sky_azimuths == 1 else weights
    path, emission, sky = table[:, :1], table[:, 1 : 1 + k] @ wide, table[:, 1 + k : 1 + 2 * k] @ wide
    turn = turn_at(sea_arc(view.sensor_height, gamma))
    mirrored = glint.grid(0.5 * np.pi - gamma, columns + np.pi, turn, table[:, 1 + 2 * k :])
    if not np.all(sea):
        above = thermal_sky(view, rows[~sea])
        sky[~sea] = thermal_at(above, columns[: sky.shape[1]], np.arange(above.shape[1])[:, None])
    return SeaRadiance(path, emission, sky, *mirrored)
