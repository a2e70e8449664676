"""Coordinates of the air: heights along a straight line over the effective Earth, and the axes of the atmosphere tables.

Points of a line are named by their ``share`` of its length: 0 at one end, 1 at the other. Heights follow from
``r^2 = a^2 (1 - x) + b^2 x - x (1 - x) s^2`` with the distances ``a``, ``b`` of the ends from the Earth's centre, written with the
differences to the Earth's radius so that low ends keep their digits.

The axes of the tables are normalised path length, height, elevation and encoded optical depth. The table builder and
``seaglint.air.lowtran_table`` share this file, so that nodes and look-ups always agree.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from seaglint.base.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.base.conventions import FloatArray

SKY_HEIGHT_SCALE = 20.0  #: Height at which the spacing of the sky's height nodes changes from even to geometric [m].

ELEVATION_SCALE = 0.012  #: Angle above the horizontal at which the spacing of elevation nodes changes from even to geometric [rad].

#: Optical depths below which a channel is clear and far above which it is opaque; the encoding spends little precision on either.
OPTICAL_DEPTH_FLOOR, OPTICAL_DEPTH_CEILING = 1e-4, 6.0


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
    # r^2 is a parabola in the share; its minimum may lie beyond the ends, where an end is lowest
    nearest = np.clip((a - b + squared) / np.maximum(2.0 * squared, 1e-12), 0.0, 1.0)
    return np.minimum(heights_along(start, end, slant, nearest), np.minimum(start, end))


def straight_slant(height: ArrayLike, sea_cosine: ArrayLike) -> FloatArray:
    """Length of the straight path over the effective Earth that leaves the sea at ``sea_cosine`` and ends at ``height`` [m]."""
    # rise/(rc + sqrt(rc^2 + rise)) instead of sqrt(rc^2 + rise) - rc, which loses the digits of low heights
    rc, h = EFFECTIVE_EARTH_RADIUS * np.asarray(sea_cosine, dtype=np.float64), np.asarray(height, dtype=np.float64)
    rise = h * (2.0 * EFFECTIVE_EARTH_RADIUS + h)
    return np.asarray(rise / (rc + np.sqrt(rc * rc + rise)))


def straight_sea_cosine(height: float, slant: ArrayLike) -> FloatArray:
    """Inverse of ``straight_slant``: cosine of the zenith angle at the sea [1]."""
    s = np.asarray(slant, dtype=np.float64)
    return np.asarray((height * (2.0 * EFFECTIVE_EARTH_RADIUS + height) - s * s) / (2.0 * EFFECTIVE_EARTH_RADIUS * s))


def path_coordinate(slant: ArrayLike, height: ArrayLike, horizon_slant: ArrayLike) -> FloatArray:
    """Path coordinate ``log(s/h) / log(s_horizon/h)`` [1]: 0 straight down, 1 at the sea horizon. Optical depth is nearly a power of it."""
    h = np.asarray(height, dtype=np.float64)
    return np.asarray(np.log(np.maximum(np.asarray(slant, dtype=np.float64) / h, 1.0)) / np.log(np.asarray(horizon_slant) / h))


def height_coordinate(height: ArrayLike, levels: tuple[float, ...]) -> FloatArray:
    """Coordinate of height for splines [1]: ``log(h)`` up to the first level, then ``j + sqrt(part of layer j)``.

    Just above a level LOWTRAN7's path gains a thin layer of another temperature, and near the horizon that layer dominates
    the emission within tens of metres: the square root spreads those out (95th percentile of path radiance 0.1 instead of 1 %).
    """
    h = np.asarray(height, dtype=np.float64)
    edges = np.array(levels)
    layer = np.clip(np.searchsorted(edges, h, side="right") - 1, 0, edges.size - 2)
    fraction = np.maximum(h - edges[layer], 0.0) / (edges[layer + 1] - edges[layer])
    low = np.log(np.minimum(h, edges[0]) / edges[0])
    return np.asarray(np.where(h <= edges[0], low, layer + np.sqrt(fraction)))


def sky_height_coordinate(height: ArrayLike, levels: tuple[float, ...]) -> FloatArray:
    """Coordinate of height for splines of the sky [1]: 0 at the sea, ``j`` at the ``j``-th level.

    Along the horizontal a thin layer fills the view within metres of the level below it as well as of the level above:
    the inverse sine spreads out both ends. Below the first level ``log(1 + h/20 m)`` makes the sea itself a node.
    """
    h = np.asarray(height, dtype=np.float64)
    edges = np.array(levels)
    layer = np.clip(np.searchsorted(edges, h, side="right") - 1, 0, edges.size - 2)
    fraction = np.clip((h - edges[layer]) / (edges[layer + 1] - edges[layer]), 0.0, 1.0)
    low = np.minimum(np.log1p(h / SKY_HEIGHT_SCALE) / np.log1p(edges[0] / SKY_HEIGHT_SCALE), 1.0)
    return np.asarray(np.where(h <= edges[0], 1.0 - np.sqrt(1.0 - low), 1.0 + layer + np.arcsin(np.sqrt(fraction)) / (0.5 * np.pi)))


def elevation_coordinate(elevation: ArrayLike, dip: ArrayLike) -> FloatArray:
    """Coordinate of the angle above the horizontal, 0 (horizontal) ... 1 (straight up) [1]: ``asinh(e/e0) / asinh(pi/2 e0)``."""
    scale = ELEVATION_SCALE + 0.5 * np.asarray(dip)
    return np.asarray(np.arcsinh(np.asarray(elevation) / scale) / np.arcsinh(0.5 * np.pi / scale))


def elevation_of_coordinate(y: ArrayLike, dip: float) -> FloatArray:
    """Inverse of ``elevation_coordinate``: angle above the horizontal [rad]."""
    scale = ELEVATION_SCALE + 0.5 * dip
    return np.asarray(scale * np.sinh(np.asarray(y) * np.arcsinh(0.5 * np.pi / scale)))


def dip_coordinate(depression: ArrayLike, dip: ArrayLike) -> FloatArray:
    """Coordinate ``sqrt(depression / dip)`` [1] of sky below the horizontal: 0 horizontal, 1 at the sea horizon.

    Such a ray dips to a tangent height and leaves through the same air again; within 0.1 dips of the horizontal the
    air between sensor and tangent height dominates, as the root of the angle (1 K from 2.5 km).
    """
    return np.asarray(np.sqrt(np.maximum(np.asarray(depression, dtype=np.float64), 0.0) / dip))


def encode_optical_depth(optical_depth: ArrayLike) -> FloatArray:
    """Encoded optical depth ``q = log(d/(1 + d/6) + 1e-4)`` [1]: a logarithm that levels off where transmittance is nearly 1 or nearly 0.

    Splines and principal components of ``q`` then work for the optical depths that matter: 32 components leave an error of 0.06 % of
    the 3-5 um band transmittance (above 0.01), 0.1 % with the plain logarithm.
    """
    d = np.asarray(optical_depth, dtype=np.float64)
    return np.asarray(np.log(d / (1.0 + d / OPTICAL_DEPTH_CEILING) + OPTICAL_DEPTH_FLOOR))


def decode_optical_depth(q: FloatArray) -> FloatArray:
    """Optical depth [1] from its encoding, not below 0; depths above 60 are not distinguished."""
    share = np.exp(q)
    share -= OPTICAL_DEPTH_FLOOR
    np.maximum(share, 0.0, out=share)
    # the floor limits the depth to about 60
    return np.asarray(share / np.maximum(1.0 - share / OPTICAL_DEPTH_CEILING, 0.09))
