"""Holes in foam: a pattern by which a share of foam is divided into foam and water, with the same mean.

The pattern has values spread evenly between 0 and 1, so that a place whose share is F is foam where the pattern is below F. Its structures
are a few decimetres to some metres large, and it drifts with the water.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Final

import numpy as np
from numpy.typing import NDArray

from seaglint.base.jit import kernel
from seaglint.base.random import stream

CELL_M: Final = 0.125  #: Size of the cells of the pattern [m].

SIZE: Final = 512  #: Cells along a side of the pattern, which repeats.

SOFT: Final = 0.6  #: Range of shares over which foam passes into water [1]; 0 makes each place foam or water.

FADED_M: Final = 2.0  #: Width of a reading from which on its foam is the share alone [m].

_LARGEST: Final = 48.0  #: Length of the largest structures [cells].


@lru_cache(maxsize=4)
def lace_pattern(seed: int) -> NDArray[np.float32]:
    """Return the pattern of a seed, values [1, (SIZE, SIZE)]; read-only."""
    white = stream(seed, "foam lace").standard_normal((SIZE, SIZE))
    frequency = np.hypot(*np.meshgrid(np.fft.fftfreq(SIZE), np.fft.fftfreq(SIZE)))
    # variance falls with the frequency to the power -2.4 between the largest structures and those of some three cells
    amplitude = (frequency**2 + _LARGEST**-2) ** -0.6 * np.exp(-0.5 * (frequency / 0.2) ** 2)
    smooth = np.fft.ifft2(np.fft.fft2(white) * amplitude).real
    rank = np.empty(smooth.size, np.float32)
    rank[np.argsort(smooth, axis=None)] = (np.arange(smooth.size) + 0.5) / smooth.size
    out = rank.reshape(smooth.shape)
    out.flags.writeable = False
    return out


@kernel
def laced(share: float, value: float, width: float) -> float:
    """Return the share of foam at a place with a ``value`` of the pattern, for a reading of a ``width`` [m]."""
    if share <= 0.0 or share >= 1.0 or width >= FADED_M:
        return share
    soft = max(min(SOFT, 2.0 * share, 2.0 * (1.0 - share)), 1e-6)
    foam = min(max((share - value) / soft + 0.5, 0.0), 1.0)
    return foam + width / FADED_M * (share - foam)
