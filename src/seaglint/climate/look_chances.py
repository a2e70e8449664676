"""Chances of glint by direction and hour at one place and date, and the directions with the least: records, tables and text."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.free_form import JsonObject, TableRow

BEARINGS: Final = np.arange(0.0, 360.0, 10.0)  #: Bearings of looks, clockwise from north [deg].

#: Sentence on a day without light.
NO_LIGHT: Final = "{date}: the Sun is not up at any full hour of [likelihood] hours_utc; no glint in any direction"


@dataclass(frozen=True)
class LookChance:
    """Chance of glint in one direction at one hour."""

    threshold_w_m2_sr: float  #: Threshold [W m-2 sr-1].
    hour_utc: float  #: Hour [h UTC].
    hour_solar: float  #: Hour of the mean Sun's day [h].
    bearing_deg: float  #: Bearing of the look, clockwise from north [deg].
    depression_deg: float | None  #: Depression of the look [deg]; None where the whole range is one look.
    azimuth_from_sun_deg: float  #: Azimuth from the Sun's, clockwise [deg, -180 to 180].
    sun_elevation_deg: float  #: Elevation of the Sun [deg].
    probability: float  #: Chance that glint exceeds the threshold [1].


@dataclass(frozen=True)
class Advice(LookChance):
    """Best or worst look, with the bearings that are as good or as bad and the chance towards the Sun."""

    bearings_alike_deg: list[float]  #: First and last bearing, clockwise, of the widest range with the same chance [deg].
    probability_towards_sun: float  #: Chance at the same hour and depression at the bearing nearest to the Sun's azimuth [1].


class BearingRange(NamedTuple):
    """Range of neighbouring bearings, by index."""

    middle: int
    first: int
    number: int


@dataclass(frozen=True, eq=False)
class BestLooks:
    """Chances of glint by bearing, depression and hour at one place and date. Made by ``best_looks``."""

    date: str  #: Date in ISO 8601, UTC.
    latitude_deg: float  #: Latitude [deg].
    longitude_deg: float  #: Longitude [deg].
    case: str  #: Kind of look.
    thresholds: tuple[float, ...]  #: Thresholds [W m-2 sr-1].
    hour_utc: FloatArray  #: Full hours with the Sun up [h UTC].
    sun_elevation_deg: FloatArray  #: Elevation of the Sun at these hours [deg].
    sun_azimuth_deg: FloatArray  #: Azimuth of the Sun, clockwise from north [deg].
    depression_deg: FloatArray  #: Depressions of looks [deg]; one, NaN, where the whole range is one look.
    probability: FloatArray  #: Chances [1, (thresholds, hours, depressions, bearings)].
    samples: int  #: Draws of weather.
    notes: list[str]  #: Remarks.

    def chance(self, threshold: int, hour: int, depression: int, bearing: int) -> LookChance:
        """Return the chance of one direction by the indices of its axes."""
        utc, below = float(self.hour_utc[hour]), float(self.depression_deg[depression])
        return LookChance(
            threshold_w_m2_sr=self.thresholds[threshold],
            hour_utc=utc,
            hour_solar=(utc + self.longitude_deg / 15.0) % 24.0,
            bearing_deg=float(BEARINGS[bearing]),
            depression_deg=None if math.isnan(below) else below,
            azimuth_from_sun_deg=float(self.from_sun(hour)[bearing]),
            sun_elevation_deg=float(self.sun_elevation_deg[hour]),
            probability=float(self.probability[threshold, hour, depression, bearing]),
        )

    def best(self, threshold: int, hours: slice = slice(None)) -> Advice:
        """Return the look with the least glint above a threshold, by its index, among hours.

        Looks within one draw of the least chance count as equal; among these the look in the middle of the widest range of bearings is
        chosen, and of equal ranges that under the highest Sun, nearest to the middle of the depressions.
        """
        chance = self.probability[threshold, hours]
        first, limit = hours.start or 0, float(chance.min()) + 1.0 / self.samples
        looks = [(i + first, k) for i, k in np.argwhere(chance.min(axis=2) <= limit).tolist()]
        ranges = {(i, k): alike(self.probability[threshold, i, k] <= limit, opposite(self.from_sun(i))) for i, k in looks}
        middle = 0.5 * (self.depression_deg.size - 1)
        i, k = max(looks, key=lambda at: (ranges[at].number, self.sun_elevation_deg[at[0]], -abs(at[1] - middle)))
        return self._advice(threshold, i, k, ranges[i, k])

    def worst(self, threshold: int) -> Advice:
        """Return the look with the most glint above a threshold, by its index."""
        chance = self.probability[threshold]
        i, k, bearing = (int(x) for x in np.unravel_index(int(np.argmax(chance)), chance.shape))
        return self._advice(threshold, i, k, BearingRange(bearing, bearing, 1))

    def best_by_hour(self, threshold: int) -> list[Advice]:
        """Return the look with the least glint above a threshold of each hour."""
        return [self.best(threshold, slice(i, i + 1)) for i in range(self.hour_utc.size)]

    def rows(self) -> list[TableRow]:
        """Return a tidy table: a row for each threshold, hour, depression and bearing."""
        return [asdict(self.chance(*at)) for at in np.ndindex(self.probability.shape)]

    def as_dict(self) -> JsonObject:
        """Return plain numbers and text, ``probability`` by threshold, hour, depression and bearing; empty without the Sun."""
        each = range(len(self.thresholds)) if self.hour_utc.size else range(0)
        return {
            "date": self.date,
            "latitude_deg": self.latitude_deg,
            "longitude_deg": self.longitude_deg,
            "case": self.case,
            "samples": self.samples,
            "best": [asdict(self.best(t)) for t in each],
            "worst": [asdict(self.worst(t)) for t in each],
            "best_by_hour": [asdict(advice) for t in each for advice in self.best_by_hour(t)],
            "threshold_w_m2_sr": list(self.thresholds),
            "hour_utc": self.hour_utc.tolist(),
            "sun_elevation_deg": self.sun_elevation_deg.tolist(),
            "sun_azimuth_deg": self.sun_azimuth_deg.tolist(),
            "depression_deg": [None if math.isnan(value) else value for value in self.depression_deg.tolist()],
            "bearing_deg": BEARINGS.tolist(),
            "probability": self.probability.tolist(),
            "notes": self.notes,
        }

    def lines(self) -> list[str]:
        """Return the best and the worst look of each threshold, and the best of each hour, as lines of text."""
        if not self.hour_utc.size:
            return [NO_LIGHT.format(date=self.date)]
        out = []
        for t, threshold in enumerate(self.thresholds):
            best, worst = self.best(t), self.worst(t)
            out.append(f"glint above {threshold:g} W m-2 sr-1 on {self.date}")
            out.append(f"  least at {best.hour_utc:.0f} UTC: {described(best)}; towards the Sun {percent(best.probability_towards_sun)}")
            out.append(f"  most at {worst.hour_utc:.0f} UTC: {described(worst)}")
            out.append("  UTC  solar  Sun's elevation  towards the Sun  least glint (bearings with the same chance, clockwise)")
            for row in self.best_by_hour(t):
                start = f"  {row.hour_utc:3.0f}  {row.hour_solar:5.1f}  {row.sun_elevation_deg:11.1f} deg"
                out.append(f"{start}  {percent(row.probability_towards_sun):>15}  {described(row)}")
        return out

    def from_sun(self, hour: int) -> FloatArray:
        """Return the bearings as azimuths from the Sun's [deg, -180 to 180)."""
        return np.asarray((BEARINGS - self.sun_azimuth_deg[hour] + 180.0) % 360.0 - 180.0)

    def _advice(self, threshold: int, hour: int, depression: int, around: BearingRange) -> Advice:
        look = self.chance(threshold, hour, depression, around.middle)
        towards = int(np.argmin(np.abs(self.from_sun(hour))))
        every = around.number == BEARINGS.size
        ends = [float(BEARINGS[(around.first + step) % BEARINGS.size]) for step in (0, around.number - 1)]
        return Advice(
            **asdict(look),
            bearings_alike_deg=[0.0, 360.0] if every else ends,
            probability_towards_sun=float(self.probability[threshold, hour, depression, towards]),
        )


def alike(chosen: NDArray[np.bool_], otherwise: int) -> BearingRange:
    """Return the widest range of neighbouring true values around the circle; all of it about ``otherwise`` where all are true.

    >>> alike(np.array([True, False, False, True, False, True]), 0)
    BearingRange(middle=5, first=5, number=2)
    """
    size = chosen.size
    if chosen.all():
        return BearingRange(otherwise, (otherwise - size // 2) % size, size)
    # The circle is opened at a value that is false, so that no range is cut.
    start = int(np.argmin(chosen))
    change = np.diff(np.concatenate([[0], np.roll(chosen, -start).astype(np.int8), [0]]))
    begin, end = np.flatnonzero(change == 1), np.flatnonzero(change == -1)
    widest = int(np.argmax(end - begin))
    first, count = int(begin[widest]), int(end[widest] - begin[widest])
    return BearingRange((start + first + (count - 1) // 2) % size, (start + first) % size, count)


def opposite(from_sun: FloatArray) -> int:
    """Return the index of the azimuth farthest from the Sun."""
    return int(np.argmax(np.abs(from_sun)))


def percent(probability: float) -> str:
    """Return a chance as text.

    >>> percent(0.2345), percent(0.0002), percent(0.0)
    ('23 %', '0.02 %', '0 %')
    """
    return f"{100.0 * probability:.2g} %"


def described(look: Advice) -> str:
    """Return the direction of a look and its chance as text."""
    first, last = look.bearings_alike_deg
    below = "" if look.depression_deg is None else f" at {look.depression_deg:.3g} deg"
    same = " (all)" if last - first == 360.0 else "" if first == last else f" ({first:.0f} to {last:.0f})"
    return f"look to {look.bearing_deg:.0f} deg{same}{below}: {percent(look.probability)}"
