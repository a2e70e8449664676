"""Readers of soundings as text.

- Tables under a line of column names: CSV of any separator, and lists in columns under lines of a header.
- Files of programs of the weather services: SHARPpy, bufkit, the Iowa mesonet's JSON, AVAPS's raw record.
- Lists in fixed columns: University of Wyoming's text list, IGRA version 2.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, Final

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError
from seaglint.formats.soundings.sounding_columns import (
    ZERO_C,
    OzoneColumn,
    Quantity,
    RawSounding,
    SoundingColumn,
    columns_of,
    is_missing_text,
    others_left,
    ozone_columns,
    plain_name,
    sounding_of,
    with_other_humidity,
    with_ozone,
    without_missing,
)
from seaglint.formats.tables.table_text import cells_of, plain_number
from seaglint.store.outputs import parsed_json

NEEDED: Final = "height_m, pressure_hpa, temperature_k (or temperature_c), relative_humidity_percent (or dewpoint_k, dewpoint_c)"

HEADER_LINES: Final = 300  #: Lines of a file in which the line of column names is searched.

MOST_SHOWN: Final = 300  #: Characters of column names that an error shows.

SAMPLE: Final = 2000  #: Rows at either end from which the rounding of a long table is estimated.

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
    is_eol = any("EOL Sounding Format" in line or "AVAPS" in line for _, line in lines[: heading.place])
    form = "AVAPS (EOL sounding format)" if is_eol else "table with a line of column names"
    # siphon's data frames of University of Wyoming's list: geopotential heights, and no unit in any name
    frame = {"pressure", "height", "temperature", "dewpoint"} <= named
    return with_ozone(sounding_of(form, columns, numbers, digits, geopotential=frame), ozone, numbers)


def _is_rule(line: str) -> bool:
    return set(line.strip()) <= set("-=+| ")


def _split(path: Path, number: int, line: str, separator: str | None) -> list[str]:
    if separator is None:
        return line.split()
    if '"' not in line:
        return [cell.strip() for cell in line.split(separator)]
    return [cell.strip() for cell in cells_of(path, number, line, separator)]


def _heading(path: Path, lines: list[tuple[int, str]]) -> _Heading:
    """Return the line that names pressure and temperature; without one the first line, for the error on its missing columns."""
    for place, (_, line) in enumerate(lines[:HEADER_LINES]):
        for separator in SEPARATORS:
            if separator is not None and separator not in line:
                continue
            heading = _as_heading(path, lines, place, separator)
            if {"pressure", "temperature"} <= {column.kind for column in columns_of(heading.names, heading.units)}:
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
        # A line of texts alone below the names holds their units.
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
    """Return names and units of columns separated by blanks, as many as the cells of a row: names may hold single blanks."""
    spaced = [name.strip() for name in re.split(r"\s{2,}|\t", line.strip()) if name.strip()]
    for candidate in (names, _TWO_WORDS.sub(r"\1_\2", line).split(), spaced):
        if len(candidate) == count:
            names = candidate
            break
    else:
        if units is not None and len(units) == count > len(names):
            # One name, as of a time in minutes and seconds, covers several columns at the left.
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
        alike = _alike(heading.names, [column.name for column in columns], missing)
        shown = ", ".join(name for name in heading.names if name)
        shown = f"{shown[:MOST_SHOWN]}..." if len(shown) > MOST_SHOWN else shown
        raise DataError(f"{path}: line {heading.number}: columns are {shown}; missing: {', '.join(missing)}{alike}")
    for known in (("temperature_k", "temperature_c"), ("relative_humidity_percent", "dewpoint_k", "dewpoint_c")):
        both = [name for name in known if name in names]
        if len(both) > 1:
            raise DataError(f"{path}: line {heading.number}: both of {both[0]}, {both[1]} are given; leave one out")


def _alike(given: list[str], used: list[str], missing: list[str]) -> str:
    """Return questions about given columns that look like missing ones."""
    begins = {
        **dict.fromkeys("hza", "height_m"),
        **{"p": "pressure_hpa", "t": "temperature_k", "d": "dewpoint_k", "r": "relative_humidity_percent"},
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
    """Return values of the columns as written, NaN where missing, and the steps that they are rounded to, by column of the file."""
    places = [column.place for column in columns]
    if heading.separator is None:
        _require_whole(path, rows, len(heading.names))
    try:
        # A table of numbers alone is read ten times as fast as cell by cell.
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
    """Refuse rows separated by blanks with more or fewer cells than names: the missing column cannot be known."""
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
    """Return the text of a number with a decimal point in place of one decimal comma."""
    return text.replace(",", ".") if text.count(",") == 1 and "." not in text else text


def _number(path: Path, line: int, name: str, text: str) -> float:
    if is_missing_text(text):
        return float("nan")
    if not _is_number(text):
        raise DataError(f"{path}: line {line}: {plain_name(name)} = '{text}' is not a number")
    return plain_number(_with_point(text))


def rounding(texts: list[str]) -> float:
    """Return the step that numbers are rounded to, from the digits after their points.

    >>> rounding(["1013.2", "1000"])
    0.1
    """
    return float(10.0 ** -min(max((len(_with_point(text).partition(".")[2]) for text in texts if "e" not in text.lower()), default=0), 6))


#: Difference from the time requested that is reported [s]: half of the time between two ascents of a day's four.
FAR_S: Final = 3.0 * 3600.0

NAMES_OF: Final[dict[str, str]] = {"pressure": "PRES", "height": "HGHT", "temperature": "TEMP", "humidity": "DWPT"}


def nearest_time(times: Sequence[datetime | None], time: datetime | None) -> int:
    """Return the index of the time nearest to a requested one; 0 without a request."""
    if time is None:
        return 0
    return int(np.argmin([abs((t - time).total_seconds()) if t is not None else np.inf for t in times]))


def choice_note(what: str, when: datetime | None, others: int, requested: datetime | None) -> tuple[str, ...]:
    """Return the note on a choice among several soundings of one file."""
    if not others:
        return ()
    shown = f" of {when:%Y-%m-%d %H:%M} UTC" if when is not None else ""
    first = "" if requested is not None else ", the first,"
    if requested is not None and when is not None and abs((when - requested).total_seconds()) >= FAR_S:
        first = f", {abs((when - requested).total_seconds()) / 3600.0:.0f} h from the time requested,"
    return (f"{what}{shown}{first} is taken, {others_left(others)}",)


def _listed_number(path: Path, line: int, text: str) -> float:
    if is_missing_text(text):
        return float("nan")
    try:
        return float(text)
    except ValueError:
        raise DataError(f"{path}: line {line}: '{text}' is not a number") from None


def is_sharppy(lines: list[str]) -> bool:
    """Return true for SHARPpy's text: levels between ``%RAW%`` and ``%END%``."""
    return any(line.strip() == "%RAW%" for line in lines[:100])


def read_sharppy(path: Path, lines: list[str], time: datetime | None) -> RawSounding:
    """Read ``LEVEL, HGHT, TEMP, DWPT, WDIR, WSPD`` in hPa, geopotential metres and Celsius; -9999 is missing.

    Raises
    ------
    DataError
        No levels, or a cell that is no number.
    """
    starts = [i for i, line in enumerate(lines) if line.strip() == "%RAW%"]
    times = [_title_time(lines[max(0, start - 12) : start]) for start in starts]
    chosen = nearest_time(times, time)
    rows, texts = [], []
    for number, line in enumerate(lines[starts[chosen] + 1 :], starts[chosen] + 2):
        if line.strip().startswith("%"):
            break
        cells = [cell.strip() for cell in line.split(",")]
        if len(cells) < 4:
            if line.strip():
                raise DataError(f"{path}: line {number}: is no level of SHARPpy's text (level, height, temperature, dew point)")
            continue
        rows.append([_listed_number(path, number, cell) for cell in cells[:4]])
        texts.append(cells)
    if not rows:
        raise DataError(f"{path}: has no levels after %RAW%; give a whole file")
    note = choice_note("the sounding", times[chosen], len(starts) - 1, time)
    columns = np.array(rows).T
    return _of_station("SHARPpy's text", columns, note, (rounding([row[0] for row in texts]), rounding([row[1] for row in texts])))


def _of_station(kind: str, columns: FloatArray, notes: tuple[str, ...], steps: tuple[float, float]) -> RawSounding:
    """Return the sounding of a station: columns of hPa, geopotential metres and two temperatures in Celsius."""
    what: tuple[Quantity, ...] = ("pressure", "height", "temperature", "humidity")
    pressure, height, kelvin, dew = (without_missing(values, name) for values, name in zip(columns, what, strict=True))
    return RawSounding(
        kind=kind, pressure=pressure, height=height, temperature=kelvin + ZERO_C, humidity="dewpoint_k", humidity_value=dew + ZERO_C,
        geopotential=True, names=dict(NAMES_OF), notes=notes, resolution=steps,
    )  # fmt: skip


def _title_time(lines: list[str]) -> datetime | None:
    match = next(filter(None, (re.search(r"\b(\d{6})/(\d{2})(\d{2})\b", line) for line in lines)), None)
    return None if match is None else _short_time(match[1], match[2], match[3])


def _short_time(day: str, hour: str, minute: str) -> datetime | None:
    try:
        year = int(day[:2])
        year += 2000 if year < 70 else 1900  # years of two digits: 70 to 99 are of the last century
        return datetime(year, int(day[2:4]), int(day[4:]), int(hour) % 24, int(minute), tzinfo=UTC)
    except ValueError:
        return None


def is_bufkit(lines: list[str]) -> bool:
    """Return true for bufkit's and GEMPAK's list: the names of its quantities after ``SNPARM =``."""
    return any(line.strip().startswith("SNPARM") for line in lines[:50])


def read_bufkit(path: Path, lines: list[str], place: tuple[float, float] | None, time: datetime | None) -> RawSounding:
    """Read one hour of a forecast: blocks of ``STID``, ``TIME`` and values in the order of ``SNPARM``; -9999 is missing.

    Of several stations the one nearest to ``place`` is taken, of several hours the one nearest to ``time``; without them the first.

    Raises
    ------
    DataError
        Names without pressure, temperature and humidity; a block of values that is cut.
    """
    heading = next(line for line in lines if line.strip().startswith("SNPARM"))
    names = [name.strip() for name in heading.partition("=")[2].split(";") if name.strip()]
    columns = columns_of(names)
    present = {column.quantity for column in columns}
    missing = [what for what in ("pressure", "temperature", "humidity") if what not in present]
    if missing:
        raise DataError(f"{path}: SNPARM names {', '.join(names)}; missing: {', '.join(missing)}")
    starts = [i for i, line in enumerate(lines) if re.match(r"\s*STID\s*=", line)]
    if not starts:
        raise DataError(f"{path}: has SNPARM and no block of a station (STID = ...); give a whole file")
    blocks = list(zip(starts, [*starts[1:], len(lines)], strict=True))
    stations = [_header_value(lines[a:b], "STID") for a, b in blocks]
    station = stations[0]
    if place is not None and len(set(stations)) > 1:
        station = stations[int(np.argmin([_distance(lines[a:b], place) for a, b in blocks]))]
    blocks = [block for block, name in zip(blocks, stations, strict=True) if name == station]
    times = [_title_time(lines[a : a + 3]) for a, _ in blocks]
    chosen = nearest_time(times, time)
    a, b = blocks[chosen]
    values, texts = _bufkit_values(path, lines, a, b, names)
    numbers = {column.place: values[:, column.place] for column in columns}
    steps = {column.place: rounding(texts[column.place :: len(names)]) for column in columns}
    note = choice_note("the hour", times[chosen], len(blocks) - 1, time)
    if len(set(stations)) > 1:
        note = (f"the station {station} is taken, {others_left(len(set(stations)) - 1)}", *note)
    raw = sounding_of("bufkit's list", columns, numbers, steps, note, geopotential=True)
    if not np.isfinite(raw.height).any():
        raw.height[0] = _listed_number(path, a + 1, _header_value(lines[a:b], "SELV"))  # the others follow from the pressures
    return raw


def _header_value(lines: list[str], key: str) -> str:
    match = next(filter(None, (re.search(rf"\b{key}\s*=\s*(\S+)", line) for line in lines[:6])), None)
    return "" if match is None else match[1]


def _distance(lines: list[str], place: tuple[float, float]) -> float:
    try:
        latitude, longitude = (float(_header_value(lines, key)) for key in ("SLAT", "SLON"))
    except ValueError:
        return float("inf")
    # In degrees of latitude: degrees of longitude are shorter by the cosine of the latitude.
    return float(np.hypot(latitude - place[0], ((longitude - place[1] + 180.0) % 360.0 - 180.0) * np.cos(np.radians(place[0]))))


def _bufkit_values(path: Path, lines: list[str], start: int, end: int, names: list[str]) -> tuple[FloatArray, list[str]]:
    """Return values of a block, (levels, names), and their texts: numbers that follow the repeated names."""
    first = next((i for i in range(start, end) if lines[i].split()[:1] == [names[0]]), None)
    if first is None:
        raise DataError(f"{path}: line {start + 1}: the block has no values under {names[0]}; give a whole file")
    texts: list[str] = []
    for number, line in enumerate(lines[first:end], first + 1):
        words = line.split()
        if words and words[0] == "STN":
            break  # values at the surface follow
        if any(re.fullmatch(r"[A-Z]\w*", word) for word in words):
            continue  # the names, over several lines
        texts += words
        for word in words:
            _listed_number(path, number, word)
    if not texts or len(texts) % len(names):
        raise DataError(f"{path}: line {first + 1}: {len(texts)} values under {len(names)} names; is the file whole?")
    return np.array([float(text) for text in texts]).reshape(-1, len(names)), texts


def is_iem_json(text: str) -> bool:
    """Return true for the JSON of the Iowa Environmental Mesonet's archive: profiles of levels."""
    return text.lstrip()[:1] == "{" and '"profiles"' in text


def read_iem_json(path: Path, text: str, time: datetime | None) -> RawSounding:
    """Read ``profiles[].profile[]`` with ``pres``, ``hght``, ``tmpc`` and ``dwpc``: hPa, geopotential metres, Celsius.

    Raises
    ------
    DataError
        No JSON, or no levels in it.
    """
    content = parsed_json(path, text, "give the answer of the archive as it came")
    profiles = [one for one in content.get("profiles") or [] if isinstance(one, dict) and one.get("profile")]
    if not profiles:
        raise DataError(f"{path}: its profiles hold no levels; give another hour of the archive")
    times = [_iso_time(str(one.get("valid", ""))) for one in profiles]
    chosen = nearest_time(times, time)
    cells = [[_json_cell(path, level, key) for key in ("pres", "hght", "tmpc", "dwpc")] for level in profiles[chosen]["profile"]]
    step_p, step_z = (rounding([repr(row[i]).removesuffix(".0") for row in cells]) for i in (0, 1))
    note = choice_note("the sounding", times[chosen], len(profiles) - 1, time)
    return _of_station("Iowa mesonet's JSON", np.array(cells).T, note, (step_p, step_z))


def _json_cell(path: Path, level: Any, key: str) -> float:
    value = level.get(key) if isinstance(level, dict) else None
    if value is None:
        return float("nan")
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise DataError(f"{path}: {key} = {value!r} is not a number")
    return float(value)


def _iso_time(text: str) -> datetime | None:
    try:
        when = datetime.fromisoformat(text)
    except ValueError:
        return None
    return when if when.tzinfo is not None else when.replace(tzinfo=UTC)


def is_avaps_record(lines: list[str]) -> bool:
    """Return true for the raw record of the AVAPS receiver: lines that begin with ``AVAPS-D``."""
    return any(line.startswith("AVAPS-D") for line in lines[:200])


def read_avaps_record(path: Path, lines: list[str]) -> RawSounding:
    """Read the samples of a drop: hPa, Celsius, relative humidity in per cent, geopotential altitude in m; 9999, 99 and 999 are missing.

    Raises
    ------
    DataError
        No samples of the sonde in it.
    """
    rows = []
    for line in lines:
        words = line.split()
        if not line.startswith("AVAPS-D") or len(words) < 14 or words[1][:1] not in ("S", "P"):
            continue  # headers, and samples of the aircraft
        try:
            rows.append([float(words[i]) for i in (5, 13, 6, 7)])
        except ValueError:
            continue
    if not rows:
        raise DataError(f"{path}: has no samples of a sonde (AVAPS-D lines of kind S or P); give the record of a drop")
    pressure, height, celsius, humidity = np.array(rows).T
    celsius[celsius == 99.0] = np.nan  # a missing temperature; 99 % of humidity is real
    return RawSounding(
        kind="AVAPS (raw record)", pressure=without_missing(pressure, "pressure"), height=without_missing(height, "height"),
        temperature=without_missing(celsius, "temperature") + ZERO_C,
        humidity="relative_humidity_percent", humidity_value=without_missing(humidity, "humidity"),
        geopotential=True, names={what: what for what in NAMES_OF}, resolution=(0.01, 0.01),
    )  # fmt: skip


_IGRA_HEAD = re.compile(r"^#[A-Z0-9]{11} \d{4} ")
_WYOMING_TITLE = re.compile(r"\b(\d{2})Z (\d{1,2}) ([A-Z][a-z]{2}) (\d{4})\b")
_WIDTH = 7  #: Width of a column of Wyoming's list.


def is_wyoming_list(lines: list[str]) -> bool:
    """Return true for University of Wyoming's list: names in columns of seven under a rule."""
    return any(_is_names_line(line) for line in lines[:200])


def _is_names_line(line: str) -> bool:
    words = line.split()
    return words[:2] == ["PRES", "HGHT"] and "," not in line and "TEMP" in words


def _wyoming_time(lines: list[str]) -> datetime | None:
    """Return the time of the last title among lines, as ``... Observations at 00Z 01 Jul 2024``."""
    titles = [match for line in lines for match in [_WYOMING_TITLE.search(line)] if match]
    try:
        return datetime.strptime(" ".join(titles[-1].groups()), "%H %d %b %Y").replace(tzinfo=UTC) if titles else None
    except ValueError:
        return None


def read_wyoming_list(path: Path, lines: list[str], time: datetime | None = None) -> RawSounding:
    """Read a list of ``PRES HGHT TEMP DWPT ...`` in hPa, geopotential metres and Celsius, as the web page or a saved copy has it.

    Of several lists, as the page gives for several days, the one nearest to ``time`` is read, without it the first.

    Raises
    ------
    DataError
        No rows under the names.
    """
    heads = [i for i, line in enumerate(lines) if _is_names_line(line)]
    times = [_wyoming_time(lines[before:head]) for before, head in zip([0, *heads], heads, strict=False)]
    chosen = nearest_time(times, time)
    head = heads[chosen]
    lines = lines[: heads[chosen + 1] if chosen + 1 < len(heads) else len(lines)]
    names = lines[head].split()
    # Only a list whose names still fill columns of seven is cut at fixed places.
    fixed = len(lines[head].rstrip()) % _WIDTH in (0, _WIDTH - 1) and lines[head].rstrip()[: _WIDTH * 2].split() == names[:2]
    rows: list[list[float]] = []
    for line in lines[head + 1 :]:
        text = line.rstrip()
        if not text.strip() or set(text.strip()) <= {"-"}:
            if rows and not text.strip():
                break
            continue
        row = _wyoming_row(text, len(names), fixed)
        if row is None:
            if rows:
                break  # station information follows
            continue
        rows.append(row)
    if not rows:
        raise DataError(f"{path}: has the names of University of Wyoming's list and no rows under them")
    if "DWPT" not in names:
        raise DataError(f"{path}: columns are {', '.join(names)}; missing: DWPT")
    columns = np.array(rows)[:, [names.index(name) for name in NAMES_OF.values()]].T
    note = choice_note("the sounding", times[chosen], len(heads) - 1, time)
    return _of_station("University of Wyoming's list", columns, note, (0.1, 1.0))


def _wyoming_row(text: str, count: int, fixed: bool) -> list[float] | None:
    words = text.split()
    if len(words) == count:
        parts = words
    elif fixed:
        parts = [text[i * _WIDTH : (i + 1) * _WIDTH].strip() for i in range(count)]
    else:
        parts = words + [""] * (count - len(words))
    try:
        return [float(part) if part else float("nan") for part in parts[:count]]
    except ValueError:
        return None


def is_igra(lines: list[str]) -> bool:
    """Return true for the Integrated Global Radiosonde Archive, version 2: a line that begins with ``#`` and the station."""
    return bool(lines) and bool(_IGRA_HEAD.match(lines[0]))


def read_igra(path: Path, lines: list[str], time: datetime | None = None) -> RawSounding:
    """Read an ascent of an IGRA file: the one nearest to ``time``, without it the first; others are counted.

    Columns of a level (IGRA's readme): 10-15 pressure [Pa], 17-21 geopotential height [m], 23-27 temperature [0.1 C], 29-33 relative
    humidity [0.1 %], 35-39 dew point depression [0.1 C]; letters behind are flags, -9999 missing, -8888 removed.

    Raises
    ------
    DataError
        No levels, or a level that is no row of the format.
    """
    heads = [i for i, line in enumerate(lines) if line.startswith("#")]
    times = [_igra_time(lines[i]) for i in heads]
    chosen = nearest_time(times, time)
    first = heads[chosen] + 1
    last = heads[chosen + 1] if chosen + 1 < len(heads) else len(lines)
    rows = []
    for number, line in enumerate(lines[first:last], first + 1):
        if not line.strip():
            continue
        try:
            rows.append([float(line[a:b]) for a, b in ((9, 15), (16, 21), (22, 27), (28, 33), (34, 39))])
        except ValueError:
            raise DataError(f"{path}: line {number}: is no level of IGRA version 2") from None
    if not rows:
        raise DataError(f"{path}: line {first}: the ascent has no levels")
    values = np.array(rows)
    # Before scaling: the codes are in the units of the file.
    values[np.isin(values, (-9999.0, -8888.0))] = np.nan
    kelvin = 0.1 * values[:, 2] + ZERO_C
    dew, humidity = kelvin - 0.1 * values[:, 4], 0.1 * values[:, 3]
    # The quantity with more values is the main one; the other one fills its gaps.
    by_dew = bool(np.isfinite(dew).sum() >= np.isfinite(humidity).sum())
    raw = RawSounding(
        kind="IGRA version 2", pressure=0.01 * values[:, 0], height=values[:, 1], temperature=kelvin,
        humidity="dewpoint_k" if by_dew else "relative_humidity_percent", humidity_value=dew if by_dew else humidity, geopotential=True,
        names={"pressure": "PRESS", "height": "GPH", "temperature": "TEMP", "humidity": "DPDP" if by_dew else "RH"},
        notes=choice_note("the ascent", times[chosen], len(heads) - 1, time), resolution=(1.0, 1.0),
    )  # fmt: skip
    return with_other_humidity(raw, "relative_humidity_percent" if by_dew else "dewpoint_k", humidity if by_dew else dew)


def _igra_time(head: str) -> datetime | None:
    try:
        year, month, day, hour = int(head[13:17]), int(head[18:20]), int(head[21:23]), int(head[24:26])
        return datetime(year, month, day, hour if hour < 24 else 0, tzinfo=UTC)
    except ValueError:
        return None
