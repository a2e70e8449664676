"""Single rays followed to the sea, where the sweep over azimuths does not serve (near nadir).

A ray at height ``f`` above the sea below it cannot meet the sea before ``f / (fall + L run)``, where ``fall`` and ``run`` are its descent
and its horizontal distance per metre and ``L`` is the steepest slope of the sea. Steps of that length never pass through a crest and
shorten as the ray approaches the sea. Steep rays arrive in a few steps, a vertical ray in two. Rays read the sea in full detail, with the
functions of the sweep; tiles have the displacement of the place where the ray meets the mean sea.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from seaglint.base.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.base.conventions import FloatArray, horizon_depression, horizon_range, surface_range, view_zenith_of_range
from seaglint.base.jit import kernel, njit
from seaglint.facet.facet_sunlight import FacetLevels, FacetOptics, facet_sunlight, level_optics
from seaglint.facet.facet_tables import FacetDomain, PathTerms, facet_tables
from seaglint.facet.foam import NO_FOAM, FoamTables, foam_emission, foam_sunlight, mixed_light
from seaglint.facet.foam_light import foam_tables
from seaglint.facet.path_basis import path_basis
from seaglint.facet.roughness import Sight, line_of_sight
from seaglint.facet.sea_view import SeaView
from seaglint.facet.sky import SkyAbove, haze_between, haze_column, sky_above, sky_between
from seaglint.facet.solar_disc import DiscLine, no_disc_line
from seaglint.facet.sunlight import Sunlight, SunTable, raised_sun, strength_kernel, sunlight_at
from seaglint.facet.thermal import azimuth_node, facet_thermal, thermal_line
from seaglint.imaging.layers import COVERAGE, DISTANCE, EMITTED, FOAM, PATH, SLOPE, SUN, TOTAL
from seaglint.imaging.wave_surface import Bounds, Surface, SurfaceLine, course, foam_share, height, lay_course, slopes, sun_over_waves
from seaglint.sea.slopes.slope_statistics import SlopeStatistics

#: Number of arcs at which the path is tabulated, uniform in log(1 + arc/height): a step changes the transmittance by less than 1e-3.
PATH_NODES = 2048

SKY_ROWS = 1025  #: Number of elevations of the sky table, uniform in the square root of the elevation above the horizon.

SAMPLES = (2, 8)  #: Least and largest number of rays along each side of a pixel; between them, as many as put four on the shortest wave.

CALM_SAMPLES = 4  #: Number of rays along each side of a pixel without resolved waves.

CLOSE = 1e-3  #: Height above the sea at which a ray has arrived [lattice spacings].

MOST_STEPS = 200_000  #: Largest number of steps of a ray; only rays that skim the sea for tens of kilometres need thousands.


class Air(NamedTuple):
    """Path by arc and sky by elevation, from one height.

    Node ``i`` of ``path`` is at the arc ``scale (e^(i/parts) - 1)`` [m], node ``i`` of ``sky`` at the elevation ``i^2/sky_parts^2 - dip``
    [rad].
    """

    scale: float
    parts: float
    path: PathTerms
    sky: SkyAbove
    dip: float
    sky_parts: float


class RayTables(NamedTuple):
    """Tables that rays read; ``thermal`` and ``emitted`` are the facets' tables, azimuth first."""

    sunlight: Sunlight
    strength: SunTable
    levels: FacetLevels
    thermal: np.ndarray
    emitted: np.ndarray
    air: Air
    foam: FoamTables  #: Light of foam; empty for a sea without foam.


class Room(NamedTuple):
    """Buffers of a ray: the lines over the sea towards its azimuth and towards the Sun, without a table of the disc."""

    line: SurfaceLine
    sunward: SurfaceLine
    disc: DiscLine


@kernel
def above_sphere(height: float, run: float, rise: float, s: float) -> tuple[float, float, float]:
    """Return height over the mean sea, arc [m] and rise per metre of a ray at a distance ``s``; ``run`` and ``rise``: its unit vector."""
    # rho - R' as a quotient: the difference of two radii would lose the digits of a height
    up, out = height + s * rise, s * run
    rho = math.sqrt((EFFECTIVE_EARTH_RADIUS + up) ** 2 + out * out)
    z = (2.0 * EFFECTIVE_EARTH_RADIUS * up + up * up + out * out) / (rho + EFFECTIVE_EARTH_RADIUS)
    return (
        z,
        EFFECTIVE_EARTH_RADIUS * math.atan2(out, EFFECTIVE_EARTH_RADIUS + up),
        (rise * (EFFECTIVE_EARTH_RADIUS + up) + run * out) / rho,
    )


@kernel
def mean_arc(eye: float, run: float, rise: float) -> float:
    """Return the arc at which a ray meets the mean sea, or is nearest to it [m]; ``run`` and ``rise``: its unit vector."""
    # the nearer root of the quadratic equation of line and sphere, in the form without cancellation
    nearest = max(-rise * (EFFECTIVE_EARTH_RADIUS + eye), 0.0)
    power = eye * (2.0 * EFFECTIVE_EARTH_RADIUS + eye)
    s = power / (nearest + math.sqrt(nearest * nearest - power)) if nearest * nearest > power else nearest
    return above_sphere(eye, run, rise, s)[1]


@kernel
def meet(surface: Surface, line: SurfaceLine, bounds: Bounds, eye: float, run: float, rise: float) -> float:
    """Return the distance at which a ray from ``eye`` [m] above the line's beginning meets the sea [m]; -1 for a ray that does not.

    ``run`` and ``rise``: unit vector of the ray.
    """
    s = 0.0
    if eye > bounds.crest:
        if rise >= 0.0:
            return -1.0
        s = (eye - bounds.crest) / -rise  # above the round sea by more than a crest until here
    before, gap_before = s, 0.0
    for step in range(MOST_STEPS):
        z, arc, climb = above_sphere(eye, run, rise, s)
        if climb >= 0.0 and z > bounds.crest:
            return -1.0
        gap = z - height(surface, line, 0, line.part.shape[0], arc)
        if gap < 0.0:
            return before + (s - before) * gap_before / (gap_before - gap) if step > 0 else s
        if gap <= CLOSE * bounds.spacing:
            return s
        before, gap_before = s, gap
        # the least step, a fiftieth of a cell, lets rays that skim the sea end
        s += max(gap / max(bounds.steepest * run - climb, 1e-9), 0.02 * bounds.spacing)
    return -1.0


@kernel
def sky_at(air: Air, elevation: float, azimuth: float) -> float:
    """Return the radiance of the sky at an elevation and an azimuth [rad], without the Sun [W m-2 sr-1]."""
    row = math.sqrt(max(elevation + air.dip, 0.0)) * air.sky_parts
    return sky_between(air.sky, azimuth, min(row, air.sky.thermal.shape[1] - 1.0))


@njit
def warm_light(
    table: np.ndarray, axes: np.ndarray, path: np.ndarray, i: int, sight: Sight, sine: float, slope: tuple[float, float]
) -> float:
    """Return the light of a thermal table, azimuth first, between the two azimuths next to a line of sight; 0 without terms."""
    if table.shape[4] == 0:
        return 0.0
    ix, fx = azimuth_node(axes, table.shape[0], sight.chi)
    warm = facet_thermal(axes, thermal_line(table[ix]), path, (i, 0.0), sight, sine, slope)
    if fx > 1e-9:
        warm += fx * (facet_thermal(axes, thermal_line(table[ix + 1]), path, (i, 0.0), sight, sine, slope) - warm)
    return warm


@njit
def ray(
    surface: Surface,
    bounds: Bounds,
    eye: float,
    tables: RayTables,
    optics: FacetOptics,
    room: Room,
    direction: np.ndarray,
    wide: float,
    out: np.ndarray,
) -> None:
    """Compute the channels of one ray along a unit vector (east, north, up) into ``out`` (channels,); ``wide`` [rad]: width of its foam."""
    air, sun = tables.air, tables.sunlight
    rise = direction[2]
    run = math.sqrt(direction[0] * direction[0] + direction[1] * direction[1])
    azimuth = math.atan2(direction[0], direction[1])
    foot = mean_arc(eye, run, rise)
    lay_course(surface, 0, (math.sin(azimuth), math.cos(azimuth)), (foot, foot), room.line)
    s = meet(surface, room.line, bounds, eye, run, rise)
    out[:] = 0.0
    if s < 0.0:
        out[TOTAL] = sky_at(air, math.atan2(rise, run), azimuth)
        return
    _, arc, climb = above_sphere(eye, run, rise, s)
    axes = optics.tables.axes
    sight = line_of_sight(sun, optics.roughness, azimuth)
    slope = slopes(surface, room.line, arc)
    sine = min(max(-climb, 0.0), 1.0)
    i = min(int(math.log(1.0 + arc / air.scale) * air.parts + 0.5), air.path.radiance.shape[0] - 1)
    warm = warm_light(tables.thermal, axes, air.path.thermal, i, sight, sine, slope)
    local_sun = sunlight_at(sun, -sight.east, -sight.north, arc)
    lit = FacetOptics(local_sun, optics.roughness, optics.tables)
    grazing = (sine, math.sqrt(1.0 - sine * sine))
    solar, _ = facet_sunlight(lit, room.disc, air.path.sun, (i, 0.0), sight, grazing, slope)
    if solar > 0.0:
        solar *= local_sun.share * strength_kernel(tables.strength, local_sun.up)
    if solar > 0.0 and bounds.steepest > local_sun.lower_tangent:
        lay_course(surface, 0, (sun.horizontal_east, sun.horizontal_north), (0.0, 0.0), room.sunward)
        share, lift = sun_over_waves(surface, 0, room.line, room.sunward, arc, (bounds.spacing, bounds.steepest), local_sun)
        if lift > 0.0:
            local_sun = raised_sun(local_sun, lift)
            risen = FacetOptics(local_sun, optics.roughness, optics.tables)
            solar, _ = facet_sunlight(risen, room.disc, air.path.sun, (i, 0.0), sight, grazing, slope)
            solar *= local_sun.share * strength_kernel(tables.strength, local_sun.up)
        solar *= share
    path = air.path.radiance[i]
    if air.path.sunlit.haze.values.shape[0] > 0:
        path += haze_between(air.path.sunlit.haze, haze_column(air.path.sunlit.haze, azimuth), air.path.sunlit.row[i])
    out[TOTAL], out[SUN] = warm + path + solar, solar
    out[EMITTED] = warm_light(tables.emitted, axes, air.path.emitted, i, sight, sine, slope)
    out[PATH], out[DISTANCE], out[COVERAGE] = path, s, 1.0
    out[SLOPE] = -(slope[0] * sight.east + slope[1] * sight.north)
    if tables.foam.sky.shape[0] > 0:
        away = (-sight.east, -sight.north)
        share = foam_share(surface, 0, room.line, away, arc, wide * s)
        local_sun = sunlight_at(sun, away[0], away[1], arc)
        bubbles = foam_sunlight(tables.foam, (i, 0.0), local_sun, slope)
        if share > 0.0 and bubbles > 0.0:
            bubbles *= local_sun.share * strength_kernel(tables.strength, local_sun.up)
            if bounds.steepest > local_sun.lower_tangent:
                lay_course(surface, 0, (sun.horizontal_east, sun.horizontal_north), (0.0, 0.0), room.sunward)
                bubbles *= sun_over_waves(surface, 0, room.line, room.sunward, arc, (bounds.spacing, bounds.steepest), local_sun)[0]
        warm, out[SUN] = mixed_light(tables.foam, (i, 0.0), share, warm, solar, bubbles)
        out[TOTAL] = path + warm + out[SUN]
        out[EMITTED] = (1.0 - share) * out[EMITTED] + share * foam_emission(tables.foam, (i, 0.0), out[EMITTED])
        out[FOAM] = share


@njit
def walk_pixels(
    surface: Surface,
    bounds: Bounds,
    eye: float,
    tables: RayTables,
    corner: np.ndarray,
    pixels: np.ndarray,
    samples: np.ndarray,
    channels: np.ndarray,
    part: tuple[int, int],
) -> None:
    """Compute mean ``channels`` (pixels, channels) of the pixels ``part = (first, end)`` of ``pixels`` (flat indices).

    ``samples``: number of rays along each side of a pixel (pixels,).
    """
    columns = corner.shape[1] - 1
    optics = level_optics(tables.sunlight, tables.levels, 0)
    line, sunward = course(surface, 0, 1.0, 0.0, (0.0, 0.0)), course(surface, 0, 1.0, 0.0, (0.0, 0.0))
    room = Room(line, sunward, no_disc_line())
    direction, one = np.empty(3), np.empty(channels.shape[1])
    for p in range(part[0], part[1]):
        row, column = pixels[p] // columns, pixels[p] % columns
        n = samples[p]
        channels[p] = 0.0
        side = 0.0
        for k in range(3):
            side += (corner[row, column + 1, k] - corner[row, column, k]) ** 2
        wide = math.sqrt(side) / n
        for sample in range(n * n):
            f, g = (sample // n + 0.5) / n, (sample % n + 0.5) / n
            norm = 0.0
            for k in range(3):
                upper = (1.0 - g) * corner[row, column, k] + g * corner[row, column + 1, k]
                lower = (1.0 - g) * corner[row + 1, column, k] + g * corner[row + 1, column + 1, k]
                direction[k] = (1.0 - f) * upper + f * lower
                norm += direction[k] * direction[k]
            direction /= math.sqrt(norm)
            ray(surface, bounds, eye, tables, optics, room, direction, wide, one)
            channels[p] += one
        channels[p] /= n * n


def ray_tables(
    view: SeaView,
    facets: SlopeStatistics,
    resolved: tuple[float, float],
    crest: float,
    elevation: float,
    azimuths: tuple[float, float],
    *,
    emitted: bool = False,
) -> RayTables:
    """Return tables for rays from one height that look down at least as steeply as ``elevation`` and between two azimuths [rad].

    ``facets``: slopes left to the facets; ``resolved``: slope variances of the waves, along and across the wind; ``crest``: height of
    the highest crest [m]; ``emitted``: True for emission separate from the mirrored sky.
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
    places = np.maximum(arcs, 1e-3 * eye)
    basis = path_basis(view.atmosphere, view.band, eye, places)
    lowest = max(float(np.cos(view_zenith_of_range(eye, farthest))), 0.0) if -elevation > 1.05 * dip else 0.0
    domain = FacetDomain(facets, resolved, view.hiding.facet_law(view.slopes, facets), (lowest, 1.0))
    sun, levels, path = facet_tables(view, basis, places, [domain], azimuths, emitted=emitted)
    shape = levels.shape[0, 1:]

    def by_azimuth(table: NDArray[np.float32]) -> NDArray[np.float32]:
        return np.ascontiguousarray(table.reshape(*shape, table.shape[1]).transpose(1, 0, 2, 3, 4))

    above = np.linspace(0.0, np.sqrt(0.5 * np.pi + dip), SKY_ROWS)
    air = Air(scale, (PATH_NODES - 1) / float(log[-1]), path, sky_above(view, above**2 - dip), dip, 1.0 / float(above[1]))
    return RayTables(
        sun,
        view.sun_table,
        levels,
        by_azimuth(levels.thermal),
        by_azimuth(levels.emitted),
        air,
        NO_FOAM if view.foam is None else foam_tables(view, basis),
    )


def rays_per_side(corner: FloatArray, pixels: NDArray[np.int64], height: float, shortest_wave: float) -> NDArray[np.int64]:
    """Return the number of rays [1] along each side of a pixel: four on the shortest wave in its footprint, within ``SAMPLES``."""
    if not np.isfinite(shortest_wave):
        return np.full(pixels.size, CALM_SAMPLES, np.int64)
    row, column = np.divmod(pixels, corner.shape[1] - 1)
    a, b, c = corner[row, column], corner[row, column + 1], corner[row + 1, column]
    angle = np.maximum(np.linalg.norm(b - a, axis=1), np.linalg.norm(c - a, axis=1))
    footprint = angle * height / np.maximum(-a[:, 2], 1e-2) ** 2
    sky = np.minimum(np.minimum(a[:, 2], b[:, 2]), np.minimum(c[:, 2], corner[row + 1, column + 1, 2])) >= 0.0
    return np.where(sky, CALM_SAMPLES, np.clip(np.ceil(4.0 * footprint / shortest_wave), *SAMPLES)).astype(np.int64)
