"""Records of heights at one place, linear and to second order, from the pairs of their waves.

A record of the duration T has one wave for each multiple of 1/T, with a Gaussian amplitude and a direction drawn from the spreading, and
for every pair of them the sum and the difference wave with the weights of Longuet-Higgins 1963, as Forristall 2000 simulates crests. No
lattice is involved: the records check the bound waves of ``seaglint.sea.wave_field.WaveField``.

A buoy moves with the water. To second order its height is

::

    zeta_1 + zeta_2 + xi . grad zeta_1,     xi = Re sum i n a exp(-i omega t)

with the orbital displacement xi, n the unit vectors of the waves. For one wave the product replaces Stokes's harmonic by a higher mean
level. Under groups of waves this level follows the group: with it the heights of a moving point are as skewed as at a place fixed in space
(Srokosz and Longuet-Higgins 1986). A buoy that integrates its acceleration has a lowest frequency, records no such level, and its heights
are hardly skewed.

References
----------
M. S. Longuet-Higgins 1963 (see ``seaglint.sea.second_order``); G. Z. Forristall, Wave crest distributions: observations and
second-order theory, J. Phys. Oceanogr. 30, 1931-1943, 2000; M. A. Srokosz and M. S. Longuet-Higgins, On the skewness of sea-surface
elevation, J. Fluid Mech. 164, 487-497, 1986.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError
from seaglint.base.random import stream
from seaglint.sea.dispersion import group_velocity, wavenumber
from seaglint.sea.second_order import pair_weights
from seaglint.sea.spectra.directional import DirectionalSpectrum

_AZIMUTHS = 720


@dataclass(frozen=True, eq=False)
class WaveRecord:
    """Heights at one place [m, (n,)]."""

    linear: FloatArray  #: Free waves alone.
    second_order: FloatArray  #: With bound waves.
    moving: FloatArray  #: With bound waves, of a point that moves with the water.
    buoy: FloatArray  #: Heights of the moving point without those below a lowest frequency.

    @classmethod
    def draw(
        cls, spectrum: DirectionalSpectrum, seed: int, samples: int, interval: float, *, hertz: tuple[float, float], bound: float
    ) -> WaveRecord:
        """Draw a record from ``stream(seed, "wave record")``.

        Parameters
        ----------
        spectrum : DirectionalSpectrum
            The sea.
        seed : int
            Of amplitudes and directions.
        samples : int
            Number of heights.
        interval : float
            Time between them [s].
        hertz : (float, float)
            Lowest frequency of a buoy, and highest frequency of the free waves [Hz].
        bound : float
            Wavenumber up to which waves have bound waves [rad m⁻¹].

        Raises
        ------
        DomainError
            A record too short for a wave, or frequencies beyond half the sampling rate.
        """
        duration = samples * interval
        lowest_hz, highest_hz = hertz
        if not 2.0 / duration < highest_hz <= 0.5 / interval:
            raise DomainError(
                f"highest frequency = {highest_hz:g} Hz of a record of {samples} heights every {interval:g} s; give "
                f"{2.0 / duration:.3g} to {0.5 / interval:.3g} Hz",
                name="hertz",
                value=highest_hz,
                allowed=(2.0 / duration, 0.5 / interval),
            )
        number = np.arange(1, int(highest_hz * duration) + 1)
        omega = 2.0 * np.pi * number / duration
        k = wavenumber(omega)
        variance = spectrum.omnidirectional(k) / group_velocity(k) * 2.0 * np.pi / duration
        rng = stream(seed, "wave record")
        a = np.sqrt(variance) * (rng.standard_normal(k.size) + 1j * rng.standard_normal(k.size))
        azimuth = _directions(spectrum, k, rng.random(k.size))
        # twice the points, so that sums of frequencies are not mistaken for lower ones before the record is sampled
        places = 2 * samples
        free = _heights(number, a, places)
        paired = (k < bound) & (variance > 0.0)
        number, a, k, azimuth = number[paired], a[paired], k[paired], azimuth[paired]
        second = _heights(np.arange(2 * samples), _bound(number, a, k, azimuth, 2 * samples), places)
        slopes = [_heights(number, 1j * k * along * a, places) for along in (np.sin(azimuth), np.cos(azimuth))]
        moves = [_heights(number, 1j * along * a, places) for along in (np.sin(azimuth), np.cos(azimuth))]
        moved = moves[0] * slopes[0] + moves[1] * slopes[1]
        both = free + second
        moving = both + moved
        slow = np.fft.rfft(moving)
        slow[np.arange(slow.size) >= lowest_hz * duration] = 0.0
        return cls(free[::2], both[::2], moving[::2], (moving - np.fft.irfft(slow, places))[::2])


def _directions(spectrum: DirectionalSpectrum, k: FloatArray, share: FloatArray) -> FloatArray:
    """Azimuths below which lie shares of the spreading [rad, (waves,)]."""
    azimuth = 2.0 * np.pi * (np.arange(_AZIMUTHS) + 0.5) / _AZIMUTHS
    below = np.cumsum(spectrum.spreading(k[:, None], azimuth), axis=1)
    place = np.sum(below < share[:, None] * below[:, -1:], axis=1)
    return np.asarray(azimuth[np.minimum(place, _AZIMUTHS - 1)])


def _bound(number: NDArray[np.int64], a: NDArray[np.complex128], k: FloatArray, azimuth: FloatArray, size: int) -> NDArray[np.complex128]:
    """Amplitudes of sum and difference waves by number of frequency [m, (size,)]."""
    out = np.zeros(size, np.complex128)
    for i in range(number.size):
        rest = slice(i, None)
        plus, minus = pair_weights(k[i], k[rest], np.cos(azimuth[i] - azimuth[rest]))
        # ordered pairs count twice, a wave with itself once
        twice = np.full(plus.size, 2.0)
        twice[0] = 1.0
        # numbers are distinct within a sum over the second wave
        out[number[i] + number[rest]] += twice * plus * a[i] * a[rest]
        out[number[rest] - number[i]] += twice * minus * a[rest] * np.conj(a[i])
    out[0] = 0.0
    return out


def _heights(number: NDArray[np.int64], a: NDArray[np.complex128], places: int) -> FloatArray:
    """Sum ``Re a exp(-i omega t)`` of waves at equal times of their common period [(places,)]."""
    half = np.zeros(places + 1, np.complex128)
    half[number] = 0.5 * np.conj(a)
    return np.asarray(np.fft.irfft(half, 2 * places, norm="forward")[::2])
