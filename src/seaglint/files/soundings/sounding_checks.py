"""Nonsense in soundings: units that were mistaken, heights and pressures that contradict each other."""

from __future__ import annotations

from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from seaglint.air.profile.air_profile import saturation_density
from seaglint.base.constants import GRAVITY
from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError
from seaglint.files.soundings.raw_sounding import VAPOUR_CONSTANT, RawSounding

DRY_AIR: Final = 287.05
"""Specific gas constant of dry air [J kg-1 K-1]."""

HYDROSTATIC: Final = 0.02
"""Largest relative difference of a thickness from the hydrostatic one."""

SPAN: Final = 1000.0
"""Thickness over which heights and pressures are compared [m]."""

SURFACE_PRESSURES: Final = (850.0, 1100.0)
"""Pressures at the sea [hPa]; hurricanes have 870."""


def virtual_temperature(temperature: ArrayLike, pressure: ArrayLike, humidity: ArrayLike) -> FloatArray:
    """Temperature of dry air of the same density [K], from temperature [K], pressure [hPa] and relative humidity [%]."""
    t = np.asarray(temperature, dtype=np.float64)
    vapour = 1e-5 * saturation_density(t) * VAPOUR_CONSTANT * t * np.asarray(humidity) / 100.0
    return np.asarray(t / (1.0 - 0.378 * np.minimum(vapour / np.asarray(pressure), 0.5)))


def check_units(path: Path, raw: RawSounding) -> None:
    """Refuse values that speak of another unit.

    Raises
    ------
    DataError
        With the suspicion.
    """
    name = raw.names
    _check_temperatures(path, raw)
    highest = float(np.max(raw.pressure))
    if highest > 2000.0:
        raise DataError(f"{path}: {name['pressure']} goes up to {highest:g}; are pressures in Pa? hPa are needed")
    if np.any(raw.pressure <= 0.0):
        raise DataError(f"{path}: {name['pressure']} goes down to {float(np.min(raw.pressure)):g}; pressures are above 0 hPa")
    lowest = float(np.nanmin(raw.height)) if np.isfinite(raw.height).any() else 0.0
    if highest < 120.0 and lowest < 3000.0:
        raise DataError(f"{path}: {name['pressure']} is {highest:g} at the lowest level; are pressures in kPa? hPa are needed")
    value = raw.humidity_value
    if raw.humidity == "relative_humidity_percent":
        if float(np.max(value)) <= 1.2 and float(np.max(raw.pressure)) > 500.0:
            raise DataError(
                f"{path}: {name['humidity']} is {float(np.max(value)):g} at most; is relative humidity a share (0.8 for 80 %)? % are needed"
            )
        if float(np.max(value)) > 110.0 or float(np.min(value)) < 0.0:
            bad = float(np.max(value)) if float(np.max(value)) > 110.0 else float(np.min(value))
            raise DataError(f"{path}: {name['humidity']} holds {bad:g}; relative humidity is 0 to 100 %, is it the right column?")
    if raw.humidity == "dewpoint_k":
        above = value > raw.temperature + 0.5
        if above.any():
            i = int(np.argmax(above))
            at = f"{name['humidity']} ({value[i] - 273.15:.1f} C) lies above {name['temperature']} ({raw.temperature[i] - 273.15:.1f} C)"
            celsius = value - 273.15
            ratio = float(np.min(celsius)) >= -0.01 and bool(np.any(raw.temperature < 263.0))
            what = "is it a mixing ratio in g/kg?" if ratio else "are the columns or units exchanged?"
            raise DataError(f"{path}: at {raw.pressure[i]:g} hPa {at}; {what}")
        # a mixing ratio read as a dew point falls to 0 with height and never below
        if bool(np.any(raw.temperature < 233.0)) and float(np.min(value)) >= 273.14:
            raise DataError(
                f"{path}: {name['humidity']} never falls below 0 C while the air falls below -40 C; is it a mixing ratio in g/kg?"
            )


def _check_temperatures(path: Path, raw: RawSounding) -> None:
    """Refuse temperatures that no air has."""
    name, kelvin = raw.names["temperature"], raw.temperature
    high, low = float(np.max(kelvin)), float(np.min(kelvin))
    if high > 400.0 and low - 273.15 > 150.0:
        raise DataError(f"{path}: {name} is {high - 273.15:g} at its largest, in Celsius; are temperatures in kelvin?")
    if high < 150.0:
        raise DataError(f"{path}: {name} is {high:g} at its largest, in kelvin; are temperatures in Celsius?")
    if high > 345.0 or low < 130.0:
        bad = high if high > 345.0 else low
        raise DataError(f"{path}: {name} holds {bad:.1f} K ({bad - 273.15:.1f} C), which no air has; is it the right column and unit?")
    if raw.humidity == "dewpoint_k" and float(np.max(raw.humidity_value)) > 400.0:
        raise DataError(
            f"{path}: {raw.names['humidity']} is {float(np.max(raw.humidity_value)) - 273.15:g} in Celsius; are dew points in kelvin?"
        )


def hydrostatic_thickness(raw: RawSounding, humidity: FloatArray) -> FloatArray:
    """Thickness of the layers between levels that their pressures give [m, (levels - 1,)]."""
    warm = virtual_temperature(raw.temperature, raw.pressure, humidity)
    mean = 0.5 * (warm[1:] + warm[:-1])
    # gravity falls with height as geometric heights grow over geopotential ones
    gravity = GRAVITY * (6_356_766.0 / (6_356_766.0 + 0.5 * (raw.height[1:] + raw.height[:-1]))) ** 2
    return np.asarray(DRY_AIR * mean / gravity * np.log(raw.pressure[:-1] / raw.pressure[1:]))


def check_hydrostatics(path: Path, raw: RawSounding, humidity: FloatArray) -> float:
    """Refuse heights and pressures that contradict each other by over 2 % between levels; the result is the whole's relative misfit.

    Raises
    ------
    DataError
        With both numbers and the suspicion.
    """
    thick = hydrostatic_thickness(raw, humidity)
    sums, z, p = np.concatenate([[0.0], np.cumsum(thick)]), raw.height, raw.pressure
    whole = float((z[-1] - z[0]) / sums[-1] - 1.0)
    slack = _slack(raw, 0, z.size - 1)
    if abs(whole) > HYDROSTATIC and abs(z[-1] - z[0] - sums[-1]) > slack:
        _refuse(path, raw, 0, z.size - 1, float(sums[-1]))
    first = 0
    for i in range(1, z.size):
        given, ours = z[i] - z[first], sums[i] - sums[first]
        if max(given, ours) < SPAN and i < z.size - 1:
            continue
        if abs(given - ours) > HYDROSTATIC * max(ours, given) + _slack(raw, first, i):
            _refuse(path, raw, first, i, float(ours))
        first = i
    at_sea = float(p[0] * np.exp(GRAVITY * z[0] / (DRY_AIR * raw.temperature[0])))
    low, high = SURFACE_PRESSURES
    if not low <= at_sea <= high:
        raise DataError(
            f"{path}: {p[0]:g} hPa at {z[0]:.0f} m make {at_sea:.0f} hPa at the sea; {low:g} to {high:g} are allowed: "
            "are heights above the ground, or columns exchanged?"
        )
    return whole


def _slack(raw: RawSounding, first: int, last: int) -> float:
    """Error of a thickness that rounding of pressures and heights explains [m]."""
    scale = DRY_AIR * 273.0 / GRAVITY
    step_p, step_z = raw.resolution
    return float(scale * 0.5 * step_p * (1.0 / raw.pressure[first] + 1.0 / raw.pressure[last]) + step_z)


def _refuse(path: Path, raw: RawSounding, first: int, last: int, ours: float) -> None:
    given = float(raw.height[last] - raw.height[first])
    ratio = given / ours
    if abs(ratio / 3.2808 - 1.0) < 0.06:
        what = "are heights in feet?"
    elif abs(ratio * 1000.0 - 1.0) < 0.1:
        what = "are heights in km?"
    elif abs(ratio / 9.80665 - 1.0) < 0.06:
        what = "is it geopotential in m2/s2?"
    else:
        what = "are columns and units right?"
    raise DataError(
        f"{path}: from {raw.pressure[first]:g} to {raw.pressure[last]:g} hPa the heights rise by {given:.0f} m, the pressures and "
        f"temperatures say {ours:.0f} m ({100.0 * (ratio - 1.0):+.0f} %, 2 % are allowed); {what}"
    )
