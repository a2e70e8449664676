"""Probabilities of detection and false alarm against closed forms, their intervals, and rare tails."""

from __future__ import annotations

import numpy as np
import pytest
from sample_tails import tail_of
from scipy.stats import binom, gamma, norm

from seaglint.analysis import Recording
from seaglint.base.errors import DataError, DomainError
from seaglint.detection.background import Background, count_false_alarms
from seaglint.detection.interface import Detector
from seaglint.detection.named_detectors import named_for
from seaglint.detection.scoring import exact_interval, interval, match_offsets
from seaglint.detection.spatial import FilterThreshold
from seaglint.detection.spot import GaussianSpot
from seaglint.detection.trials import InjectedObjects, run_trials

SPOT = GaussianSpot(0.8)
ENERGY = float((SPOT.stamps(np.zeros((1, 2))) ** 2).sum())


def recording(frames: np.ndarray) -> Recording:
    return Recording("test", *frames.shape, lambda start, stop: frames[start:stop])


def judged(frames: np.ndarray, detector: Detector, threshold: float, contrast: float, injections: int, seed: int = 0, level: float = 0.95):
    """Intervals of detection and false alarm."""
    source = recording(frames)
    background = Background(detector, source)
    found = background.threshold(threshold, "sigma")
    alarms = count_false_alarms(background, found, level)
    objects = InjectedObjects(SPOT, (contrast,), injections, "centre", 0.0, pointing="centroid", seed=seed)
    scores = run_trials(background, source, objects, found).scores[0]
    return alarms.cells.detection_interval(scores, level), alarms.per_pixel


@pytest.mark.parametrize(("name", "gain"), [("threshold", 1.0), ("matched", np.sqrt(ENERGY))])
def test_white_noise_gives_the_q_functions(name: str, gain: float) -> None:
    frames = np.random.default_rng(11).normal(50.0, 2.0, (24, 128, 128)).astype(np.float32)
    detections, alarms = judged(frames, named_for(name, SPOT, lambda: frames), 3.0, 5.0, 4000, level=0.999)
    assert detections.low < norm.sf(3.0 - gain * 2.5) < detections.high
    assert alarms.low < norm.sf(3.0) < alarms.high
    # Half widths: 3.3 sqrt(p q / n) of P_d, allowing for clusters, and a few per cent of P_fa.
    assert detections.high - detections.low < 0.08
    assert alarms.high < 1.5 * alarms.low


def test_gamma_clutter_gives_its_analytic_tail() -> None:
    shape = 2.5
    frames = np.random.default_rng(12).gamma(shape, 1.0, (24, 128, 128)).astype(np.float32)
    _, alarms = judged(frames, FilterThreshold(), 4.0, 1.0, 100, level=0.999)
    exact = gamma.sf(shape + 4.0 * np.sqrt(shape), shape)
    assert alarms.low < exact < alarms.high
    assert alarms.high < 1.6 * alarms.low
    assert exact > 50 * norm.sf(4.0)


def test_an_interval_counts_a_threshold_that_its_own_pixels_moved() -> None:
    # Rates above a threshold of one standard deviation scatter less than binomially, as mean and deviation move with the pixels:
    # p (1 - p) - phi(1)² (1 + 1/2) = 0.0457 in place of 0.1335.
    frames = np.random.default_rng(13).normal(0.0, 1.0, (64, 64, 64)).astype(np.float32)
    _, alarms = judged(frames, FilterThreshold(), 1.0, 1.0, 100)
    assert alarms.inflation == pytest.approx(0.0457 / 0.1335, rel=0.35)


def test_thresholds_by_their_laws() -> None:
    frames = np.random.default_rng(14).normal(10.0, 2.0, (4, 64, 64)).astype(np.float32)
    frames[2:] += 3.0
    background = Background(FilterThreshold(), recording(frames))
    fixed = background.threshold(20.0, "fixed")
    assert fixed.sigma == pytest.approx((20.0 - background.mean) / background.sigma)
    assert not fixed.estimated
    assert background.threshold(norm.sf(3.5), "design").sigma == pytest.approx(3.5)
    assert background.z(3, "frame").mean() == pytest.approx(0.0, abs=1e-4)
    assert background.z(3, "sigma").mean() > 0.4
    calibrated = Background(named_for("ca-cfar", SPOT, lambda: frames), recording(frames))
    assert calibrated.scale(0, "sigma") == (0.0, 1.0)
    assert not calibrated.threshold(3.0, "sigma").estimated
    for law, given in (("fixed", 5.0), ("design", 0.7), ("sigma", -1.0), ("sigma", np.nan)):
        with pytest.raises(DomainError):
            background.threshold(given, law)  # type: ignore[arg-type]


def test_border_that_repeats_pixels_is_left_out() -> None:
    frames = np.random.default_rng(15).normal(0.0, 1.0, (3, 64, 64)).astype(np.float32)
    background = Background(named_for("matched", SPOT, lambda: frames), recording(frames))
    assert background.border == 4
    assert background.pixels == 3 * 56 * 56


def test_frames_that_cannot_be_judged() -> None:
    with pytest.raises(DataError, match="in every pixel"):
        Background(FilterThreshold(), recording(np.ones((3, 20, 20), np.float32)))
    with pytest.raises(DataError, match="needs 17 frames"):
        Background(named_for("temporal-profile", SPOT, lambda: np.ones((1, 9, 9))), recording(np.ones((3, 20, 20), np.float32)))
    with pytest.raises(DataError, match="no statistic"):
        Background(named_for("ca-cfar", SPOT, lambda: np.ones((1, 9, 9))), recording(np.ones((3, 10, 10), np.float32)))


def test_intervals_of_few_occurrences_say_so() -> None:
    counts, trials = np.array([[[3]]]), np.array([[[100]]])
    found = interval(counts, trials, None, 0.95)
    # The ends at which 3 or more, and 3 or fewer, of 100 have a chance of 2.5 %.
    assert binom.sf(2, 100, found.low) == pytest.approx(0.025, rel=1e-6)
    assert binom.cdf(3, 100, found.high) == pytest.approx(0.025, rel=1e-6)
    assert "independent" in found.note
    assert interval(np.array([[[0]]]), trials, None, 0.95).low == 0.0
    assert match_offsets(1.5).shape == (9, 2)


def test_tail_says_what_it_cannot() -> None:
    values = np.random.default_rng(16).standard_normal((300, 300))
    tail, _, _ = tail_of(values)
    assert tail.fit is not None
    far = tail.at(7.0)
    assert far is not None
    assert not far.believed
    assert 0.9 < tail.extremal_index <= 1.0
    near = tail.threshold_for(1e-4)
    assert near is not None
    assert near.low < norm.sf(near.threshold_sigma) < near.high
    assert tail.at(1.0) is None
    assert tail_of(np.tile(np.arange(5.0), 40))[0].note is not None
    clustered, _, _ = tail_of(np.repeat(np.random.default_rng(17).exponential(size=(200, 200)), 3, axis=1))
    assert clustered.extremal_index < 0.4


@pytest.mark.validation
@pytest.mark.parametrize("clutter", ["gaussian", "gamma"])
def test_rare_tails_cover_the_truth(clutter: str) -> None:
    rate, covered = 1e-7, 0
    for seed in range(100):
        generator = np.random.default_rng(seed)
        values = generator.standard_normal((1000, 1000)) if clutter == "gaussian" else generator.gamma(4.0, 1.0, (1000, 1000))
        threshold = norm.isf(rate) if clutter == "gaussian" else gamma.isf(rate, 4.0)
        tail, mean, sigma = tail_of(values, seed=seed)
        found = tail.at((threshold - mean) / sigma)
        covered += found is not None and found.low <= rate <= found.high
    assert 90 <= covered <= 98


@pytest.mark.validation
def test_intervals_cover_the_q_functions() -> None:
    """400 recordings: 95 % of them are 380, with a standard deviation of 4.4; intervals of 90 % would hold 360."""
    hits = np.zeros(2)
    for seed in range(400):
        frames = np.random.default_rng(10_000 + seed).normal(5.0, 1.0, (16, 64, 64)).astype(np.float32)
        for k, (found, exact) in enumerate(zip(judged(frames, FilterThreshold(), 3.0, 3.0, 2000, seed), (0.5, norm.sf(3.0)), strict=True)):
            hits[k] += found.low <= exact <= found.high
    assert ((hits >= 368) & (hits <= 392)).all(), hits


@pytest.mark.parametrize("size", [(4, 64, 64), (8, 48, 48)])
def test_small_recordings_of_white_noise_have_an_interval_of_p_d(size: tuple[int, int, int]) -> None:
    inside = 0
    for repeat in range(10):
        frames = np.random.default_rng(repeat).standard_normal(size).astype(np.float32)
        found, _ = judged(frames, FilterThreshold(), 4.0, 4.0, 2000, seed=1)
        assert found.low is not None
        assert found.high is not None
        inside += found.low <= 0.5 <= found.high
    # 9.5 expected; 5 or fewer happen once in ten thousand
    assert inside >= 6


@pytest.mark.parametrize("expected", [0.13, 0.5, 2.0, 8.0])
def test_exact_intervals_hold_rare_chances(expected):
    """Summed over all counts that may occur, not drawn."""
    number = 16384
    counts = np.arange(40)
    chance = expected / number
    inside = [low <= chance <= high for low, high in (exact_interval(int(count), number, 0.95) for count in counts)]
    assert binom.pmf(counts, number, chance)[inside].sum() >= 0.95
