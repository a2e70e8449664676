"""Thresholds for rates and contrasts for shares found, on white noise, against its closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import norm

from seaglint.analysis import Recording
from seaglint.detection.background import Background, count_false_alarms
from seaglint.detection.design import WhiteFrames, as_threshold, contrast_for, threshold_for
from seaglint.detection.rare_alarms import rare_tail
from seaglint.detection.spatial import FilterThreshold
from seaglint.detection.spot import GaussianSpot
from seaglint.detection.trials import InjectedObjects


@pytest.fixture(scope="module")
def white() -> Recording:
    frames = np.random.default_rng(21).normal(50.0, 2.0, (24, 128, 128)).astype(np.float32)
    return Recording("white", *frames.shape, lambda start, stop: frames[start:stop].copy())


def test_thresholds_of_rates_are_counted_or_extrapolated(white: Recording) -> None:
    background = Background(FilterThreshold(), white)
    count = count_false_alarms(background, background.threshold(3.0, "sigma"))
    tail = rare_tail(count.alarms.curve(), count.alarms.events(3.0))
    for rate in (1e-2, 1e-3, 2e-4):
        counted = threshold_for(count, tail, rate)
        assert (counted.how, counted.believed) == ("counted", True)
        assert 0.8 * rate < counted.p_fa <= rate  # the next of the thresholds counted at
        assert norm.sf(counted.sigma) == pytest.approx(counted.p_fa, rel=4.0 / np.sqrt(rate * background.pixels))
        # two standard deviations of a count to either side
        assert counted.high - counted.p_fa == pytest.approx(2.0 * np.sqrt(rate / background.pixels), rel=0.3)
        assert counted.high - counted.p_fa == pytest.approx(counted.p_fa - counted.low)
    rare = threshold_for(count, tail, 1e-6)
    assert rare.how == "extrapolated"
    assert rare.p_fa == pytest.approx(1e-6)
    assert rare.low < norm.sf(rare.sigma) < rare.high


def test_white_frames_are_like_their_source(white: Recording) -> None:
    like = WhiteFrames.like(white, 3)
    values = white.read(0, 24).astype(np.float64)
    assert (like.frames, like.rows, like.columns) == (24, 128, 128)
    assert (like.mean, like.sigma) == pytest.approx((values.mean(), values.std()), rel=1e-6)
    again = like.read(5, 7)
    assert np.array_equal(again[1], like.read(6, 7)[0])
    assert again.mean() == pytest.approx(50.0, abs=0.05)
    assert again.std() == pytest.approx(2.0, rel=0.02)


def test_contrast_for_a_share_of_white_noise(white: Recording) -> None:
    """A single pixel's threshold: P_d = Q(threshold - contrast in standard deviations), here of a spot that is one pixel."""
    background = Background(FilterThreshold(), white)
    threshold = background.threshold(4.0, "sigma")
    spot = GaussianSpot(0.3)
    peak = float(spot.stamps(np.zeros((1, 2))).max())
    objects = InjectedObjects(spot, (1.0,), 1500, "centre", 0.0, pointing="centroid", seed=2)
    needed = contrast_for(background, white, objects, threshold, 0.8)
    exact = 2.0 * (4.0 - norm.isf(0.8)) / peak
    assert needed.contrast == pytest.approx(exact, rel=0.03)
    assert needed.low < exact < needed.high
    assert list(needed.tried) == sorted(needed.tried)
    assert as_threshold(threshold_for(*_counted(background), 1e-3)).sigma == pytest.approx(norm.isf(1e-3), rel=0.02)


def _counted(background: Background):
    count = count_false_alarms(background, background.threshold(3.0, "sigma"))
    return count, rare_tail(count.alarms.curve(), count.alarms.events(3.0))
