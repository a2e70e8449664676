"""Ratio of rendered images to the mean-radiance model, against depression: resolved waves meet one-scale shadowing.

    python docs/figures/near_horizon_table.py [--frames N] [--csv docs/data/near_horizon.csv]
    python docs/figures/near_horizon_table.py --steep [--frames N]    steep views of twelve seas and Suns

Frames are independent realisations of the sea (``WaveField.reseeded``); a ratio is the mean image over the mean model in a band of
depressions, its standard error comes from the scatter of the frames. Markdown goes to standard output.
"""

from __future__ import annotations

import argparse
import csv
import math
import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from seaglint.air.protocol import Atmosphere
from seaglint.base.conventions import view_zenith
from seaglint.facet.legs import BOTH, NESTED
from seaglint.facet.sea_view import SeaView
from seaglint.imaging.camera.imager import Camera
from seaglint.imaging.scene import Accuracy, image
from seaglint.imaging.upright_scene import SweptScene
from seaglint.optics import sea_water
from seaglint.optics.band import Band
from seaglint.radiance.mean_radiance import mean_radiance
from seaglint.sea.shadowing.smith import smith_lambda, smith_nu
from seaglint.sea.slopes.cox_munk import cox_munk_anisotropic
from seaglint.sea.slopes.slope_statistics import SlopeStatistics
from seaglint.sea.spectra.elfouhaily import ElfouhailySpectrum
from seaglint.sea.tiles import plan_tiles, resolve_limit
from seaglint.sea.wave_field import WaveField
from seaglint.studies.build.profile_air import model_air

WIND = 10.0
DEPRESSIONS = (1.0, 2.0, 3.0, 4.0, 6.0, 10.0, 15.0)
SUN_ZENITHS = (30.0, 60.0, 77.0, 80.0, 85.0)
SHORTEST_WAVE = 0.5
HEIGHT = 30.0
BAND = Band.rectangular(3.5, 5.0)


@dataclass(frozen=True)
class Ratio:
    """Image over model in one band of depressions, for all radiance and for its solar part, with standard errors [1]."""

    depression_deg: float
    total: float
    total_error: float
    sun: float
    sun_error: float


def elfouhaily_sea(
    wind: float, travel: float, shortest_wave: float, *, points: int = 128, tiles: int = 4
) -> tuple[WaveField, SlopeStatistics]:
    """Waves of a fully developed sea and the slopes of Cox and Munk that they and the facets add up to."""
    spectrum, slopes = ElfouhailySpectrum(wind, travel), cox_munk_anisotropic(wind, travel)
    cut = min(2.0 * math.pi / shortest_wave, resolve_limit(spectrum, slopes))
    return WaveField.create(spectrum, plan_tiles(spectrum, 2.0 * math.pi / cut, points, tiles), 0), slopes


def sea_view(air: Atmosphere, slopes: SlopeStatistics, height: float, sun_zenith_deg: float) -> SeaView:
    """The Sun stands in the north, where the camera looks; the model shadows both legs by Smith's law."""
    sun = math.radians(sun_zenith_deg)
    return SeaView(air, BAND, sea_water.hale_querry_sea(), slopes, 288.15, height, sun, 0.0, shadowing=BOTH)


def ratios(
    view: SeaView,
    camera: Camera,
    waves: WaveField,
    bands: Sequence[tuple[float, float, float]],
    frames: range,
    *,
    step: float | None = None,
    shortest_wave_columns: float = 0.0,
) -> list[Ratio]:
    """Ratio of the mean over realisations, facets nested, to the model in ``bands`` of (name, lowest, highest depression) [deg]."""
    accuracy = Accuracy(step=step, shortest_wave_columns=shortest_wave_columns)
    scene = SweptScene.prepare(replace(view, shadowing=NESTED), camera, waves, accuracy=accuracy)
    depression = -np.degrees(camera.elevations)
    rows = [np.flatnonzero((depression >= low) & (depression <= high)) for _, low, high in bands]
    samples = np.empty((len(frames), 2, len(bands)))
    for i, seed in enumerate(frames):
        found = image(scene.reseeded(seed), scene.pose, 0.0)
        for j, part in enumerate(rows):
            samples[i, :, j] = float(found.radiance[part].mean(dtype=float)), float(found.glint_radiance[part].mean(dtype=float))
    model = mean_radiance(view, camera.elevations, camera.azimuths)
    found = []
    for j, (name, _, _) in enumerate(bands):
        expected = np.array([model.total[rows[j]].mean(), np.broadcast_to(model.sun, model.total.shape)[rows[j]].mean()])
        mean = samples[:, :, j].mean(axis=0) / expected
        error = samples[:, :, j].std(axis=0, ddof=1) / math.sqrt(len(frames)) / expected
        found.append(Ratio(name, float(mean[0]), float(error[0]), float(mean[1]), float(error[1])))
    return found


def near_horizon(sun_zenith_deg: float, frames: range, depressions: Sequence[float] = DEPRESSIONS) -> list[Ratio]:
    """One row of the table: a fully developed sea of 10 m/s that runs towards the sensor, seen towards the Sun from 30 m."""
    waves, slopes = elfouhaily_sea(WIND, math.pi, SHORTEST_WAVE)
    air = model_air("midlatitude-summer", WIND, (BAND.min_um, BAND.max_um))
    low, high = 0.9 * min(depressions), 1.06 * max(depressions)
    row = 0.02 * min(depressions)
    count = math.ceil((high - low) / row)
    camera = Camera(HEIGHT, 0.0, -math.radians(low + 0.5 * count * row), math.radians(6.0), math.radians(count * row), 8, count)
    bands = [(d, 0.95 * d, 1.05 * d) for d in depressions]
    return ratios(sea_view(air, slopes, HEIGHT, sun_zenith_deg), camera, waves, bands, frames)


STEEP = tuple((d, d - 1.0, d + 1.0) for d in (30.0, 40.0, 50.0, 60.0, 70.0, 80.0))
"""Bands of depressions of steep views: name, lowest, highest [deg]."""


def steep(wind: float, sun_zenith_deg: float, frames: range) -> list[Ratio]:
    """Ratios of a fully developed sea seen from 80 m towards the Sun, waves down to 0.5 m (or 80 % of the slopes) as geometry."""
    waves, slopes = elfouhaily_sea(wind, 0.75 * math.pi, SHORTEST_WAVE)
    air = model_air("midlatitude-summer", wind, (BAND.min_um, BAND.max_um))
    camera = Camera(80.0, 0.0, math.radians(-55.0), math.radians(16.0), math.radians(53.0), 8, 106)
    return ratios(sea_view(air, slopes, 80.0, sun_zenith_deg), camera, waves, STEEP, frames)


def bound(depression_deg: float) -> float:
    """``1 + Lambda`` of the whole sea's slopes along the view: no mean image exceeds the model by more [1]."""
    slopes = cox_munk_anisotropic(WIND, math.pi)
    theta: NDArray[np.float64] = view_zenith(HEIGHT, np.radians(depression_deg))
    return 1.0 + float(smith_lambda(smith_nu(theta, slopes.mss_along(0.0))))


def markdown(table: dict[float, list[Ratio]]) -> str:
    """The table of the glint's ratio, one row per Sun, with standard errors."""
    depressions = [r.depression_deg for r in next(iter(table.values()))]
    lines = ["| Sun's zenith angle | " + " | ".join(f"{d:g}°" for d in depressions) + " |", "|---" * (len(depressions) + 1) + "|"]
    lines += [f"| {zenith:g}° | " + " | ".join(f"{r.sun:.2f} ± {r.sun_error:.2f}" for r in found) + " |" for zenith, found in table.items()]
    lines.append("| bound 1 + Λ | " + " | ".join(f"{bound(d):.2f}" for d in depressions) + " |")
    return "\n".join(lines)


def main() -> None:
    """Compute the table, write it and print it."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--frames", type=int, default=300, help="independent seas per Sun")
    parser.add_argument("--csv", type=Path, help="file to write")
    parser.add_argument("--steep", action="store_true", help="steep views instead")
    options = parser.parse_args()
    if options.steep:
        for zenith in (30.0, 60.0, 80.0):
            for wind in (2.0, 5.0, 10.0, 15.0):
                found = steep(wind, zenith, range(options.frames))
                worst = max(found, key=lambda r: abs(r.total - 1.0))
                print(f"| {wind:g} m/s | {zenith:g}° | {100.0 * (worst.total - 1.0):+.2f} % at {worst.depression_deg:g}° ", end="")
                print(f"| {100.0 * worst.total_error:.2f} % | {100.0 * max(r.total_error for r in found):.2f} % |", flush=True)
        return
    table = {}
    for zenith in SUN_ZENITHS:
        table[zenith] = near_horizon(zenith, range(options.frames))
        print(f"Sun {zenith:g} deg done", file=sys.stderr, flush=True)
    if options.csv is not None:
        options.csv.parent.mkdir(parents=True, exist_ok=True)
        with options.csv.open("w", newline="", encoding="utf-8") as stream:
            write = csv.writer(stream, lineterminator="\n")
            write.writerow(
                [
                    "solar_zenith_deg",
                    "depression_deg",
                    "glint_ratio",
                    "glint_standard_error",
                    "total_ratio",
                    "total_standard_error",
                    "bound",
                ]
            )
            for zenith, found in table.items():
                for r in found:
                    values = (r.sun, r.sun_error, r.total, r.total_error, bound(r.depression_deg))
                    write.writerow([f"{zenith:g}", f"{r.depression_deg:g}", *(f"{v:.4f}" for v in values)])
    print(markdown(table))


if __name__ == "__main__":
    main()
