"""Sunlight that a mirroring point of the sea sends to the sensor, tabulated: a million draws need no spectra of their own.

A point of the sea that mirrors the Sun shows the band radiance

.. math:: F = \\frac{1}{\\pi\\epsilon^2} \\int R\\,\\tau\\,E\\,\\rho(\\omega)\\,d\\nu

behind the air. It is smooth in the wind (whose aerosol dims path and Sun), the sensor's height, the elevation of the view and the Sun's:
the logarithm of F at :math:`\\rho = 1` is interpolated by cubics in all of them, between the winds where the aerosol has kinks, and the
mean reflectance, whose spectrum of weights hardly changes, linearly as a Chebyshev series in the cosine of incidence.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Final, NamedTuple

import numpy as np

from seaglint._jit import kernel, njit
from seaglint.atmosphere.base import Atmosphere, slant_range
from seaglint.atmosphere.coordinates import elevation_of_coordinate
from seaglint.constants import EFFECTIVE_EARTH_RADIUS, SOLAR_ANGULAR_RADIUS
from seaglint.conventions import FloatArray
from seaglint.optics.band import Band
from seaglint.optics.fresnel import ReflectanceSeries
from seaglint.optics.sea_water import WaterIndex
from seaglint.radiance.article import ArticleAtmosphere, wavelength_mean
from seaglint.radiance.view import BandSum, sea_arc

AirAt = Callable[[str, float], Atmosphere]
"""Air of a model atmosphere at a wind [m/s]."""

WIND_KINKS: Final = (2.2852369587453123, 13.1166)
"""Winds where the Navy maritime aerosol of the tables has kinks [m/s]."""

_VIEWS: Final = 24
_SUNS: Final = 32
_TERMS: Final = 12
"""Nodes of the table and terms of the reflectance, whose rest is below 1e-5."""

_COARSE: Final = (4, 8, 12)
"""Winds, views and Suns of the mean reflectance."""

_SUN_SCALE: Final = 0.012
_HEIGHTS_PER_FOLD: Final = 3.0
_LEAST: Final = 1e-60


class MirroredLight(NamedTuple):
    """The table as kernels take it. Make it with :func:`mirrored_light`."""

    winds: FloatArray
    """Nodes [m/s, (winds,)]; four equal tables where the air knows no wind."""
    pieces: FloatArray
    """Places of the first node of every piece without a kink, and of the last node."""
    heights: FloatArray
    """Logarithms of sensor heights [(heights,)], one or at least four, even."""
    depression: tuple[float, float]
    """What is looked at [rad]."""
    values: FloatArray
    """Logarithm of radiance at reflectance 1 [W m-2 sr-1, (models, winds, heights, views, Suns)]."""
    coarse_winds: FloatArray
    shapes: FloatArray
    """Mean reflectance [(models, winds, views, Suns, terms)]."""


def mirrored_light(
    air_at: AirAt,
    models: Sequence[str],
    winds: tuple[float, float] | None,
    heights: tuple[float, float],
    depression: tuple[float, float],
    band: Band,
    water: WaterIndex,
    *,
    article: bool = False,
) -> MirroredLight:
    """Tabulate the light of the model atmospheres.

    Parameters
    ----------
    air_at : callable
        Air of a model at a wind.
    models : sequence of str
        Model atmospheres, in the order in which draws number them.
    winds : (float, float) or None
        Range [m/s]; None where the air knows no wind.
    heights : (float, float)
        Range of sensor heights [m].
    depression : (float, float)
        Range of depressions [rad]; those above the horizon are left out.
    band : Band
        Spectral response.
    water : WaterIndex
        The sea's.
    article : bool
        Multiply band means, as the source article does, instead of integrating their product per wavenumber.

    Raises
    ------
    DomainError
        Whatever the air refuses.
    """
    nodes, pieces = _wind_nodes(winds)
    levels = _levels(heights)
    coarse = np.linspace(0, nodes.size - 1, _COARSE[0]).round().astype(int) if winds is not None else np.zeros(1, dtype=int)
    suns = _sun_zeniths(_SUNS)
    few = (np.linspace(0.0, 1.0, _COARSE[1]), _sun_zeniths(_COARSE[2]))
    values = np.empty((len(models), nodes.size, levels.size, _VIEWS, _SUNS))
    shapes = np.empty((len(models), coarse.size, _COARSE[1], _COARSE[2], _TERMS))
    middle = float(np.exp(levels[levels.size // 2]))
    for m, model in enumerate(models):
        for w, wind in enumerate(nodes if winds is not None else nodes[:1]):
            sums = _Sums.of(air_at(model, float(wind)), band, water, article)
            for h, level in enumerate(np.exp(levels)):
                gamma = view_elevations(float(level), depression, np.linspace(0.0, 1.0, _VIEWS))
                values[m, w, h] = np.log(np.maximum(sums.whole(float(level), gamma, suns), _LEAST))
            if w in coarse:
                gamma = view_elevations(middle, depression, few[0])
                shapes[m, np.flatnonzero(coarse == w)[0]] = sums.reflectance(middle, gamma, few[1])
        if winds is None:
            values[m, 1:] = values[m, :1]
    if winds is None:
        coarse, shapes = np.array([0, nodes.size - 1]), np.repeat(shapes, 2, axis=1)
    return MirroredLight(nodes, pieces, levels, depression, values, nodes[coarse], shapes)


class _Sums(NamedTuple):
    """Band sums in one air."""

    air: Atmosphere
    over: BandSum
    series: FloatArray
    article: bool
    band: Band

    @classmethod
    def of(cls, air: Atmosphere, band: Band, water: WaterIndex, article: bool) -> _Sums:
        over = BandSum.of(band, air)
        return cls(air, over, ReflectanceSeries.of(water.index(over.wavenumber_cm)).coefficients[:_TERMS], article, band)

    def parts(self, height: float, gamma: FloatArray, zenith: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Transmittance times weight (views, n) and sunlight (Suns, n)."""
        seen = self.air.transmittance(height, sea_arc(height, gamma))[..., self.over.grid] * self.over.weights
        return seen, self.air.solar_irradiance(zenith)[..., self.over.grid]

    def whole(self, height: float, gamma: FloatArray, zenith: FloatArray) -> FloatArray:
        """Radiance at reflectance 1 [W m-2 sr-1, (views, Suns)]."""
        if self.article:
            fit = ArticleAtmosphere.fit(self.air, self.band, height, 288.15)
            slant = slant_range(height, sea_arc(height, gamma))
            return np.outer(fit.transmittance(slant), fit.sun(zenith)) / (np.pi * SOLAR_ANGULAR_RADIUS**2)
        seen, light = self.parts(height, gamma, zenith)
        return np.asarray(seen @ light.T) / (np.pi * SOLAR_ANGULAR_RADIUS**2)

    def reflectance(self, height: float, gamma: FloatArray, zenith: FloatArray) -> FloatArray:
        """Mean reflectance as a series [(views, Suns, terms)]."""
        if self.article:
            mean = self.series @ wavelength_mean(self.over.weights, self.over.wavenumber_cm)
            return np.broadcast_to(mean, (gamma.size, zenith.size, mean.size))
        seen, light = self.parts(height, gamma, zenith)
        sums = np.einsum("vn,sn,jn->vsj", seen, light, self.series, optimize=True)
        return np.asarray(sums / np.maximum(seen @ light.T, _LEAST)[..., None])


def _wind_nodes(winds: tuple[float, float] | None) -> tuple[FloatArray, FloatArray]:
    """Nodes and the places of the pieces' first nodes and of the last."""
    if winds is None:
        return np.arange(4.0), np.array([0.0, 3.0])
    low, high = winds
    edges = [low, *(k for k in WIND_KINKS if low + 0.5 < k < high - 0.5), max(high, low + 0.1)]
    counts = [max(math.ceil(2.0 + 4.0 * (b - a) / 5.0), 4) for a, b in zip(edges[:-1], edges[1:], strict=True)]
    parts = [np.linspace(a, b, n)[int(i > 0) :] for i, (a, b, n) in enumerate(zip(edges[:-1], edges[1:], counts, strict=True))]
    return np.concatenate(parts), np.concatenate([[0.0], np.cumsum(np.array(counts) - 1)]).astype(np.float64)


def _levels(heights: tuple[float, float]) -> FloatArray:
    low, high = (math.log(h) for h in heights)
    if high - low < 1e-9:
        return np.array([low])
    return np.linspace(low, high, max(math.ceil(1.0 + _HEIGHTS_PER_FOLD * (high - low)), 4))


def _sun_zeniths(count: int) -> FloatArray:
    """Zenith angles of the Sun's nodes, from the horizon up [rad]."""
    return np.asarray(0.5 * np.pi - np.clip(elevation_of_coordinate(np.linspace(0.0, 1.0, count), 0.0), 0.0, 0.5 * np.pi))


@kernel
def elevation_kernel(height: float, depression: float) -> float:
    """Elevation of the viewer above the horizontal at the sea point looked at [rad]; negative where the look misses the sea."""
    excess = height / EFFECTIVE_EARTH_RADIUS
    half = math.sin(0.5 * depression)
    square = half * half * (1.0 + excess) - 0.5 * excess
    return 2.0 * math.asin(math.sqrt(square)) if depression > 0.0 and square >= 0.0 else -1.0


@kernel
def view_range_kernel(height: float, low: float, high: float) -> tuple[float, float, float]:
    """Scale of the elevations, and coordinates ``arsinh(elevation/scale)`` of the first and last view, the horizon in place of the sky."""
    scale = math.acos(EFFECTIVE_EARTH_RADIUS / (EFFECTIVE_EARTH_RADIUS + height))
    first = math.asinh(max(elevation_kernel(height, low), 0.0) / scale)
    last = math.asinh(max(elevation_kernel(height, high), 0.0) / scale)
    return scale, first, max(last, first + 1e-3)


def view_elevations(height: float, depression: tuple[float, float], share: FloatArray) -> FloatArray:
    """Elevations of the viewer at shares 0 to 1 of the way between two depressions [rad]."""
    scale, first, last = view_range_kernel(float(height), float(depression[0]), float(depression[1]))
    return np.minimum(scale * np.sinh(first + share * (last - first)), 0.5 * np.pi)


@njit
def place_four(x: float, nodes: FloatArray, first: int, last: int, weights: FloatArray) -> int:
    """Weights of the cubic through four of the nodes ``first`` to ``last`` about ``x``; returns the first of the four."""
    i = first + 1
    while i < last - 2 and nodes[i + 1] <= x:
        i += 1
    start = min(max(i - 1, first), last - 3)
    for k in range(4):
        w = 1.0
        for j in range(4):
            if j != k:
                w *= (x - nodes[start + j]) / (nodes[start + k] - nodes[start + j])
        weights[k] = w
    return start


@njit
def place_even(x: float, count: int, weights: FloatArray) -> int:
    """The same for even nodes 0 to 1, ``x`` within them."""
    z = min(max(x, 0.0), 1.0) * (count - 1)
    start = min(max(int(z) - 1, 0), count - 4)
    f = z - start
    weights[0] = -(f - 1.0) * (f - 2.0) * (f - 3.0) / 6.0
    weights[1] = f * (f - 2.0) * (f - 3.0) / 2.0
    weights[2] = -f * (f - 1.0) * (f - 3.0) / 2.0
    weights[3] = f * (f - 1.0) * (f - 2.0) / 6.0
    return start


@njit
def place_wind(light: MirroredLight, wind: float, weights: FloatArray) -> int:
    """Weights over the winds; a wind beyond the nodes counts as the last one."""
    x = min(max(wind, light.winds[0]), light.winds[-1])
    piece = 0
    while piece < light.pieces.size - 2 and x > light.winds[int(light.pieces[piece + 1])]:
        piece += 1
    return place_four(x, light.winds, int(light.pieces[piece]), int(light.pieces[piece + 1]), weights)


@kernel
def sun_coordinate_kernel(up: float) -> float:
    """Coordinate 0 to 1 of a Sun whose sine of elevation is ``up``."""
    return math.asinh(math.asin(min(max(up, 0.0), 1.0)) / _SUN_SCALE) / math.asinh(0.5 * math.pi / _SUN_SCALE)


@njit
def light_of(
    light: MirroredLight, model: int, place: tuple[int, int, int, int], weights: FloatArray, cosine: float, coarse: tuple[float, float, float]
) -> float:
    """Radiance of a mirroring point [W m-2 sr-1].

    ``place`` and ``weights`` (4, 4): first nodes and weights of wind, height, view and Sun; ``cosine`` of incidence; ``coarse``: wind, view
    and Sun in nodes of the mean reflectance.
    """
    total = 0.0
    for h in range(min(light.values.shape[2], 4)):
        for w in range(4):
            part = 0.0
            for v in range(4):
                row = light.values[model, place[0] + w, place[1] + h, place[2] + v]
                s = place[3]
                part += weights[2, v] * (
                    weights[3, 0] * row[s] + weights[3, 1] * row[s + 1] + weights[3, 2] * row[s + 2] + weights[3, 3] * row[s + 3]
                )
            total += weights[1, h] * weights[0, w] * part
    shapes = light.shapes
    i, j, k = (min(int(coarse[0]), shapes.shape[1] - 2), min(int(coarse[1]), shapes.shape[2] - 2), min(int(coarse[2]), shapes.shape[3] - 2))
    f, g, e = coarse[0] - i, coarse[1] - j, coarse[2] - k
    x, b1, b2 = 2.0 * cosine - 1.0, 0.0, 0.0
    first = 0.0
    for n in range(shapes.shape[4] - 1, -1, -1):
        low = (1.0 - g) * ((1.0 - e) * shapes[model, i, j, k, n] + e * shapes[model, i, j, k + 1, n]) + g * (
            (1.0 - e) * shapes[model, i, j + 1, k, n] + e * shapes[model, i, j + 1, k + 1, n]
        )
        high = (1.0 - g) * ((1.0 - e) * shapes[model, i + 1, j, k, n] + e * shapes[model, i + 1, j, k + 1, n]) + g * (
            (1.0 - e) * shapes[model, i + 1, j + 1, k, n] + e * shapes[model, i + 1, j + 1, k + 1, n]
        )
        term = low + f * (high - low)
        if n == 0:
            first = term
        else:
            b1, b2 = term + 2.0 * x * b1 - b2, b1
    return math.exp(total) * (first + x * b1 - b2)
