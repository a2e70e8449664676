"""Rays by Snell's law on a sphere: dips, angles at both ends, arcs along the sea."""

from dataclasses import replace

import numpy as np
import pytest

from seaglint.air.profile.bent_ray import RefractingAir
from seaglint.base.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.base.conventions import horizon_depression

VACUUM = RefractingAir.of(np.array([0.0, 1e5]), np.array([1e-30, 1e-30]), EFFECTIVE_EARTH_RADIUS)
AIR = RefractingAir.of(np.array([0.0, 1e3, 1e5]), np.array([2.7e-4, 2.46e-4, 1e-12]), 6.371e6)


@pytest.mark.parametrize("height", [2.0, 50.0, 3000.0])
def test_without_refraction_the_dip_is_geometry(height):
    assert VACUUM.dip(height) == pytest.approx(horizon_depression(height), rel=1e-6)


@pytest.mark.parametrize("height", [2.0, 50.0, 3000.0])
def test_refraction_lifts_the_horizon(height):
    straight = replace(VACUUM, earth_radius=AIR.earth_radius).dip(height)
    assert 0.85 * straight < AIR.dip(height) < straight


@pytest.mark.parametrize("height", [2.0, 50.0, 3000.0])
def test_ray_angles_invert(height):
    cosine = np.array([1e-3, 0.02, 0.5, 0.999])
    np.testing.assert_allclose(AIR.sea_cosine(height, AIR.depression(height, cosine)), cosine, rtol=1e-6)


def test_straight_rays_meet_the_sea_where_geometry_says():
    """Without air: cos(d) (R + h) = R cos(e), and the arc is R (d - e); from straight down to grazing."""
    vacuum = RefractingAir.of(np.array([0.0, 1e4, 1e5]), np.array([1e-30, 1e-30, 1e-30]), 6371.23e3)
    elevation = np.radians([0.0, 0.05, 1.0, 30.0, 89.0])
    for height in (2.0, 30.0, 9000.0):
        depression = np.arccos(np.cos(elevation) * vacuum.earth_radius / (vacuum.earth_radius + height))
        np.testing.assert_allclose(
            vacuum.sea_arc(height, np.sin(elevation)), vacuum.earth_radius * (depression - elevation), rtol=1e-6, atol=1e-6
        )


def test_rays_that_miss_the_sea_have_no_angle_there():
    dip = AIR.dip(50.0)
    found = AIR.sea_cosine([50.0, 50.0, 0.0], [0.999 * dip, 1.001 * dip, 0.5])
    assert np.isnan(found).tolist() == [True, False, False]
    assert found[2] == pytest.approx(np.sin(0.5), rel=1e-14)


def test_followed_rays_come_as_far_as_the_integral_says():
    cosine = np.array([0.003, 0.02, 0.5])
    followed = [AIR.ray(300.0, 0.5 * np.pi + float(d)).arc[-1] * AIR.earth_radius for d in AIR.depression(300.0, cosine)]
    np.testing.assert_allclose(followed, AIR.sea_arc(300.0, cosine), rtol=2e-5)


def bisected(air, height, invariant):
    """Lowest point of one descending ray, by bisection of single numbers."""
    if invariant <= air.sea_invariant:
        return 0.0
    low, high = 0.0, height
    for _ in range(60):
        midpoint = 0.5 * (low + high)
        low, high = (midpoint, high) if float(air.invariant(midpoint)) < invariant else (low, midpoint)
    return high


@pytest.mark.parametrize("seed", range(5))
def test_rays_followed_together_are_the_rays_followed_alone(seed):
    rng = np.random.default_rng(seed)
    height = float(np.exp(rng.uniform(0.0, 9.0)))
    zenith = [*(0.5 * np.pi + rng.uniform(-1.0, 3.0, 9) * AIR.dip(height)), 0.3, 2.8]
    for together, angle in zip(AIR.rays(height, zenith), zenith, strict=True):
        alone = AIR.ray(height, float(angle))
        for name in ("height", "length", "zenith", "arc"):
            assert getattr(together, name).tobytes() == getattr(alone, name).tobytes()
    invariants = AIR.invariant(height, np.sin(zenith))
    assert AIR.lowest(height, invariants).tolist() == [bisected(AIR, height, float(c)) for c in invariants]
