"""Statistics of one region of a recording: moments, fits, correlation, stationarity, spectrum and false alarms.

``Gatherer`` accumulates the values that are needed during the second pass, ``region`` computes the statistics from them, and
``Region`` holds the results. Numbers that do not exist are None in the plain form, with the reason in a neighbouring entry. Units are
in the names of the entries; brightness is in the recording's units.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray

from seaglint.base import random
from seaglint.base.errors import DataError
from seaglint.base.free_form import JsonObject, number, plain
from seaglint.clutter.correlation import (
    BoolArray,
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

FrameArray = NDArray[np.float32]

#: Number of fitted values: errors of the fit are then those of the independent values in the recording, not of the sample.
SAMPLE: Final = 120_000

BLOCK_LENGTHS: Final = 5.0  #: Sides of the blocks of the fits' intervals, in correlation lengths.

SERIES_VALUES: Final = 4_000_000  #: Number of values of pixels in time that are stored for the correlation time.

DECISIVE: Final = 0.05  #: Largest level at which a test of few values still rejects a family.


@dataclass(frozen=True, kw_only=True)
class AlarmSummary(FalseAlarmRate):
    """False alarms of a filter or detector at one threshold in a region, with their events and times."""

    filter: str  #: Name of the filter or detector.
    correlation_time_s: float | None  #: 1/e time of the exceedances [s].
    events: int | None  #: Number of connected sets of exceedances.
    events_per_frame: float | None  #: Events in a frame [1].
    event_duration_s: float | None  #: Mean duration of events [s].
    #: Extreme-value tail (``seaglint.clutter.extremes.TailFit.as_dict``) or the reason for its absence, at the lowest threshold.
    tail: JsonObject | None

    def as_dict(self) -> JsonObject:
        """Return plain numbers and text."""
        names = ["filter", "threshold_sigma", "rate", "rate_low", "rate_high", "gaussian_rate", "ratio", "exceedances", "inflation"]
        out = {name: getattr(self, name) for name in [*names, "correlation_time_s"]}
        out["correlation_time_frames"] = self.correlation_time
        names = ["correlation_note", "note", "events", "events_per_frame", "event_duration_s", "tail"]
        return plain(out | {name: getattr(self, name) for name in names})


@dataclass(frozen=True)
class Region:
    """Results of one region."""

    name: str
    mask: BoolArray
    moments: Moments  #: Of the recording's values less ``offset``.
    fits: dict[str, Fit]  #: Fits by family of distributions.
    sample: NDArray[np.float64]  #: Fitted values.
    spatial: SpatialCorrelation
    temporal: TemporalCorrelation
    stationarity: Stationarity
    spectrum: Spectrum | None  #: None for pictures of fewer than 8 pixels a side.
    frame_rate: float | None  #: Frames per second of the recording [Hz].
    alarms: dict[str, FalseAlarms] = field(default_factory=dict)  #: Exceedances by filter or detector.
    notes: tuple[str, ...] = ()  #: Remarks.
    offset: float = 0.0  #: Level that was subtracted when the recording was read.
    saturated: float = 0.0  #: Share of saturated values [1].
    _tails: dict[str, tuple[TailFit | None, str | None]] = field(default_factory=dict, repr=False, compare=False)

    @property
    def pixels(self) -> int:
        """Number of pixels."""
        return int(self.mask.sum())

    @property
    def mean(self) -> float:
        """Mean brightness, in the recording's numbers."""
        return self.moments.mean + self.offset

    @property
    def correlation_time_s(self) -> float | None:
        """1/e time of the brightness [s]; None where it or the frame rate is not known."""
        return None if self.frame_rate is None else number(self.temporal.time)

    @property
    def length_reason(self) -> str | None:
        """Reason why a correlation length does not exist; None if both do."""
        if math.isfinite(self.spatial.length_x) and math.isfinite(self.spatial.length_y):
            return None
        if self.moments.is_constant:
            return "all values are equal"
        if not np.isfinite(self.spatial.x).any():
            return "nothing varies besides the smooth background that was removed"
        return "correlation does not fall to 1/e within a third of the picture"

    def tail(self, name: str) -> tuple[TailFit | None, str | None]:
        """Return the extreme-value tail of a filter or detector, or the reason for its absence.

        It is fitted once, to the events of the lowest threshold.
        """
        if name not in self._tails:
            alarms = self.alarms[name]
            self._tails[name] = fit_tail(alarms.curve(), alarms.events(alarms.thresholds[0])) if alarms.pixels else (None, "no pixels")
        return self._tails[name]

    @cached_property
    def false_alarms(self) -> list[AlarmSummary]:
        """False alarms by filter or detector and threshold."""
        return [self._alarm(name, rate) for name, alarms in self.alarms.items() for rate in alarms.rates()]

    def _alarm(self, name: str, rate: FalseAlarmRate) -> AlarmSummary:
        alarms, seconds = self.alarms[name], None if self.frame_rate is None else 1.0 / self.frame_rate
        events = alarms.events(rate.threshold_sigma) if alarms.pixels else None
        duration = None if events is None or alarms.frames == 1 else events.mean_duration
        cut = f"{100 * self.saturated:.3g} % of the values saturated" if self.saturated > 0.0 else None
        tail = None
        # The tail describes all higher thresholds too, and is reported once.
        if rate.threshold_sigma == alarms.thresholds[0]:
            fitted, reason = self.tail(name)
            tail = {"reason": reason} if fitted is None else fitted.as_dict()
        known = vars(rate) | {"note": "; ".join(text for text in (rate.note, cut) if text) or None}
        return AlarmSummary(
            **known,
            filter=name,
            correlation_time_s=None if rate.correlation_time is None or seconds is None else rate.correlation_time * seconds,
            events=None if events is None else len(events),
            events_per_frame=None if events is None else number(events.per_frame),
            event_duration_s=None if duration is None or seconds is None else duration * seconds,
            tail=tail,
        )

    def as_dict(self) -> JsonObject:
        """Return plain numbers and text; missing values are None."""
        m = self.moments
        results = {
            "pixels": self.pixels,
            "values": m.count,
            "mean": self.mean,
            "std": m.std,
            "skewness": m.skewness,
            "excess_kurtosis": m.excess_kurtosis,
            "minimum": m.minimum + self.offset,
            "maximum": m.maximum + self.offset,
            "saturated": self.saturated,
            "fits": {family: fitted.as_dict() for family, fitted in self.fits.items()},
            "false_alarms": [alarm.as_dict() for alarm in self.false_alarms],
            "correlation_length_px": {"x": self.spatial.length_x, "y": self.spatial.length_y},
            "correlation_length_reason": self.length_reason,
            "correlation_time_s": self.correlation_time_s,
            "correlation_time_frames": self.temporal.time * (self.frame_rate or 1.0),
            "correlation_time_reason": self.temporal.reason or None,
            "stationary": self.stationarity.stationary,
            "stationarity": self.stationarity.as_dict(),
            "spectrum": None if self.spectrum is None or self.spectrum.segments == 0 else self.spectrum.as_dict(),
            "notes": self.notes,
        }
        return plain(results)


class Gatherer:
    """Accumulator of a region's raw values in the second pass: a sample, some frames, some pixels in time."""

    def __init__(self, mask: BoolArray, frames: int, stored_frames: NDArray[np.int64], seed: int, offset: float = 0.0) -> None:
        self.mask, self.offset = mask, offset
        inside = np.flatnonzero(mask)
        rng = random.stream(seed, "pixels of a region")
        per_frame = min(max(SAMPLE // max(stored_frames.size, 1), 1), inside.size)
        self._sampled = [np.sort(rng.choice(inside, per_frame, replace=False)) for _ in stored_frames]
        count = min(inside.size, max(SERIES_VALUES // max(frames, 1), 1), 4000)
        self._pixels = np.sort(rng.choice(inside, count, replace=False)) if frames > 1 else np.empty(0, np.int64)
        self._series = np.empty((frames if self._pixels.size else 0, self._pixels.size), np.float32)

    @property
    def has_series(self) -> bool:
        """True if pixels are stored in time."""
        return bool(self._pixels.size)

    def add(self, block: FrameArray, start: int) -> None:
        """Add the frames from ``start`` on."""
        if self.has_series:
            self._series[start : start + block.shape[0]] = block.reshape(block.shape[0], -1)[:, self._pixels]

    def sample(self, stored: FrameArray, sides: tuple[float, float], used: BoolArray) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
        """Return values of the used pixels of the stored frames, in the file's numbers, and the label of the block of each."""
        labels = block_labels(self.mask.shape, sides).ravel()
        # Stored frames are independent of each other: each has its own blocks.
        blocks_in_frame = int(labels.max()) + 1
        values = np.concatenate([frame.ravel()[p] for frame, p in zip(stored, self._sampled, strict=True)]).astype(np.float64)
        blocks = np.concatenate([i * blocks_in_frame + labels[p] for i, p in enumerate(self._sampled)])
        good = np.isfinite(values) & used.ravel()[np.concatenate(self._sampled)]
        return values[good] + self.offset, blocks[good]

    def temporal(self, frame_rate: float | None, used: BoolArray) -> TemporalCorrelation:
        """Return the correlation in time of the stored and used pixels."""
        if not self.has_series:
            return TemporalCorrelation(np.full(1, np.nan), np.nan, np.nan, "a single frame")
        inside = used.ravel()[self._pixels]
        return temporal_correlation(self._series if inside.all() else self._series[:, inside], frame_rate)


def region(
    name: str,
    gathered: Gatherer,
    moments: Moments,
    image: NDArray[np.float64],
    stored: FrameArray,
    spacing: float,
    frame_rate: float | None,
    seed: int,
    bad: BoolArray | None = None,
) -> Region:
    """Compute statistics of the values accumulated in the second pass; ``stored`` are frames ``spacing`` frames apart.

    Pixels of ``bad`` lines are in the moments and in no other statistic: one line that is not sea would pass for correlation and for a
    family of distributions.
    """
    mask = gathered.mask if bad is None else gathered.mask & ~bad
    notes: list[str] = []
    trend = trend_surface(image, mask)
    spatial = spatial_correlation(stored, mask, mean=trend)
    temporal = gathered.temporal(frame_rate, mask)
    if temporal.reason and gathered.has_series:
        notes.append(f"correlation time: {temporal.reason}")
    # Without a known length blocks are 50 px wide, as for a length of 10 px.
    lengths = [BLOCK_LENGTHS * (length if math.isfinite(length) else 10.0) for length in (spatial.length_y, spatial.length_x)]
    values, blocks = gathered.sample(stored, (lengths[0], lengths[1]), mask)
    in_frames = temporal.scale / spacing if math.isfinite(temporal.scale) else 1.0
    independent = effective_count(float(stored.shape[0] * mask.sum()), spatial.scale_x, spatial.scale_y, max(in_frames, 1.0))
    independent = min(independent, float(values.size))
    # Blocks of different frames are independent only where the stored frames are further apart than the integral scale.
    enough_blocks = np.unique(blocks).size >= 20 and in_frames <= 1.0
    fits: dict[str, Fit] = {}
    for family in FAMILIES:
        fitted = fit(values, family, effective_count=independent, blocks=blocks if enough_blocks else None)
        if fitted.is_valid:
            fitted = replace(fitted, goodness=_decisive(goodness(values, fitted, effective_count=independent, seed=seed)))
        fits[family] = fitted
    tested = stationarity(stored, mask, length_x=spatial.length_x, length_y=spatial.length_y, seed=seed)
    try:
        spectrum = power_spectrum(stored, mask, mean=trend)
    except DataError:
        spectrum = None  # pictures of fewer than 8 pixels a side
    if moments.is_constant:
        notes.append("all values are equal")
    return Region(
        name=name,
        mask=gathered.mask,
        moments=moments,
        fits=fits,
        sample=values,
        spatial=spatial,
        temporal=temporal,
        stationarity=tested,
        spectrum=spectrum,
        frame_rate=frame_rate,
        notes=tuple(notes),
        offset=gathered.offset,
    )


def _decisive(tested: Goodness) -> Goodness:
    """Return a test with its meaningful levels: of few independent values, only small ones."""
    if tested.effective_count >= FEWEST_JUDGED:
        return tested
    ks_p, ad_p = (p if p <= DECISIVE else math.nan for p in (tested.ks_p, tested.ad_p))
    return replace(tested, ks_p=ks_p, ad_p=ad_p)
