"""Scattered sunlight of continuous air against a converged sum of our own, which shares neither kernel nor points with it."""

from __future__ import annotations

import numpy as np
import pytest

from converged_scattering import converged
from seaglint.air.profile.aerosols import HazeWeather
from seaglint.air.profile.air_profile import model_profile
from seaglint.air.profile.profile_scattering import scattering_air
from seaglint.air.protocol import wavenumber_grid
from seaglint.air.scattering.gas_bands import GasBands
from seaglint.air.scattering.lowtran_ray import MOLECULES, WORK_ROWS, trace
from seaglint.air.scattering.scattered_line import KINDS, _empty_line, local_zenith, optical_depths, sun_seen
from seaglint.air.scattering.scattering_laws import SpectralLaws, scattering_angle
from seaglint.air.scattering.twilight import refined
from seaglint.formats.lowtran.deck import MODELS

WITHIN = 0.02  # the worst of 180 random lines is 1.2 % off


def scattered(air, height, line):
    amplitude, _ = air.amplitudes(height, np.array([line]))
    phase = air.phase(scattering_angle(*line[:2], float(air.apparent_zenith(line[2], height))))
    return float((air.source * (phase * amplitude[0]).sum(axis=0)).sum())


@pytest.mark.parametrize("number", [*range(6), *(pytest.param(n, marks=pytest.mark.validation) for n in range(6, 60))])
def test_lines_are_within_two_per_cent_of_a_converged_sum(number):
    random = np.random.default_rng([7, number])
    model, wind = list(MODELS)[number % 6], float(random.uniform(0.5, 18.0))
    profile, haze = model_profile(model), HazeWeather(wind=wind, wind_24h=wind)
    band = [(3.5, 5.0), (2.0, 2.5), (3.0, 4.0)][number % 3]
    air = scattering_air(profile, haze, wavenumber_grid(*band), continuous=True)
    height = float(np.exp(random.uniform(np.log(2.0), np.log(9000.0))))
    for _ in range(3):
        zenith = 0.5 * np.pi + random.choice([-1.0, 1.0]) * float(np.exp(random.uniform(np.log(2e-3), np.log(1.5))))
        line = (zenith, float(random.uniform(0.02, np.pi)), float(random.uniform(0.0, np.radians(85.0))))
        own = float(converged(profile, haze, air, height, line).sum())
        assert scattered(air, height, line) == pytest.approx(own, rel=WITHIN)


def log_means(light):
    """Means between neighbours by the logarithm of the light itself, or half their sum where one is dark."""
    a, b = light[:-1], light[1:]
    lit = (a > 0.0) & (b > 0.0) & (a != b)
    return np.where(lit, (b - a) / np.log(np.where(lit, b, 2.0) / np.where(lit, a, 1.0)), 0.5 * (a + b))


@pytest.mark.parametrize("sun", [60.0, 90.55, 90.75, 90.95])
def test_light_between_points_is_its_logarithmic_mean(sun):
    """Also where the horizon cuts the Sun's disc, of which each point of the line sees another share."""
    air = scattering_air(
        model_profile("midlatitude-summer"), HazeWeather(wind=7.0, wind_24h=7.0), wavenumber_grid(3.5, 5.0), continuous=True
    )
    laws, zenith, azimuth = air.laws, np.radians(95.0), 0.2
    columns, channels = laws.density.shape[0], air.wavenumber_cm.size
    work, line, whole, depth = np.zeros((WORK_ROWS, columns)), _empty_line(columns), np.zeros(columns), np.zeros(channels)
    points = trace(laws, 1.0, zenith, line, work)
    light, seen = np.zeros((points, channels)), np.zeros(points)
    for j in range(points):
        place = local_zenith(np.radians(sun), azimuth, line.arc[j])
        seen[j] = sun_seen(laws, line.height[j], place, work, whole, refined(np.radians(sun)))
        if seen[j] > 0.0:
            optical_depths(laws, whole + line.amount[j], depth)
            light[j] = seen[j] * np.exp(-depth)
    assert (sun < 90.0) == bool(np.all(seen == 1.0))
    assert sun < 90.0 or np.ptp(seen) > 0.01
    amounts = np.diff(line.amount[:points, MOLECULES])[:, None]
    found, _ = air.amplitudes(1000.0, np.array([(zenith, azimuth, np.radians(sun))]))
    wanted = (amounts * laws.linear[MOLECULES] * log_means(light)).sum(axis=0)
    np.testing.assert_allclose(found[0, KINDS - 1], wanted, rtol=1e-7, atol=1e-12 * wanted.max())


def test_bands_of_two_powers_have_both():
    """``sum (C W)^a``, for no amount too, and for one below 0 by rounding."""
    column, power = np.array([[0, 5, 5, 5, 6, 6]]), np.array([[0.0, 0.5, 0.5, 0.6, 0.6, 0.6]])
    log = np.array([[0.0, -1.0, 2.0, -3.0, 0.5, 1.0]])
    laws = SpectralLaws(2500.0 + 5.0 * np.arange(6.0), np.zeros((7, 6)), GasBands.of(column, power, log))
    place, powers, coefficients = laws.segments
    model = scattering_air(model_profile("tropical"), HazeWeather(wind=7.0, wind_24h=7.0), wavenumber_grid(3.5, 3.6)).laws
    few = model._replace(linear=np.zeros((11, 6)), segments=place, power=powers, coefficient=coefficients)
    for amount in (0.0, -1e-18, 1e-6, 3.0, 1e10):
        row, depth = np.zeros(13), np.full(6, np.nan)
        row[[laws.columns.index(5, 11), laws.columns.index(6, 11)]] = amount, 2.0 * amount
        optical_depths(few, row, depth)
        held = np.maximum(np.where(column[0] == 5, amount, 2.0 * amount), 0.0)
        np.testing.assert_allclose(
            depth, np.where(column[0] > 0, held ** power[0] * np.exp(log[0]), 0.0), rtol=1e-12, atol=1e-9 * (amount < 1e-20)
        )
