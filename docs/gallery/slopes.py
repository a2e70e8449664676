"""Slope and distance.

Two layers that no camera has: the slope of the sea along the line of sight, and the distance of what each pixel sees.
"""

import os

import matplotlib.pyplot as plt
from matplotlib.colors import LogNorm

import seaglint as sg

SMALL = os.environ.get("SEAGLINT_GALLERY_SIZE") == "small"
scene = sg.load(
    {
        "wind": {"speed_m_s": 8, "from_deg": 15},
        "sensor": {
            "height_m": 25,
            "azimuth_deg": 0,
            "elevation_deg": -4,
            "fov_deg": [20, 8],
            "pixels": [80, 32] if SMALL else [480, 192],
        },
        "sea": {"shortest_wave_m": 8 if SMALL else 1},
    }
)
image = sg.image(scene, layers=["slope", "range"])
figure, panels = plt.subplots(2, 1, figsize=(9.6, 7), sharex=True, layout="constrained")
image["slope"].plot(
    ax=panels[0],
    cmap="RdBu_r",
    robust=True,
    cbar_kwargs={"label": "slope along the view [1]"},
)
image["range"].plot(
    ax=panels[1],
    cmap="viridis",
    norm=LogNorm(100, 2e4),
    cbar_kwargs={"label": "distance [m]"},
)
for axes in panels:
    axes.set(title="", xlabel="column", ylabel="row")
    axes.invert_yaxis()
figure.savefig("slopes.png", dpi=100)
