"""``seaglint detect`` on recordings: reports, several settings, and textures as input."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pytest


@pytest.fixture
def clip(tmp_path: Path) -> Path:
    path = tmp_path / "clip.npy"
    np.save(path, np.random.default_rng(5).normal(100.0, 2.0, (6, 48, 48)).astype(np.float32))
    return path


COMMON = ("--contrast", "8", "--injections", "200", "--threshold", "3", "--progress", "none")


def test_a_report_of_a_recording(seaglint, clip: Path, tmp_path: Path) -> None:
    answer = seaglint("detect", clip, *COMMON, "--report", tmp_path / "r.html")
    assert answer.code == 0, answer.err
    report = (tmp_path / "r.html").read_text()
    # characteristic, map, misses and false alarms
    assert report.count("data:image/png") == 3
    assert "tiles and times" in report
    again = seaglint("detect", clip, *COMMON, "--report", tmp_path / "r.html")
    assert again.code == 2
    assert "--overwrite" in again.err


@pytest.mark.validation
def test_settings_of_the_detector_are_varied_on_a_recording(seaglint, clip: Path, tmp_path: Path) -> None:
    vary = ("--vary", "detector=threshold,matched", "--vary", "threshold=3,4")
    answer = seaglint("detect", clip, *COMMON, *vary, "-o", tmp_path / "found", "--report", tmp_path / "r.html")
    assert answer.code == 0, answer.err
    rows = list(csv.DictReader((tmp_path / "found.csv").open()))
    assert [(row["detector"], float(row["threshold"])) for row in rows] == [
        ("threshold", 3.0),
        ("threshold", 4.0),
        ("matched", 3.0),
        ("matched", 4.0),
    ]
    rates = [float(row["p_d"]) for row in rows]
    assert rates[0] > rates[1]
    assert rates[2] > rates[0]
    result = json.loads((tmp_path / "found.json").read_text())
    assert [case["parameters"]["detector"] for case in result["cases"]] == ["threshold"] * 2 + ["matched"] * 2
    assert "Against threshold" in (tmp_path / "r.html").read_text()
    # one alone gives the same numbers
    alone = json.loads(seaglint("detect", clip, *COMMON, "--detector", "matched", "--json").out)
    assert alone["p_d"] == result["cases"][2]["p_d"]


def test_what_fails_with_one_setting_is_not_lost_to_the_others(seaglint, clip: Path, tmp_path: Path) -> None:
    vary = ("--vary", "detector=temporal-profile,threshold")
    answer = seaglint("detect", clip, *COMMON, *vary, "-o", tmp_path / "found")
    assert answer.code == 2
    assert "needs 17 frames" in answer.err
    assert "1 of 2 cases failed" in answer.err
    rows = list(csv.DictReader((tmp_path / "found.csv").open()))
    assert [bool(row["error"]) for row in rows] == [True, False]
    refused = seaglint("detect", clip, *COMMON, "--vary", "wind.speed_m_s=2,5")
    assert refused.code == 2
    assert "of a recording detector, filter, threshold may be varied" in refused.err
    assert "--range: for scenarios" in seaglint("detect", clip, *COMMON, "--range").err


def test_samples_of_a_texture_are_read_as_recordings(seaglint, tmp_path: Path) -> None:
    white = np.random.default_rng(1).normal(20.0, 1.5, (8, 64, 64)).astype(np.float32)
    np.save(tmp_path / "sea.npy", white)
    assert seaglint("texture", "fit", tmp_path / "sea.npy", "-o", tmp_path / "model.json").code == 0
    assert (
        seaglint("texture", "sample", tmp_path / "model.json", "-o", tmp_path / "loop.zarr", "--size", "64x64", "--frames", "8").code == 0
    )
    answer = seaglint("detect", tmp_path / "loop.zarr", *COMMON, "--placement", "centre", "--match-radius", "0", "--json")
    assert answer.code == 0, answer.err
    found = json.loads(answer.out)
    assert found["frames"] == 8
    assert found["background_sigma"] == pytest.approx(1.5, rel=0.1)
    # 8 is 5.3 standard deviations: 2.3 above the threshold
    assert found["p_d"] == pytest.approx(0.99, abs=0.03)
