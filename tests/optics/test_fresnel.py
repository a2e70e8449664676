import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from seaglint.base.errors import DomainError
from seaglint.optics import sea_water
from seaglint.optics.fresnel import ReflectanceSeries, reflectance


@given(st.floats(0.0, 1.0), st.floats(1.01, 3.0), st.floats(0.0, 2.0))
def test_reflectance_is_a_share(c, n, k):
    assert 0.0 <= reflectance(c, n + 1j * k) <= 1.0 + 1e-15


@pytest.mark.parametrize("index", [1.33, 1.371 + 0.272j, 1.4 + 0.0046j])
def test_normal_and_grazing_limits(index):
    assert reflectance(1.0, index) == pytest.approx(abs((index - 1) / (index + 1)) ** 2, rel=1e-14)
    assert reflectance(0.0, index) == 1.0
    # Slope at grazing: 1 - rho = 2 c Re[(1 + 1/m^2) ... ] is finite, so the approach is linear in the cosine.
    assert 1.0 - reflectance(1e-9, index) == pytest.approx(1e3 * (1.0 - reflectance(1e-12, index)), rel=1e-3)


def test_at_brewsters_angle_only_s_light_comes_back():
    n = 1.33
    c = 1.0 / np.sqrt(1.0 + n**2)  # tan = n: reflected and refracted ray at right angles
    assert reflectance(c, n) == pytest.approx(0.5 * ((1.0 - n**2) / (1.0 + n**2)) ** 2, rel=1e-12)


def test_agrees_with_snells_angles_for_a_clear_medium():
    n, i = 1.33, np.radians(np.linspace(1.0, 89.0, 45))
    t = np.arcsin(np.sin(i) / n)
    rho = 0.5 * (np.sin(i - t) ** 2 / np.sin(i + t) ** 2 + np.tan(i - t) ** 2 / np.tan(i + t) ** 2)
    np.testing.assert_allclose(reflectance(np.cos(i), n), rho, rtol=1e-9)  # tan(i + t) passes through infinity


@pytest.mark.parametrize("c", [-0.1, 1.1])
def test_cosines_outside_are_refused(c):
    with pytest.raises(DomainError, match=r"0\.\.1"):
        reflectance(c, 1.33)


@pytest.mark.parametrize("model", [sea_water.hale_querry_sea, sea_water.segelstein])
def test_series_is_the_formula(model):
    index = model().index(np.linspace(720.0, 4900.0, 300))
    c = np.linspace(0.0, 1.0, 501)
    np.testing.assert_allclose(ReflectanceSeries.of(index)(c), reflectance(c[:, None], index), atol=2e-8, rtol=0)  # stated bound
