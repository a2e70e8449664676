"""Codes of marine reports in ICOADS: total cloud, visibility, direction and wave height.

References
----------
S. R. Smith et al., "The International Maritime Meteorological Archive (IMMA) Format", ICOADS Release 3.0 (2016), table C0;
WMO Manual on Codes, code tables 2700 (total cloud) and 4377 (visibility).
C. J. Hahn, S. G. Warren and J. London, "Edited synoptic cloud reports from ships and land stations over the globe, 1982-1991",
ORNL/CDIAC-77, NDP-026B (1996), Sec. 3.B: a sky obscured by fog, rain or snow counts as overcast, one obscured otherwise is missing.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.climate.derived import ICE_POINT, relative_humidity, significant_height

CALM: Final = 361.0  #: Code of the wind direction of a calm; 362 is a variable one, and neither has a direction.

OBSCURED: Final = 9.0  #: Total cloud of a sky that cannot be seen.

#: Present weather (code 4677) of fog, rain and snow that hide an overcast sky.
OBSCURING: Final = np.array(
    [10, 11, 12, *range(40, 50), *range(50, 76), 77, 79, *range(80, 100)],
    dtype=np.float64,
)

#: Lower border of each step of code 4377 [km]; 90 is anything below 0.05 km and stands as half of it.
VISIBILITY_KM: Final = {90: 0.025, 91: 0.05, 92: 0.2, 93: 0.5, 94: 1.0, 95: 2.0, 96: 4.0, 97: 10.0, 98: 20.0, 99: 50.0}

HALF_METRES: Final = 0.5  #: Unit of the heights of waves and swell [m].


def columns_of(report: dict[str, FloatArray]) -> tuple[dict[str, FloatArray], dict[str, int], list[str]]:
    """Return the columns of a weather table from those of marine reports.

    Parameters
    ----------
    report : dict of (rows,) arrays
        By their names in IMMA, NaN where missing: MO, HR [h], LAT, LON [deg], D [deg or 361, 362], W [m/s], VV (code 4377), WW (code 4677),
        AT, DPT, SST [degC], N [oktas or 9], WH, SH [half metres]. What is not there is missing throughout.

    Returns
    -------
    (dict, dict, list)
        Columns; values set missing, by reason; what was assumed.
    """
    rows = next(iter(report.values())).size

    def get(name: str) -> FloatArray:
        return report.get(name, np.full(rows, np.nan))

    direction, cloud, weather, visibility = get("D"), get("N"), get("WW"), get("VV")
    speed = np.where(np.isnan(get("W")) & (direction == CALM), 0.0, get("W"))
    hidden = cloud == OBSCURED
    overcast = hidden & np.isin(weather, OBSCURING)
    air, dew, sea = (get(name) + ICE_POINT for name in ("AT", "DPT", "SST"))
    columns = {
        "wind_speed_m_s": speed,
        "wind_from_deg": np.where((direction >= CALM) | (speed == 0.0), np.nan, direction % 360.0),
        "cloud_cover": np.where(overcast, 1.0, np.where(hidden, np.nan, cloud / 8.0)),
        "sea_temperature_k": sea,
        "air_temperature_k": air,
        "relative_humidity": relative_humidity(air, dew),
        "visibility_km": _visibility(visibility),
        "significant_height_m": significant_height(HALF_METRES * get("WH"), HALF_METRES * get("SH")),
        "month": get("MO"),
        "hour_utc": get("HR"),
        "latitude_deg": get("LAT"),
        "longitude_deg": get("LON"),
    }
    lost = {
        "cloud_cover of a sky obscured by other than fog, rain or snow": int(np.sum(hidden & ~overcast)),
        "wind_from_deg of a calm or variable wind": int(np.sum((direction >= CALM) & ~np.isnan(direction))),
    }
    notes = []
    if overcast.any():
        notes.append(f"{int(overcast.sum())} skies hidden by fog, rain or snow count as overcast")
    if np.any(~np.isnan(visibility)):
        notes.append("visibility is the lower border of its code's step")
    return columns, {reason: count for reason, count in lost.items() if count}, notes


def _visibility(code: FloatArray) -> FloatArray:
    out = np.full(code.shape, np.nan)
    for step, km in VISIBILITY_KM.items():
        out[code == step] = km
    return out
