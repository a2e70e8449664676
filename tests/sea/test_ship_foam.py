"""Foam of ships: strips and wake against their law, on straight and turning tracks."""

import math

import numpy as np
import pytest

from seaglint.sea.foam.ship_foam import (
    LIFE,
    LIVES,
    NO_SEGMENTS,
    QUIET,
    WHITE,
    Hull,
    foam_ages,
    foam_segments,
    segments_share,
    ship_segments,
)

HULL = Hull(60.0, 10.0)


def _straight(time, speed, azimuth=0.7, life=LIFE):
    """Foam of a ship whose waterline's middle is at the origin at time 0."""
    ages = foam_ages(life)
    ahead = np.array([math.sin(azimuth), math.cos(azimuth)])
    place = speed * (time - ages)[:, None] * ahead
    return foam_segments([ship_segments(place, np.full(ages.size, azimuth), np.full(ages.size, speed), HULL, life)])


def _at(foam, forward, starboard, azimuth=0.7, shift=0.0):
    """Share at a place ahead of the origin and to starboard of it [m]."""
    east = (forward + shift) * math.sin(azimuth) + starboard * math.cos(azimuth)
    north = (forward + shift) * math.cos(azimuth) - starboard * math.sin(azimuth)
    return segments_share(foam, east, north)


def _left(age, life=LIFE):
    return (math.exp(-age / life) - math.exp(-LIVES)) / (1.0 - math.exp(-LIVES))


@pytest.mark.parametrize("astern", [0.5, 10.0, 35.0, 60.0])
@pytest.mark.parametrize("life", [1.0, 3.85, 10.0])
def test_the_wake_decays_with_its_age(astern, life):
    age = astern / 6.0
    share = _at(_straight(0.0, 6.0, life=life), -30.0 - astern, 0.0)
    expected = _left(age, life) if age < LIVES * life else 0.0
    # between two ages the exponential is a straight line
    assert share == pytest.approx(expected, abs=0.025)


@pytest.mark.parametrize("side", [-1.0, 1.0])
@pytest.mark.parametrize("behind_stem", [4.0, 20.0, 45.0])
def test_strips_lie_along_both_sides(side, behind_stem):
    speed, foam = 6.0, _straight(0.0, 6.0)
    half = 0.5 * min(speed**2 / (2.0 * 9.81), 2.5)
    hull = 5.0 * min(behind_stem / 15.0, 1.0)
    middle = _at(foam, 30.0 - behind_stem, side * (hull + half))
    assert middle == pytest.approx(_left(behind_stem / speed), abs=0.03)
    assert _at(foam, 30.0 - behind_stem, side * (hull + 2.2 * half)) == 0.0


def test_the_sea_ahead_and_far_aside_has_no_foam():
    foam = _straight(0.0, 8.0)
    assert _at(foam, 35.0, 0.0) == 0.0
    assert _at(foam, -60.0, 40.0) == 0.0
    assert segments_share(foam, 1e5, -1e5) == 0.0
    assert segments_share(NO_SEGMENTS, 0.0, 0.0) == 0.0


def test_foam_moves_with_the_ship_and_fades_without_steps():
    """A steady ship carries a steady pattern; at a fixed place foam comes with the bow or the stern, and then only fades."""
    places = [(-35.0, 0.0), (-70.0, 3.0), (10.0, 6.0), (25.0, -4.0)]
    for time in (0.0, 3.7, 11.2):
        foam = _straight(time, 6.0)
        for forward, starboard in places:
            assert _at(foam, forward, starboard, shift=6.0 * time) == pytest.approx(_at(_straight(0.0, 6.0), forward, starboard), abs=1e-9)
    shares = np.array([[_at(_straight(t, 6.0), *place) for place in places] for t in np.arange(-8.0, 12.0, 0.05)])
    # 0.05 s are 1.3 % of the life; a strip that follows the hull's side passes its edge within half a second
    assert np.diff(shares, axis=0).min() > -0.15
    assert shares.max() > 0.9


@pytest.mark.parametrize(("speed", "share"), [(0.0, 0.0), (QUIET, 0.0), (0.5 * (QUIET + WHITE), 0.5), (WHITE, 1.0), (12.0, 1.0)])
def test_slow_ships_leave_less_foam(speed, share):
    assert _at(_straight(0.0, speed), -30.2, 0.0) == pytest.approx(share, abs=0.02)


def test_a_turning_ship_leaves_its_foam_where_it_was():
    """On a circle of 100 m the middle of the wake is the stern's own path."""
    ages, speed, radius = foam_ages(), 7.0, 100.0
    angle = -speed * ages / radius
    place = radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    # the ship runs counterclockwise: its heading is the tangent's azimuth
    heading = np.arctan2(-np.sin(angle), np.cos(angle))
    foam = foam_segments([ship_segments(place, heading, np.full(ages.size, speed), HULL)])
    for age in (0.5, 3.0, 8.0):
        a = -speed * age / radius
        forward = np.array([-math.sin(a), math.cos(a)])
        stern = radius * np.array([math.cos(a), math.sin(a)]) - 30.0 * forward
        assert segments_share(foam, *stern) == pytest.approx(_left(age), abs=0.03)


def test_two_ships_leave_the_larger_share():
    ages = foam_ages()
    one = ship_segments(np.stack([0.0 * ages, -6.0 * ages], axis=1), 0.0 * ages, 6.0 + 0.0 * ages, HULL)
    other = one.copy()
    other[:, [0, 6]] += 200.0
    both = foam_segments([one, other])
    for east, north in ((0.0, -40.0), (200.0, -40.0), (100.0, -40.0)):
        expected = max(segments_share(foam_segments([one]), east, north), segments_share(foam_segments([other]), east, north))
        assert segments_share(both, east, north) == expected
