"""The sounding of a scenario, and what a user needs to see of it: what was left out, what a model atmosphere continues, and its share."""

from __future__ import annotations

from dataclasses import replace
from datetime import datetime
from typing import TYPE_CHECKING, Final

import numpy as np

from seaglint.air.profile.air_profile import AirProfile
from seaglint.air.profile.air_sums import AirSums
from seaglint.air.profile.hazes import HazeWeather
from seaglint.air.protocol import wavenumber_grid
from seaglint.base.limits import PROFILE_HEIGHTS
from seaglint.base.reports import REPORTS
from seaglint.files.soundings.continuation import Continuation, continuations
from seaglint.optics.band import Band, apparent_temperature
from seaglint.scenario.model import Scenario
from seaglint.scenario.records import atmosphere_table as wanted_air

if TYPE_CHECKING:
    from seaglint.files.lowtran.deck import ProfileLevel
    from seaglint.files.soundings.sounding import Sounding

#: Zenith angle of the sky by which the effect of continued water vapour is shown [deg]: low sky, as slopes of waves mirror it.
SKY_DEG: Final = 78.0

MOST_LEVELS: Final = 2000  #: Levels of the profiles by which the effect is shown.

LEAST_EFFECT: Final = 0.1  #: Difference of the sky below which only that is reported [K].

ALMOST_NONE: Final = 1e-6  #: Factor of the water vapour that is taken away [1]; none at all has no logarithm.


def scenario_sounding(wanted: wanted_air.LowtranAtmosphere | wanted_air.LowtranFortranAtmosphere, scenario: Scenario) -> Sounding:
    """Return the sounding of a scenario at its place and time.

    Raises
    ------
    DataError
        As :func:`~seaglint.files.soundings.sounding.read_sounding`.
    """
    from seaglint.files.soundings.sounding import read_sounding

    assert wanted.sounding is not None  # callers asked
    place = None if scenario.place is None else (scenario.place.latitude_deg, scenario.place.longitude_deg)
    time: datetime | None = None if scenario.time is None else scenario.time.utc
    return read_sounding(wanted.sounding, place, time)


def report_sounding(sounding: Sounding, model: str, scenario: Scenario, over: Band) -> None:
    """Log what a user of the result needs to see, a line a fact: levels left out, what the model continues and what it changes.

    Records of one fact carry the same ``fact``: an ensemble of many sensors has one line of it.
    """
    for text in sounding.reported:
        REPORTS.warning("%s: %s", sounding.path, text)
    profile, sensor = sounding.profile(model), scenario.sensor.height_m
    for part in continuations(sounding, profile, model, sensor):
        fact = {"fact": f"{sounding.path}: above {part.height:g} m {model}"}
        REPORTS.warning("%s: %s%s", sounding.path, part.text, _effect(part, profile, scenario, over), extra=fact)


def report_air(scenario: Scenario, over: Band) -> None:
    """Report the sounding of a scenario, where it has one, for workers that prepare its air and print nothing."""
    air = scenario.atmosphere
    if isinstance(air, wanted_air.LowtranAtmosphere | wanted_air.LowtranFortranAtmosphere) and air.sounding is not None:
        report_sounding(scenario_sounding(air, scenario), air.model, scenario, over)


def program_sounding(
    wanted: wanted_air.LowtranAtmosphere | wanted_air.LowtranFortranAtmosphere, scenario: Scenario, over: Band
) -> tuple[ProfileLevel, ...]:
    """Return the levels of a scenario's sounding for LOWTRAN7's program and for decks, none without one, and report the sounding.

    Raises
    ------
    DataError
        As :func:`~seaglint.files.soundings.sounding.read_sounding`.
    """
    if wanted.sounding is None:
        return ()
    from seaglint.files.lowtran.program_levels import levels_of

    sounding = scenario_sounding(wanted, scenario)
    report_sounding(sounding, wanted.model, scenario, over)
    if sounding.ozone_ppmv is not None:
        REPORTS.warning("%s: LOWTRAN7's program and decks take no ozone of it but that of %s", sounding.path, wanted.model)
    return levels_of(sounding, wanted.model)


def _effect(part: Continuation, profile: AirProfile, scenario: Scenario, over: Band) -> str:
    """Apparent temperatures of the sky with and without the continued vapour, seen from the sensor."""
    height = float(np.clip(scenario.sensor.height_m, *PROFILE_HEIGHTS))
    profile = _thinned(profile, part.height)
    there = profile.height < part.height if part.below else profile.height > part.height
    dry = replace(profile, vapour=np.where(there, ALMOST_NONE, 1.0) * profile.vapour)
    wind = scenario.wind.speed_m_s
    without, given = (_sky(air, HazeWeather(wind=wind, wind_24h=wind), height, over) for air in (dry, profile))
    if not np.isfinite([without, given]).all():
        return ""  # a band in which the air hardly emits
    seen = f"the thermal sky {SKY_DEG:g} deg from the zenith, seen from {height:g} m in {over.min_um:g}-{over.max_um:g} um,"
    if abs(given - without) < LEAST_EFFECT:
        return f"; without this vapour {seen} would change by less than {LEAST_EFFECT:g} K"
    return f"; without this vapour {seen} would be at {without:.1f} K instead of {given:.1f} K"


def _thinned(profile: AirProfile, height: float) -> AirProfile:
    """Return at most about :data:`MOST_LEVELS` levels of a profile, that at a height [m] among them."""
    step = -(-profile.height.size // MOST_LEVELS)
    if step == 1:
        return profile
    last = profile.height.size - 1
    some = np.unique(np.r_[np.arange(0, last, step), last - np.arange(40), np.searchsorted(profile.height, height)])
    return replace(
        profile,
        height=profile.height[some],
        pressure=profile.pressure[some],
        temperature=profile.temperature[some],
        vapour=profile.vapour[some],
        gas=profile.gas[:, some],
    )


def _sky(profile: AirProfile, haze: HazeWeather, height: float, over: Band) -> float:
    """Apparent temperature of the sky [K]."""
    grid = wavenumber_grid(over.min_um, over.max_um)
    emitted = AirSums(profile, haze, grid).along(height, float(np.radians(SKY_DEG))).emitted
    return float(apparent_temperature(float(emitted @ over.weights(grid)), over, grid))
