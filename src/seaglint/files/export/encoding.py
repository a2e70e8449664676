"""Number formats of an exported file: those of the run, single precision, or counts of 16 bits with scale and offset."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final, Literal

import numpy as np
from numpy.typing import NDArray

from seaglint.base.errors import DataError

Kind = Literal["uint16", "float32"]

MOST: Final = 65535  #: Largest count.


@dataclass(frozen=True)
class Counts:
    """Linear relation of values to counts of 16 bits: ``value = offset + scale * count``; count 0 stands where there is no value.

    Examples
    --------
    >>> counts = Counts.over(0.0, 65534.0)
    >>> counts.of(np.array([0.0, 10.4, np.nan])).tolist(), counts.scale, counts.offset
    ([1, 11, 0], 1.0, -1.0)
    """

    scale: float
    offset: float

    @classmethod
    def over(cls, low: float, high: float) -> Counts:
        """Return counts 1 to 65535 from ``low`` to ``high``, which may be equal."""
        scale = (high - low) / (MOST - 1) or 1.0
        return cls(scale, low - scale)

    def steps(self, values: NDArray[Any]) -> NDArray[np.float64]:
        """Return the nearest counts, not limited to 16 bits; NaN stays."""
        return np.asarray(np.rint((np.asarray(values, np.float64) - self.offset) / self.scale))

    def of(self, values: NDArray[Any]) -> NDArray[np.uint16]:
        """Return the counts of values; those beyond the range get the counts of its ends."""
        return np.asarray(np.nan_to_num(np.clip(self.steps(values), 1, MOST), nan=0.0), np.uint16)

    def beyond(self, values: NDArray[Any]) -> int:
        """Return the number of values beyond the range."""
        steps = self.steps(values)
        return int(np.count_nonzero((steps < 1) | (steps > MOST)))


@dataclass(frozen=True)
class NumberFormat:
    """Type of the numbers in a file, and the counts that represent values."""

    dtype: np.dtype[Any]
    counts: Counts | None = None

    def of(self, values: NDArray[Any]) -> NDArray[Any]:
        """Return values as they are stored in the file."""
        return np.ascontiguousarray(values if self.counts is None else self.counts.of(values), dtype=self.dtype)

    @property
    def attributes(self) -> dict[str, float | int]:
        """Return scale, offset and the mark of missing values by their CF names; empty where values are stored as they are."""
        if self.counts is None:
            return {}
        return {"scale_factor": self.counts.scale, "add_offset": self.counts.offset, "_FillValue": 0}


def check_limits(limits: tuple[float, float]) -> tuple[float, float]:
    """Refuse a range that is not finite or not ascending.

    Raises
    ------
    DataError
        Limits that are not finite, or not one below the other.
    """
    low, high = limits
    if not (np.isfinite([low, high]).all() and low < high):
        raise DataError(f"limits=({low:g}, {high:g}) is no range; give two finite numbers, the smaller first")
    return float(low), float(high)
