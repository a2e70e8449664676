"""Blind towards the Sun.

Probability of detection of a faint, a middling and a bright point around the compass, for a plain threshold at four standard
deviations of each field.
"""

import os

import matplotlib.pyplot as plt
import numpy as np

import seaglint as sg

SMALL = os.environ.get("SEAGLINT_GALLERY_SIZE") == "small"
CONTRASTS = [0.02, 0.2, 2.0]
bearings = np.arange(0, 360, 120 if SMALL else 10)
shares = []
for bearing in bearings:
    scene = sg.load(
        {
            "sun": {"zenith_deg": 68, "azimuth_deg": 180},
            "wind": {"speed_m_s": 6, "from_deg": 180},
            "sensor": {
                "height_m": 30,
                "azimuth_deg": float(bearing),
                "elevation_deg": -2.5,
                "fov_deg": [1.6, 1.2],
                "pixels": [24, 18] if SMALL else [64, 48],
            },
            "sea": {"shortest_wave_m": 8} if SMALL else {},
        }
    )
    found = sg.detect(
        scene,
        CONTRASTS,
        threshold=4.0,
        frames=2 if SMALL else 6,
        injections=200 if SMALL else 1000,
    )
    shares.append([entry["p_d"] for entry in found["sweep"]])
figure, axes = plt.subplots(
    figsize=(5.6, 5.2), subplot_kw={"projection": "polar"}, layout="constrained"
)
axes.set_theta_zero_location("N")
axes.set_theta_direction(-1)
for contrast, share in zip(CONTRASTS, np.array([*shares, shares[0]]).T, strict=True):
    axes.plot(
        np.radians([*bearings, bearings[0]]),
        share,
        marker="o",
        ms=3,
        label=f"{contrast:g} W m⁻² sr⁻¹",
    )
axes.plot(
    np.pi,
    1.0,
    marker="*",
    ms=18,
    color="gold",
    mec="k",
    ls="none",
    clip_on=False,
    label="Sun, 22° high",
)
axes.set(ylim=(0, 1), title="P_d of a point")
axes.legend(loc="lower left", bbox_to_anchor=(-0.2, -0.1), fontsize=8)
figure.savefig("detection_polar.png", dpi=90)
