"""Thresholds in standard deviations: a filtered sequence becomes z, the height of each pixel above its mean in its own sigma.

All false-alarm counting works on z alone, of shape (k, rows, columns), with NaN outside the region and where a value is missing.
"""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from seaglint.base.errors import DataError, DomainError
from seaglint.base.jit import njit
from seaglint.clutter.filters import Frames, as_frames

Scope = Literal["frame", "sequence", "local"]


@njit
def _frame_scale(frame: np.ndarray, mask: np.ndarray, inside: bool) -> tuple[int, float, float]:
    """Number, mean and standard deviation of the finite pixels of one flat frame, in double precision.

    One pass about the first pixel's value: single precision data leave nine digits to lose, and equal values have exactly no spread.
    """
    count, total, squares, shift = 0, 0.0, 0.0, 0.0
    for i in range(frame.size):
        if (not inside or mask[i]) and np.isfinite(frame[i]):
            if count == 0:
                shift = float(frame[i])
            d = frame[i] - shift
            count += 1
            total += d
            squares += d * d
    if count == 0:
        return 0, np.nan, np.nan
    mean = total / count
    return count, shift + mean, np.sqrt(max(squares / count - mean * mean, 0.0))


@njit
def _scale(frames: np.ndarray, mask: np.ndarray, inside: bool, mean: np.ndarray, std: np.ndarray, out: np.ndarray) -> None:
    for k in range(frames.shape[0]):
        shift = mean[k]
        gain = 1.0 / std[k] if std[k] > 0 else np.nan
        for i in range(frames.shape[1]):
            out[k, i] = (frames[k, i] - shift) * gain if not inside or mask[i] else np.nan


def _flat_mask(mask: NDArray[np.bool_] | None, shape: tuple[int, ...]) -> NDArray[np.bool_]:
    if mask is None:
        return np.empty(0, np.bool_)
    m = np.ascontiguousarray(mask, np.bool_)
    if m.shape != shape[1:]:
        raise DataError(f"mask of shape {m.shape} does not fit frames of {shape[1]} x {shape[2]} pixels; give one value per pixel")
    return m.ravel()


def frame_scale(filtered: ArrayLike, mask: NDArray[np.bool_] | None = None) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return mean and standard deviation of every frame over the pixels of a region, each of shape (k,) [unit of the input].

    The standard deviation is the population's (divided by n). NaN where a frame has no pixel in the region.
    """
    frames = as_frames(filtered)
    flat = _flat_mask(mask, frames.shape)
    scales = [_frame_scale(f, flat, mask is not None) for f in frames.reshape(frames.shape[0], -1)]
    return np.array([s[1] for s in scales]), np.array([s[2] for s in scales])


def standardise(
    filtered: ArrayLike,
    mask: NDArray[np.bool_] | None = None,
    *,
    scope: Scope = "frame",
    scale: tuple[float, float] | None = None,
    window: int = 31,
) -> Frames:
    """Height of pixels above the mean in standard deviations, z = (x - mean) / sigma.

    Parameters
    ----------
    filtered : array_like
        Output of a filter, shape (k, rows, columns) [u]; NaN is missing.
    mask : ndarray of bool, optional
        The region, shape (rows, columns); mean and sigma are of its pixels, and z is NaN outside it.
    scope : {"frame", "sequence", "local"}
        Scope of mean and sigma: each frame (as in the source article); the whole sequence, in ``scale``; or the square of ``window`` pixels
        around each pixel in its frame, inside the region.
    scale : (float, float), optional
        Mean and standard deviation of the sequence [u], for ``scope = "sequence"``.
    window : int
        Side of the moving square [px], odd, at least 5; a pixel with fewer than 16 valid pixels in it gets NaN. The square includes the
        pixel itself: z cannot exceed ``window``.

    Returns
    -------
    ndarray
        z, shape (k, rows, columns), float32 [1]. NaN for whole frames (``frame``, ``sequence``) or squares (``local``) without variation:
        a constant has no sigma.

    Raises
    ------
    DataError
        The mask does not fit.
    DomainError
        A scale that is missing or not positive, a window that cannot be used.

    Examples
    --------
    >>> image = np.array([[0.0, 0.0, 0.0, 4.0]])
    >>> standardise(image)[0, 0].astype(float).round(3).tolist()
    [-0.577, -0.577, -0.577, 1.732]
    """
    frames = as_frames(filtered)
    flat = _flat_mask(mask, frames.shape)
    if scope == "local":
        return _local(frames, mask, window)
    count = frames.shape[0]
    if scope == "sequence":
        if scale is None or not np.isfinite(scale[0]) or not scale[1] >= 0:
            raise DomainError(
                f"scope = 'sequence' with scale = {scale}: give the mean and the standard deviation (0 or more) of the whole sequence"
            )
        mean, std = np.full(count, float(scale[0])), np.full(count, float(scale[1]))
    else:
        mean, std = frame_scale(frames, mask)
    out = np.empty_like(frames)
    _scale(frames.reshape(count, -1), flat, mask is not None, mean, std, out.reshape(count, -1))
    return out


def _local(frames: Frames, mask: NDArray[np.bool_] | None, window: int) -> Frames:
    from scipy.ndimage import uniform_filter

    if window < 5 or window % 2 == 0:
        raise DomainError(f"window = {window} px is not an odd number of at least 5; choose e.g. 31")
    valid = np.isfinite(frames) & (True if mask is None else mask)
    out = np.full_like(frames, np.nan)
    size = (window, window)
    for k in range(frames.shape[0]):
        v = valid[k]
        if not v.any():
            continue
        level = float(frames[k][v].mean(dtype=np.float64))
        # Less the frame's level: the variance is a difference of squares, which loses digits to a large mean.
        x = np.where(v, frames[k] - level, 0.0).astype(np.float64)
        share = uniform_filter(v.astype(np.float64), size, mode="constant")
        enough = v & (share * window * window > 15.5)
        share = np.where(share > 0, share, 1.0)
        mean = uniform_filter(x, size, mode="constant") / share
        variance = uniform_filter(x * x, size, mode="constant") / share - mean * mean
        # A difference that is rounding only is no variance.
        flat = variance <= 1e-12 * float((x * x).max())
        good = enough & ~flat
        out[k][good] = ((x - mean)[good] / np.sqrt(variance[good])).astype(np.float32)
    return out


def gaussian_rate(threshold_sigma: ArrayLike) -> NDArray[np.float64]:
    """One-sided Gaussian tail ``Q(m) = erfc(m / sqrt 2) / 2`` [1].

    Examples
    --------
    >>> gaussian_rate([3.0, 3.5]).round(6).tolist()
    [0.00135, 0.000233]
    """
    from scipy.special import ndtr

    return np.asarray(ndtr(-np.asarray(threshold_sigma, np.float64)), np.float64)
