"""The sweep: walk outward along each azimuth, keep the highest elevation seen so far, and shade what rises above it.

Every surface piece above the running horizon is visible and covers a known interval of elevation; its radiance, found at the middle and
linear towards its neighbours, is added to the pixels in proportion to the overlap. So a column has no sampling noise in elevation, its
own horizon, and any width of panorama.

Detail falls with range: where a column has grown wider than half the waves of a level's last band (:mod:`seaglint.sea.detail`), the
band goes to the facets and steps grow. Most samples are hidden at grazing views: strips of them are passed over where the largest
heights of the lattices (:mod:`seaglint.render.surface`) stay below the line of sight, and the image is that of the full walk.
Across a column, lines part as the column widens: one line near the sensor, two where the column is wider than a quarter of a shortest
wave, and so on up to a limit. From there on the sea is sampled, not averaged, across a column.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numba
import numpy as np

from seaglint._jit import kernel, njit, njit_parallel
from seaglint.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.conventions import FloatArray, horizon_depression, horizon_range, surface_range
from seaglint.render.camera import Camera
from seaglint.render.facet import (
    DISC_ROWS,
    DiscLine,
    FacetLevels,
    FacetOptics,
    Sight,
    Sunlight,
    ThermalLine,
    disc_line,
    facet_sunlight,
    facet_thermal,
    level_optics,
    line_of_sight,
    thermal_along,
)
from seaglint.render.shade import sun_share
from seaglint.render.sparkle import Sparkle, facet_spread
from seaglint.render.surface import STRIP, Course, Strip, Surface, add_heights, course, height, new_strip, slopes

RANGE_PARTS = 0.5
"""Largest step as a share of the ground seen by one pixel row, so that near pixels are made of several pieces."""

PATH_EVERY = 16
"""Samples between two at which the path of sight is known, where waves are resolved."""

CALM_PARTS = 4
"""Pieces per pixel row where no waves are resolved."""

NEGLIGIBLE_SUN = 3e-4
"""Share of a facet's thermal radiance below which its sunlight is not asked for shadows."""

BUFFER = 1024
"""Visible pieces that are found before they are shaded; 48 kB stay near the processor."""


class Walk(NamedTuple):
    """Samples along every line: arcs from the sensor's foot and what depends on them alone.

    ``range_m``: the arcs. A height ``z`` is seen at the tangent ``rise z - fall``, to first order in ``z`` over the Earth's radius.
    ``coefficients, sun_coefficients, path`` stand at every ``every``-th sample, from the first to one past the last; linear between.
    ``stage[s] = (first sample, level of detail, how often every line parts in two at its beginning)``, and the number of samples in a
    last row. ``shadow[l]``: step [m] and steepest rise of shadow rays at every level; a step of 0 where waves cast none.
    """

    range_m: np.ndarray
    rise: np.ndarray
    fall: np.ndarray
    coefficients: np.ndarray
    sun_coefficients: np.ndarray
    path: np.ndarray
    every: int
    stage: np.ndarray
    shadow: np.ndarray


class Frame(NamedTuple):
    """Rows of the image: elevation of the upper edge, 1/row step, their number, tangents of the lower and upper edges, the sky in each."""

    top: float
    per_radian: float
    rows: int
    bottom_tangent: float
    top_tangent: float
    sky: np.ndarray


@njit
def graded_ranges(first: float, last: float, begins: np.ndarray, steps: np.ndarray, height: float, row_step: float) -> np.ndarray:
    """Arcs from ``first`` to ``last`` in steps of at most ``steps[l]``, from ``begins[l]`` on, and of :data:`RANGE_PARTS` of a pixel row's
    ground [m].
    """
    size = 1
    for fill in range(2):
        out = np.empty(size)
        r, i, level = first, 0, 0
        while True:
            if fill:
                out[i] = r
            if r >= last:
                break
            while level + 1 < begins.shape[0] and r >= begins[level + 1]:
                level += 1
            r += min(steps[level], max(RANGE_PARTS * row_step * (r * r + height * height) / height, 1e-3 * height))
            i += 1
        size = i + 1
    return out


def sea_limits(camera: Camera, crest: float) -> tuple[float, float] | None:
    """Arcs between which a sea of crests up to ``crest`` [m] can appear in the image; None where it cannot."""
    arcs = np.concatenate([[0.0], np.geomspace(1e-3 * camera.height, horizon_range(camera.height) + horizon_range(max(crest, 1e-6)), 4000)])
    psi = arcs / EFFECTIVE_EARTH_RADIUS
    reach, drop = EFFECTIVE_EARTH_RADIUS * np.sin(psi), camera.height + 2.0 * EFFECTIVE_EARTH_RADIUS * np.sin(0.5 * psi) ** 2
    # height of the lower edge's line of sight: below a crest from the first range on
    below = np.flatnonzero(reach * np.tan(max(camera.bottom, -0.5 * np.pi + 1e-9)) + drop < crest)
    if below.size == 0:
        return None
    first = arcs[max(below[0] - 1, 0)]
    upper = np.flatnonzero(reach * np.tan(min(camera.top, 0.5 * np.pi - 1e-9)) + drop < -crest)
    last = arcs[min(upper[0] + 1, arcs.size - 1)] if upper.size else arcs[-1]
    return float(first), float(last)


def calm_ranges(camera: Camera) -> FloatArray:
    """Arcs at equal steps of elevation, crowding at the horizon, for a sea without resolved waves [m]."""
    horizon = horizon_depression(camera.height)
    lowest = min(-camera.bottom + camera.row_step, 0.5 * np.pi)
    if lowest <= horizon:
        return np.empty(0)
    highest = max(-camera.top - camera.row_step, horizon)
    parts = int(np.ceil((lowest - highest) / camera.row_step)) * CALM_PARTS
    share = np.linspace(1.0, 0.0, parts + 1)
    if highest == horizon:
        share = np.concatenate([share[:-1], share[-2] * np.linspace(1.0, 0.0, 12)[1:] ** 2])
    depression = highest + (lowest - highest) * share
    arcs = surface_range(camera.height, depression)
    arcs[depression <= horizon] = horizon_range(camera.height)
    return np.asarray(np.maximum.accumulate(np.nan_to_num(arcs, nan=horizon_range(camera.height))))


@kernel
def bend(range_m: float) -> tuple[float, float, float]:
    """Cosine of an arc's angle on the effective sphere, ``R' sin`` of it and ``R' (1 - cos)`` [m].

    Series to the third term: within 1e-10 of the arc up to 500 km.
    """
    psi = range_m * (1.0 / EFFECTIVE_EARTH_RADIUS)
    square = psi * psi
    sagitta = 0.5 * psi * (1.0 - square * (1.0 / 12.0) * (1.0 - square * (1.0 / 30.0)))
    return 1.0 - psi * sagitta, range_m * (1.0 - square * (1.0 / 6.0) * (1.0 - square * (1.0 / 20.0))), range_m * sagitta


def sight_lines(arcs: FloatArray, height: float) -> tuple[FloatArray, FloatArray]:
    """:attr:`Walk.rise` [1/m] and :attr:`Walk.fall` [1] of samples at ``arcs`` [m] for a sensor ``height`` above the mean sea [m]."""
    psi = arcs / EFFECTIVE_EARTH_RADIUS
    # straight below the sensor nothing has a tangent: a nanometre aside it is as good as endless
    reach = np.maximum(EFFECTIVE_EARTH_RADIUS * np.sin(psi), 1e-9)
    below = height + 2.0 * EFFECTIVE_EARTH_RADIUS * np.sin(0.5 * psi) ** 2
    return (np.cos(psi) + below / EFFECTIVE_EARTH_RADIUS) / reach, below / reach


@kernel
def elevation(tangent: float) -> float:
    """Arc tangent; a series, within 1e-12, where it is small."""
    if abs(tangent) > 0.1:
        return math.atan(tangent)
    t = tangent * tangent
    return tangent * (1.0 - t * (1.0 / 3.0 - t * (0.2 - t * (1.0 / 7.0 - t * (1.0 / 9.0 - t / 11.0)))))


@kernel
def add_rows(
    images: np.ndarray,
    frame: Frame,
    edges: tuple[float, float],
    weight: float,
    light: tuple[float, float, float],
    lean: tuple[float, float],
) -> None:
    """Add a piece to the rows between the elevations ``edges = (low, high)``, in proportion to the overlap.

    ``light``: its mean radiance, the solar part and the spread of sparkles; ``lean``: how the first two change per radian.
    """
    low, high = edges
    upper = max((frame.top - high) * frame.per_radian, 0.0)
    lower = min((frame.top - low) * frame.per_radian, float(frame.rows))
    centre = (frame.top - 0.5 * (low + high)) * frame.per_radian
    total, solar = -lean[0] / frame.per_radian, -lean[1] / frame.per_radian
    row = int(upper)
    while row < lower:
        first, last = max(upper, float(row)), min(lower, row + 1.0)
        overlap = weight * (last - first)
        off = 0.5 * (first + last) - centre
        images[0, row] += (light[0] + total * off) * overlap
        images[1, row] += (light[1] + solar * off) * overlap
        images[2, row] += light[2] * overlap
        row += 1


@kernel
def leaning(light: np.ndarray, j: int, k: int, before: float, here: float, after: float, width: float) -> float:
    """Change of a radiance per radian over piece ``j``, from its neighbours: centres ``before, here, after``, its own where none is.

    Its ends stay within what separates it from its neighbours, and above 0.
    """
    fall, rise = light[j, k] - light[j - 1 if before != here else j, k], light[j + 1 if after != here else j, k] - light[j, k]
    if before == after:
        return 0.0
    most = 2.0 * min(max(abs(fall), abs(rise)), light[j, k]) / width
    return float(min(max((fall + rise) / (after - before), -most), most))


@kernel
def in_view(walk: Walk, strip: Strip, first: int, count: int, crest: float, tangent: float) -> bool:
    """True where a height of the strip, raised by ``crest`` [m], stands above the line of sight of this tangent."""
    seen = 0
    for k in range(count):
        seen += walk.rise[first + k] * (strip.height[k] + crest) - walk.fall[first + k] > tangent
    return seen > 0


@kernel
def walk_line(
    walk: Walk,
    surface: Surface,
    level: int,
    line: Course,
    part: tuple[int, int],
    horizon: tuple[float, float],
    strip: Strip,
    sample: np.ndarray,
    piece: np.ndarray,
) -> tuple[int, int, float]:
    """Find the visible pieces of one line over the samples ``part = (first, end)``, or as many as the buffers hold.

    ``horizon``: tangents of the highest elevation seen before and of the image's upper edge. Piece ``j`` ends at the sample ``sample[j]``;
    its length is ``piece[j, 0]`` [m] and the tangent at its upper edge ``piece[j, 1]``; its lower edge is the upper one of the piece
    before. Returns the number of pieces, the sample to go on with (or ``end``) and the last tangent.
    """
    i, end = part
    tangent, top = horizon
    found, tiles = 0, line.part.shape[0]
    while i < end and tangent < top and found + STRIP <= sample.shape[0]:
        count = min(STRIP, end - i)
        strip.height[:] = 0.0
        j = 0
        while j < tiles and (j == 0 or in_view(walk, strip, i, count, surface.crest[level, j], tangent)):
            add_heights(surface, line, j, walk.range_m, i, count, strip)
            j += 1
        if j == tiles and in_view(walk, strip, i, count, 0.0, tangent):
            for k in range(i, i + count):
                risen = walk.rise[k] * strip.height[k - i] - walk.fall[k]
                if risen <= tangent:
                    continue
                length = 0.0
                if k > 0:
                    # between two samples the sea may come into view
                    before = strip.height[k - 1 - i] if k > i else height(surface, line, 0, tiles, walk.range_m[k - 1])
                    above = walk.range_m[k] * (risen - tangent)
                    below = walk.range_m[k - 1] * max(tangent - walk.rise[k - 1] * before + walk.fall[k - 1], 0.0)
                    length = (walk.range_m[k] - walk.range_m[k - 1]) * above / (below + above + 1e-30)
                sample[found], piece[found, 0], piece[found, 1] = k, length, risen
                found += 1
                tangent = risen
                if tangent >= top:
                    break
        i += count
    return found, (i if tangent < top else end), tangent


@kernel
def shade_line(
    walk: Walk,
    frame: Frame,
    surface: Surface,
    optics: FacetOptics,
    sight: Sight,
    tables: tuple[ThermalLine, DiscLine],
    level: int,
    line: Course,
    sunward: Course,
    weight: float,
    lowest: float,
    pieces: tuple[int, np.ndarray, np.ndarray, np.ndarray],
    sparkle: Sparkle,
    pixel: float,
    images: np.ndarray,
) -> None:
    """Add the radiance of a line's visible pieces, times its weight, to the rows of ``images`` (total, solar part, spread of sparkles).

    ``pieces``: their number, samples and extents as :func:`walk_line` found them, and room for what they send.

    ``tables`` are the line's :func:`~seaglint.render.facet.thermal_along` and :func:`~seaglint.render.facet.disc_line`; ``sunward`` the
    course from the sensor's foot to the Sun.
    """
    count, sample, piece, light = pieces
    thermal, disc = tables
    below = lowest
    march = (walk.shadow[level, 0], walk.shadow[level, 1])
    for j in range(count):
        i, above = sample[j], piece[j, 1]
        light[j, 0], light[j, 1], light[j, 2] = 0.0, 0.0, 0.0
        if i > 0:
            r = walk.range_m[i] - 0.5 * piece[j, 0]
            p, f = i // walk.every, (i % walk.every) / walk.every
            slope = slopes(surface, line, r)
            # the grazing angle is the depression less the arc's angle
            tangent = 0.5 * (max(below, -1e3) + above)
            cosine = 1.0 / math.sqrt(1.0 + tangent * tangent)
            cosine_arc, reach, _ = bend(r)
            sine_arc = reach * (1.0 / EFFECTIVE_EARTH_RADIUS)
            grazing = (-cosine * (tangent * cosine_arc + sine_arc), cosine * (cosine_arc - tangent * sine_arc))
            warm = facet_thermal(optics.tables.axes, thermal, walk.coefficients, (p, f), sight, grazing[0], slope)
            solar, factor = facet_sunlight(optics, disc, walk.sun_coefficients, (p, f), sight, grazing, slope)
            if march[0] > 0.0 and solar > NEGLIGIBLE_SUN * warm:
                share = sun_share(surface, level, line, sunward, r, march, optics.sunlight)
                solar *= share
                factor *= share
            across = pixel * reach * reach / cosine
            light[j, 0], light[j, 1] = warm + walk.path[p] + f * (walk.path[p + 1] - walk.path[p]) + solar, solar
            light[j, 2] = facet_spread(sparkle, optics.sunlight, sight, grazing, solar, factor, across)
        below = above
    # Radiance changes linearly over a piece; beside a gap it is that of the neighbour on the other side.
    low = elevation(lowest)
    high = elevation(piece[0, 1]) if count > 0 else low
    before = here = 0.5 * (low + high)
    for j in range(count):
        beyond = elevation(piece[j + 1, 1]) if j + 1 < count else high
        after = 0.5 * (high + beyond) if j + 1 < count and sample[j + 1] == sample[j] + 1 else here
        width = max(high - low, 1e-15)
        lean = (leaning(light, j, 0, before, here, after, width), leaning(light, j, 1, before, here, after, width))
        add_rows(images, frame, (low, high), weight, (light[j, 0], light[j, 1], light[j, 2]), lean)
        low, high = high, beyond
        before, here = (here, after) if after != here else (0.5 * (low + high), 0.5 * (low + high))


@kernel
def add_sky(frame: Frame, tangent: float, weight: float, images: np.ndarray) -> None:
    """Fill the rows above the horizon that a line ended with."""
    upper = (frame.top - elevation(tangent)) * frame.per_radian
    for row in range(min(frame.rows, math.ceil(max(upper, 0.0)))):
        images[0, row] += weight * frame.sky[row] * (min(upper, row + 1.0) - row)


@njit
def sweep_columns(
    walk: Walk,
    frame: Frame,
    surface: Surface,
    sunlight: Sunlight,
    levels: FacetLevels,
    sparkle: Sparkle,
    azimuths: np.ndarray,
    width: float,
    images: np.ndarray,
    part: tuple[int, int],
) -> None:
    """Fill ``images[first:end]`` for ``part = (first, end)``: columns at ``azimuths`` of a ``width`` [rad], (columns, 3, rows).

    Columns do not depend on each other; :func:`seaglint._jit.in_threads` shares them out.
    """
    sample, piece, light = np.empty(BUFFER, np.int64), np.empty((BUFFER, 2)), np.empty((BUFFER, 3))
    strip, disc_rows = new_strip(), np.empty(DISC_ROWS)
    for column in range(part[0], part[1]):
        image = images[column]
        image[:] = 0.0
        tangents = np.full(1, frame.bottom_tangent)
        for stage in range(walk.stage.shape[0] - 1):
            tangents = np.repeat(tangents, 1 << walk.stage[stage, 2])
            first, end, level = walk.stage[stage, 0], walk.stage[stage + 1, 0], walk.stage[stage, 1]
            optics = level_optics(sunlight, levels, level)
            sunward = course(surface, level, sunlight.horizontal_east, sunlight.horizontal_north)
            lines = tangents.shape[0]
            for j in range(lines):
                sight = line_of_sight(optics, azimuths[column] + width * ((j + 0.5) / lines - 0.5))
                line = course(surface, level, -sight.east, -sight.north)
                tables = (thermal_along(optics.tables, sight), disc_line(optics, sight, disc_rows))
                i = first
                while i < end:
                    horizon = (tangents[j], frame.top_tangent)
                    count, i, tangent = walk_line(walk, surface, level, line, (i, end), horizon, strip, sample, piece)
                    # apart from the walk, so that the look-ups of one piece can overlap with those of the next
                    pieces = (count, sample, piece, light)
                    shade_line(
                        walk,
                        frame,
                        surface,
                        optics,
                        sight,
                        tables,
                        level,
                        line,
                        sunward,
                        1.0 / lines,
                        tangents[j],
                        pieces,
                        sparkle,
                        width / frame.per_radian,
                        image,
                    )
                    tangents[j] = tangent
        for tangent in tangents:
            add_sky(frame, tangent, 1.0 / tangents.shape[0], image)


@njit_parallel
def upright(columns: np.ndarray, total: np.ndarray, sun: np.ndarray) -> None:
    """Turn columns (columns, 3, rows) into the images ``total`` and ``sun`` (rows, columns)."""
    for part in numba.prange((total.shape[0] + 15) // 16):
        for column in range(total.shape[1]):
            for row in range(16 * part, min(16 * part + 16, total.shape[0])):
                total[row, column], sun[row, column] = columns[column, 0, row], columns[column, 1, row]
