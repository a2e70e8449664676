"""Fully developed wind sea (Pierson and Moskowitz 1964), spread over the downwind half plane by the square of the cosine."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from seaglint.base.constants import GRAVITY
from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError
from seaglint.sea.spectra.directional import GRAVITY_WAVES_END, DirectionalSpectrum, downwind
from seaglint.sea.wind_profile import require_wind, wind_at_height

VALID_WIND: Final = (0.5, 34.0)  #: Winds at 19.5 m for which the model is evaluated [m/s]; the data behind it are of 10-20 m/s.

WIND_HEIGHT: Final = 19.5  #: Height of the weather ships' anemometers behind the fit [m].

_ALPHA: Final = 8.10e-3
_BETA: Final = 0.74


@dataclass(frozen=True)
class PiersonMoskowitzSpectrum(DirectionalSpectrum):
    """Pierson-Moskowitz spectrum in wavenumber.

    ``S(k) = alpha/(2 k^3) exp[-beta (g/(k U19.5^2))^2]``, ``D = (2/pi) cos^2 phi`` for ``|phi| < pi/2``

    This is ``alpha g^2 omega^-5 exp[-beta (g/(omega U))^4]`` with the gravity dispersion ``omega^2 = g k``.

    Notes
    -----
    Cut at 370 rad/m (1.7 cm), where surface tension takes over.

    References
    ----------
    Pierson and Moskowitz 1964, J. Geophys. Res. 69, 5181, Eq. 15; cosine-squared spreading as recommended by the ISSC (1964) and used
    by the ITTC.

    Examples
    --------
    >>> round(PiersonMoskowitzSpectrum(10.0).significant_height(), 2)
    2.13
    """

    u19_5: float  #: Wind speed at 19.5 m [m s⁻¹].
    wind_to_azimuth: float = 0.0  #: Azimuth the wind blows TO [rad].

    def __post_init__(self) -> None:
        """Refuse winds outside the model."""
        require_wind(self.u19_5, VALID_WIND, model="the Pierson-Moskowitz spectrum", advice='use spectrum "flat" for a calm sea')
        if not np.isfinite(self.wind_to_azimuth):
            raise DomainError(
                "the azimuth of the wind must be finite", name="wind_to_azimuth", value=self.wind_to_azimuth, allowed="finite"
            )

    @classmethod
    def of_u10(cls, u10: float, wind_to_azimuth: float = 0.0) -> PiersonMoskowitzSpectrum:
        """Spectrum for the neutral wind at 10 m [m s⁻¹], converted to 19.5 m by the logarithmic law."""
        return cls(wind_at_height(u10, WIND_HEIGHT), wind_to_azimuth)

    @property
    def _cutoff(self) -> float:
        """Wavenumber ``g/U^2 sqrt(beta)`` of the low-frequency cutoff [rad m⁻¹]."""
        return float(GRAVITY / self.u19_5**2 * np.sqrt(_BETA))

    @property
    def peak_wavenumber(self) -> float:
        """Wavenumber of the FREQUENCY spectrum's peak, ``omega_p = (4 beta/5)^(1/4) g/U`` [rad m⁻¹]."""
        return float(np.sqrt(0.8) * self._cutoff)

    @property
    def wavenumber_range(self) -> tuple[float, float]:
        """Range from a sixth of the peak (a factor exp(-45)) to 370 rad/m [rad m⁻¹]."""
        return self.peak_wavenumber / 6.0, GRAVITY_WAVES_END

    def omnidirectional(self, wavenumber: ArrayLike) -> FloatArray:
        """Omnidirectional spectrum ``S(k) = alpha/(2 k^3) exp[-beta (g/(k U^2))^2]`` [m³]."""
        k = np.asarray(wavenumber, dtype=np.float64)
        low, high = self.wavenumber_range
        inside = (k >= low) & (k <= high)
        k = np.where(inside, k, self.peak_wavenumber)
        return np.asarray(np.where(inside, 0.5 * _ALPHA * k**-3 * np.exp(-((self._cutoff / k) ** 2)), 0.0))

    def spreading(self, wavenumber: ArrayLike, azimuth: ArrayLike) -> FloatArray:
        """Spreading function ``D = (2/pi) cos^2 phi`` on the downwind half plane [rad⁻¹]."""
        angle = np.asarray(azimuth, dtype=np.float64) - self.wind_to_azimuth
        share = downwind(angle) * 2.0 / np.pi * np.cos(angle) ** 2
        return np.asarray(np.broadcast_arrays(share, np.asarray(wavenumber, dtype=np.float64))[0])

    def second_harmonic(self, wavenumber: ArrayLike) -> FloatArray:
        """Second harmonic of the spreading: one half at every wavenumber [1]."""
        return np.full(np.shape(np.asarray(wavenumber)), 0.5)
