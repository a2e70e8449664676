"""Brightness scale of a picture: values become 255 levels, linearly, between percentiles, or by plateau equalisation.

Level 0 is kept for pixels without a value. The colours of the levels are drawn by the browser.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from seaglint.base.brightness import CELLS, Scale
from seaglint.base.errors import DataError

Kind = Literal["linear", "percentile", "plateau"]
KINDS: Final[tuple[str, ...]] = get_args(Kind)

PERCENTILES: Final = (1.0, 99.0)  #: Percentiles of the values that percentile scaling maps to dark and bright [%].

PLATEAU: Final = 3.0  #: Largest count of a bin in plateau equalisation, in mean counts of the bins that are not empty.


def scaling_of(
    images: Sequence[NDArray[np.floating[Any]]],
    kind: str,
    *,
    limits: tuple[float, float] | None = None,
    percentiles: tuple[float, float] = PERCENTILES,
    symmetric: bool = False,
) -> Scale:
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
        return Scale(low, high)
    if not 0.0 <= percentiles[0] < percentiles[1] <= 100.0:
        raise DataError(f"percentiles {percentiles[0]:g} and {percentiles[1]:g}: give two from 0 to 100, the smaller first")
    values = np.concatenate([image[np.isfinite(image)].ravel() for image in images]) if images else np.empty(0)
    if not values.size:
        return Scale(0.0, 1.0)
    low, high = (float(v) for v in (np.percentile(values, percentiles) if kind == "percentile" else (values.min(), values.max())))
    if symmetric:
        high = max(abs(low), abs(high))
        low = -high
    if kind != "plateau" or not high > low:
        return Scale(low, high)
    counts = np.histogram(values, bins=CELLS, range=(low, high))[0].astype(np.float64)
    counts = np.minimum(counts, PLATEAU * counts.sum() / np.count_nonzero(counts))
    return Scale(low, high, steps=np.concatenate([[0.0], np.cumsum(counts) / counts.sum()]))
