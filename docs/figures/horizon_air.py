"""Draw the sky near the horizon in LOWTRAN7's layers and in continuous air, and print temperatures for the guide.

python docs/figures/horizon_air.py        # writes docs/images/horizon_air.png, seconds
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from scipy.interpolate import CubicSpline

from seaglint.air.profile.air_profile import model_profile
from seaglint.air.profile.air_sums import AirSums
from seaglint.air.profile.hazes import HazeWeather
from seaglint.air.protocol import wavenumber_grid
from seaglint.optics.blackbody import planck_wavenumber

OUTPUT = Path(__file__).parents[2] / "docs" / "images" / "horizon_air.png"

HEIGHTS = (5.0, 55.0, 420.0, 900.0)
"""Sensors [m]."""

ELEVATIONS_DEG = (-0.063, -0.033, -0.007, 0.0, 0.05, 0.1, 0.3, 0.5, 3.0, 10.0)
"""Elevations of the printed table, from 5 m [deg]."""


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


def main() -> None:
    """Command line."""
    argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter).parse_args()
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
    figure.savefig(OUTPUT, dpi=110, metadata={"Software": None})


if __name__ == "__main__":
    main()
