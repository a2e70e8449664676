"""Air of a scenario from a profile: a model atmosphere or a sounding, with a haze at the scenario's wind."""

from __future__ import annotations

import logging
from dataclasses import asdict, dataclass, field, replace
from functools import lru_cache, partial
from typing import TYPE_CHECKING, Final

import numpy as np

from seaglint.air.profile.absorber_densities import refractivity
from seaglint.air.profile.air_profile import AirProfile, model_profile
from seaglint.air.profile.band_numbers import Spectroscopy
from seaglint.air.profile.bent_ray import trapping_layers
from seaglint.air.profile.gas_rays import GasRays
from seaglint.air.profile.hazes import HazeWeather
from seaglint.air.profile.marine_layer import with_marine_layer
from seaglint.air.profile.own_gases import OwnGases, with_gases
from seaglint.air.profile.profile_atmosphere import THERMAL_UM, Levels, ProfileAtmosphere
from seaglint.air.protocol import wavenumber_grid
from seaglint.base.conventions import FloatArray
from seaglint.base.errors import ScenarioError
from seaglint.base.free_form import JsonObject
from seaglint.base.limits import NAVY_AEROSOL_WIND, PROFILE_BAND_UM, TABLE_BANDS_UM
from seaglint.files.tables.track import read_track
from seaglint.optics.band import Band
from seaglint.scenario.model import Scenario
from seaglint.scenario.records import atmosphere_table as wanted_air
from seaglint.scenario.records.band_table import TABLE_BANDS_TEXT
from seaglint.studies.prepare.sounding_air import report_sounding, scenario_sounding

_log = logging.getLogger(__name__)

OWN_OF_THE_PROFILE: Final = OwnGases()  #: Gases that are those of the profile.

INFRARED_CM: Final = 2500.0  #: Wavenumber at which layers that trap rays are looked for [cm-1]: 4 um.

if TYPE_CHECKING:
    from seaglint.air.profile.profile_scattering import Scatterers
    from seaglint.air.scattering.scattering_laws import ScatteringAir


def profile_atmosphere(
    wanted: wanted_air.TableAtmosphereSettings | wanted_air.LowtranAtmosphere, scenario: Scenario, over: Band
) -> ProfileAtmosphere:
    """Return the air over a band; the same object for the same air, whose rays are kept.

    Raises
    ------
    ScenarioError
        A response file reaches beyond the air's band.
    """
    _require_band(wanted, scenario, over)
    wind = scenario.wind.speed_m_s
    lowest = None if wanted.air_minus_sea_k is None else (wind, scenario.sea.temperature_k, wanted.air_minus_sea_k)
    choice = _Choice(
        HazeWeather(wind=wind, wind_24h=wind),
        (over.min_um, over.max_um),
        wanted.levels,
        _changes_height(scenario),
        lowest,
        wanted.spectroscopy,
        wanted_gases(wanted),
    )
    if isinstance(wanted, wanted_air.TableAtmosphereSettings):
        return _kept(wanted.model, choice)
    longer = wind if wanted.wind_24h_m_s is None else wanted.wind_24h_m_s
    haze = HazeWeather(wanted.haze, wanted.visibility_km, wanted.air_mass_character, wind, longer)
    choice = replace(choice, haze=haze)
    if wanted.sounding is None:
        return _kept(wanted.model, choice)
    sounding = scenario_sounding(wanted, scenario)
    report_sounding(sounding, wanted.model, scenario, over)
    profile = sounding.profile(wanted.model)
    trapped = trapping_layers(profile.height, refractivity(profile, INFRARED_CM), profile.earth_radius)
    if trapped:
        layers = ", ".join(f"{low:.0f}-{high:.0f} m" for low, high in trapped)
        shown = "" if wanted.refraction == "profile" else ", and pictures show no mirage (atmosphere.refraction = 'profile' does)"
        _log.warning("%s traps rays at %s: its sums bend them a little less%s", sounding.path, layers, shown)
    return _made(profile, choice, sounding.provenance)


def wanted_gases(wanted: wanted_air.TableAtmosphereSettings | wanted_air.LowtranAtmosphere) -> OwnGases:
    """Return the gases of a scenario, carbon dioxide of today among them."""
    return OwnGases(wanted.co2_ppmv, wanted.ch4_ppmv, wanted.n2o_ppmv, wanted.ozone_du).of(wanted.spectroscopy)


def model_air(
    model: str,
    wind_speed: float,
    edges: tuple[float, float],
    levels: Levels = "continuous",
    spectroscopy: Spectroscopy = "lblrtm",
) -> ProfileAtmosphere:
    """Return a model atmosphere with the Navy maritime aerosol at a wind [m s-1], at most 20, over wavelengths [um]."""
    wind = min(wind_speed, NAVY_AEROSOL_WIND[1])
    haze = HazeWeather(wind=wind, wind_24h=wind)
    return _kept(model, _Choice(haze, edges, levels, spectroscopy=spectroscopy, gases=OwnGases().of(spectroscopy)))


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
        """Scatterers of a haze on part of the channels."""
        # Numba comes with it: thermal bands do without.
        from seaglint.air.profile.profile_scattering import Scatterers

        key = (part.start, part.stop, part.step)
        if key not in self._scatterers:
            middle = 0.5 * float(self.grid[0] + self.grid[-1])
            self._scatterers[key] = Scatterers(
                self.profile, self.grid[part], middle, continuous=self.levels == "continuous", spectroscopy=self.spectroscopy
            )
        return self._scatterers[key].with_haze(haze)


@lru_cache(maxsize=64)
def _kept(model: str, choice: _Choice) -> ProfileAtmosphere:
    return _with_haze(_kept_hazeless(model, replace(choice, haze=HazeWeather(), moving=False)), choice)


@lru_cache(maxsize=4)
def _kept_hazeless(model: str, choice: _Choice) -> _HazelessAir:
    return _hazeless(model_profile(model), choice, {})


def _made(profile: AirProfile, choice: _Choice, noted: dict[str, str]) -> ProfileAtmosphere:
    return _with_haze(_hazeless(profile, choice, noted), choice)


def _hazeless(profile: AirProfile, choice: _Choice, noted: dict[str, str]) -> _HazelessAir:
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


def _require_band(wanted: wanted_air.TableAtmosphereSettings | wanted_air.LowtranAtmosphere, scenario: Scenario, over: Band) -> None:
    """Refuse what a response file reaches; the scenario checked its own numbers."""
    of_table = isinstance(wanted, wanted_air.TableAtmosphereSettings)
    inside = TABLE_BANDS_UM if of_table else (PROFILE_BAND_UM,)
    if any(low <= over.min_um and over.max_um <= high for low, high in inside):
        return
    text = TABLE_BANDS_TEXT if of_table else f"{PROFILE_BAND_UM[0]:g} to {PROFILE_BAND_UM[1]:g} um"
    what = "the table atmosphere" if of_table else "LOWTRAN7's band laws"
    raise ScenarioError(
        f"band.response = '{scenario.band.response}' reaches from {over.min_um:g} to {over.max_um:g} um, outside {what}; allowed: {text}, "
        "or set atmosphere.source = 'none'"
    )
