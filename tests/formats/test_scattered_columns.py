"""Scattered sunlight in atmosphere files: NetCDF and CSV say the same, for one Sun; another Sun and holes are refused."""

import numpy as np
import pytest
import xarray as xr

from seaglint.base.errors import DataError, DomainError
from seaglint.formats.air_file import read_atmosphere, write_atmosphere
from seaglint.scenario.load import parse_scenario
from seaglint.studies.build import scenario_physics

NU = np.arange(2430.0, 2571.0, 5.0)
ARC = np.array([0.0, 200.0, 2000.0, 15000.0])
ZENITH = np.array([0.0, 60.0, 85.0, 90.0])
AZIMUTH = np.array([0.0, 10.0, 180.0])


def radiance(nodes, scale):
    """A number of its own for each place, azimuth and wavenumber."""
    return scale * (1.0 + np.arange(nodes)[:, None, None] + 0.1 * np.arange(AZIMUTH.size)[:, None] + 1e-3 * np.arange(NU.size))


def scattered_columns():
    grid = np.ones((4, NU.size))
    three = ("azimuth_from_sun_deg", "wavenumber_cm")
    return xr.Dataset(
        {
            "path_transmittance": (("range_m", "wavenumber_cm"), np.array([0.99, 0.95, 0.8, 0.3])[:, None] * grid),
            "path_radiance": (("range_m", "wavenumber_cm"), np.array([1e-6, 1e-5, 1e-4, 4e-4])[:, None] * grid),
            "sky_radiance": (("sky_zenith_deg", "wavenumber_cm"), 1e-4 * grid),
            "sun_irradiance": (("sun_zenith_deg", "wavenumber_cm"), 3e-3 * grid),
            "path_scattered": (("range_m", *three), radiance(4, 1e-6)),
            "sky_scattered": (("sky_zenith_deg", *three), radiance(4, 1e-5)),
        },
        coords={"range_m": ARC, "wavenumber_cm": NU, "sky_zenith_deg": ZENITH, "sun_zenith_deg": ZENITH, three[0]: AZIMUTH},
        attrs={"sensor_height_m": 30.0, "solar_zenith_deg": 76.0},
    )


@pytest.mark.parametrize("ending", ["nc", "csv"])
def test_scattered_light_comes_back(tmp_path, ending):
    dataset = scattered_columns()
    if ending == "nc":  # any order of dimensions and nodes
        dataset = dataset.transpose("wavenumber_cm", ...).isel(azimuth_from_sun_deg=[2, 0, 1], range_m=[3, 2, 0, 1])
    found = read_atmosphere(write_atmosphere(dataset, tmp_path / f"a.{ending}"), 30.0).scattered
    assert np.degrees(found.solar_zenith) == pytest.approx(76.0)
    np.testing.assert_allclose(np.degrees(found.azimuth), AZIMUTH)
    np.testing.assert_allclose(found.range_m, ARC)
    np.testing.assert_allclose(found.path, radiance(4, 1e-6), rtol=1e-8)
    (sky,) = found.skies
    assert sky.height == 0.0
    np.testing.assert_allclose(np.degrees(sky.zenith), ZENITH)
    np.testing.assert_allclose(sky.radiance, radiance(4, 1e-5), rtol=1e-8)


def test_a_file_without_it_holds_none(tmp_path):
    path = write_atmosphere(scattered_columns().drop_vars(["path_scattered", "sky_scattered"]), tmp_path / "a.nc")
    assert read_atmosphere(path, 30.0).scattered is None


def file_air_scenario(path, zenith):
    return parse_scenario(
        {
            "band": {"min_um": 3.9, "max_um": 4.1},
            "sensor": {"height_m": 30.0},
            "sun": {"zenith_deg": zenith},
            "atmosphere": {"source": "file", "path": str(path)},
        }
    )


def test_another_sun_is_refused(tmp_path):
    path = write_atmosphere(scattered_columns(), tmp_path / "a.nc")
    for zenith in (76.0, 76.05, 96.1):  # one 6 deg below the horizon scatters nothing
        wanted = file_air_scenario(path, zenith)
        assert scenario_physics.atmosphere(wanted, scenario_physics.band(wanted)).scattered is not None
    wanted = file_air_scenario(path, 70.0)
    with pytest.raises(DomainError, match=r"solar zenith = 70 deg: .*a\.nc holds scattered sunlight of a Sun at 76 deg only") as caught:
        scenario_physics.atmosphere(wanted, scenario_physics.band(wanted))
    assert caught.value.name == "solar_zenith"
    wanted = file_air_scenario(path, 93.0)  # twilight is of its own Sun
    with pytest.raises(DomainError, match=r"solar zenith = 93 deg: .*a\.nc holds scattered sunlight of a Sun at 76 deg only"):
        scenario_physics.atmosphere(wanted, scenario_physics.band(wanted))


MISTAKES = [
    (lambda d: d.assign_attrs(solar_zenith_deg=120.0), "path_scattered needs the attribute solar_zenith_deg"),
    (lambda d: d.assign_attrs(solar_zenith_deg="low"), "path_scattered needs the attribute solar_zenith_deg"),
    (lambda d: d.assign(path_scattered=-d.path_scattered), "path_scattered has values outside the range allowed: 0 or more"),
    (lambda d: d.assign(path_scattered=d.path_scattered.isel(azimuth_from_sun_deg=0, drop=True)), "needs the variable path_scattered on"),
    (lambda d: d.isel(azimuth_from_sun_deg=[0, 1]), "azimuth_from_sun_deg goes from 0 to 10; give it from 0"),
    (lambda d: d.assign_coords(azimuth_from_sun_deg=[0.0, 0.0, 180.0]), "azimuth_from_sun_deg needs at least 2 different"),
    (lambda d: d.drop_vars("azimuth_from_sun_deg"), "scattered sunlight needs the coordinate azimuth_from_sun_deg"),
]


@pytest.mark.parametrize(("spoil", "told"), MISTAKES)
def test_netcdf_mistakes_are_named(tmp_path, spoil, told):
    spoil(scattered_columns()).to_netcdf(tmp_path / "a.nc", engine="h5netcdf")
    with pytest.raises(DataError, match=rf"a\.nc: {told}"):
        read_atmosphere(tmp_path / "a.nc", 30.0)


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (lambda text: text.replace(",76.0\n", ",70.0\n", 1), r"line \d+: solar_zenith_deg = 76, 70 before"),
        (lambda text: text.rsplit("\n", 2)[0] + "\n", "sky-scattered from 0 m has 347 of 4 x 3 x 29 samples"),
        (lambda text: text + text.splitlines()[-1] + "\n", "gives sky-scattered at the same place"),
        (lambda text: text.replace("azimuth_from_sun_deg", "azimuth"), "missing: azimuth_from_sun_deg"),
        (
            lambda text: "\n".join(x for x in text.splitlines() if not x.startswith("path-scattered,30.0,200")),
            "is at other ranges than the thermal",
        ),
    ],
)
def test_csv_mistakes_are_named(tmp_path, change, told):
    path = write_atmosphere(scattered_columns(), tmp_path / "a.csv")
    path.write_text(change(path.read_text()))
    with pytest.raises(DataError, match=told):
        read_atmosphere(path, 30.0)
