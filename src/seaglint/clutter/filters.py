"""Spatial filters that enhance small bright targets against the sea.

Every filter is a frozen record with ``name``, ``margin`` and ``apply``: frames of shape (k, rows, columns) in, the same shape out, each
frame by itself. Beyond the border the nearest pixel is repeated. A pixel whose footprint holds a missing value (NaN) is missing.
The gain of a filter is free: false alarms are counted in standard deviations of its output.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Final, Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from seaglint.base.errors import DataError, DomainError
from seaglint.base.jit import njit

Frames = NDArray[np.float32]


@runtime_checkable
class Filter(Protocol):
    """Interface of a filter for false-alarm counting."""

    @property
    def name(self) -> str:
        """Short name as in the results."""
        ...

    @property
    def margin(self) -> int:
        """Pixels from the border within which the output depends on repeated pixels [px]."""
        ...

    def apply(self, frames: Frames) -> Frames:
        """Filtered frames, shape (k, rows, columns), float32, in units of the input."""
        ...


def as_frames(frames: ArrayLike) -> Frames:
    """Frames as a C-contiguous float32 array of shape (k, rows, columns); one image becomes one frame.

    Raises
    ------
    DataError
        The array has neither two nor three axes, or an axis without elements.
    """
    array = np.ascontiguousarray(frames, np.float32)
    if array.ndim == 2:
        array = array[None]
    if array.ndim != 3 or 0 in array.shape:
        raise DataError(f"frames have shape {array.shape}; (rows, columns) or (frames, rows, columns) is needed, none of them 0")
    return array


@njit
def _laplacian(frames: np.ndarray, out: np.ndarray) -> None:
    count, rows, columns = frames.shape
    for k in range(count):
        for i in range(rows):
            up = i - 1 if i > 0 else 0
            down = i + 1 if i < rows - 1 else rows - 1
            if columns == 1:
                out[k, i, 0] = 2.0 * frames[k, i, 0] - frames[k, up, 0] - frames[k, down, 0]
                continue
            # Beyond the border the nearest pixel is repeated: at the first and last column it cancels one of the centre's four.
            for j in range(1, columns - 1):
                beside = frames[k, i, j - 1] + frames[k, i, j + 1]
                out[k, i, j] = 4.0 * frames[k, i, j] - beside - frames[k, up, j] - frames[k, down, j]
            out[k, i, 0] = 3.0 * frames[k, i, 0] - frames[k, i, 1] - frames[k, up, 0] - frames[k, down, 0]
            j = columns - 1
            out[k, i, j] = 3.0 * frames[k, i, j] - frames[k, i, j - 1] - frames[k, up, j] - frames[k, down, j]


@dataclass(frozen=True)
class Laplacian:
    """Laplacian filter of the source article: five points, centre +4, neighbours -1 (bright points become positive).

    Examples
    --------
    >>> Laplacian().apply(np.eye(3, dtype=np.float32)[None])[0]
    array([[ 2., -2.,  0.],
           [-2.,  4., -2.],
           [ 0., -2.,  2.]], dtype=float32)
    """

    name: str = field(default="laplacian", init=False)
    margin: int = field(default=1, init=False)

    def apply(self, frames: Frames) -> Frames:
        """Filtered frames, shape (k, rows, columns), units of the input."""
        source = as_frames(frames)
        out = np.empty_like(source)
        _laplacian(source, out)
        return out


def _correlate(frames: Frames, kernel: NDArray[np.float64]) -> Frames:
    from scipy.ndimage import correlate

    # In double precision, as such filters compute sums of large terms that nearly cancel.
    return _rounded(correlate(frames.astype(np.float64), kernel[None], mode="nearest"), frames)


def _rounded(out: NDArray[np.float64], source: NDArray[np.floating]) -> Frames:
    """Return single precision values, with the rounding residue of a constant set to 0, so that it has no sigma."""
    finite = source[np.isfinite(source)]
    # A constant filtered in double precision leaves some 1e-16 of its level.
    return np.where(np.abs(out) <= (1e-12 * float(np.abs(finite).max()) if finite.size else 0.0), 0.0, out).astype(np.float32)


def _odd(size: int, what: str) -> int:
    if size < 3 or size % 2 == 0:
        raise DomainError(f"{what} = {size} is not an odd number of at least 3 pixels; choose 3, 5, 7, ...")
    return size


def _with_missing(frames: Frames, margin: int) -> tuple[Frames, NDArray[np.bool_] | None]:
    """Return frames without NaN, and the pixels whose square footprint contains one."""
    from scipy.ndimage import maximum_filter

    missing = np.isnan(frames)
    if not missing.any():
        return frames, None
    side = 2 * margin + 1
    level = np.float32(np.nanmedian(frames)) if not missing.all() else np.float32(0)
    return np.where(missing, level, frames), np.asarray(maximum_filter(missing, (1, side, side), mode="nearest"), np.bool_)


def _blank(out: Frames, missing: NDArray[np.bool_] | None) -> Frames:
    if missing is not None:
        out[missing] = np.nan
    return out


@dataclass(frozen=True)
class Kernel:
    """Filter with a user's weights, centred on the middle element.

    Parameters
    ----------
    weights : array_like
        Shape (odd, odd) [1]; a target brighter than its surroundings is to give a positive output.
    name : str
        Name in the results.

    Raises
    ------
    DomainError
        Even sides, weights that are not finite, or all zero.
    """

    weights: ArrayLike
    name: str = "kernel"

    def __post_init__(self) -> None:
        w = np.array(self.weights, np.float64)
        if w.ndim != 2 or w.shape[0] % 2 == 0 or w.shape[1] % 2 == 0 or not np.isfinite(w).all() or not w.any():
            raise DomainError(
                f"kernel of shape {w.shape} is not usable; give finite weights, not all zero, with odd numbers of rows and columns"
            )
        object.__setattr__(self, "weights", w)

    @property
    def margin(self) -> int:
        """Half the larger side [px]."""
        return int(max(np.shape(self.weights))) // 2

    def apply(self, frames: Frames) -> Frames:
        """Filtered frames, shape (k, rows, columns), in units of the input times the weights' units."""
        return _correlate(as_frames(frames), np.asarray(self.weights, np.float64))


@dataclass(frozen=True)
class DifferenceOfGaussians:
    """Blur of ``inner`` standard deviations minus one of ``outer`` [px]: passes blobs of about ``inner``, no constant and no slope.

    Kernels reach to four standard deviations.
    """

    inner: float = 0.7
    outer: float = 2.0
    name: str = field(default="difference_of_gaussians", init=False)

    def __post_init__(self) -> None:
        if not 0 < self.inner < self.outer:
            raise DomainError(f"inner = {self.inner:g} px and outer = {self.outer:g} px: 0 < inner < outer is needed")

    @property
    def margin(self) -> int:
        """Reach of the wider kernel [px]."""
        return int(4 * self.outer + 0.5)

    def apply(self, frames: Frames) -> Frames:
        """Filtered frames, shape (k, rows, columns), units of the input."""
        from scipy.ndimage import gaussian_filter

        source = as_frames(frames).astype(np.float64)
        narrow, wide = (gaussian_filter(source, (0, s, s), mode="nearest", truncate=4.0) for s in (self.inner, self.outer))
        return _rounded(narrow - wide, source)


@dataclass(frozen=True)
class MedianSubtraction:
    """Pixel minus the median of the square of ``size`` pixels around it: edges pass far less than through a linear filter."""

    size: int = 5
    name: str = field(default="median_subtraction", init=False)

    def __post_init__(self) -> None:
        _odd(self.size, "size of the median")

    @property
    def margin(self) -> int:
        """Half the side of the square [px]."""
        return self.size // 2

    def apply(self, frames: Frames) -> Frames:
        """Filtered frames, shape (k, rows, columns), units of the input."""
        from scipy.ndimage import median_filter

        source, missing = _with_missing(as_frames(frames), self.margin)
        return _blank(source - np.asarray(median_filter(source, (1, self.size, self.size), mode="nearest"), np.float32), missing)


@dataclass(frozen=True)
class TopHat:
    """White top-hat: pixel minus the morphological opening with a square of ``size`` pixels; never negative.

    Bright structures smaller than the square remain, wider ones are removed whatever their shape.
    """

    size: int = 5
    name: str = field(default="top_hat", init=False)

    def __post_init__(self) -> None:
        _odd(self.size, "size of the top-hat")

    @property
    def margin(self) -> int:
        """Reach of an opening: erosion and dilation [px]."""
        return 2 * (self.size // 2)

    def apply(self, frames: Frames) -> Frames:
        """Filtered frames, shape (k, rows, columns), units of the input."""
        from scipy.ndimage import grey_opening

        source, missing = _with_missing(as_frames(frames), self.margin)
        return _blank(source - np.asarray(grey_opening(source, (1, self.size, self.size), mode="nearest"), np.float32), missing)


@dataclass(frozen=True)
class MatchedFilter:
    """Best linear estimate of the amplitude of a known signature on a background of unknown level.

        a = h . x,  h = C^-1 (s - b 1) / (s . C^-1 (s - b 1)),  b = (1 . C^-1 s) / (1 . C^-1 1)

    with signature s and covariance C of the clutter inside the signature's window (generalised least squares with a constant). The weights
    add up to 0 and answer the signature with 1.

    Parameters
    ----------
    signature : array_like
        Shape (odd, odd), at most 31 on a side; with a frame of background around the target, which gives the contrast.
    covariance : array_like, optional
        Autocovariance of the clutter at lags -reach ... reach, shape (2 reach + 1, 2 reach + 1), from ``autocovariance``; reach at
        least the signature's side less one. Without it the clutter is taken as white.

    Raises
    ------
    DomainError
        A signature that is constant, too large or of even side, or a covariance that does not reach far enough.

    References
    ----------
    Turin 1960, IRE Trans. Inf. Theory 6, 311.
    """

    signature: ArrayLike
    covariance: ArrayLike | None = None
    name: str = field(default="matched", init=False)

    def __post_init__(self) -> None:
        s = np.array(self.signature, np.float64)
        if s.ndim != 2 or s.shape[0] % 2 == 0 or s.shape[1] % 2 == 0 or max(s.shape) > 31 or not np.isfinite(s).all() or np.ptp(s) == 0:
            raise DomainError(
                f"signature of shape {s.shape} is not usable; give finite values, not all equal, with odd sides of at most 31 pixels"
            )
        object.__setattr__(self, "signature", s)
        object.__setattr__(self, "_weights", self._solve(s))

    def _solve(self, s: NDArray[np.float64]) -> NDArray[np.float64]:
        flat = s.ravel()
        if self.covariance is None:
            solved = np.stack([flat, np.ones_like(flat)], 1)
        else:
            c = np.asarray(self.covariance, np.float64)
            reach = (c.shape[0] - 1) // 2
            if c.ndim != 2 or c.shape != (2 * reach + 1,) * 2 or reach < max(s.shape) - 1:
                raise DomainError(
                    f"covariance of shape {c.shape} does not cover a signature of {s.shape}; estimate it with reach = {max(s.shape) - 1}"
                )
            row, column = (g.ravel() for g in np.indices(s.shape))
            matrix = c[np.subtract.outer(row, row) + reach, np.subtract.outer(column, column) + reach]
            # An estimated covariance may have eigenvalues of about 0 or below; a millionth of the variance keeps the inverse bounded.
            values, vectors = np.linalg.eigh(matrix)
            inverse = 1.0 / np.maximum(values, 1e-6 * c[reach, reach])
            solved = (vectors * inverse) @ (vectors.T @ np.stack([flat, np.ones_like(flat)], 1))
        level = solved[:, 0].sum() / solved[:, 1].sum()
        h = solved[:, 0] - level * solved[:, 1]
        return np.asarray((h / (flat @ h)).reshape(s.shape))

    @property
    def weights(self) -> NDArray[np.float64]:
        """Weights h of the filter, shape of the signature [1 / unit of the signature]."""
        weights: NDArray[np.float64] = self._weights  # type: ignore[attr-defined]
        return weights

    @property
    def margin(self) -> int:
        """Half the larger side of the signature [px]."""
        return int(max(self.weights.shape)) // 2

    def apply(self, frames: Frames) -> Frames:
        """Amplitude of the signature centred on each pixel, shape (k, rows, columns)."""
        return _correlate(as_frames(frames), self.weights)


def autocovariance(frames: ArrayLike, reach: int) -> NDArray[np.float64]:
    """Autocovariance of a background at pixel lags -reach ... reach, averaged over frames.

    Products of pixels that both exist, over their number; each frame's mean is taken off. NaN pixels are left out.

    Parameters
    ----------
    frames : array_like
        Shape (k, rows, columns) [u].
    reach : int
        Largest lag [px], below rows and columns.

    Returns
    -------
    ndarray
        Shape (2 reach + 1, 2 reach + 1) [u²]; the variance in the middle.
    """
    source = as_frames(frames).astype(np.float64)
    _, rows, columns = source.shape
    if not 0 < reach < min(rows, columns):
        raise DomainError(f"reach = {reach} px does not fit in frames of {rows} x {columns} pixels; choose 1 to {min(rows, columns) - 1}")
    from scipy.fft import irfft2, next_fast_len, rfft2

    valid = np.isfinite(source)
    mean = np.where(valid, source, 0.0).sum((1, 2), keepdims=True) / np.maximum(valid.sum((1, 2), keepdims=True), 1)
    size = (next_fast_len(rows + reach, True), next_fast_len(columns + reach, True))
    products, pairs = np.zeros(size), np.zeros(size)
    for values, exists in zip(np.where(valid, source - mean, 0.0), valid.astype(np.float64), strict=True):
        products += irfft2(np.abs(rfft2(values, size)) ** 2, size)
        pairs += irfft2(np.abs(rfft2(exists, size)) ** 2, size)
    lags = np.arange(-reach, reach + 1)
    return np.asarray((products / np.maximum(np.round(pairs), 1.0))[np.ix_(lags, lags)])


#: Names of the filters that need no further input.
NAMES: Final = ("laplacian", "difference_of_gaussians", "median_subtraction", "top_hat", "none")


@dataclass(frozen=True)
class Unfiltered:
    """Filter that returns the frames unchanged."""

    name: str = field(default="none", init=False)
    margin: int = field(default=0, init=False)

    def apply(self, frames: Frames) -> Frames:
        """The frames, shape (k, rows, columns), float32."""
        return as_frames(frames)


_BY_NAME: Final[Mapping[str, Callable[[], Filter]]] = {
    "laplacian": Laplacian, "difference_of_gaussians": DifferenceOfGaussians, "dog": DifferenceOfGaussians,
    "median_subtraction": MedianSubtraction, "median": MedianSubtraction, "top_hat": TopHat, "tophat": TopHat, "none": Unfiltered,
}  # fmt: skip


def named(name: str) -> Filter:
    """Filter of a name with its default settings (``NAMES``; ``-`` and ``_`` are equal, ``dog`` is short for the second).

    Raises
    ------
    DataError
        Unknown name.

    Examples
    --------
    >>> named("top-hat").name
    'top_hat'
    """
    made = _BY_NAME.get(name.strip().lower().replace("-", "_"))
    if made is not None:
        return made()
    raise DataError(f"filter {name!r} is unknown; choose one of {', '.join(NAMES)}, or give a kernel or a signature of your own")
