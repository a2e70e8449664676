"""Designer's figures of a judged detector: the contrast it needs, and what clutter costs against white noise.

Choice of the detector of a range: each of a short list is tried on the same frames, and the one with most contrast to spare is taken.
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
from seaglint.detection.isolated import IsolatedDetector
from seaglint.detection.rare_alarms import LOWEST_THRESHOLD, MOST_EVENTS, RareTail
from seaglint.detection.sources import FrameSource
from seaglint.detection.stepped_tails import tail_above
from seaglint.store.detection_results import TriedDetector
from seaglint.studies.detect.performance import DetectionOptions, Performance, detect, detector_for

TAIL_SHARE: Final = 0.02  #: Share of the pixels that a tail holds at most [1].

FEWEST_PIXELS: Final = 200  #: Pixels that it holds at least, as far as that share allows.


@dataclass(frozen=True)
class Design:
    """Request for the contrast that a designer needs."""

    p_d: float = 0.9  #: Share of objects to be found [1].
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


def wanted_rate(found: Performance, wanted: Design) -> float:
    """Rate per pixel that is asked for [1].

    Raises
    ------
    DomainError
        No frame rate.
    """
    if wanted.p_fa is not None:
        return wanted.p_fa
    rate = found.options.frame_rate
    if rate is None:
        raise DomainError("false alarms an hour need the frame rate; give frame_rate, or p_fa")
    index = found.tail.extremal_index
    events = index if index == index and 0.0 < index <= 1.0 else 1.0
    pixels = found.alarms.cells.pixels / found.judged.windows
    return min(wanted.alarms_per_hour / (3600.0 * rate * pixels * events), 0.4)


def rate_threshold(found: Performance, wanted: Design) -> RateThreshold:
    """Threshold of that rate.

    Raises
    ------
    DataError
        A rate that is neither counted nor to be extrapolated.
    """
    return told_threshold(found.alarms, tail_from(found.judged, found.threshold, found.alarms, found.tail), wanted_rate(found, wanted))


def told_threshold(count: FalseAlarmCount, tail: RareTail, p_fa: float) -> RateThreshold:
    """Threshold of a rate; where no tail can be fitted that of the few pixels above it, which is not to be believed.

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
        return RateThreshold(sigma, number / curve.pixels, low, high, "counted", believed=False)


def tail_from(judged: Background, threshold: Threshold, count: FalseAlarmCount, tail: RareTail) -> RareTail:
    """The tail above three standard deviations or, where too little is there, above what leaves enough to fit.

    A field with a horizon or a corridor in it has a broad statistic that never comes far above its mean.
    """
    curve = count.alarms.curve()
    lower = curve.threshold_for(min(TAIL_SHARE, max(MOST_EVENTS / max(curve.pixels, 1), FEWEST_PIXELS / max(curve.pixels, 1))))
    if tail.fit is not None or lower is None or not 0.0 < lower < LOWEST_THRESHOLD:
        return tail
    alarms = FalseAlarms((lower,))
    nothing = np.full(judged.statistic.shape[1:], np.nan, np.float32)
    for k in range(judged.windows):
        if k and judged.place.sequences > 1 and k % judged.place.each == 0:
            alarms.add(nothing)
        alarms.add(judged.z(k, threshold.law))
    return tail_above(judged, threshold.law, alarms.curve(), alarms.events(lower), lowest=lower)


@dataclass(frozen=True)
class DesignFigures:
    """Contrast that a detector needs, and what clutter costs against white noise."""

    #: ``p_d``, ``p_fa``: Share of objects found, and rate of false alarms per pixel [1].
    p_d: float
    p_fa: float
    p_fa_interval: list[float | None]  #: Ends of the rate's 95 % interval [1].
    alarms_per_hour: float | None  #: False alarms asked for [1/h]; None where the rate itself was.
    threshold_sigma: float  #: Threshold of that rate [standard deviations].
    threshold_how: str  #: Way in which the rate is known: counted or extrapolated.
    believed: bool  #: Whether it is to be believed.
    contrast: float | None  #: Contrast needed; None where it cannot be stated in its unit.
    contrast_interval: list[float | None]  #: Ends of its interval.
    #: ``white_contrast``, ``white_sigma``: Contrast needed in white Gaussian noise of the same variance, and its standard deviation.
    white_contrast: float | None = None
    white_sigma: float | None = None
    loss_db: float | None = None  #: Ratio of the two contrasts [dB].
    note: str | None = None  #: Why there is no comparison with white noise.
    #: ``contrast_pixel``, ``white_contrast_pixel``: Both contrasts in the pixel [units of the source], where ``contrast`` is stated in
    #: another unit.
    contrast_pixel: float | None = None
    white_contrast_pixel: float | None = None

    def stated_by(self, inverse: Callable[[float], float]) -> Self:
        """Return the figures with contrasts in the unit to which ``inverse`` takes those in the pixel; None where it has none."""

        def stated(pixel: float | None) -> float | None:
            value = math.nan if pixel is None else inverse(pixel)
            return value if math.isfinite(value) else None

        ends = [None if end is None else inverse(end) for end in self.contrast_interval]
        return replace(
            self,
            contrast=stated(self.contrast),
            white_contrast=stated(self.white_contrast),
            contrast_interval=ends,
            contrast_pixel=self.contrast,
            white_contrast_pixel=self.white_contrast,
        )

    def as_dict(self) -> JsonObject:
        """Return plain numbers and text."""
        return asdict(self)


def design(found: Performance, source: FrameSource, options: DetectionOptions, wanted: Design) -> DesignFigures:
    """Contrast for a P_d at a rate of false alarms, and the loss against white Gaussian noise of the same variance.

    Raises
    ------
    SeaglintError
        A rate or a P_d that is not reached.
    """
    at = rate_threshold(found, wanted)
    objects = replace(options.objects, injections=wanted.injections)
    found.judged.detector = detector_for(source, options)
    try:
        with single_threaded_algebra():
            needed = contrast_for(found.judged, source, objects, as_threshold(at, options.law), wanted.p_d)
    finally:
        _closed(found.judged)
    out = DesignFigures(
        p_d=wanted.p_d,
        p_fa=at.p_fa,
        p_fa_interval=[at.low, at.high],
        alarms_per_hour=None if wanted.p_fa is not None else wanted.alarms_per_hour,
        threshold_sigma=at.sigma,
        threshold_how=at.how,
        believed=at.believed,
        contrast=needed.contrast,
        contrast_interval=[needed.low, needed.high],
    )
    if not wanted.white:
        return out
    try:
        white, sigma = white_contrast(source, options, wanted, at.p_fa)
        return replace(out, white_contrast=white, white_sigma=sigma, loss_db=loss_db(needed.contrast, white))
    except SeaglintError as error:
        return replace(out, note=f"white noise of the same variance: {error}")


def white_contrast(source: FrameSource, options: DetectionOptions, wanted: Design, p_fa: float) -> tuple[float, float]:
    """Contrast that the same detector needs in white Gaussian noise of the source's variance, and its standard deviation [u]."""
    white = WhiteFrames.like(source, options.objects.seed)
    detector = detector_for(white, options)
    with single_threaded_algebra():
        judged = Background(detector, white)
        try:
            if detector.linear:
                at = gaussian_threshold(p_fa)
            else:
                four = judged.threshold(4.0, "sigma")
                count = count_false_alarms(judged, four)
                tail = tail_above(judged, four.law, count.alarms.curve(), count.alarms.events(LOWEST_THRESHOLD))
                at = told_threshold(count, tail_from(judged, four, count, tail), p_fa)
            objects = replace(options.objects, injections=wanted.injections)
            return contrast_for(judged, white, objects, as_threshold(at), wanted.p_d).contrast, white.sigma
        finally:
            _closed(judged)


def _closed(judged: Background) -> None:
    if isinstance(judged.detector, IsolatedDetector):
        judged.detector.close()


INJECTIONS: Final = 120  #: Most objects of each contrast that are tried for a choice; 120 of them know a P_d of 0.9 to 0.03.

LARGEST: Final = 32.0  #: Largest margin that is measured [1]; larger ones count as this.

SMALLEST: Final = 0.125  #: Smallest margin that is measured [1].

_FACTORS: Final = np.geomspace(1.0 / LARGEST, 1.0 / SMALLEST, 17)


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
        Wanted P_d and rate of false alarms.
    range_m : float
        Range at which these are the frames [m].
    """
    out = []
    for name in names:
        try:
            margin = contrast_margin(source, replace(options, detector=name), contrast, design)
            note = None if margin is not None else f"it needs more than {1.0 / SMALLEST:g} times the contrast"
        except SeaglintError as error:
            margin, note = None, str(error)
        out.append(TriedDetector(name, range_m, margin, note))
    return out


def contrast_margin(source: FrameSource, options: DetectionOptions, contrast: float, design: Design) -> float | None:
    """Return a contrast over the one at which the wanted P_d is reached, at most :data:`LARGEST` [1]; None below :data:`SMALLEST`.

    P_d is counted at seventeen contrasts, taken to rise with the contrast, and interpolated in its logarithm.

    Raises
    ------
    SeaglintError
        A detector that cannot judge the frames, or a rate of false alarms that they are too few for.
    """
    contrasts = tuple(float(value) for value in contrast * _FACTORS)
    objects = replace(options.objects, contrasts=contrasts, injections=min(options.objects.injections, INJECTIONS))
    found = detect(source, replace(options, objects=objects), locate=False)
    threshold = rate_threshold(found, design).sigma
    rates = np.maximum.accumulate([by_windows(scores, threshold, options.level).rate for scores in found.trials.scores])
    if rates[-1] < design.p_d:
        return None
    above = int(np.argmax(rates >= design.p_d))
    if above == 0:
        return LARGEST
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
    """Return the margins of one range as text, the largest first.

    Examples
    --------
    >>> choice_line([TriedDetector("a", 5e3, None, "it fails"), TriedDetector("b", 5e3, 1.234)], 0.9)
    'contrast at 5000 m over what is needed for P_d 0.9: b 1.23, a none; b is taken'
    """
    falling = sorted(tried, key=lambda one: -(one.contrast_margin or 0.0))
    margins = ", ".join(f"{one.detector} {'none' if one.contrast_margin is None else f'{one.contrast_margin:.3g}'}" for one in falling)
    return f"contrast at {tried[0].range_m:.0f} m over what is needed for P_d {p_d:g}: {margins}; {best_of(tried).detector} is taken"
