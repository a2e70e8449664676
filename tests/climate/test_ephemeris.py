"""The Sun of any time and place against the algorithm's own test point and against the scenario's Sun."""

from __future__ import annotations

import math
from datetime import UTC, datetime

import numpy as np
import pytest

from seaglint.base.errors import DomainError
from seaglint.climate.ephemeris import Ephemeris
from seaglint.scenario.load import parse_scenario
from seaglint.scenario.sun import sun_position

NREL = 0.001  # deg, asked of every path; the algorithm states 0.0003 deg


@pytest.fixture(scope="module")
def year():
    return Ephemeris.of_year(2026)


def test_test_point_of_the_algorithm():
    # Reda and Andreas 2004, Table A5.1: 2003-10-17 12:30:30 at UTC-7.
    time = datetime(2003, 10, 17, 19, 30, 30, tzinfo=UTC).timestamp()
    sun = Ephemeris.of_year(2003).at(time, 39.742476, -105.1786, height=1830.14, pressure=820.0, temperature=11.0)
    assert math.degrees(sun.zenith[0]) == pytest.approx(50.111622, abs=NREL)
    assert math.degrees(sun.azimuth[0]) == pytest.approx(194.340241, abs=NREL)
    assert sun.irradiance_factor[0] == pytest.approx(0.9965422974**-2, rel=1e-7)


@pytest.mark.parametrize("utc", ["2026-01-01T00:00:00Z", "2026-03-20T14:46:00Z", "2026-06-21T04:10:00Z", "2026-12-31T23:59:59Z"])
@pytest.mark.parametrize(("latitude", "longitude"), [(60.0, -20.0), (-35.0, 150.0), (0.0, 179.9)])
def test_equals_the_scenarios_sun(year, utc, latitude, longitude):
    one = sun_position(parse_scenario({"time": {"utc": utc}, "place": {"latitude_deg": latitude, "longitude_deg": longitude}}))
    many = year.at(datetime.fromisoformat(utc).timestamp(), latitude, longitude)
    assert many.zenith[0] == pytest.approx(one.zenith, abs=1e-8)
    assert many.azimuth[0] == pytest.approx(one.azimuth, abs=1e-7)
    assert many.irradiance_factor[0] == pytest.approx(one.irradiance_factor, rel=1e-7)


def test_longitudes_of_both_conventions_are_one_place(year):
    time = year.first + 86_400.0 * np.arange(3) + 50_000.0
    west, east = year.at(time, 40.0, -75.0), year.at(time, 40.0, 285.0)
    assert west.zenith == pytest.approx(east.zenith, abs=1e-9)
    # and the sign matters: the morning of the one is the afternoon of the other
    assert np.all(year.at(time, 40.0, 75.0).azimuth > math.pi)
    assert np.all(west.azimuth < math.pi)


def test_times_outside_are_refused(year):
    with pytest.raises(DomainError, match="outside the ephemeris"):
        year.at(year.last + 1e6, 0.0, 0.0)
