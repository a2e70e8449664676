"""Facts of a table of weather as plain numbers: what JSON, text and pictures read."""

from __future__ import annotations

from dataclasses import asdict, dataclass

from seaglint.base.free_form import JsonObject


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
    #: ``wind_speed_m_s``, ``cloud_cover``: Weighted means; None where there is none.
    wind_speed_m_s: float | None
    cloud_cover: float | None


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
    weight_sum: float  #: Sum of the weights as they stand in the file.
    covers: str  #: Places and times that are covered.
    months: list[int]  #: Months with rows.
    missing_months: dict[str, str]  #: Months without rows, with those that serve for them.
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
