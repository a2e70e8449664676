"""Readers of soundings as lists in fixed columns: University of Wyoming's text list, IGRA version 2."""

from __future__ import annotations

import re
from datetime import UTC, datetime
from pathlib import Path

import numpy as np

from seaglint.base.errors import DataError
from seaglint.files.soundings.raw_sounding import Quantity, RawSounding, with_other_humidity, without_missing
from seaglint.files.soundings.station_lists import choice_note, nearest_time

_IGRA_HEAD = re.compile(r"^#[A-Z0-9]{11} \d{4} ")
_WYOMING_TITLE = re.compile(r"\b(\d{2})Z (\d{1,2}) ([A-Z][a-z]{2}) (\d{4})\b")
_WIDTH = 7  #: Width of a column of Wyoming's list.


def is_wyoming_list(lines: list[str]) -> bool:
    """True for University of Wyoming's list: names in columns of seven under a rule."""
    return _names_line(lines) is not None


def _names_line(lines: list[str]) -> int | None:
    return next((i for i, line in enumerate(lines[:200]) if _is_names_line(line)), None)


def _is_names_line(line: str) -> bool:
    words = line.split()
    return words[:2] == ["PRES", "HGHT"] and "," not in line and "TEMP" in words


def _wyoming_time(lines: list[str]) -> datetime | None:
    """Return the time of the last title among lines, as ``... Observations at 00Z 01 Jul 2024``."""
    found = [match for line in lines for match in [_WYOMING_TITLE.search(line)] if match]
    try:
        return datetime.strptime(" ".join(found[-1].groups()), "%H %d %b %Y").replace(tzinfo=UTC) if found else None
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
    kinds: dict[str, Quantity] = {"PRES": "pressure", "HGHT": "height"}
    values = np.array(rows)
    column = {name: without_missing(values[:, i], kinds.get(name, "humidity")) for i, name in enumerate(names)}
    if "DWPT" not in column:
        raise DataError(f"{path}: columns are {', '.join(names)}; missing: DWPT")
    return RawSounding(
        "University of Wyoming's list",
        column["PRES"],
        column["HGHT"],
        column["TEMP"] + 273.15,
        "dewpoint_k",
        column["DWPT"] + 273.15,
        True,
        {"pressure": "PRES", "height": "HGHT", "temperature": "TEMP", "humidity": "DWPT"},
        choice_note("the sounding", times[chosen], len(heads) - 1, time),
        resolution=(0.1, 1.0),
    )


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
    """True for the Integrated Global Radiosonde Archive, version 2: a line that begins with ``#`` and the station."""
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
    values[np.isin(values, (-9999.0, -8888.0))] = np.nan
    kelvin = 0.1 * values[:, 2] + 273.15
    dew, humidity = kelvin - 0.1 * values[:, 4], 0.1 * values[:, 3]
    by_dew = bool(np.isfinite(dew).sum() >= np.isfinite(humidity).sum())
    raw = RawSounding(
        "IGRA version 2",
        0.01 * values[:, 0],
        values[:, 1],
        kelvin,
        "dewpoint_k" if by_dew else "relative_humidity_percent",
        dew if by_dew else humidity,
        True,
        {"pressure": "PRESS", "height": "GPH", "temperature": "TEMP", "humidity": "DPDP" if by_dew else "RH"},
        choice_note("the ascent", times[chosen], len(heads) - 1, time),
        resolution=(1.0, 1.0),
    )
    other = humidity if by_dew else dew
    return with_other_humidity(raw, "relative_humidity_percent" if by_dew else "dewpoint_k", other)


def _igra_time(head: str) -> datetime | None:
    try:
        year, month, day, hour = int(head[13:17]), int(head[18:20]), int(head[21:23]), int(head[24:26])
        return datetime(year, month, day, hour if hour < 24 else 0, tzinfo=UTC)
    except ValueError:
        return None
