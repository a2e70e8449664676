"""From a scenario with a sensor to counts: frames alone, threads, scanners, averages."""

from __future__ import annotations

import numpy as np
import pytest

import seaglint as sg
from seaglint.api.inputs_and_results import recording_of
from seaglint.base.errors import DataError, DomainError, ScenarioError
from seaglint.formats.recording import open_recording
from seaglint.instrument.figures_of_merit import blur_px
from seaglint.instrument.scan import ScanPattern
from seaglint.scenario.load import parse_scenario
from seaglint.scenario.presets import with_sensor
from seaglint.store.sequence_store import open_sequence
from seaglint.studies.sequence import memory
from seaglint.studies.sequence.render_sequence import prepare_sequence
from seaglint.studies.sequence.sensed_sequence import ROLLING_PARTS, binned, drawn_in_time, prepare_sensed, render
from seaglint.studies.study_requests import ReadingRequest
from sensor_cost import measured

SENSOR = {
    "pixels": [24, 16],
    "elevation_deg": -3.0,
    "frames": 6,
    "optics": {"focal_length_m": 0.01, "f_number": 2.0},
    "detector": {"pitch_um": 15.0, "integration_time_s": 0.001, "well_capacity_e": 1e7, "read_noise_e": 300.0, "bit_depth": 14},
    "noise": {"gain_spread": 0.001, "one_over_f": 50.0, "dead_share": 0.01},
}
SMALL = {
    "seed": 4,
    "sun": {"zenith_deg": 60.0, "azimuth_deg": 120.0},
    "sensor": SENSOR,
    "wind": {"speed_m_s": 7.0, "from_deg": 230.0},
    "sea": {"shortest_wave_m": 4.0},
    "render": {"tile_size": 128, "oversampling": 3},
}


def small(**sensor):
    return parse_scenario({**SMALL, "sensor": {**SENSOR, **sensor}})


def test_a_frame_alone_is_that_of_its_sequence_for_any_threads(tmp_path) -> None:
    whole = open_sequence(render(small(), tmp_path / "whole.zarr", threads=1, electrons=True, radiance=True))
    alone = open_sequence(render(small(), tmp_path / "alone.zarr", frames=range(4, 5), threads=None, electrons=True, radiance=True))
    for name in ("signal", "electrons", "radiance", "saturated_share"):
        assert whole[name].values[4].tobytes() == alone[name].values[0].tobytes()
        if name != "saturated_share":
            assert whole[name].values[4].tobytes() != whole[name].values[5].tobytes()
    assert whole.signal.dtype == np.uint16
    assert whole.signal.shape == (6, 16, 24)


def test_counts_lead_back_to_the_radiance(tmp_path) -> None:
    wide = {**SENSOR["detector"], "well_capacity_e": 1e8}
    quiet = small(noise={"temporal": False, "fixed_pattern": False}, optics={"focal_length_m": 0.01, "f_number": 1.0}, detector=wide)
    found = sg.render(quiet, tmp_path / "run.zarr", frames=range(1), radiance=True)
    line = found.signal.attrs
    radiance = found.signal.astype(float) * line["radiance_scale"] + line["radiance_offset"]
    assert float(radiance.mean()) == pytest.approx(float(found.radiance.mean()), rel=0.002)
    assert line["gain"] == pytest.approx(1e8 / 16383)
    kelvin = sg.apparent_temperature(found.drop_vars("radiance"))
    assert kelvin.attrs["units"] == "K"
    expected = sg.apparent_temperature(radiance, band=(3.5, 5.0))
    np.testing.assert_allclose(kelvin, expected, rtol=1e-6)
    # half a count in temperature and back
    assert found.attrs["oversampling"] == 3


def test_a_recording_has_the_blur_of_what_made_it(tmp_path) -> None:
    """Counts that of their sensor, the radiance at its aperture none, and what lost its file's attributes an unknown one."""
    path = tmp_path / "run.zarr"
    found = sg.render(small(), path, frames=range(1), radiance=True)
    expected = blur_px(prepare_sensed(small()).sensed.model)
    assert 0.1 < expected < 1.0
    for name, blur in (("signal", expected), ("radiance", 0.0)):
        assert open_recording(path, variable=name).blur_px == pytest.approx(blur, rel=1e-12)
        assert recording_of(found, ReadingRequest(variable=name)).blur_px == pytest.approx(blur, rel=1e-12)
    assert recording_of(found.signal.to_numpy(), ReadingRequest(frame_rate=25.0)).blur_px is None
    exported = tmp_path / "run.nc"
    sg.export(path, exported)
    assert open_recording(exported).blur_px == pytest.approx(expected, rel=1e-12)


def test_the_radiance_beside_counts_is_the_mean_over_pixels() -> None:
    run = prepare_sensed(small(), radiance=True)
    fine = run.fine.at(0.0)
    np.testing.assert_allclose(run.images(0)["radiance"], fine.radiance.reshape(16, 3, 24, 3).mean(axis=(1, 3)), rtol=1e-6)
    assert run.layout.azimuth_deg.size == 24
    assert float(np.diff(run.layout.azimuth_deg).mean()) == pytest.approx(small().sensor.ifov_deg[0])


def test_layers_are_averaged_over_pixels() -> None:
    scenario = parse_scenario(
        {**SMALL, "render": {**SMALL["render"], "layers": ["range", "coverage"]}, "sensor": {**SENSOR, "elevation_deg": 0.0}}
    )
    run = prepare_sensed(scenario)
    found, fine = run.images(0), run.fine.at(0.0)
    np.testing.assert_allclose(found["coverage"], binned(fine, 3)["coverage"])
    seen = np.isfinite(found["range"])
    assert 0 < seen.sum() < seen.size
    assert np.nanmin(found["range"]) >= np.nanmin(fine["range"])


def test_a_scenario_without_a_sensor_is_rendered_as_ever(tmp_path) -> None:
    plain = parse_scenario({**SMALL, "sensor": {"pixels": [24, 16], "fov_deg": [2.0, 1.4], "frames": 2}})
    found = open_sequence(render(plain, tmp_path / "run.zarr"))
    assert "signal" not in found
    np.testing.assert_array_equal(found.radiance.values[1], prepare_sequence(plain).at(1 / 25.0).radiance)
    assert "optics" not in found.attrs["scenario"]
    with pytest.raises(DataError, match=r"no \[sensor\.detector\]"):
        render(plain, tmp_path / "other.zarr", electrons=True)


def scanner(period: float, **more):
    return small(frame_rate_hz=2.0, scan={"kind": "line", "period_s": period}, **more)


def test_infinite_scan_speed_is_the_staring_picture_byte_for_byte() -> None:
    fast, staring = prepare_sensed(scanner(0.0)), prepare_sensed(small(frame_rate_hz=2.0))
    for number in (0, 3):
        assert fast.images(number)["signal"].tobytes() == staring.images(number)["signal"].tobytes()


def test_every_column_is_the_sea_of_its_own_instant() -> None:
    run, staring = prepare_sensed(scanner(0.4)), prepare_sensed(small(frame_rate_hz=2.0)).fine
    picture = drawn_in_time(run.fine, run.scan, 3, 1.0).layers
    for column in (0, 7, 23):
        instant = 1.0 + column * 0.4 / 24
        np.testing.assert_array_equal(
            picture.radiance[:, 3 * column : 3 * column + 3], staring.at(instant).radiance[:, 3 * column : 3 * column + 3]
        )
    assert not np.array_equal(picture.radiance, staring.at(1.0).radiance)


def test_a_moving_scanner_is_where_it_was_at_its_columns_instant() -> None:
    # 100 m/s over 0.4 s: the last column is seen from 38 m further on. The other renderer, for cameras that turn, draws the same places.
    way = {"keyframes": [{"time_s": 0.0, "east_m": 0.0}, {"time_s": 10.0, "east_m": 1000.0}]}
    moving = {**SMALL, "platform": way, "render": {**SMALL["render"], "subpixel_glint": "off"}}
    run = prepare_sensed(parse_scenario({**moving, "sensor": {**SENSOR, "frame_rate_hz": 2.0, "scan": {"kind": "line", "period_s": 0.4}}}))
    staring = prepare_sensed(parse_scenario({**moving, "sensor": {**SENSOR, "frame_rate_hz": 2.0}}))
    columns = np.arange(0, 24, 3)
    picture = binned(drawn_in_time(run.fine, run.scan, 3, 0.0).layers, 3)["radiance"][:, columns]
    then = np.stack([binned(staring.fine.at(c * 0.4 / 24), 3)["radiance"][:, c] for c in columns], axis=1)
    before = binned(staring.fine.at(0.0), 3)["radiance"][:, columns]

    def alike(one, other) -> float:
        """Correlation of what is left of each row without its mean: the waves."""
        return float(np.corrcoef(*((p - p.mean(axis=1, keepdims=True)).ravel() for p in (one, other)))[0, 1])

    assert alike(picture, then) > 0.9
    assert alike(picture, before) < 0.5


def test_a_scanner_on_a_turning_platform_looks_where_it_was_turned_to() -> None:
    # The platform turns back as fast as the scanner goes: all columns look into one direction, where a still sea is the same.
    width = float(small().sensor.fov_deg[0])
    way = {"keyframes": [{"time_s": 0.0, "azimuth_deg": 170.0}, {"time_s": 0.4, "azimuth_deg": 170.0 - width}]}
    low = {"zenith_deg": 84.0, "azimuth_deg": 168.0}
    still = {**SMALL, "sun": low, "platform": way, "sea": {"resolve_waves": False}, "render": {"oversampling": 1}}
    sensor = {**SENSOR, "frame_rate_hz": 2.5, "frames": 1, "scan": {"kind": "line", "period_s": 0.4}}
    run = prepare_sensed(parse_scenario({**still, "sensor": sensor}))
    picture = drawn_in_time(run.fine, run.scan, 1, 0.0).layers.radiance
    np.testing.assert_allclose(picture, np.broadcast_to(picture[:, :1], picture.shape), rtol=2e-4)
    staring = run.fine.at(0.0).radiance
    assert np.ptp(staring, axis=1).max() > 0.02 * staring.mean()  # the corridor, across the picture
    np.testing.assert_allclose(picture[:, 0], staring[:, 0], rtol=1e-6)


@pytest.mark.validation
def test_a_scanner_that_rises_sees_from_its_columns_height() -> None:
    way = {"keyframes": [{"time_s": 0.0, "height_m": 30.0}, {"time_s": 0.4, "height_m": 32.0}]}
    rising = {**SMALL, "platform": way, "sea": {"resolve_waves": False}, "render": {"oversampling": 1, "layers": ["range"]}}
    sensor = {**SENSOR, "frame_rate_hz": 2.5, "frames": 1, "scan": {"kind": "line", "period_s": 0.4}}
    run = prepare_sensed(parse_scenario({**rising, "sensor": sensor}))
    distance = drawn_in_time(run.fine, run.scan, 1, 0.0).layers["range"]
    height = 30.0 + 2.0 * np.arange(24) / 24
    np.testing.assert_allclose(distance[12] / distance[12, 0], height / 30.0, rtol=0.005)


def test_keyframes_that_end_within_a_scan_are_refused() -> None:
    way = {"keyframes": [{"time_s": 0.0, "azimuth_deg": 170.0}, {"time_s": 0.2, "azimuth_deg": 180.0}]}
    sensor = {**SENSOR, "frame_rate_hz": 2.5, "frames": 1, "scan": {"kind": "line", "period_s": 0.4}}
    with pytest.raises(DomainError, match="outside the platform's keyframes"):
        prepare_sensed(parse_scenario({**SMALL, "platform": way, "sensor": sensor}))


def test_a_scanner_has_no_plane_picture() -> None:
    with pytest.raises(ScenarioError, match=r"sensor\.projection = 'pinhole': .*set sensor\.projection = 'equal-angle'"):
        prepare_sensed(scanner(0.4, projection="pinhole"))


def test_a_panorama_that_memory_cannot_hold_is_refused_with_the_oversampling_that_it_can(monkeypatch) -> None:
    # 11310 x 640 pixels of 60 bytes: 4.2 GB drawn three times finer, 2.0 GB twice
    monkeypatch.setattr(memory, "memory_available", lambda: 3_000_000_000)
    wanted = parse_scenario(with_sensor({**SMALL, "render": {"tile_size": 128}}, "mwir-panoramic"))
    with pytest.raises(
        ScenarioError, match=r"pixels = \[11310, 640\] drawn 3 x 3 finer .* about 4\.\d GB .*; give render\.oversampling = 2,"
    ):
        prepare_sensed(wanted)


def test_leftward_scanners_begin_at_the_right() -> None:
    np.testing.assert_allclose(ScanPattern("line", 0.4, leftwards=True).column_delays(4), [0.3, 0.2, 0.1, 0.0])


@pytest.mark.validation
def test_a_panorama_has_no_seam_but_the_one_that_time_makes() -> None:
    step = np.degrees(0.06)  # 0.06 rad: 105 columns all round
    sensor = {
        "pixels": [105, 4], "elevation_deg": -9.0, "frames": 1, "frame_rate_hz": 1.0, "pixel_shape": "any",
        "optics": {"focal_length_m": 0.001, "f_number": 1.0}, "detector": {"pitch_um": 60.0, "integration_time_s": 1e-3},
        "noise": {"temporal": False}, "scan": {"kind": "panoramic", "period_s": 0.0},
    }  # fmt: skip
    wanted = {**SMALL, "sensor": sensor, "render": {"tile_size": 128, "oversampling": 1}}
    one = prepare_sensed(parse_scenario(wanted))
    assert one.layout.azimuth_deg.size * step == pytest.approx(360.0, rel=0.005)
    other = prepare_sensed(parse_scenario({**wanted, "sensor": {**sensor, "azimuth_deg": 180.0 + 10 * 360.0 / 105}}))
    # looked at from ten columns further on the picture is the same, turned: also what the blur carries over its edges
    first, second = (run.images(0)["signal"].astype(float) for run in (one, other))
    np.testing.assert_allclose(np.roll(first, -10, axis=1), second, rtol=2e-3)
    slow = prepare_sensed(parse_scenario({**wanted, "sensor": {**sensor, "scan": {"kind": "panoramic", "period_s": 1.0}}}))
    picture = drawn_in_time(slow.fine, slow.scan, 1, 0.0).layers
    np.testing.assert_array_equal(picture.radiance[:, 104], slow.fine.at(104 / 105).radiance[:, 104])


def test_rows_of_a_rolling_shutter_have_instants_near_their_own() -> None:
    run = prepare_sensed(small(scan={"row_time_s": 0.002}))
    picture = drawn_in_time(run.fine, run.scan, 3, 0.0).layers
    rows = np.array_split(np.arange(16), ROLLING_PARTS)
    for some in (rows[0], rows[-1]):
        cut = slice(3 * some[0], 3 * some[-1] + 3)
        np.testing.assert_array_equal(picture.radiance[cut], run.fine.at(0.002 * some.mean()).radiance[cut])


def test_a_thermal_detector_lags_and_a_frame_alone_knows_it() -> None:
    thermal = {"kind": "thermal", "pitch_um": 15.0, "netd_k": 0.05, "time_constant_s": 0.03}
    long_wave = {**SMALL, "band": {"min_um": 8.0, "max_um": 12.0}}
    wanted = parse_scenario({**long_wave, "sensor": {**SENSOR, "detector": thermal, "noise": {"temporal": False}}})
    whole, alone = prepare_sensed(wanted), prepare_sensed(wanted)
    frames = [whole.images(k)["signal"].astype(float) for k in range(5)]
    np.testing.assert_array_equal(alone.images(4)["signal"], frames[4])
    prompt = prepare_sensed(
        parse_scenario({**long_wave, "sensor": {**SENSOR, "detector": {**thermal, "time_constant_s": 0.0}, "noise": {"temporal": False}}})
    )
    now = [prompt.images(k)["signal"].astype(float) for k in range(5)]
    kept = np.exp(-0.04 / 0.03)
    expected = now[0]
    for picture in now[1:]:
        expected = (1.0 - kept) * picture + kept * expected
    np.testing.assert_allclose(frames[4], expected, atol=1.5)
    with pytest.raises(DataError, match="no electrons"):
        sg.render(wanted, "nowhere.zarr", electrons=True)


def test_a_turning_platform_blurs_along_its_turn() -> None:
    # 20 deg/s in azimuth for 1 ms: 0.35 mrad, a quarter of a pixel; noise off, one picture.
    way = {"keyframes": [{"time_s": 0.0, "azimuth_deg": 170.0}, {"time_s": 1.0, "azimuth_deg": 190.0}]}
    quick = {**SENSOR, "detector": {**SENSOR["detector"], "integration_time_s": 0.02}, "noise": {"temporal": False, "fixed_pattern": False}}
    run = prepare_sensed(parse_scenario({**SMALL, "platform": way, "sensor": quick}))
    rates = run.sensed.rates(3)
    assert rates == pytest.approx((np.radians(20.0), 0.0), abs=1e-9)
    smear = run.sensed.model.smear(rates)
    assert smear[0] == pytest.approx(np.radians(0.4))
    assert run.images(3)["signal"].shape == (16, 24)


@pytest.mark.validation
@pytest.mark.parametrize("oversampling", [3, 5, 9])
def test_finer_pictures_averaged_are_the_coarse_one(oversampling: int) -> None:
    # The default scene at its own pixels and drawn finer. Measured: means 0.11, 0.20 and 0.19 % off, variances 0.4, 0.9 and 0.9 %.
    def picture(n: int) -> np.ndarray:
        run = prepare_sequence(parse_scenario({"sensor": {"pixels": [512 * n, 256 * n]}}))
        return binned(run.at(0.0), n)["radiance"].astype(float)

    coarse, fine = picture(1), picture(oversampling)
    assert fine.mean() == pytest.approx(coarse.mean(), rel=0.003)
    for part in (slice(0, 128), slice(128, None)):
        one, other = (p[part] - p[part].mean(axis=1, keepdims=True) for p in (coarse, fine))
        assert other.var() == pytest.approx(one.var(), rel=0.05)


@pytest.mark.validation
@pytest.mark.parametrize("projection", ["equal-angle", "pinhole"])
@pytest.mark.parametrize("number", range(3))
def test_sensed_pixels_are_those_of_a_much_finer_drawing(projection: str, number: int) -> None:
    # Random sensors at the default fineness, two or three to a pixel, and eight. Measured over ten such sensors: means up to 0.5 % off,
    # deviations about each row up to 1.0 %, correlations of neighbours up to 0.010.
    rng = np.random.default_rng((7, number))
    pitch, focal = float(rng.choice([12.0, 15.0, 20.0])), float(rng.choice([0.02, 0.05]))
    sensor = {
        "projection": projection,
        "height_m": float(rng.choice([20.0, 45.0])),
        "azimuth_deg": 180.0,
        "elevation_deg": float(-np.degrees(rng.uniform(0.02, 0.12))),
        "pixels": [96, 80],
        "frame_rate_hz": 0.2,
        "frames": 9,
        "optics": {
            "focal_length_m": focal, "f_number": float(rng.uniform(1.4, 3.0)), "jitter_urad": float(rng.choice([0.0, 0.1])) * pitch / focal
        },
        "detector": {"pitch_um": pitch, "fill_factor": float(rng.choice([1.0, 0.8])), "integration_time_s": 1e-3},
    }  # fmt: skip
    sun = {"zenith_deg": float(rng.uniform(50.0, 80.0)), "azimuth_deg": 180.0}

    def statistics(render: dict) -> np.ndarray:
        run = prepare_sensed(parse_scenario({"seed": number + 1, "sun": sun, "sensor": sensor, "render": {"tile_size": 256, **render}}))
        out = []
        for frame in (0, 2, 4, 6):
            seen = run.sensed.seen(frame).astype(float)
            off = seen - seen.mean(axis=1, keepdims=True)
            power = (off**2).mean()
            across, down = (off[:, 1:] * off[:, :-1]).mean() / power, (off[1:] * off[:-1]).mean() / power
            out.append([seen.mean(), power**0.5, across, down])
        return np.mean(out, axis=0)

    default, finer = statistics({}), statistics({"oversampling": 8})
    assert default[0] == pytest.approx(finer[0], rel=0.01)
    assert default[1] == pytest.approx(finer[1], rel=0.025)
    np.testing.assert_allclose(default[2:], finer[2:], atol=0.03)


@pytest.mark.validation
def test_the_chain_costs_little_beside_the_finer_drawing() -> None:
    # Measured on one core: 2.0 s, 4.5 s for nine times the pixels, and 0.04 s for the chain.
    coarse, fine, plane, expose = measured()
    assert plane + expose < 0.3 * fine
    assert fine < 9.0 * coarse


def test_all_doors_take_the_same_image_of_a_run_with_counts_and_radiance(tmp_path) -> None:
    """One default: what the detector gives, also where the radiance at the aperture stands beside it."""
    from seaglint.formats.export.stack import select
    from seaglint.formats.recording import open_recording
    from seaglint.viewer.frame_source import open_path

    sensor = {"pixels": [24, 16], "frames": 2, "optics": {"focal_length_m": 0.05, "f_number": 2.5}, "detector": {"pitch_um": 15.0}}
    store = tmp_path / "run.zarr"
    render(parse_scenario({"sensor": sensor}), store, radiance=True)
    assert open_recording(store).units == "count"
    assert next(iter(open_path(store).layers)) == "signal"
    with open_sequence(store) as run:
        assert {"signal", "radiance"} <= set(run.data_vars)
        assert select(run).variable == "signal"
        alone = run.drop_vars("radiance")
        np.testing.assert_array_equal(sg.apparent_temperature(run), sg.apparent_temperature(alone))
