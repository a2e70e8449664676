"""Reader of NDBC standard meteorological text files of buoys, historical and realtime, of all generations of headings.

Up to 1998 the year has two digits (``YY MM DD hh``), from 2000 four, minutes come in 2005, and from 2007 headings begin with ``#`` and a
second line has units; dates are those of :mod:`seaglint.files.ndbc_dates`. Missing values are filled with nines as wide as the field (99.0,
999, 9999.0) or, in realtime files, ``MM``. The files have no place and no cloud cover. Winds are those at the anemometer, 3 to 5 m above
most buoys.

References
----------
NDBC, "Measurement descriptions and units", ndbc.noaa.gov/measdes.shtml: WSPD m/s, WDIR where the wind comes from, WVHT m,
temperatures degC, VIS nautical miles; times UTC.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Final

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError, DomainError
from seaglint.climate.derived import ICE_POINT, relative_humidity
from seaglint.files.ndbc_dates import headings_of, moment_of
from seaglint.files.tables.table_text import plain_number
from seaglint.files.weather.columns_read import WeatherSource, text_of
from seaglint.files.weather.times import order_of
from seaglint.sea.wind_profile import u10_of_wind

NAUTICAL_MILE_KM: Final = 1.852

#: Code of a missing value in each column that is used.
_MISSING: Final = {"WDIR": 999.0, "WSPD": 99.0, "WVHT": 99.0, "ATMP": 999.0, "WTMP": 999.0, "DEWP": 999.0, "VIS": 99.0}

_ALSO: Final = {"WD": "WDIR"}  #: Earlier spellings of headings.


def looks_like_ndbc(line: str) -> bool:
    """Return true where a line is the headings of an NDBC file."""
    return "WSPD" in headings_of(line)


def read_ndbc(path: Path, *, anemometer_m: float | None = None, place: tuple[float, float] | None = None) -> WeatherSource:
    """Read a buoy's file.

    Parameters
    ----------
    path : Path
        The file, also packed by gzip.
    anemometer_m : float, optional
        Height of the anemometer [m]; winds are then brought to 10 m by :func:`to_ten_metres`.
    place : (float, float), optional
        Latitude and longitude of the buoy [deg].

    Raises
    ------
    DataError
        Another number of cells than headings, a cell that is no number, or a date that there is not; with its line.
    """
    lines = [(number, line.split()) for number, line in enumerate(text_of(path).splitlines(), 1) if line.strip()]
    if not lines or not looks_like_ndbc(" ".join(lines[0][1])):
        raise DataError(f"{path}, line 1: is not the headings of an NDBC standard meteorological file (YY MM DD hh ... WSPD ...)")
    header = [_ALSO.get(name, name) for name in headings_of(" ".join(lines[0][1]))]
    rows = [(number, cells) for number, cells in lines[1:] if not cells[0].startswith("#")]
    if not rows:
        raise DataError(f"{path}: holds no records; bring the file again")
    for number, cells in rows:
        if len(cells) != len(header):
            raise DataError(f"{path}, line {number}: {len(cells)} cells under {len(header)} headings; is the file whole?")
    table = {name: _column(path, rows, at, name) for at, name in enumerate(header) if name in _MISSING}
    month, hour, time_notes = _times(path, rows, 5 if header[4] == "mm" else 4)
    get = {name: table.get(name, np.full(len(rows), np.nan)) for name in _MISSING}
    air, dew = get["ATMP"] + ICE_POINT, get["DEWP"] + ICE_POINT
    notes = ["no cloud cover in NDBC files: it is missing throughout; fill it with --fill cloud_cover=0.6, or bring another source"]
    speed = get["WSPD"]
    if anemometer_m is None:
        notes.append("winds are those at the anemometer, 3-5 m on most buoys; --anemometer-height 4.1 brings them to 10 m")
    else:
        speed = to_ten_metres(speed, anemometer_m)
        notes.append(f"winds brought from {anemometer_m:g} m to 10 m by the logarithmic profile")
    columns = {
        "wind_speed_m_s": speed,
        "wind_from_deg": np.where(get["WSPD"] == 0.0, np.nan, get["WDIR"] % 360.0),
        "cloud_cover": np.full(len(rows), np.nan),
        "sea_temperature_k": get["WTMP"] + ICE_POINT,
        "air_temperature_k": air,
        "relative_humidity": relative_humidity(air, dew),
        "visibility_km": NAUTICAL_MILE_KM * get["VIS"],
        "significant_height_m": get["WVHT"],
        "month": month,
        "hour_utc": hour,
    }
    if place is not None:
        columns |= {"latitude_deg": np.full(len(rows), place[0]), "longitude_deg": np.full(len(rows), place[1])}
    return WeatherSource(path, "NDBC standard meteorological", columns, len(rows), notes=(*notes, *time_notes)).within_ranges()


def to_ten_metres(speed: FloatArray, height: float) -> FloatArray:
    """Convert wind at another height to wind at 10 m [m/s], by the logarithmic profile of :mod:`seaglint.sea.wind_profile`.

    Raises
    ------
    DataError
        A height outside 1-150 m, or a wind too strong for the profile.

    Examples
    --------
    >>> to_ten_metres(np.array([0.0, 10.0]), 4.0).round(2).tolist()
    [0.0, 10.99]
    """
    if not 1.0 <= height <= 150.0:
        raise DataError(f"anemometer_height={height:g} is outside 1 to 150 m; give the height on the buoy's page")
    known, at = np.unique(speed, return_inverse=True)  # written in tenths: few values, each an iteration
    try:
        return np.array([math.nan if math.isnan(wind) else u10_of_wind(wind, height) for wind in known.tolist()])[at]
    except DomainError as error:
        raise DataError(f"{error}; or leave anemometer_height out") from None


def _column(path: Path, rows: list[tuple[int, list[str]]], at: int, name: str) -> FloatArray:
    out = np.full(len(rows), np.nan)
    for i, (number, cells) in enumerate(rows):
        if cells[at] == "MM":
            continue
        try:
            out[i] = plain_number(cells[at])
        except ValueError:
            raise DataError(
                f"{path}, row {i + 1} (line {number}), column {name}: '{cells[at]}' is not a number; correct it, or write MM"
            ) from None
    missing = _MISSING.get(name)
    return out if missing is None else np.where(out == missing, np.nan, out)


def _times(path: Path, rows: list[tuple[int, list[str]]], count: int) -> tuple[FloatArray, FloatArray, tuple[str, ...]]:
    """Return months, hours of UTC and notes on their order, of dates of ``count`` cells."""
    moments = []
    for i, (number, cells) in enumerate(rows):
        try:
            moments.append(moment_of(cells[:count]))
        except ValueError:
            raise DataError(
                f"{path}, row {i + 1} (line {number}): '{' '.join(cells[:5])}' is no date and hour; correct or remove the record"
            ) from None
    month = np.array([float(moment.month) for moment in moments])
    hour = np.array([moment.hour + moment.minute / 60.0 for moment in moments])
    return month, hour, order_of(np.array(moments, dtype="datetime64[m]"))
