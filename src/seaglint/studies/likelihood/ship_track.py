"""Glint along a ship's track: its chance at every time, its duration, and the time until it returns."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError
from seaglint.base.free_form import JsonObject, TableRow
from seaglint.base.parameters import documented
from seaglint.climate.draws import SamplingPlan
from seaglint.climate.ephemeris import Ephemeris
from seaglint.climate.weather_table import WeatherTable
from seaglint.climate.world_weather import NAME
from seaglint.formats.weather.weather_cells import TextColumns, read_cells
from seaglint.scenario.model import Scenario
from seaglint.studies.likelihood.draw_model import LikelihoodModel, likelihood_table
from seaglint.studies.likelihood.glint_chance import draw_values, evaluated, uniform_numbers
from seaglint.studies.study_requests import LikelihoodRequest

if TYPE_CHECKING:
    import xarray as xr

SAMPLES: Final = 1024  #: Draws at each time.

_NEEDED: Final = ("time_utc", "latitude_deg", "longitude_deg")
_BEARING: Final = "bearing_deg"


@dataclass(frozen=True)
class TrackChance:
    """Chance of glint at one time of a track."""

    time_utc: str  #: Time in ISO 8601.
    latitude_deg: float  #: Latitude [deg].
    longitude_deg: float  #: Longitude [deg].
    sun_elevation_deg: float  #: Elevation of the Sun [deg].
    threshold_w_m2_sr: float  #: Threshold [W m-2 sr-1].
    probability: float  #: Chance that glint exceeds it [1].


class Spells(NamedTuple):
    """Mean duration of glint and mean time from its end to its return [h]; None without glint, or without a return."""

    mean_duration_hours: float | None
    mean_return_hours: float | None


@dataclass(frozen=True)
class GlintHours:
    """Hours with glint along a track."""

    threshold_w_m2_sr: float  #: Threshold [W m-2 sr-1].
    hours: float  #: Expected time with glint above it [h].
    mean_duration_hours: float | None  #: Mean duration of glint [h]; None without glint.
    mean_return_hours: float | None  #: Mean time from the end of glint to its return [h]; None without a return.


@dataclass(frozen=True)
class TrackChances:
    """Chances of glint along a ship's track."""

    hours: float  #: Length of the track [h].
    results: list[GlintHours]  #: Hours with glint of each threshold.
    way: list[TrackChance]  #: Chances by time and threshold.
    notes: list[str]  #: Remarks.

    def rows(self) -> list[TableRow]:
        """Return the track as a tidy table: a row for each time and threshold."""
        return [asdict(chance) for chance in self.way]

    def as_dict(self) -> JsonObject:
        """Return plain numbers and text."""
        return asdict(self)

    def dataset(self) -> xr.Dataset:
        """Return the track as a dataset: ``probability`` over ``threshold`` and ``time``, places, and hours with glint by threshold."""
        import xarray as xr

        thresholds = [row.threshold_w_m2_sr for row in self.results]
        first = [chance for chance in self.way if chance.threshold_w_m2_sr == thresholds[0]]
        probability = [[chance.probability for chance in self.way if chance.threshold_w_m2_sr == value] for value in thresholds]
        places = ("latitude_deg", "longitude_deg", "sun_elevation_deg")
        spans = ("hours", "mean_duration_hours", "mean_return_hours")
        return xr.Dataset(
            {
                "probability": (("threshold", "time"), probability, {"units": "1", "long_name": "chance that glint exceeds the threshold"}),
                **{name: ("time", [getattr(chance, name) for chance in first], {"units": "degree"}) for name in places},
                **{name: ("threshold", [getattr(row, name) or math.nan for row in self.results], {"units": "h"}) for name in spans},
            },
            {
                "threshold": ("threshold", thresholds, {"units": "W m-2 sr-1"}),
                "time": ("time", np.array([chance.time_utc.removesuffix("Z") for chance in first], "datetime64[ns]")),
            },
            {"title": "Chance of glint along a way", "hours": self.hours, "notes": "\n".join(self.notes)},
        )


@documented(LikelihoodRequest)
def along_track(scenario: Scenario, track: Path, *, samples: int = SAMPLES, weather: WeatherTable | None = None) -> TrackChances:
    """Return chances at the times of a track, with durations and returns of each threshold.

    Parameters
    ----------
    scenario : Scenario
        Scenario with ``[likelihood]``; its own Sun, time and place are not used.
    {request}
    samples : int
        Draws at each time.
    weather : WeatherTable, optional
        Weather that replaces the scenario's.

    Returns
    -------
    TrackChances
        Chances along the track and hours with glint; the same draws of weather and geometry are followed from time to time.

    Raises
    ------
    DataError
        A file that lacks columns, or has times without a zone, unsorted or outside the years of the ephemeris.
    """
    cells = read_cells(track)
    for name in _NEEDED:
        if name not in cells.header:
            raise DataError(f"{track}: column {name} missing; found: {', '.join(cells.header)}; needed: {', '.join(_NEEDED)}")
    time = _times(cells)
    latitude, longitude = _within(cells, "latitude_deg", 90.0), _within(cells, "longitude_deg", 360.0)
    bearing = _within(cells, _BEARING, 360.0) if _BEARING in cells.header else None
    likelihood_table(scenario)  # refused after the file of the track
    model = LikelihoodModel.of(_of_track(scenario, weather), weather)
    sky = Ephemeris.between(float(time[0]), float(time[-1]))
    thresholds = model.settings.threshold_w_m2_sr
    chance = np.empty((time.size, len(thresholds)))
    lit: list[list[FloatArray]] = [[] for _ in thresholds]
    way: list[TrackChance] = []
    plan = SamplingPlan.of(samples)
    # Cached properties of the model are set to each time and place: its tables of air and sea stay.
    model.__dict__.update(when=float(time[0]), where=(0.0, 0.0), ephemeris=sky)
    u = uniform_numbers(model, plan, scenario.seed)
    for i, moment in enumerate(time.tolist()):
        model.__dict__.update(when=moment, where=(float(latitude[i]), float(longitude[i])))
        sun = sky.at(moment, latitude[i], longitude[i])
        look = None if bearing is None else float(np.radians(bearing[i]) - sun.azimuth[0])
        drawn = evaluated(model, u, model.conditions(u), plan, look)
        for t, threshold in enumerate(thresholds):
            values = draw_values(model, drawn, threshold)
            chance[i, t] = values.mean()
            lit[t].append(values)
            way.append(
                TrackChance(
                    time_utc=datetime.fromtimestamp(moment, UTC).isoformat().replace("+00:00", "Z"),
                    latitude_deg=float(latitude[i]),
                    longitude_deg=float(longitude[i]),
                    sun_elevation_deg=90.0 - float(np.degrees(sun.zenith[0])),
                    threshold_w_m2_sr=threshold,
                    probability=float(chance[i, t]),
                )
            )
    step = _steps(time)
    results = [
        GlintHours(threshold, float(chance[:, t] @ step), *spells(np.stack(lit[t], axis=1) > 0.0, step))
        for t, threshold in enumerate(thresholds)
    ]
    return TrackChances(float(step.sum()), results, way, list(model.notes))


def _of_track(scenario: Scenario, weather: WeatherTable | None) -> Scenario:
    """Return the scenario without its own Sun, time and place; the climatology is its weather by default, as all places are known."""
    settings = likelihood_table(scenario)
    update = {"place": None, **({"weather": Path(NAME)} if settings.weather is None and weather is None else {})}
    return scenario.model_copy(update={"sun": None, "time": None, "place": None, "likelihood": settings.model_copy(update=update)})


def spells(glints: np.ndarray, hours: FloatArray) -> Spells:
    """Return the mean duration of glint and the mean time from its end to its return [h], over followed draws [(draws, times)].

    Both are None without glint. Spells cut by an end of the track count with their observed part; only gaps between two spells are returns.

    >>> spells(np.array([[True, False, False, True]]), np.ones(4))
    Spells(mean_duration_hours=1.0, mean_return_hours=2.0)
    """
    # Without glint before and after the track, every spell has a begin and an end.
    change = np.diff(np.pad(glints, ((0, 0), (1, 1))).astype(np.int8), axis=1)
    draws, begin = np.nonzero(change == 1)
    end = np.nonzero(change == -1)[1]
    if begin.size == 0:
        return Spells(None, None)
    clock = np.concatenate([[0.0], np.cumsum(hours)])
    # A gap between spells of two draws is no return.
    again = draws[1:] == draws[:-1]
    gaps = clock[begin[1:]] - clock[end[:-1]]
    return Spells(float(np.mean(clock[end] - clock[begin])), float(np.mean(gaps[again])) if again.any() else None)


def _steps(time: FloatArray) -> FloatArray:
    """Return the hours of each time: half of the distance to its neighbours."""
    gaps = np.diff(time) / 3600.0
    return np.asarray(0.5 * (np.concatenate([gaps[:1], gaps]) + np.concatenate([gaps, gaps[-1:]])))


def _times(cells: TextColumns) -> FloatArray:
    out = []
    for row, text in enumerate(cells.text("time_utc")):
        try:
            moment = datetime.fromisoformat(text.replace("Z", "+00:00"))
        except ValueError:
            raise DataError(f"{cells.where(row)}: time_utc = '{text}' is no time; write it as 2026-06-21T17:30:00Z") from None
        if moment.tzinfo is None:
            raise DataError(f"{cells.where(row)}: time_utc = '{text}' names no zone; write UTC as 2026-06-21T17:30:00Z")
        out.append(moment.timestamp())
        if row and out[-1] <= out[-2]:
            raise DataError(f"{cells.where(row)}: time_utc = '{text}' is not after the row before; sort the rows by time, each time once")
    if len(out) < 2:
        raise DataError(f"{cells.path}: a way needs two times or more")
    return np.array(out)


def _within(cells: TextColumns, name: str, most: float) -> FloatArray:
    values = cells.numbers(name)
    bad = np.flatnonzero(~(np.abs(values) <= most))
    if bad.size:
        raise DataError(f"{cells.where(int(bad[0]))}, column {name}: {values[bad[0]]:g} is outside -{most:g} to {most:g} deg; correct it")
    return values
