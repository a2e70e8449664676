"""Draw low boats behind waves, 3 km from a sensor 12 m high, into docs/images.

python docs/figures/low_ships.py [FOLDER]
"""

from __future__ import annotations

import math
import sys
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from seaglint.base.schema import VARIABLES
from seaglint.scenario.load import parse_scenario
from seaglint.studies.sequence.render_sequence import prepare_sequence

IMAGES = Path(__file__).resolve().parents[2] / "docs" / "images"
RANGE = 3000.0
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


SCENE: dict[str, Any] = {
    "seed": 3,
    "sun": {"zenith_deg": 60.0, "azimuth_deg": 120.0},
    "wind": {"speed_m_s": 10.0, "from_deg": 20.0},
    "sensor": {"height_m": 12.0, "azimuth_deg": 0.0, "elevation_deg": -0.24, "fov_deg": [6.4, 0.32], "pixels": [1280, 64]},
    "objects": [boat(n) for n in range(BOATS)],
}


def picture() -> Figure:
    """Three instants, one above the other."""
    run = prepare_sequence(parse_scenario(SCENE))
    figure = Figure(figsize=(11.0, 3.2), layout="constrained")
    panels = figure.subplots(3, 1, sharex=True, sharey=True)
    for axes, time in zip(panels, (0.0, 4.0, 8.0), strict=True):
        image = run.drawn(time).layers.radiance
        shown = axes.imshow(image, cmap="gray", vmin=1.24, vmax=1.54, interpolation="nearest", aspect="auto")
        axes.set_ylabel(f"{time:g} s", fontsize=8)
    panels[-1].set_xlabel("column")
    figure.colorbar(shown, ax=panels, extend="both", pad=0.01).set_label(f"in-band radiance [{VARIABLES['radiance'].symbol}]", fontsize=8)
    return figure


def main() -> None:
    """Write the picture into the folder given, or docs/images."""
    path = (Path(sys.argv[1]) if len(sys.argv) > 1 else IMAGES) / "low_ships.png"
    picture().savefig(path, dpi=110, metadata={"Software": None})
    print(path)


if __name__ == "__main__":
    main()
