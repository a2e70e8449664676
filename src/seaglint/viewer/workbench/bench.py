"""Page of the workbench: pictures of a scenario, and beside them the form that changes it, in the style of the viewer's pages.

Pictures are drawn again shortly after the last change; a newer change replaces a picture in progress.
"""

from __future__ import annotations

import asyncio
import math
from collections.abc import Callable, Coroutine
from functools import cache
from html import escape
from pathlib import Path
from typing import Any, Final

from nicegui import app, background_tasks, ui

from seaglint.base.errors import Mistake, ScenarioError, SeaglintError
from seaglint.base.free_form import TomlTables
from seaglint.scenario.model import Scenario
from seaglint.scenario.presets import PRESETS
from seaglint.scenario.text.display import compass
from seaglint.viewer.workbench.scenario_draft import Draft, Keys, mistakes_of
from seaglint.viewer.workbench.scenario_form import Form
from seaglint.viewer.workbench.small_pictures import Job, Order, Overtaken, Painter, PreviewPicture
from seaglint.viewer.workbench.sun_card import Daylight
from seaglint.viewer.workbench.svg_pictures import PlanView, Quantity, distance, map_svg, plan, plan_svg, value_at

#: Style sheets of the page, and the script of its theme.
_HEAD: Final = (
    '<link rel="stylesheet" href="/static/theme.css"><link rel="stylesheet" href="/static/workbench.css">'
    '<script src="/static/theme.js"></script>'
)

_THEMES: Final = (
    '<label>theme <select data-theme-choice><option value="">system</option><option value="light">light</option>'
    '<option value="dark">dark</option></select></label>'
)

_POINT: Final = "point at the picture, or tap it, to read values"

#: Sends the place of the pointer in shares of the picture's width and height.
_PLACE: Final = """(event) => {
  const box = event.currentTarget.querySelector("svg")?.getBoundingClientRect();
  if (box) emit((event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height);
}"""

JOBS: Final[tuple[Job, ...]] = ("mean", "frame")

#: Callback with the name of a picture and the picture, the text of an error, or None when drawing begins.
Show = Callable[[Job, "PreviewPicture | str | None"], None]


class Redraw:
    """Requests for the pictures of one page; a newer request replaces older ones.

    Parameters
    ----------
    painter : Painter
        Process that draws; all pages share it.
    show : callable
        Called with the name of a picture and its result, see ``Show``.
    start : callable
        Starts a coroutine in the background.
    """

    def __init__(self, painter: Painter, show: Show, start: Callable[[Coroutine[Any, Any, None]], object]) -> None:
        self._painter, self._show, self._start = painter, show, start
        self._requested: Scenario | None = None
        self._order: Order | None = None
        self._works = self._closed = False

    def want(self, scenario: Scenario) -> None:
        """Request the pictures of a scenario, in place of earlier requests."""
        if self._closed:
            return
        self.drop()
        self._requested = scenario
        if not self._works:
            self._works = True
            self._start(self._work())

    def drop(self) -> None:
        """Cancel all requests."""
        self._requested = None
        if self._order is not None:
            self._order.drop()

    def close(self) -> None:
        """Stop, since the page is closed."""
        self._closed = True
        self.drop()

    async def _work(self) -> None:
        try:
            while self._requested is not None:
                scenario, self._requested = self._requested, None
                # A newer request ends the round: the next pictures would be of the old scenario.
                for job in JOBS:
                    if not await self._draw(job, scenario):
                        break
        finally:
            self._works = False

    async def _draw(self, job: Job, scenario: Scenario) -> bool:
        """Draw one picture; return False where a newer request replaced it."""
        self._order = order = Order(job, scenario)
        self._show(job, None)
        try:
            result: PreviewPicture | str = await asyncio.get_running_loop().run_in_executor(self._painter.line, self._painter.paint, order)
        except Overtaken:
            return False
        except SeaglintError as error:
            result = str(error)
        # A picture that was finished in spite of a newer request is not shown.
        if order.dropped.is_set():
            return False
        self._show(job, result)
        return True


DEBOUNCE: Final = 0.2  #: Time without a change after which the scenario is read [s].

_TITLES: Final[dict[Job, str]] = {"mean": "Mean map", "frame": "First frame"}


@cache
def painter() -> Painter:
    """Return the process that computes the pictures of all pages."""
    process = Painter()
    app.on_shutdown(process.stop)
    return process


def fill(path: str | Path | None = None) -> None:
    """Fill the current page with the workbench of a scenario file, or of a preset that is chosen on it."""
    ui.add_head_html(_HEAD)
    ui.colors(primary="var(--mark)", dark="var(--panel)", dark_page="var(--ground)", on_mark="var(--on-mark)")
    ui.query("body").classes("bench")
    with ui.row().classes("top"):
        ui.label("seaglint").classes("mark")
        head = ui.row().classes("grow choices")
        # Outside of what a preset rebuilds: the script has set it to the theme that was chosen.
        ui.html(_THEMES, sanitize=False)
    with ui.column().classes("whole") as whole:
        _begin(head, whole, path)


def _begin(head: ui.row, whole: ui.column, path: str | Path | None, preset: str = "glint") -> None:
    head.clear()
    whole.clear()
    try:
        draft = Draft(path, preset)
    except SeaglintError as error:
        with whole:
            ui.label(str(error)).classes("wrong banner")
        return
    bench = Bench(draft)
    with head:
        ui.label(draft.name if path is not None else "Scenario workbench").classes("faint grow")
        if path is None:
            words = {name: f"{name}: {chosen.title}" for name, chosen in PRESETS.items()}

            def choose(name: str) -> None:
                bench.close()
                _begin(head, whole, None, name)

            ui.select(words, label="begin with a preset", value=preset, on_change=lambda e: choose(str(e.value))).props(
                "dense outlined options-dense data-key=preset"
            ).classes("presets")
        bench.status = ui.label("").classes("faint status").props("data-status")
    with whole:
        bench.build()
    ui.context.client.on_delete(bench.close)


class Bench:
    """Draft and pictures of one page."""

    status: ui.label

    def __init__(self, draft: Draft) -> None:
        self._draft = draft
        self._dirty = self._reads = self._closed = False
        self._scenario: Scenario | None = None
        self._text = ""
        self._plan: PlanView | None = None
        self._pictures: dict[Job, PreviewPicture] = {}
        self._quantity: Quantity = "radiance"
        self._whole = False
        self._redraw = Redraw(painter(), self._show, background_tasks.create)
        painter().warm()

    def build(self) -> None:
        """Build the page in the current slot."""
        with ui.element("div").classes("columns"):
            with ui.column().classes("drawn"):
                self._problems = ui.column().classes("problems alert").props("data-problems")
                self._problems.set_visibility(False)
                with ui.row().classes("pictures"):
                    self._maps = {job: self._map(job) for job in _TITLES}
                with ui.row().classes("pictures"):
                    self._around()
                self._writing()
            # Last, so that the Tab key reaches the pictures first where they are above the form.
            self._fields = ui.column().classes("form")
        self._refill()
        self.changed()

    def _refill(self) -> None:
        """Build the form again, since tables were added or removed."""
        self._fields.clear()
        with self._fields:
            self._form = Form(self._draft, self.changed)
            self._form.build()

    def _map(self, job: Job) -> tuple[ui.html, ui.label]:
        with ui.column().classes("card two"):
            with ui.row().classes("head title"):
                ui.label(_TITLES[job]).classes("name grow")
                if job == "mean":
                    ui.toggle(
                        {"radiance": "radiance", "apparent_temperature": "apparent temperature"},
                        value="radiance",
                        on_change=lambda e: self._of(e.value),
                    ).props("dense no-caps unelevated size=sm toggle-text-color=on-mark data-do=quantity")
            picture = ui.html("", sanitize=False).classes("picture").props(f'data-picture="{job}"')
            words = ui.label("").classes("faint").props(f'data-words="{job}"')
            value = ui.label(_POINT).classes("faint").props(f'data-value="{job}" aria-live=polite')
            for event in ("pointermove", "pointerdown"):
                picture.on(event, lambda e: value.set_text(self._value(job, *e.args)), throttle=0.1, js_handler=_PLACE)
            return picture, words

    def _value(self, job: Job, across: float, down: float) -> str:
        """Return the values at a place of a picture, given in shares of its width and height."""
        return (job in self._pictures and value_at(self._pictures[job], self._quantity, across, down)) or _POINT

    def _around(self) -> None:
        with ui.column().classes("card third"):
            ui.label("Wind, Sun and view").classes("name")
            self._compass = ui.html("", sanitize=False).classes("picture middle").props("data-picture=compass")
            self._facts = ui.label("").classes("faint lines").props("data-words=facts")
        with ui.column().classes("card third"):
            with ui.row().classes("head"):
                ui.label("Plan").classes("name grow")
                ui.switch("show up to the horizon", on_change=lambda e: self._far(bool(e.value))).props("dense")
            self._map_above = ui.html("", sanitize=False).classes("picture").props("data-picture=plan")
        with ui.column().classes("card third"):
            ui.label("The Sun's day").classes("name")
            self._daylight = Daylight(self._draft, self._moved, self._sun_changed)

    def _writing(self) -> None:
        with ui.column().classes("card"):
            with ui.row().classes("head"):
                ui.label(self._draft.name).classes("name grow")
                ui.button("copy", icon="content_copy", on_click=lambda: ui.clipboard.write(self._text)).props("flat dense no-caps")
                ui.button("download", icon="download", on_click=lambda: ui.download.content(self._text, self._draft.name)).props(
                    "flat dense no-caps data-do=download"
                )
                if self._draft.source is not None:
                    ui.button("save", icon="save", on_click=self._ask).props("flat dense no-caps data-do=save")
            self._toml = ui.html("", sanitize=False).classes("text").props("data-toml")
            for command in self._draft.commands():
                with ui.row().classes("head command"):
                    ui.label(command).classes("code grow")
                    ui.button(icon="content_copy", on_click=lambda text=command: ui.clipboard.write(text)).props(
                        "flat dense size=sm aria-label='copy the command'"
                    )

    def changed(self) -> None:
        """React to a change: the scenario is read ``DEBOUNCE`` seconds after the last one."""
        self._dirty = True
        if not self._reads and not self._closed:
            self._reads = True
            background_tasks.create(self._read())

    def _moved(self, keys: Keys) -> None:
        self._form.sync(keys)
        self.changed()

    def _sun_changed(self) -> None:
        self._refill()
        self.changed()

    def _gone(self) -> bool:
        return self._closed

    def close(self) -> None:
        """Stop drawing, since the browser has closed the page."""
        self._closed = True
        self._redraw.close()

    async def _read(self) -> None:
        try:
            while self._dirty and not self._closed:
                self._dirty = False
                # Every change during the sleep sets the flag again and restarts the wait.
                await asyncio.sleep(DEBOUNCE)
                if not self._dirty:
                    await self._follow(self._draft.snapshot())
        finally:
            self._reads = False

    async def _follow(self, draft: Draft) -> None:
        """Check the draft, and draw it if it is valid."""
        # In a thread: checking reads files and builds models, while the page has to answer.
        scenario, mistakes = await asyncio.to_thread(draft.check)
        if self._closed:
            return
        self._scenario = scenario
        self._show_mistakes(mistakes, draft.raw)
        if scenario is None:
            self._redraw.drop()
            return
        self._redraw.want(scenario)
        self._text = await asyncio.to_thread(draft.toml, scenario)
        self._toml.content = f"<pre>{escape(self._text)}</pre>"
        try:
            view = await asyncio.to_thread(plan, scenario)
        except SeaglintError as error:
            # A scenario that is not valid after all is not drawn; other errors concern the plan alone.
            if isinstance(error, ScenarioError):
                self._redraw.drop()
            self._show_mistakes(mistakes_of(error), draft.raw)
            return
        if not self._gone():
            self._lay_out(scenario, view)

    def _lay_out(self, scenario: Scenario, view: PlanView) -> None:
        self._plan = view
        self._compass.content = compass(scenario, view.sun, view.azimuth)
        zenith, azimuth = math.degrees(view.sun.zenith), math.degrees(view.sun.azimuth) % 360
        facts = [
            f"wind {scenario.wind.speed_m_s:.1f} m/s from {scenario.wind.from_deg % 360:.1f}°",
            f"Sun: elevation {90 - zenith:.1f}°, azimuth {azimuth:.1f}°".replace("-", "\u2212"),
            f"view: azimuth {view.azimuth % 360:.1f}°, elevation {scenario.sensor.elevation_deg:.1f}°".replace("-", "\u2212"),
            f"horizon at {distance(view.horizon)}",
        ]
        self._facts.set_text("\n".join(facts))
        self._map_above.content = plan_svg(view, whole=self._whole)
        self._daylight.show()

    def _far(self, whole: bool) -> None:
        self._whole = whole
        if self._plan is not None:
            self._map_above.content = plan_svg(self._plan, whole=whole)

    def _of(self, quantity: Quantity) -> None:
        self._quantity = quantity
        for job, picture in self._pictures.items():
            self._maps[job][0].content = map_svg(picture, quantity, _TITLES[job])

    def _show(self, job: Job, result: PreviewPicture | str | None) -> None:
        if self._closed:
            return
        picture, words = self._maps[job]
        if result is None:
            words.set_text("drawing ...")
        elif isinstance(result, str):
            words.set_text(result)
            words.classes(add="wrong")
            picture.classes(add="old")
        else:
            self._pictures[job] = result
            columns, rows = result.radiance.shape[::-1]
            size = f"{columns} x {rows} pixels for {result.pixels[0]} x {result.pixels[1]} of the scenario"
            words.set_text(f"{size}, computed in {result.seconds:.1f}\u00a0s")
            words.classes(remove="wrong")
            picture.classes(remove="old")
            picture.content = map_svg(result, self._quantity, _TITLES[job])

    def _show_mistakes(self, mistakes: tuple[Mistake, ...], raw: TomlTables) -> None:
        self._form.show_mistakes(mistakes, raw)
        self._problems.clear()
        self._problems.set_visibility(bool(mistakes))
        with self._problems:
            for mistake in mistakes:
                ui.label(mistake.text)
        for job, (picture, words) in self._maps.items():
            picture.classes(add="old") if mistakes else picture.classes(remove="old")
            if mistakes:
                words.set_text("of the last valid scenario" if job in self._pictures else "is drawn when the scenario is valid")
        self.status.set_text(
            f"{len(mistakes)} {'error' if len(mistakes) == 1 else 'errors'} to correct" if mistakes else "the scenario is valid"
        )

    async def _ask(self) -> None:
        """Require a confirmation before the file is replaced."""
        scenario = self._scenario
        if scenario is None:
            ui.notify("the scenario is not valid yet; correct it first", type="negative")
            return
        lost = "Comments in it are lost; only what differs from the defaults is written."
        other = " It was changed by another program since it was opened here: that is lost too." if self._draft.changed_outside else ""
        with ui.dialog() as dialog, ui.card():
            ui.label(f"Replace {self._draft.name}? {lost}{other}")
            with ui.row():
                ui.button("replace", on_click=lambda: dialog.submit(True)).props("no-caps text-color=on-mark data-do=replace")
                ui.button("keep the file", on_click=lambda: dialog.submit(False)).props("flat no-caps")

        if not await dialog:
            return
        try:
            written = await asyncio.to_thread(self._draft.save, scenario)
            ui.notify(f"{written.name} is written", type="positive")
        except SeaglintError as error:
            ui.notify(str(error), type="negative")
