r"""Sun over a scene: its direction relative to the vertical of a place in view, its visible share and its strength there.

The Sun's zenith angle and azimuth hold at the sensor's foot. At an arc r along the horizontal direction h of the line of sight the
vertical is turned by ``psi = r/R`` about the horizontal axis across h. R is the true radius of the Earth: the effective radius accounts for
refraction of the line of sight and does not affect the direction of the Sun. A direction l with ``along = l.h`` and ``up = l_z`` has there

.. math:: along' = along \cos\psi - up \sin\psi, \qquad up' = along \sin\psi + up \cos\psi

so that places farther towards the Sun have it at a higher elevation: its zenith angle is less by ``psi cos(azimuth of the line of sight -
azimuth of the Sun)``. Components are along the foot's east and north, carried along the line of sight.
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from seaglint.air.sun_and_sky import visible_part_kernel
from seaglint.base.constants import EARTH_RADIUS, SOLAR_ANGULAR_RADIUS
from seaglint.base.conventions import FloatArray
from seaglint.base.jit import kernel

_LEAST: Final = 1e-6  #: Turn of the vertical below which the Sun is that at the sensor's foot [rad]: an arc of 6 m.


class SunTable(NamedTuple):
    """Ratio of sunlight in the band to sunlight at the sensor's foot, at even steps of the sine of the Sun's elevation; 1 without values.

    The elevation belongs to the middle of the visible part of the disc.
    """

    first: float
    per_step: float
    values: np.ndarray


STEADY: Final = SunTable(0.0, 1.0, np.zeros(0))  #: Sun table with the same sunlight everywhere.


def turn_at(arc: ArrayLike) -> FloatArray:
    """Turn of the vertical at an arc from the sensor's foot [m], ``psi = r/R`` [rad].

    >>> round(float(turn_at(63710.0)), 9)
    0.01
    """
    return np.asarray(np.asarray(arc, dtype=np.float64) / EARTH_RADIUS)


def solar_zenith_at(solar_zenith: float, relative_azimuth: ArrayLike, turn: ArrayLike) -> FloatArray:
    """Zenith angle of the Sun at a place [rad], broadcast; ``relative_azimuth`` is the Sun's azimuth minus the line of sight's [rad].

    >>> round(float(solar_zenith_at(1.0, 0.0, 0.01)), 9)
    0.99
    """
    psi = np.asarray(turn, dtype=np.float64)
    up = np.cos(solar_zenith) * np.cos(psi) + np.sin(solar_zenith) * np.cos(relative_azimuth) * np.sin(psi)
    return np.asarray(np.arccos(np.clip(up, -1.0, 1.0)))


@kernel
def turn_kernel(psi: float) -> tuple[float, float]:
    """Cosine and sine of a turn of the vertical [rad]; (1, 0) for turns below the least.

    Series to the third term: within 1e-7 up to 0.3 rad, the horizon of a sensor 250 km high.
    """
    if psi < _LEAST:
        return 1.0, 0.0
    square = psi * psi
    cosine = 1.0 - 0.5 * square * (1.0 - square * (1.0 / 12.0) * (1.0 - square * (1.0 / 30.0)))
    return cosine, psi * (1.0 - square * (1.0 / 6.0) * (1.0 - square * (1.0 / 20.0)))


@kernel
def turned_kernel(east: float, north: float, up: float, away: tuple[float, float], turn: tuple[float, float]) -> tuple[float, float, float]:
    """Direction in the frame of the place; ``away`` is the horizontal unit vector from the sensor, ``turn`` of ``turn_kernel``."""
    along = east * away[0] + north * away[1]
    change = along * turn[0] - up * turn[1] - along
    return east + change * away[0], north + change * away[1], along * turn[1] + up * turn[0]


def visible_sun(solar_zenith: float) -> tuple[float, float]:
    """Fraction of the disc above the horizon, and the zenith angle of that part's centroid [rad].

    The zenith angle is the apparent one, at the sea. A Sun wholly below the horizon gives (0, solar_zenith).

    >>> visible_sun(1.0)
    (1.0, 1.0)
    """
    share, lift = visible_part_kernel(0.5 * math.pi - float(solar_zenith))
    return float(share), float(solar_zenith - lift)


@kernel
def strength_kernel(table: SunTable, up: float) -> float:
    """Ratio of sunlight of a Sun with the sine ``up`` of elevation to sunlight at the sensor's foot [1]."""
    if table.values.shape[0] < 2:
        return 1.0
    x = min(max((up - table.first) * table.per_step, 0.0), table.values.shape[0] - 1.0)
    i = min(int(x), table.values.shape[0] - 2)
    return float(table.values[i] + (x - i) * (table.values[i + 1] - table.values[i]))


class Sunlight(NamedTuple):
    """Sun as kernels read it: directions, limbs and visible share.

    The fields are the unit vector to it, the tangent ``t_*`` in its vertical plane and the horizontal one ``c_*``, the horizontal unit
    vector towards it, the tangents of its limbs' elevations, the share of its disc above the horizon, and the radius of the disc [rad]; the
    horizon and waves cut it as the Sun's.
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
    radius: float


def sunlight(zenith: float, azimuth: float, shining: bool, radius: float = SOLAR_ANGULAR_RADIUS) -> Sunlight:
    """Direction to a whole Sun, the tangents to it, in its vertical plane and horizontal, and its limbs."""
    sz, cz, sa, ca = np.sin(zenith), np.cos(zenith), np.sin(azimuth), np.cos(azimuth)
    limbs = np.tan(np.clip(0.5 * np.pi - zenith + np.array([-1.0, 1.0]) * SOLAR_ANGULAR_RADIUS, -1.5, 0.5 * np.pi - 1e-6))
    values = (azimuth, sz * sa, sz * ca, cz, -cz * sa, -cz * ca, sz, ca, -sa, sa, ca, *limbs, 1.0, radius)
    return Sunlight(shining, *(float(v) for v in values))


@kernel
def sunlight_at(sun: Sunlight, away_east: float, away_north: float, arc: float) -> Sunlight:
    """Sun at a place an ``arc`` [m] from the sensor's foot, ``away`` the horizontal unit vector to it.

    Its vector points to the middle of the visible part. ``azimuth`` stays the foot's, for which the tables of the sea's shadows hold.
    """
    turn = turn_kernel(arc * (1.0 / EARTH_RADIUS))
    east, north, up = turned_kernel(sun.east, sun.north, sun.up, (away_east, away_north), turn)
    share = 1.0
    if up < SOLAR_ANGULAR_RADIUS:
        share, lift = visible_part_kernel(up)
        # of length 1 exactly: towards a low Sun, the angle between sight and Sun follows from a cosine within 1e-6 of 1
        risen = up + lift
        longer = math.sqrt((1.0 - risen * risen) / (1.0 - up * up))
        east, north, up = east * longer, north * longer, risen
    return _directed(sun, (east, north, up), share)


@kernel
def raised_sun(sun: Sunlight, lift: float) -> Sunlight:
    """Sun at a place, raised by ``lift`` [rad], at most two thirds of its radius: to the middle of its disc's unhidden part."""
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
    return Sunlight(shining, sun.azimuth, east, north, up, -up * he, -up * hn, flat, hn, -he, he, hn, lower, upper, share, sun.radius)
