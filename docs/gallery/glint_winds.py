"""Wind opens the corridor.

One Sun 20° above the horizon, four winds from ahead: the light breeze leaves a narrow, hot path,
the fresh one spreads it over the whole picture.
"""

import os

import matplotlib.pyplot as plt

import seaglint as sg

SMALL = os.environ.get("SEAGLINT_GALLERY_SIZE") == "small"
PIXELS = [64, 40] if SMALL else [320, 200]
figure, panels = plt.subplots(
    2, 2, figsize=(9.6, 6.2), sharex=True, sharey=True, layout="constrained"
)
for axes, speed in zip(panels.flat, (2, 5, 9, 14), strict=True):
    scene = sg.load(
        {
            "sun": {"zenith_deg": 70, "azimuth_deg": 180},
            "wind": {"speed_m_s": speed, "from_deg": 180},
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
    axes.set(title=f"{speed} m/s", xlabel="azimuth [deg]", ylabel="elevation [deg]")
figure.savefig("glint_winds.png", dpi=100)
