"""Every command: what it prints, where, and with which exit code."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

import seaglint as package
from seaglint.base.errors import DomainError, ScenarioError
from seaglint.cli import app as commands
from seaglint.cli.doctor import data_files, examine, read_checksums
from seaglint.cli.terminal.options import parse_frames
from seaglint.cli.terminal.progress import LOG_INTERVAL, Pace, ProgressMode, log_lines, progress


def one_line(text: str) -> bool:
    return text.count("\n") == 1 and "Traceback" not in text


def test_init_then_render_then_info(seaglint, pipeline, tmp_path):
    toml, run = tmp_path / "my.toml", tmp_path / "run.zarr"
    assert seaglint("init", toml).code == 0
    text = toml.read_text().replace("[16.0, 8.0]", "[4.0, 2.0]").replace("[512, 256]", "[32, 16]").replace("frames = 100", "frames = 3")
    toml.write_text(text)
    answer = seaglint("render", toml, "-o", run, "--preview", "--progress", "log")
    assert (answer.code, answer.out) == (0, "")
    assert "3 frames, mean" in answer.err
    assert "3/3" in answer.err
    assert {path.name for path in tmp_path.iterdir()} == {"my.toml", "run.zarr", "run.png", "run.mp4"}
    assert "complete" in seaglint("info", run).out
    facts = json.loads(seaglint("info", run, "--json").out)
    assert (facts["frames"], facts["pixels"], facts["complete"]) == (3, [32, 16], True)
    assert facts["scenario"]["sensor"]["frames"] == 3


def test_mean_then_info(seaglint, pipeline, scenario, tmp_path):
    output = tmp_path / "mean.nc"
    answer = seaglint("mean", scenario, "-o", output, "--preview")
    assert (answer.code, answer.out) == (0, "")
    assert json.loads(seaglint("info", output, "--json").out)["pixels"] == [32, 16]
    assert (tmp_path / "mean.png").exists()
    again = seaglint("mean", scenario, "-o", output)
    assert again.code == 2
    assert one_line(again.err)


@pytest.mark.parametrize("command", ["mean", "render"])
def test_the_scale_of_previews_is_chosen(seaglint, pipeline, scenario, tmp_path, command):
    output = tmp_path / ("mean.nc" if command == "mean" else "run.zarr")
    pictures = []
    for scale in ("linear", "log"):
        assert seaglint(command, scenario, "-o", output, "--preview", "--scale", scale, "--overwrite").code == 0
        pictures.append(output.with_suffix(".png").read_bytes())
    assert pictures[0] != pictures[1]
    assert "'auto', 'linear', 'log'" in seaglint(command, scenario, "-o", output, "--preview", "--scale", "square").err


def test_one_frame_alone_is_that_of_the_sequence(seaglint, pipeline, scenario, tmp_path):
    from seaglint.store.sequence_store import open_sequence

    seaglint("render", scenario, "-o", tmp_path / "all.zarr")
    assert seaglint("render", scenario, "-o", tmp_path / "one.zarr", "--frames", "2:3").code == 0
    with open_sequence(tmp_path / "all.zarr") as whole, open_sequence(tmp_path / "one.zarr") as one:
        assert one["radiance"][0].to_numpy().tobytes() == whole["radiance"][2].to_numpy().tobytes()


def test_a_trailing_slash_changes_nothing(seaglint, pipeline, scenario, tmp_path):
    seaglint("render", scenario, "-o", f"{tmp_path / 'run.zarr'}/", "--preview", "--progress", "none")
    assert (tmp_path / "run.png").exists()


def test_without_pyav_the_preview_says_so_and_goes_on(seaglint, pipeline, scenario, tmp_path, monkeypatch):
    monkeypatch.setattr("seaglint.plot.video.video_available", lambda: False)
    answer = seaglint("render", scenario, "-o", tmp_path / "run.zarr", "--preview")
    assert answer.code == 0
    assert "pip install 'av>=14'" in answer.err
    assert (tmp_path / "run.png").exists()
    assert not (tmp_path / "run.mp4").exists()


@pytest.mark.parametrize(
    "arguments",
    [
        ("render", "nix.toml", "-o", "run.zarr"),
        ("render", "my.toml", "-o", "no/run.zarr"),
        ("render", "my.toml", "-o", "run.zarr", "--frames", "3:9"),
        ("render", "my.toml", "-o", "run.zarr", "--frames", "two"),
        ("render", "my.toml", "-o", "my.toml"),
        ("render", "my.toml", "-o", "run.zarr", "--resume", "--overwrite"),
        ("render", "bad.toml", "-o", "run.zarr"),
        ("mean", "my.toml", "-o", "no/mean.nc"),
        ("mean", "bad.toml", "-o", "mean.nc"),
        ("info", "nix.zarr"),
        ("info", "bad.toml"),
        ("info", "nix.toml"),
        ("init", "my.toml"),
        ("init", "other.toml", "--preset", "nix"),
        ("init", "other.toml", "--preset", ""),
    ],
)
def test_user_errors_are_one_line_and_code_2(seaglint, pipeline, scenario, tmp_path, monkeypatch, arguments):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "bad.toml").write_text("[sensor]\nheight_m = -1\n")
    before = {path: path.read_bytes() for path in tmp_path.iterdir()}
    answer = seaglint(*arguments)
    assert answer.code == 2
    assert answer.out == ""
    assert one_line(answer.err)
    assert answer.err.startswith("seaglint: ")
    assert {path: path.read_bytes() for path in tmp_path.iterdir()} == before


def test_a_sensor_within_reach_of_the_waves_is_told_by_file_and_key(seaglint, tmp_path):
    path = tmp_path / "low.toml"
    path.write_text(
        "[sensor]\nheight_m = 2\nfov_deg = [4, 2]\npixels = [8, 4]\n[wind]\nspeed_m_s = 18\n[atmosphere]\nsource = 'isothermal'\n"
    )
    answer = seaglint("render", path, "-o", tmp_path / "run.zarr", "--progress", "none")
    assert answer.code == 2
    assert one_line(answer.err)
    assert answer.err.startswith(
        f"seaglint: {path}: sensor.height_m: sensor height = 2 m is within reach of the waves (significant height "
    )
    assert "sea.resolve_waves = false" in answer.err
    assert not (tmp_path / "run.zarr").exists()
    assert seaglint("mean", path, "-o", tmp_path / "mean.nc").code == 0  # no wave stands in the way of the mean


@pytest.mark.parametrize(
    ("error", "told"),
    [
        (DomainError("at 3 s the sea stands 5 m high", name="sensor_height", value=3.0), "sensor.height_m: at 3 s the sea stands 5 m"),
        (DomainError("sensor height and sea do not agree"), "sensor height and sea do not agree"),
        (DomainError("wind speed = 0.3 m/s is outside"), "wind speed = 0.3 m/s is outside"),
        (ScenarioError("sea.spectrum.time is missing"), "sea.spectrum.time is missing"),
    ],
)
def test_what_only_physics_refuses_names_the_file(seaglint, pipeline, scenario, tmp_path, monkeypatch, error, told):
    def refuse(*_, **__):
        raise error

    monkeypatch.setattr(sys.modules["seaglint.studies.sequence.render_sequence"], "render", refuse)
    answer = seaglint("render", scenario, "-o", tmp_path / "run.zarr", "--progress", "none")
    assert answer.code == 2
    assert one_line(answer.err)
    assert answer.err.startswith(f"seaglint: {scenario}: {told}")


@pytest.mark.parametrize("arguments", [("render",), ("nix",), ("render", "my.toml"), ("render", "my.toml", "-o", "x", "--threads", "0")])
def test_wrong_command_lines_are_code_2(seaglint, arguments):
    answer = seaglint(*arguments)
    assert (answer.code, answer.out) == (2, "")
    assert "Error:" in answer.err
    assert "Traceback" not in answer.err


def test_a_full_disk_is_code_3(seaglint, pipeline, scenario, tmp_path, monkeypatch):
    from seaglint.store.shards import Shards

    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Shards, "write", full)
    answer = seaglint("render", scenario, "-o", tmp_path / "run.zarr", "--progress", "none")
    assert answer.code == 3
    assert one_line(answer.err)
    assert "--resume" in answer.err


@pytest.mark.skipif(sys.platform == "win32", reason="file size limits are POSIX")
def test_a_real_refusal_to_write_is_code_3(scenario, tmp_path):
    # A file size limit makes the kernel itself refuse: the same path through Zarr as a full disk.
    # Python would keep half of what it compiles meanwhile, and fail at its next start.
    limit = (
        "import resource, signal, sys; sys.dont_write_bytecode = True; "
        "signal.signal(signal.SIGXFSZ, signal.SIG_IGN); resource.setrlimit(resource.RLIMIT_FSIZE, (2500, 2500)); "
    )
    code = limit + (
        "sys.path.insert(0, sys.argv.pop(1)); import types, conftest as fake, seaglint.base.kernel_plan as plan; "
        "plan.start_helpers = lambda work: 0; "
        "module = types.ModuleType('seaglint.studies.sequence.render_sequence'); module.render = fake.fake_render; "
        "sys.modules[module.__name__] = module; fake.main()"
    )
    scenario.write_text(scenario.read_text().replace("[32, 16]", "[128, 64]"))
    command = [sys.executable, "-c", code, os.path.dirname(__file__), "render", str(scenario), "-o", str(tmp_path / "run.zarr")]
    done = subprocess.run([*command, "--progress", "none"], capture_output=True, text=True, check=False)
    assert done.returncode == 3, done.stderr
    assert one_line(done.stderr)
    assert "no room left" in done.stderr
    assert not (tmp_path / "run.zarr").exists()


def test_ctrl_c_before_the_first_frame_is_code_130(seaglint, pipeline, scenario, tmp_path, monkeypatch):
    def interrupted(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr(sys.modules["seaglint.studies.sequence.render_sequence"], "render", interrupted)
    answer = seaglint("render", scenario, "-o", tmp_path / "run.zarr", "--progress", "none")
    assert answer.code == 130
    assert one_line(answer.err)


def test_a_defect_keeps_its_traceback(seaglint, pipeline, scenario, tmp_path, monkeypatch):
    def defect(*_, **__):
        raise ZeroDivisionError

    monkeypatch.setattr(sys.modules["seaglint.studies.sequence.render_sequence"], "render", defect)
    monkeypatch.setattr(sys, "argv", ["seaglint", "render", str(scenario), "-o", str(tmp_path / "run.zarr")])
    with pytest.raises(ZeroDivisionError):
        commands.main()


@pytest.mark.parametrize("arguments", [("schema",), ("doctor", "--json"), ("reproduce", "headline", "--json")])
def test_json_stands_alone_on_stdout(seaglint, pipeline, arguments):
    answer = seaglint(*arguments)
    assert answer.code == 0
    assert json.loads(answer.out)
    assert answer.err == ""


def test_headline_as_a_table(seaglint, pipeline):
    answer = seaglint("reproduce", "headline")
    assert "contrast_mwir" in answer.out
    assert "0.4217" in answer.out
    assert "3-5 um" in answer.out


def test_version_and_presets(seaglint):
    assert seaglint("--version").out == f"seaglint {package.__version__}\n"
    assert "glint" in seaglint("init", "--presets").out


@pytest.mark.parametrize(
    ("text", "frames"),
    [("37:38", range(37, 38)), ("37", range(37, 38)), ("90:", range(90, 100)), (":2", range(2)), (":", range(100)), (None, range(100))],
)
def test_frame_ranges(text, frames):
    assert parse_frames(text, 100) == frames


@pytest.mark.parametrize("text", ["", "a", "5:5", "5:4", "100", "99:101", "-1:3", "1:2:3", "1.5"])
def test_frame_ranges_that_are_none(text):
    with pytest.raises(ScenarioError, match="--frames"):
        parse_frames(text, 100)


def test_log_lines_are_rare_and_tell_rate_and_time_left():
    now, lines = [0.0], []
    report = log_lines("frames", lines.append, clock=lambda: now[0])
    for done in range(10, 101):
        report(done, 100)
        now[0] += 1.0
    # 91 calls a second apart, 10 frames there already: a line at the start, one per interval, one at the end.
    assert len(lines) <= 2 + 90 / LOG_INTERVAL
    assert lines[0] == "frames: 90 to do, 10 of 100 there already"
    assert "20/100, 1 per s, 80 s left" in lines[1]
    assert lines[-1].startswith("frames: 100/100 in 90 s")


@pytest.mark.parametrize(("first", "each"), [(37.0, 0.5), (0.5, 2.0), (20.0, 12.0)])
def test_time_left_leaves_out_the_first_piece(first, each):
    now, lines = [0.0], []
    pace = Pace(lambda: now[0])
    report = log_lines("cases", lines.append, lambda: now[0], pace)
    report(0, 60)
    now[0] += first  # compilation and preparation
    report(1, 60)
    assert pace.left is None
    assert not any("left" in line for line in lines)
    for done in range(2, 61):
        now[0] += each
        report(done, 60)
        assert pace.left == pytest.approx((60 - done) * each, abs=1e-9)  # pieces of one length: the estimate is right at once
    said = [float(line.split(", ")[-1].removesuffix(" s left")) for line in lines if line.endswith(" s left")]
    assert all(left <= 60 * each for left in said)
    assert lines[-1].startswith("cases: 60/60 in ")


@pytest.mark.parametrize("mode", [ProgressMode.BAR, ProgressMode.LOG, ProgressMode.AUTO, ProgressMode.NONE])
def test_progress_never_touches_stdout(mode, capsys):
    with progress(mode, "frames") as report:
        for done in range(4):
            report(done, 3)
    printed = capsys.readouterr()
    assert printed.out == ""
    assert bool(printed.err) == (mode is not ProgressMode.NONE)


def test_doctor_finds_nothing_wrong_here():
    report = examine()
    assert report.problems == []
    assert set(report.sections) == {"seaglint", "packages", "machine", "codecs", "tables", "live LOWTRAN7"}


def test_doctor_tells_where_compiled_kernels_are(monkeypatch, tmp_path):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    found = Path(examine().sections["machine"]["compiled kernels"])
    assert found.parent == tmp_path
    assert found.is_dir()


def test_doctor_tells_a_changed_and_a_missing_table(seaglint, tmp_path, monkeypatch):
    folder = tmp_path / "optics" / "data"
    folder.mkdir(parents=True)
    (folder / "a.csv").write_text("changed")
    (tmp_path / "checksums.sha256").write_text(f"{'0' * 64}  optics/data/a.csv\n{'0' * 64}  optics/data/b.csv\n")
    monkeypatch.setattr("seaglint.cli.doctor.files", lambda _: tmp_path)
    answer = seaglint("doctor")
    assert answer.code == 2
    assert "optics/data/a.csv is changed" in answer.err
    assert "optics/data/b.csv is missing" in answer.err


def test_every_shipped_table_has_its_checksum():
    from pathlib import Path

    root = Path(package.__file__).parent
    assert set(read_checksums(root / "checksums.sha256")) == set(data_files(root))


HOSTILE = "a\x1b[31mb\u202ec\u2066d\x07"


@pytest.mark.parametrize(
    "arguments",
    [
        ("render", f"{HOSTILE}.toml", "-o", "run.zarr"),
        ("render", "my.toml", "-o", f"{HOSTILE}.zip"),
        ("render", "my.toml", "-o", "run.zarr", "--frames", HOSTILE),
        ("render", "my.toml", "-o", "run.zarr", "--scale", HOSTILE),
        ("init", "x.toml", "--preset", HOSTILE),
        ("init", "x.toml", "--camera", HOSTILE),
        ("analyze", f"{HOSTILE}.npy"),
        ("info", f"{HOSTILE}.zarr"),
        (HOSTILE,),
        (f"--{HOSTILE}",),
        ("mean", f"--{HOSTILE}"),
    ],
)
def test_what_steers_a_terminal_is_never_repeated_raw(seaglint, scenario, tmp_path, monkeypatch, arguments):
    monkeypatch.chdir(tmp_path)
    answer = seaglint(*arguments)
    assert answer.code == 2
    assert not set(answer.out + answer.err) & set("\x1b\u202e\u2066\x07")
    assert "\\x1b" in answer.err


@pytest.mark.parametrize(
    "arguments", [("init", "x.toml", "--preset"), ("analyze", "my.toml", "--border"), ("render", "my.toml", "-o", "r.zarr", "--frames")]
)
@pytest.mark.parametrize("value", ["y" * 100_000, "y " * 50_000])
def test_what_fills_the_screen_is_cut(seaglint, scenario, tmp_path, monkeypatch, arguments, value):
    monkeypatch.chdir(tmp_path)
    answer = seaglint(*arguments, value)
    assert answer.code == 2
    assert len(answer.err) < 5000


def test_a_file_s_own_words_are_not_obeyed_either(seaglint, pipeline, scenario, tmp_path):
    run = tmp_path / "run.zarr"
    assert seaglint("render", scenario, "-o", run, "--progress", "none").code == 0
    attributes = run / "zarr.json"
    held = json.loads(attributes.read_text())
    held["attributes"]["title"] = HOSTILE
    attributes.write_text(json.dumps(held))
    answer = seaglint("info", run)
    assert answer.code == 0
    assert "\x1b" not in answer.out
    assert "\\x1b[31m" in answer.out
