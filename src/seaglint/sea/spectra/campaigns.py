"""Measured seas of two campaigns, as tables of the saturation: the Air-Sea Interaction Tower in 2019, and RaDyO in 2008.

Below 2 cm the slope variances of the two differ by eight to nineteen times at one wind; which is right is not known. Their sources and what
is known of their errors are in the lines before each table.

``asit-2019``: saturation at 19 winds from 2.69 to 17.6 m/s and 0.003 to 1378 rad/m. Its row at 2.69 m/s has more slope variance than the
next; it is one of a light wind over older waves, and is kept as measured. The rows at 15.7 and 17.6 m/s begin at 2.25 rad/m.

``radyo-2008``: slope variances in bands of 20 to 1000 rad/m, medians of the records in four classes of wind. The saturation is even within
a band, ``B = mss/ln(k2/k1)``, and changes at its edge over ``_STEP`` of the wavenumber.

References
----------
N. J. M. Laxague et al., IEEE Trans. Geosci. Remote Sens., 2025, doi 10.1109/TGRS.2025.3538460.
"""

from __future__ import annotations

from functools import cache
from importlib.resources import files
from typing import Final, Literal, get_args

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError
from seaglint.sea.spectra.directional import DirectionalSpectrum
from seaglint.sea.spectra.saturation_table import SaturationRow, SaturationTable

Campaign = Literal["asit-2019", "radyo-2008"]

CAMPAIGNS: Final[tuple[Campaign, ...]] = get_args(Campaign)  #: Names of the measured seas.

_STEP: Final = 1e-4  # share of the wavenumber over which the saturation changes between two bands: 1e-4 of a band's energy at most


def _columns(name: Campaign) -> FloatArray:
    text = files("seaglint.sea").joinpath("data", f"{name.replace('-', '_')}.csv").read_text(encoding="utf-8")
    lines = [line for line in text.splitlines() if not line.startswith("#")]
    return np.loadtxt(lines, delimiter=",", skiprows=1, dtype=np.float64).T


@cache
def campaign_table(name: Campaign) -> SaturationTable:
    """Table of a campaign.

    Examples
    --------
    >>> campaign_table("radyo-2008").rows[1].wavenumber.round(0).tolist()[:4]
    [20.0, 50.0, 50.0, 100.0]
    """
    if name not in CAMPAIGNS:
        raise DomainError(
            f"{name!r} is no measured sea; choose {' or '.join(CAMPAIGNS)}", name="name", value=name, allowed=", ".join(CAMPAIGNS)
        )
    columns = _columns(name)
    rows = []
    for wind in np.unique(columns[0]):
        chosen = columns[1:, columns[0] == wind]
        if name == "asit-2019":
            rows.append(SaturationRow(chosen[0], chosen[1], float(wind)))
        else:
            rows.append(_even(chosen[0], chosen[1], chosen[2], float(wind)))
    return SaturationTable(tuple(rows), name)


def _even(low: FloatArray, high: FloatArray, mss: FloatArray, wind: float) -> SaturationRow:
    """Return the row of bands side by side within each of which the saturation is even."""
    first, last = low * (1.0 + 0.5 * _STEP), high * (1.0 - 0.5 * _STEP)
    first[0], last[-1] = low[0], high[-1]
    level = mss / np.log(high / low)
    return SaturationRow(np.column_stack([first, last]).ravel(), np.repeat(level, 2), wind)


def campaign_winds(name: Campaign) -> FloatArray:
    """Winds of a campaign's table [m s⁻¹, (n,)], ascending; between them spectra are interpolated.

    Examples
    --------
    >>> campaign_winds("asit-2019").size
    19
    """
    return campaign_table(name).winds


def campaign_spectrum(name: Campaign, wind: float, wind_to_azimuth: float = 0.0) -> DirectionalSpectrum:
    """Spectrum of a campaign's sea at a wind [m s⁻¹] that blows TO an azimuth [rad]; its table's ``at`` has more choices.

    Raises
    ------
    DomainError
        A wind outside the campaign's.

    Examples
    --------
    >>> [round(sum(campaign_spectrum(name, 7.0).mss(1000.0, 300.0)), 4) for name in CAMPAIGNS]
    [0.001, 0.0135]
    """
    return campaign_table(name).at(wind, wind_to_azimuth)
