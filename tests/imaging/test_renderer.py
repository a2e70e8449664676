"""Frames of a moving sea: bytes, steps, directions, energy, and what is refused."""

import numba
import numpy as np
import pytest
from render_scenes import camera, elfouhaily, sea_view, shown, swept_scene, table_air

from seaglint.base.errors import DomainError
from seaglint.facet.facet_tables import facet_slopes
from seaglint.imaging.camera.imager import Camera
from seaglint.sea.slopes.cox_munk import cox_munk_anisotropic, cox_munk_isotropic
from seaglint.sea.slopes.slope_statistics import SlopeStatistics
from seaglint.sea.spectra.elfouhaily import ElfouhailySpectrum
from seaglint.sea.tiles import plan_tiles
from seaglint.sea.wave_field import WaveField

WIND = 7.0


@pytest.fixture(scope="module")
def clear_air():
    return table_air(WIND)


def _renderer(air, eye, *, wind=WIND, travel=30.0, sun=(70.0, 0.0), waves=None, **options):
    slopes = cox_munk_anisotropic(wind, np.radians(travel))
    return swept_scene(sea_view(air, slopes, eye.height, *sun), eye, elfouhaily(wind, travel) if waves is None else waves, **options)


def _waves_made_anew(seed=1):
    return elfouhaily.__wrapped__(WIND, seed=seed)


@pytest.mark.parametrize(
    ("top", "bottom", "height"),
    [
        (0.5, -6.0, 30.0),
        (0.2, -2.0, 5.0),
        *(pytest.param(*scene, marks=pytest.mark.validation) for scene in ((-10.0, -60.0, 30.0), (-1.0, -15.0, 500.0))),
    ],
    ids=str,
)
def test_half_the_step_changes_column_means_by_less_than_half_a_percent(clear_air, top, bottom, height):
    eye = camera(height, top, bottom, 100, width=20.0, columns=3)
    coarse = _renderer(clear_air, eye)
    fine = _renderer(clear_air, eye, step=0.5 * coarse.report["sweep_step_m"][0])
    one, other = shown(coarse, 2.0).radiance.mean(axis=0), shown(fine, 2.0).radiance.mean(axis=0)
    np.testing.assert_allclose(one, other, rtol=5e-3)  # the bound


def test_bytes_do_not_depend_on_threads_or_order(clear_air):
    eye = camera(30.0, 0.5, -6.0, 64, width=8.0, columns=16)
    before = numba.get_num_threads()
    if numba.config.NUMBA_NUM_THREADS < 2:
        pytest.skip("needs two threads (NUMBA_NUM_THREADS)")
    try:
        numba.set_num_threads(1)
        alone = shown(_renderer(clear_air, eye, waves=_waves_made_anew()), 37 / 25.0)
        numba.set_num_threads(2)
        other = _renderer(clear_air, eye, waves=_waves_made_anew())
        backwards = {number: shown(other, number / 25.0) for number in (40, 37, 3, 37)}
    finally:
        numba.set_num_threads(before)
    assert alone.radiance.tobytes() == backwards[37].radiance.tobytes()
    assert alone.glint_radiance.tobytes() == backwards[37].glint_radiance.tobytes()
    assert alone.radiance.tobytes() != backwards[40].radiance.tobytes()


def test_the_seed_decides(clear_air):
    eye = camera(30.0, -3.0, -6.0, 16, width=4.0, columns=8)
    one, again, other = (shown(_renderer(clear_air, eye, waves=_waves_made_anew(s)), 0.0).radiance for s in (5, 5, 6))
    assert one.tobytes() == again.tobytes()
    assert np.abs(other / one - 1.0).max() > 0.01


def _shift(pairs, axis, reach):
    """Displacement in pixels along an axis at which the second images are most like the first."""
    score = np.zeros(2 * reach + 1)
    inner = tuple(slice(reach, -reach) if i == axis else slice(None) for i in range(2))
    for one, other in pairs:
        for shift in range(-reach, reach + 1):
            score[shift + reach] += np.corrcoef(one[inner].ravel(), np.roll(other, -shift, axis)[inner].ravel())[0, 1]
    return int(np.argmax(score)) - reach


@pytest.mark.parametrize(
    ("travel", "axis", "sign"),
    [
        pytest.param(90.0, 1, 1, id="to the right"),
        pytest.param(270.0, 1, -1, id="to the left", marks=pytest.mark.validation),
        pytest.param(0.0, 0, -1, id="away: up"),
        pytest.param(180.0, 0, 1, id="nearer: down", marks=pytest.mark.validation),
    ],
)
def test_waves_run_downwind_through_the_image(clear_air, travel, axis, sign):
    """Camera looks north and down; the pattern moves to where the wind blows, at the speed of waves of some metres."""
    height, wind, pause = 100.0, 5.0, 0.25
    eye = camera(height, -50.0, -60.0, 96, width=16.0, columns=96)
    scene = _renderer(clear_air, eye, wind=wind, travel=travel, sun=(120.0, 0.0))
    found = _shift([(shown(scene, t).radiance, shown(scene, t + pause).radiance) for t in np.arange(12) * 7.0], axis, 12)
    distance = height / np.sin(np.radians(55.0))
    pixel = distance * eye.column_step * np.cos(np.radians(55.0)) if axis == 1 else distance * eye.row_step / np.sin(np.radians(55.0))
    # phase speeds of 2 m waves are 1.8 m/s, of the 16 m waves of the peak 5 m/s
    assert 1.0 < sign * found * pixel / pause < 7.0


def test_corridor_lies_under_the_sun_and_columns_run_clockwise(clear_air):
    """A panorama: brightest column towards the Sun's azimuth, darkest away from it; row 0 is sky."""
    eye = Camera(20.0, np.radians(10.0), np.radians(-4.0), 2.0 * np.pi, np.radians(12.0), 72, 48)
    image = shown(_renderer(clear_air, eye, sun=(70.0, 120.0)), 0.0)
    glint = image.glint_radiance.mean(axis=0)
    azimuth = np.degrees(eye.azimuths)
    assert np.all(np.diff(azimuth) > 0.0)
    away = np.abs((azimuth - 120.0 + 180.0) % 360.0 - 180.0)
    assert away[np.argmax(glint)] <= 10.0
    assert glint[away > 90.0].max() < 1e-2 * glint.max()
    centre = np.angle(np.sum(glint * np.exp(1j * np.radians(azimuth))), deg=True)
    assert centre == pytest.approx(120.0, abs=4.0)
    assert np.all(image.glint_radiance[0] == 0.0)
    assert np.all(np.isfinite(image.radiance))
    assert image.radiance.min() > 0.0
    # the joint of the panorama: first and last columns are neighbours and show the same calm background there
    assert image.radiance[:, 0].mean() == pytest.approx(image.radiance[:, -1].mean(), rel=0.05)


@pytest.mark.parametrize(
    ("sun_azimuth", "brighter"),
    [pytest.param(8.0, slice(8, 16), id="right"), pytest.param(-8.0, slice(0, 8), id="left", marks=pytest.mark.validation)],
)
def test_sun_right_of_the_centre_brightens_the_right(clear_air, sun_azimuth, brighter):
    eye = camera(30.0, -2.0, -8.0, 32, width=20.0, columns=16)
    sun = shown(_renderer(clear_air, eye, sun=(75.0, sun_azimuth)), 0.0).glint_radiance
    other = slice(0, 8) if brighter.start else slice(8, 16)
    assert sun[:, brighter].mean() > 1.5 * sun[:, other].mean()


def test_glint_brightens_towards_the_mirror_point_of_a_high_sun(clear_air):
    """Row 0 on top: with the Sun 60 deg up over a light wind the glint grows from the horizon down to a depression of 60 deg."""
    eye = camera(50.0, -20.0, -60.0, 80, width=6.0, columns=6)
    sun = shown(_renderer(clear_air, eye, wind=3.0, sun=(30.0, 0.0)), 0.0).glint_radiance.mean(axis=1)
    assert np.all(np.diff(sun.reshape(4, 20).mean(axis=1)) > 0.0)


@pytest.mark.parametrize("zenith", [91.0, pytest.param(150.0, marks=pytest.mark.validation)])
def test_night_has_no_glint(clear_air, zenith):
    eye = camera(30.0, 1.0, -6.0, 32, width=4.0, columns=4)
    image = shown(_renderer(clear_air, eye, sun=(zenith, 0.0)), 0.0)
    assert np.all(image.glint_radiance == 0.0)
    assert image.radiance.min() > 0.0


@pytest.mark.parametrize("wind", [2.0, 7.0, 15.0])
@pytest.mark.parametrize("slopes_of", ["isotropic", "directional"])
def test_resolved_and_facet_variances_add_up_to_the_model(wind, slopes_of):
    waves = elfouhaily(wind, 40.0)
    to = waves.spectrum.wind_to_azimuth
    total = cox_munk_isotropic(wind) if slopes_of == "isotropic" else cox_munk_anisotropic(wind, to)
    rest, resolved = facet_slopes(total, waves.resolved_mss(), to), waves.resolved_mss()
    for angle, expected in ((to, total.mss_up), (to + 0.5 * np.pi, total.mss_cross)):
        along = resolved[0] * np.cos(angle - to) ** 2 + resolved[1] * np.sin(angle - to) ** 2
        assert rest.mss_along(angle) + along == pytest.approx(expected, rel=1e-9)  # rounding of the sum alone


def test_waves_steeper_than_the_model_are_refused(clear_air):
    waves = elfouhaily(7.0)
    with pytest.raises(DomainError, match="resolve longer waves"):
        facet_slopes(SlopeStatistics(1e-3, 1e-3), waves.resolved_mss(), 0.0)
    eye = camera(30.0, -1.0, -5.0, 8)
    with pytest.raises(DomainError, match="more than the slope model"):
        swept_scene(sea_view(clear_air, SlopeStatistics(1e-3, 1e-3), 30.0), eye, waves)


def test_a_sensor_among_the_waves_is_refused(clear_air):
    waves = elfouhaily(15.0)
    slopes = cox_munk_anisotropic(15.0, np.radians(30.0))
    with pytest.raises(DomainError, match="within reach of the waves"):
        swept_scene(sea_view(clear_air, slopes, 2.0), camera(2.0, 0.0, -4.0, 8), waves)


def test_a_crest_over_the_sensor_is_refused(clear_air):
    """A freak crest can stand above three standard deviations: the frame says so."""
    waves = elfouhaily(10.0)
    height = 0.77 * waves.significant_height
    slopes = cox_munk_anisotropic(10.0, np.radians(30.0))
    scene = swept_scene(sea_view(clear_air, slopes, height), camera(height, 0.0, -4.0, 8), waves)
    calm = scene.surface(0.0)
    flooded = calm._replace(lattice=calm.lattice + np.float32(10.0))
    with pytest.raises(DomainError, match="under the sensor"):
        scene.planes(scene.pose, 0.0, flooded, (0, 1))


def test_camera_and_view_at_different_heights_are_refused(clear_air):
    with pytest.raises(DomainError, match="same height"):
        swept_scene(sea_view(clear_air, cox_munk_isotropic(5.0), 30.0), camera(31.0, 0.0, -4.0, 8))


@pytest.mark.parametrize(
    ("pixels", "width", "height_angle"),
    [((0, 4), 1.0, 1.0), ((4, 0), 1.0, 1.0), ((4, 4), 0.0, 1.0), ((4, 4), 7.0, 1.0), ((4, 4), 1.0, 3.0)],
)
def test_cameras_that_make_no_picture_are_refused(pixels, width, height_angle):
    with pytest.raises(DomainError):
        Camera(10.0, 0.0, -0.5, width, height_angle, *pixels)


def test_camera_angles_are_pixel_centres():
    eye = Camera(10.0, 1.0, -0.2, 0.4, 0.2, 4, 2)
    np.testing.assert_allclose(eye.azimuths, [0.85, 0.95, 1.05, 1.15])
    np.testing.assert_allclose(eye.elevations, [-0.15, -0.25])


def test_only_sky(clear_air):
    eye = camera(30.0, 20.0, 5.0, 10)
    image = shown(_renderer(clear_air, eye, sun=(120.0, 0.0)), 0.0)
    assert np.all(np.diff(image.radiance[:, 0]) > 0.0)  # warmer towards the horizon
    assert np.all(image.glint_radiance == 0.0)


def test_more_lines_make_columns_smoother_but_no_brighter(clear_air):
    """Lines of a column are averaged: the mean stays, the scatter between columns falls."""
    eye = camera(30.0, -1.0, -4.0, 60, width=60.0, columns=24)
    every = {"shortest_wave_columns": 0.0}  # the same waves, whatever the lines
    few, many = (shown(_renderer(clear_air, eye, sun=(120.0, 0.0), lines_per_column=n, **every), 0.0).radiance for n in (1, 16))
    assert many.mean() == pytest.approx(few.mean(), rel=2e-3)
    assert np.diff(many, axis=1).std() < 0.8 * np.diff(few, axis=1).std()


def test_tiles_may_be_fewer():
    """One long tile alone is a sea too: the sweep's short cuts for the last tile hold for it."""
    spectrum = ElfouhailySpectrum(4.0, 0.3)
    tiles = plan_tiles(spectrum, 2.0, 512, tiles=1)
    waves = WaveField.create(spectrum, tiles, 2)
    eye = camera(10.0, 0.5, -5.0, 40, columns=3)
    image = shown(swept_scene(sea_view(table_air(4.0), cox_munk_anisotropic(4.0, 0.3), 10.0), eye, waves), 0.0)
    assert np.all(np.isfinite(image.radiance))
