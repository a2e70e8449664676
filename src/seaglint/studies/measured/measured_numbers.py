"""Measured numbers beside ours, the tables of measurements in the package, and the choice of the absorption."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from functools import cache
from importlib.resources import files
from typing import Final, NamedTuple, get_args

import numpy as np

from seaglint.air.profile.aerosols import HazeWeather
from seaglint.air.profile.air_profile import GASES, AirProfile
from seaglint.air.profile.air_sums import AirSums
from seaglint.air.profile.band_laws import Spectroscopy
from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError
from seaglint.base.free_form import JsonObject
from seaglint.optics.band import Band, apparent_temperature


@dataclass(frozen=True, kw_only=True)
class MeasuredRow:
    """Measured number, or a number of another model, beside ours."""

    case: str  #: Measurement.
    quantity: str  #: Its band or property.
    spectroscopy: str  #: Absorption of ours; empty for waves.
    unit: str  #: Unit of both numbers.
    ours: float  #: Our number.
    measured: float  #: Measured number.
    difference_percent: float  #: Ours less measured, of band radiance where the unit is K [%].
    difference_k: float | None = None  #: Difference of temperatures [K]; None without temperatures.
    #: Root of the mean square difference over 20 cm-1 channels [K], or over paths or skies [unit]; None for single numbers.
    rms: float | None = None
    uncertainty: str = ""  #: Uncertainty of the measurement.
    reason: str = ""  #: A sentence on the remaining difference.

    def as_dict(self) -> JsonObject:
        """Return plain numbers and text; None for numbers that do not exist."""
        return {name: None if isinstance(value, float) and np.isnan(value) else value for name, value in asdict(self).items()}


@dataclass(frozen=True)
class BandDifference:
    """Two spectra in a band: apparent temperatures, difference of radiance, and of the channels."""

    ours: float  #: Our apparent temperature [K]; NaN for a band that has no light.
    measured: float  #: Measured apparent temperature [K]; NaN for a band that has no light.
    percent: float  #: Difference of band radiance, ours less measured [%].
    rms: float  #: Root of the mean square difference of brightness temperature over the samples in the band [K].

    @property
    def kelvin(self) -> float:
        """Return the difference of the temperatures [K]."""
        return self.ours - self.measured


def band_difference(
    wavenumber_cm: FloatArray, ours: FloatArray, measured: FloatArray, band_um: tuple[float, float], kelvin: tuple[FloatArray, FloatArray]
) -> BandDifference:
    """Compare two spectra [W m-2 sr-1 per cm-1, (n,)], whose temperatures are ``kelvin`` [K], over wavelengths [um]."""
    band = Band.rectangular(*band_um)
    weights = band.weights(wavenumber_cm)
    light = np.array([ours @ weights, measured @ weights])
    temperatures = apparent_temperature(light, band, wavenumber_cm)
    inside = weights > 0.0
    rms = float(np.sqrt(np.nanmean((kelvin[0] - kelvin[1])[inside] ** 2))) if inside.any() else float("nan")
    # A band without measured light has no relative difference.
    percent = float(100.0 * (light[0] / light[1] - 1.0)) if light[1] > 0.0 else float("nan")
    return BandDifference(float(temperatures[0]), float(temperatures[1]), percent, rms)


class ShippedTable(NamedTuple):
    """Columns of numbers by name, and the facts of the lines before them: source, terms, processing."""

    columns: dict[str, FloatArray]
    facts: dict[str, str]


@cache
def shipped(name: str) -> ShippedTable:
    """Return the table ``measured_<name>.csv`` of the package.

    Examples
    --------
    >>> shipped("modtran_path").facts["terms"]
    'MIT licence of pyradi'
    """
    lines = files("seaglint.studies").joinpath("data", f"measured_{name}.csv").read_text(encoding="utf-8").splitlines()
    facts = dict(line.removeprefix("# ").split(": ", 1) for line in lines if line.startswith("#"))
    head, *rows = (line for line in lines if not line.startswith("#"))
    return ShippedTable(dict(zip(head.split(","), np.loadtxt(rows, delimiter=",", ndmin=2).T, strict=True)), facts)


#: Numbers fitted to today's line-by-line models, and LOWTRAN7's own.
SPECTROSCOPIES: Final[tuple[Spectroscopy, ...]] = get_args(Spectroscopy)


def chosen_spectroscopies(name: str) -> tuple[Spectroscopy, ...]:
    """Return the spectroscopies of a name: one of them, or ``both``.

    Raises
    ------
    DomainError
        An unknown name.

    Examples
    --------
    >>> chosen_spectroscopies("lowtran7")
    ('lowtran7',)
    """
    chosen = tuple(one for one in SPECTROSCOPIES if name in (one, "both"))
    if not chosen:
        allowed = ", ".join([*SPECTROSCOPIES, "both"])
        raise DomainError(f"spectroscopy = '{name}' is not one of {allowed}", name="spectroscopy", value=name, allowed=allowed)
    return chosen


def sums_with(spectroscopy: Spectroscopy, profile: AirProfile, haze: HazeWeather, wavenumber_cm: FloatArray) -> AirSums:
    """Return the sums of a profile and haze on channels [cm-1, (n,)] with an absorption."""
    return AirSums(profile, haze, wavenumber_cm, spectroscopy=spectroscopy)


def with_gas(profile: AirProfile, gas: str, ppm: float) -> AirProfile:
    """Return a profile with a gas scaled to a mixing ratio at its lowest level [1e-6 of the volume]."""
    row = GASES.index(gas)
    amounts = profile.gas.copy()
    amounts[row] *= ppm / amounts[row, 0]
    return replace(profile, gas=amounts)


def without_gases(profile: AirProfile, gases: tuple[str, ...]) -> AirProfile:
    """Return a profile without some gases."""
    amounts = profile.gas.copy()
    amounts[[GASES.index(gas) for gas in gases]] = 0.0
    return replace(profile, gas=np.asarray(amounts))
