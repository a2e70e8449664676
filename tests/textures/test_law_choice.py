"""Choice of a law: fields of a known law are recognised, halves are judged by pictures that their fit has not seen."""

from __future__ import annotations

import math

import numpy as np
import pytest

from seaglint.clutter.rate_ratios import RateRatio
from seaglint.textures.gauss_markov import GaussMarkov
from seaglint.textures.gaussian_texture import GaussianTexture, Law
from seaglint.textures.law_choice import (
    LAWS,
    JudgedLaw,
    candidates,
    choose_law,
    halves,
    judge_laws,
    laplacian_rates,
    reasons,
    sampled_rates,
)
from seaglint.textures.marginals import Marginal
from seaglint.textures.synthesis import Modulation, density_of, filtered

OFFSETS = ((0, 0, 1), (0, 1, 0))
FIELD = GaussMarkov(OFFSETS, (0.2, 0.15), 1.0)
SHAPE = (1, 160, 320)


def judged(texture: GaussianTexture, laws: tuple[Law, ...] = LAWS) -> tuple[JudgedLaw, list[JudgedLaw]]:
    parts = halves(texture.sample(SHAPE, 5))
    assert parts is not None
    found = judge_laws(parts, laws, OFFSETS, 1)
    return choose_law(found), found


def test_a_gaussian_field_is_gaussian() -> None:
    chosen, _ = judged(GaussianTexture(FIELD, Marginal("gaussian", 20.0, 3.0)))
    assert chosen.law == Law("gaussian")
    assert chosen.agrees


@pytest.mark.parametrize("kind", ["gamma", "lognormal"])
def test_sparse_glints_are_recognised_by_their_values(kind: str) -> None:
    """A gamma shape of 1 or a deviation of 0.6: no other noise and no Gaussian values have these tails."""
    marginal = Marginal("gamma", 2.0, 3.0, 1.0) if kind == "gamma" else Marginal("lognormal", 0.0, 3.0, 0.6)
    chosen, found = judged(GaussianTexture(FIELD, marginal))
    assert chosen.law.tails in ("gamma", "lognormal", "empirical")
    assert chosen.agrees
    by_law = {one.law: one for one in found}
    assert by_law[Law(kind)].agrees  # type: ignore[arg-type]
    assert not by_law[Law("gaussian")].agrees


def test_long_tailed_noise_is_recognised() -> None:
    """Gaussian-looking pixels filtered from Laplace noise: no distribution of the pixels explains the tails."""
    noise = np.random.default_rng(2).laplace(0.0, 1.0, SHAPE).astype(np.float32)
    parts = halves(filtered(noise, density_of(FIELD, SHAPE)))
    assert parts is not None
    found = {one.law: one for one in judge_laws(parts, LAWS, OFFSETS, 1)}
    chosen = choose_law(list(found.values()))
    assert chosen.law.tails == "noise"
    assert chosen.agrees
    for law in (Law("gaussian"), Law("gamma"), Law("lognormal")):
        assert found[law].deviate > 2.0


def test_a_slow_scale_is_recognised_and_kept() -> None:
    texture = GaussianTexture(FIELD, Marginal(), Modulation(1.5, (1.0, 25.0, 25.0)))
    chosen, _ = judged(texture, (Law("gaussian"), Law("gamma"), Law("gaussian", scaled=True)))
    assert chosen.law == Law("gaussian", scaled=True)


def test_a_sample_of_many_tiles_has_the_rate_of_one_picture() -> None:
    """Rates relate to the deviation of a picture of the judged size, not of the whole sample."""
    texture = GaussianTexture(FIELD, Marginal("gamma", 0.0, 1.0, 1.5))
    many = sampled_rates(texture, (1, 64, 96), 3)
    single = [laplacian_rates(texture.sample((1, 64, 96), seed)) for seed in range(60)]
    mean = np.mean([[one.rate for one in rates] for rates in single], axis=0)
    assert [one.rate for one in many] == pytest.approx(mean, rel=0.06)


def test_halves_of_pictures_and_sequences() -> None:
    def shapes(*shape: int) -> list[tuple[int, ...]] | None:
        found = halves(np.zeros(shape, np.float32))
        return None if found is None else [part.shape for part in found]

    assert shapes(1, 40, 101) == [(1, 40, 50), (1, 40, 51)]
    assert shapes(1, 90, 60) == [(1, 45, 60), (1, 45, 60)]
    assert shapes(1, 47, 60) == [(1, 47, 30), (1, 47, 30)]
    assert shapes(1, 40, 47) is None
    assert shapes(17, 24, 24) == [(8, 24, 24), (9, 24, 24)]


def test_the_first_of_equals_is_chosen() -> None:
    def law(tails: str, *values: float) -> JudgedLaw:
        return JudgedLaw(Law(tails), tuple(RateRatio(v, v / 2.0, v * 2.0) for v in values))  # type: ignore[arg-type]

    near, nearer, far = law("gamma", 1.1, 0.95), law("noise", 1.05, 0.98), law("gaussian", 0.1, 0.1)
    assert choose_law([far, near, nearer]) is near
    assert far.deviate == pytest.approx(math.log(10.0) / math.log(2.0))
    assert not far.agrees
    assert choose_law([JudgedLaw(Law("k"), ()), far]) is far
    assert any("no law has the rates" in line for line in reasons(far, [far, JudgedLaw(Law("k"), ())]))


def test_candidates_follow_the_request() -> None:
    assert candidates("auto", None) == LAWS
    assert all(law.scaled for law in candidates("auto", True))
    assert candidates("gaussian", None) == (Law("gaussian"),)
    assert candidates("k", False) == (Law("k"),)
    assert candidates("noise", True) == (Law("noise", scaled=True),)
