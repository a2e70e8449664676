"""Gauss-Markov fields against dense matrices, and their parameters back from samples."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

from seaglint.base.errors import DataError, DomainError
from seaglint.textures.gauss_markov import GaussMarkov, covariance, least_symbol, log_likelihood, pseudo_log_likelihood, spectral_density
from seaglint.textures.gauss_markov_fit import Covariances, _Likelihood, candidates, choose, covariances, fit
from seaglint.textures.synthesis import latent

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


@pytest.mark.parametrize("periodic", [True, False])
def test_covariances_are_means_over_pairs(periodic: bool) -> None:
    """Pair by pair: round a torus, or inside the picture alone."""
    x = np.random.default_rng(6).normal(3.0, 1.0, (5, 7, 6))
    found = covariances(x, (2, 3, 2), periodic=periodic)
    y = x - x.mean()
    for d in ((0, 0, 0), (1, 0, 0), (2, -3, 1), (0, 3, -2), (-2, 1, 2), (-1, -1, -1)):
        moved = np.roll(y, tuple(-step for step in d), axis=(0, 1, 2))
        here = tuple(slice(max(-step, 0), n - max(step, 0)) for step, n in zip(d, y.shape, strict=True))
        expected = (y * moved)[... if periodic else here].mean()
        assert found.at(d) == pytest.approx(expected, abs=1e-12)
    assert (found.reach, found.pixels, found.mean) == ((2, 3, 2), 210, pytest.approx(x.mean()))
    assert covariances(x, (0, 0, 0), mean=1.0).at((0, 0, 0)) == pytest.approx(((x - 1.0) ** 2).mean())


def test_a_fit_has_the_covariances_and_the_information_of_the_dense_matrix() -> None:
    """At the optimum covariances are the data's; errors are those of the Fisher information 1/2 tr(S Q_j S Q_k), by finite differences."""
    shape, offsets = (1, 14, 15), ((0, 0, 1), (0, 1, -1))
    fitted = fit(draw(GaussMarkov(offsets, (0.2, 0.1), 1.5), shape, 4), offsets, periodic=True)
    data = covariances(draw(GaussMarkov(offsets, (0.2, 0.1), 1.5), shape, 4), (0, 1, 1), periodic=True)
    model = covariance(fitted.model, shape)
    assert [model[d] for d in ((0, 0, 0), *offsets)] == pytest.approx([data.at(d) for d in ((0, 0, 0), *offsets)], rel=1e-7)

    def at(parameters: np.ndarray) -> np.ndarray:
        return precision(GaussMarkov(offsets, tuple(parameters[:2]), float(parameters[2])), shape)

    best = np.array([*fitted.model.coefficients, fitted.model.variance])
    inverse = np.linalg.inv(at(best))
    slopes = [inverse @ (at(best + step) - at(best - step)) / 2e-5 for step in 1e-5 * np.eye(3)]
    information = [[0.5 * np.sum(one * other.T) for one in slopes] for other in slopes]
    errors = np.sqrt(np.diag(np.linalg.inv(information)))
    assert [*fitted.standard_errors, fitted.variance_error] == pytest.approx(errors, rel=1e-6)


def test_the_information_of_an_added_pair_is_the_last_row() -> None:
    data = covariances(np.random.default_rng(7).normal(size=(6, 9, 8)), (1, 2, 2), periodic=True)
    likelihood = _Likelihood(data, PLANE.offsets)
    squared = np.fft.irfftn(likelihood.spectrum(np.array([1.3, 0.2, 0.1, -0.1])) ** -2.0, s=(6, 9, 8), axes=(0, 1, 2))
    for joining in ((1, 2, -2), (0, 1, -1)):
        row = likelihood.row(squared, PLANE.offsets, joining)
        assert row == pytest.approx(likelihood.information(squared, (*PLANE.offsets, joining))[-1], rel=1e-12)


@pytest.mark.parametrize("seed", range(4))
def test_the_chosen_neighbourhood_has_the_least_criterion_of_all(seed: int) -> None:
    """Every subset of four pairs fitted: couplings as weak as the criterion's penalty."""
    pool = candidates((0, 1, 1))
    data = covariances(draw(GaussMarkov(((0, 0, 1), (0, 1, 0)), (0.03, 0.06), 1.0), (1, 48, 52), seed), (0, 1, 1), periodic=True)
    every = [fit(data, some).bic for k in range(5) for some in itertools.combinations(pool, k)]
    found = choose(data, pool)
    assert found.bic == pytest.approx(min(every), rel=1e-9)


def test_the_pairs_that_may_join_are_half_of_a_box() -> None:
    found = candidates((1, 2, 3))
    assert len(set(found)) == (3 * 5 * 7 - 1) // 2
    assert not {(-t, -y, -x) for t, y, x in found} & set(found)
    assert tuple(np.abs(found).max(axis=0)) == (1, 2, 3)


def test_fifty_pixels_a_parameter_are_enough() -> None:
    noise = np.random.default_rng(1).normal(size=(10, 20))
    assert fit(noise, [(0, 1), (1, 0)]).pixels == 200
    with pytest.raises(DataError, match="at least 200 are needed"):
        fit(noise[:, :19], [(0, 1), (1, 0)])


@pytest.mark.parametrize(
    ("shape", "periodic", "sides"), [((1, 40, 50), False, (3, 40, 50)), ((1, 4, 6), True, (2, 4, 6)), ((1, 4, 6), False, (3, 5, 7))]
)
def test_damped_covariances_fall_to_nothing_at_the_side(shape: tuple[int, int, int], periodic: bool, sides: tuple[int, int, int]) -> None:
    """Those of a field already positive: times a triangle as long as the picture, or as all distances where it is smaller."""
    t, y, x = np.mgrid[-1:2, -2:3, -3:4]
    known = Covariances(2.0 * 0.5 ** np.abs(t) * 0.4 ** np.abs(y) * 0.3 ** np.abs(x), 1.0, shape, periodic)
    triangles = (1.0 - np.abs(t) / sides[0]) * (1.0 - np.abs(y) / sides[1]) * (1.0 - np.abs(x) / sides[2])
    np.testing.assert_allclose(known.damped().values, known.values * triangles, atol=1e-12)


def test_damped_covariances_are_those_of_a_field() -> None:
    rough = Covariances(np.array([[[0.9, 1.0, 0.9]]]), 0.0, (1, 1, 5), periodic=False)
    spectrum = np.fft.fft(np.fft.ifftshift(rough.damped().values.ravel())).real
    assert spectrum.min() >= 0.99e-6 * spectrum.max()


def test_weights_beyond_a_field_are_made_as_small_as_the_least_symbol_needs() -> None:
    """A wave between the frequencies of a small picture, nearly without noise."""
    y, x = np.mgrid[:40, :44]
    noise = np.random.default_rng(2).normal(size=(40, 44))
    fitted = fit(np.cos(2.0 * np.pi * (y / 41.7 + x / 11.3)) + 0.01 * noise, [(0, 1), (1, 0), (1, 1)])
    assert "scaled down" in fitted.notes[0]
    assert least_symbol(fitted.model, (1, 40, 44)) == pytest.approx(1e-5, rel=1e-4)
