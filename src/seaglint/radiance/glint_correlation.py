"""Correlation length of glint on the sea from its correlation time, by the dispersion of short waves."""

from __future__ import annotations

from typing import Final

import numpy as np

from seaglint.base.constants import SEA_WATER_DENSITY
from seaglint.base.errors import DomainError
from seaglint.sea.dispersion import wavenumber

#: Surface tension in Eq. 17 of the source article [N m-1] (76.3 dyn/cm; its text calls it a viscosity).
ARTICLE_SURFACE_TENSION: Final = 76.3e-3


def _angular_frequency(correlation_time: float) -> float:
    if not (np.isfinite(correlation_time) and correlation_time > 0.0):
        raise DomainError(f"correlation_time = {correlation_time:g} s; give a time > 0 s, e.g. 0.07")
    return 2.0 * np.pi / correlation_time


def correlation_length(correlation_time: float) -> float:
    """Length ``l = 1/k`` of the wave of angular frequency ``2 pi / T_c``, with gravity and surface tension [m].

    Parameters
    ----------
    correlation_time : float
        Time after which glint at a point is forgotten [s].

    Returns
    -------
    float
        Correlation length [m].

    Examples
    --------
    >>> [round(100.0 * correlation_length(t), 3) for t in (0.07, 0.3)]
    [0.257, 2.268]
    """
    return float(1.0 / wavenumber(_angular_frequency(correlation_time)))


def capillary_length(correlation_time: float) -> float:
    """Length ``l = 1/k`` by surface tension alone, ``omega^2 = T k^3 / rho`` with 76.3 dyn/cm: Eq. 17 of the source article as printed [m].

    Gravity is not negligible there: :func:`correlation_length` gives 0.257 and 2.27 cm for 70 and 300 ms.

    Examples
    --------
    >>> [round(100.0 * capillary_length(t), 3) for t in (0.07, 0.3)]
    [0.21, 0.554]
    """
    omega = _angular_frequency(correlation_time)
    return float((ARTICLE_SURFACE_TENSION / (SEA_WATER_DENSITY * omega**2)) ** (1.0 / 3.0))
