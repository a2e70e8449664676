"""Many cases of one table atmosphere at once: a wind, a height and angles per case, as spreadsheets have them.

:class:`~seaglint.atmosphere.table.TableAtmosphere` is the table at one wind. Here every case brings its own, and the same splines are
taken as sparse sums over node values: a not-a-knot spline in wind and height is a sum over the nodes between two kinks, along the path
two values and two slopes suffice. Both give the same numbers to rounding.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import CubicSpline
from scipy.sparse import csr_array

from seaglint.atmosphere.base import FloatArray, wavenumber_grid
from seaglint.atmosphere.coordinates import (
    Refraction,
    decode_optical_depth,
    elevation_coordinate,
    height_coordinate,
    path_coordinate,
    straight_slant,
)
from seaglint.atmosphere.table import models, read_table
from seaglint.errors import DomainError
from seaglint.optics.blackbody import planck_wavenumber

_REGIONS: Final = ("mwir", "lwir")


def table_models() -> tuple[str, ...]:
    """Names of the model atmospheres whose tables cover every spectral region."""
    return tuple(sorted(set.intersection(*(set(models(region)) for region in _REGIONS))))


@dataclass(frozen=True, eq=False)
class Stencil:
    """Which node values a spline at each case adds up, and with which weights; short rows are filled up with weight 0.

    Attributes
    ----------
    index : ndarray of int
        Nodes [(cases, m)].
    weight : ndarray
        Weights [1, (cases, m)].
    size : int
        How many nodes there are to choose from.
    """

    index: NDArray[np.intp]
    weight: FloatArray
    size: int

    @classmethod
    def between_kinks(cls, nodes: FloatArray, kinks: tuple[float, ...], x: FloatArray) -> Stencil:
        """Not-a-knot cubic spline between kinks, as :func:`seaglint.atmosphere.coordinates.spline_weights` has it for one ``x``."""
        edges = np.array(sorted({float(nodes[0]), *kinks, float(nodes[-1])}))
        part = np.clip(np.searchsorted(edges, x, side="right"), 1, edges.size - 1)
        inside = [np.flatnonzero((nodes >= edges[j - 1]) & (nodes <= edges[j])) for j in range(1, edges.size)]
        widest = max(found.size for found in inside)
        index, weight = np.zeros((x.size, widest), dtype=np.intp), np.zeros((x.size, widest))
        for j, found in enumerate(inside, start=1):
            cases = np.flatnonzero(part == j)
            if cases.size:
                index[cases, : found.size] = found
                weight[cases, : found.size] = CubicSpline(nodes[found], np.eye(found.size))(x[cases])
        return cls(index, weight, nodes.size)

    @classmethod
    def hermite(cls, nodes: FloatArray, x: FloatArray) -> Stencil:
        """Cubic through values and slopes at the two nodes around ``x``, the end's tangent beyond the last one.

        Node values are followed by node slopes, as :func:`with_slopes` stacks them.
        """
        n = nodes.size
        left = np.clip(np.searchsorted(nodes, x, side="right") - 1, 0, n - 2)
        step = nodes[left + 1] - nodes[left]
        t = np.minimum((x - nodes[left]) / step, 1.0)
        beyond = np.maximum(x - nodes[-1], 0.0)
        weight = (
            (1.0 + 2.0 * t) * (1.0 - t) ** 2,
            t * t * (3.0 - 2.0 * t),
            step * t * (1.0 - t) ** 2,
            step * t * t * (t - 1.0) + beyond,
        )
        return cls(np.stack([left, left + 1, left + n, left + 1 + n], axis=1), np.stack(weight, axis=1), 2 * n)

    def times(self, other: Stencil) -> Stencil:
        """Product of two directions, the other one running fastest."""
        index = self.index[:, :, None] * other.size + other.index[:, None, :]
        weight = self.weight[:, :, None] * other.weight[:, None, :]
        return Stencil(index.reshape(index.shape[0], -1), weight.reshape(index.shape[0], -1), self.size * other.size)

    def of(self, values: FloatArray) -> FloatArray:
        """Sums over node values [(size, ...)]: (cases, ...)."""
        cases, width = self.index.shape
        matrix = csr_array((self.weight.ravel(), self.index.ravel(), np.arange(0, cases * width + 1, width)), shape=(cases, self.size))
        return np.asarray(matrix @ values.reshape(self.size, -1)).reshape(cases, *values.shape[1:])


def with_slopes(nodes: FloatArray, values: FloatArray) -> FloatArray:
    """Node values [(..., nodes, k)] followed by the slopes that their cubic spline has there: (..., 2 nodes, k)."""
    slope = np.asarray(CubicSpline(nodes, np.eye(nodes.size))(nodes, 1))
    return np.concatenate([values, slope @ values], axis=-2)


@dataclass(frozen=True, eq=False)
class _Spectra:
    """Scores at the nodes [(winds, ..., components)] and the spectra they belong to."""

    scores: FloatArray
    components: FloatArray
    mean: FloatArray

    def spectra(self, scores: FloatArray) -> FloatArray:
        return np.asarray(scores @ self.components + self.mean)


@dataclass(frozen=True, eq=False)
class BatchAtmosphere:
    """One LOWTRAN7 model atmosphere over one band, at a wind per case. Make it with :meth:`load`.

    Attributes
    ----------
    model : str
        Name of the model atmosphere.
    wavenumber_cm : ndarray
        Ascending spectral samples [cm-1, (n,)].
    wind_range, height_range : tuple of float
        What the table covers [m s-1], [m].
    extrapolate : bool
        Whether winds and heights beyond that are taken.

    Notes
    -----
    Physics, ranges and accuracy are those of :class:`~seaglint.atmosphere.table.TableAtmosphere`. Paths are named by the depression of
    LOWTRAN7's own refracted ray at the sensor.

    Examples
    --------
    >>> air = BatchAtmosphere.load("midlatitude-summer", (3.5, 5.0))
    >>> transmittance, radiance = air.path([5.0, 12.0], [100.0, 30.0], np.radians([1.0, 0.5]))
    >>> transmittance.shape
    (2, 173)
    """

    model: str
    wavenumber_cm: FloatArray
    wind_range: tuple[float, float]
    height_range: tuple[float, float]
    extrapolate: bool
    _winds: FloatArray
    _wind_kinks: tuple[float, ...]
    _heights: FloatArray
    _height_levels: tuple[float, ...]
    _height_kinks: tuple[float, ...]
    _refraction: Refraction
    _solar: FloatArray
    _horizon_excess: FloatArray
    _ray: FloatArray
    _path_depth: _Spectra
    _path_temperature: _Spectra
    _path_scores: FloatArray
    """Of depth and temperature side by side, values and slopes along the path [(winds, heights, 2 nodes, components)]."""
    _sun_depth: _Spectra
    _sky_temperature: _Spectra

    @classmethod
    def load(cls, model: str, band_um: tuple[float, float], *, extrapolate: bool = False) -> BatchAtmosphere:
        """Read the table of ``model`` over a band [um].

        With ``extrapolate`` winds above the table see the air of its highest wind, as in LOWTRAN7 itself. Below the table's lowest height a
        path is one of equal length from there: the air is the same (transmittance within 0.02 %, path radiance 0.1 %, 0.5 m). The path to
        a sensor above it ends where the ray passes the highest one and lacks the air above: at 15 km and 30 deg down 1-3 % of
        transmittance and 3-9 % of path radiance, more towards the horizon. Outside winds and heights are refused otherwise.

        Raises
        ------
        DomainError
            For an unknown model or a band outside the tables.
        DataError
            If the file in the package is damaged.
        """
        file, keep = _read_band(model, band_um)

        def spectra(name: str, scores: FloatArray) -> _Spectra:
            components = np.asarray(file[name + "_components"][:, keep], dtype=np.float64)
            return _Spectra(scores, components, np.asarray(file[name + "_mean"][keep], dtype=np.float64))

        def nodes(name: str) -> FloatArray:
            return np.asarray(file[name + "_scores"], dtype=np.float64)

        def along(values: FloatArray) -> FloatArray:
            return with_slopes(np.linspace(0.0, 1.0, values.shape[-2]), values)

        depth, temperature = nodes("path_depth"), nodes("path_temperature")
        heights, winds = np.asarray(file["heights"]), np.asarray(file["winds"])
        return cls(
            model=model,
            wavenumber_cm=np.array(file["wavenumber_cm"][keep]),
            wind_range=(float(winds[0]), float(winds[-1])),
            height_range=(float(heights[0]), float(heights[-1])),
            extrapolate=extrapolate,
            _winds=winds,
            _wind_kinks=tuple(float(k) for k in file["wind_kinks"]),
            _heights=heights,
            _height_levels=tuple(float(k) for k in file["height_levels"]),
            _height_kinks=tuple(float(k) for k in file["height_kinks"]),
            _refraction=Refraction(file["level_height"], file["refractivity"], float(file["earth_radius"])),
            _solar=np.array(file["solar"][keep]),
            _horizon_excess=np.asarray(file["horizon_excess"]),
            _ray=along(np.asarray(file["ray"])[..., None])[..., 0],
            _path_depth=spectra("path_depth", depth),
            _path_temperature=spectra("path_temperature", temperature),
            _path_scores=np.ascontiguousarray(along(np.concatenate([depth, temperature], axis=-1))),
            _sun_depth=spectra("sun_depth", along(nodes("sun_depth"))),
            _sky_temperature=spectra("sky_temperature", along(nodes("sky_temperature")[:, 0])),  # the lowest height is the sea
        )

    def _wind(self, wind_speed: ArrayLike) -> Stencil:
        wind = self._covered(np.asarray(wind_speed, dtype=np.float64), self.wind_range, "wind_speed", "m/s")
        return Stencil.between_kinks(self._winds, self._wind_kinks, wind)

    def _height(self, height: FloatArray) -> Stencil:
        inside = self._covered(height, self.height_range, "sensor height", "m")
        levels = (*self._height_levels, float(self._heights[-1]))
        kinks = tuple(height_coordinate(self._height_kinks, levels).tolist())
        return Stencil.between_kinks(height_coordinate(self._heights, levels), kinks, height_coordinate(inside, levels))

    def _covered(self, values: FloatArray, allowed: tuple[float, float], name: str, unit: str) -> FloatArray:
        """Values inside the table; those outside are moved to its edge, or refused."""
        if not self.extrapolate:
            _require(values, allowed, name, unit)
        return np.clip(values, *allowed)

    def dip(self, height: ArrayLike) -> FloatArray:
        """Depression of the sea horizon by LOWTRAN7's refraction at heights [m], [rad]."""
        return self._refraction.depression(height, 0.0)

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
        cosine = self._refraction.sea_cosine(h, depression)
        if np.any(np.isnan(cosine)):
            raise DomainError("a line of sight misses the sea; give depressions below the sea horizon, see dip()")
        h = np.minimum(h, self.height_range[1])
        straight = path_coordinate(straight_slant(h, cosine), h, straight_slant(h, 0.0))
        nodes = np.linspace(0.0, 1.0, self._ray.shape[-1] // 2)
        # The ray's spline says how far along LOWTRAN7's own path the sea lies: the coordinate of the path nodes.
        x = np.maximum(at_height.times(Stencil.hermite(nodes, straight)).of(self._ray.reshape(-1)), 0.0)
        x, share = self._of_length(h, x)
        path_nodes = np.linspace(0.0, 1.0, self._path_scores.shape[2] // 2)
        stencil = self._wind(wind_speed).times(at_height).times(Stencil.hermite(path_nodes, x))
        scores = stencil.of(self._path_scores.reshape(stencil.size, -1))
        rank = self._path_depth.components.shape[0]
        optical_depth = decode_optical_depth(self._path_depth.spectra(scores[:, :rank]))
        optical_depth *= share[:, None]
        air = self._path_temperature.spectra(scores[:, rank:])
        transmittance = np.exp(-optical_depth)
        return transmittance, -np.expm1(-optical_depth) * planck_wavenumber(self.wavenumber_cm, air)

    def _of_length(self, height: FloatArray, x: FloatArray) -> tuple[FloatArray, FloatArray]:
        """For heights below the table the path of equal length from its lowest height, and the share of it where that is too long."""
        lowest, share = self.height_range[0], np.ones_like(x)
        low = height < lowest
        if low.any():
            excess = np.exp(self._horizon_excess[0])
            length = height[low] ** (1.0 - x[low]) * (straight_slant(height[low], 0.0) * excess) ** x[low]
            x = x.copy()
            x[low] = np.maximum(np.log(length / lowest) / np.log(straight_slant(lowest, 0.0) * excess / lowest), 0.0)
            share[low] = np.minimum(length / lowest, 1.0)
        return x, share

    def solar_irradiance(self, wind_speed: ArrayLike, solar_zenith: ArrayLike) -> FloatArray:
        """Direct sunlight at the sea, normal to the beam, Sun at 1 au [W m-2 per cm-1, (cases, n)]; 0 beyond a zenith angle of pi/2."""
        zenith = np.asarray(solar_zenith, dtype=np.float64)
        _require(zenith, (0.0, np.pi), "solar_zenith", "rad")
        y = elevation_coordinate(np.maximum(0.5 * np.pi - zenith, 0.0), 0.0)
        found = self._wind(wind_speed).times(self._elevation(self._sun_depth, y))
        encoded = self._sun_depth.spectra(found.of(self._sun_depth.scores.reshape(found.size, -1)))
        up = (zenith <= 0.5 * np.pi)[:, None]
        return np.asarray(np.where(up, self._solar * np.exp(-decode_optical_depth(encoded)), 0.0))

    def sky_radiance(self, wind_speed: ArrayLike, zenith: ArrayLike) -> FloatArray:
        """Thermal radiance of the clear sky seen from the sea [W m-2 sr-1 per cm-1, (cases, n)], zenith angles 0..pi/2 [rad, (cases,)]."""
        angle = np.asarray(zenith, dtype=np.float64)
        _require(angle, (0.0, 0.5 * np.pi), "zenith", "rad")
        y = np.minimum(elevation_coordinate(0.5 * np.pi - angle, 0.0), 1.0)
        found = self._wind(wind_speed).times(self._elevation(self._sky_temperature, y))
        temperature = self._sky_temperature.spectra(found.of(self._sky_temperature.scores.reshape(found.size, -1)))
        return planck_wavenumber(self.wavenumber_cm, temperature)

    @staticmethod
    def _elevation(values: _Spectra, y: FloatArray) -> Stencil:
        return Stencil.hermite(np.linspace(0.0, 1.0, values.scores.shape[1] // 2), y)


def _require(values: FloatArray, allowed: tuple[float, float], name: str, unit: str) -> None:
    outside = ~((values >= allowed[0]) & (values <= allowed[1]))
    if outside.any():
        raise DomainError(
            f"{name} = {values[outside][0]:g} {unit} is outside {allowed[0]:g}-{allowed[1]:g} {unit} of this atmosphere",
            name=name.replace(" ", "_"),
            value=float(values[outside][0]),
            allowed=allowed,
        )


def _read_band(model: str, band_um: tuple[float, float]) -> tuple[Mapping[str, Any], slice]:
    """Content of the file of ``model`` that covers a band [um], and the part of its spectral grid that the band needs."""
    wanted = wavenumber_grid(*band_um)
    region = "mwir" if band_um[0] < 6.5 else "lwir"
    if model not in table_models():
        raise DomainError(f"model = {model!r} has no table; choose one of {', '.join(table_models())}")
    file = read_table(model, region)
    grid = file["wavenumber_cm"]
    if wanted[0] < grid[0] or wanted[-1] > grid[-1]:
        grids = [read_table(model, name)["wavenumber_cm"] for name in _REGIONS]
        covered = " and ".join(f"{1e4 / g[-1]:.3g}-{1e4 / g[0]:.3g}" for g in grids)
        raise DomainError(
            f"band {band_um[0]:g}-{band_um[1]:g} um reaches beyond the tables of {covered} um; choose a band inside one",
            name="band_um",
            value=band_um,
            allowed=f"{covered} um",
        )
    return file, slice(int(np.searchsorted(grid, wanted[0])), int(np.searchsorted(grid, wanted[-1])) + 1)
