"""Operating characteristics.

Five detectors on the same independent seas at the edge of the corridor: share of points found against false alarms per pixel.
"""

import os

import matplotlib.pyplot as plt
import numpy as np

import seaglint as sg
from seaglint.analysis import Recording
from seaglint.detection.spot import GaussianSpot
from seaglint.detection.trials import InjectedObjects
from seaglint.studies.detect.performance import DetectionOptions, detect

SMALL = os.environ.get("SEAGLINT_GALLERY_SIZE") == "small"
scene = sg.load(
    {
        "sun": {"zenith_deg": 70, "azimuth_deg": 180},
        "wind": {"speed_m_s": 5, "from_deg": 200},
        "sensor": {
            "height_m": 30,
            "azimuth_deg": 190,
            "elevation_deg": -2.5,
            "fov_deg": [3.6, 1.8],
            "pixels": [32, 24] if SMALL else [96, 48],
            "pixel_shape": "any",
        },
        "sea": {"shortest_wave_m": 8} if SMALL else {},
    }
)
run = np.stack(
    [
        sg.image(scene.model_copy(update={"seed": seed})).radiance.values
        for seed in range(2 if SMALL else 12)
    ]
)
recording = Recording(
    "seas", *run.shape, read_block=lambda start, stop: run[start:stop]
)
contrast = 3 * float(run.std())
objects = InjectedObjects(
    GaussianSpot(0.8), contrasts=(contrast,), injections=400 if SMALL else 4000
)
figure, axes = plt.subplots(figsize=(6.4, 4.8), layout="constrained")
for name in ("threshold", "matched", "top-hat", "ca-cfar", "max-median"):
    curve = detect(
        recording, DetectionOptions(objects, detector=name, threshold=3.0)
    ).characteristic()
    axes.plot(curve.p_fa, curve.p_d, label=name)
axes.set(
    xscale="log",
    xlim=(1e-4, 1),
    ylim=(0, 1),
    xlabel="false alarms per pixel P_fa [1]",
    ylabel="P_d [1]",
)
axes.set_title(
    f"points of {contrast:.2g} W m⁻² sr⁻¹, three standard deviations of the sea"
)
axes.grid(alpha=0.3)
axes.legend()
figure.savefig("roc.png", dpi=90)
