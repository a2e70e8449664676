"""Draw the sky near the horizon, and one ship through four airs, into docs/images.

    python docs/figures/atmosphere_figures.py            both, half a minute
    python docs/figures/atmosphere_figures.py mirages    one of horizon_air, mirages

``horizon_air.png`` has LOWTRAN7's layers beside continuous air, and temperatures for the guide are printed; ``mirages.png`` has standard
refraction, an inversion, a duct and air colder than the sea.
"""

from __future__ import annotations

import logging
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from scipy.interpolate import CubicSpline

from pictures import save
from seaglint.air.profile.aerosols import HazeWeather
from seaglint.air.profile.air_profile import model_profile
from seaglint.air.profile.air_sums import AirSums
from seaglint.air.protocol import wavenumber_grid
from seaglint.base.conventions import FloatArray
from seaglint.optics.band import Band, apparent_temperature
from seaglint.optics.blackbody import planck_wavenumber
from seaglint.scenario.load import parse_scenario
from seaglint.studies.sequence.labelled_frames import image

IMAGES = Path(__file__).resolve().parents[2] / "docs" / "images"

HEIGHTS = (5.0, 55.0, 420.0, 900.0)
"""Sensors [m]."""

ELEVATIONS_DEG = (-0.063, -0.033, -0.007, 0.0, 0.05, 0.1, 0.3, 0.5, 3.0, 10.0)
"""Elevations of the printed table, from 5 m [deg]."""

BAND = (8.0, 12.0)

SEA = 283.15
"""Temperature of the sea [K]."""

SHIP = {
    "name": "ship",
    "temperature_k": 287,
    "east_m": 0,
    "north_m": 13_000,
    "draught_m": 4,
    "course_deg": 90,
    "speed_m_s": 0,
    "shape": {
        "kind": "union",
        "parts": [
            {"kind": "box", "size_m": [16, 90, 9]},
            {"kind": "box", "size_m": [14, 18, 12], "at_m": [0, -25, 10], "temperature_k": 289},
            {"kind": "cylinder", "radius_m": 2.0, "length_m": 6, "at_m": [0, -25, 19], "temperature_k": 310},
        ],
    },
}


def kelvin_of(nu: np.ndarray, radiance: np.ndarray) -> np.ndarray:
    """Temperature of blackbodies with radiances in the band [K]."""
    nodes = np.linspace(150.0, 330.0, 2000)
    return CubicSpline(planck_wavenumber(nu, nodes[:, None]).sum(axis=-1), nodes)(radiance.sum(axis=-1))


def skies(model: str, band: tuple[float, float], height: float, elevation: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Temperatures [K] of LOWTRAN7's layers and of continuous air at elevations [rad] of the air's own rays."""
    nu = wavenumber_grid(*band)
    air = AirSums(model_profile(model), HazeWeather(wind=7.0, wind_24h=7.0), nu)
    zenith = 0.5 * np.pi - elevation
    layers, continuous = (np.array([sums(height, float(z)).emitted for z in zenith]) for sums in (air.in_layers, air.along))
    return kelvin_of(nu, layers), kelvin_of(nu, continuous)


def horizon_air() -> Figure:
    """The sky near the horizon in two models and two bands; prints the guide's temperatures."""
    for row in zip(ELEVATIONS_DEG, *skies("midlatitude-summer", (3.5, 5.0), 5.0, np.radians(ELEVATIONS_DEG)), strict=True):
        print("{:8.3f} deg  layers {:.2f} K  continuous {:.2f} K".format(*row))
    figure = Figure(figsize=(10.0, 7.0), layout="constrained")
    panels = figure.subplots(2, 2, sharex=True)
    for line, model in zip(panels, ("midlatitude-summer", "tropical"), strict=True):
        for axes, band in zip(line, ((3.5, 5.0), (8.0, 12.0)), strict=True):
            for i, height in enumerate(HEIGHTS):
                dip = AirSums(model_profile(model), HazeWeather(), wavenumber_grid(*band)).air.dip(height)
                elevation = np.linspace(-0.999 * dip, np.radians(2.0), 240)
                layers, continuous = skies(model, band, height, elevation)
                axes.plot(np.degrees(elevation), continuous, color=f"C{i}", label=f"{height:g} m")
                axes.plot(np.degrees(elevation), layers, color=f"C{i}", linestyle=":", linewidth=1.0)
            axes.set_title(f"{model}, {band[0]:g}-{band[1]:g} µm", fontsize=10)
            axes.grid(alpha=0.3)
        line[0].set_ylabel("apparent temperature of the sky [K]")
    for axes in panels[1]:
        axes.set_xlabel("elevation [deg]")
    handles, labels = panels[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=len(labels), title="sensor at (dotted: LOWTRAN7's layers)", fontsize=9)
    return figure


def write_sounding(path: Path, warmer: Callable[[FloatArray], FloatArray]) -> str:
    """Write a sounding of 1 m steps below 60 m: a standard lapse from the sea's temperature, and what is warmer [K] at heights [m]."""
    z = np.concatenate([np.arange(0.0, 60.0), np.geomspace(60.0, 15e3, 60)])
    kelvin = np.maximum(SEA - 0.0065 * z + warmer(z), 216.65)
    log_p = np.concatenate([[0.0], np.cumsum(-9.80665 * np.diff(z) / (287.05 * 0.5 * (kelvin[1:] + kelvin[:-1])))])
    lines = [f"{a:.3f},{1013.25 * np.exp(b):.5f},{c:.4f},70" for a, b, c in zip(z, log_p, kelvin, strict=True)]
    path.write_text("\n".join(["height_m,pressure_hpa,temperature_k,relative_humidity_percent", *lines]) + "\n")
    return str(path)


def mirages() -> Figure:
    """One ship through four airs."""
    logging.getLogger("seaglint").setLevel(logging.ERROR)  # of ducts, which are meant
    with tempfile.TemporaryDirectory() as folder:
        inversion = write_sounding(Path(folder) / "inversion.csv", lambda z: 9.0 / (1.0 + np.exp(-(z - 22.0) / 2.0)))
        duct = write_sounding(Path(folder) / "duct.csv", lambda z: 6.0 * (1.0 - np.exp(-z / 12.0)))
        airs = {
            "standard refraction": {"source": "lowtran", "sounding": inversion},
            "inversion of 9 K at 22 m: superior mirage": {"source": "lowtran", "sounding": inversion, "refraction": "profile"},
            "air warmer by 6 K within 30 m: duct": {"source": "lowtran", "sounding": duct, "refraction": "profile"},
            "air 8 K colder than the sea: inferior mirage": {
                "source": "table",
                "model": "us-standard-1976",
                "air_minus_sea_k": -8,
                "refraction": "profile",
            },
        }
        figure = Figure(figsize=(11.0, 7.0), layout="constrained")
        for axes, (title, air) in zip(figure.subplots(2, 2, sharex=True, sharey=True).flat, airs.items(), strict=True):
            picture = image(
                parse_scenario(
                    {
                        "sensor": {"pixels": [320, 240], "fov_deg": [0.48, 0.36], "elevation_deg": -0.07, "height_m": 12, "azimuth_deg": 0},
                        "wind": {"speed_m_s": 4},
                        "sun": {"zenith_deg": 120},
                        "sea": {"temperature_k": SEA},
                        "band": {"min_um": BAND[0], "max_um": BAND[1]},
                        "atmosphere": air,
                        "objects": [SHIP],
                    }
                )
            )
            celsius = apparent_temperature(picture.radiance.values, Band.rectangular(*BAND), wavenumber_grid(*BAND)) - 273.15
            x, y = picture.azimuth.values, picture.elevation.values
            shown = axes.imshow(
                celsius, cmap="inferno", vmin=np.percentile(celsius, 2), vmax=18, extent=(x[0], x[-1], y[-1], y[0]), aspect="auto"
            )
            figure.colorbar(shown, ax=axes, label="apparent temperature [°C]")
            axes.set_title(title, fontsize=10)
            axes.set(xlabel="azimuth [deg]", ylabel="elevation [deg]")
            axes.label_outer()
    return figure


PICTURES: dict[str, Callable[[], Figure]] = {"horizon_air": horizon_air, "mirages": mirages}


def main(names: list[str]) -> None:
    """Write those named, or all."""
    if unknown := set(names) - set(PICTURES):
        sys.exit(f"{', '.join(sorted(unknown))}: not one of {', '.join(PICTURES)}")
    for name in names or PICTURES:
        save(PICTURES[name](), IMAGES / f"{name}.png")


if __name__ == "__main__":
    main(sys.argv[1:])
