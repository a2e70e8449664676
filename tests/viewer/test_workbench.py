"""The workbench without a browser: form, draft, pictures, plan and day."""

from __future__ import annotations

import asyncio
import base64
import io
import re
import threading
import tomllib
from datetime import date
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from seaglint.base.errors import Mistake, ScenarioError, SeaglintError
from seaglint.scenario.keys import key_paths
from seaglint.scenario.load import load_scenario, parse_scenario
from seaglint.scenario.presets import PRESETS
from seaglint.scenario.sun import sun_position
from seaglint.viewer.workbench.bench import Redraw
from seaglint.viewer.workbench.scenario_draft import Draft, Field, Group, file_keys, form, keys_of, value_of
from seaglint.viewer.workbench.small_pictures import Order, Overtaken, Painter, PreviewPicture, reduced
from seaglint.viewer.workbench.sun_card import clock, dated, day_of, day_svg
from seaglint.viewer.workbench.svg_pictures import map_svg, plan, plan_svg, reach, rings, value_at

EXAMPLES = Path(__file__).parents[2] / "examples"
HOSTILE = "<script>alert(1)</script>"


def _fields(group, above=()):
    for entries in group.variants.values():
        for entry in entries:
            if isinstance(entry, Group):
                yield from _fields(entry, (*above, entry.name))
                if entry.tag:
                    yield (*above, entry.name, entry.tag), None
            else:
                yield (*above, entry.name), entry


# --- form


def test_every_key_has_a_field_or_stands_in_a_list_of_tables():
    found = dict(_fields(form()))
    tables = tuple(".".join(keys) + "." for keys, entry in found.items() if entry is not None and entry.kind == "tables")
    missing = {path for path in key_paths() if tuple(path.split(".")) not in found and not path.startswith(tables)}
    assert not missing


def test_fields_show_defaults_choices_and_hints():
    found = dict(_fields(form()))
    assert found["wind", "speed_m_s"].placeholder == "7.0"
    assert found["sensor", "pixels"].placeholder == "[512, 256]"
    assert found["band", "min_um"].placeholder == "3.5"
    assert found["time", "utc"].placeholder == "required"
    assert found["sensor", "projection"].choices == ("equal-angle", "pinhole")
    assert found["sea", "temperature_k"].hint == "skin temperature of the sea"
    assert found["sensor", "detector", "quantum_efficiency_file"].kind == "file"
    assert "sounding" in file_keys()


@pytest.mark.parametrize(
    ("kind", "text", "value"),
    [
        ("number", "5 kn", "5 kn"),
        ("number", '"5 kn"', "5 kn"),
        ("number", "1e3", 1000.0),
        ("number", "7", 7),
        ("number", "", None),
        ("list", "640, 512", [640, 512]),
        ("list", "[5 deg, 0.1 rad]", ["5 deg", "0.1 rad"]),
        ("text", "123", "123"),
        ("text", "2026-06-21T17:30:00Z", "2026-06-21T17:30:00Z"),
        ("tables", "[{ time_s = 0 },\n { time_s = 1 }]", [{"time_s": 0}, {"time_s": 1}]),
    ],
)
def test_text_means_what_it_means_in_the_file(kind, text, value):
    assert value_of(Field("key", kind), text) == value


def test_tables_that_are_no_toml_say_so():
    with pytest.raises(ScenarioError, match=r"keyframes: is not valid TOML"):
        value_of(Field("keyframes", "tables"), "[{ time_s = }]")


# --- draft


@pytest.mark.parametrize("name", PRESETS)
def test_a_draft_of_a_preset_is_the_preset(name):
    draft = Draft(preset=name)
    scenario, mistakes = draft.check()
    if PRESETS[name].files:  # there is no folder yet for them
        assert "needs a scenario file" in mistakes[0].text
    else:
        assert scenario == parse_scenario(PRESETS[name].values)


def test_a_file_with_mistakes_opens_and_one_that_is_none_does_not(tmp_path):
    path = tmp_path / "my.toml"
    path.write_text("wind = 5\n[sensor]\nheight_m = -1\nhight = 2\n")
    draft = Draft(path)
    scenario, mistakes = draft.check()
    assert scenario is None
    assert {keys_of(mistake, draft.raw) for mistake in mistakes} == {("wind",), ("sensor", "height_m"), ("sensor", "hight")}
    draft.put(("wind", "speed_m_s"), 5)
    draft.put(("sensor", "hight"), None)
    draft.put(("sensor", "height_m"), None)
    assert draft.check()[0] == parse_scenario({"wind": {"speed_m_s": 5}})
    with pytest.raises(ScenarioError, match="no such file"):
        Draft(tmp_path / "none.toml")
    path.write_text("wind = \n")
    with pytest.raises(ScenarioError, match="is not valid TOML"):
        Draft(path)


def test_units_that_were_typed_are_kept(tmp_path):
    draft = Draft()
    draft.put(("wind", "speed_m_s"), "18 kn")
    draft.put(("sensor", "fov_deg"), ["0.2 rad", 6])
    draft.put(("sea", "temperature_k"), "288.15 K")
    scenario, mistakes = draft.check()
    assert mistakes == ()
    text = draft.toml(scenario)
    assert 'speed_m_s = "18 kn"' in text
    assert 'fov_deg = ["0.2 rad", 6.0]' in text
    assert "[sea]" not in text  # the default
    assert parse_scenario(tomllib.loads(text)) == scenario


def test_mistakes_are_worded_as_the_program_words_them():
    draft = Draft()
    draft.put(("sensor", "height_m"), "-5 ft")
    with pytest.raises(ScenarioError) as told:
        parse_scenario(draft.raw)
    scenario, mistakes = draft.check()
    assert scenario is None
    assert mistakes[0].text == told.value.mistakes[0].text
    assert keys_of(mistakes[0], draft.raw) == ("sensor", "height_m")
    draft.put(("sensor", "height_m"), None)
    assert draft.check()[0] == parse_scenario({})


def test_text_that_cannot_be_read_is_a_mistake_until_it_is_mended():
    draft, entry, keys = Draft(), Field("layers", "tables"), ("render", "layers")
    draft.take(entry, keys, "[{ time_s = }]")
    draft.take(Field("from_deg", "number"), ("wind", "from_deg"), "90")  # another field leaves it as it is
    scenario, mistakes = draft.snapshot().check()
    assert scenario is None
    assert keys_of(mistakes[0], draft.raw) == keys
    assert "layers: is not valid TOML" in mistakes[0].text
    draft.take(entry, keys, '["range"]')
    assert draft.check()[0].render.layers == ("range",)
    draft.take(entry, keys, "[{")
    draft.forget(("render",))
    assert draft.check()[1] == ()


@pytest.mark.parametrize(
    ("key", "keys"),
    [
        ("render.layers[0]", ("render", "layers", 0)),
        ("objects[1].east_m", ("objects", 1, "east_m")),
        ("objects ('a ferry').shape", ("objects", 1, "shape")),
        ("objects ('gone')", ("objects",)),
        ("", ()),
    ],
)
def test_mistakes_find_their_field(key, keys):
    raw = {"objects": [{"name": "b"}, {"name": "a ferry"}]}
    assert keys_of(Mistake(key, None, None, "text"), raw) == keys


@pytest.mark.parametrize("value", ["/etc/passwd", "../secret.csv", "link.csv", "a/../../secret.csv", "\0"])
@pytest.mark.parametrize("deep", [False, True])
def test_no_field_reaches_files_outside_the_folder(tmp_path, value, deep):
    (tmp_path / "secret.csv").write_text("height_m\n")
    folder = tmp_path / "mine"
    folder.mkdir()
    (folder / "link.csv").symlink_to(tmp_path / "secret.csv")
    (folder / "my.toml").write_text("seed = 3\n")
    draft = Draft(folder / "my.toml")
    if deep:
        draft.put(("objects",), [{"name": "a", "shape": {"kind": "union", "parts": [{"kind": "mesh", "path": value}]}}])
    else:
        draft.put(("atmosphere",), {"source": "file", "path": value})
    scenario, mistakes = draft.check()
    assert scenario is None
    assert "is not in the scenario's folder" in mistakes[0].text
    assert Draft().folder is None


def test_files_beside_the_scenario_and_those_it_named_itself_are_taken(tmp_path):
    away = tmp_path / "away.csv"
    away.write_text("time_s,height_m\n0,30\n4,30\n")
    folder = tmp_path / "mine"
    folder.mkdir()
    (folder / "near.csv").write_text(away.read_text())
    (folder / "my.toml").write_text(f'[platform]\ntrack = "{away}"\n')
    draft = Draft(folder / "my.toml")
    assert draft.check()[1] == ()
    draft.put(("platform", "track"), "near.csv")
    scenario, mistakes = draft.check()
    assert mistakes == ()
    assert 'track = "near.csv"' in draft.toml(scenario)


def test_saving_replaces_the_file_and_sees_others_changes(tmp_path):
    path = tmp_path / "my.toml"
    path.write_text("# mine\n[wind]\nspeed_m_s = 5\n")
    draft = Draft(path)
    draft.put(("wind", "from_deg"), 10)
    scenario, _ = draft.check()
    assert not draft.changed_outside
    path.write_text("[wind]\nspeed_m_s = 6\n")
    assert draft.changed_outside
    assert draft.save(scenario) == path
    assert not draft.changed_outside
    assert load_scenario(path) == scenario
    assert draft.commands() == ["seaglint render my.toml -o my.zarr --preview", "seaglint mean my.toml -o my_mean.nc --preview"]
    with pytest.raises(SeaglintError, match="no scenario file was opened"):
        Draft().save(scenario)


def test_commands_quote_names_of_files(tmp_path):
    path = tmp_path / "a b; rm.toml"
    path.write_text("")
    assert Draft(path).commands()[0] == "seaglint render 'a b; rm.toml' -o 'a b; rm.zarr' --preview"


# --- pictures


@pytest.mark.parametrize("pixels", [[512, 256], [8, 4], [65536, 1], [640, 512]])
def test_small_pictures_keep_the_field_of_view(pixels):
    scenario = parse_scenario({"sensor": {"pixels": pixels, "pixel_shape": "any", "fov_deg": [10, 8]}, "render": {"tile_size": 4096}})
    small = reduced(scenario, 1000)
    assert small.sensor.fov_deg == scenario.sensor.fov_deg
    assert small.sensor.pixels[0] * small.sensor.pixels[1] <= 1010
    assert small.render.tile_size == 128
    assert small.sensor.detector is None


def _picture(rows=4, columns=8, grid=True):
    values = np.arange(rows * columns, dtype=np.float32).reshape(rows, columns)
    edges = ((170.0, 186.0), (4.0, -4.0)) if grid else (None, None)
    return PreviewPicture(values, 280 + values, *edges, (512, 256), 0.5)


def test_the_map_holds_the_pixels_top_row_first_and_round_angles():
    svg = ElementTree.fromstring(map_svg(_picture()))
    images = [element for element in svg.iter() if element.tag.endswith("image")]
    from PIL import Image

    pixels = np.asarray(Image.open(io.BytesIO(base64.b64decode(images[0].get("href").split(",")[1]))))
    assert pixels.shape == (4, 8, 3)
    brightness = pixels.sum(axis=2)
    assert brightness[0, 0] < brightness[1, 0] < brightness[3, 7]
    texts = [element.text for element in svg.iter() if element.tag.endswith("text")]
    assert {"azimuth [deg]", "elevation [deg]", "180", "0", "\u22122"} <= set(texts)
    assert any("W m" in text for text in texts)
    assert "K" in "".join(
        element.text for element in ElementTree.fromstring(map_svg(_picture(), "apparent_temperature")).iter() if element.text
    )
    assert "column [px]" in map_svg(_picture(grid=False))


@pytest.mark.parametrize(
    ("pixel", "where"), [((0, 0), "azimuth 171.00°, elevation 3.00°"), ((3, 7), "azimuth 185.00°, elevation \u22123.00°")]
)
def test_the_map_s_values_are_those_of_its_pixels(pixel, where):
    picture = _picture()
    picture.radiance[1, 1] = picture.temperature[1, 1] = np.nan
    svg = ElementTree.fromstring(map_svg(picture))
    image = next(element for element in svg.iter() if element.tag.endswith("image"))
    size = [float(number) for number in svg.get("viewBox").split()[2:]]
    box = [float(image.get(name)) for name in ("x", "y", "width", "height")]

    def at(row, column):
        return (box[0] + (column + 0.5) / 8 * box[2]) / size[0], (box[1] + (row + 0.5) / 4 * box[3]) / size[1]

    value = float(picture.radiance[pixel])
    assert value_at(picture, "radiance", *at(*pixel)) == f"{where}: {value:g} W m⁻² sr⁻¹, {280 + value:.2f} K ({6.85 + value:.2f} °C)"
    assert value_at(picture, "radiance", *at(1, 1)).endswith(": no value")
    assert value_at(picture, "radiance", 0.0, 0.5) == ""
    assert value_at(_picture(grid=False), "radiance", *at(0, 7)).startswith("column 480, row 32: ")


class _Slow(Painter):
    """Paints what it is told to, when it is told to."""

    def __init__(self):
        super().__init__()
        self.begun, self.go, self.done = threading.Event(), threading.Semaphore(0), []

    def paint(self, order):
        if order.dropped.is_set():
            raise Overtaken
        self.begun.set()
        assert self.go.acquire(timeout=600)
        self.done.append((order.job, order.scenario.seed))
        if order.scenario.seed == 13:
            raise SeaglintError("no luck")
        return _picture()


def _redrawn(steps):
    async def run():
        painter, shown, tasks = _Slow(), [], []
        redraw = Redraw(painter, lambda job, found: shown.append((job, found)), lambda work: tasks.append(asyncio.ensure_future(work)))
        await steps(redraw, painter)
        for _ in range(8):
            painter.go.release()
        await asyncio.gather(*tasks)
        return painter.done, [(job, found) for job, found in shown if found is not None]

    return asyncio.run(run())


def _scene(seed):
    return parse_scenario({"seed": seed})


def test_a_newer_change_overtakes_an_older():
    async def steps(redraw, painter):
        redraw.want(_scene(1))
        await asyncio.to_thread(painter.begun.wait)
        for seed in (2, 3):
            redraw.want(_scene(seed))
            await asyncio.sleep(0.0)

    done, shown = _redrawn(steps)
    assert done == [("mean", 1), ("mean", 3), ("frame", 3)]  # 2 was never begun, and what 1 began is not shown
    assert [job for job, _ in shown] == ["mean", "frame"]


def test_why_there_is_no_picture_is_shown():
    async def steps(redraw, painter):
        redraw.want(_scene(13))

    _, shown = _redrawn(steps)
    assert shown == [("mean", "no luck"), ("frame", "no luck")]


def test_nothing_is_shown_to_a_page_that_is_gone():
    async def steps(redraw, painter):
        redraw.want(_scene(1))
        await asyncio.to_thread(painter.begun.wait)
        redraw.close()
        redraw.want(_scene(2))

    done, shown = _redrawn(steps)
    assert done == [("mean", 1)]
    assert shown == []


def test_a_process_that_dies_is_told_and_started_anew(monkeypatch):
    painter = Painter()
    try:
        dead = painter._running()
        dead.kill()
        dead.wait()
        with monkeypatch.context() as patched:
            patched.setattr(painter, "_running", lambda: dead)
            with pytest.raises(SeaglintError, match="the next change starts it"):
                painter.paint(Order("mean", _scene(1)))
        assert painter._running() is not dead
    finally:
        painter.stop()


# --- plan and day


def test_the_plan_has_objects_where_they_are():
    scenario = load_scenario(EXAMPLES / "harbour.toml")
    found = plan(scenario)
    assert found.ways["container ship"][0] == pytest.approx([-250.0, -6000.0])
    last = (scenario.sensor.frames - 1) / scenario.sensor.frame_rate_hz
    speed = 14 * 1852 / 3600
    step = found.ways["container ship"][-1] - found.ways["container ship"][0]
    assert step == pytest.approx(speed * last * np.array([np.sin(np.radians(75)), np.cos(np.radians(75))]), rel=1e-9)
    assert found.horizon == pytest.approx(np.sqrt(2 * 7 / 6 * 6.371e6 * 12), rel=2e-3)
    assert found.nearest == pytest.approx(12 / np.tan(np.radians(2.6)), rel=5e-3)
    far = reach(found, False)
    svg = ElementTree.fromstring(plan_svg(found))
    places = [element for element in svg.iter() if element.get("class") == "place"]
    assert len(places) == 1 + len(scenario.objects)
    place = next(element for element in places if element[0].text == "container ship")
    assert float(place.get("cx")) == pytest.approx(160 - 134 * 250 / far, abs=0.1)  # west is left
    assert float(place.get("cy")) == pytest.approx(160 + 134 * 6000 / far, abs=0.1)  # south is below
    assert 'class="horizon"' not in plan_svg(found)
    assert 'class="horizon"' in plan_svg(found, whole=True)


def test_names_in_the_plan_are_escaped():
    scenario = parse_scenario({"objects": [{"name": HOSTILE, "preset": "buoy", "north_m": -900}]})
    svg = plan_svg(plan(scenario))
    assert "<script" not in svg
    ElementTree.fromstring(svg)


@pytest.mark.parametrize("far", [25.0, 180.0, 999.0, 6500.0, 41e3])
def test_rings_are_few_and_round(far):
    found = rings(far)
    assert 2 <= len(found) <= 6
    assert max(found) <= far
    assert re.match(r"^[1-9]0*$", f"{found[0]:.0f}")


def test_the_day_has_the_sun_where_the_scenario_has_it():
    given = {"time": {"utc": "2026-06-21T17:30:00Z"}, "place": {"latitude_deg": 36.8, "longitude_deg": -75.9}}
    sun = sun_position(parse_scenario(given))
    day = day_of(date(2026, 6, 21), 36.8, -75.9)
    elevation, azimuth = day.at(17 * 60 + 30)
    assert elevation == pytest.approx(90 - np.degrees(sun.zenith), abs=0.01)
    assert azimuth == pytest.approx(np.degrees(sun.azimuth), abs=0.01)
    # the hour angle of the horizon, cos H = -tan(latitude) tan(declination), with 34' of refraction; noon is 1.9 minutes late in June
    latitude, declination = np.radians(36.8), np.radians(23.44)
    hour_angle = np.arccos(-np.tan(latitude) * np.tan(declination))
    refraction = np.radians(34 / 60) / (np.cos(latitude) * np.cos(declination) * np.sin(hour_angle))
    noon, half = 720 + 4 * 75.9 + 1.9, 4 * np.degrees(hour_angle + refraction)
    (rise,), (fall,) = day.risings()
    assert rise == pytest.approx(noon - half, abs=2.0)
    assert fall == pytest.approx((noon + half) % 1440, abs=2.0)
    assert day.words(0).startswith("00:00 UTC: elevation ")
    assert "elevation \u2212" in day_of(date(2026, 6, 21), 36.8, 104.1).words(17 * 60 + 30)
    assert clock(rise) in ("09:46", "09:47", "09:48")
    ElementTree.fromstring(day_svg(day, 1050))


def test_the_day_of_a_sun_at_the_zenith_has_it_there():
    changed, _ = dated(parse_scenario({"sun": {"zenith_deg": 0.0, "azimuth_deg": 0.0}}))
    moment, place, sun = changed.time.utc, changed.place, sun_position(changed)
    day = day_of(moment.date(), place.latitude_deg, place.longitude_deg)
    elevation, _ = day.at(moment.hour * 60 + moment.minute + moment.second / 60)
    assert elevation == pytest.approx(90 - np.degrees(sun.zenith), abs=0.02)
    assert elevation > 89.95
    exact = sun_position(parse_scenario({"time": {"utc": moment.replace(second=0, microsecond=0)}, "place": place.model_dump()}))
    elevation, azimuth = day.at(moment.hour * 60 + moment.minute)
    assert elevation == pytest.approx(90 - np.degrees(exact.zenith), abs=1e-3)
    assert azimuth == pytest.approx(np.degrees(exact.azimuth), abs=0.1)
