"""Absorption bands of gases as stretches of channels with one law each. Nothing here needs compiled kernels."""

from __future__ import annotations

from itertools import pairwise
from typing import Final

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray

DEEPEST: Final = 600.0
"""Optical depth beyond which nothing passes. Products of still smaller transmittances would be denormal numbers, which are slow."""


def gas_bands(column: NDArray[np.int64], power: FloatArray) -> list[tuple[int, int, int]]:
    """Return the bands of gases as (gas, first channel, end): channels of one column and one power; both [(gases, n)].

    >>> gas_bands(np.array([[0, 5, 5, 5, 6]]), np.array([[0.0, 0.5, 0.5, 0.6, 0.6]]))
    [(0, 1, 3), (0, 3, 4), (0, 4, 5)]
    """
    bands = []
    for gas, (numbers, powers) in enumerate(zip(column, power, strict=True)):
        edges = np.flatnonzero((np.diff(numbers) != 0) | (np.diff(powers) != 0.0)) + 1
        bands += [(gas, first, end) for first, end in pairwise([0, *edges.tolist(), numbers.size]) if numbers[first] > 0]
    return bands
