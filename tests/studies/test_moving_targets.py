"""Small targets that move: peaks, profiles and places against own integrals, by random draws."""

from __future__ import annotations

import math

import numpy as np
import pytest
from tests.helpers.own_exposure import COLUMNS, HEIGHT, ROWS, STEP, added, at, optics, pixel, planck, scene, seen, sensor, way

import seaglint as sg
from seaglint.base.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.base.schema import SIZES
from seaglint.instrument.chain import Drawn
from seaglint.studies.sequence.sensed_sequence import prepare_sensed

FAR = 2000.0


def lamp(place, velocity=(0.0, 0.0, 0.0), intensity=50.0, **more):
    """A point at a place [m] with a velocity [m/s]."""
    shape = {"kind": "point", "intensity_w_sr": intensity}
    return {"name": "lamp", "shape": shape, **moving(place, velocity), **more}


def ball(place, radius, velocity=(0.0, 0.0, 0.0), kelvin=320.0, **more):
    """A black sphere."""
    shape = {"kind": "sphere", "radius_m": radius}
    return {"name": "ball", "shape": shape, "temperature_k": kelvin, "emissivity": 1.0, **moving(place, velocity), **more}


def moving(place, velocity):
    """Keys of a straight way, by keyframes where it climbs."""
    if not any(velocity):
        return {"east_m": place[0], "north_m": place[1], "height_m": place[2]}
    names = ("east_m", "north_m", "height_m")
    places = [(t, [p + v * t for p, v in zip(place, velocity, strict=True)]) for t in (-1.0, 1.0)]
    ends = [{"time_s": t, **dict(zip(names, there, strict=True))} for t, there in places]
    return {"keyframes": ends, "path": "straight", "heading_deg": 0.0}


def photons(wavelength):
    """Photons of a power are as many as the wavelength is long."""
    return wavelength


TIMES = (np.arange(600) + 0.5) / 600 - 0.5


@pytest.mark.parametrize("f_number", [2.0, 2.8, 4.0, 8.0])
def test_peak_and_profile_of_moving_points_are_those_of_integrals(f_number) -> None:
    """0 to 30 pixels of motion in any direction, at any phase, within 0.5 % (the bar is 1 %)."""
    rng = np.random.default_rng(int(10 * f_number))
    for motion in (0.0, rng.uniform(0.05, 1.0), rng.uniform(1.0, 8.0), rng.uniform(8.0, 30.0)):
        turn = rng.uniform(0.0, 2.0 * np.pi)
        speed = motion * STEP * FAR / 0.005
        place, velocity = at(32 + rng.uniform(-1, 1), 24 + rng.uniform(-1, 1), FAR), (speed * math.cos(turn), 0.0, speed * math.sin(turn))
        change, arrays, _ = added(scene([lamp(place, velocity)], sensor(f_number)))
        columns, rows, distances = way(place, velocity, 0.005 * TIMES)
        middle = columns.mean(), rows.mean()
        expected = seen(f_number, columns, rows) * 50.0 / (distances.mean() ** 2 * pixel(*middle))
        assert change.max() == pytest.approx(expected.max(), rel=2e-3)
        np.testing.assert_allclose(change, expected, atol=2e-3 * expected.max())
        assert arrays["column_px"][0] == pytest.approx(middle[0] - 0.5, abs=1e-3)
        assert arrays["row_px"][0] == pytest.approx(middle[1] - 0.5, abs=1e-3)
        assert arrays["motion_px"][0] == pytest.approx(motion, abs=1e-3 + 1e-4 * motion)
        ends = [arrays[f"streak_{end}_{axis}_px"][0] for end in ("begin", "end") for axis in ("column", "row")]
        first, last = (way(place, velocity, np.array([0.0025 * sign])) for sign in (-1.0, 1.0))
        assert ends == pytest.approx([float(v[0]) - 0.5 for v in (*first[:2], *last[:2])], abs=2e-3)
        assert arrays["velocity_column_px_s"][0] == pytest.approx(float(last[0][0] - first[0][0]) / 0.005, abs=1e-2 + 1e-4 * motion / 0.005)


@pytest.mark.parametrize(("f_number", "size"), [(2.0, 0.05), (2.0, 1.0), (2.8, 0.3), (4.0, 3.0), (4.0, 0.6), (8.0, 1.7)])
def test_spheres_of_any_size_and_phase_have_the_peak_of_integrals(f_number, size) -> None:
    rng = np.random.default_rng(int(100 * size))
    for speed in (0.0, rng.uniform(20.0, 300.0)):
        place, radius = at(32 + rng.uniform(-1, 1), 24 + rng.uniform(-1, 1), FAR), 0.5 * size * STEP * FAR
        change, arrays, _ = added(scene([ball(place, radius, (speed, 0.0, 0.0))], sensor(f_number)))
        columns, rows, distances = way(place, (speed, 0.0, 0.0), 0.005 * TIMES)
        solid = 2.0 * np.pi * (1.0 - math.sqrt(1.0 - (radius / distances.mean()) ** 2))
        own = pixel(columns.mean(), rows.mean())
        # as counted: the ball by its own spectrum, the sea behind it by that of its temperature, both relative to 300 K
        warmer = (planck(320.0, photons) - planck(288.15, photons)) * planck(300.0) / planck(300.0, photons)
        expected = seen(f_number, columns, rows, math.sqrt(solid / (np.pi * own))) * warmer * solid / own
        assert change.max() == pytest.approx(expected.max(), rel=3e-3)
        np.testing.assert_allclose(change, expected, atol=3e-3 * expected.max())
        assert arrays["column_px"][0] == pytest.approx(columns.mean() - 0.5, abs=1e-3)
        assert arrays["visible_share"][0] == pytest.approx(1.0, abs=1e-3)


def test_places_of_electrons_are_those_of_integrals_at_random_phases() -> None:
    """Centroids within 0.002 pixels of own ones, which swing about the true place as pixels undersample; places within 0.001."""
    rng = np.random.default_rng(8)
    known, table = optics(4.0)
    for _ in range(40):
        true = 32 + rng.uniform(-0.5, 0.5), 24 + rng.uniform(-0.5, 0.5)
        change, arrays, _ = added(scene([lamp(at(*true, FAR))], sensor(4.0)))
        near = np.s_[int(true[1]) - 8 : int(true[1]) + 9, int(true[0]) - 8 : int(true[0]) + 9]
        expected = seen(4.0, np.array([true[0]]), np.array([true[1]]))
        across = np.arange(COLUMNS)[None, :] + 0.5
        centroid, own = (float((image[near] * across[:, near[1]]).sum() / image[near].sum()) for image in (change, expected))
        assert centroid == pytest.approx(own, abs=2e-3)
        assert arrays["column_px"][0] + 0.5 == pytest.approx(true[0], abs=1e-3)
        # beyond a window the swing has a closed form: the transfer at one cycle to a pixel, which the pixels fold
        swing = -np.interp(1.0, known, table) / np.pi * math.sin(2.0 * np.pi * (true[0] - 0.5))
        assert arrays["counts_column_px"][0] + 0.5 == pytest.approx(true[0] - swing, abs=6e-3)


def test_a_slow_glide_has_no_steps() -> None:
    """A point that glides by 0.062 pixels a frame: its counts glide alike, and its peak is a smooth function of its phase."""
    speed = 0.062 * STEP * FAR * 25.0
    place = at(30.0, 24.3, FAR)
    camera = sensor(2.5, 0.001, frames=40, frame_rate_hz=25.0)
    item = lamp(place, course_deg=90.0, speed_m_s=speed)
    run = prepare_sensed(scene([item], camera))
    for frame in range(0, 40, 3):
        arrays = run.images(frame)
        columns, rows, distance = way(place, (speed, 0.0, 0.0), np.array([frame / 25.0]))
        expected = seen(2.5, columns, rows) * 50.0 / (distance[0] ** 2 * pixel(columns[0], rows[0]))
        counted = arrays["counts_peak"][0] * 1e9 / run.sensed.model.readout.per_radiance
        assert counted == pytest.approx(expected.max(), rel=3e-3)


@pytest.mark.parametrize("projection", ["pinhole", "equal-angle"])
@pytest.mark.parametrize("speed", [20.0, 300.0])
def test_a_tracked_target_is_as_sharp_as_a_standing_one_and_the_sea_is_not(projection, speed) -> None:
    place = (0.0, FAR, HEIGHT + FAR**2 / 2.0 / EFFECTIVE_EARTH_RADIUS)
    times = np.linspace(-0.02, 0.02, 41)
    turn = [{"time_s": float(t), "azimuth_deg": math.degrees(math.atan2(speed * t, FAR))} for t in times]
    camera = sensor(2.5, projection=projection)
    change, arrays, _ = added(scene([ball(place, 0.2, (speed, 0.0, 0.0), 400.0)], camera, platform={"keyframes": turn}))
    still, _, _ = added(scene([ball(place, 0.2, kelvin=400.0)], camera))
    assert change.max() == pytest.approx(still.max(), rel=1e-3)
    assert arrays["motion_px"][0] < 0.01
    # a post that stands is smeared by the turn of the camera, as the sea is
    post, held, _ = added(scene([ball(place, 0.2, kelvin=400.0)], camera, platform={"keyframes": turn}))
    columns, rows, _ = way(place, (-speed, 0.0, 0.0), 0.005 * TIMES)
    expected = seen(2.5, columns, rows, 0.2 / FAR / STEP)
    np.testing.assert_allclose(post / post.sum(), expected / expected.sum(), atol=4e-3 * (expected / expected.sum()).max())
    assert held["motion_px"][0] == pytest.approx(0.005 * speed / FAR / STEP, rel=1e-3)


def test_a_target_on_a_turning_way_leaves_an_arc() -> None:
    """On a circle of 6 pixels, a fifth of a turn in the exposure."""
    radius, rate, exposure = 6.0 * STEP * FAR, 0.4 * np.pi / 0.02, 0.02
    middle = at(32.3, 24.1, FAR)
    times = np.linspace(-0.03, 0.03, 121)
    turned = [(float(t), radius * math.cos(rate * t), radius * math.sin(rate * t)) for t in times]
    frames = [{"time_s": t, "east_m": middle[0] + x, "north_m": middle[1], "height_m": middle[2] + z} for t, x, z in turned]
    item = {"name": "lamp", "shape": {"kind": "point", "intensity_w_sr": 50.0}, "keyframes": frames, "heading_deg": 0.0}
    change, arrays, _ = added(scene([item], sensor(2.5, exposure)))
    t = exposure * TIMES
    columns, rows, distance = way((middle[0] + radius * np.cos(rate * t), middle[1], middle[2] + radius * np.sin(rate * t)), (0, 0, 0), t)
    expected = seen(2.5, columns, rows) * 50.0 / (distance.mean() ** 2 * pixel(32.3, 24.1))
    np.testing.assert_allclose(change, expected, atol=3e-3 * expected.max())
    assert arrays["motion_px"][0] == pytest.approx(6.0 * 0.4 * np.pi, rel=2e-3)


def test_rows_of_a_rolling_shutter_see_a_fast_target_at_their_own_instants() -> None:
    """Every row has the light of its own exposure: rows of 40 us, a target that crosses 0.1 pixels from row to row."""
    speed, tick = 300.0, 40e-6
    place = at(32.2, 20.7, FAR)
    change, _, _ = added(scene([lamp(place, (speed, 0.0, 0.0))], sensor(2.5, 0.001, frame_rate_hz=25.0, scan={"row_time_s": tick})))
    expected = np.zeros((ROWS, COLUMNS))
    for row in range(ROWS):
        columns, rows, distance = way(place, (speed, 0.0, 0.0), row * tick + 0.001 * TIMES)
        light = 50.0 / (distance.mean() ** 2 * pixel(columns.mean(), rows.mean()))
        expected[row] = light * seen(2.5, columns, rows, rows_seen=np.array([row + 0.5]))[0]
    np.testing.assert_allclose(change, expected, atol=0.01 * expected.max())


def test_a_target_faster_than_the_picture_is_wide_is_told_once(caplog) -> None:
    place = at(32.2, 24.0, 40.0)
    velocity = (900.0, 0.0, 0.0)
    change, arrays, _ = added(scene([lamp(place, velocity, 1e-3)], sensor(2.5, 0.005)))
    told = [record.getMessage() for record in caplog.records if "crosses" in record.getMessage()]
    assert len(told) == 1
    assert "'lamp' crosses 1875 pixels in an exposure, more than the picture is wide (64)" in told[0]
    columns, rows, distance = way(place, velocity, 0.005 * (np.arange(40000) + 0.5) / 40000 - 0.0025)
    inside = np.abs(columns - 32.0) < 80.0
    expected = seen(2.5, columns[inside], rows[inside]) * np.mean(inside) * 1e-3 / (distance[inside].mean() ** 2 * pixel(32.0, 24.0))
    np.testing.assert_allclose(change, expected, atol=0.01 * expected.max())
    assert arrays["motion_px"][0] > 64.0


def test_a_target_that_comes_into_the_picture_during_the_exposure_is_seen() -> None:
    speed = 20.0 * STEP * FAR / 0.005
    for column, velocity in ((-6.0, speed), (70.0, -speed)):
        place = at(column, 24.4, FAR)
        change, _, _ = added(scene([lamp(place, (velocity, 0.0, 0.0))], sensor(2.5)))
        columns, rows, distance = way(place, (velocity, 0.0, 0.0), 0.005 * TIMES)
        expected = seen(2.5, columns, rows) * 50.0 / (distance.mean() ** 2 * pixel(columns.mean(), rows.mean()))
        assert expected.max() > 0.01
        np.testing.assert_allclose(change, expected, atol=5e-3 * expected.max())


@pytest.mark.parametrize("oversampling", [4, 5, 7])
def test_a_single_fine_pixel_is_a_point_in_its_middle(oversampling) -> None:
    picture = np.full((ROWS * oversampling, COLUMNS * oversampling), 1.0, np.float32)
    j, i = 24 * oversampling + 1, 32 * oversampling + oversampling - 1
    picture[j, i] += oversampling**2
    counted = sg.sense(picture[None], scene([], sensor(2.5)), oversampling=oversampling, electrons=True).electrons.to_numpy()[0]
    per = (counted.astype(float) - np.median(counted)) / np.median(counted)
    expected = seen(2.5, np.array([(i + 0.5) / oversampling]), np.array([(j + 0.5) / oversampling]))
    assert per.max() == pytest.approx(expected.max(), rel=5e-3)
    np.testing.assert_allclose(per, expected, atol=5e-3)


def test_distortion_moves_a_target_as_it_moves_the_sea_around() -> None:
    """A ball and a bright pixel of the sea at one place come to the same place of the focal plane."""
    camera = sensor(2.5, 0.001)
    camera["optics"] = {**camera["optics"], "distortion": 0.1}
    place = at(44.3, 31.2, FAR)
    change, arrays, _ = added(scene([lamp(place)], camera))
    corner = math.hypot(COLUMNS / 2, ROWS / 2)
    scale = 1.0 + 0.1 * ((44.3 - 32) ** 2 + (31.2 - 24) ** 2) / corner**2
    known, table = optics(2.5)
    swing = np.interp(1.0, known, table) / np.pi
    assert arrays["counts_column_px"][0] + 0.5 == pytest.approx(32 + (44.3 - 32) * scale, abs=swing + 0.02)
    assert arrays["counts_row_px"][0] + 0.5 == pytest.approx(24 + (31.2 - 24) * scale, abs=swing + 0.02)
    # radiance stays, so that light grows with the area: by the radial and the tangential stretch
    plain, _, _ = added(scene([lamp(place)], sensor(2.5, 0.001)))
    stretch = scale * (1.0 + 3.0 * (scale - 1.0))
    assert change.sum() == pytest.approx(plain.sum() * stretch, rel=3e-3)


@pytest.mark.parametrize("size", [5.0, 40.0, 200.0])
def test_large_objects_at_rest_are_those_of_the_fine_picture(size) -> None:
    """From small to wider than a tile and the picture: the light on pixels is the blur of the composed fine picture."""
    place = at(30.3, 25.6, FAR)
    shape = {"kind": "box", "size_m": [size * STEP * FAR, 2.0, 0.4 * min(size, 60.0) * STEP * FAR]}
    item = {"name": "box", "shape": shape, "temperature_k": 300.0, "emissivity": 1.0, **moving(place, (0.0, 0.0, 0.0))}
    scenario = scene([item], sensor(4.0, pixels=[160, 48]), render={"oversampling": 6})
    run = prepare_sensed(scenario, radiance=True)
    composed = run.sensed.fine.drawn(0)
    expected = run.sensed.model.focal_plane(composed.layers.radiance, 6, drawn=Drawn())
    sea = run.sensed.model.focal_plane(composed.sea, 6, drawn=Drawn())
    # the composed picture counts all light as of 300 K: that of the box is, that of the sea behind it is lighter by its own spectrum
    lighter = planck(288.15, photons) / planck(288.15) * planck(300.0) / planck(300.0, photons)
    change, full = run.sensed.seen(0).astype(float) - sea, (planck(300.0) - planck(288.15))
    np.testing.assert_allclose(
        change, expected.astype(float) - sea + (1.0 - lighter) * planck(288.15) * (expected - sea) / full, atol=4e-3 * full
    )


def test_a_target_on_a_panorama_goes_over_the_seam() -> None:
    """Its streak at the seam is the one elsewhere, turned; labels go with it."""
    camera = {
        "pixels": [720, 8],
        "fov_deg": [360.0, 4.0],
        "elevation_deg": 0.0,
        "height_m": HEIGHT,
        "frames": 1,
        "optics": {"f_number": 2.0},
        "detector": {"pitch_um": 15.0, "integration_time_s": 0.005, "gain_e_per_count": 1e9},
        "noise": {"temporal": False, "fixed_pattern": False},
    }
    lit = lamp((0.0, FAR, HEIGHT + FAR**2 / 2.0 / EFFECTIVE_EARTH_RADIUS), course_deg=90.0, speed_m_s=1000.0)
    found = {}
    for azimuth in (180.0, 30.0):
        change, arrays, _ = added(scene([lit], {**camera, "azimuth_deg": azimuth}))
        found[azimuth] = np.roll(change, int((azimuth - 180.0) * 2), axis=1), arrays
    np.testing.assert_allclose(found[180.0][0], found[30.0][0], atol=2e-5 * found[30.0][0].max())
    one, other = (found[a][1]["counts_column_px"][0] for a in (180.0, 30.0))
    assert (one - other + 300.0 + 360.0) % 720.0 - 360.0 == pytest.approx(0.0, abs=2e-3)


def test_what_is_outside_the_picture_is_truncated_not_hidden() -> None:
    """A box that reaches out of the picture by a third, and one wholly outside whose blur comes in."""
    size = 9.0
    shape = {"kind": "box", "size_m": [size * STEP * FAR, 0.5, size * STEP * FAR]}
    for column, cut in ((size / 6.0, 1.0 / 3.0), (-size / 2.0 - 0.3, 1.0)):
        item = {"name": "box", "shape": shape, "temperature_k": 320.0, **moving(at(column, 24.0, FAR), (0.0, 0.0, 0.0))}
        change, arrays, _ = added(scene([item], sensor(4.0)))
        assert arrays["truncated_share"][0] == pytest.approx(cut, abs=3e-3)
        assert arrays["visible_share"][0] == pytest.approx(1.0 - cut, abs=3e-3)
        assert np.isnan(arrays["occluded_share"][0]) if cut == 1.0 else arrays["occluded_share"][0] == pytest.approx(0.0, abs=1e-6)
        assert change[24, 0] > 0.05 * change.max() > 0.0


def test_a_lamp_that_passes_behind_a_ball_is_hidden_for_its_time_there() -> None:
    """24 pixels of way behind a ball of a radius of 3: a quarter of the light is lost, wherever the lamp is at mid-exposure."""
    speed = 24.0 * STEP * FAR / 0.005
    screen = ball(at(32.0, 24.0, FAR - 100.0), 3.0 * STEP * (FAR - 100.0), kelvin=288.15)
    alone, _, _ = added(scene([screen], sensor(2.5)))
    for column in (32.0, 36.0):
        change, arrays, _ = added(scene([screen, lamp(at(column, 24.0, FAR), (speed, 0.0, 0.0))], sensor(2.5)))
        times = 0.005 * TIMES
        columns, rows, distance = way(at(column, 24.0, FAR), (speed, 0.0, 0.0), times)
        free = np.abs(columns - 32.0) > 3.0
        light = 50.0 / (distance.mean() ** 2 * pixel(columns.mean(), rows.mean()))
        expected = seen(2.5, columns[free], rows[free]) * np.mean(free) * light
        np.testing.assert_allclose(change - alone, expected, atol=0.08 * expected.max())
        assert (change - alone).sum() == pytest.approx(expected.sum(), rel=0.03)
        assert arrays["occluded_share"][1] == pytest.approx(0.25, abs=0.03)
        assert arrays["visible_share"][1] == pytest.approx(0.75, abs=0.03)


def test_labels_of_what_enters_the_picture_are_means_over_the_exposure() -> None:
    """20 pixels of way with the middle on the edge: half of it is in the picture."""
    speed = 20.0 * STEP * FAR / 0.005
    _, arrays, _ = added(scene([lamp(at(0.0, 24.0, FAR), (speed, 0.0, 0.0))], sensor(2.5)))
    assert arrays["truncated_share"][0] == pytest.approx(0.5, abs=0.03)
    assert arrays["visible_share"][0] == pytest.approx(0.5, abs=0.03)
    assert arrays["column_px"][0] == pytest.approx(4.5, abs=0.3)
    assert arrays["streak_begin_column_px"][0] == pytest.approx(-10.5, abs=1e-2)


@pytest.mark.parametrize("speed", [250.0, 330.0, -400.0])
def test_a_scanner_meets_a_target_that_is_nearly_as_fast(speed) -> None:
    """The column at which both are at one time: of columns 20 ms apart over the picture and a target of up to the same speed."""
    place = at(32.0, 24.0, FAR)
    camera = sensor(2.5, 1e-4, projection="equal-angle", scan={"kind": "line", "period_s": 0.02}, frame_rate_hz=25.0)
    change, arrays, _ = added(scene([lamp(place, (speed, 0.0, 0.0))], camera))
    scanned = COLUMNS / 0.02
    own = speed / FAR / STEP
    met = (32.0 - own * 0.5 / scanned) / (1.0 - own / scanned)
    if 0.0 < met < COLUMNS:
        assert arrays["column_px"][0] + 0.5 == pytest.approx(met, abs=0.3)
        assert change.max() > 0.0


def test_a_full_pixel_has_no_more_counts_of_a_target() -> None:
    camera = sensor(2.5)
    camera["detector"] = {**camera["detector"], "gain_e_per_count": 1.0, "well_capacity_e": 1e4, "bit_depth": 16}
    _, arrays, _ = added(scene([lamp(at(32.2, 24.0, FAR))], camera))
    assert arrays["saturated_share"] == 1.0
    assert arrays["counts_peak"][0] == arrays["counts_snr"][0] == 0.0


@pytest.mark.parametrize("more", [{}, {"stray_share": 0.2}, {"cos4": True}])
def test_counts_of_labels_are_those_of_the_pictures(more) -> None:
    """Peak and noise: against the electrons of two runs, and their own sum of shot, dark, read noise and quantisation."""
    rng = np.random.default_rng(5)
    gain, read, dark, exposure = 400.0, 300.0, 1e7, 0.004
    camera = sensor(2.5, exposure, pixels=[COLUMNS, ROWS])
    camera["optics"] = {"f_number": 2.5, "focal_length_m": 0.005, **more} if more else {**camera["optics"]}
    camera["detector"] = {
        "pitch_um": 15.0, "integration_time_s": exposure, "gain_e_per_count": gain, "read_noise_e": read, "dark_current_e_s": dark,
        "crosstalk": 0.1, "fill_factor": 0.8, "quantum_efficiency": 0.02,
    }  # fmt: skip
    place = (rng.uniform(-20.0, 20.0), 300.0, HEIGHT + rng.uniform(-20.0, 20.0)) if more else at(45.3, 12.2, FAR)
    item = ball(place, 0.6, (30.0, 0.0, 0.0), 600.0)
    runs = [prepare_sensed(scene(objects, camera), electrons=True).images(0) for objects in ([item], [])]
    found, bare = runs
    change = found["electrons"].astype(float) - bare["electrons"]
    # what is scattered over the whole picture is no part of the label
    change -= np.median(change) if "stray_share" in more else 0.0
    assert found["counts_peak"][0] == pytest.approx(change.max() / gain, rel=2e-3)
    peak = found["electrons"].ravel()[change.argmax()]
    assert found["counts_snr"][0] == pytest.approx(change.max() / math.sqrt(peak + read**2 + gain**2 / 12.0), rel=3e-3)


def test_blur_of_a_streak_adds_a_uniform_spread() -> None:
    """Variance of a uniform way of the length L along one of two axes: L^2 / 12, half of it in the mean of both."""
    still, moving = (added(scene([lamp(at(32.0, 24.0, FAR), (speed, 0.0, 0.0))], sensor(2.5)))[1] for speed in (0.0, 120.0))
    spread = np.var(np.linspace(0.0, moving["motion_px"][0], 200001)) / 2.0
    assert moving["blur_px"][0] ** 2 - still["blur_px"][0] ** 2 == pytest.approx(spread, rel=1e-4)


@pytest.mark.parametrize(("size", "name"), [(0.9, "point"), (1.2, "small"), (8.9, "small"), (9.3, "extended")])
def test_classes_of_size_are_by_pixels_of_the_objects_place(size, name) -> None:
    """Squares of some pixels' side, high up in an equal-angle picture, whose pixels are half as wide there."""
    camera = sensor(2.5, projection="equal-angle", elevation_deg=60.0)
    slant = 500.0
    level, up = slant * math.cos(math.radians(60.0)), slant * math.sin(math.radians(60.0))
    side = size * STEP * slant * math.sqrt(math.cos(math.radians(60.0)))
    shape = {"kind": "sphere", "radius_m": side / math.sqrt(np.pi)}
    item = {"name": "it", "shape": shape, "temperature_k": 320.0, "east_m": 0.0, "north_m": level, "height_m": HEIGHT + up}
    _, arrays, _ = added(scene([item], camera))
    assert SIZES[int(arrays["size_class"][0])] == name


def test_a_point_that_comes_near_grows_during_the_exposure() -> None:
    """From 60 m at 900 m/s for 30 ms: its light is the mean over its distances, not that of the middle one."""
    place = (0.0, 60.0, HEIGHT)
    change, _, _ = added(scene([lamp(place, (0.0, -900.0, 0.0), 1e-3)], sensor(2.5, 0.03, frame_rate_hz=20.0)))
    distance = 60.0 - 900.0 * 0.03 * TIMES
    assert change.sum() == pytest.approx(np.mean(1e-3 / distance**2) / STEP**2, rel=3e-3)


@pytest.mark.parametrize("up", [-900.0, 900.0])
def test_ends_of_a_streak_under_a_rolling_shutter_are_those_of_the_rows_there(up) -> None:
    """A target along the rows' own way is seen longer, one against it shorter: row and time solve both lines at once."""
    tick, exposure = 40e-6, 0.001
    place = at(32.0, 15.0, FAR)
    _, arrays, _ = added(scene([lamp(place, (0.0, 0.0, up))], sensor(2.5, exposure, frame_rate_hz=25.0, scan={"row_time_s": tick})))
    speed = -up / FAR / STEP  # rows per second, downwards
    for end, sign in (("begin", -1.0), ("end", 1.0)):
        row = (15.0 + speed * (sign * exposure / 2.0 - 0.5 * tick)) / (1.0 - speed * tick)
        assert arrays[f"streak_{end}_row_px"][0] + 0.5 == pytest.approx(row, abs=0.02)
