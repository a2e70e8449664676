"""Scalar kernels of bodies in the picture, compiled or as plain Python: shares of cells from outlines, the camera's inverse, gas."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from seaglint.base.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.imaging.camera.imager import Attitude, Imager
from seaglint.imaging.camera.pose import Pose
from seaglint.objects import solids
from seaglint.objects.body import Placement
from seaglint.objects.drawing.crests import calm, in_sight
from seaglint.objects.drawing.eye import Grid, TangentPlane, image_point, lens, project, stand
from seaglint.objects.drawing.prepared_bodies import Mesh
from seaglint.objects.drawing.raster import Faces, Samples, chord, lay_samples, meet, outline, sample_place
from seaglint.objects.solids import solid

pytestmark = pytest.mark.kernel

CAMERAS = {
    "plane": (Imager("pinhole", 0.4, 0.3, 40, 30), Attitude(0.5, -0.1, 0.3)),
    "angles": (Imager("equal-angle", 0.4, 0.3, 40, 30), Attitude(0.5, -0.1, 0.3)),
}


@pytest.mark.parametrize("name", CAMERAS)
def test_the_image_point_of_a_line_of_sight_is_where_it_began(name):
    imager, attitude = CAMERAS[name]
    eye = lens(imager, attitude)
    for across, down in ((0.0, 0.0), (31.25, 7.5), (40.0, 30.0)):
        along = imager.directions(attitude, across, down)
        found = image_point(eye, tuple(float(x) for x in along), 20.0)
        assert found == (pytest.approx(across, abs=1e-9), pytest.approx(down, abs=1e-9), True)


def test_columns_go_on_over_the_seam():
    eye = lens(Imager("equal-angle", 2.0 * math.pi, 0.5, 360, 30), Attitude(0.0, 0.0))
    west = (-math.sin(0.1), -math.cos(0.1), 0.0)
    assert image_point(eye, west, 359.0)[0] == pytest.approx(360.0 + math.degrees(0.1))
    assert image_point(eye, west, 1.0)[0] == pytest.approx(math.degrees(0.1))


def shares(mesh: Mesh, grid: Grid) -> np.ndarray:
    """Shares of cells of a plane image, a unit from the eye, whose cells are a hundredth wide."""
    eye = lens(Imager("pinhole", 2.0 * math.atan(0.1), 2.0 * math.atan(0.1), 20, 20), Attitude(0.0, 0.0))
    axes = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]])
    point, image = project(mesh.vertices + np.array([0.0, 10.0, 0.0]), axes, eye, 10.0)
    wide, high = grid.size
    x = (grid.begin[0] + np.arange(wide) + 0.5)[None] / grid.cells[0] / 100.0 - 0.1 + np.zeros((high, 1))
    y = 0.1 - (grid.begin[1] + np.arange(high) + 0.5)[:, None] / grid.cells[1] / 100.0 + np.zeros((1, wide))
    samples = Samples(x, y, np.zeros((high, wide)), np.full((high, wide), -1, np.int32), np.zeros((high, wide)))
    faces = Faces(point, image, mesh.corners, mesh.ends, mesh.sides, 1e-9)
    meet(faces, grid, samples)
    outline(faces, eye, axes, grid, samples)
    return samples.share


WHOLE = Grid((0, 0), (20, 20), (1, 1), (0, 0), (20, 20))


def test_an_upright_plate_covers_cells_by_their_area():
    # half sides of 3.25 and 1.5 cells about the image's middle, less where perspective makes it smaller
    plate = Mesh.of([solid(solids.box((0.65, 1e-9, 0.3)), 300.0, 1.0)])
    expected = np.outer(np.r_[np.zeros(8), 0.5, 1.0, 1.0, 0.5, np.zeros(8)], np.r_[np.zeros(6), 0.25, np.ones(6), 0.25, np.zeros(6)])
    np.testing.assert_allclose(shares(plate, WHOLE), expected, atol=1e-7)


def test_a_turned_plate_covers_its_area_wherever_the_grid_ends():
    corners, triangles = solids.box((0.5, 1e-9, 0.2))
    turn = np.array([[0.8, 0.0, -0.6], [0.0, 1.0, 0.0], [0.6, 0.0, 0.8]])
    plate = Mesh.of([solid((corners @ turn.T + (0.031, 0.0, 0.017), triangles), 300.0, 1.0)])
    whole = shares(plate, WHOLE)
    assert whole.sum() == pytest.approx(5.0 * 2.0, rel=1e-6)
    cut = shares(plate, Grid((9, 8), (4, 3), (1, 1), (9, 8), (4, 3)))
    np.testing.assert_allclose(cut, whole[8:11, 9:13], atol=1e-12)


def test_layers_behind_each_other_cover_once():
    plate = solids.box((0.65, 1e-9, 0.3))
    both = Mesh.of([solid(plate, 300.0, 1.0), solid((plate[0] + (0.0, 1.0, 0.0), plate[1]), 300.0, 1.0)])
    found = shares(both, WHOLE)
    assert found.max() == 1.0
    assert found[9].sum() == pytest.approx(6.5, abs=1e-6)


@pytest.mark.parametrize(("longest", "whole"), [(0.0, 1.0), (4.0, 1.0), (10.0, 0.4)])
def test_chords_of_gas_are_shares_of_the_longest(longest, whole):
    ball = np.concatenate([[0.0, 5.0, 0.0], np.eye(3).ravel() / 2.0, [longest]])  # 10 m north, of 2 m
    assert chord(ball, (0.0, 1.0, 0.0), 0.0, math.inf) == pytest.approx(whole)
    assert chord(ball, (0.0, 1.0, 0.0), 0.0, 10.0) == pytest.approx(0.5 * whole)
    off = 1.0 / 10.0  # half a radius off: sqrt(3)/2 of the longest chord
    assert chord(ball, (off, math.sqrt(1.0 - off * off), 0.0), 0.0, math.inf) == pytest.approx(whole * math.sqrt(0.75), rel=1e-9)


def test_a_calm_sea_hides_what_is_under_it_and_behind_its_horizon():
    sea = calm(20.0)
    far = 2.0 * sea.horizon[0]
    assert in_sight(sea, 0.0, 1000.0, 0.1, -0.02)
    assert not in_sight(sea, 0.0, 1000.0, -0.1, -0.02)
    assert in_sight(sea, 0.0, far, 30.0, sea.horizon[1] + 1e-9)
    assert not in_sight(sea, 0.0, far, 10.0, sea.horizon[1] - 1e-9)


@pytest.mark.parametrize("projection", ["pinhole", "equal-angle"])
def test_samples_lie_where_the_camera_images_them(projection):
    """Directions of samples of coarse pixels back through the camera: to third order in the angle of a cell, 5e-6 pixels here."""
    eye = lens(Imager(projection, 1.0, 0.8, 8, 8), Attitude(0.5, -0.1, 0.3))
    axes = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
    axes[2] = eye.turn @ np.array([0.0, 1.0, 0.0])  # a plane across about the middle of the picture
    axes[0] -= (axes[0] @ axes[2]) * axes[2]
    axes[0] /= np.linalg.norm(axes[0])
    axes[1] = np.cross(axes[2], axes[0])
    grid = Grid((1, 2), (6, 5), (8, 9), (8, 18), (48, 45))
    found = lay_samples(grid, eye, axes)
    for j, i in ((0, 0), (7, 40), (44, 47), (30, 3)):
        direction = tuple(axes.T @ (found.x[j, i], found.y[j, i], 1.0))
        down, right = sample_place(8 + i, 18 + j)[1], sample_place(8 + i, 18 + j)[0]
        column, row, seen = image_point(eye, direction, 4.0)
        assert seen
        assert (column, row) == pytest.approx(((8 + i + right) / 8, (18 + j + down) / 9), abs=1.5e-5)


def test_the_nearest_triangle_that_faces_the_sensor_is_met() -> None:
    """Random triangles: planes of one over the depth by least squares, inside by the signs of three areas."""
    rng = np.random.default_rng(3)
    corner = rng.permutation(60).reshape(20, 3).astype(np.int32)
    point = np.column_stack([rng.uniform(-0.1, 0.1, (60, 2)), rng.uniform(0.05, 0.2, 60)])
    point[corner[19, 1], 2] = 0.0  # behind the sensor
    image = np.column_stack([100.0 * (point[:, 0] + 0.1), 100.0 * (0.1 - point[:, 1])])
    grid = Grid((0, 0), (20, 20), (3, 2), (6, 4), (45, 30))
    x = np.broadcast_to((grid.begin[0] + np.arange(45) + rng.random((30, 45))) / 300.0 - 0.1, (30, 45)).copy()
    y = 0.1 - (grid.begin[1] + np.arange(30)[:, None] + rng.random((30, 45))) / 200.0
    samples = Samples(x, y, np.zeros((30, 45)), np.full((30, 45), -1, np.int32), np.zeros((30, 45)))
    none = np.zeros((0, 3), np.int32)
    meet(Faces(point, image, corner, none[:, :2], none, 1e-9), grid, samples)
    nearest, triangle = np.zeros((30, 45)), np.full((30, 45), -1)
    for t, three in enumerate(corner[:19]):
        a, b, c = point[three, :2]
        if np.cross(b - a, c - a) <= 0.0:
            continue
        places = np.stack([x, y], axis=-1)
        inside = np.all([np.cross(q - p, places - p) >= 0.0 for p, q in ((a, b), (b, c), (c, a))], axis=0)
        plane = np.linalg.solve(np.column_stack([point[three, :2], np.ones(3)]), point[three, 2])
        near = places @ plane[:2] + plane[2]
        new = inside & (near > nearest)
        nearest, triangle = np.where(new, near, nearest), np.where(new, t, triangle)
    np.testing.assert_allclose(samples.near, nearest, rtol=1e-9, atol=1e-12)
    np.testing.assert_array_equal(samples.triangle, triangle)
    assert len(np.unique(triangle)) >= 4


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_turned_box_covers_cells_by_the_area_of_its_outline(seed: int) -> None:
    """Outline of a convex body: the hull of its corners in the image, of which each cell holds so many of 60 x 60 points."""
    rng = np.random.default_rng(seed)
    corners, triangles = solids.box((0.5, 0.3, 0.2))
    corners = Rotation.random(random_state=seed).apply(corners) + rng.uniform(-0.1, 0.1, 3)
    found = shares(Mesh.of([solid((corners, triangles), 300.0, 1.0)]), WHOLE)
    seen = corners + np.array([0.0, 10.0, 0.0])
    image = np.column_stack([10.0 + 100.0 * seen[:, 0] / seen[:, 1], 10.0 - 100.0 * seen[:, 2] / seen[:, 1]])
    fine = (np.arange(20 * 60) + 0.5) / 60.0
    places = np.stack(np.meshgrid(fine, fine), axis=-1)
    hull = ConvexHull(image).equations
    inside = (places @ hull[:, :2].T + hull[:, 2] <= 0.0).all(axis=-1)
    np.testing.assert_allclose(found, inside.reshape(20, 60, 20, 60).mean(axis=(1, 3)), atol=0.02)
    assert found.sum() == pytest.approx(ConvexHull(image).volume, rel=1e-6)


def test_edges_bend_in_an_image_of_angles() -> None:
    """A large turned box in wide pixels of equal angles: shares by 60 x 60 lines of sight through each, on the plane of its silhouette."""
    imager, attitude = Imager("equal-angle", 1.2, 1.0, 12, 10), Attitude(0.2, 0.35, 0.15)
    eye = lens(imager, attitude)
    middle = imager.directions(attitude, 6.0, 5.0)
    axes = TangentPlane.to(middle).axes
    corners, triangles = solids.box((4.0, 3.0, 2.0))
    mesh = Mesh.of([solid((Rotation.random(random_state=4).apply(corners) + 8.0 * middle, triangles), 300.0, 1.0)])
    point, image = project(mesh.vertices, axes, eye, 6.0)
    grid = Grid((0, 0), (12, 10), (3, 2), (0, 0), (36, 20))
    samples = lay_samples(grid, eye, axes)
    faces = Faces(point, image, mesh.corners, mesh.ends, mesh.sides, 0.3)
    meet(faces, grid, samples)
    outline(faces, eye, axes, grid, samples)
    fine = (np.arange(36 * 40) + 0.5) / 120.0, (np.arange(20 * 40) + 0.5)[:, None] / 80.0
    along = imager.directions(attitude, *np.broadcast_arrays(*fine)) @ axes.T
    places = along[..., :2] / along[..., 2:]
    hull = ConvexHull(point[:, :2]).equations
    inside = (places @ hull[:, :2].T + hull[:, 2] <= 0.0).all(axis=-1)
    np.testing.assert_allclose(samples.share, inside.reshape(20, 40, 36, 40).mean(axis=(1, 3)), atol=0.03)
    assert samples.share.sum() == pytest.approx(inside.mean() * 720, rel=1e-3)


@pytest.mark.parametrize(("east", "north"), [(3000.0, -4000.0), (0.0, 20_000.0), (-60_000.0, 10.0), (0.0, 0.0)])
def test_bodies_stand_on_a_round_sea(east: float, north: float) -> None:
    """Place from the centre of the sphere; axes turned about the horizontal across the way, by the angle at the centre."""
    pose = Pose(100.0, -200.0, 35.0, Attitude(0.0, 0.0))
    own = Rotation.from_rotvec([0.3, -0.2, 0.5]).as_matrix()
    found = stand(Placement(np.array([100.0 + east, -200.0 + north, 12.0]), own), pose)
    arc, radius = math.hypot(east, north), EFFECTIVE_EARTH_RADIUS
    way = np.array([east, north, 0.0]) / max(arc, 1e-9)
    turn = Rotation.from_rotvec(arc / radius * np.array([-way[1], way[0], 0.0]))
    up = turn.apply([0.0, 0.0, 1.0])
    np.testing.assert_allclose(found.place, (radius + 12.0) * up - [0.0, 0.0, radius + 35.0], atol=1e-7)
    np.testing.assert_allclose(found.turn, turn.as_matrix() @ own, atol=1e-12)


def test_the_tangent_plane_is_across_the_line_of_sight_and_level() -> None:
    for place in (np.array([30.0, 40.0, -5.0]), np.array([-3.0, 1.0, 8.0]), np.array([0.0, 0.0, 2.0])):
        right, up, ahead = TangentPlane.to(place).axes
        np.testing.assert_allclose(TangentPlane.to(place).axes @ TangentPlane.to(place).axes.T, np.eye(3), atol=1e-12)
        np.testing.assert_allclose(ahead, place / np.linalg.norm(place))
        np.testing.assert_allclose(np.cross(right, up), -ahead, atol=1e-12)
        assert right[2] == 0.0
        assert up[2] >= 0.0


def test_columns_are_never_more_than_half_a_circle_away() -> None:
    eye = lens(Imager("equal-angle", 2.0 * math.pi, 0.5, 360, 30), Attitude(0.0, 0.0))
    for azimuth in np.linspace(-3.1, 3.1, 23):
        for about in np.linspace(-400.0, 700.0, 31):
            column = image_point(eye, (math.sin(azimuth), math.cos(azimuth), 0.0), about)[0]
            assert abs(column - about) <= 180.0 + 1e-9
            turns = (column - 180.0 - math.degrees(azimuth)) / 360.0
            assert turns == pytest.approx(round(turns), abs=1e-9)
