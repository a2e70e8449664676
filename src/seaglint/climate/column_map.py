"""Mapping of the columns of a user's table to those of a weather table, with the linear conversion of units."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from seaglint.climate.weather_table import RANGES, TEXTS

#: Unit of each column with a unit; cloud cover, humidity, month and weight are plain numbers.
UNITS: Final = {
    "wind_speed_m_s": "m/s",
    "wind_from_deg": "deg",
    "sea_temperature_k": "K",
    "air_temperature_k": "K",
    "visibility_km": "km",
    "significant_height_m": "m",
    "hour_utc": "hour",
    "latitude_deg": "deg",
    "longitude_deg": "deg",
    "wind_to_deg": "deg",
    "wind_u_m_s": "m/s",
    "wind_v_m_s": "m/s",
    "dew_point_k": "K",
}

SHARES: Final = ("cloud_cover", "relative_humidity")  #: Columns of shares of 1, which other tables have in percent, oktas or tenths.

#: Spellings of the units of a share, with the factor of each.
SHARE_UNITS: Final = {"1": 1.0, "fraction": 1.0, "percent": 0.01, "%": 0.01, "okta": 0.125, "oktas": 0.125, "tenths": 0.1}

#: Further target columns from which a weather table's are derived.
#:
#: These are ISO times, the direction that a wind blows towards, its components towards east and north, and the dew point.
HELPERS: Final = ("time", "wind_to_deg", "wind_u_m_s", "wind_v_m_s", "dew_point_k")

TARGETS: Final = (*RANGES, *TEXTS, *HELPERS)  #: Names of all target columns of a mapping.


@dataclass(frozen=True)
class MappedColumn:
    """Mapping of one column: value = ``scale * cell + offset``."""

    name: str  #: One of :data:`TARGETS`.
    column: str  #: Heading in the file.
    unit: str = ""  #: Unit as given, for messages; empty where the cells are in the unit of the target column.
    #: ``scale``, ``offset``: The line from its unit to ours.
    scale: float = 1.0
    offset: float = 0.0
