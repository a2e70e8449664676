"""Physical constants, each with its source; everything else comes from :mod:`scipy.constants`.

Values of a single model (Cox-Munk slopes, Elfouhaily's spectrum, ...) are in the file of that model.
"""

from __future__ import annotations

import math
from typing import Final

EARTH_RADIUS: Final = 6_371_000.0  #: Mean radius of the Earth [m] (LOWTRAN7 uses 6371.23 km for its midlatitude models).

#: Radius of an Earth on which optical rays near the sea are straight [m]: 7/6 of the true radius for a standard refractivity gradient.
EFFECTIVE_EARTH_RADIUS: Final = 7.0 / 6.0 * EARTH_RADIUS

SOLAR_ANGULAR_RADIUS: Final = 4.65e-3  #: Angular radius of the Sun at 1 au [rad]; epsilon in Eq. 12 of the source article.

#: Apparent zenith angle of the Sun from which on the air scatters nothing, the end of civil twilight: 96 deg [rad].
DARK_SUN: Final = math.radians(96.0)

GRAVITY: Final = 9.81  #: Acceleration of gravity used by the wave spectra and the dispersion relation [m s-2] (Elfouhaily et al. 1997).

SEA_WATER_DENSITY: Final = 1025.0  #: Density of sea water [kg m-3].

SURFACE_TENSION: Final = 0.074  #: Surface tension of sea water against air [N m-1].

VON_KARMAN: Final = 0.41  #: Von Karman's constant in the logarithmic wind profile.
