"""Brightness of a preview: limits from the sea, and a logarithm where glint would leave the sea black."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any, Final, Literal

import numpy as np
from numpy.typing import NDArray

from seaglint.base.brightness import Scale, scale_limits
from seaglint.base.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.files.directions import directions

if TYPE_CHECKING:
    import xarray as xr

Kind = Literal["auto", "linear", "log"]

_NEAR_HORIZON: Final = 0.1
"""Share of the depressions in view, from the horizon on, that sets no limits: the sea is as warm as the air there, in long wave a few
kelvin above all the rest."""

_WIDER: Final = 1.5
"""Times the sea's own range that the limits may span to show horizon and sky too."""

_FLAT: Final = 0.1
"""Share of a linear scale that the middle half of the sea's pixels has to span; else the scale is logarithmic."""


def scale_of(values: NDArray[Any], sea: NDArray[np.bool_] | None = None, kind: Kind = "auto") -> Scale:
    """Scale for images.

    Parameters
    ----------
    values : ndarray, shape (..., rows, columns)
        Radiances [any unit].
    sea : ndarray of bool, shape (rows, columns), optional
        Pixels whose brightness sets the limits (:func:`sea_pixels`); all where there are none.
    kind : {"auto", "linear", "log"}
        ``auto`` takes the logarithm where the middle half of the pixels would share less than a tenth of a linear scale.

    Returns
    -------
    Scale
        Never empty.

    Examples
    --------
    >>> Scale(0.0, 99.0, width=1.0).share(np.array([0.0, 9.0, 99.0])).round(2).tolist()
    [0.0, 0.5, 1.0]
    """
    chosen = values[..., sea] if sea is not None and np.isfinite(values[..., sea]).any() else values
    low, high = scale_limits(chosen)
    whole_low, whole_high = scale_limits(values)
    if max(whole_high, high) - min(whole_low, low) <= _WIDER * (high - low):
        low, high = min(whole_low, low), max(whole_high, high)
    finite = chosen[np.isfinite(chosen)]
    if kind == "linear" or finite.size == 0:
        return Scale(low, high)
    quarter, middle, three_quarters = (float(v) for v in np.percentile(finite, (25.0, 50.0, 75.0)))
    if kind == "auto" and three_quarters - quarter >= _FLAT * (high - low):
        return Scale(low, high)
    # The darker half of the sea within one width; not less than a thousandth of the range, which is flat.
    return Scale(low, high, max(middle - low, 1e-3 * (high - low)))


def sea_pixels(dataset: xr.Dataset) -> NDArray[np.bool_] | None:
    """Pixels of sea, those next to the horizon apart, from the elevations and the sensor's height; None where they are not known."""
    try:
        height = float(json.loads(dataset.attrs["scenario"])["sensor"]["height_m"])
    except (KeyError, ValueError, TypeError):
        return None
    azimuth, elevation = directions(dataset)
    dip = np.degrees(np.sqrt(2.0 * max(height, 0.0) / EFFECTIVE_EARTH_RADIUS))
    below = -elevation - dip
    deepest = float(np.max(below))
    if not deepest > 0.0:
        return None
    sea = below > _NEAR_HORIZON * deepest
    return np.asarray(sea if sea.ndim == 2 else np.repeat(sea[:, np.newaxis], azimuth.size, axis=1))
