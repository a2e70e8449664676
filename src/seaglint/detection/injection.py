"""Placement of injected objects: batches of places that share a window of frames without disturbing each other.

Injection i has a displacement within its pixel that is a function of (seed, i), batch b a lattice of places that is one of (seed, b):
neither threads nor order change a result. Neighbours on the lattice are ``pitch`` pixels apart, its origin is uniform within a cell, so
that every pixel inside the margin is as likely as any other.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError, DomainError
from seaglint.base.jit import njit
from seaglint.base.random import stream
from seaglint.detection.interface import Detector
from seaglint.detection.spot import SpotShape

IntArray = NDArray[np.int64]
Placement = Literal["random", "centre"]

SHARED: Final = 100  #: Number of injections that share a window of frames, where there is space, before another window is used.

LOOSE_PITCH: Final = 32  #: Distance of objects [px] for detectors that may use the whole frame, for which sharing is not exact.

_BLOCK = 4096
_EMPTY_BATCHES = 20


@dataclass(frozen=True)
class Batch:
    """Batch of objects that share a window of frames."""

    window: int  #: Number of the window.
    row: IntArray  #: Rows of the pixels that hold the objects in the last frame of the window [px, (n,)].
    column: IntArray  #: Columns of these pixels [px, (n,)].
    offset: FloatArray  #: Displacement from the pixel's centre, row and column [px, (n, 2)].

    @property
    def size(self) -> int:
        """Number of objects."""
        return int(self.row.size)

    @property
    def place(self) -> FloatArray:
        """True places, shape (n, 2), row and column [px]."""
        return np.stack([self.row, self.column], axis=1) + self.offset


def offsets(seed: int, first: int, count: int, placement: Placement) -> FloatArray:
    """Displacements of injections ``first`` ... ``first + count - 1``, uniform within the pixel, shape (count, 2) [px]; 0 at centres."""
    if placement == "centre":
        return np.zeros((count, 2))
    # Blocks of fixed size: a displacement does not depend on how many are drawn at once.
    parts = []
    for block in range(first // _BLOCK, (first + count - 1) // _BLOCK + 1):
        drawn = stream(seed, "object offsets", block).random((_BLOCK, 2)) - 0.5
        parts.append(drawn[max(first - block * _BLOCK, 0) : first + count - block * _BLOCK])
    return np.concatenate(parts)


def pitch_for(detector: Detector, shape: SpotShape, match_radius: float, travel: int) -> int:
    """Least distance of objects [px] at which neither the statistics nor the fits of position affect another's match window."""
    # Between two objects: the match window, the reach of the detector or of a fit, the object, and its travel.
    around = LOOSE_PITCH if detector.reach is None else max(detector.reach, shape.half)
    return int(match_radius) + around + shape.half + 1 + travel


@dataclass(frozen=True)
class InjectionPlan:
    """Number of injections, their distance, and the number of windows.

    Parameters
    ----------
    injections : int
        Requested number.
    windows : int
        Windows of frames there are.
    rows, columns : int
        Size of the frames [px].
    pitch, margin : int
        Distance of objects, and pixels along the border that hold none [px].
    placement : {"random", "centre"}
        Anywhere within the pixels, or at their centres.
    seed : int
        Seed of places and displacements.
    only_rows : (int, int), optional
        Rows that hold objects, first and end; all within the margin by default [px].
    spread : bool
        Whether all windows hold as many, however few: intervals of independent seas depend on how many windows hold objects.

    Raises
    ------
    DomainError
        No pixel is left within the margin.
    """

    injections: int
    windows: int
    rows: int
    columns: int
    pitch: int
    margin: int
    placement: Placement = "random"
    seed: int = 0
    only_rows: tuple[int, int] | None = None
    spread: bool = False

    def __post_init__(self) -> None:
        if self.injections < 1:
            raise DomainError(f"injections = {self.injections}; give at least 1")
        if min(self.rows, self.columns) <= 2 * self.margin:
            raise DomainError(
                f"frames of {self.rows} x {self.columns} px leave no place for an object {self.margin} px from the border; "
                "give a smaller object or larger frames"
            )
        if self.row_range[0] >= self.row_range[1]:
            raise DomainError(f"rows {self.only_rows} hold no object {self.margin} px from the border of {self.rows} rows; give others")

    @property
    def row_range(self) -> tuple[int, int]:
        """First row of the objects, and the row after the last."""
        first, end = self.only_rows or (0, self.rows)
        return max(first, self.margin), min(end, self.rows - self.margin)

    @property
    def per_batch(self) -> int:
        """Number of injections of one batch: as many as spread them over all windows, at least ``SHARED``, as far as there is space."""
        first, end = self.row_range
        # Cells of the lattice inside the margin, at least one along each axis.
        cells = max((end - first) // self.pitch, 1) * max((self.columns - 2 * self.margin) // self.pitch, 1)
        return min(max(-(-self.injections // self.windows), 1 if self.spread else SHARED), cells, self.injections)

    @property
    def batches(self) -> int:
        """Number of batches where every place is free."""
        return -(-self.injections // self.per_batch)

    def batch(self, number: int) -> Batch:
        """Batch of a given number, with all its places."""
        generator = stream(self.seed, "object places", number)
        # A random origin of the lattice, and a random choice of its cells.
        first_row, first_column = generator.integers(0, self.pitch, 2)
        first, end = self.row_range
        # fewer rows than a pitch: all are equally likely, and each is used
        rows = np.arange(first + first_row * min(self.pitch, end - first) // self.pitch, end, self.pitch)
        columns = np.arange(self.margin + first_column, self.columns - self.margin, self.pitch)
        cells = generator.permutation(rows.size * columns.size)[: self.per_batch]
        # A narrow frame may have no place on a lattice that begins beyond it.
        row, column = (rows[cells // columns.size], columns[cells % columns.size]) if cells.size else (cells, cells)
        shift = offsets(self.seed, number * self.per_batch, self.per_batch, self.placement)[: cells.size]
        # Even over the windows where there are fewer batches, else in turn.
        window = (2 * number + 1) * self.windows // (2 * self.batches) if self.batches <= self.windows else number
        return Batch(window % self.windows, row.astype(np.int64), column.astype(np.int64), shift)


def free(batch: Batch, known: NDArray[np.bool_]) -> Batch:
    """Objects of a batch whose pixel has a statistic."""
    free_pixels = known[batch.row, batch.column]
    return Batch(batch.window, batch.row[free_pixels], batch.column[free_pixels], batch.offset[free_pixels])


def nothing_free(batches: int) -> DataError:
    """Message for the case that no object finds a place."""
    return DataError(
        f"{batches} batches of objects found no pixel with a statistic: frames are missing, constant or within the detector's border; "
        "look at them with seaglint analyze, or choose another detector"
    )


def most_batches(plan: InjectionPlan) -> int:
    """Largest number of batches that are tried for injections that find no place."""
    return 4 * plan.batches + _EMPTY_BATCHES


@njit
def _add(frame: np.ndarray, stamps: np.ndarray, row: np.ndarray, column: np.ndarray, amplitude: float) -> None:
    n, side, _ = stamps.shape
    half = side // 2
    for k in range(n):
        for i in range(max(row[k] - half, 0), min(row[k] + half + 1, frame.shape[0])):
            for j in range(max(column[k] - half, 0), min(column[k] + half + 1, frame.shape[1])):
                frame[i, j] += amplitude * stamps[k, i - row[k] + half, j - column[k] + half]


def inject(
    frames: NDArray[np.floating], batch: Batch, shape: SpotShape, contrast: float, velocity: tuple[float, float] = (0.0, 0.0)
) -> None:
    """Add a batch of objects to the frames of its window, in place; each is at its place in the last frame.

    Parameters
    ----------
    frames : ndarray, shape (k, rows, columns)
        Changed in place [u].
    batch : Batch
        Objects.
    shape : SpotShape
        Shape of every object.
    contrast : float
        Signal of an object in the pixel at whose centre it lies [u].
    velocity : (float, float)
        Motion in rows and columns [px a frame].
    """
    count = frames.shape[0]
    for k in range(count):
        back = count - 1 - k
        place = batch.place - back * np.asarray(velocity)
        pixel = np.floor(place + 0.5).astype(np.int64)
        # Half a pixel of displacement must not round to the neighbour where the object is still at its own pixel.
        if back == 0 or velocity == (0.0, 0.0):
            pixel = np.stack([batch.row, batch.column], axis=1)
        _add(frames[k], shape.stamps(place - pixel), pixel[:, 0].copy(), pixel[:, 1].copy(), float(contrast))
