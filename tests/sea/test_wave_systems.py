"""JONSWAP waves and sums of systems: stated heights, added variances, directions of travel, the energy rule in every direction."""

from dataclasses import replace

import numpy as np
import pytest

from seaglint.base.constants import GRAVITY
from seaglint.base.errors import DomainError
from seaglint.facet.facet_tables import facet_slopes
from seaglint.sea.dispersion import angular_frequency
from seaglint.sea.slopes.slope_statistics import SlopeStatistics
from seaglint.sea.spectra import CombinedSpectrum, ElfouhailySpectrum, JonswapSpectrum, PiersonMoskowitzSpectrum
from seaglint.sea.tiles import plan_tiles, resolve_limit
from seaglint.sea.wave_field import WaveField

WIND_TO = np.radians(40.0)
SWELL = JonswapSpectrum(2.0, 9.0, np.radians(160.0), 5.0, np.radians(12.0), WIND_TO)
SEA = CombinedSpectrum((SWELL, ElfouhailySpectrum(7.0, WIND_TO)))


@pytest.mark.parametrize("gamma", [1.0, 3.3, 7.0])
@pytest.mark.parametrize(("height", "period"), [(0.1, 2.0), (2.0, 9.0), (8.0, 14.0)])
def test_height_and_period_are_those_stated(height: float, period: float, gamma: float) -> None:
    sea = JonswapSpectrum(height, period, 0.0, gamma)
    low, high = sea.wavenumber_range
    k = np.exp(np.linspace(np.log(low), np.log(high), 20001))
    variance = np.trapezoid(sea.omnidirectional(k), k)  # the level, by another rule than its own
    assert 4 * np.sqrt(variance) == pytest.approx(height, rel=1e-5)
    frequency = np.sqrt(GRAVITY * k) / (2 * np.pi)
    density = sea.omnidirectional(k) * 4 * np.pi * np.sqrt(k / GRAVITY)  # dk/df
    assert 1 / frequency[int(np.argmax(density))] == pytest.approx(period, rel=1e-3)


def test_without_enhancement_it_is_pierson_and_moskowitz() -> None:
    model = PiersonMoskowitzSpectrum(10.0)
    period = 2 * np.pi / float(np.sqrt(GRAVITY * model.peak_wavenumber))
    sea = JonswapSpectrum(model.significant_height(), period, 0.0, 1.0)
    k = np.array([0.05, 0.08, 0.3, 5.0])
    assert sea.omnidirectional(k) == pytest.approx(model.omnidirectional(k), rel=1e-4)


def test_the_peak_is_enhanced_as_the_experiment_has_it() -> None:
    """Ratio to the same shape without enhancement: gamma at the peak, gamma^exp(-1/2) at one width from it on either side."""
    sea, flat = JonswapSpectrum(2.0, 9.0, 0.0, 3.3), JonswapSpectrum(2.0, 9.0, 0.0, 1.0)
    k = sea.peak_wavenumber * np.array([1.0, 0.93, 1.09, 4.0]) ** 2
    ratio = sea.omnidirectional(k) / flat.omnidirectional(k)
    assert ratio / ratio[-1] == pytest.approx([3.3, 3.3 ** np.exp(-0.5), 3.3 ** np.exp(-0.5), 1.0], rel=1e-6)


@pytest.mark.parametrize(
    ("change", "match"),
    [
        ({"height": 0.0}, "height = 0 m is outside 0.01-30 m"),
        ({"peak_period": 40.0}, "peak_period = 40 s is outside 0.5-30 s"),
        ({"gamma": 0.5}, "gamma = 0.5 is outside 1-20"),
        ({"width": 0.001}, "spreading = .* is outside 1-80 deg"),
        ({"height": 10.0, "peak_period": 5.0}, r"steeper than waves can be; allowed: up to 2\.73 m"),
        ({"to_azimuth": np.nan}, "finite"),
    ],
)
def test_waves_that_are_none_are_refused(change: dict[str, float], match: str) -> None:
    with pytest.raises(DomainError, match=match):
        replace(SWELL, **change)


def test_variances_of_systems_add() -> None:
    for k_max in (0.1, 3.0, np.inf):
        parts = [(s.height_variance(k_max), *s.mss(k_max), s.slope_covariance(k_max)) for s in SEA.systems]
        together = (SEA.height_variance(k_max), *SEA.mss(k_max), SEA.slope_covariance(k_max))
        assert together == pytest.approx(np.sum(parts, axis=0), rel=1e-6)


def test_moments_of_the_sum_are_those_of_its_directional_density() -> None:
    k = np.exp(np.linspace(np.log(SEA.wavenumber_range[0]), np.log(3.0), 3001))[:, None]
    azimuth = (np.arange(720) + 0.25) * (2 * np.pi / 720)
    psi = SEA.density(k * np.sin(azimuth), k * np.cos(azimuth)) * k**4 * (2 * np.pi / 720)
    along, across = np.cos(azimuth - WIND_TO), np.sin(azimuth - WIND_TO)
    sums = [np.trapezoid((psi * weight).sum(axis=1), np.log(k[:, 0])) for weight in (along**2, across**2, along * across)]
    assert sums == pytest.approx((*SEA.mss(3.0), SEA.slope_covariance(3.0)), rel=3e-3)


@pytest.mark.parametrize("n", [256, pytest.param(512, marks=pytest.mark.validation)])
def test_the_field_has_the_height_and_slopes_of_all_systems(n: int) -> None:
    tiles = plan_tiles(SEA, 0.5, n)
    field = WaveField.create(SEA, tiles, 0)
    assert field.significant_height == pytest.approx(SEA.significant_height(), rel=0.005)
    assert field.resolved_mss() == pytest.approx(SEA.mss(tiles[-1].k_max), rel=0.01)
    variances = [sum(np.mean(s[..., 0].astype(float) ** 2) for s in field.reseeded(seed).surfaces(0.0)) for seed in range(30)]
    assert np.std(variances, ddof=1) / np.sqrt(30) < 0.03 * np.mean(variances)
    assert np.mean(variances) == pytest.approx(SEA.height_variance(tiles[-1].k_max), rel=0.09)  # three standard errors


@pytest.mark.parametrize(
    ("sea", "to"), [(SWELL, 160.0), (CombinedSpectrum((SWELL,)), 160.0), (replace(SWELL, to_azimuth=np.radians(340.0)), 340.0), (SEA, None)]
)
def test_waves_travel_in_their_own_directions(sea, to) -> None:
    """-<d zeta/dt grad zeta> = int omega k Psi: the vector along which waves carry their shape; summed over realisations."""
    field = WaveField.create(sea, plan_tiles(sea, 4.0, 128), 0)
    dt, found = 0.05, np.zeros(2)
    for seed in range(4):
        before, now, after = (field.reseeded(seed).surfaces(t) for t in (10.0 - dt, 10.0, 10.0 + dt))
        for a, b, c in zip(before, now, after, strict=True):
            rate = (c[..., 0].astype(float) - a[..., 0]) / (2 * dt)
            found -= [np.mean(rate * b[..., 1]), np.mean(rate * b[..., 2])]
    k = np.exp(np.linspace(np.log(sea.wavenumber_range[0]), np.log(field.tiles[-1].k_max), 2001))[:, None]
    azimuth = (np.arange(720) + 0.25) * (2 * np.pi / 720)
    weight = angular_frequency(k) * k**2 * sea.omnidirectional(k) * sea.spreading(k, azimuth)
    wanted = np.array([np.trapezoid((weight * part(azimuth)).sum(axis=1), np.log(k[:, 0])) for part in (np.sin, np.cos)])
    turn = np.arctan2(*found) - np.arctan2(*wanted)
    assert np.degrees((turn + np.pi) % (2 * np.pi) - np.pi) == pytest.approx(0.0, abs=6.0)  # four realisations
    if to is not None:
        assert np.degrees(np.arctan2(*wanted)) % 360.0 == pytest.approx(to, abs=0.5)


def test_the_peak_is_that_of_the_system_with_the_highest_density() -> None:
    assert SEA.peak_wavenumber == SWELL.peak_wavenumber
    small = CombinedSpectrum((replace(SWELL, height=0.1, peak_period=14.0), ElfouhailySpectrum(12.0, WIND_TO)))
    assert small.peak_wavenumber == ElfouhailySpectrum(12.0).peak_wavenumber


def test_one_wind_for_all() -> None:
    with pytest.raises(DomainError, match="one wind"):
        CombinedSpectrum((SWELL, ElfouhailySpectrum(7.0, 0.0)))
    with pytest.raises(DomainError, match="at least one"):
        CombinedSpectrum(())


@pytest.mark.parametrize("turn", [0.0, 45.0, 90.0, 120.0])
def test_geometry_stays_below_its_share_in_every_direction(turn: float) -> None:
    """Steep, narrow waves at an angle to the wind: the largest ratio of variances over all directions is the share, found by trying."""
    sea = JonswapSpectrum(3.0, 6.0, WIND_TO + np.radians(turn), 3.3, np.radians(10.0), WIND_TO)
    model = SlopeStatistics(0.02, 0.015, WIND_TO)
    limit = resolve_limit(sea, model, 0.8)
    up, cross = sea.mss(limit)
    both, angle = sea.slope_covariance(limit), np.radians(np.arange(0.0, 180.0, 0.25))
    c, s = np.cos(angle), np.sin(angle)
    resolved = up * c**2 + 2 * both * s * c + cross * s**2
    assert np.max(resolved / (model.mss_up * c**2 + model.mss_cross * s**2)) == pytest.approx(0.8, rel=1e-4)


def test_facets_and_geometry_add_up_to_the_model_in_every_direction() -> None:
    waves = WaveField.create(SEA, plan_tiles(SEA, 3.0, 256), 0)
    total, up, cross = SlopeStatistics(0.022, 0.016, WIND_TO), *waves.resolved_mss()
    both = waves.resolved_covariance()
    facets = facet_slopes(total, (up, cross), WIND_TO, both)
    angle = np.radians(np.arange(0.0, 180.0, 5.0))
    c, s = np.cos(angle - WIND_TO), np.sin(angle - WIND_TO)
    resolved = up * c**2 + 2 * both * s * c + cross * s**2
    assert facets.mss_along(angle) + resolved == pytest.approx(total.mss_along(angle), rel=1e-9)
    assert np.ptp(facets.mss_along(angle) - SlopeStatistics(0.022 - up, 0.016 - cross, WIND_TO).mss_along(angle)) > 0.002


def test_slopes_of_the_lattices_have_the_covariance_told() -> None:
    waves = WaveField.create(SEA, plan_tiles(SEA, 3.0, 128), 0)
    told, found = waves.resolved_covariance(), 0.0
    assert told == pytest.approx(SEA.slope_covariance(waves.tiles[-1].k_max), rel=0.15)  # of which interpolation loses some
    s, c = np.sin(WIND_TO), np.cos(WIND_TO)
    for seed in range(20):
        for lattice in waves.reseeded(seed).surfaces(0.0):
            east, north = lattice[..., 1].astype(float), lattice[..., 2].astype(float)
            found += float(np.mean((east * s + north * c) * (east * c - north * s))) / 20
    assert found == pytest.approx(told, rel=0.15)
    assert WaveField.create(ElfouhailySpectrum(7.0, WIND_TO), waves.tiles, 0).resolved_covariance() == 0.0
