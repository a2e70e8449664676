"""Geometry of a straight line over the effective Earth: heights along it, and its lowest point.

Points of the line are named by their ``share`` of its length: 0 at one end, 1 at the other. Heights follow from
``r^2 = a^2 (1 - x) + b^2 x - x (1 - x) s^2`` with the distances ``a``, ``b`` of the ends from the Earth's centre, written with the
differences to the Earth's radius so that low ends keep their digits.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from seaglint.base.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.base.conventions import FloatArray


def _over_radius(height: FloatArray) -> FloatArray:
    """Difference of squared radii ``(R' + h)^2 - R'^2`` [m2]."""
    return np.asarray(height * (2.0 * EFFECTIVE_EARTH_RADIUS + height))


def heights_along(start: ArrayLike, end: ArrayLike, slant: ArrayLike, share: ArrayLike) -> FloatArray:
    """Heights above the sea [m] at shares of a line of length ``slant`` between the heights ``start`` and ``end`` [m]."""
    a, b = (_over_radius(np.asarray(h, dtype=np.float64)) for h in (start, end))
    x, s = np.asarray(share, dtype=np.float64), np.asarray(slant, dtype=np.float64)
    y = a * (1.0 - x) + b * x - x * (1.0 - x) * s * s
    return np.asarray(y / (np.sqrt(EFFECTIVE_EARTH_RADIUS**2 + y) + EFFECTIVE_EARTH_RADIUS))


def lowest_height(start: ArrayLike, end: ArrayLike, slant: ArrayLike) -> FloatArray:
    """Height of the line's lowest point [m], below 0 where the line passes through the sea's bulge."""
    a, b = (_over_radius(np.asarray(h, dtype=np.float64)) for h in (start, end))
    squared = np.asarray(slant, dtype=np.float64) ** 2
    nearest = np.clip((a - b + squared) / np.maximum(2.0 * squared, 1e-12), 0.0, 1.0)
    return np.minimum(heights_along(start, end, slant, nearest), np.minimum(start, end))
