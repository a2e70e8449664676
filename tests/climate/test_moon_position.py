"""The Moon of any time and place against astropy, PyEphem, Meeus' worked example and almanac facts."""

from __future__ import annotations

import math
from datetime import datetime
from pathlib import Path

import numpy as np
import pytest

from seaglint.base.errors import DomainError
from seaglint.climate.ephemeris import Ephemeris
from seaglint.climate.moon_position import MoonEphemeris, _ecliptic_moon, _nutation, bright_limb

PLACE = 0.02  # deg, the bound; 0.003 deg from astropy and 0.004 deg from PyEphem were measured, mostly UT1 - UTC
PHASE = 0.005  # deg; 0.001 deg measured
DISTANCE = 60.0  # km; 41 km measured
ALMANAC = 0.002  # of the phase's cosine


def separation(moon, zenith_deg, azimuth_deg):
    zenith, azimuth = np.radians(zenith_deg), np.radians(azimuth_deg)
    across = np.sin(zenith) * np.sin(moon.zenith) * np.sin(0.5 * (azimuth - moon.azimuth)) ** 2
    return np.degrees(2.0 * np.arcsin(np.sqrt(np.sin(0.5 * (zenith - moon.zenith)) ** 2 + across)))


@pytest.fixture(scope="module")
def table():
    return np.loadtxt(Path(__file__).parent / "data" / "moon.csv", delimiter=",", skiprows=2)


@pytest.fixture(scope="module")
def seen(table):
    return MoonEphemeris.between(table[:, 0].min(), table[:, 0].max()).at(*table[:, :3].T, refracted=False)


def test_places_of_twenty_years_equal_astropys(table, seen):
    assert np.unique(table[:, 1]).size == 50
    assert np.ptp(table[:, 0]) > 19.8 * 365.25 * 86_400.0
    assert separation(seen, table[:, 3], table[:, 4]).max() < PLACE


def test_places_equal_those_of_another_theory(table, seen):
    assert separation(seen, table[:, 7], table[:, 8]).max() < PLACE


def test_phases_and_distances_equal_astropys(table, seen):
    assert np.abs(np.degrees(seen.phase) - table[:, 5]).max() < PHASE
    assert np.abs(seen.distance_m / 1e3 - table[:, 6]).max() < DISTANCE


@pytest.mark.validation
def test_places_equal_the_installed_astropys():
    pytest.importorskip("astropy", reason="astropy is not installed")
    from astropy import units
    from astropy.coordinates import AltAz, EarthLocation, get_body
    from astropy.time import Time
    from astropy.utils import iers

    rng = np.random.default_rng(48)
    first, last = (datetime.fromisoformat(day).timestamp() for day in ("2005-01-01T00:00Z", "2025-01-01T00:00Z"))
    sky = MoonEphemeris.between(first, last)
    with iers.conf.set_temp("auto_download", False):
        for latitude, longitude in zip(np.degrees(np.arcsin(rng.uniform(-1, 1, 50))), rng.uniform(-180, 180, 50), strict=True):
            seconds = rng.uniform(first, last, 100)
            time, place = Time(seconds, format="unix"), EarthLocation.from_geodetic(longitude * units.deg, latitude * units.deg)
            theirs = get_body("moon", time, place).transform_to(AltAz(obstime=time, location=place))
            ours = sky.at(seconds, latitude, longitude, refracted=False)
            assert separation(ours, 90.0 - theirs.alt.deg, theirs.az.deg).max() < PLACE


def test_worked_example_of_meeus():
    # Example 47.a: 1992 April 12, 0 h dynamical time, printed to 1e-6 deg and 0.1 km.
    century = np.array([(2448724.5 - 2451545.0) / 36525.0])
    longitude, latitude, distance = (float(values[0]) for values in _ecliptic_moon(century))
    assert math.degrees(longitude) % 360.0 == pytest.approx(133.162655, abs=2e-6)
    assert math.degrees(latitude) == pytest.approx(-3.229126, abs=2e-6)
    assert distance / 1e3 == pytest.approx(368409.7, abs=0.1)
    # Example 22.a, 1987 April 10, 0 h: -3.788 and 9.443 seconds of arc with all terms; these have 0.5 and 0.1.
    nutation, obliquity = _nutation(np.array([(2446895.5 - 2451545.0) / 36525.0]))
    assert math.degrees(nutation[0]) * 3600.0 == pytest.approx(-3.788, abs=0.5)
    assert math.degrees(obliquity[0]) == pytest.approx(23.443569, abs=0.1 / 3600.0)


# Times of phases from the Astronomical Almanac (minutes), the Moon seen from the Earth's side that faces it.
@pytest.mark.parametrize(
    ("utc", "elongation"),
    [("2026-01-03T10:03Z", 180.0), ("2026-02-17T12:01Z", 0.0), ("2026-03-03T11:38Z", 180.0), ("2026-06-21T21:55Z", 90.0)],
)
def test_phases_of_the_almanac(utc, elongation):
    moon = MoonEphemeris.of_year(2026).at(datetime.fromisoformat(utc).timestamp(), 0.0, 0.0)
    # The phases are defined by ecliptic longitude, so that latitude (5 deg) and parallax (1 deg) remain; at the quarters they remain too.
    assert math.degrees(float(moon.phase[0])) == pytest.approx(180.0 - elongation, abs=6.0)


def test_one_time_equals_an_ephemeris_of_a_year():
    year, times = MoonEphemeris.of_year(2026), 1.77e9 + 1e6 * np.arange(12.0)
    many = year.at(times, 36.8, -30.0)
    for i, time in enumerate(times):
        one = MoonEphemeris.between(time, time).at(time, 36.8, -30.0)
        assert [float(values[0]) for values in one] == pytest.approx([float(values[i]) for values in many], rel=1e-6, abs=2e-7)


def test_refraction_is_the_suns():
    # True minus apparent zenith angle at equal true zenith angles: pvlib's function for the Moon, the kernel for the Sun.
    times = 1.77e9 + 977.0 * np.arange(3000.0)
    sky, sun = MoonEphemeris.of_year(2026), Ephemeris.of_year(2026)
    moon, true = sky.at(times, 20.0, 0.0), sky.at(times, 20.0, 0.0, refracted=False)
    lifted = true.zenith - moon.zenith
    assert np.degrees(lifted.max()) == pytest.approx(0.6, abs=0.1)
    assert np.abs(lifted[np.degrees(true.zenith) > 97.0]).max() < 1e-14
    with_air, without = sun.at(times, 20.0, 0.0), sun.at(times, 20.0, 0.0, pressure=0.0)
    order = np.argsort(without.zenith)
    seen = (np.degrees(true.zenith) < 90.5) & (true.zenith > without.zenith.min())
    expected = np.interp(true.zenith[seen], without.zenith[order], (without.zenith - with_air.zenith)[order])
    assert lifted[seen] == pytest.approx(expected, abs=math.radians(0.003))


def test_a_setting_moon_has_no_jump():
    sky, times = MoonEphemeris.of_year(2026), 1775100000.0 + 5.0 * np.arange(17_280.0)
    zenith = np.degrees(sky.at(times, 36.8, -30.0).zenith)
    near = (np.abs(zenith[1:] - 90.0) < 5.0) & (np.abs(zenith[:-1] - 90.0) < 5.0)
    assert near.sum() > 500
    # The sky turns by 0.021 deg in 5 s. Refraction ended with a jump of 0.58 deg without that of twilight.
    assert np.abs(np.diff(zenith))[near].max() < 0.03


@pytest.mark.parametrize(
    ("sun", "expected"), [((30.0, 90.0), 0.0), ((120.0, 90.0), 180.0), ((60.0, 100.0), 90.0 - 2.5), ((60.0, 80.0), -90.0 + 2.5)]
)
def test_bright_limb_points_to_the_sun(sun, expected):
    # A great circle to a Sun of equal height rises first, by half the difference of azimuths times the cosine of the zenith angle.
    angle = math.degrees(float(bright_limb(math.radians(60.0), math.radians(90.0), *np.radians(sun))))
    assert abs((angle - expected + 180.0) % 360.0 - 180.0) < 0.05


def test_times_outside_are_refused():
    with pytest.raises(DomainError, match="outside the ephemeris"):
        MoonEphemeris.between(0.0, 10.0).at(1e6, 0.0, 0.0)
