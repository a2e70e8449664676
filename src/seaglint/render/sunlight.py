"""The Sun over a scene, as kernels see it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from seaglint.constants import SOLAR_ANGULAR_RADIUS


class Sunlight(NamedTuple):
    """The Sun as kernels see it: the unit vector to it, the tangent ``t_*`` in its vertical plane and the horizontal one ``c_*``, the
    horizontal unit vector towards it, its centre's elevation, and the tangents of its limbs' elevations.
    """

    shining: bool
    azimuth: float
    east: float
    north: float
    up: float
    t_east: float
    t_north: float
    t_up: float
    c_east: float
    c_north: float
    horizontal_east: float
    horizontal_north: float
    elevation: float
    lower_tangent: float
    upper_tangent: float


def sunlight(zenith: float, azimuth: float, shining: bool) -> Sunlight:
    """The Sun's direction, the tangents to it, in its vertical plane and horizontal, and its limbs."""
    sz, cz, sa, ca = np.sin(zenith), np.cos(zenith), np.sin(azimuth), np.cos(azimuth)
    elevation = 0.5 * np.pi - zenith
    limbs = np.tan(np.clip(elevation + np.array([-1.0, 1.0]) * SOLAR_ANGULAR_RADIUS, -1.5, 0.5 * np.pi - 1e-6))
    values = (azimuth, sz * sa, sz * ca, cz, -cz * sa, -cz * ca, sz, ca, -sa, sa, ca, elevation, *limbs)
    return Sunlight(shining, *(float(v) for v in values))
