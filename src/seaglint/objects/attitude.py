"""Attitude of a body: heading clockwise from north, pitch (nose up), roll (starboard side down), as a rotation of its axes.

::

    east, north, up = H(heading) X(pitch) Y(roll) (starboard, forward, upward)
"""

from __future__ import annotations

import math

import numpy as np

from seaglint.base.conventions import FloatArray


def rotation(heading: float, pitch: float = 0.0, roll: float = 0.0) -> FloatArray:
    """Rotation matrix from a body's axes to east, north and up for three angles [rad, (3, 3)].

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


def heading_of(turned: FloatArray) -> float:
    """Heading of a rotation [rad]: azimuth of the body's forward axis."""
    return math.atan2(float(turned[0, 1]), float(turned[1, 1]))


def tilt(heading: float, starboard: float, forward: float) -> FloatArray:
    """Rotation that lays a body's level deck on a plane, without turning its forward axis aside.

    Parameters
    ----------
    heading : float
        Heading of the body [rad].
    starboard, forward : float
        Slope of the plane towards its starboard and forward [1].

    Returns
    -------
    ndarray
        Acts on east, north and up [(3, 3)].
    """
    level = rotation(heading)
    ahead = np.array([0.0, 1.0, forward]) / math.hypot(1.0, forward)
    normal = np.array([-starboard, -forward, 1.0])
    normal /= np.linalg.norm(normal)
    return np.asarray(level @ np.stack([np.cross(ahead, normal), ahead, normal], axis=1) @ level.T)
