"""Operating characteristics against counts at every threshold."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import binomtest

from seaglint.clutter.false_alarms import RateCurve
from seaglint.detection.scoring import Scores, roc


def with_scores(score: np.ndarray) -> Scores:
    """Objects of which the scores alone matter."""
    none = np.zeros(score.size, np.int64)
    return Scores(1.0, score, none, none, none, np.zeros((score.size, 2)), np.zeros((score.size, 2)))


def test_rates_and_bands_are_those_of_counts_at_each_threshold() -> None:
    """Counts one by one; Wilson's interval of SciPy, of fewer values where their variance is larger."""
    rng = np.random.default_rng(2)
    noise, scores = rng.normal(size=20_000), rng.normal(2.5, 1.0, 300)
    threshold = np.linspace(-1.0, 6.0, 701)
    curve = RateCurve(threshold, np.array([(noise >= t).sum() for t in threshold]), noise.size)
    found = roc(curve, with_scores(scores), (4.0, np.nan))
    assert set(found.columns()) == {"threshold_sigma", "p_fa", "p_fa_low", "p_fa_high", "p_d", "p_d_low", "p_d_high"}
    assert np.array_equal(found.columns()["threshold_sigma"], found.threshold)
    assert np.isin(found.threshold, threshold).all()
    for i, at in enumerate(found.threshold):
        alarms, hits = (noise >= at).sum(), (scores > at).sum()
        assert (found.p_fa[i], found.p_d[i]) == pytest.approx((alarms / noise.size, hits / 300.0))
        wilson = binomtest(int(hits), 300).proportion_ci(method="wilson")
        assert (found.p_d_low[i], found.p_d_high[i]) == pytest.approx((wilson.low, wilson.high), abs=1e-9)
        if alarms % 4 == 0:
            wilson = binomtest(int(alarms // 4), noise.size // 4).proportion_ci(method="wilson")
            assert (found.p_fa_low[i], found.p_fa_high[i]) == pytest.approx((wilson.low, wilson.high), rel=1e-6, abs=1e-12)
    # from nearly all pixels of the curve to the last one, in steps even in the logarithm of the rate
    assert found.p_fa[-1] == 1.0 / noise.size
    rates = np.geomspace(0.999, 1.0 / noise.size, 120)
    assert found.threshold.tolist() == np.unique([threshold[curve.rate <= rate][0] for rate in rates]).tolist()


def test_frames_without_false_alarms_have_one_threshold() -> None:
    curve = RateCurve(np.array([1.0, 2.0]), np.array([0, 0]), 100)
    found = roc(curve, with_scores(np.array([0.5, 1.0, 1.5, 3.0])), (1.0, 1.0))
    assert found.threshold.tolist() == [1.0]
    assert (found.p_fa.tolist(), found.p_d.tolist()) == ([0.0], [0.5])
