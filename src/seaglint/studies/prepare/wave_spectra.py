"""Wave spectra as a scenario wants them: models at its wind, files, and sums of both."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, assert_never

import numpy as np

from seaglint.base.conventions import travel_azimuth
from seaglint.base.errors import DomainError, Mistake, ScenarioError
from seaglint.base.free_form import JsonObject
from seaglint.scenario.model import Scenario
from seaglint.scenario.records import sea_spectrum as wanted
from seaglint.sea.slopes.light_winds import LIGHTEST
from seaglint.sea.spectra.calm import CalmSpectrum
from seaglint.sea.spectra.directional import DirectionalSpectrum
from seaglint.sea.spectra.elfouhaily import ElfouhailySpectrum
from seaglint.sea.spectra.jonswap import JonswapSpectrum
from seaglint.sea.spectra.pierson_moskowitz import PiersonMoskowitzSpectrum
from seaglint.sea.spectra.systems import CombinedSpectrum

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
    from seaglint.files.waves import WaveChoice, read_waves

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
