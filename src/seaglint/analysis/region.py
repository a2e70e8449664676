"""Statistics of one region of a recording."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from seaglint.analysis.summary import (
    AlarmSummary,
    CorrelationLengths,
    Ends,
    FitSummary,
    RegionSummary,
    SpectrumSummary,
    StationaritySummary,
    TailSummary,
    number,
)
from seaglint.base import random
from seaglint.base.errors import DataError
from seaglint.base.free_form import JsonObject
from seaglint.clutter.correlation import (
    SpatialCorrelation,
    TemporalCorrelation,
    block_labels,
    effective_count,
    spatial_correlation,
    temporal_correlation,
    trend_surface,
)
from seaglint.clutter.extremes import TailFit, fit_tail
from seaglint.clutter.false_alarms import FalseAlarmRate, FalseAlarms
from seaglint.clutter.fits import FAMILIES, FEWEST_JUDGED, Fit, Goodness, fit, goodness
from seaglint.clutter.moments import Moments
from seaglint.clutter.spectrum import Spectrum, power_spectrum
from seaglint.clutter.stationarity import Stationarity, stationarity

BoolArray = NDArray[np.bool_]
FrameArray = NDArray[np.float32]

#: Number of fitted values: errors of the fit are then those of the independent values in the recording, not of the sample.
SAMPLE: Final = 120_000

BLOCK_LENGTHS: Final = 5.0  #: Sides of the blocks of the fits' intervals, in correlation lengths.

SERIES_VALUES: Final = 4_000_000  #: Number of values of pixels in time that are stored for the correlation time.


@dataclass(frozen=True)
class Region:
    """Results of one region; :meth:`summary` has those that are written."""

    name: str
    mask: BoolArray
    moments: Moments
    fits: dict[str, Fit]
    goodness: dict[str, Goodness]
    sample: NDArray[np.float64]
    spatial: SpatialCorrelation
    temporal: TemporalCorrelation
    stationarity: Stationarity
    spectrum: Spectrum | None
    alarms: dict[str, FalseAlarms] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    offset: float = 0.0
    saturated: float = 0.0
    _tails: dict[str, tuple[TailFit | None, str | None]] = field(default_factory=dict, repr=False, compare=False)

    def tail(self, name: str) -> tuple[TailFit | None, str | None]:
        """Extreme-value tail of a filter or detector from the events of its lowest threshold, or the reason for its absence.

        Fitted once.
        """
        if name not in self._tails:
            alarms = self.alarms[name]
            self._tails[name] = fit_tail(alarms.curve(), alarms.events(alarms.thresholds[0])) if alarms.pixels else (None, "no pixels")
        return self._tails[name]

    def summary(self, frame_rate: float | None) -> RegionSummary:
        """Return plain numbers and text; missing values are None."""
        m = self.moments
        return RegionSummary(
            pixels=int(self.mask.sum()),
            values=m.count,
            mean=number(m.mean + self.offset),
            std=number(m.std),
            skewness=number(m.skewness),
            excess_kurtosis=number(m.excess_kurtosis),
            minimum=number(m.minimum + self.offset),
            maximum=number(m.maximum + self.offset),
            saturated=self.saturated,
            fits={family: self._fit(family) for family in FAMILIES},
            false_alarms=[
                _alarm(name, alarms, rate, *self.tail(name), frame_rate, self.saturated)
                for name, alarms in self.alarms.items()
                for rate in alarms.rates()
            ],
            correlation_length_px=CorrelationLengths(number(self.spatial.length_x), number(self.spatial.length_y)),
            correlation_length_reason=self._no_length(),
            correlation_time_s=number(self.temporal.time) if frame_rate is not None else None,
            correlation_time_frames=number(self.temporal.time * (frame_rate or 1.0)),
            correlation_time_reason=self.temporal.reason or None,
            stationary=self.stationarity.stationary,
            stationarity=StationaritySummary(
                p_mean=number(self.stationarity.p_mean),
                p_variance=number(self.stationarity.p_variance),
                block_px=list(self.stationarity.block),
                reason=self.stationarity.reason or None,
                method=self.stationarity.method,
            ),
            spectrum=self._spectrum(),
            notes=list(self.notes),
        )

    def as_dict(self, frame_rate: float | None) -> JsonObject:
        """Return plain numbers and text; missing values are None."""
        return self.summary(frame_rate).as_dict()

    def _no_length(self) -> str | None:
        """Reason why a correlation length does not exist."""
        if math.isfinite(self.spatial.length_x) and math.isfinite(self.spatial.length_y):
            return None
        if self.moments.is_constant:
            return "all values are equal"
        if not np.isfinite(self.spatial.x).any():
            return "nothing varies besides the smooth background that was removed"
        return "correlation does not fall to 1/e within a third of the picture"

    def _fit(self, family: str) -> FitSummary:
        fitted, good = self.fits.get(family), self.goodness.get(family)
        if fitted is None:
            fitted = fit(np.empty(0), family)  # type: ignore[arg-type]
        return FitSummary(
            shape=fitted.shape,
            scale=fitted.scale,
            loc=fitted.loc,
            shape_interval=_pair(fitted.shape_interval),
            scale_interval=_pair(fitted.scale_interval),
            loc_interval=_pair(fitted.loc_interval),
            log_likelihood_per_value=None if fitted.log_likelihood is None else number(fitted.log_likelihood / max(fitted.count, 1)),
            effective_count=number(fitted.effective_count),
            excluded=fitted.excluded,
            ks=None if good is None else number(good.ks),
            ks_p=None if good is None else number(good.ks_p),
            ad=None if good is None else number(good.ad),
            ad_p=None if good is None else number(good.ad_p),
            reason=fitted.reason or None,
        )

    def _spectrum(self) -> SpectrumSummary | None:
        if self.spectrum is None or self.spectrum.segments == 0:
            return None
        frequency, density = self.spectrum.radial()
        return SpectrumSummary([number(f) for f in frequency], [number(d) for d in density])


def _pair(interval: tuple[float, float] | None) -> Ends | None:
    return None if interval is None else [number(v) for v in interval]


def _alarm(
    name: str,
    alarms: FalseAlarms,
    rate: FalseAlarmRate,
    tail: TailFit | None,
    tail_reason: str | None,
    frame_rate: float | None,
    saturated: float,
) -> AlarmSummary:
    cut = f"{100 * saturated:.3g} % of the values saturated" if saturated > 0.0 else None
    events = alarms.events(rate.threshold_sigma) if alarms.pixels else None
    duration = events.mean_duration if events is not None else None
    seconds = None if frame_rate is None else 1.0 / frame_rate
    return AlarmSummary(
        filter=name,
        threshold_sigma=rate.threshold_sigma,
        rate=number(rate.rate),
        rate_low=rate.rate_low,
        rate_high=rate.rate_high,
        gaussian_rate=rate.gaussian_rate,
        ratio=number(rate.ratio),
        exceedances=rate.exceedances,
        inflation=rate.inflation,
        correlation_time_s=rate.correlation_time * seconds if rate.correlation_time is not None and seconds is not None else None,
        correlation_time_frames=rate.correlation_time,
        correlation_note=rate.correlation_note,
        note="; ".join(text for text in (rate.note, cut) if text) or None,
        events=None if events is None else len(events),
        events_per_frame=None if events is None else number(events.per_frame),
        event_duration_s=duration * seconds if duration is not None and seconds is not None and alarms.frames > 1 else None,
        tail=_tail(tail, tail_reason) if rate.threshold_sigma == alarms.thresholds[0] else None,
    )


def _tail(tail: TailFit | None, reason: str | None) -> TailSummary:
    if tail is None:
        return TailSummary(reason=reason)
    return TailSummary(
        from_sigma=tail.threshold,
        events=tail.events,
        shape=tail.fit.shape,
        shape_interval=_pair(tail.shape_interval),
        scale_sigma=tail.fit.scale,
        goodness_p=number(tail.goodness_p),
        trusted_to_sigma=number(tail.trusted_to_sigma),
        trusted_to_rate=number(tail.trusted_to_rate),
    )


TELLING: Final = 0.05  #: Largest level at which a test of few values still rejects a family.


def _only_telling(tested: Goodness) -> Goodness:
    """Return the meaningful levels: of few independent values, only small ones."""
    if tested.effective_count >= FEWEST_JUDGED:
        return tested
    ks_p, ad_p = (p if p <= TELLING else math.nan for p in (tested.ks_p, tested.ad_p))
    return replace(tested, ks_p=ks_p, ad_p=ad_p)


class Gatherer:
    """Accumulator of a region's raw values in the second pass: a sample, some frames, some pixels in time."""

    def __init__(self, mask: BoolArray, frames: int, kept_frames: NDArray[np.int64], seed: int, offset: float = 0.0) -> None:
        self.mask, self.offset = mask, offset
        inside = np.flatnonzero(mask)
        rng = random.stream(seed, "pixels of a region")
        per_frame = min(max(SAMPLE // max(kept_frames.size, 1), 1), inside.size)
        self._sampled = [np.sort(rng.choice(inside, per_frame, replace=False)) for _ in kept_frames]
        count = min(inside.size, max(SERIES_VALUES // max(frames, 1), 1), 4000)
        self._pixels = np.sort(rng.choice(inside, count, replace=False)) if frames > 1 else np.empty(0, np.int64)
        self._series = np.empty((frames if self._pixels.size else 0, self._pixels.size), np.float32)

    def add(self, block: FrameArray, start: int) -> None:
        """Add the frames from ``start`` on."""
        if self._pixels.size:
            self._series[start : start + block.shape[0]] = block.reshape(block.shape[0], -1)[:, self._pixels]

    def sample(self, stored: FrameArray, sides: tuple[float, float], used: BoolArray) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
        """Values of the used pixels of the stored frames, in the file's numbers, and the block of each."""
        labels = block_labels(self.mask.shape, sides).ravel()
        most = int(labels.max()) + 1
        values = np.concatenate([frame.ravel()[p] for frame, p in zip(stored, self._sampled, strict=True)]).astype(np.float64)
        blocks = np.concatenate([i * most + labels[p] for i, p in enumerate(self._sampled)])
        good = np.isfinite(values) & used.ravel()[np.concatenate(self._sampled)]
        return values[good] + self.offset, blocks[good]

    def temporal(self, frame_rate: float | None, used: BoolArray) -> TemporalCorrelation:
        """Correlation in time of the stored and used pixels."""
        if not self._pixels.size:
            return TemporalCorrelation(np.full(1, np.nan), np.nan, np.nan, "a single frame")
        inside = used.ravel()[self._pixels]
        return temporal_correlation(self._series if inside.all() else self._series[:, inside], frame_rate)


def region(
    name: str,
    gathered: Gatherer,
    moments: Moments,
    image: NDArray[np.float64],
    stored: FrameArray,
    kept_spacing: float,
    frame_rate: float | None,
    seed: int,
    bad: BoolArray | None = None,
) -> Region:
    """Statistics of the values accumulated in the second pass; ``stored`` are frames ``kept_spacing`` frames apart.

    Pixels of ``bad`` lines are in the moments, in nothing else: one line that is not sea would pass for correlation and for a family.
    """
    mask = gathered.mask if bad is None else gathered.mask & ~bad
    notes: list[str] = []
    trend = trend_surface(image, mask)
    spatial = spatial_correlation(stored, mask, mean=trend)
    temporal = gathered.temporal(frame_rate, mask)
    if temporal.reason and gathered._pixels.size:
        notes.append(f"correlation time: {temporal.reason}")
    lengths = [BLOCK_LENGTHS * (length if math.isfinite(length) else 10.0) for length in (spatial.length_y, spatial.length_x)]
    values, blocks = gathered.sample(stored, (lengths[0], lengths[1]), mask)
    in_frames = temporal.scale / kept_spacing if math.isfinite(temporal.scale) else 1.0
    independent = effective_count(float(stored.shape[0] * mask.sum()), spatial.scale_x, spatial.scale_y, max(in_frames, 1.0))
    independent = min(independent, float(values.size))
    enough_blocks = np.unique(blocks).size >= 20 and in_frames <= 1.0
    fits: dict[str, Fit] = {}
    tests: dict[str, Goodness] = {}
    for family in FAMILIES:
        fitted = fit(values, family, effective_count=independent, blocks=blocks if enough_blocks else None)
        fits[family] = fitted
        if fitted.is_valid:
            tests[family] = _only_telling(goodness(values, fitted, effective_count=independent, seed=seed))
    still = stationarity(stored, mask, length_x=spatial.length_x, length_y=spatial.length_y, seed=seed)
    try:
        spectrum = power_spectrum(stored, mask, mean=trend)
    except DataError:
        spectrum = None  # pictures of fewer than 8 pixels a side
    if moments.is_constant:
        notes.append("all values are equal")
    made = Region(name, gathered.mask, moments, fits, tests, values, spatial, temporal, still, spectrum, {}, tuple(notes))
    return replace(made, offset=gathered.offset)
