"""Detectors on single images: filters followed by a threshold, Laplacian of Gaussian, max-mean and max-median.

References
----------
Deshpande, Er, Venkateswarlu and Chan 1999, Proc. SPIE 3809, 74 (max-mean and max-median); Marr and Hildreth 1980, Proc. R. Soc. B 207, 187.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from seaglint.base.errors import DomainError
from seaglint.clutter.filters import DifferenceOfGaussians, Filter, Kernel, Laplacian, MatchedFilter, TopHat, Unfiltered, as_frames
from seaglint.detection.interface import Detector, Frames

#: Filters whose output for a sum of frames is the sum of their outputs.
_LINEAR: Final = (Unfiltered, Laplacian, DifferenceOfGaussians, Kernel, MatchedFilter)

_DIRECTIONS: Final = ((0, 1), (1, 0), (1, 1), (1, -1))


@dataclass(frozen=True)
class FilterThreshold:
    """Threshold detector whose statistic is the frame itself, or a filtered frame.

    Parameters
    ----------
    filter : Filter
        Before the threshold; none by default.
    label : str, optional
        Name in the results.
    """

    filter: Filter = field(default_factory=Unfiltered)
    label: str = "threshold"
    lead: int = field(default=0, init=False)
    calibrated: bool = field(default=False, init=False)

    @property
    def name(self) -> str:
        """Name in the results."""
        return self.label

    @property
    def reach(self) -> int:
        """Margin of the filter [px]."""
        return self.filter.margin

    @property
    def linear(self) -> bool:
        """True if the filter is linear."""
        return isinstance(self.filter, _LINEAR)

    @property
    def null_law(self) -> str | None:
        """Gaussian distribution for Gaussian clutter where the filter is linear."""
        return "Gaussian of the measured mean and standard deviation, Gaussian clutter" if self.linear else None

    def __call__(self, frames: Frames) -> Frames:
        """Filtered frames, shape (k, rows, columns), unit of the input times the unit of the filter."""
        return self.filter.apply(frames)


def top_hat() -> FilterThreshold:
    """Return the detector behind a morphological top-hat, which keeps bright spots smaller than its square."""
    return FilterThreshold(TopHat(), "top-hat")


@dataclass(frozen=True)
class Chain:
    """Detector behind a filter.

    Parameters
    ----------
    filter : Filter
        Applied to every frame.
    detector : Detector
        Detector that receives the filtered frames.
    """

    filter: Filter
    detector: Detector

    @property
    def name(self) -> str:
        """Name of the detector."""
        return self.detector.name

    @property
    def lead(self) -> int:
        """Number of earlier frames that the detector needs [frames]."""
        return self.detector.lead

    @property
    def calibrated(self) -> bool:
        """True if the detector's statistic is in equivalent standard deviations."""
        return self.detector.calibrated

    @property
    def reach(self) -> int | None:
        """Sum of the reaches of filter and detector [px]."""
        return None if self.detector.reach is None else self.detector.reach + self.filter.margin

    @property
    def linear(self) -> bool:
        """True if filter and detector are linear."""
        return self.detector.linear and isinstance(self.filter, _LINEAR)

    @property
    def null_law(self) -> str | None:
        """Distribution of the detector's statistic; the filter may violate its assumptions."""
        return self.detector.null_law

    def __call__(self, frames: Frames) -> Frames:
        """Statistic of the filtered frames from ``lead`` on, shape (k - lead, rows, columns)."""
        return self.detector(self.filter.apply(frames))


def laplacian_of_gaussian(scale: float) -> Kernel:
    """Negative Laplacian of a Gaussian of standard deviation ``scale`` [px], positive for bright spots of about that size.

        h(r) = (1 - r² / (2 s²)) exp(-r² / (2 s²)) / (pi s⁴), less its mean over the window of four standard deviations

    Raises
    ------
    DomainError
        A scale outside 0.4-10 px, where pixels do not resolve it or the window grows beyond use.
    """
    if not 0.4 <= scale <= 10.0:
        raise DomainError(f"scale = {scale:g} px of the Laplacian of Gaussian is outside 0.4-10 px; choose the object's standard deviation")
    half = int(np.ceil(4.0 * scale))
    axis = np.arange(-half, half + 1)
    q = (axis[:, None] ** 2 + axis**2) / (2.0 * scale**2)
    weights = (1.0 - q) * np.exp(-q) / (np.pi * scale**4)
    return Kernel(weights - weights.mean(), name="laplacian_of_gaussian")


@dataclass(frozen=True)
class DirectionalBackground:
    """Max-mean and max-median detector: pixel minus the largest of the means, or medians, along four lines through it.

        T = x - max(Z_row, Z_column, Z_diagonal, Z_other diagonal)

    over ``size`` pixels of each line, the pixel itself among them: an edge along any of the lines is part of its background.

    Parameters
    ----------
    kind : {"mean", "median"}
        Average along the lines.
    size : int
        Pixels of a line, odd, at least 3.
    """

    kind: Literal["mean", "median"] = "median"
    size: int = 9
    lead: int = field(default=0, init=False)
    calibrated: bool = field(default=False, init=False)
    linear: bool = field(default=False, init=False)
    null_law: None = field(default=None, init=False)

    def __post_init__(self) -> None:
        if self.size < 3 or self.size % 2 == 0:
            raise DomainError(f"size = {self.size} px of max-{self.kind} is not an odd number of at least 3; choose e.g. 9")

    @property
    def name(self) -> str:
        """Name in the results."""
        return f"max-{self.kind}"

    @property
    def reach(self) -> int:
        """Half the length of the lines [px]."""
        return self.size // 2

    def __call__(self, frames: Frames) -> Frames:
        """Excess over the largest, shape (k, rows, columns), unit of the input; NaN where a line holds a missing value."""
        source = as_frames(frames)
        half = self.reach
        out = np.empty_like(source)
        for k, frame in enumerate(source):
            wide = np.pad(frame, half, mode="edge")
            highest: NDArray[np.float32] | None = None
            for down, right in _DIRECTIONS:
                line = np.stack([_moved(wide, half + s * down, half + s * right, frame.shape) for s in range(-half, half + 1)])
                level = line.mean(0) if self.kind == "mean" else np.median(line, axis=0)
                highest = level if highest is None else np.maximum(highest, level)
            out[k] = frame - highest
        return out


def _moved(wide: Frames, row: int, column: int, shape: tuple[int, ...]) -> Frames:
    return wide[row : row + shape[0], column : column + shape[1]]
