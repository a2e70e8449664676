r"""Transmittance and thermal emission along any ray through a profile, with band laws of LOWTRAN7's form.

.. math:: \tau(\nu, s) = \exp\Bigl(-\sum_k c_k W_k(s) - \sum_b (C_b W_b(s))^{a_b}\Bigr), \qquad
   L(\nu) = \int_{\tau}^1 B(\nu, T)\, d\tau'

``W(s)`` are the amounts between the sensor and the place s; lines saturate, so that transmittances follow from the amounts of whole paths.
Emission follows the temperature at the place. Densities are exponential between the profile's levels, as in LOWTRAN7; amounts between two
nodes are exact vertical sums times the ray's mean slope, so that a profile may have any number of levels.

The wind affects the aerosol alone: the optical depths of the gases along rays are cached (``GasRays``) and serve hazes of other winds.
"""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass, field, replace
from typing import Final, cast

import numpy as np
from numpy.typing import NDArray

from seaglint.air.profile.absorber_densities import absorber_densities, cold_share, refractivity
from seaglint.air.profile.aerosols import HUMID_TABLES, HazeWeather, aerosols
from seaglint.air.profile.air_profile import AirProfile
from seaglint.air.profile.band_laws import BandLaws, Spectroscopy
from seaglint.air.profile.bent_ray import BentRay, RefractingAir
from seaglint.air.profile.ray_paths import LayeredIndex
from seaglint.base.conventions import FloatArray
from seaglint.optics.blackbody import planck_wavenumber

MOST_BYTES: Final = 64 << 20  #: Largest size of the cached rays of a profile on some channels [bytes].

AEROSOLS: Final = 4

#: Humidities [%] between which extinction of a humid haze is linear in ``log(100 - RH)``, so that it follows the humidity at every place.
LOCAL_HUMIDITIES: Final = np.array([0.0, 50.0, 70.0, 75.0, 80.0, 84.0, 88.0, 91.0, 94.0, 96.0, 98.0, 99.0])

_FIRST, _SECOND = 1.190956e-16 * 1e8, 1.43879  #: LOWTRAN7's radiation constants: [W m-2 sr-1 per (cm-1)^4], [K cm].

CUTS: Final = 3  #: Parts of equal length of every piece for which the ray's slope is taken as even.

LEVEL: Final = 1e-6  #: Rise below which a cut counts as level [m].

PARTS: Final = 8  #: Pieces of a layer in LOWTRAN7's layers.


@dataclass(frozen=True, eq=False)
class GasRay:
    """Path through the air, with the quantities that do not depend on a haze."""

    ray: BentRay | None  #: The ray; None for a path between two heights.
    height: FloatArray  #: Heights of the cuts [m, (cuts + 1,)].
    length: FloatArray  #: Lengths of the cuts [m, (cuts,)].
    #: Optical depth of the gases from the start to the ends of the pieces [1, (pieces, n)], or of the whole path [1, (n,)].
    depth: FloatArray
    glow: FloatArray | None = None  #: Mean Planck radiance of the pieces [W m-2 sr-1 per cm-1, (pieces, n)]; None if it is not needed.

    @property
    def size(self) -> int:
        """Size in memory [bytes]."""
        return self.height.nbytes + self.length.nbytes + self.depth.nbytes + (0 if self.glow is None else self.glow.nbytes)


@dataclass(eq=False)
class GasRays:
    """Cache of rays of one profile on some channels; beyond ``MOST_BYTES`` the least recently used are dropped."""

    _cached: OrderedDict[Hashable, GasRay] = field(default_factory=OrderedDict)
    _size: int = 0
    _lock: threading.Lock = field(default_factory=threading.Lock)

    def get(self, key: Hashable, make: Callable[[], GasRay]) -> GasRay:
        """Return the ray of a key, computed if it is not cached."""
        return self.get_each([key], lambda _: [make()])[0]

    def get_each(self, keys: Sequence[Hashable], make: Callable[[Sequence[int]], Sequence[GasRay]]) -> list[GasRay]:
        """Return the rays of keys; missing ones are computed together, by their positions among the keys."""
        rays: dict[Hashable, GasRay] = {}
        with self._lock:
            for key in keys:
                cached = self._cached.get(key)
                if cached is not None:
                    self._cached.move_to_end(key)
                    rays[key] = cached
        # computed outside the lock, so that threads do not wait for each other; of two equal rays one is stored
        missing = [k for k, key in enumerate(keys) if key not in rays]
        if missing:
            computed = {keys[k]: ray for k, ray in zip(missing, make(missing), strict=True)}
            rays |= computed
            with self._lock:
                for key, ray in computed.items():
                    if key not in self._cached:
                        self._cached[key] = ray
                        self._size += ray.size
                # the newest ray stays, whatever its size
                while self._size > MOST_BYTES and len(self._cached) > 1:
                    self._size -= self._cached.popitem(last=False)[1].size
        return [rays[key] for key in keys]


@dataclass(frozen=True, eq=False)
class RaySpectra:
    """Spectra along a ray."""

    ray: BentRay  #: The ray.
    transmittance: FloatArray  #: From its start to its nodes [1, (nodes, n)].
    emitted: FloatArray  #: Thermal radiance of the air along it, at the start [W m-2 sr-1 per cm-1, (n,)].


@dataclass(frozen=True, eq=False)
class _Densities:
    """Densities over height, exponential between levels, linear next to a zero. Make it with ``of``."""

    height: FloatArray  #: Levels [km, (levels,)].
    density: FloatArray  #: Densities [(rows, levels)].
    exponential: NDArray[np.bool_]  #: Whether a layer is exponential [(rows, levels - 1)].
    growth: FloatArray  #: Logarithm of the ratio of densities across an exponential layer, 0 in others [1, (rows, levels - 1)].
    sums: FloatArray  #: Vertical sums up to the levels [(rows, levels)].

    @classmethod
    def of(cls, height: FloatArray, density: FloatArray, *, growing: bool = True) -> _Densities:
        """Densities at levels [km]; those that grow with height are linear between levels unless ``growing``."""
        a, b = density[:, :-1], density[:, 1:]
        exponential = (a > 0.0) & (b > 0.0) & (growing | (b <= a))
        growth = np.log(np.where(exponential, b, 1.0) / np.where(exponential, a, 1.0))
        without_sums = cls(height, density, exponential, growth, np.zeros_like(density))
        layers = without_sums._layer_integral(np.arange(height.size - 1), np.ones(height.size - 1))
        return replace(without_sums, sums=np.concatenate([without_sums.sums[:, :1], np.cumsum(layers, axis=1)], axis=1))

    def rows(self, first: int, end: int) -> _Densities:
        """Select the densities of some rows."""
        chosen = slice(first, end)
        return _Densities(self.height, self.density[chosen], self.exponential[chosen], self.growth[chosen], self.sums[chosen])

    def up_to(self, z: FloatArray) -> FloatArray:
        """Vertical sums up to heights [km] [(places, rows)]."""
        layer, fraction = self._layer(z)
        return np.asarray((self.sums[:, layer] + self._layer_integral(layer, fraction)).T)

    def at(self, z: FloatArray) -> FloatArray:
        """Densities at heights [km] [(places, rows)], exponential between two levels that both have some."""
        layer, fraction = self._layer(z)
        a, b = self.density[:, layer], self.density[:, layer + 1]
        exponential = (a > 0.0) & (b > 0.0)
        return np.asarray(
            np.where(
                exponential,
                np.where(exponential, a, 1.0) ** (1.0 - fraction) * np.where(exponential, b, 1.0) ** fraction,
                a + (b - a) * fraction,
            ).T
        )

    def _layer(self, z: FloatArray) -> tuple[NDArray[np.intp], FloatArray]:
        """Layers in which heights [km] are, and the part of the layer below each."""
        layer = np.clip(np.searchsorted(self.height, z, side="right") - 1, 0, self.height.size - 2)
        return layer, np.clip((z - self.height[layer]) / (self.height[layer + 1] - self.height[layer]), 0.0, 1.0)

    def _layer_integral(self, layer: NDArray[np.intp], fraction: FloatArray) -> FloatArray:
        """Integral from the lower level of layers up to a part of their thickness [(rows, places)]."""
        a, b = self.density[:, layer], self.density[:, layer + 1]
        growth = self.growth[:, layer] * fraction
        small = np.abs(growth) < 1e-6  # the series spares 0/0
        mean = np.where(small, 1.0 + 0.5 * growth, np.expm1(growth) / np.where(small, 1.0, growth))
        thick = (self.height[layer + 1] - self.height[layer]) * fraction
        return np.asarray(thick * np.where(self.exponential[:, layer], a * mean, a + 0.5 * (b - a) * fraction))


def joined_lines(lines: Sequence[tuple[FloatArray, FloatArray]]) -> tuple[FloatArray, FloatArray, NDArray[np.intp]]:
    """Join lines end to end: heights of their cuts [m], lengths of these [m], and the first piece of each line.

    Between two lines is an empty piece with parts of length 0. Summing all lines at once is much quicker.
    """
    # CUTS parts of length 0 are one piece, so that pieces of all lines stay aligned
    gap = CUTS - 1
    height = np.concatenate([np.append(z, np.full(gap, z[-1])) for z, _ in lines])[: -gap or None]
    length = np.concatenate([np.append(part, np.zeros(CUTS)) for _, part in lines])[:-CUTS]
    pieces = np.array([part.size // CUTS + 1 for _, part in lines])
    return height, length, np.cumsum(pieces) - pieces


class AirSums:
    """Air of one profile and haze on some channels.

    Parameters
    ----------
    profile : AirProfile
        The air.
    haze : HazeWeather
        Its aerosol.
    wavenumber_cm : ndarray
        Channels [cm-1, (n,)], multiples of 5 within 680-14290.
    refracted_cm : float, optional
        Wavenumber of the refractivity [cm-1], by default the middle of the channels, as in LOWTRAN7.
    spectroscopy : str
        Numbers of the band laws: ``lblrtm`` or ``lowtran7``.
    rays : GasRays, optional
        Rays shared with the same profile, channels and numbers in another haze.

    Examples
    --------
    >>> from seaglint.air.profile.air_profile import model_profile
    >>> air = AirSums(model_profile("midlatitude-summer"), HazeWeather(wind=7.0, wind_24h=7.0), np.arange(2000.0, 2861.0, 5.0))
    >>> sky = air.along(20.0, np.radians(80.0))
    >>> sky.emitted.shape
    (173,)
    """

    def __init__(
        self,
        profile: AirProfile,
        haze: HazeWeather,
        wavenumber_cm: FloatArray,
        refracted_cm: float | None = None,
        *,
        spectroscopy: Spectroscopy = "lblrtm",
        rays: GasRays | None = None,
    ) -> None:
        self.profile, self.haze, self.spectroscopy = profile, haze, spectroscopy
        self._rays = GasRays() if rays is None else rays
        self.laws = BandLaws.of(np.asarray(wavenumber_cm, dtype=np.float64), spectroscopy)
        central_cm = 0.5 * float(wavenumber_cm[0] + wavenumber_cm[-1]) if refracted_cm is None else refracted_cm
        self.index = LayeredIndex(profile.height, refractivity(profile, central_cm), profile.earth_radius)
        self.air = RefractingAir.of(profile.height, self.index.refractivity, profile.earth_radius)
        gases = absorber_densities(profile, self.laws.columns, self.laws.numbers.scaled)
        self._cold_row = self.laws.columns.index(9)
        self._self_row = self.laws.columns.index(5)
        self._aerosol = aerosols(profile, haze, self.laws.wavenumber_cm, 0.0)
        density, extinction = self._local_haze()
        self._extinction = extinction
        self._aerosol_rows = density.shape[0]
        mass = profile.pressure / profile.temperature
        # last rows: pressure and density of the air, for the temperatures of LOWTRAN7's layers, and the haze's humidity
        humidity = np.log(100.0 - np.minimum(profile.relative_humidity, 99.0)) * self._aerosol.density[0]
        rows = np.concatenate([density, 1e0 * gases, [profile.pressure, mass, humidity, self._aerosol.density[0]]])
        self._densities = _Densities.of(1e-3 * profile.height, rows)
        self._hazes = self._densities.rows(0, self._aerosol_rows)
        self._gases = self._densities.rows(self._aerosol_rows, rows.shape[0] - 4)
        self._heat = np.concatenate(
            [[0.0], np.cumsum(0.5 * (profile.temperature[1:] + profile.temperature[:-1]) * np.diff(profile.height))]
        )

    def _local_haze(self) -> tuple[FloatArray, FloatArray]:
        """Densities [(rows, levels)] and extinctions [(rows, n)] of the aerosols, a humid haze split by the humidity at the place."""
        aerosol = self._aerosol
        table = HUMID_TABLES.get(self.haze.haze)
        if table is None:
            return aerosol.density, aerosol.extinction
        x = -np.log(100.0 - np.minimum(self.profile.relative_humidity, 99.0))
        nodes = -np.log(100.0 - LOCAL_HUMIDITIES)
        # hat functions of the humidity: every node's extinction gets its share of the density at each level
        hats = np.array([np.interp(x, nodes, row) for row in np.eye(nodes.size)])
        spectra = [aerosols(self.profile, self.haze, self.laws.wavenumber_cm, float(h)).extinction[0] for h in LOCAL_HUMIDITIES]
        return np.concatenate([aerosol.density[0] * hats, aerosol.density[1:]]), np.concatenate([spectra, aerosol.extinction[1:]])

    def ray_amounts(self, ray: BentRay) -> tuple[FloatArray, FloatArray]:
        """Amounts of the gases in the pieces of a ray [(pieces, gases)] and mean temperatures of these [K, (pieces,)]."""
        z = ray.between(CUTS)
        # length over rise of every part turns vertical sums into sums along the ray
        slope = np.repeat(ray.length / CUTS, CUTS) / np.diff(z)
        vertical = np.diff(self._gases.up_to(1e-3 * z), axis=0)
        heat = np.diff(_heat_to(self.profile, self._heat, ray.height))
        return (vertical * slope[:, None]).reshape(-1, CUTS, vertical.shape[1]).sum(axis=1), heat / np.diff(ray.height)

    def _layer_amounts(self, ray: BentRay) -> FloatArray:
        """Amounts of the pieces of a layered ray [(pieces, rows)], as in LOWTRAN7.

        The start, the lowest point and the end of the ray are additional levels (its FILL), and densities that grow with height are
        linear between levels (its LAYER).
        """
        ends = 1e-3 * np.array([ray.height[0], ray.height.min(), ray.height[-1]])
        levels = self._densities.height
        new = np.setdiff1d(ends[(ends > levels[0]) & (ends < levels[-1])], levels)
        at = np.searchsorted(levels, new)
        filled = np.insert(self._densities.density, at, self._densities.at(new).T, axis=1)
        z = ray.between(CUTS)
        # length over rise of every part turns vertical sums into sums along the ray
        slope = np.repeat(ray.length / CUTS, CUTS) / np.diff(z)
        vertical = np.diff(_Densities.of(np.insert(levels, at, new), filled, growing=False).up_to(1e-3 * z), axis=0)
        return np.asarray((vertical * slope[:, None]).reshape(-1, CUTS, vertical.shape[1]).sum(axis=1))

    def along(self, height: float, zenith: float, end: float | None = None) -> RaySpectra:
        """Spectra along a ray from a height [m] at a zenith angle [rad], continuous; ``end`` as ``RefractingAir.ray``."""
        return self.along_each(height, [zenith], end)[0]

    def along_each(self, height: float, zenith: Sequence[float], end: float | None = None) -> list[RaySpectra]:
        """Spectra along several rays, as ``along``."""

        def computed(which: Sequence[int]) -> list[GasRay]:
            # lowest points are found together, all else ray by ray: its arrays stay in the processor's cache
            return [self._gas_ray(ray) for ray in self.air.rays(height, [zenith[k] for k in which], end)]

        paths = self._rays.get_each([("along", height, z, end) for z in zenith], computed)
        hazes = self._hazes_of(paths)
        return [RaySpectra(cast(BentRay, path.ray), *self._emitting(path, haze)) for path, haze in zip(paths, hazes, strict=True)]

    def _gas_ray(self, ray: BentRay) -> GasRay:
        return self._gas_path(ray, ray.between(CUTS), np.repeat(ray.length / CUTS, CUTS), ray.height, *self.ray_amounts(ray))

    def _hazes_of(self, paths: Sequence[GasRay]) -> list[FloatArray]:
        """Amounts of the aerosols in the pieces of each path [(pieces, aerosols)]."""
        height, length, first = joined_lines([(path.height, path.length) for path in paths])
        every = self.haze_amounts(height, length)
        return [every[at : at + path.length.size // CUTS] for path, at in zip(paths, first, strict=True)]

    def passed(self, height: float, zenith: float) -> FloatArray:
        """Transmittance [1, (n,)] of the whole ray of ``along``, at a fraction of its cost."""
        return np.asarray(self.passed_each(height, [zenith])[0])

    def passed_each(self, height: float, zenith: Sequence[float]) -> FloatArray:
        """Transmittance [1, (rays, n)] of several whole rays, as ``passed``."""

        def computed(which: Sequence[int]) -> list[GasRay]:
            return [self._passed_ray(ray) for ray in self.air.rays(height, [zenith[k] for k in which])]

        paths = self._rays.get_each([("passed", height, z) for z in zenith], computed)
        hazes = self._hazes_of(paths)
        return np.stack([np.exp(-path.depth - self.haze_depth(haze.sum(axis=0))) for path, haze in zip(paths, hazes, strict=True)])

    def _passed_ray(self, ray: BentRay) -> GasRay:
        return GasRay(ray, ray.between(CUTS), np.repeat(ray.length / CUTS, CUTS), self.gas_depth(*self.ray_amounts(ray)))

    def gas_depth(self, amounts: FloatArray, mean: FloatArray) -> FloatArray:
        """Optical depth of the gases [1, (n,)] from their amounts in pieces [(pieces, gases)] and temperatures [K, (pieces,)]."""
        gases = amounts.copy()
        gases[:, self._cold_row] = gases[:, self._self_row] * cold_share(mean, self.laws.cold_kelvin)
        return np.asarray(self.laws.optical_depth(gases.sum(axis=0, keepdims=True))[0])

    def haze_amounts(self, height: FloatArray, length: FloatArray) -> FloatArray:
        """Amounts of the aerosols in the pieces of a line cut at heights [m] into parts of lengths [m] [(pieces, aerosols)]."""
        return self._along_line(height, length, self._hazes)

    def haze_depth(self, amounts: FloatArray) -> FloatArray:
        """Optical depth of amounts of the aerosols [(..., aerosols)] [1, (..., n)]."""
        return np.asarray(amounts @ self._extinction)

    def cut_line(self, height: float, target: float, length: float) -> tuple[FloatArray, FloatArray]:
        """Heights of the cuts [m] and lengths of the parts [m] of the path between two heights [m] of a length [m]."""
        return self.air.line(height, target, length, CUTS)

    def between(self, height: float, target: float, length: float) -> tuple[FloatArray, FloatArray]:
        """Transmittance [1, (n,)] and emission [W m-2 sr-1 per cm-1, (n,)] of the path between two heights [m] of a length [m].

        The path is a line over the Earth of the radius that makes this air's rays straight between the heights that it passes; air
        below the sea is taken as at the sea.
        """
        return self.between_each(height, target, [length])[0]

    def between_each(self, height: float, target: float, lengths: Sequence[float]) -> list[tuple[FloatArray, FloatArray]]:
        """Transmittance [1, (n,)] and emission [W m-2 sr-1 per cm-1, (n,)] of paths of some lengths [m], as ``between``."""

        def computed(which: Sequence[int]) -> list[GasRay]:
            lines = [self.cut_line(height, target, lengths[k]) for k in which]
            z, step, first = joined_lines(lines)
            amounts, mean = self.line_amounts(z, step)
            pieces = [slice(at, at + part.size // CUTS) for at, (_, part) in zip(first, lines, strict=True)]
            return [self._gas_path(None, *line, line[0][::CUTS], amounts[p], mean[p]) for line, p in zip(lines, pieces, strict=True)]

        paths = self._rays.get_each([("between", height, target, length) for length in lengths], computed)
        spectra = [self._emitting(path, haze) for path, haze in zip(paths, self._hazes_of(paths), strict=True)]
        return [(passed[-1], emitted) for passed, emitted in spectra]

    def _gas_path(
        self, ray: BentRay | None, cuts: FloatArray, length: FloatArray, node: FloatArray, amounts: FloatArray, mean: FloatArray
    ) -> GasRay:
        """Gases of a path cut at heights [m], from their amounts [(pieces, gases)] between its nodes [m] and the temperatures there [K]."""
        gases = amounts.copy()
        gases[:, self._cold_row] = gases[:, self._self_row] * cold_share(mean, self.laws.cold_kelvin)
        nu = self.laws.wavenumber_cm
        at_node = planck_wavenumber(nu, np.interp(node, self.profile.height, self.profile.temperature)[:, None])
        # Simpson's rule over a piece: the Planck radiance at both ends, and at the mean temperature for the middle
        glow = (at_node[:-1] + 4.0 * planck_wavenumber(nu, mean[:, None]) + at_node[1:]) / 6.0
        return GasRay(ray, cuts, length, self.laws.optical_depth(np.cumsum(gases, axis=0)), glow)

    def _emitting(self, gases: GasRay, haze: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Transmittance to the nodes [1, (nodes, n)] and emission [W m-2 sr-1 per cm-1, (n,)] with a haze [(pieces, aerosols)]."""
        assert gases.glow is not None
        depth = gases.depth + np.cumsum(haze, axis=0) @ self._extinction
        # a piece emits its Planck radiance times the fall of transmittance across it
        passed = np.concatenate([np.ones((1, depth.shape[1])), np.exp(-depth)])
        return passed, np.sum(gases.glow * (passed[:-1] - passed[1:]), axis=0)

    def line_amounts(self, z: FloatArray, length: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Amounts of the gases [(pieces, gases)] and mean temperatures [K, (pieces,)] along a line cut at heights [m], ``CUTS`` a piece.

        Cuts that hardly rise have the density at their height.
        """
        z = np.maximum(z, 0.0)
        step = np.diff(z)
        # a level cut has no mean slope: its temperature is taken at its height
        level = np.abs(step) < LEVEL
        kelvin = np.diff(_heat_to(self.profile, self._heat, z)) / np.where(level, 1.0, step)
        if level.any():
            kelvin[level] = np.interp(0.5 * (z[1:] + z[:-1])[level], self.profile.height, self.profile.temperature)
        return self._along_line(z, length, self._gases), kelvin.reshape(-1, CUTS).mean(axis=1)

    def _along_line(self, z: FloatArray, length: FloatArray, densities: _Densities) -> FloatArray:
        z = np.maximum(z, 0.0)
        step = np.diff(z)
        level = np.abs(step) < LEVEL
        vertical = np.diff(densities.up_to(1e-3 * z), axis=0)
        amounts = vertical * np.where(level, 0.0, length / np.where(level, 1.0, step))[:, None]
        if level.any():
            mid_height = 0.5 * (z[1:] + z[:-1])[level]
            amounts[level] = 1e-3 * length[level, None] * densities.at(1e-3 * mid_height)
        return np.asarray(amounts.reshape(-1, CUTS, amounts.shape[1]).sum(axis=1))

    def layer_humidity(self, height: float, zenith: float) -> float:
        """Humidity [%] that LOWTRAN7 gives a humid haze along the ray of ``in_layers``."""
        return _path_humidity(self._layer_amounts(self.air.layered_ray(height, zenith, None, PARTS)[0]))

    def in_layers(self, height: float, zenith: float, end: float | None = None) -> RaySpectra:
        """Spectra along the same ray as LOWTRAN7 sums them: layers between levels have one temperature, its humid hazes one humidity."""
        ray, edges = self.air.layered_ray(height, zenith, end, PARTS)
        amounts = np.add.reduceat(self._layer_amounts(ray), edges[:-1], axis=0)
        # integrals of pressure and of pressure over temperature: the mean weighted with the density of air
        kelvin = amounts[:, -4] / amounts[:, -3]
        gases = amounts[:, self._aerosol_rows : -4]
        gases[:, self._cold_row] = gases[:, self._self_row] * cold_share(kelvin, self.laws.cold_kelvin)
        depth = self.laws.optical_depth(np.cumsum(gases, axis=0))
        extinction, haze = self._extinction, amounts[:, : self._aerosol_rows]
        if self._aerosol_rows > AEROSOLS:
            extinction = aerosols(self.profile, self.haze, self.laws.wavenumber_cm, _path_humidity(amounts)).extinction
            haze = np.concatenate([amounts[:, -1:], haze[:, 1 - AEROSOLS :]], axis=1)
        depth += np.cumsum(haze, axis=0) @ extinction
        # a piece emits its Planck radiance times the fall of transmittance across it
        passed = np.concatenate([np.ones((1, depth.shape[1])), np.exp(-depth)])
        nu = self.laws.wavenumber_cm
        glow = _FIRST * nu**3 / np.expm1(_SECOND * nu / kelvin[:, None])
        emitted = np.sum(glow * np.maximum(passed[:-1] - passed[1:], 0.0), axis=0)
        at_levels = BentRay(ray.height[edges], np.add.reduceat(ray.length, edges[:-1]), ray.zenith[edges], ray.arc[edges])
        return RaySpectra(at_levels, passed, emitted)


def _path_humidity(amounts: FloatArray) -> float:
    """Mean humidity of a path's haze [%], as LOWTRAN7 takes it for the whole path; 0 without haze."""
    whole = float(amounts[:, -1].sum())
    return float(100.0 - np.exp(amounts[:, -2].sum() / whole)) if whole > 0.0 else 0.0


def _heat_to(profile: AirProfile, heat: FloatArray, z: FloatArray) -> FloatArray:
    """Integral of the temperature from the sea up to heights [K m, (places,)]."""
    h, kelvin = profile.height, profile.temperature
    layer = np.clip(np.searchsorted(h, z, side="right") - 1, 0, h.size - 2)
    rise = z - h[layer]
    slope = (kelvin[layer + 1] - kelvin[layer]) / (h[layer + 1] - h[layer])
    # the temperature is linear in a layer, its integral quadratic
    return np.asarray(heat[layer] + rise * (kelvin[layer] + 0.5 * slope * rise))
