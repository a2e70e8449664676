"""Absorption bands of gases as ranges of channels with one law each, ``depth = (C W)**a``.

Optical depth in a channel is ``sum_k c_k W_k`` over continua and aerosols plus ``sum_b (C_b W_b)^a_b`` over absorption bands with lines
that saturate: the transmittance of a bent path Sun - point - sensor follows from its whole amount, not from a product of two
transmittances.

References
----------
LOWTRAN7's subroutines DBLTX and TRANS; Kneizys, F. X., et al. (1988), Users Guide to LOWTRAN 7, AFGL-TR-88-0177.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Final

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray

#: Optical depth beyond which nothing passes. Products of still smaller transmittances would be denormal numbers, which are slow.
DEEPEST: Final = 600.0


#: LOWTRAN7's numbers of absorbers linear in the amount: scattering by molecules, N2, water (296 K, colder, foreign), HNO3, O3.
CONTINUA: Final = (6, 4, 5, 9, 10, 11, 8)


@dataclass(frozen=True, eq=False)
class GasBand:
    """One band of a gas: the column of its amounts, its channels, ``depth = coefficient W**power`` [1, (channels,)]."""

    column: int
    where: slice
    power: float
    coefficient: FloatArray

    def cut(self, first: int, end: int) -> GasBand | None:
        """Return the band on consecutive channels, counted from the first of them, if it has any there."""
        low, high = max(self.where.start, first), min(self.where.stop, end)
        if low >= high:
            return None
        coefficient = self.coefficient[low - self.where.start : high - self.where.start]
        return GasBand(self.column, slice(low - first, high - first), self.power, coefficient)


@dataclass(frozen=True, eq=False)
class GasBands:
    """Bands of all gases on some channels, gas by gas. Make them with ``of``."""

    numbers: list[int]  #: Numbers of the scaled amounts, among which the bands' columns count from 0.
    bands: tuple[GasBand, ...]  #: Bands, gas by gas.

    @classmethod
    def of(cls, column: NDArray[np.int64], power: FloatArray, log_coefficient: FloatArray) -> GasBands:
        """Put channels of one amount and one power together.

        Per gas and channel: number of the scaled amount (0: no band), exponent of the amount, and the natural logarithm of coefficient to
        that power [(gases, n)].

        >>> gases = GasBands.of(np.array([[0, 5, 5, 5, 6]]), np.array([[0.0, 0.5, 0.5, 0.6, 0.6]]), np.zeros((1, 5)))
        >>> gases.numbers, [(band.column, band.where.start, band.where.stop) for band in gases.bands]
        ([5, 6], [(0, 1, 3), (0, 3, 4), (1, 4, 5)])
        """
        numbers = sorted({int(c) for c in np.unique(column)} - {0})
        bands = []
        for named, powers, log in zip(column, power, log_coefficient, strict=True):
            edges = np.flatnonzero((np.diff(named) != 0) | (np.diff(powers) != 0.0)) + 1
            bands += [
                GasBand(numbers.index(int(named[first])), slice(first, end), float(powers[first]), np.exp(log[first:end]))
                for first, end in pairwise([0, *edges.tolist(), named.size])
                if named[first] > 0
            ]
        return cls(numbers, tuple(bands))

    def cut(self, first: int, end: int) -> GasBands:
        """Return the bands on consecutive channels; their columns stay."""
        return GasBands(self.numbers, tuple(cut_band for cut_band in (band.cut(first, end) for band in self.bands) if cut_band is not None))
