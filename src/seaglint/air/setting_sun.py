"""Visible part of a Sun that the horizon cuts."""

from __future__ import annotations

import math

from seaglint.base.constants import SOLAR_ANGULAR_RADIUS
from seaglint.base.jit import kernel


@kernel
def visible_part_kernel(elevation: float) -> tuple[float, float]:
    """Fraction of the disc above the horizon, and the height of that part's centroid above the disc's centre [rad].

    ``elevation`` is the centre's [rad]; as it counts within a radius of the horizon alone, its sine serves as well.
    """
    height = elevation / SOLAR_ANGULAR_RADIUS  # of the centre over the horizon, in radii
    if height >= 1.0:
        return 1.0, 0.0
    if height <= -1.0:
        return 0.0, 0.0
    rest = math.sqrt(1.0 - height * height)
    area = math.acos(-height) + height * rest
    return area / math.pi, SOLAR_ANGULAR_RADIUS * 2.0 / 3.0 * rest * rest * rest / area
