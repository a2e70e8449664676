"""Air that emits no light: what the Moon adds to a picture of the day is the light that it sends through such air."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from seaglint.air.protocol import Atmosphere, ClearAir
from seaglint.base.conventions import FloatArray


@dataclass(frozen=True, eq=False)
class UnlitAtmosphere(ClearAir):
    """Atmosphere that transmits as another one does, and neither emits nor scatters light."""

    air: Atmosphere  #: Air with the same transmittance and sunlight.

    @property
    def wavenumber_cm(self) -> FloatArray:
        """Ascending spectral samples [cm-1, (n,)]."""
        return self.air.wavenumber_cm

    @property
    def provenance(self) -> Mapping[str, Any]:
        """Sources of the spectra."""
        return self.air.provenance

    def transmittance(self, height: float, range_m: ArrayLike, target_height: ArrayLike = 0.0) -> FloatArray:
        """Transmittance of the path from a point to the sensor [1, (..., n)]."""
        return self.air.transmittance(height, range_m, target_height)

    def path_radiance(self, height: float, range_m: ArrayLike, target_height: ArrayLike = 0.0) -> FloatArray:
        """Path radiance: zero [W m-2 sr-1 per cm-1, (..., n)]."""
        return np.zeros((*np.broadcast_shapes(np.shape(range_m), np.shape(target_height)), self.wavenumber_cm.size))

    def solar_irradiance(self, solar_zenith: ArrayLike) -> FloatArray:
        """Direct sunlight at the sea, Sun at 1 au [W m-2 per cm-1, (..., n)]."""
        return self.air.solar_irradiance(solar_zenith)

    def sunlight_at(self, height: float, solar_zenith: float) -> FloatArray | None:
        """Direct sunlight at a height [W m-2 per cm-1, (n,)]; None if it is known at the sea only."""
        return self.air.sunlight_at(height, solar_zenith)

    def sky_radiance(self, zenith: ArrayLike, azimuth: ArrayLike, height: float = 0.0) -> FloatArray:
        """Sky radiance: zero [W m-2 sr-1 per cm-1, (..., n)]."""
        return np.zeros((*np.broadcast_shapes(np.shape(zenith), np.shape(azimuth)), self.wavenumber_cm.size))
