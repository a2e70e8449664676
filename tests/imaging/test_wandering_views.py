"""Every way of seeing a sea whose tiles wander sees the same sea."""

import numba
import numpy as np
import pytest
from render_scenes import WarmSky, camera, elfouhaily, sea_view, shown, swept_scene
from view_scenes import COARSE, SLOPES, WIND, attitude, imager, likeness, moving, prepared_view

from seaglint.base.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.base.conventions import horizon_range
from seaglint.imaging.rays import above_sphere, mean_arc
from seaglint.scenario.load import parse_scenario
from seaglint.studies.build import scenario_physics


@pytest.fixture(scope="module")
def warm_sky():
    return WarmSky(COARSE)


@pytest.fixture(scope="module")
def waves():
    return elfouhaily(WIND, shortest_wave=8.0, wander=True)


def test_scenarios_have_seas_that_wander():
    small = parse_scenario({"render": {"tile_size": 128}, "sea": {"shortest_wave_m": 8.0}})
    sea = scenario_physics.sea(small, scenario_physics.slopes(small)).waves
    assert len(sea.wander) == len(sea.tiles)


def test_rays_and_the_sweep_see_the_same_sea(warm_sky, waves):
    eye, pointing = imager(columns=48, rows=36), attitude(10.0, -32.0, 15.0)
    swept = shown(prepared_view(warm_sky, eye, pointing, waves, walk_below=np.radians(-60.0)), 1.0)
    walked = shown(prepared_view(warm_sky, eye, pointing, waves, walk_below=np.radians(-10.0)), 1.0)
    still = shown(prepared_view(warm_sky, eye, pointing, elfouhaily(WIND, shortest_wave=8.0), walk_below=np.radians(-10.0)), 1.0)
    assert swept.radiance.mean() == pytest.approx(walked.radiance.mean(), rel=1e-3)
    assert likeness(swept.radiance, walked.radiance) > 0.995
    assert likeness(still.radiance, walked.radiance) < 0.9  # another place of the tiles
    assert swept.radiance.std() == pytest.approx(walked.radiance.std(), rel=0.04)  # three cells of the sweep across a pixel


def test_a_frame_alone_is_that_of_the_sequence(warm_sky, waves):
    several = moving(warm_sky, waves)
    frames = [shown(several, t).radiance for t in (0.0, 0.6)]
    assert shown(moving(warm_sky, waves), 0.6).radiance.tobytes() == frames[1].tobytes()


def test_a_moving_sensor_sees_at_each_instant_what_a_standing_one_there_sees(warm_sky, waves):
    """The air is that of a height up to 2 % lower, the geometry exact."""
    time = 0.62
    way = moving(warm_sky, waves)
    pose = way.track.at(time)
    still = shown(
        prepared_view(warm_sky, way.imager, pose.attitude, waves, height=pose.height, place=(pose.east, pose.north)), time
    ).radiance
    found = shown(way, time).radiance
    assert found.mean() == pytest.approx(still.mean(), rel=1e-3)
    assert likeness(found, still) > 0.98  # other columns of the sweep


def test_a_place_of_the_sea_looks_the_same_from_anywhere(warm_sky, waves):
    """Straight down on a place a tile and a half away: rays read the displacement of the place they meet, not of the sensor."""
    eye = imager(width=6.0, height=6.0, columns=24, rows=24)
    aside, height = 300.0 * np.tan(np.radians(20.0)), 300.0
    below = shown(prepared_view(warm_sky, eye, attitude(0.0, -89.99), waves, height=height, place=(650.0, 400.0)), 0.0).radiance
    slanted = shown(prepared_view(warm_sky, eye, attitude(0.0, -70.0), waves, height=height, place=(650.0, 400.0 - aside)), 0.0).radiance
    foot = below.mean(axis=1) - below.mean(), slanted.mean(axis=1) - slanted.mean()
    assert np.corrcoef(*foot)[0, 1] > 0.5


def test_bytes_do_not_depend_on_threads(warm_sky, waves):
    before = numba.get_num_threads()
    if numba.config.NUMBA_NUM_THREADS < 2:
        pytest.skip("needs two threads (NUMBA_NUM_THREADS)")
    picture = swept_scene(sea_view(warm_sky, SLOPES, 30.0), camera(30.0, 0.5, -6.0, 40, width=4.0, columns=32), waves)
    try:
        numba.set_num_threads(1)
        one = shown(picture, 0.7).radiance
        numba.set_num_threads(2)
        assert shown(picture, 0.7).radiance.tobytes() == one.tobytes()
    finally:
        numba.set_num_threads(before)


@pytest.mark.kernel
@pytest.mark.parametrize("depression_deg", [90.0, 35.0, 3.0, 0.2])
def test_rays_meet_the_mean_sea(depression_deg):
    eye, run, rise = 30.0, np.cos(np.radians(depression_deg)), -np.sin(np.radians(depression_deg))
    arc = mean_arc(eye, run, rise)
    distance = np.linspace(0.0, 2.0 * horizon_range(eye), 400_001) if depression_deg < 10.0 else np.linspace(0.0, 60.0, 60_001)
    z, arcs, _ = np.array([above_sphere(eye, run, rise, s) for s in distance[:: max(distance.size // 4000, 1)]]).T
    assert arc == pytest.approx(np.interp(0.0, -z[: np.argmin(z) + 1], arcs[: np.argmin(z) + 1]), rel=2e-3, abs=1e-6)


@pytest.mark.kernel
def test_rays_that_miss_the_mean_sea_have_the_arc_of_their_nearest_point():
    assert mean_arc(30.0, 1.0, 0.0) == 0.0
    assert mean_arc(30.0, np.cos(1e-3), -np.sin(1e-3)) == pytest.approx(1e-3 * EFFECTIVE_EARTH_RADIUS, rel=1e-3)
