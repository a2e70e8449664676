"""Cameras from the numbers of a data sheet."""

import tomllib

import numpy as np
import pytest

from seaglint.base.errors import DataError, ScenarioError
from seaglint.instrument.figures_of_merit import figures
from seaglint.scenario.camera import EXAMPLE, read_camera, with_camera
from seaglint.scenario.load import parse_scenario
from seaglint.scenario.presets import PRESETS
from seaglint.scenario.text.template import DATA, template, write_template
from seaglint.studies.build.sensor_model import sensor_model


def test_the_numbers_of_a_data_sheet_are_those_of_the_sensor():
    sensor = parse_scenario(with_camera({}, read_camera(EXAMPLE)))
    model = sensor_model(sensor)
    assert sensor.sensor.pixels == (640, 512)
    assert (sensor.band.min_um, sensor.band.max_um) == (7.5, 13.5)
    assert model.ifov == pytest.approx(17e-6 / 35e-3, rel=1e-12)
    assert model.optics.f_number == pytest.approx(1.1, rel=1e-12)
    # 0.04 % of quantisation beside the noise that is stated
    assert figures(model).netd_k == pytest.approx(0.05, rel=1e-3)


def test_a_key_in_any_unit_of_its_kind_is_the_same_number():
    words = (
        "pitch_um=15,pixels=320x256,focal_length_m=0.05,aperture_m=0.025,integration_time_s=0.0021,band_um=3.4-4.9",
        "pitch_nm=15000,pixels=320x256,focal_length_cm=5,aperture_mm=25,integration_time_ms=2.1,band_nm=3400-4900",
        "pitch_mm=0.015, pixels=320*256, focal_length_mm=50, aperture_cm=2.5, integration_time_us=2100, band_um=3.4 to 4.9",
    )
    first, *others = (read_camera(text).tables for text in words)
    assert all(other == first for other in others)


def test_a_file_says_what_text_says_and_a_scenario_is_a_camera(tmp_path):
    path = tmp_path / "camera.toml"
    path.write_text('pitch_um = 17\npixels = "640x512"\nfocal_length_mm = 35\nf_number = 1.1\nnetd_mk = 50\nband_um = "7.5-13.5"\n')
    assert read_camera(str(path)) == read_camera(EXAMPLE)
    whole = write_template(tmp_path / "whole.toml", camera=read_camera(EXAMPLE))
    again = tomllib.loads(template("calm", read_camera(str(whole))))
    once = tomllib.loads(whole.read_text())
    for table in ("optics", "detector"):
        assert again["sensor"][table] == once["sensor"][table]
    assert again["band"] == once["band"]


@pytest.mark.parametrize("preset", PRESETS)
def test_every_preset_takes_a_camera_and_its_lens_may_be_changed(preset):
    raw = tomllib.loads(template(preset, read_camera(EXAMPLE)))
    raw["sensor"]["optics"]["focal_length_m"] *= 2.0
    half = parse_scenario(raw, base=DATA).sensor
    assert half.fov_deg[0] == pytest.approx(np.degrees(640 * 17e-6 / 0.07), rel=1e-9)


@pytest.mark.parametrize("seed", range(12))
def test_the_horizon_is_in_view_of_any_lens(seed):
    rng = np.random.default_rng(seed)
    width, height, focal = rng.integers(64, 1281), rng.integers(64, 1025), rng.uniform(15.0, 300.0)
    text = f"pitch_um=12,pixels={width}x{height},focal_length_mm={focal:.4g},f_number=1.5,netd_mk=40,band_um=8-12,projection=pinhole"
    sensor = parse_scenario(with_camera({}, read_camera(text))).sensor
    top, bottom = sensor.elevation_deg + 0.5 * sensor.fov_deg[1], sensor.elevation_deg - 0.5 * sensor.fov_deg[1]
    assert bottom < 0.0 < top
    assert top == pytest.approx(sensor.fov_deg[1] / 16.0, abs=1e-3)


@pytest.mark.parametrize(
    ("text", "kind", "assumed"),
    [
        ("netd_mk=50,band_um=8-12", "thermal", 2),
        ("netd_mk=50,band_um=8-12,netd_f_number=1", "thermal", 0),
        ("netd_mk=20,band_um=3.5-5", "photon", 1),
        ("netd_mk=20,band_um=8-12,integration_time_us=300", "photon", 0),
        ("netd_mk=20,band_um=8-12,kind=photon", "photon", 0),
        ("netd_mk=50,band_um=3.5-5,time_constant_ms=8", "thermal", 1),
        ("read_noise_e=300", "photon", 1),
    ],
)
def test_what_is_not_said_is_assumed_and_told(text, kind, assumed):
    camera = read_camera(f"pitch_um=15,pixels=64x48,focal_length_mm=50,f_number=2,{text}")
    assert camera.tables["sensor"]["detector"]["kind"] == kind
    assert len(camera.assumed) == assumed
    parse_scenario(with_camera({}, camera))


BASE = "pitch_um=17,pixels=640x512,focal_length_mm=35,f_number=1.1"


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("pich_um=17", "did you mean pitch_um"),
        ("pitch=17", "pitch=17 has no unit; write pitch_um=17"),
        ("pitch_um", "no key=value"),
        (f"{BASE},,", "no key=value"),
        (f"{BASE},pitch_um=15", "given twice"),
        (f"{BASE},pitch_mm=0.015", "given twice"),
        (f"{BASE},band=8-12", "band=8-12 has no unit"),
        (f"{BASE},band_um=8", "is no band"),
        (f"{BASE},band_kg=8-12", "is no band"),
        (f"{BASE},focal_length_kg=3", "unknown key"),
        (f"{BASE},netd_mk=fifty", "netd_mk is an unknown key; did you mean netd_k"),
        ("netd_mk=50", "misses pixels=640x512, pitch_um=17, f_number=1.1"),
        ("pitch_um=17,pixels=640,focal_length_mm=35,f_number=1.1", "sensor.pixels = 640 must be a list of 2 numbers"),
        ("pitch_um=17,pixels=640x512,f_number=1.1", "focal_length_m is missing"),
        (f"{BASE},netd_mk=20,band_um=3-5,integration_time_ms=3,read_noise_e=400", "any two of the three give the third"),
    ],
)
def test_a_camera_that_cannot_be_is_told_in_one_line(text, told):
    with pytest.raises(ScenarioError) as error:
        with_camera({}, read_camera(text))
    assert told in str(error.value)
    assert "\n" not in str(error.value)


def test_a_file_that_is_no_camera(tmp_path):
    with pytest.raises(DataError, match="no such file"):
        read_camera(str(tmp_path / "nix.toml"))
    path = tmp_path / "camera.toml"
    path.write_text("pixels = 640x512\n")
    with pytest.raises(DataError, match="not valid TOML"):
        read_camera(str(path))
    path.write_text("[lens]\nf_number = 2\n")
    with pytest.raises(ScenarioError, match=r"\[lens\] is no table of a camera"):
        read_camera(str(path))
