"""Constant-false-alarm detectors keep their promise on the clutter they are exact for, and see a target."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.special import gammaln
from scipy.stats import norm, t

from seaglint.base.errors import DomainError
from seaglint.clutter.false_alarms import FalseAlarms
from seaglint.clutter.thresholds import gaussian_rate
from seaglint.detection.cfar import CellAveraging, OrderedStatistic
from seaglint.detection.interface import Detector


def clutter(kind: str, seed: int = 41) -> np.ndarray:
    generator = np.random.default_rng(seed)
    shape = (8, 256, 256)
    # A level of its own for every frame: neither mean nor gain may matter.
    gain = np.linspace(0.5, 40, 8)[:, None, None]
    x = gain * generator.standard_exponential(shape) if kind == "exponential" else gain * (100 + generator.standard_normal(shape))
    return x.astype(np.float32)


CASES = [
    (CellAveraging(2, 1), "gaussian"),
    (CellAveraging(8, 2), "gaussian"),
    (CellAveraging(2, 1, "exponential"), "exponential"),
    (CellAveraging(6, 0, "exponential"), "exponential"),
    pytest.param(OrderedStatistic(2, 1, 0.5, "exponential"), "exponential", marks=pytest.mark.validation),
    (OrderedStatistic(4, 2, 0.75, "exponential"), "exponential"),
    pytest.param(OrderedStatistic(2, 1, 0.8), "gaussian", marks=pytest.mark.validation),
    (OrderedStatistic(4, 2), "gaussian"),
]


@pytest.mark.parametrize(("detector", "kind"), CASES, ids=lambda c: str(getattr(c, "name", c)))
def test_false_alarms_are_those_of_the_design(detector: Detector, kind: str) -> None:
    """5e5 pixels, rates at 2, 3 and 3.5 equivalent sigma inside the 99.9 % interval (16 cells uncorrected: 3 times off)."""
    assert detector.calibrated
    z = detector(clutter(kind))
    alarms = FalseAlarms((2.0, 3.0, 3.5))
    alarms.add(z)
    for r in alarms.rates(level=0.999):
        assert r.rate_low < gaussian_rate(r.threshold_sigma) < r.rate_high
    seen = z[np.isfinite(z)]
    # The lower tail as well, so that the whole scale is equivalent sigmas: 1e4 pixels below -2.
    assert (seen < -2).mean() == pytest.approx(float(gaussian_rate(2.0)), rel=0.06)


@pytest.mark.parametrize(
    "detector",
    [CellAveraging(3, 1), CellAveraging(3, 1, "exponential"), OrderedStatistic(3, 1), OrderedStatistic(3, 1, clutter="exponential")],
    ids=lambda d: d.name,
)
def test_borders_and_missing_rings_are_nan_and_nothing_else(detector) -> None:
    x = np.random.default_rng(1).standard_exponential((1, 30, 31)).astype(np.float32)
    x[0, 15, 16] = np.nan
    finite = np.isfinite(detector(x)[0])
    row, column = np.indices(finite.shape)
    far = np.maximum(abs(row - 15), abs(column - 16))
    inside = (row >= 3) & (row < 27) & (column >= 3) & (column < 28)
    in_guard = (far <= 1) & (far > 0)
    assert np.array_equal(finite, inside & ((far > 3) | in_guard))


def test_ordered_statistic_is_not_lifted_by_a_bright_neighbour() -> None:
    """Two targets in one ring: the second lifts the mean, not the quantile."""
    x = np.random.default_rng(2).standard_exponential((1, 41, 41)).astype(np.float32)
    x[0, 20, 20] = 30.0
    alone = [CellAveraging(5, 2, "exponential")(x)[0, 20, 20], OrderedStatistic(5, 2, clutter="exponential")(x)[0, 20, 20]]
    x[0, 16, 20:24] = 100.0
    both = [CellAveraging(5, 2, "exponential")(x)[0, 20, 20], OrderedStatistic(5, 2, clutter="exponential")(x)[0, 20, 20]]
    assert both[0] < 0.7 * alone[0]
    assert both[1] > 0.9 * alone[1]


def test_guard_keeps_a_target_out_of_its_background() -> None:
    x = np.random.default_rng(3).standard_normal((1, 41, 41)).astype(np.float32)
    x[0, 19:22, 19:22] += 12.0
    assert CellAveraging(8, 2)(x)[0, 20, 20] > 8.0
    assert CellAveraging(8, 0)(x)[0, 20, 20] < 8.0


def test_flat_image_says_nothing() -> None:
    x = np.full((1, 30, 30), 290.7, np.float32)
    assert np.isnan(CellAveraging()(x)).all()
    assert np.isnan(OrderedStatistic()(x)).all()
    assert np.isnan(OrderedStatistic(clutter="exponential")(np.zeros((1, 30, 30), np.float32))).all()


def test_ordered_statistic_does_not_feel_level_and_gain() -> None:
    x = np.random.default_rng(5).standard_normal((1, 40, 40)).astype(np.float32)
    np.testing.assert_allclose(OrderedStatistic()(50.0 + 4.0 * x), OrderedStatistic()(x), rtol=1e-3, atol=1e-3)


@pytest.mark.parametrize(
    "make",
    [
        lambda: CellAveraging(2, 2),
        lambda: OrderedStatistic(3, -1),
        lambda: OrderedStatistic(quantile=1.0),
        lambda: OrderedStatistic(quantile=0.5),
    ],
)
def test_unusable_settings_are_refused(make) -> None:
    with pytest.raises(DomainError):
        make()


def rings(frame: np.ndarray, training: int, guard: int) -> tuple[np.ndarray, np.ndarray]:
    """Pixels that have a whole ring, and the values of each one's."""
    side = 2 * training + 1
    used = np.ones((side, side), bool)
    used[training - guard : training + guard + 1, training - guard : training + guard + 1] = False
    return frame[training:-training, training:-training], np.lib.stride_tricks.sliding_window_view(frame, (side, side))[..., used]


@pytest.mark.parametrize(("training", "guard"), [(3, 1), (2, 0), (4, 2)])
def test_equivalent_deviations_are_those_of_the_closed_tails(training: int, guard: int) -> None:
    """Pixel by pixel: Student's t, the power law of an exponential's mean, and Rohling's ratio of Gamma functions."""
    frame = np.random.default_rng(3).standard_exponential((24, 30)).astype(np.float32)
    inner = (0, slice(training, -training), slice(training, -training))
    x, ring = (part.astype(float) for part in rings(frame, training, guard))
    n = ring.shape[-1]
    student = (x - ring.mean(axis=-1)) / (ring.std(axis=-1, ddof=1) * np.sqrt(1.0 + 1.0 / n))
    np.testing.assert_allclose(CellAveraging(training, guard)(frame[None])[inner], norm.isf(t.sf(student, n - 1)), atol=1e-4)
    power = np.exp(-n * np.log1p(x / ring.mean(axis=-1) / n))
    np.testing.assert_allclose(CellAveraging(training, guard, "exponential")(frame[None])[inner], norm.isf(power), atol=1e-4)
    rank = round(0.6 * n)
    ratio = x / np.sort(ring, axis=-1)[..., rank - 1]
    tail = np.exp(gammaln(n + 1) + gammaln(n - rank + 1 + ratio) - gammaln(n - rank + 1) - gammaln(n + 1 + ratio))
    np.testing.assert_allclose(OrderedStatistic(training, guard, 0.6, "exponential")(frame[None])[inner], norm.isf(tail), atol=1e-4)


@pytest.mark.parametrize(("c", "quantile"), [(1.2, 0.75), (-0.7, 0.6)])
def test_the_tail_between_two_quantiles_is_the_integral_over_their_joint_density(c: float, quantile: float) -> None:
    """Ranks l = n + 1 - k and k of n Gaussian values; the statistic made from a pixel at that ratio between them."""
    n = 7**2 - 3**2
    k = max(round(quantile * n), n // 2 + 1)
    frame = np.random.default_rng(4).normal(size=(7, 7)).astype(np.float32)
    ring = np.sort(rings(frame, 3, 1)[1].ravel().astype(float))
    low, high = ring[n - k], ring[k - 1]
    frame[3, 3] = 0.5 * (low + high) + c * (high - low)
    grid = np.linspace(-6.0, 6.0, 1501)
    a, b = grid[:, None], grid[None, :]
    with np.errstate(divide="ignore", invalid="ignore"):
        joint = (
            (n - k) * (norm.logcdf(a) + norm.logsf(b))
            + (2 * k - n - 2) * np.log(norm.cdf(b) - norm.cdf(a))
            + norm.logpdf(a)
            + norm.logpdf(b)
        )
    weight = np.where(b > a, np.exp(joint - np.nanmax(joint[np.isfinite(joint)])), 0.0)
    tail = np.sum(weight * norm.sf(0.5 * (a + b) + c * (b - a))) / np.sum(weight)
    assert OrderedStatistic(3, 1, quantile)(frame[None])[0, 3, 3] == pytest.approx(norm.isf(tail), abs=2e-3)
