"""Likelihood of glint in three regions of the sea, for the figure ``likelihood_regions.png``."""

from __future__ import annotations

from typing import Final

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.climate.conditions import months_of
from seaglint.scenario.load import parse_scenario
from seaglint.studies.likelihood.draw_model import LikelihoodModel
from seaglint.studies.likelihood.glint_chance import draw, draw_values

#: Latitudes and longitudes [deg].
REGIONS: Final = {
    "Norwegian Sea, 65-72 N": ((65.0, 72.0), (-5.0, 15.0)),
    "open North Atlantic, 45-58 N": ((45.0, 58.0), (-45.0, -12.0)),
    "Azores to Canaries, 27-40 N": ((27.0, 40.0), (-32.0, -14.0)),
}

THRESHOLDS: Final = (0.05, 0.1, 0.25, 0.5, 1.0, 2.5, 5.0, 10.0, 25.0)
_MONTHLY: Final = THRESHOLDS.index(0.25)


def regions(samples: int = 131_072) -> dict[str, dict[str, FloatArray]]:
    """Return chances by threshold, and by month at 0.25 W m-2 sr-1, of a look within 15 deg of the Sun, in the weather of its seas."""
    results = {}
    for name, (latitudes, longitudes) in REGIONS.items():
        settings = {
            "threshold_w_m2_sr": list(THRESHOLDS),
            "latitudes_deg": list(latitudes),
            "longitudes_deg": list(longitudes),
            "azimuth_from_sun_deg": [-15.0, 15.0],
            "samples": samples,
        }
        model = LikelihoodModel.of(
            parse_scenario({"band": {"min_um": 3.0, "max_um": 5.0}, "sensor": {"height_m": 30.0}, "likelihood": settings})
        )
        drawn = draw(model)
        values = [draw_values(model, drawn, threshold) for threshold in THRESHOLDS]
        month = months_of(drawn.where.time)
        results[name] = {
            "threshold": np.array(THRESHOLDS),
            "probability": np.array([np.average(v, weights=drawn.weight) for v in values]),
            "by_month": np.array([np.average(values[_MONTHLY][month == m], weights=drawn.weight[month == m]) for m in range(1, 13)]),
        }
    return results
