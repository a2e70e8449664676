"""The exported sea is the one that is rendered."""

import numpy as np
import pytest
import xarray as xr
from render_scenes import spline

from seaglint.base.errors import DomainError, ScenarioError
from seaglint.scenario.load import parse_scenario
from seaglint.store.netcdf import write_netcdf
from seaglint.studies.build import scenario_physics
from seaglint.studies.sequence import sea_export as export
from seaglint.studies.sequence.sea_export import export_sea

SMALL = {"wind": {"speed_m_s": 8.0, "from_deg": 200.0}, "sea": {"shortest_wave_m": 4.0}, "render": {"tile_size": 128}}


@pytest.fixture(scope="module")
def sea():
    return export_sea(parse_scenario(SMALL), 3.2, centre=(1234.5, -77.0), extent=(60.0, 40.0), spacing=0.9)


def _waves():
    scenario = parse_scenario(SMALL)
    return scenario_physics.sea(scenario, scenario_physics.slopes(scenario)).waves


def test_patch_is_the_sum_of_the_tiles_read_where_they_have_wandered_to(sea):
    x, y = np.meshgrid(*sea.patch.axes)
    expected = 0.0
    for tile, wander, lattice in zip(sea.tiles, sea.wander, _waves().splines(3.2), strict=True):
        east, north = wander(x, y)
        expected = expected + spline(lattice.astype(float), tile.spacing, tile.rotation, x + east, y + north)
    assert np.abs(sea.patch_surface - expected).max() < 1e-5  # single precision of metres


def test_slopes_are_those_of_the_heights(sea):
    fine = export_sea(parse_scenario(SMALL), 3.2, extent=(32.0, 32.0), spacing=0.125).patch_surface.astype(float)
    measured = np.gradient(fine[..., 0], 0.125, axis=(1, 0))
    for axis in (0, 1):
        # tiles wander, which stretches and turns them by 5.5 % in each of four parts; the slopes are those of the tiles
        off = measured[axis][1:-1, 1:-1] - fine[1:-1, 1:-1, 1 + axis]
        assert off.std() < 0.1 * fine[..., 1 + axis].std()


def test_heights_and_slopes_have_the_variances_of_the_attributes(sea):
    """Over the whole of 60 seas, at points that no lattice has, and on the exported lattices: Hs and slopes as the attributes tell."""
    field, tight, lattices = _waves(), [], []
    patch = export.SeaPatch((0.0, 0.0), (900.0, 900.0), 21.3)
    for seed in range(60):
        waves = field.reseeded(seed)
        tight.append(np.mean(export._sampled(waves, 0.0, patch).astype(float) ** 2, axis=(0, 1)))
        lattices.append(sum(np.mean(lattice.astype(float) ** 2, axis=(0, 1)) for lattice in waves.surfaces(0.0)))
    slopes = sum(sea.attributes[f"resolved_mss_{way}"] for way in ("up", "cross"))
    height = (0.25 * sea.attributes["resolved_significant_height_m"]) ** 2
    for found in (np.array(tight), np.array(lattices)):
        both = np.stack([found[:, 0], found[:, 1] + found[:, 2]])
        mean, error = both.mean(axis=1), both.std(axis=1) / np.sqrt(60)
        assert np.all(error < [0.05 * height, 0.02 * slopes])
        np.testing.assert_array_less(np.abs(mean - [height, slopes]), 4.0 * error)


def test_facets_and_waves_add_up_to_the_slope_model(sea):
    scenario = parse_scenario(SMALL)
    model, field = scenario_physics.slopes(scenario), scenario_physics.sea(scenario, scenario_physics.slopes(scenario)).waves
    east_east, _, north_north = sea.facets.covariance()
    assert east_east + north_north + sum(field.resolved_mss()) == pytest.approx(model.mss, rel=1e-12)


def test_netcdf_holds_patch_tiles_and_roughness(sea, tmp_path):
    path = write_netcdf(sea.dataset(), tmp_path / "sea.nc")
    with xr.open_dataset(path) as found:
        assert found.height.dims == ("y", "x")
        assert np.array_equal(found.slope_north.values, sea.patch_surface[..., 2])
        assert found.height.attrs["units"] == "m"
        assert found.attrs["time_s"] == 3.2
        for i, tile in enumerate(sea.tiles):
            assert np.array_equal(found[f"height_{i}"].values, sea.lattices[i][..., 0])
            told = found[f"height_{i}"].attrs
            assert told["turn_deg"] == pytest.approx(np.degrees(tile.rotation))
            # the displacement, by the formula in the comment
            turns = told["wander_wave_vector_east_rad_m"] * 70.0 - told["wander_wave_vector_north_rad_m"] * 30.0 + told["wander_phase_rad"]
            place = sea.wander[i](np.array(70.0), np.array(-30.0))
            for axis, displacement in zip(("east", "north"), place, strict=True):
                assert np.sum(told[f"wander_amplitude_{axis}_m"] * np.sin(turns)) == pytest.approx(float(displacement))
            assert float(found[f"u_{i}"][-1]) == pytest.approx(tile.length - tile.spacing)
        assert float(found.facet_slope_east_east) == sea.facets.covariance()[0]
    assert set(sea.dataset(lattices=False).data_vars) == {
        *("height", "slope_east", "slope_north"),
        *(f"facet_slope_{name}" for name in ("east_east", "east_north", "north_north")),
    }


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"spacing": 50.0, "extent": (20.0, 20.0)}, "smaller than its spacing"),
        ({"extent": (-1.0, 5.0)}, "finite lengths"),
        ({"centre": (float("nan"), 0.0)}, "finite lengths"),
        ({"time": float("inf")}, "must be finite"),
        ({"extent": (4e5, 4e5), "spacing": 0.01}, "GB of memory and .* GB as PLY"),
    ],
)
def test_impossible_patches_are_refused(changes, message):
    with pytest.raises(DomainError, match=message):
        export_sea(parse_scenario(SMALL), **changes)


def test_memory_that_is_not_there_is_told(monkeypatch):
    monkeypatch.setattr(export, "memory_available", lambda: 1000)
    with pytest.raises(DomainError, match=r"0\.0 GB are free"):
        export_sea(parse_scenario(SMALL), extent=(50.0, 50.0))


def test_without_waves_there_is_no_surface():
    with pytest.raises(ScenarioError, match="no waves are resolved"):
        export_sea(parse_scenario({"sea": {"resolve_waves": False}}))
