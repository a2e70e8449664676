"""Spectra against the numbers of independent programs and against their own moments taken another way."""

import numpy as np
import pytest
from scipy.optimize import brentq

from seaglint.base.errors import DomainError
from seaglint.sea.dispersion import angular_frequency
from seaglint.sea.spectra import ElfouhailySpectrum, PiersonMoskowitzSpectrum
from seaglint.sea.spectra.elfouhaily import inverse_wave_age_of_fetch

SEAS = [ElfouhailySpectrum(10.0, np.radians(60.0)), ElfouhailySpectrum(7.0, 2.0, 2.0), PiersonMoskowitzSpectrum(10.0, np.radians(200.0))]


@pytest.mark.parametrize(
    ("wind", "height", "mss", "mss_long"), [(5.0, 0.65, 0.0323, 0.0143), (10.0, 2.64, 0.0624, 0.0223), (15.0, 5.94, 0.0855, 0.0260)]
)
def test_elfouhaily_integrals(wind, height, mss, mss_long):
    """Values of an independent program for a fully developed sea; the last column is of waves longer than 1 m."""
    sea = ElfouhailySpectrum(wind)
    assert sea.significant_height() == pytest.approx(height, abs=0.005)  # printed digits
    assert sum(sea.mss()) == pytest.approx(mss, abs=5e-5)
    assert sum(sea.mss(2 * np.pi)) == pytest.approx(mss_long, abs=5e-5)


@pytest.mark.parametrize(
    ("ratio", "level"), [(0.8, 1 + np.log(0.8)), (0.98, 1 + np.log(0.98)), (1.02, 1 + 3 * np.log(1.02)), (2.0, 1 + 3 * np.log(2.0))]
)
def test_elfouhaily_short_waves_rise_three_times_as_fast_above_the_slowest_wave(ratio, level):
    """At k_m the curvature is alpha_m/2 above that of the long waves, alpha_m = 0.01 [1 + (1 or 3) ln(u*/c_m)] on both sides of c_m."""
    wind = brentq(lambda u10: ElfouhailySpectrum(u10).friction_velocity - 0.23 * ratio, 2.0, 19.0)
    sea, k = ElfouhailySpectrum(wind), 370.0
    root = np.sqrt(k / sea.peak_wavenumber)
    long = 0.5 * 0.006 * np.sqrt(0.84) * (wind / 0.84) / 0.23 * np.exp(-0.84 / np.sqrt(10.0) * (root - 1.0))
    speed = np.sqrt(2.0 * 9.81 / k) / 0.23  # the paper's c_m is rounded
    assert float(k**3 * sea.omnidirectional(k)) * speed == pytest.approx(0.5 * 0.01 * level + long, rel=1e-3)


def test_elfouhaily_is_rougher_along_the_wind():
    assert ElfouhailySpectrum(10.0, 1.0).mss(2 * np.pi) == pytest.approx((0.0138, 0.0085), abs=5e-5)


def test_pierson_moskowitz_height_and_period():
    sea = PiersonMoskowitzSpectrum(10.0)
    assert sea.significant_height() == pytest.approx(2.13, abs=0.005)
    assert 2 * np.pi / angular_frequency(sea.peak_wavenumber) == pytest.approx(7.30, abs=0.005)
    assert PiersonMoskowitzSpectrum.of_u10(9.4002).u19_5 == pytest.approx(10.0, abs=1e-3)


@pytest.mark.parametrize("sea", SEAS)
def test_moments_of_the_directional_density(sea):
    """A polar sum of density(k_east, k_north) knows nothing of the closed forms behind significant_height and mss."""
    low, high = sea.wavenumber_range
    k = np.exp(np.linspace(np.log(low), np.log(high), 3001))[:, None]
    azimuth = (np.arange(720) + 0.25) * (2 * np.pi / 720)
    east, north = k * np.sin(azimuth), k * np.cos(azimuth)
    psi = sea.density(east, north) * k * k * (2 * np.pi / 720)  # Psi k dk dphi = Psi k^2 dlnk dphi
    log_k = np.log(k[:, 0])
    variance = np.trapezoid(psi.sum(axis=1), log_k)
    assert 4 * np.sqrt(variance) == pytest.approx(sea.significant_height(), rel=2e-3)  # 720 directions across the half plane's edge
    wind = sea.wind_to_azimuth
    up, cross = east * np.sin(wind) + north * np.cos(wind), east * np.cos(wind) - north * np.sin(wind)
    sums = [np.trapezoid((psi * s * s).sum(axis=1), log_k) for s in (up, cross)]
    assert sums == pytest.approx(sea.mss(), rel=3e-3)
    assert np.trapezoid((psi * up).sum(axis=1), log_k) > 0.0  # waves go where the wind goes
    assert np.trapezoid((psi * np.minimum(up, 0.0)).sum(axis=1), log_k) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("sea", SEAS)
def test_bands_add_up(sea):
    cut = 3.0
    assert sea.height_variance(cut) + sea.height_variance(np.inf, cut) == pytest.approx(sea.height_variance(), rel=1e-6)
    assert np.add(sea.mss(cut), sea.mss(np.inf, cut)) == pytest.approx(sea.mss(), rel=1e-6)


def test_no_energy_outside_the_range():
    sea = ElfouhailySpectrum(8.0)
    low, high = sea.wavenumber_range
    assert np.array_equal(sea.omnidirectional([low * 0.99, high * 1.01]), [0.0, 0.0])
    assert sea.density(0.0, 0.0) == 0.0
    assert sea.mss(low) == (0.0, 0.0)


def test_fetch():
    assert inverse_wave_age_of_fetch(10.0, 1e8) == pytest.approx(0.84, rel=1e-6)
    young = inverse_wave_age_of_fetch(10.0, 20e3)
    assert ElfouhailySpectrum(10.0, 0.0, young).significant_height() < 0.6 * ElfouhailySpectrum(10.0).significant_height()


@pytest.mark.parametrize(("age", "enhancement"), [(2.0, 3.506), (5.0, 5.894)])
def test_peak_enhancement_of_young_seas(age, enhancement):
    """At the peak k^3 S = exp(-5/4) gamma (0.003 sqrt(Omega_c) + short waves); gamma = 1.7 + 6 log10(Omega_c), not ln (5.9 and 11.4)."""
    sea = ElfouhailySpectrum(10.0, 0.0, age)
    long_waves = np.exp(-1.25) * 0.003 * np.sqrt(age)
    kp = sea.peak_wavenumber
    assert 1.0 < kp**3 * float(sea.omnidirectional(kp)) / long_waves / enhancement < 1.4  # the short waves' part is 0.1-0.3 of the long


@pytest.mark.parametrize(("wavenumber", "delta"), [(370.0, 0.377287), (0.13843872, 0.952225)])
def test_asymmetry_between_upwind_and_crosswind(wavenumber, delta):
    """Elfouhaily's Delta by hand at U10 = 10 m/s: tanh[ln2/4 + 4 (c/c_p)^2.5 + 0.13 (u*/c_m) (c_m/c)^2.5].

    c_p = 10/0.84 = 11.90476 m/s; z0 = 3.7e-5 100/9.81 0.84^0.9 = 3.22389e-4 m; u* = 4.1/ln(10/z0) = 0.39643 m/s; ln2/4 = 0.173287.
    At 370 rad/m: c = sqrt(2 9.81/370) = 0.230276 m/s; 4 (c/c_p)^2.5 = 0.000208; 0.13 u*/0.23 (0.23/c)^2.5 = 0.223398; tanh 0.396893.
    At 2 k_p = 0.13843872 rad/m: (c/c_p)^2.5 = 2^-1.25 = 0.420448, times 4 is 1.681793; the capillaries' term 0.000028; tanh 1.855107.
    """
    assert 2.0 * float(ElfouhailySpectrum(10.0).second_harmonic(wavenumber)) == pytest.approx(delta, abs=5e-6)  # six digits by hand


@pytest.mark.parametrize("wind", [0.0, -3.0, 31.0, np.nan])
def test_winds_outside_the_models_are_refused(wind):
    with pytest.raises(DomainError, match="Elfouhaily"):
        ElfouhailySpectrum(wind)
    with pytest.raises(DomainError, match="Pierson"):
        PiersonMoskowitzSpectrum(wind + 5.0 if wind > 30.0 else wind)


@pytest.mark.parametrize("age", [0.5, 6.0, np.nan])
def test_wave_ages_outside_the_model_are_refused(age):
    with pytest.raises(DomainError, match="wave age"):
        ElfouhailySpectrum(10.0, 0.0, age)


def test_impossible_fetch_is_refused():
    with pytest.raises(DomainError, match="fetch"):
        inverse_wave_age_of_fetch(10.0, 0.0)
