"""Reading the synthesised sea at a point: bilinear interpolation on periodic tiles."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from seaglint._jit import njit, njit_inline
from seaglint.conventions import FloatArray
from seaglint.errors import DomainError


class Surface(NamedTuple):
    """One instant of the sea.

    ``height[i, a]`` [m] and ``slope[i, a] = (east, north)`` are the lattices of tile ``i`` at the address ``a`` of :func:`corners`:
    squares of 4 x 4 points lie together in memory, because lines cross the lattice in any direction. ``size`` is the number of points
    along a side;
    ``grid[i] = (1/spacing, cos, sin of the tile's turn)``. ``crest``: largest height that the last tile, of the shortest waves, adds
    [m]; ``curvature``: largest curvature along any line of all other tiles together [1/m].
    """

    size: int
    height: np.ndarray
    slope: np.ndarray
    grid: np.ndarray
    crest: float
    curvature: float


@njit_inline
def lattice_line(surface: Surface, east: float, north: float) -> np.ndarray:
    """Lattice steps (tiles, 2) along u and v of every tile per metre along a horizontal unit vector [1/m]."""
    out = np.empty((surface.height.shape[0], 2))
    for tile in range(out.shape[0]):
        out[tile, 0] = (surface.grid[tile, 1] * east + surface.grid[tile, 2] * north) * surface.grid[tile, 0]
        out[tile, 1] = (surface.grid[tile, 1] * north - surface.grid[tile, 2] * east) * surface.grid[tile, 0]
    return out


@njit_inline
def corners(size: int, u: float, v: float) -> tuple[int, int, int, int, float, float]:
    """Address parts of the rows and columns around a lattice position (row, next row, column, next column), and its fractions (v, u).

    A row part plus a column part is the address of a lattice point. The lattice ``size`` is a power of two.
    """
    lower_u, lower_v = math.floor(u), math.floor(v)
    x0, y0 = int(lower_u) & (size - 1), int(lower_v) & (size - 1)
    x1, y1 = (x0 + 1) & (size - 1), (y0 + 1) & (size - 1)
    row0, row1 = (y0 >> 2) * 4 * size + (y0 & 3) * 4, (y1 >> 2) * 4 * size + (y1 & 3) * 4
    return row0, row1, (x0 >> 2) * 16 + (x0 & 3), (x1 >> 2) * 16 + (x1 & 3), v - lower_v, u - lower_u


@njit_inline
def height(surface: Surface, first: int, last: int, line: np.ndarray, r: float) -> float:
    """Height of the tiles ``first`` to ``last`` (not included) together [m], ``r`` metres along a :func:`lattice_line` from the origin."""
    total = 0.0
    for tile in range(first, last):
        y0, y1, x0, x1, fy, fx = corners(surface.size, r * line[tile, 0], r * line[tile, 1])
        a, b = surface.height[tile, y0 + x0], surface.height[tile, y0 + x1]
        c, d = surface.height[tile, y1 + x0], surface.height[tile, y1 + x1]
        low, high = a + fx * (b - a), c + fx * (d - c)
        total += low + fy * (high - low)
    return total


@njit_inline
def slopes(surface: Surface, x: float, y: float) -> tuple[float, float]:
    """Slopes of the sea at a point towards east and north [1]."""
    east, north = 0.0, 0.0
    for tile in range(surface.height.shape[0]):
        u = (surface.grid[tile, 1] * x + surface.grid[tile, 2] * y) * surface.grid[tile, 0]
        v = (surface.grid[tile, 1] * y - surface.grid[tile, 2] * x) * surface.grid[tile, 0]
        y0, y1, x0, x1, fy, fx = corners(surface.size, u, v)
        a, b = (1.0 - fy) * (1.0 - fx), (1.0 - fy) * fx
        c, d = fy * (1.0 - fx), fy * fx
        east += a * surface.slope[tile, y0 + x0, 0] + b * surface.slope[tile, y0 + x1, 0]
        east += c * surface.slope[tile, y1 + x0, 0] + d * surface.slope[tile, y1 + x1, 0]
        north += a * surface.slope[tile, y0 + x0, 1] + b * surface.slope[tile, y0 + x1, 1]
        north += c * surface.slope[tile, y1 + x0, 1] + d * surface.slope[tile, y1 + x1, 1]
    return east, north


@njit
def largest_curvature(lattice: np.ndarray) -> float:
    """Bound of the second difference along any direction on a periodic lattice of heights [m per cell squared]."""
    n = lattice.shape[0]
    uu, vv, uv = 0.0, 0.0, 0.0
    for i in range(n):
        up, down = (i + 1) % n, i - 1
        for j in range(n):
            right, left = (j + 1) % n, j - 1
            twice = 2.0 * lattice[i, j]
            uu = max(uu, abs(lattice[i, right] - twice + lattice[i, left]))
            vv = max(vv, abs(lattice[up, j] - twice + lattice[down, j]))
            uv = max(uv, abs(lattice[up, right] - lattice[up, left] - lattice[down, right] + lattice[down, left]))
    # |f_ss| <= max(|f_uu|, |f_vv|) + |f_uv| for a unit direction; the mixed difference above spans four cells
    return max(uu, vv) + 0.25 * uv


def calm_surface() -> Surface:
    """A sea without resolved waves."""
    lattice = np.zeros((0, 1, 2), np.float32)
    return Surface(1, lattice[..., 0].copy(), lattice, np.zeros((0, 3)), 0.0, 0.0)


def surface_of(tiles: tuple[NDArray[np.float32], ...], spacing: FloatArray, turn: FloatArray) -> Surface:
    """Bundle the tiles of one instant, each ``(n, n, 3)`` of height and slopes, on lattices of ``spacing`` [m], turned from east [rad]."""
    lattice = np.stack(tiles)
    count, n = lattice.shape[:2]
    if n < 4 or n & (n - 1):
        raise DomainError(f"tiles of {n} points a side cannot be rendered; give a power of two, 4 or more")
    squares = lattice.reshape(count, n // 4, 4, n // 4, 4, 3).transpose(0, 1, 3, 2, 4, 5).reshape(count, n * n, 3)
    return Surface(
        n,
        np.ascontiguousarray(squares[..., 0]),
        np.ascontiguousarray(squares[..., 1:]),
        np.stack([1.0 / spacing, np.cos(turn), np.sin(turn)], axis=1),
        float(lattice[-1, ..., 0].max()),
        float(sum(largest_curvature(z) / d**2 for z, d in zip(lattice[:-1, ..., 0], spacing[:-1], strict=True))),
    )
