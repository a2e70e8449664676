"""The Moon's light against whole-disc measurements, its own sums and what must hold exactly."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import constants

from seaglint.base.constants import SOLAR_ANGULAR_RADIUS
from seaglint.base.errors import DomainError
from seaglint.climate.moon_position import MoonEphemeris
from seaglint.optics.blackbody import planck_wavenumber
from seaglint.optics.moonlight import (
    MEAN_MOON_DISTANCE,
    moon_albedo,
    moon_emission,
    moon_irradiance,
    moon_radius,
    moon_reflectance,
    moon_temperature,
    moon_to_sun,
)
from seaglint.optics.solar_spectrum import exoatmospheric_irradiance

# Brightness temperatures of the whole disc: Mueller et al. 2021 (A&A 650, A38), table A.1, channels 1 to 6 of the sounders HIRS of NOAA-11,
# -14 and -15; wavelength [um] and temperature [K] of each. Reflected sunlight is negligible there.
CHANNELS = {
    "NOAA-11": (14.852, 14.731, 14.488, 14.183, 13.909, 13.658),
    "NOAA-14": (14.955, 14.701, 14.487, 14.171, 13.931, 13.656),
    "NOAA-15": (14.976, 14.743, 14.508, 14.226, 13.963, 13.666),
}
HIRS = [
    ("NOAA-11", "1993-11-25T17:39:34", (333.1, 336.2, 336.3, 335.3, 334.1, 334.6)),
    ("NOAA-11", "1992-02-15T19:54:15", (340.4, 344.1, 344.5, 343.1, 342.0, 343.0)),
    ("NOAA-11", "1990-11-27T05:04:49", (282.5, 284.1, 286.0, 285.2, 285.3, 286.0)),
    ("NOAA-11", "1989-03-17T03:31:08", (300.1, 304.5, 306.7, 306.5, 306.3, 307.4)),
    ("NOAA-14", "2000-04-14T10:50:44", (309.4, 310.9, 311.5, 312.1, 313.3, 313.8)),
    ("NOAA-14", "1997-12-08T21:52:12", (283.6, 285.2, 286.6, 287.1, 288.6, 289.6)),
    ("NOAA-14", "1997-06-15T05:05:20", (275.5, 280.2, 282.3, 282.7, 284.4, 285.8)),
    ("NOAA-14", "1996-10-23T00:30:08", (322.8, 322.2, 322.7, 323.4, 324.3, 324.9)),
    ("NOAA-14", "1996-05-28T20:58:58", (312.6, 309.5, 309.7, 310.3, 311.3, 312.0)),
    ("NOAA-14", "1995-12-03T07:13:24", (331.9, 332.9, 334.5, 335.0, 336.1, 336.8)),
    ("NOAA-15", "2018-12-24T11:44:46", (347.5, 348.4, 348.4, 348.8, 349.5, 349.9)),
]
SCATTER = 8.0  # K, of one channel; 7.4 K measured, where the channels of one moment differ by up to 5 K among themselves
BAND_LIGHT = {"3.5-5 um": (3.5, 5.0, 1.2e4, 1.7e4), "8-12 um": (8.0, 12.0, 150.0, 200.0)}


def grid(low_um, high_um):
    return np.arange(1e4 / high_um, 1e4 / low_um + 1.0, 5.0)


def measured():
    for satellite, utc, temperatures in HIRS:
        time = np.datetime64(utc).astype("datetime64[s]").astype(float)
        # a satellite sees the Moon from within 7200 km of the Earth's centre: 1 deg of phase
        moon = MoonEphemeris.between(time, time).at(time, 0.0, 0.0)
        wavenumber = 1e4 / np.array(CHANNELS[satellite])
        yield wavenumber, float(moon.phase[0]), float(moon.sun_distance_au[0]), np.array(temperatures)


def test_temperatures_of_the_disc_equal_those_of_weather_satellites():
    errors = np.array([moon_temperature(nu, phase, sun) - known for nu, phase, sun, known in measured()])
    assert np.abs(errors).max() < SCATTER
    assert np.sqrt((errors**2).mean()) < 3.0
    assert abs(errors.mean()) < 0.5


@pytest.mark.parametrize("phase_deg", [0.0, 35.0, 90.0, 140.0])
@pytest.mark.parametrize("nu", [1000.0, 2500.0])
def test_emission_is_the_sum_over_the_disc(phase_deg, nu):
    # A square grid of the disc as it is seen, x towards the Sun, instead of Gauss points in longitude and latitude.
    phase = math.radians(phase_deg)
    x, y = np.meshgrid(*2 * [(np.arange(2000) + 0.5) / 1000.0 - 1.0])
    inside = x**2 + y**2 < 1.0
    sun = x * math.sin(phase) + np.sqrt(np.maximum(1.0 - x**2 - y**2, 0.0)) * math.cos(phase)
    temperature = np.maximum(392.0 * np.maximum(sun, 0.0) ** (0.085 + 0.231 * phase_deg / 90.0), 95.0)
    expected = (1.0 - float(moon_albedo(nu))) * planck_wavenumber(nu, temperature[inside]).mean()
    assert float(moon_emission(nu, phase)[0]) == pytest.approx(expected, rel=2e-3)


def test_spherical_albedo_is_the_integral_of_the_phase_law():
    phase = np.linspace(0.0, math.pi, 3001)
    law = np.array([float(moon_reflectance(1e4 / 2.38, g)) for g in phase])
    assert 2.0 * np.trapezoid(law * np.sin(phase), phase) == pytest.approx(0.236, abs=0.001)


@pytest.mark.parametrize(("phase_deg", "expected"), [(2.0, 0.316), (7.0, 0.260), (30.0, 0.170), (60.0, 0.0897), (90.0, 0.0388)])
def test_reflectance_of_kieffer_and_stone(phase_deg, expected):
    # Eq. 10 with the coefficients of table 4 at 2383.6 nm, without libration and the terms of waxing and waning, in their own units.
    assert float(moon_reflectance(1e4 / 2.38, math.radians(phase_deg))) == pytest.approx(expected, rel=0.005)


@pytest.mark.parametrize("name", BAND_LIGHT)
def test_sun_is_brighter_by_ten_thousand_and_some_hundred(name):
    low, high, least, most = BAND_LIGHT[name]
    nu = grid(low, high)
    sun = np.trapezoid(exoatmospheric_irradiance(nu), nu)
    moon = np.trapezoid(moon_irradiance(nu, math.radians(10.0)), nu)
    discs = sun / moon * (moon_radius(MEAN_MOON_DISTANCE) / SOLAR_ANGULAR_RADIUS) ** 2
    assert least < discs < most


def test_ratio_is_that_of_the_irradiances():
    nu = grid(3.0, 5.0)
    ratio = moon_to_sun(nu, 0.7, 3.7e8, 0.99)
    assert ratio * exoatmospheric_irradiance(nu) == pytest.approx(moon_irradiance(nu, 0.7, 3.7e8, 0.99), rel=1e-12)


def test_irradiance_falls_with_the_square_of_the_distance():
    nu = np.array([1000.0])
    near, far = moon_irradiance(nu, 0.5, 3.6e8), moon_irradiance(nu, 0.5, 4.05e8)
    assert float(near[0] / far[0]) == pytest.approx((4.05 / 3.6) ** 2, rel=1e-4)
    assert [math.degrees(moon_radius(d)) for d in (3.564e8 - 6.4e6, 4.067e8)] == pytest.approx([0.284, 0.245], abs=0.001)


def test_light_falls_with_the_phase_angle():
    nu = np.array([700.0, 1000.0, 2350.0, 4000.0])
    light = np.array([moon_irradiance(nu, phase) for phase in np.radians(np.arange(2.0, 180.0, 2.0))])
    assert np.all(np.diff(light, axis=0) < 0.0)


def test_new_moon_is_its_night_side():
    nu = np.array([700.0])
    night = (1.0 - moon_albedo(nu)) * planck_wavenumber(nu, 95.0)
    assert moon_emission(nu, math.pi) == pytest.approx(night, rel=1e-9)


def test_whole_emission_is_the_absorbed_sunlight():
    # Emission over all wavelengths, integrated over all directions, against sunlight absorbed with the Bond albedo of 0.12; the law is
    # fitted to the side towards the Sun only, and neither knows the emissivity beyond 15 um.
    phase = np.linspace(0.0, math.pi, 61)
    nu = np.arange(50.0, 3000.0, 25.0)
    total = np.array([np.trapezoid(moon_emission(nu, g), nu) for g in phase])
    emitted = 2.0 * math.pi * math.pi * np.trapezoid(total * np.sin(phase), phase)  # per square of the radius
    absorbed = math.pi * 1361.0 * (1.0 - 0.12)
    assert emitted == pytest.approx(absorbed, rel=0.1)


@pytest.mark.parametrize("phase", [-0.1, 3.2, math.nan])
def test_impossible_phases_are_refused(phase):
    with pytest.raises(DomainError, match="phase angle is 0"):
        moon_irradiance([1000.0], phase)


def test_a_moon_around_the_observer_is_refused():
    with pytest.raises(DomainError, match="inside the Moon"):
        moon_radius(1000.0)


def test_stefan_boltzmann_of_a_disc_of_one_temperature():
    # The night side alone: its radiance over all wavelengths, with an emissivity of 0.95 to 1.
    nu = np.arange(5.0, 1500.0, 5.0)
    radiance = np.trapezoid(moon_emission(nu, math.pi), nu)
    black = constants.sigma * 95.0**4 / math.pi
    assert 0.94 * black < radiance < black
