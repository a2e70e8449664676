"""Tails of filtered pictures: what is measured of them, and the slow field that is found where they are too long for the pixels' values."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import norm

from seaglint.clutter.filters import Laplacian
from seaglint.textures import long_tails as tails
from seaglint.textures.gauss_markov import GaussMarkov
from seaglint.textures.long_tails import THRESHOLDS, find_modulation, interior, misfit, pilot_shape, tail
from seaglint.textures.marginals import Marginal
from seaglint.textures.synthesis import Modulation, latent

WHITE = GaussMarkov((), (), 1.0)
FIELD = GaussMarkov(((0, 0, 1), (0, 1, 0)), (0.1, 0.1), 1.0)


def test_the_tail_of_white_noise_is_gaussian_and_does_not_cluster() -> None:
    """400 000 pixels: rates within four standard errors of a count whose neighbours exceed together up to twice."""
    found = tail(np.random.default_rng(1).standard_normal((4, 320, 322)))
    expected = norm.sf(THRESHOLDS)
    pixels = 4 * 318 * 320
    assert found.rates * pixels == pytest.approx(found.counts)
    assert np.all(np.abs(found.counts - expected * pixels) < 4.0 * np.sqrt(2.0 * expected * pixels))
    assert found.clusters == pytest.approx(np.zeros(6), abs=0.01)
    assert found.lengths[1:] == (2.0, 2.0)  # the filter's own weights of neighbours


def test_interior_pixels_see_no_border() -> None:
    frames = np.random.default_rng(2).standard_normal((2, 20, 30)).astype(np.float32)
    raw = Laplacian().apply(frames)[:, 1:-1, 1:-1].astype(float)
    expected = (raw - raw.mean(axis=(1, 2), keepdims=True)) / raw.std(axis=(1, 2), keepdims=True)
    np.testing.assert_allclose(interior(frames), expected, atol=1e-4)


def test_patches_cluster_over_their_size() -> None:
    """White noise in patches of 10 rows and 20 columns, calm or rough: strengths are as alike at a distance as it lies in one patch."""
    rng = np.random.default_rng(3)
    rough = np.kron(rng.choice([0.2, 1.8], (1, 60, 40)), np.ones((1, 10, 20)))
    found = tail(rough * rng.standard_normal(rough.shape))
    apart = np.arange(3, 9)
    alike = 0.5 * (1.0 - apart / 10.0 + 1.0 - apart / 20.0)
    # A patch of the same kind next door is as good; the share of the strength's variance that patches explain is that next door.
    assert found.clusters / found.clusters[0] == pytest.approx(alike / alike[0], abs=0.08)
    assert found.lengths[2] > found.lengths[1] > 5.0
    assert found.lengths[0] == 1.0


def test_misfit_is_the_log_of_rates() -> None:
    one = tail(np.random.default_rng(4).standard_normal((1, 300, 300)))
    assert misfit(one, one) == pytest.approx(np.zeros(3), abs=1e-6)
    twice = tails.Tail(2.0 * one.rates, one.counts, one.clusters, one.lengths)
    assert misfit(twice, one) == pytest.approx(np.full(3, np.log(2.0)), abs=1e-6)
    none = tails.Tail(0.0 * one.rates, one.counts, one.clusters, one.lengths)
    assert np.all(np.isfinite(misfit(none, one)))
    assert np.all(np.isfinite(misfit(one, none)))


@pytest.mark.parametrize(("frames", "reach"), [(1, (0, 4, 4)), (20, (2, 4, 4)), (20, (0, 4, 4)), (1, (8, 1, 1))])
def test_pilots_hold_the_pixels_asked_for(frames: int, reach: tuple[int, int, int]) -> None:
    model = GaussMarkov((reach,), (0.01,), 1.0)
    deep, rows, columns = pilot_shape(model, frames)
    assert deep == (1 if frames == 1 and reach[0] == 0 else max(12, 2 * reach[0] + 1))
    assert rows == columns
    assert rows % 16 == 0
    assert deep * rows**2 <= tails.PILOT < deep * (rows + 16) ** 2


@pytest.fixture
def few(monkeypatch: pytest.MonkeyPatch) -> None:
    """Fewer and smaller samples than a fit takes."""
    monkeypatch.setattr(tails, "PILOT", 90_000)
    monkeypatch.setattr(tails, "SHAPES", (0.3, 1.0, 3.0))
    monkeypatch.setattr(tails, "STRETCHES", (1.0, 2.0))


@pytest.mark.usefixtures("few")
@pytest.mark.parametrize("shape", [0.3, 3.0])
def test_the_slow_field_of_a_sample_is_found(shape: float) -> None:
    """Long tails of a product and Gaussian values: the shape put in comes out, and the rates are met."""
    data = latent(FIELD, (1, 320, 320), 5, Modulation(shape, (1.0, 6.0, 6.0)))
    found, left = find_modulation(data, FIELD, Marginal("gaussian", 0.0, 1.0), seed=6)
    assert found is not None
    assert found.shape == shape
    assert 2.0 < found.lengths[1] < 15.0
    assert np.abs(left[:2]).max() < np.log(1.3)


@pytest.mark.usefixtures("few")
def test_a_gaussian_sample_needs_none() -> None:
    data = latent(FIELD, (1, 320, 320), 7)
    found, left = find_modulation(data, FIELD, Marginal("gaussian", 0.0, 1.0), seed=8)
    assert found is None
    assert abs(left[0]) < np.log(1.15)  # some 550 exceedances of each: a standard error of 6 %
