"""Statistics of a recording and its regions as plain numbers: what JSON, text, tables and reports read.

Numbers that do not exist are None, with the reason beside them. Units are in the names; brightness is in the recording's units.
"""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import Self

from seaglint.base.free_form import JsonObject
from seaglint.clutter.segmentation import Segmentation

Ends = list[float | None]  #: Lower and upper end of an interval.


def number(value: float) -> float | None:
    """Finite number, or None: JSON has no NaN."""
    return float(value) if math.isfinite(value) else None


@dataclass(frozen=True)
class FitSummary:
    """Fit of a family of distributions to the values of a region."""

    #: ``shape``, ``scale``, ``loc``: Parameters; None where there is no fit, and the shape of the Gaussian.
    shape: float | None
    scale: float | None
    loc: float | None
    #: ``shape_interval``, ``scale_interval``, ``loc_interval``: 95 % confidence intervals.
    shape_interval: Ends | None
    scale_interval: Ends | None
    loc_interval: Ends | None
    log_likelihood_per_value: float | None  #: Logarithm of the likelihood over the number of values [1].
    effective_count: float | None  #: Number of independent values.
    excluded: float  #: Share of the values that were left out, not above ``loc`` [1].
    #: ``ks``, ``ad``: Distances of Kolmogorov and Smirnov and of Anderson and Darling.
    ks: float | None
    #: ``ks_p``, ``ad_p``: Their levels [1].
    ks_p: float | None
    ad: float | None  #: See ``ks``.
    ad_p: float | None  #: See ``ks_p``.
    reason: str | None  #: Why there is no fit.


@dataclass(frozen=True)
class TailSummary:
    """Extreme-value tail of a filter or detector; without a fit only the reason."""

    from_sigma: float | None = None  #: Threshold from which the tail is fitted [standard deviations].
    events: int | None = None  #: Number of events that it is fitted to.
    #: ``shape``, ``scale_sigma``: Parameters of the generalised Pareto distribution; the scale in standard deviations.
    shape: float | None = None
    shape_interval: Ends | None = None  #: 95 % confidence interval of the shape.
    scale_sigma: float | None = None  #: See ``shape``.
    goodness_p: float | None = None  #: Level of the test of the fit [1].
    #: ``trusted_to_sigma``, ``trusted_to_rate``: Threshold and rate up to which the tail is trusted.
    trusted_to_sigma: float | None = None
    trusted_to_rate: float | None = None
    reason: str | None = None  #: Why there is no fit.

    def as_dict(self) -> JsonObject:
        """Return plain numbers and text; of a tail that is not there the reason alone."""
        return asdict(self) if self.from_sigma is not None else {"reason": self.reason}


@dataclass(frozen=True)
class AlarmSummary:
    """False alarms of a filter or detector at one threshold."""

    filter: str  #: Name of the filter or detector.
    threshold_sigma: float  #: Threshold [standard deviations].
    #: ``rate``, ``rate_low``, ``rate_high``: Exceedances per pixel and frame, and the ends of its 95 % interval [1].
    rate: float | None
    rate_low: float | None
    rate_high: float | None
    gaussian_rate: float  #: One-sided Gaussian tail [1].
    ratio: float | None  #: Rate over that of the Gaussian [1].
    exceedances: int  #: Number of pixels above the threshold.
    inflation: float | None  #: Variance of the rate over that of independent pixels [1].
    #: ``correlation_time_s``, ``correlation_time_frames``: 1/e time of the exceedances.
    correlation_time_s: float | None
    correlation_time_frames: float | None
    #: ``correlation_note``, ``note``: Why something is absent, or what the interval rests on.
    correlation_note: str | None
    note: str | None
    events: int | None  #: Number of connected sets of exceedances.
    #: ``events_per_frame``, ``event_duration_s``: Events in a frame, and their mean duration.
    events_per_frame: float | None
    event_duration_s: float | None
    tail: TailSummary | None  #: Extreme-value tail, at the lowest threshold.

    def as_dict(self) -> JsonObject:
        """Return plain numbers and text."""
        return asdict(self) | {"tail": None if self.tail is None else self.tail.as_dict()}


@dataclass(frozen=True)
class CorrelationLengths:
    """Distances along columns (x) and rows (y) at which the correlation falls to 1/e [px]."""

    x: float | None
    y: float | None


@dataclass(frozen=True)
class StationaritySummary:
    """Test of whether a region's mean and variance are the same everywhere."""

    #: ``p_mean``, ``p_variance``: Levels for the blocks' means and variances [1].
    p_mean: float | None
    p_variance: float | None
    block_px: list[int]  #: Rows and columns of a block [px].
    reason: str | None  #: Why it is not decidable.
    method: str  #: One line for reports.


@dataclass(frozen=True)
class SpectrumSummary:
    """Power spectral density of a region against the radial frequency [cycles px-1]."""

    frequency_cycles_px: list[float | None]
    density: list[float | None]


@dataclass(frozen=True)
class RegionSummary:
    """Statistics of one region."""

    #: ``pixels``, ``values``: Number of pixels, and of values over all frames.
    pixels: int
    values: int
    #: ``mean``, ``std``, ``skewness``, ``excess_kurtosis``, ``minimum``, ``maximum``: Moments and limits of the brightness.
    mean: float | None
    std: float | None
    skewness: float | None
    excess_kurtosis: float | None
    minimum: float | None
    maximum: float | None
    saturated: float  #: Share of saturated values [1].
    fits: dict[str, FitSummary]  #: Fits by family of distributions.
    false_alarms: list[AlarmSummary]  #: False alarms by filter or detector and threshold.
    correlation_length_px: CorrelationLengths  #: Correlation lengths, with ``correlation_length_reason`` where there are none.
    correlation_length_reason: str | None
    #: ``correlation_time_s``, ``correlation_time_frames``: 1/e time of the brightness, with ``correlation_time_reason`` where there is
    #: none.
    correlation_time_s: float | None
    correlation_time_frames: float | None
    correlation_time_reason: str | None
    stationary: bool | None  #: Whether the region is stationary; None where that is not decidable.
    stationarity: StationaritySummary  #: Test of it.
    spectrum: SpectrumSummary | None  #: Power spectrum; None of small pictures.
    notes: list[str]  #: Remarks.

    def as_dict(self) -> JsonObject:
        """Return plain numbers and text."""
        return asdict(self) | {"false_alarms": [alarm.as_dict() for alarm in self.false_alarms]}


@dataclass(frozen=True)
class SegmentationSummary:
    """Result of the search for a glint corridor."""

    found: bool  #: Whether there is a region of glint.
    method: str  #: One line for reports.
    #: ``separability``, ``contrast``, ``border_step``: Criteria of a corridor (:class:`seaglint.clutter.segmentation.Segmentation`).
    separability: float | None
    contrast: float | None
    border_step: float | None
    #: ``reason``, ``doubt``: Why there is none; criteria that it passes only narrowly.
    reason: str | None
    doubt: str | None
    sky_pixels: int  #: Number of pixels of sky or far sea, in neither region.

    @classmethod
    def of(cls, segmentation: Segmentation | None, *, found: bool) -> Self:
        """Return plain numbers of a segmentation; None stands for a mask that was given."""
        if segmentation is None:
            return cls(found, "mask given", None, None, None, None, None, 0)
        return cls(
            found,
            segmentation.method,
            number(segmentation.separability),
            number(segmentation.contrast),
            number(segmentation.border_step),
            segmentation.reason or None,
            segmentation.doubt or None,
            int(segmentation.sky.sum()),
        )


@dataclass(frozen=True)
class AnalysisSummary:
    """Statistics of a recording."""

    source: str  #: Name of the recording.
    #: ``frames``, ``rows``, ``columns``: Its size.
    frames: int
    rows: int
    columns: int
    units: str | None  #: Units of the brightness, as far as they are known.
    frame_rate_hz: float | None  #: Frame rate, as far as it is known [Hz].
    #: Blur of what made the frames beyond its pixels, a standard deviation [px]: 0 for radiance rendered without a sensor; None where it is
    #: not known.
    blur_px: float | None
    blur: str  #: The same in a sentence, with what it does to correlation times.
    filter: str  #: Filter before the thresholds.
    sigma_of: str  #: Whose standard deviation the thresholds count: frame, sequence or local.
    border: str  #: Whether pixels that the filter gives from beyond the border count.
    segmentation: SegmentationSummary  #: Search for the regions.
    regions: dict[str, RegionSummary | None]  #: Regions by name; None for those that are absent.
    notes: list[str]  #: Remarks.

    @property
    def present(self) -> dict[str, RegionSummary]:
        """Regions that are there, by name."""
        return {name: region for name, region in self.regions.items() if region is not None}

    def as_dict(self) -> JsonObject:
        """Return plain numbers and text of everything; absent regions are None."""
        return asdict(self) | {"regions": {name: None if one is None else one.as_dict() for name, one in self.regions.items()}}
