"""Reader of a sonde's ascent or descent in NetCDF: ARM's ``sondewnpn``, AVAPS drops and their like, one level a record."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any, Final

import numpy as np

from seaglint.base.errors import DataError
from seaglint.files.soundings.ozone_columns import OzoneColumn, ozone_columns, with_ozone
from seaglint.files.soundings.raw_sounding import RawSounding
from seaglint.files.soundings.sounding_columns import SoundingColumn, plain_unit, sounding_column, sounding_of

#: Dimensions of gridded analyses, which are no sondes.
LEVEL_DIMENSIONS: Final = ("pressure_level", "level", "isobaricInhPa", "plev", "isobaric")

ROUNDED: Final = {"pressure": 0.1, "height": 1.0}  #: Steps to which sondes' pressures [hPa] and heights [m] are rounded at most.


def is_sonde(data: Any) -> bool:
    """Return true for a dataset whose pressures and temperatures are records along one dimension."""
    if any(name in data.dims and name in data.variables for name in LEVEL_DIMENSIONS):
        return False
    kinds = {column.kind for column in _columns(data)}
    return {"pressure", "temperature"} <= kinds


def _columns(data: Any) -> list[SoundingColumn]:
    """Variables that hold a quantity of a sounding, by name and unit."""
    out = []
    for place, name in enumerate(map(str, data.variables)):
        variable = data[name]
        if variable.ndim == 0 or not np.issubdtype(variable.dtype, np.number):
            continue
        unit = str(variable.attrs.get("units", ""))
        column = sounding_column(place, name, plain_unit(unit))
        if column is None:
            column = sounding_column(place, str(variable.attrs.get("standard_name", "")), plain_unit(unit))
        if column is not None:
            out.append(replace(column, name=name))
    return out


def numeric_variables(data: Any) -> tuple[list[str], list[str]]:
    """Return the names of all variables of a dataset, empty for those without levels of numbers, and their units."""
    names, units = [], []
    for name in map(str, data.variables):
        levels = data[name].ndim > 0 and np.issubdtype(data[name].dtype, np.number)
        names.append(name if levels else "")
        units.append(str(data[name].attrs.get("units", "")))
    return names, units


def read_sonde(path: Path, data: Any) -> RawSounding:
    """Read the records of one sonde.

    Raises
    ------
    DataError
        Variables missing, or several sondes in one file.
    """
    columns, numbers = _columns(data), {}
    names, units = numeric_variables(data)
    ozone = ozone_columns(path, names, units, what="variable")
    read: list[SoundingColumn | OzoneColumn] = [*columns, *ozone]
    for column in read:
        variable = data[column.name]
        long = [str(name) for name in variable.dims if variable.sizes[name] > 1]
        if len(long) > 1:
            raise DataError(f"{path}: {column.name} has the dimensions {', '.join(long)}; give a file of one sonde")
        numbers[column.place] = np.asarray(variable.values, dtype=np.float64).ravel()
    missing = [what for what in ("pressure", "height", "temperature", "humidity") if what not in {c.quantity for c in columns}]
    if missing:
        raise DataError(f"{path}: variables are {', '.join(str(v) for v in data.variables)}; missing: {', '.join(missing)}")
    if len({v.size for v in numbers.values()}) > 1:
        sizes = ", ".join(f"{column.name} {numbers[column.place].size}" for column in read)
        raise DataError(f"{path}: its variables differ in length ({sizes}); give a file of one sonde")
    geopotential = any(
        "geopotential" in str(data[column.name].attrs.get("long_name", "")).lower() for column in columns if column.kind == "height"
    )
    steps = {column.place: ROUNDED.get(column.kind, 1.0) / column.factor for column in columns}
    attributes = " ".join(str(value) for value in data.attrs.values() if isinstance(value, str)).lower()
    form = "AVAPS (NetCDF)" if "avaps" in attributes else "ARM sonde (NetCDF)" if "base_time" in data.variables else "sonde (NetCDF)"
    return with_ozone(sounding_of(form, columns, numbers, steps, geopotential=geopotential), ozone, numbers)
