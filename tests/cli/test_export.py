"""``seaglint export-sea`` from file to file."""

import numpy as np
import pytest
import xarray as xr

TOML = "[sea]\nshortest_wave_m = 6.0\n[render]\ntile_size = 128\n"


@pytest.fixture
def small(tmp_path):
    path = tmp_path / "my.toml"
    path.write_text(TOML)
    return path


@pytest.mark.parametrize("kind", ["ply", "nc"])
def test_export_writes_once(seaglint, small, kind):
    output = small.with_name(f"sea.{kind}")
    command = ("export-sea", small, "--time", 3.2, "-o", output, "--extent", 30, 15)
    answer = seaglint(*command)
    assert (answer.code, answer.out) == (0, "")
    assert "21 x 11 points every 1.5 m" in answer.err
    assert sorted(path.name for path in small.parent.iterdir()) == ["my.toml", output.name]
    again = seaglint(*command)
    assert again.code == 2
    assert "exists already" in again.err
    assert seaglint(*command, "--overwrite").code == 0


def test_the_patch_can_be_elsewhere(seaglint, small):
    output = small.with_name("sea.nc")
    assert seaglint("export-sea", small, "-o", output, "--centre", 1000, -50, "--extent", 20, 20, "--spacing", 2, "--no-lattices").code == 0
    with xr.open_dataset(output) as found:
        assert np.array_equal(found.x, 990.0 + 2.0 * np.arange(11))
        assert np.array_equal(found.y, -60.0 + 2.0 * np.arange(11))
        assert "height_0" not in found


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("-o", "sea.stl"), "neither .ply nor .nc"),
        (("-o", "sea.ply", "--extent", "1e6", "1e6"), "GB of memory"),
        (("-o", "missing/sea.ply"), "does not exist"),
    ],
)
def test_what_cannot_be_is_refused_in_one_line(seaglint, small, monkeypatch, arguments, message):
    monkeypatch.chdir(small.parent)
    answer = seaglint("export-sea", small, *arguments)
    assert answer.code == 2
    assert message in answer.err
    assert answer.err.count("\n") == 1
