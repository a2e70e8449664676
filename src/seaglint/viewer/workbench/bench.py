"""Page of the workbench: the form on the left, pictures of its scenario on the right, in the style of the viewer's pages.

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
from seaglint.viewer.workbench.svg_pictures import PlanView, Quantity, distance, map_svg, plan, plan_svg

CSS: Final = """
:root { --ground: #15181b; --panel: #1d2125; --line: #343b41; --text: #dfe3e6; --faint: #98a2aa; --mark: #f0b54a; --wrong: #ff8a75;
  color-scheme: dark; }
body.bench { background: var(--ground); color: var(--text); font: 14px/1.4 system-ui, "DejaVu Sans", sans-serif; }
.bench .nicegui-content { padding: 0; }
.bench .whole { width: 100%; gap: 0; }
.bench .top { width: 100%; align-items: center; gap: 1rem; padding: .45rem .9rem; background: var(--panel);
  border-bottom: 1px solid var(--line); }
.bench .mark { color: var(--mark); font-weight: 700; letter-spacing: .03em; }
.bench .presets { width: 30rem; max-width: 60vw; }
.bench .faint { color: var(--faint); font-size: 12.5px; }
.bench .grow { flex: 1; min-width: 0; }
.bench .lines { white-space: pre-line; }
.bench .columns { width: 100%; display: grid; grid-template-columns: minmax(320px, 400px) minmax(0, 1fr); align-items: start; }
.bench .left { gap: 0; border-right: 1px solid var(--line); background: var(--panel); height: calc(100vh - 58px); overflow-y: auto;
  flex-wrap: nowrap; position: sticky; top: 0; }
.bench .right { gap: .8rem; padding: .8rem; min-width: 0; }
.bench .group { width: 100%; border-bottom: 1px solid var(--line); }
.bench .group .nicegui-expansion-content { padding: 0 .9rem .8rem; }
.bench .item { width: 100%; border: 1px solid var(--line); border-radius: 4px; }
.bench .head { width: 100%; min-width: 0; flex: 1; align-items: baseline; gap: .6rem; flex-wrap: nowrap; }
.bench .q-btn { color: var(--mark); }
.bench .q-btn.bg-primary { color: #15181b !important; }
.bench .head .faint { overflow: hidden; text-overflow: ellipsis; white-space: nowrap; }
.bench .name { font-weight: 600; white-space: nowrap; }
.bench .fields { width: 100%; gap: .15rem; }
.bench .table { width: 100%; gap: .15rem; margin-top: .6rem; padding-left: .7rem; border-left: 2px solid var(--line); }
.bench .wide { width: 100%; }
.bench .note { color: var(--faint); font-size: 11.5px; line-height: 1.3; margin: 0 0 .5rem .2rem; }
.bench .wrong { color: var(--wrong) !important; }
.bench .head .faint.wrong { white-space: normal; }
.bench .problems { width: 100%; gap: .2rem; padding: .5rem .9rem; background: #3a211d; color: var(--wrong); border: 1px solid #693a31;
  border-radius: 4px; }
.bench .banner { padding: 1rem; }
.bench .pictures { width: 100%; gap: .8rem; align-items: stretch; }
.bench .card { background: var(--panel); border: 1px solid var(--line); border-radius: 4px; padding: .6rem .8rem; gap: .35rem; width: 100%;
  min-width: 0; }
.bench .two { flex: 1 1 420px; width: auto; }
.bench .third { flex: 1 1 260px; width: auto; }
.bench .picture { width: 100%; }
.bench .picture.middle { display: flex; justify-content: center; }
.bench .picture.old { opacity: .35; }
.bench .text { width: 100%; }
.bench .text pre { margin: 0; font: 12.5px/1.45 ui-monospace, "DejaVu Sans Mono", monospace; white-space: pre-wrap; max-height: 22rem;
  overflow-y: auto; }
.bench .command { border-top: 1px solid var(--line); padding-top: .25rem; align-items: center; }
.bench .code { font: 12.5px ui-monospace, "DejaVu Sans Mono", monospace; user-select: all; overflow-x: auto; white-space: nowrap; }
.bench .q-field--outlined .q-field__control:before { border-color: var(--line); }
.bench .q-field__native::placeholder { color: #66717a; opacity: 1; }
@media (max-width: 900px) { .bench .columns { grid-template-columns: minmax(0, 1fr); }
  .bench .left { height: auto; position: static; border-right: 0; } }
"""


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
    ui.add_css(CSS)
    ui.colors(primary="#f0b54a", dark_page="#15181b")
    ui.query("body").classes("bench")
    with ui.column().classes("whole") as whole:
        _begin(whole, path)


def _begin(whole: ui.column, path: str | Path | None, preset: str = "glint") -> None:
    whole.clear()
    with whole:
        try:
            draft = Draft(path, preset)
        except SeaglintError as error:
            ui.label(str(error)).classes("wrong banner")
            return
        bench = Bench(draft)
        with ui.row().classes("top"):
            ui.label("seaglint").classes("mark")
            ui.label(draft.name if path is not None else "Scenario workbench").classes("faint grow")
            if path is None:
                words = {name: f"{name}: {chosen.title}" for name, chosen in PRESETS.items()}

                def choose(name: str) -> None:
                    bench.close()
                    _begin(whole, None, name)

                ui.select(words, label="begin with a preset", value=preset, on_change=lambda e: choose(str(e.value))).props(
                    "dense outlined options-dense data-key=preset"
                ).classes("presets")
            bench.status = ui.label("").classes("faint status").props("data-status")
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
            self._left = ui.column().classes("left")
            with ui.column().classes("right"):
                self._problems = ui.column().classes("problems").props("data-problems")
                self._problems.set_visibility(False)
                with ui.row().classes("pictures"):
                    self._maps = {job: self._map(job) for job in _TITLES}
                with ui.row().classes("pictures"):
                    self._around()
                self._writing()
        self._refill()
        self.changed()

    def _refill(self) -> None:
        """Build the form again, since tables were added or removed."""
        self._left.clear()
        with self._left:
            self._form = Form(self._draft, self.changed)
            self._form.build()

    def _map(self, job: Job) -> tuple[ui.html, ui.label]:
        with ui.column().classes("card two"):
            with ui.row().classes("head"):
                ui.label(_TITLES[job]).classes("name")
                words = ui.label("").classes("faint grow").props(f'data-words="{job}"')
                if job == "mean":
                    ui.toggle(
                        {"radiance": "radiance", "apparent_temperature": "temperature"},
                        value="radiance",
                        on_change=lambda e: self._of(e.value),
                    ).props("dense no-caps unelevated size=sm")
            return ui.html("", sanitize=False).classes("picture").props(f'data-picture="{job}"'), words

    def _around(self) -> None:
        with ui.column().classes("card third"):
            ui.label("Wind, Sun and view").classes("name")
            self._compass = ui.html("", sanitize=False).classes("picture middle").props("data-picture=compass")
            self._facts = ui.label("").classes("faint lines")
        with ui.column().classes("card third"):
            with ui.row().classes("head"):
                ui.label("Plan").classes("name grow")
                ui.switch("to the horizon", on_change=lambda e: self._far(bool(e.value))).props("dense")
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
        """React to a change: the scenario is read :data:`DEBOUNCE` seconds after the last one."""
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
            f"wind {scenario.wind.speed_m_s:g} m/s from {scenario.wind.from_deg:g}°",
            f"Sun: elevation {90 - zenith:.1f}°, azimuth {azimuth:.1f}°",
            f"view: azimuth {view.azimuth % 360:g}°, elevation {scenario.sensor.elevation_deg:g}°",
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
            words.set_text(f"{columns} x {rows} of {result.pixels[0]} x {result.pixels[1]} pixels, {result.seconds:.1f} s")
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
        for picture, _ in self._maps.values():
            picture.classes(add="old") if mistakes else picture.classes(remove="old")
        self.status.set_text(f"{len(mistakes)} to correct" if mistakes else "valid")

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
                ui.button("replace", on_click=lambda: dialog.submit(True)).props("no-caps data-do=replace")
                ui.button("keep the file", on_click=lambda: dialog.submit(False)).props("flat no-caps")

        if not await dialog:
            return
        try:
            written = await asyncio.to_thread(self._draft.save, scenario)
            ui.notify(f"{written.name} is written", type="positive")
        except SeaglintError as error:
            ui.notify(str(error), type="negative")
