"""Transfer functions against closed forms, a pupil transformed by brute force, and pyBSM."""

from __future__ import annotations

import csv
import re
from pathlib import Path

import numpy as np
import pytest

from seaglint.base.errors import DomainError
from seaglint.instrument.chain import SensorModel
from seaglint.instrument.detector import PhotonPixels, crosstalk_mtf, square_mtf
from seaglint.instrument.figures_of_merit import blur_px, mtf
from seaglint.instrument.optics import Blur, SensorOptics, cone, distorted_places, jitter_mtf, motion_mtf, pupil_mtf, wavefront_mtf
from seaglint.instrument.photons import Photons
from seaglint.optics.band import Band

PYBSM = Path(__file__).parent / "data" / "pybsm.csv"
APERTURE, FOCAL, OBSCURATION, WAVELENGTH = 0.08, 0.2, 0.3, 4.0e-6  # those of tools/pybsm_reference.py


def pybsm() -> tuple[dict[str, np.ndarray], dict[float, float]]:
    """Columns of the table, and electrons by temperature."""
    text = PYBSM.read_text()
    electrons = {float(t): float(n) for t, n in re.findall(r"blackbody at (\d+) K: (\S+)", text)}
    rows = list(csv.DictReader(line for line in text.splitlines() if not line.startswith("#")))
    return {name: np.array([float(row[name]) for row in rows]) for name in rows[0]}, electrons


@pytest.mark.parametrize(
    ("name", "ours"),
    [
        ("clear", lambda f: pupil_mtf(f * WAVELENGTH / APERTURE)),
        ("diffraction", lambda f: pupil_mtf(f * WAVELENGTH / APERTURE, OBSCURATION)),
        ("wavefront", lambda f: wavefront_mtf(f * WAVELENGTH / APERTURE, 0.07)),
        ("detector", lambda f: square_mtf(f, 15e-6 / FOCAL)),
        ("jitter", lambda f: jitter_mtf(f, 20e-6)),
    ],
)
def test_transfer_functions_are_those_of_pybsm(name, ours) -> None:
    table, _ = pybsm()
    np.testing.assert_allclose(ours(table["cycles_per_rad"]), table[name], atol=0.001)


def test_electrons_of_a_blackbody_are_those_of_pybsm() -> None:
    # pyBSM has the thin lens's solid angle; spectrum by spectrum there, the band's mean conversion here: equal at the reference.
    _, electrons = pybsm()
    optics = SensorOptics(APERTURE, FOCAL, transmission=0.8, obscuration=OBSCURATION, solid_angle_law="thin-lens")
    model = SensorModel(Photons(Band.rectangular(3.5, 5.0), None, 0.7), optics, PhotonPixels(15e-6, integration_time=2e-3))
    for temperature, expected in electrons.items():
        radiance = float(model.photons.radiance(temperature))
        light = model.detector.active_area * optics.solid_angle * optics.transmission * 2e-3
        assert light * float(model.photons.photon_radiance(temperature)) == pytest.approx(expected, rel=1e-4)
        told = 1.0 + model.photons.error(temperature)
        assert float(model.readout.units(radiance)) == pytest.approx(expected * told, rel=1e-4)
    assert model.photons.error(300.0) == 0.0
    assert abs(model.photons.error(280.0)) < 0.01


def brute_force(v: np.ndarray, obscuration: float, defocus: float) -> np.ndarray:
    """Autocorrelation of a sampled pupil by its Fourier transform."""
    count, radius = 1024, 150.0
    y, x = (np.mgrid[0:count, 0:count] - 0.5 * (count - 1)) / radius
    rho = np.hypot(x, y)
    pupil = np.where((rho <= 1.0) & (rho >= obscuration), np.exp(2j * np.pi * defocus * rho**2), 0.0)
    transfer = np.fft.ifft2(np.abs(np.fft.fft2(pupil)) ** 2).real
    return np.interp(v * 2.0 * radius, np.arange(count // 2), transfer[0, : count // 2] / transfer[0, 0])


@pytest.mark.parametrize(("obscuration", "defocus"), [(0.0, 0.0), (0.4, 0.0), (0.0, 0.3), (0.4, 0.5), (0.7, 0.2)])
def test_pupils_are_those_of_brute_force(obscuration: float, defocus: float) -> None:
    v = np.linspace(0.0, 1.0, 41)
    np.testing.assert_allclose(pupil_mtf(v, obscuration, defocus), brute_force(v, obscuration, defocus), atol=0.005)


def test_a_clear_circle_is_the_closed_form() -> None:
    v = np.linspace(0.0, 1.0, 101)
    np.testing.assert_allclose(pupil_mtf(v), 2 / np.pi * (np.arccos(v) - v * np.sqrt(1 - v * v)), atol=1e-6)


def test_the_band_is_averaged_with_the_photons_weight() -> None:
    # Two lines, three quarters of the electrons at the longer one: the mean of their transfers, not the transfer of their mean.
    optics, lines, share = SensorOptics(0.05, 0.2), np.array([3.0e-6, 5.0e-6]), np.array([0.25, 0.75])
    blur = Blur.of(optics, lines, share)
    f = 0.9 * optics.cutoff(5.0e-6)
    expected = 0.25 * pupil_mtf(f * 3.0e-6 / 0.05) + 0.75 * pupil_mtf(0.9)
    assert float(blur.parts([f])["diffraction"][0]) == pytest.approx(float(expected), abs=2e-5)
    assert float(blur.parts([0.5 * (optics.cutoff(3e-6) + optics.cutoff(5e-6))])["diffraction"][0]) > 0.0


@pytest.mark.parametrize("silent", [0, 20])
def test_defocus_of_few_lines_is_their_mean(silent: int) -> None:
    """The path error is the same length at every line, whatever their number and however many of them give no electrons."""
    lines, share = np.array([3.0e-6, 5.0e-6]), np.array([0.25, 0.75])
    optics, mean = SensorOptics(0.05, 0.2, defocus=0.3), float(lines @ share)
    dark = np.linspace(3.1e-6, 4.9e-6, silent)
    blur = Blur.of(optics, np.append(lines, dark), np.append(share, np.zeros(silent)))
    f = np.linspace(0.05, 0.9, 9) * optics.cutoff(5.0e-6)
    expected = sum(s * pupil_mtf(f * line / 0.05, defocus=0.3 * mean / line) for line, s in zip(lines, share, strict=True))
    parts = blur.parts(f)
    np.testing.assert_allclose(parts["diffraction"] * parts["defocus"], expected, atol=2e-5)  # the table's nodes


def test_jitter_and_motion_at_known_points() -> None:
    assert float(jitter_mtf(1.0 / (2.0 * np.pi * 1e-5), 1e-5)) == pytest.approx(np.exp(-0.5))
    assert float(motion_mtf(1e4, 1e-4)) == pytest.approx(0.0, abs=1e-12)
    assert float(motion_mtf(5e3, 1e-4)) == pytest.approx(2.0 / np.pi)


def test_solid_angle_of_the_sine_condition_makes_points_and_fields_agree() -> None:
    optics = SensorOptics(0.05, 0.1, obscuration=0.4)
    pixel = (15e-6 / optics.focal_length) ** 2
    assert 15e-6**2 * optics.solid_angle == pytest.approx(optics.pupil_area * pixel)
    assert cone(2.0) / cone(2.0, "thin-lens") == pytest.approx(17.0 / 16.0)
    assert optics.open_share == pytest.approx(0.84)


def test_total_is_the_product_of_its_parts_along_and_across() -> None:
    optics = SensorOptics(0.05, 0.2, wavefront_error=0.05, defocus=0.2, jitter=1e-5, drift=(0.01, 0.0))
    model = SensorModel(Photons(Band.rectangular(3.5, 5.0)), optics, PhotonPixels(15e-6, integration_time=5e-3, crosstalk=0.1))
    found = mtf(model, np.linspace(0.0, 6e3, 7))
    assert set(found["along"]) == {"diffraction", "defocus", "wavefront", "jitter", "detector", "crosstalk", "motion", "total"}
    assert "motion" not in found["across"]
    for parts in found.values():
        product = np.prod([part for name, part in parts.items() if name != "total"], axis=0)
        # the table of the optics, linear between its nodes, is within 1e-5
        np.testing.assert_allclose(parts["total"], product, rtol=1e-5)
        assert parts["total"][0] == pytest.approx(1.0, abs=1e-6)


def test_distortion_moves_corners_by_its_share() -> None:
    y, x = distorted_places((201, 301), 0.1)
    middle = (100, 150)
    assert (y[middle], x[middle]) == pytest.approx(middle)
    # what is drawn in the corner lies at the radius r with r (1 + 0.1 r^2) = 1, a little inside
    drawn, seen = np.hypot(100.0, 150.0), np.hypot(y[0, 0] - 100.0, x[0, 0] - 150.0)
    corner = np.hypot(100.5, 150.5)
    assert drawn == pytest.approx(seen * (1.0 + 0.1 * (seen / corner) ** 2), rel=1e-9)


@pytest.mark.parametrize("values", [{"obscuration": 1.0}, {"obscuration": -0.1}, {"wavefront_error": 0.3}])
def test_impossible_optics_are_refused(values) -> None:
    with pytest.raises(DomainError, match="give"):
        SensorOptics(0.05, 0.2, **values)


def test_crosstalk_is_the_transform_of_what_each_neighbour_gets():
    """A quarter of the share to each of the four neighbours, the rest to the pixel itself."""
    share, pitch = 0.2, 1.5e-4
    x, y = np.random.default_rng(2).uniform(0.0, 1.0 / pitch, (2, 30))
    places = np.array([(0, 0), (1, 0), (-1, 0), (0, 1), (0, -1)]) * pitch
    weights = np.array([1.0 - share, *[0.25 * share] * 4])
    expected = np.exp(2j * np.pi * (np.outer(x, places[:, 0]) + np.outer(y, places[:, 1]))) @ weights
    assert crosstalk_mtf(x, y, share, pitch) == pytest.approx(expected.real, abs=1e-12)
    assert np.abs(expected.imag).max() < 1e-12


def test_a_defocused_band_is_the_sum_over_its_wavelengths():
    """The path error is one length at all of them: fewer waves at longer ones."""
    optics = SensorOptics(0.05, 0.1, obscuration=0.3, defocus=0.35)
    rng = np.random.default_rng(1)
    wavelength, share = 1e-6 * rng.permutation(np.linspace(3.6, 4.8, 16)), rng.dirichlet(np.ones(16))
    mean = float(wavelength @ share)
    blur = Blur.of(optics, wavelength, share)
    f = np.linspace(0.0, 0.6, 13) * optics.cutoff(3.6e-6)
    expected = sum(s * pupil_mtf(f * w / 0.05, 0.3, 0.35 * mean / w) for w, s in zip(wavelength, share, strict=True))
    parts = blur.parts(f)
    assert parts["diffraction"] * parts["defocus"] == pytest.approx(expected, abs=2e-4)
    assert blur.wavelength == pytest.approx(mean)
    assert blur.table()[1][0] == pytest.approx(1.0, abs=5e-5)


@pytest.mark.parametrize("law", ["sine", "thin-lens"])
def test_a_cold_shield_too_wide_lets_in_the_housing_around_the_optics(law):
    optics = SensorOptics(0.05, 0.1, cold_shield_f_number=1.4, solid_angle_law=law)
    assert optics.housing_solid_angle + cone(2.0, law) == pytest.approx(cone(1.4, law))
    assert SensorOptics(0.05, 0.1, cold_shield_f_number=2.0, solid_angle_law=law).housing_solid_angle == 0.0
    assert SensorOptics(0.05, 0.1, cold_shield_f_number=3.0, solid_angle_law=law).housing_solid_angle == 0.0


def shaken(**optics: float) -> SensorModel:
    """Sensor of pixels of 0.1 mrad."""
    given = {"aperture": 0.5, "focal_length": 0.15} | optics
    return SensorModel(Photons(Band.rectangular(3.99, 4.01)), SensorOptics(**given), PhotonPixels(15e-6, integration_time=1e-3))


def test_blur_beyond_the_pixel_is_that_of_closed_forms() -> None:
    """Jitter is a Gaussian itself; the transfer of a clear circle falls to a half at 0.4040 of its cut-off; axes are averaged."""
    gaussian = np.sqrt(np.log(2.0) / 2.0) / np.pi
    assert blur_px(shaken(jitter=8e-5)) == pytest.approx(0.8, rel=0.02)  # and a little diffraction
    assert blur_px(shaken(aperture=0.02)) == pytest.approx(gaussian / 0.4040 * 4e-6 / 0.02 / 1e-4, rel=0.002)
    moved = SensorOptics(0.5, 0.15, drift=(0.3, 0.0))
    model = SensorModel(Photons(Band.rectangular(3.99, 4.01)), moved, PhotonPixels(15e-6, integration_time=1e-3))
    # three pixels in the exposure, along rows alone: sinc is a half at 0.6034 of the inverse
    assert blur_px(model) == pytest.approx(np.sqrt(0.5 * (gaussian / 0.6034 * 3.0) ** 2), rel=0.02)
    assert blur_px(shaken()) < 0.04
