"""Hours of the day for draws: most of them while the Sun is up, with weights that undo the choice.

A sea at night does not glint. The arc of the day is known to some minutes only, and need not be known better: the rest of the day is
drawn too, and weights are those of the choice that was made.
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

import numpy as np

from seaglint.base.conventions import FloatArray

_BY_DAY: Final = 15.0 / 16.0  #: Share of the draws given to the arc; a dyadic one keeps Sobol points even on both sides.

#: Elevation of the Sun at the ends of the arc [rad]: refraction, radius of the disc and 0.3 deg for places far from the sensor.
_DUSK: Final = math.radians(-1.2)

_YEAR: Final = 365.2422 * 86_400.0
_HALF_DAY: Final = 12.0


class Hours(NamedTuple):
    """Hours of the day and the weight of each [(n,)]."""

    hour: FloatArray  #: Hours UTC [h].
    weight: FloatArray  #: Ratio of the required density (even over the allowed hours) to that of the draws [1]; 1 on average.


def arc(day: FloatArray, latitude: FloatArray, longitude: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Noon [h UTC] and half of the time during which the Sun is up [h, 0 to 12], within some minutes.

    Parameters
    ----------
    day : ndarray
        Beginnings of days [s since 1970-01-01 UTC].
    latitude, longitude : ndarray
        North and east positive [deg].

    References
    ----------
    J. W. Spencer, Fourier series representation of the position of the Sun, Search 2 (1971) 172.
    """
    first = day.astype("datetime64[s]").astype("datetime64[Y]").astype("datetime64[s]").astype(np.float64)
    x = 2.0 * math.pi * (day + 43_200.0 - first) / _YEAR
    declination = (
        0.006918 - 0.399912 * np.cos(x) + 0.070257 * np.sin(x) - 0.006758 * np.cos(2 * x) + 0.000907 * np.sin(2 * x)
        - 0.002697 * np.cos(3 * x) + 0.00148 * np.sin(3 * x)
    )  # fmt: skip
    late = 0.000075 + 0.001868 * np.cos(x) - 0.032077 * np.sin(x) - 0.014615 * np.cos(2 * x) - 0.040849 * np.sin(2 * x)
    phi = np.radians(latitude)
    across = np.maximum(np.cos(phi) * np.cos(declination), 1e-9)
    cosine = (math.sin(_DUSK) - np.sin(phi) * np.sin(declination)) / across
    return 12.0 - longitude / 15.0 - late * _HALF_DAY / math.pi, np.arccos(np.clip(cosine, -1.0, 1.0)) * _HALF_DAY / math.pi


def hours_of_light(uniform: FloatArray, noon: FloatArray, half: FloatArray, hours: tuple[float, float]) -> Hours:
    """Draw hours between two of the day, most of them in the arc about noon.

    Parameters
    ----------
    uniform : ndarray
        Numbers in [0, 1) [(n,)]; the first 15/16 of them fall into the arc in the order of its time.
    noon, half : ndarray
        From :func:`arc` [(n,)].
    hours : (float, float)
        First and last hour that count, UTC, ascending.

    Examples
    --------
    >>> even = (np.arange(1024) + 0.5) / 1024
    >>> found = hours_of_light(even, np.full(1024, 12.0), np.full(1024, 6.0), (0.0, 24.0))
    >>> bool(abs(np.mean(found.weight * (np.abs(found.hour - 12.0) < 3.0)) - 0.25) < 1e-3)
    True
    """
    low, high = hours
    noon = (noon - low) % 24.0 + low
    # The arc may reach into the day before or after: its pieces inside the hours, in the order of the arc.
    pieces = [(np.clip(middle - half, low, high), np.clip(middle + half, low, high)) for middle in (noon + 24.0, noon, noon - 24.0)]
    light = np.sum([end - begin for begin, end in pieces], axis=0)
    dark = np.maximum(high - low - light, 0.0)
    by_day = uniform < _BY_DAY
    left = uniform / _BY_DAY * light
    hour = np.full(uniform.size, low)
    for begin, end in pieces:
        hour = np.where((left >= 0.0) & (end > begin), begin + np.minimum(left, end - begin), hour)
        left = np.where(left >= end - begin, left - (end - begin), -1.0)
    night = low + np.clip((uniform - _BY_DAY) / (1.0 - _BY_DAY), 0.0, 1.0) * dark
    for begin, end in reversed(pieces):
        night = np.where((night >= begin) & (end > begin), night + (end - begin), night)
    weight = np.where(by_day, light / _BY_DAY, dark / (1.0 - _BY_DAY)) / (high - low)
    return Hours(np.clip(np.where(by_day, hour, night), low, np.nextafter(high, low)), weight)
