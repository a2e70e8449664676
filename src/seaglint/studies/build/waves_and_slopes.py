"""Wave spectra as a scenario wants them: models at its wind, files, and sums of both.

From a scenario to the slope statistics of its sea.
"""

from __future__ import annotations

import logging
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Final, assert_never

import numpy as np

from seaglint.base.conventions import travel_azimuth
from seaglint.base.errors import DomainError, Mistake, ScenarioError
from seaglint.base.free_form import JsonObject
from seaglint.scenario.model import Scenario
from seaglint.scenario.records import sea_tables as wanted
from seaglint.scenario.records import sea_tables as wanted_slopes
from seaglint.scenario.records.sea_tables import FlatSea
from seaglint.sea.slopes.breon_henriot import breon_henriot
from seaglint.sea.slopes.cox_munk import cox_munk_anisotropic, cox_munk_gram_charlier, cox_munk_isotropic, cox_munk_slick
from seaglint.sea.slopes.from_spectrum import nested_in, spectrum_slopes
from seaglint.sea.slopes.slope_statistics import LIGHTEST, SlopeStatistics, at_least_residual, flat
from seaglint.sea.spectra.combined import CalmSpectrum, CombinedSpectrum
from seaglint.sea.spectra.directional import DirectionalSpectrum
from seaglint.sea.spectra.elfouhaily import ElfouhailySpectrum
from seaglint.sea.spectra.jonswap import JonswapSpectrum
from seaglint.sea.spectra.pierson_moskowitz import PiersonMoskowitzSpectrum

_ASKED: Final = ("time", "site", "from_deg", "spreading_deg")  # keys of a file's table that only the file can find wrong


@dataclass(frozen=True)
class Waves:
    """A spectrum, None for a sea without waves, and where what was read is from."""

    spectrum: DirectionalSpectrum | None
    #: For the provenance, one for every file: format, time, place, and how far they are from those wanted.
    sources: tuple[JsonObject, ...] = ()


def waves(scenario: Scenario) -> Waves:
    """Waves of a scenario.

    Raises
    ------
    ScenarioError
        Keys that a file or a model finds wrong or missing.
    DataError
        A file that cannot be read, or has nothing near the time and place wanted.
    """
    match scenario.sea.spectrum:
        case wanted.FlatSea():
            return Waves(None)
        case wanted.WaveSystems(systems=systems):
            parts = [_system(scenario, system, f"sea.spectrum.systems[{i}]") for i, system in enumerate(systems)]
            spectra = tuple(part.spectrum for part in parts if part.spectrum is not None)
            return Waves(CombinedSpectrum(spectra) if spectra else None, tuple(source for part in parts for source in part.sources))
        case single:
            return _system(scenario, single, "sea.spectrum")


def spectrum(scenario: Scenario) -> DirectionalSpectrum | None:
    """Wave spectrum; None for a sea without waves."""
    return waves(scenario).spectrum


def has_wind_sea(scenario: Scenario) -> bool:
    """Return true where waves come from a model of the wind sea, alone or with other systems."""
    table = scenario.sea.spectrum
    systems = table.systems if isinstance(table, wanted.WaveSystems) else (table,)
    return any(isinstance(system, wanted.Elfouhaily | wanted.PiersonMoskowitz) for system in systems)


def _system(scenario: Scenario, system: wanted.System, key: str) -> Waves:
    """One system; its table stands at ``key``."""
    speed, to = scenario.wind.speed_m_s, travel_azimuth(np.radians(scenario.wind.from_deg))
    match system:
        case wanted.SpectrumFile():
            return _file(scenario, system, to, key)
        case wanted.Jonswap():
            return Waves(_jonswap(system, to, key))
        case _ if speed == 0.0:
            return Waves(None)  # no wind, no wind sea
        case wanted.Elfouhaily():
            return Waves(elfouhaily(speed, to))
        case wanted.PiersonMoskowitz():
            return Waves(_wind_sea(lambda wind: PiersonMoskowitzSpectrum.of_u10(wind, to), speed))
        case other:
            assert_never(other)


def elfouhaily(speed: float, to: float) -> DirectionalSpectrum:
    """Elfouhaily's wind sea of a wind above 0 m/s at 10 m that blows TO an azimuth [rad]."""
    return _wind_sea(lambda wind: ElfouhailySpectrum(wind, to), speed)


def _wind_sea(model: Callable[[float], DirectionalSpectrum], speed: float) -> DirectionalSpectrum:
    """Sea of a model at a wind [m/s]; of winds too light for it, that of the lightest with less energy."""
    return model(speed) if speed >= LIGHTEST else CalmSpectrum(model(LIGHTEST), speed / LIGHTEST)


def _jonswap(system: wanted.Jonswap, wind_to: float, key: str) -> JonswapSpectrum:
    to = wind_to if system.from_deg is None else travel_azimuth(np.radians(system.from_deg))
    try:
        return JonswapSpectrum(
            system.significant_height_m, system.peak_period_s, to, system.gamma, float(np.radians(system.spreading_deg)), wind_to
        )
    except DomainError as error:  # the ranges are the scenario's own: what is left is the steepness
        name = f"{key}.significant_height_m"
        raise _mistake(name, f"{name}: {error}", error) from error


def _file(scenario: Scenario, system: wanted.SpectrumFile, wind_to: float, key: str) -> Waves:
    from seaglint.formats.waves import WaveChoice, read_waves

    place = scenario.place if system.latitude_deg is None and system.site is None else None
    choice = system.build(
        WaveChoice,
        time=system.time if system.time is not None else (scenario.time.utc if scenario.time is not None else None),
        latitude_deg=place.latitude_deg if place is not None else system.latitude_deg,
        longitude_deg=place.longitude_deg if place is not None else system.longitude_deg,
    )
    try:
        read = read_waves(system.path, choice, wind_to, format=None if system.format == "auto" else system.format)
    except DomainError as error:
        if error.name not in _ASKED:
            raise
        name = f"{key}.{error.name}"
        raise _mistake(name, f"{name} {error}", error) from error
    return Waves(read.spectrum, (read.report,))


def _mistake(key: str, text: str, error: DomainError) -> ScenarioError:
    return ScenarioError(text, mistakes=(Mistake(key, error.value, error.allowed, text),))


log = logging.getLogger(__name__)

FEW_SLOPES: Final = 0.6  #: Slope variance of a spectrum over that of Cox and Munk's fit below which short waves are missing.


def slopes(scenario: Scenario) -> SlopeStatistics:
    """Slope statistics of the whole sea, with the covariances of the scenario's longer waves; isotropic laws have no direction at all."""
    sea = spectrum(scenario)
    made = _law(scenario, sea)
    if isinstance(scenario.sea.slopes, wanted_slopes.CoxMunkIsotropic) or isinstance(scenario.sea.spectrum, FlatSea):
        return made
    if made.directed is None or made.directed >= 1.0:
        return made if sea is None else _nested(made, sea)
    without_wind = scenario.model_copy(update={"wind": scenario.wind.model_copy(update={"speed_m_s": 0.0})})
    return _nested(made, sea, spectrum(without_wind))


@lru_cache(maxsize=256)
def _nested(made: SlopeStatistics, waves: DirectionalSpectrum | None, calm: DirectionalSpectrum | None = None) -> SlopeStatistics:
    return nested_in(made, waves, calm)


def _law(scenario: Scenario, sea: DirectionalSpectrum | None) -> SlopeStatistics:
    """Slope statistics by the scenario's slope law, which may be that of its waves."""
    speed, to = scenario.wind.speed_m_s, travel_azimuth(np.radians(scenario.wind.from_deg))
    match scenario.sea.slopes:
        case wanted_slopes.CoxMunkIsotropic(extrapolate=extrapolate):
            return cox_munk_isotropic(speed, extrapolate=extrapolate)
        case wanted_slopes.CoxMunkAnisotropic(extrapolate=extrapolate):
            return cox_munk_anisotropic(speed, to, extrapolate=extrapolate)
        case wanted_slopes.CoxMunkGramCharlier(extrapolate=extrapolate):
            return cox_munk_gram_charlier(speed, to, extrapolate=extrapolate)
        case wanted_slopes.CoxMunkSlick(extrapolate=extrapolate):
            return cox_munk_slick(speed, to, extrapolate=extrapolate)
        case wanted_slopes.BreonHenriot(extrapolate=extrapolate):
            return breon_henriot(speed, to, extrapolate=extrapolate)
        case wanted_slopes.SpectrumSlopes():
            made = SlopeStatistics(0.0, 0.0, to) if sea is None else spectrum_slopes(sea)
            if has_wind_sea(scenario):
                made = at_least_residual(made)
            if made.is_flat:
                return made
            _warn_of_few_slopes(made.mss, speed)
            return made
        case wanted_slopes.FlatSlopes():
            return flat()
        case other:
            assert_never(other)


@lru_cache(maxsize=64)
def _warn_of_few_slopes(mss: float, speed: float) -> None:
    """Say once that a spectrum lacks the short waves that carry most of the slopes."""
    expected = cox_munk_isotropic(speed, extrapolate=True).mss
    if mss < FEW_SLOPES * expected:
        log.warning(
            "seaglint: sea.slopes.kind = 'spectrum': all waves of sea.spectrum have a slope variance of %.2g, and the sea at %.3g m/s has "
            "%.2g (Cox and Munk): short waves are missing, glint is too narrow and too bright; "
            "set sea.slopes.kind = 'cox-munk-anisotropic'",
            mss,
            speed,
            expected,
        )
