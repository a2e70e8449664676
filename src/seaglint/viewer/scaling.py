"""Brightness scale of a picture: values become 255 levels, linearly, between percentiles, or by plateau equalisation.

Level 0 is kept for pixels without a value. The colours of the levels are drawn by the browser.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from seaglint.base.errors import DataError

Kind = Literal["linear", "percentile", "plateau"]
KINDS: Final[tuple[str, ...]] = get_args(Kind)

LEVELS: Final = 255
"""Number of levels of values, counted from 1."""

PERCENTILES: Final = (1.0, 99.0)
"""Percentiles of the values that percentile scaling maps to dark and bright [%]."""

PLATEAU: Final = 3.0
"""Largest count of a bin in plateau equalisation, in mean counts of the bins that are not empty."""

CELLS: Final = 4096
"""Number of bins of the histogram."""


@dataclass(frozen=True, eq=False)
class Scaling:
    """Map of values to levels of brightness.

    Attributes
    ----------
    low, high : float
        Values of the darkest and the brightest level [unit of the image].
    steps : ndarray or None
        Brightness [0, 1] at the :data:`CELLS` + 1 edges of even cells from ``low`` to ``high``; None for a straight line.
    """

    low: float
    high: float
    steps: NDArray[np.float64] | None = None

    def levels(self, image: NDArray[np.floating[Any]]) -> NDArray[np.uint8]:
        """Return levels 1 to 255 of an image, 0 where it has no value; values beyond the limits get the levels of the limits."""
        span = self.high - self.low
        with np.errstate(invalid="ignore", over="ignore", divide="ignore"):
            if self.steps is None:
                share = (
                    (image - self.low) * ((LEVELS - 1) / span) if span > 0.0 else np.where(np.isfinite(image), (LEVELS - 1) / 2.0, np.nan)
                )
                shown = np.clip(share, 0.0, LEVELS - 1) + 1.5
                return np.where(np.isnan(shown), 0.0, shown).astype(np.uint8)
            cell = np.clip((image - self.low) * (CELLS / span), 0.0, CELLS - 1)
            missing = np.isnan(cell)
            table = np.rint(1.0 + (LEVELS - 1) * 0.5 * (self.steps[:-1] + self.steps[1:])).astype(np.uint8)
            levels = table[np.where(missing, 0.0, cell).astype(np.int32)]
        levels[missing] = 0
        return np.asarray(levels)

    def value(self, share: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the values at fractions of the brightness, for the colour bar of the picture."""
        if self.steps is None:
            return self.low + share * (self.high - self.low)
        edges = np.linspace(self.low, self.high, CELLS + 1)
        rising = np.concatenate([[True], np.diff(self.steps) > 0.0])
        return np.asarray(np.interp(share, self.steps[rising], edges[rising]))


def scaling_of(
    images: Sequence[NDArray[np.floating[Any]]],
    kind: str,
    *,
    limits: tuple[float, float] | None = None,
    percentiles: tuple[float, float] = PERCENTILES,
    symmetric: bool = False,
) -> Scaling:
    """Return the scaling of some images: of one frame for itself, of several for a sequence.

    Parameters
    ----------
    images : sequence of ndarray
        Images that set it.
    kind : {"linear", "percentile", "plateau"}
        From the smallest to the largest value; between two percentiles; or with levels for as many pixels each, where cells that hold
        very many count a plateau only (Vickers 1996), so that an even sky does not take all levels.
    limits : (float, float), optional
        Ends of a straight line instead [unit of the images].
    percentiles : (float, float)
        Lower and upper one [%].
    symmetric : bool
        Zero in the middle, for differences.

    Raises
    ------
    DataError
        An unknown kind, or limits that are no range.
    """
    if kind not in KINDS:
        raise DataError(f"scaling '{kind}': allowed are {', '.join(KINDS)}")
    if limits is not None:
        low, high = limits
        if not (np.isfinite([low, high]).all() and low < high):
            raise DataError(f"limits {low:g} to {high:g}: give two finite numbers, the smaller first")
        return Scaling(low, high)
    if not 0.0 <= percentiles[0] < percentiles[1] <= 100.0:
        raise DataError(f"percentiles {percentiles[0]:g} and {percentiles[1]:g}: give two from 0 to 100, the smaller first")
    values = np.concatenate([image[np.isfinite(image)].ravel() for image in images]) if images else np.empty(0)
    if not values.size:
        return Scaling(0.0, 1.0)
    low, high = (float(v) for v in (np.percentile(values, percentiles) if kind == "percentile" else (values.min(), values.max())))
    if symmetric:
        high = max(abs(low), abs(high))
        low = -high
    if kind != "plateau" or not high > low:
        return Scaling(low, high)
    counts = np.histogram(values, bins=CELLS, range=(low, high))[0].astype(np.float64)
    counts = np.minimum(counts, PLATEAU * counts.sum() / np.count_nonzero(counts))
    return Scaling(low, high, np.concatenate([[0.0], np.cumsum(counts) / counts.sum()]))
