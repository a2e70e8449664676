"""Spatial power spectrum of clutter by Welch's method: windowed, half overlapping squares, averaged."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError
from seaglint.base.free_form import JsonObject, plain

SMALLEST = 8  # px; a smaller square has no frequency between its first and the Nyquist one that a window leaves apart


@dataclass(frozen=True)
class Spectrum:
    """Two-sided power spectral density."""

    frequency: FloatArray  #: Rising from -1/2 [cycles/px], the same along both axes. Shape (size,).
    #: Rows are frequencies along y, columns along x [unit² px²]; its sum times the cell ``1/size²`` is the variance. Shape (size, size).
    density: FloatArray
    segments: int  #: Squares averaged; 0 where none was whole, then density is NaN.

    @property
    def variance(self) -> float:
        """Integral of the density over both frequencies [unit²]."""
        return float(self.density.mean())

    def radial(self) -> tuple[FloatArray, FloatArray]:
        """Mean density on rings one frequency step wide, up to 1/2.

        Returns
        -------
        frequency : ndarray, shape (size // 2,)
            Mean distance from the origin of the cells of a ring [cycles/px].
        density : ndarray, shape (size // 2,)
            [unit² px²]; the origin, from which the mean is removed, is left out.
        """
        size = len(self.frequency)
        distance = np.hypot(self.frequency[:, None], self.frequency[None, :])
        # Rings beyond the Nyquist frequency lie in the corners only and are left out.
        ring = np.rint(distance * size).astype(int)
        inside = (ring >= 1) & (ring <= size // 2)
        count = np.bincount(ring[inside], minlength=size // 2 + 1)[1:]
        frequency = np.bincount(ring[inside], weights=distance[inside], minlength=size // 2 + 1)[1:] / count
        return frequency, np.bincount(ring[inside], weights=self.density[inside], minlength=size // 2 + 1)[1:] / count

    def as_dict(self) -> JsonObject:
        """Return the density on rings as plain numbers."""
        frequency, density = self.radial()
        return plain({"frequency_cycles_px": frequency.tolist(), "density": density.tolist()})

    def directional(self, sectors: int = 18) -> tuple[FloatArray, FloatArray]:
        """Share of the variance by direction of the wave vector, frequencies of 1 ... size/2 steps.

        Parameters
        ----------
        sectors : int
            Over half a turn: opposite directions are the same wave.

        Returns
        -------
        angle : ndarray, shape (sectors,)
            From the x axis (columns) towards y (rows, downwards) [rad], 0 ... pi; the first sector is centred on 0.
        share : ndarray, shape (sectors,)
            Sums to 1.
        """
        size = len(self.frequency)
        fy, fx = np.meshgrid(self.frequency, self.frequency, indexing="ij")
        distance = np.hypot(fx, fy) * size
        # A disc, so that the corners of the square do not favour its diagonals.
        inside = (distance > 0.5) & (distance <= size / 2)
        sector = np.rint(np.arctan2(fy, fx)[inside] / (np.pi / sectors)).astype(int) % sectors
        power = np.bincount(sector, weights=self.density[inside], minlength=sectors)
        return np.arange(sectors) * np.pi / sectors, power / power.sum()


def power_spectrum(
    frames: ArrayLike, mask: NDArray[np.bool_] | None = None, *, mean: ArrayLike | None = None, size: int = 64, window: str = "hann"
) -> Spectrum:
    """Power spectrum averaged over the periodograms of squares that lie wholly in the region.

    ``S = |FFT(w (f - mean f))|² / sum w²``

    Parameters
    ----------
    frames : array_like, shape (rows, columns) or (frames, rows, columns)
        Squares with NaN are left out.
    mask : ndarray of bool, shape (rows, columns), optional
        Pixels of the region.
    mean : array_like, shape (rows, columns), optional
        Mean in time of each pixel, subtracted first.
    size : int
        Side of a square [px], made smaller to fit the picture, at least 8.
    window : str
        "hann" or "boxcar"; with "boxcar" the variance within squares is returned exactly (Parseval), at the price of leakage.

    Returns
    -------
    Spectrum

    Raises
    ------
    DataError
        If shapes do not fit, or the picture or square is smaller than 8 px.
    """
    data = np.array(frames, dtype=np.float64, ndmin=3)
    if data.ndim != 3 or (mask is not None and mask.shape != data.shape[1:]) or (mean is not None and np.shape(mean) != data.shape[1:]):
        raise DataError(f"frames of shape {data.shape} with a mask or mean of another; give (frames, rows, columns) and (rows, columns)")
    side = min(size, *data.shape[1:])
    if side < SMALLEST:
        raise DataError(f"squares of {side} px are too small for a spectrum; at least {SMALLEST} are needed")
    if window not in ("hann", "boxcar"):
        raise DataError(f"unknown window '{window}'; choose hann or boxcar")
    if mean is not None:
        data -= np.asarray(mean)
    if mask is not None:
        data[:, ~mask] = np.nan
    # Periodic form: half overlapping Hann windows then sum to a constant.
    taper = np.ones(side) if window == "boxcar" else 0.5 - 0.5 * np.cos(2.0 * np.pi * np.arange(side) / side)
    weight = taper[:, None] * taper[None, :]
    total = np.zeros((side, side))
    segments = 0
    step = max(side // 2, 1)
    for frame in data:
        for top in range(0, data.shape[1] - side + 1, step):
            squares = np.lib.stride_tricks.sliding_window_view(frame[top : top + side], (side, side))[0, ::step]
            squares = squares[np.isfinite(squares).all(axis=(1, 2))]
            total += np.sum(np.abs(np.fft.fft2(weight * (squares - squares.mean(axis=(1, 2), keepdims=True)))) ** 2, axis=0)
            segments += len(squares)
    density = total / (segments * np.sum(weight**2)) if segments else np.full((side, side), np.nan)
    return Spectrum(np.fft.fftshift(np.fft.fftfreq(side)), np.fft.fftshift(density), segments)
