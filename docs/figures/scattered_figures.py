"""Draw what scattered sunlight adds, into docs/images, and print the numbers that the documentation tells of it.

    python docs/figures/scattered_figures.py [share] [profile] [difference] [background]

``scattered_share.png`` is the share of scattered sunlight in path and sky radiance over the azimuth from the Sun, by band and Sun,
``aureole_profile.png`` a row of mean model and images with and without it, ``scattered_difference.png`` the demo's first frame
with it less the same without. Names draw only these.
"""

from __future__ import annotations

import sys
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

import seaglint as sg
from pictures import save
from seaglint.base.conventions import FloatArray
from seaglint.formats.tables.input_tables import Cases
from seaglint.optics.band import ApparentTemperature
from seaglint.radiance.mean_radiance import mean_radiance
from seaglint.scenario.load import parse_scenario
from seaglint.scenario.model import Scenario
from seaglint.studies.build import scenario_physics
from seaglint.studies.mean.evaluate_cases import NamedBand, evaluate_scattered, parse_bands

ROOT = Path(__file__).resolve().parents[2]
IMAGES = ROOT / "docs" / "images"
BANDS = parse_bands(["2.0-2.4", "3.5-4.2", "3.5-5.0", "4.5-5.0"])
SUNS = (30.0, 60.0, 76.0, 85.0)
LINES = {"path from 30 m to the sea, 1° down": ("path", 30.0, -1.0), "sky 2° up": ("sky", 0.0, 2.0), "sky 10° up": ("sky", 0.0, 10.0)}
SEAS = 12
DEPRESSION = 5.0


def shares(line: tuple[str, float, float], azimuth: FloatArray) -> FloatArray:
    """Scattered part of the radiance of one line of sight [1, (band, Sun, azimuth)]; midlatitude summer, 7 m/s."""
    kind, height, elevation = line
    sun, aside = (a.ravel() for a in np.meshgrid(SUNS, azimuth, indexing="ij"))
    same = {
        "kind": kind,
        "atmosphere": "midlatitude-summer",
        "wind_speed_m_s": "7",
        "sensor_height_m": f"{height:g}",
        "elevation_deg": f"{elevation:g}",
    }
    rows = [[*same.values(), f"{a:.6g}", f"{s:g}"] for s, a in zip(sun, aside, strict=True)]
    cases = Cases(Path(__file__), [*same, "azimuth_from_sun_deg", "solar_zenith_deg"], rows, list(range(len(rows))))
    found = evaluate_scattered(cases, BANDS)
    return np.stack([_share(found, band).reshape(len(SUNS), azimuth.size) for band in BANDS])


def _share(found: dict[str, Any], band: NamedBand) -> FloatArray:
    scattered, thermal = (np.asarray(found[f"{q}_W_m2_sr[{band.label}]"]) for q in ("scattered", "thermal"))
    return scattered / (scattered + thermal)


def share() -> None:
    """Share of scattered light over azimuth."""
    azimuth = np.concatenate([np.arange(0.0, 20.0, 1.0), np.arange(20.0, 181.0, 4.0)])
    figure = Figure(figsize=(9.0, 8.4), layout="constrained")
    grid = figure.subplots(len(LINES), len(BANDS), sharex=True, sharey=True)
    for line, (name, way) in enumerate(LINES.items()):
        found = shares(way, azimuth)
        for column, band in enumerate(BANDS):
            axes = grid[line, column]
            for sun, values in zip(SUNS, found[column], strict=True):
                axes.semilogy(azimuth, 100.0 * values, label=f"Sun at {sun:g}°")
            axes.set(ylim=(0.01, 110.0), xlim=(0.0, 180.0))
            axes.set_xticks([0, 45, 90, 135, 180])
            axes.grid(alpha=0.3)
            if line == 0:
                axes.set_title(f"{band.label} µm", fontsize=10)
            if column == 0:
                axes.set_ylabel(f"{name}\nscattered share [%]", fontsize=9)
        print(name)
        for band, by_sun in zip(BANDS, found, strict=True):
            values = "; ".join(", ".join(f"{100.0 * v:.2g}" for v in np.interp([0.0, 30.0, 90.0, 180.0], azimuth, row)) for row in by_sun)
            print(f"  {band.label} µm, Suns at {SUNS}, 0, 30, 90, 180 deg aside: {values}")
    grid[0, 0].legend(fontsize=8, loc="lower left")
    figure.supxlabel("azimuth from the Sun [deg]", fontsize=10)
    save(figure, IMAGES / "scattered_share.png", dpi=90)


def panorama(lit: bool) -> Scenario:
    """A row 5 deg down across 120 deg about the Sun's azimuth, from 30 m, with 7 m/s of wind from there."""
    return parse_scenario(
        {
            "sun": {"zenith_deg": 76.0, "azimuth_deg": 0.0},
            "wind": {"speed_m_s": 7.0, "from_deg": 0.0},
            "sensor": {
                "height_m": 30.0,
                "azimuth_deg": 0.0,
                "elevation_deg": -DEPRESSION,
                "fov_deg": [120.0, 0.4],
                "pixels": [160, 1],
                "pixel_shape": "any",
            },
            "sea": {"shortest_wave_m": 3.0},
            "atmosphere": {"scattered_sunlight": lit},
            "render": {"subpixel_glint": "off"},
        }
    )


def of_model(scenario: Scenario, azimuth: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Radiance and glint of the mean model along the row [W m-2 sr-1]."""
    found = mean_radiance(scenario_physics.view(scenario), np.radians([-DEPRESSION]), np.radians(azimuth))
    return found.total[0], np.broadcast_to(found.sun, found.total.shape)[0]


def of_images(scenario: Scenario) -> tuple[FloatArray, FloatArray]:
    """Azimuths [deg] and radiance of the row, mean of independent seas [W m-2 sr-1]."""
    seen = [sg.image(scenario.model_copy(update={"seed": seed})) for seed in range(SEAS)]
    return np.asarray(seen[0].azimuth), np.mean([one.radiance.values.mean(axis=0) for one in seen], axis=0)


def profile() -> None:
    """The aureole mirrored beside the corridor."""
    azimuth = np.arange(-60.0, 60.1, 0.5)
    with_it, without = panorama(True), panorama(False)
    (lit, glint), (dark, _) = of_model(with_it, azimuth), of_model(without, azimuth)
    (column, seen_lit), (_, seen_dark) = of_images(with_it), of_images(without)
    column = (column + 180.0) % 360.0 - 180.0
    figure = Figure(figsize=(6.4, 6.6), layout="constrained")
    upper, lower = figure.subplots(2, 1, sharex=True)
    upper.semilogy(azimuth, lit, "C3", label="mean model")
    upper.semilogy(azimuth, dark, "C0", label="the same without scattered sunlight")
    upper.semilogy(azimuth, glint, "k:", label="its glint alone")
    upper.semilogy(column, seen_lit, "C3.", ms=3, label=f"images, mean of {SEAS} seas")
    upper.semilogy(column, seen_dark, "C0.", ms=3, label="the same without scattered sunlight")
    upper.set(ylim=(1.0, 20.0), ylabel="radiance [W m$^{-2}$ sr$^{-1}$]")
    upper.set_yticks([1, 1.2, 1.5, 2, 3, 5, 10, 20], ["1", "1.2", "1.5", "2", "3", "5", "10", "20"])
    upper.set_yticks([], minor=True)
    upper.legend(fontsize=7, loc="upper right")
    lower.plot(azimuth, lit - dark, "C3", label="with less without: mean model")
    lower.plot(column, seen_lit - seen_dark, "k.", ms=3, label="images")
    lower.set(ylim=(0.0, None), xlim=(-60.0, 60.0), xlabel="azimuth from the Sun [deg]", ylabel="scattered sunlight [W m$^{-2}$ sr$^{-1}$]")
    lower.legend(fontsize=8)
    save(figure, IMAGES / "aureole_profile.png", dpi=90)
    at = [int(np.argmin(np.abs(azimuth - a))) for a in (0.0, 10.0, 20.0, 30.0, 60.0)]
    print(f"{DEPRESSION:g} deg down at {azimuth[at]}: without {dark[at]}, glint {glint[at]}, added {(lit - dark)[at]}")
    ratio = (seen_lit - seen_dark) / np.interp(column, azimuth, lit - dark)
    print(f"added in images over mean model: mean {ratio.mean():.4f}, {ratio.min():.3f} to {ratio.max():.3f}")


def demo(lit: bool) -> Scenario:
    """The demo with or without scattered sunlight."""
    raw = tomllib.loads((ROOT / "examples" / "demo.toml").read_text())
    return parse_scenario(raw | {"atmosphere": raw["atmosphere"] | {"scattered_sunlight": lit}})


def difference() -> None:
    """The demo's first frame with scattered sunlight less that without."""
    with_it, without = (sg.image(demo(lit)) for lit in (True, False))
    added = with_it.radiance.values - without.radiance.values
    figure = Figure(figsize=(8.0, 4.3), layout="constrained")
    axes = figure.subplots()
    aside = np.asarray(with_it.azimuth) - 240.0
    elevation = np.asarray(with_it.elevation)
    extent = (float(aside[0]), float(aside[-1]), float(elevation[-1]), float(elevation[0]))
    shown = axes.imshow(added, extent=extent, aspect="equal", cmap="inferno", norm=LogNorm(0.05, 1.25))
    axes.set(xlabel="azimuth from the Sun [deg]", ylabel="elevation [deg]")
    figure.colorbar(
        shown,
        ax=axes,
        shrink=0.8,
        ticks=[0.05, 0.1, 0.2, 0.5, 1.0],
        format="{x:g}",
        label="radiance, with less without [W m$^{-2}$ sr$^{-1}$]",
    )
    save(figure, IMAGES / "scattered_difference.png", dpi=72)
    sky = elevation > 0.0
    corridor = (elevation < -0.3)[:, None] & (np.abs(aside) < 1.0)[None, :]
    beside = (elevation < -0.3)[:, None] & (np.abs(aside) > 7.0)[None, :]
    print("demo's first frame: radiance without, with [W m-2 sr-1]; apparent temperature [K]")
    view = scenario_physics.view(demo(True))
    inverse = ApparentTemperature.create(view.band, view.atmosphere.wavenumber_cm)
    parts = {"mean": slice(None), "sky": sky, "sea within 1 deg": corridor, "sea beyond 7 deg": beside}
    for name, part in parts.items():
        values = np.array([float(one.radiance.values[part].mean(dtype=float)) for one in (without, with_it)])
        print(f"  {name}: {values}, {inverse(values)}")
    peaks = np.array([float(one.radiance.max()) for one in (without, with_it)])
    print(f"  peak: {peaks}, {inverse(peaks)}; largest difference {added.max():.3g}, smallest {added.min():.3g}")


def background_of(lit: bool) -> FloatArray:
    """The sea without glint from 100 m, 10 m/s, Sun at 77.4 deg, 2.29 deg down, as in the article's background, by azimuth [K]."""
    scenario = {
        "sun": {"zenith_deg": 77.4, "azimuth_deg": 0.0},
        "wind": {"speed_m_s": 10.0},
        "sensor": {"height_m": 100.0},
        "sea": {"temperature_k": 288.15, "water": "article", "slopes": {"kind": "cox-munk-isotropic"}},
    }
    azimuth = np.radians([0.0, 30.0, 90.0, 180.0])
    view = scenario_physics.view(parse_scenario(scenario | {"atmosphere": {"scattered_sunlight": lit}}))
    inverse = ApparentTemperature.create(view.band, view.atmosphere.wavenumber_cm)
    seen = mean_radiance(view, np.radians([-2.29]), azimuth)
    return np.asarray(inverse(seen.total[0] - np.broadcast_to(seen.sun, seen.total.shape)[0]))


def background() -> None:
    """Print the sea without glint, with and without scattered sunlight."""
    print("background [K] at 0, 30, 90, 180 deg from the Sun")
    for lit in (False, True):
        print(f"  scattered sunlight {lit}: {background_of(lit)}")


def main(names: list[str]) -> None:
    """Draw those named, or all."""
    pictures = {"share": share, "profile": profile, "difference": difference, "background": background}
    if unknown := set(names) - set(pictures):
        sys.exit(f"{', '.join(sorted(unknown))}: not one of {', '.join(pictures)}")
    for name in names or pictures:
        pictures[name]()


if __name__ == "__main__":
    main(sys.argv[1:])
