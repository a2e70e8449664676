"""Output of ``seaglint init`` and ``seaglint schema``: the commented scenario and its JSON Schema, both derived from the models."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, Final

from pydantic import BaseModel

from seaglint.base.errors import DataError, ScenarioError, StorageError
from seaglint.base.free_form import JsonObject
from seaglint.scenario.camera import CameraTables, with_camera
from seaglint.scenario.keys import Key, choices_of_kind, fields_of, is_list, tag_name, tags
from seaglint.scenario.model import Scenario
from seaglint.scenario.presets import PRESETS, Preset
from seaglint.scenario.records.sensor_table import Sensor
from seaglint.scenario.text.toml_writing import inline

DATA: Final = Path(__file__).parents[1] / "data"  #: Folder of the files that presets name.

__all__ = ["PRESETS", "json_schema", "template", "write_template"]

_HEADER = """\
# Numbers are in the unit at the end of their key; text with another unit is taken too: "12 kn", "30 ft", "15 degC".
# Azimuths are clockwise from north, winds come FROM their azimuth, elevations are above the horizontal (looking down is negative).
# Every key may be left out. 'seaglint schema' prints all of them as JSON Schema.
"""

_EXAMPLES = {
    "time": "2026-06-21T17:30:00Z",
    "min_um": "3.5",
    "max_um": "5.0",
    "response": '"response.csv"',
    "utc": "2026-06-21T17:30:00Z",
    "latitude_deg": "36.8",
    "longitude_deg": "-75.9",
    "step_m": "0.5",
    "sounding": '"sounding.csv"',
    "site": '"1"',
    "from_deg": "270",
    "spreading_deg": "30",
    "visibility_km": "20",
    "wind_24h_m_s": "7.0",
    "track": '"track.csv"',
    "path": '"hull.stl"',
    "aperture_m": "0.01375",
    "f_number": "2.0",
    "focal_length_m": "0.0275",
    "ifov_urad": "545.4",
    "pitch_um": "15.0",
    "quantum_efficiency_file": '"qe.csv"',
    "corrected_at_k": "[288, 308]",
    "cold_shield_f_number": "2.0",
    "integration_time_s": "0.003",
    "short_integration_time_s": "0.0003",
    "well_capacity_e": "7.2e6",
    "gain_e_per_count": "440",
    "netd_k": "0.05",
    "period_s": "0.04",
    "heading_deg": "90",
    "keyframes": "[{ time_s = 0, east_m = 0, north_m = 0, height_m = 30, azimuth_deg = 180, elevation_deg = -3.5, roll_deg = 5 }, "
    "{ time_s = 4, east_m = 20, north_m = 0, height_m = 30, azimuth_deg = 180, elevation_deg = -3.5, roll_deg = -5 }]",
}

#: Keys of one table in each list of tables.
_IN_LISTS = {
    "name": '"ferry"',
    "preset": '"fishing-vessel"',
    "temperature_k": "293",
    "emissivity": "0.95",
    "radius_m": "2.0",
    "semi_axes_m": "[1, 4, 1]",
    "size_m": "[4, 20, 3]",
    "length_m": "10",
    "co2_share": "0.05",
    "h2o_share": "0.05",
    "parts": '[{ kind = "box", size_m = [2, 2, 2] }, { kind = "sphere", radius_m = 1.2 }]',
    "intensity_w_sr": "50",
    "temperature_difference_k": "5",
    "area_m2": "1",
    "east_m": "500",
    "north_m": "-2000",
    "height_m": "1.5",
    "latitude_deg": "36.79",
    "longitude_deg": "-75.89",
    "draught_m": "1",
    "heading_deg": "90",
    "pitch_deg": "0",
    "roll_deg": "0",
    "course_deg": "90",
    "speed_m_s": '"12 kn"',
    "track": '"ferry.csv"',
    "floats": "true",
    "keyframes": "[{ time_s = 0, east_m = 0, north_m = -2000, height_m = 40, latitude_deg = ..., longitude_deg = ... }, "
    "{ time_s = 4, east_m = 200, north_m = -2000, height_m = 50, heading_deg = 80, pitch_deg = 5, roll_deg = -10 }]",
}


def json_schema() -> JsonObject:
    """Return the JSON Schema of scenario files, for editors and other programs."""
    schema = Scenario.model_json_schema(mode="validation")
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema, "title": "seaglint scenario"}


def template(preset: str = "glint", camera: CameraTables | None = None) -> str:
    """Return the commented TOML text of a preset, with a camera in place of its sensor where one is given.

    Raises
    ------
    ScenarioError
        For a name that is no preset, or a camera that cannot be.
    """
    try:
        chosen = PRESETS[preset]
    except KeyError:
        raise ScenarioError(f"preset='{preset}' is not one of {', '.join(PRESETS)}") from None
    if camera is not None:
        values = with_camera(chosen.values, camera)
        chosen = replace(chosen, values=values, notes=(*chosen.notes, *(f"Camera: {line}." for line in camera.assumed)))
    return "\n".join(_lines(chosen)) + "\n"


def write_template(output: str | Path, preset: str = "glint", *, camera: CameraTables | None = None, overwrite: bool = False) -> Path:
    """Write the commented scenario of a preset, with a camera in place of its sensor where one is given, and beside it the preset's files.

    A file that is there already stays.

    Raises
    ------
    DataError
        The file exists.
    StorageError
        It cannot be written.
    """
    output, text = Path(output), template(preset, camera)
    try:
        if output.exists() and not overwrite:
            raise DataError(f"{output}: exists already; choose another name, or replace it with overwrite=True")
        for name in PRESETS[preset].files:
            copy = output.with_name(name)
            if not copy.exists():
                copy.write_bytes((DATA / name).read_bytes())
        output.write_text(text, encoding="utf-8")
    except OSError as error:
        raise StorageError(f"{output}: cannot be written: {error.strerror}; choose another place") from error
    return output


def _lines(preset: Preset) -> Iterator[str]:
    yield f"# seaglint scenario: {preset.title}"
    yield from (f"# {line}" for line in preset.notes)
    yield from _HEADER.splitlines()
    yield ""
    yield from _table(Scenario.model_validate(preset.values, context={"files": False}), ())


def _table(record: BaseModel, path: tuple[str, ...]) -> Iterator[str]:
    """Return the lines of a table: plain keys first, then the tables inside, as TOML requires."""
    keys = list(fields_of(type(record), path))
    # TOML requires plain keys before the tables of a table.
    plain = [key for key in keys if not key.records or isinstance(getattr(record, key.path[-1]), tuple)]
    for key in plain:
        # A field of view that follows from the optics is written as a comment, else it would conflict after a change.
        follows = key.path == ("sensor", "fov_deg") and isinstance(record, Sensor) and record.fov_follows
        yield ("# " if follows else "") + _entry(key, getattr(record, key.path[-1]))
    for key in keys:
        if key not in plain:
            yield ""
            yield from _list(key) if is_list(key.info.annotation) and not path else _section(key, getattr(record, key.path[-1]))


def _list(key: Key) -> Iterator[str]:
    """Yield one example table of a list as a comment, indented because removing a comment sign does not make it valid."""
    record = key.records[0]
    yield f"#   [[{'.'.join(key.path)}]]  # {_first_line(record)}"
    for inner in fields_of(record, key.path):
        # A union is shown with one line per kind.
        kinds = [kind for kind in inner.records if "kind" in kind.model_fields]
        if kinds:
            yield from (_kind(inner.path[-1], kind) for kind in kinds)
        else:
            default = None if inner.info.is_required() or inner.path[-1] in _IN_LISTS else inner.info.default
            yield f"#   {_entry(inner, default, _IN_LISTS).removeprefix('# ')}"


def _kind(name: str, record: type[BaseModel]) -> str:
    """Return a table in one line, with all keys of its kind."""
    tag = next(iter(record.model_fields.values())).default
    given = [f'kind = "{tag}"']
    for key in fields_of(record):
        default = key.info.default
        if key.path[-1] != "kind":
            shown = default is not None and not isinstance(default, BaseModel) and not key.info.is_required()
            given.append(
                f"{key.path[-1]} = {inline(default) if shown else _IN_LISTS.get(key.path[-1], _EXAMPLES.get(key.path[-1], '...'))}"
            )
    return f"#   {name} = {{ {', '.join(given)} }}  # {_first_line(record)}"


def _section(key: Key, value: BaseModel | None) -> Iterator[str]:
    name = ".".join(key.path)
    if value is not None:
        yield f"[{name}]  # {_first_line(type(value))}"
        yield from _table(value, key.path)
        return
    first, *others = key.records
    yield f"# [{name}]  # {_first_line(first)}"
    for inner in fields_of(first, key.path):
        yield _commented(inner)
    for kind, other in zip(tags(key.path)[1:], others, strict=False):
        yield f'# with {tag_name(key.path)} = "{kind}" instead: {_first_line(other)}'
        yield from (_commented(inner) for inner in fields_of(other, key.path) if inner.path[-1] not in first.model_fields)


def _commented(key: Key) -> str:
    """Return the line of a key that is not in force, with its default where it has one."""
    default = key.info.get_default()
    shown = not key.info.is_required() and default is not None and not isinstance(default, BaseModel)
    return f"# {_entry(key, default if shown else None).removeprefix('# ')}"


def _first_line(record: type[BaseModel]) -> str:
    return (record.__doc__ or "").strip().splitlines()[0].rstrip(".").replace("``", "")


def _entry(key: Key, value: Any, examples: Mapping[str, str] = _EXAMPLES) -> str:
    name = key.path[-1]
    note = "; ".join(part for part in (key.info.description or "", choices_of_kind(key) or key.allowed) if part)
    comment = f"  # {note}" if note else ""
    if value is None:
        return f"# {name} = {examples.get(name, '...')}{comment}"
    return f"{name} = {inline(value)}{comment}"
