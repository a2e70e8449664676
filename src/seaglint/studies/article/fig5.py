"""The source article's Fig. 5, computed anew: the chance that glint exceeds a threshold, against the azimuth from the Sun.

Settings of the article: 3-5 um, band means, isotropic slopes, one shadowed leg; depressions of 1.5 to 6 deg; time uniform over the day and
the year, place uniform over the North Atlantic; a single look with its clouds, a trajectory over all depressions, and one widened by a
field of view of 4 x 4 deg, both hidden by an overcast sky alone. Its height and weather are not told: 30 m and the packaged table here.

The caption's threshold of 0.25 W cm-2 sr-1 is 2500 W m-2 sr-1. The Sun itself shows some 1e5 W m-2 sr-1 in 3-5 um, but of a sea with
1 m/s of wind or more few facets mirror it: glint stays below a few hundred W m-2 sr-1. A thousandth of the caption's number,
0.25 mW cm-2 sr-1, is 2.5 W m-2 sr-1; 0.25 W m-2 sr-1 stands beside it.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np

from seaglint.base.conventions import FloatArray, Progress
from seaglint.base.free_form import TomlTables
from seaglint.climate.draws import estimate
from seaglint.scenario.load import parse_scenario
from seaglint.studies.likelihood.draw_model import LikelihoodModel
from seaglint.studies.likelihood.glint_chance import draw

THRESHOLDS: Final = (2.5, 0.25)  #: 0.25 mW cm-2 sr-1, and the number of the caption in W m-2 sr-1 [W m-2 sr-1].

PRINTED: Final = 2500.0  #: The caption's 0.25 W cm-2 sr-1 [W m-2 sr-1].

CASES: Final = ("single-look", "trajectory", "field-of-view")
#: Azimuths from the Sun [deg].
AZIMUTHS: Final = np.array([0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 12.5, 15.0, 20.0, 25.0, 30.0, 40.0, 60.0, 90.0, 180.0])
NORTH_ATLANTIC: Final = {"latitudes_deg": [35.0, 65.0], "longitudes_deg": [-70.0, 0.0]}
HEIGHT: Final = 30.0
SAMPLES: Final = 8192


@dataclass(frozen=True, eq=False)
class Fig5:
    """Both panels: columns by name, ``case`` counts :data:`CASES`; and what the printed threshold gives."""

    columns: dict[str, FloatArray]
    brightest: float  #: Brightest glint of all draws [W m-2 sr-1].
    printed: float  #: Largest chance of the caption's threshold at any azimuth [1].


def scenario(case: str, weather: Path | None, mode: str = "article", samples: int = SAMPLES) -> TomlTables:
    """Mapping of the scenario of one case."""
    table: TomlTables = {"case": case, "samples": samples, "threshold_w_m2_sr": list(THRESHOLDS), **NORTH_ATLANTIC}
    if weather is not None:
        table["weather"] = str(weather)
    sea: TomlTables = {"water": "article", "slopes": {"kind": "cox-munk-isotropic"}} if mode == "article" else {}
    return {
        "atmosphere": {"spectroscopy": "lowtran7"},
        "band": {"min_um": 3.0, "max_um": 5.0},
        "sensor": {"height_m": HEIGHT},
        "mean": {"mode": mode},
        "sea": sea,
        "likelihood": table,
    }


def figure_5(weather: Path | None = None, *, mode: str = "article", samples: int = SAMPLES, report: Progress | None = None) -> Fig5:
    """Compute both panels.

    Parameters
    ----------
    weather : Path, optional
        Weather table; the packaged North Atlantic where nothing is given.
    mode : {"article", "spectral"}
        The article's way of the radiance, or this program's.
    samples : int
        Draws for each azimuth.
    report : callable, optional
        Told steps done and all of them.

    Notes
    -----
    (a) is the chance at one azimuth, the same to both sides of the Sun for winds from anywhere. The caption's (b), "for any azimuth less
    than theta_T", can be read in two ways, and both are computed: that some azimuth up to theta_T from the Sun's, of those in
    :data:`AZIMUTHS` to both sides, exceeds (``probability_within``; the same draws look at all azimuths), and that a look in a direction
    drawn evenly among them does (``probability_averaged``, the mean of (a) up to theta_T).
    """
    tell = report or (lambda done, total: None)
    rows: list[tuple[float, ...]] = []
    brightest, printed = 0.0, 0.0
    total = len(CASES) * (2 * AZIMUTHS.size - 1)
    done = 0
    for number, case in enumerate(CASES):
        model = LikelihoodModel.of(parse_scenario(scenario(case, weather, mode, samples)))
        within: dict[float, FloatArray] = {}
        for azimuth in AZIMUTHS.tolist():
            sides = []
            for side in (1.0, -1.0) if azimuth > 0.0 else (1.0,):
                tell(done, total)
                sides.append(draw(model, azimuth=side * np.radians(azimuth)))
                done += 1
            brightest = max(brightest, *(float(d.radiance.max()) for d in sides))
            printed = max(printed, *(float(np.average(d.illuminated * (d.radiance > PRINTED), weights=d.weight)) for d in sides))
            for threshold in THRESHOLDS:
                above = [(d.radiance > threshold).astype(np.float64) for d in sides]
                within[threshold] = np.maximum(within.get(threshold, np.zeros(1)), np.max(above, axis=0))
                both = np.mean([d.illuminated * a for d, a in zip(sides, above, strict=True)], axis=0)
                here = estimate(both, sides[0].plan, weight=sides[0].weight)
                any_ = estimate(sides[0].illuminated * within[threshold], sides[0].plan, weight=sides[0].weight)
                rows.append((number, threshold, azimuth, here.value, here.low, here.high, any_.value, any_.low, any_.high))
    tell(total, total)
    names = (
        "case", "threshold_w_m2_sr", "azimuth_deg", "probability", "interval_low", "interval_high",
        "probability_within", "within_low", "within_high",
    )  # fmt: skip
    table = np.array(rows)
    columns = {name: table[:, i] for i, name in enumerate(names)}
    return Fig5({**columns, "probability_averaged": _averaged(columns)}, brightest, printed)


def _averaged(columns: dict[str, FloatArray]) -> FloatArray:
    """Mean of (a) over azimuths from the Sun's to each, by trapezia [1]."""
    out = np.empty(columns["probability"].size)
    for number in range(len(CASES)):
        for threshold in THRESHOLDS:
            at = (columns["case"] == number) & (columns["threshold_w_m2_sr"] == threshold)
            chance, azimuth = columns["probability"][at], columns["azimuth_deg"][at]
            sums = np.cumsum(0.5 * (chance[1:] + chance[:-1]) * np.diff(azimuth))
            out[at] = np.concatenate([chance[:1], sums / azimuth[1:]])
    return out
