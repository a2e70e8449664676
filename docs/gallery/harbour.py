"""Off a harbour.

`examples/harbour.toml`: vessels, a buoy, a swimmer, gulls and a drone in a long-focus view; the container ship lies 6 km off.
"""

import os
import tomllib
from pathlib import Path

import matplotlib.pyplot as plt

import seaglint as sg

SMALL = os.environ.get("SEAGLINT_GALLERY_SIZE") == "small"
tables = tomllib.loads(
    (Path(__file__).parents[2] / "examples" / "harbour.toml").read_text()
)
tables["sensor"] |= {"pixels": [192, 64] if SMALL else [900, 300]}
if SMALL:
    tables["sea"]["shortest_wave_m"] = 12
kelvin = sg.apparent_temperature(sg.image(sg.load(tables)).radiance)
figure, axes = plt.subplots(figsize=(12, 4), layout="constrained")
kelvin.plot(
    x="azimuth",
    y="elevation",
    cmap="gray",
    vmin=288.5,
    vmax=296,
    cbar_kwargs={"label": "apparent temperature [K]"},
)
axes.set(
    title="from a pier 12 m high, 3.5-5 µm",
    xlabel="azimuth [deg]",
    ylabel="elevation [deg]",
)
figure.savefig("harbour.png", dpi=90)
