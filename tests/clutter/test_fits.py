import numpy as np
import pytest
from scipy import stats
from scipy.ndimage import gaussian_filter
from scipy.special import digamma, gammaln, kv, logsumexp

from seaglint.base.errors import DataError
from seaglint.clutter.correlation import block_labels, effective_count
from seaglint.clutter.fits import FAMILIES, _condensed, cdf, draw, fit, log_density, scores

TRUTHS = [
    ("gamma", (0.7, 3.0)),
    ("gamma", (40.0, 0.1)),
    ("lognormal", (0.5, 10.0)),
    ("weibull", (1.7, 4.0)),
    ("k", (0.5, 2.0)),
    ("k", (3.0, 1.0)),
    ("gaussian", (5.0, 2.0)),
]
SCIPY = {
    "gamma": lambda a, b: stats.gamma(a, scale=b),
    "lognormal": lambda a, b: stats.lognorm(a, scale=b),
    "weibull": lambda a, b: stats.weibull_min(a, scale=b),
    "gaussian": lambda a, b: stats.norm(a, b),
}


def parameters(found):
    return (found.loc, found.scale) if found.family == "gaussian" else (found.shape, found.scale)


@pytest.mark.parametrize(("family", "theta"), [t for t in TRUTHS if t[0] != "k"])
def test_densities_are_scipys(family, theta):
    x = np.array([0.01, 0.5, 2.0, 4.0, 11.0])
    np.testing.assert_allclose(log_density(family, x, theta), SCIPY[family](*theta).logpdf(x), rtol=1e-11)
    np.testing.assert_allclose(cdf(family, x, theta), SCIPY[family](*theta).cdf(x), rtol=1e-10, atol=1e-300)


@pytest.mark.parametrize("x", [0.05, 1.0, 9.0])
def test_k_density_is_an_exponential_of_gamma_mean(x):
    from scipy.integrate import quad

    v, b = 1.7, 2.5

    def compound(kernel):
        return quad(lambda t: stats.gamma.pdf(t, v, scale=b) * kernel(t), 0.0, np.inf, epsabs=0.0, epsrel=1e-10, limit=400)[0]

    assert np.exp(log_density("k", np.array(x), (v, b))) == pytest.approx(compound(lambda t: np.exp(-x / t) / t), rel=1e-7)
    assert 1.0 - cdf("k", np.array(x), (v, b)) == pytest.approx(compound(lambda t: np.exp(-x / t)), rel=1e-7)


def test_k_density_at_its_ends():
    # kve underflows or overflows at both ends; the density must stay finite and right there.
    assert np.isfinite(log_density("k", np.array([1e-300, 1e6]), (60.0, 1.0))).all()
    assert log_density("k", np.array(4.0), (3.0, 1.0)) == pytest.approx(np.log(2 / 2 * 4.0 * kv(2.0, 4.0)), rel=1e-12)


@pytest.mark.parametrize(("family", "theta"), TRUTHS)
def test_known_parameters_come_back(family, theta):
    # 1e5 independent values: the largest standard error of these, of the K shape, is 1.5 %; 4 of them.
    found = fit(draw(family, theta, (100_000,), np.random.default_rng(11)), family)
    assert parameters(found) == pytest.approx(theta, rel=0.06 if family == "k" else 0.02)
    low, high = found.scale_interval
    assert low < found.scale < high


@pytest.mark.parametrize("family", ["gamma", "lognormal", "weibull"])
def test_likelihood_is_at_its_maximum(family):
    sample = draw("gamma", (3.0, 2.0), (500,), np.random.default_rng(2))
    found = fit(sample, family)
    fitter = {"gamma": stats.gamma, "lognormal": stats.lognorm, "weibull": stats.weibull_min}[family]
    shape, _, scale = fitter.fit(sample, floc=0)
    # scipy's own search stops at about 1e-5.
    assert (found.shape, found.scale) == pytest.approx((shape, scale), rel=1e-4)
    assert found.log_likelihood == pytest.approx(np.sum(found_logpdf(found, sample)), rel=1e-12)


def found_logpdf(found, sample):
    return np.log(found.pdf(sample))


@pytest.mark.parametrize("family", FAMILIES)
def test_scale_and_units(family):
    sample = draw("k", (2.0, 1.0), (4000,), np.random.default_rng(4))
    one, thousand = fit(sample, family), fit(1000.0 * sample, family)
    assert thousand.scale == pytest.approx(1000.0 * one.scale, rel=1e-4)
    if family != "gaussian":
        assert thousand.shape == pytest.approx(one.shape, rel=1e-4)


def test_fine_histogram_is_as_good_as_the_sample():
    sample = draw("gamma", (3.0, 2.0), (50_000,), np.random.default_rng(6))
    counts, edges = np.histogram(sample, 2000)
    binned = fit(0.5 * (edges[1:] + edges[:-1]), "gamma", weights=counts)
    whole = fit(sample, "gamma")
    assert (binned.shape, binned.scale) == pytest.approx((whole.shape, whole.scale), rel=2e-3)
    assert binned.count == whole.count


def test_location_is_subtracted():
    sample = draw("weibull", (2.0, 1.0), (1000,), np.random.default_rng(8))
    assert fit(sample + 7.0, "weibull", loc=7.0).shape == pytest.approx(fit(sample, "weibull").shape, rel=1e-9)


def test_intervals_widen_with_fewer_independent_values():
    sample = draw("gamma", (3.0, 2.0), (5000,), np.random.default_rng(9))
    all_free, few = fit(sample, "gamma"), fit(sample, "gamma", effective_count=50)
    assert np.log(few.shape_interval[1] / few.shape) == pytest.approx(10.0 * np.log(all_free.shape_interval[1] / all_free.shape), rel=1e-9)


@pytest.mark.parametrize(
    ("values", "family", "reason"),
    [
        (np.ones(100), "gamma", "equal"),
        (np.full(100, 0.1), "gaussian", "equal"),
        (np.linspace(-1.0, 1.0, 100), "lognormal", "not above"),
        (np.arange(1.0, 5.0), "gamma", "at least 10"),
        (np.full(100, np.nan), "gaussian", "0 values"),
        (np.random.default_rng(1).gamma(5.0, 1.0, 1000), "k", "at least 1"),
    ],
)
def test_what_cannot_be_fitted_says_why(values, family, reason):
    found = fit(values, family)
    assert not found.is_valid
    assert (found.shape, found.scale, found.scale_interval) == (None, None, None)
    assert reason in found.reason
    with pytest.raises(DataError, match="there is no"):
        found.cdf(1.0)


def test_a_few_zeros_of_an_integer_picture_are_left_out_and_counted():
    sample = np.concatenate([np.zeros(10), draw("gamma", (3.0, 2.0), (990,), np.random.default_rng(3))])
    found = fit(sample, "gamma")
    assert found.is_valid
    assert found.excluded == pytest.approx(0.01)
    assert found.count == 990


def test_unknown_family_names_the_known():
    with pytest.raises(DataError, match="gamma, lognormal"):
        fit(np.ones(20), "rayleigh")


def gamma_field(rng, shape, sigma, size):
    """Field with gamma marginals: a Gaussian one through the two distribution functions."""
    noise = gaussian_filter(rng.standard_normal((size, size)), sigma, mode="wrap")
    noise *= 2.0 * np.sqrt(np.pi) * sigma  # unit variance: the filter's squared kernel integrates to 1 / (4 pi sigma^2)
    return stats.gamma.ppf(stats.norm.cdf(noise), shape)


@pytest.mark.validation
@pytest.mark.parametrize("family", FAMILIES)
def test_stated_intervals_of_independent_samples_cover(family):
    # 1000 simulations: 95 % has a standard error of 0.7 %.
    theta = {"gaussian": (5.0, 2.0), "k": (2.0, 1.0)}.get(family, (1.5, 2.0))
    rng = np.random.default_rng(100)
    found = [fit(draw(family, theta, (1000,), rng), family) for _ in range(1000)]
    inside = [f.scale_interval[0] < theta[1] < f.scale_interval[1] for f in found if f.is_valid]
    assert len(inside) > 990
    assert 0.93 <= np.mean(inside) <= 0.97


@pytest.mark.validation
def test_stated_intervals_of_correlated_fields_cover():
    # 400 simulations: 95 % are 380 with a standard deviation of 4.4; intervals of 90 % would hold 360.
    rng = np.random.default_rng(101)
    labels = block_labels((128, 128), (16, 16))
    inside, widths = [], []
    for _ in range(400):
        found = fit(gamma_field(rng, 2.0, 1.5, 128), "gamma", blocks=labels)
        inside.append((found.shape_interval[0] < 2.0 < found.shape_interval[1], found.scale_interval[0] < 1.0 < found.scale_interval[1]))
        widths.append(found.shape_interval[1] - found.shape_interval[0])
    held = np.sum(inside, axis=0)
    assert np.all((held >= 368) & (held <= 392)), held


def test_blocks_widen_intervals_by_the_correlation():
    rng = np.random.default_rng(7)
    field = gamma_field(rng, 2.0, 2.0, 256)
    blocked = fit(field, "gamma", blocks=block_labels(field.shape, (24, 24)))
    counted = fit(field, "gamma", effective_count=effective_count(field.size, 4.0 * np.sqrt(np.pi), 4.0 * np.sqrt(np.pi)))
    free = fit(field, "gamma")
    ratio = np.log(blocked.shape_interval[1] / blocked.shape) / np.log(free.shape_interval[1] / free.shape)
    # sqrt(1 / share of independent values) = 7.1 for the values, sqrt(2) less for the squares that fix the shape.
    assert 4.0 < ratio < 8.0
    assert counted.shape_interval[1] - counted.shape_interval[0] > 0.8 * (blocked.shape_interval[1] - blocked.shape_interval[0])


ANALYTIC_SCORES = {
    "gaussian": lambda x, a, b: ((x - a) / b**2, ((x - a) / b) ** 2 - 1.0),
    "gamma": lambda x, a, b: (a * (np.log(x / b) - digamma(a)), x / b - a),
    "lognormal": lambda x, a, b: ((np.log(x / b) / a) ** 2 - 1.0, np.log(x / b) / a**2),
    "weibull": lambda x, a, b: (1.0 + a * np.log(x / b) * (1.0 - (x / b) ** a), a * ((x / b) ** a - 1.0)),
}


@pytest.mark.parametrize("family", ANALYTIC_SCORES)
def test_scores_are_the_derivatives_of_the_density(family):
    """Closed forms, by the parameters' logarithms and the Gaussian's mean."""
    x = np.array([0.3, 1.0, 2.7, 6.0])
    np.testing.assert_allclose(scores(family, x, (2.3, 1.7)), ANALYTIC_SCORES[family](x, 2.3, 1.7), rtol=1e-6, atol=1e-8)


def test_intervals_of_a_gaussian_are_the_closed_forms():
    """Of mirrored values, whose mean and deviation do not go together: errors s / root n and 1 / root ((kurtosis - 1) n)."""
    half = np.random.default_rng(12).gamma(2.0, 1.0, 300)
    found = fit(3.0 + np.r_[half, -half], "gaussian")
    error = np.sqrt(np.mean(half**2) / 600.0)
    assert np.subtract(found.loc_interval, 3.0) == pytest.approx([-1.959964 * error, 1.959964 * error], rel=1e-6)
    spread = 1.959964 / np.sqrt((np.mean(half**4) / np.mean(half**2) ** 2 - 1.0) * 600.0)
    assert np.log(np.divide(found.scale_interval, found.scale)) == pytest.approx([-spread, spread], rel=1e-5)


def test_intervals_of_blocks_are_those_of_their_sums():
    """Gaussian: sums over blocks of deviations, and of squared ones less their mean, with Student's quantile."""
    rng = np.random.default_rng(13)
    label = rng.integers(0, 12, 500)
    x = rng.standard_normal(500) + rng.standard_normal(12)[label]
    w = rng.uniform(0.5, 2.0, 500)
    found = fit(x, "gaussian", weights=w, blocks=label)
    mean = np.average(x, weights=w)
    z = (x - mean) / np.sqrt(np.average((x - mean) ** 2, weights=w))
    quantile = stats.t.ppf(0.975, 11)
    for interval, part, slope in (
        (np.subtract(found.loc_interval, found.loc) / found.scale, z, w.sum()),
        (np.log(np.divide(found.scale_interval, found.scale)), z**2 - 1.0, 2.0 * w.sum()),
    ):
        sums = np.array([np.sum((w * part)[label == block]) for block in range(12)])
        error = np.sqrt(np.sum(sums**2) * 12.0 / 11.0) / slope
        assert interval == pytest.approx([-quantile * error, quantile * error], rel=1e-4)


def test_many_values_are_condensed_to_means_of_as_many_neighbours():
    rng = np.random.default_rng(14)
    x, p = rng.gamma(2.0, 1.0, 1000), rng.uniform(0.5, 1.5, 1000)
    p /= p.sum()
    means, weights = _condensed(x, p, 100)
    order = np.argsort(x).reshape(100, 10)
    np.testing.assert_allclose(weights, p[order].sum(axis=1))
    np.testing.assert_allclose(means, (p * x)[order].sum(axis=1) / p[order].sum(axis=1))


@pytest.mark.parametrize("order", [0.5, 7.5, 60.5])
@pytest.mark.parametrize("x", [1e-14, 1e-6, 0.3, 40.0])
def test_density_of_the_k_law_where_its_bessel_function_is_a_finite_sum(order, x):
    """K_(n+1/2)(z) = sqrt(pi/(2z)) e^-z sum of (n+k)!/(k! (n-k)! (2z)^k), by logarithms: beyond 1e308 for large orders and small z."""
    shape, z = order + 1.0, 2.0 * np.sqrt(x / 1.3)
    n, k = order - 0.5, np.arange(round(order + 0.5))
    bessel = 0.5 * np.log(np.pi / (2 * z)) - z + logsumexp(gammaln(n + k + 1) - gammaln(k + 1) - gammaln(n - k + 1) - k * np.log(2 * z))
    # f(x) = 2/(b Gamma(a)) (x/b)^((a - 1)/2) K_(a-1)(2 sqrt(x/b))
    expected = np.log(2.0 / 1.3) - gammaln(shape) + 0.5 * order * np.log(x / 1.3) + bessel
    assert log_density("k", np.asarray(x), (shape, 1.3)) == pytest.approx(expected, rel=1e-9, abs=1e-6)
