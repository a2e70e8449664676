"""Objects in the picture against closed forms, rays of the tests' own, and the picture without them."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from seaglint.air.protocol import wavenumber_grid
from seaglint.air.vacuum import VacuumAtmosphere
from seaglint.base.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.base.errors import DataError, DomainError
from seaglint.base.threads import thread_limit
from seaglint.formats.object_labels import Labels, run_lengths, write_labels
from seaglint.imaging.camera.imager import Attitude, Imager
from seaglint.imaging.camera.pose import Pose
from seaglint.imaging.launch import surface_of
from seaglint.imaging.scene import Levels
from seaglint.objects import solids
from seaglint.objects.body import Body, GasPlume, Placement, PointSource
from seaglint.objects.drawing.compose import composed
from seaglint.objects.drawing.draw import Drawer, DrawnBodies, Stage, solid_angles
from seaglint.objects.drawing.light import Surroundings
from seaglint.objects.drawing.sample_sums import COVER, SUN
from seaglint.objects.drawing.truth import labels
from seaglint.objects.solids import placed, solid
from seaglint.scenario.load import parse_scenario
from seaglint.studies.sequence.render_sequence import prepare_sequence, render

EYE = 20.0
HOT = 350.0
AIR = {"source": "isothermal", "temperature_k": 288.15, "extinction_per_km": 0.1}
CALM = {"sea": {"resolve_waves": False}, "atmosphere": AIR}


@dataclass
class Still:
    """Where it always is."""

    position: tuple[float, float, float]
    rotation: np.ndarray | None = None

    def at(self, time: float) -> Placement:
        return Placement(np.array(self.position), np.eye(3) if self.rotation is None else self.rotation)


def body(mesh: solids.Mesh, position, rotation=None, *, kelvin=HOT, emissivity=1.0, name="it") -> Body:
    return Body(name, (solid(mesh, kelvin, emissivity),), Still(position, rotation))


@cache
def calm():
    """A calm sea in air of its own temperature, seen northwards."""
    sensor = {"pixels": [128, 96], "fov_deg": [2.0, 1.5], "elevation_deg": -0.5, "azimuth_deg": 0.0, "height_m": EYE}
    return prepare_sequence(parse_scenario({"sensor": sensor, "sun": {"zenith_deg": 60.0, "azimuth_deg": 180.0}, **CALM}))


def stage(imager: Imager | None = None, attitude: Attitude | None = None, height: float = EYE, sea=None) -> Stage:
    scene = calm().scene
    pixels = imager or scene.pixels
    pose = Pose(0.0, 0.0, height, attitude or scene.pose.attitude)
    return Stage(pixels, pose, scene.view, sea, (0, pixels.columns), (0, pixels.rows))


def draw(*bodies: Body, at: Stage | None = None) -> DrawnBodies:
    return Drawer.of(bodies).picture(at or stage(), 0.0)


def covered(picture: DrawnBodies, at: Stage, number: int = 0) -> float:
    """Solid angle of what a body covers [sr], from its shares of pixels."""
    total = 0.0
    for patch in picture.patches:
        if patch.placed.part.body == number:
            solid_angle = at.imager.solid_angle(at.pose.attitude, patch.columns + 0.5, patch.rows[:, None] + 0.5)
            total += float((patch.planes[COVER] * solid_angle).sum())
    return total


def cap(radius: float, place: np.ndarray) -> float:
    """Solid angle of a sphere [sr]."""
    return 2.0 * math.pi * (1.0 - math.sqrt(1.0 - (radius / float(np.linalg.norm(place))) ** 2))


ROLLED = (Imager("pinhole", 0.04, 0.03, 128, 96), Attitude(0.01, -0.006, 0.4))
TURNED = (Imager("equal-angle", 0.04, 0.03, 128, 96), Attitude(0.01, -0.006, -0.7))


@pytest.mark.parametrize("eye", [(None, None), ROLLED, TURNED], ids=["upright", "plane", "rolled"])
@pytest.mark.parametrize(("radius", "east", "error"), [(3.0, 4.0, 2e-3), (0.3, 4.13, 5e-3), (0.001, 4.27, 5e-3)])
def test_a_sphere_covers_its_solid_angle(eye, radius, east, error):
    at = stage(*eye)
    picture = draw(body(solids.sphere(radius), (east, 1000.0, 15.0)), at=at)
    assert covered(picture, at) == pytest.approx(cap(radius, picture.stands[0].place), rel=error)


def test_what_arrives_is_radiance_times_solid_angle_times_transmittance():
    run = calm()
    at, sea, view = stage(), run.at(0.0), run.scene.view
    drawer = Drawer.of((body(solids.sphere(2.0), (3.0, 1500.0, 6.0)),))
    picture = drawer.picture(at, 0.0)
    found, sights = composed(sea, at, picture, drawer.light(view))
    pixel = at.imager.solid_angle(at.pose.attitude, np.arange(128) + 0.5, np.arange(96)[:, None] + 0.5)
    arrived = float(((found.radiance.astype(float) - sea.radiance) * pixel).sum())
    place = picture.stands[0].place
    warm, cold = view.band.radiance(np.array([HOT, 288.15]), view.atmosphere.wavenumber_cm)
    # in a cavity the path gives back what it takes of the cold
    assert arrived == pytest.approx((warm - cold) * math.exp(-1e-4 * np.linalg.norm(place)) * cap(2.0, place), rel=3e-3)
    numbers, masks, _ = labels(sights, sea.radiance, drawer.light(view).kelvin)
    assert numbers["contrast_W_m2_sr"][0] * numbers["solid_angle_sr"][0] == pytest.approx(arrived, rel=1e-4)
    weight = (found.radiance.astype(float) - sea.radiance) * pixel
    assert numbers["column_px"][0] == pytest.approx((weight * np.arange(128)).sum() / arrived, abs=0.01)
    assert numbers["row_px"][0] == pytest.approx((weight * np.arange(96)[:, None]).sum() / arrived, abs=0.01)
    assert np.array_equal(masks[0], found.radiance != sea.radiance)
    assert numbers["pixels"][0] == pytest.approx(cap(2.0, place) / pixel[0, 0], rel=5e-3)


@pytest.mark.parametrize("seed", range(10))
def test_a_cylinder_at_any_attitude_covers_its_projected_area(seed):
    turn = Rotation.random(random_state=seed).as_matrix()
    at, radius, length = stage(), 0.4, 6.0
    picture = draw(body(solids.cylinder(radius, length), (2.0, 1200.0, 12.0), turn), at=at)
    sight = picture.stands[0].place
    cosine = abs(float(turn[:, 2] @ sight)) / float(np.linalg.norm(sight))
    area = 2.0 * radius * length * math.sqrt(1.0 - cosine**2) + math.pi * radius**2 * cosine
    assert covered(picture, at) == pytest.approx(area / float(sight @ sight), rel=5e-3)


@pytest.mark.parametrize("size", [0.02, 0.6, 6.0])
@pytest.mark.parametrize("seed", range(4))
def test_a_thin_pole_covers_its_area_at_any_attitude_and_size(size, seed):
    turn = Rotation.random(random_state=seed).as_matrix()
    at, sides = stage(), size * np.array([0.03, 1.0, 0.05])
    picture = draw(body(solids.box(tuple(sides)), (2.0, 1200.0, 12.0), turn), at=at)
    sight = picture.stands[0].place
    area = float(np.abs(turn.T @ sight / np.linalg.norm(sight)) @ (sides.prod() / sides))
    # samples alone would miss it by several per cent; what is left is perspective and how its corners fall into cells
    assert covered(picture, at) == pytest.approx(area / float(sight @ sight), rel=2e-3)
    assert picture.patches[0].sums[0] == pytest.approx(covered(picture, at), rel=1e-4)


def _hit(vertices: np.ndarray, triangles: np.ndarray, rays: np.ndarray) -> np.ndarray:
    """Whether rays from the origin meet triangles, one by one (Moeller and Trumbore)."""
    met = np.zeros(len(rays), bool)
    for a, b, c in vertices[triangles]:
        e, f = b - a, c - a
        p = np.cross(rays, f)
        det = p @ e
        with np.errstate(divide="ignore", invalid="ignore"):
            u = (p @ -a) / det
            q = np.cross(-a, e)
            v = (rays @ q) / det
            met |= (u >= 0.0) & (v >= 0.0) & (u + v <= 1.0) & (f @ q / det > 0.0)
    return met


@pytest.mark.validation
def test_a_hollow_body_covers_what_rays_of_another_tracer_meet():
    ring = solids.cylinder(2.0, 1.0)
    leaning, turned = (Rotation.from_euler("xy", angles, degrees=True).as_matrix() for angles in ([40.0, 0.0], [35.0, 20.0]))
    post = placed(solid(solids.box((0.5, 0.5, 5.0)), HOT, 1.0), (1.0, 0.0, 0.0), leaning)
    it = Body("it", (solid(ring, HOT, 1.0), post), Still((0.0, 300.0, 14.0), turned))
    at = stage()
    picture = draw(it, at=at)
    patch = picture.patches[0]
    column, row = patch.columns[patch.columns.size // 2], patch.rows[0] + np.arange(patch.rows.size)
    n = 24
    across, down = (column + (np.arange(n) + 0.5) / n, row[0] + (np.arange(n * row.size) + 0.5) / n)
    rays = at.imager.directions(at.pose.attitude, across, down[:, None]).reshape(-1, 3)
    mesh = patch.placed.part.kind
    met = _hit(patch.placed.surface, mesh.corners, rays).reshape(row.size, n, n).mean(axis=(1, 2))
    np.testing.assert_allclose(patch.planes[COVER][:, column - patch.columns[0]], met, atol=0.03)
    assert patch.planes[COVER][:, column - patch.columns[0]].mean() == pytest.approx(met.mean(), abs=2e-3)


def test_a_body_behind_the_horizon_shows_what_the_round_sea_leaves():
    imager, far = Imager("equal-angle", 0.004, 0.004, 64, 256), 30_000.0
    at = stage(imager, Attitude(0.0, -0.002))
    picture = draw(body(solids.box((40.0, 1.0, 60.0)), (0.0, far, 30.0)), at=at)
    hidden = (far - math.sqrt(2.0 * EFFECTIVE_EARTH_RADIUS * EYE)) ** 2 / (2.0 * EFFECTIVE_EARTH_RADIUS)
    shown = covered(picture, at) / (40.0 / far**2)
    assert shown == pytest.approx(60.0 - hidden, abs=0.01 * far * imager.height_angle / 256)
    assert 5.0 < hidden < 55.0


class _Sea:
    """A level of detail without tiles: what the walk asks of it."""

    begins, steps, shortest = np.zeros(1), np.array([0.5]), np.array([8.0])


def _swell(amplitude: float, length: float):
    """Waves whose crests lie across the line of sight, the first a quarter of a wave away from the sensor."""
    size, spacing = 64, length / 64
    lattice = np.zeros((size, size, 2), np.float32)
    lattice[..., 0] = (amplitude * np.sin(2.0 * np.pi * np.arange(size) / size))[:, None]
    return surface_of((lattice,), np.array([spacing]), np.zeros(1))


def test_a_pole_behind_a_crest_is_cut_where_geometry_says():
    amplitude, length, far, eye = 2.0, 64.0, 620.0, 6.0
    imager = Imager("equal-angle", 0.01, 0.03, 32, 512)
    levels: Levels = _Sea()  # type: ignore[assignment]
    at = stage(imager, Attitude(0.0, 0.0), eye, (levels, _swell(amplitude, length)))
    picture = draw(body(solids.box((0.5, 0.5, 16.0)), (0.0, far, 4.0)), at=at)
    arc = np.arange(10.0, far, 0.01)
    drop = eye + arc**2 / (2.0 * EFFECTIVE_EARTH_RADIUS)
    highest = ((amplitude * np.sin(2.0 * np.pi * arc / length) - drop) / arc).max()
    lowest = highest * (far - 0.25) + eye + far**2 / (2.0 * EFFECTIVE_EARTH_RADIUS)
    shown = covered(picture, at) / (0.5 / far**2)
    assert lowest > 0.5  # the sea itself stands lower there
    assert shown == pytest.approx(12.0 - lowest, abs=0.5 * far * imager.height_angle / 512)


def test_a_cavity_shows_no_body_of_its_own_temperature():
    run, sea = calm(), calm().at(0.0)
    for emissivity, error in ((1.0, 1e-5), (0.6, 2e-3)):
        scene = replace(run.scene.view, solar_zenith=math.pi)
        at = replace(stage(), view=scene)
        drawer = Drawer.of((body(solids.box((6.0, 6.0, 6.0)), (2.0, 900.0, 3.0), kelvin=288.15, emissivity=emissivity),))
        found, _ = composed(sea, at, drawer.picture(at, 0.0), drawer.light(scene))
        np.testing.assert_allclose(found.radiance, sea.radiance, rtol=error)


def test_what_stands_in_front_hides_and_both_add_up():
    at = stage()
    near, far = body(solids.box((4.0, 1.0, 4.0)), (0.0, 700.0, 12.0)), body(solids.box((8.0, 1.0, 8.0)), (1.0, 900.0, 11.0))
    both = draw(near, far, at=at)
    alone = covered(draw(far, at=at), at)
    hidden = alone - covered(both, at, 1)
    assert covered(both, at, 0) == pytest.approx(covered(draw(near, at=at), at), rel=1e-9)
    assert hidden == pytest.approx(covered(both, at, 0), rel=5e-3)


def test_a_wall_shades_the_ground_behind_it():
    view = replace(calm().scene.view, atmosphere=VacuumAtmosphere(wavenumber_grid(3.5, 5.0)))
    at = replace(stage(Imager("equal-angle", 0.02, 0.02, 200, 200), Attitude(0.0, math.radians(-40.0)), 2000.0), view=view)
    floor = solid(solids.box((20.0, 20.0, 1.0)), 300.0, 0.5)
    wall = placed(solid(solids.box((20.0, 0.2, 4.0)), 300.0, 0.5), (0.0, -5.0, 2.5), np.eye(3))
    where = (0.0, 2000.0 / math.tan(math.radians(40.0)), 20.0)
    open_floor = draw(Body("floor", (floor,), Still(where)), at=at).patches[0].planes
    walled = draw(Body("both", (floor, wall), Still(where)), at=at).patches[0].planes
    inner = open_floor[COVER] > 0.99
    # half of the sunlight, at its cosine on the floor, which leans from the Sun by the arc's angle
    assert np.median(open_floor[SUN][inner]) == pytest.approx(
        0.5 * view.in_band(view.atmosphere.solar_irradiance(math.pi / 3)) / 2 / math.pi, rel=1e-3
    )
    dark = float(np.clip(1.0 - walled[SUN] / np.median(open_floor[SUN][inner]), 0.0, 1.0)[inner].sum()) / inner.sum()
    # behind the wall, 4 m high, lies its shadow, of which the wall itself hides a part from the sensor
    assert dark == pytest.approx((4.0 * math.tan(math.pi / 3) - 4.0 / math.tan(math.radians(40.0))) / 20.0, abs=0.015)


def test_a_plume_takes_its_share_of_what_is_behind():
    at, radius, emissivity = stage(), 3.0, 0.4
    gas = Body("gas", (GasPlume((0.0, 0.0, 0.0), (radius,) * 3, 600.0, emissivity),), Still((1.0, 900.0, 12.0)))
    picture = draw(gas, at=at)
    b = (np.arange(4000) + 0.5) / 4000
    area = np.sum(2.0 * np.pi * b * (1.0 - (1.0 - emissivity) ** np.sqrt(1.0 - b**2))) / 4000 * radius**2
    assert covered(picture, at) == pytest.approx(area / float(picture.stands[0].place @ picture.stands[0].place), rel=3e-3)
    behind = draw(gas, body(solids.sphere(1.0), (1.0, 950.0, 11.8)), at=at)
    alone = covered(draw(body(solids.sphere(1.0), (1.0, 950.0, 11.8)), at=at), at)
    assert covered(behind, at, 1) == pytest.approx(alone * (1.0 - emissivity), rel=0.05)


@pytest.mark.parametrize("semi_axes", [(3.0, 3.0, 3.0), (1.0, 6.0, 2.0)])
def test_the_whole_of_a_plume_is_what_it_covers_and_of_a_solid_too(semi_axes):
    """The solid angle that is told without looking at pixels, against the sum over the pixels of a picture that nothing hides."""
    at = stage()
    turned = Rotation.from_euler("zyx", [0.4, 0.2, 0.3]).as_matrix()
    gas = Body("gas", (GasPlume((0.0, 0.0, 0.0), semi_axes, 600.0, 0.4),), Still((1.0, 900.0, 12.0), turned))
    hull = body(solids.ellipsoid(semi_axes), (1.0, 900.0, 12.0), turned)
    for one in (gas, hull):
        picture = draw(one, at=at)
        cover = Surroundings.of(at.view).cover_of
        assert solid_angles(picture.placed[0], (), cover)[0] == pytest.approx(covered(picture, at), rel=3e-3)


def test_a_point_sends_its_intensity_through_the_air():
    run, at = calm(), stage()
    sea = run.at(0.0)
    drawer = Drawer.of((Body("star", (PointSource(intensity=50.0),), Still((1.0, 2000.0, 12.0))),))
    picture = drawer.picture(at, 0.0)
    found, sights = composed(sea, at, picture, drawer.light(at.view))
    distance = float(np.linalg.norm(picture.stands[0].place))
    numbers = labels(sights, sea.radiance, drawer.light(at.view).kelvin)[0]
    assert numbers["irradiance_W_m2"][0] == pytest.approx(50.0 * math.exp(-1e-4 * distance) / distance**2, rel=1e-6)
    assert np.count_nonzero(found.radiance != sea.radiance) == 1
    hidden = Drawer.of((*drawer.bodies, body(solids.box((2.0, 2.0, 2.0)), (1.0, 1500.0, 14.0))))
    assert not [p for p in hidden.picture(at, 0.0).patches if p.clear > 0.0]


def test_the_sensor_cannot_be_inside():
    with pytest.raises(DomainError, match="'hull': the sensor is inside it; move it"):
        draw(body(solids.box((10.0, 10.0, 60.0)), (0.0, 2.0, 0.0), name="hull"))


SCENE = {
    "sensor": {"pixels": [64, 48], "fov_deg": [2.0, 1.5], "elevation_deg": -0.5, "azimuth_deg": 0.0, "height_m": EYE, "frames": 2},
    "sun": {"zenith_deg": 60.0, "azimuth_deg": 180.0},
    **CALM,
    "objects": [
        {
            "name": "ball",
            "shape": {"kind": "sphere", "radius_m": 2.0},
            "temperature_k": 400.0,
            "emissivity": 1.0,
            "east_m": 3.0,
            "north_m": 800.0,
            "height_m": 12.0,
            "course_deg": 90.0,
            "speed_m_s": 20.0,
        },
        {
            "name": "far",
            "shape": {"kind": "box", "size_m": [1, 1, 1]},
            "temperature_k": 300.0,
            "east_m": -900.0,
            "north_m": 5.0,
            "height_m": 9,
        },
    ],
}


def test_a_run_holds_its_truth_and_labels_say_it(tmp_path):
    render(parse_scenario(SCENE), tmp_path / "run.zarr")
    run = prepare_sequence(parse_scenario(SCENE))
    bare = prepare_sequence(parse_scenario({**SCENE, "objects": []})).at(0.0).radiance
    with thread_limit(1):
        alone = run.images(1)
    found = list(Labels.of(tmp_path / "run.zarr"))
    assert [(label.frame, label.name) for label in found] == [(0, "ball"), (0, "far"), (1, "ball"), (1, "far")]
    assert found[2].values["column_px"] == alone["column_px"][0] != found[0].values["column_px"]
    image = run.at(0.0).radiance
    assert np.array_equal(found[0].mask, image != bare)
    assert found[1].values["visible_share"] == 0.0
    assert found[1].values["solid_angle_sr"] > 0.0
    write_labels(Labels.of(tmp_path / "run.zarr"), tmp_path / "l.csv")
    header = (tmp_path / "l.csv").read_text().splitlines()[0]
    assert header.startswith(
        "frame,object,column_px,row_px,range_m,solid_angle_sr,visible_share,occluded_share,truncated_share,contrast_W_m2_sr"
    )
    coco = json.loads(write_labels(Labels.of(tmp_path / "run.zarr"), tmp_path / "l.json").read_text())
    assert len(coco["annotations"]) == 2
    assert all(set(image) == {"id", "width", "height"} for image in coco["images"])
    about = coco["annotations"][0]["attributes"]
    assert (about["visible_share"], about["occluded_share"], about["truncated_share"]) == (1.0, 0.0, 0.0)
    runs = coco["annotations"][0]["segmentation"]["counts"]
    assert sum(runs) == 64 * 48
    assert np.array_equal(np.repeat(np.arange(len(runs)) % 2 == 1, runs).reshape(64, 48).T, found[0].mask)
    with pytest.raises(DataError, match=r"\.csv or \.json"):
        write_labels(Labels.of(tmp_path / "run.zarr"), tmp_path / "l.txt")


def test_labels_are_refused_where_there_are_no_objects(tmp_path):
    render(parse_scenario({**SCENE, "objects": [], "sensor": {**SCENE["sensor"], "frames": 1}}), tmp_path / "run.zarr")
    with pytest.raises(DataError, match="holds no objects"):
        Labels.of(tmp_path / "run.zarr")


def test_run_lengths_begin_outside():
    assert run_lengths(np.array([[1, 0], [1, 1]], bool)) == [0, 2, 1, 1]
    assert run_lengths(np.array([[0, 1]], bool)) == [1, 1]
