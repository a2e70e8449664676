"""Waves along a direction, their breadth, and the number of bands that follows from it."""

import math
from dataclasses import replace

import numpy as np
import pytest

from hidden_facets import clean_sea, frequent, oblique_looks, of_law, sampled, scenario_sea, two_lines
from seaglint.facet.legs import BOTH, NESTED, Shadowing
from seaglint.sea.shadowing.facet_lean import bands_along, breadth, waves_along
from seaglint.sea.shadowing.nested import bands_of, bands_of_breadth
from seaglint.sea.slopes.cox_munk import cox_munk_anisotropic, cox_munk_isotropic
from seaglint.sea.slopes.from_spectrum import nested_in
from seaglint.sea.slopes.slope_statistics import SlopeStatistics
from seaglint.sea.spectra import CombinedSpectrum, ElfouhailySpectrum, JonswapSpectrum


def scenario_slopes(wind, towards=0.0):
    return nested_in(cox_munk_anisotropic(wind, towards), ElfouhailySpectrum(wind, towards))


def looks_along(sea, beside, depressions=(0.5, 1.0, 2.0, 3.0, 5.0, 10.0), elevations=(2.0, 5.0, 10.0, 15.0, 20.0)):
    return frequent(oblique_looks(beside, 0.0, depressions, elevations), sea)


@pytest.mark.parametrize("turn_deg", [0.0, 40.0, 90.0, 250.0])
def test_all_waves_have_the_covariance_of_the_slopes(turn_deg):
    slopes, turn = scenario_slopes(5.0, 0.7), math.radians(turn_deg)
    waves = waves_along(slopes, np.array([turn]))
    east_east, east_north, north_north = slopes.covariance()
    s, c = math.sin(turn + 0.7), math.cos(turn + 0.7)
    assert waves.along[-1, 0] == pytest.approx(east_east * s * s + 2.0 * east_north * s * c + north_north * c * c, rel=1e-6)
    assert waves.covariance[-1, 0] == pytest.approx((east_east - north_north) * s * c + east_north * (c * c - s * s), abs=1e-8)
    assert np.all(np.diff(waves.along[:, 0]) >= 0.0)


@pytest.mark.parametrize("wind", [2.0, 3.0, 7.0, 12.0])
@pytest.mark.parametrize("turn_deg", [0.0, 45.0, 90.0])
def test_breadth_is_that_of_waves_one_by_one(wind, turn_deg):
    """Waves drawn from the spectrum, ripples to Cox and Munk's slopes included, against integrals over the directions of each length."""
    sea, slopes = scenario_sea(wind)
    turn = math.radians(turn_deg)
    k = np.abs(sea.north * math.cos(turn) + sea.east * math.sin(turn))
    log = np.log(np.maximum(k, 1e-9))
    mean = np.average(log, weights=sea.variance * k * k)
    drawn = math.sqrt(np.average((log - mean) ** 2, weights=sea.variance * k * k))
    assert breadth(slopes, turn) == pytest.approx(drawn, abs=0.11)


def test_breadth_is_the_same_from_either_side_and_turns_with_the_wind():
    slopes = scenario_slopes(3.0)
    for azimuth in (0.2, 1.3, 2.8):
        assert breadth(slopes, azimuth) == pytest.approx(breadth(slopes, azimuth + math.pi), rel=1e-9)
        assert breadth(slopes, azimuth) == pytest.approx(breadth(scenario_slopes(3.0, 1.1), azimuth + 1.1), rel=1e-9)
        assert breadth(slopes, azimuth) == pytest.approx(breadth(slopes, -azimuth), rel=1e-9)


def test_flat_slopes_have_no_breadth():
    assert breadth(SlopeStatistics(0.0, 0.0), 0.3) == 0.0
    assert bands_along(SlopeStatistics(0.0, 0.0), 0.3) == 1.3


def test_bands_of_elfouhailys_seas_are_those_of_their_slope_variance():
    """Two ways to the same number where both hold: seas of 2-7 m/s with Cox and Munk's slopes and Elfouhaily's shape."""
    for wind in (2.0, 3.0, 4.0, 5.0, 7.0):
        slopes = clean_sea(wind).slopes()
        assert bands_along(slopes, 0.0) == pytest.approx(bands_of(slopes.mss), abs=0.25)


def test_bands_go_evenly_with_wind_and_azimuth():
    table = np.array(
        [[bands_along(scenario_slopes(w), a) for a in np.radians(np.arange(0.0, 91.0, 10.0))] for w in np.arange(1.0, 15.1, 0.5)]
    )
    assert table.min() >= 1.3
    assert table.max() <= 4.6
    assert np.abs(np.diff(table, axis=1)).max() < 0.4
    assert np.abs(np.diff(table, axis=0)).max() < 0.6
    assert np.all(np.diff(table[4:, 0]) > -0.02), "more and more bands, the wind rising"


def test_swell_makes_the_sea_broader():
    wind = ElfouhailySpectrum(4.0, 0.0)
    both = CombinedSpectrum((wind, JonswapSpectrum(2.0, 9.0, 0.0, wind_to_azimuth=0.0)))
    slopes = cox_munk_anisotropic(4.0, 0.0)
    assert breadth(nested_in(slopes, both), 0.0) > breadth(nested_in(slopes, wind), 0.0) + 0.1


@pytest.mark.parametrize("wind", [2.0, 5.0, 9.0])
def test_swell_alone_adds_bands_to_those_of_its_slope_variance(wind):
    """Ripples that no spectrum tells of are as broad as seas of their slope variance are; swell adds longer waves, without steps."""
    slopes = cox_munk_anisotropic(wind, 0.0)
    heights = np.array([0.01, 0.1, 0.3, 0.6, 1.0, 1.3, 1.6, 2.0, 2.5, 3.0])
    found = np.array([bands_along(nested_in(slopes, JonswapSpectrum(h, 11.0, 0.0, wind_to_azimuth=0.0)), 0.0) for h in heights])
    assert found[0] == pytest.approx(bands_of(slopes.mss), abs=0.15)
    assert np.abs(np.diff(found)).max() < 0.6
    assert found.min() > found[0] - 0.5


def test_a_number_of_bands_that_is_given_stays():
    slopes = scenario_slopes(3.0)
    assert Shadowing("nested", bands=3.0).settled(slopes, 0.4).bands == 3.0
    assert BOTH.settled(slopes, 0.4) == BOTH
    assert NESTED.settled(slopes, 0.4).law_bands(slopes) == bands_of_breadth(breadth(slopes, 0.4))
    assert NESTED.settled(cox_munk_isotropic(3.0), 0.4).bands == bands_of(cox_munk_isotropic(3.0).mss)


@pytest.mark.parametrize("beside", [0.0, 90.0])
def test_light_winds_follow_brute_force(beside):
    """A sea of 3 m/s, its ripples those of Cox and Munk: by the slope variance alone the law is 25 % too dark along the wind."""
    sea, slopes = scenario_sea(3.0, sizes=(240, 48))
    looks = looks_along(sea, beside, (1.0, 3.0), (5.0, 10.0, 15.0))
    lines = two_lines(sea, (math.radians(-beside), math.radians(180.0 - beside)), math.radians(1.0), step=1.04)
    found, error = sampled(lines, looks, 40_000)
    ratio = np.array([of_law(look, slopes) for look in looks]) / found[:, 1]
    assert np.sqrt(np.mean((ratio - 1.0) ** 2)) < 0.1 + 2.0 * np.max(error[:, 1] / found[:, 1])


@pytest.mark.validation
@pytest.mark.parametrize("wind", [2.0, 3.0, 4.0, 6.0, 9.0, 12.0])
@pytest.mark.parametrize("beside", [0.0, 45.0, 90.0])
def test_bands_of_scenarios_by_brute_force(wind, beside):
    """Down to half a degree, the law's number of bands leaves at most what the best of all numbers leaves and a tenth."""
    sea, slopes = scenario_sea(wind)
    looks = looks_along(sea, beside)
    lines = two_lines(sea, (math.radians(-beside), math.radians(180.0 - beside)), math.radians(0.5), step=1.03)
    found, error = sampled(lines, looks, 100_000)
    kept = found[:, 1] > 12.0 * error[:, 1]

    def departure(law):
        ratio = np.array([of_law(look, slopes, law) for look in looks])[kept] / found[kept, 1]
        return float(np.sqrt(np.mean(np.log(ratio) ** 2)))

    best = min(departure(replace(NESTED, bands=bands)) for bands in np.arange(1.6, 5.1, 0.2))
    ours, by_variance = departure(NESTED), departure(replace(NESTED, bands=bands_of(slopes.mss)))
    print(f"{wind:g} m/s, {beside:g} deg beside: {ours:.3f}, best {best:.3f}, by the slope variance alone {by_variance:.3f}")
    assert ours < best + 0.1
