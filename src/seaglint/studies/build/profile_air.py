"""Air of a scenario from a profile: a model atmosphere or a sounding, with a haze at the scenario's wind.

For LOWTRAN7's program a sounding is thinned to the number of levels that the program takes, and continued by levels of the model
atmosphere. Levels that were left out, and the effect of water vapour that a model atmosphere continues, are reported.
"""

from __future__ import annotations

import logging
from dataclasses import asdict, dataclass, field, replace
from datetime import datetime
from functools import lru_cache, partial
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from seaglint.air.profile.absorber_densities import refractivity
from seaglint.air.profile.aerosols import HazeWeather
from seaglint.air.profile.air_profile import AirProfile, model_profile
from seaglint.air.profile.air_sums import AirSums, GasRays
from seaglint.air.profile.band_laws import OwnGases, Spectroscopy, with_gases
from seaglint.air.profile.bent_ray import trapping_layers
from seaglint.air.profile.marine_layer import with_marine_layer
from seaglint.air.profile.profile_atmosphere import THERMAL_UM, Levels, ProfileAtmosphere
from seaglint.air.protocol import wavenumber_grid
from seaglint.base.conventions import FloatArray
from seaglint.base.errors import ScenarioError
from seaglint.base.free_form import JsonObject
from seaglint.base.limits import NAVY_AEROSOL_WIND, PROFILE_BAND_UM, PROFILE_HEIGHTS, TABLE_BANDS_UM
from seaglint.base.reports import REPORTS
from seaglint.formats.lowtran.deck import MOST_LEVELS, ProfileLevel
from seaglint.formats.soundings.sounding import Continuation, Sounding, continuations, read_sounding
from seaglint.formats.tables.input_tables import read_track
from seaglint.optics.band import Band, apparent_temperature
from seaglint.scenario.model import Scenario
from seaglint.scenario.records import atmosphere_table as requested_air
from seaglint.scenario.records.small_tables import TABLE_BANDS_TEXT

AirWithSounding = requested_air.LowtranAtmosphere | requested_air.LowtranFortranAtmosphere  #: Tables of air that may have a sounding.
ComputedAir = requested_air.TableAtmosphereSettings | requested_air.LowtranAtmosphere  #: Tables of air whose absorption is summed here.

if TYPE_CHECKING:
    from seaglint.air.profile.profile_scattering import Scatterers
    from seaglint.air.scattering.scattering_laws import ScatteringAir

MODEL_LEVELS_KM = (*range(1, 26), 30, 35, 40, 45, 50, 70, 100)  #: Levels of LOWTRAN7's own models, which continue a sounding upwards.

LEVELS_ABOVE = 12  #: Largest number of levels of the model above a sounding that needs room itself.

#: Differences of equal weight when levels are left out: relative pressure [1], temperature [K], relative humidity [%].
THINNING = (0.002, 0.3, 2.0)

#: Zenith angle of the sky in which the effect of continued water vapour is computed [deg]: low sky, as slopes of waves mirror it.
SKY_DEG: Final = 78.0

MOST_SKY_LEVELS: Final = 2000  #: Largest number of levels of the profiles with which the effect is computed.

LEAST_EFFECT: Final = 0.1  #: Difference of the sky below which no temperatures are reported [K].

ALMOST_NONE: Final = 1e-6  #: Factor of the removed water vapour [1]: an amount of 0 has no logarithm.

OWN_OF_THE_PROFILE: Final = OwnGases()  #: Choice of gases that leaves the gases of the profile unchanged.

INFRARED_CM: Final = 2500.0  #: Wavenumber at which layers that trap rays are searched [cm-1]: 4 um.

_log = logging.getLogger(__name__)


def program_levels(path: str | Path, model: str = "midlatitude-summer") -> tuple[ProfileLevel, ...]:
    """Return the levels of a sounding from the sea to 100 km, thinned for LOWTRAN7, then the levels of the model atmosphere.

    Levels are left out where the others, interpolated (pressure logarithmically), miss the sounding least.

    Raises
    ------
    DataError
        As ``read_sounding``.
    """
    return levels_of(read_sounding(path), model)


def levels_of(sounding: Sounding, model: str) -> tuple[ProfileLevel, ...]:
    """Return the levels of a sounding that was read, as ``program_levels`` does; above its end humidity is the model's."""
    return _to_the_top(np.column_stack((sounding.height, sounding.pressure, sounding.temperature, sounding.humidity(model))))


def _to_the_top(levels: FloatArray) -> tuple[ProfileLevel, ...]:
    top = float(levels[-1, 0]) / 1e3
    above = [float(z) for z in MODEL_LEVELS_KM if z > top + 0.2]  # closer levels make LOWTRAN7's layers degenerate
    # LOWTRAN7 takes a limited number of levels for the sounding and the model above together.
    thinned = _thinned_levels(levels, MOST_LEVELS - min(len(above), LEVELS_ABOVE))
    while len(thinned) + len(above) > MOST_LEVELS:
        # The closest pair of the model's levels loses its upper one, never the last.
        del above[int(np.argmin([(b - a) / b for a, b in pairwise(above[:-1])])) + 1]
    own = [ProfileLevel(float(z) / 1e3, float(p), float(t), float(u)) for z, p, t, u in thinned]
    return (*own, *(ProfileLevel(z) for z in above))


def _thinned_levels(levels: FloatArray, room: int) -> FloatArray:
    """Return the rows that interpolate the others best: ends first, then the worst interpolated one after the other."""
    if len(levels) <= room:
        return levels
    # Differences of pressure, temperature and humidity become comparable in units of THINNING.
    scaled = np.column_stack([np.log(levels[:, 1]) / THINNING[0], levels[:, 2] / THINNING[1], levels[:, 3] / THINNING[2]])
    chosen = [0, len(levels) - 1]
    while len(chosen) < room:
        order = np.sort(chosen)
        guess = np.column_stack([np.interp(levels[:, 0], levels[order, 0], column[order]) for column in scaled.T])
        # Chosen levels are interpolated exactly, so the worst level is always a new one.
        chosen.append(int(np.argmax(np.abs(scaled - guess).max(axis=1))))
    return np.asarray(levels[np.sort(chosen)])


def scenario_sounding(requested: AirWithSounding, scenario: Scenario) -> Sounding:
    """Return the sounding of a scenario at its place and time.

    Raises
    ------
    DataError
        As ``read_sounding``.
    """
    assert requested.sounding is not None  # callers checked
    place = None if scenario.place is None else (scenario.place.latitude_deg, scenario.place.longitude_deg)
    time: datetime | None = None if scenario.time is None else scenario.time.utc
    return read_sounding(requested.sounding, place, time)


def report_sounding(sounding: Sounding, model: str, scenario: Scenario, over: Band) -> None:
    """Report levels of a sounding that are left out, heights that the model continues, and the effect of this, a line a fact.

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
    if isinstance(air, AirWithSounding) and air.sounding is not None:
        report_sounding(scenario_sounding(air, scenario), air.model, scenario, over)


def program_sounding(requested: AirWithSounding, scenario: Scenario, over: Band) -> tuple[ProfileLevel, ...]:
    """Return the levels of a scenario's sounding for LOWTRAN7's program and for decks, none without one, and report the sounding.

    Raises
    ------
    DataError
        As ``read_sounding``.
    """
    if requested.sounding is None:
        return ()

    sounding = scenario_sounding(requested, scenario)
    report_sounding(sounding, requested.model, scenario, over)
    if sounding.ozone_ppmv is not None:
        REPORTS.warning("%s: LOWTRAN7's program and decks take no ozone of it but that of %s", sounding.path, requested.model)
    return levels_of(sounding, requested.model)


def _effect(part: Continuation, profile: AirProfile, scenario: Scenario, over: Band) -> str:
    """Return a clause with the apparent temperatures of the sky with and without the continued vapour, seen from the sensor."""
    height = float(np.clip(scenario.sensor.height_m, *PROFILE_HEIGHTS))
    profile = _thinned(profile, part.height)
    continued = profile.height < part.height if part.below else profile.height > part.height
    dry = replace(profile, vapour=np.where(continued, ALMOST_NONE, 1.0) * profile.vapour)
    wind = scenario.wind.speed_m_s
    without, given = (_sky(air, HazeWeather(wind=wind, wind_24h=wind), height, over) for air in (dry, profile))
    if not np.isfinite([without, given]).all():
        return ""  # a band in which the air hardly emits
    seen = f"the thermal sky {SKY_DEG:g} deg from the zenith, seen from {height:g} m in {over.min_um:g}-{over.max_um:g} um,"
    if abs(given - without) < LEAST_EFFECT:
        return f"; without this vapour {seen} would change by less than {LEAST_EFFECT:g} K"
    return f"; without this vapour {seen} would be at {without:.1f} K instead of {given:.1f} K"


def _thinned(profile: AirProfile, height: float) -> AirProfile:
    """Return at most about ``MOST_SKY_LEVELS`` levels of a profile, the level at a height [m] among them."""
    step = -(-profile.height.size // MOST_SKY_LEVELS)
    if step == 1:
        return profile
    last = profile.height.size - 1
    # The lowest and the highest levels and the level of the change remain; others are thinned evenly.
    indices = np.unique(np.r_[np.arange(0, last, step), last - np.arange(40), np.searchsorted(profile.height, height)])
    return replace(
        profile,
        height=profile.height[indices],
        pressure=profile.pressure[indices],
        temperature=profile.temperature[indices],
        vapour=profile.vapour[indices],
        gas=profile.gas[:, indices],
    )


def _sky(profile: AirProfile, haze: HazeWeather, height: float, over: Band) -> float:
    """Return the apparent temperature of the sky [K]."""
    grid = wavenumber_grid(over.min_um, over.max_um)
    emitted = AirSums(profile, haze, grid).along(height, float(np.radians(SKY_DEG))).emitted
    return float(apparent_temperature(float(emitted @ over.weights(grid)), over, grid))


def profile_atmosphere(requested: ComputedAir, scenario: Scenario, over: Band) -> ProfileAtmosphere:
    """Return the air over a band; equal air is one object, which caches its rays.

    Raises
    ------
    ScenarioError
        A response file reaches beyond the air's band.
    """
    _require_band(requested, scenario, over)
    wind = scenario.wind.speed_m_s
    lowest = None if requested.air_minus_sea_k is None else (wind, scenario.sea.temperature_k, requested.air_minus_sea_k)
    choice = _Choice(
        HazeWeather(wind=wind, wind_24h=wind),
        (over.min_um, over.max_um),
        requested.levels,
        _changes_height(scenario),
        lowest,
        requested.spectroscopy,
        requested_gases(requested),
    )
    if isinstance(requested, requested_air.TableAtmosphereSettings):
        return _cached_model_air(requested.model, choice)
    longer = wind if requested.wind_24h_m_s is None else requested.wind_24h_m_s
    haze = HazeWeather(requested.haze, requested.visibility_km, requested.air_mass_character, wind, longer)
    choice = replace(choice, haze=haze)
    if requested.sounding is None:
        return _cached_model_air(requested.model, choice)
    sounding = scenario_sounding(requested, scenario)
    report_sounding(sounding, requested.model, scenario, over)
    profile = sounding.profile(requested.model)
    # A duct bends rays more than the sums assume, which the user has to know.
    if trapped := trapping_layers(profile.height, refractivity(profile, INFRARED_CM), profile.earth_radius):
        layers = ", ".join(f"{low:.0f}-{high:.0f} m" for low, high in trapped)
        shown = "" if requested.refraction == "profile" else ", and pictures show no mirage (atmosphere.refraction = 'profile' does)"
        _log.warning("%s traps rays at %s: its sums bend them a little less%s", sounding.path, layers, shown)
    return _with_haze(_hazeless_air(profile, choice, sounding.provenance), choice)


def requested_gases(requested: ComputedAir) -> OwnGases:
    """Return the gases of a scenario, with the default carbon dioxide of its spectroscopy."""
    return OwnGases(requested.co2_ppmv, requested.ch4_ppmv, requested.n2o_ppmv, requested.ozone_du).of(requested.spectroscopy)


def model_air(
    model: str, wind_speed: float, edges: tuple[float, float], levels: Levels = "continuous", spectroscopy: Spectroscopy = "lblrtm"
) -> ProfileAtmosphere:
    """Return a model atmosphere with the Navy maritime aerosol at a wind [m s-1], at most 20, over wavelengths [um]."""
    wind = min(wind_speed, NAVY_AEROSOL_WIND[1])
    haze = HazeWeather(wind=wind, wind_24h=wind)
    return _cached_model_air(model, _Choice(haze, edges, levels, spectroscopy=spectroscopy, gases=OwnGases().of(spectroscopy)))


def _changes_height(scenario: Scenario) -> bool:
    """Return true for a sensor that rises, sinks or floats."""
    platform = scenario.platform
    if platform is None:
        return False
    if platform.floats:
        return True
    if platform.track is not None:
        heights = read_track(platform.track)[0].get("height_m", np.zeros(1))
    else:
        own = scenario.sensor.height_m
        heights = np.array([own if key.height_m is None else key.height_m for key in platform.keyframes or ()])
    return bool(np.ptp(heights) > 0.0) if heights.size else False


@dataclass(frozen=True)
class _Choice:
    """Choices that air depends on besides its profile; ``lowest`` is wind, temperature of the sea, and air less sea."""

    haze: HazeWeather
    edges: tuple[float, float]
    levels: Levels = "continuous"
    moving: bool = False
    lowest: tuple[float, float, float] | None = None
    spectroscopy: Spectroscopy = "lblrtm"
    gases: OwnGases = OWN_OF_THE_PROFILE


@dataclass(eq=False)
class _HazelessAir:
    """Air of a profile over a band without its haze, which hazes of all winds share."""

    profile: AirProfile
    grid: FloatArray
    levels: Levels
    spectroscopy: Spectroscopy
    noted: JsonObject
    rays: GasRays = field(default_factory=GasRays)
    _scatterers: dict[tuple[int | None, int | None, int | None], Scatterers] = field(default_factory=dict)

    def scattering(self, haze: HazeWeather, part: slice) -> ScatteringAir:
        """Return the scatterers of a haze on part of the channels."""
        # Imported here, as it loads kernels of Numba: thermal bands do without them.
        from seaglint.air.profile.profile_scattering import Scatterers

        key = (part.start, part.stop, part.step)
        if key not in self._scatterers:
            # Rays are bent at one wavenumber for the whole band.
            middle = 0.5 * float(self.grid[0] + self.grid[-1])
            self._scatterers[key] = Scatterers(
                self.profile, self.grid[part], middle, continuous=self.levels == "continuous", spectroscopy=self.spectroscopy
            )
        return self._scatterers[key].with_haze(haze)


@lru_cache(maxsize=64)
def _cached_model_air(model: str, choice: _Choice) -> ProfileAtmosphere:
    # Hazes and motion do not change the gases, so air of all winds shares one set of sums.
    return _with_haze(_cached_hazeless_air(model, replace(choice, haze=HazeWeather(), moving=False)), choice)


@lru_cache(maxsize=4)
def _cached_hazeless_air(model: str, choice: _Choice) -> _HazelessAir:
    return _hazeless_air(model_profile(model), choice, {})


def _hazeless_air(profile: AirProfile, choice: _Choice, noted: dict[str, str]) -> _HazelessAir:
    provenance: JsonObject = {**noted}
    if choice.lowest is not None:
        profile = with_marine_layer(profile, *choice.lowest)
        provenance["air_minus_sea_k"] = choice.lowest[2]
    profile = with_gases(profile, choice.gases)
    provenance |= {name: value for name, value in asdict(choice.gases).items() if value is not None}
    return _HazelessAir(profile, wavenumber_grid(*choice.edges), choice.levels, choice.spectroscopy, provenance)


def _with_haze(air: _HazelessAir, choice: _Choice) -> ProfileAtmosphere:
    return ProfileAtmosphere(
        air.profile,
        choice.haze,
        air.grid,
        levels=choice.levels,
        scattering=partial(air.scattering, choice.haze) if choice.edges[0] < THERMAL_UM else None,
        provenance=air.noted,
        moving=choice.moving,
        spectroscopy=choice.spectroscopy,
        rays=air.rays,
    )


def _require_band(requested: ComputedAir, scenario: Scenario, over: Band) -> None:
    """Refuse wavelengths of a response file outside the air's band; the records check the scenario's numbers."""
    of_table = isinstance(requested, requested_air.TableAtmosphereSettings)
    inside = TABLE_BANDS_UM if of_table else (PROFILE_BAND_UM,)
    if any(low <= over.min_um and over.max_um <= high for low, high in inside):
        return
    text = TABLE_BANDS_TEXT if of_table else f"{PROFILE_BAND_UM[0]:g} to {PROFILE_BAND_UM[1]:g} um"
    what = "the table atmosphere" if of_table else "LOWTRAN7's band laws"
    raise ScenarioError(
        f"band.response = '{scenario.band.response}' reaches from {over.min_um:g} to {over.max_um:g} um, outside {what}; allowed: {text}, "
        "or set atmosphere.source = 'none'"
    )
