"""Motion of bodies: attitudes as rotations, places by latitude and longitude, and placements at rest, on a course or by keyframes.

An attitude is heading clockwise from north, pitch (nose up) and roll (starboard side down):

::

    east, north, up = H(heading) X(pitch) Y(roll) (starboard, forward, upward)

Every placement and velocity is a function of time alone. Positions by keyframes follow a cubic spline, which has a continuous velocity and
acceleration and no acceleration at its ends, or straight lines. Attitudes turn at an even rate from keyframe to keyframe by the shortest
rotation (Shoemake 1985, quaternions).

Latitude and longitude become metres east and north of a place by the geodesic on the WGS 84 ellipsoid (Vincenty, T. 1975: Direct and
inverse solutions of geodesics on the ellipsoid with application of nested equations. Survey Review 23, 88-93).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation, Slerp

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError
from seaglint.base.limits import MOST_SPEED, MOST_TURN
from seaglint.objects.body import Placement


def rotation(heading: float, pitch: float = 0.0, roll: float = 0.0) -> FloatArray:
    """Return the rotation matrix (3, 3) from a body's axes to east, north and up for three angles [rad].

    Examples
    --------
    >>> import numpy as np
    >>> bool(np.allclose(rotation(np.pi / 2) @ [0, 1, 0], [1, 0, 0]))  # heading east: forward is east
    True
    >>> bool((rotation(0.0, roll=0.1) @ [1, 0, 0])[2] < 0)  # starboard side down
    True
    """
    sh, ch, sp, cp, sr, cr = (f(angle) for angle in (heading, pitch, roll) for f in (math.sin, math.cos))
    level = np.array([[ch, sh, 0.0], [-sh, ch, 0.0], [0.0, 0.0, 1.0]])
    pitched = np.array([[1.0, 0.0, 0.0], [0.0, cp, -sp], [0.0, sp, cp]])
    rolled = np.array([[cr, 0.0, sr], [0.0, 1.0, 0.0], [-sr, 0.0, cr]])
    return np.asarray(level @ pitched @ rolled)


def heading_of(matrix: FloatArray) -> float:
    """Return the heading of a rotation [rad]: azimuth of the body's forward axis."""
    return math.atan2(float(matrix[0, 1]), float(matrix[1, 1]))


def tilt(heading: float, starboard: float, forward: float) -> FloatArray:
    """Return the rotation that moves a body's level deck onto a plane and leaves the azimuth of its forward axis.

    Parameters
    ----------
    heading : float
        Heading of the body [rad].
    starboard, forward : float
        Slope of the plane towards the body's starboard and forward side [1].

    Returns
    -------
    ndarray
        Matrix (3, 3) that acts on east, north and up.
    """
    level = rotation(heading)
    # the forward axis moves up the slope within its vertical plane
    ahead = np.array([0.0, 1.0, forward]) / math.hypot(1.0, forward)
    normal = np.array([-starboard, -forward, 1.0])
    normal /= np.linalg.norm(normal)
    return np.asarray(level @ np.stack([np.cross(ahead, normal), ahead, normal], axis=1) @ level.T)


SEMI_MAJOR_AXIS: Final = 6_378_137.0  #: Semi-major axis of the WGS 84 ellipsoid [m].

FLATTENING: Final = 1.0 / 298.257223563  #: Flattening of the WGS 84 ellipsoid [1].


def east_north(latitude: float, longitude: float, start: tuple[float, float]) -> tuple[float, float]:
    """Return the metres towards east and north from ``start = (latitude, longitude)`` [rad], by range and bearing.

    Raises
    ------
    DomainError
        A place near the other side of the Earth, for which the series does not converge.

    Examples
    --------
    >>> import numpy as np
    >>> east, north = east_north(np.radians(37.0), np.radians(-76.0), (np.radians(36.9), np.radians(-76.0)))
    >>> round(east, 3), round(north, 1)
    (0.0, 11097.7)
    """
    # notation of Vincenty's inverse formula: reduced latitudes U, longitude on the auxiliary sphere, iterated; then his series A and B
    f = FLATTENING
    u1, u2 = (math.atan((1.0 - f) * math.tan(angle)) for angle in (start[0], latitude))
    # the shorter way round
    difference = math.remainder(longitude - start[1], 2.0 * math.pi)
    s1, c1, s2, c2 = math.sin(u1), math.cos(u1), math.sin(u2), math.cos(u2)
    reduced = difference
    for _ in range(200):
        s, c = math.sin(reduced), math.cos(reduced)
        sine = math.hypot(c2 * s, c1 * s2 - s1 * c2 * c)
        if sine == 0.0:
            return 0.0, 0.0
        cosine = s1 * s2 + c1 * c2 * c
        arc = math.atan2(sine, cosine)
        sin_a = c1 * c2 * s / sine
        cos2_a = 1.0 - sin_a * sin_a
        middle = cosine - 2.0 * s1 * s2 / cos2_a if cos2_a > 1e-15 else 0.0
        k = f / 16.0 * cos2_a * (4.0 + f * (4.0 - 3.0 * cos2_a))
        before = reduced
        reduced = difference + (1.0 - k) * f * sin_a * (arc + k * sine * (middle + k * cosine * (2.0 * middle**2 - 1.0)))
        if abs(reduced - before) < 1e-13:
            break
    else:
        raise DomainError("a place on the other side of the Earth; give latitude_deg and longitude_deg near [place]")
    square = cos2_a * ((1.0 / (1.0 - f)) ** 2 - 1.0)
    a = 1.0 + square / 16384.0 * (4096.0 + square * (-768.0 + square * (320.0 - 175.0 * square)))
    b = square / 1024.0 * (256.0 + square * (-128.0 + square * (74.0 - 47.0 * square)))
    last = b / 6.0 * middle * (4.0 * sine**2 - 3.0) * (4.0 * middle**2 - 3.0)
    bend = b * sine * (middle + b / 4.0 * (cosine * (2.0 * middle**2 - 1.0) - last))
    length = (1.0 - f) * SEMI_MAJOR_AXIS * a * (arc - bend)
    azimuth = math.atan2(c2 * math.sin(reduced), c1 * s2 - s1 * c2 * math.cos(reduced))
    return length * math.sin(azimuth), length * math.cos(azimuth)


SLOWEST = 1e-6  #: Speed below which a body has no course [m s-1].


@dataclass(frozen=True, eq=False)
class Rest:
    """Motion of a body that does not move."""

    placement: Placement

    @property
    def known(self) -> tuple[float, float]:
        """First and last time at which the motion is known [s]."""
        return -math.inf, math.inf

    def at(self, time: float) -> Placement:
        """Return the placement at a time from the start [s]."""
        return self.placement

    def velocity(self, time: float) -> FloatArray:
        """Return the velocity towards east, north and up [m s-1, (3,)]."""
        return np.zeros(3)


@dataclass(frozen=True, eq=False)
class Course:
    """Motion of a body on a straight course from ``start``, at a steady velocity towards east, north and up [m s-1, (3,)]."""

    start: Placement
    steady: FloatArray

    @property
    def known(self) -> tuple[float, float]:
        """First and last time at which the motion is known [s]."""
        return -math.inf, math.inf

    def at(self, time: float) -> Placement:
        """Return the placement at a time from the start [s]."""
        return Placement(self.start.position + time * self.steady, self.start.rotation)

    def velocity(self, time: float) -> FloatArray:
        """Return the velocity towards east, north and up [m s-1, (3,)]."""
        return self.steady


@dataclass(frozen=True, eq=False)
class Keyframed:
    """Motion of a body from keyframe to keyframe; make it with ``create``."""

    time: FloatArray  #: Times of the keyframes [s].
    position: FloatArray  #: Positions of the keyframes (keyframes, 3): east, north, height [m].
    follows: bool  #: True if the heading is the direction of motion; then the interpolated attitudes are pitch and roll alone.
    _spline: CubicSpline | None
    _turns: Slerp

    @classmethod
    def create(
        cls,
        time: FloatArray,
        position: FloatArray,
        angles: FloatArray,
        names: Sequence[str],
        *,
        follows: bool = False,
        path: Literal["spline", "straight"] = "spline",
    ) -> Keyframed:
        """Check keyframes and interpolate between them.

        Parameters
        ----------
        time : ndarray, (keyframes,)
            Times from the first frame [s].
        position : ndarray, (keyframes, 3)
            East, north, height [m].
        angles : ndarray, (keyframes, 3)
            Heading, pitch, roll [rad].
        names : sequence of str
            Names of the keyframes in error messages, e.g. ``"line 7"``.
        follows : bool
            True for a heading in the direction of motion; the headings in ``angles`` are then not used.
        path : "spline" or "straight"
            Interpolation between positions.

        Raises
        ------
        DomainError
            Fewer than two keyframes, values that are not finite, times that do not increase, and jumps
            (``MOST_SPEED``, ``MOST_TURN``, half a turn, which can go either way).
        """
        if len(time) < 2:
            raise DomainError(f"{len(time)} keyframe{'s' * (len(time) != 1)}; give two or more, or a position without keyframes")
        for row in np.flatnonzero(~np.isfinite(np.column_stack([time, position, angles])).all(axis=1))[:1]:
            raise DomainError(f"{names[row]}: a value is not a finite number; correct or remove the keyframe")
        step = np.diff(time)
        for row in np.flatnonzero(step <= 0.0)[:1]:
            raise DomainError(
                f"{names[row + 1]}: time = {time[row + 1]:g} s is not after {time[row]:g} s of {names[row]}; put keyframes in order of time"
            )
        speed = np.linalg.norm(np.diff(position, axis=0), axis=1) / step
        for row in np.flatnonzero(speed > MOST_SPEED)[:1]:
            raise DomainError(
                f"{names[row]} to {names[row + 1]}: the object jumps at {speed[row]:.4g} m/s; allowed are {MOST_SPEED:g} m/s: correct a "
                "position or a time"
            )
        # with ``follows`` the course is applied later, as a function of time
        heading = np.zeros(len(time)) if follows else angles[:, 0]
        frames = [rotation(float(h), float(p), float(r)) for h, (p, r) in zip(heading, angles[:, 1:], strict=True)]
        rotations = Rotation.from_matrix(np.stack(frames))
        turn = np.asarray((Rotation.from_matrix(np.stack(frames[:-1])).inv() * Rotation.from_matrix(np.stack(frames[1:]))).magnitude())
        for row in np.flatnonzero(turn > np.pi - 1e-7)[:1]:
            raise DomainError(
                f"{names[row]} to {names[row + 1]}: the attitude turns by 180 deg, which can go either way; add a keyframe between"
            )
        for row in np.flatnonzero(turn / step > MOST_TURN)[:1]:
            raise DomainError(
                f"{names[row]} to {names[row + 1]}: the attitude jumps, at {np.degrees(turn[row] / step[row]):.4g} deg/s; allowed are "
                f"{np.degrees(MOST_TURN):g} deg/s: correct heading_deg, pitch_deg, roll_deg or a time"
            )
        # natural: no acceleration at the ends
        spline = CubicSpline(time, position, bc_type="natural") if path == "spline" else None
        return cls(time.copy(), position.copy(), follows, spline, Slerp(time, rotations))

    @property
    def known(self) -> tuple[float, float]:
        """Times of the first and of the last keyframe [s]."""
        return float(self.time[0]), float(self.time[-1])

    def at(self, time: float) -> Placement:
        """Return the placement at a time from the start [s].

        Raises
        ------
        DomainError
            Before the first or after the last keyframe.
        """
        t = self._inside(time)
        if self._spline is not None:
            position = np.asarray(self._spline(t))
        else:
            position = np.array([np.interp(t, self.time, column) for column in self.position.T])
        attitude = np.asarray(self._turns(t).as_matrix())
        return Placement(position, rotation(self._course(t)) @ attitude if self.follows else attitude)

    def velocity(self, time: float) -> FloatArray:
        """Return the velocity towards east, north and up [m s-1, (3,)]; at a corner of straight lines the velocity of the next line."""
        t = self._inside(time)
        if self._spline is not None:
            return np.asarray(self._spline(t, 1))
        row = min(max(int(np.searchsorted(self.time, t, side="right")) - 1, 0), self.time.size - 2)
        return np.asarray((self.position[row + 1] - self.position[row]) / (self.time[row + 1] - self.time[row]))

    def _course(self, time: float) -> float:
        """Return the azimuth of the motion [rad]; at rest the azimuth of the next motion, after the last motion of the last."""
        middle = 0.5 * (self.time[1:] + self.time[:-1])
        # the time itself, then the middles of later pieces, then of earlier ones, the nearest first
        for t in (time, *middle[middle > time], *middle[middle <= time][::-1]):
            east, north, _ = self.velocity(float(t))
            if math.hypot(east, north) > SLOWEST:
                return math.atan2(east, north)
        return 0.0

    def _inside(self, time: float) -> float:
        first, last = float(self.time[0]), float(self.time[-1])
        # frame numbers over the rate, and times typed in decimals, differ by rounding
        slack = 1e-9 * max(abs(first), abs(last), 1.0)
        if not first - slack <= time <= last + slack:
            text = f"time = {time:g} s is outside its keyframes, which span {first:g} to {last:g} s"
            raise DomainError(f"{text}; add keyframes or request fewer frames")
        return min(max(time, first), last)
