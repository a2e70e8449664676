"""Fit textures to thirteen measured pictures and to rendered seas, and write what they miss into docs/validation/textures.md.

    python docs/figures/texture_table.py            tables, and the pictures of docs/guide/textures.md
    python docs/figures/texture_table.py --print    tables on the terminal only

Each picture is divided into halves. The law is chosen and fitted with one half alone, and its rates are compared with the other half; then
the reverse. The rendered sequences are made here. Measured pictures come from the folder that ``data_folders.py`` finds; without it their
rows are left out.
"""

from __future__ import annotations

import math
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from pictures import save
from seaglint.analysis.recording import Recording
from seaglint.base.threads import single_threaded_algebra
from seaglint.clutter.rate_ratios import RateRatio, rate_ratio
from seaglint.formats.recording import open_recording
from seaglint.plot.texture_report import draw_measures, draw_pictures
from seaglint.scenario.load import parse_scenario
from seaglint.studies.sequence.render_sequence import render
from seaglint.studies.study_requests import FitRequest
from seaglint.studies.texture.counted_pixels import counted_pixels
from seaglint.studies.texture.texture_sequences import Fitted, detrended, fit, frames_of
from seaglint.textures.gaussian_texture import FieldsOf, TextureLaw
from seaglint.textures.law_choice import LAWS, Frames, choose_law, halves, judge_laws, laplacian_rates, sampled_rates
from seaglint.textures.suitability import parse_region
from validation_tables import DOCS, ROOT, table, write_table

sys.path.append(str(ROOT / "tools"))
from data_folders import data_folder

IMAGES = DOCS / "images"

FACTOR = 1.5  #: Ratio of rates within which a texture holds.

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

LONGWAVE = {**GLINT, "band": {"min_um": 8.0, "max_um": 12.0}, "sun": {"zenith_deg": 60, "azimuth_deg": 0}}
"""The same sea in 8-12 um, with the Sun behind the sensor: emission and reflected sky."""

RENDERED = (
    ("rendered glint, 2 m/s", GLINT, 2.0),
    ("rendered glint, 5 m/s", GLINT, 5.0),
    ("rendered 8-12 µm, 4 m/s", LONGWAVE, 4.0),
    ("rendered 8-12 µm, 8 m/s", LONGWAVE, 8.0),
)

#: Pictures and their parts below the horizon, without surf and shore (rows and columns).
MEASURED = (
    ("Misc_2", "165:255,45:285"),
    ("Misc_4", "152:276,3:345"),
    ("Misc_12", "176:236,3:315"),
    ("Misc_20", "146:272,3:299"),
    ("Misc_24", "82:204,4:340"),
    ("Misc_25", "152:212,4:330"),
    ("Misc_26", "60:258,4:341"),
    ("Misc_28", "142:253,3:297"),
    ("Misc_38", "152:252,3:316"),
    ("Misc_44", "95:195,3:298"),
    ("Misc_66", "60:250,3:316"),
    ("Misc_71", "226:253,40:280"),
    ("Misc_107", "3:217,4:294"),
)


def rendered(folder: Path, scenario: dict[str, object] = GLINT, **wind: float) -> Recording:
    """A rendered sequence; ``wind`` replaces values of the table ``[wind]``."""
    return open_recording(render(parse_scenario({**scenario, "wind": {**scenario["wind"], **wind}}), folder / "glint.zarr", overwrite=True))


def prepared(recording: Recording, region: str | None) -> Frames:
    """The region without its defects and objects."""
    part = parse_region(region or ":,:", recording.rows, recording.columns)
    return counted_pixels(frames_of(recording, part), recording, part).frames


def predicted(seen: Frames, other: Frames, law: TextureLaw | None = None) -> tuple[TextureLaw, list[RateRatio]]:
    """Law chosen by and fitted to one half alone, or the given one, and ratios of its rates to those of the other half."""
    fields = FieldsOf(seen)
    offsets = fields.fit(TextureLaw("gaussian")).texture.field.offsets
    parts = halves(seen)
    if law is None:
        law = TextureLaw("empirical") if parts is None else choose_law(judge_laws(parts, LAWS, offsets, 0)).law
    sampled = sampled_rates(fields.fit(law).texture, other.shape, 0)
    return law, [rate_ratio(a, b) for a, b in zip(laplacian_rates(other), sampled, strict=True)]


def row(name: str, region: str, recording: Recording, *, trend: bool) -> tuple[list[str], list[RateRatio], Fitted]:
    """One row of the table, its ratios, and the texture of the whole."""
    found = fit(recording, FitRequest(region=region if region != "all" else None, any_region=True, detrend=trend))
    parts = halves(prepared(recording, None if region == "all" else region))
    assert parts is not None
    first, second = (detrended(part) if trend else part for part in parts)
    cells, ratios, plain = [name, region, found.stored.texture.law.name], [], []  # type: ignore[union-attr]
    for seen, other in ((first, second), (second, first)):
        law, ours = predicted(seen, other)
        ratios += ours
        plain += predicted(seen, other, TextureLaw("gaussian"))[1]
        cells += [law.name, *(ratio.text for ratio in ours)]
    quality = found.comparison.distances
    cells.append(", ".join(f"{ratio.value:.2f}" if ratio.value is not None else "-" for ratio in plain))
    measures = (quality.marginal.ks, quality.spectrum_distance_db, quality.correlation_distance)
    return [*cells, " / ".join(f"{v:.2g}" for v in measures)], ratios, found


def counts(ratios: list[RateRatio]) -> tuple[int, int, int, int]:
    """Ratios within the factor, intervals that contain 1, and intervals within and beyond the factor."""
    within = sum(r.value is not None and r.value > 0.0 and abs(math.log(r.value)) <= math.log(FACTOR) for r in ratios)
    one = sum(r.low is not None and r.low <= 1.0 <= (math.inf if r.high is None else r.high) for r in ratios)
    verdicts = [r.verdict(FACTOR) for r in ratios]
    return within, one, verdicts.count("holds"), verdicts.count("differs")


@single_threaded_algebra()
def main() -> None:
    """Fit, judge, write."""
    rows, every, shown = [], [], None
    began = time.process_time()
    with tempfile.TemporaryDirectory() as folder:
        for name, scenario, speed in RENDERED:
            cells, ratios, found = row(name, "all", rendered(Path(folder), scenario, speed_m_s=speed), trend=False)
            shown = shown or found
            rows.append(cells)
            every.append((False, ratios))
    data = data_folder("SEAGLINT_DATA_DIR")
    for name, region in MEASURED if data else ():
        cells, ratios, _ = row(name, region, open_recording(Path(str(data)) / "imagery" / f"{name}.png", channel="mean"), trend=True)
        rows.append(cells)
        every.append((True, ratios))
    head = ("data", "region", "law, whole", "law, first half", "3 σ", "3.5 σ", "law, second half", "3 σ", "3.5 σ")
    lines = list(table((*head, "Gaussian field, 3 and 3.5 σ", "KS / spectra [dB] / correlation"), [tuple(cells) for cells in rows]))
    summary = []
    for measured, name in ((True, "thirteen measured pictures"), (False, "four rendered sequences")):
        for q, threshold in enumerate(("3 σ", "3.5 σ")):
            chosen = [ratio for kind, ratios in every if kind == measured for ratio in ratios[q::2]]
            within, one, holds, differs = counts(chosen)
            if chosen:
                summary.append((name, threshold, str(len(chosen)), str(within), str(one), str(holds), str(differs)))
    second = ("data", "threshold", "halves", f"ratio within {FACTOR:g}", "interval contains 1", "interval within it", "interval beyond it")
    total = list(table(second, summary))
    print("\n".join([*lines, "", *total]), f"\n{time.process_time() - began:.0f} s of processor time")
    if "--print" in sys.argv[1:]:
        return
    write_table("textures", lines)
    write_table("texture-counts", total)
    assert shown is not None
    save(draw_pictures(shown.comparison, shown.data, shown.sample), IMAGES / "texture_pictures.png", dpi=80)
    save(draw_measures(shown.comparison, shown.gaussian), IMAGES / "texture_measures.png", dpi=80)
    assert np.isfinite(shown.sample).all()


if __name__ == "__main__":
    main()
