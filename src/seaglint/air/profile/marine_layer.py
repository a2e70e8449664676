r"""Lowest air over a sea of another temperature: profiles of temperature and humidity by similarity, joined to the air above.

.. math:: \theta(z) = \theta_s + \frac{\theta_*}{\kappa} \left[\ln\frac{z}{z_{0t}} - \psi_h\!\left(\frac{z}{L}\right)\right]

(Monin and Obukhov 1954), specific humidity alike, with the roughness lengths and stability functions of COARE 3.0.

References
----------
Fairall, C. W., et al. (2003), Bulk parameterization of air-sea fluxes: updates and verification for the COARE algorithm, J. Climate 16,
571-591 (Eqs. 11, 16, 26-28, Appendix); Beljaars, A. C. M., and A. A. M. Holtslag (1991), J. Appl. Meteor. 30, 327-341 (stable).
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Final, NamedTuple

import numpy as np

from seaglint.air.profile.air_profile import AirProfile, saturation_density
from seaglint.base.constants import GRAVITY
from seaglint.base.conventions import FloatArray

REFERENCE_HEIGHT: Final = 10.0  #: Height of wind, air temperature and humidity [m].

SIMILAR_UP_TO: Final = 50.0  #: Height up to which the profiles follow the law [m].

JOINED_AT: Final = 500.0  #: Height from which on the air is the profile's [m]; between both the difference fades evenly.

#: Levels of the lowest air [m], close where it changes most.
LEVELS: Final = (
    0.0,
    0.003,
    0.01,
    0.03,
    0.1,
    0.3,
    0.6,
    1.0,
    1.5,
    2.0,
    3.0,
    4.5,
    6.0,
    8.0,
    10.0,
    14.0,
    20.0,
    27.0,
    36.0,
    50.0,
    80.0,
    120.0,
    200.0,
    320.0,
    500.0,
)

KARMAN: Final = 0.4  #: Von Karman's constant of the COARE law.

ADIABATIC: Final = 9.8e-3  #: Decrease of the temperature of rising dry air with height [K m-1].

SALT: Final = 0.98  #: Vapour pressure over sea water in parts of that over fresh water.

CALMEST: Final = 0.2  #: Least wind, of gusts [m s-1].

_VISCOSITY: Final = 1.5e-5
_VAPOUR_CONSTANT: Final = 461.5
_DRY_AIR: Final = 287.05


class SimilarProfiles(NamedTuple):
    """Scales of the lowest air: friction velocity [m s-1], temperature [K], humidity [kg kg-1], Obukhov's length and roughness [m]."""

    friction_velocity: float
    temperature_scale: float
    humidity_scale: float
    obukhov_length: float
    roughness: float


def stability_of_momentum(zeta: float) -> float:
    """Integrated stability function of the wind [1] at ``z/L``, 0 in neutral air.

    >>> stability_of_momentum(0.0)
    0.0
    """
    if zeta >= 0.0:
        return _stable(zeta, 1.0 + zeta)
    x = (1.0 - 15.0 * zeta) ** 0.25
    kansas = 2.0 * math.log((1.0 + x) / 2.0) + math.log((1.0 + x * x) / 2.0) - 2.0 * math.atan(x) + 0.5 * math.pi
    return _blended(zeta, kansas, (1.0 - 10.15 * zeta) ** (1.0 / 3.0))


def stability_of_heat(zeta: float) -> float:
    """Integrated stability function of temperature and humidity [1] at ``z/L``, 0 in neutral air.

    >>> stability_of_heat(0.0)
    0.0
    """
    if zeta >= 0.0:
        return _stable(zeta, (1.0 + 2.0 / 3.0 * zeta) ** 1.5)
    x = math.sqrt(1.0 - 15.0 * zeta)
    return _blended(zeta, 2.0 * math.log((1.0 + x) / 2.0), (1.0 - 34.15 * zeta) ** (1.0 / 3.0))


def _stable(zeta: float, first: float) -> float:
    decay = 0.6667 * (zeta - 14.28) * math.exp(-min(50.0, 0.35 * zeta))
    return 1.0 - first - decay - 0.6667 * 14.28


def _blended(zeta: float, kansas: float, x: float) -> float:
    """Kansas functions blended with free convection."""
    root = math.sqrt(3.0)
    free = 1.5 * math.log((1.0 + x + x * x) / 3.0) - root * math.atan((1.0 + 2.0 * x) / root) + math.pi / root
    share = zeta * zeta / (1.0 + zeta * zeta)
    return (1.0 - share) * kansas + share * free


def saturation_humidity(temperature: float, pressure: float) -> float:
    """Specific humidity of saturated air [kg kg-1] at a temperature [K] and pressure [hPa]."""
    vapour = 1e-5 * float(saturation_density(temperature)) * _VAPOUR_CONSTANT * temperature
    return 0.62198 * vapour / (pressure - 0.378 * vapour)


def similar_profiles(wind_speed: float, sea_kelvin: float, air_minus_sea: float, humidity: float, pressure: float) -> SimilarProfiles:
    """Solve the bulk law for the scales.

    Parameters
    ----------
    wind_speed : float
        At 10 m [m s-1].
    sea_kelvin, air_minus_sea : float
        Temperature of the sea [K], and of the air at 10 m less that [K].
    humidity, pressure : float
        Relative humidity at 10 m [%], pressure at the sea [hPa].

    Returns
    -------
    SimilarProfiles
        By iteration to 1e-10; the argument of the stability functions is limited to 50 as in COARE.
    """
    z, wind = REFERENCE_HEIGHT, max(wind_speed, CALMEST)
    air = sea_kelvin + air_minus_sea
    # potential temperatures: air that sinks from the height warms by the adiabatic lapse
    warmer = air_minus_sea + ADIABATIC * z
    q = 0.01 * humidity * saturation_humidity(air, pressure)
    moister = q - SALT * saturation_humidity(sea_kelvin, pressure)
    zeta, friction = 0.0, 0.035 * wind
    rough = heat = 1e-4
    temperature = moisture = 0.0
    for _ in range(200):
        # roughness: Charnock's law for waves, and viscosity of a smooth sea
        charnock = float(np.interp(wind, [10.0, 18.0], [0.011, 0.018]))
        rough = charnock * friction**2 / GRAVITY + 0.11 * _VISCOSITY / friction
        heat = min(1.15e-4, 5.5e-5 * (rough * friction / _VISCOSITY) ** -0.6)
        friction = KARMAN * wind / (math.log(z / rough) - stability_of_momentum(zeta))
        scale = KARMAN / (math.log(z / heat) - stability_of_heat(zeta) + stability_of_heat(zeta * heat / z))
        temperature, moisture = scale * warmer, scale * moister
        # flux of virtual temperature, whose ratio to the friction gives z/L
        buoyancy = temperature * (1.0 + 0.61 * q) + 0.61 * air * moisture
        new = min(max(KARMAN * GRAVITY * z * buoyancy / (air * friction**2), -50.0), 50.0)
        if abs(new - zeta) < 1e-10 * (1.0 + abs(new)):
            zeta = new
            break
        zeta = 0.5 * (zeta + new)  # damped: half of every step
    return SimilarProfiles(friction, temperature, moisture, z / zeta if zeta != 0.0 else math.inf, heat)


def with_marine_layer(profile: AirProfile, wind_speed: float, sea_kelvin: float, air_minus_sea: float) -> AirProfile:
    """Return a profile whose lowest air follows the bulk law over a sea.

    Parameters
    ----------
    profile : AirProfile
        The air above ``JOINED_AT``; its relative humidity at 10 m and its pressures stay unchanged.
    wind_speed : float
        At 10 m [m s-1].
    sea_kelvin, air_minus_sea : float
        Temperature of the sea [K], and of the air at 10 m less that [K].

    Returns
    -------
    AirProfile
        The profile with the temperatures and humidities of the bulk law in its lowest air.

    Notes
    -----
    The Navy's haze takes the humidity at 10 m, not that at the sea's surface.
    """
    z = np.array(LEVELS)
    pressure = np.exp(np.interp(z, profile.height, np.log(profile.pressure)))
    humidity = float(np.interp(REFERENCE_HEIGHT, profile.height, profile.relative_humidity))
    scales = similar_profiles(wind_speed, sea_kelvin, air_minus_sea, humidity, float(pressure[0]))
    kelvin, vapour = _by_law(z, pressure, scales, sea_kelvin)
    old_kelvin, old_vapour = np.interp(z, profile.height, profile.temperature), np.interp(z, profile.height, profile.vapour)
    edge = int(np.searchsorted(z, SIMILAR_UP_TO))
    fade = np.clip((JOINED_AT - z) / (JOINED_AT - SIMILAR_UP_TO), 0.0, 1.0)
    above = z > SIMILAR_UP_TO
    kelvin = np.where(above, old_kelvin + fade * (kelvin[edge] - old_kelvin[edge]), kelvin)
    vapour = np.where(above, old_vapour + fade * (vapour[edge] - old_vapour[edge]), vapour)
    # temperature and vapour fade separately: their mixture may pass saturation
    vapour = np.clip(vapour, 0.0, saturation_density(kelvin))
    keep = profile.height > JOINED_AT
    gas = np.array([np.concatenate([np.interp(z, profile.height, row), row[keep]]) for row in profile.gas])
    return replace(
        profile,
        height=np.concatenate([z, profile.height[keep]]),
        pressure=np.concatenate([pressure, profile.pressure[keep]]),
        temperature=np.concatenate([kelvin, profile.temperature[keep]]),
        vapour=np.concatenate([vapour, profile.vapour[keep]]),
        gas=gas,
        haze_humidity=humidity,
    )


def _by_law(z: FloatArray, pressure: FloatArray, scales: SimilarProfiles, sea_kelvin: float) -> tuple[FloatArray, FloatArray]:
    """Temperatures [K] and vapour densities [g m-3] at heights [m]."""
    base = SALT * saturation_humidity(sea_kelvin, float(pressure[0]))
    steps = np.zeros(z.size)
    for i, height in enumerate(z):
        if height > scales.roughness:
            bent = stability_of_heat(height / scales.obukhov_length) - stability_of_heat(scales.roughness / scales.obukhov_length)
            steps[i] = (math.log(height / scales.roughness) - bent) / KARMAN
    kelvin = sea_kelvin + scales.temperature_scale * steps - ADIABATIC * z
    q = np.maximum(base + scales.humidity_scale * steps, 1e-6)
    return kelvin, 1e3 * 100.0 * pressure * q / (_DRY_AIR * kelvin * (1.0 + 0.61 * q))
