"""Direct ray walk: rays followed to the sea one by one, where azimuth says nothing (near nadir) and the sweep does not serve.

A ray at height ``f`` above the sea below it cannot meet the sea before ``f / (fall + L run)``, with ``fall`` and ``run`` what it goes down
and outwards per metre and ``L`` the steepest slope of the sea: steps of that length never pass through a crest, and get the closer the
shorter they are. Steep rays arrive in a few steps, a vertical one in two.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

from seaglint._jit import kernel, njit, njit_parallel
from seaglint.constants import EFFECTIVE_EARTH_RADIUS, SOLAR_ANGULAR_RADIUS
from seaglint.conventions import FloatArray, horizon_depression, horizon_range, surface_range, view_zenith_of_range
from seaglint.radiance.glint import visible_sun
from seaglint.radiance.mean import SeaView, band_grid
from seaglint.render.facet import (
    DiscLine,
    FacetOptics,
    FacetTables,
    Roughness,
    Sunlight,
    facet_sunlight,
    facet_thermal,
    line_of_sight,
    no_disc_line,
    node,
    roughness_of,
    sun_terms,
    sunlight,
    thermal_axes,
    thermal_line,
    thermal_sources,
    thermal_table,
)
from seaglint.render.path_basis import TOGETHER, fewest_terms, path_basis
from seaglint.render.shade import FARTHEST, disc_share
from seaglint.sea.slopes import SlopeStatistics

PATH_NODES = 2048
"""Arcs at which the path is known, uniform in log(1 + arc/height): a step changes the transmittance by less than 1e-3."""

SKY_ROWS = 1025
"""Elevations of the sky table, uniform in the square root of the elevation above the horizon."""

SAMPLES = (2, 8)
"""Least and most rays along each side of a pixel; between them, as many as put four on the shortest wave."""

CALM_SAMPLES = 4
"""The same where no waves are resolved."""

CLOSE = 1e-3
"""Height above the sea at which a ray has arrived, in lattice spacings."""

MOST_STEPS = 200_000
"""Steps after which a ray is given up; only rays that skim the sea for tens of kilometres need thousands."""


class Air(NamedTuple):
    """Path by arc and sky by elevation, from one height: ``coefficients, sun_coefficients, path`` at the arcs ``scale (e^(i/parts) - 1)``;
    ``sky`` at the elevations ``i^2/sky_parts^2 - dip``.
    """

    scale: float
    parts: float
    coefficients: np.ndarray
    sun_coefficients: np.ndarray
    path: np.ndarray
    sky: np.ndarray
    dip: float
    sky_parts: float


class Lattices(NamedTuple):
    """One instant of the sea as rays read it, every lattice in full detail.

    ``points[first + iy n + ix] = (height, slope east, slope north)`` with ``part[i] = (first, n)`` and ``grid[i] = (1/spacing, cos, sin of
    the turn)`` of lattice ``i``. ``crest``: bound of the height [m]; ``steepest``: of the slope [1]; ``spacing``: the finest [m].
    """

    points: np.ndarray
    part: np.ndarray
    grid: np.ndarray
    crest: float
    steepest: float
    spacing: float


class Eye(NamedTuple):
    """Where the rays begin [m]."""

    east: float
    north: float
    height: float


def lattices_of(tiles: tuple[NDArray[np.float32], ...], spacing: FloatArray, turn: FloatArray) -> Lattices:
    """Bundle the tiles of one instant, each ``(n, n, 3)`` of height and slopes, ``spacing`` [m] apart and turned from east [rad].

    Heights are read bilinearly, so their differences bound the slope of what rays meet. No tiles are a calm sea.
    """
    crest, steepest, first = 0.0, 0.0, 0
    part = np.zeros((len(tiles), 2), np.int64)
    for i, (tile, d) in enumerate(zip(tiles, spacing, strict=True)):
        z = tile[..., 0]
        crest += float(z.max())
        steepest += math.hypot(*(float(np.abs(z - np.roll(z, 1, axis)).max()) / float(d) for axis in (0, 1)))
        part[i] = first, tile.shape[0]
        first += tile.shape[0] ** 2
    points = np.concatenate([tile.reshape(-1, 3) for tile in tiles]) if tiles else np.zeros((0, 3), np.float32)
    grid = np.stack([1.0 / spacing, np.cos(turn), np.sin(turn)], axis=1)
    return Lattices(points, part, grid, crest, steepest, float(spacing.min()) if tiles else 1.0)


@kernel
def read(sea: Lattices, x: float, y: float, first: int, values: np.ndarray) -> None:
    """Bilinear height (0) or slopes (1, 2) at a point into ``values``, from the kind ``first`` on."""
    values[:] = 0.0
    for i in range(sea.part.shape[0]):
        u = (sea.grid[i, 1] * x + sea.grid[i, 2] * y) * sea.grid[i, 0]
        v = (sea.grid[i, 1] * y - sea.grid[i, 2] * x) * sea.grid[i, 0]
        lower_u, lower_v = math.floor(u), math.floor(v)
        fu, fv = u - lower_u, v - lower_v
        begin, n = sea.part[i, 0], sea.part[i, 1]
        x0, y0 = int(lower_u) % n, int(lower_v) % n
        x1, y1 = (x0 + 1) % n, (y0 + 1) % n
        a, b, c, d = begin + y0 * n + x0, begin + y0 * n + x1, begin + y1 * n + x0, begin + y1 * n + x1
        for k in range(values.shape[0]):
            low = sea.points[a, first + k] + fu * (sea.points[b, first + k] - sea.points[a, first + k])
            high = sea.points[c, first + k] + fu * (sea.points[d, first + k] - sea.points[c, first + k])
            values[k] += low + fv * (high - low)


@kernel
def above_sphere(height: float, run: float, rise: float, s: float) -> tuple[float, float, float]:
    """Height over the mean sea, arc [m] and rise per metre of a ray at a distance ``s``; ``run`` and ``rise`` make its unit vector."""
    up, out = height + s * rise, s * run
    rho = math.sqrt((EFFECTIVE_EARTH_RADIUS + up) ** 2 + out * out)
    z = (2.0 * EFFECTIVE_EARTH_RADIUS * up + up * up + out * out) / (rho + EFFECTIVE_EARTH_RADIUS)
    return (
        z,
        EFFECTIVE_EARTH_RADIUS * math.atan2(out, EFFECTIVE_EARTH_RADIUS + up),
        (rise * (EFFECTIVE_EARTH_RADIUS + up) + run * out) / rho,
    )


@kernel
def meet(sea: Lattices, eye: Eye, heading: tuple[float, float], run: float, rise: float, height: np.ndarray) -> float:
    """Distance at which a ray meets the sea [m], -1 where it does not.

    ``heading`` is its horizontal unit vector (east, north), ``run`` and ``rise`` make the unit vector; ``height`` (1,) is a buffer.
    """
    s = 0.0
    if eye.height > sea.crest:
        if rise >= 0.0:
            return -1.0
        s = (eye.height - sea.crest) / -rise  # above the round sea by more than a crest until here
    before, gap_before = s, 0.0
    for step in range(MOST_STEPS):
        z, arc, climb = above_sphere(eye.height, run, rise, s)
        if climb >= 0.0 and z > sea.crest:
            return -1.0
        read(sea, eye.east + arc * heading[0], eye.north + arc * heading[1], 0, height)
        gap = z - height[0]
        if gap < 0.0:
            return before + (s - before) * gap_before / (gap_before - gap) if step > 0 else s
        if gap <= CLOSE * sea.spacing:
            return s
        before, gap_before = s, gap
        s += max(gap / max(sea.steepest * run - climb, 1e-9), 0.02 * sea.spacing)
    return -1.0


@kernel
def sun_share(sea: Lattices, east: float, north: float, sun: Sunlight, height: np.ndarray) -> float:
    """Share of the solar disc seen from a point of the sea over the waves towards it, as the sweep has it, in steps of the spacing."""
    read(sea, east, north, 0, height)
    own, low, skyline = height[0], max(sun.lower_tangent, 1e-4), -1.0
    for n in range(1, int(min((sea.crest - own) / (low * sea.spacing), float(FARTHEST))) + 1):
        d = n * sea.spacing
        read(sea, east + d * sun.horizontal_east, north + d * sun.horizontal_north, 0, height)
        skyline = max(skyline, (height[0] - own) / d)
        if skyline >= sun.upper_tangent:
            return 0.0
    return 1.0 if skyline <= low else disc_share((sun.elevation - math.atan(skyline)) / SOLAR_ANGULAR_RADIUS)


@njit
def ray(
    sea: Lattices,
    eye: Eye,
    optics: FacetOptics,
    disc: DiscLine,
    thermal: np.ndarray,
    air: Air,
    direction: np.ndarray,
    values: np.ndarray,
) -> tuple[float, float]:
    """Radiance and its solar part along a unit vector (east, north, up) [W m-2 sr-1].

    ``disc`` is that of single rays; ``thermal`` the table, azimuth first; ``values`` (3,) a buffer.
    """
    rise = direction[2]
    run = math.sqrt(direction[0] * direction[0] + direction[1] * direction[1])
    azimuth = math.atan2(direction[0], direction[1])
    s = meet(sea, eye, (math.sin(azimuth), math.cos(azimuth)), run, rise, values[:1])
    if s < 0.0:
        at = math.sqrt(max(math.atan2(rise, run) + air.dip, 0.0)) * air.sky_parts
        i = min(int(at), air.sky.shape[0] - 2)
        f = min(at - i, 1.0)
        return (1.0 - f) * air.sky[i] + f * air.sky[i + 1], 0.0
    _, arc, climb = above_sphere(eye.height, run, rise, s)
    # the table's azimuths ascend from its first, not wrapped
    first = optics.tables.axes[1, 0]
    azimuth = first + (azimuth - first) % (2.0 * math.pi)
    sight = line_of_sight(optics, azimuth)
    read(sea, eye.east - arc * sight.east, eye.north - arc * sight.north, 1, values[:2])
    slope = (values[0], values[1])
    sine = min(max(-climb, 0.0), 1.0)
    grazing = (sine, math.sqrt(1.0 - sine * sine))
    i = min(int(math.log(1.0 + arc / air.scale) * air.parts + 0.5), air.path.shape[0] - 1)
    axes = optics.tables.axes
    ix, fx = node(axes, 1, thermal.shape[0], azimuth)
    warm = facet_thermal(axes, thermal_line(thermal[ix]), air.coefficients, (i, 0.0), sight, sine, slope)
    if fx > 1e-9:
        warm += fx * (facet_thermal(axes, thermal_line(thermal[ix + 1]), air.coefficients, (i, 0.0), sight, sine, slope) - warm)
    solar, _ = facet_sunlight(optics, disc, air.sun_coefficients, (i, 0.0), sight, grazing, slope)
    if solar > 0.0 and sea.steepest > optics.sunlight.lower_tangent:
        solar *= sun_share(sea, eye.east - arc * sight.east, eye.north - arc * sight.north, optics.sunlight, values[:1])
    return warm + air.path[i] + solar, solar


@njit_parallel
def walk_pixels(
    sea: Lattices,
    eye: Eye,
    sunlight: Sunlight,
    roughness: Roughness,
    tables: FacetTables,
    thermal: np.ndarray,
    air: Air,
    corner: np.ndarray,
    pixels: np.ndarray,
    samples: np.ndarray,
    out: np.ndarray,
) -> None:
    """Mean radiance and its solar part of pixels (flat indices) into ``out`` (2, all pixels), from ``samples`` rays along each side."""
    columns = corner.shape[1] - 1
    for p in numba.prange(pixels.shape[0]):
        optics = FacetOptics(sunlight, roughness, tables)
        direction, values, disc = np.empty(3), np.empty(3), no_disc_line()
        row, column = pixels[p] // columns, pixels[p] % columns
        n = samples[p]
        total, solar = 0.0, 0.0
        for part in range(n * n):
            f, g = (part // n + 0.5) / n, (part % n + 0.5) / n
            norm = 0.0
            for k in range(3):
                upper = (1.0 - g) * corner[row, column, k] + g * corner[row, column + 1, k]
                lower = (1.0 - g) * corner[row + 1, column, k] + g * corner[row + 1, column + 1, k]
                direction[k] = (1.0 - f) * upper + f * lower
                norm += direction[k] * direction[k]
            direction /= math.sqrt(norm)
            one, sun = ray(sea, eye, optics, disc, thermal, air, direction, values)
            total += one
            solar += sun
        out[0, pixels[p]] = total / (n * n)
        out[1, pixels[p]] = solar / (n * n)


@dataclass(frozen=True, eq=False)
class DirectWalk:
    """What rays from one height look up; make it with :meth:`create`."""

    optics: FacetOptics
    thermal: NDArray[np.float32]
    air: Air

    @classmethod
    def create(
        cls,
        view: SeaView,
        facets: SlopeStatistics,
        resolved: tuple[float, float],
        crest: float,
        elevation: float,
        azimuths: tuple[float, float],
        bands: int = 1,
    ) -> DirectWalk:
        """Tables for rays that look down at least as steeply as ``elevation`` and between two azimuths [rad].

        ``facets``: slopes left to the facets; ``resolved``: slope variances of the waves, along and across the wind; ``crest``: height of
        the highest [m]; ``bands`` of nested shadowing of the facets (1: Smith's).
        """
        eye = view.sensor_height
        dip = horizon_depression(eye)
        farthest = horizon_range(eye) + horizon_range(max(crest, 1e-6))
        if -elevation > 1.05 * dip:
            # the ray meets crests nearer, and troughs as deep farther out, than the mean sea
            farthest = min(float(surface_range(eye + 2.0 * crest, -elevation)), farthest)
        scale = eye
        log = np.linspace(0.0, np.log1p(farthest / scale), PATH_NODES)
        arcs = scale * np.expm1(log)
        basis = path_basis(view.atmosphere, view.band, eye, np.maximum(arcs, 1e-3 * eye))
        lowest = max(float(np.cos(view_zenith_of_range(eye, farthest))), 0.0) if -elevation > 1.05 * dip else 0.0
        axes, shape = thermal_axes(facets, resolved, (lowest, 1.0), azimuths)
        share, zenith = visible_sun(view.solar_zenith)
        irradiance = view.sun_distance_factor * share * view.atmosphere.solar_irradiance(zenith)[basis.grid]
        sun = sunlight(zenith, view.solar_azimuth, bool(irradiance.max() > 0.0))
        rough = roughness_of(facets, sun.azimuth, bands)
        table = thermal_table(thermal_sources(basis, view), rough, axes, shape, basis.phi.shape[0])
        thermal, coefficients = fewest_terms(table.astype(np.float64), basis.coefficients, TOGETHER)
        reflected, sun_coefficients = fewest_terms(sun_terms(basis, irradiance, view.water), basis.coefficients)
        tables = FacetTables(np.zeros((1, 1, 1, 1, 1), np.float32), axes, np.ascontiguousarray(reflected))
        by_azimuth = np.ascontiguousarray(thermal.astype(np.float32).transpose(1, 0, 2, 3, 4))
        above = np.linspace(0.0, np.sqrt(0.5 * np.pi + dip), SKY_ROWS)
        weights, grid = band_grid(view.band, view.atmosphere)
        sky = view.atmosphere.sky_radiance(np.maximum(0.5 * np.pi + dip - above**2, 0.0), eye)[:, grid] @ weights
        air = Air(
            scale, (PATH_NODES - 1) / float(log[-1]), coefficients, sun_coefficients, basis.path_radiance, sky, dip, 1.0 / float(above[1])
        )
        return cls(FacetOptics(sun, rough, tables), by_azimuth, air)

    def __call__(
        self,
        sea: Lattices,
        eye: Eye,
        corner: FloatArray,
        pixels: NDArray[np.int64],
        samples: NDArray[np.int64],
        out: NDArray[np.float32],
    ) -> None:
        """Walk the rays of some pixels; see :func:`walk_pixels`."""
        walk_pixels(sea, eye, *self.optics, self.thermal, self.air, corner, pixels, samples, out)


def rays_per_side(corner: FloatArray, pixels: NDArray[np.int64], height: float, shortest_wave: float) -> NDArray[np.int64]:
    """Rays along each side of a pixel [1]: enough to put four on the shortest wave in its footprint, within :data:`SAMPLES`."""
    if not np.isfinite(shortest_wave):
        return np.full(pixels.size, CALM_SAMPLES, np.int64)
    row, column = np.divmod(pixels, corner.shape[1] - 1)
    a, b, c = corner[row, column], corner[row, column + 1], corner[row + 1, column]
    angle = np.maximum(np.linalg.norm(b - a, axis=1), np.linalg.norm(c - a, axis=1))
    footprint = angle * height / np.maximum(-a[:, 2], 1e-2) ** 2
    sky = np.minimum(np.minimum(a[:, 2], b[:, 2]), np.minimum(c[:, 2], corner[row + 1, column + 1, 2])) >= 0.0
    return np.where(sky, CALM_SAMPLES, np.clip(np.ceil(4.0 * footprint / shortest_wave), *SAMPLES)).astype(np.int64)
