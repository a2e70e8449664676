"""A texture of a sea.

Rendered glint from above and a sample of the Gauss-Markov texture fitted to it, which has no edges and no end, with the same scale.
"""

import os

import matplotlib.pyplot as plt
import numpy as np

import seaglint as sg
from seaglint.analysis import Recording
from seaglint.studies.study_requests import FitRequest, SampleRequest
from seaglint.studies.texture.texture_sequences import fit, loop

SMALL = os.environ.get("SEAGLINT_GALLERY_SIZE") == "small"
SIZE = 48 if SMALL else 128
scene = sg.load(
    {
        "sun": {"zenith_deg": 30, "azimuth_deg": 180},
        "wind": {"speed_m_s": 6, "from_deg": 180},
        "sensor": {
            "height_m": 400,
            "elevation_deg": -90,
            "projection": "pinhole",
            "fov_deg": [8, 8],
            "pixels": [SIZE, SIZE],
        },
        "sea": {"shortest_wave_m": 4 if SMALL else 1},
    }
)
frames = sg.image(scene).radiance.values[np.newaxis]
recording = Recording(
    "sea", *frames.shape, read_block=lambda start, stop: frames[start:stop]
)
fitted = fit(recording, FitRequest(tails="gamma", any_region=True))
sample = loop(fitted.stored, SampleRequest((SIZE, SIZE), seed=1)).texture
figure, panels = plt.subplots(
    1, 2, figsize=(9.6, 4.4), sharey=True, layout="constrained"
)
low, high = np.percentile(frames, [1, 99])
for axes, picture, title in zip(
    panels, (frames[0], sample[0]), ("rendered", "sample of its texture"), strict=True
):
    shown = axes.imshow(picture, cmap="gray", vmin=low, vmax=high)
    axes.set(title=title, xlabel="column", ylabel="row")
figure.colorbar(shown, ax=panels, label="radiance [W m⁻² sr⁻¹]", extend="both")
figure.savefig("texture.png", dpi=90)
