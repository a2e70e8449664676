"""NETD, seen and computed.

A microbolometer looks at an even plate of 300 K: the spread of each pixel over time beside the NETD that `seaglint sensor` states.
"""

import os

import matplotlib.pyplot as plt
import numpy as np

import seaglint as sg
from seaglint.scenario.presets import with_sensor
from seaglint.studies.build.sensor_model import sensor_model

SMALL = os.environ.get("SEAGLINT_GALLERY_SIZE") == "small"
tables = with_sensor({}, "lwir-microbolometer-640")
size = 24 if SMALL else 96
scene = sg.load(tables | {"sensor": tables["sensor"] | {"pixels": [size, size]}})
plate = float(sensor_model(scene).photons.radiance(300.0))
seen = sg.apparent_temperature(
    sg.sense(np.full((20 if SMALL else 100, size, size), plate), scene, oversampling=1)
)
spread = 1000 * seen.std("time")
stated = 1000 * sg.sensor(scene)["netd_k"]
figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4.2), layout="constrained")
shown = left.imshow(seen.isel(time=0), cmap="gray")
left.set(title="first frame", xlabel="column", ylabel="row")
figure.colorbar(shown, ax=left, label="apparent temperature [K]")
right.hist(spread.values.ravel(), bins=40, color="0.6")
right.axvline(stated, color="tab:red", label=f"NETD {stated:.0f} mK")
right.set(
    title="each pixel over time", xlabel="standard deviation [mK]", ylabel="pixels"
)
right.legend()
figure.savefig("noise.png", dpi=90)
