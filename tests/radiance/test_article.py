import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from seaglint.air.isothermal import IsothermalAtmosphere
from seaglint.air.vacuum import VacuumAtmosphere
from seaglint.facet.legs import VIEWER
from seaglint.facet.sea_view import SeaView
from seaglint.optics import sea_water
from seaglint.optics.band import Band
from seaglint.radiance.article import ArticleAtmosphere, article_radiance, wavelength_mean
from seaglint.radiance.mean_radiance import mean_radiance
from seaglint.sea.slopes.cox_munk import cox_munk_isotropic
from seaglint.studies.build.profile_air import model_air

BAND = Band.rectangular(3.5, 5.0)


class GreyAirWithSun(IsothermalAtmosphere):
    """Air without lines, sunlight as outside the atmosphere."""

    def solar_irradiance(self, solar_zenith):
        return VacuumAtmosphere(self.wavenumber_cm).solar_irradiance(solar_zenith)


def _view(atmosphere, **changes):
    inputs = {
        "atmosphere": atmosphere,
        "band": BAND,
        "water": sea_water.article(),
        "slopes": cox_munk_isotropic(10.0, height=12.5),
        "sea_temperature": 288.15,
        "sensor_height": 100.0,
        "solar_zenith": np.radians(77.0),
        "shadowing": VIEWER,
        "background": "blackbody",
    }
    return SeaView(**(inputs | changes))


def test_white_furnace_stays_flat_through_the_interpolators():
    total = article_radiance(_view(IsothermalAtmosphere.for_band(288.15, 3.5, 5.0)), np.radians(np.linspace(5.0, -90.0, 60)), [0.0]).total
    np.testing.assert_allclose(total, BAND.radiance(288.15, IsothermalAtmosphere.for_band(288.15, 3.5, 5.0).wavenumber_cm), rtol=1e-9)


@given(st.floats(1e-6, 3e-4))
def test_polynomial_of_eq_9_finds_beers_law(extinction):
    atmosphere = IsothermalAtmosphere.for_band(288.15, 3.5, 5.0, extinction)
    air = ArticleAtmosphere.fit(atmosphere, BAND, 100.0, 288.15)
    np.testing.assert_allclose(air.coefficients, [0.0, -1e3 * extinction, 0.0, 0.0], atol=1e-6)
    assert air.transmittance(7000.0) == pytest.approx(np.exp(-extinction * 7000.0), rel=1e-6)  # rounding of the fit


def test_where_nothing_has_lines_band_means_are_the_integral():
    view = _view(GreyAirWithSun.for_band(288.15, 3.5, 5.0, 5e-5))
    elevation, azimuth = -np.radians([0.7, 2.0, 8.0, 30.0]), np.radians([0.0, 10.0])
    means, integral = article_radiance(view, elevation, azimuth), mean_radiance(view, elevation, azimuth)
    # the reflectance varies with wavelength a little, through k = a lambda / 4 pi, and sunlight is not flat
    np.testing.assert_allclose(means.sun, integral.sun, rtol=2e-3)
    np.testing.assert_allclose(means.path + means.emission, integral.path + integral.emission, rtol=1e-4)  # spline in ln range


@pytest.mark.parametrize("depression", [1.0, 2.0, 5.0])
def test_band_means_miss_the_common_lines_of_sunlight_and_path(depression):
    view = _view(model_air("midlatitude-summer", 10.0, (3.5, 5.0)))
    means = article_radiance(view, [-np.radians(depression)], [0.0])
    integral = mean_radiance(view, [-np.radians(depression)], [0.0])
    assert 1.1 < float(integral.sun[0, 0] / means.sun[0, 0]) < 2.1  # 5-95 % of random cases in 3-5 um
    assert means.path + means.emission == pytest.approx(integral.path + integral.emission, rel=2e-3)


def test_wavelength_mean_is_flat_over_wavelength():
    grid = np.arange(1980.0, 2900.0, 5.0)
    mean = wavelength_mean(BAND.weights(grid), grid)
    assert mean.sum() == pytest.approx(1.0)
    assert mean @ (1e4 / grid) == pytest.approx(4.25, rel=1e-5)  # middle of 3.5-5 um; trapezoid on 5 cm-1


def test_sun_below_the_horizon_leaves_the_boundary_radiance():
    view = _view(model_air("midlatitude-summer", 5.0, (3.5, 5.0)), solar_zenith=np.radians(100.0))
    assert np.all(article_radiance(view, [-0.05], [0.0]).sun == 0.0)
