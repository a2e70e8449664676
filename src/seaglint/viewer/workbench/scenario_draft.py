"""Draft of a scenario: fields from the JSON Schema, values as typed, the scenario that they define, and their mistakes."""

from __future__ import annotations

import copy
import re
import shlex
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any, Final, Literal

from seaglint.base.errors import DataError, Mistake, ScenarioError, SeaglintError
from seaglint.base.free_form import JsonObject, TomlTables
from seaglint.scenario.load import load_scenario, parse_scenario
from seaglint.scenario.model import Scenario
from seaglint.scenario.presets import PRESETS
from seaglint.scenario.text.template import json_schema
from seaglint.scenario.text.toml_writing import differing, toml_text, toml_value
from seaglint.store.outputs import moved_when_whole

Kind = Literal["number", "text", "list", "tables", "switch", "choice", "file"]

# A comment and no docstring: Sphinx cannot draw up a signature of an alias.
Keys = tuple[str | int, ...]  # place of a key in the file: names of tables and keys, indices in lists


@dataclass(frozen=True)
class Field:
    """Input field of one key of a scenario file."""

    name: str
    #: ``number`` (with a unit as text), ``text``, ``file``, ``list`` and ``tables`` (of numbers, of tables, written as in the file),
    #: ``switch`` or ``choice``.
    kind: Kind
    hint: str = ""
    default: Any = None  #: Default value; None without a default.
    choices: tuple[Any, ...] = ()  #: Values of a choice; for a list, the allowed items.
    required: bool = False

    @property
    def placeholder(self) -> str:
        """Return the default as text to type."""
        if self.default is None:
            return "required" if self.required else "not given"
        return self.default if self.kind in ("text", "file") else toml_value(self.default)


@dataclass(frozen=True)
class Group:
    """Group of fields for one table, or for a list of tables."""

    name: str
    hint: str
    variants: Mapping[str, tuple[Field | Group, ...]]
    tag: str = ""  #: Key that chooses between ``variants``; empty for a single variant, which has the name ``""``.
    default_tag: str = ""
    optional: bool = False  #: Flag: the whole table may be omitted, and is omitted by default.
    many: bool = False  #: Flag: the file has a list of such tables.
    hints: Mapping[str, str] = field(default_factory=dict)

    def entries(self, tag: str = "") -> tuple[Field | Group, ...]:
        """Return keys and tables of a variant; for an unknown tag, of the first variant."""
        return self.variants.get(tag or self.default_tag, next(iter(self.variants.values())))


_DEEPEST: Final = 4  #: Depth to which nested tables become groups; deeper tables are typed as in the file.


@cache
def form() -> Group:
    """Return the whole form."""
    schema = json_schema()
    return Group("", schema.get("description", ""), {"": tuple(_entries(schema, schema["$defs"], 1))})


def _entries(record: Mapping[str, Any], defs: Mapping[str, Any], depth: int) -> Iterator[Field | Group]:
    required, known = record.get("required", ()), record.get("default") or {}
    for name, own in record.get("properties", {}).items():
        # The default of the table is more specific than the defaults of its keys: it has the edges of the band.
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
        if not ("oneOf" in inner or "properties" in inner):
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
    # Truth values first: a key may be either a truth value or a number.
    kind: Kind = "switch" if "boolean" in kinds else "number" if kinds & {"number", "integer"} else "text"
    return Field(name, kind, hint, default, required=required)


def _resolved(schema: Mapping[str, Any], defs: Mapping[str, Any]) -> JsonObject:
    """Return the schema behind a reference, with the attributes next to it."""
    if "$ref" not in schema:
        return dict(schema)
    return {**defs[schema["$ref"].rsplit("/", 1)[-1]], **{key: value for key, value in schema.items() if key != "$ref"}}


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


MOST_TEXT: Final = 20_000  #: Largest number of characters of one field.

_WORDS: Final = frozenset({"spline", "straight", "north-atlantic"})  #: Values of keys for files that do not name a file.


class Draft:
    """Tables of a scenario file as typed; they need not be valid.

    Parameters
    ----------
    source : path, optional
        Scenario file to begin with.
    preset : str
        Preset to begin with, without a file.

    Raises
    ------
    ScenarioError
        The file is missing, or is no TOML.
    """

    def __init__(self, source: str | Path | None = None, preset: str = "glint") -> None:
        self.source = None if source is None else Path(source)
        self.preset = preset
        self.raw: TomlTables = {}
        self._read = b""
        if self.source is None:
            self.raw = copy.deepcopy(PRESETS[preset].values)
        else:
            try:
                load_scenario(self.source)
            except ScenarioError as error:
                if not error.mistakes:  # not a scenario file at all; mistakes of keys are shown at their fields
                    raise
            self._read = self.source.read_bytes()
            self.raw = tomllib.loads(self._read.decode("utf-8-sig"))
        self._unread: dict[Keys, str] = {}
        self._own = frozenset(value for _, value in _files(self.raw, ())) if self.source is not None else frozenset()

    def snapshot(self) -> Draft:
        """Return a copy of the values; later changes do not reach it."""
        copied = copy.copy(self)
        copied.raw = copy.deepcopy(self.raw)
        copied._unread = dict(self._unread)
        return copied

    @property
    def name(self) -> str:
        """Return the name of the file to save."""
        return "scenario.toml" if self.source is None else self.source.name

    @property
    def folder(self) -> Path | None:
        """Return the folder of the scenario's files; None without a scenario file."""
        return None if self.source is None else self.source.parent

    def get(self, keys: Keys) -> Any:
        """Return the value at a place; None if the place is empty."""
        table: Any = self.raw
        for key in keys:
            if isinstance(table, Mapping):
                table = table.get(key)
            elif isinstance(table, list) and isinstance(key, int) and key < len(table):
                table = table[key]
            else:
                return None
        return table

    def put(self, keys: Keys, value: Any) -> None:
        """Set the value at a place, or remove it (None); missing tables on the way are created."""
        table: Any = self.raw
        for key in keys[:-1]:
            if isinstance(table, list):
                table = table[int(key)]
                continue
            if not isinstance(table.get(key), dict | list):
                if value is None:
                    return
                table[key] = {}
            table = table[key]
        last = keys[-1]
        if value is not None:
            table[last] = value
        elif isinstance(table, list):
            del table[int(last)]
        else:
            table.pop(last, None)

    def take(self, entry: Field, keys: Keys, text: str) -> None:
        """Set a value from a field's text; unreadable text is a mistake until it is corrected, and the previous value stays."""
        try:
            value = value_of(entry, text)
        except ScenarioError as error:
            self._unread[keys] = str(error)
            return
        self._unread.pop(keys, None)
        self.put(keys, value)

    def forget(self, keys: Keys) -> None:
        """Discard unreadable texts at a place and below, since the fields there are rebuilt with the values."""
        self._unread = {known: text for known, text in self._unread.items() if known[: len(keys)] != keys}

    def check(self) -> tuple[Scenario | None, tuple[Mistake, ...]]:
        """Return the scenario, or None and its mistakes, with the texts of the program."""
        # Checked before the scenario is read: reading would open the files.
        refused = (*(Mistake(dotted(keys), None, None, text) for keys, text in self._unread.items()), *self._outside())
        if refused:
            return None, refused
        try:
            return parse_scenario(self.raw, base=self.folder), ()
        except ScenarioError as error:
            return None, mistakes_of(error)

    def _outside(self) -> Iterator[Mistake]:
        """Yield a mistake for each file that the page may not name: neither in the scenario's folder nor in the opened file."""
        for key, value in _files(self.raw, ()):
            if value in _WORDS or value in self._own:
                continue
            if self.folder is None:
                text = (
                    f"{key} = '{value}' needs a scenario file: save this one and open it with 'seaglint view', its folder is then searched"
                )
                yield Mistake(key, value, None, text)
            elif not _inside(self.folder, value):
                text = f"{key} = '{value}' is not in the scenario's folder; put the file there, or name it in the file before opening it"
                yield Mistake(key, value, None, text)

    def toml(self, scenario: Scenario) -> str:
        """Return the text to save: only what differs from the defaults, with the units that were typed."""
        tables = differing(scenario)
        typed = _with_units(tables, self.raw)
        try:
            # Typed units are written only where they give the same scenario after defaults and rounding.
            same = parse_scenario(typed, base=self.folder) == scenario
        except ScenarioError:
            same = False
        return toml_text(typed if same else tables, self.folder)

    @property
    def changed_outside(self) -> bool:
        """Return true where the file has changed since it was read."""
        try:
            return self.source is not None and self.source.read_bytes() != self._read
        except OSError:
            return True

    def save(self, scenario: Scenario) -> Path:
        """Write the file that was opened, as a whole.

        Raises
        ------
        DataError
            No file was opened.
        StorageError
            The file cannot be written.
        """
        if self.source is None:
            raise DataError("no scenario file was opened; download the text instead, or begin with 'seaglint init'")
        text = self.toml(scenario)
        with moved_when_whole(self.source, "download the text instead") as partial:
            partial.write_text(text, encoding="utf-8")
        self._read = text.encode()
        return self.source

    def commands(self) -> list[str]:
        """Return command lines that compute the displayed pictures."""
        stem = Path(self.name).stem
        name, run, mean = (shlex.quote(text) for text in (self.name, f"{stem}.zarr", f"{stem}_mean.nc"))
        return [f"seaglint render {name} -o {run} --preview", f"seaglint mean {name} -o {mean} --preview"]


def mistakes_of(error: SeaglintError) -> tuple[Mistake, ...]:
    """Return the mistakes of an error; the whole text is one where the error names no keys."""
    return (error.mistakes if isinstance(error, ScenarioError) else ()) or (Mistake("", None, None, str(error)),)


def dotted(keys: Keys) -> str:
    """Return a place in the notation of errors.

    >>> dotted(("objects", 0, "east_m"))
    'objects[0].east_m'
    """
    return "".join(f"[{key}]" if isinstance(key, int) else f".{key}" for key in keys).lstrip(".")


def value_of(entry: Field, text: str) -> Any:
    """Return the value of a field's text: as in the file, but quotes may be omitted.

    Raises
    ------
    ScenarioError
        The text of a list or of a list of tables is no TOML.

    Examples
    --------
    >>> speed, pair = Field("speed_m_s", "number"), Field("pixels", "list")
    >>> value_of(speed, "5 kn"), value_of(speed, " 5.5"), value_of(pair, "[64, 32]")
    ('5 kn', 5.5, [64, 32])
    """
    text = text.strip()[:MOST_TEXT]
    if not text:
        return None
    if entry.kind in ("text", "file"):
        return text[1:-1] if len(text) > 1 and text[0] == text[-1] and text[0] in "\"'" else text
    # Brackets may be omitted too.
    if entry.kind in ("list", "tables") and not text.startswith("["):
        text = f"[{text}]"
    try:
        return tomllib.loads(f"value = {text}")["value"] if "\n" not in text or entry.kind == "tables" else text
    except (tomllib.TOMLDecodeError, ValueError, RecursionError) as error:
        if entry.kind == "tables":
            raise ScenarioError(f"{entry.name}: is not valid TOML: {error}; write [{{ key = 1, ... }}, ...] as in the file") from None
        # pairs with units may come without quotes too: [5 deg, 3 deg]
        return [_word(part) for part in text.strip("[]").split(",")] if entry.kind == "list" else text


def _word(text: str) -> Any:
    try:
        return tomllib.loads(f"value = {text.strip()}")["value"]
    except (tomllib.TOMLDecodeError, ValueError):
        return text.strip()


def text_of(value: Any) -> str:
    """Return the text of a value in a field."""
    if value is None:
        return ""
    return value if isinstance(value, str) else toml_value(value)


def _with_units(value: Any, typed: Any) -> Any:
    """Return a value in which numbers that were typed with a unit are replaced by the typed text."""
    match value, typed:
        case dict(), dict():
            return {key: _with_units(inner, typed.get(key)) for key, inner in value.items()}
        case (list() | tuple(), list()) if len(value) == len(typed):
            return [_with_units(inner, typed_inner) for inner, typed_inner in zip(value, typed, strict=True)]
        case float(), str():
            return typed
        case _:
            return value


def _files(table: Any, keys: tuple[str, ...]) -> Iterator[tuple[str, str]]:
    """Yield dotted keys of files and their values, at any depth."""
    if isinstance(table, Mapping):
        for name, value in table.items():
            if name in file_keys() and isinstance(value, str):
                yield ".".join((*keys, name)).replace(".[", "["), value
            else:
                yield from _files(value, (*keys, str(name)))
    elif isinstance(table, list | tuple):
        for place, value in enumerate(table):
            yield from _files(value, (*keys, f"[{place}]"))


def _inside(folder: Path, name: str) -> bool:
    try:
        return (folder / name).resolve().is_relative_to(folder.resolve())
    except (OSError, ValueError, RuntimeError):  # a name that no file system takes, links in a circle
        return False


_PLACE = re.compile(r"^(?P<name>[^\[]+)(?P<places>(\[\d+\])*)$")


def keys_of(mistake: Mistake, raw: Mapping[str, Any]) -> Keys:
    """Return the place of a mistake: keys and indices in lists; objects are identified by their name."""
    text = mistake.key
    # Errors name an object where possible; its index is looked up.
    named = re.match(r"^objects \('(?P<name>.*)'\)", text, re.DOTALL)
    if named is not None:
        objects = raw.get("objects")
        for place, item in enumerate(objects if isinstance(objects, list) else []):
            if isinstance(item, Mapping) and item.get("name") == named["name"]:
                return ("objects", place, *keys_of(Mistake(text[named.end() :].lstrip("."), None, None, ""), raw))
        return ("objects",)
    out: list[str | int] = []
    for part in text.split(".") if text else []:
        match = _PLACE.match(part)
        if match is None:
            break
        out.append(match["name"])
        out.extend(int(place) for place in re.findall(r"\d+", match["places"]))
    return tuple(out)
