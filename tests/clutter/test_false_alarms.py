"""False alarms: reference counts on measured images, the Gaussian tail, intervals that hold for clusters, the curve."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter
from scipy.signal import lfilter
from scipy.stats import binom, norm

from seaglint.base.errors import DataError, DomainError
from seaglint.clutter import false_alarms
from seaglint.clutter.cluster_variance import rate_variance, score_interval
from seaglint.clutter.false_alarms import SEGMENTS, FalseAlarms, RateCurve
from seaglint.clutter.filters import Laplacian
from seaglint.clutter.thresholds import frame_scale, gaussian_rate, standardise


def count(z: np.ndarray, *thresholds: float) -> FalseAlarms:
    alarms = FalseAlarms(thresholds or (3.0, 3.5))
    alarms.add(z)
    return alarms


@pytest.mark.parametrize(
    ("name", "rates", "ratios"),
    [
        ("Misc_66", ("0.0069", "0.0050"), (5.1, 21)),
        ("Misc_107", ("0.0072", "0.0035"), (5.4, 15)),
        ("Misc_26", ("0.0051", "0.0037"), (3.8, 16)),
    ],
)
def test_measured_images_give_the_known_rates(data_dir: Path, name: str, rates: tuple[str, str], ratios: tuple[float, float]) -> None:
    """The whole image filtered, rows from 0.45 of the height down, sigma of that crop: known to the last digit."""
    from matplotlib.image import imread

    image = (imread(data_dir / "imagery" / f"{name}.png")[..., :3] * 255).round().mean(-1)
    mask = np.arange(image.shape[0])[:, None] >= int(0.45 * image.shape[0])
    found = count(standardise(Laplacian().apply(image), np.broadcast_to(mask, image.shape))).rates()
    assert tuple(f"{r.rate:.4f}" for r in found) == rates
    # Two digits are known.
    assert [r.ratio for r in found] == pytest.approx(ratios, rel=0.03)


@pytest.mark.parametrize("scope", ["frame", "local"])
def test_white_gaussian_gives_back_the_tail(scope) -> None:
    """2e6 pixels; within the 99.9 % interval at both thresholds, and with the inflation of independent pixels."""
    x = np.random.default_rng(21).standard_normal((32, 256, 256)).astype(np.float32)
    # A pixel is in its own window: with 63 x 63 pixels that shortens 3.5 sigma by 0.1 %.
    for r in count(standardise(x, scope=scope, window=63)).rates(level=0.999):
        assert r.rate_low < gaussian_rate(r.threshold_sigma) < r.rate_high
        assert r.inflation == pytest.approx(1.0, abs=0.4)
        assert r.correlation_time is None


def test_filtered_gaussian_gives_back_the_tail() -> None:
    x = np.random.default_rng(22).standard_normal((32, 256, 256)).astype(np.float32)
    for r in count(standardise(Laplacian().apply(x))).rates(level=0.999):
        assert r.rate_low < gaussian_rate(r.threshold_sigma) < r.rate_high


def test_tail_is_known() -> None:
    assert gaussian_rate([3.0, 3.5]) == pytest.approx([1.349898e-3, 2.326291e-4], rel=1e-6)


def test_standardised_has_mean_0_and_sigma_1_in_the_region_and_nothing_outside() -> None:
    x = 300 + 5 * np.random.default_rng(3).standard_normal((2, 30, 40)).astype(np.float32)
    mask = np.zeros((30, 40), bool)
    mask[5:20, 8:30] = True
    x[0, 6, 9] = np.nan
    z = standardise(x, mask)
    assert np.isnan(z[:, ~mask]).all()
    assert np.isnan(z[0, 6, 9])
    mean, std = frame_scale(z, mask)
    assert mean == pytest.approx(0, abs=1e-5)
    assert std == pytest.approx(1, abs=1e-6)
    whole = standardise(x, mask, scope="sequence", scale=(300.0, 5.0))
    assert whole[1, 10, 10] == pytest.approx((x[1, 10, 10] - 300) / 5, rel=1e-5)


def test_local_sigma_follows_the_image() -> None:
    gain = np.where(np.arange(200) < 100, 1.0, 10.0)
    x = (gain * np.random.default_rng(4).standard_normal((1, 200, 200))).astype(np.float32)
    z = standardise(x, scope="local", window=21)
    assert [z[..., :85].std(), z[..., 115:].std()] == pytest.approx([1, 1], rel=0.03)


@pytest.mark.parametrize("scope", ["frame", "local"])
def test_constant_image_has_no_rate(scope) -> None:
    alarms = count(standardise(Laplacian().apply(np.full((3, 40, 40), 291.3)), scope=scope))
    assert alarms.empty_frames == 3
    assert all(np.isnan(r.rate) and r.rate_low is None and r.note for r in alarms.rates())
    assert alarms.curve().threshold.size == 0


def test_result_does_not_depend_on_blocks() -> None:
    z = np.random.default_rng(8).standard_normal((SEGMENTS + 44, 20, 24)).astype(np.float32)
    z[7] = np.nan
    whole, parts = count(z, 2.0), FalseAlarms((2.0,))
    for block in np.array_split(z, [1, 2, 50, 257]):
        parts.add(block)
    assert parts.rates() == whole.rates()
    assert np.array_equal(parts.histogram, whole.histogram)
    assert np.array_equal(parts.events(2.0).size, whole.events(2.0).size)
    r = whole.rates()[0]
    assert (r.exceedances, r.pixels) == (int((z > 2).sum()), int(np.isfinite(z).sum()))
    assert whole.empty_frames == 1


def test_curve_is_the_survival_function() -> None:
    z = np.random.default_rng(9).standard_exponential((4, 100, 100)).astype(np.float32)
    curve = count(z, 3.0).curve()
    for m in (0.0, 1.0, 3.0):
        k = int(np.argmin(np.abs(curve.threshold - m)))
        assert curve.exceedances[k] == (z >= m).sum()
    assert curve.threshold[-1] > z.max()
    assert curve.exceedances[-1] == 0
    assert curve.threshold_for(np.exp(-3)) == pytest.approx(3.0, abs=0.15)  # 2000 exceedances, 5 sigma
    assert curve.threshold_for(1e-9) is None


def test_interval_of_few_exceedances_says_what_it_rests_on() -> None:
    z = np.zeros((1, 64, 64), np.float32)
    z[0, 5, 5] = 4.0
    low, high = count(z, 3.0, 5.0).rates()
    assert "fewer than 10" in str(low.note)
    assert low.rate_low < 1 / 4096 < low.rate_high
    assert high.rate_low == 0.0
    assert 1 / 4096 < high.rate_high < 6 / 4096  # rule of three and its relatives: 3 to 4 in n


@pytest.mark.parametrize("rate", [0.001, 0.01, 0.1])
def test_score_interval_covers_independent_counts(rate: float) -> None:
    """Exact coverage by summing the binomial distribution, n = 5000."""
    k = np.arange(0, 1000)
    ends = np.array([score_interval(int(i), 5000, 1.0, np.inf, 0.95) for i in k])
    covered = binom.pmf(k, 5000, rate)[(ends[:, 0] <= rate) & (rate <= ends[:, 1])].sum()
    assert covered == pytest.approx(0.95, abs=0.02)


def test_inflation_is_the_size_of_the_clusters() -> None:
    """Squares of 3 x 3 exceed together: nine pixels count as one."""
    seeds = np.random.default_rng(10).random((60, 96, 96)) < 0.01
    z = np.where(np.kron(seeds, np.ones((1, 3, 3))) > 0, 5.0, 0.0)
    assert count(z, 3.0).rates()[0].inflation == pytest.approx(9 * 0.99 / (1 - 0.01), rel=0.25)


def test_rate_that_varies_over_the_image_is_not_uncertainty() -> None:
    """A corridor: half the image has all exceedances, each frame anew."""
    rate = np.where(np.arange(128) < 64, 0.02, 0.0)
    z = np.where(np.random.default_rng(12).random((200, 128, 128)) < rate, 5.0, 0.0)
    assert count(z, 3.0).rates()[0].inflation == pytest.approx(1.0, abs=0.5)


def test_one_everlasting_pattern_has_no_interval() -> None:
    counts = np.zeros((50, 8, 8), np.int64)
    counts[:, :4] = 9
    found = rate_variance(counts, np.full_like(counts, 64))
    assert found.variance is None
    assert "correlated" in str(found.note)


def correlated_field(generator: np.random.Generator, frames: int, side: int, time: float, length: float) -> np.ndarray:
    """Gaussian field of unit variance, exponential in time (1/e after ``time`` frames), a Gaussian blur of ``length`` pixels in space."""
    x = generator.standard_normal((frames, side, side))
    if time:
        a = np.exp(-1 / time)
        x[0] /= np.sqrt(1 - a * a)
        x = lfilter([np.sqrt(1 - a * a)], [1, -a], x, axis=0)
    return gaussian_filter(x, (0, length, length), mode="wrap") * 2 * length * np.sqrt(np.pi) if length else x


def test_a_slow_scene_of_uneven_brightness_has_an_interval_that_holds() -> None:
    """Forty frames of a field that remembers nine, brighter downwards and in the middle: few times, many places."""
    generator = np.random.default_rng(8)
    y, x = np.linspace(0.0, 1.0, 96)[:, None], np.linspace(-1.0, 1.0, 96)[None]
    amplitude = (0.6 + 0.6 * y) * (0.7 + 0.7 * np.exp(-((x / 0.3) ** 2)))
    truth, held = norm.sf(2.2 / amplitude).mean(), 0
    for _ in range(10):
        rate = count((correlated_field(generator, 40, 96, 9.0, 1.5) * amplitude).astype(np.float32), 2.2).rates()[0]
        assert rate.rate_low is not None, rate.note
        held += rate.rate_low <= truth <= rate.rate_high
    assert held >= 8  # fewer by chance in 1 of 100 where 95 % of the intervals hold


@pytest.mark.validation
@pytest.mark.parametrize(("frames", "side", "time", "length"), [(1, 256, 0, 1.5), (1, 128, 0, 0), (60, 64, 4, 1.5), (256, 32, 6, 1.5)])
def test_intervals_cover_the_truth(frames: int, side: int, time: float, length: float) -> None:
    """400 simulations of a correlated field: 95 % intervals hold the true rate in 368 to 392, those of 90 % would in 360.

    Thresholds at which a gamma field of shape 0.7, made of the Gaussian one point by point, stands 3 and 3.5 sigma above its mean.
    """
    generator = np.random.default_rng(5)
    thresholds = (1.846, 2.031)
    covered = np.zeros(2)
    for _ in range(400):
        rates = count(correlated_field(generator, frames, side, time, length), *thresholds).rates()
        covered += [r.rate_low is not None and r.rate_low <= norm.sf(r.threshold_sigma) <= r.rate_high for r in rates]
    assert ((covered >= 368) & (covered <= 392)).all(), covered


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda: FalseAlarms(()), "above 0"),
        (lambda: FalseAlarms((-1.0,)), "above 0"),
        (lambda: count(np.ones((1, 4, 4))).rates(level=95), "0.95"),
        (lambda: count(np.ones((1, 4, 4))).joint(4.0), "3, 3.5"),
        (lambda: standardise(np.ones((1, 4, 4)), np.ones((3, 4), bool)), "does not fit"),
        (lambda: standardise(np.ones((1, 4, 4)), scope="sequence"), "whole sequence"),
        (lambda: standardise(np.ones((1, 4, 4)), scope="local", window=4), "odd"),
    ],
)
def test_unusable_input_is_said(make, says: str) -> None:
    with pytest.raises((DataError, DomainError), match=says):
        make()


def test_frames_of_another_size_are_refused() -> None:
    alarms = count(np.zeros((1, 5, 5)))
    with pytest.raises(DataError, match="one size"):
        alarms.add(np.zeros((1, 5, 6)))


def test_local_deviations_are_those_of_each_pixels_square() -> None:
    """Mean and deviation of the valid pixels of the square written out, with missing pixels, a mask and the picture's corner."""
    x = np.random.default_rng(31).standard_normal((2, 40, 50)).astype(np.float32)
    x[0, 20:24, 10:30] = np.nan
    mask = np.ones((40, 50), bool)
    mask[:, 40:] = False
    z = standardise(x, mask, scope="local", window=9)
    assert np.isnan(z[:, ~mask]).all()
    for row, column in ((0, 0), (19, 20), (25, 38), (39, 17)):
        square = np.where(mask, x[0], np.nan)[max(row - 4, 0) : row + 5, max(column - 4, 0) : column + 5].astype(float)
        expected = (x[0, row, column] - np.nanmean(square)) / np.nanstd(square)
        assert z[0, row, column] == pytest.approx(expected, abs=1e-4)


def test_local_deviations_need_16_pixels() -> None:
    x = np.full((1, 60, 30), np.nan, np.float32)
    values = np.random.default_rng(32).standard_normal(16)
    x[0, 10:14, 10:14] = values.reshape(4, 4)
    x[0, 40:44, 10:14] = values.reshape(4, 4)
    x[0, 40, 10] = np.nan
    z = standardise(x, scope="local", window=11)
    assert np.isfinite(z[0, 10:14, 10:14]).all()
    assert np.isnan(z[0, 30:]).all()


def test_local_deviations_of_a_bright_frame_keep_their_digits() -> None:
    """Steps of one on a level of 4 million, all that single precision holds."""
    x = np.random.default_rng(33).integers(-3, 4, (1, 50, 50)).astype(np.float32)
    level = np.float32(2.0**22)
    assert standardise(x + level, scope="local", window=11) == pytest.approx(standardise(x, scope="local", window=11), abs=1e-4)


def test_the_density_of_a_rate_curve_is_its_slope() -> None:
    threshold = np.linspace(0.0, 4.0, 401)
    numbers = np.rint(1e9 * norm.sf(threshold)).astype(np.int64)
    assert RateCurve(threshold, numbers, 10**9).density(2.0) == pytest.approx(norm.pdf(2.0), rel=0.01)
    line = np.rint(1000.0 * (4.0 - threshold)).astype(np.int64)
    assert RateCurve(threshold, line, 4000).density(1.234) == pytest.approx(0.25, rel=1e-9)
    assert RateCurve(threshold, line, 4000).density(0.0) == pytest.approx(0.125, rel=1e-9)  # nothing is counted below the first
    assert RateCurve(threshold[:1], line[:1], 4000).density(0.0) == 0.0


def test_a_rate_at_the_measured_deviation_is_more_certain() -> None:
    """Bright events raise the deviation too: of gamma values the count scatters less than the deviation's own error lets one expect."""
    counts, widths = [], []
    for seed in range(40):
        x = np.random.default_rng(seed).gamma(2.0, 1.0, (1, 80, 100))
        z = ((x - x.mean()) / x.std()).astype(np.float32)
        found = []
        for estimated in (False, True):
            alarms = FalseAlarms((3.0,), estimated=estimated)
            alarms.add(z)
            found.append(alarms.rates()[0])
        counts.append(found[0].exceedances)
        widths.append([one.inflation for one in found])
    scatter = np.var(counts) / np.mean(counts)
    known, estimated = np.mean(widths, axis=0)
    assert scatter < 0.85
    assert abs(estimated - scatter) < abs(known - scatter)
    assert estimated == pytest.approx(scatter, rel=0.35)


def test_a_slow_scale_is_counted_beyond_the_correlation_of_the_pixels(monkeypatch: pytest.MonkeyPatch) -> None:
    """White pixels times exp(0.3 g), g of length 20 px: what the measured deviation leaves of the patches adds up over longer lags."""
    counts: list[int] = []
    own, short = [], []
    for seed in range(120):
        generator = np.random.default_rng([7, seed])
        g = gaussian_filter(generator.standard_normal((120, 160)), 10.0, mode="wrap") * 20.0 * np.sqrt(np.pi)
        x = generator.standard_normal((120, 160)) * np.exp(0.3 * g)
        z = ((x - x.mean()) / x.std()).astype(np.float32)[None]
        for reach, found in ((None, own), (1.0, short)):
            with monkeypatch.context() as patch:
                if reach is not None:
                    patch.setattr(false_alarms, "ESTIMATED_REACH", reach)
                alarms = FalseAlarms((3.0,), estimated=True)
                alarms.add(z)
                rate = alarms.rates()[0]
            found.append(rate.inflation)
        counts.append(rate.exceedances)
    scatter = np.var(counts, ddof=1) / np.mean(counts)
    assert np.mean(own) > 1.2 * np.mean(short)
    assert abs(np.mean(own) - scatter) < 0.75 * abs(np.mean(short) - scatter)
