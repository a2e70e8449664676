"""Through three sensors.

One sea at the aperture and as three ready sensors of published data see it, each in its own band, pixels and noise.
"""

import os
import tempfile

import matplotlib.pyplot as plt

import seaglint as sg
from seaglint.scenario.presets import with_sensor

SMALL = os.environ.get("SEAGLINT_GALLERY_SIZE") == "small"
SCENE = {
    "seed": 3,
    "sun": {"zenith_deg": 130},
    "wind": {"speed_m_s": 7, "from_deg": 30},
    "sensor": {"height_m": 15, "elevation_deg": -3.2},
    "sea": {"shortest_wave_m": 8 if SMALL else 1},
}
NAMES = ("mwir-insb-640", "lwir-mct-640", "lwir-microbolometer-640")
figure, panels = plt.subplots(3, 2, figsize=(9.6, 8.4), layout="constrained")
for line, name in zip(panels, NAMES, strict=True):
    tables = with_sensor(SCENE, name)
    tables["sensor"] |= {"pixels": [32, 20] if SMALL else [160, 100], "frames": 1}
    with tempfile.TemporaryDirectory() as folder:
        run = sg.render(sg.load(tables), f"{folder}/run.zarr", radiance=True)
        pictures = {
            "at the aperture": run.radiance.load(),
            "from the counts": run.load(),
        }
    for axes, (where, seen) in zip(line, pictures.items(), strict=True):
        kelvin = sg.apparent_temperature(seen).isel(time=0)
        low, high = kelvin.quantile([0.01, 0.99])
        shown = axes.imshow(kelvin, cmap="gray", vmin=low, vmax=high)
        figure.colorbar(shown, ax=axes, label="K")
        axes.set(title=f"{name}: {where}", xlabel="column", ylabel="row")
figure.savefig("sensor_presets.png", dpi=80)
