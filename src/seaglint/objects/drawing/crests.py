"""Sea in front of a body: its height along the lines of sight to the body, and what it hides.

Along a few azimuths the resolved waves are walked from where a crest could first touch the lowest line of sight to behind the body, as
finely as the picture has them there. At every place of the body the greatest elevation of the sea before it and the sea's own height are
then known. Without resolved waves the mean sea hides what is under it and what is behind its horizon.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from seaglint.base.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.base.conventions import FloatArray, horizon_depression, horizon_range
from seaglint.base.jit import kernel, njit
from seaglint.imaging.detail_levels import Levels
from seaglint.imaging.sweep.walk import sight_lines
from seaglint.imaging.wave_surface import STRIP, Surface, add_heights, course, new_strip

LINES_PER_WAVE = 4.0
"""Number of azimuth lines across the shortest resolved wave."""

MOST_LINES = 256
"""Largest number of azimuth lines of a body."""

ARCS_ACROSS = 24
"""Least number of arcs over the depth of a body."""

MOST_ARCS = 60_000
"""Largest number of arcs of a line: 15 km in steps of a quarter of a metre. Longer ways take longer steps."""

STEEP = 1.0
"""Tangent of depression beyond which no wave in front hides a body: slopes of resolved waves stay below it."""

_LOWEST = -1e9


class Crests(NamedTuple):
    """Sea along azimuth lines: greatest tangent of elevation up to each arc, and height there [m], (lines, arcs).

    The lines are given by ``azimuth`` of the first [rad] and lines per radian, with the arcs [m] of its samples. Without lines there is the
    mean sea: ``horizon``, its arc [m] and tangent. ``top``: greatest height [m] and tangent of all; what stands above both is in view.
    """

    azimuth: float
    per_radian: float
    arc: np.ndarray
    tangent: np.ndarray
    height: np.ndarray
    horizon: tuple[float, float]
    top: tuple[float, float]


def calm(eye: float) -> Crests:
    """Crests of the mean sea seen from a height [m]."""
    none = np.zeros((0, 0))
    horizon = (horizon_range(eye), -math.tan(horizon_depression(eye)))
    return Crests(0.0, 0.0, np.zeros(0), none, none, horizon, (0.0, horizon[1]))


class Span(NamedTuple):
    """Extent of a body in azimuth, arc and elevation.

    The fields are azimuths of its left and right [rad], arcs of its near and far end [m], its least and greatest tangent of elevation.
    """

    azimuth: tuple[float, float]
    arc: tuple[float, float]
    lowest: float
    highest: float


@njit
def _walk(surface: Surface, stage: np.ndarray, sights: np.ndarray, azimuths: np.ndarray, keep: int, out: np.ndarray) -> None:
    """Fill ``out[line, (tangent, height), arc]`` from arc ``keep`` on; ``sights``: arcs, rise, fall (:func:`sight_lines`).

    ``stage[s] = (level of detail, first arc, end)``.
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


def crests(levels: Levels, surface: Surface, eye: float, span: Span) -> Crests:
    """Compute the sea before and under a body, from a sensor ``eye`` above the mean sea [m]."""
    mean = calm(eye)
    if surface.part.shape[0] == 0:
        return mean
    top = float(surface.crest[0].max())
    near, far = max(span.arc[0], 0.0), span.arc[1]
    level = int(np.searchsorted(levels.begins, near, side="right")) - 1
    step = float(levels.steps[level]) if levels.steps[level] > 0.0 else 0.25 * float(levels.shortest[level])
    first = _first_arc(eye, span.lowest, near, top)
    ahead = np.arange(first, near, max(step, (near - first) / MOST_ARCS))
    inside = np.linspace(near, max(far, near + step), max(ARCS_ACROSS, math.ceil((far - near) / step)) + 1)
    arcs = np.concatenate([ahead, inside])
    keep = ahead.size
    left, right = span.azimuth
    wide = (right - left) * max(far, 1e-3)
    lines = min(max(math.ceil(wide * LINES_PER_WAVE / float(levels.shortest[level])) + 1, 3), MOST_LINES)
    azimuths = np.linspace(left, right, lines)
    at = np.searchsorted(levels.begins, arcs, side="right") - 1
    starts = np.flatnonzero(np.concatenate([[True], np.diff(at) != 0]))
    stage = np.stack([at[starts], starts, np.append(starts[1:], arcs.size)], axis=1).astype(np.int64)
    out = np.empty((lines, 2, arcs.size - keep))
    _walk(surface, stage, np.stack([arcs, *sight_lines(arcs, eye)]), azimuths, keep, out)
    per_radian = (lines - 1) / (right - left) if right > left else 0.0
    tangent, height = np.ascontiguousarray(out[:, 0]), np.ascontiguousarray(out[:, 1])
    return Crests(left, per_radian, arcs[keep:], tangent, height, mean.horizon, (float(height.max()), float(tangent.max())))


def _first_arc(eye: float, lowest: float, near: float, crest: float) -> float:
    """First arc at which a crest can reach the line of sight of tangent ``lowest``."""
    if lowest < -STEEP:
        return near
    arcs: FloatArray = np.linspace(0.0, near, 400)
    psi = arcs / EFFECTIVE_EARTH_RADIUS
    above = eye + EFFECTIVE_EARTH_RADIUS * np.sin(psi) * lowest + 2.0 * EFFECTIVE_EARTH_RADIUS * np.sin(0.5 * psi) ** 2
    below = np.flatnonzero(above < crest)
    return float(arcs[max(below[0] - 1, 0)]) if below.size else near


@kernel
def in_sight(crest: Crests, azimuth: float, arc: float, height: float, tangent: float) -> bool:
    """True if the sea does not hide a point, given by azimuth [rad], arc [m], height above the mean sea [m] and tangent of elevation."""
    lines, arcs = crest.tangent.shape
    if lines == 0:
        return bool(height >= 0.0 and (arc <= crest.horizon[0] or tangent >= crest.horizon[1]))
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
    if height < a + f * (b - a):
        return False
    if tangent < -STEEP:
        return True
    a = (1.0 - g) * crest.tangent[i, low] + g * crest.tangent[i, low + 1]
    b = (1.0 - g) * crest.tangent[i + 1, low] + g * crest.tangent[i + 1, low + 1]
    return bool(tangent >= a + f * (b - a))
