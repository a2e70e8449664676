"""Short waves between the measured campaigns and Elfouhaily's model: bounds, laws of the levels, continuity in the wind."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from seaglint.base.errors import DomainError
from seaglint.sea.spectra.campaign_draws import (
    LONGEST,
    SHORTEST_MEASURED,
    DrawnShortWaves,
    LongWaves,
    ShortWaveLevels,
    drawn_levels,
    drawn_sea,
    level_at,
    level_correlation,
    short_wave_bounds,
)
from seaglint.sea.spectra.campaigns import campaign_spectrum, campaign_winds
from seaglint.sea.spectra.directional import DirectionalSpectrum
from seaglint.sea.spectra.elfouhaily import ElfouhailySpectrum
from seaglint.sea.spectra.jonswap import JonswapSpectrum
from seaglint.sea.spectra.saturation_table import elfouhaily_or_calm

WINDS = [0.02, 0.5, 1.0, 1.73, 2.69, 5.0, 7.0, 9.24, 12.0, 17.6, 20.0]
BETWEEN = np.geomspace(LONGEST, SHORTEST_MEASURED, 301)[1:-1]


def saturation(spectrum, k):
    return k**3 * spectrum.omnidirectional(k)


def sea_at(wind, levels, longer=None):
    return drawn_sea(wind, levels, 0.3, ElfouhailySpectrum(max(wind, 0.5), 0.3) if longer is None else longer)


@pytest.mark.parametrize("wind", [5.0, 7.0, 9.0])
def test_the_bounds_are_the_campaigns_and_the_model_where_all_three_have_waves(wind):
    k = BETWEEN[BETWEEN > 21.0]
    seas = [saturation(campaign_spectrum(name, wind), k) for name in ("asit-2019", "radyo-2008")]
    seas.append(saturation(ElfouhailySpectrum(wind), k))
    # RaDyO's saturation steps between bands: away from the steps log-linear interpolation is within 1 %
    edges = np.array([20.0, 50.0, 100.0, 200.0, 300.0, 600.0, 1000.0])
    away = np.min(np.abs(np.log(k[:, None] / edges)), axis=1) > 0.02
    for level, expected in ((0.0, np.min(seas, axis=0)), (1.0, np.max(seas, axis=0))):
        drawn = saturation(sea_at(wind, ShortWaveLevels(level, level)), k)
        # 2 %: kinks where one sea passes another lie between nodes, 8 an octave
        assert drawn[away] == pytest.approx(expected[away], rel=0.02)


@given(wind=st.floats(0.01, 30.0), long=st.floats(0.0, 1.0), short=st.floats(0.0, 1.0))
@settings(max_examples=40, deadline=None)
def test_every_drawn_sea_lies_within_the_bounds(wind, long, short):
    bounds = short_wave_bounds(wind)
    k = bounds.wavenumber[bounds.wavenumber >= LONGEST]
    inside = bounds.wavenumber >= LONGEST
    drawn = saturation(sea_at(wind, ShortWaveLevels(long, short)), k)
    # rounding of logarithms alone
    assert np.all(drawn >= bounds.least[inside] * (1.0 - 1e-9))
    assert np.all(drawn <= bounds.largest[inside] * (1.0 + 1e-9))


@pytest.mark.parametrize(("end", "field"), [(LONGEST, "long"), (SHORTEST_MEASURED, "short")])
def test_the_saturation_at_both_ends_is_log_uniform_between_the_bounds(end, field):
    draws, wind = 2000, 8.0
    levels = [drawn_levels(3, i, draws) for i in range(0, draws, 10)]
    bounds = short_wave_bounds(wind)
    low, high = (np.log(np.interp(end, bounds.wavenumber, edge)) for edge in (bounds.least, bounds.largest))
    place = np.array([(np.log(saturation(sea_at(wind, one), end)) - low) / (high - low) for one in levels])
    # a uniform variable's mean and variance, from 200 of them: three standard errors are 0.061 and 0.016
    assert place.mean() == pytest.approx(0.5, abs=0.061)
    assert place.var() == pytest.approx(1.0 / 12.0, abs=0.016)
    assert place == pytest.approx([getattr(one, field) for one in levels], abs=1e-6)


@pytest.mark.parametrize("k", [(5.0, 30.0), (5.0, 1000.0), (20.0, 300.0), (70.0, 75.0)])
def test_levels_of_two_wavenumbers_have_the_stated_correlation(k):
    rng = np.random.default_rng(5)
    pairs = [level_at(ShortWaveLevels(*rng.random(2)), np.array(k)) for _ in range(20_000)]
    # standard error of a correlation of 20,000 pairs: 0.007 at most; three of them
    assert np.corrcoef(np.array(pairs).T)[0, 1] == pytest.approx(float(level_correlation(*k)), abs=0.021)


@pytest.mark.parametrize("draws", [2, 5, 16])
def test_each_level_has_one_sea_in_every_equal_part_of_its_range(draws):
    levels = np.array([drawn_levels(11, i, draws) for i in range(draws)])
    assert np.sort(np.floor(levels * draws).astype(int), axis=0).tolist() == [[i, i] for i in range(draws)]


def test_a_sea_is_a_function_of_seed_and_number():
    forwards = [drawn_levels(4, i, 6) for i in range(6)]
    assert [drawn_levels(4, i, 6) for i in reversed(range(6))] == forwards[::-1]
    assert drawn_levels(5, 0, 6) != forwards[0]
    assert len(set(forwards)) == 6
    assert drawn_sea(7.0, forwards[0], 0.3, ElfouhailySpectrum(7.0, 0.3)) == drawn_sea(7.0, forwards[0], 0.3, ElfouhailySpectrum(7.0, 0.3))


@pytest.mark.parametrize("levels", [ShortWaveLevels(0.0, 0.0), ShortWaveLevels(0.2, 0.9), ShortWaveLevels(1.0, 1.0)])
def test_the_slopes_change_continuously_with_the_wind(levels):
    winds = np.linspace(0.0, 20.0, 801)
    seas = [drawn_sea(wind, levels, 0.0, elfouhaily_or_calm(wind, 0.0)) for wind in winds]
    total = np.array([0.0 if sea is None else sum(sea.mss()) for sea in seas])
    # largest step over 0.025 m/s: 7e-4 where Elfouhaily's sea of 0.5 m/s grows; a row lost or doubled would be above 4e-3
    assert np.abs(np.diff(total)).max() < 1e-3
    assert total[-1] < 0.13


@pytest.mark.parametrize("wind", WINDS)
def test_the_slope_variance_rises_with_both_levels(wind):
    grid = [
        sum(sea_at(wind, ShortWaveLevels(long, short)).mss())
        for long, short in ((0.0, 0.0), (0.5, 0.0), (0.5, 0.5), (0.5, 1.0), (1.0, 1.0))
    ]
    assert np.all(np.diff(grid) > 0.0)


@pytest.mark.parametrize("name", ["asit-2019", "radyo-2008"])
def test_outside_its_winds_a_campaign_is_in_proportion_to_the_wind(name):
    """At 1/2 and at 0.3 of a lightest wind both campaigns bound the sea from above, at 15 m/s ASIT from below."""
    lightest = float(campaign_winds(name)[0])
    k = 900.0
    sea = float(saturation(campaign_spectrum(name, lightest), k))
    bounds = short_wave_bounds(0.3 * float(campaign_winds("radyo-2008")[0]))
    if name == "radyo-2008":
        largest = float(np.interp(k, bounds.wavenumber, bounds.largest))
        model = float(saturation(ElfouhailySpectrum(0.519), k))
        # whichever is larger in this wind: Elfouhaily's sea or a third of RaDyO's lightest
        assert largest == pytest.approx(max(model, 0.3 * sea), rel=0.01)
    else:
        strongest = float(campaign_winds(name)[-1])
        strong = short_wave_bounds(1.1 * strongest)
        last = float(saturation(campaign_spectrum(name, strongest), k))
        assert float(np.interp(k, strong.wavenumber, strong.least)) == pytest.approx(1.1 * last, rel=0.01)


def test_longer_waves_are_the_spectrum_given_and_the_passage_has_no_step():
    model, sea = ElfouhailySpectrum(7.0, 0.3), sea_at(7.0, ShortWaveLevels(0.1, 0.8))
    long = np.geomspace(0.05, 0.499 * LONGEST, 50)
    assert sea.omnidirectional(long) == pytest.approx(model.omnidirectional(long), rel=1e-12)
    assert sea.mss(0.5 * LONGEST) == pytest.approx(model.mss(0.5 * LONGEST), rel=1e-6)
    for edge in (0.5 * LONGEST, LONGEST):
        below, above = saturation(sea, edge * np.array([1.0 - 1e-6, 1.0 + 1e-6]))
        assert above == pytest.approx(below, rel=1e-4)
    # 1 %: directions about the wind are the spectrum's at every wavenumber
    assert sea.second_harmonic(BETWEEN) == pytest.approx(model.second_harmonic(BETWEEN), rel=1e-12)


def test_shorter_waves_continue_and_end():
    sea = sea_at(9.0, ShortWaveLevels(0.5, 1.0))
    at = saturation(sea, np.array([999.9, 1000.1, 1500.0, 3000.0]))
    assert at[1] == pytest.approx(at[0], rel=2e-3)
    assert at[0] > at[2] > at[3] > 0.0
    assert at[3] < 1e-5 * at[0]
    # beyond 6 mm there is a tenth of the slope variance of 300 to 1000 rad/m at most: the end is no choice that decides
    assert sum(sea.mss(k_min=1000.0)) < 0.25 * sum(sea.mss(1000.0, 300.0))


def test_without_wind_a_swell_keeps_its_long_waves_alone():
    swell = JonswapSpectrum(1.5, 11.0, 0.7, wind_to_azimuth=0.3)
    calm = drawn_sea(0.0, ShortWaveLevels(0.5, 0.5), 0.3, swell, directed=False)
    assert calm == drawn_sea(0.0, ShortWaveLevels(0.1, 0.9), 0.3, swell, directed=False)
    assert calm.wavenumber_range[1] == LONGEST
    assert calm.mss(2.0) == pytest.approx(swell.mss(2.0), rel=1e-6)
    assert drawn_sea(0.0, ShortWaveLevels(0.5, 0.5), 0.3, None) is None


def test_a_swell_alone_has_short_waves_of_the_wind():
    swell = JonswapSpectrum(1.5, 11.0, 0.7, wind_to_azimuth=0.3)
    sea, model = drawn_sea(7.0, ShortWaveLevels(0.5, 0.5), 0.3, swell, directed=False), ElfouhailySpectrum(7.0, 0.3)
    with_wind_sea = sea_at(7.0, ShortWaveLevels(0.5, 0.5))
    assert saturation(sea, BETWEEN) == pytest.approx(saturation(with_wind_sea, BETWEEN), rel=1e-12)
    assert sea.second_harmonic(BETWEEN) == pytest.approx(model.second_harmonic(BETWEEN), rel=1e-12)
    assert sea.mss(1.0) == pytest.approx(swell.mss(1.0), rel=1e-6)


def test_the_directions_of_the_short_waves_are_even_about_the_wind():
    angles = np.linspace(0.0, 2.0 * np.pi, 721)[:-1]
    spread = sea_at(7.0, ShortWaveLevels(0.5, 0.5)).spreading(np.full(angles.size, 200.0), angles)
    assert spread.sum() * (2.0 * np.pi / 720) == pytest.approx(1.0, abs=1e-6)


@pytest.mark.parametrize(
    ("build", "text"),
    [
        (lambda: DrawnShortWaves(7.0, ShortWaveLevels(-0.1, 0.5), ElfouhailySpectrum(7.0)), "level = -0.1"),
        (lambda: DrawnShortWaves(7.0, ShortWaveLevels(0.1, float("nan")), ElfouhailySpectrum(7.0)), "level = nan"),
        (lambda: short_wave_bounds(31.0), "31 m/s is outside 0-30"),
        (lambda: short_wave_bounds(0.0), "0 m/s is outside"),
        (lambda: drawn_levels(1, 3, 3), "count from 0 to 2"),
    ],
)
def test_values_outside_are_refused_in_one_line(build, text):
    with pytest.raises(DomainError, match=text) as error:
        build()
    assert "\n" not in str(error.value)


def test_a_spectrum_of_short_waves_alone_has_no_longer_part():
    short = ElfouhailySpectrum(0.5)  # begins at 4.6 rad/m
    assert LongWaves(short).wavenumber_range == pytest.approx((short.wavenumber_range[0], LONGEST))


@pytest.mark.parametrize("wind", [0.3, 2.0, 7.0, 15.0])
@pytest.mark.parametrize("swell", [False, True])
def test_the_table_of_slopes_agrees_with_the_quadrature_of_every_spectrum(wind, swell):
    """Two routes: the table of this spectrum, and the panels that the interface integrates for any spectrum."""
    longer = JonswapSpectrum(1.5, 11.0, 0.9, wind_to_azimuth=0.3) if swell else ElfouhailySpectrum(max(wind, 0.5), 0.3)
    sea = drawn_sea(wind, ShortWaveLevels(0.2, 0.9), 0.3, longer, directed=not swell)
    total = sum(DirectionalSpectrum.mss(sea))
    for k_min, k_max in ((0.0, np.inf), (0.0, 3.3), (3.0, 4.1), (17.0, 23.0), (100.0, 700.0), (900.0, 5000.0)):
        # 2e-5 of the total: cubic between some 250 wavenumbers
        assert sea.mss(k_max, k_min) == pytest.approx(DirectionalSpectrum.mss(sea, k_max, k_min), abs=2e-5 * total)
        expected = DirectionalSpectrum.slope_covariance(sea, k_max, k_min)
        assert sea.slope_covariance(k_max, k_min) == pytest.approx(expected, abs=2e-5 * total)
    with pytest.raises(DomainError, match="must not be negative"):
        sea.mss(-1.0)
