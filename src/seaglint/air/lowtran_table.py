"""Atmosphere tables of LOWTRAN7's model atmospheres: reader, cut to a band, and spectra for many cases at once.

The files, built by ``tools/build_atmosphere.py``, hold for one model atmosphere and one spectral region

- encoded optical depth and effective air temperature ``T_e`` of the path from the sea to a sensor, against wind, height and
  normalised path length: ``L_path = (1 - tau) B(T_e)``;
- encoded optical depth of the path to the Sun against wind and zenith angle;
- brightness temperature of the thermal sky against wind, height and elevation, above and below the horizontal,

each as spectral principal components with scores that are interpolated by cubic splines. These quantities vary slowly where
transmittance and radiance vary by orders of magnitude, and their splines show no bands in an image.

``BatchAtmosphere`` evaluates cases that each have a wind, a height and angles, as in spreadsheets. Splines over wind, height and the
path are weighted sums over node values (``Stencil``): a not-a-knot spline in wind and height sums over the nodes between two kinks,
along the path two values and two slopes suffice. A case takes 20 us; sums along its ray (``seaglint.air.profile.air_sums``) take a
millisecond.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache
from importlib import resources
from io import BytesIO
from lzma import LZMAError
from types import MappingProxyType
from typing import Any, Final, Literal
from zipfile import BadZipFile

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import CubicSpline
from scipy.sparse import csr_array

from seaglint.air.coordinates import (
    decode_optical_depth,
    dip_coordinate,
    elevation_coordinate,
    height_coordinate,
    path_coordinate,
    sky_height_coordinate,
    straight_slant,
)
from seaglint.air.profile.bent_ray import RefractingAir
from seaglint.air.protocol import ANGLE_SLACK, require_solar_zenith, wavenumber_grid
from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError, DomainError
from seaglint.base.free_form import JsonObject
from seaglint.optics.blackbody import planck_wavenumber

_DATA = resources.files("seaglint.air").joinpath("data")

Region = Literal["mwir", "lwir"]

_REGIONS: Final[tuple[Region, ...]] = ("mwir", "lwir")

_QUANTITIES = ("path_depth", "path_temperature", "sun_depth", "sky_temperature")


@dataclass(frozen=True, eq=False)
class Stencil:
    """Indices and weights of the node values in a spline at each case; short rows are padded with weight 0."""

    index: NDArray[np.intp]  #: Nodes [(cases, m)].
    weight: FloatArray  #: Weights [1, (cases, m)].
    size: int  #: Number of nodes.

    @classmethod
    def between_kinks(cls, nodes: FloatArray, kinks: tuple[float, ...], x: FloatArray) -> Stencil:
        """Stencil of a cubic spline whose slope may jump at kinks, which are nodes.

        Between two kinks it is not-a-knot (three nodes: a parabola, two: a line).
        """
        edges = np.array(sorted({float(nodes[0]), *kinks, float(nodes[-1])}))
        interval = np.clip(np.searchsorted(edges, x, side="right"), 1, edges.size - 1)
        inside = [np.flatnonzero((nodes >= edges[j - 1]) & (nodes <= edges[j])) for j in range(1, edges.size)]
        widest = max(piece.size for piece in inside)
        index, weight = np.zeros((x.size, widest), dtype=np.intp), np.zeros((x.size, widest))
        for j, piece in enumerate(inside, start=1):
            cases = np.flatnonzero(interval == j)
            if cases.size:
                index[cases, : piece.size] = piece
                weight[cases, : piece.size] = CubicSpline(nodes[piece], np.eye(piece.size))(x[cases])
        return cls(index, weight, nodes.size)

    @classmethod
    def hermite(cls, nodes: FloatArray, x: FloatArray) -> Stencil:
        """Stencil of the cubic through values and slopes at the two nodes around ``x``, the end's tangent beyond the last one.

        Node values are followed by node slopes, as ``with_slopes`` stacks them.
        """
        n = nodes.size
        left = np.clip(np.searchsorted(nodes, x, side="right") - 1, 0, n - 2)
        step = nodes[left + 1] - nodes[left]
        t = np.minimum((x - nodes[left]) / step, 1.0)
        beyond = np.maximum(x - nodes[-1], 0.0)
        # Hermite's basis on a step: both values, then both slopes; beyond the last node its slope alone counts
        weight = ((1.0 + 2.0 * t) * (1.0 - t) ** 2, t * t * (3.0 - 2.0 * t), step * t * (1.0 - t) ** 2, step * t * t * (t - 1.0) + beyond)
        return cls(np.stack([left, left + 1, left + n, left + 1 + n], axis=1), np.stack(weight, axis=1), 2 * n)

    def times(self, other: Stencil) -> Stencil:
        """Stencil of the product of two directions, the other one running fastest."""
        index = self.index[:, :, None] * other.size + other.index[:, None, :]
        weight = self.weight[:, :, None] * other.weight[:, None, :]
        return Stencil(index.reshape(index.shape[0], -1), weight.reshape(index.shape[0], -1), self.size * other.size)

    def of(self, values: FloatArray) -> FloatArray:
        """Weighted sums (cases, ...) over node values [(size, ...)]."""
        cases, width = self.index.shape
        # one sparse product for all components: rows are cases, each with as many weights
        matrix = csr_array((self.weight.ravel(), self.index.ravel(), np.arange(0, cases * width + 1, width)), shape=(cases, self.size))
        return np.asarray(matrix @ values.reshape(self.size, -1)).reshape(cases, *values.shape[1:])


def with_slopes(nodes: FloatArray, values: FloatArray) -> FloatArray:
    """Node values [(..., nodes, k)] followed by the slopes of their cubic spline: (..., 2 nodes, k)."""
    slope = np.asarray(CubicSpline(nodes, np.eye(nodes.size))(nodes, 1))
    return np.concatenate([values, slope @ values], axis=-2)


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
    # the horizontal is a node of both, of the sky above it and of the sky below it
    sky, up = table["sky_temperature_scores"], int(table["sky_nodes"])
    table["sky_temperature_scores"], table["sky_dip_scores"] = sky[:, :, :up], np.concatenate([sky[:, :, :1], sky[:, :, up:]], axis=2)
    for array in table.values():
        array.flags.writeable = False
    return MappingProxyType(table | {"sha256": hashlib.sha256(content).hexdigest()})


def _decoded(table: Mapping[str, Any], name: str) -> dict[str, FloatArray]:
    """Components and scores of a quantity from their integers: 16-bit components; scores as byte planes of differences in wind."""
    planes = table[f"{name}_scores"]
    # the planes are the bytes of little-endian 32-bit integers: plane i holds byte i of all of them
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
    """Atmosphere table cut to a band, all winds. Make it with ``read``."""

    model: str  #: Model atmosphere.
    region: Region  #: Spectral region.
    wavenumber_cm: FloatArray  #: Channels [cm-1, (n,)].
    solar: FloatArray  #: Sunlight outside the atmosphere at 1 au [W m-2 per cm-1, (n,)].
    provenance: JsonObject
    winds: FloatArray  #: Nodes of wind [m s-1, (winds,)].
    wind_kinks: tuple[float, ...]
    heights: FloatArray  #: Nodes of sensor height for paths [m, (heights,)].
    sky_heights: FloatArray  #: Nodes of sensor height for the sky [m, (sky heights,)].
    levels: tuple[float, ...]
    height_kinks: tuple[float, ...]
    refraction: RefractingAir  #: LOWTRAN7's refraction.
    horizon_excess: FloatArray  #: Logarithm of the slant path to the sea horizon over its straight length [1, (heights,)].
    ray: FloatArray  #: Path coordinate of LOWTRAN7's rays against the coordinate of straight ones [1, (heights, nodes)].
    path_depth: Spectra  #: Encoded optical depth of paths; arrays as in ``read_table``.
    path_temperature: Spectra  #: Effective air temperature of paths [K].
    sun_depth: Spectra  #: Encoded optical depth of the path to the Sun.
    sky_temperature: Spectra  #: Temperature of the sky, horizontal to zenith [K].
    sky_dip: Spectra  #: Temperature of the sky, horizontal down to the sea horizon [K].

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
        """Direct sunlight at the sea [W m-2 per cm-1, (..., n)] from the encoded depth of the path to the Sun; 0 below the horizon."""
        up = (np.asarray(solar_zenith, dtype=np.float64) <= 0.5 * np.pi + ANGLE_SLACK)[..., np.newaxis]
        return np.asarray(np.where(up, self.solar * np.exp(-decode_optical_depth(encoded)), 0.0))


def _covered(grid: FloatArray) -> str:
    return f"{1e4 / grid[-1]:.3g}-{1e4 / grid[0]:.3g}"


@dataclass(frozen=True, eq=False)
class BatchAtmosphere:
    """LOWTRAN7 model atmosphere over one band for cases of different winds. Make it with ``load``.

    Notes
    -----
    LOWTRAN7's Navy maritime aerosol at winds (U10, also the 24-hour mean) of 0 to 20 m/s, heights of 2 m to 10 km, paths to the sea named
    by the depression of LOWTRAN7's own refracted ray at the sensor, in its layers and at its 20 cm-1, sampled every 5. Radiance is thermal.
    Against LOWTRAN7 runs off the nodes (3-5 um) the 95th percentile of the error is 0.15 % of band transmittance, 0.1 % of path radiance
    and sunlight, 0.05 % of the sky above the sea, and 1.5 % (largest 5 %) of the sky from a height within four dips of the horizon.

    References
    ----------
    Kneizys, F. X., et al. (1988), Users Guide to LOWTRAN 7, AFGL-TR-88-0177; Gathman, S. G. (1983), Optical properties of
    the marine aerosol as predicted by the Navy aerosol model, Opt. Eng. 22, 57-62.

    Examples
    --------
    >>> air = BatchAtmosphere.load("midlatitude-summer", (3.5, 5.0))
    >>> transmittance, radiance = air.path([5.0, 12.0], [100.0, 30.0], np.radians([1.0, 0.5]))
    >>> transmittance.shape
    (2, 173)
    """

    model: str  #: Name of the model atmosphere.
    wavenumber_cm: FloatArray  #: Ascending spectral samples [cm-1, (n,)].
    wind_range: tuple[float, float]  #: Lowest and highest wind of the table [m s-1].
    height_range: tuple[float, float]  #: Lowest and highest height of the table [m].
    extrapolate: bool  #: Whether winds and heights beyond the ranges are accepted.
    _table: BandTable
    _ray: FloatArray
    #: Scores of depth and temperature side by side, values and slopes along the path [(winds, heights, 2 nodes, components)].
    _path_scores: FloatArray
    _sun_scores: FloatArray
    _sky_scores: FloatArray  #: Scores of the sky above the sea against elevation, values and slopes [(winds, 2 nodes, components)].

    @classmethod
    def load(cls, model: str, band_um: tuple[float, float], *, extrapolate: bool = False) -> BatchAtmosphere:
        """Read the table of ``model`` over a band [um].

        With ``extrapolate`` winds above the table take the air of its highest wind, as in LOWTRAN7 itself. Below the table's lowest height
        a path is one of equal length from there: the air is the same (transmittance within 0.02 %, path radiance 0.1 %, 0.5 m). The path to
        a sensor above it ends where the ray passes the highest one and lacks the air above: at 15 km and 30 deg down 1-3 % of transmittance
        and 3-9 % of path radiance, more towards the horizon. Outside winds and heights are refused otherwise.

        Raises
        ------
        DomainError
            For an unknown model or a band outside the tables.
        DataError
            If the file in the package is damaged.
        """
        table = BandTable.read(model, band_um)
        winds, heights = table.winds, table.heights
        return cls(
            model=model,
            wavenumber_cm=table.wavenumber_cm,
            wind_range=(float(winds[0]), float(winds[-1])),
            height_range=(float(heights[0]), float(heights[-1])),
            extrapolate=extrapolate,
            _table=table,
            _ray=_and_slopes(np.asarray(table.ray)[..., None])[..., 0],
            _path_scores=np.ascontiguousarray(
                _and_slopes(np.concatenate([table.path_depth.scores, table.path_temperature.scores], axis=-1))
            ),
            _sun_scores=_and_slopes(table.sun_depth.scores),
            _sky_scores=_and_slopes(table.sky_temperature.scores[:, 0]),  # the lowest height is the sea
        )

    def _wind(self, wind_speed: ArrayLike) -> Stencil:
        wind = self._covered(np.asarray(wind_speed, dtype=np.float64), self.wind_range, "wind_speed", "m/s")
        return Stencil.between_kinks(self._table.winds, self._table.wind_kinks, wind)

    def _height(self, height: FloatArray) -> Stencil:
        return self._table.at_heights(self._covered(height, self.height_range, "sensor height", "m"))

    def _covered(self, values: FloatArray, allowed: tuple[float, float], name: str, unit: str) -> FloatArray:
        """Return values inside the table; those outside are set to its edge, or refused."""
        if not self.extrapolate:
            _require(values, allowed, name, unit)
        return np.clip(values, *allowed)

    def dip(self, height: ArrayLike) -> FloatArray:
        """Depression of the sea horizon by LOWTRAN7's refraction [rad] at heights [m]."""
        return self._table.refraction.depression(height, 0.0)

    def path(self, wind_speed: ArrayLike, height: ArrayLike, depression: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Transmittance [1] and thermal path radiance [W m-2 sr-1 per cm-1], both (cases, n), of rays that end on the sea.

        Parameters
        ----------
        wind_speed : array_like
            U10 [m s-1, (cases,)].
        height : array_like
            Sensor height [m, (cases,)].
        depression : array_like
            Below the horizontal at the sensor [rad, (cases,)].

        Raises
        ------
        DomainError
            A wind or height outside the table, or a ray that misses the sea.
        """
        h = np.asarray(height, dtype=np.float64)
        at_height = self._height(h)
        cosine = self._table.refraction.sea_cosine(h, depression)
        if np.any(np.isnan(cosine)):
            raise DomainError("a line of sight misses the sea; give depressions below the sea horizon, see dip()")
        h = np.minimum(h, self.height_range[1])
        straight = path_coordinate(straight_slant(h, cosine), h, straight_slant(h, 0.0))
        nodes = np.linspace(0.0, 1.0, self._ray.shape[-1] // 2)
        # The ray's spline converts the coordinate of the straight path to the coordinate of LOWTRAN7's own ray, on which the nodes are.
        x = np.maximum(at_height.times(Stencil.hermite(nodes, straight)).of(self._ray.reshape(-1)), 0.0)
        x, share = self._of_length(h, x)
        path_nodes = np.linspace(0.0, 1.0, self._path_scores.shape[2] // 2)
        where = self._wind(wind_speed).times(at_height).times(Stencil.hermite(path_nodes, x))
        optical_depth, air = self._table.path_at(self._path_scores, where)
        optical_depth *= share[:, None]
        transmittance = np.exp(-optical_depth)
        return transmittance, -np.expm1(-optical_depth) * planck_wavenumber(self.wavenumber_cm, air)

    def _of_length(self, height: FloatArray, x: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Path of equal length from the table's lowest height, for heights below it, and its share where that path is too long."""
        lowest, share = self.height_range[0], np.ones_like(x)
        low = height < lowest
        if low.any():
            # the path coordinate x is logarithmic: length h^(1 - x) s_horizon^x
            excess = np.exp(self._table.horizon_excess[0])
            length = height[low] ** (1.0 - x[low]) * (straight_slant(height[low], 0.0) * excess) ** x[low]
            x = x.copy()
            x[low] = np.maximum(np.log(length / lowest) / np.log(straight_slant(lowest, 0.0) * excess / lowest), 0.0)
            share[low] = np.minimum(length / lowest, 1.0)
        return x, share

    def solar_irradiance(self, wind_speed: ArrayLike, solar_zenith: ArrayLike) -> FloatArray:
        """Direct sunlight at the sea, normal to the beam, Sun at 1 au [W m-2 per cm-1, (cases, n)]; 0 beyond a zenith angle of pi/2."""
        y = self._table.sun_coordinate(solar_zenith)
        return self._table.sunlight(solar_zenith, self._against_elevation(self._table.sun_depth, self._sun_scores, wind_speed, y))

    def sky_radiance(self, wind_speed: ArrayLike, zenith: ArrayLike, height: ArrayLike | None = None) -> FloatArray:
        """Thermal radiance of the clear sky [W m-2 sr-1 per cm-1, (cases, n)] at zenith angles [rad, (cases,)].

        The sky above the sea, or at heights [m, (cases,)], there down to the horizon of LOWTRAN7's own rays (``dip``).
        """
        angle = np.asarray(zenith, dtype=np.float64)
        if height is not None:
            return self._sky_from(wind_speed, angle, np.asarray(height, dtype=np.float64))
        _require(angle, (0.0, 0.5 * np.pi), "zenith", "rad")
        y = np.minimum(elevation_coordinate(0.5 * np.pi - angle, 0.0), 1.0)
        temperature = self._against_elevation(self._table.sky_temperature, self._sky_scores, wind_speed, y)
        return planck_wavenumber(self.wavenumber_cm, temperature)

    def _sky_from(self, wind_speed: ArrayLike, zenith: FloatArray, height: FloatArray) -> FloatArray:
        table = self._table
        at = self._covered(height, (0.0, float(table.sky_heights[-1])), "sensor height", "m")
        dip, elevation = self.dip(at), 0.5 * np.pi - zenith
        _require(elevation, (float(-dip.max()), 0.5 * np.pi), "elevation of the sky", "rad")
        where = self._wind(wind_speed).times(table.at_sky_heights(at))
        up, low = self._skies
        nodes = (up.shape[2] // 2, low.shape[2] // 2)
        y = np.minimum(elevation_coordinate(np.maximum(elevation, 0.0), dip), 1.0)
        scores = where.times(Stencil.hermite(np.linspace(0.0, 1.0, nodes[0]), y)).of(up.reshape(-1, up.shape[-1]))
        below = elevation < 0.0
        if below.any():
            x = np.minimum(dip_coordinate(-elevation[below], dip[below]), 1.0)
            dip_stencil = Stencil(where.index[below], where.weight[below], where.size).times(
                Stencil.hermite(np.linspace(0.0, 1.0, nodes[1]), x)
            )
            scores[below] = dip_stencil.of(low.reshape(-1, low.shape[-1]))
        return planck_wavenumber(self.wavenumber_cm, table.sky_temperature.of(scores))

    @cached_property
    def _skies(self) -> tuple[FloatArray, FloatArray]:
        """Scores and slopes of the sky from all heights, above and below the horizontal [(winds, heights, 2 nodes, components)]."""
        return _and_slopes(self._table.sky_temperature.scores), _and_slopes(self._table.sky_dip.scores)

    def _against_elevation(self, spectra: Spectra, scores: FloatArray, wind_speed: ArrayLike, y: FloatArray) -> FloatArray:
        """Spectra at the winds and elevation coordinates of the cases [(cases, n)]."""
        where = self._wind(wind_speed).times(Stencil.hermite(np.linspace(0.0, 1.0, scores.shape[1] // 2), y))
        return spectra.of(where.of(scores.reshape(where.size, -1)))


def _and_slopes(values: FloatArray) -> FloatArray:
    """Return values at even nodes 0...1 followed by the slopes of their spline."""
    return with_slopes(np.linspace(0.0, 1.0, values.shape[-2]), values)


def _require(values: FloatArray, allowed: tuple[float, float], name: str, unit: str) -> None:
    outside = ~((values >= allowed[0]) & (values <= allowed[1]))
    if outside.any():
        raise DomainError(
            f"{name} = {values[outside][0]:g} {unit} is outside {allowed[0]:g}-{allowed[1]:g} {unit} of this atmosphere",
            name=name.replace(" ", "_"),
            value=float(values[outside][0]),
            allowed=allowed,
        )
