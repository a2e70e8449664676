"""The class of the article's Fig. 12: its scene, its geometry and what the command writes."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest

from seaglint.scenario.load import load_scenario
from seaglint.studies.article import figures_5_and_12

ROOT = Path(__file__).parents[2]


def test_the_example_is_the_scene():
    example = load_scenario(ROOT / "examples" / "approach.toml")
    assert example.model_dump(exclude={"render"}) == figures_5_and_12.scene().model_dump(exclude={"render"})
    assert example.render == figures_5_and_12.scene().render


def test_the_scene_is_of_the_articles_size():
    found = figures_5_and_12.scene()
    assert (found.sensor.frames, found.sensor.pixels) == (100, (512, 512))
    assert 2.0 * 14.0 * np.tan(np.radians(0.5 * found.sensor.fov_deg[0])) == pytest.approx(3.5, abs=0.1)


def test_both_bodies_close_before_a_sensor_that_moves():
    ways = figures_5_and_12.trajectories(figures_5_and_12.scene(), range(figures_5_and_12.FRAMES))
    assert np.diff(ways.ahead["sensor"]) == pytest.approx(figures_5_and_12.SPEED / figures_5_and_12.FRAME_RATE)
    gap = ways.ahead["attacking body"] - ways.ahead["defending body"]
    assert (np.diff(gap) < 0.0).all()
    assert gap[-1] < 0.05 * gap[0]
    assert (ways.ahead["defending body"] > ways.ahead["sensor"] + 200.0).all()
    assert ways.height["attacking body"].max() < 15.0
    assert ways.sight == pytest.approx(np.radians([-6.6, 0.4]))


@pytest.mark.validation
def test_the_command_writes_pictures_labels_and_sequence(seaglint, tmp_path):
    answer = seaglint("reproduce", "fig12", "-o", tmp_path, "--frames", "70:72", "--pixels", "32")
    assert answer.code == 0
    assert "frames: 2/2" in answer.err
    names = {path.name for path in tmp_path.iterdir()}
    assert {"fig12.zarr", "fig12.png", "fig12.csv"} <= names
    assert (tmp_path / "fig12.png").read_bytes().startswith(b"\x89PNG")
    rows = list(csv.DictReader((tmp_path / "fig12.csv").open()))
    assert [(row["frame"], row["object"]) for row in rows] == [
        (f, f"{name} body") for f in ("70", "71") for name in ("attacking", "defending")
    ]
    assert float(rows[0]["visible_share"]) > 0.9
    again = seaglint("reproduce", "fig12", "-o", tmp_path, "--frames", "70:72")
    assert again.code == 2
    assert "exists already" in again.err or "--overwrite" in again.err
