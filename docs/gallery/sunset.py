"""Sunset.

Two degrees before the Sun touches the horizon: its disc, the haze that it lights, and a broken path on the sea; the scale is logarithmic.
"""

import os

import matplotlib.pyplot as plt
from matplotlib.colors import LogNorm

import seaglint as sg

SMALL = os.environ.get("SEAGLINT_GALLERY_SIZE") == "small"
scene = sg.load(
    {
        "sun": {"zenith_deg": 88, "azimuth_deg": 270},
        "wind": {"speed_m_s": 5, "from_deg": 250},
        "sensor": {
            "height_m": 15,
            "azimuth_deg": 270,
            "elevation_deg": -1.5,
            "fov_deg": [20, 8],
            "pixels": [80, 32] if SMALL else [640, 256],
        },
        "sea": {"shortest_wave_m": 8 if SMALL else 1},
    }
)
radiance = sg.image(scene).radiance
figure, axes = plt.subplots(figsize=(9.6, 4.4), layout="constrained")
radiance.plot(
    x="azimuth",
    y="elevation",
    cmap="inferno",
    norm=LogNorm(1, 30),
    cbar_kwargs={"label": "radiance, 3.5-5 µm [W m⁻² sr⁻¹]"},
)
axes.set(
    title="sensor at 15 m, Sun 2° above the horizon",
    xlabel="azimuth [deg]",
    ylabel="elevation [deg]",
)
figure.savefig("sunset.png", dpi=100)
