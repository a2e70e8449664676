r"""Foam of ships under way: two strips from the bow along the sides, and the turbulent wake astern.

Water that the bow or the stern passed at an age a ago stays where it is and carries foam with the share

.. math:: s(a) = s_0(U)\,\frac{e^{-a/T} - e^{-n}}{1 - e^{-n}}, \qquad 0 \le a \le n T

with the life T of foam and n = 4. The foam is a pure function of the track over the last nT seconds. It is given to kernels as segments
between the places at some ages, whose half width and share change linearly between their ends.

The strips begin at the stem and lie along the hull, whose entrance is a wedge of a quarter of its length. Their width is the rise of water
at a stem, at most the head :math:`U^2 / 2g` and a quarter of the beam. The wake begins at the stern with the beam W and grows as the width
of turbulent wakes of ships, :math:`W (1 + x/W)^{1/5}` at a distance x. Both have foam from ``QUIET`` on, in full from ``WHITE`` on; these
two speeds and the widths at the bow are plausible choices, not measurements. The waves of a ship are left out.

References
----------
Monahan 1971, J. Phys. Oceanogr. 1, 139 (life of whitecaps in salt water);
Tennekes and Lumley 1972, A First Course in Turbulence, chapter 4 (wakes of self-propelled bodies grow as the fifth root of the distance).
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

import numpy as np

from seaglint.base.constants import GRAVITY
from seaglint.base.conventions import FloatArray
from seaglint.base.jit import kernel

LIFE: Final = 3.85  #: Time in which foam on salt water decays to 1/e [s] (Monahan 1971).

LIVES: Final = 4.0  #: Age of the oldest foam [lives].

QUIET, WHITE = 1.5, 4.0  #: Speeds of a ship below which it leaves no foam, and from which its foam is full [m s-1].

ENTRANCE: Final = 0.25  #: Length of the wedge at the bow [lengths of the waterline].

AGES: Final = 13  #: Number of ages at which the track is read, closer together for young foam.


class Hull(NamedTuple):
    """Waterline of a ship [m]."""

    length: float
    width: float


class FoamSegments(NamedTuple):
    """Foam as segments for ``segments_share``.

    ``segments[i]`` = (east, north, half width, share, sine and cosine of the heading) of the first end and of the second end [m, 1], which
    meet the neighbours' without gaps; ``box`` = least and greatest east, least and greatest north of all foam [m].
    """

    box: np.ndarray
    segments: np.ndarray


NO_SEGMENTS: Final = FoamSegments(np.array([np.inf, -np.inf, np.inf, -np.inf]), np.zeros((0, 12)))  #: Segments of a sea without ships.


def foam_ages(life: float = LIFE) -> FloatArray:
    """Ages of foam at which a track is read [s, (ages,)], from 0."""
    return np.asarray(LIVES * life * np.linspace(0.0, 1.0, AGES) ** 1.5)


def ship_share(speed: FloatArray, age: FloatArray, life: float = LIFE) -> FloatArray:
    """Share of foam that a ship of a speed [m s-1] left at an age ago [s], in the middle of its strips and its wake [1]."""
    full = np.clip((speed - QUIET) / (WHITE - QUIET), 0.0, 1.0)
    last = math.exp(-LIVES)
    return np.asarray(full * np.maximum(np.exp(-age / life) - last, 0.0) / (1.0 - last))


def ship_segments(place: FloatArray, heading: FloatArray, speed: FloatArray, hull: Hull, life: float = LIFE) -> FloatArray:
    """Return the segments of the foam of one ship at an instant [(segments, 12)].

    Parameters
    ----------
    place : ndarray, (ages, 2)
        Middle of the waterline, east and north, ``foam_ages`` before the instant [m].
    heading : ndarray, (ages,)
        Azimuth of its forward end then [rad].
    speed : ndarray, (ages,)
        Its speed then [m s-1].
    hull : Hull
        Its waterline.
    life : float
        Life of foam [s].
    """
    age = foam_ages(life)
    share = ship_share(speed, age, life)
    forward = np.stack([np.sin(heading), np.cos(heading)], axis=1)
    starboard = np.stack([forward[:, 1], -forward[:, 0]], axis=1)
    passed = _passed(place)
    half = 0.5 * np.minimum(speed**2 / (2.0 * GRAVITY), 0.25 * hull.width)
    aside = 0.5 * hull.width * np.minimum(passed / (ENTRANCE * hull.length), 1.0) + half
    stem, stern = place + 0.5 * hull.length * forward, place - 0.5 * hull.length * forward
    wake = 0.5 * hull.width * (1.0 + passed / hull.width) ** 0.2
    strips = [(stem + aside[:, None] * starboard, half), (stem - aside[:, None] * starboard, half), (stern, wake)]
    nodes = [np.concatenate([line, width[:, None], share[:, None], forward], axis=1) for line, width in strips]
    segments = np.concatenate([np.concatenate([line[:-1], line[1:]], axis=1) for line in nodes])
    return np.ascontiguousarray(segments[np.maximum(segments[:, 3], segments[:, 9]) > 0.0])


def _passed(place: FloatArray) -> FloatArray:
    """Distance along the track from the places to the first one [m, (ages,)]."""
    return np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(place, axis=0), axis=1))])


def foam_segments(ships: list[FloatArray]) -> FoamSegments:
    """Return the foam of several ships, ``ship_segments`` of each, for kernels."""
    segments = np.concatenate(ships) if ships else np.zeros((0, 12))
    if not len(segments):
        return NO_SEGMENTS
    ends = segments.reshape(-1, 6)
    low, high = ends[:, :2] - ends[:, 2:3], ends[:, :2] + ends[:, 2:3]
    return FoamSegments(np.array([low[:, 0].min(), high[:, 0].max(), low[:, 1].min(), high[:, 1].max()]), np.ascontiguousarray(segments))


@kernel
def segments_share(foam: FoamSegments, east: float, north: float) -> float:
    """Share of foam of ships at a place [m]: the largest of all segments, 1 - q^4 across each with q the distance over its half width."""
    if east < foam.box[0] or east > foam.box[1] or north < foam.box[2] or north > foam.box[3]:
        return 0.0
    largest = 0.0
    for i in range(foam.segments.shape[0]):
        one = foam.segments[i]
        # distances before the lines across the track at both ends: a place between them is before one and behind the other
        first = (east - one[0]) * one[4] + (north - one[1]) * one[5]
        last = (east - one[6]) * one[10] + (north - one[7]) * one[11]
        if first * last > 0.0 or first == last:
            continue
        f = first / (first - last)
        off_east, off_north = east - one[0] - f * (one[6] - one[0]), north - one[1] - f * (one[7] - one[1])
        half = one[2] + f * (one[8] - one[2])
        if half <= 0.0:
            continue
        q = (off_east * off_east + off_north * off_north) / (half * half)
        if q < 1.0:
            largest = max(largest, (one[3] + f * (one[9] - one[3])) * (1.0 - q * q))
    return largest
