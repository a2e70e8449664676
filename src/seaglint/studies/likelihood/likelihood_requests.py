"""Request for the likelihood of glint: of a scenario, over a map by month, or along a ship's way.

Importing this module loads nothing else: a help page needs it.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from seaglint.base.parameters import Parameter


@dataclass(frozen=True)
class LikelihoodRequest:
    """Request for the likelihood that glint exceeds thresholds, as the scenario's table ``[likelihood]`` says."""

    by_month: Annotated[bool, Parameter("map the region of [likelihood] by month: OUT.nc or a folder", option="--map")] = False
    step: Annotated[float, Parameter("step of the map [deg]", least=0.05, detail="It is width and height of a cell.")] = 1.0
    track: Annotated[
        Path | None,
        Parameter(
            "CSV of a ship's way: time_utc, latitude_deg, longitude_deg and, if it looks one way, bearing_deg",
            detail="Bearings are clockwise from north; without them azimuths from the Sun are those of the scenario.",
        ),
    ] = None
