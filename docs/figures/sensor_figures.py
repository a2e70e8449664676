"""Draw a point, an edge and the sea before and after a sensor, and its MTF and noise budget, into docs/images.

python docs/figures/sensor_figures.py
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from pictures import renew, save
from seaglint.plot.sensor_and_spectra import write_sensor_plot
from seaglint.scenario.load import parse_scenario
from seaglint.studies.mean.sensor_figures import describe_sensor
from seaglint.studies.sequence.sensed_sequence import prepare_sensed

IMAGES = Path(__file__).resolve().parents[2] / "docs" / "images"
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


def shown(axes: Any, picture: np.ndarray, title: str, low: float, high: float, extent: tuple[float, ...], units: tuple[str, str]) -> Any:
    """One picture over its angles: ``extent`` is left, right, bottom, top, ``units`` are the labels of the axes."""
    drawn = axes.imshow(picture, cmap="gray", vmin=low, vmax=high, interpolation="nearest", extent=extent, aspect="equal")
    axes.set_title(title, fontsize=9)
    axes.set_xlabel(units[0], fontsize=8)
    axes.set_ylabel(units[1], fontsize=8)
    axes.tick_params(labelsize=8)
    return drawn


def scaled(figure: Figure, drawn: Any, axes: Any) -> None:
    """Scale of radiance beside pictures that share it."""
    bar = figure.colorbar(drawn, ax=axes, fraction=0.05, pad=0.02, extend="max")
    bar.set_label("radiance [W m⁻² sr⁻¹]", fontsize=8)
    bar.ax.tick_params(labelsize=8)


def main() -> None:
    """Write the pictures."""
    scenario = parse_scenario(SCENE)
    run = prepare_sensed(scenario)
    model, n = run.sensed.model, run.sensed.oversampling
    fine = run.fine.at(0.0).radiance
    counts = model.readout.radiance(model.expose(model.focal_plane(fine, n)).signal)
    low, high = (float(v) for v in np.percentile(fine, (1.0, 98.0)))
    azimuth, elevation = run.layout.azimuth_deg, run.layout.elevation_deg
    half = 0.5 * float(azimuth[1] - azimuth[0])
    seen = (float(azimuth[0]) - half, float(azimuth[-1]) + half, float(elevation[-1]) - half, float(elevation[0]) + half)
    figure = Figure(figsize=(7.4, 7.0), layout="constrained")
    both = figure.subplots(2, 1)
    directions = ("azimuth [deg]", "elevation [deg]")
    drawn = shown(both[0], fine, f"radiance at the aperture, drawn {n} times finer than the pixels", low, high, seen, directions)
    shown(both[1], counts, "counts of the detector, as radiance", low, high, seen, directions)
    scaled(figure, drawn, both)
    save(figure, IMAGES / "sensor_sea.png")

    size, warm = 24, float(model.photons.radiance(300.0))
    point = np.full((size * n, size * n), warm, np.float32)
    point[size // 2 * n + n // 2, size // 2 * n + n // 2] = 400.0
    row, column = np.mgrid[0 : size * n, 0 : size * n] - 0.5 * size * n
    edge = np.where(column > 0.1 * row, float(model.photons.radiance(310.0)), warm).astype(np.float32)
    figure = Figure(figsize=(10.0, 6.2), layout="constrained")
    axes = figure.subplots(2, 3)
    side = 0.5e3 * size * model.ifov
    square, milliradians = (-side, side, -side, side), ("along rows [mrad]", "across [mrad]")
    for line, (name, picture) in enumerate((("point", point), ("edge", edge))):
        seen_by = model.focal_plane(picture, n)
        counts = model.readout.radiance(model.expose(seen_by).signal)
        top = float(seen_by.max())
        shown(axes[line, 0], picture, f"{name} at the aperture", warm, top, square, milliradians)
        shown(axes[line, 1], seen_by, "after optics and detector", warm, top, square, milliradians)
        scaled(figure, shown(axes[line, 2], counts, "counts, as radiance", warm, top, square, milliradians), axes[line])
    save(figure, IMAGES / "sensor_point_edge.png")
    write_sensor_plot(describe_sensor(scenario).sheet, IMAGES / "sensor_mtf.png")
    renew(IMAGES / "sensor_mtf.png")
    draw_lenses()


WIDE: dict[str, Any] = {
    "seed": 4,
    "sun": {"zenith_deg": 70.0, "azimuth_deg": 180.0},
    "wind": {"speed_m_s": 7.0, "from_deg": 205.0},
    "sensor": {"height_m": 30.0, "azimuth_deg": 196.0, "elevation_deg": -9.0, "projection": "pinhole", "pixels": [320, 200]},
}


def draw_lenses() -> None:
    """Draw the sea through a wide lens without errors, and through one that distorts and darkens its corners."""
    lens, pixels = {"focal_length_m": 0.005, "f_number": 1.4}, {"pitch_um": 17.0, "integration_time_s": 2e-4}
    figure = Figure(figsize=(7.4, 8.6), layout="constrained")
    for axes, (title, errors) in zip(
        figure.subplots(2, 1),
        (("a wide lens without errors", {}), ("distortion = 0.12 (pincushion) and cos4 = true", {"distortion": 0.12, "cos4": True})),
        strict=True,
    ):
        run = prepare_sensed(parse_scenario({**WIDE, "sensor": {**WIDE["sensor"], "optics": lens | errors, "detector": pixels}}))
        seen = run.sensed.model.focal_plane(run.fine.at(0.0).radiance, run.sensed.oversampling)
        rows, columns = seen.shape
        low, high = (0.0, 12.0)
        drawn = shown(axes, seen, title, low, high, (0, columns, rows, 0), ("column", "row"))
        scaled(figure, drawn, axes)
    save(figure, IMAGES / "sensor_lens.png", dpi=90)


if __name__ == "__main__":
    main()
