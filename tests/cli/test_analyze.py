"""``seaglint analyze``: what the text says, and what is refused in one line."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from seaglint.analysis import Recording, analyze
from seaglint.cli.analyze import lines
from seaglint.clutter.fits import Family, Fit, Goodness


@pytest.fixture
def clip(tmp_path: Path) -> Path:
    np.save(tmp_path / "clip.npy", np.random.default_rng(1).normal(100.0, 5.0, (9, 24, 32)).astype(np.float32))
    return tmp_path / "clip.npy"


@pytest.fixture
def raw(tmp_path: Path) -> Path:
    np.random.default_rng(1).integers(100, 140, (9, 24, 32)).astype("<u2").tofile(tmp_path / "clip.raw")
    return tmp_path / "clip.raw"


def test_text_gives_reasons_and_repeats_nothing(seaglint, clip):
    answer = seaglint("analyze", clip)
    assert answer.code == 0
    assert "9 frames of 32 x 24" in answer.out
    assert "background: the same as all" in answer.out
    assert "(- to -)" not in answer.out


def test_a_layout_on_the_command_line_takes_a_broken_frame_rate(seaglint, raw):
    answer = seaglint("analyze", raw, "--raw", "rows=24,columns=32,frame_rate=29.97,units=counts")
    assert answer.code == 0
    assert "29.97 Hz" in answer.out


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("--raw", "rows=24,columns=32,frame_rate=fast"), "frame_rate = 'fast'"),
        (("--raw", "rows=24,columns=32", "--report", "out.txt"), "ends in .html"),
        (("--raw", "rows=24,columns=32", "--border", "left"), "auto, keep, drop"),
        (("--raw", "rows=24,columns=32", "--axes", "xyz"), "yxt (time last)"),
        (("--raw", "rows=24,columns=32", "--axes", "yxt"), "for arrays"),
    ],
)
def test_what_cannot_be_is_refused_in_one_line(seaglint, raw, arguments, says):
    answer = seaglint("analyze", raw, *arguments)
    assert answer.code == 2
    assert says in answer.err
    assert answer.err.count("\n") == 1


def fit(family: Family, ks: float, level: float | None) -> Fit:
    count = 4.0 if level is None else 400.0
    tested = Goodness(ks, np.nan if level is None else level, np.nan, np.nan, count, 199)
    return Fit(family, 2.0, 0.0, 1.0, None, None, None, None, 400, count, goodness=tested)


@pytest.mark.parametrize(
    ("levels", "says"),
    [((0.3, 0.005), "best fit gamma"), ((0.005, 0.005), "none of the families fits; nearest: gamma"), ((None, None), "too few")],
)
def test_a_fit_at_the_floor_is_not_called_the_best(levels, says):
    whole = analyze(Recording("a", 1, 24, 32, lambda start, stop: np.random.default_rng(1).normal(size=(1, 24, 32)).astype(np.float32)))
    region = replace(whole.regions["all"], fits={"gamma": fit("gamma", 0.01, levels[0]), "weibull": fit("weibull", 0.2, levels[1])})
    assert says in "\n".join(lines(replace(whole, regions={"all": region})))


def test_text_tells_saturation_of_the_region_and_no_fit_of_few_values(seaglint, tmp_path):
    """Smooth waves of some 16 independent values, a quarter of them cut."""
    from scipy.ndimage import gaussian_filter

    waves = gaussian_filter(np.random.default_rng(2).normal(size=(96, 96)), 8.0, mode="wrap")
    np.save(tmp_path / "waves.npy", np.minimum(waves, np.quantile(waves, 0.75)))
    answer = seaglint("analyze", tmp_path / "waves.npy")
    assert "all: 9216 pixels" in answer.out
    line = next(line for line in answer.out.splitlines() if line.startswith("all:"))
    assert line.endswith(", 25 % saturated")
    assert "independent values, too few (below 50) to say which family fits" in answer.out
    assert "best fit" not in answer.out


@pytest.mark.validation
def test_warnings_of_numbers_that_do_not_exist_are_not_shown(tmp_path, monkeypatch):
    """In a process of its own: Python prints warnings past the command's own error output."""
    import subprocess
    import sys

    (tmp_path / "loud.py").write_text("import numpy as np\n\n\ndef detector(frames):\n    return np.log(frames - 100) / np.zeros(1)\n")
    frames = np.random.default_rng(1).normal(100.0, 5.0, (9, 24, 32)).astype(np.float32)
    np.save(tmp_path / "clip.npy", frames)
    command = [sys.executable, "-W", "default", "-m", "seaglint.cli.app", "analyze", "clip.npy", "--detector", "loud:detector"]
    told = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True)
    assert "Warning" not in told.stderr
    assert "loud:detector" in told.stdout


@pytest.fixture
def regions(tmp_path: Path) -> Path:
    (tmp_path / "regions.json").write_text('{"near": "12:24,:", "far": "0:12,:20"}')
    return tmp_path / "regions.json"


def test_results_are_given_for_every_region_by_its_name(seaglint, clip, regions, tmp_path):
    import json

    answer = seaglint("analyze", clip, "--regions", regions, "--report", tmp_path / "r.html")
    assert answer.code == 0
    assert [line.split(":")[0] for line in answer.out.splitlines() if " pixels, mean " in line] == ["all", "near", "far"]
    assert not [line for line in answer.out.splitlines() if line.startswith(("glint", "background"))]
    page = (tmp_path / "r.html").read_text("utf-8")
    assert "<h3>near</h3>" in page
    assert list(json.loads(seaglint("analyze", clip, "--regions", regions, "--json").out)["regions"]) == ["all", "near", "far"]


def test_without_glint_all_pixels_are_the_only_region(seaglint, clip):
    answer = seaglint("analyze", clip, "--no-glint")
    assert answer.code == 0
    lines = answer.out.splitlines()[1:]
    assert not [line for line in lines if "glint" in line or "background" in line]


def test_an_uncertain_corridor_prints_no_numbers_of_glint(seaglint, data_dir):
    answer = seaglint("analyze", data_dir / "imagery" / "Misc_2.png", "--channel", "mean")
    assert answer.code == 0
    assert "glint: no region of its own" in answer.out
    assert "no glint corridor found: " in answer.out


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("--no-glint", "--regions", "regions.json"), "--no-glint and --regions exclude each other"),
        (("--mask", "mask.npy", "--regions", "regions.json"), "--mask and --regions exclude each other"),
        (("--mask", "mask.npy", "--no-glint"), "--mask and --no-glint exclude each other"),
        (("--regions", "small.npy"), "2 x 2, the frames have 24 x 32"),
        (("--regions", "none.json"), "none.json"),
        (("--regions", "regions.json", "--report", "regions.html", "--rows", "2:1"), "rows"),
    ],
)
def test_regions_that_cannot_be_are_refused_in_one_line(seaglint, clip, regions, tmp_path, monkeypatch, arguments, says):
    monkeypatch.chdir(tmp_path)
    np.save("mask.npy", np.eye(24, 32))
    np.save("small.npy", np.ones((2, 2), int))
    answer = seaglint("analyze", clip, *arguments)
    assert answer.code == 2
    assert says in answer.err
    assert answer.err.count("\n") == 1
