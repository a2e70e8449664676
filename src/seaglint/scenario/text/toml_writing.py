"""Writer of TOML text: of plain values and tables, and of a scenario's differences from the defaults."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterator, Mapping
from datetime import date, datetime, time
from pathlib import Path
from typing import Any, Final

from pydantic import BaseModel, ValidationError

from seaglint.base.free_form import TomlTables
from seaglint.scenario.model import Scenario

_BARE: Final = re.compile(r"[A-Za-z0-9_-]+")


def inline(value: Any) -> str:
    """Return a value as TOML text for the right-hand side of an equals sign.

    Examples
    --------
    >>> inline({"kind": "box", "size_m": (1.0, 2.0, 3.0)})
    '{ kind = "box", size_m = [1.0, 2.0, 3.0] }'
    """
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, datetime):
        return value.isoformat().replace("+00:00", "Z")
    if isinstance(value, date | time):
        return value.isoformat()
    if isinstance(value, int | float):
        return repr(value)
    if isinstance(value, tuple | list):
        return "[" + ", ".join(inline(item) for item in value) + "]"
    if isinstance(value, BaseModel):
        value = {name: item for name, item in value if item is not None}
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{_key(name)} = {inline(item)}" for name, item in value.items()) + " }" if value else "{}"
    return _quoted(str(value))


def document(tables: Mapping[str, Any], comment: str = "") -> str:
    """Return a whole file: plain keys first, then tables; top-level lists of tables get headings, nested ones a line each.

    Examples
    --------
    >>> print(document({"wind": {"speed_m_s": 5.0}, "seed": 1, "objects": [{"name": "ferry"}]}), end="")
    seed = 1
    <BLANKLINE>
    [wind]
    speed_m_s = 5.0
    <BLANKLINE>
    [[objects]]
    name = "ferry"
    """
    notes = [f"# {line}" if line else "" for line in comment.splitlines()]
    return "\n".join([*notes, *_lines(tables, ())]).lstrip("\n") + "\n"


def _lines(table: Mapping[str, Any], above: tuple[str, ...]) -> Iterator[str]:
    inner = {name: value for name, value in table.items() if isinstance(value, Mapping) or (not above and _tables(value))}
    for name, value in table.items():
        if name not in inner:
            yield _entry(name, value)
    for name, value in inner.items():
        path = (*above, name)
        heading = ".".join(map(_key, path))
        if isinstance(value, Mapping):
            if not value or any(not isinstance(inner_value, Mapping) for inner_value in value.values()):
                yield from ("", f"[{heading}]")  # else the headings of its tables name it
            yield from _lines(value, path)
            continue
        for item in value:
            yield from ("", f"[[{heading}]]")
            yield from (_entry(key, inner_value) for key, inner_value in item.items())


def _entry(name: str, value: Any) -> str:
    if not _tables(value):
        return f"{_key(name)} = {inline(value)}"
    return f"{_key(name)} = [\n" + "".join(f"  {inline(item)},\n" for item in value) + "]"


def _tables(value: Any) -> bool:
    return isinstance(value, list | tuple) and len(value) > 0 and all(isinstance(item, Mapping) for item in value)


def _key(name: str) -> str:
    return name if _BARE.fullmatch(name) else _quoted(name)


def _quoted(text: str) -> str:
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


_HEADER: Final = "seaglint scenario: what differs from the defaults; 'seaglint init' writes every key with its comment."


def stated(scenario: Scenario) -> TomlTables:
    """Return the tables and keys that a scenario states, as the TOML file; where that is not known those that differ from defaults.

    Examples
    --------
    >>> from seaglint.scenario.load import parse_scenario
    >>> stated(parse_scenario({"sea": {"temperature_k": 288.15}}))
    {'sea': {'temperature_k': 288.15}}
    """
    tables: TomlTables = scenario.model_dump(mode="json", exclude_unset=True, exclude_none=True)
    try:
        # model_copy changes values without marking them as set, so the stated keys are checked to give this scenario.
        same = Scenario.model_validate(tables) == scenario
    except ValidationError:
        same = False
    return {name: table for name, table in tables.items() if table != {}} if same else differing(scenario)


def differing(scenario: Scenario) -> TomlTables:
    """Return the tables and keys of a scenario that differ from the defaults, laid out as the TOML file.

    A key is left out where the scenario reads the same without it: defaults that follow from other keys (a field of view from the optics,
    an object's shape from its preset) are left out too.

    Examples
    --------
    >>> from seaglint.scenario.load import parse_scenario
    >>> differing(parse_scenario({"wind": {"speed_m_s": 9, "from_deg": 230}}))
    {'wind': {'speed_m_s': 9.0}}
    """
    whole: TomlTables = scenario.model_dump(exclude_none=True)
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


def _thin(table: TomlTables, same: Callable[[], bool]) -> None:
    """Remove every key of a table without which the scenario is the same."""
    # Every key is removed on trial; keys that change the scenario are restored in their former order.
    order = list(table)
    for key in order:
        value = table.pop(key)
        if same():
            continue
        table[key] = value
        for inner in [value] if isinstance(value, dict) else value if isinstance(value, list | tuple) else []:
            if isinstance(inner, dict):
                _thin(inner, same)
    ordered = {key: table[key] for key in order if key in table}
    table.clear()
    table.update(ordered)


def scenario_toml(scenario: Scenario, base: str | Path | None = None) -> str:
    """Return TOML text that reads as this scenario: only what differs from the defaults, in the units of the keys.

    Parameters
    ----------
    scenario : Scenario
        Any.
    base : path, optional
        Folder of the file: paths below it are written from there, others whole. Without it paths are written unchanged.

    Examples
    --------
    >>> from seaglint.scenario.load import parse_scenario
    >>> print(scenario_toml(parse_scenario({"wind": {"speed_m_s": 9}})).splitlines()[-1])
    speed_m_s = 9.0
    """
    return toml_text(differing(scenario), base)


def toml_text(tables: Mapping[str, Any], base: str | Path | None = None) -> str:
    """Return the TOML text of tables laid out as a scenario file."""
    return document(_with_paths(tables, None if base is None else Path(base)), _HEADER)


def toml_value(value: Any, base: Path | None = None) -> str:
    """Return one value as TOML writes it; tables in one line."""
    return inline(_with_paths(value, base))


def _with_paths(value: Any, base: Path | None) -> Any:
    """Return tables with paths relative to ``base``, or absolute ones."""
    match value:
        case Path():
            return _from(value, base)
        case BaseModel():
            return _with_paths(value.model_dump(exclude_none=True), base)
        case Mapping():
            return {key: _with_paths(item, base) for key, item in value.items()}
        case list() | tuple():
            return [_with_paths(item, base) for item in value]
        case _:
            return value


def _from(path: Path, base: Path | None) -> str:
    """Return a path as a file in ``base`` has to name it."""
    if base is None:
        return path.as_posix()
    whole, folder = path.resolve(), base.resolve()
    return (whole.relative_to(folder) if whole.is_relative_to(folder) else whole).as_posix()
