"""Summary of a table of weather: wind rose, joint distribution of wind and cloud, months, missing shares.

The records hold plain numbers for JSON, text and pictures.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Final

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.base.free_form import JsonObject, number
from seaglint.climate.weather_table import RANGES, TEXTS, WeatherTable


@dataclass(frozen=True)
class ColumnFacts:
    """Weighted mean, limits and weighted share of missing values of a column; None where a number does not exist."""

    mean: float | None
    min: float | None
    max: float | None
    missing_share: float


@dataclass(frozen=True)
class MonthFacts:
    """Rows of one month."""

    month: int  #: 1 to 12.
    rows: int  #: Their number.
    probability: float  #: Their share of the table's weight [1].
    wind_speed_m_s: float | None  #: Weighted mean wind speed [m s-1]; None without values.
    cloud_cover: float | None  #: Weighted mean cloud cover [1]; None without values.


@dataclass(frozen=True)
class WindRose:
    """Probability of direction and speed."""

    sector_centre_deg: list[float]  #: Middles of the sectors that the wind comes from [deg].
    speed_edges_m_s: list[float | None]  #: Edges of the classes of speed; the last class has no upper one.
    probability: list[list[float]]  #: Share of the weight by sector and class of speed [1].


@dataclass(frozen=True)
class WindCloud:
    """Probability of wind speed and cloud cover together."""

    speed_edges_m_s: list[float | None]  #: Edges of the classes of speed; the last class has no upper one.
    cloud_edges: list[float]  #: Edges of the classes of cloud cover [1].
    probability: list[list[float]]  #: Share of the weight by class of speed and of cover [1].


@dataclass(frozen=True)
class WeatherFacts:
    """Contents of a table of weather."""

    path: str  #: File, or name of the table in the package.
    rows: int  #: Number of rows.
    effective_rows: float  #: Number of rows of equal weight with the same scatter.
    weight_sum: float  #: Sum of the weights in the file.
    covers: str  #: Places and times that are covered.
    months: list[int]  #: Months with rows.
    missing_months: dict[str, str]  #: Months without rows, with the months used in their place.
    regions: list[str]  #: Names of regions in the table.
    atmospheres: dict[str, float]  #: Share of the weight of each model atmosphere [1].
    columns: dict[str, ColumnFacts]  #: Columns by name.
    missing_share: dict[str, float]  #: Share of the weight without a value, by column; 1 where there is no such column.
    wind_cloud_correlation: float | None  #: Correlation of wind speed and cloud cover [1].
    by_month: list[MonthFacts]  #: Means by month.
    wind_rose: WindRose  #: Directions and speeds.
    wind_cloud: WindCloud  #: Speeds and cloud cover.
    notes: list[str]  #: Comments of the file, and remarks.

    def as_dict(self) -> JsonObject:
        """Return plain numbers and text."""
        return asdict(self)


SECTORS: Final = 16  #: Number of sectors of the wind rose, the first centred on north.

SPEED_EDGES: Final = (0.0, 2.0, 5.0, 8.0, 11.0, 14.0, 20.0, np.inf)  #: Classes of wind speed [m/s].

CLOUD_EDGES: Final = tuple(np.round((np.arange(10) - 0.5) / 8.0, 4))  #: Classes of cloud cover: the nine oktas, 0 to 8.


def wind_rose(table: WeatherTable) -> FloatArray:
    """Probability of direction and speed [(sectors, speed classes)]; its sum is the share of rows that have both.

    Sector k is centred on 360 k / ``SECTORS`` deg, which the wind comes from.
    """
    come, speed = table["wind_from_deg"], table["wind_speed_m_s"]
    known = ~np.isnan(come) & ~np.isnan(speed)
    width = 360.0 / SECTORS
    # Half a sector further, so that the first one is centred on north.
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


def month_means(table: WeatherTable) -> list[MonthFacts]:
    """Return the rows and means of each month that has rows."""
    out = []
    for month in table.months:
        at = table["month"] == month
        rows = table.take(at)
        means = number(rows.mean("wind_speed_m_s")), number(rows.mean("cloud_cover"))
        out.append(MonthFacts(month, int(at.sum()), float(table.probability[at].sum()), *means))
    return out


def missing_shares(table: WeatherTable) -> dict[str, float]:
    """Weighted share of rows without a value, of every column that the table may have; 1 where it has no such column."""
    return {name: table.missing_share(name) for name in (*RANGES, *TEXTS) if name != "weight"}
