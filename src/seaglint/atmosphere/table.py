"""LOWTRAN7 with its Navy maritime aerosol, tabulated: the atmosphere that ships with seaglint.

Built by ``tools/build_atmosphere.py``; each file holds, for one model atmosphere and one spectral region,

- encoded optical depth and effective air temperature ``T_e`` of the path from the sea to a sensor, against wind, height and
  normalised path length: ``L_path = (1 - tau) B(T_e)``;
- encoded optical depth of the path to the Sun against wind and zenith angle;
- brightness temperature of the thermal sky against wind, height and elevation, above and below the horizontal,

each as spectral principal components whose scores are interpolated by cubic splines. These quantities vary slowly where
transmittance and radiance vary by orders of magnitude, and splines of them show no bands in an image.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from importlib import resources
from io import BytesIO
from lzma import LZMAError
from types import MappingProxyType
from typing import Any
from zipfile import BadZipFile

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import CubicSpline

from seaglint.atmosphere.base import FloatArray, require_height, require_range, slant_range, wavenumber_grid
from seaglint.atmosphere.coordinates import (
    Refraction,
    decode_optical_depth,
    dip_coordinate,
    elevation_coordinate,
    height_coordinate,
    path_coordinate,
    sky_height_coordinate,
    spline_weights,
    straight_sea_cosine,
    straight_slant,
)
from seaglint.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.conventions import horizon_depression
from seaglint.errors import DataError, DomainError
from seaglint.optics.blackbody import planck_wavenumber

_DATA = resources.files("seaglint.atmosphere").joinpath("data")
_ANGLE_SLACK = 1e-6
"""Angles this far below the horizon count as on it: rounding of degrees, 2e-3 of the solar radius [rad]."""

_QUANTITIES = ("path_depth", "path_temperature", "sun_depth", "sky_temperature")


def models(region: str = "mwir") -> tuple[str, ...]:
    """Names of the model atmospheres that ship with a table of the spectral region (``mwir`` 2-5.5 um, ``lwir`` 7.5-14 um)."""
    ending = f"_{region}.npz"
    return tuple(sorted(f.name.removesuffix(ending) for f in _DATA.iterdir() if f.name.endswith(ending)))


@dataclass(frozen=True)
class _Spectra:
    """Spectra as ``mean + scores @ components``: one row of scores per node, interpolation acts on the scores."""

    mean: FloatArray
    components: FloatArray
    scores: FloatArray

    @classmethod
    def read(cls, file: Mapping[str, Any], name: str, keep: slice, wind_weights: FloatArray, scores_name: str = "") -> _Spectra:
        scores = np.tensordot(wind_weights, file[f"{scores_name or name}_scores"].astype(np.float64), axes=1)
        return cls(file[name + "_mean"][keep].astype(np.float64), file[name + "_components"][:, keep].astype(np.float64), scores)

    def at_height(self, weights: FloatArray) -> _Spectra:
        return _Spectra(self.mean, self.components, np.tensordot(weights, self.scores, axes=1))

    def along(self, nodes: FloatArray, x: FloatArray) -> FloatArray:
        """Spectra at ``x``: cubic spline between the nodes, the end's tangent beyond the last one."""
        spline = CubicSpline(nodes, self.scores)
        inside = np.minimum(x, nodes[-1])
        scores = spline(inside) + (x - inside)[..., np.newaxis] * spline(nodes[-1], 1)
        return np.asarray(scores @ self.components + self.mean)


@dataclass(frozen=True)
class TableAtmosphere:
    """One LOWTRAN7 model atmosphere at one wind speed, over one band. Make it with :meth:`load`.

    Notes
    -----
    Heights 2 m to 10 km, wind (U10, also the 24-hour mean) 0 to 20 m/s, arcs from 0 to the sea horizon. Beyond the horizon,
    where only wave crests are seen, encoded optical depth and air temperature go on along their tangent in log path length.
    LOWTRAN7 takes calm (0 m/s) for "unknown"; the table's 0 m/s is its limit for little wind. Radiance is thermal: sunlight
    scattered by the air is not in it. Spectral resolution is LOWTRAN7's 20 cm-1, sampled every 5.

    Against LOWTRAN7 runs off the nodes (random heights 2 m-10 km, angles and winds; 3-5 um) the 95th percentile of the error is 0.15 % of
    band transmittance, 0.1 % of path radiance and sunlight, 0.05 % of the sky seen from the sea, and 1.5 % (largest 5 %) of the sky seen
    from a height within four dips of the sea horizon, where LOWTRAN7's layers are met almost along (0.9 % from below 5 km).

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
    provenance: dict[str, Any]
    _heights: FloatArray
    _levels: tuple[float, ...]
    _kinks: tuple[float, ...]
    _sky_heights: FloatArray
    _refraction: Refraction
    _solar: FloatArray
    _horizon_excess: FloatArray
    _ray: FloatArray
    _path_depth: _Spectra
    _path_temperature: _Spectra
    _sun_depth: _Spectra
    _sky_temperature: _Spectra
    _sky_dip: _Spectra
    _extrapolate: bool = False
    extrapolated: tuple[str, ...] = ()
    """What was taken from the edge of the table whatever the height: ``("wind_speed",)`` or nothing; see :meth:`extrapolated_at`."""

    @classmethod
    def load(
        cls, model: str, wind_speed: float, band_um: tuple[float, float] = (3.0, 5.0), *, extrapolate: bool = False
    ) -> TableAtmosphere:
        """Read the table of ``model`` and interpolate it to a wind.

        Parameters
        ----------
        model : str
            One of :func:`models`, e.g. ``"midlatitude-summer"``.
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
        wanted = wavenumber_grid(*band_um)
        region = "mwir" if band_um[0] < 6.5 else "lwir"
        if model not in models(region):
            raise DomainError(
                f"model = {model!r} has no table for {band_um[0]:g}-{band_um[1]:g} um; choose one of {', '.join(models(region))}"
            )
        file = read_table(model, region)
        grid, winds = file["wavenumber_cm"], file["winds"]
        if wanted[0] < grid[0] or wanted[-1] > grid[-1]:
            covered = f"{1e4 / grid[-1]:.3g}-{1e4 / grid[0]:.3g} um"
            raise DomainError(
                f"band {band_um[0]:g}-{band_um[1]:g} um reaches beyond the table of {covered}; narrow the band",
                name="band_um",
                value=band_um,
                allowed=covered,
            )
        if not winds[0] <= wind_speed <= (np.inf if extrapolate else winds[-1]):
            raise DomainError(
                f"wind_speed = {wind_speed:g} m/s is outside {winds[0]:g}-{winds[-1]:g} m/s of the Navy maritime aerosol",
                name="wind_speed",
                value=wind_speed,
                allowed=(float(winds[0]), float(winds[-1])),
            )
        keep = slice(int(np.searchsorted(grid, wanted[0])), int(np.searchsorted(grid, wanted[-1])) + 1)
        wind_weights = spline_weights(winds, tuple(file["wind_kinks"].tolist()), min(wind_speed, float(winds[-1])))
        return cls(
            model=model,
            wind_speed=float(wind_speed),
            wavenumber_cm=grid[keep].copy(),
            provenance=json.loads(str(file["provenance"])) | {"sha256": str(file["sha256"])},
            _heights=file["heights"],
            _levels=tuple(file["height_levels"]),
            _kinks=tuple(file["height_kinks"]),
            _sky_heights=file["sky_heights"],
            _refraction=Refraction(file["level_height"], file["refractivity"], float(file["earth_radius"])),
            _solar=file["solar"][keep].copy(),
            _horizon_excess=file["horizon_excess"],
            _ray=file["ray"],
            _path_depth=_Spectra.read(file, "path_depth", keep, wind_weights),
            _path_temperature=_Spectra.read(file, "path_temperature", keep, wind_weights),
            _sun_depth=_Spectra.read(file, "sun_depth", keep, wind_weights),
            _sky_temperature=_Spectra.read(file, "sky_temperature", keep, wind_weights),
            _sky_dip=_Spectra.read(file, "sky_temperature", keep, wind_weights, "sky_dip"),
            _extrapolate=extrapolate,
            extrapolated=("wind_speed",) if wind_speed > winds[-1] else (),
        )

    def extrapolated_at(self, height: float) -> tuple[str, ...]:
        """Names of what is beyond the table for a sensor at ``height`` [m]; empty inside it."""
        inside = self._heights[0] <= height <= self._heights[-1]
        return self.extrapolated if inside else (*self.extrapolated, "sensor_height")

    def _height_weights(self, height: float) -> FloatArray:
        lowest, highest = float(self._heights[0]), float(self._heights[-1])
        if self._extrapolate and height > 0.0:
            height = min(max(height, lowest), highest)
        require_height(height, lowest, highest, "choose a height inside it")
        levels = (*self._levels, highest)
        u, at = height_coordinate(self._heights, levels), height_coordinate(height, levels)
        return spline_weights(u, tuple(height_coordinate(self._kinks, levels).tolist()), float(at))

    def _horizon_slant(self, height: float, weights: FloatArray) -> float:
        """Slant path to the sea horizon that LOWTRAN7's refraction gives, in the table's straight geometry [m]."""
        return float(straight_slant(height, 0.0) * np.exp(weights @ self._horizon_excess))

    def _path_coordinate(self, height: float, range_m: ArrayLike, weights: FloatArray) -> FloatArray:
        """Where along the table's paths those from arcs ``range_m`` to the sensor lie [1]."""
        slant, highest = slant_range(height, require_range(range_m)), float(self._heights[-1])
        if height > highest:
            slant = straight_slant(highest, straight_sea_cosine(height, slant))
        inside = min(max(height, float(self._heights[0])), highest)
        return path_coordinate(slant, inside, self._horizon_slant(inside, weights))

    def _optical_depth(self, x: FloatArray, weights: FloatArray) -> FloatArray:
        nodes = np.linspace(0.0, 1.0, self._path_depth.scores.shape[1])
        return decode_optical_depth(self._path_depth.at_height(weights).along(nodes, x))

    def path(self, height: float, range_m: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Transmittance [1] and thermal path radiance [W m-2 sr-1 per cm-1] in one go, both (..., n)."""
        weights = self._height_weights(height)
        x = self._path_coordinate(height, range_m, weights)
        optical_depth = self._optical_depth(x, weights)
        nodes = np.linspace(0.0, 1.0, self._path_temperature.scores.shape[1])
        air = self._path_temperature.at_height(weights).along(nodes, x)
        return np.exp(-optical_depth), -np.expm1(-optical_depth) * planck_wavenumber(self.wavenumber_cm, air)

    def transmittance(self, height: float, range_m: ArrayLike) -> FloatArray:
        """Transmittance of the path from the sea at arcs ``range_m`` [m, (...)] to the sensor [1, (..., n)]."""
        weights = self._height_weights(height)
        return np.asarray(np.exp(-self._optical_depth(self._path_coordinate(height, range_m, weights), weights)))

    def path_radiance(self, height: float, range_m: ArrayLike) -> FloatArray:
        """Thermal radiance of the air between the sea and the sensor [W m-2 sr-1 per cm-1, (..., n)]."""
        return self.path(height, range_m)[1]

    def range_of_depression(self, height: float, depression: ArrayLike) -> FloatArray:
        """Arc to the sea point at which LOWTRAN7's own refracted ray of this depression ends [m]; NaN where it misses the sea.

        Differs from :func:`seaglint.conventions.surface_range` by tens of per cent close to the horizon. Use it to compare
        with LOWTRAN7 runs made by angle.
        """
        weights = self._height_weights(height)
        cosine = self._refraction.sea_cosine(height, depression)
        straight = path_coordinate(straight_slant(height, cosine), height, float(straight_slant(height, 0.0)))
        ray = CubicSpline(np.linspace(0.0, 1.0, self._ray.shape[1]), weights @ self._ray)
        slant = height * (self._horizon_slant(height, weights) / height) ** ray(straight)
        chord = (slant**2 - height**2) / (4.0 * EFFECTIVE_EARTH_RADIUS * (EFFECTIVE_EARTH_RADIUS + height))
        return np.asarray(2.0 * EFFECTIVE_EARTH_RADIUS * np.arcsin(np.sqrt(np.maximum(chord, 0.0))))

    def solar_irradiance(self, solar_zenith: ArrayLike) -> FloatArray:
        """Direct sunlight at the sea, normal to the beam, Sun at 1 au [W m-2 per cm-1, (..., n)]; 0 beyond a zenith angle of pi/2.

        ``solar_zenith`` is the apparent (refracted) zenith angle of the point of the Sun looked at [rad, (...)].
        """
        zenith = np.asarray(solar_zenith, dtype=np.float64)
        if not np.all((zenith >= 0.0) & (zenith <= np.pi)):
            raise DomainError(
                "solar_zenith has values outside 0-pi rad; give zenith angles in radians",
                name="solar_zenith",
                value=float(zenith[~((zenith >= 0.0) & (zenith <= np.pi))].ravel()[0]),
                allowed=(0.0, np.pi),
            )
        y = elevation_coordinate(np.maximum(0.5 * np.pi - zenith, 0.0), 0.0)
        encoded = self._sun_depth.along(np.linspace(0.0, 1.0, self._sun_depth.scores.shape[0]), y)
        up = (zenith <= 0.5 * np.pi + _ANGLE_SLACK)[..., np.newaxis]
        return np.asarray(np.where(up, self._solar * np.exp(-decode_optical_depth(encoded)), 0.0))

    def sky_radiance(self, zenith: ArrayLike, height: float = 0.0) -> FloatArray:
        """Thermal radiance of the clear sky at zenith angles ``zenith`` [rad, (...)] seen from ``height`` [W m-2 sr-1 per cm-1, (..., n)].

        From a height the angles reach down to the sea horizon, ``pi/2 + horizon_depression(height)``; lower ones see the sea
        and are refused.
        """
        highest = float(self._sky_heights[-1])
        at = min(height, highest) if self._extrapolate else height
        require_height(at, 0.0, highest, "choose a height inside it")
        dip = horizon_depression(height) if height > 0.0 else 0.0
        elevation = 0.5 * np.pi - np.asarray(zenith, dtype=np.float64)
        if not np.all((elevation >= -dip - _ANGLE_SLACK) & (elevation <= 0.5 * np.pi + _ANGLE_SLACK)):
            raise DomainError(
                f"zenith has values outside 0-{np.degrees(0.5 * np.pi + dip):.4f} deg, where the sky of a sensor at {height:g} m ends; "
                "directions below the sea horizon see the sea"
            )
        levels = (*self._levels, highest)
        u = sky_height_coordinate(self._sky_heights, levels)
        kinks = tuple(float(j) for j, level in enumerate(self._levels, 1) if level in self._sky_heights)
        weights = spline_weights(u, kinks, float(sky_height_coordinate(at, levels)))
        sky = self._sky_temperature.at_height(weights)
        y = np.minimum(elevation_coordinate(np.maximum(elevation, 0.0), self._refraction.dip(at) if at > 0.0 else 0.0), 1.0)
        temperature = sky.along(np.linspace(0.0, 1.0, sky.scores.shape[0]), y)
        below = elevation < 0.0
        if dip > 0.0 and below.any():
            seen = self._sky_dip.at_height(weights)
            x = np.minimum(dip_coordinate(-elevation[below], dip), 1.0)
            temperature[below] = seen.along(np.linspace(0.0, 1.0, seen.scores.shape[0]), x)
        return planck_wavenumber(self.wavenumber_cm, temperature)


@lru_cache(maxsize=12)
def read_table(model: str, region: str) -> Mapping[str, Any]:
    """Arrays of one shipped table by name, and the file's ``sha256``; read once a process, not to be written to.

    Per quantity (``path_depth``, ``path_temperature``, ``sun_depth``, ``sky_temperature``) there are ``_mean`` [(n)],
    ``_components`` [(c, n)] and ``_scores`` [(winds, [heights,] nodes, c)]: spectra are ``mean + scores @ components``.
    ``sky_temperature_scores`` go from the horizontal to the zenith, ``sky_dip_scores`` (of the same components) from the
    horizontal down to the sea horizon.

    Raises
    ------
    DataError
        If the file in the package is missing or damaged.
    """
    name = f"{model}_{region}.npz"
    try:
        content = _DATA.joinpath(name).read_bytes()
        with np.load(BytesIO(content)) as archive:
            table: dict[str, Any] = dict(archive)
        for name in _QUANTITIES:
            table |= _decoded(table, name)
    except (OSError, ValueError, KeyError, BadZipFile, LZMAError) as error:
        raise DataError(f"the atmosphere table {name} in the package is damaged ({error}); install seaglint again") from error
    sky, up = table["sky_temperature_scores"], int(table["sky_nodes"])
    table["sky_temperature_scores"], table["sky_dip_scores"] = sky[:, :, :up], np.concatenate([sky[:, :, :1], sky[:, :, up:]], axis=2)
    for array in table.values():
        array.flags.writeable = False
    return MappingProxyType(table | {"sha256": hashlib.sha256(content).hexdigest()})


def _decoded(table: Mapping[str, Any], name: str) -> dict[str, FloatArray]:
    """Components and scores of a quantity from their integers: 16-bit components; scores as byte planes of differences in wind."""
    planes = table[f"{name}_scores"]
    differences = np.ascontiguousarray(planes.reshape(4, -1).T).view("<i4").reshape(planes.shape[1:])
    scores = np.cumsum(np.moveaxis(differences, 0, -1), axis=0) * float(table[f"{name}_step"])
    return {
        f"{name}_components": table[f"{name}_components"] * table[f"{name}_scale"][:, np.newaxis].astype(np.float64),
        f"{name}_scores": np.ascontiguousarray(scores),
    }
