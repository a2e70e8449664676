"""Frames without objects, in which detectors are evaluated: their interface, and the effects of a sensor and of a level.

A sensor counts the light of an injected object with shot noise and in steps of the converter (``Counting``). A recording may subtract
a level from its frames for precision; ``Rescaled`` and ``level_shift`` restore it where a detector or a threshold needs it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from scipy.special import ndtri, pdtr

from seaglint.base.conventions import FloatArray
from seaglint.base.random import stream
from seaglint.detection.interface import Detector, Frames


class FrameSource(Protocol):
    """Frames without objects: a recording, or pictures rendered on demand.

    A source inherits from ``PlainFrames`` the members that it does not define.
    """

    @property
    def frames(self) -> int:
        """Number of frames."""
        ...

    @property
    def rows(self) -> int:
        """Rows of a frame [px]."""
        ...

    @property
    def columns(self) -> int:
        """Columns of a frame [px]."""
        ...

    @property
    def saturation(self) -> float | None:
        """Saturation value of a pixel [u]; None where it is unknown."""
        ...

    @property
    def sequence_length(self) -> int:
        """Number of frames of each independent sequence; 0 where all belong together."""
        ...

    @property
    def counting(self) -> Counting | None:
        """Counting of an object's light by the sensor; None where objects are added unchanged."""
        ...

    @property
    def offset(self) -> float:
        """Level that ``read`` has subtracted from the source's own numbers [u]."""
        ...

    def read(self, start: int, stop: int) -> Frames:
        """Return frames ``start`` to ``stop`` (not included) as a copy, NaN where missing [u]."""
        ...


class PlainFrames:
    """Members of a source whose frames are one sequence of unchanged numbers, without a sensor's counting."""

    @property
    def sequence_length(self) -> int:
        """All frames belong together."""
        return 0

    @property
    def counting(self) -> Counting | None:
        """Objects are added unchanged."""
        return None

    @property
    def offset(self) -> float:
        """Nothing is subtracted [u]."""
        return 0.0


_MANY = 100.0  # from here on Cornish and Fisher's quantile is within 0.05 electrons of the exact one inside four standard deviations


@dataclass(frozen=True)
class Counting:
    """Increase of frames by an object's light, counted as the sensor does.

    Electrons of background and object are independent Poisson numbers, so that the electrons of the object may be added to frames which
    have the noise of the background already. The converter has rounded these: the increase is rounded up or down at random, so that its
    mean stays, and the sum takes the converter's values again.
    """

    electrons: float | None  #: Electrons for each unit of the frames [1/u]; None where a sensor has no shot noise.
    step: float  #: Step of the converter [u].

    def draws(self, seed: int, first: int, shape: tuple[int, int, int]) -> FloatArray:
        """Two uniform numbers for each pixel, functions of seed, frame and place, shape (k, 2, rows, columns).

        Parameters
        ----------
        seed : int
            Seed of the objects.
        first : int
            Number of the first frame in its source.
        shape : (int, int, int)
            Frames, rows, columns.
        """
        count, rows, columns = shape
        return np.stack([stream(seed, "object electrons", first + k).random((2, rows, columns)) for k in range(count)])

    def added(self, light: Frames, draws: FloatArray) -> Frames:
        """Increase of frames, in whole steps.

        Parameters
        ----------
        light : ndarray, shape (k, rows, columns)
            Mean of the objects' light [u]. Below 0, for objects darker than their background, it has no separate noise: the missing
            electrons take a little of the background's noise with them, which is left in.
        draws : ndarray, shape (k, 2, rows, columns)
            Numbers from ``draws``.
        """
        out = np.zeros_like(light)
        lit = light != 0.0
        mean = light[lit].astype(np.float64)
        drawn, rounded = draws[:, 0][lit], draws[:, 1][lit]
        if self.electrons is not None:
            number = mean * self.electrons
            bright = number > 0.0
            number[bright] = poisson_quantile(number[bright], drawn[bright])
            mean = number / self.electrons
        out[lit] = self.step * np.floor(mean / self.step + rounded)
        return out


def poisson_quantile(mean: FloatArray, share: FloatArray) -> FloatArray:
    """Quantile of a Poisson distribution: the least whole number with at least that probability, rising in both arguments.

    Examples
    --------
    >>> poisson_quantile(np.array([3.0, 1e4]), np.array([0.5, 0.5])).tolist()
    [3.0, 10000.0]
    """
    # Cornish and Fisher: the Gaussian quantile with the skewness of the Poisson distribution.
    z = ndtri(np.clip(share, 1e-16, 1.0 - 1e-16))
    out = np.rint(mean + np.sqrt(mean) * z + (z * z - 1.0) / 6.0)
    few = np.flatnonzero(mean < _MANY)
    out[few] = _exact_quantile(np.maximum(out[few], 0.0), mean[few], share[few])
    return out


def _exact_quantile(number: FloatArray, mean: FloatArray, share: FloatArray) -> FloatArray:
    """Return the least whole numbers whose cumulative Poisson probability is at least ``share``, searched from ``number`` in place."""
    short = pdtr(number, mean) < share
    below, above = np.flatnonzero(short), np.flatnonzero(~short)
    while below.size:
        number[below] += 1.0
        below = below[pdtr(number[below], mean[below]) < share[below]]
    above = above[number[above] > 0.0]
    while above.size:
        above = above[pdtr(number[above] - 1.0, mean[above]) >= share[above]]
        number[above] -= 1.0
        above = above[number[above] > 0.0]
    return number


class DerivedFrames(PlainFrames):
    """Members of a source that takes its frames from another source, in their number and size."""

    source: FrameSource

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
    def counting(self) -> Counting | None:
        """Counting of an object's light."""
        return self.source.counting


@dataclass(frozen=True)
class Rescaled(DerivedFrames):
    """Source whose values are multiplied by a factor and raised by a level.

    With a factor of -1 dark objects are bright, which is what detectors look for.
    """

    source: FrameSource
    factor: float = 1.0
    level: float = 0.0

    @property
    def saturation(self) -> float | None:
        """Saturation value of a pixel [u]; None with a negative factor, where saturation would be the smallest value."""
        highest = self.source.saturation
        return None if highest is None or self.factor < 0.0 else self.factor * highest + self.level

    @property
    def counting(self) -> Counting | None:
        """Counting of an object's light; with a negative factor counting of dark objects, without separate shot noise."""
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
    # The statistic of a constant 1 in the middle of the frame is the weight of a level.
    answer = detector(ones)[-1]
    return source.offset * float(answer[source.rows // 2, source.columns // 2])
