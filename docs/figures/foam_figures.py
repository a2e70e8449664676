"""Draw a sea with and without foam in two bands, and the life of one breaker, into docs/images.

python docs/figures/foam_figures.py              both
python docs/figures/foam_figures.py foam_life    one of foam, foam_life
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from pictures import save
from seaglint.base.conventions import FloatArray, surface_range
from seaglint.imaging.camera.imager import Camera
from seaglint.imaging.scene import image
from seaglint.optics.band import apparent_temperature
from seaglint.scenario.load import parse_scenario
from seaglint.studies.build import scenario_physics
from seaglint.studies.sequence.render_sequence import prepare_sequence

ROOT = Path(__file__).resolve().parents[2]
IMAGES = ROOT / "docs" / "images"
BANDS = ((8.0, 12.0), (3.5, 5.0))
BAR = 10.0  # m
SIZE = (640, 320)
SCENE: dict[str, Any] = {
    "seed": 2,
    "sun": {"zenith_deg": 50.0, "azimuth_deg": 150.0},
    "wind": {"speed_m_s": 14.0, "from_deg": 330.0},
    "sensor": {"height_m": 20.0, "azimuth_deg": 0.0, "elevation_deg": -9.0, "fov_deg": [24.0, 12.0], "pixels": SIZE},
    "sea": {"shortest_wave_m": 0.25},
    "render": {"layers": ["foam_share"]},
}
INTERVAL, FRAMES = 0.5, 5  # s, of the strip
CROP = (64, 160)  # rows and columns of the strip
MIDDLE, BEFORE = 4.0, 0.5  # s: an instant at which a breaker is looked for, and what of its life is shown before


class Picture(NamedTuple):
    """A frame and what it is drawn with."""

    kelvin: FloatArray
    share: NDArray[np.float32]
    camera: Camera


def pictures(band: tuple[float, float], foam: bool, times: FloatArray) -> list[Picture]:
    """Apparent temperature and shares of foam of some instants [s]."""
    sea = {**SCENE["sea"], **({"foam": {}} if foam else {})}
    scenario = parse_scenario({**SCENE, "band": {"min_um": band[0], "max_um": band[1]}, "sea": sea})
    scene, camera = prepare_sequence(scenario).scene, scenario_physics.camera(scenario)
    drawn = [image(scene, scene.pose, time) for time in times.tolist()]
    grid = scene.view.atmosphere.wavenumber_cm
    return [Picture(apparent_temperature(one.radiance, scene.view.band, grid), one["foam_share"], camera) for one in drawn]


def extent(camera: Camera, rows: slice = slice(None), columns: slice = slice(None)) -> tuple[float, float, float, float]:
    """Left, right, lower and upper border of a part of the picture [deg]."""
    azimuth, elevation = np.degrees(camera.azimuths[columns]), np.degrees(camera.elevations[rows])
    half = 0.5 * np.degrees(camera.row_step)
    return azimuth[0] - half, azimuth[-1] + half, elevation[-1] - half, elevation[0] + half


def bar(axes: Axes, camera: Camera, elevation: float) -> None:
    """Draw a bar of some metres across the line of sight at an elevation [deg]."""
    distance = float(surface_range(camera.height, np.radians([-elevation]))[0])
    half = 0.5 * np.degrees(BAR / distance)
    axes.plot([-half, half], [elevation] * 2, color="tab:orange", lw=1.5)
    axes.text(half, elevation, f" {BAR:g} m at {distance:.0f} m", color="tab:orange", fontsize=7, va="center")


def foam() -> Figure:
    """The same sea without and with foam, in two bands."""
    figure = Figure(figsize=(11.0, 6.0), layout="constrained")
    panels = figure.subplots(2, 2, sharex=True, sharey=True)
    for pair, band in zip(panels, BANDS, strict=True):
        found = [pictures(band, foam, np.array([MIDDLE]))[0] for foam in (False, True)]
        low, high = np.quantile(found[1].kelvin, (0.002, 0.998))
        for axes, one, title in zip(pair, found, ("without foam", "with foam"), strict=True):
            box = extent(one.camera)
            shown = axes.imshow(one.kelvin, cmap="gray", vmin=low, vmax=high, interpolation="nearest", extent=box, aspect="equal")
            axes.set_title(f"{band[0]:g}-{band[1]:g} µm, {title}", fontsize=9)
        figure.colorbar(shown, ax=pair, extend="both", pad=0.01).set_label("apparent temperature [K]")
        pair[0].set_ylabel("elevation [deg]")
    for axes in panels[-1]:
        axes.set_xlabel("azimuth [deg]")
    for elevation in (-5.0, -13.0):
        bar(panels[0, 1], found[1].camera, elevation)
    return figure


def foam_life() -> Figure:
    """The brightest breaker of an instant, from its beginning on: apparent temperature and share of foam."""
    times = MIDDLE - BEFORE + INTERVAL * np.arange(FRAMES)
    found = pictures(BANDS[0], True, times)
    rows, columns = place(found[1].share)
    figure = Figure(figsize=(11.0, 2.6), layout="constrained")
    panels = figure.subplots(2, FRAMES, sharex=True, sharey=True)
    box = extent(found[0].camera, rows, columns)
    seen = np.stack([one.kelvin[rows, columns] for one in found])
    low, high = np.quantile(seen, (0.005, 0.998))
    for column, (one, time) in enumerate(zip(found, times, strict=True)):
        warm = panels[0, column].imshow(one.kelvin[rows, columns], cmap="gray", vmin=low, vmax=high, interpolation="nearest", extent=box)
        white = panels[1, column].imshow(one.share[rows, columns], cmap="gray", vmin=0.0, vmax=1.0, interpolation="nearest", extent=box)
        panels[0, column].set_title(f"{time - times[0]:g} s", fontsize=9)
        panels[1, column].set_xlabel("azimuth [deg]", fontsize=8)
    for axes in panels[:, 0]:
        axes.set_ylabel("elev. [deg]", fontsize=8)
    figure.colorbar(warm, ax=panels[0], pad=0.01).set_label("temp. [K]", fontsize=8)
    figure.colorbar(white, ax=panels[1], pad=0.01).set_label("foam [1]", fontsize=8)
    return figure


def place(share: NDArray[np.float32]) -> tuple[slice, slice]:
    """Rows and columns of the strip around the part of a picture with most foam, in the nearer half of the sea."""
    rows, columns = CROP
    sums = np.pad(share.astype(np.float64), ((1, 0), (1, 0))).cumsum(axis=0).cumsum(axis=1)
    inside = sums[rows:, columns:] - sums[:-rows, columns:] - sums[rows:, :-columns] + sums[:-rows, :-columns]
    inside[: share.shape[0] // 3] = 0.0
    row, column = (int(i) for i in np.unravel_index(int(inside.argmax()), inside.shape))
    return slice(row, row + rows), slice(column, column + columns)


PICTURES: dict[str, Callable[[], Figure]] = {"foam": foam, "foam_life": foam_life}


def main(names: list[str]) -> None:
    """Write those named, or all."""
    if unknown := set(names) - set(PICTURES):
        sys.exit(f"{', '.join(sorted(unknown))}: not one of {', '.join(PICTURES)}")
    for name in names or PICTURES:
        path = IMAGES / f"{name}.png"
        save(PICTURES[name](), path)
        print(path.relative_to(ROOT))


if __name__ == "__main__":
    main(sys.argv[1:])
