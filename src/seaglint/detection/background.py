"""Statistic of a detector on frames without objects: mean and standard deviation, thresholds, and false alarms."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Final, Literal

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import Progress
from seaglint.base.errors import DataError, DomainError
from seaglint.clutter.cluster_variance import LOWER
from seaglint.clutter.false_alarms import HIGHEST, FalseAlarms
from seaglint.clutter.thresholds import frame_scale
from seaglint.detection.interface import Detector, Frames, statistics
from seaglint.detection.rare_alarms import LOWEST_THRESHOLD
from seaglint.detection.scoring import Interval, SegmentSums, interval
from seaglint.detection.sources import FrameSource

Law = Literal["sigma", "frame", "fixed", "design"]

KEPT_BYTES: Final = 512e6  #: Size of the statistic up to which it is held in memory; a larger one is written to a temporary file [B].

_BLOCK_BYTES = 8e6


def blocks_of(source: FrameSource, first: int = 0, end: int | None = None) -> Iterator[Frames]:
    """Iterate over frames ``first`` to ``end`` (not included; by default all), in order, in blocks of some megabytes."""
    # 4 bytes a value: frames are single precision.
    step = max(int(_BLOCK_BYTES / (4.0 * source.rows * source.columns)), 1)
    last = source.frames if end is None else end
    for start in range(first, last, step):
        yield source.read(start, min(start + step, last))


@dataclass(frozen=True)
class Windows:
    """Windows of frames that a detector uses: none spans two sequences."""

    frames: int  #: Frames of the source.
    length: int  #: Frames of each of its sequences; all of them where it is one.
    lead: int  #: Earlier frames that the detector needs.

    @classmethod
    def of(cls, source: FrameSource, lead: int) -> Windows:
        """Return the windows of a source."""
        return cls(source.frames, max(source.sequence_length or source.frames, 1), lead)

    @property
    def each(self) -> int:
        """Number of windows of one sequence."""
        return max(self.length - self.lead, 0)

    @property
    def sequences(self) -> int:
        """Number of whole sequences."""
        return self.frames // self.length

    @property
    def count(self) -> int:
        """Number of all windows."""
        return self.sequences * self.each

    def start(self, window: int) -> int:
        """Return the first frame of a window."""
        return window // self.each * self.length + window % self.each

    def of_event(self, number: int) -> int:
        """Return the window of a frame of :class:`seaglint.clutter.false_alarms.FalseAlarms`, which has an empty one between sequences."""
        return number // (self.each + 1) * self.each + number % (self.each + 1) if self.sequences > 1 else number


@dataclass(frozen=True)
class Threshold:
    """Threshold and the way it was specified."""

    #: Standard deviations above the mean, of all frames or of each; the statistic's own units; or a designed rate of false alarms.
    law: Law
    given: float  #: The number, in the law's unit.
    sigma: float  #: Threshold in standard deviations above the mean [1].
    estimated: bool  #: Whether it depends on the measured mean and standard deviation.


class Background:
    """Statistic of all windows of a source, stored for the injection of objects.

    Parameters
    ----------
    detector : Detector
        Detector to evaluate.
    source : FrameSource
        Frames without objects.
    report : callable, optional
        Called with (windows done, windows in all).

    Raises
    ------
    DataError
        Fewer frames than the detector needs, a detector that fails, or a statistic that does not vary.
    """

    def __init__(self, detector: Detector, source: FrameSource, report: Progress | None = None) -> None:
        self.detector, self.lead = detector, detector.lead
        self.place = Windows.of(source, self.lead)
        self.windows = self.place.count
        if self.windows < 1:
            available = min(self.place.length, source.frames)
            raise DataError(f"detector {detector.name} needs {self.lead + 1} frames; the sequence has {available}")
        shape = (self.windows, source.rows, source.columns)
        self.statistic: NDArray[np.float32] = _room(shape)
        done = 0
        for blocks in self._sequences(source):
            for part in statistics(detector, blocks):
                self.statistic[done : done + part.shape[0]] = part
                done += part.shape[0]
                if report is not None:
                    report(done, self.windows)
        self.border = self._blank_border()
        scales = [frame_scale(frame) for frame in self.statistic]
        self.frame_mean, self.frame_sigma = (np.array([s[k][0] for s in scales]) for k in (0, 1))
        number = np.array([np.isfinite(frame).sum() for frame in self.statistic], np.float64)
        self.pixels = int(number.sum())
        if self.pixels == 0:
            raise DataError(
                f"detector {detector.name} gives no statistic in any pixel of {self.windows} windows (all NaN); "
                "frames are smaller than its border, all missing, or the detector is at fault"
            )
        # Moments over all pixels from those of the frames: variance within the frames, and variance of their means.
        weight = number / number.sum()
        mean, deviation = (np.where(number > 0, v, 0.0) for v in (self.frame_mean, self.frame_sigma))
        self.mean = float(weight @ mean)
        self.sigma = float(np.sqrt(weight @ (deviation**2 + (mean - self.mean) ** 2)))
        # Rounding alone leaves a deviation of some 1e-16 of the mean.
        if not self.sigma > 1e-12 * abs(self.mean):
            raise DataError(
                f"detector {detector.name}: the statistic is {self.mean:g} in every pixel; clutter without variation is not judged"
            )

    def _sequences(self, source: FrameSource) -> Iterator[Iterator[Frames]]:
        """Blocks of each sequence; single frames, which need none before them, form one."""
        # Without a lead no block needs frames before it, so that the sequences need not be separated.
        if self.lead == 0:
            yield blocks_of(source, 0, self.windows)
            return
        for begin in range(0, self.place.sequences * self.place.length, self.place.length):
            yield blocks_of(source, begin, begin + self.place.length)

    def _blank_border(self) -> int:
        """Mask the pixels affected by repeated ones beyond the border, where half of the pixels remain; return their width [px].

        Weights that fall on one repeated pixel add up: the matched filter's variance is up to twice as large there, and its false alarms
        many times more.
        """
        _, rows, columns = self.statistic.shape
        width = self.detector.reach or 0
        inside = (rows - 2 * width, columns - 2 * width)
        if not width or min(inside) < 1 or 2 * inside[0] * inside[1] < rows * columns:
            return 0
        for part in (np.s_[:, :width], np.s_[:, rows - width :], np.s_[:, :, :width], np.s_[:, :, columns - width :]):
            self.statistic[part] = np.nan
        return width

    def threshold(self, given: float, law: Law) -> Threshold:
        """Return the threshold in standard deviations above the mean.

        A calibrated statistic is already in standard deviations, and its thresholds depend on no measured number. A designed rate takes the
        Gaussian tail, of the calibrated statistic or of the measured mean and standard deviation.

        Raises
        ------
        DomainError
            A number that the law does not allow, or a threshold that is not above the mean.
        """
        if not np.isfinite(given):
            raise DomainError(f"threshold = {given:g}; give a finite number")
        calibrated = self.detector.calibrated and law != "frame"
        sigma = given
        if law == "design":
            if not 0.0 < given < 0.5:
                raise DomainError(f"designed rate of false alarms = {given:g} is not between 0 and 0.5; give e.g. 1e-5")
            from scipy.special import ndtri

            sigma = -float(ndtri(given))
        elif law == "fixed" and not calibrated:
            sigma = (given - self.mean) / self.sigma
        if not 0.0 < sigma < HIGHEST:
            raise DomainError(
                f"threshold = {given:g} is {sigma:.4g} standard deviations above the mean of the statistic "
                f"({self.mean:.4g}, standard deviation {self.sigma:.4g}); above 0 and below {HIGHEST:g} are needed"
            )
        return Threshold(law, given, sigma, law != "fixed" and not calibrated)

    def scale(self, window: int, law: Law) -> tuple[float, float]:
        """Return the mean and the standard deviation to which the statistic of a window is scaled."""
        if law == "frame":
            return float(self.frame_mean[window]), float(self.frame_sigma[window])
        return (0.0, 1.0) if self.detector.calibrated else (self.mean, self.sigma)

    def z(self, window: int, law: Law) -> NDArray[np.float32]:
        """Return the statistic of a window in standard deviations above the mean, shape (rows, columns) [1]."""
        mean, sigma = self.scale(window, law)
        if not sigma > 0:
            return np.full(self.statistic.shape[1:], np.nan, np.float32)
        return np.asarray((self.statistic[window] - np.float64(mean)) / sigma, np.float32)

    def add_to(self, alarms: FalseAlarms, law: Law) -> Iterator[NDArray[np.float32]]:
        """Add all windows to an accumulator of false alarms, and iterate over their statistics, see ``z``."""
        nothing = np.full(self.statistic.shape[1:], np.nan, np.float32)
        for window in range(self.windows):
            # An empty frame between sequences: exceedances of independent seas do not touch.
            if window and self.place.sequences > 1 and window % self.place.each == 0:
                alarms.add(nothing)
            z = self.z(window, law)
            alarms.add(z)
            yield z


@dataclass(frozen=True)
class FalseAlarmCount:
    """False alarms of a threshold over all windows."""

    alarms: FalseAlarms  #: Rates, events and the rate curve of z.
    cells: SegmentSums  #: Cells from which intervals are computed.
    per_pixel: Interval  #: Rate per pixel and frame [1].
    per_frame: Interval  #: Share of frames with at least one false alarm [1].


def count_false_alarms(background: Background, threshold: Threshold, level: float = 0.95) -> FalseAlarmCount:
    """Count the pixels above the threshold in all windows; alarms are single pixels, not clusters."""
    windows, rows, columns = background.statistic.shape
    alarms = FalseAlarms(tuple({threshold.sigma, LOWEST_THRESHOLD}))
    place = background.place
    each = place.each if place.sequences > 1 else 0
    cells = SegmentSums(windows, rows, columns, threshold.sigma, estimated=threshold.estimated, each=each)
    with_alarm = np.zeros(windows, np.int64)
    for k, z in enumerate(background.add_to(alarms, threshold.law)):
        cells.add(k, z)
        with_alarm[k] = bool((z > threshold.sigma).any())
    curve = alarms.curve()
    # The density of z converts a shift of a threshold to a number of pixels.
    at, below = (curve.density(m) for m in (threshold.sigma, LOWER * threshold.sigma))
    per_pixel = cells.false_alarm_interval((at, below), level)
    per_frame = interval(with_alarm[:, None, None], np.ones((windows, 1, 1), np.int64), None, level)
    return FalseAlarmCount(alarms, cells, per_pixel, per_frame)


def _room(shape: tuple[int, ...]) -> Any:
    """Return an array, on disk where it is large; the file has no name and is deleted with the array."""
    if 4.0 * np.prod(shape, dtype=np.float64) <= KEPT_BYTES:
        return np.empty(shape, np.float32)
    try:
        with tempfile.TemporaryFile() as file:
            return np.memmap(file, np.float32, "w+", shape=shape)
    except OSError as error:
        raise DataError(
            f"the statistic of {shape[0]} frames of {shape[1]} x {shape[2]} px finds no room among temporary files ({error}); "
            "set TMPDIR to a folder with more, or give fewer frames"
        ) from error
