"""First contact of a sensor with a body along their paths, at any time between the first and the last frame."""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise
from typing import Final, NamedTuple

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.objects.body import Body, GasPlume, PointSource, Solid
from seaglint.objects.floating import Afloat
from seaglint.objects.mesh_checks import inside
from seaglint.objects.motion import Keyframed

CLEARANCE: Final = 0.1  #: Least distance of a point from the sensor [m].

STRAIGHT: Final = 0.005  #: Largest deviation of a piece of the path from a straight line [m].

MOST_PIECES: Final = 1000  #: Largest number of pieces near a body that are halved; further pieces are taken as straight.

#: Largest assumed lift of a floating body above its path on a flat sea, in standard deviations of the sea under it.
HIGHEST_WAVE: Final = 6.0


class Contact(NamedTuple):
    """Time [s] at which a sensor is in a body, and its distance from the body's origin [m]."""

    time: float
    distance: float


def first_contact(body: Body, eye: Callable[[float], FloatArray], corners: FloatArray, last: float) -> Contact | None:
    """Return the first contact of a sensor with a body between 0 and the last time [s]; None without contact.

    The path of the sensor touches a solid and a plume where it crosses them, a point within ``CLEARANCE``.

    Parameters
    ----------
    body : Body
        With its motion.
    eye : callable
        Position of the sensor at a time: east, north and height [m, (3,)], linear between ``corners``.
    corners : ndarray
        Times at which the sensor's path changes direction [s].
    last : float
        Time of the last frame [s].
    """
    flat, lift = (body.motion.base, _lift(body.motion)) if isinstance(body.motion, Afloat) else (body.motion, 0.0)
    reach = reach_of(body) + lift
    turns = flat.time if isinstance(flat, Keyframed) else np.zeros(0)
    inner = np.concatenate([corners, turns])
    breaks = np.unique(np.concatenate([[0.0, last], inner[(inner > 0.0) & (inner < last)]]))
    pieces = [(float(a), float(b)) for a, b in pairwise(breaks)][::-1] or [(0.0, 0.0)]
    halved = 0
    while pieces:
        begin, end = pieces.pop()
        # between breaks the path is a cubic (a spline less a line): four places determine it
        path = np.stack([eye(t) - flat.at(t).position for t in np.linspace(begin, end, 4)])
        if _beyond(path, reach):
            continue
        times = np.linspace(begin, end, 5)
        sensor = np.stack([_in_body(body, eye, float(t)) for t in times])
        line = sensor[0] + (sensor[-1] - sensor[0]) * np.linspace(0.0, 1.0, 5)[:, None]
        if halved < MOST_PIECES and end > begin and float(np.linalg.norm(sensor - line, axis=1).max()) > STRAIGHT:
            halved += 1
            middle = 0.5 * (begin + end)
            pieces += [(middle, end), (begin, middle)]
            continue
        share = min((at for part in body.parts if (at := _first_touch(part, sensor[0], sensor[-1])) is not None), default=None)
        if share is not None:
            return Contact(begin + share * (end - begin), float(np.linalg.norm(sensor[0] + share * (sensor[-1] - sensor[0]))))
    return None


def _in_body(body: Body, eye: Callable[[float], FloatArray], time: float) -> FloatArray:
    """Return the position of the sensor in a body's axes [m]."""
    at = body.motion.at(time)
    return np.asarray(at.rotation.T @ (eye(time) - at.position))


def _beyond(path: FloatArray, reach: float) -> bool:
    """Return True if a cubic path through four places at even times stays farther than ``reach`` [m] from the origin.

    The path lies in the hull of its Bezier points, and these lie in a ball about the middle of its ends.
    """
    p, q, r, s = path
    control = np.stack([p, (-5.0 * p + 18.0 * q - 9.0 * r + 2.0 * s) / 6.0, (2.0 * p - 9.0 * q + 18.0 * r - 5.0 * s) / 6.0, s])
    middle = 0.5 * (p + s)
    return bool(np.linalg.norm(middle) - np.linalg.norm(control - middle, axis=1).max() > reach)


def _lift(motion: Afloat) -> float:
    """Return the largest assumed height by which waves move a floating body from its place on a flat sea [m]."""
    variance = sum(0.5 * float((waves[:, 3] ** 2 + waves[:, 4] ** 2).sum()) for waves in motion.swell.waves)
    return HIGHEST_WAVE * math.sqrt(variance)


def reach_of(body: Body) -> float:
    """Return the radius of a ball about a body's origin that contains the body [m]."""
    return max(_radius(part) for part in body.parts)


def _radius(part: Solid | GasPlume | PointSource) -> float:
    """Return the radius of a sphere about the body's origin that contains a part [m]."""
    if isinstance(part, Solid):
        return float(np.linalg.norm(part.vertices, axis=1).max())
    if isinstance(part, GasPlume):
        return float(np.linalg.norm(part.centre) + max(part.semi_axes))
    return CLEARANCE


def _first_touch(part: Solid | GasPlume | PointSource, start: FloatArray, end: FloatArray) -> float | None:
    """Return the share of a straight path at which it first meets a part [1]; None where it does not."""
    if isinstance(part, Solid):
        return 0.0 if inside(part, start) else _pierced(part, start, end)
    if isinstance(part, GasPlume):
        centre, axes = np.asarray(part.centre), np.asarray(part.semi_axes)
        return _into_ball((start - centre) / axes, (end - centre) / axes, 1.0)
    return _into_ball(start, end, CLEARANCE)


def _into_ball(start: FloatArray, end: FloatArray, radius: float) -> float | None:
    """Return the share of a straight path at which it enters a ball about the origin [1]; None where it does not."""
    along = end - start
    c = float(start @ start) - radius**2
    if c < 0.0:
        return 0.0
    a, b = float(along @ along), float(start @ along)
    root = b * b - a * c
    if a == 0.0 or root <= 0.0:
        return None
    share = (-b - math.sqrt(root)) / a
    return share if 0.0 <= share <= 1.0 else None


def _pierced(part: Solid, start: FloatArray, end: FloatArray) -> float | None:
    """Return the share of a straight path at which it first crosses a triangle [1] (Moeller and Trumbore 1997); None where it does not."""
    along = end - start
    corner = part.vertices[part.triangles]
    u, v, to = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0], start - corner[:, 0]
    across = np.cross(along, v)
    size = np.einsum("ij,ij->i", u, across)
    other = np.cross(to, u)
    # a path along the plane of a triangle crosses its neighbours
    size = np.where(np.abs(size) > 0.0, size, np.inf)
    g = np.einsum("ij,ij->i", to, across) / size
    h = other @ along / size
    share = np.where(np.isfinite(size), np.einsum("ij,ij->i", v, other) / size, np.inf)
    crossings = share[(g >= 0.0) & (h >= 0.0) & (g + h <= 1.0) & (share >= 0.0) & (share <= 1.0)]
    return float(crossings.min()) if crossings.size else None
