"""Slope statistics against wind speed from satellite images of glint over the ocean (Bréon and Henriot 2006).

Bréon and Henriot, "Spaceborne observations of ocean glint reflectance and modeling of wave slope distributions",
J. Geophys. Res. 111, C06005 (2006): eight million observations of POLDER, winds at 10 m of a scatterometer.
"""

from __future__ import annotations

import math
from typing import Final

from seaglint.base.limits import BREON_HENRIOT_WIND
from seaglint.sea.slopes.slope_statistics import SlopeStatistics, joined_in_calm
from seaglint.sea.spectra.combined import LIGHTEST
from seaglint.sea.wind_profile import require_wind, u10_of_wind

_CROSSING: Final = 0.002 / (0.00316 - 0.00185)  #: Wind at 10 m where the fits along and across the wind cross [m/s]: 1.53.


def breon_henriot(wind_speed: float, wind_to_azimuth: float, *, height: float = 10.0, extrapolate: bool = False) -> SlopeStatistics:
    """Slope statistics of the open ocean, with skewness (steep lee faces above 4 m/s) and peakedness.

    ``mss_up = 0.001 + 0.00316 W``, ``mss_cross = 0.003 + 0.00185 W``, ``c21 = -9.1e-4 W^2``, ``c03 = -0.45/(1 + exp(7 - W))``,
    ``c40 = 0.3``, ``c22 = 0.12``, ``c04 = 0.4``, ``W`` the wind at 10 m. Below 1.53 m/s, where the fit has more variance across the
    wind than along it, both have half of the total and the coefficients fall to 0, :mod:`seaglint.sea.slopes.slope_statistics`.

    Parameters
    ----------
    wind_speed : float
        Neutral wind speed at ``height`` [m s⁻¹]; 0-15 m/s.
    wind_to_azimuth : float
        Azimuth the wind blows TO, clockwise from north [rad].
    height : float
        Height at which ``wind_speed`` holds [m].
    extrapolate : bool
        Whether winds beyond that range are accepted.

    Returns
    -------
    SlopeStatistics

    Raises
    ------
    DomainError
        For winds outside 0-15 m/s, unless ``extrapolate``.

    References
    ----------
    Bréon and Henriot 2006.

    Examples
    --------
    >>> slopes = breon_henriot(7.0, 0.0)
    >>> round(slopes.mss_up, 5), round(slopes.mss_cross, 5), round(slopes.c03, 3)
    (0.02312, 0.01595, -0.225)
    """
    if not extrapolate:
        require_wind(
            wind_speed, BREON_HENRIOT_WIND, model="the Breon-Henriot fit", advice="choose another slope model or pass extrapolate = true"
        )
    require_wind(wind_speed)
    wind = wind_speed if height == 10.0 else u10_of_wind(wind_speed, height)
    skewness = -0.45 / (1.0 + math.exp(7.0 - wind))
    variances = (0.001 + 0.00316 * wind, 0.003 + 0.00185 * wind)
    return joined_in_calm(variances, (-9.1e-4 * wind**2, skewness, 0.3, 0.12, 0.4), wind_to_azimuth, (wind, _CROSSING, LIGHTEST))
