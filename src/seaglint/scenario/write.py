"""A scenario becomes the text of a TOML file that says only what differs from the defaults."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping
from datetime import datetime
from pathlib import Path
from typing import Any, Final

from pydantic import BaseModel, ValidationError

from seaglint.scenario.model import Scenario

_HEADER: Final = "# seaglint scenario: what differs from the defaults; 'seaglint init' writes every key with its comment."


def differing(scenario: Scenario) -> dict[str, Any]:
    """Tables and keys of a scenario that differ from the defaults, laid out as the TOML file.

    A key is left out where the scenario reads the same without it: defaults that follow from other keys (a field of view from the optics,
    an object's shape from its preset) are left out too.

    Examples
    --------
    >>> from seaglint.scenario.load import parse_scenario
    >>> differing(parse_scenario({"wind": {"speed_m_s": 9, "from_deg": 230}}))
    {'wind': {'speed_m_s': 9.0}}
    """
    whole: dict[str, Any] = scenario.model_dump(exclude_none=True)
    for item in whole.get("objects", ()):
        if "preset" in item:  # it brings the shape, and refuses another
            del item["shape"]

    def same() -> bool:
        try:
            return Scenario.model_validate(whole, context={"files": False}) == scenario
        except ValidationError:
            return False

    _thin(whole, same)
    return whole


def _thin(table: dict[str, Any], same: Callable[[], bool]) -> None:
    """Take out of a table every key without which the scenario is the same."""
    order = list(table)
    for key in order:
        value = table.pop(key)
        if same():
            continue
        table[key] = value
        for inner in [value] if isinstance(value, dict) else value if isinstance(value, list | tuple) else []:
            if isinstance(inner, dict):
                _thin(inner, same)
    kept = {key: table[key] for key in order if key in table}
    table.clear()
    table.update(kept)


def scenario_toml(scenario: Scenario, base: str | Path | None = None) -> str:
    """Text of a TOML file that reads as this scenario: only what differs from the defaults, in the units of the keys.

    Parameters
    ----------
    scenario : Scenario
        Any.
    base : path, optional
        Folder of the file: paths below it are written from there, others whole. Without it paths are written as they are.

    Examples
    --------
    >>> from seaglint.scenario.load import parse_scenario
    >>> print(scenario_toml(parse_scenario({"wind": {"speed_m_s": 9}})).splitlines()[-1])
    speed_m_s = 9.0
    """
    return toml_text(differing(scenario), base)


def toml_text(tables: Mapping[str, Any], base: str | Path | None = None) -> str:
    """TOML text of tables laid out as a scenario file."""
    folder = None if base is None else Path(base)
    return "\n".join([_HEADER, *_table(tables, (), folder)]) + "\n"


def _table(table: Mapping[str, Any], path: tuple[str, ...], base: Path | None) -> Iterator[str]:
    """Plain keys first, then the tables inside, as TOML wants it."""
    deeper = {key: value for key, value in table.items() if isinstance(value, Mapping)}
    lists = {key: value for key, value in table.items() if not path and _is_list_of_tables(value)}
    for key, value in table.items():
        if key not in deeper and key not in lists:
            yield _entry(key, value, base)
    for key, value in deeper.items():
        yield ""
        if any(not isinstance(inner, Mapping) for inner in value.values()) or not value:
            yield f"[{'.'.join((*path, key))}]"
            yield from _table(value, (*path, key), base)
        else:
            yield from list(_table(value, (*path, key), base))[1:]  # it holds tables alone: their headings name it
    for key, items in lists.items():
        for item in items:
            yield ""
            yield f"[[{key}]]"
            yield from (_entry(name, value, base) for name, value in item.items())


def _entry(key: str, value: Any, base: Path | None) -> str:
    if not _is_list_of_tables(value):
        return f"{key} = {toml_value(value, base)}"
    return f"{key} = [\n" + "".join(f"  {toml_value(item, base)},\n" for item in value) + "]"


def _is_list_of_tables(value: Any) -> bool:
    return isinstance(value, list | tuple) and bool(value) and all(isinstance(item, Mapping) for item in value)


def toml_value(value: Any, base: Path | None = None) -> str:
    """One value as TOML writes it; tables in one line."""
    match value:
        case bool():
            return "true" if value else "false"
        case datetime():
            return value.isoformat().replace("+00:00", "Z")
        case int() | float():
            return repr(value)
        case Path():
            return toml_value(_from(value, base))
        case Mapping():
            return "{ " + ", ".join(f"{key} = {toml_value(item, base)}" for key, item in value.items()) + " }"
        case BaseModel():
            return toml_value(value.model_dump(exclude_none=True), base)
        case list() | tuple():
            return "[" + ", ".join(toml_value(item, base) for item in value) + "]"
        case _:
            # JSON's escapes are TOML's, but for the one control character that JSON lets through.
            return json.dumps(str(value), ensure_ascii=False).replace("\x7f", "\\u007F")


def _from(path: Path, base: Path | None) -> str:
    """A path as a file in ``base`` has to name it."""
    if base is None:
        return path.as_posix()
    whole, folder = path.resolve(), base.resolve()
    return (whole.relative_to(folder) if whole.is_relative_to(folder) else whole).as_posix()
