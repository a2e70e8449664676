"""Wind waves under winds too light for a model: its sea at the lightest wind that it allows, with less energy."""

from __future__ import annotations

from dataclasses import dataclass

from numpy.typing import ArrayLike

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError
from seaglint.sea.spectra.directional import DirectionalSpectrum


@dataclass(frozen=True)
class CalmSpectrum(DirectionalSpectrum):
    """Spectrum of a model with a share of its energy, ``S(k) = share S_0(k)``; lengths and spreading stay.

    Light winds have no spectrum of their own in the models, which begin at 0.5 m/s; there the significant height is 6 mm. From there to no
    wind and no waves its energy, and so its slope variance, falls in proportion to the wind, as the measured slope variances of Cox and
    Munk (1954, J. Opt. Soc. Am. 44, 838) do. Below 0.5 m/s this is an interpolation, not a measurement.

    Examples
    --------
    >>> from seaglint.sea.spectra.elfouhaily import ElfouhailySpectrum
    >>> lightest = ElfouhailySpectrum(0.5)
    >>> round(CalmSpectrum(lightest, 0.25).height_variance() / lightest.height_variance(), 6)
    0.25
    """

    lightest: DirectionalSpectrum  #: The model's sea at the lightest wind that it allows.
    share: float  #: Share of the energy, 0-1 [1].

    def __post_init__(self) -> None:
        """Refuse shares that are none."""
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
