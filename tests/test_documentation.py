"""What the pages name exists, and the Python on them runs."""

from __future__ import annotations

import importlib
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
FOLDERS = (ROOT / "docs", ROOT / "docs" / "guide", ROOT / "docs" / "adr")
PAGES = [ROOT / "README.md", *sorted(page for folder in FOLDERS for page in folder.glob("*.md"))]
NAME = re.compile(r"\bseaglint(?:\.[A-Za-z_][A-Za-z_0-9]*)+")
FILE = re.compile(r"(?<![\w/.])(?:tests|tools|examples|docs|src)/[\w./-]+\.(?:py|toml|md|csv|png)\b")

SMALL = """
[sensor]
fov_deg = [4, 6]
elevation_deg = -3
pixels = [32, 40]
frames = 3

[sea]
shortest_wave_m = 4.0

[render]
tile_size = 128
layers = ["range"]
"""


def exists(name: str) -> bool:
    """Whether a dotted name is a module or something in one."""
    parts = name.split(".")
    for end in range(len(parts), 0, -1):
        try:
            found = importlib.import_module(".".join(parts[:end]))
        except ModuleNotFoundError:
            continue
        for part in parts[end:]:
            if not hasattr(found, part) and part not in getattr(found, "__annotations__", {}):
                return False
            found = getattr(found, part, None)
        return True
    return False


@pytest.mark.parametrize("page", PAGES, ids=lambda p: str(p.relative_to(ROOT)))
def test_names_and_files_exist(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    assert [name for name in sorted(set(NAME.findall(text))) if not exists(name)] == []
    assert [name for name in sorted(set(FILE.findall(text))) if not (ROOT / name).exists()] == []


def test_a_name_that_is_gone_is_found() -> None:
    assert not exists("seaglint.render.renderer.Renderer")
    assert not exists("seaglint.render.sweep.Frame")
    assert exists("seaglint.render.sweep.Rows")
    assert exists("seaglint.render.swept.SweptScene.intervals")


@pytest.mark.parametrize("page", ["README.md", "docs/guide/python.md"])
def test_python_on_the_page_runs(page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "my.toml").write_text(SMALL)
    blocks = re.findall(r"```python\n(.*?)```", (ROOT / page).read_text(encoding="utf-8"), re.DOTALL)
    assert blocks
    names: dict[str, object] = {}
    for block in blocks:
        exec(compile(block, page, "exec"), names)
