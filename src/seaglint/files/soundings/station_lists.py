"""Readers of soundings as programs of the weather services write them: SHARPpy, bufkit, the Iowa mesonet's JSON, AVAPS's raw record."""

from __future__ import annotations

import re
from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, Final

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError
from seaglint.files.soundings.raw_sounding import Quantity, RawSounding, is_missing_text, others_left, without_missing
from seaglint.files.soundings.sounding_columns import columns_of, sounding_of
from seaglint.files.soundings.sounding_table import rounding
from seaglint.files.text_file import parsed_json

#: Difference from the time requested that is reported [s]: half of the time between two ascents of a day's four.
FAR_S: Final = 3.0 * 3600.0

NAMES_OF: Final[dict[str, str]] = {"pressure": "PRES", "height": "HGHT", "temperature": "TEMP", "humidity": "DWPT"}


def nearest_time(times: Sequence[datetime | None], time: datetime | None) -> int:
    """Return the place of the time nearest to a requested one; without it the first."""
    if time is None:
        return 0
    gaps = [abs((t - time).total_seconds()) if t is not None else np.inf for t in times]
    return int(np.argmin(gaps))


def choice_note(what: str, when: datetime | None, others: int, requested: datetime | None) -> tuple[str, ...]:
    """Return the note on a choice among several soundings of one file."""
    if not others:
        return ()
    shown = f" of {when:%Y-%m-%d %H:%M} UTC" if when is not None else ""
    first = "" if requested is not None else ", the first,"
    if requested is not None and when is not None and abs((when - requested).total_seconds()) >= FAR_S:
        first = f", {abs((when - requested).total_seconds()) / 3600.0:.0f} h from the time requested,"
    return (f"{what}{shown}{first} is taken, {others_left(others)}",)


def _number(path: Path, line: int, text: str) -> float:
    if is_missing_text(text):
        return float("nan")
    try:
        return float(text)
    except ValueError:
        raise DataError(f"{path}: line {line}: '{text}' is not a number") from None


def is_sharppy(lines: list[str]) -> bool:
    """True for SHARPpy's text: levels between ``%RAW%`` and ``%END%``."""
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
        rows.append([_number(path, number, cell) for cell in cells[:4]])
        texts.append(cells)
    if not rows:
        raise DataError(f"{path}: has no levels after %RAW%; give a whole file")
    note = choice_note("the sounding", times[chosen], len(starts) - 1, time)
    columns = np.array(rows).T
    steps = (rounding([row[0] for row in texts]), rounding([row[1] for row in texts]))
    return _of_station("SHARPpy's text", columns, note, steps)


def _of_station(kind: str, columns: FloatArray, notes: tuple[str, ...], steps: tuple[float, float]) -> RawSounding:
    """Rows of hPa, geopotential metres and two temperatures in Celsius."""
    what: tuple[Quantity, ...] = ("pressure", "height", "temperature", "humidity")
    pressure, height, kelvin, dew = (without_missing(values, name) for values, name in zip(columns, what, strict=True))
    return RawSounding(
        kind, pressure, height, kelvin + 273.15, "dewpoint_k", dew + 273.15, True, dict(NAMES_OF), notes, resolution=steps
    )  # fmt: skip


def _title_time(lines: list[str]) -> datetime | None:
    for line in lines:
        match = re.search(r"\b(\d{6})/(\d{2})(\d{2})\b", line)
        if match:
            return _short_time(match[1], match[2], match[3])
    return None


def _short_time(day: str, hour: str, minute: str) -> datetime | None:
    try:
        year = int(day[:2])
        return datetime(
            (2000 if year < 70 else 1900) + year, int(day[2:4]), int(day[4:]), int(hour) % 24, int(minute), tzinfo=UTC
        )  # fmt: skip
    except ValueError:
        return None


def is_bufkit(lines: list[str]) -> bool:
    """True for bufkit's and GEMPAK's list: the names of its quantities after ``SNPARM =``."""
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
        raw.height[0] = _number(path, a + 1, _header_value(lines[a:b], "SELV"))  # the others follow from the pressures
    return raw


def _header_value(lines: list[str], key: str) -> str:
    for line in lines[:6]:
        match = re.search(rf"\b{key}\s*=\s*(\S+)", line)
        if match:
            return match[1]
    return ""


def _distance(lines: list[str], place: tuple[float, float]) -> float:
    try:
        latitude, longitude = (float(_header_value(lines, key)) for key in ("SLAT", "SLON"))
    except ValueError:
        return float("inf")
    east = (longitude - place[1] + 180.0) % 360.0 - 180.0
    return float(np.hypot(latitude - place[0], east * np.cos(np.radians(place[0]))))


def _bufkit_values(path: Path, lines: list[str], start: int, end: int, names: list[str]) -> tuple[FloatArray, list[str]]:
    """Values of a block, (levels, names), and their texts: numbers that follow the repeated names."""
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
            _number(path, number, word)
    if not texts or len(texts) % len(names):
        raise DataError(f"{path}: line {first + 1}: {len(texts)} values under {len(names)} names; is the file whole?")
    return np.array([float(text) for text in texts]).reshape(-1, len(names)), texts


def is_iem_json(text: str) -> bool:
    """True for the JSON of the Iowa Environmental Mesonet's archive: profiles of levels."""
    return text.lstrip()[:1] == "{" and '"profiles"' in text


def read_iem_json(path: Path, text: str, time: datetime | None) -> RawSounding:
    """Read ``profiles[].profile[]`` with ``pres``, ``hght``, ``tmpc`` and ``dwpc``: hPa, geopotential metres, Celsius.

    Raises
    ------
    DataError
        No JSON, or no levels in it.
    """
    held = parsed_json(path, text, "give the answer of the archive as it came")
    profiles = [one for one in held.get("profiles") or [] if isinstance(one, dict) and one.get("profile")]
    if not profiles:
        raise DataError(f"{path}: its profiles hold no levels; give another hour of the archive")
    times = [_iso_time(str(one.get("valid", ""))) for one in profiles]
    chosen = nearest_time(times, time)
    levels = profiles[chosen]["profile"]
    cells = [[_json_cell(path, level, key) for key in ("pres", "hght", "tmpc", "dwpc")] for level in levels]
    steps = (rounding([repr(row[0]).removesuffix(".0") for row in cells]), rounding([repr(row[1]).removesuffix(".0") for row in cells]))
    return _of_station("Iowa mesonet's JSON", np.array(cells).T, choice_note("the sounding", times[chosen], len(profiles) - 1, time), steps)


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
    """True for the raw record of the AVAPS receiver: lines that begin with ``AVAPS-D``."""
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
    celsius[celsius == 99.0] = np.nan
    return RawSounding(
        "AVAPS (raw record)",
        without_missing(pressure, "pressure"),
        without_missing(height, "height"),
        without_missing(celsius, "temperature") + 273.15,
        "relative_humidity_percent",
        without_missing(humidity, "humidity"),
        True,
        {what: what for what in NAMES_OF},
        resolution=(0.01, 0.01),
    )
