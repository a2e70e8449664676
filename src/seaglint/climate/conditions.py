"""Conditions of draws: weather rows, times, places, hours of light and free Suns, from uniform numbers.

- ``conditions`` draws rows of a weather table with times and places. Rows stay whole and keep their season and hour.
- :func:`hours_of_light` draws most hours of the day while the Sun is up, as a sea at night does not glint, with weights that undo the
  choice. The arc of the day is known to some minutes only, which suffices: the rest of the day is drawn too.
- ``illuminated`` is the probability that clouds do not hide the Sun from the sea: by their cover, only when overcast, or along slanting
  lines of sight.
- ``smoothed`` is a smooth bootstrap: drawn rows with kernel noise, so that a short table does not repeat the same few conditions.

In the smooth bootstrap each number gets normal noise with a standard deviation, the bandwidth, by Silverman's rule for the number d of
smoothed dimensions,

    h_j = s_j (4 / ((d + 2) n))^(1 / (d + 4)),

s_j the column's standard deviation and n the effective number of rows. The variance of a column grows by the share (h_j / s_j)^2 where no
bound is near. Noise is reflected at bounds. A value exactly at a bound (a calm, a clear or an overcast sky) remains there, because it is a
separate state: the chance of overcast must not be smoothed away.

References
----------
B. W. Silverman, Density Estimation for Statistics and Data Analysis (1986), Eq. 4.14 and Sec. 6.4.1.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from typing import Final, Literal, NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import ndtri

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError
from seaglint.climate.ephemeris import year_span
from seaglint.climate.weather_table import MONTHS, IntArray, WeatherTable, month_used

_BY_DAY: Final = 15.0 / 16.0  #: Share of the draws given to the arc; a dyadic one keeps Sobol points even on both sides.

#: Elevation of the Sun at the ends of the arc [rad]: refraction, radius of the disc and 0.3 deg for places far from the sensor.
_DUSK: Final = math.radians(-1.2)

_DAY: Final = 86_400.0  #: Length of a day [s].
_YEAR: Final = 365.2422 * 86_400.0
_HALF_DAY: Final = 12.0


class Hours(NamedTuple):
    """Hours of the day and the weight of each [(n,)]."""

    hour: FloatArray  #: Hours UTC [h].
    weight: FloatArray  #: Ratio of the required density (even over the allowed hours) to that of the draws [1]; 1 on average.


def arc(day: FloatArray, latitude: FloatArray, longitude: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return noon [h UTC] and half of the time during which the Sun is up [h, 0 to 12], within some minutes.

    Parameters
    ----------
    day : ndarray
        Beginnings of days [s since 1970-01-01 UTC].
    latitude, longitude : ndarray
        North and east positive [deg].

    Returns
    -------
    (ndarray, ndarray)
        Noon [h UTC] and half of the time of light [h].

    References
    ----------
    J. W. Spencer, Fourier series representation of the position of the Sun, Search 2 (1971) 172.
    """
    first = day.astype("datetime64[s]").astype("datetime64[Y]").astype("datetime64[s]").astype(np.float64)
    x = 2.0 * math.pi * (day + 43_200.0 - first) / _YEAR
    declination = (
        0.006918 - 0.399912 * np.cos(x) + 0.070257 * np.sin(x) - 0.006758 * np.cos(2 * x) + 0.000907 * np.sin(2 * x)
        - 0.002697 * np.cos(3 * x) + 0.00148 * np.sin(3 * x)
    )  # fmt: skip
    # Equation of time [rad]: the true Sun passes south this much after the mean one.
    equation_of_time = 0.000075 + 0.001868 * np.cos(x) - 0.032077 * np.sin(x) - 0.014615 * np.cos(2 * x) - 0.040849 * np.sin(2 * x)
    phi = np.radians(latitude)
    cosine = (math.sin(_DUSK) - np.sin(phi) * np.sin(declination)) / np.maximum(np.cos(phi) * np.cos(declination), 1e-9)
    return 12.0 - longitude / 15.0 - equation_of_time * _HALF_DAY / math.pi, np.arccos(np.clip(cosine, -1.0, 1.0)) * _HALF_DAY / math.pi


def hours_of_light(uniform: FloatArray, noon: FloatArray, half: FloatArray, hours: tuple[float, float]) -> Hours:
    """Draw hours between two of the day, most of them in the arc about noon.

    Parameters
    ----------
    uniform : ndarray
        Numbers in [0, 1) [(n,)]; the first 15/16 of them fall into the arc in the order of its time.
    noon, half : ndarray
        From :func:`arc` [(n,)].
    hours : (float, float)
        First and last hour that count, UTC, ascending; the last may be above 24, as in 22 to 28, which goes through midnight.

    Returns
    -------
    Hours
        Hours of the draws [h UTC] with their weights.

    Examples
    --------
    >>> even = (np.arange(1024) + 0.5) / 1024
    >>> hours = hours_of_light(even, np.full(1024, 12.0), np.full(1024, 6.0), (0.0, 24.0))
    >>> bool(abs(np.mean(hours.weight * (np.abs(hours.hour - 12.0) < 3.0)) - 0.25) < 1e-3)
    True
    """
    low, high = hours
    # The noon within the day that begins with the first hour.
    noon = (noon - low) % 24.0 + low
    # The arc may reach into the day before or after: its pieces inside the hours, in the order of the arc.
    pieces = [(np.clip(centre - half, low, high), np.clip(centre + half, low, high)) for centre in (noon + 24.0, noon, noon - 24.0)]
    light = np.sum([end - begin for begin, end in pieces], axis=0)
    dark = np.maximum(high - low - light, 0.0)
    by_day = uniform < _BY_DAY
    # Time of the arc that is left to walk through, piece by piece; below 0 once the hour is fixed.
    left = uniform / _BY_DAY * light
    hour = np.full(uniform.size, low)
    for begin, end in pieces:
        hour = np.where((left >= 0.0) & (end > begin), begin + np.minimum(left, end - begin), hour)
        left = np.where(left >= end - begin, left - (end - begin), -1.0)
    night = low + np.clip((uniform - _BY_DAY) / (1.0 - _BY_DAY), 0.0, 1.0) * dark
    for begin, end in reversed(pieces):
        night = np.where((night >= begin) & (end > begin), night + (end - begin), night)
    weight = np.where(by_day, light / _BY_DAY, dark / (1.0 - _BY_DAY)) / (high - low)
    # The last hour itself is excluded: it belongs to the next day.
    return Hours(np.clip(np.where(by_day, hour, night), low, np.nextafter(high, low)), weight)


#: Law of the probability of a free Sun: 1 - cover; 1 unless the sky is overcast; or by :func:`clear_line`.
CloudLaw = Literal["cover", "overcast", "line-of-sight"]

OVERCAST: Final = 0.99  #: Least cover of an overcast sky [1]: reports in eighths and fractions rounded to hundredths mean 1 by it.


def clear_line(cover: ArrayLike, elevation: ArrayLike, aspect: float) -> FloatArray:
    r"""Probability that a line of sight at an elevation meets no cloud.

    .. math:: P = (1 - N)^{1 + \frac{4}{\pi}\,a\,\cot e}

    Clouds are upright cylinders with a height of ``a`` times their width, at independent places, and N is the share of the sea below them.
    The shadow of one is its base and its side, ``pi w^2/4 + w h cot(e)``, and the probabilities of no cloud are powers of each other.

    Parameters
    ----------
    cover : array_like
        N, share of the sky covered as viewed from straight below [1].
    elevation : array_like
        Elevation of the line of sight [rad]; broadcast. At 0 and below no line is clear under any cloud.
    aspect : float
        a, height of clouds over their width [1]; 0 is ``CloudLaw`` ``"cover"``.

    Returns
    -------
    ndarray
        Probability [1].

    Examples
    --------
    >>> round(float(clear_line(0.5, np.radians(45.0), np.pi / 4)), 3)
    0.25
    """
    free, up = 1.0 - np.asarray(cover, dtype=np.float64), np.asarray(elevation, dtype=np.float64)
    cotangent = 1.0 / np.tan(np.clip(up, 1e-6, 0.5 * math.pi))
    return np.asarray(np.clip(free, 0.0, 1.0) ** (1.0 + 4.0 / math.pi * aspect * np.maximum(cotangent, 0.0)))


def illuminated(law: CloudLaw, cover: ArrayLike, elevation: ArrayLike, *, overcast: float = OVERCAST, aspect: float = 0.5) -> FloatArray:
    """Probability that the Sun is not hidden by clouds [1], by one of the laws; parameters as in :func:`clear_line`.

    >>> illuminated("overcast", [0.9, 1.0], 0.5).tolist()
    [1.0, 0.0]
    """
    n = np.asarray(cover, dtype=np.float64)
    match law:
        case "cover":
            return np.asarray(np.clip(1.0 - n, 0.0, 1.0) + 0.0 * np.asarray(elevation))
        case "overcast":
            return np.asarray(np.where(n >= overcast, 0.0, 1.0) + 0.0 * np.asarray(elevation))
        case "line-of-sight":
            return clear_line(n, elevation, aspect)


#: Columns that can be smoothed, with their bounds; directions are periodic.
BOUNDS: Final[Mapping[str, tuple[float, float]]] = {
    "wind_speed_m_s": (0.0, np.inf),
    "wind_from_deg": (-np.inf, np.inf),
    "cloud_cover": (0.0, 1.0),
    "sea_temperature_k": (-np.inf, np.inf),
    "air_temperature_k": (-np.inf, np.inf),
    "relative_humidity": (0.0, 1.0),
    "visibility_km": (0.0, np.inf),
    "significant_height_m": (0.0, np.inf),
}


def bandwidths(table: WeatherTable, names: Sequence[str] = ("wind_speed_m_s", "cloud_cover")) -> dict[str, float]:
    """Bandwidth of each column, in its unit; 0 where it has no spread or no values.

    Raises
    ------
    DomainError
        A column that cannot be smoothed.
    """
    for name in names:
        if name not in BOUNDS:
            raise DomainError(f"'{name}' cannot be smoothed; smoothed can be {', '.join(BOUNDS)}")
    d = len(names)
    # Width of a Gaussian kernel that suits a Gaussian density in d dimensions.
    rule = (4.0 / ((d + 2) * table.effective_rows)) ** (1.0 / (d + 4))
    return {name: rule * _standard_deviation(table, name) for name in names}


def _standard_deviation(table: WeatherTable, name: str) -> float:
    """Return the weighted standard deviation of the valid values; for directions of a wrapped normal with the same resultant."""
    values, weight = table[name], table["weight"]
    known = ~np.isnan(values) & (weight > 0.0)
    if not known.any():
        return 0.0
    if name == "wind_from_deg":
        length = min(abs(np.average(np.exp(1j * np.radians(values[known])), weights=weight[known])), 1.0)
        # Beyond 90 deg a direction is nearly uniform, and noise of any width leaves it uniform.
        return float(np.degrees(min(np.sqrt(-2.0 * np.log(max(length, 1e-12))), np.pi / 2)))
    mean = np.average(values[known], weights=weight[known])
    return float(np.sqrt(np.average((values[known] - mean) ** 2, weights=weight[known])))


def smoothed(table: WeatherTable, rows: IntArray, uniform: FloatArray, bandwidth: Mapping[str, float]) -> WeatherTable:
    """Drawn rows with noise, all of the same weight.

    Parameters
    ----------
    table : WeatherTable
        The table drawn from.
    rows : (n,) array of int
        Rows from :meth:`~seaglint.climate.weather_table.WeatherTable.draw`.
    uniform : (n, columns) array
        Numbers inside (0, 1), a column for each of ``bandwidth`` in its order.
    bandwidth : mapping
        Standard deviation of the noise by column, as ``bandwidths`` gives it.

    Raises
    ------
    DomainError
        Uniform numbers of another shape or range.
    """
    uniform = np.asarray(uniform, dtype=np.float64)
    if uniform.shape != (rows.size, len(bandwidth)) or not np.all((uniform > 0.0) & (uniform < 1.0)):
        raise DomainError(
            f"uniform numbers of shape {uniform.shape} are not {rows.size} x {len(bandwidth)} numbers inside (0, 1); give one for each row "
            "and each smoothed column"
        )
    drawn = table.take(rows) if np.any(table["weight"][rows] > 0.0) else table
    columns = dict(drawn.columns) | {"weight": np.ones(rows.size)}
    for at, (name, width) in enumerate(bandwidth.items()):
        if name in columns:
            columns[name] = _noisy(columns[name], width * ndtri(uniform[:, at]), name)
    return WeatherTable(columns, drawn.texts)


def _noisy(values: FloatArray, noise: FloatArray, name: str) -> FloatArray:
    low, high = BOUNDS[name]
    moved = values + noise
    if name == "wind_from_deg":
        return np.asarray(moved % 360.0)
    if np.isfinite(high):
        # Reflected at both ends as often as needed: no probability leaves the range.
        period = 2.0 * (high - low)
        folded = np.abs((moved - low) % period)
        moved = low + np.minimum(folded, period - folded)
    elif np.isfinite(low):
        moved = low + np.abs(moved - low)
    # Values at an end, as calms and clear skies, stay there.
    return np.where((values <= low) | (values >= high), values, moved)


_SMALL: Final = 16  #: Number of rows up to which each is a separate range of winds.


@dataclass(frozen=True)
class Times:
    """Range of equally likely times."""

    year: int  #: Calendar year, UTC.
    months: tuple[int, ...] = ()  #: Months that count; all where empty.
    hours: tuple[float, float] = (0.0, 24.0)  #: Hours of the day that count, UTC; 22 and 4 go through midnight.

    @property
    def span(self) -> tuple[float, float]:
        """Hours that count, ascending: 22 to 28 where they go through midnight."""
        low, high = self.hours
        return low, high if low < high else high + 24.0

    def draw(self, day: FloatArray, hour: FloatArray) -> FloatArray:
        """Times at uniform numbers for the day and the hour [s since 1970-01-01 UTC]."""
        low, high = self.span
        # The hours after midnight are those of the same day: days and months stay as drawn.
        return np.asarray(self.day(day) + 3600.0 * ((low + (high - low) * hour) % 24.0))

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
        # Even in the sine of latitude: even by area on a sphere.
        latitude = (
            np.degrees(np.arcsin(np.clip(low + (high - low) * across, -1.0, 1.0))) if high > low else np.full(across.size, self.south)
        )
        return latitude, (self.west + self.width * along + 180.0) % 360.0 - 180.0

    @property
    def width(self) -> float:
        """Width from the western to the eastern border [deg]."""
        width = self.east - self.west
        return width if 0.0 <= width <= 360.0 else width % 360.0


class PlaceLaw(Protocol):
    """Law of the place of a draw."""

    def draw(self, across: FloatArray, along: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Latitudes and longitudes at uniform numbers [deg]."""


@dataclass(frozen=True, eq=False)
class Conditions:
    """Weather row, time and place of every draw; times and places are NaN where the Sun is given."""

    rows: IntArray  #: Rows of the table.
    time: FloatArray  #: Seconds since 1970-01-01 UTC [s].
    latitude: FloatArray  #: Latitude, north positive [deg].
    longitude: FloatArray  #: Longitude, east positive [deg].
    weight: FloatArray | None = None  #: Weight of each draw [1], 1 on average; all the same where it is not given.


class WeatherOfDraws(NamedTuple):
    """Weather of every draw [(n,) each]."""

    wind: FloatArray  #: Wind speed at 10 m [m/s].
    cover: FloatArray  #: Cloud cover [1].
    wind_from: FloatArray  #: Direction that the wind comes from [deg]; NaN where it is not known.
    model: NDArray[np.int64]  #: Place of the model atmosphere among the models of the draws.


def months_of(time: FloatArray) -> NDArray[np.int64]:
    """Calendar month, 1 to 12, of seconds since 1970-01-01 UTC."""
    return np.asarray(time.astype("datetime64[s]").astype("datetime64[M]").astype(np.int64) % 12 + 1)


def conditions(
    table: WeatherTable,
    uniform: Mapping[str, FloatArray],
    when: Times | float | None,
    where: PlaceLaw | tuple[float, float] | tuple[FloatArray, FloatArray] | None,
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
    where : PlaceLaw, tuple or None
        Law of the place, one place (latitude, longitude) [deg] or one for each draw; None takes the rows' own, with their months and hours.
    some : ndarray of int, optional
        The only rows to draw from, with a law of the time.
    by_daylight : bool
        Draw most hours while the Sun is up, with weights, where time and place have separate laws.

    Returns
    -------
    Conditions

    Raises
    ------
    DomainError
        Rows without a place where the places of the rows are used.
    """
    row = uniform["row"]
    nowhere = np.full(row.size, np.nan)
    if when is None:
        return Conditions(draw_pairs(table, row, uniform["cover"]), nowhere, nowhere, nowhere)
    if where is None:
        return _of_rows(table, uniform, when)
    drawn = times_and_places(uniform, when, where, by_daylight=by_daylight)
    rows = _rows_at(table, row, uniform["cover"], drawn.time, np.arange(len(table)) if some is None else some)
    return replace(drawn, rows=rows)


def times_and_places(
    uniform: Mapping[str, FloatArray],
    when: Times | float,
    where: PlaceLaw | tuple[float, float] | tuple[FloatArray, FloatArray],
    *,
    by_daylight: bool = False,
) -> Conditions:
    """Draw times and places; parameters as in ``conditions``. The rows are 0."""
    count = uniform["row"].size
    place = [np.full(count, x) for x in where] if isinstance(where, tuple) else where.draw(uniform["across"], uniform["along"])
    weight = None
    if isinstance(when, float):
        time = np.full(count, when)
    elif by_daylight:
        day = when.day(uniform["day"])
        hours = hours_of_light(uniform["hour"], *arc(day, place[0], place[1]), when.span)
        time, weight = day + 3600.0 * (hours.hour % 24.0), hours.weight
    else:
        time = when.draw(uniform["day"], uniform["hour"])
    return Conditions(np.zeros(count, dtype=np.int64), time, place[0], place[1], weight)


def draw_pairs(table: WeatherTable, uniform: FloatArray, second: FloatArray) -> IntArray:
    """Draw rows at two uniform numbers each: the first chooses a range of winds, the second a row of it in the order of the cover.

    Rows have the chances of ``WeatherTable.draw``, but wind and cover follow separate numbers, so that points even in two dimensions
    leave little noise in either.

    >>> table = WeatherTable({"wind_speed_m_s": np.array([9.0, 3.0]), "cloud_cover": np.array([0.1, 0.9]), "weight": np.array([1.0, 3.0])})
    >>> draw_pairs(table, np.array([0.1, 0.74, 0.76]), np.array([0.5, 0.5, 0.5])).tolist()
    [1, 1, 0]
    """
    return _pairs(table["weight"], table["wind_speed_m_s"], table["cloud_cover"], uniform, second)


def _pairs(weight: FloatArray, wind: FloatArray, cover: FloatArray, uniform: FloatArray, second: FloatArray) -> IntArray:
    """Draw values of columns at two uniform numbers each, as ``draw_pairs``."""
    order = np.lexsort((cover, wind))
    order = order[weight[order] > 0.0]
    ends = np.cumsum(weight[order])
    groups = max(math.isqrt(order.size), 1) if order.size > _SMALL else order.size
    # About the root of the number of rows: as many ranges of winds as rows in each.
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
    """Draw rows, among some, of the month and the nearest hour of times; a month without rows uses its neighbour's rows.

    A month without rows of an hour uses all rows of the month.
    """
    weight, wind, cover, of_month, hour = (table[name][some] for name in ("weight", "wind_speed_m_s", "cloud_cover", "month", "hour_utc"))
    hour = hour % 24.0
    used = month_used(of_month, weight)
    key = np.array([0, *(used.get(m, 0) for m in range(1, 13))])[months_of(time)]
    hours = np.unique(hour[weight > 0.0])
    # Hours count only where every row has one and they differ.
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
    """Return the index of the nearest of ascending hours, around the day."""
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
    low, high = when.span
    selected &= np.isnan(hour) | ((hour - low) % 24.0 <= high - low)
    if not np.any(selected & (table["weight"] > 0.0)):
        names = ", ".join(MONTHS[m - 1] for m in when.months) or "all months"
        raise DomainError(f"no row of the weather table is of {names} between {low:g} and {when.hours[1]:g} h UTC; choose others")
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
        # Each report stands for the time until its neighbours': hours are spread evenly about it.
        around = (hour[rows] + (24.0 / max(np.unique(hour[~np.isnan(hour)] % 24.0).size, 1)) * (uniform["hour"] - 0.5)) % 24.0
        time = np.where(known, time - time % _DAY + 3600.0 * around, time)
    return Conditions(np.asarray(rows, dtype=np.int64), time, table["latitude_deg"][rows], table["longitude_deg"][rows])


def timestamp(moment: datetime) -> float:
    """Timestamp [s since 1970-01-01 UTC] of a time with a zone."""
    return moment.astimezone(UTC).timestamp()
