"""Mean maps of pixels that are no grid of azimuth and elevation: lines of sight through each pixel, averaged over its solid angle."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np

from seaglint.base.conventions import FloatArray, Progress, horizon_depression
from seaglint.imaging.camera.imager import Attitude, Imager
from seaglint.imaging.camera.pose import Pose

#: Mapped components, beside the sum of the radiances and its temperature.
MAPS: Final = ("path_radiance", "emitted_radiance", "sky_radiance", "glint_radiance", "glint_std")

#: Height of a pixel, or of a part of it, over its distance from the horizon, from which it is sampled more finely: below it the middle is
#: within 1e-4 of the mean.
ROW_SHARE: Final = 0.02

ROW_POINTS: Final = 8  #: Elevations averaged in such a pixel, and azimuths where columns are not upright and :data:`SIDE` do not serve.

CUT_POINTS: Final = 64  #: Elevations averaged in a whole row that the horizon cuts: the share of it that is sea is within 1/128.

#: Points along each side of a pixel that the horizon cuts: glint of a low Sun may end there, and 8 are up to 3 % off.
EDGE_POINTS: Final = 24

SIDE: Final = 3  #: Lines of sight along each side of any other pixel that is not small, as many as the cells of a turned image.

#: Root of the solid angle of a pixel below which its middle serves [rad]: glint varies over degrees, the middle is within 1e-4.
SMALL: Final = 2e-3

BLOCK: Final = 1 << 17  #: Lines of sight at a time: memory stays below 100 MB.

#: Four components of the radiance [W m-2 sr-1] and the variance of glint [(5, n)], of elevations and azimuths [rad] and the solid angle of
#: the pixels that they belong to [sr, (n,)].
Sights = Callable[[FloatArray, FloatArray, FloatArray], FloatArray]


def over_pixels(imager: Imager, pose: Pose, seen: Sights, progress: Progress | None = None) -> dict[str, FloatArray]:
    """Means over the pixels of a camera [W m-2 sr-1, (rows, columns)], by the names of :data:`MAPS`.

    Cells of the sea are independent, so a pixel's variance is the mean of what its lines of sight would have with all of its solid angle.
    """
    rows, columns = imager.rows, imager.columns
    out = np.empty((len(MAPS), rows * columns))
    dip, attitude = horizon_depression(pose.height), pose.attitude
    size, tell = BLOCK // 4, progress or (lambda done, total: None)
    for first in range(0, rows * columns, size):
        tell(first, rows * columns)
        pixels = np.arange(first, min(first + size, rows * columns))
        quarters = _points(pixels, columns, 2)
        elevation = np.arctan2(*_rise_and_run(imager.directions(attitude, *quarters)))
        middle, spread = elevation.mean(axis=1), 2.0 * np.ptp(elevation, axis=1)
        below = np.abs(middle + dip)
        sides = np.where(imager.solid_angle(attitude, *quarters).mean(axis=1) < SMALL**2, 1, SIDE)
        sides[spread > ROW_SHARE * below] = SIDE
        sides[spread > SIDE * ROW_SHARE * below] = ROW_POINTS
        sides[0.5 * spread > below] = EDGE_POINTS
        for side in (1, SIDE, ROW_POINTS, EDGE_POINTS):
            chosen, most = pixels[sides == side], BLOCK // side**2
            for some in (chosen[i : i + most] for i in range(0, chosen.size, most)):
                out[:, some] = _means(imager, attitude, _points(some, columns, side), seen)
    tell(rows * columns, rows * columns)
    out[-1] = np.sqrt(out[-1])
    return {name: values.reshape(rows, columns) for name, values in zip(MAPS, out, strict=True)}


def _points(pixels: np.ndarray, columns: int, side: int) -> tuple[FloatArray, FloatArray]:
    """Image points across and down [pixels, (n, side squared)] of pixels counted row by row."""
    row, column = np.divmod(pixels, columns)
    down, across = np.divmod(np.arange(side * side), side)
    return column[:, None] + (across + 0.5) / side, row[:, None] + (down + 0.5) / side


def _rise_and_run(sight: FloatArray) -> tuple[FloatArray, FloatArray]:
    return sight[..., 2], np.hypot(sight[..., 0], sight[..., 1])


def _means(imager: Imager, attitude: Attitude, points: tuple[FloatArray, FloatArray], seen: Sights) -> FloatArray:
    """Return means over the points of each pixel, weighted by the solid angle of each point [(5, pixels)]."""
    sight, weight = imager.directions(attitude, *points), imager.solid_angle(attitude, *points)
    pixel = weight.mean(axis=1)
    elevation, azimuth = np.arctan2(*_rise_and_run(sight)), np.arctan2(sight[..., 0], sight[..., 1])
    of_pixel = np.repeat(pixel, weight.shape[1])
    values = seen(elevation.ravel(), azimuth.ravel(), of_pixel).reshape(-1, *weight.shape)
    return np.asarray((values * weight).mean(axis=2) / pixel)
