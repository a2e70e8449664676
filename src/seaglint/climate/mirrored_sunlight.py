r"""Tables of the sunlight that a mirroring point of the sea sends to the sensor: a million draws need no separate spectra.

A point of the sea that mirrors the Sun shows the band radiance

.. math:: F = \frac{1}{\pi\epsilon^2} \int R\,\tau\,E\,\rho(\omega)\,d\nu

behind the air. It is smooth in the wind (whose aerosol dims path and Sun), the sensor's height, the elevation of the view and the Sun's:
the logarithm of F at :math:`\rho = 1` is interpolated by cubics in all of them, between the winds where the aerosol has kinks, and the
mean reflectance, whose spectrum of weights hardly changes, linearly as a Chebyshev series in the cosine of incidence.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from seaglint.air.coordinates import elevation_of_coordinate
from seaglint.air.protocol import Atmosphere, slant_range
from seaglint.base.constants import EFFECTIVE_EARTH_RADIUS, SOLAR_ANGULAR_RADIUS
from seaglint.base.conventions import FloatArray
from seaglint.base.jit import kernel, njit
from seaglint.facet.sea_view import BandSum, sea_arc
from seaglint.optics.band import Band
from seaglint.optics.fresnel import ReflectanceSeries
from seaglint.optics.sea_water import WaterIndex
from seaglint.radiance.article import ArticleAtmosphere, wavelength_mean

AirAt = Callable[[str, float], Atmosphere]  #: Function that returns the air of a model atmosphere at a wind [m/s].

_VIEWS: Final = 32  #: Numbers of nodes of views and Suns.
_SUNS: Final = 32
_TERMS: Final = 12  #: Number of terms of the reflectance; the rest is below 1e-5.

_COARSE: Final = (4, 6, 8, 12)  #: Numbers of winds, heights, views and Suns of the mean reflectance.

_SUN_SCALE: Final = 0.012  #: Elevation of the Sun below which its coordinate is about linear [rad].
_HEIGHTS_PER_UNIT: Final = 3.0  #: Number of nodes of height for each unit of their coordinate.
_LEAST: Final = 1e-60  #: Radiance in place of 0, whose logarithm does not exist [W m-2 sr-1].


class MirroredLight(NamedTuple):
    """Table of mirrored sunlight as kernels read it. Make it with ``mirrored_light``."""

    winds: FloatArray  #: Nodes of wind [m/s, (models, winds)]; four equal tables where the air does not depend on wind.
    pieces: FloatArray  #: Indices of the first node of every piece without a kink, and of the last node [(models, pieces + 1)].
    heights: FloatArray  #: Coordinates of sensor heights (``height_coordinate``) [(heights,)], one or at least four.
    height_pieces: FloatArray  #: Indices of the first node of every layer of air, and of the last node.
    depression: tuple[float, float]  #: Range of depressions that are evaluated [rad].
    #: Least depression of the nodes [rad]: that of the looks from one height, the horizon from many, whose nodes then vary smoothly.
    lowest: float
    values: FloatArray  #: Logarithm of radiance at reflectance 1 [W m-2 sr-1, (models, winds, heights, views, Suns)].
    coarse_winds: FloatArray  #: Nodes of the mean reflectance [m/s, (models, winds)].
    coarse_heights: FloatArray
    shapes: FloatArray  #: Mean reflectance [(models, winds, heights, views, Suns, terms)].


def mirrored_light(
    air_at: AirAt,
    models: Sequence[str],
    winds: tuple[float, float] | None,
    heights: tuple[float, float],
    depression: tuple[float, float],
    band: Band,
    water: WaterIndex,
    *,
    kinks: Sequence[Sequence[float]] = (),
    article: bool = False,
    ratios: Sequence[FloatArray | None] = (None,),
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
    kinks : sequence of sequences of float
        Winds at which the aerosol of each model atmosphere changes its law [m/s], in the order of ``models``; empty where it changes
        smoothly. No cubic is laid across them. Models may have different numbers of them.
    article : bool
        Multiply band means, as the source article does, instead of integrating their product per wavenumber.
    ratios : sequence of ndarray or None
        Other lights over sunlight above the air on the samples of the band [1, (n,)] (``BandSum``); None is sunlight. Model atmospheres
        are numbered with all lights of the first, then of the second, and so on.

    Raises
    ------
    DomainError
        Whatever the air refuses.
    """
    nodes, pieces = _wind_nodes(winds, kinks or [()] * len(models))
    levels, layers = _levels(heights)
    coarse, few_levels = _some(nodes.shape[1] if winds is not None else 1, _COARSE[0]), _some(levels.size, _COARSE[1])
    suns, few_suns = _sun_zeniths(_SUNS), _sun_zeniths(_COARSE[3])
    lights = len(ratios)
    values = np.empty((lights * len(models), nodes.shape[1], levels.size, _VIEWS, _SUNS))
    shapes = np.empty((lights * len(models), coarse.size, few_levels.size, _COARSE[2], few_suns.size, _TERMS))
    metres, covered = _heights_of(levels), (depression[0] if levels.size == 1 else 0.0, depression[1])
    for m, model in enumerate(models):
        for w, wind in enumerate(nodes[m] if winds is not None else nodes[m, :1]):
            sums = _Sums.of(air_at(model, float(wind)), band, water, article)
            for h, level in enumerate(metres.tolist()):
                gamma = view_elevations(level, covered, np.linspace(0.0, 1.0, _VIEWS))
                for k, whole in enumerate(sums.whole(level, gamma, suns, ratios)):
                    values[lights * m + k, w, h] = np.log(np.maximum(whole, _LEAST))
                if w in coarse and h in few_levels:
                    gamma = view_elevations(level, covered, np.linspace(0.0, 1.0, _COARSE[2]))
                    at = np.flatnonzero(coarse == w)[0], np.flatnonzero(few_levels == h)[0]
                    for k, mean in enumerate(sums.reflectance(level, gamma, few_suns, ratios)):
                        shapes[lights * m + k, at[0], at[1]] = mean
    if winds is None:
        # The cubic in the wind needs four nodes: without wind they are equal.
        values[:, 1:] = values[:, :1]
    nodes, pieces = (np.repeat(of_models, lights, axis=0) for of_models in (nodes, pieces))
    if winds is None:
        coarse, shapes = np.array([0, nodes.shape[1] - 1]), np.repeat(shapes, 2, axis=1)
    few_heights = levels[few_levels]
    if levels.size == 1:
        # Linear interpolation needs a second node, equal to the first.
        few_heights, shapes = levels[0] + np.array([0.0, 1.0]), np.repeat(shapes, 2, axis=2)
    return MirroredLight(
        winds=nodes,
        pieces=pieces,
        heights=levels,
        height_pieces=layers,
        depression=depression,
        lowest=covered[0],
        values=values,
        coarse_winds=nodes[:, coarse],
        coarse_heights=few_heights,
        shapes=shapes,
    )


def _some(count: int, most: int) -> NDArray[np.intp]:
    """Indices of at most so many of some nodes, both ends among them."""
    return np.unique(np.linspace(0, count - 1, min(count, most)).round().astype(np.intp))


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

    def whole(self, height: float, gamma: FloatArray, zenith: FloatArray, ratios: Sequence[FloatArray | None]) -> list[FloatArray]:
        """Radiance at reflectance 1 of every light [W m-2 sr-1, (views, Suns)]."""
        if self.article:
            fit = ArticleAtmosphere.fit(self.air, self.band, height, 288.15)
            slant = slant_range(height, sea_arc(height, gamma))
            return [np.outer(fit.transmittance(slant), fit.sun(zenith)) / (np.pi * SOLAR_ANGULAR_RADIUS**2)]
        seen, light = self.parts(height, gamma, zenith)
        return [np.asarray(seen @ each.T) / (np.pi * SOLAR_ANGULAR_RADIUS**2) for each in _lights(light, ratios)]

    def reflectance(self, height: float, gamma: FloatArray, zenith: FloatArray, ratios: Sequence[FloatArray | None]) -> list[FloatArray]:
        """Mean reflectance of every light as a series [(views, Suns, terms)]."""
        if self.article:
            mean = self.series @ wavelength_mean(self.over.weights, self.over.wavenumber_cm)
            return [np.broadcast_to(mean, (gamma.size, zenith.size, mean.size))]
        seen, light = self.parts(height, gamma, zenith)
        means = []
        for each in _lights(light, ratios):
            sums = np.einsum("vn,sn,jn->vsj", seen, each, self.series, optimize=True)
            means.append(np.asarray(sums / np.maximum(seen @ each.T, _LEAST)[..., None]))
        return means


def _lights(sunlight: FloatArray, ratios: Sequence[FloatArray | None]) -> list[FloatArray]:
    """Return sunlight (Suns, n) as the light of every ratio."""
    return [sunlight if ratio is None else sunlight * ratio for ratio in ratios]


def _wind_nodes(winds: tuple[float, float] | None, kinks: Sequence[Sequence[float]]) -> tuple[FloatArray, FloatArray]:
    """Return nodes of wind [(models, winds)] and the indices of the pieces' first nodes and of the last [(models, pieces + 1)].

    All models have as many pieces, and as many nodes in each, as the model that needs most: a model with fewer kinks is cut at the kinks of
    another one, which costs nodes and no accuracy.
    """
    if winds is None:
        return np.tile(np.arange(4.0), (len(kinks), 1)), np.tile([0.0, 3.0], (len(kinks), 1))
    low, high = winds
    inside = [[k for k in own if low + 0.5 < k < high - 0.5] for own in kinks]
    most = max(inside, key=len)
    edges = [[low, *own, *most[len(own) :], max(high, low + 0.1)] for own in inside]
    longest = [max(b - a for a, b in ends) for ends in zip(*map(itertools.pairwise, edges), strict=True)]
    counts = [max(math.ceil(2.0 + 4.0 * length / 5.0), 4) for length in longest]
    nodes, pieces = zip(*(_pieces(own, counts) for own in edges), strict=True)
    return np.stack(nodes), np.stack(pieces)


def height_coordinate(height: ArrayLike) -> FloatArray:
    """Coordinate of heights [m] for cubics [1]: logarithmic to 1 km, above it the root of the share of LOWTRAN7's layers of 1 km.

    >>> height_coordinate([1000.0, 2250.0]).tolist()
    [0.0, 1.5]
    """
    h = np.asarray(height, dtype=np.float64)
    # The logarithm up to 1 km; above, one unit for each layer of 1 km.
    layer = np.floor(np.maximum(h, 1e3) / 1e3) - 1.0
    part = np.maximum(h - 1e3 * (layer + 1.0), 0.0) / 1e3
    return np.asarray(np.where(h <= 1e3, np.log(np.minimum(h, 1e3) / 1e3), layer + np.sqrt(part)))


def _heights_of(coordinate: FloatArray) -> FloatArray:
    """Inverse of ``height_coordinate``."""
    layer = np.floor(np.maximum(coordinate, 0.0))
    above = 1e3 * (layer + 1.0 + np.maximum(coordinate - layer, 0.0) ** 2)
    return np.asarray(np.where(coordinate <= 0.0, 1e3 * np.exp(np.minimum(coordinate, 0.0)), above))


def _levels(heights: tuple[float, float]) -> tuple[FloatArray, FloatArray]:
    """Coordinates of the nodes and the indices of the layers' first nodes and of the last."""
    low, high = (float(height_coordinate(h)) for h in heights)
    if high - low < 1e-9:
        return np.array([low]), np.array([0.0, 0.0])
    edges = [low, *(k for k in np.arange(9.0) if low + 1e-3 < k < high - 1e-3), high]
    return _pieces(edges, [max(math.ceil(1.0 + _HEIGHTS_PER_UNIT * (b - a)), 4) for a, b in itertools.pairwise(edges)])


def _pieces(edges: list[float], counts: list[int]) -> tuple[FloatArray, FloatArray]:
    """Even nodes between edges, and the indices of the edges among them."""
    parts = [np.linspace(a, b, n)[int(i > 0) :] for i, ((a, b), n) in enumerate(zip(itertools.pairwise(edges), counts, strict=True))]
    return np.concatenate(parts), np.concatenate([[0.0], np.cumsum(np.array(counts) - 1)]).astype(np.float64)


def _sun_zeniths(count: int) -> FloatArray:
    """Zenith angles of the Sun's nodes, from the horizon up [rad]."""
    return np.asarray(0.5 * np.pi - np.clip(elevation_of_coordinate(np.linspace(0.0, 1.0, count), 0.0), 0.0, 0.5 * np.pi))


@kernel
def elevation_kernel(height: float, depression: float) -> float:
    """Elevation of the viewer above the horizontal at the sea point in view [rad]; negative where the look misses the sea."""
    excess = height / EFFECTIVE_EARTH_RADIUS
    half = math.sin(0.5 * depression)
    # By half angles, which keep the digits near the horizon.
    square = half * half * (1.0 + excess) - 0.5 * excess
    return 2.0 * math.asin(math.sqrt(square)) if depression > 0.0 and square >= 0.0 else -1.0


@kernel
def view_range_kernel(height: float, low: float, high: float) -> tuple[float, float, float]:
    """Scale of the elevations, and coordinates ``arsinh(elevation/scale)`` of the first and last view.

    The sky is replaced by the horizon.
    """
    scale = math.acos(EFFECTIVE_EARTH_RADIUS / (EFFECTIVE_EARTH_RADIUS + height))
    first = math.asinh(max(elevation_kernel(height, low), 0.0) / scale)
    return scale, first, max(math.asinh(max(elevation_kernel(height, high), 0.0) / scale), first + 1e-3)


def view_elevations(height: float, depression: tuple[float, float], share: FloatArray) -> FloatArray:
    """Elevations of the viewer at shares 0 to 1 of the interval between two depressions [rad]."""
    scale, first, last = view_range_kernel(float(height), float(depression[0]), float(depression[1]))
    return np.minimum(scale * np.sinh(first + share * (last - first)), 0.5 * np.pi)


@njit
def place_four(x: float, nodes: FloatArray, first: int, last: int, weights: FloatArray) -> int:
    """Weights of the cubic through four of the nodes ``first`` to ``last`` about ``x``; returns the first of the four."""
    i = first + 1
    while i < last - 2 and nodes[i + 1] <= x:
        i += 1
    # Four nodes about x, all of its own piece.
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
    """Weights of the cubic through four of even nodes 0 to 1 about ``x``, which lies within them; returns the first of the four."""
    z = min(max(x, 0.0), 1.0) * (count - 1)
    start = min(max(int(z) - 1, 0), count - 4)
    f = z - start
    # Weights of Lagrange for four even nodes, f steps from the first.
    weights[0] = -(f - 1.0) * (f - 2.0) * (f - 3.0) / 6.0
    weights[1] = f * (f - 2.0) * (f - 3.0) / 2.0
    weights[2] = -f * (f - 1.0) * (f - 3.0) / 2.0
    weights[3] = f * (f - 1.0) * (f - 2.0) / 6.0
    return start


@njit
def place_in_pieces(x: float, nodes: FloatArray, pieces: FloatArray, weights: FloatArray) -> int:
    """Weights of the four nodes about ``x`` in its piece; returns the first. Beyond the nodes the nearest one is used."""
    if nodes.size == 1:
        weights[0] = 1.0
        return 0
    inside = min(max(x, nodes[0]), nodes[-1])
    piece = 0
    while piece < pieces.size - 2 and inside > nodes[int(pieces[piece + 1])]:
        piece += 1
    return place_four(inside, nodes, int(pieces[piece]), int(pieces[piece + 1]), weights)


@kernel
def sun_coordinate_kernel(up: float) -> float:
    """Coordinate 0 to 1 of a Sun whose sine of elevation is ``up``."""
    return math.asinh(math.asin(min(max(up, 0.0), 1.0)) / _SUN_SCALE) / math.asinh(0.5 * math.pi / _SUN_SCALE)


@kernel
def between_kernel(x: float, nodes: FloatArray) -> float:
    """Coordinate of ``x`` among ascending nodes, in nodes; beyond them the nearest is used."""
    inside = min(max(x, nodes[0]), nodes[-1])
    i = 0
    while i < nodes.size - 2 and inside > nodes[i + 1]:
        i += 1
    return float(i + (inside - nodes[i]) / (nodes[i + 1] - nodes[i]))


@njit
def light_of(
    light: MirroredLight,
    model: int,
    place: tuple[int, int, int, int],
    weights: FloatArray,
    cosine: float,
    coarse: tuple[float, float, float, float],
) -> float:
    """Radiance of a mirroring point [W m-2 sr-1].

    ``place`` and ``weights`` (4, 4): first nodes and weights of wind, height, view and Sun; ``cosine`` of incidence; ``coarse``: wind,
    height, view and Sun in nodes of the mean reflectance.
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
    i, j = min(int(coarse[0]), shapes.shape[1] - 2), min(int(coarse[1]), shapes.shape[2] - 2)
    k, m = min(int(coarse[2]), shapes.shape[3] - 2), min(int(coarse[3]), shapes.shape[4] - 2)
    f, g, e, d = coarse[0] - i, coarse[1] - j, coarse[2] - k, coarse[3] - m
    # Clenshaw's sum of the Chebyshev series in the cosine of incidence, mapped to -1 ... 1; each term is linear between coarse nodes.
    x, b1, b2 = 2.0 * cosine - 1.0, 0.0, 0.0
    first = 0.0
    for n in range(shapes.shape[5] - 1, -1, -1):
        term = 0.0
        for p in range(2):
            for q in range(2):
                here = shapes[model, i + p, j + q]
                low = (1.0 - d) * here[k, m, n] + d * here[k, m + 1, n]
                high = (1.0 - d) * here[k + 1, m, n] + d * here[k + 1, m + 1, n]
                term += (f if p == 1 else 1.0 - f) * (g if q == 1 else 1.0 - g) * ((1.0 - e) * low + e * high)
        if n == 0:
            first = term
        else:
            b1, b2 = term + 2.0 * x * b1 - b2, b1
    return float(math.exp(total) * (first + x * b1 - b2))
