"""Design of a detector: the contrast for a required P_d at a required P_fa, and the loss of clutter against white noise."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Final

import numpy as np
from numpy.typing import NDArray

from seaglint.base.errors import DataError
from seaglint.base.random import stream
from seaglint.detection.background import Background, FalseAlarmCount, Law, Threshold
from seaglint.detection.interface import Frames
from seaglint.detection.rare_alarms import RareTail
from seaglint.detection.scoring import Interval, Scores, interval_of_sequences
from seaglint.detection.sources import FrameSource, PlainFrames
from seaglint.detection.trials import InjectedObjects, run_trials

COUNTED: Final = 30  #: Least number of false alarms at a threshold whose rate is counted rather than extrapolated.

_STEPS = 5
_ROUNDS = 3
_DECADES = 5


@dataclass(frozen=True)
class RateThreshold:
    """Threshold for a rate of false alarms."""

    sigma: float  #: In standard deviations above the mean [1].
    p_fa: float  #: Rate per pixel [1].
    low: float  #: Lower end of its interval [1].
    high: float  #: Upper end of its interval [1].
    how: str  #: From the pixels above it, from the tail's fit, or by the law of white noise.
    believed: bool  #: Whether the rate is reliable.


def threshold_for(count: FalseAlarmCount, tail: RareTail, p_fa: float) -> RateThreshold:
    """Return the threshold for a rate per pixel: counted with enough false alarms, else from the tail's fit.

    Raises
    ------
    DataError
        Neither is possible.
    """
    curve = count.alarms.curve()
    if p_fa * curve.pixels >= COUNTED:
        counted = curve.threshold_for(p_fa)
        if counted is not None and counted > 0:
            # The threshold is an edge of the curve, up to rounding.
            place = int(np.searchsorted(curve.threshold, counted - 1e-9))
            number = int(curve.exceedances[place])
            half = 2.0 * math.sqrt(max(number, 1) * max(count.per_pixel.inflation if np.isfinite(count.per_pixel.inflation) else 1.0, 1.0))
            rate = number / curve.pixels
            return RateThreshold(counted, rate, max(number - half, 0.0) / curve.pixels, (number + half) / curve.pixels, "counted", True)
    rare = tail.threshold_for(p_fa)
    if rare is None:
        raise DataError(
            f"a rate of {p_fa:.2g} per pixel has no threshold in {curve.pixels} pixels: {tail.note or 'their tail ends before'}; "
            "give more frames or a higher rate"
        )
    return RateThreshold(rare.threshold_sigma, rare.rate, rare.low, rare.high, "extrapolated", rare.believed)


@dataclass(frozen=True)
class NeededContrast:
    """Contrast for a required P_d."""

    contrast: float  #: Signal of an object in the pixel at whose centre it lies [u].
    low: float | None  #: Contrast at which the required P_d is the upper end of its interval [u].
    high: float | None  #: Contrast at which the required P_d is the lower end of its interval [u].
    tried: tuple[tuple[float, float], ...]  #: Contrasts tried and their P_d, rising.


def contrast_for(
    background: Background, source: FrameSource, objects: InjectedObjects, threshold: Threshold, p_d: float = 0.9
) -> NeededContrast:
    """Return the contrast at which a share ``p_d`` of the objects is detected, bracketed in rounds.

    Parameters
    ----------
    background, source, threshold
        Background, source and threshold of the same frames without objects.
    objects : InjectedObjects
        Injected objects; the sign of their first contrast is used.
    p_d : float
        Requested share [1].

    Raises
    ------
    DataError
        No contrast between a hundredth and a million standard deviations of the frames is detected so often.
    """
    sign = math.copysign(1.0, objects.contrasts[0])
    first = source.read(0, 1)
    # A frame without variation is scaled by its largest value.
    scale = float(np.nanstd(first.astype(np.float64))) or float(np.nanmax(np.abs(first))) or 1.0
    # First round in decades of the frames' deviation; each further round between the contrasts that bracket P_d.
    grid: NDArray[np.float64] = np.asarray(scale * 10.0 ** (np.arange(_DECADES + 1) - 2.0), np.float64)
    # P_d at every contrast tried: a later round keeps the results of the earlier ones.
    known: dict[float, Interval] = {}
    low, high = 0.0, math.inf
    for number in range(_ROUNDS + 1):
        for contrast, interval in zip(grid, _rates(background, source, objects, threshold, sign * grid), strict=True):
            known[float(contrast)] = interval
        rising = sorted(known)
        above = [c for c in rising if known[c].rate >= p_d]
        if not above:
            break
        high = above[0]
        below = [c for c in rising if c < high]
        if not below:
            low = 0.0
            break
        low = below[-1]
        if number < _ROUNDS:
            grid = np.asarray(np.geomspace(low, high, _STEPS + 2)[1:-1], np.float64)
    rising = sorted(known)
    tried = tuple((sign * c, known[c].rate) for c in rising)
    if not math.isfinite(high) or low == 0.0:
        raise DataError(
            f"detector {background.detector.name}: P_d = {p_d:g} is reached by no contrast between {rising[0]:.3g} and {rising[-1]:.3g} "
            f"(P_d {known[rising[0]].rate:.3g} and {known[rising[-1]].rate:.3g}); lower the threshold, or choose another detector"
        )
    # Ends of the interval: where the lower, and where the upper end of P_d's own interval crosses the requested share.
    exact = _crossing([(c, known[c].rate) for c in rising], p_d)
    sure, doubtful = ([(c, getattr(known[c], name) or known[c].rate) for c in rising] for name in ("low", "high"))
    least, most = (None if e is None else sign * e for e in (_crossing(doubtful, p_d), _crossing(sure, p_d)))
    return NeededContrast(sign * (exact or high), least, most, tried)


def _rates(
    background: Background, source: FrameSource, objects: InjectedObjects, threshold: Threshold, contrasts: NDArray[np.float64]
) -> list[Interval]:
    trials = run_trials(background, source, replace(objects, contrasts=tuple(float(c) for c in contrasts)), threshold, locate=False)
    return [by_windows(scores, threshold.sigma, 0.95) for scores in trials.scores]


def by_windows(scores: Scores, threshold_sigma: float, level: float) -> Interval:
    """Return the share of objects above a threshold, with its interval from the scatter between windows."""
    windows, which = np.unique(scores.window, return_inverse=True)
    hits = np.bincount(which, scores.detected(threshold_sigma), windows.size).astype(np.float64)
    return interval_of_sequences(hits, np.bincount(which, minlength=windows.size).astype(np.float64), None, level)


def _crossing(points: list[tuple[float, float]], rate: float) -> float | None:
    """Return the first contrast at which a curve reaches a rate, linear in the contrast's logarithm; None where it does not."""
    for (c0, p0), (c1, p1) in pairwise(points):
        if p0 < rate <= p1:
            return float(c0 * (c1 / c0) ** ((rate - p0) / (p1 - p0)))
    return None


def loss_db(contrast: float, white: float) -> float:
    """Return the loss by clutter against white noise, 20 log10 of the ratio of contrasts [dB].

    Examples
    --------
    >>> round(loss_db(2.0, 1.0), 2)
    6.02
    """
    return 20.0 * math.log10(abs(contrast) / abs(white))


@dataclass(frozen=True)
class WhiteFrames(PlainFrames):
    """White Gaussian noise in place of a source, with the same number of frames, mean and variance.

    Parameters
    ----------
    frames, rows, columns : int
        Size.
    mean, sigma : float
        Mean and standard deviation of every pixel [u].
    seed : int
        Seed of the noise; a frame is a function of it and of its number.
    sequence_length : int
        Frames of a sequence; 0 where all are one.
    saturation : float, optional
        Value from which on a pixel is saturated [u].
    """

    frames: int
    rows: int
    columns: int
    mean: float
    sigma: float
    seed: int = 0
    sequence_length: int = 0
    saturation: float | None = None

    @classmethod
    def like(cls, source: FrameSource, seed: int) -> WhiteFrames:
        """White noise with a source's size, mean and variance, over all its pixels and frames."""
        # Sums about the level of the first frame, for their precision.
        number, total, squares = 0, 0.0, 0.0
        shift: float | None = None
        for k in range(source.frames):
            values = source.read(k, k + 1).astype(np.float64)
            values = values[np.isfinite(values)]
            shift = float(values.mean()) if shift is None and values.size else shift
            values -= shift or 0.0
            number, total, squares = number + values.size, total + float(values.sum()), squares + float((values**2).sum())
        mean = total / max(number, 1)
        sigma = math.sqrt(max(squares / max(number, 1) - mean**2, 0.0))
        return cls(
            frames=source.frames,
            rows=source.rows,
            columns=source.columns,
            mean=mean + (shift or 0.0),
            sigma=sigma,
            seed=seed,
            sequence_length=source.sequence_length,
        )

    def read(self, start: int, stop: int) -> Frames:
        """Frames ``start`` to ``stop`` (not included)."""
        shape = (self.rows, self.columns)
        frames = [stream(self.seed, "white frames", k).standard_normal(shape) for k in range(start, stop)]
        return np.asarray(self.mean + self.sigma * np.stack(frames), np.float32)


def gaussian_threshold(p_fa: float) -> RateThreshold:
    """Return the threshold of a linear or calibrated statistic on white Gaussian noise."""
    from scipy.special import ndtri

    return RateThreshold(-float(ndtri(p_fa)), p_fa, p_fa, p_fa, "gaussian", True)


def as_threshold(threshold: RateThreshold, law: Law = "sigma") -> Threshold:
    """Convert a threshold of a rate to a threshold of trials."""
    return Threshold(law, threshold.sigma, threshold.sigma, False)
