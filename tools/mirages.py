"""Draw one ship through four airs: standard refraction, an inversion, a duct and air colder than the sea.

python tools/mirages.py        # writes docs/images/mirages.png, half a minute
"""

from __future__ import annotations

import argparse
import logging
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from seaglint.air.protocol import wavenumber_grid
from seaglint.base.conventions import FloatArray
from seaglint.optics.band import Band, apparent_temperature
from seaglint.scenario.load import parse_scenario
from seaglint.studies.sequence.labelled_frames import image

OUTPUT = Path(__file__).parents[1] / "docs" / "images" / "mirages.png"

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


def write_sounding(path: Path, warmer: Callable[[FloatArray], FloatArray]) -> str:
    """Write a sounding of 1 m steps below 60 m: a standard lapse from the sea's temperature, and what is warmer [K] at heights [m]."""
    z = np.concatenate([np.arange(0.0, 60.0), np.geomspace(60.0, 15e3, 60)])
    kelvin = np.maximum(SEA - 0.0065 * z + warmer(z), 216.65)
    log_p = np.concatenate([[0.0], np.cumsum(-9.80665 * np.diff(z) / (287.05 * 0.5 * (kelvin[1:] + kelvin[:-1])))])
    lines = [f"{a:.3f},{1013.25 * np.exp(b):.5f},{c:.4f},70" for a, b, c in zip(z, log_p, kelvin, strict=True)]
    path.write_text("\n".join(["height_m,pressure_hpa,temperature_k,relative_humidity_percent", *lines]) + "\n")
    return str(path)


def main() -> None:
    """Command line."""
    argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter).parse_args()
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
    figure.savefig(OUTPUT, dpi=110)


if __name__ == "__main__":
    main()
