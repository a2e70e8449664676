"""The sweep: walk outward along each azimuth, keep the highest elevation seen so far, and shade what rises above it.

Every surface piece above the running horizon is visible and covers a known interval of elevation; its radiance, taken at the middle of that
interval, is added to the pixels in proportion to the overlap. So a column has no sampling noise in elevation, its own horizon, and any width of panorama.
Most samples are hidden at grazing views: stretches whose ceiling stays below the line of sight are stepped over, which gives exactly the image
of the full walk at a fraction of its samples.

Across a column, lines part as the column widens: one line near the sensor, two where half a shortest wave no longer spans the column, and so on
up to a limit. From there on the sea is sampled, not averaged, across a column.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numba
import numpy as np

from seaglint._jit import njit, njit_inline, njit_parallel
from seaglint.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.conventions import FloatArray, horizon_depression, horizon_range, surface_range
from seaglint.render.camera import Camera
from seaglint.render.facet import FacetOptics, FacetTables, Roughness, Sight, Sunlight, facet_radiance, line_of_sight
from seaglint.render.surface import STRIDES, Surface, ceiling, height, slopes

RANGE_PARTS = 0.5
"""Largest step as a share of the ground seen by one pixel row, so that near pixels are made of several pieces."""

CALM_PARTS = 4
"""Pieces per pixel row where no waves are resolved."""


class Walk(NamedTuple):
    """Samples along every line: arcs from the sensor's foot and what depends on them alone.

    ``range_m, cosine, sine_arc, drop``: arc r, cos(r/R'), R' sin(r/R') and h + R' (1 - cos(r/R')) at the samples.
    ``coefficients, path`` belong to the middle of the piece that ends at a sample. ``parting``: first sample, those at which every line of
    a column becomes two, and the number of samples.
    """

    range_m: np.ndarray
    cosine: np.ndarray
    sine_arc: np.ndarray
    drop: np.ndarray
    coefficients: np.ndarray
    path: np.ndarray
    parting: np.ndarray


class Frame(NamedTuple):
    """Rows of the image: elevation of the upper edge, 1/row step, number of rows, and the sky's radiance in each."""

    top: float
    per_radian: float
    rows: int
    bottom_tangent: float
    sky: np.ndarray


@njit
def graded_ranges(first: float, last: float, step: float, height: float, row_step: float) -> np.ndarray:
    """Arcs from ``first`` to ``last`` in steps of at most ``step`` and of :data:`RANGE_PARTS` of a pixel row's ground [m]."""
    size = 1
    for fill in range(2):
        out = np.empty(size)
        r, i = first, 0
        while True:
            if fill:
                out[i] = r
            if r >= last:
                break
            r += min(step, max(RANGE_PARTS * row_step * (r * r + height * height) / height, 1e-3 * height))
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


@njit_inline
def sight_height(walk: Walk, i: int, tangent: float) -> float:
    """Height at sample ``i`` of the line of sight with this tangent of elevation [m]; what is higher is visible."""
    return (tangent * walk.sine_arc[i] + walk.drop[i]) / (walk.cosine[i] - tangent * walk.sine_arc[i] / EFFECTIVE_EARTH_RADIUS)


@njit_inline
def tangent_of(walk: Walk, i: int, z: float) -> float:
    """Tangent of the elevation at which a height is seen."""
    return (z * walk.cosine[i] - walk.drop[i]) / (walk.sine_arc[i] * (1.0 + z / EFFECTIVE_EARTH_RADIUS) + 1e-300)


@njit_inline
def hidden_stretch(walk: Walk, surface: Surface, sight: Sight, i: int, tangent: float, level: int) -> bool:
    """Whether the sea stays below the line of sight from sample ``i`` on over the ceiling's reach."""
    r = walk.range_m[i]
    # the line of sight is convex over the round sea: its tangent here is a lower bound further out
    fall = max(-tangent - r / EFFECTIVE_EARTH_RADIUS, 0.0)
    return ceiling(surface, level, -r * sight.east, -r * sight.north) < sight_height(walk, i, tangent) - fall * surface.reach[level]


@njit_inline
def add_rows(image: np.ndarray, frame: Frame, low: float, high: float, value: float) -> None:
    """Add ``value`` to the rows between two elevations, in proportion to the overlap."""
    upper = max((frame.top - high) * frame.per_radian, 0.0)
    lower = min((frame.top - low) * frame.per_radian, float(frame.rows))
    row = int(upper)
    while row < lower:
        image[row] += value * (min(lower, row + 1.0) - max(upper, float(row)))
        row += 1


@njit_inline
def piece(walk: Walk, optics: FacetOptics, surface: Surface, sight: Sight, i: int, back: float, tangent: float) -> tuple[float, float]:
    """Thermal radiance (with the path's) and solar radiance of the piece that ends at sample ``i``, read ``back`` metres before it."""
    r = walk.range_m[i] - back
    slope = slopes(surface, -r * sight.east, -r * sight.north)
    # the grazing angle is the depression less the arc's angle
    cosine = 1.0 / math.sqrt(1.0 + tangent * tangent)
    sine_arc = walk.sine_arc[i] / EFFECTIVE_EARTH_RADIUS
    grazing_sine = -cosine * (tangent * walk.cosine[i] + sine_arc)
    grazing_cosine = cosine * (walk.cosine[i] - tangent * sine_arc)
    thermal, solar = facet_radiance(optics, walk.coefficients, i, sight, (grazing_sine, grazing_cosine), slope)
    return thermal + walk.path[i], solar


@njit
def sweep_line(
    walk: Walk,
    frame: Frame,
    surface: Surface,
    optics: FacetOptics,
    sight: Sight,
    part: tuple[int, int, float, float],
    total: np.ndarray,
    sun: np.ndarray,
) -> float:
    """Walk one line over the samples ``part = (first, end, weight, tangent of the horizon so far)``; returns that tangent at the end.

    Radiance times the weight is added to the rows of ``total``, its solar part to those of ``sun``.
    """
    i, end, weight, tangent = part
    elevation = math.atan(tangent)
    last_above, level, top_level = i - 1, 0, surface.reach.shape[0] - 1
    waves = surface.height.shape[0] > 0
    while i < end and elevation < frame.top:
        if waves and level >= 0:
            if hidden_stretch(walk, surface, sight, i, tangent, level):
                i += STRIDES[level]
                level = min(level + 1, top_level)
                continue
            level -= 1
            if level >= 0:
                continue
        r = walk.range_m[i]
        z = height(surface, -r * sight.east, -r * sight.north)
        above = z - sight_height(walk, i, tangent)
        if above < 0.0:
            i += 1
            level = 0
            continue
        start = 0.0
        if i > 0 and last_above != i - 1:
            before = walk.range_m[i - 1]
            below = sight_height(walk, i - 1, tangent) - height(surface, -before * sight.east, -before * sight.north)
            start = max(below, 0.0) / (max(below, 0.0) + above + 1e-30)
        new_tangent = tangent_of(walk, i, z)
        new_elevation = math.atan(new_tangent)
        if new_elevation > elevation:
            if i > 0:
                back = 0.5 * (1.0 - start) * (r - walk.range_m[i - 1])
                thermal, solar = piece(walk, optics, surface, sight, i, back, 0.5 * (max(tangent, -1e3) + new_tangent))
                add_rows(total, frame, elevation, new_elevation, weight * (thermal + solar))
                add_rows(sun, frame, elevation, new_elevation, weight * solar)
            tangent, elevation = new_tangent, new_elevation
        last_above, level = i, -1
        i += 1
    return tangent


@njit
def add_sky(frame: Frame, tangent: float, weight: float, total: np.ndarray) -> None:
    """Fill the rows above the horizon that a line ended with."""
    upper = (frame.top - math.atan(tangent)) * frame.per_radian
    for row in range(min(frame.rows, int(math.ceil(max(upper, 0.0))))):
        total[row] += weight * frame.sky[row] * (min(upper, row + 1.0) - row)


@njit
def sweep_column(
    walk: Walk, frame: Frame, surface: Surface, optics: FacetOptics, centre: float, width: float, total: np.ndarray, sun: np.ndarray
) -> None:
    """Add one column of azimuth ``centre`` and ``width`` [rad]; ``walk.parting`` are the samples at which every line becomes two."""
    stages = walk.parting.shape[0] - 1
    tangents = np.full(1, frame.bottom_tangent)
    for stage in range(stages):
        lines = tangents.shape[0]
        for j in range(lines):
            azimuth = centre + width * ((j + 0.5) / lines - 0.5)
            sight = line_of_sight(optics, azimuth)
            part = (walk.parting[stage], walk.parting[stage + 1], 1.0 / lines, tangents[j])
            tangents[j] = sweep_line(walk, frame, surface, optics, sight, part, total, sun)
        if stage + 1 < stages:
            tangents = np.repeat(tangents, 2)
    for tangent in tangents:
        add_sky(frame, tangent, 1.0 / tangents.shape[0], total)


@njit_parallel
def sweep_columns(
    walk: Walk,
    frame: Frame,
    surface: Surface,
    sunlight: Sunlight,
    roughness: Roughness,
    tables: FacetTables,
    azimuths: np.ndarray,
    width: float,
    images: np.ndarray,
) -> None:
    """Fill ``images``, (2, columns, rows): radiance and its solar part, for columns at ``azimuths`` of a ``width`` [rad].

    Columns do not depend on each other. Numba's parallel loops take no nested tuples, so the facet's parts come one by one.
    """
    for column in numba.prange(azimuths.shape[0]):
        total, sun = np.zeros(frame.rows), np.zeros(frame.rows)
        sweep_column(walk, frame, surface, FacetOptics(sunlight, roughness, tables), azimuths[column], width, total, sun)
        images[0, column], images[1, column] = total, sun
