"""Transmittance of a path through air of one temperature and pressure: a cell, a lidar's path, a level line over the sea."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from seaglint.air.profile.absorber_densities import absorber_densities, cold_share
from seaglint.air.profile.aerosols import NAMES, HazeWeather, aerosols
from seaglint.air.profile.air_profile import GASES, AirProfile, lowtran_numbers, saturation_density
from seaglint.air.profile.band_laws import FITTED_UP_TO, GRAM_PER_HPA, BandLaws, Spectroscopy
from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError
from seaglint.base.limits import PROFILE_BAND_UM
from seaglint.base.reports import REPORTS
from seaglint.optics.band import Band
from seaglint.optics.blackbody import planck_wavenumber

MOST_PPMV: Final = 50_000.0  #: Largest amount of a trace gas [1e-6 of the volume of dry air]: laws for traces in air do not hold for more.

FITTED_K: Final = (200.0, 310.0)  #: Temperatures of the paths to which ``lblrtm`` is fitted [K].

#: Largest amounts of the traces to which ``lblrtm`` is fitted [1e-6 of the volume of dry air].
FITTED_PPMV: Final = {"CO2": 1000.0, "O3": 10.0, "N2O": 1.0, "CO": 1.0, "CH4": 5.0}

EVEN_HEIGHTS: Final = np.array([0.0, 5e4, 1e5])  #: Levels of even air [m].

OXYGEN: Final = 0.209  #: Oxygen of dry air [1 of the volume].

#: Amounts of nitrogen and oxygen by number, and the bands [cm-1] in which RRTMGP's tables hold their absorption.
OF_AIR: Final = {4: (2390.0, 2680.0), 63: (1480.0, 1800.0), 1: (1480.0, 1800.0), 2: (1480.0, 1800.0)}

_LIMITS: Final = {"temperature_k": (150.0, 400.0, "K"), "pressure_hpa": (0.01, 1100.0, "hPa"), "length_km": (0.0, 10_000.0, "km")}


@dataclass(frozen=True, eq=False)
class PathSpectrum:
    """Spectrum of a path."""

    wavenumber_cm: FloatArray  #: Channels [cm-1, (n,)].
    transmittance: FloatArray  #: Transmittance [1, (n,)].
    mean: float  #: Mean over the band, weighted with the blackbody at the path's temperature [1].


def homogeneous_spectrum(
    *,
    temperature_k: float,
    pressure_hpa: float,
    vapour_pressure_hpa: float,
    length_km: float,
    band_um: tuple[float, float],
    ppmv: dict[str, float],
    spectroscopy: Spectroscopy,
    haze: HazeWeather,
) -> PathSpectrum:
    """Compute the transmittance of a path through air of one temperature [K] and pressure [hPa].

    The product of the gases' transmittances and of ``exp(-k length)`` with the extinction ``k = scattering + absorption`` of the aerosol;
    gases by a fit to numbers of LBLRTM (Pincus, Mlawer and Delamere 2019) or by LOWTRAN7 (Kneizys et al. 1988).

    Parameters
    ----------
    temperature_k, pressure_hpa, vapour_pressure_hpa, length_km : float
        Temperature [K], pressure of all air and of its water vapour [hPa], length [km].
    band_um : (float, float)
        Shortest and longest wavelength [um], within 0.7-14.7.
    ppmv : dict of float
        Gases of ``GASES`` but water [1e-6 of the volume of dry air]; 0 for gases not named.
        Nitrogen and oxygen have their shares of air and, with ``lblrtm``, absorb in RRTMGP's bands of them, 2390-2680 and 1480-1800 cm-1.
    spectroscopy : str
        Numbers of the band laws: ``lblrtm`` or ``lowtran7``.
    haze : HazeWeather
        Aerosol at the sea.

    Returns
    -------
    PathSpectrum
        Transmittance [1] by wavenumber, and its mean over the band.

    Raises
    ------
    DomainError
        A number outside its range, a name that is not known, or a band outside 0.7-14.7 um.
    """
    given = {"temperature_k": temperature_k, "pressure_hpa": pressure_hpa, "length_km": length_km}
    for name, (low, high, unit) in _LIMITS.items():
        if not low <= given[name] <= high:
            raise DomainError(
                f"{name} = {given[name]:g} is not within {low:g} to {high:g} {unit}", name=name, value=given[name], allowed=(low, high)
            )
    if not 0.0 <= vapour_pressure_hpa < pressure_hpa:
        raise DomainError(
            f"vapour_pressure_hpa = {vapour_pressure_hpa:g} is not from 0 to below the pressure, {pressure_hpa:g} hPa; "
            "give the part of the pressure that is water vapour",
            name="vapour_pressure_hpa",
            value=vapour_pressure_hpa,
            allowed=(0.0, pressure_hpa),
        )
    for name, amount in ppmv.items():
        if not 0.0 <= amount <= MOST_PPMV:
            key = f"{name.lower()}_ppmv"
            raise DomainError(
                f"{key} = {amount:g} is not within 0 to {MOST_PPMV:g} parts per million of dry air; "
                "the laws hold for traces of a gas in air",
                name=key,
                value=amount,
                allowed=(0.0, MOST_PPMV),
            )
    if spectroscopy not in ("lblrtm", "lowtran7"):
        raise DomainError(
            f"spectroscopy = {spectroscopy!r} is not known; give lblrtm or lowtran7",
            name="spectroscopy",
            value=spectroscopy,
            allowed="lblrtm, lowtran7",
        )
    if haze.haze not in NAMES:
        known = ", ".join(NAMES)
        raise DomainError(f"haze = {haze.haze!r} is not known; give one of {known}", name="haze", value=haze.haze, allowed=known)
    band = _band(band_um, spectroscopy)
    _report_unusual(temperature_k, vapour_pressure_hpa, ppmv)
    nu = lowtran_numbers()["wavenumber_cm"]
    low, high = 1e4 / band.max_um, 1e4 / band.min_um
    # one channel beyond each edge, as the band's weights need a grid that covers it
    nu = nu[(nu > low - 5.0 - 1e-6) & (nu < high + 5.0 + 1e-6)]
    laws = BandLaws.of(nu, spectroscopy)
    profile = even_air(temperature_k, pressure_hpa, vapour_pressure_hpa, ppmv)
    amounts = length_km * absorber_densities(profile, laws.columns, laws.numbers.scaled)[:, 0]
    amounts[laws.columns.index(9)] = amounts[laws.columns.index(5)] * cold_share(np.array(temperature_k), laws.cold_kelvin)
    depth = laws.optical_depth(amounts[None])[0]
    if spectroscopy == "lblrtm":
        # outside RRTMGP's bands of nitrogen and oxygen LBLRTM's numbers have no absorption by them
        for column, (first, last) in OF_AIR.items():
            outside = (nu < first) | (nu >= last)
            row = laws.columns.index(column)
            depth -= np.where(outside, amounts[row] * laws.continuum[row], 0.0)
    if haze.haze != "none":
        aerosol = aerosols(profile, haze, nu, float(profile.relative_humidity[0]))
        depth = depth + length_km * aerosol.density[:, 0] @ aerosol.extinction
    transmittance = np.exp(-depth)
    weights = band.weights(nu) * planck_wavenumber(nu, temperature_k)
    return PathSpectrum(nu, transmittance, float(weights @ transmittance / weights.sum()))


def _report_unusual(kelvin: float, vapour_pressure: float, ppmv: dict[str, float]) -> None:
    """Report air outside the range of the fit, and air above saturation."""
    if not FITTED_K[0] <= kelvin <= FITTED_K[1]:
        REPORTS.warning("temperature_k = %g is outside %g to %g K, for which absorption was fitted", kelvin, *FITTED_K)
    saturated = float(saturation_density(kelvin)) * kelvin / GRAM_PER_HPA
    if vapour_pressure > 1.05 * saturated:
        REPORTS.warning("vapour_pressure_hpa = %g is above saturation, %.3g hPa at %g K", vapour_pressure, saturated, kelvin)
    for name, amount in ppmv.items():
        if amount > FITTED_PPMV.get(name, np.inf):
            REPORTS.warning(
                "%s_ppmv = %g: absorption was fitted to traces as in air, up to %g parts per million",
                name.lower(),
                amount,
                FITTED_PPMV[name],
            )


def _band(band_um: tuple[float, float], spectroscopy: Spectroscopy) -> Band:
    """Rectangular band within the range of the numbers."""
    shortest, longest = (float(edge) for edge in band_um)
    if not PROFILE_BAND_UM[0] <= shortest < longest <= PROFILE_BAND_UM[1]:
        raise DomainError(
            f"band_um = {shortest:g} to {longest:g} is not an ascending band within {PROFILE_BAND_UM[0]:g} to {PROFILE_BAND_UM[1]:g} um, "
            "for which absorption is known",
            name="band_um",
            value=(shortest, longest),
            allowed=PROFILE_BAND_UM,
        )
    if spectroscopy == "lblrtm" and 1e4 / shortest > FITTED_UP_TO * (1.0 + 1e-9):
        REPORTS.warning(
            "band %g-%g um: wavelengths below %.4g um (%g cm-1) have LOWTRAN7's absorption, that of LBLRTM ends there",
            shortest,
            longest,
            1e4 / FITTED_UP_TO,
            FITTED_UP_TO,
        )
    return Band.rectangular(shortest, longest)


def even_air(kelvin: float, pressure: float, vapour_pressure: float, ppmv: dict[str, float]) -> AirProfile:
    """Return a profile of air that is the same up to 100 km: temperature [K], pressure and vapour pressure [hPa].

    ``ppmv``: gases except water [1e-6 of the volume of dry air]; the profile has them per volume of all air, as all profiles do.
    """
    dry = 1.0 - vapour_pressure / pressure
    gas = np.zeros((len(GASES), EVEN_HEIGHTS.size))
    gas[GASES.index("O2")] = 1e6 * OXYGEN * dry
    for name, amount in ppmv.items():
        gas[GASES.index(name)] = amount * dry
    same = np.ones(EVEN_HEIGHTS.size)
    vapour = GRAM_PER_HPA * vapour_pressure / kelvin
    return AirProfile("even air", EVEN_HEIGHTS, pressure * same, kelvin * same, vapour * same, gas, 6371.23e3, "spring")
