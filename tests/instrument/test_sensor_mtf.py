"""Figures of a sensor by the transfer of its pictures: points drawn through the whole chain, and noise that is drawn."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from sensors import camera, flat

from seaglint.base.errors import DataError, DomainError, ScenarioError
from seaglint.formats.recording import open_recording
from seaglint.instrument.chain import SensorModel
from seaglint.instrument.figures_of_merit import BACKGROUND, figures, mtf, point_response
from seaglint.instrument.noise import DetectorNoise
from seaglint.instrument.optics import SensorOptics
from seaglint.instrument.transfer import margins, padded_shape
from seaglint.scenario.load import parse_scenario
from seaglint.studies.build.sensor_model import sensor_model
from seaglint.studies.mean.sensor_figures import describe_sensor
from seaglint.studies.sequence import memory
from seaglint.studies.sequence.memory import memory_needed, require_memory
from seaglint.studies.sequence.sense import prepare_sense

SIZE, FINE = 65, 15


def drawn(seed: int) -> tuple[SensorModel, tuple[float, float]]:
    """A camera with every cause of blur at random, and a platform that turns."""
    rng = np.random.default_rng(seed)
    pixel = 1.5e-4
    optics = SensorOptics(
        0.1 / rng.uniform(1.5, 4.0),
        0.1,
        obscuration=rng.choice([0.0, 0.3]),
        wavefront_error=rng.uniform(0.0, 0.1),
        defocus=rng.uniform(0.0, 0.5),
        jitter=rng.uniform(0.0, 1.5) * pixel * rng.integers(0, 2),
        drift=tuple(rng.uniform(-1.5, 1.5, 2) * pixel / 2e-3 * rng.integers(0, 2, 2)),
        stray_share=rng.uniform(0.0, 0.2) * rng.integers(0, 2),
    )
    crosstalk = rng.uniform(0.0, 0.6) * rng.integers(0, 2)
    model = camera(DetectorNoise(), optics=optics, fill_factor=rng.uniform(0.3, 1.0), crosstalk=crosstalk, read_noise=300.0)
    return model, tuple(rng.uniform(-1.0, 1.0, 2) * pixel / 2e-3 * rng.integers(0, 2))


def middle(model: SensorModel, rates: tuple[float, float]) -> float:
    """What a point of 1 pixel's light adds to the pixel at whose centre it stands."""
    picture = np.zeros((SIZE * FINE, SIZE * FINE), np.float32)
    picture[SIZE * FINE // 2, SIZE * FINE // 2] = FINE**2
    return float(model.focal_plane(picture, FINE, rates)[SIZE // 2, SIZE // 2])


@pytest.mark.parametrize("seed", range(10))
def test_a_point_and_the_nei_are_those_of_pictures(seed):
    """The irradiance of the NEI, drawn as a point, changes its pixel by the noise of flat fields."""
    model, rates = drawn(seed)
    seen = middle(model, rates)
    # what is drawn is a square of a 15th of a pixel, whose own transfer the picture takes out; the rest is the stray light's mean
    assert seen == pytest.approx(point_response(model, rates), rel=0.01, abs=2e-4)
    sheet = figures(model, rates=rates)
    assert sheet.point_share == pytest.approx(model.detector.fill_factor * seen, rel=0.01, abs=2e-4)
    still = replace(model, noise=replace(model.noise, fixed_pattern=False)) if hasattr(model.noise, "fixed_pattern") else model
    field = flat(model, BACKGROUND, 128)
    spread = float(np.std(still.expose(field, 0).units - still.expose(field, 1).units)) / np.sqrt(2.0)
    radiance = sheet.nei_w_m2 / model.ifov**2 * seen
    # 128 x 128 pixels of two frames: a standard error of 0.6 %
    assert model.readout.per_radiance * radiance == pytest.approx(spread, rel=0.03)


@pytest.mark.parametrize("pixels", [10.0, 20.0, 40.0])
def test_wide_jitter_is_the_gaussian_of_its_width(pixels):
    """Optics are sharp beside it: the response is p^2 / (2 pi s^2) with the pixel's own p^2 / 12 in s^2."""
    model = camera(optics=SensorOptics(0.1, 0.1, jitter=pixels * 1.5e-4))
    assert point_response(model) == pytest.approx(1.0 / (2.0 * np.pi * (pixels**2 + 1.0 / 12.0)), rel=0.01)
    fine = np.zeros((201, 201), np.float32)
    fine[100, 100] = 1.0
    seen = model.focal_plane(fine)
    across = np.arange(201) - 100
    expected = np.exp(-0.5 * (across[:, None] ** 2 + across[None, :] ** 2) / pixels**2) / (2.0 * np.pi * pixels**2)
    np.testing.assert_allclose(seen, expected, atol=0.05 * expected.max())


def test_movement_of_the_platform_is_in_the_figures():
    """A turn of 20 degrees a second in 2 ms is 0.7 mrad."""
    camera_ = {"optics": {"aperture_m": 0.05, "focal_length_m": 0.1}, "detector": {"pitch_um": 15, "integration_time_s": 2e-3}}
    sensor = {"pixels": [64, 48], "elevation_deg": 0.0, "frames": 20, "frame_rate_hz": 20.0, "projection": "equal-angle", **camera_}
    turning = [{"time_s": 0, "azimuth_deg": 0.0}, {"time_s": 2, "azimuth_deg": 40.0}]
    settings = {"sensor": sensor, "sea": {"resolve_waves": False}}
    still, moved = (describe_sensor(parse_scenario(s)).sheet for s in (settings, {**settings, "platform": {"keyframes": turning}}))
    smear = np.radians(20.0) * 2e-3
    assert moved.mtf.parts["along"]["motion"] == pytest.approx(np.sinc(1e3 * np.array(moved.mtf.frequency_cycles_per_mrad) * smear))
    assert "motion" not in moved.mtf.parts["across"]
    assert moved.nei_w_m2 > 2.0 * still.nei_w_m2
    model = sensor_model(parse_scenario(settings))
    assert moved.point_response == pytest.approx(middle(model, (np.radians(20.0), 0.0)), rel=0.01)


def scenario(optics=None, detector=None, pixels=(64, 48), **more):
    camera_ = {
        "optics": {"aperture_m": 0.05, "focal_length_m": 0.1, **(optics or {})},
        "detector": {"pitch_um": 15, "integration_time_s": 2e-3, "well_capacity_e": 1e6, **(detector or {})},
    }
    return parse_scenario({"sensor": {"pixels": list(pixels), "elevation_deg": 0.0, **camera_, **more}, "sea": {"resolve_waves": False}})


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"optics": {"jitter_urad": 1e5}}, r"sensor\.optics\.jitter_urad = 100000 is 666\.7 pixels rms.*up to 2400 urad"),
        ({"optics": {"jitter_urad": 2500}}, r"sensor\.optics\.jitter_urad = 2500 is 16\.67 pixels rms"),
        ({"optics": {"drift_along_urad_s": 1e8}}, r"sensor\.optics\.drift_along_urad_s = 1e\+08 moves the picture by 1333 pixels"),
        ({"optics": {"drift_across_urad_s": -1e8}}, r"sensor\.optics\.drift_across_urad_s = -1e\+08 moves the picture by 1333 pixels"),
        ({"detector": {"dark_current_e_s": 5e8}}, r"= 5e\+08 fills the well of 1e\+06 electrons in 0\.002 s; allowed are below"),
        ({"detector": {"dark_current_e_s": 1e13, "short_integration_time_s": 1e-6}}, r"fills the well of 1e\+06 electrons in 1e-06 s"),
        ({"detector": {"dark_current_e_s": 6e8, "short_integration_time_s": 1e-6}}, r"fills the well of 1e\+06 electrons in 0\.002 s"),
        ({"detector": {"integration_time_s": 0.1}}, r"integration_time_s = 0\.1 is longer than a frame of 0\.04 s"),
    ],
)
def test_what_no_sensor_can_do_is_refused_in_a_line(settings, message):
    with pytest.raises(ScenarioError, match=message) as error:
        scenario(**settings)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(("sides", "most"), [((64, 48), 16.0), ((640, 512), 128.0), ((512, 1), 16.0)])
def test_jitter_is_allowed_up_to_a_quarter_of_the_smaller_side(sides, most):
    assert scenario({"jitter_urad": 0.999 * most * 150.0}, pixels=sides, pixel_shape="any").sensor.optics.jitter_urad > 0.0
    with pytest.raises(ScenarioError, match="pixels rms"):
        scenario({"jitter_urad": 1.001 * most * 150.0}, pixels=sides, pixel_shape="any")


def test_a_transfer_refuses_what_the_scenario_would():
    model = camera(optics=SensorOptics(0.05, 0.1, jitter=0.1))
    with pytest.raises(DomainError, match=r"jitter = 666\.7 pixels rms is too wide for a picture of 48 x 64 pixels; allowed are up to 16"):
        model.transfer((48, 64), 1)


def test_margins_end_however_wide_the_blur_is():
    shape = (48, 64)
    for jitter, drift in ((1e-1, 0.0), (2e-3, 1e4), (0.0, -1e6)):
        model = camera(optics=SensorOptics(0.05, 0.1, jitter=jitter, drift=(drift, drift)))
        above, left = margins(model.blur, model.sampling(3), shape)
        assert max(above, left) < 64 + 64 + 100
        assert padded_shape(model.blur, model.sampling(3), shape)[0] >= shape[0] + 2 * above


def test_blur_is_in_the_memory_that_is_asked_for_before(monkeypatch):
    sharp, soft = scenario(pixels=(1024, 768)), scenario({"jitter_urad": 0.24 * 768 * 150.0}, pixels=(1024, 768))
    need = [memory_needed(one, 3, sensor_model(one)) for one in (sharp, soft)]
    assert need[1] > 2.0 * need[0]
    monkeypatch.setattr(memory, "memory_available", lambda: (need[0] + need[1]) // 2)
    require_memory(sharp, 3, sensor_model(sharp))
    with pytest.raises(ScenarioError, match="GB of memory") as error:
        require_memory(soft, 3, sensor_model(soft))
    assert "\n" not in str(error.value)


def test_a_recording_too_small_for_the_blur_or_too_large_for_the_memory_is_refused_before_it_is_read(tmp_path, monkeypatch):
    np.save(tmp_path / "small.npy", np.ones((2, 32, 40), np.float32))
    opened = open_recording(tmp_path / "small.npy", frame_rate=25.0)
    soft = scenario({"jitter_urad": 100.0 * 150.0}, pixels=(640, 512))
    with pytest.raises(DataError, match=r"small\.npy: sensor\.optics\.jitter_urad = 15000: jitter = 100 pixels rms is too wide") as error:
        prepare_sense(opened, soft, oversampling=1)
    assert "\n" not in str(error.value)
    monkeypatch.setattr(memory, "memory_available", lambda: 1 << 20)
    with pytest.raises(DataError, match=r"small\.npy: blur of 40 x 32 pixels, 1 x 1 finer, needs about 0\.3 GB of memory"):
        prepare_sense(opened, scenario(), oversampling=1)


def test_a_background_that_fills_the_well_is_reported(caplog):
    warm = {"emissivity": 0.9, "temperature_k": 400.0}
    with caplog.at_level("WARNING", logger="seaglint.reports"):
        model = sensor_model(scenario(warm, {"well_capacity_e": 1e5}))
    assert model.readout.background > 1e5
    assert [record.getMessage().count("\n") for record in caplog.records] == [0]
    assert "every pixel is saturated" in caplog.text
    assert model.expose(np.zeros((4, 4), np.float32)).saturated == 16


def test_the_total_is_the_product_of_what_is_listed():
    model, rates = drawn(3)
    for parts in mtf(model, np.linspace(0.0, 9e3, 50), rates).values():
        product = np.prod([part for name, part in parts.items() if name != "total"], axis=0)
        np.testing.assert_allclose(parts["total"], product, atol=2e-5)  # the table of the optics is linear between its nodes
