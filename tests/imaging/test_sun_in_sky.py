"""The solar disc in the sky: its energy wherever it stands among the pixels, its limb, the horizon and waves that cut it."""

from __future__ import annotations

import numpy as np
import pytest
from render_scenes import BAND, camera, elfouhaily, sea_view, shown, swept_scene, turned_scene

from seaglint.air.vacuum import VacuumAtmosphere
from seaglint.base.constants import SOLAR_ANGULAR_RADIUS
from seaglint.base.conventions import horizon_depression
from seaglint.imaging import upright_scene
from seaglint.imaging.camera.imager import Attitude, Imager
from seaglint.imaging.camera.pose import Track
from seaglint.imaging.sun_in_sky import sun_in_sky
from seaglint.sea.slopes.cox_munk import cox_munk_isotropic
from seaglint.sea.slopes.slope_statistics import flat

AZIMUTH = 10.0
HEIGHT = 30.0


class Bright(VacuumAtmosphere):
    """No air; 1 W m-2 of sunlight in the band, wherever the Sun stands; a black sky."""

    def solar_irradiance(self, solar_zenith):
        weights = BAND.weights(self.wavenumber_cm)
        return np.full((*np.shape(solar_zenith), self.wavenumber_cm.size), 1.0 / weights.sum())


def bright(sun_zenith, height=HEIGHT):
    return sea_view(Bright.for_band(BAND.min_um, BAND.max_um), cox_munk_isotropic(7.0), height, sun_zenith, AZIMUTH)


def sky_alone(image):
    """The sky and what stands in it; the vacuum's own is black, and the sea's light is told apart."""
    return (image.radiance - image.glint_radiance - image["emitted_radiance"]).astype(float)


def solid_angle(eye):
    edges = np.sin(eye.top - np.arange(eye.rows + 1) * eye.row_step)
    return (edges[:-1] - edges[1:])[:, None] * eye.column_step


@pytest.mark.parametrize("sun_zenith", [80.0, 45.0, 5.0, 0.5])
@pytest.mark.parametrize(("columns", "rows"), [(60, 60), (4, 3), (1, 1)])
@pytest.mark.parametrize(("aside", "up"), [(0.0, 0.0), (0.013, 0.031), (0.2, 0.17)])
def test_a_picture_holds_all_sunlight_wherever_the_disc_stands(sun_zenith, columns, rows, aside, up):
    wide = 2.0 / np.sin(np.radians(sun_zenith))
    top = min(90.0 - sun_zenith + 1.0 + up, 90.0)
    eye = camera(HEIGHT, top, top - 2.0, rows, azimuth=AZIMUTH + aside, width=min(wide, 360.0), columns=columns)
    view = bright(sun_zenith)
    light = sky_alone(shown(swept_scene(view, eye, layers=("emitted_radiance",)), 0.0))
    assert np.sum(light * solid_angle(eye)) == pytest.approx(1.0, rel=2e-4)
    if columns == 60 and sun_zenith > 1.0:
        assert light.max() == pytest.approx(1.0 / (np.pi * SOLAR_ANGULAR_RADIUS**2), rel=1e-3)


def test_pixels_inside_and_outside_the_limb():
    eye = camera(HEIGHT, 15.4, 14.6, 200, azimuth=AZIMUTH, width=0.8, columns=200)
    light = sky_alone(shown(swept_scene(bright(75.0), eye, layers=("emitted_radiance",)), 0.0))
    e, s = eye.elevations[:, None], np.radians(15.0)
    cosine = np.sin(e) * np.sin(s) + np.cos(e) * np.cos(s) * np.cos(eye.azimuths - np.radians(AZIMUTH))
    angle, pixel = np.arccos(cosine), eye.row_step
    disc = 1.0 / (np.pi * SOLAR_ANGULAR_RADIUS**2)
    np.testing.assert_allclose(light[angle < SOLAR_ANGULAR_RADIUS - pixel], disc, rtol=1e-2)  # chords, five to a pixel's width
    assert np.all(light[angle > SOLAR_ANGULAR_RADIUS + pixel] == 0.0)


def segment(height_over_horizon):
    """Share of a disc whose middle stands so many radii over a straight edge."""
    h = np.clip(height_over_horizon, -1.0, 1.0)
    return (np.arccos(-h) + h * np.sqrt(1.0 - h * h)) / np.pi


@pytest.mark.parametrize("radii", [1.5, 0.7, 0.0, -0.6, -1.2])
def test_the_horizon_cuts_the_disc(radii):
    dip = horizon_depression(HEIGHT)
    sun_zenith = 90.0 + np.degrees(dip - radii * SOLAR_ANGULAR_RADIUS)
    eye = camera(HEIGHT, 1.0, -1.0, 101, azimuth=AZIMUTH, width=1.0, columns=21)
    image = shown(swept_scene(bright(sun_zenith), eye, layers=("emitted_radiance", "coverage")), 0.0)
    light = sky_alone(image)
    light[image["coverage"] > 0.999] = 0.0  # the mirrored sky is black, rounding is not
    assert np.sum(light * solid_angle(eye)) == pytest.approx(segment(radii), abs=2e-3)
    assert (sun_in_sky(bright(sun_zenith)).radiance == 0.0) == (radii < -1.0)


def test_waves_cut_the_disc():
    """What crests hide is hidden: no pixel has more of the disc than sky."""
    eye = camera(6.0, 0.6, -0.6, 120, azimuth=AZIMUTH, width=0.8, columns=40)
    view = bright(90.0 + np.degrees(horizon_depression(6.0)), 6.0)
    image = shown(swept_scene(view, eye, elfouhaily(7.0), layers=("emitted_radiance", "coverage", "sky_radiance")), 2.0)
    disc = 1.0 / (np.pi * SOLAR_ANGULAR_RADIUS**2)
    sky = sky_alone(image)
    # chords stand for a column's lines, not each for one
    assert np.all(sky <= disc * (1.0 - image["coverage"] + 0.05))
    held = np.sum(np.where(image["coverage"] > 0.999, 0.0, sky) * solid_angle(eye))
    assert 0.3 < held < 0.5, "crests stand above the mean horizon"


@pytest.mark.parametrize("roll", [pytest.param(0.0, marks=pytest.mark.validation), 0.5])
@pytest.mark.parametrize(("projection", "elevation"), [("pinhole", 20.0), ("equal-angle", 20.0), ("pinhole", 0.0)])
def test_turned_cameras_hold_all_sunlight(projection, elevation, roll):
    """Away from the horizon by rays, across it by resampling."""
    imager = Imager(projection, np.radians(3.0), np.radians(2.5), 30, 25)
    attitude = Attitude(np.radians(AZIMUTH + 0.3), np.radians(elevation + 0.2), roll)
    scene = turned_scene(
        lambda h: bright(90.0 - elevation, h), imager, Track.standing(HEIGHT, attitude), layers=("emitted_radiance", "coverage")
    )
    image = shown(scene, 0.0)
    corner = imager.corners(attitude)
    right, down = corner[:-1, 1:] - corner[:-1, :-1], corner[1:, :-1] - corner[:-1, :-1]
    light = np.where(image["coverage"] > 0.999, 0.0, sky_alone(image))
    held = np.sum(light * np.linalg.norm(np.cross(right, down), axis=-1))
    above = segment((np.radians(elevation) + horizon_depression(HEIGHT)) / SOLAR_ANGULAR_RADIUS)
    assert held == pytest.approx(above, rel=3e-3)  # flat areas of pixels, and the horizon's row


def test_the_disc_is_no_glint():
    """A mirror sea has the disc twice: in the sky, and as glint; layers keep them apart."""
    view = sea_view(Bright.for_band(BAND.min_um, BAND.max_um), flat(), HEIGHT, 85.0, AZIMUTH)
    eye = camera(HEIGHT, 6.0, -6.0, 240, azimuth=AZIMUTH, width=1.0, columns=40)
    image = shown(swept_scene(view, eye, layers=("emitted_radiance", "sky_radiance")), 0.0)
    area = solid_angle(eye)
    sky, glint = np.sum(image["sky_radiance"] * area), np.sum(image.glint_radiance * area)
    assert sky == pytest.approx(1.0, rel=2e-3)
    assert 0.3 < glint < 1.0, "mirrored at 85 deg"
    assert np.all(image.radiance < np.finfo(np.float32).max)


@pytest.mark.parametrize("above", [-1.2, -0.5, 0.9, 1.0001, 1.5, 90.0])
def test_a_disc_above_the_picture_is_left_out_of_nothing(above, monkeypatch):
    """The same bytes with the light of the disc computed, wherever the upper edge of the picture is; ``above`` counts its radii."""
    view, top = bright(60.0), 30.0 - np.degrees(above * SOLAR_ANGULAR_RADIUS)
    eye = camera(HEIGHT, top, top - 1.0, 20, azimuth=AZIMUTH, width=1.0, columns=21)
    image = shown(swept_scene(view, eye), 0.0).radiance
    assert (sun_in_sky(view, eye.top).radiance == 0.0) == (above > 1.0)
    monkeypatch.setattr(upright_scene, "sun_in_sky", lambda view, top: sun_in_sky(view))
    assert shown(swept_scene(view, eye), 0.0).radiance.tobytes() == image.tobytes()
