r"""Direction, phase and distance of the Moon at any time and place by the series of Meeus (1998), chapter 47.

The 120 terms of his tables 47.A and 47.B are the largest of the lunar theory ELP-2000/82 of Chapront-Touze and Chapront; with nutation
(chapter 22) they give the apparent position within some 10 seconds of arc. The direction is topocentric: the Moon's parallax of almost
one degree is that of the place on the ellipsoid. Refraction is that of the Sun (``seaglint.climate.ephemeris``), whose positions also
give the phase angle and the bright limb (chapter 48).

For many draws, positions of Moon and Sun are computed at steps of six hours and interpolated by cubic splines, within 1e-5 deg.

References
----------
Meeus, J. (1998), Astronomical Algorithms, second edition, Willmann-Bell.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy import constants

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError
from seaglint.climate.ephemeris import DELTA_T, EQUATOR, FLATTENING, ephemeris_steps, geocentric_sun, seen_elevation, year_span

if TYPE_CHECKING:
    from scipy.interpolate import CubicSpline

#: Multiples of the Moon's mean elongation D, the Sun's anomaly M, the Moon's anomaly M' and its argument of latitude F, with the
#: coefficients of the sine in longitude [1e-6 deg] and of the cosine in distance [m]: Meeus' table 47.A.
_LONGITUDE_AND_DISTANCE: Final = np.array(
    [
        (0, 0, 1, 0, 6288774, -20905355), (2, 0, -1, 0, 1274027, -3699111), (2, 0, 0, 0, 658314, -2955968),
        (0, 0, 2, 0, 213618, -569925), (0, 1, 0, 0, -185116, 48888), (0, 0, 0, 2, -114332, -3149), (2, 0, -2, 0, 58793, 246158),
        (2, -1, -1, 0, 57066, -152138), (2, 0, 1, 0, 53322, -170733), (2, -1, 0, 0, 45758, -204586), (0, 1, -1, 0, -40923, -129620),
        (1, 0, 0, 0, -34720, 108743), (0, 1, 1, 0, -30383, 104755), (2, 0, 0, -2, 15327, 10321), (0, 0, 1, 2, -12528, 0),
        (0, 0, 1, -2, 10980, 79661), (4, 0, -1, 0, 10675, -34782), (0, 0, 3, 0, 10034, -23210), (4, 0, -2, 0, 8548, -21636),
        (2, 1, -1, 0, -7888, 24208), (2, 1, 0, 0, -6766, 30824), (1, 0, -1, 0, -5163, -8379), (1, 1, 0, 0, 4987, -16675),
        (2, -1, 1, 0, 4036, -12831), (2, 0, 2, 0, 3994, -10445), (4, 0, 0, 0, 3861, -11650), (2, 0, -3, 0, 3665, 14403),
        (0, 1, -2, 0, -2689, -7003), (2, 0, -1, 2, -2602, 0), (2, -1, -2, 0, 2390, 10056), (1, 0, 1, 0, -2348, 6322),
        (2, -2, 0, 0, 2236, -9884), (0, 1, 2, 0, -2120, 5751), (0, 2, 0, 0, -2069, 0), (2, -2, -1, 0, 2048, -4950),
        (2, 0, 1, -2, -1773, 4130), (2, 0, 0, 2, -1595, 0), (4, -1, -1, 0, 1215, -3958), (0, 0, 2, 2, -1110, 0),
        (3, 0, -1, 0, -892, 3258), (2, 1, 1, 0, -810, 2616), (4, -1, -2, 0, 759, -1897), (0, 2, -1, 0, -713, -2117),
        (2, 2, -1, 0, -700, 2354), (2, 1, -2, 0, 691, 0), (2, -1, 0, -2, 596, 0), (4, 0, 1, 0, 549, -1423), (0, 0, 4, 0, 537, -1117),
        (4, -1, 0, 0, 520, -1571), (1, 0, -2, 0, -487, -1739), (2, 1, 0, -2, -399, 0), (0, 0, 2, -2, -381, -4421), (1, 1, 1, 0, 351, 0),
        (3, 0, -2, 0, -340, 0), (4, 0, -3, 0, 330, 0), (2, -1, 2, 0, 327, 0), (0, 2, 1, 0, -323, 1165), (1, 1, -1, 0, 299, 0),
        (2, 0, 3, 0, 294, 0), (2, 0, -1, -2, 0, 8752),
    ]
)  # fmt: skip

#: The same multiples, and the coefficient of the sine in latitude [1e-6 deg]: table 47.B.
_LATITUDE: Final = np.array(
    [
        (0, 0, 0, 1, 5128122), (0, 0, 1, 1, 280602), (0, 0, 1, -1, 277693), (2, 0, 0, -1, 173237), (2, 0, -1, 1, 55413),
        (2, 0, -1, -1, 46271), (2, 0, 0, 1, 32573), (0, 0, 2, 1, 17198), (2, 0, 1, -1, 9266), (0, 0, 2, -1, 8822), (2, -1, 0, -1, 8216),
        (2, 0, -2, -1, 4324), (2, 0, 1, 1, 4200), (2, 1, 0, -1, -3359), (2, -1, -1, 1, 2463), (2, -1, 0, 1, 2211), (2, -1, -1, -1, 2065),
        (0, 1, -1, -1, -1870), (4, 0, -1, -1, 1828), (0, 1, 0, 1, -1794), (0, 0, 0, 3, -1749), (0, 1, -1, 1, -1565), (1, 0, 0, 1, -1491),
        (0, 1, 1, 1, -1475), (0, 1, 1, -1, -1410), (0, 1, 0, -1, -1344), (1, 0, 0, -1, -1335), (0, 0, 3, 1, 1107), (4, 0, 0, -1, 1021),
        (4, 0, -1, 1, 833), (0, 0, 1, -3, 777), (4, 0, -2, 1, 671), (2, 0, 0, -3, 607), (2, 0, 2, -1, 596), (2, -1, 1, -1, 491),
        (2, 0, -2, 1, -451), (0, 0, 3, -1, 439), (2, 0, 2, 1, 422), (2, 0, -3, -1, 421), (2, 1, -1, 1, -366), (2, 1, 0, 1, -351),
        (4, 0, 0, 1, 331), (2, -1, 1, 1, 315), (2, -2, 0, -1, 302), (0, 0, 1, 3, -283), (2, 1, 1, -1, -229), (1, 1, 0, -1, 223),
        (1, 1, 0, 1, 223), (0, 1, -2, -1, -220), (2, 1, -1, -1, -220), (1, 0, 1, 1, -185), (2, -1, -2, -1, 181), (0, 1, 2, 1, -177),
        (4, 0, -2, -1, 176), (4, -1, -1, -1, 166), (1, 0, 1, -1, -164), (4, 0, 1, -1, 132), (1, 0, -1, -1, -119), (4, -1, 0, -1, 115),
        (2, -2, 0, 1, 107),
    ]
)  # fmt: skip


class MoonPositions(NamedTuple):
    """Directions, phases and distances of the Moon's centre [(n,)]."""

    zenith: FloatArray  #: Apparent zenith angle, refraction included [rad].
    azimuth: FloatArray  #: Azimuth clockwise from north [rad].
    phase: FloatArray  #: Phase angle, the angle at the Moon between Sun and observer [rad]: 0 at full Moon.
    distance_m: FloatArray  #: Distance from the place [m].
    bright_limb: FloatArray  #: Direction in the sky from the Moon's centre to the Sun, from upwards towards increasing azimuth [rad].
    sun_distance_au: FloatArray  #: Distance from the Sun [au].


@dataclass(frozen=True, eq=False)
class MoonEphemeris:
    """Ephemeris of the Moon between two times. Make it with ``between``."""

    first: float  #: Earliest time that it covers, since 1970-01-01 UTC [s].
    last: float  #: Latest time that it covers, since 1970-01-01 UTC [s].
    #: Geocentric vectors of Moon and Sun, equator and equinox of date [m], and the equation of the equinoxes [rad] [(7,)].
    _columns: CubicSpline[np.float64]

    @classmethod
    def between(cls, first: float, last: float) -> MoonEphemeris:
        """Ephemeris for the seconds since 1970-01-01 UTC from ``first`` to ``last``."""
        from scipy.interpolate import CubicSpline  # takes half a second

        times = ephemeris_steps(first, last)
        ascension, declination, distance, equinoxes = geocentric_sun(times).T
        flat = np.cos(declination)
        sun = np.stack([flat * np.cos(ascension), flat * np.sin(ascension), np.sin(declination)])
        columns = np.concatenate([geocentric_moon(times), constants.au * distance * sun, equinoxes[None]])
        return cls(float(first), float(last), CubicSpline(times, columns, axis=1))

    @classmethod
    def of_year(cls, year: int) -> MoonEphemeris:
        """Ephemeris of a calendar year, UTC."""
        return cls.between(*year_span(year))

    def at(self, time: ArrayLike, latitude: ArrayLike, longitude: ArrayLike, *, refracted: bool = True) -> MoonPositions:
        """Positions at times and places at sea level, broadcast.

        Parameters
        ----------
        time : array_like
            Seconds since 1970-01-01 UTC [s].
        latitude, longitude : array_like
            North and east positive [deg].
        refracted : bool
            Whether the zenith angle includes refraction.

        Raises
        ------
        DomainError
            Times outside the ephemeris.

        Examples
        --------
        >>> moon = MoonEphemeris.of_year(2026).at(1775100000.0, 36.8, -30.0)
        >>> np.degrees([moon.zenith[0], moon.azimuth[0], moon.phase[0]]).round(2).tolist(), round(moon.distance_m[0] / 1e3)
        ([48.97, 206.62, 3.66], 389531)
        """
        parts = np.broadcast_arrays(*(np.asarray(a, dtype=np.float64) for a in (time, latitude, longitude)))
        t, lat, lon = (np.ravel(part) for part in parts)
        outside = ~((t >= self.first) & (t <= self.last))
        if outside.any():
            raise DomainError(
                f"time = {float(t[outside][0]):g} s is outside the ephemeris, {self.first:g} to {self.last:g} s since 1970; "
                "make one that covers it"
            )
        columns = self._columns(t)
        up, north, east, place = _horizon(np.radians(lat), _sidereal_time(t) + columns[6] + np.radians(lon))
        moon, sun = columns[:3] - place, columns[3:6] - place
        distance = np.sqrt(np.sum(moon**2, axis=0))
        zenith, azimuth = _direction(moon, up, north, east)
        limb = bright_limb(zenith, azimuth, *_direction(sun, up, north, east))
        to_sun = sun - moon
        sun_distance = np.sqrt(np.sum(to_sun**2, axis=0))
        phase = np.arccos(np.clip(-np.sum(to_sun * moon, axis=0) / (sun_distance * distance), -1.0, 1.0))
        if refracted:
            zenith = np.radians(90.0 - seen_elevation(90.0 - np.degrees(zenith)))
        return MoonPositions(zenith, azimuth, phase, distance, np.asarray(limb), sun_distance / constants.au)


def bright_limb(zenith: ArrayLike, azimuth: ArrayLike, sun_zenith: ArrayLike, sun_azimuth: ArrayLike) -> FloatArray:
    """Direction in the sky from a place in it to the Sun, from upwards towards increasing azimuth, -pi to pi [rad]; all angles in radians.

    >>> round(math.degrees(bright_limb(math.radians(60.0), 0.0, math.radians(60.0), math.radians(90.0))), 1)
    63.4
    """
    moon, sun = np.asarray(zenith, dtype=np.float64), np.asarray(sun_zenith, dtype=np.float64)
    away = np.asarray(sun_azimuth, dtype=np.float64) - np.asarray(azimuth, dtype=np.float64)
    return np.asarray(np.arctan2(np.sin(sun) * np.sin(away), np.sin(moon) * np.cos(sun) - np.cos(moon) * np.sin(sun) * np.cos(away)))


def geocentric_moon(times: FloatArray) -> FloatArray:
    """Apparent vectors from the Earth's centre to the Moon, equator and equinox of date [m, (3, n)], at seconds since 1970-01-01 UTC."""
    century = _century(times + DELTA_T)
    longitude, latitude, distance = _ecliptic_moon(century)
    nutation, obliquity = _nutation(century)
    longitude = longitude + nutation
    flat = np.cos(latitude)
    x, y, z = flat * np.cos(longitude), flat * np.sin(longitude), np.sin(latitude)
    cosine, sine = np.cos(obliquity), np.sin(obliquity)
    return np.asarray(distance * np.stack([x, cosine * y - sine * z, sine * y + cosine * z]))


def _century(times: FloatArray) -> FloatArray:
    """Julian centuries from 2000-01-01 12:00 to seconds since 1970-01-01."""
    return (times / 86_400.0 - 10_957.5) / 36_525.0


def _ecliptic_moon(century: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Longitude and latitude of the Moon, mean ecliptic and equinox of date [rad], and its distance [m]."""
    t = century
    mean = 218.3164477 + t * (481267.88123421 + t * (-0.0015786 + t * (1.0 / 538841.0 - t / 65194000.0)))
    elongation = 297.8501921 + t * (445267.1114034 + t * (-0.0018819 + t * (1.0 / 545868.0 - t / 113065000.0)))
    sun = 357.5291092 + t * (35999.0502909 + t * (-0.0001536 + t / 24490000.0))
    anomaly = 134.9633964 + t * (477198.8675055 + t * (0.0087414 + t * (1.0 / 69699.0 - t / 14712000.0)))
    argument = 93.2720950 + t * (483202.0175233 + t * (-0.0036539 + t * (-1.0 / 3526000.0 + t / 863310000.0)))
    arguments = np.radians(np.stack([elongation, sun, anomaly, argument]) % 360.0)
    # the Sun's orbit grows rounder
    rounder = 1.0 - t * (0.002516 + 0.0000074 * t)
    first = _LONGITUDE_AND_DISTANCE[:, :4] @ arguments
    weight = rounder ** np.abs(_LONGITUDE_AND_DISTANCE[:, 1:2])
    longitude = _LONGITUDE_AND_DISTANCE[:, 4] @ (weight * np.sin(first))
    distance = _LONGITUDE_AND_DISTANCE[:, 5] @ (weight * np.cos(first))
    latitude = _LATITUDE[:, 4] @ (rounder ** np.abs(_LATITUDE[:, 1:2]) * np.sin(_LATITUDE[:, :4] @ arguments))
    # Venus, Jupiter and the flattening of the Earth
    a1, a2, a3, moon, f, m = np.radians(
        np.stack([119.75 + 131.849 * t, 53.09 + 479264.290 * t, 313.45 + 481266.484 * t, mean, argument, anomaly]) % 360.0
    )
    longitude = longitude + 3958.0 * np.sin(a1) + 1962.0 * np.sin(moon - f) + 318.0 * np.sin(a2)
    latitude = latitude - 2235.0 * np.sin(moon) + 382.0 * np.sin(a3) + 175.0 * (np.sin(a1 - f) + np.sin(a1 + f))
    latitude = latitude + 127.0 * np.sin(moon - m) - 115.0 * np.sin(moon + m)
    return np.radians(mean + 1e-6 * longitude), np.radians(1e-6 * latitude), 385_000_560.0 + distance


def _nutation(century: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Nutation in longitude, within 0.5 seconds of arc, and true obliquity of the ecliptic [rad] (Meeus, chapter 22)."""
    node, sun, moon = np.radians(
        np.stack([125.04452 - 1934.136261 * century, 280.4665 + 36000.7698 * century, 218.3165 + 481267.8813 * century]) % 360.0
    )
    longitude = -17.20 * np.sin(node) - 1.32 * np.sin(2.0 * sun) - 0.23 * np.sin(2.0 * moon) + 0.21 * np.sin(2.0 * node)
    tilt = 9.20 * np.cos(node) + 0.57 * np.cos(2.0 * sun) + 0.10 * np.cos(2.0 * moon) - 0.09 * np.cos(2.0 * node)
    mean = 84_381.448 + century * (-46.8150 + century * (-0.00059 + 0.001813 * century))
    return np.radians(longitude / 3600.0), np.radians((mean + tilt) / 3600.0)


def _sidereal_time(times: FloatArray) -> FloatArray:
    """Mean sidereal time at Greenwich [rad] (Meeus, chapter 12)."""
    century = _century(times)
    return np.asarray(
        np.radians((280.46061837 + century * (13_185_000.770053742 + century * (0.000387933 - century / 38_710_000.0))) % 360.0)
    )


def _horizon(latitude: FloatArray, sidereal: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Up, north and east of a place at its sidereal time, and the vector to it from the Earth's centre [m] [(3, n) each]."""
    sine, cosine, ahead, aside = np.sin(latitude), np.cos(latitude), np.cos(sidereal), np.sin(sidereal)
    up = np.stack([cosine * ahead, cosine * aside, sine])
    north = np.stack([-sine * ahead, -sine * aside, cosine])
    east = np.stack([-aside, ahead, np.zeros_like(aside)])
    reduced = np.arctan2(FLATTENING * sine, cosine)
    flat = np.cos(reduced)
    place = EQUATOR * np.stack([flat * ahead, flat * aside, FLATTENING * np.sin(reduced)])
    return up, north, east, place


def _direction(vector: FloatArray, up: FloatArray, north: FloatArray, east: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Zenith angle and azimuth of vectors [rad], all [(3, n)]."""
    height, ahead, aside = (np.sum(vector * axis, axis=0) for axis in (up, north, east))
    return np.arctan2(np.hypot(ahead, aside), height), np.arctan2(aside, ahead) % (2.0 * math.pi)
