"""Types of data without fixed fields: texts of JSON and TOML, attributes of files, and rows of tables.

A result that is read in more than one place is a record instead, with ``as_dict`` for its output.
"""

from __future__ import annotations

from typing import Any

#: Object of a JSON text, read or to be written: texts, numbers, truth values, None, lists and further objects by name.
JsonObject = dict[str, Any]

TomlTables = dict[str, Any]  #: Tables of a TOML file, or a part of them, before they are checked: values and further tables by key.

Attributes = dict[str, Any]  #: Attributes of a file or a variable: texts, numbers and arrays by name.

TableRow = dict[str, Any]  #: Row of a tidy table: texts and numbers by the name of their column; None for an empty cell.
