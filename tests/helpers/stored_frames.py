"""Frames in memory, as detectors are judged in them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from seaglint.detection.sources import Counting, PlainFrames


@dataclass
class StoredFrames(PlainFrames):
    """A source of given values (frames, rows, columns)."""

    values: np.ndarray
    saturation: float | None = None
    sequence_length: int = 0
    counting: Counting | None = None
    offset: float = 0.0

    @property
    def frames(self) -> int:
        return self.values.shape[0]

    @property
    def rows(self) -> int:
        return self.values.shape[1]

    @property
    def columns(self) -> int:
        return self.values.shape[2]

    def read(self, start: int, stop: int) -> np.ndarray:
        return self.values[start:stop].copy()
