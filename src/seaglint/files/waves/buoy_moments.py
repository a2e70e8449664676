"""Directional moments of buoys: from mean and principal direction and the lengths r1 and r2, as NDBC gives them.

Directions alpha1 and alpha2 are where waves come FROM, in degrees clockwise from north, and r1 and r2 the lengths of the two moments, in
0-1 or, in historical files, in hundredths.
"""

from __future__ import annotations

from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError
from seaglint.files.waves.bands import DirectionalMoments

LengthUnit = Literal["ones", "hundredths", "unknown"]  #: Unit of r1 and r2 as the file says it.

_NINES: Final = (99.0, 999.0, 9999.0)
_CERTAIN: Final = 2.0  # lengths that all are at most 0.02 are of no sea


def energy_known(energy: FloatArray) -> FloatArray:
    """Return energies with NaN for those written as nines; a storm has densities above 99 m²/Hz, so only 99, 999 and 9999 count."""
    return np.where(np.isin(energy, _NINES), np.nan, energy)


def moments_of(
    frequency: FloatArray, energy: FloatArray, columns: tuple[FloatArray, FloatArray, FloatArray, FloatArray], unit: LengthUnit, what: str
) -> DirectionalMoments:
    """Return the moments of alpha1, alpha2 [deg, from], r1 and r2; NaN where one of the four is missing.

    Raises
    ------
    DataError
        r1 or r2 that are impossible in their unit, or whose unit cannot be decided.
    """
    alpha1, alpha2, r1, r2 = columns
    known = np.all([np.isfinite(c) & ~np.isin(c, _NINES[1:]) for c in columns], axis=0)
    known &= (alpha1 >= 0.0) & (alpha1 <= 360.0) & (alpha2 >= 0.0) & (alpha2 <= 360.0)
    known &= ~np.all([c == _NINES[0] for c in columns], axis=0)  # one such value may be a direction of 99 deg or a length of 0.99
    scale = _scale([r[known] for r in (r1, r2)], unit, what)
    if scale == 1.0:
        known &= ~(_coded(r1) | _coded(r2))
    first = scale * r1 * np.exp(1j * (np.radians(alpha1) + np.pi))  # from -> to; the second moment does not know the difference
    second = scale * r2 * np.exp(2j * np.radians(alpha2))
    return DirectionalMoments(frequency, energy, *(np.where(known, c, np.nan) for c in (first, second)))


def _coded(lengths: FloatArray) -> NDArray[np.bool_]:
    """Return true for lengths that, unless in hundredths, are missing: 99, and the 9.99 that a division by 100 makes of 999."""
    return np.asarray((lengths == _NINES[0]) | np.isclose(lengths, 0.01 * _NINES[1]))


def _scale(lengths: list[NDArray[np.float64]], unit: LengthUnit, what: str) -> float:
    """Return the factor that makes lengths 0 to 1."""
    if any(np.any(r < 0.0) for r in lengths):
        raise DataError(f"{what}: r1 or r2 is negative, and 0-1 (or hundredths) is allowed; check the file")
    largest = [float(np.max(r[~_coded(r)], initial=0.0)) for r in lengths]
    if max(largest) <= 1.0:
        if unit == "hundredths" and max(largest) > 0.0:
            raise DataError(f"{what}: r1 and r2 are at most {max(largest):g}, and the file says hundredths; correct their unit to 1")
        return 1.0
    if unit == "ones":
        raise DataError(
            f"{what}: r1 or r2 above 1; realtime files have them in 0-1, historical ones (41010w2019.txt) in hundredths: divide by 100"
        )
    if max(largest) > 100.0 or any(0.0 < value <= _CERTAIN for value in largest):
        shown = " and ".join(f"{value:g}" for value in largest)
        raise DataError(f"{what}: r1 and r2 reach {shown}, which is neither 0-1 nor hundredths for both; give both in 0-1 or in hundredths")
    return 0.01
