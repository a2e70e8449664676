"""Waves by length.

The model spectra for three winds and a swell; shaded is what a scenario with waves down to 2 m draws as geometry.
"""

import os

import matplotlib.pyplot as plt
import numpy as np

from seaglint.sea.spectra.elfouhaily import ElfouhailySpectrum
from seaglint.sea.spectra.jonswap import JonswapSpectrum

SMALL = os.environ.get("SEAGLINT_GALLERY_SIZE") == "small"
k = np.geomspace(1e-2, 1e3, 100 if SMALL else 1000)
figure, axes = plt.subplots(figsize=(7.2, 4.6), layout="constrained")
for speed in (5, 10, 15):
    sea = ElfouhailySpectrum(speed)
    axes.loglog(
        k,
        k**3 * sea.omnidirectional(k),
        label=f"Elfouhaily, {speed} m/s: Hs {sea.significant_height():.1f} m",
    )
swell = JonswapSpectrum(2.0, 12.0, 0.0, gamma=5.0)
axes.loglog(k, k**3 * swell.omnidirectional(k), "--", label="JONSWAP swell, 2 m, 12 s")
axes.axvspan(
    k[0], 2 * np.pi / 2.0, color="0.92", zorder=0, label="longer than 2 m: geometry"
)
axes.set(
    xlabel="wavenumber k [rad m⁻¹]",
    ylabel="curvature spectrum k³S(k) [1]",
    ylim=(1e-5, 1),
    xlim=(k[0], k[-1]),
)
lengths = axes.secondary_xaxis(
    "top",
    functions=(
        lambda v: 2 * np.pi / np.maximum(v, 1e-9),
        lambda v: 2 * np.pi / np.maximum(v, 1e-9),
    ),
)
lengths.set_xlabel("wavelength [m]")
axes.legend(fontsize=8)
figure.savefig("wave_spectrum.png", dpi=90)
