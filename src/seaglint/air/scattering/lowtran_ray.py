"""Kernels of LOWTRAN7's rays: refraction through its levels, and sums of absorbers along the ray.

References
----------
LOWTRAN7's subroutines FILL, LAYER, RFPATH, DBLTX and TRANS; Kneizys, F. X., et al. (1988), Users Guide to LOWTRAN 7, AFGL-TR-88-0177.
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.base.jit import njit

AEROSOLS: Final = 4  #: Number of aerosol regions (boundary layer, troposphere, stratosphere, above), the first columns of the amounts.

MOLECULES: Final = 4  #: Column of the scattering molecules.

SELF: Final = 6
SELF_COLD: Final = 7  #: Columns of the water continuum at 296 K and of its share that is colder.

MOST_POINTS: Final = 400  #: Largest number of points of a line.

WORK_ROWS: Final = 6  #: Rows [(columns,)] of scratch space that the kernels need.

#: Quadrature nodes and weights along the ray, down to its tangent height.
_NODES, _WEIGHTS = (0.5 * (1.0 + np.polynomial.legendre.leggauss(4)[0]), 0.5 * np.polynomial.legendre.leggauss(4)[1])

#: Quadrature nodes and weights over the heights of a whole layer.
_HEIGHTS, _HEIGHT_WEIGHTS = (0.5 * (1.0 + np.polynomial.legendre.leggauss(5)[0]), 0.5 * np.polynomial.legendre.leggauss(5)[1])

#: Nodes and weights with which the densities of a whole layer are integrated, once.
_FINE, _FINE_WEIGHTS = (0.5 * (1.0 + np.polynomial.legendre.leggauss(12)[0]), 0.5 * np.polynomial.legendre.leggauss(12)[1])

#: Matrix from densities at the fine nodes to weights of a function's values at the nodes of a whole layer.
_TO_HEIGHTS = np.linalg.solve(np.vander(_HEIGHTS, increasing=True).T, np.vander(_FINE, 5, increasing=True).T).T * _FINE_WEIGHTS[:, None]

#: Largest thickness of a piece of a finely cut line above a height, and below it, where droplets grow with humidity [km, km, km].
_HUMID: Final = (5.0, 3.0, 0.25)

_STRAIGHT: Final = 2.5  #: Growth of the squared cosine of the zenith angle below which a layer is summed on its fixed heights.

_THIN: Final = 1e-4  #: Least thickness of LOWTRAN7's layers [km].

SHADE: Final = -1.0  #: Value for a ray that the Earth blocks.


class LayerGrid(NamedTuple):
    """Quadrature heights of every whole layer, for rays far from level there: the sums need no exponentials.

    ``invariant[l, g]``: ``n r`` there [km], and at the levels ``at_level[l]``; ``amount[l, g, k]``: weights of ``1/cos(zenith)`` for the
    amounts; ``bending[l, g]`` and ``turn[l, g]`` the weights of ``tan(zenith)`` for bending and for the angle at the Earth's centre.
    """

    at_level: np.ndarray
    invariant: np.ndarray
    amount: np.ndarray
    bending: np.ndarray
    turn: np.ndarray


class Laws(NamedTuple):
    """Data from which LOWTRAN7 computes transmittances, in its units: km, densities per km.

    ``density[k, l]``: scaled densities at the levels of four aerosols, molecules, then absorbers; ``humidity`` relative [%] and ``tops``
    the highest levels of the aerosol regions. ``linear[k, i]``: coefficients of the columns whose optical depth is proportional to the
    amount; ``scattering[k, i]`` the coefficients of the aerosols' scattering. ``segments[s] = (column, first, end)``: bands with optical
    depth ``coefficient W**power[s]`` in channels first...end, whose coefficients are listed one after another. ``grid`` follows from the
    levels.
    """

    earth_radius: float
    height: np.ndarray
    pressure: np.ndarray
    temperature: np.ndarray
    refractivity: np.ndarray
    density: np.ndarray
    humidity: np.ndarray
    tops: np.ndarray
    linear: np.ndarray
    scattering: np.ndarray
    segments: np.ndarray
    power: np.ndarray
    coefficient: np.ndarray
    grid: LayerGrid
    #: Thickness of the first piece of a line of sight [km]; further ones are as thick as they lie above or below it. 0: whole layers.
    finest: float
    cold_kelvin: float  #: Temperature of the law by which water's own continuum grows in cold air [K], 0 for LOWTRAN7's.


@njit
def _interpolated(a: float, b: float, fraction: float) -> float:
    """Interpolation as LOWTRAN7's EXPINT: exponential, linear next to a zero."""
    if a <= 0.0 or b <= 0.0:
        return a + (b - a) * fraction
    return float(a * (b / a) ** fraction)


@njit
def layer_of(laws: Laws, z: float) -> int:
    """Index of the layer whose lower level is at or below z, the upper above it."""
    i = int(np.searchsorted(laws.height, z, side="right")) - 1
    return min(max(i, 0), laws.height.size - 2)


@njit
def refractivity_at(laws: Laws, z: float) -> float:
    """Refractivity ``n - 1`` at a height [km]."""
    i = layer_of(laws, z)
    fraction = (z - laws.height[i]) / (laws.height[i + 1] - laws.height[i])
    low, high = laws.refractivity[i] + 1e-20, laws.refractivity[i + 1] + 1e-20
    return float(low * (high / low) ** fraction)


@njit
def invariant_of(laws: Laws, z: float, sine: float) -> float:
    """Snell's invariant ``n r sin(zenith)`` [km]."""
    return (1.0 + refractivity_at(laws, z)) * (laws.earth_radius + z) * sine


@njit
def tangent_height(laws: Laws, invariant: float, z: float) -> float:
    """Tangent height [km] of a descending ray from z; below 0 where it meets the sea."""
    if invariant < invariant_of(laws, 0.0, 1.0):
        return SHADE
    low, high = 0.0, z
    for _ in range(60):  # bisection to the last bit
        midpoint = 0.5 * (low + high)
        if invariant_of(laws, midpoint, 1.0) < invariant:
            low = midpoint
        else:
            high = midpoint
    return high


@njit
def _between_levels(laws: Laws, layer: int, fractions: tuple[float, float], low: np.ndarray, high: np.ndarray, growth: np.ndarray) -> None:
    """Compute densities at two parts of a layer, and the logarithm of their ratio, 0 where one of them is 0."""
    for k in range(low.size):
        a, b = laws.density[k, layer], laws.density[k, layer + 1]
        if a > 0.0 and b > 0.0:
            whole = math.log(b / a)
            growth[k] = (fractions[1] - fractions[0]) * whole
            low[k] = a * math.exp(fractions[0] * whole)
            high[k] = low[k] * math.exp(growth[k])
        else:
            low[k], high[k] = a + (b - a) * fractions[0], a + (b - a) * fractions[1]
            growth[k] = math.log(high[k] / low[k]) if low[k] > 0.0 and high[k] > 0.0 else 0.0


@njit
def _clear(row: np.ndarray) -> None:
    for k in range(row.size):  # written out: an assignment to the whole row takes seconds to compile
        row[k] = 0.0


@njit
def _cold(p1: float, p2: float, kelvin1: float, kelvin2: float, scale: float) -> float:
    """Share of the water continuum that counts as cold (260 K: all, 296 K: none) between two points of a layer.

    It follows ``exp(scale / T)``; with 0 it is linear, as in LOWTRAN7.
    """
    # mean pressure over mean density, both exponential between the points: the temperature weighted with density
    kelvin = kelvin1
    rho1, rho2 = p1 / kelvin1, p2 / kelvin2
    if abs(rho2 / rho1 - 1.0) > 1e-9 and abs(p2 / p1 - 1.0) > 1e-9:
        kelvin = (p1 - p2) / math.log(p1 / p2) / ((rho1 - rho2) / math.log(rho1 / rho2))
    if scale == 0.0:
        return min(max((296.0 - kelvin) / 36.0, 0.0), 1.0)
    return math.expm1(scale * (1.0 / kelvin - 1.0 / 296.0)) / math.expm1(scale * (1.0 / 260.0 - 1.0 / 296.0))


@njit
def layer_part(laws: Laws, z1: float, z2: float, invariant: float, work: np.ndarray, out: np.ndarray) -> tuple[float, float]:
    """Add the amounts between two heights of one layer to ``out`` [(columns,)]; return angle at the Earth's centre and bending [rad].

    With an ``out`` of no columns only the ray is followed.

    Quadrature along the parabola that the ray nearly is: the integrand stays smooth down to the height where the ray runs level.
    """
    re = laws.earth_radius
    layer = layer_of(laws, 0.5 * (z1 + z2))
    columns = out.size
    low, high = work[0, :columns], work[1, :columns]
    thick = laws.height[layer + 1] - laws.height[layer]
    _between_levels(laws, layer, ((z1 - laws.height[layer]) / thick, (z2 - laws.height[layer]) / thick), low, high, work[3])
    n_low, n_high = laws.refractivity[layer] + 1e-20, laws.refractivity[layer + 1] + 1e-20
    # refractivity falls exponentially across a layer
    fall = math.log(n_low / n_high) / thick
    n1 = n_low * math.exp(-fall * (z1 - laws.height[layer]))
    n2 = n_low * math.exp(-fall * (z2 - laws.height[layer]))
    sine1 = min(invariant / ((1.0 + n1) * (re + z1)), 1.0)
    sine2 = min(invariant / ((1.0 + n2) * (re + z2)), 1.0)
    cos1 = math.sqrt((1.0 - sine1) * (1.0 + sine1))
    # curvature of the ray relative to the Earth, with a floor for almost trapped rays
    curved = max(sine1 * sine1 - (re + z1) * fall * n1 / (1.0 + n1) * sine1 * sine1, 0.02) / (re + z1)
    dz = z2 - z1
    length = 2.0 * dz / (cos1 + math.sqrt(cos1 * cos1 + 2.0 * curved * dz))
    kelvin1 = laws.temperature[layer] + (laws.temperature[layer + 1] - laws.temperature[layer]) * (z1 - laws.height[layer]) / thick
    kelvin2 = laws.temperature[layer] + (laws.temperature[layer + 1] - laws.temperature[layer]) * (z2 - laws.height[layer]) / thick
    bending = 0.0
    sums = work[2]
    _clear(sums)
    for g in range(_NODES.size):
        s = length * _NODES[g]
        z = min(z1 + cos1 * s + 0.5 * curved * s * s, z2)
        n = n1 * math.exp(-fall * (z - z1))
        sine = invariant / ((1.0 + n) * (re + z))
        cosine = math.sqrt(max((1.0 - sine) * (1.0 + sine), 1e-300))
        # dz/ds of the parabola over the cosine of the real ray corrects the parabola's length
        weight = _WEIGHTS[g] * length * (cos1 + curved * s) / cosine
        fraction = (z - z1) / dz
        bending += weight * sine * fall * n / (1.0 + n)
        for k in range(columns):
            a, b = low[k], high[k]
            if a > 0.0 and b > 0.0:
                sums[k] += weight * a * math.exp(fraction * work[3, k])
            else:
                sums[k] += weight * (a + (b - a) * fraction)
    # Snell: the zenith angle changes by the angle at the Earth's centre less the bending
    turn = math.asin(sine1) - math.asin(sine2) + bending
    if columns == 0:
        return turn, bending
    # The layer's temperature, weighted with the density of air, determines how much of the continuum counts as cold.
    p1 = _interpolated(laws.pressure[layer], laws.pressure[layer + 1], (z1 - laws.height[layer]) / thick)
    p2 = _interpolated(laws.pressure[layer], laws.pressure[layer + 1], (z2 - laws.height[layer]) / thick)
    for k in range(columns):
        out[k] += sums[k]
    out[SELF_COLD] += sums[SELF] * _cold(p1, p2, kelvin1, kelvin2, laws.cold_kelvin)
    return turn, bending


@njit
def _layers(laws: Laws, first: int, last: int, invariant: float, work: np.ndarray, out: np.ndarray) -> tuple[float, float]:
    """Add ``layer_part`` of the layers first...last - 1 from level to level."""
    grid = laws.grid
    columns, nodes = out.size, grid.invariant.shape[1]
    turn, bending = 0.0, 0.0
    for layer in range(first, last):
        low, high = invariant / grid.at_level[layer], invariant / grid.at_level[layer + 1]
        # near level the squared cosine grows by a large factor within the layer, which fixed heights do not resolve
        if (1.0 - high * high) > _STRAIGHT * (1.0 - low * low):
            angles = layer_part(laws, laws.height[layer], laws.height[layer + 1], invariant, work, out)
            turn += angles[0]
            bending += angles[1]
            continue
        for g in range(nodes):
            # far from level: only the secant depends on the ray, all else was summed once
            sine = invariant / grid.invariant[layer, g]
            secant = 1.0 / math.sqrt((1.0 - sine) * (1.0 + sine))
            turn += grid.turn[layer, g] * sine * secant
            bending += grid.bending[layer, g] * sine * secant
            for k in range(columns):
                out[k] += secant * grid.amount[layer, g, k]
    return turn, bending


@njit
def rise(laws: Laws, low: float, high: float, invariant: float, work: np.ndarray, out: np.ndarray) -> tuple[float, float]:
    """Add ``layer_part`` of a ray between any two heights; parts of layers thinner than 0.1 m are omitted."""
    turn, bending = 0.0, 0.0
    first, last = layer_of(laws, low), layer_of(laws, high)
    if laws.height[first] < low:
        end = min(laws.height[first + 1], high)
        if end - low > _THIN:
            turn, bending = layer_part(laws, low, end, invariant, work, out)
        first += 1
    if high >= laws.height[last + 1]:
        last += 1
    if last > first:
        angles = _layers(laws, first, last, invariant, work, out)
        turn += angles[0]
        bending += angles[1]
    start = max(laws.height[last], low)
    if last >= first and high - start > _THIN:
        angles = layer_part(laws, start, high, invariant, work, out)
        turn += angles[0]
        bending += angles[1]
    return turn, bending


@njit
def sun_amounts(laws: Laws, z: float, zenith: float, work: np.ndarray, out: np.ndarray) -> float:
    """Compute amounts ``out`` [(columns,)] from a height [km] to the Sun at an apparent zenith angle [rad].

    The result is the bending [rad], -1 in the shade.
    """
    _clear(out)
    if z >= laws.height[-1]:
        return 0.0
    invariant = invariant_of(laws, z, math.sin(zenith))
    bending = 0.0
    if zenith > 0.5 * math.pi:
        lowest = tangent_height(laws, invariant, z)
        if lowest < 0.0:
            return SHADE
        # below the start the ray passes every layer twice, down to its tangent height and up again
        bending = 2.0 * rise(laws, lowest, z, invariant, work, out)[1]
        for k in range(out.size):
            out[k] *= 2.0
    return bending + rise(laws, z, laws.height[-1], invariant, work, out)[1]


@njit
def _copy(row: np.ndarray, out: np.ndarray) -> None:
    for k in range(row.size):
        out[k] = row[k]


class LevelCrossings(NamedTuple):
    """Points at which a line of sight crosses levels.

    ``height`` [km], ``zenith`` of the line's onward direction there, ``arc`` from the sensor [rad], ``level`` the index that LOWTRAN7
    takes the humidity from, ``amount[j]`` from the sensor to point j.
    """

    height: np.ndarray
    zenith: np.ndarray
    arc: np.ndarray
    level: np.ndarray
    amount: np.ndarray


@njit
def _rung(line: LevelCrossings, n: int, z: float, zenith: float, arc: float, level: int) -> None:
    line.height[n], line.zenith[n], line.arc[n], line.level[n] = z, zenith, arc, level


@njit
def zenith_at(laws: Laws, invariant: float, z: float) -> float:
    """Zenith angle of a rising ray at a height [rad]."""
    return math.asin(min(invariant / invariant_of(laws, z, 1.0), 1.0))


@njit
def trace(laws: Laws, z: float, zenith: float, line: LevelCrossings, work: np.ndarray) -> int:
    """Trace the line of sight from a height [km] at a zenith angle [rad] to the sea or to space; return the number of points."""
    invariant = invariant_of(laws, z, math.sin(zenith))
    amount = work[4]
    _clear(amount)
    n, arc = 0, 0.0
    start, first = z, 0
    descending = zenith > 0.5 * math.pi + 1e-12
    if descending:
        lowest = max(tangent_height(laws, invariant, z), 0.0)
        # Levels from the lowest point up, numbered as LOWTRAN7 does.
        below = 0
        for i in range(laws.height.size):
            below += 1 if lowest < laws.height[i] < z - 1e-4 else 0
        level = below + 1
        _rung(line, 0, z, zenith, 0.0, level)
        while start - lowest > 1e-9:
            i = layer_of(laws, start - 1e-9)
            end = max(laws.height[i], lowest)
            if laws.finest > 0.0:
                end = max(end, start - max(laws.finest, min(z - start, start - lowest, _HUMID[0] if start > _HUMID[1] else _HUMID[2])))
            if line.height[n] - end < 1e-4 and end > lowest:  # as LOWTRAN7, no pieces of less than 0.1 m
                start = end
                continue
            arc += rise(laws, end, start, invariant, work, amount)[0]
            n += 1
            level -= 1
            _rung(line, n, end, math.pi - zenith_at(laws, invariant, end), arc, level)
            _copy(amount, line.amount[n])
            start = end
        if invariant < invariant_of(laws, 0.0, 1.0):
            return n + 1
        line.zenith[n] = 0.5 * math.pi
        first = 0
    else:
        _rung(line, 0, z, zenith, 0.0, 0)
    level = first
    top, bottom = laws.height[-1], start
    while top - start > 1e-4:
        end = laws.height[layer_of(laws, start) + 1]
        if descending and start < z - 1e-4 and end > z:
            end = z
        if laws.finest > 0.0:
            end = min(end, start + max(laws.finest, min(start - bottom, _HUMID[0] if start > _HUMID[1] else _HUMID[2])))
        if end - start < 1e-4:
            start = end
            continue
        arc += rise(laws, start, end, invariant, work, amount)[0]
        n += 1
        level += 1
        _rung(line, n, end, zenith_at(laws, invariant, end), arc, level)
        _copy(amount, line.amount[n])
        start = end
    return n + 1


def layer_grid(earth_radius: float, height: FloatArray, refractivity: FloatArray, cold: FloatArray, density: FloatArray) -> LayerGrid:
    """Quadrature of whole layers.

    Heights [km, (levels,)], ``n - 1``, share of the water continuum that counts as cold [(layers,)], densities [(columns, levels)].
    """
    thick = np.diff(height)
    z = height[:-1, None] + thick[:, None] * _HEIGHTS
    n = refractivity + 1e-20
    fall = np.log(n[:-1] / n[1:]) / thick
    at_node = n[:-1, None] * np.exp(-fall[:, None] * (z - height[:-1, None]))
    amount = layer_amounts(thick, density)
    # every layer has one temperature, so its cold share is one factor
    amount[:, :, SELF_COLD] = amount[:, :, SELF] * cold[:, None]
    return LayerGrid(
        (1.0 + n) * (earth_radius + height),
        (1.0 + at_node) * (earth_radius + z),
        amount,
        _HEIGHT_WEIGHTS * thick[:, None] * fall[:, None] * at_node / (1.0 + at_node),
        _HEIGHT_WEIGHTS * thick[:, None] / (earth_radius + z),
    )


def layer_amounts(thick: FloatArray, density: FloatArray) -> FloatArray:
    """Weights [(layers, nodes, columns)] of a smooth function's values at the quadrature heights in its integral times the density."""
    a, b = density[:, :-1, None], density[:, 1:, None]
    exponential = (a > 0.0) & (b > 0.0)
    slope = np.log(np.where(exponential, b, 1.0) / np.where(exponential, a, 1.0))
    at_node = np.where(exponential, a * np.exp(slope * _FINE), a + (b - a) * _FINE)
    return np.ascontiguousarray(np.moveaxis(at_node @ _TO_HEIGHTS, 0, -1) * thick[:, None, None])


def layers_cold_share(pressure: FloatArray, temperature: FloatArray, cold_kelvin: float) -> FloatArray:
    """Share of the water continuum of every layer that counts as cold [1, (layers,)], by its density-weighted temperature [K]."""
    pairs = zip(_pairs(pressure), _pairs(temperature), strict=True)
    return np.array([_cold(float(p[0]), float(p[1]), float(t[0]), float(t[1]), cold_kelvin) for p, t in pairs])


def _pairs(values: FloatArray) -> FloatArray:
    return np.stack([values[:-1], values[1:]], axis=1)
