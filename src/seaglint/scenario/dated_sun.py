"""A date and a place for a given position of the Sun."""

from __future__ import annotations

import math
from datetime import UTC, datetime, timedelta
from typing import Final

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.climate.ephemeris import seen_elevation

_YEAR: Final = 2026  #: Year of the dates that ``dated_sun`` chooses.

#: Latitude and longitude [deg] that ``dated_sun`` prefers: in the Atlantic, whose meridian is sea from 60 degrees north to 70 south.
_OPEN_SEA: Final = (36.8, -30.0)

# Weights of a degree: a Sun that is elsewhere is worse than any place; the longitude only selects between places of about one latitude.
_WEIGHT_OF_SUN, _WEIGHT_OF_LONGITUDE = 1e3, 0.1


def dated_sun(zenith: float, azimuth: float) -> tuple[datetime, float, float]:
    """Return a date, to the minute in UTC, with latitude and longitude [deg] at which ``sun_position`` is nearest to a direction.

    A pole at latitude ``phi`` is ``90 - phi`` degrees from the zenith, so that the Sun's declination ``delta`` satisfies
    ``sin delta = cos z sin phi + sin z cos a cos phi``; the Sun's hour angle then gives the longitude. Of the hours of a year, and then of
    the minutes around the best one, that is taken whose latitude is nearest to 36.8 degrees north or south.

    Parameters
    ----------
    zenith : float
        Zenith angle of the Sun as seen, refraction included [rad].
    azimuth : float
        Azimuth, clockwise from north [rad].

    Notes
    -----
    Every direction is reached within 0.01 degree, except for zenith angles between 96 and 96.62 degrees: the refraction of ``sun_position``
    ends with twilight, so that its centre is never seen there.

    Examples
    --------
    >>> moment, latitude, longitude = dated_sun(math.radians(60.0), math.radians(180.0))
    >>> f"{moment:%H:%M}", round(latitude), round(longitude)
    ('14:02', 37, -30)
    """
    zenith = _without_refraction(zenith)
    begin = datetime(_YEAR, 1, 1, tzinfo=UTC)
    hour, _ = _best_place([begin + timedelta(hours=n) for n in range(365 * 24)], zenith, azimuth)
    moment, (latitude, longitude) = _best_place([hour + timedelta(minutes=n) for n in range(-30, 31)], zenith, azimuth)
    return moment, round(latitude, 4), round(longitude, 4)


def _without_refraction(zenith: float) -> float:
    """Return the zenith angle without refraction of a Sun that is seen at a zenith angle, or the nearest that is seen [rad]."""
    # Refraction lifts by at most 0.62 degrees.
    elevation = 90.0 - math.degrees(zenith) - np.linspace(0.0, 0.7, 7001)
    seen = seen_elevation(elevation)
    return math.radians(90.0 - float(elevation[np.argmin(np.abs(seen - 90.0 + math.degrees(zenith)))]))


def _best_place(times: list[datetime], zenith: float, azimuth: float) -> tuple[datetime, tuple[float, float]]:
    """Return the best of some times for a direction without refraction [rad], with latitude and longitude [deg]."""
    import pandas as pd
    from pvlib import solarposition

    # At the north pole the elevation is the declination, and the azimuth is 180 degrees more than the hour angle at Greenwich.
    pole = solarposition.get_solarposition(pd.DatetimeIndex(times), 90.0, 0.0, method="nrel_numpy")
    declination, greenwich = np.radians(pole["elevation"].to_numpy()), np.radians(pole["azimuth"].to_numpy() - 180.0)
    up, north, west = math.cos(zenith), math.sin(zenith) * math.cos(azimuth), -math.sin(zenith) * math.sin(azimuth)
    radius, phase = math.hypot(up, north), math.atan2(north, up)
    # sin(declination) = radius sin(latitude + phase) has two solutions; where it has none, its nearest latitude.
    first = np.arcsin(np.clip(np.sin(declination) / max(radius, 1e-12), -1.0, 1.0))
    latitude = _around_zero(np.stack([first, np.pi - first]) - phase)
    hour_angle = np.arctan2(west, up * np.cos(latitude) - north * np.sin(latitude))
    longitude = _around_zero(hour_angle - greenwich)
    beside = np.maximum(np.abs(declination) - math.asin(min(radius, 1.0)), 0.0)
    away = _around_zero(longitude - math.radians(_OPEN_SEA[1]))
    cost = _WEIGHT_OF_SUN * beside + np.abs(np.abs(latitude) - math.radians(_OPEN_SEA[0])) + _WEIGHT_OF_LONGITUDE * np.abs(away)
    cost[np.abs(latitude) > 0.5 * np.pi] = np.inf
    root, best = (int(index) for index in np.unravel_index(np.argmin(cost), cost.shape))
    return times[best], (math.degrees(latitude[root, best]), math.degrees(longitude[root, best]))


def _around_zero(angle: FloatArray) -> FloatArray:
    """Return angles between -pi and pi [rad]."""
    return (angle + np.pi) % (2.0 * np.pi) - np.pi
