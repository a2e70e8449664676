"""Tails of counts, and how a sensor counts an object's light."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.stats import chi2, genpareto, norm, poisson, power_divergence
from stored_frames import StoredFrames

from seaglint.detection.background import Background, count_false_alarms
from seaglint.detection.sources import Counting, PlainFrames, poisson_quantile
from seaglint.detection.spatial import FilterThreshold
from seaglint.detection.spot import GaussianSpot
from seaglint.detection.stepped_tails import Steps, fit_levels, steps_of, tail_above
from seaglint.detection.trials import InjectedObjects, run_trials
from seaglint.studies.detect.performance import DetectionOptions, chips, detect


def test_the_tail_of_counts_is_fitted_to_their_levels() -> None:
    sigma = 2.0  # a count is half a standard deviation
    frames = np.rint(np.random.default_rng(3).normal(100.3, sigma, (70, 128, 128))).astype(np.float32)
    background = Background(FilterThreshold(), StoredFrames(frames))
    steps = steps_of(background, "sigma")
    assert steps is not None
    assert steps.step == pytest.approx(1.0 / background.sigma, rel=1e-3)
    count = count_false_alarms(background, background.threshold(4.0, "sigma"))
    tail = tail_above(background, "sigma", count.alarms.curve(), count.alarms.events(3.0))
    assert tail.fit is not None
    found = tail.threshold_for(1e-7)
    assert found is not None
    value = background.mean + found.threshold_sigma * background.sigma
    # a threshold in the middle between two counts, and the rate of the counts beyond it
    assert value % 1.0 == pytest.approx(0.5, abs=0.01)
    assert found.rate <= 1e-7
    assert found.low < norm.sf((value - 100.3) / sigma) < found.high
    # anywhere between the same two counts there are as many alarms
    assert tail.at(found.threshold_sigma + 0.4 * steps.step) == found


def test_other_statistics_are_not_taken_for_counts() -> None:
    frames = np.random.default_rng(3).normal(100.0, 2.0, (8, 64, 64)).astype(np.float32)
    assert steps_of(Background(FilterThreshold(), StoredFrames(frames)), "sigma") is None
    fine = np.rint(50.0 * frames)
    assert steps_of(Background(FilterThreshold(), StoredFrames(fine)), "sigma") is None


def test_electrons_of_an_object_are_poisson_numbers() -> None:
    share = np.random.default_rng(1).random(200_000)
    for mean in (0.7, 30.0, 400.0):
        drawn = poisson_quantile(np.full(share.size, mean), share)
        # four standard errors of mean and variance
        assert drawn.mean() == pytest.approx(mean, abs=4.0 * np.sqrt(mean / share.size))
        assert drawn.var() == pytest.approx(mean, rel=0.02)
        assert np.abs(drawn[:20_000] - poisson.ppf(share[:20_000], mean)).max() <= 1


def test_light_is_counted_in_steps_with_its_own_noise() -> None:
    counting = Counting(electrons=50.0, step=0.5)
    light = np.zeros((2, 300, 300), np.float32)
    light[1] = 3.2  # 160 electrons, 6.4 counts
    draws = counting.draws(7, 4, (2, 300, 300))
    added = counting.added(light, draws)
    assert not added[0].any()
    assert np.abs(added / 0.5 - np.rint(added / 0.5)).max() < 1e-5
    assert added[1].mean() == pytest.approx(3.2, abs=4.0 * np.sqrt(160.0) / 50.0 / 300.0)
    # shot noise and rounding at random: between 1/12 and 1/4 of a step squared
    assert 160.0 / 2500.0 + 0.25 / 12.0 < added[1].var() < 160.0 / 2500.0 + 0.25 / 3.0
    # a function of seed, frame and place alone
    np.testing.assert_array_equal(draws[1], counting.draws(7, 5, (1, 300, 300))[0])
    assert np.abs(draws[1] - counting.draws(8, 5, (1, 300, 300))[0]).max() > 0.5
    dark = Counting(50.0, 0.5).added(-light, draws)
    assert dark[1].mean() == pytest.approx(-3.2, abs=0.01)
    assert np.unique(dark[1]).tolist() == pytest.approx([-3.5, -3.0])


@dataclass
class Dim(PlainFrames):
    """Frames of a sensor in the dark: the objects' own noise is all there is, but for one thousandth."""

    counting: Counting | None = None
    frames: int = 20
    rows: int = 96
    columns: int = 96
    saturation: float | None = None

    def read(self, start: int, stop: int) -> np.ndarray:
        return np.stack([np.random.default_rng(k).normal(0.0, 1e-3, (self.rows, self.columns)) for k in range(start, stop)]).astype("f4")


def test_objects_behind_a_sensor_scatter_by_their_shot_noise() -> None:
    objects = InjectedObjects(GaussianSpot(0.3), (4.0,), 1500, "centre", 0.0, seed=3)
    scatter = {}
    for name, counting in (("without", None), ("with", Counting(25.0, 1e-3))):
        source = Dim(counting)
        background = Background(FilterThreshold(), source)
        found = run_trials(background, source, objects, background.threshold(4.0, "sigma"))
        scatter[name] = np.std(found.scores[0].score) * background.sigma
    assert scatter["without"] == pytest.approx(1e-3, rel=0.1)
    # 100 electrons: a tenth of 4; 1500 objects tell it to 2 %
    assert scatter["with"] == pytest.approx(0.4, rel=0.07)


def test_saturation_is_told_whatever_the_noise() -> None:
    source = Dim(Counting(25.0, 1e-3), saturation=3.0)
    background = Background(FilterThreshold(), source)
    found = run_trials(
        background, source, InjectedObjects(GaussianSpot(0.3), (1.0, 9.0), 300, "centre", 0.0), background.threshold(4.0, "sigma")
    )
    assert found.saturated == (0, 300)
    # nothing goes beyond it
    assert (found.scores[1].score * background.sigma).max() == pytest.approx(3.0, abs=0.01)


def test_pictures_of_misses_show_what_was_judged() -> None:
    source = Dim(Counting(50.0, 0.0025), saturation=0.06)
    found = detect(source, DetectionOptions(InjectedObjects(GaussianSpot(0.3), (0.04,), 300, "centre", 0.0, seed=3), threshold=100.0))
    missed = chips(found, source).missed
    assert len(missed) == 6
    for chip in missed:
        # its score is that of the pixel in the middle: two electrons or so, in steps, cut at saturation
        value = chip.score * found.background[1] + found.background[0]
        assert chip.pixels[12][12] == pytest.approx(value, abs=1e-6)
    assert len({round(chip.pixels[12][12], 2) for chip in missed}) > 1


@pytest.mark.parametrize("threshold", [-3.4, -0.2, 0.31, 1.0, 2.55, 7.29])
def test_thresholds_of_steps_are_middles_of_two_levels(threshold: float) -> None:
    steps = Steps(0.3, 0.7)
    levels = 0.3 + 0.7 * np.arange(-20, 20)
    middles = 0.5 * (levels[1:] + levels[:-1])
    assert steps.below(threshold) == pytest.approx(middles[np.argmax(levels > threshold) - 1])
    assert steps.above(threshold) == pytest.approx(middles[middles >= threshold].min())
    assert steps.above(middles[25]) == pytest.approx(middles[25])
    assert steps.below(levels[25]) == pytest.approx(middles[25])


@pytest.mark.parametrize(("shape", "share"), [(0.3, 1.0), (-0.25, 0.6), (0.0, 0.8)])
def test_levels_are_fitted_by_the_likelihood_of_their_numbers(shape: float, share: float) -> None:
    """Numbers of SciPy's distribution between ends of levels; the fit's likelihood, its region, and what lies beside it."""
    step, ends = 0.5, 0.5 * np.arange(26)
    chances = -np.diff(genpareto.sf(ends, shape, scale=1.3))
    counts = np.random.default_rng(2).multinomial(3000, chances / chances.sum())
    counts = counts[: np.flatnonzero(counts)[-1] + 1]
    fit, p, (shapes, scales) = fit_levels(counts, step, share)

    def likelihood(xi: float, beta: float) -> float:
        below = genpareto.sf(ends[: counts.size], xi, scale=beta) - genpareto.sf(ends[1 : counts.size + 1], xi, scale=beta)
        return share * float(counts @ np.log(np.maximum(below, 1e-300)))

    assert fit.log_likelihood == pytest.approx(likelihood(fit.shape, fit.scale), rel=1e-9)
    best = minimize(lambda at: -likelihood(at[0], np.exp(at[1])), (shape, np.log(1.3)), method="Nelder-Mead")
    assert fit.log_likelihood == pytest.approx(-best.fun, abs=0.3)  # on a grid of steps of 0.01 and 2.5 %
    assert (fit.shape, fit.scale) == (pytest.approx(best.x[0], abs=0.03), pytest.approx(np.exp(best.x[1]), rel=0.05))
    inside = np.array([likelihood(*pair) for pair in zip(shapes, scales, strict=True)])
    assert 0.0 <= inside.min() - (fit.log_likelihood - 0.5 * 2.1**2) < 0.5
    # steps beside the region's ends are outside it, whatever the scale
    for beyond in (shapes.min() - 0.01, shapes.max() + 0.01):
        assert max(likelihood(beyond, beta) for beta in np.unique(scales)) < fit.log_likelihood - 0.5 * 2.1**2
    reached = np.r_[genpareto.sf(ends[: counts.size], fit.shape, scale=fit.scale), 0.0]
    seen, expected = list(share * counts), list(-share * counts.sum() * np.diff(reached))
    while len(seen) > 1 and expected[-1] < 3.0:  # rare levels with those beyond
        seen[-2:], expected[-2:] = [sum(seen[-2:])], [sum(expected[-2:])]
    statistic = power_divergence(seen, np.array(expected) * sum(seen) / sum(expected), lambda_="log-likelihood").statistic
    assert p == pytest.approx(chi2.sf(statistic, len(seen) - 3), rel=1e-6)
    assert p > 0.01
