"""The page of sequences in a real Chromium, cut off from everything but the viewer.

With ``SEAGLINT_SCREENSHOTS=folder`` the pictures of the documentation are made from a rendered run (:func:`test_screenshots`).
"""

from __future__ import annotations

import json
import os
from pathlib import Path

import numpy as np
import pytest

from seaglint.analysis import AnalysisOptions, analyze
from seaglint.clutter.filters import Laplacian
from seaglint.clutter.thresholds import standardise
from seaglint.store.sequence_store import write_sequence
from seaglint.viewer.frame_source import open_source

from .conftest import COLUMNS, ROWS, images, layout, radiance

pytest.importorskip("playwright.sync_api", reason="Playwright is not installed")

from .page import PATIENCE, Seen, Served, shrink


def test_scrub_and_probe_tell_the_stores_values(seen):
    seen.scrub(7)
    seen.page.mouse.move(*seen.at(40, 30))
    seen.until("document.getElementById('probe').dataset.frame === '7' && document.querySelector('[data-testid=probe-radiance]')")
    seen.until("document.getElementById('probe-where').textContent.startsWith('column 40, row 30')")
    assert seen.number("probe-radiance") == float(radiance(7)[30, 40])
    assert seen.on("frame-number").text_content() == "frame 7 / 11"
    assert seen.on("time").text_content() == "0.28 s"
    seen.on("step-forward").click()
    seen.until("document.getElementById('probe').dataset.frame === '8'")
    assert seen.number("probe-radiance") == float(radiance(8)[30, 40])


@pytest.mark.validation
def test_dragged_region_has_the_statistics_of_analyze(seen, store):
    seen.scrub(4)
    box = seen.drag((10, 8), (45, 40))
    assert box == {"left": 10, "top": 8, "width": 36, "height": 33}
    seen.until("document.getElementById('region').dataset.frame === '4' && document.querySelector('[data-testid=region-mean]')")
    mask = np.zeros((ROWS, COLUMNS), bool)
    mask[8:41, 10:46] = True
    expected = analyze(open_source(store).recording("radiance", only=4), AnalysisOptions(mask=mask)).regions["glint"].as_dict()
    for name, key in (("mean", "mean"), ("std", "std"), ("skewness", "skewness"), ("kurtosis", "excess_kurtosis"), ("pixels", "pixels")):
        assert seen.number(f"region-{name}") == expected[key]
    assert seen.number("region-gamma") == expected["fits"]["gamma"]["shape"]


@pytest.mark.validation
def test_threshold_counts_what_it_shows(seen):
    seen.scrub(2)
    seen.on("threshold-on").check()
    seen.on("threshold").evaluate("(slider) => { slider.value = 2.5; slider.dispatchEvent(new Event('input')) }")
    seen.until("(({ sigma, frame }) => sigma === '2.5' && frame === '2')(document.getElementById('threshold-table').dataset)")
    count = int((standardise(Laplacian().apply(radiance(2)[np.newaxis]))[0] > 2.5).sum())
    assert seen.number("threshold-count") == count > 0
    assert seen.number("threshold-rate") == count / (ROWS * COLUMNS)
    pixels = "(() => { const c = seaglint.state.panes.a.mask; return c.getContext('2d').getImageData(0, 0, c.width, c.height).data })()"
    shown = f"{pixels}.filter((value, place) => place % 4 === 3 && value > 0).length"
    assert seen.page.evaluate(shown) == count


@pytest.mark.validation
def test_policy_holds_and_everything_comes_from_the_viewer(chromium, served):
    context = chromium.new_context()
    page = context.new_page()
    complaints: list[str] = []
    page.on("console", lambda message: complaints.append(message.text))
    page.goto(f"http://{served.place}/")
    page.locator("[data-testid=frame-number]", has_text="frame 0").wait_for(timeout=PATIENCE)
    assert complaints == []
    context.close()


@pytest.mark.validation
def test_side_by_side_and_difference(chromium, served):
    seen = Seen(chromium, served)
    seen.on("difference").check()
    seen.until("seaglint.state.panes.d && seaglint.state.panes.d.drawn > 0 && seaglint.state.panes.d.levels")
    seen.scrub(3)
    difference = radiance(3) - radiance(103)
    levels = np.array(seen.page.evaluate("Array.from(seaglint.state.panes.d.levels)")).reshape(ROWS, COLUMNS)
    inside = (levels > 1) & (levels < 255)  # neither beyond the scale's ends nor rounded to its middle
    assert np.array_equal((levels > 128)[inside & (levels != 128)], (difference > 0)[inside & (levels != 128)])
    seen.page.mouse.move(*seen.at(20, 20, "b"))
    seen.until("document.querySelectorAll('[data-testid=probe-radiance]').length === 2")
    seen.until("document.getElementById('probe').dataset.frame === '3'")
    values = [float(cell.get_attribute("data-value")) for cell in seen.on("probe-radiance").all()]
    assert values == [float(radiance(3)[20, 20]), float(radiance(103)[20, 20])]
    # Axes are linked: what one pane zooms, all do.
    seen.page.mouse.wheel(0, -600)
    places = [
        seen.page.evaluate(
            f"(() => {{ const p = seaglint.state.panes.{name}; return p.at(p.canvas.clientWidth / 2, p.canvas.clientHeight / 2) }})()"
        )
        for name in "abd"
    ]
    assert seen.page.evaluate("seaglint.camera.zoom") > 2
    assert places[0] == pytest.approx(places[1], abs=0.5)
    seen.end()


@pytest.mark.validation
def test_difference_of_two_sizes_is_told_and_both_are_shown(chromium, store, tmp_path):
    np.save(tmp_path / "small.npy", np.arange(600.0).reshape(1, 20, 30))
    np.save(tmp_path / "large.npy", np.arange(1200.0).reshape(1, 30, 40))
    viewer = Served(tmp_path / "small.npy", tmp_path / "large.npy")
    seen = Seen(chromium, viewer)
    seen.on("difference").check()
    seen.on("message").filter(has_text="30 x 20 and 40 x 30 pixels").wait_for()
    assert seen.page.evaluate("seaglint.state.panes.a.levels.length") == 600
    assert seen.page.evaluate("seaglint.state.panes.b.levels.length") == 1200
    seen.end()
    viewer.end()


@pytest.mark.validation
def test_a_shorter_sequence_beside_says_where_it_ends(chromium, store, tmp_path):
    np.save(tmp_path / "long.npy", np.arange(6000.0).reshape(10, 20, 30))
    np.save(tmp_path / "one.npy", np.arange(600.0).reshape(1, 20, 30))
    viewer = Served(tmp_path / "long.npy", tmp_path / "one.npy")
    seen = Seen(chromium, viewer)
    seen.until("document.getElementById('frame-number').textContent === 'frame 0 / 9, B ends at 0'")
    seen.end()
    viewer.end()


@pytest.mark.validation
def test_store_being_written_goes_on_and_vanishing_is_told(chromium, half):
    viewer = Served(half)
    seen = Seen(chromium, viewer)
    assert seen.page.evaluate("Number(document.getElementById('scrub').max)") == 2
    write_sequence(half, layout(), images, resume=True)
    seen.until("Number(document.getElementById('scrub').max) === 11")
    half.rename(half.with_name("away"))
    seen.on("message").filter(has_text="not there any more").wait_for()
    half.with_name("away").rename(half)
    seen.until("document.getElementById('message').hidden")
    seen.end()
    viewer.end()


@pytest.mark.validation
def test_whole_analysis_of_a_region(seen, store):
    seen.scrub(6)
    box = seen.drag((5, 5), (50, 40))
    seen.on("analyse-frame").click()
    seen.until("document.getElementById('analysis').dataset.result")
    told = json.loads(seen.on("analysis").get_attribute("data-result"))
    mask = np.zeros((ROWS, COLUMNS), bool)
    mask[box["top"] : box["top"] + box["height"], box["left"] : box["left"] + box["width"]] = True
    expected = analyze(open_source(store).recording("radiance", only=6), AnalysisOptions(mask=mask)).regions["glint"].as_dict()
    assert {key: told[key] for key in expected} == json.loads(json.dumps(expected))
    with seen.page.expect_download() as waiting:
        seen.on("save-csv").click()
    assert f"mean,{expected['mean']}" in Path(waiting.value.path()).read_text().splitlines()


@pytest.mark.validation
def test_downloads_traces_and_a_browser_closed_in_the_middle(chromium, served):
    seen = Seen(chromium, served)
    seen.scrub(5)
    seen.page.mouse.click(*seen.at(12, 9))
    seen.until("document.getElementById('trace').dataset.values")
    values = json.loads(seen.on("trace").get_attribute("data-values"))
    assert values == [float(radiance(n)[9, 12]) for n in range(12)]
    seen.page.evaluate("document.querySelectorAll('details').forEach((d) => { d.open = true })")
    with seen.page.expect_download() as waiting:
        seen.on("export-npy").click()
    assert np.array_equal(np.load(waiting.value.path()), radiance(5))
    seen.drag((0, 0), (60, 45))
    seen.on("analyse-all").click()
    seen.on("play").click()
    seen.end()  # while frames and an analysis are under way
    again = Seen(chromium, served)
    again.scrub(1)
    again.end()


@pytest.mark.validation
def test_plays_640_by_512(chromium, tmp_path):
    """All frames are drawn, and again from the first."""
    path = write_sequence(
        tmp_path / "large.zarr", layout(75, 512, 640, truth=False, layers=()), lambda n: {"radiance": radiance(n, 512, 640)}
    )
    viewer = Served(path)
    seen = Seen(chromium, viewer)
    seen.on("play").click()
    seen.until("seaglint.state.panes.a.drawn > 30")
    before = seen.page.evaluate("[performance.now(), seaglint.state.panes.a.drawn]")
    seen.until(f"seaglint.state.panes.a.drawn > {before[1] + 120}")
    after = seen.page.evaluate("[performance.now(), seaglint.state.panes.a.drawn]")
    print(f"{1000.0 * (after[1] - before[1]) / (after[0] - before[0]):.1f} frames a second")
    seen.end()
    viewer.end()


@pytest.mark.validation
@pytest.mark.skipif("SEAGLINT_SCREENSHOTS" not in os.environ, reason="SEAGLINT_SCREENSHOTS names no folder for the pictures of the guide")
def test_screenshots(chromium, tmp_path):
    folder = Path(os.environ["SEAGLINT_SCREENSHOTS"])
    given = os.environ.get("SEAGLINT_SCREENSHOT_RUN")
    run = Path(given) if given else _demo(tmp_path)
    viewer = Served(run)
    seen = Seen(chromium, viewer, (1240, 800))
    seen.scrub(3)
    seen.page.mouse.click(*seen.at(300, 120))
    seen.drag((200, 150), (300, 215))
    seen.drag((60, 120), (140, 190))
    seen.on("tool-line").click()
    seen.page.mouse.move(*seen.at(20, 60))
    seen.page.mouse.down()
    seen.page.mouse.move(*seen.at(460, 60), steps=3)
    seen.page.mouse.up()
    seen.on("tool-pan").click()
    seen.on("threshold-on").check()
    seen.page.locator("aside").evaluate("(panel) => panel.scrollTo(0, 0)")
    seen.page.mouse.move(*seen.at(262, 90))
    seen.until("document.querySelector('[data-testid=region-mean]') && document.querySelector('[data-testid=threshold-rate]')")
    seen.until(
        "document.getElementById('trace').dataset.values && document.getElementById('probe-where').textContent.startsWith('column 262')"
    )
    seen.page.wait_for_timeout(500)
    picture = folder / "viewer-sequence.png"
    seen.page.screenshot(path=str(picture))
    shrink(picture, glint=True)
    seen.end()
    viewer.end()


def _demo(folder: Path) -> Path:
    """The demo's first frames."""
    from seaglint.scenario.load import load_scenario
    from seaglint.studies.sequence.render_sequence import render

    scenario = load_scenario(Path(__file__).parents[2] / "examples" / "demo.toml")
    return render(scenario, folder / "demo.zarr", frames=range(8))
