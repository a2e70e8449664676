"""Brightness scales of pictures: from values to grey levels, linear, logarithmic or equalised."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray

PERCENTILES: Final = (0.2, 99.8)  #: Scale limits: a few sparkles are tens of times brighter than the sea and would turn the rest black.

LEVELS: Final = 255  #: Number of levels of values, counted from 1.

CELLS: Final = 4096  #: Number of bins of the histogram of plateau equalisation.


@dataclass(frozen=True, eq=False)
class Scale:
    """Brightness scale: linear, logarithmic above the lower limit, or steps of equal numbers of pixels.

    A logarithmic scale is

    ``share = ln(1 + (x - low) / width) / ln(1 + (high - low) / width)``

    which is linear within ``width`` of the lower limit and even in decades far above it.
    """

    low: float  #: Lower limit.
    high: float  #: Upper limit.
    width: float | None = None  #: Width of the linear part of a logarithmic scale; None for other scales.
    #: Brightness [0, 1] at the ``CELLS`` + 1 edges of even cells from ``low`` to ``high``, of a scale by plateau equalisation.
    steps: FloatArray | None = None

    @property
    def logarithmic(self) -> bool:
        """True for a logarithmic scale."""
        return self.width is not None

    def share(self, values: NDArray[Any]) -> FloatArray:
        """Return the brightness of values, 0 at the lower limit and 1 at the upper one [1], not clipped; NaN for NaN."""
        x = np.asarray(values, np.float64) - self.low
        if self.steps is not None:
            return np.asarray(np.interp(x, np.linspace(0.0, self.high - self.low, CELLS + 1), self.steps))
        if self.width is None:
            return np.asarray(x / (self.high - self.low))
        # values below the limit are black; the bound is above the pole of the logarithm, one width below the limit
        return np.asarray(np.log1p(np.maximum(x / self.width, -0.5)) / np.log1p((self.high - self.low) / self.width))

    def value(self, share: NDArray[Any]) -> FloatArray:
        """Return the values of a brightness, the inverse of ``share``."""
        s = np.asarray(share, np.float64)
        if self.steps is not None:
            # cells without pixels make flat steps, which have no inverse
            rising = np.concatenate([[True], np.diff(self.steps) > 0.0])
            return np.asarray(np.interp(s, self.steps[rising], np.linspace(self.low, self.high, CELLS + 1)[rising]))
        if self.width is None:
            return np.asarray(self.low + s * (self.high - self.low))
        return np.asarray(self.low + self.width * np.expm1(s * np.log1p((self.high - self.low) / self.width)))

    def levels(self, image: NDArray[np.floating[Any]]) -> NDArray[np.uint8]:
        """Return levels 1 to 255 of an image, 0 for pixels without a value; values beyond the limits have the levels of the limits."""
        span, top = self.high - self.low, LEVELS - 1
        with np.errstate(invalid="ignore", over="ignore", divide="ignore"):
            if self.steps is None:
                share: NDArray[np.floating[Any]]
                if self.width is not None:
                    share = self.share(image) * top
                else:  # in the precision of the image, which is faster: a viewer draws many large images
                    share = (image - self.low) * (top / span) if span > 0.0 else np.where(np.isfinite(image), top / 2.0, np.nan)
                shown = np.clip(share, 0.0, top) + 1.5
                return np.where(np.isnan(shown), 0.0, shown).astype(np.uint8)
            cell = np.clip((image - self.low) * (CELLS / span), 0.0, CELLS - 1)
            missing = np.isnan(cell)
            table = np.rint(1.0 + top * 0.5 * (self.steps[:-1] + self.steps[1:])).astype(np.uint8)
            levels = table[np.where(missing, 0.0, cell).astype(np.int32)]
        levels[missing] = 0
        return np.asarray(levels)


def eight_bit(share: NDArray[Any]) -> NDArray[np.uint8]:
    """Return the levels 0 to 255 of a brightness from 0 to 1, clipped; NaN is black."""
    return np.asarray(np.rint(255.0 * np.nan_to_num(np.clip(share, 0.0, 1.0), nan=0.0)), np.uint8)


def scale_limits(values: NDArray[Any], percentiles: tuple[float, float] = PERCENTILES) -> tuple[float, float]:
    """Return the limits of a colour scale, two percentiles of the values that are finite [%]; never empty."""
    finite = values[np.isfinite(values)]
    if finite.size == 0:
        return 0.0, 1.0
    low, high = (float(v) for v in np.percentile(finite, percentiles))
    margin = 1e-4 * max(abs(low), abs(high), 1e-12)  # a flat image must not show its rounding errors
    return (low, high) if high - low > margin else (low - margin, high + margin)
