"""What the radiance is made of.

The four parts of one image: the air's own light, the sea's emission, the mirrored sky and the mirrored Sun. Each panel has
its own scale; the sky is left out.
"""

import os

import matplotlib.pyplot as plt

import seaglint as sg

SMALL = os.environ.get("SEAGLINT_GALLERY_SIZE") == "small"
PARTS = {
    "path_radiance": "air",
    "emitted_radiance": "emitted by the sea",
    "sky_radiance": "mirrored sky",
    "glint_radiance": "mirrored Sun",
}
scene = sg.load(
    {
        "sun": {"zenith_deg": 72, "azimuth_deg": 180},
        "wind": {"speed_m_s": 6, "from_deg": 210},
        "sensor": {
            "height_m": 25,
            "azimuth_deg": 180,
            "elevation_deg": -5.5,
            "fov_deg": [20, 12],
            "pixels": [60, 36] if SMALL else [300, 180],
        },
        "sea": {"shortest_wave_m": 8 if SMALL else 1},
    }
)
image = sg.image(scene, layers=list(PARTS))
figure, panels = plt.subplots(
    2, 2, figsize=(9.6, 6.2), sharex=True, sharey=True, layout="constrained"
)
for axes, (name, title) in zip(panels.flat, PARTS.items(), strict=True):
    image[name].where(image.elevation < -0.3).plot(
        ax=axes,
        x="azimuth",
        y="elevation",
        cmap="inferno",
        robust=True,
        cbar_kwargs={"label": "W m⁻² sr⁻¹"},
    )
    axes.set(title=title, xlabel="azimuth [deg]", ylabel="elevation [deg]")
figure.savefig("layers.png", dpi=100)
