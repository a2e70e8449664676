"""Coordinates of the tables: lengths of paths, heights, elevations, encoded depths."""

import numpy as np
import pytest

from seaglint.air.coordinates import (
    decode_optical_depth,
    dip_coordinate,
    elevation_coordinate,
    elevation_of_coordinate,
    encode_optical_depth,
    height_coordinate,
    sky_height_coordinate,
    straight_sea_cosine,
    straight_slant,
)


@pytest.mark.parametrize("height", [2.0, 50.0, 3000.0])
def test_straight_paths_invert(height):
    cosine = np.array([0.0, 1e-3, 0.02, 0.5, 1.0])
    slant = straight_slant(height, cosine)
    np.testing.assert_allclose(straight_sea_cosine(height, slant), cosine, atol=1e-7)
    assert slant[-1] == pytest.approx(height, rel=1e-9)


@pytest.mark.parametrize("dip", [0.0, 0.03])
def test_elevation_coordinate_inverts_and_ends_at_0_and_1(dip):
    y = np.linspace(0.0, 1.0, 9)
    np.testing.assert_allclose(elevation_coordinate(elevation_of_coordinate(y, dip), dip), y, atol=1e-12)
    assert elevation_of_coordinate(1.0, dip) == pytest.approx(0.5 * np.pi)


def test_dip_coordinate_runs_from_the_horizontal_to_the_sea_horizon():
    np.testing.assert_allclose(dip_coordinate([-0.01, 0.0, 0.005, 0.02], 0.02), [0.0, 0.0, 0.5, 1.0])


@pytest.mark.parametrize("coordinate", [height_coordinate, sky_height_coordinate])
def test_heights_keep_their_order_and_levels_are_whole_numbers(coordinate):
    levels = (1000.0, 2000.0, 3000.0, 4000.0)
    stretched = coordinate(np.linspace(2.0, 4000.0, 2000), levels)
    assert np.all(np.diff(stretched) > 0.0)
    np.testing.assert_allclose(np.diff(coordinate(levels, levels)), 1.0)
    assert sky_height_coordinate(0.0, levels) == 0.0


def test_optical_depth_encoding_inverts():
    depth = np.array([0.0, 1e-5, 1e-3, 0.1, 1.0, 5.0, 20.0, 50.0])
    np.testing.assert_allclose(decode_optical_depth(encode_optical_depth(depth)), depth, rtol=1e-9, atol=1e-15)
