"""Lean of visible facets across the view where long waves run in other directions than short ones, and the covariances it hangs on."""

import math
from dataclasses import replace

import numpy as np
import pytest

from hidden_facets import UPRIGHT, clean_sea, frequent, oblique_looks, of_law, random_waves, sampled, scenario_sea, two_lines
from seaglint.facet.glint import glint
from seaglint.facet.legs import BOTH, NESTED, NESTED_VIEWER, lean_of_legs, legs_of
from seaglint.sea.shadowing.facet_lean import AZIMUTHS, LEAN, gain_at, lean_gains, lean_kernel, lean_table
from seaglint.sea.slopes.cox_munk import cox_munk_anisotropic, cox_munk_isotropic
from seaglint.sea.slopes.from_spectrum import nested_in, spectrum_slopes
from seaglint.sea.slopes.slope_statistics import SlopeStatistics
from seaglint.sea.spectra import CombinedSpectrum, ElfouhailySpectrum, JonswapSpectrum

SEA = cox_munk_anisotropic(7.0, 0.4)
SWELL = JonswapSpectrum(2.5, 11.0, math.radians(115.0), width=math.radians(12.0), wind_to_azimuth=0.4)


def of_waves(slopes, *spectra):
    return nested_in(slopes, CombinedSpectrum(tuple(spectra)) if len(spectra) > 1 else spectra[0])


SEAS = {
    "without spectrum": SEA,
    "Elfouhaily": of_waves(SEA, ElfouhailySpectrum(7.0, 0.4)),
    "swell across": of_waves(SEA, SWELL, ElfouhailySpectrum(7.0, 0.4)),
}


def test_isotropic_slopes_do_not_lean():
    np.testing.assert_allclose(lean_gains(cox_munk_isotropic(7.0)), 0.0, atol=1e-15)


@pytest.mark.parametrize("name", ["without spectrum", "Elfouhaily"])
def test_no_lean_along_and_across_the_wind_and_opposite_leans_beside_it(name):
    gains = lean_gains(SEAS[name])
    np.testing.assert_allclose(gains[[0, AZIMUTHS // 2]], 0.0, atol=1e-9)
    np.testing.assert_allclose(gains[1:], -gains[:0:-1], atol=1e-9)
    assert np.abs(gains).max() > 0.1, "long waves run along the wind more closely than short ones"


def one_by_one(sea, azimuth):
    """Gain of waves that are drawn, sorted by their wavenumber along the view."""
    c, s = math.cos(azimuth), math.sin(azimuth)
    along, beside = sea.north * c + sea.east * s, sea.east * c - sea.north * s
    order = np.argsort(np.abs(along))
    part = (sea.variance * along**2)[order]
    x = np.concatenate([[0.0], np.cumsum(part) / part.sum()])
    shape = x**0.62 * (1.0 - x)
    return LEAN * np.sum(np.diff(shape) * (beside / along)[order]) / ((0.62 / 1.62) ** 0.62 / 1.62)


@pytest.mark.parametrize("wind", [3.0, 12.0])
def test_gains_are_those_of_waves_one_by_one(wind):
    """Against integrals over the directions of each length."""
    sea = clean_sea(wind, isotropic=False)
    for turn in (20, 50, 70, 115, 160):
        azimuth = math.radians(turn)
        assert gain_at(lean_gains(sea.slopes()), azimuth) == pytest.approx(one_by_one(sea, azimuth), rel=0.04, abs=0.02)


@pytest.mark.parametrize("cut", [3.0, 0.3])
def test_gains_of_what_geometry_leaves(cut):
    """Waves down to a length are geometry: facets lean as the shorter ones alone make them."""
    sea = clean_sea(7.0, isotropic=False)
    longer = sea.longer_than(cut)
    short = sea._replace(variance=np.where(np.hypot(sea.east, sea.north) * cut < 2.0 * math.pi, 0.0, sea.variance))
    for turn in (20, 50, 115):
        azimuth = math.radians(turn)
        gain = gain_at(lean_gains(sea.slopes(), float(np.trace(longer.covariance()))), azimuth)
        assert gain == pytest.approx(one_by_one(short, azimuth), rel=0.06, abs=0.03)


def test_gains_of_swell_one_by_one():
    """Waves of 12 deg of spread are narrower than a second harmonic; a light wind beside them, or none."""
    swell = random_waves(JonswapSpectrum(2.5, 11.0, 0.0, width=math.radians(12.0), wind_to_azimuth=0.0), 0.004)
    wind = clean_sea(3.0, isotropic=False)
    both = type(wind)(*(np.concatenate(pair) for pair in zip(wind, swell, strict=True)))
    for sea, error in ((swell, 0.27), (both, 0.09)):
        for turn in (15, 30, 60, 75, 120):
            azimuth = math.radians(turn)
            assert gain_at(lean_gains(sea.slopes()), azimuth) == pytest.approx(one_by_one(sea, azimuth), abs=error)


def test_waves_that_run_one_way_do_not_lean():
    """Slopes along a view and across it are in one proportion for all of them."""
    rows = [(float(k), x, 0.0, 0.0) for k, x in zip(np.geomspace(0.1, 600.0, 30), np.linspace(0.0, 0.02, 30), strict=True)]
    gains = lean_gains(SlopeStatistics(0.02, 0.0, nesting=tuple(rows)))
    assert np.abs(gains[np.arange(AZIMUTHS) != AZIMUTHS // 2]).max() < 0.02


def test_swell_across_the_wind_leans_the_other_way():
    wind, swell = (lean_gains(SEAS[name])[AZIMUTHS // 4] for name in ("Elfouhaily", "swell across"))
    assert abs(swell - wind) > 0.1
    assert abs(lean_gains(SEAS["swell across"])[0]) > 1e-2, "along the wind too"


def test_gains_go_on_over_the_whole_circle():
    gains = lean_gains(SEAS["swell across"])
    step = math.pi / AZIMUTHS
    for turn in (0.3, 2.9):
        assert gain_at(gains, turn) == pytest.approx(gain_at(gains, turn + math.pi))
        assert gain_at(gains, turn) == pytest.approx(gain_at(gains, turn - 2.0 * math.pi))
    assert gain_at(gains, 3.0 * step) == pytest.approx(gains[3])
    assert gain_at(gains, -0.5 * step) == pytest.approx(0.5 * (gains[-1] + gains[0]))


def test_high_views_and_one_band_do_not_lean():
    table = lean_table(4.3)
    assert lean_kernel(-0.5, 6.0, 0.3, table) == 0.0
    assert abs(lean_kernel(-0.5, 4.5, 0.3, table)) < 1e-3
    assert np.all(lean_table(1.0) == 0.0)
    legs = legs_of(BOTH, SEA, 1.4, 0.3, shining=True)
    assert lean_of_legs((-0.4, 0.2, 0.1), 2.8, -0.4, legs) == (0.0, 0.0)


def test_tables_go_evenly_from_one_number_of_bands_to_the_next():
    at = [lean_kernel(-0.4, 0.3, 1.0, lean_table(float(bands))) for bands in np.arange(1.0, 4.61, 0.2)]
    assert at[0] == 0.0
    assert np.abs(np.diff(at)).max() < 0.1


@pytest.mark.parametrize("azimuth", [0.0, 1.1, 4.0])
@pytest.mark.parametrize("name", SEAS)
def test_the_viewers_lean_keeps_the_visible_area(name, azimuth):
    """It is a shift across the view, by a number for each slope along it: no facet is won or lost, nor turned to the viewer."""
    slopes = SEAS[name]
    legs = legs_of(NESTED_VIEWER, slopes, 0.0, 0.0, shining=False)
    deviation = math.sqrt(float(slopes.mss_along(azimuth)))
    for along in (-2.0, -0.5, 0.2):
        east, north = lean_of_legs((along, 0.4, deviation), azimuth, 0.0, legs)
        assert abs(east * math.sin(azimuth) + north * math.cos(azimuth)) < 1e-12
        assert name != "swell across" or math.hypot(east, north) > 1e-5


@pytest.mark.parametrize("name", SEAS)
@pytest.mark.parametrize("places", [(2.0, 5.0, 3.0), (5.0, 8.0, 2.7), (1.0, 12.0, 3.4)])
def test_leaning_facets_are_reciprocal(name, places):
    """Helmholtz; the disc is on one side only."""
    a, b = (math.radians(90.0 - places[0]), places[2]), (math.radians(90.0 - places[1]), 0.2)
    one, other = (float(glint(*v, *s, SEAS[name], NESTED).chance) * math.cos(v[0]) for v, s in ((a, b), (b, a)))
    assert one == pytest.approx(other, rel=0.02)


def test_light_winds_are_reciprocal_within_a_per_cent():
    """The number of bands is that of the Sun's azimuth, which changes when viewer and Sun change places."""
    slopes = of_waves(cox_munk_anisotropic(3.0, 0.4), ElfouhailySpectrum(3.0, 0.4))
    a, b = (math.radians(87.0), 3.0), (math.radians(82.0), 0.2)
    one, other = (float(glint(*v, *s, slopes, NESTED).chance) * math.cos(v[0]) for v, s in ((a, b), (b, a)))
    assert one == pytest.approx(other, rel=0.015)


def test_seas_seen_from_either_side_of_the_wind_mirror_each_other():
    for turn in (0.3, 1.2):
        one, other = (
            float(glint(math.radians(87.0), 0.4 + side * (turn + math.pi + 0.1), math.radians(78.0), 0.4 + side * turn, SEA, NESTED).chance)
            for side in (1.0, -1.0)
        )
        assert one == pytest.approx(other, rel=1e-9)


@pytest.mark.parametrize("name", SEAS)
def test_growth_goes_from_no_waves_to_all(name):
    """Every wave adds slopes: the steps are covariances, the last ends at the total."""
    slopes = SEAS[name]
    grown = slopes.growth()
    np.testing.assert_array_equal(grown[0, 1:], 0.0)
    np.testing.assert_allclose(grown[-1, 1:], (slopes.mss_up, slopes.mss_cross, 0.0), rtol=1e-12, atol=1e-15)
    more, up, cross, both = np.diff(grown, axis=0).T
    assert np.all(more > 0.0)
    assert np.all(up >= -1e-12)
    assert np.all(cross >= -1e-12)
    assert np.all(up * cross - both**2 >= -1e-12)


def test_the_shape_without_a_spectrum_is_elfouhailys():
    """Excess of slope variance along the wind over that across it, of the longer waves, within 0.05 of their share."""
    for wind in (3.0, 7.0, 12.0):
        slopes = spectrum_slopes(ElfouhailySpectrum(wind, 0.0))
        made, shape = nested_in(slopes, ElfouhailySpectrum(wind, 0.0)).growth(), slopes.growth()
        total = slopes.mss
        for _, up, cross, _ in made[3:-1:4]:
            x = (up + cross) / total
            wanted = [float(np.interp(x, shape[:, 1:3].sum(axis=1) / total, shape[:, i])) / total for i in (1, 2)]
            assert (up - cross) / total == pytest.approx(wanted[0] - wanted[1], abs=0.05)


def test_covariances_turn_with_the_axes():
    """A spectrum whose own wind is beside that of the slopes: the same waves, told in the slopes' axes."""
    straight = replace(SEA, wind_to_azimuth=0.0)
    for turn in (0.5, math.pi / 2.0, -2.0):
        turned = nested_in(straight, ElfouhailySpectrum(4.0, turn)).nesting[8]  # waves too long for ripples
        _, up, cross, both = turned
        c, s = math.cos(turn), math.sin(turn)
        own = (up * c * c + 2.0 * both * c * s + cross * s * s, up * s * s - 2.0 * both * c * s + cross * c * c)
        mixed = (cross - up) * c * s + both * (c * c - s * s)
        assert abs(mixed) < 1e-9, "along its own wind a spectrum's slopes do not go together"
        assert own[0] > own[1]


def test_swell_is_where_it_runs():
    """Waves of 11 s towards 115 deg: the first covariances lie along that azimuth, 92 deg beside the wind."""
    first = SEAS["swell across"].nesting[6][1:]
    angle = 0.5 * math.atan2(2.0 * first[2], first[0] - first[1])
    assert math.remainder(angle - (math.radians(115.0) - 0.4), math.pi) == pytest.approx(0.0, abs=0.05)


def test_flat_slopes_have_no_waves_to_nest():
    flat = SlopeStatistics(0.0, 0.0)
    assert nested_in(flat, ElfouhailySpectrum(5.0, 0.0)) == flat
    assert np.all(flat.growth()[:, 1:] == 0.0)


def _ratios(sea, slopes, beside, off, depressions, elevations, draws, step):
    """Law over brute force and its error, and the same without lean, of looks that enough facets are left for."""
    looks = frequent(oblique_looks(beside, off, depressions, elevations), sea)
    lines = two_lines(sea, (math.radians(off - beside), math.radians(180.0 - beside)), math.radians(min(depressions)), step=step)
    found, error = sampled(lines, looks, draws)
    kept = found[:, 1] > 20.0 * error[:, 1]
    laws = [np.array([of_law(look, slopes, law) for look in looks])[kept] / found[kept, 1] for law in (NESTED, UPRIGHT)]
    return *laws, (error[:, 1] / found[:, 1])[kept]


def test_glint_beside_the_sun_under_oblique_wind_follows_brute_force():
    """Wind 50 deg beside, 5 deg off the Sun 10 deg high: without lean one side is told too dark and the other too bright."""
    sea = clean_sea(6.0, isotropic=False, sizes=(200, 48))
    for off in (-5.0, 5.0):
        leaning, upright, error = _ratios(sea, sea.slopes(), 50.0, off, (3.0,), (10.0,), 20_000, 1.05)
        assert leaning.size == 1
        assert abs(leaning[0] - 1.0) < 0.08 + 2.5 * error[0]
        assert abs(leaning[0] - 1.0) < abs(upright[0] - 1.0)


@pytest.mark.validation
@pytest.mark.parametrize("wind", [3.0, 6.0, 12.0])
@pytest.mark.parametrize("beside", [30.0, 50.0, 90.0])
@pytest.mark.parametrize("kind", ["clean", "scenario"])
def test_glint_under_oblique_wind_by_brute_force(wind, beside, kind):
    sea = clean_sea(wind, isotropic=False)
    sea, slopes = (sea, sea.slopes()) if kind == "clean" else scenario_sea(wind)
    for off in (-10.0, -5.0, 5.0, 10.0):
        leaning, upright, error = _ratios(sea, slopes, beside, off, (1.0, 3.0, 7.0, 15.0), (5.0, 10.0, 15.0, 25.0), 80_000, 1.03)
        print(wind, beside, off, np.round(leaning, 3), np.round(upright, 3))
        assert np.all(np.abs(leaning - 1.0) < 0.15 + 3.0 * error)
