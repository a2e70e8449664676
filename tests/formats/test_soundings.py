"""Soundings as people have them: every format, every kind of damage, and every unit that was mistaken."""

import numpy as np
import pytest
import xarray as xr
from sounding_files import humidity_of_dew_point

from seaglint.air.profile.aerosols import HazeWeather
from seaglint.air.profile.air_profile import model_profile, saturation_density
from seaglint.air.profile.air_sums import AirSums
from seaglint.air.protocol import wavenumber_grid
from seaglint.base.errors import DataError
from seaglint.formats.soundings.sounding import geometric_height, read_sounding
from seaglint.formats.soundings.sounding_checks import DRY_AIR, hydrostatic_thickness, virtual_temperature
from seaglint.formats.soundings.sounding_columns import RawSounding

HEAD = "height_m,pressure_hpa,temperature_k,relative_humidity_percent\n"
Z = np.array([5.0, 120.0, 300.0, 640.0, 1010.0, 1560.0, 2200.0, 3150.0, 4350.0, 5900.0, 7600.0, 9700.0, 12_300.0, 16_600.0, 20_700.0])
"""Heights of the ascent that all files hold [m]."""


def ascent():
    """Pressure [hPa], temperature [K] and relative humidity [%] at :data:`Z`, hydrostatic."""
    base = model_profile("midlatitude-summer")
    kelvin = np.interp(Z, base.height, base.temperature)
    humidity = np.interp(Z, base.height, base.relative_humidity)
    pressure = [1012.0]
    for i in range(1, Z.size):
        p = pressure[-1]
        for _ in range(3):  # the humidity of the layer acts on its thickness
            warm = 0.5 * (
                virtual_temperature(kelvin[i - 1], pressure[-1], humidity[i - 1]) + virtual_temperature(kelvin[i], p, humidity[i])
            )
            gravity = 9.81 * (6_356_766.0 / (6_356_766.0 + 0.5 * (Z[i] + Z[i - 1]))) ** 2
            p = pressure[-1] * np.exp(-(Z[i] - Z[i - 1]) * gravity / (DRY_AIR * float(warm)))
        pressure.append(float(p))
    return np.array(pressure), kelvin, humidity


P, T, U = ascent()


def dew_point():
    """Dew points [K] of the ascent, found by bisection in LOWTRAN7's saturation."""
    low, high = np.full(T.size, 150.0), T.copy()
    for _ in range(60):
        middle = 0.5 * (low + high)
        wet = humidity_of_dew_point(T, middle) > U
        low, high = np.where(wet, low, middle), np.where(wet, middle, high)
    return high


DEW = dew_point()


def mixing_ratio():
    """Mixing ratios [g kg-1] of the ascent."""
    vapour = 1e-5 * saturation_density(T) * 461.5 * T * U / 100.0
    return 1e3 * 0.62198 * vapour / (P - vapour)


def table(columns, values, separator=","):
    rows = [separator.join(f"{v:.10g}" if isinstance(v, float) else str(v) for v in row) for row in zip(*values, strict=True)]
    return separator.join(columns) + "\n" + "\n".join(rows) + "\n"


def write(folder, text, name="air.csv"):
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def ours(folder):
    columns = ("height_m", "pressure_hpa", "temperature_k", "relative_humidity_percent")
    return write(folder, table(columns, (Z, P, T, U)))


def geopotential():
    return Z * 6_356_766.0 / (6_356_766.0 + Z)


def wyoming_list(folder, *, blanks=()):
    """University of Wyoming's text list, columns of seven; some levels have blanks below the ground."""
    rule = "-" * 77
    lines = ["<HTML><PRE>", "47600 RJNW Observations at 00Z 01 Jul 2024", "", rule]
    lines += [
        "   PRES   HGHT   TEMP   DWPT   RELH   MIXR   DRCT   SKNT   THTA   THTE   THTV",
        "    hPa     m      C      C      %    g/kg    deg   knot     K      K      K ",
        rule,
    ]
    lines += [" 1000.0   -20" if i == 0 else "" for i in blanks[:1]]
    for p, h, t, d, u, r in zip(P, geopotential(), T - 273.15, DEW - 273.15, U, mixing_ratio(), strict=True):
        lines.append(f"{p:7.1f}{h:7.0f}{t:7.1f}{d:7.1f}{u:7.0f}{r:7.2f}{180:7d}{10:7d}{300.0:7.1f}{330.0:7.1f}{302.0:7.1f}")
    lines += ["</PRE><H3>Station information and sounding indices</H3><PRE>", "          Station identifier: RJNW", "</PRE>"]
    return write(folder, "\n".join(lines) + "\n", "wyoming.txt")


def wyoming_csv(folder):
    n = Z.size
    cells = {
        "time": ["2024-07-01 00:00:05"] * n,
        "longitude": [130.0] * n,
        "latitude": [33.0] * n,
        "pressure_hPa": P,
        "geopotential height_m": geopotential(),
        "temperature_C": T - 273.15,
        "dew point temperature_C": DEW - 273.15,
        "ice point temperature_C": [""] * n,
        "relative humidity_%": U,
        "humidity wrt ice_%": [""] * n,
        "mixing ratio_g/kg": mixing_ratio(),
        "wind direction_degree": [200.0] * n,
        "wind speed_m/s": [5.0] * n,
    }
    return write(folder, table(list(cells), list(cells.values())), "wyoming.csv")


def igra(folder, *, heights=True, ascents=2):
    """IGRA version 2: fixed columns, Pa, tenths of degrees, -9999 and -8888."""
    lines = []
    for day in range(1, 1 + ascents):
        lines.append(f"#JAM00047600 2024 07 {day:02d} 00 2330 {Z.size:4d} ncdc-gts ncdc-gts  330000  1300000")
        for i, (p, h, t, d) in enumerate(zip(P, geopotential(), T - 273.15, T - DEW, strict=True)):
            gph = round(h) if heights or i in (0, 7) else -9999
            temperature = f"{round(10 * (t + day - 1)):5d}"
            lines.append(f"10 {-9999:5d} {round(100 * p):6d}B{gph:5d}B{temperature}B{-9999:5d} {round(10 * d):5d} {180:5d} {50:5d} ")
    return write(folder, "\n".join(lines) + "\n", "JAM00047600-data.txt")


def era5(folder, **changes):
    hours = np.array(["2024-07-01T00", "2024-07-01T06"], dtype="datetime64[ns]")
    lat, lon = np.array([33.25, 33.0]), np.array([129.75, 130.0, 130.25])
    shape = (2, Z.size, 2, 3)
    q = mixing_ratio() * 1e-3
    q = q / (1.0 + q)

    def field(values):
        return ("valid_time", "pressure_level", "latitude", "longitude"), np.broadcast_to(values[None, ::-1, None, None], shape).copy()

    data = xr.Dataset(
        {"z": field(geopotential() * 9.80665), "t": field(T), "q": field(q)},
        coords={"valid_time": hours, "pressure_level": ("pressure_level", P[::-1], {"units": "hPa"}), "latitude": lat, "longitude": lon},
    )
    data["t"].values[1] += 2.0
    path = folder / "era5.nc"
    data.to_netcdf(path, engine="h5netcdf")
    return path


FORMATS = {
    "ours": ours,
    "wyoming-list": wyoming_list,
    "wyoming-csv": wyoming_csv,
    "igra": igra,
    "igra-few-heights": lambda f: igra(f, heights=False),
}


@pytest.mark.parametrize("form", FORMATS)
def test_every_format_holds_the_same_ascent(tmp_path, form):
    found = read_sounding(FORMATS[form](tmp_path))
    assert found.height[0] == 0.0
    np.testing.assert_allclose(np.interp(Z, found.height, found.temperature), T, atol=0.06)
    np.testing.assert_allclose(np.interp(Z, found.height, np.log(found.pressure)), np.log(P), atol=3e-3)
    np.testing.assert_allclose(np.interp(Z[:9], found.height, found.relative_humidity), U[:9], atol=1.0)
    few = form == "igra-few-heights"
    np.testing.assert_allclose(found.height[1:], Z, rtol=5e-3 if few else 1e-3, atol=5.0 if few else 1.0)
    assert len(found.digest) == 64
    assert any("geopotential" in note for note in found.notes) == (form != "ours")


def test_era5_levels_at_a_place_and_hour(tmp_path):
    path = era5(tmp_path)
    with pytest.raises(DataError, match=r"holds 6 places; give \[place\]"):
        read_sounding(path)
    from datetime import UTC, datetime

    first, second = (read_sounding(path, (33.1, 130.1), datetime(2024, 7, 1, hour, tzinfo=UTC)) for hour in (1, 5))
    np.testing.assert_allclose(first.temperature[1:], T, atol=1e-4)
    np.testing.assert_allclose(second.temperature[1:], T + 2.0, atol=1e-4)
    np.testing.assert_allclose(first.relative_humidity[1:], U, atol=0.6)
    np.testing.assert_allclose(first.height[1:], Z, atol=0.5)
    assert any("grid point 33" in note for note in first.notes)
    with pytest.raises(DataError, match=r"is 1[0-9].* deg from 45, 130"):
        read_sounding(path, (45.0, 130.0))
    xr.load_dataset(path, engine="h5netcdf").drop_vars("t").to_netcdf(tmp_path / "no.nc", engine="h5netcdf")
    with pytest.raises(DataError, match="missing: temperature"):
        read_sounding(tmp_path / "no.nc", (33.0, 130.0))


@pytest.mark.parametrize("missing", ["", "NaN", "9999", "-99.9", "-99", "-9999", "--", "/////", "1e20"])
def test_levels_without_pressure_or_temperature_are_left_out_and_counted(tmp_path, missing):
    """A level without humidity keeps its temperature; its humidity is interpolated in height."""
    rows = [f"{z},{p},{t},{u}" for z, p, t, u in zip(Z, P, T, U, strict=True)]
    for i, column in ((2, 2), (5, 3), (9, 1)):
        cells = rows[i].split(",")
        cells[column] = missing
        rows[i] = ",".join(cells)
    found = read_sounding(write(tmp_path, HEAD + "\n".join(rows) + "\n"))
    assert any(note.startswith("2 of 15 levels have missing values") for note in found.reported)
    assert any(note.startswith("1 of 13 levels lack humidity between others") for note in found.reported)
    np.testing.assert_allclose(found.height[1:], np.delete(Z, [2, 9]))
    assert found.temperature[5] == pytest.approx(T[5])
    assert found.relative_humidity[5] == pytest.approx(np.interp(Z[5], Z[[4, 6]], U[[4, 6]]))


@pytest.mark.parametrize(("column", "missing"), [(2, "999.9"), (3, "999"), (3, "-999.99")])
def test_numbers_that_no_air_has_are_missing(tmp_path, column, missing):
    rows = [[f"{value}" for value in row] for row in zip(Z, P, T, U, strict=True)]
    rows[4][column] = missing
    found = read_sounding(write(tmp_path, HEAD + "\n".join(map(",".join, rows)) + "\n"))
    assert found.given == 15 - (column == 2)


def test_a_pressure_of_999_9_hpa_and_a_height_of_999_m_are_real(tmp_path):
    z, p = np.append(Z, 999.0), np.append(P, np.exp(np.interp(999.0, Z, np.log(P))))
    order = np.argsort(z)
    shift = 999.9 / p[order][1]  # the second level gets this pressure
    rows = zip(z[order], p[order] * shift, np.interp(z[order], Z, T), np.interp(z[order], Z, U), strict=True)
    found = read_sounding(write(tmp_path, HEAD + "".join(f"{a:g},{b:.1f},{c},{d}\n" for a, b, c, d in rows)))
    assert found.given == 16
    assert 999.0 in found.height
    assert found.pressure[2] == pytest.approx(999.9)


def test_levels_from_the_top_down_are_turned_round(tmp_path):
    rows = [f"{z},{p},{t},{u}" for z, p, t, u in zip(Z, P, T, U, strict=True)]
    found = read_sounding(write(tmp_path, HEAD + "\n".join(rows[::-1]) + "\n"))
    np.testing.assert_allclose(found.height[1:], Z)
    assert any("turned round" in note for note in found.notes)


@pytest.mark.parametrize("station", [0.0, 30.0, 250.0, 499.0])
def test_a_first_level_above_the_sea_is_continued_down(tmp_path, station):
    high = np.concatenate([[station], Z[station < Z]])
    p, t, u = (np.interp(high, Z, row) for row in (np.log(P), T, U))
    rows = [f"{z},{np.exp(a)},{b},{c}" for z, a, b, c in zip(high, p, t, u, strict=True)]
    found = read_sounding(write(tmp_path, HEAD + "\n".join(rows) + "\n"))
    assert found.height[0] == 0.0
    assert found.pressure[0] == pytest.approx(1012.6, abs=1.5)
    assert any("continued to the sea" in note for note in found.notes) == (station > 2.0)


def test_none_of_many_levels_is_thinned(tmp_path):
    z = np.linspace(5.0, 20e3, 5001)
    rows = [f"{a},{np.exp(b)},{c},{d}" for a, b, c, d in zip(z, *(np.interp(z, Z, row) for row in (np.log(P), T, U)), strict=True)]
    assert read_sounding(write(tmp_path, HEAD + "\n".join(rows) + "\n")).height.size == 5002  # and the sea


def columns(
    height=Z,
    pressure=P,
    temperature=T - 273.15,
    humidity=U,
    names=("height_m", "pressure_hpa", "temperature_c", "relative_humidity_percent"),
):
    return table(names, (height, pressure, temperature, humidity))


KELVIN_NAMES = ("height_m", "pressure_hpa", "temperature_k", "relative_humidity_percent")
DEW_NAMES = ("height_m", "pressure_hpa", "temperature_c", "dewpoint_c")

NONSENSE = {
    "feet": (columns(height=Z / 0.3048), "are heights in feet?"),
    "kilometres": (columns(height=1e-3 * Z), "are heights in km?"),
    "m2 s-2": (columns(height=9.80665 * Z), "is it geopotential in m2/s2?"),
    "kPa": (columns(pressure=0.1 * P), "are pressures in kPa?"),
    "Pa": (columns(pressure=100.0 * P), "are pressures in Pa?"),
    "kelvin in _c": (columns(temperature=T), "are temperatures in kelvin?"),
    "Celsius in _k": (columns(names=KELVIN_NAMES), "are temperatures in Celsius?"),
    "a share": (columns(humidity=0.01 * U), r"is relative humidity a share \(0.8 for 80 %\)"),
    "humidity of 300 %": (columns(humidity=3.0 * U + 100.0), "is it the right column"),
    "a mixing ratio": (columns(humidity=mixing_ratio(), names=DEW_NAMES), "is it a mixing ratio in g/kg"),
    "kelvin dew point in _c": (columns(humidity=DEW, names=DEW_NAMES), "dew points in kelvin"),
    "exchanged": (columns(temperature=DEW - 273.15, humidity=T - 273.15, names=DEW_NAMES), "are the columns or units exchanged"),
    "wrong by 5 %": (columns(height=1.05 * Z), r"\+5 %, 2 % are allowed"),
    "one layer wrong": (columns(height=np.where(Z > 6000.0, Z + 400.0, Z)), "are columns and units right"),
    "above the ground": (columns(height=Z, pressure=0.8 * P), "are heights above the ground"),
    "a mountain": (columns(height=Z + 900.0, pressure=P * 0.9), "lowest level lies at 905 m"),
    "no humidity": (table(("height_m", "pressure_hpa", "temperature_c"), (Z, P, T)), "missing: relative_humidity_percent"),
    "three are missing": (table(("altitude", "Druck", "T"), (Z, P, T)), "missing: pressure_hpa, temperature_k .*'T' temperature_k"),
    "twice": (table(("height_m", "height_m", "pressure_hpa", "temperature_c"), (Z, Z, P, T)), "stands twice"),
    "hot": (columns(temperature=T - 180.0), "which no air has"),
    "words": (HEAD + "0,1013,mild,80\n", "temperature_k = 'mild' is not a number"),
    "one level": (HEAD + "0,1013,290,80\n", "has 1 levels"),
    "none": (HEAD, "no rows"),
    "empty": ("", "is empty"),
    "noise": ("\x00\x01\x02", "missing|empty|no rows"),
    "several ascents": (columns() + columns().split("\n", 1)[1] + columns().split("\n", 1)[1], "is it one ascent"),
}  # fmt: skip


@pytest.mark.parametrize("fault", NONSENSE)
def test_nonsense_is_found_and_named(tmp_path, fault):
    text, told = NONSENSE[fault]
    with pytest.raises(DataError, match=told) as caught:
        read_sounding(write(tmp_path, text))
    assert "\n" not in str(caught.value)
    assert "air.csv" in str(caught.value)


def test_feet_are_told_with_both_numbers(tmp_path):
    with pytest.raises(DataError, match=r"heights rise by 678\d\d m, .* say 20[678]\d\d m"):
        read_sounding(write(tmp_path, NONSENSE["feet"][0]))


def test_a_very_dry_stratosphere_is_no_fault(tmp_path):
    """A dew point of -80 C ended the Fortran program."""
    dew = np.where(Z > 9000.0, 193.15, DEW)
    found = read_sounding(write(tmp_path, columns(humidity=dew - 273.15, names=DEW_NAMES)))
    assert 0.0 < found.relative_humidity[-1] < 5.0


def test_a_low_top_is_told(tmp_path):
    low = Z < 3000.0
    rows = [f"{z},{p},{t},{u}" for z, p, t, u in zip(Z[low], P[low], T[low], U[low], strict=True)]
    found = read_sounding(write(tmp_path, HEAD + "\n".join(rows) + "\n"))
    assert any(note.startswith("the sounding ends at 2.2 km") for note in found.notes)
    whole = found.profile("tropical")
    assert whole.height[-1] == 100e3
    assert np.all(np.diff(whole.height) > 0.0)


def test_geopotential_heights_are_made_geometric():
    """US Standard Atmosphere 1976, Table I: 30 000 m' are 30 142 m."""
    assert float(geometric_height(np.array(30_000.0))) == pytest.approx(30_142.3, abs=1.0)


def test_a_folder_and_nothing_are_named(tmp_path):
    with pytest.raises(DataError, match="no such file"):
        read_sounding(tmp_path / "none.csv")
    with pytest.raises(DataError, match="is a folder"):
        read_sounding(tmp_path)


@pytest.mark.parametrize(
    ("celsius", "saturation", "mixing_ratio", "pressure", "virtual"),
    [
        # Wallace and Hobbs (2006), Atmospheric Science, 2nd ed., chapter 3: 20 g/kg at 30 degC add 3.7 K
        (30.0, 42.43, 20.0, 1000.0, 303.15 + 3.7),
        # the IFS documentation's T (1 + 0.6078 q), q the specific humidity
        (20.0, 23.37, 10.0, 1000.0, 293.15 * (1.0 + 0.6078 * 0.010 / 1.010)),
        (0.0, 6.11, 3.0, 850.0, 273.15 * (1.0 + 0.6078 * 0.003 / 1.003)),
    ],
)
def test_virtual_temperatures_are_the_published_ones(celsius, saturation, mixing_ratio, pressure, virtual):
    """Saturation over water [hPa] by WMO-No. 8, from which the relative humidity of a mixing ratio follows."""
    vapour = pressure * mixing_ratio / (621.98 + mixing_ratio)
    assert float(virtual_temperature(celsius + 273.15, pressure, 100.0 * vapour / saturation)) == pytest.approx(virtual, abs=0.1)


@pytest.mark.parametrize(("kelvin", "metres"), [(288.0, 5846.0), (233.0, 4730.0)])
def test_thicknesses_are_the_published_ones(kelvin, metres):
    """From 1000 to 500 hPa at mean virtual temperatures of the tropics and the pole (Wallace and Hobbs 2006, ch. 3), geopotential."""
    level = np.array([kelvin, kelvin])
    raw = RawSounding(
        "test", np.array([1000.0, 500.0]), np.array([0.0, metres]), level, "relative_humidity_percent", np.zeros(2), False, {}
    )
    thick = hydrostatic_thickness(raw, np.zeros(2))
    # 5 m more by gravity's fall with height
    np.testing.assert_allclose(thick, metres, rtol=1.5e-3)


def two_levels(folder, extra=()):
    """Sounding of two levels 1 km apart, hydrostatic at 280 K without vapour, and any levels more, all on one line."""
    z = np.array(sorted({0.0, 1000.0, *extra}))
    p = 1013.0 * np.exp(-9.80665 * z / (287.05 * (280.0 - 0.5 * 0.006 * z)))
    rows = (z, p, 280.0 - 0.006 * z, np.full(z.size, 40.0))
    return write(folder, table(("height_m", "pressure_hpa", "temperature_k", "relative_humidity_percent"), rows), f"{z.size}.csv")


def test_two_levels_are_a_sounding_and_one_is_none(tmp_path):
    two, many = (read_sounding(two_levels(tmp_path, extra)) for extra in ((), np.arange(50.0, 1000.0, 50.0)))
    assert (two.given, two.top, many.given) == (2, 1000.0, 21)
    air, finer = two.profile("subarctic-winter"), many.profile("subarctic-winter")
    assert np.interp(500.0, air.height, air.temperature) == pytest.approx(277.0)
    nu = wavenumber_grid(8.0, 12.0)
    haze = HazeWeather(wind=5.0, wind_24h=5.0)
    light = [AirSums(one, haze, nu).along(10.0, zenith).emitted for zenith in (0.3, 1.5) for one in (air, finer)]
    # vapour and pressure exponential between two levels instead of by 20 steps
    np.testing.assert_allclose(light[0::2], light[1::2], rtol=0.01)
    one = write(
        tmp_path, table(("height_m", "pressure_hpa", "temperature_k", "relative_humidity_percent"), ([0.0], [1013.0], [280.0], [40.0]))
    )
    with pytest.raises(DataError, match="2 at least"):
        read_sounding(one)
