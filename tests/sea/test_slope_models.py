"""Slope models beyond the Gaussian: moments by quadrature, published coefficients, the sign of skewness, ranges."""

import numpy as np
import pytest
from shadowing_laws import clipped_mass

from seaglint.base.errors import DomainError
from seaglint.sea.slopes.breon_henriot import breon_henriot
from seaglint.sea.slopes.cox_munk import cox_munk_anisotropic, cox_munk_gram_charlier, cox_munk_slick
from seaglint.sea.slopes.from_spectrum import spectrum_slopes
from seaglint.sea.slopes.slope_statistics import SlopeStatistics
from seaglint.sea.spectra.elfouhaily import ElfouhailySpectrum
from seaglint.sea.spectra.pierson_moskowitz import PiersonMoskowitzSpectrum
from seaglint.sea.wind_profile import wind_at_height

SERIES = [cox_munk_gram_charlier, cox_munk_slick, breon_henriot]


def moments(slopes, powers):
    """Moments of standardised slopes (towards where the wind comes FROM, across) by a sum over the plane of east and north slopes."""
    s = np.linspace(-9.0, 9.0, 1201) * np.sqrt(max(slopes.mss_up, slopes.mss_cross))
    east, north = np.meshgrid(s, s)
    wind_from = slopes.wind_to_azimuth + np.pi
    eta = (east * np.sin(wind_from) + north * np.cos(wind_from)) / np.sqrt(slopes.mss_up)
    xi = (east * np.cos(wind_from) - north * np.sin(wind_from)) / np.sqrt(slopes.mss_cross)
    p = slopes.density(east, north) * (s[1] - s[0]) ** 2
    assert np.all(p >= 0.0)
    return [float((p * eta**up * xi**across).sum()) for up, across in powers]


@pytest.mark.parametrize("model", SERIES)
def test_moments_are_the_coefficients(model):
    """Hermite orthogonality: where no value is clipped, each coefficient is a cumulant of the density; no two may be swapped."""
    slopes = model(5.0, 0.7)
    assert clipped_mass(slopes) == 0.0
    powers = [(0, 0), (1, 0), (0, 1), (2, 0), (0, 2), (3, 0), (1, 2), (4, 0), (0, 4), (2, 2)]
    c21, c03, c40, c22, c04 = slopes.coefficients
    expected = [1.0, 0.0, 0.0, 1.0, 1.0, -c03, -c21, 3.0 + c04, 3.0 + c40, 1.0 + c22]
    assert moments(slopes, powers) == pytest.approx(expected, abs=1e-9)  # a smooth sum over nine deviations


@pytest.mark.parametrize("wind", [1.0, 13.0, pytest.param(10.0, marks=pytest.mark.validation)])
@pytest.mark.parametrize("model", SERIES)
def test_densities_integrate_to_one(model, wind):
    slopes = model(wind, 2.0)
    (mass,) = moments(slopes, [(0, 0)])
    assert mass == pytest.approx(1.0, abs=1e-3)  # what is promised where nothing is clipped; the clipped mass here is below 3e-4
    assert mass - 1.0 == pytest.approx(clipped_mass(slopes), abs=1e-6)  # two grids


def test_clipping_adds_what_the_docs_say():
    at = [clipped_mass(cox_munk_gram_charlier(w, 0.0, height=12.5, extrapolate=True)) for w in (10.0, 15.0, 20.0)]
    assert at == pytest.approx([8.4e-6, 6.1e-4, 2.2e-3], rel=0.05)  # two digits in the docs
    assert clipped_mass(breon_henriot(15.0, 0.0)) < 1e-4


@pytest.mark.parametrize("model", [cox_munk_gram_charlier, breon_henriot])
def test_lee_faces_are_the_steep_ones(model):
    """Wind blowing to the east: the lee face falls to the east, so steep negative east slopes are more frequent than positive ones."""
    slopes = model(10.0, np.pi / 2)
    steep = 2.5 * np.sqrt(slopes.mss_up)
    assert slopes.density(-steep, 0.0) > 1.5 * slopes.density(steep, 0.0)
    # and the commonest slope leans gently the other way
    s = np.linspace(-0.1, 0.1, 2001)
    assert s[np.argmax(slopes.density(s, 0.0))] > 0.0


def test_cox_munk_series_as_printed():
    """By hand at 10 m/s and 12.5 m."""
    slopes = cox_munk_gram_charlier(10.0, 0.3, height=12.5)
    assert (slopes.mss_up, slopes.mss_cross) == pytest.approx((0.0316, 0.0222), rel=1e-12)
    assert slopes.coefficients == pytest.approx((-0.076, -0.29, 0.40, 0.12, 0.23), rel=1e-12)
    slick = cox_munk_slick(10.0, 0.3, height=12.5)
    assert (slick.mss_up, slick.mss_cross) == pytest.approx((0.0128, 0.0114), rel=1e-12)
    assert slick.coefficients == pytest.approx((0.0, 0.02, 0.36, 0.10, 0.26), rel=1e-12)


def test_breon_henriot_as_printed():
    """By hand at 7 m/s, the middle of the sigmoid, and at 14 m/s, where it is over (exp(-7) = 9e-4)."""
    slopes = breon_henriot(7.0, 0.3)
    assert (slopes.mss_up, slopes.mss_cross) == pytest.approx((0.02312, 0.01595), rel=1e-12)
    assert slopes.coefficients == pytest.approx((-0.04459, -0.225, 0.3, 0.12, 0.4), rel=1e-12)
    assert breon_henriot(14.0, 0.0).c03 == pytest.approx(-0.45, rel=1e-3)


def test_wind_is_carried_to_the_height_of_each_fit():
    assert breon_henriot(wind_at_height(8.0, 19.5), 0.0, height=19.5).mss == pytest.approx(breon_henriot(8.0, 0.0).mss, rel=1e-8)
    assert cox_munk_slick(8.0, 0.0) == cox_munk_slick(wind_at_height(8.0, 12.5), 0.0, height=12.5)


def test_the_series_stands_on_the_gaussian_of_the_same_fit():
    series, gaussian = cox_munk_gram_charlier(9.0, 1.0), cox_munk_anisotropic(9.0, 1.0)
    assert series.gaussian() == gaussian
    assert gaussian.is_gaussian
    assert not series.is_gaussian
    assert not series.is_isotropic


def test_a_series_needs_width_both_ways():
    assert cox_munk_gram_charlier(0.0, 1.0) == cox_munk_anisotropic(0.0, 1.0)
    with pytest.raises(DomainError, match="along and across the wind"):
        SlopeStatistics(0.0, 0.01, c40=0.4)
    with pytest.raises(DomainError, match="finite"):
        SlopeStatistics(0.01, 0.01, c40=np.nan)
    # a round Gaussian with a series is not the same in all directions
    assert not SlopeStatistics(0.01, 0.01, c03=-0.1).is_isotropic


@pytest.mark.parametrize(("model", "highest"), [(cox_munk_gram_charlier, 20.0), (cox_munk_slick, 14.0), (breon_henriot, 15.0)])
def test_winds_outside_each_fit_are_refused(model, highest):
    assert model(highest, 0.0).mss > 0.0
    assert model(highest + 1.0, 0.0, extrapolate=True).mss > model(highest, 0.0).mss
    for wind in (-1.0, np.nan, highest + 0.01):
        with pytest.raises(DomainError, match=f"0-{highest:g} m/s of the .* fit"):
            model(wind, 0.0)


@pytest.mark.parametrize(("wind", "variance"), [(5.0, 0.0323), (10.0, 0.0624), (15.0, 0.0855)])
def test_slopes_of_the_elfouhaily_spectrum(wind, variance):
    """Against an independent integration of the same formulas."""
    slopes = spectrum_slopes(ElfouhailySpectrum(wind, 1.2))
    assert slopes.mss == pytest.approx(variance, rel=5e-3)  # three digits
    assert slopes.mss_up > slopes.mss_cross
    assert slopes.wind_to_azimuth == 1.2
    assert slopes.is_gaussian


@pytest.mark.parametrize("spectrum", [ElfouhailySpectrum(8.0, 0.5), PiersonMoskowitzSpectrum.of_u10(8.0, 0.5)], ids=["elfouhaily", "pm"])
def test_covariance_is_that_of_the_directional_spectrum(spectrum):
    """Sum of k k^T Psi over polar rings, from the two-dimensional density alone."""
    low, high = spectrum.wavenumber_range
    edges = np.linspace(np.log(low), np.log(high), 3001)
    k = np.exp(0.5 * (edges[1:] + edges[:-1]))[:, None]
    phi = (np.arange(90) + 0.5) * 2.0 * np.pi / 90
    weight = spectrum.density(k * np.sin(phi), k * np.cos(phi)) * k**4 * (edges[1] - edges[0]) * 2.0 * np.pi / 90
    parts = [float((weight * a * b).sum()) for a, b in ((np.sin(phi),) * 2, (np.sin(phi), np.cos(phi)), (np.cos(phi),) * 2)]
    assert spectrum_slopes(spectrum).covariance() == pytest.approx(parts, rel=2e-3, abs=1e-6)  # midpoints in log k
