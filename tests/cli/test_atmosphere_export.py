"""A file of air made from the package's own table gives the table's results; only the ranges in view are asked of a file."""

import numpy as np
import pytest
import xarray as xr

from seaglint.base.errors import DomainError
from seaglint.formats.air_file import read_atmosphere
from seaglint.scenario.load import load_scenario
from seaglint.studies.mean.mean_map import mean
from seaglint.studies.sequence.render_sequence import prepare_sequence

SCENE = """[band]
min_um = 3.9
max_um = 4.1
[sensor]
height_m = {height}
elevation_deg = {elevation}
fov_deg = [4, {fov}]
pixels = [4, {rows}]
pixel_shape = "any"
"""
THERMAL = "[atmosphere]\nscattered_sunlight = false\n"
WAVES = "[sea]\nshortest_wave_m = 4.0\n[render]\ntile_size = 128\n"


def write_scenario(folder, name="table.toml", *, height=30.0, elevation=-3.5, fov=8.0, rows=256, more=""):
    path = folder / name
    path.write_text(SCENE.format(height=height, elevation=elevation, fov=fov, rows=rows) + more)
    return path


@pytest.mark.parametrize("ending", ["nc", "csv"])
@pytest.mark.parametrize(("height", "elevation"), [(30.0, -3.5), (2500.0, -8.0)])
def test_the_table_as_a_file_gives_equal_maps(seaglint, tmp_path, ending, height, elevation):
    """Nodes dense enough that the spline between them costs less than 1e-4 of any pixel; horizon and sky in view at 30 m."""
    ours = write_scenario(tmp_path, height=height, elevation=elevation, more=THERMAL)
    answer = seaglint("atmosphere", "export", ours, "-o", tmp_path / f"air.{ending}")
    assert (answer.code, answer.out) == (0, "")
    assert 'source = "file"' in answer.err
    theirs = write_scenario(
        tmp_path, "file.toml", height=height, elevation=elevation, more=f'{THERMAL}source = "file"\npath = "air.{ending}"\n'
    )
    a, b = (mean(load_scenario(path)) for path in (ours, theirs))
    for name in ("radiance", "path_radiance", "sky_radiance", "glint_radiance", "glint_std"):
        np.testing.assert_allclose(b[name], a[name], rtol=2e-4, atol=1e-6 * float(a.radiance.max()), err_msg=name)


@pytest.mark.validation
def test_the_table_as_a_file_gives_equal_pictures(seaglint, tmp_path):
    ours = write_scenario(tmp_path, rows=32, more=WAVES + THERMAL)
    assert seaglint("atmosphere", "export", ours, "-o", tmp_path / "air.nc").code == 0
    theirs = write_scenario(tmp_path, "file.toml", rows=32, more=WAVES + THERMAL + 'source = "file"\npath = "air.nc"\n')
    a, b = (prepare_sequence(load_scenario(path)).at(0.0).radiance for path in (ours, theirs))
    np.testing.assert_allclose(b, a, rtol=5e-4)


def test_ranges_outside_the_picture_are_not_asked_for(seaglint, tmp_path):
    """Rows from 2 to 6 deg below the horizontal see 284 to 850 m; a file from 250 to 1000 m serves, one that lacks 850 m does not."""
    ours = write_scenario(tmp_path, elevation=-4.0, fov=4.0, more=THERMAL)
    assert seaglint("atmosphere", "export", ours, "-o", tmp_path / "air.nc").code == 0
    whole = xr.load_dataset(tmp_path / "air.nc")
    part = THERMAL + 'source = "file"\npath = "part.nc"\n'
    theirs = write_scenario(tmp_path, "part.toml", elevation=-4.0, fov=4.0, more=part)
    waves = write_scenario(tmp_path, "waves.toml", elevation=-4.0, fov=4.0, rows=32, more=part + WAVES)

    def cut(low, high):
        inside = (whole.range_m > low) & (whole.range_m < high)
        whole.isel(range_m=np.flatnonzero(inside)).to_netcdf(tmp_path / "part.nc", engine="h5netcdf")

    cut(230.0, 1000.0)
    a, b = (mean(load_scenario(path)) for path in (ours, theirs))
    np.testing.assert_allclose(b.radiance, a.radiance, rtol=1e-3)
    assert np.isfinite(prepare_sequence(load_scenario(waves)).at(0.0).radiance).all()
    cut(230.0, 800.0)
    with pytest.raises(DomainError, match=r"range = 8\d\d(\.\d)? m is outside .* add paths"):
        mean(load_scenario(theirs))
    with pytest.raises(DomainError, match="range = 0 m is outside"):
        read_atmosphere(tmp_path / "part.nc", 30.0).transmittance(30.0, 0.0)


@pytest.mark.validation
def test_scattered_sunlight_goes_with_the_file(seaglint, tmp_path):
    """Fourteen azimuths and the nodes of the thermal air leave 2 % of what is scattered; another Sun is refused."""
    sun = "[sun]\nzenith_deg = 76\nazimuth_deg = 4\n"
    ours = write_scenario(tmp_path, rows=64, more=sun)
    assert seaglint("atmosphere", "export", ours, "-o", tmp_path / "air.nc").code == 0
    file = '[atmosphere]\nsource = "file"\npath = "air.nc"\n'
    theirs = write_scenario(tmp_path, "file.toml", rows=64, more=sun + file)
    dark = write_scenario(tmp_path, "dark.toml", rows=64, more=sun + THERMAL)
    a, b, c = (mean(load_scenario(path)).radiance for path in (ours, theirs, dark))
    scattered = a - c
    assert float((scattered / a).max()) > 0.02
    np.testing.assert_allclose(b - c, scattered, atol=0.02 * float(scattered.max()), rtol=0.05)
    other = write_scenario(tmp_path, "other.toml", rows=64, more=sun.replace("76", "70") + file)
    answer = seaglint("mean", other, "-o", tmp_path / "other.nc")
    assert answer.code == 2
    assert "76" in answer.err


def test_what_is_no_table_is_refused(seaglint, tmp_path):
    ours = write_scenario(tmp_path)
    answer = seaglint("atmosphere", "export", ours, "-o", tmp_path / "air.txt")
    assert answer.code == 2
    assert "neither .csv nor .nc" in answer.err
    assert seaglint("atmosphere", "export", ours, "-o", tmp_path / "air.nc").code == 0
    theirs = write_scenario(tmp_path, "file.toml", more='[atmosphere]\nsource = "file"\npath = "air.nc"\n')
    answer = seaglint("atmosphere", "export", theirs, "-o", tmp_path / "b.nc")
    assert answer.code == 2
    assert "is such a file already" in answer.err
