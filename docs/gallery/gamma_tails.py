"""Long tails.

Pixels of the corridor over many seas: at four standard deviations a Gaussian is wrong by a factor of ten and more, a gamma law of
the same mean and variance lies near.
"""

import os

import matplotlib.pyplot as plt
import numpy as np
from scipy import stats

import seaglint as sg

SMALL = os.environ.get("SEAGLINT_GALLERY_SIZE") == "small"
scene = sg.load(
    {
        "sun": {"zenith_deg": 60, "azimuth_deg": 180},
        "wind": {"speed_m_s": 5, "from_deg": 225},
        "sensor": {
            "height_m": 100,
            "azimuth_deg": 180,
            "elevation_deg": -3,
            "fov_deg": [4, 1],
            "pixels": [64, 16] if SMALL else [256, 32],
            "pixel_shape": "any",
        },
        "sea": {"shortest_wave_m": 8 if SMALL else 0.5},
    }
)
seas = [
    sg.image(
        scene.model_copy(update={"seed": s}), layers=["glint_radiance"]
    ).glint_radiance.values
    for s in range(2 if SMALL else 12)
]
values = np.concatenate([sea.ravel() for sea in seas])
mean, deviation = values.mean(), values.std()
sigma = np.linspace(0, 8, 100)
level = mean + sigma * deviation
figure, axes = plt.subplots(figsize=(6.4, 4.6), layout="constrained")
axes.semilogy(
    sigma,
    [max(np.mean(values > v), 1e-9) for v in level],
    "k.",
    ms=3,
    label="pixels of rendered seas",
)
axes.semilogy(
    sigma,
    stats.gamma.sf(level, (mean / deviation) ** 2, scale=deviation**2 / mean),
    label="gamma, same mean and variance",
)
axes.semilogy(sigma, stats.norm.sf(sigma), label="Gaussian")
axes.set(
    ylim=(1e-6, 1),
    xlabel="threshold above the mean [standard deviations]",
    ylabel="share of pixels above [1]",
)
axes.grid(alpha=0.3)
axes.legend()
figure.savefig("gamma_tails.png", dpi=90)
