"""Waves on their way.

One column of pixels over time: every crest draws a line whose slope is its speed, long waves faster than short ones.
"""

import os
import tempfile

import matplotlib.pyplot as plt

import seaglint as sg

SMALL = os.environ.get("SEAGLINT_GALLERY_SIZE") == "small"
FRAMES = 12 if SMALL else 240
scene = sg.load(
    {
        "sun": {"zenith_deg": 130},
        "band": {"min_um": 8, "max_um": 12},
        "wind": {"speed_m_s": 9, "from_deg": 0},
        "sensor": {
            "height_m": 40,
            "elevation_deg": -7,
            "fov_deg": [0.2, 10],
            "pixels": [4, 24 if SMALL else 240],
            "pixel_shape": "any",
            "frame_rate_hz": 5,
            "frames": FRAMES,
        },
        "sea": {"shortest_wave_m": 8} if SMALL else {},
    }
)
with tempfile.TemporaryDirectory() as folder:
    run = sg.render(scene, f"{folder}/run.zarr")
    kelvin = sg.apparent_temperature(run.radiance.isel(x=2).load().rename(y="row"))
figure, axes = plt.subplots(figsize=(8.4, 4.6), layout="constrained")
low, high = kelvin.quantile([0.01, 0.99])
shown = axes.pcolormesh(
    kelvin.time,
    run.elevation,
    kelvin.transpose("row", "time"),
    cmap="gray",
    vmin=low,
    vmax=high,
)
figure.colorbar(shown, label="apparent temperature, 8-12 µm [K]", extend="both")
axes.set(
    xlabel="time [s]", ylabel="elevation [deg]", title="from 40 m, into a wind of 9 m/s"
)
figure.savefig("range_time.png", dpi=90)
