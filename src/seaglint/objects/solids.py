"""Solids: closed surfaces of simple shapes with fine triangles, their materials, placement in a body, and combination.

Simple shapes have their origin at the centre of the bounding box. A polyhedron with its corners on a sphere is smaller than the sphere. By
Cauchy's formula the mean projected area of a convex body over all directions is a quarter of its surface, so curved shapes are scaled to
the surface area of the exact shape; the remaining error depends on the direction.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from typing import Any, Final, Literal, assert_never

import numpy as np
from numpy.typing import ArrayLike, NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError
from seaglint.base.optional import optional
from seaglint.objects.body import GasPlume, Solid

# Corners (vertices, 3) [m] and triangles (triangles, 3), counterclockwise seen from outside.
Mesh = tuple[FloatArray, NDArray[np.int32]]

#: Number of parts of an icosahedron's edges for a sphere: 2000 triangles show its area within 0.05 % in every direction, 0.014 % rms.
PARTS: Final = 10

SIDES: Final = 128  #: Number of sides of a cylinder or cone: the area of a cap is 0.02 % too small, the width is within 0.01 %.

_BOX: Final = ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))


def box(size: tuple[float, float, float]) -> Mesh:
    """Return a box of sides along x, y and z [m]."""
    x, y, z = (0.5 * s for s in size)
    corners = np.array([(-x, -y, -z), (x, -y, -z), (x, y, -z), (-x, y, -z), (-x, -y, z), (x, -y, z), (x, y, z), (-x, y, z)])
    return corners, _triangles(_BOX)


def wedge(size: tuple[float, float, float]) -> Mesh:
    """Return half of a box of sides along x, y and z [m]: full height aft, decreasing to zero at its forward edge."""
    x, y, z = (0.5 * s for s in size)
    corners = np.array([(-x, -y, -z), (x, -y, -z), (x, y, -z), (-x, y, -z), (-x, -y, z), (x, -y, z)])
    return corners, np.array([(0, 2, 1), (0, 3, 2), (0, 1, 5), (0, 5, 4), (1, 2, 5), (0, 4, 3), (4, 5, 2), (4, 2, 3)], np.int32)


def sphere(radius: float) -> Mesh:
    """Return a sphere of a radius [m]."""
    return ellipsoid((radius, radius, radius))


def ellipsoid(semi_axes: tuple[float, float, float]) -> Mesh:
    """Return an ellipsoid of semi-axes along x, y and z [m].

    The shadow of a stretched body is the stretched shadow: its projected area has the relative error of the sphere's in another direction.
    """
    corners, triangles = _unit_sphere()
    return corners * np.asarray(semi_axes), triangles


def cylinder(radius: float, length: float) -> Mesh:
    """Return a capped cylinder about z [m]."""
    return cone(radius, length, radius)


def cone(radius: float, length: float, top_radius: float = 0.0) -> Mesh:
    """Return a capped cone about z, or part of one [m]; its tip, or its end of ``top_radius``, is up.

    The polygon has the perimeter of the circle and so, by Cauchy's formula, its mean width.
    """
    turn = 2.0 * np.pi * np.arange(SIDES) / SIDES
    circle = np.stack([np.cos(turn), np.sin(turn), np.zeros(SIDES)], axis=1) * (np.pi / SIDES) / np.sin(np.pi / SIDES)
    up = np.array([0.0, 0.0, 0.5 * length])
    lower = np.arange(SIDES)
    next_lower, foot = (lower + 1) % SIDES, np.full(SIDES, SIDES)
    bottom = np.stack([foot, next_lower, lower], axis=1)
    if top_radius == 0.0:
        corners = np.concatenate([radius * circle - up, [-up, up]])
        sides = np.stack([lower, next_lower, np.full(SIDES, SIDES + 1)], axis=1)
        return corners, np.concatenate([bottom, sides]).astype(np.int32)
    corners = np.concatenate([radius * circle - up, [-up], top_radius * circle + up, [up]])
    upper, next_upper = lower + SIDES + 1, next_lower + SIDES + 1
    sides = np.concatenate([np.stack([lower, next_lower, next_upper], axis=1), np.stack([lower, next_upper, upper], axis=1)])
    top = np.stack([np.full(SIDES, 2 * SIDES + 1), upper, next_upper], axis=1)
    return corners, np.concatenate([bottom, sides, top]).astype(np.int32)


def surface_area(mesh: Mesh) -> float:
    """Return the area of all triangles [m2]."""
    return float(0.5 * np.linalg.norm(doubled_areas(mesh), axis=1).sum())


def doubled_areas(mesh: Mesh) -> FloatArray:
    """Return outward normals of the triangles, of twice their areas [m2, (triangles, 3)]."""
    a, b, c = (mesh[0][mesh[1][:, i]] for i in range(3))
    return np.cross(b - a, c - a)


def volume(mesh: Mesh) -> float:
    """Return the volume inside [m3], negative for triangles clockwise seen from outside."""
    # tetrahedra from the mean of the corners: the origin may be far away
    corners = mesh[0] - mesh[0].mean(axis=0)
    a, b, c = (corners[mesh[1][:, i]] for i in range(3))
    return float(np.sum(a * np.cross(b, c)) / 6.0)


def _triangles(faces: tuple[tuple[int, int, int, int], ...]) -> NDArray[np.int32]:
    return np.array([t for a, b, c, d in faces for t in ((a, b, c), (a, c, d))], np.int32)


@cache
def _unit_sphere() -> Mesh:
    """Return a subdivided icosahedron with the surface area of the unit sphere."""
    g = 0.5 * (1.0 + np.sqrt(5.0))
    corners = np.array(
        [
            *((-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g)),
            *((0, -1, -g), (0, 1, -g), (g, 0, -1), (g, 0, 1), (-g, 0, -1), (-g, 0, 1)),
        ]
    )
    faces = "0 11 5 0 5 1 0 1 7 0 7 10 0 10 11 1 5 9 5 11 4 11 10 2 10 7 6 7 1 8 "
    faces += "3 9 4 3 4 2 3 2 6 3 6 8 3 8 9 4 9 5 2 4 11 6 2 10 8 6 7 9 8 1"
    triangles = np.array(faces.split(), np.int32).reshape(-1, 3)
    n = PARTS
    rows = [(i, j) for i in range(n + 1) for j in range(n + 1 - i)]
    number = {place: k for k, place in enumerate(rows)}
    small = [(number[i, j], number[i + 1, j], number[i, j + 1]) for i, j in rows if i + j < n]
    small += [(number[i + 1, j], number[i + 1, j + 1], number[i, j + 1]) for i, j in rows if i + j < n - 1]
    weights = np.array([(n - i - j, i, j) for i, j in rows]) / n
    every = (weights @ corners[triangles]).reshape(-1, 3)
    # corners on the border of two faces occur twice, equal but for rounding
    _, first, back = np.unique(np.round(every, 9), axis=0, return_index=True, return_inverse=True)
    corners = every[first] / np.linalg.norm(every[first], axis=1, keepdims=True)
    numbers = np.arange(len(triangles))[:, None, None] * len(rows) + np.array(small)
    triangles = back.reshape(-1)[numbers.reshape(-1, 3)].astype(np.int32)
    return corners * np.sqrt(4.0 * np.pi / surface_area((corners, triangles))), triangles


Operation = Literal["union", "intersection", "difference"]


def solid(mesh: Mesh, temperature: ArrayLike, emissivity: ArrayLike) -> Solid:
    """Return a solid from a mesh and a material: one temperature [K] and emissivity [1], or one for each vertex."""
    vertices, triangles = mesh
    shape = (len(vertices),)
    return Solid(
        np.ascontiguousarray(vertices, np.float64),
        np.ascontiguousarray(triangles, np.int32),
        np.array(np.broadcast_to(temperature, shape), np.float64),
        np.array(np.broadcast_to(emissivity, shape), np.float64),
    )


def placed(part: Solid, at: ArrayLike, rotation: FloatArray) -> Solid:
    """Return a part of a body, rotated (3, 3) and then moved [m]."""
    return Solid(part.vertices @ rotation.T + np.asarray(at, np.float64), part.triangles, part.temperature, part.emissivity)


def plume_in(part: GasPlume, at: ArrayLike, rotation: FloatArray) -> GasPlume:
    """Return a plume, rotated by quarter turns and then moved [m]; its axes are parallel to the axes of the body.

    Raises
    ------
    DomainError
        Any other rotation.
    """
    quarters = np.abs(rotation)
    if np.max(np.minimum(quarters, np.abs(quarters - 1.0))) > 1e-6:
        raise DomainError("a plume's axes are parallel to its body's: turn it by multiples of 90 deg, or turn the body")
    centre = rotation @ np.asarray(part.centre) + np.asarray(at, np.float64)
    semi_axes = np.rint(quarters) @ np.asarray(part.semi_axes)
    x, y, z = (float(v) for v in centre)
    a, b, c = (float(v) for v in semi_axes)
    return replace(part, centre=(x, y, z), semi_axes=(a, b, c))


def combined(operation: Operation, parts: Sequence[Solid]) -> Solid:
    """Return the closed surface of the union, intersection or difference of several solids.

    Every triangle has the temperature and the emissivity of the part that it comes from; a cut surface comes from the cutting part.
    Vertices at the border of two parts occur once for each part.

    Raises
    ------
    DomainError
        The result is empty, or the surface of a part is not closed.
    """
    if not parts:
        raise DomainError(f"shape.parts: a {operation} of no parts; give two or more")
    if len(parts) == 1:
        return parts[0]
    manifold3d = optional("manifold3d", "a solid of several parts")

    kind = manifold3d.OpType
    match operation:
        case "union":
            mode = kind.Add
        case "intersection":
            mode = kind.Intersect
        case "difference":
            mode = kind.Subtract
        case other:
            assert_never(other)
    result = manifold3d.Manifold.batch_boolean([_manifold(part) for part in parts], mode)
    if result.is_empty() or result.volume() <= 0.0:
        left = "the parts have nothing in common" if operation == "intersection" else "nothing is left"
        raise DomainError(f"its {operation} is empty: {left}; correct at_m or the sizes of its parts")
    mesh = result.to_mesh64()
    values = np.asarray(mesh.vert_properties)
    return solid((values[:, :3], np.asarray(mesh.tri_verts, np.int32)), values[:, 3], values[:, 4])


def common_volume(one: Solid, other: Solid) -> float:
    """Return the common volume of two solids [m3]."""
    manifold3d = optional("manifold3d", "a solid of several parts")

    return float(manifold3d.Manifold.batch_boolean([_manifold(one), _manifold(other)], manifold3d.OpType.Intersect).volume())


def _manifold(part: Solid) -> Any:
    manifold3d = optional("manifold3d", "a solid of several parts")

    values = np.column_stack([part.vertices, part.temperature, part.emissivity])
    # vertices at one place count as one: seams would otherwise be holes
    first = merged(part.vertices)
    duplicates = np.flatnonzero(first != np.arange(len(first)))
    mesh = manifold3d.Mesh64(
        np.ascontiguousarray(values),
        np.ascontiguousarray(part.triangles, np.uint64),
        duplicates.astype(np.uint64),
        first[duplicates].astype(np.uint64),
    )
    result = manifold3d.Manifold(mesh)
    if result.status() != manifold3d.Error.NoError:
        raise DomainError(f"a part is no closed surface ({result.status().name}); close it, or leave it out of the union")
    return result


def merged(vertices: FloatArray) -> NDArray[np.int64]:
    """Return, for each vertex, the number of the first vertex at its place; files and seams have several at one place (vertices,)."""
    _, first, back = np.unique(vertices, axis=0, return_index=True, return_inverse=True)
    return np.asarray(first[back.reshape(-1)], np.int64)
