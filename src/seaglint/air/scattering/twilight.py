r"""Twilight: sunlight that the air above the Earth's shadow scatters once while the Sun is below the horizon.

The sum over the line of sight stays the same as by day (``seaglint.air.scattering.scattered_line``): each of its places has its own Sun,
and receives the share of the disc above its own refracted horizon, through the air along the bent ray that may graze the Earth. From a
place with the Sun ``delta`` below the horizontal, without refraction, the shadow begins overhead at the height

.. math:: h = R\,(1/\cos\delta - 1)

(35 km at 6 deg), and lines towards the Sun leave it first. What is added here are two functions of the Sun's zenith angle:

- ``refined``: how far the direction of the refracted Sun at a place is iterated. By day one step as in LOWTRAN7 suffices; rays that graze
  the Earth are bent twice, and one step would make twilight brighter by a tenth to a half.
- ``fading``: weight with which the light ends smoothly between 5 and 6 deg below the horizon, where it is far below the thermal radiance.

Light scattered more than once is left out, and so is light from clouds.

References
----------
Rozenberg, G. V. (1966), Twilight: A Study in Atmospheric Optics, Plenum Press, New York.
"""

from __future__ import annotations

import math
from typing import Final

from seaglint.base.constants import DARK_SUN, SOLAR_ANGULAR_RADIUS
from seaglint.base.jit import kernel

LOWEST_SUN: Final = 0.5 * math.pi - SOLAR_ANGULAR_RADIUS  #: Apparent zenith angle of a Sun whose lower limb touches the horizon [rad].

_FADED: Final = math.radians(1.0)  #: Range of zenith angles before ``DARK_SUN`` over which the light ends [rad].

#: Zenith angles of the Sun without refraction between which the iterated direction replaces the single step [rad]. The first is that of a
#: disc on the horizon, in the air with the strongest refraction.
_ONE_STEP, _ITERATED = math.radians(90.6), math.radians(91.6)


def fading(solar_zenith: float) -> float:
    """Return the weight of scattered sunlight for an apparent zenith angle of the Sun [1]; 1 to 5 deg below the horizon, 0 from 6 deg.

    >>> fading(1.0), round(fading(math.radians(95.5)), 12), fading(math.radians(96.0))
    (1.0, 0.5, 0.0)
    """
    left = min(max((DARK_SUN - solar_zenith) / _FADED, 0.0), 1.0)
    return left * left * (3.0 - 2.0 * left)


@kernel
def refined(solar_zenith: float) -> float:
    """Weight of the iterated direction of sunlight [1] for the Sun's zenith angle at the sensor without refraction [rad]."""
    return min(max((solar_zenith - _ONE_STEP) / (_ITERATED - _ONE_STEP), 0.0), 1.0)
