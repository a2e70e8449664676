"""Endings of outputs say what is written: another kind's is refused before the work; and ``seaglint info`` says what any file is."""

import json

import numpy as np
import pytest

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
