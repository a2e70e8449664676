"""Selection of rows of a weather table by box, polygon, months, hours and region, with the number that each criterion excludes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError
from seaglint.climate.weather_columns import west_east
from seaglint.climate.weather_table import MONTHS, WeatherTable

BoolArray = NDArray[np.bool_]


@dataclass(frozen=True)
class GeographicBox:
    """Range of latitudes and longitudes, borders included."""

    west: float  #: Western border [deg], in any convention; beyond ``east`` the box crosses the date line.
    south: float  #: Southern border [deg].
    east: float  #: Eastern border [deg], in any convention.
    north: float  #: Northern border [deg].

    def __post_init__(self) -> None:
        if not (-90.0 <= self.south <= self.north <= 90.0 and all(-360.0 <= lon <= 360.0 for lon in (self.west, self.east))):
            raise DomainError(
                f"box {self.west:g},{self.south:g},{self.east:g},{self.north:g} is not west,south,east,north in degrees "
                "(latitudes -90 to 90, the southern one first; longitudes -360 to 360)"
            )

    def holds(self, latitude: FloatArray, longitude: FloatArray) -> BoolArray:
        """True for places [deg] inside."""
        # A whole turn has a width of 360 deg, of which the remainder would be 0.
        width = 360.0 if self.east - self.west >= 360.0 else (self.east - self.west) % 360.0
        return np.asarray((latitude >= self.south) & (latitude <= self.north) & ((longitude - self.west) % 360.0 <= width))


@dataclass(frozen=True)
class Polygon:
    """Area between corners joined by straight lines in latitude and longitude."""

    #: Longitude and latitude of three corners or more [deg]; the last is joined to the first. No wider than 180 deg to either side of the
    #: first.
    corners: tuple[tuple[float, float], ...]

    def __post_init__(self) -> None:
        if len(self.corners) < 3 or not all(abs(lon) <= 360.0 and abs(lat) <= 90.0 for lon, lat in self.corners):
            raise DomainError(
                f"a polygon of {len(self.corners)} corners {self.corners[:4]} is not one of three or more 'longitude,latitude' in degrees"
            )

    def holds(self, latitude: FloatArray, longitude: FloatArray) -> BoolArray:
        """True for places [deg] inside, by the number of borders that a ray to the east crosses."""
        # Longitudes from the first corner: a polygon across the date line is then one piece.
        first = self.corners[0][0]
        x = west_east(np.asarray(longitude, dtype=np.float64) - first)
        y = np.asarray(latitude, dtype=np.float64)
        around = [(float(west_east(lon - first)), lat) for lon, lat in self.corners]
        inside = np.zeros(np.broadcast(x, y).shape, dtype=np.bool_)
        for (x0, y0), (x1, y1) in zip(around, around[1:] + around[:1], strict=True):
            # An edge along a parallel is not crossed by another parallel.
            if y0 == y1:
                continue
            crossed = (y0 > y) != (y1 > y)
            inside ^= crossed & (x < x0 + (y - y0) / (y1 - y0) * (x1 - x0))
        return np.asarray(inside & ~np.isnan(x) & ~np.isnan(y))


@dataclass(frozen=True)
class Selection:
    """Criteria for rows; None selects all of them."""

    box: GeographicBox | None = None  #: Places inside.
    polygon: Polygon | None = None  #: Places inside.
    months: tuple[int, ...] | None = None  #: Months 1-12.
    hours: tuple[int, ...] | None = None  #: Hours of UTC 0-23; 6 holds 6:00 to 6:59.
    region: str | None = None  #: Text of the column ``region``.

    def __post_init__(self) -> None:
        if self.months is not None and (not self.months or not all(1 <= m <= 12 for m in self.months)):
            raise DomainError(f"months {self.months} are not numbers 1 to 12; give e.g. 6,7,8 or 12-2")
        if self.hours is not None and (not self.hours or not all(0 <= h <= 23 for h in self.hours)):
            raise DomainError(f"hours {self.hours} are not numbers 0 to 23; give e.g. 0,6,12,18 or 6-18")

    @property
    def words(self) -> list[str]:
        """Criteria in words, for messages."""
        out = []
        if self.box is not None:
            out.append(f"box {self.box.west:g},{self.box.south:g},{self.box.east:g},{self.box.north:g} (west,south,east,north)")
        if self.polygon is not None:
            out.append(f"polygon of {len(self.polygon.corners)} corners")
        if self.months is not None:
            out.append("months " + ", ".join(MONTHS[m - 1] for m in self.months))
        if self.hours is not None:
            out.append("hours " + ", ".join(map(str, self.hours)) + " UTC")
        if self.region is not None:
            out.append(f"region '{self.region}'")
        return out

    def places(self, latitude: FloatArray, longitude: FloatArray) -> BoolArray:
        """True for places [deg] inside box and polygon."""
        good = np.ones(np.broadcast(latitude, longitude).shape, dtype=np.bool_)
        for area in (self.box, self.polygon):
            if area is not None:
                good &= area.holds(latitude, longitude)
        return good

    def times(self, month: FloatArray, hour: FloatArray) -> BoolArray:
        """True for the selected months and hours."""
        good = np.ones(month.shape, dtype=np.bool_)
        if self.months is not None:
            good &= np.isin(month, self.months)
        if self.hours is not None:
            good &= np.isin(np.floor(hour), self.hours)
        return good

    def rows(self, columns: Mapping[str, FloatArray], count: int) -> tuple[BoolArray, dict[str, int]]:
        """Selected rows, and the number that each criterion excludes.

        Parameters
        ----------
        columns : mapping
            Columns by name; a row whose place or time is missing or unknown is excluded where one is a criterion, and counted so.
        count : int
            Number of rows.

        Returns
        -------
        ((rows,) array of bool, dict)
            Selected rows; numbers of excluded rows by reason, in the order of the criteria.
        """
        nothing = np.full(count, np.nan)
        lat, lon, month, hour = (columns.get(n, nothing) for n in ("latitude_deg", "longitude_deg", "month", "hour_utc"))
        tests = []
        for name, area in (("box", self.box), ("polygon", self.polygon)):
            if area is not None:
                tests += [("without a place", ~np.isnan(lat) & ~np.isnan(lon)), (f"outside the {name}", area.holds(lat, lon))]
        if self.months is not None:
            tests += [("without a month", ~np.isnan(month)), ("of other months", np.isin(month, self.months))]
        if self.hours is not None:
            tests += [("without an hour", ~np.isnan(hour)), ("of other hours", np.isin(np.floor(hour), self.hours))]
        good, left_out = np.ones(count, dtype=np.bool_), dict[str, int]()
        for reason, test in tests:
            excluded = int(np.sum(good & ~test))
            if excluded:
                left_out[reason] = left_out.get(reason, 0) + excluded
            good &= test
        return good, left_out


def select(table: WeatherTable, selection: Selection) -> tuple[WeatherTable, dict[str, int]]:
    """Select rows of a table, and count those that each criterion excludes.

    Raises
    ------
    DomainError
        No rows are left, or the region is not in the table; the text lists the contents of the table.
    """
    good, left_out = selection.rows(table.columns, len(table))
    if selection.region is not None:
        regions = table.text("region")
        if not np.any(regions == selection.region):
            names = sorted({str(name) for name in regions} - {""})
            raise DomainError(
                f"region '{selection.region}' has no rows; the table has {', '.join(names) or 'no regions'}; give one of them"
            )
        other = good & (regions != selection.region)
        left_out |= {"of other regions": int(other.sum())} if other.any() else {}
        good &= ~other
    if not np.any(good):
        raise DomainError(f"no rows in {' and '.join(selection.words)}; the table covers {covered(table.columns)}; choose inside it")
    return table.take(good), left_out


def covered(columns: Mapping[str, FloatArray]) -> str:
    """Range of places and times of columns, in words."""
    out = []
    for name, what in (("latitude_deg", "latitudes"), ("longitude_deg", "longitudes")):
        values = columns.get(name)
        if values is not None and not np.all(np.isnan(values)):
            out.append(f"{what} {np.nanmin(values):g} to {np.nanmax(values):g}")
    months = columns.get("month")
    if months is not None and not np.all(np.isnan(months)):
        out.append("months " + ", ".join(str(int(m)) for m in np.unique(months[~np.isnan(months)])))
    hours = columns.get("hour_utc")
    if hours is not None and not np.all(np.isnan(hours)):
        present = np.unique(np.floor(hours[~np.isnan(hours)])).astype(int)
        out.append("hours " + (", ".join(map(str, present)) if present.size <= 8 else f"{present[0]} to {present[-1]}"))
    return ", ".join(out) or "no places and no times"
