"""Writer of TOML text from plain values and tables, laid out as scenario files are."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from datetime import date, datetime, time
from typing import Any, Final

from pydantic import BaseModel

_BARE: Final = re.compile(r"[A-Za-z0-9_-]+")


def inline(value: Any) -> str:
    """Return a value as it stands to the right of the equals sign.

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
        way = (*above, name)
        heading = ".".join(map(_key, way))
        if isinstance(value, Mapping):
            if not value or any(not isinstance(held, Mapping) for held in value.values()):
                yield from ("", f"[{heading}]")  # else the headings of its tables name it
            yield from _lines(value, way)
            continue
        for item in value:
            yield from ("", f"[[{heading}]]")
            yield from (_entry(key, held) for key, held in item.items())


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
