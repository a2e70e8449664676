"""Ratios of rates: the interval against closed forms and repeated counts, and the verdicts from it."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.special import betainc
from scipy.stats import gamma, t

from seaglint.clutter.cluster_variance import student_widening
from seaglint.clutter.false_alarms import FalseAlarmRate
from seaglint.clutter.rate_ratios import RateRatio, rate_ratio


def rate(count: int, pixels: int, inflation: float | None = 1.0, degrees: float = math.inf, note: str | None = None) -> FalseAlarmRate:
    return FalseAlarmRate(3.0, count, pixels, count / pixels, 0.0, 1.0, 0.95, 1.35e-3, inflation, None, note, None, degrees)


def test_the_interval_is_the_ratio_of_two_gamma_rates() -> None:
    """Jeffreys' priors: quantiles of the ratio of gamma variates, drawn."""
    rng = np.random.default_rng(1)
    drawn = gamma.rvs(40.5, size=400_000, random_state=rng) / 2e4 / (gamma.rvs(90.5, size=400_000, random_state=rng) / 3e4)
    found = rate_ratio(rate(90, 30_000), rate(40, 20_000))
    assert found.value == pytest.approx(40 / 2e4 / (90 / 3e4))
    # The ends use k + 1/2 of one and k + 1/2 of the other rate.
    assert [found.low, found.high] == pytest.approx(np.quantile(drawn, [0.025, 0.975]), rel=0.01)


@pytest.mark.parametrize(("one", "other"), [(4, 60), (60, 4), (3, 5), (9, 9)])
def test_few_events_have_the_exact_interval(one: int, other: int) -> None:
    """At each end the chance of a split as far from the expected one, given the sum, is 2.5 %."""
    found = rate_ratio(rate(one, 10_000), rate(other, 20_000))
    assert found.low is not None
    assert found.high is not None
    for ratio, successes in ((found.low, other), (found.high, other + 1)):
        share = 2.0 * ratio / (1.0 + 2.0 * ratio)
        chance = betainc(successes, one + other - successes + 1, share)
        assert chance == pytest.approx(0.025 if ratio == found.low else 0.975, abs=1e-9)


def test_clusters_widen_the_interval() -> None:
    """Counts of clusters of six as counts of a sixth of the pixels."""
    clustered = rate_ratio(rate(600, 60_000, 6.0), rate(300, 60_000, 6.0))
    alone = rate_ratio(rate(100, 10_000), rate(50, 10_000))
    assert [clustered.low, clustered.high] == pytest.approx([alone.low, alone.high])
    assert student_widening(5.0, 0.95) == pytest.approx((t.ppf(0.975, 5) / 1.959964) ** 2)
    assert student_widening(math.inf, 0.95) == 1.0
    wide = rate_ratio(rate(600, 60_000, 6.0, 5.0), rate(300, 60_000, 6.0, 5.0))
    assert wide.low < clustered.low
    assert wide.high > clustered.high


def test_swapping_the_two_inverts_the_ratio() -> None:
    one, other = rate(37, 9_000, 2.0, 12.0), rate(81, 7_000, 3.0, 8.0)
    there, back = rate_ratio(one, other), rate_ratio(other, one)
    assert there.value == pytest.approx(1.0 / back.value)
    assert [there.low, there.high] == pytest.approx([1.0 / back.high, 1.0 / back.low])


def test_rates_of_zero_have_one_end() -> None:
    none_then_some = rate_ratio(rate(0, 10_000), rate(20, 10_000))
    assert none_then_some.value is None
    assert none_then_some.high is None
    assert none_then_some.low == pytest.approx((1.0 / 0.025 ** (1.0 / 20.0) - 1.0) ** -1, rel=1e-6)
    some_then_none = rate_ratio(rate(20, 10_000), rate(0, 10_000))
    assert (some_then_none.value, some_then_none.low) == (0.0, 0.0)
    assert some_then_none.high == pytest.approx(1.0 / none_then_some.low)
    both = rate_ratio(rate(0, 10_000), rate(0, 10_000))
    assert (both.value, both.low, both.note) == (None, None, "no exceedances in either")
    unknown = rate_ratio(rate(9, 10_000, None, note="correlated all over"), rate(20, 10_000))
    assert (unknown.low, unknown.note) == (None, "correlated all over")
    assert "correlated all over" in unknown.text


def test_repeated_counts_lie_in_the_interval() -> None:
    """Clusters of a Poisson number of events, 2000 pairs: 95 % within three standard errors."""
    rng = np.random.default_rng(5)
    size, pixels, true = 4.0, 100_000, 1.7
    hits = 0
    for _ in range(2000):
        one, other = (4 * int(rng.poisson(mean)) for mean in (30.0, 30.0 * true))
        found = rate_ratio(rate(one, pixels, size), rate(other, pixels, size))
        hits += found.low <= true <= (found.high or math.inf)
    assert abs(hits / 2000 - 0.95) < 0.017


@pytest.mark.parametrize(
    ("ratio", "verdict"),
    [
        (RateRatio(1.0, 0.7, 1.4), "holds"),
        (RateRatio(1.4, 1.0, 1.6), "undecided"),
        (RateRatio(0.5, 0.4, 0.66), "differs"),
        (RateRatio(0.6, 0.5, 0.7), "undecided"),
        (RateRatio(0.0, 0.0, 0.3), "differs"),
        (RateRatio(0.0, 0.0, 3.0), "undecided"),
        (RateRatio(None, 1.2, None), "undecided"),
        (RateRatio(None, None, None, note="none"), "undecided"),
    ],
)
def test_verdicts_need_the_whole_interval(ratio: RateRatio, verdict: str) -> None:
    assert ratio.verdict(1.5) == verdict
