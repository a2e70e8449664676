"""Transmittance at many winds is that of the whole air at each, and the aerosol's corners are where its law changes."""

from __future__ import annotations

import numpy as np
import pytest

from seaglint.air.profile.aerosols import HazeWeather, aerosols, wind_kinks
from seaglint.air.profile.air_profile import model_profile
from seaglint.air.profile.air_sums import AirSums
from seaglint.air.profile.profile_atmosphere import WindyAir
from seaglint.air.protocol import slant_range, wavenumber_grid
from seaglint.formats.lowtran.deck import MODELS


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("band", [(3.5, 5.0), (8.0, 12.0)])
def test_it_is_the_whole_air_at_each_wind(model, band):
    random = np.random.default_rng(len(model))
    nu, profile = wavenumber_grid(*band), model_profile(model)
    air = WindyAir.of(profile, nu)
    height, arcs = float(random.uniform(5.0, 3000.0)), random.uniform(0.0, 12e3, 4)
    zenith = random.uniform(0.0, 0.5 * np.pi, 4)
    for wind in (0.0, *random.uniform(0.0, 20.0, 2)):
        whole = AirSums(profile, HazeWeather(wind=wind, wind_24h=wind), nu)
        paths = [whole.between(height, 0.0, float(s))[0] for s in slant_range(height, arcs)]
        at = air.at(wind)
        assert np.allclose(at.transmittance(height, arcs), paths, rtol=1e-9, atol=1e-12)
        suns = [whole.laws.source * whole.passed(0.0, float(z)) for z in zenith]
        assert np.allclose(at.solar_irradiance(zenith), suns, rtol=1e-6, atol=1e-15)
    assert not air.at(7.0).solar_irradiance(np.radians([90.5])).any()


@pytest.mark.parametrize("model", MODELS)
def test_the_haze_has_corners_at_its_kinks_and_nowhere_else(model):
    profile = model_profile(model)
    kinks = wind_kinks(profile)

    def depth(wind):
        held = aerosols(profile, HazeWeather(wind=float(wind), wind_24h=float(wind)), np.array([1e4 / 0.55]), 0.0)
        return float(np.log(held.density[0][:3].sum() * held.extinction[0, 0]))

    def turn(wind, step=1e-3):
        """Change of the slope at a wind."""
        return abs(depth(wind + step) - 2.0 * depth(wind) + depth(wind - step)) / step

    assert min(turn(kink) for kink in kinks) > 3e-3
    random = np.random.default_rng(5)
    between = [w for w in random.uniform(0.5, 19.5, 40) if min(abs(w - kink) for kink in kinks) > 0.05]
    assert max(turn(w) for w in between) < 1e-3
