"""Walk outward along a line of sight: positions of samples, visible pieces of sea, and merging of pieces of nearly equal slope.

Detail falls with range: where a column has grown wider than half the waves of a level's last octave (:mod:`seaglint.sea.wave_field`),
that octave goes to the facets and steps grow. At grazing views most samples are hidden: strips of them are skipped where the largest
heights of the lattices (``seaglint.imaging.wave_surface``) stay below the line of sight. The image is equal to the image of the full
walk.

The walk yields a piece at every sample that rises above the horizon. Far away and with short waves many of them share a row of the image,
and neighbours differ by little compared with the slopes of their facets; such pieces are merged and shaded as one. A merged piece has the
mean slope and the mean share of foam of its parts, each weighted with the elevation that it fills, and the covariance of their slopes. That
covariance is added to the covariance of the facets, and the visible and lit share of facets is averaged over it
(``seaglint.facet.facet_sunlight.merged_share``): the mean of all parts, to second order in the slopes.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from seaglint.base.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.base.conventions import FloatArray, horizon_depression, horizon_range, surface_range
from seaglint.base.jit import kernel, njit
from seaglint.base.sine import sine
from seaglint.facet.facet_tables import PathTerms
from seaglint.facet.roughness import Roughness
from seaglint.imaging.camera.imager import Camera
from seaglint.imaging.foam_surface import foam_level, level_share, with_holes
from seaglint.imaging.wave_surface import LONGEST_STRIP, STRIP, Strip, Surface, SurfaceLine, add_heights, address, gradient, height, piece
from seaglint.sea.foam.ship_foam import segments_share

RANGE_PARTS = 0.5  #: Largest step as a share of the ground seen by one pixel row, so that near pixels consist of several pieces.

PATH_EVERY = 16  #: Number of samples between two at which the path is known, where waves are resolved.

CALM_PARTS = 4  #: Number of pieces per pixel row where no waves are resolved.


class Walk(NamedTuple):
    """Samples along every line: arcs from the sensor's foot and the quantities that depend on them alone.

    - ``range_m``: the arcs; ``eye``: height of the sensor [m].
    - ``rise`` [1/m], ``fall`` [1]: a height ``z`` has the tangent of elevation ``rise z - fall``, to first order in ``z`` over the Earth's
      radius.
    - ``path``: at every ``every``-th sample, from the first to one past the last; linear between.
    - ``stage[s]``: first sample, level of detail, and number of times that every line splits in two at its beginning; a last row has the
      number of samples.
    - ``shadow[l]``: step [m] and steepest rise of shadow rays at every level; a step of 0 where waves cast no shadow.
    """

    range_m: np.ndarray
    eye: float
    rise: np.ndarray
    fall: np.ndarray
    path: PathTerms
    every: int
    stage: np.ndarray
    shadow: np.ndarray


@njit
def graded_ranges(first: float, last: float, begins: np.ndarray, steps: np.ndarray, height: float, row_step: float) -> np.ndarray:
    """Return arcs from ``first`` to ``last`` [m] in steps of at most ``steps[l]``, from ``begins[l]`` on.

    Steps are also at most ``RANGE_PARTS`` of the ground in a pixel row.
    """
    # the first pass counts the arcs, the second one stores them
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
    """Return the arcs between which a sea of crests up to ``crest`` [m] can appear in the image [m]; None where it cannot."""
    arcs = np.concatenate([[0.0], np.geomspace(1e-3 * camera.height, horizon_range(camera.height) + horizon_range(max(crest, 1e-6)), 4000)])
    psi = arcs / EFFECTIVE_EARTH_RADIUS
    reach, drop = EFFECTIVE_EARTH_RADIUS * np.sin(psi), camera.height + 2.0 * EFFECTIVE_EARTH_RADIUS * np.sin(0.5 * psi) ** 2
    # height of the line of sight of the lower edge: below a crest from the first range on
    below = np.flatnonzero(reach * np.tan(max(camera.bottom, -0.5 * np.pi + 1e-9)) + drop < crest)
    if below.size == 0:
        return None
    first = arcs[max(below[0] - 1, 0)]
    upper = np.flatnonzero(reach * np.tan(min(camera.top, 0.5 * np.pi - 1e-9)) + drop < -crest)
    last = arcs[min(upper[0] + 1, arcs.size - 1)] if upper.size else arcs[-1]
    return float(first), float(last)


def calm_ranges(camera: Camera) -> FloatArray:
    """Return arcs at equal steps of elevation, dense at the horizon, for a sea without resolved waves [m]."""
    horizon = horizon_depression(camera.height)
    lowest = min(-camera.bottom + camera.row_step, 0.5 * np.pi)
    if lowest <= horizon:
        return np.empty(0)
    highest = max(-camera.top - camera.row_step, horizon)
    parts = int(np.ceil((lowest - highest) / camera.row_step)) * CALM_PARTS
    share = np.linspace(1.0, 0.0, parts + 1)
    if highest == horizon:
        # arcs grow without bound per elevation near the horizon: the last step is divided, the parts falling to 0 as squares
        share = np.concatenate([share[:-1], share[-2] * np.linspace(1.0, 0.0, 12)[1:] ** 2])
    depression = highest + (lowest - highest) * share
    arcs = surface_range(camera.height, depression)
    arcs[depression <= horizon] = horizon_range(camera.height)
    return np.asarray(np.maximum.accumulate(np.nan_to_num(arcs, nan=horizon_range(camera.height))))


def stages(arcs: FloatArray, begins: FloatArray, parts: FloatArray) -> NDArray[np.int64]:
    """Return the rows ``Walk.stage`` for samples at ``arcs`` [m].

    Level ``l`` begins at the arc ``begins[l]``; at each of ``parts`` the lines of a column split in two. They never join again, as each
    line has its own horizon.
    """
    level = np.searchsorted(begins, arcs, side="right") - 1
    parted = np.searchsorted(parts, arcs, side="right")
    starts = np.flatnonzero(np.concatenate([[True], (np.diff(level) != 0) | (np.diff(parted) != 0)]))
    doublings = np.diff(parted[starts], prepend=0)
    return np.concatenate([np.stack([starts, level[starts], doublings], axis=1), [[arcs.size, 0, 0]]]).astype(np.int64)


def sight_lines(arcs: FloatArray, height: float) -> tuple[FloatArray, FloatArray]:
    """Return ``Walk.rise`` [1/m] and ``Walk.fall`` [1] of samples at ``arcs`` [m], seen from ``height`` [m] above the mean sea."""
    psi = arcs / EFFECTIVE_EARTH_RADIUS
    # straight below the sensor the tangent is infinite: it is evaluated a nanometre aside
    reach = np.maximum(EFFECTIVE_EARTH_RADIUS * np.sin(psi), 1e-9)
    below = height + 2.0 * EFFECTIVE_EARTH_RADIUS * np.sin(0.5 * psi) ** 2
    return (np.cos(psi) + below / EFFECTIVE_EARTH_RADIUS) / reach, below / reach


@kernel
def bend(range_m: float) -> tuple[float, float, float]:
    """Return the cosine of an arc's angle on the effective sphere, ``R' sin`` of the angle and ``R' (1 - cos)`` [m].

    Series to the third term: within 1e-10 of the arc up to 500 km.
    """
    psi = range_m * (1.0 / EFFECTIVE_EARTH_RADIUS)
    square = psi * psi
    sagitta = 0.5 * psi * (1.0 - square * (1.0 / 12.0) * (1.0 - square * (1.0 / 30.0)))
    return 1.0 - psi * sagitta, range_m * (1.0 - square * (1.0 / 6.0) * (1.0 - square * (1.0 / 20.0))), range_m * sagitta


@kernel
def elevation(tangent: float) -> float:
    """Return an elevation from its tangent [rad]: the arc tangent, by a series within 1e-12 where it is small."""
    if abs(tangent) > 0.1:
        return math.atan(tangent)
    t = tangent * tangent
    return tangent * (1.0 - t * (1.0 / 3.0 - t * (0.2 - t * (1.0 / 7.0 - t * (1.0 / 9.0 - t / 11.0)))))


@kernel
def in_view(walk: Walk, strip: Strip, first: int, count: int, crest: float, tangent: float) -> bool:
    """Return True where a height of the strip, raised by ``crest`` [m], is above the line of sight of this tangent."""
    # unsigned, as in ``address``
    visible, at = np.int64(0), np.uint64(first)
    for n in range(count):
        k = np.uint64(n)
        visible += walk.rise[at + k] * (strip.height[k] + crest) - walk.fall[at + k] > tangent
    return bool(visible > 0)


@kernel
def walk_line(
    walk: Walk,
    surface: Surface,
    level: int,
    line: SurfaceLine,
    part: tuple[int, int],
    horizon: tuple[float, float],
    strip: Strip,
    sample: np.ndarray,
    piece: np.ndarray,
) -> tuple[int, int, float]:
    """Find the visible pieces of one line over the samples ``part = (first, end)``, or as many as the buffers hold.

    ``horizon``: tangents of the highest visible elevation so far and of the image's upper edge. Piece ``j`` ends at the sample
    ``sample[j]``; its length is ``piece[j, 0]`` [m] and the tangent at its upper edge ``piece[j, 1]``; its lower edge is the upper edge of
    the piece before. Returns the number of pieces, the number of the next sample (or ``end``) and the last tangent.
    """
    i, end = part
    tangent, top = horizon
    number, tiles = 0, line.part.shape[0]
    while i < end and tangent < top and number + STRIP <= sample.shape[0]:
        count = min(STRIP, end - i)
        strip.height[:] = 0.0
        j = 0
        # before the first lattice the bound is the highest crest of all: beyond the horizon almost no sample has to be read
        while j < tiles and in_view(walk, strip, i, count, surface.crest[level, j], tangent):
            add_heights(surface, line, j, walk.range_m, i, count, strip)
            j += 1
        if j == tiles and in_view(walk, strip, i, count, 0.0, tangent):
            for k in range(i, i + count):
                risen = walk.rise[k] * strip.height[k - i] - walk.fall[k]
                if risen <= tangent:
                    continue
                length = 0.0
                if k > 0:
                    # the sea comes into view between two samples where its height, linear between them, meets the line of sight
                    before = strip.height[k - 1 - i] if k > i else height(surface, line, 0, tiles, walk.range_m[k - 1])
                    above = walk.range_m[k] * (risen - tangent)
                    below = walk.range_m[k - 1] * max(tangent - walk.rise[k - 1] * before + walk.fall[k - 1], 0.0)
                    length = (walk.range_m[k] - walk.range_m[k - 1]) * above / (below + above + 1e-30)
                sample[number], piece[number, 0], piece[number, 1] = k, length, risen
                number += 1
                tangent = risen
                if tangent >= top:
                    break
        i += count
    return number, (i if tangent < top else end), tangent


BUFFER = 1024  #: Number of visible pieces that are collected before they are shaded; 150 kB stay in the processor's cache.


class Pieces(NamedTuple):
    """Visible pieces of a line from ``walk_line``, and buffers for their radiance, channel by channel.

    Piece ``j`` reaches from the sample ``begin[j]`` to ``sample[j]``; ``extent[j]`` is its length [m] and the tangent at its upper edge,
    ``arc[j]`` its middle [m], ``slope[j]`` its mean slope towards east and north, ``spread[j]`` the covariance (ee, en, nn) within it and
    ``foam[j]`` its share of foam, read at ``place[:, j]`` of a tile. ``mixed``: light of one piece of water and foam.
    """

    sample: np.ndarray
    begin: np.ndarray
    extent: np.ndarray
    arc: np.ndarray
    slope: np.ndarray
    spread: np.ndarray
    foam: np.ndarray
    place: np.ndarray
    light: np.ndarray
    mixed: np.ndarray


class Merging(NamedTuple):
    """Limits for merging neighbouring pieces: slope variance, elevation and tangent."""

    spread: float  #: Largest slope variance of merged pieces over the slope variance of their facets [1].
    #: Cells of elevation per radian; merged pieces share one, so that merging does not depend on where a view begins.
    cells: float
    highest: np.ndarray  #: Tangent of elevation up to which pieces are merged, at every level of detail (levels,).


@njit
def new_pieces(channels: int) -> Pieces:
    """Return buffers for ``BUFFER`` pieces."""
    return Pieces(
        np.empty(BUFFER, np.int64),
        np.empty(BUFFER, np.int64),
        np.empty((BUFFER, 2)),
        np.empty(BUFFER),
        np.empty((BUFFER, 2)),
        np.empty((BUFFER, 3)),
        np.zeros(BUFFER),
        np.empty((2, BUFFER)),
        np.empty((BUFFER, channels)),
        np.empty(channels),
    )


@kernel
def read_slopes(surface: Surface, line: SurfaceLine, range_m: np.ndarray, pieces: Pieces, count: int, strip: Strip) -> None:
    """Compute the middles of the first ``count`` pieces and the slopes there, equal to ``slopes`` to
    2e-5 of a cell.

    Pieces are read strip by strip, each within the range of positions of a strip.
    """
    v, u = strip.fraction
    for n in range(count):
        j = np.uint64(n)
        pieces.arc[j] = range_m[np.uint64(pieces.sample[j])] - 0.5 * pieces.extent[j, 0]
        pieces.slope[j, 0], pieces.slope[j, 1] = 0.0, 0.0
    finest = 1e-9
    for i in range(line.part.shape[0]):
        finest = max(finest, abs(line.step[i, 0, 0]) + abs(line.step[i, 0, 1]))
    # a quarter of the longest strip: readings count from a place up to a stretch before the first one
    stretch = 0.25 * LONGEST_STRIP / finest
    first = 0
    while first < count:
        # counted from fixed places, so that roundings do not depend on where a view begins
        begin, number = stretch * math.floor(pieces.arc[first] / stretch), min(STRIP, count - first)
        while number > 1 and pieces.arc[first + number - 1] >= begin + stretch:
            number -= 1
        for n in range(number):
            strip.arc[np.uint64(n)] = pieces.arc[np.uint64(first + n)] - begin
        for i in range(line.part.shape[0]):
            done = 0
            while done < number:
                done = address(line, i, begin, (done, number), strip)
            origin, row = np.uint64(line.part[i, 2]), np.uint64(line.part[i, 1] + 3)
            c, s = np.float32(line.turn[i, 0]), np.float32(line.turn[i, 1])
            for n in range(number):
                k, j = np.uint64(n), np.uint64(first + n)
                along, across = gradient(surface.lattice, origin + np.uint64(strip.cell[k]), row, u[k], v[k])
                pieces.slope[j, 0] += c * along - s * across
                pieces.slope[j, 1] += s * along + c * across
        first += number


@kernel
def foam_places(surface: Surface, level: int, line: SurfaceLine, t: int, away: tuple[float, float], pieces: Pieces, count: int) -> None:
    """Compute the places of the first ``count`` pieces on the foam of a tile into ``pieces.place`` [cells]."""
    foam, u, v, arc = surface.foam, pieces.place[0], pieces.place[1], pieces.arc
    j, done = foam.row[level, t], 0
    # ``position`` and ``wandered``, in loops that vectorise
    if j >= 0:
        ratio = float(foam.tile[t, 1]) / float(line.part[j, 1])
        while done < count:
            m, end = piece(line, j, arc[done]), done + 1
            knot = line.knot[j, 0] + (m + 1) / line.knot[j, 1] if m < line.part[j, 4] else math.inf
            while end < count and arc[end] < knot:
                end += 1
            start_u, start_v = ratio * line.start[j, m, 0], ratio * line.start[j, m, 1]
            step_u, step_v = ratio * line.step[j, m, 0], ratio * line.step[j, m, 1]
            for n in range(done, end):
                k = np.uint64(n)
                u[k], v[k] = start_u + arc[k] * step_u, start_v + arc[k] * step_v
            done = end
        return
    scale, c, s = foam.grid[t, 0], foam.grid[t, 1], foam.grid[t, 2]
    start_u, start_v = foam.grid[t, 3], foam.grid[t, 4]
    step_u, step_v = scale * (c * away[0] + s * away[1]), scale * (c * away[1] - s * away[0])
    for n in range(count):
        k = np.uint64(n)
        u[k], v[k] = start_u + arc[k] * step_u, start_v + arc[k] * step_v
    for w in range(foam.wander.shape[1]):
        move_u, move_v, phase = foam.wander[t, w, 0], foam.wander[t, w, 1], foam.wander[t, w, 4]
        along = foam.wander[t, w, 2] * away[0] + foam.wander[t, w, 3] * away[1]
        for n in range(count):
            k = np.uint64(n)
            height = sine(phase + arc[k] * along)
            u[k] += move_u * height
            v[k] += move_v * height


@kernel
def read_foam(surface: Surface, level: int, line: SurfaceLine, away: tuple[float, float], wide: float, pieces: Pieces, count: int) -> None:
    """Compute ``foam_share`` of the first ``count`` pieces, tile by tile.

    ``away``: unit vector of the line; ``wide``: its width [rad].
    """
    foam = surface.foam
    for n in range(count):
        pieces.foam[np.uint64(n)] = foam.even
    for t in range(foam.tile.shape[0]):
        foam_places(surface, level, line, t, away, pieces, count)
        wider, done = wide * foam.grid[t, 0], 0
        while done < count:
            first, marks, size, scale = foam_level(foam, t, wider * pieces.arc[done])
            # arcs increase: from here on to where the next level begins
            beyond = 2.0 * scale / wider if size > 2 else math.inf
            part, end = 1.0 / scale, done + 1
            while end < count and pieces.arc[end] < beyond:
                end += 1
            for n in range(done, end):
                k = np.uint64(n)
                width = wider * pieces.arc[k] * part
                pieces.foam[k] += level_share(foam, first, marks, size, pieces.place[0, k] * part, pieces.place[1, k] * part, width)
            done = end
    if foam.ships.segments.shape[0] > 0:
        for n in range(count):
            r = pieces.arc[np.uint64(n)]
            ship = segments_share(foam.ships, foam.origin[0] + r * away[0], foam.origin[1] + r * away[1])
            pieces.foam[np.uint64(n)] = max(pieces.foam[np.uint64(n)], ship)
    for n in range(count):
        r = pieces.arc[np.uint64(n)]
        pieces.foam[np.uint64(n)] = with_holes(foam, min(pieces.foam[np.uint64(n)], 1.0), away, r, wide * r)


@kernel
def merge(pieces: Pieces, count: int, lowest: float, rough: Roughness, limits: tuple[float, float, float, float]) -> int:
    """Merge neighbours among the first ``count`` pieces in place; return the number left.

    The first, which the view's edge may cut, stays alone.

    ``lowest``: tangent at the lower edge of the first; ``limits``: the fields of ``Merging`` at a level, and the elevation of the edge
    of a cell [rad].
    """
    # the test below is trace(inverse(facets) spread) <= limits[0], times the determinant: no division in the loop
    det = rough.east_east * rough.north_north - rough.east_north * rough.east_north
    limit = limits[0] * det if rough.east_east + rough.north_north > 0.0 else -1.0  # mirrors stay apart
    merged, n, below = 0, 0, lowest
    while n < count:
        j = np.uint64(n)
        begin, sample, top, length = pieces.sample[j], pieces.sample[j], pieces.extent[j, 1], pieces.extent[j, 0]
        east, north = pieces.slope[j, 0], pieces.slope[j, 1]
        # sums over slopes, counted from those of the first part
        weight = top - below
        sums = (0.0, 0.0, 0.0, 0.0, 0.0)
        mean, spread = (0.0, 0.0), (0.0, 0.0, 0.0)
        arc, foam = pieces.arc[j] * weight, pieces.foam[j] * weight
        cell = math.floor((limits[3] - elevation(top)) * limits[1])
        n += 1
        while n < count and merged > 0:
            k = np.uint64(n)
            above = pieces.extent[k, 1]
            if pieces.sample[k] != sample + 1 or above > limits[2] or math.floor((limits[3] - elevation(above)) * limits[1]) != cell:
                break
            w, e, f = above - top, pieces.slope[k, 0] - east, pieces.slope[k, 1] - north
            share = 1.0 / (weight + w)
            new_sums = (sums[0] + w * e, sums[1] + w * f, sums[2] + w * e * e, sums[3] + w * e * f, sums[4] + w * f * f)
            new_mean = (new_sums[0] * share, new_sums[1] * share)
            ee, en = new_sums[2] * share - new_mean[0] * new_mean[0], new_sums[3] * share - new_mean[0] * new_mean[1]
            nn = new_sums[4] * share - new_mean[1] * new_mean[1]
            if rough.north_north * ee - 2.0 * rough.east_north * en + rough.east_east * nn > limit:
                break
            sums, mean, spread = new_sums, new_mean, (ee, en, nn)
            arc, weight, length = arc + w * pieces.arc[k], weight + w, length + pieces.extent[k, 0]
            foam += w * pieces.foam[k]
            sample, top = pieces.sample[k], above
            n += 1
        at = np.uint64(merged)
        pieces.arc[at] = arc / weight if sample > begin else pieces.arc[j]
        pieces.foam[at] = foam / weight if sample > begin else pieces.foam[j]
        pieces.begin[at], pieces.sample[at] = begin, sample
        pieces.extent[at, 0], pieces.extent[at, 1] = length, top
        pieces.slope[at, 0], pieces.slope[at, 1] = east + mean[0], north + mean[1]
        pieces.spread[at, 0], pieces.spread[at, 1], pieces.spread[at, 2] = spread
        merged, below = merged + 1, top
    return merged
