"""Soundings in the layouts of other programs, against the ascent that they were written of."""

from datetime import UTC, datetime

import numpy as np
import pytest
import xarray as xr
from sounding_files import LAYOUTS, ascent, save

from seaglint.base.errors import DataError
from seaglint.formats.soundings.sounding import read_sounding
from seaglint.formats.soundings.sounding_columns import others_left

MODELS = ("tropical", "midlatitude-summer", "midlatitude-winter", "subarctic-summer", "subarctic-winter", "us-standard-1976")


@pytest.mark.parametrize("layout", LAYOUTS)
@pytest.mark.parametrize("model", ["tropical", "midlatitude-winter"])
def test_every_layout_holds_the_same_ascent(tmp_path, layout, model):
    truth = ascent(model)
    found = read_sounding(LAYOUTS[layout](tmp_path, truth))
    assert found.given == truth.z.size
    np.testing.assert_allclose(found.height[1:], truth.z, rtol=2e-3, atol=1.0)
    np.testing.assert_allclose(found.pressure[1:], truth.p, rtol=2e-5, atol=0.06)
    np.testing.assert_allclose(found.temperature[1:], truth.t, atol=0.06)
    low = np.append(False, truth.z < 9000.0)
    np.testing.assert_allclose(found.relative_humidity[low], truth.u[low[1:]], atol=1.0, rtol=0.01)
    profile = found.profile(model)
    water = profile.water_above(found.lowest_given) - profile.water_above(truth.z[-1])
    assert water == pytest.approx(truth.water, rel=0.005)


@pytest.mark.parametrize(
    ("layout", "time", "warmer", "others"),
    [
        ("bufkit", None, 0.0, 2),
        ("bufkit", datetime(2014, 6, 16, 20, tzinfo=UTC), 2.0, 2),
        ("IEM", None, 0.0, 1),
        ("IEM", datetime(2024, 7, 1, 11, tzinfo=UTC), 2.0, 1),
    ],
)
def test_the_nearest_hour_is_taken_and_the_others_are_counted(tmp_path, layout, time, warmer, others):
    truth = ascent()
    found = read_sounding(LAYOUTS[layout](tmp_path, truth), None, time)
    np.testing.assert_allclose(found.temperature[1:], truth.t + warmer, atol=0.06)
    assert any(others_left(others) in note for note in found.reported)
    assert any("the first" in note for note in found.reported) == (time is None)


def test_the_layout_is_told_by_the_content_not_by_the_name(tmp_path):
    kinds = {}
    for layout in ("SHARPpy", "bufkit", "EDT", "IEM", "ARM NetCDF 3", "AVAPS in EOL's format", "AVAPS record", "data frame"):
        path = LAYOUTS[layout](tmp_path, ascent())
        renamed = path.rename(tmp_path / "sounding")
        kinds[layout] = read_sounding(renamed).kind
    assert kinds == {
        "SHARPpy": "SHARPpy's text",
        "bufkit": "bufkit's list",
        "EDT": "table with a line of column names",
        "IEM": "Iowa mesonet's JSON",
        "ARM NetCDF 3": "ARM sonde (NetCDF)",
        "AVAPS in EOL's format": "AVAPS (EOL sounding format)",
        "AVAPS record": "AVAPS (raw record)",
        "data frame": "table with a line of column names",
    }


def number(values):
    return [f"{v:.10g}" for v in values]


def wrong(truth, what):
    """Columns of a table with one column in another unit, and the suspicion."""
    celsius, dew = truth.t - 273.15, truth.dew - 273.15
    names = ["height_m", "pressure_hpa", "temperature_c", "dewpoint_c"]
    values = [truth.z, truth.p, celsius, dew]
    match what:
        case "right":
            return names, values, ""
        case "kelvin right":
            return ["height_m", "pressure_hpa", "temperature_k", "dewpoint_k"], [truth.z, truth.p, truth.t, truth.dew], ""
        case "fahrenheit":
            return names, [truth.z, truth.p, 1.8 * celsius + 32.0, 1.8 * dew + 32.0], "are temperatures in Fahrenheit?"
        case "fahrenheit in _k":
            names = ["height_m", "pressure_hpa", "temperature_k", "dewpoint_k"]
            return names, [truth.z, truth.p, 1.8 * celsius + 32.0, 1.8 * dew + 32.0], "are temperatures in Fahrenheit?"
        case "celsius in _k":
            names = ["height_m", "pressure_hpa", "temperature_k", "dewpoint_k"]
            return names, [truth.z, truth.p, celsius, dew], "are temperatures in Celsius?"
        case "dew points in fahrenheit":
            return names, [truth.z, truth.p, celsius, 1.8 * dew + 32.0], "are dew points in Fahrenheit?"
        case "depression":
            return names, [truth.z, truth.p, celsius, truth.t - truth.dew], "is it a dew-point depression?"
        case "mixing ratio":
            return names, [truth.z, truth.p, celsius, truth.mixing_ratio], "is it a mixing ratio in g/kg?"
        case "feet":
            return names, [truth.z / 0.3048, truth.p, celsius, dew], "are heights in feet?"
        case "exchanged":
            return names, [truth.z, truth.p, dew, celsius], "are the columns or units exchanged?"
    raise AssertionError(what)


WRONG = (
    *("right", "kelvin right", "fahrenheit", "fahrenheit in _k", "celsius in _k", "dew points in fahrenheit"),
    *("depression", "mixing ratio", "feet", "exchanged"),
)


@pytest.mark.parametrize("what", WRONG)
@pytest.mark.parametrize("model", MODELS)
def test_right_units_are_never_suspected_and_wrong_ones_are_named(tmp_path, model, what):
    """Twelve ascents of each model: surface, warmth, humidity, levels and top are drawn."""
    driest = 0.8 if what == "dew points in fahrenheit" else 0.3  # of cold and dry air they are dew points of other air
    random = np.random.default_rng([MODELS.index(model), WRONG.index(what)])
    for _ in range(12):
        top = random.uniform(9e3, 28e3)
        z = np.unique(np.round(np.r_[random.uniform(0.0, 300.0), np.sort(random.uniform(300.0, top, random.integers(15, 120))), top]))
        truth = ascent(model, z, random.uniform(985.0, 1035.0), random.uniform(-4.0, 4.0), random.uniform(driest, 1.2))
        names, values, told = wrong(truth, what)
        path = save(tmp_path, "air.csv", ",".join(names) + "\n" + "\n".join(map(",".join, zip(*map(number, values), strict=True))) + "\n")
        if told:
            with pytest.raises(DataError) as caught:
                read_sounding(path)
            assert told in str(caught.value)
            assert "\n" not in str(caught.value)
        else:
            assert read_sounding(path).given == z.size


def test_blanks_that_hide_a_missing_value_are_refused(tmp_path):
    rows = "height_m pressure_hpa temperature_c dewpoint_c\n0 1013 20 10\n500 955 15\n1000 900 12 5\n"
    with pytest.raises(DataError, match="line 3: 3 values under 4 column names, parted by blanks"):
        read_sounding(save(tmp_path, "air.txt", rows))


def test_several_sondes_in_one_netcdf_are_refused(tmp_path):
    truth = ascent()
    columns = (("pres", truth.p, "hPa"), ("tdry", truth.t, "K"), ("rh", truth.u, "%"), ("alt", truth.z, "m"))
    data = {name: (("sonde", "time"), np.tile(values, (2, 1)), {"units": unit}) for name, values, unit in columns}
    xr.Dataset(data).to_netcdf(tmp_path / "two.nc", engine="h5netcdf")
    with pytest.raises(DataError, match="give a file of one sonde"):
        read_sounding(tmp_path / "two.nc")


@pytest.mark.parametrize("model", MODELS)
def test_forty_soundings_have_the_water_of_an_independent_integral(tmp_path, model):
    """Seven soundings a model, forty-two in all, of 40 to 300 levels to 16 to 30 km, whose files round as stations do."""
    random = np.random.default_rng(MODELS.index(model))
    writers = [LAYOUTS[name] for name in ("SHARPpy", "EDT", "IEM", "data frame", "bufkit", "ARM NetCDF 3", "decimal commas")]
    for writer in writers:
        z = np.unique(
            np.round(
                np.r_[random.uniform(2.0, 400.0), np.sort(random.uniform(400.0, random.uniform(16e3, 30e3), random.integers(40, 300)))]
            )
        )
        truth = ascent(model, z, random.uniform(990.0, 1030.0), random.uniform(-3.0, 3.0), random.uniform(0.4, 1.2))
        found = read_sounding(writer(tmp_path, truth))
        profile = found.profile(model)
        assert profile.water_above(found.lowest_given) - profile.water_above(truth.z[-1]) == pytest.approx(truth.water, rel=0.005)


def test_the_old_layout_of_era5_is_read_at_a_place_and_time(tmp_path):
    """NetCDF 3, integer levels in millibars, packed values, time and level under their old names."""
    truth = ascent(z=np.r_[100.0, np.arange(500.0, 24_001.0, 1000.0)])
    q = 1e-3 * truth.mixing_ratio
    fields = {"z": 9.80665 * truth.geopotential, "t": truth.t, "q": q / (1.0 + q)}
    shape, dims = (2, truth.z.size, 2, 2), ("time", "level", "latitude", "longitude")
    warmer = np.array([0.0, 3.0])[:, None, None, None]
    data = xr.Dataset(
        {name: (dims, np.broadcast_to(v[None, :, None, None], shape) + (warmer if name == "t" else 0.0)) for name, v in fields.items()},
        coords={
            "time": np.array(["2023-05-01T00", "2023-05-01T12"], dtype="datetime64[ns]"),
            "level": ("level", truth.p, {"units": "millibars"}),
            "latitude": [10.25, 10.0],
            "longitude": [-60.0, -59.75],
        },
    )
    path = tmp_path / "old.nc"
    data.to_netcdf(path, engine="scipy", format="NETCDF3_64BIT")
    found = read_sounding(path, (10.1, 300.1), datetime(2023, 5, 1, 10, tzinfo=UTC))
    np.testing.assert_allclose(found.temperature[1:], truth.t + 3.0, atol=0.01)
    np.testing.assert_allclose(found.height[1:], truth.z, atol=0.5)
    assert found.kind == "ERA5 pressure levels"
    assert any("the hour 2023-05-01T12:00 is taken, 1 other is left" in text for text in found.reported)


@pytest.mark.parametrize(
    ("time", "surface", "first"),
    [
        (None, 290.0, ", the first,"),
        (datetime(2024, 7, 2, 1, tzinfo=UTC), 270.0, ""),
        (datetime(2024, 7, 9, tzinfo=UTC), 270.0, ", 168 h from"),
    ],
)
def test_of_several_lists_of_wyoming_one_is_taken_with_a_word(tmp_path, time, surface, first):
    """The page gives one after the other for a range of days."""
    lists = []
    for title, kelvin in (("12Z 01 Jul 2024", 290.0), ("00Z 02 Jul 2024", 270.0)):
        rows = [f"{p:7.1f}{z:7d}{t - 273.15:7.1f}{t - 278.15:7.1f}" for p, z, t in _column(kelvin)]
        head = (
            f"<H2>47600 RJNW Observations at {title}</H2><PRE>\n"
            + "-" * 28
            + "\n   PRES   HGHT   TEMP   DWPT\n    hPa     m      C      C\n"
            + "-" * 28
        )
        lists.append("\n".join([head, *rows, "</PRE><H3>Station information and sounding indices</H3>"]))
    (tmp_path / "month.txt").write_text("\n".join(lists) + "\n")
    found = read_sounding(tmp_path / "month.txt", None, time)
    assert found.temperature[0] == pytest.approx(surface, abs=0.06)
    (note,) = [text for text in found.reported if "1 other is left" in text]
    assert first in note


def _column(kelvin):
    """Levels of an isothermal air: pressure, height and temperature."""
    heights = np.arange(10, 9000, 400)
    return [(1012.0 * np.exp(-9.80665 * (z - 10) / (287.05 * kelvin)), int(z), kelvin) for z in heights]
