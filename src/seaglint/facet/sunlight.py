"""Sun over a scene as kernels read it: at the sensor's foot, and at a place in view."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from seaglint.air.setting_sun import visible_part_kernel
from seaglint.base.constants import EARTH_RADIUS, SOLAR_ANGULAR_RADIUS
from seaglint.base.jit import kernel
from seaglint.facet.local_sun import turn_kernel, turned_kernel


class Sunlight(NamedTuple):
    """Sun as kernels read it: directions, limbs and visible share.

    The fields are the unit vector to it, the tangent ``t_*`` in its vertical plane and the horizontal one ``c_*``, the horizontal unit
    vector towards it, the tangents of its limbs' elevations, and the share of its disc above the horizon.
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
    lower_tangent: float
    upper_tangent: float
    share: float


def sunlight(zenith: float, azimuth: float, shining: bool) -> Sunlight:
    """Direction to a whole Sun, the tangents to it, in its vertical plane and horizontal, and its limbs."""
    sz, cz, sa, ca = np.sin(zenith), np.cos(zenith), np.sin(azimuth), np.cos(azimuth)
    limbs = np.tan(np.clip(0.5 * np.pi - zenith + np.array([-1.0, 1.0]) * SOLAR_ANGULAR_RADIUS, -1.5, 0.5 * np.pi - 1e-6))
    values = (azimuth, sz * sa, sz * ca, cz, -cz * sa, -cz * ca, sz, ca, -sa, sa, ca, *limbs, 1.0)
    return Sunlight(shining, *(float(v) for v in values))


@kernel
def sunlight_at(sun: Sunlight, away_east: float, away_north: float, arc: float) -> Sunlight:
    """Sun at a place an ``arc`` [m] from the sensor's foot, ``away`` the horizontal unit vector to it.

    Its vector is that to the middle of the visible part. ``azimuth`` stays the foot's, which tables of the sea's shadows are for.
    """
    turn = turn_kernel(arc * (1.0 / EARTH_RADIUS))
    east, north, up = turned_kernel(sun.east, sun.north, sun.up, (away_east, away_north), turn)
    share = 1.0
    if up < SOLAR_ANGULAR_RADIUS:
        # raised by so little, the horizontal part keeps its length within 1e-5
        share, lift = visible_part_kernel(up)
        east, north, up = east * (1.0 - lift * up), north * (1.0 - lift * up), up + lift
    return _directed(sun, (east, north, up), share)


@kernel
def raised_sun(sun: Sunlight, lift: float) -> Sunlight:
    """Sun at a place, raised by ``lift`` [rad], at most two thirds of its radius: to the middle of what waves leave of its disc."""
    length = math.sqrt(max(1.0 - sun.up * sun.up, 0.0))
    up, per_length = sun.up + lift * length, 1.0 - lift * sun.up / max(length, 1e-9)
    return _directed(sun, (sun.east * per_length, sun.north * per_length, up), sun.share)


@kernel
def _directed(sun: Sunlight, direction: tuple[float, float, float], share: float) -> Sunlight:
    """Sun of another direction and visible share."""
    east, north, up = direction
    flat = math.sqrt(max(1.0 - up * up, 1e-18))
    per_flat = 1.0 / flat
    he, hn = east * per_flat, north * per_flat
    if flat < 1e-6:  # at the zenith the azimuth is the foot's
        he, hn = sun.horizontal_east, sun.horizontal_north
    # tangents of sums, with the radius for its own tangent
    tangent = up * per_flat
    lower = (tangent - SOLAR_ANGULAR_RADIUS) / (1.0 + tangent * SOLAR_ANGULAR_RADIUS)
    upper = (tangent + SOLAR_ANGULAR_RADIUS) / max(1.0 - tangent * SOLAR_ANGULAR_RADIUS, 1e-6)
    shining = sun.shining and share > 0.0
    return Sunlight(shining, sun.azimuth, east, north, up, -up * he, -up * hn, flat, hn, -he, he, hn, lower, upper, share)
