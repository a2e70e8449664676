"""Components of an object and its placement at a time: solids of triangles, plumes, points."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray


@dataclass(frozen=True, eq=False)
class Solid:
    """Closed surface of triangles, graybody in emission and Lambertian in reflection.

    Attributes
    ----------
    vertices : ndarray, (vertices, 3)
        In the body's axes [m]: x to starboard, y forward, z up; without a turn they are east, north and up.
    triangles : ndarray of int32, (triangles, 3)
        Corners, counterclockwise seen from outside.
    temperature : ndarray, (vertices,)
        Temperature of the surface [K].
    emissivity : ndarray, (vertices,)
        Emissivity of the surface [1]; the rest to 1 is reflected.
    """

    vertices: FloatArray
    triangles: NDArray[np.int32]
    temperature: FloatArray
    emissivity: FloatArray


@dataclass(frozen=True)
class GasPlume:
    """Ellipsoid of gas that emits and transmits, without a surface or reflection, uniform inside.

    It is grey, with an optical depth along a line that is the middle's times (chord / longest chord in that direction), or a mixture of hot
    carbon dioxide and water vapour at 1 atm (:mod:`seaglint.objects.combustion_gas`), which absorbs by the length of the chord.

    Attributes
    ----------
    centre : tuple of float
        In the body's axes [m].
    semi_axes : tuple of float
        Along x, y and z [m].
    temperature : float
        Temperature of the gas [K].
    emissivity : float, optional
        Of a grey plume along a line through the middle, below 1 [1]; None for one of gases.
    co2_share, h2o_share : float
        Mole fractions of carbon dioxide and water vapour [1].
    """

    centre: tuple[float, float, float]
    semi_axes: tuple[float, float, float]
    temperature: float
    emissivity: float | None = None
    co2_share: float = 0.0
    h2o_share: float = 0.0


@dataclass(frozen=True)
class PointSource:
    """Source without extent, at the body's origin.

    Attributes
    ----------
    intensity : float, optional
        In-band radiant intensity before the path [W sr-1], added to what is behind.
    temperature_difference : float, optional
        Apparent, to what is behind it [K]; with ``area`` it stands in place of an intensity.
    area : float, optional
        Projected [m2].
    temperature : float, optional
        Of the blackbody that has the spectrum of ``intensity`` [K]; without it the air takes the flat mean of its transmittance.
    """

    intensity: float | None = None
    temperature_difference: float | None = None
    area: float | None = None
    temperature: float | None = None


@dataclass(frozen=True, eq=False)
class Placement:
    """Position and attitude of a body at an instant.

    Attributes
    ----------
    position : ndarray, (3,)
        Position of its origin: east and north on the sea's own axes, as the sensor's pose has them; height above the mean sea there [m].
    rotation : ndarray, (3, 3)
        From the body's axes to east, north and up.
    water : ndarray, (2, 3), optional
        Waterline of a floating body, the plane fixed to it that lies at the mean sea when the sea is flat: its upward unit normal (east,
        north, up) and a point of it in the axes of ``position`` [m]. None is the mean sea.
    """

    position: FloatArray
    rotation: FloatArray
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
