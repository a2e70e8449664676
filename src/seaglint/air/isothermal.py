"""Isothermal air in a closed cavity of equal temperature: the white furnace, an exact test scene."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from seaglint.air.protocol import ClearAir, require_line, slant_range, wavenumber_grid
from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError
from seaglint.optics.blackbody import planck_wavenumber


@dataclass(frozen=True)
class IsothermalAtmosphere(ClearAir):
    """Grey air of one temperature under a sky of the same temperature, and no Sun.

    ``tau = exp(-k s)``, ``L_path = (1 - tau) B(T)``, ``L_sky = B(T)``. A sea at the same temperature is then invisible:
    every direction shows ``B(T)``.

    Parameters
    ----------
    temperature : float
        Temperature of air and sky [K].
    wavenumber_cm : array
        Ascending spectral samples [cm-1, (n,)].
    extinction_per_m : float
        Extinction coefficient of the air [m-1].
    """

    temperature: float
    wavenumber_cm: FloatArray
    extinction_per_m: float = 1e-4

    def __post_init__(self) -> None:
        if not (self.temperature > 0.0 and np.isfinite(self.temperature)):
            raise DomainError(
                f"temperature = {self.temperature:g} K is not above 0 K; give the air temperature in kelvin",
                name="temperature",
                value=self.temperature,
                allowed="above 0 K",
            )
        if not (self.extinction_per_m >= 0.0 and np.isfinite(self.extinction_per_m)):
            raise DomainError(
                f"extinction_per_m = {self.extinction_per_m:g} is not a finite number >= 0 per metre",
                name="extinction_per_m",
                value=self.extinction_per_m,
                allowed="0 per metre or more, finite",
            )

    @classmethod
    def for_band(cls, temperature: float, min_um: float, max_um: float, extinction_per_m: float = 1e-4) -> IsothermalAtmosphere:
        """Isothermal air on the 5 cm-1 grid that covers a band [um]."""
        return cls(temperature, wavenumber_grid(min_um, max_um), extinction_per_m)

    def _blackbody(self, shape: tuple[int, ...]) -> FloatArray:
        spectrum = planck_wavenumber(self.wavenumber_cm, self.temperature)
        return np.broadcast_to(spectrum, (*shape, self.wavenumber_cm.size)).copy()

    @property
    def provenance(self) -> Mapping[str, Any]:
        """Name of the class, in place of a table."""
        return {"table": type(self).__name__}

    def transmittance(self, height: float, range_m: ArrayLike, target_height: ArrayLike = 0.0) -> FloatArray:
        """Transmittance ``exp(-k s)`` over the straight path of length ``s`` [1, (..., n)]."""
        optical_depth = self.extinction_per_m * slant_range(height, *require_line(height, range_m, target_height))
        grey = np.exp(-optical_depth)[..., np.newaxis]
        return np.broadcast_to(grey, (*optical_depth.shape, self.wavenumber_cm.size)).copy()

    def path_radiance(self, height: float, range_m: ArrayLike, target_height: ArrayLike = 0.0) -> FloatArray:
        """Path radiance ``(1 - tau) B(T)`` [W m-2 sr-1 per cm-1, (..., n)]."""
        return np.asarray(
            (1.0 - self.transmittance(height, range_m, target_height)) * planck_wavenumber(self.wavenumber_cm, self.temperature)
        )

    def solar_irradiance(self, solar_zenith: ArrayLike) -> FloatArray:
        """Solar irradiance in a closed cavity: zero [W m-2 per cm-1, (..., n)]."""
        return np.zeros((*np.shape(solar_zenith), self.wavenumber_cm.size))

    def sky_radiance(self, zenith: ArrayLike, azimuth: ArrayLike, height: float = 0.0) -> FloatArray:
        """Sky radiance ``B(T)``, equal in all directions [W m-2 sr-1 per cm-1, (..., n)]."""
        return self._blackbody(np.broadcast_shapes(np.shape(zenith), np.shape(azimuth)))
