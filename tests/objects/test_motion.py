"""Ways through keyframes, attitudes the short way round, places from degrees."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from scipy.special import ellipeinc

from seaglint.base.errors import DomainError
from seaglint.objects.motion import FLATTENING, SEMI_MAJOR_AXIS, Keyframed, east_north, heading_of, rotation, tilt

TIME = np.array([0.0, 1.0, 2.5, 4.0, 7.0])
PLACE = np.array([[0, 0, 10], [5, 8, 12], [20, 9, 11], [22, -3, 9], [30, -20, 10.0]])
NAMES = [f"keyframes[{i}]" for i in range(5)]


def way(path="spline", follows=True, angles=None, time=TIME):
    return Keyframed.create(time, PLACE, np.zeros((5, 3)) if angles is None else angles, NAMES, follows=follows, path=path)


@pytest.mark.parametrize("path", ["spline", "straight"])
def test_keyframes_are_met_exactly(path):
    found = way(path)
    np.testing.assert_allclose([found.at(t).position for t in TIME], PLACE, atol=1e-12)
    middle = 0.5 * (PLACE[1] + PLACE[2])
    assert np.allclose(found.at(1.75).position, middle, atol=1e-9) == (path == "straight")


def test_velocity_and_acceleration_of_a_spline_are_continuous():
    found = way()
    for t in TIME[1:-1]:
        before, behind = (np.array([found.velocity(t + s * h) for h in (1e-4, 2e-4)]) for s in (-1, 1))
        np.testing.assert_allclose(before[0], behind[0], atol=1e-2)
        np.testing.assert_allclose((before[0] - before[1]) / 1e-4, (behind[1] - behind[0]) / 1e-4, atol=1e-1)
        kink = np.diff([way("straight").velocity(t - 1e-4), way("straight").velocity(t + 1e-4)], axis=0)
        assert np.abs(kink).max() > 1.0
    for t in (0.3, 3.1, 6.0):
        slope = (found.at(t + 1e-5).position - found.at(t - 1e-5).position) / 2e-5
        np.testing.assert_allclose(found.velocity(t), slope, rtol=1e-6, atol=1e-6)


def test_the_bow_points_along_the_way_unless_told():
    found = way()
    east, north, _ = found.velocity(3.0)
    assert heading_of(found.at(3.0).rotation) == pytest.approx(np.arctan2(east, north))
    fixed = way(follows=False, angles=np.tile([0.7, 0.0, 0.1], (5, 1)))
    np.testing.assert_allclose(fixed.at(3.0).rotation, rotation(0.7, 0.0, 0.1), atol=1e-12)


def test_attitudes_turn_the_short_way():
    angles = np.zeros((5, 3))
    angles[:, 0] = np.radians([350, 10, 10, 10, 10])
    found = way(follows=False, angles=angles)
    assert np.degrees(heading_of(found.at(0.5).rotation)) == pytest.approx(0.0, abs=1e-9)
    angles[1] = (0.3, 0.5, -0.4)
    found = way(follows=False, angles=angles)
    half = Rotation.from_matrix(rotation(*angles[0]).T @ found.at(0.5).rotation).magnitude()
    whole = Rotation.from_matrix(rotation(*angles[0]).T @ rotation(*angles[1])).magnitude()
    assert half == pytest.approx(0.5 * whole)


def test_bad_keyframes_are_refused():
    with pytest.raises(DomainError, match=r"keyframes\[2\]: time = 1 s is not after 1 s of keyframes\[1\]"):
        way(time=np.array([0.0, 1.0, 1.0, 4.0, 7.0]))
    with pytest.raises(DomainError, match="jumps at"):
        way(time=TIME * 1e-4)
    angles = np.zeros((5, 3))
    angles[1:, 0] = np.pi
    with pytest.raises(DomainError, match="either way"):
        way(follows=False, angles=angles)
    angles[1:, 0] = 3.0
    with pytest.raises(DomainError, match="attitude jumps"):
        way(follows=False, angles=angles, time=TIME * 0.2)
    with pytest.raises(DomainError, match="span 0 to 7 s"):
        way().at(7.1)


def test_tilt_lays_the_deck_on_the_plane():
    turn = tilt(0.8, 0.2, -0.1)
    starboard, forward, up = (turn @ rotation(0.8)).T
    assert starboard @ forward == pytest.approx(0.0, abs=1e-12)
    assert heading_of(turn @ rotation(0.8)) == pytest.approx(0.8)
    assert forward[2] / np.hypot(forward[0], forward[1]) == pytest.approx(-0.1)
    assert np.linalg.det(turn) == pytest.approx(1.0)
    level = rotation(0.8)
    assert -(up @ level[:, 0]) / up[2] == pytest.approx(0.2)


def meridian(latitude):
    """Length of the meridian from the equator: an elliptic integral of the reduced latitude."""
    b = SEMI_MAJOR_AXIS * (1.0 - FLATTENING)
    reduced = np.arctan((1.0 - FLATTENING) * np.tan(latitude))
    m = 1.0 - (SEMI_MAJOR_AXIS / b) ** 2
    return b * ellipeinc(reduced, m)


def test_degrees_become_metres_of_the_geodesic():
    start = np.radians([36.8, -75.9])
    east, north = east_north(np.radians(37.3), start[1], tuple(start))
    assert abs(east) < 1e-6
    assert north == pytest.approx(meridian(np.radians(37.3)) - meridian(start[0]), abs=1e-3)
    east, north = east_north(0.0, np.radians(-179.5), (0.0, np.radians(180.0)))
    assert east == pytest.approx(SEMI_MAJOR_AXIS * np.radians(0.5), abs=1e-3)
    assert abs(north) < 1e-6
    # along a parallel, near by: its radius times the difference of longitude
    near = SEMI_MAJOR_AXIS * np.cos(start[0]) / np.sqrt(1.0 - FLATTENING * (2.0 - FLATTENING) * np.sin(start[0]) ** 2)
    assert east_north(start[0], start[1] + 1e-4, tuple(start))[0] == pytest.approx(near * 1e-4, rel=1e-7)
    assert east_north(*start, tuple(start)) == (0.0, 0.0)


@pytest.mark.parametrize("degrees", [(-37.95103341666667, 144.42486788888888, -37.65282113888889, 143.92649552777778)])
def test_the_survey_line_of_the_series_own_example(degrees):
    """Flinders Peak to Buninyong, 54972.271 m at 306 deg 52' 05.37'' (Geoscience Australia's test line, GRS 80)."""
    start, end = np.radians(degrees[:2]), np.radians(degrees[2:])
    east, north = east_north(end[0], end[1], tuple(start))
    assert np.hypot(east, north) == pytest.approx(54972.271, abs=1e-3)
    assert np.degrees(np.arctan2(east, north)) % 360.0 == pytest.approx(306.0 + 52.0 / 60.0 + 5.37 / 3600.0, abs=1e-5)


@pytest.mark.parametrize("end", [(60.0, 40.0), (-50.0, 30.0), (5.0, 140.0), (80.0, -100.0)])
def test_long_geodesics_end_where_they_lead(end):
    """The equations of a geodesic on the ellipsoid integrated over the length and first azimuth found, some thousand kilometres."""
    from scipy.integrate import solve_ivp

    square = FLATTENING * (2.0 - FLATTENING)
    start, wanted = np.radians([20.0, -10.0]), np.radians(end)
    east, north = east_north(wanted[0], wanted[1], tuple(start))

    def along(_, state):
        latitude, _, azimuth = state
        w = np.sqrt(1.0 - square * np.sin(latitude) ** 2)
        across, meridional = SEMI_MAJOR_AXIS / w, SEMI_MAJOR_AXIS * (1.0 - square) / w**3
        turn = np.sin(azimuth) / across
        return np.cos(azimuth) / meridional, turn / np.cos(latitude), turn * np.tan(latitude)

    length = np.hypot(east, north)
    found = solve_ivp(along, (0.0, length), [*start, np.arctan2(east, north)], "DOP853", rtol=1e-12, atol=1e-13).y[:2, -1]
    miss = SEMI_MAJOR_AXIS * np.array([found[0] - wanted[0], (found[1] - wanted[1]) * np.cos(wanted[0])])
    assert np.abs(miss).max() < 2e-3  # Vincenty: within 0.5 mm
