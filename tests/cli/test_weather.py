"""The commands 'weather build' and 'weather info': files in, a table and counts out, refusals in one line."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import weather_files as made
import xarray as xr

from seaglint.formats.weather.weather_file import read_weather


def test_era5_ships_and_buoys_become_one_table_and_nothing_is_dropped_unsaid(tmp_path, seaglint) -> None:
    made.write_era5_old(tmp_path / "era5.nc", made.era5_fields(), expver=True)
    (tmp_path / "imma1").write_text(made.imma() + "\n" + made.imma(mo=" 1") + "\n")
    (tmp_path / "44011.txt").write_text(made.NDBC_2019)
    out = tmp_path / "w.csv"
    sources = [tmp_path / name for name in ("era5.nc", "imma1", "44011.txt")]
    answer = seaglint(
        "weather", "build", *sources, "-o", out, "--months", "6-8", "--region", "here", "--place", "42.3,290.3", "--fill", "cloud_cover=0.6"
    )
    assert (answer.code, answer.out) == (0, ""), answer.err
    found = read_weather(out)
    assert len(found.table) == 22 + 1 + 1
    assert set(found.table.text("region")) == {"here"}
    assert found.table.months == (7,)
    for line in (
        "era5.nc: ERA5, 36 records, 22 rows; left out: 12 outside the times and places wanted, 2 on land (no sea temperature)",
        "era5.nc: 1 of 3 times are preliminary (expver 5)",
        "imma1: ICOADS IMMA1, 2 records, 1 rows; left out: 1 of other months",
        "44011.txt: NDBC standard meteorological, 3 records, 1 rows; left out: 2 of other months",
        "cloud_cover: 1 missing values filled with 0.6, as asked",
        "rows in July only: they serve all the year",
        f"{out}: 24 rows written",
    ):
        assert line in answer.err.splitlines(), answer.err
    assert [note for note in found.notes if "preliminary" in note]
    assert found.table["longitude_deg"][-1] == pytest.approx(-69.7)
    assert found.table.text("atmosphere")[-1] == "midlatitude-summer"


def test_each_row_of_each_source_counts_alike(tmp_path, seaglint) -> None:
    made.write_era5_new(tmp_path / "era5.nc", made.era5_fields())
    (tmp_path / "imma1").write_text("\n".join([made.imma()] * 33) + "\n")
    assert seaglint("weather", "build", tmp_path / "era5.nc", tmp_path / "imma1", "-o", tmp_path / "w.csv").code == 0
    table = read_weather(tmp_path / "w.csv").table
    assert table.probability[33:].sum() == pytest.approx(0.5, rel=1e-6)


def test_knots_are_not_metres_per_second(tmp_path, seaglint) -> None:
    (tmp_path / "a.csv").write_text("ws,cloud,t\n10,100,2019-07-01T06:00Z\n")
    arguments = ["weather", "build", tmp_path / "a.csv", "-o", tmp_path / "w.csv", "--map", "cloud_cover=cloud:percent", "--map", "time=t"]
    assert seaglint(*arguments, "--map", "wind_speed_m_s=ws:kn").code == 0
    assert read_weather(tmp_path / "w.csv").table["wind_speed_m_s"][0] == pytest.approx(18520 / 3600)
    unknown = seaglint(*arguments, "--map", "wind_speed_m_s=ws:knotts", "--overwrite")
    assert unknown.code == 2
    assert "wind_speed_m_s has the unknown unit 'knotts'" in unknown.err
    other = seaglint(*arguments, "--map", "wind_speed_m_s=ws:K", "--overwrite")
    assert "unit of another kind ('K'); allowed is m/s" in other.err


def test_winds_alone_make_no_table_of_waves_and_files_beside_are_joined(tmp_path, seaglint) -> None:
    fields = made.era5_fields()
    waves = {"swh": fields.pop("swh")}
    made.write_era5_new(tmp_path / "winds.nc", fields)
    made.write_era5_new(tmp_path / "waves.nc", waves)
    alone = seaglint("weather", "build", tmp_path / "waves.nc", "-o", tmp_path / "w.csv")
    assert alone.code == 2
    assert "has no wind (u10, v10); give the file with the winds of the same times beside it" in alone.err
    both = seaglint("weather", "build", tmp_path / "waves.nc", tmp_path / "winds.nc", "-o", tmp_path / "w.csv")
    assert both.code == 0, both.err
    table = read_weather(tmp_path / "w.csv").table
    assert np.sort(table["significant_height_m"]) == pytest.approx(np.sort(waves["swh"][~np.isnan(waves["swh"])]), rel=1e-6)
    later = xr.open_dataset(tmp_path / "waves.nc").load()
    later["valid_time"] = later["valid_time"] + np.timedelta64(30, "D")
    later.to_netcdf(tmp_path / "later.nc", engine="h5netcdf")
    idle = seaglint("weather", "build", tmp_path / "later.nc", tmp_path / "winds.nc", "-o", tmp_path / "x.csv")
    assert "later.nc: nothing of it is used" in idle.err


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--months", "13"], "--months '13' is not whole numbers 1 to 12"),
        (["--hours", "24"], "--hours '24' is not whole numbers 0 to 23"),
        (["--box", "1,2,3"], "--box '1,2,3' is not four numbers; write west,south,east,north"),
        (["--box", "0,60,10,30"], "is not west,south,east,north"),
        (["--polygon", "1,2 3,4"], "a polygon of 2 corners"),
        (["--months", "3"], "no rows in months March"),
        (["--box", "0,0,1,1"], "give a source without places its own with --place LAT,LON"),
        (["--fill", "cloud=1"], "'cloud' cannot be filled; allowed are"),
        (["--fill", "cloud_cover=60"], "fill cloud_cover = 60 is outside the range allowed: 0 to 1"),
        (["--fill", "cloud_cover=much"], "is not NAME=VALUE with a number"),
        (["--place", "100,0"], "--place '100,0' is not latitude,longitude"),
        (["--map", "wind=ws"], "'wind' is not one of weight, wind_speed_m_s"),
        (["--anemometer-height", "0.1"], "--anemometer-height 0.1 is outside 1 to 150 m"),
    ],
)
def test_options_that_cannot_be_used_are_told_in_one_line(tmp_path, seaglint, arguments, said) -> None:
    (tmp_path / "44011.txt").write_text(made.NDBC_2019)
    answer = seaglint("weather", "build", tmp_path / "44011.txt", "-o", tmp_path / "w.csv", *arguments)
    assert answer.code == 2
    assert said in answer.err
    assert answer.err.count("\n") == 1
    assert not (tmp_path / "w.csv").exists()


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("wind_speed_m_s,cloud_cover,month\n3,0.5,13\n", "column month: month = 13 is outside the range allowed: 1 to 12"),
        ("wind_speed_m_s,cloud_cover\n3,1.5\n", "column cloud_cover: cloud_cover = 1.5 is outside the range allowed: 0 to 1"),
        (made.imma(mo="13") + "\n", "1 of 1 lines are no IMMA records: 1 with a month outside 1 to 12; the first is line 1"),
        ("7" * 1_000_000 + "\n", "which is no weather that is read"),
        ("a," * 500_000 + "b\n1\n", "columns are a, a, a"),
    ],
)
def test_impossible_files_are_told_in_one_line(tmp_path, seaglint, text, said) -> None:
    (tmp_path / "a.csv").write_text(text)
    answer = seaglint("weather", "build", tmp_path / "a.csv", "-o", tmp_path / "w.csv")
    assert (answer.code, answer.out) == (2, "")
    assert said in answer.err
    assert answer.err.count("\n") == 1
    assert len(answer.err) < 1000


def test_other_files_and_outputs_are_refused(tmp_path, seaglint) -> None:
    (tmp_path / "44011.txt").write_text(made.NDBC_2019)
    (tmp_path / "notes.txt").write_text("hello\n")
    assert "is no weather that is read" not in seaglint("weather", "build", tmp_path / "44011.txt", "-o", tmp_path / "w.csv").err
    assert "begins with 'hello'" in seaglint("weather", "build", tmp_path / "notes.txt", "-o", tmp_path / "x.csv").err
    assert "cannot be read (No such file" in seaglint("weather", "build", tmp_path / "none", "-o", tmp_path / "x.csv").err
    assert "give a name that ends in .csv or .parquet" in seaglint("weather", "build", tmp_path / "44011.txt", "-o", tmp_path / "x.nc").err
    assert "exists already" in seaglint("weather", "build", tmp_path / "44011.txt", "-o", tmp_path / "w.csv").err
    grib = tmp_path / "a.grib"
    grib.write_bytes(b"GRIB" + bytes(20))
    assert "pip install 'cfgrib>=0.9.15'" in seaglint("weather", "build", grib, "-o", tmp_path / "x.csv").err


def test_a_region_of_a_table_is_selected_and_one_without_data_is_named(tmp_path, seaglint) -> None:
    (tmp_path / "a.csv").write_text("wind_speed_m_s,cloud_cover,region\n3,0.1,north\n9,0.9,south\n")
    made_one = seaglint("weather", "build", tmp_path / "a.csv", "-o", tmp_path / "w.csv", "--region", "south")
    assert "left out: 1 of other regions" in made_one.err
    assert read_weather(tmp_path / "w.csv").table["wind_speed_m_s"].tolist() == [9.0]
    none = seaglint("weather", "build", tmp_path / "a.csv", "-o", tmp_path / "x.csv", "--region", "west")
    assert "region 'west' has no rows; the file has north, south" in none.err


@pytest.mark.validation
def test_polygons_of_files(tmp_path, seaglint) -> None:
    made.write_era5_new(tmp_path / "era5.nc", made.era5_fields())
    corners = [[-0.3, 49.9], [0.1, 49.9], [0.1, 50.1], [-0.3, 50.1], [-0.3, 49.9]]
    (tmp_path / "p.geojson").write_text(json.dumps({"type": "Feature", "geometry": {"type": "Polygon", "coordinates": [corners]}}))
    (tmp_path / "p.csv").write_text("lon,lat\n" + "\n".join(f"{x},{y}" for x, y in corners[:4]) + "\n")
    for k, area in enumerate(["-0.3,49.9 0.1,49.9 0.1,50.1 -0.3,50.1", tmp_path / "p.geojson", tmp_path / "p.csv"]):
        out = tmp_path / f"w{k}.csv"
        answer = seaglint("weather", "build", tmp_path / "era5.nc", "-o", out, "--polygon", area)
        assert answer.code == 0, answer.err
        assert set(read_weather(out).table["longitude_deg"]) == {-0.25, 0.0}


def test_info_tells_and_draws_a_table(tmp_path: Path, seaglint) -> None:
    (tmp_path / "w.csv").write_text(
        "# of a test\nwind_speed_m_s,wind_from_deg,cloud_cover,weight,month\n3,350,0.125,1,1\n9,,1,3,7\n6,10,,4,7\n"
    )
    answer = seaglint("weather", "info", tmp_path / "w.csv", "--json", "--plot", tmp_path / "w.png")
    assert answer.code == 0, answer.err
    facts = json.loads(answer.out)
    assert (facts["rows"], facts["weight_sum"], facts["months"]) == (3, 8.0, [1, 7])
    assert facts["missing_months"]["December"] == "January"
    assert facts["columns"]["wind_speed_m_s"]["mean"] == pytest.approx((3 + 27 + 24) / 8)
    assert facts["columns"]["cloud_cover"]["missing_share"] == pytest.approx(0.5)
    assert facts["missing_share"]["sea_temperature_k"] == 1.0
    assert sum(facts["wind_rose"]["probability"][0]) == pytest.approx(5 / 8)  # 350 and 10 deg are both north
    assert facts["notes"] == ["of a test", "weights sum to 8 and are divided by it"]
    assert (tmp_path / "w.png").read_bytes()[:4] == b"\x89PNG"
    text = seaglint("weather", "info", tmp_path / "w.csv").out
    assert "most frequent wind from 0 deg, 62.5 % of the weight" in text
    assert (
        "no rows in February, March, April, November, December (January serves), May, June, August, September, October (July serves)"
        in text
    )
    assert "needed are wind_speed_m_s, cloud_cover" in seaglint("weather", "info", _bad(tmp_path)).err
    assert "north-atlantic: 1188 rows" in seaglint("weather", "info", "north-atlantic").out


def _bad(folder: Path) -> Path:
    path = folder / "bad.csv"
    path.write_text("wind,cloud\n1,2\n")
    return path


def test_the_climatology_is_described_and_built_from(seaglint, tmp_path: Path) -> None:
    facts = json.loads(seaglint("weather", "info", "world", "--json").out)
    assert facts["rows"] == 1788 * 12 * 99
    assert any("rest on fewer than 10 wind observations" in note for note in facts["notes"])
    assert facts["columns"]["wind_speed_m_s"]["mean"] == pytest.approx(7.14, abs=0.02)
    out = seaglint("weather", "build", "world", "--place", "30,-60", "--months", "7", "-o", tmp_path / "bermuda.csv")
    assert "99 rows written" in out.err
    assert "world: climatology, 99 records, 99 rows" in out.err
    box = seaglint("weather", "build", "world", "--box", "-60,30,-50,40", "-o", tmp_path / "box.csv")
    assert f"{3 * 3 * 12 * 99} rows written" in box.err
    land = seaglint("weather", "build", "world", "--place", "48.1,11.6", "-o", tmp_path / "land.csv")
    assert land.code == 2
    assert "nearest sea of the climatology is [54, 5]" in land.err
