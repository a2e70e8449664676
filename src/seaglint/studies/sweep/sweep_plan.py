"""Plan of a sweep: the varied keys with their values and coordinates, the cases, and the view angles.

A case is the scenario with its keys set to one combination of their values.
"""

from __future__ import annotations

import copy
import math
import re
import tomllib
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from seaglint.base.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError, ScenarioError
from seaglint.base.free_form import TomlTables
from seaglint.facet.sea_view import sea_arc
from seaglint.scenario.changed_scenario import set_key
from seaglint.scenario.keys import Key, named_key
from seaglint.scenario.load import load_scenario, parse_scenario
from seaglint.scenario.model import Scenario
from seaglint.scenario.records.quantities import convert
from seaglint.scenario.text.toml_writing import differing

NAME: Final = "sweep"  #: Name of the scenario in messages about a single key.

MOST_CHECKED: Final = 5000  #: Number of values of all keys up to which they are checked beforehand: a second for each thousand.

ZENITH: Final = "view_zenith_deg"
AZIMUTH: Final = "view_azimuth_deg"

#: Attributes of the coordinates.
ATTRIBUTES: Final = {
    ZENITH: {"units": "degree", "long_name": "zenith angle, at the sea, of the direction to the sensor; 0 is straight down"},
    AZIMUTH: {"units": "degree", "long_name": "azimuth of the line of sight at the sensor, clockwise from north"},
}

_BAND: Final = re.compile(r"\s*(\d+\.?\d*|\.\d+)\s*-\s*(\d+\.?\d*|\.\d+)\s*")

#: Units of keys as UDUNITS writes them, where it writes them otherwise.
_UDUNITS: Final = {"m/s": "m s-1", "deg": "degree", "1/km": "km-1", "%": "percent", "": "1"}

#: Keys that most of the preparation depends on, in the order in which cases change them, the slowest first.
_OF_THE_AIR: Final = ("band", "atmosphere", "place", "time", "wind.speed_m_s", "wind", "sensor.height_m", "sea.temperature_k")

_RANGES: Final = {ZENITH: (0.0, 90.0), AZIMUTH: (-360.0, 360.0)}


@dataclass(frozen=True, eq=False)
class SweptKey:
    """One key with all its values. Make it with ``swept_key``."""

    name: str  #: Dotted name, which is that of the dimension.
    values: tuple[Any, ...]  #: Values as a scenario file has them.
    coordinate: NDArray[Any]  #: Numbers in the unit of the key, dates, or texts [(values,)].
    attributes: dict[str, str]  #: ``units`` and ``long_name`` of the coordinate.

    def assignment(self, place: int) -> str:
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
    """Return one key with its values; see ``swept_keys``.

    Examples
    --------
    >>> key = swept_key({}, "wind.speed_m_s", [5, "36 km/h"], None)
    >>> key.coordinate.tolist(), key.attributes["units"]
    ([5.0, 10.0], 'm s-1')
    """
    given = plain_values(given)
    if isinstance(given, str | Mapping) or not isinstance(given, Sequence | np.ndarray):
        shown = " ".join(repr(given).split())[:80]
        raise DataError(f"vary: {name} = {shown} is no list; give all values of the key in a list, such as [2, 5, 10]")
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
        repeated = SweptKey(name, values, coordinate, {}).assignment(int(first[counts > 1][0]))
        raise DataError(f"vary: {repeated} is given twice; give each value of a key once")
    return SweptKey(name, values, coordinate, _attributes(key, coordinate))


def plain_values(given: Any) -> Any:
    """Return the values of an array of pandas or xarray as a list, with its ``units`` if it states them; other values are unchanged."""
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
        with suppress(TypeError, ValueError):  # the scenario reports the mistake
            return np.array([_utc(value) for value in values], dtype="datetime64[ns]")
    return np.array([label(name, value) for value in values], dtype=np.str_)


def _number(name: str, value: Any, unit: str) -> float | int:
    """Return a value as a number in a unit; the scenario checks its range."""
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
    """Return the text of a value that is no number.

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


def _attributes(key: Key | None, coordinate: NDArray[Any]) -> dict[str, str]:
    out: dict[str, str] = {}
    if key is not None and key.info.description:
        out["long_name"] = key.info.description
    if key is not None and key.quantities and coordinate.dtype.kind in "if":
        unit = key.quantities[0].unit
        out["units"] = _UDUNITS.get(unit, unit)
    return out


@dataclass(frozen=True, eq=False)
class SweepPlan:
    """Scenario and swept keys of a sweep. Make it with ``of``."""

    base: TomlTables  #: Tables of the scenario.
    folder: Path | None  #: Folder from which relative paths count.
    keys: tuple[SweptKey, ...]  #: Swept keys, in the order of the dimensions.

    @classmethod
    def of(cls, source: Scenario | str | Path | Mapping[str, Any], vary: Mapping[str, Any]) -> SweepPlan:
        """Return the plan of a sweep over a scenario, its file, or its tables.

        Raises
        ------
        ScenarioError
            A scenario with mistakes, or a key that does not exist.
        DataError
            Values that are no values of a key.
        """
        base, folder = _tables(source)
        plan = cls(base, folder, swept_keys(base, vary, folder))
        plan.require_base(source)
        return plan

    def require_base(self, source: Scenario | str | Path | Mapping[str, Any]) -> None:
        """Refuse a scenario with mistakes, as its file has them; a key that is varied may be missing in it.

        Raises
        ------
        ScenarioError
            Every mistake.
        """
        try:
            if isinstance(source, str | Path):
                load_scenario(Path(source))
            else:
                parse_scenario(self.base, base=self.folder)
        except ScenarioError as error:
            try:
                self.scenario(0)
            except ScenarioError:
                raise error from None

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of values of each key."""
        return tuple(len(key.values) for key in self.keys)

    @property
    def count(self) -> int:
        """Number of cases."""
        return math.prod(self.shape)

    def order(self) -> list[int]:
        """Return the numbers of all cases, in an order in which neighbours share most of their preparation."""
        # Keys of the air vary slowest, because air takes most of the preparation.
        ranks = [_rank(key.name) for key in self.keys]
        axes = sorted(range(len(self.keys)), key=lambda axis: (ranks[axis], axis))
        return [int(number) for number in np.arange(self.count).reshape(self.shape).transpose(axes).ravel()]

    def together(self) -> int:
        """Return the number of neighbours in ``order`` that differ in nothing that most of the preparation depends on."""
        return math.prod(size for key, size in zip(self.keys, self.shape, strict=True) if _rank(key.name) == len(_OF_THE_AIR))

    def places(self, number: int) -> tuple[int, ...]:
        """Return the place of a case along each dimension."""
        return tuple(int(place) for place in np.unravel_index(number, self.shape))

    def named(self, number: int) -> str:
        """Return the assignments of a case, for messages."""
        return ", ".join(key.assignment(place) for key, place in zip(self.keys, self.places(number), strict=True))

    def scenario(self, number: int) -> Scenario:
        """Return the scenario of a case.

        Raises
        ------
        ScenarioError
            Naming the case.
        """
        tables, name = copy.deepcopy(self.base), f"sweep, {self.named(number)}"
        for key, place in zip(self.keys, self.places(number), strict=True):
            set_key(tables, key.name, copy.deepcopy(key.values[place]), name)
        try:
            return parse_scenario(tables, name=name, base=self.folder)
        except ScenarioError as error:
            raise ScenarioError(str(error).splitlines()[0], mistakes=error.mistakes[:1]) from None

    def check(self) -> None:
        """Refuse values that no scenario may have before anything is computed: each value of a key with the first values of the others.

        Raises
        ------
        ScenarioError
            Naming the case.
        """
        # Steps in the case number from one value of a key to the next, as in a row-major array.
        place = np.cumprod([1, *self.shape[:0:-1]])[::-1]
        if sum(self.shape) <= MOST_CHECKED:
            for size, step in zip(self.shape, place, strict=True):
                for value in range(size):
                    self.scenario(value * int(step))

    def base_scenario(self) -> Scenario:
        """Return the scenario without changes; its first case if the scenario needs a varied key."""
        try:
            return parse_scenario(self.base, base=self.folder)
        except ScenarioError:
            return self.scenario(0)


def _rank(name: str) -> int:
    return next((i for i, prefix in enumerate(_OF_THE_AIR) if name == prefix or name.startswith(f"{prefix}.")), len(_OF_THE_AIR))


def _tables(source: Scenario | str | Path | Mapping[str, Any]) -> tuple[TomlTables, Path | None]:
    """Return the tables of a scenario as its file has them, and the folder that paths count from."""
    if isinstance(source, Scenario):
        return differing(source), None
    if isinstance(source, Mapping):
        return copy.deepcopy(dict(source)), None
    path = Path(source)
    try:
        return tomllib.loads(path.read_bytes().decode("utf-8-sig")), path.parent.absolute()
    except (OSError, ValueError, RecursionError):
        load_scenario(path)  # raises with the mistake
        raise


def chunks(order: Sequence[int], together: int, workers: int) -> list[tuple[int, ...]]:
    """Split cases into units of work: neighbours that share their preparation stay together while there is enough for all workers.

    >>> chunks(range(6), 3, 1)
    [(0, 1, 2), (3, 4, 5)]
    >>> chunks(range(6), 6, 2)
    [(0,), (1,), (2,), (3,), (4,), (5,)]
    """
    # At least two units for each worker, so that none waits long for the last one.
    size = max(min(together, len(order) // (2 * workers)), 1) if workers > 1 else max(together, 1)
    return [tuple(order[first : first + size]) for first in range(0, len(order), size)]


@dataclass(frozen=True)
class ViewAngles:
    """Angles of lines of sight to the sea. Make them with ``of``."""

    zenith_deg: tuple[float, ...]  #: Zenith angles, at the sea, of the direction to the sensor [deg].
    #: Azimuths of the lines of sight, clockwise from north [deg]; None is the sensor's azimuth.
    azimuth_deg: tuple[float, ...] | None = None

    @classmethod
    def of(cls, given: Mapping[str, Any] | ViewAngles | None) -> ViewAngles | None:
        """Return the angles of a mapping; None without one.

        Raises
        ------
        DataError
            Unknown names, no zenith angles, or angles outside 0 to 90 deg and -360 to 360 deg.

        Examples
        --------
        >>> ViewAngles.of({"view_zenith_deg": [0, "0.5 rad"]}).zenith_deg[0]
        0.0
        """
        if given is None or isinstance(given, ViewAngles):
            return given
        if unknown := sorted(set(given) - {ZENITH, AZIMUTH}):
            raise DataError(f"at: {unknown[0]} is unknown; give {ZENITH} and {AZIMUTH}")
        if ZENITH not in given:
            raise DataError(f"at: {ZENITH} is missing; give zenith angles at the sea, 0 to below 90 deg")
        return cls(_angles(ZENITH, given[ZENITH]), _angles(AZIMUTH, given[AZIMUTH]) if AZIMUTH in given else None)

    @property
    def dims(self) -> tuple[str, ...]:
        """Names of the dimensions."""
        return (ZENITH,) if self.azimuth_deg is None else (ZENITH, AZIMUTH)

    def elevations(self, height: float) -> FloatArray:
        """Return elevations of the lines of sight at a sensor's height [m] [rad, (zeniths,)]."""
        # The zenith angle at the sea and the arc to it give the elevation at the sensor over the effective Earth.
        gamma = 0.5 * np.pi - np.radians(np.array(self.zenith_deg))
        return np.asarray(-(gamma + sea_arc(height, gamma) / EFFECTIVE_EARTH_RADIUS))


def _angles(name: str, given: Any) -> tuple[float, ...]:
    given = plain_values(given)
    values = list(given) if isinstance(given, Sequence | np.ndarray) and not isinstance(given, str) else [given]
    low, high = _RANGES[name]
    out: list[float] = []
    for value in values:
        try:
            angle = convert(value, "deg") if isinstance(value, str) else float(value)
        except (TypeError, ValueError) as error:
            text = f" {error}" if isinstance(value, str) else "; give numbers"
            raise DataError(f"at: {name} = {value!r}{text}") from None
        if not (low <= angle <= high) or (name == ZENITH and angle == high):
            allowed = "0 to below 90 deg; lines of sight from 90 deg on do not meet the sea" if name == ZENITH else "-360 to 360 deg"
            raise DataError(f"at: {name} = {angle:g} is outside the allowed range: {allowed}")
        if angle in out:
            raise DataError(f"at: {name} = {angle:g} is given twice; give each angle once")
        out.append(angle)
    if not out:
        raise DataError(f"at: {name} has no values; give at least one")
    return tuple(out)
