"""Summary of a table of weather: wind rose, joint distribution of wind and cloud, months, shares missing."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.climate.weather_table import RANGES, TEXTS, WeatherTable

SECTORS: Final = 16  #: Number of sectors of the wind rose, the first centred on north.

SPEED_EDGES: Final = (0.0, 2.0, 5.0, 8.0, 11.0, 14.0, 20.0, np.inf)  #: Classes of wind speed [m/s].

CLOUD_EDGES: Final = tuple(np.round((np.arange(10) - 0.5) / 8.0, 4))  #: Classes of cloud cover: those of the nine oktas, 0 to 8.


def wind_rose(table: WeatherTable) -> FloatArray:
    """Probability of direction and speed [(sectors, speed classes)]; its sum is the share of rows that have both.

    Sector k is centred on 360 k / :data:`SECTORS` deg, which the wind comes from.
    """
    come, speed = table["wind_from_deg"], table["wind_speed_m_s"]
    known = ~np.isnan(come) & ~np.isnan(speed)
    width = 360.0 / SECTORS
    sector = np.floor(((come[known] + 0.5 * width) % 360.0) / width).astype(np.int64)
    speed_class = np.searchsorted(SPEED_EDGES, speed[known], side="right") - 1
    out = np.zeros((SECTORS, len(SPEED_EDGES) - 1))
    np.add.at(out, (sector, speed_class), table.probability[known])
    return out


def joint_density(table: WeatherTable) -> FloatArray:
    """Probability of wind speed and cloud cover [(speed classes, cloud classes)]; its sum is the share of rows that have both."""
    speed, cloud = table["wind_speed_m_s"], table["cloud_cover"]
    known = ~np.isnan(speed) & ~np.isnan(cloud)
    density, _, _ = np.histogram2d(speed[known], cloud[known], bins=(SPEED_EDGES, CLOUD_EDGES), weights=table.probability[known])
    return np.asarray(density)


def correlation(table: WeatherTable, first: str = "wind_speed_m_s", second: str = "cloud_cover") -> float:
    """Weighted correlation of two columns over the rows that have both; NaN where one does not vary."""
    a, b, weight = table[first], table[second], table["weight"]
    known = ~np.isnan(a) & ~np.isnan(b) & (weight > 0.0)
    if not known.any():
        return float("nan")
    a, b, weight = a[known], b[known], weight[known]
    a, b = a - np.average(a, weights=weight), b - np.average(b, weights=weight)
    spread = np.sqrt(np.average(a * a, weights=weight) * np.average(b * b, weights=weight))
    return float(np.average(a * b, weights=weight) / spread) if spread > 0.0 else float("nan")


@dataclass(frozen=True)
class MonthMeans:
    """Means of one month."""

    month: int
    rows: int
    probability: float  #: Share of the table's weight.
    wind_speed_m_s: float
    cloud_cover: float


def month_means(table: WeatherTable) -> list[MonthMeans]:
    """Means of each month that has rows."""
    out = []
    for month in table.months:
        at = table["month"] == month
        part = table.take(at)
        out.append(
            MonthMeans(month, int(at.sum()), float(table.probability[at].sum()), part.mean("wind_speed_m_s"), part.mean("cloud_cover"))
        )
    return out


def missing_shares(table: WeatherTable) -> dict[str, float]:
    """Weighted share of rows without a value, of every column that the table may have; 1 where it has no such column."""
    return {name: table.missing_share(name) for name in (*RANGES, *TEXTS) if name != "weight"}
