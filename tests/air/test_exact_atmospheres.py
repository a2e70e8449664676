"""The cavity and no air: what must hold exactly."""

import numpy as np
import pytest

from seaglint.air.isothermal import IsothermalAtmosphere
from seaglint.air.protocol import Atmosphere, slant_range, wavenumber_grid
from seaglint.air.vacuum import VacuumAtmosphere
from seaglint.base.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.base.errors import DomainError
from seaglint.optics.blackbody import planck_wavenumber
from seaglint.optics.solar_spectrum import exoatmospheric_irradiance

ROUNDING = 1e-12


@pytest.fixture
def cavity() -> IsothermalAtmosphere:
    return IsothermalAtmosphere.for_band(291.0, 3.0, 5.0, extinction_per_m=2e-4)


@pytest.mark.parametrize("range_m", [0.0, 10.0, 1e3, 1e5])
def test_a_black_sea_is_invisible_in_the_cavity(cavity, range_m):
    seen = cavity.path_radiance(30.0, range_m) + cavity.transmittance(30.0, range_m) * planck_wavenumber(cavity.wavenumber_cm, 291.0)
    np.testing.assert_allclose(seen, cavity.sky_radiance(0.3, 0.0), rtol=ROUNDING)


def test_the_cavity_has_no_sun(cavity):
    assert not cavity.solar_irradiance([0.0, 1.0]).any()


def test_extinction_acts_over_the_slant_path(cavity):
    # Looking straight down from h the path is h; two lengths multiply.
    down = cavity.transmittance(5000.0, 0.0)
    np.testing.assert_allclose(down, np.exp(-1.0), rtol=ROUNDING)


@pytest.mark.parametrize("height", [2.0, 100.0, 10e3])
def test_slant_range_closes_the_triangle(height):
    arc = np.array([0.0, 50.0, 5e3, 2e5])
    r, s = EFFECTIVE_EARTH_RADIUS, slant_range(height, arc)
    sensor = np.array([0.0, r + height])
    sea = np.stack([r * np.sin(arc / r), r * np.cos(arc / r)], axis=-1)
    np.testing.assert_allclose(s, np.hypot(*(sea - sensor).T), atol=1e-6)  # metres; the other route loses digits at 7e6 m


def test_vacuum_neither_absorbs_nor_emits():
    air = VacuumAtmosphere.for_band(3.0, 5.0)
    assert np.all(air.transmittance(10.0, [1.0, 1e5]) == 1.0)
    assert not air.path_radiance(10.0, [1.0, 1e5]).any()
    assert not air.sky_radiance([0.0, 1.5], 0.0).any()
    np.testing.assert_array_equal(air.solar_irradiance(1.5), air.solar_irradiance(0.0))
    assert not air.solar_irradiance(1.6).any()


def test_exoatmospheric_sun_looks_like_a_hot_disc():
    # Brightness temperatures of the disc (6.79e-5 sr at 1 au) lie between the CO bands at 2.3 and 4.7 um and the 1.6 um window of
    # the photosphere's H- opacity: 5200-6500 K.
    wavenumber = wavenumber_grid(2.0, 5.0)
    low, high = (6.79e-5 * planck_wavenumber(wavenumber, t) for t in (5200.0, 6500.0))
    sun = exoatmospheric_irradiance(wavenumber)
    assert np.all((sun > low) & (sun < high))


def test_band_irradiance_is_that_of_the_effective_temperature():
    # 5772 K is the effective temperature of the Sun (IAU 2015); the infrared departs from it by a few per cent.
    wavenumber = wavenumber_grid(3.0, 5.0)
    blackbody = np.trapezoid(6.79e-5 * planck_wavenumber(wavenumber, 5772.0), wavenumber)
    assert np.trapezoid(exoatmospheric_irradiance(wavenumber), wavenumber) == pytest.approx(blackbody, rel=0.05)


@pytest.mark.parametrize("make", [lambda: IsothermalAtmosphere.for_band(290.0, 3.0, 5.0), lambda: VacuumAtmosphere.for_band(3.0, 5.0)])
def test_they_answer_the_protocol_with_the_shapes_it_promises(make):
    air = make()
    n = air.wavenumber_cm.size
    assert isinstance(air, Atmosphere)
    assert air.transmittance(10.0, np.ones((3, 2))).shape == (3, 2, n)
    assert air.path_radiance(10.0, 5.0).shape == (n,)
    assert air.solar_irradiance(np.ones(4)).shape == (4, n)
    assert air.sky_radiance(np.ones((2, 2)), 0.0, height=3.0).shape == (2, 2, n)


@pytest.mark.parametrize("bad", [lambda: exoatmospheric_irradiance(100.0), lambda: wavenumber_grid(5.0, 3.0)])
def test_what_no_table_covers_is_refused(bad):
    with pytest.raises(DomainError):
        bad()


@pytest.mark.parametrize("range_m", [-1.0, np.nan])
def test_impossible_ranges_are_refused(cavity, range_m):
    with pytest.raises(DomainError, match="range_m"):
        cavity.transmittance(10.0, range_m)
