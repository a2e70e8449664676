"""Silhouettes with truth boxes.

A container ship and a fishing vessel dark before the glint, with the boxes that `seaglint labels` writes.
"""

import os
import tempfile

import matplotlib.pyplot as plt
import xarray as xr

import seaglint as sg

SMALL = os.environ.get("SEAGLINT_GALLERY_SIZE") == "small"
scene = sg.load(
    {
        "sun": {"zenith_deg": 75, "azimuth_deg": 180},
        "wind": {"speed_m_s": 6, "from_deg": 200},
        "sensor": {
            "height_m": 25,
            "azimuth_deg": 180,
            "elevation_deg": -0.9,
            "fov_deg": [8, 3],
            "pixels": [160, 60] if SMALL else [800, 300],
            "frames": 1,
        },
        "sea": {"shortest_wave_m": 8} if SMALL else {},
        "objects": [
            {
                "name": "container ship",
                "preset": "container-ship",
                "east_m": 0,
                "north_m": -3500,
                "course_deg": 80,
                "speed_m_s": 7,
            },
            {
                "name": "trawler",
                "preset": "fishing-vessel",
                "east_m": -60,
                "north_m": -1900,
                "course_deg": 290,
                "speed_m_s": 4,
            },
        ],
    }
)
with tempfile.TemporaryDirectory() as folder:
    kelvin = sg.apparent_temperature(
        sg.render(scene, f"{folder}/run.zarr").radiance.isel(time=0)
    ).load()
    truth = (
        xr.open_zarr(f"{folder}/run.zarr", group="truth", consolidated=False)
        .isel(time=0)
        .load()
    )
figure, axes = plt.subplots(figsize=(12, 4.9), layout="constrained")
shown = axes.imshow(kelvin, cmap="gray", vmin=285, vmax=400)
for name, (_, box) in zip(
    ("container ship", "trawler"), truth.groupby("object"), strict=True
):
    left, top, width, height = (
        float(box[f"bbox_{side}_px"].squeeze())
        for side in ("left", "top", "width", "height")
    )
    axes.add_patch(
        plt.Rectangle(
            (left - 1, top - 1), width + 1, height + 1, fill=False, ec="tab:orange"
        )
    )
    axes.text(
        left,
        top - 3,
        f"{name}, {float(box.range_m.squeeze()) / 1000:.1f} km",
        color="tab:orange",
    )
axes.set(xlabel="column", ylabel="row")
figure.colorbar(shown, label="apparent temperature [K]", extend="max")
figure.savefig("ships_boxes.png", dpi=90)
