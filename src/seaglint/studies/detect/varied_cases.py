"""Cases of a detection study: a scenario with keys set to every combination of some values, or to the rows of a table."""

from __future__ import annotations

import copy
import itertools
import json
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from seaglint.base.errors import DataError
from seaglint.base.free_form import TomlTables
from seaglint.formats.tables.input_tables import read_cases
from seaglint.scenario.changed_scenario import set_key
from seaglint.scenario.load import parse_scenario
from seaglint.scenario.model import Scenario
from seaglint.scenario.presets import with_sensor
from seaglint.scenario.text.option_texts import parse_vary, plain_value
from seaglint.scenario.text.toml_writing import stated

MOST_CASES: Final = 1000  #: Largest number of cases of one study.

STUDY_KEYS: Final = ("detector", "filter", "threshold")  #: Settings of a case in addition to keys of the scenario.


@dataclass(frozen=True)
class StudyCase:
    """One scenario of a study."""

    parameters: TomlTables  #: Keys that were set, with their values.
    scenario: Scenario  #: Scenario with these values.
    study: TomlTables  #: Parameters in ``STUDY_KEYS``, which are no keys of the scenario.


def cases_of(
    source: Path | Scenario, *, vary: Sequence[str] | Mapping[str, Sequence[Any]] = (), table: Path | None = None, sensor: str | None = None
) -> list[StudyCase]:
    """Return all cases of a scenario; the unchanged scenario is a single case.

    Parameters
    ----------
    source : Path or Scenario
        TOML file, or a scenario that is loaded.
    vary : sequence of str, or mapping
        ``key=value,value`` or ``key=START:STOP:STEP``, or values by key; several are combined.
    table : Path, optional
        CSV file with keys as headings and a case in each row; empty cells leave the scenario unchanged.
    sensor : str, optional
        Preset that replaces its sensor.

    Raises
    ------
    ScenarioError
        A case that is no scenario, named with its values.
    DataError
        Too many cases, or a table that cannot be read.
    """
    from seaglint.scenario.load import load_scenario

    if isinstance(source, Scenario):
        path, base, raw = "scenario", None, stated(source)
    else:
        load_scenario(source, sensor=sensor)  # mistakes of the file itself are reported with its own keys
        path, base, raw = str(source), source.parent, tomllib.loads(source.read_bytes().decode("utf-8-sig"))
    raw = raw if sensor is None else with_sensor(raw, sensor)
    rows = _rows(table) if table is not None else [({}, "")]
    varied = [(key, list(values)) for key, values in vary.items()] if isinstance(vary, Mapping) else parse_vary(vary)
    combined = list(itertools.product(*[[(key, value) for value in values] for key, values in varied]))
    if len(rows) * len(combined) > MOST_CASES:
        raise DataError(f"{len(rows) * len(combined)} cases are more than {MOST_CASES}; vary less, or part the study")
    out = []
    # Every row of the table with every combination of the varied values.
    for (row, where), chosen in itertools.product(rows, combined):
        parameters = {**row, **dict(chosen)}
        study = {key: parameters[key] for key in STUDY_KEYS if key in parameters}
        parameters = with_names(parameters)
        changed = copy.deepcopy(raw)
        named = ", ".join(f"{key} = {value}" for key, value in parameters.items())
        name = f"{path}{where}" + (f" with {named}" if named else "")
        for key, value in parameters.items():
            if key not in STUDY_KEYS:
                set_key(changed, key, value, name)
        out.append(StudyCase(parameters, parse_scenario(changed, name=name, base=base), study))
    return out


def with_names(parameters: TomlTables) -> TomlTables:
    """Return the parameters of a case with a detector that is an object by its name."""
    detector = parameters.get("detector")
    return parameters if detector is None or isinstance(detector, str) else {**parameters, "detector": getattr(detector, "name", detector)}


def _rows(table: Path) -> list[tuple[TomlTables, str]]:
    cases = read_cases(table)
    cells = [cases.text(name) for name in cases.header]
    rows = [{name: plain_value(cells[i][k]) for i, name in enumerate(cases.header) if cells[i][k]} for k in range(len(cases))]
    return [(row, f" (row {k} of {table})") for k, row in enumerate(rows, start=1)]


def flattened(scenario: Scenario) -> TomlTables:
    """Return every value of a scenario by its dotted key; lists as JSON.

    Examples
    --------
    >>> flattened(parse_scenario({"wind": {"speed_m_s": 4.0}}))["wind.speed_m_s"]
    4.0
    """
    out: TomlTables = {}

    def walk(value: Any, key: str) -> None:
        if isinstance(value, dict):
            for name, inner in value.items():
                walk(inner, f"{key}.{name}" if key else name)
        else:
            out[key] = json.dumps(value) if isinstance(value, list) else value

    walk(json.loads(scenario.model_dump_json(exclude_none=True)), "")
    return out
