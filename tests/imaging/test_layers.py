"""Layers of a frame: their sum, what each is, cuts in range, columns alone, other cameras and other realisations of a scene."""

import numpy as np
import pytest
from render_scenes import camera, elfouhaily, sea_view, shown, swept_scene, table_air, turned_scene

from seaglint.base.conventions import surface_range
from seaglint.base.errors import DomainError
from seaglint.base.schema import LAYERS
from seaglint.imaging.camera.imager import Attitude, Imager
from seaglint.imaging.camera.pose import Pose, Track
from seaglint.imaging.scene import image
from seaglint.imaging.sparkle_settings import Sparkles
from seaglint.imaging.upright_scene import composed
from seaglint.radiance.mean_radiance import mean_radiance
from seaglint.sea.slopes.cox_munk import cox_munk_anisotropic

WIND = 7.0
SLOPES = cox_munk_anisotropic(WIND, np.radians(30.0))
SPARKLES = Sparkles(3, 0.003, 0.07, "on")
PARTS = ("path_radiance", "emitted_radiance", "sky_radiance", "glint_radiance")


@pytest.fixture(scope="module")
def clear_air():
    return table_air(WIND)


@pytest.fixture(scope="module")
def swept(clear_air):
    """From the sky over the horizon down to the foreground, towards the Sun, with sparkles."""
    eye = camera(30.0, 0.6, -9.0, 120, width=12.0, columns=24)
    return swept_scene(sea_view(clear_air, SLOPES, 30.0, 70.0), eye, elfouhaily(WIND), layers=LAYERS, sparkles=SPARKLES)


def turned(air, elevation, *, roll=20.0, height=30.0, waves=None, **accuracy):
    eye = Imager("pinhole", np.radians(14.0), np.radians(10.0), 28, 20)
    track = Track.standing(height, Attitude(0.2, np.radians(elevation), np.radians(roll)))
    return turned_scene(lambda h: sea_view(air, SLOPES, h, 70.0), eye, track, waves, layers=LAYERS, **accuracy)


def require_sum(found):
    total = np.sum([found[name].astype(float) for name in PARTS], axis=0)
    np.testing.assert_allclose(total, found.radiance, rtol=1e-6)


def test_the_parts_add_up_to_the_radiance(swept):
    found = shown(swept, 1.0)
    assert set(found) == {"radiance", *LAYERS}
    require_sum(found)
    assert min(found[name].min() for name in PARTS) > -1e-6 * found.radiance.max()
    assert all(found[name].max() > 0.01 * found.radiance.min() for name in PARTS)
    assert 0.02 < np.nanstd(found["slope"]) < 0.3


@pytest.mark.parametrize("elevation", [-4.0, -60.0], ids=["swept", "walked"])
def test_the_parts_of_a_turned_camera_add_up(clear_air, elevation):
    require_sum(shown(turned(clear_air, elevation, waves=elfouhaily(WIND)), 1.0))


def test_asking_for_layers_changes_no_byte_of_the_radiance(clear_air, swept):
    plain = swept_scene(swept.view, swept.camera, swept.waves, sparkles=SPARKLES)
    found, more = shown(plain, 1.0), shown(swept, 1.0)
    assert set(found) == {"radiance", "glint_radiance"}
    assert found.radiance.tobytes() == more.radiance.tobytes()
    assert found.glint_radiance.tobytes() == more.glint_radiance.tobytes()


@pytest.mark.parametrize("sun", [40.0, 100.0])
def test_without_waves_the_layers_are_the_components_of_the_mean(clear_air, sun):
    eye = camera(30.0, -1.0, -40.0, 240, width=8.0, columns=3)
    view = sea_view(clear_air, SLOPES, 30.0, sun)
    found, model = shown(swept_scene(view, eye, layers=LAYERS), 0.0), mean_radiance(view, eye.elevations, eye.azimuths)
    for name, part in zip(PARTS[:3], (model.path, model.emission, model.sky), strict=True):
        # of the whole: tables of facets and path
        np.testing.assert_allclose(found[name], np.broadcast_to(part, found[name].shape), atol=2e-3 * found.radiance.mean(), err_msg=name)


def test_range_and_coverage_of_a_calm_sea(clear_air):
    """Straight distance over the round sea; above the horizon there is none."""
    height = 100.0
    eye = camera(height, 0.5, -30.0, 305)
    found = shown(swept_scene(sea_view(clear_air, SLOPES, height), eye, layers=["range", "coverage"]), 0.0)
    fine = eye.elevations[:, None] - ((np.arange(50) + 0.5) / 50 - 0.5) * eye.row_step
    arc = surface_range(height, -fine)
    seen = np.isfinite(arc)
    psi = arc / (7.0 / 6.0 * 6.371e6)
    radius = 7.0 / 6.0 * 6.371e6
    straight = np.hypot(radius * np.sin(psi), height + radius * (1.0 - np.cos(psi)))
    np.testing.assert_allclose(found["coverage"][:, 0], seen.mean(axis=1), atol=0.03)
    whole = seen.all(axis=1)
    np.testing.assert_allclose(found["range"][whole, 0], straight[whole].mean(axis=1), rtol=3e-3)
    assert np.isnan(found["range"][~seen.any(axis=1), 0]).all()
    assert set(found) == {"radiance", "glint_radiance", "range", "coverage"}


def test_range_of_sweep_and_of_walked_rays(clear_air):
    """The same pixels by both ways: the range differs by less than a step of the sweep."""
    waves = elfouhaily(WIND)
    swept, walked = (
        shown(turned(clear_air, -20.0, height=20.0, waves=waves, walk_below=np.radians(lowest)), 0.7) for lowest in (-60.0, -1.0)
    )
    step = 0.5  # a quarter of the shortest wave, 2 m
    assert np.abs(swept["range"] - walked["range"]).max() < step
    assert np.abs(swept["range"] - walked["range"]).mean() < 0.1 * step
    np.testing.assert_allclose(walked["coverage"], 1.0)


@pytest.mark.parametrize("walked", [False, True], ids=["swept", "walked"])
def test_slope_is_the_rise_of_the_places_seen(clear_air, walked):
    """From the ranges of neighbouring rows, steep enough that no crest hides a trough."""
    height, below = 20.0, {"walk_below": np.radians(-1.0)} if walked else {}
    eye = Imager("pinhole", np.radians(6.0), np.radians(5.0), 28, 30)
    track = Track.standing(height, Attitude(0.2, np.radians(-35.0)))
    scene = turned_scene(lambda h: sea_view(clear_air, SLOPES, h, 70.0), eye, track, elfouhaily(WIND), layers=LAYERS, **below)
    found = shown(scene, 0.7)
    azimuth, elevation = scene.imager.centres(scene.pose.attitude)
    along, up = found["range"] * np.cos(elevation), height + found["range"] * np.sin(elevation)
    rise = (up[:-2] - up[2:]) / (along[:-2] - along[2:])
    slope = found["slope"][1:-1]
    assert np.corrcoef(slope.ravel(), rise.ravel())[0, 1] > 0.95
    assert (slope * rise).sum() / (rise**2).sum() == pytest.approx(1.0, abs=0.06)
    assert azimuth.shape == found["slope"].shape


def test_a_calm_sea_has_no_slope_and_its_glint_a_share(clear_air):
    eye = camera(30.0, 0.5, -30.0, 60, width=8.0, columns=3)
    found = shown(swept_scene(sea_view(clear_air, SLOPES, 30.0, 60.0), eye, layers=LAYERS), 0.0)
    sea = found["coverage"] > 0.0
    assert np.isnan(found["slope"][~sea]).all()
    assert np.all(found["slope"][sea] == 0.0)
    np.testing.assert_allclose(found["glint_share"] * found.radiance, found.glint_radiance, rtol=1e-6)
    assert 0.1 < found["glint_share"].max() < 1.0
    assert not found["object_id"].any()


@pytest.mark.parametrize(
    "cuts",
    [
        pytest.param(np.array([300.0]), id="one"),
        pytest.param(np.array([50.0, 400.0, 401.0, 3000.0]), id="several"),
        pytest.param(np.linspace(200.0, 2000.0, 48).reshape(24, 2), id="by column", marks=pytest.mark.validation),
        pytest.param(np.array([1e9]), id="beyond"),
    ],
)
def test_cuts_in_range_compose_to_the_whole_image(swept, cuts):
    whole, parts = shown(swept, 1.0), swept.intervals(swept.pose, 1.0, cuts)
    assert len(parts) == cuts.shape[-1] + 1
    back = composed(parts)
    for name in whole:
        assert back[name].tobytes() == whole[name].tobytes(), name
        if name not in ("range", "slope"):
            # parts are sums of their own, not what is left of the whole: nothing is negative
            assert min(float(part[name].min()) for part in parts) >= (-1e-12 if name == "sky_radiance" else 0.0), name


def test_an_interval_shows_what_stands_in_it(swept):
    near, middle, far = swept.intervals(swept.pose, 1.0, np.array([300.0, 1000.0]))
    assert np.nanmax(near["range"]) < 300.0 <= np.nanmin(middle["range"])
    assert np.nanmax(middle["range"]) < 1000.0 <= np.nanmin(far["range"])
    # the sky is behind everything
    sky = shown(swept, 1.0)["coverage"] == 0.0
    assert sky.any()
    assert near["radiance"][sky].max() == 0.0
    assert far["radiance"][sky].min() > 0.0
    # near sea fills its columns from below up to its own skyline
    for column in near["coverage"].T:
        assert np.all(np.diff(column) > -1e-9)


def test_columns_alone_are_those_of_the_image(swept):
    whole, part = shown(swept, 2.0), swept.columns(swept.pose, 2.0, (5, 9))
    for name in whole:
        assert part[name].tobytes() == whole[name][:, 5:9].tobytes(), name


def test_every_column_at_its_own_time(swept):
    times = np.repeat([0.0, 0.5, 0.5, 2.0], 6)
    found = swept.scanned([swept.pose] * 24, times.tolist())
    for time in (0.0, 0.5, 2.0):
        frame = shown(swept, time)
        np.testing.assert_array_equal(found.radiance[:, times == time], frame.radiance[:, times == time])
    assert swept.scanned([swept.pose] * 24, [1.0] * 24).radiance.tobytes() == shown(swept, 1.0).radiance.tobytes()
    with pytest.raises(DomainError, match="one of each for every column"):
        swept.scanned([swept.pose], [0.0])


def test_realisations_share_nothing_but_the_sea_state(swept):
    """Sparkles of another seed are others, with and without resolved waves."""
    other = swept.reseeded(17)
    assert np.corrcoef(shown(swept, 0.0).radiance[40:].ravel(), shown(other, 0.0).radiance[40:].ravel())[0, 1] < 0.9
    calm = swept_scene(swept.view, swept.camera, sparkles=SPARKLES)
    one, two, again = (shown(calm.reseeded(seed), 0.0).glint_radiance for seed in (3, 4, 3))
    assert shown(calm, 0.0).glint_radiance.tobytes() == one.tobytes() == again.tobytes()
    mean = shown(swept_scene(swept.view, swept.camera), 0.0).glint_radiance
    lit = mean > 0.05 * mean.max()
    assert lit.sum() > 200
    assert abs(np.corrcoef(one[lit] / mean[lit], two[lit] / mean[lit])[0, 1]) < 0.2


@pytest.mark.validation
def test_a_reseeded_scene_is_the_scene_of_that_seed(clear_air):
    eye = camera(30.0, 0.5, -6.0, 32, width=8.0, columns=8)
    view = sea_view(clear_air, SLOPES, 30.0, 70.0)
    made = swept_scene(view, eye, elfouhaily.__wrapped__(WIND, seed=9), sparkles=Sparkles(9, 0.003, 0.07, "on"))
    other = swept_scene(view, eye, elfouhaily.__wrapped__(WIND, seed=2), sparkles=Sparkles(2, 0.003, 0.07, "on")).reseeded(9)
    assert shown(made, 0.3).radiance.tobytes() == shown(other, 0.3).radiance.tobytes()
    rays = turned(clear_air, -30.0, waves=elfouhaily.__wrapped__(WIND, seed=9))
    other = turned(clear_air, -30.0, waves=elfouhaily.__wrapped__(WIND, seed=2)).reseeded(9)
    assert shown(rays, 0.3).radiance.tobytes() == shown(other, 0.3).radiance.tobytes()


def test_another_camera_inside_the_view(swept):
    eye = swept.camera
    part = camera(eye.height, 0.6 - 0.08 * 20, 0.6 - 0.08 * 60, 40, width=6.0, columns=12)
    one, other = shown(swept.with_camera(part), 1.0).radiance, shown(swept, 1.0).radiance[20:60, 6:18]
    # radiance leans towards the neighbours of a piece: at an edge, and where a run of pieces ends, there is none
    np.testing.assert_allclose(one, other, rtol=0.02)
    assert np.mean(one == other) > 0.9


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"height": 40.0}, "prepared for 30 to 30.6 m"),
        ({"azimuth": 0.1}, "beyond the view that the scene was prepared for"),
        ({"elevation": 0.1}, "beyond the view that the scene was prepared for"),
        ({"columns": 48}, "keep the pixels"),
    ],
)
def test_a_camera_outside_what_was_prepared_is_refused(swept, change, message):
    from dataclasses import replace

    with pytest.raises(DomainError, match=message) as caught:
        swept.with_camera(replace(swept.camera, **change))
    assert "\n" not in str(caught.value)


def test_a_turned_scene_takes_other_cameras_inside_its_view(clear_air):
    scene = turned(clear_air, -5.0, roll=0.0, waves=elfouhaily(WIND))
    narrow = Imager("pinhole", np.radians(7.0), np.radians(5.0), 14, 10)
    assert shown(scene.with_camera(narrow), 0.0).radiance.mean() == pytest.approx(shown(scene, 0.0).radiance[5:15, 7:21].mean(), rel=0.05)
    with pytest.raises(DomainError, match="prepare a scene"):
        scene.with_camera(Imager("pinhole", np.radians(20.0), np.radians(5.0), 14, 10))


@pytest.mark.parametrize(
    "pose",
    [
        Pose(0.0, 0.0, 30.0, Attitude(0.2 + 0.5 * np.pi, np.radians(-5.0), 0.35)),
        Pose(0.0, 0.0, 300.0, Attitude(0.2, np.radians(-5.0), np.radians(20.0))),
        Pose(np.nan, 0.0, 30.0, Attitude(0.2, np.radians(-5.0), np.radians(20.0))),
    ],
)
def test_a_turned_scene_refuses_poses_off_its_track(clear_air, pose):
    scene = turned(clear_air, -5.0)
    with pytest.raises(DomainError, match="prepare"):
        image(scene, pose, 0.0)
    again = Pose(0.0, 0.0, 30.0, Attitude(0.2 + 2.0 * np.pi, np.radians(-5.0), np.radians(20.0)))
    assert image(scene, again, 0.0).radiance.shape == (20, 28)


@pytest.mark.parametrize("part", [(4, 40), (-4, 2), (3, 3)])
def test_columns_that_there_are_not_are_refused(swept, part):
    with pytest.raises(DomainError, match="0 <= first < end <= 24"):
        swept.columns(swept.pose, 0.0, part)


@pytest.mark.parametrize("cuts", [np.empty(0), np.ones((3, 2)), np.ones((24, 2, 1)), np.array([np.nan])])
def test_cuts_that_are_none_are_refused(swept, cuts):
    with pytest.raises(DomainError, match="cuts"):
        swept.intervals(swept.pose, 0.0, cuts)


@pytest.mark.validation
def test_a_panorama_can_be_cut_into_looks(clear_air):
    eye = camera(30.0, -1.0, -6.0, 20, width=360.0, columns=72)
    whole = swept_scene(sea_view(clear_air, SLOPES, 30.0, 70.0), eye, elfouhaily(WIND))
    look = camera(30.0, -1.0, -6.0, 20, azimuth=370.0, width=20.0, columns=4)  # ten degrees, once round
    one, all_round = shown(whole.with_camera(look), 0.0).radiance, shown(whole, 0.0).radiance
    np.testing.assert_allclose(one, all_round[:, 36:40], rtol=1e-3)


@pytest.mark.parametrize("pose", [Pose(0.0, 0.0, 31.0, Attitude(0.0, np.radians(-4.2))), Pose(0.0, 0.0, 30.0, Attitude(0.0, -0.3))])
def test_a_pose_of_another_camera_is_refused(swept, pose):
    with pytest.raises(DomainError, match="with_camera"):
        image(swept, pose, 0.0)


def test_layers_that_there_are_not_are_refused(swept):
    with pytest.raises(DomainError, match=r"layer 'rnage' is not one of path_radiance, .*coverage"):
        swept_scene(swept.view, swept.camera, layers=["rnage"])
    with pytest.raises(DomainError, match="ascend"):
        swept.intervals(swept.pose, 0.0, np.array([400.0, 300.0]))
