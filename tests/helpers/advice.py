"""Lines of a scenario that messages of the package recommend, collected from its sources."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import seaglint

SOURCES = Path(seaglint.__file__).parent
GAP = "\N{REPLACEMENT CHARACTER}"
"""Stands for what is filled in when the program runs."""

OF_OBJECTS = ("scenario/records/object_tables.py", "studies/build/bodies.py")
"""Sources whose messages are of an object, so that its keys need no table before them."""

_VALUE = r"""(?:"[^"]*"|'[^']*'|\[[^\]]*\]|\{[^}]*\}|true|false|[-+]?\d[\d.e+-]*\d|\d)"""
_PAIR = rf"[a-z_][\w.]* = {_VALUE}"
_TABLE = re.compile(rf"\[\[?[a-z_.]+\]\]?,? {_PAIR}(?:,? (?:and )?{_PAIR})*")
_DOTTED = re.compile(rf"(?<![\w.\[]){_PAIR}")


class Advice(NamedTuple):
    """A recommendation: the file and line that make it, and its lines as TOML."""

    where: str
    lines: str


def texts() -> Iterator[tuple[str, str]]:
    """Yield the texts of the package that are no docstrings, with their places."""
    for path in sorted(SOURCES.rglob("*.py")):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        quiet = {
            id(node.body[0].value)
            for node in ast.walk(tree)
            if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef) and node.body and isinstance(node.body[0], ast.Expr)
        }
        inner = {id(part) for node in ast.walk(tree) if isinstance(node, ast.JoinedStr) for part in ast.walk(node) if part is not node}
        for node in ast.walk(tree):
            if id(node) in quiet or id(node) in inner:
                continue
            where = f"{path.relative_to(SOURCES)}:{getattr(node, 'lineno', 0)}"
            if isinstance(node, ast.Constant) and isinstance(node.value, str):
                yield where, node.value
            elif isinstance(node, ast.JoinedStr):
                yield where, "".join(str(part.value) if isinstance(part, ast.Constant) else GAP for part in node.values)


def recommended(keys: frozenset[str], of_objects: frozenset[str]) -> Iterator[Advice]:
    """Yield what texts recommend to write into a scenario: tables with their keys, dotted ``keys`` with a value, and keys of objects.

    Values that are filled in when the program runs are left out. What a text says was given looks the same and is yielded too.
    """
    for where, text in texts():
        alone = of_objects if where.startswith(OF_OBJECTS) else frozenset()
        rest = text
        for found in _TABLE.finditer(text):
            rest = rest.replace(found[0], "")
            if GAP not in found[0]:
                table, body = re.match(r"(\[\[?[a-z_.]+\]\]?),? (.*)", found[0]).groups()
                yield Advice(where, "\n".join([table, *re.findall(_PAIR, body)]))
        for found in _DOTTED.finditer(rest):
            key = found[0].split(" = ")[0]
            if GAP not in found[0] and key in keys:
                yield Advice(where, found[0])
            elif GAP not in found[0] and key in alone:
                yield Advice(where, f"[[objects]]\n{found[0]}")
