"""Long tails: the noise behind a picture, its distribution, and the slow scale that multiplies it."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter
from scipy.special import polygamma

from seaglint.clutter.filters import Laplacian
from seaglint.textures.gauss_markov import GaussMarkov
from seaglint.textures.gaussian_texture import GaussianTexture, TextureLaw, fit_texture, of_latent
from seaglint.textures.long_tails import PATCH, PATCH_IN_TIME, innovations, interior
from seaglint.textures.marginals import Marginal, fit_marginal
from seaglint.textures.synthesis import Modulation, density_of, filtered, latent, rough, slow, whitened

FIELD = GaussMarkov(((0, 0, 1), (0, 1, 0)), (0.2, 0.15), 1.0)
IN_TIME = GaussMarkov(((0, 0, 1), (0, 1, 0), (1, 0, 1)), (0.15, 0.1, 0.15), 1.0)


def test_interior_pixels_see_no_border() -> None:
    frames = np.random.default_rng(2).standard_normal((2, 20, 30)).astype(np.float32)
    raw = Laplacian().apply(frames)[:, 1:-1, 1:-1].astype(float)
    expected = (raw - raw.mean(axis=(1, 2), keepdims=True)) / raw.std(axis=(1, 2), keepdims=True)
    np.testing.assert_allclose(interior(frames), expected, atol=1e-4)


@pytest.mark.parametrize(("model", "shape"), [(FIELD, (1, 40, 61)), (IN_TIME, (9, 30, 22))])
def test_whitening_undoes_the_filter(model: GaussMarkov, shape: tuple[int, int, int]) -> None:
    noise = np.random.default_rng(1).standard_normal(shape).astype(np.float32)
    density = density_of(model, shape)
    np.testing.assert_allclose(whitened(filtered(noise.copy(), density), density), noise, atol=2e-5)


@pytest.mark.parametrize("model", [FIELD, IN_TIME])
def test_the_noise_behind_a_part_of_a_sample_is_found(model: GaussMarkov) -> None:
    """Cut from a torus, so that the borders have neighbours that nobody knows; away from them the noise is the one drawn."""
    frames = 1 if model.reach[0] == 0 else 20
    shape = (frames, 160, 200)
    law = Marginal("empirical", 0.0, 1.0, None, tuple(np.sign(g) * abs(g) ** 1.4 for g in np.linspace(-4.0, 4.0, 101)))
    drawn = rough(shape, 3, noise=law)
    whole = filtered(drawn.copy(), density_of(model, shape))
    part = (slice(None), slice(20, 120), slice(30, 170)) if frames == 1 else (slice(4, 16), slice(20, 120), slice(30, 170))
    found = innovations(whole[part], model).values
    inside = np.isfinite(found)
    assert np.corrcoef(found[inside], drawn[part][inside])[0, 1] > 0.985
    assert not inside[:, 0].any()
    assert not inside[:, :, -1].any()


def test_the_law_of_the_noise_is_found() -> None:
    """Exponential noise: skewness 2 and excess kurtosis 6 of the noise, of which a filter leaves less in the pixels."""
    noise = np.random.default_rng(4).exponential(1.0, (1, 400, 400)).astype(np.float32) - 1.0
    x = filtered(noise, density_of(FIELD, noise.shape))
    behind = innovations(x, FIELD)
    law = behind.law(scaled=False)
    assert law.mean == pytest.approx(0.0, abs=1e-6)
    assert law.variance == pytest.approx(1.0, rel=1e-6)
    drawn = rough((1, 600, 600), 5, noise=law)
    z = (drawn - drawn.mean()) / drawn.std()
    assert float((z**3).mean()) == pytest.approx(2.0, rel=0.1)
    assert float((z**4).mean()) - 3.0 == pytest.approx(6.0, rel=0.3)
    assert behind.modulation is None


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_even_noise_has_no_slow_scale(seed: int) -> None:
    x = latent(FIELD, (1, 150, 200), seed)
    assert innovations(x, FIELD).modulation is None


@pytest.mark.parametrize(("shape", "length"), [(2.0, 40.0), (5.0, 25.0)])
def test_the_slow_scale_of_a_sample_is_found(shape: float, length: float) -> None:
    """The window averages over two lengths of 8 px: the variance of the logarithm falls by as much as the correlation over it."""
    found = [innovations(latent(FIELD, (1, 600, 600), seed, Modulation(shape, (1.0, length, length))), FIELD).modulation for seed in (1, 2)]
    assert all(one is not None for one in found)
    # The Gaussian window of standard deviation w leaves 1 / (1 + 4 w² / L²) of the variance of a field of correlation exp(-(d / L)²).
    left = 1.0 / (1.0 + 4.0 * PATCH**2 / length**2)
    expected = polygamma(1, shape) * left
    measured = np.mean([polygamma(1, one.shape) for one in found if one is not None])
    assert measured == pytest.approx(expected, rel=0.3)
    lengths = np.mean([one.lengths[1:] for one in found if one is not None])
    assert lengths == pytest.approx(np.hypot(length, 2.0 * PATCH), rel=0.3)


def test_gaps_have_no_noise_and_change_none_far_away() -> None:
    x = latent(FIELD, (1, 120, 160), 8)
    holed = x.copy()
    holed[:, 40:50, 60:80] = np.nan
    whole, gaps = innovations(x, FIELD), innovations(holed, FIELD)
    assert np.isnan(gaps.values[:, 40:50, 60:80]).all()
    far = (slice(None), slice(70, 110), slice(10, 150))
    ratio = gaps.values[far] / whole.values[far]
    assert float(np.median(ratio)) == pytest.approx(1.0, abs=0.01)
    assert float(np.corrcoef(gaps.values[far].ravel(), whole.values[far].ravel())[0, 1]) > 0.9999


def test_samples_with_noise_and_scale_keep_the_spectrum_and_their_bytes() -> None:
    law = fit_marginal(np.random.default_rng(1).gamma(2.0, 1.0, 20_000), "empirical")
    texture = GaussianTexture(FIELD, Marginal("gaussian", 5.0, 2.0), Modulation(2.0, (1.0, 12.0, 12.0)), law)
    again = GaussianTexture.from_dict(texture.to_dict())
    assert again == texture
    assert texture.law == TextureLaw("noise", scaled=True)
    assert again.sample((1, 64, 80), 3).tobytes() == texture.sample((1, 64, 80), 3).tobytes()


@pytest.mark.parametrize("law", [TextureLaw("noise"), TextureLaw("noise", scaled=True), TextureLaw("empirical", scaled=True)])
def test_a_fit_to_long_tails_has_them(law: TextureLaw) -> None:
    """Laplacian of samples: kurtosis of the data within a fifth, where a Gaussian fit has none."""
    noise = np.random.default_rng(6).laplace(0.0, 1.0, (1, 300, 300)).astype(np.float32)
    data = filtered(noise, density_of(FIELD, noise.shape)) if law.tails == "noise" else np.exp(0.4 * latent(FIELD, (1, 300, 300), 7))
    fitted = fit_texture(data, law).texture

    def kurtosis(x: np.ndarray) -> float:
        return float((interior(x) ** 4).mean()) - 3.0

    sample = fitted.sample((1, 300, 300), 1)
    assert kurtosis(sample) == pytest.approx(kurtosis(data), rel=0.25)
    assert abs(kurtosis(fit_texture(data).texture.sample((1, 300, 300), 1))) < 0.2


def test_a_scaled_sample_has_the_values_of_the_data() -> None:
    """A field with a slow scale is not Gaussian: without its own transform its quantiles lie up to a fifth away."""
    data = np.exp(0.5 * latent(FIELD, (1, 300, 300), 3, Modulation(0.5, (1.0, 25.0, 25.0))))
    fitted = fit_texture(data, TextureLaw("empirical", scaled=True)).texture
    assert fitted.transform is not None
    share = np.array([0.01, 0.1, 0.5, 0.9, 0.99])
    # Samples with one draw of the slow field: the mean of eight.
    sampled = np.mean([np.quantile(fitted.sample((1, 300, 300), seed), share) for seed in range(8)], axis=0)
    assert sampled == pytest.approx(np.quantile(data, share), rel=0.06)


def test_values_of_a_field_that_is_not_gaussian() -> None:
    """Quantiles of the transformed field are those of the distribution, whatever the field's own."""
    field = latent(FIELD, (1, 512, 512), 1, Modulation(0.5, (1.0, 20.0, 20.0)))
    wanted = fit_marginal(np.random.default_rng(2).gamma(3.0, 2.0, 50_000), "empirical")
    other = latent(FIELD, (1, 512, 512), 9, Modulation(0.5, (1.0, 20.0, 20.0)))
    values = of_latent(wanted, field).transform(other)
    share = np.array([0.05, 0.3, 0.5, 0.7, 0.95])
    plain = wanted.transform(np.random.default_rng(3).standard_normal((1, 500, 500)).astype(np.float32))
    assert np.quantile(values, share) == pytest.approx(np.quantile(plain, share), rel=0.15)


def test_the_noise_near_the_border_of_a_part_is_as_good_as_inside() -> None:
    """A field with long correlations, cut from a torus: on a torus of its own it would have a step at the border, whose noise is large."""
    model, shape = GaussMarkov(((0, 0, 1), (0, 1, 0)), (0.25, 0.2499), 1.0), (1, 200, 240)
    errors = []
    for seed in range(4):
        drawn = rough(shape, seed)
        part = (slice(None), slice(30, 150), slice(30, 190))
        found = innovations(filtered(drawn.copy(), density_of(model, shape))[part], model).values
        known = np.isfinite(found)
        scale = (found[known] * drawn[part][known]).sum() / (drawn[part][known] ** 2).sum()
        errors.append((found - scale * drawn[part])[0] ** 2)
    error = np.sqrt(np.mean(errors, axis=0))
    rows, columns = np.indices(error.shape)
    depth = np.minimum(np.minimum(rows, error.shape[0] - 1 - rows), np.minimum(columns, error.shape[1] - 1 - columns))
    assert np.sqrt(np.mean(error[(depth >= 5) & (depth < 10)] ** 2)) < 2.4 * np.sqrt(np.mean(error[depth >= 40] ** 2))


def test_the_scale_of_even_noise_varies_by_the_number_of_pixels_in_the_window() -> None:
    """Mean of abs(e) over 4 pi w² pixels, e Gaussian: relative variance (pi / 2 - 1) / (4 pi w²)."""
    scales = [innovations(latent(FIELD, (1, 300, 300), seed), FIELD).scale[:, 24:-24, 24:-24] for seed in range(12)]
    assert np.mean([np.log(one).var() for one in scales]) == pytest.approx((np.pi / 2.0 - 1.0) / (4.0 * np.pi * PATCH**2), rel=0.15)


def test_what_varies_by_chance_is_no_slow_scale() -> None:
    """A scale that varies by 4 %, and averages of it by another 3 %: the fitted variance is the one of the drawn scale."""
    weak, shape = Modulation(100.0, (1.0, 30.0, 30.0)), (1, 300, 300)
    drawn, fitted = [], []
    for seed in range(10):
        modulation = innovations(latent(FIELD, shape, seed, weak), FIELD).modulation
        fitted.append(0.0 if modulation is None else float(polygamma(1, modulation.shape)) / 4.0)
        drawn.append(float(np.log(gaussian_filter(np.sqrt(slow(weak, shape, seed)[0]), PATCH)).var()))
    assert np.mean(fitted) == pytest.approx(np.mean(drawn), rel=0.15)


@pytest.mark.parametrize(("length", "rel"), [(0.5, 0.25), (8.0, 0.3)])
def test_the_length_in_time_of_the_slow_scale(length: float, rel: float) -> None:
    """The window alone correlates averages to 1/e at twice its width: squares of both lengths add."""
    strong = Modulation(2.0, (length, 6.0, 6.0))
    found = [innovations(latent(IN_TIME, (48, 64, 64), seed, strong), IN_TIME).modulation for seed in range(4)]
    lengths = [one.lengths[0] for one in found if one is not None]
    assert len(lengths) == len(found)
    assert np.mean(lengths) == pytest.approx(np.hypot(length, 2.0 * PATCH_IN_TIME), rel=rel)
