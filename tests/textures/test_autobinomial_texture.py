"""Textures of autobinomial fields: the sampler is the one that the regime asks for, and what failed is told."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter

from seaglint.base.errors import DataError
from seaglint.textures import autobinomial_texture as textures
from seaglint.textures.autobinomial import Autobinomial
from seaglint.textures.autobinomial_sampler import exchange, sample
from seaglint.textures.autobinomial_texture import AutobinomialTexture, fit_texture
from seaglint.textures.regime import correlations

USABLE = Autobinomial.of(4, 1, -1.2, (0.2,))


@pytest.fixture(scope="module")
def usable() -> np.ndarray:
    return sample(USABLE, (48, 48), 60, seed=2).astype(float)


def test_usable_fits_are_sampled_by_gibbs_sweeps(usable: np.ndarray) -> None:
    found = fit_texture(usable, 4, 1, isotropic=True)
    assert (found.texture.sampler, found.found.method) == ("gibbs", "pseudo-likelihood")
    assert "Gibbs sweeps" in found.notes[-1]
    drawn = found.texture.sample((1, 48, 48), 3)[0]
    levels = found.texture.grey.to_levels(drawn)
    assert not np.array_equal(np.bincount(levels.ravel()), np.bincount(usable.astype(int).ravel()))
    assert drawn.std() == pytest.approx(usable.std(), rel=0.05)
    assert np.array_equal(drawn, fit_texture(usable, 4, 1, isotropic=True).texture.sample((1, 48, 48), 3)[0])


def test_the_histogram_is_kept_where_it_is_asked_for(usable: np.ndarray) -> None:
    found = fit_texture(usable, 4, 1, isotropic=True, keep_histogram=True)
    assert (found.texture.sampler, found.found.method, found.found.converged) == ("exchange", "monte-carlo-exchange", True)
    drawn = found.texture.grey.to_levels(found.texture.sample((1, 48, 48), 3)[0])
    assert np.array_equal(np.bincount(drawn.ravel()), np.bincount(usable.astype(int).ravel()))


def test_frozen_fits_are_sampled_by_exchange_at_the_likelihood_given_the_histogram() -> None:
    even = np.random.default_rng(5).permutation(np.repeat(np.arange(6), 384)).reshape(48, 48)
    picture = exchange(even, Autobinomial.of(6, 1, 0.0, (0.3,)), 300, seed=2).astype(float)
    found = fit_texture(picture, 6, 1, isotropic=True)
    assert (found.texture.sampler, found.found.method, found.found.converged) == ("exchange", "monte-carlo-exchange", True)
    assert found.notes[0].startswith("Gibbs sweeps at the pseudo-likelihood's fit: ")
    assert "by exchange" in found.notes[-1]
    drawn = found.texture.sample((1, 48, 48), 1)[0].astype(np.int16)
    tie = [correlations(x, found.texture.field.neighbours)[0] for x in (drawn, picture.astype(np.int16))]
    assert tie[0] == pytest.approx(tie[1], abs=0.05)


def test_what_does_not_converge_is_told_and_the_nearer_couplings_are_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    """A smooth Gaussian picture is of no couplings; few rounds, as more do not help."""
    monkeypatch.setattr("seaglint.textures.autobinomial_fit.ROUNDS", 8)
    smooth = gaussian_filter(np.random.default_rng(3).standard_normal((48, 48)), 1.5, mode="wrap")
    found = fit_texture(smooth, 8, 2)
    assert found.texture.sampler == "exchange"
    told = next(note for note in found.notes if "did not converge" in note)
    assert "gauss-markov" in told
    picture = found.texture.grey.to_levels(smooth)
    taken = textures._gap(picture, found.texture.field, 0)
    assert f"{taken:.2g}" in told
    pseudo = textures._gap(picture, fit_texture(smooth, 8, 2, method="pseudo-likelihood").texture.field, 0)
    assert taken <= pseudo


def test_files_without_a_sampler_are_not_whole(usable: np.ndarray) -> None:
    texture = fit_texture(usable, 4, 1, isotropic=True).texture
    assert AutobinomialTexture.from_dict(texture.to_dict()).sampler == "gibbs"
    held = texture.to_dict()
    with pytest.raises(DataError, match="allowed are gibbs and exchange"):
        AutobinomialTexture.from_dict({**held, "sampler": "sweep"})
    del held["sampler"]
    with pytest.raises(DataError, match="fit it anew"):
        AutobinomialTexture.from_dict(held)
