"""Spectra given on frequencies and directions, as wave models write them or spread by a cosine about a stated direction.

Two seas that cross within one frequency stay two, which two moments would blur. Between directions the density is a monotone cubic, never
negative, sampled finely: linear interpolation between bins of 15 degrees would widen a wind sea's directions by 1.8 %, the cubic by
0.2 %. Every band conserves its energy. Frequencies, tail and wavenumbers are as in a measured spectrum.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import PchipInterpolator

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError
from seaglint.sea.spectra.directional import cosine_power, power_of_width
from seaglint.sea.spectra.measured import TAIL_BANDS, MeasuredSpectrum

_UNEVEN: Final = 0.02  # share by which steps of direction may differ: files round to 0.1 deg
_FINE: Final = float(np.radians(2.5))  # largest step of direction that is drawn as a straight line
_COSINE_BINS: Final = 360  # the sharpest cosine taken is one degree wide at half a percent of the energy


@dataclass(frozen=True, eq=False)
class BinnedSpectrum(MeasuredSpectrum):
    """Measured spectrum with a directional distribution for each frequency; make it with ``of_bins`` or ``of_cosine``."""

    #: Azimuths waves travel TO, ascending over one turn or a sector with nothing at its ends [rad, (n,)].
    azimuth: FloatArray = field(default_factory=lambda: np.empty(0))
    #: ``D`` at these azimuths per frequency [rad⁻¹, (m, n)]; linear in between.
    share: FloatArray = field(default_factory=lambda: np.empty((0, 0)))

    def spreading(self, wavenumber: ArrayLike, azimuth: ArrayLike) -> FloatArray:
        """Directional distribution [rad⁻¹], linear in direction and wavenumber; beyond the measured range the distribution of the tail."""
        k, angle = np.broadcast_arrays(np.asarray(wavenumber, dtype=np.float64), np.asarray(azimuth, dtype=np.float64))
        rows = self._k.size
        lower = np.clip(np.searchsorted(self._k, k, side="right") - 1, 0, rows - 2)
        step = np.clip((k - self._k[lower]) / (self._k[lower + 1] - self._k[lower]), 0.0, 1.0)
        # the last row is the tail's distribution
        shares = np.vstack([self.share, self._tail_share()])
        tail = k >= self.tail_wavenumber
        low, high = np.where(tail, rows, lower), np.where(tail, rows, lower + 1)
        left, right, along = self._place(angle)
        values = [shares[row, left] + along * (shares[row, right] - shares[row, left]) for row in (low, high)]
        return np.asarray(values[0] + step * (values[1] - values[0]))

    def _tail_share(self) -> FloatArray:
        """Mean distribution of the last bands with energy, whose moments the tail also has [rad⁻¹, (n,)]."""
        return np.asarray(self.share[np.flatnonzero(self.energy > 0.0)[-TAIL_BANDS:]].mean(axis=0))

    def _place(self, angle: FloatArray) -> tuple[NDArray[np.intp], NDArray[np.intp], FloatArray]:
        """Indices of the directions on both sides of an angle, and the fraction from the first to the second [1]."""
        turn = 2.0 * np.pi
        angle = self.azimuth[0] + (angle - self.azimuth[0]) % turn
        left = np.searchsorted(self.azimuth, angle, side="right") - 1
        right = (left + 1) % self.azimuth.size
        width = (self.azimuth[right] - self.azimuth[left]) % turn
        return left, right, np.asarray((angle - self.azimuth[left]) / width)


def of_bins(frequency_hz: FloatArray, azimuth: FloatArray, density: FloatArray, wind_to_azimuth: float = 0.0) -> BinnedSpectrum:
    """Spectrum from densities over frequency and direction.

    Parameters
    ----------
    frequency_hz : ndarray
        Ascending frequencies [Hz, (m,)].
    azimuth : ndarray
        Evenly spaced azimuths waves travel TO, in any order, over the whole turn or a sector of it [rad, (n,)].
    density : ndarray
        Height variance per hertz and radian [m² Hz⁻¹ rad⁻¹, (m, n)]; a sector has no energy outside.
    wind_to_azimuth : float
        Azimuth the wind blows TO [rad].

    Returns
    -------
    BinnedSpectrum
        With ``E(f)`` the sum over the directions times their step.

    Raises
    ------
    DataError
        Directions that are uneven or occur twice, values that are missing or negative.
    """
    azimuth, step = _sorted_directions(azimuth)
    order = np.argsort(azimuth)
    values = np.asarray(density, dtype=np.float64)[:, order]
    if not np.all(np.isfinite(values)) or np.any(values < 0.0):
        raise DataError("densities over frequency and direction must be finite and not negative; fill or drop that record")
    azimuth = azimuth[order]
    if azimuth.size * step < 2.0 * np.pi - 0.5 * step:
        azimuth, values = _with_empty_ends(azimuth, values, step)
    energy = values.sum(axis=1) * step
    azimuth, values, fine = _refined(azimuth, values, step)
    share = _filled(values, values.sum(axis=1) * fine)
    # Moments of the broken line, not of spikes at its corners: a triangle of half width step has sinc^2 of them.
    first, second = (np.sinc(n * fine / (2.0 * np.pi)) ** 2 * fine * (share @ np.exp(1j * n * azimuth)) for n in (1, 2))
    return BinnedSpectrum(np.asarray(frequency_hz, dtype=np.float64), energy, first, second, wind_to_azimuth, azimuth, share)


def of_cosine(
    frequency_hz: FloatArray, energy: FloatArray, to_azimuth: ArrayLike, width: ArrayLike, wind_to_azimuth: float = 0.0
) -> BinnedSpectrum:
    """Spectrum from energy, mean direction and width per frequency, spread by a power of the cosine.

    Parameters
    ----------
    frequency_hz, energy : ndarray
        Ascending frequencies [Hz, (m,)] and height variance per hertz [m² Hz⁻¹, (m,)].
    to_azimuth, width : array_like
        Azimuth the waves travel TO and circular width of their directions [rad, (m,) or one for all].
    wind_to_azimuth : float
        Azimuth the wind blows TO [rad].

    Returns
    -------
    BinnedSpectrum

    Raises
    ------
    DomainError
        Widths outside ``seaglint.sea.spectra.directional.WIDTHS``.
    DataError
        Values that are missing or negative.
    """
    azimuth = np.asarray(np.arange(_COSINE_BINS) * (2.0 * np.pi / _COSINE_BINS), dtype=np.float64)
    rows = np.shape(energy)
    centre, power = np.broadcast_to(to_azimuth, rows), np.broadcast_to(power_of_width(width), rows)
    share = cosine_power(azimuth - np.asarray(centre)[:, None], power[:, None])
    share /= share.sum(axis=1, keepdims=True) * (2.0 * np.pi / _COSINE_BINS)
    density = np.asarray(np.asarray(energy)[:, None] * share, dtype=np.float64)
    return of_bins(frequency_hz, azimuth, density, wind_to_azimuth)


def _sorted_directions(azimuth: FloatArray) -> tuple[FloatArray, float]:
    """Azimuths sorted within one turn, and their step [rad]."""
    wrapped = np.asarray(azimuth, dtype=np.float64) % (2.0 * np.pi)
    ordered = np.sort(wrapped)
    if ordered.size < 4 or not np.all(np.isfinite(ordered)):
        raise DataError(
            f"a spectrum over directions needs 4 of them or more, not {ordered.size}; give its mean direction and width instead"
        )
    gaps = np.diff(ordered, append=ordered[0] + 2.0 * np.pi)
    step = float(np.median(gaps))
    inner = np.sort(gaps)[:-1]  # the widest may be the part of the circle that a sector leaves out
    if np.any(np.abs(inner - step) > _UNEVEN * step):
        degrees = ", ".join(f"{np.degrees(value):.4g}" for value in (inner.min(), inner.max()))
        raise DataError(f"directions must be evenly spaced, each once; steps lie between {degrees} deg: interpolate them first")
    return wrapped, float(2.0 * np.pi / ordered.size) if gaps.max() < 1.5 * step else step


def _with_empty_ends(azimuth: FloatArray, values: FloatArray, step: float) -> tuple[FloatArray, FloatArray]:
    """Directions of a sector completed to the full circle, or with an empty bin at each end."""
    # the sector starts after the widest gap
    beginning = int(np.argmax(np.diff(azimuth, append=azimuth[0] + 2.0 * np.pi))) + 1
    azimuth, values = np.roll(azimuth, -beginning), np.roll(values, -beginning, axis=1)
    azimuth = azimuth[0] + (azimuth - azimuth[0]) % (2.0 * np.pi)
    missing = 2.0 * np.pi / step - azimuth.size
    if abs(missing - round(missing)) < _UNEVEN * azimuth.size:
        azimuth = azimuth[0] + np.arange(azimuth.size + round(missing)) * step
        return azimuth, np.pad(values, ((0, 0), (0, round(missing))))
    if missing < 3.0:
        raise DataError(
            f"directions leave out {np.degrees(missing * step):.4g} deg, no whole number of their steps: interpolate them first"
        )
    return np.concatenate([[azimuth[0] - step], azimuth, [azimuth[-1] + step]]), np.pad(values, ((0, 0), (1, 1)))


def _refined(azimuth: FloatArray, values: FloatArray, step: float) -> tuple[FloatArray, FloatArray, float]:
    """Directions dense enough for linear interpolation, the densities there, and their step [rad]."""
    parts = int(np.ceil(step / _FINE))
    # two neighbours beyond each end make the cubic periodic
    around = np.concatenate([azimuth[-2:] - 2.0 * np.pi, azimuth, azimuth[:2] + 2.0 * np.pi])
    periodic = np.hstack([values[:, -2:], values, values[:, :2]])
    turn = azimuth.size * step > 2.0 * np.pi - 0.5 * step
    count = azimuth.size * parts if turn else (azimuth.size - 1) * parts + 1
    fine = azimuth[0] + np.arange(count) * (step / parts)
    return fine, np.asarray(np.maximum(PchipInterpolator(around, periodic, axis=1)(fine), 0.0)), step / parts


def _filled(values: FloatArray, energy: FloatArray) -> FloatArray:
    """Directional distribution of every band [rad⁻¹]; a band without energy takes the distribution of the nearest band with energy."""
    known = np.flatnonzero(energy > 0.0)
    if known.size == 0:
        raise DataError("energy of a measured spectrum must not be zero everywhere; for a calm sea use the flat spectrum")
    rows = np.arange(energy.size)
    nearest = known[np.argmin(np.abs(rows[:, None] - known[None, :]), axis=1)]
    return np.asarray(values[nearest] / energy[nearest, None])
