"""Keys of a scenario that a sweep varies: their values, and the coordinates that name them."""

from __future__ import annotations

import copy
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from seaglint.base.errors import DataError, ScenarioError
from seaglint.base.free_form import TomlTables
from seaglint.scenario.keys import Key, named_key
from seaglint.scenario.load import parse_scenario
from seaglint.scenario.records.quantity import convert
from seaglint.scenario.setting import set_key

NAME: Final = "sweep"  #: Name of the scenario in messages about a single key.

_BAND: Final = re.compile(r"\s*(\d+\.?\d*|\.\d+)\s*-\s*(\d+\.?\d*|\.\d+)\s*")


@dataclass(frozen=True, eq=False)
class SweptKey:
    """One key with all its values. Make it with :func:`swept_key`."""

    name: str  #: Dotted name, which is that of the dimension.
    values: tuple[Any, ...]  #: Values as a scenario file has them.
    coordinate: NDArray[Any]  #: Numbers in the unit of the key, dates, or texts [(values,)].
    attributes: dict[str, str]  #: ``units`` and ``long_name`` of the coordinate.

    def said(self, place: int) -> str:
        """Return the assignment of one value, for messages."""
        value = self.coordinate[place]
        text = np.datetime_as_string(value, unit="s") if isinstance(value, np.datetime64) else f"{value:g}" if _is_number(value) else value
        return f"{self.name} = {text}"


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float | np.integer | np.floating)


def swept_keys(base: TomlTables, vary: Mapping[str, Any], folder: Path | None) -> tuple[SweptKey, ...]:
    """Return the keys of a sweep.

    Parameters
    ----------
    base : dict
        Tables of the scenario.
    vary : mapping
        Values by dotted key.
    folder : Path, optional
        Folder from which relative paths count.

    Raises
    ------
    DataError
        No key, a key without values or with one twice, or a key inside another one.
    ScenarioError
        A key that does not exist, or units of another kind.
    """
    if not vary:
        raise DataError("vary has no key; give values of at least one key of the scenario, such as wind.speed_m_s")
    for inner in vary:
        for outer in vary:
            if inner.startswith(f"{outer}."):
                raise DataError(f"vary: {inner} is a part of {outer}, which is varied too; put its values into the tables of {outer}")
    return tuple(swept_key(base, name, values, folder) for name, values in vary.items())


def swept_key(base: TomlTables, name: str, given: Any, folder: Path | None) -> SweptKey:
    """Return one key with its values; see :func:`swept_keys`.

    Examples
    --------
    >>> key = swept_key({}, "wind.speed_m_s", [5, "36 km/h"], None)
    >>> key.coordinate.tolist(), key.attributes["units"]
    ([5.0, 10.0], 'm s-1')
    """
    given = plain_values(given)
    if isinstance(given, str | Mapping) or not isinstance(given, Sequence | np.ndarray):
        said = " ".join(repr(given).split())[:80]
        raise DataError(f"vary: {name} = {said} is no list; give all values of the key in a list, such as [2, 5, 10]")
    values = tuple(value.item() if isinstance(value, np.generic) else value for value in given)
    if not values:
        raise DataError(f"vary: {name} has no values; give at least one")
    key = named_key(name)
    if key is None:
        _refuse_unknown(base, name, values[0], folder)
    if name == "band":
        values = tuple(_band_table(value) for value in values)
    coordinate = _coordinate(name, key, values)
    _, first, counts = np.unique(coordinate, return_index=True, return_counts=True)
    if (counts > 1).any():
        said = SweptKey(name, values, coordinate, {}).said(int(first[counts > 1][0]))
        raise DataError(f"vary: {said} is given twice; give each value of a key once")
    return SweptKey(name, values, coordinate, _attributes(key, coordinate))


def plain_values(given: Any) -> Any:
    """Return the values of an array of pandas or xarray as a list, in its ``units`` where it states some; others stay as they are."""
    if isinstance(given, str | Mapping | Sequence) or not hasattr(given, "__array__"):
        return given
    values = np.atleast_1d(np.asarray(given)).tolist()
    unit = str(getattr(given, "attrs", {}).get("units", "")) if not isinstance(given, np.ndarray) else ""
    unit = {"degree": "deg", "degrees": "deg", "1": ""}.get(unit, unit)
    return [f"{value!r} {unit}" if unit and isinstance(value, int | float) else value for value in values]


def _refuse_unknown(base: TomlTables, name: str, value: Any, folder: Path | None) -> None:
    """Raise the error of a key that does not exist, which names the nearest one."""
    tables = copy.deepcopy(base)
    set_key(tables, name, value, NAME)
    parse_scenario(tables, name=NAME, base=folder)
    raise ScenarioError(f"{NAME}: {name} is not a key of a scenario; 'seaglint init' writes all of them")


def _band_table(value: Any) -> Any:
    """Return a band as its table: from a pair of wavelengths [um] or from ``3.5-4.15``."""
    if isinstance(value, str) and (edges := _BAND.fullmatch(value)):
        return {"min_um": float(edges[1]), "max_um": float(edges[2])}
    if isinstance(value, list | tuple) and len(value) == 2:
        return {"min_um": value[0], "max_um": value[1]}
    return value


def _coordinate(name: str, key: Key | None, values: tuple[Any, ...]) -> NDArray[Any]:
    """Return the values as numbers in the key's unit, as dates, or as texts."""
    quantity = next(iter(key.quantities), None) if key is not None else None
    if quantity is not None and not any(isinstance(value, list | tuple | Mapping) for value in values):
        numbers = [_number(name, value, quantity.unit) for value in values]
        return np.array(numbers, dtype=np.int64 if quantity.integer and all(isinstance(n, int) for n in numbers) else np.float64)
    if (key is not None and key.info.annotation is datetime) or any(isinstance(value, datetime) for value in values):
        try:
            return np.array([_utc(value) for value in values], dtype="datetime64[ns]")
        except (TypeError, ValueError):
            pass  # the scenario says what is wrong with it
    return np.array([label(name, value) for value in values], dtype=np.str_)


def _number(name: str, value: Any, unit: str) -> float | int:
    """Return a value as a number in a unit; whether it is allowed is the scenario's to say."""
    if isinstance(value, str) and unit:
        try:
            return convert(value, unit)
        except ValueError as error:
            raise ScenarioError(f"vary: {name} = '{value}' {error}") from None
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise ScenarioError(f"vary: {name} = {value!r} is not a number{' in ' + unit if unit else ''}; give numbers or text with a unit")
    return value


def _utc(value: Any) -> np.datetime64:
    moment = value if isinstance(value, datetime) else datetime.fromisoformat(value)
    return np.datetime64(moment if moment.tzinfo is None else moment.astimezone(UTC).replace(tzinfo=None), "ns")


def label(name: str, value: Any) -> str:
    """Return the text that stands for a value which is no number.

    >>> label("band", {"min_um": 3.5, "max_um": 4.15}), label("sea.slopes", {"kind": "flat"}), label("sea.resolve_waves", True)
    ('3.5-4.15', 'kind = flat', 'true')
    """
    match value:
        case bool():
            return "true" if value else "false"
        case Mapping() if name == "band" and set(value) == {"min_um", "max_um"}:
            return (
                f"{value['min_um']:g}-{value['max_um']:g}" if all(map(_is_number, value.values())) else "-".join(map(str, value.values()))
            )
        case Mapping():
            return ", ".join(f"{key} = {label('', inner)}" for key, inner in value.items())
        case list() | tuple():
            return f"[{', '.join(label('', inner) for inner in value)}]"
        case float():
            return f"{value:g}"
        case _:
            return str(value)


#: Units of keys as UDUNITS writes them, where it writes them otherwise.
_UDUNITS: Final = {"m/s": "m s-1", "deg": "degree", "1/km": "km-1", "%": "percent", "": "1"}


def _attributes(key: Key | None, coordinate: NDArray[Any]) -> dict[str, str]:
    out: dict[str, str] = {}
    if key is not None and key.info.description:
        out["long_name"] = key.info.description
    if key is not None and key.quantities and coordinate.dtype.kind in "if":
        unit = key.quantities[0].unit
        out["units"] = _UDUNITS.get(unit, unit)
    return out
