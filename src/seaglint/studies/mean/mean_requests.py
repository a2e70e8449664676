"""Requests for mean radiance: of the view of a scenario, and of the rows of a table of cases.

Importing this module loads nothing else: a help page needs it.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

from seaglint.base.parameters import Parameter
from seaglint.studies.reading_requests import Overwrite


@dataclass(frozen=True)
class MeanRequest:
    """Request to map mean radiance and apparent temperature over the view of a scenario."""

    scenario: Annotated[
        Path, Parameter("scenario file; 'seaglint init my.toml' writes one", metavar="SCENARIO.toml", python="See :func:`load`.")
    ]
    overwrite: Overwrite = False


@dataclass(frozen=True)
class EvaluationRequest:
    """Request to evaluate a table of cases row by row."""

    extrapolate: Annotated[bool, Parameter("take winds and heights that are not covered, and name them in the column 'extrapolated'")] = (
        False
    )
    overwrite: Overwrite = False


@dataclass(frozen=True)
class BandsRequest(EvaluationRequest):
    """Request to evaluate a table of cases in some spectral bands."""

    bands: Annotated[
        tuple[str, ...],
        Parameter(
            "wavelengths in um, e.g. 3.0-5.0; may be repeated",
            metavar="A-B",
            option="--band",
            python="Bands inside the tables, as :func:`parse_bands` gives them.",
        ),
    ] = ()


@dataclass(frozen=True)
class AirRequest(BandsRequest):
    """Request to evaluate the air in a table of cases."""

    levels: Annotated[
        Literal["lowtran", "continuous"],
        Parameter(
            "lowtran: LOWTRAN7's own layers, from tables; continuous: air that emits by the temperature at the place",
            python="``lowtran`` for LOWTRAN7's own layers, from tables; ``continuous`` for air that emits by the temperature at the place.",
        ),
    ] = "lowtran"
