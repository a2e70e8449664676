"""Sea in front of a body: its height along the lines of sight to the body, and what it hides.

The walk follows a few azimuths over all resolved waves, at any distance, from the first arc at which a crest could touch the lowest line of
sight to behind the body. For every place of the body it yields the greatest elevation of the sea in front and the height of the sea.
Without resolved waves the mean sea hides places below its surface and beyond its horizon.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from seaglint.base.conventions import horizon_depression, horizon_range
from seaglint.base.jit import kernel, njit
from seaglint.imaging.wave_surface import STRIP, Surface, add_heights, course, new_strip

STEEP = 1.0  #: Tangent of depression beyond which no wave in front hides a body: slopes of resolved waves stay below it.

_LOWEST = -1e9


class Crests(NamedTuple):
    """Sea along azimuth lines; without lines the mean sea."""

    azimuth: float  #: Azimuth of the first line [rad].
    per_radian: float  #: Lines per radian.
    arc: np.ndarray  #: Arcs of the samples of every line [m, (arcs,)].
    tangent: np.ndarray  #: Greatest tangent of elevation of the sea up to each arc [1, (lines, arcs)].
    height: np.ndarray  #: Height of the sea at each arc [m, (lines, arcs)].
    horizon: tuple[float, float]  #: Arc [m] and tangent of elevation of the mean sea's horizon.
    top: tuple[float, float]  #: Greatest height [m] and tangent of all samples; a point above both is in view.


def calm(eye: float) -> Crests:
    """Return the crests of the mean sea seen from a height [m]."""
    none = np.zeros((0, 0))
    horizon = (horizon_range(eye), -math.tan(horizon_depression(eye)))
    return Crests(0.0, 0.0, np.zeros(0), none, none, horizon, (0.0, horizon[1]))


class Span(NamedTuple):
    """Extent of a body in azimuth, arc and elevation."""

    azimuth: tuple[float, float]  #: Azimuths of its left and right end [rad].
    arc: tuple[float, float]  #: Arcs of its near and far end [m].
    lowest: float  #: Least tangent of elevation.
    highest: float  #: Greatest tangent of elevation.


@njit
def walk_crests(surface: Surface, stage: np.ndarray, sights: np.ndarray, azimuths: np.ndarray, keep: int, out: np.ndarray) -> None:
    """Fill ``out[line, (tangent, height), arc]`` from arc ``keep`` on.

    ``sights``: arcs, rise and fall (``sight_lines``); ``stage[s] = (level of detail, first arc, end)``.
    """
    arcs, rise, fall = sights[0], sights[1], sights[2]
    strip = new_strip()
    for n in range(azimuths.shape[0]):
        east, north = math.sin(azimuths[n]), math.cos(azimuths[n])
        highest = _LOWEST
        for s in range(stage.shape[0]):
            level, first, end = stage[s, 0], stage[s, 1], stage[s, 2]
            line = course(surface, level, east, north, (arcs[first], arcs[end - 1]))
            tiles = line.part.shape[0]
            at = first
            while at < end:
                count = min(STRIP, end - at)
                strip.height[:] = 0.0
                # strips before the body are left out where no crest can raise the skyline; strips at the body need their heights
                needed = at + count > keep
                j, seen = 0, True
                while j < tiles and seen:
                    if not needed:
                        seen = False
                        for k in range(count):
                            if rise[at + k] * (strip.height[k] + surface.crest[level, j]) - fall[at + k] > highest:
                                seen = True
                    if seen:
                        add_heights(surface, line, j, arcs, at, count, strip)
                        j += 1
                for k in range(count):
                    if seen:
                        highest = max(highest, rise[at + k] * strip.height[k] - fall[at + k])
                    if at + k >= keep:
                        out[n, 0, at + k - keep], out[n, 1, at + k - keep] = highest, strip.height[k]
                at += count


@kernel
def in_sight(crest: Crests, azimuth: float, arc: float, height: float, tangent: float) -> bool:
    """Return True if the sea does not hide a point of an azimuth [rad], arc [m], height above the mean sea [m] and tangent of elevation."""
    lines, arcs = crest.tangent.shape
    if lines == 0:
        return bool(height >= 0.0 and (arc <= crest.horizon[0] or tangent >= crest.horizon[1]))
    # linear between two lines and two arcs, of the heights first: they suffice for a point under water
    x = min(max((azimuth - crest.azimuth) * crest.per_radian, 0.0), lines - 1.0)
    i = min(int(x), lines - 2)
    low, high = 0, arcs - 1
    while high - low > 1:
        middle = (low + high) >> 1
        if crest.arc[middle] <= arc:
            low = middle
        else:
            high = middle
    f, g = x - i, min(max((arc - crest.arc[low]) / (crest.arc[low + 1] - crest.arc[low]), 0.0), 1.0)
    a = (1.0 - g) * crest.height[i, low] + g * crest.height[i, low + 1]
    b = (1.0 - g) * crest.height[i + 1, low] + g * crest.height[i + 1, low + 1]
    # under water
    if height < a + f * (b - a):
        return False
    # no crest in front reaches a steep line of sight
    if tangent < -STEEP:
        return True
    a = (1.0 - g) * crest.tangent[i, low] + g * crest.tangent[i, low + 1]
    b = (1.0 - g) * crest.tangent[i + 1, low] + g * crest.tangent[i + 1, low + 1]
    return bool(tangent >= a + f * (b - a))
