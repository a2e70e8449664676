"""The sky near the sea horizon: LOWTRAN7 with thin layers, no line that the air does not make, LOWTRAN7's own sky elsewhere."""

import itertools
from dataclasses import replace

import numpy as np
import pytest

from seaglint.air.table import low_sky
from seaglint.air.table.lowtran7 import TableAtmosphere
from seaglint.air.table.profiles import PROFILES
from seaglint.base.conventions import horizon_depression
from seaglint.optics.band import Band, apparent_temperature

BANDS = ((3.5, 5.0), (8.0, 12.0))
MODELS = tuple(PROFILES)

# Apparent temperatures [K] in 3.5-5 and 8-12 um from LOWTRAN7 (cards as in test_table_against_lowtran.py, ITYPE=3) with a user's
# profile of thin layers: levels 2, 6, 15, 30, 50, 75 m below and 2, 6, 15, 30, 50, 80, 120, 170, 250, 350, 500, 700 m above the sensor, at
# it, and each kilometre; between the model's levels temperature is linear, pressure and water vapour exponential. The same with the
# model's own levels only gives LOWTRAN7's model within 0.02 K.
# model, wind [m/s], height [m], elevation: parts of the dip below the horizontal or degrees above it, temperatures.
THIN = [
    ("tropical", 7.0, 5.0, -0.95, 299.668, 299.674),
    ("tropical", 7.0, 5.0, 0.0, 299.641, 299.652),
    ("tropical", 7.0, 100.0, -0.5, 299.128, 299.133),
    ("midlatitude-summer", 7.0, 2.0, -0.1, 294.166, 294.170),
    ("midlatitude-summer", 7.0, 5.0, -0.95, 294.173, 294.178),
    ("midlatitude-summer", 7.0, 5.0, -0.1, 294.153, 294.157),
    ("midlatitude-summer", 7.0, 5.0, 0.0, 294.150, 294.154),
    ("midlatitude-summer", 7.0, 5.0, 0.05, 294.136, 294.137),
    ("midlatitude-summer", 7.0, 30.0, 0.0, 294.037, 294.041),
    ("midlatitude-summer", 7.0, 100.0, -0.95, 293.811, 293.831),
    ("midlatitude-summer", 7.0, 100.0, 0.0, 293.721, 293.725),
    ("midlatitude-winter", 3.0, 5.0, 0.0, 272.035, 271.296),
    ("midlatitude-winter", 3.0, 100.0, -0.1, 271.713, 270.929),
    ("subarctic-summer", 15.0, 5.0, -0.5, 287.164, 287.149),
    ("subarctic-summer", 15.0, 100.0, 0.05, 286.611, 286.566),
    ("subarctic-winter", 7.0, 5.0, 0.0, 257.236, 255.855),
    ("subarctic-winter", 7.0, 100.0, -0.95, 257.338, 256.559),
    ("us-standard-1976", 10.0, 5.0, 0.0, 288.084, 287.914),
    ("us-standard-1976", 10.0, 100.0, -0.1, 287.486, 287.326),
]

THIN_ERROR = (0.03, 0.06)  # K, what the table and the band law leave, most in the dry air of subarctic winter; layers leave up to 2 K

BUMP = 0.1  # K: what may be seen beside the step from sea to sky


def apparent(air, edges, elevation, height):
    band = Band.rectangular(*edges)
    sky = air.sky_radiance(0.5 * np.pi - np.asarray(elevation), 0.0, height)
    return apparent_temperature(sky @ band.weights(air.wavenumber_cm), band, air.wavenumber_cm)


def bump(temperature):
    """How far a profile comes back from its largest or its smallest value so far, whichever is less."""
    return min(np.max(np.maximum.accumulate(temperature) - temperature), np.max(temperature - np.minimum.accumulate(temperature)))


def near(height):
    """Elevations from the sea horizon to 0.1 deg above it [rad]."""
    return np.radians(np.concatenate([[0.0], np.geomspace(1e-4, 0.1, 60)])) - horizon_depression(height)


@pytest.mark.parametrize("row", THIN, ids=lambda r: f"{r[0]}-{r[2]:g}m-{r[3]:g}")
@pytest.mark.parametrize("band", [0, 1], ids=["3.5-5um", "8-12um"])
def test_it_is_lowtran7_with_thin_layers(row, band):
    model, wind, height, where = row[:4]
    elevation = where * horizon_depression(height) if where < 0.0 else np.radians(where)
    air = TableAtmosphere.load(model, wind, BANDS[band])
    assert apparent(air, BANDS[band], [elevation], height)[0] == pytest.approx(row[4 + band], abs=THIN_ERROR[band])


GRID = list(itertools.product(MODELS, (2.0, 3.0, 5.0, 8.0, 15.0, 30.0, 60.0, 100.0), (0.0, 2.0, 7.0, 13.0, 20.0)))
FEW = [(model, height, 7.0) for model, height in zip(MODELS, (2.0, 5.0, 5.0, 15.0, 30.0, 100.0), strict=True)]
CASES = FEW + [pytest.param(*case, marks=pytest.mark.validation) for case in GRID if case not in FEW]


@pytest.mark.parametrize("edges", BANDS, ids=["3.5-5um", "8-12um"])
@pytest.mark.parametrize(("model", "height", "wind"), CASES)
def test_no_line_above_the_sea_horizon(model, height, wind, edges):
    sky = apparent(TableAtmosphere.load(model, wind, edges), edges, near(height), height)
    assert bump(sky) < BUMP
    # Nor a bright band: the horizontal is where layers end, and continuous air goes on as it was within the 0.1 deg.
    assert np.ptp(sky) < 1.0


@pytest.mark.parametrize("model", MODELS)
def test_the_sky_is_no_warmer_than_the_warmest_air(model):
    air = TableAtmosphere.load(model, 7.0, BANDS[0])
    warmest = max(PROFILES[model].temperature_k)
    for height in (2.0, 3.0, 4.0, 5.0, 6.5, 8.0, 15.0, 60.0, 250.0):
        assert np.max(apparent(air, BANDS[0], near(height), height)) < warmest


# LOWTRAN7's own layers, run live: model, wind [m/s], height [m], elevation [deg], 3.5-5 and 8-12 um [K].
LAYERED = [("midlatitude-summer", 7.0, 5.0, 0.5, 292.223, 292.228), ("midlatitude-summer", 7.0, 100.0, 0.5, 291.964, 291.972)]


@pytest.mark.parametrize("row", LAYERED, ids=lambda r: f"{r[2]:g}m")
@pytest.mark.parametrize("band", [0, 1], ids=["3.5-5um", "8-12um"])
def test_from_half_a_degree_up_it_is_lowtran7s_own(row, band):
    air = TableAtmosphere.load(row[0], row[1], BANDS[band])
    assert apparent(air, BANDS[band], np.radians(row[3:4]), row[2])[0] == pytest.approx(row[4 + band], abs=5e-3)


def test_it_goes_over_into_lowtran7s_own_without_steps():
    air = TableAtmosphere.load("us-standard-1976", 7.0, BANDS[0])
    up = np.radians(np.linspace(0.0, 1.0, 201))
    for height in (2.0, 100.0, 200.0):
        sky = apparent(air, BANDS[0], up, height)
        assert np.all(np.diff(sky) < 0.0)
        assert np.max(np.abs(np.diff(sky, 2))) < 2e-3
    for below, above in ((99.99, 100.01), (299.99, 300.01)):
        at = [apparent(air, BANDS[0], -horizon_depression(below) * np.linspace(0.0, 1.0, 21), height) for height in (below, above)]
        np.testing.assert_allclose(*at, atol=0.01)


def test_sensors_from_300_m_up_and_the_sea_itself_see_lowtran7s_sky(monkeypatch):
    air = TableAtmosphere.load("midlatitude-summer", 7.0, BANDS[0])
    zenith = np.radians([90.0, 89.9, 60.0])
    seen = {height: air.sky_radiance(zenith, 0.0, height) for height in (0.0, 99.0, 300.0, 2000.0)}
    monkeypatch.setattr(low_sky, "continuous_over_layered", lambda law, height, elevation: np.full((elevation.size, 1), 2.0))
    for height, sky in seen.items():
        assert np.array_equal(air.sky_radiance(zenith, 0.0, height), sky) == (height != 99.0)


def test_air_of_one_temperature_shines_alike_in_any_layers():
    law = TableAtmosphere.load("tropical", 7.0, BANDS[1])._law
    even = replace(law, absorbers=replace(law.absorbers, temperature=np.full(11, 280.0)))
    elevation = low_sky.nodes(horizon_depression(20.0))
    np.testing.assert_allclose(low_sky.continuous_over_layered(even, 20.0, elevation), 1.0, rtol=1e-9)
    assert np.min(low_sky.continuous_over_layered(law, 20.0, np.zeros(1))) > 1.01
