"""Somebody's own transmittance and radiance: CSV and NetCDF say the same, units are what they say, mistakes are named by line."""

import csv

import numpy as np
import pytest
import xarray as xr

from seaglint.base.conventions import horizon_depression, horizon_range
from seaglint.base.errors import DataError
from seaglint.formats.air_file import read_atmosphere
from seaglint.studies.build.profile_air import model_air

HEIGHT = 30.0
BAND = (3.9, 4.0)
DIP = np.degrees(horizon_depression(HEIGHT))
ARC = np.concatenate([[0.0], np.geomspace(10.0, 0.98 * horizon_range(HEIGHT), 24)])
ZENITH = 90.0 - np.concatenate([[0.0], np.geomspace(0.2, 90.0, 24)])[::-1]
SENSOR_ZENITH = np.concatenate([ZENITH, 90.0 + DIP * np.linspace(0.1, 1.0, 9)])


@pytest.fixture(scope="module")
def table():
    return model_air("midlatitude-summer", 7.0, BAND)


def rows_of(air):
    """Lines of the file form of an atmosphere: kind, height, range, zenith, wavenumber, transmittance, radiance, irradiance."""
    nu = air.wavenumber_cm
    tau, path = air.path(HEIGHT, ARC)
    for i, arc in enumerate(ARC):
        yield from (["path", HEIGHT, arc, "", v, t, p, ""] for v, t, p in zip(nu, tau[i], path[i], strict=True))
    for height, angles in ((0.0, ZENITH), (HEIGHT, SENSOR_ZENITH)):
        sky = air.sky_radiance(np.radians(angles), 0.0, height)
        for i, angle in enumerate(angles):
            yield from (["sky", height, "", angle, v, "", s, ""] for v, s in zip(nu, sky[i], strict=True))
    sun = air.solar_irradiance(np.radians(ZENITH))
    for i, angle in enumerate(ZENITH):
        yield from (["sun", "", "", angle, v, "", "", e] for v, e in zip(nu, sun[i], strict=True))


HEAD = ["kind", "height_m", "range_m", "zenith_deg", "wavenumber_cm", "transmittance", "radiance", "irradiance"]


def write(path, rows, head=HEAD, **how):
    with path.open("w", newline="", encoding="utf-8") as stream:
        stream.write("# made by a test\n")
        csv.writer(stream, **how).writerows([head, *rows])
    return path


@pytest.fixture(scope="module")
def csv_file(table, tmp_path_factory):
    return write(tmp_path_factory.mktemp("air") / "air.csv", rows_of(table))


def same(a, b, rtol):
    """Band means of all four questions, between the nodes."""
    arc, zenith = np.geomspace(20.0, 0.97 * horizon_range(HEIGHT), 17), np.radians([3.0, 47.0, 72.0, 84.0, 88.8, 89.7])
    for name, arguments in (
        ("transmittance", (HEIGHT, arc)),
        ("path_radiance", (HEIGHT, arc)),
        ("solar_irradiance", (zenith,)),
        ("sky_radiance", (zenith, 0.0)),
        ("sky_radiance", (np.append(zenith, np.radians(90.0 + 0.6 * DIP)), 0.0, HEIGHT)),
    ):
        ours, theirs = (getattr(air, name)(*arguments).mean(axis=-1) for air in (a, b))
        np.testing.assert_allclose(ours, theirs, rtol=rtol, err_msg=name)


def test_a_table_written_as_a_file_comes_back(table, csv_file):
    """25 nodes each, splined, against the table's own splines: 0.2 %."""
    found = read_atmosphere(csv_file, HEIGHT)
    np.testing.assert_allclose(found.wavenumber_cm, table.wavenumber_cm)
    same(found, table, 2e-3)
    at_nodes = found.path(HEIGHT, ARC[1:])
    np.testing.assert_allclose(at_nodes[0], table.transmittance(HEIGHT, ARC[1:]), rtol=1e-5)


def test_per_micrometre_is_per_wavenumber(csv_file, table, tmp_path):
    """L_lambda = L_nu nu^2/1e4, written in another order and with semicolons."""
    rows = []
    for kind, height, arc, zenith, v, t, radiance, irradiance in rows_of(table):
        per_um = [value if value == "" else value * v * v / 1e4 for value in (radiance, irradiance)]
        rows.append([kind, height, arc, zenith, 1e4 / v, t, *per_um])
    head = ["wavelength_um" if name == "wavenumber_cm" else name for name in HEAD]
    other = write(tmp_path / "um.csv", rows[::-1], head, delimiter=";")
    same(read_atmosphere(other, HEIGHT), read_atmosphere(csv_file, HEIGHT), 1e-9)


def dataset_of(air):
    tau, path = air.path(HEIGHT, ARC)
    return xr.Dataset(
        {
            "path_transmittance": (("range_m", "wavenumber_cm"), tau),
            "path_radiance": (("range_m", "wavenumber_cm"), path),
            "sun_irradiance": (("sun_zenith_deg", "wavenumber_cm"), air.solar_irradiance(np.radians(ZENITH))),
            "sky_radiance": (("wavenumber_cm", "sky_zenith_deg"), air.sky_radiance(np.radians(ZENITH), 0.0).T),
            "sensor_sky_radiance": (("sensor_sky_zenith_deg", "wavenumber_cm"), air.sky_radiance(np.radians(SENSOR_ZENITH), 0.0, HEIGHT)),
        },
        coords={
            "range_m": ARC,
            "wavenumber_cm": air.wavenumber_cm,
            "sun_zenith_deg": ZENITH,
            "sky_zenith_deg": ZENITH,
            "sensor_sky_zenith_deg": SENSOR_ZENITH,
        },
        attrs={"sensor_height_m": HEIGHT},
    )


def test_netcdf_says_the_same(table, csv_file, tmp_path):
    path = tmp_path / "air.nc"
    dataset_of(table).isel(wavenumber_cm=slice(None, None, -1)).to_netcdf(path, engine="h5netcdf")
    same(read_atmosphere(path, HEIGHT), read_atmosphere(csv_file, HEIGHT), 1e-9)


@pytest.mark.parametrize(
    ("spoil", "told"),
    [
        (lambda d: d.drop_vars("sun_irradiance"), "needs the variable sun_irradiance"),
        (lambda d: d.assign_attrs(sensor_height_m="x"), "has no attribute sensor_height_m"),
        (lambda d: d.assign_coords(range_m=-d.range_m), "range_m needs at least 2 different values within 0"),
        (lambda d: d.assign(path_transmittance=d.path_transmittance * 1.5), "path_transmittance has values outside .* 0 to 1"),
        (lambda d: d.assign_coords(sun_zenith_deg=[1e-300 if z == ZENITH[1] else z for z in ZENITH]), "sun zenith.* all different"),
        (lambda d: d.assign_coords(sky_zenith_deg=[1e-300 if z == ZENITH[1] else z for z in ZENITH]), "sky elevation.* all different"),
        (lambda d: d.drop_vars("wavenumber_cm"), "needs the coordinate wavenumber_cm"),
        (lambda d: d.assign_attrs(sensor_height_m=5.0), "holds paths to 5 m, none to sensor.height_m = 30"),
    ],
)
def test_netcdf_mistakes_are_named(table, tmp_path, spoil, told):
    spoil(dataset_of(table)).to_netcdf(tmp_path / "air.nc", engine="h5netcdf")
    with pytest.raises(DataError, match=rf"air\.nc: {told}"):
        read_atmosphere(tmp_path / "air.nc", HEIGHT)


def test_what_is_not_netcdf_is_one_line(tmp_path):
    (tmp_path / "air.nc").write_text("no\nno\n")
    with pytest.raises(DataError, match="cannot be read as NetCDF 4") as caught:
        read_atmosphere(tmp_path / "air.nc", HEIGHT)
    assert "\n" not in str(caught.value)


PATHS = [["path", 30, r, "", v, 0.9, 1e-5, ""] for r in (10, 1000) for v in (2000, 2005)]
SKY = [["sky", 0, "", z, v, "", 1e-4, ""] for z in (0, 90) for v in (2000, 2005)]
SUN = [["sun", "", "", z, v, "", "", 1e-3] for z in (0, 90) for v in (2000, 2005)]
WHOLE = PATHS + SKY + SUN  # lines 3 to 14


def replaced(line, column, value):
    rows = [list(row) for row in WHOLE]
    rows[line - 3][HEAD.index(column)] = value
    return rows


def test_the_smallest_file_works(tmp_path):
    air = read_atmosphere(write(tmp_path / "a.csv", WHOLE), 30.0)
    np.testing.assert_allclose(air.transmittance(30.0, 300.0), 0.9)


@pytest.mark.parametrize(
    ("rows", "told"),
    [
        (replaced(4, "kind", "ray"), "line 4: kind = 'ray' is not one of path, sky, sun"),
        (replaced(5, "transmittance", 90), "line 5: transmittance = 90 is outside the range allowed: 0 to 1"),
        (replaced(5, "transmittance", ""), "line 5: transmittance = '' is not a number"),
        (replaced(8, "radiance", -1), "line 8: radiance = -1 is outside"),
        (replaced(11, "zenith_deg", 95), "line 11: zenith_deg = 95 is outside the range allowed: 0 to 90"),
        (replaced(4, "wavenumber_cm", 2000), "line 4: gives path at the same place and wavenumber_cm as line 3"),
        (replaced(4, "wavenumber_cm", 2010), "line 3: path from 30 m at range_m = 10 has 2 of the 3 spectral samples"),
        (PATHS + SUN, "holds no sky seen from the sea"),
        (PATHS + SKY, "holds no sunlight"),
        (SKY + SUN, "holds no paths"),
        (PATHS[:2] + SKY + SUN, "line 3: path from 30 m has 1 range_m"),
        (PATHS + [[*r[:4], r[4] + 1, *r[5:]] for r in SKY] + SUN, "sky from 0 m has another spectral grid than the paths"),
    ],
)
def test_csv_mistakes_name_the_line(tmp_path, rows, told):
    with pytest.raises(DataError, match=told) as caught:
        read_atmosphere(write(tmp_path / "a.csv", rows), 30.0)
    assert str(caught.value).startswith(str(tmp_path / "a.csv"))
    assert "\n" not in str(caught.value)


def test_a_missing_column_is_named(tmp_path):
    with pytest.raises(DataError, match=r"line 2: columns are .* missing: irradiance"):
        read_atmosphere(write(tmp_path / "a.csv", [row[:-1] for row in WHOLE], HEAD[:-1]), 30.0)
