"""Chances of glint with the climatology of the world's seas: places, seasons, notes and refusals."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from seaglint.base.errors import SeaglintError
from seaglint.climate.weather_table import WeatherTable
from seaglint.climate.world_weather import model_atmospheres, world_weather
from seaglint.scenario.ensemble_file import parse_ensemble
from seaglint.scenario.load import parse_scenario
from seaglint.studies.ensemble.render_ensemble import draw as drawn_scenes
from seaglint.studies.likelihood.draw_model import LikelihoodModel
from seaglint.studies.likelihood.glint_chance import draw, likelihood

TABLE = {"threshold_w_m2_sr": [0.25], "samples": 4096}


def model(likelihood_table: dict[str, Any], **tables: Any) -> LikelihoodModel:
    return LikelihoodModel.of(parse_scenario({"likelihood": TABLE | likelihood_table, **tables}))


def test_the_chance_at_a_time_is_that_of_many_rows_of_the_laws() -> None:
    """One noon in the middle of July: the climatology against a table of 10 000 rows of its laws."""
    time = {"utc": "2025-07-16T16:00:00Z"}
    table = TABLE | {"samples": 32_768, "depression_deg": [30, 60]}
    climatology = likelihood(parse_scenario({"likelihood": table | {"weather": "world", "place": [50, -30]}, "time": time}))
    wind, cloud = (x.ravel() for x in np.meshgrid((np.arange(400) + 0.5) / 400, (np.arange(25) + 0.5) / 25))
    drawn = world_weather().draw(np.full(wind.size, 6.5), np.full(wind.size, 50.0), np.full(wind.size, -30.0), wind, cloud)
    names = np.array([name for name, _ in model_atmospheres()])[drawn.model]
    rows = WeatherTable({"wind_speed_m_s": drawn.wind, "cloud_cover": drawn.cover}, {"atmosphere": names})
    scenario = parse_scenario({"likelihood": table, "time": time, "place": {"latitude_deg": 50, "longitude_deg": -30}})
    assert climatology.estimates[0].value > 0.01
    assert climatology.estimates[0].value == pytest.approx(likelihood(scenario, weather=rows).estimates[0].value, rel=0.02)
    assert climatology.summary().weather.file == "world"


def test_the_short_form_is_the_table_place() -> None:
    one = likelihood(parse_scenario({"likelihood": TABLE | {"weather": "world", "place": [30, -60]}}))
    place = {"latitude_deg": 30, "longitude_deg": -60}
    other = likelihood(parse_scenario({"likelihood": TABLE | {"weather": "world"}, "place": place}))
    assert one.estimates == other.estimates


def test_of_several_places_the_short_form_is_used_and_reported() -> None:
    place = {"latitude_deg": 10, "longitude_deg": -30}
    notes = " ".join(model({"weather": "world", "place": [30, -60], "latitudes_deg": [0, 5], "longitudes_deg": [0, 5]}, place=place).notes)
    assert "likelihood.place = [30, -60] is used instead of [place] and the region of likelihood.latitudes_deg" in notes
    under_sun = model({"weather": "world", "place": [30, -60]}, sun={"zenith_deg": 70}).notes
    assert "the Sun is that of [sun]" in " ".join(under_sun)


def test_the_season_follows_hemisphere_and_month() -> None:
    """Mean winds of draws in the North Atlantic: those of the cells of January and July, of the middles of both months to a tenth."""
    for month in (1, 7):
        drawn = draw(model({"weather": "world", "place": [50, -30], "months": [month]}), samples=16_384)
        mean = float(world_weather().of_month(month, 50.0, -30.0).wind_speed_m_s)
        assert np.average(drawn.wind, weights=drawn.weight) == pytest.approx(mean, rel=0.015)


def test_all_draws_of_a_region_are_at_sea_and_even_over_its_area() -> None:
    """A region half of which is Africa: no draw on land, and means of the places are those of the sea of a fine grid."""
    drawn = draw(model({"weather": "world", "latitudes_deg": [10, 20], "longitudes_deg": [-30, 0]}), samples=8192)
    # Borders of the sea are known to half a degree.
    assert world_weather().at_sea(drawn.where.latitude, drawn.where.longitude).mean() > 0.98
    north, east = (x.ravel() for x in np.meshgrid(np.arange(10.05, 20, 0.1), np.arange(-29.95, 0, 0.1), indexing="ij"))
    sea = world_weather().at_sea(north, east)
    assert 0.3 < sea.mean() < 0.8
    area = np.cos(np.radians(north[sea]))
    for places, fine in ((drawn.where.latitude, north[sea]), (drawn.where.longitude, east[sea])):
        assert np.average(places, weights=drawn.weight) == pytest.approx(np.average(fine, weights=area), abs=0.15)
        assert np.average(places**2, weights=drawn.weight) == pytest.approx(np.average(fine**2, weights=area), rel=0.02)


def test_the_world_is_the_region_by_default() -> None:
    drawn = draw(model({"weather": "world"}), samples=8192)
    weight = drawn.weight / drawn.weight.sum()
    north, _, area = world_weather().cells()
    assert weight @ drawn.where.latitude == pytest.approx(np.average(north, weights=area), abs=1.5)


def test_under_a_given_sun_the_weather_has_the_whole_year() -> None:
    drawn = draw(model({"weather": "world", "place": [50, -30]}, sun={"zenith_deg": 60}), samples=16_384)
    months = world_weather().of_month(np.arange(1, 13), 50.0, -30.0).wind_speed_m_s
    assert drawn.wind.mean() == pytest.approx(months.mean(), rel=0.02)
    assert np.all(drawn.solar_zenith == drawn.solar_zenith[0])


def test_models_of_the_air_follow_the_place() -> None:
    for place, name in (([5, -30], "tropical"), ([66, 0], "midlatitude-winter")):
        at = model({"weather": "world", "place": place, "months": [1]})
        drawn = at.weather(
            at.conditions({name: np.full(8, 0.5) for name in ("row", "cover", "day", "hour", "across", "along")}),
            dict.fromkeys(("row", "cover"), np.full(8, 0.5)),
        )
        assert {at.models[k] for k in drawn.model} == {name}


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ({"place": [48.1, 11.6]}, r"likelihood\.place = \[48\.1, 11\.6\] is on land.* nearest sea of the climatology is \[54, 5\]"),
        ({"latitudes_deg": [44, 50], "longitudes_deg": [5, 20]}, r"no sea of the climatology 'world' inside; the nearest is"),
        ({"place": [95, 0]}, r"likelihood\.place\[0\] = 95"),
        ({"place": [10]}, r"likelihood\.place"),
    ],
)
def test_places_without_sea_are_refused_in_one_line(table: dict[str, Any], message: str) -> None:
    with pytest.raises(SeaglintError, match=message) as error:
        model({"weather": "world"} | table)
    assert "\n" not in str(error.value)


def test_few_observations_are_reported() -> None:
    assert any("few wind observations in the cell of [-62, 0]" in note for note in model({"weather": "world", "place": [-62, 0]}).notes)
    assert not any("few" in note for note in model({"weather": "world", "place": [50, -30]}).notes)


def test_strong_winds_are_counted_in_the_months_of_the_draws() -> None:
    def share(months: list[int]) -> float:
        drawn = parse_scenario({"likelihood": {"weather": "world", "place": [50, -30], "months": months, "samples": 65_536}})
        model = LikelihoodModel.of(drawn)
        note = next(note for note in model.notes if "of the winds are above 20 m/s" in note)
        wind = draw(model).wind
        # The note has the mean of the month's middle: over all of January winds are weaker, over all of July stronger.
        assert float(note.split()[0]) == pytest.approx(100.0 * np.mean(wind > 20.0), rel=0.5)
        return float(note.split()[0])

    assert share([1]) > 20.0 * share([7])


def test_without_a_name_the_climatology_serves_where_it_has_the_place() -> None:
    assert model({"place": [50, -30]}).climatology is not None
    mediterranean = model({"place": [36, 18]})
    assert mediterranean.climatology is None
    assert any("the packaged table north-atlantic" in note for note in mediterranean.notes)
    assert model({}).climatology is None


def test_the_same_seed_gives_the_same_draws() -> None:
    table = {"weather": "world", "latitudes_deg": [0, 40], "longitudes_deg": [140, -140]}
    one, other = (draw(model(table), samples=2048) for _ in range(2))
    assert np.array_equal(one.radiance, other.radiance)
    assert np.array_equal(one.weight, other.weight)


def test_an_ensemble_draws_the_weather_of_its_place_and_month() -> None:
    """Sea temperature and air less sea are the month's; winds have its mean."""
    place = {"latitude_deg": 30, "longitude_deg": -60}
    columns = ["wind_speed_m_s", "sea_temperature_k", "air_minus_sea_k", "atmosphere"]
    raw = {
        "ensemble": {"scenes": 64, "sampling": "latin_hypercube"},
        "base": {"place": place, "time": {"utc": "2025-01-16T16:00:00Z"}},
        "vary": [{"law": "weather", "table": "world", "columns": columns}],
    }
    scenes = drawn_scenes(parse_ensemble(raw))
    means = world_weather().of_month(1, 30.0, -60.0)
    values = [scene.parameters for scene in scenes]
    np.testing.assert_allclose([value["sea.temperature_k"] for value in values], float(means.sea_temperature_k))
    assert values[0]["atmosphere.air_minus_sea_k"] == pytest.approx(float(means.air_temperature_k - means.sea_temperature_k))
    winds = np.mean([value["wind.speed_m_s"] for value in values])
    assert winds == pytest.approx(float(means.wind_speed_m_s), rel=0.05)
