"""``seaglint detect``: a command for each kind of request, and the spelling without a command, which chooses by the file."""

from __future__ import annotations

import inspect
import json
from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest

import seaglint as sg
from seaglint.studies.detect.detection_requests import DesignRequest, RangeRequest, RecordingRequest, SceneRequest

REQUESTS = {"recording": RecordingRequest, "scene": SceneRequest, "design": DesignRequest, "range": RangeRequest}
OF_ONE = {
    "recording": ("--raw", "--pixel-mrad"),
    "scene": ("--intensity", "--time-budget"),
    "design": ("--alarms-per-hour", "--precision-fa"),
    "range": ("--bearings", "--range-limits"),
}


@pytest.fixture
def clip(tmp_path: Path) -> Path:
    path = tmp_path / "clip.npy"
    np.save(path, np.random.default_rng(5).normal(100.0, 2.0, (6, 48, 48)).astype(np.float32))
    return path


@pytest.mark.parametrize(
    "options",
    [
        ("--contrast", "8", "--json"),
        ("--contrast", "4:12:4", "--detector", "matched", "--velocity", "0.5,0", "--placement", "centre"),
        ("--contrast", "8", "--vary", "threshold=3,4", "--frame-rate", "25", "--json"),
    ],
)
def test_a_recording_gives_the_same_with_and_without_the_command(seaglint, clip: Path, options: tuple[str, ...]) -> None:
    common = (*options, "--injections", "100", "--threshold", "3", "--progress", "none")
    named, bare = seaglint("detect", "recording", clip, *common), seaglint("detect", clip, *common)
    assert named.code == bare.code == 0, named.err
    assert named.out == bare.out != ""
    # options may stand before the file
    assert seaglint("detect", *common, clip).out == bare.out


def test_the_files_of_both_spellings_are_the_same(seaglint, clip: Path, tmp_path: Path) -> None:
    common = ("--contrast", "8", "--injections", "100", "--threshold", "3", "--progress", "none")
    assert seaglint("detect", "recording", clip, *common, "-o", tmp_path / "named").code == 0
    assert seaglint("detect", clip, *common, "-o", tmp_path / "bare").code == 0
    for ending in (".json", ".csv", "_roc.csv", "_roc.png"):
        assert (tmp_path / f"named{ending}").read_bytes() == (tmp_path / f"bare{ending}").read_bytes()


def test_python_gives_what_the_command_prints(seaglint, clip: Path) -> None:
    answer = seaglint("detect", "recording", clip, "--contrast", "4,8", "--threshold", "3", "--velocity", "0.5,0", "--json")
    found = sg.detect(clip, [4.0, 8.0], threshold=3.0, velocity=(0.5, 0.0))
    assert json.loads(answer.out) == json.loads(json.dumps(found))


def test_a_recording_is_judged_by_its_own_clutter(seaglint, tmp_path: Path) -> None:
    """White noise over a slope: contrasts of its deviation, a threshold that leaves one pixel in 10,000, and an answer from 0 to 1."""
    import seaglint as sg

    frames = (np.random.default_rng(3).normal(0.0, 2.0, (8, 160, 160)) + 300.0).astype(np.float32)
    np.save(tmp_path / "clip.npy", frames)
    answer = seaglint("detect", "recording", tmp_path / "clip.npy", "--json", "--progress", "none")
    assert answer.code == 0, answer.err
    found = json.loads(answer.out)
    assert found["detector"] == "matched-local"
    assert [case["contrast"] for case in found["cases"]] == pytest.approx([1.0, 2.0, 4.0, 8.0, 16.0, 32.0], rel=0.01)
    p_d = [case["p_d"] for case in found["cases"]]
    assert p_d == sorted(p_d)
    assert p_d[0] < 0.02
    assert p_d[-1] == 1.0
    assert 3e-5 < found["p_fa"] < 3e-4
    assert found["threshold_sigma"] == pytest.approx(3.72, abs=0.25)  # of a Gaussian
    assert json.loads(json.dumps(sg.detect(tmp_path / "clip.npy")))["cases"] == found["cases"]
    told = seaglint("detect", "recording", tmp_path / "clip.npy", "--progress", "none").out
    assert "16 standard deviations of the clutter" in told
    assert "unreliable" not in told
    assert "unreliable" in seaglint("detect", "recording", tmp_path / "clip.npy", "--tails", "--progress", "none").out


def test_velocity_is_to_the_right_and_down_on_the_command_line() -> None:
    from seaglint.cli.terminal.record_options import READERS

    assert READERS["pair"]("0.5,2", "--velocity") == (0.5, 2.0)
    assert RecordingRequest("clip.npy", velocity=(0.5, 2.0)).detection((1.0,)).objects.velocity == (2.0, 0.5)


def test_a_file_that_is_called_like_a_command_is_reached_by_its_folder(seaglint, tmp_path: Path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("range").write_text("[sensor]\n")
    answer = seaglint("detect", "./range", "--contrast", "4")
    assert answer.code == 2
    assert "range" in answer.err
    assert "Missing argument" in seaglint("detect", "range").err


@pytest.mark.parametrize("name", REQUESTS)
def test_the_help_of_a_command_has_its_own_options_alone(name: str, seaglint) -> None:
    told = seaglint("detect", name, "--help").out
    for other, options in OF_ONE.items():
        for option in options:
            has = option[2:].replace("-", "_") in {field.name for field in fields(REQUESTS[name])}
            assert (f"{option} " in told) == has, option
            assert has or other != name
    headings = [line for line in told.splitlines() if line.endswith(":") and not line.startswith(" ")]
    assert headings[:2] == ["Arguments:", "Object:"]
    assert "Results:" in headings


@pytest.mark.parametrize("name", REQUESTS)
def test_options_are_the_parameters_of_python(name: str, seaglint) -> None:
    told = seaglint("detect", name, "--help").out
    for parameter in list(inspect.signature(REQUESTS[name]).parameters)[1:]:
        assert f"  --{parameter.replace('_', '-')} " in told


def test_the_help_of_the_group_tells_the_four_and_the_spelling_without_them(seaglint) -> None:
    told = seaglint("detect", "--help").out
    assert [line.split()[0] for line in told.partition("Commands:\n")[2].partition("\n\n")[0].splitlines()] == list(REQUESTS)
    assert "seaglint detect SOURCE" in told
    # the options of all four are told behind a file
    assert all(option in seaglint("detect", "clip.npy", "--help").out for options in OF_ONE.values() for option in options)


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("recording", "clip.npy", "--contrast", "4", "--bearings", "0"), "--bearings"),
        (("recording", "clip.npy", "--contrast", "4", "--vary", "wind.speed_m_s=2"), "--vary wind.speed_m_s: of a recording"),
        (("recording", "clip.npy", "--contrast", "4", "--psf", "psf.csv", "--object-sigma-px", "1"), "--psf and --object-sigma-px are two"),
        (("recording", "clip.npy", "--contrast", "4", "--filter", "matched"), "--filter matched needs"),
        (("scene", "boat.toml", "--contrast", "4", "--intensity", "3"), "--temperature-difference and"),
        (("scene", "boat.toml", "--intensity", "3"), "give --range-m, above 0"),
        (("scene", "boat.toml", "--intensity", "3", "--objects", "boat"), "--objects boat; give --objects point"),
        (("range", "boat.toml"), "the scenario has no object to look for"),
        (("range", "boat.toml", "--range-limits", "far"), "--range-limits far: give NEAR:FAR"),
        (("range", "boat.toml", "--level", "3"), "--level 3 of the intervals"),
    ],
)
def test_errors_speak_of_options(seaglint, clip: Path, arguments: tuple[str, ...], says: str, monkeypatch) -> None:
    monkeypatch.chdir(clip.parent)
    np.savetxt("psf.csv", np.ones((3, 3)), delimiter=",")
    Path("boat.toml").write_text("[sensor]\npixels = [8, 4]\n")
    answer = seaglint("detect", *arguments, "--progress", "none")
    assert answer.code == 2
    assert says in answer.err


@pytest.mark.parametrize("words", [("recordng", "clip.npy"), ("scenes",), ("desing", "my.toml", "--p-d", "0.9")])
def test_a_misspelt_command_is_answered_in_one_line_with_those_there_are(seaglint, words: tuple[str, ...]) -> None:
    answer = seaglint("detect", *words)
    assert answer.code == 2
    (line,) = answer.err.strip().splitlines()
    assert line.startswith(f"seaglint: {words[0]}: ")
    assert "recording, scene, design, range" in line


def test_a_folder_or_file_without_an_ending_is_a_recording(seaglint, clip: Path, tmp_path: Path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "frames").mkdir()
    answer = seaglint("detect", "frames", "--contrast", "8")
    assert answer.code == 2
    assert "none of the commands" not in answer.err


def test_a_refused_range_leaves_the_unfinished_study(seaglint, tmp_path: Path) -> None:
    """Frames of hours lie beside the result: a mistyped number must not cost them, whatever --overwrite allows."""
    scenario, parts = tmp_path / "my.toml", tmp_path / "r.parts"
    scenario.write_text('[[objects]]\npreset = "small-boat"\neast_m = 0\nnorth_m = 2000\n')
    parts.mkdir()
    (parts / "seaglint-detection-parts").touch()
    (parts / "case-x.json").write_text("[1]")
    answer = seaglint("detect", "range", scenario, "-o", tmp_path / "r", "--overwrite", "--range-limits", "900:500")
    assert (answer.code, "900" in answer.err) == (2, True), answer.err
    assert (parts / "case-x.json").read_text() == "[1]"


SCENE = """
seed = 3
[sensor]
pixels = [48, 24]
fov_deg = [4, 2]
elevation_deg = -4
[sea]
resolve_waves = false
[[objects]]
name = "boat"
preset = "small-boat"
north_m = -400
"""


def test_a_range_over_workers_is_the_same_in_both_spellings(seaglint, tmp_path: Path) -> None:
    file = tmp_path / "boat.toml"
    file.write_text(SCENE)
    common = ("--frames", 8, "--precision", 0.5, "--range-limits", "5000:40000", "--p-fa", 0.01, "--detector", "top-hat")
    common = (*common, "--bearings", "0,5", "--json", "--progress", "none")
    alone, named, bare = (
        seaglint(*words, *common)
        for words in (("detect", "range", file), ("detect", "range", file, "--workers", 2), ("detect", file, "--range", "--workers", 2))
    )
    assert alone.code == named.code == bare.code == 0, named.err
    assert len(json.loads(alone.out)["ranges"]) == 2
    assert alone.out == named.out == bare.out


@pytest.mark.parametrize("detector", ["fob", "nofile.py:look"])
def test_an_unknown_detector_of_a_range_is_refused_before_any_work(seaglint, tmp_path: Path, detector: str) -> None:
    (tmp_path / "boat.toml").write_text(SCENE)
    answer = seaglint("detect", "range", tmp_path / "boat.toml", "--detector", detector, "-o", tmp_path / "found", "--progress", "none")
    assert (answer.code, answer.out) == (2, "")
    assert "first estimate" not in answer.err
    assert [path.name for path in tmp_path.iterdir()] == ["boat.toml"]


@pytest.mark.parametrize(
    "command", [("detect", "recording", "--contrast", "8", "--threshold", "3"), ("analyze",)], ids=["detect", "analyze"]
)
def test_a_detector_of_a_file_that_never_returns_ends_the_command(seaglint, command: tuple[str, ...], clip: Path, tmp_path: Path) -> None:
    file = tmp_path / "mine.py"
    file.write_text("def never(frames):\n    while True:\n        pass\n")
    words = (*command, clip, "--detector", f"{file}:never", "--time-limit", 0.5, "--progress", "none")
    answer = seaglint(*words, *(("-o", tmp_path / "found") if command[0] == "detect" else ()))
    assert answer.code == 2
    assert answer.out == ""
    assert f"detector {file}:never took longer than 0.5 s" in answer.err
    assert "Traceback" not in answer.err
    assert sorted(path.name for path in tmp_path.iterdir() if path.name != "__pycache__") == ["clip.npy", "mine.py"]
