r"""Slopes of a sea in light winds, where fits to the wind lose their meaning: without wind no direction is left.

The straight lines through measured slope variances end at 0 m/s in a sea that no one has seen: Cox and Munk's has 0.003 across the wind
and nothing along it, so that the picture would hang on where no wind comes from. Below the winds at which a fit stops to make sense
slopes follow from what was measured, and no further number is needed:

- Waves are never steeper across the wind than along it. Cox and Munk's ratio of the crosswind variance to the upwind one lies between
  0.54 and 1.0 in their photographs (mean 0.75), in light winds too. Below the wind at which the lines cross, 2.42 m/s, both directions have
  half of the fit's total: 0.003 in all at 0 m/s, which Cox and Munk's isotropic law has too.
- A film damps waves and never makes them. In no direction has a slick sea more slope variance than a clean one.
- Skewness and peakedness are the wind's. They fall in proportion to the wind below the same speed, to a Gaussian sea in a calm.
- Wind seas of the models end at 0.5 m/s. From there to 0 the direction of long waves, which the law of shadowing takes into account,
  falls in proportion to the wind (:attr:`~seaglint.sea.slopes.slope_statistics.SlopeStatistics.directed`).

At most 0.0015 is so moved from one direction to the other, at 0 m/s; Cox and Munk state 0.002 (across) and 0.004 (along) as the standard
deviations of their observations from the lines. Above the joining wind a fit is used as published.

References
----------
Cox and Munk 1954, J. Opt. Soc. Am. 44, 838: straight lines, their standard deviations, and the range of the ratio.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final

from seaglint.sea.slopes.slope_statistics import SlopeStatistics

RESIDUAL: Final = 0.003  #: Slope variance of a clean sea without wind, in all directions together [1]: Cox and Munk's total at 0 m/s.

#: Lightest wind at 10 m that the models of wind seas allow [m/s]; below it waves lose their direction in proportion to the wind.
LIGHTEST: Final = 0.5


def joined_in_calm(
    variances: tuple[float, float],
    coefficients: tuple[float, float, float, float, float],
    wind_to_azimuth: float,
    winds: tuple[float, float, float],
) -> SlopeStatistics:
    """Return the slopes of a fit at a wind, without direction at 0 m/s and as published from ``join`` on.

    Parameters
    ----------
    variances : tuple of float
        Variances of the fit along and across the wind [1].
    coefficients : tuple of float
        Gram-Charlier coefficients of the fit, (c21, c03, c40, c22, c04) [1].
    wind_to_azimuth : float
        Azimuth the wind blows TO [rad].
    winds : tuple of float
        Wind, the wind from which the fit holds, and the lightest wind of wind seas (:data:`LIGHTEST` at 10 m), all at the height of the
        fit [m s⁻¹].

    Examples
    --------
    >>> calm = joined_in_calm((0.0, 0.003), (0.01, 0.04, 0.4, 0.12, 0.23), 1.0, (0.0, 2.42, 0.51))
    >>> calm.is_isotropic, calm.mss
    (True, 0.003)
    """
    wind, join, lightest = winds
    if wind >= join:
        return SlopeStatistics(*variances, wind_to_azimuth, *coefficients)
    up, cross = variances
    if cross > up:
        up = cross = 0.5 * (up + cross)
    c21, c03, c40, c22, c04 = (wind / join * coefficient for coefficient in coefficients)
    return SlopeStatistics(up, cross, wind_to_azimuth, c21, c03, c40, c22, c04, directed=min(wind / lightest, 1.0))


def at_least_residual(slopes: SlopeStatistics) -> SlopeStatistics:
    """Return slopes of a wind sea with at least half of :data:`RESIDUAL` in every direction, as a sea without wind has.

    Examples
    --------
    >>> calm = at_least_residual(SlopeStatistics(0.0, 0.0))
    >>> calm.is_isotropic, calm.mss
    (True, 0.003)
    """
    least = 0.5 * RESIDUAL
    if min(slopes.mss_up, slopes.mss_cross) >= least:
        return slopes
    up, cross = max(slopes.mss_up, least), max(slopes.mss_cross, least)
    return replace(slopes, mss_up=up, mss_cross=cross, directed=slopes.mss / (up + cross))
