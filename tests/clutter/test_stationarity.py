import numpy as np
import pytest
from scipy.ndimage import gaussian_filter

from seaglint.clutter.stationarity import stationarity


def field(rng, size=180, sigma=1.5):
    """Squared Gaussian: skewed, correlated over sqrt(2) sigma."""
    return gaussian_filter(rng.standard_normal((size, size)), sigma, mode="wrap") ** 2


def test_level_holds_for_skewed_correlated_clutter():
    rng = np.random.default_rng(1)
    found = [stationarity(field(rng), length_x=2.1, length_y=2.1, permutations=199, seed=i) for i in range(100)]
    # 5 % of 100 with a standard error of 2.2 %; three of these.
    assert np.mean([f.stationary is False for f in found]) <= 0.12
    assert np.mean([f.p_mean for f in found]) == pytest.approx(0.5, abs=0.1)
    assert np.mean([f.p_variance for f in found]) == pytest.approx(0.5, abs=0.1)


@pytest.mark.parametrize("shape", ["ramp", "corridor"])
@pytest.mark.parametrize("what", ["mean", "variance"])
def test_slow_changes_are_found(what, shape):
    rng = np.random.default_rng(2)
    x = np.linspace(-1.0, 1.0, 180)
    change = 1.0 + (0.5 * x if shape == "ramp" else np.exp(-((x / 0.4) ** 2)))
    noise = field(rng)
    noise = (noise - noise.mean()) / noise.std()
    found = stationarity(noise * change if what == "variance" else noise + change, length_x=2.1, length_y=2.1)
    assert found.stationary is False
    assert (found.p_variance if what == "variance" else found.p_mean) <= 0.01
    again = stationarity(noise * change if what == "variance" else noise + change, length_x=2.1, length_y=2.1)
    assert (again.p_mean, again.p_variance) == (found.p_mean, found.p_variance)


@pytest.mark.parametrize(
    ("data", "length", "reason"),
    [
        (np.random.default_rng(3).normal(size=(40, 40)), 5.0, "independent blocks"),
        (np.random.default_rng(3).normal(size=(90, 90)), np.nan, "not known"),
        (np.ones((120, 120)), 1.0, "without any variance"),
        (np.full((120, 120), np.nan), 1.0, "0 independent blocks"),
    ],
)
def test_undecidable_is_an_answer(data, length, reason):
    found = stationarity(data, length_x=length, length_y=length)
    assert found.stationary is None
    assert np.isnan(found.p_mean)
    assert reason in found.reason
