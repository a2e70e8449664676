"""Names that commands are given for their output: refused before the work, with what to do; inputs are never replaced."""

from __future__ import annotations

import os
import signal
import subprocess
import sys

import pytest

from seaglint.cli.app import main
from seaglint.store import location, sequence_store
from seaglint.store.shards import Shards
from seaglint.store.writers import lock_path


def one_line(text: str) -> bool:
    return text.count("\n") == 1 and "Traceback" not in text


@pytest.mark.parametrize(
    ("command", "output", "code", "told"),
    [
        ("mean", "a.zarr", 2, "'seaglint render' makes sequences"),
        ("mean", "a.png", 2, "a name that ends in .nc"),
        ("render", "a.nc", 2, "a.nc, is made by 'seaglint mean'"),
        ("render", "none/a.zarr", 2, "does not exist; make it first"),
        ("mean", "none/a.nc", 2, "does not exist; make it first"),
        ("render", 300 * "a" + ".zarr", 3, "too long for this file system; choose a shorter one"),
        ("mean", 300 * "a" + ".nc", 3, "too long for this file system; choose a shorter one"),
        ("init", 300 * "a" + ".toml", 3, "too long for this file system; choose a shorter one"),
    ],
)
def test_names_are_refused_before_the_work(seaglint, scenario, tmp_path, monkeypatch, command, output, code, told):
    for name in ("seaglint.studies.sequence.render_sequence.prepare_sequence", "seaglint.studies.mean.mean_map.mean"):
        monkeypatch.setattr(name, lambda *_, **__: pytest.fail("computed"))
    answer = seaglint(*([command, tmp_path / output] if command == "init" else [command, scenario, "-o", tmp_path / output]))
    assert (answer.code, one_line(answer.err)) == (code, True), answer.err
    assert told in answer.err
    assert [path.name for path in tmp_path.iterdir()] == ["my.toml"]


@pytest.mark.parametrize("reads", ["scenario", "response"])
@pytest.mark.parametrize("command", [("mean",), ("export-sea",), ("atmosphere", "export")])
def test_inputs_are_never_replaced(seaglint, pipeline, scenario, tmp_path, command, reads):
    """Under another name too: the output is a link to what is read."""
    response = tmp_path / "band.csv"
    response.write_text("wavelength_um,response\n3.8,0\n4.0,1\n4.2,0\n")
    scenario.write_text(scenario.read_text() + '[band]\nresponse = "band.csv"\n')
    read = scenario if reads == "scenario" else response
    before = read.read_text()
    (tmp_path / "link.nc").symlink_to(read)
    answer = seaglint(*command, scenario, "-o", tmp_path / "link.nc", "--overwrite")
    assert answer.code == 2
    assert one_line(answer.err)
    assert "is read by this command" in answer.err
    assert read.read_text() == before


def test_masks_are_never_replaced(seaglint, tmp_path):
    mask = tmp_path / "mask.html"
    mask.write_text("x")
    answer = seaglint("analyze", tmp_path / "none.npy", "--mask", mask, "--report", mask, "--overwrite")
    assert (answer.code, "is read by this command" in answer.err) == (2, True)
    assert mask.read_text() == "x"


def test_previews_of_another_run_are_told_and_replaced_on_demand(seaglint, pipeline, scenario, tmp_path):
    assert seaglint("mean", scenario, "-o", tmp_path / "a.nc", "--preview").code == 0
    answer = seaglint("render", scenario, "-o", tmp_path / "a.zarr", "--preview", "--progress", "none")
    assert answer.code == 2
    assert "--preview writes this file" in answer.err
    assert "--overwrite" in answer.err
    before = (tmp_path / "a.png").read_bytes()
    assert seaglint("render", scenario, "-o", tmp_path / "a.zarr", "--preview", "--progress", "none", "--overwrite").code == 0
    assert (tmp_path / "a.png").read_bytes() != before


def test_where_nothing_can_be_written_is_code_3(seaglint, pipeline, scenario, tmp_path, monkeypatch):
    """A read-only file system refuses even to remove what is not there."""
    monkeypatch.setattr(os, "access", lambda path, mode: mode != os.W_OK)
    for command, output in (("render", "a.zarr"), ("mean", "a.nc")):
        answer = seaglint(command, scenario, "-o", tmp_path / output)
        assert (answer.code, one_line(answer.err)) == (3, True)
        assert "no right to write there; choose another place; nothing was written" in answer.err


def test_a_full_disk_at_the_start_leaves_nothing_and_says_so(seaglint, pipeline, scenario, tmp_path, monkeypatch):
    def full(*_, **__):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(location, "_put", full)
    answer = seaglint("render", scenario, "-o", tmp_path / "run.zarr", "--progress", "none")
    assert (answer.code, one_line(answer.err)) == (3, True)
    assert "nothing was written; make room" in answer.err
    assert "--resume" not in answer.err
    assert [path.name for path in tmp_path.iterdir()] == ["my.toml"]


def test_a_full_disk_leaves_no_lock(seaglint, pipeline, scenario, tmp_path, monkeypatch):
    real = os.write

    def full(descriptor, data):
        if data.startswith(f"{os.getpid()} ".encode()):
            raise OSError(28, "No space left on device")
        return real(descriptor, data)

    monkeypatch.setattr(os, "write", full)
    answer = seaglint("render", scenario, "-o", tmp_path / "run.zarr", "--progress", "none")
    assert (answer.code, "nothing was written" in answer.err) == (3, True)
    assert not lock_path(sequence_store.partial_path(tmp_path / "run.zarr")).exists()


def test_half_written_chunks_of_a_killed_process_go(seaglint, pipeline, scenario, tmp_path, monkeypatch):
    real = Shards.write

    def killed(shards, unit, *rest):
        if unit == 2:
            raise RuntimeError("killed here")
        real(shards, unit, *rest)

    monkeypatch.setattr(Shards, "write", killed)
    monkeypatch.setattr(sys, "argv", ["seaglint", "render", str(scenario), "-o", str(tmp_path / "run.zarr")])
    with pytest.raises(RuntimeError):
        main()
    left = sequence_store.partial_path(tmp_path / "run.zarr") / "radiance" / "c" / "1" / "0" / "0.abc.partial"
    assert left.parent.is_dir()
    left.write_bytes(b"half")
    monkeypatch.setattr(Shards, "write", real)
    store_made = seaglint("render", scenario, "-o", tmp_path / "run.zarr", "--resume", "--progress", "none")
    assert store_made.code == 0, store_made.err
    assert not list(tmp_path.rglob("*.partial"))


@pytest.mark.skipif(sys.platform == "win32", reason="SIGTERM ends a process of Windows at once")
def test_sigterm_before_the_first_frame_is_code_143_and_a_line(scenario, tmp_path):
    code = (
        "import sys, time; sys.path.insert(0, sys.argv.pop(1)); import types, conftest as fake; "
        "module = types.ModuleType('seaglint.studies.sequence.render_sequence'); "
        "module.render = lambda *_, **__: (print('prepares', file=sys.stderr, flush=True), time.sleep(3600)); "
        "sys.modules[module.__name__] = module; fake.main()"
    )
    command = [sys.executable, "-c", code, os.path.dirname(__file__), "render", str(scenario), "-o", str(tmp_path / "run.zarr")]
    process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    assert process.stderr is not None
    assert process.stderr.readline().startswith("air at 10 m")  # the default's, which the scenario does not state
    assert process.stderr.readline() == "prepares\n"
    process.send_signal(signal.SIGTERM)
    rest = process.communicate(timeout=600)[1]  # of the hour that it would take
    assert process.returncode == 143
    assert rest == "seaglint: terminated; files with their final names are complete\n"
