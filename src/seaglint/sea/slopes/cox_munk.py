"""Slope statistics of clean and slick seas against wind speed, from photographs of sun glitter (Cox and Munk 1954).

Cox and Munk, "Measurement of the roughness of the sea surface from photographs of the Sun's glitter", J. Opt. Soc. Am. 44, 838 (1954).
Their wind was measured at 41 ft (12.5 m), from 0.7 to 14 m/s; the straight lines are commonly used from 0 to 20 m/s.
"""

from __future__ import annotations

from functools import cache
from typing import Final

from seaglint.base.limits import COX_MUNK_SLICK_WIND, COX_MUNK_WIND
from seaglint.sea.slopes.slope_statistics import SlopeStatistics, joined_in_calm
from seaglint.sea.spectra.combined import LIGHTEST
from seaglint.sea.wind_profile import require_wind, u10_of_wind, wind_at_height

WIND_HEIGHT: Final = 12.5  #: Height of Cox and Munk's wind measurement [m].

_CROSSING: Final = 0.003 / (0.00316 - 0.00192)  #: Wind at 12.5 m where the fits along and across the wind cross [m/s]: 2.42.

#: Wind at 12.5 m below which the slick fit has more variance along the wind than a clean sea [m/s]: 1.99.
_SLICK_JOIN: Final = (0.005 - 0.0015) / (0.5 * (0.00316 + 0.00192) - 0.00078)


_GAUSSIAN: Final = (0.0, 0.0, 0.0, 0.0, 0.0)


def _fit_wind(
    wind_speed: float, height: float, extrapolate: bool, valid: tuple[float, float] = COX_MUNK_WIND, model: str = "the Cox-Munk fit"
) -> float:
    """Wind speed at the measurement height of the fit [m/s]."""
    if not extrapolate:
        require_wind(wind_speed, valid, model=model, advice="choose another slope model or pass extrapolate = true")
    if height == WIND_HEIGHT:
        require_wind(wind_speed)
        return wind_speed
    return wind_at_height(u10_of_wind(wind_speed, height), WIND_HEIGHT)


@cache
def _lightest() -> float:
    """Lightest wind of wind seas at the measurement height of the fit [m/s]: 0.51."""
    return wind_at_height(LIGHTEST, WIND_HEIGHT)


def _clean(wind: float) -> tuple[float, float]:
    """Variances of the fits of a clean sea along and across a wind at 12.5 m [1]."""
    return 0.00316 * wind, 0.003 + 0.00192 * wind


def cox_munk_isotropic(wind_speed: float, *, height: float = 10.0, extrapolate: bool = False) -> SlopeStatistics:
    """Slope statistics of a clean sea, Gaussian and isotropic.

    ``mss = 0.003 + 0.00512 W``, half of it in each direction, ``W`` the wind at 12.5 m.

    Parameters
    ----------
    wind_speed : float
        Neutral wind speed at ``height`` [m s⁻¹]; 0-20 m/s.
    height : float
        Height at which ``wind_speed`` holds [m]. 12.5 takes the number unchanged, as the source article does.
    extrapolate : bool
        Whether winds beyond the range of the fit are accepted.

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
    half = 0.5 * (0.003 + 0.00512 * _fit_wind(wind_speed, height, extrapolate))
    return SlopeStatistics(half, half)


def cox_munk_anisotropic(wind_speed: float, wind_to_azimuth: float, *, height: float = 10.0, extrapolate: bool = False) -> SlopeStatistics:
    """Slope statistics of a clean sea, Gaussian, with different variances along and across the wind.

    ``mss_up = 0.00316 W + 0.000``, ``mss_cross = 0.003 + 0.00192 W``, ``W`` the wind at 12.5 m.

    Below 2.42 m/s the fit has more variance across the wind than along it, and none along it at 0 m/s. There both have half of its total,
    ``0.0015 + 0.00254 W``, :mod:`seaglint.sea.slopes.slope_statistics`.

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
    return joined_in_calm(_clean(wind), _GAUSSIAN, wind_to_azimuth, (wind, _CROSSING, _lightest()))


def cox_munk_gram_charlier(
    wind_speed: float, wind_to_azimuth: float, *, height: float = 10.0, extrapolate: bool = False
) -> SlopeStatistics:
    """Slope statistics of a clean sea with skewness (steep lee faces) and peakedness.

    Variances of :func:`cox_munk_anisotropic`; ``c21 = 0.01 - 0.0086 W``, ``c03 = 0.04 - 0.033 W``, ``c40 = 0.40``, ``c22 = 0.12``,
    ``c04 = 0.23``, ``W`` the wind at 12.5 m. Below 2.42 m/s the coefficients are multiplied with ``W / 2.42``: Gaussian at 0 m/s.

    Parameters
    ----------
    wind_speed, wind_to_azimuth, height, extrapolate
        As in :func:`cox_munk_anisotropic`.

    Returns
    -------
    SlopeStatistics

    Raises
    ------
    DomainError
        For winds outside 0-20 m/s, unless ``extrapolate``.

    Notes
    -----
    The photographs show slopes to about 2.5 standard deviations. Far out the series turns negative, which counts as 0 and adds to
    the integral of the density: 8e-6 at 10 m/s, 6e-4 at 15, 2.2e-3 at 20 m/s (winds at 12.5 m).

    References
    ----------
    Cox and Munk 1954, Eq. 18 and the fits for a clean surface.

    Examples
    --------
    >>> slopes = cox_munk_gram_charlier(10.0, 0.0, height=12.5)
    >>> round(slopes.c21, 3), round(slopes.c03, 2)
    (-0.076, -0.29)
    """
    wind = _fit_wind(wind_speed, height, extrapolate)
    coefficients = (0.01 - 0.0086 * wind, 0.04 - 0.033 * wind, 0.40, 0.12, 0.23)
    return joined_in_calm(_clean(wind), coefficients, wind_to_azimuth, (wind, _CROSSING, _lightest()))


def cox_munk_slick(wind_speed: float, wind_to_azimuth: float, *, height: float = 10.0, extrapolate: bool = False) -> SlopeStatistics:
    """Slope statistics of a sea under an oil slick, which damps waves shorter than about 0.3 m.

    ``mss_up = 0.005 + 0.00078 W``, ``mss_cross = 0.003 + 0.00084 W``, ``c21 = 0``, ``c03 = 0.02``, ``c40 = 0.36``, ``c22 = 0.10``,
    ``c04 = 0.26``, ``W`` the wind at 12.5 m. Below 1.99 m/s, where the fit has more variance along the wind than a clean sea, each
    variance is the smaller one of both seas and the coefficients fall to 0, :mod:`seaglint.sea.slopes.slope_statistics`.

    Parameters
    ----------
    wind_speed : float
        Neutral wind speed at ``height`` [m s⁻¹]; 0-14 m/s.
    wind_to_azimuth, height, extrapolate
        As in :func:`cox_munk_anisotropic`.

    Returns
    -------
    SlopeStatistics

    Raises
    ------
    DomainError
        For winds outside 0-14 m/s, unless ``extrapolate``.

    References
    ----------
    Cox and Munk 1954, the fits for a slick surface.

    Examples
    --------
    >>> slopes = cox_munk_slick(10.0, 0.0, height=12.5)
    >>> round(slopes.mss_up, 4), round(slopes.mss_cross, 4)
    (0.0128, 0.0114)
    """
    wind = _fit_wind(wind_speed, height, extrapolate, COX_MUNK_SLICK_WIND, "the Cox-Munk fit of a slick sea")
    up, cross = 0.005 + 0.00078 * wind, 0.003 + 0.00084 * wind
    if wind < _SLICK_JOIN:
        clean = 0.5 * sum(_clean(wind))
        up, cross = min(up, clean), min(cross, clean)
    return joined_in_calm((up, cross), (0.0, 0.02, 0.36, 0.10, 0.26), wind_to_azimuth, (wind, _SLICK_JOIN, _lightest()))
