"""Bodies prepared for drawing: their solids as one mesh, their gases and their points, each placed at an instant."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray

from seaglint.base.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError
from seaglint.base.jit import njit
from seaglint.objects.body import Body, GasPlume, PointSource, Solid
from seaglint.objects.combustion_gas import longest_chord
from seaglint.objects.drawing.crests import Span
from seaglint.objects.drawing.eye import Stand
from seaglint.objects.mesh_checks import encloses_origin
from seaglint.objects.solids import merged

#: Largest number of temperatures of a body that are evaluated one by one; more are interpolated linearly in a table of 257.
MOST_TEMPERATURES: Final = 16

_TABLED: Final = 257


@dataclass(frozen=True, eq=False)
class Mesh:
    """Mesh of all solids of a body, in its axes."""

    vertices: FloatArray  #: Vertices [m, (vertices, 3)].
    corners: NDArray[np.int32]  #: Numbers of the vertices of each triangle (triangles, 3).
    code: FloatArray  #: Index, with a fraction, of the temperature of each vertex in ``temperatures`` (vertices,).
    emissivity: FloatArray  #: Emissivity of each vertex [1, (vertices,)].
    temperatures: FloatArray  #: Temperatures for which radiances are evaluated [K, (k,)].
    middle: FloatArray  #: Centre of the bounding box [m, (3,)].
    radius: float  #: Radius of the sphere about the middle that contains the mesh [m].
    ends: NDArray[np.int32]  #: Vertices of the edges (edges, 2).
    sides: NDArray[np.int32]  #: Edges of the triangles, counted from 1, negative where they run backwards (triangles, 3).

    @classmethod
    def of(cls, solids: list[Solid]) -> Mesh:
        """Return the mesh of several solids."""
        first = np.concatenate([[0], np.cumsum([s.vertices.shape[0] for s in solids])[:-1]])
        vertices = np.ascontiguousarray(np.concatenate([s.vertices for s in solids]), dtype=np.float64)
        corners = np.concatenate([s.triangles + n for s, n in zip(solids, first, strict=True)]).astype(np.int32)
        kelvin = np.concatenate([np.asarray(s.temperature, np.float64) for s in solids])
        temperatures, inverse = np.unique(kelvin, return_inverse=True)
        code: FloatArray = np.asarray(inverse, np.float64)
        # many temperatures, as in a file with one for each vertex, become an even table
        if temperatures.size > MOST_TEMPERATURES:
            temperatures = np.linspace(temperatures[0], temperatures[-1], _TABLED)
            code = (kelvin - temperatures[0]) / (temperatures[1] - temperatures[0])
        middle = 0.5 * (vertices.min(axis=0) + vertices.max(axis=0))
        radius = float(np.sqrt(((vertices - middle) ** 2).sum(axis=1).max()))
        emissivity = np.concatenate([np.asarray(s.emissivity, np.float64) for s in solids])
        return cls(vertices, np.ascontiguousarray(corners), code, emissivity, temperatures, middle, radius, *_edges(vertices, corners))


def _edges(vertices: FloatArray, corners: NDArray[np.int32]) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """Return the edges of triangles, and the edge numbers of each triangle (``Mesh.ends``, ``Mesh.sides``)."""
    same = merged(vertices)[corners]
    start, end = same, np.roll(same, -1, axis=1)
    count = len(vertices)
    # an edge has one number for both triangles, whichever direction they run along it
    keys, which = np.unique(np.minimum(start, end) * count + np.maximum(start, end), return_inverse=True)
    ends = np.stack(np.divmod(keys, count), axis=1).astype(np.int32)
    return ends, np.where(start < end, which.reshape(same.shape) + 1, -(which.reshape(same.shape) + 1)).astype(np.int32)


@dataclass(frozen=True, eq=False)
class DrawnPart:
    """Part of a body to draw, with number and name of the body."""

    body: int
    name: str
    kind: Mesh | GasPlume | PointSource


def parts_of(bodies: tuple[Body, ...]) -> tuple[DrawnPart, ...]:
    """Return the parts of all bodies; the solids of a body are one part."""
    out: list[DrawnPart] = []
    for number, body in enumerate(bodies):
        solids = [part for part in body.parts if isinstance(part, Solid)]
        if solids:
            out.append(DrawnPart(number, body.name, Mesh.of(solids)))
        out += [DrawnPart(number, body.name, part) for part in body.parts if not isinstance(part, Solid)]
    return tuple(out)


@dataclass(frozen=True, eq=False)
class Placed:
    """Part of a body at an instant, in the sensor's axes [m]."""

    part: DrawnPart  #: Part of the body.
    place: FloatArray  #: Middle of the part [m, (3,)].
    radius: float  #: Radius of a sphere about the middle that encloses the part [m].
    surface: FloatArray  #: Vertices of a mesh; points about a plume; the point itself [m, (n, 3)].
    gas: FloatArray  #: Numbers of a plume for ``chord``; empty for other parts.
    eye: float  #: Height of the sensor above the mean sea [m].
    water: FloatArray  #: Plane of the body's waterline (``seaglint.objects.drawing.eye.Stand.water``). Shape (4,).

    @property
    def distance(self) -> float:
        """Distance to the part's centre [m]."""
        return float(np.linalg.norm(self.place))

    @property
    def azimuth(self) -> float:
        """Azimuth of the part's centre [rad]."""
        return math.atan2(self.place[0], self.place[1])

    @property
    def heading(self) -> tuple[float, float, float]:
        """Azimuth of the part's centre [rad], with its sine and cosine."""
        return self.azimuth, math.sin(self.azimuth), math.cos(self.azimuth)

    @property
    def elevation(self) -> float:
        """Elevation of the part's centre [rad]."""
        return math.atan2(self.place[2], math.hypot(self.place[0], self.place[1]))

    @property
    def angle(self) -> float:
        """Angular radius of the sphere [rad]."""
        return math.asin(min(self.radius / max(self.distance, 1e-9), 1.0))

    @cached_property
    def span(self) -> tuple[Span, tuple[float, float]]:
        """Extent of the part, and its least and greatest height above the mean sea [m]."""
        middle, s, c = self.heading
        low, high = _extent(self.surface, self.eye, (s, c))
        turn, near = (low[0], high[0]), low[1]
        if math.hypot(self.place[0], self.place[1]) <= self.radius:  # over or under the sensor
            # all azimuths, from the sensor's foot on
            turn, near = (-math.pi, math.pi), 0.0
        ends = (middle + turn[0], middle + turn[1])
        return Span(ends, (near, high[1]), low[2], high[2]), (low[3], high[3])


@njit
def _extent(surface: FloatArray, eye: float, heading: tuple[float, float]) -> tuple[list[float], list[float]]:
    """Return least and greatest azimuth from a heading (sine, cosine) [rad], arc [m], tangent of elevation and height [m] of points."""
    s, c = heading
    low, high = [math.inf] * 4, [-math.inf] * 4
    for n in range(surface.shape[0]):
        east, north, up = surface[n, 0], surface[n, 1], surface[n, 2]
        level, over = math.sqrt(east * east + north * north), EFFECTIVE_EARTH_RADIUS + eye + up
        sample = (
            math.atan2(east * c - north * s, east * s + north * c),
            EFFECTIVE_EARTH_RADIUS * math.atan2(level, over),
            up / max(level, 1e-9),
            math.sqrt(level * level + over * over) - EFFECTIVE_EARTH_RADIUS,
        )
        for k in range(4):
            low[k], high[k] = min(low[k], sample[k]), max(high[k], sample[k])
    return low, high


_BALL: Final = np.array(
    [
        [math.sqrt(1.0 - z * z) * math.cos(a), math.sqrt(1.0 - z * z) * math.sin(a), z]
        for z in np.linspace(-1.0, 1.0, 17)
        for a in np.linspace(0.0, 2.0 * np.pi, 32, endpoint=False)
    ]
)


def placed(part: DrawnPart, stand: Stand, eye: float) -> Placed:
    """Return a part of a body at its place, seen from a height [m].

    Raises
    ------
    DomainError
        The sensor is inside the part.
    """
    none = np.zeros(0)
    if isinstance(part.kind, Mesh):
        middle = stand.place + stand.turn @ part.kind.middle
        surface = part.kind.vertices @ stand.turn.T + stand.place
        out = Placed(part, middle, part.kind.radius, surface, none, eye, stand.water)
        if out.distance < out.radius and encloses_origin((surface, part.kind.corners)):
            raise DomainError(
                f"objects '{part.name}': the sensor is inside it; move it, or the sensor, or keep its path clear of the sensor's"
            )
        return out
    if isinstance(part.kind, GasPlume):
        axes, middle = np.asarray(part.kind.semi_axes), stand.place + stand.turn @ np.asarray(part.kind.centre)
        # 3 % beyond the surface, so that the surface between the points is inside their hull
        surface = middle + 1.03 * (_BALL * axes) @ stand.turn.T
        # rows convert a direction in the sensor's axes to units of the semi-axes
        to_unit = stand.turn.T / axes[:, None]
        gas = np.concatenate([to_unit @ middle, to_unit.ravel(), [longest_chord(part.kind)]])
        if np.linalg.norm(gas[:3]) < 1.0:
            raise DomainError(f"objects '{part.name}': the sensor is inside its plume; move it, or the sensor")
        return Placed(part, middle, 1.03 * float(axes.max()), surface, gas, eye, stand.water)
    return Placed(part, stand.place, 0.0, stand.place[None], none, eye, stand.water)
