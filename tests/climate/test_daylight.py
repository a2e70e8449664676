"""Hours drawn by daylight stand for all hours alike."""

from __future__ import annotations

import numpy as np
import pytest

from seaglint.climate.conditions import arc, hours_of_light
from seaglint.climate.ephemeris import Ephemeris, year_span

EVEN = (np.arange(65_536) + 0.5) / 65_536


@pytest.mark.parametrize(
    ("noon", "half", "hours"),
    [
        (12.0, 6.0, (0.0, 24.0)),
        (1.0, 5.0, (0.0, 24.0)),  # from the day before
        (20.0, 9.0, (0.0, 24.0)),  # into the next day
        (-30.0, 4.0, (0.0, 24.0)),
        (23.9, 12.0, (0.0, 24.0)),  # no night
        (5.0, 0.0, (0.0, 24.0)),  # no day
        (3.0, 7.0, (6.0, 18.0)),
        (15.0, 8.0, (20.0, 23.0)),
        (1.0, 5.0, (22.0, 28.0)),  # through midnight, by day
        (14.0, 9.0, (18.0, 40.0)),
    ],
)
def test_weights_undo_the_choice_of_hours(noon, half, hours):
    found = hours_of_light(EVEN, np.full(EVEN.size, noon), np.full(EVEN.size, half), hours)
    assert found.hour.min() >= hours[0]
    assert found.hour.max() < hours[1]
    counted = np.histogram(found.hour, np.linspace(*hours, 25), weights=found.weight)[0] / EVEN.size
    assert counted == pytest.approx(np.full(24, 1 / 24), rel=0.01)  # a class holds 170 points of the night at least
    away = np.abs((found.hour - noon + 12.0) % 24.0 - 12.0)
    assert np.mean(away[EVEN < 15 / 16] <= half + 1e-9) == (1.0 if half > 0.0 else 0.0)


def test_the_arc_holds_nearly_all_of_the_light():
    rng = np.random.default_rng(4)
    first, last = year_span(2025)
    day = np.floor(rng.uniform(first, last, 20_000) / 86_400.0) * 86_400.0
    latitude, longitude, hour = rng.uniform(-75.0, 75.0, day.size), rng.uniform(-180.0, 180.0, day.size), rng.uniform(0.0, 24.0, day.size)
    noon, half = arc(day, latitude, longitude)
    up = Ephemeris.of_year(2025).at(day + 3600.0 * hour, latitude, longitude).zenith < 0.5 * np.pi
    inside = np.abs((hour - noon + 12.0) % 24.0 - 12.0) <= half
    assert np.mean(up & ~inside) < 0.003
    assert np.mean(inside & ~up) < 0.01


def test_noon_and_length_of_the_day_are_those_of_the_ephemeris():
    """Every day of a year: Spencer's series is within 0.009 rad of the declination and 45 s of noon."""
    day = year_span(2025)[0] + 86_400.0 * np.arange(365.0)
    place = {"longitude": np.full(365, -30.0), "pressure": 0.0}
    noon, north = arc(day, np.full(365, 60.0), place["longitude"])
    _, south = arc(day, np.full(365, -60.0), place["longitude"])
    year = Ephemeris.of_year(2025)
    angles = [year.at(day + 3600.0 * noon + seconds, np.full(365, 40.0), **place).azimuth - np.pi for seconds in (-60.0, 60.0)]
    late = -120.0 * angles[0] / (angles[1] - angles[0]) - 60.0  # when the Sun is due south, after the noon told [s]
    assert np.abs(late).max() < 45.0
    zenith = year.at(day + 3600.0 * noon, np.full(365, 40.0), **place).zenith
    declination = np.radians(40.0) - zenith
    # Lengths of the day north and south: their cosines differ by the declination's tangent, and share the elevation at dusk, -1.2 deg.
    cosines = np.cos(np.pi / 12.0 * np.array([north, south]))
    told = np.arctan(0.5 * (cosines[1] - cosines[0]) / np.tan(np.radians(60.0)))
    assert np.abs(told - declination).max() < 0.009
    # Years begin up to a day apart in the Sun's course, which moves the first harmonic; the others stay as they are.
    x = 2.0 * np.pi * np.arange(365.0)[:, None] / 365.2422 * np.arange(1, 5)
    waves = np.concatenate([np.ones((365, 1)), np.cos(x), np.sin(x)], axis=1)
    missed = np.linalg.lstsq(waves, np.stack([told - declination, late * np.pi / 43_200.0], axis=1))[0]
    assert np.all(np.hypot(missed[2:5], missed[6:9]) < (3e-4, 2e-3))
    assert missed[0] == pytest.approx(np.zeros(2), abs=4e-4)
    dusk = np.arcsin(0.5 * cosines.sum(axis=0) * np.cos(np.radians(60.0)) * np.cos(told))
    assert np.degrees(dusk) == pytest.approx(np.full(365, -1.2), abs=1e-6)
