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
    """Rows of one month.

    Attributes
    ----------
    month : int
        1 to 12.
    rows : int
        Their number.
    probability : float
        Their share of the table's weight [1].
    wind_speed_m_s, cloud_cover : float or None
        Weighted means; None where there is none.
    """

    month: int
    rows: int
    probability: float
    wind_speed_m_s: float | None
    cloud_cover: float | None


@dataclass(frozen=True)
class WindRose:
    """Probability of direction and speed.

    Attributes
    ----------
    sector_centre_deg : list of float
        Middles of the sectors that the wind comes from [deg].
    speed_edges_m_s : list of float or None
        Edges of the classes of speed; the last class has no upper one.
    probability : list of list of float
        Share of the weight by sector and class of speed [1].
    """

    sector_centre_deg: list[float]
    speed_edges_m_s: list[float | None]
    probability: list[list[float]]


@dataclass(frozen=True)
class WindCloud:
    """Probability of wind speed and cloud cover together.

    Attributes
    ----------
    speed_edges_m_s : list of float or None
        Edges of the classes of speed; the last class has no upper one.
    cloud_edges : list of float
        Edges of the classes of cloud cover [1].
    probability : list of list of float
        Share of the weight by class of speed and of cover [1].
    """

    speed_edges_m_s: list[float | None]
    cloud_edges: list[float]
    probability: list[list[float]]


@dataclass(frozen=True)
class WeatherFacts:
    """Contents of a table of weather.

    Attributes
    ----------
    path : str
        File, or name of the table in the package.
    rows : int
        Number of rows.
    effective_rows : float
        Number of rows of equal weight with the same scatter.
    weight_sum : float
        Sum of the weights as they stand in the file.
    covers : str
        Places and times that are covered.
    months : list of int
        Months with rows.
    missing_months : dict of str
        Months without rows, with those that serve for them.
    regions : list of str
        Names of regions in the table.
    atmospheres : dict of float
        Share of the weight of each model atmosphere [1].
    columns : dict of ColumnFacts
        Columns by name.
    missing_share : dict of float
        Share of the weight without a value, by column; 1 where there is no such column.
    wind_cloud_correlation : float or None
        Correlation of wind speed and cloud cover [1].
    by_month : list of MonthFacts
        Means by month.
    wind_rose : WindRose
        Directions and speeds.
    wind_cloud : WindCloud
        Speeds and cloud cover.
    notes : list of str
        Comments of the file, and remarks.
    """

    path: str
    rows: int
    effective_rows: float
    weight_sum: float
    covers: str
    months: list[int]
    missing_months: dict[str, str]
    regions: list[str]
    atmospheres: dict[str, float]
    columns: dict[str, ColumnFacts]
    missing_share: dict[str, float]
    wind_cloud_correlation: float | None
    by_month: list[MonthFacts]
    wind_rose: WindRose
    wind_cloud: WindCloud
    notes: list[str]

    def as_dict(self) -> JsonObject:
        """Return plain numbers and text."""
        return asdict(self)
