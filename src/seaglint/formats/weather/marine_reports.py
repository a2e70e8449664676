"""Readers of marine weather reports: ships (ICOADS as IMMA1 records or CSV), buoys (NDBC text), and any CSV file by a map of its columns.

ICOADS: the core of IMMA1 records is read (columns 1-108 of each line), attachments behind it are not. Missing fields are blank. Longitudes
run 0 to 359.99, or -179.99 to 180. A sky obscured by fog, rain or snow counts as overcast, one obscured otherwise is missing (Hahn et al.).

NDBC: standard meteorological files, historical and realtime, of all generations of headings. Up to 1998 the year has two digits
(``YY MM DD hh``), from 2000 four, minutes come in 2005, and from 2007 headings begin with ``#`` and a second line has units; dates are
parsed by ``seaglint.formats.waves.ndbc_buoys``. Missing values are filled with nines as wide as the field (99.0, 999, 9999.0) or, in
realtime files, ``MM``. The files have no place and no cloud cover. Winds are measured at the anemometer, 3 to 5 m above most buoys.

References
----------
S. R. Smith et al., "The International Maritime Meteorological Archive (IMMA) Format", ICOADS Release 3.0 (2016), table C0;
WMO Manual on Codes, code tables 2700 (total cloud) and 4377 (visibility).
C. J. Hahn, S. G. Warren and J. London, "Edited synoptic cloud reports from ships and land stations over the globe, 1982-1991",
ORNL/CDIAC-77, NDP-026B (1996), Sec. 3.B.
NDBC, "Measurement descriptions and units", ndbc.noaa.gov/measdes.shtml: WSPD m/s, WDIR where the wind comes from, WVHT m,
temperatures degC, VIS nautical miles; times UTC.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Final

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError, DomainError
from seaglint.climate.weather_columns import (
    HELPERS,
    ICE_POINT,
    MappedColumn,
    relative_humidity,
    significant_height,
    west_east,
    wind_from_components,
)
from seaglint.climate.weather_table import RANGES, TEXTS
from seaglint.formats.tables.table_text import plain_number
from seaglint.formats.waves.ndbc_buoys import headings_of, moment_of
from seaglint.formats.weather.weather_cells import TextColumns, WeatherSource, month_and_hour, order_of, text_of
from seaglint.sea.wind_profile import u10_of_wind

CALM: Final = 361.0  #: Code of the wind direction of a calm; 362 is a variable one, and neither has a direction.

OBSCURED: Final = 9.0  #: Total cloud of a sky that cannot be seen.

#: Present weather (code 4677) of fog, rain and snow that hide an overcast sky.
OBSCURING: Final = np.array([10, 11, 12, *range(40, 50), *range(50, 76), 77, 79, *range(80, 100)], dtype=np.float64)

#: Lower border of each step of code 4377 [km]; 90 is anything below 0.05 km and counts as half of it.
VISIBILITY_KM: Final = {90: 0.025, 91: 0.05, 92: 0.2, 93: 0.5, 94: 1.0, 95: 2.0, 96: 4.0, 97: 10.0, 98: 20.0, 99: 50.0}

HALF_METRES: Final = 0.5  #: Unit of the heights of waves and swell [m].

#: Fields of the core in their order, with the number of characters of each; 108 in all.
CORE: Final = (
    "YR:4 MO:2 DY:2 HR:4 LAT:5 LON:6 IM:2 ATTC:1 TI:1 LI:1 DS:1 VS:1 NID:2 II:2 ID:9 C1:2 DI:1 D:3 WI:1 W:3 VI:1 VV:2 WW:2 W1:1 SLP:5 A:1 "
    "PPP:3 IT:1 AT:4 WBTI:1 WBT:4 DPTI:1 DPT:4 SI:2 SST:4 N:1 NH:1 CL:1 HI:1 H:1 CM:1 CH:1 WD:2 WP:2 WH:2 SD:2 SP:2 SH:2"
)

NAUTICAL_MILE_KM: Final = 1.852

#: Fields that are used and the unit of each: hours, degrees, m/s, degC, oktas, half metres, or a code.
_SCALE: Final = {
    "MO": 1.0, "HR": 0.01, "LAT": 0.01, "LON": 0.01, "D": 1.0, "W": 0.1, "VV": 1.0, "WW": 1.0, "AT": 0.1, "DPT": 0.1, "SST": 0.1, "N": 1.0,
    "WH": 1.0, "SH": 1.0,
}  # fmt: skip

#: Headings of NCEI's global marine CSV, which keeps IMMA's tenths, and the field of each.
_NCEI: Final = {
    "LATITUDE": ("LAT", 1.0), "LONGITUDE": ("LON", 1.0), "WIND_DIR": ("D", 1.0), "WIND_SPEED": ("W", 0.1), "VISIBILITY": ("VV", 1.0),
    "PRES_WX": ("WW", 1.0), "AIR_TEMP": ("AT", 0.1), "DEW_PT_TEMP": ("DPT", 0.1), "SEA_SURF_TEMP": ("SST", 0.1), "TOT_CLD_AMT": ("N", 1.0),
    "WAVE_HGT": ("WH", 1.0), "SWELL_HGT": ("SH", 1.0),
}  # fmt: skip

#: Code of a missing value in each column that is used.
_MISSING: Final = {"WDIR": 999.0, "WSPD": 99.0, "WVHT": 99.0, "ATMP": 999.0, "WTMP": 999.0, "DEWP": 999.0, "VIS": 99.0}

_ALSO: Final = {"WD": "WDIR"}  #: Earlier spellings of headings.


def columns_of(report: dict[str, FloatArray]) -> tuple[dict[str, FloatArray], dict[str, int], list[str]]:
    """Convert the columns of marine reports to the columns of a weather table.

    Parameters
    ----------
    report : dict of (rows,) arrays
        By their names in IMMA, NaN where missing: MO, HR [h], LAT, LON [deg], D [deg or 361, 362], W [m/s], VV (code 4377), WW (code 4677),
        AT, DPT, SST [degC], N [oktas or 9], WH, SH [half metres]. An absent column is missing throughout.

    Returns
    -------
    (dict, dict, list)
        Columns; values set missing, by reason; notes on assumptions.
    """
    rows = next(iter(report.values())).size

    def get(name: str) -> FloatArray:
        return report.get(name, np.full(rows, np.nan))

    direction, cloud, weather, visibility = get("D"), get("N"), get("WW"), get("VV")
    # A calm may be reported by the code of its direction alone.
    speed = np.where(np.isnan(get("W")) & (direction == CALM), 0.0, get("W"))
    hidden = cloud == OBSCURED
    overcast = hidden & np.isin(weather, OBSCURING)
    air, dew, sea = (get(name) + ICE_POINT for name in ("AT", "DPT", "SST"))
    columns = {
        "wind_speed_m_s": speed,
        "wind_from_deg": np.where((direction >= CALM) | (speed == 0.0), np.nan, direction % 360.0),
        "cloud_cover": np.where(overcast, 1.0, np.where(hidden, np.nan, cloud / 8.0)),
        "sea_temperature_k": sea,
        "air_temperature_k": air,
        "relative_humidity": relative_humidity(air, dew),
        "visibility_km": _visibility(visibility),
        "significant_height_m": significant_height(HALF_METRES * get("WH"), HALF_METRES * get("SH")),
        "month": get("MO"),
        "hour_utc": get("HR"),
        "latitude_deg": get("LAT"),
        "longitude_deg": get("LON"),
    }
    lost = {
        "cloud_cover of a sky obscured by other than fog, rain or snow": int(np.sum(hidden & ~overcast)),
        "wind_from_deg of a calm or variable wind": int(np.sum((direction >= CALM) & ~np.isnan(direction))),
    }
    notes = []
    if overcast.any():
        notes.append(f"{int(overcast.sum())} skies hidden by fog, rain or snow count as overcast")
    if np.any(~np.isnan(visibility)):
        notes.append("visibility is the lower border of its code's step")
    return columns, {reason: count for reason, count in lost.items() if count}, notes


def _visibility(code: FloatArray) -> FloatArray:
    out = np.full(code.shape, np.nan)
    for step, km in VISIBILITY_KM.items():
        out[code == step] = km
    return out


def _layout() -> dict[str, tuple[int, int]]:
    out, at = {}, 0
    for entry in CORE.split():
        name, _, length = entry.partition(":")
        out[name] = (at, at + int(length))
        at += int(length)
    return out


LAYOUT: Final = _layout()  #: First column and the one behind the last of every field, counted from 0.


def looks_like_imma(line: str) -> bool:
    """Return true where a line begins as an IMMA record: year, month or blanks, and a latitude."""
    year, month, lat = (line[slice(*LAYOUT[name])].strip() for name in ("YR", "MO", "LAT"))
    return (
        len(line) >= LAYOUT["C1"][1]
        and "," not in line
        and year.isdigit()
        and 1600 <= int(year) <= 2100
        and (not month or month.isdigit())
        and (not lat or lat.lstrip("+-").isdigit())
    )


def read_imma(path: Path) -> WeatherSource:
    """Read the core of IMMA records.

    Raises
    ------
    DataError
        A line that ends within its place, or a field that is no number; with its line.
    """
    lines = [(number, line) for number, line in enumerate(text_of(path).splitlines(), 1) if line.strip()]
    for number, line in lines:
        if not looks_like_imma(line):
            raise DataError(
                f"{path}, line {number}: '{line[:45]}' does not begin with year, month, day, hour, latitude, longitude in IMMA's columns "
                "1-45; is the file whole and IMMA1?"
            )
    report = {name: scale * _field(path, lines, name) for name, scale in _SCALE.items()}
    report["LON"] = west_east(report["LON"])
    columns, lost, notes = columns_of(report)
    return WeatherSource(path, "ICOADS IMMA1", columns, len(lines), set_missing=lost, notes=tuple(notes)).within_ranges()


def _field(path: Path, lines: list[tuple[int, str]], name: str) -> FloatArray:
    first, last = LAYOUT[name]
    cells = [line[first:last].strip() for _, line in lines]
    out = np.full(len(cells), np.nan)
    for i, cell in enumerate(cells):
        if cell:
            try:
                out[i] = int(cell)
            except ValueError:
                raise DataError(
                    f"{path}, row {i + 1} (line {lines[i][0]}), columns {first + 1}-{last}: {name} = '{cell}' is no whole number; correct "
                    "it or remove the record"
                ) from None
    return out


def is_icoads_csv(header: Sequence[str]) -> bool:
    """Return true for the headings of ICOADS: IMMA's abbreviations, or NCEI's long names."""
    return {"MO", "LAT", "LON", "W"} <= set(header) or {"DATE", "LATITUDE", "LONGITUDE", "WIND_SPEED"} <= set(header)


def read_icoads_csv(cells: TextColumns) -> WeatherSource:
    """Read the columns of an ICOADS CSV file.

    IMMA's abbreviations are in plain units (hours, degrees, m/s, degC, oktas, half metres); NCEI's long names (WIND_SPEED, AIR_TEMP, ...)
    keep the tenths of the records.

    Raises
    ------
    DataError
        A cell that is no number, or a place or wind that only records in hundredths and tenths have.
    """
    if "MO" in cells.header:
        report = {name: cells.numbers(name) for name in _SCALE if name in cells.header}
        for name, high in (("LAT", 90.0), ("LON", 360.0), ("HR", 24.0)):
            bad = np.flatnonzero(np.abs(report.get(name, np.zeros(0))) > high)
            if bad.size:
                raise DataError(
                    f"{cells.where(int(bad[0]))}, column {name}: {report[name][bad[0]]:g} is above {high:g}; with IMMA's abbreviations as "
                    f"headings values are in degrees, hours, m/s and degC: divide by IMMA's scale, or read it with map='NAME=COLUMN:UNIT'"
                )
        times: tuple[str, ...] = ()
    else:
        report = {field: scale * cells.numbers(name) for name, (field, scale) in _NCEI.items() if name in cells.header}
        report["MO"], report["HR"], times = month_and_hour(cells, "DATE", naive_is_utc=True)
    report["LON"] = west_east(report["LON"])
    columns, lost, notes = columns_of(report)
    notes += [*times]
    return WeatherSource(cells.path, "ICOADS CSV", columns, len(cells.rows), set_missing=lost, notes=tuple(notes)).within_ranges()


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
        Height of the anemometer [m]; winds are then brought to 10 m by ``to_ten_metres``.
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
    # From 2007 a second line that begins with # has the units.
    rows = {number: cells for number, cells in lines[1:] if not cells[0].startswith("#")}
    if not rows:
        raise DataError(f"{path}: holds no records; bring the file again")
    for number, cells in rows.items():
        if len(cells) != len(header):
            raise DataError(f"{path}, line {number}: {len(cells)} cells under {len(header)} headings; is the file whole?")
    table = TextColumns(path, header, list(rows.values()), list(rows))
    month, hour, time_notes = _times(table, 5 if header[4] == "mm" else 4)
    get = {name: _column(table, name) if name in header else np.full(len(rows), np.nan) for name in _MISSING}
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
    known, at = np.unique(speed, return_inverse=True)  # written in tenths: few values, each solved by iteration
    try:
        return np.array([math.nan if math.isnan(wind) else u10_of_wind(wind, height) for wind in known.tolist()])[at]
    except DomainError as error:
        raise DataError(f"{error}; or leave anemometer_height out") from None


def _column(table: TextColumns, name: str) -> FloatArray:
    out = np.full(len(table), np.nan)
    for i, cell in enumerate(table.text(name)):
        if cell == "MM":
            continue
        try:
            out[i] = plain_number(cell)
        except ValueError:
            raise DataError(f"{table.where(i)}, column {name}: '{cell}' is not a number; correct it, or write MM") from None
    return np.where(out == _MISSING[name], np.nan, out)


def _times(table: TextColumns, count: int) -> tuple[FloatArray, FloatArray, tuple[str, ...]]:
    """Return months, hours of UTC and notes on their order, of dates of ``count`` cells."""
    moments = []
    for i, cells in enumerate(table.rows):
        try:
            moments.append(moment_of(cells[:count]))
        except ValueError:
            raise DataError(f"{table.where(i)}: '{' '.join(cells[:5])}' is no date and hour; correct or remove the record") from None
    month = np.array([float(moment.month) for moment in moments])
    return month, np.array([moment.hour + moment.minute / 60.0 for moment in moments]), order_of(np.array(moments, dtype="datetime64[m]"))


def read_mapped(cells: TextColumns, columns: Sequence[MappedColumn], *, naive_is_utc: bool = False) -> WeatherSource:
    """Read the columns of a CSV file by a map; headings that are weather columns already need no map.

    Parameters
    ----------
    cells : TextColumns
        The file.
    columns : sequence of MappedColumn
        Map of its columns.
    naive_is_utc : bool
        Flag: times without a zone are UTC; else they are refused.

    Raises
    ------
    DataError
        A column that the file does not have, a cell that is no number or outside its range, a time without a zone, no wind speed.
    """
    requested = list(columns)
    mapped = {column.name for column in requested}
    requested += [MappedColumn(name, name) for name in (*RANGES, *TEXTS) if name in cells.header and name not in mapped]
    for column in requested:
        if column.column not in cells.header:
            raise DataError(
                f"{cells.path}: column '{column.column}' of map='{column.name}={column.column}' is not there; columns are "
                f"{', '.join(cells.header)}"
            )
    texts = {c.name: np.asarray(cells.text(c.column), dtype=np.str_) for c in requested if c.name in TEXTS}
    numbers = {c.name: c.scale * cells.numbers(c.column) + c.offset for c in requested if c.name not in TEXTS and c.name != "time"}
    heading = {c.name: c.column for c in requested}
    notes: list[str] = []
    if "time" in heading:
        month, hour, time_notes = month_and_hour(cells, heading["time"], naive_is_utc=naive_is_utc)
        numbers = {"month": month, "hour_utc": hour} | numbers
        notes += time_notes
    if {"wind_u_m_s", "wind_v_m_s"} <= set(numbers):
        speed, come = wind_from_components(numbers["wind_u_m_s"], numbers["wind_v_m_s"])
        numbers |= {"wind_speed_m_s": speed, "wind_from_deg": come}
    elif "wind_to_deg" in numbers:
        numbers["wind_from_deg"] = numbers["wind_to_deg"] + 180.0
    if "dew_point_k" in numbers and "air_temperature_k" in numbers:
        numbers.setdefault("relative_humidity", relative_humidity(numbers["air_temperature_k"], numbers["dew_point_k"]))
    if "wind_speed_m_s" not in numbers:
        raise DataError(
            f"{cells.path}: no column for wind_speed_m_s; columns are {', '.join(cells.header)}; name it with "
            "map='wind_speed_m_s=COLUMN:UNIT', or its components with wind_u_m_s and wind_v_m_s"
        )
    if "cloud_cover" not in numbers:
        numbers["cloud_cover"] = np.full(len(cells.rows), np.nan)
        notes.append("no column for cloud_cover: it is missing throughout; map one, or fill it with --fill cloud_cover=0.6")
    if "wind_from_deg" in numbers:
        numbers["wind_from_deg"] = numbers["wind_from_deg"] % 360.0
    if "longitude_deg" in numbers:
        numbers["longitude_deg"] = west_east(numbers["longitude_deg"])
    used = {c.column for c in requested}
    idle = [name for name in cells.header if name not in used]
    if idle:
        notes.append(f"columns passed over: {', '.join(idle)}")
    stored = {name: values for name, values in numbers.items() if name not in HELPERS}
    for name, values in stored.items():
        cells.within(name, values, heading.get(name, ""), "correct it or its unit in the map of columns, or leave it empty")
    if np.any(np.isnan(stored.get("weight", np.zeros(1)))):
        row = int(np.flatnonzero(np.isnan(stored["weight"]))[0])
        raise DataError(f"{cells.where(row)}, column {heading['weight']}: a weight is missing; give a number of 0 or more")
    return WeatherSource(cells.path, "CSV", stored, len(cells.rows), texts, notes=tuple(notes))
