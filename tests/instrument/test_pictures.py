"""Edges, points and blackbodies through the optics and onto the pixels."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sensors import camera, flat

from seaglint.base.errors import DataError, DomainError
from seaglint.instrument.chain import Drawn
from seaglint.instrument.figures_of_merit import mtf, point_response, point_share
from seaglint.instrument.noise import DetectorNoise
from seaglint.instrument.optics import SensorOptics
from seaglint.instrument.transfer import FOLDED, Sampling, Transfer, folded_share, needed_oversampling
from sensor_validation import edge_mtf, slanted_edge

ANGLE = 5.0
SHARP = SensorOptics(0.1, 0.1)  # F/1: the blur is a third of a pixel


@pytest.mark.parametrize("oversampling", [3, 4, 5])
@pytest.mark.parametrize("turned", [False, True], ids=["along", "across"])
def test_an_edge_has_the_product_of_the_parts(oversampling: int, turned: bool) -> None:
    # The window cuts the wings of diffraction off, which raises all of the MTF by 0.002 at F/2 and this size.
    model = camera(optics=SensorOptics(0.05, 0.1, wavefront_error=0.04, jitter=2e-5), fill_factor=0.8)
    seen = model.focal_plane(slanted_edge(256, oversampling, ANGLE, turned=turned), oversampling)
    frequency, found = edge_mtf(seen, ANGLE, turned)
    below = frequency <= 0.5
    expected = mtf(model, frequency[below] / model.ifov)["across" if turned else "along"]["total"]
    np.testing.assert_allclose(found[below], expected, atol=0.005)


@pytest.mark.parametrize(("size", "f_number", "obscuration"), [(256, 3.0, 0.3), (256, 3.0, 0.5), (128, 3.0, 0.0)])
def test_edges_behind_obscured_pupils_have_it_from_the_first_frequency_on(size: int, f_number: float, obscuration: float) -> None:
    # Margins of six rings let wings reach over from the other side: 0.008 to 0.013 too much at all frequencies.
    model = camera(optics=SensorOptics(0.1 / f_number, 0.1, obscuration=obscuration))
    seen = model.focal_plane(slanted_edge(size, 3, ANGLE), 3)
    frequency, found = edge_mtf(seen, ANGLE)
    below = frequency <= 0.5
    np.testing.assert_allclose(found[below], mtf(model, frequency[below] / model.ifov)["along"]["total"], atol=0.005)


def test_counts_of_an_edge_have_it_too() -> None:
    model = camera(optics=SensorOptics(0.05, 0.1, obscuration=0.2))
    signal = model.sense(slanted_edge(256, 3, ANGLE, 1.0, 2.0), oversampling=3).signal
    frequency, found = edge_mtf(signal.astype(float), ANGLE)
    below = frequency <= 0.5
    np.testing.assert_allclose(found[below], mtf(model, frequency[below] / model.ifov)["along"]["total"], atol=0.01)


def test_movement_blurs_along_its_direction_alone() -> None:
    model = camera(optics=SensorOptics(0.05, 0.1, drift=(0.15, 0.0)))  # two pixels in 2 ms
    for turned, way in ((False, "along"), (True, "across")):
        seen = model.focal_plane(slanted_edge(256, 3, ANGLE, turned=turned), 3)
        frequency, found = edge_mtf(seen, ANGLE, turned)
        below = frequency <= 0.3
        # The edge is not quite straight across: its normal has a part of the movement.
        expected = np.abs(mtf(model, frequency[below] * np.cos(np.radians(ANGLE)) / model.ifov)[way]["total"])
        np.testing.assert_allclose(found[below], expected, atol=0.02)


def point(oversampling: int, row: int, column: int, size: int = 64) -> np.ndarray:
    """All light in one fine pixel near the middle, of 1 pixel solid angle in all."""
    radiance = np.zeros((size * oversampling, size * oversampling), np.float32)
    radiance[size // 2 * oversampling + row, size // 2 * oversampling + column] = oversampling**2
    return radiance


def test_a_points_sum_does_not_depend_on_its_place() -> None:
    model = camera(optics=SHARP)
    sums = [model.focal_plane(point(5, row, column), 5).sum() for row in range(5) for column in range(5)]
    assert np.ptp(sums) < 0.003 * np.mean(sums)
    assert np.mean(sums) == pytest.approx(1.0, abs=0.005)  # the rest lies beyond 32 pixels


def test_gaps_between_pixels_swallow_points() -> None:
    # Sensitive squares of half a pixel's width: a point in the middle is all seen, in the corner next to nothing of its core.
    model = camera(optics=SHARP, fill_factor=0.25)
    line = [float(model.focal_plane(point(5, place, 2), 5).sum()) * 0.25 for place in range(5)]
    inside = np.array([0.0, 0.5, 1.0, 0.5, 0.0])  # overlap of the fine pixels with the square, had the optics no blur
    assert np.all(np.diff(line[:3]) > 0.1)
    np.testing.assert_allclose(line, line[::-1], rtol=1e-3)
    assert line[2] - line[0] < inside[2]
    mean = np.mean([model.focal_plane(point(5, a, b), 5).sum() * 0.25 for a in range(5) for b in range(5)])
    assert mean == pytest.approx(0.25, rel=0.01)


@pytest.mark.parametrize("oversampling", [2, 3])
def test_pixels_are_where_they_are(oversampling: int) -> None:
    model = camera(optics=SensorOptics(0.0125, 0.1))  # F/8: sampled finely enough for its centroid
    seen = model.focal_plane(point(oversampling, 0, oversampling - 1, 65), oversampling).astype(float)
    rows, columns = np.mgrid[0:65, 0:65]
    shift = 0.5 / oversampling - 0.5
    assert float((seen * rows).sum() / seen.sum()) == pytest.approx(32 + shift, abs=0.02)
    assert float((seen * columns).sum() / seen.sum()) == pytest.approx(32 - shift, abs=0.02)


def test_a_point_and_a_field_agree() -> None:
    # The point as the irradiance it makes at the aperture: pupil area times electrons of a joule, against its radiance times solid angle.
    model = camera(optics=SensorOptics(0.05, 0.1, obscuration=0.3, transmission=0.8))
    radiance = 10.0
    irradiance = radiance * model.ifov**2
    electrons = irradiance * model.optics.pupil_area * 0.8 * model.photons.electrons_per_joule * 2e-3
    seen = model.focal_plane(radiance * point(3, 1, 1, 96), 3)
    assert float((model.readout.units(seen) - model.readout.background).sum()) == pytest.approx(electrons, rel=0.01)


@pytest.mark.parametrize(
    ("fill", "detector", "optics"),
    [(1.0, {}, {}), (0.5, {}, {}), (0.8, {"crosstalk": 0.1}, {"stray_share": 0.05}), (0.9, {}, {"drift": (0.2, 0.1), "jitter": 4e-5})],
)
def test_the_middle_pixel_has_the_response_that_is_told(fill: float, detector: dict[str, Any], optics: dict[str, Any]) -> None:
    """With crosstalk, stray light, motion and a fill factor: the picture's own pixel, of a point drawn into one fine pixel of 9 x 9."""
    model = camera(optics=SensorOptics(0.05, 0.1, **optics), fill_factor=fill, **detector)
    seen = float(model.focal_plane(point(9, 4, 4, 65), 9)[32, 32])
    assert seen == pytest.approx(point_response(model), rel=0.02)
    assert point_share(model) == pytest.approx(fill * point_response(model), rel=1e-12)


@pytest.mark.parametrize("temperature", [275.0, 300.0, 315.0])
def test_a_blackbody_comes_back_at_its_temperature(temperature: float) -> None:
    model = camera(optics=SensorOptics(0.05, 0.1, transmission=0.8, emissivity=0.2, temperature=305.0), dark_current=1e6, offset=100.0)
    found = model.sense(np.repeat(np.repeat(flat(model, temperature, 32), 3, 0), 3, 1), oversampling=3)
    np.testing.assert_allclose(model.apparent_temperature(found.signal), temperature, atol=0.05)


def test_counts_and_radiance_go_both_ways() -> None:
    model = camera(offset=200.0, dark_current=5e6)
    counts = np.arange(300, model.readout.top_count, 37)
    radiance = model.readout.radiance(counts)
    np.testing.assert_allclose(model.readout.counts(model.readout.units(radiance)), counts, atol=0.5)
    temperature = model.apparent_temperature(counts[counts > 600])
    again = model.readout.counts(model.readout.units(model.photons.radiance(temperature)))
    np.testing.assert_allclose(again, counts[counts > 600], atol=0.5)


def test_stray_light_and_cos4() -> None:
    picture = np.zeros((90, 90), np.float32)
    picture[:, 45:] = 2.0
    clear, veiled = (camera(optics=SensorOptics(0.05, 0.1, stray_share=share)).focal_plane(picture) for share in (0.0, 0.1))
    np.testing.assert_allclose(veiled, 0.9 * clear + 0.1 * clear.mean(dtype=float), rtol=1e-5)
    wide = camera(optics=SensorOptics(0.001, 0.002, cos4=True))
    seen = wide.focal_plane(np.ones((201, 201), np.float32))
    tangent = 100 * 15e-6 / 0.002
    assert float(seen[100, 0]) == pytest.approx(np.cos(np.arctan(tangent)) ** 4, rel=1e-4)
    assert float(seen[100, 100]) == pytest.approx(1.0, rel=1e-4)


def test_oversampling_that_the_cut_off_needs() -> None:
    # F/2 at 3.5 um: 143 cycles/mm; pixels of 15 um have their Nyquist frequency at 33.3.
    assert camera().finest == needed_oversampling(150e-6, 0.05 / 3.5e-6) == 5
    assert camera(optics=SensorOptics(0.025, 0.1)).finest == 3


@st.composite
def sensors(draw: st.DrawFn):
    optics = SensorOptics(0.1 / draw(st.floats(1.0, 6.0)), 0.1, jitter=draw(st.sampled_from([0.0, 3e-5])))
    return camera(optics=optics, fill_factor=draw(st.floats(0.5, 1.0)), crosstalk=draw(st.sampled_from([0.0, 0.04])))


@given(model=sensors())
@settings(max_examples=20, deadline=None, derandomize=True)
def test_drawings_are_as_fine_as_the_folded_energy_needs(model) -> None:
    shares = [folded_share(model.blur, model.sampling(1), n) for n in range(1, model.finest + 1)]
    assert model.oversampling <= model.finest
    assert all(share > FOLDED for share in shares[: model.oversampling - 1])
    if model.oversampling < model.finest:
        assert shares[model.oversampling - 1] <= FOLDED
    assert shares == sorted(shares, reverse=True)


@given(model=sensors(), seed=st.integers(0, 2**31))
@settings(max_examples=4, deadline=None, derandomize=True)
def test_independent_light_keeps_its_energy_and_a_field_of_means_has_the_stated_error(model, seed: int) -> None:
    # Light without any correlation on a grid twelve times finer than the pixels, and its means on the coarser grid of a drawing.
    n, finest, size, inside = model.oversampling, 12, 72, (slice(8, -8), slice(8, -8))
    finest += -finest % n
    random, pictures = np.random.default_rng(seed), []
    for _ in range(3):
        light = random.uniform(0.0, 2.0, (size * finest, size * finest)).astype(np.float32)
        means = light.reshape(size * n, finest // n, size * n, finest // n).mean(axis=(1, 3))
        drawings = ((light, finest, Drawn(light)), (means, n, Drawn(means)), (means, n, Drawn()))
        pictures.append([model.focal_plane(fine, times, drawn=drawn)[inside] for fine, times, drawn in drawings])
    exact, independent, continuous = (np.stack(some) for some in zip(*pictures, strict=True))
    # Of 3 x 56 x 56 pixels a ratio of variances of the same light has a deviation of 0.5 to 1 %.
    assert independent.var() / exact.var() == pytest.approx(1.0, abs=0.03)
    for axis in (1, 2):
        found, expected = (neighbours(picture, axis) for picture in (independent, exact))
        assert found == pytest.approx(expected, abs=0.02)
    error = folded_share(model.blur, model.sampling(1), n)
    assert continuous.var() / exact.var() == pytest.approx((1.0 + error) ** 2, abs=0.04)


def neighbours(picture: np.ndarray, axis: int) -> float:
    """Correlation of neighbouring pixels along an axis."""
    q = np.moveaxis(picture - picture.mean(), axis, 0).astype(float)
    return float((q[1:] * q[:-1]).mean() / (q * q).mean())


@pytest.mark.parametrize("offset", [0.0, 0.3, 0.5])
def test_the_squares_of_cells_under_a_picture_are_divided_out(offset: float) -> None:
    """Waves on cells of half a fine pixel, averaged over pixels at some offset: within 2 % of their amplitude on the detector."""
    model, n, size, parts = camera(optics=SensorOptics(0.05, 0.1)), 2, 48, 20
    for cycles in (0.1, 0.25, 0.4):  # in a detector's pixel
        edges = np.arange(2 * n * size + 2) / (2 * n)
        cells = -np.diff(np.cos(2 * np.pi * cycles * edges)) / (2 * np.pi * cycles * np.diff(edges))
        fine = np.repeat(cells, parts)[round(offset * parts) :][: 2 * n * size * parts].reshape(n * size, -1).mean(axis=1)
        picture = np.broadcast_to(2.0 + fine, (n * size, n * size)).astype(np.float32)
        seen = model.focal_plane(picture, n, drawn=Drawn(cells=model.ifov / (2 * n)))[size // 2].astype(float)
        x = np.arange(size) + 0.5 + offset / (2 * n)
        inside = slice(8, -8)
        waves = np.stack([np.ones(size), np.sin(2 * np.pi * cycles * x), np.cos(2 * np.pi * cycles * x)], axis=1)[inside]
        _, sine, cosine = np.linalg.lstsq(waves, seen[inside], rcond=None)[0]
        expected = float(mtf(model, np.array([cycles / model.ifov]))["along"]["total"][0])
        assert np.hypot(sine, cosine) == pytest.approx(expected, rel=0.04)


@pytest.mark.parametrize(("value", "said"), [(np.nan, "not finite"), (np.inf, "not finite"), (-0.1, "negative")])
def test_what_is_no_radiance_is_refused(value: float, said: str) -> None:
    picture = np.ones((8, 8), np.float32)
    picture[2, 5] = value
    with pytest.raises(DataError, match=rf"1 of 64 pixels are {said}.*row 2, column 5"):
        camera().focal_plane(picture)


def test_a_picture_that_oversampling_does_not_divide_is_refused() -> None:
    with pytest.raises(DomainError, match="oversampling = 3 does not divide a picture of 8 rows and 8 columns; give one of 1, 2, 4, 8"):
        camera().focal_plane(np.ones((8, 8), np.float32), 3)


def test_stages_take_sequences_and_stand_alone() -> None:
    # Optics alone: a detector as fine as the picture adds nothing. Then the rest, stage by stage, is the whole chain.
    model = camera(DetectorNoise(gain_spread=0.01, drift_per_hour=1e6), optics=SensorOptics(0.05, 0.1, stray_share=0.1))
    radiance = (1.5 + np.random.default_rng(2).random((3, 30, 30))).astype(np.float32)
    blur = Transfer.of(model.blur, Sampling(model.ifov / 3, model.ifov / 3, 1), (30, 30))
    soft = blur(radiance)
    assert soft.shape == radiance.shape
    wave = np.cos(2 * np.pi * 5 * np.arange(240) / 240)[None, :] * np.ones((240, 1))  # 5 cycles in 80 pixels of the detector
    wide = Transfer.of(model.blur, Sampling(model.ifov / 3, model.ifov / 3, 1, circle=True), (240, 240))
    kept = wide((2.0 + wave).astype(np.float32))[120]
    expected = mtf(model, [5 / (80 * model.ifov)])["along"]
    assert np.ptp(kept) / 2 == pytest.approx(expected["diffraction"][0], abs=1e-3)
    seen = model.focal_plane(radiance, 3)
    assert seen.shape == (3, 10, 10)
    found = model.expose(seen, 4)
    for k in range(3):
        one = model.sense(radiance[k], 4 + k, 3)
        np.testing.assert_array_equal(found.signal[k], one.signal)
        np.testing.assert_array_equal(found.units[k], one.units)
    assert found.saturated_share == 0.0
    np.testing.assert_array_equal(model.readout.counts(found.units), found.signal)
    with pytest.raises(DataError, match="not finite"):
        model.focal_plane(np.where(radiance > 2.49, np.nan, radiance), 3)
