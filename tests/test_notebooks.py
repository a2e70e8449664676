"""Notebooks of examples run from their first cell, and their stored outputs are complete and clean."""

from __future__ import annotations

import importlib.util
import re
from pathlib import Path

import pytest

from make_gallery import IMAGES, MOST_BYTES

if missing := [name for name in ("nbclient", "nbformat", "ipykernel") if importlib.util.find_spec(name) is None]:
    pytest.skip(f"notebooks need {', '.join(missing)}: pip install '.[dev]'", allow_module_level=True)

from run_notebooks import executed, names, picture, read, stderr

ROOT = Path(__file__).resolve().parents[1]
QUICK = "apparent_temperature_and_glint"
GALLERY = (ROOT / "docs" / "gallery" / "index.md").read_text(encoding="utf-8")
MACHINE = re.compile(r"/(?:home|root|tmp|work|Users)/|[A-Z]:\\\\|ipykernel")
"""Paths and files that only one machine has."""


def outputs(book):
    return [output for cell in book.cells for output in cell.get("outputs", [])]


def test_there_are_three() -> None:
    assert len(names()) == 3


@pytest.mark.parametrize("name", names())
def test_outputs_are_stored_and_name_no_machine(name: str) -> None:
    book = read(name)
    code = [cell for cell in book.cells if cell.cell_type == "code"]
    assert [cell.execution_count for cell in code] == list(range(1, len(code) + 1)), f"run python tools/run_notebooks.py --write {name}"
    assert not stderr(book)
    assert all(output.output_type != "error" for output in outputs(book))
    texts = [str(output.get("text", "")) for output in outputs(book)]
    texts += [str(value) for output in outputs(book) for kind, value in output.get("data", {}).items() if kind.startswith("text/")]
    assert not [text for text in texts if MACHINE.search(text)]


@pytest.mark.parametrize("name", names())
def test_its_picture_is_small_and_shown(name: str) -> None:
    kept = [path for path in IMAGES.glob(f"{name}.*") if path.suffix in (".png", ".jpg")]
    assert len(kept) == 1, f"run python tools/run_notebooks.py --write {name}"
    assert kept[0].stat().st_size < MOST_BYTES
    assert min(picture(read(name)).size) > 200
    assert f"images/gallery/small/{name}.jpg" in GALLERY
    assert f"../../examples/{name}.ipynb" in GALLERY


def runs(name: str) -> None:
    """Run; nothing fails, and each picture that is stored is drawn again."""
    again = executed(name, timeout=240.0)
    assert [sorted(output.get("data", {})) for output in outputs(again) if "data" in output] == [
        sorted(output.get("data", {})) for output in outputs(read(name)) if "data" in output
    ]


def test_it_runs() -> None:
    runs(QUICK)


@pytest.mark.validation
@pytest.mark.parametrize("name", [name for name in names() if name != QUICK])
def test_all_run(name: str) -> None:
    runs(name)
