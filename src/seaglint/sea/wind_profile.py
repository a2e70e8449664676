"""Neutral wind profile over the sea: friction velocity and wind speed at other heights than 10 m."""

from __future__ import annotations

import math
from typing import Final

from scipy.optimize import brentq

from seaglint.base.constants import GRAVITY, VON_KARMAN
from seaglint.base.errors import DomainError
from seaglint.base.limits import WIND_PROFILE

FULLY_DEVELOPED: Final = 0.84  #: Inverse wave age U10/cp of a fully developed sea (Elfouhaily et al. 1997).


def require_wind(
    wind_speed: float, allowed: tuple[float, float] = WIND_PROFILE, *, model: str = "the wind profile", advice: str = ""
) -> None:
    """Raise ``DomainError`` unless ``wind_speed`` [m/s] is finite and inside the closed interval ``allowed``."""
    if not (math.isfinite(wind_speed) and allowed[0] <= wind_speed <= allowed[1]):
        text = f"wind speed = {wind_speed:g} m/s is outside {allowed[0]:g}-{allowed[1]:g} m/s of {model}"
        raise DomainError(
            f"{text}; {advice}" if advice else f"{text}; give a value in that range", name="wind_speed", value=wind_speed, allowed=allowed
        )


def roughness_length(u10: float, inverse_wave_age: float = FULLY_DEVELOPED) -> float:
    """Aerodynamic roughness length of the sea.

    ``z0 = 3.7e-5 (U10^2/g) (U10/cp)^0.9``

    Parameters
    ----------
    u10 : float
        Neutral wind speed at 10 m [m s⁻¹].
    inverse_wave_age : float
        U10 over the phase speed of the spectral peak; 0.84 for a fully developed sea.

    Returns
    -------
    float
        Roughness length [m].

    References
    ----------
    Donelan et al. 1993 (J. Phys. Oceanogr. 23, 2143), in the form used by Elfouhaily et al. 1997 (J. Geophys. Res. 102, 15781).
    """
    require_wind(u10)
    return 3.7e-5 * (u10 * u10) / GRAVITY * float(inverse_wave_age**0.9)


def friction_velocity(u10: float, inverse_wave_age: float = FULLY_DEVELOPED) -> float:
    """Friction velocity of the air over the sea.

    ``u* = kappa U10 / ln(10 m / z0)``

    Parameters
    ----------
    u10 : float
        Neutral wind speed at 10 m [m s⁻¹].
    inverse_wave_age : float
        See :func:`roughness_length`.

    Returns
    -------
    float
        Friction velocity [m s⁻¹]; 0 without wind.

    Examples
    --------
    >>> round(friction_velocity(10.0), 3)
    0.396
    """
    require_wind(u10)
    if u10 == 0.0:
        return 0.0
    return VON_KARMAN * u10 / math.log(10.0 / roughness_length(u10, inverse_wave_age))


def wind_at_height(u10: float, height: float, inverse_wave_age: float = FULLY_DEVELOPED) -> float:
    """Neutral wind speed at ``height`` by the logarithmic law.

    ``U(z) = (u*/kappa) ln(z/z0)``

    Parameters
    ----------
    u10 : float
        Neutral wind speed at 10 m [m s⁻¹].
    height : float
        Height above the sea [m]; 1-100 m.
    inverse_wave_age : float
        See :func:`roughness_length`.

    Returns
    -------
    float
        Wind speed [m s⁻¹].

    Raises
    ------
    DomainError
        For heights outside the surface layer, where the law does not hold.

    Examples
    --------
    >>> round(wind_at_height(10.0, 12.5), 3)
    10.216
    """
    if not 1.0 <= height <= 100.0:
        raise DomainError(
            f"height = {height:g} m is outside 1-100 m of the logarithmic wind profile; give a height in that range",
            name="height",
            value=height,
            allowed=(1.0, 100.0),
        )
    require_wind(u10)
    if u10 == 0.0:
        return 0.0
    return u10 + friction_velocity(u10, inverse_wave_age) / VON_KARMAN * math.log(height / 10.0)


def u10_of_wind(wind_speed: float, height: float, inverse_wave_age: float = FULLY_DEVELOPED) -> float:
    """Wind speed at 10 m whose logarithmic profile has ``wind_speed`` [m/s] at ``height`` [m]; inverse of :func:`wind_at_height`."""
    require_wind(wind_speed)
    if wind_speed == 0.0:
        return 0.0

    def excess(u10: float) -> float:
        return wind_at_height(u10, height, inverse_wave_age) - wind_speed

    if excess(WIND_PROFILE[1]) < 0.0:
        raise DomainError(
            f"wind speed = {wind_speed:g} m/s at {height:g} m means more than {WIND_PROFILE[1]:g} m/s at 10 m; give a lower wind",
            name="wind_speed",
            value=wind_speed,
            allowed=WIND_PROFILE,
        )
    # the wind at any height grows with the wind at 10 m, so that there is one root
    return float(brentq(excess, 0.0, WIND_PROFILE[1], xtol=1e-10))
