"""Ozone of a sounding in the air of a model atmosphere: joined to the model's above the highest level that has it, and its whole amount."""

from __future__ import annotations

from typing import Final

import numpy as np

from seaglint.base.conventions import FloatArray

#: Height over which the ratio of the sounding's last ozone to the model's falls to 1/e [m]: about a scale height of ozone aloft.
JOIN_M: Final = 5000.0

LARGEST_RATIO: Final = 1e3  #: Largest ratio at the join, either way.

BOLTZMANN: Final = 1.380649e-23  #: [J K-1].

DOBSON: Final = 2.6867e20  #: Molecules of one Dobson unit [m-2].


def joined_ozone(height: FloatArray, of_model: FloatArray, given: FloatArray) -> FloatArray:
    """Ozone [1e-6 of the volume, (levels,)] of a sounding, with the model's above its highest known level.

    The ratio of both at that level goes to 1 as ``exp(-(z - z_last) / 5 km)`` in its logarithm, so that no step is made. Missing values
    between known levels are linear in height; below the lowest known level its value holds.

    Parameters
    ----------
    height, of_model : ndarray
        Ascending levels [m] and the model's ozone there [1e-6 of the volume]; (levels,).
    given : ndarray
        The sounding's ozone at the first of these levels [1e-6 of the volume], NaN where missing.
    """
    known = np.flatnonzero(np.isfinite(given))
    if not known.size:
        return of_model
    last = int(known[-1])
    ratio = np.clip(given[last] / of_model[last], 1.0 / LARGEST_RATIO, LARGEST_RATIO)
    above = of_model[last + 1 :] * ratio ** np.exp(-(height[last + 1 :] - height[last]) / JOIN_M)
    return np.concatenate([np.interp(height[: last + 1], height[known], given[known]), above])


def ozone_dobson(height: FloatArray, pressure: FloatArray, temperature: FloatArray, ozone: FloatArray) -> float:
    """Ozone above the lowest level [Dobson units] of levels [m], [hPa], [K], [1e-6 of the volume], exponential between them."""
    density = 1e-6 * ozone * 100.0 * pressure / (BOLTZMANN * temperature)
    a, b = density[:-1], density[1:]
    both = (a > 0.0) & (b > 0.0) & (np.abs(a - b) > 1e-9 * a)
    ratio = np.where(both, a, np.e) / np.where(both, b, 1.0)
    mean = np.where(both, (a - b) / np.log(ratio), 0.5 * (a + b))
    return float(np.sum(mean * np.diff(height)) / DOBSON)
