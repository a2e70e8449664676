"""Endings of outputs say what is written: another kind's is refused before the work; and ``seaglint info`` says what any file is."""

import functools
import json
import re
from pathlib import Path

import numpy as np
import pytest

from seaglint.base.thread_setting import require_thread_setting
from seaglint.scenario.load import load_scenario

ENSEMBLE = 'base = "my.toml"\n[ensemble]\nscenes = 3\n[[vary]]\nkey = "wind.speed_m_s"\nlaw = "uniform"\nmin = 2\nmax = 9\n'
OF_MAPS = ("m.txt", "m.json", "m.zarr", "m.zip", "m.png", "m.h5")
OF_STORES = ("r.zip", "r.tif", "r.txt", "r.nc", "r.tar", "r.parquet", "r.webm", "r.YAML")
OF_FOLDERS = ("e.zip", "e.csv", "e.json")


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "my.toml").write_text("[sensor]\npixels = [32, 16]\nframes = 2\n")
    (tmp_path / "winds.toml").write_text(ENSEMBLE)
    (tmp_path / "cases.csv").write_text("zenith_deg\n10\n")
    np.save(tmp_path / "clip.npy", np.linspace(1.0, 2.0, 5 * 6 * 7, dtype=np.float32).reshape(5, 6, 7))
    return tmp_path


@pytest.mark.parametrize(
    ("command", "output"),
    [
        *((("mean", "my.toml"), name) for name in OF_MAPS),
        *((("render", "my.toml"), name) for name in OF_STORES),
        *((("sense", "clip.npy", "my.toml"), name) for name in OF_STORES[:3]),
        *((("init",), name) for name in ("x.json", "x.yaml", "x.txt", "x.zarr")),
        *((("evaluate", "emissivity", "cases.csv"), name) for name in ("o.json", "o.nc", "o.xlsx")),
        *((("ensemble", "winds.toml", "--draw-only"), name) for name in OF_FOLDERS),
        *((("dataset", "winds.toml"), name) for name in OF_FOLDERS),
        *((("reproduce", "headline"), name) for name in ()),
        *((("export", "r.zarr"), name) for name in ("o.zarr", "o.toml")),
        *((("export-sea", "my.toml"), name) for name in ("o.csv", "o.zarr")),
        *((("texture", "fit", "clip.npy"), name) for name in ("o.toml", "o.zarr")),
        *((("labels", "r.zarr"), name) for name in ("o.xml", "o.nc")),
        *((("detect", "recording", "clip.npy"), name) for name in ("o.zip", "o.png")),
        *((("likelihood", "my.toml"), name) for name in ("o.zip", "o.txt")),
    ],
)
def test_an_ending_of_another_kind_is_refused_and_nothing_written(seaglint, folder, command, output):
    before = sorted(folder.iterdir())
    answer = seaglint(*command, *((output,) if command[0] == "init" else ("-o", output)))
    assert answer.code == 2
    assert answer.out == ""
    assert answer.err.startswith("seaglint: ")
    assert answer.err.count("\n") == 1
    assert sorted(folder.iterdir()) == before


@pytest.mark.parametrize("name", ["run_0.5", "night", "v1.2"])
def test_a_name_with_a_point_is_a_name(seaglint, folder, name):
    assert seaglint("ensemble", "winds.toml", "--draw-only", "-o", name).code == 0
    assert (folder / name / "parameters.csv").is_file()


def test_info_says_what_a_scenario_describes(seaglint, folder):
    answer = seaglint("info", "my.toml")
    assert answer.code == 0
    assert "my.toml: a scenario" in answer.out
    assert "32 x 16 pixels" in answer.out
    assert "wind 7 m/s from 230 deg" in answer.out
    assert json.loads(seaglint("info", "my.toml", "--json").out)["kind"] == "scenario"
    ensemble = seaglint("info", "winds.toml").out
    assert "an ensemble" in ensemble
    assert "3 scenes; drawn for each: wind.speed_m_s" in ensemble


def test_info_says_what_an_array_is_and_lacks(seaglint, folder):
    answer = seaglint("info", "clip.npy")
    assert answer.code == 0
    assert "5 of 7 x 6 pixels, no frame rate" in answer.out
    assert "no unit" in answer.out
    assert "--units and --frame-rate" in answer.out
    facts = json.loads(seaglint("info", "clip.npy", "--json").out)
    assert (facts["frames"], facts["rows"], facts["columns"]) == (5, 6, 7)
    assert facts["least"] == pytest.approx(1.0)


def test_info_is_ten_lines_and_all_the_rest_on_demand(seaglint, folder):
    assert seaglint("render", "my.toml", "-o", "run.zarr", "--progress", "none").code == 0
    short, long = seaglint("info", "run.zarr").out.splitlines(), seaglint("info", "run.zarr", "--all").out.splitlines()
    assert len(short) <= 10
    assert len(long) > 20
    assert any("cut_wavenumber_rad_m" in line for line in long)
    assert not any("cut_wavenumber_rad_m" in line for line in short)


PROC = pytest.mark.skipif(not Path("/proc/self").exists(), reason="a folder that takes no files although its rights allow it")


@PROC
@pytest.mark.parametrize(
    ("command", "output"),
    [
        (("mean", "my.toml"), "x.nc"),
        (("render", "my.toml"), "x.zarr"),
        (("sense", "clip.npy", "my.toml"), "x.zarr"),
        (("init",), "x.toml"),
        (("evaluate", "emissivity", "cases.csv"), "x.csv"),
        (("ensemble", "winds.toml"), "x"),
        (("dataset", "winds.toml"), "x"),
        (("reproduce", "fig5"), "x"),
        (("export-sea", "my.toml"), "x.ply"),
        (("texture", "fit", "clip.npy"), "x.json"),
        (("detect", "recording", "clip.npy"), "x"),
        (("atmosphere", "export", "my.toml"), "x.nc"),
        (("atmosphere", "write", "my.toml"), "x"),
    ],
)
def test_a_folder_that_takes_no_files_is_named_before_the_work(seaglint, folder, command, output):
    answer = seaglint(*command, *((f"/proc/{output}",) if command[0] == "init" else ("-o", f"/proc/{output}")))
    assert answer.code == 3
    last = answer.err.splitlines()[-1]
    assert "/proc" in last
    assert "cannot be written to" in last or "no right to write there" in last


@pytest.mark.parametrize("given", ["abc", "0", "-1", "1000", "1.5"])
def test_a_wrong_number_of_threads_is_a_line(seaglint, folder, monkeypatch, given):
    monkeypatch.setenv("NUMBA_NUM_THREADS", given)
    monkeypatch.setattr("os.cpu_count", lambda: 8)
    answer = seaglint("mean", "my.toml", "-o", "m.nc")
    assert answer.code == 2
    assert answer.err.startswith(f"seaglint: NUMBA_NUM_THREADS = '{given}' in the environment is no number of threads; allowed: 1 to 256")
    assert answer.err.count("\n") == 1


def test_threads_that_are_allowed_pass(monkeypatch):
    for given in ("1", "2", " 4 ", "256", ""):
        monkeypatch.setenv("NUMBA_NUM_THREADS", given)
        require_thread_setting()


def test_init_says_what_a_camera_leaves_open(seaglint, folder):
    answer = seaglint("init", "cam.toml", "--camera", "pitch_um=15,pixels=640x512,aperture_m=0.05,f_number=2")
    assert answer.code == 0
    for said in (
        "[sensor] height_m = 30, azimuth_deg = 180, elevation_deg = -1.925",
        "frame_rate_hz = 25, frames = 100",
        "[band] min_um = 3.5, max_um = 5",
        "[sensor.optics] focal_length_m = 0.1, transmission = 1",
        "quantum_efficiency = 1, integration_time_s = a whole frame, well_capacity_e = without limit, read_noise_e = 0",
        "[sensor.noise] all 0",
        "[wind] speed_m_s = 7, from_deg = 230",
    ):
        assert said in answer.err
    scenario = load_scenario(folder / "cam.toml")
    for table, keys in re.findall(r"\[([\w.]+)\] (\w+ = .*)", answer.err):  # each is what the file has
        for key, value in re.findall(r"(\w+) = (\[.*?\]|[^,]+)", keys):
            record = functools.reduce(getattr, table.split("."), scenario)
            if isinstance(getattr(record, key), int | float):
                assert f"{getattr(record, key):g}" == value
