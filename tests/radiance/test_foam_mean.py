"""Mean radiance of a sea with foam."""

from dataclasses import replace

import numpy as np
import pytest
from render_scenes import BAND, SEA_TEMPERATURE, WarmSky, sea_view, table_air

from seaglint.air.isothermal import IsothermalAtmosphere
from seaglint.base.conventions import horizon_depression, view_zenith
from seaglint.facet.foam import FoamCover
from seaglint.optics.blackbody import planck_wavenumber
from seaglint.optics.foam_reflectance import BUBBLES, diffuse_reflectance, foam_emissivity
from seaglint.optics.fresnel import reflectance
from seaglint.radiance.foam_mean import FoamMean
from seaglint.radiance.mean_radiance import MeanModel, mean_radiance
from seaglint.radiance.variance import sea_variance
from seaglint.sea.slopes.cox_munk import cox_munk_anisotropic, cox_munk_gram_charlier, cox_munk_isotropic
from seaglint.sea.slopes.slope_statistics import flat

ELEVATION = np.concatenate([[0.2], -horizon_depression(30.0) - np.array([1e-5, 1e-3]), -np.radians([1.0, 3.0, 10.0, 40.0, 90.0])])
AZIMUTH = np.radians([-40.0, 0.0, 25.0, 150.0])
SEAS = {"flat": flat(), "isotropic": cox_munk_isotropic(10.0), "skewed": cox_munk_gram_charlier(10.0, 0.4)}


def _with(view, share):
    return replace(view, foam=FoamCover(share))


@pytest.mark.parametrize("slopes", SEAS.values(), ids=SEAS.keys())
@pytest.mark.parametrize("share", [0.02, 1.0])
def test_white_furnace_with_foam_is_flat(slopes, share):
    air = IsothermalAtmosphere.for_band(SEA_TEMPERATURE, BAND.min_um, BAND.max_um)
    total = mean_radiance(_with(sea_view(air, slopes), share), ELEVATION, AZIMUTH).total
    np.testing.assert_allclose(total, BAND.radiance(SEA_TEMPERATURE, air.wavenumber_cm), rtol=1e-10)


def test_every_component_is_linear_in_the_share():
    view = sea_view(table_air(10.0), cox_munk_anisotropic(10.0, 0.4), sun_zenith=70.0)
    none, some, all_foam = (mean_radiance(v, ELEVATION, AZIMUTH) for v in (view, _with(view, 0.25), _with(view, 1.0)))
    for name in ("path", "emission", "sky", "sunlight", "total", "chance"):
        water, foam = getattr(none, name), getattr(all_foam, name)
        np.testing.assert_allclose(getattr(some, name), 0.75 * water + 0.25 * foam, rtol=1e-12, atol=1e-15)
    np.testing.assert_array_equal(none.path, all_foam.path)


def test_no_foam_changes_no_bit():
    view = sea_view(table_air(10.0), cox_munk_anisotropic(10.0, 0.4), sun_zenith=70.0)
    none, dry = mean_radiance(view, ELEVATION, AZIMUTH), mean_radiance(_with(view, 0.0), ELEVATION, AZIMUTH)
    np.testing.assert_array_equal(none.total, dry.total)
    np.testing.assert_array_equal(none.sunlight, none.sun)


def test_smooth_foam_is_its_emissivity_times_planck_and_its_sky():
    """A flat sea of foam alone without air: emission and mirrored sky by the published law, put together by hand."""
    air = WarmSky.for_band(BAND.min_um, BAND.max_um)
    view = _with(sea_view(air, flat(), sun_zenith=120.0), 1.0)
    depression, nu = np.radians(5.0), air.wavenumber_cm
    theta = view_zenith(30.0, depression)
    got = mean_radiance(view, [-depression], [0.0])
    weights, water = BAND.weights(nu), view.water
    emitted = weights @ (foam_emissivity(np.cos(theta), nu, water) * planck_wavenumber(nu, SEA_TEMPERATURE))
    assert got.emission[0, 0] == pytest.approx(emitted, rel=1e-5)
    cosine = (np.arange(2000) + 0.5) / 2000
    sky = 2.0 / 2000 * (cosine @ air.sky_radiance(np.arccos(cosine), 0.0))
    mirrored = (1.0 - BUBBLES) * reflectance(np.cos(theta), water.index(nu)) * air.sky_radiance(theta, 0.0)
    assert got.sky[0, 0] == pytest.approx(weights @ (mirrored + diffuse_reflectance(nu, water) * sky), rel=1e-5)


def test_foam_emits_more_than_the_rough_sea_and_most_near_the_horizon():
    view = sea_view(table_air(10.0), cox_munk_isotropic(10.0), sun_zenith=120.0)
    excess = mean_radiance(_with(view, 1.0), ELEVATION[3:], [0.0]).emission - mean_radiance(view, ELEVATION[3:], [0.0]).emission
    assert excess.min() > 0.0
    assert excess[1, 0] > 5.0 * excess[-1, 0]  # 3 deg of depression against the nadir


def test_only_the_mirroring_share_sparkles():
    view = sea_view(table_air(10.0), cox_munk_isotropic(10.0), sun_zenith=70.0)
    variances = []
    for each in (view, _with(view, 0.5)):
        mean = mean_radiance(each, ELEVATION, AZIMUTH)
        variances.append(sea_variance(each, mean, ELEVATION, np.full(ELEVATION.size, 1e-6), 0.0026))
    water, foam = variances
    # glint is sparse: the variance of independent cells is proportional to their share
    bright = water > 1e-3 * water.max()
    np.testing.assert_allclose(foam[bright] / water[bright], 1.0 - 0.5 * BUBBLES, rtol=0.1)
    assert np.all(foam <= water)


def test_tables_of_large_maps_equal_line_by_line():
    view = _with(sea_view(table_air(10.0), cox_munk_anisotropic(10.0, 0.4), sun_zenith=80.0), 0.3)
    model, line = MeanModel.prepare(view), mean_radiance(view, ELEVATION, AZIMUTH)
    table = model.map(ELEVATION, AZIMUTH)
    # scattered sunlight towards a low Sun is interpolated within 1e-4 at the horizon
    np.testing.assert_allclose(table.total, line.total, rtol=1e-4)
    np.testing.assert_allclose(table.foam_sun, line.foam_sun, rtol=1e-4)
    rows, columns = np.meshgrid(ELEVATION, AZIMUTH, indexing="ij")
    along = model.along(rows.ravel(), columns.ravel())
    np.testing.assert_allclose(along.total[:, 0].reshape(rows.shape)[1:], table.total[1:], rtol=1e-12)
    np.testing.assert_allclose(along.foam_sun[:, 0].reshape(rows.shape), table.foam_sun, rtol=1e-12)


@pytest.mark.parametrize("gamma_deg", [2.0, 10.0, 50.0])
@pytest.mark.parametrize("beside_deg", [0.0, 70.0, 180.0])
def test_incidence_of_the_sun_is_the_mean_over_slopes_in_view(gamma_deg, beside_deg):
    """Cosine of incidence averaged over a grid of slopes, each with its projected area."""
    slopes = cox_munk_anisotropic(10.0, 0.4)
    view = _with(sea_view(table_air(10.0), slopes, height=2.0, sun_zenith=50.0, sun_azimuth=20.0), 1.0)
    azimuth, gamma = np.radians(20.0 + beside_deg), np.radians(gamma_deg)
    got = float(FoamMean.prepare(view).incidence(np.array(gamma), np.array(azimuth)))
    x = np.linspace(-5.0, 5.0, 801)
    up, cross = np.meshgrid(x * np.sqrt(slopes.mss_up), x * np.sqrt(slopes.mss_cross), indexing="ij")
    east, north = up * np.sin(0.4) + cross * np.cos(0.4), up * np.cos(0.4) - cross * np.sin(0.4)
    share = np.exp(-0.5 * (x[:, None] ** 2 + x**2))
    share *= np.maximum(np.sin(gamma) + np.cos(gamma) * (np.sin(azimuth) * east + np.cos(azimuth) * north), 0.0)
    z, a = view.solar_zenith, view.solar_azimuth
    rise = np.cos(z) - np.sin(z) * (np.sin(a) * east + np.cos(a) * north)
    # the vertical turns by 1e-5 rad on the way to the place
    assert got == pytest.approx(float((share * rise).sum() / share.sum()), rel=2e-3)


def test_a_low_sun_on_foam_is_cut_by_the_horizon():
    views = [_with(sea_view(table_air(10.0), cox_munk_isotropic(10.0), sun_zenith=z), 1.0) for z in (89.0, 90.0, 92.0)]
    light = [mean_radiance(v, [-np.radians(20.0)], [np.pi]).foam_sun[0, 0] for v in views]
    assert light[0] > light[1] > light[2] == 0.0


def test_a_blackbody_sea_has_no_foam():
    view = replace(sea_view(table_air(10.0), cox_munk_isotropic(10.0)), background="blackbody")
    np.testing.assert_array_equal(mean_radiance(_with(view, 0.5), ELEVATION, AZIMUTH).total, mean_radiance(view, ELEVATION, AZIMUTH).total)
