"""Maps as one NetCDF 4 file, written beside its place and moved there when whole.

The file is made in memory and its bytes are written by Python: HDF5 that meets a full disk can take the process with it.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from seaglint.errors import DataError
from seaglint.io.failures import storage_errors
from seaglint.schema import VARIABLES

if TYPE_CHECKING:
    import xarray as xr


def refuse_existing(output: str | Path, *, overwrite: bool = False) -> Path:
    """Path of an output file, checked before anything is computed."""
    output = Path(output)
    if not output.parent.is_dir():
        raise DataError(f"{output}: the folder {output.parent} does not exist; make it first")
    if output.is_dir():
        raise DataError(f"{output}: is a folder; give the name of a file")
    if output.exists() and not overwrite:
        raise DataError(f"{output}: exists already; choose another name, or replace it with --overwrite")
    return output


def write_netcdf(dataset: xr.Dataset, output: str | Path, *, overwrite: bool = False) -> Path:
    """Write a dataset; variables named in :mod:`seaglint.schema` get their CF attributes.

    Raises
    ------
    DataError
        The output exists.
    StorageError
        No room or no rights; nothing is left behind.
    """
    output = refuse_existing(output, overwrite=overwrite)
    labelled = dataset.copy()
    for name in map(str, labelled.variables):
        if name in VARIABLES:
            labelled[name].attrs = {**VARIABLES[name].attributes, **labelled[name].attrs}
    partial = output.with_name(output.name + ".partial")
    encoding = {name: {"zlib": True, "complevel": 3} for name, variable in labelled.data_vars.items() if variable.ndim >= 2}
    content = labelled.to_netcdf(engine="h5netcdf", encoding=encoding)
    try:
        with storage_errors(output, "make room or choose another place; nothing was written"):
            partial.write_bytes(content)
            partial.replace(output)
    finally:
        partial.unlink(missing_ok=True)
    return output
