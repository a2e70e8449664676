"""Launches of the kernels that draw bodies into a frame: allocation of their arrays and their runs.

The module is for bodies what ``seaglint.imaging.launch`` is for the sea. ``seaglint.objects.drawing.draw`` calls it in threads, one
for each part of a body.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Final

import numpy as np

from seaglint.base.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.base.conventions import FloatArray
from seaglint.imaging.scene import Levels
from seaglint.imaging.sweep.walk import sight_lines
from seaglint.imaging.wave_surface import Surface
from seaglint.objects.drawing.crests import STEEP, Crests, Span, calm, walk_crests
from seaglint.objects.drawing.eye import Grid, Lens, strips
from seaglint.objects.drawing.light import Arriving
from seaglint.objects.drawing.raster import Faces, Samples, SunMap, lay_samples, meet, outline, sun_map, whole_solid_angle
from seaglint.objects.drawing.sample_sums import PLANES, SUMS, BodySurroundings, SensorMesh, Window, clear_to, shade_gas, shade_solid

LINES_PER_WAVE = 4.0  #: Number of azimuth lines across the shortest wave in the picture at a body.

MOST_LINES = 256  #: Largest number of azimuth lines of a body.

ARCS_ACROSS = 24  #: Least number of arcs over the depth of a body.

MOST_ARCS = 60_000  #: Largest number of arcs of a line: 15 km in steps of a quarter of a metre. Longer lines have longer steps.

NOTHING: Final = np.zeros((0, 0))  #: Depths of other bodies before they are computed.

_OWN_PLANE: Final = Lens(np.eye(3), True, (0.0, 1.0), (0.0, 1.0), 1.0)


def part_planes(
    grid: Grid,
    camera: tuple[Lens, Window],
    faces: tuple[Faces, Sequence[Faces], Sequence[Faces]],
    body: SensorMesh | FloatArray,
    around: BodySurroundings,
    arriving: Arriving,
    shadow: SunMap,
) -> tuple[FloatArray, FloatArray]:
    """Draw one part on a separate grid of samples.

    Parameters
    ----------
    grid : Grid
        Cells of its samples.
    camera : (Lens, Window)
        Conversion of image points, and the pixels to draw.
    faces : (Faces, sequence of Faces, sequence of Faces)
        Faces of the part, of the solids that may be in front of it, and of the solids among these that belong to the same body.
    body : SensorMesh or ndarray
        Solid, or gas as in ``chord``.
    around : BodySurroundings
        Surroundings; this function computes the depths of other bodies.
    arriving, shadow : Arriving, SunMap
        Light at the sensor, and the body's shadow on itself.

    Returns
    -------
    planes, sums : ndarray
        ``PLANES`` of the grid's pixels (planes, rows, columns), and
        ``SUMS`` of their rows (sums, rows).
    """
    lens, window = camera
    planes, sums = np.zeros((PLANES, grid.pixels[1], grid.pixels[0])), np.zeros((SUMS, grid.pixels[1]))
    for strip in strips(grid):
        samples = lay_samples(strip, lens, around.axes)
        meet(faces[0], strip, samples)
        outline(faces[0], lens, around.axes, strip, samples)
        scene = around._replace(others=_depths(samples, strip, faces[1]), own=_depths(samples, strip, faces[2]) if faces[2] else NOTHING)
        rows = slice(strip.first[1] - grid.first[1], strip.first[1] - grid.first[1] + strip.pixels[1])
        out = (planes[:, rows], sums[:, rows])
        if isinstance(body, SensorMesh):
            shade_solid(strip, lens, window, samples, body, scene, arriving, shadow, out)
        else:
            shade_gas(strip, lens, window, samples, body, scene, arriving, out)
    return planes, sums


def _depths(samples: Samples, grid: Grid, solids: Sequence[Faces]) -> FloatArray:
    """Return the inverse depths of other bodies at the samples [1/m, (rows, columns)]; 0 without a body."""
    near = np.zeros_like(samples.near)
    if solids:
        triangle = np.full(near.shape, -1, np.int32)
        for faces in solids:
            meet(faces, grid, samples._replace(near=near, triangle=triangle))
    return near


def clear_to_point(around: BodySurroundings, solids: Sequence[Faces], distance: float) -> float:
    """Return the transmittance [1] to a point in the middle of the plane at a distance [m], through sea, solids and gases, without air."""
    x, y, near = np.zeros((3, 1, 1))
    samples = Samples(x, y, near, np.full((1, 1), -1, np.int32), np.ones((1, 1)))
    # image points of 0 put every triangle into the one cell: each is tested in the direction of the point
    ahead = [faces._replace(image=np.zeros_like(faces.image)) for faces in solids]
    grid = Grid((0, 0), (1, 1), (1, 1), (0, 0), (1, 1))
    return float(clear_to(around._replace(others=_depths(samples, grid, ahead)), distance))


def hit_cells(grid: Grid, lens: Lens, axes: FloatArray, faces: Faces) -> Iterator[tuple[Grid, np.ndarray]]:
    """Iterate over strips of a grid, with the cells whose samples a part covers (rows, columns)."""
    for strip in strips(grid):
        samples = lay_samples(strip, lens, axes)
        meet(faces, strip, samples)
        yield strip, samples.triangle >= 0


def sampled_solid(faces: Faces, x: FloatArray, y: FloatArray, cell: tuple[float, float]) -> tuple[float, Samples]:
    """Return the solid angle of a solid [sr] from samples at tangents ``x`` and ``y``, ``cell`` apart, and the samples."""
    samples = Samples(x, y, np.zeros(x.shape), np.full(x.shape, -1, np.int32), np.zeros(x.shape))
    return float(whole_solid_angle(faces, _OWN_PLANE, samples, cell)), samples


def shadow_map(vertex: FloatArray, corner: np.ndarray, axes: tuple[FloatArray, FloatArray], cells: int, lift: float) -> SunMap:
    """Return the shadow map of a body on itself; arguments as of ``sun_map``."""
    result: SunMap = sun_map(vertex, corner, axes, cells, lift)
    return result


def sea_before(levels: Levels, surface: Surface, eye: float, span: Span) -> Crests:
    """Compute the sea in front of a body and under it, for a sensor ``eye`` [m] above the mean sea."""
    mean = calm(eye)
    if surface.part.shape[0] == 0:
        return mean
    top = float(surface.crest[0].max())
    near, far = max(span.arc[0], 0.0), span.arc[1]
    # all waves of the sea, also where pixels are too wide to resolve the shortest: a few centimetres decide whether a low object is hidden
    step = float(levels.steps[0]) if levels.steps[0] > 0.0 else 0.25 * float(levels.shortest[0])
    first = _first_arc(eye, span.lowest, near, top)
    ahead = np.arange(first, near, max(step, (near - first) / MOST_ARCS))
    inside = np.linspace(near, max(far, near + step), max(ARCS_ACROSS, math.ceil((far - near) / step)) + 1)
    arcs = np.concatenate([ahead, inside])
    keep = ahead.size
    left, right = span.azimuth
    wide = (right - left) * max(far, 1e-3)
    # across the body the sea is as fine as in the picture
    coarse = float(levels.shortest[int(np.searchsorted(levels.begins, near, side="right")) - 1])
    lines = min(max(math.ceil(wide * LINES_PER_WAVE / coarse) + 1, 3), MOST_LINES)
    azimuths = np.linspace(left, right, lines)
    stage = np.array([[0, 0, arcs.size]], np.int64)
    out = np.empty((lines, 2, arcs.size - keep))
    walk_crests(surface, stage, np.stack([arcs, *sight_lines(arcs, eye)]), azimuths, keep, out)
    per_radian = (lines - 1) / (right - left) if right > left else 0.0
    tangent, height = np.ascontiguousarray(out[:, 0]), np.ascontiguousarray(out[:, 1])
    return Crests(left, per_radian, arcs[keep:], tangent, height, mean.horizon, (float(height.max()), float(tangent.max())))


def _first_arc(eye: float, lowest: float, near: float, crest: float) -> float:
    """Return the first arc at which a crest can reach the line of sight of tangent ``lowest`` [m]."""
    if lowest < -STEEP:
        return near
    arcs: FloatArray = np.linspace(0.0, near, 400)
    psi = arcs / EFFECTIVE_EARTH_RADIUS
    above = eye + EFFECTIVE_EARTH_RADIUS * np.sin(psi) * lowest + 2.0 * EFFECTIVE_EARTH_RADIUS * np.sin(0.5 * psi) ** 2
    below = np.flatnonzero(above < crest)
    return float(arcs[max(below[0] - 1, 0)]) if below.size else near
