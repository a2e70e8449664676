"""``seaglint compare`` and ``seaglint reproduce measured``: tables, files, and refusals of one line."""

from __future__ import annotations

import csv
import json

import pytest

from seaglint.studies.measured.measured_numbers import SPECTROSCOPIES

SPECTRUM = "# resolution_cm: 20\nwavelength_um,brightness_temperature_k\n8.5,262\n8.7,259\n8.9,257\n9.1,254\n"


@pytest.fixture
def files(tmp_path):
    """A spectrum and a scenario."""
    (tmp_path / "sky.csv").write_text(SPECTRUM)
    (tmp_path / "my.toml").write_text("[band]\nmin_um = 8\nmax_um = 12\n[sensor]\nheight_m = 20\n")
    return tmp_path / "sky.csv", tmp_path / "my.toml"


def test_prints_a_table_and_writes_picture_and_numbers(seaglint, files, tmp_path) -> None:
    command = ("compare", *files, "--zenith-deg", 30, "-o", tmp_path / "sky.png", "--csv", tmp_path / "both.csv")
    answer = seaglint(*command)
    assert answer.code == 0
    head, row = answer.out.splitlines()
    assert head.split()[:2] == ["band", "um"]
    assert row.split()[0] == "8.511-9.091"
    assert (tmp_path / "sky.png").read_bytes().startswith(b"\x89PNG")
    rows = list(csv.DictReader((tmp_path / "both.csv").open()))
    assert {"wavenumber_cm", "ours_radiance_w_m2_sr_cm", "measured_brightness_temperature_k"} <= rows[0].keys()
    again = seaglint(*command)
    assert again.code == 2
    assert "exists already" in again.err


@pytest.mark.parametrize(
    ("text", "options", "said"),
    [
        (SPECTRUM.replace("brightness_temperature_k", "radiance"), (), "'radiance' names no unit"),
        (SPECTRUM.replace("259", "-259"), (), "= -259 is outside"),
        (SPECTRUM.replace("259", "nan"), (), "= nan is outside"),
        (SPECTRUM.replace("\n8.", "\n28.").replace("9.1,", "29.1,"), (), "outside the 0.7-14.7 um"),
        (SPECTRUM, ("--resolution-cm", 60), "--resolution-cm 60 is more than half"),
        (SPECTRUM, ("--depression-deg", 0), "--depression-deg 0 does not meet the sea"),
        (SPECTRUM, ("--spectroscopy", "hitran"), "--spectroscopy 'hitran' is not one of"),
        (SPECTRUM, ("-o", "sky.nc"), "a picture is .png, .pdf or .svg"),
    ],
)
def test_errors_are_one_line_and_code_2(seaglint, files, text: str, options, said: str) -> None:
    files[0].write_text(text)
    answer = seaglint("compare", *files, *options)
    assert answer.code == 2
    assert answer.out == ""
    assert len(answer.err.splitlines()) == 1
    assert said in answer.err


def test_the_spectrum_is_not_overwritten(seaglint, files) -> None:
    answer = seaglint("compare", *files, "--csv", files[0], "--overwrite")
    assert answer.code == 2
    assert files[0].read_text() == SPECTRUM


def test_measured_writes_table_and_picture(seaglint, tmp_path) -> None:
    answer = seaglint("reproduce", "measured", "-o", tmp_path, "--spectroscopy", "lowtran7")
    assert answer.code == 0
    assert "AERI, zenith sky, Oklahoma 2001, lowtran7" in answer.out
    assert sorted(path.name for path in tmp_path.iterdir()) == ["measured.csv", "measured.png"]
    assert (tmp_path / "measured.csv").read_text().startswith("# aeri: AERI")
    again = seaglint("reproduce", "measured", "-o", tmp_path)
    assert again.code == 2
    assert "exists already" in again.err


def test_measured_as_json(seaglint, tmp_path) -> None:
    answer = seaglint("reproduce", "measured", "-o", tmp_path, "--json")
    rows = json.loads(answer.out)
    assert {row["spectroscopy"] for row in rows} == {"", *SPECTROSCOPIES}
    assert all(row["reason"] for row in rows)
