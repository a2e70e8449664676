"""Draw a small drone that crosses the glint, before a camera that stands and one that follows it, and compare its counts with its labels.

    python docs/figures/moving_targets.py [--frames N]

``--frames 0`` draws the figure into docs/images. Otherwise a table, Markdown on standard output, gives the distance between labels and the
middle of the electrons that a target adds: those of a run with it less those of a run without it, noise off.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from numpy.typing import NDArray

from pictures import save
from seaglint.base.brightness import scale_limits
from seaglint.base.schema import VARIABLES
from seaglint.scenario.load import parse_scenario
from seaglint.studies.sequence.sensed_sequence import SensedSequence, prepare_sensed

OUTPUT = Path(__file__).resolve().parents[2] / "docs" / "images" / "moving_targets.png"
COLUMNS = 160
STEP = 0.2e-3
"""Angle between pixels [rad]."""

HEIGHT, DOWN = 30.0, 1.2
"""Height of the camera [m] and depression of its middle [deg]."""

RANGE, SPEED, PASS = 400.0, 20.0, 0.6
"""Distance of the way at its nearest [m], speed [m/s] and duration [s]."""

FRAMES = (0, 3, 6, 9, 12, 15)
"""Numbers of the frames of the figure."""

CLOSE = (14, 9)
"""Half of what the close-ups show: columns and rows [pixels]."""

TARGETS: Mapping[str, Mapping[str, Any]] = {
    "drone": {"preset": "drone"},
    "hot engine": {"shape": {"kind": "sphere", "radius_m": 0.015}, "temperature_k": 1000.0, "emissivity": 0.9},
}


@dataclass(frozen=True)
class Camera:
    """A camera: its rows, f-number, exposure [s] and rate [Hz], and whether it follows the target."""

    rows: int
    f_number: float
    exposure: float
    rate: float
    follows: bool = False


STANDING = Camera(96, 4.0, 12e-3, 25.0)
TRACKING = replace(STANDING, follows=True)
FAST = Camera(48, 2.5, 1.2e-3, 781.0)
"""The table's camera: undersampled, its target goes on by 0.32 pixels a frame, so that all phases within a pixel occur."""

FIRST = 88
"""First frame of the table: 300 frames on, the target is 32 pixels from either edge, beyond most of the wings of diffraction."""


def scene(camera: Camera, target: str | None) -> SensedSequence:
    """A pass with a target or without one."""
    east = 0.5 * SPEED * PASS
    instants = np.linspace(-0.05, PASS + 0.05, 71)
    turns = [{"time_s": float(t), "azimuth_deg": 180.0 - math.degrees(math.atan2(east - SPEED * t, RANGE))} for t in instants]
    item = {"east_m": east, "north_m": -RANGE, "height_m": HEIGHT - RANGE * math.tan(math.radians(DOWN))}
    settings: dict[str, Any] = {
        "seed": 4,
        "sun": {"zenith_deg": 84.0, "azimuth_deg": 180.0},
        "wind": {"speed_m_s": 4.0, "from_deg": 230.0},
        "sea": {"shortest_wave_m": 2.0},
        "band": {"min_um": 3.5, "max_um": 5.0},
        "sensor": {
            "pixels": [COLUMNS, camera.rows],
            "azimuth_deg": 180.0,
            "elevation_deg": -DOWN,
            "height_m": HEIGHT,
            "frames": round(PASS * camera.rate) + 1,
            "frame_rate_hz": camera.rate,
            "optics": {"focal_length_m": 15e-6 / STEP, "f_number": camera.f_number},
            "detector": {"pitch_um": 15.0, "integration_time_s": camera.exposure, "gain_e_per_count": 1e5},
            "noise": {"temporal": False, "fixed_pattern": False},
        },
    }
    if camera.follows:
        settings["platform"] = {"keyframes": turns}
    if target is not None:
        settings["objects"] = [{"name": target, **TARGETS[target], **item, "course_deg": 270.0, "speed_m_s": SPEED}]
    return prepare_sensed(parse_scenario(settings), electrons=True)


def labels(arrays: Mapping[str, NDArray[Any]]) -> dict[str, float]:
    """Labels of the one target of a frame."""
    return {name: float(values[0]) for name, values in arrays.items() if values.shape == (1,)}


def mark(axes: Axes, truth: Mapping[str, float]) -> None:
    """Mark the place of a target and the ends of its streak."""
    axes.plot(truth["column_px"], truth["row_px"], "+", color="tab:cyan", ms=7, mew=0.9)
    ends = [[truth[f"streak_{end}_{axis}_px"] for end in ("begin", "end")] for axis in ("column", "row")]
    axes.plot(*ends, "-|", color="tab:orange", ms=9, mew=0.9, lw=0.7)


def picture() -> Figure:
    """Frames of both cameras, and close-ups."""
    figure = Figure(figsize=(12.0, 6.2), layout="constrained")
    panels = figure.subplots(4, len(FRAMES))
    limits: tuple[float, float] | None = None
    shown: Any = None
    for upper, camera in zip((0, 2), (STANDING, TRACKING), strict=True):
        run = scene(camera, "drone")
        name = "tracking" if camera.follows else "standing"
        for k, frame in enumerate(FRAMES):
            arrays = run.images(frame)
            image, truth = run.sensed.seen(frame), labels(arrays)
            limits = limits or scale_limits(image)
            for axes in panels[upper : upper + 2, k]:
                shown = axes.imshow(image, cmap="gray", vmin=limits[0], vmax=limits[1], interpolation="nearest")
                axes.tick_params(labelsize=6)
            panels[upper, k].set_title(f"{name}, {frame / camera.rate:.2f} s: way {truth['motion_px']:.2f} px", fontsize=7)
            whole, close = panels[upper : upper + 2, k]
            x, y = round(truth["column_px"]), round(truth["row_px"])
            close.set(xlim=(x - CLOSE[0] - 0.5, x + CLOSE[0] + 0.5), ylim=(y + CLOSE[1] + 0.5, y - CLOSE[1] - 0.5))
            whole.add_patch(_frame(x, y))
            mark(close, truth)
    for axes in panels[:, 0]:
        axes.set_ylabel("row", fontsize=7)
    for axes in panels[-1]:
        axes.set_xlabel("column", fontsize=7)
    symbol = VARIABLES["radiance"].symbol
    figure.colorbar(shown, ax=panels, extend="both", pad=0.01).set_label(f"in-band radiance on the pixels [{symbol}]", fontsize=8)
    return figure


def _frame(column: int, row: int) -> Rectangle:
    """Outline of a close-up."""
    corner = (column - CLOSE[0] - 0.5, row - CLOSE[1] - 0.5)
    return Rectangle(corner, 2 * CLOSE[0] + 1, 2 * CLOSE[1] + 1, fill=False, ec="tab:cyan", lw=0.6)


def distances(target: str, empty: Sequence[NDArray[np.float64]]) -> Iterator[tuple[float, float]]:
    """Distances of the middle of a target's electrons from its counted and from its true place, frame by frame [pixels].

    ``empty`` holds the electrons of the frames without it [(rows, columns)].
    """
    run = scene(FAST, target)
    for number, without in enumerate(empty, FIRST):
        arrays = run.images(number)
        truth = labels(arrays)
        change = arrays["electrons"].astype(np.float64) - without
        total = float(change.sum())
        across = float(change.sum(axis=0) @ np.arange(COLUMNS)) / total
        down = float(change.sum(axis=1) @ np.arange(FAST.rows)) / total
        counted, true = (math.hypot(across - truth[f"{name}column_px"], down - truth[f"{name}row_px"]) for name in ("counts_", ""))
        yield counted, true


def table(frames: int) -> None:
    """Print the table."""
    print("| target | frames | from `counts_column_px`, `counts_row_px`: rms | largest | from `column_px`, `row_px`: rms | largest |")
    print("|---|---|---|---|---|---|")
    plain = scene(FAST, None)
    empty = [plain.images(number)["electrons"].astype(np.float64) for number in range(FIRST, FIRST + frames)]
    for target in TARGETS:
        found = np.array(list(distances(target, empty)))
        cells = [f"{number:.2g}" for column in found.T for number in (math.sqrt(float(np.mean(column**2))), float(column.max()))]
        print(f"| {target} | {frames} | " + " | ".join(cells) + " |", flush=True)


def main() -> None:
    """Write the picture and print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--frames", type=int, default=300, help="frames of the table, at most 300; 0 draws the picture instead")
    frames = parser.parse_args().frames
    if frames:
        table(frames)
    else:
        save(picture(), OUTPUT)


if __name__ == "__main__":
    main()
