"""Slope models that the rows of a spreadsheet of cases name."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from typing import Final

import numpy as np
from numpy.typing import NDArray

from seaglint.files.tables.cases import Cases
from seaglint.sea.slopes.cox_munk import cox_munk_anisotropic, cox_munk_gram_charlier, cox_munk_isotropic
from seaglint.sea.slopes.from_spectrum import nested_in
from seaglint.sea.slopes.slope_statistics import SlopeStatistics
from seaglint.studies.prepare.wave_spectra import elfouhaily

#: Column of the cases of the mean that may be missing: where the wind comes from, clockwise from the Sun's azimuth.
WIND_FROM: Final = "wind_from_deg"

SLOPES: Final = "slopes"  #: Another that may be missing: the slope model of each row, one of :data:`SLOPE_KINDS`.

SLOPE_KINDS: Final = ("cox-munk-isotropic", "cox-munk-anisotropic", "cox-munk-gram-charlier")


def slope_kinds(cases: Cases, directed: bool) -> NDArray[np.str_]:
    """Slope model of every row; those that have a direction need the wind's."""
    if SLOPES not in cases.header:
        return np.full(len(cases), SLOPE_KINDS[1 if directed else 0])
    kinds = np.array(cases.choice(SLOPES, SLOPE_KINDS))
    if not directed:
        cases.check(
            kinds == SLOPE_KINDS[0],
            SLOPES,
            lambda row: f"'{kinds[row]}' depends on the wind's direction; add a column {WIND_FROM}, or give '{SLOPE_KINDS[0]}'",
        )
    return kinds


def slopes_of(kind: str, speed: float, towards: float, extrapolate: bool) -> SlopeStatistics:
    """Slopes of a wind at 10 m towards an azimuth [rad], over the waves of Elfouhaily's spectrum as a scenario has them by default."""
    made = _law(kind, speed, towards, extrapolate)
    return made if kind == SLOPE_KINDS[0] else replace(made, nesting=_nesting(kind, speed, extrapolate))


def _law(kind: str, speed: float, towards: float, extrapolate: bool) -> SlopeStatistics:
    match kind:
        case "cox-munk-isotropic":
            return cox_munk_isotropic(speed, extrapolate=extrapolate)
        case "cox-munk-anisotropic":
            return cox_munk_anisotropic(speed, towards, extrapolate=extrapolate)
        case _:
            return cox_munk_gram_charlier(speed, towards, extrapolate=extrapolate)


@lru_cache(maxsize=4096)
def _nesting(kind: str, speed: float, extrapolate: bool) -> tuple[tuple[float, float, float, float], ...]:
    """Covariances of the longer waves along and across the wind, whatever its direction."""
    made = _law(kind, speed, 0.0, extrapolate)
    return nested_in(made, elfouhaily(speed, made.wind_to_azimuth) if speed > 0.0 else None).nesting
