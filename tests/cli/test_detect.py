"""``seaglint detect``: names, files, and what is refused in one line."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import norm


@pytest.fixture(scope="module")
def white(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("clip") / "white.npy"
    np.save(path, np.random.default_rng(5).normal(100.0, 2.0, (20, 64, 64)).astype(np.float32))
    return path


def test_the_plain_threshold_on_white_noise(seaglint, white: Path) -> None:
    options = (
        *("--detector", "threshold", "--filter", "none", "--object-sigma-px", "0.8", "--contrast", "8", "--threshold", "3"),
        *("--injections", "3000", "--placement", "centre", "--match-radius", "0", "--seed", "1", "--json", "--progress", "none"),
    )
    answer = seaglint("detect", white, *options)
    assert answer.code == 0
    found = json.loads(answer.out)
    # Contrast 8 is four standard deviations: one above the threshold. Four standard errors of 3000 objects.
    assert found["p_d"] == pytest.approx(norm.sf(-1.0), abs=0.03)
    assert found["p_d_interval"][0] < found["p_d"] < found["p_d_interval"][1]
    # 81920 pixels, 110 alarms: 40 %.
    assert found["p_fa"] == pytest.approx(norm.sf(3.0), rel=0.4)
    assert found["p_fa_interval"][0] < found["p_fa"] < found["p_fa_interval"][1]
    assert found["injections"] == 3000
    assert found["false_alarms"]["pixels"] == 20 * 64 * 64
    assert seaglint("detect", white, *options).out == answer.out


def test_sweep_writes_tables_and_pictures(seaglint, white: Path, tmp_path: Path) -> None:
    pixels = ("--frame-rate", "50", "--pixel-mrad", "0.5")
    options = ("--contrast", "4:12:4", "--injections", "300", "--detector", "matched", "--threshold", "3", *pixels)
    answer = seaglint("detect", white, *options, "-o", tmp_path / "found", "--progress", "none")
    assert answer.code == 0
    assert "contrast 12: P_d" in answer.out
    result = json.loads((tmp_path / "found.json").read_text())
    assert [entry["contrast"] for entry in result["sweep"]] == [4.0, 8.0, 12.0]
    rates = [entry["p_d"] for entry in result["sweep"]]
    assert rates == sorted(rates)
    events, degrees = result["false_alarms"], np.degrees(0.5e-3)
    assert events["pixels_per_deg2_s"] == pytest.approx(result["p_fa"] * 50.0 / degrees**2)
    assert events["events_per_hour"] == pytest.approx(events["events_per_frame"] * 180_000)
    rows = list(csv.DictReader((tmp_path / "found.csv").open()))
    assert [float(row["contrast"]) for row in rows] == [4.0, 8.0, 12.0]
    assert float(rows[2]["p_d"]) == rates[2]
    curve = np.genfromtxt(tmp_path / "found_roc.csv", delimiter=",", names=True)
    assert np.unique(curve["contrast"]).tolist() == [4.0, 8.0, 12.0]
    one = curve["contrast"] == 8.0
    assert (np.diff(curve["p_fa"][one]) <= 0).all()
    assert (np.diff(curve["p_d"][one]) <= 0).all()
    assert (curve["p_d_low"] <= curve["p_d"]).all()
    assert (tmp_path / "found_roc.png").read_bytes()[:4] == b"\x89PNG"
    again = seaglint("detect", white, *options, "-o", tmp_path / "found.json")
    assert again.code == 2
    assert "--overwrite" in again.err


def test_parquet_holds_the_same_rows(seaglint, white: Path, tmp_path: Path) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    options = ("--contrast", "6", "--injections", "200", "--threshold", "3", "--progress", "none")
    assert seaglint("detect", white, *options, "-o", tmp_path / "found.parquet").code == 0
    table = parquet.read_table(tmp_path / "found.parquet").to_pylist()
    assert table[0]["p_d"] == json.loads((tmp_path / "found.json").read_text())["p_d"]


def test_a_point_spread_from_a_file_is_the_object(seaglint, white: Path, tmp_path: Path) -> None:
    axis = np.arange(-3, 4)
    np.savetxt(tmp_path / "psf.csv", 5.0 * np.exp(-(axis[:, None] ** 2 + axis**2) / 2.0), delimiter=",")
    options = ("--contrast", "40", "--injections", "100", "--psf", tmp_path / "psf.csv", "--placement", "centre", "--match-radius", "0")
    found = json.loads(seaglint("detect", white, *options, "--json").out)
    assert found["p_d"] == 1.0
    assert found["object_sigma_px"] is None
    assert found["pointing_error"]["row"]["std_px"] < 0.1


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (("--contrast", "0"), "--contrast 0: an object must add something"),
        (("--contrast", "1,1e39"), "--contrast 1e+39 is beyond what frames hold"),
        (("--contrast", "bright"), "FIRST:LAST:STEP"),
        (("--contrast", "1:2:0"), "FIRST:LAST:STEP"),
        (("--contrast", "4", "--detector", "radar"), "'radar' is unknown; choose"),
        (("--contrast", "4", "--detector", "temporal-profile"), "needs 17 frames; the sequence has 2"),
        (("--contrast", "4", "--object-sigma-px", "30"), "outside 0.05-20"),
        (("--contrast", "4", "--object-sigma-px", "9"), "no place for an object"),
        (("--contrast", "4", "--velocity", "fast"), "X,Y"),
        (("--contrast", "4", "--threshold", "-2"), "above the mean"),
        (("--contrast", "4", "--level", "95"), "between 0 and 1"),
        (("--contrast", "4", "-o", "found.txt"), ".parquet"),
    ],
)
def test_what_cannot_be_is_one_line(seaglint, tmp_path: Path, options: tuple[str, ...], says: str) -> None:
    np.save(tmp_path / "clip.npy", np.random.default_rng(5).normal(100.0, 2.0, (2, 32, 32)).astype(np.float32))
    answer = seaglint("detect", tmp_path / "clip.npy", *options, "--progress", "none")
    assert answer.code == 2
    assert says in answer.err
    assert len(answer.err.strip().splitlines()) == 1
