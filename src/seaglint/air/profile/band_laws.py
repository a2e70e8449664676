r"""Optical depth of absorber amounts in channels: continua and band laws of LOWTRAN7's form.

.. math:: d(\nu) = \sum_k c_k(\nu) W_k + \sum_b (C_b(\nu) W_b)^{a_b}

Lines of a band saturate (``a_b < 1``): the depth of a way is that of its whole amounts, not a sum over its parts.

References
----------
Pierluissi, J. H., and C. E. Maragoudakis (1986), AFGL-TR-86-0272; LOWTRAN7's subroutines TRANS, DBLTX and O2CONT.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray

from seaglint.air.profile.band_numbers import BandNumbers, Spectroscopy, band_numbers
from seaglint.air.profile.lowtran_numbers import channels_of, lowtran_numbers
from seaglint.air.scattering.gas_bands import CONTINUA, DEEPEST, GasBands
from seaglint.base.conventions import FloatArray

#: LOWTRAN7's numbers of all absorbers linear in the amount: those that scattered light passes, and O2.
LINEAR: Final = (*CONTINUA, 63, 1, 2)


@dataclass(frozen=True, eq=False)
class BandLaws:
    """Laws of some channels. Make them with :meth:`of`."""

    wavenumber_cm: FloatArray  #: [cm-1, (n,)].
    continuum: FloatArray  #: Coefficients in the order of :data:`LINEAR` [(10, n)].
    gases: GasBands  #: Bands.
    source: FloatArray  #: Sunlight outside the air at 1 au [W m-2 per cm-1, (n,)].
    numbers: BandNumbers  #: Exponents of the amounts, and where the numbers are from.

    @classmethod
    def of(cls, wavenumber_cm: FloatArray, spectroscopy: Spectroscopy = "lblrtm") -> BandLaws:
        """Laws of channels of the file [cm-1, (n,)].

        Raises
        ------
        DomainError
            Channels that the file does not hold.
        """
        keep, held = channels_of(wavenumber_cm), band_numbers(spectroscopy)
        gases = GasBands.of(held.column[:, keep], held.power[:, keep], held.log_coefficient[:, keep])
        return cls(wavenumber_cm, held.continuum[:, keep], gases, lowtran_numbers()["source"][keep], held)

    @cached_property
    def cold_kelvin(self) -> float:
        """Temperature of the law by which water's own continuum grows in cold air [K]; 0 for LOWTRAN7's."""
        return self.numbers.cold_law(self.wavenumber_cm)

    @cached_property
    def columns(self) -> list[int]:
        """Numbers of continua and bands, in the order of amounts."""
        return [*LINEAR, *self.gases.numbers]

    def optical_depth(self, amount: FloatArray) -> FloatArray:
        """Optical depth [1, (ways, n)] of amounts [(ways, columns)] in the order of :attr:`columns`."""
        column, power, coefficient = self._grown
        rows = amount[:, len(LINEAR) :]
        depth = amount[:, : len(LINEAR)] @ self.continuum + np.maximum(rows[:, column], 0.0) ** power @ coefficient
        return np.asarray(np.clip(depth, 0.0, DEEPEST))

    @cached_property
    def _grown(self) -> tuple[NDArray[np.int64], FloatArray, FloatArray]:
        """Columns and powers of the amounts that saturate, and their coefficients on all channels [(laws, n)].

        One matrix product over all channels, most of them 0, is faster than a sum over stretches of channels.
        """
        laws = sorted({(band.column, band.power) for band in self.gases.bands})
        coefficient = np.zeros((len(laws), self.wavenumber_cm.size))
        for band in self.gases.bands:
            coefficient[laws.index((band.column, band.power)), band.where] += band.coefficient
        return np.array([law[0] for law in laws], np.int64), np.array([law[1] for law in laws]), coefficient
