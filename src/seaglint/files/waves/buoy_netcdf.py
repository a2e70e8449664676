"""Variables of a buoy's NetCDF with what their attributes say: units, the sense of directions, and which north.

An attribute that is missing or empty says nothing, and the format's own convention holds. One that changes the meaning of the numbers is
honoured where that is certain, else refused.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any, Final

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError
from seaglint.files.waves.buoy_moments import LengthUnit

_WORDS: Final = (
    (r"met(?:er|re)s?", "m"),
    (r"squared|\^2|\*\*2|²", "2"),
    (r"hertz", "hz"),
    (r"seconds?|sec\b", "s"),
    (r"\bper\b", "/"),
    (r"⁻¹|\^-1|\*\*-1", "-1"),
    (r"m\s*\*\s*m\b", "m2"),
    (r"[\s()\[\]*.·_^]", ""),
)
_DENSITIES: Final = {"m2/hz", "m2hz-1", "m2s", "m2/(hz)", "m2/s-1"}
_FREQUENCIES: Final = {"hz", "s-1", "1/s", "/s", "cycles/s", "cyclespersecond"}
_DEGREES: Final = re.compile(r"(?:deg(?:ree)?s?|°)(?:t|true|fromtrue(?:north)?|truenorth|clockwisefromtrue(?:north)?)?")
_ONES: Final = {"1", "-", "none", "dimensionless", "nondimensional", "unitless"}
_HUNDREDTHS: Final = {"%", "percent", "hundredths", "0.01", "1e-2", "1e-02", "10-2"}
_MAGNETIC: Final = re.compile(r"magnetic north|degrees? magnetic|\bdeg_?M\b|relative to magnetic", re.IGNORECASE)
_FILLED: Final = -999.0  # -999, -999.9, -999.99 and -9999, where no attribute says that it is a fill value


def unit_of(data: Any, name: str) -> str:
    """Return the units of a variable, spelled in one way; empty where the file does not say.

    Examples
    --------
    >>> import xarray as xr
    >>> [unit_of({"S": xr.DataArray(0.0, attrs={"units": u})}, "S") for u in ("meter^2 second", "(meter * meter)/Hz", "m**2 Hz**-1")]
    ['m2s', 'm2/hz', 'm2hz-1']
    """
    text = str(data[name].attrs.get("units", "")).strip().lower()
    for pattern, plain in _WORDS:
        text = re.sub(pattern, plain, text)
    return text


def numbers_of(data: Any, name: str) -> FloatArray:
    """Return the values of a variable as floats; NaN where they are filled with -999 or below."""
    values = np.asarray(data[name].values, dtype=np.float64)
    return np.where(values <= _FILLED, np.nan, values)


def frequency_of(data: Any, name: str, path: Path) -> FloatArray:
    """Return frequencies [Hz]; other units are refused."""
    unit = unit_of(data, name)
    if unit and unit not in _FREQUENCIES:
        raise DataError(f"{path}: {name} is in '{data[name].attrs['units']}', and Hz is read; convert it")
    return np.asarray(data[name].values, dtype=np.float64)


def energy_of(data: Any, name: str, path: Path) -> FloatArray:
    """Return energy densities [m² Hz⁻¹]; other units are refused."""
    unit = unit_of(data, name)
    if unit and unit not in _DENSITIES:
        raise DataError(f"{path}: {name} is in '{data[name].attrs['units']}', and m2/Hz is read; convert it")
    return numbers_of(data, name)


def degrees_of(data: Any, name: str, path: Path) -> FloatArray:
    """Return directions as the file has them [deg]; other units, and magnetic north, are refused."""
    attributes = data[name].attrs
    said = " ".join(str(attributes.get(key, "")) for key in ("units", "long_name", "standard_name", "description", "comment", "reference"))
    if _MAGNETIC.search(said) and "true" not in said.lower():
        raise DataError(f"{path}: {name} is relative to magnetic north, and true north is read; add the declination and say degrees_true")
    unit = unit_of(data, name)
    if unit and not _DEGREES.fullmatch(unit):
        raise DataError(f"{path}: {name} is in '{attributes['units']}', and degrees clockwise from true north are read; convert it")
    return numbers_of(data, name)


def travels_to(data: Any, name: str) -> bool:
    """Return true where the standard name of directions says that waves travel TO them."""
    return "to_direction" in str(data[name].attrs.get("standard_name", ""))


def from_degrees_of(data: Any, name: str, path: Path) -> FloatArray:
    """Return directions waves come FROM [deg, 0 to 360], turned where the file says that they travel TO them."""
    values = degrees_of(data, name, path)
    return np.where(values <= 360.0, (values + 180.0) % 360.0, values) if travels_to(data, name) else values


def length_unit_of(data: Any, names: tuple[str, str], path: Path) -> LengthUnit:
    """Return the unit of r1 and r2 as their attributes say it."""
    units = {unit_of(data, name) for name in names}
    said = " ".join(str(data[name].attrs.get(key, "")) for name in names for key in ("long_name", "description", "comment")).lower()
    ones, hundredths = units & _ONES, units & _HUNDREDTHS
    if units - _ONES - _HUNDREDTHS - {""} or (ones and hundredths):
        raise DataError(
            f"{path}: {' and '.join(names)} are in {', '.join(map(repr, sorted(units)))}; 1 or % for both is read: convert them"
        )
    if hundredths:
        return "hundredths"
    return "ones" if ones or "nondimensional" in said or "dimensionless" in said else "unknown"
