"""Autocorrelation of clutter along the picture's axes and in time, and the effective size of a correlated sample.

Lengths and times are the lags at which the correlation falls to 1/e, interpolated between samples by a cubic through its logarithm (exact
for an exponential and nearly so for a Gaussian shape). The estimate is corrected for the mean, which is taken from the same data and lowers
every lag by the mean's variance: ``rho = (c + v) / (c_0 + v)``, ``v = sum over lags of w (c + v)``, solved by iteration.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError

BoolArray = NDArray[np.bool_]

LEVEL = float(np.exp(-1.0))  #: Correlation at the lag that is the length or time [1].
FEWEST_FRAMES = 8  #: Least number of frames of a correlation in time.


@dataclass(frozen=True)
class SpatialCorrelation:
    """Autocorrelation along the picture's axes."""

    x: FloatArray  #: Correlation at 0, 1, 2 ... px along columns, horizontally [1, (lags,)]; NaN at lags without pairs.
    y: FloatArray  #: Correlation at 0, 1, 2 ... px along rows, vertically [1, (lags,)]; NaN at lags without pairs.
    #: Lag at which ``x`` falls to 1/e [px]; below one pixel by the straight line from lag 0 to 1, 0.63 px for white noise. NaN for
    #: constant data or where it does not fall so far.
    length_x: float
    length_y: float  #: Lag at which ``y`` falls to 1/e [px], as ``length_x``.
    scale_x: float  #: Integral scale, ``1 + 2 sum rho`` up to the first value of ``x`` below zero [px].
    scale_y: float  #: Integral scale of ``y`` [px], as ``scale_x``.


@dataclass(frozen=True)
class TemporalCorrelation:
    """Autocorrelation in time, mean over pixels."""

    rho: FloatArray  #: Correlation at 0, 1, 2 ... frames. Shape (lags,).
    time: float  #: Lag at which it falls to 1/e [s]; [frames] without a frame rate. NaN as for lengths, and with fewer than 8 frames.
    scale: float  #: Integral scale, ``1 + 2 sum rho`` up to its first value below zero [frames].
    reason: str = ""  #: Reason for the absence of a time; empty if there is one.


def spatial_correlation(
    frames: ArrayLike, mask: BoolArray | None = None, *, mean: ArrayLike | None = None, longest: int | None = None
) -> SpatialCorrelation:
    """Estimate the correlation of pixels along x and y, frames pooled.

    Parameters
    ----------
    frames : array_like, shape (rows, columns) or (frames, rows, columns)
        NaN are left out. Some ten frames, further apart than the correlation time, give the same result as all.
    mask : ndarray of bool, shape (rows, columns), optional
        Pixels of the region.
    mean : array_like, shape (rows, columns), optional
        Part that is no clutter and is subtracted first: with ``trend_surface``, for one frame and for many, the shape of the
        corridor is not taken for correlation. (The mean in time of each pixel serves for a long sequence only: the mean of a few
        frames contains clutter.) The region's mean is removed in any case.
    longest : int, optional
        Largest lag [px]; default a third of each side.

    Returns
    -------
    SpatialCorrelation

    Raises
    ------
    DataError
        If shapes do not fit.

    Examples
    --------
    >>> import numpy as np
    >>> white = np.random.default_rng(1).normal(size=(200, 200))
    >>> bool(spatial_correlation(white).length_x < 1.0)
    True
    """
    data = np.array(frames, dtype=np.float64, ndmin=3)
    if data.ndim != 3:
        raise DataError(f"frames of shape {data.shape}; give (rows, columns) or (frames, rows, columns)")
    for name, other in (("mask", mask), ("mean", mean)):
        if other is not None and np.shape(other) != data.shape[1:]:
            raise DataError(f"{name} of shape {np.shape(other)} does not fit frames of {data.shape[1:]}; give one value per pixel")
    valid = np.isfinite(data)
    level = max(float(data.max(where=valid, initial=0.0)), -float(data.min(where=valid, initial=0.0)))
    if mean is not None:
        data -= np.asarray(mean)
        valid = np.isfinite(data)
    if mask is not None:
        valid &= mask
    if not valid.any():
        nothing = np.full(1, np.nan)
        return SpatialCorrelation(nothing, nothing, np.nan, np.nan, np.nan, np.nan)
    centred = np.where(valid, data - data[valid].mean(), 0.0)
    del data
    sums = []
    for axis in (2, 1):
        limit = max(1, centred.shape[axis] // 3) if longest is None else min(longest, centred.shape[axis] - 1)
        sums.append(_lagged_sums(centred, valid, axis, limit))
    variance = float(np.mean(centred[valid] ** 2))
    # A constant less a surface leaves rounding errors, which have a correlation of their own.
    if variance <= (1e-12 * level) ** 2:
        variance = 0.0
    lags = [np.divide(total, pairs, out=np.full(total.shape, np.nan), where=pairs > 0) for total, pairs in sums]
    # The mean of a region of n pixels varies by variance times integral scales over n. Each frame counts as independent, which holds for
    # frames far apart; for frames close together the correction is only smaller than it should be.
    pixels = valid.sum()
    shift = 0.0
    for _ in range(8):
        scale_x, scale_y = (_integral_scale((lag + shift) / (variance + shift)) if variance > 0.0 else 1.0 for lag in lags)
        shift = variance / max(pixels / (scale_x * scale_y) - 1.0, 1.0)
    if not variance > 0.0:
        rho = [np.full(lag.shape, np.nan) for lag in lags]
    else:
        # A mean over the pairs of one lag can exceed that over all pixels where the variance is uneven; a correlation cannot exceed 1.
        rho = [np.clip((lag + shift) / (variance + shift), -1.0, 1.0) for lag in lags]
        for r in rho:
            r[0] = 1.0
    return SpatialCorrelation(rho[0], rho[1], decay(rho[0]), decay(rho[1]), _integral_scale(rho[0]), _integral_scale(rho[1]))


def trend_surface(image: ArrayLike, mask: BoolArray | None = None, degree: int = 4) -> FloatArray:
    """Fit a polynomial surface in row and column to a region, by least squares: its slow change of brightness.

    Parameters
    ----------
    image : array_like, shape (rows, columns)
        Mean over time, or a single frame; NaN are left out.
    mask : ndarray of bool, shape (rows, columns), optional
        Pixels of the region.
    degree : int
        Degree of the polynomial; degree 4 has fifteen coefficients, which use up fifteen of the region's independent values.

    Returns
    -------
    ndarray, shape (rows, columns)
        Also outside the region, where it has no meaning. Of degree 0 if the region has too few pixels.
    """
    data = np.asarray(image, dtype=np.float64)
    used = np.isfinite(data) if mask is None else np.isfinite(data) & mask
    v, u = (2.0 * index / max(size - 1, 1) - 1.0 for index, size in zip(np.indices(data.shape), data.shape, strict=True))
    if np.count_nonzero(used) < 10 * (degree + 1) * (degree + 2):
        return np.full(data.shape, np.mean(data[used]) if used.any() else np.nan)
    powers = [(i, j) for i in range(degree + 1) for j in range(degree + 1 - i)]
    # Triangular factor of all equations, some rows of the picture at a time: the same least squares in a hundredth of the memory.
    factor = np.empty((0, len(powers) + 1))
    for top in range(0, data.shape[0], 32):
        rows = slice(top, top + 32)
        inside = used[rows]
        equations = np.stack([*(u[rows][inside] ** i * v[rows][inside] ** j for i, j in powers), data[rows][inside]], axis=1)
        factor = np.asarray(np.linalg.qr(np.concatenate([factor, equations]), mode="r"))
    rounding = float(np.finfo(np.float64).eps) * np.count_nonzero(used)
    coefficients = np.linalg.lstsq(factor[:, :-1], factor[:, -1], rcond=rounding)[0]
    square = np.zeros((degree + 1, degree + 1))
    for (i, j), coefficient in zip(powers, coefficients, strict=True):
        square[j, i] = coefficient
    return np.asarray(np.polynomial.polynomial.polygrid2d(v[:, 0], u[0], square))


def temporal_correlation(series: ArrayLike, frame_rate: float | None = None, *, longest: int | None = None) -> TemporalCorrelation:
    """Estimate the correlation of each pixel with itself at later times, about the pixel's mean, averaged over pixels.

    Parameters
    ----------
    series : array_like, shape (frames, ...)
        Values of pixels in time; NaN are left out. A few thousand pixels spread over the region give the same result as all.
    frame_rate : float, optional
        Frames per second [Hz].
    longest : int, optional
        Largest lag [frames]; default half the frames.

    Returns
    -------
    TemporalCorrelation
        The sequence should be several correlation times long: the mean of a shorter one cannot be separated from its slow changes,
        and the estimated time is too short.

    Raises
    ------
    DataError
        If the frame rate is not positive.
    """
    data = np.asarray(series, dtype=np.float64)
    if frame_rate is not None and not (np.isfinite(frame_rate) and frame_rate > 0.0):
        raise DataError(f"frame_rate = {frame_rate} Hz must be positive; give the recording's")
    frames = data.shape[0]
    data = data.reshape(frames, -1)
    if frames < FEWEST_FRAMES:
        return TemporalCorrelation(np.full(1, np.nan), np.nan, np.nan, f"{frames} frames, at least {FEWEST_FRAMES} are needed")
    valid = np.isfinite(data)
    enough = valid.sum(axis=0) >= max(FEWEST_FRAMES, frames // 2)
    data, valid = data[:, enough], valid[:, enough]
    centred = np.where(valid, data - np.where(valid, data, 0.0).sum(axis=0) / np.maximum(valid.sum(axis=0), 1), 0.0)
    variance = float(np.sum(centred**2) / max(valid.sum(), 1))
    if not variance > 0.0:
        return TemporalCorrelation(np.full(1, np.nan), np.nan, np.nan, "no pixel changes in time")
    limit = frames // 2 if longest is None else min(longest, frames - 1)
    total, pairs = _lagged_sums(centred, valid, 0, limit)
    lag = total / np.maximum(pairs, 1)
    shift = 0.0
    for _ in range(20):
        rho = (lag + shift) / (variance + shift)
        positive = _positive_lags(rho)
        # Variance of a mean of k values, from the lags before the first zero.
        inner = np.arange(1, len(positive))
        shift = (variance + shift) / frames * (1.0 + 2.0 * float(np.sum((1.0 - inner / frames) * positive[1:])))
    rho = np.clip((lag + shift) / (variance + shift), -1.0, 1.0)
    rho[0] = 1.0
    frames_to_fall = decay(rho)
    reason = "" if np.isfinite(frames_to_fall) else f"correlation does not fall to 1/e within {limit} frames"
    return TemporalCorrelation(rho, frames_to_fall / (frame_rate or 1.0), _integral_scale(rho), reason)


def effective_count(count: float, *scales: float) -> float:
    """Estimate the number of independent values among correlated ones.

    ``m = n / (s_1 s_2 ...)`` with the integral scales along each axis, the separable form of ``n / sum rho``.

    Parameters
    ----------
    count : float
        Number of values.
    *scales : float
        Integral scales [px or frames]; NaN (not known) count as 1.

    Returns
    -------
    float
        At least 1, at most ``count``. For functions of the values that are less correlated than they are, a lower bound.
    """
    product = float(np.prod([max(s, 1.0) for s in scales if np.isfinite(s)]))
    return float(max(count / product, 1.0)) if count else 0.0


def block_labels(shape: tuple[int, ...], sides: tuple[float, ...]) -> NDArray[np.int64]:
    """Return the label of the block of each element of an array, for intervals of fits.

    Parameters
    ----------
    shape : tuple of int
        Shape of the array, e.g. (frames, rows, columns).
    sides : tuple of float
        Sides of a block along each axis; some five correlation lengths or times. Rounded up, and to divide the axis evenly.

    Returns
    -------
    ndarray of int, of that shape
    """
    label = np.zeros(shape, dtype=np.int64)
    for axis, (size, side) in enumerate(zip(shape, sides, strict=True)):
        number = max(int(size // max(np.ceil(side), 1)), 1)
        label = label * number + (np.arange(size) * number // size).reshape([-1 if i == axis else 1 for i in range(len(shape))])
    return label


def decay(rho: FloatArray) -> float:
    """Return the lag at which a correlation first falls to 1/e, interpolated between samples; NaN where it does not.

    Parameters
    ----------
    rho : ndarray, shape (lags,)
        Correlation at lags 0, 1, 2 ...

    Returns
    -------
    float
        [lags]; the error is below 0.5 % for exponential and Gaussian shapes of a length over one lag.
    """
    low = np.flatnonzero(rho <= LEVEL)
    if not low.size or not np.all(np.isfinite(rho[: low[0] + 1])):
        return np.nan
    after = int(low[0])
    if after == 0:
        return np.nan
    # Within the first lag no shape can be recognised, unless the next values are above noise: the straight line is taken.
    if after == 1 and (len(rho) < 3 or rho[2] <= 0.02 or rho[1] <= 0.02):
        return (1.0 - LEVEL) / (1.0 - float(rho[1]))
    nodes = np.arange(max(after - 2, 0), min(after + 2, len(rho)))
    # Values near zero are noise, and their logarithm would dominate the cubic.
    nodes = nodes[: 1 + int(np.flatnonzero(rho[nodes] > 0.02)[-1])]
    if len(nodes) < 2 or np.any(rho[nodes] <= 0.02):
        return after - 1 + float((rho[after - 1] - LEVEL) / (rho[after - 1] - rho[after]))
    polynomial = np.polynomial.Polynomial.fit(nodes, np.log(rho[nodes]) + 1.0, len(nodes) - 1)
    low_end, high_end = float(after - 1), float(after)
    for _ in range(60):
        middle = 0.5 * (low_end + high_end)
        low_end, high_end = (middle, high_end) if polynomial(middle) > 0.0 else (low_end, middle)
    return 0.5 * (low_end + high_end)


def _positive_lags(rho: FloatArray) -> FloatArray:
    """Return the lags before the first correlation that is not above zero; the noise of later ones could sum to any value."""
    bad = np.flatnonzero(~(rho > 0.0))
    return rho[: bad[0]] if bad.size else rho


def _integral_scale(rho: FloatArray) -> float:
    positive = _positive_lags(rho)
    return 1.0 + 2.0 * float(np.sum(positive[1:])) if len(positive) else np.nan


def _lagged_sums(centred: FloatArray, valid: BoolArray, axis: int, longest: int) -> tuple[FloatArray, FloatArray]:
    """Return sums of products and numbers of pairs at lags 0 ... longest along an axis, by zero-padded Fourier transforms."""
    from scipy.fft import irfft, next_fast_len, rfft

    size = next_fast_len(centred.shape[axis] + longest + 1, real=True)
    lines = np.moveaxis(centred, axis, -1).reshape(-1, centred.shape[axis])
    exist = np.moveaxis(valid, axis, -1).reshape(lines.shape)
    power, pairs = np.zeros(size // 2 + 1), np.zeros(size // 2 + 1)
    whole = 0
    # Few lines at a time: transforms of all of them at once would be several times the data.
    for first in range(0, len(lines), 512):
        chunk, present = lines[first : first + 512], exist[first : first + 512]
        occupied = present.any(axis=1)
        complete = present.all(axis=1)
        whole += int(complete.sum())
        for values, total in ((chunk[occupied], power), (present[occupied & ~complete].astype(np.float64), pairs)):
            transformed = rfft(values, size, axis=1)
            total += np.einsum("ij,ij->j", transformed.real, transformed.real) + np.einsum("ij,ij->j", transformed.imag, transformed.imag)
    # Lines without gaps have as many pairs as their length leaves.
    number = np.rint(irfft(pairs, size)[: longest + 1]) + whole * np.arange(lines.shape[1], lines.shape[1] - longest - 1, -1)
    return np.asarray(irfft(power, size)[: longest + 1]), np.asarray(number)
