"""Parsers of texts on a command line: values of keys, and column maps of weather files.

Values of a key are a list or a range of numbers; column maps are ``NAME=COLUMN:UNIT``.
"""

from __future__ import annotations

import difflib
import re
import tomllib
from collections.abc import Sequence
from decimal import Decimal
from typing import Any, Final

from seaglint.base.errors import DataError, ScenarioError
from seaglint.climate.weather_columns import SHARE_UNITS, SHARES, TARGETS, UNITS, MappedColumn, west_east
from seaglint.scenario.records.quantities import convert

MOST_VALUES: Final = 100_000  #: Values of one key at most.

_NUMBER: Final = r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?"
_RANGE: Final = re.compile(rf"\s*({_NUMBER})\s*:\s*({_NUMBER})\s*:\s*({_NUMBER})\s*")

_UNFINISHED: Final = re.compile(rf"\s*{_NUMBER}\s*:\s*{_NUMBER}(?:\s*:\s*{_NUMBER})?(?:\s*[A-Za-z/%]+)?\s*")

#: How values of a key are written.
FORMS: Final = "give KEY=VALUE,VALUE,... or KEY=START:STOP:STEP with STOP included, e.g. wind.speed_m_s=2,5,10 or wind.speed_m_s=1:20:1"


def parse_vary(texts: Sequence[str], option: str = "vary") -> list[tuple[str, list[Any]]]:
    """Return keys and values of ``key=a,b,c`` and ``key=START:STOP:STEP``, STOP included.

    Raises
    ------
    DataError
        No key, no values, a key twice, or a range without an end.

    Examples
    --------
    >>> parse_vary(["wind.speed_m_s=2,5", "detector=matched,log"])
    [('wind.speed_m_s', [2, 5]), ('detector', ['matched', 'log'])]
    >>> parse_vary(["sun.zenith_deg=0:1:0.25", "band=[3.5,4.15],[8,12]"])
    [('sun.zenith_deg', [0.0, 0.25, 0.5, 0.75, 1.0]), ('band', [[3.5, 4.15], [8, 12]])]
    """
    out: list[tuple[str, list[Any]]] = []
    for text in texts:
        key, sign, values = text.partition("=")
        key = key.strip()
        if not sign or not key or not values.strip():
            raise DataError(f"{option} = {text}: {FORMS}")
        if any(key == known for known, _ in out):
            raise DataError(f"{option} = {text}: {key} is varied twice; give all its values at once")
        out.append((key, _values(values, f"{option} = {text}")))
    return out


def _values(text: str, where: str) -> list[Any]:
    """Return the values of a list or a range."""
    whole = _RANGE.fullmatch(text)
    if whole is None:
        parts = _parts(text)
        if not all(part.strip() for part in parts):
            raise DataError(f"{where}: a value is missing between two commas or at an end; {FORMS}")
        if any(_UNFINISHED.fullmatch(part) for part in parts):
            raise DataError(f"{where}: a range has three numbers without a unit, START:STOP:STEP; {FORMS}")
        return [plain_value(part) for part in parts]
    start, stop, step = (Decimal(part) for part in whole.groups())
    if step == 0 or (stop - start) * step < 0:
        raise DataError(f"{where}: steps of {step} do not lead from {start} to {stop}; {FORMS}")
    # Decimal numbers keep 0.1 steps exact, so that the end is included.
    count = int((stop - start) / step + Decimal("1e-9")) + 1
    if count > MOST_VALUES:
        raise DataError(f"{where}: has {count} values; give at most {MOST_VALUES} of one key, with a larger STEP")
    values = [start + i * step for i in range(count)]
    if all(part == part.to_integral_value() and "." not in text and "e" not in text.lower() for part in (start, step)):
        return [int(value) for value in values]
    return [float(value) for value in values]


def _parts(text: str) -> list[str]:
    """Split at commas outside brackets and quotes."""
    parts, depth, quote, part = [], 0, "", ""
    for letter in text:
        if quote:
            quote = "" if letter == quote else quote
        elif letter in "\"'":
            quote = letter
        depth += (letter in "[{") - (letter in "]}") if not quote else 0
        if letter == "," and depth == 0 and not quote:
            parts.append(part)
            part = ""
        else:
            part += letter
    return [*parts, part]


def plain_value(text: str) -> Any:
    """Return a value as a TOML file has it; text without quotes is text.

    Examples
    --------
    >>> plain_value("2"), plain_value(" 14 kn"), plain_value("[4, 2]"), plain_value("true")
    (2, '14 kn', [4, 2], True)
    """
    try:
        return tomllib.loads(f"v = {text.strip()}")["v"]
    except (tomllib.TOMLDecodeError, ValueError):
        return text.strip()


def parse_map(texts: Sequence[str]) -> tuple[MappedColumn, ...]:
    """Parse columns of texts such as ``wind_speed_m_s=ws:kn``.

    Raises
    ------
    ScenarioError
        A text of another form, an unknown name, a name twice, or a unit that is unknown or of another kind.

    Examples
    --------
    >>> parse_map(["sea_temperature_k=sst:degC"])[0].offset
    273.15
    """
    columns = [_parsed(text) for text in texts]
    names = [column.name for column in columns]
    for name in names:
        if names.count(name) > 1:
            raise ScenarioError(f"map='{name}=...' is given twice; give one column for it")
    return tuple(columns)


def _parsed(text: str) -> MappedColumn:
    name, equals, rest = text.partition("=")
    name = name.strip()
    column, _, unit = rest.rpartition(":") if ":" in rest else (rest, "", "")
    column, unit = column.strip(), unit.strip()
    if not equals or not column:
        raise ScenarioError(f"map='{text}' is not NAME=COLUMN or NAME=COLUMN:UNIT; write e.g. wind_speed_m_s=ws:kn")
    if name not in TARGETS:
        near = difflib.get_close_matches(name, TARGETS, n=1, cutoff=0.5)
        raise ScenarioError(f"map='{text}': '{name}' is not one of {', '.join(TARGETS)}{f'; did you mean {near[0]}?' if near else ''}")
    if not unit:
        return MappedColumn(name, column)
    if name in SHARES:
        if unit not in SHARE_UNITS:
            raise ScenarioError(f"map='{text}': '{unit}' is an unknown unit of a share; allowed are {', '.join(SHARE_UNITS)}")
        return MappedColumn(name, column, unit, SHARE_UNITS[unit])
    if name not in UNITS:
        raise ScenarioError(f"map='{text}': {name} has no unit; write {name}={column}")
    try:
        # Two points give factor and offset of any linear unit, Celsius included.
        zero, one = (convert(f"{value} {unit}", UNITS[name]) for value in (0, 1))
    except ValueError as error:
        raise ScenarioError(f"map='{text}': {name} {error}") from None
    return MappedColumn(name, column, unit, one - zero, zero)


def parse_fill(texts: Sequence[str]) -> dict[str, float]:
    """Parse values of texts such as ``cloud_cover=0.6``, with a unit where the column has one: ``sea_temperature_k=15 degC``.

    Raises
    ------
    ScenarioError
        A text of another form.
    """
    out = {}
    for text in texts:
        name, _, value = (part.strip() for part in text.partition("="))
        try:
            out[name] = float(value) if name not in UNITS or _plain(value) else convert(value, UNITS[name])
        except ValueError:
            raise ScenarioError(f"fill='{text}' is not NAME=VALUE with a number; write e.g. cloud_cover=0.6") from None
    return out


def _plain(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def parse_place(text: str) -> tuple[float, float]:
    """Parse latitude and longitude of a text ``44.1,-66.6`` [deg]; the longitude is in [-180, 180).

    Raises
    ------
    ScenarioError
        A text of another form, or a place that there is not.
    """
    try:
        latitude, longitude = (float(part) for part in text.split(","))
        if not (-90.0 <= latitude <= 90.0 and -360.0 <= longitude <= 360.0):
            raise ValueError
    except ValueError:
        raise ScenarioError(f"place='{text}' is not latitude,longitude in degrees; write e.g. 42.3,-69.7") from None
    return latitude, float(west_east(longitude))
