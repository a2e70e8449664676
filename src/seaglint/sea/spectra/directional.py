"""Interface of a directional wave spectrum, the integrals that follow from it, and spreading by a power of the cosine.

    Psi(k_east, k_north) = S(k)/k D(k, phi),     int S dk = <zeta^2>,     int D dphi = 1

``phi`` is the azimuth a wave travels TO, so opposite wave vectors are different waves and a spectrum with all its energy downwind moves
downwind. For real surfaces at one instant only ``Psi(k) + Psi(-k)`` matters.

The cosine to a power (Longuet-Higgins, Cartwright and Smith 1963) spreads energy over directions as

    D = Gamma(s + 1)/[2 sqrt(pi) Gamma(s + 1/2)] cos^2s((phi - phi_0)/2)

Its width is the circular one, ``sigma = sqrt(2 (1 - |c1|))`` with the first moment ``|c1| = s/(s + 1)`` (Kuik, van Vledder and
Holthuijsen 1988, Eq. 33), as buoys and wave models report it.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import Final

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import gammaln

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError

#: Wavenumber at which spectra of gravity waves end [rad/m], 1.7 cm: beyond it surface tension dominates, and the slope variance of ``k^-3``
#: would grow without limit.
GRAVITY_WAVES_END: Final = 370.0

_PANELS_PER_DECADE: Final = 16
_ORDER: Final = 8  # smooth spectra are integrated to 1e-9, tabulated ones exactly to their break points
_GAUSS_X, _GAUSS_W = np.polynomial.legendre.leggauss(_ORDER)

#: Circular widths for which the cosine is used [rad]: sqrt(2) rad (81 degrees) is a sea without direction.
WIDTHS: Final = (float(np.radians(1.0)), float(np.radians(80.0)))


class DirectionalSpectrum(ABC):
    """Interface of a directional spectrum; subclasses are frozen dataclasses.

    A subclass gives :meth:`omnidirectional`, :meth:`spreading` and :meth:`second_harmonic` (their integral, known in closed form),
    its peak, its range and the wind.
    """

    wind_to_azimuth: float

    @property
    @abstractmethod
    def peak_wavenumber(self) -> float:
        """Wavenumber of the spectral peak [rad m⁻¹]."""

    @property
    @abstractmethod
    def wavenumber_range(self) -> tuple[float, float]:
        """Range of wavenumbers that has energy [rad m⁻¹]; the spectrum is zero outside."""

    @abstractmethod
    def omnidirectional(self, wavenumber: ArrayLike) -> FloatArray:
        """Height variance per wavenumber, S(k) [m³]."""

    @abstractmethod
    def spreading(self, wavenumber: ArrayLike, azimuth: ArrayLike) -> FloatArray:
        """Share of energy per angle travelling TO an azimuth, D(k, phi) [rad⁻¹]; its integral over all azimuths is 1."""

    @abstractmethod
    def second_harmonic(self, wavenumber: ArrayLike) -> FloatArray:
        """Mean of ``cos 2(phi - phi_wind)`` over the spreading [1], ``a2``; ``(1 + a2)/2`` is the upwind share of slope variance."""

    def cross_harmonic(self, wavenumber: ArrayLike) -> FloatArray:
        """Mean of ``sin 2(phi - phi_wind)`` over the spreading [1]; 0 where energy lies evenly on both sides of the wind."""
        return np.zeros(np.shape(np.asarray(wavenumber)))

    def breakpoints(self) -> FloatArray:
        """Wavenumbers where the spectrum is not smooth [rad m⁻¹]."""
        return np.empty(0)

    def density(self, k_east: ArrayLike, k_north: ArrayLike) -> FloatArray:
        """Directional spectrum ``Psi = S(k)/k D(k, phi)`` of waves travelling along (k_east, k_north) [m⁴ rad⁻²]; 0 at k = 0."""
        east, north = np.broadcast_arrays(np.asarray(k_east, dtype=np.float64), np.asarray(k_north, dtype=np.float64))
        k = np.hypot(east, north)
        safe = np.where(k > 0.0, k, 1.0)
        psi = self.omnidirectional(safe) / safe * self.spreading(safe, np.arctan2(east, north))
        return np.asarray(np.where(k > 0.0, psi, 0.0))

    def integrate(self, function: Callable[[FloatArray], FloatArray], k_min: float = 0.0, k_max: float = np.inf) -> float:
        """Integral of ``function(k)`` over the part of [k_min, k_max] that has energy, by Gauss-Legendre panels in log k."""
        require_wavenumbers(k_min, k_max)
        low, high = max(k_min, self.wavenumber_range[0]), min(k_max, self.wavenumber_range[1])
        if low >= high:
            return 0.0
        panels = int(np.ceil(_PANELS_PER_DECADE * np.log10(high / low))) + 1
        # a panel never crosses a kink, so that every one integrates a smooth function
        breaks = self.breakpoints()
        breaks = breaks[(breaks > low) & (breaks < high)]
        edges = np.unique(np.concatenate([np.linspace(np.log(low), np.log(high), panels + 1), np.log(breaks)]))
        half = 0.5 * np.diff(edges)[:, None]
        k = np.exp(edges[:-1, None] + half * (1.0 + _GAUSS_X))
        return float(np.sum(half * _GAUSS_W * k * function(k)))

    def height_variance(self, k_max: float = np.inf, k_min: float = 0.0) -> float:
        """Variance of the height of waves with k_min <= k < k_max, ``int S dk`` [m²]."""
        return self.integrate(self.omnidirectional, k_min, k_max)

    def significant_height(self) -> float:
        """Significant wave height, ``4 sqrt(int S dk)`` [m]."""
        return 4.0 * float(np.sqrt(self.height_variance()))

    def mss(self, k_max: float = np.inf, k_min: float = 0.0) -> tuple[float, float]:
        """Slope variance along and across the wind of waves with k_min <= k < k_max, ``int k^2 S (1 +- a2)/2 dk`` [1]."""

        def total(k: FloatArray) -> FloatArray:
            return np.asarray(k * k * self.omnidirectional(k))

        def difference(k: FloatArray) -> FloatArray:
            return np.asarray(total(k) * self.second_harmonic(k))

        both, split = self.integrate(total, k_min, k_max), self.integrate(difference, k_min, k_max)
        return 0.5 * (both + split), 0.5 * (both - split)

    def slope_covariance(self, k_max: float = np.inf, k_min: float = 0.0) -> float:
        """Covariance of the slopes along the wind and to the right of it, of waves with k_min <= k < k_max, ``int k^2 S b2/2 dk`` [1]."""
        return 0.5 * self.integrate(lambda k: np.asarray(k * k * self.omnidirectional(k) * self.cross_harmonic(k)), k_min, k_max)


def require_wavenumbers(k_min: float, k_max: float) -> None:
    """Refuse ends of a range of wavenumbers [rad/m] that are negative or NaN."""
    if not (k_min >= 0.0 and k_max >= 0.0):
        raise DomainError(
            f"wavenumbers {k_min:g}-{k_max:g} rad/m must not be negative or NaN",
            name="wavenumber",
            value=(k_min, k_max),
            allowed="0 rad/m or more",
        )


def downwind(angle: ArrayLike) -> FloatArray:
    """Weight [1] of the half plane around the wind's direction: 1 inside, 0 behind, 1/2 on its edge (k and -k share that energy)."""
    c = np.cos(np.asarray(angle, dtype=np.float64))
    return np.asarray(np.where(np.abs(c) < 1e-9, 0.5, (c > 0.0).astype(np.float64)))


def power_of_width(width: ArrayLike) -> FloatArray:
    """Power ``s = 2/sigma^2 - 1`` of a circular width [rad]; widths outside ``WIDTHS`` are refused.

    Examples
    --------
    >>> float(power_of_width(np.radians(30.0)).round(2))
    6.3
    """
    sigma = np.asarray(width, dtype=np.float64)
    low, high = WIDTHS
    outside = ~((sigma >= low) & (sigma <= high))
    if np.any(outside):
        value = float(np.degrees(sigma[outside].ravel()[0]))
        raise DomainError(
            f"spreading = {value:g} deg is outside {np.degrees(low):g}-{np.degrees(high):g} deg of the cosine distribution; wind sea has "
            "about 30 deg, swell 10 to 20 deg",
            name="spreading",
            value=value,
            allowed=(float(np.degrees(low)), float(np.degrees(high))),
        )
    return np.asarray(2.0 / sigma**2 - 1.0)


def cosine_power(angle: ArrayLike, s: ArrayLike) -> FloatArray:
    """Distribution ``D`` at an angle from its centre [rad] for a power s [rad⁻¹]."""
    power = np.asarray(s, dtype=np.float64)
    level = np.exp(gammaln(power + 1.0) - gammaln(power + 0.5)) / (2.0 * np.sqrt(np.pi))
    return np.asarray(level * np.abs(np.cos(0.5 * np.asarray(angle, dtype=np.float64))) ** (2.0 * power))


def second_moment(s: float) -> float:
    """Mean of ``cos 2(phi - phi_0)``, ``s (s - 1)/[(s + 1)(s + 2)]`` [1]."""
    return s * (s - 1.0) / ((s + 1.0) * (s + 2.0))
