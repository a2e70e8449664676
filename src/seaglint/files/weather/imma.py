"""Reader of ICOADS ship reports: the core of IMMA1 records (columns 1-108 of each line), and ICOADS as CSV.

Attachments behind the core are not read. Missing fields are blank. Longitudes run 0 to 359.99, or -179.99 to 180.

References
----------
S. R. Smith et al., "The International Maritime Meteorological Archive (IMMA) Format", ICOADS Release 3.0 (2016), table C0.
"""

from __future__ import annotations

from pathlib import Path
from typing import Final

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError
from seaglint.climate.derived import west_east
from seaglint.files.weather.columns_read import WeatherSource, text_of
from seaglint.files.weather.marine_codes import columns_of
from seaglint.files.weather.times import month_and_hour
from seaglint.files.weather.weather_cells import TextColumns

#: Fields of the core in their order, with the number of characters of each; 108 in all.
CORE: Final = (
    "YR:4 MO:2 DY:2 HR:4 LAT:5 LON:6 IM:2 ATTC:1 TI:1 LI:1 DS:1 VS:1 NID:2 II:2 ID:9 C1:2 DI:1 D:3 WI:1 W:3 VI:1 VV:2 WW:2 W1:1 SLP:5 A:1 "
    "PPP:3 IT:1 AT:4 WBTI:1 WBT:4 DPTI:1 DPT:4 SI:2 SST:4 N:1 NH:1 CL:1 HI:1 H:1 CM:1 CH:1 WD:2 WP:2 WH:2 SD:2 SP:2 SH:2"
)

#: Fields that are used and the unit of each: hours, degrees, m/s, degC, oktas, half metres, or a code.
_SCALE: Final = {
    "MO": 1.0,
    "HR": 0.01,
    "LAT": 0.01,
    "LON": 0.01,
    "D": 1.0,
    "W": 0.1,
    "VV": 1.0,
    "WW": 1.0,
    "AT": 0.1,
    "DPT": 0.1,
    "SST": 0.1,
    "N": 1.0,
    "WH": 1.0,
    "SH": 1.0,
}

#: Headings of NCEI's global marine CSV, which keeps IMMA's tenths, and the field of each.
_NCEI: Final = {
    "LATITUDE": ("LAT", 1.0),
    "LONGITUDE": ("LON", 1.0),
    "WIND_DIR": ("D", 1.0),
    "WIND_SPEED": ("W", 0.1),
    "VISIBILITY": ("VV", 1.0),
    "PRES_WX": ("WW", 1.0),
    "AIR_TEMP": ("AT", 0.1),
    "DEW_PT_TEMP": ("DPT", 0.1),
    "SEA_SURF_TEMP": ("SST", 0.1),
    "TOT_CLD_AMT": ("N", 1.0),
    "WAVE_HGT": ("WH", 1.0),
    "SWELL_HGT": ("SH", 1.0),
}


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


def is_icoads_csv(header: tuple[str, ...]) -> bool:
    """Return true where headings are those of ICOADS: IMMA's abbreviations, or NCEI's long names."""
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
