"""Foam of the sea for kernels: pyramids of shares on the tiles of the waves, read at the places of the waves.

Each tile holds its shares on square cells and the means of 2 x 2, 4 x 4, ... of them (``seaglint.sea.foam.foam_field``). A place is read
bilinearly on the two levels whose cells are next to the width that the reading stands for, and linearly between them, so that foam neither
jumps nor loses its mean where the width grows. Foam of tiles whose waves a level of detail omits is still read, at the same places.
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.jit import kernel
from seaglint.sea.foam.foam_field import FoamTiles, pyramid_size
from seaglint.sea.foam.lace import CELL_M, FADED_M, laced
from seaglint.sea.foam.ship_foam import NO_SEGMENTS, FoamSegments
from seaglint.sea.tiles import Tile, Wander


class FoamSurface(NamedTuple):
    """Foam of an instant as kernels read it.

    ``share`` and ``marks``: ``FoamTiles.cells`` and ``.marks``; ``tile[t] = (address of its pyramid, cells along a side, address of its
    marks)``; ``grid[t] = (cells per metre, cos, sin of the tile's turn, u, v under the sensor)`` and ``wander[t]`` as in ``Surface``, in
    cells; ``row[l, t]``: place of the tile among the parts of level l, -1 where the level omits it; ``even``: share everywhere, of a sea
    without resolved waves; ``ships``: foam of ships, by places east and north, and ``origin``: place under the sensor [m]; ``lace``:
    pattern of holes, empty where foam has none, and ``drifted``: way of the water since the start [m].
    """

    share: np.ndarray
    marks: np.ndarray
    tile: np.ndarray
    grid: np.ndarray
    wander: np.ndarray
    row: np.ndarray
    even: float
    origin: tuple[float, float]
    ships: FoamSegments
    lace: np.ndarray
    drifted: tuple[float, float]


def even_foam(share: float, origin: tuple[float, float] = (0.0, 0.0), ships: FoamSegments = NO_SEGMENTS) -> FoamSurface:
    """Return a sea with the same share of foam everywhere, and that of ships."""
    none, numbers = np.zeros((0, 5)), np.zeros((0, 3), np.int64)
    holes, cells, marks = np.zeros((0, 0), np.float32), np.zeros(0, np.float32), np.zeros(0, np.uint8)
    return FoamSurface(cells, marks, numbers, none, np.zeros((0, 0, 5)), numbers, share, origin, ships, holes, (0.0, 0.0))


NO_FOAM_SURFACE: Final = even_foam(0.0)  #: A sea without foam.


def wander_rows(wander: tuple[Wander, ...], spacing: FloatArray, turn: FloatArray, origin: tuple[float, float]) -> FloatArray:
    """Return the rows ``Surface.wander`` for a sensor above ``origin`` [m]."""
    out = np.zeros((len(wander), max((w.phase.size for w in wander), default=0), 5))
    for rows, one, d, angle in zip(out, wander, spacing, turn, strict=False):
        row = rows[: one.phase.size]  # waves that a part lacks have no amplitude
        c, s = np.cos(angle), np.sin(angle)
        row[:, :2] = one.amplitude @ np.array([[c, -s], [s, c]]) / d
        row[:, 2:4] = one.wave_vector / (2.0 * np.pi)
        row[:, 4] = np.mod(row[:, 2:4] @ np.array(origin) + one.phase / (2.0 * np.pi), 1.0)
    return out


def foam_surface(
    foam: FoamTiles,
    tiles: tuple[Tile, ...],
    wander: tuple[Wander, ...],
    rows: NDArray[np.int64],
    origin: tuple[float, float],
    ships: FoamSegments = NO_SEGMENTS,
) -> FoamSurface:
    """Return the foam of an instant around a sensor above ``origin``, east and north [m].

    Parameters
    ----------
    foam : FoamTiles
        Pyramids of the tiles.
    tiles : tuple of Tile
        The tiles of the sea.
    wander : tuple of Wander
        Displacement of each; none where all lie still.
    rows : ndarray
        ``FoamSurface.row``.
    origin : (float, float)
        Point under the sensor [m].
    ships : FoamSegments
        Foam of ships.
    """
    size = np.array(foam.size, np.int64)
    cell = np.array([tile.length for tile in tiles]) / size
    turn = np.array([tile.rotation for tile in tiles])
    first, above = (np.cumsum([0, *map(pyramid_size, sizes)])[:-1] for sizes in (foam.size, (n // 2 for n in foam.size)))
    c, s = np.cos(turn), np.sin(turn)
    u, v = (np.mod(p / cell, size) for p in (c * origin[0] + s * origin[1], c * origin[1] - s * origin[0]))
    grid: FloatArray = np.stack([1.0 / cell, c, s, u, v], axis=1)
    moved = wander_rows(wander, cell, turn, origin) if wander else np.zeros((len(tiles), 0, 5))
    places = np.stack([first, size, above], axis=1).astype(np.int64)
    return FoamSurface(foam.cells, foam.marks, places, grid, moved, rows, 0.0, origin, ships, foam.lace, foam.drifted)


@kernel
def corners(share: np.ndarray, first: int, size: int, x: float, y: float) -> tuple[float, float, float, float, float, float]:
    """Return the four cells of a level around a place and the fractions between them; ``x``, ``y``: cells from the middle of the first."""
    lower_x, lower_y = math.floor(x), math.floor(y)
    mask = size - 1
    i, j = int(lower_x) & mask, int(lower_y) & mask
    near, far = np.uint64(first + j * size), np.uint64(first + ((j + 1) & mask) * size)
    left, right = np.uint64(i), np.uint64((i + 1) & mask)
    return share[near + left], share[near + right], share[far + left], share[far + right], x - lower_x, y - lower_y


@kernel
def foam_level(foam: FoamSurface, t: int, width: float) -> tuple[int, int, int, float]:
    """Return the finer of the two levels for readings of a ``width`` [cells], and the width of its cells over those of the tile.

    These are: its address, the address of the marks of the coarser level, its cells along a side, and the width, a power of two.
    """
    first, size, scale, marks = foam.tile[t, 0], foam.tile[t, 1], 1.0, foam.tile[t, 2]
    while width >= 2.0 * scale and size > 2:
        first, size, scale = first + size * size, size >> 1, 2.0 * scale
        marks += size * size
    return first, marks, size, scale


@kernel
def level_share(foam: FoamSurface, first: int, marks: int, size: int, u: float, v: float, width: float) -> float:
    """Return the share of foam at a place (u, v) of a level and the next one, a mean over a ``width``, all in cells of the level."""
    # the cells of the next level contain those of this one: where they are water, so is the place
    half = size >> 1
    x, y = 0.5 * u - 0.5, 0.5 * v - 0.5
    lower_x, lower_y = math.floor(x), math.floor(y)
    if foam.marks[np.uint64(marks + (int(lower_y) & (half - 1)) * half + (int(lower_x) & (half - 1)))] == 0:
        return 0.0
    a, b, c, d, f, g = corners(foam.share, first + size * size, half, x, y)
    above = a + f * (b - a) + g * (c - a + f * (d - c - b + a))
    part = min(max(width - 1.0, 0.0), 1.0)
    if part == 1.0:
        return above
    a, b, c, d, f, g = corners(foam.share, first, size, u - 0.5, v - 0.5)
    fine = a + f * (b - a) + g * (c - a + f * (d - c - b + a))
    return fine + part * (above - fine)


@kernel
def tile_share(foam: FoamSurface, t: int, u: float, v: float, width: float) -> float:
    """Return the share of a tile's foam at a place (u, v), a mean over a ``width`` [cells]."""
    first, marks, size, scale = foam_level(foam, t, width)
    return level_share(foam, first, marks, size, u / scale, v / scale, width / scale)


@kernel
def with_holes(foam: FoamSurface, share: float, away: tuple[float, float], r: float, width: float) -> float:
    """Return a share of foam with the holes at a place, ``r`` metres from under the sensor along a horizontal unit vector."""
    size = foam.lace.shape[0]
    if size == 0 or share <= 0.0 or share >= 1.0 or width >= FADED_M:
        return share
    x = (foam.origin[0] + r * away[0] - foam.drifted[0]) * (1.0 / CELL_M)
    y = (foam.origin[1] + r * away[1] - foam.drifted[1]) * (1.0 / CELL_M)
    lower_x, lower_y = math.floor(x), math.floor(y)
    f, g = x - lower_x, y - lower_y
    at, row = int(lower_x) & (size - 1), int(lower_y) & (size - 1)
    # unsigned: Numba tests every signed address for a negative value
    i, j, k, m = np.uint64(at), np.uint64(row), np.uint64((at + 1) & (size - 1)), np.uint64((row + 1) & (size - 1))
    near = foam.lace[j, i] + f * (foam.lace[j, k] - foam.lace[j, i])
    far = foam.lace[m, i] + f * (foam.lace[m, k] - foam.lace[m, i])
    return laced(share, near + g * (far - near), width)
