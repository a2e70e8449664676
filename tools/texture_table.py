"""Fit gamma textures to a rendered glint sequence and to measured pictures, and write what they miss into docs/validation.md.

    python tools/texture_table.py            table, and the pictures of docs/guide/textures.md
    python tools/texture_table.py --print    table on the terminal only

The rendered sequence is made here. Measured pictures come from the folder that SEAGLINT_DATA_DIR names; without it their rows are left out.
"""

from __future__ import annotations

import os
import sys
import tempfile
from pathlib import Path

import numpy as np

from seaglint.analysis.recording import Recording
from seaglint.io.recording import open_recording
from seaglint.pipeline.render import render
from seaglint.pipeline.texture import FitOptions, Fitted, fit
from seaglint.plot.texture import draw_measures, draw_pictures
from seaglint.scenario.load import parse_scenario
from validation_tables import PAGE, replace, table

IMAGES = PAGE.parent / "images"

GLINT = {
    "seed": 4,
    "sun": {"zenith_deg": 60, "azimuth_deg": 180},
    "sensor": {
        "height_m": 100,
        "azimuth_deg": 180,
        "elevation_deg": -6,
        "fov_deg": [4.1, 3.1],
        "pixels": [128, 96],
        "frame_rate_hz": 25,
        "frames": 50,
    },
    "band": {"min_um": 3.5, "max_um": 5.0},
    "wind": {"speed_m_s": 2, "from_deg": 135},
    "sea": {"shortest_wave_m": 1.0},
}
"""Sparse glints: a Sun at 60 deg over a light wind, seen at 4.5 to 7.5 deg of depression."""

MEASURED = (("Misc_66", "120:250,90:230"), ("Misc_66", "5:125,100:300"), ("Misc_107", "110:215,150:290"), ("Misc_26", "20:120,120:340"))
"""Pictures and regions: the glint corridor, and three that the whole corridor or shore is kept out of."""


def rendered(folder: Path) -> Recording:
    """The glint sequence."""
    return open_recording(render(parse_scenario(GLINT), folder / "glint.zarr"))


def judged(recording: Recording, region: str | None) -> Fitted:
    """A gamma texture; these pictures are stationary nowhere, which is the user's to decide."""
    return fit(recording, FitOptions(tails="gamma", region=region, any_region=True))


def row(name: str, region: str, found: Fitted) -> list[str]:
    """What the table holds of a fit."""
    quality = found.stored.quality
    texture = found.stored.texture.to_dict()
    slow = texture["modulation"]
    cells = [name, region, f"{texture['marginal']['shape']:.3g}", "-" if slow is None else f"{slow['shape']:.2g}"]
    for own, plain in zip(quality["filtered_rates"], quality["gaussian_filtered_rates"], strict=True):
        cells += [f"{own['first_over_gaussian']:.3g}", f"{own['second_over_first']:.2f}", f"{plain['second_over_first']:.2f}"]
    values = quality["marginal"]["ks"], quality["spectrum_distance_db"], quality["correlation_distance"]
    return [*cells, *(f"{v:.2g}" for v in values)]


def main() -> None:
    """Fit, tell, write."""
    rows, shown = [], None
    with tempfile.TemporaryDirectory() as folder:
        found = shown = judged(rendered(Path(folder)), None)
        rows.append(row("rendered glint, 50 frames", "all", found))
    data = os.environ.get("SEAGLINT_DATA_DIR")
    for name, region in MEASURED if data else ():
        found = judged(open_recording(Path(str(data)) / "imagery" / f"{name}.png", channel="mean"), region)
        rows.append(row(name, region, found))
    head = ["data", "region", "gamma shape", "slow shape", "3 sigma, times Gaussian tail", "gamma field / data", "Gaussian field / data"]
    head += ["3.5 sigma", "gamma field / data", "Gaussian field / data", "KS", "spectra [dB]", "correlation"]
    lines = table(head, rows)
    print("\n".join(lines))
    if "--print" in sys.argv[1:]:
        return
    PAGE.write_text(replace(PAGE.read_text(encoding="utf-8"), "textures", lines), encoding="utf-8")
    draw_pictures(shown.comparison, shown.data, shown.sample).savefig(IMAGES / "texture_pictures.png", dpi=80, metadata={"Software": None})
    draw_measures(shown.comparison, shown.gaussian).savefig(IMAGES / "texture_measures.png", dpi=80, metadata={"Software": None})
    assert np.isfinite(shown.sample).all()


if __name__ == "__main__":
    main()
