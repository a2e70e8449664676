"""Choice of a law: fields of a known law are recognised, halves are judged by pictures that their fit has not seen."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from seaglint.base.errors import DomainError
from seaglint.clutter.rate_ratios import RateRatio
from seaglint.textures.gauss_markov import GaussMarkov
from seaglint.textures.gaussian_texture import GaussianTexture, TextureLaw
from seaglint.textures.law_choice import (
    JUDGED,
    LAWS,
    JudgedLaw,
    _judged_part,
    candidates,
    choose_law,
    deviate,
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


def judged(texture: GaussianTexture, laws: tuple[TextureLaw, ...] = LAWS) -> tuple[JudgedLaw, list[JudgedLaw]]:
    parts = halves(texture.sample(SHAPE, 5))
    assert parts is not None
    found = judge_laws(parts, laws, OFFSETS, 1)
    return choose_law(found), found


def test_a_gaussian_field_is_gaussian() -> None:
    chosen, _ = judged(GaussianTexture(FIELD, Marginal("gaussian", 20.0, 3.0)))
    assert chosen.law == TextureLaw("gaussian")
    assert chosen.agrees


@pytest.mark.parametrize("kind", ["gamma", "lognormal"])
def test_sparse_glints_are_recognised_by_their_values(kind: str) -> None:
    """A gamma shape of 1 or a deviation of 0.6: no other noise and no Gaussian values have these tails."""
    marginal = Marginal("gamma", 2.0, 3.0, 1.0) if kind == "gamma" else Marginal("lognormal", 0.0, 3.0, 0.6)
    chosen, found = judged(GaussianTexture(FIELD, marginal))
    assert chosen.law.tails in ("gamma", "lognormal", "empirical")
    assert chosen.agrees
    by_law = {one.law: one for one in found}
    assert by_law[TextureLaw(kind)].agrees  # type: ignore[arg-type]
    assert not by_law[TextureLaw("gaussian")].agrees


def test_long_tailed_noise_is_recognised() -> None:
    """Gaussian-looking pixels filtered from Laplace noise: no distribution of the pixels explains the tails."""
    noise = np.random.default_rng(2).laplace(0.0, 1.0, SHAPE).astype(np.float32)
    parts = halves(filtered(noise, density_of(FIELD, SHAPE)))
    assert parts is not None
    found = {one.law: one for one in judge_laws(parts, LAWS, OFFSETS, 1)}
    chosen = choose_law(list(found.values()))
    assert chosen.law.tails == "noise"
    assert chosen.agrees
    for law in (TextureLaw("gaussian"), TextureLaw("gamma"), TextureLaw("lognormal")):
        assert found[law].deviate > 2.0


def test_a_slow_scale_is_recognised_and_kept() -> None:
    texture = GaussianTexture(FIELD, Marginal(), Modulation(1.5, (1.0, 25.0, 25.0)))
    chosen, _ = judged(texture, (TextureLaw("gaussian"), TextureLaw("gamma"), TextureLaw("gaussian", scaled=True)))
    assert chosen.law == TextureLaw("gaussian", scaled=True)


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
        ratios = tuple(RateRatio(v, v / 2.0, v * 2.0) for v in values)
        return JudgedLaw(TextureLaw(tails), ratios, tuple(abs(math.log(v)) / math.log(2.0) for v in values))  # type: ignore[arg-type]

    near, nearer, far = law("gamma", 1.1, 0.95), law("noise", 1.05, 0.98), law("gaussian", 0.1, 0.1)
    none = JudgedLaw(TextureLaw("k"), (), (), "no field has these correlations")
    assert choose_law([far, near, nearer]) is near
    assert far.deviate == pytest.approx(math.log(10.0) / math.log(2.0))
    assert not far.agrees
    assert choose_law([none, far]) is far
    assert any("this law does not have the rates" in line for line in reasons(far, [far, none]))
    assert any("1 of 2 laws" in line for line in reasons(near, [near, far]))
    assert "no field" in none.text
    assert "not judged" in reasons(none, [none])[0]


def test_deviates_use_the_interval_of_the_data_alone() -> None:
    """At an end of the interval the deviate is 1, whatever the sample's own uncertainty."""
    data = laplacian_rates(GaussianTexture(FIELD, Marginal()).sample((1, 200, 300), 1))[0]
    for end in (data.rate_low, data.rate_high):
        assert end is not None
        for inflation in (1.0, 30.0):
            sampled = replace(data, exceedances=round(end * 10**8), pixels=10**8, rate=end, inflation=inflation)
            assert deviate(data, sampled) == pytest.approx(1.0, rel=1e-3)
    assert deviate(replace(data, rate_low=None), data) is None
    assert deviate(data, data) == 0.0


def test_every_law_is_judged_in_a_sequence() -> None:
    """Neighbours in time, 32 frames: a field and a sample of each law, also with a frame missing."""
    moving = GaussMarkov(((0, 0, 1), (0, 1, 0), (1, 0, 1)), (0.15, 0.1, 0.15), 1.0)
    data = GaussianTexture(moving, Marginal("gamma", 1.0, 1.0, 3.0)).sample((32, 48, 64), 2)
    for missing in (False, True):
        if missing:
            data[5] = np.nan
        parts = halves(data)
        assert parts is not None
        found = judge_laws(parts, LAWS, moving.offsets, 1)
        assert [one.law for one in found if not one.ratios] == []
        assert choose_law(found).law.tails in ("gamma", "lognormal", "empirical")


def test_halves_have_the_same_number_of_pixels_that_count() -> None:
    data = np.zeros((1, 64, 200), np.float32)
    data[:, :, :90] = np.nan
    left, right = halves(data) or (data, data)
    assert np.isfinite(left).sum() == np.isfinite(right).sum()
    clip = np.zeros((40, 24, 24), np.float32)
    clip[:20] = np.nan
    before, after = halves(clip) or (clip, clip)
    assert (len(before), len(after)) == (30, 10)


def test_large_halves_are_judged_by_their_middle() -> None:
    wide = np.broadcast_to(np.arange(1000.0, dtype=np.float32), (1, 1000, 1000))
    some = _judged_part(wide)
    assert some.size <= JUDGED
    assert some.shape == (1, 632, 632)
    assert float(some.mean()) == pytest.approx(499.5, abs=1.0)
    clip = _judged_part(np.broadcast_to(np.float32(1.0), (500, 64, 64)))
    assert clip.shape == (97, 64, 64)


def test_candidates_follow_the_request() -> None:
    assert candidates("auto", None) == LAWS
    assert all(law.scaled for law in candidates("auto", True))
    assert candidates("gaussian", None) == (TextureLaw("gaussian"),)
    assert candidates("k", False) == (TextureLaw("k"),)
    assert candidates("noise", True) == (TextureLaw("noise", scaled=True),)


def test_wrong_laws_are_refused_in_a_line() -> None:
    with pytest.raises(DomainError, match="allowed are auto, gaussian"):
        candidates("foo", None)  # type: ignore[arg-type]
    with pytest.raises(DomainError, match="True, False and None"):
        candidates("gamma", "never")  # type: ignore[arg-type]
