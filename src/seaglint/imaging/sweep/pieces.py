"""Visible pieces of a line of sight, and neighbours of nearly equal slope merged to be shaded as one.

The walk finds a piece at every sample that rises above the horizon. Far away and with short waves many of them share a row of the image,
and neighbours differ by little beside the slopes that their facets carry. A merged piece has the mean slope of its parts, each weighted
with the elevation that it fills, and their covariance about it. That covariance is added to the facets' own, and their share that is seen
and lit is averaged over it (:func:`seaglint.facet.facet_sunlight.merged_share`): the mean of all parts, to second order in the slopes.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from seaglint.base.jit import kernel, njit
from seaglint.facet.roughness import Roughness
from seaglint.imaging.spline import gradient
from seaglint.imaging.sweep.walk import elevation
from seaglint.imaging.wave_surface import LONGEST_STRIP, STRIP, Strip, Surface, SurfaceLine, address

BUFFER = 1024  #: Number of visible pieces found before they are shaded; 150 kB stay in the processor's cache.


class Pieces(NamedTuple):
    """Visible pieces of a line from :func:`~seaglint.imaging.sweep.walk.walk_line`, and buffers for their radiance, channel by channel.

    Piece ``j`` reaches from the sample ``begin[j]`` to ``sample[j]``; ``extent[j]`` is its length [m] and the tangent at its upper edge,
    ``arc[j]`` its middle [m], ``slope[j]`` its mean slope towards east and north and ``spread[j]`` the covariance (ee, en, nn) within it.
    """

    sample: np.ndarray
    begin: np.ndarray
    extent: np.ndarray
    arc: np.ndarray
    slope: np.ndarray
    spread: np.ndarray
    light: np.ndarray


class Merging(NamedTuple):
    """Limits for merging neighbours: slope variance, elevation and tangent.

    The fields are their slope variance over that of their facets, cells of elevation per radian that they share (so that they do not depend
    on where a view begins), and at every level of detail the tangent of elevation up to which they are merged.
    """

    spread: float
    cells: float
    highest: np.ndarray


@njit
def new_pieces(channels: int) -> Pieces:
    """Buffers for :data:`BUFFER` pieces."""
    return Pieces(
        np.empty(BUFFER, np.int64),
        np.empty(BUFFER, np.int64),
        np.empty((BUFFER, 2)),
        np.empty(BUFFER),
        np.empty((BUFFER, 2)),
        np.empty((BUFFER, 3)),
        np.empty((BUFFER, channels)),
    )


@kernel
def read_slopes(surface: Surface, line: SurfaceLine, range_m: np.ndarray, pieces: Pieces, count: int, strip: Strip) -> None:
    """Read the middles of the first ``count`` pieces and the slopes there, as :func:`~seaglint.imaging.wave_surface.slopes` to 2e-5 of a
    cell.

    Strip by strip, within the range of positions in one.
    """
    v, u = strip.fraction
    for n in range(count):
        j = np.uint64(n)
        pieces.arc[j] = range_m[np.uint64(pieces.sample[j])] - 0.5 * pieces.extent[j, 0]
        pieces.slope[j, 0], pieces.slope[j, 1] = 0.0, 0.0
    finest = 1e-9
    for i in range(line.part.shape[0]):
        finest = max(finest, abs(line.step[i, 0, 0]) + abs(line.step[i, 0, 1]))
    stretch = 0.25 * LONGEST_STRIP / finest
    first = 0
    while first < count:
        # counted from fixed places, so that roundings do not depend on where a view begins
        begin, some = stretch * math.floor(pieces.arc[first] / stretch), min(STRIP, count - first)
        while some > 1 and pieces.arc[first + some - 1] >= begin + stretch:
            some -= 1
        for n in range(some):
            strip.arc[np.uint64(n)] = pieces.arc[np.uint64(first + n)] - begin
        for i in range(line.part.shape[0]):
            done = 0
            while done < some:
                done = address(line, i, begin, (done, some), strip)
            origin, row = np.uint64(line.part[i, 2]), np.uint64(line.part[i, 1] + 3)
            c, s = np.float32(line.turn[i, 0]), np.float32(line.turn[i, 1])
            for n in range(some):
                k, j = np.uint64(n), np.uint64(first + n)
                along, across = gradient(surface.lattice, origin + np.uint64(strip.cell[k]), row, u[k], v[k])
                pieces.slope[j, 0] += c * along - s * across
                pieces.slope[j, 1] += s * along + c * across
        first += some


@kernel
def merge(pieces: Pieces, count: int, lowest: float, rough: Roughness, limits: tuple[float, float, float, float]) -> int:
    """Merge neighbours among the first ``count`` pieces in place; return the number left.

    The first, which the view's edge may cut, stays alone.

    ``lowest``: tangent at the lower edge of the first; ``limits``: those of :class:`Merging` at a level, and the elevation of a cell's
    edge [rad].
    """
    det = rough.east_east * rough.north_north - rough.east_north * rough.east_north
    most = limits[0] * det if rough.east_east + rough.north_north > 0.0 else -1.0  # mirrors stay apart
    left, n, below = 0, 0, lowest
    while n < count:
        j = np.uint64(n)
        begin, sample, top, length = pieces.sample[j], pieces.sample[j], pieces.extent[j, 1], pieces.extent[j, 0]
        east, north = pieces.slope[j, 0], pieces.slope[j, 1]
        # sums over slopes, counted from those of the first part
        weight = top - below
        sums = (0.0, 0.0, 0.0, 0.0, 0.0)
        mean, spread = (0.0, 0.0), (0.0, 0.0, 0.0)
        arc = pieces.arc[j] * weight
        cell = math.floor((limits[3] - elevation(top)) * limits[1])
        n += 1
        while n < count and left > 0:
            k = np.uint64(n)
            above = pieces.extent[k, 1]
            if pieces.sample[k] != sample + 1 or above > limits[2] or math.floor((limits[3] - elevation(above)) * limits[1]) != cell:
                break
            w, e, f = above - top, pieces.slope[k, 0] - east, pieces.slope[k, 1] - north
            share = 1.0 / (weight + w)
            more = (sums[0] + w * e, sums[1] + w * f, sums[2] + w * e * e, sums[3] + w * e * f, sums[4] + w * f * f)
            middle = (more[0] * share, more[1] * share)
            ee, en = more[2] * share - middle[0] * middle[0], more[3] * share - middle[0] * middle[1]
            nn = more[4] * share - middle[1] * middle[1]
            if rough.north_north * ee - 2.0 * rough.east_north * en + rough.east_east * nn > most:
                break
            sums, mean, spread = more, middle, (ee, en, nn)
            arc, weight, length = arc + w * pieces.arc[k], weight + w, length + pieces.extent[k, 0]
            sample, top = pieces.sample[k], above
            n += 1
        at = np.uint64(left)
        pieces.arc[at] = arc / weight if sample > begin else pieces.arc[j]
        pieces.begin[at], pieces.sample[at] = begin, sample
        pieces.extent[at, 0], pieces.extent[at, 1] = length, top
        pieces.slope[at, 0], pieces.slope[at, 1] = east + mean[0], north + mean[1]
        pieces.spread[at, 0], pieces.spread[at, 1], pieces.spread[at, 2] = spread
        left, below = left + 1, top
    return left
