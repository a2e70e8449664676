"""Scattered sunlight of a file: what is sampled comes back, between the samples too."""

import math

import numpy as np
import pytest

from seaglint.air.protocol import ScatteredSamples, ScatteredSky
from seaglint.air.scattering.scattered_light import scattered_path, scattered_shares
from seaglint.air.scattering.scattered_tables import SampledLight, ScatteredLight
from seaglint.base.conventions import depression_of_range, horizon_depression, horizon_range
from seaglint.studies.build.profile_air import model_air

HEIGHT, BAND = 30.0, (3.5, 4.2)
AZIMUTH = np.radians([0.0, 2.0, 5.0, 10.0, 15.0, 20.0, 30.0, 45.0, 60.0, 90.0, 120.0, 150.0, 180.0])


@pytest.fixture(scope="module", params=[50.0, 76.0])
def lights(request):
    """Our own light, and the same sampled as a file would have it."""
    air = model_air("midlatitude-summer", 7.0, BAND)
    every = slice(0, air.wavenumber_cm.size)
    weights = np.full(air.wavenumber_cm.size, 5.0)
    sun = math.radians(request.param)
    ours = ScatteredLight(air.scattering(every), weights, HEIGHT, sun)
    arcs = np.concatenate([[1.0], np.geomspace(30.0, 0.999 * horizon_range(HEIGHT), 24)])
    dip = horizon_depression(HEIGHT)
    zenith = 0.5 * np.pi - np.concatenate(
        [[0.5 * np.pi], np.radians(np.concatenate([np.arange(84.0, 4.0, -2.0), np.geomspace(4.0, 0.2, 9)])), [0.0]]
    )
    one = weights / (weights @ weights)  # any spectrum does that adds up to the radiance in band
    path = scattered_path(arcs[:, None], -depression_of_range(HEIGHT, arcs)[:, None], AZIMUTH, ours.path)[..., None] * one
    below = np.append(zenith, 0.5 * np.pi + 0.999 * dip)
    aloft = scattered_shares(0.5 * np.pi - below[:, None], AZIMUTH, ours.sky) * one
    sea = scattered_shares(0.5 * np.pi - zenith[:, None], AZIMUTH, ours.sea_sky) @ ours.sea_sky.spectral
    held = ScatteredSamples(sun, AZIMUTH, arcs, path, (ScatteredSky(0.0, zenith, sea), ScatteredSky(HEIGHT, below, aloft)))
    return ours, SampledLight(held, every, weights, HEIGHT)


def test_between_the_samples_it_is_the_same_light(lights):
    ours, file = lights
    azimuth = np.radians(np.array([0.0, 3.0, 8.0, 25.0, 75.0, 170.0]))
    arcs = np.array([100.0, 900.0, 5000.0, 15000.0])
    elevation = -depression_of_range(HEIGHT, arcs)
    a, b = (scattered_path(arcs[:, None], elevation[:, None], azimuth, light.path) for light in (ours, file))
    np.testing.assert_allclose(b, a, rtol=0.06, atol=1e-5)
    np.testing.assert_allclose(file.paths(arcs, azimuth), b)
    up = np.radians(np.array([0.4, 3.0, 14.0, 40.0, 80.0]))[:, None]
    a, b = (scattered_shares(up, azimuth, light.sky)[..., 0] for light in (ours, file))
    np.testing.assert_allclose(b, a, rtol=0.06, atol=1e-5)
    a, b = (scattered_shares(up, azimuth, light.sea_sky) @ (light.sea_sky.spectral @ ours.weights) for light in (ours, file))
    np.testing.assert_allclose(b, a, rtol=0.06, atol=1e-5)


def test_what_the_file_leaves_out_is_dark(lights):
    _, file = lights
    held = file.samples
    bare = SampledLight(ScatteredSamples(held.solar_zenith, held.azimuth, held.range_m, None, ()), file.grid, file.weights, HEIGHT)
    assert not bare.path.amplitude.any()
    assert not bare.sky.amplitude.any()
    assert not bare.sea_sky.amplitude.any()
    assert bare.sea_sky.spectral.shape[1] == file.weights.size
