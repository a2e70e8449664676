"""Lines over the round Earth, absorber amounts on them, and the law that turns amounts into optical depth."""

import numpy as np
import pytest

from seaglint.air.line import heights_along, level_shares, lowest_height
from seaglint.air.protocol import slant_range
from seaglint.air.table.absorbers import Absorbers, BandLaw, LayerPieces
from seaglint.air.table.profiles import PROFILES
from seaglint.base.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.files.lowtran.deck import MODELS
from seaglint.optics.blackbody import planck_wavenumber

ENDS = [(30.0, 2.0, 20e3), (2.0, 4000.0, 60e3), (800.0, 800.0, 100e3), (50.0, 50.0, 10.0), (3000.0, 10.0, 0.0)]


@pytest.mark.parametrize(("start", "end", "arc"), ENDS)
def test_heights_along_the_line_are_those_of_points_in_the_plane(start, end, arc):
    angle, share = arc / EFFECTIVE_EARTH_RADIUS, np.linspace(0.0, 1.0, 41)
    a = np.array([0.0, EFFECTIVE_EARTH_RADIUS + start])
    b = (EFFECTIVE_EARTH_RADIUS + end) * np.array([np.sin(angle), np.cos(angle)])
    expected = np.hypot(*(a[:, None] + (b - a)[:, None] * share)) - EFFECTIVE_EARTH_RADIUS
    slant = slant_range(start, arc, end)
    np.testing.assert_allclose(heights_along(start, end, slant, share), expected, atol=1e-5)  # digits of the other route
    assert slant == pytest.approx(np.hypot(*(b - a)), rel=1e-9, abs=1e-6)
    assert lowest_height(start, end, slant) <= expected.min() + 1e-5
    assert lowest_height(start, end, slant) == pytest.approx(expected.min(), abs=0.02 * (expected.max() - expected.min()) + 1e-5)


def test_a_line_crosses_its_levels_where_it_is_as_high():
    start, end, arc = (np.array(v) for v in zip(*ENDS[1:3], (30.0, 2500.0, 500.0), strict=True))
    slant, levels = slant_range(start, arc, end), np.array([700.0, 1000.0, 2000.0])
    shares = level_shares(start, end, slant, levels)
    assert shares.shape == (3, 8)
    assert np.all(np.diff(shares, axis=1) >= 0.0)
    height = heights_along(start[:, None], end[:, None], slant[:, None], shares)
    inside = (shares > 0.0) & (shares < 1.0)
    assert inside.sum(axis=1).tolist() == [3, 2, 3]  # from 800 m to 800 m the line dips below 700 m and comes back
    assert np.abs(height[inside][:, None] - levels).min(axis=1).max() < 1e-4


def test_profiles_are_those_of_the_models_and_hydrostatic():
    assert set(PROFILES) == set(MODELS)
    for profile in PROFILES.values():
        pressure, kelvin = np.array(profile.pressure_hpa), np.array(profile.temperature_k)
        assert len(pressure) == len(kelvin) == len(profile.water_ppmv) == len(profile.ozone_ppmv) == 11
        mean = 0.5 * (kelvin[1:] + kelvin[:-1])
        np.testing.assert_allclose(
            np.log(pressure[:-1] / pressure[1:]), 9.81 * 1000.0 / (287.05 * mean), rtol=0.02
        )  # gravity falls, and three digits


def absorbers() -> Absorbers:
    """One absorber that falls by e in 2 km and one that is the same everywhere, in air whose temperature falls by 6 K a km."""
    z = np.arange(11.0)
    return Absorbers(np.array([np.exp(-z / 2.0), np.ones(11)]), np.array([0.5, 1.0]), np.exp(-z / 8.0), 290.0 - 6.0 * z)


def test_amounts_are_the_integrals_of_the_densities():
    start, end, slant = np.array([2500.0, 400.0]), np.array([300.0, 400.0]), np.array([2200.0, 900.0])
    pieces = absorbers().along(start, end, slant)
    np.testing.assert_allclose(pieces.whole[0], [2.0 * (np.exp(-0.15) - np.exp(-1.25)), 2.2], rtol=1e-6)
    np.testing.assert_allclose(pieces.whole[1], [0.9 * np.exp(-0.2), 0.9], rtol=1e-4)  # the chord sags by 7 mm
    kelvin = pieces.temperature[0][np.diff(pieces.amount[0, :, 1], prepend=0.0) > 0.0]
    np.testing.assert_allclose(kelvin, [290.0 - 6.0 * z for z in (2.25, 1.5, 0.65)], atol=0.08)  # the lower part is denser


def test_no_air_is_counted_above_ten_kilometres_and_the_seas_below_it():
    found = absorbers().along(np.array([12e3, -20.0]), np.array([8e3, -20.0]), np.array([4e3, 50.0]))
    np.testing.assert_allclose(found.whole[:, 1], [2.0, 0.05], rtol=1e-9)
    np.testing.assert_allclose(found.whole[1, 0], 0.05, rtol=1e-9)


def test_the_law_finds_the_coefficients_it_was_made_with():
    nu, truth = np.array([2000.0, 2100.0, 2200.0]), np.array([[0.7, 0.0, 1.5], [0.02, 0.3, 0.0]])
    amount = np.abs(np.random.default_rng(3).normal(size=(30, 2))) + 0.05
    air = absorbers()
    law = BandLaw.fit(air, nu, amount, amount**air.growth @ truth)
    np.testing.assert_allclose(law.coefficient, truth, atol=1e-9)
    np.testing.assert_allclose(law.optical_depth(np.array([4.0, 2.0])), 2.0 * truth[0] + 2.0 * truth[1], rtol=1e-9)


def test_air_of_one_temperature_shines_like_a_blackbody_and_thick_air_like_its_near_end():
    nu, air = np.array([2000.0, 2500.0]), absorbers()
    law = BandLaw(air, np.array([[0.3, 1.0], [0.0, 0.1]]), nu)
    amount = np.array([[[0.1, 0.2], [0.4, 0.5], [0.4, 0.5]]])
    one = np.ones((1, 2))
    even = LayerPieces(amount, np.full((1, 3), 280.0))
    np.testing.assert_allclose(law.emission(even, one)[0], planck_wavenumber(nu, 280.0), rtol=1e-12)
    layered = LayerPieces(amount, np.array([[290.0, 260.0, 200.0]]))
    near, far = planck_wavenumber(nu, 290.0), planck_wavenumber(nu, 260.0)
    np.testing.assert_allclose(law.emission(layered, 500.0 * one)[0], near, rtol=1e-6)
    depth = law.optical_depth(amount[0])
    tau = np.exp(-depth)
    expected = ((1.0 - tau[0]) * near + (tau[0] - tau[1]) * far) / (1.0 - tau[1])
    np.testing.assert_allclose(law.emission(layered, one)[0], expected, rtol=1e-12)
    back = layered.reversed(np.array([True]))
    np.testing.assert_allclose(back.amount[0, :, 0], [0.0, 0.3, 0.4], atol=1e-15)
    np.testing.assert_allclose(law.emission(back, 500.0 * one)[0], far, rtol=1e-6)
