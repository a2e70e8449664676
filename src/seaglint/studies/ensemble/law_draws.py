"""Draws of an ensemble: uniform numbers, and the values that its laws give to keys, weather and objects, scene by scene.

Objects may be placed by pixel of the first frame; ``PixelGrid`` gives their place on or above the sea.
"""

from __future__ import annotations

import json
import logging
import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Final

import numpy as np

from seaglint.base.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError, ScenarioError
from seaglint.base.free_form import TableRow, TomlTables
from seaglint.base.random import stream
from seaglint.climate.weather_table import TEXTS, WeatherTable
from seaglint.climate.world_weather import world_weather
from seaglint.formats.weather.weather_file import NORTH_ATLANTIC, is_world, read_weather
from seaglint.imaging.camera.imager import Imager
from seaglint.imaging.camera.pose import Pose
from seaglint.scenario.ensemble_file import COUNT, Ensemble, Template, law_of
from seaglint.scenario.keys import quantity_of
from seaglint.scenario.model import Scenario
from seaglint.scenario.records.ensemble_tables import Choice, LogUniform, Normal, Uniform, Weather, in_unit, value_of
from seaglint.scenario.records.quantities import Quantity
from seaglint.scenario.records.small_tables import Place, Time
from seaglint.scenario.text.toml_writing import document
from seaglint.studies.build import scenario_physics
from seaglint.studies.sequence.render_sequence import Sequence, prepare_sequence
from seaglint.studies.sequence.sensed_sequence import SensedSequence, prepare_sensed
from seaglint.studies.sequence.sequence_work import SceneCache

_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class PixelGrid:
    """Grid of pixels of the first frame: from a place in it to a place on or above the sea."""

    scenario: Scenario  #: Scenario with the sensor.

    @cached_property
    def pose(self) -> Pose:
        """Pose of the sensor at the first frame; a floating sensor at rest."""
        return scenario_physics.track(self.scenario).at(0.0)

    @cached_property
    def pixels(self) -> Imager:
        """Pixel model of the camera."""
        return scenario_physics.imager(self.scenario)

    def place(
        self, column: float, row: float | None, *, range_m: float | None = None, height: float | None = None
    ) -> tuple[float, float, float]:
        r"""Return east, north and height [m] of a place in the first frame.

        .. math:: (R' + h)\,\cos(\epsilon + s/R') = (R' + h_0)\,\cos\epsilon

        along a line of sight of elevation epsilon from the sensor at h0, with the arc s along the sea.

        Parameters
        ----------
        column, row : float
            Pixels from the left and upper edges; without a row the middle one gives the azimuth.
        range_m : float, optional
            Arc along the sea [m].
        height : float, optional
            Height above the mean sea [m].

        Raises
        ------
        ScenarioError
            A line of sight that does not come to that height, or is under the sea at that range.
        """
        east, north, up = (
            float(v) for v in self.pixels.directions(self.pose.attitude, column, 0.5 * self.pixels.rows if row is None else row)
        )
        elevation, eye = math.atan2(up, math.hypot(east, north)), EFFECTIVE_EARTH_RADIUS + self.pose.height
        if row is None:
            assert range_m is not None  # the template has two of row, range_m and height
            arc, height_m = range_m, height or 0.0
        elif range_m is None:
            arc, height_m = self._arc(elevation, height or 0.0, row), height or 0.0
        else:
            arc = range_m
            height_m = eye * math.cos(elevation) / math.cos(elevation + arc / EFFECTIVE_EARTH_RADIUS) - EFFECTIVE_EARTH_RADIUS
            if height_m <= 0.0:
                raise ScenarioError(
                    f"row = {row:.6g} looks {-height_m:.4g} m under the sea at range_m = {range_m:.6g}; give a lesser range_m, or a "
                    "height_m instead of one of the two"
                )
        # The line of sight stays in its vertical plane: the arc is divided like the horizontal part of its direction.
        level = math.hypot(east, north)
        return self.pose.east + arc * east / level, self.pose.north + arc * north / level, height_m

    def _arc(self, elevation: float, height: float, row: float) -> float:
        """Return the arc to the place at which a line of sight first reaches a height [m]."""
        cosine = (EFFECTIVE_EARTH_RADIUS + self.pose.height) * math.cos(elevation) / (EFFECTIVE_EARTH_RADIUS + height)
        falls = self.pose.height > height
        if cosine > 1.0 or (falls and elevation >= 0.0) or (not falls and elevation <= 0.0):
            raise ScenarioError(
                f"row = {row:.6g} looks {math.degrees(elevation):+.4g} deg from the horizontal, which never comes to height_m = {height:g} "
                f"from {self.pose.height:g} m; give rows that do, or range_m instead of row"
            )
        # Two places have that height; the first is on the side from which the line comes.
        angle = math.acos(cosine)
        return EFFECTIVE_EARTH_RADIUS * ((-angle if falls else angle) - elevation)


MOST_TRIES: Final = 200  #: Number of draws of a place after which objects count as too many for their distance.

_SEED_BITS: Final = 53  #: Bits of the seeds of seas: whole numbers that every reader of tables keeps.

SingleLaw = Uniform | LogUniform | Normal | Choice


@dataclass(frozen=True, eq=False)
class EnsembleScene:
    """One scene of an ensemble."""

    number: int  #: Number, counted from 0.
    label: str  #: Number with leading zeros, the name of its files.
    scenario: Scenario  #: Scenario that is rendered.
    tables: TomlTables  #: Tables of the scenario's file, paths absolute.
    parameters: TableRow  #: Drawn values by key: numbers in the key's unit.
    objects: tuple[TomlTables, ...]  #: Tables of the objects drawn for it.

    @property
    def seed(self) -> int:
        """Seed of the scene's sea."""
        return self.scenario.seed

    @property
    def text(self) -> str:
        """Text of its scenario file."""
        return document(self.tables, f"scene {self.number} of an ensemble; 'seaglint render' renders it alone to the same bytes")

    @property
    def row(self) -> TableRow:
        """Row of the table of parameters; lists and tables as JSON."""
        columns = {"scene": self.number, "seed": self.seed, **{k: v for k, v in self.parameters.items() if k != "seed"}}
        return {key: json.dumps(value) if isinstance(value, list | tuple | Mapping) else value for key, value in columns.items()}


def sea_seed(seed: int, number: int) -> int:
    """Return the seed of a scene's sea."""
    return int(stream(seed, "ensemble sea", number).integers(2**_SEED_BITS))


@dataclass(frozen=True, eq=False)
class UniformNumbers:
    """Uniform numbers of all scenes, by key [(scenes,) each]; each a function of seed, scene and key."""

    ensemble: Ensemble  #: Ensemble with the settings of the draws.
    keys: tuple[str, ...]  #: Keys whose draws are spread over the scenes by ``sampling``.

    @cached_property
    def _points(self) -> Mapping[str, FloatArray]:
        settings, scenes = self.ensemble.ensemble, self.ensemble.ensemble.scenes
        if settings.sampling == "random" or not self.keys:
            return {}
        from scipy.stats import qmc

        if settings.sampling == "latin_hypercube":
            # Columns of a Latin hypercube are independent: one by one, a further key leaves the others as they were.
            return {
                key: qmc.LatinHypercube(1, rng=stream(settings.seed, f"ensemble hypercube {key}")).random(scenes)[:, 0] for key in self.keys
            }
        exponent = max(scenes - 1, 1).bit_length()
        points = qmc.Sobol(len(self.keys), scramble=True, rng=stream(settings.seed, "ensemble sobol")).random_base2(exponent)
        return {key: points[:scenes, i] for i, key in enumerate(self.keys)}

    def of(self, key: str, scene: int, *more: int) -> float:
        """Return the number of a key in a scene; ``more`` counts tries."""
        points = self._points.get(key)
        return float(stream(self.ensemble.ensemble.seed, f"ensemble {key}", scene, *more).random() if points is None else points[scene])


@dataclass(frozen=True, eq=False)
class WeatherRows:
    """A weather table from which rows are drawn whole."""

    law: Weather  #: Columns and their keys.
    table: WeatherTable  #: Rows that can be drawn, in the order of the wind.

    @classmethod
    def of(cls, law: Weather, name: str, base: TomlTables | None = None) -> WeatherRows:
        """Read the table of a law and leave out rows that cannot be drawn; the climatology has rows at place and month of the base.

        Raises
        ------
        SeaglintError
            A file that cannot be read, or a table without a usable row.
        """
        source = law.table or Path(NORTH_ATLANTIC)
        try:
            table = _rows_of_world(base or {}) if is_world(source) else read_weather(source).table
            needed = [own for column in law.columns if column != "wind_from_deg" for own in _OF_COLUMN.get(column, (column,))]
            if lacking := [column for column in needed if column not in table]:
                raise DomainError(f"it has no column {', '.join(lacking)}; leave that out of columns")
            table, _ = table.complete(needed or ["weight"])
            if law.max_wind_m_s is not None:
                calm = table["wind_speed_m_s"] <= law.max_wind_m_s
                if not calm.any():
                    raise DomainError(f"no row has a wind up to max_wind_m_s = {law.max_wind_m_s:g}; give a greater one")
                table = table.take(calm)
            # neighbouring numbers give neighbouring rows: so a Latin hypercube or Sobol points spread over the winds
            return cls(law, table.ordered("wind_speed_m_s"))
        except DomainError as error:
            raise ScenarioError(f"{name}: {source}: {error}") from None

    def at(self, uniform: float, direction: float) -> TomlTables:
        """Return keys and values of a row; ``direction`` is a uniform number for a wind whose direction is missing."""
        # Below 1, so that the last row is drawn for it.
        row = int(self.table.draw(np.array([min(uniform, 1.0 - 2.0**-53)]))[0])
        out: TomlTables = {}
        for column, key in zip(self.law.columns, self.law.keys, strict=True):
            if column in TEXTS:
                out[key] = str(self.table.text(column)[row])
                continue
            if column == AIR_MINUS_SEA:
                out[key] = float(self.table["air_temperature_k"][row] - self.table["sea_temperature_k"][row])
                continue
            value = float(self.table[column][row])
            out[key] = 360.0 * direction if column == "wind_from_deg" and math.isnan(value) else value
        return out


AIR_MINUS_SEA: Final = "air_minus_sea_k"  #: Column that follows from the temperatures of air and sea.

_OF_COLUMN: Final = {AIR_MINUS_SEA: ("air_temperature_k", "sea_temperature_k")}  #: Columns that others follow from.


def _rows_of_world(base: TomlTables) -> WeatherTable:
    """Return rows of the climatology at the base's place, in the month of its time; in all months without a time."""
    place, time = base.get("place"), base.get("time")
    if not isinstance(place, Mapping) or not {"latitude_deg", "longitude_deg"} <= set(place):
        raise DomainError("the climatology needs the place: add [place] latitude_deg, longitude_deg to the base")
    where, world = Place.model_validate(place), world_weather()
    north, east, other = world.sea_at(where.latitude_deg, where.longitude_deg, "[place]")
    if other:
        _log.warning("seaglint: %s", other)
    moment = time.get("utc") if isinstance(time, Mapping) else None
    months = () if moment is None else (Time.model_validate({"utc": moment}).utc.month,)
    return world.table(north, east, months)


@dataclass(frozen=True, eq=False)
class DrawnObjects:
    """Objects of a scene, drawn from templates: names, places and values."""

    ensemble: Ensemble  #: Templates and laws.
    numbers: UniformNumbers  #: Uniform numbers of the draws.

    def count(self, template: Template, scene: int) -> int:
        """Return the number of objects of a template."""
        law, where = template.count, f"{self.ensemble.name}: objects ('{template.name}').count"
        if isinstance(law, int):
            return law
        value = value_of(law, self.numbers.of(count_key(template), scene), COUNT, where)
        try:
            return int(COUNT.parse(value))
        except Exception as error:
            raise ScenarioError(f"{where} = {value} {error} (scene {scene})") from None

    def draw(self, template: Template, count: int, scene: int, picture: PixelGrid, taken: list[tuple[float, float]]) -> list[TomlTables]:
        """Return the tables of a template's objects; their places in the picture are added to ``taken``."""
        out = []
        for i in range(1, count + 1):
            name = f"{template.name}-{i}"
            item = {"name": name, **self._drawn(template.others, f"objects.{name}", scene)}
            if template.column is not None:
                item |= self._placed(template, name, item, scene, picture, taken)
            out.append(item)
        return out

    def _placed(
        self, template: Template, name: str, item: Mapping[str, Any], scene: int, picture: PixelGrid, taken: list[tuple[float, float]]
    ) -> TomlTables:
        height = item.get("height_m")
        height = None if height is None else in_unit(height, quantity_of("objects.0.height_m"))
        for tried in range(MOST_TRIES):
            column, row, arc = (
                self._value(getattr(template, key), f"objects.{name}.{key}", scene, tried, _METRES if key == "range_m" else _PIXELS)
                for key in ("column", "row", "range_m")
            )
            at = (float(column), float(row) if row is not None else math.inf)
            if template.apart_px and any(math.dist(at, other) < template.apart_px for other in taken if math.isfinite(other[1])):
                continue
            try:
                east, north, up = picture.place(column, row, range_m=arc, height=height)
            except ScenarioError as error:
                raise ScenarioError(f"{self.ensemble.name}, scene {scene}: objects ('{name}'): {error}") from None
            taken.append(at)
            position = {"east_m": east, "north_m": north}
            return position if "height_m" in item or "draught_m" in item or item.get("floats") is True else {**position, "height_m": up}
        raise ScenarioError(
            f"{self.ensemble.name}, scene {scene}: objects ('{name}'): no place {template.apart_px:g} px from the others in {MOST_TRIES} "
            "draws; draw fewer, or give a lesser apart_px"
        )

    def _drawn(self, raw: Any, key: str, scene: int) -> Any:
        """Return the tables with their laws drawn."""
        law = law_of(raw, f"{self.ensemble.name}: {key}") if isinstance(raw, Mapping) else None
        if law is not None:
            return self._value(law, key, scene, 0, quantity_of(key))
        if isinstance(raw, Mapping):
            return {name: self._drawn(value, f"{key}.{name}", scene) for name, value in raw.items()}
        if isinstance(raw, list):
            return [self._drawn(value, f"{key}.{i}", scene) for i, value in enumerate(raw)]
        return raw

    def _value(self, law: Any, key: str, scene: int, tried: int, quantity: Quantity | None) -> Any:
        if isinstance(law, SingleLaw):
            more = (tried,) if tried else ()
            return value_of(law, self.numbers.of(key, scene, *more), quantity, f"{self.ensemble.name}: {key}")
        if isinstance(law, str) and quantity is not None:
            return in_unit(law, quantity)
        return law


_PIXELS: Final = Quantity()
_METRES: Final = Quantity("m", ge=0)


def count_key(template: Template) -> str:
    """Return the column of a template's number of objects."""
    return f"objects.{template.name}.count"


def prepared(scenario: Scenario, cached: SceneCache) -> SensedSequence | Sequence:
    """Return the prepared sequence of a scenario, with its sensor if it has one; tables are shared through ``cached``."""
    return prepare_sensed(scenario, cached=cached) if scenario.sensor.senses else prepare_sequence(scenario, cached=cached)
