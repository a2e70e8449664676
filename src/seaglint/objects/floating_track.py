"""Sensor on a floating vessel: heave, pitch and roll of its waterline turn the camera and move it at the mast's top."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from seaglint.base.conventions import FloatArray, wrap_angle
from seaglint.imaging.camera.imager import Attitude
from seaglint.imaging.camera.pose import Pose, Track
from seaglint.objects.attitude import tilt
from seaglint.objects.floating import Swell

MOST_SAMPLES = 257  #: Largest number of times at which the motion is evaluated beforehand: a second's work.

DENSE = 0.25  #: Spacing of these times [s] up to which their extremes are those of the motion, but for :data:`SPARE`.

SPARE = 0.5  #: Margin in standard deviations for motion between two samples beyond their extremes.

FARTHEST = 5.5  #: Margin in standard deviations about the mean where samples are sparse: a Gaussian motion exceeds it once in ten million.

_TURNS = 9  #: Number of azimuths of a turning track at which the camera's reach is evaluated.


@dataclass(frozen=True, eq=False)
class FloatingTrack(Track):
    """Track on a floating vessel; make it with :meth:`create`. ``time`` and ``values`` are those of the keyframes, on a flat sea."""

    swell: Swell
    half_sides: FloatArray
    heading: float | None
    low: FloatArray
    high: FloatArray  #: Least and greatest height [m], azimuth, elevation and roll [rad], with a margin.

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
            Width and length over which waves are averaged [m]; the sensor stands above its middle.
        heading : float, optional
            Azimuth of the vessel's forward end [rad]; along its way where nothing is said, else the camera's at the start.
        times : ndarray
            Instants that are looked at for the reach of the motion [s].
        """
        half = 0.5 * np.asarray(waterline, np.float64)
        afloat = cls(base.time, base.values, swell, half, heading, np.zeros(4), np.zeros(4))
        poses = [afloat.at(float(t)) for t in times]
        flat = [Track.at(afloat, float(t)) for t in times]
        numbers, base_numbers = np.array([_numbers(p) for p in poses]), np.array([_numbers(p) for p in flat])
        spread = (numbers - base_numbers).std(axis=0)
        low, high = numbers.min(axis=0) - SPARE * spread, numbers.max(axis=0) + SPARE * spread
        if len(times) > 1 and times[1] - times[0] > DENSE:
            low = np.minimum(low, base_numbers.min(axis=0) - FARTHEST * spread)
            high = np.maximum(high, base_numbers.max(axis=0) + FARTHEST * spread)
        return cls(base.time, base.values, swell, half, heading, low, high)

    def at(self, time: float) -> Pose:
        """Pose at a time [s]: that of the flat sea, lifted and tilted with the sea under the vessel."""
        flat = super().at(time)
        heading = self._heading(time)
        lift = self.swell.under(np.array([flat.east, flat.north]), heading, self.half_sides, time)
        turn = tilt(heading, lift.starboard, lift.forward)
        mast = turn @ np.array([0.0, 0.0, flat.height])
        attitude = _turned(flat.attitude, turn)
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
        """Least and greatest azimuth, elevation and roll [rad], azimuth and roll unwrapped."""
        return tuple((float(a), float(b)) for a, b in zip(self.low[1:], self.high[1:], strict=True))

    def attitudes(self, parts: int = 8) -> list[Attitude]:
        """Attitudes on the border of the reach."""
        (left, right), elevations, rolls = self.reach()
        azimuths = np.linspace(left, right, _TURNS)
        level = [float(np.clip(e, -0.5 * np.pi, 0.5 * np.pi)) for e in elevations]
        return [Attitude(float(a), e, r) for a in azimuths for e in level for r in rolls]


def _numbers(pose: Pose) -> tuple[float, float, float, float]:
    return pose.height, pose.attitude.azimuth, pose.attitude.elevation, pose.attitude.roll


def _turned(attitude: Attitude, turn: FloatArray) -> Attitude:
    """Attitude rotated with the vessel, its angles near those before."""
    right, _, forward = attitude.axes @ turn.T
    elevation = math.asin(min(max(float(forward[2]), -1.0), 1.0))
    azimuth = math.atan2(float(forward[0]), float(forward[1]))
    level_right, level_up, _ = Attitude(azimuth, elevation).axes
    roll = math.atan2(-float(right @ level_up), float(right @ level_right))
    near = (attitude.azimuth + float(wrap_angle(azimuth - attitude.azimuth)), attitude.roll + float(wrap_angle(roll - attitude.roll)))
    return Attitude(near[0], elevation, near[1])
