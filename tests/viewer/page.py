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

#: Lowest contrast of text by the Web Content Accessibility Guidelines, level AA.
LEAST_CONTRAST = 4.5

# Texts whose contrast with the colour behind them is too low. Opacities count; hidden texts, icons and pictures dimmed by errors do not.
FAINT_TEXTS = """least => {
  const draw = document.createElement('canvas').getContext('2d', {willReadFrequently: true});
  const rgba = (colour) => { draw.clearRect(0, 0, 1, 1); draw.fillStyle = colour; draw.fillRect(0, 0, 1, 1);
    const [r, g, b, a] = draw.getImageData(0, 0, 1, 1).data; return [r, g, b, a / 255]; };
  const over = (top, below) => [0, 1, 2].map((n) => top[3] * top[n] + (1 - top[3]) * below[n]).concat(1);
  const light = (c) => c.slice(0, 3).map((v) => v / 255).map((v) => v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4)
    .reduce((sum, v, n) => sum + v * [0.2126, 0.7152, 0.0722][n], 0);
  const behind = (element) => { const layers = [];
    for (let e = element; e; e = e.parentElement) layers.push(rgba(getComputedStyle(e).backgroundColor));
    return layers.reverse().reduce((below, top) => over(top, below), [255, 255, 255, 1]); };
  const opacity = (element) => element ? Number(getComputedStyle(element).opacity) * opacity(element.parentElement) : 1;
  const found = [];
  const check = (element, colour, text) => {
    const ground = behind(element), ink = rgba(colour);
    ink[3] *= opacity(element);
    const [a, b] = [light(over(ink, ground)), light(ground)].sort((x, y) => y - x);
    const contrast = (a + 0.05) / (b + 0.05);
    if (contrast < least) found.push(`${contrast.toFixed(2)}: ${text}`);
    return 1;
  };
  let checked = 0;
  for (const element of document.querySelectorAll('body *')) {
    if (!element.checkVisibility({visibilityProperty: true, opacityProperty: true})) continue;
    if (element.closest('.q-icon, .nicegui-error-popup, title, .old')) continue;
    const own = [...element.childNodes].filter((node) => node.nodeType === 3).map((node) => node.data.trim()).join('');
    const style = getComputedStyle(element);
    if (own) checked += check(element, element.closest('svg') ? style.fill : style.color, own);
    if (element.value && element.matches('input:not([type=range], [type=checkbox]), textarea'))
      checked += check(element, style.color, element.value);
    if (element.placeholder) checked += check(element, getComputedStyle(element, '::placeholder').color, element.placeholder);
  }
  return [checked, found];
}"""


def shrink(picture: Path, *, glint: bool = False) -> None:
    """Write a picture of the guide with a palette, which halves the file; of much ``glint`` with few greys, whose noise fills it."""
    from PIL import Image

    method = Image.Quantize.MAXCOVERAGE if glint else Image.Quantize.MEDIANCUT
    Image.open(picture).convert("RGB").quantize(256, method, dither=Image.Dither.NONE).save(picture, optimize=True)
    assert picture.stat().st_size < 150_000


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
