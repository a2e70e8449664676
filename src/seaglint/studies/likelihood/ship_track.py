"""Glint along a ship's track: its chance at every time, its duration and the time until it returns, in the climatology and a forecast."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Final

import numpy as np
from scipy.special import ndtri

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError
from seaglint.base.free_form import number
from seaglint.base.parameters import documented
from seaglint.climate.conditions import WeatherOfDraws
from seaglint.climate.draws import SamplingPlan
from seaglint.climate.ephemeris import Ephemeris, SunPositions
from seaglint.climate.track_chances import ForecastChance, ForecastHours, GlintHours, TrackChance, TrackChances, spells
from seaglint.climate.weather_table import WeatherTable
from seaglint.climate.world_weather import NAME
from seaglint.formats.weather.forecast_weather import ForecastWeather, read_forecast
from seaglint.formats.weather.weather_cells import TextColumns, read_cells
from seaglint.scenario.model import Scenario
from seaglint.studies.likelihood.climatology import likelihood_table
from seaglint.studies.likelihood.draw_model import LikelihoodModel, require_no_moon
from seaglint.studies.likelihood.glint_chance import draw_values, evaluated, uniform_numbers
from seaglint.studies.study_requests import LikelihoodRequest

SAMPLES: Final = 1024  #: Draws at each time.

_NEEDED: Final = ("time_utc", "latitude_deg", "longitude_deg")
_BEARING: Final = "bearing_deg"
_ERRORS: Final = ("wind_error", "cover_error")  #: Uniform numbers of the errors of a forecast.


@documented(LikelihoodRequest)
def along_track(
    scenario: Scenario,
    track: Path,
    *,
    forecast: Path | None = None,
    wind_spread: float = 0.0,
    cover_spread: float = 0.0,
    samples: int = SAMPLES,
    weather: WeatherTable | None = None,
) -> TrackChances:
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
        Chances along the track and hours with glint; the same draws of weather and geometry are followed from time to time. A forecast
        adds its own chances: each draw follows one of its members, and the same errors about it, along the whole track.

    Raises
    ------
    DataError
        A file that lacks columns, or has times without a zone, unsorted or outside the years of the ephemeris; a forecast that does not
        cover the track.
    """
    course = _course(track)
    likelihood_table(scenario)  # refused after the file of the track
    require_no_moon(scenario, "the likelihood along a track")
    ahead = None if forecast is None else read_forecast(forecast, course.time, course.latitude, course.longitude)
    model = LikelihoodModel.of(_of_track(scenario, weather), weather)
    notes = [*model.notes, *_near_the_sea(model, course)]
    plan = SamplingPlan.of(samples)
    u = _numbers(model, course, plan)
    values = _values(model, course, plan, u)
    if forecast is None or ahead is None:
        return _together(course, model, values, notes)
    spread = wind_spread > 0.0 or cover_spread > 0.0
    stronger = model.reaching(float(ahead.wind_speed_m_s.max()) + 3.0 * wind_spread)
    # More numbers would change the points of the climatology, which do not depend on a forecast.
    u = _numbers(stronger, course, plan, more=_ERRORS) if spread else u
    of_forecast = _values(stronger, course, plan, u, lambda row, own: _ahead(own, ahead, row, u, wind_spread, cover_spread))
    return _together(course, model, values, [*notes, *_notes(forecast, ahead, wind_spread, cover_spread)], ahead, of_forecast)


@dataclass(frozen=True, eq=False)
class _Course:
    """Times and places of a track, with the Sun [(times,) each]."""

    time: FloatArray  #: Since 1970-01-01 UTC [s].
    latitude: FloatArray  #: North positive [deg].
    longitude: FloatArray  #: East positive [deg].
    bearing: FloatArray | None  #: Bearing of the look, clockwise from north [deg]; None where the scenario's azimuths count.
    sky: Ephemeris
    sun: SunPositions


def _course(track: Path) -> _Course:
    """Read the file of a track."""
    cells = read_cells(track)
    for name in _NEEDED:
        if name not in cells.header:
            raise DataError(f"{track}: column {name} missing; found: {', '.join(cells.header)}; needed: {', '.join(_NEEDED)}")
    time = _times(cells)
    latitude, longitude = _within(cells, "latitude_deg", 90.0), _within(cells, "longitude_deg", 360.0)
    bearing = _within(cells, _BEARING, 360.0) if _BEARING in cells.header else None
    sky = Ephemeris.between(float(time[0]), float(time[-1]))
    return _Course(time, latitude, longitude, bearing, sky, sky.at(time, latitude, longitude))


def _near_the_sea(model: LikelihoodModel, course: _Course) -> list[str]:
    """Return a note on the rows of a track that have the weather of the nearest sea of the climatology; rows far from it are refused."""
    if model.climatology is None:
        return []
    world = model.climatology.world
    away = np.flatnonzero(~world.at_sea(course.latitude, course.longitude)).tolist()
    told = [world.sea_at(float(course.latitude[i]), float(course.longitude[i]), f"row {i + 1} of the track")[2] for i in away]
    if not told:
        return []
    rows = f" ({len(told)} of {course.time.size} rows like it)" if len(told) > 1 else ""
    return [f"{told[0]}{rows}"]


def _numbers(model: LikelihoodModel, course: _Course, plan: SamplingPlan, *, more: tuple[str, ...] = ()) -> dict[str, FloatArray]:
    """Return the uniform numbers of the draws, the same ones at all times."""
    # Cached properties of the model are set to each time and place: its tables of air and sea stay.
    model.__dict__.update(when=float(course.time[0]), where=(0.0, 0.0), ephemeris=course.sky)
    return uniform_numbers(model, plan, model.scenario.seed, more=more)


def _values(
    model: LikelihoodModel,
    course: _Course,
    plan: SamplingPlan,
    u: dict[str, FloatArray],
    forecast: Callable[[int, WeatherOfDraws], WeatherOfDraws] | None = None,
) -> FloatArray:
    """Return the quantity that is averaged [1, (thresholds, times, draws)]; ``forecast`` replaces weather at a time."""
    thresholds = model.settings.threshold_w_m2_sr
    out = np.empty((len(thresholds), course.time.size, plan.total))
    for i, moment in enumerate(course.time.tolist()):
        model.__dict__.update(when=moment, where=(float(course.latitude[i]), float(course.longitude[i])), ephemeris=course.sky)
        look = None if course.bearing is None else float(np.radians(course.bearing[i]) - course.sun.azimuth[i])
        where = model.conditions(u)
        weather = model.weather(where, u)
        if forecast is not None:
            weather = forecast(i, weather)
        drawn = evaluated(model, u, where, plan, look, weather=weather)
        for t, threshold in enumerate(thresholds):
            out[t, i] = draw_values(model, drawn, threshold)
    return out


def _together(
    course: _Course,
    model: LikelihoodModel,
    values: FloatArray,
    notes: list[str],
    ahead: ForecastWeather | None = None,
    of_forecast: FloatArray | None = None,
) -> TrackChances:
    """Return the chances and hours of a track from the values of its draws, with those of a forecast where there is one."""
    step, thresholds = _steps(course.time), model.settings.threshold_w_m2_sr
    chance, elevation = values.mean(axis=2), 90.0 - np.degrees(course.sun.zenith)
    way = [
        TrackChance(
            time_utc=datetime.fromtimestamp(moment, UTC).isoformat().replace("+00:00", "Z"),
            latitude_deg=float(course.latitude[i]),
            longitude_deg=float(course.longitude[i]),
            sun_elevation_deg=float(elevation[i]),
            threshold_w_m2_sr=threshold,
            probability=float(chance[t, i]),
        )
        for i, moment in enumerate(course.time.tolist())
        for t, threshold in enumerate(thresholds)
    ]
    hours = [GlintHours(threshold, float(chance[t] @ step), *spells(values[t].T > 0.0, step)) for t, threshold in enumerate(thresholds)]
    if ahead is not None and of_forecast is not None:
        chance, (wind, come), cover = of_forecast.mean(axis=2), ahead.mean_wind(), ahead.cloud_cover.mean(axis=1)
        way = [
            ForecastChance(
                **asdict(one),
                forecast_probability=float(chance[n % len(thresholds), n // len(thresholds)]),
                wind_speed_m_s=float(wind[n // len(thresholds)]),
                wind_from_deg=number(come[n // len(thresholds)]),
                cloud_cover=float(cover[n // len(thresholds)]),
            )
            for n, one in enumerate(way)
        ]
        hours = [
            ForecastHours(
                **asdict(one),
                forecast_hours=float(chance[t] @ step),
                **{f"forecast_{name}": value for name, value in spells(of_forecast[t].T > 0.0, step)._asdict().items()},
            )
            for t, one in enumerate(hours)
        ]
    return TrackChances(float(step.sum()), hours, way, notes)


def _of_track(scenario: Scenario, weather: WeatherTable | None) -> Scenario:
    """Return the scenario without its own Sun, time and place; the climatology is its weather by default, as all places are known."""
    settings = likelihood_table(scenario)
    update = {"place": None, **({"weather": Path(NAME)} if settings.weather is None and weather is None else {})}
    return scenario.model_copy(update={"sun": None, "time": None, "place": None, "likelihood": settings.model_copy(update=update)})


def _ahead(
    own: WeatherOfDraws, ahead: ForecastWeather, row: int, u: dict[str, FloatArray], wind_spread: float, cover_spread: float
) -> WeatherOfDraws:
    """Return the weather of every draw at a row of the track, from its member with its errors; the air is the climatology's."""
    # Not by turns: the order of Sobol points follows their first digits.
    member = np.minimum((u["row"] * ahead.members).astype(np.intp), ahead.members - 1)
    wind, come, cover = (of[row, member] for of in (ahead.wind_speed_m_s, ahead.wind_from_deg, ahead.cloud_cover))
    if wind_spread > 0.0 or cover_spread > 0.0:
        errors = [ndtri(np.clip(u[name], 1e-12, 1.0 - 1e-12)) for name in _ERRORS]
        # Winds are reflected at the calm. Covers end at clear and overcast, which are states with chances of their own.
        wind, cover = np.abs(wind + wind_spread * errors[0]), np.clip(cover + cover_spread * errors[1], 0.0, 1.0)
    return own._replace(wind=wind, cover=cover, wind_from=come)


def _notes(path: Path, ahead: ForecastWeather, wind_spread: float, cover_spread: float) -> list[str]:
    notes = [f"{path.name}: {note}" for note in ahead.notes]
    errors = f"standard deviations about it {wind_spread:g} m/s and {cover_spread:g} of the sky"
    if ahead.members > 1:
        spread = f", {errors}" if wind_spread > 0.0 or cover_spread > 0.0 else ""
        return [*notes, f"{path.name}: {ahead.members} members, each as likely{spread}"]
    if wind_spread > 0.0 or cover_spread > 0.0:
        return [*notes, f"{path.name}: one state, {errors}"]
    return [*notes, f"{path.name}: one state, taken as certain; a stated spread of wind and cover gives it errors"]


def _steps(time: FloatArray) -> FloatArray:
    """Return the hours of each time: half of the distance to its neighbours; the ends stand for a whole gap, as hourly rows for an hour."""
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
