"""Brightness of a preview: limits from all pixels shown, and a logarithm where glint would leave the sea black."""

from __future__ import annotations

from typing import Any, Final, Literal

import numpy as np
from numpy.typing import NDArray

from seaglint.base.brightness import Scale, scale_limits
from seaglint.base.representation import rounded

Kind = Literal["auto", "linear", "log"]

_FLAT: Final = 0.1
"""Share of a linear scale that the middle half of the pixels has to span; else the scale is logarithmic."""


def scale_of(values: NDArray[Any], kind: Kind = "auto") -> Scale:
    """Scale for images: its limits leave out one pixel in five hundred at either end, and no part of the picture.

    Parameters
    ----------
    values : ndarray
        Radiances [any unit].
    kind : {"auto", "linear", "log"}
        ``auto`` takes the logarithm where half of the pixels would share less than a tenth of a linear scale at its dark end.

    Returns
    -------
    Scale
        Never empty.

    Examples
    --------
    >>> scale_of(np.linspace(1.0, 2.0, 1001)).logarithmic, scale_of(np.geomspace(1.0, 1e6, 1001)).logarithmic
    (False, True)
    """
    low, high = scale_limits(values)
    finite = values[np.isfinite(values)]
    if kind == "linear" or finite.size == 0:
        return Scale(low, high)
    quarter, middle, three_quarters = (float(v) for v in np.percentile(finite, (25.0, 50.0, 75.0)))
    crowded = three_quarters - quarter < _FLAT * (high - low) and middle - low < 0.5 * (high - low)
    if kind == "auto" and not crowded:
        return Scale(low, high)
    # The darker half of the pixels within one width; not less than a thousandth of the range, which is flat.
    return Scale(low, high, max(middle - low, 1e-3 * (high - low)))


def tick_labels(values: NDArray[Any], digits: int = 3) -> list[str]:
    """Numbers of a colour bar, with as many digits as make neighbours differ, at least ``digits`` and at most 9.

    Examples
    --------
    >>> tick_labels(np.array([28.01, 28.04, 28.2, 30.0]))
    ['28.01', '28.04', '28.2', '30']
    >>> tick_labels(np.array([903.0, 4610.0, 25400.0]))
    ['903', '4610', '25400']
    """
    for figures in range(digits, 10):
        labels = [rounded(value, figures) for value in values]
        if len(set(labels)) == len(labels):
            break
    return labels
