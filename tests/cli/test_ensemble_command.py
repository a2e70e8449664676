"""The command ``seaglint ensemble``."""

from pathlib import Path

import pytest

from seaglint.scenario.load import load_scenario

TEXT = """
[ensemble]
scenes = 2
[base.sensor]
pixels = [8, 4]
[base.sea]
resolve_waves = false
[base.atmosphere]
source = "none"
[[vary]]
key = "wind.speed_m_s"
law = "uniform"
min = 3
max = 9
"""


@pytest.mark.validation
def test_scenes_are_drawn_and_rendered_later(seaglint, tmp_path: Path) -> None:
    (tmp_path / "e.toml").write_text(TEXT)
    answer = seaglint("ensemble", tmp_path / "e.toml", "-o", tmp_path / "out", "--draw-only")
    assert (answer.code, answer.out) == (0, "")
    assert "2 scenes drawn" in answer.err
    assert 3 <= load_scenario(tmp_path / "out" / "scenes" / "0001.toml").wind.speed_m_s <= 9
    assert not (tmp_path / "out" / "scenes" / "0001.zarr").exists()
    answer = seaglint("ensemble", tmp_path / "e.toml", "-o", tmp_path / "out", "--resume", "--progress", "log")
    assert answer.code == 0
    assert "scenes: 2/2" in answer.err
    assert (tmp_path / "out" / "scenes" / "0001.zarr" / "zarr.json").is_file()


def test_many_scenes_tell_their_cost_before_they_start(seaglint, tmp_path: Path) -> None:
    """All frames at the cost of one, and pixels of four bytes; few scenes, a quiet run and a folder that is taken tell nothing."""
    (tmp_path / "e.toml").write_text(TEXT.replace("scenes = 2", "scenes = 16\nframes = 3"))
    answer = seaglint("ensemble", tmp_path / "e.toml", "-o", tmp_path / "out", "--progress", "log")
    assert answer.code == 0
    cost, work = (next(k for k, line in enumerate(answer.err.splitlines()) if part in line) for part in ("16 scenes of", "16 to do"))
    assert cost < work
    assert "3 x 8 x 4 pixels: about " in answer.err
    # 16 scenes of 3 frames of 32 pixels of 4 bytes are 6144 bytes
    assert "at most 0.00614 MB" in answer.err
    assert "pixels: about" not in seaglint("ensemble", tmp_path / "e.toml", "-o", tmp_path / "out").err


@pytest.mark.parametrize(
    ("text", "options", "line"),
    [
        (TEXT.replace("min = 3", "min = 60").replace("max = 9", "max = 90"), (), "e.toml, scene 0: wind.speed_m_s = "),
        (TEXT.replace("wind.speed_m_s", "wind.spede_m_s"), (), "scene 0: wind.spede_m_s is an unknown key; did you mean wind.speed_m_s?"),
        (TEXT.replace("scenes = 2", "scenes = 0"), (), "ensemble.scenes = 0 is outside the allowed range"),
        (
            "seed = 4\n[sensor]\npixels = [8, 4]\n",
            (),
            "e.toml: is a scenario and no ensemble; write a file of two lines beside it, base = 'e.toml'",
        ),
        (TEXT + "[sun]\nzenith_deg = 30\n", (), "e.toml: sun is a key of scenarios; put it into the base, [base.sun]"),
        (TEXT.replace("max = 9", "max = 9\nmaxx = 9"), (), "vary[0].maxx is an unknown key; did you mean max?"),
        (TEXT.replace("[[vary]]", "[vary]"), (), "vary must be a list of tables; write [[vary]]"),
        (TEXT.replace("max = 9", "max = inf"), (), "vary[0] (wind.speed_m_s): max = inf is not finite"),
        (TEXT.replace("min = 3", "min = nan"), (), "vary[0] (wind.speed_m_s): min = nan is no number"),
        ("[ensemble", (), "e.toml: is not valid TOML"),
        (TEXT, ("--resume", "--overwrite"), "resume keeps what is there and overwrite replaces it"),
        (TEXT, ("--workers", "2", "--dask", "tcp://nowhere:1"), "--workers and --dask: work is shared out in one way"),
    ],
)
def test_mistakes_are_one_line_and_leave_nothing(seaglint, tmp_path: Path, text: str, options: tuple[str, ...], line: str) -> None:
    (tmp_path / "e.toml").write_text(text)
    answer = seaglint("ensemble", tmp_path / "e.toml", "-o", tmp_path / "out", "--progress", "none", *options)
    assert answer.code == 2
    assert line in answer.err
    assert answer.err.count("\n") == 1
    assert sorted(path.name for path in tmp_path.iterdir()) == ["e.toml"]


@pytest.mark.validation
def test_two_processes_make_the_same_bytes(seaglint, tmp_path: Path) -> None:
    (tmp_path / "e.toml").write_text(TEXT)
    for name, options in (("one", ()), ("two", ("--workers", "2"))):
        assert seaglint("ensemble", tmp_path / "e.toml", "-o", tmp_path / name, *options).code == 0
    for path in (tmp_path / "one" / "scenes").rglob("*"):
        if path.is_file() and path.name != "zarr.json":
            assert path.read_bytes() == (tmp_path / "two" / path.relative_to(tmp_path / "one")).read_bytes()


def test_the_example_draws(seaglint, tmp_path: Path) -> None:
    example = Path(__file__).parents[2] / "examples" / "wind-and-sun.toml"
    assert seaglint("ensemble", example, "-o", tmp_path / "out", "--draw-only").code == 0
    assert len(list((tmp_path / "out" / "scenes").glob("*.toml"))) == 16
