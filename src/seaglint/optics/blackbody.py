"""Planck's law per wavenumber."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import ArrayLike
from scipy import constants

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError

#: First radiation constant ``2 h c^2`` for wavenumbers in cm-1 [W m-2 sr-1 (cm-1)-4].
FIRST_RADIATION: Final = 2.0e8 * constants.h * constants.c**2

#: Second radiation constant ``h c / k`` for wavenumbers in cm-1 [K (cm-1)-1].
SECOND_RADIATION: Final = 100.0 * constants.h * constants.c / constants.k


def planck_wavenumber(wavenumber_cm: ArrayLike, temperature: ArrayLike) -> FloatArray:
    r"""Spectral radiance of a blackbody.

    .. math:: B = \frac{2 h c^2 \nu^3}{\exp(h c \nu / k T) - 1}

    Parameters
    ----------
    wavenumber_cm : array_like
        Wavenumber [cm-1], positive.
    temperature : array_like
        Temperature [K], positive; broadcast against ``wavenumber_cm``.

    Returns
    -------
    ndarray
        Spectral radiance [W m-2 sr-1 (cm-1)-1].

    Raises
    ------
    DomainError
        A temperature or wavenumber that is not positive.

    Examples
    --------
    >>> round(float(planck_wavenumber(1000.0, 300.0)), 5)
    0.09924
    """
    nu, t = np.asarray(wavenumber_cm, dtype=np.float64), np.asarray(temperature, dtype=np.float64)
    if not np.all(t > 0.0):
        raise DomainError(
            f"temperature = {float(np.min(t)):g} K; a blackbody needs a temperature > 0 K",
            name="temperature",
            value=float(np.min(t)),
            allowed="above 0 K",
        )
    if not np.all(nu > 0.0):
        raise DomainError(
            f"wavenumber = {float(np.min(nu)):g} cm-1; give wavenumbers > 0 cm-1",
            name="wavenumber_cm",
            value=float(np.min(nu)),
            allowed="above 0 cm-1",
        )
    x = SECOND_RADIATION * nu / t
    # exp(-x)/(1 - exp(-x)) instead of 1/(exp(x) - 1): cold bodies at short waves underflow to 0 and never overflow.
    return np.asarray(FIRST_RADIATION * nu**3 * np.exp(-x) / -np.expm1(-x))
