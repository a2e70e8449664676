"""Moonlight on the sea: print the table of the guide, and draw its picture into docs/images.

``contrast`` writes the contrast of the corridor into docs/guide/scenario/moon.md, ``picture`` draws moonlit_sea.png:

    python docs/figures/moonlit_figures.py contrast picture
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

import seaglint as sg
from pictures import save
from seaglint.optics.band import apparent_temperature
from seaglint.radiance.mean_radiance import mean_radiance
from seaglint.scenario.load import parse_scenario
from seaglint.studies.build import scenario_physics

ROOT = Path(__file__).resolve().parents[2]
PAGE, IMAGES = ROOT / "docs" / "guide" / "scenario" / "moon.md", ROOT / "docs" / "images"
BANDS = {"3.5-5": (3.5, 5.0), "8-12": (8.0, 12.0)}
PHASES = {"full": 5.0, "half": 90.0}
HEIGHTS, WINDS = (5.0, 10.0, 20.0, 40.0, 60.0), (2.0, 5.0, 10.0)
DEPRESSIONS = np.radians(np.geomspace(0.5, 80.0, 60))
"""Depressions among which the brightest of the corridor is taken [rad]."""


def contrast(band: tuple[float, float], height: float, phase: float, wind: float) -> float:
    """Largest rise of the apparent temperature towards a Moon of a height and phase [deg] by its mirrored light [mK]; sensor 20 m high."""
    tables: dict[str, Any] = {
        "sun": {"zenith_deg": 150.0, "azimuth_deg": 180.0},
        "moon": {"zenith_deg": 90.0 - height, "azimuth_deg": 0.0, "phase_deg": phase},
        "band": {"min_um": band[0], "max_um": band[1]},
        "wind": {"speed_m_s": wind, "from_deg": 0.0},
        "sensor": {"height_m": 20.0, "azimuth_deg": 0.0},
    }
    view = scenario_physics.view(parse_scenario(tables))
    light = mean_radiance(view, -DEPRESSIONS, [0.0])
    wavenumber = view.atmosphere.wavenumber_cm
    lit, dark = (apparent_temperature(radiance, view.band, wavenumber) for radiance in (light.total, light.total - light.sun))
    return 1e3 * float((lit - dark).max())


def contrast_table() -> list[str]:
    """Rows of the guide's table."""
    columns = [(band, phase) for band in BANDS for phase in PHASES]
    head = [f"{band} µm, {phase}" for band, phase in columns]
    lines = ["| Moon's height | wind | " + " | ".join(head) + " |", "|---|---|" + "---|" * len(head)]
    for height in HEIGHTS:
        for wind in WINDS:
            values = [contrast(BANDS[band], height, PHASES[phase], wind) for band, phase in columns]
            cells = [f"{value:.2g} mK" for value in values]
            lines.append(f"| {height:g}° | {wind:g} m/s | " + " | ".join(cells) + " |")
    return lines


def write_table() -> None:
    """Write the table between its markers."""
    text, begin, end = PAGE.read_text(encoding="utf-8"), "<!-- begin contrast -->\n", "<!-- end contrast -->"
    before, rest = text.split(begin)
    PAGE.write_text("\n".join([before + begin, *contrast_table(), "", end]) + rest.split(end)[1], encoding="utf-8")


def draw_picture() -> None:
    """Draw the Moon above its corridor in 3.5-5 um from 20 m, the mirrored light alone, and the lit part."""
    tables: dict[str, Any] = {
        "seed": 4,
        "sun": {"zenith_deg": 125.0, "azimuth_deg": 40.0},
        "moon": {"zenith_deg": 80.0, "azimuth_deg": 100.0, "phase_deg": 60.0},
        "band": {"min_um": 3.5, "max_um": 5.0},
        "wind": {"speed_m_s": 3.0, "from_deg": 130.0},
        "sensor": {"height_m": 20.0, "azimuth_deg": 100.0, "elevation_deg": 0.0, "fov_deg": [14.0, 24.0], "pixels": [466, 800]},
    }
    image = sg.image(tables, 0.0, ["glint_radiance"])
    view = scenario_physics.view(parse_scenario(tables))
    wavenumber = view.atmosphere.wavenumber_cm
    lit, glint = (image[name].values.astype(float) for name in ("radiance", "glint_radiance"))
    kelvin, unlit = (apparent_temperature(radiance, view.band, wavenumber) for radiance in (lit, lit - glint))
    azimuth, elevation = image.azimuth.values, image.elevation.values
    figure = Figure(figsize=(8.6, 6.2), layout="constrained")
    axes = figure.subplots(1, 3, width_ratios=[1.0, 1.0, 0.5])
    seen: dict[str, Any] = {"extent": (azimuth[0], azimuth[-1], elevation[-1], elevation[0]), "aspect": "equal"}
    above = kelvin - np.median(kelvin, axis=1, keepdims=True)
    shown = axes[0].imshow(above, cmap="gray", vmin=-1.0, vmax=1.5, **seen)
    figure.colorbar(shown, ax=axes[0], location="bottom", label="less the median of the row [K]", extend="both")
    axes[0].set(xlabel="azimuth [°]", ylabel="elevation [°]", title="apparent temperature")
    shown = axes[1].imshow(1e3 * (kelvin - unlit), cmap="inferno", vmin=0.0, vmax=40.0, **seen)
    figure.colorbar(shown, ax=axes[1], location="bottom", label="part of it [mK]", extend="max")
    axes[1].set(xlabel="azimuth [°]", title="mirrored moonlight")
    axes[2].imshow(kelvin, cmap="gray", vmin=float(kelvin.max()) - 25.0, vmax=float(kelvin.max()), **seen)
    axes[2].set(xlim=(99.6, 100.4), ylim=(9.6, 10.4), xticks=(), yticks=(), title=f"the Moon, {kelvin.max():.0f} K\nbehind the air")
    save(figure, IMAGES / "moonlit_sea.png")


if __name__ == "__main__":
    for name in sys.argv[1:] or ("contrast", "picture"):
        {"contrast": write_table, "picture": draw_picture}[name]()
