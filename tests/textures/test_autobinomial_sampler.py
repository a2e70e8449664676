"""Samplers against exact enumeration, closed forms, and each other."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from scipy import stats
from scipy.special import comb, expit

from seaglint.base.errors import DomainError
from seaglint.base.jit import njit
from seaglint.textures import autobinomial_sampler as kernels
from seaglint.textures import autobinomial_sampler as sampler
from seaglint.textures.autobinomial import Autobinomial
from seaglint.textures.autobinomial_sampler import exchange, mixing, sample

LEVEL = 1e-3
"""Level of every chi-square test here: one in a thousand fails by chance, and seeds are fixed."""


def chain(model: Autobinomial, shape: tuple[int, int], draws: int, thin: int, seed: int) -> np.ndarray:
    """Pictures of one Gibbs chain, ``thin`` sweeps apart."""
    law, plan, key = sampler.sampling_law(model), sampler.plan(model, shape), sampler.words(seed, "test")
    field = np.zeros(shape, dtype=np.int16)
    found = np.empty((draws, *shape), dtype=np.int16)
    kernels.gibbs(field, law, plan, key, 0, 50)
    for i in range(draws):
        kernels.gibbs(field, law, plan, key, 50 + i * thin, thin)
        found[i] = field
    return found


def chi_square(counts: np.ndarray, expected: np.ndarray) -> float:
    """p-value; cells that expect fewer than 8 are one cell."""
    few = expected < 8.0
    if few.any():
        counts, expected = np.append(counts[~few], counts[few].sum()), np.append(expected[~few], expected[few].sum())
    assert expected[-1] > 1.0
    return float(stats.chisquare(counts, expected * counts.sum() / expected.sum()).pvalue)


def exact(model: Autobinomial, side: int) -> np.ndarray:
    """Probability of every picture of a small torus, each a number to the base of the levels: the joint density, written out."""
    levels, pixels = model.levels, side * side
    states = np.array(list(itertools.product(range(levels), repeat=pixels))).reshape(-1, side, side)
    exponent = (model.alpha * states + np.log(comb(levels - 1, states))).sum(axis=(1, 2))
    for one, beta in zip(model.neighbours, model.beta, strict=True):
        for dy, dx in one:
            exponent = exponent + beta * (states * np.roll(states, (-dy, -dx), axis=(1, 2))).sum(axis=(1, 2))
    weights = np.exp(exponent - exponent.max())
    return weights / weights.sum()


def numbers(pictures: np.ndarray, levels: int) -> np.ndarray:
    """Which of the pictures of :func:`exact` each is."""
    flat = pictures.reshape(len(pictures), -1).astype(np.int64)
    return flat @ levels ** np.arange(flat.shape[1])[::-1]


@pytest.mark.parametrize(
    "model",
    [
        Autobinomial.of(2, 1, -0.8, (0.5,)),
        Autobinomial.of(2, 2, 0.3, (-0.4, 0.3, 0.25, -0.2), isotropic=False),
        Autobinomial.of(3, 1, -0.7, (0.2, -0.1), isotropic=False),
    ],
    ids=["2-levels", "2-levels-diagonals", "3-levels"],
)
def test_every_picture_of_3_x_3_comes_as_often_as_it_must(model: Autobinomial) -> None:
    draws = 12_000
    counts = np.bincount(numbers(chain(model, (3, 3), draws, 6, seed=1), model.levels), minlength=model.levels**9)
    assert chi_square(counts, draws * exact(model, 3)) > LEVEL


@pytest.mark.validation
def test_every_picture_of_4_x_4_with_2_levels() -> None:
    """65 536 pictures: those that differ by a shift share a cell, named by the least of them."""
    model, draws = Autobinomial.of(2, 1, -1.6, (0.7, 0.2), isotropic=False), 12_000
    probability = exact(model, 4)
    pictures = np.arange(2**16)[:, None] >> np.arange(16)[::-1] & 1
    shifts = [np.roll(pictures.reshape(-1, 4, 4), shift, axis=(1, 2)) for shift in itertools.product(range(4), repeat=2)]
    least = np.min([numbers(shifted, 2) for shifted in shifts], axis=0)
    counts = np.bincount(least[numbers(chain(model, (4, 4), draws, 8, seed=2), 2)], minlength=2**16)
    assert chi_square(counts, draws * np.bincount(least, probability, minlength=2**16)) > LEVEL


@pytest.mark.parametrize("levels", [2, 3])
def test_sums_of_4_x_4_are_those_of_the_transfer_matrix(levels: int) -> None:
    """Sum of levels on 4 x 4: traces of products of row matrices with every row weighted by z^sum, for z on the unit circle."""
    model, draws = Autobinomial.of(levels, 1, -0.9, (0.25, 0.1), isotropic=False), 12_000
    rows = np.array(list(itertools.product(range(levels), repeat=4)))
    inside = model.alpha * rows.sum(axis=1) + np.log(comb(levels - 1, rows)).sum(axis=1)
    inside = inside + model.beta[0] * (rows * np.roll(rows, -1, axis=1)).sum(axis=1)
    step = np.exp(model.beta[1] * rows @ rows.T)
    most = 16 * (levels - 1)
    generating = []
    for z in np.exp(2j * np.pi * np.arange(most + 1) / (most + 1)):
        weighted = step * np.exp(inside) * z ** rows.sum(axis=1)
        generating.append(np.trace(np.linalg.matrix_power(weighted, 4)))
    weights = np.fft.fft(generating).real / (most + 1)
    counts = np.bincount(chain(model, (4, 4), draws, 8, seed=3).sum(axis=(1, 2)), minlength=most + 1)
    assert chi_square(counts, draws * weights / weights.sum()) > LEVEL


@pytest.mark.parametrize("levels", [2, 3])
def test_pairs_of_4_x_4_are_those_of_the_transfer_matrix(levels: int) -> None:
    """Sum of the products of all neighbours, whatever their direction: every pair weighted by z^product within and across rows."""
    model, draws = Autobinomial.of(levels, 1, -0.9, (0.25, 0.1), isotropic=False), 12_000
    rows = np.array(list(itertools.product(range(levels), repeat=4)))
    along, across = (rows * np.roll(rows, -1, axis=1)).sum(axis=1), rows @ rows.T
    own = model.alpha * rows.sum(axis=1) + np.log(comb(levels - 1, rows)).sum(axis=1) + model.beta[0] * along
    most = 32 * (levels - 1) ** 2
    circle = np.exp(2j * np.pi * np.arange(most + 1) / (most + 1))
    steps = (np.exp(model.beta[1] * across) * z**across * np.exp(own) * z**along for z in circle)
    weights = np.fft.fft([np.trace(np.linalg.matrix_power(step, 4)) for step in steps]).real / (most + 1)
    found = chain(model, (4, 4), draws, 8, seed=4).astype(np.int64)
    pairs = sum((found * np.roll(found, -1, axis=axis)).sum(axis=(1, 2)) for axis in (1, 2))
    assert chi_square(np.bincount(pairs, minlength=most + 1), draws * np.maximum(weights, 0.0) / weights.sum()) > LEVEL


@njit
def draw(count: int, probability: float, trials: int, out: np.ndarray) -> None:
    """Binomial deviates of keys (i, 7)."""
    for i in range(count):
        out[i] = kernels.binomial(probability, trials, (i, 7))


@pytest.mark.parametrize(("probability", "trials"), [(0.5, 1), (0.3, 3), (0.123, 63), (0.97, 15), (1e-3, 63), (0.42, 300)])
def test_binomial_deviates(probability: float, trials: int) -> None:
    count = 40_000
    out = np.empty(count, dtype=np.int64)
    draw(count, probability, trials, out)
    expected = count * stats.binom(trials, probability).pmf(np.arange(trials + 1))
    assert chi_square(np.bincount(out, minlength=trials + 1), expected) > LEVEL


@pytest.mark.kernel
def test_certain_trials_and_deviates_uncompiled() -> None:
    assert kernels.binomial(1.0, 70, (1, 2)) == 70
    assert kernels.binomial(0.0, 70, (1, 2)) == 0
    plain = [getattr(kernels.binomial, "py_func", kernels.binomial)(0.3, 63, (i, 7)) for i in range(20)]
    out = np.empty(20, dtype=np.int64)
    draw(20, 0.3, 63, out)
    assert plain == out.tolist()


@pytest.mark.kernel
def test_bytes_of_a_seed() -> None:
    """Compiled or not, on any machine: 80 levels take two words of trials, a size of 5 three colours each way."""
    model = Autobinomial.of(80, 2, -0.5, (0.003, 0.001, -0.001, 0.002), isotropic=False)
    field = sample(model, (5, 5), 2, seed=3)
    assert field[0].tolist() == [40, 35, 35, 42, 40]
    assert field[4].tolist() == [37, 42, 38, 43, 37]
    assert exchange(field, model, 2, seed=3)[0].tolist() == [36, 35, 35, 42, 40]


def test_without_coupling_pixels_are_binomial() -> None:
    found = sample(Autobinomial.of(64, 2, 0.4, (0.0, 0.0)), (64, 63), 1, seed=3)
    expected = found.size * stats.binom(63, expit(0.4)).pmf(np.arange(64))
    assert chi_square(np.bincount(found.ravel(), minlength=64), expected) > LEVEL


def test_rows_of_an_ising_chain() -> None:
    """Coupled along rows alone: closed form of the ring of 60, by the eigenvalues of its 2 x 2 matrix."""
    alpha, beta, size = -1.0, 1.2, 60
    model = Autobinomial(2, (((0, 1),),), alpha, (beta,))
    matrix = np.array([[1.0, np.exp(alpha / 2)], [np.exp(alpha / 2), np.exp(alpha + beta)]])
    values, vectors = np.linalg.eigh(matrix)
    powers = (values / values[-1]) ** size
    occupied = np.diag([0.0, 1.0])
    mean = np.trace(occupied @ vectors @ np.diag(powers) @ vectors.T) / powers.sum()
    step = vectors @ np.diag(values / values[-1]) @ vectors.T
    rest = vectors @ np.diag((values / values[-1]) ** (size - 1)) @ vectors.T
    product = np.trace(occupied @ step @ occupied @ rest) / powers.sum()
    found = chain(model, (40, size), 400, 5, seed=4).astype(float)
    means = found.mean(axis=(1, 2)), (found * np.roll(found, -1, axis=2)).mean(axis=(1, 2))
    # 400 draws, 5 sweeps apart (batches of 20 for what correlation is left); 4 standard errors are passed once in 16 000.
    for values_of, expected in zip(means, (mean, product), strict=True):
        error = values_of.reshape(20, 20).mean(axis=1).std(ddof=1) / np.sqrt(20)
        assert abs(values_of.mean() - expected) < 4.0 * error
        assert error < 0.003


@pytest.mark.parametrize(
    ("first", "levels", "beta"),
    [([[1, 1, 1], [1, 0, 0], [0, 0, 0]], 2, (0.9, -0.5)), ([[0, 1, 2], [0, 1, 2], [0, 0, 1]], 3, (0.3, 0.2))],
    ids=["2-levels", "3-levels"],
)
def test_exchange_visits_pictures_of_its_histogram_as_often_as_it_must(first: list, levels: int, beta: tuple) -> None:
    model, draws = Autobinomial.of(levels, 1, 0.7, beta, isotropic=False), 10_000
    probability = exact(model, 3)
    pictures = np.array(list(itertools.product(range(levels), repeat=9)))
    alike = (np.sort(pictures, axis=1) == np.sort(np.ravel(first))).all(axis=1)
    field = np.array(first, dtype=np.int16)
    law, plan, key = sampler.sampling_law(model), sampler.plan(model, (3, 3)), sampler.words(5, "test")
    found = np.empty((draws, 3, 3), dtype=np.int16)
    for i in range(draws):
        kernels.exchange_kernel(field, law, plan, key, 15 * i, 15)
        found[i] = field
    counts = np.bincount(numbers(found, levels), minlength=levels**9)
    assert counts[~alike].sum() == 0
    assert chi_square(counts[alike], draws * probability[alike] / probability[alike].sum()) > LEVEL


def test_exchange_keeps_the_histogram_and_finds_the_texture() -> None:
    first = np.random.default_rng(1).integers(0, 16, (48, 40))
    model = Autobinomial.of(16, 1, 0.0, (0.05,))
    found = exchange(first, model, 20, seed=1)
    assert np.array_equal(np.bincount(found.ravel(), minlength=16), np.bincount(first.ravel(), minlength=16))
    assert np.corrcoef(found[:, 1:].ravel(), found[:, :-1].ravel())[0, 1] > 0.3  # 0 in the first picture
    assert np.array_equal(found, exchange(first, model, 20, seed=1))
    assert not np.array_equal(found, exchange(first, model, 20, seed=2))


def test_bytes_do_not_depend_on_threads() -> None:
    model, shape = Autobinomial.of(16, 3, -1.0, (0.02, 0.01, 0.01)), (65, 67)  # sizes that no number of colours divides
    one, other = np.zeros(shape, dtype=np.int16), np.zeros(shape, dtype=np.int16)
    arguments = sampler.sampling_law(model), sampler.plan(model, shape), sampler.words(6, "test"), 0, 3
    kernels.gibbs(one, *arguments)
    kernels.gibbs_in_threads(other, *arguments)
    assert np.array_equal(one, other)
    assert one.std() > 1.0


def test_sweeps_go_on_where_others_ended_and_seeds_differ() -> None:
    model = Autobinomial.of(8, 1, -1.0, (0.1,))
    law, plan, key = sampler.sampling_law(model), sampler.plan(model, (20, 20)), sampler.words(1, "test")
    one, other = np.zeros((20, 20), dtype=np.int16), np.zeros((20, 20), dtype=np.int16)
    kernels.gibbs(one, law, plan, key, 0, 5)
    kernels.gibbs(other, law, plan, key, 0, 2)
    kernels.gibbs(other, law, plan, key, 2, 3)
    assert np.array_equal(one, other)
    assert not np.array_equal(sample(model, (20, 20), 5, seed=1), sample(model, (20, 20), 5, seed=2))


def test_edges_of_a_cut_sample_are_no_neighbours() -> None:
    model = Autobinomial.of(16, 1, -1.65, (0.055,))
    torus, cut = (np.array([sample(model, (24, 24), 40, seed=s, periodic=p) for s in range(25)]).astype(float) for p in (True, False))
    seam = [np.corrcoef(x[:, :, 0].ravel(), x[:, :, -1].ravel())[0, 1] for x in (torus, cut)]
    inside = np.corrcoef(cut[:, :, 11].ravel(), cut[:, :, 12].ravel())[0, 1]
    # 600 pairs: standard deviation 0.04.
    assert seam[0] > 0.15
    assert inside > 0.15
    assert abs(seam[1]) < 0.12


def test_chains_mix_and_say_so() -> None:
    found = mixing(Autobinomial.of(16, 1, -1.2, (0.03,)), (32, 32), seed=1, warm=50, draws=400)
    assert found.mixed
    assert found.rhat.max() < 1.01
    assert found.effective.min() > 400
    assert found.energy.shape == (4, 400)


def test_chains_that_remember_their_starts_are_found() -> None:
    frozen = Autobinomial.of(16, 1, -15 * 2 * 0.12, (0.12,))
    found = mixing(frozen, (32, 32), seed=1, warm=50, draws=50)
    assert not found.mixed
    assert found.rhat.max() > 1.5


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        ({"shape": (2, 9), "sweeps": 1}, "needs 3 x 3"),
        ({"shape": (9, 9), "sweeps": -1}, "allowed are 0 or more"),
        ({"shape": (9, 9), "sweeps": 1, "start": np.zeros((8, 9), dtype=int)}, "give a start of that shape"),
        ({"shape": (9, 9), "sweeps": 1, "start": np.full((9, 9), 4)}, "grey levels 4 to 4"),
    ],
)
def test_what_does_not_fit_is_named(arguments: dict, text: str) -> None:
    with pytest.raises(DomainError, match=text):
        sample(Autobinomial.of(4, 1, 0.0, (0.1,)), seed=1, **arguments)


@pytest.mark.filterwarnings("ignore:.*encountered in scalar divide:RuntimeWarning")  # chains without any scatter
def test_energies_and_sums_of_frozen_chains_are_those_of_even_pictures() -> None:
    """So strong a coupling leaves every chain at its start, 0, 0 and 1: halves are rounded to the even level."""
    model = Autobinomial(2, (((0, 1), (1, 0)), ((1, 1),)), -240.0, (60.0, 120.0))
    found = mixing(model, (5, 7), seed=1, chains=3, warm=2, draws=8)
    np.testing.assert_allclose(found.sums, np.array([0.0, 0.0, 1.0])[:, None, None] * np.ones((3, 8, 3)))
    np.testing.assert_allclose(found.energy, np.array([0.0, 0.0, 240.0 - 2 * 60.0 - 120.0])[:, None] * np.ones((3, 8)))


@pytest.mark.filterwarnings("ignore:.*encountered in scalar divide:RuntimeWarning")  # chains without any scatter
def test_sums_of_a_bright_field_are_per_pixel_and_per_pair() -> None:
    model = Autobinomial(6, (((0, 1), (1, 0), (1, -1)), ((1, 1),)), 70.0, (0.2, -0.1))
    found = mixing(model, (5, 7), seed=1, chains=2, warm=1, draws=8)
    np.testing.assert_allclose(found.sums, np.array([5.0, 25.0, 25.0]) * np.ones((2, 8, 3)))
    np.testing.assert_allclose(found.energy, -(70.0 * 5.0 + 0.2 * 3 * 25.0 - 0.1 * 25.0), rtol=1e-12)
