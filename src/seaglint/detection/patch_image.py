"""Principal-component background: the infrared patch-image model, a low-rank background and sparse objects.

References
----------
Gao, Meng, Yang, Wang, Zhou and Hauptmann 2013, IEEE Trans. Image Process. 22, 4996; solved by the inexact augmented Lagrangian of
Lin, Chen and Ma 2010, arXiv:1009.5055, Algorithm 5.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Final

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError
from seaglint.clutter.filters import as_frames
from seaglint.detection.interface import Frames, filled

TOLERANCE: Final = 1e-5  #: Ratio of the residual of the decomposition to the norm of the patch image at which the iteration ends.

_MOST = 60


def robust_components(matrix: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Low-rank and sparse part of a matrix: minimum of ||B||_* + ||T||_1 / sqrt(max(rows, columns)) with B + T = matrix.

    Parameters
    ----------
    matrix : ndarray, shape (m, n)
        Finite [any].

    Returns
    -------
    background, sparse : ndarray
        Both of the matrix's shape; they add up to it to ``TOLERANCE`` of its norm.
    """
    norm = float(np.linalg.norm(matrix))
    background, sparse = np.zeros_like(matrix), np.zeros_like(matrix)
    if norm == 0.0:
        return background, sparse
    weight = 1.0 / np.sqrt(max(matrix.shape))
    spectral = float(np.linalg.norm(matrix, 2))
    multiplier = matrix / max(spectral, float(np.abs(matrix).max()) / weight)
    penalty = 1.25 / spectral
    most = penalty * 1e7
    for _ in range(_MOST):
        rest = matrix - background + multiplier / penalty
        # Shrinkage towards 0: the step of the sum of magnitudes.
        sparse = np.sign(rest) * np.maximum(np.abs(rest) - weight / penalty, 0.0)
        u, s, v = np.linalg.svd(matrix - sparse + multiplier / penalty, full_matrices=False)
        rank = int((s > 1.0 / penalty).sum())
        # Singular values are lowered by the threshold, and those below it dropped.
        background = (u[:, :rank] * (s[:rank] - 1.0 / penalty)) @ v[:rank]
        residual = matrix - background - sparse
        multiplier += penalty * residual
        penalty = min(1.5 * penalty, most)
        if float(np.linalg.norm(residual)) < TOLERANCE * norm:
            break
    return background, sparse


@dataclass(frozen=True)
class PatchImage:
    """Detector from the sparse part of the matrix whose columns are the patches of a frame; overlapping patches are averaged.

    Parameters
    ----------
    patch : int
        Side of the square patches [px], at least 4.
    step : int
        Distance of neighbouring patches [px], 1 to ``patch``.

    Notes
    -----
    Singular values cost (pixels / step²) (patch²)² and more: some seconds for a frame of 512 x 512 with patches of 32 every 16 pixels.
    """

    patch: int = 32
    step: int = 16
    name: str = field(default="patch-image", init=False)
    lead: int = field(default=0, init=False)
    calibrated: bool = field(default=False, init=False)
    reach: None = field(default=None, init=False)
    linear: bool = field(default=False, init=False)
    null_law: None = field(default=None, init=False)

    def __post_init__(self) -> None:
        if self.patch < 4 or not 1 <= self.step <= self.patch:
            raise DomainError(f"patch = {self.patch} px and step = {self.step} px; patch >= 4 and 1 <= step <= patch are needed")

    def __call__(self, frames: Frames) -> Frames:
        """Sparse part, shape (k, rows, columns), unit of the input; NaN where the pixel is missing.

        Raises
        ------
        DomainError
            Frames smaller than a patch.
        """
        source = as_frames(frames)
        if min(source.shape[1:]) < self.patch:
            raise DomainError(f"frames of {source.shape[1]} x {source.shape[2]} px are smaller than a patch of {self.patch} px")
        tops, lefts = (_starts(n, self.patch, self.step) for n in source.shape[1:])
        out = np.empty_like(source)
        for k, frame in enumerate(filled(source)):
            image = frame.astype(np.float64)
            # Less its level: it would be the first singular value, and the tolerance a share of it.
            image -= image.mean()
            columns = [image[i : i + self.patch, j : j + self.patch].ravel() for i in tops for j in lefts]
            sparse = robust_components(np.stack(columns, axis=1))[1]
            total, number = np.zeros(image.shape), np.zeros(image.shape)
            for column, (i, j) in zip(sparse.T, ((i, j) for i in tops for j in lefts), strict=True):
                total[i : i + self.patch, j : j + self.patch] += column.reshape(self.patch, self.patch)
                number[i : i + self.patch, j : j + self.patch] += 1.0
            # Mean over the patches that overlap in a pixel.
            out[k] = np.where(np.isnan(source[k]), np.nan, total / number)
        return out


def _starts(length: int, patch: int, step: int) -> list[int]:
    """First pixels of patches that cover an axis, the last one flush with its end."""
    starts = list(range(0, length - patch + 1, step))
    return starts if starts[-1] == length - patch else [*starts, length - patch]
