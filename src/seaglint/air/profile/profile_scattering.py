"""Scatterers of any profile and haze, and scattered sunlight of many cases.

``seaglint.air.scattering`` sums single scattering of sunlight over these scatterers. Cases that each have a wind, height, direction and
Sun are computed line by line, without a table (``scattered_cases``).
"""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import lru_cache
from typing import Final

import numpy as np

from seaglint.air.profile.absorber_densities import absorber_densities, refractivity
from seaglint.air.profile.aerosols import HUMID_TABLES, HazeWeather, aerosols, mean_humidity
from seaglint.air.profile.air_profile import AirProfile, lowtran_numbers, model_profile
from seaglint.air.profile.band_laws import BandLaws, Spectroscopy
from seaglint.air.profile.bent_ray import RefractingAir
from seaglint.air.scattering.gas_bands import CONTINUA
from seaglint.air.scattering.lowtran_ray import AEROSOLS, layer_amounts
from seaglint.air.scattering.scattered_line import HUMIDITIES, KINDS, NO_SUNS, many_amplitudes
from seaglint.air.scattering.scattering_laws import (
    AEROSOL_COLUMNS,
    AerosolLaws,
    AirLevels,
    ScatteringAir,
    SpectralLaws,
    grid_of,
    scattering_angle,
)
from seaglint.air.scattering.twilight import fading
from seaglint.base.conventions import FloatArray
from seaglint.base.limits import NAVY_AEROSOL_WIND
from seaglint.optics.band import Band

#: Wavenumber of the refractivity in cases evaluated one by one, whatever their bands [cm-1]: the middle of 2-5.5 um.
MODELS_REFRACTED_CM: Final = 3410.0

FINEST_KM: Final = 0.005  #: Thickness of the first piece of lines of sight in continuous air [km].

#: Levels that single scattering is summed over, in LOWTRAN7's layers as the program does, and in continuous air (a sounding of 800 levels
#: changes by 0.05 % in the median, 0.5 % at most); of profiles with more, those that interpolate the others best.
MOST_LEVELS: Final = (34, 150)

#: Aerosol models of the phase functions before the four for rising humidity.
HUMID_MODELS: Final = {
    "rural-23km": 0, "rural-5km": 0, "navy-maritime": 4, "maritime-23km": 4, "urban": 8, "tropospheric": 16,
}  # fmt: skip

FOG_MODELS: Final = {"advective-fog": 23, "radiative-fog": 24}
#: Aerosol models of fogs, and above the boundary layer: troposphere at 70 %, background stratosphere, meteoric dust.
ALOFT_MODELS: Final = (17, 20, 25)

#: Differences of equal weight when levels are left out: relative pressure [1], temperature [K], relative humidity [%].
_THINNING: Final = (0.002, 0.3, 2.0)

_THREADS: Final = min(os.cpu_count() or 1, 4)

SCATTERED_UM: Final = (2.0, 5.5)  #: Wavelengths of bands for which scattered sunlight is computed [um]; in 7.5-14 um it is negligible.

_PARTS: Final = 8  #: Parts of the work for each thread.


class Scatterers:
    """Scatterers of a profile on channels, for many hazes.

    Parameters
    ----------
    profile : AirProfile
        The air.
    wavenumber_cm : ndarray
        Channels [cm-1, (n,)].
    refracted_cm : float, optional
        Wavenumber of the refractivity [cm-1]; by default the middle of the channels.
    continuous : bool
        True for continuous air, false for LOWTRAN7's layers.
    spectroscopy : str
        Numbers of the band laws: ``lblrtm`` or ``lowtran7``.

    Examples
    --------
    >>> from seaglint.air.profile.air_profile import model_profile
    >>> air = Scatterers(model_profile("midlatitude-summer"), np.arange(2000.0, 2861.0, 5.0)).with_haze(HazeWeather(wind=7.0, wind_24h=7.0))
    >>> air.source.shape
    (173,)
    """

    def __init__(
        self,
        profile: AirProfile,
        wavenumber_cm: FloatArray,
        refracted_cm: float | None = None,
        *,
        continuous: bool = False,
        spectroscopy: Spectroscopy = "lblrtm",
    ) -> None:
        self._continuous = continuous
        self._profile = thin = thinned(profile, MOST_LEVELS[continuous])
        self._nu = nu = np.asarray(wavenumber_cm, dtype=np.float64)
        bands = BandLaws.of(nu, spectroscopy)
        self._cold_kelvin = bands.cold_kelvin
        self._spectral = SpectralLaws(nu, bands.continuum[: len(CONTINUA)], bands.gases)
        self._source = bands.source
        self._density = absorber_densities(thin, [c for c in self._spectral.columns if c not in AEROSOL_COLUMNS], bands.numbers.scaled)
        central_cm = 0.5 * float(nu[0] + nu[-1]) if refracted_cm is None else refracted_cm
        # layers that would trap rays are almost trapping here too: a ray must rise or fall through all of them
        self._refractivity = np.exp(RefractingAir.of(thin.height, refractivity(thin, central_cm), thin.earth_radius).log_refractivity)
        no_aerosol = np.zeros((AEROSOLS, thin.height.size))
        self._grid = grid_of(self._levels("none", no_aerosol, np.zeros(AEROSOLS)))

    def _levels(self, haze: str, density: FloatArray, tops: FloatArray) -> AirLevels:
        thin = self._profile
        return AirLevels(
            1e-3 * thin.earth_radius,
            1e-3 * thin.height,
            thin.pressure,
            thin.temperature,
            self._refractivity,
            _phase_humidity(haze, thin.relative_humidity),
            1e-3 * tops,
            np.concatenate([density, self._density]),
            self._cold_kelvin,
        )

    def with_haze(self, haze: HazeWeather, humidity: float | None = None) -> ScatteringAir:
        """Scatterers and absorbers with a haze.

        Hazes that grow with humidity have ``humidity`` [%], by default the mean one of the boundary layer above the sea, weighted with
        the haze.
        """
        thin = self._profile
        if humidity is None and haze.haze in HUMID_TABLES:
            dry = aerosols(thin, haze, self._nu, 0.0)
            # a level's weight is the amount of haze in the layer below it
            weight = np.concatenate([[0.0], 0.5 * (dry.density[0, :-1] + dry.density[0, 1:]) * np.diff(thin.height)])
            humidity = mean_humidity(thin.relative_humidity, weight)
        aerosol = aerosols(thin, haze, self._nu, humidity or 0.0)
        levels = self._levels(haze.haze, aerosol.density, aerosol.tops)
        amount = self._grid.amount.copy()
        amount[:, :, :AEROSOLS] = layer_amounts(np.diff(levels.height), aerosol.density)
        angle = np.radians(lowtran_numbers()["phase_angle_deg"])
        laws = AerosolLaws(aerosol.extinction, aerosol.absorption, angle, self._log_phase(haze.haze, aerosol.asymmetry[0]))
        finest = FINEST_KM if self._continuous else 0.0
        return ScatteringAir.assembled(self._spectral, levels, laws, self._source, self._grid._replace(amount=amount), finest)

    def _log_phase(self, haze: str, asymmetry: FloatArray) -> FloatArray:
        """Logarithm of the phase functions [(KINDS - 1, n, angles)], linear in wavelength as in LOWTRAN7."""
        tables = lowtran_numbers()
        out = _mie_phase(haze, tuple(self._nu.tolist()))
        if haze == "desert":  # LOWTRAN7 takes Henyey and Greenstein's function there
            out, cosine = out.copy(), np.cos(np.radians(tables["phase_angle_deg"]))
            g = asymmetry[:, None]
            out[: len(HUMIDITIES)] = np.log((1.0 - g**2) / (4.0 * np.pi * (1.0 + g**2 - 2.0 * g * cosine) ** 1.5))
        return out


def scattering_air(
    profile: AirProfile,
    haze: HazeWeather,
    wavenumber_cm: FloatArray,
    refracted_cm: float | None = None,
    humidity: float | None = None,
    *,
    continuous: bool = False,
    spectroscopy: Spectroscopy = "lblrtm",
) -> ScatteringAir:
    """Return ``Scatterers`` of a profile on channels [cm-1, (n,)] with one haze."""
    return Scatterers(profile, wavenumber_cm, refracted_cm, continuous=continuous, spectroscopy=spectroscopy).with_haze(haze, humidity)


@lru_cache(maxsize=8)
def model_scatterers(
    model: str, channels: tuple[float, ...], *, continuous: bool = False, spectroscopy: Spectroscopy = "lblrtm"
) -> Scatterers:
    """Return the scatterers of a model atmosphere on channels [cm-1]."""
    return Scatterers(model_profile(model), np.array(channels), MODELS_REFRACTED_CM, continuous=continuous, spectroscopy=spectroscopy)


def maritime(wind_speed: float) -> HazeWeather:
    """Return the Navy's haze at a wind [m s-1]; above 20 m/s the haze at 20 m/s, as in LOWTRAN7."""
    wind = min(float(wind_speed), NAVY_AEROSOL_WIND[1])
    return HazeWeather(wind=wind, wind_24h=wind)


def _phase_humidity(haze: str, humidity: FloatArray) -> FloatArray:
    """Humidity [%] of the phase functions: for the tropospheric haze LOWTRAN7 takes the next drier table."""
    return np.array(HUMIDITIES)[np.searchsorted(HUMIDITIES, humidity, side="right") - 1] if haze == "tropospheric" else humidity


def thinned(profile: AirProfile, most: int) -> AirProfile:
    """Return the profile with at most some levels: ends first, then the worst interpolated one after the other."""
    z = profile.height
    if z.size <= most:
        return profile
    scaled = np.stack(
        [np.log(profile.pressure) / _THINNING[0], profile.temperature / _THINNING[1], profile.relative_humidity / _THINNING[2]]
    )
    chosen = [0, z.size - 1]
    while len(chosen) < most:
        order = np.sort(chosen)
        # one level at a time: each new level changes which one is interpolated worst
        guess = np.array([np.interp(z, z[order], row[order]) for row in scaled])
        chosen.append(int(np.argmax(np.abs(scaled - guess).max(axis=0))))
    i = np.sort(chosen)
    parts = (profile.height[i], profile.pressure[i], profile.temperature[i], profile.vapour[i], profile.gas[:, i])
    return AirProfile(profile.name, *parts, profile.earth_radius, profile.season, profile.haze_humidity)


@lru_cache(maxsize=8)
def _mie_phase(haze: str, channels: tuple[float, ...]) -> FloatArray:
    """Logarithm of the tabulated phase functions [(KINDS - 1, n, angles)]."""
    tables = lowtran_numbers()
    first = HUMID_MODELS.get(haze, 4)
    boundary_layer = [FOG_MODELS[haze]] * len(HUMIDITIES) if haze in FOG_MODELS else [first + i for i in range(len(HUMIDITIES))]
    table, nodes, um = tables["log_phase"][[*boundary_layer, *ALOFT_MODELS]], tables["phase_um"], 1e4 / np.array(channels)
    left = np.clip(np.searchsorted(nodes, um, side="right") - 1, 0, nodes.size - 2)
    fraction = ((um - nodes[left]) / (nodes[left + 1] - nodes[left]))[:, None]
    out = np.asarray((1.0 - fraction) * table[:, left] + fraction * table[:, left + 1])
    out.flags.writeable = False
    return out


def scattered_cases(model: str, lines: FloatArray, bands: Sequence[Band], *, continuous: bool = False) -> list[FloatArray]:
    """Scattered radiance of cases in bands, Sun at 1 au [W m-2 sr-1, (cases,)], in LOWTRAN7's layers or continuous, with its band laws.

    ``lines`` [(cases, 5)]: wind [m s-1], height [m], then elevation, azimuth from the Sun and the Sun's zenith angle without refraction at
    the sensor [rad]. Below the horizon the Sun scatters as in ``seaglint.air.scattering.twilight``.
    """
    if not bands:
        return []
    grid = lowtran_numbers()["wavenumber_cm"]
    weights = np.array([band.weights(grid) for band in bands])
    used = weights.any(axis=0)
    table = model_scatterers(model, tuple(grid[used].tolist()), continuous=continuous, spectroscopy="lowtran7")
    weights = weights[:, used]
    out = np.empty((len(bands), len(lines)))
    size = max(-(-len(lines) // (_THREADS * _PARTS)), 1)

    def fill(first: int) -> None:
        for i in range(first, min(first + size, len(lines))):
            out[:, i] = weights @ _case_spectrum(table, lines[i])

    with ThreadPoolExecutor(_THREADS) as pool:  # kernels release the interpreter
        list(pool.map(fill, range(0, len(lines), size)))
    return list(out)


def scatters_in(band_um: tuple[float, float]) -> bool:
    """True if scattered sunlight of a band [um] is computed."""
    return SCATTERED_UM[0] * (1.0 - 1e-9) <= band_um[0] and band_um[1] <= SCATTERED_UM[1] * (1.0 + 1e-9)


def _case_spectrum(table: Scatterers, line: FloatArray) -> FloatArray:
    """Spectrum of scattered sunlight of one case [W m-2 sr-1 per cm-1, (n,)]."""
    wind, height, elevation, azimuth, zenith = (float(x) for x in line)
    air = table.with_haze(maritime(wind))
    share = fading(float(air.apparent_zenith(zenith)))
    if share <= 0.0:
        return np.zeros(air.source.size)
    view = 0.5 * math.pi - elevation
    amplitude, arc = np.empty((1, KINDS, air.source.size)), np.empty(1)
    many_amplitudes(air.laws, 1e-3 * height, np.array([[view, azimuth, zenith]]), (0, 1), NO_SUNS, amplitude, arc)
    phase = air.phase(scattering_angle(view, azimuth, air.apparent_zenith(zenith, height)))
    return np.asarray(share * air.source * (phase * amplitude[0]).sum(axis=0))
