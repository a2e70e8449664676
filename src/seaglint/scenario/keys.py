"""Tree of the keys that a scenario may have, derived from the models: for error messages, the template and the documentation."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from typing import Annotated, Any, Literal, get_args, get_origin

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from seaglint.scenario.model import Scenario
from seaglint.scenario.records.quantities import Quantity


@dataclass(frozen=True)
class Key:
    """One key: its path, its meaning and its allowed values."""

    path: tuple[str, ...]
    info: FieldInfo
    records: tuple[type[BaseModel], ...]  #: Records that the key may hold when it is a table; several for a union.

    @property
    def quantities(self) -> tuple[Quantity, ...]:
        """Return the units and ranges of the key's numbers; empty where it has none."""
        return tuple(_find(self.info.annotation, Quantity)) or tuple(item for item in self.info.metadata if isinstance(item, Quantity))

    @property
    def allowed(self) -> str:
        """Return the range or the choices as text; empty where any value is allowed."""
        if self.quantities:
            return " x ".join(dict.fromkeys(quantity.allowed for quantity in self.quantities))
        choices = " | ".join(f'"{choice}"' if isinstance(choice, str) else f"{choice}" for choice in _choices(self.info.annotation))
        if choices:
            return f"list of {choices}" if is_list(self.info.annotation) else choices
        return "true | false" if self.info.annotation is bool else ""


def _find(annotation: Any, kind: type) -> Iterator[Any]:
    """Yield the instances of ``kind`` among the annotations nested in a type."""
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
    """Return the values of the choice in a type, also of one that is optional or in a list."""
    if get_origin(annotation) is Literal:
        return get_args(annotation)
    return tuple(dict.fromkeys(choice for argument in get_args(annotation) for choice in _choices(argument)))


def is_list(annotation: Any) -> bool:
    """Return true for a list of any length (in the file), false for a pair."""
    return any(get_origin(kind) is tuple and get_args(kind)[-1] is Ellipsis for kind in (annotation, *get_args(annotation)))


def list_length(annotation: Any) -> int | None:
    """Return the number of values of a list of fixed length; None for lists of any length and for keys that are no list.

    >>> list_length(tuple[float, float] | None), list_length(tuple[int, ...]), list_length(float)
    (2, None, None)
    """
    kinds = (kind for kind in (annotation, *get_args(annotation)) if get_origin(kind) is tuple)
    return next((len(get_args(kind)) for kind in kinds if get_args(kind)[-1] is not Ellipsis), None)


def fields_of(record: type[BaseModel], above: tuple[str, ...] = ()) -> Iterator[Key]:
    """Yield the keys of one record, without the keys of inner tables."""
    for name, info in record.model_fields.items():
        yield Key((*above, name), info, tuple(dict.fromkeys(_records(info.annotation))))


@cache
def _at(location: tuple[str, ...]) -> tuple[type[BaseModel], ...]:
    """Return the records that are allowed at a location."""
    records: tuple[type[BaseModel], ...] = (Scenario,)
    for part in location:
        if part.isdecimal():  # a place in a list
            continue
        inside = (inner for record in records for key in fields_of(record) if key.path[-1] == part for inner in key.records)
        records = tuple(dict.fromkeys(inside))
    return records


def table_keys(location: tuple[str | int, ...]) -> tuple[str, ...]:
    """Return the keys allowed in the table at a location, over all kinds that the table may have."""
    return tuple(dict.fromkeys(name for record in _at(tuple(str(part) for part in location)) for name in record.model_fields))


def key_at(location: tuple[str | int, ...], kind: str | None = None) -> Key | None:
    """Return the key at a location, or the list that holds it; None where no such key exists.

    A table of several kinds has the key of the given ``kind``, otherwise of the first kind that has one.
    """
    *above, name = (str(part) for part in location if isinstance(part, str))
    records = _at(tuple(above))
    if len(records) > 1 and kind is not None:
        tag = tag_name(tuple(above))
        records = tuple(sorted(records, key=lambda record: record.model_fields[tag].default != kind))
    return next((key for record in records for key in fields_of(record, tuple(above)) if key.path[-1] == name), None)


def named_key(dotted: str) -> Key | None:
    """Return the key of a dotted name as ``seaglint.scenario.changed_scenario.set_key`` takes it; None where no such key exists.

    >>> named_key("objects.ferry.course_deg").path, named_key("sensor.fov_deg.0").path, named_key("wind.speed")
    (('objects', 'course_deg'), ('sensor', 'fov_deg'), None)
    """
    parts = dotted.split(".")
    if parts[0] == "objects" and len(parts) > 1:
        # The name or the number of an object is not a level of the records.
        parts.pop(1)
    return _key_at(tuple(part for part in parts if not part.isdecimal()))


@cache
def _key_at(location: tuple[str, ...]) -> Key | None:
    return key_at(location) if location else None


def quantity_of(dotted: str) -> Quantity | None:
    """Return unit and range of a key of the scenario; None where it is no number, or no key."""
    key = named_key(dotted)
    return next(iter(key.quantities), None) if key is not None else None


def choices_at(location: tuple[str | int, ...]) -> tuple[str, ...]:
    """Return the choices at a location as text; empty where any value is allowed."""
    key = key_at(location)
    return tuple(str(choice) for choice in _choices(key.info.annotation)) if key is not None else ()


def tags(location: tuple[str | int, ...]) -> tuple[str, ...]:
    """Return the kinds of the union at a location; empty where there is no union."""
    records = _at(tuple(str(part) for part in location))
    if len(records) < 2:
        return ()
    name = next(iter(records[0].model_fields))  # others may inherit fields that stand before it
    return tuple(str(choice) for record in records for choice in _choices(record.model_fields[name].annotation))


def choices_of_kind(key: Key) -> str:
    """Return all kinds as text for the key that chooses a kind; empty for other keys."""
    above = tags(key.path[:-1])
    return " | ".join(f'"{tag}"' for tag in above) if above and tag_name(key.path[:-1]) == key.path[-1] else ""


def tag_name(location: tuple[str | int, ...]) -> str:
    """Return the name of the key that chooses the kind of the union at a location."""
    return next(iter(_at(tuple(str(part) for part in location))[0].model_fields))


def kinds_with(location: tuple[str | int, ...], name: str) -> tuple[str, ...]:
    """Return the kinds of the union at a location that have a key ``name``, as ``tag_name`` is written for them."""
    records, kind = _at(tuple(str(part) for part in location)), tag_name(location)
    return tuple(record.model_fields[kind].default for record in records if name in record.model_fields)


@cache
def key_paths() -> tuple[str, ...]:
    """Return all keys as dotted paths, without tables."""

    def walk(record: type[BaseModel], above: tuple[str, ...], over: tuple[type[BaseModel], ...]) -> Iterator[str]:
        for key in fields_of(record, above):
            # Tables are not keys that can be set to a number or text; their keys are walked below.
            if not key.records:
                yield ".".join(key.path)
            for inner in key.records:
                if inner not in over:  # shapes are made of shapes
                    yield from walk(inner, key.path, (*over, *key.records))

    return tuple(dict.fromkeys(walk(Scenario, (), ())))
