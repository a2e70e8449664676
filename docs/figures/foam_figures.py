"""Draw a sea with and without foam in two bands, and the life of one breaker, into docs/images.

python docs/figures/foam_figures.py              both
python docs/figures/foam_figures.py foam_life    one of foam, foam_life
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke
from numpy.typing import NDArray

from pictures import save_named
from seaglint.base.conventions import FloatArray, surface_range
from seaglint.imaging.camera.imager import Camera
from seaglint.imaging.scene import image
from seaglint.optics.band import apparent_temperature
from seaglint.scenario.load import parse_scenario
from seaglint.studies.build import scenario_physics
from seaglint.studies.sequence.render_sequence import prepare_sequence

BANDS = ((8.0, 12.0), (3.5, 5.0))
BAR = 10.0  # m
SIZE = (640, 320)
SCENE: dict[str, Any] = {
    "seed": 2,
    "sun": {"zenith_deg": 50.0, "azimuth_deg": 150.0},
    "wind": {"speed_m_s": 14.0, "from_deg": 330.0},
    "sensor": {"height_m": 20.0, "azimuth_deg": 0.0, "elevation_deg": -9.0, "fov_deg": [24.0, 12.0], "pixels": SIZE},
    "sea": {"shortest_wave_m": 0.25},
}
INTERVAL, FRAMES = 0.5, 10  # s, of a breaker's life
CROP = (120, 240)  # rows and columns of it
WAIT = 12  # frames among whose beginnings that of a breaker is looked for
INSTANT = 4.0  # s, of the two bands


class Picture(NamedTuple):
    """A frame and what it is drawn with."""

    kelvin: FloatArray
    share: NDArray[np.float32]
    camera: Camera


def pictures(band: tuple[float, float], foam: bool, times: FloatArray, **sensor: Any) -> list[Picture]:
    """Apparent temperature and shares of foam of some instants [s]; ``sensor``: other keys of the sensor."""
    sensor = {**SCENE["sensor"], **sensor}
    more = {"sea": {**SCENE["sea"], "foam": {}}, "render": {"layers": ["foam_share"]}} if foam else {}
    scenario = parse_scenario({**SCENE, "sensor": sensor, "band": {"min_um": band[0], "max_um": band[1]}, **more})
    scene, camera = prepare_sequence(scenario).scene, scenario_physics.camera(scenario)
    drawn = [image(scene, scene.pose, time) for time in times.tolist()]
    grid = scene.view.atmosphere.wavenumber_cm
    share = [one["foam_share"] if foam else np.zeros_like(one.radiance) for one in drawn]
    return [Picture(apparent_temperature(one.radiance, scene.view.band, grid), f, camera) for one, f in zip(drawn, share, strict=True)]


def extent(camera: Camera, rows: slice = slice(None), columns: slice = slice(None)) -> tuple[float, float, float, float]:
    """Left, right, lower and upper border of a part of the picture [deg]."""
    azimuth, elevation = np.degrees(camera.azimuths[columns]), np.degrees(camera.elevations[rows])
    half = 0.5 * np.degrees(camera.row_step)
    return azimuth[0] - half, azimuth[-1] + half, elevation[-1] - half, elevation[0] + half


def bar(axes: Axes, camera: Camera, elevation: float) -> None:
    """Draw a bar of some metres across the line of sight at an elevation [deg]."""
    distance = float(surface_range(camera.height, np.radians([-elevation]))[0])
    half = 0.5 * np.degrees(BAR / distance)
    outline = [withStroke(linewidth=3.0, foreground="black")]
    axes.plot([-half, half], [elevation] * 2, color="tab:orange", lw=2.0, path_effects=outline)
    text = f"  {BAR:g} m at {distance:.0f} m"
    axes.text(half, elevation, text, color="tab:orange", fontsize=8, va="center", path_effects=outline)


def foam() -> Figure:
    """The same sea without and with foam, in two bands."""
    figure = Figure(figsize=(11.0, 6.0), layout="constrained")
    panels = figure.subplots(2, 2, sharex=True, sharey=True)
    for pair, band in zip(panels, BANDS, strict=True):
        found = [pictures(band, foam, np.array([INSTANT]))[0] for foam in (False, True)]
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
        bar(panels[0, 0], found[1].camera, elevation)
    return figure


def foam_life() -> Figure:
    """The life of a breaker, from the frame before its beginning on."""
    found = pictures(BANDS[0], True, INTERVAL * np.arange(WAIT + FRAMES), elevation_deg=-14.0, fov_deg=[12.0, 6.0])
    first, rows, columns = beginning(np.stack([one.share for one in found]))
    found = found[first : first + FRAMES]
    figure = Figure(figsize=(11.0, 3.2), layout="constrained")
    panels = figure.subplots(2, FRAMES // 2, sharex=True, sharey=True)
    box = extent(found[0].camera, rows, columns)
    low, high = np.quantile([one.kelvin[rows, columns] for one in found], (0.005, 0.998))
    for number, (axes, one) in enumerate(zip(panels.flat, found, strict=True)):
        shown = axes.imshow(one.kelvin[rows, columns], cmap="gray", vmin=low, vmax=high, interpolation="nearest", extent=box)
        axes.set_title(f"{INTERVAL * number:g} s", fontsize=9)
    for axes in panels[-1]:
        axes.set_xlabel("azimuth [deg]", fontsize=8)
    for axes in panels[:, 0]:
        axes.set_ylabel("elevation [deg]", fontsize=8)
    figure.colorbar(shown, ax=panels, extend="both", pad=0.01).set_label("apparent temperature [K]", fontsize=8)
    return figure


def beginning(share: NDArray[np.float32]) -> tuple[int, slice, slice]:
    """Frame, rows and columns of the breaker that leaves most foam where there was none, in the middle of the strip."""
    rows, columns = CROP
    inner, around = window_sums(share, rows // 2, columns // 2), window_sums(share, rows, columns)
    height, width = around.shape[1:]
    middle = 2.0 * inner[:, rows // 4 :, columns // 4 :][:, :height, :width] - around
    life = sum(middle[later:][:WAIT] for later in range(1, FRAMES // 2)) - FRAMES * around[:WAIT]
    frame, row, column = (int(i) for i in np.unravel_index(int(life.argmax()), life.shape))
    return frame, slice(row, row + rows), slice(column, column + columns)


def window_sums(values: NDArray[np.float32], rows: int, columns: int) -> FloatArray:
    """Sums over all windows of a size in each frame, by the window's first row and column."""
    sums = np.pad(values.astype(np.float64), ((0, 0), (1, 0), (1, 0))).cumsum(axis=1).cumsum(axis=2)
    return np.asarray(sums[:, rows:, columns:] - sums[:, :-rows, columns:] - sums[:, rows:, :-columns] + sums[:, :-rows, :-columns])


PICTURES: dict[str, Callable[[], Figure]] = {"foam": foam, "foam_life": foam_life}


if __name__ == "__main__":
    save_named(PICTURES, sys.argv[1:])
