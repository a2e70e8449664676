"""Smooth bootstrap: drawn rows with kernel noise, so that a short table does not repeat the same few conditions.

Each number gets normal noise whose standard deviation, the bandwidth, is Silverman's rule for as many dimensions as are smoothed,

    h_j = s_j (4 / ((d + 2) n))^(1 / (d + 4)),

s_j the column's standard deviation and n the effective number of rows. The variance of a column grows by the share (h_j / s_j)^2 where no
bound is near. Noise is reflected at bounds; what stands exactly at a bound (a calm, a clear or an overcast sky) stays there, because it
is a state of its own: the chance of overcast must not be smoothed away.

References
----------
B. W. Silverman, Density Estimation for Statistics and Data Analysis (1986), Eq. 4.14 and Sec. 6.4.1.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np
from scipy.special import ndtri

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError
from seaglint.climate.weather_table import IntArray, WeatherTable

#: Columns that can be smoothed, with their bounds; directions are periodic.
BOUNDS: Final[Mapping[str, tuple[float, float]]] = {
    "wind_speed_m_s": (0.0, np.inf),
    "wind_from_deg": (-np.inf, np.inf),
    "cloud_cover": (0.0, 1.0),
    "sea_temperature_k": (-np.inf, np.inf),
    "air_temperature_k": (-np.inf, np.inf),
    "relative_humidity": (0.0, 1.0),
    "visibility_km": (0.0, np.inf),
    "significant_height_m": (0.0, np.inf),
}


def bandwidths(table: WeatherTable, names: Sequence[str] = ("wind_speed_m_s", "cloud_cover")) -> dict[str, float]:
    """Bandwidth of each column, in its unit; 0 where it has no spread or no values.

    Raises
    ------
    DomainError
        A column that cannot be smoothed.
    """
    for name in names:
        if name not in BOUNDS:
            raise DomainError(f"'{name}' cannot be smoothed; smoothed can be {', '.join(BOUNDS)}")
    d = len(names)
    rule = (4.0 / ((d + 2) * table.effective_rows)) ** (1.0 / (d + 4))
    return {name: rule * _spread(table, name) for name in names}


def _spread(table: WeatherTable, name: str) -> float:
    """Weighted standard deviation of the valid values; for directions that of a wrapped normal of the same resultant."""
    values, weight = table[name], table["weight"]
    known = ~np.isnan(values) & (weight > 0.0)
    if not known.any():
        return 0.0
    if name == "wind_from_deg":
        length = min(abs(np.average(np.exp(1j * np.radians(values[known])), weights=weight[known])), 1.0)
        # Beyond 90 deg a direction is as good as uniform, and noise of any width leaves it so.
        return float(np.degrees(min(np.sqrt(-2.0 * np.log(max(length, 1e-12))), np.pi / 2)))
    mean = np.average(values[known], weights=weight[known])
    return float(np.sqrt(np.average((values[known] - mean) ** 2, weights=weight[known])))


def smoothed(table: WeatherTable, rows: IntArray, uniform: FloatArray, bandwidth: Mapping[str, float]) -> WeatherTable:
    """Drawn rows with noise, all of the same weight.

    Parameters
    ----------
    table : WeatherTable
        The table drawn from.
    rows : (n,) array of int
        Rows from :meth:`~seaglint.climate.weather_table.WeatherTable.draw`.
    uniform : (n, columns) array
        Numbers inside (0, 1), a column for each of ``bandwidth`` in its order.
    bandwidth : mapping
        Standard deviation of the noise by column, as :func:`bandwidths` gives it.

    Raises
    ------
    DomainError
        Uniform numbers of another shape or range.
    """
    uniform = np.asarray(uniform, dtype=np.float64)
    if uniform.shape != (rows.size, len(bandwidth)) or not np.all((uniform > 0.0) & (uniform < 1.0)):
        raise DomainError(
            f"uniform numbers of shape {uniform.shape} are not {rows.size} x {len(bandwidth)} numbers inside (0, 1); give one for each row "
            "and each smoothed column"
        )
    drawn = table.take(rows) if np.any(table["weight"][rows] > 0.0) else table
    columns = dict(drawn.columns) | {"weight": np.ones(rows.size)}
    for at, (name, width) in enumerate(bandwidth.items()):
        if name in columns:
            columns[name] = _noisy(columns[name], width * ndtri(uniform[:, at]), name)
    return WeatherTable(columns, drawn.texts)


def _noisy(values: FloatArray, noise: FloatArray, name: str) -> FloatArray:
    low, high = BOUNDS[name]
    moved = values + noise
    if name == "wind_from_deg":
        return np.asarray(moved % 360.0)
    if np.isfinite(high):
        period = 2.0 * (high - low)
        folded = np.abs((moved - low) % period)
        moved = low + np.minimum(folded, period - folded)
    elif np.isfinite(low):
        moved = low + np.abs(moved - low)
    return np.where((values <= low) | (values >= high), values, moved)
