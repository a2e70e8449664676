"""Types of data without fixed fields: texts of JSON and TOML, attributes of files, and rows of tables.

A result that is read in more than one place is a record instead, with ``as_dict`` for its output.
"""

from __future__ import annotations

import math
from typing import Any

#: Object of a JSON text, read or to be written: texts, numbers, truth values, None, lists and further objects by name.
JsonObject = dict[str, Any]

TomlTables = dict[str, Any]  #: Tables of a TOML file, or a part of them, before they are checked: values and further tables by key.

Attributes = dict[str, Any]  #: Attributes of a file or a variable: texts, numbers and arrays by name.

TableRow = dict[str, Any]  #: Row of a tidy table: texts and numbers by the name of their column; None for an empty cell.


def number(value: float) -> float | None:
    """Return a finite number, or None: JSON has no NaN and no infinity."""
    return float(value) if math.isfinite(value) else None


def plain(values: JsonObject) -> JsonObject:
    """Return values as JSON holds them: numbers that are not finite become None, tuples lists."""
    return {name: _plain(value) for name, value in values.items()}


def _plain(value: Any) -> Any:
    if isinstance(value, float):
        return number(value)
    if isinstance(value, list | tuple):
        return [_plain(entry) for entry in value]
    return plain(value) if isinstance(value, dict) else value
