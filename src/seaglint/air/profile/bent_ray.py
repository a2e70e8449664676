r"""Rays through a profile: refraction by it, and the nodes along them between which absorbers are summed.

Snell's law on a sphere, :math:`n r \sin\theta = c`, gives the zenith angle at every height. Between two nodes the cosine is taken as linear
in the length, so that :math:`\Delta s = 2 \Delta z / (\cos\theta_1 + \cos\theta_2)`: exact for a parabola, at the lowest point too.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from seaglint.base.conventions import FloatArray

FIRST_PIECE: Final = 2.0  #: Length of the first piece of a ray [m].

GROWTH: Final = 1.2  #: Ratio of the distances of neighbouring nodes from the sensor.

THICKEST: Final = ((0.0, 250.0), (12e3, 1e3), (30e3, 5e3))  #: Largest thickness of a piece [m] above heights [m].

#: Largest thickness of a piece [m] above heights [m] in a profile of more than ``MOST_NODE_LEVELS`` levels.
THICKEST_OF_MANY: Final = ((0.0, 25.0), (2e3, 100.0), (5e3, 250.0), (12e3, 500.0), (30e3, 5e3))

#: Largest number of levels of a profile for which every level is a node of every ray; with more levels means between nodes are taken.
MOST_NODE_LEVELS: Final = 100

NEARLY_LEVEL: Final = 0.003  #: Cosine of the zenith angle at its lower end below which a ray has nodes ``ABOVE_LOWEST`` there.

#: Heights of nodes above the lowest point of a ray [m], on either side of which it passes most air.
ABOVE_LOWEST: Final = (4.0, 16.0, 60.0, 130.0, 300.0, 600.0)

#: Gradient of refractivity, in parts of the one that bends a ray like the Earth, up to which rays are followed: layers that trap rays are
#: taken as almost trapping.
STEEPEST: Final = 0.95

ARC_PARTS: Final = 8
ARC_ORDER: Final = 24  #: Parts of a layer, and nodes in each, over which arcs along the sea are integrated.

CLOSEST: Final = 1e-3  #: Smallest distance in height between two nodes [m].


@dataclass(frozen=True, eq=False)
class BentRay:
    """Nodes of a ray from its start on."""

    height: FloatArray  #: Heights of the nodes [m, (nodes,)].
    length: FloatArray  #: Lengths of the pieces between nodes [m, (nodes - 1,)].
    zenith: FloatArray  #: Zenith angle of the onward direction [rad, (nodes,)].
    arc: FloatArray  #: Angle at the Earth's centre from the start [rad, (nodes,)].

    def between(self, parts: int) -> FloatArray:
        """Heights that cut every piece into ``parts`` of equal length, the nodes among them [m, (parts (nodes - 1) + 1,)]."""
        share = np.arange(parts) / parts
        start_cosine, end_cosine = np.cos(self.zenith[:-1, None]), np.cos(self.zenith[1:, None])
        start_cosine, end_cosine = (
            np.copysign(start_cosine, np.diff(self.height)[:, None]),
            np.copysign(end_cosine, np.diff(self.height)[:, None]),
        )
        inside = self.height[:-1, None] + self.length[:, None] * share * (start_cosine + 0.5 * (end_cosine - start_cosine) * share)
        return np.concatenate([inside.ravel(), self.height[-1:]])


@dataclass(frozen=True, eq=False)
class RefractingAir:
    """Refractivity over heights, exponential between levels, around an Earth of a radius.

    Make it with ``of``, or directly if no gradient is to be reduced.
    """

    height: FloatArray  #: Heights of the levels [m, (levels,)].
    log_refractivity: FloatArray  #: ``log(n - 1)`` at the levels [1, (levels,)].
    earth_radius: float  #: Radius of the Earth [m].

    @classmethod
    def of(cls, height: FloatArray, refractivity: FloatArray, earth_radius: float) -> RefractingAir:
        """Air that traps no ray: steeper gradients are reduced to ``STEEPEST`` of the critical one, from the top down."""
        n = np.maximum(refractivity, 1e-20).copy()
        # from the top down, as the limit at a level follows from the level above
        for i in range(n.size - 2, -1, -1):
            n[i] = min(n[i], n[i + 1] + STEEPEST * (height[i + 1] - height[i]) / earth_radius)
        return cls(height, np.log(n), earth_radius)

    def refractivity(self, height: ArrayLike) -> FloatArray:
        """Refractivity ``n - 1`` at heights [m]; above the top the value at the top."""
        return np.asarray(np.exp(np.interp(np.asarray(height, dtype=np.float64), self.height, self.log_refractivity)))

    def invariant(self, height: ArrayLike, sine: ArrayLike = 1.0) -> FloatArray:
        """Snell's invariant less the Earth's radius, ``n r sin(zenith) - R`` [m]; differences of it keep their digits."""
        z, s = np.asarray(height, dtype=np.float64), np.asarray(sine, dtype=np.float64)
        n = self.refractivity(z)
        return np.asarray(z + n * (self.earth_radius + z) - (1.0 - s) * (1.0 + n) * (self.earth_radius + z))

    def cosine(self, height: ArrayLike, invariant: ArrayLike) -> FloatArray:
        """Size of the cosine of the zenith angle at heights [m] of a ray with an invariant, 0 below its lowest point."""
        level = self.invariant(height)
        # 1 - sin, from differences of invariants: near the horizontal the cosine keeps its digits
        lack = np.clip((level - np.asarray(invariant, dtype=np.float64)) / (self.earth_radius + level), 0.0, 1.0)
        return np.asarray(np.sqrt(lack * (2.0 - lack)))

    @cached_property
    def sea_invariant(self) -> float:
        """Invariant of the ray that grazes the sea [m]."""
        return float(self.invariant(0.0))

    def dip(self, height: float) -> float:
        """Depression of the sea's horizon from a height [rad]."""
        return float(self.depression(height, 0.0))

    def depression(self, height: ArrayLike, sea_cosine: ArrayLike) -> FloatArray:
        """Depression at heights [m] of rays that leave the sea at zenith angles ``arccos(sea_cosine)`` [rad]."""
        c = np.clip(np.asarray(sea_cosine, dtype=np.float64), 0.0, 1.0)
        level = (self.earth_radius + self.sea_invariant) / (self.earth_radius + self.invariant(height)) * np.sqrt((1.0 - c) * (1.0 + c))
        return np.asarray(np.arctan2(self.cosine(height, self._from_sea(c)), level))

    def sea_cosine(self, height: ArrayLike, depression: ArrayLike) -> FloatArray:
        """Cosine of the zenith angle at the sea [1] of rays at depressions [rad] from heights [m]; NaN for rays that miss the sea."""
        level, half = self.invariant(height), 0.5 * np.asarray(depression, dtype=np.float64)
        lack = (self.sea_invariant - level + 2.0 * np.sin(half) ** 2 * (self.earth_radius + level)) / (
            self.earth_radius + self.sea_invariant
        )
        with np.errstate(invalid="ignore"):
            return np.asarray(np.sqrt(lack * (2.0 - lack)))

    def sea_arc(self, height: float, sea_cosine: ArrayLike) -> FloatArray:
        """Arc along the sea of rays that leave it at zenith angles ``arccos(sea_cosine)`` and end at a height [m], without errors of steps.

        Between levels the integral over height runs over its root, in which it is smooth down to grazing rays.
        """
        levels = self.height[(self.height > 0.0) & (self.height < height)]
        edges = np.sqrt(np.concatenate([[0.0], levels, [height]]))
        edges = np.interp(np.arange(ARC_PARTS * (edges.size - 1) + 1) / ARC_PARTS, np.arange(edges.size), edges)
        node, weight = np.polynomial.legendre.leggauss(ARC_ORDER)
        half = 0.5 * np.diff(edges)[:, None]
        # dz/cos(zenith) diverges as 1/sqrt(z) for a ray that grazes the sea; over the root of z it is smooth
        root = (edges[:-1, None] + half * (1.0 + node)).ravel()
        z = root * root
        cosine = np.maximum(self.cosine(z, self._from_sea(sea_cosine)[..., None]), 1e-12)
        tangent = np.sqrt((1.0 - cosine) * (1.0 + cosine)) / cosine
        return np.asarray((tangent * (2.0 * root * self.earth_radius / (self.earth_radius + z) * (half * weight).ravel())).sum(axis=-1))

    def _from_sea(self, sea_cosine: ArrayLike) -> FloatArray:
        """Invariants of rays that leave the sea at zenith angles ``arccos(sea_cosine)`` [m]."""
        c = np.clip(np.asarray(sea_cosine, dtype=np.float64), 0.0, 1.0)
        return np.asarray(self.sea_invariant - c * c / (1.0 + np.sqrt((1.0 - c) * (1.0 + c))) * (self.earth_radius + self.sea_invariant))

    def lowest(self, height: float, invariant: ArrayLike) -> FloatArray:
        """Heights of the lowest points of descending rays with invariants [m, (...)], 0 where they meet the sea."""
        of_ray = np.asarray(invariant, dtype=np.float64)
        low, high = np.zeros(of_ray.shape), np.full(of_ray.shape, height)
        for _ in range(60):  # bisection to the last bit
            midpoint = 0.5 * (low + high)
            below = self.invariant(midpoint) < of_ray
            low, high = np.where(below, midpoint, low), np.where(below, high, midpoint)
        return np.where(of_ray <= self.sea_invariant, 0.0, high)

    def ray(self, height: float, zenith: float, end: float | None = None) -> BentRay:
        """Follow a ray from a height [m] at a zenith angle [rad] to the sea, to the top of the air, or to the height ``end`` [m].

        A ray that starts downwards ends where it first reaches ``end`` below its start; to an ``end`` above its start it continues through
        its lowest point.
        """
        return self.rays(height, [zenith], end)[0]

    def rays(self, height: float, zenith: Sequence[float], end: float | None = None) -> list[BentRay]:
        """Follow several rays from one height, as ``ray``: their lowest points are found together."""
        return [self._followed(height, *start, end, None) for start in self._starts(height, zenith)]

    def layered_ray(self, height: float, zenith: float, end: float | None = None, parts: int = 12) -> tuple[BentRay, NDArray[np.intp]]:
        """Follow the same ray [rad] with nodes at the levels [m], each layer in ``parts``; the second result are the levels among them."""
        ray = self._followed(height, *self._starts(height, [zenith])[0], end, parts)
        return ray, np.arange(0, ray.height.size, parts)

    def line(self, height: float, target: float, length: float, cuts: int = 3) -> tuple[FloatArray, FloatArray]:
        """Heights [m, (cuts pieces + 1,)] of a path of a length [m] between two heights [m], and lengths of its cuts [m, (cuts pieces,)].

        The path bends as this air's rays do on the average over the heights that it passes.
        """
        share = FIRST_PIECE * (np.exp(np.arange(0.0, math.log(1.0 + length / FIRST_PIECE), math.log(GROWTH))) - 1.0) / length
        crossed = self.height[(self.height > min(height, target)) & (self.height < max(height, target))]
        if abs(target - height) > 1.0:
            rise = np.concatenate(_ladder(crossed, min(height, target), max(height, target)))
            share = np.concatenate([share, (rise - height) / (target - height)])
        share = np.unique(share)
        share = share[(share > 1e-9) & (share < 1.0 - 1e-6)]
        share = np.concatenate([[0.0], share, [1.0]])
        cut_share = np.concatenate([(share[:-1, None] + np.diff(share)[:, None] * np.arange(cuts) / cuts).ravel(), [1.0]])
        # air that the path passes, its sag between the ends included
        sag = length * length / (8.0 * self.earth_radius)
        low = max(min(height, target) - sag, 0.0)
        high = max(height, target, low + 100.0)
        bend = self.earth_radius * float(self.refractivity(low) - self.refractivity(high)) / (high - low)
        radius = self.earth_radius / (1.0 - min(bend, STEEPEST))
        # r^2 = a^2 (1 - x) + b^2 x - x (1 - x) s^2 about that Earth
        a, b = height * (2.0 * radius + height), target * (2.0 * radius + target)
        y = a * (1.0 - cut_share) + b * cut_share - cut_share * (1.0 - cut_share) * length * length
        z = y / (np.sqrt(radius * radius + y) + radius)
        # where the air bends more than on the average the path sags less: z'' = 1/R - bending(z), ends held
        step = np.diff(cut_share) * length
        across = 1.0 - min(((target - height) / length) ** 2, 1.0)
        for _ in range(2):
            above_sea = np.maximum(z, 0.0)
            local = (self.refractivity(np.maximum(above_sea - 25.0, 0.0)) - self.refractivity(above_sea + 25.0)) / (
                above_sea + 25.0 - np.maximum(above_sea - 25.0, 0.0)
            )
            excess = across * (1.0 / radius - (1.0 / self.earth_radius - np.minimum(local, STEEPEST / self.earth_radius)))
            slope = np.concatenate([[0.0], np.cumsum(0.5 * step * (excess[1:] + excess[:-1]))])
            rise = np.concatenate([[0.0], np.cumsum(0.5 * step * (slope[1:] + slope[:-1]))])
            z = y / (np.sqrt(radius * radius + y) + radius) - (rise - cut_share * rise[-1])
        return z, step

    def _starts(self, height: float, zenith: Sequence[float]) -> list[tuple[float, float | None]]:
        """Invariants of rays [m], and the heights of their lowest points [m], None for rays that start upwards."""
        invariant = self.invariant(height, [math.sin(angle) for angle in zenith])
        down = np.array([angle > 0.5 * math.pi + 1e-12 for angle in zenith])
        lowest = np.zeros(invariant.shape)
        lowest[down] = self.lowest(height, invariant[down])
        return [(float(c), float(z) if falls else None) for c, z, falls in zip(invariant, lowest, down, strict=True)]

    def _followed(self, height: float, invariant: float, lowest: float | None, end: float | None, parts: int | None) -> BentRay:
        top = float(self.height[-1])
        down, bottom, descent = np.array([height]), height, 0.0
        continues = True
        if lowest is not None:
            continues = invariant > self.sea_invariant and (end is None or end >= height)
            bottom = max(lowest, end) if end is not None and end < height else lowest
            if height - bottom > CLOSEST:
                down = self._nodes(bottom, height, invariant, 0.0, parts, descending=True)[::-1]
                cosine = self.cosine(down, invariant)
                descent = float(np.sum(2.0 * -np.diff(down) / np.maximum(cosine[1:] + cosine[:-1], 1e-9)))
            else:
                bottom = height
        up = np.array([bottom])
        if continues and (top if end is None else end) > bottom + CLOSEST:
            # LOWTRAN7's levels include the start's own height where the ray comes back to it
            up = self._nodes(bottom, top if end is None else end, invariant, descent, parts, extra=height)
        z = np.concatenate([down, up[1:]])
        cosine = self.cosine(z, invariant)
        length = 2.0 * np.abs(np.diff(z)) / np.maximum(cosine[1:] + cosine[:-1], 1e-9)
        r = self.earth_radius + z
        sine = np.minimum((self.earth_radius + invariant) / ((1.0 + self.refractivity(z)) * r), 1.0)
        arc = np.concatenate([[0.0], np.cumsum(0.5 * length * (sine[1:] / r[1:] + sine[:-1] / r[:-1]))])
        angle = np.arctan2(sine, cosine)
        # the sign marks the descending part, which has zenith angles beyond pi/2
        angle[: down.size if up.size == 1 else down.size - 1] *= -1.0
        angle = np.where(angle < 0.0, np.pi + angle, angle) if down.size > 1 else np.abs(angle)
        return BentRay(z, length, angle, arc)

    def _nodes(
        self, low: float, high: float, invariant: float, far: float, parts: int | None, *, descending: bool = False, extra: float = -1.0
    ) -> FloatArray:
        """Ascending heights of nodes between two heights; the ray's start is ``far`` [m] before the lower one, or is the upper one."""
        levels = self.height[(self.height > low + 0.1) & (self.height < high - 0.1)]
        if parts is not None:
            if low + 0.1 < extra < high - 0.1:
                levels = np.union1d(levels, [extra])
            edges = np.concatenate([[low], levels, [high]])
            share = np.arange(parts) / parts
            first = edges[0] + (edges[1] - edges[0]) * share**2  # the ray may run level in its lowest layer
            rest = (edges[1:-1, None] + np.diff(edges)[1:, None] * share).ravel()
            return np.concatenate([first, rest, [high]])
        # heights along the ray by a parabola over the effective Earth: only the spacing of the nodes depends on it
        radius = self.earth_radius * 7.0 / 6.0
        farthest = 4.0 * math.sqrt(2.0 * radius * high) + high
        if descending:
            cosine = float(self.cosine(high, invariant))
            s = FIRST_PIECE * np.exp(np.arange(0.0, math.log(farthest / FIRST_PIECE), math.log(GROWTH)))
            z = high - cosine * s + s * s / (2.0 * radius)
            # the parabola of the spacing may turn upwards before the lowest point: only its descending part gives nodes
            z = z[: max(int(np.argmax(np.diff(z, append=np.inf) >= 0.0)), 0)]
        else:
            cosine, base = float(self.cosine(low, invariant)), max(far, FIRST_PIECE)
            s = base * (np.exp(np.arange(0.0, math.log(1.0 + farthest / base), math.log(GROWTH))) - 1.0)
            z = low + cosine * s + s * s / (2.0 * radius)
        level = float(self.cosine(low, invariant)) < NEARLY_LEVEL
        nodes = np.concatenate([z, low + np.array(ABOVE_LOWEST if level else ()), *_ladder(levels, low, high)])
        nodes = np.unique(nodes[(nodes > low + CLOSEST) & (nodes < high - CLOSEST)])
        nodes = np.concatenate([[low], nodes, [high]])
        keep = np.concatenate([[True], np.diff(nodes) > CLOSEST])
        keep[-1] = True
        return np.asarray(nodes[keep])


def trapping_layers(height: FloatArray, refractivity: FloatArray, earth_radius: float) -> list[tuple[float, float]]:
    """Layers that bend rays more than the Earth curves, from and to heights [m], neighbours taken together.

    >>> trapping_layers(np.array([0.0, 50.0, 60.0, 70.0]), 1e-6 * np.array([280.0, 279.0, 276.0, 273.0]), 6371e3)
    [(50.0, 70.0)]
    """
    # a horizontal ray bends by -dn/dz, the Earth by 1/R
    steep = np.diff(refractivity) / np.diff(height) < -1.0 / earth_radius
    edge = np.flatnonzero(np.diff(np.concatenate([[False], steep, [False]])))
    return [(float(height[a]), float(height[b])) for a, b in zip(edge[::2], edge[1::2], strict=True)]


def _ladder(levels: FloatArray, low: float, high: float) -> tuple[FloatArray, FloatArray]:
    """Levels that are nodes, and heights of even spacing between two heights [m]: finer spacing for profiles of too many levels."""
    all_levels = levels.size <= MOST_NODE_LEVELS
    thickest = THICKEST if all_levels else THICKEST_OF_MANY
    ends = [*(start for start, _ in thickest[1:]), np.inf]
    steps = [
        np.arange(step * math.ceil(max(low, start) / step), min(high, stop), step)
        for (start, step), stop in zip(thickest, ends, strict=True)
    ]
    return levels if all_levels else levels[:0], np.concatenate(steps)
