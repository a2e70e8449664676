"""Card of the Sun: its angles, or its course over a day at a place with a slider for the time."""

from __future__ import annotations

import asyncio
import math
from collections.abc import Callable
from dataclasses import dataclass
from datetime import UTC, date, datetime, timedelta
from typing import Any, Final

import numpy as np
from nicegui import background_tasks, ui

from seaglint.base.conventions import FloatArray
from seaglint.scenario.sun import SunPosition
from seaglint.scenario.text.display import SUN
from seaglint.viewer.workbench.scenario_draft import Draft, Keys

STEP: Final = 10  #: Time between two points of the course [min].

_WIDTH, _HEIGHT, _LEFT, _TOP = 420.0, 150.0, 34.0, 8.0


@dataclass(frozen=True, eq=False)
class Day:
    """Elevation and azimuth [deg] of the Sun every ``STEP`` minutes of a day in UTC, refraction included."""

    elevation: FloatArray
    azimuth: FloatArray

    def at(self, minutes: float) -> tuple[float, float]:
        """Return elevation and azimuth [deg] at a minute of the day."""
        times = STEP * np.arange(self.elevation.size)
        elevation = float(np.interp(minutes, times, self.elevation))
        # The azimuth is unwrapped: between 359 and 1 degrees it must not pass through 180.
        return elevation, float(np.interp(minutes, times, np.degrees(np.unwrap(np.radians(self.azimuth))))) % 360.0

    def risings(self) -> tuple[list[int], list[int]]:
        """Return the minutes of the day at which the Sun's centre rises and sets."""
        up = self.elevation > 0.0
        turns = np.flatnonzero(up[1:] != up[:-1])
        # Straight line between two points: the elevation is 0 at this share of the step.
        share = self.elevation[turns] / (self.elevation[turns] - self.elevation[turns + 1])
        minutes = np.round(STEP * (turns + share)).astype(int)
        return [int(m) for m, t in zip(minutes, turns, strict=True) if up[t + 1]], [
            int(m) for m, t in zip(minutes, turns, strict=True) if up[t]
        ]


def day_of(day: date, latitude_deg: float, longitude_deg: float) -> Day:
    """Return the Sun's course over a day, by the algorithm of ``seaglint.scenario.sun.sun_position``.

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
    # At least 20 degrees either side, so that the horizon is in the graph on polar days and nights too.
    low, high = min(-20.0, float(day.elevation.min())), max(20.0, float(day.elevation.max()))

    def place(minute: float, elevation: float) -> tuple[float, float]:
        return _LEFT + inside[0] * minute / 1440.0, _TOP + inside[1] * (high - elevation) / (high - low)

    path = "M" + "L".join(f"{x:.1f},{y:.1f}" for x, y in [place(STEP * n, float(e)) for n, e in enumerate(day.elevation)])
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


#: Initial time and place of the slider: off the coast of Virginia, in the season of the article.
_BEGIN = ("2026-06-21T17:30:00Z", 36.8, -75.9)


class Daylight:
    """Card of the Sun; ``changed`` is called with the keys that it changed, ``rebuilt`` where tables were added or removed."""

    def __init__(self, draft: Draft, changed: Callable[[Keys], None], rebuilt: Callable[[], None]) -> None:
        self._draft, self._changed, self._rebuilt = draft, changed, rebuilt
        self._sun: SunPosition | None = None
        self._day: Day | None = None
        self._known: tuple[date, float, float] | None = None
        self._box = ui.column().classes("fields")
        self._parts: tuple[Any, Any, Any] | None = None
        self._build()

    def _moment(self) -> datetime | None:
        given = self._draft.get(("time", "utc"))
        try:
            moment = given if isinstance(given, datetime) else datetime.fromisoformat(str(given).strip().replace("Z", "+00:00"))
        except ValueError:
            return None
        return moment.replace(tzinfo=UTC) if moment.tzinfo is None else moment.astimezone(UTC)

    def _build(self) -> None:
        self._box.clear()
        self._parts = None
        with self._box:
            moment = self._moment()
            if moment is None:
                ui.label("The Sun's angles are given. By time and place its course over the day is shown here.").classes("faint")
                ui.button("Sun by time and place", icon="schedule", on_click=self._by_time).props("flat dense no-caps data-do=by-time")
                return
            picture = ui.html("", sanitize=False).classes("picture")
            minutes = moment.hour * 60 + moment.minute
            slider = ui.slider(min=0, max=1435, step=5, value=minutes, on_change=lambda e: self._slid(int(e.value))).props(
                "dense data-do=day aria-label='time of the day, UTC'"
            )
            words = ui.label("").classes("faint")
            ui.button("Sun by its angles", icon="wb_sunny", on_click=self._by_angles).props("flat dense no-caps data-do=by-angles")
            self._parts = picture, slider, words

    def _by_time(self) -> None:
        self._draft.put(("sun",), None)
        for keys, value in zip((("time", "utc"), ("place", "latitude_deg"), ("place", "longitude_deg")), _BEGIN, strict=True):
            self._draft.put(keys, value)
        self._build()
        self._rebuilt()

    def _by_angles(self) -> None:
        for key in ("time", "place"):
            self._draft.put((key,), None)
        if self._sun is not None:
            zenith, azimuth = (round(math.degrees(angle), 2) for angle in (self._sun.zenith, self._sun.azimuth))
            self._draft.put(("sun",), {"zenith_deg": zenith, "azimuth_deg": azimuth})
        self._build()
        self._rebuilt()

    def _slid(self, minutes: int) -> None:
        moment = self._moment()
        if moment is None or moment.hour * 60 + moment.minute == minutes:
            return
        self._draft.put(("time", "utc"), f"{moment:%Y-%m-%d}T{clock(minutes)}:00Z")
        self._draw(minutes)
        self._changed(("time", "utc"))

    def show(self, sun: SunPosition | None) -> None:
        """Show the Sun of a valid scenario."""
        self._sun = sun
        moment = self._moment()
        if (moment is not None) != (self._parts is not None):
            self._build()
        if moment is None or self._parts is None:
            return
        self._parts[1].set_value(moment.hour * 60 + moment.minute // 5 * 5)
        background_tasks.create(self._follow(moment))

    async def _follow(self, moment: datetime) -> None:
        """Compute the day again if date or place have changed, and draw it."""
        from seaglint.scenario.records.small_tables import Place

        place = Place.model_validate(self._draft.get(("place",)))
        requested = (moment.date(), place.latitude_deg, place.longitude_deg)
        if requested != self._known:
            self._day = await asyncio.to_thread(day_of, *requested)
            self._known = requested
        self._draw(moment.hour * 60 + moment.minute)

    def _draw(self, minutes: int) -> None:
        if self._day is None or self._parts is None or self._parts[0].is_deleted:
            return
        picture, _, words = self._parts
        elevation, azimuth = self._day.at(minutes)
        risings = [f"rises {clock(rise)}" for rise in self._day.risings()[0]] + [f"sets {clock(fall)}" for fall in self._day.risings()[1]]
        picture.content = day_svg(self._day, minutes)
        words.set_text("; ".join([f"{clock(minutes)} UTC: elevation {elevation:.1f}°, azimuth {azimuth:.1f}°", *risings]))
