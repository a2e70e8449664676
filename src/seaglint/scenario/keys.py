"""The tree of keys a scenario may have, read off the models: for error messages, the template and the documentation."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from typing import Annotated, Any, Literal, get_args, get_origin

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from seaglint.scenario.model import Scenario
from seaglint.scenario.records.quantity import Quantity


@dataclass(frozen=True)
class Key:
    """One key: where it stands, what it means, what it may be."""

    path: tuple[str, ...]
    info: FieldInfo
    records: tuple[type[BaseModel], ...]
    """Records that the key may hold, when it is a table (several for a union)."""

    @property
    def quantities(self) -> tuple[Quantity, ...]:
        """Units and ranges of the key's numbers; empty where it has none."""
        return tuple(_find(self.info.annotation, Quantity)) or tuple(item for item in self.info.metadata if isinstance(item, Quantity))

    @property
    def allowed(self) -> str:
        """Range or choices as text; empty where any value goes."""
        if self.quantities:
            return " x ".join(dict.fromkeys(quantity.allowed for quantity in self.quantities))
        choices = " | ".join(f'"{choice}"' if isinstance(choice, str) else f"{choice}" for choice in _choices(self.info.annotation))
        if choices:
            return f"list of {choices}" if is_list(self.info.annotation) else choices
        return "true | false" if self.info.annotation is bool else ""


def _find(annotation: Any, kind: type) -> Iterator[Any]:
    """Instances of ``wanted`` among the annotations nested in a type."""
    if get_origin(annotation) is Annotated:
        inner, *extras = get_args(annotation)
        yield from (extra for extra in extras if isinstance(extra, kind))
        yield from _find(inner, kind)
    else:
        for argument in get_args(annotation):
            yield from _find(argument, kind)


def _records(annotation: Any) -> Iterator[type[BaseModel]]:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    for argument in get_args(annotation):
        yield from _records(argument)


def _choices(annotation: Any) -> tuple[Any, ...]:
    """Values of the choice in a type, also of one that may be left out or is asked for in a list."""
    if get_origin(annotation) is Literal:
        return get_args(annotation)
    return tuple(dict.fromkeys(choice for argument in get_args(annotation) for choice in _choices(argument)))


def is_list(annotation: Any) -> bool:
    """Whether a type is a list of any length (in the file), rather than a pair."""
    return any(get_origin(kind) is tuple and get_args(kind)[-1] is Ellipsis for kind in (annotation, *get_args(annotation)))


def fields_of(record: type[BaseModel], above: tuple[str, ...] = ()) -> Iterator[Key]:
    """Keys of one record, not going deeper."""
    for name, info in record.model_fields.items():
        yield Key((*above, name), info, tuple(dict.fromkeys(_records(info.annotation))))


@cache
def _at(location: tuple[str, ...]) -> tuple[type[BaseModel], ...]:
    """Records that may stand at a location."""
    records: tuple[type[BaseModel], ...] = (Scenario,)
    for part in location:
        if part.isdecimal():  # a place in a list
            continue
        inside = (inner for record in records for key in fields_of(record) if key.path[-1] == part for inner in key.records)
        records = tuple(dict.fromkeys(inside))
    return records


def table_keys(location: tuple[str | int, ...]) -> tuple[str, ...]:
    """Keys allowed in the table at a location, over all the kinds that it may have."""
    return tuple(dict.fromkeys(name for record in _at(tuple(str(part) for part in location)) for name in record.model_fields))


def key_at(location: tuple[str | int, ...]) -> Key | None:
    """The key at a location, or the list that holds it; None where no such key exists."""
    *above, name = (str(part) for part in location if isinstance(part, str))
    return next((key for record in _at(tuple(above)) for key in fields_of(record, tuple(above)) if key.path[-1] == name), None)


def choices_at(location: tuple[str | int, ...]) -> tuple[str, ...]:
    """What the choice at a location may be, as text; empty where any value goes."""
    key = key_at(location)
    return tuple(str(choice) for choice in _choices(key.info.annotation)) if key is not None else ()


def tags(location: tuple[str | int, ...]) -> tuple[str, ...]:
    """Kinds of the union at a location; empty where there is no union."""
    records = _at(tuple(str(part) for part in location))
    if len(records) < 2:
        return ()
    return tuple(str(choice) for record in records for choice in _choices(next(iter(record.model_fields.values())).annotation))


def choices_of_kind(key: Key) -> str:
    """For the key that chooses a kind: all kinds as text; empty for other keys."""
    above = tags(key.path[:-1])
    return " | ".join(f'"{tag}"' for tag in above) if above and tag_name(key.path[:-1]) == key.path[-1] else ""


def tag_name(location: tuple[str | int, ...]) -> str:
    """Name of the key that chooses the kind of the union at a location."""
    return next(iter(_at(tuple(str(part) for part in location))[0].model_fields))


@cache
def key_paths() -> tuple[str, ...]:
    """All keys as dotted paths, tables not included."""

    def walk(record: type[BaseModel], above: tuple[str, ...], over: tuple[type[BaseModel], ...]) -> Iterator[str]:
        for key in fields_of(record, above):
            if not key.records:
                yield ".".join(key.path)
            for inner in key.records:
                if inner not in over:  # shapes are made of shapes
                    yield from walk(inner, key.path, (*over, *key.records))

    return tuple(dict.fromkeys(walk(Scenario, (), ())))
