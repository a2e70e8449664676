"""A viewer in this process, and its page in a real Chromium that is cut off from everything but the viewer."""

from __future__ import annotations

import socket
import threading
from pathlib import Path
from urllib.parse import urlsplit

import pytest

uvicorn = pytest.importorskip("uvicorn", reason="the viewer's extra is not installed")

CHROMIUM = Path("/usr/bin/chromium")
if not CHROMIUM.exists():
    pytest.skip(f"no {CHROMIUM}", allow_module_level=True)

PATIENCE = 600_000  # ms; of a machine that is busy with other tests


class Served:
    """A viewer in this process, at a port of its own."""

    def __init__(self, *paths: Path) -> None:
        from seaglint.viewer.library import Library
        from seaglint.viewer.server import make_app

        self.socket = socket.socket()
        self.socket.bind(("127.0.0.1", 0))
        self.socket.listen()
        self.place = f"127.0.0.1:{self.socket.getsockname()[1]}"
        self.server = uvicorn.Server(uvicorn.Config(make_app(Library(paths)), log_level="error", lifespan="off"))
        self.thread = threading.Thread(target=self.server.run, kwargs={"sockets": [self.socket]}, daemon=True)
        self.thread.start()

    def end(self) -> None:
        self.server.should_exit = True
        self.thread.join(10)
        self.socket.close()


class Seen:
    """A page and every request of it."""

    def __init__(self, browser, viewer: Served, size=(1366, 768), fragment: str = "", **options) -> None:
        self.place = viewer.place
        # Strings that Playwright waits for are evaluated, which the pages' policy forbids; test_policy_holds looks with it on.
        self.context = browser.new_context(
            viewport={"width": size[0], "height": size[1]}, bypass_csp=True, accept_downloads=True, **options
        )
        self.page = self.context.new_page()
        self.page.set_default_timeout(PATIENCE)
        self.requests: list[str] = []
        self.errors: list[str] = []
        self.page.on("request", lambda request: self.requests.append(request.url))
        self.page.on("pageerror", lambda error: self.errors.append(str(error)))
        self.page.goto(f"http://{viewer.place}/{fragment}")
        self.until("window.seaglint && seaglint.state.panes.a && seaglint.state.panes.a.drawn > 0")

    def until(self, condition: str) -> None:
        self.page.wait_for_function(condition, timeout=PATIENCE)

    def on(self, testid: str):
        return self.page.locator(f"[data-testid={testid}]")

    def number(self, testid: str) -> float:
        return float(self.on(testid).first.get_attribute("data-value"))

    def at(self, column: int, row: int, pane: str = "a") -> tuple[float, float]:
        return tuple(self.page.evaluate("([pane, column, row]) => seaglint.screen(pane, column, row)", [pane, column, row]))

    def scrub(self, frame: int) -> None:
        self.on("scrub").evaluate("(slider, value) => { slider.value = value; slider.dispatchEvent(new Event('input')) }", frame)
        self.until(f"seaglint.state.frame === {frame}")

    def drag(self, first: tuple[int, int], last: tuple[int, int]) -> dict[str, int]:
        self.page.keyboard.down("Shift")
        self.page.mouse.move(*self.at(*first))
        self.page.mouse.down()
        self.page.mouse.move(*self.at(*last), steps=5)
        self.page.mouse.up()
        self.page.keyboard.up("Shift")
        return dict(zip(("left", "top", "width", "height"), self.page.evaluate("seaglint.state.regions.at(-1).numbers"), strict=True))

    def end(self) -> None:
        self.context.close()
        assert self.errors == []
        assert {urlsplit(url).netloc for url in self.requests if not url.startswith(("blob:", "data:"))} == {self.place}
