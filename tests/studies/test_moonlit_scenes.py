"""Scenarios with [moon]: pictures, maps and likelihoods, their provenance, and what is refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from seaglint.base.errors import SeaglintError
from seaglint.cli.likelihood import lines
from seaglint.climate.moon_position import MoonEphemeris
from seaglint.climate.weather_table import WeatherTable
from seaglint.formats.tables.input_tables import Cases
from seaglint.radiance.mean_radiance import mean_radiance
from seaglint.radiance.variance import sea_variance
from seaglint.scenario.load import parse_scenario
from seaglint.scenario.moon import moon_position
from seaglint.studies.build import scenario_physics
from seaglint.studies.likelihood.best_looks import best_looks
from seaglint.studies.likelihood.chance_map import likelihood_map
from seaglint.studies.likelihood.draw_model import LikelihoodModel
from seaglint.studies.likelihood.glint_chance import draw, likelihood, pixel_deviation
from seaglint.studies.mean.evaluate_cases import MEAN_INPUTS, MOON, evaluate_mean, parse_bands
from seaglint.studies.mean.mean_map import mean
from seaglint.studies.sequence.render_sequence import prepare_sequence

SMALL = {
    "sun": {"zenith_deg": 130.0, "azimuth_deg": 0.0},
    "moon": {"zenith_deg": 70.0, "azimuth_deg": 180.0, "phase_deg": 40.0},
    "sensor": {"fov_deg": [4.0, 2.0], "pixels": [16, 8], "elevation_deg": -3.0, "azimuth_deg": 180.0, "frame_rate_hz": 0.02, "frames": 3},
    "wind": {"speed_m_s": 7.0, "from_deg": 230.0},
    "sea": {"shortest_wave_m": 4.0},
    "render": {"tile_size": 128},
}
DATED = {name: table for name, table in SMALL.items() if name not in ("sun", "moon")} | {
    "moon": {},
    "time": {"utc": "2026-11-24T22:00:00Z"},
    "place": {"latitude_deg": 30.0, "longitude_deg": 0.0},
}


def test_maps_and_pictures_say_where_the_moon_is():
    scenario = parse_scenario(SMALL)
    for attributes in (mean(scenario).attrs, prepare_sequence(scenario).layout.attributes):
        assert attributes["solar_zenith_deg"] == pytest.approx(130.0)
        assert attributes["moon_zenith_deg"] == pytest.approx(70.0)
        assert attributes["moon_azimuth_deg"] == pytest.approx(180.0)
        assert attributes["moon_phase_deg"] == pytest.approx(40.0)
    assert not any("moon" in name for name in mean(parse_scenario(SMALL | {"moon": None})).attrs if name != "scenario")


def test_the_moon_of_a_sequence_moves_as_the_sun_does():
    scenario = parse_scenario(DATED)
    run = prepare_sequence(scenario)
    first, later = run.scene_at(0.0).view, run.scene_at(100.0).view
    assert first.disc.ratio is not None, "the Sun is down"
    for view, step in ((first, 0), (later, 8)):
        assert view.disc.centre == pytest.approx((moon_position(scenario, step).zenith, moon_position(scenario, step).azimuth))
    assert abs(later.disc.centre[0] - first.disc.centre[0]) + abs(later.disc.centre[1] - first.disc.centre[1]) > 1e-3


def test_cases_have_a_moon():
    """Columns of the Moon, beside the mean radiance of a view with it."""
    names = (*MEAN_INPUTS, *MOON)
    rows = [["midlatitude-summer", "5", "20", "10", zenith, "30", "288.15", "1", "75", "30", "40"] for zenith in ("130", "70")]
    cases = Cases(Path("cases.csv"), list(names), rows, [2, 3])
    lit = evaluate_mean(cases, parse_bands(["8.0-12.0"]))
    dark = evaluate_mean(Cases(Path("cases.csv"), list(MEAN_INPUTS), [row[:8] for row in rows], [2, 3]), parse_bands(["8.0-12.0"]))
    added = np.asarray(lit["radiance_W_m2_sr[8.0-12.0]"]) - np.asarray(dark["radiance_W_m2_sr[8.0-12.0]"])
    tables = {"moon": {"zenith_deg": 75.0, "azimuth_deg": 30.0, "phase_deg": 40.0}, "sun": {"zenith_deg": 130.0, "azimuth_deg": 0.0}}
    tables |= {"band": {"min_um": 8.0, "max_um": 12.0}, "wind": {"speed_m_s": 5.0}, "sensor": {"height_m": 20.0}}
    view = scenario_physics.view(parse_scenario(tables | {"sea": {"slopes": {"kind": "cox-munk-isotropic"}}}))
    expected = mean_radiance(view, [-np.radians(10.0)], [np.radians(30.0)]).sun[0, 0]
    # the bright limb is the lower one in cases, and that towards the Sun in scenarios; the number of bands is that of the light's azimuth
    assert added == pytest.approx([expected, expected], rel=0.01)
    with pytest.raises(SeaglintError, match="moon_phase_deg"):
        evaluate_mean(Cases(Path("cases.csv"), list(names[:-1]), [row[:-1] for row in rows], [2, 3]), parse_bands(["8.0-12.0"]))


@pytest.mark.parametrize(("correlation", "tolerance"), [("time", 0.03), ("waves", 0.06)])
def test_the_likelihood_sees_the_same_moonlight(correlation, tolerance):
    """Draws of one weather under a given Moon, beside the mean radiance of their lines of sight.

    From the waves, the likelihood interpolates between winds.
    """
    tables = {
        "likelihood": {"threshold_w_m2_sr": [1e-4], "case": "single-look", "samples": 256, "depression_deg": [2.0, 20.0],
                       "azimuth_from_sun_deg": [170.0, 190.0], "height_m": [20.0, 20.0]},
        "sun": SMALL["sun"], "wind": SMALL["wind"], "sensor": SMALL["sensor"] | {"height_m": 20.0},
        "sea": {"glint": {"correlation": correlation}},
    }  # fmt: skip
    weather = WeatherTable({"wind_speed_m_s": np.array([7.0]), "cloud_cover": np.zeros(1)})
    for phase, zenith in ((0.0, 70.0), (62.0, 70.0), (95.0, 45.0)):
        for band in ({"min_um": 3.5, "max_um": 5.0}, {"min_um": 8.0, "max_um": 12.0}):
            moon = {"zenith_deg": zenith, "azimuth_deg": 180.0, "phase_deg": phase}
            scenario = parse_scenario(tables | {"moon": moon, "band": band})
            model = LikelihoodModel.of(scenario, weather)
            drawn = draw(model, samples=256)
            view = scenario_physics.view(scenario)
            spread = pixel_deviation(model, drawn)
            depression = np.arcsin(np.clip(np.sin(drawn.sight.elevation), -1.0, 1.0))
            for i in range(0, 256, 37):
                # a sensor 20 m high: the elevation at the sea is the depression within 2 per cent of the horizon's dip
                azimuth = drawn.solar_azimuth[i] + drawn.azimuth_from_sun[i]
                rows = [-float(np.arccos(np.cos(depression[i]) * 7433166.7 / (7433166.7 + 20.0)))]
                light = mean_radiance(view, rows, [azimuth])
                if light.sun[0, 0] < 1e-3 * drawn.radiance.max():
                    continue
                # number of bands of the nested law: the mean over azimuths of the light
                assert drawn.radiance[i] == pytest.approx(light.sun[0, 0], rel=0.015)
                pixel = np.prod(np.radians(scenario.sensor.ifov_deg))
                length = scenario_physics.glint_correlation(scenario)
                assert spread[i] == pytest.approx(float(np.sqrt(sea_variance(view, light, rows, pixel, length)[0, 0])), rel=tolerance)


def test_moonlit_nights_of_a_year():
    """The Moon of each draw lights the sea where it is up, and glint of any light is more frequent than the Sun's."""
    likely = {"threshold_w_m2_sr": [1e-6], "case": "single-look", "samples": 4096, "weather": "north-atlantic", "place": [45.0, -30.0]}
    tables = {"likelihood": likely, "band": {"min_um": 8.0, "max_um": 12.0}}
    with_moon, without = likelihood(parse_scenario(tables | {"moon": {}})), likelihood(parse_scenario(tables))
    chances = [result.estimates[0].value for result in (with_moon, without)]
    assert chances[0] > 1.3 * chances[1]
    drawn = with_moon.draws
    night = drawn.solar_zenith > 1.9
    zenith = MoonEphemeris.of_year(2025).at(drawn.where.time[night], 45.0, -30.0).zenith
    lit = drawn.radiance[night] > 0.0
    assert np.all(zenith[lit] < 0.5 * np.pi + 0.01)
    assert np.mean(lit) > 0.25, "the Moon is up half of the time, and not always behind clouds"
    summary = with_moon.summary()
    assert any("[moon]" in note for note in summary.notes)
    assert not any("[moon]" in note for note in without.summary().notes)
    # refraction and the parallax of one degree nearly cancel
    assert summary.as_dict()["moon_up"]["share"] == pytest.approx(0.5, abs=0.02)
    assert "moon_up" not in without.as_dict()
    told = lines(summary)[-2]
    assert told.startswith("  Sun up in ")
    assert " %, Moon up in " in told
    assert " % of the draws; the brighter one free of clouds in " in told
    assert "Moon" not in lines(without.summary())[-2]


LIKELY = {"likelihood": {"threshold_w_m2_sr": [0.1], "case": "single-look", "place": [45.0, -30.0]}, "moon": {}}


@pytest.mark.parametrize(
    ("refused", "message"),
    [
        (
            lambda: LikelihoodModel.of(parse_scenario(LIKELY | {"likelihood": LIKELY["likelihood"] | {"azimuths": "integrated"}})),
            "likelihood.azimuths = 'integrated'",
        ),
        (lambda: best_looks(parse_scenario(LIKELY), date="2026-06-21"), "the search for the best look"),
        (lambda: likelihood_map(parse_scenario(LIKELY)), "a map of the likelihood"),
    ],
    ids=["integrated", "best looks", "map"],
)
def test_what_has_no_moon_is_refused_in_one_line(refused, message):
    with pytest.raises(SeaglintError, match=r"\[moon\]") as error:
        refused()
    assert message in str(error.value)
    assert "\n" not in str(error.value)
