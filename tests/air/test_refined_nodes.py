"""Nodes that splines of the air add where its rays change fast, and what is left between them."""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from seaglint.air.profile import bent_ray
from seaglint.air.profile.aerosols import HazeWeather
from seaglint.air.profile.air_profile import model_profile, sounding_profile
from seaglint.air.profile.air_sums import AirSums
from seaglint.air.profile.marine_layer import with_marine_layer
from seaglint.air.profile.profile_atmosphere import LIMIT, MOST_TIMES, ProfileAtmosphere, refined_nodes
from seaglint.air.protocol import slant_range, wavenumber_grid
from seaglint.base.conventions import horizon_depression, horizon_range
from seaglint.optics.blackbody import planck_wavenumber

HAZE = HazeWeather(wind=7.0, wind_24h=7.0)


def absolute(splined, values):
    return np.abs(splined - values)[:, 0]


@pytest.mark.parametrize("corner", [0.5, 0.371, 0.93])
def test_nodes_gather_at_a_corner(corner):
    first = np.linspace(0.0, 1.0, 31)
    found = refined_nodes(first, lambda x: 8.0 * np.abs(x - corner)[:, np.newaxis], absolute)
    x = np.linspace(0.0, 1.0, 4001)
    splined = CubicSpline(found.place, found.value, axis=0)(x)
    assert np.max(absolute(splined, 8.0 * np.abs(x - corner)[:, np.newaxis])) < 1.5 * LIMIT
    assert found.residual == 0.0
    assert found.place.size < 60


def test_smooth_values_cost_no_node_more():
    first = np.linspace(0.0, 1.0, 31)
    assert refined_nodes(first, lambda x: 3.0 * np.sin(7.0 * x)[:, np.newaxis], absolute).place.size == 31


def test_what_cannot_be_splined_is_told_and_bounded():
    """White noise of 1 K."""
    first = np.linspace(0.0, 1.0, 31)
    noise = np.random.default_rng(3)
    found = refined_nodes(first, lambda x: noise.standard_normal((x.size, 1)), absolute)
    assert found.residual > 0.5
    assert found.place.size <= MOST_TIMES * 31


def winter(levels=4185):
    """Sounding of thousands of levels with an inversion, and waves of 0.3 K that a radiosonde has."""
    base = model_profile("subarctic-winter")
    z = np.linspace(0.0, 30e3, levels)
    kelvin = np.interp(z, base.height, base.temperature) + 6.0 * np.exp(-(((z - 700.0) / 300.0) ** 2)) + 0.3 * np.sin(z / 120.0)
    humidity = np.interp(z, base.height, base.relative_humidity) * (1.0 + 0.2 * np.sin(z / 170.0))
    steps = -9.80665 * np.diff(z) / (287.05 * 0.5 * (kelvin[1:] + kelvin[:-1]))
    pressure = 1013.0 * np.exp(np.concatenate([[0.0], np.cumsum(steps)]))
    return sounding_profile("winter", "subarctic-winter", z, pressure, kelvin, humidity)


def duct():
    """Warm and dry air above 80 m, which bends rays more than the Earth is round."""
    base = model_profile("tropical")
    z = np.concatenate([np.linspace(0.0, 200.0, 81), np.linspace(250.0, 20e3, 40)])
    step = 1.0 / (1.0 + np.exp(-(z - 80.0) / 5.0))
    kelvin = np.interp(z, base.height, base.temperature) + 4.0 * step
    humidity = np.interp(z, base.height, base.relative_humidity) * (1.0 - 0.5 * step)
    steps = -9.80665 * np.diff(z) / (287.05 * 0.5 * (kelvin[1:] + kelvin[:-1]))
    pressure = 1013.0 * np.exp(np.concatenate([[0.0], np.cumsum(steps)]))
    return sounding_profile("duct", "tropical", z, pressure, kelvin, humidity)


AIRS = {
    "tropical": lambda: model_profile("tropical"),
    "subarctic-winter": lambda: model_profile("subarctic-winter"),
    "cold-sea": lambda: with_marine_layer(model_profile("midlatitude-summer"), 5.0, 285.0, 3.0),
    "duct": duct,
    "winter": winter,
}


def band_kelvin(nu, light):
    """Temperature of a black body of the same band radiance [K]."""
    kelvin = np.linspace(100.0, 330.0, 2301)
    return np.interp(np.sum(light, axis=-1), np.sum(planck_wavenumber(nu, kelvin[:, np.newaxis]), axis=1), kelvin)


@pytest.mark.parametrize("band", [(3.0, 5.0), (8.0, 12.0)], ids=["mwir", "lwir"])
@pytest.mark.parametrize("kind", AIRS)
def test_splines_follow_rays_whatever_the_profile(kind, band):
    """Three heights by chance, low, in the boundary layer and of an aircraft. The cold sky above 8 km counts by its own low temperature."""
    nu, rng = wavenumber_grid(*band), np.random.default_rng(len(kind) + int(band[0]))
    air = ProfileAtmosphere(AIRS[kind](), HAZE, nu)
    sea = planck_wavenumber(nu, air.sums.profile.temperature[0])
    for low, high in ((3.0, 60.0), (60.0, 1500.0), (8e3, 20e3)):
        height = float(np.exp(rng.uniform(np.log(low), np.log(high))))
        dip = horizon_depression(height)
        elevation = np.concatenate([-dip * rng.uniform(0.01, 0.99, 20), rng.uniform(0.0, 0.2, 8), rng.uniform(0.2, 1.5, 4)])
        bent = np.where(elevation < 0.0, elevation * air.sums.air.dip(height) / dip, elevation)
        sky = band_kelvin(nu, [air.sums.along(height, 0.5 * np.pi - float(e)).emitted for e in bent])
        off = np.abs(band_kelvin(nu, air.sky_radiance(0.5 * np.pi - elevation, 0.0, height)) - sky)
        assert off.max() < (0.015 if high < 8e3 else 0.06)
        arc = horizon_range(height) * rng.uniform(0.02, 0.99, 16)
        tau, light = air.path(height, arc)
        own = [air.sums.between(height, 0.0, float(s)) for s in slant_range(height, arc)]
        seen = band_kelvin(nu, light + tau * sea) - band_kelvin(nu, [path + share * sea for share, path in own])
        assert np.abs(seen).max() < 0.012


@pytest.mark.parametrize("band", [(3.0, 5.0), (8.0, 12.0)], ids=["mwir", "lwir"])
def test_sums_through_many_levels_are_those_of_finer_pieces(band, monkeypatch):
    """Paths straight and slanting down to the sea, skies and rays past the air below, against pieces of 10 m with every level a node."""
    nu, profile = wavenumber_grid(*band), winter()
    sea = planck_wavenumber(nu, profile.temperature[0])
    sums = AirSums(profile, HAZE, nu)

    def seen():
        paths = [sums.between(h, 0.0, s) for h, s in ((100.0, 3e3), (3e3, 3.1e3), (8e3, 9e3), (20e3, 40e3))]
        skies = [sums.along(h, z).emitted for h, z in ((10.0, 1.0), (10.0, 1.55), (900.0, 1.57), (3e3, 1.56), (3e3, 1.59))]
        return band_kelvin(nu, [*(light + tau * sea for tau, light in paths), *skies])

    own = seen()
    monkeypatch.setattr(bent_ray, "MOST_NODE_LEVELS", 10**6)
    monkeypatch.setattr(bent_ray, "GROWTH", 1.05)
    assert np.abs(own - seen()).max() < 0.01


@pytest.mark.parametrize("seed", range(4))
def test_the_sky_next_to_the_horizon_does_not_need_the_rest(seed):
    """Spectra of a part of the sky alone, against those of the whole sky: the end of their spline is eight rays away."""
    rng = np.random.default_rng(seed)
    models = ("tropical", "midlatitude-summer", "midlatitude-winter", "subarctic-winter", "us-standard-1976")
    wind, height = rng.uniform(0.0, 18.0), float(np.exp(rng.uniform(np.log(2.0), np.log(3000.0))))
    nu = wavenumber_grid(*((3.5, 5.0) if seed % 2 else (8.0, 12.0)))
    profile, haze = model_profile(str(rng.choice(models))), HazeWeather(wind=wind, wind_24h=wind)
    for top in (-1e-5, np.radians(0.2), np.radians(3.0)):
        zenith = 0.5 * np.pi - np.linspace(-horizon_depression(height), top, 200)
        alone = ProfileAtmosphere(profile, haze, nu).sky_radiance(zenith, 0.0, height)
        whole = ProfileAtmosphere(profile, haze, nu).sky_radiance(np.append(zenith, 0.0), 0.0, height)[:-1]
        # a millionth of a kelvin of a sky of 250 K at 12 um, less of shorter waves
        np.testing.assert_allclose(alone, whole, rtol=2e-8)
