"""Wind profile and slope statistics: published numbers and moments taken by quadrature."""

import numpy as np
import pytest

from seaglint.base.errors import DomainError
from seaglint.sea.slopes.cox_munk import cox_munk_anisotropic, cox_munk_isotropic
from seaglint.sea.slopes.slope_statistics import SlopeStatistics, flat
from seaglint.sea.wind_profile import friction_velocity, roughness_length, u10_of_wind, wind_at_height


def slope_plane(half_width=2.5, n=1001):
    s = np.linspace(-half_width, half_width, n)
    return *np.meshgrid(s, s), (s[1] - s[0]) ** 2


@pytest.mark.parametrize("u10", [1.0, 5.0, 10.0, 20.0])
def test_wind_profile_passes_through_its_own_roughness_and_ten_metres(u10):
    assert wind_at_height(u10, 10.0) == pytest.approx(u10, rel=1e-12)
    # u* from two heights of the profile, independent of z0
    slope = (wind_at_height(u10, 20.0) - wind_at_height(u10, 5.0)) / np.log(4.0)
    assert slope * 0.41 == pytest.approx(friction_velocity(u10), rel=1e-10)
    assert 1e-6 < roughness_length(u10) < 1e-2
    assert u10_of_wind(wind_at_height(u10, 19.5), 19.5) == pytest.approx(u10, rel=1e-9)


def test_no_wind_means_no_stress():
    assert friction_velocity(0.0) == 0.0
    assert wind_at_height(0.0, 19.5) == 0.0
    assert u10_of_wind(0.0, 19.5) == 0.0


def test_drag_coefficient_is_that_of_the_open_sea():
    # 1.2-1.8e-3 at 10 m/s in every review of open-sea drag
    assert 1.2e-3 < (friction_velocity(10.0) / 10.0) ** 2 < 1.8e-3


@pytest.mark.parametrize("wind", [-1.0, np.nan, np.inf, 20.001])
@pytest.mark.parametrize("model", [cox_munk_isotropic, lambda w: cox_munk_anisotropic(w, 0.0)])
def test_winds_outside_the_fit_are_refused(model, wind):
    with pytest.raises(DomainError, match="Cox-Munk"):
        model(wind)


def test_extrapolation_must_be_asked_for():
    assert cox_munk_isotropic(25.0, height=12.5, extrapolate=True).mss == pytest.approx(0.131, rel=1e-9)


@pytest.mark.parametrize(("wind", "upwind", "crosswind"), [(5.0, 0.0158, 0.0126), (10.0, 0.0316, 0.0222), (14.0, 0.04424, 0.02988)])
def test_cox_munk_at_its_own_height(wind, upwind, crosswind):
    slopes = cox_munk_anisotropic(wind, 0.3, height=12.5)
    assert (slopes.mss_up, slopes.mss_cross) == pytest.approx((upwind, crosswind), rel=1e-9)


def test_wind_is_carried_to_the_anemometer_height_of_the_fit():
    ten = cox_munk_isotropic(10.0)
    as_is = cox_munk_isotropic(10.0, height=12.5)
    assert ten.mss == pytest.approx(0.003 + 0.00512 * wind_at_height(10.0, 12.5), rel=1e-9)
    assert 1.01 < ten.mss / as_is.mss < 1.03


@pytest.mark.parametrize("slopes", [cox_munk_isotropic(10.0), cox_munk_anisotropic(12.0, np.radians(30.0)), cox_munk_anisotropic(1.5, 4.0)])
def test_density_has_unit_integral_and_the_stated_moments(slopes):
    east, north, cell = slope_plane()
    p = slopes.density(east, north) * cell
    assert p.sum() == pytest.approx(1.0, abs=1e-6)  # grid far finer and wider than sigma
    see, sen, snn = (p * east * east).sum(), (p * east * north).sum(), (p * north * north).sum()
    assert (see, sen, snn) == pytest.approx(slopes.covariance(), abs=1e-6)
    azimuth = 0.7
    along = np.sin(azimuth) * east + np.cos(azimuth) * north
    assert (p * along**2).sum() == pytest.approx(float(slopes.mss_along(azimuth)), abs=1e-6)


def test_upwind_is_the_rough_direction():
    slopes = cox_munk_anisotropic(10.0, np.pi / 2)  # the wind blows to the east
    see, _, snn = slopes.covariance()
    assert see == pytest.approx(slopes.mss_up)
    assert see > snn
    assert slopes.density(0.4, 0.0) > slopes.density(0.0, 0.4)


def test_a_flat_sea_has_no_density_and_says_so():
    assert flat().is_flat
    assert flat().is_isotropic
    with pytest.raises(DomainError, match="mirror"):
        flat().density(0.0, 0.0)


@pytest.mark.parametrize("variances", [(-0.1, 0.1), (np.nan, 0.1), (0.1, np.inf)])
def test_impossible_variances_are_refused(variances):
    with pytest.raises(DomainError, match="variances"):
        SlopeStatistics(*variances)
