"""Vacuum: the sea under a black sky and the Sun outside the atmosphere."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from seaglint.air.protocol import ClearAir, require_line, wavenumber_grid
from seaglint.base.conventions import FloatArray
from seaglint.optics.solar_spectrum import exoatmospheric_irradiance


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
