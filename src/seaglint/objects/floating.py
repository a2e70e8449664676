"""Floating bodies on the resolved waves: heave, roll and pitch of the plane that best fits the sea over their waterline.

The waterline is a rectangle of half sides a (starboard) and b (forward). For a wave of amplitude A and wavenumbers k_x, k_y along them
the plane of least squares has

::

    height = A m(k_x a) m(k_y b),   slope_y = i k_y A m(k_x a) t(k_y b),   m(q) = sin q / q,   t(q) = 3 (sin q - q cos q) / q^3

at its middle: waves much longer than the waterline are followed, those much shorter are averaged out. There is no inertia, no
resonance and no drift: a body answers at once, and stays where its keys put it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.base.jit import njit
from seaglint.objects.attitude import heading_of, rotation, tilt
from seaglint.objects.body import Placement
from seaglint.sea.field import WaveField
from seaglint.sea.wander import Wander

NEGLIGIBLE = 1e-6  #: Share of the variances of height and slope in the waves that may be omitted: 0.1 % of the motion.


class Steered(Protocol):
    """Motion with a velocity."""

    @property
    def known(self) -> tuple[float, float]:
        """First and last time at which it is known [s]."""
        ...

    def at(self, time: float) -> Placement:
        """Placement at a time from the start [s]."""
        ...

    def velocity(self, time: float) -> FloatArray:
        """Velocity towards east, north and up [m s-1, (3,)]."""
        ...


class Lift(NamedTuple):
    """Sea under a waterline: height [m], its rate [m s-1] and slopes towards starboard and forward [1]."""

    height: float
    rate: float
    starboard: float
    forward: float


@dataclass(frozen=True, eq=False)
class Swell:
    """Plane waves of a sea that matter for floating bodies; make it with :meth:`of`."""

    waves: tuple[FloatArray, ...]
    wander: tuple[Wander, ...]

    @classmethod
    def of(cls, field: WaveField, half_sides: tuple[float, float] = (0.0, 0.0)) -> Swell:
        """Return the waves that a waterline of these half sides [m] or wider ones can feel."""
        every = field.plane_waves()
        shares = []
        for waves in every:
            k = np.hypot(waves[:, 0], waves[:, 1])
            # largest response of the narrow side at any heading
            felt = (waves[:, 3] ** 2 + waves[:, 4] ** 2) * np.minimum(1.0, 1.0 / np.maximum(k * min(half_sides), 1e-300)) ** 2
            shares.append(np.stack([felt, felt * k**2], axis=1))
        whole = np.concatenate(shares) / np.concatenate(shares).sum(axis=0)
        weight = np.sort(whole.max(axis=1))
        least = weight[min(int(np.searchsorted(np.cumsum(weight), NEGLIGIBLE)), weight.size - 1)]
        selected, first = [], 0
        for waves in every:
            selected.append(np.ascontiguousarray(waves[whole[first : first + len(waves)].max(axis=1) >= least]))
            first += len(waves)
        return cls(tuple(selected), field.wander)

    def under(self, place: FloatArray, heading: float, half_sides: FloatArray, time: float, velocity: FloatArray | None = None) -> Lift:
        """Sea under a waterline.

        Parameters
        ----------
        place : ndarray, (2,)
            Its middle: east, north of the sea's origin [m].
        heading : float
            Azimuth of its forward side [rad].
        half_sides : ndarray, (2,)
            Towards starboard and forward [m].
        time : float
            From the start [s].
        velocity : ndarray, optional
            Velocity of the middle, towards east and north [m s-1]; it counts for the rate.
        """
        total = np.zeros(6)
        for i, waves in enumerate(self.waves):
            at, stretch = np.asarray(place, np.float64)[:2], np.eye(2)
            if self.wander:
                # over the waterline a tile's displacement is taken to change evenly
                aside = self.wander[i](np.asarray(place[0]), np.asarray(place[1]))
                at, stretch = at + np.array([float(d) for d in aside]), stretch + self.wander[i].gradient(float(place[0]), float(place[1]))
            axes = (math.cos(heading), -math.sin(heading)), (math.sin(heading), math.cos(heading))
            total += _lifted(waves, at, stretch, np.array(axes), np.asarray(half_sides, np.float64), time)
        moving = 0.0 if velocity is None else float(velocity[0] * total[2] + velocity[1] * total[3])
        return Lift(float(total[0]), float(total[1]) + moving, float(total[4]), float(total[5]))


@dataclass(frozen=True, eq=False)
class Afloat:
    """Body that rides on the waves of its place; ``base`` is its motion on a flat sea."""

    base: Steered  #: Motion on a flat sea.
    swell: Swell  #: Waves that it rides on.
    #: ``centre``, ``half_sides``: Centre and half sides of the waterline, towards starboard and forward of the body's origin [m, (2,)].
    centre: FloatArray
    half_sides: FloatArray

    @property
    def known(self) -> tuple[float, float]:
        """First and last time at which it is known [s]."""
        return self.base.known

    def at(self, time: float) -> Placement:
        """Placement at a time from the start [s]."""
        level = self.base.at(time)
        heading = heading_of(level.rotation)
        middle = self._middle(level, heading)
        lift = self.swell.under(middle, heading, self.half_sides, time)
        turn = tilt(heading, lift.starboard, lift.forward)
        foot = np.array([middle[0], middle[1], 0.0])
        lifted = foot + np.array([0.0, 0.0, lift.height])
        return Placement(lifted + turn @ (level.position - foot), turn @ level.rotation, np.stack([turn[:, 2], lifted]))

    def velocity(self, time: float) -> FloatArray:
        """Velocity of the middle of its waterline towards east, north and up [m s-1, (3,)]."""
        level, steady = self.base.at(time), self.base.velocity(time)
        heading = heading_of(level.rotation)
        lift = self.swell.under(self._middle(level, heading), heading, self.half_sides, time, steady[:2])
        return np.asarray(steady + np.array([0.0, 0.0, lift.rate]))

    def _middle(self, level: Placement, heading: float) -> FloatArray:
        return np.asarray(level.position[:2] + rotation(heading)[:2, :2] @ self.centre)


@njit
def _lifted(waves: FloatArray, place: FloatArray, stretch: FloatArray, axes: FloatArray, half_sides: FloatArray, time: float) -> FloatArray:
    """Sums over waves: height, its rate, its derivatives towards east and north, slopes of the plane towards starboard and forward."""
    out = np.zeros(6)
    for i in range(waves.shape[0]):
        k0, k1, frequency = waves[i, 0], waves[i, 1], waves[i, 2]
        phase = k0 * place[0] + k1 * place[1] - frequency * time
        c, s = math.cos(phase), math.sin(phase)
        real, imaginary = waves[i, 3] * c - waves[i, 4] * s, waves[i, 3] * s + waves[i, 4] * c
        east, north = stretch[0, 0] * k0 + stretch[1, 0] * k1, stretch[0, 1] * k0 + stretch[1, 1] * k1
        kx, ky = east * axes[0, 0] + north * axes[0, 1], east * axes[1, 0] + north * axes[1, 1]
        mean_x, tilt_x = _averaged(kx * half_sides[0])
        mean_y, tilt_y = _averaged(ky * half_sides[1])
        mean = mean_x * mean_y
        out[0] += mean * real
        out[1] += mean * frequency * imaginary
        out[2] -= mean * east * imaginary
        out[3] -= mean * north * imaginary
        out[4] -= kx * tilt_x * mean_y * imaginary
        out[5] -= ky * mean_x * tilt_y * imaginary
    return out


@njit
def _averaged(q: float) -> tuple[float, float]:
    """Mean of a wave over a side, and slope of its best linear fit, relative to those at the centre."""
    if abs(q) < 1e-2:
        return 1.0 - q * q / 6.0, 1.0 - 0.1 * q * q
    s, c = math.sin(q), math.cos(q)
    return s / q, 3.0 * (s - q * c) / (q * q * q)
