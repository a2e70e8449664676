"""Reader of a user's sounding as the profile that LOWTRAN7 takes.

CSV columns ``height_m``, ``pressure_hpa``, ``temperature_k`` (or ``temperature_c``) and ``relative_humidity_percent`` (or
``dewpoint_k``, ``dewpoint_c``), heights ascending above the sea.
"""

from __future__ import annotations

import math
from itertools import pairwise
from pathlib import Path

import numpy as np

from seaglint.base.constants import GRAVITY
from seaglint.base.conventions import FloatArray
from seaglint.files.lowtran.deck import MOST_LEVELS, ProfileLevel
from seaglint.files.tables.table_text import read_text_table

COLUMNS = ("height_m", "pressure_hpa", "temperature_k", "relative_humidity_percent")

LOWEST_AT_MOST = 100.0
"""Largest height of the lowest level [m]; it is continued to the sea with its own temperature and humidity."""

TOP_M = 100_000.0
"""Top of LOWTRAN7's atmosphere [m]."""

MODEL_LEVELS_KM = (*range(1, 26), 30, 35, 40, 45, 50, 70, 100)
"""Levels of LOWTRAN7's own models, which continue a sounding upwards."""

DRY_AIR = 287.05
"""Specific gas constant [J kg-1 K-1]."""

LEVELS_ABOVE = 12
"""Largest number of levels of the model above a sounding that needs room itself."""

THINNING = (0.002, 0.3, 2.0)
"""Differences of equal weight when levels are left out: relative pressure [1], temperature [K], relative humidity [%]."""


def read_sounding(path: str | Path) -> tuple[ProfileLevel, ...]:
    """Read levels from the sea to 100 km: the sounding's, thinned to what LOWTRAN7 takes, then those of the model atmosphere.

    Raises
    ------
    DataError
        Naming file, line and column of what cannot be used.

    Notes
    -----
    Levels are left out where the others, interpolated (pressure logarithmically), miss the sounding least. Saturation for dew points
    is LOWTRAN7's own formula over water.
    """
    table = read_text_table(path, COLUMNS)
    table.require("height_m", "pressure_hpa")
    heat, moist = table.one_of("temperature_k", "temperature_c"), table.one_of("relative_humidity_percent", "dewpoint_k", "dewpoint_c")
    zero = 273.15 if heat == "temperature_c" else 0.0
    levels: list[tuple[float, float, float, float]] = []
    for row in table.rows:
        height = table.number(row, "height_m", 0.0, TOP_M)
        pressure = table.number(row, "pressure_hpa", 1e-5, 1100.0)
        temperature = zero + table.number(row, heat, 100.0 - zero, 350.0 - zero)
        if moist == "relative_humidity_percent":
            humidity = table.number(row, moist, 0.0, 105.0)
        else:
            dew_zero = 273.15 if moist == "dewpoint_c" else 0.0
            dew = dew_zero + table.number(row, moist, 100.0 - dew_zero, 350.0 - dew_zero)
            if dew > temperature + 0.5:
                raise table.error(row.line, f"{moist} = {row.cells[moist]} is above the temperature; are units and columns right?")
            humidity = 100.0 * saturation_density(min(dew, temperature)) * dew / (saturation_density(temperature) * temperature)
        if levels and height <= levels[-1][0]:
            raise table.error(row.line, f"height_m = {row.cells['height_m']} is not above the line before; sort the levels upwards")
        if levels and pressure >= levels[-1][1]:
            raise table.error(row.line, f"pressure_hpa = {row.cells['pressure_hpa']} is not below the line before; is it the pressure?")
        if not levels and height > LOWEST_AT_MOST:
            raise table.error(row.line, f"height_m = {height:g}: the lowest level must lie within {LOWEST_AT_MOST:g} m of the sea; add one")
        levels.append((height, pressure, temperature, humidity))
    if len(levels) < 2:
        raise table.error(table.rows[-1].line, "is the only level; a sounding needs 2 at least")
    return _to_the_top(_down_to_the_sea(levels))


def saturation_density(temperature: float) -> float:
    """Return LOWTRAN7's density of saturated vapour over water [g m-3]: ``A exp(18.9766 - 14.9595 A - 2.43882 A^2)``, A = 273.15/T.

    >>> round(saturation_density(288.15), 2)
    12.82
    """
    a = 273.15 / temperature
    return a * math.exp(18.9766 - 14.9595 * a - 2.43882 * a * a)


def _down_to_the_sea(levels: list[tuple[float, float, float, float]]) -> list[tuple[float, float, float, float]]:
    height, pressure, temperature, humidity = levels[0]
    if height == 0.0:
        return levels
    return [(0.0, pressure * math.exp(GRAVITY * height / (DRY_AIR * temperature)), temperature, humidity), *levels]


def _to_the_top(levels: list[tuple[float, float, float, float]]) -> tuple[ProfileLevel, ...]:
    top = levels[-1][0] / 1e3
    above = [float(z) for z in MODEL_LEVELS_KM if z > top + 0.2]  # closer levels make LOWTRAN7's layers degenerate
    room = MOST_LEVELS - min(len(above), LEVELS_ABOVE)
    thinned = _thinned(np.array(levels), room)
    while len(thinned) + len(above) > MOST_LEVELS:
        # The closest pair of the model's levels loses its upper one, never the last.
        gaps = [(b - a) / b for a, b in pairwise(above[:-1])]
        del above[int(np.argmin(gaps)) + 1]
    own = [ProfileLevel(float(z) / 1e3, float(p), float(t), float(u)) for z, p, t, u in thinned]
    return (*own, *(ProfileLevel(z) for z in above))


def _thinned(levels: FloatArray, room: int) -> FloatArray:
    """Return the rows that interpolate the others best: ends first, then the worst interpolated one after the other."""
    if len(levels) <= room:
        return levels
    scaled = np.column_stack([np.log(levels[:, 1]) / THINNING[0], levels[:, 2] / THINNING[1], levels[:, 3] / THINNING[2]])
    chosen = [0, len(levels) - 1]
    while len(chosen) < room:
        order = np.sort(chosen)
        guess = np.column_stack([np.interp(levels[:, 0], levels[order, 0], column[order]) for column in scaled.T])
        chosen.append(int(np.argmax(np.abs(scaled - guess).max(axis=1))))
    return np.asarray(levels[np.sort(chosen)])
