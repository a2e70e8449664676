"""Air of a profile as an atmosphere: spectra of paths, sky and sunlight, splined between rays that are computed on first use.

A path is named by height and range, over the straight lines of ``seaglint.base.conventions``; the sky between the horizontal and the
sea's horizon by its share of the dip. So the camera's standard refraction and the profile's refraction meet at the same horizon.

**Nodes.** A sounding may have any layers, so nodes are added where a spline needs them (``refined_nodes``). Two splines, each through
every other node, are compared with the nodes left out. Where they differ much, rays are added in the middle between nodes until the spline
agrees with them. Smooth air costs no ray more than the first nodes.

**Many winds.** ``WindyAir`` gives transmittance and sunlight of one profile at many winds, without emission, for likelihoods of
sunlight. Transmittance is ``exp(-gases - aerosol)`` and the wind affects the aerosol alone: gases are summed once, the aerosol per wind.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from typing import TYPE_CHECKING, Final, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import CubicSpline

from seaglint.air.coordinates import decode_optical_depth, encode_optical_depth, straight_sea_cosine, straight_slant
from seaglint.air.profile.aerosols import HazeWeather
from seaglint.air.profile.air_profile import AirProfile
from seaglint.air.profile.air_sums import CUTS, AirSums, GasRays, joined_lines
from seaglint.air.profile.band_laws import Spectroscopy
from seaglint.air.profile.ray_paths import LayeredIndex
from seaglint.air.protocol import ANGLE_SLACK, ClearAir, require_height, require_line, require_solar_zenith, slant_range
from seaglint.air.sun_and_sky import brightness_temperature, radiance_of
from seaglint.base.conventions import FloatArray, horizon_depression
from seaglint.base.errors import DomainError
from seaglint.base.free_form import JsonObject
from seaglint.base.limits import PROFILE_HEIGHTS
from seaglint.base.reports import REPORTS

if TYPE_CHECKING:
    from seaglint.air.scattering.scattering_laws import ScatteringAir


LIMIT: Final = 0.01  #: Error between nodes from which on one more is added [K].

#: Error of a node left out, in parts of ``LIMIT``, from which on its neighbourhood is checked: with twice the nodes a smooth spline is
#: 16 times better, one over a corner at least 2 times.
SUSPECT: Final = 4.0

MOST_TIMES: Final = 4  #: Largest number of nodes, in parts of the first ones.

DEEPEST: Final = 5  #: Number of times that an interval between two of the first nodes may be halved.

Values = Callable[[FloatArray], FloatArray]
Errors = Callable[[FloatArray, FloatArray], FloatArray]

Levels = Literal["continuous", "lowtran"]

#: Wavelengths [um] from which on scattered sunlight counts for nothing (at 7 m/s at most 1e-3 of the thermal radiance in the warmer models,
#: 4e-3 in midlatitude and 9e-3 in subarctic winter, looking into the Sun).
THERMAL_UM: Final = 5.5

PATH_NODES: Final = 40
SUN_NODES: Final = 40
SKY_NODES: Final = 44
DIP_NODES: Final = 20  #: Numbers of rays between which spectra are splined.

#: Elevations up to which the sky is computed, the least that holds all elevations of a request [rad]: pictures of the sea need the sky next
#: to the horizon alone, whose rays are a third of all.
SKY_TOPS: Final = tuple(float(angle) for angle in np.radians((0.2, 3.0, 90.0)))

#: Rays above such an elevation; their spline's end changes the sky below it by less than 1e-6 K.
RAYS_BEYOND: Final = 8

#: Steps of the lowest height of rays that start downwards [m] above heights [m].
LOWEST_STEPS: Final = ((0.0, 200.0), (20e3, 1e3), (50e3, 5e3))

#: Paths longer than to the horizon, to crests of waves, are computed up to this many times its length and continue along their tangent.
BEYOND: Final = 1.1

SKY_SCALE: Final = 0.004  #: Angle at which the spacing of the sky's rays changes from even to geometric [rad].

COLD: Final = 200.0  #: Temperature [K] at which errors of colder sky are converted to temperature: a dark band has no temperature.

CLEAR: Final = 1e-9  #: Smallest optical depth whose emission is evaluated.

HEIGHT_RATIO: Final = 1.05  #: Ratio of neighbouring heights between which the air of a sensor that moves is blended.


class RefinedNodes(NamedTuple):
    """Places [(n,)] and values [(n, ...)] of nodes, and the largest error between them that is left [K]."""

    place: FloatArray
    value: FloatArray
    residual: float


def refined_nodes(place: FloatArray, values: Values, errors: Errors) -> RefinedNodes:
    """Add nodes until a spline through them is within ``LIMIT`` in the middle of every checked interval.

    Parameters
    ----------
    place : ndarray
        First nodes, ascending [1, (n,)].
    values : callable
        Values at places [(m,)] (m, ...).
    errors : callable
        Errors of splined values (m, ...) against values (m, ...) [K, (m,)].

    Returns
    -------
    RefinedNodes
        Nodes, and the largest error [K] of the last ones added if their number is exhausted; 0 if all were within the limit.
    """
    x, y = place, values(place)
    suspect, residual = _suspect_intervals(x, y, errors), 0.0
    for _ in range(DEEPEST):
        at = np.flatnonzero(suspect)
        if at.size == 0 or x.size + at.size > MOST_TIMES * place.size:
            break
        midpoint = 0.5 * (x[at] + x[at + 1])
        new = values(midpoint)
        error = errors(CubicSpline(x, y, axis=0)(midpoint), new)
        order = np.argsort(np.concatenate([x, midpoint]), kind="stable")
        wrong = np.concatenate([np.zeros(x.size, dtype=bool), error > LIMIT])[order]
        x, y = np.concatenate([x, midpoint])[order], np.concatenate([y, new])[order]
        # both halves, and their neighbours
        suspect = wrong[:-1] | wrong[1:]
        suspect[1:] |= wrong[:-2]
        suspect[:-1] |= wrong[2:]
        residual = float(error.max()) if suspect.any() else 0.0
    return RefinedNodes(x, y, residual)


def _suspect_intervals(x: FloatArray, y: FloatArray, errors: Errors) -> NDArray[np.bool_]:
    """Intervals next to nodes that a spline through every other node misses [(n - 1,)]."""
    error = np.zeros(x.size)
    for first in (1, 2):
        omitted = np.arange(first, x.size - 1, 2)
        retained = np.setdiff1d(np.arange(x.size), omitted)
        error[omitted] = errors(CubicSpline(x[retained], y[retained], axis=0)(x[omitted]), y[omitted])
    bad = error > SUSPECT * LIMIT
    return np.asarray(bad[:-1] | bad[1:])


@dataclass(frozen=True, eq=False)
class _Paths:
    """Spline of paths from the sea to one height over the logarithm of their length."""

    first: float
    last: float
    spline: CubicSpline[np.float64]

    def __call__(self, slant: FloatArray) -> FloatArray:
        x = np.log(np.maximum(slant, self.first))
        inside = np.minimum(x, self.last)
        values = np.asarray(self.spline(inside))
        beyond = (x - inside)[..., np.newaxis, np.newaxis]
        return values + beyond * self.spline(self.last, 1) if np.any(beyond) else values


class ProfileAtmosphere(ClearAir):
    """Air of a profile with a haze over one band.

    Parameters
    ----------
    profile : AirProfile
        The air.
    haze : HazeWeather
        Its aerosol.
    wavenumber_cm : ndarray
        Channels [cm-1, (n,)].
    levels : str
        ``continuous``: emission by the temperature at the place; ``lowtran``: of LOWTRAN7's layers, for comparison with it.
    scattering : callable, optional
        Function that makes the scatterers on part of the channels; None for air that scatters almost no sunlight.
    moving : bool
        True for a sensor that changes its height: spectra are blended between heights 5 % apart, so that one set of rays serves a
        whole track.
    spectroscopy : str
        Numbers of the band laws: ``lblrtm`` or ``lowtran7``.
    rays : GasRays, optional
        Rays shared with the same air in another haze.
    provenance : mapping, optional
        Further entries of the record of its origin.

    Notes
    -----
    Rays are computed when a height is first requested. Between them brightness temperature and encoded optical depth are splined, with more
    rays where two splines through half of them disagree (:mod:`seaglint.air.profile.profile_atmosphere`); errors of band temperatures above
    0.01 K that are known to be left are reported (docs, validation). Heights 1 cm to 100 km.
    """

    def __init__(
        self,
        profile: AirProfile,
        haze: HazeWeather,
        wavenumber_cm: FloatArray,
        *,
        levels: Levels = "continuous",
        scattering: Callable[[slice], ScatteringAir] | None = None,
        provenance: JsonObject | None = None,
        moving: bool = False,
        spectroscopy: Spectroscopy = "lblrtm",
        rays: GasRays | None = None,
    ) -> None:
        self.wavenumber_cm = np.asarray(wavenumber_cm, dtype=np.float64)
        self.sums = AirSums(profile, haze, self.wavenumber_cm, spectroscopy=spectroscopy, rays=rays)
        self.levels = levels
        self.name = profile.name
        self.provenance: JsonObject = {"table": profile.name, **self.sums.laws.numbers.provenance, "levels": levels, **(provenance or {})}
        self._scattering = scattering
        self._moving = moving
        self._error_reported = False
        self._paths: dict[float, _Paths] = {}
        self._skies: dict[tuple[float, float], CubicSpline[np.float64]] = {}
        self._suns: dict[float, CubicSpline[np.float64]] = {}
        self._scatterers: dict[tuple[int | None, int | None, int | None], ScatteringAir] = {}

    @property
    def index(self) -> LayeredIndex:
        """Refraction of the profile, ducts included."""
        return self.sums.index

    def scattering(self, grid: slice) -> ScatteringAir | None:
        """Scatterers on part of the channels; the same object for the same part."""
        if self._scattering is None:
            return None
        key = (grid.start, grid.stop, grid.step)
        if key not in self._scatterers:
            self._scatterers[key] = self._scattering(grid)
        return self._scatterers[key]

    def _sea_paths(self, height: float) -> _Paths:
        """Spline of encoded depth and air temperature, side by side, of the paths from the sea to a height."""
        cached = self._paths.get(height)
        if cached is not None:
            return cached
        horizon = float(straight_slant(height, 0.0))
        if self.levels == "continuous":
            slant = height * (BEYOND * horizon / height) ** np.linspace(0.0, 1.0, PATH_NODES)
            nodes = refined_nodes(np.log(slant), lambda x: self._sea_values(height, np.exp(x)), self._path_errors)
            self._report_error(height, nodes.residual)
            x, values = nodes.place, nodes.value
        else:
            cosine = np.clip(straight_sea_cosine(height, height * (horizon / height) ** np.linspace(0.0, 1.0, PATH_NODES)), 1e-5, 1.0)
            # straight down exactly, whatever the rounding of the first length
            cosine[0] = 1.0
            depression = self.sums.air.depression(height, cosine)
            rays = [self.sums.in_layers(height, 0.5 * np.pi + float(d)) for d in depression]
            slant = slant_range(height, [ray.ray.arc[-1] * self.sums.air.earth_radius for ray in rays])
            # rays straight down may have equal lengths, which a spline does not allow
            keep = np.concatenate([[True], np.diff(slant) > 1e-6 * slant[1:]])
            slant = slant[keep]
            x = np.log(slant)
            values = self._encoded([(ray.transmittance[-1], ray.emitted) for ray, usable in zip(rays, keep, strict=True) if usable])
        return self._paths.setdefault(height, _Paths(float(slant[0]), float(x[-1]), CubicSpline(x, values, axis=0)))

    def _sea_values(self, height: float, slant: FloatArray) -> FloatArray:
        """Encoded depth and air temperature of the paths of some lengths [m] from the sea to a height [m] (lengths, 2, n)."""
        return self._encoded(self.sums.between_each(height, 0.0, slant.tolist()))

    def _encoded(self, paths: list[tuple[FloatArray, FloatArray]]) -> FloatArray:
        depth = np.maximum(-np.log(np.maximum([tau for tau, _ in paths], 1e-300)), CLEAR)
        kelvin = brightness_temperature(self.wavenumber_cm, np.array([light for _, light in paths]) / -np.expm1(-depth))
        return np.stack([encode_optical_depth(depth), kelvin], axis=1)

    def _decoded(self, values: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Transmittance [1] and path radiance [W m-2 sr-1 per cm-1] of splined values (..., 2, n), both (..., n)."""
        depth = decode_optical_depth(values[..., 0, :])
        return np.exp(-depth), -np.expm1(-depth) * radiance_of(self.wavenumber_cm, values[..., 1, :])

    def _path_errors(self, splined: FloatArray, values: FloatArray) -> FloatArray:
        """Errors of splined paths in band temperature [K], in front of a sea as warm as the lowest air, and of the path's own light."""
        warm = np.full(self.wavenumber_cm.size, float(self.sums.profile.temperature[0]))
        sea = radiance_of(self.wavenumber_cm, warm)
        (tau, light), (exact_tau, exact_light) = self._decoded(splined), self._decoded(values)
        path = np.sum(light - exact_light, axis=-1)
        error = np.maximum(np.abs(path), np.abs(path + np.sum((tau - exact_tau) * sea, axis=-1)))
        return np.asarray(error / np.sum(radiance_of(self.wavenumber_cm, warm + 1.0) - sea))

    def _sky_errors(self, splined: FloatArray, values: FloatArray) -> FloatArray:
        """Errors of splined brightness temperatures of the sky in band temperature [K]; colder sky counts as at ``COLD``."""
        warm = np.maximum(values, COLD)
        slope = radiance_of(self.wavenumber_cm, warm + 1.0) - radiance_of(self.wavenumber_cm, warm)
        error = radiance_of(self.wavenumber_cm, splined) - radiance_of(self.wavenumber_cm, values)
        return np.asarray(np.abs(np.sum(error, axis=-1)) / np.sum(slope, axis=-1))

    def _report_error(self, height: float, residual: float) -> None:
        """Report an error between nodes [K] that is left, once."""
        if residual > LIMIT and not self._error_reported:
            self._error_reported = True
            REPORTS.warning(
                "%s: the air seen from %g m changes so fast that up to %.2g K are left between its rays", self.name, height, residual
            )

    def path(self, height: float, range_m: ArrayLike, target_height: ArrayLike = 0.0) -> tuple[FloatArray, FloatArray]:
        """Transmittance [1] and thermal path radiance [W m-2 sr-1 per cm-1] together, both (..., n).

        Parameters
        ----------
        height : float
            Sensor height [m].
        range_m : array_like
            Arc along the sea to the point looked at [m, (...)].
        target_height : array_like
            Height of that point [m], broadcast with ``range_m``; up to 100 km.

        Raises
        ------
        DomainError
            Heights outside 1 cm to 100 km, or a line too deep below the sea.
        """
        require_height(height, *PROFILE_HEIGHTS, "choose a height inside it")
        arc, target = require_line(height, range_m, target_height)
        slant = slant_range(height, arc, target)
        if not target.any():
            return self._sea(height, slant)
        if np.any(target > PROFILE_HEIGHTS[1]):
            raise DomainError(
                f"target_height = {target.max():g} m is above {PROFILE_HEIGHTS[1]:g} m of this atmosphere; choose heights below it",
                name="target_height",
                value=float(target.max()),
                allowed=(0.0, PROFILE_HEIGHTS[1]),
            )
        n = self.wavenumber_cm.size
        tau, light = np.empty((arc.size, n)), np.empty((arc.size, n))
        flat, ends = slant.ravel(), target.ravel()
        sea = ends == 0.0
        if sea.any():
            tau[sea], light[sea] = self._sea(height, flat[sea])
        for i in np.flatnonzero(~sea):
            tau[i], light[i] = self.sums.between(height, float(ends[i]), float(flat[i])) if flat[i] > 0.0 else (1.0, 0.0)
        return tau.reshape(*arc.shape, n), light.reshape(*arc.shape, n)

    def _around(self, height: float) -> tuple[tuple[float, float], ...]:
        """Heights [m] whose rays are used for a height, and their shares."""
        if not self._moving or height <= PROFILE_HEIGHTS[0]:
            return ((height, 1.0),)
        # heights of one ladder for all sensors, so that a track reuses their rays; weights linear in log height
        x = np.log(height) / np.log(HEIGHT_RATIO)
        low = float(np.floor(x))
        ends = HEIGHT_RATIO ** np.array([low, low + 1.0])
        return ((float(np.clip(ends[0], *PROFILE_HEIGHTS)), 1.0 - (x - low)), (float(np.clip(ends[1], *PROFILE_HEIGHTS)), x - low))

    def _sea(self, height: float, slant: FloatArray) -> tuple[FloatArray, FloatArray]:
        share = np.log(np.maximum(slant / height, 1.0)) / np.log(straight_slant(height, 0.0) / height)
        blended = np.zeros((*slant.shape, 2, self.wavenumber_cm.size))
        for node, weight in self._around(height):
            # at the other height the path with the same path coordinate
            at = slant if node == height else node * (straight_slant(node, 0.0) / node) ** share
            blended += weight * self._sea_paths(node)(at)
        return self._decoded(blended)

    def transmittance(self, height: float, range_m: ArrayLike, target_height: ArrayLike = 0.0) -> FloatArray:
        """Transmittance of the path from a point to the sensor [1, (..., n)]."""
        return self.path(height, range_m, target_height)[0]

    def path_radiance(self, height: float, range_m: ArrayLike, target_height: ArrayLike = 0.0) -> FloatArray:
        """Thermal radiance of the same path at the sensor [W m-2 sr-1 per cm-1, (..., n)]."""
        return self.path(height, range_m, target_height)[1]

    def _sun(self, height: float) -> CubicSpline[np.float64]:
        """Spline of the encoded optical depth towards the Sun from a height over ``_sky_coordinate``, down to the sea's horizon."""
        cached = self._suns.get(height)
        if cached is not None:
            return cached
        dip = horizon_depression(height) if height > 0.0 else 0.0
        # the profile's dip over the camera's: below the horizontal elevations are scaled so that both horizons coincide
        dip_ratio = self.sums.air.dip(height) / dip if dip > 0.0 else 1.0
        y = np.linspace(float(_sky_coordinate(-dip)), float(_sky_coordinate(0.5 * np.pi)), SUN_NODES)
        elevation = np.minimum(_sky_elevation(y), 0.5 * np.pi)
        elevation = np.where(elevation < 0.0, elevation * dip_ratio * (1.0 - 1e-9), elevation)
        if self.levels == "continuous":
            passed = list(self.sums.passed_each(height, [0.5 * np.pi - float(e) for e in elevation]))
        else:
            passed = [self.sums.in_layers(height, 0.5 * np.pi - float(e)).transmittance[-1] for e in elevation]
        return self._suns.setdefault(height, CubicSpline(y, encode_optical_depth(-np.log(np.maximum(passed, 1e-300))), axis=0))

    def solar_irradiance(self, solar_zenith: ArrayLike, height: float = 0.0) -> FloatArray:
        """Direct sunlight at a height [m], normal to the beam, Sun at 1 au [W m-2 per cm-1, (..., n)].

        ``solar_zenith`` is the apparent (refracted) zenith angle, there, of the point of the Sun looked at [rad, (...)]. The result is 0
        below the sea's horizon, at the sea beyond pi/2.
        """
        require_height(height, 0.0, PROFILE_HEIGHTS[1], "choose a height inside it")
        elevation = 0.5 * np.pi - require_solar_zenith(solar_zenith)
        dip = horizon_depression(height) if height > 0.0 else 0.0
        encoded = self._blended(self._sun, height, np.maximum(elevation, -dip))
        depth = decode_optical_depth(encoded)
        up = (elevation >= -dip - ANGLE_SLACK)[..., np.newaxis]
        return np.asarray(np.where(up, self.sums.laws.source * np.exp(-depth), 0.0))

    def sunlight_at(self, height: float, solar_zenith: float) -> FloatArray:
        """Direct sunlight at a height [W m-2 per cm-1, (n,)], as :meth:`solar_irradiance`."""
        return self.solar_irradiance(solar_zenith, height)

    def sky_radiance(self, zenith: ArrayLike, azimuth: ArrayLike, height: float = 0.0) -> FloatArray:
        """Thermal radiance of the clear sky in directions [rad, (...)] from ``height`` [W m-2 sr-1 per cm-1, (..., n)].

        From a height the angles reach down to the sea horizon, ``pi/2 + horizon_depression(height)``; lower ones point at the sea
        and are refused.
        """
        require_height(height, 0.0, PROFILE_HEIGHTS[1], "choose a height inside it")
        dip = horizon_depression(height) if height > 0.0 else 0.0
        elevation = 0.5 * np.pi - np.broadcast_arrays(np.asarray(zenith, dtype=np.float64), azimuth)[0]
        if not np.all((elevation >= -dip - ANGLE_SLACK) & (elevation <= 0.5 * np.pi + ANGLE_SLACK)):
            raise DomainError(
                f"zenith has values outside 0-{np.degrees(0.5 * np.pi + dip):.4f} deg, where the sky of a sensor at {height:g} m ends; "
                "directions below the sea horizon see the sea"
            )
        inside = np.clip(elevation, -dip, 0.5 * np.pi)
        top = next(angle for angle in SKY_TOPS if angle >= np.max(inside, initial=-dip))
        return radiance_of(self.wavenumber_cm, self._blended(partial(self._sky, top=top), height, inside))

    def _blended(self, spline_at: Callable[[float], CubicSpline[np.float64]], height: float, elevation: FloatArray) -> FloatArray:
        """Values of splines over elevation [rad] at a height [m]; below the horizontal by the share of the dip."""
        out = np.zeros((*elevation.shape, self.wavenumber_cm.size))
        for node, weight in self._around(height):
            scale = 1.0 if node == height else horizon_depression(node) / horizon_depression(height)
            out += weight * spline_at(node)(_sky_coordinate(np.where(elevation < 0.0, elevation * scale, elevation)))
        return out

    def _sky(self, height: float, top: float) -> CubicSpline[np.float64]:
        """Spline of the sky's brightness temperature over ``_sky_coordinate`` of the camera's elevations, up to ``top`` [rad]."""
        cached = self._skies.get((height, top))
        if cached is not None:
            return cached
        dip = horizon_depression(height) if height > 0.0 else 0.0
        dip_ratio = self.sums.air.dip(height) / dip if dip > 0.0 else 1.0
        above = np.linspace(0.0, float(_sky_coordinate(0.5 * np.pi)), SKY_NODES)
        if self.levels == "continuous":
            above = above[: np.searchsorted(above, _sky_coordinate(top)) + RAYS_BEYOND]
        below = np.linspace(float(_sky_coordinate(-dip)), 0.0, DIP_NODES, endpoint=False) if dip > 0.0 else above[:0]
        ends = (*(start for start, _ in LOWEST_STEPS[1:]), np.inf)
        steps = [
            np.arange(start + step, min(end + 0.5 * step, height - step), step)
            for (start, step), end in zip(LOWEST_STEPS, ends, strict=True)
        ]
        lowest = np.concatenate(steps)
        # rays whose lowest points step through the heights: the sky changes fast as a ray grazes a layer
        grazing = np.arcsin(self.sums.air.cosine(height, self.sums.air.invariant(lowest)))
        below = np.concatenate([below, _sky_coordinate(-grazing / dip_ratio)])
        x = np.concatenate([np.unique(below), above])

        def kelvin(place: FloatArray) -> FloatArray:
            elevation = np.minimum(_sky_elevation(place), 0.5 * np.pi)
            elevation = np.where(elevation < 0.0, elevation * dip_ratio, elevation)
            if dip > 0.0 and place[0] == x[0]:
                elevation[0] *= 1.0 - 1e-9  # the ray that grazes the sea sees sky
            zenith = [0.5 * np.pi - float(e) for e in elevation]
            rays = self.sums.along_each(height, zenith) if self.levels == "continuous" else [self.sums.in_layers(height, z) for z in zenith]
            light = np.array([ray.emitted for ray in rays])
            return brightness_temperature(self.wavenumber_cm, light)

        if self.levels == "lowtran":
            return self._skies.setdefault((height, top), CubicSpline(x, kelvin(x), axis=0))
        nodes = refined_nodes(x, kelvin, self._sky_errors)
        self._report_error(height, nodes.residual)
        return self._skies.setdefault((height, top), CubicSpline(nodes.place, nodes.value, axis=0))


def _sky_coordinate(elevation: ArrayLike) -> FloatArray:
    """Coordinate of elevations [rad] in which the sky is smooth [1]: ``asinh(e / e0)``."""
    return np.asarray(np.arcsinh(np.asarray(elevation, dtype=np.float64) / SKY_SCALE))


def _sky_elevation(coordinate: ArrayLike) -> FloatArray:
    """Inverse of ``_sky_coordinate`` [rad]."""
    return np.asarray(SKY_SCALE * np.sinh(coordinate))


@dataclass(frozen=True, eq=False)
class _JoinedPaths:
    """Paths or rays joined end to end, and the optical depth of their gases.

    Heights of the cuts [m], lengths of the parts [m], first piece of each path, and depths [1, (paths, n)].
    """

    height: FloatArray
    length: FloatArray
    first: NDArray[np.intp]
    gases: FloatArray


@dataclass(frozen=True, eq=False)
class WindyAir:
    """Profile with the Navy's aerosol at any wind. Make it with ``of``.

    Examples
    --------
    >>> from seaglint.air.profile.air_profile import model_profile
    >>> air = WindyAir.of(model_profile("tropical"), np.arange(2000.0, 2861.0, 5.0))
    >>> calm, storm = (air.at(wind).transmittance(20.0, [5000.0]).mean() for wind in (1.0, 18.0))
    >>> bool(storm < calm)
    True
    """

    sums: AirSums
    _paths: dict[tuple[float, ...], _JoinedPaths] = field(default_factory=dict)

    @classmethod
    def of(cls, profile: AirProfile, wavenumber_cm: FloatArray, spectroscopy: Spectroscopy = "lblrtm") -> WindyAir:
        """Air of a profile on channels [cm-1, (n,)]."""
        return cls(AirSums(profile, HazeWeather(), wavenumber_cm, spectroscopy=spectroscopy))

    def at(self, wind: float) -> AirAtWind:
        """Air at a wind [m s-1], which is also the mean wind of the last 24 hours."""
        sums = self.sums
        haze = HazeWeather(wind=wind, wind_24h=wind)
        return AirAtWind(self, AirSums(sums.profile, haze, sums.laws.wavenumber_cm, spectroscopy=sums.spectroscopy))

    def paths(self, height: float, slant: FloatArray) -> _JoinedPaths:
        """Paths from the sea to a height [m] of lengths [m, (paths,)]."""
        key = (height, *slant.tolist())
        if key not in self._paths:
            lines = [self.sums.cut_line(height, 0.0, float(s)) for s in slant]
            gases = np.array([self.sums.gas_depth(*self.sums.line_amounts(*line)) for line in lines])
            self._paths[key] = _JoinedPaths(*joined_lines(lines), gases)
        return self._paths[key]

    def rays(self, zenith: FloatArray) -> _JoinedPaths:
        """Rays from the sea at zenith angles [rad, (rays,)] to the Sun."""
        key = (0.0, *zenith.tolist())
        if key not in self._paths:
            rays = [self.sums.air.ray(0.0, float(z)) for z in zenith]
            lines = [(ray.between(CUTS), np.repeat(ray.length / CUTS, CUTS)) for ray in rays]
            gases = np.array([self.sums.gas_depth(*self.sums.ray_amounts(ray)) for ray in rays])
            self._paths[key] = _JoinedPaths(*joined_lines(lines), gases)
        return self._paths[key]


@dataclass(frozen=True, eq=False)
class AirAtWind:
    """Transmittance and sunlight of ``WindyAir`` at one wind."""

    air: WindyAir  #: Gases, which do not depend on the wind.
    sums: AirSums  #: Aerosol at the wind.
    _light: dict[tuple[float, ...], FloatArray] = field(default_factory=dict)

    @property
    def wavenumber_cm(self) -> FloatArray:
        """Channels [cm-1, (n,)]."""
        return self.sums.laws.wavenumber_cm

    def transmittance(self, height: float, range_m: ArrayLike) -> FloatArray:
        """Transmittance [1, (m, n)] of the paths from the sea at arcs [m, (m,)] to a height [m]."""
        return self._passed(self.air.paths(height, slant_range(height, np.atleast_1d(np.asarray(range_m, np.float64)))))

    def solar_irradiance(self, solar_zenith: ArrayLike) -> FloatArray:
        """Sunlight at the sea, normal to the beam, Sun at 1 au [W m-2 per cm-1, (m, n)]; 0 beyond a zenith angle of pi/2."""
        zenith = np.atleast_1d(require_solar_zenith(solar_zenith))
        key = tuple(zenith.tolist())
        if key not in self._light:
            up = zenith <= 0.5 * np.pi
            self._light[key] = np.zeros((zenith.size, self.wavenumber_cm.size))
            if up.any():
                self._light[key][up] = self.sums.laws.source * self._passed(self.air.rays(zenith[up]))
        return self._light[key]

    def _passed(self, paths: _JoinedPaths) -> FloatArray:
        haze = np.add.reduceat(self.sums.haze_amounts(paths.height, paths.length), paths.first, axis=0)
        return np.asarray(np.exp(-paths.gases - self.sums.haze_depth(haze)))
