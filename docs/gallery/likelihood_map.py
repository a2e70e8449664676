"""How often glint, where and when.

Chance that a look near the Sun's azimuth meets more than 0.25 W m⁻² sr⁻¹ of glint, with the climatology of the world's seas.
Wind, cloud and Sun change with place and month; land has no value.
"""

import os

import matplotlib.pyplot as plt

import seaglint as sg
from seaglint.studies.likelihood.chance_map import likelihood_map

SMALL = os.environ.get("SEAGLINT_GALLERY_SIZE") == "small"
scene = sg.load(
    {
        "sensor": {"height_m": 30},
        "band": {"min_um": 3, "max_um": 5},
        "likelihood": {
            "threshold_w_m2_sr": [0.25],
            "depression_deg": [1.5, 6],
            "azimuth_from_sun_deg": [-15, 15],
            "latitudes_deg": [40, 60] if SMALL else [30, 70],
            "longitudes_deg": [-40, -20] if SMALL else [-60, -10],
            "months": [1, 4, 7, 10],
        },
    }
)
found = likelihood_map(scene, step=10 if SMALL else 2)
chance = 100 * found.probability.isel(threshold=0)
figure, panels = plt.subplots(
    2, 2, figsize=(9.6, 7), sharex=True, sharey=True, layout="constrained"
)
for axes, (month, name) in zip(
    panels.flat,
    {1: "January", 4: "April", 7: "July", 10: "October"}.items(),
    strict=True,
):
    shown = axes.pcolormesh(
        chance.longitude,
        chance.latitude,
        chance.sel(month=month),
        cmap="magma",
        vmin=0,
        vmax=chance.max(),
    )
    axes.set_facecolor("0.8")
    axes.set(title=name, xlabel="longitude [deg]", ylabel="latitude [deg]")
figure.colorbar(shown, ax=panels, label="looks that meet glint [%]")
figure.savefig("likelihood_map.png", dpi=90)
