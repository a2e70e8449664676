"""Tracks of moving sensors: what lies between keyframes, and what is refused."""

import numpy as np
import pytest

from seaglint.base.errors import DomainError
from seaglint.imaging.camera.pose import COLUMNS, Track

START = {"time": 0.0, "east": 0.0, "north": 0.0, "height": 30.0, "azimuth": 0.0, "elevation": -0.1, "roll": 0.0}


def track(*changes):
    rows = [START | {"time": float(i)} | change for i, change in enumerate(changes)]
    return Track.create({name: np.array([row[name] for row in rows]) for name in COLUMNS}, [f"line {i + 2}" for i in range(len(rows))])


def test_between_keyframes_everything_is_linear():
    pose = track({}, {"east": 8.0, "north": -4.0, "height": 34.0, "elevation": -0.3}).at(0.25)
    assert (pose.east, pose.north, pose.height, pose.attitude.elevation) == pytest.approx((2.0, -1.0, 31.0, -0.15))


@pytest.mark.parametrize(("first", "last", "middle"), [(350.0, 20.0, 5.0), (20.0, 350.0, 5.0), (-170.0, 170.0, 180.0), (10.0, 100.0, 55.0)])
@pytest.mark.parametrize("angle", ["azimuth", "roll"])
def test_angles_go_the_short_way_round(angle, first, last, middle):
    found = getattr(track({angle: np.radians(first)}, {angle: np.radians(last)}).at(0.5).attitude, angle)
    assert np.cos(found - np.radians(middle)) == pytest.approx(1.0)


def test_a_turning_head_goes_round_more_than_once():
    way = track(*({"azimuth": np.radians(90.0 * i % 360.0)} for i in range(9)))
    assert way.at(7.5).attitude.azimuth == pytest.approx(np.radians(90.0 * 7.5))
    assert way.turns


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        (({},), "1 keyframe; give two or more"),
        (({}, {"time": 0.0}), "line 3: time = 0 s is not after 0 s of line 2"),
        (({}, {}, {"time": 0.5}), "line 4: time = 0.5 s is not after 1 s of line 3"),
        (({}, {"east": np.nan}), "line 3: east = nan is not a finite number"),
        (({"roll": np.inf}, {}), "line 2: roll = inf is not a finite number"),
        (({}, {"north": 3000.0}), "line 2 to line 3: the platform jumps at 3000 m/s; allowed are 1000 m/s"),
        (({}, {"time": 0.1, "roll": np.radians(90.0)}), "line 2 to line 3: roll turns at 900 deg/s; allowed are 720 deg/s"),
        (({}, {"azimuth": np.pi}), "line 2 to line 3: azimuth turns by 180 deg, which can go either way"),
        (({}, {"height": 0.0}), "line 3: height = 0 m is not above the sea"),
        (({"elevation": -1.6}, {}), "line 2: elevation = -91.6732 deg is outside"),
    ],
)
def test_what_cannot_be_a_track_is_refused_by_its_lines(changes, words):
    with pytest.raises(DomainError) as error:
        track(*changes)
    assert words in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("time", [-0.1, 1.1])
def test_times_outside_are_refused(time):
    with pytest.raises(DomainError, match="which span 0 to 1 s"):
        track({}, {}).at(time)
