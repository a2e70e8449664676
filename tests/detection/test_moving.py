"""Registration to a fraction of a pixel; moving targets are found, standing clutter cancels, short glints average out."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter

from seaglint.base.errors import DataError, DomainError
from seaglint.clutter.thresholds import standardise
from seaglint.detection.interface import statistics
from seaglint.detection.moving import FrameDifference, RegisteredIntegration, displacement, moved

SPOT = gaussian_filter(np.pad([[1.0]], 4), 1.0)
SPOT /= SPOT.max()


def wave_sum(rows: int, columns: int, shift: tuple[float, float] = (0.0, 0.0)) -> np.ndarray:
    """Sum of waves, exact at any shift."""
    generator = np.random.default_rng(51)
    y, x = np.indices((rows, columns)) - np.array(shift).reshape(2, 1, 1)
    waves = zip(generator.uniform(-0.8, 0.8, (60, 2)), generator.uniform(0, 6.28, 60), strict=True)
    return np.sum([np.cos(k[0] * y + k[1] * x + p) for k, p in waves], axis=0).astype(np.float32)


@pytest.mark.parametrize("shift", [(0.0, 0.0), (0.3, -0.7), (3.37, -5.21), (-10.5, 8.25)])
@pytest.mark.parametrize("noise", [0.0, 0.5])
def test_displacement_is_found_to_a_fraction_of_a_pixel(shift: tuple[float, float], noise: float) -> None:
    """A tenth of a pixel for a tenth of the scene (5.5 rms) as noise; a twentieth for what enters and leaves at the borders."""
    grain = np.random.default_rng(52).standard_normal((2, 128, 140)) * noise
    found = displacement(280 + wave_sum(128, 140) + grain[0], 280 + wave_sum(128, 140, shift) + grain[1])
    assert found == pytest.approx(shift, abs=0.1 if noise else 0.05)


def test_moved_undoes_a_displacement() -> None:
    by = (1.3, -2.6)
    inner = np.s_[8:-8, 8:-8]
    # Cubic splines at 0.8 rad per pixel: 1 % of the amplitude.
    assert moved(wave_sum(60, 60), by)[inner] == pytest.approx(wave_sum(60, 60, by)[inner], abs=0.3)
    assert np.isnan(moved(wave_sum(60, 60), by)[0]).all()


@pytest.fixture(scope="module")
def crossing() -> np.ndarray:
    """Standing waves 50 times stronger than the noise, and a target of a tenth of them that crosses at 2 px per frame."""
    frames = np.tile(10 * wave_sum(80, 90), (12, 1, 1)) + np.random.default_rng(53).standard_normal((12, 80, 90))
    for k in range(12):
        frames[k, 36:45, 20 + 2 * k : 29 + 2 * k] += 15 * SPOT
    return frames.astype(np.float32)


def test_difference_finds_a_moving_target_in_standing_clutter(crossing: np.ndarray) -> None:
    detector = FrameDifference(4)
    z = standardise(detector(crossing))
    assert z.shape == (8, 80, 90)
    for k in range(8):
        assert np.unravel_index(np.argmax(z[k]), z[k].shape) == pytest.approx((40, 24 + 2 * (k + 4)), abs=1)
    assert z[0].max() > 5
    # What stands is gone: noise of two frames is left.
    assert detector(crossing)[:, :30].std() == pytest.approx(np.sqrt(2), rel=0.02)


def test_registered_difference_cancels_what_the_camera_moves() -> None:
    frames = np.stack([wave_sum(100, 110, (0.4 * k, -0.9 * k)) for k in range(4)])
    inner = np.s_[:, 8:-8, 8:-8]
    assert FrameDifference(1, register=True)(frames)[inner].std() < 0.15 * FrameDifference(1)(frames)[inner].std()


def test_integration_averages_what_is_gone_sooner() -> None:
    x = np.random.default_rng(54).standard_normal((20, 60, 60)).astype(np.float32)
    out = RegisteredIntegration(5, register=False)(x)
    assert out.shape == (16, 60, 60)
    assert out.std() == pytest.approx(1 / np.sqrt(5), rel=0.02)
    assert out[3] == pytest.approx(x[3:8].mean(0), abs=1e-6)


def test_integration_along_the_track_keeps_the_target() -> None:
    x = np.random.default_rng(55).standard_normal((8, 60, 80)).astype(np.float32)
    for k in range(8):
        x[k, 26:35, 20 + 3 * k : 29 + 3 * k] += (2.5 * SPOT).astype(np.float32)
    along = RegisteredIntegration(8, register=False, velocity=(0.0, 3.0))(x)[0]
    assert along[30, 24 + 21] / np.nanstd(along[:20]) > 5
    assert RegisteredIntegration(8, register=False)(x)[0][30, 45] < 1.5


def test_registered_integration_holds_a_moving_scene() -> None:
    frames = np.stack([wave_sum(100, 110, (0.7 * k, -1.3 * k)) for k in range(4)])
    out = RegisteredIntegration(4)(frames)[0]
    inner = np.s_[12:-12, 12:-12]
    assert (out - frames[-1])[inner].std() < 0.1 * frames[-1].std()


@pytest.mark.parametrize("block", [1, 3, 12])
@pytest.mark.parametrize("detector", [FrameDifference(4), RegisteredIntegration(3, register=False)], ids=lambda d: d.name)
def test_a_stream_gives_what_the_whole_gives(crossing: np.ndarray, detector, block: int) -> None:
    parts = list(statistics(detector, (crossing[k : k + block] for k in range(0, 12, block))))
    assert np.array_equal(np.concatenate(parts), detector(crossing))


def test_too_short_a_sequence_is_said(crossing: np.ndarray) -> None:
    with pytest.raises(DataError, match="needs 5 frames; the sequence has 4"):
        list(statistics(FrameDifference(4), [crossing[:2], crossing[2:4]]))


def test_unusable_input_is_refused() -> None:
    with pytest.raises(DomainError, match="at least 1"):
        FrameDifference(0)
    with pytest.raises(DomainError, match="at least 2"):
        RegisteredIntegration(1)
    with pytest.raises(DataError, match="equal shapes"):
        displacement(np.zeros((4, 4)), np.zeros((4, 5)))
    with pytest.raises(DataError, match="without any value"):
        displacement(np.full((4, 4), np.nan), np.zeros((4, 4)))


def test_a_frame_without_values_costs_only_the_sums_that_it_is_in():
    frames = np.random.default_rng(8).standard_normal((6, 32, 32)).astype(np.float32)
    frames[2] = np.nan
    summed = RegisteredIntegration(count=2)(frames)
    assert np.isnan(summed).all(axis=(1, 2)).tolist() == [False, True, True, False, False]
