"""Straight down.

A camera behind a lens 150 m above the water under a high Sun: glitter around the place that mirrors the Sun.
"""

import os

import matplotlib.pyplot as plt
import numpy as np

import seaglint as sg

SMALL = os.environ.get("SEAGLINT_GALLERY_SIZE") == "small"
SIZE = 64 if SMALL else 420
scene = sg.load(
    {
        "sun": {"zenith_deg": 20, "azimuth_deg": 135},
        "wind": {"speed_m_s": 7, "from_deg": 270},
        "sensor": {
            "height_m": 150,
            "azimuth_deg": 0,
            "elevation_deg": -90,
            "projection": "pinhole",
            "fov_deg": [50, 50],
            "pixels": [SIZE, SIZE],
        },
        "sea": {"shortest_wave_m": 4 if SMALL else 1},
    }
)
kelvin = sg.apparent_temperature(sg.image(scene).radiance)
half = 150 * np.tan(np.radians(25))
figure, axes = plt.subplots(figsize=(6.6, 5.6), layout="constrained")
shown = axes.imshow(
    kelvin, cmap="gray", extent=(-half, half, -half, half), vmin=289, vmax=312
)
figure.colorbar(shown, label="apparent temperature [K]", extend="max")
axes.set(
    xlabel="east [m]",
    ylabel="north [m]",
    title="from 150 m, Sun 70° high in the south-east, west wind of 7 m/s",
)
figure.savefig("plan_view.png", dpi=100)
