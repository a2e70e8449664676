"""Whether what is prepared for one attitude of a turning camera serves another."""

from dataclasses import replace

import numpy as np
import pytest

from seaglint.imaging.attitude_scene import AngleSurvey, corners_of, covers
from seaglint.imaging.camera.imager import Camera

GRID = Camera(30.0, 0.0, np.radians(-10.0), np.radians(8.0), np.radians(4.0), 80, 40)
MADE = AngleSurvey(GRID, np.radians(-40.0), (np.radians(-20.0), np.radians(30.0)))


def shrunk(of=GRID, by=0.9):
    return replace(of, width=by * of.width, height_angle=by * of.height_angle, columns=round(by * of.columns), rows=round(by * of.rows))


@pytest.mark.parametrize(
    ("grid", "served"),
    [
        (None, True),
        (GRID, True),
        (shrunk(), True),
        (shrunk(by=1.1), False),
        (replace(GRID, azimuth=np.radians(1.0)), False),
        (replace(shrunk(), azimuth=np.radians(0.3)), True),
        (replace(shrunk(), azimuth=np.radians(0.5)), False),
        (replace(shrunk(), azimuth=np.radians(-0.5)), False),
        (replace(shrunk(), elevation=np.radians(-10.3)), False),
        (replace(shrunk(), elevation=np.radians(-9.7)), False),
        (replace(GRID, rows=41), False),  # finer rows
        (replace(GRID, rows=39), True),
    ],
)
def test_a_grid_serves_what_lies_inside_and_is_no_finer(grid, served):
    assert covers(MADE, AngleSurvey(grid, 0.0, (0.0, 0.0))) is served


def test_without_a_grid_none_is_served():
    assert not covers(AngleSurvey(None, 0.0, (0.0, 0.0)), MADE)


@pytest.mark.parametrize(
    ("walked", "served"),
    [
        ((-40.0, -20.0, 30.0), True),
        ((-41.0, -20.0, 30.0), True),
        ((-39.0, -20.0, 30.0), False),  # from higher up
        ((-40.0, -21.0, 30.0), False),
        ((-40.0, -20.0, 31.0), False),
        ((-40.0, 345.0, 385.0), True),  # the same azimuths, a turn on
        ((-40.0, -375.0, -335.0), True),
        ((-40.0, 339.0, 385.0), False),
        ((-10.0, 50.0, 50.0), True),  # no pixels are walked
    ],
)
def test_walked_pixels_are_served_from_their_elevation_down_and_between_their_azimuths(walked, served):
    walk_from, first, last = np.radians(walked)
    assert bool(covers(MADE, AngleSurvey(None, walk_from, (first, last)))) is served


def test_all_azimuths_serve_any():
    around = AngleSurvey(None, 0.0, (0.0, 2.0 * np.pi))
    assert covers(around, AngleSurvey(None, 0.0, (3.0, 3.0 + 1.9 * np.pi)))


def test_corners_are_those_of_the_pixels_chosen():
    azimuth = np.add.outer(np.arange(5.0), 10.0 * np.arange(7.0))  # of the corners of 4 x 6 pixels
    chosen = np.zeros((4, 6), bool)
    chosen[1, 2] = chosen[2, 4] = True
    assert corners_of(azimuth, chosen) == (azimuth[1, 2], azimuth[3, 5])
