"""Levels of a sounding as a file gives them, missing values as NaN."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from seaglint.air.profile.air_profile import saturation_density
from seaglint.base.conventions import FloatArray

MISSING: Final = (9999.0, 99999.0, 999.9, 999.99, -99.9, -999.0, -999.9, -9999.0, -8888.0, -99999.0, 9999.9, -32768.0, 32767.0)
"""Numbers that stand for a missing value."""

MISSING_TEXTS: Final = ("", "nan", "na", "n/a", "null", "none", "-", "--", "---", "///", "//", "m", "missing", "*", "****")
"""Texts that stand for a missing value."""

Humidity = Literal["dewpoint_k", "relative_humidity_percent", "mixing_ratio_g_kg", "specific_humidity"]

VAPOUR_CONSTANT: Final = 461.5
"""Specific gas constant of water vapour [J kg-1 K-1]."""


@dataclass(frozen=True, eq=False)
class RawSounding:
    """Rows of a file.

    Attributes
    ----------
    kind : str
        Name of the format.
    pressure, height, temperature : ndarray
        [hPa], [m], [K]; NaN where missing.
    humidity : str
        Quantity of ``humidity_value``: dew point [K], relative humidity [%], mixing ratio [g kg-1], or specific humidity [kg kg-1].
    humidity_value : ndarray
        Its values.
    geopotential : bool
        True for geopotential heights.
    names : dict
        Columns of the file by quantity: pressure, height, temperature, humidity.
    notes : tuple of str
        What the reader chose.
    resolution : (float, float)
        Steps that pressures [hPa] and heights [m] are rounded to.
    """

    kind: str
    pressure: FloatArray
    height: FloatArray
    temperature: FloatArray
    humidity: Humidity
    humidity_value: FloatArray
    geopotential: bool
    names: dict[str, str]
    notes: tuple[str, ...] = ()
    resolution: tuple[float, float] = (0.1, 1.0)

    def kept(self, where: NDArray[np.bool_] | NDArray[np.intp]) -> RawSounding:
        """Return some of the levels."""
        return replace(
            self,
            pressure=self.pressure[where],
            height=self.height[where],
            temperature=self.temperature[where],
            humidity_value=self.humidity_value[where],
        )

    def relative_humidity(self) -> FloatArray:
        """Relative humidity over water [%], 0 to 100."""
        match self.humidity:
            case "relative_humidity_percent":
                out = self.humidity_value
            case "dewpoint_k":
                dew = np.minimum(self.humidity_value, self.temperature)
                out = 100.0 * saturation_density(dew) * dew / (saturation_density(self.temperature) * self.temperature)
            case _:
                ratio = 1e-3 * self.humidity_value
                if self.humidity == "specific_humidity":
                    ratio = self.humidity_value / (1.0 - self.humidity_value)
                partial = 100.0 * self.pressure * ratio / (0.62198 + ratio)
                saturated = 1e-3 * saturation_density(self.temperature) * VAPOUR_CONSTANT * self.temperature
                out = 100.0 * partial / saturated
        return np.asarray(np.clip(out, 0.0, 100.0))


def without_missing(values: FloatArray) -> FloatArray:
    """Return values with NaN for the numbers that stand for none."""
    out = np.array(values, dtype=np.float64)
    out[np.isin(out, MISSING)] = np.nan
    return out
