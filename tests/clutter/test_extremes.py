"""Tails: against SciPy's fit, exact forms, and rates that are known below one per data set."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import genpareto

from seaglint.base.errors import DomainError
from seaglint.clutter.exceedances import Events
from seaglint.clutter.extremes import fit_pareto, fit_tail
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
    [
        (np.zeros((2, 40, 40)), "0 events"),
        (np.where(np.random.default_rng(1).random((2, 90, 90)) < 0.02, 7.0, 0.0), "different values"),
    ],
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
