"""Aerosols of LOWTRAN7 over the heights of a profile: density, extinction and absorption of the regions, whatever the haze.

Up to 2 km lies the boundary layer's haze, then the troposphere's up to 10 km, the stratosphere's up to 30 km, meteoric dust above.
Densities are extinctions at 0.55 um [km-1]; coefficients are relative to these extinctions.

References
----------
LOWTRAN7's subroutines AERPRF, EXABIN, MARINE and DESATT; Gathman, S. G. (1983), Optical properties of the marine aerosol as predicted by
the Navy aerosol model, Opt. Eng. 22, 57-62; Shettle, E. P., and R. W. Fenn (1979), AFGL-TR-79-0214.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy.optimize import brentq

from seaglint.air.profile.air_profile import AirProfile, lowtran_numbers
from seaglint.base.conventions import FloatArray

VISIBILITIES: Final = (50.0, 23.0, 10.0, 5.0, 2.0)  #: Visibilities of the profiles up to 2 km [km].

#: Hazes of the boundary layer.
NAMES: Final = (
    "none", "rural-23km", "rural-5km", "navy-maritime", "maritime-23km", "urban", "tropospheric", "advective-fog", "radiative-fog",
    "desert",
)  # fmt: skip

#: Default visibility of a haze [km]; the visibilities of the Navy's and the desert's follow from the weather.
DEFAULT_VISIBILITY: Final = {
    "rural-23km": 23.0, "rural-5km": 5.0, "maritime-23km": 23.0, "urban": 5.0, "tropospheric": 50.0, "advective-fog": 0.2,
    "radiative-fog": 0.5,
}  # fmt: skip

#: Tables of the hazes whose droplets grow with humidity.
HUMID_TABLES: Final = {
    "rural-23km": "rural",
    "rural-5km": "rural",
    "maritime-23km": "ocean",
    "urban": "urban",
    "tropospheric": "troposphere",
}

HUMIDITIES: Final = np.array([0.0, 70.0, 80.0, 99.0])  #: Relative humidities of these tables [%].

TROPOSPHERE_HUMIDITY: Final = 70.0  #: Humidity of the troposphere's aerosol above the boundary layer [%].

DROPLET_KINK: Final = 2.2 + 0.5 / 5.866  #: Wind of the last 24 hours up to which the Navy's second size of droplets is constant [m s-1].

CLEAR_MOLECULES: Final = 0.01159  #: Extinction of clean air at 0.55 um [km-1].

CONTRAST: Final = 3.912  #: Koschmieder's constant: visibility times extinction.


@dataclass(frozen=True)
class HazeWeather:
    """Choice of a haze and the weather that it depends on."""

    haze: str = "navy-maritime"  #: Name of the boundary layer's aerosol, ``none`` for no aerosol at any height.
    visibility_km: float | None = None  #: Meteorological range at the sea [km]; None leaves it to the haze.
    air_mass: int = 3  #: Character of the air mass, 1 open ocean to 10 continental (Navy).
    wind: float = 0.0  #: Present wind [m s-1], at most 20 for the Navy's haze.
    wind_24h: float = 0.0  #: Mean wind over a day [m s-1], at most 20 for the Navy's haze.


@dataclass(frozen=True, eq=False)
class Aerosols:
    """Aerosols of four regions."""

    density: FloatArray  #: Extinction at 0.55 um [km-1, (4, levels)].
    tops: FloatArray  #: Highest levels of the regions [m, (4,)].
    extinction: FloatArray  #: Extinction over extinction at 0.55 um, on the channels [1, (4, n)].
    absorption: FloatArray  #: Absorption over extinction at 0.55 um, on the channels [1, (4, n)].
    asymmetry: FloatArray  #: Mean cosine of the scattering angle [1, (4, n)].
    visibility_km: float  #: Meteorological range at the sea that was used [km].


def aerosols(profile: AirProfile, weather: HazeWeather, wavenumber_cm: FloatArray, humidity: float) -> Aerosols:
    """Return the aerosols of a profile on channels [cm-1, (n,)].

    ``humidity`` [%] is the boundary layer's, for hazes with a table over humidity: LOWTRAN7 takes the mean along a path, weighted by
    the haze (``mean_humidity``). The Navy's haze takes the humidity of the lowest level.
    """
    tables, um = lowtran_numbers(), 1e4 / wavenumber_cm
    surface = profile.relative_humidity[0] if profile.haze_humidity is None else profile.haze_humidity
    boundary_layer, visibility = _boundary_layer(weather, float(surface), humidity)
    kinds = [boundary_layer, _humid("troposphere", TROPOSPHERE_HUMIDITY), tables["aerosol_stratosphere"], tables["aerosol_meteoric"]]
    edges = (2e3, 10e3, 30e3)
    if weather.haze == "tropospheric":  # LOWTRAN7 continues with the same region up to 10 km
        kinds, edges = [kinds[0], kinds[2], kinds[3], kinds[3]], (10e3, 30e3, np.inf)
    region = np.searchsorted(np.array(edges), profile.height, side="left")
    haze = haze_by_height(profile, visibility) if weather.haze != "none" else np.zeros(profile.height.size)
    density = np.where(region == np.arange(4)[:, None], haze, 0.0)
    tops = np.array([max([0.0, *profile.height[region == r]]) for r in range(4)])
    spectra = np.array([[np.interp(um, tables["haze_um"], quantity) for quantity in kind] for kind in kinds])
    if weather.haze == "none":
        spectra[:] = 0.0
    return Aerosols(density, tops, spectra[:, 0], spectra[:, 1], spectra[:, 2], visibility)


def haze_by_height(profile: AirProfile, visibility_km: float) -> FloatArray:
    """Extinction of the aerosol at 0.55 um [km-1, (levels,)], between LOWTRAN7's heights exponential."""
    tables = lowtran_numbers()
    height, layers = tables["haze_height"], tables["haze_below"]
    # between two tabulated visibilities the haze is linear in 1/visibility, as the extinction is
    j = int(next((i for i in range(1, 5) if visibility_km >= VISIBILITIES[i]), 4))
    a, b = VISIBILITIES[j - 1], VISIBILITIES[j]
    inverse = 1.0 / (1.0 / b - 1.0 / a)
    haze = inverse * ((layers[j] - layers[j - 1]) / visibility_km + layers[j - 1] / b - layers[j] / a)
    season = "fall" if profile.season == "fall" else "spring"
    hazy, clear = tables[f"haze_{season}-23km"], tables[f"haze_{season}-50km"]
    interpolated = ((hazy - clear) / visibility_km + clear / 23.0 - hazy / 50.0) / (1.0 / 23.0 - 1.0 / 50.0)
    troposphere = hazy if visibility_km <= 23.0 else np.where(height <= 4.0, interpolated, clear)
    haze = np.where(height <= 2.0, haze, troposphere)
    haze = np.where(height > 10.0, tables[f"haze_stratosphere-{season}"], haze)
    haze = np.maximum(np.where(height > 30.0, tables["haze_upper"], haze), 0.0)
    z = 1e-3 * profile.height
    i = np.clip(np.searchsorted(height, z + 1e-6, side="right") - 1, 0, height.size - 2)
    fraction = np.clip((z - height[i]) / (height[i + 1] - height[i]), 0.0, 1.0)
    low, high = haze[i], haze[i + 1]
    exponential = (low > 0.0) & (high > 0.0)
    return np.asarray(
        np.where(exponential, np.where(exponential, low, 1.0) ** (1.0 - fraction) * np.where(exponential, high, 1.0) ** fraction, 0.0)
    )


def mean_humidity(humidity: FloatArray, amount: FloatArray) -> float:
    """Humidity [%] of a haze by LOWTRAN7: ``100 - exp(mean log(100 - min(RH, 99)))``, weighted with amounts; 0 without haze."""
    total = float(np.sum(amount))
    if total <= 0.0:
        return 0.0
    return float(100.0 - np.exp(np.sum(amount * np.log(100.0 - np.minimum(humidity, 99.0))) / total))


def _boundary_layer(weather: HazeWeather, surface_humidity: float, humidity: float) -> tuple[FloatArray, float]:
    """Extinction, absorption and asymmetry [(3, 47)] of the boundary layer's aerosol, and the visibility [km]."""
    tables = lowtran_numbers()
    given = weather.visibility_km or 0.0
    match weather.haze:
        case "none":
            return np.zeros((3, tables["haze_um"].size)), 23.0
        case "navy-maritime":
            return _navy(weather, surface_humidity, given)
        case "desert":
            return _desert(weather.wind, given)
        case "advective-fog" | "radiative-fog":
            return tables[f"aerosol_{weather.haze}"], given or DEFAULT_VISIBILITY[weather.haze]
        case _:
            return _humid(HUMID_TABLES[weather.haze], humidity), given or DEFAULT_VISIBILITY[weather.haze]


def _humid(table: str, humidity: float) -> FloatArray:
    """Coefficients [(3, 47)] of an aerosol at a relative humidity [%], logarithms linear in ``log(100 - RH)``."""
    values = lowtran_numbers()[f"aerosol_{table}"]
    # LOWTRAN7's tables end at 99 %, and the logarithm of 100 - RH at 100 %
    x, at = np.log(100.0 - min(humidity, 99.0)), np.log(100.0 - HUMIDITIES)
    i = min(int(np.searchsorted(HUMIDITIES, humidity, side="right")), 3) - 1
    fraction = (x - at[i]) / (at[i + 1] - at[i])
    logs = np.log(np.maximum(values, 1e-300))
    return np.asarray(np.exp((1.0 - fraction) * logs[:, i] + fraction * logs[:, i + 1]))


def _navy(weather: HazeWeather, humidity: float, visibility: float) -> tuple[FloatArray, float]:
    """Navy maritime aerosol: three sizes of droplets, grown by humidity, raised by the wind."""
    tables = lowtran_numbers()
    rh = min(max(humidity, 50.0), 98.0)
    # Gathman's growth of the radius of droplets with humidity
    f = ((2.0 - rh / 100.0) / (6.0 * (1.0 - rh / 100.0))) ** 0.33333
    wind, daily_wind = max(min(weather.wind, 20.0), 1e-3), max(min(weather.wind_24h, 20.0), 1e-3)
    # numbers of the three sizes of droplets: by air mass, by the mean wind of the day, by the wind
    numbers = np.array([2000.0 * weather.air_mass**2, max(5.866 * (daily_wind - 2.2), 0.5), 10.0 ** (0.06 * wind - 2.8)])
    nodes = tables["navy_humidity"]
    j = max(int(np.searchsorted(nodes, rh)), 1)
    fraction = (rh - nodes[j - 1]) / (nodes[j] - nodes[j - 1])
    logs = (1.0 - fraction) * tables["navy"][:, j - 1] + fraction * tables["navy"][:, j]
    # column 3 is 0.55 um, to which coefficients are relative
    green = 10.0 ** logs[:3, 3] @ numbers
    spectra = np.zeros((3, tables["haze_um"].size))
    spectra[0, :40] = numbers @ 10.0 ** logs[:3] / green
    spectra[1, :40] = numbers @ 10.0 ** logs[3:] / green
    return spectra, visibility or CONTRAST / (np.pi / 1000.0 * green / f + CLEAR_MOLECULES)


def _desert(wind: float, visibility: float) -> tuple[FloatArray, float]:
    """Desert aerosol: exponential between winds of 0, 10, 20 and 30 m/s, and beyond."""
    table = lowtran_numbers()["desert"]
    i = min(int(wind / 10.0), 2)
    fraction = wind / 10.0 - i
    spectra = np.empty((3, table.shape[-1]))
    spectra[:2] = np.exp((1.0 - fraction) * np.log(table[:2, i]) + fraction * np.log(table[:2, i + 1]))
    spectra[2] = (1.0 - fraction) * table[2, i] + fraction * table[2, i + 1]
    green = spectra[0, 3]
    spectra[:2] /= green
    return spectra, visibility or CONTRAST / (green + CLEAR_MOLECULES)


def wind_kinks(profile: AirProfile) -> tuple[float, ...]:
    """Winds at which the Navy's haze changes its law over a profile [m s-1, ascending]: number of droplets, and visibility tables."""
    surface = float(profile.relative_humidity[0] if profile.haze_humidity is None else profile.haze_humidity)

    def excess(wind: float, visibility: float) -> float:
        return _navy(HazeWeather(wind=wind, wind_24h=wind), surface, 0.0)[1] - visibility

    low, high = DROPLET_KINK, 20.0
    # more wind, less visibility: a table is crossed once, if its visibility lies between the ends
    crossed = [v for v in VISIBILITIES[1:] if excess(low, v) > 0.0 > excess(high, v)]
    return (DROPLET_KINK, *sorted(float(brentq(excess, low, high, args=(v,))) for v in crossed))
