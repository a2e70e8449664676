"""The Sun of a date and place against almanac facts."""

from __future__ import annotations

import math

import pytest

from seaglint.scenario.load import parse_scenario
from seaglint.scenario.sun import sun_position

ALMANAC = 0.02  # deg; the facts below are rounded to about 0.01 deg
REFRACTION = 0.05  # deg; the standard atmosphere's bending above 20 deg of elevation


def at(utc, latitude, longitude):
    return sun_position(parse_scenario({"time": {"utc": utc}, "place": {"latitude_deg": latitude, "longitude_deg": longitude}}))


def test_given_angles_are_at_one_astronomical_unit():
    sun = sun_position(parse_scenario({"sun": {"zenith_deg": 60, "azimuth_deg": 90}}))
    assert (sun.zenith, sun.azimuth, sun.irradiance_factor) == (pytest.approx(math.radians(60)), pytest.approx(math.radians(90)), 1.0)


def test_equinox_noon_on_the_equator_is_overhead():
    # March equinox 2026: 20 March 14:46 UTC; the Sun crosses the meridian of 40 deg W about then (equation of time -7.4 min).
    sun = at("2026-03-20T14:46:00Z", 0.0, -15 * (14 + 46 / 60 - 12) + 7.4 / 4)
    assert math.degrees(sun.zenith) == pytest.approx(0.0, abs=0.1)


def test_solstice_noon_height_is_latitude_minus_obliquity():
    # Obliquity 23.436 deg; at local noon in June the Sun stands south of 50 deg N at that zenith distance.
    sun = at("2026-06-21T12:01:50Z", 50.0, 0.0)
    assert math.degrees(sun.zenith) == pytest.approx(50.0 - 23.436, abs=ALMANAC + REFRACTION)
    assert math.degrees(sun.azimuth) == pytest.approx(180.0, abs=0.2)


@pytest.mark.parametrize(("utc", "distance"), [("2026-01-03T17:15:00Z", 0.98330), ("2026-07-06T17:30:00Z", 1.01664)])
def test_distance_at_perihelion_and_aphelion(utc, distance):
    sun = at(utc, 0.0, 0.0)
    assert sun.distance_au == pytest.approx(distance, abs=5e-5)
    assert sun.irradiance_factor == pytest.approx(distance**-2, rel=1e-4)


def test_morning_sun_is_in_the_east():
    assert math.degrees(at("2026-03-20T08:00:00Z", 0.0, 0.0).azimuth) == pytest.approx(90.0, abs=1.0)


def test_midnight_sun_is_below_the_horizontal():
    assert math.degrees(at("2026-03-20T00:00:00Z", 0.0, 0.0).zenith) > 170.0
