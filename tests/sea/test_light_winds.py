"""Slopes in light winds: no direction in a calm, no step on the way to it, the published fits above."""

import numpy as np
import pytest

from seaglint.sea.shadowing.facet_lean import bands_along, lean_gains
from seaglint.sea.slopes.breon_henriot import breon_henriot
from seaglint.sea.slopes.cox_munk import cox_munk_anisotropic, cox_munk_gram_charlier, cox_munk_isotropic, cox_munk_slick
from seaglint.sea.slopes.from_spectrum import nested_in
from seaglint.sea.slopes.slope_statistics import SlopeStatistics
from seaglint.sea.spectra.jonswap import JonswapSpectrum

# variances along and across a wind at the height of each fit, Gram-Charlier coefficients, and the wind from which both are as published
PUBLISHED = {
    cox_munk_anisotropic: (lambda w: (0.00316 * w, 0.003 + 0.00192 * w, 0.0, 0.0, 0.0, 0.0, 0.0), 12.5, 2.42),
    cox_munk_gram_charlier: (
        lambda w: (0.00316 * w, 0.003 + 0.00192 * w, 0.01 - 0.0086 * w, 0.04 - 0.033 * w, 0.40, 0.12, 0.23),
        12.5,
        2.42,
    ),
    cox_munk_slick: (lambda w: (0.005 + 0.00078 * w, 0.003 + 0.00084 * w, 0.0, 0.02, 0.36, 0.10, 0.26), 12.5, 1.99),
    breon_henriot: (
        lambda w: (0.001 + 0.00316 * w, 0.003 + 0.00185 * w, -9.1e-4 * w**2, -0.45 / (1.0 + np.exp(7.0 - w)), 0.3, 0.12, 0.4),
        10.0,
        1.53,
    ),
}
LAWS = list(PUBLISHED)


def numbers(slopes: SlopeStatistics) -> np.ndarray:
    return np.array([slopes.mss_up, slopes.mss_cross, *slopes.coefficients])


@pytest.mark.parametrize("law", LAWS)
def test_a_calm_has_no_direction(law):
    """The density is that of a round Gaussian, wherever no wind comes from; the residual is the total of the fit at 0 m/s."""
    directions = [law(0.0, to) for to in (0.0, 0.7, 4.0)]
    s = np.linspace(-0.15, 0.15, 31)
    densities = [slopes.density(*np.meshgrid(s, s)) for slopes in directions]
    assert all(slopes.is_isotropic for slopes in directions)
    assert directions[0].mss == pytest.approx(0.004 if law is breon_henriot else 0.003, rel=1e-12)
    for density in densities:
        np.testing.assert_allclose(density, densities[0], rtol=1e-12)
        np.testing.assert_allclose(density, density[:, ::-1], rtol=1e-9)
        np.testing.assert_allclose(density, density.T, rtol=1e-9)
    assert not lean_gains(directions[1]).any()


@pytest.mark.parametrize("law", LAWS)
def test_fits_are_as_published_from_the_joining_wind_on(law):
    published, height, join = PUBLISHED[law]
    for wind in np.random.default_rng(3).uniform(join + 0.01, 14.0, 20):
        slopes = law(wind, 0.3, height=height)
        np.testing.assert_allclose(numbers(slopes), published(wind), rtol=1e-12)
        assert slopes.directed is None


@pytest.mark.parametrize("law", LAWS)
def test_light_winds_pass_into_a_calm_without_a_step(law):
    """Small steps of the wind change variances and coefficients by the slopes of the published lines at most, twice to spare."""
    height, join = PUBLISHED[law][1:]
    winds = np.concatenate([[0.0], np.sort(np.random.default_rng(4).uniform(0.0, 1.5 * join, 400)), [0.4999, 0.5001]])
    winds.sort()
    rows = np.array([numbers(law(wind, 0.3, height=height)) for wind in winds])
    rates = np.abs(np.diff(rows, axis=0)) / np.diff(winds)[:, None]
    assert rates[:, :2].max() < 2.0 * 0.00316
    assert rates[:, 2:].max() < 2.0 * 0.4 / join
    assert np.all(rows[:, 0] >= rows[:, 1] - 1e-15), "no sea is rougher across the wind than along it"
    assert np.all(np.diff(rows[:, :2], axis=0) > 0.0), "more wind makes more slopes"


def test_totals_stay_those_of_the_fits():
    """Slope variance moves from one direction to the other; none is lost."""
    for wind in (0.0, 0.3, 1.1, 2.0):
        assert cox_munk_gram_charlier(wind, 0.4, height=12.5).mss == pytest.approx(0.003 + 0.00508 * wind, rel=1e-12)
        assert breon_henriot(wind, 0.4).mss == pytest.approx(0.004 + 0.00501 * wind, rel=1e-12)
    assert cox_munk_anisotropic(0.0, 0.4).mss == cox_munk_isotropic(0.0).mss


def test_a_film_never_makes_waves():
    for wind in np.linspace(0.0, 14.0, 57):
        slick, clean = cox_munk_slick(wind, 0.0, height=12.5), cox_munk_anisotropic(wind, 0.0, height=12.5)
        assert slick.mss_up <= clean.mss_up * (1.0 + 1e-12)
        assert slick.mss_cross <= clean.mss_cross * (1.0 + 1e-12)


def test_swell_keeps_its_direction_in_a_calm():
    """Slopes without direction in all are nested in a swell that has one, and its lean is that of the swell alone."""
    calm = cox_munk_anisotropic(0.0, 0.0)
    swell = JonswapSpectrum(0.5, 9.0, np.radians(60.0), width=np.radians(12.0), wind_to_azimuth=0.0)
    nested = nested_in(calm, None, swell)
    up, cross, both = nested.nesting[-1][1:]
    assert (up, cross, both) == pytest.approx((0.0015, 0.0015, 0.0), abs=1e-12)
    (up, cross, both), total = (np.array(nested.nesting)[10, 1:], sum(swell.mss(nested.nesting[10][0])))
    assert up + cross == pytest.approx(total, rel=0.05)  # ripples of the longest lengths are a few parts in a hundred
    assert np.degrees(0.5 * np.arctan2(2.0 * both, up - cross)) == pytest.approx(60.0, abs=3.0)
    assert np.abs(lean_gains(nested)).max() > 0.02
    assert bands_along(nested_in(calm, None), 0.4) == pytest.approx(bands_along(nested_in(calm, None), 1.9), abs=1e-9)


@pytest.mark.parametrize("wind", [0.05, 0.2, 0.45, 0.5, 0.9])
def test_the_direction_of_long_waves_fades_below_the_lightest_wind_of_wind_seas(wind: float) -> None:
    """Winds are at 10 m; the fits of Cox and Munk, at 12.5 m, follow the same share within 0.3 %: the profile is not quite linear."""
    share = min(wind / 0.5, 1.0)
    for law in (cox_munk_anisotropic, cox_munk_gram_charlier, cox_munk_slick, breon_henriot):
        assert law(wind, 1.0).directed == pytest.approx(share, rel=5e-3), law.__name__
