"""Reader of ERA5 two-dimensional wave spectra (NetCDF, parameter 251.140, d2fd), before and after the new layout of September 2024.

Files hold the decimal logarithm of the density in m² s rad⁻¹, directions that waves travel TO, clockwise from north, by number only, and
nothing where there is land or next to no energy.

References
----------
ECMWF, "2D wave spectra": first direction half a step, first frequency 0.03453 Hz, each 1.1 times the one before.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, Final

import numpy as np

from seaglint.base.errors import DataError
from seaglint.files.waves.bands import Bins
from seaglint.files.waves.netcdf_waves import held_by
from seaglint.files.waves.wave_file import Held, reader

#: Numbers of frequencies and directions whose first frequency is 0.03453 Hz: ERA5 and the global forecast since 2010.
_GRIDS: Final = {(30, 24), (36, 36)}


def read(path: Path) -> Held:
    """Read the records of a file."""
    reader("read_era5")

    def convert(data: Any) -> Bins:
        from wavespectra.input.era5 import from_era5

        for name in ("expver", "number"):
            if name in data["d2fd"].dims:
                data = _one_of(data, name, path)
        # wavespectra wants the numbers of frequencies and directions as coordinates; some files have bare dimensions.
        data = data.assign_coords({name: np.arange(data.sizes[name]) for name in data["d2fd"].dims if name not in data.variables})
        if not np.any(np.isfinite(data["d2fd"].values)):
            raise DataError(f"{path}: has no spectrum there at that time (land, or outside); give a place at sea")
        converted = from_era5(data)
        spectrum = converted["efth"].squeeze(drop=True).transpose("freq", "dir")
        if spectrum.shape not in _GRIDS:
            raise DataError(
                f"{path}: has {spectrum.shape[0]} frequencies and {spectrum.shape[1]} directions, and ERA5 has 30 and 24 (forecasts 36 and "
                "36); ask for all of them"
            )
        frequency, directions = (np.asarray(converted[name].values, dtype=np.float64) for name in ("freq", "dir"))
        return Bins(frequency, directions, np.asarray(spectrum.values, dtype=np.float64))

    return held_by(path, "d2fd", convert)


def _one_of(data: Any, name: str, path: Path) -> Any:
    """Return the entry of a dimension that has values: final or preliminary data; more than one is refused."""
    held = [i for i in range(data.sizes[name]) if np.any(np.isfinite(data["d2fd"].isel({name: i}).values))]
    if len(held) > 1:
        raise DataError(f"{path}: has {len(held)} entries of '{name}' at that time and place; select one, as in xarray: isel({name}=0)")
    return data.isel({name: held[0] if held else 0})
