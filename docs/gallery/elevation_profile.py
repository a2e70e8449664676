"""Apparent temperature towards the horizon.

Sea and sky without glint, day side turned away, in both bands: the sea cools to where it mirrors the sky and warms again into the haze.
"""

import os

import matplotlib.pyplot as plt

import seaglint as sg

SMALL = os.environ.get("SEAGLINT_GALLERY_SIZE") == "small"
figure, axes = plt.subplots(figsize=(6.8, 4.8), layout="constrained")
for band, colour in {(3.5, 5.0): "tab:blue", (8.0, 12.0): "tab:red"}.items():
    for speed, style in {2: ":", 7: "-", 14: "--"}.items():
        scene = sg.load(
            {
                "sun": {"zenith_deg": 130},
                "band": {"min_um": band[0], "max_um": band[1]},
                "wind": {"speed_m_s": speed},
                "sea": {"temperature_k": 290},
                "sensor": {
                    "height_m": 30,
                    "elevation_deg": -14,
                    "fov_deg": [1, 32],
                    "pixels": [1, 40 if SMALL else 400],
                    "pixel_shape": "any",
                },
            }
        )
        kelvin = sg.apparent_temperature(sg.mean(scene).radiance).isel(x=0)
        axes.plot(
            kelvin.elevation,
            kelvin,
            style,
            color=colour,
            label=f"{band[0]:g}-{band[1]:g} µm, {speed} m/s",
        )
axes.axhline(290, color="0.7", lw=0.8)
axes.text(-29.5, 290.05, "water", color="0.5", fontsize=8)
axes.set(
    xlabel="elevation [deg]",
    ylabel="apparent temperature [K]",
    title="from 30 m, no Sun, midlatitude summer",
)
axes.legend(fontsize=8, loc="upper left")
axes.grid(alpha=0.3)
figure.savefig("elevation_profile.png", dpi=90)
