"""Long tails: quantiles, correlations by Hermite expansion, and fits."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from seaglint.base.errors import DataError, DomainError
from seaglint.textures.marginals import TAILS, Marginal, fit_marginal

ONE_OF_EACH = [
    Marginal("gaussian", 1.0, 2.0),
    Marginal("gamma", 0.5, 2.0, 0.5),
    Marginal("gamma", 3.0, -1.0, 2.0),
    Marginal("lognormal", 0.0, 1.5, 0.6),
    Marginal("k", 0.0, 1.0, 1.5),
]


def test_quantiles_are_those_of_the_families() -> None:
    g = np.array([-4.0, -1.0, 0.0, 2.0, 5.0])
    assert Marginal("gamma", 0.5, 2.0, 0.5)(g) == pytest.approx(stats.gamma.isf(stats.norm.sf(g), 0.5, 0.5, 2.0), rel=1e-9)
    assert Marginal("lognormal", 0.0, 1.5, 0.6)(g) == pytest.approx(1.5 * np.exp(0.6 * g))
    # An exponential with a gamma distributed mean, P(x) by quadrature over the mean.
    mean = stats.gamma.ppf((np.arange(200_000) + 0.5) / 200_000, 1.5)
    k = Marginal("k", 0.0, 1.0, 1.5)
    assert [np.exp(-k(x) / mean).mean() for x in (-1.0, 0.0, 2.0)] == pytest.approx(stats.norm.sf([-1.0, 0.0, 2.0]), rel=2e-4)
    assert k.mean == pytest.approx(1.5, rel=1e-5)
    assert k.variance == pytest.approx(1.5**2 * (1.0 + 2.0 / 1.5), rel=1e-4)


def test_the_correlation_of_lognormal_pixels_is_the_closed_form() -> None:
    s, r = 0.6, np.array([-0.5, 0.2, 0.7, 0.95])
    closed = np.expm1(s**2 * r) / np.expm1(s**2)
    marginal = Marginal("lognormal", 0.0, 1.0, s)
    assert marginal.output_correlation(r) == pytest.approx(closed, abs=1e-10)
    assert marginal.latent_correlation(closed) == pytest.approx(r, abs=1e-6)


@pytest.mark.parametrize("marginal", ONE_OF_EACH, ids=lambda m: m.kind)
def test_correlations_are_met_and_the_error_is_stated(marginal: Marginal) -> None:
    """100 000 pairs of pixels: correlation within 5 standard errors, from 50 blocks."""
    wanted = 0.4
    r = float(marginal.latent_correlation(wanted))
    rng = np.random.default_rng(6)
    g = rng.standard_normal((2, 100_000))
    pair = marginal(g[0]), marginal(r * g[0] + np.sqrt(1.0 - r * r) * g[1])
    blocks = [np.corrcoef(a, b)[0, 1] for a, b in zip(*(np.split(p, 50) for p in pair), strict=True)]
    assert np.mean(blocks) == pytest.approx(wanted, abs=5.0 * np.std(blocks) / np.sqrt(50) + 5e-4)
    assert marginal.truncation < 1e-6


@pytest.mark.parametrize("marginal", ONE_OF_EACH, ids=lambda m: m.kind)
def test_fits_find_the_family_again(marginal: Marginal) -> None:
    """100 000 pixels: quantiles from 2 to 98 % within 4 standard errors of the least certain one; dark tails too."""
    values = marginal(np.random.default_rng(7).standard_normal(100_000))
    found = fit_marginal(values, marginal.kind)
    g = np.linspace(-2.0, 2.0, 21)
    slope = np.abs(marginal(g + 1e-4) - marginal(g - 1e-4)) / 2e-4
    share = stats.norm.cdf(g)
    error = slope / stats.norm.pdf(g) * np.sqrt(share * (1.0 - share) / values.size)
    assert found(g) == pytest.approx(marginal(g), abs=4.0 * error.max())
    assert np.sign(found.scale) == np.sign(marginal.scale)
    assert Marginal.from_dict(found.to_dict()) == found


def test_empirical_pixels_have_the_quantiles_of_the_data() -> None:
    values = np.random.default_rng(8).weibull(0.8, 50_000)
    found = fit_marginal(values, "empirical")
    shares = np.array([0.01, 0.3, 0.9, 0.999])
    assert found(stats.norm.ppf(shares)) == pytest.approx(np.quantile(values, shares), rel=0.02, abs=1e-3)


@pytest.mark.parametrize("kind", TAILS)
def test_the_table_is_the_transform(kind: str) -> None:
    marginal = fit_marginal(np.random.default_rng(9).gamma(1.5, 1.0, 20_000), kind) if kind != "k" else ONE_OF_EACH[4]
    g = np.random.default_rng(1).standard_normal((3, 40)).astype(np.float32)
    assert marginal.transform(g.copy()) == pytest.approx(
        # Between quantiles that are kept an empirical distribution has kinks, beside those of the table.
        marginal(g),
        abs=(5e-4 if kind == "empirical" else 1e-5) * np.sqrt(marginal.variance),
    )
    assert marginal.gaussian(marginal(g)) == pytest.approx(g, abs=5e-4 if kind == "empirical" else 1e-5)


def test_what_cannot_be_is_refused() -> None:
    with pytest.raises(DataError, match="all values are equal"):
        fit_marginal(np.ones(100), "gamma")
    with pytest.raises(DomainError, match="allowed are gaussian, gamma"):
        fit_marginal(np.arange(9.0), "cauchy")  # type: ignore[arg-type]
    with pytest.raises(DomainError, match="has one above 0"):
        Marginal("gamma", 0.0, 1.0, -2.0)
