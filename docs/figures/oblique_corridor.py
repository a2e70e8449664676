"""Draw the corridor under an oblique wind, the mean map beside images averaged over seas, into docs/images.

python docs/figures/oblique_corridor.py [FOLDER] [--seas 60]
"""

from __future__ import annotations

import argparse
import math
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from pictures import save
from seaglint.base.conventions import FloatArray
from seaglint.base.schema import VARIABLES
from seaglint.imaging.camera.imager import Camera
from seaglint.imaging.scene import Accuracy, image
from seaglint.imaging.upright_scene import SweptScene
from seaglint.radiance.mean_radiance import mean_radiance
from seaglint.scenario.load import parse_scenario
from seaglint.studies.build import scenario_physics

IMAGES = Path(__file__).resolve().parents[2] / "docs" / "images"
SCENE: dict[str, Any] = {
    "sun": {"zenith_deg": 75.0, "azimuth_deg": 0.0},
    "wind": {"speed_m_s": 7.0, "from_deg": 30.0},
    "sensor": {"height_m": 30.0},
    "render": {"subpixel_glint": "off"},
}
WIDTH, TOP, BOTTOM = 24.0, 0.75, 8.0
"""Width of the picture, and depressions of its upper and lower edge [deg]."""


def radiances(seas: int) -> tuple[FloatArray, FloatArray]:
    """Mean map and mean of images [W m-2 sr-1, (rows, columns)], columns of one degree and rows of a quarter."""
    scenario = parse_scenario(SCENE)
    view = scenario_physics.view(scenario)
    waves = scenario_physics.sea(scenario, view.slopes).waves
    rows, columns = round(4.0 * (BOTTOM - TOP)), round(WIDTH)
    middle = -math.radians(0.5 * (TOP + BOTTOM))
    fine = Camera(30.0, 0.0, middle, math.radians(WIDTH), math.radians(BOTTOM - TOP), columns, 6 * rows)
    drawn = SweptScene.prepare(view, fine, waves, accuracy=Accuracy())
    total = np.zeros((rows, columns))
    for sea in range(seas):
        found = image(drawn.reseeded(sea), drawn.pose, 0.0).radiance
        total += np.asarray(found, dtype=np.float64).reshape(rows, 6, columns).mean(axis=1)
    mapped = mean_radiance(view, fine.elevations, fine.azimuths).total.reshape(rows, 6, columns).mean(axis=1)
    return mapped, total / seas


def picture(seas: int) -> Figure:
    """Map, mean image, and their ratio in rows of depression."""
    mapped, drawn = radiances(seas)
    figure = Figure(figsize=(10.5, 3.6), layout="constrained")
    axes = figure.subplots(1, 3)
    extent = (-0.5 * WIDTH, 0.5 * WIDTH, BOTTOM, TOP)
    for part, values, title in zip(axes[:2], (mapped, drawn), ("mean map", f"images of {seas} seas"), strict=True):
        shown = part.imshow(values, extent=extent, aspect="auto", cmap="inferno", vmin=0.0, vmax=float(mapped.max()))
        part.set(title=title, xlabel="azimuth from the Sun's [deg]", ylabel="depression [deg]")
    figure.colorbar(shown, ax=axes[:2], location="bottom", shrink=0.6).set_label(f"in-band radiance [{VARIABLES['radiance'].symbol}]")
    azimuth = np.arange(-0.5 * WIDTH + 0.5, 0.5 * WIDTH)
    depression = np.linspace(TOP, BOTTOM, mapped.shape[0] + 1)
    for low, high in ((0.75, 1.5), (1.5, 3.0), (3.0, 8.0)):
        inside = (depression[:-1] >= low) & (depression[1:] <= high)
        axes[2].plot(azimuth, mapped[inside].mean(axis=0) / drawn[inside].mean(axis=0), label=f"{low:g}-{high:g} deg down")
    axes[2].axhline(1.0, color="0.5", lw=0.8)
    axes[2].set(title="map over images", xlabel="azimuth from the Sun's [deg]", ylim=(0.8, 1.2))
    axes[2].legend(fontsize=8)
    return figure


def main() -> None:
    """Write the picture into the folder given, or docs/images."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, nargs="?", default=IMAGES)
    parser.add_argument("--seas", type=int, default=60, help="independent seas")
    options = parser.parse_args()
    path = options.folder / "oblique_corridor.png"
    save(picture(options.seas), path)
    print(path)


if __name__ == "__main__":
    main()
