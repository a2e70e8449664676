"""Direction of the Sun at any time and place by the NREL solar position algorithm (Reda and Andreas 2004), fast for a million draws.

Quantities of the time alone (right ascension, declination, distance, sidereal time) are taken from pvlib's form of the algorithm at steps
of six hours and interpolated by cubics, within 1e-6 deg. Quantities of the place are computed for every draw.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from seaglint.base.constants import DARK_SUN
from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError
from seaglint.base.jit import in_threads, kernel, njit

STANDARD_PRESSURE: Final = 1013.25
STANDARD_TEMPERATURE: Final = 12.0  #: Default air for refraction [hPa], [degC]: pvlib's standard atmosphere at the sea.

_STEP: Final = 21_600.0
DELTA_T: Final = 67.0  #: Terrestrial minus universal time [s]; 10 s more move the Sun by 1e-4 deg.

RISE: Final = 0.5667  #: Refraction at the horizon of the algorithm [deg].
SET: Final = -(0.26667 + RISE)  #: Elevation without refraction below which the algorithm has none [deg].

FLATTENING: Final = 0.99664719  #: Polar over equatorial radius of the Earth [1].
EQUATOR: Final = 6_378_140.0  #: Equatorial radius of the Earth [m].


class SunPositions(NamedTuple):
    """Directions and distances of the Sun's centre [(n,)]."""

    zenith: FloatArray  #: Apparent zenith angle, refraction included [rad].
    azimuth: FloatArray  #: Azimuth clockwise from north [rad].
    irradiance_factor: FloatArray  #: Ratio of the irradiance to that at 1 au, ``1/d^2`` [1].


@dataclass(frozen=True, eq=False)
class Ephemeris:
    """Ephemeris of the Sun between two times. Make it with :meth:`between`."""

    first: float  #: Earliest time that it covers, since 1970-01-01 UTC [s].
    last: float  #: Latest time that it covers, since 1970-01-01 UTC [s].
    _table: FloatArray  #: Right ascension and declination [rad], distance [au], equation of the equinoxes [rad] at the steps [(steps, 4)].

    @classmethod
    def between(cls, first: float, last: float) -> Ephemeris:
        """Ephemeris for the seconds since 1970-01-01 UTC from ``first`` to ``last``."""
        times = ephemeris_steps(first, last)
        return cls(float(first), float(last), geocentric_sun(times))

    @classmethod
    def of_year(cls, year: int) -> Ephemeris:
        """Ephemeris of a calendar year, UTC."""
        return cls.between(*year_span(year))

    def at(
        self,
        time: ArrayLike,
        latitude: ArrayLike,
        longitude: ArrayLike,
        *,
        height: float = 0.0,
        pressure: float = STANDARD_PRESSURE,
        temperature: float = STANDARD_TEMPERATURE,
    ) -> SunPositions:
        """Positions at times and places, broadcast.

        Parameters
        ----------
        time : array_like
            Seconds since 1970-01-01 UTC [s].
        latitude, longitude : array_like
            North and east positive [deg].
        height : float
            Above the ellipsoid [m].
        pressure, temperature : float
            Air at the place, for refraction [hPa], [degC].

        Raises
        ------
        DomainError
            Times outside the ephemeris.

        Examples
        --------
        >>> import numpy as np
        >>> sky = Ephemeris.of_year(2003)
        >>> air = dict(height=1830.14, pressure=820.0, temperature=11.0)
        >>> sun = sky.at(1066419030.0, 39.742476, -105.1786, **air)
        >>> np.degrees([sun.zenith[0], sun.azimuth[0]]).round(4).tolist()
        [50.1116, 194.3402]
        """
        parts = np.broadcast_arrays(*(np.asarray(a, dtype=np.float64) for a in (time, latitude, longitude)))
        t, lat, lon = (np.ascontiguousarray(part).ravel() for part in parts)
        if not np.all((t >= self.first) & (t <= self.last)):
            raise DomainError(
                f"time = {float(t[~((t >= self.first) & (t <= self.last))][0]):g} s is outside the ephemeris, {self.first:g} to "
                f"{self.last:g} s since 1970; make one that covers it"
            )
        out = np.empty((3, t.size))
        air = (pressure / 1010.0 * 283.0 / (273.0 + temperature), height)
        in_threads(lambda part: _fill(part, t, lat, lon, self.first - 2.0 * _STEP, self._table, air, out), t.size)
        return SunPositions(out[0], out[1], out[2])


def ephemeris_steps(first: float, last: float) -> FloatArray:
    """Times of an ephemeris from ``first`` to ``last``, every six hours, since 1970-01-01 UTC [s, (steps,)]."""
    # Two steps more at the beginning and the end: a cubic needs a node on either side of its interval.
    start = first - 2.0 * _STEP
    return start + _STEP * np.arange(math.ceil((last - start) / _STEP) + 3, dtype=np.float64)


def geocentric_sun(times: FloatArray) -> FloatArray:
    """Apparent right ascension and declination of the Sun [rad], distance [au], equation of the equinoxes [rad] [(steps, 4)].

    ``times`` are seconds since 1970-01-01 UTC; right ascensions are continuous from one to the next.
    """
    # Imported here, as pvlib imports pandas, which takes half a second.
    from pvlib import spa

    place = (0.0, 0.0, 0.0, STANDARD_PRESSURE, STANDARD_TEMPERATURE, DELTA_T, RISE, 1)
    sidereal, ascension, declination = spa.solar_position(times, *place, sst=True)
    distance = spa.solar_position(times, *place, esd=True)[0]
    nutation = sidereal - spa.mean_sidereal_time(spa.julian_day(times), spa.julian_century(spa.julian_day(times)))
    # The difference of two angles in [0, 360) may be off by a turn.
    nutation = (nutation + 180.0) % 360.0 - 180.0
    columns = [np.unwrap(np.radians(ascension)), np.radians(declination), distance, np.radians(nutation)]
    return np.ascontiguousarray(np.stack(columns, axis=1))


def year_span(year: int) -> tuple[float, float]:
    """First and last second of a calendar year since 1970-01-01 UTC [s]; the last is the first of the next year."""
    first, last = (datetime(y, 1, 1, tzinfo=UTC).timestamp() for y in (year, year + 1))
    return first, last


def seen_elevation(elevation: FloatArray) -> FloatArray:
    """Return the elevation of Sun or Moon with refraction [deg], from the elevation without it [deg].

    A light that has set keeps the refraction of the moment, to the end of twilight: its direction has no step at the horizon.
    """
    from pvlib.spa import atmospheric_refraction_correction

    air = (STANDARD_PRESSURE, STANDARD_TEMPERATURE)
    seen = elevation + atmospheric_refraction_correction(*air, elevation, RISE)
    lifted = elevation + atmospheric_refraction_correction(*air, np.array(SET), RISE)
    twilight = (elevation < SET) & (lifted > 90.0 - math.degrees(DARK_SUN))
    return np.asarray(np.where(twilight, lifted, seen))


@kernel
def _cubic(f: float, a: float, b: float, c: float, d: float) -> float:
    """Cubic interpolation between four even points, at the fraction ``f`` between the middle two."""
    low, high = f + 1.0, f - 2.0
    return -f * (f - 1.0) * high / 6.0 * a + low * (f - 1.0) * high / 2.0 * b - low * f * high / 2.0 * c + low * f * (f - 1.0) / 6.0 * d


@njit
def _fill(
    part: tuple[int, int],
    time: FloatArray,
    latitude: FloatArray,
    longitude: FloatArray,
    start: float,
    table: FloatArray,
    air: tuple[float, float],
    out: FloatArray,
) -> None:
    radian = math.pi / 180.0
    for n in range(part[0], part[1]):
        x = (time[n] - start) / _STEP
        i = min(max(int(x), 1), table.shape[0] - 3)
        f = x - i
        ascension = _cubic(f, table[i - 1, 0], table[i, 0], table[i + 1, 0], table[i + 2, 0])
        declination = _cubic(f, table[i - 1, 1], table[i, 1], table[i + 1, 1], table[i + 2, 1])
        distance = _cubic(f, table[i - 1, 2], table[i, 2], table[i + 1, 2], table[i + 2, 2])
        nutation = _cubic(f, table[i - 1, 3], table[i, 3], table[i + 1, 3], table[i + 2, 3])
        days = time[n] / 86_400.0 - 10_957.5  # since 2000-01-01 12:00
        century = days / 36_525.0
        sidereal = (280.46061837 + 360.98564736629 * days + century * century * (0.000387933 - century / 38_710_000.0)) % 360.0
        hour = sidereal * radian + nutation + longitude[n] * radian - ascension
        # parallax: the place is not the Earth's centre
        lat = latitude[n] * radian
        reduced = math.atan(FLATTENING * math.tan(lat))
        across = math.cos(reduced) + air[1] / EQUATOR * math.cos(lat)
        along = FLATTENING * math.sin(reduced) + air[1] / EQUATOR * math.sin(lat)
        shift = math.sin(8.794 / 3600.0 / distance * radian)
        turn = math.atan2(-across * shift * math.sin(hour), math.cos(declination) - across * shift * math.cos(hour))
        seen = math.atan2((math.sin(declination) - along * shift) * math.cos(turn), math.cos(declination) - across * shift * math.cos(hour))
        hour -= turn  # topocentric hour angle
        sine = math.sin(lat) * math.sin(seen) + math.cos(lat) * math.cos(seen) * math.cos(hour)
        elevation = math.asin(min(max(sine, -1.0), 1.0)) / radian
        # Refraction by the algorithm's formula, in degrees; its argument is the true elevation.
        if elevation >= SET:
            elevation += air[0] * 1.02 / (60.0 * math.tan((elevation + 10.3 / (elevation + 5.11)) * radian))
        out[0, n] = (90.0 - elevation) * radian
        south = math.atan2(math.sin(hour), math.cos(hour) * math.sin(lat) - math.tan(seen) * math.cos(lat))
        out[1, n] = (south + math.pi) % (2.0 * math.pi)
        out[2, n] = 1.0 / (distance * distance)
