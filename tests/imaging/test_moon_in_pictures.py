"""The Moon in pictures: its lit part in the sky, its mirrored light beside the mean map, and Sun and Moon together."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from render_scenes import BAND, camera, elfouhaily, sea_view, shown, swept_scene, table_air, turned_scene

from seaglint.air.vacuum import VacuumAtmosphere
from seaglint.facet.sea_view import LightDisc, Moonlight
from seaglint.imaging.camera.imager import Attitude, Imager
from seaglint.imaging.camera.pose import Track
from seaglint.radiance.mean_radiance import mean_radiance
from seaglint.sea.slopes.cox_munk import cox_munk_anisotropic, cox_munk_isotropic
from seaglint.sea.slopes.slope_statistics import flat

AZIMUTH, HEIGHT, RADIUS = 10.0, 30.0, 4.5e-3
SUN_DOWN = 130.0  #: Zenith angle of the Sun at night [deg].


class OneWatt(VacuumAtmosphere):
    """No air; 1 W m-2 of light in the band, from wherever; a black sky."""

    def solar_irradiance(self, solar_zenith):
        weights = BAND.weights(self.wavenumber_cm)
        light = np.full((*np.shape(solar_zenith), self.wavenumber_cm.size), 1.0 / weights.sum())
        return np.where(np.asarray(solar_zenith)[..., None] < 1.7, light, 0.0)


def moon(zenith_deg, phase_deg=0.0, limb_deg=0.0, ratio=np.ones_like, azimuth_deg=AZIMUTH):
    return Moonlight(np.radians(zenith_deg), np.radians(azimuth_deg), LightDisc(RADIUS, ratio, np.radians(phase_deg), np.radians(limb_deg)))


def faint(wavenumber_cm):
    """A light that the eye would call a Moon: the Sun's, four hundredth of it."""
    return np.full(np.shape(wavenumber_cm), 2.5e-3)


def night(light, slopes=None, air=None, sun_zenith=SUN_DOWN, height=HEIGHT):
    air = OneWatt.for_band(BAND.min_um, BAND.max_um) if air is None else air
    return sea_view(air, cox_munk_isotropic(7.0) if slopes is None else slopes, height, sun_zenith, AZIMUTH, moon=light)


def sky_alone(image):
    return (image.radiance - image.glint_radiance - image["emitted_radiance"]).astype(float)


def solid_angle(eye):
    edges = np.sin(eye.top - np.arange(eye.rows + 1) * eye.row_step)
    return (edges[:-1] - edges[1:])[:, None] * eye.column_step


CASES = [(0.0, 0.0), (50.0, 20.0), (90.0, 130.0), (90.0, 270.0), (140.0, 75.0), (140.0, 200.0)]


@pytest.mark.parametrize(("phase", "limb"), CASES)
@pytest.mark.parametrize("zenith", [80.0, 30.0])
def test_the_lit_part_has_all_light_and_lies_at_the_bright_limb(phase, limb, zenith):
    wide = 0.8 / np.sin(np.radians(zenith))
    eye = camera(HEIGHT, 90.4 - zenith, 89.6 - zenith, 160, azimuth=AZIMUTH, width=wide, columns=160)
    image = shown(swept_scene(night(moon(zenith, phase, limb)), eye, layers=("emitted_radiance",)), 0.0)
    light = sky_alone(image) * solid_angle(eye)
    assert light.sum() == pytest.approx(1.0, rel=1e-3)
    up = (eye.elevations - np.radians(90.0 - zenith))[:, None]
    right = (eye.azimuths - np.radians(AZIMUTH)) * np.cos(eye.elevations)[:, None]
    # a half ellipse beside a half disc: its middle is (4/3 pi) (1 - cos(phase)) radii from the centre
    off = RADIUS * 4.0 / (3.0 * np.pi) * (1.0 - np.cos(np.radians(phase)))
    assert (light * up).sum() == pytest.approx(off * np.cos(np.radians(limb)), abs=0.015 * RADIUS)
    assert (light * right).sum() == pytest.approx(off * np.sin(np.radians(limb)), abs=0.015 * RADIUS)
    share = np.count_nonzero(light > 0.5 * light.max()) * eye.row_step * eye.column_step * np.sin(np.radians(zenith))
    assert share == pytest.approx(np.pi * RADIUS**2 * 0.5 * (1.0 + np.cos(np.radians(phase))), rel=0.05)


@pytest.mark.parametrize(("phase", "limb"), CASES)
def test_turned_cameras_draw_the_same_moon(phase, limb):
    """Pixels of rays, by areas of polygons, against the chords of the sweep."""
    view = night(moon(60.0, phase, limb))
    upright = camera(HEIGHT, 30.4, 29.6, 160, azimuth=AZIMUTH, width=0.8 / np.cos(np.radians(30.0)), columns=160)
    chords = sky_alone(shown(swept_scene(view, upright, layers=("emitted_radiance",)), 0.0))
    # the pinhole camera has the same pixels on the axis, within 1e-4 of them
    imager = Imager("pinhole", np.radians(0.8), np.radians(0.8), 160, 160)
    still = Track.standing(HEIGHT, Attitude(np.radians(AZIMUTH), np.radians(30.0), 0.0))
    scene = turned_scene(lambda height: replace(view, sensor_height=height), imager, still, layers=("emitted_radiance",))
    rays = sky_alone(shown(scene, 0.0))
    # pixels at the limb and the terminator differ by their shares
    assert np.abs(rays - chords).sum() == pytest.approx(0.0, abs=0.03 * chords.sum())
    assert rays.sum() == pytest.approx(chords.sum(), rel=2e-3)


@pytest.mark.parametrize("roll", [0.0, 0.5])
def test_a_rolled_camera_turns_the_moon(roll):
    view = night(moon(60.0, 90.0, 0.0))
    imager = Imager("pinhole", np.radians(0.8), np.radians(0.8), 80, 80)
    still = Track.standing(HEIGHT, Attitude(np.radians(AZIMUTH), np.radians(30.0), roll))
    light = sky_alone(shown(turned_scene(lambda h: view, imager, still, layers=("emitted_radiance",)), 0.0))
    at = np.arange(80) - 39.5
    right, up = (light * at).sum() / light.sum(), (light * -at[:, None]).sum() / light.sum()
    expected = 4.0 / (3.0 * np.pi) * RADIUS / np.radians(0.8 / 80)
    assert np.hypot(right, up) == pytest.approx(expected, rel=0.01)
    assert abs(np.arctan2(right, up)) == pytest.approx(roll, abs=0.01)


@pytest.mark.parametrize("radii", [0.6, -0.4])
def test_the_horizon_cuts_the_moon(radii):
    eye = camera(HEIGHT, 1.0, -1.0, 101, azimuth=AZIMUTH, width=1.0, columns=41)
    dip = float(np.degrees(np.arccos(6371e3 * 7 / 6 / (6371e3 * 7 / 6 + HEIGHT))))
    light = moon(90.0 + dip - np.degrees(radii * RADIUS), 90.0, 90.0)
    image = shown(swept_scene(night(light), eye, layers=("emitted_radiance", "coverage")), 0.0)
    held = np.where(image["coverage"] > 0.999, 0.0, sky_alone(image))
    # a half disc with a vertical terminator loses the same share as the whole
    expected = (np.arccos(-radii) + radii * np.sqrt(1.0 - radii**2)) / np.pi
    assert np.sum(held * solid_angle(eye)) == pytest.approx(expected, abs=6e-3)


@pytest.mark.parametrize("phase", [0.0, 90.0])
@pytest.mark.parametrize("zenith", [80.0, 55.0])
def test_without_waves_the_moonlit_picture_is_the_mean_map(phase, zenith):
    """The bars of the Sun's picture: facets' tables beside spectral sums."""
    view = night(moon(zenith, phase, 80.0, faint), cox_munk_anisotropic(8.0, 2.0), table_air(8.0))
    eye = camera(HEIGHT, -0.5, -12.0, 120, azimuth=AZIMUTH, width=24.0, columns=3)
    image, model = shown(swept_scene(view, eye, lines_per_column=1), 0.0), mean_radiance(view, eye.elevations, eye.azimuths)
    np.testing.assert_allclose(image.radiance, model.total, rtol=5e-3)
    bright = model.sun > 0.1 * model.sun.max()
    np.testing.assert_allclose(image.glint_radiance[bright], model.sun[bright], rtol=8e-3)


def test_the_expectation_of_waves_in_moonlight_is_the_mean_map():
    """The same sea under the Sun and the Moon of one place: the Moon's picture is the Sun's, as faint as the light is.

    So every bar that the tests of the Sun set for the expectation of pictures holds for the Moon.
    """
    waves, slopes = elfouhaily(7.0), cox_munk_anisotropic(7.0, np.radians(30.0))
    light = Moonlight(np.radians(75.0), np.radians(AZIMUTH), LightDisc(4.65e-3, faint))
    sun = night(None, slopes, table_air(7.0), 75.0)
    sun, dark = replace(sun, scattering=False), night(light, slopes, table_air(7.0))
    eye = camera(HEIGHT, 0.5, -6.0, 120, azimuth=AZIMUTH, width=8.0, columns=40)
    by_sun, by_moon = (shown(swept_scene(view, eye, waves), 2.0).glint_radiance for view in (sun, dark))
    # shadows by waves are looked for in fainter light
    np.testing.assert_allclose(by_moon, 2.5e-3 * by_sun, rtol=2e-3, atol=2e-3 * 2.5e-3 * by_sun.max())


@pytest.mark.parametrize("waves", [True, False])
@pytest.mark.parametrize("turned", [False, True])
def test_sun_and_moon_add_up(waves, turned):
    """The picture of the Sun, byte for byte, plus the mirrored light and the disc of the Moon at night."""
    field, slopes = elfouhaily(7.0) if waves else None, cox_munk_anisotropic(7.0, np.radians(30.0))
    # half as bright as the Sun, so that single precision does not hide it; the levels of waves depend on the height of a low light
    light = moon(70.0 if waves else 89.5, 60.0, 40.0, lambda wavenumber: np.full(np.shape(wavenumber), 0.5))
    both = night(light, slopes, table_air(7.0), 70.0)
    views = (both, replace(both, moon=None), night(light, slopes, table_air(7.0)), night(None, slopes, table_air(7.0)))
    if turned:
        imager = Imager("pinhole", np.radians(5.0), np.radians(4.0), 40, 32)
        still = Track.standing(HEIGHT, Attitude(np.radians(AZIMUTH), np.radians(-1.0), 0.2))
        scenes = [turned_scene(lambda h, view=view: view, imager, still, field, layers=("emitted_radiance",)) for view in views]
    else:
        eye = camera(HEIGHT, 1.0, -3.0, 64, azimuth=AZIMUTH, width=5.0, columns=40)
        scenes = [swept_scene(view, eye, field, layers=("emitted_radiance",)) for view in views]
    of_both, of_sun, of_moon, of_none = (shown(scene, 1.0) for scene in scenes)
    np.testing.assert_array_equal(of_both["emitted_radiance"], of_sun["emitted_radiance"])
    moonlit = of_moon.glint_radiance.astype(float)
    # rounding of the Sun's light, and shadows that are looked for in fainter light of the Moon
    bar = 1e-6 * of_both.radiance.max() + 5e-3 * moonlit.max()
    np.testing.assert_allclose(of_both.glint_radiance.astype(float) - of_sun.glint_radiance, moonlit, atol=bar)
    added = of_both.radiance.astype(float) - of_sun.radiance
    np.testing.assert_allclose(added, of_moon.radiance.astype(float) - of_none.radiance, atol=bar)
    if not waves:
        assert added.max() > 50.0 * moonlit.max(), "the disc in the sky"


def test_a_moon_that_is_down_changes_nothing():
    eye = camera(HEIGHT, 1.0, -3.0, 32, azimuth=AZIMUTH, width=5.0, columns=20)
    for sun_zenith in (70.0, SUN_DOWN):
        pictures = [shown(swept_scene(night(light, air=table_air(7.0), sun_zenith=sun_zenith), eye), 0.0) for light in (moon(95.0), None)]
        assert pictures[0].radiance.tobytes() == pictures[1].radiance.tobytes()


def test_a_mirror_sea_shows_a_disc_with_the_solid_angle_of_the_lit_part():
    view = night(moon(70.0, 90.0, 0.0), flat())
    eye = camera(HEIGHT, -19.6, -20.4, 200, azimuth=AZIMUTH, width=0.8, columns=200)
    glint = shown(swept_scene(view, eye), 0.0).glint_radiance
    shown_share = np.count_nonzero(glint) * eye.row_step * eye.column_step * np.cos(np.radians(20.0))
    assert shown_share == pytest.approx(0.5 * np.pi * RADIUS**2, rel=0.02)
