"""Background near an object: rows of the sea, of the sky, or about the horizon, each less its mean."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Literal

import numpy as np

from seaglint.base.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.detection.sources import DerivedFrames, FrameSource

if TYPE_CHECKING:
    from seaglint.detection.interface import Frames
    from seaglint.detection.spot import SpotShape
    from seaglint.studies.detect.scene_frames import IndependentSeas

Background = Literal["sea", "horizon", "sky"]

AROUND: Final = 24  #: Rows above and below the object whose statistics are those of its background.

MARGIN: Final = 3  #: Rows on either side of the horizon that optics blur into one another.

FEWEST: Final = (
    20  #: Least number of rows of sea, or of sky, that are a separate background; fewer rows count as the background about the horizon.
)


@dataclass(frozen=True)
class NearRows(DerivedFrames):
    """Rows of a source, each less its mean over its columns in each frame.

    Sea brightens and sky darkens away from the horizon, in steps from row to row that are many times the clutter of a row. They are known
    wherever the horizon is, so that no detector must treat them as clutter.
    """

    source: FrameSource  #: Whole frames.
    first: int  #: First row taken [px].
    end: int  #: Row after the last one taken [px].

    @property
    def rows(self) -> int:
        """Rows taken [px]."""
        return self.end - self.first

    @property
    def saturation(self) -> float | None:
        """Unknown: the means that are taken off differ from row to row."""
        return None

    def read(self, start: int, stop: int) -> Frames:
        """Frames ``start`` to ``stop`` (not included) [u]."""
        return less_row_means(self.source.read(start, stop)[:, self.first : self.end])


def less_row_means(frames: Frames) -> Frames:
    """Return frames less the mean of each of their rows."""
    wide = frames.astype(np.float64)
    return np.asarray(wide - np.nanmean(wide, axis=2, keepdims=True), np.float32)


def rows_to_horizon(seas: IndependentSeas, row: int, extent: int) -> int | None:
    """Return the rows from an object up to the horizon, below 0 down to it [px].

    Parameters
    ----------
    seas : IndependentSeas
        Scene whose rows are known.
    row, extent : int
        Row of the object, and rows above and below it that the object fills [px].

    Returns
    -------
    int or None
        0 where a row of the object is neither sea nor sky alone; None where all rows are like the object's.
    """
    rows = seas.size[0]
    high, low, dip = _elevations(seas)
    at = min(max(row, 0), rows - 1)
    # Below the dip of the horizon is sea, above it sky.
    for like, sign in ((high < -dip, 1), (low > -dip, -1)):
        if like[max(at - extent, 0) : at + extent + 1].all():
            others = np.flatnonzero(~like)
            return sign * int(np.abs(others - at).min()) if others.size else None
    return 0


def half_height(shape: SpotShape) -> int:
    """Return the rows above and below its middle in which an object has a tenth of its peak or more [px]."""
    stamp = np.abs(np.asarray(shape.stamps(np.zeros((1, 2)))[0], np.float64))
    return int(np.abs(np.flatnonzero(stamp.max(axis=1) >= 0.1 * stamp.max()) - stamp.shape[0] // 2).max())


def _elevations(seas: IndependentSeas) -> tuple[np.ndarray, np.ndarray, float]:
    """Return the highest and the lowest elevation in each row, and the dip of the horizon [deg]."""
    elevation = np.asarray(seas.directions[1])
    high, low = (elevation, elevation) if elevation.ndim == 1 else (elevation.max(axis=1), elevation.min(axis=1))
    return high, low, math.degrees(math.sqrt(2.0 * max(seas.scenario.sensor.height_m, 0.0) / EFFECTIVE_EARTH_RADIUS))


def background_of(seas: IndependentSeas, row: int, half: int) -> tuple[Background, int, int]:
    """Return what lies around a row of the picture, and the first and end of the rows that are like it.

    A row is sea, or sky, where all of its pixels are, by their elevation against the dip of the horizon ``sqrt(2 h / R)`` with standard
    refraction, ``MARGIN`` rows apart. The background is that about the horizon where the object, ``half`` rows either way, comes near
    it, and where fewer than ``FEWEST`` rows are alike.
    """
    rows = seas.size[0]
    high, low, dip = _elevations(seas)
    # Optics blur the horizon over some rows, which are neither sea nor sky.
    apart = MARGIN * seas.pixel_deg[0]
    at = min(max(row, 0), rows - 1)
    window = np.zeros(rows, dtype=bool)
    window[max(at - AROUND, 0) : at + AROUND + 1] = True
    kinds: tuple[tuple[Background, np.ndarray], ...] = (("sea", high < -dip - apart), ("sky", low > -dip + apart))
    # The rows of the object itself, with three more on either side.
    own = slice(max(at - half - 3, 0), at + half + 4)
    for kind, like in kinds:
        if like[own].all() and np.count_nonzero(like & window) >= min(FEWEST, rows):
            inside = np.flatnonzero(like & window)
            return kind, int(inside[0]), int(inside[-1]) + 1
    return "horizon", max(at - AROUND, 0), min(at + AROUND + 1, rows)
