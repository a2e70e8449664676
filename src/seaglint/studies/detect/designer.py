"""Figures for a designer: the contrast that a detector needs, its loss by clutter against white noise, and the choice of a detector.

For a range each of a short list of detectors is tried on the same frames, and the one with the largest margin of contrast is taken.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Final, Self

import numpy as np

from seaglint.base.errors import DataError, DomainError, SeaglintError
from seaglint.base.free_form import JsonObject
from seaglint.base.threads import single_threaded_algebra
from seaglint.clutter.cluster_variance import score_interval
from seaglint.clutter.false_alarms import FalseAlarms
from seaglint.detection.background import Background, FalseAlarmCount, Threshold, count_false_alarms
from seaglint.detection.design import (
    RateThreshold,
    WhiteFrames,
    as_threshold,
    by_windows,
    contrast_for,
    gaussian_threshold,
    loss_db,
    threshold_for,
)
from seaglint.detection.isolated import ended
from seaglint.detection.rare_alarms import LOWEST_THRESHOLD, MOST_EVENTS, RareTail
from seaglint.detection.sources import FrameSource
from seaglint.detection.stepped_tails import tail_above
from seaglint.store.detection_results import TriedDetector
from seaglint.studies.detect.performance import DetectionOptions, Performance, detect, detector_for

TAIL_SHARE: Final = 0.02  #: Share of the pixels that a tail holds at most [1].

FEWEST_PIXELS: Final = 200  #: Pixels that it holds at least, as far as that share allows.

INJECTIONS: Final = 120  #: Most objects of each contrast that are tried for a choice; 120 of them know a P_d of 0.9 to 0.03.

LARGEST: Final = 32.0  #: Largest margin that is measured [1]; larger ones count as this.

SMALLEST: Final = 0.125  #: Smallest margin that is measured [1].

_FACTORS: Final = np.geomspace(1.0 / LARGEST, 1.0 / SMALLEST, 17)


@dataclass(frozen=True)
class Design:
    """Request for the contrast that a designer needs."""

    p_d: float = 0.9  #: Share of objects to be detected [1].
    p_fa: float | None = None  #: Rate of false alarms per pixel [1]; without it ``alarms_per_hour`` counts.
    alarms_per_hour: float = 1.0  #: False alarms an hour in the whole field: events, of which each frame is an independent look [1/h].
    injections: int = 400  #: Objects of each contrast tried.
    white: bool = True  #: Whether white noise is judged as well.

    def __post_init__(self) -> None:
        if not 0.0 < self.p_d < 1.0:
            raise DomainError(f"P_d = {self.p_d:g} is not between 0 and 1; give e.g. 0.9")
        if self.p_fa is not None and not 0.0 < self.p_fa < 0.5:
            raise DomainError(f"P_fa = {self.p_fa:g} is not between 0 and 0.5; give e.g. 1e-6")
        if not self.alarms_per_hour > 0.0:
            raise DomainError(f"{self.alarms_per_hour:g} false alarms an hour; give a number above 0")


def requested_rate(performance: Performance, request: Design) -> float:
    """Return the requested rate of false alarms per pixel [1].

    Raises
    ------
    DomainError
        No frame rate.
    """
    if request.p_fa is not None:
        return request.p_fa
    rate = performance.options.frame_rate
    if rate is None:
        raise DomainError("false alarms an hour need the frame rate; give frame_rate, or p_fa")
    # Alarms are events of several pixels: the extremal index is events over pixels above the threshold.
    index = performance.tail.extremal_index
    events = index if index == index and 0.0 < index <= 1.0 else 1.0
    pixels = performance.alarms.cells.pixels / performance.judged.windows
    return min(request.alarms_per_hour / (3600.0 * rate * pixels * events), 0.4)


def rate_threshold(performance: Performance, request: Design) -> RateThreshold:
    """Return the threshold of the requested rate.

    Raises
    ------
    DataError
        A rate that can be neither counted nor extrapolated.
    """
    tail = tail_from(performance.judged, performance.threshold, performance.alarms, performance.tail)
    return threshold_or_count(performance.alarms, tail, requested_rate(performance, request))


def threshold_or_count(count: FalseAlarmCount, tail: RareTail, p_fa: float) -> RateThreshold:
    """Return the threshold of a rate; where no tail can be fitted, an unreliable one from the few pixels above it.

    Raises
    ------
    DataError
        Less than one pixel above it is expected as well.
    """
    try:
        return threshold_for(count, tail, p_fa)
    except DataError:
        curve = count.alarms.curve()
        sigma = curve.threshold_for(p_fa)
        if sigma is None or not sigma > 0.0:
            raise
        number = int(curve.exceedances[int(np.searchsorted(curve.threshold, sigma - 1e-9))])
        low, high = score_interval(number, curve.pixels, max(float(np.nan_to_num(count.per_pixel.inflation)), 1.0), math.inf, 0.95)
        return RateThreshold(sigma=sigma, p_fa=number / curve.pixels, low=low, high=high, how="counted", believed=False)


def tail_from(judged: Background, threshold: Threshold, count: FalseAlarmCount, tail: RareTail) -> RareTail:
    """Return the tail above three standard deviations or, where too few pixels are there, above a threshold that leaves enough to fit.

    A field with a horizon or a corridor in it has a broad statistic that never comes far above its mean.
    """
    curve = count.alarms.curve()
    # Enough pixels for a fit, but no more than a small share of all.
    lower = curve.threshold_for(min(TAIL_SHARE, max(MOST_EVENTS / max(curve.pixels, 1), FEWEST_PIXELS / max(curve.pixels, 1))))
    if tail.fit is not None or lower is None or not 0.0 < lower < LOWEST_THRESHOLD:
        return tail
    alarms = FalseAlarms((lower,))
    for _ in judged.add_to(alarms, threshold.law):
        pass
    return tail_above(judged, threshold.law, alarms.curve(), alarms.events(lower), lowest=lower)


@dataclass(frozen=True)
class DesignFigures:
    """Contrast that a detector needs, and what clutter costs against white noise."""

    p_d: float  #: Share of detected objects [1].
    p_fa: float  #: Rate of false alarms per pixel [1].
    p_fa_interval: list[float | None]  #: Ends of the rate's 95 % interval [1].
    alarms_per_hour: float | None  #: Requested false alarms [1/h]; None where the rate per pixel was requested.
    threshold_sigma: float  #: Threshold of that rate [standard deviations].
    threshold_how: str  #: Source of the rate: counted or extrapolated.
    believed: bool  #: Whether the rate is reliable.
    contrast: float | None  #: Contrast needed; None where it cannot be stated in its unit.
    contrast_interval: list[float | None]  #: Ends of its interval.
    white_contrast: float | None = None  #: Contrast needed in white Gaussian noise of the same variance.
    white_sigma: float | None = None  #: Standard deviation of that noise.
    loss_db: float | None = None  #: Ratio of the two contrasts [dB].
    note: str | None = None  #: Reason why no comparison with white noise is given.
    contrast_pixel: float | None = None  #: ``contrast`` in the pixel [units of the source], where it is stated in another unit.
    white_contrast_pixel: float | None = None  #: ``white_contrast`` in the pixel [units of the source], likewise.

    def stated_by(self, inverse: Callable[[float], float]) -> Self:
        """Return the figures with contrasts in the unit to which ``inverse`` takes those in the pixel; None where it has none."""

        def stated(pixel: float | None) -> float | None:
            value = math.nan if pixel is None else inverse(pixel)
            return value if math.isfinite(value) else None

        return replace(
            self,
            contrast=stated(self.contrast),
            white_contrast=stated(self.white_contrast),
            contrast_interval=[None if end is None else inverse(end) for end in self.contrast_interval],
            contrast_pixel=self.contrast,
            white_contrast_pixel=self.white_contrast,
        )

    def as_dict(self) -> JsonObject:
        """Return plain numbers and text."""
        return asdict(self)


def design(performance: Performance, source: FrameSource, options: DetectionOptions, request: Design) -> DesignFigures:
    """Return the contrast for a P_d at a rate of false alarms, and the loss against white Gaussian noise of the same variance.

    Raises
    ------
    SeaglintError
        A rate or a P_d that is not reached.
    """
    at = rate_threshold(performance, request)
    objects = replace(options.objects, injections=request.injections)
    # The detector's process ended with the first evaluation: a new one for further objects.
    performance.judged.detector = detector_for(source, options)
    try:
        with single_threaded_algebra():
            needed = contrast_for(performance.judged, source, objects, as_threshold(at, options.law), request.p_d)
    finally:
        ended(performance.judged.detector)
    out = DesignFigures(
        p_d=request.p_d,
        p_fa=at.p_fa,
        p_fa_interval=[at.low, at.high],
        alarms_per_hour=None if request.p_fa is not None else request.alarms_per_hour,
        threshold_sigma=at.sigma,
        threshold_how=at.how,
        believed=at.believed,
        contrast=needed.contrast,
        contrast_interval=[needed.low, needed.high],
    )
    if not request.white:
        return out
    try:
        white, sigma = white_contrast(source, options, request, at.p_fa)
        return replace(out, white_contrast=white, white_sigma=sigma, loss_db=loss_db(needed.contrast, white))
    except SeaglintError as error:
        return replace(out, note=f"white noise of the same variance: {error}")


def white_contrast(source: FrameSource, options: DetectionOptions, request: Design, p_fa: float) -> tuple[float, float]:
    """Return the contrast that the same detector needs in white Gaussian noise of the source's variance, and its standard deviation [u]."""
    white = WhiteFrames.like(source, options.objects.seed)
    detector = detector_for(white, options)
    with single_threaded_algebra():
        background = Background(detector, white)
        try:
            if detector.linear:
                at = gaussian_threshold(p_fa)
            else:
                four = background.threshold(4.0, "sigma")
                count = count_false_alarms(background, four)
                tail = tail_above(background, four.law, count.alarms.curve(), count.alarms.events(LOWEST_THRESHOLD))
                at = threshold_or_count(count, tail_from(background, four, count, tail), p_fa)
            objects = replace(options.objects, injections=request.injections)
            return contrast_for(background, white, objects, as_threshold(at), request.p_d).contrast, white.sigma
        finally:
            ended(detector)


def tried_detectors(
    names: Sequence[str], source: FrameSource, options: DetectionOptions, contrast: float, design: Design, range_m: float
) -> list[TriedDetector]:
    """Return the margin of each detector on some frames.

    Parameters
    ----------
    names : sequence of str
        Detectors.
    source : FrameSource
        Frames without objects.
    options : DetectionOptions
        Objects, threshold and filter; the detector is each of ``names``.
    contrast : float
        Contrast of the object in its pixel, above 0 [units of the source].
    design : Design
        Requested P_d and rate of false alarms.
    range_m : float
        Range at which these are the frames [m].
    """
    out = []
    for name in names:
        try:
            margin = contrast_margin(source, replace(options, detector=name), contrast, design)
            note = None if margin is not None else f"it needs more than {1.0 / SMALLEST:g} times the contrast"
        except SeaglintError as error:
            # A detector that fails is not chosen, and the others are tried.
            margin, note = None, str(error)
        out.append(TriedDetector(name, range_m, margin, note))
    return out


def contrast_margin(source: FrameSource, options: DetectionOptions, contrast: float, design: Design) -> float | None:
    """Return a contrast over the contrast at which the requested P_d is reached, at most ``LARGEST`` [1]; None below ``SMALLEST``.

    P_d is counted at seventeen contrasts, taken to rise with the contrast, and interpolated in its logarithm.

    Raises
    ------
    SeaglintError
        A detector that cannot evaluate the frames, or a rate of false alarms for which they are too few.
    """
    contrasts = tuple(float(value) for value in contrast * _FACTORS)
    objects = replace(options.objects, contrasts=contrasts, injections=min(options.objects.injections, INJECTIONS))
    performance = detect(source, replace(options, objects=objects), locate=False)
    threshold = rate_threshold(performance, design).sigma
    # Chance may give a lower P_d at a larger contrast: the largest so far is taken.
    rates = np.maximum.accumulate([by_windows(scores, threshold, options.level).rate for scores in performance.trials.scores])
    if rates[-1] < design.p_d:
        return None
    above = int(np.argmax(rates >= design.p_d))
    if above == 0:
        return LARGEST
    # Linear in P_d between the two contrasts, in the logarithm of the contrast.
    between = float(np.interp(design.p_d, rates[above - 1 : above + 1], np.log(_FACTORS[above - 1 : above + 1])))
    return float(np.exp(-between))


def best_of(tried: Sequence[TriedDetector]) -> TriedDetector:
    """Return the detector with the largest margin, of equal ones the first.

    Examples
    --------
    >>> best_of([TriedDetector("a", 1e3, None, "it fails"), TriedDetector("b", 1e3, 1.2), TriedDetector("c", 1e3, 0.8)]).detector
    'b'
    """
    return max(tried, key=lambda one: 0.0 if one.contrast_margin is None else one.contrast_margin)


def choice_line(tried: Sequence[TriedDetector], p_d: float) -> str:
    """Return the margins at one range as text, the largest first.

    Examples
    --------
    >>> choice_line([TriedDetector("a", 5e3, None, "it fails"), TriedDetector("b", 5e3, 1.234)], 0.9)
    'contrast at 5000 m over what is needed for P_d 0.9: b 1.23, a none; b is taken'
    """
    falling = sorted(tried, key=lambda one: -(one.contrast_margin or 0.0))
    margins = ", ".join(f"{one.detector} {'none' if one.contrast_margin is None else f'{one.contrast_margin:.3g}'}" for one in falling)
    return f"contrast at {tried[0].range_m:.0f} m over what is needed for P_d {p_d:g}: {margins}; {best_of(tried).detector} is taken"
