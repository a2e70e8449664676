"""Reader of scenarios from a TOML file or a mapping; errors name file, key, value, allowed range and the nearest valid key."""

from __future__ import annotations

import difflib
import logging
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from datetime import datetime
from pathlib import Path
from typing import Any

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from seaglint.base.errors import Mistake, ScenarioError
from seaglint.scenario.keys import Key, choices_at, is_list, key_at, key_paths, kinds_with, list_length, table_keys, tag_name, tags
from seaglint.scenario.model import Scenario
from seaglint.scenario.moon import phase_misfit
from seaglint.scenario.presets import with_sensor
from seaglint.scenario.records.object_tables import with_names
from seaglint.scenario.records.quantities import meant_in
from seaglint.scenario.text import display  # noqa: F401 - scenarios show themselves in notebooks

log = logging.getLogger(__name__)


def load_scenario(path: str | Path, *, sensor: str | None = None) -> Scenario:
    """Read and validate a scenario file; ``sensor`` names a preset that replaces its sensor's optics, detector, scan and noise.

    Raises
    ------
    ScenarioError
        With one line per mistake: ``file: key.path = value ...: allowed values; remedy``.
    """
    path = Path(path)
    try:
        # Editors on Windows may begin UTF-8 files with a byte-order mark, which TOML does not allow.
        text = path.read_bytes().decode("utf-8-sig")
    except FileNotFoundError:
        raise ScenarioError(f"{path}: no such file; 'seaglint init {path}' writes a commented one") from None
    except IsADirectoryError:
        raise ScenarioError(f"{path}: is a folder; give the scenario's TOML file") from None
    except UnicodeDecodeError as error:
        raise ScenarioError(f"{path}: is not UTF-8 text (byte {error.start}); save the scenario as UTF-8") from None
    except OSError as error:
        raise ScenarioError(f"{path}: cannot be read: {error.strerror}") from None
    try:
        raw = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise ScenarioError(f"{path}: is not valid TOML: {error}; is the file whole, and is text in quotes?") from None
    except ValueError:
        raise ScenarioError(f"{path}: holds a number of thousands of digits; write numbers as 1.5 or 2e3") from None
    except RecursionError:
        raise ScenarioError(f"{path}: holds lists or tables nested hundreds deep; 'seaglint init' writes a file to start from") from None
    scenario = parse_scenario(raw if sensor is None else with_sensor(raw, sensor), name=str(path), base=path.parent)
    report_moments(raw, str(path))
    if (misfit := phase_misfit(scenario)) is not None:
        log.warning("seaglint: %s: %s", path, misfit)
    return scenario


def report_moments(raw: Mapping[str, Any], name: str) -> None:
    """Report the UTC time that is taken for dates and times without a zone, or without an hour, because it changes the Sun."""
    for key, moment, hour in _without_zone(raw):
        given, lacks = (moment.isoformat(), "") if hour else (f"{moment:%Y-%m-%d}", "no hour and ")
        text = "seaglint: %s: %s = %s has %sno time zone and is taken as UTC, %sZ; end the time in Z, or in its offset such as -05:00"
        log.warning(text, name, key, given, lacks, moment.isoformat())


def _without_zone(raw: Any, above: str = "") -> Iterator[tuple[str, datetime, bool]]:
    """Yield the keys of dates and times without a zone, the time that is taken, and whether an hour is given."""
    if isinstance(raw, Mapping):
        for key, value in raw.items():
            yield from _without_zone(value, f"{above}.{key}" if above else str(key))
    elif isinstance(raw, list):
        for place, value in enumerate(raw):
            yield from _without_zone(value, f"{above}[{place}]")
    elif above.rpartition(".")[2] in ("utc", "time"):
        try:
            given = raw.strip() if isinstance(raw, str) else raw.isoformat()
            moment = datetime.fromisoformat(given)
        except (ValueError, AttributeError):
            return
        # A moment with a zone is exact; one without is taken as UTC and reported.
        if moment.tzinfo is None:
            yield above, moment, len(given) > len("2026-06-21")


def parse_scenario(raw: Mapping[str, Any], *, name: str = "scenario", base: Path | None = None) -> Scenario:
    """Validate a mapping laid out as the TOML file; ``base`` is the folder that relative paths count from."""
    if "ensemble" in raw:
        raise ScenarioError(f"{name}: is an ensemble of scenes; draw them with 'seaglint ensemble' (draw_only=True), and give one of them")
    try:
        return Scenario.model_validate(dict(raw), context={"base": base})
    except ValidationError as error:
        details = [detail for detail in error.errors(include_url=False) if not counts_elements(detail)]
        explained = (_named(_explain(detail, raw), detail["loc"], raw) for detail in details)
        # A union reports a mistake once per kind; equal lines are printed once.
        mistakes = tuple({mistake.text: mistake for mistake in explained}.values())
        raise ScenarioError("\n".join(f"{name}: {mistake.text}" for mistake in mistakes), mistakes=mistakes) from None


def counts_elements(error: ErrorDetails) -> bool:
    """Return true where a list is called too short only because its wrong elements, which have lines themselves, do not count."""
    return error["type"] == "too_short" and isinstance(error["input"], list | tuple) and len(error["input"]) >= error["ctx"]["min_length"]


def _explain(error: ErrorDetails, raw: Mapping[str, Any]) -> Mistake:
    """Describe one mistake in one line."""
    location = _without_tags(error["loc"], raw)
    if error["type"] == "missing" and isinstance(location[-1], int):
        location = location[:-1]  # a value of a list of fixed length; the input is the list
        return Mistake(_dotted(location), error["input"], None, _sentence(error, location))
    key, kind, context, given = _dotted(location), error["type"], error.get("ctx", {}), error["input"]
    if kind == "rule":
        meant = _meant_in(context["key"], context["allowed"], raw)
        return Mistake(context["key"], context["value"], context["allowed"], f"{context['key']} {error['msg']}{meant}")
    if kind == "union_tag_invalid":
        allowed, tag = tags(location), f"{key}.{tag_name(location)}"
        text = f"{tag} = '{context['tag']}' is not one of {_listed(allowed)}{_meant(context['tag'], allowed)}"
        return Mistake(tag, context["tag"], _listed(allowed), text)
    if kind == "literal_error":
        allowed = choices_at(location)
        text = f"{key} = {_shown(given)} is not one of {_listed(allowed)}{_meant(str(given), allowed)}"
        return Mistake(key, given, _listed(allowed), text)
    if kind == "union_tag_not_found" and isinstance(given, Mapping):
        allowed, tag = tags(location), f"{key}.{tag_name(location)}"
        return Mistake(tag, None, _listed(allowed), f"{tag} is missing; add one of {_listed(allowed)}")
    return Mistake(key, None if kind == "missing" else given, context.get("allowed"), _sentence(error, location))


def _meant_in(key: str, allowed: object, raw: Mapping[str, Any]) -> str:
    """Return the question whether a number that a rule refuses is in another unit than its key."""
    value: Any = raw
    for part in key.split("."):
        value = value.get(part) if isinstance(value, Mapping) else None
    if isinstance(value, bool) or not isinstance(value, int | float) or not isinstance(allowed, tuple):
        return ""
    place, (low, high) = key_at(tuple(key.split("."))), allowed
    unit = next((quantity.unit for quantity in place.quantities), "") if place is not None else ""
    return meant_in(value, unit, lambda given: low <= given <= high, high)


def _named(mistake: Mistake, location: Sequence[str | int], raw: Mapping[str, Any]) -> Mistake:
    """Put the name of the object into a mistake of an object."""
    match location:
        case ("objects", int(place), *_):
            given = with_names(raw["objects"])[place] if isinstance(raw.get("objects"), Sequence) else None
            name = given.get("name") if isinstance(given, Mapping) else None
        case _:
            return mistake
    if not isinstance(name, str) or f"'{name}'" in mistake.text:
        return mistake
    prefix = f"objects[{place}]"
    rest = mistake.text.removeprefix(prefix) if mistake.text.startswith(prefix) else f": {mistake.text}"
    return replace(mistake, text=f"{prefix} ({_shown(name)}){rest}")


def _sentence(error: ErrorDetails, location: tuple[str | int, ...]) -> str:
    """Return the line of a mistake that no other key and no list of names explains."""
    key, kind, value = _dotted(location), error["type"], _shown(error["input"])
    if kind == "extra_forbidden":
        return _unknown_key(location)
    # The last text of pydantic's location but the key is the kind of the table, if it has several.
    table = next((str(part) for part in reversed(error["loc"]) if isinstance(part, str) and part not in location), None)
    known = key_at(location, table) if kind in ("missing", "too_short", "too_long", "tuple_type") else None
    if known is not None and (kind != "missing" or isinstance(error["input"], list | tuple)):
        return f"{key} = {value} {_list_mistake(known, error)}"
    if kind == "missing":
        return f"{key} is missing; add it to the file"
    if kind in ("quantity", "missing_file"):
        return f"{key} = {value} {error['msg']}"
    if kind in ("model_type", "model_attributes_type", "dict_type") or kind.startswith("union_tag"):
        keys = ", ".join(table_keys(location)) or "none"
        header = f"[[{_dotted(location[:-1])}]]" if isinstance(location[-1], int) else f"[{key}]"
        return f"{key} = {value} must be a table {header}; allowed keys: {keys}"
    if kind.startswith("bool"):
        return f"{key} = {value} must be true or false"
    if kind.startswith("datetime") or kind.startswith("date_"):
        return f"{key} = {value} is not a date and time; write it as 2026-06-21T17:30:00Z"
    if kind.startswith("path"):
        return f"{key} = {value} must be the path of a file, in quotes"
    return f"{key} = {value}: {error['msg']}"


def _list_mistake(key: Key, error: ErrorDetails) -> str:
    """Return what is wrong with a list itself: that it is none, or the number of its values."""
    given, context = error["input"], error.get("ctx", {})
    count = len(given) if isinstance(given, list | tuple) else None
    length = list_length(key.info.annotation)
    if length is not None:
        wrong = f"must be a list of {length} numbers in brackets" if count is None else f"has {values_text(count)} and must have {length}"
        return f"{wrong}: {key.info.description} (allowed: {key.allowed})"
    names = choices_at(key.path)
    allowed = _listed(names) if names else key.allowed
    if count is None:
        return "must be a list in brackets" + (f"; allowed in it: {allowed}" if allowed else "")
    if error["type"] == "too_long":
        return f"has {values_text(count)}; allowed are at most {context['max_length']}"
    least = context["min_length"]
    return f"{'is empty' if count == 0 else f'has {values_text(count)}'}; give {least} or more" + (
        f" (allowed: {allowed})" if allowed else ""
    )


def values_text(count: int) -> str:
    """Return a number of values in words."""
    return f"{count} value{'' if count == 1 else 's'}"


def _unknown_key(location: Sequence[str | int]) -> str:
    *table, wrong = location
    allowed_keys, name = table_keys(tuple(table)), str(wrong)
    if name in allowed_keys:
        # A key of another kind of the same table, such as atmosphere.model beside source = "isothermal".
        tag = tag_name(tuple(table))
        kinds = " or ".join(f'"{kind}"' for kind in kinds_with(tuple(table), name))
        change = f"set {_dotted(table)}.{tag} = {kinds}" if kinds else f"change the {tag}"
        return f"{_dotted(location)} does not go with this {tag} of {_dotted(table)}; leave it out or {change}"
    # Of other tables only a key of the very same name helps: a similar one (direction_deg, elevation_deg) means something else.
    exact = [path for path in key_paths() if path.rsplit(".", 1)[-1] == name]
    # Keys of the same table may be misspelt; keys of other tables count with an equal name only.
    near = [_dotted((*table, key)) for key in difflib.get_close_matches(name, allowed_keys, n=1, cutoff=0.6)] + exact[:1]
    hint = f"; did you mean {' or '.join(near)}?" if near else ""
    allowed = "" if near else f"; allowed here: {', '.join(allowed_keys) or 'none'}"
    return f"{_dotted(location)} is an unknown key{hint}{allowed}"


def _without_tags(location: Sequence[str | int], raw: Mapping[str, Any]) -> tuple[str | int, ...]:
    """Return a location without the tags of unions, which pydantic adds and the file does not have.

    In a list of unions (``sea.spectrum.systems[0].file.path``) the tag follows the place.
    """
    out: list[str | int] = []
    skip = False
    for part in location:
        if skip:
            skip = False
            continue
        out.append(part)
        key = key_at(tuple(out)) if isinstance(part, str) else None
        skip = bool(tags(tuple(out))) and not (key is not None and is_list(key.info.annotation))
    return tuple(out)


def _dotted(location: Sequence[str | int]) -> str:
    return "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in location).lstrip(".")


def _listed(values: Sequence[str]) -> str:
    return ", ".join(value if value.isdecimal() else f"'{value}'" for value in values)


def _meant(given: str, allowed: Sequence[str]) -> str:
    near = [value for value in allowed if given and value.startswith(given)] or difflib.get_close_matches(given, allowed, n=1, cutoff=0.5)
    return f"; did you mean '{near[0]}'?" if near else ""


def _shown(value: object) -> str:
    text = {True: "true", False: "false"}.get(value) if isinstance(value, bool) else None
    try:
        text = text or (f"'{value}'" if isinstance(value, str | Path) else f"{value}")
    except ValueError:  # a hexadecimal number of thousands of digits
        text = "(a number of thousands of digits)"
    text = " ".join(text.split())
    return text if len(text) <= 80 else text[:77] + "..."
