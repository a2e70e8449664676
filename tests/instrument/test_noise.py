"""Photon transfer, NETD, 3-D noise, defects; every frame alone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from sensors import camera, flat, reseeded

from seaglint.base.errors import DataError, DomainError
from seaglint.instrument.bolometer import ThermalPixels, lag_weights
from seaglint.instrument.chain import SensorModel
from seaglint.instrument.detector import PhotonPixels
from seaglint.instrument.figures_of_merit import figures, three_d
from seaglint.instrument.noise import DetectorNoise, three_d_noise
from seaglint.instrument.optics import SensorOptics
from seaglint.instrument.photons import Photons
from seaglint.optics.band import Band


def test_photon_transfer_gives_gain_read_noise_and_well_back() -> None:
    # 10 levels, pairs of frames of 256 x 256 pixels: the fixed pattern drops out of their difference.
    model = camera(DetectorNoise(gain_spread=0.01, offset_spread=300.0), well_capacity=1e6, read_noise=200.0)
    full = (1e6 - model.readout.background) / model.readout.per_radiance
    mean, variance = [], []
    for number, share in enumerate(np.linspace(0.0, 0.9, 10)):
        radiance = np.full((256, 256), share * full, np.float32)
        first, second = (model.sense(radiance, 2 * number + k).signal.astype(float) for k in (0, 1))
        mean.append(0.5 * (first + second).mean())
        variance.append(0.5 * (first - second).var())
    # variance = mean / gain + (read / gain)^2 + 1/12; the darkest level clips half of its readings at zero counts
    slope, _ = np.polyfit(mean[1:], variance[1:], 1)
    assert 1.0 / slope == pytest.approx(model.readout.gain, rel=0.02)
    offset = camera(DetectorNoise(), well_capacity=1e6, read_noise=200.0, offset=100.0)
    dark = [offset.sense(np.zeros((256, 256), np.float32), k).signal.astype(float) for k in (0, 1)]
    read = np.sqrt(0.5 * (dark[0] - dark[1]).var() - 1.0 / 12.0) * offset.readout.gain
    assert read == pytest.approx(200.0, rel=0.02)
    bright = offset.sense(np.full((64, 64), 2.0 * full, np.float32))
    assert (bright.signal.mean() - 100.0) * offset.readout.gain == pytest.approx(1e6, rel=0.02)
    assert bright.saturated == 64 * 64


def test_netd_of_flat_fields_is_the_formulas() -> None:
    # The slope between 300 and 301 K is 1.8 % above that at 300 K: within the 3 %.
    model = camera(DetectorNoise(gain_spread=0.001), read_noise=500.0)
    frames = [model.sense(flat(model, 300.0, 256), k).signal.astype(float) for k in range(8)]
    warm = np.mean([model.sense(flat(model, 301.0, 256), 10 + k).signal.mean() for k in range(4)])
    noise = np.sqrt(np.mean([0.5 * (a - b).var() for a, b in zip(frames[::2], frames[1::2], strict=True)]))
    assert noise / (warm - np.mean(frames)) == pytest.approx(figures(model).netd_k, rel=0.03)


def test_netd_is_that_of_electrons_by_pybsm() -> None:
    # tools/pybsm_reference.py: 1127446.2 electrons at 300 K and 1168117.1 at 301 K, thin lens; sqrt(N)/(dN/dT).
    optics = SensorOptics(0.08, 0.2, transmission=0.8, obscuration=0.3, solid_angle_law="thin-lens")
    model = SensorModel(Photons(Band.rectangular(3.5, 5.0), None, 0.7), optics, PhotonPixels(15e-6, integration_time=2e-3, gain=10.0))
    assert figures(model).netd_k == pytest.approx(np.sqrt(1127446.2) / (1168117.1 - 1127446.2), rel=0.03)


def test_components_of_3d_noise_come_back() -> None:
    # 400 frames of 200 x 240 pixels: an rms of n samples has a standard error of 1/sqrt(2 n), 3.5 % for the frames.
    put = {"T": 300.0, "V": 400.0, "H": 350.0, "TV": 250.0, "TH": 450.0, "VH": 500.0}
    names = {"T": "frame", "V": "row", "H": "column", "TV": "row_temporal", "TH": "column_temporal", "VH": "offset_spread"}
    model = camera(DetectorNoise(**{names[key]: value for key, value in put.items()}), read_noise=600.0)
    radiance = np.full((200, 240), 1.0, np.float32)
    found = three_d_noise(np.stack([model.expose(radiance, k).units for k in range(400)]))
    told = three_d(model, 1.0)
    # What was drawn, not what it was drawn from: one set of 200 rows has its own rms.
    pattern = model._pattern((200, 240))
    assert pattern.offset is not None
    drawn = {"V": pattern.offset.mean(axis=1).std(ddof=1), "H": pattern.offset.mean(axis=0).std(ddof=1)}
    for name in found:
        assert told[name] == pytest.approx(put.get(name, told[name]), rel=1e-9)
        assert found[name] == pytest.approx(drawn.get(name, told[name]), rel=0.05), name


def test_3d_noise_of_pure_components() -> None:
    rng = np.random.default_rng(1)
    shape = (60, 50, 40)
    for name, axes in {"T": (60, 1, 1), "V": (1, 50, 1), "TH": (60, 1, 40), "VH": (1, 50, 40), "TVH": shape}.items():
        found = three_d_noise(np.broadcast_to(rng.normal(0.0, 2.0, axes), shape) + 5.0)
        assert found[name] == pytest.approx(2.0, rel=0.25)
        assert max(value for other, value in found.items() if other != name) < 0.25
    with pytest.raises(DataError, match="two or more frames"):
        three_d_noise(np.zeros((1, 4, 4)))


def test_a_frame_alone_is_that_of_its_sequence_and_seeds_differ() -> None:
    every = DetectorNoise(
        one_over_f=50.0, frame=10.0, row=20.0, column=30.0, row_temporal=40.0, column_temporal=50.0, gain_spread=0.01, offset_spread=60.0,
        drift_per_hour=1e5, dead_share=0.01, hot_share=0.01, blinking_share=0.02, hot_signal=1e5, blinking_signal=2e4, blinking_time=0.1,
    )  # fmt: skip
    sequence, alone = camera(every, read_noise=100.0), camera(every, read_noise=100.0)
    radiance = flat(sequence, 295.0, 48)
    frames = [sequence.sense(radiance, k).signal for k in range(6)]
    np.testing.assert_array_equal(alone.sense(radiance, 4).signal, frames[4])
    assert not np.array_equal(frames[3], frames[4])
    assert not np.array_equal(reseeded(sequence, 4).sense(radiance, 4).signal, frames[4])


def test_switches_leave_parts_out() -> None:
    every = DetectorNoise(gain_spread=0.02, dead_share=0.1, hot_share=0.1, hot_signal=1e6)
    model = camera(every, read_noise=300.0)
    radiance = flat(model, 300.0)
    still = replace(model, noise=replace(every, temporal=False), _patterns={})
    np.testing.assert_array_equal(still.sense(radiance, 0).signal, still.sense(radiance, 1).signal)
    assert still.sense(radiance).signal.std() > 0.0
    even = replace(model, noise=replace(every, fixed_pattern=False), _patterns={})
    assert np.mean([even.sense(radiance, k).units for k in range(64)], axis=0).std() < 300.0
    assert np.ptp(replace(model, noise=DetectorNoise(temporal=False, fixed_pattern=False), _patterns={}).sense(radiance).signal) == 0


def test_defect_pixels_are_as_many_as_asked_for() -> None:
    noise = DetectorNoise(
        temporal=False, dead_share=0.02, hot_share=0.03, blinking_share=0.04, hot_signal=1e6, blinking_signal=3e5, blinking_time=0.2
    )
    model = camera(noise)
    radiance = flat(model, 300.0, 200)
    frames = np.stack([model.sense(radiance, k).units for k in range(200)])
    usual = np.median(frames)
    dead, hot = frames[0] < 0.01 * usual, frames[0] > usual + 0.9e6
    assert dead.mean() == pytest.approx(0.02, abs=0.003)  # 40 000 pixels: a standard deviation is 0.0007
    assert hot.mean() == pytest.approx(0.03, abs=0.003)
    blinking = frames.std(axis=0) > 1e4
    assert blinking.mean() == pytest.approx(0.04, abs=0.004)
    up = frames[:, blinking] > usual + 1e5
    jumps = np.count_nonzero(np.diff(up, axis=0)) / blinking.sum()
    assert jumps == pytest.approx(199 * model.frame_interval / 0.2, rel=0.1)  # a jump in 0.2 s


def test_a_scanners_pixels_are_its_rows() -> None:
    # One column of detectors sees all azimuths: gain, offset, dead and blinking pixels are stripes along the whole picture.
    every = DetectorNoise(False, gain_spread=0.05, offset_spread=900.0, dead_share=0.05, hot_share=0.05, hot_signal=5e5, blinking_share=0.2)
    model = replace(camera(replace(every, blinking_signal=1e5)), scanning=True)
    units = model.expose(np.full((80, 30), 1.5, np.float32), 3).units
    assert np.ptp(units, axis=1).max() == 0.0
    assert np.ptp(units[:, 0]) > 1e5
    still = DetectorNoise(gain_spread=0.01, offset_spread=300.0)
    found = three_d_noise(
        np.stack([replace(camera(still), scanning=True).expose(np.full((400, 50), 1.0, np.float32), k).units for k in range(8)])
    )
    told = three_d(replace(camera(still), scanning=True), 1.0)
    assert told["VH"] == 0.0
    assert found["V"] == pytest.approx(told["V"], rel=0.1)  # 400 rows: standard error 3.5 %


def test_two_point_correction_leaves_curvature_alone() -> None:
    model = camera(DetectorNoise(temporal=False))
    at = tuple(float(model.readout.units(model.photons.radiance(t))) for t in (290.0, 310.0))
    noise = DetectorNoise(temporal=False, gain_spread=0.05, offset_spread=1e4, curvature_spread=0.01, corrected_at=at)
    corrected = replace(model, noise=noise)
    spread = {t: float(corrected.sense(flat(model, t)).units.std()) for t in (290.0, 300.0, 305.0, 310.0)}
    assert spread[290.0] < 1.0
    assert spread[310.0] < 1.0
    assert min(spread[300.0], spread[305.0]) > 100.0
    raw = replace(corrected, noise=replace(noise, corrected_at=None), _patterns={})
    assert float(raw.sense(flat(model, 300.0)).units.std()) > 10.0 * spread[300.0]


def test_one_over_f_noise_falls_with_frequency() -> None:
    model = camera(DetectorNoise(one_over_f=100.0))
    model = replace(model, detector=replace(model.detector, well_capacity=None, gain=1.0))
    units = np.stack([model.expose(np.zeros((64, 64), np.float32), k).units for k in range(512)])
    assert units.std() == pytest.approx(100.0, rel=0.03)
    power = (np.abs(np.fft.rfft(units - units.mean(axis=0), axis=0)) ** 2).mean(axis=(1, 2))
    number = np.arange(power.size)
    slope, _ = np.polyfit(np.log(number[4:120]), np.log(power[4:120]), 1)
    assert slope == pytest.approx(-1.0, abs=0.2)


def test_two_integration_times_widen_the_range() -> None:
    model = camera(DetectorNoise(), read_noise=200.0, short_integration_time=1e-4, bit_depth=16)
    narrow = camera(DetectorNoise(), read_noise=200.0, bit_depth=16)
    for temperature, wide_only in ((300.0, False), (400.0, True)):
        radiance = flat(model, temperature)
        found = model.sense(radiance)
        assert model.apparent_temperature(found.signal.mean()) == pytest.approx(temperature, abs=0.1)
        assert found.saturated == 0
        assert (narrow.sense(radiance).saturated_share == 1.0) is wide_only


def test_the_noise_of_a_short_reading_is_multiplied_with_its_light() -> None:
    model = camera(DetectorNoise(), read_noise=5000.0, short_integration_time=2e-4, bit_depth=16)
    electrons = model.sense(flat(model, 400.0)).units.astype(float)
    assert electrons.mean() > 7e6
    # ten times the shot noise of a tenth of the light, and ten times that of a reading
    assert electrons.std() == pytest.approx(np.hypot(np.sqrt(10.0 * electrons.mean()), 10.0 * 5000.0), rel=0.02)


def microbolometer(**more) -> SensorModel:
    return SensorModel(
        Photons(Band.rectangular(8.0, 12.0)),
        SensorOptics(0.02, 0.03, transmission=0.9),
        ThermalPixels(17e-6, 0.05, **more),
        DetectorNoise(),
    )


def test_a_microbolometer_has_the_netd_that_its_data_sheet_says() -> None:
    # Stated at F/1; through F/1.5 and a transmission of 0.9 it is 2.25 / 0.9 times that.
    model = microbolometer()
    frames = [model.expose(flat(model, 300.0, 256), k).signal.astype(float) for k in range(2)]
    warm = model.expose(flat(model, 301.0, 256), 9).signal.mean()
    noise = np.sqrt(0.5 * (frames[0] - frames[1]).var())
    assert noise / (warm - np.mean(frames)) == pytest.approx(0.05 * 2.25 / 0.9, rel=0.03)
    assert figures(model).netd_k == pytest.approx(0.05 * 2.25 / 0.9, rel=0.001)
    # no shot noise: the same noise in the dark and in the light
    hot = [model.expose(flat(model, 360.0, 256), k).signal.astype(float) for k in range(2)]
    assert np.std(hot[0] - hot[1]) == pytest.approx(np.std(frames[0] - frames[1]), rel=0.02)


def test_lag_keeps_the_exponential_share() -> None:
    weights = lag_weights(0.02, 0.04)
    assert weights.sum() == pytest.approx(1.0)
    assert weights[1] / weights[0] == pytest.approx(np.exp(-2.0))


@pytest.mark.parametrize(
    "values",
    [{"bit_depth": 17}, {"bit_depth": 0}, {"well_capacity": 100.0, "read_noise": 200.0}, {"short_integration_time": 1.0}],
    ids=["too many bits", "no bit", "well below the read noise", "long short time"],
)
def test_impossible_detectors_are_refused(values) -> None:
    with pytest.raises(DomainError):
        camera(**values)


def test_warm_optics_bring_the_electrons_of_a_blackbody_in_their_place() -> None:
    """A blackbody at the optics' temperature that fills the field, and optics that emit what they do not transmit: a closed cavity."""
    black = camera(dark_current=0.0)
    optics = replace(black.optics, transmission=0.7, emissivity=0.3, temperature=300.0)
    warm = camera(optics=optics, dark_current=1e6)
    scene = float(black.photons.radiance(300.0))
    line = warm.readout
    assert line.dark == pytest.approx(1e6 * 2e-3)
    assert line.units(scene) - line.dark == pytest.approx(black.readout.units(scene), rel=1e-12)
    # A shield as wide as one at F/1.5 adds the housing: as many electrons as a faster lens would have brought.
    wide, fast = camera(optics=replace(optics, cold_shield_f_number=1.5)), camera(optics=replace(black.optics, aperture=0.1 / 1.5))
    assert wide.readout.units(scene) == pytest.approx(fast.readout.units(scene), rel=1e-12)


def test_figures_agree_with_each_other_and_with_the_line_to_counts() -> None:
    model = camera(DetectorNoise(gain_spread=0.01, frame=30.0, one_over_f=20.0), read_noise=200.0, dark_current=1e6)
    line, sheet = model.readout, figures(model, scene_radiance=2.0)
    optics = model.optics
    budget = sheet.noise_budget
    assert sheet.nei_w_m2 * optics.pupil_area * optics.transmission * sheet.point_share == pytest.approx(sheet.nep_w)
    # A power of one NEP on a pixel for an integration time is as many electrons as the noise has.
    at_300 = figures(model)
    noise = at_300.noise_budget.total_temporal
    assert sheet.nep_w * model.photons.electrons_per_joule * model.detector.integration_time == pytest.approx(noise)
    assert sheet.netd_k * sheet.sitf_counts_per_k * line.gain == pytest.approx(noise)
    assert sheet.sitf_counts_per_k == pytest.approx(
        float(np.diff(line.units(model.photons.radiance([299.5, 300.5])))[0]) / line.gain, rel=1e-4
    )
    assert float(line.units(sheet.saturation_radiance)) == pytest.approx(line.full_scale)
    assert float(model.photons.radiance(sheet.saturation_temperature_k)) == pytest.approx(sheet.saturation_radiance, rel=1e-4)
    floor = figures(model, scene_radiance=0.0).noise_budget.total_temporal
    assert 10.0 ** (sheet.dynamic_range_db / 20.0) == pytest.approx((line.full_scale - line.background) / floor)
    # Shot noise of all electrons, and the others by root of the sum of squares.
    assert budget.parts["scene"] ** 2 + budget.parts["dark"] ** 2 + budget.parts["optics"] ** 2 == pytest.approx(budget.signal)
    others = 200.0**2 + 30.0**2 + 20.0**2 + line.gain**2 / 12.0
    assert budget.total_temporal**2 == pytest.approx(budget.signal + others)
    assert budget.fixed_pattern == pytest.approx(0.01 * (budget.signal - line.dark))
    parts = sheet.three_d_noise
    assert parts["TVH"] ** 2 + parts["T"] ** 2 == pytest.approx(budget.total_temporal**2)
    assert parts["VH"] == budget.fixed_pattern
    f = np.array(sheet.mtf.frequency_cycles_per_mrad)
    assert f[-1] == pytest.approx(2.0 * sheet.mtf.nyquist_cycles_per_mrad)
    assert sheet.mtf.nyquist_cycles_per_mrad * sheet.ifov_mrad == pytest.approx(0.5)


def test_corrected_patterns_vanish_where_they_were_corrected() -> None:
    from seaglint.instrument.figures_of_merit import fixed_pattern

    model = camera(DetectorNoise(gain_spread=0.01, offset_spread=50.0, curvature_spread=0.02, corrected_at=(2e5, 8e5)))
    line = model.readout
    radiance = [(electrons + line.dark - line.background) / line.per_radiance for electrons in (2e5, 5e5, 8e5)]
    low, middle, high = (fixed_pattern(model, one) for one in radiance)
    assert (low, high) == (pytest.approx(0.0, abs=1e-6), pytest.approx(0.0, abs=1e-6))
    assert middle == pytest.approx(0.02 * 3e5**2 / line.full_scale)


def test_lag_ends_where_a_frame_is_forgotten() -> None:
    """Weights down to a ten-thousandth of the first, 64 at most."""
    weights = lag_weights(0.1, 0.04)
    decay = np.exp(-0.4)
    assert weights.size == 1 + np.flatnonzero(decay ** np.arange(100) >= 1e-4)[-1]
    np.testing.assert_allclose(weights, decay ** np.arange(weights.size) / np.sum(decay ** np.arange(weights.size)))
    assert lag_weights(100.0, 0.04).size == 64
    assert lag_weights(1e-9, 0.04).tolist() == [1.0]
    assert lag_weights(0.0, 0.04).tolist() == [1.0]


def test_the_signal_of_a_microbolometer_is_in_nanowatts() -> None:
    """Radiance times area, solid angle, transmission and absorptance."""
    model = microbolometer(fill_factor=0.8, absorptance=0.7)
    power = model.readout.per_radiance * 1e-9
    assert power == pytest.approx((17e-6) ** 2 * 0.8 * 0.7 * model.optics.solid_angle * 0.9)
    assert figures(model).nw_per_count == pytest.approx(model.readout.radiance_scale * power * 1e9)


def test_components_solve_the_table_of_expected_mean_squares() -> None:
    """Parts without means of their own, of which the mean squares are known; expected ones by the table of a crossed design."""
    shape, rng = (4, 5, 6), np.random.default_rng(21)
    sizes = {"T": (0,), "V": (1,), "H": (2,), "TV": (0, 1), "TH": (0, 2), "VH": (1, 2), "TVH": (0, 1, 2)}
    rms = {1: 20.0, 2: 5.0, 3: 1.0}
    cube, squares = np.zeros(shape), []
    for axes in sizes.values():
        part = rms[len(axes)] * rng.normal(size=[shape[axis] if axis in axes else 1 for axis in range(3)])
        for axis in axes:
            part = part - part.mean(axis=axis, keepdims=True)
        cube = cube + part
        squares.append(np.sum(np.broadcast_to(part, shape) ** 2) / np.prod([shape[axis] - 1 for axis in axes]))
    table = [
        [np.prod([n for axis, n in enumerate(shape) if axis not in of]) * (set(own) <= set(of)) for of in sizes.values()]
        for own in sizes.values()
    ]
    expected = np.sqrt(np.linalg.solve(np.array(table, float), squares))
    assert list(three_d_noise(cube + 7.0).values()) == pytest.approx(expected, rel=1e-10)
    assert list(three_d_noise(cube)) == list(sizes)
