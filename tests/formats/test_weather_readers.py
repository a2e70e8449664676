"""Readers of weather: what an independent reader finds in files of the exact layouts, and what bad files are told."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import weather_files as made
import xarray as xr

from seaglint.base.errors import BackendError, DataError, ScenarioError
from seaglint.climate.weather_selection import GeographicBox, Selection
from seaglint.climate.weather_table import WeatherTable
from seaglint.formats.weather import era5_weather as era5
from seaglint.formats.weather import marine_reports
from seaglint.formats.weather import marine_reports as ndbc
from seaglint.formats.weather.weather_file import SHIPPED, WeatherReading, read_source, read_weather, write_weather
from seaglint.scenario.load import parse_scenario
from seaglint.scenario.records.quantities import PACKAGED
from seaglint.scenario.text.option_texts import parse_map


def _independent(path: Path) -> pd.DataFrame:
    """Rows of an ERA5 file as xarray and pandas have them, land left out."""
    data = xr.open_dataset(path)
    if "expver" in data.dims:
        data = data.sel(expver=1, drop=True).fillna(data.sel(expver=5, drop=True))
    frame = data.rename({"valid_time": "time"} if "valid_time" in data.dims else {}).to_dataframe().reset_index()
    frame = frame[frame["sst"].notna()]
    frame["longitude"] = frame["longitude"].where(frame["longitude"] < 180.0, frame["longitude"] - 360.0)
    return frame.sort_values(["time", "latitude", "longitude"]).reset_index(drop=True)


@pytest.mark.parametrize("layout", ["time, packed", "time, expver", "valid_time", "valid_time, west and east"])
def test_era5_rows_are_those_of_an_independent_reader(tmp_path: Path, layout: str) -> None:
    fields, path = made.era5_fields(), tmp_path / "era5.nc"
    if layout.startswith("valid"):
        made.write_era5_new(path, fields, west_east="west" in layout)
    else:
        made.write_era5_old(path, fields, expver="expver" in layout)
    source = era5.read_era5(path, Selection())
    expected = _independent(path)
    order = np.lexsort([source.columns[n] for n in ("longitude_deg", "latitude_deg", "hour_utc", "month")])
    column = {name: values[order] for name, values in source.columns.items()}

    assert source.rows == len(expected) == 33
    assert source.left_out == {"on land (no sea temperature)": 3}
    assert ("1 of 3 times are preliminary (expver 5)" in source.notes) == (layout != "time, packed")
    # Readers may unpack in float32; 1e-6 of 300 K is a tenth of the packing's step.
    np.testing.assert_allclose(column["wind_speed_m_s"] ** 2, expected["u10"] ** 2 + expected["v10"] ** 2, rtol=2e-6)
    east = -column["wind_speed_m_s"] * np.sin(np.radians(column["wind_from_deg"]))
    np.testing.assert_allclose(east, expected["u10"], atol=1e-5)
    np.testing.assert_allclose(column["cloud_cover"], expected["tcc"], atol=2e-5)
    for ours, theirs in (("sea_temperature_k", "sst"), ("air_temperature_k", "t2m"), ("significant_height_m", "swh")):
        np.testing.assert_allclose(column[ours], expected[theirs], rtol=1e-6)
    np.testing.assert_array_equal(column["month"], expected["time"].dt.month)
    np.testing.assert_array_equal(column["hour_utc"], expected["time"].dt.hour)
    np.testing.assert_allclose(column["longitude_deg"], expected["longitude"])
    np.testing.assert_allclose(column["weight"], np.cos(np.radians(expected["latitude"])))


def test_temperatures_in_degrees_celsius_and_humidity(tmp_path: Path) -> None:
    """Humidity of the dew point by Magnus' formula, or the one of the file itself, which needs no dew point."""
    data = xr.open_dataset(made.write_era5_new(tmp_path / "e.nc", made.era5_fields())).load()
    sea, air, dew = (data[name].values[~np.isnan(data["sst"].values)].astype(float) for name in ("sst", "t2m", "d2m"))
    for name in ("sst", "t2m", "d2m"):
        data[name] = (data[name] - 273.15).assign_attrs(units="degC")
    data.to_netcdf(tmp_path / "c.nc", engine="h5netcdf")
    source = era5.read_era5(tmp_path / "c.nc", Selection())
    np.testing.assert_allclose(source.columns["sea_temperature_k"], sea, rtol=1e-6)
    np.testing.assert_allclose(source.columns["air_temperature_k"], air, rtol=1e-6)
    pressure, own = (np.exp(17.625 * (k - 273.15) / (k - 30.11)) for k in (air, dew))
    np.testing.assert_allclose(source.columns["relative_humidity"], own / pressure, rtol=1e-5)
    share = data["d2m"].assign_attrs(units="%").copy(data=np.full(data["d2m"].shape, 70.0))
    data.drop_vars("d2m").assign(r2=share).to_netcdf(tmp_path / "r.nc", engine="h5netcdf")
    source = era5.read_era5(tmp_path / "r.nc", Selection())
    np.testing.assert_allclose(source.columns["relative_humidity"], 0.7)
    assert not [note for note in source.notes if note.startswith("not in the file")]


def test_a_westerly_of_era5_comes_from_the_west(tmp_path: Path) -> None:
    fields = made.era5_fields()
    fields["u10"][:], fields["v10"][:] = 7.0, 0.0
    fields["u10"][0, 0, 0], fields["v10"][0, 0, 0] = 0.0, -3.0
    source = era5.read_era5(made.write_era5_new(tmp_path / "e.nc", fields), Selection())
    assert sorted(set(source.columns["wind_from_deg"].round(6))) == [0.0, 270.0]


def test_packed_shares_stay_shares(tmp_path: Path) -> None:
    fields = made.era5_fields()
    source = era5.read_era5(made.write_era5_old(tmp_path / "e.nc", fields), Selection())
    cloud = source.columns["cloud_cover"]
    assert (cloud.min(), cloud.max()) == pytest.approx((0.0, 1.0), abs=1e-9)
    assert not source.set_missing
    # Interpolation of packed numbers leads beyond 0 and 1.
    fields["tcc"][0, 0, :2] = -0.0005, 1.0005
    source = era5.read_era5(made.write_era5_new(tmp_path / "n.nc", fields), Selection())
    assert (source.columns["cloud_cover"].min(), source.columns["cloud_cover"].max()) == (0.0, 1.0)
    assert not source.set_missing


def test_a_box_across_greenwich_and_a_month_are_read_alone(tmp_path: Path) -> None:
    path = made.write_era5_new(tmp_path / "e.nc", made.era5_fields())
    source = era5.read_era5(path, Selection(box=GeographicBox(-0.3, 49.9, 0.1, 50.1), months=(7,), hours=(18,)))
    assert sorted(source.columns["longitude_deg"]) == [-0.25, 0.0]
    assert set(source.columns["month"]) == {7.0}
    assert source.left_out == {"outside the times and places wanted": 34}
    with pytest.raises(DataError, match=r"nothing in months March; the file covers latitudes 49.75 to 50.25.*months 1, 7"):
        era5.read_era5(path, Selection(months=(3,)))


def test_waves_of_a_coarser_grid_are_joined_by_time_and_nearest_place(tmp_path: Path) -> None:
    fields = made.era5_fields()
    waves = {"swh": fields.pop("swh")}
    path = made.write_era5_new(tmp_path / "winds.nc", fields)
    coarse = xr.open_dataset(made.write_era5_new(tmp_path / "w.nc", waves)).isel(latitude=[0, 2], longitude=[0, 2], valid_time=[1, 2])
    coarse.load().to_netcdf(tmp_path / "waves.nc", engine="h5netcdf")
    source = era5.read_era5(path, Selection(), beside=[tmp_path / "waves.nc"])
    at = (source.columns["latitude_deg"] == 50.25) & (source.columns["longitude_deg"] == 0.25) & (source.columns["hour_utc"] == 6)
    assert source.columns["significant_height_m"][at] == pytest.approx(waves["swh"][1, 0, 0], rel=1e-6)
    assert np.isnan(source.columns["significant_height_m"][source.columns["month"] == 1]).all()
    assert any("swh from waves.nc, same time and nearest place, 2 of 3 times" in note for note in source.notes)
    # A further file fills the gaps alone.
    further = made.write_era5_new(tmp_path / "further.nc", {"swh": 2.0 * waves["swh"]})
    both = era5.read_era5(path, Selection(), beside=[tmp_path / "waves.nc", further]).columns["significant_height_m"]
    first = source.columns["significant_height_m"]
    np.testing.assert_array_equal(both[~np.isnan(first)], first[~np.isnan(first)])
    january = (source.columns["latitude_deg"] == 50.25) & (source.columns["longitude_deg"] == 0.25) & (source.columns["month"] == 1)
    assert both[january] == pytest.approx(2.0 * waves["swh"][0, 0, 1], rel=1e-6)


def test_an_unknown_unit_and_several_members_are_refused(tmp_path: Path) -> None:
    data = xr.open_dataset(made.write_era5_new(tmp_path / "e.nc", made.era5_fields())).load()
    data["sst"].attrs["units"] = "degF"
    data.to_netcdf(tmp_path / "f.nc", engine="h5netcdf")
    with pytest.raises(DataError, match=r"f.nc: sst has the unknown unit 'degF'; allowed are K, kelvin"):
        era5.read_era5(tmp_path / "f.nc", Selection())
    data["sst"].attrs["units"] = "K"
    xr.concat([data.drop_vars("number")] * 2, xr.IndexVariable("number", [0, 1])).to_netcdf(tmp_path / "n.nc", engine="h5netcdf")
    with pytest.raises(DataError, match=r"n.nc: has 2 entries of 'number'; select one"):
        era5.read_era5(tmp_path / "n.nc", Selection())


def test_grib_without_cfgrib_names_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "cfgrib", None)
    path = tmp_path / "era5.grib"
    path.write_bytes(b"GRIB\0\0\0\1")
    with pytest.raises(BackendError, match=r"era5.grib: GRIB needs cfgrib.*pip install 'cfgrib>=0\.9\.15'"):
        read_source(path, Selection(), WeatherReading())


@pytest.mark.parametrize("times", [3, 1])
def test_grib_has_the_values_that_were_packed(tmp_path: Path, times: int) -> None:
    """Waves in a file of their own; a single time has no dimension."""
    pytest.importorskip("cfgrib")
    fields = {name: values[:times] for name, values in made.era5_fields().items()}
    waves = {"swh": fields["swh"]}
    path = made.write_era5_grib(tmp_path / "era5.grib", {name: values for name, values in fields.items() if name != "swh"})
    source = era5.read_era5(path, Selection(), beside=[made.write_era5_grib(tmp_path / "waves.grib", waves)])
    sea = ~np.isnan(fields["sst"]).ravel()
    assert source.rows == sea.sum() == 11 * times
    # Half a step of 16 bits over 20 m/s or K.
    speed = np.hypot(fields["u10"], fields["v10"]).ravel()[sea]
    np.testing.assert_allclose(source.columns["wind_speed_m_s"], speed, atol=1e-3)
    np.testing.assert_allclose(source.columns["sea_temperature_k"], fields["sst"].ravel()[sea], atol=5e-4)
    np.testing.assert_allclose(source.columns["significant_height_m"], fields["swh"].ravel()[sea], atol=5e-4)
    assert set(source.columns["longitude_deg"]) == {-10.0, -9.75, -9.5, -9.25}


def test_the_core_of_imma_has_108_characters() -> None:
    assert max(last for _, last in marine_reports.LAYOUT.values()) == 108
    # Columns of the published table C0, counted from 1.
    assert {name: marine_reports.LAYOUT[name][0] + 1 for name in ("LAT", "D", "W", "VV", "AT", "DPT", "SST", "N", "WH", "SH")} == {
        "LAT": 13, "D": 47, "W": 51, "VV": 55, "AT": 70, "DPT": 80, "SST": 86, "N": 90, "WH": 101, "SH": 107,
    }  # fmt: skip


def test_imma_records_are_those_of_pandas_fixed_width(tmp_path: Path) -> None:
    records = [
        made.imma(),
        made.imma(
            mo="12", hr="2350", lat="-1050", lon=" -4025", d="361", w="  0", n="9", ww="45", at="-105", dpt="    ", sst="  -8", vv="90"
        ),
        made.imma(d="362", w=" 31", n="9", ww="02", wh="  ", sh="  ", vv="  "),
        made.imma(d="   ", w="   ", n=" ", lat="     ", lon="      "),
    ]
    path = tmp_path / "imma1"
    path.write_text("\n".join(records) + "\n")
    source = read_source(path, Selection(), WeatherReading())
    column = source.columns
    specs = [marine_reports.LAYOUT[name] for name in ("HR", "LAT", "LON", "W", "AT", "SST")]
    frame = pd.read_fwf(io.StringIO("\n".join(records)), colspecs=specs, header=None, names=["HR", "LAT", "LON", "W", "AT", "SST"])
    np.testing.assert_allclose(column["hour_utc"], frame["HR"] / 100)
    np.testing.assert_allclose(column["latitude_deg"], frame["LAT"] / 100)
    np.testing.assert_allclose(column["longitude_deg"], [-29.25, -40.25, -29.25, np.nan])
    np.testing.assert_allclose(column["wind_speed_m_s"], frame["W"] / 10)
    np.testing.assert_allclose(column["air_temperature_k"], frame["AT"] / 10 + 273.15)
    np.testing.assert_allclose(column["sea_temperature_k"], frame["SST"] / 10 + 273.15)
    np.testing.assert_array_equal(column["wind_from_deg"], [270.0, np.nan, np.nan, np.nan])
    np.testing.assert_array_equal(column["cloud_cover"], [0.75, 1.0, np.nan, np.nan])
    np.testing.assert_allclose(column["significant_height_m"][:3], [2.5, 2.5, np.nan])  # 1.5 m of waves and 2 m of swell
    np.testing.assert_array_equal(column["visibility_km"], [10.0, 0.025, np.nan, 10.0])
    assert source.set_missing["cloud_cover of a sky obscured by other than fog, rain or snow"] == 1
    assert "1 skies hidden by fog, rain or snow count as overcast" in source.notes


def test_icoads_csv_in_both_spellings(tmp_path: Path) -> None:
    short = tmp_path / "a.csv"
    short.write_text("YR,MO,DY,HR,LAT,LON,D,W,VV,WW,AT,DPT,SST,N,WH,SH\n2005,7,14,6.5,45.12,330.75,270,10.3,97,2,15.2,10.1,16.4,6,3,4\n")
    long = tmp_path / "b.csv"
    long.write_text(
        "STATION,DATE,LATITUDE,LONGITUDE,WIND_DIR,WIND_SPEED,VISIBILITY,PRES_WX,AIR_TEMP,DEW_PT_TEMP,SEA_SURF_TEMP,TOT_CLD_AMT,WAVE_HGT,SWELL_HGT\n"
        "SHIP,2005-07-14T06:30:00,45.12,-29.25,270,103,97,2,152,101,164,6,3,4\n"
    )
    text = tmp_path / "imma1"
    text.write_text(made.imma() + "\n")
    expected = read_source(text, Selection(), WeatherReading()).columns
    for path in (short, long):
        found = read_source(path, Selection(), WeatherReading()).columns
        for name, values in expected.items():
            np.testing.assert_allclose(found[name], values, rtol=1e-12, err_msg=f"{path.name} {name}")


@pytest.mark.parametrize(
    ("text", "speed", "sea", "hour", "month"),
    [
        (made.NDBC_2019, [12.3, np.nan, 0.0], [281.35, 281.45, 290.35], [50 / 60, 1 + 50 / 60, 2 + 50 / 60], [1, 1, 7]),
        (made.NDBC_1996, [8.7, 3.1], [280.65, 282.65], [23.0, 0.0], [12, 6]),
        (made.NDBC_REALTIME, [7.0, np.nan], [278.65, np.nan], [11 + 50 / 60, 10 + 50 / 60], [3, 3]),
    ],
)
def test_ndbc_of_all_generations(
    tmp_path: Path, text: str, speed: list[float], sea: list[float], hour: list[float], month: list[int]
) -> None:
    path = tmp_path / "44011.txt"
    path.write_text(text)
    column = read_source(path, Selection(), WeatherReading()).columns
    np.testing.assert_allclose(column["wind_speed_m_s"], speed)
    np.testing.assert_allclose(column["sea_temperature_k"], sea)
    np.testing.assert_allclose(column["hour_utc"], hour)
    np.testing.assert_array_equal(column["month"], month)
    assert np.isnan(column["cloud_cover"]).all()


def test_ndbc_years_of_two_digits_go_on_after_1999(tmp_path: Path) -> None:
    """The last record is of 24 h, which is midnight of the next day, a month later."""
    head, row, _ = made.NDBC_1996.splitlines()
    path = tmp_path / "44011.txt"
    path.write_text("\n".join([head, *(row.replace("96 12 31 23", date) for date in ("99 12 31 23", "00 01 01 00", "00 01 31 24"))]) + "\n")
    source = read_source(path, Selection(), WeatherReading())
    assert not [note for note in source.notes if "sorted" in note]
    assert source.columns["month"].tolist() == [12, 1, 2]
    assert source.columns["hour_utc"].tolist() == [23, 0, 0]


def test_ndbc_values_are_those_of_pandas(tmp_path: Path) -> None:
    path = tmp_path / "44011h2019.txt"
    path.write_text(made.NDBC_2019)
    column = read_source(path, Selection(), WeatherReading()).columns
    frame = pd.read_csv(path, sep=r"\s+", skiprows=[1], na_values={"WDIR": 999, "WVHT": 99.0, "ATMP": 999.0, "VIS": 99.0})
    np.testing.assert_allclose(column["significant_height_m"], frame["WVHT"])
    np.testing.assert_allclose(column["air_temperature_k"], frame["ATMP"] + 273.15)
    np.testing.assert_allclose(column["visibility_km"], 1.852 * frame["VIS"])
    np.testing.assert_array_equal(column["wind_from_deg"], [310.0, np.nan, np.nan])  # the last is a calm


def test_winds_at_a_low_anemometer_are_brought_to_ten_metres(tmp_path: Path) -> None:
    path = tmp_path / "b.txt"
    path.write_text(made.NDBC_2019)
    column = ndbc.read_ndbc(path, anemometer_m=4.1, place=(42.3, -69.7)).columns
    # A neutral profile over the open sea adds a tenth between 4 and 10 m at 12 m/s.
    assert column["wind_speed_m_s"][0] == pytest.approx(1.1 * 12.3, rel=0.02)
    assert column["longitude_deg"][2] == -69.7


def test_any_csv_by_a_map_of_knots_percent_and_zones(tmp_path: Path) -> None:
    path = tmp_path / "ship.csv"
    path.write_text("when;ws;wd;cloud;t;lon;name\n2019-07-01T01:30+03:00;14;90;75;15;350;a\n2019-01-01T00:00Z;2;45;100;;-10;b\n")
    columns = parse_map(
        [
            "wind_speed_m_s=ws:kn",
            "wind_to_deg=wd",
            "cloud_cover=cloud:percent",
            "time=when",
            "sea_temperature_k=t:degC",
            "longitude_deg=lon",
        ]
    )
    source = read_source(path, Selection(), WeatherReading(columns))
    column = source.columns
    np.testing.assert_allclose(column["wind_speed_m_s"], [14 * 1852 / 3600, 2 * 1852 / 3600])
    np.testing.assert_allclose(column["wind_from_deg"], [270.0, 225.0])
    np.testing.assert_allclose(column["cloud_cover"], [0.75, 1.0])
    np.testing.assert_allclose(column["sea_temperature_k"], [288.15, np.nan])
    np.testing.assert_array_equal(column["month"], [6, 1])  # 22:30 UTC of the last of June
    np.testing.assert_array_equal(column["hour_utc"], [22.5, 0.0])
    np.testing.assert_array_equal(column["longitude_deg"], [-10.0, -10.0])
    assert "columns passed over: name" in source.notes
    assert any("not sorted: 1 go backwards, the first in record 2" in note for note in source.notes)


@pytest.mark.parametrize(
    ("cells", "columns", "said"),
    [
        ("ws,cloud\n3,0.5\n", [], r"line 1: columns are ws, cloud; name the columns to read, e.g. map="),
        ("ws,cloud\n3,50\n", ["wind_speed_m_s=ws", "cloud_cover=cloud"], r"row 1 \(line 2\), column cloud: .* = 50 is outside.*0 to 1"),
        ("ws,cloud\n3,0.5\n", ["wind_speed_m_s=speed"], r"column 'speed' of map=.* is not there; columns are ws, cloud"),
        ("t,ws\n2019-01-01T00:00,3\n", ["time=t", "wind_speed_m_s=ws"], r"row 1 \(line 2\), column t: .* has no time zone; .*utc=True"),
        ("t,ws\nyesterday,3\n", ["time=t", "wind_speed_m_s=ws"], r"'yesterday' is no ISO time"),
        ("ws,cloud\n3,0.5\n", ["cloud_cover=cloud"], r"no column for wind_speed_m_s"),
        ("ws,weight\n3,-1\n", ["wind_speed_m_s=ws"], r"column weight: weight = -1 is outside the range allowed: 0 or more"),
        ("wind_speed_m_s,cloud_cover\n3,x\n", [], r"row 1 \(line 2\), column cloud_cover: 'x' is not a number"),
        ("wind_speed_m_s,cloud_cover,weight\n3,0.1,\n", [], r"column weight: is empty"),
        ("wind_speed_m_s,cloud_cover,weight\n3,0.1,0\n", [], r"all weights are 0"),
        ("wind_speed_m_s,cloud_cover\n3,6\n", [], r"cloud cover is a share of 1; convert oktas or percent"),
    ],
)  # fmt: skip
def test_bad_csv_names_row_file_and_remedy(tmp_path: Path, cells: str, columns: list[str], said: str) -> None:
    path = tmp_path / "bad.csv"
    path.write_text(cells)
    with pytest.raises(DataError, match=rf"bad.csv.*{said}"):
        read_source(path, Selection(), WeatherReading(parse_map(columns)))


@pytest.mark.parametrize("suffix", [".csv", ".parquet"])
def test_tables_come_back_as_they_were_written(tmp_path: Path, suffix: str) -> None:
    if suffix == ".parquet":
        pytest.importorskip("pyarrow")
    rng = np.random.default_rng(1)
    columns = {"wind_speed_m_s": rng.uniform(0, 20, 9).round(4), "cloud_cover": np.r_[np.nan, np.arange(8) / 8], "weight": np.arange(9.0)}
    table = WeatherTable(columns, {"region": np.array(["a, b", *"cdefghij"[:8]])})
    path = write_weather(table, tmp_path / f"w{suffix}", notes=["of a test"])
    found = read_weather(path)
    for name, values in table.columns.items():
        np.testing.assert_array_equal(found.table[name], values)
    assert found.table.text("region").tolist() == table.text("region").tolist()
    assert found.notes == ("of a test",)
    assert found.remarks == ("weights sum to 36 and are divided by it",)
    with pytest.raises(DataError, match="exists already"):
        write_weather(table, path)


def test_the_weather_of_the_package_has_the_names_that_scenarios_take() -> None:
    assert PACKAGED == SHIPPED
    told = (
        r"'nothing.csv' is not the name of a weather in the package \(world, north-atlantic\) or a file that exists; a relative path counts"
    )
    with pytest.raises(ScenarioError, match=told):
        parse_scenario({"likelihood": {"weather": "nothing.csv"}})


def test_parquet_without_pyarrow_names_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "pyarrow", None)
    table = WeatherTable({"wind_speed_m_s": np.ones(1), "cloud_cover": np.ones(1)})
    with pytest.raises(BackendError, match=r"pip install 'pyarrow>=17', or use .csv"):
        write_weather(table, tmp_path / "w.parquet")
