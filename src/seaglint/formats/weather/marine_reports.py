"""Readers of marine weather reports: ships (ICOADS as IMMA1 records or CSV), buoys (NDBC text), and any CSV file by a map of its columns.

ICOADS: the core of IMMA1 records is read (columns 1-108 of each line), attachments behind it are not. Missing fields are blank. Longitudes
run 0 to 359.99, or -179.99 to 180. A sky obscured by fog, rain or snow counts as overcast, one obscured otherwise is missing (Hahn et al.).
Attachments may hold free text with any sign (commas, quotes, tabs, control bytes): only columns 1-45 say whether a line is a record.

ICOADS as CSV has one of three sets of headings: IMMA's abbreviations, in plain units; those of NCEI's archive of global marine data, which
keep the tenths, half metres and codes of the records; and those of NCEI's earlier orders, in degrees Fahrenheit and, for the wind, tenths
of a metre per second.

Every reader of observations leaves out bad lines and sets bad values missing, counted by kind; a file with more bad lines than good ones is
refused. The map of a CSV file is the user's own, so that there the first bad cell is refused.

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
NCEI, "Global Marine Data", www.ncei.noaa.gov/data/global-marine: headings of the CSV files and of ``Marine_CSV_sample.csv``.
NDBC, "Measurement descriptions and units", ndbc.noaa.gov/measdes.shtml: WSPD m/s, WDIR where the wind comes from, WVHT m,
temperatures degC, VIS nautical miles; times UTC.
"""

from __future__ import annotations

import math
import re
from calendar import monthrange
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError, DomainError
from seaglint.base.limits import WIND_PROFILE
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
from seaglint.formats.tables.observed_lines import Line, lines_of, shown, sound, text_of
from seaglint.formats.waves.ndbc_buoys import headings_of, moment_of
from seaglint.formats.weather.weather_cells import (
    TextColumns,
    WeatherSource,
    header_of,
    moment_of_iso,
    month_and_hour,
    numbers_or_missing,
    order_of,
    separator_of,
    split_cells,
    twice_noted,
)
from seaglint.sea.wind_profile import u10_of_wind

CALM: Final = 361.0  #: Code of the wind direction of a calm.
VARIABLE: Final = 362.0  #: Code of a variable wind direction; neither of the two is a direction.

YEARS: Final = (1600, 2100)  #: Years of records.

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

#: Headings of NCEI's archive of global marine data, which keeps IMMA's units, and the field of each with the unit of its numbers.
_NCEI: Final = {
    "LATITUDE": ("LAT", 1.0), "LONGITUDE": ("LON", 1.0), "WIND_DIR": ("D", 1.0), "WIND_SPEED": ("W", 0.1), "VISIBILITY": ("VV", 1.0),
    "PRES_WX": ("WW", 1.0), "AIR_TEMP": ("AT", 0.1), "DEW_PT_TEMP": ("DPT", 0.1), "SEA_SURF_TEMP": ("SST", 0.1), "TOT_CLD_AMT": ("N", 1.0),
    "WAVE_HGT": ("WH", 1.0), "SWELL_HGT": ("SH", 1.0),
}  # fmt: skip

_FAHRENHEIT: Final = 1.0 / 1.8  #: Degree Fahrenheit [K].
_FREEZING_F: Final = 32.0  #: Freezing point of water [degF].

#: Headings of NCEI's earlier orders, whose temperatures are in degrees Fahrenheit; of the sea's the published sample has none.
_NCEI_ORDER: Final = {
    "Latitude": ("LAT", 1.0), "Longitude": ("LON", 1.0), "Wind Direction": ("D", 1.0), "Wind Speed": ("W", 0.1), "Visibility": ("VV", 1.0),
    "Present Weather": ("WW", 1.0), "Air Temperature": ("AT", _FAHRENHEIT), "Dew Point Temperature": ("DPT", _FAHRENHEIT),
    "Sea Surface Temperature": ("SST", _FAHRENHEIT), "Total Cloud Amount": ("N", 1.0), "Wave Height": ("WH", 1.0),
    "Swell Height": ("SH", 1.0),
}  # fmt: skip

#: IMMA's abbreviations as headings, in plain units.
_ABBREVIATED: Final = {name: (name, 1.0) for name in ("YR", "DY", *_SCALE)}

#: Headings by which each kind of ICOADS CSV is recognised, the name of the column of times, and the fields of its headings.
_KINDS: Final = (
    ({"MO", "LAT", "LON", "W"}, "", _ABBREVIATED),
    ({"DATE", "LATITUDE", "LONGITUDE", "WIND_SPEED"}, "DATE", _NCEI),
    ({"Time of Observation", "Latitude", "Longitude", "Wind Speed"}, "Time of Observation", _NCEI_ORDER),
)

_ABSENT: Final = frozenset({"MM"})  #: Missing value of NDBC's realtime files, beside nines.

_WHOLE: Final = re.compile(r"[+-]?[0-9]+")

#: Code of a missing value in each column that is used.
_MISSING: Final = {"WDIR": 999.0, "WSPD": 99.0, "WVHT": 99.0, "ATMP": 999.0, "WTMP": 999.0, "DEWP": 999.0, "VIS": 99.0}

#: Ranges of mapped columns that go around.
_AROUND: Final = {"wind_from_deg": (0.0, 360.0), "wind_to_deg": (0.0, 360.0), "longitude_deg": (-180.0, 360.0)}

_REMEDY: Final = "correct it or its unit in the map of columns, or leave it empty"

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
    known, coded = (direction >= 0.0) & (direction <= 360.0), np.isin(direction, (CALM, VARIABLE))
    hidden = cloud == OBSCURED
    overcast = hidden & np.isin(weather, OBSCURING)
    air, dew, sea = (get(name) + ICE_POINT for name in ("AT", "DPT", "SST"))
    columns = {
        "wind_speed_m_s": speed,
        "wind_from_deg": np.where(known & (speed != 0.0), direction % 360.0, np.nan),
        "cloud_cover": np.where(overcast, 1.0, np.where(hidden, np.nan, cloud / 8.0)),
        "sea_temperature_k": sea,
        "air_temperature_k": air,
        "relative_humidity": _humidity(air, dew),
        "visibility_km": _visibility(visibility),
        "significant_height_m": significant_height(HALF_METRES * get("WH"), HALF_METRES * get("SH")),
        "month": get("MO"),
        "hour_utc": get("HR"),
        "latitude_deg": get("LAT"),
        "longitude_deg": get("LON"),
    }
    lost = {
        "cloud_cover of a sky obscured by other than fog, rain or snow": int(np.sum(hidden & ~overcast)),
        "wind_from_deg of a calm or variable wind": int(np.sum(coded)),
        "wind_from_deg outside 0 to 362": int(np.sum(~known & ~coded & ~np.isnan(direction))),
        "visibility_km of an unknown code": int(np.sum(~np.isnan(visibility) & ~np.isin(visibility, list(VISIBILITY_KM)))),
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


def _humidity(air: FloatArray, dew: FloatArray) -> FloatArray:
    """Return the relative humidity, NaN where a temperature [K] is out of the range of the air's."""
    low, high = RANGES["air_temperature_k"]
    return relative_humidity(*(np.where((t >= low) & (t <= high), t, np.nan) for t in (air, dew)))


def _layout() -> dict[str, tuple[int, int]]:
    out, at = {}, 0
    for entry in CORE.split():
        name, _, length = entry.partition(":")
        out[name] = (at, at + int(length))
        at += int(length)
    return out


LAYOUT: Final = _layout()  #: First column and the one behind the last of every field, counted from 0.


def _date_and_place(line: str) -> list[int | None] | None:
    """Return year, month, day, hour, latitude and longitude of a record as written, None where blank; None if one is no number."""
    cells = [line[slice(*LAYOUT[name])].strip(" ") for name in ("YR", "MO", "DY", "HR", "LAT", "LON")]
    return [int(cell) if cell else None for cell in cells] if all(_WHOLE.fullmatch(cell) for cell in cells if cell) else None


def imma_fault(line: str) -> str:
    """Return what is wrong with the date and place of an IMMA record, in words; empty where nothing is.

    Examples
    --------
    >>> imma_fault("2005 714 650 4512 33075 130")
    'shorter than 45 columns'
    """
    if len(line) < LAYOUT["C1"][1]:
        return "shorter than 45 columns"
    numbers = _date_and_place(line)
    if numbers is None:
        return "with something else than numbers in date and place"
    year, month, day, _, lat, lon = numbers
    if year is None:
        return "without a year"
    return _date_fault(year, month, day) or _place_fault(0.01 * (lat or 0), 0.01 * (lon or 0))


def _date_fault(year: int | None, month: int | None, day: int | None) -> str:
    """Return what is wrong with a date, in words; a year of no date is any, as are a month and a day."""
    if year is not None and not YEARS[0] <= year <= YEARS[1]:
        return f"with a year outside {YEARS[0]} to {YEARS[1]}"
    if month is not None and not 1 <= month <= 12:
        return "with a month outside 1 to 12"
    days = monthrange(2000 if year is None else year, month)[1] if month is not None else 31
    return "" if day is None or 1 <= day <= days else "with a day that its month does not have"


def _place_fault(latitude: float, longitude: float) -> str:
    return "" if abs(latitude) <= 90.0 and -180.0 <= longitude <= 360.0 else "with a place outside the globe"


def looks_like_imma(lines: Sequence[Line]) -> bool:
    """Return true for lines of which one at least has a year, a latitude and, in their columns, only numbers for date and place."""
    found = (_date_and_place(line) for _, line in lines)
    return any(numbers and numbers[4] is not None and YEARS[0] <= (numbers[0] or 0) <= YEARS[1] for numbers in found)


def read_imma(path: Path) -> WeatherSource:
    """Read the core of IMMA records.

    Raises
    ------
    DataError
        More than half of the lines are no records.
    """
    lines = lines_of(text_of(path))
    good, left_out = sound(path, lines, [imma_fault(line) for _, line in lines], "IMMA records", "is the file whole and IMMA1?")
    records = [line for (_, line), keep in zip(lines, good.tolist(), strict=True) if keep]
    report: dict[str, FloatArray] = {}
    lost: dict[str, int] = {}
    for name, scale in _SCALE.items():
        values, bad = _field(records, name)
        report[name] = scale * values
        lost |= {f"{name} that is no whole number": bad} if bad else {}
    report["LON"] = west_east(report["LON"])
    columns, coded, notes = columns_of(report)
    notes += twice_noted(records)
    source = WeatherSource(path, "ICOADS IMMA1", columns, len(lines), left_out=left_out, set_missing=lost | coded, notes=tuple(notes))
    return source.within_ranges()


def _field(records: Sequence[str], name: str) -> tuple[FloatArray, int]:
    """Return a field of records as numbers, and how many are none; a field in which the record ends is none either."""
    first, last = LAYOUT[name]
    out, bad = np.full(len(records), np.nan), 0
    for i, record in enumerate(records):
        cell = record[first:last].strip(" ")
        if cell and len(record) >= last and _WHOLE.fullmatch(cell):
            out[i] = int(cell)
        elif cell:
            bad += 1
    return out, bad


def is_icoads_csv(header: Sequence[str]) -> bool:
    """Return true for the headings of ICOADS: IMMA's abbreviations, or one of NCEI's two sets."""
    return any(needed <= set(header) for needed, *_ in _KINDS)


def read_icoads_csv(path: Path) -> WeatherSource:
    """Read an ICOADS CSV file.

    IMMA's abbreviations are in plain units (hours, degrees, m/s, degC, oktas, half metres). NCEI's headings in capitals (WIND_SPEED,
    AIR_TEMP, ...) have tenths, half metres and codes as in the records; those in words (Wind Speed, Air Temperature, ...) also, and
    temperatures in degrees Fahrenheit.

    Raises
    ------
    DataError
        More than half of the rows are bad: another number of cells, a date that there is not, no place on the globe.
    """
    first, *lines = [line for line in lines_of(text_of(path)) if not line[1].lstrip().startswith("#")]
    header, separator = header_of([first]), separator_of(first[1])
    time, fields = next((time, fields) for needed, time, fields in _KINDS if needed <= set(header))
    split = [split_cells(line, separator) for _, line in lines]
    whole = [cells is not None and len(cells) == len(header) for cells in split]
    rows = [cells if cells is not None and good else [""] * len(header) for cells, good in zip(split, whole, strict=True)]
    table = TextColumns(path, header, rows, [number for number, _ in lines])
    report, bad = _icoads_columns(table, fields)
    faults = _icoads_faults(table, report, bad, time)
    faults = [fault if good else "with another number of cells" for fault, good in zip(faults, whole, strict=True)]
    remedy = (
        "with IMMA's abbreviations as headings values are in degrees, hours, m/s and degC: divide by IMMA's scale, or read it with "
        "map='NAME=COLUMN:UNIT'"
    )
    good, left_out = sound(path, lines, faults, "ICOADS records", "is the file whole?" if time else remedy)
    keep = np.flatnonzero(good).tolist()
    table = TextColumns(path, header, [rows[i] for i in keep], [table.lines[i] for i in keep])
    report = {name: values[good] for name, values in report.items()}
    lost = {f"{name} that is no number": int(np.sum(cells[good])) for name, cells in bad.items() if np.any(cells[good])}
    times: tuple[str, ...] = ()
    if time:
        report["MO"], report["HR"], times = month_and_hour(table, time, naive_is_utc=True)
    report["LON"] = west_east(report["LON"])
    columns, coded, notes = columns_of(report)
    notes += [*times, *twice_noted([lines[i][1] for i in keep])]
    source = WeatherSource(path, "ICOADS CSV", columns, len(lines), left_out=left_out, set_missing=lost | coded, notes=tuple(notes))
    return source.within_ranges()


def _icoads_columns(
    table: TextColumns, fields: Mapping[str, tuple[str, float]]
) -> tuple[dict[str, FloatArray], dict[str, NDArray[np.bool_]]]:
    """Return the fields of an ICOADS CSV file in plain units, and by field which cells are no numbers."""
    report, bad = {}, {}
    for heading, (name, scale) in fields.items():
        if heading in table.header:
            values, bad[name] = numbers_or_missing(table.text(heading))
            report[name] = scale * (values - _FREEZING_F if scale == _FAHRENHEIT else values)
    return report, bad


def _icoads_faults(table: TextColumns, report: dict[str, FloatArray], bad: dict[str, NDArray[np.bool_]], time: str) -> list[str]:
    """Return what is wrong with date and place of each row, in words."""
    nothing = np.full(len(table), np.nan)
    dates = zip(*(report.get(name, nothing).tolist() for name in ("YR", "MO", "DY", "HR")), strict=True)
    places = np.nan_to_num(np.stack([report["LAT"], report["LON"]], axis=1)).tolist()
    letters = np.any([bad[name] for name in ("YR", "MO", "DY", "LAT", "LON") if name in bad], axis=0).tolist()
    texts = table.text(time) if time else [""] * len(table)
    out = []
    for (year, month, day, hour), (lat, lon), text, lettered in zip(dates, places, texts, letters, strict=True):
        if lettered:
            fault = "with something else than numbers in date and place"
        elif text and not _is_time(text):
            fault = "with a time that there is not"
        elif not math.isnan(hour) and not 0.0 <= hour <= 24.0:
            fault = "with an hour outside 0 to 24"
        else:
            fault = _date_fault(*(None if math.isnan(number) else int(number) for number in (year, month, day)))
        out.append(fault or _place_fault(lat, lon))
    return out


def _is_time(text: str) -> bool:
    try:
        moment_of_iso(text, naive_is_utc=True)
    except ValueError:
        return False
    return True


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
        More than half of the lines are bad (another number of cells, a date that there is not), or headings that change within the file.
    """
    lines = lines_of(text_of(path))
    if not lines or not looks_like_ndbc(lines[0][1]):
        raise DataError(f"{path}, line 1: is not the headings of an NDBC standard meteorological file (YY MM DD hh ... WSPD ...)")
    named = headings_of(lines[0][1])
    header = [_ALSO.get(name, name) for name in named]
    for number, line in lines[1:]:
        if (again := headings_of(line)) and again != named:
            raise DataError(f"{path}, line {number}: has other headings than line {lines[0][0]}; give the parts as files of their own")
    # From 2007 a second line that begins with # has the units.
    lines = [line for line in lines[1:] if not line[1].lstrip().startswith("#") and not headings_of(line[1])]
    split = [line.split() for _, line in lines]
    dated = 5 if header[4] == "mm" else 4
    good, left_out = sound(path, lines, [_ndbc_fault(cells, len(header), dated) for cells in split], "NDBC records", "is the file whole?")
    keep = np.flatnonzero(good).tolist()
    table = TextColumns(path, header, [split[i] for i in keep], [lines[i][0] for i in keep])
    moments = [moment_of(cells[:dated]) for cells in table.rows]
    get: dict[str, FloatArray] = {}
    lost: dict[str, int] = {}
    for name, nines in _MISSING.items():
        values, bad = numbers_or_missing(table.text(name) if name in header else [], _ABSENT)
        get[name] = np.where(values == nines, np.nan, values) if name in header else np.full(len(table), np.nan)
        lost |= {f"{name} that is no number": int(bad.sum())} if bad.any() else {}
    notes = ["no cloud cover in NDBC files: it is missing throughout; fill it with --fill cloud_cover=0.6, or bring another source"]
    speed, direction = get["WSPD"], get["WDIR"]
    turned = ~np.isnan(direction) & ~((direction >= 0.0) & (direction <= 360.0))
    lost |= {"wind_from_deg outside 0 to 360": int(turned.sum())} if turned.any() else {}
    if anemometer_m is None:
        notes.append("winds are those at the anemometer, 3-5 m on most buoys; --anemometer-height 4.1 brings them to 10 m")
    else:
        speed = to_ten_metres(speed, anemometer_m)
        notes.append(f"winds brought from {anemometer_m:g} m to 10 m by the logarithmic profile")
        strong = int(np.sum(np.isnan(speed) & ~np.isnan(get["WSPD"])))
        lost |= {f"wind_speed_m_s outside the logarithmic profile, 0 to {WIND_PROFILE[1]:g} at 10 m": strong} if strong else {}
    air, dew = get["ATMP"] + ICE_POINT, get["DEWP"] + ICE_POINT
    columns = {
        "wind_speed_m_s": speed,
        "wind_from_deg": np.where(turned | (get["WSPD"] == 0.0), np.nan, direction % 360.0),
        "cloud_cover": np.full(len(table), np.nan),
        "sea_temperature_k": get["WTMP"] + ICE_POINT,
        "air_temperature_k": air,
        "relative_humidity": _humidity(air, dew),
        "visibility_km": NAUTICAL_MILE_KM * get["VIS"],
        "significant_height_m": get["WVHT"],
        "month": np.array([float(moment.month) for moment in moments]),
        "hour_utc": np.array([moment.hour + moment.minute / 60.0 for moment in moments]),
    }
    notes += [*order_of(np.array(moments, dtype="datetime64[m]")), *twice_noted([" ".join(cells) for cells in table.rows])]
    if place is not None:
        columns |= {"latitude_deg": np.full(len(table), place[0]), "longitude_deg": np.full(len(table), place[1])}
    source = WeatherSource(
        path, "NDBC standard meteorological", columns, len(lines), left_out=left_out, set_missing=lost, notes=tuple(notes)
    )
    return source.within_ranges()


def _ndbc_fault(cells: Sequence[str], count: int, dated: int) -> str:
    """Return what is wrong with a row, in words; its first cells are the date."""
    if len(cells) != count:
        return "with another number of cells"
    try:
        moment_of(cells[:dated])
    except ValueError:
        return "with a date that there is not"
    return ""


def to_ten_metres(speed: FloatArray, height: float) -> FloatArray:
    """Convert wind at another height to wind at 10 m [m/s], by the logarithmic profile of :mod:`seaglint.sea.wind_profile`.

    A wind outside the profile's range is missing.

    Raises
    ------
    DataError
        A height outside 1-150 m.

    Examples
    --------
    >>> to_ten_metres(np.array([0.0, 10.0]), 4.0).round(2).tolist()
    [0.0, 10.99]
    """
    if not 1.0 <= height <= 150.0:
        raise DataError(f"anemometer_height={height:g} is outside 1 to 150 m; give the height on the buoy's page")
    known, at = np.unique(speed, return_inverse=True)  # written in tenths: few values, each solved by iteration
    return np.array([_at_ten_metres(wind, height) for wind in known.tolist()])[at]


def _at_ten_metres(wind: float, height: float) -> float:
    try:
        return math.nan if math.isnan(wind) else u10_of_wind(wind, height)
    except DomainError:
        return math.nan


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
                f"{shown(', '.join(cells.header), 400)}"
            )
    texts = {c.name: np.asarray(cells.text(c.column), dtype=np.str_) for c in requested if c.name in TEXTS}
    numbers = {c.name: c.scale * cells.numbers(c.column) + c.offset for c in requested if c.name not in TEXTS and c.name != "time"}
    heading = {c.name: c.column for c in requested}
    for name, around in _AROUND.items():
        if name in numbers:
            cells.within(name, numbers[name], heading[name], _REMEDY, around)
    notes: list[str] = []
    if "time" in heading:
        month, hour, time_notes = month_and_hour(cells, heading["time"], naive_is_utc=naive_is_utc)
        numbers = {"month": month, "hour_utc": hour} | numbers
        notes += time_notes
    if {"wind_u_m_s", "wind_v_m_s"} <= set(numbers):
        speed, come = wind_from_components(numbers["wind_u_m_s"], numbers["wind_v_m_s"])
        numbers |= {"wind_speed_m_s": speed, "wind_from_deg": come}
    elif "wind_to_deg" in numbers:
        numbers["wind_from_deg"] = (numbers["wind_to_deg"] + 180.0) % 360.0
    if "dew_point_k" in numbers and "air_temperature_k" in numbers:
        numbers.setdefault("relative_humidity", relative_humidity(numbers["air_temperature_k"], numbers["dew_point_k"]))
    if "wind_speed_m_s" not in numbers:
        raise DataError(
            f"{cells.path}: no column for wind_speed_m_s; columns are {shown(', '.join(cells.header), 400)}; name it with "
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
        notes.append(f"columns passed over: {shown(', '.join(idle), 400)}")
    stored = {name: values for name, values in numbers.items() if name not in HELPERS}
    for name, values in stored.items():
        cells.within(name, values, heading.get(name, ""), _REMEDY)
    if np.any(np.isnan(stored.get("weight", np.zeros(1)))):
        row = int(np.flatnonzero(np.isnan(stored["weight"]))[0])
        raise DataError(f"{cells.where(row)}, column {heading['weight']}: a weight is missing; give a number of 0 or more")
    return WeatherSource(cells.path, "CSV", stored, len(cells.rows), texts, notes=tuple(notes))
