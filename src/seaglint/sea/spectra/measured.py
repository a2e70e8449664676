"""Measured directional spectra as a wave buoy reports them, converted to wavenumber spectra.

A buoy gives, per frequency band, the energy density and two Fourier moments of the directional distribution. The distribution used is the
one of maximum entropy with exactly these moments, positive everywhere; the slope variances along and across the wind depend on the second
moment alone. Spectra given on directions are in :mod:`seaglint.sea.spectra.binned`. Above the last band with energy the spectrum
continues as ``f^-5`` (``S ~ k^-3``), the saturated range of Phillips 1958, with the mean level and the mean directions of the last bands
that have energy.

References
----------
Lygre and Krogstad 1986, J. Phys. Oceanogr. 16, 2052 (maximum entropy, Eqs. 11-14); Longuet-Higgins, Cartwright and Smith 1963 (moments);
NDBC, "Nondirectional and directional wave data analysis procedures", Technical Document 96-01; Phillips 1958, J. Fluid Mech. 4, 426.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError
from seaglint.sea.dispersion import angular_frequency, group_velocity, wavenumber
from seaglint.sea.spectra.directional import GRAVITY_WAVES_END, DirectionalSpectrum

ComplexArray = NDArray[np.complex128]

TAIL_BANDS: Final = 5  # the last band alone is one or two units of the last printed digit
_SHARPEST: Final = 0.95  # of the largest second moment compatible with the first: a distribution at the limit is a pair of spikes


@dataclass(frozen=True, eq=False)
class MeasuredSpectrum(DirectionalSpectrum):
    """Directional spectrum from energy and two circular moments per frequency.

    ``S(k) = E(f) df/dk`` with ``E`` linear between the frequencies and ``df/dk`` the group velocity over 2 pi;
    ``D`` of maximum entropy from the moments, interpolated over wavenumber.

    Raises
    ------
    DataError
        Values that are missing, negative or impossible; no energy at all.
    """

    frequency_hz: FloatArray  #: Ascending frequencies [Hz, (m,)].
    energy: FloatArray  #: Height variance per hertz, E(f) [m² Hz⁻¹, (m,)].
    first: ComplexArray  #: ``int D exp(i phi) dphi``, phi the azimuth waves travel TO [1, (m,)].
    second: ComplexArray  #: ``int D exp(2 i phi) dphi`` [1, (m,)].
    wind_to_azimuth: float = 0.0  #: Azimuth the wind blows TO [rad]; used only to distinguish upwind from crosswind.

    def __post_init__(self) -> None:
        """Refuse columns that are not a valid spectrum."""
        columns = (self.frequency_hz, self.energy, self.first, self.second)
        if len({c.shape for c in columns}) != 1 or self.frequency_hz.ndim != 1 or self.frequency_hz.size < 3:
            raise DataError("a measured spectrum needs frequency, energy and two moments of the same length, at least 3 bands")
        if not all(np.all(np.isfinite(c)) for c in columns):
            raise DataError("measured spectrum has missing or NaN values; fill or drop that record")
        if self.frequency_hz[0] <= 0.0 or np.any(np.diff(self.frequency_hz) <= 0.0):
            raise DataError("frequencies of a measured spectrum must be above 0 Hz and ascending")
        if np.any(self.energy < 0.0) or not np.any(self.energy > 0.0):
            raise DataError("energy of a measured spectrum must not be negative, nor zero everywhere; for a calm sea use the flat spectrum")
        room = 1.0 - np.abs(self.first) ** 2
        if np.any(room <= 0.0) or np.any(np.abs(self.second - self.first**2) >= room):
            raise DataError("directional moments that no distribution has; pass them through possible_moments first")

    @cached_property
    def _k(self) -> FloatArray:
        """Wavenumbers of the measured frequencies [rad m⁻¹]."""
        return wavenumber(2.0 * np.pi * self.frequency_hz)

    @cached_property
    def _tail(self) -> _Tail:
        used = np.flatnonzero(self.energy > 0.0)[-TAIL_BANDS:]
        saturation = self.energy[used] * _frequency_per_wavenumber(self._k[used]) * self._k[used] ** 3
        return _Tail(
            float(self._k[used[-1]]), float(saturation.mean()), complex(self.first[used].mean()), complex(self.second[used].mean())
        )

    @property
    def peak_wavenumber(self) -> float:
        """Wavenumber of the frequency band with the highest density [rad m⁻¹]."""
        return float(self._k[int(np.argmax(self.energy))])

    @property
    def tail_wavenumber(self) -> float:
        """Wavenumber above which the spectrum is extrapolated [rad m⁻¹]."""
        return self._tail.start

    @property
    def wavenumber_range(self) -> tuple[float, float]:
        """Range from the first frequency to 370 rad/m, where surface tension dominates [rad m⁻¹]."""
        return float(self._k[0]), GRAVITY_WAVES_END

    def breakpoints(self) -> FloatArray:
        """The measured frequencies as wavenumbers [rad/m]: energy is linear between them."""
        return self._k

    def omnidirectional(self, wavenumber: ArrayLike) -> FloatArray:
        """Omnidirectional spectrum: ``E(f) df/dk`` up to the last band with energy, above it ``level k^-3`` [m³]."""
        k = np.asarray(wavenumber, dtype=np.float64)
        low, high = self.wavenumber_range
        safe = np.clip(k, low, high)
        frequency = angular_frequency(safe) / (2.0 * np.pi)
        measured = np.interp(frequency, self.frequency_hz, self.energy) * _frequency_per_wavenumber(safe)
        value = np.where(safe < self._tail.start, measured, self._tail.level * safe**-3)
        return np.asarray(np.where((k >= low) & (k <= high), value, 0.0))

    def _moments(self, wavenumber: ArrayLike) -> tuple[ComplexArray, ComplexArray]:
        """Circular moments at any wavenumber, interpolated; mixtures of possible moments are possible."""
        k = np.asarray(wavenumber, dtype=np.float64)
        measured = k < self._tail.start
        first = np.where(measured, np.interp(k, self._k, self.first), self._tail.first)
        second = np.where(measured, np.interp(k, self._k, self.second), self._tail.second)
        return first, second

    def spreading(self, wavenumber: ArrayLike, azimuth: ArrayLike) -> FloatArray:
        """Maximum-entropy distribution of the two moments [rad⁻¹] (Lygre and Krogstad 1986, Eqs. 13-14)."""
        first, second = self._moments(wavenumber)
        turn = np.exp(-1j * np.asarray(azimuth, dtype=np.float64))
        # coefficients of an autoregressive model with these two moments, phi_1 and phi_2 of the reference
        a = (first - second * np.conj(first)) / (1.0 - np.abs(first) ** 2)
        b = second - first * a
        level = (1.0 - a * np.conj(first) - b * np.conj(second)).real
        return np.asarray(level / np.abs(1.0 - a * turn - b * turn**2) ** 2 / (2.0 * np.pi))

    def second_harmonic(self, wavenumber: ArrayLike) -> FloatArray:
        """Second moment along the wind [1]."""
        return np.asarray((self._moments(wavenumber)[1] * np.exp(-2j * self.wind_to_azimuth)).real)

    def cross_harmonic(self, wavenumber: ArrayLike) -> FloatArray:
        """Second moment to the right of the wind [1]."""
        return np.asarray((self._moments(wavenumber)[1] * np.exp(-2j * self.wind_to_azimuth)).imag)


class _Tail(NamedTuple):
    """Tail above the measured bands: ``S = level k^-3`` from ``start`` on."""

    start: float
    level: float
    first: complex
    second: complex


def _frequency_per_wavenumber(k: FloatArray) -> FloatArray:
    """Jacobian df/dk [Hz m rad⁻¹]."""
    return np.asarray(group_velocity(k) / (2.0 * np.pi))


def possible_moments(first: ComplexArray, second: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
    """Return the nearest moments that a distribution of finite width can have.

    A distribution needs ``|c1| < 1`` and ``|c2 - c1^2| < 1 - |c1|^2``; sampling noise of a buoy can lie outside. Moments beyond 95 % of
    these limits are moved to 95 %.
    """
    size = np.abs(first)
    # moments keep their direction; only their size is reduced
    first = first * np.minimum(1.0, 0.99 / np.maximum(size, 0.99))
    room = _SHARPEST * (1.0 - np.abs(first) ** 2)
    offset = second - first**2
    return first, first**2 + offset * np.minimum(1.0, room / np.maximum(np.abs(offset), room))
