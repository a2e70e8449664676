"""Places of the draws of a scenario, and the climatology of the world's seas there: whether it serves, and its places, airs and winds."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.special import gamma

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError, ScenarioError, SeaglintError
from seaglint.climate.conditions import GeographicRegion
from seaglint.climate.sea_places import SeaPlaces, sea_places
from seaglint.climate.weather_laws import wind_shape
from seaglint.climate.world_weather import FEW, WorldWeather, few_observations, model_atmospheres, world_weather
from seaglint.scenario.model import Scenario
from seaglint.scenario.records.atmosphere_table import TableAtmosphereSettings
from seaglint.scenario.records.likelihood_table import Likelihood

EVERYWHERE: Final = GeographicRegion(-72.0, 80.0, -180.0, 180.0)  #: Region of the climatology.


def likelihood_table(scenario: Scenario) -> Likelihood:
    """Return the scenario's table ``[likelihood]``; a scenario without it is refused."""
    if scenario.likelihood is None:
        raise ScenarioError("likelihood is missing: add a table [likelihood] with weather, threshold_w_m2_sr and case")
    return scenario.likelihood


def place_law(scenario: Scenario) -> GeographicRegion | tuple[float, float] | None:
    """Return the law of the place: ``likelihood.place`` before a region, and a region before ``[place]``; None where none is stated."""
    settings, place = likelihood_table(scenario), scenario.place
    if settings.place is not None:
        return settings.place
    if settings.latitudes_deg is not None and settings.longitudes_deg is not None:
        return GeographicRegion(*settings.latitudes_deg, *settings.longitudes_deg)
    return None if place is None else (place.latitude_deg, place.longitude_deg)


def which_place(scenario: Scenario) -> list[str]:
    """Return a note where several places are stated, of which one is used."""
    settings = likelihood_table(scenario)
    if settings.place is None:
        return []
    others = [
        name
        for name, given in (
            ("[place]", scenario.place is not None),
            ("the region of likelihood.latitudes_deg and longitudes_deg", settings.latitudes_deg is not None),
            ("likelihood.place_from_weather", settings.place_from_weather),
        )
        if given
    ]
    at = f"likelihood.place = [{settings.place[0]:g}, {settings.place[1]:g}]"
    notes = [f"{at} is used instead of {' and '.join(others)}"] if others else []
    if scenario.sun is not None:
        notes.append(f"the Sun is that of [sun]; {at} is the place of the weather alone")
    return notes


@dataclass(frozen=True, eq=False)
class Climatology:
    """Climatology at the places of a scenario. Make it with ``of``."""

    scenario: Scenario  #: Scenario with ``[likelihood]``.
    world: WorldWeather

    @classmethod
    def of(cls, scenario: Scenario) -> Climatology:
        """Return the packaged climatology for a scenario."""
        return cls(scenario, world_weather())

    @cached_property
    def places(self) -> SeaPlaces | tuple[float, float]:
        """Law of the place: the sea of the region, of the globe without one, or the place whose weather serves a stated one [deg].

        Raises
        ------
        DomainError, DataError
            A place far from the sea, or a region without sea; the nearest is named.
        """
        where = place_law(self.scenario)
        if isinstance(where, tuple):
            return self.world.sea_at(*where, self._name)[:2]
        law = sea_places(self.world, where or EVERYWHERE)
        if law is None:
            assert where is not None  # the globe has sea
            middle = 0.5 * (where.south + where.north), where.west + 0.5 * where.width
            north, east, distance = self.world.nearest_sea(*middle)
            raise DataError(
                f"likelihood.latitudes_deg = [{where.south:g}, {where.north:g}], longitudes_deg = [{where.west:g}, {where.east:g}]: no sea "
                f"of the climatology 'world' inside; the nearest is [{north:g}, {east:g}], {1e-3 * distance:.0f} km from the middle"
            )
        return law

    @property
    def _name(self) -> str:
        return "place" if likelihood_table(self.scenario).place is None else "likelihood.place"

    @property
    def months(self) -> tuple[int, ...]:
        """Months of the draws: that of a stated time, those of the scenario, or all."""
        if self.scenario.sun is None and self.scenario.time is not None:
            return (self.scenario.time.utc.month,)
        return likelihood_table(self.scenario).months or tuple(range(1, 13))

    @cached_property
    def _some(self) -> tuple[FloatArray, FloatArray]:
        """Places that stand for all [deg]."""
        if isinstance(self.places, tuple):
            return np.array([self.places[0]]), np.array([self.places[1]])
        return self.places.some

    @property
    def models(self) -> tuple[tuple[str, ...], NDArray[np.int64]]:
        """Model atmospheres that occur there, and the place among them of each model of all."""
        names = [name for name, _ in model_atmospheres()]
        if not isinstance(self.scenario.atmosphere, TableAtmosphereSettings):
            return (self.scenario.atmosphere.source,), np.zeros(len(names), dtype=np.int64)
        # Tables of light cost some seconds for each model: those between the driest and the wettest air suffice.
        there = self.world.at(np.arange(24.0)[:, None] / 2.0, *self._some).model
        first, last = int(there.min()), int(there.max())
        return tuple(names[first : last + 1]), np.clip(np.arange(len(names)) - first, 0, last - first)

    def notes(self, strongest: float) -> list[str]:
        """Return remarks on places, observations and winds above the strongest of the sea's slopes [m/s]."""
        settings, where = likelihood_table(self.scenario), place_law(self.scenario)
        notes: list[str | None] = []
        if settings.weather is None:
            notes.append("likelihood.weather is not given: the climatology 'world', monthly means of ships' observations")
        if settings.smooth:
            notes.append("likelihood.smooth = true has no effect: the climatology 'world' has continuous laws")
        if isinstance(self.places, tuple):
            if isinstance(where, tuple):
                notes.append(self.world.sea_at(*where, self._name)[2])
            notes.append(few_observations(self.world, *self.places, self.months))
        elif where is not None:
            notes.append(self._few_of_region(self.places))
        share = self._share_above(strongest)
        # A track has places and times of its own, and a map shows its observations cell by cell.
        if share > 1e-6 and where is not None:
            notes.append(f"{100 * share:.2g} % of the winds are above {strongest:g} m/s, taken as {strongest:g}")
        return [note for note in notes if note]

    def _few_of_region(self, places: SeaPlaces) -> str | None:
        cells = np.unique(np.stack(self.world.cell_of(*places.middles)), axis=1)
        row, column = cells[:, self.world.sea[cells[0], cells[1]]]
        counts = self.world.observations[np.array(self.months)[:, None] - 1, row, column]
        few = int(np.sum(np.rint(counts) < FEW))
        return f"{few} of {counts.size} months of the region's cells rest on fewer than {FEW} wind observations" if few else None

    def _share_above(self, wind: float) -> float:
        """Share of winds above a speed [m/s], by the laws of the months."""
        north, east = self._some
        mean = self.world.of_month(np.array(self.months)[:, None], north, east).wind_speed_m_s
        shape = wind_shape(north, mean)
        return float(np.mean(np.exp(-((wind / mean * gamma(1.0 + 1.0 / shape)) ** shape))))


def climatology_at(scenario: Scenario) -> Climatology | str:
    """Return the climatology at the places of a scenario, or why it cannot serve where the scenario does not name it."""
    named, climatology = likelihood_table(scenario).of_the_world, Climatology.of(scenario)
    if place_law(scenario) is None and not named:
        return "no place is known"
    try:
        _ = climatology.places
    except SeaglintError as error:
        if named:
            raise
        return str(error)
    return climatology
