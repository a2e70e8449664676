"""``seaglint export`` and ``sg.export`` from a store to a file."""

from __future__ import annotations

import json
import signal
import subprocess
import sys

import h5py
import numpy as np
import pytest

import seaglint as sg
from seaglint.store.sequence_store import open_sequence

ENDINGS = ["nc", "h5", "tif", "fits", "npy", "raw", "mp4", "gif"]


@pytest.fixture
def run(seaglint, pipeline, scenario, tmp_path):
    path = tmp_path / "run.zarr"
    assert seaglint("render", scenario, "-o", path, "--progress", "none").code == 0
    scenario.unlink()
    return path


def test_every_format_is_written_once(seaglint, run):
    for ending in ENDINGS:
        output = run.with_name(f"x.{ending}")
        answer = seaglint("export", run, "-o", output)
        assert (answer.code, answer.out) == (0, "")
        assert "radiance [W m-2 sr-1], 4 frames of 32 x 16" in answer.err
        again = seaglint("export", run, "-o", output)
        assert (again.code, again.err.count("\n")) == (2, 1)
        assert "exists already" in again.err
        assert seaglint("export", run, "-o", output, "--overwrite").code == 0
    assert {path.name for path in run.parent.iterdir()} == {"run.zarr", "x.json", "x.npy.json", *(f"x.{ending}" for ending in ENDINGS)}


def test_frames_variable_and_numbers_are_chosen(seaglint, run):
    output = run.with_name("x.npy")
    answer = seaglint("export", run, "-o", output, "--frames", "1:4:2", "--dtype", "uint16", "--range", 0, 5, "--variable", "radiance")
    assert answer.code == 0
    assert "2 frames of 32 x 16, uint16; value = " in answer.err
    about = json.loads(run.with_name("x.npy.json").read_text())["metadata"]
    with open_sequence(run) as dataset:
        expected = dataset["radiance"].to_numpy()[1::2]
    found = about["add_offset"] + about["scale_factor"] * np.load(output)
    np.testing.assert_allclose(found, np.clip(expected, 0.0, 5.0), rtol=0.0, atol=0.501 * 5.0 / 65534)


def test_colours_and_rate_of_a_video(seaglint, run):
    from PIL import Image

    hot = []
    for colours in ("white-hot", "black-hot"):
        output = run.with_name("x.gif")
        assert seaglint("export", run, "-o", output, "--map", colours, "--fps", 4, "--scale", "linear", "--overwrite").code == 0
        with Image.open(output) as image:
            assert image.info["duration"] == 250
            hot.append(np.asarray(image.convert("L")).astype(int))
    np.testing.assert_array_equal(hot[0], 255 - hot[1])


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("-o", "x.avi"), "allowed are .nc, .h5, .hdf5, .tif, .tiff, .fits, .npy, .raw, .mp4, .gif"),
        (("-o", "x"), "allowed are"),
        (("-o", "x.tif", "--variable", "signal"), "has no images 'signal'; it has radiance"),
        (("-o", "x.tif", "--frames", "2:9"), "allowed: 0:4"),
        (("-o", "x.tif", "--frames", "0:4:0"), "a step of 0"),
        (("-o", "x.tif", "--frames", "a"), "is not a range of frames"),
        (("-o", "x.tif", "--range", "2", "1", "--dtype", "uint16"), "the smaller first"),
        (("-o", "run.zarr/x.tif"), "inside the run"),
        (("-o", "missing/x.tif"), "does not exist"),
    ],
)
def test_what_cannot_be_is_refused_in_one_line(seaglint, run, monkeypatch, arguments, message):
    monkeypatch.chdir(run.parent)
    answer = seaglint("export", run.name, *arguments)
    assert (answer.code, answer.err.count("\n")) == (2, 1)
    assert message in answer.err
    assert [path.name for path in run.parent.iterdir()] == ["run.zarr"]


def test_other_kinds_and_unfinished_runs_are_refused(seaglint, pipeline, scenario, tmp_path):
    seaglint("mean", scenario, "-o", tmp_path / "mean.nc")
    seaglint("render", scenario, "-o", tmp_path / "run.zarr", "--progress", "none")
    (tmp_path / "run.zarr").rename(tmp_path / "cut.zarr.partial")
    import zarr

    zarr.open_group(tmp_path / "cut.zarr.partial", mode="r+")["frame_done"][2] = 0
    for name, message in (
        ("mean.nc", "is not a seaglint sequence"),
        ("cut.zarr", "unfinished: render again with"),
        ("cut.zarr.partial", "1 of 4 frames are missing"),
        ("none.zarr", "no such sequence"),
    ):
        answer = seaglint("export", tmp_path / name, "-o", tmp_path / "x.tif")
        assert (answer.code, answer.err.count("\n")) == (2, 1)
        assert message in answer.err
    assert not (tmp_path / "x.tif").exists()


@pytest.mark.skipif(sys.platform == "win32", reason="signals")
@pytest.mark.parametrize(("number", "code", "ending"), [(signal.SIGINT, 130, "tif"), (signal.SIGTERM, 143, "h5")])
def test_a_signal_leaves_nothing_under_the_final_name(run, number, code, ending):
    output = run.with_name(f"x.{ending}")
    slow = (  # once the file is begun, a frame waits for a line
        "import signal, sys, pathlib, seaglint.formats.export.stack as s; "
        "signal.signal(signal.SIGINT, signal.default_int_handler); "  # a shell may have started the suite with it ignored
        " read = s.Stack.__getitem__; begun = pathlib.Path(sys.argv.pop(1)); "
        "stop = lambda: begun.exists() and (print('begun', file=sys.stderr, flush=True), sys.stdin.readline()); "
        "s.Stack.__getitem__ = lambda *a: (stop(), read(*a))[1]; from seaglint.cli.app import main; main()"
    )
    partial = output.with_name(output.name + ".partial")
    started = subprocess.Popen(
        [sys.executable, "-c", slow, partial, "export", run, "-o", output], stdin=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert started.stderr is not None
    assert "begun\n" in iter(started.stderr.readline, "")
    started.send_signal(number)
    told = started.communicate("go on\n", timeout=600)[1]
    assert started.returncode == code
    assert "files with their final names are complete" in told
    assert [path.name for path in run.parent.iterdir()] == ["run.zarr"]


def test_python_does_the_same(seaglint, run):
    told = sg.export(run, run.with_name("x.h5"), frames=range(1, 3), dtype="uint16")
    with open_sequence(run) as dataset, h5py.File(told.files[0]) as file:
        values = dataset["radiance"].to_numpy()[1:3]
        found = told.add_offset + told.scale_factor * file["radiance"][:].astype(np.float64)
        np.testing.assert_allclose(found, values, rtol=0.0, atol=0.501 * np.ptp(values) / 65534)
        part = sg.export(dataset.isel(time=slice(2, None)), run.with_name("x.raw"))
    assert part.shape == (2, 16, 32)
    with pytest.raises(TypeError, match="color"):
        sg.export(run, run.with_name("x.gif"), color="red")
