r"""Cameras: the upright image grid, lines of sight in any attitude, and images resampled from the upright grid by exact areas.

The upright grid has equal steps of azimuth (columns, clockwise) and of elevation (rows, row 0 on top).

In azimuth and the sine of elevation equal areas are equal solid angles. A pixel of a tilted camera is a quadrilateral in this plane, a cell
of the sweep's image is a rectangle, and

.. math:: L_{pixel} = \sum_{cells} w L_{cell}, \qquad w = \Omega(pixel \cap cell) / \Omega(pixel)

with the overlaps from clipping. Neighbouring pixels share their corners, so the sum over pixels conserves energy.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from seaglint.base.conventions import FloatArray, wrap_angle
from seaglint.base.errors import DomainError
from seaglint.base.jit import kernel, njit
from seaglint.base.limits import WIDEST_PINHOLE_DEG


@dataclass(frozen=True)
class Camera:
    """Upright camera above the point (0, 0) of the sea, with pixels of equal azimuth and elevation steps.

    Parameters
    ----------
    height : float
        Height above the mean sea [m].
    azimuth, elevation : float
        Direction of the image centre [rad]; azimuth clockwise from north, elevation negative below the horizontal.
    width, height_angle : float
        Field of view in azimuth and elevation [rad].
    columns, rows : int
        Pixels in azimuth and elevation.
    """

    height: float
    azimuth: float
    elevation: float
    width: float
    height_angle: float
    columns: int
    rows: int

    def __post_init__(self) -> None:
        if not self.height > 0.0:
            raise DomainError(
                f"sensor height = {self.height:g} m is not above the sea; give a height > 0 m",
                name="sensor_height",
                value=self.height,
                allowed="above 0 m",
            )
        if self.columns < 1 or self.rows < 1:
            raise DomainError(f"pixels = [{self.columns}, {self.rows}]: an image needs at least 1 x 1 pixels")
        if not 0.0 < self.width <= 2.0 * np.pi + 1e-12:
            raise DomainError(f"field of view in azimuth = {np.degrees(self.width):g} deg is outside (0, 360] deg")
        if self.bottom < -0.5 * np.pi - 1e-9 or self.top > 0.5 * np.pi + 1e-9:
            raise DomainError(
                f"elevations {np.degrees(self.bottom):g} to {np.degrees(self.top):g} deg leave -90 to 90 deg; "
                "lower the field of view or move elevation_deg"
            )

    @property
    def column_step(self) -> float:
        """Azimuth step between columns [rad]."""
        return self.width / self.columns

    @property
    def row_step(self) -> float:
        """Elevation step between rows [rad]."""
        return self.height_angle / self.rows

    @property
    def top(self) -> float:
        """Elevation of the upper edge of row 0 [rad]."""
        return self.elevation + 0.5 * self.height_angle

    @property
    def bottom(self) -> float:
        """Elevation of the lower edge of the last row [rad]."""
        return self.elevation - 0.5 * self.height_angle

    @property
    def azimuths(self) -> FloatArray:
        """Azimuths of the column centres [rad], ascending (not wrapped)."""
        return np.asarray(self.azimuth - 0.5 * self.width + (np.arange(self.columns) + 0.5) * self.column_step)

    @property
    def elevations(self) -> FloatArray:
        """Elevations of the row centres [rad], descending."""
        return np.asarray(self.top - (np.arange(self.rows) + 0.5) * self.row_step)


Projection = Literal["equal-angle", "pinhole"]

WIDEST_PINHOLE = np.radians(WIDEST_PINHOLE_DEG)  #: Largest field of view of a plane image [rad].

CORNERS = 10  #: Largest number of corners of a quadrilateral cut by two parallel lines, and two more.


@dataclass(frozen=True)
class Attitude:
    """Attitude of a camera [rad]: azimuth clockwise from north, elevation above the horizontal, roll about the line of sight.

    A positive roll turns the camera clockwise for a viewer behind it (right side down), so the scene turns counter-clockwise in the image.
    """

    azimuth: float
    elevation: float
    roll: float = 0.0

    @property
    def axes(self) -> FloatArray:
        """Unit vectors to the right of the image, to its top and into it, each (east, north, up) [1, (3, 3)]."""
        sa, ca, se, ce = math.sin(self.azimuth), math.cos(self.azimuth), math.sin(self.elevation), math.cos(self.elevation)
        right, up, forward = np.array([ca, -sa, 0.0]), np.array([-se * sa, -se * ca, ce]), np.array([ce * sa, ce * ca, se])
        s, c = math.sin(self.roll), math.cos(self.roll)
        return np.stack([c * right - s * up, s * right + c * up, forward])


@dataclass(frozen=True)
class Imager:
    """Pixels of a camera, in any attitude.

    Parameters
    ----------
    projection : "equal-angle" or "pinhole"
        Equal steps of azimuth and elevation, turned rigidly about the line of sight by the roll; or a plane image, equal steps of the
        tangent.
    width, height_angle : float
        Full field of view [rad].
    columns, rows : int
        Pixels.
    """

    projection: Projection
    width: float
    height_angle: float
    columns: int
    rows: int

    def __post_init__(self) -> None:
        if self.columns < 1 or self.rows < 1:
            raise DomainError(f"pixels = [{self.columns}, {self.rows}]: an image needs at least 1 x 1 pixels")
        widest = WIDEST_PINHOLE if self.projection == "pinhole" else 2.0 * np.pi
        if not (0.0 < self.width <= widest + 1e-12 and 0.0 < self.height_angle <= min(widest, np.pi) + 1e-12):
            raise DomainError(
                f"field of view {np.degrees(self.width):g} x {np.degrees(self.height_angle):g} deg is outside (0, "
                f"{np.degrees(widest):g}] x (0, {np.degrees(min(widest, np.pi)):g}] deg of a {self.projection} camera"
            )

    @property
    def goes_round(self) -> bool:
        """True if the image closes on itself: its last column is a neighbour of its first."""
        return self.projection == "equal-angle" and self.width > 2.0 * np.pi - 1e-9

    def directions(self, attitude: Attitude, across: ArrayLike, down: ArrayLike) -> FloatArray:
        """Return unit vectors (east, north, up) of the lines of sight through image points.

        Parameters
        ----------
        attitude : Attitude
            Where the camera points.
        across, down : array_like
            Pixels from the left and from the top edge of the image; corners are whole numbers, centres halves [(...)].

        Returns
        -------
        ndarray
            Unit vectors [1, (..., 3)].

        Examples
        --------
        >>> eye = Imager("pinhole", 0.2, 0.1, 200, 100)
        >>> east = eye.directions(Attitude(np.pi / 2, 0.0), 100, 50)
        >>> bool(np.allclose(east, [1.0, 0.0, 0.0]))
        True
        """
        x, y = np.broadcast_arrays(np.asarray(across) / self.columns - 0.5, 0.5 - np.asarray(down) / self.rows)
        axes = attitude.axes
        if self.projection == "pinhole":
            plane = np.stack([2.0 * x * np.tan(0.5 * self.width), 2.0 * y * np.tan(0.5 * self.height_angle), np.ones_like(x)], axis=-1)
            plane /= np.linalg.norm(plane, axis=-1, keepdims=True)
            return np.asarray(plane @ axes)
        azimuth, elevation = attitude.azimuth + x * self.width, attitude.elevation + y * self.height_angle
        level = np.stack([np.cos(elevation) * np.sin(azimuth), np.cos(elevation) * np.cos(azimuth), np.sin(elevation)], axis=-1)
        if attitude.roll == 0.0:
            return level
        # from the world's axes to the unrolled camera's, and back through the rolled one
        return np.asarray(level @ (Attitude(attitude.azimuth, attitude.elevation).axes.T @ axes))

    def solid_angle(self, attitude: Attitude, across: ArrayLike, down: ArrayLike) -> FloatArray:
        """Return the solid angle per pixel at image points [sr, (...)]; points as in :meth:`directions`."""
        x, y = np.broadcast_arrays(np.asarray(across) / self.columns - 0.5, 0.5 - np.asarray(down) / self.rows)
        if self.projection == "pinhole":
            wide, high = 2.0 * np.tan(0.5 * self.width), 2.0 * np.tan(0.5 * self.height_angle)
            return np.asarray(wide * high / (self.columns * self.rows) * (1.0 + (x * wide) ** 2 + (y * high) ** 2) ** -1.5)
        # the roll turns the grid rigidly
        step = self.width / self.columns * self.height_angle / self.rows
        return np.asarray(step * np.cos(attitude.elevation + y * self.height_angle))

    def corners(self, attitude: Attitude) -> FloatArray:
        """Return the lines of sight through the corners of all pixels, unit vectors [1, (rows + 1, columns + 1, 3)]."""
        return self.directions(attitude, np.arange(self.columns + 1.0), np.arange(self.rows + 1.0)[:, None])

    def centres(self, attitude: Attitude) -> tuple[FloatArray, FloatArray]:
        """Return azimuth (continuous within a half circle to both sides) and elevation of the pixel centres [rad, (rows, columns)]."""
        v = self.directions(attitude, np.arange(self.columns) + 0.5, np.arange(self.rows)[:, None] + 0.5)
        azimuth = attitude.azimuth + wrap_angle(np.arctan2(v[..., 0], v[..., 1]) - attitude.azimuth)
        return azimuth, np.arctan2(v[..., 2], np.hypot(v[..., 0], v[..., 1]))

    def camera(self, height: float, attitude: Attitude) -> Camera | None:
        """Return the image grid of the sweep for a camera of equal angles without roll, else None."""
        if self.projection != "equal-angle" or attitude.roll != 0.0:
            return None
        return Camera(height, attitude.azimuth, attitude.elevation, self.width, self.height_angle, self.columns, self.rows)


def pixels_of(camera: Camera) -> Imager:
    """Return the pixels of an upright image grid, for any attitude; the inverse of :meth:`Imager.camera`."""
    return Imager("equal-angle", camera.width, camera.height_angle, camera.columns, camera.rows)


def pixel_pitch(corners: FloatArray) -> tuple[float, float]:
    """Return the least and the median angle between neighbouring corners [rad]."""
    across = np.linalg.norm(np.diff(corners, axis=1), axis=-1)
    down = np.linalg.norm(np.diff(corners, axis=0), axis=-1)
    pitch = np.minimum(np.minimum(across[1:], across[:-1]), np.minimum(down[:, 1:], down[:, :-1]))
    return float(pitch.min()), float(np.median(pitch))


def pixel_elevations(corners: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the elevations of the lowest and the highest corner of each pixel [rad, (rows, columns)]."""
    elevation = np.arctan2(corners[..., 2], np.hypot(corners[..., 0], corners[..., 1]))
    four = (elevation[:-1, :-1], elevation[:-1, 1:], elevation[1:, :-1], elevation[1:, 1:])
    return np.minimum(np.minimum(four[0], four[1]), np.minimum(four[2], four[3])), np.maximum(
        np.maximum(four[0], four[1]), np.maximum(four[2], four[3])
    )


class SweepGrid(NamedTuple):
    """Cells of the sweep's image in azimuth and the sine of elevation."""

    middle: float  #: Azimuth of the middle of the image [rad].
    step: float  #: Width of a column [rad].
    columns: int
    circle: bool  #: True for a full circle, on which the first column follows the last.
    top: float  #: Elevation of the upper edge of row 0 [rad].
    per_radian: float  #: Rows per radian, the inverse of their step.
    edges: np.ndarray  #: Sines of the elevations of all edges of rows (rows + 1,).


def cells_of(camera: Camera) -> SweepGrid:
    """Return the cells of an azimuth-elevation image."""
    edges = np.sin(np.clip(camera.top - np.arange(camera.rows + 1) * camera.row_step, -0.5 * np.pi, 0.5 * np.pi))
    circle = camera.width > 2.0 * np.pi - 1e-9
    return SweepGrid(camera.azimuth, camera.column_step, camera.columns, bool(circle), camera.top, 1.0 / camera.row_step, edges)


class Quads(NamedTuple):
    """Pixels as quadrilaterals: corners in columns and in sines of elevation, (pixels, 4), and the cells of their bounding box."""

    column: FloatArray
    sine: FloatArray
    bound: NDArray[np.int64]

    def some(self, which: NDArray[np.bool_]) -> Quads:
        """Return a part of the quadrilaterals."""
        return Quads(self.column[which], self.sine[which], self.bound[which])


def quads(corners: FloatArray, pixels: NDArray[np.int64], cells: SweepGrid, azimuth_of_image: float) -> Quads:
    """Return quadrilaterals of some pixels (flat indices); columns are continuous within a half circle about ``azimuth_of_image``."""
    # wrapped in three steps: the image from the grid, the first corner from the image, the other corners from the first
    width = corners.shape[1]
    row, column = np.divmod(pixels, width - 1)
    first = row * width + column
    four = np.stack([first, first + 1, first + width + 1, first + width], axis=1)
    # each corner belongs to four pixels: its angles are computed once
    azimuth = np.arctan2(corners[..., 0], corners[..., 1]).ravel()[four]
    sine, elevation = corners[..., 2].ravel()[four], np.arcsin(np.clip(corners[..., 2], -1.0, 1.0)).ravel()[four]
    u = wrap_angle(azimuth_of_image - cells.middle) + wrap_angle(azimuth[:, :1] - azimuth_of_image) + wrap_angle(azimuth - azimuth[:, :1])
    u = u / cells.step + 0.5 * cells.columns
    row_of = (cells.top - elevation) * cells.per_radian
    # one cell more on each side: the rounding of a corner on an edge
    bound = (np.ceil(np.ptp(u, axis=1)) + 2) * (np.ceil(np.ptp(row_of, axis=1)) + 2)
    return Quads(u, sine, bound.astype(np.int64))


def inside(quadrilaterals: Quads, cells: SweepGrid) -> NDArray[np.bool_]:
    """Return True for each quadrilateral that the cells cover [bool, (pixels,)]."""
    rows = (quadrilaterals.sine.max(axis=1) <= cells.edges[0]) & (quadrilaterals.sine.min(axis=1) >= cells.edges[-1])
    if cells.circle:
        return np.asarray(rows)
    return np.asarray(rows & (quadrilaterals.column.min(axis=1) >= 0.0) & (quadrilaterals.column.max(axis=1) <= cells.columns))


@njit
def cut(poly: np.ndarray, n: int, axis: int, bound: float, sign: float, out: np.ndarray) -> int:
    """Cut a polygon (n corners) to one side of a line, ``sign (p[axis] - bound) >= 0``; return its number of corners."""
    count = 0
    for i in range(n):
        j = i + 1 if i + 1 < n else 0
        a, b = sign * (poly[i, axis] - bound), sign * (poly[j, axis] - bound)
        if a >= 0.0:
            out[count, 0], out[count, 1] = poly[i, 0], poly[i, 1]
            count += 1
        if (a > 0.0 and b < 0.0) or (a < 0.0 and b > 0.0):
            f = a / (a - b)
            out[count, 0] = poly[i, 0] + f * (poly[j, 0] - poly[i, 0])
            out[count, 1] = poly[i, 1] + f * (poly[j, 1] - poly[i, 1])
            count += 1
    return count


@kernel
def area(poly: np.ndarray, n: int) -> float:
    """Return the area of a polygon of ``n`` corners [square of its unit], counted from its first corner."""
    twice = 0.0
    for i in range(n):
        j = i + 1 if i + 1 < n else 0
        twice += (poly[i, 0] - poly[0, 0]) * (poly[j, 1] - poly[0, 1]) - (poly[j, 0] - poly[0, 0]) * (poly[i, 1] - poly[0, 1])
    return abs(0.5 * twice)


@njit
def overlaps(column: np.ndarray, sine: np.ndarray, cells: SweepGrid, work: np.ndarray, index: np.ndarray, weight: np.ndarray) -> int:
    """Compute the cells (row times columns plus column) that a quadrilateral overlaps and their weights, and return their number.

    The weights add to 1. ``work`` holds four polygons.
    """
    # corners are counted from a column and a sine inside the quadrilateral: small numbers lose fewer digits in the areas
    rows = cells.edges.shape[0] - 1
    quad, strip, cleft, left = work[0], work[1], work[2], work[3]
    base = math.floor(column.min())
    middle = 0.25 * (sine[0] + sine[1] + sine[2] + sine[3])
    for i in range(4):
        quad[i, 0], quad[i, 1] = column[i] - base, sine[i] - middle
    top = int((cells.top - math.asin(min(max(sine.max(), -1.0), 1.0))) * cells.per_radian)
    row = min(max(top - 1, 0), rows - 1)
    count, total = 0, 0.0
    low = sine.min()
    # edges descend, as row 0 is on top
    while row < rows and cells.edges[row] > low:
        n = cut(quad, 4, 1, cells.edges[row] - middle, -1.0, cleft)
        n = cut(cleft, n, 1, cells.edges[row + 1] - middle, 1.0, strip)
        if n >= 3:
            first, last = strip[0, 0], strip[0, 0]
            for i in range(1, n):
                first, last = min(first, strip[i, 0]), max(last, strip[i, 0])
            # area to the left of each column's right edge, less the area to the left of the edge before
            before = 0.0
            for c in range(int(first), math.ceil(last)):
                m = cut(strip, n, 0, c + 1.0, -1.0, left)
                now = area(left, m)
                if now > before:
                    at = base + c
                    at = at % cells.columns if cells.circle else min(max(at, 0), cells.columns - 1)
                    index[count] = row * cells.columns + at
                    weight[count] = now - before
                    total += now - before
                    count += 1
                before = now
        row += 1
    for i in range(count):
        weight[i] /= total
    return count


@njit
def fill_weights(
    column: np.ndarray,
    sine: np.ndarray,
    cells: SweepGrid,
    start: np.ndarray,
    count: np.ndarray,
    index: np.ndarray,
    weight: np.ndarray,
    part: tuple[int, int],
) -> None:
    """Compute ``overlaps`` of a part of the quadrilaterals; pixel ``p`` has ``count[p]`` cells and weights from ``start[p]`` on."""
    work = np.empty((4, CORNERS, 2))
    for p in range(part[0], part[1]):
        count[p] = overlaps(column[p], sine[p], cells, work, index[start[p] : start[p + 1]], weight[start[p] : start[p + 1]])


@njit
def apply_weights(
    start: np.ndarray,
    count: np.ndarray,
    index: np.ndarray,
    weight: np.ndarray,
    images: np.ndarray,
    pixels: np.ndarray,
    out: np.ndarray,
    part: tuple[int, int],
) -> None:
    """Compute weighted sums of ``images`` (k, cells) in a part of the named pixels of ``out`` (k, all pixels)."""
    for p in range(part[0], part[1]):
        for k in range(images.shape[0]):
            total = 0.0
            for i in range(start[p], start[p] + count[p]):
                total += weight[i] * images[k, index[i]]
            out[k, pixels[p]] = total


@njit
def resample_at_once(
    column: np.ndarray,
    sine: np.ndarray,
    cells: SweepGrid,
    most: int,
    images: np.ndarray,
    pixels: np.ndarray,
    out: np.ndarray,
    part: tuple[int, int],
) -> None:
    """Apply ``fill_weights`` and ``apply_weights`` without storing the weights; ``most``: largest number of cells under a pixel."""
    work = np.empty((4, CORNERS, 2))
    index, weight = np.empty(most, np.int32), np.empty(most, np.float32)
    for p in range(part[0], part[1]):
        n = overlaps(column[p], sine[p], cells, work, index, weight)
        for k in range(images.shape[0]):
            total = 0.0
            for i in range(n):
                total += weight[i] * images[k, index[i]]
            out[k, pixels[p]] = total


@dataclass(frozen=True, eq=False)
class Resampling:
    """Weights of the sweep's cells in a camera's pixels.

    The n-th pixel has ``count[n]`` weights from ``start[n]`` on.
    """

    pixels: NDArray[np.int64]  #: Flat indices of the pixels.
    start: NDArray[np.int64]
    count: NDArray[np.int32]
    index: NDArray[np.int32]  #: Flat indices of the cells.
    weight: NDArray[np.float32]
