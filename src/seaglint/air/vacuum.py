"""Vacuum: the sea under a black sky and the Sun outside the atmosphere."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from importlib import resources
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from seaglint.air.protocol import ClearAir, require_line, wavenumber_grid
from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError

_SOLAR_FILE = "solar_lowtran7.npz"


@lru_cache(maxsize=1)
def _solar_table() -> tuple[FloatArray, FloatArray]:
    with resources.files("seaglint.air").joinpath("data", _SOLAR_FILE).open("rb") as stream, np.load(stream) as file:
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


@dataclass(frozen=True)
class VacuumAtmosphere(ClearAir):
    """Atmosphere without absorption and emission: a black sky and the full Sun at 1 au.

    Parameters
    ----------
    wavenumber_cm : array
        Ascending spectral samples [cm-1, (n,)].
    """

    wavenumber_cm: FloatArray

    @classmethod
    def for_band(cls, min_um: float, max_um: float) -> VacuumAtmosphere:
        """Vacuum on the 5 cm-1 grid that covers a band [um]."""
        return cls(wavenumber_grid(min_um, max_um))

    @property
    def provenance(self) -> Mapping[str, Any]:
        """Name of the class, in place of a table."""
        return {"table": type(self).__name__}

    def transmittance(self, height: float, range_m: ArrayLike, target_height: ArrayLike = 0.0) -> FloatArray:
        """Transmittance: one everywhere [1, (..., n)]."""
        return np.ones((*require_line(height, range_m, target_height)[0].shape, self.wavenumber_cm.size))

    def path_radiance(self, height: float, range_m: ArrayLike, target_height: ArrayLike = 0.0) -> FloatArray:
        """Path radiance: zero [W m-2 sr-1 per cm-1, (..., n)]."""
        return np.zeros((*require_line(height, range_m, target_height)[0].shape, self.wavenumber_cm.size))

    def solar_irradiance(self, solar_zenith: ArrayLike) -> FloatArray:
        """Exoatmospheric spectrum for a Sun above the horizon, zero below it [W m-2 per cm-1, (..., n)]."""
        zenith = np.asarray(solar_zenith, dtype=np.float64)
        up = (zenith <= 0.5 * np.pi)[..., np.newaxis]
        return np.asarray(np.where(up, exoatmospheric_irradiance(self.wavenumber_cm), 0.0))

    def sky_radiance(self, zenith: ArrayLike, azimuth: ArrayLike, height: float = 0.0) -> FloatArray:
        """Sky radiance: zero [W m-2 sr-1 per cm-1, (..., n)]."""
        return np.zeros((*np.broadcast_shapes(np.shape(zenith), np.shape(azimuth)), self.wavenumber_cm.size))
