"""Bound waves of a sea: the sum and difference waves of second order, which sharpen crests and flatten troughs.

**Pairs of waves.** To second order in steepness, on deep water, waves ``a_i cos psi_i`` have beside them

::

    zeta_2 = sum_ij a_i a_j [S_ij cos(psi_i + psi_j) + D_ij cos(psi_i - psi_j)]                 (all ordered pairs)
    S = (k_i + k_j + r (1 - c) + 2 B+/r)/4,     D = (k_i + k_j - r (1 + c) + 2 B-/r)/4,     r = sqrt(k_i k_j)
    B+- = (sqrt k_i +- sqrt k_j)^2 k_i k_j (c -+ 1)/[(sqrt k_i +- sqrt k_j)^2 - |k_i +- k_j|]

with c the cosine of the angle between them (Longuet-Higgins 1963, Eqs. 3.7-3.9). For one direction ``S = (k_i + k_j)/4`` and
``D = -|k_i - k_j|/4``; one wave has Stokes's ``k a^2/2 cos 2 psi``. The third moment of the heights is

::

    <zeta^3> = 3 int int 2 (S + D) Psi(k_i) Psi(k_j) dk_i dk_j

**On a lattice** a sum over pairs is a product of fields if the weights are products. B are not. Here

::

    S = [c |K| + b_s k_i k_j (1 - c^2)/|K|]/4,     D = [-c |K| + b_d k_i k_j (1 - c^2)/|K|]/4,     K = k_i +- k_j

which is exact for equal and opposite directions, and Creamer's and others' transform of 1989 (at its lowest order) with ``b_s = b_d = 1``.
That transform exceeds the third moment of the pairs by 1 % at a spreading of 10 deg, 9 % at 30 deg, 16 % at 45 deg and 19 % at 60 deg, as
it disregards the frequencies of the pairs. ``b_s`` and ``b_d`` below are fitted to the third moments of sum and difference waves each:
within 1.4 % up to 30 deg (JONSWAP; Pierson and Moskowitz and Elfouhaily: 1 %), 3.3 % at 45 deg and 6 % at 60 deg. With the unit vectors n
of the waves the sums are products of the two fields ``sum n a exp(i psi)``.

**Waves that have them.** The expansion is about the mean level and diverges for short waves that long ones displace by more than their
own length over 2 pi. So only energetic waves are included (``bound_limit``).

References
----------
M. S. Longuet-Higgins, The effect of non-linearities on statistical distributions in the theory of sea waves, J. Fluid Mech. 17,
459-480, 1963; D. B. Creamer, F. Henyey, R. Schult and J. Wright, Improved linear representation of ocean surface waves, J. Fluid Mech.
205, 135-161, 1989.
"""

from __future__ import annotations

from typing import Final

import numpy as np
import scipy.fft
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import brentq

from seaglint.base.conventions import FloatArray
from seaglint.sea.spectra.directional import DirectionalSpectrum

ComplexArray = NDArray[np.complex64]

#: Weights of the oblique part of sum and difference waves, fitted to third moments for spreadings of 10 to 45 deg.
OBLIQUE: Final = (-0.35, 1.40)

#: Share of the height variance in waves too short to have bound waves.
#:
#: 3 % leaves out a tenth of the third moment of a fully developed sea, 5 % of JONSWAP's; 1 % would need a lattice of twice the points.
UNBOUND_SHARE: Final = 0.03

#: Largest product of a wave's wavenumber and the standard deviation of the heights [1].
#:
#: At 0.5 the bound waves of the shortest waves have a fourth of the slope variance of these; at 1 all of it.
DISPLACED: Final = 0.5

_STEPS: Final = 96  # wavenumbers of the integrals of third moments: 0.3 % of them
_ANGLES: Final = 120


def bound_limit(spectrum: DirectionalSpectrum) -> float:
    """Wavenumber up to which waves have bound waves [rad m⁻¹].

    Above it lies ``UNBOUND_SHARE`` of the height variance, or its product with the standard deviation of the heights exceeds ``DISPLACED``,
    whichever is less.

    Examples
    --------
    >>> from seaglint.sea.spectra import PiersonMoskowitzSpectrum
    >>> sea = PiersonMoskowitzSpectrum(10.0)
    >>> round(bound_limit(sea) / sea.peak_wavenumber, 1)
    6.4
    """
    low, high = spectrum.wavenumber_range
    variance = spectrum.height_variance()
    energy = (1.0 - UNBOUND_SHARE) * variance
    share = float(np.exp(brentq(lambda x: spectrum.height_variance(float(np.exp(x))) - energy, np.log(low), np.log(high), xtol=1e-6)))
    return min(share, DISPLACED / float(np.sqrt(variance)))


def pair_weights(first: ArrayLike, second: ArrayLike, cosine: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Weights ``S`` and ``D`` of the sum and the difference wave of two waves [rad m⁻¹].

    Parameters
    ----------
    first, second : array_like
        Wavenumbers [rad m⁻¹], above 0.
    cosine : array_like
        Cosine of the angle between the waves [1].

    Returns
    -------
    tuple of ndarray
        For ordered pairs: two different waves have twice these amplitudes.

    Examples
    --------
    >>> [round(float(w), 9) for w in pair_weights(3.0, 1.0, 1.0)]
    [1.0, -0.5]
    """
    a, b, c = np.broadcast_arrays(np.asarray(first, np.float64), np.asarray(second, np.float64), np.asarray(cosine, np.float64))
    root = np.sqrt(a * b)
    plus, minus = (np.sqrt(a) + np.sqrt(b)) ** 2, (np.sqrt(a) - np.sqrt(b)) ** 2
    cross = 2.0 * a * b * c
    # along one direction the sum wave's B is 0 over a positive number; equal waves have no difference wave, 0 over 0
    up = plus * a * b * (c - 1.0) / (plus - np.sqrt(np.maximum(a * a + b * b + cross, 0.0)))
    below = minus - np.sqrt(np.maximum(a * a + b * b - cross, 0.0))
    down = np.where(below < 0.0, minus * a * b * (c + 1.0) / np.where(below < 0.0, below, -1.0), 0.0)
    total = a + b
    return (
        np.asarray(0.25 * (total + root * (1.0 - c) + 2.0 * up / root)),
        np.asarray(0.25 * (total - root * (1.0 + c) + 2.0 * down / root)),
    )


def lattice_weights(first: ArrayLike, second: ArrayLike, cosine: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Weights that lattices use instead of ``pair_weights`` [rad m⁻¹], with the same arguments."""
    a, b, c = np.broadcast_arrays(np.asarray(first, np.float64), np.asarray(second, np.float64), np.asarray(cosine, np.float64))
    oblique = a * b * (1.0 - c * c)
    out = []
    for sign, weight in zip((1.0, -1.0), OBLIQUE, strict=True):
        size = np.sqrt(np.maximum(a * a + b * b + 2.0 * sign * a * b * c, 0.0))
        # the oblique part of equal waves tends to 0 with the angle
        out.append(np.asarray(0.25 * (sign * c * size + weight * oblique / np.maximum(size, 1e-9 * (a + b)))))
    return out[0], out[1]


def bound_skewness(spectrum: DirectionalSpectrum, k_max: float = np.inf, *, exact: bool = True) -> float:
    """Skewness that bound waves give to the heights of a sea [1].

    ``3 int int 2 (S + D) Psi Psi dk dk' / (int Psi dk)^(3/2)``, the upper integrals over waves up to ``k_max``, the lower one over all.

    Parameters
    ----------
    spectrum : DirectionalSpectrum
        The sea.
    k_max : float
        Largest wavenumber of waves that have bound waves [rad m⁻¹].
    exact : bool
        Use ``pair_weights``, or ``lattice_weights``.

    Notes
    -----
    Midpoints of 96 wavenumbers of equal ratio and 120 angles: 0.5 % of the skewness.

    Examples
    --------
    >>> from seaglint.sea.spectra import JonswapSpectrum
    >>> storm = JonswapSpectrum(7.0, 11.0, 0.0, 3.3, np.radians(30.0))
    >>> round(bound_skewness(storm), 2)
    0.16
    """
    low, high = spectrum.wavenumber_range
    # waves beyond 60 times the peak's wavenumber add less than 1e-4 of the third moment
    high = min(high, k_max, 60.0 * spectrum.peak_wavenumber)
    if high <= low:
        return 0.0
    ratio = np.log(high / low)
    k = low * np.exp((np.arange(_STEPS) + 0.5) / _STEPS * ratio)
    energy = spectrum.omnidirectional(k) * k * ratio / _STEPS
    angle = 2.0 * np.pi * np.arange(_ANGLES) / _ANGLES
    share = spectrum.spreading(k[:, None], angle)
    # directions narrower than the steps of the angle keep their energy
    share /= share.sum(axis=1, keepdims=True)
    turned = np.fft.fft(share, axis=1)
    weights = pair_weights if exact else lattice_weights
    total = 0.0
    for i in range(_STEPS):
        # share of pairs by the angle between their waves
        pairs = np.fft.ifft(np.conj(turned[i]) * turned, axis=1).real
        total += float(energy[i]) * float(np.sum(energy[:, None] * pairs * np.add(*weights(k[i], k[:, None], np.cos(angle)))))
    return 6.0 * total / float(spectrum.height_variance() ** 1.5)


def bound_coefficients(forward: ComplexArray, backward: ComplexArray, step: float, workers: int = 1) -> ComplexArray:
    """Fourier coefficients of the bound waves of a lattice's waves at one instant.

    Parameters
    ----------
    forward, backward : ndarray
        Half amplitudes with their phases, ``a_k exp(-i omega t)/2`` of the waves along k and along -k [m, (2 m + 1, m + 1)]: rows are
        lattice numbers 0 to m and -m to -1, columns 0 to m. The column 0 of ``forward`` has all waves along it.
    step : float
        Spacing of lattice wavenumbers [rad m⁻¹].
    workers : int
        Threads of the transforms; the bytes do not depend on them.

    Returns
    -------
    ndarray
        Coefficients of the height ``zeta_2`` [m, (4 m + 1, 2 m + 1)], in the same order; the mean level has none.
    """
    top = forward.shape[1] - 1
    # sums reach 2 m: with 4 m + 1 points no product is mistaken for another
    n = scipy.fft.next_fast_len(4 * top + 1)
    q, p = np.concatenate([np.arange(top + 1), np.arange(-top, 0)])[:, None], np.arange(top + 1)
    whole = np.zeros((2, n, n), np.complex64)
    unit = np.divide(np.stack(np.broadcast_arrays(p, q)), np.maximum(np.hypot(p, q), 1.0)).astype(np.float32)
    for field, along in zip(whole, unit, strict=True):
        # amplitudes a, not their halves
        field[q, p] = 2.0 * along * forward
        # the column 0 of forward has these waves already
        field[-q, -p[1:]] = -2.0 * along[:, 1:] * backward[:, 1:]
    x, y = scipy.fft.ifft2(whole, norm="forward", overwrite_x=True, workers=workers)
    sums, differences = OBLIQUE
    # real parts of n_i n_j of sum and difference pairs; a filter that is even and real may follow the real part
    a, b, c, d = x.real, x.imag, y.real, y.imag
    xx, xx_, yy, yy_ = a * a, b * b, c * c, d * d
    # (a + i b)^2 and |a + i b|^2 differ in the sign of b^2 alone
    more, less = sums - differences, sums + differences
    twice = more * (xx - yy) - less * (xx_ - yy_)
    cross = more * (a * c) - less * (b * d)
    level = -0.5 * more * (xx + yy) - (2.0 - 0.5 * less) * (xx_ + yy_)
    spectra = scipy.fft.rfft2(0.25 * np.stack([level, 0.5 * twice, cross]), norm="forward", workers=workers)
    rows = np.concatenate([np.arange(2 * top + 1), np.arange(-2 * top, 0)])
    level, twice, cross = spectra[:, rows, : 2 * top + 1]
    v, u = rows[:, None].astype(np.float32), np.arange(2 * top + 1, dtype=np.float32)
    size = np.hypot(u, v)
    safe = np.maximum(size, np.float32(1.0))
    return np.asarray(step * (size * level + ((u * u - v * v) * twice + 2.0 * u * v * cross) / safe), np.complex64)
