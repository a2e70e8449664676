"""Shares of objects that are cut by the picture's edge and hidden by others, against rays of the tests' own."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest

from seaglint.objects import solids
from seaglint.objects.body import Body, GasPlume, Placement, PointSource
from seaglint.objects.drawing.compose import BodySight, composed
from seaglint.objects.drawing.draw import Drawer, Stage
from seaglint.objects.drawing.truth import labels
from seaglint.objects.motion import rotation
from seaglint.objects.solids import solid
from seaglint.scenario.load import parse_scenario
from seaglint.studies.sequence.render_sequence import prepare_sequence
from seaglint.studies.sequence.sensed_sequence import prepare_sensed

EYE = 3.0
PIXELS = (96, 64)
FOV = (3.0, 2.0)
ELEVATION = -0.5
CALM = {
    "sea": {"resolve_waves": False},
    "atmosphere": {"source": "isothermal", "temperature_k": 288.15, "extinction_per_km": 0.05},
    "sun": {"zenith_deg": 60.0, "azimuth_deg": 180.0},
}
SENSOR = {"pixels": list(PIXELS), "fov_deg": list(FOV), "elevation_deg": ELEVATION, "azimuth_deg": 0.0, "height_m": EYE, "frames": 1}
SAMPLED = 6e-3
"""What sampling leaves of a share, of the program and of the tests' own rays."""

RAYS = 800
"""The tests' own rays along a side."""


class Still:
    """Motion of a body at rest, its waterline where ``water`` says."""

    def __init__(self, place: tuple[float, float, float], rotation: np.ndarray | None = None, water: np.ndarray | None = None) -> None:
        self.placement = Placement(np.array(place, float), np.eye(3) if rotation is None else rotation, water)

    def at(self, time: float) -> Placement:
        return self.placement


@cache
def calm():
    return prepare_sequence(parse_scenario({"sensor": SENSOR, **CALM}))


def sights(*bodies: Body, columns: tuple[int, int] = (0, PIXELS[0])) -> tuple[BodySight, ...]:
    """What is seen of bodies in some columns of the picture."""
    run = calm()
    drawer = Drawer.of(bodies)
    stage = Stage(run.scene.pixels, run.scene.pose, run.scene.view, None, columns, (0, PIXELS[1]))
    picture = drawer.picture(stage, 0.0)
    layers = run.at(0.0)
    cut = type(layers)({name: layers[name][:, slice(*columns)] for name in layers})
    return composed(cut, stage, picture, drawer.light(stage.view))[1]


def box_hit(direction: np.ndarray, centre: np.ndarray, rotation: np.ndarray, size: np.ndarray) -> np.ndarray:
    """Distance along unit directions to a box, infinite beside it."""
    d, o = direction @ rotation, -centre @ rotation
    with np.errstate(divide="ignore"):
        one, two = (-0.5 * size - o) / d, (0.5 * size - o) / d
    near, far = np.minimum(one, two).max(axis=-1), np.maximum(one, two).min(axis=-1)
    return np.where((near <= far) & (near > 0.0), near, np.inf)


def sphere_hit(direction: np.ndarray, centre: np.ndarray, radius: float) -> np.ndarray:
    along = direction @ centre
    square = along**2 - centre @ centre + radius**2
    return np.where((square > 0.0) & (along > 0.0), along - np.sqrt(np.maximum(square, 0.0)), np.inf)


def rays(azimuths: tuple[float, float], elevations: tuple[float, float], count: int = RAYS) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Unit directions over a patch of the sky, their weights in solid angle, and a flag for those in the picture."""
    azimuth = azimuths[0] + (np.arange(count) + 0.5) / count * (azimuths[1] - azimuths[0])
    elevation = elevations[0] + (np.arange(count) + 0.5)[:, None] / count * (elevations[1] - elevations[0])
    direction = np.stack(
        np.broadcast_arrays(np.cos(elevation) * np.sin(azimuth), np.cos(elevation) * np.cos(azimuth), np.sin(elevation)), -1
    )
    wide, high = (0.5 * math.radians(side) for side in FOV)
    inside = (np.abs(azimuth) < wide) & (np.abs(elevation - math.radians(ELEVATION)) < high)
    return direction, np.broadcast_to(np.cos(elevation), inside.shape), inside


@pytest.mark.parametrize("seed", range(24))
def test_boxes_and_spheres_are_cut_and_hidden_as_rays_say(seed):
    """A box anywhere about the picture, dipped by any depth, and a sphere or a box somewhere before it; the Earth is flat at 150 m."""
    rng = np.random.default_rng(seed)
    size, far = rng.uniform(0.5, 6.0, 3), rng.uniform(100.0, 200.0)
    azimuth = rng.choice([-0.5, 0.5, rng.uniform(-0.5, 0.5)]) * math.radians(FOV[0]) + rng.uniform(-0.5, 0.5) * size[0] / far
    place = np.array(
        [far * math.sin(azimuth), far * math.cos(azimuth), rng.uniform(-0.4, 0.5) * size[2] + rng.uniform(0.0, 4.0) * (seed % 2)]
    )
    heading = rng.uniform(0.0, 2.0 * math.pi)
    rotation = np.array([[math.cos(heading), math.sin(heading), 0.0], [-math.sin(heading), math.cos(heading), 0.0], [0.0, 0.0, 1.0]])
    before = rng.uniform(0.5, 0.8)
    eye = np.array([0.0, 0.0, EYE])
    aside = place * before + (1.0 - before) * eye + rng.uniform(-0.6, 0.6, 3) * (size[0], 0.0, size[2])
    radius, other_size = rng.uniform(0.3, 1.5), rng.uniform(0.5, 2.0, 3)
    ball = seed % 3 == 0
    screen = solid(solids.sphere(radius) if ball else solids.box(tuple(other_size)), 300.0, 1.0)
    it = Body("it", (solid(solids.box(tuple(size)), 350.0, 1.0),), Still(tuple(place), rotation))
    sight = sights(it, Body("screen", (screen,), Still(tuple(aside))))[0]

    # the Earth falls by 2 mm over these distances
    centre, at = place - eye, aside - eye
    reach = 0.6 * float(np.linalg.norm(size)) / float(np.linalg.norm(centre))
    middle = math.atan2(centre[0], centre[1]), math.atan2(centre[2], math.hypot(centre[0], centre[1]))
    direction, weight, inside = rays(*((m - reach, m + reach) for m in middle))
    hit = box_hit(direction, centre, rotation, size)
    weight = weight * np.isfinite(hit) * (np.where(np.isfinite(hit), hit, 0.0) * direction[..., 2] + EYE > 0.0)
    hidden = (sphere_hit(direction, at, radius) if ball else box_hit(direction, at, np.eye(3), other_size)) < hit
    total, there = weight.sum(), (weight * inside).sum()
    assert sight.truncated == pytest.approx(1.0 - there / total, abs=SAMPLED)
    if there == 0.0:
        assert math.isnan(sight.occluded)
    elif there > 0.02 * total:
        assert sight.occluded == pytest.approx((weight * inside * hidden).sum() / there, abs=2.0 * SAMPLED)
    step = 2.0 * reach / RAYS
    assert sight.dry == pytest.approx(total * step**2, rel=2.0 * SAMPLED)


@pytest.mark.parametrize("scan", [{"kind": "line", "period_s": 0.02}, {"row_time_s": 2e-4}])
def test_shares_of_a_picture_taken_in_parts_are_those_of_the_whole(scan):
    """A scanner takes column by column, a rolling shutter row by row; what stands half hidden over the edge is cut and hidden as ever."""
    box = {"name": "it", "shape": {"kind": "box", "size_m": [1.2, 1, 1.2]}, "temperature_k": 350}
    screen = {"name": "screen", "shape": {"kind": "box", "size_m": [0.4, 0.4, 0.5]}, "temperature_k": 350}
    optics = {"optics": {"aperture_m": 0.02, "f_number": 2.0}, "detector": {"pitch_um": 15.0, "integration_time_s": 1e-4}}
    camera = {"pixels": [48, 32], "azimuth_deg": 0.0, "elevation_deg": 0.0, "height_m": 5.0, "frame_rate_hz": 25.0, **optics}
    half = math.atan(0.5 * 48 * 15e-6 / 0.04)
    items = [
        {**box, "east_m": 150.0 * math.tan(half), "north_m": 150.0, "height_m": 5.0},
        {**screen, "east_m": 100.0 * math.tan(half) - 0.25, "north_m": 100.0, "height_m": 5.0},
    ]
    common = {"sea": {"resolve_waves": False}, "sun": {"zenith_deg": 60.0}, "objects": items}
    one, other = (prepare_sensed(parse_scenario({**common, "sensor": {**camera, **more}})).images(0) for more in ({}, {"scan": scan}))
    assert 0.3 < one["truncated_share"][0] < 0.7
    assert 0.05 < one["occluded_share"][0] < 0.9
    for name in ("truncated_share", "occluded_share", "visible_share", "pixels", "column_px", "row_px"):
        assert other[name] == pytest.approx(one[name], abs=1e-6), name


def test_wholly_inside_is_exactly_uncut_and_far_outside_exactly_cut():
    ball = Body("in", (solid(solids.sphere(1.0), 350.0, 1.0),), Still((0.0, 300.0, 2.0)))
    away = Body("out", (solid(solids.sphere(1.0), 350.0, 1.0),), Still((0.0, -300.0, 2.0)))
    found = sights(ball, away)
    assert (found[0].truncated, found[0].occluded) == (0.0, 0.0)
    assert found[1].truncated == 1.0
    assert math.isnan(found[1].occluded)


def test_points_are_there_or_not():
    wall = Body("wall", (solid(solids.box((4.0, 1.0, 4.0)), 300.0, 1.0),), Still((0.0, 100.0, 2.0)))
    places = {"seen": (4.6, 200.0, 1.5), "hidden": (0.0, 200.0, 1.5), "outside": (40.0, 200.0, 1.5)}
    points = [Body(name, (PointSource(intensity=1.0),), Still(place)) for name, place in places.items()]
    found = sights(wall, *points)[1:]
    assert [(one.truncated, one.occluded) for one in found[:2]] == [(0.0, 0.0), (0.0, 1.0)]
    assert found[2].truncated == 1.0
    assert math.isnan(found[2].occluded)
    run = calm()
    rows, _, _ = labels(found, run.at(0.0).radiance, lambda radiance: 300.0)
    np.testing.assert_array_equal(rows["visible_share"], [1.0, 0.0, 0.0])
    np.testing.assert_array_equal(rows["solid_angle_sr"], 0.0)


def test_what_a_body_hides_of_itself_is_not_called_hidden():
    """A plume behind its own funnel and before its own hull; another body's wall hides both."""
    hull = solid(solids.box((4.0, 4.0, 6.0)), 320.0, 1.0)
    smoke = GasPlume((1.5, -6.0, 3.0), (3.0, 2.0, 2.0), 400.0, 0.6)
    behind = GasPlume((-1.5, 8.0, 3.0), (3.0, 2.0, 2.0), 400.0, 0.6)
    ship = Body("ship", (hull, smoke, behind), Still((0.0, 500.0, 2.0)))
    alone = sights(ship)[0]
    assert (alone.truncated, alone.occluded) == (0.0, pytest.approx(0.0, abs=1e-9))
    other = Body("other", (smoke,), Still((0.0, 500.0, 2.0)))
    assert sights(Body("hull", (hull,), Still((0.0, 500.0, 2.0))), other)[0].occluded > 0.05
    # over the edge both ways of measuring the whole must agree
    east = 500.0 * math.tan(math.radians(0.5 * FOV[0]))
    turn = rotation(math.radians(0.5 * FOV[0]))
    cut = sights(Body("ship", (hull, smoke, behind), Still((east, 500.0, 2.0), turn)))[0]
    assert cut.dry == pytest.approx(alone.dry, rel=6e-3)
    assert cut.occluded == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("depth", [0.2, 0.5, 0.9])
def test_a_plume_dips_by_its_opacity(depth):
    """Of a thin plume with its middle on the waterline half is above it."""
    water = np.array([[0.0, 0.0, 1.0], [0.0, 300.0, 1.0]])
    plume = Body("gas", (GasPlume((0.0, 0.0, 0.0), (3.0, 3.0, 3.0), 400.0, depth),), Still((0.0, 300.0, 1.0), water=water))
    found = sights(plume)[0]
    assert found.dry / found.whole == pytest.approx(0.5, abs=0.01)
    assert found.occluded == pytest.approx(0.0, abs=1e-9)


def test_the_waterline_leans_with_a_floating_body():
    """A box heeled by 20 degrees with its plane: what is above the plane is a box again."""
    angle = math.radians(20.0)
    turn = np.array([[math.cos(angle), 0.0, math.sin(angle)], [0.0, 1.0, 0.0], [-math.sin(angle), 0.0, math.cos(angle)]])
    place, height = np.array([0.0, 300.0, 2.0]), 1.5
    water = np.stack([turn[:, 2], place + turn @ (0.0, 0.0, 3.0 - height)])
    whole = Body("it", (solid(solids.box((4.0, 2.0, 6.0)), 350.0, 1.0),), Still(tuple(place), turn, water))
    above = Body(
        "above", (solid(solids.box((4.0, 2.0, height)), 350.0, 1.0),), Still(tuple(place + turn @ (0.0, 0.0, 3.0 - 0.5 * height)), turn)
    )
    assert sights(whole)[0].dry == pytest.approx(sights(above)[0].whole, rel=6e-3)


def test_a_wholly_submerged_body_is_invisible_and_not_cut():
    sunk = Body("sunk", (solid(solids.sphere(1.0), 350.0, 1.0),), Still((0.0, 300.0, -3.0)))
    found = sights(sunk)
    assert math.isnan(found[0].truncated)
    rows, _, _ = labels(found, calm().at(0.0).radiance, lambda radiance: 300.0)
    assert rows["visible_share"][0] == 0.0
    assert math.isnan(rows["truncated_share"][0])


SHIP = {"name": "ship", "preset": "container-ship", "north_m": 3000.0, "heading_deg": 70.0}


@pytest.mark.parametrize("sea", [{"resolve_waves": False}, {}], ids=["calm", "waves"])
def test_a_ship_in_plain_view_is_visible(sea):
    """Its hull under water is no part of what can be seen."""
    sensor = {**SENSOR, "pixels": [192, 64], "fov_deg": [6.0, 2.0], "height_m": 30.0, "elevation_deg": -0.5}
    run = prepare_sequence(parse_scenario({"sensor": sensor, **CALM, "sea": sea, "objects": [SHIP], "wind": {"speed_m_s": 5.0}}))
    found = run.images(0)
    (sight,) = run.drawn(0.0).sights
    assert sight.dry < 0.8 * sight.whole
    assert found["visible_share"][0] == pytest.approx(1.0, abs=0.01)
    assert found["occluded_share"][0] == pytest.approx(0.0, abs=0.01)
    assert found["truncated_share"][0] == 0.0
    assert found["solid_angle_sr"][0] * found["visible_share"][0] == pytest.approx(sight.seen, rel=0.01)


@pytest.mark.parametrize("scan", [{"kind": "line"}, {"kind": "staring", "row_time_s": 2e-4}], ids=["scanner", "rolling"])
def test_scanners_and_rolling_shutters_say_what_a_snapshot_says(scan):
    east = 1000.0 * math.tan(math.radians(0.5 * FOV[0]))
    ball = {"shape": {"kind": "sphere", "radius_m": 4.0}, "temperature_k": 300.0, "height_m": 5.0, "north_m": 1000.0}
    wall = {"name": "wall", "shape": {"kind": "box", "size_m": [8, 1, 8]}, "temperature_k": 300.0, "height_m": 4.0, "north_m": 500.0}
    objects = [{"name": "cut", "east_m": east, **ball}, {"name": "half", "east_m": 8.0, **ball}, wall]
    camera = {"optics": {"aperture_m": 0.05, "focal_length_m": 0.05}, "detector": {"pitch_um": 27.27, "integration_time_s": 1e-5}}
    sensor = {key: value for key, value in SENSOR.items() if key != "fov_deg"} | {"frame_rate_hz": 25.0, **camera}
    settings = {**CALM, "objects": objects, "render": {"oversampling": 2}}
    still = prepare_sensed(parse_scenario({**settings, "sensor": sensor})).images(0)
    found = prepare_sensed(parse_scenario({**settings, "sensor": {**sensor, "scan": scan}})).images(0)
    assert 0.3 < still["truncated_share"][0] < 0.7
    assert 0.2 < still["occluded_share"][1] < 0.8
    for name in ("truncated_share", "occluded_share", "visible_share"):
        np.testing.assert_allclose(found[name], still[name], atol=SAMPLED, err_msg=name)
