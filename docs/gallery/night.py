"""Night, long wave.

8-12 µm with the Sun far below the horizon: crests emit, flat water mirrors the colder sky, and the far sea
takes the temperature of the air.
"""

import os

import matplotlib.pyplot as plt

import seaglint as sg

SMALL = os.environ.get("SEAGLINT_GALLERY_SIZE") == "small"
scene = sg.load(
    {
        "sun": {"zenith_deg": 130},
        "band": {"min_um": 8, "max_um": 12},
        "wind": {"speed_m_s": 9, "from_deg": 40},
        "sensor": {
            "height_m": 20,
            "elevation_deg": -4,
            "fov_deg": [20, 10],
            "pixels": [80, 40] if SMALL else [560, 280],
        },
        "sea": {"temperature_k": "14 degC", "shortest_wave_m": 8 if SMALL else 0.5},
    }
)
kelvin = sg.apparent_temperature(sg.image(scene).radiance)
figure, axes = plt.subplots(figsize=(9.6, 5), layout="constrained")
kelvin.plot(
    x="azimuth",
    y="elevation",
    cmap="gray",
    vmin=285.3,
    vmax=289,
    cbar_kwargs={"label": "apparent temperature, 8-12 µm [K]"},
)
axes.set(
    title="sensor at 20 m, wind of 9 m/s from ahead to the right, no Sun",
    xlabel="azimuth [deg]",
    ylabel="elevation [deg]",
)
figure.savefig("night.png", dpi=100)
