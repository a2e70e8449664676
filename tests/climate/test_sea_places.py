"""Places of a region at sea: on the sea alone, even over its area, and as even as the numbers they are made of."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import qmc

from seaglint.climate.conditions import GeographicRegion
from seaglint.climate.sea_places import sea_places
from seaglint.climate.world_weather import world_weather

REGIONS = {
    "globe": GeographicRegion(-72.0, 80.0, -180.0, 180.0),
    "Africa's coast": GeographicRegion(10.0, 20.0, -30.0, 0.0),
    "date line": GeographicRegion(50.0, 62.0, 160.0, -150.0),
    "a degree": GeographicRegion(33.0, 34.0, -79.5, -78.0),
    "a parallel": GeographicRegion(40.0, 40.0, -20.0, 5.0),
}


@pytest.mark.parametrize("name", REGIONS)
def test_places_are_at_sea_and_even_over_its_area(name):
    region, world = REGIONS[name], world_weather()
    law = sea_places(world, region)
    north, east = law.draw(*qmc.Sobol(2, rng=np.random.default_rng(1)).random_base2(14).T)
    assert world.at_sea(north, east).mean() > 0.97
    assert np.all((north >= region.south - 1e-9) & (north <= region.north + 1e-9))
    across = (east - region.west) % 360.0
    assert np.all((across <= region.width + 1e-9) | (across > 360.0 - 1e-9))
    # Shares of quarters of the region, against a fine grid of the sea weighted by area.
    fine_north = np.linspace(region.south, region.north, 401)
    fine_east = np.linspace(0.0, region.width, 401)[:-1]
    grid_north, grid_east = np.meshgrid(fine_north[:-1] + 0.5 * np.diff(fine_north), fine_east + 0.5 * fine_east[1], indexing="ij")
    weight = np.cos(np.radians(grid_north)) * world.at_sea(grid_north, region.west + grid_east)
    for low in (True, False):
        for left in (True, False):
            quarter = ((grid_north < np.mean(fine_north)) == low) & ((grid_east < 0.5 * region.width) == left)
            drawn = ((north < np.mean(fine_north)) == low) & ((across < 0.5 * region.width) == left)
            assert drawn.mean() == pytest.approx((weight * quarter).sum() / weight.sum(), abs=0.015)


def test_even_numbers_give_places_with_little_noise():
    """The mean latitude of Sobol points errs by a tenth of that of random ones or less."""
    law, random = sea_places(world_weather(), REGIONS["globe"]), np.random.default_rng(2)
    errors = {}
    exact = np.mean(law.draw(*qmc.Sobol(2, rng=np.random.default_rng(9)).random_base2(18).T)[0])
    for kind in ("even", "random"):
        points = [random.random((1024, 2)) if kind == "random" else qmc.Sobol(2, rng=random).random_base2(10) for _ in range(32)]
        errors[kind] = np.sqrt(np.mean([(np.mean(law.draw(*each.T)[0]) - exact) ** 2 for each in points]))
    assert errors["even"] < 0.1 * errors["random"]


def test_a_region_on_land_has_none():
    assert sea_places(world_weather(), GeographicRegion(44.0, 50.0, 5.0, 20.0)) is None


def test_middles_are_the_parts_that_are_drawn():
    law = sea_places(world_weather(), REGIONS["Africa's coast"])
    assert world_weather().at_sea(*law.middles).all()
    assert law.middles[0].size == law.count.sum()
    assert law.some[0].size <= 2048
