r"""Conversion of in-band radiance to photons and electrons.

A detector counts photons; a scene has watts in a band. With the response ``R`` of the band and the detector's quantum efficiency ``eta``, a
blackbody of temperature ``T`` has

.. math:: K(T) = \frac{\int \eta R B \lambda / (h c)\,d\lambda}{\int R B\,d\lambda}

electrons for each joule. :class:`Photons` uses the ``K`` of one reference temperature for the sea and sky, so that the chain is linear;
:meth:`Photons.error` returns the error for other spectra. Known spectra, such as the spectra of objects, are counted by
:meth:`Photons.counted`.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import ArrayLike
from scipy import constants

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError
from seaglint.optics.band import ApparentTemperature, Band
from seaglint.optics.blackbody import planck_wavenumber

#: Temperature of the blackbody with the spectrum that represents the scene [K]: in the middle of seas and skies.
REFERENCE_TEMPERATURE: Final = 300.0

SUN_TEMPERATURE: Final = 5778.0  #: Temperature of the blackbody that represents sunlight in the comparison of conversions [K].

STEP: Final = 1.0  #: Step of the spectral grid [cm-1]: conversions are then exact to 1e-6.


@dataclass(frozen=True, eq=False)
class Photons:
    """Conversion of in-band radiance for one band and one quantum efficiency."""

    band: Band  #: Response over which the radiance is integrated.
    efficiency: Band | None = None  #: Quantum efficiency: one number, or a curve times ``peak``.
    peak: float = 1.0  #: Efficiency where the curve is 1.
    temperature: float = REFERENCE_TEMPERATURE  #: Reference temperature [K].

    def __post_init__(self) -> None:
        if self.efficiency is None:
            return
        low, high = self.efficiency.min_um, self.efficiency.max_um
        if low > self.band.min_um * (1.0 + 1e-9) or high < self.band.max_um * (1.0 - 1e-9):
            raise DomainError(
                f"the quantum efficiency is given from {low:g} to {high:g} um and the scene's band reaches from {self.band.min_um:g} to "
                f"{self.band.max_um:g} um; give it over the whole band (0 where the detector does not respond), or change the band",
                name="quantum_efficiency",
                value=(low, high),
                allowed=(self.band.min_um, self.band.max_um),
            )

    @cached_property
    def wavenumber_cm(self) -> FloatArray:
        """Spectral grid over the band [cm-1, (n,)]."""
        low, high = 1.0e4 / self.band.max_um, 1.0e4 / self.band.min_um
        return np.linspace(low, high, max(int(np.ceil((high - low) / STEP)), 64) + 1)

    @cached_property
    def _efficiency(self) -> FloatArray:
        nu = self.wavenumber_cm
        curve = np.ones(nu.size) if self.efficiency is None else self.efficiency.response_at(nu)
        return self.peak * curve

    @cached_property
    def _weights(self) -> FloatArray:
        return self.band.weights(self.wavenumber_cm)

    @cached_property
    def _electrons(self) -> FloatArray:
        """Electrons per joule at each wavenumber [J-1]."""
        # one over the photon's energy h c nu, with nu in m-1
        return self._efficiency / (100.0 * constants.h * constants.c * self.wavenumber_cm)

    def radiance(self, temperature: ArrayLike) -> FloatArray:
        """Return the in-band radiance of a blackbody [W m-2 sr-1, shape of ``temperature`` in K]."""
        return self._planck(temperature) @ self._weights

    def photon_radiance(self, temperature: ArrayLike) -> FloatArray:
        """Return the electron rate from a blackbody's spectrum in the band [electrons s-1 m-2 sr-1, shape of ``temperature`` in K]."""
        return np.asarray(self._planck(temperature) @ (self._weights * self._electrons))

    def radiance_slope(self, temperature: float) -> float:
        """Return the derivative of :meth:`radiance` [W m-2 sr-1 K-1]."""
        # a central difference: small against curvature, large against rounding
        step = 0.01
        pair = self.radiance([temperature - step, temperature + step])
        return float((pair[1] - pair[0]) / (2.0 * step))

    def per_joule(self, temperature: float) -> float:
        """Return the electrons per joule in the band, ``K(T)`` of the module [J-1]."""
        return float(self.photon_radiance(temperature) / self.radiance(temperature))

    @cached_property
    def electrons_per_joule(self) -> float:
        """Electrons per joule at the reference temperature, which the chain uses [J-1]."""
        return self.per_joule(self.temperature)

    def counted(self, wavenumber_cm: ArrayLike) -> FloatArray:
        """Return electrons per joule at wavenumbers [cm-1] over :attr:`electrons_per_joule` [1, shape of ``wavenumber_cm``].

        The product of a spectrum with this curve, converted by :attr:`electrons_per_joule`, has the exact number of electrons.

        >>> Photons(Band.rectangular(3.0, 5.0)).counted([2000.0, 3000.0]).round(2)
        array([1.12, 0.75])
        """
        nu = np.asarray(wavenumber_cm, np.float64)
        curve = 1.0 if self.efficiency is None else self.efficiency.response_at(nu)
        return np.asarray(self.peak * curve / (100.0 * constants.h * constants.c * nu) / self.electrons_per_joule)

    def error(self, temperature: float) -> float:
        """Return the relative error of the chain's electrons for the spectrum of another blackbody [1]; positive for too many electrons.

        >>> round(100 * Photons(Band.rectangular(3.5, 5.0)).error(280.0), 1)
        -0.6
        """
        return self.electrons_per_joule / self.per_joule(temperature) - 1.0

    @cached_property
    def sunlight_error(self) -> float:
        """Relative error of the chain's electrons for the spectrum of sunlight [1]."""
        return self.error(SUN_TEMPERATURE)

    @cached_property
    def spectrum(self) -> tuple[FloatArray, FloatArray]:
        """Wavelengths [m] and the share of the reference blackbody's electrons at each [1]; shares add to 1."""
        # electrons, not energy: blur follows what the detector counts
        share = self._planck(self.temperature) * self._weights * self._electrons
        return 0.01 / self.wavenumber_cm, share / share.sum()

    @cached_property
    def wavelength(self) -> float:
        """Mean wavelength of the reference blackbody's electrons [m]."""
        wavelength, share = self.spectrum
        return float(wavelength @ share)

    @cached_property
    def _inverse(self) -> ApparentTemperature:
        return ApparentTemperature.create(self.band, self.wavenumber_cm)

    def apparent_temperature(self, radiance: ArrayLike) -> FloatArray:
        """Return the apparent temperature of in-band radiances [K]; NaN outside 100-6500 K."""
        return self._inverse(radiance)

    def _planck(self, temperature: ArrayLike) -> FloatArray:
        return planck_wavenumber(self.wavenumber_cm, np.asarray(temperature, np.float64)[..., None])
