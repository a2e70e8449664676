import numpy as np
import pytest
from scipy.ndimage import gaussian_filter
from scipy.signal import lfilter

from seaglint.base.errors import DataError
from seaglint.clutter.correlation import block_labels, decay, effective_count, spatial_correlation, temporal_correlation, trend_surface

LENGTHS = [1.2, 1.5, 2.0, 2.7, 5.0, 8.5]


def autoregressive(rng, frames, pixels, tau):
    a = np.exp(-1.0 / tau)
    start = rng.standard_normal((1, pixels))
    return lfilter([np.sqrt(1 - a * a)], [1.0, -a], rng.standard_normal((frames, pixels)), axis=0, zi=a * start)[0]


@pytest.mark.parametrize("length", LENGTHS)
@pytest.mark.parametrize("shape", [1.0, 2.0])
def test_decay_between_samples(length, shape):
    assert decay(np.exp(-((np.arange(60) / length) ** shape))) == pytest.approx(length, rel=5e-3)


def test_decay_that_never_comes_or_comes_at_once():
    assert np.isnan(decay(np.full(20, 0.9)))
    assert np.isnan(decay(np.full(20, np.nan)))
    assert decay(np.array([1.0, 0.0, 0.0])) == pytest.approx(1.0 - np.exp(-1.0))


def test_lengths_along_and_across():
    # White noise through Gaussian kernels of 2 and 5 px: exp(-lag^2 / 4 sigma^2), 1/e at twice sigma. 512^2 px: 2000 independent.
    field = gaussian_filter(np.random.default_rng(2).standard_normal((512, 512)), (2.0, 5.0), mode="wrap")
    found = spatial_correlation(field)
    assert (found.length_y, found.length_x) == pytest.approx((4.0, 10.0), rel=0.05)
    assert (found.scale_y, found.scale_x) == pytest.approx((4.0 * np.sqrt(np.pi), 10.0 * np.sqrt(np.pi)), rel=0.12)
    transposed = spatial_correlation(field.T)
    assert (transposed.length_y, transposed.length_x) == (pytest.approx(found.length_x, rel=1e-9), pytest.approx(found.length_y, rel=1e-9))


def test_against_the_sum_over_pairs():
    rng = np.random.default_rng(4)
    field = rng.standard_normal((3, 12, 15))
    field[0, 3, 4] = np.nan
    mask = rng.random((12, 15)) < 0.7
    found = spatial_correlation(field, mask, longest=4)
    use = np.isfinite(field) & mask
    d = np.where(use, field - field[use].mean(), 0.0)
    # The correction for the mean is common to all lags: differences of lags are free of it up to one factor.
    c = [np.sum(d[:, :, : 15 - lag] * d[:, :, lag:]) / np.sum(use[:, :, : 15 - lag] & use[:, :, lag:]) for lag in range(5)]
    measured = (found.x[1:4] - found.x[2:5]) / (found.x[0] - found.x[1])
    expected = (np.array(c[1:4]) - np.array(c[2:5])) / (np.mean(d[use] ** 2) - c[1])
    np.testing.assert_allclose(measured, expected, rtol=1e-9)


def test_a_trend_is_no_correlation():
    rng = np.random.default_rng(5)
    noise = gaussian_filter(rng.standard_normal((200, 200)), 1.5, mode="wrap")
    corridor = 3.0 * noise.std() * np.exp(-(((np.arange(200) - 90) / 90.0) ** 2))
    raw = spatial_correlation(noise + corridor)
    freed = spatial_correlation(noise + corridor, mean=trend_surface(noise + corridor))
    assert raw.length_x > 5.0
    assert raw.length_y > 20.0
    assert freed.length_x == pytest.approx(3.0, rel=0.05)


def test_trend_surface_returns_a_polynomial():
    y, x = np.mgrid[:40, :50] / 50.0
    surface = 1.0 + x - 2.0 * y**2 + x * y**2
    gaps = np.where(np.random.default_rng(1).random(surface.shape) < 0.2, np.nan, surface)
    np.testing.assert_allclose(trend_surface(gaps), surface, rtol=1e-10)


@pytest.mark.parametrize("tau", [2.0, 6.0])
def test_correlation_time(tau):
    rng = np.random.default_rng(6)
    series = autoregressive(rng, 400, 3000, tau) + 10.0 * rng.standard_normal(3000)
    found = temporal_correlation(series, 25.0)
    assert found.time == pytest.approx(tau / 25.0, rel=0.03)
    assert found.scale == pytest.approx((1 + np.exp(-1 / tau)) / (1 - np.exp(-1 / tau)), rel=0.1)


def test_the_mean_taken_from_the_data_is_allowed_for():
    # 60 frames of 5: without the correction the time is 15 % short.
    found = temporal_correlation(autoregressive(np.random.default_rng(7), 60, 8000, 5.0))
    assert found.time == pytest.approx(5.0, rel=0.07)


@pytest.mark.parametrize(("series", "reason"), [(np.zeros((4, 9)), "4 frames"), (np.ones((40, 9)), "no pixel changes")])
def test_time_that_cannot_be_told(series, reason):
    found = temporal_correlation(series, 25.0)
    assert np.isnan(found.time)
    assert reason in found.reason


@pytest.mark.parametrize("rate", [0.0, -1.0, np.nan])
def test_bad_frame_rate(rate):
    with pytest.raises(DataError, match="frame_rate"):
        temporal_correlation(np.zeros((20, 3)), rate)


def test_effective_count_is_that_of_the_mean():
    # Variance of block means is variance over independent values per block: 256 blocks, level of the ratio 9 %, 3 of them.
    field = gaussian_filter(np.random.default_rng(8).standard_normal((1024, 1024)), 2.0, mode="wrap")
    c = spatial_correlation(field)
    counted = effective_count(64 * 64, c.scale_x, c.scale_y)
    scattered = field.var() / field.reshape(16, 64, 16, 64).mean(axis=(1, 3)).var()
    assert counted == pytest.approx(scattered, rel=0.3)
    assert effective_count(100.0) == 100.0
    assert effective_count(100.0, 1e9, np.nan) == 1.0


def test_block_labels_are_whole_blocks():
    labels = block_labels((2, 20, 30), (1, 7, 9))
    _, counts = np.unique(labels, return_counts=True)
    assert len(counts) == 2 * 2 * 3
    assert counts.min() >= 7 * 9


def test_constant_and_empty():
    assert np.isnan(spatial_correlation(np.ones((20, 20))).length_x)
    assert np.isnan(spatial_correlation(np.full((20, 20), np.nan)).length_y)
    with pytest.raises(DataError, match="mask"):
        spatial_correlation(np.ones((20, 20)), np.ones((20, 21), bool))


@pytest.mark.validation
def test_gamma_field_gives_back_what_it_was_made_of():
    """Sum of two squared Gaussian fields: gamma of shape 1, correlation squared: 1/e length sqrt(2) sigma, time tau / 2."""
    from seaglint.clutter.fits import fit

    rng = np.random.default_rng(9)
    tau, sigma = 8.0, 2.0
    a = np.exp(-1.0 / tau)
    frames = np.zeros((360, 256, 256))
    for _ in range(2):
        state = gaussian_filter(rng.standard_normal((256, 256)), sigma, mode="wrap") * 2.0 * np.sqrt(np.pi) * sigma
        for frame in frames:
            frame += state**2
            state = (
                a * state
                + np.sqrt(1 - a * a) * gaussian_filter(rng.standard_normal((256, 256)), sigma, mode="wrap") * 2.0 * np.sqrt(np.pi) * sigma
            )
    space = spatial_correlation(frames[::36])
    time = temporal_correlation(frames[:, ::4, ::4], 1.0)
    found = fit(frames[::4], "gamma")
    assert effective_count(frames.size, space.scale_x, space.scale_y, time.scale) > 1e5
    assert found.shape == pytest.approx(1.0, rel=0.03)
    assert (space.length_x, space.length_y) == pytest.approx((np.sqrt(2) * sigma,) * 2, rel=0.03)
    assert time.time == pytest.approx(tau / 2.0, rel=0.03)


def test_decay_within_the_first_lag():
    """With a second value above the noise by the exponential through both, else along a straight line from 1."""
    assert decay(np.exp(-np.arange(8) / 0.8)) == pytest.approx(0.8, rel=1e-6)
    assert decay(np.array([1.0, 0.3, 0.01, 0.0])) == pytest.approx((1.0 - np.exp(-1.0)) / 0.7)
    assert decay(np.array([1.0, 0.3])) == pytest.approx((1.0 - np.exp(-1.0)) / 0.7)
    assert decay(np.array([1.0, 0.01, 0.2, 0.1])) == pytest.approx((1.0 - np.exp(-1.0)) / 0.99)


def test_decay_before_noise_is_along_a_straight_line():
    """A value of the noise's size after the 1/e level, and another one above it behind."""
    assert decay(np.array([1.0, 0.9, 0.6, 0.01, 0.3])) == pytest.approx(2.0 + (0.6 - np.exp(-1.0)) / 0.59)


def test_lags_reach_a_third_of_each_side():
    found = spatial_correlation(np.random.default_rng(3).standard_normal((20, 31)))
    assert (len(found.y), len(found.x)) == (7, 11)
    assert len(spatial_correlation(np.random.default_rng(3).standard_normal((5, 2))).x) == 2
    assert len(spatial_correlation(np.random.default_rng(3).standard_normal((5, 4)), longest=9).x) == 4


def test_what_a_surface_leaves_of_a_constant_has_no_correlation():
    level = np.full((40, 40), 1234.567)
    assert np.isnan(spatial_correlation(level, mean=trend_surface(level)).length_x)


def test_the_correction_for_the_mean_solves_its_own_equation():
    """Shift of the variance = (variance + shift) over the number of independent pixels, whose integral scales are of what results."""
    field = gaussian_filter(np.random.default_rng(10).standard_normal((2, 90, 120)), (0.0, 4.0, 6.0), mode="wrap")
    found = spatial_correlation(field)
    d = field - field.mean()
    variance = float((d * d).mean())
    lag = float((d[:, :, :-1] * d[:, :, 1:]).mean())
    independent = effective_count(field.size, found.scale_x, found.scale_y)
    shift = variance / (independent - 1.0)
    assert found.x[1] == pytest.approx((lag + shift) / (variance + shift), rel=1e-4)
    assert shift > 0.005 * variance
