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
from seaglint.scenario.dated_sun import dated_sun
from seaglint.scenario.model import Scenario
from seaglint.scenario.records.small_tables import Place, Time
from seaglint.scenario.sun import sun_position
from seaglint.scenario.text.display import SUN
from seaglint.viewer.workbench.scenario_draft import Draft, Keys

STEP: Final = 10  #: Time between two points of the drawn course [min].

_WIDTH, _HEIGHT, _LEFT, _TOP = 300.0, 140.0, 34.0, 8.0


@dataclass(frozen=True, eq=False)
class Day:
    """Elevation and azimuth [deg] of the Sun every minute of a day in UTC, refraction included."""

    elevation: FloatArray
    azimuth: FloatArray

    def at(self, minutes: float) -> tuple[float, float]:
        """Return elevation and azimuth [deg] at a minute of the day."""
        before = min(max(int(minutes), 0), self.elevation.size - 2)
        pair = slice(before, before + 2)
        up, around = np.radians(self.elevation[pair]), np.radians(self.azimuth[pair])
        # A straight line between directions, not between angles: near the zenith the azimuth turns by 180 degrees in minutes.
        ends = np.array([np.cos(up) * np.cos(around), np.cos(up) * np.sin(around), np.sin(up)])
        north, east, above = ends @ (1.0 - (minutes - before), minutes - before)
        return math.degrees(math.atan2(above, math.hypot(north, east))), math.degrees(math.atan2(east, north)) % 360.0

    def words(self, minutes: float) -> str:
        """Return time and position of the Sun at a minute of the day as text."""
        elevation, azimuth = self.at(minutes)
        return f"{clock(minutes)} UTC: elevation {round(elevation, 1) + 0.0:.1f}°, azimuth {azimuth:.1f}°".replace("-", "\u2212")

    def risings(self) -> tuple[list[int], list[int]]:
        """Return the minutes of the day at which the Sun's centre rises and sets."""
        up = self.elevation > 0.0
        turns = np.flatnonzero(up[1:] != up[:-1])
        # Straight line between two points: the elevation is 0 at this share of the minute.
        share = self.elevation[turns] / (self.elevation[turns] - self.elevation[turns + 1])
        minutes = np.round(turns + share).astype(int)
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
    times = pd.DatetimeIndex([start + timedelta(minutes=n) for n in range(24 * 60 + 1)])
    angles = solarposition.get_solarposition(times, latitude_deg, longitude_deg, method="nrel_numpy")
    return Day(90.0 - angles["apparent_zenith"].to_numpy(), angles["azimuth"].to_numpy())


def clock(minutes: float) -> str:
    """Return hours and minutes of the day as text, and seconds where they are not 0.

    >>> clock(1050), clock(1050.5)
    ('17:30', '17:30:30')
    """
    seconds = round(60.0 * minutes)
    return f"{seconds // 3600 % 24:02d}:{seconds // 60 % 60:02d}" + (f":{seconds % 60:02d}" if seconds % 60 else "")


def day_svg(day: Day, minutes: float) -> str:
    """Return a graph of the elevation over the day with the Sun's position, as SVG."""
    inside = _WIDTH - _LEFT - 12, _HEIGHT - _TOP - 34
    # At least 20 degrees either side, so that the horizon is in the graph on polar days and nights too.
    low, high = min(-20.0, float(day.elevation.min())), max(20.0, float(day.elevation.max()))

    def place(minute: float, elevation: float) -> tuple[float, float]:
        return _LEFT + inside[0] * minute / 1440.0, _TOP + inside[1] * (high - elevation) / (high - low)

    path = "M" + "L".join(f"{x:.1f},{y:.1f}" for x, y in [place(STEP * n, float(e)) for n, e in enumerate(day.elevation[::STEP])])
    elevation, _ = day.at(minutes)
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
        f"<title>{day.words(minutes)}</title></circle></svg>"
    )


def dated(scenario: Scenario) -> tuple[Scenario, str]:
    """Return a scenario whose Sun comes from a date and a place (``dated_sun``), and a line on what differs."""
    given = sun_position(scenario)
    moment, latitude, longitude = dated_sun(given.zenith, given.azimuth)
    place = Place(latitude_deg=latitude, longitude_deg=longitude)
    changed = scenario.model_copy(update={"sun": None, "time": Time(utc=moment), "place": place})
    found = sun_position(changed)
    # The haversine formula has no cancellation at small angles.
    half = math.sin(0.5 * (found.zenith - given.zenith)) ** 2
    half += math.sin(given.zenith) * math.sin(found.zenith) * math.sin(0.5 * (found.azimuth - given.azimuth)) ** 2
    angle = math.degrees(2.0 * math.asin(math.sqrt(half)))
    light = 100.0 * (found.irradiance_factor / given.irradiance_factor - 1.0)
    return changed, (
        f"The Sun differs by {angle:.3f}° from the given angles; by its distance of {found.distance_au:.3f} au on this date "
        f"its irradiance is {abs(light):.1f} % {'higher' if light > 0 else 'lower'}."
    )


class Daylight:
    """Card of the Sun; ``changed`` is called with the keys that it changed, ``rebuilt`` where tables were added or removed."""

    def __init__(self, draft: Draft, changed: Callable[[Keys], None], rebuilt: Callable[[], None]) -> None:
        self._draft, self._changed, self._rebuilt = draft, changed, rebuilt
        self._difference = ""
        self._found = draft.snapshot()
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
                words = (
                    "The Sun's angles are given. A date and a place with this Sun can be found; its course over the day is then shown here."
                )
                ui.label(words).classes("faint")
                ui.button("Sun by time and place", icon="schedule", on_click=self._by_time).props("flat dense no-caps data-do=by-time")
                return
            picture = ui.html("", sanitize=False).classes("picture")
            minutes = moment.hour * 60 + moment.minute
            slider = ui.slider(min=0, max=1439, step=1, value=minutes, on_change=lambda e: self._slid(int(e.value))).props(
                "dense data-do=day aria-label='time of the day, UTC'"
            )
            course = ui.label("").classes("faint").props("data-words=day")
            if self._difference:
                ui.label(self._difference).classes("faint").props("data-words=difference")
            ui.button("Sun by its angles", icon="wb_sunny", on_click=self._by_angles).props("flat dense no-caps data-do=by-angles")
            self._parts = picture, slider, course

    async def _valid(self) -> Scenario | None:
        """Return the scenario of the draft; where it is not valid, say so and return None."""
        scenario, _ = await asyncio.to_thread(self._draft.snapshot().check)
        if scenario is None or (scenario.sun is None and scenario.time is None):
            ui.notify("the Sun of this scenario is not known: correct the scenario first, and give one Sun", type="negative")
            return None
        return scenario

    async def _by_time(self) -> None:
        scenario = await self._valid()
        if scenario is None:
            return
        changed, self._difference = await asyncio.to_thread(dated, scenario)
        assert changed.time is not None
        assert changed.place is not None
        self._draft.put(("sun",), None)
        self._draft.put(("time",), {"utc": f"{changed.time.utc:%Y-%m-%dT%H:%M:%SZ}"})
        self._draft.put(("place",), changed.place.model_dump())
        self._found = self._draft.snapshot()
        self._build()
        self._rebuilt()

    async def _by_angles(self) -> None:
        scenario = await self._valid()
        if scenario is None:
            return
        sun = await asyncio.to_thread(sun_position, scenario)
        for key in ("time", "place"):
            self._draft.put((key,), None)
        zenith, azimuth = (round(math.degrees(angle), 2) for angle in (sun.zenith, sun.azimuth))
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

    def show(self) -> None:
        """Show the Sun's day of a valid scenario."""
        moment = self._moment()
        # The line on the difference is true for the time and place that were found, not for later ones.
        old = bool(self._difference) and any(self._draft.get((key,)) != self._found.get((key,)) for key in ("time", "place"))
        if old:
            self._difference = ""
        if old or (moment is not None) != (self._parts is not None):
            self._build()
        if moment is None or self._parts is None:
            return
        self._parts[1].set_value(moment.hour * 60 + moment.minute)
        background_tasks.create(self._follow(moment))

    async def _follow(self, moment: datetime) -> None:
        """Compute the day again if date or place have changed, and draw it."""
        place = Place.model_validate(self._draft.get(("place",)))
        requested = (moment.date(), place.latitude_deg, place.longitude_deg)
        if requested != self._known:
            self._day = await asyncio.to_thread(day_of, *requested)
            self._known = requested
        self._draw(moment.hour * 60 + moment.minute + moment.second / 60.0)

    def _draw(self, minutes: float) -> None:
        if self._day is None or self._parts is None or self._parts[0].is_deleted:
            return
        picture, _, words = self._parts
        risings = [f"rises {clock(rise)}" for rise in self._day.risings()[0]] + [f"sets {clock(fall)}" for fall in self._day.risings()[1]]
        picture.content = day_svg(self._day, minutes)
        words.set_text("; ".join([self._day.words(minutes), *risings]))
