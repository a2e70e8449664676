"""Requests for mean radiance: of the view of a scenario, and of the rows of a table of cases.

Importing this module loads nothing else: a help page needs it.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from seaglint.base.parameters import Parameter
from seaglint.studies.reading_requests import Overwrite


@dataclass(frozen=True)
class MeanRequest:
    """Request to map mean radiance and apparent temperature over the view of a scenario."""

    scenario: Annotated[
        Path, Parameter("scenario file; 'seaglint init my.toml' writes one", metavar="SCENARIO.toml", python="See :func:`load`.")
    ]
    overwrite: Overwrite = False
