"""Components of an object and its placement at a time: solids of triangles, plumes, points."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray


@dataclass(frozen=True, eq=False)
class Solid:
    """Closed surface of triangles, graybody in emission and Lambertian in reflection."""

    #: In the body's axes [m]: x to starboard, y forward, z up; without a turn they are east, north and up. Shape (vertices, 3).
    vertices: FloatArray
    triangles: NDArray[np.int32]  #: Corners, counterclockwise seen from outside. Shape (triangles, 3).
    temperature: FloatArray  #: Temperature of the surface [K, (vertices,)].
    emissivity: FloatArray  #: Emissivity of the surface [1]; the rest to 1 is reflected. Shape (vertices,).


@dataclass(frozen=True)
class GasPlume:
    """Ellipsoid of gas that emits and transmits, without a surface or reflection, uniform inside.

    It is grey, with an optical depth along a line that is the middle's times (chord / longest chord in that direction), or a mixture of hot
    carbon dioxide and water vapour at 1 atm (:mod:`seaglint.objects.combustion_gas`), which absorbs by the length of the chord.
    """

    centre: tuple[float, float, float]  #: In the body's axes [m].
    semi_axes: tuple[float, float, float]  #: Along x, y and z [m].
    temperature: float  #: Temperature of the gas [K].
    emissivity: float | None = None  #: Of a grey plume along a line through the middle, below 1 [1]; None for one of gases.
    #: ``co2_share``, ``h2o_share``: Mole fractions of carbon dioxide and water vapour [1].
    co2_share: float = 0.0
    h2o_share: float = 0.0


@dataclass(frozen=True)
class PointSource:
    """Source without extent, at the body's origin."""

    intensity: float | None = None  #: In-band radiant intensity before the path [W sr-1], added to what is behind.
    temperature_difference: float | None = None  #: Apparent, to what is behind it [K]; with ``area`` it stands in place of an intensity.
    area: float | None = None  #: Projected [m2].
    #: Of the blackbody that has the spectrum of ``intensity`` [K]; without it the air takes the flat mean of its transmittance.
    temperature: float | None = None


@dataclass(frozen=True, eq=False)
class Placement:
    """Position and attitude of a body at an instant."""

    #: Position of its origin: east and north on the sea's own axes, as the sensor's pose has them; height above the mean sea there [m,
    #: (3,)].
    position: FloatArray
    rotation: FloatArray  #: From the body's axes to east, north and up. Shape (3, 3).
    #: Waterline of a floating body, the plane fixed to it that lies at the mean sea when the sea is flat: its upward unit normal (east,
    #: north, up) and a point of it in the axes of ``position`` [m]. None is the mean sea. Shape (2, 3).
    water: FloatArray | None = None


class Motion(Protocol):
    """Position and attitude of a body as a function of time alone."""

    @property
    def known(self) -> tuple[float, float]:
        """First and last time at which it is known [s]."""
        ...

    def at(self, time: float) -> Placement:
        """Placement at a time from the start [s]."""
        ...


@dataclass(frozen=True, eq=False)
class Body:
    """Object of a scene."""

    name: str
    parts: tuple[Solid | GasPlume | PointSource, ...]
    motion: Motion
