"""View angles at which a sweep evaluates the sea instead of a picture's pixels."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from seaglint.base.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError
from seaglint.facet.sea_view import sea_arc
from seaglint.scenario.records.quantity import convert
from seaglint.studies.sweep.swept_keys import plain_values

ZENITH: Final = "view_zenith_deg"
AZIMUTH: Final = "view_azimuth_deg"

#: Attributes of the coordinates.
ATTRIBUTES: Final = {
    ZENITH: {"units": "degree", "long_name": "zenith angle, at the sea, of the direction to the sensor; 0 is straight down"},
    AZIMUTH: {"units": "degree", "long_name": "azimuth of the line of sight at the sensor, clockwise from north"},
}

_RANGES: Final = {ZENITH: (0.0, 90.0), AZIMUTH: (-360.0, 360.0)}


@dataclass(frozen=True)
class ViewAngles:
    """Angles of lines of sight to the sea. Make them with :meth:`of`."""

    zenith_deg: tuple[float, ...]  #: Zenith angles, at the sea, of the direction to the sensor [deg].
    #: Azimuths of the lines of sight, clockwise from north [deg]; the sensor's own where there are none.
    azimuth_deg: tuple[float, ...] | None = None

    @classmethod
    def of(cls, given: Mapping[str, Any] | ViewAngles | None) -> ViewAngles | None:
        """Return the angles of a mapping; None without one.

        Raises
        ------
        DataError
            Unknown names, no zenith angles, or angles outside 0 to 90 deg and -360 to 360 deg.

        Examples
        --------
        >>> ViewAngles.of({"view_zenith_deg": [0, "0.5 rad"]}).zenith_deg[0]
        0.0
        """
        if given is None or isinstance(given, ViewAngles):
            return given
        unknown = sorted(set(given) - {ZENITH, AZIMUTH})
        if unknown:
            raise DataError(f"at: {unknown[0]} is unknown; give {ZENITH} and {AZIMUTH}")
        if ZENITH not in given:
            raise DataError(f"at: {ZENITH} is missing; give zenith angles at the sea, 0 to below 90 deg")
        zenith = _angles(ZENITH, given[ZENITH])
        return cls(zenith, _angles(AZIMUTH, given[AZIMUTH]) if AZIMUTH in given else None)

    @property
    def dims(self) -> tuple[str, ...]:
        """Names of the dimensions."""
        return (ZENITH,) if self.azimuth_deg is None else (ZENITH, AZIMUTH)

    def elevations(self, height: float) -> FloatArray:
        """Elevations of the lines of sight at a sensor's height [m] [rad, (zeniths,)]."""
        gamma = 0.5 * np.pi - np.radians(np.array(self.zenith_deg))
        return np.asarray(-(gamma + sea_arc(height, gamma) / EFFECTIVE_EARTH_RADIUS))


def _angles(name: str, given: Any) -> tuple[float, ...]:
    given = plain_values(given)
    values = list(given) if isinstance(given, Sequence | np.ndarray) and not isinstance(given, str) else [given]
    low, high = _RANGES[name]
    out: list[float] = []
    for value in values:
        try:
            angle = convert(value, "deg") if isinstance(value, str) else float(value)
        except (TypeError, ValueError) as error:
            text = f" {error}" if isinstance(value, str) else "; give numbers"
            raise DataError(f"at: {name} = {value!r}{text}") from None
        if not (low <= angle <= high) or (name == ZENITH and angle == high):
            allowed = "0 to below 90 deg; lines of sight from 90 deg on do not meet the sea" if name == ZENITH else "-360 to 360 deg"
            raise DataError(f"at: {name} = {angle:g} is outside the allowed range: {allowed}")
        if angle in out:
            raise DataError(f"at: {name} = {angle:g} is given twice; give each angle once")
        out.append(angle)
    if not out:
        raise DataError(f"at: {name} has no values; give at least one")
    return tuple(out)
