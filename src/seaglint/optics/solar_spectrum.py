"""Spectrum of the Sun outside the atmosphere."""

from __future__ import annotations

from functools import lru_cache
from importlib import resources

import numpy as np
from numpy.typing import ArrayLike

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError

_SOLAR_FILE = "solar_lowtran7.npz"


@lru_cache(maxsize=1)
def _solar_table() -> tuple[FloatArray, FloatArray]:
    with resources.files("seaglint.optics").joinpath("data", _SOLAR_FILE).open("rb") as stream, np.load(stream) as file:
        return file["wavenumber_cm"], file["irradiance"]


def exoatmospheric_irradiance(wavenumber_cm: ArrayLike) -> FloatArray:
    """Spectral irradiance of the Sun at 1 au outside the atmosphere [W m-2 per cm-1, shape of ``wavenumber_cm``].

    Linear interpolation of the spectrum that LOWTRAN7 carries (its function SUN and block data SOLAR), sampled every
    5 cm-1 from 680 to 14290 cm-1 (0.70-14.7 um).

    Raises
    ------
    DomainError
        For a wavenumber outside that range.

    References
    ----------
    Kneizys, F. X., et al. (1988), Users Guide to LOWTRAN 7, AFGL-TR-88-0177.

    Examples
    --------
    >>> round(float(exoatmospheric_irradiance(2500.0)), 6)
    0.0152
    """
    requested = np.asarray(wavenumber_cm, dtype=np.float64)
    known, irradiance = _solar_table()
    outside = ~((requested >= known[0]) & (requested <= known[-1]))
    if outside.any():
        raise DomainError(
            f"wavenumber {requested[outside].ravel()[0]:g} cm-1 is outside {known[0]:g}-{known[-1]:g} cm-1 of the solar spectrum; "
            "choose a band within 0.70-14.7 um",
            name="wavenumber_cm",
            value=float(requested[outside].ravel()[0]),
            allowed=(float(known[0]), float(known[-1])),
        )
    return np.asarray(np.interp(requested, known, irradiance))
