"""Heights and pressures of soundings that contradict each other."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from seaglint.air.profile.air_profile import saturation_density
from seaglint.base.constants import GRAVITY
from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError
from seaglint.files.soundings.raw_sounding import VAPOUR_CONSTANT, RawSounding

DRY_AIR: Final = 287.05  #: Specific gas constant of dry air [J kg-1 K-1].

HYDROSTATIC: Final = 0.02  #: Largest relative difference of a thickness from the hydrostatic one.

SPAN: Final = 1000.0  #: Thickness over which heights and pressures are compared [m].

SURFACE_PRESSURES: Final = (850.0, 1100.0)  #: Pressures at the sea [hPa]; hurricanes have 870.


def virtual_temperature(temperature: ArrayLike, pressure: ArrayLike, humidity: ArrayLike) -> FloatArray:
    """Temperature of dry air of the same density [K], from temperature [K], pressure [hPa] and relative humidity [%]."""
    t = np.asarray(temperature, dtype=np.float64)
    vapour = 1e-5 * saturation_density(t) * VAPOUR_CONSTANT * t * np.asarray(humidity) / 100.0
    return np.asarray(t / (1.0 - 0.378 * np.minimum(vapour / np.asarray(pressure), 0.5)))


def whole_humidity(pressure: FloatArray, humidity: FloatArray) -> FloatArray:
    """Relative humidity [%] without gaps, for the weight of the air alone: linear in log pressure, and as the pressure above the last."""
    known = np.isfinite(humidity)
    if known.all():
        return humidity
    x = -np.log(pressure)
    order = np.argsort(x[known])
    at, values = x[known][order], humidity[known][order]
    return np.asarray(np.interp(x, at, values) * np.exp(np.minimum(at[-1] - x, 0.0)))


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
    for start, end in _spans(z, sums):
        given, ours = z[end] - z[start], sums[end] - sums[start]
        if abs(given - ours) > HYDROSTATIC * max(ours, given) + _slack(raw, start, end):
            _refuse(path, raw, start, end, float(ours))
    at_sea = float(p[0] * np.exp(GRAVITY * z[0] / (DRY_AIR * raw.temperature[0])))
    low, high = SURFACE_PRESSURES
    if not low <= at_sea <= high:
        raise DataError(
            f"{path}: {p[0]:g} hPa at {z[0]:.0f} m make {at_sea:.0f} hPa at the sea; {low:g} to {high:g} are allowed: "
            "are heights above the ground, or columns exchanged?"
        )
    return whole


def span_misfit(raw: RawSounding, temperature: FloatArray) -> float:
    """Largest relative misfit of heights from the hydrostatic ones of dry air of some temperatures [K], over spans of a kilometre [1].

    Rounding of the file is taken off. The result is NaN where fewer than two levels have heights.
    """
    known = np.flatnonzero(np.isfinite(raw.height) & np.isfinite(temperature) & (temperature > 1.0) & (raw.pressure > 0.0))
    known = known[np.argsort(raw.height[known], kind="stable")]
    if known.size < 2:
        return float("nan")
    part = raw.kept(known)
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
    """Pairs of levels that lie a span apart by their heights or by their pressures; the last pair overlaps the one below where it must."""
    first, last = 0, height.size - 1
    while first < last:
        ends = (int(np.searchsorted(height, height[first] + SPAN)), int(np.searchsorted(sums, sums[first] + SPAN)))
        end = max(min(ends), first + 1)
        if end > last:
            # two levels close to each other differ by their noise
            lower = (int(np.searchsorted(height, height[last] - SPAN, "right")), int(np.searchsorted(sums, sums[last] - SPAN, "right")))
            first, end = min(first, max(max(lower) - 1, 0)), last
        yield first, end
        first = end


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
