"""Sweep: walk outward along each azimuth, track the highest elevation so far, and shade what rises above it.

Every surface piece above the running horizon is visible and covers a known interval of elevation; its radiance, evaluated at the middle
and linear towards its neighbours, is added to the pixels in proportion to the overlap. So a column has no sampling noise in elevation. It
has a separate horizon, and panoramas may have any width.

Across a column, lines split as the column widens, up to a limit. Between them the sea is sampled, or each line reads a sea that is averaged
over its share of the column: ``seaglint.imaging.scene`` plans both.

Cuts divide the image of a column by distance from the sensor: every piece is added to the whole image and to the image of its interval.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from seaglint.base.constants import EARTH_RADIUS, EFFECTIVE_EARTH_RADIUS
from seaglint.base.jit import kernel, njit
from seaglint.facet.facet_sunlight import FacetLevels, FacetOptics, facet_sunlight, level_optics
from seaglint.facet.foam import FoamTables, foam_emission, foam_sunlight, mirroring_share, mixed_light
from seaglint.facet.roughness import Sight, line_of_sight
from seaglint.facet.sky import SkyAbove, haze_between, haze_column, path_along, sky_column, thermal_between
from seaglint.facet.solar_disc import DISC_ROWS, DiscLine, disc_line
from seaglint.facet.sunlight import Sunlight, SunTable, raised_sun, strength_kernel, sunlight_at
from seaglint.facet.thermal import ThermalLine, facet_thermal, thermal_along
from seaglint.imaging.layers import COVERAGE, DISTANCE, EMITTED, FEWEST, FOAM, PATH, SLOPE, SPREAD, SUN, TOTAL
from seaglint.imaging.sparkle import Sparkle, facet_spread
from seaglint.imaging.sun_in_sky import NO_SUN, SunInSky, add_disc
from seaglint.imaging.sweep.walk import Merging, Pieces, Walk, bend, elevation, merge, new_pieces, read_foam, read_slopes, walk_line
from seaglint.imaging.wave_surface import Surface, SurfaceLine, course, height, new_strip, sun_over_waves

#: Share of a facet's thermal radiance below which its sunlight is not tested for shadows, and its moonlight.
NEGLIGIBLE_SUN, NEGLIGIBLE_MOON = 3e-4, 3e-6


#: Range of azimuths in which columns share tables of the facets and of the disc [rad]: radiance changes by less than 0.2 % in any pixel
#: and by 2e-4 rms.
SHARED = math.radians(0.25)

WIDE_COLUMN = math.radians(0.5)  #: Least width of a column [rad] with separate tables for each line: the aureole is ten degrees wide.


class Rows(NamedTuple):
    """Rows of the image: geometry, sky and Sun."""

    top: float  #: Elevation of the upper edge of row 0 [rad].
    per_radian: float  #: Rows per radian, the inverse of their step.
    number: int
    bottom_tangent: float  #: Tangent of the elevation of the image's lower edge.
    top_tangent: float  #: Tangent of the elevation of the image's upper edge.
    sky: SkyAbove  #: Sky in the rows that touch it, and in one more.
    sun: SunInSky = NO_SUN


class Swept(NamedTuple):
    """Data that columns read; no length depends on the instant."""

    walk: Walk  #: Samples along every line.
    rows: Rows
    sunlight: Sunlight  #: The Sun at the sensor's foot.
    strength: SunTable  #: Change of sunlight with the elevation of the Sun.
    levels: FacetLevels  #: Facets at every level of detail.
    sparkle: Sparkle
    merging: Merging
    foam: FoamTables  #: Light of foam; empty for a sea without foam.
    faint: float  #: Share of a facet's thermal radiance below which its sunlight is not tested for shadows.


class Line(NamedTuple):
    """Line of sight of a column in one stage of the walk."""

    level: int  #: Level of detail.
    course: SurfaceLine  #: Course over the sea.
    sunward: SurfaceLine  #: Course over the sea to the Sun.
    sight: Sight
    thermal: ThermalLine  #: Thermal radiance of the facets (``thermal_along``).
    emitted: ThermalLine  #: Emission of the facets alone.
    disc: DiscLine  #: Mirrored Sun (``disc_line``).
    path: np.ndarray  #: Radiance of the path (``path_along``) [W m-2 sr-1].
    weight: float  #: Share of the line in the column [1].
    width: float  #: Width of the column [rad].


@kernel
def add_rows(
    image: np.ndarray, rows: Rows, edges: tuple[float, float], weight: float, light: np.ndarray, lean: tuple[float, float, float, float]
) -> None:
    """Add a piece to the rows between the elevations ``edges = (low, high)``, in proportion to the overlap.

    ``image`` (channels, rows); ``light`` (channels,): means over the piece; ``lean``: derivatives of total, Sun, emission and path per
    radian.
    """
    low, high = edges
    upper = max((rows.top - high) * rows.per_radian, 0.0)
    lower = min((rows.top - low) * rows.per_radian, float(rows.number))
    centre = (rows.top - 0.5 * (low + high)) * rows.per_radian
    total, solar = -lean[0] / rows.per_radian, -lean[1] / rows.per_radian
    row = int(upper)
    while row < lower:
        first, last = max(upper, float(row)), min(lower, row + 1.0)
        overlap = weight * (last - first)
        off = 0.5 * (first + last) - centre
        image[TOTAL, row] += (light[TOTAL] + total * off) * overlap
        image[SUN, row] += (light[SUN] + solar * off) * overlap
        image[SPREAD, row] += light[SPREAD] * overlap
        if image.shape[0] > FEWEST:
            image[EMITTED, row] += (light[EMITTED] - lean[2] / rows.per_radian * off) * overlap
            image[PATH, row] += (light[PATH] - lean[3] / rows.per_radian * off) * overlap
            image[DISTANCE, row] += light[DISTANCE] * overlap
            image[COVERAGE, row] += overlap
            image[SLOPE, row] += light[SLOPE] * overlap
            image[FOAM, row] += light[FOAM] * overlap
        row += 1


@kernel
def leaning(light: np.ndarray, j: int, k: int, before: float, centre: float, after: float, width: float) -> float:
    """Return the derivative of a radiance over elevation [per rad] at piece ``j``, from its neighbours.

    ``before, here, after``: elevations of the centres of the neighbours and of the piece; a missing neighbour has the centre of the piece.
    The radiance at the ends of the piece differs from its mean by no more than the mean differs from its neighbours, and is above 0.
    """
    fall, rise = light[j, k] - light[j - 1 if before != centre else j, k], light[j + 1 if after != centre else j, k] - light[j, k]
    if before == after:
        return 0.0
    most = 2.0 * min(max(abs(fall), abs(rise)), light[j, k]) / width
    return float(min(max((fall + rise) / (after - before), -most), most))


@kernel
def distance(eye: float, z: float, r: float) -> float:
    """Return the slant distance from the sensor, ``eye`` [m] above the mean sea, to a point ``z`` [m] above it at an arc ``r`` [m]."""
    # law of cosines with 1 - cos as the square of a half angle: no loss of digits for short arcs
    half = math.sin(0.5 * r / EFFECTIVE_EARTH_RADIUS)
    across = 4.0 * (EFFECTIVE_EARTH_RADIUS + eye) * (EFFECTIVE_EARTH_RADIUS + z) * half * half
    return math.sqrt((eye - z) * (eye - z) + across)


@kernel
def shade_piece(swept: Swept, surface: Surface, lit: FacetOptics, line: Line, pieces: Pieces, j: int, below: float) -> None:
    """Compute the light of a piece, from its upper edge down to the tangent ``below``, into ``pieces.light[j]``.

    ``lit`` has the Sun at the piece.
    """
    walk, light, sun = swept.walk, pieces.light, lit.sunlight
    i, above, r = (pieces.begin[j] + pieces.sample[j]) >> 1, pieces.extent[j, 1], pieces.arc[j]
    if i == 0:
        for k in range(light.shape[1]):
            light[j, k] = 0.0
        return
    p, f = i // walk.every, (i % walk.every) / walk.every
    slope, spread = (pieces.slope[j, 0], pieces.slope[j, 1]), (pieces.spread[j, 0], pieces.spread[j, 1], pieces.spread[j, 2])
    # the grazing angle is the depression less the angle of the arc; at the nadir the tangent is infinite, hence the bound
    tangent = 0.5 * (max(below, -1e3) + above)
    cosine = 1.0 / math.sqrt(1.0 + tangent * tangent)
    cosine_arc, reach, _ = bend(r)
    sine_arc = reach * (1.0 / EFFECTIVE_EARTH_RADIUS)
    grazing = (-cosine * (tangent * cosine_arc + sine_arc), cosine * (cosine_arc - tangent * sine_arc))
    warm = facet_thermal(lit.tables.axes, line.thermal, walk.path.thermal, (p, f), line.sight, grazing[0], slope)
    solar, factor = facet_sunlight(lit, line.disc, walk.path.sun, (p, f), line.sight, grazing, slope, spread)
    if solar > 0.0:
        solar *= sun.share * strength_kernel(swept.strength, sun.up)
    march = (walk.shadow[line.level, 0], walk.shadow[line.level, 1])
    if march[0] > 0.0 and solar > swept.faint * warm:
        share, lift = sun_over_waves(surface, line.level, line.course, line.sunward, r, march, sun)
        if lift > 0.0:
            sun = raised_sun(sun, lift)
            risen = FacetOptics(sun, lit.roughness, lit.tables)
            solar, factor = facet_sunlight(risen, line.disc, walk.path.sun, (p, f), line.sight, grazing, slope, spread)
            solar *= sun.share * strength_kernel(swept.strength, sun.up)
        solar *= share
        factor *= share
    across = line.width / swept.rows.per_radian * reach * reach / cosine
    path = line.path[p] + f * (line.path[p + 1] - line.path[p])
    light[j, TOTAL], light[j, SUN] = warm + path + solar, solar
    slopes, seen = (slope[0], slope[1], spread[0], spread[1], spread[2]), FacetOptics(sun, lit.roughness, lit.tables)
    light[j, SPREAD] = facet_spread(swept.sparkle, seen, line.sight, grazing, slopes, (solar, factor), across, r)
    if light.shape[1] > FEWEST:
        light[j, EMITTED] = facet_thermal(lit.tables.axes, line.emitted, walk.path.emitted, (p, f), line.sight, grazing[0], slope)
        light[j, PATH] = path
        light[j, DISTANCE] = distance(walk.eye, height(surface, line.course, 0, line.course.part.shape[0], r), r)
        light[j, SLOPE] = -(slope[0] * line.sight.east + slope[1] * line.sight.north)
        light[j, FOAM] = 0.0


@kernel
def mix_foam(swept: Swept, surface: Surface, line: Line, pieces: Pieces, j: int, sun: Sunlight) -> float:
    """Compute the light of a shaded piece of water with its share of foam (``seaglint.facet.foam``) into ``pieces.mixed``.

    Returns the share of the piece that mirrors. ``sun`` is the Sun at the piece.
    """
    share, walk, light, mixed = pieces.foam[j], swept.walk, pieces.light, pieces.mixed
    i = (pieces.begin[j] + pieces.sample[j]) >> 1
    for k in range(light.shape[1]):
        mixed[k] = light[j, k]
    if i == 0:
        return 1.0
    at, slope = (i // walk.every, (i % walk.every) / walk.every), (pieces.slope[j, 0], pieces.slope[j, 1])
    path = line.path[at[0]] + at[1] * (line.path[at[0] + 1] - line.path[at[0]])
    glint, bubbles = light[j, SUN], foam_sunlight(swept.foam, at, sun, slope)
    if bubbles > 0.0:
        bubbles *= sun.share * strength_kernel(swept.strength, sun.up)
        march = (walk.shadow[line.level, 0], walk.shadow[line.level, 1])
        if march[0] > 0.0:
            bubbles *= sun_over_waves(surface, line.level, line.course, line.sunward, pieces.arc[j], march, sun)[0]
    warm, mixed[SUN] = mixed_light(swept.foam, at, share, light[j, TOTAL] - path - glint, glint, bubbles)
    mixed[TOTAL] = path + warm + mixed[SUN]
    mirroring = mirroring_share(swept.foam, share)
    mixed[SPREAD] *= mirroring * mirroring
    if light.shape[1] > FEWEST:
        emitted = light[j, EMITTED]
        mixed[EMITTED] = (1.0 - share) * emitted + share * foam_emission(swept.foam, at, emitted)
        mixed[FOAM] = share
    return mirroring


@kernel
def shade_line(
    swept: Swept,
    surface: Surface,
    optics: FacetOptics,
    line: Line,
    pieces: Pieces,
    count: int,
    lowest: float,
    cuts: np.ndarray,
    images: np.ndarray,
) -> None:
    """Add the radiance of a line's ``count`` visible pieces, times its weight, to the rows of ``images[0]`` (channels, rows).

    ``lowest``: tangent at the lower edge of the first piece. With ``images[1:]`` every piece is also added to the image of its interval:
    the number of the interval is the number of ``cuts`` [m] nearer than the piece.
    """
    sample, begin, extent, light = pieces.sample, pieces.begin, pieces.extent, pieces.light
    below, known = lowest, -1
    sun = optics.sunlight
    for j in range(count):
        # between two nodes of the path the Sun is taken as fixed: the vertical turns by some 1e-6 rad
        if sample[j] // swept.walk.every != known:
            known = sample[j] // swept.walk.every
            sun = sunlight_at(optics.sunlight, -line.sight.east, -line.sight.north, pieces.arc[j])
        shade_piece(swept, surface, FacetOptics(sun, optics.roughness, optics.tables), line, pieces, j, below)
        below = extent[j, 1]
    # radiance is linear over a piece; next to a hidden gap only the neighbour on the other side gives the slope
    low = elevation(lowest)
    high = elevation(extent[0, 1]) if count > 0 else low
    before = centre = 0.5 * (low + high)
    emitted = path = 0.0
    known, foamy = -1, swept.foam.sky.shape[0] > 0
    for j in range(count):
        beyond = elevation(extent[j + 1, 1]) if j + 1 < count else high
        after = 0.5 * (high + beyond) if j + 1 < count and begin[j + 1] == sample[j] + 1 else centre
        width = max(high - low, 1e-15)
        if light.shape[1] > FEWEST:
            emitted = leaning(light, j, EMITTED, before, centre, after, width)
            path = leaning(light, j, PATH, before, centre, after, width)
        lean = (leaning(light, j, TOTAL, before, centre, after, width), leaning(light, j, SUN, before, centre, after, width), emitted, path)
        row = light[j]
        if foamy and pieces.foam[j] > 0.0:
            # foam ends at the piece's ends: the slopes are those of the water alone
            if sample[j] // swept.walk.every != known:
                known = sample[j] // swept.walk.every
                sun = sunlight_at(optics.sunlight, -line.sight.east, -line.sight.north, pieces.arc[j])
            mirroring = mix_foam(swept, surface, line, pieces, j, sun)
            lean = (mirroring * lean[0], mirroring * lean[1], mirroring * lean[2], lean[3])
            row = pieces.mixed
        add_rows(images[0], swept.rows, (low, high), line.weight, row, lean)
        if images.shape[0] > 1:
            interval = 0
            while interval < cuts.shape[0] and light[j, DISTANCE] >= cuts[interval]:
                interval += 1
            add_rows(images[1 + interval], swept.rows, (low, high), line.weight, row, lean)
        low, high = high, beyond
        before, centre = (centre, after) if after != centre else (0.5 * (low + high), 0.5 * (low + high))


@kernel
def add_sky(rows: Rows, azimuth: float, tangent: float, weight: float, image: np.ndarray) -> None:
    """Fill the rows above the horizon of a line at an azimuth [rad]."""
    upper = (rows.top - elevation(tangent)) * rows.per_radian
    last = min(rows.sky.thermal.shape[1] - 1, math.ceil(max(upper, 0.0)))
    column = sky_column(rows.sky, azimuth)
    for row in range(last):
        image[TOTAL, row] += weight * thermal_between(rows.sky, column, row) * (min(upper, row + 1.0) - row)
    haze = rows.sky.haze
    if haze.values.shape[0] > 0:
        column = haze_column(haze, azimuth)
        for row in range(last):
            image[TOTAL, row] += weight * haze_between(haze, column, row) * (min(upper, row + 1.0) - row)


@kernel
def add_skies(rows: Rows, azimuth: float, width: float, tangents: np.ndarray, image: np.ndarray) -> None:
    """Add sky and Sun of a column above the horizons of its lines."""
    lines = tangents.shape[0]
    for j in range(lines):
        add_sky(rows, azimuth + width * ((j + 0.5) / lines - 0.5), tangents[j], 1.0 / lines, image)
    if rows.sun.radiance > 0.0:
        add_disc(rows.sun, rows.top, rows.per_radian, (azimuth, width), tangents, image[TOTAL])


@njit
def skies_alone(rows: Rows, azimuths: np.ndarray, width: float, images: np.ndarray) -> None:
    """Fill columns without sea; arguments as of ``sweep_columns``."""
    below = np.full(1, rows.bottom_tangent)
    for column in range(azimuths.shape[0]):
        images[column] = 0.0
        add_skies(rows, azimuths[column], width, below, images[column, 0])
        if images.shape[1] > 1:
            add_skies(rows, azimuths[column], width, below, images[column, images.shape[1] - 1])


@njit
def _split(tangents: np.ndarray, times: int) -> np.ndarray:
    """Repeat each value (columns, lines) a number of times; Numba takes a second to compile NumPy's ``repeat``."""
    out = np.empty((tangents.shape[0], times * tangents.shape[1]))
    for column in range(out.shape[0]):
        for i in range(out.shape[1]):
            out[column, i] = tangents[column, i // times]
    return out


@njit
def sharing(azimuths: np.ndarray, width: float, first: int, end: int) -> tuple[int, float]:
    """Return the end of the columns from ``first`` on that share tables, and the azimuth of these tables [rad].

    They are the columns between two multiples of ``SHARED``, so that they do not depend on the view; wide columns share none.
    """
    if width >= SHARED:
        return first + 1, azimuths[first]
    number, after = math.floor(azimuths[first] / SHARED), first + 1
    while after < end and math.floor(azimuths[after] / SHARED) == number:
        after += 1
    return after, (number + 0.5) * SHARED


@njit
def sweep_columns(
    swept: Swept, surface: Surface, azimuths: np.ndarray, width: float, cuts: np.ndarray, images: np.ndarray, part: tuple[int, int]
) -> None:
    """Fill ``images[first:end]`` for ``part = (first, end)``: columns at ``azimuths`` of a ``width`` [rad].

    ``images`` (columns, 1 or 2 + cuts, channels, rows): the whole, and the interval before each of the ``cuts`` (columns, cuts) [m] and
    beyond the last. Columns do not depend on each other; ``seaglint.base.jit.in_threads`` divides them among threads.
    """
    walk, rows = swept.walk, swept.rows
    farthest = walk.range_m[walk.range_m.shape[0] - 1] / EARTH_RADIUS
    pieces, strip, disc_rows = new_pieces(images.shape[2]), new_strip(), np.empty(DISC_ROWS)
    begin = part[0]
    while begin < part[1]:
        after, shared = sharing(azimuths, width, begin, part[1])
        images[begin:after] = 0.0
        tangents = np.full((after - begin, 1), rows.bottom_tangent)
        for stage in range(walk.stage.shape[0] - 1):
            tangents = _split(tangents, 1 << walk.stage[stage, 2])
            first, end, level = walk.stage[stage, 0], walk.stage[stage + 1, 0], walk.stage[stage, 1]
            optics = level_optics(swept.sunlight, swept.levels, level)
            axes, tables = optics.tables.axes, optics.tables
            sines = (max(axes[0, 0], 0.0), min(axes[0, 0] + (tables.thermal.shape[0] - 1) / axes[0, 1], 1.0))
            sunward = course(surface, level, swept.sunlight.horizontal_east, swept.sunlight.horizontal_north, (0.0, 0.0))
            arcs = (walk.range_m[first], walk.range_m[end - 1])
            limits = (swept.merging.spread, swept.merging.cells, swept.merging.highest[level], rows.top)
            middle = line_of_sight(optics.sunlight, optics.roughness, shared)
            thermal, emitted = thermal_along(tables.thermal, axes, middle), thermal_along(tables.emitted, axes, middle)
            disc = disc_line(optics.sunlight, optics.roughness, middle, sines, disc_rows, farthest)
            lines, places = tangents.shape[1], (first // walk.every, (end - 1) // walk.every + 2)
            path = walk.path.radiance
            for number in range((after - begin) * lines):
                column, j = begin + number // lines, number % lines
                sight = line_of_sight(optics.sunlight, optics.roughness, azimuths[column] + width * ((j + 0.5) / lines - 0.5))
                if lines > 1 and width > WIDE_COLUMN:
                    thermal, emitted = thermal_along(tables.thermal, axes, sight), thermal_along(tables.emitted, axes, sight)
                    disc = disc_line(optics.sunlight, optics.roughness, sight, sines, disc_rows, farthest)
                    path = path_along(walk.path.radiance, walk.path.sunlit, sight.chi, places)
                elif j == 0:
                    # next to the Sun haze changes too fast to be shared by columns: they would show as stripes
                    middle = line_of_sight(optics.sunlight, optics.roughness, azimuths[column])
                    path = path_along(walk.path.radiance, walk.path.sunlit, middle.chi, places)
                line = Line(
                    level,
                    course(surface, level, -sight.east, -sight.north, arcs),
                    sunward,
                    sight,
                    thermal,
                    emitted,
                    disc,
                    path,
                    1.0 / lines,
                    width,
                )
                i, tangent = first, tangents[column - begin, j]
                while i < end:
                    horizon = (tangent, rows.top_tangent)
                    count, i, highest = walk_line(walk, surface, level, line.course, (i, end), horizon, strip, pieces.sample, pieces.extent)
                    # separate from the walk, so that readings of one piece can overlap with readings of the next
                    read_slopes(surface, line.course, walk.range_m, pieces, count, strip)
                    if swept.foam.sky.shape[0] > 0:
                        read_foam(surface, level, line.course, (-sight.east, -sight.north), width / lines, pieces, count)
                    count = merge(pieces, count, tangent, optics.roughness, limits)
                    shade_line(swept, surface, optics, line, pieces, count, tangent, cuts[column], images[column])
                    tangent = highest
                tangents[column - begin, j] = tangent
        for column in range(begin, after):
            last = images.shape[1] - 1
            add_skies(rows, azimuths[column], width, tangents[column - begin], images[column, 0])
            if last > 0:
                add_skies(rows, azimuths[column], width, tangents[column - begin], images[column, last])
        begin = after
