"""Solids have the volumes, areas and shadows of geometry, alone and combined; meshes are closed or refused."""

from __future__ import annotations

from contextlib import nullcontext

import numpy as np
import pytest

from seaglint.base.errors import DomainError
from seaglint.objects import solids
from seaglint.objects.mesh_checks import inside, oriented, require_materials, waterline
from seaglint.objects.motion import rotation
from seaglint.objects.solids import combined, common_volume, placed, solid

PI = np.pi
ELLIPSOID = 4.0 * PI * (((2 * 3) ** 1.6075 + (2 * 0.5) ** 1.6075 + (3 * 0.5) ** 1.6075) / 3.0) ** (1.0 / 1.6075)  # Thomsen, 1.1 %

# volume and surface in closed form; polyhedra inside a sphere of equal surface hold 0.1 % less
CASES = {
    "sphere": (solids.sphere(2.0), 4.0 / 3.0 * PI * 8.0, 16.0 * PI, 1e-3, 1e-9),
    "ellipsoid": (solids.ellipsoid((2.0, 3.0, 0.5)), 4.0 / 3.0 * PI * 3.0, ELLIPSOID, 1e-3, 0.012),
    "box": (solids.box((1.0, 2.0, 3.0)), 6.0, 22.0, 1e-12, 1e-12),
    "cylinder": (solids.cylinder(1.5, 4.0), PI * 9.0, PI * (2 * 2.25 + 12.0), 3e-4, 2e-4),
    "cone": (solids.cone(1.5, 2.0), PI * 1.5, PI * (2.25 + 1.5 * 2.5), 3e-4, 2e-4),
    "part of a cone": (solids.cone(2.0, 3.0, 1.0), PI * 7.0, PI * (5.0 + 3.0 * np.sqrt(10.0)), 3e-4, 2e-4),
    "wedge": (solids.wedge((2.0, 4.0, 3.0)), 12.0, 2 * 4 + 2 * 3 + 2 * 5 + 4 * 3, 1e-12, 1e-12),
}


@pytest.mark.parametrize("name", CASES)
def test_volume_and_surface(name):
    mesh, volume, area, volume_error, area_error = CASES[name]
    assert solids.volume(mesh) == pytest.approx(volume, rel=volume_error)
    assert solids.surface_area(mesh) == pytest.approx(area, rel=area_error)
    assert len(oriented(mesh)[1]) == len(mesh[1]) <= 5000


def shadow(mesh, direction):
    return 0.5 * np.maximum(solids.doubled_areas(mesh) @ direction, 0.0).sum()


DIRECTIONS = np.random.default_rng(7).normal(size=(200, 3))
DIRECTIONS /= np.linalg.norm(DIRECTIONS, axis=1, keepdims=True)


def test_round_solids_show_the_area_of_round_ones():
    x, y, z = DIRECTIONS.T
    axes = (2.0, 3.0, 0.5)
    wanted = {
        "sphere": (solids.sphere(2.0), np.full(200, 4.0 * PI)),
        "ellipsoid": (solids.ellipsoid(axes), PI * 3.0 * np.sqrt((x / 2) ** 2 + (y / 3) ** 2 + (z / 0.5) ** 2)),
        "cylinder": (solids.cylinder(1.5, 4.0), PI * 2.25 * np.abs(z) + 12.0 * np.hypot(x, y)),
    }
    for mesh, areas in wanted.values():
        error = np.array([shadow(mesh, d) for d in DIRECTIONS]) / areas - 1.0
        assert np.abs(error).max() < 5e-4
        assert abs(error.mean()) < 2e-4


def members(points):
    ball = np.linalg.norm(points, axis=1) < 1.0
    box = (np.abs(points - (0.5, 0.0, 0.0)) < (0.6, 0.9, 0.4)).all(axis=1)
    pole = (np.hypot(points[:, 0], points[:, 1]) < 0.4) & (np.abs(points[:, 2]) < 1.5)
    return (ball & ~pole) | (box & ~ball)


def test_nested_combinations_fill_what_membership_of_points_says():
    ball = solid(solids.sphere(1.0), 280.0, 0.9)
    box = placed(solid(solids.box((1.2, 1.8, 0.8)), 300.0, 0.5), (0.5, 0.0, 0.0), np.eye(3))
    pole = solid(solids.cylinder(0.4, 3.0), 320.0, 0.7)
    found = combined("union", [combined("difference", [ball, pole]), combined("difference", [box, ball])])
    points = np.random.default_rng(3).uniform((-1.2, -1.2, -1.2), (1.2, 1.2, 1.2), (400_000, 3))
    share = members(points).mean()
    # one standard error of the share is 0.2 % of it; the ball lacks 0.1 % of its volume
    assert solids.volume((found.vertices, found.triangles)) == pytest.approx(share * 2.4**3, rel=0.008)
    assert found.vertices.min() >= -1.01
    oriented((found.vertices, found.triangles))


def test_parts_keep_what_they_are_made_of():
    low = solid(solids.box((2.0, 2.0, 2.0)), 280.0, 0.9)
    high = placed(solid(solids.box((1.0, 1.0, 2.0)), 400.0, 0.3), (0.0, 0.0, 1.0), np.eye(3))
    found = combined("union", [low, high])
    area = 0.5 * np.linalg.norm(solids.doubled_areas((found.vertices, found.triangles)), axis=1)
    of = found.temperature[found.triangles]
    assert np.ptp(of, axis=1).max() < 1e-9  # no triangle between two parts
    warm = of[:, 0] > 300.0
    assert area[warm].sum() == pytest.approx(1.0 + 4.0)  # the upper half of the inner box
    assert area[~warm].sum() == pytest.approx(24.0 - 1.0)
    assert found.emissivity[found.triangles][warm].mean() == pytest.approx(0.3)
    assert common_volume(low, high) == pytest.approx(1.0)


def test_empty_combinations_are_refused():
    one = solid(solids.box((1.0, 1.0, 1.0)), 280.0, 1.0)
    with pytest.raises(DomainError, match="nothing in common"):
        combined("intersection", [one, placed(one, (5.0, 0.0, 0.0), np.eye(3))])
    with pytest.raises(DomainError, match="nothing is left"):
        combined("difference", [one, placed(solid(solids.sphere(3.0), 280.0, 1.0), (0, 0, 0), np.eye(3))])


def test_open_crossing_and_flat_meshes_are_refused():
    corners, triangles = solids.box((1.0, 1.0, 1.0))
    with pytest.raises(DomainError, match="open: 3 edges"):
        oriented((corners, triangles[1:]))
    turned = triangles.copy()
    turned[0] = turned[0, ::-1]
    with pytest.raises(DomainError, match="both orientations"):
        oriented((corners, turned))
    with pytest.raises(DomainError, match="no volume"):
        oriented((corners * (1.0, 1.0, 0.0), triangles))
    two = np.concatenate([corners, corners @ rotation(0.3, 0.2, 0.1).T + (0.4, 0.3, 0.2)])
    with pytest.raises(DomainError, match="crosses itself near"):
        oriented((two, np.concatenate([triangles, triangles + 8])))
    apart = np.concatenate([corners, corners + 3.0])
    oriented((apart, np.concatenate([triangles, triangles + 8])))
    assert solids.volume(oriented((corners, triangles[:, ::-1]))) == pytest.approx(1.0)
    with pytest.raises(DomainError, match=r"emissivity = 1\.5"):
        require_materials(solid((corners, triangles), 280.0, 1.5))


def test_what_is_inside_and_where_the_water_cuts():
    ring = combined("difference", [solid(solids.cylinder(2.0, 1.0), 280.0, 1.0), solid(solids.cylinder(1.0, 2.0), 280.0, 1.0)])
    assert inside(ring, np.array([1.5, 0.0, 0.0]))
    assert not inside(ring, np.array([0.5, 0.0, 0.0]))
    assert not inside(ring, np.array([1.5, 0.0, 0.6]))
    hull = placed(solid(solids.box((3.0, 10.0, 2.0)), 280.0, 1.0), (1.0, 2.0, 0.5), np.eye(3))
    centre, half = waterline(hull, 0.0)
    np.testing.assert_allclose(centre, [1.0, 2.0], atol=1e-9)
    np.testing.assert_allclose(half, [1.5, 5.0], rtol=1e-9)
    # a disc of radius r has second moments r^2/4: a square of half side sqrt(3)/2 r
    _, half = waterline(solid(solids.sphere(2.0), 280.0, 1.0), 1.0)
    np.testing.assert_allclose(half, np.sqrt(0.75 * 3.0), rtol=3e-3)
    assert waterline(hull, 5.0) is None


def test_boxes_cross_where_they_overlap_in_part():
    """Convex surfaces cross where they have a part in common, but not where one holds the other: by the volume of the intersection."""
    rng, crossed = np.random.default_rng(4), []
    for _ in range(30):
        sides = rng.uniform(0.3, 1.6, (2, 3))
        one, other = (solid(solids.box(tuple(s)), 280.0, 1.0) for s in sides)
        other = placed(other, tuple(rng.uniform(-1.2, 1.2, 3)), rotation(*rng.uniform(-3.0, 3.0, 3)))
        common, least = common_volume(one, other), float(np.prod(sides, axis=1).min())
        mesh = np.concatenate([one.vertices, other.vertices]), np.concatenate([one.triangles, other.triangles + len(one.vertices)])
        crosses = 1e-6 < common < (1.0 - 1e-6) * least
        with pytest.raises(DomainError, match="crosses itself") if crosses else nullcontext():
            oriented(mesh)
        crossed.append(crosses)
    assert 8 < sum(crossed) < 25


def test_a_corner_through_a_face_is_a_crossing_wherever_it_lies():
    """A small tetrahedron's corner just through, or just short of, a large one's face, turned and moved together."""
    rng = np.random.default_rng(6)
    large = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.3, 0.3, 1.0]])
    triangles = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    tipped = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])  # the tip first
    for _ in range(200):
        depth = float(rng.choice([0.01, -0.01]))
        tip = np.array([*rng.uniform(0.1, 0.4, 2), depth])
        small = tip + np.array([[0.0, 0.0, 0.0], [0.05, 0.0, -0.1], [-0.05, 0.05, -0.1], [0.0, -0.06, -0.1]])
        corners = np.concatenate([large, small]) @ rotation(*rng.uniform(-3.0, 3.0, 3)).T + rng.uniform(-2.0, 2.0, 3)
        with pytest.raises(DomainError, match="crosses itself") if depth > 0.0 else nullcontext():
            oriented((corners, np.concatenate([triangles, 4 + np.roll(tipped, rng.integers(3), axis=1)])))


def test_boxes_that_touch_do_not_cross():
    corners, triangles = solids.box((1.0, 1.0, 1.0))
    for shift in ((1.0, 0.3, 0.2), (1.0, 1.0, 0.4), (1.0, 0.0, 0.0)):
        oriented((np.concatenate([corners, corners + shift]), np.concatenate([triangles, triangles + 8])))


@pytest.mark.parametrize(("overlap", "crosses"), [(1e-9, False), (5e-7, False), (1e-5, True), (1e-3, True)])
@pytest.mark.parametrize("aside", [(0.3, 0.2), (-0.41, 0.17), (0.6, -0.7)])
def test_boxes_that_overlap_by_rounding_touch(aside, overlap, crosses):
    """Up to a millionth of the mesh, which is 2 m long: files hold seven digits."""
    corners, triangles = solids.box((1.0, 1.0, 1.0))
    mesh = np.concatenate([corners, corners + np.array([1.0 - overlap, *aside])]), np.concatenate([triangles, triangles + 8])
    with pytest.raises(DomainError, match="crosses itself") if crosses else nullcontext():
        oriented(mesh)


@pytest.mark.parametrize("level", [-0.7, -0.2, 0.0, 0.45])
def test_sections_of_a_turned_box_by_counting(level):
    """Centre and second moments of the places inside at that height, on a fine lattice."""
    hull = placed(solid(solids.box((3.0, 1.0, 2.0)), 280.0, 1.0), (0.4, -0.2, 0.1), rotation(0.3, 0.2, 0.5))
    centre, half = waterline(hull, level)
    axis = np.linspace(-2.5, 2.5, 1001)
    x, y = np.meshgrid(axis, axis, indexing="ij")
    places = np.stack([x - 0.4, y + 0.2, np.full_like(x, level - 0.1)], axis=-1) @ rotation(0.3, 0.2, 0.5)
    there = (np.abs(places) <= (1.5, 0.5, 1.0)).all(axis=-1)
    assert centre == pytest.approx([x[there].mean(), y[there].mean()], abs=5e-3)
    assert half == pytest.approx(np.sqrt(3.0) * np.array([x[there].std(), y[there].std()]), rel=5e-3)
