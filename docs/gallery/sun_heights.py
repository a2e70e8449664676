"""The Sun sinks.

The same sea under four Suns: high, it glitters close to the ship; low, the glint runs up to the horizon.
"""

import os

import matplotlib.pyplot as plt

import seaglint as sg

SMALL = os.environ.get("SEAGLINT_GALLERY_SIZE") == "small"
PIXELS = [64, 40] if SMALL else [320, 200]
figure, panels = plt.subplots(
    2, 2, figsize=(9.6, 6.2), sharex=True, sharey=True, layout="constrained"
)
for axes, height in zip(panels.flat, (50, 30, 15, 5), strict=True):
    scene = sg.load(
        {
            "sun": {"zenith_deg": 90 - height, "azimuth_deg": 180},
            "wind": {"speed_m_s": 6, "from_deg": 210},
            "sensor": {
                "height_m": 25,
                "azimuth_deg": 180,
                "elevation_deg": -9,
                "fov_deg": [32, 20],
                "pixels": PIXELS,
            },
            "sea": {"shortest_wave_m": 8 if SMALL else 1},
        }
    )
    kelvin = sg.apparent_temperature(sg.image(scene).radiance)
    kelvin.plot(
        ax=axes,
        x="azimuth",
        y="elevation",
        cmap="gray",
        vmin=285,
        vmax=400,
        cbar_kwargs={"label": "apparent temperature [K]"},
    )
    axes.set(
        title=f"Sun {height}° above the horizon",
        xlabel="azimuth [deg]",
        ylabel="elevation [deg]",
    )
figure.savefig("sun_heights.png", dpi=100)
