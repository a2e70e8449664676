"""Dispersion of gravity-capillary waves on deep water.

``omega^2 = g k + (T/rho) k^3``, with the surface tension and density of ``seaglint.base.constants`` (Lamb, Hydrodynamics, section 267).
The slowest wave is 1.7 cm long and travels at 0.231 m/s.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from seaglint.base.constants import GRAVITY, SEA_WATER_DENSITY, SURFACE_TENSION
from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError

_KINEMATIC_TENSION: Final = SURFACE_TENSION / SEA_WATER_DENSITY


def angular_frequency(wavenumber: ArrayLike) -> FloatArray:
    """Angular frequency of a wave.

    ``omega = sqrt(g k + (T/rho) k^3)``

    Parameters
    ----------
    wavenumber : array_like
        Wavenumber k >= 0 [rad m⁻¹, any shape].

    Returns
    -------
    ndarray
        Angular frequency [rad s⁻¹].

    Examples
    --------
    >>> import numpy as np
    >>> k = 2 * np.pi / 0.017
    >>> round(float(angular_frequency(k) / k), 3)
    0.231
    """
    k = np.asarray(wavenumber, dtype=np.float64)
    if np.any(k < 0.0):
        raise DomainError(
            f"wavenumber = {float(np.min(k)):g} rad/m is below 0; give k >= 0",
            name="wavenumber",
            value=float(np.min(k)),
            allowed="0 rad/m or more",
        )
    return np.asarray(np.sqrt(k * (GRAVITY + _KINEMATIC_TENSION * k * k)))


def group_velocity(wavenumber: ArrayLike) -> FloatArray:
    """Group velocity, ``d omega/dk = (g + 3 (T/rho) k^2)/(2 omega)`` [m s⁻¹]; infinite at k = 0."""
    k = np.asarray(wavenumber, dtype=np.float64)
    with np.errstate(divide="ignore"):
        return np.asarray((GRAVITY + 3.0 * _KINEMATIC_TENSION * k * k) / (2.0 * angular_frequency(k)))


def wavenumber(angular_frequency: ArrayLike) -> FloatArray:
    """Wavenumber of a wave of given angular frequency, the real root of ``(T/rho) k^3 + g k = omega^2``.

    Cardano's formula in its hyperbolic form, exact to rounding at both ends:
    ``k = 2 sqrt(p/3) sinh(asinh(1.5 q/p sqrt(3/p))/3)`` with ``p = g rho/T``, ``q = omega^2 rho/T``.

    Parameters
    ----------
    angular_frequency : array_like
        Angular frequency >= 0 [rad s⁻¹, any shape].

    Returns
    -------
    ndarray
        Wavenumber [rad m⁻¹].
    """
    omega = np.asarray(angular_frequency, dtype=np.float64)
    if np.any(omega < 0.0):
        raise DomainError(
            f"angular frequency = {float(np.min(omega)):g} rad/s is below 0; give omega >= 0",
            name="angular_frequency",
            value=float(np.min(omega)),
            allowed="0 rad/s or more",
        )
    # arcsinh instead of logarithms and cube roots: both limits, gravity and capillary waves, come without cancellation
    p = GRAVITY / _KINEMATIC_TENSION
    q = omega * omega / _KINEMATIC_TENSION
    return np.asarray(2.0 * np.sqrt(p / 3.0) * np.sinh(np.arcsinh(1.5 * q / p * np.sqrt(3.0 / p)) / 3.0))
