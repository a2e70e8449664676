"""Scripts of the gallery run at reduced size, and their committed pictures are small and shown."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest
from matplotlib.figure import Figure
from PIL import Image

from make_gallery import IMAGES, MOST_BYTES, MOST_SMALL_BYTES, SCRIPTS, SMALL, draw, encoded, keep, names, thumbnail

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"
QUICK = ("air_spectra", "wave_spectrum", "wind_rose")
PAGES = {path.name: path.read_text(encoding="utf-8") for path in SCRIPTS.glob("*.md")}


def test_there_are_twenty_and_more() -> None:
    assert len(names()) >= 20


@pytest.mark.parametrize("name", names())
def test_a_script_is_short_and_told(name: str) -> None:
    text = (SCRIPTS / f"{name}.py").read_text(encoding="utf-8")
    told = ast.get_docstring(ast.parse(text))
    assert told is not None
    title, _, rest = told.partition("\n")
    assert title.endswith(".")
    assert rest.strip().endswith(".")
    assert len(text.splitlines()) <= 80  # of at most 88 columns
    assert f'("{name}.png"' in text, "the picture has the script's name"
    assert "SEAGLINT_GALLERY_SIZE" in text, "it has a reduced size"
    assert re.search(r"label", text) or "write_weather_plot" in text, "axes have labels"


@pytest.mark.parametrize("name", names())
def test_its_picture_is_small_and_shown(name: str) -> None:
    pictures = [path for path in IMAGES.glob(f"{name}.*") if path.suffix in (".png", ".jpg")]
    assert len(pictures) == 1, f"run python docs/figures/make_gallery.py {name}"
    assert pictures[0].stat().st_size < MOST_BYTES
    assert (IMAGES / "small" / f"{name}.jpg").stat().st_size < MOST_SMALL_BYTES
    pages = [page for page, text in PAGES.items() if f"(../images/gallery/{pictures[0].name})" in text and f"({name}.py)" in text]
    assert len(pages) == 1
    assert f"(../images/gallery/small/{name}.jpg)]({pages[0]}#" in PAGES["index.md"]


def test_no_picture_is_left_behind() -> None:
    notebooks = {path.stem for path in EXAMPLES.glob("*.ipynb")}
    assert {path.stem for path in IMAGES.glob("*.*")} == set(names()) | notebooks


def drawn(name: str, folder: Path) -> None:
    """Draw at reduced size; the picture shows something."""
    picture, thumbnail = draw(name, small=True)
    assert min(picture.size) > 200
    assert all(len(one.convert("L").getcolors()) > 10 for one in (picture, thumbnail))
    assert keep(name, picture, thumbnail, folder).stat().st_size < MOST_BYTES


def test_small_pictures_have_one_size() -> None:
    assert {Image.open(path).size for path in (IMAGES / "small").iterdir()} == {SMALL}


def test_a_small_picture_shows_one_panel_with_words_that_fit() -> None:
    figure = Figure(layout="constrained")
    left, right = figure.subplots(1, 2, sharey=True)
    drawn = right.imshow([[0.0, 1.0], [2.0, 3.0]], label="sea")
    figure.colorbar(drawn, ax=[left, right], label="radiance")
    right.set(title="a title", xlabel="column", ylabel="distance from the place of the sensor along the surface [m]")
    right.legend([], [], title="a legend")
    assert thumbnail(figure, 1).size == SMALL
    assert figure.axes == [right]
    assert (right.get_title(), right.get_xlabel(), right.get_ylabel(), right.get_legend()) == ("", "column", "", None)
    assert len(right.get_xticks()) <= 6


@pytest.mark.parametrize("name", QUICK)
def test_it_runs_at_reduced_size(name: str, tmp_path: Path) -> None:
    drawn(name, tmp_path)


@pytest.mark.validation
@pytest.mark.parametrize("name", [name for name in names() if name not in QUICK])
def test_all_run_at_reduced_size(name: str, tmp_path: Path) -> None:
    drawn(name, tmp_path)


def test_a_picture_stays_small() -> None:
    noise = Image.effect_noise((420, 300), 60.0).convert("RGB")
    ending, content = encoded(noise)
    assert ending == "jpg"
    assert len(content) < MOST_BYTES
    assert encoded(Image.new("RGB", (700, 500), "white"))[0] == "png"
