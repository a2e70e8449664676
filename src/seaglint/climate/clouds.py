"""Probability that clouds do not hide the Sun from the sea: by their cover, only when overcast, or along slanting lines of sight."""

from __future__ import annotations

import math
from typing import Final, Literal

import numpy as np
from numpy.typing import ArrayLike

from seaglint.base.conventions import FloatArray

#: Law of the probability of a free Sun: 1 - cover; 1 unless the sky is overcast; or by :func:`clear_line`.
CloudLaw = Literal["cover", "overcast", "line-of-sight"]

OVERCAST: Final = 0.99  #: Least cover of an overcast sky [1]: reports in eighths and fractions rounded to hundredths mean 1 by it.


def clear_line(cover: ArrayLike, elevation: ArrayLike, aspect: float) -> FloatArray:
    r"""Probability that a line of sight at an elevation meets no cloud.

    .. math:: P = (1 - N)^{1 + \frac{4}{\pi}\,a\,\cot e}

    Upright cylinders whose height is ``a`` times their width, strewn without regard to each other, and N the share of the sea that they
    stand over: the shadow of one is its base and its side, ``pi w^2/4 + w h cot(e)``, and chances of none are powers of each other.

    Parameters
    ----------
    cover : array_like
        N, share of the sky covered as seen from straight below [1].
    elevation : array_like
        Elevation of the line of sight [rad]; broadcast. At 0 and below no line is clear under any cloud.
    aspect : float
        a, height of clouds over their width [1]; 0 is :data:`CloudLaw` ``"cover"``.

    Examples
    --------
    >>> round(float(clear_line(0.5, np.radians(45.0), np.pi / 4)), 3)
    0.25
    """
    free, up = 1.0 - np.asarray(cover, dtype=np.float64), np.asarray(elevation, dtype=np.float64)
    cotangent = 1.0 / np.tan(np.clip(up, 1e-6, 0.5 * math.pi))
    return np.asarray(np.clip(free, 0.0, 1.0) ** (1.0 + 4.0 / math.pi * aspect * np.maximum(cotangent, 0.0)))


def illuminated(law: CloudLaw, cover: ArrayLike, elevation: ArrayLike, *, overcast: float = OVERCAST, aspect: float = 0.5) -> FloatArray:
    """Probability that the Sun is not hidden by clouds [1], by one of the laws; parameters as in :func:`clear_line`.

    >>> illuminated("overcast", [0.9, 1.0], 0.5).tolist()
    [1.0, 0.0]
    """
    n = np.asarray(cover, dtype=np.float64)
    match law:
        case "cover":
            return np.asarray(np.clip(1.0 - n, 0.0, 1.0) + 0.0 * np.asarray(elevation))
        case "overcast":
            return np.asarray(np.where(n >= overcast, 0.0, 1.0) + 0.0 * np.asarray(elevation))
        case "line-of-sight":
            return clear_line(n, elevation, aspect)
