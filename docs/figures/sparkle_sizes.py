"""Measure glint against the size of pixels with both sparkles: docs/data/sparkle_sizes.csv, a table and a picture.

    python docs/figures/sparkle_sizes.py        12 frames of the finest pixels, some minutes on two cores
    python docs/figures/sparkle_sizes.py 40     more frames, smaller errors

The sea and the Sun are those of the default scene, seen in 4 x 2 degrees of the glint by pixels of a quarter to four times its pixels, with
``sea.glint.correlation`` "time" and "waves" and without sparkle. The mirrored Sun is divided by its mean by the mean-radiance model, which
removes the trend. Rates count values more than a number of standard deviations above the mean, as they are and behind the Laplacian filter.
Coarse pixels are few, so that more frames of them are rendered.
"""

from __future__ import annotations

import csv
import math
import sys
from collections.abc import Iterator
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from scipy.stats import norm

from pictures import save_named
from seaglint.base.conventions import FloatArray
from seaglint.clutter.filters import Laplacian
from seaglint.imaging.scene import image
from seaglint.imaging.sparkle_settings import relative_variance
from seaglint.radiance.mean_radiance import mean_radiance
from seaglint.scenario.load import parse_scenario
from seaglint.scenario.model import Scenario
from seaglint.studies.build import scenario_physics
from seaglint.studies.sequence.render_sequence import prepare_sequence
from validation_tables import DOCS, table, write_table

OUTPUT = DOCS / "data" / "sparkle_sizes.csv"
SCALES = (0.25, 0.5, 1.0, 2.0, 4.0)
PIXELS = (128, 64)  # of the default scene's 0.03125 deg
FOV_DEG = (4.0, 2.0)
APART = 7.0  # s: several periods of the waves that pixels resolve
THRESHOLDS = (3.0, 3.5)
#: Rates by name, and the Gaussian's.
RATES = {f"{kind}{m:g}_sigma": float(norm.sf(m)) for kind in ("", "filtered_") for m in THRESHOLDS}
SPARKLES = ("waves", "time", "off")
CORRELATION_TIME = 0.07  # s
FRAMES = 12
MORE = {0.25: 1, 0.5: 1, 1.0: 2, 2.0: 3, 4.0: 5}  # times as many frames


def scenario(scale: float, sparkle: str) -> Scenario:
    """Scene with pixels of a multiple of the default ones."""
    pixels = [round(size / scale) for size in PIXELS]
    glint: dict[str, Any] = (
        {"correlation": "time", "correlation_time_s": CORRELATION_TIME} if sparkle == "time" else {"correlation": "waves"}
    )
    return parse_scenario(
        {
            "sensor": {"fov_deg": FOV_DEG, "pixels": pixels},
            "sea": {"glint": glint},
            "render": {"subpixel_glint": "off" if sparkle == "off" else "on", "layers": ["glint_radiance"]},
        }
    )


def relative_glint(scale: float, sparkle: str, frames: int) -> tuple[FloatArray, float]:
    """Mirrored Sun over its mean (frames, rows, columns), and the closed form of the sparkle's relative variance (0 without)."""
    one = scenario(scale, sparkle)
    run, camera = prepare_sequence(one).scene, scenario_physics.camera(one)
    mean = mean_radiance(run.view, camera.elevations, camera.azimuths).sun
    seen = np.stack([image(run, run.pose, APART * number)["glint_radiance"] for number in range(frames)])
    expected = 0.0 if sparkle == "off" else relative_variance(run.view, camera, scenario_physics.glint_correlation(one))
    return np.asarray(seen / mean, np.float64), expected


def averaged(values: FloatArray) -> FloatArray:
    """Means over 2 x 2 pixels."""
    count, rows, columns = values.shape
    return np.asarray(values.reshape(count, rows // 2, 2, columns // 2, 2).mean((2, 4)))


def statistics(values: FloatArray) -> FloatArray:
    """Relative variance, and the rates beyond each threshold, plain and behind the filter."""
    laplacian = Laplacian()
    edge = laplacian.margin
    filtered = np.asarray(laplacian.apply(values.astype(np.float32)), np.float64)[:, edge:-edge, edge:-edge]
    rates = [float((one > one.mean() + m * one.std()).mean()) for one in (values, filtered) for m in THRESHOLDS]
    return np.array([values.var() / values.mean() ** 2, *rates])


def with_errors(values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Statistics and their standard errors by omission of one frame."""
    count = len(values)
    without = np.array([statistics(np.delete(values, i, axis=0)) for i in range(count)])
    return statistics(values), without.std(0) * math.sqrt(count - 1.0)


def rows_of(sparkle: str, frames: int) -> Iterator[dict[str, Any]]:
    """One row for each size of pixels, the finest first."""
    finer: FloatArray | None = None
    for scale in SCALES:
        values, expected = relative_glint(scale, sparkle, frames * MORE[scale])
        seen, error = with_errors(values)
        coarse = math.nan if finer is None else float(statistics(averaged(finer))[0] / statistics(values[: len(finer)])[0])
        row = {"sparkle": sparkle, "pixels_over_default": scale, "mean": float(values.mean())}
        row |= {"variance": seen[0], "variance_error": error[0], "closed_form": expected, "finer_averaged_over_this": coarse}
        for i, name in enumerate(RATES):
            row |= {f"rate_{name}": seen[1 + i], f"error_{name}": error[1 + i]}
        yield row
        finer = values
        print(sparkle, scale, np.round(seen, 5), f"closed {expected:.4f}, finer averaged {coarse:.3f}", file=sys.stderr, flush=True)


def read() -> dict[tuple[str, float], dict[str, float]]:
    """Rows of the file by sparkle and size."""
    with OUTPUT.open(encoding="utf-8") as file:
        return {
            (row["sparkle"], float(row["pixels_over_default"])): {k: float(v) for k, v in row.items() if k != "sparkle"}
            for row in csv.DictReader(file)
        }


def lines(rows: dict[tuple[str, float], dict[str, float]]) -> Iterator[str]:
    """The table of the page."""
    body = []
    for sparkle in SPARKLES:
        for scale in SCALES:
            row = rows[sparkle, scale]
            added = row["variance"] - rows["off", scale]["variance"]
            times = (f"{row[f'rate_{name}'] / tail:.2g} ± {row[f'error_{name}'] / tail:.1g}" for name, tail in RATES.items())
            coarse = row["finer_averaged_over_this"]
            body.append(
                (
                    f"{sparkle}, {scale:g}", f"{row['variance']:.3g} ± {row['variance_error']:.1g}", f"{1.0 / row['variance']:.3g}",
                    "-" if sparkle == "off" else f"{added:.3g}", "-" if sparkle == "off" else f"{row['closed_form']:.3g}", *times,
                    "-" if math.isnan(coarse) else f"{coarse:.2f}",
                )
            )  # fmt: skip
    head = ("sparkle, pixel / 0.55 mrad", "variance / mean²", "gamma shape", "from sparkle", "closed form", "times Gaussian, 3 sigma",
            "3.5 sigma", "filtered, 3 sigma", "filtered, 3.5 sigma", "finer averaged down / this")  # fmt: skip
    yield from table(head, body)


def picture(rows: dict[tuple[str, float], dict[str, float]]) -> Figure:
    """Gamma shape and rates against the size of pixels."""
    figure = Figure(figsize=(12, 3.8), layout="constrained")
    first, plain, filtered = figure.subplots(1, 3)
    for colour, sparkle in zip(("tab:blue", "tab:red", "0.5"), SPARKLES, strict=True):
        label = {"waves": "from the waves", "time": "70 ms", "off": "none"}[sparkle]
        variance, error = (np.array([rows[sparkle, s][key] for s in SCALES]) for key in ("variance", "variance_error"))
        first.errorbar(SCALES, 1.0 / variance, error / variance**2, fmt="o-", ms=4, color=colour, label=label)
        for name, tail in RATES.items():
            axes, style = filtered if name.startswith("filtered") else plain, "o-" if name.endswith("3_sigma") else "s--"
            times, error = (np.array([rows[sparkle, s][f"{key}_{name}"] for s in SCALES]) / tail for key in ("rate", "error"))
            axes.errorbar(SCALES, times, error, fmt=style, ms=4, color=colour, label=f"{label}, {name.split('_')[-2]} sigma")
    first.set(ylabel="gamma shape, mean² / variance [1]", yscale="log")
    first.set_yticks([2, 3, 5, 10, 15], ["2", "3", "5", "10", "15"])
    plain.set(ylabel="rate / Gaussian rate [1]", yscale="log", ylim=(0.05, 60.0))
    filtered.set(ylabel="the same, behind the Laplacian filter [1]", yscale="log", ylim=(0.05, 60.0))
    for axes in (first, plain, filtered):
        axes.set(xscale="log", xlabel="pixel / 0.55 mrad")
        axes.set_xticks(SCALES, [f"{scale:g}" for scale in SCALES])
        axes.minorticks_off()
        axes.grid(alpha=0.3)
        axes.legend(fontsize=8)
    return figure


def main(frames: str = str(FRAMES)) -> None:
    """Render, and write file, table and picture."""
    made = [row for sparkle in SPARKLES for row in rows_of(sparkle, int(frames))]
    with OUTPUT.open("w", newline="", encoding="utf-8") as file:
        out = csv.DictWriter(file, made[0].keys(), lineterminator="\n")
        out.writeheader()
        out.writerows({key: f"{value:.5g}" if isinstance(value, float) else value for key, value in row.items()} for row in made)
    rows = read()
    text = list(lines(rows))
    print(*text, sep="\n")
    write_table("sparkle-sizes", text)
    save_named({"sparkle_sizes": lambda: picture(rows)}, [])


if __name__ == "__main__":
    main(*sys.argv[1:])
