"""Shift between two images to a fraction of a pixel, by phase correlation.

References
----------
Kuglin and Hines 1975, Proc. IEEE Conf. Cybernetics and Society, 163; Guizar-Sicairos, Thurman and Fienup 2008, Opt. Lett. 33, 156
(refinement by a small discrete Fourier transform around the peak).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from seaglint.base.errors import DataError
from seaglint.detection.interface import Frames

FINENESS = 50  #: Number of parts of a pixel to which a shift is refined: far finer than the noise.


def _prepared(image: ArrayLike) -> NDArray[np.float64]:
    x = np.asarray(image, np.float64)
    finite = np.isfinite(x)
    if not finite.any():
        raise DataError("a frame without any value cannot be registered; leave it out or switch registration off")
    x = np.where(finite, x, x[finite].mean())
    # The border of an image correlates with itself at shift 0; a Hann window takes it away.
    window = np.outer(np.hanning(x.shape[0] + 2)[1:-1], np.hanning(x.shape[1] + 2)[1:-1])
    return np.asarray((x - (x * window).sum() / window.sum()) * window)


def displacement(earlier: ArrayLike, later: ArrayLike) -> tuple[float, float]:
    """Motion of the scene from one image to the next, (rows, columns) [px]: ``later(x) = earlier(x - displacement)``.

    The cross-power spectrum is whitened by its square root only: fully whitened, frequencies without signal would vote like the others.

    Raises
    ------
    DataError
        Images of different shapes, or without any value.
    """
    if np.shape(earlier) != np.shape(later):
        raise DataError(f"images of shapes {np.shape(earlier)} and {np.shape(later)} cannot be registered; give equal shapes")
    first = _displacement(np.asarray(earlier), np.asarray(later))
    # A second time on the common part of both images: parts in one image alone bias the estimate towards 0 under the window.
    whole = [round(d) for d in first]
    shape = np.shape(earlier)
    if not any(whole) or any(n - abs(d) < 16 for n, d in zip(shape, whole, strict=True)):
        return first
    before = tuple(slice(max(-d, 0), n - max(d, 0)) for d, n in zip(whole, shape, strict=True))
    after = tuple(slice(max(d, 0), n - max(-d, 0)) for d, n in zip(whole, shape, strict=True))
    rest = _displacement(np.asarray(earlier)[before], np.asarray(later)[after])
    return (whole[0] + rest[0], whole[1] + rest[1]) if max(abs(rest[0]), abs(rest[1])) < 1.5 else first


def _displacement(earlier: NDArray[np.floating], later: NDArray[np.floating]) -> tuple[float, float]:
    a, b = np.fft.fft2(_prepared(earlier)), np.fft.fft2(_prepared(later))
    cross = b * a.conj()
    size = np.abs(cross)
    if not size.any():
        return 0.0, 0.0
    cross /= np.sqrt(np.maximum(size, 1e-12 * size.max()))
    rows, columns = cross.shape
    peak = np.unravel_index(int(np.argmax(np.fft.ifft2(cross).real)), cross.shape)
    centre = [float((p + n // 2) % n - n // 2) for p, n in zip(peak, cross.shape, strict=True)]
    fy, fx = np.fft.fftfreq(rows), np.fft.fftfreq(columns)
    for step in (0.1, 1.0 / FINENESS):
        offsets = step * np.arange(-10, 11)
        y, x = centre[0] + offsets, centre[1] + offsets
        fine = np.exp(2j * np.pi * np.outer(y, fy)) @ cross @ np.exp(2j * np.pi * np.outer(fx, x))
        i, j = np.unravel_index(int(np.argmax(fine.real)), fine.shape)
        centre = [float(y[i]), float(x[j])]
    return centre[0], centre[1]


def moved(frame: ArrayLike, by: tuple[float, float]) -> Frames:
    """Image moved by (rows, columns) [px], cubic spline; NaN where it has no value, unit of the input."""
    from scipy.ndimage import shift

    x = np.asarray(frame, np.float64)
    if by == (0.0, 0.0):
        return x.astype(np.float32)
    missing = np.isnan(x)
    if missing.any():
        gone = shift(missing.astype(np.float64), by, order=1, mode="constant", cval=1.0) > 1e-6
        out = shift(np.where(missing, np.nanmean(x), x), by, order=3, mode="constant", cval=np.nan)
        return np.where(gone, np.nan, out).astype(np.float32)
    return np.asarray(shift(x, by, order=3, mode="constant", cval=np.nan), np.float32)
