"""Scattered sunlight of continuous air against a converged sum of our own, which shares neither kernel nor points with it."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

from seaglint.air.profile.air_profile import model_profile
from seaglint.air.profile.hazes import HazeWeather
from seaglint.air.profile.profile_scattering import scattering_air
from seaglint.air.protocol import wavenumber_grid
from seaglint.air.scattering.scattering_laws import scattering_angle
from seaglint.files.lowtran.deck import MODELS

sys.path.insert(0, str(Path(__file__).parents[2] / "tools"))
from converged_scattering import converged

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
