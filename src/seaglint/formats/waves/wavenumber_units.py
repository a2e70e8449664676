"""Units that NetCDF files of wavenumber spectra state: what is converted, and what contradicts the name of a variable.

A unit is one of those below in any usual spelling (``rad m**-1``, ``radians per metre``). Without the attribute ``units`` the name of the
variable is the unit. Densities are per unit of the file's wavenumber, so that ``cpm`` beside ``wavenumber_rad_m`` is a contradiction.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

from seaglint.base.errors import DataError
from seaglint.formats.waves.ndbc_buoys import unit_of

#: Spellings beside those of the reader of buoys.
_WORDS: Final = ((r"rad(?:ian)?s?", "rad"), (r"cyc(?:le)?s?", "cycle"), (r"³", "3"), (r"deg(?:ree)?s?|°", "deg"))

_ONE: Final = {"": 1.0, "1": 1.0, "-": 1.0, "none": 1.0, "dimensionless": 1.0, "nondimensional": 1.0, "unitless": 1.0}

_PER_LENGTH: Final = ("1/m", "m-1", "/m")  # rad/m or cycle/m, as the name says

#: Unit that is read, and the factor to it from each unit that a file may state, by variable.
_UNITS: Final[Mapping[str, tuple[str, Mapping[str, float]]]] = {
    "wavenumber_rad_m": ("rad/m", dict.fromkeys(("", "rad/m", "radm-1", *_PER_LENGTH), 1.0)),
    "wavenumber_cycles_m": ("cycle/m", dict.fromkeys(("", "cycle/m", "cyclem-1", "cpm", *_PER_LENGTH), 1.0)),
    "saturation": ("1 or %", {**_ONE, "%": 0.01, "percent": 0.01}),
    "elevation_m3": ("m3", dict.fromkeys(("", "m3"), 1.0)),
    "slope_m": ("m", dict.fromkeys(("", "m"), 1.0)),
    "wind_speed_m_s": (
        "m/s, knots or km/h",
        {
            **dict.fromkeys(("", "m/s", "ms-1"), 1.0),
            **dict.fromkeys(("kn", "kt", "kts", "knot", "knots"), 1852.0 / 3600.0),
            **dict.fromkeys(("km/h", "kmh-1", "kmhr-1"), 1.0 / 3.6),
        },
    ),
    "delta": ("1", _ONE),
    "half_width_deg": ("degrees", {"": 1.0, "deg": 1.0}),
}

#: Densities per unit of a wavenumber, as files spell them behind the unit of the variance.
_PER: Final = {
    "wavenumber_rad_m": ("/rad/m", "/radm-1", "m/rad", "mrad-1"),
    "wavenumber_cycles_m": ("/cycle/m", "/cyclem-1", "m/cycle", "mcycle-1", "/cpm", "cpm-1"),
}

#: Unit of the variance itself; the slope's may be stated as an angle.
_VARIANCE: Final = {"elevation_m3": ("m2",), "slope_m": ("", "1", "rad2")}

_OTHER: Final = {"wavenumber_rad_m": "wavenumber_cycles_m", "wavenumber_cycles_m": "wavenumber_rad_m"}


def unit_factor(path: Path, data: Any, name: str, wavenumber: str) -> float:
    """Return the factor from a variable of a file to the unit of its name [1].

    Parameters
    ----------
    path : Path
        File, for the error.
    data : xarray.Dataset
        Its variables.
    name, wavenumber : str
        Names of the variable, and of the wavenumber of the file.

    Returns
    -------
    float

    Raises
    ------
    DataError
        A unit that is not read, or contradicts the name of the variable or the wavenumber.

    Examples
    --------
    >>> import xarray as xr
    >>> data = xr.Dataset({"wind_speed_m_s": ("wind", [10.0], {"units": "knots"})})
    >>> round(unit_factor(Path("a.nc"), data, "wind_speed_m_s", "wavenumber_rad_m"), 4)
    0.5144
    """
    wanted, factors = _UNITS[name]
    unit = unit_of(data, name)
    for pattern, plain in _WORDS:
        unit = re.sub(pattern, plain, unit)
    if unit in factors:
        return factors[unit]
    stated = str(data[name].attrs["units"])
    # the same unit beside the other wavenumber is the contradiction
    for kind, ends in _PER.items():
        if name in _VARIANCE and unit in {variance + end for variance in _VARIANCE[name] for end in ends}:
            if kind == wavenumber:
                return 1.0
            raise DataError(f"{path}: {name} is in '{stated}' and the wavenumber is {wavenumber}, another unit; convert one of them")
    other = _OTHER.get(name)
    if other is not None and unit in _UNITS[other][1]:
        raise DataError(f"{path}: {name} is in '{stated}', and {wanted} is read; name it {other}, or convert it")
    raise DataError(f"{path}: {name} is in '{stated}', and {wanted} is read; convert it, or correct its attribute units")
