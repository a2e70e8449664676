"""Turned and moving sensors from the scenario to the store and its picture; what is refused in one line."""

import json

import numpy as np
import pytest

from seaglint.base.errors import ScenarioError
from seaglint.imaging.attitude_scene import TurnedScene
from seaglint.imaging.upright_scene import SweptScene
from seaglint.plot.preview import draw
from seaglint.scenario.load import load_scenario, parse_scenario
from seaglint.store.sequence_store import open_sequence
from seaglint.store.stored_images import directions
from seaglint.studies.build import scenario_physics
from seaglint.studies.file_contents import describe
from seaglint.studies.sequence import memory
from seaglint.studies.sequence.render_sequence import prepare_sequence, render

SENSOR = {"pixels": [12, 8], "fov_deg": [12, 8], "frames": 3, "frame_rate_hz": 2}
KEYFRAMES = [{"time_s": 0, "roll_deg": 5, "east_m": 0}, {"time_s": 1, "roll_deg": -5, "east_m": 10}]


def scenario(sensor=(), **more):
    calm = {"sea": {"resolve_waves": False}, "atmosphere": {"source": "none"}}
    return parse_scenario(calm | {"sensor": SENSOR | dict(sensor)} | more)


@pytest.mark.parametrize(
    ("sensor", "kind"),
    [({}, SweptScene), ({"roll_deg": 0.0}, SweptScene), ({"roll_deg": 1}, TurnedScene), ({"projection": "pinhole"}, TurnedScene)],
)
def test_only_what_the_sweep_cannot_show_is_resampled(sensor, kind):
    assert type(prepare_sequence(scenario(sensor)).scene) is kind


def test_a_turned_image_stores_the_direction_of_every_pixel(tmp_path):
    path = render(scenario({"roll_deg": 20, "projection": "pinhole"}), tmp_path / "x.zarr")
    with open_sequence(path) as stored:
        azimuth, elevation = directions(stored)
        assert stored.azimuth.dims == ("y", "x")
        assert azimuth.shape == elevation.shape == (8, 12)
        # right side down: in what it sees, the right is lower
        assert elevation[4, -1] < elevation[4, 0]
        assert np.all(np.isfinite(stored.radiance))
        draw(stored)
    assert describe(path).as_dict()["elevation_deg"] == [pytest.approx(elevation.max()), pytest.approx(elevation.min())]


def test_a_moving_sensor_stores_where_it_is(tmp_path):
    track = tmp_path / "track.csv"
    track.write_text("time_s,roll_deg,east_m\n0,5,0\n1,-5,10\n")
    here, there = (
        render(scenario(platform=p), tmp_path / f"{i}.zarr") for i, p in enumerate(({"keyframes": KEYFRAMES}, {"track": str(track)}))
    )
    with open_sequence(here) as one, open_sequence(there) as other:
        np.testing.assert_allclose(one.sensor_roll, [5.0, 0.0, -5.0], atol=1e-12)
        np.testing.assert_allclose(one.sensor_east, [0.0, 5.0, 10.0])
        assert "azimuth" not in one.variables
        azimuth, elevation = directions(one, 1)
        np.testing.assert_allclose(elevation[:, 0], elevation[:, -1], atol=1e-9)
        assert azimuth.shape == (8, 12)
        np.testing.assert_array_equal(one.radiance, other.radiance)
        assert json.loads(one.attrs["scenario"])["platform"]["keyframes"][1]["east_m"] == 10.0
        draw(one)
    assert describe(here).as_dict()["frames"] == 3


@pytest.mark.parametrize(
    ("platform", "words"),
    [
        ({}, "platform track and keyframes are both missing"),
        ({"keyframes": [{"time_s": 0, "roll_deg": 1}, {"time_s": 1}]}, "platform.keyframes[1] lacks roll_deg, which other keyframes have"),
        ({"keyframes": [{"time_s": 0, "rol_deg": 1}, {"time_s": 1}]}, "did you mean platform.keyframes[0].roll_deg?"),
        ({"keyframes": [{"time_s": 0, "east_m": float("nan")}, {"time_s": 1}]}, "east_m = nan is not finite"),
        ({"keyframes": KEYFRAMES[:1]}, "1 keyframe; give two or more"),
        ({"keyframes": [KEYFRAMES[0], KEYFRAMES[1] | {"time_s": 0}]}, "keyframes[1]: time = 0 s is not after 0 s of keyframes[0]"),
        ({"keyframes": [KEYFRAMES[0], KEYFRAMES[1] | {"east_m": 2e4}]}, "keyframes[0] to keyframes[1]: the platform jumps at 2e+04 m/s"),
        (
            {"keyframes": [KEYFRAMES[0], KEYFRAMES[1] | {"time_s": 0.9}]},
            "time = 1 s is outside the platform's keyframes, which span 0 to 0.9 s",
        ),
    ],
)
def test_keyframes_that_cannot_be_are_refused_in_one_line(platform, words):
    with pytest.raises(ScenarioError) as error:
        scenario_physics.track(scenario(platform=platform))
    assert words in str(error.value)
    assert "\n" not in str(error.value)


def test_heights_outside_the_table_atmosphere_are_refused():
    keyframes = [{"time_s": 0, "height_m": 3}, {"time_s": 1, "height_m": 0.004}]
    words = r"heights of 0.004 to 3 m leave those of atmosphere.source = 'table'; allowed: 0.01 to 100000 m"
    with pytest.raises(ScenarioError, match=words):
        scenario_physics.track(scenario(platform={"keyframes": keyframes}, atmosphere={"source": "table"}))


def test_the_line_of_the_file_is_named(tmp_path):
    (tmp_path / "t.csv").write_text("# jump\ntime_s,north_m\n0,0\n1,5000\n")
    (tmp_path / "s.toml").write_text('[platform]\ntrack = "t.csv"\n')
    with pytest.raises(ScenarioError, match=r"t\.csv: line 3 to line 4: the platform jumps at 5000 m/s"):
        scenario_physics.track(load_scenario(tmp_path / "s.toml"))


@pytest.mark.parametrize(
    ("sensor", "words"),
    [
        ({"elevation_deg": -90}, "or sensor.projection = 'pinhole'"),
        ({"projection": "pinhole", "fov_deg": [180, 120]}, "sensor.fov_deg = [180, 120] is too wide"),
        ({"projection": "fisheye"}, "is not one of 'equal-angle', 'pinhole'"),
        ({"roll_deg": 400}, "-360 to 360 deg"),
    ],
)
def test_impossible_views_are_refused(sensor, words):
    with pytest.raises(ScenarioError) as error:
        scenario(sensor)
    assert words in str(error.value)


def test_a_grid_of_equal_steps_is_refused_where_there_is_none():
    with pytest.raises(ScenarioError, match="leave no grid of equal steps of azimuth and elevation"):
        scenario_physics.camera(scenario({"roll_deg": 3}))


def test_memory_that_cannot_fit_is_refused_before_anything_is_made(monkeypatch):
    monkeypatch.setattr(memory, "memory_available", lambda: 2_000_000_000)
    big = scenario({"pixels": [24000, 16000], "roll_deg": 1})
    with pytest.raises(ScenarioError, match=r"sensor.pixels = \[24000, 16000\] .* needs about 38\d\.\d GB of memory, and 2.0 GB are free"):
        prepare_sequence(big)
    memory.require_memory(scenario())
    available = memory.memory_available()
    assert available is None or available > 0
