"""The NETD of a photon detector's data sheet gives its read noise or its integration time."""

import dataclasses

import numpy as np
import pytest

from seaglint.base.errors import DomainError, ScenarioError
from seaglint.instrument.chain import SensorModel
from seaglint.instrument.detector import PhotonPixels
from seaglint.instrument.figures_of_merit import figures, integration_time_for, netd, read_noise_for
from seaglint.instrument.optics import SensorOptics
from seaglint.instrument.photons import Photons
from seaglint.optics.band import Band
from seaglint.scenario.load import parse_scenario
from seaglint.studies.build.sensor_model import sensor_model
from seaglint.studies.mean.sensor_figures import describe_sensor


def _model(rng: np.random.Generator, **more: float) -> SensorModel:
    low, high = [(3.0, 5.0), (3.5, 5.0), (7.7, 9.3), (8.0, 12.0)][rng.integers(4)]
    focal = rng.uniform(0.02, 0.3)
    optics = SensorOptics(focal / rng.uniform(1.2, 5.0), focal, transmission=rng.uniform(0.5, 1.0))
    pixels = PhotonPixels(rng.uniform(8e-6, 30e-6), quantum_efficiency=rng.uniform(0.3, 1.0), **more)
    return SensorModel(Photons(Band.rectangular(low, high)), optics, pixels)


@pytest.mark.parametrize("seed", range(10))
def test_what_the_netd_gives_has_that_netd(seed):
    rng = np.random.default_rng(seed)
    temperature = rng.uniform(270.0, 320.0)
    model = _model(rng, integration_time=10.0 ** rng.uniform(-4.0, -2.0), dark_current=10.0 ** rng.uniform(0.0, 6.0))
    stated = netd(model, temperature) * rng.uniform(1.05, 4.0)
    read = read_noise_for(model, stated, temperature)
    noisy = dataclasses.replace(model, detector=dataclasses.replace(model.detector, read_noise=read))
    assert netd(noisy, temperature) == pytest.approx(stated, rel=1e-9)
    time = integration_time_for(noisy, stated, temperature, 1.0)
    assert time == pytest.approx(model.detector.integration_time, rel=1e-6)


def test_a_camera_limited_by_photons_alone():
    """Closed form: (NETD S t)^2 = R t + g^2/12, with R electrons in a second, S of them for a kelvin, and steps of g electrons."""
    model = _model(np.random.default_rng(3), gain=400.0, integration_time=1.0)
    line, slope = model.readout, model.photons.radiance_slope(300.0)
    rate, growth = float(line.units(model.photons.radiance(300.0))), line.per_radiance * slope
    stated = 0.02
    a, c = (stated * growth) ** 2, 400.0**2 / 12.0
    expected = (rate + np.sqrt(rate**2 + 4.0 * a * c)) / (2.0 * a)
    assert integration_time_for(model, stated, 300.0, 1.0) == pytest.approx(expected, rel=1e-6)


def test_flat_fields_drawn_have_the_netd_that_was_stated():
    """The whole chain, from the scenario's key to counts."""
    tables = {"optics": {"focal_length_m": 0.05, "f_number": 2.5}, "detector": {"pitch_um": 15.0, "netd_k": 0.025}}
    scene = parse_scenario({"sensor": {"pixels": [64, 64], **tables}, "band": {"min_um": 3.5, "max_um": 5.0}})
    model = sensor_model(scene)
    flat = [np.full((64, 64), float(model.photons.radiance(t)), np.float32) for t in (300.0, 301.0)]
    cold, warm = (np.stack([model.sense(one, index).signal for index in range(20)]).astype(float) for one in flat)
    assert cold.std() / (warm.mean() - cold.mean()) == pytest.approx(0.025, rel=0.03)
    described = describe_sensor(scene)
    assert described.sheet.netd_k == pytest.approx(0.025, rel=1e-6)
    assert described.from_netd == {"integration_time_s": model.detector.integration_time}


def test_a_scenario_that_was_stored_is_the_same_camera():
    tables = {
        "optics": {"focal_length_m": 0.05, "f_number": 2.5},
        "detector": {"pitch_um": 15.0, "netd_k": "30 mK", "integration_time_s": 0.002},
    }
    scene = parse_scenario({"sensor": {"pixels": [64, 64], **tables}})
    again = parse_scenario(scene.model_dump(exclude_none=True, mode="json"))
    assert sensor_model(again).detector == sensor_model(scene).detector
    assert figures(sensor_model(scene)).netd_k == pytest.approx(0.03, rel=1e-6)
    assert set(describe_sensor(scene).from_netd) == {"read_noise_e"}


@pytest.mark.parametrize(
    ("detector", "told"),
    [
        ({"netd_k": 0.0001}, "longest integration, 0.04 s"),
        ({"netd_k": 0.0001, "integration_time_s": 0.001}, "without any read noise"),
        ({"netd_k": 0.02, "well_capacity_e": 1e5}, "and a pixel holds 1e.05"),
        ({"netd_k": 0.02, "integration_time_s": 0.001, "read_noise_e": 100.0}, "any two of the three"),
    ],
)
def test_an_netd_that_no_camera_has(detector, told):
    raw = {"sensor": {"optics": {"focal_length_m": 0.05, "f_number": 2.5}, "detector": {"pitch_um": 15.0, **detector}}}
    with pytest.raises(ScenarioError, match=told) as error:
        sensor_model(parse_scenario(raw))
    assert "\n" not in str(error.value)


def test_an_netd_that_any_integration_has():
    model = _model(np.random.default_rng(1))
    with pytest.raises(DomainError, match="any integration time"):
        integration_time_for(model, 1e9, 300.0, 1.0)
