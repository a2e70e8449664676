"""Rays through layers against an own integration of the eikonal equation on the round Earth, and mirages by their number of images."""

from __future__ import annotations

import bisect
import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from seaglint.air.profile.absorber_densities import refractivity
from seaglint.air.profile.air_profile import model_profile
from seaglint.air.profile.marine_layer import with_marine_layer
from seaglint.air.profile.ray_paths import LayeredIndex
from seaglint.base.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.base.conventions import horizon_depression, horizon_range, surface_range
from seaglint.imaging.refraction import Bending

BAR = 0.02e-3  # rad


def air_of(kind: str) -> LayeredIndex:
    """A model atmosphere, with a warmer or colder sea, or with an inversion in the lowest air."""
    name, _, change = kind.partition(":")
    profile = model_profile(name)
    if change.lstrip("+-").isdigit():
        profile = with_marine_layer(profile, 5.0, 285.0, float(change))
    n = refractivity(profile, 2500.0)
    z = profile.height
    if change in ("duct", "inversion"):
        z = np.unique(np.concatenate([z, np.linspace(0.0, 80.0, 81)]))
        n = np.exp(np.interp(z, profile.height, np.log(n)))
        rise = 6.0 * (1.0 - np.exp(-z / 12.0)) if change == "duct" else 9.0 / (1.0 + np.exp(-(z - 22.0) / 2.0))
        n = n / (1.0 + rise / 285.0)
    return LayeredIndex(z, n, profile.earth_radius)


AIRS = (
    "tropical",
    "subarctic-winter",
    "us-standard-1976:-12",
    "midlatitude-summer:+8",
    "midlatitude-winter:-3",
    "tropical:duct",
    "midlatitude-summer:inversion",
)


def own_ray(air: LayeredIndex, height: float, elevation: float, arcs: np.ndarray) -> np.ndarray:
    """Heights [m] over arcs [m] by the eikonal equation: the ray turns by the gradient across it, the vertical by the arc."""
    log_n, edges, radius = np.log(air.refractivity).tolist(), air.height.tolist(), air.earth_radius

    def along(_: float, state: np.ndarray) -> list[float]:
        z, angle = state
        layer = min(max(bisect.bisect_right(edges, z) - 1, 0), len(edges) - 2)
        fall = (log_n[layer + 1] - log_n[layer]) / (edges[layer + 1] - edges[layer])
        n = math.exp(log_n[layer] + fall * (z - edges[layer]))
        stretch = (radius + z) / radius
        return [math.tan(angle) * stretch, stretch * (1.0 / (radius + z) + fall * n / (1.0 + n))]

    result = solve_ivp(along, (0.0, arcs[-1]), [height, elevation], t_eval=arcs, rtol=1e-9, atol=1e-7, max_step=20.0)
    return np.asarray(result.y[0])


@pytest.mark.parametrize("kind", AIRS)
def test_rays_against_an_own_integration(kind):
    air, random = air_of(kind), np.random.default_rng(len(kind))
    for height in (2.0, float(random.uniform(5.0, 60.0)), 900.0):
        dip = horizon_depression(height)
        elevation = np.concatenate([random.uniform(-2.5 * dip, 1e-3, 4), random.uniform(-0.05, 0.05, 1)])
        rays = air.paths(height, elevation, 60e3)
        for i, e in enumerate(elevation):
            end = min(float(rays.end[i]) * 0.999, 40e3)
            arcs = np.linspace(0.1 * end, end, 7)
            ours = np.array([rays.at(float(arc))[i] for arc in arcs])
            assert np.all(np.abs(ours - own_ray(air, height, float(e), arcs)) < 0.25 * BAR * arcs + 1e-3)


@pytest.mark.parametrize("kind", AIRS)
def test_points_are_seen_where_rays_come_from_them(kind):
    """Bending to objects and to the sea: the ray at the elevation given passes the point."""
    air, random = air_of(kind), np.random.default_rng(len(kind))
    seen = 0
    for _ in range(6):
        height, arc, up = float(random.uniform(3.0, 200.0)), float(random.uniform(500.0, 15e3)), float(random.uniform(1.0, 60.0))
        for e in Bending(air, height, 285.0).elevation(up, arc):
            assert abs(own_ray(air, height, float(e), np.array([0.5 * arc, arc]))[-1] - up) < BAR * arc + 1e-3
            seen += 1
    assert seen >= 3


def test_air_without_refraction_over_the_effective_earth_is_the_standard_picture():
    air = LayeredIndex(np.array([0.0, 1e5]), np.array([1e-15, 1e-15]), EFFECTIVE_EARTH_RADIUS)
    for height in (2.0, 40.0, 3000.0):
        bent = Bending(air, height, 285.0)
        dip = horizon_depression(height)
        assert bent.horizon == pytest.approx(-dip, abs=1e-8)
        elevation = np.concatenate([-dip * np.geomspace(1.001, 0.5 / dip, 60), np.linspace(-0.99 * dip, 0.4, 30)])
        rays = bent.paths(elevation)
        assert np.allclose(bent.straight(rays), elevation, atol=1e-7)
        assert np.allclose(rays.end[:60], surface_range(height, -elevation[:60]), rtol=1e-5)
        arc = 0.3 * horizon_range(height)
        z = rays.at(arc)
        there = np.isfinite(z)
        assert np.allclose(bent.over(rays, arc)[there], elevation[there], atol=1e-7)


def images(kind: str, height: float, arc: float, up: float) -> np.ndarray:
    return Bending(air_of(kind), height, 285.0).elevation(up, arc)


def test_a_warm_sea_shows_a_second_image_below_and_an_inversion_one_above():
    assert images("us-standard-1976", 10.0, 9e3, 15.0).size == 1
    below = images("us-standard-1976:-12", 10.0, 9e3, 15.0)
    assert below.size == 2  # inferior mirage
    above = images("midlatitude-summer:inversion", 12.0, 18e3, 12.0)
    assert above.size == 3  # superior mirage: upright, inverted above it, and upright again by way of the inversion's top
    tops = images("midlatitude-summer:inversion", 12.0, 18e3, 13.0)
    assert tops[0] > above[0]
    assert tops[1] < above[1]  # what is higher is lower in the inverted image


@pytest.mark.parametrize(
    ("kind", "height", "arc", "up", "images"),
    [
        ("us-standard-1976", 10.0, 9e3, 15.0, 1),
        ("us-standard-1976:-12", 10.0, 9e3, 15.0, 2),
        ("midlatitude-summer:inversion", 12.0, 18e3, 12.0, 3),  # the highest turns in the inversion 4.4 mrad above the line
        ("tropical:duct", 5.0, 30e3, 8.0, 1),
        ("us-standard-1976:+20", 10.0, 12e3, 10.0, 1),  # 6.7 mrad above it
        ("us-standard-1976", 10.0, 150.0, 140.0, 1),
    ],
)
def test_all_images_of_a_point_are_found(kind, height, arc, up, images):
    """Those of a scan of the rays from straight down to straight up that pass the point, the highest one too."""
    bent = Bending(air_of(kind), height, 285.0)
    scan = np.concatenate([np.linspace(-1.5, -0.03, 500), np.linspace(-0.03, 0.03, 20_001)[1:], np.linspace(0.03, 1.5, 500)[1:]])
    off = np.concatenate([bent.paths(part).at(arc) for part in np.array_split(scan, 8)]) - up
    met = np.flatnonzero((off[:-1] <= 0.0) != (off[1:] <= 0.0))
    met = met[np.isfinite(off[met]) & np.isfinite(off[met + 1])]
    found = bent.elevation(up, arc)
    assert met.size == found.size == images
    assert np.all((scan[met] <= found) & (found <= scan[met + 1]))


def test_a_duct_lifts_the_horizon_and_lengthens_it():
    air, plain = air_of("tropical:duct"), air_of("tropical")
    assert air.horizon(10.0, 5e5) > 3.0 * plain.horizon(10.0, 5e5)
    assert air.lowest_sky(10.0, 5e5) > plain.lowest_sky(10.0, 5e5)
    assert plain.horizon(10.0, 5e5) == pytest.approx(horizon_range(10.0), rel=0.03)


def test_many_levels_are_followed_as_fast():
    one = air_of("tropical:duct")
    z = np.concatenate([np.linspace(0.0, 100.0, 50_001), one.height[one.height > 100.0]])
    n = np.exp(np.interp(z, one.height, np.log(one.refractivity)))
    many = LayeredIndex(z, n, one.earth_radius)
    assert many.levels[0].size < 500
    assert many.horizon(30.0, 5e5) == pytest.approx(one.horizon(30.0, 5e5), rel=0.02)


@pytest.mark.parametrize("height", [2.0, 5.0, 10.0, 40.0, 300.0])
@pytest.mark.parametrize("kind", [*(f"us-standard-1976:{change:+d}" for change in (-20, -12, -6, -1, 0, 2, 6, 12, 20)), "tropical:duct"])
def test_the_horizon_is_the_last_ray_of_a_scan_that_meets_the_sea(kind, height):
    """Air up to 20 K colder or warmer than the sea: the horizon lies from far below the standard one to far above the horizontal."""
    air = air_of(kind)
    scan = np.linspace(-horizon_depression(height) - 0.01, 0.02, 3001)
    rays = air.paths(height, scan, 5e5)
    last = int(np.flatnonzero(rays.sea)[-1])
    assert scan[last] - 1e-9 <= air.lowest_sky(height, 5e5) <= scan[last + 1] + 1e-9
    assert rays.end[last] - 1.0 <= air.horizon(height, 5e5) < 5e5


def test_the_horizon_of_a_sea_so_warm_that_no_ray_near_the_standard_horizon_meets_it():
    """Fall of the refractivity towards the sea of 100 times a model's: the search goes down to where there is sea."""
    z = np.array([0.0, 2.0, 1e5])
    air = LayeredIndex(z, np.array([1.0e-4, 3.0e-4, 1e-15]), 6371e3)
    # Snell's law between 2 m and 0 m, the Earth flat over them
    assert air.lowest_sky(2.0, 5e5) == pytest.approx(-math.sqrt(2.0 * (2.0e-4 - 0.0)), rel=0.01)
