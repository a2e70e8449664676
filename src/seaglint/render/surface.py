"""Reading the synthesised sea at a point: bilinear interpolation on periodic tiles, and ceilings over stretches of it."""

from __future__ import annotations

import math
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d

from seaglint._jit import njit_inline
from seaglint.conventions import FloatArray
from seaglint.errors import DomainError

STRIDES: Final = (4, 8, 16, 32)
"""Steps that a sweep may skip under a ceiling; the fewest are the length of the shortest wave."""

BLOCK_STEPS: Final = 4
"""Steps of the sweep that a block sharing one ceiling may be long; a lattice cell where that is longer."""


class Surface(NamedTuple):
    """One instant of the sea.

    ``height[i, iy, ix]`` [m] and ``slope[i, iy, ix] = (east, north)`` are the lattices of tile ``i``;
    ``grid[i] = (1/spacing, cos, sin of the tile's turn)``. ``ceiling[l, start[i] + by side + bx]``, with ``side = n >> block[i]``: largest
    height of tile ``i`` that a line of the image meets within ``reach[l]`` metres outward from any point of the block.
    """

    height: np.ndarray
    slope: np.ndarray
    grid: np.ndarray
    ceiling: np.ndarray
    reach: np.ndarray
    start: np.ndarray
    block: np.ndarray


@njit_inline
def cell(surface: Surface, tile: int, x: float, y: float) -> tuple[int, int, int, int, float, float]:
    """Indices of the four lattice points around a point and its fractions between them. The lattice size is a power of two."""
    u = (surface.grid[tile, 1] * x + surface.grid[tile, 2] * y) * surface.grid[tile, 0]
    v = (surface.grid[tile, 1] * y - surface.grid[tile, 2] * x) * surface.grid[tile, 0]
    lower_u, lower_v = math.floor(u), math.floor(v)
    mask = surface.height.shape[1] - 1
    ix, iy = int(lower_u) & mask, int(lower_v) & mask
    return iy, (iy + 1) & mask, ix, (ix + 1) & mask, v - lower_v, u - lower_u


@njit_inline
def height(surface: Surface, x: float, y: float) -> float:
    """Height of the sea at a point [m]."""
    total = 0.0
    for tile in range(surface.height.shape[0]):
        y0, y1, x0, x1, fy, fx = cell(surface, tile, x, y)
        a, b = surface.height[tile, y0, x0], surface.height[tile, y0, x1]
        c, d = surface.height[tile, y1, x0], surface.height[tile, y1, x1]
        low, high = a + fx * (b - a), c + fx * (d - c)
        total += low + fy * (high - low)
    return total


@njit_inline
def slopes(surface: Surface, x: float, y: float) -> tuple[float, float]:
    """Slopes of the sea at a point towards east and north [1]."""
    east, north = 0.0, 0.0
    for tile in range(surface.height.shape[0]):
        y0, y1, x0, x1, fy, fx = cell(surface, tile, x, y)
        a, b = (1.0 - fy) * (1.0 - fx), (1.0 - fy) * fx
        c, d = fy * (1.0 - fx), fy * fx
        east += a * surface.slope[tile, y0, x0, 0] + b * surface.slope[tile, y0, x1, 0]
        east += c * surface.slope[tile, y1, x0, 0] + d * surface.slope[tile, y1, x1, 0]
        north += a * surface.slope[tile, y0, x0, 1] + b * surface.slope[tile, y0, x1, 1]
        north += c * surface.slope[tile, y1, x0, 1] + d * surface.slope[tile, y1, x1, 1]
    return east, north


@njit_inline
def ceiling(surface: Surface, level: int, x: float, y: float) -> float:
    """Height that no point within ``reach[level]`` further out exceeds [m]."""
    total = 0.0
    n = surface.height.shape[1]
    for tile in range(surface.height.shape[0]):
        u = (surface.grid[tile, 1] * x + surface.grid[tile, 2] * y) * surface.grid[tile, 0]
        v = (surface.grid[tile, 1] * y - surface.grid[tile, 2] * x) * surface.grid[tile, 0]
        by, bx = (math.floor(v) & (n - 1)) >> surface.block[tile], (math.floor(u) & (n - 1)) >> surface.block[tile]
        total += surface.ceiling[level, surface.start[tile] + by * (n >> surface.block[tile]) + bx]
    return total


def calm_surface() -> Surface:
    """A sea without resolved waves."""
    none = np.zeros(0, np.int64)
    lattice = np.zeros((0, 1, 1, 2), np.float32)
    return Surface(lattice[..., 0].copy(), lattice, np.zeros((0, 3)), np.zeros((1, 0), np.float32), np.zeros(1), none, none)


class Ceilings:
    """How ceilings are made for one camera: the same at every instant.

    Parameters
    ----------
    spacing, turn : (tiles,)
        Lattice spacing [m] and turn of each tile's axes from east [rad].
    n : int
        Lattice points along each side, a power of two.
    step : float
        Largest step of the sweep [m].
    azimuths : (float, float)
        Azimuths between which all lines lie [rad].
    """

    def __init__(self, spacing: FloatArray, turn: FloatArray, n: int, step: float, azimuths: tuple[float, float]) -> None:
        if n & (n - 1):
            raise DomainError(f"tiles of {n} points a side cannot be rendered; give a power of two")
        self.reach = step * np.asarray(STRIDES, dtype=np.float64)
        self.grid = np.stack([1.0 / spacing, np.cos(turn), np.sin(turn)], axis=1)
        cells = np.maximum(BLOCK_STEPS * step / spacing, 1.0)
        self.block = np.minimum(np.floor(np.log2(cells)), np.log2(n) - 1).astype(np.int64)
        sizes = (n >> self.block) ** 2
        self.start = np.concatenate([[0], np.cumsum(sizes)[:-1]]).astype(np.int64)
        self._size = int(sizes.sum())
        fan = np.linspace(*azimuths, 181)
        ahead = np.stack([np.cos(turn)[:, None] * np.sin(fan) + np.sin(turn)[:, None] * np.cos(fan),
                          np.cos(turn)[:, None] * np.cos(fan) - np.sin(turn)[:, None] * np.sin(fan)], axis=1)  # fmt: skip
        # directions between two of the fan's reach further by less than the square of half their angle
        margin = (azimuths[1] - azimuths[0]) / 180.0
        low, high = np.minimum(ahead.min(axis=2) - margin, 0.0), np.maximum(ahead.max(axis=2) + margin, 0.0)
        scale = self.reach[:, None, None] / (spacing[:, None] * 2.0 ** self.block[:, None])
        # whole blocks behind and ahead, (levels, tiles, axes u and v)
        self._behind = np.ceil(-low * scale).astype(int)
        self._ahead = np.ceil(high * scale).astype(int)

    def table(self, heights: NDArray[np.float32]) -> NDArray[np.float32]:
        """Ceilings of one instant, from heights (tiles, n, n)."""
        out = np.empty((self.reach.size, self._size), np.float32)
        for tile, lattice in enumerate(heights):
            side = 1 << int(self.block[tile])
            blocks = lattice.reshape(lattice.shape[0] // side, side, -1, side).max(axis=(1, 3))
            # interpolation at a block's far edges reads the next lattice points
            blocks = np.maximum(blocks, np.roll(blocks, -1, axis=0))
            blocks = np.maximum(blocks, np.roll(blocks, -1, axis=1))
            for level in range(self.reach.size):
                grown = blocks
                for axis, (behind, ahead) in enumerate(zip(self._behind[level, tile], self._ahead[level, tile], strict=True)):
                    size = min(int(behind + ahead) + 1, blocks.shape[0])
                    # a filter of this origin covers from `behind` before to `ahead` after
                    grown = maximum_filter1d(grown, size, axis=1 - axis, mode="wrap", origin=int(behind) - size // 2)
                out[level, self.start[tile] : self.start[tile] + blocks.size] = grown.ravel()
        return out


def surface_of(tiles: tuple[NDArray[np.float32], ...], ceilings: Ceilings) -> Surface:
    """Bundle the tiles of one instant, each ``(n, n, 3)`` of height and slopes."""
    lattice = np.stack(tiles)
    heights = np.ascontiguousarray(lattice[..., 0])
    slope = np.ascontiguousarray(lattice[..., 1:])
    return Surface(heights, slope, ceilings.grid, ceilings.table(heights), ceilings.reach, ceilings.start, ceilings.block)
