"""Air whose gases, rays and scatterers hazes of all winds share, and amounts towards the Sun interpolated for many lines."""

from __future__ import annotations

import numpy as np
import pytest

from seaglint.air.profile.aerosols import HazeWeather
from seaglint.air.profile.air_profile import model_profile
from seaglint.air.profile.air_sums import AirSums, GasRay, GasRays
from seaglint.air.profile.profile_scattering import scattering_air
from seaglint.air.protocol import wavenumber_grid
from seaglint.studies.build.profile_air import model_air

BANDS = [(3.5, 4.15), (8.0, 12.0)]


def haze(wind: float) -> HazeWeather:
    return HazeWeather(wind=wind, wind_24h=wind)


@pytest.mark.parametrize("edges", BANDS)
def test_rays_shared_by_winds_are_those_of_one_wind_alone(edges):
    draw, grid, profile = np.random.default_rng(3), wavenumber_grid(*edges), model_profile("midlatitude-winter")
    rays = GasRays()
    height, zeniths = float(draw.uniform(5.0, 3000.0)), [float(z) for z in draw.uniform(0.0, 1.55, 4)]
    AirSums(profile, haze(2.0), grid, rays=rays).along_each(height, zeniths)
    shared, alone = AirSums(profile, haze(17.0), grid, rays=rays), AirSums(profile, haze(17.0), grid)
    for zenith, one in zip(zeniths, shared.along_each(height, zeniths), strict=True):
        other = alone.along(height, zenith)
        np.testing.assert_array_equal(one.emitted, other.emitted)
        np.testing.assert_array_equal(one.transmittance, other.transmittance)
        # another quadrature of the same way: the whole amounts at once
        np.testing.assert_allclose(shared.passed(height, zenith), other.transmittance[-1], rtol=1e-9, atol=1e-12)
    np.testing.assert_array_equal(shared.between(height, 0.0, 4.0 * height), alone.between(height, 0.0, 4.0 * height))


def test_winds_of_one_air_differ():
    grid, rays = wavenumber_grid(3.5, 4.15), GasRays()
    calm, storm = (AirSums(model_profile("tropical"), haze(w), grid, rays=rays).passed(0.0, 1.3) for w in (1.0, 19.0))
    assert np.all(storm <= calm)
    assert storm.mean() < 0.98 * calm.mean()


def test_the_oldest_rays_go_when_there_are_too_many(monkeypatch):
    monkeypatch.setattr("seaglint.air.profile.air_sums.MOST_BYTES", 3000)
    rays, made = GasRays(), []

    def make(number: int) -> GasRay:
        made.append(number)
        return GasRay(None, np.zeros(50), np.zeros(50), np.zeros(100))

    for number in (0, 1, 0, 1, 2, 0):
        rays.get(number, lambda number=number: make(number))
    assert made == [0, 1, 0, 1, 2, 0] or made == [0, 1, 2, 0]  # 1600 bytes each: one stays, or two
    assert rays._size <= 3000


@pytest.mark.parametrize("sun", [4.0, 48.0, 71.0, 85.0, 87.5])
def test_amounts_towards_the_sun_by_table_are_those_ray_by_ray(sun):
    draw = np.random.default_rng(int(sun))
    air = scattering_air(model_profile("subarctic-summer"), haze(6.0), wavenumber_grid(3.5, 4.15), continuous=True)
    lines = np.stack([draw.uniform(0.0, 0.5 * np.pi, 40), draw.uniform(0.0, np.pi, 40), np.full(40, np.radians(sun))], axis=1)
    table, exact = air.amplitudes(0.0, lines, tabulated=True)[0], air.amplitudes(0.0, lines)[0]
    # What scatters from a line into the sensor, all kinds together; the bound of the docstring.
    np.testing.assert_allclose(table.sum(axis=1), exact.sum(axis=1), rtol=4e-6, atol=1e-12 * exact.max())


def test_the_same_air_is_the_same_object_and_its_scatterers_too():
    one, other = (model_air("us-standard-1976", 6.5, (3.5, 4.15)) for _ in range(2))
    assert one is other
    assert one.scattering(slice(0, 10)) is one.scattering(slice(0, 10))
    assert one.sums._rays is model_air("us-standard-1976", 9.5, (3.5, 4.15)).sums._rays
