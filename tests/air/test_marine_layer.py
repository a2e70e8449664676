"""Lowest air over a sea of another temperature: the bulk law, its limits, and what joins above."""

import math

import numpy as np
import pytest

from seaglint.air.profile.absorber_densities import refractivity
from seaglint.air.profile.aerosols import HazeWeather
from seaglint.air.profile.air_profile import model_profile
from seaglint.air.profile.air_sums import AirSums
from seaglint.air.profile.marine_layer import (
    ADIABATIC,
    JOINED_AT,
    similar_profiles,
    stability_of_heat,
    stability_of_momentum,
    with_marine_layer,
)
from seaglint.air.protocol import wavenumber_grid

SEA = 288.15


@pytest.mark.parametrize("difference", [-20.0, -8.0, -1.0, 0.0, 0.5, 4.0, 20.0])
@pytest.mark.parametrize("wind", [0.0, 2.0, 7.0, 20.0])
def test_the_air_at_ten_metres_is_what_was_asked_for(difference, wind):
    for model in ("tropical", "subarctic-winter"):
        base = model_profile(model)
        air = with_marine_layer(base, wind, SEA, difference)
        at = np.interp([0.0, 10.0, 600.0, 5000.0], air.height, air.temperature)
        assert at[0] == pytest.approx(SEA)
        assert at[1] - SEA == pytest.approx(difference, abs=1e-3)
        np.testing.assert_allclose(
            np.interp([JOINED_AT, 3000.0], air.height, air.temperature), np.interp([JOINED_AT, 3000.0], base.height, base.temperature)
        )
        assert np.all(air.relative_humidity <= 100.0 + 1e-9)
        assert np.all(np.diff(air.height) > 0.0)
        assert np.all(np.diff(air.pressure) < 0.0)
        assert np.all(np.isfinite(air.vapour))


def test_stability_functions_are_the_integrals_of_gradients():
    """``phi = 1 - zeta psi'``: 1 in neutral air, below 1 in unstable, above in stable, near it 5 zeta (momentum, stable)."""
    for psi in (stability_of_heat, stability_of_momentum):
        for zeta, low, high in ((-2.0, 0.1, 0.6), (-0.1, 0.5, 0.99), (0.05, 1.1, 1.5), (1.0, 4.0, 8.0)):
            step = 1e-5 * abs(zeta)
            gradient = 1.0 - zeta * (psi(zeta + step) - psi(zeta - step)) / (2.0 * step)
            assert low < gradient < high, (psi, zeta, gradient)
        assert psi(1e-9) == pytest.approx(psi(-1e-9), abs=1e-7)


def test_fluxes_are_the_published_ones():
    """COARE 3.0 (Fairall et al. 2003): neutral drag from 1.0e-3 at 5 m/s to 2e-3 at 18 m/s, transfer of heat near 1.15e-3."""
    for wind, drag in ((5.0, 1.0e-3), (10.0, 1.25e-3), (18.0, 2.1e-3)):
        scales = similar_profiles(wind, SEA, -ADIABATIC * 10.0, 98.0, 1013.0)
        assert (scales.friction_velocity / wind) ** 2 == pytest.approx(drag, rel=0.15)
        warm = similar_profiles(wind, SEA, -2.0, 80.0, 1013.0)
        exchange = -warm.friction_velocity * warm.temperature_scale / (wind * (2.0 - ADIABATIC * 10.0))
        assert exchange == pytest.approx(1.15e-3, rel=0.15)


def test_nearly_neutral_profiles_are_logarithmic():
    scales = similar_profiles(10.0, SEA, -0.12, 97.0, 1013.0)
    air = with_marine_layer(model_profile("us-standard-1976"), 10.0, SEA, -0.12)
    kelvin = np.interp([0.1, 1.0, 10.0], air.height, air.temperature) + ADIABATIC * np.array([0.1, 1.0, 10.0])
    slope = scales.temperature_scale / 0.4 * math.log(10.0)
    np.testing.assert_allclose(np.diff(kelvin), slope, atol=0.01)


def test_a_warm_sea_bends_rays_up_and_a_cold_one_down():
    base = model_profile("midlatitude-summer")
    gradients = []
    for difference in (-6.0, 0.0, 6.0):
        air = with_marine_layer(base, 5.0, SEA, difference)
        n = refractivity(air, 2500.0)
        gradients.append(float(np.interp(5.0, air.height, n) - np.interp(0.3, air.height, n)) / 4.7)
    assert gradients[0] > gradients[1] > gradients[2]
    assert gradients[0] > 0.0
    assert gradients[2] < -157e-9 / 3.0


def test_the_sky_at_the_horizon_follows_the_lowest_air():
    nu = wavenumber_grid(8.0, 12.0)
    haze = HazeWeather(wind=5.0, wind_24h=5.0)
    light = [
        AirSums(with_marine_layer(model_profile("midlatitude-summer"), 5.0, SEA, difference), haze, nu)
        .along(10.0, 0.5 * np.pi)
        .emitted.sum()
        for difference in (-4.0, 0.0, 4.0)
    ]
    assert light[0] < light[1] < light[2]


def test_the_haze_keeps_the_humidity_of_ten_metres():
    base = model_profile("midlatitude-summer")
    air = with_marine_layer(base, 5.0, SEA, -2.0)
    assert air.haze_humidity == pytest.approx(float(np.interp(10.0, base.height, base.relative_humidity)))
    assert air.relative_humidity[0] > 95.0


@pytest.mark.parametrize("difference", [-8.0, -1.0, 0.0, 4.0])
@pytest.mark.parametrize("model", ["midlatitude-summer", "subarctic-winter"])
def test_the_humidity_at_ten_metres_is_that_of_the_profile(model, difference):
    """The vapour there makes it at the new temperature; at the sea it is that of salt water, 98 % of saturation (Fairall et al. 2003)."""
    base = model_profile(model)
    asked = float(np.interp(10.0, base.height, base.relative_humidity))
    air = with_marine_layer(base, 6.0, SEA, difference)
    at = list(air.height).index(10.0)
    assert air.relative_humidity[at] == pytest.approx(asked, abs=0.5)
    assert air.relative_humidity[0] == pytest.approx(98.0, abs=0.1)
