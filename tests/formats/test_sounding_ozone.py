"""Ozone of soundings: units, layouts, gaps, the model's above, what is refused, and the sky that it makes."""

import logging
from datetime import UTC, datetime

import numpy as np
import pytest
import xarray as xr
from sounding_files import ascent, save

from seaglint.air.profile.aerosols import HazeWeather
from seaglint.air.profile.air_profile import GASES, model_levels, model_profile, ozone_dobson, sounding_profile
from seaglint.air.profile.air_sums import AirSums
from seaglint.base.errors import DataError
from seaglint.formats.soundings.air_summary import summarise_air
from seaglint.formats.soundings.sounding import read_sounding
from seaglint.optics.band import Band
from seaglint.optics.blackbody import planck_wavenumber
from seaglint.scenario.load import parse_scenario
from seaglint.studies.build.profile_air import profile_atmosphere, program_sounding

OZONE = GASES.index("O3")
MODEL = "midlatitude-summer"
TRUTH = ascent(z=np.unique(np.r_[5.0, np.arange(200.0, 3000.0, 400.0), np.arange(3000.0, 30_001.0, 1000.0)]))
PPMV = 1.3 * model_levels(MODEL, TRUTH.z)[3][OZONE]
MMR = 1e-6 * PPMV * 47.9982 / 28.9644
MPA = 0.1 * PPMV * TRUTH.p
PLAIN = "height_m,pressure_hpa,temperature_k,relative_humidity_percent"


def table(folder, name=None, values=None, *, order=slice(None), units=None, separator=","):
    """Our table of the ascent, with a further column; empty cells for NaN."""
    rows = [[f"{v:.9g}" for v in row] for row in zip(TRUTH.z, TRUTH.p, TRUTH.t, TRUTH.u, strict=True)]
    head = PLAIN.split(",")
    if name is not None:
        head.append(name)
        for row, value in zip(rows, np.broadcast_to(values, TRUTH.z.shape), strict=True):
            row.append(value if isinstance(value, str) else "" if np.isnan(value) else f"{value:.9g}")
    lines = [head, *([units] if units else []), *rows[order]]
    return save(folder, "air.csv", "\n".join(separator.join(line) for line in lines) + "\n")


def era5(folder, **variables):
    """Two places and two hours, from the top down; variables of values and their units."""
    lat, lon = np.array([33.25, 33.0]), np.array([130.0])
    hours = np.array(["2024-07-01T00", "2024-07-01T06"], dtype="datetime64[ns]")
    ratio = 1e-3 * TRUTH.mixing_ratio
    held = {"z": (TRUTH.geopotential * 9.80665, "m2 s-2"), "t": (TRUTH.t, "K"), "q": (ratio / (1.0 + ratio), "kg kg**-1"), **variables}
    data = xr.Dataset(
        {
            name: (
                ("valid_time", "pressure_level", "latitude", "longitude"),
                np.broadcast_to(values[None, ::-1, None, None], (2, TRUTH.z.size, 2, 1)).copy(),
                {} if unit is None else {"units": unit},
            )
            for name, (values, unit) in held.items()
        },
        coords={
            "valid_time": hours,
            "pressure_level": ("pressure_level", TRUTH.p[::-1], {"units": "hPa"}),
            "latitude": lat,
            "longitude": lon,
        },
    )
    for name in set(variables):
        data[name].values[:, :, 1] *= 0.5  # the other place has other ozone
    path = folder / "era5.nc"
    data.to_netcdf(path, engine="h5netcdf")
    return path


def sonde(folder, **variables):
    held = {"pres": (TRUTH.p, "hPa"), "tdry": (TRUTH.t - 273.15, "C"), "rh": (TRUTH.u, "%"), "alt": (TRUTH.z, "m"), **variables}
    path = folder / "sonde.nc"
    data = xr.Dataset({name: ("time", values.astype(np.float64), {"units": unit}) for name, (values, unit) in held.items()})
    data.to_netcdf(path, engine="h5netcdf")
    return path


def era5_at(path):
    return read_sounding(path, (33.25, 130.0), datetime(2024, 7, 1, tzinfo=UTC))


@pytest.mark.parametrize(
    ("name", "values", "units"),
    [
        ("ozone_ppmv", PPMV, None),
        ("Ozone [ppmv]", PPMV, None),
        ("o3 (mPa)", MPA, None),
        ("ozone_mpa", MPA, None),
        ("ozone_partial_pressure_mPa", MPA, None),
        ("ozone_mmr", MMR, None),
        ("O3_kg/kg", MMR, None),
        ("ozone_ppbv", 1e3 * PPMV, None),
        ("ozone", MPA, ["m", "hPa", "K", "%", "mPa"]),
        ("ozone", MMR, ["m", "hPa", "K", "%", "kg kg**-1"]),
    ],
)
@pytest.mark.parametrize("order", [slice(None), slice(None, None, -1)], ids=["up", "down"])
def test_every_unit_gives_one_profile(tmp_path, name, values, units, order):
    found = read_sounding(table(tmp_path, name, values, units=units, order=order))
    np.testing.assert_allclose(found.ozone_ppmv[1:], PPMV, rtol=1e-7)
    assert found.ozone_ppmv[0] == found.ozone_ppmv[1]
    profile = found.profile(MODEL)
    whole = np.append(PPMV[0], PPMV)
    np.testing.assert_allclose(profile.gas[OZONE][: whole.size], whole, rtol=1e-7)
    z = profile.height[whole.size :]
    ratio = 1.3 ** np.exp(-(z - 30e3) / 5e3)
    np.testing.assert_allclose(profile.gas[OZONE][whole.size :], ratio * model_levels(MODEL, z)[3][OZONE], rtol=1e-7)
    assert not found.reported
    assert any(note.startswith("ozone ends at 30.0 km") for note in found.notes)


def test_analyses_and_sondes_in_netcdf(tmp_path):
    found = era5_at(era5(tmp_path, o3=(MMR, "kg kg**-1")))
    np.testing.assert_allclose(found.ozone_ppmv[1:], PPMV, rtol=1e-6)
    other = read_sounding(tmp_path / "era5.nc", (33.0, 130.0))
    np.testing.assert_allclose(other.ozone_ppmv[1:], 0.5 * PPMV, rtol=1e-6)
    found = read_sounding(sonde(tmp_path, ozone_partial_pressure=(MPA, "mPa"), ozone_flag=(MPA * 0.0, "1")))
    np.testing.assert_allclose(found.ozone_ppmv[1:], PPMV, rtol=1e-6)


def test_packing_of_analyses_makes_no_negative_ozone(tmp_path):
    least = np.where(np.arange(TRUTH.z.size) == 3, -2e-10, MMR)
    assert era5_at(era5(tmp_path, o3=(least, "kg kg**-1"))).ozone_ppmv[4] == 0.0
    with pytest.raises(DataError, match="ozone is 0 or more"):
        era5_at(era5(tmp_path, o3=(-MMR, "kg kg**-1")))


def test_air_without_ozone_is_the_models_to_the_bit(tmp_path):
    found = read_sounding(table(tmp_path))
    assert found.ozone_ppmv is None
    assert found.ozone_top is None
    profile = found.profile(MODEL)
    assert np.array_equal(profile.gas, model_levels(MODEL, profile.height)[3])
    assert not any("ozone" in note for note in found.notes)
    summary = summarise_air(str(tmp_path / "air.csv"), 290.0)
    assert not any("ozone" in text for text in (*summary.lines[1:], *summary.as_dict()))


def test_other_gases_and_the_air_stay(tmp_path):
    plain = read_sounding(table(tmp_path)).profile(MODEL)
    given = read_sounding(table(tmp_path, "ozone_ppmv", PPMV)).profile(MODEL)
    for name in ("height", "pressure", "temperature", "vapour"):
        assert np.array_equal(getattr(plain, name), getattr(given, name))
    others = np.arange(len(GASES)) != OZONE
    assert np.array_equal(plain.gas[others], given.gas[others])


def test_gaps_are_interpolated_the_lowest_holds_and_the_model_goes_on(tmp_path):
    i = np.arange(TRUTH.z.size)
    last = int(np.searchsorted(TRUTH.z, 24e3))
    values = np.where((i < 2) | ((i > 10) & (i < 14)) | (i > last), np.nan, PPMV)
    found = read_sounding(table(tmp_path, "ozone_ppmv", values))
    assert found.ozone_top == 24e3
    assert np.all(found.ozone_ppmv[:4] == found.ozone_ppmv[3])
    np.testing.assert_allclose(found.ozone_ppmv[12:15], np.interp(TRUTH.z[11:14], TRUTH.z[[10, 14]], PPMV[[10, 14]]), rtol=1e-7)
    assert np.isnan(found.ozone_ppmv[last + 2 :]).all()
    assert found.reported == (f"3 of {i.size} levels lack ozone between others; it is interpolated in height",)
    assert any(note.startswith("ozone begins at 600 m") for note in found.notes)
    profile = found.profile(MODEL)
    ratio = profile.gas[OZONE] / model_levels(MODEL, profile.height)[3][OZONE]
    above = profile.height >= 24e3
    assert ratio[above][0] == pytest.approx(1.3)
    assert np.all(np.diff(ratio[above]) < 0.0)
    assert np.max(np.abs(np.diff(ratio[above & (profile.height <= 30e3)]))) < 0.3 / 4.0  # no step
    assert ratio[-1] == pytest.approx(1.0, abs=1e-5)


def test_ozone_that_ends_low_is_reported(tmp_path):
    found = read_sounding(table(tmp_path, "ozone_ppmv", np.where(TRUTH.z > 12e3, np.nan, PPMV)))
    assert found.reported == ("ozone ends at 12.0 km; the model atmosphere's goes on above, joined to it over 5 km",)


def test_a_column_of_nothing_is_the_models(tmp_path):
    found = read_sounding(table(tmp_path, "ozone_ppmv", np.full(TRUTH.z.size, -9999.0)))
    assert found.ozone_ppmv is None
    assert found.reported == ("ozone is missing from the sea to 100 km; it is that of the model atmosphere",)


def test_levels_of_one_height_are_averaged_with_their_ozone(tmp_path):
    order = np.r_[np.arange(8), 7, np.arange(8, TRUTH.z.size)]
    text = table(tmp_path, "ozone_ppmv", PPMV, order=slice(None)).read_text().splitlines()
    rows = [text[1 + i].split(",") for i in order]
    rows[8][-1] = f"{3.0 * PPMV[7]:.9g}"
    found = read_sounding(save(tmp_path, "twice.csv", "\n".join([text[0], *map(",".join, rows)]) + "\n"))
    assert found.ozone_ppmv[8] == pytest.approx(2.0 * PPMV[7])
    np.testing.assert_allclose(found.ozone_ppmv[9:], PPMV[8:], rtol=1e-7)


def test_of_several_columns_the_fullest_counts(tmp_path):
    text = table(tmp_path, "ozone_ppmv", np.where(TRUTH.z > 9e3, np.nan, 0.5 * PPMV)).read_text().splitlines()
    lines = [f"{text[0]},ozone_mpa,ozone_error", *(f"{line},{v:.9g},x" for line, v in zip(text[1:], MPA, strict=True))]
    np.testing.assert_allclose(read_sounding(save(tmp_path, "both.csv", "\n".join(lines) + "\n")).ozone_ppmv[1:], PPMV, rtol=1e-7)


@pytest.mark.parametrize(
    ("name", "values", "units", "message"),
    [
        ("ozone", PPMV, None, "line 1: the column ozone holds ozone in no unit that is known; ozone is read as ozone_ppmv .*ozone_mmr"),
        ("ozone_xyz", PPMV, None, "the column ozone_xyz holds ozone in no unit that is known"),
        ("o3_ppm", PPMV, None, "the column o3_ppm holds ozone in no unit that is known"),
        ("ozone", PPMV, ["m", "hPa", "K", "%", "foo"], "the column ozone holds ozone in 'foo'; .*leave it out"),
        ("ozone_ppmv", PPMV, ["m", "hPa", "K", "%", "mPa"], "is in ppmv by its name and in mPa by its unit"),
        ("ozone_ppmv", -PPMV, None, "ozone_ppmv holds -.* hPa; ozone is 0 or more"),
        ("ozone_ppmv", 1e3 * PPMV, None, r"at most .* ppmv are allowed there: is its unit .*ppbv"),
        ("ozone_ppmv", MPA, None, "holds .* at most 1 ppmv are allowed there: is its unit .*mPa"),
        ("ozone_ppmv", MMR, None, "half of its levels lie below 0.001 ppmv: is its unit kg/kg"),
        ("ozone_mmr", PPMV, None, "at most .* ppmv are allowed there: is its unit ppmv"),
        ("ozone_mpa", PPMV, None, "half of its levels lie below 0.001 ppmv: is its unit ppmv"),
        ("ozone_mmr", 20.0 * MMR, None, "at most .* ppmv are allowed there"),
        ("ozone_ppmv", "many", None, "line 2: ozone_ppmv = 'many' is not a number"),
    ],
)
def test_what_is_no_ozone_is_refused_in_one_line(tmp_path, name, values, units, message):
    with pytest.raises(DataError, match=message) as refused:
        read_sounding(table(tmp_path, name, values, units=units))
    assert "\n" not in str(refused.value)


def test_ozone_of_netcdf_in_another_unit_is_refused(tmp_path):
    for unit, said in (("foo", "in 'foo'"), (None, "in no unit that is known")):
        with pytest.raises(DataError, match=f"the variable o3 holds ozone {said}; ozone is read as ozone_ppmv"):
            era5_at(era5(tmp_path, o3=(MMR, unit)))
    with pytest.raises(DataError, match="the variable ozone holds ozone in 'counts'"):
        read_sounding(sonde(tmp_path, ozone=(MPA, "counts")))


def test_pressures_in_pascal_are_named_before_ozone(tmp_path):
    text = table(tmp_path, "ozone_mpa", MPA).read_text().splitlines()
    rows = [line.split(",") for line in text[1:]]
    lines = [text[0], *(",".join([z, f"{100.0 * float(p):.8g}", *rest]) for z, p, *rest in rows)]
    with pytest.raises(DataError, match="are pressures in Pa"):
        read_sounding(save(tmp_path, "pa.csv", "\n".join(lines) + "\n"))


def test_twice_the_ozone_is_twice_the_row_and_warms_the_sky(tmp_path):
    """The band of 9.6 um: the window beside it stays."""
    base = model_levels(MODEL, TRUTH.z)[3][OZONE]
    one, two = (read_sounding(table(tmp_path, "ozone_ppmv", factor * base)).profile(MODEL) for factor in (1.0, 2.0))
    count = TRUTH.z.size + 1
    np.testing.assert_allclose(two.gas[OZONE][:count], 2.0 * one.gas[OZONE][:count], rtol=1e-7)
    nu = np.array([900.0, 1040.0, 1045.0])
    first, second = (AirSums(air, HazeWeather("none"), nu).along(0.0, 0.0).emitted for air in (one, two))
    grid = np.linspace(150.0, 320.0, 3401)
    cold, warm = (
        np.array([np.interp(L, planck_wavenumber(np.full(1, v), grid).ravel(), grid) for L, v in zip(sky, nu, strict=True)])
        for sky in (first, second)
    )
    assert np.all(warm[1:] - cold[1:] > 4.0)
    assert abs(warm[0] - cold[0]) < 0.3


def test_dobson_units(tmp_path):
    """McClatchey et al. (1972) have 319 Dobson units in midlatitude summer, 277 in the tropics and 343 in the standard."""
    for model, units in (("midlatitude-summer", 325.0), ("tropical", 265.0), ("us-standard-1976", 343.0)):
        air = model_profile(model)
        assert ozone_dobson(air.height, air.pressure, air.temperature, air.gas[OZONE]) == pytest.approx(units, rel=0.06)
    z = np.array([0.0, 1e3])
    even = ozone_dobson(z, np.full(2, 1013.25), np.full(2, 273.15), np.ones(2))
    assert even == pytest.approx(100.0, rel=1e-4)  # 1e-6 of a kilometre is a millimetre: 100 units
    summary = summarise_air(str(table(tmp_path, "ozone_mpa", MPA)), 290.0)
    (line,) = [line for line in summary.lines if line.startswith("ozone ")]
    assert line.startswith(f"ozone {summary.ozone:.0f} Dobson units from the sea up, ")
    assert summary.as_dict()["ozone_dobson"] == summary.ozone
    assert summary.ozone_above(30e3) < 0.3 * summary.ozone
    assert any(line.startswith("note: ozone ends at 30.0 km") for line in summary.lines)


def test_no_ozone_at_all_is_taken_as_said():
    """A value of 0 is no missing one; above it the model's comes back."""
    z, p, t, u = TRUTH.z[1:], TRUTH.p[1:], TRUTH.t[1:], TRUTH.u[1:]
    air = sounding_profile("none", MODEL, z, p, t, u, ozone_ppmv=np.zeros(z.size))
    assert np.all(air.gas[OZONE][: z.size] == 0.0)
    assert np.all(np.isfinite(air.gas))
    assert 0.0 < air.gas[OZONE][z.size] < 0.1 * model_levels(MODEL, air.height[z.size :])[3][OZONE][0]


def test_a_scenario_notes_its_ozone_and_the_program_says_that_it_takes_none(tmp_path, caplog):
    air = {"source": "lowtran", "sounding": str(table(tmp_path, "ozone_ppmv", PPMV))}
    scenario = parse_scenario({"sensor": {"pixels": [4, 4], "fov_deg": [1, 1], "height_m": 20.0}, "atmosphere": air})
    band = Band.rectangular(9.0, 10.0)
    with caplog.at_level(logging.WARNING, "seaglint"):
        assert "ozone ends at 30.0 km" in profile_atmosphere(scenario.atmosphere, scenario, band).provenance["sounding_notes"]
        assert not caplog.records
        program_sounding(scenario.atmosphere, scenario, band)
    (said,) = [record.getMessage() for record in caplog.records]
    assert said.endswith("LOWTRAN7's program and decks take no ozone of it but that of midlatitude-summer")
