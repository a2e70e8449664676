"""Shipped atmosphere at one wind: LOWTRAN7 with its Navy maritime aerosol, tabulated.

:mod:`seaglint.air.table.table_file` says what the files hold, :mod:`seaglint.air.table.batch` takes a wind for each case.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import CubicSpline, PchipInterpolator

from seaglint.air.coordinates import (
    decode_optical_depth,
    dip_coordinate,
    elevation_coordinate,
    path_coordinate,
    sky_height_coordinate,
    spline_weights,
    straight_sea_cosine,
    straight_slant,
)
from seaglint.air.protocol import ClearAir, require_height, require_line, slant_range
from seaglint.air.sky_spline import brightness_temperature
from seaglint.air.table import low_sky
from seaglint.air.table.absorbers import Absorbers, BandLaw
from seaglint.air.table.stencil import Stencil, with_slopes
from seaglint.air.table.table_file import ANGLE_SLACK, BandTable, Spectra
from seaglint.base.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.base.conventions import FloatArray, horizon_depression
from seaglint.base.errors import DomainError
from seaglint.base.free_form import JsonObject
from seaglint.optics.blackbody import planck_wavenumber

if TYPE_CHECKING:
    from seaglint.air.scattering.scattering_laws import ScatteringAir

_LAW_HEIGHTS = np.array([2.0, 12.0, 70.0, 280.0, 700.0, 1060.0, 1450.0, 2000.0, 2600.0, 2990.0, 3400.0, 5000.0, 7000.0, 10e3])
"""Heights of the paths to the sea that the band law is fitted to, nine lengths each [m]."""

_CASES_AT_ONCE = 512
"""Paths to points above the sea that are computed together: tens of megabytes."""


def _at_wind(weights: FloatArray, of_winds: Spectra) -> Spectra:
    return Spectra(of_winds.mean, of_winds.components, np.tensordot(weights, of_winds.scores, axes=1))


def _along(spectra: Spectra, scores: FloatArray, x: FloatArray) -> FloatArray:
    """Spectra at ``x`` of even nodes 0...1: cubic spline between them, the end's tangent beyond the last one."""
    nodes = np.linspace(0.0, 1.0, scores.shape[0])
    spline = CubicSpline(nodes, scores)
    inside = np.minimum(x, nodes[-1])
    return spectra.of(spline(inside) + (x - inside)[..., np.newaxis] * spline(nodes[-1], 1))


@dataclass(frozen=True, eq=False)
class TableAtmosphere(ClearAir):
    """LOWTRAN7 model atmosphere at one wind speed, over one band. Make it with :meth:`load`.

    Notes
    -----
    Heights 2 m to 10 km, wind (U10, also the 24-hour mean) 0 to 20 m/s, arcs from 0 to the sea horizon. Beyond the horizon,
    where only wave crests are seen, encoded optical depth and air temperature go on along their tangent in log path length.
    LOWTRAN7 takes calm (0 m/s) for "unknown"; the table's 0 m/s is its limit for little wind. Radiance is thermal: sunlight
    scattered by the air is not in it. Spectral resolution is LOWTRAN7's 20 cm-1, sampled every 5.

    Against LOWTRAN7 runs off the nodes (random heights 2 m-10 km, angles and winds; 3-5 um) the 95th percentile of the error is 0.15 % of
    band transmittance, 0.1 % of path radiance and sunlight, 0.05 % of the sky seen from the sea, and 1.5 % (largest 5 %) of the sky seen
    from a height within four dips of the sea horizon, where LOWTRAN7's layers are met almost along (0.9 % from below 5 km). Sensors below
    300 m see less of these layers below 0.5 deg of elevation, from 100 m down none (:mod:`seaglint.air.table.low_sky`): within 0.03 K of
    apparent temperature in 3.5-5 um, 0.06 K in 8-12 um, of LOWTRAN7 runs with layers some metres thick.

    To points above the sea, against 840 random LOWTRAN7 runs between two heights (sensors 2 m-10 km, ranges 0.1-60 km, all models and
    winds; 3-5, 3.5-5 and 8-12 um), the 95th percentile of the error of band transmittance and path radiance is 0.2 % and 0.4 % for
    points below 1 km within 20 km, 0.9 % and 0.5 % beyond, 3 % and 4 % for points at 1-3 km; from 3 to 10 km 5 % of both, single
    cases 12 %, and two thirds of the small radiance of thin air in 8-12 um.

    References
    ----------
    Kneizys, F. X., et al. (1988), Users Guide to LOWTRAN 7, AFGL-TR-88-0177; Gathman, S. G. (1983), Optical properties of
    the marine aerosol as predicted by the Navy aerosol model, Opt. Eng. 22, 57-62.

    Examples
    --------
    >>> air = TableAtmosphere.load("midlatitude-summer", wind_speed=7.0, band_um=(3.5, 5.0))
    >>> air.transmittance(100.0, [1000.0, 10000.0]).shape
    (2, 173)
    """

    model: str
    wind_speed: float
    wavenumber_cm: FloatArray
    provenance: JsonObject
    _table: BandTable
    _path_depth: Spectra
    _path_temperature: Spectra
    _sun_depth: Spectra
    _sky_temperature: Spectra
    _sky_dip: Spectra
    _extrapolate: bool = False
    extrapolated: tuple[str, ...] = ()
    """Quantities outside the table at every height: ``("wind_speed",)`` or empty; see :meth:`extrapolated_at`."""

    @classmethod
    def load(
        cls, model: str, wind_speed: float, band_um: tuple[float, float] = (3.0, 5.0), *, extrapolate: bool = False
    ) -> TableAtmosphere:
        """Read the table of ``model`` and interpolate it to a wind.

        Parameters
        ----------
        model : str
            One of :func:`~seaglint.air.table.table_file.models`, e.g. ``"midlatitude-summer"``.
        wind_speed : float
            U10 of the Navy maritime aerosol [m s-1], 0 to 20.
        band_um : (float, float)
            Wavelengths that the spectral samples have to cover [um]; inside 2-5.5 um or 7.5-14 um.
        extrapolate : bool
            Take winds and heights beyond the table instead of refusing them. Winds above 20 m/s are 20 m/s, as in LOWTRAN7
            itself; from below 2 m a path is the one of equal length that ends at 2 m; from above 10 km it is its part below
            10 km (the same ray at the sea), and the sky is that of 10 km. Bands and negative values are always refused.

        Raises
        ------
        DomainError
            For an unknown model, a wind or a band outside the table.
        DataError
            If the file in the package is damaged.
        """
        table = BandTable.read(model, band_um)
        winds = table.winds
        if not winds[0] <= wind_speed <= (np.inf if extrapolate else winds[-1]):
            raise DomainError(
                f"wind_speed = {wind_speed:g} m/s is outside {winds[0]:g}-{winds[-1]:g} m/s of the Navy maritime aerosol",
                name="wind_speed",
                value=wind_speed,
                allowed=(float(winds[0]), float(winds[-1])),
            )
        weights = spline_weights(winds, table.wind_kinks, min(wind_speed, float(winds[-1])))
        return cls(
            model=model,
            wind_speed=float(wind_speed),
            wavenumber_cm=table.wavenumber_cm,
            provenance=table.provenance,
            _table=table,
            _path_depth=_at_wind(weights, table.path_depth),
            _path_temperature=_at_wind(weights, table.path_temperature),
            _sun_depth=_at_wind(weights, table.sun_depth),
            _sky_temperature=_at_wind(weights, table.sky_temperature),
            _sky_dip=_at_wind(weights, table.sky_dip),
            _extrapolate=extrapolate,
            extrapolated=("wind_speed",) if wind_speed > winds[-1] else (),
        )

    @property
    def _height_range(self) -> tuple[float, float]:
        return float(self._table.heights[0]), float(self._table.heights[-1])

    def extrapolated_at(self, height: float) -> tuple[str, ...]:
        """Names of the quantities outside the table for a sensor at ``height`` [m]; empty inside it."""
        lowest, highest = self._height_range
        return self.extrapolated if lowest <= height <= highest else (*self.extrapolated, "sensor_height")

    def _height_weights(self, height: float) -> FloatArray:
        lowest, highest = self._height_range
        if self._extrapolate and height > 0.0:
            height = min(max(height, lowest), highest)
        require_height(height, lowest, highest, "choose a height inside it")
        return spline_weights(*self._table.height_axis, float(self._table.height_coordinate(height)))

    def _horizon_slant(self, height: float, weights: FloatArray) -> float:
        """Slant path to the sea horizon that LOWTRAN7's refraction gives, in the table's straight geometry [m]."""
        return float(straight_slant(height, 0.0) * np.exp(weights @ self._table.horizon_excess))

    def _path_coordinate(self, height: float, arc: FloatArray, weights: FloatArray) -> FloatArray:
        """Coordinate along the table's paths [1] of those from the sea at arcs [m] to the sensor."""
        lowest, highest = self._height_range
        slant = slant_range(height, arc)
        if height > highest:
            slant = straight_slant(highest, straight_sea_cosine(height, slant))
        inside = min(max(height, lowest), highest)
        return path_coordinate(slant, inside, self._horizon_slant(inside, weights))

    def _sea_path(self, height: float, arc: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Optical depth [1] and effective air temperature [K] of paths from the sea, both (..., n)."""
        weights = self._height_weights(height)
        x = self._path_coordinate(height, arc, weights)
        depth, air = (
            _along(spectra, np.tensordot(weights, spectra.scores, axes=1), x) for spectra in (self._path_depth, self._path_temperature)
        )
        return decode_optical_depth(depth), air

    def path(self, height: float, range_m: ArrayLike, target_height: ArrayLike = 0.0) -> tuple[FloatArray, FloatArray]:
        """Transmittance [1] and thermal path radiance [W m-2 sr-1 per cm-1] together, both (..., n).

        Parameters
        ----------
        height : float
            Sensor height [m].
        range_m : array_like
            Arc along the sea to the point looked at [m, (...)].
        target_height : array_like
            Height of that point [m], broadcast with ``range_m``; up to 10 km.

        Raises
        ------
        DomainError
            Heights outside the table, or a line too deep below the sea (:data:`~seaglint.air.protocol.DEEPEST_LINE`).

        Notes
        -----
        To a point above the sea, optical depth is that of a path of the same length to the sea, times the ratio of what the absorbers on
        both amount to (:class:`~seaglint.air.table.absorbers.BandLaw`, fitted to the table). The sensor of the path to the sea stands
        at the sum of both heights, so that the mean height is the same, or straight above the sea where that is longer than the line.
        The air's emission is that of the model atmosphere's layers; as far as the point is low, it is corrected by the table's.
        Transmittance does not change when sensor and point change places.
        """
        arc, target = require_line(height, range_m, target_height)
        if not target.any():
            depth, air = self._sea_path(height, arc)
            return np.exp(-depth), -np.expm1(-depth) * planck_wavenumber(self.wavenumber_cm, air)
        depth, glow = self._line(height, arc, target, emission=True)
        return np.exp(-depth), -np.expm1(-depth) * glow

    def transmittance(self, height: float, range_m: ArrayLike, target_height: ArrayLike = 0.0) -> FloatArray:
        """Transmittance of the path from a point at arcs ``range_m`` [m, (...)] and a height to the sensor [1, (..., n)]."""
        arc, target = require_line(height, range_m, target_height)
        if not target.any():
            weights = self._height_weights(height)
            scores = np.tensordot(weights, self._path_depth.scores, axes=1)
            x = self._path_coordinate(height, arc, weights)
            return np.asarray(np.exp(-decode_optical_depth(_along(self._path_depth, scores, x))))
        return np.asarray(np.exp(-self._line(height, arc, target, emission=False)[0]))

    def path_radiance(self, height: float, range_m: ArrayLike, target_height: ArrayLike = 0.0) -> FloatArray:
        """Thermal radiance of the air between the point and the sensor [W m-2 sr-1 per cm-1, (..., n)]."""
        return self.path(height, range_m, target_height)[1]

    @cached_property
    def _law(self) -> BandLaw:
        """Band law of this air, fitted to its own paths to the sea."""
        height = np.repeat(_LAW_HEIGHTS, 9)
        slant = height * (straight_slant(height, 0.0) / height) ** np.tile(np.linspace(0.0, 1.0, 9), _LAW_HEIGHTS.size)
        absorbers = Absorbers.of_model(self.model, self._table.region)
        amount = absorbers.along(height, np.zeros_like(height), slant).whole
        return BandLaw.fit(absorbers, self.wavenumber_cm, amount, self._sea_paths(height, slant)[0])

    @cached_property
    def _path_nodes(self) -> FloatArray:
        """Scores of depth and temperature side by side, values and slopes along the path [(heights, 2 nodes, components)]."""
        scores = np.concatenate([self._path_depth.scores, self._path_temperature.scores], axis=-1)
        return with_slopes(np.linspace(0.0, 1.0, scores.shape[-2]), scores)

    def _sea_paths(self, height: FloatArray, slant: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Optical depth [1] and air temperature [K], (cases, n), of paths from the sea by sensor height and length [m, (cases,)]."""
        at = self._table.at_heights(height)
        horizon = straight_slant(height, 0.0) * np.exp(at.of(self._table.horizon_excess))
        along = Stencil.hermite(np.linspace(0.0, 1.0, self._path_nodes.shape[1] // 2), path_coordinate(slant, height, horizon))
        return self._table.path_at(self._path_nodes, at.times(along))

    def _line(self, height: float, arc: FloatArray, target: FloatArray, *, emission: bool) -> tuple[FloatArray, FloatArray]:
        """Optical depth [1] and, if requested, blackbody radiance of the air [W m-2 sr-1 per cm-1] of paths to any height, (..., n)."""
        self._height_weights(height)  # refuses heights outside the table
        if np.any(target > self._height_range[1]):
            highest = self._height_range[1]
            raise DomainError(
                f"target_height = {target.max():g} m is above {highest:g} m of this atmosphere; choose heights below it",
                name="target_height",
                value=float(target.max()),
                allowed=(0.0, highest),
            )
        n = self.wavenumber_cm.size
        depth, glow = np.empty((arc.size, n)), np.zeros((arc.size, n))
        flat_arc, flat_target = arc.ravel(), target.ravel()
        sea = flat_target == 0.0
        if sea.any():
            depth[sea], air = self._sea_path(height, flat_arc[sea])
            glow[sea] = planck_wavenumber(self.wavenumber_cm, air)
        above = np.flatnonzero(~sea)
        for first in range(0, above.size, _CASES_AT_ONCE):
            some = above[first : first + _CASES_AT_ONCE]
            depth[some], glow[some] = self._to_points(height, flat_arc[some], flat_target[some], emission)
        return depth.reshape(*arc.shape, n), glow.reshape(*arc.shape, n)

    def _to_points(self, height: float, arc: FloatArray, target: FloatArray, emission: bool) -> tuple[FloatArray, FloatArray]:
        law, (lowest, highest) = self._law, self._height_range
        slant = slant_range(height, arc, target)
        upper, lower = np.maximum(height, target), np.minimum(height, target)
        sensor = np.clip(np.minimum(upper + lower, slant), lowest, highest)
        length = np.maximum(slant, sensor)
        pieces = law.absorbers.along(upper, lower, slant)
        to_sea = law.absorbers.along(sensor, np.zeros_like(sensor), length)
        known, air = self._sea_paths(sensor, length)
        scale = law.scale(to_sea.whole, known)
        depth = scale * law.optical_depth(pieces.whole)
        if not emission:
            return depth, np.zeros_like(depth)
        ours, at_sea = law.emission(pieces.reversed(target > height), scale), law.emission(to_sea, scale)
        # The table knows what air a sensor aloft has before it; the point's share in the heights says how little of that is on the line.
        alike = np.maximum(height - target, 0.0) / (height + np.abs(target))
        return depth, ours * (planck_wavenumber(self.wavenumber_cm, air) / at_sea) ** alike[:, None]

    def range_of_depression(self, height: float, depression: ArrayLike) -> FloatArray:
        """Arc to the sea point [m] at which LOWTRAN7's refracted ray of this depression ends; NaN where it misses the sea.

        Differs from :func:`seaglint.base.conventions.surface_range` by tens of per cent close to the horizon. Use it to compare
        with LOWTRAN7 runs made by angle.
        """
        weights = self._height_weights(height)
        cosine = self._table.refraction.sea_cosine(height, depression)
        straight = path_coordinate(straight_slant(height, cosine), height, float(straight_slant(height, 0.0)))
        ray = CubicSpline(np.linspace(0.0, 1.0, self._table.ray.shape[1]), weights @ self._table.ray)
        slant = height * (self._horizon_slant(height, weights) / height) ** ray(straight)
        chord = (slant**2 - height**2) / (4.0 * EFFECTIVE_EARTH_RADIUS * (EFFECTIVE_EARTH_RADIUS + height))
        return np.asarray(2.0 * EFFECTIVE_EARTH_RADIUS * np.arcsin(np.sqrt(np.maximum(chord, 0.0))))

    def scattering(self, grid: slice) -> ScatteringAir | None:
        """Scatterers on part of the spectral samples; None in 7.5-14 um, where the air scatters almost no sunlight."""
        if self._table.region != "mwir":
            return None
        # Numba comes with it: the thermal tables do without.
        from seaglint.air.profile.profile_scattering import maritime, model_scatterers

        return model_scatterers(self.model, tuple(self.wavenumber_cm[grid].tolist())).with_haze(maritime(self.wind_speed))

    def solar_irradiance(self, solar_zenith: ArrayLike) -> FloatArray:
        """Direct sunlight at the sea, normal to the beam, Sun at 1 au [W m-2 per cm-1, (..., n)]; 0 beyond a zenith angle of pi/2.

        ``solar_zenith`` is the apparent (refracted) zenith angle of the point of the Sun looked at [rad, (...)].
        """
        y = self._table.sun_coordinate(solar_zenith)
        return self._table.sunlight(solar_zenith, _along(self._sun_depth, self._sun_depth.scores, y))

    def sky_radiance(self, zenith: ArrayLike, azimuth: ArrayLike, height: float = 0.0) -> FloatArray:
        """Thermal radiance of the clear sky in directions [rad, (...)] seen from ``height`` [W m-2 sr-1 per cm-1, (..., n)].

        From a height the angles reach down to the sea horizon, ``pi/2 + horizon_depression(height)``; lower ones see the sea
        and are refused. Below half a degree above the horizontal the sky that a low sensor sees is that of continuous air
        (:mod:`seaglint.air.table.low_sky`); the sky seen from the sea itself (0 m) is LOWTRAN7's own everywhere.
        """
        highest = float(self._table.sky_heights[-1])
        at = min(height, highest) if self._extrapolate else height
        require_height(at, 0.0, highest, "choose a height inside it")
        dip = horizon_depression(height) if height > 0.0 else 0.0
        elevation = 0.5 * np.pi - np.broadcast_arrays(np.asarray(zenith, dtype=np.float64), azimuth)[0]
        if not np.all((elevation >= -dip - ANGLE_SLACK) & (elevation <= 0.5 * np.pi + ANGLE_SLACK)):
            raise DomainError(
                f"zenith has values outside 0-{np.degrees(0.5 * np.pi + dip):.4f} deg, where the sky of a sensor at {height:g} m ends; "
                "directions below the sea horizon see the sea"
            )
        temperature = self._layered_sky(at, dip, elevation)
        share = low_sky.share(at, elevation)
        low = share > 0.0
        if low.any():
            temperature[low] += share[low][:, None] * (self._continuous_sky(at, dip, elevation[low]) - temperature[low])
        return planck_wavenumber(self.wavenumber_cm, temperature)

    def _layered_sky(self, height: float, dip: float, elevation: FloatArray) -> FloatArray:
        """Brightness temperature [K, (..., n)] of LOWTRAN7's own sky at elevations [rad, (...)] down to ``dip`` below the horizontal."""
        table = self._table
        levels = (*table.levels, float(table.sky_heights[-1]))
        u = sky_height_coordinate(table.sky_heights, levels)
        here = float(sky_height_coordinate(height, levels))
        kinks = tuple(float(j) for j, level in enumerate(table.levels, 1) if level in table.sky_heights)
        weights = spline_weights(u, kinks, here)
        y = np.minimum(elevation_coordinate(np.maximum(elevation, 0.0), table.refraction.dip(height) if height > 0.0 else 0.0), 1.0)
        temperature = _along(self._sky_temperature, np.tensordot(weights, self._sky_temperature.scores, axes=1), y)
        below = elevation < 0.0
        if dip > 0.0 and below.any():
            # Seen from the sea there is no sky below the horizontal: the table holds the horizontal there, which is no node here.
            weights = spline_weights(u[1:], kinks, max(here, float(u[1])))
            x = np.minimum(dip_coordinate(-elevation[below], dip), 1.0)
            temperature[below] = _along(self._sky_dip, np.tensordot(weights, self._sky_dip.scores[1:], axes=1), x)
        return temperature

    def _continuous_sky(self, height: float, dip: float, elevation: FloatArray) -> FloatArray:
        """Brightness temperature [K, (cases, n)] of the sky in continuous air, at elevations near the sea horizon [rad, (cases,)]."""
        nodes = low_sky.nodes(dip)
        layered = planck_wavenumber(self.wavenumber_cm, self._layered_sky(height, dip, nodes))
        continuous = layered * low_sky.continuous_over_layered(self._law, height, nodes)
        smooth = PchipInterpolator(nodes, brightness_temperature(self.wavenumber_cm, continuous))
        return np.asarray(smooth(np.maximum(elevation, nodes[0])))
