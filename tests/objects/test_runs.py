"""Objects through the pipeline: threads, frames alone, runs taken up again, cameras of all kinds, and the labels of each."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest
from scipy.constants import c, h, k

from seaglint.base.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.base.threads import thread_limit
from seaglint.formats.object_labels import Labels
from seaglint.scenario.load import parse_scenario
from seaglint.studies.sequence.render_sequence import prepare_sequence, render
from seaglint.studies.sequence.sensed_sequence import prepare_sensed

HOT = 400.0
AIR = {"source": "isothermal", "temperature_k": 288.15, "extinction_per_km": 0.1}
CALM = {"sea": {"resolve_waves": False}, "atmosphere": AIR, "sun": {"zenith_deg": 60.0, "azimuth_deg": 180.0}}


def ball(radius=2.0, east=3.0, north=700.0, height=12.0, name="ball", **more):
    shape = {"kind": "sphere", "radius_m": radius}
    place = {"east_m": east, "north_m": north, "height_m": height}
    return {"name": name, "shape": shape, "temperature_k": HOT, "emissivity": 1.0, **place, **more}


WAVY = {
    "seed": 4,
    "sun": {"zenith_deg": 60.0, "azimuth_deg": 180.0},
    "sensor": {"pixels": [32, 24], "fov_deg": [4.0, 3.0], "elevation_deg": -1.8, "azimuth_deg": 0.0, "height_m": 20.0, "frames": 3},
    "sea": {"shortest_wave_m": 4.0},
    "render": {"tile_size": 128, "layers": ["range", "coverage"]},
    "objects": [
        ball(course_deg=90.0, speed_m_s=20.0),
        {"name": "boat", "preset": "small-boat", "east_m": -9.0, "north_m": 500.0},
        {"name": "post", "shape": {"kind": "box", "size_m": [2, 2, 6]}, "temperature_k": 300.0, "east_m": 8, "north_m": 900, "height_m": 2},
    ],
}


@cache
def wavy():
    return prepare_sequence(parse_scenario(WAVY))


def test_bytes_of_pictures_and_truth_do_not_depend_on_threads_or_frames_before():
    found = []
    for threads in (1, None):
        with thread_limit(threads):
            found.append(wavy().images(2))
    with thread_limit(1):
        wavy().images(0)
        found.append(wavy().images(2))
    assert "object_mask" in found[0]
    for name, values in found[0].items():
        assert all(np.asarray(other[name]).tobytes() == np.asarray(values).tobytes() for other in found[1:]), name


def test_a_run_taken_up_again_holds_the_truth_of_one_in_one_go(tmp_path):
    scenario = parse_scenario({**WAVY, **CALM, "objects": WAVY["objects"][:1]})
    render(scenario, tmp_path / "whole.zarr")

    def stop(done, total):
        if done == 1:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        render(scenario, tmp_path / "run.zarr", progress=stop)
    render(scenario, tmp_path / "run.zarr", resume=True)
    whole, run = (list(Labels.of(tmp_path / name)) for name in ("whole.zarr", "run.zarr"))
    assert len(whole) == 3
    for one, other in zip(whole, run, strict=True):
        np.testing.assert_equal(one.values, other.values)  # also where both are not known
        assert np.array_equal(one.mask, other.mask)


def test_the_sea_outside_masks_keeps_its_bytes_and_masks_are_those_of_objects_alone():
    bare = prepare_sequence(parse_scenario({**WAVY, "objects": []})).at(0.0)
    found = wavy().images(0)
    masks = [(found["object_mask"][0] >> np.uint64(n)) & np.uint64(1) > 0 for n in range(3)]
    touched = np.logical_or.reduce(masks)
    assert all(mask.any() for mask in masks)
    for name in ("radiance", "range", "coverage"):
        assert found[name][~touched].tobytes() == bare[name][~touched].tobytes(), name
    assert (found["radiance"][touched] != bare.radiance[touched]).all()
    alone = prepare_sequence(parse_scenario({**WAVY, "objects": WAVY["objects"][1:2]})).images(0)
    assert np.array_equal(alone["object_mask"][0] > 0, masks[1])


def placed(east, north, height, eye):
    """A place in the axes of a sensor over the round sea [m]."""
    arc = math.hypot(east, north)
    psi, radius = arc / EFFECTIVE_EARTH_RADIUS, EFFECTIVE_EARTH_RADIUS + height
    level = radius * math.sin(psi)
    return np.array([level * east / arc, level * north / arc, radius * math.cos(psi) - EFFECTIVE_EARTH_RADIUS - eye])


def arrived(radius, place):
    """Signal of a hot ball [W m-2] in a cavity."""
    far = float(np.linalg.norm(place))
    nu = 100.0 * np.linspace(2000.0, 1e4 / 3.5, 4001)  # of 3.5 to 5 um [1/m]
    warm, cold = (np.trapezoid(2.0 * h * c**2 * nu**3 / np.expm1(h * c * nu / (k * kelvin)), nu) for kelvin in (HOT, 288.15))
    return (warm - cold) * math.exp(-1e-4 * far) * 2.0 * math.pi * (1.0 - math.sqrt(1.0 - (radius / far) ** 2))


@pytest.mark.parametrize("across", [0.1, 0.24, 0.61])
def test_a_ball_on_the_seam_of_a_panorama_is_whole(across):
    sensor = {"pixels": [180, 6], "fov_deg": [360.0, 12.0], "elevation_deg": 0.0, "height_m": 20.0}
    azimuth = math.radians(180.0 + 2.0 * across)
    item = ball(9.0, 250.0 * math.sin(azimuth), 250.0 * math.cos(azimuth), 18.0)
    at_seam, inside = (
        prepare_sequence(parse_scenario({**CALM, "sensor": {**sensor, "azimuth_deg": a}, "objects": [item]})) for a in (0.0, 90.0)
    )
    one, other = at_seam.images(0), inside.images(0)
    # columns of 2 deg: turned by 45 of them
    np.testing.assert_allclose(one["radiance"], np.roll(other["radiance"], 45, axis=1), rtol=1e-5)
    assert one["irradiance_W_m2"][0] == pytest.approx(arrived(9.0, placed(item["east_m"], item["north_m"], 18.0, 20.0)), rel=2e-3)
    assert one["visible_share"][0] == pytest.approx(1.0, abs=1e-6)
    assert one["column_px"][0] == pytest.approx((other["column_px"][0] + 45.5) % 180.0 - 0.5, abs=1e-3)
    assert one["signal_column_px"][0] == pytest.approx((other["signal_column_px"][0] + 45.5) % 180.0 - 0.5, abs=1e-3)
    assert (one["bbox_left_px"][0], one["bbox_width_px"][0]) == ((other["bbox_left_px"][0] + 45.0) % 180.0, other["bbox_width_px"][0])


@pytest.mark.parametrize("azimuth", [0.7, 90.7, 178.7, 180.7, 183.0, 269.3, 359.3])
def test_a_point_has_its_pixel_wherever_a_panorama_begins(azimuth):
    sensor = {"pixels": [180, 6], "fov_deg": [360.0, 12.0], "elevation_deg": 0.0, "height_m": 20.0}
    east, north = (float(250.0 * f(math.radians(azimuth))) for f in (math.sin, math.cos))
    item = {"name": "lamp", "shape": {"kind": "point", "intensity_w_sr": 1e4}, "east_m": east, "north_m": north, "height_m": 18.0}
    one, other = (
        prepare_sequence(parse_scenario({**CALM, "sensor": {**sensor, "azimuth_deg": a}, "objects": [item]})).images(0) for a in (0.0, 90.0)
    )
    column = math.floor((azimuth + 180.0) / 2.0) % 180  # of 2 deg, the first at the camera's back
    assert int(np.argmax(one["radiance"].max(axis=0))) == column
    np.testing.assert_allclose(one["radiance"], np.roll(other["radiance"], 45, axis=1), rtol=1e-5)
    assert one["irradiance_W_m2"][0] == pytest.approx(other["irradiance_W_m2"][0], rel=1e-6)


@pytest.mark.parametrize(("projection", "roll"), [("equal-angle", 20.0), ("pinhole", -33.0)])
def test_a_turned_camera_sees_a_ball_where_geometry_puts_it(projection, roll):
    sensor = {"pixels": [64, 48], "fov_deg": [4.0, 3.0], "elevation_deg": -0.7, "azimuth_deg": 10.0, "height_m": 20.0, "roll_deg": roll}
    east, north = 700.0 * math.sin(math.radians(10.4)), 700.0 * math.cos(math.radians(10.4))
    run = prepare_sequence(
        parse_scenario({**CALM, "sensor": {**sensor, "projection": projection}, "objects": [ball(2.0, east, north, 12.0)]})
    )
    found, pose = run.images(0), run.track.at(0.0)
    place = placed(east, north, 12.0, 20.0)
    along = run.scene.pixels.directions(pose.attitude, found["column_px"][0] + 0.5, found["row_px"][0] + 0.5)
    assert math.acos(min(float(along @ place) / float(np.linalg.norm(place)), 1.0)) < 0.02 * math.radians(4.0 / 64)
    assert found["irradiance_W_m2"][0] == pytest.approx(arrived(2.0, place), rel=2e-3)
    assert found["signal_column_px"][0] == pytest.approx(found["column_px"][0], abs=0.02)


DETECTOR = {
    "optics": {"focal_length_m": 0.01, "f_number": 2.0},
    "detector": {"pitch_um": 15.0, "integration_time_s": 0.001, "well_capacity_e": 1e8, "bit_depth": 14},
    "noise": {"temporal": False, "fixed_pattern": False},
}


@pytest.mark.parametrize("kind", ["staring", "line", "rolling"])
def test_labels_of_a_detector_are_in_its_pixels_at_their_own_instants(kind):
    more = {"line": {"scan": {"kind": "line", "period_s": 0.4}}, "rolling": {"scan": {"row_time_s": 0.3 / 16}}}.get(kind, {})
    sensor = {"pixels": [24, 16], "elevation_deg": -0.6, "azimuth_deg": 0.0, "height_m": 20.0, "frame_rate_hz": 2.0, **DETECTOR, **more}
    common = {**CALM, "sensor": sensor, "render": {"oversampling": 3}}
    mover = ball(3.0, -4.0, 600.0, 14.0, course_deg=90.0, speed_m_s=10.0)
    found = prepare_sensed(parse_scenario({**common, "objects": [mover]}), radiance=True).images(0)
    bare = prepare_sensed(parse_scenario(common), radiance=True).images(0)
    change = found["radiance"].astype(float) - bare["radiance"]
    assert change.max() > 0.1
    mask = found["object_mask"][0, :, :] > 0
    # the layer is drawn at eight instants of a rolling shutter, and without the way in the exposure: slivers of pixels may differ
    assert mask[change > 0.02 * change.max()].all()
    assert np.count_nonzero(mask != (change != 0.0)) <= 2
    column, row = ((change * axis).sum() / change.sum() for axis in (np.arange(24)[None], np.arange(16)[:, None]))
    # columns taken one by one share boxes of a sixteenth of a pixel
    assert found["signal_column_px"][0] == pytest.approx(column, abs=4e-3 if kind == "line" else 2e-3)
    assert found["signal_row_px"][0] == pytest.approx(row, abs=2e-3)
    pixel = 1.5e-3
    delay = {"staring": 0.0, "line": 0.4 * (column + 0.5) / 24, "rolling": 0.3 * (row + 0.5) / 16}[kind]
    expected = 11.5 + math.atan2(-4.0 + 10.0 * delay, 600.0) / pixel
    # pixels of 1.5 mrad, 0.9 m: the ball is 6.7 wide; a scanner's columns, taken one by one, shear it
    assert found["column_px"][0] == pytest.approx(expected, abs=0.03 if kind == "staring" else 0.12)
