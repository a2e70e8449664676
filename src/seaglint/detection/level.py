"""Restoration of the level that a recording subtracts from its frames for precision, where a detector or a threshold needs it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from seaglint.detection.counting import Counting
from seaglint.detection.interface import Detector, Frames
from seaglint.detection.sources import FrameSource, PlainFrames


@dataclass(frozen=True)
class Rescaled(PlainFrames):
    """Source whose values are multiplied by a factor and raised by a level.

    With a factor of -1 dark objects are bright, which is what detectors look for.
    """

    source: FrameSource
    factor: float = 1.0
    level: float = 0.0

    @property
    def frames(self) -> int:
        """Number of frames."""
        return self.source.frames

    @property
    def rows(self) -> int:
        """Rows of a frame [px]."""
        return self.source.rows

    @property
    def columns(self) -> int:
        """Columns of a frame [px]."""
        return self.source.columns

    @property
    def sequence_length(self) -> int:
        """Number of frames of each independent sequence; 0 where all belong together."""
        return self.source.sequence_length

    @property
    def saturation(self) -> float | None:
        """Saturation value of a pixel [u]; None with a negative factor, where the largest value was the least."""
        highest = self.source.saturation
        return None if highest is None or self.factor < 0.0 else self.factor * highest + self.level

    @property
    def counting(self) -> Counting | None:
        """Counting of an object's light; with a negative factor that of dark objects, which have no shot noise of their own."""
        counting = self.source.counting
        if counting is None:
            return None
        electrons = None if counting.electrons is None or self.factor < 0.0 else counting.electrons / self.factor
        return Counting(electrons, counting.step * abs(self.factor))

    def read(self, start: int, stop: int) -> Frames:
        """Frames ``start`` to ``stop`` (not included) [u]."""
        return np.asarray(self.source.read(start, stop).astype(np.float64) * self.factor + self.level, np.float32)


def level_shift(detector: Detector, source: FrameSource) -> float:
    """Shift of the statistic by the level that a recording subtracts from its frames [its unit].

    Statistics that are not linear take differences or ratios of neighbours, on which a level has no effect.
    """
    if not source.offset or not detector.linear:
        return 0.0
    ones = np.ones((detector.lead + 1, source.rows, source.columns), np.float32)
    answer = detector(ones)[-1]
    return source.offset * float(answer[source.rows // 2, source.columns // 2])
