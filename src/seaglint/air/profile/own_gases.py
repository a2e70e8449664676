"""Gases of one's own in a profile: today's carbon dioxide, or what somebody measured.

References
----------
Lan, X., P. Tans and K. W. Thoning, Trends in globally-averaged CO2, NOAA Global Monitoring Laboratory: 424.6 ppmv at Mauna Loa in 2024.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from seaglint.air.profile.air_profile import GASES, AirProfile, air_molecules, sum_between
from seaglint.air.profile.band_numbers import Spectroscopy
from seaglint.base.conventions import FloatArray

TODAY_CO2_PPMV: Final = 425.0  #: Carbon dioxide of today [1e-6 of the volume of dry air]; LOWTRAN7's models have 330.

_DOBSON: Final = 2.6867e16  #: Molecules per cm2 of 1 Dobson unit.

GRAM_PER_HPA: Final = 216.68  #: Water vapour of 1 hPa at 1 K [g m-3].


@dataclass(frozen=True)
class OwnGases:
    """Gases that replace those of a profile; None leaves the profile's."""

    co2_ppmv: float | None = None  #: Of dry air, the same at all heights.
    #: ``ch4_ppmv``, ``n2o_ppmv``: Of dry air, at the lowest level; above in proportion to the profile's.
    ch4_ppmv: float | None = None
    n2o_ppmv: float | None = None
    ozone_du: float | None = None  #: Column from the sea up [Dobson units].

    def of(self, spectroscopy: Spectroscopy) -> OwnGases:
        """Return the gases with carbon dioxide of today, unless LOWTRAN7's numbers go with LOWTRAN7's gases."""
        return replace(self, co2_ppmv=TODAY_CO2_PPMV) if self.co2_ppmv is None and spectroscopy != "lowtran7" else self


def dry_share(profile: AirProfile) -> FloatArray:
    """Part of the molecules of a profile's air that is not water vapour [1, (levels,)]."""
    return np.asarray(1.0 - profile.vapour * profile.temperature / GRAM_PER_HPA / profile.pressure)


def ozone_column(profile: AirProfile) -> float:
    """Ozone of a profile from its lowest level up [Dobson units], exponential between levels."""
    molecules = air_molecules(profile.pressure, profile.temperature) * 1e-6 * profile.gas[GASES.index("O3")]
    return 100.0 * sum_between(profile.height, molecules) / _DOBSON


def with_gases(profile: AirProfile, gases: OwnGases) -> AirProfile:
    """Return the profile with gases of one's own.

    >>> from seaglint.air.profile.air_profile import model_profile
    >>> air = with_gases(model_profile("us-standard-1976"), OwnGases(co2_ppmv=425.0, ozone_du=300.0))
    >>> round(float(air.gas[1, -1])), round(ozone_column(air))
    (425, 300)
    """
    if gases == OwnGases():
        return profile
    gas, dry = profile.gas.copy(), dry_share(profile)
    if gases.co2_ppmv is not None:
        gas[GASES.index("CO2")] = gases.co2_ppmv * dry
    for name, ppmv in (("CH4", gases.ch4_ppmv), ("N2O", gases.n2o_ppmv)):
        if ppmv is not None:
            row = GASES.index(name)
            gas[row] *= ppmv * dry[0] / gas[row, 0]
    if gases.ozone_du is not None:
        gas[GASES.index("O3")] *= gases.ozone_du / ozone_column(profile)
    return replace(profile, gas=gas)
