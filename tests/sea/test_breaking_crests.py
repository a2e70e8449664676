"""Breaking crests: closed forms against quadrature, Phillips' relation of coverage, drawn speeds, published amplitude."""

from __future__ import annotations

import itertools
import math
from typing import get_args

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.stats import kstest

from seaglint.base.errors import DomainError
from seaglint.sea.foam.breaking_crests import BreakingCrests, Form

FORMS = get_args(Form)
BEND = 3.8 / 4.2 * 9.81 / (2.0 * math.pi)  #: Speed above which the decay time is constant [m/s]; quadratures are divided there.


@pytest.fixture(params=[(form, wind) for form in FORMS for wind in (5.0, 10.0, 20.0)], ids=lambda case: f"{case[0]}-{case[1]:g}")
def crests(request: pytest.FixtureRequest) -> BreakingCrests:
    form, wind = request.param
    return BreakingCrests.create(2.95e-6 * wind**3.52, wind, form)


def test_coverage_is_the_integral_of_swept_area_and_life(crests: BreakingCrests) -> None:
    def swept(c: float) -> float:
        # Share of foam at a place by time after the crest: 1, then an exponential decline; integrated numerically.
        share = quad(lambda t: math.exp(-t / float(crests.decay(c))), 0.0, math.inf)[0]
        return c * (float(crests.active(c)) + share) * float(crests.density(c))

    total = quad(swept, crests.slowest, crests.fastest, points=[BEND], epsabs=0.0, epsrel=1e-9, limit=200)[0]
    wind = crests.fastest * 0.84 / 0.8
    assert total == pytest.approx(2.95e-6 * wind**3.52, rel=1e-8)  # that of the quadrature


@pytest.mark.parametrize("limits", [(1.0, 1.2), (1.0, 2.5), (1.3, 1.5), (2.0, 4.0), (0.2, 99.0)])
def test_parts_agree_with_quadrature(crests: BreakingCrests, limits: tuple[float, float]) -> None:
    low, high = max(limits[0], crests.slowest), min(limits[1], crests.fastest)
    bend = min(max(BEND, low), high)
    parts = [quad(lambda c: c * float(crests.life(c) * crests.density(c)), *ends, epsrel=1e-10)[0] for ends in ((low, bend), (bend, high))]
    rate = quad(lambda c: float(crests.rate(c)), low, high, epsabs=0.0, epsrel=1e-10, limit=200)[0]
    assert crests.coverage_between(*limits) == pytest.approx(sum(parts), rel=1e-7)
    assert crests.rate_between(*limits) == pytest.approx(rate, rel=1e-7)


def test_parts_add_up(crests: BreakingCrests) -> None:
    edges = np.linspace(crests.slowest, crests.fastest, 8)
    parts = sum(crests.coverage_between(low, high) for low, high in itertools.pairwise(edges))
    assert parts == pytest.approx(crests.coverage_between(0.0, 100.0), rel=1e-12)


def test_events_make_the_length_of_crests(crests: BreakingCrests) -> None:
    """A crest of length L that breaks for the time D adds L D to the length present at an instant."""
    c = np.linspace(crests.slowest, crests.fastest, 31)
    np.testing.assert_allclose(crests.rate(c) * crests.crest_length(c) * crests.duration(c), crests.density(c), rtol=1e-12)


@pytest.mark.parametrize("limits", [(1.0, 100.0), (1.5, 3.0)])
def test_drawn_speeds_follow_the_rate(crests: BreakingCrests, limits: tuple[float, float]) -> None:
    share = np.linspace(0.0, 1.0, 401)
    speeds = crests.speeds(share, *limits)
    low, high = max(limits[0], crests.slowest), min(limits[1], crests.fastest)
    assert (speeds[0], speeds[-1]) == pytest.approx((low, high), rel=1e-9)
    cumulative = np.array([crests.rate_between(low, speed) for speed in speeds]) / crests.rate_between(low, high)
    np.testing.assert_allclose(cumulative, share, atol=1e-10)


def test_drawn_lengths_have_the_distribution_of_phillips() -> None:
    """Events by speed, weighted with length and time, give Lambda(c): 200 000 draws, Kolmogorov's test of resampled speeds."""
    crests = BreakingCrests.create(0.01, 10.0)
    random = np.random.default_rng(8)
    speeds = crests.speeds(random.random(200_000), 1.0, 9.0)
    weights = crests.crest_length(speeds) * crests.duration(speeds)
    lengths = speeds[random.random(speeds.size) < weights / weights.max()]  # some hundreds of draws are accepted
    a, b = math.exp(-0.64), math.exp(-0.64 * 9.0)
    assert lengths.size > 300
    assert kstest(lengths, lambda c: (a - np.exp(-0.64 * c)) / (a - b)).pvalue > 0.001


def test_published_amplitude() -> None:
    """With Melville and Matusov's amplitude at 10 m/s the factor is 1, and Lambda(2 m/s) is their value."""
    once = BreakingCrests.create(0.01, 10.0)
    published = BreakingCrests.create(0.01 / once.factor, 10.0)  # type: ignore[operator]
    assert published.factor == pytest.approx(1.0, rel=1e-12)
    assert float(published.density(2.0)) == pytest.approx(3.3e-4 * math.exp(-1.28), rel=1e-12)
    assert BreakingCrests.create(0.01, 10.0, "phillips-1985").factor is None


def test_life_is_one_to_ten_seconds() -> None:
    crests = BreakingCrests.create(0.01, 10.0)
    life = crests.life(np.linspace(1.0, 9.0, 50))
    assert np.all(np.diff(life) > 0.0)
    assert (life[0], life[-1]) == pytest.approx((5 * 2 * math.pi / 9.81, 0.8 * 2 * math.pi * 9.0 / 9.81 + 3.8), rel=1e-12)


def test_lengths_and_times_of_a_breaker() -> None:
    """A wave of 64 m has a phase speed of 10 m/s and a period of 6.4 s; its crest breaks at 8 m/s."""
    crests = BreakingCrests.create(0.01, 10.0)
    assert (float(crests.crest_length(8.0)), float(crests.duration(8.0))) == pytest.approx((6.405, 1.9215), rel=1e-3)


def test_no_foam_no_crests() -> None:
    crests = BreakingCrests.create(0.0, 10.0)
    assert crests.rate_between(1.0, 9.0) == 0.0
    assert not crests.density(np.array([1.0, 3.0])).any()


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        ((1.2, 10.0), "coverage = 1.2 is outside 0-1"),
        ((math.nan, 10.0), "coverage = nan"),
        ((0.01, 0.0), "wind_speed = 0 m/s must be positive"),
        ((0.01, 10.0, "duncan"), "form = 'duncan' is not known; allowed: melville-matusov-2002, phillips-1985"),
        ((0.01, 10.0, "phillips-1985", 3.0, 2.0), "speeds from 3 to 2 m/s are not in order"),
    ],
)
def test_refusals(arguments: tuple[float, ...], text: str) -> None:
    with pytest.raises(DomainError, match=text):
        BreakingCrests.create(*arguments)  # type: ignore[arg-type]
