"""Matched filter for a known point spread: amplitude of the object at every pixel, clutter whitened by its covariance.

    a = h . x,  h = C^-1 s / (s . C^-1 s),   deflection  d'^2 = A^2 s . C^-1 s

for an object of amplitude A. The level of the clutter is taken as known (thresholds lie above the mean of the statistic), or as
unknown: then the weights add up to 0, which costs the constant part of the signature
(:class:`seaglint.clutter.filters.MatchedFilter`).

References
----------
Turin 1960, IRE Trans. Inf. Theory 6, 311; Margalit, Reed and Gagliardi 1985, IEEE Trans. AES 21, 394 (local covariance).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError
from seaglint.clutter.filters import Kernel, MatchedFilter, as_frames, autocovariance
from seaglint.detection.interface import Frames

#: Share of the variance to which smaller eigenvalues of an estimated covariance are raised: they may come out at 0 or below.
LEAST_EIGENVALUE: Final = 1e-6


TILE: Final = 64  #: Side of tiles with separate covariances, where the object is not too large for it [px].


def covariance_matrix(lags: ArrayLike, shape: tuple[int, int]) -> FloatArray:
    """Covariance of the pixels of a window from the autocovariance at lags -reach ... reach, shape (pixels, pixels) [u²].

    Raises
    ------
    DomainError
        Lags that do not reach across the window.
    """
    c = np.asarray(lags, np.float64)
    reach = (c.shape[0] - 1) // 2
    if c.ndim != 2 or c.shape != (2 * reach + 1,) * 2 or reach < max(shape) - 1:
        raise DomainError(f"covariance of shape {c.shape} does not cover a window of {shape}; estimate it with reach = {max(shape) - 1}")
    row, column = (g.ravel() for g in np.indices(shape))
    return np.asarray(c[np.subtract.outer(row, row) + reach, np.subtract.outer(column, column) + reach])


def whitened(signature: ArrayLike, lags: ArrayLike) -> FloatArray:
    """Whitened signature C^-1 s, shape of the signature [unit of the signature / u²]."""
    s = np.asarray(signature, np.float64)
    matrix = covariance_matrix(lags, (s.shape[0], s.shape[1]))
    # By eigenvalues rather than by solving: an estimated covariance need not be positive definite.
    values, vectors = np.linalg.eigh(matrix)
    inverse = 1.0 / np.maximum(values, LEAST_EIGENVALUE * matrix[0, 0])
    return np.asarray(((vectors * inverse) @ (vectors.T @ s.ravel())).reshape(s.shape))


@dataclass(frozen=True)
class Matched:
    """Matched filter with one set of weights for the whole frame.

    Parameters
    ----------
    signature : array_like
        The object centred on a pixel, shape (odd, odd) [1].
    covariance : array_like, optional
        Autocovariance of the clutter (``seaglint.clutter.filters.autocovariance``); white without it.
    known_level : bool
        Whether the level of the clutter is known.
    """

    signature: ArrayLike
    covariance: ArrayLike | None = None
    known_level: bool = True
    lead: int = field(default=0, init=False)
    calibrated: bool = field(default=False, init=False)
    linear: bool = field(default=True, init=False)
    null_law: str = field(default="Gaussian of the measured mean and standard deviation, Gaussian clutter", init=False)

    def __post_init__(self) -> None:
        # Checks the signature as well.
        weights = MatchedFilter(self.signature, self.covariance).weights
        if self.known_level:
            s = np.asarray(self.signature, np.float64)
            # With a known level the weights need not add up to 0; they give the amplitude 1 on the signature.
            solved = s if self.covariance is None else whitened(s, self.covariance)
            weights = solved / (solved * s).sum()
        object.__setattr__(self, "_kernel", Kernel(weights, name=self.name))

    @property
    def name(self) -> str:
        """Name in the results."""
        return "matched" if self.covariance is None else "matched-global"

    @property
    def weights(self) -> FloatArray:
        """Weights h of the filter, shape of the signature."""
        return np.asarray(self._kernel.weights, np.float64)  # type: ignore[attr-defined]

    @property
    def reach(self) -> int:
        """Half the larger side of the signature [px]."""
        return int(max(self.weights.shape)) // 2

    def __call__(self, frames: Frames) -> Frames:
        """Amplitude of the object centred on each pixel, shape (k, rows, columns), unit of the input."""
        out: Frames = self._kernel.apply(frames)  # type: ignore[attr-defined]
        return out


@dataclass(frozen=True)
class LocalMatched:
    """Matched filter with the covariance of each tile of the frame, in standard deviations of that tile, level unknown.

    Clutter of a corridor and of the open sea around it have different covariances. Each tile has its own weights h, and its statistic is
    divided by the standard deviation sqrt(h . C h) that the tile's covariance gives it.

    Parameters
    ----------
    signature : array_like
        The object centred on a pixel, shape (odd, odd) [1].
    background : array_like
        Frames without objects, shape (k, rows, columns), from which the covariances are estimated.
    tile : int, optional
        Side of the tiles [px], at least three sides of the signature; 64, or three sides where these are more.
    """

    signature: ArrayLike
    background: ArrayLike
    tile: int | None = None
    name: str = field(default="matched-local", init=False)
    lead: int = field(default=0, init=False)
    calibrated: bool = field(default=False, init=False)
    linear: bool = field(default=True, init=False)
    null_law: str = field(default="Gaussian of the measured mean and standard deviation, Gaussian clutter", init=False)

    def __post_init__(self) -> None:
        s = np.asarray(self.signature, np.float64)
        side = max(s.shape)
        frames = as_frames(self.background)
        tile = max(TILE, 3 * side) if self.tile is None else self.tile
        if tile < 3 * side:
            raise DomainError(f"tile = {tile} px is less than three sides of a signature of {side} px; choose at least {3 * side}")
        if min(frames.shape[1:]) < 2 * side:
            raise DomainError(f"frames of {frames.shape[1]} x {frames.shape[2]} px are less than two sides of a signature of {side} px")
        edges = [_edges(n, tile) for n in frames.shape[1:]]
        kernels: list[list[Kernel | None]] = []
        for top, bottom in zip(edges[0][:-1], edges[0][1:], strict=True):
            row: list[Kernel | None] = []
            for left, right in zip(edges[1][:-1], edges[1][1:], strict=True):
                part = frames[:, top:bottom, left:right]
                # Lags up to the side of the signature cover all pairs of its pixels.
                lags = autocovariance(part, side - 1)
                if not lags[side - 1, side - 1] > 0:
                    row.append(None)
                    continue
                h = MatchedFilter(s, lags).weights
                variance = float(h.ravel() @ covariance_matrix(lags, (s.shape[0], s.shape[1])) @ h.ravel())
                row.append(Kernel(h / np.sqrt(max(variance, LEAST_EIGENVALUE * float((h * h).sum()) * lags[side - 1, side - 1]))))
            kernels.append(row)
        # The frames themselves are dropped: only their size is needed from here on.
        object.__setattr__(self, "signature", s)
        object.__setattr__(self, "background", np.empty((0, *frames.shape[1:]), np.float32))
        object.__setattr__(self, "_tiles", (edges, kernels))

    @property
    def reach(self) -> int:
        """Half the larger side of the signature [px]."""
        return int(max(np.shape(self.signature))) // 2

    def __call__(self, frames: Frames) -> Frames:
        """Amplitude over its local standard deviation, shape (k, rows, columns) [1]; NaN in tiles without variation."""
        (rows, columns), kernels = self._tiles  # type: ignore[attr-defined]
        source = as_frames(frames)
        if source.shape[1:] != np.shape(self.background)[1:]:
            raise DomainError(f"frames of {source.shape[1:]} px; the covariances are those of frames of {np.shape(self.background)[1:]} px")
        out = np.full_like(source, np.nan)
        half = self.reach
        for i, row in enumerate(kernels):
            for j, kernel in enumerate(row):
                if kernel is None:
                    continue
                # The tile with its surroundings, as far as the weights reach.
                top, left = max(rows[i] - half, 0), max(columns[j] - half, 0)
                part = kernel.apply(source[:, top : rows[i + 1] + half, left : columns[j + 1] + half])
                out[:, rows[i] : rows[i + 1], columns[j] : columns[j + 1]] = part[
                    :, rows[i] - top : rows[i + 1] - top, columns[j] - left : columns[j + 1] - left
                ]
        return out


def _edges(length: int, tile: int) -> list[int]:
    """Borders of tiles of about equal length, none shorter than ``tile`` where there are several."""
    parts = max(length // tile, 1)
    return [round(k * length / parts) for k in range(parts + 1)]
