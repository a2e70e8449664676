"""Rasterisation of bodies: samples of their picture, the nearest triangle at each, the covered share of each cell, and shadow maps.

Samples are even in image coordinates, so that pixels are covered exactly, and are evaluated on the plane across the line of sight
(``TangentPlane``), where triangles have straight sides and one over the depth is linear. The position of
the sample differs from cell to cell (a lattice of two irrational turns): a thin body at any angle is hit in proportion to its width.

Shares of cells come from the outline instead, without sampling noise: edges between a triangle that faces the sensor and one that does not
wind once around every layer of the body that faces it. For layers one behind the other in a cell the share is their sum, at most 1.

A map of the surfaces that face away from the Sun gives the shadow of a body on itself.
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

import numpy as np

from seaglint.base.jit import kernel, njit
from seaglint.objects.drawing.eye import Grid, Lens, image_point

TURN_OF_ROWS = 0.6180339887498949
TURN_OF_COLUMNS = 0.7548776662466927  #: Steps of the sample positions from row to row and from column to column.

LEAST_BEND = 0.02  #: Curvature of an edge in the image above which it is divided into pieces [cells].

MOST_PIECES = 64


class Samples(NamedTuple):
    """Samples of a grid (rows, columns): plane coordinates, and the nearest triangle at each."""

    x: np.ndarray  #: Tangents to the right of the plane's centre.
    y: np.ndarray  #: Tangents up from the plane's centre.
    near: np.ndarray  #: One over the depth of the nearest triangle [1/m]; 0 without a triangle.
    triangle: np.ndarray  #: Number of the nearest triangle; -1 without a triangle.
    share: np.ndarray  #: Share of the cell that the body covers [1].


class Faces(NamedTuple):
    """Triangles on a plane and in the image."""

    point: np.ndarray  #: Vertices as tangents and one over the depth (n, 3).
    image: np.ndarray  #: Image points of the vertices [pixels, (n, 2)].
    corner: np.ndarray  #: Vertices of the triangles (m, 3).
    ends: np.ndarray  #: Vertices of the edges (``seaglint.objects.drawing.prepared_bodies.Mesh.ends``).
    sides: np.ndarray  #: Edges of the triangles (``seaglint.objects.drawing.prepared_bodies.Mesh.sides``).
    bend: float  #: Share of its size by which a side of a triangle may be curved in the image [1].


@kernel
def sample_place(i: int, j: int) -> tuple[float, float]:
    """Return the position of the sample within a cell, each coordinate in 0..1."""
    a, b = 0.5 + TURN_OF_ROWS * j, 0.5 + TURN_OF_COLUMNS * i
    return a - math.floor(a), b - math.floor(b)


@njit
def lay_samples(grid: Grid, lens: Lens, axes: np.ndarray) -> Samples:
    """Return the samples of a grid on the plane of ``axes``, without hits."""
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
            else:  # a cell is small: sines and cosines to second order in its angle
                u, v = column[i, 0] * (1.0 - 0.5 * dx * dx) + column[i, 1] * dx, column[i, 1] * (1.0 - 0.5 * dx * dx) - column[i, 0] * dx
                p, q = a * (1.0 - 0.5 * dy * dy) - b * dy, b * (1.0 - 0.5 * dy * dy) + a * dy
            u, v = p * u, p * v
            depth = turn[2, 0] * u + turn[2, 1] * v + turn[2, 2] * q
            if depth > 1e-3:
                x[j, i] = (turn[0, 0] * u + turn[0, 1] * v + turn[0, 2] * q) / depth
                y[j, i] = (turn[1, 0] * u + turn[1, 1] * v + turn[1, 2] * q) / depth
            else:
                x[j, i], y[j, i] = 1e9, 1e9
    return Samples(x, y, np.zeros((high, wide)), np.full((high, wide), -1, np.int32), np.zeros((high, wide)))


@kernel
def cell_range(low: float, high: float, cells: int, begin: int, size: int) -> tuple[int, int]:
    """Return the range of cells of a grid between two image points [pixels], as (first, end)."""
    a, b = math.floor(low * cells) - begin, math.floor(high * cells) + 1 - begin
    return int(max(a, 0)), int(min(b, size))


@njit
def meet(faces: Faces, grid: Grid, samples: Samples) -> None:
    """Store the nearest triangle that faces the sensor at each sample."""
    point, image = faces.point, faces.image
    for t in range(faces.corner.shape[0]):
        a, b, c = faces.corner[t, 0], faces.corner[t, 1], faces.corner[t, 2]
        if not (point[a, 2] > 0.0 and point[b, 2] > 0.0 and point[c, 2] > 0.0):
            continue
        ax, ay, bx, by, cx, cy = point[a, 0], point[a, 1], point[b, 0], point[b, 1], point[c, 0], point[c, 1]
        area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
        # counterclockwise triangles face the sensor
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


@njit
def outline(faces: Faces, lens: Lens, axes: np.ndarray, grid: Grid, samples: Samples) -> None:
    """Compute the shares of the cells that triangles cover, from their outline; after ``meet``.

    A covered cell with no hit at its sample gets triangle and depth of the edge through it. If some triangles are behind the camera, or
    over the pole of the image's angles, a hit covers its whole cell.
    """
    # a side that two triangles facing the sensor share is counted once in each sense and cancels: the outline remains
    high, wide = samples.share.shape
    count = np.zeros(faces.ends.shape[0], np.int32)
    owner = np.zeros(faces.ends.shape[0], np.int32)
    whole = faces.bend < 1.0
    for t in range(faces.corner.shape[0]):
        a, b, c = faces.corner[t, 0], faces.corner[t, 1], faces.corner[t, 2]
        p = faces.point
        if not (p[a, 2] > 0.0 and p[b, 2] > 0.0 and p[c, 2] > 0.0):
            whole = False
            break
        if (p[b, 0] - p[a, 0]) * (p[c, 1] - p[a, 1]) - (p[b, 1] - p[a, 1]) * (p[c, 0] - p[a, 0]) > 0.0:
            for k in range(3):
                side = faces.sides[t, k]
                edge = abs(side) - 1
                count[edge] += 1 if side > 0 else -1
                owner[edge] = t
    if not whole:
        for j in range(high):
            for i in range(wide):
                samples.share[j, i] = 1.0 if samples.near[j, i] > 0.0 else 0.0
        return
    border = np.zeros((high, wide + 2))
    for e in range(faces.ends.shape[0]):
        if count[e] == 0:
            continue
        a, b = faces.ends[e, 0], faces.ends[e, 1]
        start, end = faces.point[a], faces.point[b]
        column, row = faces.image[a, 0], faces.image[a, 1]
        across, down = (faces.image[b, 0] - column) * grid.cells[0], (faces.image[b, 1] - row) * grid.cells[1]
        bend = faces.bend * max(abs(across), abs(down))
        pieces = int(min(math.ceil(math.sqrt(bend / LEAST_BEND)), MOST_PIECES)) if bend > LEAST_BEND else 1
        x, y = column * grid.cells[0] - grid.begin[0], row * grid.cells[1] - grid.begin[1]
        for n in range(1, pieces + 1):
            f = n / pieces
            if n == pieces:
                column, row = faces.image[b, 0], faces.image[b, 1]
            else:
                u, v = start[0] + f * (end[0] - start[0]), start[1] + f * (end[1] - start[1])
                along = (
                    u * axes[0, 0] + v * axes[1, 0] + axes[2, 0],
                    u * axes[0, 1] + v * axes[1, 1] + axes[2, 1],
                    u * axes[0, 2] + v * axes[1, 2] + axes[2, 2],
                )
                column, row, _ = image_point(lens, along, column)
            ahead, below = column * grid.cells[0] - grid.begin[0], row * grid.cells[1] - grid.begin[1]
            near = start[2] + (f - 0.5 / pieces) * (end[2] - start[2])
            _run(border, samples, (x, y, ahead, below), float(count[e]), (near, owner[e]))
            x, y = ahead, below
    for j in range(high):
        total = 0.0
        for i in range(wide):
            total += border[j, i]
            if samples.near[j, i] > 0.0:
                samples.share[j, i] = min(max(total, 0.0), 1.0)


@njit
def _run(border: np.ndarray, samples: Samples, line: tuple[float, float, float, float], times: float, edge_hit: tuple[float, int]) -> None:
    """Add the area to the right of a descending line (x, y to x, y) [cells] to the changes of shares along rows.

    ``edge_hit``: inverse depth and triangle for cells on the line without a hit.
    """
    high, wide = samples.share.shape
    x0, y0, x1, y1 = line
    if y0 == y1:  # a horizontal line has no area to its right, but cells on it
        j = math.floor(y0)
        if 0 <= j < high:
            _touch(samples, j, max(math.floor(min(x0, x1)), 0), min(math.ceil(max(x0, x1)), wide), edge_hit)
        return
    if y0 > y1:
        times, x0, y0, x1, y1 = -times, x1, y1, x0, y0
    slope = (x1 - x0) / (y1 - y0)
    for j in range(max(math.floor(y0), 0), min(math.ceil(y1), high)):
        top, bottom = max(float(j), y0), min(j + 1.0, y1)
        d = times * (bottom - top)
        a, b = x0 + slope * (top - y0), x0 + slope * (bottom - y0)
        if a > b:
            a, b = b, a
        if a >= wide:
            continue
        if b <= 0.0:
            border[j, 0] += d
            continue
        if a < 0.0:  # left of the grid the whole first cell is to the right
            border[j, 0] += d * -a / (b - a)
            d, a = d * b / (b - a), 0.0
        if b > wide:
            d, b = d * (wide - a) / (b - a), float(wide)
        i, last = int(a), min(math.ceil(b), wide)
        _touch(samples, j, i, max(last, min(i + 1, wide)), edge_hit)
        # the mean share of cell k to the right of the line is the difference of the integral at its two sides
        done = 0.0
        for k in range(i, last + 1):
            part = _crossed(k + 1.0, a, b) - _crossed(float(k), a, b)
            border[j, k] += d * (part - done)
            done = part


@kernel
def _touch(samples: Samples, j: int, first: int, end: int, edge_hit: tuple[float, int]) -> None:
    """Set inverse depth and triangle of cells of a row without a hit."""
    for i in range(first, end):
        if samples.near[j, i] <= 0.0:
            samples.near[j, i], samples.triangle[j, i] = edge_hit


@kernel
def _crossed(x: float, a: float, b: float) -> float:
    """Return the integral up to x of the share of a line from a to b that is to the left of x."""
    if x <= a:
        return 0.0
    if x >= b:
        return x - 0.5 * (a + b)
    return 0.5 * (x - a) * (x - a) / (b - a)


@kernel
def in_semi_axes(gas: np.ndarray, direction: tuple[float, float, float]) -> tuple[float, float, float]:
    """Return a direction (unit, sensor's axes) in units of a plume's semi-axes [1/m]; ``gas`` as in ``chord``."""
    return (
        gas[3] * direction[0] + gas[4] * direction[1] + gas[5] * direction[2],
        gas[6] * direction[0] + gas[7] * direction[1] + gas[8] * direction[2],
        gas[9] * direction[0] + gas[10] * direction[1] + gas[11] * direction[2],
    )


@kernel
def chord(gas: np.ndarray, direction: tuple[float, float, float], first: float, last: float) -> float:
    """Return the length of a plume between two distances [m] along a direction (unit, sensor's axes), as a share of its longest chord [1].

    ``gas``: 13 numbers: centre in units of the semi-axes, from the sensor (3), rows of the matrix that converts a direction to these units
    (9), and the longest chord [m]; 0 in place of it makes shares relative to the longest chord in the direction.
    """
    ux, uy, uz = in_semi_axes(gas, direction)
    length = math.sqrt(ux * ux + uy * uy + uz * uz)
    middle = (gas[0] * ux + gas[1] * uy + gas[2] * uz) / length
    ox, oy, oz = gas[0] - middle * ux / length, gas[1] - middle * uy / length, gas[2] - middle * uz / length
    half = 1.0 - (ox * ox + oy * oy + oz * oz)
    if half <= 0.0:
        return 0.0
    half = math.sqrt(half)
    begin, end = max(middle - half, first * length), min(middle + half, last * length)
    inside = max(end - begin, 0.0)
    return float(min(inside / (length * gas[12]) if gas[12] > 0.0 else 0.5 * inside, 1.0))


@njit
def whole_solid_angle(faces: Faces, lens: Lens, samples: Samples, cell: tuple[float, float]) -> float:
    """Return the solid angle [sr] of triangles from samples that are ``cell`` apart on the plane itself, the image of ``lens``."""
    total = 0.0
    high, wide = samples.x.shape
    grid = Grid((0, 0), (wide, high), (1, 1), (0, 0), (wide, high))
    meet(faces, grid, samples)
    outline(faces, lens, lens.turn, grid, samples)
    for j in range(high):
        for i in range(wide):
            if samples.share[j, i] > 0.0:
                total += samples.share[j, i] * (1.0 + samples.x[j, i] ** 2 + samples.y[j, i] ** 2) ** -1.5
    return total * cell[0] * cell[1]


#: Least distance towards the Sun between a shading and a shaded surface, as a share of the body's size: rounding of its shadow map.
LIFT: Final = 1e-3


class SunMap(NamedTuple):
    """Shadow map: coordinates towards the Sun of the surfaces that face away from it, on a grid across its light.

    A map without cells shades no point.
    """

    sun: np.ndarray  #: Direction to the Sun (3,).
    across: np.ndarray  #: Unit vectors across it (2, 3).
    first: np.ndarray  #: Coordinates of the first cell [m] and cells per metre, each across and down (4,).
    nearest: np.ndarray  #: Greatest coordinate towards the Sun in each cell [m, (rows, columns)].
    lift: float  #: Least distance towards the Sun between a shading and a shaded point [m].


@kernel
def lit(shadow: SunMap, point: tuple[float, float, float]) -> bool:
    """Return True if no part of the body is between a point and the Sun."""
    if shadow.nearest.shape[0] == 0:
        return True
    a, f = shadow.across, shadow.first
    i = int((a[0, 0] * point[0] + a[0, 1] * point[1] + a[0, 2] * point[2] - f[0]) * f[2])
    j = int((a[1, 0] * point[0] + a[1, 1] * point[1] + a[1, 2] * point[2] - f[1]) * f[3])
    if i < 0 or j < 0 or i >= shadow.nearest.shape[1] or j >= shadow.nearest.shape[0]:
        return True
    along = shadow.sun[0] * point[0] + shadow.sun[1] * point[1] + shadow.sun[2] * point[2]
    return bool(shadow.nearest[j, i] <= along + shadow.lift)


@njit
def sun_map(vertex: np.ndarray, corner: np.ndarray, axes: tuple[np.ndarray, np.ndarray], cells: int, lift: float) -> SunMap:
    """Return the shadow map of triangles that face away from the Sun: a closed body shades itself by these, and no lit facet shades itself.

    ``axes``: direction to the Sun and unit vectors across it; ``cells``: number along a side; ``lift``: least distance of a shading surface
    from a shaded point [m].
    """
    sun, across = axes
    wide = high = cells
    nearest = np.full((high, wide), -np.inf)
    point = np.empty((vertex.shape[0], 3))
    low, top = np.full(2, np.inf), np.full(2, -np.inf)
    for n in range(vertex.shape[0]):
        east, north, up = vertex[n, 0], vertex[n, 1], vertex[n, 2]
        for k in range(2):
            point[n, k] = across[k, 0] * east + across[k, 1] * north + across[k, 2] * up
            low[k], top[k] = min(low[k], point[n, k]), max(top[k], point[n, k])
        point[n, 2] = sun[0] * east + sun[1] * north + sun[2] * up
    first = np.array([low[0], low[1], cells / max(top[0] - low[0], 1e-9), cells / max(top[1] - low[1], 1e-9)])
    for n in range(vertex.shape[0]):
        point[n, 0], point[n, 1] = (point[n, 0] - first[0]) * first[2], (point[n, 1] - first[1]) * first[3]
    for t in range(corner.shape[0]):
        a, b, c = corner[t, 0], corner[t, 1], corner[t, 2]
        ax, ay, bx, by, cx, cy = point[a, 0], point[a, 1], point[b, 0], point[b, 1], point[c, 0], point[c, 1]
        area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
        if area >= 0.0:
            continue
        # shares of b and c, and the coordinate towards the Sun, change linearly from cell to cell
        scale = 1.0 / area
        b_across, b_down, c_across, c_down = (cy - ay) * scale, (ax - cx) * scale, (ay - by) * scale, (bx - ax) * scale
        to_b, to_c = point[b, 2] - point[a, 2], point[c, 2] - point[a, 2]
        left, right = max(int(min(ax, bx, cx)), 0), min(int(max(ax, bx, cx)) + 1, wide)
        for j in range(max(int(min(ay, by, cy)), 0), min(int(max(ay, by, cy)) + 1, high)):
            dx, dy = left + 0.5 - ax, j + 0.5 - ay
            of_b, of_c = dx * b_across + dy * b_down, dx * c_across + dy * c_down
            for i in range(left, right):
                if of_b >= 0.0 and of_c >= 0.0 and of_b + of_c <= 1.0:
                    along = point[a, 2] + of_b * to_b + of_c * to_c
                    if along > nearest[j, i]:
                        nearest[j, i] = along
                of_b += b_across
                of_c += c_across
    return SunMap(sun, across, first, nearest, lift)
