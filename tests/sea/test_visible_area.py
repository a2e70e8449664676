"""Projected area, Lambda and the average over facets for slope densities that are not Gaussian, against sums over the slope plane."""

import numpy as np
import pytest
from shadowing_laws import bistatic, slope_lambda

from seaglint.facet.emissivity import emissivity, facet_nodes
from seaglint.optics.fresnel import reflectance
from seaglint.optics.sea_water import hale_querry_sea
from seaglint.sea.shadowing.smith import projected_area, smith_lambda, smith_nu, visible_area
from seaglint.sea.slopes.breon_henriot import breon_henriot
from seaglint.sea.slopes.cox_munk import cox_munk_anisotropic, cox_munk_gram_charlier, cox_munk_isotropic, cox_munk_slick
from seaglint.sea.slopes.from_spectrum import spectrum_slopes
from seaglint.sea.slopes.slope_statistics import SlopeStatistics
from seaglint.sea.spectra.elfouhaily import ElfouhailySpectrum

WIND_TO = np.radians(70.0)
MODELS = {
    "series": cox_munk_gram_charlier(8.0, WIND_TO),
    "series-clipped": cox_munk_gram_charlier(20.0, WIND_TO),
    "slick": cox_munk_slick(8.0, WIND_TO),
    "breon-henriot": breon_henriot(14.0, WIND_TO),
    "anisotropic": cox_munk_anisotropic(10.0, WIND_TO),
    "isotropic": cox_munk_isotropic(10.0),
    "spectrum": spectrum_slopes(ElfouhailySpectrum(10.0, WIND_TO)),
}
every_model = pytest.mark.parametrize("slopes", MODELS.values(), ids=MODELS.keys())
ZENITHS = np.radians([0.0, 30.0, 60.0, 80.0, 88.0, 90.0, 91.0, 93.0])
AZIMUTHS = np.radians([70.0, 95.0, 160.0, 217.0, 250.0, -20.0])


def plane(slopes, zenith, azimuth, n=1401):
    """Slopes on a square grid, their density times cell, and the cosine of the view on each facet times the facet's own area."""
    s = np.linspace(-9.0, 9.0, n) * np.sqrt(max(slopes.mss_up, slopes.mss_cross))
    east, north = np.meshgrid(s, s)
    p = slopes.density(east, north) * (s[1] - s[0]) ** 2
    seen = np.cos(zenith) - np.sin(zenith) * (east * np.sin(azimuth) + north * np.cos(azimuth))
    return east, north, p, np.maximum(seen, 0.0)


@every_model
def test_area_is_the_sum_over_the_density(slopes):
    """Negative parts of a series count as 0 in both, so that dividing by the area conserves energy to 1e-4."""
    ours = visible_area(ZENITHS[:, None], AZIMUTHS, slopes)
    east, north, p, _ = plane(slopes, 0.0, 0.0, 801)
    keep = p > 1e-12
    east, north, p = east[keep], north[keep], p[keep]
    for j in (0, 1, 3, 4):
        along = east * np.sin(AZIMUTHS[j]) + north * np.cos(AZIMUTHS[j])
        area = [(p * np.maximum(np.cos(z) - np.sin(z) * along, 0.0)).sum() for z in ZENITHS]
        assert ours[:, j] == pytest.approx(area, rel=2e-5)  # the grid's kink and the table's interpolation; 1e-4 is promised


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(("turn_deg", "excess", "deviation"), [(0.0, 0.26, "mss_up"), (90.0, 0.36, "mss_cross")])
def test_area_at_the_horizon_by_hand(turn_deg, excess, deviation, sign):
    """``sigma_1/sqrt(2 pi) (1 - h4/24)``: skewness has no say there; up and cross have each their own peakedness."""
    slopes = MODELS["slick"]
    expected = np.sqrt(getattr(slopes, deviation) / (2.0 * np.pi)) * (1.0 - excess / 24.0)
    assert visible_area(np.pi / 2, WIND_TO + sign * np.radians(turn_deg), slopes) == pytest.approx(expected, rel=1e-9)


@every_model
def test_area_at_the_horizon_is_ergodic_within_five_per_cent(slopes):
    zeisse = np.sqrt(slopes.mss_along(AZIMUTHS) / (2.0 * np.pi))
    assert visible_area(np.pi / 2, AZIMUTHS, slopes) == pytest.approx(zeisse, rel=0.05)


def test_gaussian_seas_keep_their_closed_forms():
    slopes = MODELS["anisotropic"]
    along = slopes.mss_along(AZIMUTHS)
    theta = ZENITHS[:, None]
    assert np.array_equal(visible_area(theta, AZIMUTHS, slopes), projected_area(theta, along))
    assert np.array_equal(slope_lambda(theta, AZIMUTHS, slopes), smith_lambda(smith_nu(theta, along)))
    round_sea = MODELS["isotropic"]
    assert visible_area(theta, AZIMUTHS, round_sea).shape == (8, 6)
    assert np.array_equal(slope_lambda(ZENITHS, 0.0, round_sea), smith_lambda(smith_nu(ZENITHS, round_sea.mss_up)))


def test_a_series_without_coefficients_is_the_gaussian():
    """Coefficients far too small to matter take the other branch and give the same."""
    base = MODELS["anisotropic"]
    almost = SlopeStatistics(base.mss_up, base.mss_cross, base.wind_to_azimuth, c40=1e-12)
    assert visible_area(ZENITHS[:, None], AZIMUTHS, almost) == pytest.approx(visible_area(ZENITHS[:, None], AZIMUTHS, base), rel=1e-9)


@every_model
def test_lambda_and_area_are_one(slopes):
    theta = np.radians([5.0, 60.0, 85.0, 89.9])[:, None]
    lam = slope_lambda(theta, AZIMUTHS, slopes)
    assert np.cos(theta) * (1.0 + lam) == pytest.approx(visible_area(theta, AZIMUTHS, slopes), rel=1e-12)
    assert np.all(np.isinf(slope_lambda(np.radians([90.5, 92.0]), 0.3, slopes)))
    share = bistatic(lam, lam[::-1], 2.0)
    assert np.all((share > 0.0) & (share <= 1.0 + 1e-12))


def test_steep_lee_faces_are_seen_from_downwind():
    """Of what a viewer downwind sees, more is facets that face him steeply than from upwind."""
    slopes, zenith = MODELS["series"], np.radians(70.0)
    # rays mirrored from high above belong to the facets that face the viewer most steeply
    high = zenith - 2.0 * np.arctan(2.5 * np.sqrt(slopes.mss_up))
    lee, windward = (facet_nodes(zenith, slopes, WIND_TO + turn) for turn in (0.0, np.pi))
    assert lee.weight[lee.reflected_zenith < high].sum() > 1.3 * windward.weight[windward.reflected_zenith < high].sum()


@every_model
@pytest.mark.parametrize("zenith_deg", [0.0, 45.0, 75.0, 89.0, 90.0, 90.5])
def test_energy_is_conserved(slopes, zenith_deg):
    """Weights add up to 1 and none is negative; what is emitted and what mirrors the sky, over a water that reflects all, is everything."""
    nodes = facet_nodes(np.radians(zenith_deg), slopes, 0.4)
    assert nodes.weight.sum() == pytest.approx(1.0, abs=1e-12)
    assert np.all(nodes.weight >= 0.0)
    theta, index = np.radians(zenith_deg), hale_querry_sea().index([2500.0])
    to_sky = (np.where(nodes.meets_sea, 0.0, nodes.weight) * reflectance(nodes.cos_incidence, index[0])).sum()
    assert emissivity(theta, slopes, hale_querry_sea(), [2500.0], view_azimuth=0.4)[0] + to_sky == pytest.approx(1.0, abs=1e-6)


@pytest.mark.parametrize("turn_deg", [40.0, 180.0, *(pytest.param(t, marks=pytest.mark.validation) for t in (0.0, 90.0))])
@pytest.mark.parametrize("zenith_deg", [50.0, 85.0, *(pytest.param(z, marks=pytest.mark.validation) for z in (0.0, 90.0))])
@pytest.mark.parametrize("name", ["series", "series-clipped", "slick", "breon-henriot"])
def test_average_over_facets_equals_a_sum_over_the_plane(name, zenith_deg, turn_deg):
    slopes, theta, azimuth = MODELS[name], np.radians(zenith_deg), WIND_TO + np.radians(turn_deg)
    east, north, p, seen = plane(slopes, theta, azimuth, 1001)
    length = np.sqrt(1.0 + east**2 + north**2)
    c = np.clip(seen / length, 0.0, 1.0)
    lit = p * seen * (2.0 * c / length - np.cos(theta) >= 0.0)
    expected = 1.0 - (lit * reflectance(c, hale_querry_sea().index(2500.0))).sum() / (p * seen).sum()
    ours = emissivity(theta, slopes, hale_querry_sea(), [2500.0], view_azimuth=azimuth)[0]
    assert ours == pytest.approx(expected, abs=1.5e-4)  # 1e-4 where the series is clipped, and the grid's own two edges


def test_upwind_and_crosswind_views_differ():
    """Swapped variances, or azimuths turned by 90 degrees, fail here."""
    slopes = MODELS["series"]
    along, across = (float(visible_area(np.radians(88.0), WIND_TO + t, slopes)) for t in (0.0, np.pi / 2))
    assert slopes.mss_up > slopes.mss_cross
    assert along > 1.05 * across
