"""Foam of the bodies that float and move."""

import numpy as np
import pytest

from seaglint.objects.body import Body, Placement
from seaglint.objects.floating import Afloat, Swell
from seaglint.objects.motion import Course, Keyframed, Rest, rotation
from seaglint.objects.wakes import foam_of_ships
from seaglint.sea.foam.ship_foam import segments_share

CALM = Swell((), ())


def _ship(motion, half_sides=(4.0, 25.0), centre=(0.0, 0.0)):
    return Body("ship", (), Afloat(motion, CALM, np.array(centre), np.array(half_sides)))


def _course(east_speed, azimuth=0.5 * np.pi):
    return Course(Placement(np.array([100.0, 50.0, 2.0]), rotation(azimuth)), np.array([east_speed, 0.0, 0.0]))


def test_a_ship_under_way_has_foam_astern():
    foam = foam_of_ships([_ship(_course(7.0))], 10.0)
    assert segments_share(foam, 100.0 + 70.0 - 26.0, 50.0) > 0.9
    assert segments_share(foam, 100.0 + 70.0 + 27.0, 50.0) == 0.0
    # the same ship earlier, the same foam farther back
    before = foam_of_ships([_ship(_course(7.0))], 0.0)
    assert segments_share(before, 100.0 - 40.0, 53.0) == pytest.approx(segments_share(foam, 170.0 - 40.0, 53.0), abs=1e-12)


def test_a_waterline_off_the_origin_moves_the_foam():
    moved = foam_of_ships([_ship(_course(7.0), centre=(0.0, 10.0))], 0.0)
    plain = foam_of_ships([_ship(_course(7.0))], 0.0)
    assert segments_share(moved, 90.0, 52.0) == pytest.approx(segments_share(plain, 80.0, 52.0), abs=1e-12)


@pytest.mark.parametrize(
    "body",
    [
        _ship(Rest(Placement(np.zeros(3), np.eye(3)))),
        _ship(_course(1.0)),
        _ship(_course(7.0), half_sides=(0.0, 0.0)),
        Body("aircraft", (), _course(60.0)),
    ],
    ids=["at rest", "slow", "no waterline", "not afloat"],
)
def test_others_leave_none(body):
    assert len(foam_of_ships([body], 3.0).segments) == 0


def test_a_ship_of_keyframes_came_straight_before_its_first():
    time, east = np.array([0.0, 20.0, 40.0]), np.array([0.0, 140.0, 280.0])
    position = np.stack([east, 0.0 * east, 0.0 * east + 2.0], axis=1)
    frames = Keyframed.create(time, position, np.tile([0.5 * np.pi, 0.0, 0.0], (3, 1)), ("a", "b", "c"), path="straight")
    early, later = foam_of_ships([_ship(frames)], 0.0), foam_of_ships([_ship(frames)], 30.0)
    for astern in (26.0, 60.0, 100.0):
        assert segments_share(early, -astern, 1.0) == pytest.approx(segments_share(later, 210.0 - astern, 1.0), abs=1e-9)
