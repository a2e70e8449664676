"""The level that a recording takes off its frames for the sake of precision, where a detector or a threshold needs it back."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from seaglint.detection.background import FrameSource
from seaglint.detection.base import Detector, Frames


@dataclass(frozen=True)
class Raised:
    """A source with the level back that was taken off it."""

    source: FrameSource
    by: float

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
    def saturation(self) -> float | None:
        """Value beyond which no pixel goes [u]."""
        return None if self.source.saturation is None else self.source.saturation + self.by

    def read(self, start: int, stop: int) -> Frames:
        """Frames ``start`` to ``stop`` (not included) [u]."""
        return np.asarray(self.source.read(start, stop).astype(np.float64) + self.by, np.float32)


def level_shift(detector: Detector, source: FrameSource) -> float:
    """What the level that a recording takes off its frames would add to the statistic [its unit].

    Statistics that are not linear take differences or ratios of neighbours, on which a level has no effect.
    """
    offset = getattr(source, "offset", 0.0)
    if not offset or not detector.linear:
        return 0.0
    ones = np.ones((detector.lead + 1, source.rows, source.columns), np.float32)
    answer = detector(ones)[-1]
    return float(offset) * float(answer[source.rows // 2, source.columns // 2])
