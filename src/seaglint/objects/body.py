"""Objects of a scene: their parts (solids of triangles, plumes, points), their motion, and their placement at a time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray


@dataclass(frozen=True, eq=False)
class Solid:
    """Closed surface of triangles, graybody in emission and Lambertian in reflection."""

    #: Corners in the body's axes [m]: x to starboard, y forward, z up; without rotation east, north and up. Shape (vertices, 3).
    vertices: FloatArray
    triangles: NDArray[np.int32]  #: Numbers of the corners, counterclockwise seen from outside. Shape (triangles, 3).
    temperature: FloatArray  #: Temperature of the surface [K, (vertices,)].
    emissivity: FloatArray  #: Emissivity of the surface [1]; the rest to 1 is reflected. Shape (vertices,).


@dataclass(frozen=True)
class GasPlume:
    """Ellipsoid of gas that emits and transmits, without a surface or reflection, uniform inside.

    There are two kinds. A grey plume has an optical depth along a line of (chord / longest chord in that direction) times the optical depth
    through the middle. A mixture of hot carbon dioxide and water vapour at 1 atm (:mod:`seaglint.objects.combustion_gas`) absorbs by the
    length of the chord.
    """

    centre: tuple[float, float, float]  #: Centre in the body's axes [m].
    semi_axes: tuple[float, float, float]  #: Semi-axes along x, y and z [m].
    temperature: float  #: Temperature of the gas [K].
    emissivity: float | None = None  #: Emissivity of a grey plume along a line through the middle, below 1 [1]; None for gases.
    co2_share: float = 0.0  #: Mole fraction of carbon dioxide [1].
    h2o_share: float = 0.0  #: Mole fraction of water vapour [1].


@dataclass(frozen=True)
class PointSource:
    """Source without extent, at the body's origin."""

    intensity: float | None = None  #: In-band radiant intensity before the path [W sr-1], added to the background.
    #: Apparent temperature above the background [K]; with ``area`` it replaces an intensity.
    temperature_difference: float | None = None
    area: float | None = None  #: Projected area [m2].
    #: Temperature of the blackbody with the spectrum of ``intensity`` [K]; without it the path has the flat mean of the transmittance.
    temperature: float | None = None


@dataclass(frozen=True, eq=False)
class Placement:
    """Position and attitude of a body at an instant."""

    #: Position of the body's origin: east and north in the axes of the sea, as in the sensor's pose; height above the mean sea [m, (3,)].
    position: FloatArray
    rotation: FloatArray  #: Rotation from the body's axes to east, north and up. Shape (3, 3).
    #: Plane of the waterline of a floating body, fixed to the body and at the mean sea when the sea is flat: its upward unit normal (east,
    #: north, up) and a point of it in the axes of ``position`` [m]. None: the mean sea. Shape (2, 3).
    water: FloatArray | None = None


class Motion(Protocol):
    """Position and attitude of a body as a function of time alone."""

    @property
    def known(self) -> tuple[float, float]:
        """First and last time at which the motion is known [s]."""
        ...

    def at(self, time: float) -> Placement:
        """Return the placement at a time from the start [s]."""
        ...


@dataclass(frozen=True, eq=False)
class Body:
    """Object of a scene."""

    name: str
    parts: tuple[Solid | GasPlume | PointSource, ...]
    motion: Motion
