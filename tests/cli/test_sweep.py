"""The command ``seaglint sweep``."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from seaglint.plot.sweep_figure import draw_sweep

WINDS = ("--vary", "wind.speed_m_s=2:6:2")


@pytest.fixture
def toml(tmp_path):
    path = tmp_path / "my.toml"
    path.write_text("[sensor]\nheight_m = 20\n[band]\nmin_um = 8\nmax_um = 12\n")
    return path


def test_a_sweep_is_a_file_with_axes_and_a_picture(seaglint, toml, tmp_path):
    output = tmp_path / "sweep.nc"
    answer = seaglint(
        *("sweep", toml, *WINDS, "--vary", "sun.zenith_deg=0,40", "--at", "view_zenith_deg=0:60:30", "-o", output, "--preview")
    )
    assert (answer.code, answer.out) == (0, "")
    with xr.open_dataset(output, engine="h5netcdf") as stored:
        assert dict(stored.radiance.sizes) == {"wind.speed_m_s": 3, "sun.zenith_deg": 2, "view_zenith_deg": 3}
        assert stored["wind.speed_m_s"].values.tolist() == [2, 4, 6]
        assert stored["wind.speed_m_s"].attrs["units"] == "m s-1"
        assert stored.apparent_temperature.notnull().all()
        assert stored.attrs["what"] == "mean"
    assert output.with_suffix(".png").read_bytes()[:4] == b"\x89PNG"
    again = seaglint("sweep", toml, *WINDS, "-o", output)
    assert again.code == 2
    assert "exists already" in again.err


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--vary", "wind.speed=1,2"), "wind.speed is an unknown key; did you mean wind.speed_m_s?"),
        (("--vary", "wind.speed_m_s=1,5 m"), "unit of another kind ('m')"),
        (("--vary", "wind.speed_m_s=1,40,2"), "sweep, wind.speed_m_s = 40: "),
        (("--vary", "seed=1:100000:1", "--vary", "wind.speed_m_s=0.001:10:0.001", "--at", "view_zenith_deg=40"), "1000000000 cases, about"),
        (("--vary", "wind.speed_m_s"), "give KEY=VALUE,VALUE,..."),
        ((), "--vary is missing"),
        ((*WINDS, "--what", "median"), "is not one of mean, image"),
        ((*WINDS, "--at", "view_zenith_deg=95"), "view_zenith_deg = 95 is outside"),
    ],
)
def test_what_makes_no_sweep_is_one_line_and_writes_nothing(seaglint, toml, tmp_path, options, said):
    answer = seaglint("sweep", toml, *options, "-o", tmp_path / "sweep.nc", "--progress", "none")
    assert answer.code == 2
    assert said in answer.err
    assert answer.err.count("\n") == 1
    assert "Traceback" not in answer.err
    assert {path.name for path in tmp_path.iterdir()} == {"my.toml"}


def test_the_rest_is_kept_on_request(seaglint, toml, tmp_path):
    output = tmp_path / "sweep.nc"
    answer = seaglint(
        "sweep", toml, "--vary", "wind.speed_m_s=3,40,5", "--at", "view_zenith_deg=30", "-o", output, "--keep-going", "--progress", "none"
    )
    assert answer.code == 0
    assert "1 cases failed" in answer.err
    with xr.open_dataset(output, engine="h5netcdf") as stored:
        assert np.isnan(stored.radiance.values[:, 0]).tolist() == [False, True, False]


@pytest.mark.parametrize(("sizes", "panels", "lines"), [((5,), 1, 1), ((5, 6), 2, 0), ((3, 6), 1, 3), ((2, 3, 5), 2, 3)])
def test_pictures_have_axes_units_and_a_scale(sizes, panels, lines):
    names = [("wind.speed_m_s", "m s-1"), ("sun.zenith_deg", "degree"), ("view_zenith_deg", "degree")][-len(sizes) :]
    coords = {name: (name, np.arange(float(size)), {"units": unit}) for (name, unit), size in zip(names, sizes, strict=True)}
    values = ([name for name, _ in names], np.arange(float(np.prod(sizes))).reshape(sizes))
    figure = draw_sweep(xr.Dataset({"apparent_temperature": values}, coords=coords))
    shown = [axes for axes in figure.axes if axes.axison]
    assert len(shown) == panels  # an image and its scale, or panels of lines
    assert len(shown[0].lines) == lines
    text = " ".join([*(axes.get_xlabel() + axes.get_ylabel() for axes in shown)])
    assert "apparent temperature [K]" in text
    assert f"{names[-1][0]} [{names[-1][1]}]" in text
