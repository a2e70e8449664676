"""Position of a detected object: centroid and least squares, with their errors in white noise.

Places are (row, column) from the centre of the patch's middle pixel [px].

References
----------
Kay 1993, Fundamentals of Statistical Signal Processing: Estimation Theory, ch. 3 (Cramer-Rao bound); Winick 1986, J. Opt. Soc. Am. A 3,
1809 (position of a spot in pixels).
"""

from __future__ import annotations

from typing import Final, Literal

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.detection.spot import SpotShape

Pointing = Literal["least-squares", "centroid"]

FARTHEST: Final = 1.0  #: Displacement from the brightest pixel beyond which a fit is rejected [px].

_STEP = 1e-3
_ITERATIONS = 8


def border_level(patches: FloatArray) -> FloatArray:
    """Mean of the outermost pixels of each patch, shape (n,) [u]: a local level of the clutter."""
    n, side = patches.shape[:2]
    ring = np.ones((side, side), np.bool_)
    ring[1:-1, 1:-1] = False
    return np.asarray(patches[:, ring].mean(axis=1) if side > 2 else np.zeros(n))


def centroid(patches: FloatArray, level: FloatArray | float = 0.0) -> FloatArray:
    """Centre of gravity of each patch above its level, shape (n, 2) [px]; NaN where the sum above it is not positive.

    x = sum x (I - level) / sum (I - level)
    """
    above = patches - np.reshape(level, (-1, 1, 1))
    half = (patches.shape[1] - 1) / 2
    axis = np.arange(patches.shape[1]) - half
    total = above.sum(axis=(1, 2))
    with np.errstate(divide="ignore", invalid="ignore"):
        place = np.stack([(above.sum(axis=2) * axis).sum(axis=1), (above.sum(axis=1) * axis).sum(axis=1)], axis=1) / total[:, None]
    return np.where(total[:, None] > 0, place, np.nan)


def _derivatives(shape: SpotShape, place: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Shape and its derivatives with respect to row and column."""
    steps = _STEP * np.eye(2)
    down, right = ((shape.stamps(place + s) - shape.stamps(place - s)) / (2 * _STEP) for s in steps)
    return shape.stamps(place), down, right


def least_squares(patches: FloatArray, shape: SpotShape) -> FloatArray:
    """Position of the best fit of the shape with an amplitude and a constant level to each patch, shape (n, 2) [px].

    Gauss-Newton steps on the place from the middle of the patch; amplitude and level are solved for at each. Places farther than
    :data:`FARTHEST` from the middle are given as NaN: noise has a brighter pixel.

    Parameters
    ----------
    patches : ndarray, shape (n, 2 half + 1, 2 half + 1)
        Around the brightest pixel of each object [u].
    shape : SpotShape
        Shape of the object, with that ``half``.
    """
    n = patches.shape[0]
    values = patches.reshape(n, -1)
    place = np.zeros((n, 2))
    for _ in range(_ITERATIONS):
        s, down, right = (d.reshape(n, -1) for d in _derivatives(shape, place))
        # Amplitude and level first, then the step of the place with both free as well: columns S, 1, A dS/drow, A dS/dcolumn.
        centred = s - s.mean(axis=1, keepdims=True)
        amplitude = (centred * values).sum(axis=1) / np.maximum((centred**2).sum(axis=1), 1e-300)
        design = np.stack([s, np.ones_like(s), amplitude[:, None] * down, amplitude[:, None] * right], axis=2)
        normal = np.einsum("npi,npj->nij", design, design)
        # A vanishing amplitude leaves the place undetermined: the ridge keeps its step at 0.
        normal += 1e-12 * np.trace(normal, axis1=1, axis2=2)[:, None, None] * np.eye(4)
        step = np.linalg.solve(normal, np.einsum("npi,np->ni", design, values)[:, :, None])[:, 2:, 0]
        place = np.clip(place + np.clip(step, -0.5, 0.5), -2 * FARTHEST, 2 * FARTHEST)
    near = np.abs(place).max(axis=1) < FARTHEST
    return np.where(near[:, None], place, np.nan)
