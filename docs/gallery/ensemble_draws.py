"""Three ways to draw an ensemble.

Thirty-two scenes with a law for wind and one for the Sun: every draw by itself, one in each thirty-second part of either law, and points
that are even in both at once.
"""

import os

import matplotlib.pyplot as plt

from seaglint.scenario.ensemble_file import parse_ensemble
from seaglint.studies.ensemble.render_ensemble import draw

SMALL = os.environ.get("SEAGLINT_GALLERY_SIZE") == "small"
laws = [
    {"key": "wind.speed_m_s", "law": "uniform", "min": 2, "max": 14},
    {
        "key": "sun.zenith_deg",
        "law": "normal",
        "mean": 65,
        "standard_deviation": 10,
        "min": 40,
        "max": 85,
    },
]
figure, panels = plt.subplots(
    1, 3, figsize=(9, 3.4), sharex=True, sharey=True, layout="constrained"
)
for axes, sampling in zip(panels, ("random", "latin_hypercube", "sobol"), strict=True):
    ensemble = {"scenes": 8 if SMALL else 32, "seed": 5, "sampling": sampling}
    scenes = draw(
        parse_ensemble(
            {
                "base": {"sensor": {"pixels": [32, 32]}},
                "ensemble": ensemble,
                "vary": laws,
            }
        )
    )
    wind = [scene.scenario.wind.speed_m_s for scene in scenes]
    sun = [scene.parameters["sun.zenith_deg"] for scene in scenes]
    axes.scatter(wind, sun, s=18, alpha=0.8)
    for value in wind:  # draws of either law alone, along the edges
        axes.plot([value, value], [40, 40.8], color="C0", lw=0.7)
    for value in sun:
        axes.plot([2, 2.2], [value, value], color="C0", lw=0.7)
    axes.set(title=sampling, xlabel="wind speed [m/s]", xlim=(2, 14), ylim=(40, 85))
panels[0].set_ylabel("solar zenith [deg]")
figure.savefig("ensemble_draws.png", dpi=90)
