"""Form of a scenario, derived from its JSON Schema: groups by table, fields by key."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache
from typing import Any, Final, Literal

from seaglint.base.free_form import JsonObject
from seaglint.scenario.text.template import json_schema
from seaglint.scenario.text.write import toml_value

Kind = Literal["number", "text", "list", "tables", "switch", "choice", "file"]

# A comment and no docstring: Sphinx cannot draw up a signature of an alias.
Path = tuple[str | int, ...]  # where a key stands in the file: names of tables and keys, places in lists


@dataclass(frozen=True)
class Field:
    """Field of one key."""

    name: str
    #: ``number`` (with a unit as text), ``text``, ``file``, ``list`` and ``tables`` (of numbers, of tables, written as in the file),
    #: ``switch`` or ``choice``.
    kind: Kind
    hint: str = ""
    default: Any = None  #: Value where none is given; None without a default.
    choices: tuple[Any, ...] = ()  #: Values of a choice; for a list, the allowed items.
    required: bool = False

    @property
    def placeholder(self) -> str:
        """Return the default as one would type it."""
        if self.default is None:
            return "required" if self.required else "not given"
        return self.default if self.kind in ("text", "file") else toml_value(self.default)


@dataclass(frozen=True)
class Group:
    """Group of one table, or of a list of tables."""

    name: str
    hint: str
    variants: Mapping[str, tuple[Field | Group, ...]]
    tag: str = ""  #: Key that chooses between ``variants``; empty where there is one variant only, by the name ``""``.
    default_tag: str = ""
    optional: bool = False  #: Flag: the whole table may be omitted and is by default.
    many: bool = False  #: Flag: the file has a list of such tables.
    hints: Mapping[str, str] = field(default_factory=dict)

    def entries(self, tag: str = "") -> tuple[Field | Group, ...]:
        """Return keys and tables of a variant; of the first one for an unknown tag."""
        return self.variants.get(tag or self.default_tag, next(iter(self.variants.values())))


_DEEPEST: Final = 4  #: Depth of nested tables that become groups; deeper ones are typed as in the file.


@cache
def form() -> Group:
    """Return the whole form."""
    schema = json_schema()
    return Group("", schema.get("description", ""), {"": tuple(_entries(schema, schema["$defs"], 1))})


def _entries(record: Mapping[str, Any], defs: Mapping[str, Any], depth: int) -> Iterator[Field | Group]:
    required, known = record.get("required", ()), record.get("default") or {}
    for name, own in record.get("properties", {}).items():
        # the table's own default knows more than its keys': the edges of the band
        schema = own if known.get(name) is None else {**own, "default": known[name]}
        if "const" not in schema:  # the tag of a union: its group has it
            yield _entry(name, schema, defs, depth, name in required)


def _entry(name: str, schema: Mapping[str, Any], defs: Mapping[str, Any], depth: int, required: bool) -> Field | Group:
    ways = [_resolved(way, defs) for way in schema.get("anyOf", [schema])]
    given = [way for way in ways if way.get("type") != "null"]
    hint = str(schema.get("description", ""))
    optional = len(given) < len(ways)
    for way in given:
        many = way.get("type") == "array" and "items" in way
        inner = _resolved(way["items"], defs) if many else way
        if not _is_table(inner):
            continue
        if depth >= _DEEPEST or (many and depth > 1):
            return Field(name, "tables", hint, schema.get("default"), required=required)
        return _group(name, inner, defs, depth, hint, optional=optional or (many and schema.get("default") is None), many=many)
    return _field(name, schema, given, hint, required)


def _group(name: str, table: Mapping[str, Any], defs: Mapping[str, Any], depth: int, hint: str, *, optional: bool, many: bool) -> Group:
    if "oneOf" not in table:
        hint = hint or _first_line(table)
        return Group(name, hint, {"": tuple(_entries(table, defs, depth + 1))}, optional=optional, many=many)
    tag, mapping = table["discriminator"]["propertyName"], table["discriminator"]["mapping"]
    records = {word: _resolved({"$ref": place}, defs) for word, place in mapping.items()}
    # in the order of the models, which put the common ones first
    order = [ref["$ref"] for ref in table["oneOf"]]
    records = dict(sorted(records.items(), key=lambda item: order.index(mapping[item[0]])))
    default = table.get("default") or {}
    return Group(
        name,
        hint,
        {word: tuple(_entries(record, defs, depth + 1)) for word, record in records.items()},
        tag=tag,
        default_tag=str(default.get(tag) or next(iter(records))),
        optional=optional,
        many=many,
        hints={word: _first_line(record) for word, record in records.items()},
    )


def _field(name: str, schema: Mapping[str, Any], ways: list[JsonObject], hint: str, required: bool) -> Field:
    default = schema.get("default")
    kinds = {way.get("type") for way in ways}
    for way in ways:
        if "enum" in way:
            return Field(name, "choice", hint, default, tuple(way["enum"]), required)
        if way.get("type") == "array":
            return Field(name, "list", hint, default, tuple(way.get("items", {}).get("enum", ())), required)
        if way.get("format") in ("path", "file-path"):
            return Field(name, "file", hint, default, required=required)
    kind: Kind = "switch" if "boolean" in kinds else "number" if kinds & {"number", "integer"} else "text"
    return Field(name, kind, hint, default, required=required)


def _resolved(schema: Mapping[str, Any], defs: Mapping[str, Any]) -> JsonObject:
    """Return the schema behind a reference, with the attributes beside it."""
    if "$ref" not in schema:
        return dict(schema)
    rest = {key: value for key, value in schema.items() if key != "$ref"}
    return {**defs[schema["$ref"].rsplit("/", 1)[-1]], **rest}


def _is_table(schema: Mapping[str, Any]) -> bool:
    return "oneOf" in schema or "properties" in schema


def _first_line(record: Mapping[str, Any]) -> str:
    return str(record.get("description", "")).split("\n")[0].rstrip(".").replace("``", "")


@cache
def file_keys() -> frozenset[str]:
    """Return the names of the keys that hold paths of files, at any depth."""
    keys = set()
    for record in json_schema()["$defs"].values():
        for name, schema in record.get("properties", {}).items():
            if any(way.get("format") in ("path", "file-path") for way in schema.get("anyOf", [schema])):
                keys.add(name)
    return frozenset(keys)
