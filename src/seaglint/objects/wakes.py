"""Foam of the ships among the bodies of a scene: of bodies that float and move."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.objects.body import Body
from seaglint.objects.floating import Afloat
from seaglint.objects.motion import heading_of, rotation
from seaglint.sea.foam.ship_foam import LIFE, QUIET, FoamSegments, Hull, foam_ages, foam_segments, ship_segments


def foam_of_ships(bodies: Iterable[Body], time: float, life: float = LIFE) -> FoamSegments:
    """Return the foam of the floating bodies under way at a time [s], for ``segments_share``.

    Before the first time at which a motion is known the ship came on a straight course at its first speed. The ship's own track counts, not
    its heave, roll and pitch.

    Parameters
    ----------
    bodies : iterable of Body
        Bodies of the scene; those that do not float, and those without a waterline, leave no foam.
    time : float
        Time from the start [s].
    life : float
        Time in which foam decays to 1/e [s].
    """
    return foam_segments([_segments(body.motion, time, life) for body in bodies if isinstance(body.motion, Afloat)])


def _segments(ship: Afloat, time: float, life: float) -> FloatArray:
    """Return the segments of one ship."""
    hull = Hull(2.0 * float(ship.half_sides[1]), 2.0 * float(ship.half_sides[0]))
    if min(hull) <= 0.0:
        return np.zeros((0, 12))
    first, ages = ship.known[0], foam_ages(life)
    place, heading, speed = np.empty((ages.size, 2)), np.empty(ages.size), np.empty(ages.size)
    for i, age in enumerate(ages.tolist()):
        then = max(time - age, first)
        at, velocity = ship.base.at(then), ship.base.velocity(then)
        heading[i] = heading_of(at.rotation)
        middle = at.position[:2] + rotation(float(heading[i]))[:2, :2] @ ship.centre
        # before the motion is known the ship came at its first velocity
        place[i] = middle - (then - (time - age)) * velocity[:2]
        speed[i] = math.hypot(float(velocity[0]), float(velocity[1]))
    return ship_segments(place, heading, speed, hull, life) if speed.max() > QUIET else np.zeros((0, 12))
