"""Draw a frame of examples/harbour.toml with its labels, a ship's shadow on the glint and low boats behind waves into docs/images.

python docs/figures/object_figures.py                    all three
python docs/figures/object_figures.py objects_harbour    some of objects_harbour, objects_shadow, low_ships
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from pictures import save_named
from seaglint.base.brightness import scale_limits
from seaglint.base.schema import VARIABLES
from seaglint.scenario.load import load_scenario, parse_scenario
from seaglint.studies.sequence.render_sequence import Sequence, prepare_sequence

ROOT = Path(__file__).resolve().parents[2]
SHADOW: dict[str, Any] = {
    "seed": 5,
    "sun": {"zenith_deg": 76.0, "azimuth_deg": 180.0},
    "wind": {"speed_m_s": 7.0, "from_deg": 215.0},
    "sensor": {"height_m": 200.0, "azimuth_deg": 180.0, "elevation_deg": -6.8, "fov_deg": [16.0, 6.0], "pixels": [640, 240], "frames": 1},
    "sea": {"shortest_wave_m": 3.0},
    "render": {"lines_per_column": 2, "variance_error": 0.1, "tile_size": 256, "object_shadows": True},
    "objects": [{"name": "ship", "preset": "container-ship", "east_m": 0.0, "north_m": -1500.0, "heading_deg": 90.0}],
}


RANGE = 3000.0
"""Range of the low boats [m]."""
HEIGHTS = (1.0, 2.0, 3.0)
"""Heights of the boats over the mean sea [m], in turn from left to right."""

BOATS = 12


def boat(number: int) -> dict[str, Any]:
    """A warm box of 8 m, lying on the mean sea across the line of sight."""
    azimuth, high = math.radians(0.5 * (number - 0.5 * (BOATS - 1))), HEIGHTS[number % len(HEIGHTS)]
    return {
        "name": f"boat {number + 1}, {high:g} m",
        "shape": {"kind": "box", "size_m": [8.0, 2.0, high]},
        "temperature_k": 294.0,
        "east_m": RANGE * math.sin(azimuth),
        "north_m": RANGE * math.cos(azimuth),
        "height_m": 0.5 * high,
    }


LOW_SHIPS: dict[str, Any] = {
    "seed": 3,
    "sun": {"zenith_deg": 60.0, "azimuth_deg": 120.0},
    "wind": {"speed_m_s": 10.0, "from_deg": 20.0},
    "sensor": {"height_m": 12.0, "azimuth_deg": 0.0, "elevation_deg": -0.24, "fov_deg": [6.4, 0.32], "pixels": [1280, 64]},
    "objects": [boat(n) for n in range(BOATS)],
}


def boxes(run: Sequence, time: float) -> tuple[np.ndarray, list[tuple[str, float, float, float, float]]]:
    """Radiance of an instant, and name, left, top, width and height of every object in view [pixels]."""
    drawn = run.drawn(time)
    assert run.objects is not None
    truth = run.objects.truth(drawn.sights, drawn.sea, run.scene_at(time), (run.scene.pixels, run.track.at(time).attitude))
    sides = [truth[f"bbox_{side}_px"] for side in ("left", "top", "width", "height")]
    found = [(name, *(float(side[n]) for side in sides)) for n, name in enumerate(run.objects.names)]
    return drawn.layers.radiance, [box for box in found if np.isfinite(box[1])]


def harbour() -> Figure:
    """A frame and the bounding boxes of what is in it."""
    run = prepare_sequence(load_scenario(ROOT / "examples" / "harbour.toml"))
    image, found = boxes(run, 0.0)
    figure = Figure(figsize=(11.0, 3.9), layout="constrained")
    axes = figure.subplots()
    low, high = scale_limits(image[: image.shape[0] * 5 // 6])
    shown = axes.imshow(image, cmap="gray", vmin=low, vmax=high, interpolation="nearest")
    for name, left, top, width, height in found:
        axes.add_patch(Rectangle((left - 1.5, top - 1.5), width + 2.0, height + 2.0, fill=False, ec="tab:orange", lw=0.8))
        axes.text(left + width + 2.0, top - 2.5, name, color="tab:orange", fontsize=7, va="bottom", ha="left")
    figure.colorbar(shown, ax=axes, extend="both", pad=0.01).set_label(f"in-band radiance [{VARIABLES['radiance'].symbol}]")
    axes.set(xlabel="column", ylabel="row")
    return figure


def shadow() -> Figure:
    """A ship in the corridor of a low Sun, without and with its shadow."""
    figure = Figure(figsize=(11.0, 2.9), layout="constrained")
    panels = figure.subplots(1, 2, sharey=True)
    limits: tuple[float, float] | None = None
    for axes, wanted in zip(panels, (False, True), strict=True):
        settings = {**SHADOW, "render": {**SHADOW["render"], "object_shadows": wanted}}
        image = prepare_sequence(parse_scenario(settings)).at(0.0).radiance
        limits = limits or scale_limits(image)
        shown = axes.imshow(image, cmap="gray", vmin=limits[0], vmax=limits[1], interpolation="nearest")
        axes.set_title(f"render.object_shadows = {str(wanted).lower()}", fontsize=9)
        axes.set_xlabel("column")
    panels[0].set_ylabel("row")
    figure.colorbar(shown, ax=panels, extend="both", pad=0.01).set_label(f"in-band radiance [{VARIABLES['radiance'].symbol}]")
    return figure


def low_ships() -> Figure:
    """Low boats behind waves at three instants, one above the other."""
    run = prepare_sequence(parse_scenario(LOW_SHIPS))
    figure = Figure(figsize=(11.0, 3.2), layout="constrained")
    panels = figure.subplots(3, 1, sharex=True, sharey=True)
    for axes, time in zip(panels, (0.0, 4.0, 8.0), strict=True):
        image = run.drawn(time).layers.radiance
        shown = axes.imshow(image, cmap="gray", vmin=1.24, vmax=1.54, interpolation="nearest", aspect="auto")
        axes.set_ylabel(f"{time:g} s", fontsize=8)
    panels[-1].set_xlabel("column")
    figure.colorbar(shown, ax=panels, extend="both", pad=0.01).set_label(f"in-band radiance [{VARIABLES['radiance'].symbol}]", fontsize=8)
    return figure


PICTURES: dict[str, Callable[[], Figure]] = {"objects_harbour": harbour, "objects_shadow": shadow, "low_ships": low_ships}


if __name__ == "__main__":
    save_named(PICTURES, sys.argv[1:])
