"""Times, places and weather of draws, from uniform numbers: rows of the table stay whole and keep their season and hour."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Final

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError
from seaglint.climate.daylight import arc, hours_of_light
from seaglint.climate.ephemeris import year_span
from seaglint.climate.weather_table import MONTHS, IntArray, WeatherTable, month_used

_DAY: Final = 86_400.0
_SMALL: Final = 16  #: Number of rows up to which each is a range of winds of its own.


@dataclass(frozen=True)
class Times:
    """Range of equally likely times."""

    year: int  #: Calendar year, UTC.
    months: tuple[int, ...] = ()  #: Months that count; all where empty.
    hours: tuple[float, float] = (0.0, 24.0)  #: Hours of the day that count, UTC.

    def draw(self, day: FloatArray, hour: FloatArray) -> FloatArray:
        """Times at uniform numbers for the day and the hour [s since 1970-01-01 UTC]."""
        low, high = self.hours
        return np.asarray(self.day(day) + 3600.0 * (low + (high - low) * hour))

    def day(self, uniform: FloatArray) -> FloatArray:
        """Beginnings of days at uniform numbers [s since 1970-01-01 UTC]."""
        days = self.days
        return np.asarray(days[(uniform * days.size).astype(np.intp)])

    @property
    def days(self) -> FloatArray:
        """Beginnings of the allowed days [s since 1970-01-01 UTC]."""
        first, last = year_span(self.year)
        days = np.arange(first, last, _DAY)
        return days[np.isin(months_of(days), self.months)] if self.months else days


@dataclass(frozen=True)
class GeographicRegion:
    """Region of places that are equally likely by area, between latitudes and longitudes [deg]; a point where both ends are equal.

    A western border beyond the eastern one crosses the date line.
    """

    south: float
    north: float
    west: float
    east: float

    def draw(self, across: FloatArray, along: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Latitudes and longitudes at uniform numbers [deg]."""
        low, high = np.sin(np.radians([self.south, self.north]))
        latitude = (
            np.degrees(np.arcsin(np.clip(low + (high - low) * across, -1.0, 1.0))) if high > low else np.full(across.size, self.south)
        )
        wide = self.east - self.west
        wide = wide if 0.0 <= wide <= 360.0 else wide % 360.0
        return latitude, (self.west + wide * along + 180.0) % 360.0 - 180.0


@dataclass(frozen=True, eq=False)
class Conditions:
    """Weather row, time and place of every draw; times and places are NaN where the Sun is given."""

    rows: IntArray  #: Rows of the table.
    time: FloatArray  #: Seconds since 1970-01-01 UTC [s].
    #: ``latitude``, ``longitude``: North and east positive [deg].
    latitude: FloatArray
    longitude: FloatArray
    weight: FloatArray | None = None  #: Weight of each draw [1], 1 on average; all the same where it is not given.


def months_of(time: FloatArray) -> NDArray[np.int64]:
    """Calendar month, 1 to 12, of seconds since 1970-01-01 UTC."""
    return np.asarray(time.astype("datetime64[s]").astype("datetime64[M]").astype(np.int64) % 12 + 1)


def conditions(
    table: WeatherTable,
    uniform: Mapping[str, FloatArray],
    when: Times | float | None,
    where: GeographicRegion | tuple[float, float] | tuple[FloatArray, FloatArray] | None,
    some: NDArray[np.intp] | None = None,
    *,
    by_daylight: bool = False,
) -> Conditions:
    """Draw weather, time and place.

    Parameters
    ----------
    table : WeatherTable
        Rows with wind and cover.
    uniform : mapping
        Uniform numbers [(n,)] named ``row, cover, day, hour, across, along``.
    when : Times, float or None
        Law of the time, one time [s since 1970-01-01 UTC], or None where the Sun is given.
    where : GeographicRegion, tuple or None
        Law of the place, one place (latitude, longitude) [deg] or one for each draw; None takes the rows' own, with their months and hours.
    some : ndarray of int, optional
        The only rows to draw from, with a law of the time.
    by_daylight : bool
        Draw most hours while the Sun is up, with weights, where time and place have a law of their own.

    Returns
    -------
    Conditions

    Raises
    ------
    DomainError
        Rows without a place where places are theirs.
    """
    row = uniform["row"]
    nowhere = np.full(row.size, np.nan)
    if when is None:
        return Conditions(draw_pairs(table, row, uniform["cover"]), nowhere, nowhere, nowhere)
    if where is None:
        return _of_rows(table, uniform, when)
    place = (
        where.draw(uniform["across"], uniform["along"]) if isinstance(where, GeographicRegion) else [np.full(row.size, x) for x in where]
    )
    weight = None
    if isinstance(when, float):
        time = np.full(row.size, when)
    elif by_daylight:
        day = when.day(uniform["day"])
        hours = hours_of_light(uniform["hour"], *arc(day, place[0], place[1]), when.hours)
        time, weight = day + 3600.0 * hours.hour, hours.weight
    else:
        time = when.draw(uniform["day"], uniform["hour"])
    rows = _rows_at(table, row, uniform["cover"], time, np.arange(len(table)) if some is None else some)
    return Conditions(rows, time, place[0], place[1], weight)


def draw_pairs(table: WeatherTable, uniform: FloatArray, second: FloatArray) -> IntArray:
    """Draw rows at two uniform numbers each: the first chooses a range of winds, the second a row of it in the order of the cover.

    Rows have the chances of :meth:`WeatherTable.draw`, but wind and cover each follow a number of their own, so that points even in two
    dimensions leave little noise in either.

    >>> table = WeatherTable({"wind_speed_m_s": np.array([9.0, 3.0]), "cloud_cover": np.array([0.1, 0.9]), "weight": np.array([1.0, 3.0])})
    >>> draw_pairs(table, np.array([0.1, 0.74, 0.76]), np.array([0.5, 0.5, 0.5])).tolist()
    [1, 1, 0]
    """
    return _pairs(table["weight"], table["wind_speed_m_s"], table["cloud_cover"], uniform, second)


def _pairs(weight: FloatArray, wind: FloatArray, cover: FloatArray, uniform: FloatArray, second: FloatArray) -> IntArray:
    """Draw values of columns at two uniform numbers each, as :func:`draw_pairs`."""
    order = np.lexsort((cover, wind))
    order = order[weight[order] > 0.0]
    ends = np.cumsum(weight[order])
    groups = max(math.isqrt(order.size), 1) if order.size > _SMALL else order.size
    group = np.minimum(((ends - 0.5 * weight[order]) / ends[-1] * groups).astype(np.intp), groups - 1)
    inner = np.lexsort((cover[order], group))
    order, group = order[inner], group[inner]
    ends = np.cumsum(weight[order])
    last = np.append(np.flatnonzero(np.diff(group)), order.size - 1)
    group_ends = ends[last]
    chosen = np.minimum(np.searchsorted(group_ends, uniform * ends[-1], side="right"), last.size - 1)
    start = np.concatenate([[0.0], group_ends[:-1]])[chosen]
    at = np.searchsorted(ends, start + second * (group_ends[chosen] - start), side="right")
    return np.asarray(order[np.minimum(at, last[chosen])], dtype=np.int64)


def _rows_at(table: WeatherTable, uniform: FloatArray, second: FloatArray, time: FloatArray, some: NDArray[np.intp]) -> IntArray:
    """Rows, among some, of the month and the nearest hour of times; a month without rows has those of its neighbour.

    A month that has no rows of an hour gives all of its own.
    """
    weight, wind, cover, of_month, hour = (table[name][some] for name in ("weight", "wind_speed_m_s", "cloud_cover", "month", "hour_utc"))
    hour = hour % 24.0
    used = month_used(of_month, weight)
    month = months_of(time)
    key = np.array([0, *(used.get(m, 0) for m in range(1, 13))])[month]
    hours = np.unique(hour[weight > 0.0])
    hours = hours[:0] if np.isnan(hours).any() or hours.size < 2 else hours
    at_hour = _nearest(time % _DAY / 3600.0, hours) if hours.size else np.zeros(time.size, dtype=np.intp)
    order = np.lexsort((at_hour, key))
    steps = np.flatnonzero(np.diff(key[order]) | np.diff(at_hour[order])) + 1
    out = np.empty(uniform.size, dtype=np.int64)
    for at in np.split(order, steps):
        in_month = (of_month == key[at[0]]) if used else np.ones(some.size, dtype=np.bool_)
        rows = in_month & (hour == hours[at_hour[at[0]]]) if hours.size else in_month
        rows = rows if np.any(weight[rows] > 0.0) else in_month
        matches = np.flatnonzero(rows)
        out[at] = some[matches[_pairs(weight[matches], wind[matches], cover[matches], uniform[at], second[at])]]
    return out


def _nearest(hour: FloatArray, hours: FloatArray) -> NDArray[np.intp]:
    """Index of the nearest of ascending hours, around the day."""
    wrapped = np.concatenate([[hours[-1] - 24.0], hours, [hours[0] + 24.0]])
    return np.asarray((np.searchsorted(0.5 * (wrapped[1:] + wrapped[:-1]), hour) - 1) % hours.size)


def _of_rows(table: WeatherTable, uniform: Mapping[str, FloatArray], when: Times | float) -> Conditions:
    if isinstance(when, float):
        raise DomainError("one time with the places of the weather's rows: their months and hours are their own; leave [time] out")
    for name in ("latitude_deg", "longitude_deg"):
        if np.isnan(table[name]).any():
            raise DomainError(f"place_from_weather = true needs {name} in every row of the weather table; give a region or [place] instead")
    month, hour = table["month"], table["hour_utc"]
    selected = np.isnan(month) | np.isin(month, when.months or tuple(range(1, 13)))
    low, high = when.hours
    selected &= np.isnan(hour) | ((hour % 24.0 >= low) & (hour % 24.0 <= high))
    if not np.any(selected & (table["weight"] > 0.0)):
        names = ", ".join(MONTHS[m - 1] for m in when.months) or "all months"
        raise DomainError(f"no row of the weather table is of {names} between {low:g} and {high:g} h UTC; choose others")
    matches = np.flatnonzero(selected)
    rows = matches[draw_pairs(table.take(matches), uniform["row"], uniform["cover"])]
    time = when.draw(uniform["day"], uniform["hour"])
    for m in range(1, 13):
        at = np.flatnonzero(month[rows] == m)
        if at.size:
            days = Times(when.year, (m,)).days
            time[at] = days[(uniform["day"][at] * days.size).astype(np.intp)] + time[at] % _DAY
    known = ~np.isnan(hour[rows])
    if known.any():
        spread = 24.0 / max(np.unique(hour[~np.isnan(hour)] % 24.0).size, 1)
        around = (hour[rows] + spread * (uniform["hour"] - 0.5)) % 24.0
        time = np.where(known, time - time % _DAY + 3600.0 * around, time)
    return Conditions(np.asarray(rows, dtype=np.int64), time, table["latitude_deg"][rows], table["longitude_deg"][rows])


def timestamp(moment: datetime) -> float:
    """Timestamp [s since 1970-01-01 UTC] of a time with a zone."""
    return moment.astimezone(UTC).timestamp()
