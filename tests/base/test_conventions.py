"""Geometry of a line of sight over a round sea, against a ray walked through space and against published values."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from seaglint.base import conventions as c
from seaglint.base.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.base.errors import DomainError, SeaglintError

heights = st.floats(0.5, 1e4)
angles = st.floats(-20.0, 20.0)


def walked_ray(height: float, depression: float) -> tuple[float, float]:
    """Arc and view zenith [m, rad] where a straight ray meets the sphere, by bisection on its height above it; no formula shared."""
    radius, slope = EFFECTIVE_EARTH_RADIUS, (math.cos(depression), -math.sin(depression))

    def altitude(t: float) -> float:
        x, z = t * slope[0], height + t * slope[1]
        # (r^2 - R^2)/(r + R) keeps millimetres where r - R would not.
        return (x * x + z * z + 2.0 * radius * z) / (math.hypot(x, radius + z) + radius)

    low, high = 0.0, radius * math.sin(depression)  # the lowest point of the chord lies near its middle
    for _ in range(200):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if altitude(middle) > 0.0 else (low, middle)
    x, z = low * slope[0], radius + height + low * slope[1]
    to_sensor = np.array([-slope[0], -slope[1]])
    return radius * math.atan2(x, z), math.acos(float(np.dot(to_sensor, [x, z])) / math.hypot(x, z))


@pytest.mark.parametrize(("height", "depression_deg"), [(2.0, 0.06), (30.0, 0.2), (30.0, 3.5), (100.0, 0.4), (3000.0, 2.0), (3000.0, 70.0)])
def test_line_of_sight_meets_the_sea_where_a_walked_ray_does(height: float, depression_deg: float) -> None:
    d = math.radians(depression_deg)
    arc, zenith = walked_ray(height, d)
    assert float(c.surface_range(height, d)) == pytest.approx(arc, rel=1e-9)  # bisection ends at 1e-13 of the path
    assert float(c.view_zenith(height, d)) == pytest.approx(zenith, abs=1e-7)  # arccos near its ends


def test_published_numbers_of_a_sensor_at_100_m() -> None:
    """Horizon 38.6 km with refraction (35.7 km without); at 0.4 deg depression the sea is seen 0.13 deg nearer to grazing."""
    assert c.horizon_range(100.0) == pytest.approx(38_560.0, abs=50.0)  # printed to 0.1 km
    assert 90.0 - 0.4 - math.degrees(float(c.view_zenith(100.0, math.radians(0.4)))) == pytest.approx(-0.13, abs=0.005)


@given(height=heights, fraction=st.floats(0.0, 0.999))
def test_range_and_depression_undo_each_other(height: float, fraction: float) -> None:
    arc = fraction * c.horizon_range(height)
    back = float(c.surface_range(height, c.depression_of_range(height, arc)))
    # The depression hardly changes with range near the horizon: its last bit there is metres.
    assert back == pytest.approx(arc, rel=1e-5, abs=1e-6)


@given(height=heights, fraction=st.floats(0.0, 0.999))
def test_view_zenith_by_range_and_by_depression_agree(height: float, fraction: float) -> None:
    arc = fraction * c.horizon_range(height)
    by_range = float(c.view_zenith_of_range(height, arc))
    assert float(c.view_zenith(height, c.depression_of_range(height, arc))) == pytest.approx(by_range, abs=1e-6)


@given(height=heights)
def test_the_horizon_is_where_the_sea_ends(height: float) -> None:
    edge = c.horizon_depression(height)
    assert np.isfinite(c.surface_range(height, edge * (1.0 + 1e-6)))
    assert np.isnan(c.surface_range(height, edge * (1.0 - 1e-6)))
    assert np.isnan(c.surface_range(height, -0.1))
    assert float(c.view_zenith_of_range(height, c.horizon_range(height))) == pytest.approx(0.5 * math.pi, abs=1e-9)


def test_straight_down_is_the_sensor_foot() -> None:
    assert float(c.surface_range(50.0, 0.5 * math.pi)) == pytest.approx(0.0, abs=1e-8)
    assert float(c.view_zenith(50.0, 0.5 * math.pi)) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize(("degrees", "east", "north"), [(0, 0, 1), (90, 1, 0), (180, 0, -1), (270, -1, 0)])
def test_azimuth_is_clockwise_from_north(degrees: float, east: float, north: float) -> None:
    assert np.array(c.unit_vector(math.radians(degrees))) == pytest.approx(np.array([east, north]), abs=1e-15)


@given(from_azimuth=angles)
def test_what_comes_from_one_side_travels_to_the_other(from_azimuth: float) -> None:
    to = c.travel_azimuth(from_azimuth)
    assert 0.0 <= to <= 2.0 * math.pi
    assert np.array(c.unit_vector(to)) == pytest.approx(-np.array(c.unit_vector(from_azimuth)), abs=1e-12)


@given(angle=angles)
def test_wrapped_angle_is_the_same_direction(angle: float) -> None:
    wrapped = float(c.wrap_angle(angle))
    assert -math.pi <= wrapped <= math.pi
    assert np.array(c.unit_vector(wrapped)) == pytest.approx(np.array(c.unit_vector(angle)), abs=1e-12)


@pytest.mark.parametrize("height", [0.0, -3.0, math.nan, math.inf])
def test_sensor_that_is_not_above_the_sea_is_refused(height: float) -> None:
    with pytest.raises(DomainError, match="give a height > 0 m"):
        c.horizon_range(height)


def test_every_error_of_a_caller_has_one_parent() -> None:
    assert issubclass(DomainError, SeaglintError)
    assert issubclass(DomainError, ValueError)
