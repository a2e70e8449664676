"""Scenes whose image is known without a renderer."""

import numpy as np
import pytest
from render_scenes import BAND, SEA_TEMPERATURE, WarmSky, camera, elfouhaily, furnace, sea_view, shown, swept_scene, table_air

from seaglint.base.constants import SOLAR_ANGULAR_RADIUS
from seaglint.base.conventions import surface_range, view_zenith
from seaglint.optics import sea_water
from seaglint.optics.blackbody import planck_wavenumber
from seaglint.optics.fresnel import reflectance
from seaglint.radiance.mean_radiance import mean_radiance
from seaglint.sea.slopes.cox_munk import cox_munk_anisotropic, cox_munk_isotropic
from seaglint.sea.slopes.slope_statistics import SlopeStatistics, flat

FURNACE = 1e-4  # the issue's; float32 images hold 6e-8, so anything near this bound is light lost or counted twice


@pytest.mark.parametrize("height", [2.0, 3000.0, pytest.param(30.0, marks=pytest.mark.validation)])
@pytest.mark.parametrize(
    "slopes",
    [flat(), cox_munk_isotropic(3.0), cox_munk_anisotropic(12.0, 0.5), SlopeStatistics(0.03, 0.0)],
    ids=["flat", "isotropic", "directional", "one direction only"],
)
def test_white_furnace_of_facets_is_flat(height, slopes):
    image = shown(swept_scene(sea_view(furnace(), slopes, height), camera(height, 4.0, -90.0, 300, width=20.0, columns=4)), 0.0)
    np.testing.assert_allclose(image.radiance, BAND.radiance(SEA_TEMPERATURE, furnace().wavenumber_cm), rtol=FURNACE)
    assert np.all(image.glint_radiance == 0.0)


@pytest.mark.parametrize(
    ("height", "wind", "bottom"),
    [
        (2.0, 3.0, -3.0),
        (30.0, 9.0, -90.0),
        *(
            pytest.param(*scene, marks=pytest.mark.validation)
            for scene in ((2.0, 3.0, -90.0), (30.0, 9.0, -3.0), (3000.0, 9.0, -3.0), (3000.0, 9.0, -90.0))
        ),
    ],
)
def test_white_furnace_with_waves_is_flat(height, wind, bottom):
    """Crests, troughs, sky between crests and the foot of the sensor: every pixel is filled once."""
    waves = elfouhaily(wind, shortest_wave=4.0 if wind > 5.0 else 2.0)
    view = sea_view(furnace(), cox_munk_anisotropic(wind, np.radians(30.0)), height)
    image = shown(swept_scene(view, camera(height, 1.0, bottom, 200, width=10.0, columns=4), waves), 3.0)
    np.testing.assert_allclose(image.radiance, BAND.radiance(SEA_TEMPERATURE, furnace().wavenumber_cm), rtol=FURNACE)


@pytest.mark.parametrize("air", [WarmSky.for_band(BAND.min_um, BAND.max_um), table_air(7.0)], ids=["warm sky", "table"])
def test_flat_sea_is_fresnel_times_sky_plus_emission(air):
    height, nu = 30.0, air.wavenumber_cm
    eye = camera(height, -0.4, -70.0, 1500)
    total = shown(swept_scene(sea_view(air, flat(), height, sun_zenith=120.0), eye), 0.0).radiance[:, 0]
    depression = -eye.elevations
    theta, arc = view_zenith(height, depression), surface_range(height, depression)
    rho = reflectance(np.cos(theta)[:, None], sea_water.hale_querry_sea().index(nu))
    leaving = rho * air.sky_radiance(theta, 0.0) + (1.0 - rho) * planck_wavenumber(nu, SEA_TEMPERATURE)
    expected = (air.transmittance(height, arc) * leaving + air.path_radiance(height, arc)) @ BAND.weights(nu)
    # the bound; rows of 0.046 deg lie between the atmosphere's and the sky's nodes
    np.testing.assert_allclose(total, expected, rtol=1e-3)


@pytest.mark.parametrize("depression", [3.0, 20.0])
def test_mirror_sea_shows_the_solar_disc(depression):
    """Radiance ``tau rho E/(pi eps^2)`` inside the disc; all pixels together the irradiance of the mirrored Sun."""
    air, height = table_air(7.0), 3.0
    nu, zenith = air.wavenumber_cm, float(view_zenith(height, np.radians(depression)))
    radius = np.degrees(SOLAR_ANGULAR_RADIUS)
    width = 2.6 * radius / np.cos(np.radians(depression))
    eye = camera(height, -depression + 1.3 * radius, -depression - 1.3 * radius, 240, width=width, columns=240)
    sun = shown(swept_scene(sea_view(air, flat(), height, sun_zenith=np.degrees(zenith)), eye), 0.0).glint_radiance.astype(float)
    tau = air.transmittance(height, surface_range(height, np.radians(depression)))
    rho = reflectance(np.cos(zenith), sea_water.hale_querry_sea().index(nu))
    irradiance = float((tau * rho * air.solar_irradiance(zenith)) @ BAND.weights(nu))
    middle = sun[100:140, 100:140]
    assert middle.mean() == pytest.approx(irradiance / (np.pi * SOLAR_ANGULAR_RADIUS**2), rel=1e-3)
    solid_angle = eye.row_step * eye.column_step * np.cos(eye.elevations)[:, None]
    # over 0.53 deg of elevation Fresnel and path change by several percent, but evenly about the middle
    assert (sun * solid_angle).sum() == pytest.approx(irradiance, rel=5e-3)
    assert sun[:5].max() == 0.0
    assert sun[:, :5].max() == 0.0


@pytest.mark.parametrize("sun_zenith", [40.0, 88.0, pytest.param(80.0, marks=pytest.mark.validation)])
@pytest.mark.parametrize(
    ("wind", "slopes"),
    [
        pytest.param(2.0, cox_munk_isotropic(2.0), id="isotropic 2 m/s"),
        pytest.param(18.0, cox_munk_isotropic(18.0), id="isotropic 18 m/s", marks=pytest.mark.validation),
        pytest.param(15.0, cox_munk_anisotropic(15.0, 2.0), id="directional 15 m/s"),
    ],
)
@pytest.mark.parametrize(
    ("top", "rows"),
    [pytest.param(-0.5, 120, id="near the horizon"), pytest.param(-4.0, 280, id="down to 60 deg", marks=pytest.mark.validation)],
)
def test_without_resolved_waves_the_image_is_the_mean(wind, slopes, sun_zenith, top, rows):
    """Two routes to the same average: path basis and facet tables here, spectral sums over facets per row there."""
    bottom = top - 0.03 * rows if top > -1.0 else -60.0
    view, eye = sea_view(table_air(wind), slopes, 50.0, sun_zenith, 5.0), camera(50.0, top, bottom, rows, width=24.0, columns=3)
    # one line: the middle of a column, as the model has it; wide columns have more
    image, model = shown(swept_scene(view, eye, lines_per_column=1), 0.0), mean_radiance(view, eye.elevations, eye.azimuths)
    np.testing.assert_allclose(image.radiance, model.total, rtol=5e-3)  # every pixel
    bright = model.sun > 0.1 * model.total
    # the Sun alone: a disc taken as a Gaussian with its fourth cumulants, where it is half as wide as the slopes (Sun at 88 deg)
    np.testing.assert_allclose(image.glint_radiance[bright], model.sun[bright], rtol=8e-3)


@pytest.mark.parametrize("model", ["us-standard-1976"])
def test_the_other_atmosphere_and_a_high_sensor_give_the_mean_too(model):
    view, eye = sea_view(table_air(10.0, model), cox_munk_isotropic(10.0), 2500.0, 75.0), camera(2500.0, -2.5, -60.0, 1000)
    np.testing.assert_allclose(
        shown(swept_scene(view, eye), 0.0).radiance, mean_radiance(view, eye.elevations, eye.azimuths).total, rtol=5e-3
    )
