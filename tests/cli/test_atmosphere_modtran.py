"""``atmosphere write`` and ``atmosphere read``: decks written, run by LOWTRAN7, read back, used: the air that LOWTRAN7 run live gives."""

import json
import shutil
import subprocess
from dataclasses import replace

import modtran_files as made
import numpy as np
import pytest
import xarray as xr

from seaglint.base.errors import BackendError
from seaglint.formats.lowtran import engine
from seaglint.formats.lowtran.deck import Aerosol, LowtranAir
from seaglint.formats.modtran.decks import ModtranCase, deck
from seaglint.formats.modtran.modtran_air import read_spectra
from seaglint.scenario.load import load_scenario
from seaglint.studies.mean.mean_map import mean

SCENE = """[band]
min_um = 3.9
max_um = 4.1
[wind]
speed_m_s = 7
[sun]
zenith_deg = {sun}
[sensor]
height_m = {height}
elevation_deg = -3.5
fov_deg = [4, 8]
pixels = [4, 64]
pixel_shape = "any"
[atmosphere]
"""


def write_scenario(folder, name, air, height=30.0, sun=76):
    path = folder / name
    path.write_text(SCENE.format(height=height, sun=sun) + air)
    return path


@pytest.fixture(scope="module")
def program(pytestconfig):
    """LOWTRAN7 compiled; the cache folder is kept from session to session."""
    if shutil.which("gfortran") is None:
        pytest.skip("gfortran is not installed")
    try:
        engine.fortran_file()
    except BackendError as error:
        pytest.skip(str(error))
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("SEAGLINT_CACHE", str(pytestconfig.cache.mkdir("seaglint")))
        yield engine.engine().program


def run_lowtran7(program, folder, samples):
    """What a user does with the deck: run it where it lies."""
    (folder / "out").mkdir()
    for tape in ("TAPE6", "TAPE7", "TAPE8"):
        (folder / "out" / tape).touch()
    subprocess.run([program, str(samples)], cwd=folder, check=True, capture_output=True)
    shutil.move(folder / "out" / "TAPE7", folder / "TAPE7")


@pytest.mark.parametrize(
    ("height", "scattered"), [pytest.param(30.0, "--scattered", marks=pytest.mark.validation), (2500.0, "--no-scattered")]
)
def test_decks_run_and_read_back_give_the_same_air(seaglint, program, tmp_path, height, scattered):
    """Three printed digits and other nodes leave 0.1 %, at 2500 m, where rays graze levels, 0.4 % of single pixels; 0.5 % is promised."""
    light = "" if scattered == "--scattered" else "scattered_sunlight = false\n"
    ours = write_scenario(tmp_path, "low.toml", 'source = "lowtran"\nlevels = "lowtran"\nspectroscopy = "lowtran7"\n' + light, height)
    theirs = write_scenario(tmp_path, "file.toml", 'source = "file"\npath = "air.nc"\n' + light, height)
    answer = seaglint("atmosphere", "write", ours, "--format", "tape5-lowtran7", "-o", tmp_path / "d", scattered)
    assert (answer.code, answer.out) == (0, "")
    run_lowtran7(program, tmp_path / "d", 27)
    answer = seaglint("atmosphere", "read", tmp_path / "d", "-o", tmp_path / "air.nc")
    assert (answer.code, answer.out) == (0, "")
    assert f"sensor.height_m = {height:g}" in answer.err
    a, b = (mean(load_scenario(path)) for path in (ours, theirs))
    for name in ("radiance", "path_radiance", "glint_radiance"):
        np.testing.assert_allclose(b[name], a[name], rtol=5e-3, atol=1e-6 * float(a.radiance.max()), err_msg=name)
    np.testing.assert_allclose(b.radiance.mean(), a.radiance.mean(), rtol=5e-4)
    air = xr.load_dataset(tmp_path / "air.nc")
    assert ("path_scattered" in air) == (scattered == "--scattered")
    if "path_scattered" in air:
        assert air.attrs["solar_zenith_deg"] == 76.0
        towards = air.sky_scattered.isel(azimuth_from_sun_deg=[0, -1]).mean("wavenumber_cm")
        low = towards.sel(sky_zenith_deg=80.0, method="nearest")
        assert 10.0 < float(low[0] / low[1]) < 1000.0


def test_scattered_light_of_a_known_case(program, tmp_path):
    """A path from 30 m 1 deg down, towards a Sun 14 deg high, in 3.5-5 um: 0.893 thermal and 0.104 W m-2 sr-1 scattered."""
    air = LowtranAir("midlatitude-summer", Aerosol(wind=7.0, wind_24h=7.0), 2000, 2860)
    (tmp_path / "TAPE5").write_text(deck([ModtranCase("path", 30.0, 91.0, azimuth_deg=0.0)], air, 76.0, modtran=False))
    run_lowtran7(program, tmp_path, air.samples)
    (found,) = read_spectra(tmp_path / "TAPE7")
    nu = np.append(np.arange(2000.0, 2857.0, 5.0), 1e4 / 3.5)
    bands = [np.trapezoid(np.interp(nu, found.wavenumber_cm, found.need(name)), nu) for name in ("thermal", "scattered")]
    np.testing.assert_allclose(bands, [0.893, 0.104], rtol=0.01)


@pytest.mark.parametrize(
    ("form", "deck_name", "output", "writer"),
    [("tape5", "lines.tp5", "lines.tp7", made.modtran), ("modtran6-json", "lines-input.json", "lines.csv", made.modtran6_csv)],
)
def test_modtran_decks_and_results_belong_together_by_the_manifest(seaglint, tmp_path, form, deck_name, output, writer):
    """Results in MODTRAN's layouts, one a line of the manifest, come back at its ranges and angles."""
    ours = write_scenario(tmp_path, "table.toml", 'source = "table"\n')
    assert seaglint("atmosphere", "write", ours, "--format", form, "-o", tmp_path / "d").code == 0
    lines = json.loads((tmp_path / "d" / "manifest.json").read_text())["lines"]
    text = (tmp_path / "d" / deck_name).read_text()
    assert len(lines) == (text.count('"MODTRANINPUT"') if form == "modtran6-json" else text.count("\nTM") + 1)
    modes = {"path": (2, 2), "sky": (2, 3), "sun": (3, 3)}
    cases = [made.case(*modes[x["kind"]], x["height_m"] / 1e3, x["zenith_deg"], x.get("azimuth_deg", 0.0)) for x in lines]
    (tmp_path / "d" / output).write_text(writer(cases))
    answer = seaglint("atmosphere", "read", tmp_path / "d" / output, "-o", tmp_path / "air.nc")
    assert answer.code == 0, answer.err
    air = xr.load_dataset(tmp_path / "air.nc")
    ranges = sorted({x["range_m"] for x in lines if x["kind"] == "path"})
    np.testing.assert_allclose(air.range_m, ranges, atol=1e-5)
    assert air.attrs["paths_reach_horizon"] == 1
    some = next(x for x in lines if x["kind"] == "path" and x["range_m"] > 1000.0)
    here = air.sel(range_m=some["range_m"], method="nearest")
    wanted = made.case(2, 2, 0.03, some["zenith_deg"], some["azimuth_deg"])
    np.testing.assert_allclose(here.path_radiance, 1e4 * wanted.thermal, rtol=1e-4)
    np.testing.assert_allclose(here.path_scattered.sel(azimuth_from_sun_deg=some["azimuth_deg"]), 1e4 * wanted.scattered, rtol=1e-4)
    # The output of a deck for another height does not pass for this one's.
    if form == "tape5":
        others = [made.case(*modes[x["kind"]], 0.035 if x["height_m"] else 0.0, x["zenith_deg"], x.get("azimuth_deg", 0.0)) for x in lines]
        (tmp_path / "d" / output).write_text(writer(others))
        answer = seaglint("atmosphere", "read", tmp_path / "d", "-o", tmp_path / "air.nc", "--overwrite")
        assert answer.code == 2
        assert "case 1: looks from 35 m" in answer.err
        (tmp_path / "d" / output).write_text(writer([replace(c, solar=70.0) for c in cases]))
        answer = seaglint("atmosphere", "read", tmp_path / "d", "-o", tmp_path / "air.nc", "--overwrite")
        assert answer.code == 2
        assert "case 1: has a Sun at 70 deg" in answer.err
    (tmp_path / "d" / output).write_text(writer(cases[:100]))
    answer = seaglint("atmosphere", "read", tmp_path / "d", "-o", tmp_path / "air.nc", "--overwrite")
    assert answer.code == 2
    assert "holds 100 cases, manifest.json beside it" in answer.err


def test_scattered_light_of_an_unknown_azimuth_is_left_out_and_told(seaglint, tmp_path):
    """IPARM = 1 gives the Sun by place and time: its azimuth from the line of sight is not among the cards."""
    text = made.modtran(made.all_cases(azimuths=(0.0,))).replace("    2    2   93    0", "    1    2   93    0")
    (tmp_path / "a.tp7").write_text(text)
    answer = seaglint("atmosphere", "read", tmp_path / "a.tp7", "-o", tmp_path / "air.nc")
    assert answer.code == 0
    assert "scattered sunlight of 12 cases is left out" in answer.err
    assert "path_scattered" not in xr.load_dataset(tmp_path / "air.nc")


def test_a_sun_below_the_horizon_scatters_nothing(seaglint, tmp_path):
    assert seaglint("atmosphere", "write", write_scenario(tmp_path, "a.toml", 'source = "table"\n', sun=95), "-o", tmp_path / "d").code == 0
    manifest = json.loads((tmp_path / "d" / "manifest.json").read_text())
    assert manifest["solar_zenith_deg"] is None
    assert all("azimuth_deg" not in line for line in manifest["lines"])


def test_what_cannot_be_written_or_read_is_refused_in_a_line(seaglint, tmp_path):
    ours = write_scenario(tmp_path, "a.toml", 'source = "table"\n')
    assert seaglint("atmosphere", "write", ours, "-o", tmp_path / "d").code == 0
    (tmp_path / "f").write_text("x")
    none = write_scenario(tmp_path, "none.toml", 'source = "none"\n')
    for told, *command in (
        ("exists already", "write", ours, "-o", tmp_path / "d"),
        ("is a file; give the name of a folder", "write", ours, "-o", tmp_path / "f"),
        ("is no air that MODTRAN could compute", "write", none, "-o", tmp_path / "e"),
        ("holds none of lines.tp7, tape7", "read", tmp_path / "d", "-o", tmp_path / "a.nc"),
        ("no such file", "read", tmp_path / "x.tp7", "-o", tmp_path / "a.nc"),
        ("neither .csv nor .nc", "read", tmp_path / "x.tp7", "-o", tmp_path / "a.txt"),
        ("is of no known format", "read", tmp_path / "f", "-o", tmp_path / "a.nc"),
    ):
        answer = seaglint("atmosphere", *command)
        assert answer.code == 2, told
        assert told in answer.err
        assert answer.err.count("\n") == 1
