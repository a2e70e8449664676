"""Seas between the campaigns for one scenario, and the interval of a result over them: how far it is unknown with the sea.

Only the sea differs between the scenarios of ``sea_draws``: seed, phases of waves, weather and noise are the same, so that differences of
their results are due to the short waves alone.
"""

from __future__ import annotations

import logging
from collections.abc import Sequence
from functools import lru_cache
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from seaglint.base.conventions import FloatArray, Progress
from seaglint.base.errors import ScenarioError
from seaglint.scenario.model import Scenario
from seaglint.sea.spectra.campaign_draws import LONGEST, ShortWaveLevels, drawn_levels
from seaglint.studies.study_requests import require_sea_draws

log = logging.getLogger(__name__)

SHARES: Final = (0.05, 0.95)  #: Shares of the drawn seas between which the interval lies [1].

LOW, HIGH, COUNT = "sea_unknown_low", "sea_unknown_high", "sea_draws"  #: Names of the ends in results, and of the number of seas.


class SeaUnknown(NamedTuple):
    """Interval of a result over drawn seas; arrays have the shape of the result."""

    low: FloatArray  #: Value that 5 % of the seas are below.
    high: FloatArray  #: Value that 5 % of the seas are above.
    median: FloatArray
    draws: int  #: Number of seas.

    @classmethod
    def of(cls, values: ArrayLike) -> SeaUnknown:
        """Return the interval of the results of drawn seas along the first axis; linear between sorted results, NaN where one is NaN.

        Examples
        --------
        >>> SeaUnknown.of([3.0, 1.0, 2.0]).low.round(2).item()
        1.1
        """
        each = np.asarray(values, dtype=np.float64)
        low, median, high = np.quantile(each, [SHARES[0], 0.5, SHARES[1]], axis=0)
        return cls(low, high, median, each.shape[0])

    def as_dict(self, name: str = "") -> dict[str, Any]:
        """Return both ends and the median of a single number, with the number of seas; ``name`` begins the keys of the ends."""
        before = f"{name}_" if name else ""
        ends = {LOW: self.low, HIGH: self.high, "sea_unknown_median": self.median}
        return {f"{before}{key}": float(value) if np.isfinite(value) else None for key, value in ends.items()}

    def line(self, form: str = ".4g", unit: str = "") -> str:
        """Return the interval of a single number in plain words."""
        return sea_line(float(self.low), float(self.high), self.draws, form, unit)


def sea_line(low: float, high: float, draws: int, form: str = ".4g", unit: str = "", value: float | None = None) -> str:
    """Return an interval over drawn seas in plain words; it says so where the result of the scenario's own sea is outside.

    Examples
    --------
    >>> sea_line(0.51, 0.72, 20, unit="K")
    'sea unknown: 0.51 to 0.72 K (20 seas between the campaigns)'
    """
    line = f"sea unknown: {low:{form}} to {high:{form}}{f' {unit}' if unit else ''} ({draws} seas between the campaigns)"
    if value is None or low <= value <= high or not np.isfinite(value):
        return line
    return f"{line}; the result is outside: drawn seas have the slopes of their waves, not of sea.slopes"


def levels_of(seed: int, draws: int) -> list[ShortWaveLevels]:
    """Return the levels of some seas, as ``sea_draws`` gives them to scenarios of that seed."""
    require_sea_draws(draws)
    return [drawn_levels(seed, number, draws) for number in range(draws)]


def sea_draws(scenario: Scenario, draws: int) -> list[Scenario]:
    """Return the scenario with each of some seas between the campaigns.

    Raises
    ------
    ScenarioError
        A scenario whose sea cannot be drawn.
    DataError
        A number of seas that is not allowed.
    """
    return with_seas(scenario, levels_of(scenario.seed, draws))


def with_seas(scenario: Scenario, levels: Sequence[ShortWaveLevels]) -> list[Scenario]:
    """Return the scenario with seas of some levels; see ``sea_draws``."""
    require_drawn(scenario)
    return [
        scenario.model_copy(update={"sea": scenario.sea.model_copy(update={"uncertainty": "campaigns", "short_wave_levels": tuple(level)})})
        for level in levels
    ]


def require_drawn(scenario: Scenario) -> None:
    """Refuse a scenario whose sea cannot be drawn between the campaigns; report measured waves that the drawn seas do not have."""
    if (reason := scenario.sea_not_drawn) is not None:
        raise ScenarioError(f"sea_draws {reason}, or leave sea_draws out")
    if scenario.wind.speed_m_s == 0.0 and scenario.likelihood is None:
        raise ScenarioError("sea_draws draws the short waves of a wind, and wind.speed_m_s = 0; set a wind, or leave sea_draws out")
    if (kind := scenario.sea.measured_kind) is not None:
        _report_measured_waves(kind)


@lru_cache(maxsize=64)
def _report_measured_waves(kind: str) -> None:
    """Report once that drawn seas have other short waves than a measured spectrum."""
    log.warning(
        "seaglint: sea_draws: the seas are drawn between the campaigns from %g rad/m on and have only longer waves of sea.spectrum '%s': "
        "their interval need not contain the result of the measured sea",
        LONGEST,
        kind,
    )


def part_of(progress: Progress | None, number: int, parts: int) -> Progress | None:
    """Return the progress of one of several equal parts of a piece of work."""
    if progress is None:
        return None
    return lambda done, total: progress(number * total + done, parts * total)
