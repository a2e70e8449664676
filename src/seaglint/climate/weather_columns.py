"""Columns of a weather table from other tables: derived quantities, and the mapping of columns with the linear conversion of units.

Derived quantities are the wind from its components, humidity, wave height and model atmosphere.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from seaglint.base.conventions import FloatArray
from seaglint.climate.weather_table import RANGES, TEXTS

ICE_POINT: Final = 273.15  #: Temperature of 0 degC [K].

#: Latitude below which the tropical model atmosphere is used [deg]: halfway between its 15 deg and the midlatitude model's 45 deg.
TROPICAL_BELOW: Final = 30.0

SUBARCTIC_FROM: Final = 52.5  #: Latitude from which the subarctic models are used [deg]: halfway between 45 and 60 deg.

_MAGNUS: Final = (17.625, 243.04)  #: Constants of Magnus' formula [1], [degC].


def wind_from_components(east: ArrayLike, north: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Return the speed of a wind and the direction that it comes from, from the components that it blows towards.

    ``speed = sqrt(u^2 + v^2)``, ``direction = atan2(-u, -v)``.

    Parameters
    ----------
    east, north : array
        Components u and v [m/s]; a westerly wind has u > 0.

    Returns
    -------
    (array, array)
        Speed [m/s]; direction it comes from, clockwise from north [deg, 0 to below 360], NaN in a calm.

    Examples
    --------
    >>> speed, come = wind_from_components([5.0, 0.0], [0.0, -3.0])
    >>> speed.tolist(), come.tolist()
    ([5.0, 3.0], [270.0, 0.0])
    """
    u, v = np.asarray(east, dtype=np.float64), np.asarray(north, dtype=np.float64)
    speed = np.hypot(u, v)
    come = np.degrees(np.arctan2(-u, -v)) % 360.0
    come = np.where(come >= 360.0, 0.0, come)  # a tiny negative angle rounds up to 360
    return speed, np.where(speed > 0.0, come, np.nan)


def relative_humidity(air_k: ArrayLike, dew_point_k: ArrayLike) -> FloatArray:
    """Return the relative humidity over water, from air temperature and dew point [share of 1].

    Notes
    -----
    Magnus' formula with the constants of Alduchov and Eskridge, J. Appl. Meteor. 35, 601-609 (1996), Eq. 21: saturation vapour pressure
    within 0.4 % from -40 to 50 degC.

    Examples
    --------
    >>> round(float(relative_humidity(293.15, 283.15)), 3)
    0.525
    """
    a, b = _MAGNUS
    # Ratio of the saturation pressures at the dew point and at the temperature of the air.
    air, dew = (np.asarray(t, dtype=np.float64) - ICE_POINT for t in (air_k, dew_point_k))
    return np.asarray(np.exp(a * dew / (b + dew) - a * air / (b + air)))


def significant_height(wind_waves: ArrayLike, swell: ArrayLike) -> FloatArray:
    """Return the significant height of wind waves and swell together [m]: root of the sum of squares, as their variances add.

    Where only one of the two is reported, it is the height; where neither is, the height is missing.

    Examples
    --------
    >>> significant_height([3.0, 1.0], [4.0, np.nan]).tolist()
    [5.0, 1.0]
    """
    a, b = np.asarray(wind_waves, dtype=np.float64), np.asarray(swell, dtype=np.float64)
    return np.where(np.isnan(a) & np.isnan(b), np.nan, np.hypot(np.nan_to_num(a), np.nan_to_num(b)))


def west_east(longitude: ArrayLike) -> FloatArray:
    """Return a longitude of any convention as degrees east in [-180, 180).

    Examples
    --------
    >>> west_east([350.0, -170.0, 180.0]).tolist()
    [-10.0, -170.0, -180.0]
    """
    return np.asarray((np.asarray(longitude, dtype=np.float64) + 180.0) % 360.0 - 180.0)


def model_atmosphere(latitude: ArrayLike, month: ArrayLike) -> NDArray[np.str_]:
    """Return LOWTRAN7's model atmosphere for a latitude [deg] and month; empty where one of them is missing.

    Tropical up to ``TROPICAL_BELOW``, subarctic from ``SUBARCTIC_FROM``, midlatitude between; summer is April to September in
    the north and October to March in the south.

    Examples
    --------
    >>> model_atmosphere([10.0, 45.0, -45.0, 60.0], [1, 7, 7, 1]).tolist()
    ['tropical', 'midlatitude-summer', 'midlatitude-winter', 'subarctic-winter']
    """
    lat, number = np.broadcast_arrays(np.asarray(latitude, dtype=np.float64), np.asarray(month, dtype=np.float64))
    # April to September is the summer of the north and the winter of the south.
    warm = ((number >= 4) & (number <= 9)) == (lat >= 0.0)
    zone = np.where(np.abs(lat) >= SUBARCTIC_FROM, "subarctic", "midlatitude")
    seasonal = np.char.add(zone, np.where(warm, "-summer", "-winter"))
    known = np.where(np.abs(lat) <= TROPICAL_BELOW, "tropical", seasonal)
    return np.asarray(np.where(np.isnan(lat) | np.isnan(number), "", known), dtype=np.str_)


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

    name: str  #: One of ``TARGETS``.
    column: str  #: Heading in the file.
    unit: str = ""  #: Unit as given, for messages; empty where the cells are in the unit of the target column.
    scale: float = 1.0  #: Factor from its unit to ours.
    offset: float = 0.0  #: Offset of that line, in our unit.
