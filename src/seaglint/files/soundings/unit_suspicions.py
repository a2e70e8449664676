"""Units of soundings that were mistaken: values that no air has in the unit of their column, and the unit in which air has them."""

from __future__ import annotations

from pathlib import Path
from typing import Final

import numpy as np

from seaglint.air.profile.air_profile import saturation_density
from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError
from seaglint.files.soundings.raw_sounding import VAPOUR_CONSTANT, RawSounding
from seaglint.files.soundings.sounding_checks import HYDROSTATIC, span_misfit

ZERO_C: Final = 273.15

WARMEST_K: Final = 345.0  #: Temperatures above are no air's [K].

COLDEST_K: Final = 130.0  #: Temperatures below are no air's up to 100 km [K].

ABOVE_AIR: Final = 0.5  #: Excess of a dew point over the temperature that rounding and sensors explain [K].

DRIEST_LOW: Final = 20.0  #: Dew-point depression above 700 hPa that no whole sounding exceeds at each of its levels [K].


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
    if _is_fahrenheit(raw):
        raise DataError(
            f"{path}: {name['temperature']} from {_span(raw.temperature - ZERO_C)} agrees with heights and pressures in Fahrenheit, not in "
            "Celsius; are temperatures in Fahrenheit? Celsius or kelvin are needed"
        )
    if raw.humidity == "relative_humidity_percent":
        _check_humidity(path, raw)
    if raw.humidity == "dewpoint_k":
        _check_dew_points(path, raw)


def _span(values: FloatArray) -> str:
    return f"{float(np.nanmin(values)):.1f} to {float(np.nanmax(values)):.1f}"


def _fahrenheit(number: FloatArray) -> FloatArray:
    """Kelvin of numbers in Fahrenheit."""
    return np.asarray((number - 32.0) / 1.8 + ZERO_C)


def _is_fahrenheit(raw: RawSounding) -> bool:
    """True where numbers taken as Celsius contradict heights and pressures, and taken as Fahrenheit agree with them."""
    given = span_misfit(raw, raw.temperature)
    other = span_misfit(raw, _fahrenheit(raw.temperature - ZERO_C))
    return bool(given > HYDROSTATIC > other and other < 0.5 * given)


def _check_temperatures(path: Path, raw: RawSounding) -> None:
    """Refuse temperatures that no air has."""
    name, kelvin = raw.names["temperature"], raw.temperature
    high, low = float(np.max(kelvin)), float(np.min(kelvin))
    if high > 400.0 and low - ZERO_C > 150.0:
        raise DataError(f"{path}: {name} is {high - ZERO_C:g} at its largest, in Celsius; are temperatures in kelvin?")
    if high < 150.0:
        as_f, as_c = span_misfit(raw, _fahrenheit(kelvin)), span_misfit(raw, kelvin + ZERO_C)
        what = "Fahrenheit" if high > 60.0 or as_f < min(as_c, HYDROSTATIC) else "Celsius"
        raise DataError(f"{path}: {name} is {high:g} at its largest, in kelvin; are temperatures in {what}?")
    if high > WARMEST_K or low < COLDEST_K:
        bad = high if high > WARMEST_K else low
        cold = _fahrenheit(kelvin - ZERO_C)
        inside = bool(np.min(cold) > 170.0 and np.max(cold) < 330.0)
        if inside and not span_misfit(raw, cold) > 1.5 * HYDROSTATIC:
            raise DataError(f"{path}: {name} holds {bad - ZERO_C:.1f} C, which no air has; are temperatures in Fahrenheit?")
        raise DataError(f"{path}: {name} holds {bad:.1f} K ({bad - ZERO_C:.1f} C), which no air has; is it the right column and unit?")


def _check_humidity(path: Path, raw: RawSounding) -> None:
    """Refuse relative humidities that are a share, or none."""
    name, value = raw.names["humidity"], raw.humidity_value
    high, low = float(np.nanmax(value)), float(np.nanmin(value))
    deep = bool(np.max(raw.pressure[np.isfinite(value)]) > 500.0)
    if high <= 1.2 and deep:
        raise DataError(f"{path}: {name} is {high:g} at most; is relative humidity a share (0.8 for 80 %)? % are needed")
    if high > 110.0 or low < 0.0:
        bad = high if high > 110.0 else low
        raise DataError(f"{path}: {name} holds {bad:g}; relative humidity is 0 to 100 %, is it the right column?")


def _check_dew_points(path: Path, raw: RawSounding) -> None:
    """Refuse dew points above the temperature of the air, with what they may be instead."""
    name = raw.names["humidity"]
    known = np.isfinite(raw.humidity_value)
    part = raw.kept(known)
    value, kelvin = part.humidity_value, part.temperature
    if float(np.max(value)) > 400.0:
        raise DataError(f"{path}: {name} is {float(np.max(value)) - ZERO_C:g} in Celsius; are dew points in kelvin?")
    if float(np.max(value)) < COLDEST_K:
        number = value
        negative = float(np.min(number)) < -0.01
        what = "are dew points in Celsius?" if negative else _dew_suspicion(part, number)
        if not negative and float(np.min(kelvin)) > 243.0 and bool(np.all(number + ZERO_C <= kelvin + ABOVE_AIR)):
            what = "are dew points in Celsius?"
        raise DataError(f"{path}: {name} is {float(np.max(value)):g} at its largest, in kelvin; {what}")
    above = value > kelvin + ABOVE_AIR
    if above.any():
        i = int(np.argmax(above))
        at = f"{name} ({value[i] - ZERO_C:.1f} C) lies above {raw.names['temperature']} ({kelvin[i] - ZERO_C:.1f} C)"
        raise DataError(f"{path}: at {part.pressure[i]:g} hPa {at}; {_dew_suspicion(part, value - ZERO_C)}")


def _dew_suspicion(raw: RawSounding, number: FloatArray) -> str:
    """Question about numbers that are no dew points in their unit."""
    in_fahrenheit = bool(np.all(_fahrenheit(number) <= raw.temperature + ABOVE_AIR))
    if float(np.min(number)) >= -0.01:
        if in_fahrenheit and float(np.min(number)) > DRIEST_LOW:
            return "are dew points in Fahrenheit?"
        if bool(np.any(raw.temperature < 278.0)):
            # above what saturated air holds it is no mixing ratio; a dew-point depression exceeds that in any cold and dry air
            partial = 1e-5 * saturation_density(raw.temperature) * VAPOUR_CONSTANT * raw.temperature
            saturated = 1e3 * 0.62198 * partial / np.maximum(raw.pressure - partial, 1e-3)
            too_much = np.mean(number > 1.1 * saturated + 0.02)
            return "is it a dew-point depression?" if too_much > 0.02 else "is it a mixing ratio in g/kg?"
        return "is it a mixing ratio in g/kg, or a dew-point depression?"
    if span_misfit(raw, number + ZERO_C) <= HYDROSTATIC and float(np.mean(number + ZERO_C >= raw.temperature - ABOVE_AIR)) > 0.9:
        return "are the columns or units exchanged?"
    return "are dew points in Fahrenheit?" if in_fahrenheit else "are the columns or units exchanged?"
