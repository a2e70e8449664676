"""Pictures of the documentation: few colours where none is seen to change, dark pages, cards, and what makes each of them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure
from PIL import Image

import pictures
import tables

ROOT = Path(__file__).resolve().parents[2]
IMAGES = ROOT / "docs" / "images"
RASTERS = sorted(path for path in IMAGES.rglob("*") if path.suffix in (".png", ".jpg"))


@pytest.fixture
def makers():
    return pytest.importorskip("makers", reason="Sphinx is not installed")


@pytest.fixture
def dark_pages():
    return pytest.importorskip("dark_pages", reason="Sphinx is not installed")


def ramp(seed: int, noise: float) -> Image.Image:
    """Smooth map of many colours, with noise of a standard deviation [levels of 255]."""
    x, y = np.meshgrid(np.linspace(0.0, 1.0, 300), np.linspace(0.0, 1.0, 200))
    values = np.stack([255.0 * x, 255.0 * y, 255.0 * (1.0 - x * y)], axis=-1)
    values += noise * np.random.default_rng(seed).standard_normal(values.shape)
    return Image.fromarray(np.clip(values, 0.0, 255.0).astype(np.uint8))


def test_lines_become_a_palette_and_smooth_maps_of_many_colours_do_not(tmp_path: Path) -> None:
    figure = Figure()
    figure.subplots().plot([0.0, 1.0], [1.0, 0.0])
    path = tmp_path / "lines.png"
    pictures.save(figure, path)
    assert Image.open(path).mode == "P"
    assert pictures.palettes(ramp(1, 0.0)) == []


def test_a_picture_is_written_anew_only_where_that_is_smaller(tmp_path: Path) -> None:
    path = tmp_path / "map.png"
    path.write_bytes(pictures.encoded(ramp(2, 0.0)))
    before = path.read_bytes()
    pictures.renew(path)
    assert path.read_bytes() == before
    Image.new("RGB", (300, 200), "white").save(path, compress_level=0)
    pictures.renew(path)
    assert path.stat().st_size < 1000


@pytest.mark.parametrize("path", [path for path in RASTERS if path.parent.name != "small"], ids=lambda path: path.stem)
def test_each_picture_is_as_small_as_its_writer_makes_it(path: Path) -> None:
    assert path.stat().st_size < 400_000


@pytest.mark.parametrize("path", sorted(path for path in IMAGES.rglob("*") if path.is_file()), ids=lambda path: path.name)
def test_each_picture_has_a_maker_that_exists(makers, path: Path) -> None:
    command = makers.shown(makers.makers()[path], path)
    assert all((tables.ROOT / word).is_file() for word in command.split() if word.endswith(".py"))
    assert makers.scripts(command) or command.startswith("seaglint ")
    assert "$" not in command


def test_a_command_of_several_pictures_names_the_one_shown(makers) -> None:
    path = IMAGES / "clutter_rates.png"
    assert makers.shown(makers.makers()[path], path) == "python docs/figures/make_figures.py clutter_rates"
    path = IMAGES / "fig5.png"
    assert makers.shown(makers.makers()[path], path) == "seaglint reproduce fig5"


PANELS = {
    "demo.png": 4,
    "near_horizon.png": 0,
    "fig12.png": 4,
    "sensor_point_edge.png": 8,
    "texture_measures.png": 0,
    "gallery/sun_heights.jpg": 8,
    "gallery/wave_spectrum.png": 0,
}
"""Panels of imagery and colour bars, counted by eye."""


@pytest.mark.parametrize(("name", "count"), PANELS.items(), ids=PANELS)
def test_imagery_and_colour_bars_are_found(dark_pages, name: str, count: int) -> None:
    assert len(dark_pages.panels(IMAGES / name)) == count


def test_panels_are_where_they_were_drawn(dark_pages, tmp_path: Path) -> None:
    values = np.full((100, 200, 3), 255, np.uint8)
    values[20:60, 30:130] = 90  # imagery
    values[40, 130:136] = 0  # a tick
    values[30:34, 50:60] = 255  # a part of it that is white
    values[80:90, 10:190:4] = 0  # words
    path = tmp_path / "panels.png"
    Image.fromarray(values).save(path)
    assert dark_pages.panels(path) == ((0.15, 0.2, 0.65, 0.6),)
    assert "15% 20%" in dark_pages.shade(path)
