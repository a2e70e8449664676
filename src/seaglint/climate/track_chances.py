"""Chances of glint along a ship's track: by time, with a climatology and a forecast, and as hours, durations and returns."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.free_form import JsonObject, TableRow

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True)
class TrackChance:
    """Chance of glint at one time of a track."""

    time_utc: str  #: Time in ISO 8601.
    latitude_deg: float  #: Latitude [deg].
    longitude_deg: float  #: Longitude [deg].
    sun_elevation_deg: float  #: Elevation of the Sun [deg].
    threshold_w_m2_sr: float  #: Threshold [W m-2 sr-1].
    probability: float  #: Chance that glint exceeds it [1].


@dataclass(frozen=True)
class ForecastChance(TrackChance):
    """Chance of glint at one time of a track, by the climatology and by a forecast."""

    forecast_probability: float  #: Chance that glint exceeds the threshold in the weather of the forecast [1].
    wind_speed_m_s: float  #: Wind speed of the forecast, mean of its members [m/s].
    wind_from_deg: float | None  #: Direction from which the mean wind of the forecast comes [deg]; None in a calm.
    cloud_cover: float  #: Cloud cover of the forecast, mean of its members [1].


class Spells(NamedTuple):
    """Mean duration of glint and mean time from its end to its return [h]; None without glint, or without a return."""

    mean_duration_hours: float | None
    mean_return_hours: float | None


@dataclass(frozen=True)
class GlintHours:
    """Hours with glint along a track."""

    threshold_w_m2_sr: float  #: Threshold [W m-2 sr-1].
    hours: float  #: Expected time with glint above it [h].
    mean_duration_hours: float | None  #: Mean duration of glint [h]; None without glint.
    mean_return_hours: float | None  #: Mean time from the end of glint to its return [h]; None without a return.


@dataclass(frozen=True)
class ForecastHours(GlintHours):
    """Hours with glint along a track, by the climatology and by a forecast."""

    forecast_hours: float  #: Expected time with glint above the threshold in the weather of the forecast [h].
    forecast_mean_duration_hours: float | None  #: Mean duration of glint in it [h]; None without glint.
    forecast_mean_return_hours: float | None  #: Mean time from the end of glint in it to its return [h]; None without a return.


@dataclass(frozen=True)
class TrackChances:
    """Chances of glint along a ship's track."""

    hours: float  #: Length of the track [h].
    results: list[GlintHours]  #: Hours with glint of each threshold.
    way: list[TrackChance]  #: Chances by time and threshold.
    notes: list[str]  #: Remarks.

    def rows(self) -> list[TableRow]:
        """Return the track as a tidy table: a row for each time and threshold."""
        return [asdict(chance) for chance in self.way]

    def as_dict(self) -> JsonObject:
        """Return plain numbers and text."""
        return asdict(self)

    @property
    def thresholds(self) -> list[float]:
        """Return the thresholds [W m-2 sr-1]."""
        return [row.threshold_w_m2_sr for row in self.results]

    @property
    def has_forecast(self) -> bool:
        """Return true where a forecast is beside the climatology."""
        return isinstance(self.way[0], ForecastChance)

    @property
    def time(self) -> NDArray[np.datetime64]:
        """Return the times of the track, UTC [(times,)]."""
        return np.array([chance.time_utc.removesuffix("Z") for chance in self._of(self.thresholds[0])], "datetime64[ns]")

    def over_time(self, name: str) -> FloatArray:
        """Return a number of the weather, the Sun or the place over the times [(times,)]; NaN where there is none."""
        return np.array([getattr(chance, name) for chance in self._of(self.thresholds[0])], dtype=np.float64)

    def chances(self, name: str = "probability") -> FloatArray:
        """Return ``probability`` or ``forecast_probability`` over thresholds and times [(thresholds, times)]."""
        return np.array([[getattr(chance, name) for chance in self._of(threshold)] for threshold in self.thresholds])

    def _of(self, threshold: float) -> list[TrackChance]:
        return [chance for chance in self.way if chance.threshold_w_m2_sr == threshold]

    def dataset(self) -> xr.Dataset:
        """Return the track as a dataset: chances over ``threshold`` and ``time``, places, and hours with glint by threshold."""
        import xarray as xr

        chances = {name: text for name, text in _CHANCES.items() if name == "probability" or self.has_forecast}
        along = {name: unit for name, unit in _ALONG.items() if hasattr(self.way[0], name)}
        spans = [name for name in _SPANS if hasattr(self.results[0], name)]
        return xr.Dataset(
            {
                **{name: (("threshold", "time"), self.chances(name), {"units": "1", "long_name": text}) for name, text in chances.items()},
                **{name: ("time", self.over_time(name), {"units": unit}) for name, unit in along.items()},
                **{name: ("threshold", [_number(getattr(row, name)) for row in self.results], {"units": "h"}) for name in spans},
            },
            {"threshold": ("threshold", self.thresholds, {"units": "W m-2 sr-1"}), "time": ("time", self.time)},
            {"title": "Chance of glint along a way", "hours": self.hours, "notes": "\n".join(self.notes)},
        )


def _number(value: float | None) -> float:
    return math.nan if value is None else value


_CHANCES: Final = {
    "probability": "chance that glint exceeds the threshold",
    "forecast_probability": "chance that glint exceeds the threshold in the weather of the forecast",
}
_ALONG: Final = {
    **dict.fromkeys(("latitude_deg", "longitude_deg", "sun_elevation_deg"), "degree"),
    "wind_speed_m_s": "m s-1",
    "wind_from_deg": "degree",
    "cloud_cover": "1",
}
_SPANS: Final = tuple(before + name for before in ("", "forecast_") for name in ("hours", "mean_duration_hours", "mean_return_hours"))


def spells(glints: np.ndarray, hours: FloatArray) -> Spells:
    """Return the mean duration of glint and the mean time from its end to its return [h], over followed draws [(draws, times)].

    Both are None without glint. Spells cut by an end of the track count with their observed part; only gaps between two spells are returns.

    >>> spells(np.array([[True, False, False, True]]), np.ones(4))
    Spells(mean_duration_hours=1.0, mean_return_hours=2.0)
    """
    # Without glint before and after the track, every spell has a begin and an end.
    change = np.diff(np.pad(glints, ((0, 0), (1, 1))).astype(np.int8), axis=1)
    draws, begin = np.nonzero(change == 1)
    end = np.nonzero(change == -1)[1]
    if begin.size == 0:
        return Spells(None, None)
    clock = np.concatenate([[0.0], np.cumsum(hours)])
    # A gap between spells of two draws is no return.
    again = draws[1:] == draws[:-1]
    gaps = clock[begin[1:]] - clock[end[:-1]]
    return Spells(float(np.mean(clock[end] - clock[begin])), float(np.mean(gaps[again])) if again.any() else None)
