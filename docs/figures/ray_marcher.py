"""A slow, plain renderer of a sea of tiles, to check the fast one against: rays one by one, small steps, nothing shared with the sweep.

A ray goes in fixed small steps where it is near the water; higher up the step is what it can go without meeting a surface that is nowhere
steeper than the tiles' steepest slopes together. The crossing is then halved until it is known to a tenth of a millimetre. Heights and
slopes are read linearly from lattices of eight times as many points as the sweep's, which know nothing of its splines. The Earth is a
sphere of a given radius: the sea's coordinates are arcs along the ray's azimuth, its height is the distance from the sphere, and what a
facet does is worked out in the frame of its own vertical, which is turned against the Sun by the arc over the true radius: the given one
stands for refraction of the line of sight.

The facet: Gaussian unresolved slopes of a given covariance about the slope that is read, their visible area ``A+``, their own two-leg
shadowing, and where it is wanted the density of nested bands. The Sun's disc is sampled: one point of it for each ray, used for the
mirroring slope and for the ray that looks whether another wave is in the way.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from scipy.stats.qmc import Sobol

from seaglint.base.conventions import FloatArray
from seaglint.facet.legs import SMITHS, FacetLaw
from seaglint.sea.shadowing.nested import HIGHEST, LOWEST, nested_ratio
from seaglint.sea.shadowing.seen_and_lit import coupling_table, lit_exponent_kernel
from seaglint.sea.wave_field import WaveField

SUN_RADIUS = 4.65e-3
REFRACTION = 7.0 / 6.0
"""Radius of the sphere over that of the Earth."""

EARTH = REFRACTION * 6.371e6
FINER = 8
"""Points of a lattice for one of the sea's: linear reading of 32 on the shortest wave loses 1.3 % of its slope variance."""

SLOPE_END, EDGE_END, NODES = 6.5, 6.0, (481, 1041)
"""Nested table: edges 0 to EDGE_END in rows, slopes -SLOPE_END to SLOPE_END in columns, in rms slopes."""


class Sea(NamedTuple):
    """One instant: ``lattice`` (tiles, n, n, 3) of height and slopes, ``grid`` (tiles, 3) of spacing and cosine and sine of the turn,
    the highest sum of crests [m], the steepest sum of slopes [1], the shortest step [m] and the sphere's radius [m].
    """

    lattice: np.ndarray
    grid: np.ndarray
    crest: float
    steepest: float
    step: float
    radius: float


class Facets(NamedTuple):
    """Covariance of the slopes on the facets (east-east, east-north, north-north), logarithms of the nested tables, of one leg and of
    what two do together, empty for Smith, the share of the deviation that stands in the Sun's way, 1 but for less than one band, and the
    shelter that geometry gives: share of the square of a low Sun's elevation that does not count, the least that does, in deviations, and
    excess of facets seen and lit.
    """

    east_east: float
    east_north: float
    north_north: float
    nested: np.ndarray
    coupling: np.ndarray
    in_the_way: float
    shelter: tuple[float, float, float]


def sea_of(waves: WaveField, time: float = 0.0, *, part: float = 0.1, radius: float = EARTH) -> Sea:
    """The sea of a field; rays near the water step by a ``part`` of the finest lattice's spacing."""
    fine = waves.refined(FINER)
    lattice = np.stack([np.asarray(tile, dtype=np.float32) for tile in fine.surfaces(time)])
    grid = np.array([(t.spacing, math.cos(t.rotation), math.sin(t.rotation)) for t in fine.tiles])
    # The bilinear surface is as steep as its lattice's differences at most
    steepest = 0.0
    for z, tile in zip(lattice[..., 0].astype(float), fine.tiles, strict=True):
        u, v = (np.abs(np.roll(z, -1, axis) - z) for axis in (1, 0))
        both = np.hypot(np.maximum(u, np.roll(u, -1, 0)), np.maximum(v, np.roll(v, -1, 1)))
        steepest += float(both.max()) / tile.spacing
    crest = float(lattice[..., 0].max(axis=(1, 2)).sum())
    return Sea(lattice, grid, crest, steepest, part * min(t.spacing for t in waves.tiles), radius)


def facets_of(covariance: tuple[float, float, float], law: FacetLaw = SMITHS) -> Facets:
    """Roughness with the shadowing of a law: Smith's (1 band, with less deviation towards the Sun for fewer) or nested."""
    table, bands = np.zeros((0, 0)), max(law.bands, 1.0)
    if bands > 1.0:
        edge, slope = np.linspace(0.0, EDGE_END, NODES[0])[:, None], np.linspace(-SLOPE_END, SLOPE_END, NODES[1])
        table = np.log(np.maximum(nested_ratio(slope, np.arctan2(1.0, edge), 1.0, bands), 1e-300))
    return Facets(*covariance, table, coupling_table(bands, law.deviation), min(law.bands, 1.0), tuple(law.shelter))


@njit(cache=True)
def read(sea: Sea, part: int, x: float, y: float) -> float:
    """Sum over tiles of height (0), slope east (1) or north (2) at a point."""
    total = 0.0
    n = sea.lattice.shape[1]
    for t in range(sea.lattice.shape[0]):
        d, c, s = sea.grid[t, 0], sea.grid[t, 1], sea.grid[t, 2]
        u, v = (c * x + s * y) / d, (c * y - s * x) / d
        i, j = math.floor(u), math.floor(v)
        f, g = u - i, v - j
        i0, j0 = int(i) % n, int(j) % n
        i1, j1 = (i0 + 1) % n, (j0 + 1) % n
        total += (1.0 - g) * ((1.0 - f) * sea.lattice[t, j0, i0, part] + f * sea.lattice[t, j0, i1, part])
        total += g * ((1.0 - f) * sea.lattice[t, j1, i0, part] + f * sea.lattice[t, j1, i1, part])
    return total


@njit(cache=True)
def above(sea: Sea, x: float, y: float, z: float) -> tuple[float, float, float, float, float]:
    """Height over the sea, height over the sphere, the place in arcs east and north of the origin, and the angle of the arc."""
    rho = math.hypot(x, y)
    distance = math.hypot(rho, z + sea.radius)
    # z + (rho^2)/(2R) without the difference of large numbers
    altitude = (z * (z + 2.0 * sea.radius) + rho * rho) / (distance + sea.radius)
    angle = math.atan2(rho, z + sea.radius)
    k = sea.radius * angle / rho if rho > 0.0 else 1.0
    clear = altitude - sea.crest
    if clear < 2.0:
        clear = altitude - read(sea, 0, k * x, k * y)
    return clear, altitude, k * x, k * y, angle


@njit(cache=True)
def first_hit(sea: Sea, origin: tuple[float, float, float], direction: tuple[float, float, float], start: float, end: float) -> float:
    """Distance at which a ray from above first meets the sea after ``start`` [m]; -1 where it does not before ``end``."""
    ox, oy, oz = origin
    dx, dy, dz = direction
    before, t = start, start
    rounding = math.hypot(dx, dy) ** 2 / sea.radius
    while t < end:
        clear, altitude, _, _, _ = above(sea, ox + t * dx, oy + t * dy, oz + t * dz)
        if clear < 0.0:
            low, high = before, t
            while high - low > 1e-4:
                middle = 0.5 * (low + high)
                clear, _, _, _, _ = above(sea, ox + middle * dx, oy + middle * dy, oz + middle * dz)
                if clear < 0.0:
                    high = middle
                else:
                    low = middle
            return 0.5 * (low + high)
        rising = dz + t * rounding
        if altitude > sea.crest and rising > 0.0:
            return -1.0
        before = t
        t += max(sea.step, clear / (sea.steepest + abs(dz) + 1e-6))
    return -1.0


@njit(cache=True)
def visible_area(mean: float, deviation: float) -> float:
    """Mean of a normal variable where it is positive: A+."""
    if deviation <= 0.0:
        return max(mean, 0.0)
    t = mean / deviation
    return mean * 0.5 * math.erfc(-t / math.sqrt(2.0)) + deviation * math.exp(-0.5 * t * t) / math.sqrt(2.0 * math.pi)


@njit(cache=True)
def nested_density(table: np.ndarray, slope: float, edge: float) -> float:
    """Visible density over Smith's; both numbers in rms slopes."""
    if table.size == 0 or edge >= EDGE_END:
        return 1.0
    rows, columns = table.shape
    a = max(edge, 0.0) / EDGE_END * (rows - 1)
    b = (min(max(slope, -SLOPE_END), SLOPE_END) + SLOPE_END) / (2.0 * SLOPE_END) * (columns - 1)
    i, j = min(int(a), rows - 2), min(int(b), columns - 2)
    f, g = a - i, b - j
    low = (1.0 - g) * table[i, j] + g * table[i, j + 1]
    high = (1.0 - g) * table[i + 1, j] + g * table[i + 1, j + 1]
    return math.exp((1.0 - f) * low + f * high)


@njit(cache=True)
def facet_glint(
    facets: Facets, view: tuple[float, float, float], sun: tuple[float, float, float], slope: tuple[float, float]
) -> tuple[float, float]:
    """Glint factor ``q S (1+Lambda_v)/(4 cos^4 A+)`` [1/sr] of a facet and the cosine of incidence, directions (east, north, up)."""
    ee, en, nn = facets.east_east, facets.east_north, facets.north_north
    mx, my, mz = view[0] + sun[0], view[1] + sun[1], view[2] + sun[2]
    cosine = 0.5 * math.sqrt(mx * mx + my * my + mz * mz)
    if mz <= 0.0:
        return 0.0, cosine
    sx, sy = -mx / mz, -my / mz
    dx, dy = sx - slope[0], sy - slope[1]
    det = ee * nn - en * en
    q = math.exp(-0.5 * (nn * dx * dx - 2.0 * en * dx * dy + ee * dy * dy) / det) / (2.0 * math.pi * math.sqrt(det))
    view_deviation = math.sqrt(view[0] ** 2 * ee + 2.0 * view[0] * view[1] * en + view[1] ** 2 * nn)
    sun_deviation = facets.in_the_way * math.sqrt(sun[0] ** 2 * ee + 2.0 * sun[0] * sun[1] * en + sun[1] ** 2 * nn)
    view_mean = view[2] - view[0] * slope[0] - view[1] * slope[1]
    sun_mean = sun[2] - sun[0] * slope[0] - sun[1] * slope[1]
    area = visible_area(view_mean, view_deviation)
    if area < 1e-12 or sun_mean <= 0.0:
        return 0.0, cosine
    angle = abs(math.atan2(view[0] * sun[1] - view[1] * sun[0], view[0] * sun[0] + view[1] * sun[1]))
    # Heitz et al. 2014, passage between full correlation (same side) and none (opposite sides)
    passage = 4.41 * angle / (4.41 * angle + 1.0) * (4.41 * math.pi + 1.0) / (4.41 * math.pi)
    to_view = (view[0] * dx + view[1] * dy) / max(view_deviation, 1e-12)
    to_sun = (sun[0] * dx + sun[1] * dy) / max(sun_deviation, 1e-12)
    view_edge, sun_edge = view_mean / max(view_deviation, 1e-12), sun_mean / max(sun_deviation, 1e-12)
    seen = nested_density(facets.nested, to_view, view_edge)
    if sun_edge >= HIGHEST:
        both = seen
    else:
        slack, least, together = facets.shelter
        counts = 1.0 - slack / (1.0 + (sun_edge / 1.22) ** 2)
        sun_mean = math.hypot(math.sqrt(counts) * sun_mean, least * sun_deviation)
        sun_edge = sun_mean / sun_deviation
        lit, pair = nested_density(facets.nested, to_sun, sun_edge), 0.0
        if view_edge < HIGHEST:
            pair = lit_exponent_kernel(0.5 * (to_view - to_sun), view_edge, sun_edge, facets.coupling)
        # shares of the visible area: of the viewer's leg alone, of the Sun's, of independent legs
        upright = max(view_mean, 0.0) / area
        shadow = visible_area(sun_mean, sun_deviation) / sun_mean - 1.0
        one_side = min(seen, lit / max(upright * (1.0 + shadow), 1e-12))
        more = 1.0 + together / (max(view_edge, LOWEST) * max(sun_edge, LOWEST))
        apart = min(seen * lit * math.exp(pair) * more / (1.0 + upright * shadow), one_side)
        both = 1.0 / ((1.0 - passage) / one_side + passage / max(apart, 1e-300))
    return q * both * (1.0 + sx * sx + sy * sy) ** 2 / (4.0 * area), cosine


@njit(cache=True)
def turned(v: tuple[float, float, float], azimuth: float, angle: float) -> tuple[float, float, float]:
    """A vector in the frame of a place at an arc of ``angle`` along ``azimuth``; a negative angle turns back."""
    s, c = math.sin(azimuth), math.cos(azimuth)
    out, side = v[0] * s + v[1] * c, v[0] * c - v[1] * s
    new_out = out * math.cos(angle) - v[2] * math.sin(angle)
    up = out * math.sin(angle) + v[2] * math.cos(angle)
    return new_out * s + side * c, new_out * c - side * s, up


@njit(cache=True)
def trace(
    sea: Sea, facets: Facets, height: float, pixel: np.ndarray, sun: np.ndarray, shaded: bool, reflected: np.ndarray, points: np.ndarray
) -> np.ndarray:
    """Radiance of single rays through ``pixel = (azimuth, its width, elevation, its height)``.

    ``sun = (zenith, azimuth)`` at the sensor's foot; ``reflected`` is reflectance times irradiance on even cosines of incidence; ``points``
    (rays, 4) are places in the pixel and on the disc, each in 0-1.
    """
    out = np.zeros(points.shape[0])
    sz, cz, sa, ca = math.sin(sun[0]), math.cos(sun[0]), math.sin(sun[1]), math.cos(sun[1])
    for ray in range(points.shape[0]):
        azimuth = pixel[0] + pixel[1] * (points[ray, 0] - 0.5)
        elevation = pixel[2] + pixel[3] * (points[ray, 1] - 0.5)
        direction = (math.cos(elevation) * math.sin(azimuth), math.cos(elevation) * math.cos(azimuth), math.sin(elevation))
        t = first_hit(sea, (0.0, 0.0, height), direction, 0.0, 1e6)
        if t < 0.0:
            continue
        x, y, z = t * direction[0], t * direction[1], height + t * direction[2]
        _, _, east, north, angle = above(sea, x, y, z)
        away = (-direction[0], -direction[1], -direction[2])
        view = turned(away, azimuth, angle)
        r, turn = SUN_RADIUS * math.sqrt(points[ray, 2]), 2.0 * math.pi * points[ray, 3]
        a, b = r * math.cos(turn), r * math.sin(turn)
        lx, ly, lz = sz * sa - a * cz * sa + b * ca, sz * ca - a * cz * ca - b * sa, cz + a * sz
        norm = math.sqrt(lx * lx + ly * ly + lz * lz)
        light = turned((lx / norm, ly / norm, lz / norm), azimuth, REFRACTION * angle)
        factor, cosine = facet_glint(facets, view, light, (read(sea, 1, east, north), read(sea, 2, east, north)))
        if factor <= 0.0:
            continue
        if shaded:
            towards = turned(light, azimuth, -angle)
            if towards[2] < -0.1 or first_hit(sea, (x, y, z + 1e-3), towards, 0.0, 1e5) >= 0.0:
                continue
        k = min(cosine, 1.0) * (reflected.size - 1)
        i = min(int(k), reflected.size - 2)
        out[ray] = factor * ((1.0 - (k - i)) * reflected[i] + (k - i) * reflected[i + 1])
    return out


@njit(cache=True)
def visible_slopes(sea: Sea, depression: float, azimuth: float, places: np.ndarray) -> np.ndarray:
    """Slopes (rays, 2) where parallel rays meet a flat Earth's sea: ``depression`` and ``azimuth`` they go to, from over ``places`` [m]."""
    out = np.full((places.shape[0], 2), np.nan)
    direction = (math.cos(depression) * math.sin(azimuth), math.cos(depression) * math.cos(azimuth), -math.sin(depression))
    for ray in range(places.shape[0]):
        x, y = places[ray, 0], places[ray, 1]
        t = first_hit(sea, (x, y, sea.crest + 1e-3), direction, 0.0, 1e6)
        if t >= 0.0:
            x, y = x + t * direction[0], y + t * direction[1]
            out[ray, 0], out[ray, 1] = read(sea, 1, x, y), read(sea, 2, x, y)
    return out


def mean_radiance(
    sea: Sea,
    facets: Facets,
    height: float,
    pixel: tuple[float, float, float, float],
    sun: tuple[float, float],
    rays: int,
    *,
    reflected: FloatArray | None = None,
    shaded: bool = True,
    seed: int = 0,
) -> tuple[float, float]:
    """Mean radiance of a pixel and its standard error; without ``reflected`` the glint factor [1/sr]."""
    points = np.random.default_rng(seed).random((rays, 4))
    table = np.ones(2) if reflected is None else np.asarray(reflected, dtype=np.float64)
    found = trace(sea, facets, height, np.array(pixel), np.array(sun), shaded, table, points)
    return float(found.mean()), float(found.std() / math.sqrt(rays))


def evenly_sampled(
    sea: Sea,
    facets: Facets,
    height: float,
    pixel: tuple[float, float, float, float],
    sun: tuple[float, float],
    rays: int,
    *,
    reflected: FloatArray,
    sets: int = 8,
) -> tuple[float, float]:
    """:func:`mean_radiance` over ``sets`` scrambled Sobol sets of ``rays`` each, a power of 2, and its standard error from their scatter.

    Where waves are wide in the pixel the error falls nearly as one over the rays: twenty times fewer than points drawn one by one.
    """
    means = [
        trace(sea, facets, height, np.array(pixel), np.array(sun), True, reflected, Sobol(4, seed=seed).random(rays)).mean()
        for seed in range(sets)
    ]
    return float(np.mean(means)), float(np.std(means, ddof=1) / math.sqrt(sets))


def seen_over_model(
    sea: Sea,
    facets: Facets,
    total: tuple[float, float, float],
    depression: float,
    azimuth: float,
    sun_zeniths: FloatArray,
    places: FloatArray,
) -> FloatArray:
    """Mirroring slopes seen from ``depression`` looking towards ``azimuth`` with the Sun ahead, over Saunders' law, per Sun zenith.

    Parallel rays fall evenly over the level plane, so every ray stands for the same projected area. No wave shades the Sun and the Earth is
    flat, as in the definition of the ratio. ``total`` is the covariance of all slopes.

    Returns
    -------
    ndarray
        Per ray and Sun (rays, Suns): the means over rays are the ratios.
    """
    found = visible_slopes(sea, depression, azimuth, places)
    if not np.all(np.isfinite(found)):
        raise RuntimeError(f"{np.sum(~np.isfinite(found[:, 0]))} rays went under the sea")
    view = (-math.cos(depression) * math.sin(azimuth), -math.cos(depression) * math.cos(azimuth), math.sin(depression))
    whole = facets_of(total)
    out = np.empty((len(found), len(sun_zeniths)))
    for k, zenith in enumerate(sun_zeniths):
        sun = (math.sin(zenith) * math.sin(azimuth), math.sin(zenith) * math.cos(azimuth), math.cos(zenith))
        out[:, k] = _one_leg(facets, view, sun, found) / _one_leg(whole, view, sun, np.zeros((1, 2)))[0]
    return out


@njit(cache=True)
def _one_leg(facets: Facets, view: tuple[float, float, float], sun: tuple[float, float, float], slopes: np.ndarray) -> np.ndarray:
    """Visible density of the mirroring slope on facets, ``q(s* - s0)/A+`` [1]: no shadowing of the Sun's leg."""
    out = np.zeros(slopes.shape[0])
    ee, en, nn = facets.east_east, facets.east_north, facets.north_north
    mz = view[2] + sun[2]
    det = ee * nn - en * en
    deviation = math.sqrt(view[0] ** 2 * ee + 2.0 * view[0] * view[1] * en + view[1] ** 2 * nn)
    for i in range(slopes.shape[0]):
        dx, dy = -(view[0] + sun[0]) / mz - slopes[i, 0], -(view[1] + sun[1]) / mz - slopes[i, 1]
        mean = view[2] - view[0] * slopes[i, 0] - view[1] * slopes[i, 1]
        area = visible_area(mean, deviation)
        if area > 1e-12:
            q = math.exp(-0.5 * (nn * dx * dx - 2.0 * en * dx * dy + ee * dy * dy) / det)
            q *= nested_density(facets.nested, (view[0] * dx + view[1] * dy) / deviation, mean / deviation)
            out[i] = q / (2.0 * math.pi * math.sqrt(det) * area)
    return out
