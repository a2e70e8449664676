"""Exceedances in time and the events they form, against a labelling of the whole cube and a Markov chain with known memory."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.ndimage import label, maximum, sum_labels

from seaglint.clutter.exceedances import EventTracker, JointExceedances


@pytest.fixture(scope="module")
def noise() -> np.ndarray:
    return np.random.default_rng(31).standard_normal((40, 30, 35)).astype(np.float32)


@pytest.mark.parametrize("threshold", [0.8, 1.2, 2.0])
@pytest.mark.parametrize("block", [1, 7, 40])
def test_events_are_the_connected_parts_of_the_cube(noise: np.ndarray, threshold: float, block: int) -> None:
    tracker = EventTracker(threshold)
    for start in range(0, 40, block):
        tracker.add(noise[start : start + block])
    events = tracker.result()
    labels, n = label(noise > threshold, np.ones((3, 3, 3)))
    numbers = np.arange(1, n + 1)
    assert sorted(events.size) == sorted(sum_labels(noise > threshold, labels, numbers))
    assert np.sort(events.peak) == pytest.approx(np.sort(maximum(noise, labels, numbers)))
    frame = np.broadcast_to(np.arange(40)[:, None, None], noise.shape)
    first = np.array([frame[labels == i].min() for i in numbers[:50]])
    last = np.array([frame[labels == i].max() for i in numbers[:50]])
    peaks = maximum(noise, labels, numbers[:50])
    where = [int(np.flatnonzero(events.peak == p)[0]) for p in peaks]
    assert events.first[where].tolist() == first.tolist()
    assert events.duration[where].tolist() == (last - first + 1).tolist()
    assert (noise[:, events.row[0], events.column[0]] == np.float32(events.peak[0])).any()
    assert events.cut.sum() == len({*np.unique(labels[0]), *np.unique(labels[-1])} - {0})


def test_empty_frame_ends_an_event() -> None:
    z = np.zeros((5, 6, 6), np.float32)
    z[[0, 1, 3], 2, 2] = 4.0
    tracker = EventTracker(3.0)
    tracker.add(z)
    events = tracker.result()
    assert events.first.tolist() == [0, 3]
    assert events.duration.tolist() == [2, 1]
    assert events.cut.tolist() == [True, False]
    assert events.per_frame == pytest.approx(2 / 5)


def chain(frames: int, pixels: int, stay: float, rate: float) -> np.ndarray:
    """Independent two-state Markov pixels, P(on) = rate, correlation ``stay`` per frame."""
    generator = np.random.default_rng(32)
    on = generator.random(pixels) < rate
    out = np.empty((frames, pixels), bool)
    for k in range(frames):
        out[k] = on
        renewed = generator.random(pixels) >= stay
        on = np.where(renewed, generator.random(pixels) < rate, on)
    return out


def test_joint_probability_of_a_markov_chain() -> None:
    """R(lag) = p² + p (1 - p) a^lag; correlation time -1 / log a."""
    p, a = 0.02, 0.8
    on = chain(400, 90 * 90, a, p)
    joint = JointExceedances(3.0, 100)
    joint.add(np.where(on, 4.0, 0.0).reshape(400, 90, 90))
    r = joint.result()
    # 7000 independent exceedances: 4 sigma of the rate are 5 %.
    assert r.joint[[0, 1, 4]] == pytest.approx(p * p + p * (1 - p) * a ** np.array([0, 1, 4]), rel=0.06)
    time, why = r.correlation_time()
    assert why is None
    assert time == pytest.approx(-1 / np.log(a), rel=0.04)  # linear between frames: 1 % of it
    assert r.correlation[50:].mean() == pytest.approx(0.0, abs=0.005)


@pytest.mark.parametrize("max_lag", [1, 63, 64, 130])
def test_joint_counts_are_those_of_the_definition(max_lag: int) -> None:
    generator = np.random.default_rng(33)
    z = np.where(generator.random((300, 6, 7)) < 0.05, 4.0, 0.0)
    z[:, 2, 3] = np.nan
    z[40] = np.nan
    joint = JointExceedances(3.0, max_lag)
    for block in np.array_split(z, 9):
        joint.add(block)
    r = joint.result()
    on, seen = z > 3, np.isfinite(z)
    for lag in (0, 1, max_lag // 2, max_lag):
        pairs = (seen[lag:] & seen[: 300 - lag]).sum()
        assert r.joint[lag] == pytest.approx((on[lag:] & on[: 300 - lag]).sum() / pairs, rel=1e-12, abs=1e-15)
    assert r.lag[-1] == max_lag


@pytest.mark.parametrize(
    ("z", "why"),
    [
        (np.full((1, 5, 5), 4.0), "single frame"),
        (np.zeros((9, 5, 5)), "no exceedances"),
        (np.where(np.arange(25).reshape(5, 5) == 7, 4.0, np.zeros((9, 5, 5))), "stay correlated"),
        (np.where(np.random.default_rng(3).random((50, 40, 40)) < 0.05, 4.0, 0.0), "within one frame"),
    ],
)
def test_correlation_time_that_cannot_be_told_is_none_with_the_reason(z: np.ndarray, why: str) -> None:
    joint = JointExceedances(3.0)
    joint.add(z)
    time, note = joint.result().correlation_time()
    assert time is None
    assert why in str(note)


def test_mean_duration_allows_for_the_ends_of_the_record() -> None:
    """Geometric durations of mean 10 in a record of 30 frames; the plain mean of complete ones is far too short."""
    alone = np.zeros((30, 400, 9), np.float32)
    generator = np.random.default_rng(34)
    for pixel in range(0, 400, 3):
        on = False
        for k in range(30):
            on = generator.random() >= 0.1 if on else generator.random() < 0.5
            alone[k, pixel, 4] = 4.0 * on
    tracker = EventTracker(3.0)
    tracker.add(alone)
    # Some 260 ends seen: 3 sigma are 19 %.
    assert tracker.result().mean_duration == pytest.approx(10.0, rel=0.19)
