"""An air whose sky depends on azimuth: pictures and maps show it where it is, whichever way they are drawn."""

from __future__ import annotations

import numpy as np
import pytest
from render_scenes import BAND, camera, sea_view, shown, swept_scene, turned_scene

from seaglint.air.vacuum import VacuumAtmosphere
from seaglint.facet.sky import mirrored_sky, thermal_at, thermal_sky
from seaglint.imaging.camera.imager import Attitude, Imager
from seaglint.imaging.camera.pose import Track
from seaglint.optics.blackbody import planck_wavenumber
from seaglint.radiance.mean import MeanModel, mean_radiance
from seaglint.sea.slopes.cox_munk import cox_munk_anisotropic, cox_munk_isotropic

HEIGHT = 30.0
BRIGHTEST = np.radians(40.0)
LINEAR = 5e-5
"""Error of a straight line between two of 360 azimuths of a cosine, (2 pi/360)^2 / 8, and of the mean over a column of half a degree."""


def pattern(elevation, azimuth):
    """Sky over that of 250 K: brightest at an azimuth, and brighter towards the horizon."""
    return (1.0 + 0.5 * np.cos(azimuth - BRIGHTEST)) * (2.0 - np.sin(elevation))


class OneSidedSky(VacuumAtmosphere):
    """No air, and a sky that is brighter on one side."""

    sky_azimuths = 360

    def sky_radiance(self, zenith, azimuth, height=0.0):
        share = pattern(0.5 * np.pi - np.asarray(zenith, dtype=float), azimuth)
        return share[..., None] * planck_wavenumber(self.wavenumber_cm, 250.0)


class EvenSky(OneSidedSky):
    """The mean of that sky over azimuth."""

    sky_azimuths = 1

    def sky_radiance(self, zenith, azimuth, height=0.0):
        return super().sky_radiance(zenith, BRIGHTEST + 0.5 * np.pi)


def night(air=OneSidedSky, slopes=None, height=HEIGHT):
    return sea_view(air.for_band(BAND.min_um, BAND.max_um), slopes or cox_munk_isotropic(5.0), height, sun_zenith=120.0)


def expected(view, elevation, azimuth):
    return view.in_band(planck_wavenumber(view.atmosphere.wavenumber_cm, 250.0)) * pattern(elevation, azimuth)


@pytest.mark.parametrize(("top", "bottom"), [(2.0, -2.0), (12.0, 2.0)], ids=["sea and sky", "sky alone"])
@pytest.mark.parametrize("azimuth", [35.0, 359.0, -100.0])
def test_upright_pictures_show_the_sky_of_each_column(top, bottom, azimuth):
    view, eye = night(), camera(HEIGHT, top, bottom, 40, azimuth=azimuth, width=20.0, columns=40)
    image = shown(swept_scene(view, eye), 0.0)
    sky = eye.elevations > 0.5 * eye.row_step
    np.testing.assert_allclose(image.radiance[sky], expected(view, eye.elevations[sky, None], eye.azimuths), rtol=LINEAR)


@pytest.mark.parametrize("elevation", [pytest.param(40.0, marks=pytest.mark.validation), 0.5], ids=["rays", "resampled"])
def test_turned_pictures_show_the_sky_of_each_pixel(elevation):
    imager, attitude = Imager("pinhole", np.radians(8.0), np.radians(4.0), 32, 16), Attitude(np.radians(350.0), np.radians(elevation), 0.3)
    scene = turned_scene(lambda height: night(height=height), imager, Track.standing(HEIGHT, attitude))
    seen, (azimuth, up) = shown(scene, 0.0).radiance, imager.centres(attitude)
    sky = up > np.radians(0.4)
    # means over pixels of a quarter of a degree, resampled from cells of their size
    np.testing.assert_allclose(seen[sky], expected(night(), up, azimuth)[sky], rtol=3e-3 if elevation < 1.0 else LINEAR)


@pytest.mark.parametrize("slopes", [cox_munk_isotropic(5.0), cox_munk_anisotropic(5.0, 0.4)], ids=["isotropic", "directional"])
def test_mean_maps_show_it_too(slopes):
    view, elevation, azimuth = night(slopes=slopes), np.radians([-3.0, 1.0, 20.0]), np.radians([-90.0, 10.0, 41.5, 200.0])
    wanted = expected(view, elevation[1:, None], azimuth)
    np.testing.assert_allclose(mean_radiance(view, elevation, azimuth).total[1:], wanted, rtol=LINEAR)
    lines = MeanModel.prepare(view).along(np.repeat(elevation[1:], 4), np.tile(azimuth, 2))
    # the table of elevations has a node every 0.05 deg at 20 deg
    np.testing.assert_allclose(lines.total[:, 0], wanted.ravel(), rtol=2 * LINEAR)


def test_the_sea_mirrors_its_mean_over_azimuth():
    one_sided, even = night(), night(EvenSky)
    eye = camera(HEIGHT, -1.0, -30.0, 30, azimuth=40.0, width=10.0, columns=3)
    images = [shown(swept_scene(view, eye), 0.0).radiance for view in (one_sided, even)]
    np.testing.assert_allclose(*images, rtol=1e-6)  # float32
    maps = [mean_radiance(view, eye.elevations, eye.azimuths).total for view in (one_sided, even)]
    np.testing.assert_allclose(np.broadcast_to(maps[1], maps[0].shape), maps[0], rtol=1e-12)
    zenith = np.linspace(0.0, 0.5 * np.pi, 7)
    np.testing.assert_allclose(mirrored_sky(one_sided.atmosphere, zenith), mirrored_sky(even.atmosphere, zenith), rtol=1e-13)


def test_the_table_goes_round_the_circle():
    view, elevation = night(), np.radians([0.0, 30.0])
    azimuth = np.array([-1e-9, 0.0, 2.0 * np.pi, 6.0 * np.pi + 1.0, -7.0])
    found = thermal_at(thermal_sky(view, elevation), azimuth, np.arange(2)[:, None])
    np.testing.assert_allclose(found, expected(view, elevation[:, None], azimuth), rtol=LINEAR)
