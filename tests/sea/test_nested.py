import numpy as np
import pytest
from scipy.integrate import quad
from scipy.stats import norm
from shadowing_laws import lit_of_seen

from seaglint.base.errors import DomainError
from seaglint.facet.emissivity import facet_nodes
from seaglint.facet.glint import glint
from seaglint.facet.legs import NESTED_VIEWER, VIEWER, Shadowing
from seaglint.sea.shadowing.nested import BANDS, nested_area, nested_exponent_kernel, nested_ratio, ratio_table
from seaglint.sea.shadowing.seen_and_lit import coupled_bands, coupling_table, lit_exponent_kernel
from seaglint.sea.shadowing.smith import projected_area, smith_lambda, smith_nu
from seaglint.sea.slopes.cox_munk import cox_munk_anisotropic, cox_munk_gram_charlier, cox_munk_isotropic
from seaglint.sea.slopes.slope_statistics import SlopeStatistics, flat

DEPRESSIONS = (1.0, 2.0, 3.0, 4.0, 6.0, 10.0, 15.0)
# Brute-force visibility on an isotropic Gaussian surface of k^-4 elevation density, 256 m to 5 cm, slope variance 0.0542, no shading of
# the Sun: mirrored light seen over Saunders' law. Standard errors 0.003-0.015.
BRUTE_FORCE = {
    60.0: (1.22, 1.21, 1.19, 1.17, 1.12, 1.05, 1.01),
    77.0: (0.73, 0.76, 0.81, 0.83, 0.89, 0.97, 1.00),
    80.0: (0.61, 0.66, 0.69, 0.75, 0.83, 0.94, 0.99),
    85.0: (0.43, 0.46, 0.52, 0.57, 0.71, 0.88, 0.97),
}
SURFACE = SlopeStatistics(0.0271, 0.0271)


@pytest.mark.parametrize("sun", BRUTE_FORCE)
def test_mirrored_light_near_the_horizon_is_that_of_brute_force(sun):
    theta = np.radians(90.0 - np.array(DEPRESSIONS))
    nested, smith = (glint(theta, np.pi, np.radians(sun), 0.0, SURFACE, law).chance for law in (NESTED_VIEWER, VIEWER))
    np.testing.assert_allclose(nested / smith, BRUTE_FORCE[sun], atol=0.06)


@pytest.mark.parametrize("slopes", [cox_munk_isotropic(7.0), cox_munk_anisotropic(11.0, 0.7)], ids=["isotropic", "directional"])
def test_one_band_is_smith_to_the_last_digit(slopes):
    theta, azimuth = np.radians([[30.0], [85.0], [89.5], [90.0]]), np.radians([150.0, 185.0])
    one, smith = (glint(theta, azimuth, np.radians(80.0), 0.1, slopes, Shadowing.of(law, 1)).chance for law in ("nested", "both"))
    np.testing.assert_array_equal(one, smith)
    assert np.all(smith[:, 1] > 0.0)


@pytest.mark.parametrize("bands", [BANDS, 32, *(pytest.param(n, marks=pytest.mark.validation) for n in (2, 8))])
@pytest.mark.parametrize("zenith", [70.0, 85.0, 89.0, 89.9, 90.0])
def test_visible_slopes_add_up_to_one(bands, zenith):
    theta, variance = np.radians(zenith), 0.03
    deviation = np.sqrt(variance)
    edge = 1.0 / np.tan(theta)
    low, high = -6.5 * deviation, min(edge, 6.5 * deviation)
    x, w = np.polynomial.legendre.leggauss(400)
    s = low + 0.5 * (high - low) * (1.0 + x)
    visible = norm.pdf(s, scale=deviation) * (np.cos(theta) - np.sin(theta) * s) / projected_area(theta, variance)
    total = 0.5 * (high - low) * (w @ (visible * nested_ratio(s, theta, variance, bands)))
    assert total == pytest.approx(1.0, abs=1e-4)  # the table's cubics


@pytest.mark.parametrize("zenith", [80.0, 88.0])
@pytest.mark.parametrize("slope", [-2.0, -0.7, 0.0])
def test_bands_without_end_are_a_walk_that_never_meets_the_edge(zenith, slope):
    """Closed form: Brownian slopes conditioned not to cross the slope seen edge on."""
    theta, variance = np.radians(zenith), 0.03
    mu = 1.0 / (np.tan(theta) * np.sqrt(variance))
    limit = (1.0 + smith_lambda(smith_nu(theta, variance))) * -np.expm1(-2.0 * mu * (mu - slope))
    error = [abs(float(nested_ratio(slope * np.sqrt(variance), theta, variance, n)) / limit - 1.0) for n in (1, 4, 16, 64)]
    assert np.all(np.diff(error) < 0.0)
    assert error[-1] < 0.07  # falls as the root of the number of bands


def test_never_more_than_all_that_is_visible():
    """Smith's law hides Lambda/(1 + Lambda) of the facets turned to the viewer; no ensemble can show more than all."""
    theta = np.radians(np.linspace(75.0, 89.9, 40))[:, None]
    ratio = nested_ratio(np.linspace(-0.8, 0.2, 60), theta, 0.03)
    assert np.all(ratio <= (1.0 + smith_lambda(smith_nu(theta, 0.03))) * (1.0 + 1e-3))
    assert np.all(ratio > 0.0)


@pytest.mark.parametrize("zenith", [87.0, pytest.param(75.0, marks=pytest.mark.validation)])
def test_directional_slopes_drawn_band_by_band(zenith):
    """Independent route: draw two-dimensional slopes of each band, weigh by what is seen of it, average over the last."""
    slopes, theta, azimuth, n = SlopeStatistics(0.04, 0.012), np.radians(zenith), 0.8, 400_000
    rng = np.random.default_rng(5)
    v = np.array([np.sin(theta) * np.cos(azimuth), np.sin(theta) * np.sin(azimuth)])  # along and across the wind
    s, weight = np.zeros((2, n)), np.ones(n)
    along = np.sin(theta) ** 2 * float(slopes.mss_along(azimuth)) / BANDS
    for _ in range(BANDS):
        edge = (np.cos(theta) - v @ s) / np.sqrt(along)
        s = s + rng.normal(size=(2, n)) * np.sqrt(np.array([[slopes.mss_up], [slopes.mss_cross]]) / BANDS)
        projection = np.cos(theta) - v @ s
        weight *= np.maximum(projection, 0.0) / (np.sqrt(along) * (edge * norm.cdf(edge) + norm.pdf(edge)))
        keep = rng.choice(n, n, p=weight / weight.sum())  # resampled, or few draws would carry all the weight
        s, weight = s[:, keep], np.ones(n)
    projection = np.cos(theta) - v @ s
    upward2 = 1.0 / (1.0 + (s**2).sum(axis=0))
    nodes = facet_nodes(theta, slopes, azimuth, BANDS)
    assert nodes.weight @ nodes.cos_incidence == pytest.approx(np.mean(projection * np.sqrt(upward2)), rel=0.01)  # 4 standard errors
    assert nodes.weight @ nodes.meets_sea == pytest.approx(np.mean(2.0 * projection * upward2 < np.cos(theta)), abs=0.004)
    smith = facet_nodes(theta, slopes, azimuth)
    if zenith > 80.0:
        assert nodes.weight @ nodes.cos_incidence > 1.05 * (smith.weight @ smith.cos_incidence)


def test_steep_views_and_flat_seas_have_nothing_to_nest():
    assert float(nested_ratio(-0.1, np.radians(20.0), 0.03)) == 1.0
    assert float(nested_ratio(0.0, np.radians(80.0), 0.0)) == 1.0
    chance = [float(glint(1.2, np.pi, 1.2, 0.0, flat(), Shadowing.of(law)).chance) for law in ("both", "nested")]
    assert chance[0] == chance[1]


def test_refusals_say_what_to_do():
    with pytest.raises(DomainError, match="outside 1-64"):
        ratio_table(0)
    with pytest.raises(DomainError, match=r"0\.\.pi/2"):
        nested_ratio(0.0, 1.6, 0.03)
    with pytest.raises(DomainError, match="below 0"):
        nested_ratio(0.0, 1.5, -0.03)


def _two_bands_by_hand(slope, view, sun):
    """The joint law of two bands by adaptive quadrature over the first band's slope."""
    width = np.sqrt(0.5)

    def density(x):
        return np.exp(-0.5 * x * x) / np.sqrt(2.0 * np.pi)

    def area(x, scale):
        return scale * (x / scale * norm.cdf(x / scale) + density(x / scale))

    def seen_and_lit(tilt, scale):
        v, s = view - tilt, sun + tilt
        lambda_v, lambda_s = area(v, scale) / v - 1.0, area(s, scale) / s - 1.0
        return (1.0 + lambda_v) / (1.0 + lambda_v + lambda_s) / area(v, scale)

    def first(s):
        onward = density((slope - s) / width) / width * seen_and_lit(s, width) * (view - s)
        return density(s / width) / width * seen_and_lit(0.0, width) * onward

    found = quad(first, max(-sun, -8.0), min(view, 8.0), epsabs=1e-12, limit=200)[0]
    return found / (density(slope) * seen_and_lit(0.0, 1.0))


@pytest.mark.parametrize(("slope", "view", "sun"), [(0.0, 0.4, 0.4), (-0.6, 0.4, 1.6), (0.3, 1.4, 0.8), (-1.0, 0.2, 3.0), (-0.2, 2.0, 2.4)])
def test_facets_seen_and_lit_of_two_bands_by_quadrature(slope, view, sun):
    """Legs so high over a sea so rough that the coupling has 0.55 of the bands beyond the first: just one more."""
    assert coupled_bands(np.array(view), np.array(sun), 1.0 + 1.0 / 0.55, 0.2) == pytest.approx(2.0)
    alone = [float(nested_ratio(s, np.arctan(1.0 / edge), 1.0, 2)) for s, edge in ((slope, view), (-slope, sun))]
    found = alone[0] * alone[1] * np.exp(lit_exponent_kernel(slope, view, sun, coupling_table(1.0 + 1.0 / 0.55, 0.2)))
    assert found == pytest.approx(_two_bands_by_hand(slope, view, sun), rel=5e-3)


def test_low_legs_over_gentle_seas_have_one_band_together():
    """Shadows of both fall on the same facets: bands grow with both elevations alike, and with the slopes, up to a bound."""
    low, high = np.array([1e-3, 0.01, 0.1, 0.3]), np.array([0.5])
    for deviation in (0.05, 0.12, 0.3):
        bands = coupled_bands(low[:, None], low, 4.6, deviation)
        np.testing.assert_array_equal(bands, bands.T)
        assert np.all(np.diff(bands, axis=0) >= 0.0)
    assert coupled_bands(low[:1], low[:1], 4.6, 0.14) < 1.1
    assert coupled_bands(high, high, 4.6, 0.3) == pytest.approx(1.0 + 0.55 * 3.6)
    np.testing.assert_array_equal(coupled_bands(high, high, 1.0, 0.3), 1.0)


@pytest.mark.parametrize("slope", [-0.1, 0.0, 0.05])
def test_the_coupling_is_symmetric_in_viewer_and_sun(slope):
    table = coupling_table(4.3, 0.15)
    for view, sun in ((0.15, 0.6), (0.3, 2.0), (0.02, 0.1)):
        assert lit_exponent_kernel(slope, view, sun, table) == pytest.approx(
            lit_exponent_kernel(-slope, sun, view, table), rel=0.01, abs=2e-3
        )


@pytest.mark.parametrize("bands", [2, 3, 5])
def test_under_a_high_sun_all_that_is_seen_is_lit(bands):
    for slope, view in ((-1.0, 0.4), (0.0, 1.0), (0.1, 0.6)):
        assert lit_of_seen(slope, view, 6.0, bands) == pytest.approx(1.0, abs=0.01)


# Share of the mirroring facets seen that a Sun ahead lights, by rays on the same surface, flat Earth: eight seas, 1500 rays each, once.
# Standard error 0.02-0.03 of the value for 60-80 deg, 0.1 for 85 deg.
LIT = {1.0: (1.000, 0.823, 0.618, 0.187), 4.0: (1.000, 0.901, 0.745, 0.288), 10.0: (1.000, 0.955, 0.890, 0.556)}


@pytest.mark.parametrize("depression", LIT)
def test_facets_lit_of_those_seen_are_those_of_brute_force(depression):
    sigma, low = np.sqrt(SURFACE.mss_up), np.radians(depression)
    view = np.tan(low) / sigma
    lambda_view = float(smith_lambda(view / np.sqrt(2.0)))
    for zenith, expected in zip((60.0, 77.0, 80.0, 85.0), LIT[depression], strict=True):
        sun = np.tan(np.radians(90.0 - zenith)) / sigma
        lambda_sun = float(smith_lambda(sun / np.sqrt(2.0)))
        slope = (np.sin(np.radians(zenith)) - np.cos(low)) / (np.sin(low) + np.cos(np.radians(zenith))) / sigma
        smith = (1.0 + lambda_view) / (1.0 + lambda_view + lambda_sun)
        # the mirror tilts to the viewer where the Sun is higher
        share = smith * lit_of_seen(slope, view, sun)
        assert share == pytest.approx(expected, abs=0.06)


def test_one_band_is_smiths():
    assert coupling_table(1.0, 0.15).size == 0
    assert lit_of_seen(-0.3, 0.5, 0.7, 1) == 1.0


@pytest.mark.parametrize("nodes", [0, 1])
@pytest.mark.parametrize(("view", "sun"), [(0.0, 0.0), (0.5, 0.7), (9.0, 0.2), (9.0, 9.0)])
def test_an_empty_table_and_its_stand_in_couple_nothing(nodes: int, view: float, sun: float) -> None:
    """What lies behind them in memory is never read."""
    around = np.full((64, 64, 64), 5.0)
    around[0, 0, 0] = 0.0
    assert lit_exponent_kernel(-0.3, view, sun, around[:nodes, :nodes, :nodes]) == 0.0


@pytest.mark.parametrize(("mu", "t"), [(0.3, -0.5), (1.0, 0.2), (2.5, -1.0)])
def test_the_quick_exponent_is_the_ratios(mu, t):
    assert np.exp(nested_exponent_kernel(t, mu, 1.0, ratio_table(5))) == pytest.approx(
        float(nested_ratio(t, np.arctan(1.0 / mu), 1.0)), abs=1e-3
    )


@pytest.mark.parametrize("slopes", [cox_munk_gram_charlier(12.0, 0.7), cox_munk_anisotropic(12.0, 0.7)], ids=["skewed", "gaussian"])
@pytest.mark.parametrize(("zenith", "azimuth"), [(86.0, 0.0), (89.0, 2.5), (78.0, 4.0)])
def test_visible_slopes_of_any_density_add_up_to_one(slopes, zenith, azimuth):
    """The area that normalises the nested density, by a sum over the plane of slopes."""
    theta, bands = np.radians(zenith), 4.7
    axis = np.linspace(-7.0, 7.0, 561)
    up, cross = np.meshgrid(np.sqrt(slopes.mss_up) * axis, np.sqrt(slopes.mss_cross) * axis)
    cell = (up[0, 1] - up[0, 0]) * (cross[1, 0] - cross[0, 0])
    wind = slopes.wind_to_azimuth
    east, north = up * np.sin(wind) + cross * np.cos(wind), up * np.cos(wind) - cross * np.sin(wind)
    along = east * np.sin(azimuth) + north * np.cos(azimuth)
    ratio = nested_ratio(along, theta, slopes.mss_along(azimuth), bands)
    visible = slopes.density(east, north) * ratio * np.maximum(np.cos(theta) - np.sin(theta) * along, 0.0)
    # 2e-3: the negative part of the series counts without the ratio
    assert visible.sum() * cell == pytest.approx(float(nested_area(theta, azimuth, slopes, bands)), rel=2e-3)
