"""Pixels that are NaN do not count: measures of pictures with gaps are averages over the pixels and pairs that have a value."""

from __future__ import annotations

import numpy as np
import pytest

from seaglint.base.errors import DataError
from seaglint.studies.texture.texture_sequences import detrended
from seaglint.textures.gauss_markov import GaussMarkov
from seaglint.textures.gauss_markov_fit import covariances, fit
from seaglint.textures.gaussian_texture import TextureLaw, fit_texture
from seaglint.textures.long_tails import interior
from seaglint.textures.marginals import fit_marginal
from seaglint.textures.quality import compare, cooccurrence
from seaglint.textures.suitability import examine
from seaglint.textures.synthesis import latent

FIELD = GaussMarkov(((0, 0, 1), (0, 1, 0)), (0.24, 0.2), 1.0)


def picture(seed: int, shape: tuple[int, int, int] = (1, 96, 112)) -> np.ndarray:
    return latent(FIELD, shape, seed)


def with_gaps(x: np.ndarray) -> np.ndarray:
    """Return the frames without a row, the border, a corner and single pixels."""
    out = x.copy()
    out[:, 30] = np.nan
    out[:, :, :2] = np.nan
    out[:, -12:, -9:] = np.nan
    out[:, 20, 40] = np.nan
    return out


def test_covariances_are_averages_over_the_pairs_with_two_values() -> None:
    x = with_gaps(picture(1, (3, 40, 44))).astype(float)
    found = covariances(x, (1, 2, 3))
    centred = x - np.nanmean(x)
    assert found.pixels == np.count_nonzero(np.isfinite(x))
    for t, y, col in ((0, 0, 0), (0, 1, -3), (1, -2, 2)):
        a = centred[t:, max(y, 0) : 40 + min(y, 0), max(col, 0) : 44 + min(col, 0)]
        b = centred[: 3 - t, max(-y, 0) : 40 + min(-y, 0), max(-col, 0) : 44 + min(-col, 0)]
        assert found.at((t, y, col)) == pytest.approx(np.nanmean(a * b), rel=1e-9)


def test_distances_without_pairs_are_named() -> None:
    x = picture(1, (1, 20, 20))
    x[:, :, 1::2] = np.nan
    with pytest.raises(DataError, match="none of them are some distances"):
        covariances(x, (0, 1, 1))
    with pytest.raises(DataError, match="missing"):
        covariances(x, (0, 1, 1), periodic=True)


def test_a_field_with_gaps_has_the_weights_of_the_field() -> None:
    """Of 112 x 128 pixels: weights within four standard errors, which count the pixels that have a value."""
    found = fit(with_gaps(picture(2, (1, 128, 144))[:, :112, :128]), FIELD.offsets)
    for value, true, error in zip(found.model.coefficients, FIELD.coefficients, found.standard_errors, strict=True):
        assert value == pytest.approx(true, abs=4.0 * error)


def test_the_laplacian_of_pixels_of_which_all_five_have_a_value() -> None:
    x = with_gaps(picture(3))
    z = interior(x)
    assert np.isnan(z[0, 28:31]).all()  # rows 29 to 31 of the picture
    assert np.isnan(z[0, 19, 38:41]).all()
    assert np.isfinite(z[0, 17, 39])


def test_quantiles_and_pairs_of_grey_levels_leave_gaps_out() -> None:
    x = with_gaps(picture(4))
    assert fit_marginal(x, "gamma") == fit_marginal(x[np.isfinite(x)], "gamma")
    striped = np.broadcast_to(np.arange(24.0) % 2, (1, 24, 24)).copy()
    whole = cooccurrence(striped, (0.0, 1.0), 2)
    striped[0, 3] = np.nan
    assert cooccurrence(striped, (0.0, 1.0), 2) == pytest.approx(whole, abs=0.02)


def test_slow_changes_of_pictures_with_gaps() -> None:
    """A dark corner of the frame is no slow change of what is left."""
    x = picture(5) + 10.0
    dark = x.copy()
    dark[:, :30, :30] = 0.0
    assert examine(dark).beyond((0.1, 1.4))
    dark[:, :30, :30] = np.nan
    assert not examine(dark).beyond((0.1, 1.4))
    ramp = dark + np.linspace(0.0, 9.0, 112)
    assert examine(ramp).mean > 0.5
    level = detrended(ramp.astype(np.float32))
    assert np.isnan(level[:, :30, :30]).all()
    assert examine(level).mean < 0.1
    assert np.isfinite(level).sum() == np.isfinite(dark).sum()


def test_comparisons_leave_gaps_out() -> None:
    """A picture differs from itself with gaps by less than from another sample; with the gaps filled by a bright value by far more."""
    x = picture(6, (1, 200, 200))
    gaps = compare(x, with_gaps(x)).distances
    other = compare(x, picture(7, (1, 200, 200))).distances
    assert gaps.fails == []
    assert gaps.marginal.ks < max(other.marginal.ks, 0.01)
    assert gaps.correlation_distance < other.correlation_distance
    bright = np.nan_to_num(with_gaps(x), nan=30.0)
    assert compare(x, bright).distances.fails


def test_scattered_gaps_leave_a_spectrum() -> None:
    """Of 5 % of the pixels without a value no square of 16 x 16 is whole: they are interpolated."""
    x = picture(8, (1, 128, 128))
    x[np.random.default_rng(1).random(x.shape) < 0.05] = np.nan
    assert compare(picture(9, (1, 128, 128)), x).distances.spectrum_distance_db < 3.0


def test_a_texture_is_fitted_to_what_is_left() -> None:
    x = with_gaps(np.exp(0.5 * picture(10, (1, 128, 128))))
    found = fit_texture(x, TextureLaw("lognormal"))
    assert found.texture.marginal.mean == pytest.approx(np.nanmean(x), rel=0.1)
    assert found.field.pixels == np.isfinite(x).sum()
