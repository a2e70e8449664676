"""Textures on the sea: footprints average, the variance is brought back, means and horizons stay."""

from __future__ import annotations

import numpy as np
import pytest

from seaglint.base.conventions import horizon_depression, horizon_range
from seaglint.base.errors import DomainError
from seaglint.studies.texture.perspective import Footprints, PeriodicField, fluctuation

HEIGHT = 30.0


def footprints() -> Footprints:
    elevations = np.radians(0.5 - 0.2 * np.arange(20))
    return Footprints.of(HEIGHT, elevations, np.radians(0.2), 16, np.radians(0.2))


def test_rows_meet_and_the_horizon_ends_them() -> None:
    feet = footprints()
    rows = np.flatnonzero(feet.sea)
    assert feet.far[rows[0]] == pytest.approx(horizon_range(HEIGHT))
    assert feet.near[rows[:-1]] == pytest.approx(feet.far[rows[1:]])
    assert not feet.sea[np.radians(0.5 - 0.2 * np.arange(20) - 0.1) > -horizon_depression(HEIGHT)].any()


def test_footprints_average_whole_and_parts_of_cells() -> None:
    """White noise, a row 3 cells long whose columns are 1.5 cells wide: the mean by hand, and the deviation of such means."""
    noise = np.random.default_rng(1).standard_normal((4, 240, 240)).astype(np.float32)
    feet = Footprints(np.array([3.0, 0.0]), np.array([6.0, 3.0]), np.array([0.0, 1.0, 2.0]))
    plane = PeriodicField(noise, (1.0, 1.0), feet)
    strip = noise[1, 237:240].astype(float).mean(axis=0)  # ranges 0 to 3, nearest at the bottom; their middle is 1.5
    by_hand = np.array([strip[0] + 0.5 * strip[1], 0.5 * strip[1] + strip[2]]) / 1.5
    assert plane.frame(1)[1] * plane.spread[1] == pytest.approx(by_hand, abs=1e-5)
    assert plane.spread[1] == pytest.approx(np.sqrt((1.0 + 0.5**2) / 1.5**2 / 3.0), rel=0.06)
    assert plane.frame(1) == pytest.approx(plane.frame(5))  # of a loop of 4


def test_variance_is_1_in_every_row_and_the_far_sea_is_smoother() -> None:
    field = np.random.default_rng(2).standard_normal((8, 256, 256)).astype(np.float32)
    feet = footprints()
    plane = PeriodicField(field, (0.5 * feet.finest()[0], 0.5 * feet.finest()[1]), feet)
    seen = np.stack([plane.frame(k) for k in range(8)])
    assert (seen[:, ~feet.sea] == 0.0).all()
    assert seen[:, feet.sea].std() == pytest.approx(1.0, abs=0.1)
    averaging = plane.averaging[feet.sea]
    assert (np.diff(averaging[2:]) > 0.0).mean() > 0.8
    assert averaging[-1] > 5.0 * averaging[1]


@pytest.mark.parametrize("tails", ["gamma", "lognormal", "gaussian"])
def test_pixels_have_the_mean_and_deviation_asked_for(tails: str) -> None:
    g = np.random.default_rng(3).standard_normal((100_000, 1))
    seen = fluctuation(g, np.full_like(g, 2.0), np.full_like(g, 3.0 if tails != "lognormal" else 1.0), tails)  # type: ignore[arg-type]
    assert seen.mean() == pytest.approx(2.0, rel=0.02)
    assert seen.std() == pytest.approx(3.0 if tails != "lognormal" else 1.0, rel=0.02)
    assert tails == "gaussian" or seen.min() >= 0.0


def test_still_pixels_keep_their_mean() -> None:
    still = fluctuation(np.ones((2, 2)), np.array([[1.0, 0.0], [2.0, 3.0]]), np.zeros((2, 2)), "gamma")
    assert still.tolist() == [[1.0, 0.0], [2.0, 3.0]]


def test_a_picture_of_the_sky_has_no_place() -> None:
    feet = Footprints.of(HEIGHT, np.radians([2.0, 1.0]), np.radians(1.0), 4, 0.01)
    with pytest.raises(DomainError, match="shows no sea"):
        feet.finest()
