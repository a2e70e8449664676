"""What a sensor does to the tails of the default scene: the table in docs/guide/sensor.md, and docs/data/sensor_rates.csv.

    python docs/figures/sensor_rates.py            8 frames, some minutes on two cores
    python docs/figures/sensor_rates.py 20         more frames, narrower intervals

The same fine pictures give the aperture's radiance averaged over pixels, what the optics leave of it, and counts with noise. Rates are
those of the Laplacian filter over the glint corridor and over all sea in view, a standard deviation for each picture.
"""

from __future__ import annotations

import csv
import sys
from typing import Any

import numpy as np

from seaglint.analysis.analyze_recording import ALWAYS
from seaglint.base.conventions import horizon_depression
from seaglint.clutter.false_alarms import FalseAlarms
from seaglint.clutter.filters import Laplacian
from seaglint.clutter.thresholds import standardise
from seaglint.scenario.load import parse_scenario
from seaglint.studies.article.table1 import corridor
from seaglint.studies.build import scenario_physics
from seaglint.studies.sequence.sensed_sequence import binned, prepare_sensed
from validation_tables import DOCS, replace, table

GUIDE = DOCS / "guide" / "sensor.md"
OUTPUT = DOCS / "data" / "sensor_rates.csv"
SENSORS = {"F/2": {"f_number": 2.0}, "F/4, 0.5 pixels of jitter": {"f_number": 4.0, "jitter_urad": 270.0}}
DETECTOR = {"pitch_um": 15.0, "integration_time_s": 5e-4, "well_capacity_e": 2e7, "read_noise_e": 600.0, "bit_depth": 16}
APART = 1.0


def pictures(optics: dict[str, float], frames: int) -> tuple[Any, dict[str, np.ndarray]]:
    """The three kinds of pictures of one sensor [(frames, rows, columns)]."""
    sensor = {"optics": {"focal_length_m": 0.0275019, **optics}, "detector": DETECTOR, "frame_rate_hz": 1.0 / APART}
    run = prepare_sensed(parse_scenario({"sensor": sensor}))
    model = run.sensed.model
    found: dict[str, list[np.ndarray]] = {"aperture": [], "optics": [], "counts": []}
    for number in range(frames):
        fine = run.fine.at(APART * number)
        seen = model.focal_plane(fine.radiance, run.sensed.oversampling)
        exposed = model.expose(seen, number)
        found["aperture"].append(binned(fine, run.sensed.oversampling)["radiance"])
        found["optics"].append(seen)
        found["counts"].append(model.readout.radiance(exposed.signal).astype(np.float32))
        print(f"{optics}: frame {number}, saturated {exposed.saturated_share:.2g}", file=sys.stderr)
    return run, {name: np.stack(values) for name, values in found.items()}


def rows_of(name: str, optics: dict[str, float], frames: int) -> list[dict[str, Any]]:
    """Rates before and after one sensor."""
    run, found = pictures(optics, frames)
    scenario = run.fine_scenario
    coarse = scenario.model_copy(update={"sensor": scenario.sensor.model_copy(update={"pixels": (512, 256)})})
    camera = scenario_physics.camera(coarse)
    below = camera.elevations < -horizon_depression(camera.height) - 2.0 * camera.row_step
    regions = {"corridor": corridor(run.fine.scene.view, camera) & below[:, None], "sea": np.repeat(below[:, None], camera.columns, axis=1)}
    out = []
    for kind, sequence in found.items():
        filtered = Laplacian().apply(sequence)
        for region, mask in regions.items():
            alarms = FalseAlarms(ALWAYS)
            alarms.add(standardise(filtered, mask))
            values = sequence[:, mask]
            for rate in alarms.rates():
                out.append(
                    {
                        "sensor": name, "picture": kind, "region": region, "threshold_sigma": rate.threshold_sigma, "rate": rate.rate,
                        "low": rate.rate_low, "high": rate.rate_high, "std": float(values.std()),
                        "filtered_std": float(filtered[:, mask].std()),
                    }
                )  # fmt: skip
    return out


def main() -> None:
    """Write the table and the file."""
    frames = int(sys.argv[1]) if len(sys.argv) > 1 else 8
    rows = [row for name, optics in SENSORS.items() for row in rows_of(name, optics, frames)]
    with OUTPUT.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, rows[0].keys())
        writer.writeheader()
        writer.writerows({key: f"{value:.6g}" if isinstance(value, float) else value for key, value in row.items()} for row in rows)
    lines = []
    for name in SENSORS:
        for region in ("corridor", "sea"):
            for kind in ("aperture", "optics", "counts"):
                three, more = (r for r in rows if (r["sensor"], r["region"], r["picture"]) == (name, region, kind))
                spread = (f"{three['std']:.3g}", f"{three['filtered_std']:.3g}")
                lines.append((name, region, kind, *spread, f"{three['rate']:.4f}", f"{more['rate']:.4f}"))
    heads = ("sensor", "region", "picture", "std [W m⁻² sr⁻¹]", "filtered", "rate at 3 σ", "at 3.5 σ")
    made = list(table(heads, lines))
    print(*made, sep="\n")
    GUIDE.write_text(replace(GUIDE.read_text(encoding="utf-8"), "rates", made), encoding="utf-8")


if __name__ == "__main__":
    main()
