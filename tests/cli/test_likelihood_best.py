"""The command ``seaglint likelihood --best``: files of a day without light."""

from __future__ import annotations

from pathlib import Path


def test_a_day_without_light_has_files_with_headings_alone(tmp_path: Path, seaglint) -> None:
    (tmp_path / "n.toml").write_text("[likelihood]\nplace = [30, -60]\nhours_utc = [1, 4]\n")
    answer = seaglint("likelihood", tmp_path / "n.toml", "--best", "--date", "2026-07-10", "-o", tmp_path / "out")
    assert answer.code == 0
    assert "the Sun is not up at any full hour" in answer.out
    assert (tmp_path / "out" / "best_looks.csv").read_text().startswith("threshold_w_m2_sr,hour_utc,")
    assert len((tmp_path / "out" / "best_looks.csv").read_text().splitlines()) == 1
