"""Signal to clutter of the same object at the edges of a picture and in its middle, over many random seas of even statistics."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter

from seaglint.objects.drawing.compose import BodyShare, BodySight
from seaglint.objects.drawing.truth import labels

ROWS, COLUMNS, SEAS = 60, 90, 300
SIDES = {
    "left": lambda step: (30, step),
    "right": lambda step: (30, COLUMNS - 1 - step),
    "top": lambda step: (step, 45),
    "bottom": lambda step: (ROWS - 1 - step, 45),
    "corner": lambda step: (step, COLUMNS - 1 - step),
}


def sight(row: int, column: int) -> BodySight:
    """A point of 5 W m-2 sr-1 in one pixel."""
    one = np.ones((1, 1))
    share = BodyShare(np.array([row]), np.array([column]), 0.0 * one, 5.0 * one, 0.0 * one, 1e-8 * one)
    return BodySight("it", 1000.0, 0.0, 0.0, shares=(share,), across=column + 0.5, down=row + 0.5)


def ratio(sea: np.ndarray, row: int, column: int, *, around: bool = False) -> float:
    return float(labels((sight(row, column),), sea, lambda radiance: 300.0, around=around)[0]["signal_to_clutter"][0])


def sea(rng: np.random.Generator, correlation: float) -> np.ndarray:
    """A sea whose values are correlated over some pixels, of one law everywhere."""
    wide = rng.normal(size=(ROWS + 40, COLUMNS + 40))
    return (gaussian_filter(wide, correlation) if correlation else wide)[20:-20, 20:-20]


@pytest.mark.parametrize("side", SIDES)
@pytest.mark.parametrize("correlation", [0.0, 1.0, 2.0])
@pytest.mark.parametrize("step", [0, 1, 2])
def test_the_edge_is_as_the_middle(side, correlation, step):
    """Means of the logarithm over 300 seas each, within 3.5 standard errors; half a frame of a correlated sea gave up to 10 % more."""
    rng = np.random.default_rng((step, int(correlation), list(SIDES).index(side)))
    logs = []
    for _ in range(SEAS):
        field = sea(rng, correlation)
        logs.append(np.log(ratio(field, *SIDES[side](step)) / ratio(field, 30, 45)))
    error = np.std(logs) / np.sqrt(SEAS)
    assert abs(np.mean(logs)) < 3.5 * error
    assert error < 0.016


@pytest.mark.parametrize(("row", "column"), [(0, 0), (0, 45), (30, 0), (ROWS - 1, COLUMNS - 1), (30, 45), (5, 3)])
def test_the_frame_has_as_many_pixels_anywhere(row, column):
    """Counted by seas that are 1 in a single row or column: those that make a deviation are in the frame."""
    sides = []
    for axis, size in enumerate((ROWS, COLUMNS)):
        stripes = [np.zeros((ROWS, COLUMNS)) for _ in range(size)]
        for k, field in enumerate(stripes):
            np.moveaxis(field, axis, 0)[k] = 1.0
        sides.append(sum(bool(np.isfinite(ratio(field, row, column))) for field in stripes))
    assert sides[0] == min(row, 10) + 1 + min(ROWS - 1 - row, 10)
    assert 0 <= sides[0] * sides[1] - 21 * 21 < sides[0]


def test_a_frame_over_the_seam_of_a_panorama_counts_on():
    """What is at the seam of one picture is in its middle when it is turned by half."""
    field = sea(np.random.default_rng(1), 1.0)
    turned = np.roll(field, COLUMNS // 2, axis=1)
    assert ratio(field, 30, 0, around=True) == pytest.approx(ratio(turned, 30, COLUMNS // 2, around=True), rel=1e-12)
