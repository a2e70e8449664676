"""Reader of soundings as tables under a line of column names: CSV of any separator, and lists in columns under lines of a header."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError
from seaglint.files.soundings.ozone_columns import OzoneColumn, ozone_columns, with_ozone
from seaglint.files.soundings.raw_sounding import RawSounding, is_missing_text
from seaglint.files.soundings.sounding_columns import SoundingColumn, columns_of, plain_name, sounding_of
from seaglint.files.tables.table_text import cells_of, plain_number

NEEDED: Final = "height_m, pressure_hpa, temperature_k (or temperature_c), relative_humidity_percent (or dewpoint_k, dewpoint_c)"

HEADER_LINES: Final = 300  #: Lines of a file among which the line of column names is looked for.

MOST_SHOWN: Final = 300  #: Characters of column names that an error shows.

SAMPLE: Final = 2000  #: Rows at either end by which the rounding of a long table is found.

#: Names of two words in lists whose columns single blanks part.
_TWO_WORDS: Final = re.compile(
    r"(?i)\b(elapsed|asc|ascent|wind|flight|geopot|dew|relative|air) +(time|rate|speed|dir|direction|height|point|humidity|temp)"
)

#: Separators of cells; None for blanks.
SEPARATORS: Final = ("\t", ";", ",", None)


@dataclass(frozen=True)
class _Heading:
    """Line of column names: its place in the lines, its number from 1, the separator of cells, names, and units of a line below it."""

    place: int
    number: int
    separator: str | None
    names: list[str]
    units: list[str] | None
    first: int


def read_sounding_table(path: Path, text: str) -> RawSounding:
    """Read a sounding with a line of column names, parted by commas, semicolons, tabs or blanks; lines before it are a header.

    Raises
    ------
    DataError
        Naming the columns that are missing and what looks like them, or the line of a cell that is no number.
    """
    lines = [(n, line) for n, line in enumerate(text.splitlines(), 1) if line.strip() and line.lstrip()[0] != "#"]
    if not lines:
        raise DataError(f"{path}: is empty; it needs columns {NEEDED}")
    heading = _heading(path, lines)
    columns = columns_of(heading.names, heading.units)
    _require(path, heading, columns)
    ozone = ozone_columns(path, heading.names, heading.units, where=f"line {heading.number}: ")
    rows = [pair for pair in lines[heading.first :] if not _is_rule(pair[1])]
    if not rows:
        raise DataError(f"{path}: has column names and no rows; it needs levels")
    numbers, digits = _numbers(path, heading, rows, [*columns, *ozone])
    named = {plain_name(column.name) for column in columns}
    form = "AVAPS (EOL sounding format)" if _is_eol(lines[: heading.place]) else "table with a line of column names"
    # siphon's data frames of University of Wyoming's list: geopotential heights, and no unit in any name
    frame = {"pressure", "height", "temperature", "dewpoint"} <= named
    return with_ozone(sounding_of(form, columns, numbers, digits, geopotential=frame), ozone, numbers)


def _is_eol(header: list[tuple[int, str]]) -> bool:
    return any("EOL Sounding Format" in line or "AVAPS" in line for _, line in header)


def _is_rule(line: str) -> bool:
    return set(line.strip()) <= set("-=+| ")


def _split(path: Path, number: int, line: str, separator: str | None) -> list[str]:
    if separator is None:
        return line.split()
    if '"' not in line:
        return [cell.strip() for cell in line.split(separator)]
    return [cell.strip() for cell in cells_of(path, number, line, separator)]


def _heading(path: Path, lines: list[tuple[int, str]]) -> _Heading:
    """Line that names pressure and temperature; without one the first line, whose missing columns are then named."""
    for place, (_, line) in enumerate(lines[:HEADER_LINES]):
        for separator in SEPARATORS:
            if separator is not None and separator not in line:
                continue
            heading = _as_heading(path, lines, place, separator)
            kinds = {column.kind for column in columns_of(heading.names, heading.units)}
            if {"pressure", "temperature"} <= kinds:
                return heading
    line = lines[0][1]
    separator = max((s for s in SEPARATORS if s is not None), key=line.count)
    return _as_heading(path, lines, 0, separator if separator in line else None)


def _as_heading(path: Path, lines: list[tuple[int, str]], place: int, separator: str | None) -> _Heading:
    number, line = lines[place]
    names = _split(path, number, line, separator)
    first, units = place + 1, None
    while first < len(lines) and _is_rule(lines[first][1]):
        first += 1
    if first < len(lines):
        below = _split(path, lines[first][0], lines[first][1], separator)
        if below and not any(_is_number(cell) for cell in below) and any(not is_missing_text(cell) for cell in below if cell):
            units, first = below, first + 1
    if separator is None and first < len(lines):
        row = next((cells for cells in (text.split() for _, text in lines[first : first + 20]) if len(cells) > 2), [])
        if units is None and len(row) == len(names) + 1 and _counts([text for _, text in lines[first : first + 20]]):
            names = ["", *names]  # an index without a name
        names, units = _aligned(line, names, units, len(row))
    elif units is not None and len(units) < len(names):
        units = [*units, *[""] * (len(names) - len(units))]
    return _Heading(place, number, separator, names, units, first)


def _counts(rows: list[str]) -> bool:
    """Return true for rows that begin with 0, 1, 2 and so on."""
    return [row.split()[0] for row in rows] == [str(i) for i in range(len(rows))]


def _aligned(line: str, names: list[str], units: list[str] | None, count: int) -> tuple[list[str], list[str] | None]:
    """Names and units of columns that blanks part, as many as the cells of a row: names may hold single blanks."""
    spaced = [name.strip() for name in re.split(r"\s{2,}|\t", line.strip()) if name.strip()]
    joined = _TWO_WORDS.sub(r"\1_\2", line).split()
    for candidate in (names, joined, spaced):
        if len(candidate) == count:
            names = candidate
            break
    else:
        if units is not None and len(units) == count > len(names):
            # one name, as of a time in minutes and seconds, stands over several columns at the left
            names = [*[""] * (count - len(names)), *names]
    return names, units if units is not None and len(units) == len(names) else None


def _require(path: Path, heading: _Heading, columns: list[SoundingColumn]) -> None:
    """Refuse tables that lack a quantity; all that are missing are named together."""
    names = [plain_name(name) for name in heading.names]
    for column in columns:
        if names.count(names[column.place]) > 1:
            raise DataError(f"{path}: line {heading.number}: the column {names[column.place]} stands twice; leave one out")
    present = {column.quantity for column in columns}
    missing = [
        text
        for what, text in (
            ("pressure", "pressure_hpa"),
            ("height", "height_m"),
            ("temperature", "temperature_k (or temperature_c)"),
            ("humidity", "relative_humidity_percent (or dewpoint_k, dewpoint_c)"),
        )
        if what not in present
    ]
    if missing:
        used = [column.name for column in columns]
        alike = _alike(heading.names, used, missing)
        shown = ", ".join(name for name in heading.names if name)
        shown = f"{shown[:MOST_SHOWN]}..." if len(shown) > MOST_SHOWN else shown
        raise DataError(f"{path}: line {heading.number}: columns are {shown}; missing: {', '.join(missing)}{alike}")
    for known in (("temperature_k", "temperature_c"), ("relative_humidity_percent", "dewpoint_k", "dewpoint_c")):
        both = [name for name in known if name in names]
        if len(both) > 1:
            raise DataError(f"{path}: line {heading.number}: both of {both[0]}, {both[1]} are given; leave one out")


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


def _numbers(
    path: Path, heading: _Heading, rows: list[tuple[int, str]], columns: list[SoundingColumn | OzoneColumn]
) -> tuple[dict[int, FloatArray], dict[int, float]]:
    """Values of the columns as written, NaN where missing, and the steps that they are rounded to, by column of the file."""
    places = [column.place for column in columns]
    if heading.separator is None:
        _require_whole(path, rows, len(heading.names))
    try:
        # a table of nothing but numbers, ten times as fast as cell by cell
        values = np.loadtxt([line for _, line in rows], delimiter=heading.separator, usecols=places, ndmin=2, comments=None)
        numbers = {place: values[:, i] for i, place in enumerate(places)}
        sample = [*rows[:SAMPLE], *rows[SAMPLE:][-SAMPLE:]]
    except ValueError:
        numbers, sample = {}, rows
    cells = [_split(path, number, line, heading.separator) for number, line in sample]
    if not numbers:
        for column in columns:
            values = np.array([_number(path, n, column.name, _cell(row, column.place)) for (n, _), row in zip(rows, cells, strict=True)])
            numbers[column.place] = values
    steps = {place: rounding([_cell(row, place) for row in cells]) for place in places}
    return {place: np.where(np.isfinite(v), v, np.nan) for place, v in numbers.items()}, steps


def _require_whole(path: Path, rows: list[tuple[int, str]], count: int) -> None:
    """Refuse rows whose cells blanks part and that have more or fewer than the names: which one is missing nobody knows."""
    for number, line in rows:
        cells = len(line.split())
        if cells != count:
            raise DataError(
                f"{path}: line {number}: {cells} values under {count} column names, parted by blanks; give -9999 for missing values, "
                "or commas between the cells"
            )


def _cell(row: list[str], column: int) -> str:
    return row[column] if column < len(row) else ""


def _is_number(text: str) -> bool:
    try:
        plain_number(_with_point(text))
    except ValueError:
        return False
    return True


def _with_point(text: str) -> str:
    """Text of a number with a decimal point, where it has one decimal comma."""
    return text.replace(",", ".") if text.count(",") == 1 and "." not in text else text


def _number(path: Path, line: int, name: str, text: str) -> float:
    if is_missing_text(text):
        return float("nan")
    try:
        return plain_number(_with_point(text))
    except ValueError:
        raise DataError(f"{path}: line {line}: {plain_name(name)} = '{text}' is not a number") from None


def rounding(texts: list[str]) -> float:
    """Step that numbers are rounded to, from the digits after their points.

    >>> rounding(["1013.2", "1000"])
    0.1
    """
    most = max((len(_with_point(text).partition(".")[2]) for text in texts if "e" not in text.lower()), default=0)
    return float(10.0 ** -min(most, 6))
