"""Hull down.

Four container ships at 6 to 24 km from a bridge 10 m high: beyond the horizon the round Earth takes the hull first.
"""

import math
import os

import matplotlib.pyplot as plt

import seaglint as sg
from seaglint.base.constants import EFFECTIVE_EARTH_RADIUS

SMALL = os.environ.get("SEAGLINT_GALLERY_SIZE") == "small"
SHIPS = {6: -2.6, 12: -0.9, 18: 0.9, 24: 2.6}  # distance [km]: bearing [deg]
objects = [
    {
        "name": f"{km} km",
        "preset": "container-ship",
        "east_m": 1000 * km * math.sin(math.radians(bearing)),
        "north_m": 1000 * km * math.cos(math.radians(bearing)),
        "heading_deg": 90,
    }
    for km, bearing in SHIPS.items()
]
scene = sg.load(
    {
        "sun": {"zenith_deg": 60, "azimuth_deg": 180},
        "wind": {"speed_m_s": 3, "from_deg": 0},
        "sensor": {
            "height_m": 10,
            "azimuth_deg": 0,
            "elevation_deg": 0.05,
            "fov_deg": [7.5, 0.7],
            "pixels": [240, 24] if SMALL else [1500, 140],
            "pixel_shape": "any",
        },
        "sea": {"shortest_wave_m": 8} if SMALL else {},
        "objects": objects,
    }
)
kelvin = sg.apparent_temperature(sg.image(scene).radiance).assign_coords(
    x=range(scene.sensor.pixels[0])
)
figure, axes = plt.subplots(figsize=(12, 3.2), layout="constrained")
bearing = (kelvin.azimuth + 180) % 360 - 180
shown = axes.pcolormesh(
    bearing,
    kelvin.elevation,
    kelvin,
    cmap="gray",
    vmin=float(kelvin.quantile(0.02)),
    vmax=float(kelvin.quantile(0.995)),
)
axes.axhline(
    -math.degrees(math.sqrt(2 * 10 / EFFECTIVE_EARTH_RADIUS)),
    color="tab:orange",
    lw=0.8,
    xmax=0.03,
    label="sea horizon",
)
for km, at in SHIPS.items():
    axes.text(at, 0.41, f"{km} km", ha="center", color="tab:orange")
axes.legend(loc="lower right", fontsize=8)
axes.set(xlabel="bearing [deg]", ylabel="elevation [deg], stretched", ylim=(-0.3, 0.48))
figure.colorbar(shown, label="apparent temperature [K]", extend="both")
figure.savefig("curvature.png", dpi=90)
