"""Changes of a scenario: a key set by its dotted name, and a picture cut to its middle."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from seaglint.base.errors import ScenarioError
from seaglint.base.free_form import TomlTables

if TYPE_CHECKING:
    from seaglint.scenario.model import Scenario


def set_key(raw: TomlTables, key: str, value: Any, name: str) -> None:
    """Set a dotted key in place.

    Parameters
    ----------
    raw : dict
        Tables as the TOML file has them.
    key : str
        ``wind.speed_m_s``; of an object by its name or its place in the list, ``objects.ferry.course_deg``, ``objects.0.course_deg``; of
        a list by the place in it, ``sensor.fov_deg.0``.
    value : object
        New value of the key.
    name : str
        Name of the tables, for messages.

    Raises
    ------
    ScenarioError
        A part of the dotted name is no table, no object of that name, or no such place in a list.

    Examples
    --------
    >>> raw = {"sensor": {"fov_deg": [16, 8]}}
    >>> set_key(raw, "sensor.fov_deg.0", 12, "my.toml"), set_key(raw, "wind.speed_m_s", 5, "my.toml")
    (None, None)
    >>> raw
    {'sensor': {'fov_deg': [12, 8]}, 'wind': {'speed_m_s': 5}}
    """
    *tables, last = key.split(".")
    place: Any = raw
    for k, step in enumerate(tables):
        place = place[_place(place, step, key, name)] if isinstance(place, list) else place.setdefault(step, {})
        if not isinstance(place, dict | list):
            raise ScenarioError(f"{name}: {'.'.join(tables[: k + 1])} is no table; the key {key} is not one of a scenario")
    if isinstance(place, list):
        if any(isinstance(item, Mapping) for item in place):
            raise ScenarioError(f"{name}: {key}: objects are named; give objects.NAME.key")
        place[_place(place, last, key, name)] = value
    else:
        place[last] = value


def _place(items: list[Any], step: str, key: str, name: str) -> int:
    """Return the index of an object in a list by its name, or of any item by its number."""
    if named := [i for i, item in enumerate(items) if isinstance(item, Mapping) and item.get("name") == step]:
        return named[0]
    if step.isdecimal() and int(step) < len(items):
        return int(step)
    if any(isinstance(item, Mapping) for item in items):
        raise ScenarioError(f"{name}: {key}: there is no object '{step}'; give a name of the scenario's [[objects]]")
    raise ScenarioError(f"{name}: {key}: there is no place {step} in a list of {len(items)}; give 0 to {len(items) - 1}")


def middle_of(scenario: Scenario, rows: int, columns: int | None = None) -> Scenario:
    """Return the scenario with the middle of its picture alone, at most so many rows and columns; pixels keep their angles."""
    sensor = scenario.sensor
    sides = list(zip(sensor.pixels, sensor.fov_deg, (columns, rows), strict=True))
    sides_and_angles = [_cut_side(side, angle, most, plane=sensor.projection == "pinhole") for side, angle, most in sides]
    if [side for side, _ in sides_and_angles] == list(sensor.pixels):
        return scenario
    parts = {"pixels": (sides_and_angles[0][0], sides_and_angles[1][0]), "fov_deg": (sides_and_angles[0][1], sides_and_angles[1][1])}
    return scenario.model_copy(update={"sensor": sensor.model_copy(update=parts)})


def _cut_side(side: int, angle: float, most: int | None, *, plane: bool) -> tuple[int, float]:
    """Pixels that stay of a side, an even number less so that its middle stays where it is, and their angle [deg]."""
    if most is None or side <= most:
        return side, angle
    # The removed pixels must be even in number, else the middle would move by half a pixel.
    fewer = most - (side - most) % 2
    share = fewer / side
    return fewer, 2.0 * math.degrees(math.atan(share * math.tan(math.radians(0.5 * angle)))) if plane else angle * share
