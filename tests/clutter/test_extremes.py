"""Tails: against SciPy's fit, exact forms, and rates that are known below one per data set."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import genpareto

from seaglint.base.errors import DomainError
from seaglint.clutter.exceedances import Events
from seaglint.clutter.extremes import TRUSTED_SETS, TRUSTED_SPAN, ParetoFit, _anderson_darling, _draw, fit_pareto, fit_tail, with_limits
from seaglint.clutter.false_alarms import FalseAlarms, RateCurve


@pytest.mark.parametrize("shape", [-0.3, 0.0, 0.2, 0.8])
def test_fit_is_the_maximum_of_the_likelihood(shape: float) -> None:
    y = genpareto.rvs(shape, scale=2.5, size=3000, random_state=4)
    fit = fit_pareto(y)
    xi, _, beta = genpareto.fit(y, floc=0)
    assert (fit.shape, fit.scale) == pytest.approx((xi, beta), abs=2e-3)  # where SciPy's simplex stops
    assert fit.log_likelihood == pytest.approx(genpareto.logpdf(y, fit.shape, scale=fit.scale).sum(), rel=1e-9)
    assert fit.survival([0.0, 1.0, 5.0]) == pytest.approx(genpareto.sf([0.0, 1.0, 5.0], fit.shape, scale=fit.scale), rel=1e-9)
    # Standard deviations of the estimates, (1 + xi) / sqrt n and about sqrt 2 of it; four of them.
    assert fit.shape == pytest.approx(shape, abs=4 * (1 + shape) / np.sqrt(3000))


def test_numbers_are_repetitions() -> None:
    y = np.array([0.1, 0.2, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 9.0])
    n = np.array([9, 8, 7, 6, 5, 4, 3, 2, 1, 1])
    once, repeated = fit_pareto(y, n), fit_pareto(np.repeat(y, n))
    assert (once.shape, once.scale, once.log_likelihood) == pytest.approx((repeated.shape, repeated.scale, repeated.log_likelihood))


def tail_of(z: np.ndarray) -> tuple[RateCurve, Events]:
    alarms = FalseAlarms((3.0,))
    for frame in z:
        alarms.add(frame)
    return alarms.curve(), alarms.events(3.0)


def test_exponential_tail_is_extrapolated_to_one_in_ten_data_sets() -> None:
    z = np.random.default_rng(3).standard_exponential((20, 128, 128)) - 1
    tail, why = fit_tail(*tail_of(z))
    assert why is None
    assert tail.shape_interval[0] < 0 < tail.shape_interval[1]
    assert tail.goodness_p >= 0.1
    rate, low, high = tail.rates([5.0, 10.0, 13.0])
    truth = np.exp(-np.array([6.0, 11.0, 14.0]))
    assert (low < truth).all()
    assert (truth < high).all()
    assert (low < rate).all()
    # One per data set is 3e-6; trust ends within ten data sets, and where the interval spans a factor of ten.
    assert 1e-7 * 3.05 <= tail.trusted_to_rate < 3e-6
    assert tail.threshold_for(1e-5) == pytest.approx(-np.log(1e-5) - 1, rel=0.1)


def test_repeated_frames_widen_nothing_away() -> None:
    """The same frame ten times holds the same information: one event per bright pixel, not ten."""
    z = np.random.default_rng(5).standard_exponential((1, 200, 200)) - 1
    one, _ = fit_tail(*tail_of(z))
    ten, _ = fit_tail(*tail_of(np.repeat(z, 10, axis=0)))
    assert ten.events == one.events
    assert ten.shape_interval == pytest.approx(one.shape_interval, abs=0.02)


@pytest.mark.validation
def test_intervals_cover_at_their_level() -> None:
    """200 fields, heavy tail of shape 0.25: the 95 % interval at a fiftieth of the rate at 3 sigma covers the truth at least 178 times."""
    generator = np.random.default_rng(6)
    covered = 0
    for _ in range(200):
        z = np.expm1(0.25 * generator.standard_exponential((1, 100, 100))) / 0.25
        tail, _ = fit_tail(*tail_of(z))
        if tail is not None:
            _, low, high = tail.rates([20.0])
            covered += low[0] <= (1 + 0.25 * 20) ** -4 <= high[0]
        else:
            covered += 1
    assert covered >= 178


@pytest.mark.parametrize(
    ("z", "why"),
    [(np.zeros((2, 40, 40)), "0 events"), (np.where(np.random.default_rng(1).random((2, 90, 90)) < 0.02, 7.0, 0.0), "different values")],
)
def test_no_tail_is_an_answer(z: np.ndarray, why: str) -> None:
    tail, note = fit_tail(*tail_of(z))
    assert tail is None
    assert why in str(note)


def test_too_few_or_negative_excesses_are_refused() -> None:
    with pytest.raises(DomainError, match="at least 10"):
        fit_pareto([1.0, 2.0])
    with pytest.raises(DomainError, match="above 0"):
        fit_pareto(np.arange(20.0) - 3)


@pytest.mark.parametrize("shape", [-0.3, 0.0, 0.4])
def test_draws_are_the_inverse_of_the_survival_function(shape: float) -> None:
    fit = ParetoFit(shape, 1.7, 0.0)
    drawn = _draw(fit, 1000, np.random.default_rng(1))
    exponential = np.random.default_rng(1).standard_exponential(1000)
    np.testing.assert_allclose(drawn, genpareto.isf(np.exp(-exponential), shape, scale=1.7), rtol=1e-9)
    np.testing.assert_allclose(fit.survival(drawn), np.exp(-exponential), rtol=1e-9)


def test_the_anderson_darling_distance_is_its_integral() -> None:
    """n times the integral of the squared difference of both distribution functions over p (1 - p)."""
    fit = ParetoFit(0.2, 1.3, 0.0)
    drawn = np.sort(_draw(fit, 40, np.random.default_rng(2)))
    p = (np.arange(2_000_000) + 0.5) / 2_000_000
    steps = np.searchsorted(genpareto.cdf(drawn, 0.2, scale=1.3), p) / 40.0
    assert _anderson_darling(drawn, fit) == pytest.approx(40.0 * np.mean((steps - p) ** 2 / (p * (1.0 - p))), rel=1e-4)


def test_limits_are_those_of_maximum_likelihood() -> None:
    """Smith's covariance of shape and log scale, and a Poisson number; trusted up to the last rate that is sharp and not too rare."""
    threshold = np.linspace(0.0, 20.0, 2001)
    curve = RateCurve(threshold, np.rint(1e8 * np.exp(-threshold)).astype(np.int64), 10**8)
    fit, number = ParetoFit(0.15, 1.1, 0.0), 400
    tail = with_limits(curve, 300, 3.0, number, fit, 0.5, 4.0, np.random.default_rng(3))
    rates, shapes, scales = tail._draws
    assert tail.rate == pytest.approx(np.exp(-3.0))
    found = number * np.cov(np.stack([shapes, np.log(scales), np.log(rates)]))
    expected = np.array([[1.15**2, -1.15, 0.0], [-1.15, 2.0 * 1.15, 0.0], [0.0, 0.0, 1.0]])
    error = 4.0 * 1.15 * np.sqrt(2.0 * 2.3 / shapes.size)  # four standard errors of the largest entries
    np.testing.assert_allclose(found, expected, atol=error)
    assert tail.shape_interval == pytest.approx(tuple(np.quantile(shapes, [0.025, 0.975])))
    at = 3.0 + np.array([0.0, 2.0, 5.0])
    rate, low, high = tail.rates(at)
    np.testing.assert_allclose(rate, tail.rate * genpareto.sf(at - 3.0, 0.15, scale=1.1))
    each = rates[:, None] * genpareto.sf(at - 3.0, shapes[:, None], scale=scales[:, None])
    np.testing.assert_allclose((low, high), np.quantile(each, [0.025, 0.975], axis=0), rtol=1e-9)
    assert tail.threshold_for(1e-5) == pytest.approx(3.0 + genpareto.isf(1e-5 / tail.rate, 0.15, scale=1.1))
    assert tail.threshold_for(1.001 * tail.rate) is None
    steps = 3.0 + np.linspace(0.0, 40.0, 301)
    rate, low, high = tail.rates(steps)
    trusted = steps[: np.flatnonzero((high >= TRUSTED_SPAN * low) | (rate * 1e8 < 1.0 / TRUSTED_SETS))[0]]
    assert tail.trusted_to_sigma == pytest.approx(trusted[-1])
    assert tail.trusted_to_rate == pytest.approx(rate[trusted.size - 1])
