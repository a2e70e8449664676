"""Cameras in any attitude: areas, turns, horizon, panorama, nadir, and the sweep against rays."""

import numpy as np
import pytest
from render_scenes import SEA_TEMPERATURE, Furnace, WarmSky, elfouhaily, one_tile, sea_view, shown, swept_scene
from view_scenes import COARSE, SLOPES, WIND, attitude, imager, likeness, moving, prepared_view

from seaglint.base.conventions import horizon_depression
from seaglint.base.errors import DomainError
from seaglint.facet.legs import Shadowing
from seaglint.imaging.camera.imager import Camera, cells_of, inside, quads
from seaglint.imaging.launch import weights_of
from seaglint.radiance.mean_radiance import mean_radiance


@pytest.fixture(scope="module")
def warm_sky():
    return WarmSky(COARSE)


@pytest.fixture(scope="module")
def waves():
    return elfouhaily(WIND, shortest_wave=8.0)


def test_equal_angles_without_roll_are_the_cameras_grid():
    eye, pointing = imager("equal-angle", 360.0, 8.0, 36, 8), attitude(70.0, -3.0)
    azimuth, elevation = eye.centres(pointing)
    grid = eye.camera(30.0, pointing)
    assert grid is not None
    np.testing.assert_allclose(azimuth, np.broadcast_to(grid.azimuths, azimuth.shape), atol=1e-12)
    np.testing.assert_allclose(elevation, np.broadcast_to(grid.elevations[:, None], elevation.shape), atol=1e-12)


@pytest.mark.parametrize("projection", ["equal-angle", "pinhole"])
def test_a_positive_roll_puts_the_right_side_down(projection):
    v = imager(projection, 40.0, 30.0).directions(attitude(0.0, 0.0, 30.0), [0.0, 16.0, 32.0], 12.0)
    assert v[0, 2] > 0.0 > v[2, 2]
    np.testing.assert_allclose(v[1], [0.0, 1.0, 0.0], atol=1e-12)
    np.testing.assert_allclose(np.arcsin(v[2, 2]), -np.arcsin(np.sin(np.radians(30.0)) * np.sin(np.radians(20.0))), atol=1e-12)


def test_a_fully_turned_plane_image_looks_the_same_way():
    eye = imager(width=10.0, height=10.0, columns=8, rows=8)
    one, turned = eye.corners(attitude(20.0, -40.0)), eye.corners(attitude(20.0, -40.0, 90.0))
    # the camera turns clockwise, so its image turns the other way
    np.testing.assert_allclose(turned, np.rot90(one), atol=1e-12)


@pytest.mark.parametrize(("elevation", "roll"), [(-6.0, 20.0), (-30.0, -75.0), (-6.0, 0.0)])
def test_weights_sum_to_one_and_conserve_energy(elevation, roll):
    pointing, eye = attitude(10.0, elevation, roll), imager(columns=40, rows=30)
    corner = eye.corners(pointing)
    grid = Camera(30.0, np.radians(10.0), np.radians(elevation), np.radians(30.0), np.radians(16.0), 90, 64)
    cells = cells_of(grid)
    pixels = np.arange(eye.rows * eye.columns)
    found = quads(corner, pixels, cells, pointing.azimuth)
    assert inside(found, cells).all()
    sampled = weights_of(found, pixels, cells)
    used = np.concatenate([np.arange(a, a + n) for a, n in zip(sampled.start, sampled.count, strict=False)])
    sums = np.add.reduceat(sampled.weight[used], np.concatenate([[0], np.cumsum(sampled.count)[:-1]]))
    np.testing.assert_allclose(sums, 1.0, atol=1e-6)
    # solid angle of the quadrilaterals, from the cross product of their diagonals
    u, s = found.column, found.sine
    solid = 0.5 * np.abs((u[:, 2] - u[:, 0]) * (s[:, 3] - s[:, 1]) - (u[:, 3] - u[:, 1]) * (s[:, 2] - s[:, 0]))
    taken = np.bincount(sampled.index[used], sampled.weight[used] * np.repeat(solid, sampled.count), minlength=grid.rows * grid.columns)
    whole = (cells.edges[:-1] - cells.edges[1:])[:, None] * np.ones(grid.columns)
    # a cell in the middle of the image belongs to its pixels in whole, once
    middle = np.s_[grid.rows // 2 - 6 : grid.rows // 2 + 6, 42:48]
    np.testing.assert_allclose(taken.reshape(whole.shape)[middle], whole[middle], rtol=1e-6)
    assert taken.sum() == pytest.approx(solid.sum(), rel=1e-6)


def test_roll_of_nothing_is_the_sweeps_own_image(warm_sky, waves):
    eye, pointing = imager("equal-angle"), attitude(5.0, -8.0)
    grid = eye.camera(30.0, pointing)
    plain = shown(swept_scene(sea_view(warm_sky, SLOPES, 30.0, shadowing=Shadowing(bands=1)), grid, waves), 1.0).radiance
    found = shown(prepared_view(warm_sky, eye, pointing, waves), 1.0).radiance
    assert found.mean() == pytest.approx(plain.mean(), rel=2e-3)  # other lines of sight in the columns
    assert likeness(found, plain) > 0.98


def test_roll_of_a_right_angle_turns_the_picture(warm_sky, waves):
    eye = imager(width=9.0, height=9.0, columns=24, rows=24)
    upright = shown(prepared_view(warm_sky, eye, attitude(0.0, -10.0), waves), 2.0).radiance
    turned = shown(prepared_view(warm_sky, eye, attitude(0.0, -10.0, 90.0), waves), 2.0).radiance
    assert turned.mean() == pytest.approx(upright.mean(), rel=1e-3)
    assert likeness(turned, np.rot90(upright)) > 0.99
    assert likeness(turned, np.rot90(upright, -1)) < 0.5


@pytest.mark.parametrize(
    "pointing",
    [(0, -3, 25), (200, -90, 10), (10, 85, 0), (40, -42, 0), pytest.param((90, -50, 180), marks=pytest.mark.validation)],
    ids=str,
)
def test_a_closed_cavity_is_flat_in_any_attitude(pointing, waves):
    oven = Furnace(SEA_TEMPERATURE, COARSE, 1e-4)
    found = prepared_view(oven, imager(width=50.0, height=40.0, columns=8, rows=6), attitude(*pointing), waves, sun=(120.0, 0.0))
    radiances = shown(found, 0.5)
    image = radiances.radiance
    assert np.all(np.isfinite(image))
    assert np.ptp(image) < 1e-3 * image.mean()  # the spectral terms kept (2e-3 of a spectrum, less of a band)
    assert radiances.glint_radiance.max() == 0.0


@pytest.mark.parametrize(("elevation", "roll"), [(0.0, 20.0), (-3.0, -60.0), (2.0, 180.0)])
def test_the_horizon_is_where_geometry_puts_it(warm_sky, elevation, roll):
    height = 200.0
    eye, pointing = imager(columns=48, rows=36), attitude(30.0, elevation, roll)
    view = prepared_view(warm_sky, eye, pointing, height=height, sun=(120.0, 0.0))
    image = shown(view, 0.0).radiance
    _, centre = eye.centres(pointing)
    above = centre + horizon_depression(height)
    pixel = 0.75 * np.hypot(eye.width / eye.columns, eye.height_angle / eye.rows)
    sky, sea = image[above > pixel], image[above < -pixel]
    # the sky is at 280 K there and the sea at 288 K mirrors it: no value between them is shared
    assert sky.max() < sea.min()
    across = np.abs(above) < 0.1 * pixel
    assert np.all((image[across] > sky.min()) & (image[across] < sea.max()))


@pytest.mark.parametrize("roll", [3.0, pytest.param(0.0, marks=pytest.mark.validation)])
def test_a_panorama_has_no_seam(warm_sky, waves, roll):
    """The same picture from its other end, where the edges of one are the middle of the other; an axis is turned the other way there."""
    eye = imager("equal-angle", 360.0, 12.0, 36, 6)
    one, other = (shown(prepared_view(warm_sky, eye, attitude(a, 0.0, r), waves), 0.0).radiance for a, r in ((0.0, roll), (180.0, -roll)))
    assert likeness(np.roll(other, 18, axis=1), one) > 0.999
    ends = [np.concatenate([image[:, -2:], image[:, :2]], axis=1) for image in (one, np.roll(other, 18, axis=1))]
    np.testing.assert_allclose(*ends, rtol=0.03)  # other columns of the sweep


@pytest.mark.parametrize(("elevation", "sun"), [(-90.0, 30.0), (-65.0, 20.0), (-45.0, 100.0)])
def test_rays_see_the_mean_model_on_a_sea_without_waves(warm_sky, elevation, sun):
    eye, pointing = imager(width=30.0, height=20.0, columns=5, rows=3), attitude(15.0, elevation, 40.0)
    found = prepared_view(warm_sky, eye, pointing, height=100.0, sun=(sun, 60.0), walk_below=np.radians(-1.0))
    image = shown(found, 0.0).radiance
    corner = eye.directions(pointing, np.arange(5) + 0.5, np.arange(3)[:, None] + 0.5).reshape(-1, 3)
    view = sea_view(warm_sky, SLOPES, 100.0, sun, 60.0)
    model = [float(mean_radiance(view, [np.arcsin(v[2])], [np.arctan2(v[0], v[1])]).total[0, 0]) for v in corner]
    # a pixel is the mean over its 6 degrees, the model its centre
    np.testing.assert_allclose(image.ravel(), model, rtol=3e-2)
    assert image.mean() == pytest.approx(np.mean(model), rel=5e-3)


@pytest.mark.parametrize("height", [30.0, pytest.param(150.0, marks=pytest.mark.validation)])
def test_rays_and_the_sweep_see_the_same_sea(warm_sky, waves, height):
    eye, pointing = imager(columns=48, rows=36), attitude(10.0, -32.0, 15.0)
    swept = shown(prepared_view(warm_sky, eye, pointing, waves, height=height, walk_below=np.radians(-60.0)), 1.0)
    walked = shown(prepared_view(warm_sky, eye, pointing, waves, height=height, walk_below=np.radians(-10.0)), 1.0)
    assert swept.radiance.mean() == pytest.approx(walked.radiance.mean(), rel=1e-3)
    assert swept.glint_radiance.mean() == pytest.approx(walked.glint_radiance.mean(), rel=2e-3)
    assert likeness(swept.radiance, walked.radiance) > 0.995
    assert swept.radiance.std() == pytest.approx(walked.radiance.std(), rel=0.04)  # three cells of the sweep across a pixel


def test_one_image_of_both_has_no_step_between_them(warm_sky, waves):
    eye, pointing = imager(width=24.0, height=18.0, columns=48, rows=36), attitude(10.0, -40.0)
    both = prepared_view(warm_sky, eye, pointing, waves)
    assert 0 < both.report["pixels_walked"] < eye.columns * eye.rows
    rays = prepared_view(warm_sky, eye, pointing, waves, walk_below=np.radians(-10.0))
    one, other = shown(both, 1.0).radiance, shown(rays, 1.0).radiance
    assert likeness(one, other) > 0.998
    assert np.all(np.abs(one.mean(axis=1) / other.mean(axis=1) - 1.0) < 5e-3)


@pytest.mark.parametrize("elevation", [-12.0, -60.0], ids=["swept", "walked"])
def test_a_sensor_moved_by_the_seas_period_sees_the_same(warm_sky, elevation):
    sea = one_tile(turn=0.4)
    length, turn = sea.tiles[0].length, sea.tiles[0].rotation
    period = (length * np.cos(turn), length * np.sin(turn))
    eye, pointing = imager(columns=24, rows=18), attitude(200.0, elevation, 10.0)
    here, there, between = (
        shown(prepared_view(warm_sky, eye, pointing, sea, place=place), 3.0).radiance
        for place in ((0.0, 0.0), period, (0.37 * period[0], 0.37 * period[1]))
    )
    np.testing.assert_allclose(there, here, rtol=1e-4)  # float32 lattices, positions to nanometres
    assert np.abs(between / here - 1.0).max() > 1e-3


@pytest.mark.validation
def test_a_frame_alone_is_that_of_the_sequence(warm_sky, waves):
    several = moving(warm_sky, waves)
    frames = [shown(several, t).radiance for t in (0.0, 0.3, 0.6)]
    assert shown(moving(warm_sky, waves), 0.6).radiance.tobytes() == frames[2].tobytes()
    assert shown(several, 0.3).radiance.tobytes() == frames[1].tobytes()


def test_a_moving_sensor_sees_at_each_instant_what_a_standing_one_there_sees(warm_sky, waves):
    """The air is that of a height up to 2 % lower, the geometry exact."""
    time = 0.62
    way = moving(warm_sky, waves)
    pose = way.track.at(time)
    still = shown(
        prepared_view(warm_sky, way.imager, pose.attitude, waves, height=pose.height, place=(pose.east, pose.north)), time
    ).radiance
    found = shown(way, time).radiance
    assert found.mean() == pytest.approx(still.mean(), rel=1e-3)
    assert likeness(found, still) > 0.98  # other columns of the sweep


def test_a_sensor_among_the_crests_is_refused(warm_sky, waves):
    with pytest.raises(DomainError, match=r"place it above .* m or do not resolve waves"):
        prepared_view(warm_sky, imager(), attitude(0.0, -5.0), waves, height=0.2)


@pytest.mark.parametrize("width", [171.0, 0.0])
def test_impossible_plane_images_are_refused(width):
    with pytest.raises(DomainError, match="pinhole"):
        imager(width=width)
