r"""Covariance of the slopes of short waves at two places and two times, along and across the wind.

With the slope variances ``V_u(k)`` and ``V_c(k)`` of bands of wavenumber, and waves that travel downwind,

.. math:: R(\mathbf{r}, t) = \int \mathbf{k k}^T \Psi(\mathbf{k}) \cos(\mathbf{k \cdot r} - \omega t)\, d^2k, \qquad
    D(\varphi) = \frac{1 + 2 a_2 \cos 2\varphi}{\pi}, \quad |\varphi| < \frac{\pi}{2}, \quad a_2 = \frac{V_u - V_c}{V_u + V_c}

At one time only the even part of D matters, and the integral over directions is a sum of Bessel functions of ``z = k r``:

.. math::
    R_{uu} &= \tfrac12 V [(1 + a_2) J_0 - (1 + 2 a_2) J_2 \cos 2\varphi + a_2 J_4 \cos 4\varphi] \\
    R_{cc} &= \tfrac12 V [(1 - a_2) J_0 + (1 - 2 a_2) J_2 \cos 2\varphi - a_2 J_4 \cos 4\varphi] \\
    R_{uc} &= \tfrac12 V [- J_2 \sin 2\varphi + a_2 J_4 \sin 4\varphi]

A band has a width: the mean over it is the value at its middle times ``exp[-(z d)^2/24]``, d its width in the logarithm of k, so that bands
as wide as a tenth of an octave suffice.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import Final

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import jv

from seaglint.base.conventions import FloatArray
from seaglint.base.jit import njit
from seaglint.sea.dispersion import angular_frequency
from seaglint.sea.slopes.slope_statistics import SHORTEST, SlopeStatistics
from seaglint.sea.spectra.directional import DirectionalSpectrum

PER_DECADE: Final = 24  #: Number of bands per decade of wavenumber.

DIRECTIONS: Final = 24  #: Number of directions of the waves of a band at two times; its width removes what they would alias.

FAINT: Final = 1e-4  #: Damping of a band by its width below which it is omitted.

SPAN: Final = 30.0  #: Least ratio of the ends of the bands of slopes that no spectrum accounts for.


@dataclass(frozen=True, eq=False)
class ShortWaves:
    """Slope variances of waves in bands of wavenumber, about one axis."""

    wavenumber: FloatArray  #: Middles of the bands, ascending [rad m⁻¹, (n,)].
    up: FloatArray  #: Slope variance of each band along the axis [1, (n,)].
    cross: FloatArray  #: Slope variance of each band across the axis [1, (n,)].
    width: float  #: Width of a band in the logarithm of the wavenumber [1].
    to_azimuth: float  #: Azimuth of the axis, towards which the waves travel [rad].

    @property
    def variances(self) -> tuple[float, float]:
        """Slope variance of all bands along and across the axis [1]."""
        return float(self.up.sum()), float(self.cross.sum())

    @property
    def frequency(self) -> FloatArray:
        """Angular frequency of each band [rad s⁻¹, (n,)]."""
        return angular_frequency(self.wavenumber)

    @property
    def second_moment(self) -> FloatArray:
        """Second moment ``a_2`` of the directions of each band [1, (n,)]; 0 for a band without waves."""
        total = self.up + self.cross
        return np.divide(self.up - self.cross, total, out=np.zeros(total.shape), where=total > 0.0)

    def scaled(self, up: float, cross: float) -> ShortWaves:
        """Return the bands with other variances of their sum along and across the axis [1], in the same proportions."""
        own = self.variances
        parts = zip((self.up, self.cross), (up, cross), own, strict=True)
        along, across = (bands * (new / old) if old > 0.0 else bands for bands, new, old in parts)
        return ShortWaves(self.wavenumber, along, across, self.width, self.to_azimuth)

    @classmethod
    def of_spectrum(cls, spectrum: DirectionalSpectrum, k_min: float, k_max: float = math.inf) -> ShortWaves:
        """Return the waves of a spectrum with ``k_min <= k < k_max`` [rad m⁻¹], about the principal axis of their slopes."""
        low, high = max(k_min, spectrum.wavenumber_range[0]), min(k_max, spectrum.wavenumber_range[1])
        edges = np.geomspace(low, high, max(math.ceil(PER_DECADE * math.log10(high / low)), 1) + 1)
        parts = np.array([[*spectrum.mss(b, a), spectrum.slope_covariance(b, a)] for a, b in pairwise(edges)])
        along, across, both = parts.sum(axis=0)
        turn = 0.5 * math.atan2(2.0 * both, along - across) if both != 0.0 else 0.0
        c, s = math.cos(turn), math.sin(turn)
        up = parts[:, 0] * c * c + 2.0 * parts[:, 2] * c * s + parts[:, 1] * s * s
        cross = parts[:, 0] * s * s - 2.0 * parts[:, 2] * c * s + parts[:, 1] * c * c
        return cls(np.sqrt(edges[1:] * edges[:-1]), up, cross, math.log(edges[1] / edges[0]), spectrum.wind_to_azimuth + turn)

    @classmethod
    def of_slopes(cls, slopes: SlopeStatistics, k_min: float) -> ShortWaves:
        """Return bands with the growth of a slope law beyond a wavenumber [rad m⁻¹]; even over its logarithm where the law has none."""
        grown = slopes.growth()
        low = max(k_min, float(grown[0, 0]))
        top = max(float(grown[-1, 0]), SPAN * low, SHORTEST)
        edges = np.geomspace(low, top, math.ceil(PER_DECADE * math.log10(top / low)) + 1)
        at = [np.interp(np.log(edges), np.log(grown[:, 0]), grown[:, i]) for i in (1, 2)]
        up, cross = np.maximum(np.diff(at[0]), 0.0), np.maximum(np.diff(at[1]), 0.0)
        if up.sum() <= 0.0 or cross.sum() <= 0.0:
            up, cross = np.full(edges.size - 1, 1.0), np.full(edges.size - 1, 1.0)
        return cls(np.sqrt(edges[1:] * edges[:-1]), up, cross, math.log(edges[1] / edges[0]), slopes.wind_to_azimuth)

    def covariance(self, distance: ArrayLike, direction: ArrayLike) -> FloatArray:
        """Covariance of the slopes at two places at one time.

        Parameters
        ----------
        distance : array_like
            Distance of the places [m].
        direction : array_like
            Direction from one to the other, from the axis of the waves [rad], broadcast.

        Returns
        -------
        ndarray
            Along, mixed and across [1, (..., 3)].
        """
        r, angle = np.broadcast_arrays(np.asarray(distance, np.float64), np.asarray(direction, np.float64))
        # each distance once: the Bessel functions are the work
        lags, inverse = np.unique(r, return_inverse=True)
        z = lags[:, None] * self.wavenumber
        half = 0.5 * (self.up + self.cross) * np.exp(-((z * self.width) ** 2) / 24.0)
        a2 = self.second_moment
        j0, j2, j4 = (half * jv(n, z) for n in (0, 2, 4))
        sums = [np.sum(part, axis=1)[inverse].reshape(r.shape) for part in (j0, a2 * j0, j2, a2 * j2, j4 * a2)]
        even, even_a, two, two_a, four = sums
        c2, c4, s2, s4 = np.cos(2.0 * angle), np.cos(4.0 * angle), np.sin(2.0 * angle), np.sin(4.0 * angle)
        along = even + even_a - (two + 2.0 * two_a) * c2 + four * c4
        across = even - even_a + (two - 2.0 * two_a) * c2 - four * c4
        return np.stack([along, -two * s2 + four * s4, across], axis=-1)

    def moving_covariance(self, distance: FloatArray, direction: FloatArray, time: FloatArray) -> FloatArray:
        """Covariance of the slopes at two places and two times, of waves that travel towards the axis.

        Parameters
        ----------
        distance, direction, time : ndarray
            Distances [m, (m,)], directions from the axis of the waves [rad, (p,)] and times [s, (q,)].

        Returns
        -------
        ndarray
            Along, mixed and across [1, (p, m, q, 3)].
        """
        out = np.empty((direction.size, distance.size, time.size, 3))
        _moving(self.wavenumber, self.up + self.cross, self.second_moment, self.frequency, self.width, distance, direction, time, out)
        return out

    def mean_covariance(self, box: tuple[float, float], turn: float, time: FloatArray) -> FloatArray:
        """Covariance of the slopes averaged over a box at two times.

        Parameters
        ----------
        box : tuple of float
            Length and width [m].
        turn : float
            Direction of its length from the axis of the waves [rad].
        time : ndarray
            Times between both means [s, (q,)].

        Returns
        -------
        ndarray
            Along, mixed and across [1, (q, 3)].
        """
        angle = math.pi * ((np.arange(4 * DIRECTIONS) + 0.5) / (4 * DIRECTIONS) - 0.5)
        c, s, k = np.cos(angle)[:, None], np.sin(angle)[:, None], self.wavenumber
        share = np.sinc(k * np.cos(angle - turn)[:, None] * box[0] / (2.0 * np.pi)) ** 2
        share = share * np.sinc(k * np.sin(angle - turn)[:, None] * box[1] / (2.0 * np.pi)) ** 2
        energy = share * (self.up + self.cross) * (1.0 + 2.0 * self.second_moment * (c * c - s * s)) / angle.size
        parts = np.stack([np.sum(energy * weight, axis=0) for weight in (c * c, c * s, s * s)], axis=-1)
        q = self.frequency * np.asarray(time, np.float64)[:, None]
        # the frequency of a band varies by half of its width and more: as in space, the mean over it
        moved = np.cos(q) * np.exp(-((0.5 * q * self.width) ** 2) / 24.0)
        return np.asarray(moved @ parts)


@njit
def _moving(
    k: FloatArray,
    total: FloatArray,
    a2: FloatArray,
    frequency: FloatArray,
    width: float,
    distance: FloatArray,
    direction: FloatArray,
    time: FloatArray,
    out: FloatArray,
) -> None:
    """Fill ``out`` (directions, distances, times, 3) with the covariances of slopes, as a sum over directions of the waves."""
    angle = math.pi * ((np.arange(DIRECTIONS) + 0.5) / DIRECTIONS - 0.5)
    cosines, sines = np.cos(angle), np.sin(angle)
    for p in range(direction.size):
        towards, aside = math.cos(direction[p]), math.sin(direction[p])
        for m in range(distance.size):
            for q in range(time.size):
                along, mixed, across = 0.0, 0.0, 0.0
                for i in range(k.size):
                    z, turn = k[i] * distance[m], frequency[i] * time[q]
                    damping = math.exp(-((z * width) ** 2 + (0.5 * turn * width) ** 2) / 24.0)
                    if damping < FAINT or total[i] <= 0.0:
                        continue
                    for j in range(DIRECTIONS):
                        c, s = cosines[j], sines[j]
                        wave = (1.0 + 2.0 * a2[i] * (c * c - s * s)) * math.cos(z * (c * towards + s * aside) - turn)
                        wave *= damping * total[i] / DIRECTIONS
                        along += wave * c * c
                        mixed += wave * c * s
                        across += wave * s * s
                out[p, m, q, 0], out[p, m, q, 1], out[p, m, q, 2] = along, mixed, across
