"""Ensemble files: a base scenario, laws for its keys, and the number of scenes and frames that are drawn."""

from __future__ import annotations

import difflib
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Final, Literal, Self

from pydantic import ConfigDict, Field, PrivateAttr, TypeAdapter, ValidationError, model_validator
from pydantic_core import ErrorDetails

from seaglint.base.errors import Mistake, ScenarioError
from seaglint.base.free_form import TomlTables
from seaglint.scenario.keys import list_length
from seaglint.scenario.load import counts_elements, parse_scenario, report_moments, values_text
from seaglint.scenario.model import Scenario
from seaglint.scenario.presets import PRESETS, with_sensor
from seaglint.scenario.records.ensemble_tables import Choice, Dataset, Law, LogUniform, Normal, Number, Uniform, Vary, Weather
from seaglint.scenario.records.object_tables import with_names
from seaglint.scenario.records.quantities import Quantity, Record, about, rule

Sampling = Literal["random", "latin_hypercube", "sobol"]

MOST_OBJECTS = 1000  #: Largest number of objects that one template draws in a scene.

COUNT = Quantity(ge=0, le=MOST_OBJECTS, integer=True)  #: Range of the number of objects.

_LAW: TypeAdapter[Any] = TypeAdapter(Law)

Value = Law | Number  #: Law of a key, or a constant value.


class EnsembleSettings(Record):
    """Number of scenes, and the method by which they are drawn."""

    scenes: Annotated[int, Quantity(ge=1, le=1_000_000, integer=True), about("number of scenes")]
    frames: Annotated[
        Annotated[int, Quantity(ge=1, le=10_000_000, integer=True)] | None,
        about("frames of every scene; default: sensor.frames of the base"),
    ] = None
    seed: Annotated[int, Quantity(ge=0, le=9_223_372_036_854_775_807, integer=True), about("the same seed draws the same scenes")] = 1
    sampling: Annotated[
        Sampling,
        about(
            "random: every draw by itself; latin_hypercube: of each key one draw in each of as many equally probable parts as "
            "there are scenes; sobol: even in several keys at once"
        ),
    ] = "random"
    sensor: Annotated[str | None, about("preset that stands in for the base's sensor, as --sensor of render")] = None


class Template(Record):
    """Objects of a kind that every scene draws anew; further keys are those of a scenario's ``[[objects]]``, numbers or laws."""

    model_config = ConfigDict(extra="allow")

    name: Annotated[
        str, Field(min_length=1, max_length=90, description="objects are called NAME-1, NAME-2, ...; default: that of preset or shape")
    ]
    count: Annotated[Law | Annotated[int, COUNT], about("how many")] = 1
    column: Annotated[Value | None, about("place in the first frame: pixels from its left edge")] = None
    row: Annotated[Value | None, about("place in the first frame: pixels from its upper edge")] = None
    range_m: Annotated[Value | None, about("distance along the sea")] = None
    apart_px: Annotated[float, Quantity(ge=0, le=10_000), about("least distance in the first frame from objects drawn before [px]")] = 0.0

    @property
    def others(self) -> TomlTables:
        """Return the keys of the object itself."""
        return dict(self.model_extra or {})

    @model_validator(mode="after")
    def _placed_once(self) -> Self:
        where = f"objects ('{self.name}')"
        if self.column is None:
            for key in ("row", "range_m"):
                if getattr(self, key) is not None:
                    raise rule(where, f"has {key} and no column; give column, or east_m and north_m instead")
            if self.apart_px:
                raise rule(where, "has apart_px and no column; give column and row")
            return self
        for key in ("east_m", "north_m", "latitude_deg", "longitude_deg", "track", "keyframes"):
            if key in self.others:
                raise rule(where, f"has column and {key}; give one of them")
        if self.row is None and self.range_m is None:
            raise rule(where, "has column alone; add row, or range_m")
        if self.row is not None and self.range_m is not None and {"height_m", "draught_m"} & self.others.keys():
            raise rule(where, "has row, range_m and a height, which are one too many; give two of them")
        return self


class Ensemble(Record):
    """Ensemble as read; its base no longer depends on a file."""

    base: Annotated[TomlTables, about("a scenario's tables; in the file also its path")]
    ensemble: EnsembleSettings
    vary: Annotated[tuple[Vary, ...], about("laws of keys")] = ()
    objects: Annotated[tuple[Template, ...], about("objects that every scene draws anew, beside those of the base")] = ()
    dataset: Annotated[Dataset, about("labelled data sets of it, for the command dataset")] = Dataset()
    _name: str = PrivateAttr("ensemble")
    _folder: Path | None = PrivateAttr(None)

    @property
    def name(self) -> str:
        """Name of the ensemble in error messages: the path of its file."""
        return self._name

    @property
    def folder(self) -> Path | None:
        """Folder from which relative paths in the ensemble count."""
        return self._folder

    @model_validator(mode="before")
    @classmethod
    def _objects_by_name(cls, raw: Any) -> Any:
        return {**raw, "objects": with_names(raw["objects"])} if isinstance(raw, dict) and "objects" in raw else raw

    @model_validator(mode="after")
    def _keys_once(self) -> Self:
        keys_so_far: set[str] = set()
        for i, law in enumerate(self.vary):
            if not isinstance(law, Weather) and not law.key:
                raise rule(f"vary[{i}].key", "is missing; name a key of the scenario, e.g. key = 'wind.speed_m_s'")
            for key in law.keys if isinstance(law, Weather) else (law.key or "",):
                if key in keys_so_far:
                    raise rule(f"vary[{i}].key", f"= '{key}' has two laws; leave one of them out", value=key)
                # Laws are applied in order, so a law of a whole table would overwrite an earlier law of a key inside it.
                inner = next((other for other in sorted(keys_so_far) if other.startswith(f"{key}.")), None)
                if inner is not None:
                    raise rule(f"vary[{i}].key", f"= '{key}' would replace what was drawn for {inner}; put it before that law", value=key)
                keys_so_far.add(key)
        names = [template.name for template in self.objects]
        for name in names:
            if names.count(name) > 1:
                raise rule("objects", f"has the name '{name}' twice; give every one a name of its own", value=name)
        return self


def load_ensemble(path: str | Path) -> Ensemble:
    """Read and check an ensemble file without drawing from it.

    Raises
    ------
    ScenarioError
        With one line per mistake, of the file or of its base.
    """
    path = Path(path)
    return parse_ensemble(read_toml(path, "ensemble"), name=str(path), folder=path.parent)


def read_toml(path: Path, what: str) -> TomlTables:
    """Read the tables of a TOML file.

    Raises
    ------
    ScenarioError
        A file that cannot be read, or is no TOML.
    """
    try:
        return tomllib.loads(path.read_bytes().decode("utf-8-sig"))
    except OSError as error:
        raise ScenarioError(f"{path}: cannot be read ({error.strerror}); give the {what}'s TOML file") from None
    except UnicodeDecodeError as error:
        raise ScenarioError(f"{path}: is not UTF-8 text (byte {error.start}); save it as UTF-8") from None
    except (ValueError, RecursionError) as error:
        raise ScenarioError(f"{path}: is not valid TOML: {error}; is the file whole, and is text in quotes?") from None


def parse_ensemble(raw: Mapping[str, Any], *, name: str = "ensemble", folder: Path | None = None) -> Ensemble:
    """Check tables laid out as an ensemble file; ``folder`` is what relative paths count from.

    Raises
    ------
    ScenarioError
        With one line per mistake.
    """
    if "ensemble" not in raw and raw.keys() & _SCENARIO:
        raise ScenarioError(
            f"{name}: is a scenario and no ensemble; write a file of two lines beside it, base = '{Path(name).name}' and "
            "ensemble = { scenes = 100 }, and laws of keys in tables [[vary]]"
        )
    try:
        # The base is validated as a scenario below; here it would be free-form tables.
        ensemble = Ensemble.model_validate({**raw, "base": {}}, context={"base": folder})
    except ValidationError as error:
        lines = dict.fromkeys(_described(detail) for detail in error.errors(include_url=False) if not counts_elements(detail))
        mistakes = tuple(Mistake(key, value, None, text) for key, value, text in lines)
        raise ScenarioError("\n".join(f"{name}: {mistake.text}" for mistake in mistakes), mistakes=mistakes) from None
    ensemble = ensemble.model_copy(update={"base": _base(raw.get("base", {}), ensemble.ensemble.sensor, name, folder)})
    ensemble._name, ensemble._folder = name, folder
    return ensemble


def law_of(raw: object, name: str) -> Uniform | LogUniform | Normal | Choice | None:
    """Return the law that a template's key holds; None where it is a plain value.

    Raises
    ------
    ScenarioError
        A law with a mistake; ``name`` is the key of the law in the message.
    """
    if not isinstance(raw, Mapping) or "law" not in raw:
        return None
    try:
        law: Uniform | LogUniform | Normal | Choice = _LAW.validate_python(dict(raw))
    except ValidationError as error:
        raise ScenarioError(f"{name}.{_described(error.errors(include_url=False)[0])[2]}") from None
    if law.key is not None:
        raise ScenarioError(f"{name}.key = '{law.key}': a law in a table of objects is of the key that it stands at; leave key out")
    return law


def _base(given: object, sensor: str | None, name: str, folder: Path | None) -> TomlTables:
    """Return the tables of the base with absolute paths."""
    paths_from: Path | None
    if isinstance(given, str):
        path = Path(given) if folder is None else folder / given
        raw, where, paths_from = read_toml(path, "base scenario"), str(path), path.parent
        report_moments(raw, where)
    elif isinstance(given, Mapping):
        raw, where, paths_from = dict(given), f"{name}: base", folder
        if (preset := raw.pop("preset", None)) is not None:
            if not isinstance(preset, str) or preset not in PRESETS:
                raise ScenarioError(f"{where}.preset = '{preset}' is not one of {', '.join(PRESETS)}")
            raw = merged(PRESETS[preset].values, raw)
    else:
        raise ScenarioError(f"{name}: base = {given!r} must be the path of a scenario file, in quotes, or a table [base]")
    raw = raw if sensor is None else with_sensor(raw, sensor)
    if "objects" in raw:
        raw = {**raw, "objects": with_names(raw["objects"])}
    return with_absolute_paths(raw, parse_scenario(raw, name=where, base=paths_from))


def merged(below: Mapping[str, Any], above: Mapping[str, Any]) -> TomlTables:
    """Merge two sets of tables, table by table; keys of ``above`` replace keys of ``below``."""
    out = dict(below)
    for key, value in above.items():
        inner = out.get(key)
        out[key] = merged(inner, value) if isinstance(inner, Mapping) and isinstance(value, Mapping) else value
    return out


def with_absolute_paths(raw: Mapping[str, Any], scenario: Scenario) -> TomlTables:
    """Return tables in which every path is absolute, so that they mean the same in any folder."""

    def walk(given: Any, resolved: Any) -> Any:
        if isinstance(resolved, Path) and isinstance(given, str | Path):
            return str(resolved.absolute())
        if isinstance(given, Mapping):
            return {key: walk(value, resolved.get(key) if isinstance(resolved, Mapping) else None) for key, value in given.items()}
        if isinstance(given, list | tuple) and isinstance(resolved, list | tuple) and len(resolved) == len(given):
            return [walk(one, other) for one, other in zip(given, resolved, strict=True)]
        return list(given) if isinstance(given, tuple) else given

    return {key: walk(value, resolved) for (key, value), resolved in zip(raw.items(), map(scenario.model_dump().get, raw), strict=True)}


def _described(error: ErrorDetails) -> tuple[str, Any, str]:
    """Return key, value and text of one mistake."""
    # Pydantic adds the law's name to the location of a mistake in a union; the file has no such level.
    location = tuple(part for part in error["loc"] if part not in _TAGS)
    key = "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in location).lstrip(".")
    kind, given, context = error["type"], error["input"], error.get("ctx", {})
    if kind == "rule":
        at = key if context["key"].startswith(("objects", "vary")) else f"{key}.{context['key']}".lstrip(".")
        return context["key"], context["value"], f"{context['key'] if at == key else at} {error['msg']}"
    if kind == "extra_forbidden":
        # A key of a scenario at the top of the ensemble is misplaced rather than unknown.
        if key in _SCENARIO:
            return key, None, f"{key} is a key of scenarios; put it into the base, [base.{key}] or base.{key} = ..."
        keys = _keys_at(error["loc"])
        near = difflib.get_close_matches(str(location[-1]), keys, n=1, cutoff=0.6)
        return key, None, f"{key} is an unknown key; " + (f"did you mean {near[0]}?" if near else f"allowed here: {', '.join(keys)}")
    if kind == "too_long" or (kind == "missing" and isinstance(location[-1], int)):
        # Of the list of fixed length that there is, a value is missing or too many.
        key, length = key.partition("[")[0], list_length(Dataset.model_fields["split"].annotation)
        return key, None, f"{key} = {given} has {values_text(len(given))} and must have {length}"
    if kind == "missing":
        missing = "a table [ensemble] with the number of scenes, e.g. scenes = 100" if key == "ensemble" else "it to the file"
        return key, None, f"{key} is missing; add {missing}"
    if kind == "tuple_type" and key in ("vary", "objects"):
        return key, None, f"{key} must be a list of tables; write [[{key}]] above each of them"
    if kind == "union_tag_invalid":
        near = difflib.get_close_matches(str(context["tag"]), _TAGS, n=1, cutoff=0.5)
        hint = f"; did you mean '{near[0]}'?" if near else ""
        return f"{key}.law", context["tag"], f"{key}.law = '{context['tag']}' is not one of {', '.join(_TAGS)}{hint}"
    if kind == "union_tag_not_found":
        return f"{key}.law", None, f"{key}.law is missing; add one of {', '.join(_TAGS)}"
    shown = f"'{given}'" if isinstance(given, str) else f"{given}"
    if kind == "tuple_type":
        return key, None, f"{key} = {shown} must be a list in brackets"
    if kind == "too_short":
        return key, None, f"{key} = {shown} is empty; give {context['min_length']} or more"
    if kind in ("model_type", "model_attributes_type", "dict_type"):
        return key, None, f"{key} = {shown} must be a table"
    text = error["msg"] if kind in ("quantity", "missing_file") else f"is not allowed: {error['msg']}"
    return key, None, f"{key} = {shown if len(shown) < 80 else shown[:77] + '...'} {text}"


def _keys_at(location: tuple[int | str, ...]) -> list[str]:
    """Return the keys that are allowed at a location."""
    law = next((_LAWS[str(part)] for part in reversed(location) if part in _LAWS), None)
    if law is not None:
        # a law in a table of objects is of the key that it stands at
        return [key for key in law.model_fields if key != "key" or location[0] == "vary"]
    tables: dict[str, type[Record]] = {"ensemble": EnsembleSettings, "dataset": Dataset}
    table = tables.get(str(location[0]), Ensemble) if len(location) > 1 else Ensemble
    return list(table.model_fields)


_LAWS: Final[Mapping[str, type[Record]]] = {
    "uniform": Uniform,
    "log_uniform": LogUniform,
    "normal": Normal,
    "choice": Choice,
    "weather": Weather,
}
_TAGS: Final = tuple(_LAWS)
#: Tables and keys at the top of a scenario that an ensemble does not have.
_SCENARIO: Final = Scenario.model_fields.keys() - Ensemble.model_fields.keys()
