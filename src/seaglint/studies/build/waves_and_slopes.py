"""Wave spectra and slope statistics of a scenario's sea.

Spectra are models at the scenario's wind, files, and sums of both. With ``sea.uncertainty = "campaigns"`` their short waves are replaced by
those of a sea between two measured campaigns and a model (:mod:`seaglint.sea.spectra.campaign_draws`), from which all slopes follow.
"""

from __future__ import annotations

import logging
from dataclasses import replace
from functools import lru_cache
from typing import Final, assert_never

import numpy as np

from seaglint.base.conventions import travel_azimuth
from seaglint.base.errors import DomainError, Mistake, ScenarioError
from seaglint.base.free_form import JsonObject
from seaglint.scenario.model import Scenario
from seaglint.scenario.records import sea_tables as requested_sea
from seaglint.scenario.records.sea_tables import FlatSea
from seaglint.sea.slopes.breon_henriot import breon_henriot
from seaglint.sea.slopes.cox_munk import cox_munk_anisotropic, cox_munk_gram_charlier, cox_munk_isotropic, cox_munk_slick
from seaglint.sea.slopes.from_spectrum import nested_in, spectrum_slopes
from seaglint.sea.slopes.slope_statistics import SlopeStatistics, at_least_residual, flat
from seaglint.sea.spectra.campaign_draws import SHORTEST, ShortWaveLevels, drawn_levels, drawn_sea
from seaglint.sea.spectra.combined import CombinedSpectrum, wind_sea
from seaglint.sea.spectra.directional import DirectionalSpectrum
from seaglint.sea.spectra.elfouhaily import ElfouhailySpectrum
from seaglint.sea.spectra.jonswap import JonswapSpectrum
from seaglint.sea.spectra.pierson_moskowitz import PiersonMoskowitzSpectrum
from seaglint.studies.build.measured_waves import Waves, has_winds, measured_waves

FEW_SLOPES: Final = 0.6  #: Slope variance of a spectrum over that of Cox and Munk's fit below which short waves are missing.

log = logging.getLogger(__name__)

_FILE_KEYS: Final = ("time", "site", "from_deg", "spreading_deg")  # keys of a file's table that only the file can find wrong


def waves(scenario: Scenario) -> Waves:
    """Return the waves of a scenario; with ``sea.uncertainty = "campaigns"`` those of a drawn sea.

    Raises
    ------
    ScenarioError
        Keys that a file or a model finds wrong or missing.
    DataError
        A file that cannot be read, or has nothing near the requested time and place.
    """
    specified = _specified(scenario)
    if scenario.sea.uncertainty == "none" or isinstance(scenario.sea.spectrum, FlatSea):
        return specified
    return replace(specified, spectrum=_drawn(scenario, specified.spectrum))


def _specified(scenario: Scenario) -> Waves:
    """Return the waves that the scenario specifies."""
    match scenario.sea.spectrum:
        case requested_sea.FlatSea():
            return Waves(None)
        case requested_sea.WaveSystems(systems=systems):
            _report_two_wind_seas(systems)
            parts = [_system(scenario, system, f"sea.spectrum.systems[{i}]") for i, system in enumerate(systems)]
            spectra = tuple(part.spectrum for part in parts if part.spectrum is not None)
            return Waves(CombinedSpectrum(spectra) if spectra else None, tuple(source for part in parts for source in part.sources))
        case single:
            return _system(scenario, single, "sea.spectrum")


def spectrum(scenario: Scenario) -> DirectionalSpectrum | None:
    """Return the wave spectrum; None for a sea without waves."""
    return waves(scenario).spectrum


def has_wind_sea(scenario: Scenario) -> bool:
    """Return true where waves come from a model of the wind sea, alone or with other systems."""
    table = scenario.sea.spectrum
    systems = table.systems if isinstance(table, requested_sea.WaveSystems) else (table,)
    return any(isinstance(system, requested_sea.Elfouhaily | requested_sea.PiersonMoskowitz) for system in systems)


def levels(scenario: Scenario) -> ShortWaveLevels:
    """Return the place of a drawn sea between the campaigns: as specified, or by the seed."""
    given = scenario.sea.short_wave_levels
    return drawn_levels(scenario.seed) if given is None else ShortWaveLevels(*given)


def _drawn(scenario: Scenario, longer: DirectionalSpectrum | None) -> DirectionalSpectrum | None:
    """Return a sea with drawn short waves and the longer ones of a spectrum."""
    speed, to = scenario.wind.speed_m_s, travel_azimuth(np.radians(scenario.wind.from_deg))
    return drawn_sea(speed, levels(scenario), to, longer, directed=has_wind_sea(scenario) or _is_measured(scenario))


def drawn_waves(scenario: Scenario) -> DirectionalSpectrum | None:
    """Return the spectrum of all waves of a drawn sea, from which its slopes follow; None for a sea without waves.

    With ``sea.spectrum.kind = "flat"`` no waves are geometry, and the longer ones of the slopes are Elfouhaily's.
    """
    if not isinstance(scenario.sea.spectrum, FlatSea):
        return spectrum(scenario)
    speed, to = scenario.wind.speed_m_s, travel_azimuth(np.radians(scenario.wind.from_deg))
    return None if speed == 0.0 else drawn_sea(speed, levels(scenario), to, elfouhaily(speed, to))


def drawn_sea_facts(scenario: Scenario) -> JsonObject:
    """Return the levels of a drawn sea, its slope variance and the wavenumber at which it ends, for the provenance; empty without one."""
    if scenario.sea.uncertainty == "none":
        return {}
    place, sea = levels(scenario), drawn_waves(scenario)
    return {
        "sea_uncertainty": scenario.sea.uncertainty,
        "short_wave_level_long": place.long,
        "short_wave_level_short": place.short,
        "drawn_sea_mss": 0.0 if sea is None else sum(sea.mss()),
        "drawn_sea_cut_rad_m": SHORTEST,
    }


@lru_cache(maxsize=64)
def _report_two_wind_seas(systems: tuple[requested_sea.System, ...]) -> None:
    """Report once a measured sea that is joined to a model of the wind sea beside another wind sea."""
    joined = [system.kind for system in systems if isinstance(system, requested_sea.MeasuredWaves) and system.longer_waves == "elfouhaily"]
    models = [system.kind for system in systems if isinstance(system, requested_sea.Elfouhaily | requested_sea.PiersonMoskowitz)]
    if joined and models:
        log.warning(
            "seaglint: sea.spectrum.systems: '%s' continues with the wind sea of Elfouhaily's spectrum and '%s' is a wind sea too: their "
            "energies add; set longer_waves = 'cut', or leave one out",
            joined[0],
            models[0],
        )


def _system(scenario: Scenario, system: requested_sea.System, key: str) -> Waves:
    """Return the waves of one system, whose table has the dotted name ``key``."""
    speed, to = scenario.wind.speed_m_s, travel_azimuth(np.radians(scenario.wind.from_deg))
    match system:
        case requested_sea.SpectrumFile():
            return _file(scenario, system, to, key)
        case requested_sea.Jonswap():
            return Waves(_jonswap(system, to, key))
        case requested_sea.AsitSea() | requested_sea.RadyoSea() | requested_sea.WavenumberFile():
            return measured_waves(system, speed, to, key)
        # Order matters: files and JONSWAP have waves without wind; the models of the wind sea below do not.
        case _ if speed == 0.0:
            return Waves(None)  # no wind, no wind sea
        case requested_sea.Elfouhaily():
            return Waves(elfouhaily(speed, to))
        case requested_sea.PiersonMoskowitz():
            return Waves(wind_sea(lambda wind: PiersonMoskowitzSpectrum.of_u10(wind, to), speed))
        case other:
            assert_never(other)


def elfouhaily(speed: float, to: float) -> DirectionalSpectrum:
    """Return Elfouhaily's wind sea of a wind above 0 m/s at 10 m that blows TO an azimuth [rad]."""
    return wind_sea(lambda wind: ElfouhailySpectrum(wind, to), speed)


def _jonswap(system: requested_sea.Jonswap, wind_to: float, key: str) -> JonswapSpectrum:
    to = wind_to if system.from_deg is None else travel_azimuth(np.radians(system.from_deg))
    try:
        return JonswapSpectrum(
            system.significant_height_m, system.peak_period_s, to, system.gamma, float(np.radians(system.spreading_deg)), wind_to
        )
    except DomainError as error:  # the ranges are the scenario's own: what is left is the steepness
        name = f"{key}.significant_height_m"
        raise _mistake(name, f"{name}: {error}", error) from error


def _file(scenario: Scenario, system: requested_sea.SpectrumFile, wind_to: float, key: str) -> Waves:
    from seaglint.formats.waves import WaveChoice, read_waves

    # The scenario's place is a default; a place or a site of the file's table replaces it.
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
        if error.name not in _FILE_KEYS:
            raise
        name = f"{key}.{error.name}"
        raise _mistake(name, f"{name} {error}", error) from error
    return Waves(read.spectrum, (read.report,))


def _mistake(key: str, text: str, error: DomainError) -> ScenarioError:
    return ScenarioError(text, mistakes=(Mistake(key, error.value, error.allowed, text),))


def slopes(scenario: Scenario) -> SlopeStatistics:
    """Return the slope statistics of the whole sea, with the covariances of longer waves; isotropic laws have no direction."""
    sea = spectrum(scenario)
    statistics = _law(scenario, sea)
    specified = scenario.sea.uncertainty == "none"
    if (specified and isinstance(scenario.sea.slopes, requested_sea.CoxMunkIsotropic)) or isinstance(scenario.sea.spectrum, FlatSea):
        return statistics
    if statistics.directed is None or statistics.directed >= 1.0:
        return statistics if sea is None else _nested(statistics, sea)
    return _nested(statistics, sea, spectrum(_without_wind(scenario)))


def _without_wind(scenario: Scenario) -> Scenario:
    """Return the scenario without wind and without the measured waves of winds."""
    table = scenario.sea.spectrum
    systems = table.systems if isinstance(table, requested_sea.WaveSystems) else (table,)
    # the wind seas of models are left out at 0 m/s anyway; measured ones have no spectrum there
    kept = tuple(system for system in systems if not isinstance(system, requested_sea.MeasuredWaves) or not has_winds(system))
    if len(kept) < len(systems):
        left = requested_sea.WaveSystems(systems=kept) if kept else FlatSea()  # type: ignore[arg-type]  # of a table of systems
        scenario = scenario.model_copy(update={"sea": scenario.sea.model_copy(update={"spectrum": left})})
    return scenario.model_copy(update={"wind": scenario.wind.model_copy(update={"speed_m_s": 0.0})})


@lru_cache(maxsize=256)
def _nested(statistics: SlopeStatistics, waves: DirectionalSpectrum | None, calm: DirectionalSpectrum | None = None) -> SlopeStatistics:
    return nested_in(statistics, waves, calm)


def _law(scenario: Scenario, sea: DirectionalSpectrum | None) -> SlopeStatistics:
    """Return the slope statistics by the scenario's slope law, which may be the spectrum of its waves."""
    speed, to = scenario.wind.speed_m_s, travel_azimuth(np.radians(scenario.wind.from_deg))
    if scenario.sea.uncertainty != "none":
        drawn = drawn_waves(scenario) if isinstance(scenario.sea.spectrum, FlatSea) else sea
        # A sea without wind still has residual slopes, as the fits of Cox and Munk have.
        return at_least_residual(SlopeStatistics(0.0, 0.0, to) if drawn is None else spectrum_slopes(drawn))
    match scenario.sea.slopes:
        case requested_sea.CoxMunkIsotropic(extrapolate=extrapolate):
            return cox_munk_isotropic(speed, extrapolate=extrapolate)
        case requested_sea.CoxMunkAnisotropic(extrapolate=extrapolate):
            return cox_munk_anisotropic(speed, to, extrapolate=extrapolate)
        case requested_sea.CoxMunkGramCharlier(extrapolate=extrapolate):
            return cox_munk_gram_charlier(speed, to, extrapolate=extrapolate)
        case requested_sea.CoxMunkSlick(extrapolate=extrapolate):
            return cox_munk_slick(speed, to, extrapolate=extrapolate)
        case requested_sea.BreonHenriot(extrapolate=extrapolate):
            return breon_henriot(speed, to, extrapolate=extrapolate)
        # A file may lack the short waves that carry most of the slopes; this is reported below.
        case requested_sea.SpectrumSlopes():
            statistics = SlopeStatistics(0.0, 0.0, to) if sea is None else spectrum_slopes(sea)
            # A calm wind sea still has residual slopes, as the fits of Cox and Munk have.
            if has_wind_sea(scenario):
                statistics = at_least_residual(statistics)
            if statistics.is_flat:
                return statistics
            _warn_of_few_slopes(statistics.mss, speed, _is_measured(scenario))
            return statistics
        case requested_sea.FlatSlopes():
            return flat()
        case other:
            assert_never(other)


def _is_measured(scenario: Scenario) -> bool:
    """Return true where all waves are a measured wavenumber spectrum."""
    return isinstance(scenario.sea.spectrum, requested_sea.MeasuredWaves)


@lru_cache(maxsize=64)
def _warn_of_few_slopes(mss: float, speed: float, measured: bool) -> None:
    """Report once that a spectrum lacks the short waves that carry most of the slopes."""
    # Cox and Munk's variance includes all waves, down to the shortest.
    expected = cox_munk_isotropic(speed, extrapolate=True).mss
    if mss < FEW_SLOPES * expected:
        log.warning(
            "seaglint: sea.slopes.kind = 'spectrum': all waves of sea.spectrum have a slope variance of %.2g, and the sea at %.3g m/s has "
            "%.2g (Cox and Munk): short waves are missing, glint is too narrow and too bright; %s",
            mss,
            speed,
            expected,
            "its key shorter_waves continues it with Elfouhaily's spectrum; check the units of a file"
            if measured
            else "set sea.slopes.kind = 'cox-munk-anisotropic'",
        )
