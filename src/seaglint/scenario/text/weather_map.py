"""Parser of column maps ``NAME=COLUMN:UNIT`` for CSV files of weather."""

from __future__ import annotations

import difflib
from collections.abc import Sequence

from seaglint.base.errors import ScenarioError
from seaglint.climate.column_map import SHARE_UNITS, SHARES, TARGETS, UNITS, MappedColumn
from seaglint.climate.derived import west_east
from seaglint.scenario.records.quantity import convert


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
