"""The climatology of the world's seas: its means by an own reading of the file, its laws by sampling, and its places."""

from __future__ import annotations

import csv
from datetime import UTC, datetime
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from scipy.special import gamma
from scipy.stats import beta, kstest, norm, weibull_min

from seaglint.base.errors import DomainError
from seaglint.climate.weather_laws import CLOUD_SUM, WIND_CLOUD, cloud_at, cloud_shares, joint_shares, wind_at, wind_shape
from seaglint.climate.world_weather import DAYS, MeanConditions, few_observations, model_atmospheres, time_of_year, world_weather
from seaglint.formats.weather.weather_file import shipped

SHARED = Path(__file__).resolve().parents[3] / "shared" / "data" / "esbensen_kushnir_1981.csv"


@cache
def rows() -> list[dict[str, float]]:
    """Rows of the packaged file by the standard library's reader."""
    lines = [line for line in shipped("world").read_text().splitlines() if not line.startswith("#")]
    return [{name: float(value) for name, value in row.items()} for row in csv.DictReader(lines)]


@cache
def by_cell() -> dict[tuple[float, float, float], dict[str, float]]:
    return {(row["month"], row["latitude_deg"], row["longitude_deg"]): row for row in rows()}


def test_the_packaged_rows_are_those_of_the_source() -> None:
    if not SHARED.exists():
        pytest.skip("the source's table is not beside the project")
    with SHARED.open() as file:
        given = [{name: float(value) for name, value in row.items()} for row in csv.DictReader(file)]
    assert given == rows()


def test_the_means_at_the_middles_of_cells_and_months_are_the_files() -> None:
    world = world_weather()
    for row in np.random.default_rng(2).permutation(np.array(rows(), dtype=object))[:2000]:
        at = world.of_month(row["month"], row["latitude_deg"], row["longitude_deg"])
        expected = (
            row["wind_speed_m_s"],
            row["cloud_cover"],
            row["sea_temperature_c"] + 273.15,
            row["air_temperature_c"] + 273.15,
            1e-3 * row["specific_humidity_g_kg"],
            row["pressure_hpa"],
        )
        assert [float(value) for value in at] == pytest.approx(expected, rel=1e-12)
        # The file states the difference of the temperatures too.
        assert float(at.sea_temperature_k - at.air_temperature_k) == pytest.approx(row["sea_minus_air_k"], abs=0.011)


def test_between_the_middles_of_cells_the_means_are_linear() -> None:
    """Four corners, written out; corners without data do not count."""
    random, world, cells = np.random.default_rng(3), world_weather(), by_cell()
    compared = 0
    for _ in range(400):
        month, latitude, longitude = int(random.integers(1, 13)), random.uniform(-69, 77), random.uniform(-180, 180)
        total = weight = 0.0
        south, west = -70 + 4 * ((latitude + 70) // 4), -180 + 5 * ((longitude + 180) // 5)
        whole = True
        for north, up in ((south, 1 - (latitude - south) / 4), (south + 4, (latitude - south) / 4)):
            for east, right in ((west, 1 - (longitude - west) / 5), (west + 5, (longitude - west) / 5)):
                wrapped = (east + 180) % 360 - 180
                if bool(world.at_sea(north, wrapped)):
                    row = cells.get((month, north, wrapped))
                    if row is None:
                        whole = False  # a month that is interpolated
                        continue
                    total += up * right * row["wind_speed_m_s"]
                    weight += up * right
        if whole and weight > 1e-9:
            assert float(world.of_month(month, latitude, longitude).wind_speed_m_s) == pytest.approx(total / weight, rel=1e-9)
            compared += 1
    assert compared > 150


def test_the_mean_over_a_month_is_the_months() -> None:
    """By sums over the days: wind, temperatures and humidity to their rounding; covers where they are not cut at 0 or 1."""
    world = world_weather()
    north, east, _ = world.cells()
    for month in range(1, 13):
        time = month - 1 + (np.arange(64)[:, None] + 0.5) / 64
        means, expected = world.at(time, north, east), world.of_month(month, north, east)
        for name in ("wind_speed_m_s", "sea_temperature_k", "air_temperature_k", "specific_humidity", "cloud_cover"):
            difference = np.abs(getattr(means, name).mean(axis=0) - getattr(expected, name))
            assert np.quantile(difference / np.abs(getattr(expected, name)), 0.999) < 2e-3, name
        assert float(means.wind_speed_m_s.min()) > 0.5


def test_the_year_and_the_globe_are_closed() -> None:
    world, north = world_weather(), np.linspace(-60.0, 60.0, 61)
    for one, other in (((0.0, 179.999999), (12.0, -180.0)), ((0.3, -180.0), (0.3, 180.0)), ((6.0, 170.0), (6.0, -190.0))):
        first, second = world.at(one[0], north, one[1]), world.at(other[0], north, other[1])
        for a, b in zip(first, second, strict=True):
            np.testing.assert_allclose(a, b, rtol=1e-6)


def test_a_place_is_at_sea_where_cells_with_rows_have_half_of_the_weight() -> None:
    random, world = np.random.default_rng(5), world_weather()
    cells = {(lat, lon) for _, lat, lon in by_cell()}
    for latitude, longitude in zip(random.uniform(-71, 79, 3000), random.uniform(-180, 180, 3000), strict=True):
        weight = 0.0
        for lat, lon in cells:
            near = 1 - abs(min(max(latitude, -70.0), 78.0) - lat) / 4, 1 - abs((longitude - lon + 180) % 360 - 180) / 5
            weight += near[0] * near[1] if min(near) > 0 else 0.0
        assert bool(world.at_sea(latitude, longitude)) == (weight >= 0.5)
    assert not world.at_sea([-73.0, 81.0], [-30.0, 0.0]).any()


def test_a_place_off_the_coast_has_the_weather_of_the_nearest_sea() -> None:
    """A light station in the bight of Carolina is at sea, the Skagerrak is served; Gibraltar is too far from the next cell."""
    assert bool(world_weather().at_sea(33.48, -77.58))
    north, east, note = world_weather().sea_at(57.0, 8.0)
    assert bool(world_weather().at_sea(north, east))
    assert "no observations at place = [57, 8]" in str(note)
    with pytest.raises(DomainError, match="is on land, in ice or in a sea without data"):
        world_weather().sea_at(36.0, -5.5)


@pytest.mark.parametrize("place", [(48.1, 11.6), (36.0, 18.0), (85.0, 0.0), (-80.0, 10.0), (0.0, 20.0)])
def test_on_land_the_nearest_sea_is_named(place: tuple[float, float]) -> None:
    world = world_weather()
    north, east, distance = world.nearest_sea(*place)
    assert bool(world.at_sea(north, east))

    def angle(a: tuple[float, float], b: tuple[float, float]) -> float:
        one, other = (np.array([np.cos(p) * np.cos(q), np.cos(p) * np.sin(q), np.sin(p)]) for p, q in (np.radians(a), np.radians(b)))
        return float(np.arccos(np.clip(one @ other, -1, 1)))

    nearest = min({(lat, lon) for _, lat, lon in by_cell()}, key=lambda cell: angle(cell, place))
    assert angle((north, east), place) == pytest.approx(angle(nearest, place), abs=1e-9)
    assert distance == pytest.approx(6.371e6 * angle((north, east), place), rel=2e-3)
    with pytest.raises(DomainError, match=rf"nearest sea of the climatology is \[{north:g}, {east:g}\]"):
        world.sea_at(*place)


def test_the_border_in_the_north_belongs_to_the_last_row() -> None:
    world = world_weather()
    assert world.sea_at(80.0, 10.0) == (80.0, 10.0, None)
    assert world.cell_of([80.0, 79.9, -72.0], np.full(3, 10.0))[0].tolist() == [37, 37, 0]
    border, inside = (few_observations(world, north, 0.0, range(1, 13)) for north in (80.0, 79.9))
    assert border is not None
    assert inside is not None
    assert border.partition(": ")[2] == inside.partition(": ")[2]


def test_clear_and_overcast_skies_of_all_seas_are_those_of_the_law() -> None:
    # 5 % clear and 24 % overcast, as stated beside CLOUD_SUM.
    north, east, area = world_weather().cells()
    cover = world_weather().of_month(np.arange(1, 13)[:, None], north, east).cloud_cover
    clear, *_, overcast = np.average(cloud_shares(cover).mean(axis=0), axis=0, weights=area)
    assert (clear, overcast) == pytest.approx((0.05, 0.24), abs=0.005)


def test_times_of_the_year_are_those_of_the_calendar() -> None:
    for moment, expected in (
        (datetime(2025, 1, 16, 12, tzinfo=UTC), 0.5),
        (datetime(2024, 2, 15, 12, tzinfo=UTC), 1.5),
        (datetime(1969, 12, 31, 23, 59, 59, tzinfo=UTC), 12.0),
        (datetime(2030, 7, 1, tzinfo=UTC), 6.0),
    ):
        assert float(time_of_year(np.array([moment.timestamp()]))[0]) == pytest.approx(expected, abs=1e-6)


def test_draws_have_the_laws_about_the_means() -> None:
    """Winds against SciPy's Weibull law, covers against a beta law counted in oktas, and their normal scores against the copula."""
    random, n = np.random.default_rng(7), 200_000
    u = random.random((2, n))
    drawn = world_weather().draw(np.full(n, 0.5), np.full(n, 50.0), np.full(n, -30.0), u[0], u[1])
    means = world_weather().at(0.5, 50.0, -30.0)
    mean, shape = float(means.wind_speed_m_s), float(wind_shape(50.0, means.wind_speed_m_s))
    law = weibull_min(shape, scale=mean / gamma(1 + 1 / shape))
    for speed in (2.0, 5.0, 10.0, 20.0):
        assert np.mean(drawn.wind <= speed) == pytest.approx(law.cdf(speed), abs=4e-3)
    assert drawn.cover.mean() == pytest.approx(float(means.cloud_cover), abs=4e-3)
    assert set(np.unique(drawn.cover)) == set(np.arange(9) / 8)
    shares = np.bincount((8 * drawn.cover).astype(int), minlength=9) / n
    np.testing.assert_allclose(shares, cloud_shares(float(means.cloud_cover)), atol=4e-3)
    # A mean cover given the wind, by the copula.
    calm = u[0] < 0.05
    score = norm.ppf(np.linspace(0, 0.05, 2002)[1:-1])
    edges = norm.ppf(np.cumsum(cloud_shares(float(means.cloud_cover)))[:-1])
    above = [float(np.mean(1 - norm.cdf((edge - WIND_CLOUD * score) / np.sqrt(1 - WIND_CLOUD**2)))) / 8 for edge in edges]
    assert drawn.cover[calm].mean() == pytest.approx(sum(above), abs=0.01)


def test_shares_of_cloud_are_a_beta_law_counted_in_oktas() -> None:
    for mean in np.random.default_rng(8).uniform(0.02, 0.98, 60):
        shares = cloud_shares(mean)
        assert shares.sum() == pytest.approx(1.0)
        assert shares @ (np.arange(9) / 8) == pytest.approx(mean, abs=1e-4)
        # The parameter whose counted mean is the requested one.
        edges = np.r_[0, (np.arange(8) + 0.5) / 8, 1]
        grid = np.linspace(1e-4, 1 - 1e-4, 20_001)
        laws = np.diff(beta.cdf(edges, CLOUD_SUM * grid[:, None], CLOUD_SUM * (1 - grid[:, None])), axis=1)
        best = laws[np.argmin(np.abs(laws @ (np.arange(9) / 8) - mean))]
        np.testing.assert_allclose(shares, best, atol=2e-3)


@pytest.mark.parametrize("mean", [0.0, 0.3, 0.7, 1.0])
def test_classes_of_a_table_are_those_of_draws(mean: float) -> None:
    random, n = np.random.default_rng(9), 400_000
    wind, cloud = random.random((2, n))
    from seaglint.climate.weather_laws import WIND_CLASSES, joined

    place = np.searchsorted(np.cumsum(WIND_CLASSES), wind), (8 * cloud_at(joined(wind, cloud), mean)).astype(int)
    counted = np.zeros((11, 9))
    np.add.at(counted, place, 1 / n)
    np.testing.assert_allclose(joint_shares(mean), counted, atol=1.5e-3)


def test_a_table_at_a_place_has_the_means_of_the_place() -> None:
    world = world_weather()
    table = world.table([20.0, -35.0], [-30.0, 90.0], (1, 7), area=[1.0, 3.0])
    for latitude, longitude, share in ((20.0, -30.0, 0.25), (-35.0, 90.0, 0.75)):
        for month in (1, 7):
            part = table.take((table["latitude_deg"] == latitude) & (table["month"] == month))
            at = world.of_month(month, latitude, longitude)
            assert part.mean("wind_speed_m_s") == pytest.approx(float(at.wind_speed_m_s), rel=1e-9)
            assert part.mean("cloud_cover") == pytest.approx(float(at.cloud_cover), abs=1e-4)
            assert set(part.text("atmosphere")) == {model_atmospheres()[int(at.model)][0]}
            assert part.weight_sum == pytest.approx(share * DAYS[month - 1] / (DAYS[0] + DAYS[6]))


def test_the_model_atmosphere_has_the_nearest_humidity() -> None:
    """Wet tropical seas get the tropical model, cold ones a dry one; the ratio of humidities is the smallest of all."""
    names, humidity = zip(*model_atmospheres(), strict=True)
    for q in np.random.default_rng(11).uniform(0.001, 0.022, 200):
        means = MeanConditions(*(np.array(x) for x in (7.0, 0.5, 290.0, 290.0, q, 1013.0)))
        assert int(means.model) == int(np.argmin(np.abs(np.log(np.array(humidity) / q))))
    assert names[int(world_weather().at(6.5, 10.0, -40.0).model)] == "tropical"


def test_relative_humidity_is_the_vapour_pressure_over_saturation() -> None:
    """A dew point of 10 deg C in air of 20 deg C: vapour pressure 12.27 hPa, specific humidity 7.55 g/kg, 52.5 % (Magnus' formula)."""
    vapour = 6.1094 * np.exp(17.625 * 10.0 / 253.04)
    q = 0.62198 * vapour / (1013.25 - 0.37802 * vapour)
    means = MeanConditions(*(np.array(x) for x in (7.0, 0.5, 293.15, 293.15, q, 1013.25)))
    assert float(means.relative_humidity) == pytest.approx(0.525, abs=0.002)


#: Reports of ships, light stations and drifters that the climatology, which ends before 1980, does not hold, or holds among thousands.
#:
#: Month, day, latitude, longitude [deg], sea and air temperature [deg C], wind [m/s]; None where missing. ICOADS release 3 (NOAA, public
#: domain), as sampled in the repository glamod/cdm_reader_mapper.
REPORTS = (
    (2, 1, 71.2, 36.4, 4.5, -6.0, 12.9), (2, 1, 65.3, 7.3, 7.6, 1.1, 11.8), (2, 1, 71.3, 22.3, 6.7, -5.9, 6.2),
    (11, 1, 42.31, -33.92, 19.3, None, None), (11, 1, 36.24, -159.92, 21.8, None, None), (11, 1, 35.42, -164.43, 22.7, None, None),
    (11, 1, 31.49, -64.01, 25.9, None, None), (11, 1, 30.97, -28.28, 24.1, None, None), (1, 1, 75.6, 31.6, 4.6, 4.2, 10.0),
    (1, 1, 69.6, 18.9, 5.8, 6.2, 8.0), (1, 1, 66.0, 8.1, None, 7.3, 12.9), (9, 1, 33.4, 122.58, 21.5, 17.2, 2.0),
    (9, 1, 36.9, -75.7, 25.6, 25.6, 2.1), (9, 1, 41.39, -71.03, None, 18.9, 4.1), (9, 1, 36.9, -75.7, 25.6, 24.4, 3.1),
)  # fmt: skip


def test_single_reports_lie_inside_the_laws() -> None:
    """Seas within 4 K, warmer on average (drifters of 2021 most); winds at quantiles that look uniform."""
    world, seas, quantiles = world_weather(), [], []
    for month, day, latitude, longitude, sea, air, wind in REPORTS:
        means = world.at(month - 1 + day / 30.5, latitude, longitude)
        if sea is not None:
            seas.append(sea + 273.15 - float(means.sea_temperature_k))
        if air is not None:
            assert abs(air + 273.15 - float(means.air_temperature_k)) < 8.5
        if wind is not None:
            mean, shape = float(means.wind_speed_m_s), float(wind_shape(latitude, means.wind_speed_m_s))
            quantiles.append(weibull_min(shape, scale=mean / gamma(1 + 1 / shape)).cdf(wind))
    assert max(abs(np.array(seas))) < 4.0
    assert np.mean(seas) == pytest.approx(0.9, abs=0.6)
    assert kstest(quantiles, "uniform").pvalue > 0.05


def test_winds_of_weak_and_steady_months_differ_in_shape() -> None:
    assert float(wind_shape(15.0, 7.5)) > float(wind_shape(15.0, 4.0))
    for shape in (1.8, 2.1, 3.0):
        uniform = (np.arange(200_000) + 0.5) / 200_000
        assert wind_at(uniform, 6.0, shape).mean() == pytest.approx(6.0, rel=1e-4)
