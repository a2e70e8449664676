"""Shadowing: printed values, areas by quadrature over slopes, limits and symmetries."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from shadowing_laws import bistatic, saunders

from seaglint.base.errors import DomainError
from seaglint.sea.shadowing.smith import projected_area, smith_lambda, smith_lambda_kernel, smith_nu, visible_area_kernel


@pytest.mark.parametrize(
    ("wind", "zenith", "expected"),
    [(5, 80, 0.97468), (5, 85, 0.82873), (5, 89, 0.29407), (10, 80, 0.92141), (10, 85, 0.71082), (10, 89, 0.21822)],
)
def test_saunders_values(wind, zenith, expected):
    """Values of an independent program for sigma_1^2 = 0.00316 W."""
    assert saunders(np.radians(zenith), 0.00316 * wind) == pytest.approx(expected, abs=6e-6)  # printed to five digits


@pytest.mark.parametrize("zenith_deg", [0.0, 40.0, 75.0, 88.0, 90.0, 91.0, 95.0])
@pytest.mark.parametrize("mss", [1e-4, 0.005, 0.03])
def test_projected_area_is_the_mean_over_slopes(zenith_deg, mss):
    theta = np.radians(zenith_deg)
    s = np.linspace(-10.0, 10.0, 200_001) * np.sqrt(mss)
    p = np.exp(-s * s / (2 * mss)) / np.sqrt(2 * np.pi * mss)
    area = np.trapezoid(p * np.maximum(0.0, np.cos(theta) - np.sin(theta) * s), s)
    assert projected_area(theta, mss) == pytest.approx(area, rel=1e-6, abs=1e-12)  # kink on the trapezoid grid


@pytest.mark.parametrize("zenith_deg", [5.0, 60.0, 85.0, 89.9])
def test_saunders_conserves_the_projected_area_of_the_mean_plane(zenith_deg):
    theta = np.radians(zenith_deg)
    assert saunders(theta, 0.03) * projected_area(theta, 0.03) == pytest.approx(np.cos(theta), rel=1e-10)


def test_area_at_the_horizon_is_zeisses():
    assert projected_area(np.pi / 2, 0.0316) == pytest.approx(np.sqrt(0.0316 / (2 * np.pi)), rel=1e-12)


def test_a_flat_sea_hides_nothing_above_the_horizon():
    angles = np.radians([0.0, 60.0, 89.99])
    assert np.all(saunders(angles, 0.0) == 1.0)
    assert projected_area(angles, 0.0) == pytest.approx(np.cos(angles))
    assert projected_area(np.radians(91.0), 0.0) == 0.0


@pytest.mark.parametrize("mss", [0.0, 0.03])
def test_nothing_is_seen_past_the_horizon(mss):
    assert saunders(np.radians(90.5), mss) == 0.0


def test_arrays_and_kernels_are_the_same_function():
    nu = np.array([[-1.0, 0.0, 0.01], [0.5, 3.0, 30.0]])
    expected = [[smith_lambda_kernel(float(x)) for x in row] for row in nu]
    assert np.array_equal(smith_lambda(nu), expected)


@given(st.floats(1e-3, 5.0))
def test_lambda_falls_from_infinity_to_zero(nu):
    low, high = smith_lambda([nu, nu * 1.01])
    assert low >= high >= 0.0


@given(st.floats(0.0, 50.0), st.floats(0.0, 50.0), st.floats(-10.0, 10.0))
def test_two_legs_are_symmetric_and_between_their_limits(view, sun, azimuth):
    both = float(bistatic(view, sun, azimuth))
    assert both == float(bistatic(sun, view, -azimuth))
    assert 1.0 / (1.0 + view + sun) * (1 - 1e-12) <= both <= 1.0 / (1.0 + max(view, sun))


def test_two_legs_limits():
    assert bistatic(0.7, 0.4, 0.0) == pytest.approx(1.0 / 1.7)
    assert bistatic(0.7, 0.4, np.pi) == pytest.approx(1.0 / 2.1)
    assert bistatic(0.7, 0.0, 1.0) == pytest.approx(1.0 / 1.7)
    assert bistatic(np.inf, 0.4, 1.0) == 0.0


def test_passage_between_the_limits_at_45_deg():
    """By hand from van Ginneken's 4.41 per radian.

    4.41 pi/4 = 3.46361, over 4.46361 is 0.775966; 4.41 pi = 13.85442, over 14.85442 is 0.932680; their ratio a = 0.831975.
    1/(1 + 0.7 + 0.4 a) = 1/2.032790 = 0.491935.
    """
    assert bistatic(0.7, 0.4, np.pi / 4) == pytest.approx(0.491935, abs=2e-6)  # six digits; 4.40 or 4.42 would be 3e-5 away


def test_deviation_of_zero_is_the_plane():
    assert visible_area_kernel(0.3, 0.0) == 0.3
    assert visible_area_kernel(-0.3, 0.0) == 0.0


def test_negative_variance_is_refused():
    with pytest.raises(DomainError, match="variance"):
        smith_nu(1.0, -0.1)
    with pytest.raises(DomainError, match="variance"):
        projected_area(1.0, -0.1)
