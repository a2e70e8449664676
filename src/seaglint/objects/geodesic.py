"""Conversion of latitude and longitude to metres east and north of a place, by the geodesic on the WGS 84 ellipsoid.

Vincenty, T. 1975: Direct and inverse solutions of geodesics on the ellipsoid with application of nested equations. Survey Review 23, 88-93.
"""

from __future__ import annotations

import math
from typing import Final

from seaglint.base.errors import DomainError

SEMI_MAJOR_AXIS: Final = 6_378_137.0  #: Semi-major axis of the WGS 84 ellipsoid [m].

FLATTENING: Final = 1.0 / 298.257223563  #: Flattening of the WGS 84 ellipsoid [1].


def east_north(latitude: float, longitude: float, start: tuple[float, float]) -> tuple[float, float]:
    """Metres towards east and north from ``start = (latitude, longitude)`` [rad], by range and bearing.

    Raises
    ------
    DomainError
        A place near the other side of the Earth, for which the series does not converge.

    Examples
    --------
    >>> import numpy as np
    >>> east, north = east_north(np.radians(37.0), np.radians(-76.0), (np.radians(36.9), np.radians(-76.0)))
    >>> round(east, 3), round(north, 1)
    (0.0, 11097.7)
    """
    f = FLATTENING
    u1, u2 = (math.atan((1.0 - f) * math.tan(angle)) for angle in (start[0], latitude))
    difference = math.remainder(longitude - start[1], 2.0 * math.pi)
    s1, c1, s2, c2 = math.sin(u1), math.cos(u1), math.sin(u2), math.cos(u2)
    reduced = difference
    for _ in range(200):
        s, c = math.sin(reduced), math.cos(reduced)
        sine = math.hypot(c2 * s, c1 * s2 - s1 * c2 * c)
        if sine == 0.0:
            return 0.0, 0.0
        cosine = s1 * s2 + c1 * c2 * c
        arc = math.atan2(sine, cosine)
        sin_a = c1 * c2 * s / sine
        cos2_a = 1.0 - sin_a * sin_a
        middle = cosine - 2.0 * s1 * s2 / cos2_a if cos2_a > 1e-15 else 0.0
        k = f / 16.0 * cos2_a * (4.0 + f * (4.0 - 3.0 * cos2_a))
        before = reduced
        reduced = difference + (1.0 - k) * f * sin_a * (arc + k * sine * (middle + k * cosine * (2.0 * middle**2 - 1.0)))
        if abs(reduced - before) < 1e-13:
            break
    else:
        raise DomainError("a place on the other side of the Earth; give latitude_deg and longitude_deg near [place]")
    square = cos2_a * ((1.0 / (1.0 - f)) ** 2 - 1.0)
    a = 1.0 + square / 16384.0 * (4096.0 + square * (-768.0 + square * (320.0 - 175.0 * square)))
    b = square / 1024.0 * (256.0 + square * (-128.0 + square * (74.0 - 47.0 * square)))
    last = b / 6.0 * middle * (4.0 * sine**2 - 3.0) * (4.0 * middle**2 - 3.0)
    bend = b * sine * (middle + b / 4.0 * (cosine * (2.0 * middle**2 - 1.0) - last))
    length = (1.0 - f) * SEMI_MAJOR_AXIS * a * (arc - bend)
    azimuth = math.atan2(c2 * math.sin(reduced), c1 * s2 - s1 * c2 * math.cos(reduced))
    return length * math.sin(azimuth), length * math.cos(azimuth)
