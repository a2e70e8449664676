"""Tables of the sensor: alternatives that agree, defaults that are neutral, mistakes told in a line."""

from __future__ import annotations

import math
from dataclasses import fields

import numpy as np
import pytest
from scipy import constants

from seaglint.base.errors import ScenarioError
from seaglint.instrument.bolometer import ThermalPixels
from seaglint.instrument.detector import PhotonPixels
from seaglint.instrument.figures_of_merit import figures
from seaglint.instrument.noise import DetectorNoise
from seaglint.instrument.optics import SensorOptics
from seaglint.scenario.load import load_scenario, parse_scenario
from seaglint.scenario.presets import SENSORS, with_sensor
from seaglint.studies.build.sensor_model import sensor_model

OPTICS = {"aperture_m": 0.05, "f_number": 4.0}
PIXELS = {"pitch_um": 15.0}


def parsed(optics=OPTICS, detector=PIXELS, **sensor):
    return parse_scenario({"sensor": {"optics": optics, "detector": detector, **sensor}})


def refusal(optics=OPTICS, detector=PIXELS, **sensor) -> str:
    with pytest.raises(ScenarioError) as caught:
        parsed(optics, detector, **sensor)
    assert "\n" not in str(caught.value)
    return str(caught.value)


@pytest.mark.parametrize(
    ("optics", "more"),
    [
        ({"aperture_m": 0.05, "f_number": 4.0}, {}),
        ({"aperture_m": 0.05, "focal_length_m": 0.2}, {}),
        ({"f_number": 4.0, "focal_length_m": 0.2}, {}),
        ({"f_number": 4.0, "ifov_urad": 75.0}, {}),
        ({"f_number": 4.0}, {"fov_deg": [math.degrees(75e-6) * 512, math.degrees(75e-6) * 256]}),
        ({"aperture_m": 0.05, "focal_length_m": 0.2, "f_number": 4.01, "ifov_urad": 75.2}, {"fov_deg": [2.2, 1.1]}),
    ],
    ids=["aperture and f-number", "aperture and focal length", "f-number and focal length", "IFOV", "field of view", "all, rounded"],
)
def test_every_way_to_give_the_optics(optics, more) -> None:
    scenario = parsed(optics, **more)
    assert scenario.sensor.focal_length_m == pytest.approx(0.2, rel=0.005)
    assert scenario.sensor.aperture_m == pytest.approx(0.05, rel=0.005)
    assert math.radians(scenario.sensor.ifov_deg[0]) == pytest.approx(75e-6, rel=0.005)


def test_a_plane_picture_has_the_tangents_field_of_view() -> None:
    sensor = parsed({"f_number": 2.0, "focal_length_m": 0.01}, projection="pinhole").sensor
    assert math.tan(math.radians(0.5 * sensor.fov_deg[0])) == pytest.approx(256 * 15e-6 / 0.01)


def test_what_is_not_given_is_neutral() -> None:
    model = sensor_model(parsed())
    optics, detector, noise = model.optics, model.detector, model.noise
    assert isinstance(detector, PhotonPixels)
    assert (optics.transmission, optics.obscuration, optics.jitter, optics.wavefront_error, optics.defocus) == (1.0, 0.0, 0.0, 0.0, 0.0)
    assert (optics.emissivity, optics.housing_solid_angle, optics.stray_share, optics.cos4, optics.distortion) == (
        0.0,
        0.0,
        0.0,
        False,
        0.0,
    )
    assert (detector.fill_factor, detector.quantum_efficiency, detector.offset, detector.crosstalk) == (1.0, 1.0, 0.0, 0.0)
    assert (detector.read_noise, detector.dark_current, detector.integration_time) == (0.0, 0.0, 0.04)
    assert (noise.temporal, noise.fixed_pattern, noise.one_over_f, noise.gain_spread, noise.dead_share) == (True, True, 0.0, 0.0, 0.0)
    assert model.readout.background == 0.0


BOLOMETER = {"kind": "thermal", "pitch_um": 15.0, "netd_k": 0.05}


@pytest.mark.parametrize(
    ("table", "key", "value", "part", "name", "expected"),
    [
        ("optics", "transmission", 0.7, "optics", "transmission", 0.7),
        ("optics", "wavefront_error_waves", 0.1, "optics", "wavefront_error", 0.1),
        ("optics", "defocus_waves", 0.2, "optics", "defocus", 0.2),
        ("optics", "jitter_urad", 20.0, "optics", "jitter", 1e-6 * 20.0),
        ("optics", "drift_along_urad_s", 20.0, "optics", "drift", (1e-6 * 20.0, 0.0)),
        ("optics", "drift_across_urad_s", 20.0, "optics", "drift", (0.0, 1e-6 * 20.0)),
        ("optics", "temperature_k", 280.0, "optics", "temperature", 280.0),
        ("optics", "cold_shield_f_number", 1.5, "optics", "cold_shield_f_number", 1.5),
        ("optics", "solid_angle", "thin-lens", "optics", "solid_angle_law", "thin-lens"),
        ("optics", "cos4", True, "optics", "cos4", True),
        ("photon", "integration_time_s", 0.002, "detector", "integration_time", 0.002),
        ("photon", "read_noise_e", 30.0, "detector", "read_noise", 30.0),
        ("photon", "dark_current_e_s", 1e6, "detector", "dark_current", 1e6),
        ("photon", "gain_e_per_count", 40.0, "detector", "gain", 40.0),
        ("photon", "offset_counts", 100.0, "detector", "offset", 100.0),
        ("photon", "crosstalk", 0.1, "detector", "crosstalk", 0.1),
        ("thermal", "netd_k", 0.03, "detector", "netd", 0.03),
        ("thermal", "netd_f_number", 1.4, "detector", "netd_f_number", 1.4),
        ("thermal", "netd_temperature_k", 310.0, "detector", "netd_temperature", 310.0),
        ("thermal", "time_constant_s", 0.01, "detector", "time_constant", 0.01),
        ("thermal", "full_scale_k", 500.0, "detector", "full_scale_temperature", 500.0),
        ("thermal", "pitch_um", 12.0, "detector", "pitch", 12e-6),
        ("noise", "temporal", False, "noise", "temporal", False),
        ("noise", "row", 7.0, "noise", "row", 7.0),
        ("noise", "hot_signal", 7.0, "noise", "hot_signal", 7.0),
        ("noise", "drift_per_hour", 7.0, "noise", "drift_per_hour", 7.0),
        ("noise", "blinking_time_s", 7.0, "noise", "blinking_time", 7.0),
    ],
)
def test_a_key_reaches_the_sensor_in_si_units(table, key: str, value, part: str, name: str, expected) -> None:
    """Keys that name a unit are converted; the rest go over as they are."""
    tables = {"optics": OPTICS, "detector": BOLOMETER if table == "thermal" else PIXELS, "noise": {}}
    place = "detector" if table in ("photon", "thermal") else table
    model = sensor_model(parsed(**(tables | {place: tables[place] | {key: value}})))
    assert getattr(getattr(model, part), name) == expected  # bit for bit: the unit is one factor


def test_no_key_is_forgotten() -> None:
    """Each key is a field of the sensor's records, or one of those that the scenario itself turns into them."""
    own = {"kind", "focal_length", "aperture", "f_number", "ifov", "drift_along", "drift_across", "solid_angle", "quantum_efficiency_file"}
    tables = parsed(noise={}).sensor, parsed(detector=BOLOMETER).sensor
    pairs = [
        (tables[0].optics, SensorOptics),
        (tables[0].detector, PhotonPixels),
        (tables[1].detector, ThermalPixels),
        (tables[0].noise, DetectorNoise),
    ]
    stated = {"netd", "netd_temperature"}  # a photon detector's, from which its read noise or integration time follows
    for record, kind in pairs:
        assert set(record.in_si()) - {one.name for one in fields(kind)} - own - stated <= {"full_scale"}


def test_a_well_fills_the_counts() -> None:
    model = sensor_model(parsed(detector=PIXELS | {"well_capacity_e": 7e6, "bit_depth": 14}))
    assert figures(model).electrons_per_count == pytest.approx(7e6 / 16383)
    with_offset = sensor_model(parsed(detector=PIXELS | {"well_capacity_e": 7e6, "bit_depth": 14, "offset_counts": 383.0}))
    assert with_offset.readout.gain == pytest.approx(7e6 / 16000)


@pytest.mark.parametrize(
    ("tables", "key", "remedy"),
    [
        ({"optics": OPTICS | {"obscuration": 1.0}}, "sensor.optics.obscuration", "0 to below 1"),
        ({"optics": OPTICS | {"focal_length_m": 0.3}}, "sensor.optics.f_number", "leave it out"),
        ({"optics": OPTICS | {"ifov_urad": 80}}, "sensor.optics.ifov_urad", "0.5 %"),
        ({"fov_deg": [16, 8]}, "sensor.fov_deg", "leave fov_deg out"),
        ({"optics": {"aperture_m": 0.05}}, "sensor.optics.focal_length_m", "give it"),
        ({"optics": {"focal_length_m": 0.05}}, "sensor.optics.aperture_m", "f_number"),
        ({"optics": {"focal_length_m": 0.05, "aperture_m": 0.2}}, "sensor.optics.aperture_m", "F/0.5"),
        ({"detector": PIXELS | {"well_capacity_e": 10, "read_noise_e": 50}}, "sensor.detector.well_capacity_e", "correct one"),
        ({"detector": PIXELS | {"bit_depth": 17}}, "sensor.detector.bit_depth", "1 to 16"),
        ({"detector": PIXELS | {"bit_depth": 8, "offset_counts": 300}}, "sensor.detector.offset_counts", "lower offset"),
        ({"detector": PIXELS | {"integration_time_s": 0.05}}, "sensor.detector.integration_time_s", "shorten it"),
        (
            {"detector": PIXELS | {"well_capacity_e": 7e6, "integration_time_s": 0.03, "short_integration_time_s": 0.02}},
            "integration_time_s",
            "shorten it",
        ),
        ({"detector": PIXELS | {"integration_time_s": 0.02, "short_integration_time_s": 0.01}}, "well_capacity_e", "add it"),
        ({"detector": PIXELS | {"fill_factor": 1.2}}, "sensor.detector.fill_factor", "above 0 to 1"),
        ({"detector": PIXELS | {"quantum_efficiency": 1.2}}, "sensor.detector.quantum_efficiency", "above 0 to 1"),
        ({"detector": {}}, "sensor.detector.pitch_um", "add it"),
        ({"detector": None}, "sensor.detector", "add it"),
        ({"optics": None}, "sensor.optics", "add it"),
        ({"noise": {"dead_share": 0.6, "hot_share": 0.6}}, "sensor.noise.dead_share", "up to 1"),
        ({"noise": {"corrected_at_k": [300, 300]}}, "sensor.noise.corrected_at_k", "give two"),
        ({"scan": {"period_s": 0.01}}, "sensor.scan.period_s", "leave it out"),
        ({"scan": {"kind": "line", "period_s": 0.1}}, "sensor.scan.period_s", "shorten it"),
        ({"scan": {"kind": "line", "row_time_s": 1e-6}}, "sensor.scan.row_time_s", "leave it out"),
        ({"scan": {"row_time_s": 1e-3}}, "sensor.scan.row_time_s", "shorten it"),
    ],
)
def test_mistakes_are_one_line_with_key_and_remedy(tables, key: str, remedy: str) -> None:
    given = {"optics": OPTICS, "detector": PIXELS, **tables}
    said = refusal(given.pop("optics"), given.pop("detector"), **given)
    assert key in said
    assert remedy in said


def test_noise_without_a_detector_is_refused() -> None:
    with pytest.raises(ScenarioError, match=r"sensor\.noise is given without \[sensor\.optics\]"):
        parse_scenario({"sensor": {"noise": {"temporal": False}}})


@pytest.mark.parametrize(("low", "high"), [(8.0, 12.0), (3.5, 4.5)])
def test_a_response_that_is_not_that_of_the_band_is_refused(tmp_path, low: float, high: float) -> None:
    path = tmp_path / "qe.csv"
    path.write_text(f"wavelength_um,response\n{low},0.5\n{0.5 * (low + high)},1\n{high},0.5\n")
    scenario = parsed(detector=PIXELS | {"quantum_efficiency_file": str(path)})
    with pytest.raises(ScenarioError, match=r"sensor\.detector\.quantum_efficiency_file.*over the whole band") as caught:
        sensor_model(scenario)
    assert "\n" not in str(caught.value)


def test_a_curve_of_efficiency_weights_the_photons(tmp_path) -> None:
    path = tmp_path / "qe.csv"
    path.write_text("wavelength_um,response\n3.0,0\n4.2,0\n4.3,1\n6.0,1\n")
    curve = sensor_model(parsed(detector=PIXELS | {"quantum_efficiency_file": str(path), "quantum_efficiency": 0.8}))
    plain = sensor_model(parsed(detector=PIXELS))
    assert curve.photons.electrons_per_joule < 0.8 * plain.photons.electrons_per_joule
    assert curve.photons.wavelength > plain.photons.wavelength


@pytest.mark.parametrize("name", SENSORS)
def test_presets_are_sensors_with_a_source_beside_each_number(name: str) -> None:
    chosen = SENSORS[name]
    scenario = parse_scenario(with_sensor({"sensor": {"height_m": 20.0, "fov_deg": [16, 8], "pixels": [512, 256]}}, name))
    assert scenario.sensor.height_m == 20.0
    given = {"band"}
    for key, value in chosen.sensor.items():
        given |= {f"{key}.{inner}" for inner in value} if isinstance(value, dict) else {key}
    assert given == set(chosen.sources)
    assert sensor_model(scenario).readout.gain > 0.0


def test_presets_have_the_netd_of_their_data_sheets() -> None:
    found = {name: figures(sensor_model(parse_scenario(with_sensor({}, name)))).netd_k for name in SENSORS}
    assert found["mwir-insb-640"] == pytest.approx(0.018, abs=0.002)  # below 20 mK, 18 typical
    assert found["lwir-mct-640"] == pytest.approx(0.022, abs=0.002)
    assert found["lwir-microbolometer-640"] == pytest.approx(0.040, rel=0.01)


def test_dark_current_of_mct_is_that_of_rule_07() -> None:
    # Tennant et al. 2008: J = 8367 A cm-2 exp(-1.16239 * 1.24 q / (k lambda T)) for cut-offs beyond 4.6 um, lambda in um.
    density = 8367.0 * np.exp(-1.16239 * 1.24 * constants.e / (constants.k * 9.3 * 80.0))
    assert SENSORS["lwir-mct-640"].sensor["detector"]["dark_current_e_s"] == pytest.approx(density * 15e-4**2 / constants.e, rel=0.05)


def test_an_unknown_preset_names_those_there_are(tmp_path) -> None:
    path = tmp_path / "my.toml"
    path.write_text("")
    with pytest.raises(ScenarioError, match="sensor='nix' is not one of mwir-insb-640, lwir-mct-640"):
        load_scenario(path, sensor="nix")
