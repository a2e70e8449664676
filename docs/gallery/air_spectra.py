"""Through the air.

Transmittance from the sea to a sensor at 30 m over three distances, 20 cm⁻¹ wide as in LOWTRAN7, with two usual bands.
"""

import os

import matplotlib.pyplot as plt

from seaglint.studies.build.profile_air import model_air

SMALL = os.environ.get("SEAGLINT_GALLERY_SIZE") == "small"
figure, axes = plt.subplots(figsize=(8.4, 4.4), layout="constrained")
for limits in ((2.1, 5.4), (7.6, 13.9)):
    air = model_air("midlatitude-summer", 7.0, limits)
    for kilometres, colour in {1: "tab:blue", 5: "tab:orange", 15: "tab:red"}.items():
        label = f"{kilometres} km" if limits[0] < 3 else None
        axes.plot(
            1e4 / air.wavenumber_cm,
            air.transmittance(30.0, 1000.0 * kilometres),
            color=colour,
            lw=1,
            label=label,
        )
for low, high in ((3.5, 5.0), (8.0, 12.0)):
    axes.axvspan(low, high, color="0.92", zorder=0)
    axes.text(0.5 * (low + high), 0.95, f"{low:g}-{high:g} µm", ha="center")
axes.set(
    xlabel="wavelength [µm]",
    ylabel="transmittance [1]",
    ylim=(0, 1),
    title="midlatitude summer, Navy maritime haze at 7 m/s",
)
axes.legend()
figure.savefig("air_spectra.png", dpi=90)
