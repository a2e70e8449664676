"""Shares of azimuths by their borders, against looks at every azimuth."""

from __future__ import annotations

import numpy as np
import pytest

from seaglint.climate.exceeding_azimuths import azimuth_shares
from seaglint.climate.glint_radiance import looks, seas
from seaglint.climate.mirrored_sunlight import mirrored_light
from seaglint.facet.legs import NESTED
from seaglint.optics.band import Band
from seaglint.optics.sea_water import hale_querry_sea
from seaglint.sea.slopes.cox_munk import cox_munk_gram_charlier
from seaglint.studies.build.profile_air import model_air

BAND = (3.5, 5.0)
DEPRESSION = (0.02, 0.11)
THRESHOLDS = (0.05, 0.25, 2.5)
STEPS = 1440


@pytest.fixture(scope="module")
def light_and_seas():
    def band_air(model, wind):
        return model_air(model, wind, BAND)

    light = mirrored_light(band_air, ["midlatitude-summer"], None, (30.0, 30.0), DEPRESSION, Band.rectangular(*BAND), hale_querry_sea())
    return light, seas(lambda wind: cox_munk_gram_charlier(wind, 0.0), (0.0, 20.0), NESTED)


@pytest.mark.parametrize("degrees", [(0.0, 360.0), (-15.0, 15.0), (40.0, 350.0)])
def test_shares_are_those_of_looks_at_all_azimuths(light_and_seas, degrees):
    u = np.random.default_rng(6).random((40, 5))
    first, last = np.radians(degrees)
    azimuth = first + (last - first) * (np.arange(STEPS) + 0.5) / STEPS
    columns = [
        np.zeros(40), 0.5 + 14.0 * u[:, 0], 2.0 * np.pi * u[:, 1], np.full(40, 30.0), np.radians(60.0 + 29.0 * u[:, 2]),
        2.0 * np.pi * u[:, 3], np.ones(40), np.zeros(40), DEPRESSION[0] + (DEPRESSION[1] - DEPRESSION[0]) * u[:, 4],
    ]  # fmt: skip
    rows = np.column_stack(columns)
    every = np.repeat(rows, STEPS, axis=0)
    every[:, 7] = every[:, 5] + np.tile(azimuth, 40)
    radiance = looks(every, *light_and_seas).radiance.reshape(40, STEPS)
    exact = np.stack([np.mean(radiance > threshold, axis=1) for threshold in THRESHOLDS], axis=1)
    assert np.mean((exact > 0.0) & (exact < 1.0)) > 0.3
    # Counting azimuths errs by half a step at each of two borders, and by a tenth of one for radiances found within 2e-4.
    assert np.max(np.abs(azimuth_shares(rows, *light_and_seas, (first, last), THRESHOLDS) - exact)) < 1.3 / STEPS
