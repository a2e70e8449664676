"""Gauss-Markov fields against dense matrices, and their parameters back from samples."""

from __future__ import annotations

import math

import numpy as np
import pytest

from seaglint.base.errors import DataError, DomainError
from seaglint.texture.gauss_markov import (
    GaussMarkov,
    covariance,
    least_symbol,
    log_likelihood,
    pseudo_log_likelihood,
    spectral_density,
)
from seaglint.texture.gauss_markov_fit import candidates, choose, covariances, fit
from seaglint.texture.synthesis import latent

SPACE_TIME = GaussMarkov(((0, 0, 1), (0, 1, 0), (1, 0, 1), (1, 0, 0)), (0.12, 0.1, 0.15, 0.05), 1.3, 2.0)
PLANE = GaussMarkov(((0, 0, 1), (0, 1, 0), (0, 1, 1)), (0.2, 0.12, 0.07), 0.7)


def precision(model: GaussMarkov, shape: tuple[int, int, int]) -> np.ndarray:
    """Dense precision matrix of the torus, pixel by pixel."""
    number = np.arange(math.prod(shape)).reshape(shape)
    out = np.eye(number.size)
    for d, b in zip(model.offsets, model.coefficients, strict=True):
        for sign in (1, -1):
            other = np.roll(number, tuple(-sign * step for step in d), axis=(0, 1, 2))
            np.add.at(out, (number.ravel(), other.ravel()), -b)
    return out / model.variance


def draw(model: GaussMarkov, shape: tuple[int, int, int], seed: int) -> np.ndarray:
    """Sample with the model's own variance and mean."""
    return model.mean + math.sqrt(covariance(model, shape)[0, 0, 0]) * latent(model, shape, seed).astype(float)


def test_likelihood_is_that_of_the_dense_matrix() -> None:
    shape = (4, 8, 8)
    q = precision(SPACE_TIME, shape)
    x = np.random.default_rng(5).normal(2.0, 1.5, shape)
    e = x.ravel() - 2.0
    dense = 0.5 * (np.linalg.slogdet(q)[1] - e.size * math.log(2.0 * math.pi) - e @ q @ e)
    assert log_likelihood(SPACE_TIME, x) == pytest.approx(dense, abs=1e-10, rel=1e-13)


def test_likelihood_of_a_fit_is_that_of_its_model() -> None:
    x = draw(PLANE, (1, 48, 40), 3)
    for among in (PLANE.offsets, PLANE.offsets[:1]):
        fitted = fit(x, among, periodic=True)
        assert fitted.log_likelihood == pytest.approx(log_likelihood(fitted.model, x), rel=1e-9)
        assert fitted.bic == pytest.approx(-2.0 * fitted.log_likelihood + (len(among) + 2) * math.log(x.size))


def test_covariance_is_the_inverse_of_the_dense_matrix() -> None:
    shape = (5, 6, 7)
    dense = np.linalg.inv(precision(SPACE_TIME, shape))
    assert covariance(SPACE_TIME, shape).ravel() == pytest.approx(dense[0], abs=1e-12)


def test_pseudo_likelihood_is_that_of_the_conditional_density() -> None:
    model = GaussMarkov(((0, 0, 1),), (0.3,), 2.0, 1.0)
    x = np.random.default_rng(1).normal(size=(1, 3, 5))
    residual = x[:, :, 1:-1] - 1.0 - 0.3 * (x[:, :, 2:] + x[:, :, :-2] - 2.0)
    assert pseudo_log_likelihood(model, x) == pytest.approx(np.mean(-0.5 * np.log(4.0 * np.pi) - residual**2 / 4.0))


def test_all_random_starts_reach_one_optimum() -> None:
    data = draw(PLANE, (1, 64, 64), 3)
    rng = np.random.default_rng(0)
    found = [fit(data, PLANE.offsets, periodic=True, start=rng.uniform(-0.16, 0.16, 3)).model.coefficients for _ in range(10)]
    assert np.ptp(found, axis=0) == pytest.approx(0.0, abs=1e-7)


@pytest.mark.validation
def test_known_parameters_come_back_with_the_stated_coverage() -> None:
    """128 x 128 pixels, 100 seeds, three weights and the variance: 95 % intervals cover 90 to 99 %, 3 standard errors all but 2 %."""
    z = []
    for seed in range(100):
        found = fit(draw(PLANE, (1, 128, 128), seed), PLANE.offsets, periodic=True)
        errors = [*found.standard_errors, found.variance_error]
        truth = [*PLANE.coefficients, PLANE.variance]
        z.append((np.array([*found.model.coefficients, found.model.variance]) - truth) / errors)
    inside = (np.abs(z) < 1.96).mean(axis=0)
    assert ((inside >= 0.90) & (inside <= 0.99)).all(), inside
    assert (np.abs(z) < 3.0).mean() > 0.98


def test_cut_pieces_give_the_parameters_of_the_whole() -> None:
    """A picture is no torus: edge-corrected covariances, 96 x 96 of 256 x 256 pixels, mean of 12 cuts within 3 of its standard errors."""
    field = draw(PLANE, (1, 256, 256), 8)
    cuts = [field[:, i : i + 96, j : j + 96] for i in (0, 80, 160) for j in (0, 50, 100, 160)]
    fits = [fit(cut, PLANE.offsets) for cut in cuts]
    mean = np.mean([f.model.coefficients for f in fits], axis=0)
    # Overlapping cuts are worth some 7 independent ones.
    assert np.abs(mean - PLANE.coefficients) == pytest.approx(0.0, abs=3.0 * max(fits[0].standard_errors) / math.sqrt(7))


def test_the_neighbourhood_is_found_and_texture_travels() -> None:
    model = GaussMarkov(((0, 0, 1), (1, 0, 1), (0, 1, 0)), (0.1, 0.2, 0.1), 1.0)
    data = draw(model, (16, 96, 96), 2)[:12, :64, :64]
    found = choose(covariances(data, (2, 2, 2)), candidates((2, 2, 2)))
    assert set(found.model.offsets) == set(model.offsets)
    lags = covariance(found.model, (16, 64, 64))
    assert lags[1, 0, 1] > 2.0 * lags[1, 0, -1]


def test_fitted_fields_exist_on_every_torus() -> None:
    smooth = np.cumsum(np.cumsum(np.random.default_rng(4).normal(size=(64, 64)), axis=0), axis=1)[16:, 16:]
    found = choose(covariances(smooth, (0, 3, 3)), candidates((0, 3, 3)))
    assert least_symbol(found.model, (1, 48, 48)) >= 0.99e-5
    assert all(spectral_density(found.model, (1, n, n)).min() > 0.0 for n in (31, 64, 97))


@pytest.mark.parametrize(
    ("data", "told"),
    [
        (np.ones((40, 40)), "all values are equal"),
        (np.full((40, 40), np.nan), "missing or infinite"),
        (np.random.default_rng(1).normal(size=(9, 9)), "81 pixels are too few for 2 neighbour pairs"),
    ],
)
def test_data_that_tell_nothing_are_refused(data: np.ndarray, told: str) -> None:
    with pytest.raises(DataError, match=told):
        fit(data, [(0, 1), (1, 0)])


def test_fields_that_do_not_exist_are_refused() -> None:
    with pytest.raises(DomainError, match="give at least 1 x 5 x 1"):
        spectral_density(GaussMarkov(((0, 2, 0),), (0.1,), 1.0), (1, 4, 8))
    with pytest.raises(DomainError, match="sum to less than 1/2"):
        spectral_density(GaussMarkov(((0, 0, 1),), (0.5,), 1.0), (1, 1, 8))
    with pytest.raises(DomainError, match="twice"):
        GaussMarkov(((0, 1, 1), (0, -1, -1)), (0.1, 0.1), 1.0)
