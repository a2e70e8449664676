"""Directions with the least glint: against the likelihood of single looks, mirrored Suns, ties, and a night."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq

import seaglint as sg
from seaglint.base.errors import DataError, ScenarioError
from seaglint.climate.ephemeris import Ephemeris
from seaglint.climate.look_chances import BearingRange, alike
from seaglint.climate.weather_table import WeatherTable
from seaglint.plot.likelihood_maps import draw_best
from seaglint.scenario.load import parse_scenario
from seaglint.studies.likelihood.best_looks import best_looks
from seaglint.studies.likelihood.glint_chance import likelihood

WINDS = WeatherTable({"wind_speed_m_s": np.array([2.0, 5.0, 9.0]), "cloud_cover": np.array([0.1, 0.4, 0.7])})


def scenario(wanted=None, **more):
    place = {"place": {"latitude_deg": 40.0, "longitude_deg": -30.0}}
    return parse_scenario({"atmosphere": {"source": "none"}} | place | more | {"likelihood": {"depression_deg": [2, 8]} | (wanted or {})})


@pytest.fixture(scope="module")
def june():
    return best_looks(scenario({"threshold_w_m2_sr": [0.25, 2.5], "hours_utc": [6, 18]}), date="2026-06-21", weather=WINDS)


@pytest.mark.parametrize(("hour", "bearing", "depression"), [(8, 70, 0), (9, 90, 3), (10, 90, 6), (18, 290, 3)])
def test_a_cell_has_the_likelihood_of_its_look(june, hour, bearing, depression):
    at = june.hour_utc.tolist().index(hour)
    below, aside = june.depression_deg[depression], (bearing - june.sun_azimuth_deg[at] + 180) % 360 - 180
    look = {"depression_deg": [below, below], "azimuth_from_sun_deg": [aside, aside], "threshold_w_m2_sr": [0.25, 2.5], "samples": 16_384}
    alone = likelihood(scenario(look, time={"utc": f"2026-06-21T{hour:02d}:00:00Z"}), weather=WINDS)
    chances = june.probability[:, at, depression, bearing // 10]
    # 1024 Sobol points: a single direction errs by 0.005 at most, measured against 16 384.
    assert chances == pytest.approx([estimate.value for estimate in alone.estimates], abs=0.005)
    assert chances[0] > 0.01


def test_azimuths_from_the_sun_are_clockwise(june):
    for hour in range(june.hour_utc.size):
        back = (june.from_sun(hour) + june.sun_azimuth_deg[hour]) % 360.0
        assert np.cos(np.radians(back - 10.0 * np.arange(36))) == pytest.approx(1.0, abs=1e-9)
    row = june.chance(0, 0, 0, 9)
    assert (row.azimuth_from_sun_deg + june.sun_azimuth_deg[0]) % 360.0 == pytest.approx(row.bearing_deg)


def test_chances_are_mirrored_with_the_sun():
    # At the longitude where the Sun is in the south at 12 UTC, the hours before and after it have mirrored Suns.
    noon = np.datetime64("2026-06-21T12:00:00").astype("datetime64[s]").astype(np.float64)
    sky = Ephemeris.between(noon, noon)
    place = {"latitude_deg": 40.0, "longitude_deg": brentq(lambda east: sky.at(noon, 40.0, east).azimuth[0] - np.pi, -3.0, 3.0)}
    looks = best_looks(scenario({"depression_deg": [4, 4]}, place=place), date="2026-06-21", weather=WINDS, samples=4096)
    hours = looks.hour_utc.tolist()
    for hour in (5, 6, 7, 8):
        before, after = (looks.probability[0, hours.index(h), 0] for h in (hour, 24 - hour))
        # The bearing 10 k deg is mirrored to -10 k deg; the Suns agree within 0.02 deg, and 4096 draws of the wind err by 0.002.
        assert after == pytest.approx(np.roll(before[::-1], 1), abs=0.01)
        assert before.max() > 0.1


def test_the_best_look_is_the_middle_of_the_widest_range(june):
    for t in range(2):
        best, worst = june.best(t), june.worst(t)
        assert best.probability <= june.probability[t].min() + 1.0 / june.samples
        assert worst.probability == june.probability[t].max()
        assert abs(worst.azimuth_from_sun_deg) <= 10.0
    for at, row in enumerate(june.best_by_hour(0)):
        first, last = row.bearings_alike_deg
        width = (last - first) % 360.0 if last - first < 360.0 else 360.0
        assert width >= 180.0
        assert abs(row.azimuth_from_sun_deg) > 170.0  # glint is narrow, so that the middle is opposite to the Sun
        assert row.probability_towards_sun >= june.probability[0, at].min()


@pytest.mark.parametrize(
    ("chosen", "expected"),
    [
        ([0, 1, 1, 1, 0, 1], BearingRange(2, 1, 3)),
        ([1, 1, 0, 0, 1, 1], BearingRange(5, 4, 4)),
        ([1, 0, 0, 0, 0, 0], BearingRange(0, 0, 1)),
        ([1, 1, 1, 1, 1, 1], BearingRange(4, 1, 6)),
    ],
)
def test_ranges_go_around_the_circle(chosen, expected):
    assert alike(np.array(chosen, dtype=bool), 4) == expected


def test_all_depressions_of_a_trajectory_are_one_look(june):
    way = best_looks(
        scenario({"threshold_w_m2_sr": [0.25], "case": "trajectory", "clouds": "cover", "hours_utc": [6, 18]}),
        date="2026-06-21",
        weather=WINDS,
    )
    assert way.probability.shape[2] == 1
    assert way.best(0).depression_deg is None
    # Any depression exceeds more often than the best of seven fixed ones.
    assert np.all(way.probability[0, :, 0] >= june.probability[0].max(axis=1) - 0.005)
    assert len(draw_best(way).axes) == 2


def test_a_night_has_no_looks():
    looks = best_looks(scenario(place={"latitude_deg": 80.0, "longitude_deg": 0.0}), date="2026-12-21", weather=WINDS)
    assert looks.rows() == []
    assert looks.as_dict()["best"] == []
    assert looks.lines() == ["2026-12-21: the Sun is not up at any full hour of [likelihood] hours_utc; no glint in any direction"]
    assert draw_best(looks).axes


def test_looks_at_the_sky_are_no_advice():
    looks = best_looks(scenario({"depression_deg": [-5, 5], "hours_utc": [13, 15]}), date="2026-06-21", weather=WINDS, samples=64)
    assert looks.hour_utc.tolist() == [13.0, 14.0, 15.0]
    assert looks.depression_deg[0] > 0.0
    with pytest.raises(ScenarioError, match=r"is above the horizon; give depressions above 0\.1"):
        best_looks(scenario({"depression_deg": [-5, 0.05]}), date="2026-06-21", weather=WINDS)


@pytest.mark.parametrize(
    ("tables", "date", "message"),
    [
        ({}, None, "time is missing: the best look"),
        ({}, "2026-13-01", "date = 2026-13-01: is no date; write it as 2026-06-21"),
        ({}, "1700-01-01", "outside the years 1800 to 2200"),
        ({"place": None, "likelihood": {"latitudes_deg": [40, 50], "longitudes_deg": [-40, -30]}}, "2026-06-21", "searched at one place"),
        ({"sun": {"zenith_deg": 50}, "place": None}, "2026-06-21", "place is missing"),
    ],
)
def test_missing_places_and_dates_are_told(tables, date, message):
    made = {"place": {"latitude_deg": 40.0, "longitude_deg": -30.0}, "likelihood": {}} | tables
    with pytest.raises((ScenarioError, DataError), match=message):
        best_looks(parse_scenario({name: value for name, value in made.items() if value is not None}), date=date, weather=WINDS)


def test_several_results_at_once_are_refused():
    with pytest.raises(DataError, match="`by_month` and `best` are given"):
        sg.likelihood(scenario(), best=True, by_month=True)
    with pytest.raises(DataError, match="date = 2026-06-21: is for `best` alone"):
        sg.likelihood(scenario(), date="2026-06-21")
