"""Slope variances of the clean sea against wind speed, from photographs of sun glitter (Cox and Munk 1954).

Cox and Munk, "Measurement of the roughness of the sea surface from photographs of the Sun's glitter", J. Opt. Soc. Am. 44, 838 (1954).
Their wind was measured at 41 ft (12.5 m), from 0.7 to 14 m/s; the straight lines are commonly used from 0 to 20 m/s.
"""

from __future__ import annotations

from typing import Final

from seaglint.sea.slopes import SlopeStatistics
from seaglint.sea.wind import require_wind, u10_of_wind, wind_at_height

WIND_HEIGHT: Final = 12.5
"""Height of Cox and Munk's anemometer [m]."""

VALID_WIND: Final = (0.0, 20.0)
"""Wind speeds for which the fit is used without asking [m/s]."""


def _fit_wind(wind_speed: float, height: float, extrapolate: bool) -> float:
    """Wind speed at the anemometer height of the fit [m/s]."""
    if not extrapolate:
        require_wind(wind_speed, VALID_WIND, model="the Cox-Munk fit", advice="choose another slope model or pass extrapolate = true")
    if height == WIND_HEIGHT:
        require_wind(wind_speed)
        return wind_speed
    return wind_at_height(u10_of_wind(wind_speed, height), WIND_HEIGHT)


def cox_munk_isotropic(wind_speed: float, *, height: float = 10.0, extrapolate: bool = False) -> SlopeStatistics:
    """Slopes of a clean sea, the same in all directions.

    ``mss = 0.003 + 0.00512 W``, half of it in each direction, ``W`` the wind at 12.5 m.

    Parameters
    ----------
    wind_speed : float
        Neutral wind speed at ``height`` [m s⁻¹]; 0-20 m/s.
    height : float
        Height at which ``wind_speed`` holds [m]. 12.5 takes the number as it is (the source article's way).
    extrapolate : bool
        Accept winds beyond the range of the fit.

    Returns
    -------
    SlopeStatistics

    Raises
    ------
    DomainError
        For winds outside 0-20 m/s, unless ``extrapolate``.

    References
    ----------
    Cox and Munk 1954, their fit for the total variance of a clean surface.

    Examples
    --------
    >>> round(cox_munk_isotropic(10.0, height=12.5).mss, 4)
    0.0542
    """
    wind = _fit_wind(wind_speed, height, extrapolate)
    half = 0.5 * (0.003 + 0.00512 * wind)
    return SlopeStatistics(half, half)


def cox_munk_anisotropic(wind_speed: float, wind_to_azimuth: float, *, height: float = 10.0, extrapolate: bool = False) -> SlopeStatistics:
    """Slopes of a clean sea, Gaussian, with different variances along and across the wind.

    ``mss_up = 0.00316 W + 0.000``, ``mss_cross = 0.003 + 0.00192 W``, ``W`` the wind at 12.5 m.

    Below 2.4 m/s the fit has more variance across the wind than along it, and none along it at 0 m/s: as printed.

    Parameters
    ----------
    wind_speed : float
        Neutral wind speed at ``height`` [m s⁻¹]; 0-20 m/s.
    wind_to_azimuth : float
        Azimuth the wind blows TO, clockwise from north [rad].
    height, extrapolate
        As in :func:`cox_munk_isotropic`.

    Returns
    -------
    SlopeStatistics

    Raises
    ------
    DomainError
        For winds outside 0-20 m/s, unless ``extrapolate``.

    References
    ----------
    Cox and Munk 1954, their fits for a clean surface.

    Examples
    --------
    >>> slopes = cox_munk_anisotropic(10.0, 0.0, height=12.5)
    >>> round(slopes.mss_up, 4), round(slopes.mss_cross, 4)
    (0.0316, 0.0222)
    """
    wind = _fit_wind(wind_speed, height, extrapolate)
    return SlopeStatistics(0.00316 * wind, 0.003 + 0.00192 * wind, wind_to_azimuth)
