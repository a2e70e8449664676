"""Floating bodies and sensors on the resolved waves: heave, roll and pitch of the plane that best fits the sea over a waterline.

The waterline is a rectangle of half sides a (starboard) and b (forward). For a wave of amplitude A and wavenumbers k_x, k_y along these
axes the plane of least squares has

::

    height = A m(k_x a) m(k_y b),   slope_y = i k_y A m(k_x a) t(k_y b),   m(q) = sin q / q,   t(q) = 3 (sin q - q cos q) / q^3

at its middle: a body follows waves much longer than the waterline and averages out much shorter waves. The model has no inertia, no
resonance and no drift: a body responds at once and its mean position follows its keyframes.

A sensor on a floating vessel is at the top of a mast: heave, pitch and roll of the waterline turn and move the camera.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np

from seaglint.base.conventions import FloatArray, wrap_angle
from seaglint.base.jit import njit
from seaglint.imaging.camera.imager import Attitude
from seaglint.imaging.camera.pose import Pose, Track
from seaglint.objects.body import Placement
from seaglint.objects.motion import heading_of, rotation, tilt
from seaglint.sea.tiles import Wander
from seaglint.sea.wave_field import WaveField

NEGLIGIBLE = 1e-6  #: Share of the variances of height and slope in the waves that may be omitted: 0.1 % of the motion.


class Steered(Protocol):
    """Motion with a velocity."""

    @property
    def known(self) -> tuple[float, float]:
        """First and last time at which the motion is known [s]."""
        ...

    def at(self, time: float) -> Placement:
        """Return the placement at a time from the start [s]."""
        ...

    def velocity(self, time: float) -> FloatArray:
        """Return the velocity towards east, north and up [m s-1, (3,)]."""
        ...


class Lift(NamedTuple):
    """Sea under a waterline: height [m], its rate [m s-1] and slopes towards starboard and forward [1]."""

    height: float
    rate: float
    starboard: float
    forward: float


@dataclass(frozen=True, eq=False)
class Swell:
    """Plane waves of a sea that matter for floating bodies; make it with ``of``."""

    waves: tuple[FloatArray, ...]
    wander: tuple[Wander, ...]

    @classmethod
    def of(cls, field: WaveField, half_sides: tuple[float, float] = (0.0, 0.0)) -> Swell:
        """Return the waves that move a waterline of these half sides [m] or larger ones."""
        every = field.plane_waves()
        shares = []
        for waves in every:
            k = np.hypot(waves[:, 0], waves[:, 1])
            # largest response of the narrow side at any heading
            response = (waves[:, 3] ** 2 + waves[:, 4] ** 2) * np.minimum(1.0, 1.0 / np.maximum(k * min(half_sides), 1e-300)) ** 2
            shares.append(np.stack([response, response * k**2], axis=1))
        # shares of the variance of height and of slope, whichever is greater counts
        whole = np.concatenate(shares) / np.concatenate(shares).sum(axis=0)
        weight = np.sort(whole.max(axis=1))
        # the weakest waves that together carry less than NEGLIGIBLE are omitted
        least = weight[min(int(np.searchsorted(np.cumsum(weight), NEGLIGIBLE)), weight.size - 1)]
        selected, first = [], 0
        for waves in every:
            selected.append(np.ascontiguousarray(waves[whole[first : first + len(waves)].max(axis=1) >= least]))
            first += len(waves)
        return cls(tuple(selected), field.wander)

    def under(self, place: FloatArray, heading: float, half_sides: FloatArray, time: float, velocity: FloatArray | None = None) -> Lift:
        """Return height, rate and slopes of the sea under a waterline.

        Parameters
        ----------
        place : ndarray, (2,)
            Middle of the waterline: east, north of the sea's origin [m].
        heading : float
            Azimuth of the forward side of the waterline [rad].
        half_sides : ndarray, (2,)
            Towards starboard and forward [m].
        time : float
            From the start [s].
        velocity : ndarray, optional
            Velocity of the middle, towards east and north [m s-1]; it enters the rate.
        """
        total = np.zeros(6)
        for i, waves in enumerate(self.waves):
            at, stretch = np.asarray(place, np.float64)[:2], np.eye(2)
            if self.wander:
                # over the waterline the displacement of a tile is approximated as linear
                aside = self.wander[i](np.asarray(place[0]), np.asarray(place[1]))
                at, stretch = at + np.array([float(d) for d in aside]), stretch + self.wander[i].gradient(float(place[0]), float(place[1]))
            # starboard and forward as east and north
            axes = (math.cos(heading), -math.sin(heading)), (math.sin(heading), math.cos(heading))
            total += _lifted(waves, at, stretch, np.array(axes), np.asarray(half_sides, np.float64), time)
        moving = 0.0 if velocity is None else float(velocity[0] * total[2] + velocity[1] * total[3])
        return Lift(float(total[0]), float(total[1]) + moving, float(total[4]), float(total[5]))


@dataclass(frozen=True, eq=False)
class Afloat:
    """Body that rides on the waves of its place; ``base`` is its motion on a flat sea."""

    base: Steered  #: Motion on a flat sea.
    swell: Swell  #: Waves that it rides on.
    centre: FloatArray  #: Centre of the waterline, towards starboard and forward of the body's origin [m, (2,)].
    half_sides: FloatArray  #: Half sides of the waterline, towards starboard and forward [m, (2,)].

    @property
    def known(self) -> tuple[float, float]:
        """First and last time at which the motion is known [s]."""
        return self.base.known

    def at(self, time: float) -> Placement:
        """Return the placement at a time from the start [s]."""
        level = self.base.at(time)
        heading = heading_of(level.rotation)
        middle = self._middle(level, heading)
        lift = self.swell.under(middle, heading, self.half_sides, time)
        turn = tilt(heading, lift.starboard, lift.forward)
        foot = np.array([middle[0], middle[1], 0.0])
        lifted = foot + np.array([0.0, 0.0, lift.height])
        return Placement(lifted + turn @ (level.position - foot), turn @ level.rotation, np.stack([turn[:, 2], lifted]))

    def velocity(self, time: float) -> FloatArray:
        """Return the velocity of the middle of the waterline towards east, north and up [m s-1, (3,)]."""
        level, steady = self.base.at(time), self.base.velocity(time)
        heading = heading_of(level.rotation)
        lift = self.swell.under(self._middle(level, heading), heading, self.half_sides, time, steady[:2])
        return np.asarray(steady + np.array([0.0, 0.0, lift.rate]))

    def _middle(self, level: Placement, heading: float) -> FloatArray:
        return np.asarray(level.position[:2] + rotation(heading)[:2, :2] @ self.centre)


@njit
def _lifted(waves: FloatArray, place: FloatArray, stretch: FloatArray, axes: FloatArray, half_sides: FloatArray, time: float) -> FloatArray:
    """Return sums over waves: height, its rate, its derivatives to east and north, slopes of the plane towards starboard and forward."""
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
    """Return the mean of a wave over a side and the slope of its best linear fit, relative to height and slope at the centre [1]."""
    # series: the closed forms lose digits where q is small
    if abs(q) < 1e-2:
        return 1.0 - q * q / 6.0, 1.0 - 0.1 * q * q
    s, c = math.sin(q), math.cos(q)
    return s / q, 3.0 * (s - q * c) / (q * q * q)


MOST_SAMPLES = 257  #: Largest number of times at which the motion is evaluated beforehand: one second of computing.

DENSE = 0.25  #: Spacing of these times [s] up to which their extremes are the extremes of the motion, within ``SPARE``.

SPARE = 0.5  #: Margin in standard deviations for motion between two samples beyond their extremes.

FARTHEST = 5.5  #: Margin in standard deviations about the mean where samples are sparse: a Gaussian motion exceeds it once in ten million.

_TURNS = 9  #: Number of azimuths of a turning track at which the camera's reach is evaluated.


@dataclass(frozen=True, eq=False)
class FloatingTrack(Track):
    """Track on a floating vessel; make it with ``create``. ``time`` and ``values`` are keyframes on a flat sea."""

    swell: Swell  #: Waves that the vessel rides on.
    half_sides: FloatArray  #: Half sides of the waterline, towards starboard and forward [m, (2,)].
    heading: float | None  #: Azimuth of the vessel's forward end [rad]; None: its direction of motion, or the camera's at the start.
    low: FloatArray  #: Least height [m], azimuth, elevation and roll [rad], with a margin.
    high: FloatArray  #: Greatest height [m], azimuth, elevation and roll [rad], with a margin.

    @classmethod
    def create(  # type: ignore[override]
        cls, base: Track, swell: Swell, waterline: tuple[float, float], heading: float | None, times: FloatArray
    ) -> FloatingTrack:
        """Create the floating track of a track on a flat sea.

        Parameters
        ----------
        base : Track
            On a flat sea.
        swell : Swell
            Waves that the vessel rides on.
        waterline : (float, float)
            Width and length over which waves are averaged [m]; the sensor is above its middle.
        heading : float, optional
            Azimuth of the vessel's forward end [rad]; by default its direction of motion, or the camera's azimuth at the start at rest.
        times : ndarray
            Instants at which the reach of the motion is evaluated [s].
        """
        half = 0.5 * np.asarray(waterline, np.float64)
        afloat = cls(base.time, base.values, swell, half, heading, np.zeros(4), np.zeros(4))
        poses = [afloat.at(float(t)) for t in times]
        flat = [Track.at(afloat, float(t)) for t in times]
        numbers, base_numbers = np.array([_numbers(p) for p in poses]), np.array([_numbers(p) for p in flat])
        deviation = (numbers - base_numbers).std(axis=0)
        low, high = numbers.min(axis=0) - SPARE * deviation, numbers.max(axis=0) + SPARE * deviation
        # extremes between sparse samples are not known: bounds from the standard deviation
        if len(times) > 1 and times[1] - times[0] > DENSE:
            low = np.minimum(low, base_numbers.min(axis=0) - FARTHEST * deviation)
            high = np.maximum(high, base_numbers.max(axis=0) + FARTHEST * deviation)
        return cls(base.time, base.values, swell, half, heading, low, high)

    def at(self, time: float) -> Pose:
        """Return the pose at a time [s]: the pose on a flat sea, lifted and tilted with the sea under the vessel."""
        flat = super().at(time)
        heading = self._heading(time)
        lift = self.swell.under(np.array([flat.east, flat.north]), heading, self.half_sides, time)
        turn = tilt(heading, lift.starboard, lift.forward)
        mast = turn @ np.array([0.0, 0.0, flat.height])
        attitude = _tilted(flat.attitude, turn)
        return Pose(flat.east + float(mast[0]), flat.north + float(mast[1]), lift.height + float(mast[2]), attitude)

    def _heading(self, time: float) -> float:
        if self.heading is not None:
            return self.heading
        if self.time.size > 1:
            row = min(max(int(np.searchsorted(self.time, time, side="right")) - 1, 0), self.time.size - 2)
            east, north = self.values[row + 1, :2] - self.values[row, :2]
            if math.hypot(east, north) > 1e-6:
                return math.atan2(east, north)
        return float(self.values[0, 3])

    @property
    def lowest(self) -> float:
        """Least height [m]."""
        return float(self.low[0])

    @property
    def highest(self) -> float:
        """Greatest height [m]."""
        return float(self.high[0])

    @property
    def turns(self) -> bool:
        """True, as the attitude changes always."""
        return True

    @property
    def moves(self) -> bool:
        """True, as the pose changes always."""
        return True

    def reach(self) -> tuple[tuple[float, float], ...]:
        """Return least and greatest azimuth, elevation and roll [rad], azimuth and roll unwrapped."""
        return tuple((float(a), float(b)) for a, b in zip(self.low[1:], self.high[1:], strict=True))

    def attitudes(self, parts: int = 8) -> list[Attitude]:
        """Return attitudes on the border of the reach."""
        (left, right), elevations, rolls = self.reach()
        azimuths = np.linspace(left, right, _TURNS)
        level = [float(np.clip(e, -0.5 * np.pi, 0.5 * np.pi)) for e in elevations]
        return [Attitude(float(a), e, r) for a in azimuths for e in level for r in rolls]


def _numbers(pose: Pose) -> tuple[float, float, float, float]:
    return pose.height, pose.attitude.azimuth, pose.attitude.elevation, pose.attitude.roll


def _tilted(attitude: Attitude, turn: FloatArray) -> Attitude:
    """Return an attitude rotated with the vessel; its azimuth and roll are within half a turn of the original angles."""
    right, _, forward = attitude.axes @ turn.T
    elevation = math.asin(min(max(float(forward[2]), -1.0), 1.0))
    azimuth = math.atan2(float(forward[0]), float(forward[1]))
    level_right, level_up, _ = Attitude(azimuth, elevation).axes
    # angle from the unrolled camera's right to the turned camera's right
    roll = math.atan2(-float(right @ level_up), float(right @ level_right))
    near = (attitude.azimuth + float(wrap_angle(azimuth - attitude.azimuth)), attitude.roll + float(wrap_angle(roll - attitude.roll)))
    return Attitude(near[0], elevation, near[1])
