"""Pose of a moving sensor: position and attitude, interpolated between the keyframes of a track."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from seaglint.base.conventions import FloatArray, wrap_angle
from seaglint.base.errors import DomainError
from seaglint.base.limits import MOST_SPEED, MOST_TURN
from seaglint.imaging.camera.imager import Attitude

COLUMNS = ("time", "east", "north", "height", "azimuth", "elevation", "roll")  #: Quantities of a track, in this order.

_TURNING = ("azimuth", "roll")


@dataclass(frozen=True)
class Pose:
    """Position of a sensor at an instant (east, north of the sea's origin; height above the mean sea [m]) and its attitude."""

    east: float
    north: float
    height: float
    attitude: Attitude


@dataclass(frozen=True, eq=False)
class Track:
    """Keyframes of a sensor's path; make it with :meth:`create` or :meth:`standing`.

    Between keyframes positions and elevation are linear in time, azimuth and roll too, the short way round.
    """

    time: FloatArray
    #: Values of keyframes (keyframes, 6): east, north, height [m], azimuth, elevation, roll [rad]; azimuth and roll unwrapped.
    values: FloatArray

    @classmethod
    def standing(cls, height: float, attitude: Attitude) -> Track:
        """Return the track of a sensor that does not move, above the sea's origin."""
        return cls(np.zeros(1), np.array([[0.0, 0.0, height, attitude.azimuth, attitude.elevation, attitude.roll]]))

    @classmethod
    def create(cls, columns: Mapping[str, FloatArray], names: Sequence[str]) -> Track:
        """Check keyframes and interpolate between them.

        Parameters
        ----------
        columns : mapping
            Arrays under ``COLUMNS`` [s, m, rad], one value per keyframe.
        names : sequence of str
            Names of the keyframes in error messages, e.g. ``"line 7"``.

        Raises
        ------
        DomainError
            Fewer than two keyframes, values that are not finite, times that do not increase, a sensor under the sea, an elevation beyond
            the vertical, a jump (``MOST_SPEED``, ``MOST_TURN``), or half a turn, which can go either way.
        """
        table = np.stack([np.asarray(columns[name], dtype=np.float64) for name in COLUMNS], axis=1)
        if table.shape[0] < 2:
            raise DomainError(f"{table.shape[0]} keyframe{'s' * (table.shape[0] != 1)}; give two or more, or a sensor that does not move")
        bad = np.argwhere(~np.isfinite(table))
        if bad.size:
            row, column = bad[0]
            raise DomainError(
                f"{names[row]}: {COLUMNS[column]} = {table[row, column]:g} is not a finite number; correct or remove the keyframe"
            )
        for row in np.flatnonzero(table[:, 3] <= 0.0)[:1]:
            raise DomainError(f"{names[row]}: height = {table[row, 3]:g} m is not above the sea; give a height > 0 m")
        for row in np.flatnonzero(np.abs(table[:, 5]) > 0.5 * np.pi + 1e-12)[:1]:
            raise DomainError(f"{names[row]}: elevation = {np.degrees(table[row, 5]):g} deg is outside -90 to 90 deg")
        step = np.diff(table[:, 0])
        for row in np.flatnonzero(step <= 0.0)[:1]:
            raise DomainError(
                f"{names[row + 1]}: time = {table[row + 1, 0]:g} s is not after {table[row, 0]:g} s of {names[row]}; keyframes must "
                "not overlap"
            )
        for column in (COLUMNS.index(name) for name in _TURNING):
            turn = wrap_angle(np.diff(table[:, column]))
            for row in np.flatnonzero(np.abs(turn) > np.pi - 1e-9)[:1]:
                raise DomainError(
                    f"{names[row]} to {names[row + 1]}: {COLUMNS[column]} turns by 180 deg, which can go either way; add a keyframe between"
                )
            # the short way round
            table[1:, column] = table[0, column] + np.cumsum(turn)
        # after unwrapping: a turn across north is no jump
        _require_no_jump(table, step, names)
        return cls(table[:, 0].copy(), table[:, 1:].copy())

    def at(self, time: float) -> Pose:
        """Return the pose at a time [s]; a fixed sensor has one pose at all times.

        Raises
        ------
        DomainError
            Before the first or after the last keyframe.
        """
        if self.time.size == 1:
            return _pose(self.values[0])
        first, last = float(self.time[0]), float(self.time[-1])
        # frame numbers over the rate, and times typed in decimals, differ by rounding
        slack = 1e-9 * max(abs(first), abs(last), 1.0)
        if not first - slack <= time <= last + slack:
            text = f"time = {time:g} s is outside the platform's keyframes, which span {first:g} to {last:g} s"
            raise DomainError(f"{text}; add keyframes or request fewer frames")
        return _pose(np.array([np.interp(time, self.time, column) for column in self.values.T]))

    @property
    def known(self) -> tuple[float, float]:
        """First and last time at which the pose is known [s]; infinite for a fixed sensor."""
        return (float(self.time[0]), float(self.time[-1])) if self.time.size > 1 else (-np.inf, np.inf)

    @property
    def lowest(self) -> float:
        """Least height [m]."""
        return float(self.values[:, 2].min())

    @property
    def highest(self) -> float:
        """Greatest height [m]."""
        return float(self.values[:, 2].max())

    @property
    def turns(self) -> bool:
        """True if the attitude changes."""
        return bool(np.ptp(self.values[:, 3:], axis=0).max() > 0.0)

    def reach(self) -> tuple[tuple[float, float], ...]:
        """Return least and greatest azimuth, elevation and roll [rad], azimuth and roll unwrapped."""
        return tuple((float(angles.min()), float(angles.max())) for angles in self.values[:, 3:].T)

    @property
    def moves(self) -> bool:
        """True if position or attitude changes."""
        return self.time.size > 1

    def attitudes(self, parts: int = 8) -> list[Attitude]:
        """Return attitudes along the track, ``parts`` in each gap between keyframes."""
        if not self.turns:
            return [_pose(self.values[0]).attitude]
        times = np.unique(np.concatenate([np.linspace(a, b, parts + 1) for a, b in zip(self.time[:-1], self.time[1:], strict=True)]))
        return [self.at(float(t)).attitude for t in times]


def pixel_directions(azimuth: FloatArray, elevation: FloatArray) -> dict[str, Any]:
    """Return azimuth and elevation [rad] as coordinates [deg] of columns and rows, or of all pixels where they are no grid."""
    dims: tuple[Any, Any] = (("y", "x"), ("y", "x")) if azimuth.ndim == 2 else ("x", "y")
    return {"azimuth": (dims[0], np.degrees(azimuth)), "elevation": (dims[1], np.degrees(elevation))}


def pose_at(track: Track, time: float) -> dict[str, float]:
    """Return position and attitude [m, deg] of a moving sensor at a time [s], by the names of variables; empty for one at rest."""
    return {name: float(values[0]) for name, values in poses(track, np.array([time])).items()} if track.moves else {}


def poses(track: Track, times: FloatArray) -> dict[str, FloatArray]:
    """Return positions [m] and attitudes [deg] of a sensor at times [s, (times,)], each (times,).

    They have the names of output variables (``seaglint.base.schema.VARIABLES``).
    """
    sampled = [track.at(float(t)) for t in times]
    return {
        "sensor_east": np.array([p.east for p in sampled]),
        "sensor_north": np.array([p.north for p in sampled]),
        "sensor_height": np.array([p.height for p in sampled]),
        "sensor_azimuth": np.degrees([p.attitude.azimuth for p in sampled]),
        "sensor_elevation": np.degrees([p.attitude.elevation for p in sampled]),
        "sensor_roll": np.degrees([p.attitude.roll for p in sampled]),
    }


def _pose(values: FloatArray) -> Pose:
    east, north, height, azimuth, elevation, roll = (float(v) for v in values)
    return Pose(east, north, height, Attitude(azimuth, elevation, roll))


def _require_no_jump(table: FloatArray, step: FloatArray, names: Sequence[str]) -> None:
    speed = np.linalg.norm(np.diff(table[:, 1:4], axis=0), axis=1) / step
    for row in np.flatnonzero(speed > MOST_SPEED)[:1]:
        raise DomainError(
            f"{names[row]} to {names[row + 1]}: the platform jumps at {speed[row]:.4g} m/s; allowed are {MOST_SPEED:g} m/s: correct a "
            "position or a time"
        )
    rates = np.abs(np.diff(table[:, 4:], axis=0)) / step[:, None]
    for row, column in np.argwhere(rates > MOST_TURN)[:1]:
        raise DomainError(
            f"{names[row]} to {names[row + 1]}: {COLUMNS[4 + column]} turns at {np.degrees(rates[row, column]):.4g} deg/s; allowed are "
            f"{np.degrees(MOST_TURN):g} deg/s: correct an angle or a time"
        )
