"""Seas between the campaigns in scenarios and studies: what changes with them, what stays, and the intervals of results."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from seaglint.base.errors import DataError, ScenarioError
from seaglint.formats.tables.input_tables import cases_of_columns
from seaglint.scenario.ensemble_file import parse_ensemble
from seaglint.scenario.load import parse_scenario
from seaglint.sea.spectra.campaign_draws import ShortWaveLevels, drawn_levels
from seaglint.store.detection_results import parts_folder
from seaglint.studies.build import scenario_physics
from seaglint.studies.build.waves_and_slopes import drawn_sea_facts, levels, slopes, waves
from seaglint.studies.detect.detection_requests import SceneRequest
from seaglint.studies.detect.study import run_study
from seaglint.studies.detect.unknown_sea import of_same_contrast
from seaglint.studies.detect.varied_cases import cases_of
from seaglint.studies.ensemble.render_ensemble import render_ensemble
from seaglint.studies.likelihood.glint_chance import likelihood
from seaglint.studies.mean.evaluate_cases import evaluate_mean, labelled_cases, parse_bands, widest_sea_lines
from seaglint.studies.mean.field_numbers import FIELD_NUMBERS, field_numbers
from seaglint.studies.mean.mean_map import UNKNOWN, brightest_lines, mean
from seaglint.studies.sea_draws import SeaUnknown, _report_measured_waves, sea_draws, sea_line, with_seas
from seaglint.studies.study_requests import LikelihoodRequest, MeanCasesRequest, MeanRequest

SENSOR = {"azimuth_deg": 0.0, "elevation_deg": -10.0, "fov_deg": [6.0, 4.0]}

#: The Sun is in front of the sensor: every pixel has glint.
SMALL = {"sensor": {"pixels": [12, 8], **SENSOR}, "atmosphere": {"source": "none"}, "sun": {"zenith_deg": 60.0, "azimuth_deg": 0.0}}


def scenario(**tables):
    return parse_scenario({**SMALL, **tables})


def campaigns(**sea):
    return scenario(sea={"uncertainty": "campaigns", **sea})


def test_the_seed_draws_the_sea_and_levels_replace_it():
    assert levels(campaigns()) == drawn_levels(1)
    assert levels(campaigns().model_copy(update={"seed": 2})) != levels(campaigns())
    assert levels(campaigns(short_wave_levels=[0.25, 0.75])) == ShortWaveLevels(0.25, 0.75)
    facts = drawn_sea_facts(campaigns(short_wave_levels=[0.25, 0.75]))
    assert (facts["short_wave_level_long"], facts["short_wave_level_short"]) == (0.25, 0.75)
    assert facts["drawn_sea_mss"] == pytest.approx(slopes(campaigns(short_wave_levels=[0.25, 0.75])).mss, rel=1e-12)
    assert drawn_sea_facts(scenario()) == {}


@pytest.mark.parametrize("kind", ["cox-munk-isotropic", "cox-munk-gram-charlier", "spectrum"])
def test_slopes_are_those_of_the_drawn_waves_whatever_the_law(kind):
    assert slopes(campaigns(slopes={"kind": kind})) == slopes(campaigns())
    assert slopes(campaigns()).is_gaussian


@pytest.mark.parametrize(
    ("spectrum", "wind"),
    [
        ({"kind": "elfouhaily"}, 7.0),
        ({"kind": "pierson-moskowitz"}, 12.0),
        ({"kind": "jonswap", "significant_height_m": 1.0, "peak_period_s": 10.0}, 7.0),
        ({"kind": "jonswap", "significant_height_m": 1.0, "peak_period_s": 10.0}, 0.1),
        ({"kind": "flat"}, 7.0),
        ({"kind": "asit-2019"}, 7.0),
        ({"kind": "radyo-2008"}, 7.0),
        ({"kind": "elfouhaily"}, 0.2),
    ],
)
def test_every_kind_of_sea_can_be_drawn_and_prepared(spectrum, wind):
    given = parse_scenario({**SMALL, "sea": {"spectrum": spectrum}, "wind": {"speed_m_s": wind}})
    for sea in sea_draws(given, 2):
        statistics = slopes(sea)
        assert statistics.mss >= 0.003 * (1.0 - 1e-9)  # the residual slopes of a calm sea
        prepared = scenario_physics.sea(sea, statistics)
        up, cross = (prepared.report[f"resolved_mss_{axis}"] + prepared.report[f"facet_mss_{axis}"] for axis in ("up", "cross"))
        # geometry and facets make up the whole sea, as without a drawn one
        assert (up, cross) == pytest.approx((statistics.mss_up, statistics.mss_cross), rel=1e-9)
    assert (waves(with_seas(given, [ShortWaveLevels(0.5, 0.5)])[0]).spectrum is None) == (spectrum["kind"] == "flat")


def test_nothing_is_drawn_without_wind():
    with pytest.raises(ScenarioError, match=r"wind.speed_m_s = 0; set a wind, or leave sea_draws out"):
        sea_draws(parse_scenario({**SMALL, "wind": {"speed_m_s": 0.0}}), 2)


def test_drawn_seas_change_no_other_random_numbers():
    """Phases of all waves are the same: heights of every tile are those of the scenario's sea, but for the size of the shortest waves."""
    given = scenario()
    fields = [
        scenario_physics.sea(sea, slopes(sea)).waves
        for sea in (given, *with_seas(given, [ShortWaveLevels(0.0, 0.0), ShortWaveLevels(1.0, 1.0)]))
    ]
    tiles = [[part for tile in field.tiles for part in (tile.length, tile.rotation)] for field in fields]
    # lengths follow from the spectrum, to which waves of 2 to 2.5 m add up to 2e-4 of them
    assert tiles[1] == pytest.approx(tiles[0], rel=5e-4)
    assert tiles[2] == pytest.approx(tiles[0], rel=5e-4)
    surfaces = [field.surfaces(10.0) for field in fields]
    for drawn in surfaces[1:]:
        for own, other in zip(surfaces[0], drawn, strict=True):
            # 0.95 in the tile of the shortest waves, the only one whose waves the draws change; without common phases it would be 0
            assert np.corrcoef(own[..., 0].ravel(), other[..., 0].ravel())[0, 1] > 0.95


def test_the_scenarios_differ_in_the_sea_alone_and_survive_files():
    given = scenario()
    drawn = sea_draws(given, 5)
    assert len({sea.sea.short_wave_levels for sea in drawn}) == 5
    for sea in drawn:
        assert sea.model_copy(update={"sea": given.sea}) == given
        assert parse_scenario(json.loads(sea.model_dump_json(exclude_none=True))) == sea
    assert sea_draws(given, 5)[3] == drawn[3]


@pytest.mark.parametrize("draws", [1, 0, -3, 1001])
@pytest.mark.parametrize("make", [lambda n: MeanRequest(scenario="a.toml", sea_draws=n), lambda n: MeanCasesRequest(sea_draws=n)])
def test_a_number_of_seas_that_gives_no_interval_is_refused_in_one_line(make, draws):
    with pytest.raises(DataError, match=rf"sea_draws = {draws} is outside 2 to 1000") as error:
        make(draws)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("draws", [2.5, "5", 5.0, [5]])
def test_a_number_of_seas_that_is_no_whole_number_is_refused_in_one_line(draws):
    with pytest.raises(DataError, match=r"is no whole number; give the number of seas to draw, from 2 to 1000") as error:
        mean(scenario(), sea_draws=draws)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("way", [{"best": True}, {"by_month": True}])
def test_seas_are_drawn_for_chances_alone(way):
    with pytest.raises(DataError, match="sea_draws = 5: is for the chances of the thresholds alone"):
        LikelihoodRequest(sea_draws=5, **way)


@pytest.mark.parametrize(
    ("tables", "text"),
    [
        ({"sea": {"slopes": {"kind": "flat"}}}, "is a mirror"),
        ({"sea": {"slopes": {"kind": "cox-munk-slick"}}}, "has a slick on it"),
        ({"mean": {"mode": "article"}}, "mean.mode = 'article'"),
    ],
)
def test_scenarios_without_short_waves_to_draw_are_refused(tables, text):
    given = scenario(**tables)
    with pytest.raises(ScenarioError, match=text):
        sea_draws(given, 3)
    tables = {**tables, "sea": {**tables.get("sea", {}), "uncertainty": "campaigns"}}
    with pytest.raises(ScenarioError, match=text):
        scenario(**tables)


def in_systems(kind):
    return {"kind": "systems", "systems": [{"kind": "jonswap", "significant_height_m": 1.0, "peak_period_s": 10.0}, {"kind": kind}]}


@pytest.mark.parametrize("kind", ["asit-2019", "radyo-2008"])
@pytest.mark.parametrize("table", [lambda kind: {"kind": kind}, in_systems])
def test_measured_short_waves_are_not_replaced_but_have_an_interval(kind, table, caplog):
    """One sea cannot have both the measured short waves and drawn ones; an interval over other seas is reported as what it is."""
    with pytest.raises(ScenarioError, match=rf"sea.uncertainty = 'campaigns' replaces .* \(kind = '{kind}'\); leave uncertainty") as error:
        campaigns(spectrum=table(kind))
    assert "\n" not in str(error.value)
    _report_measured_waves.cache_clear()
    given = scenario(sea={"spectrum": table(kind)})
    assert [slopes(sea).mss for sea in sea_draws(given, 3)] != [slopes(given).mss] * 3
    sea_draws(given, 3)
    (line,) = [message for message in caplog.messages if "sea_draws" in message]
    assert f"drawn between the campaigns from 5 rad/m on and have only longer waves of sea.spectrum '{kind}'" in line


def test_levels_without_uncertainty_are_refused():
    with pytest.raises(ScenarioError, match=r"sea.short_wave_levels is for sea.uncertainty = 'campaigns' alone"):
        scenario(sea={"short_wave_levels": [0.0, 1.0]})
    with pytest.raises(ScenarioError, match=r"short_wave_levels\[1\] = 1.5 is outside"):
        campaigns(short_wave_levels=[0.0, 1.5])


def test_a_map_keeps_the_scenarios_own_images_and_bounds_those_of_the_seas():
    given = scenario()
    plain, drawn = mean(given), mean(given, sea_draws=4)
    for name in plain.data_vars:
        np.testing.assert_array_equal(plain[name], drawn[name])
    images = {name: np.stack([mean(sea)[name].to_numpy() for sea in sea_draws(given, 4)]) for name in UNKNOWN}
    for name, stack in images.items():
        # quantiles by hand: 5 % of the way from the lowest, as three steps lie between four seas
        lowest, second = np.sort(stack, axis=0)[:2]
        expected = lowest + 0.15 * (second - lowest)
        np.testing.assert_allclose(drawn[f"{name}_sea_low"], expected, rtol=1e-5)
        assert np.all(drawn[f"{name}_sea_high"] >= drawn[f"{name}_sea_low"])
    assert drawn.attrs["sea_draws"] == 4
    assert brightest_lines(plain) == []
    assert all("sea unknown: " in line and "(4 seas between the campaigns)" in line for line in brightest_lines(drawn))


def test_a_map_of_a_turned_camera_has_the_interval_too():
    drawn = mean(scenario(sensor={**SENSOR, "pixels": [6, 4], "roll_deg": 20.0}), sea_draws=2)
    assert np.all(drawn.radiance_sea_high >= drawn.radiance_sea_low)


def test_a_table_of_cases_has_the_interval_of_each_column_at_the_wind_of_its_row():
    rows = {
        "atmosphere": ["tropical"] * 2, "wind_speed_m_s": [5.0, 9.0], "sensor_height_m": [20.0] * 2, "depression_deg": [5.0] * 2,
        "solar_zenith_deg": [60.0] * 2, "relative_azimuth_deg": [0.0] * 2, "sea_temperature_k": [300.0] * 2, "ifov_mrad": [0.5] * 2,
    }  # fmt: skip
    bands = parse_bands(["3.8-4.0"])
    both = evaluate_mean(cases_of_columns(rows), bands, sea_draws=3)
    plain = evaluate_mean(cases_of_columns(rows), bands)
    second = evaluate_mean(cases_of_columns({name: values[1:] for name, values in rows.items()}), bands, sea_draws=3)
    for name, values in plain.items():
        np.testing.assert_array_equal(both[name], values)
    for name, values in second.items():
        assert np.asarray(both[name])[1:] == pytest.approx(np.asarray(values), rel=1e-12)
    assert np.asarray(both["sea_draws"]).tolist() == [3, 3]
    for quantity in ("radiance_W_m2_sr", "apparent_temperature_K", "std_W_m2_sr"):
        low, high = (np.asarray(both[f"{quantity}_sea_unknown_{end}[3.8-4.0]"]) for end in ("low", "high"))
        assert np.all(low < high)
    labelled = labelled_cases(cases_of_columns(rows), both)
    assert labelled.std_W_m2_sr_sea_unknown_low.attrs["units"] == "W m-2 sr-1"
    assert widest_sea_lines(plain) == []
    assert "(3 seas between the campaigns)" in widest_sea_lines(both)[0]


def test_a_likelihood_has_the_chances_of_the_seas_with_the_same_draws():
    tables = {"likelihood": {"threshold_w_m2_sr": [1.0, 30.0], "samples": 2048, "azimuths": "drawn"}, "atmosphere": {"source": "none"}}
    given = parse_scenario(tables)
    plain, drawn = likelihood(given), likelihood(given, sea_draws=3)
    assert [row.probability for row in drawn.summary().results] == [row.probability for row in plain.summary().results]
    for threshold, row in enumerate(drawn.summary().results):
        assert row.sea_draws == 3
        assert 0.0 <= row.sea_unknown_low <= row.sea_unknown_median <= row.sea_unknown_high <= 1.0
        assert row.sea_unknown_high > row.sea_unknown_low or threshold == 1
    assert "sea_unknown_low" not in plain.as_dict()["results"][0]


def test_numbers_of_a_field_bound_those_of_the_seas_and_are_empty_without_a_sea():
    row = field_numbers(scenario(), 3)
    assert row["sea_draws"] == 3
    for name in FIELD_NUMBERS:
        assert 0.0 < row[f"{name}_sea_unknown_low"] < row[f"{name}_sea_unknown_high"]
    up = field_numbers(scenario(sensor={"pixels": [4, 4], "elevation_deg": 40.0}), 2)
    assert {up[name] for name in FIELD_NUMBERS} == {None}


def test_the_field_is_that_of_the_map():
    given = scenario(sensor={**SENSOR, "pixels": [12, 8], "fov_deg": [2.0, 1.0]})
    row, images = field_numbers(given, 2), mean(given)
    # 2 %: middles of pixels against means over their height
    assert row["mean_radiance_W_m2_sr"] == pytest.approx(float(images.radiance.mean()), rel=0.02)
    assert row["glint_std_W_m2_sr"] == pytest.approx(float(np.sqrt((images.glint_std.to_numpy() ** 2).mean())), rel=0.02)


def test_rates_of_a_detector_have_intervals_and_the_objects_of_the_scenarios_sea(tmp_path):
    given = parse_scenario({**SMALL, "sensor": {**SENSOR, "pixels": [24, 16]}, "sea": {"resolve_waves": False}})
    request = SceneRequest(source="scenario", contrast=(0.001, 50.0), injections=60, frames=2, sea_draws=2)
    with parts_folder(None, resume=False, overwrite=False) as (parts, _):
        done = []
        study = run_study(cases_of(given), request, parts, progress=lambda done_seas, total: done.append((done_seas, total)))
        again = run_study(cases_of(given), request, parts)
        plain = run_study(cases_of(given), replace(request, sea_draws=None), parts)
    result = study.good[0].done.result
    assert result["sea_draws"] == 2
    assert result["p_fa_sea_unknown_low"] <= result["p_fa_sea_unknown_high"]
    for entry in result["sweep"]:
        assert 0.0 <= entry["p_d_sea_unknown_low"] <= entry["p_d_sea_unknown_high"] <= 1.0
    assert result["sweep"][1]["p_d_sea_unknown_low"] == 1.0  # as bright as to be found in every sea
    row = study.rows()[0]
    assert {"p_d_sea_unknown_low", "p_fa_sea_unknown_high", "sea_draws"} <= row.keys()
    assert again.good[0].done.result == result
    assert "sea_draws" not in plain.good[0].done.result
    assert [seas for seas, _ in done] == sorted(seas for seas, _ in done)
    assert {total for _, total in done} == {6}
    assert of_same_contrast(request, study.good[0].done).contrast == (0.001, 50.0)


def test_an_interval_of_equal_values_is_that_value_and_nan_stays():
    assert SeaUnknown.of([2.0, 2.0]).as_dict("p_d") == {
        "p_d_sea_unknown_low": 2.0, "p_d_sea_unknown_high": 2.0, "p_d_sea_unknown_median": 2.0,
    }  # fmt: skip
    assert SeaUnknown.of([1.0, float("nan")]).as_dict()["sea_unknown_low"] is None
    assert sea_line(0.001, 0.25, 20) == "sea unknown: 0.001 to 0.25 (20 seas between the campaigns)"


def test_an_ensemble_reports_rendering_and_drawn_seas_as_one_work(tmp_path):
    given = parse_ensemble({"ensemble": {"scenes": 2}, "base": SMALL})
    reported = []
    render_ensemble(given, tmp_path / "out", sea_draws=2, progress=lambda done, total: reported.append((done, total)))
    assert reported[-1] == (4, 4)
    assert [done for done, _ in reported] == sorted(done for done, _ in reported)
    rows = (tmp_path / "out" / "sea_unknown.csv").read_text().splitlines()
    assert len(rows) == 3
    reported.clear()
    render_ensemble(given, tmp_path / "only", sea_draws=2, draw_only=True, progress=lambda done, total: reported.append((done, total)))
    assert reported == [(0, 2), (1, 2), (2, 2)]
    # the scenes are the scenario's own: the table of parameters does not change
    plain = render_ensemble(given, tmp_path / "plain", draw_only=True)
    assert (plain / "parameters.csv").read_text() == (tmp_path / "out" / "parameters.csv").read_text()
