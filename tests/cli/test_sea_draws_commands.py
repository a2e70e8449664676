"""``--sea-draws`` of the commands: the interval in files, JSON and text, and refusals."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import pytest
import xarray as xr

TABLES = '[atmosphere]\nsource = "none"\n[sun]\nzenith_deg = 60\nazimuth_deg = 180\n[sensor]\nazimuth_deg = 180\npixels = [6, 4]\n'
LINE = "(3 seas between the campaigns)"


@pytest.fixture
def scenario(tmp_path: Path) -> Path:
    path = tmp_path / "my.toml"
    path.write_text(TABLES)
    return path


def test_mean_writes_two_more_variables_of_each_and_a_line(scenario: Path, tmp_path: Path, seaglint) -> None:
    answer = seaglint("mean", scenario, "-o", tmp_path / "map.nc", "--sea-draws", 3)
    assert answer.code == 0
    assert f"sea unknown: {answer.err.split('sea unknown: ')[1].split(' (')[0]} {LINE}" in answer.err
    with xr.open_dataset(tmp_path / "map.nc") as maps:
        for name in ("radiance", "apparent_temperature", "glint_std"):
            assert bool((maps[f"{name}_sea_low"] <= maps[f"{name}_sea_high"]).all())
            assert maps[f"{name}_sea_low"].units == maps[name].units


def test_evaluate_mean_adds_columns_and_a_line(tmp_path: Path, seaglint) -> None:
    cases, out = tmp_path / "cases.csv", tmp_path / "out.csv"
    cases.write_text(
        "atmosphere,wind_speed_m_s,sensor_height_m,depression_deg,solar_zenith_deg,relative_azimuth_deg,sea_temperature_k,ifov_mrad\n"
        "tropical,5,20,5,60,0,300,0.5\n"
    )
    answer = seaglint("evaluate", "mean", cases, "-o", out, "--band", "3.8-4.0", "--sea-draws", 3)
    assert answer.code == 0
    assert LINE in answer.err
    (row,) = csv.DictReader(out.read_text().splitlines())
    low, high = (float(row[f"radiance_W_m2_sr_sea_unknown_{end}[3.8-4.0]"]) for end in ("low", "high"))
    assert 0.0 < low < high
    assert row["sea_draws"] == "3"


def test_likelihood_prints_the_interval_beside_its_own(tmp_path: Path, seaglint) -> None:
    path = tmp_path / "l.toml"
    path.write_text('[atmosphere]\nsource = "none"\n[likelihood]\nthreshold_w_m2_sr = [1.0]\nsamples = 1024\nazimuths = "drawn"\n')
    (row,) = json.loads(seaglint("likelihood", path, "--json", "--sea-draws", 3, "--progress", "none").out)["results"]
    assert row["sea_draws"] == 3
    assert row["sea_unknown_low"] <= row["sea_unknown_median"] <= row["sea_unknown_high"]
    answer = seaglint("likelihood", path, "-o", tmp_path / "l.png", "--sea-draws", 3, "--progress", "none")
    assert LINE in answer.out
    assert (tmp_path / "l.png").stat().st_size > 10_000


def test_ensemble_writes_a_table_of_its_scenes(tmp_path: Path, seaglint) -> None:
    base = "".join(f"[base.{line[1:]}\n" if line.startswith("[") else f"{line}\n" for line in TABLES.splitlines())
    (tmp_path / "e.toml").write_text(f"[ensemble]\nscenes = 2\n{base}")
    answer = seaglint("ensemble", tmp_path / "e.toml", "-o", tmp_path / "out", "--draw-only", "--sea-draws", 3)
    assert answer.code == 0
    assert LINE in answer.err
    rows = list(csv.DictReader((tmp_path / "out" / "sea_unknown.csv").read_text().splitlines()))
    assert [row["scene"] for row in rows] == ["0", "1"]
    assert all(float(row["glint_std_W_m2_sr_sea_unknown_low"]) < float(row["glint_std_W_m2_sr_sea_unknown_high"]) for row in rows)


def test_detect_scene_has_it_in_json_and_text(tmp_path: Path, scenario: Path, seaglint) -> None:
    scenario.write_text(f"{TABLES.replace('[6, 4]', '[24, 16]')}[sea]\nresolve_waves = false\n")
    arguments = ("detect", "scene", scenario, "--contrast", "5", "--frames", 2, "--injections", 40, "--sea-draws", 3, "--progress", "none")
    result = json.loads(seaglint(*arguments, "--json").out)
    assert result["sea_draws"] == 3
    assert result["sweep"][0]["p_d_sea_unknown_low"] <= result["sweep"][0]["p_d_sea_unknown_high"]
    assert LINE in seaglint(*arguments, "--report", tmp_path / "r.html").out
    assert "sea unknown: P_d" in (tmp_path / "r.html").read_text()


@pytest.mark.parametrize("draws", [1, 0, 5000])
@pytest.mark.parametrize(
    "command",
    [("mean", "-o", "a.nc"), ("likelihood",), ("detect", "scene"), ("ensemble", "-o", "out"), ("evaluate", "mean", "-o", "a.csv")],
)
def test_numbers_without_sense_are_one_line_and_code_2(command, draws, scenario: Path, seaglint, monkeypatch) -> None:
    monkeypatch.chdir(scenario.parent)
    words = 2 if command[0] in ("detect", "evaluate") else 1
    band = ("--band", "3-5") if command[0] == "evaluate" else ()
    answer = seaglint(*command[:words], scenario, *command[words:], *band, "--sea-draws", draws)
    assert answer.code == 2
    lines = [line for line in answer.err.splitlines() if line]
    assert len(lines) == 1
    assert f"{draws} is outside 2 to 1000" in lines[0]


def test_a_scenario_without_short_waves_to_draw_is_one_line_and_code_2(scenario: Path, seaglint) -> None:
    scenario.write_text(f'{TABLES}[mean]\nmode = "article"\n')
    answer = seaglint("mean", scenario, "-o", scenario.parent / "a.nc", "--sea-draws", 3)
    assert answer.code == 2
    assert "mean.mode = 'article'" in answer.err
    assert len(answer.err.strip().splitlines()) == 1
