r"""Position of a body for a sensor: axes at the sensor, the plane and the image on which the body is sampled, and the grid of samples.

The sea is a sphere of the effective Earth radius :math:`R'`. A body with its origin ``z`` above the mean sea at an arc ``r`` from the
sensor's foot has, in the sensor's axes (east, north, up), the place

.. math:: p = ((R'+z)\sin\psi\;a,\;(R'+z)\cos\psi - R' - h), \qquad \psi = r/R'

with the horizontal unit vector ``a`` of its azimuth; the body's vertical is inclined by :math:`\psi`, so that the hull of a far ship is
below the horizon. A body is rigid: all of it has the axes at its origin.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from seaglint.base.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.base.conventions import FloatArray
from seaglint.base.jit import kernel, njit
from seaglint.imaging.camera.imager import Attitude, Imager
from seaglint.imaging.camera.pose import Pose
from seaglint.objects.body import Placement


class Stand(NamedTuple):
    """Body at an instant in the sensor's axes."""

    place: FloatArray  #: Place of its origin [m, (3,)].
    turn: FloatArray  #: Rotation from the body's axes to the sensor's (3, 3).
    #: Upward unit normal of the plane of the waterline and the plane's offset along it [m], (4,); points above the waterline have a greater
    #: offset.
    water: FloatArray


def stand(placement: Placement, pose: Pose) -> Stand:
    """Return place and rotation of a body in the axes (east, north, up) of a sensor."""
    east, north = placement.position[0] - pose.east, placement.position[1] - pose.north
    height, arc = float(placement.position[2]), math.hypot(east, north)
    s, c = (east / arc, north / arc) if arc > 0.0 else (0.0, 1.0)
    psi = arc / EFFECTIVE_EARTH_RADIUS
    sine, drop = math.sin(psi), 2.0 * math.sin(0.5 * psi) ** 2
    radius = EFFECTIVE_EARTH_RADIUS + height
    place = np.array([radius * sine * s, radius * sine * c, height - pose.height - radius * drop])
    # axes at the body's place: away from the sensor, inclined by psi, and across
    ahead, aside = np.array([(1.0 - drop) * s, (1.0 - drop) * c, -sine]), np.array([c, -s, 0.0])
    axes = np.stack([s * ahead + c * aside, c * ahead - s * aside, np.array([sine * s, sine * c, 1.0 - drop])], axis=1)
    if placement.water is None:  # the mean sea under the origin; over a body it is a plane
        normal, point = axes[:, 2], place - height * axes[:, 2]
    else:
        normal, point = axes @ placement.water[0], place + axes @ (placement.water[1] - placement.position)
    return Stand(place, axes @ placement.rotation, np.append(normal, normal @ point))


@dataclass(frozen=True, eq=False)
class TangentPlane:
    """Plane across the line of sight to a body: points are given by their tangents to the right and up, and one over the depth [1/m].

    Straight edges are straight on the plane, for any camera.
    """

    axes: FloatArray  #: Unit vectors to the right, up and to the body (rows), in the sensor's axes.

    @classmethod
    def to(cls, place: FloatArray) -> TangentPlane:
        """Return the plane across the direction of a place [m]."""
        ahead = place / np.linalg.norm(place)
        level = math.hypot(ahead[0], ahead[1])
        right = np.array([ahead[1], -ahead[0], 0.0]) / level if level > 1e-12 else np.array([1.0, 0.0, 0.0])
        return cls(np.stack([right, np.cross(right, ahead), ahead]))


class Lens(NamedTuple):
    """Conversion of image points to directions: ``turn @ (a u, a v, b)`` with (u, v) of columns and (a, b) of rows (``lens``)."""

    turn: np.ndarray
    plane: bool
    across: tuple[float, float]
    down: tuple[float, float]
    pixel: float  #: Solid angle of a pixel where its density is 1 [sr]; the density is ``a / |direction|^3``.


def lens(imager: Imager, attitude: Attitude) -> Lens:
    """Return the lens of a camera: columns and rows become angles, or tangents of a plane image, as ``first + step x``."""
    axes = attitude.axes
    if imager.projection == "pinhole":
        wide, high = 2.0 * math.tan(0.5 * imager.width), 2.0 * math.tan(0.5 * imager.height_angle)
        # (right, into the image, up): the form (a u, a v, b) of a lens
        turn = np.ascontiguousarray(axes[[0, 2, 1]].T)
        steps = (wide / imager.columns, -high / imager.rows)
        return Lens(turn, True, (-0.5 * wide, steps[0]), (0.5 * high, steps[1]), -steps[0] * steps[1])
    # angles are of the unrolled camera; only the roll turns them
    turn = np.eye(3) if attitude.roll == 0.0 else (Attitude(attitude.azimuth, attitude.elevation).axes.T @ axes).T
    steps = (imager.width / imager.columns, -imager.height_angle / imager.rows)
    first = (attitude.azimuth - 0.5 * imager.width, attitude.elevation + 0.5 * imager.height_angle)
    return Lens(np.ascontiguousarray(turn), False, (first[0], steps[0]), (first[1], steps[1]), -steps[0] * steps[1])


@kernel
def image_point(lens: Lens, direction: tuple[float, float, float], about: float) -> tuple[float, float, bool]:
    """Return column and row of a direction [pixels], the inverse of ``Lens``, and a flag for directions in front of the camera.

    Of columns that differ by a full circle the result is the nearest to ``about``.
    """
    t, (x, y, z) = lens.turn, direction
    u, v, w = t[0, 0] * x + t[1, 0] * y + t[2, 0] * z, t[0, 1] * x + t[1, 1] * y + t[2, 1] * z, t[0, 2] * x + t[1, 2] * y + t[2, 2] * z
    if lens.plane:
        if v <= 0.0:
            return 0.0, 0.0, False
        return (u / v - lens.across[0]) / lens.across[1], (w / v - lens.down[0]) / lens.down[1], True
    column = (math.atan2(u, v) - lens.across[0]) / lens.across[1]
    circle = 2.0 * math.pi / lens.across[1]
    # whole turns, so that a body across the seam of a panorama has continuous columns
    column += circle * math.floor((about - column) / circle + 0.5)
    return column, (math.atan2(w, math.sqrt(u * u + v * v)) - lens.down[0]) / lens.down[1], True


@njit
def project(surface: np.ndarray, axes: np.ndarray, lens: Lens, about: float) -> tuple[np.ndarray, np.ndarray]:
    """Project points [m, (n, 3)] to a plane (tangents and one over the depth, 0 behind the sensor or the camera) and the image [pixels]."""
    point, image = np.zeros((surface.shape[0], 3)), np.zeros((surface.shape[0], 2))
    for n in range(surface.shape[0]):
        x, y, z = surface[n, 0], surface[n, 1], surface[n, 2]
        depth = axes[2, 0] * x + axes[2, 1] * y + axes[2, 2] * z
        ahead = depth > 1e-3 * math.sqrt(x * x + y * y + z * z)
        scale = 1.0 / depth if ahead else 1.0
        point[n, 0] = (axes[0, 0] * x + axes[0, 1] * y + axes[0, 2] * z) * scale
        point[n, 1] = (axes[1, 0] * x + axes[1, 1] * y + axes[1, 2] * z) * scale
        column, row, seen = image_point(lens, (x, y, z), about)
        point[n, 2] = scale if ahead and seen else 0.0
        image[n, 0], image[n, 1] = column, row
    return point, image


class Grid(NamedTuple):
    """Cells over part of an image with one sample each: a whole number of cells to a pixel along either side."""

    first: tuple[int, int]  #: Column and row of the first pixel.
    pixels: tuple[int, int]  #: Number of columns and rows.
    cells: tuple[int, int]  #: Number of cells in a pixel, across and down.
    begin: tuple[int, int]  #: First cell along each side, counted from the image's corner.
    size: tuple[int, int]  #: Number of cells along each side.


FEWEST_CELLS = 8  #: Least number of cells along a pixel's side.

CELLS_ACROSS = 96  #: Number of cells across a small body's box, for a solid angle within some 0.1 %.

MOST_CELLS = 1 << 20  #: Largest number of cells in memory; larger grids are drawn in strips of rows.


def grid_over(box: tuple[float, float, float, float], fewest: int = FEWEST_CELLS) -> Grid:
    """Return a grid of cells over a box (left, right, top, bottom) [pixels], at least ``fewest`` along a pixel's side."""
    cells, begin, size, first, pixels = [], [], [], [], []
    for low, high in ((box[0], box[1]), (box[2], box[3])):
        # small bodies have more cells to a pixel, large ones no fewer than ``fewest``
        n = max(math.ceil(CELLS_ACROSS / max(high - low, 1e-9)), fewest)
        a, b = math.floor(low * n), math.ceil(high * n)
        b = max(b, a + 1)
        cells.append(n)
        begin.append(a)
        size.append(b - a)
        first.append(a // n)
        pixels.append((b - 1) // n - a // n + 1)
    return Grid((first[0], first[1]), (pixels[0], pixels[1]), (cells[0], cells[1]), (begin[0], begin[1]), (size[0], size[1]))


def strips(grid: Grid) -> list[Grid]:
    """Return parts of a grid of whole rows of pixels, each with at most ``MOST_CELLS`` cells or one row."""
    if grid.size[0] * grid.size[1] <= MOST_CELLS:
        return [grid]
    n = grid.cells[1]
    rows = max(MOST_CELLS // (grid.size[0] * n), 1)
    out, end = [], grid.begin[1] + grid.size[1]
    row = grid.first[1]
    while row * n < end:
        a, b = max(row * n, grid.begin[1]), min((row + rows) * n, end)
        out.append(
            Grid((grid.first[0], row), (grid.pixels[0], (b - 1) // n - row + 1), grid.cells, (grid.begin[0], a), (grid.size[0], b - a))
        )
        row += rows
    return out
