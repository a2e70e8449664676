"""How often glint matters, end to end, against closed forms."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest
from typer.testing import CliRunner

from seaglint.base.errors import ScenarioError, SeaglintError
from seaglint.cli.app import app
from seaglint.climate.weather_table import WeatherTable
from seaglint.radiance.mean_radiance import mean_radiance
from seaglint.scenario.load import parse_scenario
from seaglint.scenario.sun import sun_position
from seaglint.studies.build import scenario_physics
from seaglint.studies.likelihood.chance_map import likelihood_map
from seaglint.studies.likelihood.glint_chance import likelihood
from seaglint.studies.likelihood.ship_track import along_track

SUN = {"zenith_deg": 72.0, "azimuth_deg": 200.0}
AIR = {"source": "none"}


def table(wind, cover, weight=None, **more):
    columns = {"wind_speed_m_s": np.array(wind, dtype=float), "cloud_cover": np.array(cover, dtype=float)}
    columns |= {name: np.array(values, dtype=float) for name, values in more.items()}
    return WeatherTable(columns if weight is None else columns | {"weight": np.array(weight, dtype=float)})


def scenario(wanted, **more):
    base = {"sun": SUN, "atmosphere": AIR, "sensor": {"height_m": 30.0}, "likelihood": {"samples": 4096, **wanted}}
    return parse_scenario({name: value for name, value in (base | more).items() if value is not None})


def chances(found):
    return [row["probability"] for row in found.as_dict()["results"]]


def test_constant_weather_and_a_fixed_look_are_certain():
    look = {"depression_deg": [3, 3], "azimuth_from_sun_deg": [4, 4]}
    wanted = scenario(look, wind={"speed_m_s": 6.0, "from_deg": 250.0})
    view = scenario_physics.view(wanted)
    exact = float(mean_radiance(view, [-math.radians(3)], [sun_position(wanted).azimuth + math.radians(4)]).sun[0, 0])
    both = scenario(look | {"threshold_w_m2_sr": [0.995 * exact, 1.005 * exact]}, wind={"from_deg": 250.0})
    assert chances(likelihood(both, weather=table([6.0], [0.25]))) == pytest.approx([0.75, 0.0])


@pytest.mark.parametrize(("case", "expected"), [("single-look", 0.35), ("trajectory", 0.7), ("field-of-view", 0.7)])
def test_three_rows_of_weather_hide_the_sun_by_case(case, expected):
    wanted = scenario({"case": case, "threshold_w_m2_sr": [0.0, 1e6], "depression_deg": [1.5, 6.0]})
    found = likelihood(wanted, weather=table([4.0, 8.0, 12.0], [0.1, 0.8, 1.0], [3, 4, 3]))
    rows = found.as_dict()["results"]
    assert rows[0]["interval"][0] <= expected <= rows[0]["interval"][1]
    assert rows[0]["probability"] == pytest.approx(expected, abs=1e-3)
    assert rows[1]["probability"] == 0.0
    assert rows[1]["interval"][1] < 0.001


def test_uniform_azimuth_is_the_share_of_the_corridor():
    look = {"depression_deg": [3, 3], "azimuth_from_sun_deg": [0, 360], "threshold_w_m2_sr": [1.0]}
    kind = {"slopes": {"kind": "cox-munk-isotropic"}}
    found = likelihood(scenario(look, sea=kind), weather=table([6.0], [0.0]))
    view = scenario_physics.view(scenario(look, sea=kind, wind={"speed_m_s": 6.0}))
    azimuth = np.linspace(0.0, 2.0 * np.pi, 7201)[:-1]
    share = float(np.mean(mean_radiance(view, [-math.radians(3)], azimuth).sun[0] > 1.0))
    assert 0.02 < share < 0.5
    low, high = found.as_dict()["results"][0]["interval"]
    assert low - 2e-4 <= share <= high + 2e-4


def test_share_of_time_that_the_sun_is_up():
    # On the equator, refraction and parallax lift the Sun's centre by 0.56 deg: 3.7 % of a 15 deg hour at each end, 0.503 of the day.
    found = likelihood(
        scenario({"threshold_w_m2_sr": [0.0]}, sun=None, place={"latitude_deg": 0, "longitude_deg": 20}), weather=table([5.0], [0.0])
    )
    told = found.as_dict()
    assert told["sun_up"]["share"] == pytest.approx(0.5 + 2 * 0.565 / 360 * 1.05, abs=0.002)  # 16 times 256 points
    assert told["results"][0]["probability"] == pytest.approx(told["sun_up"]["share"], abs=0.003)


def test_the_poles_have_their_seasons():
    def up(month, latitude):
        wanted = {"months": [month], "threshold_w_m2_sr": [0.0]}
        found = likelihood(scenario(wanted, sun=None, place={"latitude_deg": latitude, "longitude_deg": 0}), weather=table([5.0], [0.0]))
        return found.sun_up.value

    assert [up(6, 80), up(12, 80), up(6, -80), up(12, -80)] == [1.0, 0.0, 0.0, 1.0]


def test_weather_of_a_month_is_drawn_in_that_month():
    weather = table([5.0, 5.0], [0.0, 1.0], month=[1, 7])
    place = {"latitude_deg": -40, "longitude_deg": 0}
    january, july = (
        likelihood(scenario({"months": [m], "threshold_w_m2_sr": [0.0]}, sun=None, place=place), weather=weather) for m in (1, 7)
    )
    assert chances(january)[0] > 0.5
    assert chances(july) == [0.0]
    assert any("no rows in February, March, April, November, December (January serves), May" in note for note in january.as_dict()["notes"])


def test_wind_comes_from_where_table_scenario_or_nobody_says():
    # Skewed slopes tell up from down the wind.
    sea = {"slopes": {"kind": "cox-munk-gram-charlier"}}
    look = {"depression_deg": [3, 3], "azimuth_from_sun_deg": [0, 0], "threshold_w_m2_sr": [0.0]}

    def seen(weather, **more):
        return likelihood(scenario(look, sea=sea, **more), weather=weather).draws.radiance

    by_table = seen(table([8.0], [0.0], wind_from_deg=[200.0]))
    by_scenario = seen(table([8.0], [0.0]), wind={"from_deg": 200.0})
    opposite = seen(table([8.0], [0.0], wind_from_deg=[20.0]))
    anywhere = seen(table([8.0], [0.0]))
    assert np.ptp(by_table) == 0.0
    assert by_table[0] == by_scenario[0]
    assert abs(opposite[0] / by_table[0] - 1.0) > 0.02
    assert anywhere.min() == pytest.approx(by_table[0], rel=1e-4)  # down the wind, as it happens
    assert anywhere.max() > 1.02 * by_table[0]


def test_quantities_go_with_each_other():
    look = {"depression_deg": [2, 6], "azimuth_from_sun_deg": [-20, 20], "threshold_w_m2_sr": [0.5, 5.0]}
    weather = table([3.0, 9.0], [0.2, 0.5])
    mean, more, alarms = (
        likelihood(scenario(look | {"quantity": quantity}), weather=weather).as_dict()["results"]
        for quantity in ("mean", "mean-plus-sigma", "false-alarms")
    )
    for a, b, c in zip(mean, more, alarms, strict=True):
        assert a["probability"] < b["probability"]
        assert 0.0 < c["probability"] < b["probability"]
    pixels = parse_scenario({}).sensor.pixels
    rate = alarms[0]["false_alarms_per_hour"] / (alarms[0]["probability"] * 3600 * pixels[0] * pixels[1])
    # pixels of a metre over waves shorter than 2 m: the glint of a pixel lasts some 0.2 s
    assert 3.0 < rate < 10.0
    by_time = scenario(look | {"quantity": "false-alarms"})
    glint = by_time.sea.glint.model_copy(update={"correlation": "time"})
    by_time = by_time.model_copy(update={"sea": by_time.sea.model_copy(update={"glint": glint})})
    alarm = likelihood(by_time, weather=weather).as_dict()["results"][0]
    assert alarm["false_alarms_per_hour"] == pytest.approx(alarm["probability"] * 3600 / 0.07 * pixels[0] * pixels[1])


def test_map_and_way(tmp_path):
    wanted = {"latitudes_deg": [0, 60], "longitudes_deg": [170, -170], "threshold_w_m2_sr": [0.0], "months": [6, 12]}
    weather = table([5.0, 5.0], [0.0, 1.0], latitude_deg=[15, 45], longitude_deg=[175, -175])
    found = likelihood_map(scenario(wanted, sun=None), step=30.0, samples=256, weather=weather)
    chance = found.probability.isel(threshold=0)
    assert chance.latitude.values.tolist() == [15.0, 45.0]
    assert chance.sel(latitude=15.0, month=6).values == pytest.approx(0.53, abs=0.03)
    assert chance.sel(latitude=45.0).values.max() == 0.0
    track = tmp_path / "way.csv"
    times = [f"2026-06-{day:02d}T{hour:02d}:30:00Z" for day in (1, 2) for hour in range(24)]
    track.write_text("time_utc,latitude_deg,longitude_deg\n" + "".join(f"{t},0,0\n" for t in times))
    way = along_track(scenario({"threshold_w_m2_sr": [0.0]}), track, samples=256, weather=table([5.0], [0.0]))
    row = way.results[0]
    assert way.hours == pytest.approx(48.0)
    assert row.hours == pytest.approx(24.0, abs=1e-6)  # the Sun is up in 12 of the 24 looks of a day
    assert row.mean_duration_hours == pytest.approx(12.0)
    assert row.mean_return_hours == pytest.approx(12.0)


@pytest.mark.parametrize(
    ("wanted", "told"),
    [
        ({"depression_deg": [6, 1.5]}, "goes down"),
        ({"latitudes_deg": [30, 60]}, "likelihood.longitudes_deg is missing"),
        ({"case": "trajectroy"}, "did you mean 'trajectory'"),
        ({"threshold_w_m2_sr": []}, "likelihood.threshold_w_m2_sr"),
        ({"quantity": "detection"}, "detection_curve"),
        ({"samples": 10}, "256"),
        ({"hours_utc": [24, 0]}, "hours_utc is empty"),
        ({"hours_utc": [22, 25]}, "hours_utc"),
    ],
)
def test_mistakes_are_told(wanted, told):
    with pytest.raises(ScenarioError, match=told.replace("'", ".")):
        scenario(wanted)


def test_unknown_air_of_a_row_is_named():
    weather = WeatherTable({"wind_speed_m_s": np.array([5.0]), "cloud_cover": np.array([0.0])}, {"atmosphere": np.array(["martian"])})
    with pytest.raises(SeaglintError, match="row 1 by wind: atmosphere = 'martian' is unknown"):
        likelihood(scenario({}, atmosphere=None), weather=weather)


def test_strong_winds_are_counted():
    found = likelihood(scenario({}), weather=table([5.0, 27.0], [0.0, 0.0], [9, 1]))
    assert any("1 rows of weather (10 % of the weight) have winds above 20 m/s" in note for note in found.as_dict()["notes"])


def test_command(tmp_path):
    (tmp_path / "w.csv").write_text("wind_speed_m_s,cloud_cover,weight\n4,0.1,0.3\n8,0.8,0.4\n12,1.0,0.3\n")
    file = tmp_path / "s.toml"
    file.write_text(
        '[sun]\nzenith_deg = 72\n[atmosphere]\nsource = "none"\n[likelihood]\nweather = "w.csv"\nthreshold_w_m2_sr = [0.0, 0.25]\n'
        'case = "single-look"\ndepression_deg = [1.5, 6.0]\nazimuth_from_sun_deg = [0, 360]\nsamples = 1024\n'
    )
    run = CliRunner().invoke(app, ["likelihood", str(file), "--json", "-o", str(tmp_path / "out"), "--progress", "none"])
    assert run.exit_code == 0, run.output
    found = json.loads(run.stdout)
    assert [sorted(row) for row in found["results"]] == [["interval", "probability", "threshold_w_m2_sr"]] * 2
    assert found["results"][0]["probability"] == pytest.approx(0.3 * 0.9 + 0.4 * 0.2, abs=0.003)
    assert sorted(p.name for p in (tmp_path / "out").iterdir()) == ["likelihood.csv", "likelihood.json", "likelihood.png", "strata.csv"]
    assert (tmp_path / "out" / "likelihood.csv").read_text().startswith("threshold_w_m2_sr,probability,interval_low,interval_high\n0,0.3")
    again = CliRunner().invoke(app, ["likelihood", str(file), "-o", str(tmp_path / "out"), "--progress", "none"])
    assert again.exit_code == 2
