"""Files of the atmosphere tables: their list, their reader, and one of them cut to a band.

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
from typing import Any, Final, Literal
from zipfile import BadZipFile

import numpy as np
from numpy.typing import ArrayLike

from seaglint.air.coordinates import decode_optical_depth, elevation_coordinate, height_coordinate, sky_height_coordinate
from seaglint.air.profile.bent_ray import RefractingAir
from seaglint.air.protocol import require_solar_zenith, wavenumber_grid
from seaglint.air.table.stencil import Stencil
from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError, DomainError
from seaglint.base.free_form import JsonObject

_DATA = resources.files("seaglint.air").joinpath("data")

Region = Literal["mwir", "lwir"]

_REGIONS: Final[tuple[Region, ...]] = ("mwir", "lwir")

_QUANTITIES = ("path_depth", "path_temperature", "sun_depth", "sky_temperature")

ANGLE_SLACK = 1e-6  #: Tolerance within which angles below the horizon count as on it: rounding of degrees, 2e-3 of the solar radius [rad].


def models(region: str = "mwir") -> tuple[str, ...]:
    """Names of the model atmospheres that ship with a table of the spectral region (``mwir`` 2-5.5 um, ``lwir`` 7.5-14 um)."""
    ending = f"_{region}.npz"
    return tuple(sorted(f.name.removesuffix(ending) for f in _DATA.iterdir() if f.name.endswith(ending)))


def table_models() -> tuple[str, ...]:
    """Names of the model atmospheres whose tables cover every spectral region."""
    return tuple(sorted(set.intersection(*(set(models(region)) for region in _REGIONS))))


@lru_cache(maxsize=12)
def read_table(model: str, region: str) -> Mapping[str, Any]:
    """Return the arrays of one shipped table by name, and the file's ``sha256``; read once a process, read-only.

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


@dataclass(frozen=True, eq=False)
class Spectra:
    """Spectra as ``mean + scores @ components``: interpolation acts on the scores [(winds, ..., components)]."""

    mean: FloatArray
    components: FloatArray
    scores: FloatArray

    def of(self, scores: FloatArray) -> FloatArray:
        """Spectra of interpolated scores [(..., components)]: (..., n)."""
        return np.asarray(scores @ self.components + self.mean)


@dataclass(frozen=True, eq=False)
class BandTable:
    """Atmosphere table cut to a band, all winds. Make it with :meth:`read`."""

    #: ``model``, ``region``: Model atmosphere and spectral region.
    model: str
    region: Region
    #: ``wavenumber_cm``, ``solar``: Channels [cm-1] and sunlight outside the atmosphere at 1 au [W m-2 per cm-1], both (n,).
    wavenumber_cm: FloatArray
    solar: FloatArray
    provenance: JsonObject
    #: ``winds``, ``heights``, ``sky_heights``: Nodes [m s-1], [m], [m].
    winds: FloatArray
    wind_kinks: tuple[float, ...]
    heights: FloatArray  #: See ``winds``.
    sky_heights: FloatArray  #: See ``winds``.
    levels: tuple[float, ...]
    height_kinks: tuple[float, ...]
    refraction: RefractingAir  #: LOWTRAN7's own.
    #: ``horizon_excess``, ``ray``: Logarithm of the slant path to the sea horizon over its straight length [1, (heights,)]; path coordinate
    #: of LOWTRAN7's rays against that of straight ones [1, (heights, nodes)].
    horizon_excess: FloatArray
    ray: FloatArray
    #: ``path_depth``, ``path_temperature``, ``sun_depth``, ``sky_temperature``, ``sky_dip``: Spectra that :func:`read_table` describes.
    path_depth: Spectra
    path_temperature: Spectra
    sun_depth: Spectra
    sky_temperature: Spectra
    sky_dip: Spectra

    @classmethod
    def read(cls, model: str, band_um: tuple[float, float]) -> BandTable:
        """Read the table of ``model`` that covers a band [um].

        Raises
        ------
        DomainError
            For an unknown model or a band outside the tables.
        DataError
            If the file in the package is damaged.
        """
        requested = wavenumber_grid(*band_um)
        region = _REGIONS[0] if band_um[0] < 6.5 else _REGIONS[1]
        if model not in models(region):
            raise DomainError(
                f"model = {model!r} has no table for {band_um[0]:g}-{band_um[1]:g} um; choose one of {', '.join(models(region))}"
            )
        file = read_table(model, region)
        grid = file["wavenumber_cm"]
        if requested[0] < grid[0] or requested[-1] > grid[-1]:
            covered = " and ".join(_covered(read_table(model, name)["wavenumber_cm"]) for name in _REGIONS if model in models(name))
            raise DomainError(
                f"band {band_um[0]:g}-{band_um[1]:g} um reaches beyond the tables of {covered} um, "
                f"here beyond the table of {_covered(grid)} um; choose a band inside one",
                name="band_um",
                value=band_um,
                allowed=f"{covered} um",
            )
        keep = slice(int(np.searchsorted(grid, requested[0])), int(np.searchsorted(grid, requested[-1])) + 1)

        def spectra(name: str, scores: str) -> Spectra:
            mean, components = file[name + "_mean"][keep].astype(np.float64), file[name + "_components"][:, keep].astype(np.float64)
            return Spectra(mean, components, file[scores + "_scores"])

        return cls(
            model=model,
            region=region,
            wavenumber_cm=grid[keep].copy(),
            solar=file["solar"][keep].copy(),
            provenance=json.loads(str(file["provenance"])) | {"sha256": str(file["sha256"])},
            winds=file["winds"],
            wind_kinks=tuple(file["wind_kinks"].tolist()),
            heights=file["heights"],
            sky_heights=file["sky_heights"],
            levels=tuple(file["height_levels"].tolist()),
            height_kinks=tuple(file["height_kinks"].tolist()),
            refraction=RefractingAir.of(file["level_height"], file["refractivity"], float(file["earth_radius"])),
            horizon_excess=file["horizon_excess"],
            ray=file["ray"],
            path_depth=spectra("path_depth", "path_depth"),
            path_temperature=spectra("path_temperature", "path_temperature"),
            sun_depth=spectra("sun_depth", "sun_depth"),
            sky_temperature=spectra("sky_temperature", "sky_temperature"),
            sky_dip=spectra("sky_temperature", "sky_dip"),
        )

    def height_coordinate(self, height: ArrayLike) -> FloatArray:
        """Spline coordinate [1] of heights [m] for paths."""
        return height_coordinate(height, (*self.levels, float(self.heights[-1])))

    @property
    def height_axis(self) -> tuple[FloatArray, tuple[float, ...]]:
        """Nodes and kinks of the height coordinate [1]."""
        return self.height_coordinate(self.heights), tuple(self.height_coordinate(self.height_kinks).tolist())

    def at_heights(self, height: FloatArray) -> Stencil:
        """Stencil over the heights' nodes for heights inside the table [m, (cases,)]."""
        return Stencil.between_kinks(*self.height_axis, self.height_coordinate(height))

    def at_sky_heights(self, height: FloatArray) -> Stencil:
        """Stencil over the heights from which the sky is tabulated, for heights inside the table [m, (cases,)]."""
        levels = (*self.levels, float(self.sky_heights[-1]))
        kinks = tuple(float(j) for j, level in enumerate(self.levels, 1) if level in self.sky_heights)
        return Stencil.between_kinks(sky_height_coordinate(self.sky_heights, levels), kinks, sky_height_coordinate(height, levels))

    def path_at(self, scores: FloatArray, where: Stencil) -> tuple[FloatArray, FloatArray]:
        """Optical depth [1] and air temperature [K] of paths, both (cases, n), from the nodes' scores of both side by side."""
        interpolated = where.of(scores.reshape(where.size, -1))
        rank = self.path_depth.components.shape[0]
        return decode_optical_depth(self.path_depth.of(interpolated[:, :rank])), self.path_temperature.of(interpolated[:, rank:])

    @staticmethod
    def sun_coordinate(solar_zenith: ArrayLike) -> FloatArray:
        """Spline coordinate [1] of zenith angles of the Sun [rad]; those outside 0-pi are refused."""
        zenith = require_solar_zenith(solar_zenith)
        return elevation_coordinate(np.maximum(0.5 * np.pi - zenith, 0.0), 0.0)

    def sunlight(self, solar_zenith: ArrayLike, encoded: FloatArray) -> FloatArray:
        """Direct sunlight at the sea [W m-2 per cm-1, (..., n)] from the encoded depth of the way to the Sun; 0 below the horizon."""
        up = (np.asarray(solar_zenith, dtype=np.float64) <= 0.5 * np.pi + ANGLE_SLACK)[..., np.newaxis]
        return np.asarray(np.where(up, self.solar * np.exp(-decode_optical_depth(encoded)), 0.0))


def _covered(grid: FloatArray) -> str:
    return f"{1e4 / grid[-1]:.3g}-{1e4 / grid[0]:.3g}"
