"""Directions and the geometry of a line of sight over a round sea.

World frame: x east, y north, z up. Zenith angles are measured from +z, azimuths clockwise from north, both in radians.
Both directions of a reflection point away from the surface. ``depression`` is below the horizontal at the sensor;
``elevation`` is its negative. Rays are straight over an Earth of ``EFFECTIVE_EARTH_RADIUS``, which represents
mean refraction. ``range_m`` is the arc along the sea from the sensor's foot to the target point.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from seaglint.base.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.base.errors import DomainError

FloatArray = NDArray[np.float64]

Progress = Callable[[int, int], None]  #: Called with (pieces of work done, pieces in all): once at the start and after each piece.


def unit_vector(azimuth: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Return the horizontal unit vector (east, north) of an azimuth clockwise from north [rad]."""
    a = np.asarray(azimuth, dtype=np.float64)
    return np.sin(a), np.cos(a)


def travel_azimuth(from_azimuth: float) -> float:
    """Return the azimuth TO which waves or air travel [rad], in [0, 2 pi), from the azimuth they come FROM."""
    return float((from_azimuth + np.pi) % (2.0 * np.pi))


def wrap_angle(angle: ArrayLike) -> FloatArray:
    """Return an angle wrapped to [-pi, pi) [rad]."""
    return np.asarray((np.asarray(angle, dtype=np.float64) + np.pi) % (2.0 * np.pi) - np.pi)


def _require_height(height: float) -> None:
    if not (np.isfinite(height) and height > 0.0):
        raise DomainError(
            f"sensor height = {height:g} m is not above the sea; give a height > 0 m",
            name="sensor_height",
            value=height,
            allowed="above 0 m",
        )


def horizon_depression(height: float) -> float:
    """Return the depression of the sea horizon, ``arccos(R'/(R'+h))`` [rad], for a sensor at ``height`` [m]."""
    _require_height(height)
    # arccos(1 - x) loses digits for low sensors; the half-angle form does not
    return float(2.0 * np.arcsin(np.sqrt(0.5 * height / (EFFECTIVE_EARTH_RADIUS + height))))


def horizon_range(height: float) -> float:
    """Return the arc along the sea from the sensor's foot to the horizon [m]; 38.6 km at 100 m."""
    return EFFECTIVE_EARTH_RADIUS * horizon_depression(height)


def view_zenith(height: float, depression: ArrayLike) -> FloatArray:
    """Return the zenith angle of the direction from the sea point to the sensor [rad]; NaN where the ray misses the sea.

    ``sin(theta_v) = (1 + h/R') cos(depression)``.
    """
    _require_height(height)
    d = np.asarray(depression, dtype=np.float64)
    s = (1.0 + height / EFFECTIVE_EARTH_RADIUS) * np.cos(d)
    with np.errstate(invalid="ignore"):
        return np.asarray(np.where((s <= 1.0) & (d > 0.0), np.arcsin(np.minimum(s, 1.0)), np.nan))


def surface_range(height: float, depression: ArrayLike) -> FloatArray:
    """Return the arc along the sea to the visible point at a ``depression`` [m]; NaN where the ray misses the sea.

    The point is the near intersection of the line of sight with the effective sphere, in a form without cancellation for low sensors.
    """
    _require_height(height)
    d = np.asarray(depression, dtype=np.float64)
    a = height / EFFECTIVE_EARTH_RADIUS
    # slant path t from the sensor: positive root of t^2 - 2 t (1+a) sin d + 2a + a^2 = 0 in Earth radii (the near one)
    b = (1.0 + a) * np.sin(d)
    c = a * (2.0 + a)
    with np.errstate(invalid="ignore"):
        disc = b * b - c
        # the near root as a quotient: b - sqrt(disc) would cancel
        t = c / (b + np.sqrt(disc))
        psi = np.arctan2(t * np.cos(d), 1.0 + a - t * np.sin(d))
        return np.asarray(np.where((disc >= 0.0) & (d > 0.0), EFFECTIVE_EARTH_RADIUS * psi, np.nan))


def depression_of_range(height: float, range_m: ArrayLike) -> FloatArray:
    """Return the depression of the mean sea surface at an arc ``range_m`` [rad] (also beyond the horizon)."""
    _require_height(height)
    psi = np.asarray(range_m, dtype=np.float64) / EFFECTIVE_EARTH_RADIUS
    drop = height + 2.0 * EFFECTIVE_EARTH_RADIUS * np.sin(0.5 * psi) ** 2
    return np.asarray(np.arctan2(drop, EFFECTIVE_EARTH_RADIUS * np.sin(psi)))


def view_zenith_of_range(height: float, range_m: ArrayLike) -> FloatArray:
    """Return the zenith angle of the direction from the sea to the sensor [rad] at an arc ``range_m`` (above pi/2 beyond the horizon)."""
    psi = np.asarray(range_m, dtype=np.float64) / EFFECTIVE_EARTH_RADIUS
    return np.asarray(0.5 * np.pi - depression_of_range(height, range_m) + psi)
