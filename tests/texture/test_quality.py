"""Measures of likeness: two samples of one texture are alike, and each kind of difference is told."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from seaglint.base.errors import DataError
from seaglint.texture.gauss_markov import GaussMarkov
from seaglint.texture.gaussian_texture import GaussianTexture
from seaglint.texture.marginals import Marginal
from seaglint.texture.quality import compare, cooccurrence

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
