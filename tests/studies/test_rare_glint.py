"""Rare glint: draws towards it, their weights and intervals."""

from __future__ import annotations

import math

import numpy as np
import pytest

from seaglint.climate.draws import estimate
from seaglint.climate.weather_table import WeatherTable
from seaglint.radiance.mean_radiance import mean_radiance
from seaglint.scenario.load import parse_scenario
from seaglint.scenario.sun import sun_position
from seaglint.studies.build import scenario_physics
from seaglint.studies.likelihood.draw_model import LikelihoodModel
from seaglint.studies.likelihood.glint_chance import aimed, draw, draw_values, likelihood

CALM_NOW_AND_THEN = WeatherTable(
    {"wind_speed_m_s": np.array([2.0, 8.0]), "cloud_cover": np.array([0.25, 0.5]), "weight": np.array([0.01, 0.99])}
)
SUN = {"zenith_deg": 82.0, "azimuth_deg": 200.0}
PLACE = {"latitude_deg": 45, "longitude_deg": -30}


def scenario(wanted, **more):
    base = {"sun": SUN, "atmosphere": {"source": "none"}, "sea": {"slopes": {"kind": "cox-munk-isotropic"}}, "sensor": {"height_m": 30.0}}
    tables = {name: value for name, value in (base | more).items() if value is not None}
    return parse_scenario(tables | {"likelihood": {"depression_deg": [1.5, 6.0], "samples": 16_384, **wanted}})


def nested(threshold, wind):
    """Share of looks above a threshold, depression by depression and azimuth by azimuth with the direct model."""
    wanted = scenario({}, wind={"speed_m_s": wind})
    depression = np.radians(1.5 + 4.5 * (np.arange(90) + 0.5) / 90)
    # The corridor of glint of light winds is narrower than 12 deg to each side.
    azimuth = np.radians(np.linspace(-12.0, 12.0, 1201))
    radiance = mean_radiance(scenario_physics.view(wanted), -depression[::-1], sun_position(wanted).azimuth + azimuth).sun
    assert max(radiance[:, 0].max(), radiance[:, -1].max()) < threshold
    return float(np.mean(radiance > threshold)) * 24.0 / 360.0, float(radiance.max())


@pytest.mark.parametrize(("azimuths", "ratio"), [("integrated", 1.2), ("drawn", 1.7)])
def test_rare_glint_of_calms_is_the_nested_integral(azimuths, ratio):
    top = nested(1e9, 2.0)[1]
    threshold = 0.9 * top
    calm, fresh = nested(threshold, 2.0)[0], nested(threshold, 8.0)[0]
    chance = 0.01 * 0.75 * calm + 0.99 * 0.5 * fresh
    assert 1e-7 < chance < 1e-4
    found = likelihood(scenario({"threshold_w_m2_sr": [threshold], "azimuths": azimuths}), weather=CALM_NOW_AND_THEN)
    one = found.estimates[0]
    # The grid counts whole cells: some 3 % of so small an area; tables of light are within 0.2 % of radiance, some times that of the area.
    assert one.low / 1.04 < chance < one.high * 1.04
    assert one.high / one.low < ratio
    assert found.summary().sampling == "towards glint"
    assert any("draws concentrated where glint exceeds the thresholds" in note for note in found.summary().notes)


def test_a_rare_and_a_common_threshold_share_their_draws():
    """Chances of both, of the Sun's hours and of the cover agree with those of even draws; strata add up."""
    wanted = {"threshold_w_m2_sr": [0.25, 100.0], "samples": 32_768}
    weather = WeatherTable({"wind_speed_m_s": np.array([1.5, 4.0, 9.0]), "cloud_cover": np.array([0.1, 0.4, 0.7])})
    rare = likelihood(scenario(wanted, sun=None, place=PLACE), weather=weather)
    model = rare.model
    assert rare.draws.aim is not None
    even = draw(model, samples=131_072, seed=5)
    for one, threshold in zip(rare.estimates, model.settings.threshold_w_m2_sr, strict=True):
        other = estimate(draw_values(model, even, threshold), even.plan, weight=even.weight)
        # Twice the half width is 4 standard errors.
        assert abs(one.value - other.value) < (one.high - one.low) + (other.high - other.low)
    assert rare.sun_up.value == pytest.approx(0.503, abs=0.01)
    assert rare.summary().sun_free_of_clouds == pytest.approx(1.0 - 0.4, abs=0.02)
    for of_threshold, whole in zip(rare.strata, rare.estimates, strict=True):
        months = [s for s in of_threshold if s.by == "month"]
        assert sum(s.share for s in months) == pytest.approx(1.0)
        assert sum(s.share * s.value for s in months) == pytest.approx(whole.value)
    by_month = rare.month_by_hour()
    assert by_month is not None
    assert np.nanmean(by_month) == pytest.approx(rare.estimates[0].value, rel=0.2)  # months and hours have nearly equal shares


def test_draws_are_a_function_of_the_seed():
    wanted = scenario({"threshold_w_m2_sr": [30.0], "samples": 4096})
    one, same = (likelihood(wanted, weather=CALM_NOW_AND_THEN).draws for _ in range(2))
    assert np.array_equal(one.weight, same.weight)
    assert np.array_equal(one.radiance, same.radiance)


@pytest.mark.parametrize("thresholds", [[0.0], [1e6], [0.0, 1e6]])
def test_thresholds_that_are_certain_or_out_of_reach_have_even_draws(thresholds):
    wanted = scenario({"threshold_w_m2_sr": thresholds, "case": "trajectory", "samples": 4096})
    found = likelihood(wanted, weather=CALM_NOW_AND_THEN)
    assert found.summary().sampling == "even"
    if thresholds[-1] == 1e6:
        assert (found.estimates[-1].low, found.estimates[-1].high) == (0.0, pytest.approx(3.0 / 4096))


@pytest.mark.validation
@pytest.mark.parametrize("case", ["trajectory", "field-of-view"])
@pytest.mark.parametrize("where", ["sun", "place", "region", "towards the sun"])
def test_draws_towards_glint_beat_random_ones_five_times(case, where):
    """The same integrand at the default draws, those of the search for the density included; two thresholds share the draws."""
    region = {"latitudes_deg": [35, 65], "longitudes_deg": [-70, 0]}
    tables, keys = {
        "sun": ({"sun": {"zenith_deg": 75.0, "azimuth_deg": 200.0}}, {}),
        "place": ({"place": PLACE}, {}),
        "region": ({}, region),
        "towards the sun": ({}, region | {"azimuth_from_sun_deg": [-15, 15]}),
    }[where]
    model = LikelihoodModel.of(parse_scenario(tables | {"band": {"min_um": 3.0, "max_um": 5.0}, "likelihood": {"case": case, **keys}}))
    plain = draw(model, seed=1, plain=True)
    ours = [draw(model, seed=seed, aim=aimed(model, seed=seed)) for seed in range(4)]
    for threshold in (0.25, 2.5):
        values = draw_values(model, plain, threshold)
        mean = estimate(values, plain.plan, weight=plain.weight).value
        alone = float(np.mean((plain.weight * (values - mean)) ** 2))
        costs = []
        for drawn in ours:
            shape = (drawn.plan.scramblings, drawn.plan.points)
            means = np.average(draw_values(model, drawn, threshold).reshape(shape), axis=1, weights=drawn.weight.reshape(shape))
            draws = drawn.plan.points * (1.0 + (0 if drawn.aim is None else drawn.aim.draws) / drawn.plan.total)
            costs.append(np.var(means, ddof=1) * draws)
        assert alone / np.mean(costs) > 5.0


@pytest.mark.validation
def test_a_chance_of_a_millionth_by_a_million_draws():
    """Upper over lower end of the interval at most 4, with the shipped weather over a year at a place."""
    tables = {"place": PLACE, "band": {"min_um": 3.0, "max_um": 5.0}, "likelihood": {"threshold_w_m2_sr": [180.0], "samples": 1_048_576}}
    found = likelihood(parse_scenario(tables)).estimates[0]
    assert 1e-7 < found.value < 3e-6
    assert found.high / found.low < 4.0
    assert math.isfinite(found.high)
