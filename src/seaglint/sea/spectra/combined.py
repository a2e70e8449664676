"""Spectra made from other spectra: a model's sea with less energy in very light winds, and wind sea and swells on one sea."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError
from seaglint.sea.dispersion import group_velocity
from seaglint.sea.spectra.directional import DirectionalSpectrum

#: Lightest wind at 10 m that the models of wind seas allow [m/s]; below it waves have less energy and lose their direction.
LIGHTEST: Final = 0.5


@dataclass(frozen=True)
class CalmSpectrum(DirectionalSpectrum):
    """Spectrum of a model with a share of its energy, ``S(k) = share S_0(k)``; lengths and spreading stay.

    The models begin at 0.5 m/s, where the significant height is 6 mm; lighter winds have no spectrum. From there to no
    wind and no waves the energy, and so its slope variance, falls in proportion to the wind, as the measured slope variances of Cox and
    Munk (1954, J. Opt. Soc. Am. 44, 838) do. Below 0.5 m/s this is an interpolation, not a measurement.

    Examples
    --------
    >>> from seaglint.sea.spectra.elfouhaily import ElfouhailySpectrum
    >>> lightest = ElfouhailySpectrum(0.5)
    >>> calm = CalmSpectrum(lightest, 0.25)
    >>> round(calm.height_variance() / lightest.height_variance(), 6)
    0.25
    """

    lightest: DirectionalSpectrum  #: The model's sea at the lightest wind that it allows.
    share: float  #: Share of the energy, 0-1 [1].

    def __post_init__(self) -> None:
        """Refuse shares outside 0-1."""
        if not 0.0 <= self.share <= 1.0:
            raise DomainError(f"share of the energy = {self.share:g} is not within 0-1", name="share", value=self.share, allowed=(0.0, 1.0))

    @property
    def wind_to_azimuth(self) -> float:  # type: ignore[override]  # an attribute of the other spectra
        """Azimuth the wind blows TO [rad]."""
        return self.lightest.wind_to_azimuth

    @property
    def peak_wavenumber(self) -> float:
        """Wavenumber of the spectral peak [rad m⁻¹]."""
        return self.lightest.peak_wavenumber

    @property
    def wavenumber_range(self) -> tuple[float, float]:
        """Range of wavenumbers that has energy [rad m⁻¹]."""
        return self.lightest.wavenumber_range

    def omnidirectional(self, wavenumber: ArrayLike) -> FloatArray:
        """Height variance per wavenumber [m³]."""
        return self.share * self.lightest.omnidirectional(wavenumber)

    def spreading(self, wavenumber: ArrayLike, azimuth: ArrayLike) -> FloatArray:
        """Share of energy per angle travelling TO an azimuth [rad⁻¹]."""
        return self.lightest.spreading(wavenumber, azimuth)

    def second_harmonic(self, wavenumber: ArrayLike) -> FloatArray:
        """Second harmonic of the spreading [1]."""
        return self.lightest.second_harmonic(wavenumber)

    def cross_harmonic(self, wavenumber: ArrayLike) -> FloatArray:
        """Second harmonic across the wind [1]."""
        return self.lightest.cross_harmonic(wavenumber)

    def breakpoints(self) -> FloatArray:
        """Wavenumbers where the spectrum is not smooth [rad m⁻¹]."""
        return self.lightest.breakpoints()


def wind_sea(model: Callable[[float], DirectionalSpectrum], wind: float) -> DirectionalSpectrum:
    """Sea of a model of the wind sea at a wind above 0 m/s; below the model's lightest wind, that sea with less energy.

    Parameters
    ----------
    model : callable
        Spectrum of a wind of at least ``LIGHTEST``.
    wind : float
        Wind speed [m s⁻¹].

    Returns
    -------
    DirectionalSpectrum
        Energy falls in proportion to the wind, so that the sea becomes flat at 0 m/s.
    """
    return model(wind) if wind >= LIGHTEST else CalmSpectrum(model(LIGHTEST), wind / LIGHTEST)


@dataclass(frozen=True)
class CombinedSpectrum(DirectionalSpectrum):
    """Sum of spectra: ``Psi = sum Psi_i``, so that ``S = sum S_i`` and ``D = sum S_i D_i/S``.

    Systems are independent of each other: variances of height and slopes add.

    Raises
    ------
    DomainError
        No system, or systems with different winds.

    Examples
    --------
    >>> from seaglint.sea.spectra import ElfouhailySpectrum, JonswapSpectrum
    >>> sea = CombinedSpectrum((JonswapSpectrum(2.0, 12.0, 1.0), ElfouhailySpectrum(10.0)))
    >>> wind_sea = ElfouhailySpectrum(10.0).significant_height()
    >>> round(sea.significant_height(), 2), round((2.0**2 + wind_sea**2) ** 0.5, 2)
    (3.31, 3.31)
    """

    systems: tuple[DirectionalSpectrum, ...]  #: One or more, with the same wind.

    def __post_init__(self) -> None:
        """Refuse systems that cannot be added."""
        if not self.systems:
            raise DomainError("a sea of systems needs at least one; give a spectrum, or no waves at all", name="systems", value=())
        if len({system.wind_to_azimuth for system in self.systems}) > 1:
            raise DomainError("systems on one sea have one wind; give all the same wind_to_azimuth", name="wind_to_azimuth")

    @property
    def wind_to_azimuth(self) -> float:  # type: ignore[override]
        """Azimuth the wind blows TO [rad]."""
        return self.systems[0].wind_to_azimuth

    @property
    def peak_wavenumber(self) -> float:
        """Peak wavenumber of the system with the highest peak in the FREQUENCY spectrum of the sum [rad m⁻¹]."""
        peaks = np.array([system.peak_wavenumber for system in self.systems])
        return float(peaks[int(np.argmax(self.omnidirectional(peaks) / group_velocity(peaks)))])

    @property
    def wavenumber_range(self) -> tuple[float, float]:
        """Range from the longest to the shortest waves of all systems [rad m⁻¹]."""
        ranges = [system.wavenumber_range for system in self.systems]
        return min(low for low, _ in ranges), max(high for _, high in ranges)

    def breakpoints(self) -> FloatArray:
        """Break points of all systems, and the ends of their ranges [rad m⁻¹]."""
        parts = [np.concatenate([system.breakpoints(), system.wavenumber_range]) for system in self.systems]
        return np.unique(np.concatenate(parts))

    def omnidirectional(self, wavenumber: ArrayLike) -> FloatArray:
        """Omnidirectional spectrum ``sum S_i`` [m³]."""
        return np.asarray(np.sum([system.omnidirectional(wavenumber) for system in self.systems], axis=0))

    def _mean(self, wavenumber: ArrayLike, of: Callable[[DirectionalSpectrum], FloatArray]) -> FloatArray:
        """Mean of a property of the systems, weighted with their energy; unweighted where there is no energy."""
        energy = np.array([system.omnidirectional(wavenumber) for system in self.systems])
        # equal weights where no system has energy, instead of 0/0
        energy = np.where(energy.sum(axis=0) > 0.0, energy, 1.0)
        values = np.array([of(system) for system in self.systems])
        weights = energy.reshape(energy.shape[:1] + (1,) * (values.ndim - energy.ndim) + energy.shape[1:])
        return np.asarray((weights * values).sum(axis=0) / weights.sum(axis=0))

    def spreading(self, wavenumber: ArrayLike, azimuth: ArrayLike) -> FloatArray:
        """Spreading function ``sum S_i D_i/sum S_i`` [rad⁻¹]."""
        return self._mean(wavenumber, lambda system: system.spreading(wavenumber, azimuth))

    def second_harmonic(self, wavenumber: ArrayLike) -> FloatArray:
        """Second harmonic along the wind, mean over the systems weighted with their energies [1]."""
        return self._mean(wavenumber, lambda system: system.second_harmonic(wavenumber))

    def cross_harmonic(self, wavenumber: ArrayLike) -> FloatArray:
        """Second harmonic across the wind, mean over the systems weighted with their energies [1]."""
        return self._mean(wavenumber, lambda system: system.cross_harmonic(wavenumber))
