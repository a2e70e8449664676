"""Checks of meshes: closed, of one orientation, of some volume, not crossing itself; points inside, materials and waterlines of solids."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError
from seaglint.base.jit import njit
from seaglint.objects.body import Solid
from seaglint.objects.solids import Mesh, merged, volume

THINNEST = 1e-9  #: Least share of its bounding box that a solid fills.


TOUCHING = 1e-6  #: Depth, relative to the size of a mesh, up to which crossing triangles count as touching: files hold seven digits.

MOST_SLABS = 64  #: Largest number of slabs of a mesh that are searched for crossings one by one.

COLDEST, HOTTEST = 100.0, 4000.0  #: Limits of objects' temperatures [K]; values outside are mistyped.


def oriented(mesh: Mesh) -> Mesh:
    """Return a mesh, checked to be a closed surface, with its triangles counterclockwise seen from outside.

    Raises
    ------
    DomainError
        An open mesh, a mesh with triangles of both orientations, without volume, or one that crosses itself.
    """
    vertices, triangles = mesh
    if not len(triangles) or not np.isfinite(vertices).all():
        raise DomainError("the mesh has no triangles, or vertices that are no finite numbers; export it again")
    merged_corners = merged(vertices)[triangles]
    valid = (
        (merged_corners[:, 0] != merged_corners[:, 1])
        & (merged_corners[:, 1] != merged_corners[:, 2])
        & (merged_corners[:, 2] != merged_corners[:, 0])
    )
    merged_corners, triangles = merged_corners[valid], triangles[valid]
    _require_closed(merged_corners)
    enclosed = volume((vertices, triangles))
    size = np.ptp(vertices, axis=0)
    if abs(enclosed) <= THINNEST * max(float(np.prod(size)), 1e-3 * float(size.max()) ** 3):
        raise DomainError(f"the mesh has no volume ({abs(enclosed):.3g} m3); give it some thickness")
    _require_uncrossed(vertices, merged_corners)
    return vertices, np.ascontiguousarray(triangles if enclosed > 0.0 else triangles[:, ::-1])


def inside(part: Solid, place: FloatArray) -> bool:
    """Return True if a place [m, (3,)] in the body's axes is inside a solid: seen from it, the surface fills the whole sphere."""
    if np.any(place < part.vertices.min(axis=0)) or np.any(place > part.vertices.max(axis=0)):
        return False
    return encloses_origin((part.vertices - place, part.triangles))


def encloses_origin(mesh: Mesh) -> bool:
    """Return True if a closed surface encloses the origin: the solid angles of its triangles add to a full sphere."""
    a, b, c = (mesh[0][mesh[1][:, i]] for i in range(3))
    la, lb, lc = (np.linalg.norm(v, axis=1) for v in (a, b, c))
    # half of a solid angle by its tangent (Van Oosterom and Strackee 1983); the sum is 2 pi inside and 0 outside
    numerator = np.sum(a * np.cross(b, c), axis=1)
    denominator = la * lb * lc + np.sum(a * b, axis=1) * lc + np.sum(b * c, axis=1) * la + np.sum(c * a, axis=1) * lb
    return bool(abs(np.sum(np.arctan2(numerator, denominator))) > np.pi)


def _require_closed(triangles: NDArray[np.int64]) -> None:
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    most = int(edges.max()) + 1
    forward, backward = edges[:, 0] * most + edges[:, 1], edges[:, 1] * most + edges[:, 0]
    along, count = np.unique(forward, return_counts=True)
    against, other = np.unique(backward, return_counts=True)
    if along.size == against.size and np.array_equal(along, against) and np.array_equal(count, other):
        return
    _, times = np.unique(np.sort(edges, axis=1), axis=0, return_counts=True)
    lone = int(np.count_nonzero(times % 2))
    if lone:
        raise DomainError(f"the mesh is open: {lone} edges have a triangle on one side only; close its holes")
    raise DomainError("the mesh has triangles of both orientations; make its normals consistent")


def _require_uncrossed(vertices: FloatArray, triangles: NDArray[np.int64]) -> None:
    corners = vertices[triangles]
    low, high = corners.min(axis=1), corners.max(axis=1)
    # sorted along the axis on which triangles are smallest relative to the mesh, in slabs of the axis with the next smallest ones
    size = np.maximum(np.ptp(vertices, axis=0), 1e-300)
    axes = np.argsort((high - low).mean(axis=0) / size, kind="stable")
    order = np.argsort(low[:, axes[0]], kind="stable")
    depth, begin, wide = TOUCHING * float(size.max()), float(vertices[:, axes[1]].min()), float(size[axes[1]])
    slabs = int(np.clip(0.125 * wide / max(float((high - low)[:, axes[1]].mean()), 1e-300), 1, MOST_SLABS))
    first = second = -1
    for slab in range(slabs):
        bottom, top = (begin + wide * k / slabs for k in (slab, slab + 1))
        members = order[(low[order, axes[1]] <= top) & (high[order, axes[1]] >= bottom)]
        arranged = [np.ascontiguousarray(values[members][..., axes]) for values in (corners, low, high)]
        first, second = _crossing(arranged[0], arranged[1], arranged[2], np.ascontiguousarray(triangles[members]), depth)
        if first >= 0:
            first, second = int(members[first]), int(members[second])
            break
    if first >= 0:
        x, y, z = corners[first].mean(axis=0)
        raise DomainError(
            f"the mesh crosses itself near ({x:.4g}, {y:.4g}, {z:.4g}) m (triangles {first} and {second}); unite its shells, "
            "or give them as parts of a union"
        )


@njit
def _crossing(corners: FloatArray, low: FloatArray, high: FloatArray, triangles: NDArray[np.int64], depth: float) -> tuple[int, int]:
    """Return the first two triangles without a common corner that cross by more than ``depth`` [m]; (-1, -1) without any.

    Triangles are sorted by their lower end on the first axis.
    """
    for i in range(low.shape[0]):
        end, y0, y1, z0, z1 = high[i, 0], low[i, 1], high[i, 1], low[i, 2], high[i, 2]
        x, y, z = _normal(corners[i, 0], corners[i, 1], corners[i, 2])
        long = math.sqrt(x * x + y * y + z * z)
        level, thick = x * corners[i, 0, 0] + y * corners[i, 0, 1] + z * corners[i, 0, 2], depth * long
        for j in range(i + 1, low.shape[0]):
            if low[j, 0] > end:
                break
            if low[j, 1] > y1 or high[j, 1] < y0 or low[j, 2] > z1 or high[j, 2] < z0:
                continue
            # most neighbours lie on one side of the triangle's plane
            d0 = x * corners[j, 0, 0] + y * corners[j, 0, 1] + z * corners[j, 0, 2] - level
            d1 = x * corners[j, 1, 0] + y * corners[j, 1, 1] + z * corners[j, 1, 2] - level
            d2 = x * corners[j, 2, 0] + y * corners[j, 2, 1] + z * corners[j, 2, 2] - level
            if min(d0, d1, d2) >= -thick or max(d0, d1, d2) <= thick:
                continue
            shared = False
            for m in range(3):
                for n in range(3):
                    shared = shared or triangles[i, m] == triangles[j, n]
            if shared:
                continue
            for m in range(3):
                n = (m + 1) % 3
                if _pierces(corners[i, m], corners[i, n], corners[j], depth) or _pierces(corners[j, m], corners[j, n], corners[i], depth):
                    return i, j
    return -1, -1


@njit
def _pierces(start: FloatArray, end: FloatArray, triangle: FloatArray, depth: float) -> bool:
    """Return True if a segment passes through a triangle by more than ``depth`` on both sides, farther than ``depth`` from its edges."""
    a, b, c = triangle[0], triangle[1], triangle[2]
    before, behind = _six_volumes(a, b, c, start), _six_volumes(a, b, c, end)
    if before * behind >= 0.0:
        return False
    x, y, z = _normal(a, b, c)
    long = math.sqrt(x * x + y * y + z * z)
    if min(abs(before), abs(behind)) <= depth * long:
        return False
    u, v, w = _six_volumes(start, end, a, b), _six_volumes(start, end, b, c), _six_volumes(start, end, c, a)
    if not ((u > 0.0 and v > 0.0 and w > 0.0) or (u < 0.0 and v < 0.0 and w < 0.0)):
        return False
    # distances from the edges, by the shares of the corners opposite to them
    least = depth * abs(u + v + w) / long
    return abs(u) > least * _distance(a, b) and abs(v) > least * _distance(b, c) and abs(w) > least * _distance(c, a)


@njit
def _distance(a: FloatArray, b: FloatArray) -> float:
    return math.sqrt((b[0] - a[0]) ** 2 + (b[1] - a[1]) ** 2 + (b[2] - a[2]) ** 2)


@njit
def _normal(a: FloatArray, b: FloatArray, c: FloatArray) -> tuple[float, float, float]:
    """Return the normal of a triangle, with a length of twice its area [m2]."""
    x0, y0, z0 = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    x1, y1, z1 = c[0] - a[0], c[1] - a[1], c[2] - a[2]
    return y0 * z1 - z0 * y1, z0 * x1 - x0 * z1, x0 * y1 - y0 * x1


@njit
def _six_volumes(a: FloatArray, b: FloatArray, c: FloatArray, d: FloatArray) -> float:
    x0, y0, z0 = a[0] - d[0], a[1] - d[1], a[2] - d[2]
    x1, y1, z1 = b[0] - d[0], b[1] - d[1], b[2] - d[2]
    x2, y2, z2 = c[0] - d[0], c[1] - d[1], c[2] - d[2]
    return float(x0 * (y1 * z2 - z1 * y2) - y0 * (x1 * z2 - z1 * x2) + z0 * (x1 * y2 - y1 * x2))


def require_materials(part: Solid) -> None:
    """Raise for emissivities outside 0 to 1 and temperatures outside the limits.

    Raises
    ------
    DomainError
        A value outside its limits; the message has the first.
    """
    for value in part.emissivity[~((part.emissivity >= 0.0) & (part.emissivity <= 1.0))][:1]:
        raise DomainError(f"emissivity = {value:g} of a vertex is outside 0 to 1; correct the file")
    for value in part.temperature[~((part.temperature >= COLDEST) & (part.temperature <= HOTTEST))][:1]:
        raise DomainError(f"temperature = {value:g} K of a vertex is outside {COLDEST:g} to {HOTTEST:g} K; correct the file")


def waterline(part: Solid, level: float) -> tuple[FloatArray, FloatArray] | None:
    """Return the rectangle along x and y that has the second moments of a solid's section at a height in its axes [m].

    Returns
    -------
    (ndarray, ndarray) or None
        Centre and half sides (x, y) [m]; None where the level does not cut the solid.
    """
    corners = part.vertices[part.triangles]
    # a level that runs through vertices is moved out of them
    height = corners[..., 2] - level
    height = np.where(height == 0.0, 1e-9 * max(float(np.ptp(corners[..., 2])), 1e-9), height)
    above = height > 0.0
    cut = above.any(axis=1) & ~above.all(axis=1)
    if not cut.any():
        return None
    corners, height, above = corners[cut], height[cut], above[cut]
    # the corner that is alone on its side comes first
    alone = np.argmax(above == (above.sum(axis=1) == 1)[:, None], axis=1)
    turn = (alone[:, None] + np.arange(3)) % 3
    corners = np.take_along_axis(corners, turn[..., None], axis=1)
    height = np.take_along_axis(height, turn, axis=1)
    share = height[:, :1] / (height[:, :1] - height[:, 1:])
    crossing = corners[:, :1, :2] + (corners[:, 1:, :2] - corners[:, :1, :2]) * share[..., None]
    first, second = crossing[:, 0], crossing[:, 1]
    # the border is oriented with the section on its left, for a lone corner above or below the level
    swap = (height[:, 0] < 0.0)[:, None]
    start, end = np.where(swap, second, first), np.where(swap, first, second)
    twice = start[:, 0] * end[:, 1] - end[:, 0] * start[:, 1]
    area = 0.5 * float(twice.sum())
    if abs(area) < 1e-12:
        return None
    # centroid and second moments of a polygon as sums over its border (Green's theorem)
    centre = np.array([float(np.sum((start[:, i] + end[:, i]) * twice)) for i in range(2)]) / (6.0 * area)
    second_moment = np.array([float(np.sum((start[:, i] ** 2 + start[:, i] * end[:, i] + end[:, i] ** 2) * twice)) for i in range(2)])
    spread = second_moment / (12.0 * area) - centre**2
    return centre, np.sqrt(3.0 * np.maximum(spread, 0.0))
