"""Share of the sea that is foam, against wind speed: fits to photographs and to the emission that satellites measure.

At one wind, measured coverages differ by a factor of ten and more: with the sea's age, swell, temperature and films on the water.

References
----------
Monahan and O'Muircheartaigh, J. Phys. Oceanogr. 10, 2094 (1980): photographs of 1971 and 1973, least squares and a robust fit.
Callaghan, de Leeuw, Cohen and O'Dowd, Geophys. Res. Lett. 35, L23609 (2008): videos of the North East Atlantic. Salisbury, Anguelova and
Brooks, J. Geophys. Res. Oceans 118, 6201 (2013): microwave emission at 10 GHz. The last two as quoted with their ranges by Albert,
Anguelova, Manders, Schaap and de Leeuw, Atmos. Chem. Phys. 16, 13725 (2016), Eqs. 2 and 5.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Final

from seaglint.base.errors import DomainError
from seaglint.base.limits import FOAM_WINDS
from seaglint.sea.wind_profile import require_wind


def _callaghan(wind: float) -> float:
    """Return Callaghan's coverage: two cubic fits whose ranges overlap from 9.25 to 11.25 m/s, joined where they cross (10.2 m/s)."""
    # The first fit is the lower one on its side of the crossing, and the second on the other side.
    return min(3.18e-5 * max(wind - 3.70, 0.0) ** 3, 4.82e-6 * (wind + 1.98) ** 3)


_LAWS: Final[Mapping[str, Callable[[float], float]]] = MappingProxyType(
    {
        "monahan-1980": lambda wind: 2.95e-6 * wind**3.52,
        "monahan-1980-robust": lambda wind: 3.84e-6 * wind**3.41,
        "callaghan-2008": _callaghan,
        "salisbury-2013": lambda wind: 4.6e-5 * wind**2.26,
    }
)


def coverage(law: str, wind_speed: float, *, extrapolate: bool = False) -> float:
    """Return the share of the sea that is foam.

    ==================== ====================================================== ==========
    law                  coverage at the wind U at 10 m                         winds
    ==================== ====================================================== ==========
    monahan-1980         2.95e-6 U^3.52                                         0-17 m/s
    monahan-1980-robust  3.84e-6 U^3.41                                         0-17 m/s
    callaghan-2008       3.18e-5 (U - 3.70)^3 to 10.2 m/s, 4.82e-6 (U + 1.98)^3 0-23.1 m/s
    salisbury-2013       4.6e-5 U^2.26                                          2-20 m/s
    ==================== ====================================================== ==========

    Parameters
    ----------
    law : {"monahan-1980", "monahan-1980-robust", "callaghan-2008", "salisbury-2013"}
        Name of the law.
    wind_speed : float
        Neutral wind speed at 10 m [m s⁻¹].
    extrapolate : bool
        Whether winds outside the range of the law are accepted.

    Returns
    -------
    float
        Coverage [1], at most 1.

    Raises
    ------
    DomainError
        For an unknown law, and for winds outside its range unless ``extrapolate``.

    Examples
    --------
    >>> round(coverage("monahan-1980", 10.0), 5), round(coverage("callaghan-2008", 10.0), 5)
    (0.00977, 0.00795)
    """
    if law not in _LAWS:
        raise DomainError(f"law = {law!r} is not known; allowed: {', '.join(_LAWS)}", name="law", value=law, allowed=", ".join(_LAWS))
    if not extrapolate:
        require_wind(wind_speed, FOAM_WINDS[law], model=f"the foam law {law}", advice="choose another law or pass extrapolate = true")
    require_wind(wind_speed)
    return min(_LAWS[law](wind_speed), 1.0)
