import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from seaglint.base.errors import DataError
from seaglint.clutter.moments import Moments, PixelMoments


def sums(moments):
    return moments.count, moments.mean, moments.std, moments.skewness, moments.excess_kurtosis


@given(st.integers(0, 2**31), st.lists(st.integers(1, 60), min_size=1, max_size=6))
def test_blocks_of_any_size_merge_to_the_whole(seed, sizes):
    data = np.random.default_rng(seed).gamma(1.5, 2.0, sum(sizes)) + 50.0
    parts = np.split(data, np.cumsum(sizes)[:-1])
    forward = sum((Moments.of(part) for part in parts), Moments())
    backward = sum((Moments.of(part) for part in parts[::-1]), Moments())
    if len(data) > 1:
        # Rounding only: 50 standard deviations from zero cost the fourth power some digits.
        assert sums(forward) == pytest.approx(sums(Moments.of(data)), rel=1e-9, abs=1e-9)
        assert sums(forward) == pytest.approx(sums(backward), rel=1e-9, abs=1e-9)


def test_against_scipy_far_from_zero():
    data = np.random.default_rng(3).gamma(2.0, 1.0, 40_000) + 1e4
    found = Moments.of(data)
    assert found.mean == pytest.approx(data.mean(), rel=1e-14)
    assert found.std == pytest.approx(data.std(), rel=1e-11)
    assert found.skewness == pytest.approx(stats.skew(data), rel=1e-9)
    assert found.excess_kurtosis == pytest.approx(stats.kurtosis(data), rel=1e-9)
    assert (found.minimum, found.maximum) == (data.min(), data.max())


def test_known_shapes():
    # Exact moments of a fair die: variance 35/12, no skewness, excess kurtosis -222/175.
    die = Moments.of(np.tile(np.arange(1, 7), 10))
    assert sums(die) == pytest.approx((60, 3.5, (35 / 12) ** 0.5, 0.0, -222 / 175), rel=1e-13, abs=1e-14)


def test_maps_give_every_region():
    rng = np.random.default_rng(5)
    frames = rng.normal(100.0, 3.0, (23, 17, 19)).astype(np.float32)
    frames[rng.random(frames.shape) < 0.1] = np.nan
    frames[:, 4, :] = np.nan
    mask = rng.random((17, 19)) < 0.4
    gathered = PixelMoments.empty(17, 19)
    for block in np.split(frames, [1, 9, 10]):
        gathered.add(block)
    chosen = frames[:, mask].astype(float)
    chosen = chosen[np.isfinite(chosen)]
    expected = (chosen.size, chosen.mean(), chosen.std(), stats.skew(chosen), stats.kurtosis(chosen))
    assert sums(gathered.region(mask)) == pytest.approx(expected, rel=1e-9, abs=1e-9)
    together = gathered.region(mask) + gathered.region(~mask)
    assert sums(together) == pytest.approx(sums(gathered.region()), rel=1e-10, abs=1e-10)
    assert np.isnan(gathered.image[4]).all()
    np.testing.assert_allclose(gathered.std[0], np.nanstd(frames[:, 0].astype(float), axis=0), rtol=1e-10)


def test_constants_have_no_shape_and_nothing_has_no_mean():
    constant = Moments.of(np.full(100, 0.1))
    assert constant.is_constant
    assert np.isnan(constant.skewness)
    assert np.isnan(constant.excess_kurtosis)
    assert Moments.of([np.nan, np.nan]).count == 0
    assert np.isnan(Moments().std)


def test_wrong_shapes_are_refused():
    with pytest.raises(DataError, match="does not fit"):
        PixelMoments.empty(4, 5).add(np.zeros((2, 5, 4)))
    with pytest.raises(DataError, match="mask"):
        PixelMoments.empty(4, 5).region(np.ones((5, 4), bool))
