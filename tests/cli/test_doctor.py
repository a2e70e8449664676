"""``seaglint doctor --compile``: kernels of a scenario before they are needed."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

SMALL = """
[sensor]
fov_deg = [4, 6]
elevation_deg = -3
pixels = [16, 20]

[sea]
shortest_wave_m = 8.0

[render]
tile_size = 128
"""


@pytest.fixture
def small(tmp_path: Path) -> Path:
    path = tmp_path / "small.toml"
    path.write_text(SMALL)
    return path


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("small.toml",), "add --compile or leave small.toml out"),
        (("nix.toml", "--compile"), "nix.toml: no such file"),
        (("bad.toml", "--compile"), "sensor.height_m"),
    ],
)
def test_wrong_input_is_one_line(arguments, words, small, seaglint, tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "bad.toml").write_text("[sensor]\nheight_m = -1\n")
    answer = seaglint("doctor", *arguments)
    assert answer.code == 2
    assert answer.out == ""
    assert len(answer.err.splitlines()) == 1
    assert words in answer.err


def test_without_a_folder_nothing_is_compiled(small, seaglint, monkeypatch) -> None:
    monkeypatch.setattr("seaglint.cli.compile_kernels.kernel_folder", lambda requested: None)
    answer = seaglint("doctor", "--compile", small)
    assert answer.code == 2
    assert "set SEAGLINT_CACHE to one that can" in answer.err


def test_plain_python_is_not_compiled(small, seaglint, monkeypatch) -> None:
    import numba

    monkeypatch.setattr(numba.config, "DISABLE_JIT", 1)
    answer = seaglint("doctor", "--compile", small)
    assert answer.code == 2
    assert "unset it to compile them" in answer.err


@pytest.mark.skipif(os.environ.get("NUMBA_DISABLE_JIT") == "1", reason="nothing is compiled")
def test_what_is_compiled_is_not_compiled_again(small, seaglint) -> None:
    first = seaglint("doctor", "--compile", small, "--json", "--progress", "none")
    assert first.code == 0, first.err
    assert Path(json.loads(first.out)["folder"]).is_dir()
    again = seaglint("doctor", "--compile", small)
    assert again.code == 0
    assert again.out.startswith(f"all kernels of {small} are compiled, in ")


@pytest.mark.validation
def test_later_commands_compile_nothing(small, tmp_path) -> None:
    """From an empty folder: afterwards a mean map and a frame write no compiled code."""
    environment = {k: v for k, v in os.environ.items() if not k.startswith("NUMBA_")} | {"SEAGLINT_CACHE": str(tmp_path / "cache")}

    def seaglint(*words: str) -> str:
        command = [sys.executable, "-m", "seaglint.cli.app", *words]
        return subprocess.run(command, env=environment, cwd=tmp_path, capture_output=True, text=True, check=True).stdout

    assert "compiled in" in seaglint("doctor", "--compile", "small.toml")
    before = {path.name for path in (tmp_path / "cache").rglob("*.nb?")}
    assert len(before) > 100
    seaglint("mean", "small.toml", "-o", "m.nc", "--preview")
    seaglint("render", "small.toml", "-o", "r.zarr", "--frames", "0:2", "--preview")
    assert {path.name for path in (tmp_path / "cache").rglob("*.nb?")} == before
