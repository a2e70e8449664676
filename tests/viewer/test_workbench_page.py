"""The workbench in a real browser: fields, messages, pictures, saving; nothing leaves the machine."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import time
import tomllib
from contextlib import contextmanager
from pathlib import Path
from urllib.parse import urlsplit

import pytest

from seaglint.scenario.load import load_scenario, parse_scenario

pytest.importorskip("nicegui")
playwright = pytest.importorskip("playwright.sync_api")

CHROMIUM = Path("/usr/bin/chromium")
EXAMPLES = Path(__file__).parents[2] / "examples"
SCREENSHOTS = os.environ.get("SEAGLINT_SCREENSHOTS")

pytestmark = [
    pytest.mark.validation,  # a server, a browser and pictures: minutes
    pytest.mark.skipif(not CHROMIUM.exists(), reason="needs /usr/bin/chromium"),
]


@contextmanager
def served(*arguments):
    """Address of a viewer of its own."""
    command = [sys.executable, "-c", "from seaglint.cli.app import main; main()", "view", *arguments, "--no-browser"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        try:
            yield process.stdout.readline().strip()
        finally:
            process.terminate()


@pytest.fixture(scope="module")
def browser():
    with playwright.sync_playwright() as tool:
        opened = tool.chromium.launch(executable_path=str(CHROMIUM), args=["--no-sandbox"])
        yield opened
        opened.close()


@contextmanager
def opened(browser, address):
    """A page, of which every request is recorded; all have to stay on the machine."""
    page = browser.new_page(viewport={"width": 1500, "height": 1150})
    asked = []
    page.on("request", lambda request: asked.append(request.url))
    page.on("websocket", lambda socket: asked.append(socket.url))
    page.set_default_timeout(600_000)
    playwright.expect.set_options(timeout=600_000)
    page.goto(address)
    yield page
    page.close()
    assert asked
    away = [url for url in asked if not url.startswith(("data:", "blob:")) and urlsplit(url).hostname != "127.0.0.1"]
    assert not away


def picture(page, name):
    return page.locator(f'[data-picture="{name}"]')


def drawn(page, before=None):
    """Content of the first frame once it is there, and another than before."""
    frame = picture(page, "frame")
    playwright.expect(frame.locator("svg image").first).to_be_attached(timeout=600_000)
    if before is not None:
        page.wait_for_function("old => document.querySelector('[data-picture=frame]').innerHTML !== old", arg=before, timeout=600_000)
    return frame.inner_html()


def test_a_change_is_drawn_and_saved(browser, tmp_path):
    mine = tmp_path / "harbour.toml"
    text = (EXAMPLES / "harbour.toml").read_text(encoding="utf-8")
    mine.write_text(text.replace("zenith_deg = 60", "zenith_deg = 80").replace("azimuth_deg = 250", "azimuth_deg = 183"), encoding="utf-8")
    with served(str(mine)) as address, opened(browser, address) as page:
        first, compass = drawn(page), picture(page, "compass").inner_html()
        assert "swimmer" in picture(page, "plan").inner_html()
        if SCREENSHOTS:
            page.screenshot(path=Path(SCREENSHOTS) / "viewer-workbench.png")
        page.locator('input[data-key="wind.from_deg"]').fill("90")
        page.locator('input[data-key="wind.speed_m_s"]').fill("18 kn")
        began = time.perf_counter()
        second = drawn(page, first)
        print(f"mean map and frame redrawn {time.perf_counter() - began:.1f} s after the change")
        assert picture(page, "compass").inner_html() != compass
        playwright.expect(page.locator("[data-toml]")).to_contain_text("from_deg = 90.0")

        with page.expect_download() as waiting:
            page.locator('[data-do="download"]').click()
        scenario = parse_scenario(tomllib.loads(waiting.value.path().read_text(encoding="utf-8")))
        assert scenario.wind.speed_m_s == pytest.approx(9.26)
        assert scenario.wind.from_deg == 90.0

        field = page.locator('input[data-key="sensor.height_m"]')
        field.fill("-5 ft")
        note = page.locator('[data-note="sensor.height_m"]')
        refused = (
            "sensor.height_m = '-5 ft' is outside the allowed range: above 0 to 100000 m; for a satellite write 'space', the top of the air"
        )
        playwright.expect(note).to_have_text(refused)
        field.fill("50 ft")
        playwright.expect(note).to_have_text(re.compile("^height above the mean sea"))
        drawn(page, second)

        assert load_scenario(mine).wind.from_deg == 230.0
        page.locator('[data-do="save"]').click()
        page.locator('[data-do="replace"]').click()
        playwright.expect(page.get_by_text("harbour.toml is written")).to_be_visible()
    assert load_scenario(mine).sensor.height_m == pytest.approx(15.24)
    assert load_scenario(mine).objects == load_scenario(EXAMPLES / "harbour.toml").objects


def test_a_preset_to_begin_with_and_the_day_of_its_sun(browser):
    with served() as address, opened(browser, address) as page:
        assert urlsplit(address).path == "/workbench"
        drawn(page)
        page.locator('[data-key="preset"]').click()
        page.get_by_text("calm: ").click()
        playwright.expect(page.locator("[data-toml]")).to_contain_text("height_m = 100.0")
        page.locator('[data-do="by-time"]').click()
        playwright.expect(page.locator("[data-toml]")).to_contain_text("latitude_deg = 36.8")
        playwright.expect(page.get_by_text("17:30 UTC: elevation 75")).to_be_visible()
        compass = picture(page, "compass").inner_html()
        box = page.locator('[data-do="day"]').bounding_box()
        page.mouse.click(box["x"] + box["width"] * 0.5, box["y"] + box["height"] / 2)
        playwright.expect(page.locator("[data-toml]")).to_contain_text(re.compile("utc = 2026-06-21T1[12]:[05][05]:00Z"))
        page.wait_for_function("old => document.querySelector('[data-picture=compass]').innerHTML !== old", arg=compass)
        page.locator('[data-do="by-angles"]').click()
        playwright.expect(page.locator("[data-toml]")).to_contain_text("[sun]")


def test_a_browser_that_leaves_in_the_middle_and_comes_back(browser):
    with served(str(EXAMPLES / "demo.toml")) as address:
        for _ in range(3):
            with opened(browser, address) as page:
                page.locator('input[data-key="wind.from_deg"]').fill("10")
        with opened(browser, address) as page:
            drawn(page)
