"""Shadows of waves on waves against a plain search along the ray towards the Sun."""

import numpy as np
import pytest
from render_scenes import camera, elfouhaily, one_tile, read, sea_view, shown, swept_scene

from seaglint.air.sun_and_sky import visible_part_kernel
from seaglint.air.vacuum import VacuumAtmosphere
from seaglint.base.constants import SOLAR_ANGULAR_RADIUS
from seaglint.facet.sunlight import raised_sun, sunlight, sunlight_at
from seaglint.imaging.launch import surface_of
from seaglint.imaging.wave_surface import course, sun_over_waves
from seaglint.sea.slopes.cox_munk import cox_munk_anisotropic


@pytest.mark.kernel
@pytest.mark.parametrize(("height", "share"), [(-1.5, 0.0), (-1.0, 0.0), (0.0, 0.5), (1.0, 1.0), (2.0, 1.0)])
def test_disc_over_an_edge(height, share):
    assert visible_part_kernel(height * SOLAR_ANGULAR_RADIUS)[0] == pytest.approx(share)


@pytest.mark.kernel
def test_part_of_a_disc_is_its_area_and_its_middle():
    """Points spread over a disc."""
    n = 200_000
    y = np.sqrt((np.arange(n) + 0.5) / n) * np.sin(np.arange(n) * np.pi * (3.0 - np.sqrt(5.0)))
    for height in (-0.7, -0.2, 0.4, 0.9):
        share, lift = visible_part_kernel(height * SOLAR_ANGULAR_RADIUS)
        assert share == pytest.approx(np.mean(y > -height), abs=2e-3)
        assert lift / SOLAR_ANGULAR_RADIUS == pytest.approx(np.mean(y[y > -height]), abs=2e-3)


@pytest.mark.kernel
@pytest.mark.parametrize("zenith_deg", [20.0, 45.0, 80.0, 89.0])
def test_a_raised_sun_is_one_of_a_smaller_zenith_angle(zenith_deg):
    lift = 0.4 * SOLAR_ANGULAR_RADIUS
    at_the_foot = sunlight_at(sunlight(np.radians(zenith_deg) - lift, 0.8, True), 0.0, 1.0, 0.0)
    raised = raised_sun(sunlight(np.radians(zenith_deg), 0.8, True), lift)
    np.testing.assert_allclose(raised, at_the_foot, rtol=2e-5, atol=2e-5)


@pytest.mark.parametrize("sun_zenith_deg", [84.0, 86.0, 88.0])
def test_share_of_the_sun_is_that_above_the_skyline(sun_zenith_deg):
    waves = one_tile(wind=12.0)
    lattices, tile = waves.coefficients(0.0), waves.tiles[0]
    sea = surface_of(lattices, np.array([tile.spacing]), np.array([tile.rotation]))
    azimuth, step = 0.8, 0.25 * tile.spacing
    sun = sunlight(np.radians(sun_zenith_deg), azimuth, True)
    view = (np.sin(0.3), np.cos(0.3))
    line, sunward = course(sea, 0, *view, (0.0, 0.0)), course(sea, 0, np.sin(azimuth), np.cos(azimuth), (0.0, 0.0))
    march = (step, float(np.hypot(*waves.surfaces(0.0)[0][..., 1:].T).max()))
    found, expected = [], []
    for r in np.linspace(5.0, 400.0, 150):
        found.append(sun_over_waves(sea, 0, line, sunward, float(r), march, sun)[0])
        d = np.concatenate([[0.25, 0.5], np.arange(1, 4000)]) * step
        x, y = r * view[0] + d * np.sin(azimuth), r * view[1] + d * np.cos(azimuth)
        z = read(lattices[0], tile.spacing, tile.rotation, x, y)[..., 0]
        own = read(lattices[0], tile.spacing, tile.rotation, np.array([r * view[0]]), np.array([r * view[1]]))[0, 0]
        skyline = np.arctan(((z - own) / d).max())
        height = np.radians(90.0 - sun_zenith_deg) - skyline
        expected.append(visible_part_kernel(float(height))[0])
    assert 0.05 < np.mean(expected) < 0.98  # some of both
    # skipped samples cannot reach the ray; where they graze it the skyline is that of the samples looked at
    np.testing.assert_allclose(found, expected, atol=0.02)


def test_shadows_that_are_not_looked_for_are_next_to_nothing():
    """Where Smith's law leaves less than a thousandth of the sea in shadow, rays to the Sun change the glint by hardly more."""
    waves, slopes = elfouhaily(8.0, travel_deg=180.0), cox_munk_anisotropic(8.0, np.pi)
    view = sea_view(VacuumAtmosphere.for_band(3.5, 5.0), slopes, 20.0, 68.0)
    eye = camera(20.0, -2.0, -8.0, 60, width=4.0, columns=24)
    with_none = swept_scene(view, eye, waves)
    with_all = swept_scene(view, eye, waves, negligible_shadow=0.0)
    assert with_none.tables.walk.shadow[:, 0].max() == 0.0
    assert with_all.tables.walk.shadow[:, 0].min() > 0.0
    skipped, looked_for = (shown(with_none, 0.0).glint_radiance.mean(dtype=float), shown(with_all, 0.0).glint_radiance.mean(dtype=float))
    assert looked_for <= skipped
    assert looked_for == pytest.approx(skipped, rel=3e-3)
