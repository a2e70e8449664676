"""Checks of soundings: hydrostatic agreement of heights and pressures, order of the levels, and mistaken units.

Levels are one ascent from the ground up, with heights that rise and pressures that fall. Pressures rounded to 0.1 hPa repeat aloft, where a
second of ascent changes less; all of these levels count. Heights decide their order, and their pressures are interpolated in height within
the rounding of the file.

Values that are impossible in the unit of their column are refused with the unit in which they are possible.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from seaglint.air.profile.air_profile import saturation_density
from seaglint.base.constants import GRAVITY
from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError
from seaglint.formats.soundings.sounding_columns import VAPOUR_CONSTANT, ZERO_C, RawSounding

DRY_AIR: Final = 287.05  #: Specific gas constant of dry air [J kg-1 K-1].

HYDROSTATIC: Final = 0.02  #: Largest relative difference of a thickness from the hydrostatic one.

SPAN: Final = 1000.0  #: Thickness over which heights and pressures are compared [m].

SURFACE_PRESSURES: Final = (850.0, 1100.0)  #: Pressures at the sea [hPa]; hurricanes have 870.

FALL: Final = 0.125  #: Rise of the logarithm of pressure beyond which more than one level is another ascent: a fall of about a kilometre.

#: Rise of the logarithm of pressure in one step, after which levels rise on, that shows a second launch: a fall of some 65 m.
RESTART: Final = 0.008

GROUND: Final = 0.012  #: Difference of the logarithm of pressure from the first level within which a level is near the ground: some 100 m.

RESTARTED: Final = 3  #: Least number of levels after such a step that lie below those before it; fewer are faults of single levels.

JUMP: Final = 0.7  #: Share of such a rise in a single step that distinguishes another sounding from a descent.

NOISE_HPA: Final = 0.2  #: Rise of pressure, under rising heights, that a sensor's noise explains [hPa].

NOISE_M: Final = 10.0  #: Fall of height, under falling pressures, that noise of the height explains [m].

SAME_M: Final = 1e-3  #: Heights this close are one height [m].

LOST: Final = 0.25  #: Largest share of levels that may fall back.

WARMEST_K: Final = 345.0  #: Largest temperature of real air [K].

COLDEST_K: Final = 130.0  #: Smallest temperature of real air up to 100 km [K].

ABOVE_AIR: Final = 0.5  #: Excess of a dew point over the temperature that rounding and sensors explain [K].

DRIEST_LOW: Final = 20.0  #: Dew-point depression above 700 hPa that no whole sounding exceeds at each of its levels [K].


def virtual_temperature(temperature: ArrayLike, pressure: ArrayLike, humidity: ArrayLike) -> FloatArray:
    """Return the temperature of dry air of the same density [K], from temperature [K], pressure [hPa] and relative humidity [%]."""
    t = np.asarray(temperature, dtype=np.float64)
    vapour = 1e-5 * saturation_density(t) * VAPOUR_CONSTANT * t * np.asarray(humidity) / 100.0
    return np.asarray(t / (1.0 - 0.378 * np.minimum(vapour / np.asarray(pressure), 0.5)))


def whole_humidity(pressure: FloatArray, humidity: FloatArray) -> FloatArray:
    """Return relative humidity [%] without gaps, for the weight of the air alone.

    It is linear in the logarithm of pressure, and proportional to the pressure above the last value.
    """
    known = np.isfinite(humidity)
    if known.all():
        return humidity
    x = -np.log(pressure)
    order = np.argsort(x[known])
    at, values = x[known][order], humidity[known][order]
    return np.asarray(np.interp(x, at, values) * np.exp(np.minimum(at[-1] - x, 0.0)))


def hydrostatic_thickness(raw: RawSounding, humidity: FloatArray) -> FloatArray:
    """Return the thickness of the layers between levels by their pressures [m, (levels - 1,)]."""
    warm = virtual_temperature(raw.temperature, raw.pressure, humidity)
    mean = 0.5 * (warm[1:] + warm[:-1])
    # gravity falls with height as geometric heights grow over geopotential ones
    gravity = GRAVITY * (6_356_766.0 / (6_356_766.0 + 0.5 * (raw.height[1:] + raw.height[:-1]))) ** 2
    return np.asarray(DRY_AIR * mean / gravity * np.log(raw.pressure[:-1] / raw.pressure[1:]))


def check_hydrostatics(path: Path, raw: RawSounding, humidity: FloatArray) -> float:
    """Return the relative misfit of heights and pressures of a whole sounding [1]; refuse contradictions of over 2 % between levels.

    Raises
    ------
    DataError
        With both numbers and the suspicion.
    """
    sums, z, p = np.concatenate([[0.0], np.cumsum(hydrostatic_thickness(raw, humidity))]), raw.height, raw.pressure
    whole = float((z[-1] - z[0]) / sums[-1] - 1.0)
    if abs(whole) > HYDROSTATIC and abs(z[-1] - z[0] - sums[-1]) > _slack(raw, 0, z.size - 1):
        _refuse(path, raw, 0, z.size - 1, float(sums[-1]))
    for start, end in _spans(z, sums):
        given, ours = z[end] - z[start], sums[end] - sums[start]
        if abs(given - ours) > HYDROSTATIC * max(ours, given) + _slack(raw, start, end):
            _refuse(path, raw, start, end, float(ours))
    # The lowest pressure is reduced to the sea at the temperature of its level.
    at_sea = float(p[0] * np.exp(GRAVITY * z[0] / (DRY_AIR * raw.temperature[0])))
    low, high = SURFACE_PRESSURES
    if not low <= at_sea <= high:
        raise DataError(
            f"{path}: {p[0]:g} hPa at {z[0]:.0f} m make {at_sea:.0f} hPa at the sea; {low:g} to {high:g} are allowed: "
            "are heights above the ground, or columns exchanged?"
        )
    return whole


def span_misfit(raw: RawSounding, temperature: FloatArray) -> float:
    """Return the largest relative misfit of heights from hydrostatic ones of dry air of given temperatures [K], over spans of 1 km [1].

    Rounding of the file is subtracted. The result is NaN where fewer than two levels have heights.
    """
    # Dry air is enough to compare units: humidity changes a thickness by less than a unit does.
    known = np.flatnonzero(np.isfinite(raw.height) & np.isfinite(temperature) & (temperature > 1.0) & (raw.pressure > 0.0))
    known = known[np.argsort(raw.height[known], kind="stable")]
    if known.size < 2:
        return float("nan")
    part = raw.at(known)
    p = np.minimum.accumulate(part.pressure)
    kelvin = temperature[known]
    steps = DRY_AIR / GRAVITY * 0.5 * (kelvin[1:] + kelvin[:-1]) * np.log(p[:-1] / p[1:])
    sums, z = np.concatenate([[0.0], np.cumsum(steps)]), part.height
    worst = 0.0
    for low, high in _spans(z, sums):
        given, ours = z[high] - z[low], sums[high] - sums[low]
        if max(given, ours) > 0.0:
            worst = max(worst, (abs(given - ours) - _slack(part, low, high)) / max(given, ours))
    return float(worst)


def _spans(height: FloatArray, sums: FloatArray) -> Iterator[tuple[int, int]]:
    """Yield pairs of levels a span apart by their heights or by their pressures; the last pair may overlap the one below."""
    first, last = 0, height.size - 1
    while first < last:
        ends = (int(np.searchsorted(height, height[first] + SPAN)), int(np.searchsorted(sums, sums[first] + SPAN)))
        end = max(min(ends), first + 1)
        if end > last:
            # Two levels close to each other differ by their noise: the last span is made as long as the others.
            lower = (int(np.searchsorted(height, height[last] - SPAN, "right")), int(np.searchsorted(sums, sums[last] - SPAN, "right")))
            first, end = min(first, max(max(lower) - 1, 0)), last
        yield first, end
        first = end


def _slack(raw: RawSounding, first: int, last: int) -> float:
    """Return the error of a thickness that rounding of pressures and heights explains [m]."""
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


def upwards(path: Path, raw: RawSounding) -> tuple[RawSounding, bool]:
    """Return the levels from the ground up, and true where the file has them from the top down.

    Raises
    ------
    DataError
        The file holds an ascent and a descent, or several soundings.
    """
    reversed_order = bool(raw.pressure[0] < raw.pressure[-1])
    if reversed_order:
        raw = raw.at(np.arange(raw.pressure.size)[::-1])
    log_p = np.log(raw.pressure)
    least = np.minimum.accumulate(log_p)
    _refuse_restart(path, raw, log_p, least, reversed_order)
    back = np.flatnonzero(log_p[1:] - least[:-1] > FALL) + 1
    if back.size < 2:
        return raw, reversed_order
    lowest = int(np.argmin(log_p[: back[0]]))
    highest = lowest + int(np.argmax(log_p[lowest:]))
    steps = np.diff(log_p[lowest : highest + 1])
    place = lowest + int(np.argmax(steps)) + 1
    size = raw.pressure.size
    low, high = raw.pressure[lowest], raw.pressure[highest]
    if np.max(steps) > JUMP * (log_p[highest] - log_p[lowest]):
        row = size - place + 1 if reversed_order else place + 1
        raise DataError(
            f"{path}: pressure rises again from {low:g} to {high:g} hPa at level {row} of {size}; is it one ascent? "
            "two soundings in one file, or levels out of order: give one, in order"
        )
    row = size - lowest if reversed_order else lowest + 1
    raise DataError(
        f"{path}: pressure falls to {low:g} hPa at level {row} of {size} and rises again to {high:g} hPa; is it one ascent? "
        "ascent and descent in one file: give one of them"
    )


def _refuse_restart(path: Path, raw: RawSounding, log_p: FloatArray, least: FloatArray, reversed_order: bool) -> None:
    """Refuse an ascent that begins again near the ground, after an abandoned launch of any length."""
    size = log_p.size
    for place in (np.flatnonzero(np.diff(log_p) > RESTART) + 1).tolist():
        above = least[place - 1]
        after = log_p[place : place + RESTARTED]
        if log_p[place] < log_p[0] - GROUND:
            continue
        if after.size == RESTARTED and bool(np.all(after > above)) and bool(np.all(np.diff(after) < RESTART)):
            row = size - place + 1 if reversed_order else place + 1
            raise DataError(
                f"{path}: pressure rises again from {np.exp(above):.4g} to {raw.pressure[place]:g} hPa at level {row} of {size}; is it one "
                "ascent? two soundings in one file, or levels out of order: give one, in order"
            )


def in_order(path: Path, raw: RawSounding, humidity: FloatArray) -> tuple[RawSounding, FloatArray, list[str], list[str]]:
    """Return levels whose heights rise and pressures fall strictly, with notes on changes and on omissions.

    Raises
    ------
    DataError
        More than a quarter of the levels, and more than three, fall back.
    """
    done, lost = [], []
    step_p, step_z = raw.resolution
    risen = np.concatenate([[0.0], raw.pressure[1:] - np.minimum.accumulate(raw.pressure)[:-1]])
    fallen = np.concatenate([[0.0], np.maximum.accumulate(raw.height)[:-1] - raw.height[1:]])
    # Rounding alone moves neighbouring levels by up to one step.
    falls = (risen > max(1.5 * step_p, NOISE_HPA)) | (fallen > max(1.5 * step_z, NOISE_M))
    falls |= (fallen > 1.5 * step_z) & (risen > 1.01 * step_p)  # both agree that the balloon sank
    if falls.any():
        count = int(falls.sum())
        if count > max(3, LOST * falls.size):
            raise DataError(
                f"{path}: {count} of {falls.size} levels do not rise with falling pressure; is it one ascent, with the right columns?"
            )
        lost.append(f"{count} of {falls.size} levels fall back below others and are left out")
        raw, humidity = raw.at(~falls), humidity[~falls]
    order = np.argsort(raw.height, kind="stable")
    moved = int(np.sum(order != np.arange(order.size)))
    if moved:
        done.append(f"{moved} of {order.size} levels stand out of order within rounding and noise; heights decide their order")
        raw, humidity = raw.at(order), humidity[order]
    raw, humidity, merged = _merged(raw, humidity)
    if merged:
        done.append(f"{merged} of {order.size} levels repeat a height and are averaged with the level there")
    pressure, repeats = _falling(raw)
    if repeats:
        done.append(
            f"{repeats} of {pressure.size} levels repeat a pressure, rounded to {step_p:g} hPa; they are interpolated in height, "
            "none is left out"
        )
    return replace(raw, pressure=pressure), humidity, done, lost


def _merged(raw: RawSounding, humidity: FloatArray) -> tuple[RawSounding, FloatArray, int]:
    """Average the levels of one height, and return the number of levels that are merged into another."""
    z = raw.height
    first = np.flatnonzero(np.concatenate([[True], np.diff(z) > SAME_M]))
    merged = int(z.size - first.size)
    if not merged:
        return raw, humidity, 0

    def mean(values: FloatArray) -> FloatArray:
        known = np.isfinite(values)
        # Missing values do not count in the mean of a height.
        count = np.add.reduceat(known.astype(np.float64), first)
        return np.where(count > 0.0, np.add.reduceat(np.where(known, values, 0.0), first) / np.maximum(count, 1.0), np.nan)

    raw = replace(
        raw,
        pressure=mean(raw.pressure),
        height=z[first],
        temperature=mean(raw.temperature),
        humidity_value=mean(raw.humidity_value),
        ozone=None if raw.ozone is None else mean(raw.ozone),
    )
    return raw, mean(humidity), merged


def _falling(raw: RawSounding) -> tuple[FloatArray, int]:
    """Return pressures that fall strictly [hPa], and the number of levels whose pressure repeats or exceeds one below.

    A run of equal pressures P represents pressures from P + s/2 down to P - s/2, where s is the rounding: in the middle between the last
    level of a run and the first of the next lies the middle of their pressures. Between these ends the logarithm of pressure is linear in
    height. An end that no run follows has the hydrostatic pressure, within the rounding.
    """
    p, z = np.minimum.accumulate(raw.pressure), raw.height
    starts: NDArray[np.intp] = np.flatnonzero(np.concatenate([[True], p[1:] < p[:-1]]))
    if starts.size == p.size:
        return p, 0
    ends = np.concatenate([starts[1:], [p.size]]) - 1
    count, value = ends - starts + 1, p[starts]
    half = np.maximum(0.5 * raw.resolution[0], np.maximum.reduceat(raw.pressure, starts) - value)
    half = np.minimum(half, 0.5 * value)
    gap = 0.5 * (value[:-1] - value[1:])
    between = 0.5 * (z[ends[:-1]] + z[starts[1:]])
    z_low, z_high = np.concatenate([[z[0]], between]), np.concatenate([between, [z[-1]]])
    scale = DRY_AIR * raw.temperature[starts] / GRAVITY
    # Ratio of the pressures at both ends of a run, hydrostatic at the temperature of its first level.
    thin = np.exp(-np.maximum(z_high - z_low, SAME_M) / scale)
    p_low, p_high = value.copy(), value.copy()
    p_low[1:] += np.minimum(gap, half[1:])
    p_high[:-1] -= np.minimum(gap, half[:-1])
    p_low[0] = min(value[0] + half[0], p_high[0] / thin[0]) if starts.size > 1 else value[0]
    p_high[-1] = max(value[-1] - half[-1], p_low[-1] * thin[-1])
    run = np.repeat(np.arange(starts.size), count)
    share = (z - z_low[run]) / np.maximum(z_high - z_low, SAME_M)[run]
    smooth = np.exp(np.log(p_low)[run] * (1.0 - share) + np.log(p_high)[run] * share)
    return np.where(count[run] > 1, smooth, p), int(np.sum(count - 1))


def check_units(path: Path, raw: RawSounding) -> None:
    """Refuse values that show another unit.

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
    """Return the temperature of numbers in Fahrenheit [K]."""
    return np.asarray((number - 32.0) / 1.8 + ZERO_C)


def _is_fahrenheit(raw: RawSounding) -> bool:
    """Return true where numbers read as Celsius contradict heights and pressures, and read as Fahrenheit agree with them."""
    # Fahrenheit must fit clearly better than Celsius before it is suspected.
    given = span_misfit(raw, raw.temperature)
    other = span_misfit(raw, _fahrenheit(raw.temperature - ZERO_C))
    return bool(given > HYDROSTATIC > other and other < 0.5 * given)


def _check_temperatures(path: Path, raw: RawSounding) -> None:
    """Refuse temperatures that are impossible in air."""
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
        if bool(np.min(cold) > 170.0 and np.max(cold) < 330.0) and not span_misfit(raw, cold) > 1.5 * HYDROSTATIC:
            raise DataError(f"{path}: {name} holds {bad - ZERO_C:.1f} C, which no air has; are temperatures in Fahrenheit?")
        raise DataError(f"{path}: {name} holds {bad:.1f} K ({bad - ZERO_C:.1f} C), which no air has; is it the right column and unit?")


def _check_humidity(path: Path, raw: RawSounding) -> None:
    """Refuse relative humidities that are a share, or impossible."""
    name, value = raw.names["humidity"], raw.humidity_value
    high, low = float(np.nanmax(value)), float(np.nanmin(value))
    if high <= 1.2 and bool(np.max(raw.pressure[np.isfinite(value)]) > 500.0):
        raise DataError(f"{path}: {name} is {high:g} at most; is relative humidity a share (0.8 for 80 %)? % are needed")
    if high > 110.0 or low < 0.0:
        bad = high if high > 110.0 else low
        raise DataError(f"{path}: {name} holds {bad:g}; relative humidity is 0 to 100 %, is it the right column?")


def _check_dew_points(path: Path, raw: RawSounding) -> None:
    """Refuse dew points above the temperature of the air, with the suspected quantity or unit."""
    name = raw.names["humidity"]
    part = raw.at(np.isfinite(raw.humidity_value))
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
    """Return a question about numbers that are no dew points in their unit."""
    in_fahrenheit = bool(np.all(_fahrenheit(number) <= raw.temperature + ABOVE_AIR))
    if float(np.min(number)) >= -0.01:
        if in_fahrenheit and float(np.min(number)) > DRIEST_LOW:
            return "are dew points in Fahrenheit?"
        if bool(np.any(raw.temperature < 278.0)):
            # A mixing ratio is below that of saturated air; a dew-point depression exceeds it in any cold and dry air.
            partial = 1e-5 * saturation_density(raw.temperature) * VAPOUR_CONSTANT * raw.temperature
            saturated = 1e3 * 0.62198 * partial / np.maximum(raw.pressure - partial, 1e-3)
            too_much = np.mean(number > 1.1 * saturated + 0.02)
            return "is it a dew-point depression?" if too_much > 0.02 else "is it a mixing ratio in g/kg?"
        return "is it a mixing ratio in g/kg, or a dew-point depression?"
    if span_misfit(raw, number + ZERO_C) <= HYDROSTATIC and float(np.mean(number + ZERO_C >= raw.temperature - ABOVE_AIR)) > 0.9:
        return "are the columns or units exchanged?"
    return "are dew points in Fahrenheit?" if in_fahrenheit else "are the columns or units exchanged?"
