"""Ensembles: scenes drawn from the laws of a file, each a scenario of its own, rendered one by one."""

from __future__ import annotations

import copy
import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from seaglint.errors import ScenarioError
from seaglint.pipeline.ensemble_draw import Numbers, Objects, Rows, count_key, quantity_of, sea_seed
from seaglint.pipeline.ensemble_place import Picture
from seaglint.scenario.ensemble import Ensemble, with_absolute_paths
from seaglint.scenario.laws import Weather, value_of
from seaglint.scenario.load import parse_scenario
from seaglint.scenario.model import Scenario
from seaglint.scenario.setting import set_key
from seaglint.scenario.toml_text import document


@dataclass(frozen=True, eq=False)
class Scene:
    """One scene of an ensemble.

    Attributes
    ----------
    number : int
        Counted from 0.
    label : str
        The number with leading zeros, as its files are called.
    scenario : Scenario
        What is rendered.
    tables : dict
        The scenario as a file has it, paths absolute.
    parameters : dict
        What was drawn, by key: numbers in the key's unit.
    objects : tuple of dict
        Tables of the objects drawn for it.
    """

    number: int
    label: str
    scenario: Scenario
    tables: dict[str, Any]
    parameters: dict[str, Any]
    objects: tuple[dict[str, Any], ...]

    @property
    def seed(self) -> int:
        """Of its sea."""
        return self.scenario.seed

    @property
    def text(self) -> str:
        """Its scenario file."""
        return document(self.tables, f"scene {self.number} of an ensemble; 'seaglint render' renders it alone to the same bytes")

    @property
    def row(self) -> dict[str, Any]:
        """Its row of the table of parameters; lists and tables as JSON."""
        drawn = {key: value for key, value in self.parameters.items() if key != "seed"}
        found = {"scene": self.number, "seed": self.seed, **drawn}
        return {key: json.dumps(value) if isinstance(value, list | tuple | Mapping) else value for key, value in found.items()}


def draw(ensemble: Ensemble) -> list[Scene]:
    """All scenes of an ensemble, each checked as a scenario.

    Raises
    ------
    SeaglintError
        The first scene that is no scenario, with the key and what was drawn for it.
    """
    return list(scenes(ensemble))


def scenes(ensemble: Ensemble) -> Iterator[Scene]:
    """Scenes one after the other; see :func:`draw`."""
    settings = ensemble.ensemble
    sampled = [*("weather" if isinstance(law, Weather) else law.key or "" for law in ensemble.vary)]
    sampled += [count_key(template) for template in ensemble.objects if not isinstance(template.count, int)]
    numbers = Numbers(ensemble, tuple(sampled))
    rows = {i: Rows.of(law, f"{ensemble.name}: vary[{i}]") for i, law in enumerate(ensemble.vary) if isinstance(law, Weather)}
    quantities = {law.key: quantity_of(law.key) for law in ensemble.vary if not isinstance(law, Weather) and law.key}
    objects, width = Objects(ensemble, numbers), max(4, len(str(settings.scenes - 1)))
    for number in range(settings.scenes):
        parameters: dict[str, Any] = {}
        for i, law in enumerate(ensemble.vary):
            if isinstance(law, Weather):
                parameters |= rows[i].at(numbers.of("weather", number), numbers.of("weather direction", number))
            else:
                key = law.key or ""
                parameters[key] = value_of(law, numbers.of(key, number), quantities[key], f"{ensemble.name}: vary[{i}] ({key})")
        tables = copy.deepcopy(ensemble.base)
        tables["seed"] = sea_seed(settings.seed, number)
        if settings.frames is not None:
            tables.setdefault("sensor", {})["frames"] = settings.frames
        where = f"{ensemble.name}, scene {number}"
        for key, value in parameters.items():
            set_key(tables, key, list(value) if isinstance(value, tuple) else value, where)
        made: list[dict[str, Any]] = []
        if ensemble.objects:
            # Places in the picture need the sensor, as it is drawn, before there are objects.
            picture = Picture(_checked(ensemble, {k: v for k, v in tables.items() if k != "objects"}, parameters, where))
            taken: list[tuple[float, float]] = []
            for template in ensemble.objects:
                count = objects.count(template, number)
                parameters[count_key(template)] = count
                made += objects.draw(template, count, number, picture, taken)
            if made or "objects" in tables:
                tables["objects"] = [*tables.get("objects", []), *made]
        scenario = _checked(ensemble, tables, parameters, where)
        yield Scene(number, f"{number:0{width}d}", scenario, with_absolute_paths(tables, scenario), parameters, tuple(made))


def _checked(ensemble: Ensemble, tables: Mapping[str, Any], parameters: Mapping[str, Any], where: str) -> Scenario:
    """The scenario of a scene; of its mistakes the first, with what was drawn."""
    try:
        return parse_scenario(tables, name=where, base=ensemble.folder)
    except ScenarioError as error:
        if not error.mistakes:
            raise
        first = error.mistakes[0]
        drawn = parameters.get(first.key)
        told = "" if drawn is None or f"{drawn}" in first.text else f" (drawn: {first.key} = {drawn})"
        if first.key not in parameters and parameters:
            told = f" (drawn: {', '.join(f'{key} = {value}' for key, value in parameters.items())})"
        raise ScenarioError(f"{where}: {first.text}{told}", mistakes=(first,)) from None
