"""Fit gamma textures to a rendered glint sequence and to measured pictures, and write what they miss into docs/validation/textures.md.

    python docs/figures/texture_table.py            table, and the pictures of docs/guide/textures.md
    python docs/figures/texture_table.py --print    table on the terminal only

The rendered sequence is made here. Measured pictures come from the folder that ``data_folders.py`` finds; without
it their rows are left out.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import numpy as np

from pictures import save
from seaglint.analysis.recording import Recording
from seaglint.formats.recording import open_recording
from seaglint.plot.texture_report import draw_measures, draw_pictures
from seaglint.scenario.load import parse_scenario
from seaglint.studies.sequence.render_sequence import render
from seaglint.studies.study_requests import FitRequest
from seaglint.studies.texture.texture_sequences import STILL, Fitted, detrended, fit, frames_of, sample_like
from seaglint.textures.gaussian_texture import fit_texture
from seaglint.textures.quality import compare
from seaglint.textures.suitability import parse_region
from validation_tables import DOCS, ROOT, table, write_table

sys.path.append(str(ROOT / "tools"))
from data_folders import data_folder

IMAGES = DOCS / "images"

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

MEASURED = (("Misc_66", "120:250,90:230"), ("Misc_66", "50:125,100:300"), ("Misc_107", "145:215,150:290"), ("Misc_26", "20:120,100:225"))
"""Pictures and regions: the glint corridor, its flank and two seas, without the boats (rows and columns in the pictures' XML files)."""

BOAT = ("Misc_107", "110:215,150:290")
"""A region with a boat in it: what a few pixels of a target do to a fit."""


def rendered(folder: Path, **wind: float) -> Recording:
    """The glint sequence; ``wind`` replaces values of the table ``[wind]``."""
    return open_recording(render(parse_scenario({**GLINT, "wind": {**GLINT["wind"], **wind}}), folder / "glint.zarr"))


def judged(recording: Recording, region: str | None, *, detrend: bool = False) -> Fitted:
    """A gamma texture, of the picture as it is, the boat included, or with slow changes taken off."""
    return fit(recording, FitRequest(tails="gamma", region=region, any_region=True, detrend=detrend, keep_defects=True))


def held_out(recording: Recording, region: str | None, *, detrend: bool = False) -> list[tuple[float | None, float | None]]:
    """Rates of the gamma and of the Gaussian field over those of data that neither has seen, at 3 and 3.5 sigma.

    Fitted to the first half of the frames, of a picture to the left half, and compared with the other.
    """
    whole = frames_of(recording, parse_region(region or ":,:", recording.rows, recording.columns))
    parts = np.array_split(whole, 2, axis=0 if len(whole) >= 2 * STILL else 2)
    seen, kept = (detrended(part) if detrend else part for part in parts)
    found = []
    for tails in ("gamma", "gaussian"):
        drawn = sample_like(fit_texture(seen, tails).texture, kept, 0)  # type: ignore[arg-type]
        rates = compare(kept, drawn, consecutive=False).as_dict()["filtered_rates"]
        found.append([entry["second_over_first"] for entry in rates])
    return list(zip(*found, strict=True))


def ratio(value: float | None) -> str:
    """A ratio of rates for the table; none where one of the two has no pixel above the threshold."""
    return "none" if value is None else f"{value:.2f}"


def row(name: str, region: str, found: Fitted, unseen: list[tuple[float | None, float | None]]) -> list[str]:
    """What the table holds of a fit."""
    quality = found.stored.quality
    texture = found.stored.texture.to_dict()
    slow = texture["modulation"]
    cells = [name, region, f"{texture['marginal']['shape']:.3g}", "-" if slow is None else f"{slow['shape']:.2g}"]
    for own, plain, other in zip(quality["filtered_rates"], quality["gaussian_filtered_rates"], unseen, strict=True):
        pair = f"{ratio(own['second_over_first'])}, {ratio(other[0])}", f"{ratio(plain['second_over_first'])}, {ratio(other[1])}"
        cells += [f"{own['first_over_gaussian']:.3g}", *pair]
    values = quality["marginal"]["ks"], quality["spectrum_distance_db"], quality["correlation_distance"]
    return [*cells, *(f"{v:.2g}" for v in values)]


def main() -> None:
    """Fit, tell, write."""
    rows, shown = [], None
    with tempfile.TemporaryDirectory() as folder:
        sequence = rendered(Path(folder))
        found = shown = judged(sequence, None)
        rows.append(row("rendered glint, 50 frames", "all", found, held_out(sequence, None)))
    data = data_folder("SEAGLINT_DATA_DIR")
    for name, region in (*MEASURED, BOAT) if data else ():
        picture = open_recording(Path(str(data)) / "imagery" / f"{name}.png", channel="mean")
        for off in (False, True):
            told = name + (", with the boat" if (name, region) == BOAT else "") + (", slow changes off" if off else "")
            rows.append(row(told, region, judged(picture, region, detrend=off), held_out(picture, region, detrend=off)))
    head = [
        "data",
        "region",
        "gamma shape",
        "slow shape",
        "3 sigma, times Gaussian tail",
        "gamma field / data, held out",
        "Gaussian field / data, held out",
    ]
    head += ["3.5 sigma", "gamma field / data, held out", "Gaussian field / data, held out", "KS", "spectra [dB]", "correlation"]
    lines = table(head, rows)
    print("\n".join(lines))
    if "--print" in sys.argv[1:]:
        return
    write_table("textures", lines)
    save(draw_pictures(shown.comparison, shown.data, shown.sample), IMAGES / "texture_pictures.png", dpi=80)
    save(draw_measures(shown.comparison, shown.gaussian), IMAGES / "texture_measures.png", dpi=80)
    assert np.isfinite(shown.sample).all()


if __name__ == "__main__":
    main()
