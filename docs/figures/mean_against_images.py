"""Mean maps against images averaged over independent seas, over wind, Sun, depression and azimuth off the Sun.

    python docs/figures/mean_against_images.py [--seas 16] [--csv FILE]

Markdown goes to standard output: of each wind and Sun the departure of the radiance, and of the glint over what Smith's law for both legs
has, that is largest beyond two standard errors of the seas. The file has all places: radiance, glint and errors of the image, and of the
mean model.
"""

from __future__ import annotations

import argparse
import csv
from dataclasses import replace

import numpy as np

from seaglint.facet.legs import BOTH
from seaglint.imaging.camera.imager import Camera
from seaglint.imaging.scene import Accuracy, image
from seaglint.imaging.upright_scene import SweptScene
from seaglint.radiance.mean_radiance import mean_radiance
from seaglint.scenario.load import parse_scenario
from seaglint.studies.build import scenario_physics

WINDS = (3.0, 7.0, 12.0)
SUNS = (60.0, 75.0, 80.0, 85.0, 88.5)
DEPRESSIONS = (0.5, 0.7, 1.0, 1.5, 2.0, 3.0, 5.0, 8.0, 12.0, 15.0)
AZIMUTHS = (0.0, 5.0, 20.0)
HEIGHT = 30.0
COLUMN = 0.25  # deg

Row = dict[str, float]


def scene(wind: float, sun: float, seas: int) -> list[Row]:
    """Rows of one wind and Sun; the camera looks towards the Sun's azimuth and aside from it."""
    scenario = parse_scenario(
        {
            "sun": {"zenith_deg": sun, "azimuth_deg": 0},
            "wind": {"speed_m_s": wind, "from_deg": 30},
            "sensor": {"height_m": HEIGHT},
            "render": {"subpixel_glint": "off"},
        }
    )
    view = scenario_physics.view(scenario)
    sea = scenario_physics.sea(scenario, view.slopes)
    out: list[Row] = []
    for azimuth in AZIMUTHS:
        for parts in (DEPRESSIONS[:5], DEPRESSIONS[5:]):
            low, high = 0.94 * parts[0], 1.06 * parts[-1]
            count = int(np.ceil((high - low) / (0.02 * parts[0])))
            camera = Camera(
                HEIGHT, np.radians(azimuth), -np.radians(0.5 * (low + high)), np.radians(COLUMN), np.radians(high - low), 1, count
            )
            made = SweptScene.prepare(view, camera, sea.waves, accuracy=Accuracy())
            depression = -np.degrees(camera.elevations)
            model = mean_radiance(view, camera.elevations, camera.azimuths)
            smith = mean_radiance(replace(view, shadowing=BOTH), camera.elevations, camera.azimuths)
            found = np.empty((seas, 2, len(parts)))
            rows = [np.abs(depression / d - 1.0) < 0.05 for d in parts]
            for i in range(seas):
                seen = image(made.reseeded(i), made.pose, 0.0)
                for j, part in enumerate(rows):
                    found[i, :, j] = seen.radiance[part].mean(dtype=float), seen.glint_radiance[part].mean(dtype=float)
            mean, error = found.mean(axis=0), found.std(axis=0, ddof=1) / np.sqrt(seas)
            for j, (d, part) in enumerate(zip(parts, rows, strict=True)):
                radiance, glint, plain = (
                    float(np.broadcast_to(a, model.total.shape)[part].mean()) for a in (model.total, model.sun, smith.sun)
                )
                out.append(
                    {
                        "wind_speed_m_s": wind,
                        "solar_zenith_deg": sun,
                        "azimuth_deg": azimuth,
                        "depression_deg": d,
                        "radiance_ratio": mean[0, j] / radiance,
                        "radiance_error": error[0, j] / radiance,
                        "glint_image": mean[1, j],
                        "glint_mean": glint,
                        "glint_smith": plain,
                        "glint_error": error[1, j],
                    }
                )
    return out


def largest(rows: list[Row], azimuth: float) -> tuple[str, str]:
    """Departures of radiance and of glint towards an azimuth, as the table has them."""
    here = [row for row in rows if row["azimuth_deg"] == azimuth]
    ratio = max(here, key=lambda row: abs(row["radiance_ratio"] - 1.0) - 2.0 * row["radiance_error"])
    apart = max(
        here, key=lambda row: (abs(row["glint_image"] - row["glint_mean"]) - 2.0 * row["glint_error"]) / max(row["glint_smith"], 1e-30)
    )
    glint, error = (
        value / max(apart["glint_smith"], 1e-30) for value in (apart["glint_image"] - apart["glint_mean"], apart["glint_error"])
    )
    return (
        f"{ratio['radiance_ratio']:.3f} ± {ratio['radiance_error']:.3f} at {ratio['depression_deg']:g}°",
        f"{glint:+.3f} ± {error:.3f} at {apart['depression_deg']:g}°",
    )


def main() -> None:
    """Print the table, and write all rows."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seas", type=int, default=16, help="independent seas")
    parser.add_argument("--csv", help="file for all rows")
    options = parser.parse_args()
    rows: list[Row] = []
    print("| wind | Sun's zenith angle | towards the Sun: largest departure of the radiance; of the glint, of Smith's | 5° aside |")
    print("| --- | --- | --- | --- |")
    for wind in WINDS:
        for sun in SUNS:
            some = scene(wind, sun, options.seas)
            print(f"| {wind:g} m/s | {sun:g}° | {'; '.join(largest(some, 0.0))} | {largest(some, 5.0)[0]} |", flush=True)
            rows += some
    if options.csv:
        with open(options.csv, "w", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, rows[0])
            writer.writeheader()
            writer.writerows(rows)


if __name__ == "__main__":
    main()
