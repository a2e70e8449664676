"""A sensor afloat: pictures from poses that ride on the same waves as the picture shows."""

from __future__ import annotations

import numpy as np
import pytest

from seaglint.objects.body import Placement
from seaglint.objects.floating import Afloat
from seaglint.objects.motion import Rest
from seaglint.scenario.load import parse_scenario
from seaglint.studies.build import scenario_physics
from seaglint.studies.build.bodies import bodies
from seaglint.studies.sequence.render_sequence import prepare_sequence

SCENARIO = {
    "sensor": {"pixels": [24, 16], "fov_deg": [12, 8], "elevation_deg": -3, "frames": 5, "frame_rate_hz": 5.0},
    "platform": {"floats": True, "waterline_m": [2, 4], "heading_deg": 0},
    "wind": {"speed_m_s": 8},
    "sea": {"shortest_wave_m": 8.0},
    "render": {"tile_size": 64},
    "atmosphere": {"source": "none"},
    "objects": [{"name": "buoy", "preset": "buoy", "north_m": -600}],
}


@pytest.fixture(scope="module")
def scenario():
    return parse_scenario(SCENARIO)


def test_frames_are_taken_from_the_waves(scenario):
    found = prepare_sequence(scenario)
    image = found.at(0.4).radiance
    assert np.isfinite(image).all()
    assert np.array_equal(image, prepare_sequence(scenario).at(0.4).radiance)
    poses = found.layout.poses
    assert np.ptp(poses["sensor_height"]) > 0.005
    assert np.ptp(poses["sensor_roll"]) > 0.05
    pose = found.track.at(0.4)
    assert poses["sensor_elevation"][2] == pytest.approx(np.degrees(pose.attitude.elevation))
    waves = scenario_physics.sea(scenario, scenario_physics.slopes(scenario)).waves
    assert scenario_physics.track(scenario, waves).at(0.4) == pose
    assert scenario_physics.track(scenario).at(0.4).height == 30.0  # without waves the flat sea's


def test_a_buoy_and_a_sensor_at_one_place_heave_alike(scenario):
    waves = scenario_physics.sea(scenario, scenario_physics.slopes(scenario)).waves
    low = scenario.sensor.model_copy(update={"height_m": 3.0})  # a mast that leans little
    here = scenario.model_copy(update={"objects": (scenario.objects[0].model_copy(update={"north_m": 4.0}),), "sensor": low})
    one, sensor = bodies(here, waves)[0].motion, scenario_physics.track(here, waves)
    buoy = Afloat(Rest(Placement(np.array([0.0, 0.0, 0.0]), np.eye(3))), one.swell, np.zeros(2), np.array([1.0, 2.0]))
    for t in (0.0, 0.4, 0.8):
        at = buoy.at(t)
        assert sensor.at(t).height == pytest.approx(at.position[2] + 3.0 * at.rotation[2, 2], abs=0.02)
