"""Levels of a sounding as a file gives them, missing values as NaN."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from seaglint.air.profile.air_profile import saturation_density
from seaglint.base.conventions import FloatArray

#: Numbers that stand for a missing value of any quantity.
MISSING: Final = (9999.0, 99999.0, -999.0, -999.9, -999.99, -9999.0, -9999.9, -8888.0, -99999.0, 9999.9, -32768.0, 32767.0)

#: Further numbers that stand for a missing pressure, temperature or humidity; a height of -99 m may be real.
BELOW_ZERO: Final = (-99.0, -99.9, -99.99, -888.0)

#: Further numbers that stand for a missing temperature or humidity; 999.9 hPa and 999 m may be real.
BEYOND_AIR: Final = (999.0, 999.9, 999.99)

Quantity = Literal["pressure", "height", "temperature", "humidity"]

LARGEST: Final = 1e9  #: Numbers beyond are fill values such as 1e20.

#: Texts that stand for a missing value, in lower case; so do texts of nothing but ``-``, ``/``, ``*`` or ``.``.
MISSING_TEXTS: Final = frozenset({"", "nan", "na", "n/a", "null", "none", "m", "missing", "nil"})

Humidity = Literal["dewpoint_k", "relative_humidity_percent", "mixing_ratio_g_kg", "specific_humidity"]

VAPOUR_CONSTANT: Final = 461.5  #: Specific gas constant of water vapour [J kg-1 K-1].


@dataclass(frozen=True, eq=False)
class RawSounding:
    """Rows of a file."""

    kind: str  #: Name of the format.
    #: ``pressure``, ``height``, ``temperature``: [hPa], [m], [K]; NaN where missing.
    pressure: FloatArray
    height: FloatArray
    temperature: FloatArray
    #: Quantity of ``humidity_value``: dew point [K], relative humidity [%], mixing ratio [g kg-1], or specific humidity [kg kg-1].
    humidity: Humidity
    humidity_value: FloatArray  #: Its values, NaN where missing.
    geopotential: bool  #: True for geopotential heights.
    names: dict[str, str]  #: Columns of the file by quantity: pressure, height, temperature, humidity, and ozone where it has that.
    notes: tuple[str, ...] = ()  #: What the reader chose.
    resolution: tuple[float, float] = (0.1, 1.0)  #: Steps that pressures [hPa] and heights [m] are rounded to.
    ozone: FloatArray | None = None  #: Ozone, NaN where missing; None for files without it.
    ozone_unit: str = "ppmv"  #: Its unit, ``ppmv`` for parts per million of the volume of air.

    def kept(self, where: NDArray[np.bool_] | NDArray[np.intp]) -> RawSounding:
        """Return some of the levels."""
        return replace(
            self,
            pressure=self.pressure[where],
            height=self.height[where],
            temperature=self.temperature[where],
            humidity_value=self.humidity_value[where],
            ozone=None if self.ozone is None else self.ozone[where],
        )

    def relative_humidity(self) -> FloatArray:
        """Relative humidity over water [%], 0 to 100; NaN where missing."""
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


def with_other_humidity(raw: RawSounding, other: Humidity, values: FloatArray) -> RawSounding:
    """Return a sounding whose levels without humidity have that of another quantity of the file, as relative humidity.

    Parameters
    ----------
    raw : RawSounding
        The sounding.
    other : str
        The other quantity.
    values : ndarray
        Its values, NaN where missing.
    """
    gaps = ~np.isfinite(raw.humidity_value)
    further = replace(raw, humidity=other, humidity_value=values).relative_humidity()
    count = int(np.sum(gaps & np.isfinite(further)))
    if not count:
        return raw
    both = np.where(gaps, further, raw.relative_humidity())
    note = f"{count} levels without {raw.names['humidity']} have the humidity of another column"
    return replace(raw, humidity="relative_humidity_percent", humidity_value=both, notes=(*raw.notes, note))


def without_missing(values: FloatArray, what: Quantity) -> FloatArray:
    """Return values of a quantity with NaN for the numbers that stand for none."""
    out = np.array(values, dtype=np.float64)
    none = MISSING if what == "height" else (*MISSING, *BELOW_ZERO) if what == "pressure" else (*MISSING, *BELOW_ZERO, *BEYOND_AIR)
    out[np.isin(out, none) | (np.abs(out) > LARGEST)] = np.nan
    return out


def others_left(count: int) -> str:
    """Return the end of a note on a choice.

    >>> others_left(1), others_left(3)
    ('1 other is left', '3 others are left')
    """
    return f"{count} other is left" if count == 1 else f"{count} others are left"


def is_missing_text(text: str) -> bool:
    """Return true for a text that stands for a missing value.

    >>> is_missing_text("/////"), is_missing_text("-99")
    (True, False)
    """
    return text.lower() in MISSING_TEXTS or set(text) <= {text[0]} <= set("-/*.")
