import numpy as np
import pytest
from scipy import stats
from scipy.ndimage import gaussian_filter

from seaglint.base.errors import DataError
from seaglint.clutter.correlation import effective_count, spatial_correlation
from seaglint.clutter.fits import distances, draw, fit, goodness


def test_distances_are_scipys():
    sample = np.sort(np.random.default_rng(1).normal(size=150))
    ks, _ = distances(stats.norm.cdf(sample))
    assert ks == pytest.approx(stats.kstest(sample, "norm").statistic, rel=1e-12)
    # Anderson-Darling by its textbook sum.
    f = stats.norm.cdf(sample)
    i = np.arange(1, 151)
    textbook = -150 - np.sum((2 * i - 1) * (np.log(f) + np.log(1 - f[::-1]))) / 150
    assert 150 * distances(f)[1] == pytest.approx(textbook, rel=1e-10)


def test_counts_are_repeated_values():
    x, counts = np.array([0.2, 0.5, 0.9]), np.array([3.0, 1.0, 2.0])
    many = np.sort(np.repeat(x, counts.astype(int)))
    assert distances(x, counts)[1] == pytest.approx(distances(many)[1], rel=1e-12)
    assert distances(x, counts)[0] == pytest.approx(stats.kstest(many, "uniform").statistic, rel=1e-12)


@pytest.mark.parametrize(("family", "theta"), [("gamma", (0.7, 3.0)), ("gaussian", (0.0, 1.0)), ("weibull", (1.5, 1.0))])
def test_levels_of_true_families_are_uniform(family, theta):
    rng = np.random.default_rng(12)
    levels = []
    for seed in range(150):
        sample = draw(family, theta, (100,), rng)
        levels.append((lambda g: (g.ks_p, g.ad_p))(goodness(sample, fit(sample, family), replicates=99, seed=seed)))
    # Textbook levels without the fit's share would lie above 0.5 nine times in ten. Level of this test 1e-3, 150 samples.
    for column in np.transpose(levels):
        assert stats.kstest(column, "uniform").pvalue > 1e-3


def test_wrong_family_is_found_and_same_seed_gives_same_level():
    sample = draw("lognormal", (1.0, 1.0), (3000,), np.random.default_rng(13))
    found = goodness(sample, fit(sample, "gamma"))
    assert found.ks_p == found.ad_p == pytest.approx(1 / 200)
    assert goodness(sample, fit(sample, "gamma")) == found


@pytest.mark.validation
def test_levels_hold_under_correlation():
    rng = np.random.default_rng(14)
    rejected = []
    for seed in range(400):
        field = stats.gamma.ppf(
            stats.norm.cdf(gaussian_filter(rng.standard_normal((96, 96)), 2.0, mode="wrap") * 4.0 * np.sqrt(np.pi)), 3.0
        )
        c = spatial_correlation(field)
        count = effective_count(field.size, c.scale_x, c.scale_y)
        found = goodness(field, fit(field, "gamma", effective_count=count), replicates=99, seed=seed)
        rejected.append((found.ks_p <= 0.05, found.ad_p <= 0.05))
    # Never more than stated (0.05 + 3 standard errors of 0.011); as independent pixels nearly all would be rejected.
    assert np.all(np.mean(rejected, axis=0) <= 0.083), np.mean(rejected, axis=0)


def test_too_few_independent_values_have_no_level():
    sample = draw("gamma", (2.0, 1.0), (1000,), np.random.default_rng(1))
    found = goodness(sample, fit(sample, "gamma", effective_count=4))
    assert found.ks > 0.0
    assert np.isnan(found.ks_p)


def test_no_fit_no_goodness():
    with pytest.raises(DataError, match="no gamma fit"):
        goodness(-np.ones(50), fit(-np.ones(50), "gamma"))


def test_levels_of_many_values_are_those_of_as_many_drawn(monkeypatch: pytest.MonkeyPatch) -> None:
    """Fewer are drawn than there are, and distances scaled: of 199 draws a level near 0.3 scatters by 0.03."""
    sample = np.random.default_rng(19).gamma(3.0, 2.0, 3000)
    found = fit(sample, "gamma")
    whole = goodness(sample, found, seed=1)
    monkeypatch.setattr("seaglint.clutter.fits.MOST_INDEPENDENT", 250)
    few = goodness(sample, found, seed=2)
    assert 0.1 < min(whole.ks_p, whole.ad_p) < 0.9
    assert (few.ks, few.ad) == (whole.ks, whole.ad)
    assert few.ks_p == pytest.approx(whole.ks_p, abs=0.15)
    assert few.ad_p == pytest.approx(whole.ad_p, abs=0.15)
