"""Sky near the sea horizon for continuous air, computed from the sky of LOWTRAN7's layers.

LOWTRAN7 gives each layer between two levels, a kilometre thick, one temperature, and the sensor's height is a level. A level line of
sight from a low sensor then shines like the mean of the lowest kilometre, 1.5 K colder than the air before the sensor; just below
the horizontal it dips into the thin layer under the sensor, at the temperature of the sea's air, and the sky brightens by that much
within hundredths of a degree: a bright line above the sea horizon that no air makes. In continuous air both lines shine like the air
of the first kilometres before the sensor. The band law of :mod:`seaglint.air.table.absorbers`, whose layers can be as thin as one
likes, says by how much the two differ in each channel; whatever else it leaves out cancels in the ratio.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from seaglint.air.table.absorbers import BandLaw
from seaglint.air.table.profiles import LEVEL_STEP
from seaglint.base.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.base.conventions import FloatArray

HIGHEST_ELEVATION: Final = float(np.radians(0.5))
"""Elevation from which up the sky is LOWTRAN7's own [rad]; up to the horizontal it is that of continuous air."""

HEIGHTS: Final = (100.0, 300.0)
"""Sensor heights [m] up to which the sky near the horizon is that of continuous air, and from which up LOWTRAN7's own."""

_TOP: Final = 10e3
"""Height at which the lines of sight end [m]; above it the band law has no absorbers."""

_THIN: Final = _TOP * (np.arange(1, 80) / 80.0) ** 2
"""Distances above and below the sensor's height of the levels whose thin layers represent continuous air [m]: 1.6, 6.25, 14, 25 ..."""


def share(height: float, elevation: FloatArray) -> FloatArray:
    """Share [1] of continuous air in the sky at elevations [rad] seen from a height [m]; smooth along the elevation."""
    low, high = HEIGHTS
    near = np.clip(np.log(high / height) / np.log(high / low), 0.0, 1.0) if height > 0.0 else 0.0
    t = np.clip(elevation / HIGHEST_ELEVATION, 0.0, 1.0)
    return np.asarray(near * (1.0 - t) ** 3 * (1.0 + 3.0 * t + 6.0 * t * t))


def nodes(dip: float) -> FloatArray:
    """Elevations [rad] from the sea horizon, ``dip`` below the horizontal, to :data:`HIGHEST_ELEVATION`.

    None lies just below the horizontal, where the sky of layers changes as the root of the angle.
    """
    return np.concatenate([-dip * np.array([1.0, 2.0 / 3.0, 1.0 / 3.0]), np.linspace(0.0, HIGHEST_ELEVATION, 5)])


def continuous_over_layered(law: BandLaw, height: float, elevation: FloatArray) -> FloatArray:
    """Ratio [1, (cases, n)] of the sky's radiance in continuous air to that in LOWTRAN7's layers, from a height [m] at elevations [rad]."""
    rise = (EFFECTIVE_EARTH_RADIUS + height) * np.sin(elevation)
    slant = np.sqrt(rise * rise + (_TOP - height) * (2.0 * EFFECTIVE_EARTH_RADIUS + _TOP + height)) - rise
    air = np.sort(np.concatenate([height - _THIN[height > _THIN], [height], height + _THIN]))
    layers = np.union1d(height, np.arange(LEVEL_STEP, _TOP, LEVEL_STEP))
    start, one = np.full_like(slant, height), np.ones((slant.size, law.wavenumber_cm.size))
    continuous, layered = (
        law.emission(law.absorbers.along(start, np.full_like(slant, _TOP), slant, levels), one) for levels in (air, layers)
    )
    return np.asarray(continuous / layered)
