"""Densities of LOWTRAN7's absorbers, scaled by pressure and temperature, and refractivity, at the levels of a profile.

An absorption band takes the amount ``W = integral u (p/p0)^n (T0/T)^m ds``, with a band's own exponents; continua take other powers of the
densities.

References
----------
LOWTRAN7's subroutine STDMDL; Pierluissi, J. H., and C. E. Maragoudakis (1986), Molecular transmission band models for LOWTRAN,
AFGL-TR-86-0272; refractivity after Edlen, B. (1966), Metrologia 2, 71.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

import numpy as np

from seaglint.air.profile.air_profile import GASES, STANDARD_PRESSURE, ZERO_CELSIUS, AirProfile, air_molecules
from seaglint.base.conventions import FloatArray

_PER_KM: Final = 3.7194e-21  #: Factor from molecules per cm3, in parts per million, to atm cm per km (CONJOE).

_LOSCHMIDT: Final = 2.6868e24  #: Molecules per cm2 and km of standard air.

_VAPOUR_MOLECULES: Final = 3.3429e21  #: Molecules per cm2 and km of 1 g m-3 of water (CON).

#: LOWTRAN7's number of the first band of a gas, and exponents of relative pressure and of 273.15 K / T of its bands.
SCALED: Final[dict[str, tuple[int, tuple[tuple[float, float], ...]]]] = {
    "H2O": (
        17,
        (
            *((0.9810, 0.3324), (1.1406, -2.6343), (0.9834, -2.5294), (1.0443, -2.4359), (0.9681, -1.9537), (0.9555, -1.5378)),
            *((0.9362, -1.6338), (0.9233, -0.9398), (0.8658, -0.1034), (0.8874, -0.2576), (0.7982, 0.0588), (0.8088, 0.2816)),
            *((0.6642, 0.2764), (0.6656, 0.5061)),
        ),
    ),
    "O3": (31, ((0.4200, 1.3909), (0.4221, 0.7678), (0.3739, 0.1225), (0.1770, 0.9827), (0.3921, 0.1942))),
    "CO2": (
        36,
        (
            *((0.6705, -2.2560), (0.7038, -5.0768), (0.7258, -1.6740), (0.6982, -1.8107), (0.8867, -0.5327), (0.7883, -1.3244)),
            *((0.6899, -0.8152), (0.6035, 0.6026)),
        ),
    ),
    "CO": (44, ((0.7589, 0.6911), (0.9267, 0.1716))),
    "CH4": (46, ((0.7139, -0.4185),)),
    "N2O": (47, ((0.3783, 0.9399), (0.7203, -0.1836), (0.7764, 1.1931))),
    "O2": (50, ((1.1879, 2.9738), (0.9353, 0.1936))),
    "NH3": (52, ((0.8023, -0.9111), (0.6968, 0.3377))),
    "NO": (54, ((0.5265, -0.4702),)),
    "NO2": (55, ((0.3956, -0.0545),)),
    "SO2": (56, ((0.2943, 1.2316), (0.2135, 0.0733))),
}

#: Gas and exponents of LOWTRAN7's scaled amounts, by number.
LOWTRAN_SCALED: Final[Mapping[int, tuple[str, float, float]]] = MappingProxyType(
    {first + i: (gas, n, m) for gas, (first, exponents) in SCALED.items() for i, (n, m) in enumerate(exponents)}
)

COLD, WARM = 260.0, 296.0  #: Temperatures [K] at which all or nothing of water's own continuum counts as cold.


def cold_share(kelvin: FloatArray, cold_kelvin: float) -> FloatArray:
    """Part of water's own continuum that counts as cold [1, (...)] at temperatures [K, (...)]: 0 at 296 K, 1 at 260 K.

    With ``cold_kelvin`` it follows ``exp(cold_kelvin / T)``, below 0 in warmer air; with 0 it is LOWTRAN7's, linear and within 0-1.

    >>> cold_share(np.array([308.0, 296.0, 278.0, 260.0]), 1800.0).round(3)
    array([-0.16 ,  0.   ,  0.365,  1.   ])
    """
    if cold_kelvin == 0.0:
        return np.asarray(np.clip((WARM - kelvin) / (WARM - COLD), 0.0, 1.0))
    return np.asarray(np.expm1(cold_kelvin * (1.0 / kelvin - 1.0 / WARM)) / np.expm1(cold_kelvin * (1.0 / COLD - 1.0 / WARM)))


def absorber_densities(
    profile: AirProfile, columns: list[int], scaled: Mapping[int, tuple[str, float, float]] = LOWTRAN_SCALED
) -> FloatArray:
    """Densities [per km, (columns, levels)] of absorbers with the numbers ``columns``, ``scaled`` by exponents.

    4 nitrogen, 5 and 10 water's continua by itself and by air, 6 scattering molecules, 8 ozone below 0.77 um, 9 the colder share of 5
    (0 here: it depends on the ray), 11 nitric acid, 1, 2 and 63 oxygen's continuum, from 17 on bands.
    """
    p, t = profile.pressure / STANDARD_PRESSURE, ZERO_CELSIUS / profile.temperature
    air = p * t
    volume = dict(zip(GASES, _PER_KM * air_molecules(profile.pressure, profile.temperature) * profile.gas, strict=True))
    water = _VAPOUR_MOLECULES * profile.vapour / _LOSCHMIDT
    at_296 = ZERO_CELSIUS / 296.0
    oxygen = volume["O2"] * p
    known = {
        1: oxygen * profile.temperature,
        2: oxygen * (profile.temperature - 220.0) ** 2,
        63: oxygen,
        4: 0.781 * air * p * np.sqrt(t),
        5: _LOSCHMIDT * water**2 / at_296,
        6: air,
        8: volume["O3"],
        9: np.zeros(p.size),
        10: _LOSCHMIDT * water * (air - water) / at_296,
        11: air * profile.gas[GASES.index("HNO3")] * 1e-4,
    }
    out = np.empty((len(columns), p.size))
    for row, column in enumerate(columns):
        if column in known:
            out[row] = known[column]
            continue
        name, n, m = scaled[column]
        out[row] = (0.1 * profile.vapour if name == "H2O" else volume[name]) * p**n * t**m
    return out


def refractivity(profile: AirProfile, wavenumber_cm: float) -> FloatArray:
    """Refractivity ``n - 1`` [1, (levels,)] at a wavenumber [cm-1], by Edlen's law with water vapour."""
    dry = 83.42 + 185.08 / (1.0 - (wavenumber_cm / 1.140e5) ** 2) + 4.11 / (1.0 - (wavenumber_cm / 6.24e4) ** 2)
    vapour = 4.6152e-3 * profile.vapour * profile.temperature / STANDARD_PRESSURE
    pressure = profile.pressure / STANDARD_PRESSURE
    return np.asarray(
        1e-6 * (dry * pressure * (ZERO_CELSIUS + 15.0) / profile.temperature - (43.49 - (wavenumber_cm / 1.7e4) ** 2) * vapour)
    )
