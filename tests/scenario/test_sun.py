"""The Sun of a date and place against almanac facts."""

from __future__ import annotations

import math

import numpy as np
import pytest

from seaglint.scenario.dated_sun import dated_sun
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


# --- a date and a place for a direction

NEAREST = 0.01  # deg; minutes, places to 1e-4 deg, and the parallax of 0.0024 deg
rng = np.random.default_rng(48)
EVERYWHERE = [(math.degrees(math.acos(up)), azimuth) for up, azimuth in zip(rng.uniform(-1, 1, 40), rng.uniform(0, 360, 40), strict=True)]
LOW = list(zip(rng.uniform(80, 90.2, 20), rng.uniform(0, 360, 20), strict=True))  # where refraction is largest
CORNERS = [(0, 0), (180, 0), (0.3, 45), (90, 0), (90, 90), (90, 180), (90, 270), (89, 90), (89.9, 90.1), (45, 90), (75, 0), (75, 180)]


def beside(zenith, azimuth):
    """Angle between a direction and the Sun at its date and place [deg], and that date and place."""
    moment, latitude, longitude = dated_sun(math.radians(zenith), math.radians(azimuth))
    sun = at(moment.isoformat(), latitude, longitude)
    ends = [
        np.array([math.sin(z) * math.sin(a), math.sin(z) * math.cos(a), math.cos(z)])
        for z, a in ((sun.zenith, sun.azimuth), (math.radians(zenith), math.radians(azimuth)))
    ]
    return math.degrees(2 * math.asin(0.5 * float(np.linalg.norm(ends[0] - ends[1])))), (moment, latitude, longitude)


@pytest.mark.parametrize(("zenith", "azimuth"), EVERYWHERE + LOW + CORNERS)
def test_every_direction_has_a_date_and_a_place(zenith, azimuth):
    angle, (moment, latitude, longitude) = beside(zenith, azimuth)
    assert angle < NEAREST
    assert moment.second == 0
    assert abs(latitude) <= 90
    assert -180 <= longitude <= 180


@pytest.mark.parametrize(("zenith", "azimuth"), EVERYWHERE)
def test_places_of_dates_are_on_the_open_atlantic(zenith, azimuth):
    _, (_, latitude, longitude) = beside(zenith, azimuth)
    assert longitude == pytest.approx(-30.0, abs=1.0)
    # The Sun is due south or north of places at 90 - 23.4 deg at the farthest, where it is on the horizon at the solstice.
    assert abs(latitude) < 67.0


@pytest.mark.parametrize("zenith", [90.3, 90.5, 90.7, 92.0, 95.8])
def test_a_sun_that_has_set_keeps_its_refraction(zenith):
    angle, _ = beside(zenith, 200.0)
    assert angle < NEAREST


def test_the_sun_sets_without_a_step_of_its_zenith_angle():
    """A minute moves the Sun by a quarter of a degree; refraction ends with twilight, where it has no light any more."""
    zenith = np.degrees([at(f"2026-03-20T{18 + m // 60}:{m % 60:02d}:00Z", 0.0, 0.0).zenith for m in range(5, 40)])
    twilight = zenith[zenith < 95.9]
    assert twilight.size > 20
    assert np.diff(twilight) == pytest.approx(0.25, abs=0.06)
    assert zenith[-1] > 97.0
