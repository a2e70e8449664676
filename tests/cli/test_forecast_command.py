"""``seaglint likelihood --track --forecast``: its files, the same in Python, and mistakes."""

from __future__ import annotations

import json
from pathlib import Path

import forecast_files as made
import numpy as np
import pytest
import xarray as xr

import seaglint as sg


def test_the_command_writes_both_and_python_has_the_same(tmp_path: Path, seaglint) -> None:
    (tmp_path / "s.toml").write_text(
        '[sensor]\nheight_m = 30\n[atmosphere]\nsource = "none"\n[likelihood]\nweather = "w.csv"\nthreshold_w_m2_sr = [0.5, 2.5]\n'
        "depression_deg = [1.5, 6.0]\nazimuth_from_sun_deg = [-40, 40]\n"
    )
    (tmp_path / "w.csv").write_text("wind_speed_m_s,cloud_cover\n4,0.2\n8,0.8\n")
    track, ahead = made.way(tmp_path / "way.csv"), made.wgrib2(tmp_path / "gfs.nc", made.fields())
    given = ("likelihood", tmp_path / "s.toml", "--track", track)
    plain = seaglint(*given, "-o", tmp_path / "plain.csv")
    answer = seaglint(*given, "--forecast", ahead, "--wind-spread", 1.0, "-o", tmp_path / "out")
    assert answer.code == 0, answer.err
    assert {path.name for path in (tmp_path / "out").iterdir()} == {"track.json", "track.csv", "track.png"}
    assert [line for line in answer.out.splitlines() if "forecast" not in line] == plain.out.splitlines()
    assert sum("by the forecast" in line for line in answer.out.splitlines()) == 2
    head, *rows = (tmp_path / "out" / "track.csv").read_text().splitlines()
    before = (tmp_path / "plain.csv").read_text().splitlines()
    assert head == before[0] + ",forecast_probability,wind_speed_m_s,wind_from_deg,cloud_cover"
    assert [row.rsplit(",", 4)[0] for row in rows] == before[1:]
    found = sg.likelihood(tmp_path / "s.toml", track=track, forecast=ahead, wind_spread=1.0)
    told = json.loads((tmp_path / "out" / "track.json").read_text())
    assert found.forecast_probability.dims == ("threshold", "time")
    np.testing.assert_array_equal(found.forecast_hours, [row["forecast_hours"] for row in told["results"]])
    np.testing.assert_array_equal(found.forecast_probability.values.T.ravel(), [row["forecast_probability"] for row in told["way"]])
    assert found.cloud_cover.attrs["units"] == "1"
    found.to_netcdf(tmp_path / "found.nc", engine="h5netcdf")
    xr.testing.assert_identical(xr.load_dataset(tmp_path / "found.nc").forecast_probability, found.forecast_probability)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--forecast", "f.nc"), "a forecast is given without a track"),
        (("--map", "--track", "way.csv"), "--map and --track are given: a map, the way of a ship"),
        (("--track", "way.csv", "--wind-spread", "2"), "--wind-spread 2 is given without a forecast"),
        (("--track", "way.csv", "--forecast", "f.nc", "--cover-spread", "20"), "--cover-spread 20 is outside 0 to 1"),
        (("--track", "way.csv", "--forecast", "none.nc"), "none.nc: cannot be read"),
        (("--track", "way.csv", "--forecast", "way.csv"), "way.csv: cannot be read as a grid of weather"),
        (("--track", "way.csv", "--forecast", "f.nc", "-o", "o.txt"), "give a folder, or a name that ends in .json, .csv or .png"),
        (
            ("--track", "late.csv", "--forecast", "f.nc"),
            "the forecast ends 2026-06-20T18:00Z, before row 2 of the track, 2026-06-20T20:00Z",
        ),
    ],
)
def test_mistakes_are_told_in_a_line(tmp_path: Path, seaglint, monkeypatch, options, message) -> None:
    monkeypatch.chdir(tmp_path)
    Path("s.toml").write_text("[likelihood]\n")
    made.ecmwf(Path("f.nc"), made.fields())
    made.way(Path("way.csv"))
    made.way(Path("late.csv"), (17, 20))
    answer = seaglint("likelihood", "s.toml", *options)
    assert answer.code == 2
    assert message in answer.err
    assert len(answer.err.strip().splitlines()) == 1
