"""Distribution of wave energy over directions by the cosine to a power (Longuet-Higgins, Cartwright and Smith 1963).

``D = Gamma(s + 1)/[2 sqrt(pi) Gamma(s + 1/2)] cos^2s((phi - phi_0)/2)``

Its width is the circular one, ``sigma = sqrt(2 (1 - |c1|))`` with the first moment ``|c1| = s/(s + 1)`` (Kuik, van Vledder and
Holthuijsen 1988, Eq. 33), as buoys and wave models do.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import gammaln

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError

#: Circular widths for which the cosine is used [rad]: sqrt(2) rad (81 degrees) is a sea without direction.
WIDTHS: Final = (float(np.radians(1.0)), float(np.radians(80.0)))


def power_of_width(width: ArrayLike) -> FloatArray:
    """Power ``s = 2/sigma^2 - 1`` of a circular width [rad]; widths outside :data:`WIDTHS` are refused.

    Examples
    --------
    >>> float(power_of_width(np.radians(30.0)).round(2))
    6.3
    """
    sigma = np.asarray(width, dtype=np.float64)
    low, high = WIDTHS
    outside = ~((sigma >= low) & (sigma <= high))
    if np.any(outside):
        value = float(np.degrees(sigma[outside].ravel()[0]))
        raise DomainError(
            f"spreading = {value:g} deg is outside {np.degrees(low):g}-{np.degrees(high):g} deg of the cosine distribution; wind sea has "
            "about 30 deg, swell 10 to 20 deg",
            name="spreading",
            value=value,
            allowed=(float(np.degrees(low)), float(np.degrees(high))),
        )
    return np.asarray(2.0 / sigma**2 - 1.0)


def cosine_power(angle: ArrayLike, s: ArrayLike) -> FloatArray:
    """Distribution ``D`` at an angle from its centre [rad] for a power s [rad⁻¹]."""
    power = np.asarray(s, dtype=np.float64)
    level = np.exp(gammaln(power + 1.0) - gammaln(power + 0.5)) / (2.0 * np.sqrt(np.pi))
    return np.asarray(level * np.abs(np.cos(0.5 * np.asarray(angle, dtype=np.float64))) ** (2.0 * power))


def second_moment(s: float) -> float:
    """Mean of ``cos 2(phi - phi_0)``, ``s (s - 1)/[(s + 1)(s + 2)]`` [1]."""
    return s * (s - 1.0) / ((s + 1.0) * (s + 2.0))
