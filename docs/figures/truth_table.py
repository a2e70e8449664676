"""The sweep and the mean map against a sea of mirrors, over wind, its azimuth, the Sun and the depression of the view.

    python docs/figures/truth_table.py [--seas N] [--rays N] [--shortest M] [--winds ...] [--brief] [--csv FILE]

The Sun is a wide disc, for rays to find it: the renderer's and the map's are averaged over four Suns with the same variance about its
middle. No air. All have the slope variance of the same spectrum, cut at the shortest wave. Markdown goes to standard output.
"""

from __future__ import annotations

import argparse
import csv
import math
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from mirror_sea import CutSpectrum, mirror_sea, ripple_tiles, traced
from seaglint.air.vacuum import VacuumAtmosphere
from seaglint.base.constants import SOLAR_ANGULAR_RADIUS
from seaglint.base.conventions import FloatArray, view_zenith
from seaglint.facet.glint import GlintModel
from seaglint.facet.legs import NESTED
from seaglint.facet.sea_view import SeaView, sea_arc
from seaglint.facet.sunlight import turn_at
from seaglint.imaging.camera.imager import Camera
from seaglint.imaging.scene import Accuracy, image
from seaglint.imaging.upright_scene import SweptScene
from seaglint.optics.band import Band
from seaglint.optics.fresnel import reflectance
from seaglint.optics.sea_water import hale_querry_sea
from seaglint.sea.slopes.from_spectrum import nested_in, spectrum_slopes
from seaglint.sea.spectra.elfouhaily import ElfouhailySpectrum
from seaglint.sea.tiles import plan_tiles
from seaglint.sea.wave_field import WaveField

WINDS = (3.0, 7.0, 12.0)
BESIDE = (0.0, 50.0)
SUNS = (50.0, 75.0, 80.0, 85.0)
DEPRESSIONS = (1.0, 2.0, 3.0, 5.0, 10.0)
BAND = (3.95, 4.05)
HEIGHT = 30.0
LONGEST_RIPPLE = 3.0
LATTICE = 512
COLUMN = 1e-3
ROW_SHARE = 0.02
"""Row over depression: at 1 deg it is 34 m of sea, at 10 deg 3.4 m."""

PIXELS = (8, 4)
PLACES = 4
"""Rows and columns of a patch, and patches of a sea."""

WIDE = 3000.0
"""Patches lie anywhere in a square so wide [m]."""

DISC = 1.2
"""Radius of the Sun's disc, in deviations of the slopes across the wind as the mirror turns them; four points on it then stand for the
disc within half a per cent of the glint."""

WIDEST = 0.35, math.radians(4.0)
"""Largest radius of the disc over the Sun's elevation [1], and itself [rad]."""


@dataclass(frozen=True)
class Compared:
    """One row of the table: truth, renderer and map of one wind, Sun and depression."""

    wind: float
    beside: float
    depression: float
    sun: float
    glint: float
    """Mean of the truth, radiance over that of a white sea [1]."""
    shade: float
    """Share that waves leave of the Sun's way."""
    mean: float
    mean_error: float
    viewer: float
    deviation: float
    deviation_error: float
    truth_deviation: float
    slope: float
    slope_error: float
    mapped: float
    mapped_error: float
    mapped_viewer: float


def view_of(waves: WaveField, sun_deg: float, *, sunward: bool = True) -> SeaView:
    """View without air of a sea whose slopes are those of all its waves."""
    return SeaView(
        atmosphere=VacuumAtmosphere.for_band(*BAND),
        band=Band.rectangular(*BAND),
        water=hale_querry_sea(),
        slopes=nested_in(spectrum_slopes(waves.spectrum), waves.spectrum),
        sea_temperature=288.15,
        sensor_height=HEIGHT,
        solar_zenith=math.radians(sun_deg),
        shadowing=replace(NESTED, sun=sunward),
    )


def reflected(view: SeaView, nodes: int = 1025) -> FloatArray:
    """Reflectance times irradiance over the band at even cosines of incidence [W m-2]."""
    over = view.in_band
    return np.asarray(
        reflectance(np.linspace(0.0, 1.0, nodes)[:, None], view.water.index(over.wavenumber_cm)) @ (view.irradiance * over.weights)
    )


def camera_at(depression_deg: float) -> Camera:
    """Pixels about a depression, straight at the Sun's azimuth."""
    middle = math.radians(depression_deg)
    rows, columns = PIXELS
    return Camera(HEIGHT, 0.0, -middle, COLUMN * columns, ROW_SHARE * middle * rows, columns, rows)


def disc_radius(view: SeaView, depression_deg: float) -> float:
    """Radius of the disc [rad]: a share of the glint's width."""
    rise = math.sin(math.radians(depression_deg)) + math.cos(view.solar_zenith)
    widest = min(WIDEST[0] * (0.5 * math.pi - view.solar_zenith), WIDEST[1])
    return min(DISC * math.sqrt(min(view.slopes.mss_up, view.slopes.mss_cross)) * rise, widest)


def four_suns(view: SeaView, radius: float) -> list[SeaView]:
    """Views of the Sun above, below and beside the disc's middle, whose mean has the disc's variance."""
    a = math.sqrt(0.5 * (radius**2 - SOLAR_ANGULAR_RADIUS**2))
    aside = a / math.sin(view.solar_zenith)
    moved = ((a, 0.0), (-a, 0.0), (0.0, aside), (0.0, -aside))
    return [replace(view, solar_zenith=view.solar_zenith + up, solar_azimuth=view.solar_azimuth + side) for up, side in moved]


def mapped(view: SeaView, camera: Camera, table: FloatArray) -> float:
    """Mean radiance of the mirrored Sun in the camera's pixels by the mean model."""
    theta = view_zenith(camera.height, -camera.elevations)
    model = GlintModel.prepare(view.solar_zenith, view.solar_azimuth, view.slopes, view.shadowing)
    terms = np.ones((theta.size, 1))
    _, chance, cosine = model.grid(theta, camera.azimuths + np.pi, turn_at(sea_arc(camera.height, 0.5 * np.pi - theta)), terms)
    light = np.interp(cosine, np.linspace(0.0, 1.0, table.size), table)
    return float(np.mean(chance * light)) / (math.pi * SOLAR_ANGULAR_RADIUS**2)


def compare(
    wind: float,
    beside: float,
    *,
    depressions: Sequence[float] = DEPRESSIONS,
    suns: Sequence[float] = SUNS,
    seas: int = 12,
    rays: int = 200,
    shortest: float = 0.015,
    accuracy: Accuracy | None = None,
    legs: bool = True,
    seed: int = 1,
) -> Iterator[Compared]:
    """Rows of a wind and its azimuth beside the Sun's; ``rays`` are those of a pixel."""
    spectrum = CutSpectrum.of(ElfouhailySpectrum(wind, math.pi + math.radians(beside)), shortest)
    waves = WaveField.create(spectrum, plan_tiles(spectrum, LONGEST_RIPPLE, LATTICE), seed)
    ripples = WaveField.create(spectrum, ripple_tiles(LONGEST_RIPPLE, shortest), seed)
    fine = accuracy or Accuracy(shortest_wave_columns=0.0)
    rng = np.random.default_rng((seed, round(10.0 * wind), round(beside)))
    cameras = [camera_at(d) for d in depressions]
    views = [view_of(waves, sun) for sun in suns]
    radii = np.array([[disc_radius(view, d) for view in views] for d in depressions])
    table = reflected(views[0])
    truth = np.empty((len(depressions), seas, PLACES, *PIXELS, 2, len(suns), 2))
    drawn = np.empty((len(depressions), len(suns), 2 if legs else 1, seas, PLACES, *PIXELS))
    places = rng.uniform(0.0, WIDE, (seas, PLACES, 2))
    scenes = [
        [
            [
                [SweptScene.prepare(v, camera, waves, accuracy=fine) for v in four_suns(view_of(waves, sun, sunward=sunward), radii[k, j])]
                for sunward in (True, False)[: 2 if legs else 1]
            ]
            for j, sun in enumerate(suns)
        ]
        for k, camera in enumerate(cameras)
    ]
    for i in range(seas):
        here = waves.reseeded(seed + i)
        sea = mirror_sea(here, ripples.reseeded(seed + 1000 + i))
        for k, camera in enumerate(cameras):
            edges = (camera.azimuth - 0.5 * camera.width, camera.column_step, camera.top, camera.row_step)
            discs = np.array([(view.solar_zenith, 0.0, r) for view, r in zip(views, radii[k], strict=True)])
            instant = scenes[k][0][0][0].reseeded(seed + i).sea(scenes[k][0][0][0].pose, 0.0)
            for n, (east, north) in enumerate(places[i]):
                truth[k, i, n] = traced(sea, (east, north, HEIGHT), edges, PIXELS, discs, table, rays, rng)
                surface = instant.levels.surface(instant.lattices, (east, north))
                for j, of_sun in enumerate(scenes[k]):
                    for leg, four in enumerate(of_sun):
                        pose = replace(four[0].pose, east=east, north=north)
                        shown = [image(one, pose, 0.0, instant._replace(surface=surface)).glint_radiance for one in four]
                        drawn[k, j, leg, i, n] = np.mean(shown, axis=0, dtype=float)
    for k, depression in enumerate(depressions):
        for j, sun in enumerate(suns):
            maps = [
                float(np.mean([mapped(v, cameras[k], table) for v in four_suns(view_of(waves, sun, sunward=sunward), radii[k, j])]))
                for sunward in (True, False)[: 2 if legs else 1]
            ]
            yield _row((wind, beside, depression, sun), truth[k, ..., j, :], drawn[k, j], maps, float(table[-1]))


def _row(case: tuple[float, float, float, float], truth: FloatArray, swept: FloatArray, maps: list[float], white: float) -> Compared:
    """Figures of one case; ``truth`` (seas, places, rows, columns, halves, legs), ``swept`` (legs, seas, places, rows, columns)."""
    truth, swept = truth.reshape(len(truth), -1, *truth.shape[-2:]), swept.reshape(*swept.shape[:2], -1)
    lit, seen, drawn = truth[..., 1].mean(axis=-1), truth[..., 0].mean(axis=-1), swept[0]
    mean, error = _ratio(drawn.mean(axis=1), lit.mean(axis=1))
    # halves share no ray: their covariance is that of the pixels alone
    found = _deviations(truth[..., 1], drawn)
    n = len(drawn)
    left = np.array([_deviations(np.delete(truth[..., 1], i, axis=0), np.delete(drawn, i, axis=0)) for i in range(n)])
    errors = np.sqrt((n - 1) / n * np.sum((left - left.mean(axis=0)) ** 2, axis=0))
    whole, alone = float(lit.mean()), float(seen.mean())
    one = (swept[1].mean() / alone, maps[1] / alone) if len(swept) > 1 else (math.nan, math.nan)
    return Compared(
        *case,
        glint=whole / white,
        shade=whole / alone,
        mean=mean,
        mean_error=error,
        viewer=float(one[0]),
        deviation=found[1],
        deviation_error=float(errors[1]),
        truth_deviation=found[0],
        slope=found[2],
        slope_error=float(errors[2]),
        mapped=maps[0] / whole,
        mapped_error=maps[0] / whole**2 * float(lit.mean(axis=1).std(ddof=1)) / math.sqrt(n),
        mapped_viewer=float(one[1]),
    )


def _deviations(halves: FloatArray, drawn: FloatArray) -> tuple[float, float, float]:
    """Deviation of the truth's pixels over their mean, the renderer's over it, and the truth's regression on the renderer."""
    a, b, d = halves[..., 0].ravel(), halves[..., 1].ravel(), drawn.ravel()
    mean = 0.5 * (a.mean() + b.mean())
    of_truth, of_sweep = max(float(np.cov(a, b)[0, 1]) / mean**2, 1e-12), float(d.var(ddof=1)) / float(d.mean()) ** 2
    together = float(np.cov(0.5 * (a + b), d)[0, 1]) / (float(d.mean()) * mean)
    return math.sqrt(of_truth), math.sqrt(of_sweep / of_truth), together / of_sweep


def _ratio(a: FloatArray, b: FloatArray) -> tuple[float, float]:
    """Ratio of two means over seas, and its standard error."""
    ratio = float(a.mean() / b.mean())
    rest = a - ratio * b
    return ratio, float(rest.std(ddof=1) / math.sqrt(rest.size) / b.mean())


HEAD = (
    "| wind | beside | down | Sun | glint | lit | sweep/truth | viewer's leg | deviation sweep/truth | truth's deviation | "
    "truth on sweep | map/truth | map viewer's leg |\n" + 13 * "|---:" + "|"
)


def line(row: Compared) -> str:
    """Row of Markdown."""
    cells = (
        *(f"{value:g}" for value in (row.wind, row.beside, row.depression, row.sun)),
        f"{row.glint:.3g}",
        f"{row.shade:.3f}",
        f"{row.mean:.3f} ± {row.mean_error:.3f}",
        f"{row.viewer:.3f}",
        f"{row.deviation:.3f} ± {row.deviation_error:.3f}",
        f"{row.truth_deviation:.2f}",
        f"{row.slope:.3f} ± {row.slope_error:.3f}",
        f"{row.mapped:.3f} ± {row.mapped_error:.3f}",
        f"{row.mapped_viewer:.3f}",
    )
    return "| " + " | ".join(cells) + " |"


def brief(rows: Sequence[Compared]) -> Iterator[str]:
    """Markdown of a row for each wind and Sun, and for each depression sweep over truth: of the mean, and of the pixels' contrast.

    The contrast is one over the truth's regression on the renderer, where rays know it to 6 %.
    """
    downs = sorted({row.depression for row in rows})
    yield "| wind, angle to the Sun | Sun | " + " | ".join(f"{down:g}° down" for down in downs) + " |"
    yield "| --- | --- |" + " --- |" * len(downs)
    cases: dict[tuple[float, float, float], dict[float, Compared]] = {}
    for row in rows:
        cases.setdefault((row.wind, row.beside, row.sun), {})[row.depression] = row
    for (wind, beside, sun), found in cases.items():
        cells = [
            f"{row.mean:.3f} ± {row.mean_error:.3f}; " + (f"{1.0 / row.slope:.2f}" if row.slope_error < 0.06 * row.slope else "-")
            for row in (found[down] for down in downs)
        ]
        yield f"| {wind:g} m/s, {beside:g}° | {sun:g}° | " + " | ".join(cells) + " |"


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seas", type=int, default=12)
    parser.add_argument("--rays", type=int, default=200)
    parser.add_argument("--shortest", type=float, default=0.015)
    parser.add_argument("--winds", type=float, nargs="+", default=WINDS)
    parser.add_argument("--beside", type=float, nargs="+", default=BESIDE)
    parser.add_argument("--legs", action="store_true", help="also without the Sun's leg")
    parser.add_argument("--brief", action="store_true", help="a row for each wind and Sun")
    parser.add_argument("--csv")
    options = parser.parse_args()
    if not options.brief:
        print(HEAD)
    begin = time.perf_counter()
    rows: list[Compared] = []
    for wind in options.winds:
        for beside in options.beside:
            for row in compare(wind, beside, seas=options.seas, rays=options.rays, shortest=options.shortest, legs=options.legs):
                rows.append(row)
                if not options.brief:
                    print(line(row), flush=True)
    if options.brief:
        print("\n".join(brief(rows)))
    print(f"{time.perf_counter() - begin:.0f} s", file=sys.stderr)
    if options.csv:
        with open(options.csv, "w", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, vars(rows[0]))
            writer.writeheader()
            writer.writerows(vars(row) for row in rows)


if __name__ == "__main__":
    main()
