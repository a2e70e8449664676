"""The Sun of pictures against the vertical of each place."""

import numpy as np
import pytest
from render_scenes import camera, sea_view, shown, swept_scene, turned_scene

from seaglint.air.vacuum import VacuumAtmosphere
from seaglint.base.constants import EARTH_RADIUS
from seaglint.facet import solar_disc
from seaglint.facet.facet_sunlight import sun_factor
from seaglint.facet.legs import SMITHS, Shadowing
from seaglint.facet.roughness import line_of_sight, roughness_of
from seaglint.facet.sunlight import sunlight, sunlight_at, visible_sun
from seaglint.imaging.camera.imager import Attitude, Imager
from seaglint.imaging.camera.pose import Track
from seaglint.radiance.mean_radiance import mean_radiance
from seaglint.sea.slopes.cox_munk import cox_munk_anisotropic


class HazySun(VacuumAtmosphere):
    """Clear paths under haze: sunlight that falls with the way through a flat layer."""

    def solar_irradiance(self, solar_zenith):
        up = np.cos(np.asarray(solar_zenith, dtype=float))[..., None]
        return super().solar_irradiance(solar_zenith) * np.exp(-0.1 / np.maximum(up, 1e-3))


AIR = HazySun.for_band(3.5, 5.0)
# one band in images and maps: with several, their shadows differ by 2 %
LAW = {"shadowing": Shadowing(bands=1)}
SLOPES = cox_munk_anisotropic(10.0, 0.5)


@pytest.mark.kernel
@pytest.mark.parametrize("zenith", [0.3, 1.0, 1.5, 0.5 * np.pi, 0.5 * np.pi + 0.02, 0.5 * np.pi + 0.028])
@pytest.mark.parametrize("relative", [0.0, 0.7, 2.5, np.pi])
def test_the_sun_at_a_place_is_a_sun_made_for_it(zenith, relative):
    psi, bearing = 0.025, 0.9
    away = np.array([np.sin(bearing), np.cos(bearing)])
    got = sunlight_at(sunlight(zenith, bearing + relative, True), *away, psi * EARTH_RADIUS)
    # components along the line, aside and up, turned about aside
    out, aside, up = np.sin(zenith) * np.cos(relative), np.sin(zenith) * np.sin(relative), np.cos(zenith)
    out, up = np.cos(psi) * out - np.sin(psi) * up, np.sin(psi) * out + np.cos(psi) * up
    share, middle = visible_sun(float(np.arccos(up)))
    assert got.share == pytest.approx(share, abs=1e-5)
    assert got.shining == (share > 0.0)
    if share == 0.0:
        return
    assert got.east**2 + got.north**2 + got.up**2 == pytest.approx(1.0, abs=1e-12)
    expected = sunlight(middle, bearing + float(np.arctan2(aside, out)), True)
    fields = set(expected._fields) - {"shining", "azimuth", "share", "upper_tangent"}
    for name in fields:
        assert getattr(got, name) == pytest.approx(getattr(expected, name), abs=3e-5)
    assert np.arctan(got.upper_tangent) == pytest.approx(np.arctan(expected.upper_tangent), abs=1e-5)


@pytest.mark.parametrize(("aside", "error"), [(0.0, 2e-3), (0.5, 5e-3), (1.3, 1e-2)])
def test_the_discs_table_of_the_foot_serves_turned_places(aside, error):
    """Within the turn times the disc's share of the slopes, which is large far aside where next to nothing is mirrored."""
    psi, sun = 0.05, sunlight(np.radians(75.0), 0.3, True)
    rough = roughness_of(SLOPES, 0.3, SMITHS)
    sight = line_of_sight(sun, rough, 0.3 + aside)
    line = solar_disc.disc_line(sun, rough, sight, (0.05, 0.9), np.empty(solar_disc.DISC_ROWS), psi)
    assert line.rows.size > 0
    there = sunlight_at(sun, -sight.east, -sight.north, psi * EARTH_RADIUS)
    for sine in (0.05, 0.1, 0.2):
        grazing = (sine, float(np.sqrt(1.0 - sine * sine)))
        mirror = [-(c * grazing[1] + s) / (sine + there.up) for c, s in ((sight.east, there.east), (sight.north, there.north))]
        slope = (0.8 * mirror[0], 0.8 * mirror[1])
        got, _ = sun_factor(there, rough, line, sight, grazing, slope)
        exact, _ = sun_factor(there, rough, solar_disc.no_disc_line(), sight, grazing, slope)
        assert got == pytest.approx(exact, rel=error, abs=1e-12)


@pytest.mark.parametrize(("height", "top"), [(10_000.0, -3.15), (3000.0, -1.9)])
@pytest.mark.parametrize(("sun", "azimuth"), [(40.0, 10.0), (70.0, 0.0), (84.0, 15.0)])
def test_from_on_high_the_image_without_waves_is_the_mean(height, top, sun, azimuth):
    view, eye = sea_view(AIR, SLOPES, height, sun, azimuth, **LAW), camera(height, top, top - 40.0, 800, width=50.0, columns=3)
    image, model = shown(swept_scene(view, eye, lines_per_column=1), 0.0), mean_radiance(view, eye.elevations, eye.azimuths)
    np.testing.assert_allclose(image.radiance, model.total, rtol=5e-3)
    bright = model.sun > 0.1 * model.total
    assert bright.any()
    np.testing.assert_allclose(image.glint_radiance[bright], model.sun[bright], rtol=8e-3)


def test_a_sun_that_is_up_only_towards_it_is_in_pictures_too():
    view, eye = sea_view(AIR, SLOPES, 10_000.0, 91.0, **LAW), camera(10_000.0, -3.0, -3.6, 60, width=4.0, columns=2)
    image, model = shown(swept_scene(view, eye, lines_per_column=1), 0.0), mean_radiance(view, eye.elevations, eye.azimuths)
    assert model.sun.max() > 0.0
    bright = model.sun > 0.1 * model.sun.max()
    # a disc at the horizon, taken as a Gaussian in the slopes
    np.testing.assert_allclose(image.glint_radiance[bright], model.sun[bright], rtol=0.05)


def test_rays_have_each_places_sun():
    height, sun = 10_000.0, 60.0
    eye, pointing = Imager("equal-angle", np.radians(2.0), np.radians(2.0), 3, 3), Attitude(0.0, np.radians(-12.0), np.radians(30.0))
    track = Track.standing(height, pointing)
    image = shown(turned_scene(lambda h: sea_view(AIR, SLOPES, h, sun, **LAW), eye, track, walk_below=np.radians(-1.0)), 0.0).glint_radiance
    corner = eye.directions(pointing, np.arange(3) + 0.5, np.arange(3)[:, None] + 0.5).reshape(-1, 3)
    view = sea_view(AIR, SLOPES, height, sun, **LAW)
    model = [float(mean_radiance(view, [np.arcsin(v[2])], [np.arctan2(v[0], v[1])]).sun[0, 0]) for v in corner]
    np.testing.assert_allclose(image.ravel(), model, rtol=8e-3)  # a pixel is the mean over 0.7 deg, the model its centre
