"""All around.

A panorama of 360°: the corridor stands under the Sun in the south-west, and the haze is lit on both sides of it.
"""

import os

import matplotlib.pyplot as plt

import seaglint as sg

SMALL = os.environ.get("SEAGLINT_GALLERY_SIZE") == "small"
scene = sg.load(
    {
        "sun": {"zenith_deg": 72, "azimuth_deg": 225},
        "wind": {"speed_m_s": 8, "from_deg": 300},
        "sensor": {
            "height_m": 30,
            "azimuth_deg": 180,
            "elevation_deg": -7,
            "fov_deg": [360, 16],
            "pixels": [180, 16] if SMALL else [1440, 160],
            "pixel_shape": "any",
        },
        "sea": {"shortest_wave_m": 8} if SMALL else {},
    }
)
kelvin = sg.apparent_temperature(sg.image(scene).radiance)
figure, axes = plt.subplots(figsize=(12, 3.4), layout="constrained")
kelvin.plot(
    x="azimuth",
    y="elevation",
    cmap="gray",
    vmin=289.5,
    vmax=298,
    cbar_kwargs={"label": "apparent temperature [K]"},
)
axes.set_xticks(range(0, 361, 45), ["N", "NE", "E", "SE", "S", "SW", "W", "NW", "N"])
axes.set(
    xlabel="azimuth",
    ylabel="elevation [deg]",
    title="Sun 18° high in the south-west, wind of 8 m/s from west-north-west",
)
figure.savefig("panorama.png", dpi=90)
