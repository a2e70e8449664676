"""Hours drawn by daylight stand for all hours alike."""

from __future__ import annotations

import numpy as np
import pytest

from seaglint.weather.daylight import arc, hours_of_light
from seaglint.weather.ephemeris import Ephemeris, year_span

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
