"""Unified directional spectrum of wind-driven waves, from swell peak to capillaries (Elfouhaily et al. 1997).

Elfouhaily, Chapron, Katsaros and Vandemark, "A unified directional spectrum for long and short wind-driven waves",
J. Geophys. Res. 102 (C7), 15781 (1997).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from seaglint.base.constants import GRAVITY
from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError
from seaglint.base.limits import ELFOUHAILY_WIND
from seaglint.sea.spectra.directional import DirectionalSpectrum, downwind
from seaglint.sea.wind_profile import FULLY_DEVELOPED, friction_velocity, require_wind

VALID_WIND: Final = ELFOUHAILY_WIND  #: Winds at 10 m for which the model is evaluated [m/s]; the data behind it are of 2-24 m/s.

#: Allowed inverse wave ages [1], from fully developed to very young seas (the paper's own limits are 0.84 and 5).
VALID_INVERSE_WAVE_AGE: Final = (0.83, 5.0)

_K_M: Final = 370.0  # gravity-capillary peak [rad/m]
_C_M: Final = 0.23  # slowest phase speed [m/s]


def inverse_wave_age_of_fetch(u10: float, fetch: float) -> float:
    """Inverse wave age after a fetch [m], ``Omega_c = 0.84 tanh[(X/2.2e4)^0.4]^-0.75``, ``X = g fetch/U10^2`` (Eq. 37)."""
    require_wind(u10, VALID_WIND, model="the Elfouhaily spectrum")
    if not fetch > 0.0:
        raise DomainError(
            f"fetch = {fetch:g} m must be above 0 m; leave it out for a fully developed sea", name="fetch", value=fetch, allowed="above 0 m"
        )
    return float(FULLY_DEVELOPED * np.tanh((GRAVITY * fetch / u10**2 / 2.2e4) ** 0.4) ** -0.75)


@dataclass(frozen=True)
class ElfouhailySpectrum(DirectionalSpectrum):
    """Spectrum of Elfouhaily et al. 1997, with all waves travelling downwind.

    ``S(k) = k^-3 (B_l + B_h)``, ``D = [1 + Delta cos 2 phi]/pi`` for ``|phi| < pi/2``: the paper's form, symmetric under k to -k,
    with the upwind half folded on the downwind one, which leaves height, slopes and all even moments as they were.
    The side effects ``L_PM J_p`` multiply ``B_h`` too (public codes differ), so that short waves do not reach below the peak.

    Raises
    ------
    DomainError
        Wind or wave age outside the model.

    Examples
    --------
    >>> sea = ElfouhailySpectrum(10.0)
    >>> round(sea.significant_height(), 2), round(sum(sea.mss()), 4)
    (2.64, 0.0624)
    """

    u10: float  #: Neutral wind speed at 10 m [m s⁻¹], 0.5-30.
    wind_to_azimuth: float = 0.0  #: Azimuth the wind blows TO [rad].
    inverse_wave_age: float = FULLY_DEVELOPED  #: ``U10/c_p``; 0.84 is a fully developed sea. See :func:`inverse_wave_age_of_fetch`.

    def __post_init__(self) -> None:
        """Refuse winds and wave ages outside the model."""
        require_wind(self.u10, VALID_WIND, model="the Elfouhaily spectrum", advice='use spectrum "flat" for a calm sea')
        low, high = VALID_INVERSE_WAVE_AGE
        if not low <= self.inverse_wave_age <= high:
            raise DomainError(
                f"inverse wave age = {self.inverse_wave_age:g} is outside {low:g}-{high:g} of the Elfouhaily spectrum; "
                "0.84 is a fully developed sea, give a longer fetch for a lower value",
                name="inverse_wave_age",
                value=self.inverse_wave_age,
                allowed=VALID_INVERSE_WAVE_AGE,
            )
        if not np.isfinite(self.wind_to_azimuth):
            raise DomainError(
                "the azimuth of the wind must be finite", name="wind_to_azimuth", value=self.wind_to_azimuth, allowed="finite"
            )

    @property
    def peak_wavenumber(self) -> float:
        """Peak wavenumber ``k_p = (g/U10^2) Omega_c^2`` [rad m⁻¹]."""
        return float(GRAVITY / self.u10**2 * self.inverse_wave_age**2)

    @property
    def wavenumber_range(self) -> tuple[float, float]:
        """Range from a sixth of the peak (a factor exp(-45)) to 1e4 rad/m (a factor exp(-169)) [rad m⁻¹]."""
        return self.peak_wavenumber / 6.0, 1.0e4

    @property
    def friction_velocity(self) -> float:
        """Friction velocity of the air [m s⁻¹]."""
        return friction_velocity(self.u10, self.inverse_wave_age)

    def omnidirectional(self, wavenumber: ArrayLike) -> FloatArray:
        """Omnidirectional spectrum ``S(k) = k^-3 (B_l + B_h)`` [m³] (Eq. 30, its parts Eqs. 31, 32, 40, 41)."""
        k = np.asarray(wavenumber, dtype=np.float64)
        low, high = self.wavenumber_range
        inside = (k >= low) & (k <= high)
        # outside the range any valid number serves: the result is set to 0 below
        k = np.where(inside, k, self.peak_wavenumber)
        oc, kp, speed = self.inverse_wave_age, self.peak_wavenumber, _phase_speed(k)
        root = np.sqrt(k / kp)
        sigma = 0.08 * (1.0 + 4.0 * oc**-3)
        gamma = 1.7 if oc < 1.0 else 1.7 + 6.0 * np.log10(oc)
        side = np.exp(-1.25 * (kp / k) ** 2) * gamma ** np.exp(-((root - 1.0) ** 2) / (2.0 * sigma**2))
        long = 0.5 * 0.006 * np.sqrt(oc) * (self.u10 / oc) / speed * np.exp(-oc / np.sqrt(10.0) * (root - 1.0))
        short = 0.5 * self._short_wave_level() * _C_M / speed * np.exp(-0.25 * (k / _K_M - 1.0) ** 2)
        return np.asarray(np.where(inside, side * (long + short) / k**3, 0.0))

    def _short_wave_level(self) -> float:
        """Equilibrium parameter of short waves, alpha_m [1] (Eq. 44)."""
        # the law is negative in the lightest winds, where short waves vanish
        ratio = self.friction_velocity / _C_M
        return max(0.01 * (1.0 + (1.0 if ratio < 1.0 else 3.0) * float(np.log(ratio))), 0.0)

    def _asymmetry(self, wavenumber: FloatArray) -> FloatArray:
        """Upwind-crosswind ratio Delta(k) [1] (Eq. 57)."""
        speed = _phase_speed(wavenumber)
        peak_speed = self.u10 / self.inverse_wave_age
        short = 0.13 * self.friction_velocity / _C_M
        return np.asarray(np.tanh(0.25 * np.log(2.0) + 4.0 * (speed / peak_speed) ** 2.5 + short * (_C_M / speed) ** 2.5))

    def spreading(self, wavenumber: ArrayLike, azimuth: ArrayLike) -> FloatArray:
        """Spreading function ``D = [1 + Delta cos 2 phi]/pi`` on the downwind half plane [rad⁻¹] (Eq. 49, folded)."""
        angle = np.asarray(azimuth, dtype=np.float64) - self.wind_to_azimuth
        delta = self._asymmetry(np.asarray(wavenumber, dtype=np.float64))
        return np.asarray(downwind(angle) * (1.0 + delta * np.cos(2.0 * angle)) / np.pi)

    def second_harmonic(self, wavenumber: ArrayLike) -> FloatArray:
        """Second harmonic of the spreading, ``Delta/2`` [1]."""
        return np.asarray(0.5 * self._asymmetry(np.asarray(wavenumber, dtype=np.float64)))


def _phase_speed(wavenumber: FloatArray) -> FloatArray:
    """Phase speed with the paper's own k_m [m/s]; within 1 % of :mod:`seaglint.sea.dispersion`."""
    return np.asarray(np.sqrt(GRAVITY / wavenumber * (1.0 + (wavenumber / _K_M) ** 2)))
