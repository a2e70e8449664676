"""Draw a point, an edge and the sea before and after a sensor, and its MTF and noise budget, into docs/images.

python tools/sensor_figures.py
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from seaglint.pipeline.sensed import prepare_sensed
from seaglint.pipeline.sensor import describe_sensor
from seaglint.plot.sensor import write_sensor_plot
from seaglint.scenario.load import parse_scenario

IMAGES = Path(__file__).resolve().parents[1] / "docs" / "images"
SCENE: dict[str, Any] = {
    "seed": 4,
    "sun": {"zenith_deg": 76.0, "azimuth_deg": 240.0},
    "wind": {"speed_m_s": 7.0, "from_deg": 205.0},
    "sensor": {
        "height_m": 30.0,
        "azimuth_deg": 246.0,
        "elevation_deg": -2.2,
        "pixels": [256, 128],
        "optics": {"focal_length_m": 0.03, "f_number": 4.0, "transmission": 0.85, "wavefront_error_waves": 0.05, "jitter_urad": 120},
        "detector": {
            "pitch_um": 15.0,
            "fill_factor": 0.9,
            "integration_time_s": 5e-4,
            "quantum_efficiency": 0.8,
            "well_capacity_e": 7e6,
            "read_noise_e": 600,
            "bit_depth": 14,
        },
        "noise": {"gain_spread": 0.003, "column": 800.0, "dead_share": 0.0005},
    },
}


def shown(axes: Any, picture: np.ndarray, title: str, low: float, high: float) -> None:
    """One picture without axes."""
    axes.imshow(picture, cmap="gray", vmin=low, vmax=high, interpolation="nearest")
    axes.set_title(title, fontsize=9)
    axes.set_axis_off()


def main() -> None:
    """Write the pictures."""
    scenario = parse_scenario(SCENE)
    run = prepare_sensed(scenario)
    model, n = run.sensed.model, run.sensed.oversampling
    fine = run.fine.at(0.0).radiance
    exposed = model.expose(model.focal_plane(fine, n))
    counts = model.readout.radiance(exposed.signal)
    low, high = (float(v) for v in np.percentile(fine, (1.0, 98.0)))
    figure = Figure(figsize=(6.4, 7.0), layout="constrained")
    upper, lower = figure.subplots(2, 1)
    shown(upper, fine, f"radiance at the aperture, drawn {n} times finer", low, high)
    shown(lower, counts, "counts of the detector, as radiance", low, high)
    figure.savefig(IMAGES / "sensor_sea.png", dpi=110)

    size, warm = 24, float(model.photons.radiance(300.0))
    point = np.full((size * n, size * n), warm, np.float32)
    point[size // 2 * n + n // 2, size // 2 * n + n // 2] = 400.0
    row, column = np.mgrid[0 : size * n, 0 : size * n] - 0.5 * size * n
    edge = np.where(column > 0.1 * row, float(model.photons.radiance(310.0)), warm).astype(np.float32)
    figure = Figure(figsize=(9.0, 4.6), layout="constrained")
    axes = figure.subplots(2, 3)
    for line, (name, picture) in enumerate((("point", point), ("edge", edge))):
        seen = model.focal_plane(picture, n)
        counts = model.readout.radiance(model.expose(seen).signal)
        top = float(seen.max())
        shown(axes[line, 0], picture, f"{name} at the aperture", warm, top)
        shown(axes[line, 1], seen, "after optics and detector", warm, top)
        shown(axes[line, 2], counts, "counts, as radiance", warm, top)
    figure.savefig(IMAGES / "sensor_point_edge.png", dpi=110)
    write_sensor_plot(describe_sensor(scenario), IMAGES / "sensor_mtf.png")


if __name__ == "__main__":
    main()
