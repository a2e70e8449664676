"""The workbench in a real browser: fields, messages, pictures, saving; nothing leaves the machine."""

from __future__ import annotations

import itertools
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

from .page import CHROMIUM, FAINT_TEXTS, LEAST_CONTRAST, shrink

playwright = pytest.importorskip("playwright.sync_api")
EXAMPLES = Path(__file__).parents[2] / "examples"
SCREENSHOTS = os.environ.get("SEAGLINT_SCREENSHOTS")

pytestmark = pytest.mark.validation  # a server, a browser and pictures: minutes


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
def opened(browser, address, width=1500, **settings):
    """A page, of which every request is recorded; all have to stay on the machine."""
    page = browser.new_page(viewport={"width": width, "height": 1150}, **settings)
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
            guide = Path(SCREENSHOTS) / "viewer-workbench.png"
            page.screenshot(path=guide)
            shrink(guide)
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
        facts = page.locator('[data-words="facts"]')
        before = facts.inner_text()
        wind = before.splitlines()[0]
        page.locator('[data-do="by-time"]').click()
        playwright.expect(page.locator("[data-toml]")).to_contain_text("longitude_deg")
        playwright.expect(page.locator("[data-toml]")).not_to_contain_text("[sun]")
        said = page.locator('[data-words="difference"]').inner_text()
        assert re.match(r"The Sun differs by 0\.00\d+° from the given angles; by its distance of \d\.\d{3} au on this date", said)
        playwright.expect(page.locator('[data-words="day"]')).to_contain_text("UTC: elevation")
        assert facts.inner_text() == before
        compass = picture(page, "compass").inner_html()
        box = page.locator('[data-do="day"]').bounding_box()
        page.mouse.click(box["x"] + box["width"] * 0.5, box["y"] + box["height"] / 2)
        playwright.expect(page.locator("[data-toml]")).to_contain_text(re.compile("utc = 2026-[0-9-]+T1[12]:[05][0-9]:00Z"))
        page.wait_for_function("old => document.querySelector('[data-picture=compass]').innerHTML !== old", arg=compass)
        playwright.expect(page.locator('[data-words="difference"]')).to_have_count(0)
        assert wind in facts.inner_text()
        page.locator('[data-do="by-angles"]').click()
        playwright.expect(page.locator("[data-toml]")).to_contain_text("[sun]")


def test_a_browser_that_leaves_in_the_middle_and_comes_back(browser):
    with served(str(EXAMPLES / "demo.toml")) as address:
        for _ in range(3):
            with opened(browser, address) as page:
                page.locator('input[data-key="wind.from_deg"]').fill("10")
        with opened(browser, address) as page:
            drawn(page)


# --- how the page looks

# What ends to the right of the form, or is cut off within it.
OUTSIDE = """() => {
  const panel = document.querySelector('.form'), edge = panel.getBoundingClientRect().left + panel.clientLeft + panel.clientWidth + 0.5;
  return [...panel.querySelectorAll('*')].filter((e) => e.checkVisibility() && !e.closest('.q-focus-helper, svg'))
    .filter((e) => e.getBoundingClientRect().right > edge || (e.matches('.note, .faint, .name') && e.scrollWidth > e.clientWidth + 1))
    .map((e) => `${e.className}: ${e.textContent.slice(0, 60)}`);
}"""

PLAN_INSIDE = """() => {
  const box = document.querySelector('[data-picture=plan] svg').getBoundingClientRect();
  return [...document.querySelectorAll('[data-picture=plan] text')].map((text) => [text.textContent, text.getBoundingClientRect()])
    .filter(([, t]) => t.left < box.left || t.right > box.right || t.top < box.top || t.bottom > box.bottom).map(([text]) => text);
}"""


@pytest.fixture(scope="module")
def bench():
    """Address of one viewer for all looks."""
    with served() as address:
        yield address


def unfold(page, *groups):
    for group in groups:
        page.locator(f'[data-group="{group}"] .q-item').first.click()
        page.locator(f'[data-group="{group}"] .fields .note:visible').first.wait_for()


def ready(page):
    """The page with pictures, optics, noise, detector and an error."""
    drawn(page)
    unfold(page, "sea", "atmosphere")
    for table in ("sensor.optics", "sensor.noise"):
        page.locator(f'[data-key="{table}"]').click()
        page.locator(f'[data-note^="{table}."]').first.wait_for()
    page.locator('input[data-key="sensor.height_m"]').fill("-5 ft")
    playwright.expect(page.locator('[data-note="sensor.height_m"]')).to_contain_text("outside the allowed range")


@pytest.mark.parametrize("width", [1280, 390, 320])
def test_everything_ends_inside_its_panel(browser, bench, width):
    with opened(browser, bench, width) as page:
        drawn(page)
        assert page.evaluate(PLAN_INSIDE) == []
        lines = [page.locator(f'[data-words="{job}"]') for job in ("mean", "frame")]
        for words in lines:
            assert "160 x 80 pixels for 512 x 256" in words.inner_text()
            assert words.evaluate("e => e.scrollWidth <= e.clientWidth")
        ready(page)
        for words in lines:
            playwright.expect(words).to_have_text("of the last valid scenario")
        assert page.evaluate(OUTSIDE) == []
        assert page.evaluate("document.documentElement.scrollWidth") <= width


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_every_text_stands_out_from_what_is_behind_it(browser, bench, theme):
    with opened(browser, bench, 1280, color_scheme=theme) as page:
        ready(page)
        checked, faint = page.evaluate(FAINT_TEXTS, LEAST_CONTRAST)
        assert checked > 150
        assert faint == []
        page.reload()
        drawn(page)
        page.locator('[data-do="by-time"]').click()
        page.locator('[data-words="difference"]').wait_for()
        playwright.expect(picture(page, "compass")).to_contain_text("NE")
        checked, faint = page.evaluate(FAINT_TEXTS, LEAST_CONTRAST)
        assert checked > 150
        assert faint == []


def test_a_chosen_theme_stays_and_the_system_s_is_the_default(browser, bench):
    with opened(browser, bench, color_scheme="light") as page:
        grounds = {}
        for theme in ("dark", "light", ""):
            page.locator("[data-theme-choice]").select_option(theme)
            page.reload()
            assert page.locator("[data-theme-choice]").input_value() == theme
            grounds[theme] = page.evaluate("getComputedStyle(document.body).backgroundColor")
            assert ("body--dark" in page.locator("body").get_attribute("class")) == (theme == "dark")
        assert grounds[""] == grounds["light"] != grounds["dark"]


def test_a_phone_has_pictures_first_and_buttons_for_fingers(browser, bench):
    with opened(browser, bench, 390) as page:
        drawn(page)
        assert picture(page, "mean").bounding_box()["y"] < 600
        assert page.locator(".form").bounding_box()["y"] > picture(page, "plan").bounding_box()["y"]
        for button in page.locator("button:visible, .q-item:visible, .top select").all():
            box = button.bounding_box()
            assert min(box["height"], box["width"]) >= 40, button.evaluate("e => e.outerHTML")
        # The Tab key goes down the page.
        tops, top = [], "(e => e && e !== document.body ? e.getBoundingClientRect().top + scrollY : null)(document.activeElement)"
        page.locator("[data-theme-choice]").focus()
        for _ in range(12):
            tops.append(page.evaluate(top))
            page.keyboard.press("Tab")
        assert tops[-1] > 600
        assert all(after >= before - 40 for before, after in itertools.pairwise(tops))  # things of one line differ in height


def test_values_are_read_off_the_maps(browser, bench):
    with opened(browser, bench) as page:
        drawn(page)
        value = page.locator('[data-value="mean"]')
        box = picture(page, "mean").locator("image").first.bounding_box()
        page.mouse.move(box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"])
        playwright.expect(value).to_have_text(
            re.compile(r"^azimuth 1(79|80)\.\d\d°, elevation \u22123\.\d\d°: [\d.]+ W m⁻² sr⁻¹, \d{3}\.\d\d K \([\d.]+ °C\)$")
        )
        kelvin, celsius = re.search(r"([\d.]+) K \(([\d.]+) °C\)", value.inner_text()).groups()
        assert float(kelvin) - float(celsius) == pytest.approx(273.15, abs=0.011)
        page.mouse.move(box["x"] - 20, box["y"] + 0.5 * box["height"])
        playwright.expect(value).to_have_text("point at the picture, or tap it, to read values")


def test_temperatures_are_in_celsius_too(browser, bench):
    with opened(browser, bench) as page:
        drawn(page)
        unfold(page, "sea")
        shown = page.locator('label:has(input[data-key="sea.temperature_k"]) .q-field__suffix')
        playwright.expect(shown).to_have_text("= 15.00 °C")
        page.locator('input[data-key="sea.temperature_k"]').fill("280")
        playwright.expect(shown).to_have_text("= 6.85 °C")
        page.locator('input[data-key="sea.temperature_k"]').fill("11 degC")
        playwright.expect(shown).to_have_text("")
        page.get_by_text("apparent temperature", exact=True).click()
        playwright.expect(picture(page, "mean")).to_contain_text("K (°C)")
        label = re.search(r">(\d+\.?\d*) \((\d+\.?\d*)\)<", picture(page, "mean").inner_html())
        assert float(label[1]) - float(label[2]) == pytest.approx(273.15, abs=1.0)  # whole degrees
