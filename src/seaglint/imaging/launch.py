"""Launches of a frame's kernels: allocation of their arrays and their runs, in threads or by Numba's parallel loops.

Scenes prepare the tables that kernels read and call these functions for every frame; no other module runs them, so another device needs
only another module in place of this one. The tables themselves are filled where they are defined, once for each sensor height. Fourier
transforms of the waves are in :mod:`seaglint.sea.wave_field`, launches for bodies in ``seaglint.objects.drawing.launch_bodies``.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import DTypeLike, NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError
from seaglint.base.jit import in_threads
from seaglint.imaging.camera.imager import Quads, Resampling, SweepGrid, apply_weights, fill_weights, resample_at_once
from seaglint.imaging.foam_surface import NO_FOAM_SURFACE, FoamSurface, wander_rows
from seaglint.imaging.layers import BLOCK, CHANNELS, upright
from seaglint.imaging.rays import RayTables, walk_pixels
from seaglint.imaging.sparkle import SparkleRows, sparkle_columns
from seaglint.imaging.sweep.sweep import Rows, Swept, skies_alone, sweep_columns
from seaglint.imaging.wave_surface import LONGEST_STRIP, Bounds, Surface, course, height, lay_rows
from seaglint.sea.tiles import Wander


def surface_of(
    lattices: tuple[NDArray[np.float32], ...],
    spacing: FloatArray,
    turn: FloatArray,
    levels: tuple[tuple[int, ...], ...] | None = None,
    origin: tuple[float, float] = (0.0, 0.0),
    wander: tuple[Wander, ...] = (),
    foam: FoamSurface = NO_FOAM_SURFACE,
) -> Surface:
    """Bundle the lattices of one instant; without lattices the sea has no resolved waves.

    Parameters
    ----------
    lattices : tuple of ndarray
        Each (n, n, 1) or (n, n, 2) as of :meth:`~seaglint.sea.wave_field.WaveField.coefficients` [m]; n a power of two, 4 or more.
    spacing, turn : ndarray
        Distance of lattice points [m] and turn from east [rad] of each.
    levels : tuple of tuples of int, optional
        Lattices of every level of detail, longest waves first; one of all by default.
    origin : (float, float)
        Point under the sensor, east and north [m].
    wander : tuple of Wander
        Displacement of each lattice; none where all lie still.
    foam : FoamSurface
        Foam on the tiles.
    """
    sizes = np.array([z.shape[0] for z in lattices], dtype=np.int64)
    for n in sizes:
        if n < 4 or n & (n - 1) or n > LONGEST_STRIP:
            raise DomainError(f"tiles of {n} points a side cannot be rendered; give a power of two from 4 to {LONGEST_STRIP}")
    chosen = levels if levels is not None else (tuple(range(len(lattices))),)
    count = np.array([z.shape[2] for z in lattices], dtype=np.int64)
    # addresses of the lattices in one array, with their borders of three points
    first = np.concatenate([[0], np.cumsum(count * (sizes + 3) ** 2)]).astype(np.int64)
    rows = np.empty(first[-1], np.float32)
    for lattice, begin, n in zip(lattices, first, sizes, strict=False):
        for k in range(lattice.shape[2]):
            lay_rows(lattice, k, rows[begin + k * (n + 3) ** 2 : begin + (k + 1) * (n + 3) ** 2])
    # linear reading begins at the second of a spline's four points along either axis
    spline, linear = first[:-1] + (count - 1) * (sizes + 3) ** 2, first[:-1] + (count - 1) * (sizes + 4)
    c, s = np.cos(turn), np.sin(turn)
    # positions are periodic: small numbers have more digits
    u, v = (np.mod(p / spacing, sizes) for p in (c * origin[0] + s * origin[1], c * origin[1] - s * origin[0]))
    highest = [float(z[..., 0].max()) for z in lattices]
    most = max(*map(len, chosen), 1)
    # crest: from each lattice of a level on, the sum of the highest points of it and of all shorter waves
    level, crest = np.full((len(chosen), most), -1, np.int64), np.zeros((len(chosen), most))
    for i, parts in enumerate(chosen):
        level[i, : len(parts)] = parts
        crest[i, : len(parts)] = np.cumsum([highest[p] for p in reversed(parts)])[::-1]
    return Surface(
        rows,
        np.stack([linear, sizes, spline, (count == 1).astype(np.int64)], axis=1),
        np.stack([1.0 / spacing, c, s, u, v], axis=1),
        level,
        crest,
        wander_rows(wander, spacing, turn, origin),
        foam,
    )


def foot_height(surface: Surface) -> float:
    """Return the height of the sea under the sensor [m]."""
    line = course(surface, 0, 1.0, 0.0, (0.0, 0.0))
    return float(height(surface, line, 0, line.part.shape[0], 0.0))


def columns_of_sky(rows: Rows, azimuths: FloatArray, width: float, intervals: int, channels: int) -> FloatArray:
    """Return channels of columns without sea (columns, 1 + intervals, channels, rows), at azimuths and of a width [rad]."""
    images = np.zeros((azimuths.size, 1 + intervals, channels, rows.number))
    skies_alone(rows, azimuths, width, images)
    return images


def columns_of_sea(swept: Swept, surface: Surface, azimuths: FloatArray, width: float, cuts: FloatArray, channels: int) -> FloatArray:
    """Return channels of columns by the sweep (columns, 1 or 2 + cuts, channels, rows), at azimuths of a width [rad]; without sparkles."""
    intervals = cuts.shape[1] + 1 if cuts.shape[1] else 0
    images = np.zeros((azimuths.size, 1 + intervals, channels, swept.rows.number))
    in_threads(lambda part: sweep_columns(swept, surface, azimuths, width, cuts, images, part), azimuths.size)
    return images


def add_sparkles(
    swept: Swept, rows: SparkleRows, azimuths: FloatArray, place: tuple[float, float], time: float, images: FloatArray
) -> None:
    """Apply sparkles to the mirrored Sun of columns, seen from above a place, east and north [m], at a time [s]."""
    in_threads(lambda part: sparkle_columns(swept.sparkle, rows, swept.sunlight, azimuths, place, time, images, part), azimuths.size)


def planes_of(columns: FloatArray, planes: NDArray[np.int64], kind: DTypeLike) -> NDArray[np.floating]:
    """Return planes of an image [unit of the channels, (planes, rows, columns)], of a data type.

    ``columns`` holds the channels of its columns (columns, channels, rows).
    """
    out = np.empty((planes.size, columns.shape[2], columns.shape[0]), kind)
    in_threads(lambda part: upright(columns, planes, out, part), -(-out.shape[1] // BLOCK))
    return out


def pixels_of_rays(
    tables: RayTables,
    surface: Surface,
    bounds: Bounds,
    eye: float,
    corner: FloatArray,
    pixels: NDArray[np.int64],
    samples: NDArray[np.int64],
) -> FloatArray:
    """Return mean channels of some pixels [units of the layers, (pixels, channels)], from rays.

    Arguments are those of ``walk_pixels``.
    """
    channels = np.zeros((pixels.size, CHANNELS))
    in_threads(lambda part: walk_pixels(surface, bounds, eye, tables, corner, pixels, samples, channels, part), pixels.size)
    return channels


def weights_of(quadrilaterals: Quads, pixels: NDArray[np.int64], cells: SweepGrid) -> Resampling:
    """Return the weights of the sweep's cells in some pixels (flat indices) with their quadrilaterals."""
    start = np.concatenate([[0], np.cumsum(quadrilaterals.bound)])
    count = np.zeros(pixels.size, np.int32)
    index, weight = np.zeros(start[-1], np.int32), np.zeros(start[-1], np.float32)
    column, sine = quadrilaterals.column, quadrilaterals.sine
    in_threads(lambda part: fill_weights(column, sine, cells, start, count, index, weight, part), pixels.size)
    return Resampling(pixels, start, count, index, weight)


def resample(weights: Resampling, images: NDArray[np.float32], out: NDArray[np.float32]) -> None:
    """Resample images of the sweep's cells (planes, rows, columns) into pixels of ``out`` (planes, pixels of the camera)."""
    flat, w = images.reshape(images.shape[0], -1), weights
    in_threads(lambda part: apply_weights(w.start, w.count, w.index, w.weight, flat, w.pixels, out, part), w.pixels.size)


def resample_once(
    quadrilaterals: Quads, pixels: NDArray[np.int64], cells: SweepGrid, images: NDArray[np.float32], out: NDArray[np.float32]
) -> None:
    """Resample as ``resample`` with the weights of ``weights_of``, which are not stored."""
    most, flat = int(quadrilaterals.bound.max()), images.reshape(images.shape[0], -1)
    column, sine = quadrilaterals.column, quadrilaterals.sine
    in_threads(lambda part: resample_at_once(column, sine, cells, most, flat, pixels, out, part), pixels.size)
