"""Prediction of pixels from their neighbours: known truths, whole-numbered data, values outside the law, and sums of a few pixels."""

from __future__ import annotations

import math

import numpy as np
import pytest

from seaglint.textures.gauss_markov import GaussMarkov, covariance
from seaglint.textures.gaussian_texture import GaussianTexture
from seaglint.textures.marginals import Marginal, fit_marginal
from seaglint.textures.prediction import data_step, predict


def unit_field() -> GaussMarkov:
    """A field of variance 1 on the torus of the samples."""
    offsets, weights = ((0, 0, 1), (0, 1, 0)), (0.24, 0.22)
    variance = float(covariance(GaussMarkov(offsets, weights, 1.0), (1, 256, 256))[0, 0, 0])
    return GaussMarkov(offsets, weights, 1.0 / variance)


FIELD = unit_field()
GAMMA = Marginal("gamma", 1.0, 0.5, 1.5)


def sample(marginal: Marginal, seed: int = 3) -> np.ndarray:
    return GaussianTexture(FIELD, marginal).sample((1, 256, 256), seed).astype(float)


@pytest.mark.parametrize("marginal", [Marginal("gaussian", 10.0, 2.0), GAMMA, Marginal("lognormal", 1.0, -0.5, 0.4)])
def test_the_number_is_the_conditional_entropy(marginal: Marginal) -> None:
    """Of 65 536 pixels the mean of ``residual² / 2 v`` scatters by 0.5 sqrt(2 / 65536) times 1.5 for neighbours that share pixels."""
    found = predict(GaussianTexture(FIELD, marginal), sample(marginal))
    entropy = 0.5 * math.log(2.0 * math.pi * math.e * FIELD.variance)
    g = np.random.default_rng(1).standard_normal(400_000)
    assert found.log_pseudo_likelihood == pytest.approx(-entropy - marginal.log_slope(g).mean(), abs=0.02)
    assert found.gain == pytest.approx(-0.5 * math.log(FIELD.variance), abs=4.0 * 1.5 * 0.5 * math.sqrt(2.0 / 65536.0))
    assert (found.outside, found.step, found.reason) == (0.0, None, None)


@pytest.mark.parametrize("kind", ["gaussian", "gamma", "empirical"])
def test_whole_numbers_have_the_probability_of_their_step(kind) -> None:
    """Rounded to a tenth of a standard deviation the information is that of the field; it never exceeds it, and falls with the step."""
    x = sample(GAMMA)
    std = math.sqrt(GAMMA.variance)
    gains = []
    for share in (0.1, 0.4, 1.0):
        rounded = np.round(x / (share * std)) * share * std
        marginal = GAMMA if kind == "gamma" else fit_marginal(rounded, kind)
        found = predict(GaussianTexture(FIELD, marginal), rounded)
        assert found.step == pytest.approx(share * std)
        assert found.log_pseudo_likelihood < -math.log(share * std)  # a probability of at most 1
        gains.append(found.gain)
    if kind != "gaussian":
        assert gains[0] == pytest.approx(-0.5 * math.log(FIELD.variance), abs=0.02)
    assert gains[0] > gains[1] > gains[2] > 0.0


@pytest.mark.parametrize("kind", ["gaussian", "empirical"])
@pytest.mark.parametrize("scale", [0.5, 40.0])
def test_fine_steps_have_the_density_of_the_field(kind, scale) -> None:
    """Steps of a tenth of the deviation s: log density -1/2 log(2 pi e v s²) of a field with the conditional variance v s²."""
    x = np.round(10.0 * sample(Marginal())) * 0.1 * scale
    marginal = Marginal("gaussian", 0.0, scale) if kind == "gaussian" else fit_marginal(x, kind)
    expected = -0.5 * math.log(2.0 * math.pi * math.e * FIELD.variance * scale**2)
    assert predict(GaussianTexture(FIELD, marginal), x).log_pseudo_likelihood == pytest.approx(expected, abs=0.03)


def test_eight_bits_have_no_infinite_density() -> None:
    """Quantiles of whole numbers are steps: slopes between them are 0, and a density would be nonsense of some hundred nat."""
    x = np.round(40.0 + 5.0 * sample(Marginal()))
    texture = GaussianTexture(FIELD, fit_marginal(x, "empirical"))
    found = predict(texture, x)
    gaussian = predict(GaussianTexture(FIELD, Marginal("gaussian", 40.0, 5.0)), x)
    assert found.log_pseudo_likelihood == pytest.approx(gaussian.log_pseudo_likelihood, abs=0.01)


def test_values_that_the_law_excludes() -> None:
    x = sample(GAMMA)
    few, many = x.copy(), x.copy()
    few[0, ::16, ::16] = 0.5  # below the smallest value, 1
    many[0, ::4, ::4] = 0.5
    found = predict(GaussianTexture(FIELD, GAMMA), few)
    assert found.outside == pytest.approx(1.0 / 256.0)
    assert found.gain == pytest.approx(-0.5 * math.log(FIELD.variance), abs=0.02)
    found = predict(GaussianTexture(FIELD, GAMMA), many)
    assert found.outside == pytest.approx(1.0 / 16.0)
    assert found.log_pseudo_likelihood is None
    assert found.gain is None
    assert "6.25 % of the pixels have values that the fitted gamma distribution excludes" in found.reason


def test_a_few_pixels_carry_no_sum() -> None:
    x = sample(Marginal())
    x[0, 100, 100] = 400.0  # 1.2 nat of the mean
    found = predict(GaussianTexture(FIELD, Marginal()), x)
    assert found.log_pseudo_likelihood is None
    assert "carry the sum" in found.reason


def test_gaps_are_left_out() -> None:
    x = sample(GAMMA)
    gaps = x.copy()
    gaps[0, 40] = np.nan
    gaps[0, :, 7] = np.nan
    texture = GaussianTexture(FIELD, GAMMA)
    assert predict(texture, gaps).gain == pytest.approx(predict(texture, x).gain, abs=0.01)
    gaps[0, ::2] = np.nan
    assert predict(texture, gaps).reason == "no pixel has a value with all its neighbours"


@pytest.mark.parametrize(
    ("values", "step"),
    [
        (np.round(np.random.default_rng(1).normal(50.0, 6.0, 4000)), 1.0),
        (np.float32(np.round(np.random.default_rng(1).normal(150.0, 18.0, 4000)) / 3.0), 1.0 / 3.0),  # mean of three channels
        (np.random.default_rng(1).normal(50.0, 6.0, 4000), None),
        (np.round(np.random.default_rng(1).normal(5e4, 6e4, 4000)), None),  # a step that no statistic notices
        (np.full(100, 3.0), None),
    ],
)
def test_steps_of_data(values: np.ndarray, step: float | None) -> None:
    assert data_step(values) == (None if step is None else pytest.approx(step, rel=1e-3))
