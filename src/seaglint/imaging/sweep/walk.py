"""Walk outward along a line of sight: positions of samples, and pieces of sea that rise above the skyline.

Detail falls with range: where a column has grown wider than half the waves of a level's last octave (:mod:`seaglint.sea.detail`),
that octave goes to the facets and steps grow. Most samples are hidden at grazing views: strips of them are passed over where the largest
heights of the lattices (:mod:`seaglint.imaging.wave_surface`) stay below the line of sight, and the image is that of the full walk.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from seaglint.base.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.base.conventions import FloatArray, horizon_depression, horizon_range, surface_range
from seaglint.base.jit import kernel, njit
from seaglint.facet.facet_tables import PathTerms
from seaglint.imaging.camera.image_grid import Camera
from seaglint.imaging.wave_surface import STRIP, Strip, Surface, SurfaceLine, add_heights, height

RANGE_PARTS = 0.5  #: Largest step as a share of the ground seen by one pixel row, so that near pixels consist of several pieces.

PATH_EVERY = 16  #: Number of samples between two at which the path is known, where waves are resolved.

CALM_PARTS = 4  #: Number of pieces per pixel row where no waves are resolved.


class Walk(NamedTuple):
    """Samples along every line: arcs from the sensor's foot and the quantities that depend on them alone.

    ``range_m``: the arcs; ``eye``: height of the sensor [m]. A height ``z`` is seen at the tangent ``rise z - fall``, to first order in
    ``z`` over the Earth's radius. ``path`` stands at every ``every``-th sample, from the first to one past the last; linear between.
    ``stage[s] = (first sample, level of detail, how often every line parts in two at its beginning)``, and the number of samples in a
    last row. ``shadow[l]``: step [m] and steepest rise of shadow rays at every level; a step of 0 where waves cast none.
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
    """Arcs at equal steps of elevation, dense at the horizon, for a sea without resolved waves [m]."""
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


def stages(arcs: FloatArray, begins: FloatArray, parts: FloatArray) -> NDArray[np.int64]:
    """Row numbers of :attr:`Walk.stage` for samples at ``arcs`` [m].

    Level ``l`` begins at the arc ``begins[l]``; at each of ``parts`` the lines of a column part in two. They never join again, as each
    has its own horizon.
    """
    level = np.searchsorted(begins, arcs, side="right") - 1
    parted = np.searchsorted(parts, arcs, side="right")
    starts = np.flatnonzero(np.concatenate([[True], (np.diff(level) != 0) | (np.diff(parted) != 0)]))
    doublings = np.diff(parted[starts], prepend=0)
    return np.concatenate([np.stack([starts, level[starts], doublings], axis=1), [[arcs.size, 0, 0]]]).astype(np.int64)


def sight_lines(arcs: FloatArray, height: float) -> tuple[FloatArray, FloatArray]:
    """Arrays :attr:`Walk.rise` [1/m] and :attr:`Walk.fall` [1] of samples at ``arcs`` [m].

    The sensor is ``height`` above the mean sea [m].
    """
    psi = arcs / EFFECTIVE_EARTH_RADIUS
    # straight below the sensor the tangent is infinite: it is evaluated a nanometre aside
    reach = np.maximum(EFFECTIVE_EARTH_RADIUS * np.sin(psi), 1e-9)
    below = height + 2.0 * EFFECTIVE_EARTH_RADIUS * np.sin(0.5 * psi) ** 2
    return (np.cos(psi) + below / EFFECTIVE_EARTH_RADIUS) / reach, below / reach


@kernel
def bend(range_m: float) -> tuple[float, float, float]:
    """Cosine of an arc's angle on the effective sphere, ``R' sin`` of it and ``R' (1 - cos)`` [m].

    Series to the third term: within 1e-10 of the arc up to 500 km.
    """
    psi = range_m * (1.0 / EFFECTIVE_EARTH_RADIUS)
    square = psi * psi
    sagitta = 0.5 * psi * (1.0 - square * (1.0 / 12.0) * (1.0 - square * (1.0 / 30.0)))
    return 1.0 - psi * sagitta, range_m * (1.0 - square * (1.0 / 6.0) * (1.0 - square * (1.0 / 20.0))), range_m * sagitta


@kernel
def elevation(tangent: float) -> float:
    """Elevation from its tangent: arc tangent, by a series within 1e-12 where it is small."""
    if abs(tangent) > 0.1:
        return math.atan(tangent)
    t = tangent * tangent
    return tangent * (1.0 - t * (1.0 / 3.0 - t * (0.2 - t * (1.0 / 7.0 - t * (1.0 / 9.0 - t / 11.0)))))


@kernel
def in_view(walk: Walk, strip: Strip, first: int, count: int, crest: float, tangent: float) -> bool:
    """True where a height of the strip, raised by ``crest`` [m], stands above the line of sight of this tangent."""
    # unsigned, as an address that could be negative is looked at once more
    seen, at = np.int64(0), np.uint64(first)
    for n in range(count):
        k = np.uint64(n)
        seen += walk.rise[at + k] * (strip.height[k] + crest) - walk.fall[at + k] > tangent
    return bool(seen > 0)


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

    ``horizon``: tangents of the highest elevation seen before and of the image's upper edge. Piece ``j`` ends at the sample ``sample[j]``;
    its length is ``piece[j, 0]`` [m] and the tangent at its upper edge ``piece[j, 1]``; its lower edge is the upper one of the piece
    before. Returns the number of pieces, the sample to go on with (or ``end``) and the last tangent.
    """
    i, end = part
    tangent, top = horizon
    number, tiles = 0, line.part.shape[0]
    while i < end and tangent < top and number + STRIP <= sample.shape[0]:
        count = min(STRIP, end - i)
        strip.height[:] = 0.0
        j = 0
        # first with the highest crest of all: beyond the horizon almost no sample has to be read
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
                    # between two samples the sea may come into view
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
