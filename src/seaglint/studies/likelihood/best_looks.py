"""Directions with the least glint: its chance by bearing, depression and hour at one place and date, over the weather of the date."""

from __future__ import annotations

import math
from datetime import UTC, datetime
from typing import Final

import numpy as np

from seaglint.base.conventions import FloatArray, Progress, horizon_depression
from seaglint.base.errors import DataError, ScenarioError
from seaglint.base.parameters import documented
from seaglint.climate.draws import SamplingPlan
from seaglint.climate.ephemeris import Ephemeris
from seaglint.climate.look_chances import BEARINGS, NO_LIGHT, BestLooks
from seaglint.climate.weather_table import WeatherTable
from seaglint.scenario.model import Scenario
from seaglint.scenario.records.quantities import YEARS
from seaglint.studies.likelihood.climatology import likelihood_table
from seaglint.studies.likelihood.draw_model import LikelihoodModel, require_no_moon
from seaglint.studies.likelihood.glint_chance import draw_values, evaluated, uniform_numbers
from seaglint.studies.study_requests import LikelihoodRequest

SAMPLES: Final = 1024  #: Draws of weather, the same in every direction and hour: chances within 0.005.

DEPRESSIONS: Final = 7  #: Number of depressions, even over the scenario's range.

_ABOVE_HORIZON: Final = math.radians(0.01)  #: Least depression below the horizon [rad]; looks at the sky have no glint and are no advice.


@documented(LikelihoodRequest)
def best_looks(
    scenario: Scenario,
    *,
    date: str | None = None,
    samples: int = SAMPLES,
    weather: WeatherTable | None = None,
    progress: Progress | None = None,
) -> BestLooks:
    """Return the chance of glint by bearing, depression and hour at the scenario's place, over the weather of the date.

    The climatology has the date's weather, a table that of its month.

    Parameters
    ----------
    scenario : Scenario
        Scenario with ``[likelihood]`` and one place.
    {request}
    samples : int
        Draws of weather, rounded up to a power of two.
    weather : WeatherTable, optional
        Weather that replaces the scenario's.
    progress : callable, optional
        Called with (hours done, hours in all).

    Returns
    -------
    BestLooks
        Chances at the full hours (UTC) of the date while the Sun is up.

    Raises
    ------
    ScenarioError
        No place or no date, looks of a table, detection instead of glint, or depressions above the horizon.
    DataError
        A text that is no date.

    Notes
    -----
    All directions and hours share their draws of weather, so that they differ by direction and Sun alone. The case of the scenario says
    what a look is: of a trajectory or a field of view all depressions are one look.
    """
    settings = likelihood_table(scenario)
    require_no_moon(scenario, "the search for the best look")
    if settings.looks is not None:
        raise ScenarioError("likelihood.looks has directions, and the best look is searched among all; leave it out")
    if settings.quantity == "detection":
        raise ScenarioError("likelihood.quantity is 'detection', for which no look has the least glint; give another one, e.g. 'mean'")
    begin = _midnight(scenario, date)
    changed = {"sun": None, "time": None, "likelihood": settings.model_copy(update={"months": (begin.month,)})}
    model = LikelihoodModel.of(scenario.model_copy(update=changed), weather)
    place = model.where
    if not isinstance(place, tuple):
        raise ScenarioError("place is missing: the best look is searched at one place; add likelihood.place or [place]")
    midnight = begin.timestamp()
    sky = Ephemeris.between(midnight, midnight + 86_400.0)
    hours = np.arange(24.0)
    sun = sky.at(midnight + 3600.0 * hours, *place)
    first, last = settings.hours_utc
    counts = (hours >= first) & (hours <= last) if first <= last else (hours >= first) | (hours <= last)
    up = np.flatnonzero((sun.zenith < 0.5 * math.pi) & counts)
    depression = _depressions(model)
    model.__dict__.update(when=midnight, ephemeris=sky)
    plan = SamplingPlan(1, 2 ** max(math.ceil(math.log2(samples)), 0))
    cells = depression.size * BEARINGS.size
    u = {name: np.tile(values, cells) for name, values in uniform_numbers(model, plan, scenario.seed).items()}
    low, high = model.depression
    share = (np.radians(depression) - low) / (high - low) if high > low else np.zeros(depression.size)
    u["depression"] = np.repeat(np.nan_to_num(share), BEARINGS.size * plan.total)
    bearing = np.radians(np.tile(np.repeat(BEARINGS, plan.total), depression.size))
    out = np.empty((len(settings.threshold_w_m2_sr), up.size, depression.size, BEARINGS.size))
    report = progress or (lambda done, total: None)
    for i, hour in enumerate(up.tolist()):
        report(i, up.size)
        # The cached time of the model is that of the hour: its tables of air and sea stay.
        model.__dict__["when"] = midnight + 3600.0 * hour
        drawn = evaluated(model, u, model.conditions(u), SamplingPlan(1, u["row"].size), bearing - float(sun.azimuth[hour]))
        for t, threshold in enumerate(settings.threshold_w_m2_sr):
            out[t, i] = draw_values(model, drawn, threshold).reshape(*out.shape[2:], plan.total).mean(axis=2)
    report(up.size, up.size)
    return BestLooks(
        date=begin.date().isoformat(),
        latitude_deg=place[0],
        longitude_deg=place[1],
        case=settings.case,
        thresholds=settings.threshold_w_m2_sr,
        hour_utc=hours[up],
        sun_elevation_deg=90.0 - np.degrees(sun.zenith[up]),
        sun_azimuth_deg=np.degrees(sun.azimuth[up]),
        depression_deg=depression,
        probability=out,
        samples=plan.total,
        notes=[*model.notes, *([] if up.size else [NO_LIGHT.format(date=begin.date().isoformat())])],
    )


def _midnight(scenario: Scenario, date: str | None) -> datetime:
    """Return the beginning of the given date, else of the date of the scenario's time, UTC."""
    if date is None:
        if scenario.time is None:
            raise ScenarioError("time is missing: the best look is searched at one date; give `date`, e.g. 2026-06-21, or add [time] utc")
        return scenario.time.utc.astimezone(UTC).replace(hour=0, minute=0, second=0, microsecond=0)
    try:
        begin = datetime.strptime(str(date), "%Y-%m-%d").replace(tzinfo=UTC)
    except ValueError:
        raise DataError(f"date = {date}: is no date; write it as 2026-06-21") from None
    if not YEARS[0] <= begin.year <= YEARS[1]:
        raise DataError(f"date = {date}: is outside the years {YEARS[0]} to {YEARS[1]}; give a date within them")
    return begin


def _depressions(model: LikelihoodModel) -> FloatArray:
    """Return the depressions of looks [deg]: those of the range that meet the sea; one, NaN, where the range is one look."""
    if model.settings.case != "single-look":
        return np.array([math.nan])
    low, high = model.depression
    horizon = horizon_depression(model.heights[1]) + _ABOVE_HORIZON
    if high < horizon:
        raise ScenarioError(
            f"likelihood.depression_deg = [{math.degrees(low):g}, {math.degrees(high):g}] is above the horizon; give depressions above "
            f"{math.degrees(horizon):.3g} deg"
        )
    low = max(low, horizon)
    return np.degrees(np.linspace(low, high, DEPRESSIONS if high > low else 1))
