"""Card of the Sun: its angles, or its course over a day at a place with a slider."""

from __future__ import annotations

import asyncio
import math
from collections.abc import Callable
from datetime import UTC, date, datetime
from typing import Any

from nicegui import background_tasks, ui

from seaglint.scenario.sun import SunPosition
from seaglint.viewer.workbench.day import Day, clock, day_of, day_svg
from seaglint.viewer.workbench.draft import Draft
from seaglint.viewer.workbench.fields import Path as Keys

#: Place and time at which the slider begins: off the coast of Virginia, in the season of the article.
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
        """Compute the day again where it is another one."""
        from seaglint.scenario.records.place import Place

        place = Place.model_validate(self._draft.get(("place",)))
        wanted = (moment.date(), place.latitude_deg, place.longitude_deg)
        if wanted != self._known:
            self._day = await asyncio.to_thread(day_of, *wanted)
            self._known = wanted
        self._draw(moment.hour * 60 + moment.minute)

    def _draw(self, minutes: int) -> None:
        if self._day is None or self._parts is None or self._parts[0].is_deleted:
            return
        picture, _, words = self._parts
        elevation, azimuth = self._day.at(minutes)
        risings = [f"rises {clock(rise)}" for rise in self._day.risings()[0]] + [f"sets {clock(fall)}" for fall in self._day.risings()[1]]
        picture.content = day_svg(self._day, minutes)
        words.set_text("; ".join([f"{clock(minutes)} UTC: elevation {elevation:.1f}°, azimuth {azimuth:.1f}°", *risings]))
