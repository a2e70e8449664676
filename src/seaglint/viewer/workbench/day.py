"""Course of the Sun over a day at a place, and its position at a time of day."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import UTC, date, datetime, timedelta
from typing import Final

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.scenario.text.compass import SUN

STEP: Final = 10  #: Time between two points of the course [min].

_WIDTH, _HEIGHT, _LEFT, _TOP = 420.0, 150.0, 34.0, 8.0


@dataclass(frozen=True, eq=False)
class Day:
    """Elevation and azimuth [deg] of the Sun every :data:`STEP` minutes of a day in UTC, refraction included."""

    elevation: FloatArray
    azimuth: FloatArray

    def at(self, minutes: float) -> tuple[float, float]:
        """Return elevation and azimuth [deg] at a minute of the day."""
        times = STEP * np.arange(self.elevation.size)
        elevation = float(np.interp(minutes, times, self.elevation))
        return elevation, float(np.interp(minutes, times, np.degrees(np.unwrap(np.radians(self.azimuth))))) % 360.0

    def risings(self) -> tuple[list[int], list[int]]:
        """Return the minutes of the day at which the Sun's centre rises and sets."""
        up = self.elevation > 0.0
        turns = np.flatnonzero(up[1:] != up[:-1])
        share = self.elevation[turns] / (self.elevation[turns] - self.elevation[turns + 1])
        minutes = np.round(STEP * (turns + share)).astype(int)
        return [int(m) for m, t in zip(minutes, turns, strict=True) if up[t + 1]], [
            int(m) for m, t in zip(minutes, turns, strict=True) if up[t]
        ]


def day_of(day: date, latitude_deg: float, longitude_deg: float) -> Day:
    """Return the Sun's course; the same algorithm as :func:`seaglint.scenario.sun.sun_position`.

    Examples
    --------
    >>> noon = day_of(date(2026, 6, 21), 40.0, 0.0).at(12 * 60)
    >>> round(noon[0]), round(noon[1])
    (73, 179)
    """
    import pandas as pd
    from pvlib import solarposition

    start = datetime(day.year, day.month, day.day, tzinfo=UTC)
    times = pd.DatetimeIndex([start + timedelta(minutes=STEP * n) for n in range(24 * 60 // STEP + 1)])
    angles = solarposition.get_solarposition(times, latitude_deg, longitude_deg, method="nrel_numpy")
    return Day(90.0 - angles["apparent_zenith"].to_numpy(), angles["azimuth"].to_numpy())


def clock(minutes: float) -> str:
    """Return hours and minutes of the day as text.

    >>> clock(1050)
    '17:30'
    """
    return f"{int(minutes) // 60 % 24:02d}:{int(minutes) % 60:02d}"


def day_svg(day: Day, minutes: float) -> str:
    """Return a graph of the elevation over the day with the Sun's position, as SVG."""
    inside = _WIDTH - _LEFT - 12, _HEIGHT - _TOP - 34
    low, high = min(-20.0, float(day.elevation.min())), max(20.0, float(day.elevation.max()))

    def place(minute: float, elevation: float) -> tuple[float, float]:
        return _LEFT + inside[0] * minute / 1440.0, _TOP + inside[1] * (high - elevation) / (high - low)

    points = [place(STEP * n, float(e)) for n, e in enumerate(day.elevation)]
    path = "M" + "L".join(f"{x:.1f},{y:.1f}" for x, y in points)
    elevation, azimuth = day.at(minutes)
    (x, y), (_, ground) = place(minutes, elevation), place(0, 0.0)
    hours = "".join(
        f'<text x="{place(60 * h, 0)[0]:.1f}" y="{_TOP + inside[1] + 16:.1f}" text-anchor="middle">{h:02d}</text>' for h in range(0, 25, 3)
    )
    angles = "".join(
        f'<text x="{_LEFT - 6:g}" y="{place(0, e)[1]:.1f}" text-anchor="end" dominant-baseline="central">{e}</text>'.replace(
            ">-", ">\u2212"
        )
        for e in range(-60, 91, 30)
        if low <= e <= high
    )
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_WIDTH:g} {_HEIGHT:g}" width="100%" role="img" '
        f'aria-label="the Sun over the day" '
        f'font-family="system-ui, sans-serif" font-size="11" fill="currentColor">'
        f'<rect x="{_LEFT:g}" y="{ground:.1f}" width="{inside[0]:g}" height="{_TOP + inside[1] - ground:.1f}" fill="currentColor" '
        f'fill-opacity=".08"/><path d="M{_LEFT:g},{ground:.1f}h{inside[0]:g}" stroke="currentColor" stroke-opacity=".5"/>'
        f'<path d="{path}" fill="none" stroke="{SUN}" stroke-width="1.8"/>{hours}{angles}'
        f'<text x="{_LEFT + inside[0] / 2:g}" y="{_HEIGHT - 4:g}" text-anchor="middle">hour [UTC]; elevation of the Sun [deg]</text>'
        f'<circle cx="{x:.1f}" cy="{y:.1f}" r="6" fill="{SUN}">'
        f"<title>{clock(minutes)}: {elevation:.1f}°, azimuth {azimuth:.1f}°</title></circle></svg>"
    )
