"""The table of weather: draws that keep the joint law, months, selection, smoothing."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import chisquare, qmc

from seaglint.base.errors import DomainError
from seaglint.climate.conditions import bandwidths, smoothed
from seaglint.climate.table_summary import correlation, joint_density, month_means, wind_rose
from seaglint.climate.weather_columns import model_atmosphere, relative_humidity, significant_height, wind_from_components
from seaglint.climate.weather_selection import GeographicBox, Polygon, Selection, select
from seaglint.climate.weather_table import WeatherTable


def _linked(rows: int = 400, seed: int = 5) -> WeatherTable:
    """Strong winds under closed skies, of unequal weight, in three months."""
    rng = np.random.default_rng(seed)
    wind = rng.weibull(2.0, rows) * 8.0
    cloud = np.clip(np.round(8 * (0.3 + 0.05 * wind + rng.normal(0.0, 0.2, rows))) / 8, 0.0, 1.0)
    return WeatherTable(
        {"wind_speed_m_s": wind, "cloud_cover": cloud, "weight": rng.gamma(0.5, 1.0, rows), "month": rng.choice([1.0, 2.0, 7.0], rows)}
    )


def _classes(table: WeatherTable) -> np.ndarray:
    """Class of each row in wind and cloud: 4 x 3."""
    wind = np.searchsorted([4.0, 8.0, 12.0], table["wind_speed_m_s"], side="right")
    cloud = np.searchsorted([0.5, 0.95], table["cloud_cover"], side="right")
    return wind * 3 + cloud


def test_the_drawn_joint_law_is_that_of_the_table() -> None:
    """Chi-square in two dimensions, 20 000 draws in 12 classes of wind and cloud; the level is 1e-3 and the seed fixed."""
    table, count = _linked(), 20_000
    rows = table.draw(np.random.default_rng(11).random(count))
    classes = _classes(table)
    expected = np.bincount(classes, weights=table.probability, minlength=12)
    found = np.bincount(classes[rows], minlength=12)
    there = expected > 0
    assert (count * expected[there]).min() > 5.0  # as the test needs
    assert found[~there].sum() == 0
    assert chisquare(found[there], count * expected[there]).pvalue > 1e-3
    # The same draws with the columns shuffled against each other, as if they were independent, are refused.
    loose = np.random.default_rng(1).permutation(rows)
    mixed = np.searchsorted([4.0, 8.0, 12.0], table["wind_speed_m_s"][rows], side="right") * 3
    mixed += np.searchsorted([0.5, 0.95], table["cloud_cover"][loose], side="right")
    loosely = np.bincount(mixed, minlength=12)[there]
    assert chisquare(loosely, loosely.sum() * expected[there] / expected[there].sum()).pvalue < 1e-9


def test_quasi_random_numbers_drive_the_draw() -> None:
    """Frequencies of rows by 2^12 Sobol points miss the probabilities by no more than a few points each, not by their root."""
    table = _linked(50)
    rows = table.draw(qmc.Sobol(1, rng=np.random.default_rng(3)).random_base2(12)[:, 0])
    assert np.abs(np.bincount(rows, minlength=50) - 4096 * table.probability).max() <= 2.0


def test_rows_of_no_weight_never_come_and_any_sum_is_divided_out() -> None:
    table = WeatherTable({"wind_speed_m_s": np.arange(4.0), "cloud_cover": np.zeros(4), "weight": np.array([0.0, 30.0, 0.0, 10.0])})
    assert table.weight_sum == 40.0
    np.testing.assert_allclose(table.probability, [0.0, 0.75, 0.0, 0.25])
    uniform = np.array([0.0, 0.7499, 0.7501, np.nextafter(1.0, 0.0)])
    assert table.draw(uniform).tolist() == [1, 1, 3, 3]
    assert table.effective_rows == pytest.approx(1.6)


@pytest.mark.parametrize(
    ("columns", "said"),
    [
        ({"weight": [-1.0, 2.0]}, r"row 1: weight = -1 is outside the range allowed: 0 or more"),
        ({"weight": [0.0, 0.0]}, r"all weights are 0"),
        ({"weight": [1.0, np.nan]}, r"row 2: weight is missing"),
        ({"month": [1.0, 13.0]}, r"row 2: month = 13 is outside the range allowed: 1 to 12"),
        ({"month": [1.0, 2.5]}, r"row 2: month = 2.5"),
        ({"cloud_cover": [0.5, 8.0]}, r"row 2: cloud_cover = 8 is outside the range allowed: 0 to 1"),
        ({"cloud_cover": [0.5]}, r"columns of unequal length"),
        ({"wind_kn": [1.0, 2.0]}, r"'wind_kn' is not a column"),
    ],
)
def test_what_is_no_table_is_refused(columns: dict[str, list[float]], said: str) -> None:
    whole = {"wind_speed_m_s": [3.0, 4.0], "cloud_cover": [0.1, 0.2]} | columns
    with pytest.raises(DomainError, match=said):
        WeatherTable({name: np.array(values) for name, values in whole.items()})


def test_months_without_rows_take_the_nearest_around_the_year() -> None:
    """December lies beside January: a month counted as a plain number would take July."""
    table = _linked()
    assert table.months == (1, 2, 7)
    used = table.month_used
    assert (used[12], used[11], used[3], used[4], used[5], used[9], used[10]) == (1, 1, 2, 2, 7, 7, 7)
    assert table.missing_months == (3, 4, 5, 6, 8, 9, 10, 11, 12)
    month = np.repeat([12, 2, 6], 500)
    rows = table.draw_in_month(np.random.default_rng(2).random(1500), month)
    assert (table["month"][rows] == np.repeat([1, 2, 7], 500)).all()


def test_draws_in_a_month_follow_its_weights() -> None:
    table = _linked()
    uniform = (np.arange(100_000) + 0.5) / 100_000
    rows = table.draw_in_month(uniform, np.full(uniform.size, 7))
    part = table.take(table["month"] == 7)
    assert table["wind_speed_m_s"][rows].mean() == pytest.approx(part.mean("wind_speed_m_s"), rel=1e-3)


def test_smoothing_widens_by_its_bandwidth_and_keeps_what_stands_at_a_bound() -> None:
    table = _linked()
    width = bandwidths(table)
    # Silverman's rule in two dimensions: n^(-1/6) of the spread.
    spread = np.sqrt(np.cov(table["wind_speed_m_s"], aweights=table.probability, ddof=0))
    assert width["wind_speed_m_s"] == pytest.approx(spread * table.effective_rows ** (-1 / 6), rel=1e-12)
    rng = np.random.default_rng(8)
    rows = table.draw(rng.random(40_000))
    found = smoothed(table, rows, rng.uniform(1e-12, 1.0, (rows.size, 2)), width)
    wind, cloud = found["wind_speed_m_s"], found["cloud_cover"]
    assert wind.min() >= 0.0
    assert 0.0 <= cloud.min() <= cloud.max() <= 1.0
    np.testing.assert_array_equal(cloud == 1.0, table["cloud_cover"][rows] == 1.0)
    assert np.unique(wind).size > 39_000
    far = table["wind_speed_m_s"][rows] > 5 * width["wind_speed_m_s"]  # where the bound is not felt
    assert np.std((wind - table["wind_speed_m_s"][rows])[far]) == pytest.approx(width["wind_speed_m_s"], rel=0.02)


def test_smoothed_directions_go_around() -> None:
    table = WeatherTable({"wind_speed_m_s": np.ones(2), "cloud_cover": np.zeros(2), "wind_from_deg": np.array([359.0, 1.0])})
    found = smoothed(table, np.array([0, 1]), np.array([[0.999], [0.001]]), {"wind_from_deg": 2.0})["wind_from_deg"]
    assert found.tolist() == pytest.approx([5.18, 354.82], abs=0.01)


def test_a_box_over_the_date_line_and_longitudes_of_both_conventions() -> None:
    lat = np.array([10.0, 10.0, 10.0, 10.0])
    assert GeographicBox(170.0, 0.0, -170.0, 20.0).holds(lat, np.array([175.0, -175.0, 0.0, 185.0])).tolist() == [True, True, False, True]
    assert GeographicBox(300.0, 0.0, 350.0, 20.0).holds(lat, np.array([-60.0, -10.0, -9.0, 320.0])).tolist() == [True, True, False, True]
    assert GeographicBox(-180.0, 0.0, 180.0, 20.0).holds(lat, np.array([-180.0, 0.0, 90.0, 179.0])).all()
    with pytest.raises(DomainError, match="is not west,south,east,north"):
        GeographicBox(0.0, 20.0, 10.0, 0.0)


def test_a_polygon_holds_what_its_corners_enclose() -> None:
    """An L over the date line: its share of the box around it is known."""
    area = Polygon(((170.0, 0.0), (-170.0, 0.0), (-170.0, 10.0), (180.0, 10.0), (180.0, 20.0), (170.0, 20.0)))
    lon, lat = np.meshgrid(170.0 + 0.1 + 0.2 * np.arange(100), 0.1 + 0.2 * np.arange(100))
    assert area.holds(lat, lon).mean() == pytest.approx(0.75, abs=1e-12)
    assert area.holds(lat, lon - 360.0).mean() == pytest.approx(0.75, abs=1e-12)


def test_selection_counts_what_it_leaves_out_and_names_what_there_is() -> None:
    table = WeatherTable(
        {
            "wind_speed_m_s": np.ones(5),
            "cloud_cover": np.zeros(5),
            "month": np.array([1.0, 7.0, 7.0, np.nan, 7.0]),
            "hour_utc": np.array([0.0, 6.5, 12.0, 6.0, 6.0]),
        },
        {"region": np.array(["a", "a", "a", "a", "b"])},
    )
    found, left_out = select(table, Selection(months=(7,), hours=(6,), region="a"))
    assert len(found) == 1
    assert left_out == {"without a month": 1, "of other months": 1, "of other hours": 1, "of other regions": 1}
    with pytest.raises(DomainError, match="region 'c' has no rows; the table has a, b"):
        select(table, Selection(region="c"))
    with pytest.raises(DomainError, match=r"no rows in months March; the table covers months 1, 7, hours 0, 6, 12"):
        select(table, Selection(months=(3,)))


def test_winds_come_from_where_they_do_not_go() -> None:
    speed, come = wind_from_components([5.0, 0.0, -3.0, 0.0, 0.0], [0.0, 5.0, -3.0, 0.0, -1e-300])
    np.testing.assert_allclose(come, [270.0, 180.0, 45.0, np.nan, 0.0])
    assert speed[2] == pytest.approx(np.sqrt(18.0))


def test_derived_quantities() -> None:
    # Smithsonian tables: 12.27 hPa over water at 10 degC and 23.37 hPa at 20 degC.
    assert relative_humidity(293.15, 283.15) == pytest.approx(12.27 / 23.37, rel=2e-3)
    np.testing.assert_allclose(significant_height([3.0, np.nan, np.nan], [4.0, 2.0, np.nan]), [5.0, 2.0, np.nan])
    assert model_atmosphere([20.0, 52.0, 53.0, -45.0, np.nan], [1, 9, 10, 1, 1]).tolist() == [
        "tropical", "midlatitude-summer", "subarctic-winter", "midlatitude-summer", "",
    ]  # fmt: skip


def test_the_summary_sums_to_what_is_there() -> None:
    table = WeatherTable(
        {
            "wind_speed_m_s": np.array([1.0, 6.0, 30.0, 6.0]),
            "wind_from_deg": np.array([350.0, 10.0, 180.0, np.nan]),
            "cloud_cover": np.array([0.0, 0.5, 1.0, np.nan]),
            "weight": np.array([1.0, 2.0, 4.0, 3.0]),
            "month": np.array([1.0, 1.0, 7.0, 7.0]),
        }
    )
    rose = wind_rose(table)
    assert (rose[0, 0], rose[0, 2], rose[8, 6]) == pytest.approx((0.1, 0.2, 0.4))
    assert rose.sum() == pytest.approx(0.7)
    joint = joint_density(table)
    assert (joint[0, 0], joint[2, 4], joint[6, 8]) == pytest.approx((0.1, 0.2, 0.4))
    january = month_means(table)[0]
    assert (january.rows, january.probability, january.wind_speed_m_s) == pytest.approx((2, 0.3, 13.0 / 3.0))
    linked = _linked()
    assert correlation(linked) == pytest.approx(
        np.cov(linked["wind_speed_m_s"], linked["cloud_cover"], aweights=linked.probability)[0, 1]
        / np.sqrt(np.prod([np.cov(linked[n], aweights=linked.probability) for n in ("wind_speed_m_s", "cloud_cover")])),
        rel=1e-9,
    )


@pytest.mark.parametrize(
    "made",
    [
        lambda: Polygon(((0.0, 0.0), (1.0, 0.0))),
        lambda: Polygon(((0.0, 0.0), (361.0, 0.0), (1.0, 1.0))),
        lambda: Polygon(((0.0, 0.0), (1.0, 91.0), (1.0, 1.0))),
        lambda: Selection(months=()),
        lambda: Selection(months=(0, 1)),
        lambda: Selection(months=(12, 13)),
        lambda: Selection(hours=()),
        lambda: Selection(hours=(-1, 3)),
        lambda: Selection(hours=(23, 24)),
        lambda: GeographicBox(0.0, 10.0, 5.0, 9.0),
        lambda: GeographicBox(0.0, -91.0, 5.0, 9.0),
        lambda: GeographicBox(0.0, 0.0, 5.0, 91.0),
        lambda: GeographicBox(-361.0, 0.0, 5.0, 9.0),
        lambda: GeographicBox(0.0, 0.0, 361.0, 9.0),
    ],
)
def test_areas_and_times_that_are_none_are_refused(made) -> None:
    with pytest.raises(DomainError):
        made()


def test_areas_and_times_may_reach_their_limits() -> None:
    corners = ((0.0, 0.0), (360.0, 90.0), (-360.0, -90.0))
    assert Polygon(corners).corners == corners
    whole = Selection(GeographicBox(-360.0, -90.0, 360.0, 90.0), months=(1, 12), hours=(0, 23))
    assert whole.places(np.array([-90.0, 0.0, 90.0]), np.array([-180.0, 13.0, 360.0])).all()
    assert whole.times(np.array([1.0, 2.0, 12.0]), np.array([23.99, 0.0, 22.0])).tolist() == [True, False, False]


def test_chances_at_their_ends_cannot_be_smoothed() -> None:
    table = WeatherTable({"wind_speed_m_s": np.array([3.0, 5.0]), "cloud_cover": np.array([0.2, 0.7])})
    for end in (0.0, 1.0, 1.01, -0.1):
        with pytest.raises(DomainError, match="inside"):
            smoothed(table, np.array([0]), np.array([[end]]), {"wind_speed_m_s": 1.0})
    moved = smoothed(table, np.array([0, 1]), np.array([[0.5], [0.999]]), {"wind_speed_m_s": 1.0})
    assert moved["wind_speed_m_s"] == pytest.approx([3.0, 5.0 + 3.0902323], rel=1e-6)
