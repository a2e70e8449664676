"""Solids from meshes: materials, placement in a body, and their union, intersection and difference."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, Literal, assert_never

import numpy as np
from numpy.typing import ArrayLike, NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError
from seaglint.base.optional import optional
from seaglint.objects.body import GasPlume, Solid
from seaglint.objects.primitives import Mesh

Operation = Literal["union", "intersection", "difference"]


def solid(mesh: Mesh, temperature: ArrayLike, emissivity: ArrayLike) -> Solid:
    """Solid from a mesh and a material: one temperature [K] and emissivity [1], or one for each vertex."""
    vertices, triangles = mesh
    wide = (len(vertices),)
    return Solid(
        np.ascontiguousarray(vertices, np.float64),
        np.ascontiguousarray(triangles, np.int32),
        np.array(np.broadcast_to(temperature, wide), np.float64),
        np.array(np.broadcast_to(emissivity, wide), np.float64),
    )


def placed(part: Solid, at: ArrayLike, rotation: FloatArray) -> Solid:
    """Part of a body, rotated [(3, 3)] and then moved [m]."""
    return Solid(part.vertices @ rotation.T + np.asarray(at, np.float64), part.triangles, part.temperature, part.emissivity)


def plume_in(part: GasPlume, at: ArrayLike, rotation: FloatArray) -> GasPlume:
    """Plume moved [m] and rotated by quarter turns, as its axes are the body's.

    Raises
    ------
    DomainError
        Any other turn.
    """
    quarters = np.abs(rotation)
    if np.max(np.minimum(quarters, np.abs(quarters - 1.0))) > 1e-6:
        raise DomainError("a plume's axes are those of its body: turn it by multiples of 90 deg, or turn the body")
    centre = rotation @ np.asarray(part.centre) + np.asarray(at, np.float64)
    semi_axes = np.rint(quarters) @ np.asarray(part.semi_axes)
    x, y, z = (float(v) for v in centre)
    a, b, c = (float(v) for v in semi_axes)
    return replace(part, centre=(x, y, z), semi_axes=(a, b, c))


def combined(operation: Operation, parts: Sequence[Solid]) -> Solid:
    """Closed surface of the union, intersection or difference of several solids.

    Every triangle keeps the temperature and the emissivity of the part that it comes from; what a part cuts out of another has the
    cutting part's. Vertices at the border of two parts are there once for each.

    Raises
    ------
    DomainError
        Nothing is left, or a part is no closed surface.
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
    """Common volume of two solids [m3]."""
    manifold3d = optional("manifold3d", "a solid of several parts")

    return float(manifold3d.Manifold.batch_boolean([_manifold(one), _manifold(other)], manifold3d.OpType.Intersect).volume())


def _manifold(part: Solid) -> Any:
    manifold3d = optional("manifold3d", "a solid of several parts")

    values = np.column_stack([part.vertices, part.temperature, part.emissivity])
    same = merged(part.vertices)
    twice = np.flatnonzero(same != np.arange(len(same)))
    mesh = manifold3d.Mesh64(
        np.ascontiguousarray(values),
        np.ascontiguousarray(part.triangles, np.uint64),
        twice.astype(np.uint64),
        same[twice].astype(np.uint64),
    )
    result = manifold3d.Manifold(mesh)
    if result.status() != manifold3d.Error.NoError:
        raise DomainError(f"a part is no closed surface ({result.status().name}); close it, or leave it out of the union")
    return result


def merged(vertices: FloatArray) -> NDArray[np.int64]:
    """Number of the first vertex at the place of each; files and seams have several at one place."""
    _, first, back = np.unique(vertices, axis=0, return_index=True, return_inverse=True)
    return np.asarray(first[back.reshape(-1)], np.int64)
