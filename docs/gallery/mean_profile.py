"""A mean map and its profile.

What `seaglint mean` gives: the map without waves, and down its middle column the parts that make it up.
"""

import os

import matplotlib.pyplot as plt

import seaglint as sg

SMALL = os.environ.get("SEAGLINT_GALLERY_SIZE") == "small"
scene = sg.load(
    {
        "sun": {"zenith_deg": 70, "azimuth_deg": 180},
        "wind": {"speed_m_s": 7, "from_deg": 180},
        "sensor": {
            "height_m": 30,
            "azimuth_deg": 180,
            "elevation_deg": -7,
            "fov_deg": [40, 16],
            "pixels": [60, 24] if SMALL else [400, 160],
        },
    }
)
found = sg.mean(scene)
middle = found.isel(x=found.sizes["x"] // 2)
figure, (left, right) = plt.subplots(
    1, 2, figsize=(11, 4.2), sharey=True, width_ratios=(2, 1), layout="constrained"
)
found.radiance.plot(
    ax=left,
    x="azimuth",
    y="elevation",
    cmap="inferno",
    cbar_kwargs={"label": "mean radiance [W m⁻² sr⁻¹]"},
)
for name, label in {
    "path": "air",
    "emitted": "emitted",
    "sky": "sky",
    "glint": "glint",
}.items():
    right.plot(middle[f"{name}_radiance"], middle.elevation, label=label)
right.plot(middle.radiance, middle.elevation, "k--", label="all")
left.set(xlabel="azimuth [deg]", ylabel="elevation [deg]")
right.set(
    xlabel="radiance [W m⁻² sr⁻¹]",
    xscale="log",
    xlim=(0.05, 30),
    title="down the middle",
)
right.legend(fontsize=8)
figure.savefig("mean_profile.png", dpi=90)
