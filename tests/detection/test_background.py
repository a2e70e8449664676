"""Windows of sequences, moments over frames with gaps, and scales of thresholds, counted one by one."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import norm
from stored_frames import StoredFrames

from seaglint.detection.background import Background, Windows, blocks_of, count_false_alarms
from seaglint.detection.moving import FrameDifference
from seaglint.detection.spatial import FilterThreshold


def source_of(frames: np.ndarray, sequence_length: int = 0) -> StoredFrames:
    return StoredFrames(frames, sequence_length=sequence_length)


@pytest.mark.parametrize(("frames", "length", "lead"), [(20, 5, 2), (23, 7, 0), (9, 9, 3), (8, 4, 4)])
def test_windows_are_runs_of_frames_inside_one_sequence(frames: int, length: int, lead: int) -> None:
    """What is left over after the last whole sequence has none; between sequences events have an empty frame."""
    found = Windows(frames, length, lead)
    runs = [range(first, first + lead + 1) for first in range(frames // length * length)]
    runs = [run for run in runs if run[0] // length == run[-1] // length]
    assert found.count == len(runs)
    assert found.sequences == frames // length
    assert [found.start(window) for window in range(found.count)] == [run[0] for run in runs]
    events: list[int | None] = []
    for window, run in enumerate(runs):
        if window and run[0] // length != runs[window - 1][0] // length:
            events.append(None)
        events.append(window)
    assert [found.of_event(number) for number, window in enumerate(events) if window is not None] == list(range(found.count))


def test_sequences_are_as_long_as_their_source_says() -> None:
    frames = np.zeros((12, 4, 4), np.float32)
    assert Windows.of(source_of(frames), 1) == Windows(12, 12, 1)
    assert Windows.of(source_of(frames, sequence_length=4), 1) == Windows(12, 4, 1)


def test_blocks_hold_eight_megabytes_and_every_frame_once() -> None:
    frames = np.arange(10, dtype=np.float32)[:, None, None] * np.ones((1, 800, 1000), np.float32)  # 3.2 MB each
    blocks = list(blocks_of(source_of(frames), 1, 8))
    assert [len(block) for block in blocks] == [2, 2, 2, 1]
    assert np.concatenate(blocks)[:, 0, 0].tolist() == list(range(1, 8))
    assert sum(map(len, blocks_of(source_of(frames)))) == 10


@pytest.fixture(scope="module")
def uneven() -> np.ndarray:
    """Frames of different mean and contrast, some with many missing pixels and one with none left."""
    generator = np.random.default_rng(4)
    frames = generator.normal(0.0, 1.0, (8, 40, 50)) * generator.uniform(0.5, 3.0, (8, 1, 1)) + generator.normal(50.0, 2.0, (8, 1, 1))
    frames[generator.random(frames.shape) < np.linspace(0.0, 0.9, 8)[:, None, None]] = np.nan
    frames[3] = np.nan
    return frames.astype(np.float32)


def test_mean_and_deviation_are_those_of_all_pixels_together(uneven: np.ndarray) -> None:
    background = Background(FilterThreshold(), source_of(uneven))
    values = uneven[np.isfinite(uneven)].astype(np.float64)
    assert background.pixels == values.size
    assert (background.mean, background.sigma) == pytest.approx((values.mean(), values.std()), rel=1e-6)


def test_heights_are_in_deviations_of_all_frames_or_of_each(uneven: np.ndarray) -> None:
    background = Background(FilterThreshold(), source_of(uneven))
    for window in (0, 7):
        frame = uneven[window].astype(np.float64)
        expected = (frame - np.nanmean(frame)) / np.nanstd(frame)
        np.testing.assert_allclose(background.z(window, "frame"), expected, atol=1e-5)
        np.testing.assert_allclose(background.z(window, "sigma"), (frame - background.mean) / background.sigma, atol=1e-5)
    assert np.isnan(background.z(3, "frame")).all()
    fixed, design = background.threshold(60.0, "fixed"), background.threshold(1e-4, "design")
    assert (fixed.sigma, fixed.estimated) == (pytest.approx((60.0 - background.mean) / background.sigma), False)
    assert (design.sigma, design.estimated) == (pytest.approx(norm.isf(1e-4)), True)


def test_false_alarms_of_sequences_do_not_touch() -> None:
    """A pixel bright in every frame: an event for each sequence, and all frames have an alarm."""
    frames = np.random.default_rng(5).normal(size=(12, 40, 40)).astype(np.float32)
    frames[:, 20, 20] += 30.0
    background = Background(FilterThreshold(), source_of(frames, sequence_length=4))
    threshold = background.threshold(5.0, "sigma")
    count = count_false_alarms(background, threshold)
    bright = count.alarms.events(threshold.sigma)
    assert (len(bright), bright.duration.tolist()) == (3, [4, 4, 4])
    assert [background.place.of_event(int(first)) for first in bright.first] == [0, 4, 8]
    assert count.per_frame.rate == 1.0
    assert count.per_pixel.rate == pytest.approx(12 / frames.size)


def test_large_frames_are_read_one_by_one() -> None:
    frames = np.zeros((3, 1500, 1500), np.float32)  # 9 MB each
    assert [len(block) for block in blocks_of(source_of(frames))] == [1, 1, 1]


def test_a_detector_of_several_frames_sees_one_sequence_at_a_time() -> None:
    frames = np.random.default_rng(6).normal(size=(12, 20, 24)).astype(np.float32)
    background = Background(FrameDifference(lag=2), source_of(frames, sequence_length=4))
    expected = [frames[first + 2 + k] - frames[first + k] for first in (0, 4, 8) for k in (0, 1)]
    np.testing.assert_allclose(background.statistic, expected, atol=1e-6)
