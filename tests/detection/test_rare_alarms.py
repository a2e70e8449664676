"""Where extrapolated rates of false alarms end, and where they stop being believed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from sample_tails import tail_of
from scipy.optimize import minimize
from scipy.stats import genpareto

from seaglint.clutter.extremes import TRUSTED_SETS, TRUSTED_SPAN
from seaglint.clutter.false_alarms import FalseAlarms
from seaglint.detection.rare_alarms import LOWEST_THRESHOLD, MOST_EVENTS, RareTail, rare_tail


@pytest.fixture(scope="module")
def tail() -> RareTail:
    """Exponential noise in 4 million values: its tail is of the fit's own form."""
    return tail_of(np.random.default_rng(5).exponential(size=(4, 1000, 1000)))[0]


def test_a_rate_is_believed_down_to_one_exceedance_in_ten_sets(tail: RareTail) -> None:
    few = replace(tail, pixels=20_000)  # far within what the fit's interval allows
    rarest = 1.0 / (TRUSTED_SETS * few.pixels)
    for share, believed in ((1.02, True), (0.98, False)):
        rate = few.threshold_for(share * rarest)
        assert rate is not None
        assert rate.high < TRUSTED_SPAN * rate.low  # the interval alone would do
        assert rate.rate == pytest.approx(share * rarest, rel=1e-6)
        assert rate.believed is believed


def test_a_rate_is_believed_while_its_interval_is_narrow(tail: RareTail) -> None:
    """As many pixels as one likes: what is left is the width of the interval."""
    endless = replace(tail, pixels=10**30)
    rates = [endless.at(t) for t in np.linspace(tail.fit.threshold, tail.fit.threshold + 25.0, 400)]
    assert [r.believed for r in rates] == [r.high < TRUSTED_SPAN * r.low for r in rates]
    assert {r.believed for r in rates} == {True, False}


def test_no_rate_is_above_one(tail: RareTail) -> None:
    """The fit's own rate of events, raised until the interval's upper end would be above every pixel."""
    common = replace(tail, fit=replace(tail.fit, rate=0.999))
    found = common.at(tail.fit.threshold)
    assert found.low < found.rate <= found.high == 1.0


def test_the_interval_adds_what_is_unknown_of_form_and_number_in_quadrature(tail: RareTail) -> None:
    """Either alone: without the one, as of the fit itself, or without the other, as of endless events."""
    at = tail.fit.threshold + 6.0
    alone = replace(tail, region=(np.array([tail.fit.fit.shape]), np.array([tail.fit.fit.scale]))).at(at)
    endless = replace(tail, fit=replace(tail.fit, events=10**30)).at(at)
    whole = tail.at(at)
    widths = {name: np.log([one.rate / one.low, one.high / one.rate]) for name, one in (("n", alone), ("form", endless), ("both", whole))}
    assert widths["n"] == pytest.approx(2.1 / np.sqrt(tail.fit.events))
    assert widths["both"] == pytest.approx(np.hypot(widths["n"], widths["form"]))
    shares = genpareto.sf(6.0, tail.region[0], scale=tail.region[1])
    assert (endless.low, endless.high) == pytest.approx((tail.fit.rate * shares.min(), tail.fit.rate * shares.max()), rel=1e-6)
    assert whole.rate == pytest.approx(tail.fit.rate * genpareto.sf(6.0, tail.fit.fit.shape, scale=tail.fit.fit.scale))


@pytest.mark.parametrize("shape", [-0.2, 0.25])
def test_shapes_and_scales_that_are_not_ruled_out_have_nearly_the_largest_likelihood(shape: float) -> None:
    """Likelihood of the curve's bins by SciPy, an event once; down to half of 2.1 squared, and no farther out is any that high."""
    values = genpareto.rvs(shape, size=(1, 1, 400_000), random_state=7)
    alarms = FalseAlarms((LOWEST_THRESHOLD,))
    alarms.add(values.astype(np.float32))
    curve = alarms.curve()
    tail = rare_tail(curve, alarms.events(LOWEST_THRESHOLD))
    above = curve.threshold >= tail.fit.threshold - 1e-6
    numbers, edges = -np.diff(curve.exceedances[above]), curve.threshold[above] - tail.fit.threshold
    middle = 0.5 * (edges[1:] + edges[:-1])
    weight = numbers * tail.fit.events / numbers.sum()

    def likelihood(xi: float, beta: float) -> float:
        return float(weight[numbers > 0] @ genpareto.logpdf(middle[numbers > 0], xi, scale=beta))

    inside = np.array([likelihood(*pair) for pair in zip(*tail.region, strict=True)])
    best = minimize(lambda at: -likelihood(at[0], np.exp(at[1])), (tail.fit.fit.shape, np.log(tail.fit.fit.scale)), method="Nelder-Mead")
    assert -best.fun - inside.max() == pytest.approx(0.0, abs=0.05)
    assert inside.min() - (inside.max() - 0.5 * 2.1**2) == pytest.approx(0.0, abs=0.05)
    assert inside.min() >= inside.max() - 0.5 * 2.1**2
    step = 0.1 * (1.0 + tail.fit.fit.shape) / np.sqrt(tail.fit.events)
    for beyond in (tail.region[0].min() - step, tail.region[0].max() + step):
        assert max(likelihood(beyond, beta) for beta in np.unique(tail.region[1])) < inside.max() - 0.5 * 2.1**2
    assert tail.extremal_index == pytest.approx(tail.fit.events / curve.exceedances[above][0], rel=1e-6)


def test_no_more_than_the_largest_events_are_fitted() -> None:
    alarms = FalseAlarms((LOWEST_THRESHOLD,))
    alarms.add(np.random.default_rng(8).exponential(size=(1, 500, 500)).astype(np.float32))
    events = alarms.events(LOWEST_THRESHOLD)
    assert len(events) > 4 * MOST_EVENTS
    tail = rare_tail(alarms.curve(), events)
    assert tail.fit.threshold >= np.sort(events.peak)[-MOST_EVENTS]
    # from there to the next edge of the curve's bins
    assert 0.97 * MOST_EVENTS < tail.fit.events <= MOST_EVENTS
