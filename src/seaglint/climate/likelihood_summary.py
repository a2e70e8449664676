"""Chances of glint as plain numbers: what JSON, tables, charts and text read."""

from __future__ import annotations

from dataclasses import asdict, dataclass

from seaglint.base.free_form import JsonObject, TableRow


@dataclass(frozen=True)
class ThresholdChance:
    """Chance that glint exceeds a threshold."""

    threshold_w_m2_sr: float  #: Threshold [W m-2 sr-1].
    probability: float  #: Chance, or share of looks that are detected [1].
    interval: list[float]  #: Ends of its 95 % interval [1].
    false_alarms_per_hour: float | None = None  #: False alarms of all pixels [h-1], where they are the requested quantity.
    false_alarms_per_hour_interval: list[float] | None = None  #: Ends of their 95 % interval [h-1].
    sea_unknown_low: float | None = None  #: Chance that 5 % of the seas between the campaigns are below [1]; None without drawn seas.
    sea_unknown_high: float | None = None  #: Chance that 5 % of the seas between the campaigns are above [1].
    sea_unknown_median: float | None = None  #: Median of the seas between the campaigns [1].
    sea_draws: int | None = None  #: Number of these seas.
    false_alarms_per_hour_sea_unknown: list[float] | None = None  #: Both ends for false alarms, where they are requested [h-1].

    def as_row(self) -> TableRow:
        """Return the numbers; false alarms and the interval over drawn seas only where they are requested."""
        always = ("threshold_w_m2_sr", "probability", "interval")
        return {name: value for name, value in asdict(self).items() if name in always or value is not None}


@dataclass(frozen=True)
class StratumChance:
    """Chance of glint among the draws between two values of a quantity."""

    threshold_w_m2_sr: float  #: Threshold [W m-2 sr-1].
    by: str  #: Quantity, with its unit.
    low: float  #: Lower end of its range.
    high: float | None  #: Upper end of its range, which is outside; None without an end.
    share: float  #: Share of all draws [1].
    value: float  #: Chance of glint among these draws [1].
    interval_low: float  #: Lower end of its 95 % interval [1].
    interval_high: float  #: Upper end of its 95 % interval [1].
    contribution: float | None  #: Share of all glint that these draws bring [1]; None without any.


@dataclass(frozen=True)
class ExceededContrast:
    """Radiance that glint exceeds in a share of the looks."""

    share_of_looks: float
    radiance_w_m2_sr: float


@dataclass(frozen=True)
class LightUp:
    """Share of the draws with the centre of Sun or Moon above the horizon [1], and its 95 % interval."""

    share: float
    interval: list[float]


@dataclass(frozen=True)
class DrawnWeather:
    """Table of weather that is drawn from: its file, the number of its rows, and the atmospheres."""

    file: str | None
    rows: int
    models: list[str]


@dataclass(frozen=True)
class LikelihoodSummary:
    """Chances of glint, where they come from, and how they were drawn."""

    quantity: str  #: Requested quantity.
    case: str  #: Kind of look.
    results: list[ThresholdChance]  #: Chance of each threshold.
    sun_up: LightUp  #: Share of the draws in which the Sun is up.
    sun_free_of_clouds: float  #: Share in which clouds leave it free, or with a Moon the brighter one of both [1].
    contrast_exceeded_by_glint: list[ExceededContrast]  #: Radiances by the share of looks that exceed them.
    samples: int  #: Number of draws.
    scramblings: int  #: Number of independent sets of draws.
    azimuths: str  #: Treatment of the azimuth of looks.
    sampling: str  #: ``even``, or ``towards glint`` where draws are concentrated and weighted.
    confidence: float  #: Level of the intervals [1].
    clouds: str  #: Law of the Sun behind clouds.
    weather: DrawnWeather  #: Table of weather.
    strata: list[StratumChance]  #: Chances by threshold and condition.
    notes: list[str]  #: Remarks.
    moon_up: LightUp | None = None  #: Share of the draws in which the Moon is up; None without a Moon.

    def as_dict(self) -> JsonObject:
        """Return plain numbers and text; ``moon_up`` only with a Moon."""
        values = asdict(self) | {"results": [chance.as_row() for chance in self.results]}
        return {name: value for name, value in values.items() if name != "moon_up" or value is not None}
