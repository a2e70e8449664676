"""Spectra averaged to a coarser resolution by a triangle, as an instrument or a band model has them."""

from __future__ import annotations

import numpy as np

from seaglint.base.conventions import FloatArray


def triangular_average(wavenumber_cm: FloatArray, spectrum: FloatArray, centres_cm: FloatArray, width_cm: float = 20.0) -> FloatArray:
    """Average a spectrum with a triangle about each centre, of a full width at half maximum ``width_cm`` [unit of spectrum, (n,)].

    Parameters
    ----------
    wavenumber_cm : ndarray
        Ascending samples [cm-1, (m,)]; they may lie unevenly.
    spectrum : ndarray
        Values there, linear between them [(m,)].
    centres_cm : ndarray
        Middles of the triangles [cm-1, (n,)]. A triangle that reaches beyond the samples is cut there.
    width_cm : float
        Full width at half maximum [cm-1]; the triangle ends this far from its middle.

    Examples
    --------
    >>> nu = np.arange(900.0, 1000.5, 0.5)
    >>> triangular_average(nu, nu, np.array([950.0]))
    array([950.])
    """
    weight = np.maximum(1.0 - np.abs(centres_cm[:, None] - wavenumber_cm) / width_cm, 0.0) * np.gradient(wavenumber_cm)
    return np.asarray(weight @ spectrum / weight.sum(axis=1))
