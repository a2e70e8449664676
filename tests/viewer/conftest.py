"""A small sequence with a layer and an object, through the real store, and a client without a browser."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest

from seaglint.optics.band import Band
from seaglint.store.layout import NUMBERS, Layout, Truth
from seaglint.store.provenance import provenance
from seaglint.store.sequence_store import write_sequence

if TYPE_CHECKING:
    from .page import Seen, Served

ROWS, COLUMNS, FRAMES = 48, 64, 12


def layout(
    frames: int = FRAMES, rows: int = ROWS, columns: int = COLUMNS, *, truth: bool = True, layers: tuple[str, ...] = ("range",)
) -> Layout:
    return Layout(
        azimuth_deg=np.linspace(170.0, 190.0, columns),
        elevation_deg=np.linspace(1.0, -6.0, rows),
        frames=range(frames),
        frame_rate=25.0,
        band=Band.rectangular(3.5, 5.0),
        variables=("radiance", *layers),
        attributes=provenance("Infrared image sequence of the sea", scenario_json='{"wind": {"speed_m_s": 7.0}}', seed=1),
        truth=Truth(("boat",)) if truth else None,
    )


def radiance(number: int, rows: int = ROWS, columns: int = COLUMNS) -> np.ndarray:
    """Gamma clutter, brighter in the middle; another one every frame."""
    noise = np.random.default_rng([7, number]).gamma(3.0, 0.4, (rows, columns))
    corridor = 1.0 + 3.0 * np.exp(-(((np.arange(columns) - columns / 2) / (columns / 6)) ** 2))
    return (noise * corridor).astype(np.float32)


def images(number: int) -> dict[str, np.ndarray]:
    mask = np.zeros((1, ROWS, COLUMNS), np.uint64)
    mask[0, 20:24, 10 + number : 18 + number] = 1
    truth = {name: np.array([0.0]) for name in NUMBERS}
    box = {"bbox_left_px": 10 + number, "bbox_top_px": 20, "bbox_width_px": 8, "bbox_height_px": 4, "range_m": 1200.0}
    truth |= {name: np.array([float(value)]) for name, value in box.items()}
    distance = np.repeat(np.geomspace(9000.0, 300.0, ROWS)[:, np.newaxis], COLUMNS, axis=1).astype(np.float32)
    return {"radiance": radiance(number), "range": distance, **truth, "object_mask": mask, "object_id": mask[0].astype(np.uint16)}


@pytest.fixture(scope="session")
def store(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_sequence(tmp_path_factory.mktemp("run") / "run.zarr", layout(), images)


@pytest.fixture
def half(tmp_path: Path) -> Path:
    """A sequence whose writing broke off after three frames; its final name."""

    def until(number: int) -> dict[str, np.ndarray]:
        if number == 3:
            raise RuntimeError("stopped")
        return images(number)

    with pytest.raises(RuntimeError):
        write_sequence(tmp_path / "half.zarr", layout(), until)
    return tmp_path / "half.zarr"


@pytest.fixture(scope="module")
def chromium() -> Iterator:
    playwright = pytest.importorskip("playwright.sync_api", reason="Playwright is not installed")
    from .page import CHROMIUM

    with playwright.sync_playwright() as started:
        browser = started.chromium.launch(executable_path=str(CHROMIUM), args=["--no-sandbox", "--headless=new"])
        yield browser
        browser.close()


@pytest.fixture(scope="module")
def served(store, tmp_path_factory) -> Iterator[Served]:
    from .page import Served

    other = write_sequence(
        tmp_path_factory.mktemp("other") / "other.zarr", layout(), lambda n: {**images(n), "radiance": radiance(n + 100)}
    )
    viewer = Served(store, other)
    yield viewer
    viewer.end()


@pytest.fixture
def seen(chromium, served) -> Iterator[Seen]:
    from .page import Seen

    page = Seen(chromium, served)
    page.on("source-b").select_option("")
    page.until("seaglint.state.b === null && seaglint.state.panes.a.levels")
    yield page
    page.end()
