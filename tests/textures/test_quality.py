"""Measures of likeness: two samples of one texture are alike, and each kind of difference is told."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from seaglint.base.errors import DataError
from seaglint.textures.gauss_markov import GaussMarkov
from seaglint.textures.gaussian_texture import GaussianTexture
from seaglint.textures.marginals import Marginal
from seaglint.textures.quality import Comparison, compare, cooccurrence

FIELD = GaussMarkov(((1, 0, 0), (0, 0, 1), (0, 1, 0)), (0.2, 0.1, 0.1), 1.0)
FIELD_OF_NOISE = GaussMarkov((), (), 1.0)
SHAPE = (12, 96, 96)


def frames(seed: int, field: GaussMarkov = FIELD, tails: Marginal | None = None) -> np.ndarray:
    return GaussianTexture(field, tails or Marginal("gamma", 1.0, 1.0, 2.0)).sample(SHAPE, seed)


def test_two_samples_of_one_texture_are_alike() -> None:
    assert compare(frames(1), frames(2)).as_dict()["fails"] == []


@pytest.mark.parametrize(
    ("other", "told"),
    [
        (frames(2, tails=Marginal("gaussian", 3.0, 1.4)), "filtered picture exceeds 3.5 sigma"),
        (frames(2, tails=Marginal("gamma", 3.0, 1.0, 2.0)), "distribution functions"),
        (frames(2, GaussMarkov(((0, 0, 1), (0, 1, 0)), (0.24, 0.24), 1.0)), "correlations in space"),
        (frames(2, GaussMarkov(((1, 0, 0), (0, 0, 1), (0, 1, 0)), (0.45, 0.01, 0.01), 1.0)), "correlations in time"),
    ],
    ids=["tails", "values", "space", "time"],
)
def test_each_difference_is_told(other: np.ndarray, told: str) -> None:
    assert any(told in sentence for sentence in compare(frames(1), other).as_dict()["fails"])


def test_rates_are_those_of_the_filtered_picture() -> None:
    """White gamma noise: Laplacian by hand, share of the inner pixels above 3 of its deviations."""
    noise = np.random.default_rng(2).gamma(1.0, 1.0, (1, 64, 64)).astype(np.float32)
    x = noise[0].astype(float)
    z = 4.0 * x[1:-1, 1:-1] - x[2:, 1:-1] - x[:-2, 1:-1] - x[1:-1, 2:] - x[1:-1, :-2]
    share = float((z > z.mean() + 3.0 * z.std()).mean())
    found = compare(noise, noise).as_dict()["filtered_rates"][0]
    assert found["first"] == found["second"] == pytest.approx(share)
    assert found["second_over_first"] == 1.0


def test_cooccurrence_of_stripes() -> None:
    stripes = np.tile([[0.0, 1.0]], (32, 16))[None]
    found = cooccurrence(stripes, (0.0, 1.0), 2)
    # Rows below are alike; right and diagonal neighbours differ.
    assert found["contrast"] == pytest.approx(3.0 / 4.0)
    assert found["homogeneity"] == pytest.approx((1.0 + 3.0 * 0.5) / 4.0)
    assert found["energy"] == pytest.approx(0.5, abs=1e-3)
    assert found["correlation"] == pytest.approx(-0.5, abs=1e-3)


def test_pictures_that_cannot_be_compared() -> None:
    with pytest.raises(DataError, match="24 x 24"):
        compare(np.ones((1, 8, 8)), frames(1))
    with pytest.raises(DataError, match="missing"):
        compare(frames(1), np.full(SHAPE, np.nan))


def test_two_small_pictures_of_white_noise_are_alike() -> None:
    """A single square of 64 px would differ from another by 8 dB rms, and correlations of 0.01 and 0.002 by their whole size."""
    one, other = (np.random.default_rng(seed).gamma(2.0, 1.0, (1, 64, 64)).astype(np.float32) for seed in (1, 2))
    found = compare(one, other).as_dict()
    assert found["spectrum_distance_db"] < 3.0
    assert not any("co-occurring" in sentence for sentence in found["fails"])


def test_spectra_of_another_slope_are_told() -> None:
    smooth = GaussMarkov(((0, 0, 1), (0, 1, 0)), (0.24, 0.24), 1.0)
    one, other = (GaussianTexture(field, Marginal()).sample((1, 64, 64), 1) for field in (FIELD_OF_NOISE, smooth))
    assert any("spectra differ" in sentence for sentence in compare(one, other).as_dict()["fails"])


def test_cooccurrence_pair_by_pair() -> None:
    """Features from the levels of every pair, both ways, without a matrix."""
    picture = frames(3)[:2, :40, :30].astype(float)
    low, high = np.quantile(picture, [0.001, 0.999])
    grey = np.minimum(np.maximum(np.floor((picture - low) / (high - low) * 16), 0), 15)
    expected = dict.fromkeys(("contrast", "homogeneity", "energy", "entropy", "correlation"), 0.0)
    for down, right in ((0, 1), (1, 0), (1, 1), (1, -1)):
        moved = np.roll(grey, (-down, -right), axis=(1, 2))
        inside = (slice(None), slice(0, 40 - down), slice(1, None) if right < 0 else slice(0, 30 - right))
        a, b = grey[inside].ravel(), moved[inside].ravel()
        first, second = np.concatenate([a, b]), np.concatenate([b, a])
        shares = np.unique(np.stack([first, second]), axis=1, return_counts=True)[1] / first.size
        expected["contrast"] += np.mean((a - b) ** 2) / 4.0
        expected["homogeneity"] += np.mean(1.0 / (1.0 + (a - b) ** 2)) / 4.0
        expected["energy"] += np.sum(shares**2) / 4.0
        expected["entropy"] -= np.sum(shares * np.log(shares)) / 4.0
        expected["correlation"] += np.corrcoef(first, second)[0, 1] / 4.0
    assert cooccurrence(picture, (low, high)) == pytest.approx(expected, rel=1e-9)


def test_values_are_compared_as_scipy_does() -> None:
    one, other = frames(4)[:1], 1.3 * frames(5)[:1] + 0.4
    found = compare(one, other).as_dict()["marginal"]
    a, b = one.ravel().astype(float), other.ravel().astype(float)
    assert found["ks"] == pytest.approx(stats.ks_2samp(a, b).statistic)
    assert found["wasserstein_std"] == pytest.approx(stats.wasserstein_distance(a, b) / a.std(), rel=0.01)
    for name, v in (("first", a), ("second", b)):
        told = [found[name][key] for key in ("mean", "std", "skewness", "excess_kurtosis")]
        assert told == pytest.approx([v.mean(), v.std(), stats.skew(v), stats.kurtosis(v)], rel=1e-4)


def test_units_do_not_count_where_likeness_is_in_standard_deviations() -> None:
    one = frames(6)
    found = compare(one, 3.0 * one + 7.0).as_dict()
    assert found["spectrum_distance_db"] == pytest.approx(0.0, abs=1e-3)
    assert found["correlation_distance"] == pytest.approx(0.0, abs=1e-5)
    assert found["time_correlation_distance"] == pytest.approx(0.0, abs=1e-5)
    assert [entry["second_over_first"] for entry in found["filtered_rates"]] == pytest.approx([1.0, 1.0], rel=0.01)


def test_a_spectrum_of_known_gain_is_that_many_decibels_away() -> None:
    """White noise and its sums over two neighbours: 10 log10 of 2 cos^2(k/2) in standard deviations, rms over frequencies."""
    noise = np.random.default_rng(7).normal(size=(12, 192, 193))
    k = 2.0 * np.pi * np.fft.fftfreq(64)
    ratio = np.maximum(np.cos(0.5 * k) ** 2 * 2.0, 1e-3)
    expected = np.sqrt(np.mean((10.0 * np.log10(ratio)) ** 2))
    found = compare(noise[..., 1:], noise[..., 1:] + noise[..., :-1]).as_dict()
    # Windows of the periodogram fill the zero at the highest frequency.
    assert found["spectrum_distance_db"] == pytest.approx(expected, rel=0.15)
    assert found["correlation_distance"] == pytest.approx(0.5 / np.sqrt(2.0 * 13.0), abs=0.01)  # 1/2 at one of 13 distances of one axis


with np.errstate(over="ignore"):  # where kernels run as plain Python unsigned products wrap aloud
    ONE = compare(frames(1), frames(1)).first


def near(**changes: object) -> Comparison:
    """A texture and itself with some measures changed."""
    return Comparison(ONE, replace(ONE, **changes))


def shifted(share: float) -> np.ndarray:
    """Values of which a share of the largest are the least one."""
    kept = ONE.values[: round((1.0 - share) * ONE.values.size)]
    return np.r_[np.full(ONE.values.size - kept.size, kept[0]), kept]


def with_rate(factor: float) -> tuple:
    return tuple(replace(rate, rate=factor * rate.rate, exceedances=round(factor * rate.exceedances)) for rate in ONE.rates)


@pytest.mark.parametrize(
    ("inside", "beyond", "sentence"),
    [
        (near(rates=with_rate(1.45)), near(rates=with_rate(3.0)), "filtered picture exceeds 3 sigma, 3.00 ("),
        (near(rates=with_rate(1.0 / 1.45)), near(rates=with_rate(0.25)), "filtered picture exceeds 3.5 sigma, 0.25 ("),
        (near(x=ONE.x + 0.139), near(x=ONE.x + 0.144), "correlations in space differ by 0.1 rms"),  # mean square of two axes
        (near(y=ONE.y - 0.139), near(y=ONE.y - 0.144), "correlations in space differ by 0.1 rms"),
        (near(time=ONE.time + 0.098), near(time=ONE.time + 0.103), "correlations in time differ by 0.1 rms"),
        (
            near(spectrum=replace(ONE.spectrum, density=10.0**0.29 * ONE.spectrum.density)),
            near(spectrum=replace(ONE.spectrum, density=10.0**0.31 * ONE.spectrum.density)),
            "spectra differ by 3.1 dB rms",
        ),
        (
            near(features=ONE.features | {"contrast": ONE.features["contrast"] / 0.76}),
            near(features=ONE.features | {"contrast": ONE.features["contrast"] / 0.74}),
            "co-occurring grey levels differ most in contrast",
        ),
        (
            near(features=ONE.features | {"correlation": ONE.features["correlation"] - 0.24}),
            near(features=ONE.features | {"correlation": ONE.features["correlation"] - 0.26}),
            "co-occurring grey levels differ most in correlation",
        ),
        (near(values=shifted(0.098)), near(values=shifted(0.103)), "distribution functions of the pixels differ by 0.1"),
    ],
    ids=["often", "seldom", "columns", "rows", "time", "spectrum", "contrast", "correlation", "values"],
)
def test_a_measure_fails_just_beyond_its_limit_alone(inside: Comparison, beyond: Comparison, sentence: str) -> None:
    assert inside.as_dict()["fails"] == []
    fails = beyond.as_dict()["fails"]
    assert any(sentence in one for one in fails)
    assert len({one.split(" sigma")[0][:20] for one in fails}) == 1


def test_pictures_without_times_or_exceedances_are_compared_in_the_rest() -> None:
    """Frames that do not follow each other have no distance in time, whichever of the two they are."""
    for pair in (near(time=None), Comparison(replace(ONE, time=None), ONE)):
        assert pair.as_dict()["time_correlation_distance"] is None
    none = tuple(replace(rate, exceedances=0, rate=0.0) for rate in ONE.rates)
    assert sum("never exceeds" in one for one in near(rates=none).as_dict()["fails"]) == 2
    assert sum("exceeds" in one for one in Comparison(replace(ONE, rates=none), ONE).as_dict()["fails"]) == 2


@pytest.mark.parametrize("factor", [0.5, 0.6, 1.0, 1.45, 1.6, 1.9, 4.0])
def test_verdicts_of_rates_follow_from_their_intervals(factor: float) -> None:
    found = near(rates=with_rate(factor)).distances
    for entry in found.filtered_rates:
        low, high = entry.ratio_interval
        assert low is not None
        assert high is not None
        assert low < factor < high
        expected = "holds" if low >= 1 / 1.5 and high <= 1.5 else "differs" if low > 1.5 or high < 1 / 1.5 else "undecided"
        assert entry.verdict == expected
    verdicts = [entry.verdict for entry in found.filtered_rates]
    assert len(found.undecided) == verdicts.count("undecided")
    assert sum("exceeds" in sentence for sentence in found.fails) == verdicts.count("differs")


def test_the_distance_of_correlations_leaves_out_what_is_missing() -> None:
    shorter = np.r_[ONE.x[:5] + 0.3, np.nan]
    found = near(x=shorter, y=ONE.y[:3] + 0.4).as_dict()["correlation_distance"]
    assert found == pytest.approx(np.sqrt((0.3**2 + 0.4**2) / 2.0))


@pytest.mark.parametrize(
    ("shape", "side"),
    [((1, 320, 320), 64), ((1, 319, 320), 32), ((6, 128, 128), 64), ((5, 128, 128), 32), ((40, 64, 128), 64), ((1, 100, 100), 16)],
)
def test_squares_of_spectra_are_the_largest_of_which_24_fit(shape: tuple[int, int, int], side: int) -> None:
    """In up to 12 frames; 16 px where no size has so many."""
    noise = np.random.default_rng(8).normal(size=shape).astype(np.float32)
    found = compare(noise, noise)
    assert len(found.first.spectrum.frequency) == side


def test_correlations_in_time_reach_half_of_the_shorter_sequence() -> None:
    noise = np.random.default_rng(9).normal(size=(80, 24, 24))
    lags = [compare(noise, noise[:count]).second.time for count in (7, 8, 20, 80)]
    assert [None if one is None else len(one) - 1 for one in lags] == [None, 4, 10, 25]
    assert compare(noise, noise, consecutive=False).first.time is None
