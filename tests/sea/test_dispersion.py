"""Gravity-capillary dispersion: its minimum, its inverse, its derivative."""

import numpy as np
import pytest

from seaglint.base.errors import DomainError
from seaglint.sea.dispersion import angular_frequency, group_velocity, wavenumber


def test_slowest_wave():
    k = np.geomspace(10.0, 3000.0, 200_001)
    speed = angular_frequency(k) / k
    slowest = np.argmin(speed)
    assert 2 * np.pi / k[slowest] == pytest.approx(0.0170, abs=5e-5)  # 1.70 cm
    assert speed[slowest] == pytest.approx(0.231, abs=5e-4)
    assert group_velocity(k[slowest]) == pytest.approx(speed[slowest], rel=1e-4)  # they meet where the phase speed is least


@pytest.mark.parametrize("k", [1e-6, 1e-2, 1.0, 370.0, 1e5])
def test_inverse(k):
    assert wavenumber(angular_frequency(k)) == pytest.approx(k, rel=1e-12)


@pytest.mark.parametrize("k", [0.05, 5.0, 400.0, 4000.0])
def test_group_velocity_is_the_derivative(k):
    step = 1e-5 * k
    slope = (angular_frequency(k + step) - angular_frequency(k - step)) / (2 * step)
    assert group_velocity(k) == pytest.approx(slope, rel=1e-8)


def test_long_and_short_limits():
    assert angular_frequency(0.1) == pytest.approx(np.sqrt(0.981), rel=1e-6)
    assert angular_frequency(1e5) == pytest.approx(np.sqrt(0.074 / 1025.0 * 1e15), rel=1e-4)
    assert angular_frequency(0.0) == 0.0
    assert wavenumber(0.0) == 0.0


@pytest.mark.parametrize("function", [angular_frequency, wavenumber])
def test_negative_arguments_are_refused(function):
    with pytest.raises(DomainError, match="below 0"):
        function(-1.0)
