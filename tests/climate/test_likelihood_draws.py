"""Scrambled points, intervals, laws of time, place, rows and clouds of the likelihood's draws."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import chi2, ttest_1samp

from seaglint.base.errors import DomainError
from seaglint.climate.conditions import GeographicRegion, Times, _nearest, clear_line, conditions, draw_pairs, illuminated, months_of
from seaglint.climate.draws import SamplingPlan, estimate, strata
from seaglint.climate.weather_table import WeatherTable


@pytest.mark.parametrize("samples", [256, 1000, 65_536, 100_000, 1_000_000])
def test_plan_has_what_is_asked_and_little_more(samples):
    plan = SamplingPlan.of(samples)
    assert samples <= plan.total < 1.07 * samples
    assert plan.scramblings >= 16
    assert plan.points & (plan.points - 1) == 0


def test_points_depend_on_the_seed_alone():
    plan = SamplingPlan.of(1024)
    assert np.array_equal(plan.uniform(3, 5), plan.uniform(3, 5))
    assert not np.array_equal(plan.uniform(3, 5), plan.uniform(3, 6))


@pytest.mark.parametrize("certain", [0.0, 1.0])
def test_certainty_has_an_interval_to_one_side(certain):
    found = estimate(np.full(4096, certain), SamplingPlan(16, 256))
    assert found.value == certain
    assert (found.low, found.high) == pytest.approx((max(certain - 3 / 4096, 0.0), min(certain + 3 / 4096, 1.0)))


def test_few_hits_have_the_interval_of_their_count():
    values = np.zeros(4096)
    values[[7, 1000, 3000]] = 1.0
    found = estimate(values, SamplingPlan(16, 256))
    # Poisson, 3 counts, 95 %: 0.619 to 8.767 (Garwood 1936)
    assert found.low * 4096 <= 0.619
    assert found.high * 4096 >= 8.76


@pytest.mark.validation
@pytest.mark.parametrize("chance", [0.03, 0.4])
def test_intervals_cover_as_they_say(chance):
    # 1000 repeats at 95 %: standard error 0.7 %. The set is a quarter disc's share of the square, so that no lattice fits it.
    plan, radius = SamplingPlan(16, 64), np.sqrt(4.0 * chance / np.pi)
    covered = 0
    for seed in range(1000):
        u = plan.uniform(2, seed)
        found = estimate((u[:, 0] ** 2 + u[:, 1] ** 2 < radius**2).astype(float), plan)
        covered += found.low <= chance <= found.high
    assert 930 <= covered <= 970


def test_months_keep_their_order():
    times = Times(2025, (2,)).draw(np.array([0.0, 0.999]), np.array([0.0, 0.5]))
    assert times.astype("datetime64[s]").astype(str).tolist() == ["2025-02-01T00:00:00", "2025-02-28T12:00:00"]
    assert months_of(times).tolist() == [2, 2]


def test_months_draw_their_own_rows_and_hours_the_nearest():
    wind = np.arange(1.0, 49.0)
    table = WeatherTable(
        {
            "wind_speed_m_s": wind,
            "cloud_cover": np.zeros(48),
            "month": np.repeat(np.arange(1.0, 13.0), 4),
            "hour_utc": np.tile([0.0, 6.0, 12.0, 18.0], 12),
        }
    )
    rng = np.random.default_rng(1)
    u = {name: rng.random(2000) for name in ("row", "cover", "day", "hour", "across", "along")}
    found = conditions(table, u, Times(2025), GeographicRegion(40.0, 50.0, -30.0, -10.0))
    assert np.array_equal(table["month"][found.rows], months_of(found.time))
    away = np.abs((found.time % 86_400.0 / 3600.0 - table["hour_utc"][found.rows] + 12.0) % 24.0 - 12.0)
    assert away.max() <= 3.0


def test_places_of_a_region_are_even_by_area_and_cross_the_date_line():
    u = np.linspace(0.0, 1.0, 10_001)[:-1]
    latitude, longitude = GeographicRegion(0.0, 90.0, 170.0, -170.0).draw(u, u)
    assert np.mean(latitude < 30.0) == pytest.approx(0.5, abs=1e-3)  # half of a hemisphere lies below 30 deg
    assert np.all((longitude >= 170.0) | (longitude <= -170.0))
    assert -180.0 <= longitude.min() < longitude.max() < 180.0
    assert np.mean(longitude > 0.0) == pytest.approx(0.5, abs=1e-3)


def test_rows_places_bring_their_month_and_hour():
    table = WeatherTable(
        {
            "wind_speed_m_s": np.array([3.0, 8.0]),
            "cloud_cover": np.zeros(2),
            "month": np.array([1.0, 7.0]),
            "hour_utc": np.array([0.0, 12.0]),
            "latitude_deg": np.array([10.0, 50.0]),
            "longitude_deg": np.array([0.0, -20.0]),
        }
    )
    rng = np.random.default_rng(1)
    u = {name: rng.random(500) for name in ("row", "cover", "day", "hour", "across", "along")}
    found = conditions(table, u, Times(2025), None)
    assert np.array_equal(months_of(found.time), np.where(found.rows == 0, 1, 7))
    assert np.array_equal(found.latitude, np.where(found.rows == 0, 10.0, 50.0))
    noon = found.time[found.rows == 1] % 86_400.0 / 3600.0
    assert np.all((noon >= 6.0) & (noon <= 18.0))
    with pytest.raises(DomainError, match="no row of the weather table is of March"):
        conditions(table, u, Times(2025, (3,)), None)


EVEN = (np.arange(2**16) + 0.5) / 2**16


def _hours_counted(when, place, by_daylight):
    """Share of the draws in each hour of the day."""
    table = WeatherTable({"wind_speed_m_s": np.ones(1), "cloud_cover": np.zeros(1)})
    u = dict.fromkeys(("row", "cover", "hour", "across", "along"), EVEN) | {"day": np.random.default_rng(3).permutation(EVEN)}
    found = conditions(table, u, when, place, by_daylight=by_daylight)
    weight = np.ones(EVEN.size) if found.weight is None else found.weight
    assert np.sum(weight[months_of(found.time) != 6]) < 1e-3 * weight.sum()
    return np.histogram(found.time % 86_400.0 / 3600.0, np.arange(25), weights=weight)[0] / weight.sum()


@pytest.mark.parametrize("by_daylight", [False, True])
@pytest.mark.parametrize("place", [(50.0, -20.0), (10.0, 170.0)])  # night and day at midnight UTC
@pytest.mark.parametrize(("hours", "pieces"), [((22.0, 4.0), [(22.0, 24.0), (0.0, 4.0)]), ((20.0, 12.0), [(20.0, 24.0), (0.0, 12.0)])])
def test_hours_through_midnight_are_two_pieces_by_their_lengths(hours, pieces, place, by_daylight):
    whole = _hours_counted(Times(2025, (6,), hours), place, by_daylight)
    lengths = [high - low for low, high in pieces]
    parts = [_hours_counted(Times(2025, (6,), piece), place, by_daylight) for piece in pieces]
    assert whole == pytest.approx(np.average(parts, axis=0, weights=lengths), rel=0.03, abs=1e-9)


def test_rows_of_hours_through_midnight():
    hour = np.array([21.9, 22.0, 23.5, 24.0, 0.0, 4.0, 4.1, 12.0])
    table = WeatherTable(
        {
            "wind_speed_m_s": np.arange(1.0, 9.0),
            "cloud_cover": np.zeros(8),
            "month": np.full(8, 7.0),
            "hour_utc": hour,
            "latitude_deg": np.zeros(8),
            "longitude_deg": np.zeros(8),
        }
    )
    rng = np.random.default_rng(1)
    u = {name: rng.random(500) for name in ("row", "cover", "day", "hour", "across", "along")}
    assert set(conditions(table, u, Times(2025, hours=(22.0, 4.0)), None).rows.tolist()) == {1, 2, 3, 4, 5}
    with pytest.raises(DomainError, match="between 13 and 20 h"):
        conditions(table, u, Times(2025, hours=(13.0, 20.0)), None)


def test_pairs_have_the_tables_law():
    # Two-dimensional: chi-square of 40 rows at 40 000 plain draws; 39 degrees of freedom, 1e-4 level 77.
    rng = np.random.default_rng(2)
    weight = rng.random(40)
    table = WeatherTable({"wind_speed_m_s": rng.integers(0, 12, 40).astype(float), "cloud_cover": rng.random(40), "weight": weight})
    counts = np.bincount(draw_pairs(table, rng.random(40_000), rng.random(40_000)), minlength=40)
    expected = 40_000 * weight / weight.sum()
    assert np.sum((counts - expected) ** 2 / expected) < 77.0


def test_clouds_hide_by_cover_or_only_when_overcast():
    assert illuminated("cover", [0.0, 0.3, 1.0], 0.5) == pytest.approx([1.0, 0.7, 0.0])
    assert illuminated("overcast", [0.0, 0.9, 1.0], 0.5).tolist() == [1.0, 1.0, 0.0]


def test_slanting_lines_meet_more_clouds():
    overhead, low = clear_line(0.5, np.radians([90.0, 10.0]), 0.5)
    assert overhead == pytest.approx(0.5)
    assert low == pytest.approx(0.5 ** (1.0 + 2.0 / np.pi / np.tan(np.radians(10.0))))


def test_strata_add_up_to_the_whole():
    plan = SamplingPlan(16, 256)
    u = plan.uniform(2, 1)
    values = (u[:, 0] < 0.3).astype(float)
    found = strata(values, plan, {"half": (u[:, 1], np.array([0.0, 0.5, 1.0]))}, 1.0)
    assert sum(s.share for s in found) == pytest.approx(1.0)
    assert sum(s.share * s.value for s in found) == pytest.approx(values.mean())
    assert sum(s.contribution for s in found) == pytest.approx(1.0)
    assert all(s.interval_low <= 0.3 <= s.interval_high for s in found)


def test_hours_of_rows_stand_for_the_hours_around_them():
    """Rows of four hours: each for three hours before and after, around midnight too, evenly."""
    count = 4000
    table = WeatherTable(
        {
            "wind_speed_m_s": np.array([3.0, 8.0, 5.0, 6.0]),
            "cloud_cover": np.zeros(4),
            "month": np.full(4, 3.0),
            "hour_utc": np.array([0.0, 6.0, 12.0, 18.0]),
            "latitude_deg": np.full(4, 10.0),
            "longitude_deg": np.zeros(4),
        }
    )
    rng = np.random.default_rng(3)
    u = {name: rng.random(count) for name in ("row", "cover", "day", "hour", "across", "along")}
    found = conditions(table, u, Times(2025), None)
    assert np.array_equal(months_of(found.time), np.full(count, 3))
    for row, hour in enumerate(table["hour_utc"]):
        away = (found.time[found.rows == row] % 86_400.0 / 3600.0 - hour + 12.0) % 24.0 - 12.0
        assert np.quantile(away, [0.0, 0.25, 0.5, 0.75, 1.0]) == pytest.approx([-3.0, -1.5, 0.0, 1.5, 3.0], abs=0.3)
    days = np.unique(found.time // 86_400.0)
    assert days.size == 31


@pytest.mark.parametrize(
    ("region", "east"),
    [
        ((10.0, 60.0, -20.0, 40.0), 40.0),
        ((10.0, 60.0, 170.0, -150.0), -150.0),
        ((-90.0, 90.0, -180.0, 180.0), -180.0),
        ((-5.0, -5.0, 3.0, 3.0), 3.0),
    ],
)
def test_places_go_from_border_to_border(region, east):
    """First, middle and last: sines of latitude are even, longitudes go on over the date line."""
    south, north, west, _ = region
    latitude, longitude = GeographicRegion(*region).draw(np.array([0.0, 0.5, 1.0]), np.array([0.0, 0.5, 1.0]))
    sines = np.sin(np.radians([south, north]))
    assert np.sin(np.radians(latitude)) == pytest.approx([sines[0], sines.mean(), sines[1]], abs=1e-12)
    assert longitude[[0, 2]] == pytest.approx([west, east])
    half = (region[3] - west) % 360.0 / 2.0 if region[3] - west != 360.0 else 180.0
    assert np.exp(1j * np.radians(longitude[1])) == pytest.approx(np.exp(1j * np.radians(west + half)))
    assert -180.0 <= longitude.min() <= longitude.max() < 180.0


def test_the_nearest_hour_goes_around_the_day():
    hours = np.array([1.0, 7.5, 13.0, 22.0])
    asked = np.linspace(0.0, 23.99, 200)
    away = np.abs((asked[:, None] - hours + 12.0) % 24.0 - 12.0)
    assert np.array_equal(_nearest(asked, hours), np.argmin(away, axis=1))


def test_few_samples_are_one_point_a_scrambling():
    assert SamplingPlan.of(5) == SamplingPlan(16, 1)
    assert SamplingPlan.of(32) == SamplingPlan(16, 2)


def test_intervals_are_students_of_the_scramblings():
    """Means of 16 scramblings, by SciPy's test of one sample; weights that are all the same change nothing, those of 0 leave draws out."""
    plan = SamplingPlan(16, 64)
    values = np.random.default_rng(4).gamma(2.0, 1.0, plan.total)
    low, high = ttest_1samp(values.reshape(16, 64).mean(axis=1), 0.0).confidence_interval(0.95)
    found = estimate(values, plan, most=np.inf)
    assert (found.value, found.low, found.high) == pytest.approx((values.mean(), low, high))
    again = estimate(values, plan, weight=np.full(plan.total, 2.5), most=np.inf)
    assert (again.value, again.low, again.high) == pytest.approx((found.value, found.low, found.high))
    half = np.tile([1.0, 0.0], plan.total // 2)
    some, part = estimate(values, plan, weight=half, most=np.inf), estimate(values[::2], SamplingPlan(16, 32), most=np.inf)
    assert (some.value, some.low, some.high) == pytest.approx((part.value, part.low, part.high))
    assert np.isnan(estimate(values, plan, weight=0.0 * half).value)


@pytest.mark.parametrize("most", [1.0, 2.5])
def test_few_hits_or_misses_have_poissons_interval_to_the_outside(most):
    """Garwood's by chi-square; misses as hits seen from the other end."""
    plan = SamplingPlan(16, 256)
    values = np.zeros(plan.total)
    values[[5, 1000, 2000, 4000]] = most  # in four of the scramblings
    found, mirrored = estimate(values, plan, most=most), estimate(most - values, plan, most=most)
    low, high = chi2.ppf(0.025, 8) / 2.0, chi2.ppf(0.975, 10) / 2.0
    student = ttest_1samp(values.reshape(16, 256).mean(axis=1), 0.0).confidence_interval(0.95)
    assert found.value == pytest.approx(4.0 * most / plan.total)
    assert found.low == pytest.approx(max(min(low * most / plan.total, student.low, most / plan.total), 0.0))
    assert found.high == pytest.approx(max(high * most / plan.total, student.high))
    assert (mirrored.low, mirrored.high) == pytest.approx((most - found.high, most - found.low))


def test_intervals_are_three_draws_wide_at_least():
    plan = SamplingPlan(16, 256)
    even = np.tile([0.0, 1.0], plan.total // 2)
    found = estimate(even, plan)
    assert (found.value - found.low, found.high - found.value) == pytest.approx((3.0 / plan.total, 3.0 / plan.total))
    scaled = estimate(4.0 * even, plan, most=4.0)
    assert (scaled.value, scaled.high - scaled.value) == pytest.approx((2.0, 12.0 / plan.total))
