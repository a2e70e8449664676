r"""Light of small sources on the focal plane, at places finer than any grid, in windows of a picture.

A source at image point ``x`` adds the light ``h(p - x)`` to a pixel ``p``; the transform of ``h`` is the product ``H`` of all transfer
functions. Sources are distributed on a local grid of ``m`` nodes to a pixel by cubic B-splines; the transform of the splines is then
divided out:

.. math:: L_p = \int \frac{H(f)}{B(f)}\,\hat G(f)\,e^{2\pi i f p}\,df, \qquad B(f) = \mathrm{sinc}^4(f_x/m)\,\mathrm{sinc}^4(f_y/m)

The transfer of optics is 0 above their cut-off :math:`f_c`. With :math:`m = 4 f_c` the grid adds to a frequency ``f`` an aliased share of
:math:`(f/(m-f))^4`, at most :math:`4\cdot 10^{-4}` up to half the cut-off (Dutt and Rokhlin 1993, SIAM J. Sci. Comput. 14, 1368).

Windows are parts of a picture, with its full circle if it closes on itself: they are added to it, cut and joined.
"""

from __future__ import annotations

import itertools
import math
from collections import OrderedDict
from dataclasses import dataclass, field
from typing import Final, NamedTuple

import numpy as np
import scipy.fft
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.jit import kernel, njit
from seaglint.instrument.optics import Blur
from seaglint.instrument.transfer import Sampling, sensor_mtf

#: First row and first column of a part of a picture, which may lie outside it, and values of its pixels (rows, columns).
PictureWindow = tuple[int, int, NDArray[np.float32]]

NODES_PER_CYCLE: Final = 4.0  #: Number of nodes of the grid in a period of the optics' cut-off.

#: Least and greatest margin of a window around its sources [pixels]; between them ``BLURS`` of diffraction.
#:
#: Diffracted light beyond the margin, a share of some ``1 / (pi^2 BLURS)``, wraps around to the other side, so that sums are complete.
MARGINS: Final = (24, 48)

BLURS: Final = 16.0  #: Margin in units of the blur's diameter (wavelength times f-number).

TILE: Final = 96  #: Side of the tiles into which sources over a larger area are divided [pixels].

STEP: Final = 16  #: Step of the sizes of windows [pixels], so that few filters are needed.

CACHED: Final = 8  #: Number of filters of windows that are cached.


def add_window(picture: FloatArray, window: PictureWindow, circle: int) -> None:
    """Add a window to a picture (rows, columns); ``circle``: columns of a full circle, 0 for a picture that is no full circle."""
    row, column, values = window
    first, end = max(row, 0), min(row + values.shape[0], picture.shape[0])
    if first >= end:
        return
    inside = values[first - row : end - row]
    columns = column + np.arange(values.shape[1])
    if circle:
        for k in range(-(-columns.size // circle)):  # a window may be wider than the circle
            some = slice(k * circle, (k + 1) * circle)
            picture[first:end, columns[some] % circle] += inside[:, some]
        return
    keep = (columns >= 0) & (columns < picture.shape[1])
    picture[first:end, columns[keep]] += inside[:, keep]


def part_of(window: PictureWindow, rows: tuple[int, int] | None, columns: tuple[int, int] | None) -> PictureWindow:
    """Return the part of a window in some rows and columns (first and end; None for all)."""
    row, column, values = window
    if rows is not None:
        first, end = max(rows[0], row), min(rows[1], row + values.shape[0])
        values, row = values[max(first - row, 0) : max(end - row, 0)], first
    if columns is not None:
        first, end = max(columns[0], column), min(columns[1], column + values.shape[1])
        values, column = values[:, max(first - column, 0) : max(end - column, 0)], first
    return row, column, values


def sum_of(windows: list[PictureWindow], shape: tuple[int, ...], circle: int) -> PictureWindow | None:
    """Return the sum of windows in a picture of ``shape`` (rows, columns) as one window; None if all are outside it."""
    if not windows:
        return None
    # on a full circle all windows move to the turn in which they are nearest to the first
    about = windows[0][1]
    moved = [(row, about + (column - about + circle // 2) % circle - circle // 2 if circle else column, v) for row, column, v in windows]
    top, left = max(min(row for row, _, _ in moved), 0), min(column for _, column, _ in moved)
    bottom = min(max(row + v.shape[0] for row, _, v in moved), shape[0])
    right = max(column + v.shape[1] for _, column, v in moved)
    if not circle:
        left, right = max(left, 0), min(right, shape[1])
    if top >= bottom or left >= right:
        return None
    whole = np.zeros((bottom - top, right - left))
    for row, column, values in moved:
        add_window(whole, (row - top, column - left, values), 0)
    return top, left, whole.astype(np.float32)


class Boxes(NamedTuple):
    """Sources as boxes of light over the sea, at the middle of an exposure; arrays are (b,)."""

    column: FloatArray  #: Columns of the centres [pixels].
    row: FloatArray  #: Rows of the centres [pixels].
    counted: FloatArray  #: Counted radiance times the area of the box [W m-2 sr-1 pixels].
    radiance: FloatArray  #: Radiance times the area of the box [W m-2 sr-1 pixels].
    cover: FloatArray  #: Covered area [pixels].
    side: float  #: Side of a box [pixels]; 0 for points.


class Instants(NamedTuple):
    """Instants of an exposure; arrays are (k,)."""

    across: FloatArray  #: Shifts of the sources along columns [pixels].
    down: FloatArray  #: Shifts of the sources along rows [pixels].
    weight: FloatArray  #: Weights, which add to 1.
    sea_across: FloatArray  #: Shifts of the sea's image along columns [pixels].
    sea_down: FloatArray  #: Shifts of the sea's image along rows [pixels].


class Backdrop(NamedTuple):
    """Image of the sea behind sources."""

    radiance: NDArray[np.float32]  #: Radiance [W m-2 sr-1, (rows, columns)].
    fine: int  #: Number of its pixels along a side of a detector's pixel.
    circle: int  #: Columns of the detector in a full circle; 0 for an image that is no full circle.
    counted: float  #: Counted over unweighted radiance of the sea [1].


class LensShift(NamedTuple):
    """Distortion of a lens."""

    share: float  #: Relative radial shift at the corners [1].
    column: float  #: Column of the axis [pixels].
    row: float  #: Row of the axis [pixels].
    corner: float  #: Distance from the axis to a corner [pixels].


@kernel
def behind(sea: Backdrop, column: float, row: float) -> float:
    """Return the radiance of the sea at an image point [W m-2 sr-1], linear between the pixels' centres."""
    high, wide = sea.radiance.shape
    x, y = column * sea.fine - 0.5, row * sea.fine - 0.5
    i, j = math.floor(x), math.floor(y)
    u, v = x - i, y - j
    if sea.circle > 0:
        i0, i1 = i % wide, (i + 1) % wide
    else:
        i0, i1 = min(max(i, 0), wide - 1), min(max(i + 1, 0), wide - 1)
    j0, j1 = min(max(j, 0), high - 1), min(max(j + 1, 0), high - 1)
    s = sea.radiance
    return float((1.0 - v) * ((1.0 - u) * s[j0, i0] + u * s[j0, i1]) + v * ((1.0 - u) * s[j1, i0] + u * s[j1, i1]))


@kernel
def _spline(t: float) -> tuple[float, float, float, float]:
    """Return the weights of a cubic B-spline at the four nodes about a place ``t`` behind the second."""
    s = 1.0 - t
    return s * s * s / 6.0, (4.0 - 6.0 * t * t + 3.0 * t * t * t) / 6.0, (4.0 - 6.0 * s * s + 3.0 * s * s * s) / 6.0, t * t * t / 6.0


@njit
def spread(
    grid: np.ndarray,
    nodes: int,
    first: tuple[int, int],
    tile: tuple[float, float, float, float],
    boxes: Boxes,
    instants: Instants,
    sea: Backdrop,
    bent: LensShift,
) -> None:
    """Add the change of light by sources to the nodes of ``grid`` (rows, columns), ``nodes`` to a pixel, from pixel ``first`` on.

    Only sources in ``tile`` (left, right, top, bottom) [pixels] contribute.
    """
    high, wide = grid.shape
    for k in range(instants.weight.size):
        for b in range(boxes.column.size):
            column, row = boxes.column[b] + instants.across[k], boxes.row[b] + instants.down[k]
            at_column, at_row, weight = column, row, instants.weight[k]
            if bent.share != 0.0:
                x, y = column - bent.column, row - bent.row
                square = bent.share * (x * x + y * y) / (bent.corner * bent.corner)
                at_column, at_row = bent.column + x * (1.0 + square), bent.row + y * (1.0 + square)
                # area magnification of the distortion: tangential times radial stretch
                weight *= (1.0 + square) * (1.0 + 3.0 * square)
            if not (tile[0] <= at_column < tile[1] and tile[2] <= at_row < tile[3]):
                continue
            light = boxes.counted[b]
            if boxes.cover[b] != 0.0:
                light -= boxes.cover[b] * sea.counted * behind(sea, column + instants.sea_across[k], row + instants.sea_down[k])
            light *= weight
            x, y = (at_column - first[0]) * nodes, (at_row - first[1]) * nodes
            i, j = math.floor(x), math.floor(y)
            # the spline needs one node before and two behind
            if i < 1 or j < 1 or i + 2 >= wide or j + 2 >= high:
                continue
            across, down = _spline(x - i), _spline(y - j)
            for a in range(4):
                part = light * down[a]
                for c in range(4):
                    grid[j - 1 + a, i - 1 + c] += part * across[c]


@njit
def count_pixels(sums: np.ndarray, first: tuple[int, int], boxes: Boxes, instants: Instants, sea: Backdrop) -> None:
    """Add covered share, radiance, and radiance of the hidden sea to the pixels from ``first`` on, ``sums`` (3, rows, columns)."""
    high, wide = sums.shape[1], sums.shape[2]
    half = 0.5 * boxes.side
    for k in range(instants.weight.size):
        for b in range(boxes.column.size):
            column, row = boxes.column[b] + instants.across[k], boxes.row[b] + instants.down[k]
            left, top = math.floor(column - half), math.floor(row - half)
            weight, cover = instants.weight[k], boxes.cover[b]
            hidden = 0.0
            if cover != 0.0:
                hidden = cover * behind(sea, column + instants.sea_across[k], row + instants.sea_down[k])
            # a box across the border of pixels contributes to up to four of them
            in_left = min((left + 1 - column + half) / boxes.side, 1.0) if half > 0.0 else 1.0
            in_top = min((top + 1 - row + half) / boxes.side, 1.0) if half > 0.0 else 1.0
            for down in range(2):
                for across in range(2):
                    i, j = left + across - first[0], top + down - first[1]
                    share = weight * (in_left if across == 0 else 1.0 - in_left) * (in_top if down == 0 else 1.0 - in_top)
                    if share > 0.0 and 0 <= i < wide and 0 <= j < high:
                        sums[0, j, i] += share * cover
                        sums[1, j, i] += share * boxes.radiance[b]
                        sums[2, j, i] += share * hidden


@dataclass(frozen=True, eq=False)
class LocalLight:
    """Transfer of small sources to the pixels around them; make it with ``of``."""

    blur: Blur  #: Transfer of the optics.
    sampling: Sampling  #: Pixels and steady movement.
    nodes: int  #: Number of nodes of the grid along a side of a pixel.
    margin: int  #: Margin of a window around its sources [pixels].
    _filters: OrderedDict[tuple[int, int], NDArray[np.complex64]] = field(default_factory=OrderedDict, repr=False)

    @classmethod
    def of(cls, blur: Blur, sampling: Sampling, shortest: float) -> LocalLight:
        """Prepare the transfer for optics and pixels.

        Parameters
        ----------
        blur : Blur
            Transfer of the optics.
        sampling : Sampling
            Pixels and steady movement; its oversampling is not used.
        shortest : float
            Shortest wavelength of the band, which determines the cut-off of the optics [m].
        """
        cutoff = sampling.step * blur.optics.cutoff(shortest)
        # the cut-off in cycles per pixel times nodes per cycle
        nodes = max(math.ceil(NODES_PER_CYCLE * cutoff), 2)
        nodes += nodes % 2  # the middle of a pixel is a node
        wide = BLURS / (blur.optics.cutoff(blur.wavelength) * sampling.step) + 4.0 * blur.optics.jitter / sampling.step
        smear = max(abs(part) for part in sampling.smear) / sampling.step
        return cls(blur, sampling, nodes, math.ceil(min(max(wide, MARGINS[0]), MARGINS[1]) + smear))

    def filter(self, shape: tuple[int, int]) -> NDArray[np.complex64]:
        """Return the transfer for a window of ``shape`` (rows, columns) [pixels] over the splines' transform; latest ones are cached."""
        cached = self._filters.get(shape)
        if cached is None:
            m, step = self.nodes, self.sampling.step
            x, y = scipy.fft.rfftfreq(m * shape[1], 1.0 / m), scipy.fft.fftfreq(m * shape[0], 1.0 / m)
            total = sensor_mtf(self.blur, self.sampling, x[None, :] / step, y[:, None] / step)
            total = total / (np.sinc(x / m) ** 4)[None, :] / (np.sinc(y / m) ** 4)[:, None]
            phase = np.exp(1j * np.pi * x)[None, :] * np.exp(1j * np.pi * y)[:, None]  # a pixel's middle is half a pixel behind its edge
            cached = self._filters[shape] = (total * phase).astype(np.complex64)
            while len(self._filters) > CACHED:
                self._filters.popitem(last=False)
        return cached

    def changes(
        self,
        boxes: Boxes,
        instants: Instants,
        sea: Backdrop,
        bent: LensShift,
        requested: tuple[tuple[int, int] | None, tuple[int, int] | None] = (None, None),
    ) -> list[tuple[int, int, NDArray[np.float32]]]:
        """Return the change of the radiance on the pixels around sources in an exposure.

        Parameters
        ----------
        boxes : Boxes
            The sources.
        instants : Instants
            Their shifts during the exposure.
        sea : Backdrop
            Image of the sea behind them.
        bent : LensShift
            Distortion of the lens.
        requested : (columns, rows)
            First and end of the requested pixels, None for all: sources farther from them than the margin are left out.

        Returns
        -------
        list of (int, int, ndarray)
            Windows: first row and first column, which may lie outside the picture, and the change [W m-2 sr-1, (rows, columns)].
        """
        if boxes.column.size == 0 or instants.weight.size == 0:
            return []
        limits = list(_extent(boxes, instants, bent))
        for k, some in enumerate(requested):
            if some is not None:
                limits[2 * k] = max(limits[2 * k], some[0] - self.margin)
                limits[2 * k + 1] = min(limits[2 * k + 1], some[1] + self.margin)
        out = []
        for tile in _tiles(*limits):
            (left, wide), (top, high) = self._window(tile[0], tile[1]), self._window(tile[2], tile[3])
            first = (left, top)
            grid = np.zeros((high * self.nodes, wide * self.nodes))
            spread(grid, self.nodes, first, tile, _in_rows(boxes, instants, tile, bent), instants, sea, bent)
            if grid.any():
                out.append((first[1], first[0], self._transferred(grid, (high, wide), boxes.side)))
        return out

    def _window(self, low: float, high: float) -> tuple[int, int]:
        """Return first pixel and number of pixels of a window about sources between two places [pixels].

        The middles of window and sources are within a quarter of a pixel: otherwise light that wraps around from the other side would shift
        the mean place of a source.
        """
        size = 2 * self.margin + STEP * math.ceil((high - low - 1e-5) / STEP)
        middle = 0.5 * (low + high)
        size += round(2.0 * middle - size) % 2
        return round(middle - 0.5 * size), size

    def _transferred(self, grid: FloatArray, shape: tuple[int, int], side: float) -> NDArray[np.float32]:
        m = self.nodes
        spectrum = scipy.fft.rfft2(grid.astype(np.float32))
        spectrum *= self.filter(shape)
        if side > 0.0:  # the light of a box is a mean over it: its blur is divided out
            x, y = scipy.fft.rfftfreq(m * shape[1], 1.0 / m), scipy.fft.fftfreq(m * shape[0], 1.0 / m)
            spectrum /= (np.sinc(y * side)[:, None] * np.sinc(x * side)[None, :]).astype(np.float32)
        folded = spectrum.reshape(m, shape[0], -1).sum(axis=0)
        lines = scipy.fft.ifft(folded, axis=0)
        # the inverse transform divides by the nodes of a row, the window's integral by its pixels
        return np.asarray(scipy.fft.irfft(lines, m * shape[1], axis=1)[:, ::m] * np.float32(m), np.float32)


def _extent(boxes: Boxes, instants: Instants, bent: LensShift) -> tuple[float, float, float, float]:
    """Return left, right, top and bottom of all sources at all instants [pixels], with a small margin."""
    across = np.array([boxes.column.min() + instants.across.min(), boxes.column.max() + instants.across.max()])
    down = np.array([boxes.row.min() + instants.down.min(), boxes.row.max() + instants.down.max()])
    if bent.share != 0.0:
        x, y = across[:, None] - bent.column, down[None, :] - bent.row
        scale = 1.0 + bent.share * (x * x + y * y) / bent.corner**2
        corners = bent.column + x * scale, bent.row + y * scale
        spare = abs(bent.share) * max(float(np.ptp(across)), float(np.ptp(down)))  # sides of a box bend
        across = np.array([corners[0].min() - spare, corners[0].max() + spare])
        down = np.array([corners[1].min() - spare, corners[1].max() + spare])
    return float(across[0]), float(across[1]) + 1e-6, float(down[0]), float(down[1]) + 1e-6


def _in_rows(boxes: Boxes, instants: Instants, tile: tuple[float, float, float, float], bent: LensShift) -> Boxes:
    """Return the boxes that may be in the rows of a tile; boxes are in the order of their rows."""
    if bent.share != 0.0:
        return boxes
    first, end = np.searchsorted(boxes.row, [tile[2] - instants.down.max() - 1e-6, tile[3] - instants.down.min() + 1e-6])
    some = slice(int(first), int(end))
    column, row, counted, radiance, cover, side = boxes
    return Boxes(column[some], row[some], counted[some], radiance[some], cover[some], side)


def _tiles(left: float, right: float, top: float, bottom: float) -> list[tuple[float, float, float, float]]:
    """Return the tiles of an area [pixels]; a small area is one tile."""
    return [(*across, *down) for down in _cuts(top, bottom) for across in _cuts(left, right)]


def _cuts(low: float, high: float) -> list[tuple[float, float]]:
    """Return the parts of a length; a short one is one part, an empty one has none."""
    inner = np.arange(math.floor(low) + TILE, high, TILE, dtype=np.float64) if high - low > TILE else np.zeros(0)
    ends = [low, *(float(x) for x in inner), high]
    return list(itertools.pairwise(ends)) if low < high else []
