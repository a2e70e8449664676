"""What nobody would write on purpose: one line that names the place, never a traceback, never a number that was not meant."""

from __future__ import annotations

import datetime

import pytest
import xarray as xr

from seaglint.base.errors import DataError, ScenarioError
from seaglint.formats.tables.input_tables import read_cases, read_track
from seaglint.formats.tables.spectra import read_response
from seaglint.formats.tables.table_text import plain_number, read_table
from seaglint.scenario.load import load_scenario, parse_scenario


def refused(text, tmp_path):
    path = tmp_path / "my.toml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(ScenarioError) as caught:
        load_scenario(path)
    assert "\n" not in str(caught.value)
    return str(caught.value)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("[sensor]\nheight_m = " + 400 * "9", "sensor.height_m = 999.* is not finite"),
        ("seed = " + 400 * "9", "seed = 9.* is not finite"),
        ("seed = " + 5000 * "9", "a number of thousands of digits"),
        ("seed = 0x" + 9000 * "f", "a number of thousands of digits"),
        ("seed = " + 3000 * "[", "nested hundreds deep|not valid TOML"),
        (f'[band]\nresponse = "{300 * "a"}"', "is not a file that exists"),
        ('[sensor]\nfov_deg = ["3 dB", 2]', "has a unit of another kind"),
        ('[sensor]\nfov_deg = ["50 %", 2]', "unknown unit|another kind"),
        ('[sensor]\nframe_rate_hz = "60 rpm"', "has a unit of another kind"),
        ('[sensor]\nheight_m = "٣٠ m"', "is not a number with a unit"),
        ("[time]\nutc = 3\n[place]\nlatitude_deg = 1\nlongitude_deg = 2", "time.utc = 3 is not a date and time"),
        ('[time]\nutc = "3"\n[place]\nlatitude_deg = 1\nlongitude_deg = 2', "time.utc = '3' is not a date and time"),
        ("[time]\nutc = 9999-12-31T23:59:59-14:00\n[place]\nlatitude_deg = 1\nlongitude_deg = 2", "outside the years 1800 to 2200"),
        ("[time]\nutc = 0001-01-01T00:00:00+14:00\n[place]\nlatitude_deg = 1\nlongitude_deg = 2", "outside the years 1800 to 2200"),
        (
            "[time]\nutc = 2026-01-01\n[place]\nlatitude_deg = 1\nlongitude_deg = 2\n[sensor]\nframe_rate_hz = 1e-5\nframes = 90000",
            "sensor.frames = 90000 at 1e-05 Hz end after the year 2200",
        ),
        ("[sensor]\nframe_rate_hz = 1e-320", "outside the allowed range: 1e-05 to 100000 Hz"),
    ],
)
def test_scenarios_are_refused_in_one_line(tmp_path, text, told):
    import re

    assert re.search(told, refused(text, tmp_path))


@pytest.mark.parametrize("unit", ["6 deg", "0.10471975511965977 rad", "360 arcmin", "104.71975511965977 mrad"])
def test_angles_of_every_unit_stay(unit):
    found = parse_scenario({"sensor": {"fov_deg": [unit, 3], "pixels": [2, 1]}})
    assert found.sensor.fov_deg[0] == pytest.approx(6.0, rel=1e-12)


@pytest.mark.parametrize("when", ["2026-06-21T17:30:00Z", "2026-06-21 17:30:00", datetime.datetime(2026, 6, 21, 17, 30)])
def test_dates_and_times_stay(when):
    found = parse_scenario({"time": {"utc": when}, "place": {"latitude_deg": 1, "longitude_deg": 2}})
    assert found.time is not None
    assert found.time.utc == datetime.datetime(2026, 6, 21, 17, 30, tzinfo=datetime.UTC)


@pytest.mark.parametrize("cell", ["٣", "1_000", "０.5", "0x10", "", "1,5"])
def test_cells_are_numbers_in_digits_0_to_9(tmp_path, cell):
    with pytest.raises(ValueError):
        plain_number(cell)
    path, quoted = tmp_path / "a.csv", f'"{cell}"'
    path.write_text(f"time_s,east_m\n0,{quoted}\n1,2\n", encoding="utf-8")
    with pytest.raises(DataError, match="line 2"):
        read_track(path)
    table = read_table(path, ["time_s"])
    with pytest.raises(DataError, match=r"line 2: east_m = .* is not a number"):
        table.number(0, "east_m")
    with pytest.raises(DataError, match="row 1"):
        read_cases(path).numbers("east_m")
    path.write_text(f"wavelength_um,response\n3,0\n4,{quoted}\n5,0\n", encoding="utf-8")
    with pytest.raises(DataError, match="line 3"):
        read_response(path)


@pytest.mark.parametrize("read", [read_track, read_response, lambda path: read_table(path, ["a"])])
def test_cells_over_several_lines_are_told(tmp_path, read):
    (tmp_path / "a.csv").write_text('wavelength_um,response\n3,"0\n4",1\n')
    with pytest.raises(DataError, match="line 2: is no row of cells"):
        read(tmp_path / "a.csv")


def test_a_text_for_the_frame_rate_is_told(tmp_path):
    from seaglint.studies.file_contents import describe

    path = tmp_path / "a.nc"
    xr.Dataset({"radiance": (("time", "y", "x"), [[[1.0, 2.0]]])}, {"frame": ("time", [0])}, {"frame_rate_hz": "fast"}).to_netcdf(
        path, engine="h5netcdf"
    )
    with pytest.raises(DataError, match=r"a\.nc: cannot be read as a seaglint file .*make it again"):
        describe(path)
    path.write_bytes(path.read_bytes()[:700])
    with pytest.raises(DataError, match=r"a\.nc: cannot be read as NetCDF 4, or is cut"):
        describe(path)
