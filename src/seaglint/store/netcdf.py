"""NetCDF files: opened in versions 3 and 4 with errors of one line, and maps written as one file of version 4, completely or not at all.

A file is made in memory and its bytes are written by Python: HDF5 that meets a full disk can end the process.
"""

from __future__ import annotations

import json
import sys
import traceback
import warnings
from collections.abc import Mapping
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from seaglint.base.errors import DataError
from seaglint.base.free_form import Attributes
from seaglint.base.schema import VARIABLES
from seaglint.store.outputs import moved_when_whole, reason_of, refuse_existing

if TYPE_CHECKING:
    import xarray as xr


NETCDF3: Final = (b"CDF\x01", b"CDF\x02")  #: First bytes of NetCDF 3, of 32-bit and of 64-bit offsets.

NETCDF_MAGIC: Final = (b"\x89HDF", *NETCDF3, b"CDF\x05")  #: First bytes of NetCDF files of any version.


#: Number of 16 bits that netCDF4 masks as missing wherever a variable has no ``_FillValue``, fill mode off or not: of counts the saturated
#: ones. A ``_FillValue`` that does not occur would keep them, and make xarray read floats.
MISTAKEN: Final = 65535


def open_netcdf(path: str | Path, **how: Any) -> xr.Dataset:
    """Open a NetCDF 4 or 3 file; keywords go to :func:`xarray.open_dataset`.

    Raises
    ------
    DataError
        Nothing there, another kind of file, or a damaged one.
    """
    import xarray as xr

    # The first bytes decide on the engine: names do not tell the version.
    magic = b""
    try:
        with open(path, "rb") as file:
            magic = file.read(4)
        if magic == b"CDF\x05":
            raise DataError(f"{path}: is NetCDF 3 with 64-bit data (CDF-5), which is not read; convert it: nccopy -k nc4 IN.nc OUT.nc")
        return xr.open_dataset(path, engine="scipy" if magic in NETCDF3 else "h5netcdf", **how)
    except DataError:
        raise
    except FileNotFoundError:
        raise DataError(f"{path}: no such file; give a NetCDF file") from None
    except Exception as error:  # h5py and xarray raise nearly anything for a file that is none
        reason = reason_of(error)
        drop_quietly(error)
        version = 3 if magic in NETCDF3 else 4
        raise DataError(f"{path}: cannot be read as NetCDF {version}, or is cut ({reason}); give a whole NetCDF file") from None


def drop_quietly(error: BaseException | None) -> None:
    """Discard a file that failed to open: h5netcdf and scipy would complain on standard error when it is collected."""
    before, sys.unraisablehook = sys.unraisablehook, lambda _: None
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RuntimeWarning)
            while error is not None:
                traceback.clear_frames(error.__traceback__)
                error = error.__cause__ or error.__context__
    finally:
        sys.unraisablehook = before


def labelled(dataset: xr.Dataset) -> xr.Dataset:
    """Return a dataset with units, names and CF names at the variables of ``seaglint.base.schema``; existing ones stay."""
    out = dataset.copy()
    for name in map(str, out.variables):
        if name in VARIABLES:
            out[name].attrs = {**VARIABLES[name].attributes, **out[name].attrs}
    return out


def plain_attributes(attributes: Mapping[Any, Any]) -> Attributes:
    """Return attributes that any file can hold: tables as JSON text, truth values as 0 and 1, no empty ones.

    >>> plain_attributes({"table": {"winds": [0, 20]}, "step": None, "whole": True})
    {'table': '{"winds": [0, 20]}', 'whole': 1}
    """
    out: Attributes = {}
    for name, value in attributes.items():
        if isinstance(value, bool):
            out[str(name)] = int(value)
        elif isinstance(value, Mapping) or (isinstance(value, list | tuple) and any(isinstance(part, Mapping | list) for part in value)):
            out[str(name)] = json.dumps(value)
        elif value is not None and not (isinstance(value, list | tuple) and len(value) == 0):
            out[str(name)] = value
    return out


def coordinate_encoding(dataset: xr.Dataset) -> dict[Any, dict[str, Any]]:
    """Return the encoding of coordinates and bounds that have all their values: no ``_FillValue``, which CF 1.11, 2.5.1, forbids them."""
    bounds = {values.attrs.get("bounds") for values in dataset.coords.values()}
    lines = {name: values for name, values in dataset.data_vars.items() if values.ndim < 2 or name in bounds}
    coordinates = {**dataset.coords, **lines}
    return {name: {"_FillValue": None} for name, values in coordinates.items() if not bool(values.isnull().any())}


def write_netcdf(dataset: xr.Dataset, output: str | Path, *, overwrite: bool = False) -> Path:
    """Write a dataset; variables named in ``seaglint.base.schema`` get their CF attributes.

    Unsigned integers of 16 bits that reach ``MISTAKEN`` are stored as integers of 32 bits.

    Raises
    ------
    DataError
        The output exists.
    StorageError
        No room or no rights; nothing is left behind.
    """
    from xarray.backends import H5NetCDFStore

    output = refuse_existing(output, overwrite=overwrite)
    images = [name for name, variable in dataset.data_vars.items() if variable.ndim >= 2]
    encoding = coordinate_encoding(dataset)
    for name, variable in dataset.data_vars.items():
        if variable.dtype == np.uint16 and bool((variable == MISTAKEN).any()):
            encoding[name] = {**encoding.get(name, {}), "dtype": "int32"}
        if name in images:
            encoding[name] = {**encoding.get(name, {}), "zlib": True, "complevel": 3}
    content = BytesIO()
    # As Dataset.to_netcdf, but without Dask's lock: importing Dask, where it is installed, takes 0.1 to 0.3 s.
    store = H5NetCDFStore.open(content, mode="w", lock=False)
    try:
        labelled(dataset).dump_to_store(store, encoding=encoding)
    finally:
        store.close()
    with moved_when_whole(output) as partial:
        partial.write_bytes(content.getbuffer())
    return output
