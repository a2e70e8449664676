"""Reader of soundings as tables with a line of column names: our CSV, University of Wyoming's CSV, and their like."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Final

import numpy as np

from seaglint.base.errors import DataError
from seaglint.files.soundings.raw_sounding import MISSING_TEXTS, Humidity, RawSounding, without_missing
from seaglint.files.tables.table_text import plain_number, read_cell_lines

PRESSURE: Final = {
    "pressure_hpa": 1.0,
    "pres": 1.0,
    "press": 1.0,
    "p_hpa": 1.0,
    "pressure_mb": 1.0,
    "pressure_mbar": 1.0,
    "pressure": 1.0,
    "p": 1.0,
    "pressure_pa": 0.01,
    "pressure_kpa": 10.0,
}
"""Known names of pressure and their factors to hPa."""

HEIGHT: Final = {
    "height_m": False,
    "altitude_m": False,
    "alt_m": False,
    "z_m": False,
    "height": False,
    "altitude": False,
    "alt": False,
    "geometric_height_m": False,
    "hght": True,
    "geopotential_height_m": True,
    "geopotential_height": True,
    "gph": True,
    "hgt": True,
    "hght_m": True,
}
"""Known names of height; true for geopotential ones."""

TEMPERATURE: Final = {
    "temperature_k": 0.0,
    "temp_k": 0.0,
    "t_k": 0.0,
    "temperature_c": 273.15,
    "temp_c": 273.15,
    "t_c": 273.15,
    "temp": 273.15,
    "tmpc": 273.15,
}
"""Known names of temperature and their zero [K]."""

DEW_POINT: Final = {
    "dewpoint_k": 0.0,
    "dew_point_k": 0.0,
    "dew_point_temperature_k": 0.0,
    "td_k": 0.0,
    "dewpoint_c": 273.15,
    "dew_point_c": 273.15,
    "dew_point_temperature_c": 273.15,
    "td_c": 273.15,
    "dwpt": 273.15,
    "dwpc": 273.15,
}
HUMIDITY: Final = ("relative_humidity_percent", "relative_humidity_%", "relative_humidity", "rh_percent", "rh_%", "relh", "rh")
MIXING: Final = ("mixing_ratio_g_kg", "mixing_ratio_g/kg", "mixr", "mixing_ratio")

NEEDED: Final = "height_m, pressure_hpa, temperature_k (or temperature_c), relative_humidity_percent (or dewpoint_k, dewpoint_c)"


def plain_name(text: str) -> str:
    """Return a column name in lower case with single underscores.

    >>> plain_name("geopotential height_m")
    'geopotential_height_m'
    """
    return re.sub(r"[\s()\[\]]+", "_", text.strip().lower()).strip("_")


def read_sounding_table(path: Path) -> RawSounding:
    """Read a sounding with a line of column names, parted by commas, semicolons, tabs or blanks.

    Raises
    ------
    DataError
        Naming the columns that are missing and what looks like them, or the line of a cell that is no number.
    """
    (head, *rest), _ = read_cell_lines(path, f"it needs columns {NEEDED}")
    blanks = len(head.cells) == 1 and len(head.text.split()) > 1
    cells = [line.text.split() if blanks else line.cells for line in (head, *rest)]
    names = [plain_name(cell) for cell in cells[0]]
    if len(set(names)) < len(names):
        twice = next(name for name in names if names.count(name) > 1)
        raise DataError(f"{path}: line {head.number}: the column {twice} stands twice; leave one out")
    rows = cells[1:]
    start = 1
    if rows and rows[0] and not any(_is_number(cell) for cell in rows[0]):
        rows, start = rows[1:], 2  # a line of units
    chosen, humidity = _columns(path, head.number, cells[0], names)
    if not rows:
        raise DataError(f"{path}: has column names and no rows; it needs levels")
    columns = {}
    for what, column in chosen.items():
        columns[what] = without_missing(
            np.array([_number(path, rest[i + start - 1].number, names[column], _cell(row, column)) for i, row in enumerate(rows)])
        )
    names_of = {what: cells[0][column] for what, column in chosen.items()}
    plain = {what: names[column] for what, column in chosen.items()}
    value = columns["humidity"]
    if humidity == "dewpoint_k":
        value = value + DEW_POINT[plain["humidity"]]
    pressures = [_cell(row, chosen["pressure"]) for row in rows]
    return RawSounding(
        "table with a line of column names",
        columns["pressure"] * PRESSURE[plain["pressure"]],
        columns["height"],
        columns["temperature"] + TEMPERATURE[plain["temperature"]],
        humidity,
        value,
        HEIGHT[plain["height"]],
        names_of,
        resolution=(rounding(pressures) * PRESSURE[plain["pressure"]], rounding([_cell(row, chosen["height"]) for row in rows])),
    )


def _columns(path: Path, line: int, given: list[str], names: list[str]) -> tuple[dict[str, int], Humidity]:
    """Columns of the quantities; all that are missing are named together."""
    chosen: dict[str, int] = {}
    missing = []
    for what, known, told in (
        ("pressure", tuple(PRESSURE), "pressure_hpa"),
        ("height", tuple(HEIGHT), "height_m"),
        ("temperature", tuple(TEMPERATURE), "temperature_k (or temperature_c)"),
    ):
        present = [name for name in known if name in names]
        if len(present) > 1 and what == "temperature":
            raise DataError(f"{path}: line {line}: both of {present[0]}, {present[1]} are given; leave one out")
        if present:
            chosen[what] = names.index(present[0])
        else:
            missing.append(told)
    humidity: Humidity = "dewpoint_k"
    ours = [name for name in ("relative_humidity_percent", "dewpoint_k", "dewpoint_c") if name in names]
    if len(ours) > 1:
        raise DataError(f"{path}: line {line}: both of {ours[0]}, {ours[1]} are given; leave one out")
    kinds: tuple[tuple[Humidity, tuple[str, ...]], ...] = (
        ("dewpoint_k", tuple(DEW_POINT)),
        ("relative_humidity_percent", HUMIDITY),
        ("mixing_ratio_g_kg", MIXING),
    )
    for kind, known in kinds:
        present = [name for name in known if name in names]
        if present:
            chosen["humidity"], humidity = names.index(present[0]), kind
            break
    else:
        missing.append("relative_humidity_percent (or dewpoint_k, dewpoint_c)")
    if missing:
        alike = _alike(given, [given[i] for i in chosen.values()], missing)
        raise DataError(f"{path}: line {line}: columns are {', '.join(given)}; missing: {', '.join(missing)}{alike}")
    return chosen, humidity


def _alike(given: list[str], used: list[str], missing: list[str]) -> str:
    """Columns that look like missing ones."""
    begins = {
        "p": "pressure_hpa",
        "h": "height_m",
        "z": "height_m",
        "a": "height_m",
        "t": "temperature_k",
        "d": "dewpoint_k",
        "r": "relative_humidity_percent",
    }
    hints = []
    for name in given:
        like = begins.get(plain_name(name)[:1])
        if name not in used and like is not None and any(like in what for what in missing):
            hints.append(f"is '{name}' {like}?")
    return f"; {' '.join(hints)}" if hints else ""


def _cell(row: list[str], column: int) -> str:
    return row[column].strip() if column < len(row) else ""


def _is_number(text: str) -> bool:
    try:
        plain_number(text)
    except ValueError:
        return False
    return True


def _number(path: Path, line: int, name: str, text: str) -> float:
    if text.lower() in MISSING_TEXTS:
        return float("nan")
    try:
        value = plain_number(text)
    except ValueError:
        raise DataError(f"{path}: line {line}: {name} = '{text}' is not a number") from None
    return value if np.isfinite(value) else float("nan")


def rounding(texts: list[str]) -> float:
    """Step that numbers are rounded to, from the digits after their points.

    >>> rounding(["1013.2", "1000"])
    0.1
    """
    most = max((len(text.partition(".")[2]) for text in texts if "e" not in text.lower()), default=0)
    return float(10.0 ** -min(most, 6))
