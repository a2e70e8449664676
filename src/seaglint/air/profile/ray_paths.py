r"""Heights of rays over the arc along the sea, through layers that may trap them: horizons, ducts and mirages.

With :math:`\zeta = R \ln(1 + z/R)` over the arc :math:`x` the round Earth becomes flat and the index of refraction
:math:`m = n (1 + z/R)`; along a ray that starts at an elevation :math:`e_0`

.. math:: \frac{d^2\zeta}{dx^2} = \frac{1}{2 C^2} \frac{d m^2}{d \zeta}, \qquad C = m_0 \cos e_0

exactly. Between levels :math:`m^2` is linear, so a ray is a parabola there and is followed from level to level without steps.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray

#: Largest thickness of a layer [m] above heights [m]: within it the refractivity's gradient is one number.
FINEST: Final = ((0.0, 5.0), (200.0, 25.0), (2e3, 200.0), (12e3, 1e3))

ABOVE: Final = 2e5  #: Height above the last level up to which rays are followed, without air [m].

MOST_LEVELS: Final = 400  #: Largest number of levels that are all used; larger profiles are sampled at steps of ``DENSE``.

DENSE: Final = ((0.0, 1.0), (100.0, 5.0), (500.0, 25.0), (2e3, 200.0), (12e3, 1e3))  #: As ``FINEST``, for profiles of many levels.

HIGHEST: Final = 0.01  #: Elevation up to which a ray in a duct may come back to the sea [rad].

STEEPER: Final = 16  #: Number of elevations tried between straight down and the horizon of standard air, in even ratios.

MOST_CROSSINGS: Final = 20_000  #: Largest number of levels that a ray crosses; one in a duct crosses some tens in 10 km.


@dataclass(frozen=True, eq=False)
class RayPaths:
    """Rays from one height, followed to the sea, to the top of the air or to the farthest arc."""

    elevation: FloatArray  #: Elevations at the sensor [rad, (rays,)].
    end: FloatArray  #: Arc at which each ray ends [m, (rays,)].
    sea: NDArray[np.bool_]  #: True for rays that end at the sea.
    _radius: float
    _begin: FloatArray
    _height: FloatArray
    _slope: FloatArray
    _curve: FloatArray

    def at(self, arc: float, *, into_sea: bool = False) -> FloatArray:
        """Heights of the rays at an arc [m, (rays,)]; NaN for rays that met the sea before.

        With ``into_sea`` they continue below it, as into the trough of a wave.
        """
        # pieces that a ray no longer has begin at infinity
        piece = np.maximum((self._begin <= arc).sum(axis=0) - 1, 0)
        ray = np.arange(piece.size)
        x = arc - self._begin[piece, ray]
        flat = self._height[piece, ray] + x * (self._slope[piece, ray] + 0.5 * self._curve[piece, ray] * x)
        z = self._radius * np.expm1(flat / self._radius)
        return z if into_sea else np.where(self.sea & (self.end < arc), np.nan, z)


@dataclass(frozen=True, eq=False)
class LayeredIndex:
    """Refraction of a profile, ducts included.

    Parameters
    ----------
    height, refractivity : ndarray
        Levels [m], the first at the sea, and ``n - 1`` there, exponential between them; (levels,).
    earth_radius : float
        [m].
    """

    height: FloatArray
    refractivity: FloatArray
    earth_radius: float

    @cached_property
    def levels(self) -> tuple[FloatArray, FloatArray]:
        """Heights over the flattened Earth [m] and ``log m`` there, (levels,)."""
        top = float(self.height[-1])
        all_levels = self.height.size <= MOST_LEVELS
        steps = FINEST if all_levels else DENSE
        ladder = [
            np.arange(low, min(high, top), step)
            for (low, step), high in zip(steps, [*(low for low, _ in steps[1:]), np.inf], strict=True)
            if low < top
        ]
        z = np.unique(np.concatenate([self.height if all_levels else self.height[[0, -1]], *ladder]))
        z = z[np.concatenate([[True], np.diff(z) > 1e-3])]
        n = np.exp(np.interp(z, self.height, np.log(np.maximum(self.refractivity, 1e-20))))
        # one layer without air, so that rays end above the profile
        z, n = np.append(z, top + ABOVE), np.append(n, 0.0)
        round_earth = np.log1p(z / self.earth_radius)
        return self.earth_radius * round_earth, np.log1p(n) + round_earth

    def paths(self, height: float, elevation: FloatArray, farthest: float) -> RayPaths:
        """Follow rays from a height [m] at elevations [rad, (rays,)] up to an arc [m].

        Errors come from gradients that are constant within ``FINEST`` (1e-6 rad over 30 km); steps cause none.
        """
        zeta, log_m = self.levels
        start = self.earth_radius * np.log1p(height / self.earth_radius)
        first = int(np.clip(np.searchsorted(zeta, start, side="right") - 1, 0, zeta.size - 2))
        square = np.expm1(2.0 * log_m)  # m^2 - 1, which keeps its digits
        gradient = np.diff(square) / np.diff(zeta)
        start_square = square[first] + gradient[first] * (start - zeta[first])
        e = np.asarray(elevation, dtype=np.float64)
        curvature = gradient[:, None] / (2.0 * (1.0 + start_square) * np.cos(e) ** 2)
        x, z, slope = np.zeros(e.size), np.full(e.size, start), np.tan(e)
        layer, active = np.full(e.size, first), np.ones(e.size, bool)
        sea = np.zeros(e.size, bool)
        ray = np.arange(e.size)
        begin, heights, slopes, curves = [], [], [], []
        for _ in range(MOST_CROSSINGS):
            a = curvature[layer, ray]
            begin.append(np.where(active, x, np.inf))
            heights.append(z)
            slopes.append(slope)
            curves.append(a)
            # arcs along the parabola to the upper and the lower level of the layer
            up, down = _reach(zeta[layer + 1] - z, slope, a), _reach(z - zeta[layer], -slope, -a)
            step = np.where(active, np.minimum(up, down), 0.0)
            rises = up < down
            at_end = active & (x + step >= farthest)
            step = np.where(at_end, 0.0, step)
            crossed = active & ~at_end
            slope = np.where(crossed, slope + a * step, slope)
            x = np.where(at_end, farthest, x + step)
            z = np.where(crossed, zeta[np.where(rises, layer + 1, layer)], z)
            layer = layer + np.where(crossed, np.where(rises, 1, -1), 0)
            sea |= crossed & (layer < 0)
            active = crossed & (layer >= 0) & (layer < zeta.size - 1)
            layer = np.clip(layer, 0, zeta.size - 2)
            if not active.any():
                break
        return RayPaths(e, x, sea, self.earth_radius, np.array(begin), np.array(heights), np.array(slopes), np.array(curves))

    def lowest_sky(self, height: float, farthest: float) -> float:
        """Elevation of the sea's horizon from a height [rad]: no ray above it meets the sea within an arc [m]."""
        depth = 1.6 * (np.sqrt(2.0 * height / self.earth_radius) + 1e-3)
        low, high = -min(depth, 0.5 * np.pi), max(depth, HIGHEST)
        # a sea warmer than the air bends rays upwards, so that its horizon may be below any guess; straight down is always sea
        below = -np.geomspace(0.5 * np.pi, -low, STEEPER, endpoint=False)
        elevations = np.concatenate([below, np.linspace(low, high, 65)])
        for _ in range(8):
            sea_hits = np.flatnonzero(self.paths(height, elevations, farthest).sea)
            last = int(sea_hits[-1]) if sea_hits.size else 0
            if last == elevations.size - 1:
                return float(elevations[-1])
            # between the highest ray that meets the sea and the next one
            low, high = float(elevations[last]), float(elevations[last + 1])
            elevations = np.linspace(low, high, 33)
        return float(high)

    def horizon(self, height: float, farthest: float) -> float:
        """Arc to the sea's horizon from a height [m], at most ``farthest``."""
        ray = self.paths(height, np.array([self.lowest_sky(height, farthest) - 1e-9]), farthest)
        return float(ray.end[0])


def _reach(distance: FloatArray, slope: FloatArray, curve: FloatArray) -> FloatArray:
    """Arc to the next crossing of a level ``distance`` ahead [m]; infinite without a crossing."""
    root = slope * slope + 2.0 * curve * distance
    size = np.sqrt(np.maximum(root, 0.0))
    with np.errstate(divide="ignore", invalid="ignore"):
        # first positive root of distance = slope x + curve x^2/2; a rising ray takes the form without cancellation
        ahead = np.where(slope > 0.0, 2.0 * distance / (slope + size), np.where(curve > 0.0, (size - slope) / curve, np.inf))
    return np.where((root >= 0.0) & np.isfinite(ahead), ahead, np.inf)
