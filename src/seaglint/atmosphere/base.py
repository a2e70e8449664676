"""What every atmosphere answers: four spectra along a line of sight, the same questions for a table, a cavity or no air.

All spectra are sampled on ``wavenumber_cm`` (ascending). Radiance is in W m-2 sr-1 per cm-1, irradiance in W m-2 per cm-1.
Paths to the sea are named by sensor height and ``range_m``, the arc along the sea from the sensor's foot
(:mod:`seaglint.conventions`), because refraction makes angles a poor key near the horizon.
"""

from __future__ import annotations

from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from seaglint.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.errors import DomainError

FloatArray = NDArray[np.float64]

GRID_STEP_CM = 5.0
"""Spacing of LOWTRAN7's spectral samples [cm-1]; every atmosphere uses multiples of it unless told otherwise."""


@runtime_checkable
class Atmosphere(Protocol):
    """Spectral transmittance, thermal path radiance, sunlight and thermal sky between the sea and a sensor above it."""

    @property
    def wavenumber_cm(self) -> FloatArray:
        """Ascending spectral samples [cm-1, (n,)]."""
        ...

    def transmittance(self, height: float, range_m: ArrayLike) -> FloatArray:
        """Transmittance of the path from the sea to the sensor [1, (..., n)] for arcs ``range_m`` [m, (...)]."""
        ...

    def path_radiance(self, height: float, range_m: ArrayLike) -> FloatArray:
        """Thermal radiance of the same path [W m-2 sr-1 per cm-1, (..., n)]; scattered sunlight is not in it."""
        ...

    def solar_irradiance(self, solar_zenith: ArrayLike) -> FloatArray:
        """Direct sunlight at the sea on a plane normal to the beam, Sun at 1 au [W m-2 per cm-1, (..., n)]; 0 below the horizon."""
        ...

    def sky_radiance(self, zenith: ArrayLike, height: float = 0.0) -> FloatArray:
        """Thermal radiance of the clear sky seen from ``height`` at ``zenith`` [W m-2 sr-1 per cm-1, (..., n)]."""
        ...


def wavenumber_grid(min_um: float, max_um: float, step_cm: float = GRID_STEP_CM) -> FloatArray:
    """Multiples of ``step_cm`` that cover the wavelengths ``min_um`` to ``max_um`` with both edges inside [cm-1, (n,)].

    >>> wavenumber_grid(3.0, 5.0)[[0, -1]]
    array([2000., 3335.])
    """
    if not 0.0 < min_um < max_um:
        raise DomainError(
            f"band {min_um:g}-{max_um:g} um is empty; give 0 < min_um < max_um",
            name="band_um",
            value=(min_um, max_um),
            allowed="0 < min_um < max_um",
        )
    first = np.floor(1e4 / max_um / step_cm + 1e-9)
    last = np.ceil(1e4 / min_um / step_cm - 1e-9)
    return np.asarray(step_cm * np.arange(first, last + 1.0))


def slant_range(height: float, range_m: ArrayLike) -> FloatArray:
    """Length of the straight path over the effective Earth from the sensor to the sea at an arc ``range_m`` [m].

    ``s^2 = h^2 + 4 R' (R' + h) sin^2(arc / 2R')``; at the sensor's foot it is the height.
    """
    half = np.asarray(range_m, dtype=np.float64) / (2.0 * EFFECTIVE_EARTH_RADIUS)
    return np.asarray(np.sqrt(height**2 + 4.0 * EFFECTIVE_EARTH_RADIUS * (EFFECTIVE_EARTH_RADIUS + height) * np.sin(half) ** 2))


def require_height(height: float, lowest: float, highest: float, remedy: str) -> None:
    """Refuse a sensor height outside ``[lowest, highest]`` [m]."""
    if not lowest <= height <= highest:
        raise DomainError(
            f"sensor height = {height:g} m is outside {lowest:g}-{highest:g} m of this atmosphere; {remedy}",
            name="sensor_height",
            value=height,
            allowed=(lowest, highest),
        )


def require_range(range_m: ArrayLike) -> FloatArray:
    """Arcs along the sea as an array [m]; negative or NaN ones are refused."""
    arc = np.asarray(range_m, dtype=np.float64)
    if not np.all(arc >= 0.0):
        raise DomainError(
            f"range_m holds {np.asarray(arc)[~(arc >= 0.0)].ravel()[0]:g} m; give arcs along the sea of 0 m or more",
            name="range_m",
            value=float(arc[~(arc >= 0.0)].ravel()[0]),
            allowed="0 m or more",
        )
    return arc
