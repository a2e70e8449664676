"""Wind sea and swell.

The same light wind without and with a swell of 2 m and 12 s that runs past from the right: the path of glint breaks
into bands.
"""

import os

import matplotlib.pyplot as plt

import seaglint as sg

SMALL = os.environ.get("SEAGLINT_GALLERY_SIZE") == "small"
SWELL = {
    "kind": "jonswap",
    "significant_height_m": 2,
    "peak_period_s": 12,
    "gamma": 5,
    "from_deg": 300,
    "spreading_deg": 10,
}
figure, panels = plt.subplots(2, 1, figsize=(9.6, 7), sharex=True, layout="constrained")
for axes, systems in zip(
    panels, ([{"kind": "elfouhaily"}], [{"kind": "elfouhaily"}, SWELL]), strict=True
):
    scene = sg.load(
        {
            "sun": {"zenith_deg": 74, "azimuth_deg": 240},
            "wind": {"speed_m_s": 5, "from_deg": 220},
            "sensor": {
                "height_m": 40,
                "azimuth_deg": 240,
                "elevation_deg": -4.5,
                "fov_deg": [20, 8],
                "pixels": [80, 32] if SMALL else [480, 192],
            },
            "sea": {"spectrum": {"kind": "systems", "systems": systems}}
            | ({"shortest_wave_m": 8} if SMALL else {}),
        }
    )
    kelvin = sg.apparent_temperature(sg.image(scene).radiance)
    kelvin.plot(
        ax=axes,
        x="azimuth",
        y="elevation",
        cmap="gray",
        robust=True,
        cbar_kwargs={"label": "apparent temperature [K]"},
    )
    axes.set(
        title="wind sea of 5 m/s"
        if len(systems) == 1
        else "the same and a swell of 2 m, 12 s, from 300°",
        xlabel="azimuth [deg]",
        ylabel="elevation [deg]",
    )
figure.savefig("swell.png", dpi=85)
