"""Reading the synthesised sea: bilinear interpolation on periodic lattices, at any level of detail, and bounds of its height.

A level of detail (:mod:`seaglint.sea.detail`) is a choice of lattices whose heights add up. A kernel that follows a horizontal line makes a
:func:`course` of it once: where it starts on every lattice of the level and how it moves over it.

Over each lattice stands a roof: for stretches of a given length, the highest point of the lattice around every block of it. The sum of the
roofs of a level says in a few look-ups that nothing of a stretch reaches a line of sight.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from seaglint._jit import njit
from seaglint.conventions import FloatArray
from seaglint.errors import DomainError

LEAPS = (8, 3)
"""Samples of a sweep that are passed over at once below a roof, longest leap first."""


class Surface(NamedTuple):
    """One instant of the sea.

    ``height`` [m] and ``slope[:, (east, north)]`` are all lattices one after another: ``part[i] = (first address, points along a side)``.
    Within a lattice squares of 4 x 4 points lie together in memory, because lines cross it in any direction; see :func:`bilinear`.
    ``grid[i] = (1/spacing, cos, sin of the lattice's turn, u, v under the sensor)``. ``level[l]``: parts of the level, -1 where there are
    no more; ``crest[l]``: largest height that the last part of the level adds, and that all of them add [m].
    ``roofs[l, leap, j] = (first address in roof, shift, mask)`` of the level's part ``j``.
    """

    height: np.ndarray
    slope: np.ndarray
    part: np.ndarray
    grid: np.ndarray
    level: np.ndarray
    crest: np.ndarray
    roof: np.ndarray
    roofs: np.ndarray


class Course(NamedTuple):
    """A horizontal line over the lattices of one level.

    ``start[j]``, ``step[j]``: position (u, v) at its beginning and its change per metre [cells]; ``part[j] = (first address, size)``.
    """

    start: np.ndarray
    step: np.ndarray
    part: np.ndarray


@njit
def course(surface: Surface, level: int, east: float, north: float) -> Course:
    """The line from under the sensor along a horizontal unit vector."""
    count = 0
    while count < surface.level.shape[1] and surface.level[level, count] >= 0:
        count += 1
    start, step, part = np.empty((count, 2)), np.empty((count, 2)), np.empty((count, 2), np.int64)
    for j in range(count):
        i = surface.level[level, j]
        scale, c, s = surface.grid[i, 0], surface.grid[i, 1], surface.grid[i, 2]
        start[j, 0], start[j, 1] = surface.grid[i, 3], surface.grid[i, 4]
        step[j, 0], step[j, 1] = (c * east + s * north) * scale, (c * north - s * east) * scale
        part[j, 0], part[j, 1] = surface.part[i, 0], surface.part[i, 1]
    return Course(start, step, part)


@njit
def corners(size: int, u: float, v: float) -> tuple[int, int, int, int, float, float]:
    """Address parts of the rows and columns around a lattice position (row, next row, column, next column), and its fractions (v, u).

    A row part plus a column part is the address of a lattice point. The lattice ``size`` is a power of two.
    """
    lower_u, lower_v = math.floor(u), math.floor(v)
    x0, y0 = int(lower_u) & (size - 1), int(lower_v) & (size - 1)
    x1, y1 = (x0 + 1) & (size - 1), (y0 + 1) & (size - 1)
    row0, row1 = (y0 >> 2) * 4 * size + (y0 & 3) * 4, (y1 >> 2) * 4 * size + (y1 & 3) * 4
    return row0, row1, (x0 >> 2) * 16 + (x0 & 3), (x1 >> 2) * 16 + (x1 & 3), v - lower_v, u - lower_u


@njit
def bilinear(surface: Surface, first: int, size: int, u: float, v: float) -> float:
    """Height of one lattice [m] between the four points around a position."""
    y0, y1, x0, x1, fy, fx = corners(size, u, v)
    y0, y1 = y0 + first, y1 + first
    a, b = surface.height[y0 + x0], surface.height[y0 + x1]
    c, d = surface.height[y1 + x0], surface.height[y1 + x1]
    low, high = a + fx * (b - a), c + fx * (d - c)
    return float(low + fy * (high - low))


@njit
def height(surface: Surface, line: Course, first: int, last: int, r: float) -> float:
    """Height of a level's parts ``first`` to ``last`` (not included) together [m], ``r`` metres along a line."""
    total = 0.0
    for j in range(first, last):
        u, v = line.start[j, 0] + r * line.step[j, 0], line.start[j, 1] + r * line.step[j, 1]
        total += bilinear(surface, line.part[j, 0], line.part[j, 1], u, v)
    return total


@njit
def slopes(surface: Surface, line: Course, r: float) -> tuple[float, float]:
    """Slopes of a level towards east and north [1], ``r`` metres along a line."""
    east, north = 0.0, 0.0
    for j in range(line.part.shape[0]):
        u, v = line.start[j, 0] + r * line.step[j, 0], line.start[j, 1] + r * line.step[j, 1]
        y0, y1, x0, x1, fy, fx = corners(line.part[j, 1], u, v)
        y0, y1 = y0 + line.part[j, 0], y1 + line.part[j, 0]
        a, b = (1.0 - fy) * (1.0 - fx), (1.0 - fy) * fx
        c, d = fy * (1.0 - fx), fy * fx
        east += a * surface.slope[y0 + x0, 0] + b * surface.slope[y0 + x1, 0]
        east += c * surface.slope[y1 + x0, 0] + d * surface.slope[y1 + x1, 0]
        north += a * surface.slope[y0 + x0, 1] + b * surface.slope[y0 + x1, 1]
        north += c * surface.slope[y1 + x0, 1] + d * surface.slope[y1 + x1, 1]
    return east, north


@njit
def roof(surface: Surface, line: Course, level: int, leap: int, r: float) -> float:
    """Height that no stretch of a leap's length around ``r`` metres along a line exceeds [m]."""
    total = 0.0
    for j in range(line.part.shape[0]):
        first, shift, mask = surface.roofs[level, leap, j, 0], surface.roofs[level, leap, j, 1], surface.roofs[level, leap, j, 2]
        x = (math.floor(line.start[j, 0] + r * line.step[j, 0]) >> shift) & mask
        y = (math.floor(line.start[j, 1] + r * line.step[j, 1]) >> shift) & mask
        total += surface.roof[first + y * (mask + 1) + x]
    return total


@njit
def raise_roof(lattice: np.ndarray, shift: int, out: np.ndarray) -> None:
    """Highest point in every block of ``2**shift`` points a side and its eight neighbours, on a periodic square lattice."""
    side = 1 << shift
    blocks = lattice.shape[0] >> shift
    plain = np.empty((blocks, blocks), np.float32)
    for y in range(blocks):
        for x in range(blocks):
            top = lattice[y * side, x * side]
            for j in range(y * side, (y + 1) * side):
                for i in range(x * side, (x + 1) * side):
                    top = max(top, lattice[j, i])
            plain[y, x] = top
    mask = blocks - 1
    rows = np.empty_like(plain)
    for y in range(blocks):
        for x in range(blocks):
            rows[y, x] = max(plain[y, (x - 1) & mask], max(plain[y, x], plain[y, (x + 1) & mask]))
    for y in range(blocks):
        for x in range(blocks):
            out[y * blocks + x] = max(rows[(y - 1) & mask, x], max(rows[y, x], rows[(y + 1) & mask, x]))


def calm_surface() -> Surface:
    """A sea without resolved waves."""
    flat, none = np.zeros(0, np.float32), np.zeros((0, 2), np.int64)
    level, roofs = np.full((1, 1), -1, np.int64), np.zeros((1, len(LEAPS), 1, 3), np.int64)
    return Surface(flat, np.zeros((0, 2), np.float32), none, np.zeros((0, 5)), level, np.zeros((1, 2)), flat.copy(), roofs)


def surface_of(
    lattices: tuple[NDArray[np.float32], ...],
    spacing: FloatArray,
    turn: FloatArray,
    levels: tuple[tuple[int, ...], ...] | None = None,
    steps: FloatArray | None = None,
    origin: tuple[float, float] = (0.0, 0.0),
) -> Surface:
    """Bundle the lattices of one instant.

    Parameters
    ----------
    lattices : tuple of ndarray
        Each (n, n, 3): height [m], slopes towards east and north; n a power of two, 4 or more.
    spacing, turn : ndarray
        Distance of lattice points [m] and turn from east [rad] of each.
    levels : tuple of tuples of int, optional
        Lattices of every level of detail, longest waves first; one of all by default.
    steps : ndarray, optional
        Step of the sweep at every level [m], for the roofs; the spacing of the level's last lattice by default.
    origin : (float, float)
        Point under the sensor, east and north [m].
    """
    sizes = np.array([z.shape[0] for z in lattices])
    for n in sizes:
        if n < 4 or n & (n - 1):
            raise DomainError(f"tiles of {n} points a side cannot be rendered; give a power of two, 4 or more")
    chosen = levels if levels is not None else (tuple(range(len(lattices))),)
    moves = steps if steps is not None else np.array([spacing[level[-1]] for level in chosen])
    squares = [z.reshape(n // 4, 4, n // 4, 4, 3).transpose(0, 2, 1, 3, 4).reshape(n * n, 3) for z, n in zip(lattices, sizes, strict=True)]
    together = np.concatenate(squares)
    c, s = np.cos(turn), np.sin(turn)
    # positions are periodic: small numbers keep their digits
    u, v = (np.mod(p / spacing, sizes) for p in (c * origin[0] + s * origin[1], c * origin[1] - s * origin[0]))
    highest = [float(z[..., 0].max()) for z in lattices]
    level = np.full((len(chosen), max(map(len, chosen))), -1, np.int64)
    for row, parts in zip(level, chosen, strict=True):
        row[: len(parts)] = parts
    return Surface(
        np.ascontiguousarray(together[:, 0]),
        np.ascontiguousarray(together[:, 1:]),
        np.stack([np.concatenate([[0], np.cumsum(sizes**2)[:-1]]), sizes], axis=1),
        np.stack([1.0 / spacing, c, s, u, v], axis=1),
        level,
        np.array([[highest[parts[-1]], sum(highest[p] for p in parts)] for parts in chosen]),
        *_roofs(lattices, sizes, spacing, level, moves),
    )


def _roofs(
    lattices: tuple[NDArray[np.float32], ...], sizes: NDArray[np.int64], spacing: FloatArray, level: NDArray[np.int64], steps: FloatArray
) -> tuple[NDArray[np.float32], NDArray[np.int64]]:
    """Roofs of all lattices and where each level finds those of its leaps."""
    where: dict[tuple[int, int], int] = {}
    made: list[NDArray[np.float32]] = []
    table = np.zeros((level.shape[0], len(LEAPS), level.shape[1], 3), np.int64)
    end = 0
    for i, parts in enumerate(level):
        for k, samples in enumerate(LEAPS):
            for j, part in enumerate(parts[parts >= 0]):
                # a stretch stays, with the points it is interpolated from, in the blocks around that of its middle
                cells = 0.5 * samples * steps[i] / spacing[part] + 1.0
                shift = min(math.ceil(math.log2(cells)), int(sizes[part]).bit_length() - 1)
                if (part, shift) not in where:
                    blocks = int(sizes[part]) >> shift
                    where[part, shift] = end
                    made.append(np.empty(blocks * blocks, np.float32))
                    raise_roof(lattices[part][..., 0], shift, made[-1])
                    end += blocks * blocks
                table[i, k, j] = where[part, shift], shift, (int(sizes[part]) >> shift) - 1
    return np.concatenate(made), table
