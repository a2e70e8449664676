"""Samples of a body's picture and which triangle each of them meets first.

Samples are laid in image coordinates, so that pixels are covered exactly, and looked up on the plane across the line of sight
(:class:`~seaglint.render.bodies.eye.Plane`), where triangles have straight sides and one over the depth is linear. Each cell has its sample
at a place of its own (a lattice of two irrational turns): thin bodies at any angle are met as often as they are wide.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from seaglint._jit import kernel, njit
from seaglint.render.bodies.eye import Grid, Lens

TURN_OF_ROWS = 0.6180339887498949
TURN_OF_COLUMNS = 0.7548776662466927
"""Turns of the samples' places from row to row and from column to column."""


class Samples(NamedTuple):
    """Samples of a grid (rows, columns): tangents to the right and up of the plane, one over the depth of what is met [1/m], 0 for nothing,
    and its triangle.
    """

    x: np.ndarray
    y: np.ndarray
    near: np.ndarray
    triangle: np.ndarray


class Faces(NamedTuple):
    """Triangles on a plane: tangents and one over the depth of vertices (n, 3), their image points (n, 2) [pixels], corners (m, 3), and the
    share of its size by which a triangle's sides may bend in the image.
    """

    point: np.ndarray
    image: np.ndarray
    corner: np.ndarray
    bend: float


@kernel
def sample_place(i: int, j: int) -> tuple[float, float]:
    """Place of a cell's sample within it, each way in 0..1."""
    a, b = 0.5 + TURN_OF_ROWS * j, 0.5 + TURN_OF_COLUMNS * i
    return a - math.floor(a), b - math.floor(b)


@njit
def lay_samples(grid: Grid, lens: Lens, axes: np.ndarray) -> Samples:
    """Samples of a grid on the plane of ``axes``, nothing met."""
    wide, high = grid.size
    x, y = np.empty((high, wide)), np.empty((high, wide))
    turn = np.zeros((3, 3))
    for k in range(3):
        for m in range(3):
            for n in range(3):
                turn[k, m] += axes[k, n] * lens.turn[n, m]
    step_x, step_y = lens.across[1] / grid.cells[0], lens.down[1] / grid.cells[1]
    column = np.empty((wide, 2))
    for i in range(wide):
        at = lens.across[0] + step_x * (grid.begin[0] + i)
        column[i, 0], column[i, 1] = (at, 1.0) if lens.plane else (math.sin(at), math.cos(at))
    for j in range(high):
        at = lens.down[0] + step_y * (grid.begin[1] + j)
        a, b = (1.0, at) if lens.plane else (math.cos(at), math.sin(at))
        for i in range(wide):
            place = sample_place(grid.begin[0] + i, grid.begin[1] + j)
            dx, dy = place[0] * step_x, place[1] * step_y
            if lens.plane:
                u, v, p, q = column[i, 0] + dx, 1.0, 1.0, b + dy
            else:  # a cell is small: to second order in its own angle
                u, v = column[i, 0] * (1.0 - 0.5 * dx * dx) + column[i, 1] * dx, column[i, 1] * (1.0 - 0.5 * dx * dx) - column[i, 0] * dx
                p, q = a * (1.0 - 0.5 * dy * dy) - b * dy, b * (1.0 - 0.5 * dy * dy) + a * dy
            u, v = p * u, p * v
            depth = turn[2, 0] * u + turn[2, 1] * v + turn[2, 2] * q
            if depth > 1e-3:
                x[j, i] = (turn[0, 0] * u + turn[0, 1] * v + turn[0, 2] * q) / depth
                y[j, i] = (turn[1, 0] * u + turn[1, 1] * v + turn[1, 2] * q) / depth
            else:
                x[j, i], y[j, i] = 1e9, 1e9
    return Samples(x, y, np.zeros((high, wide)), np.full((high, wide), -1, np.int32))


@kernel
def cell_range(low: float, high: float, cells: int, begin: int, size: int) -> tuple[int, int]:
    """Cells of a grid between two image points [pixels], as (first, end)."""
    a, b = math.floor(low * cells) - begin, math.floor(high * cells) + 1 - begin
    return int(max(a, 0)), int(min(b, size))


@njit
def meet(faces: Faces, grid: Grid, samples: Samples) -> None:
    """Find the nearest triangle that faces the sensor, for each sample."""
    point, image = faces.point, faces.image
    for t in range(faces.corner.shape[0]):
        a, b, c = faces.corner[t, 0], faces.corner[t, 1], faces.corner[t, 2]
        if not (point[a, 2] > 0.0 and point[b, 2] > 0.0 and point[c, 2] > 0.0):
            continue
        ax, ay, bx, by, cx, cy = point[a, 0], point[a, 1], point[b, 0], point[b, 1], point[c, 0], point[c, 1]
        area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
        if area <= 0.0:
            continue
        left, right = min(image[a, 0], image[b, 0], image[c, 0]), max(image[a, 0], image[b, 0], image[c, 0])
        top, bottom = min(image[a, 1], image[b, 1], image[c, 1]), max(image[a, 1], image[b, 1], image[c, 1])
        margin = faces.bend * max(right - left, bottom - top)
        i0, i1 = cell_range(left - margin, right + margin, grid.cells[0], grid.begin[0], grid.size[0])
        j0, j1 = cell_range(top - margin, bottom + margin, grid.cells[1], grid.begin[1], grid.size[1])
        if i0 >= i1 or j0 >= j1:
            continue
        scale = 1.0 / area
        near, along_b, along_c = point[a, 2], (point[b, 2] - point[a, 2]) * scale, (point[c, 2] - point[a, 2]) * scale
        for j in range(j0, j1):
            for i in range(i0, i1):
                dx, dy = samples.x[j, i] - ax, samples.y[j, i] - ay
                # twice the areas opposite b and c
                of_b = dx * (cy - ay) - dy * (cx - ax)
                of_c = (bx - ax) * dy - (by - ay) * dx
                if of_b >= 0.0 and of_c >= 0.0 and of_b + of_c <= area:
                    depth = near + of_b * along_b + of_c * along_c
                    if depth > samples.near[j, i]:
                        samples.near[j, i] = depth
                        samples.triangle[j, i] = t


@kernel
def chord(gas: np.ndarray, direction: tuple[float, float, float], first: float, last: float) -> float:
    """Optical depth of a plume between two distances [m] along a direction (unit, sensor's axes).

    ``gas``: its centre in units of its semi-axes, from the sensor (3), rows that turn a direction into these units (9), and the optical
    depth of its middle.
    """
    ux = gas[3] * direction[0] + gas[4] * direction[1] + gas[5] * direction[2]
    uy = gas[6] * direction[0] + gas[7] * direction[1] + gas[8] * direction[2]
    uz = gas[9] * direction[0] + gas[10] * direction[1] + gas[11] * direction[2]
    length = math.sqrt(ux * ux + uy * uy + uz * uz)
    middle = (gas[0] * ux + gas[1] * uy + gas[2] * uz) / length
    ox, oy, oz = gas[0] - middle * ux / length, gas[1] - middle * uy / length, gas[2] - middle * uz / length
    half = 1.0 - (ox * ox + oy * oy + oz * oz)
    if half <= 0.0:
        return 0.0
    half = math.sqrt(half)
    begin, end = max(middle - half, first * length), min(middle + half, last * length)
    return float(gas[12] * max(end - begin, 0.0) * 0.5)


@njit
def whole_solid_angle(faces: Faces, samples: Samples, cell: tuple[float, float]) -> float:
    """Solid angle [sr] of triangles from samples that lie ``cell`` apart on the plane itself."""
    total = 0.0
    high, wide = samples.x.shape
    meet(faces, Grid((0, 0), (wide, high), (1, 1), (0, 0), (wide, high)), samples)
    for j in range(high):
        for i in range(wide):
            if samples.near[j, i] > 0.0:
                total += (1.0 + samples.x[j, i] ** 2 + samples.y[j, i] ** 2) ** -1.5
    return total * cell[0] * cell[1]
