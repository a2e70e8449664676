"""A wind rose.

What `seaglint weather info --plot` draws of a table with directions. The table here is made up: 3000 hours, mostly from the south-west.
"""

import os
import tempfile
from pathlib import Path

import numpy as np

from seaglint.plot.environment_charts import write_weather_plot
from seaglint.studies.likelihood.weather_files import describe

SMALL = os.environ.get("SEAGLINT_GALLERY_SIZE") == "small"
rng = np.random.default_rng(1)
hours = 300 if SMALL else 3000
speed = 8 * rng.weibull(2.1, hours)
towards = (225 + 55 * rng.standard_normal(hours)) % 360
cover = rng.beta(2.0, 1.0, hours)
month = rng.integers(1, 13, hours)
with tempfile.TemporaryDirectory() as folder:
    rows = np.column_stack([speed, towards, cover, month])
    heads = "wind_speed_m_s,wind_from_deg,cloud_cover,month"
    np.savetxt(
        f"{folder}/made-up.csv",
        rows,
        fmt=["%.2f", "%.1f", "%.3f", "%d"],
        delimiter=",",
        header=heads,
        comments="",
    )
    _, facts = describe(f"{folder}/made-up.csv")
write_weather_plot(facts, Path("wind_rose.png"))
