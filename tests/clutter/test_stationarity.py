import numpy as np
import pytest
from scipy.ndimage import gaussian_filter

from seaglint.base.errors import DataError
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


def test_blocks_are_apart_and_need_half_of_their_pixels():
    """Four lengths a side, three between: moments of those pixels alone, in all frames; what lies between counts nowhere."""
    rng = np.random.default_rng(5)
    data = rng.gamma(2.0, 1.0, (2, 100, 130))
    rows, columns = [slice(18 * i, 18 * i + 10) for i in range(6)], [slice(21 * i, 21 * i + 12) for i in range(6)]
    between = np.ones((100, 130), bool)
    for row in rows:
        for column in columns:
            between[row, column] = False
    data[:, between] = 1e6
    data[:, 0:5, 0:12] = np.nan  # half of the first block
    data[:, 0:5, 21:33] = np.nan
    data[0, 5, 21] = np.nan  # more than half of the second
    found = stationarity(data, length_y=2.5, length_x=3.0, permutations=19)
    assert found.block == (10, 12)
    assert found.mean.shape == (6, 6)
    for i, row in enumerate(rows):
        for j, column in enumerate(columns):
            block = data[:, row, column]
            expected = (np.nan, np.nan) if (i, j) == (0, 1) else (np.nanmean(block), np.nanvar(block))
            assert (found.mean[i, j], found.variance[i, j]) == pytest.approx(expected, nan_ok=True)
    masked = stationarity(np.where(between, np.nan, rng.gamma(2.0, 1.0, (100, 130))), ~between, length_y=2.5, length_x=3.0, permutations=19)
    assert np.isfinite(masked.mean).all()


@pytest.mark.parametrize(
    ("levels", "verdict"), [((0.026, 0.9), True), ((0.9, 0.026), True), ((0.9, 0.0245), False), ((0.0245, 0.9), False)]
)
def test_either_level_below_half_of_five_percent_refuses(monkeypatch, levels, verdict):
    """Two tests, each at half of the level."""
    made = iter(levels)
    monkeypatch.setattr("seaglint.clutter.stationarity._level", lambda *given: next(made))
    assert stationarity(field(np.random.default_rng(6)), length_x=2.1, length_y=2.1).stationary is verdict


def test_lengths_and_masks_that_do_not_fit():
    data = np.random.default_rng(7).normal(size=(100, 100))
    for lengths in ((np.nan, 2.0), (2.0, np.nan)):
        assert "not known" in stationarity(data, length_x=lengths[0], length_y=lengths[1]).reason
    with pytest.raises(DataError, match="mask of another"):
        stationarity(data, np.ones((100, 99), bool), length_x=2.0, length_y=2.0)
