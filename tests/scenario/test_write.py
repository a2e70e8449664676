"""The text of a scenario reads as the scenario, and says no more than it must."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest

from seaglint.scenario.load import load_scenario, parse_scenario
from seaglint.scenario.model import Scenario
from seaglint.scenario.presets import PRESETS, SENSORS
from seaglint.scenario.text.toml_writing import differing, scenario_toml

EXAMPLES = sorted(
    path for path in (Path(__file__).parents[2] / "examples").glob("*.toml") if "[ensemble]" not in path.read_text(encoding="utf-8")
)


@pytest.mark.parametrize("name", PRESETS)
def test_presets_come_back(name):
    scenario = Scenario.model_validate(PRESETS[name].values, context={"files": False})
    text = tomllib.loads(scenario_toml(scenario))
    assert Scenario.model_validate(text, context={"files": False}) == scenario


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_examples_come_back(path, tmp_path):
    scenario = load_scenario(path)
    copy = tmp_path / "copy.toml"
    copy.write_text(scenario_toml(scenario, tmp_path), encoding="utf-8")
    assert load_scenario(copy) == scenario
    assert copy.stat().st_size < path.stat().st_size + 200


@pytest.mark.parametrize("name", SENSORS)
def test_sensors_come_back_without_what_their_optics_tell(name):
    from seaglint.scenario.presets import with_sensor

    scenario = parse_scenario(with_sensor({}, name))
    text = tomllib.loads(scenario_toml(scenario))
    assert parse_scenario(text) == scenario
    assert "fov_deg" not in text["sensor"] or "fov_deg" in SENSORS[name].sensor


def test_only_what_differs_is_said():
    assert differing(parse_scenario({})) == {}
    given = {"wind": {"speed_m_s": "10 m/s", "from_deg": 230}, "sea": {"slopes": {"kind": "flat"}}, "seed": 1, "band": {"min_um": 3.5}}
    assert differing(parse_scenario(given)) == {"wind": {"speed_m_s": 10.0}, "sea": {"slopes": {"kind": "flat"}}}


def test_date_and_place_bring_no_sun():
    given = {"time": {"utc": "2026-06-21T17:30:00Z"}, "place": {"latitude_deg": 40, "longitude_deg": -70}}
    text = scenario_toml(parse_scenario(given))
    assert "[sun]" not in text
    assert "utc = 2026-06-21T17:30:00Z" in text
    assert parse_scenario(tomllib.loads(text)) == parse_scenario(given)


@pytest.mark.parametrize("name", ['a "quoted" \\ name', "two\nlines\tand\x7f", "Ærø °"])
def test_any_name_comes_back(name):
    shape = {"kind": "union", "parts": [{"kind": "sphere", "radius_m": 2}, {"kind": "box", "size_m": [1, 2, 3]}]}
    item = {"name": name, "shape": shape, "temperature_k": 300, "north_m": -500, "height_m": 5}
    keyframes = [{"time_s": 0, "east_m": 1, "north_m": 2}, {"time_s": 4, "east_m": 3, "north_m": 2}]
    scenario = parse_scenario({"objects": [item, {"name": "b", "preset": "buoy", "keyframes": keyframes}]})
    text = scenario_toml(scenario)
    assert parse_scenario(tomllib.loads(text)) == scenario
    assert "semi_axes" not in text  # of the preset, which brings its shape


def test_files_are_named_from_the_folder_of_the_text(tmp_path):
    (tmp_path / "air.csv").touch()
    scenario = parse_scenario({"atmosphere": {"source": "file", "path": "air.csv"}}, base=tmp_path)
    assert 'path = "air.csv"' in scenario_toml(scenario, tmp_path)
    away = tmp_path / "away"
    away.mkdir()
    assert parse_scenario(tomllib.loads(scenario_toml(scenario, away)), base=away) == scenario
