"""What a visitor does with the page in a real Chromium: reads plots, marks regions, uses keys and fingers, sends a link."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from seaglint.viewer.regions import PictureRegion, of_csv, of_imagej, to_csv

from .conftest import COLUMNS, FRAMES, ROWS, radiance
from .test_regions import star

pytest.importorskip("playwright.sync_api", reason="Playwright is not installed")

from .page import FAINT_TEXTS, LEAST_CONTRAST, Seen, Served

pytestmark = pytest.mark.validation  # a browser: minutes

MADE = "document.querySelectorAll('[data-testid=regions-mean]').length === {}"


def visit(chromium, *paths: Path, **options):
    viewer = Served(*paths)
    return viewer, Seen(chromium, viewer, **options)


def leave(viewer: Served, seen: Seen) -> None:
    seen.end()
    viewer.end()


def point(seen: Seen, testid: str, share: float) -> str:
    """Point at a plot, and return what it says."""
    box = seen.on(testid).bounding_box()
    seen.page.mouse.move(box["x"] + 54 + share * (box["width"] - 64), box["y"] + box["height"] / 2)
    return seen.on(f"{testid}-read" if testid != "threshold-plot" else "threshold-read").text_content()


def pull(seen: Seen, first: tuple[float, float], last: tuple[float, float]) -> None:
    """Drag from one place of the picture to another, in pixels of the picture as fractions."""
    seen.page.mouse.move(*seen.at(first[0] - 0.5, first[1] - 0.5))
    seen.page.mouse.down()
    seen.page.mouse.move(*seen.at(last[0] - 0.5, last[1] - 0.5), steps=6)
    seen.page.mouse.up()


def numbers(seen: Seen, index: int = 0) -> list[float]:
    return seen.page.evaluate(f"seaglint.state.regions[{index}].numbers")


def test_values_are_read_off_a_trace_by_pointer_and_by_keys(seen):
    seen.page.mouse.click(*seen.at(12, 9))
    seen.until("document.getElementById('trace').dataset.values")
    assert point(seen, "trace", 7 / 11) == f"time 0.28 s: {float(f'{radiance(7)[9, 12]:.5g}'):g} W m⁻² sr⁻¹"
    seen.on("trace").focus()
    seen.page.keyboard.press("Home")
    seen.page.keyboard.press("ArrowRight")
    assert seen.on("trace-read").text_content().startswith("time 0.04 s: ")
    seen.page.keyboard.press("Enter")
    seen.until("seaglint.state.frame === 1")


def test_histogram_and_false_alarms_tell_their_values(seen):
    seen.drag((5, 5), (50, 40))
    seen.until(MADE.format(1))
    seen.on("histogram").scroll_into_view_if_needed()
    told = point(seen, "histogram", 0.2)
    assert "density" in told
    assert "gamma" in told
    assert "1/(W m⁻² sr⁻¹)" in told
    seen.on("threshold-on").check()
    seen.until("document.getElementById('threshold-table').dataset.sigma")
    seen.on("threshold-plot").scroll_into_view_if_needed()
    told = point(seen, "threshold-plot", 2 / 8)
    assert told.startswith("threshold 2 σ: measured ")
    assert told.endswith("Gaussian 2.28 × 10⁻² per pixel")
    seen.page.mouse.down()
    seen.page.mouse.up()
    seen.until("document.getElementById('threshold-table').dataset.sigma === '2'")


def test_numbers_have_one_style(seen):
    told = seen.page.evaluate("[0.0013499, 5.6818e-4, 0.25, null].map(seaglint.rate)")
    assert told == ["1.35 × 10⁻³", "5.68 × 10⁻⁴", "0.25", "–"]
    assert seen.page.evaluate("[seaglint.within(285.31234, 1.2), seaglint.within(7.20222, 0.5), seaglint.reading(12.3456, '°C')]") == [
        "285.31", "7.202", "12.35",
    ]  # fmt: skip


def test_three_shapes_their_statistics_and_their_courses(seen):
    seen.scrub(4)
    seen.drag((5, 4), (24, 13))
    seen.on("tool-ellipse").click()
    seen.page.mouse.move(*seen.at(30, 10))
    seen.page.mouse.down()
    seen.page.mouse.move(*seen.at(49, 29), steps=4)
    seen.page.mouse.up()
    seen.on("tool-polygon").click()
    for corner in [(40, 30), (60, 32), (50, 44), (40, 30)]:
        seen.page.mouse.click(*seen.at(*corner))
    seen.until(MADE.format(3))
    texts = seen.page.evaluate("seaglint.state.regions.map(({ shape, numbers }) => [shape, ...numbers].join(' '))")
    assert texts[:2] == ["rectangle 5 4 20 10", "ellipse 30 10 20 20"]
    regions = [PictureRegion.of_text(text) for text in texts]
    masks = [region.mask(ROWS, COLUMNS) for region in regions]
    shown = [float(cell.get_attribute("data-value")) for cell in seen.on("regions-mean").all()]
    assert shown == pytest.approx([radiance(4)[mask].mean(dtype=float) for mask in masks], rel=1e-12)
    seen.on("courses-run").click()
    seen.until("document.getElementById('courses').dataset.means")
    means = json.loads(seen.on("courses").get_attribute("data-means"))
    assert np.allclose(means, [[radiance(n)[mask].mean(dtype=float) for n in range(FRAMES)] for mask in masks])
    assert point(seen, "courses", 0.5).count(",") == 2
    with seen.page.expect_download() as waiting:
        seen.on("regions-csv").click()
    assert [region.text for region in of_csv(Path(waiting.value.path()).read_text())] == texts
    kept = waiting.value.path()
    seen.on("region-clear").click()
    seen.until("document.getElementById('regions').hidden")
    seen.on("regions-load").set_input_files({"name": "regions.csv", "mimeType": "text/csv", "buffer": Path(kept).read_bytes()})
    seen.until(MADE.format(3))
    seen.on("region-remove").first.click()
    seen.until(MADE.format(2))
    seen.on("regions-load").set_input_files({"name": "x.csv", "mimeType": "text/csv", "buffer": b"nonsense"})
    seen.on("message").filter(has_text="the first line must be").wait_for()


def test_a_double_click_closes_a_polygon_and_another_tool_keeps_it_open(seen):
    seen.on("tool-polygon").click()
    for corner in [(40, 30), (60, 32)]:
        seen.page.mouse.click(*seen.at(*corner))
    seen.on("tool-line").click()
    assert "a polygon of 2 corners is open" in seen.on("tool-told").text_content()
    seen.on("tool-polygon").click()
    seen.page.mouse.dblclick(*seen.at(50, 44))  # the last corner
    seen.until(MADE.format(1))
    for corner in [(10, 10), (30, 10), (20, 30)]:
        seen.page.mouse.click(*seen.at(*corner))
    seen.page.mouse.dblclick(*seen.at(10, 10))  # the first corner again
    seen.until(MADE.format(2))
    assert (len(numbers(seen)), len(numbers(seen, 1))) == (6, 6)
    assert seen.page.evaluate("seaglint.state.draft.length") == 0
    outside = to_csv([PictureRegion("rectangle", (900, 0, 5, 5), "far")]).encode()
    seen.on("regions-load").set_input_files({"name": "far.csv", "mimeType": "text/csv", "buffer": outside})
    seen.until("document.querySelector('#regions .reason')")
    seen.on("courses-run").click()
    seen.until("document.getElementById('courses').dataset.means")
    seen.until("document.getElementById('courses-progress').textContent.startsWith('left out, outside the picture: ')")
    assert seen.on("courses-progress").text_content().endswith(": far")
    assert point(seen, "courses", 0.5).count(",") == 1


def test_regions_go_to_imagej_and_come_back(seen):
    pytest.importorskip("roifile", reason="roifile is not installed")
    seen.drag((5, 4), (24, 13))
    seen.until(MADE.format(1))
    with seen.page.expect_download() as waiting:
        seen.on("regions-imagej").click()
    content = Path(waiting.value.path()).read_bytes()
    assert [region.text for region in of_imagej(content)] == ["rectangle 5 4 20 10"]
    seen.on("regions-load").set_input_files({"name": "RoiSet.zip", "mimeType": "application/zip", "buffer": content})
    seen.until(MADE.format(2))


def test_line_profile_is_the_row_of_the_picture(seen):
    seen.scrub(3)
    seen.on("tool-line").click()
    seen.page.mouse.move(*seen.at(10, 20))
    seen.page.mouse.down()
    seen.page.mouse.move(*seen.at(50, 20), steps=4)
    seen.page.mouse.up()
    seen.until("document.getElementById('profile').dataset.values")
    assert json.loads(seen.on("profile").get_attribute("data-values")) == radiance(3)[20, 10:51].astype(float).tolist()
    assert point(seen, "profile", 0.5).startswith("distance 20 px: ")


def test_mean_over_time_is_a_layer_that_can_be_probed(seen):
    seen.on("over-time").click()
    seen.until("document.getElementById('layer').value === 'radiance_mean'")
    seen.page.mouse.move(*seen.at(33, 17))
    seen.until("document.querySelector('[data-testid=probe-radiance_deviation]')")
    stack = np.stack([radiance(n)[17, 33].astype(float) for n in range(FRAMES)])
    expected = {"mean": stack.mean(), "deviation": stack.std(), "maximum": stack.max()}
    assert {word: seen.number(f"probe-radiance_{word}") for word in expected} == pytest.approx(expected)
    seen.on("layer").select_option("radiance")


def test_celsius_is_told_beside_kelvin(seen):
    seen.page.mouse.move(*seen.at(40, 30))
    seen.until("document.querySelector('[data-testid=probe-apparent_temperature_celsius]')")
    kelvin, celsius = (seen.number(f"probe-apparent_temperature{end}") for end in ("", "_celsius"))
    assert celsius == pytest.approx(kelvin - 273.15, abs=1e-3)
    seen.on("layer").select_option("apparent_temperature_celsius")
    seen.until("seaglint.state.panes.a.scale.unit === '°C'")


def test_limits_are_dragged_on_the_colour_bar(seen):
    seen.until("seaglint.state.panes.a.barPlace")
    low, high = seen.page.evaluate("[0, 4].map((i) => seaglint.state.panes.a.scale.values[i])")
    canvas = seen.on("canvas-a").bounding_box()
    left, width, top = seen.page.evaluate("(({ left, width, y }) => [left, width, y])(seaglint.state.panes.a.barPlace)")
    bar = (canvas["x"] + left, width, canvas["y"] + top)
    seen.page.mouse.move(bar[0] + 2, bar[2] + 5)
    seen.page.mouse.down()
    seen.page.mouse.move(bar[0] + 2 + 0.25 * bar[1], bar[2] + 5, steps=5)
    seen.page.mouse.up()
    moved = low + 0.25 * (high - low)
    seen.until(f"Math.abs(seaglint.state.panes.a.scale.values[0] - {moved}) < {0.01 * (high - low)}")
    assert seen.on("scaling").input_value() == "limits"
    assert float(seen.on("high").input_value()) == pytest.approx(high, rel=1e-3)


def test_limits_are_dragged_on_the_histogram(seen):
    seen.drag((5, 5), (50, 40))
    seen.until(MADE.format(1))
    seen.until("seaglint.plots.histogram.data?.limits && seaglint.plots.histogram.x")
    seen.on("histogram").scroll_into_view_if_needed()
    box = seen.on("histogram").bounding_box()
    low, high, left = seen.page.evaluate("(({ data, x }) => [...data.limits, x(data.limits[0])])(seaglint.plots.histogram)")
    aim = low + 0.3 * (high - low)
    x, y = box["x"] + max(left, 54), box["y"] + 40
    seen.page.mouse.move(x, y)
    seen.page.mouse.down()
    seen.page.mouse.move(box["x"] + seen.page.evaluate(f"seaglint.plots.histogram.x({aim})"), y, steps=5)
    assert seen.on("histogram-read").text_content().startswith("limits of the scale: ")
    seen.page.mouse.up()
    seen.until(f"Math.abs(seaglint.state.panes.a.scale.values[0] - {aim}) < {0.02 * (high - low)}")
    assert seen.on("scaling").input_value() == "limits"
    assert seen.page.evaluate("seaglint.state.panes.a.scale.values[4]") == pytest.approx(high, rel=1e-3)


def test_regions_are_moved_and_resized_by_pointer(seen):
    seen.drag((10, 8), (29, 27))
    seen.until(MADE.format(1))
    pull(seen, (14, 8), (20, 13))  # its upper side, away from the handles
    assert numbers(seen) == [16, 13, 20, 20]
    pull(seen, (36, 33), (50, 40))  # its lower right corner
    assert numbers(seen) == [16, 13, 34, 27]
    pull(seen, (16, 26.5), (4, 20))  # the middle of its left side moves that side alone
    assert numbers(seen) == [4, 13, 46, 27]
    expected = radiance(0)[13:40, 4:50].mean(dtype=float)
    seen.until(f"Math.abs(document.querySelector('[data-testid=regions-mean]')?.dataset.value - {expected}) < 1e-9")
    pull(seen, (9, 13), (-30, -30))
    assert numbers(seen) == [0, 0, 46, 27]  # not out of the picture
    seen.on("tool-polygon").click()
    for corner in [(50, 30), (60, 32), (55, 44), (50, 30)]:
        seen.page.mouse.click(*seen.at(*corner))
    seen.until(MADE.format(2))
    seen.on("tool-pan").click()
    first = numbers(seen, 1)
    pull(seen, (first[2], first[3]), (62, 40))
    assert numbers(seen, 1) == pytest.approx([*first[:2], 62, 40, *first[4:]], abs=0.11)


def test_regions_are_moved_resized_and_removed_by_keys(seen):
    seen.drag((10, 8), (29, 27))
    seen.until(MADE.format(1))
    seen.on("region-choose").focus()
    for key in ("ArrowRight", "ArrowRight", "Control+ArrowDown", "Shift+ArrowLeft", "Shift+Control+ArrowDown"):
        seen.page.keyboard.press(key)
    assert numbers(seen) == [12, 18, 19, 30]
    expected = radiance(0)[18:48, 12:31].mean(dtype=float)
    seen.until(f"Math.abs(document.querySelector('[data-testid=regions-mean]')?.dataset.value - {expected}) < 1e-9")
    assert seen.page.evaluate("document.activeElement.dataset.testid") == "region-choose"
    assert seen.page.evaluate("seaglint.state.frame") == 0
    seen.page.keyboard.press("Delete")
    seen.until("seaglint.state.regions.length === 0 && document.getElementById('regions').hidden")


def test_a_polygon_drawn_by_hand_is_loaded_counted_and_resized(seen):
    region = star(3000)
    seen.on("regions-load").set_input_files({"name": "r.csv", "mimeType": "text/csv", "buffer": to_csv([region]).encode()})
    seen.until(MADE.format(1))
    assert seen.number("regions-mean") == pytest.approx(radiance(0)[region.mask(ROWS, COLUMNS)].mean(dtype=float))
    seen.on("threshold-on").check()
    seen.until("document.getElementById('threshold-table').dataset.sigma")
    assert seen.on("threshold-count").count() == 1
    left, right = min(region.numbers[::2]), max(region.numbers[::2])
    pull(seen, (right, 24), (left + (right - left) / 2, 24))  # by its box: the middle of its right side
    assert max(numbers(seen)[::2]) == pytest.approx(left + (right - left) / 2, abs=1.1)


def test_a_pixel_in_time_shows_its_progress_and_is_cancelled(chromium, tmp_path):
    np.lib.format.open_memmap(tmp_path / "long.npy", "w+", np.float32, (60_000, 128, 160))[::500] = 1.0
    viewer, seen = visit(chromium, tmp_path / "long.npy")
    seen.page.mouse.click(*seen.at(12, 9))
    seen.on("trace-cancel").click()
    seen.until("document.getElementById('trace-read').textContent === 'cancelled; click a pixel to read it'")
    seen.page.mouse.click(*seen.at(14, 9))
    seen.page.mouse.click(*seen.at(16, 9))  # given up for this one
    seen.until("JSON.parse(document.getElementById('trace').dataset.values || '[]').length === 60000")
    assert seen.on("trace-where").text_content().startswith("column 16, row 9")
    leave(viewer, seen)


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_every_text_of_the_page_stands_out(chromium, served, theme):
    seen = Seen(chromium, served, color_scheme=theme)
    seen.drag((10, 8), (29, 27))
    seen.until(MADE.format(1))
    seen.on("threshold-on").check()
    seen.page.get_by_text("Save", exact=True).click()
    seen.page.mouse.click(*seen.at(12, 9))
    seen.until("document.getElementById('trace').dataset.values && document.getElementById('threshold-table').dataset.sigma")
    checked, faint = seen.page.evaluate(FAINT_TEXTS, LEAST_CONTRAST)
    assert checked > 80
    assert faint == []
    seen.end()


def test_arrows_move_the_probe_and_shift_grows_a_region(seen):
    seen.scrub(2)
    seen.on("canvas-a").focus()
    for key in ("ArrowRight", "ArrowDown", "ArrowDown"):
        seen.page.keyboard.press(key)
    column, row = COLUMNS // 2 + 1, ROWS // 2 + 2
    seen.until(f"document.getElementById('probe-where').textContent === 'column {column}, row {row}'")
    for key in ("Shift+ArrowRight", "Shift+ArrowRight", "Shift+ArrowDown"):
        seen.page.keyboard.press(key)
    seen.until(MADE.format(1))
    assert seen.page.evaluate("seaglint.state.regions[0].numbers") == [column, row, 3, 2]
    seen.page.keyboard.press("Enter")
    seen.until("document.getElementById('trace').dataset.values")
    assert seen.page.evaluate("seaglint.state.frame") == 2
    seen.page.keyboard.press(".")
    seen.until("seaglint.state.frame === 3")


def test_a_finger_probes_and_marks_a_region_on_a_phone(chromium, store):
    viewer, seen = visit(chromium, store, size=(390, 844), has_touch=True, is_mobile=True)
    assert seen.page.evaluate("document.documentElement.scrollWidth") == 390
    seen.page.touchscreen.tap(*seen.at(40, 30))
    seen.until("document.getElementById('probe-where').textContent === 'column 40, row 30'")
    seen.until("document.querySelector('[data-testid=probe-radiance]')")
    assert seen.number("probe-radiance") == float(radiance(0)[30, 40])
    assert seen.on("probe-line").text_content() == f"column 40, row 30: {float(f'{radiance(0)[30, 40]:.5g}'):g} W m⁻² sr⁻¹"
    sizes = "[...document.querySelectorAll('button')].filter((b) => b.offsetParent).map((b) => Math.min(b.offsetWidth, b.offsetHeight))"
    assert min(seen.page.evaluate(sizes)) >= 40
    for part in ("summary", "label.switch", "input[type=file]"):
        heights = f"[...document.querySelectorAll('{part}')].filter((e) => e.offsetParent).map((e) => e.offsetHeight)"
        assert min(seen.page.evaluate(heights)) >= 40
    seen.on("tool-polygon").tap()
    seen.page.evaluate("scrollTo(0, 0)")
    for corner in [(10, 10), (40, 12), (20, 40), (10, 10)]:
        seen.page.touchscreen.tap(*seen.at(*corner))
    seen.until(MADE.format(1))
    leave(viewer, seen)


def test_a_finger_moves_a_region_of_a_whole_picture(chromium, store):
    viewer, seen = visit(chromium, store, size=(390, 844), has_touch=True, is_mobile=True)
    seen.page.evaluate(
        "seaglint.state.regions.push({ shape: 'rectangle', numbers: [10, 8, 20, 12], name: '1' }); seaglint.state.chosen = 0"
    )
    touch = seen.context.new_cdp_session(seen.page)
    for kind, place in [("touchStart", (25, 8)), ("touchMove", (25, 14)), ("touchMove", (25, 20)), ("touchEnd", None)]:
        points = [] if place is None else [dict(zip("xy", seen.at(*place), strict=True))]
        touch.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})
    assert numbers(seen) == [10, 20, 20, 12]
    assert seen.page.evaluate("scrollY") == 0
    leave(viewer, seen)


def test_a_link_and_a_file_bring_the_view_back(chromium, served, seen, tmp_path):
    seen.scrub(6)
    seen.on("layer").select_option("apparent_temperature_celsius")
    seen.on("colours").select_option("perceptual")
    seen.drag((5, 4), (24, 13))
    seen.page.mouse.click(*seen.at(30, 20))
    seen.page.mouse.wheel(0, -300)
    seen.until("location.hash.includes('rectangle+5+4+20+10') && location.hash.includes('view=') && location.hash.includes('pixel=30+20')")
    fragment = seen.page.evaluate("location.hash")
    other = Seen(chromium, served, fragment=fragment)
    other.until(MADE.format(1))
    other.until("document.getElementById('trace').dataset.values")
    assert other.page.evaluate("'#' + seaglint.fragment()") == fragment
    assert other.page.evaluate("seaglint.state.frame") == 6
    other.page.evaluate("(hash) => { location.hash = hash }", fragment.replace("frame=6", "frame=2").replace("a=run.zarr", "a=away.zarr"))
    other.on("message").filter(has_text="away.zarr: is not among the files of this viewer").wait_for()
    other.end()
    seen.page.get_by_text("Save", exact=True).click()
    with seen.page.expect_download() as waiting:
        seen.on("save-state").click()
    third = Seen(chromium, served)
    third.page.get_by_text("Save", exact=True).click()
    third.on("load-state").set_input_files(waiting.value.path())
    third.until(f"'#' + seaglint.fragment() === {json.dumps(fragment)}")
    third.on("load-state").set_input_files({"name": "x.json", "mimeType": "application/json", "buffer": b"[]"})
    third.on("message").filter(has_text="x.json: is no state of this viewer").wait_for()
    third.end()


def test_a_link_to_a_picture_over_time_computes_it(chromium, store):
    viewer, seen = visit(chromium, store, fragment="#a=run.zarr&frame=3&layer=radiance_maximum&pixel=33+17")
    seen.until("document.getElementById('layer').value === 'radiance_maximum'")
    seen.until("document.querySelector('[data-testid=probe-radiance_maximum]')")
    assert seen.number("probe-radiance_maximum") == max(float(radiance(n)[17, 33]) for n in range(FRAMES))
    leave(viewer, seen)


def test_theme_follows_the_system_until_it_is_switched(chromium, served):
    ground = "getComputedStyle(document.body).backgroundColor"
    seen = Seen(chromium, served, color_scheme="light")
    assert seen.page.evaluate(ground) == "rgb(244, 245, 246)"
    seen.page.emulate_media(color_scheme="dark")
    seen.until(f"{ground} === 'rgb(21, 24, 27)'")
    seen.page.locator("[data-theme-choice]").select_option("light")
    assert seen.page.evaluate(ground) == "rgb(244, 245, 246)"
    seen.page.reload()
    seen.until("window.seaglint && seaglint.state.panes.a && seaglint.state.panes.a.drawn > 0")
    assert seen.page.evaluate(ground) == "rgb(244, 245, 246)"
    seen.end()


def test_narrow_browser_one_pixel_row_and_gaps_are_drawn_or_said(chromium, tmp_path):
    values = np.random.default_rng(5).normal(280.0, 1.0, (20, 6, 8))
    values[3:5, 2, 2] = np.nan
    values[:, 3, 3] = values[6] = np.nan
    values[9, 2, 4] = np.inf
    np.save(tmp_path / "gaps.npy", values)
    np.save(tmp_path / "row.npy", values[:1, :1])
    viewer, seen = visit(chromium, tmp_path / "gaps.npy", tmp_path / "row.npy", size=(320, 640))
    seen.on("source-b").select_option("")
    seen.until("seaglint.state.b === null && seaglint.state.panes.a.levels")
    assert seen.page.evaluate("document.documentElement.scrollWidth") == 320
    seen.page.mouse.click(*seen.at(2, 2))
    seen.until("document.getElementById('trace-read').textContent === '3 of 20 values are missing: gaps'")
    seen.page.mouse.click(*seen.at(3, 3))
    seen.until("document.getElementById('trace-read').textContent === 'no value in any of them'")
    seen.drag((1, 1), (6, 4))
    seen.until(MADE.format(1))
    seen.on("threshold-on").check()
    seen.scrub(6)
    seen.until("document.getElementById('threshold-table').textContent === 'frame 6: no pixel of it has a value; choose another frame'")
    seen.until("document.getElementById('region-where').textContent === 'frame 6: no pixel of it has a value; choose another frame'")
    assert seen.page.evaluate("document.getElementById('message').hidden")
    seen.scrub(9)
    seen.until(MADE.format(1))
    seen.on("over-time").click()
    seen.until("document.getElementById('layer').value === 'value_mean'")
    seen.on("source-a").select_option(label="row.npy")
    seen.until("seaglint.state.meta.a.rows === 1 && seaglint.state.panes.a.levels?.length === 8")
    seen.page.evaluate("scrollTo(0, 0)")
    seen.page.mouse.click(*seen.at(4, 0))
    seen.until("JSON.parse(document.getElementById('trace').dataset.values).length === 1")
    seen.drag((1, 0), (6, 0))
    seen.until(MADE.format(1))
    assert seen.page.evaluate("document.documentElement.scrollWidth") == 320
    leave(viewer, seen)


def test_a_server_that_stops_is_told(chromium, store):
    viewer, seen = visit(chromium, store)
    viewer.end()
    seen.on("message").filter(has_text="the viewer does not answer; is 'seaglint view' still running?").wait_for()
    seen.end()


def test_long_computations_are_cancelled(chromium, tmp_path):
    np.lib.format.open_memmap(tmp_path / "long.npy", "w+", np.float32, (20_000, 128, 160))[::500] = 1.0
    viewer, seen = visit(chromium, tmp_path / "long.npy")
    seen.on("over-time").click()
    seen.on("over-time-cancel").click()
    seen.until("document.getElementById('over-time-told').textContent === 'cancelled'")
    leave(viewer, seen)
