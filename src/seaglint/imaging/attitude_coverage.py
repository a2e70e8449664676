"""Directions that the attitudes of a turning camera need, and the check whether a prepared scene covers them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray
from seaglint.imaging.camera.image_grid import Camera
from seaglint.imaging.swept import SAME, beyond


@dataclass(frozen=True, eq=False)
class AngleSurvey:
    """Azimuth-elevation grid that serves all attitudes, and the highest elevation and the azimuths of the pixels that it does not."""

    grid: Camera | None
    walk_from: float
    walk_azimuths: tuple[float, float]


def covers(made: AngleSurvey, requested: AngleSurvey) -> bool:
    """True if a prepared scene covers another camera."""
    one, other = made.grid, requested.grid
    if other is not None and (one is None or beyond(one, other) > SAME or other.row_step < one.row_step * (1.0 - SAME)):
        return False
    (left, right), (first, last) = made.walk_azimuths, requested.walk_azimuths
    if first == last:
        return True
    turn = 2.0 * np.pi * np.round((0.5 * (first + last) - 0.5 * (left + right)) / (2.0 * np.pi))
    around = right - left >= 2.0 * np.pi - SAME
    return requested.walk_from <= made.walk_from + SAME and (around or (left <= first - turn + SAME and last - turn <= right + SAME))


def corners_of(azimuth: FloatArray, swept: NDArray[np.bool_]) -> tuple[float, float]:
    """Least and greatest azimuth of the corners of some pixels [rad]."""
    touched = np.zeros(azimuth.shape, bool)
    for rows in (slice(None, -1), slice(1, None)):
        for columns in (slice(None, -1), slice(1, None)):
            touched[rows, columns] |= swept
    return float(azimuth[touched].min()), float(azimuth[touched].max())
