"""Reader of SWAN's standard spectral files and NetCDF.

In text files nautical directions (``NDIR``) are where waves come FROM, Cartesian ones (``CDIR``) where they travel TO, counter-clockwise
from the x axis; wavespectra turns these. In NetCDF directions are in radians, and an attribute says which of the two they are;
wavespectra takes them for nautical always.
"""

from __future__ import annotations

import gzip
import warnings
from pathlib import Path
from typing import Any, Final

import numpy as np

from seaglint.base.errors import DataError
from seaglint.files.waves.bands import Bins
from seaglint.files.waves.netcdf_waves import held_by
from seaglint.files.waves.wave_file import Held, parsed, reader

_HEADER_END: Final = "QUANT"


def read_text(path: Path) -> Held:
    """Read the records of a standard spectral file, plain or gzipped; a stationary run has no times."""
    header = parsed(path, "a SWAN spectral file", lambda: _header(path))
    if not {"NDIR", "CDIR"} & header:
        raise DataError(
            f"{path}: is a SWAN file of one-dimensional spectra, which are not read; write two-dimensional ones (SPECOUT ... SPEC2D)"
        )
    read = reader("read_swan")
    # As sites always: for a grid wavespectra sorts the coordinates but not the spectra.
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # rows that cannot be read are warned of and left as NaN: refused when they are wanted
        data = parsed(path, "a SWAN spectral file", lambda: read(str(path), as_site=True))
    spherical = "LONLAT" in header

    def bands(moment: int, place: int) -> Bins:
        density = np.asarray(data["efth"].values[moment, place], dtype=np.float64)
        if not np.any(np.isfinite(density)):
            raise DataError(f"{path}: has no spectrum at site {place + 1} at that time (NODATA: land or dry); choose another")
        return Bins(np.asarray(data["freq"].values, dtype=np.float64), np.asarray(data["dir"].values, dtype=np.float64), density)

    count = data.sizes["time"]
    places = [np.broadcast_to(data[name].values, (count, data.sizes["site"])) if spherical else None for name in ("lat", "lon")]
    times = data["time"].values.astype("datetime64[ns]") if "TIME" in header else None
    return Held(bands, times, tuple(str(name) for name in data["site"].values), *places)


def _header(path: Path) -> set[str]:
    """Return the first words of the lines above the quantities."""
    words = set()
    with gzip.open(path, "rt") if path.suffix == ".gz" else path.open() as lines:
        for line in lines:
            words.add((line.split() or [""])[0].upper())
            if line.startswith(_HEADER_END):
                break
    return words


def read_netcdf(path: Path) -> Held:
    """Read the records of SWAN's NetCDF output of two-dimensional spectra."""

    def convert(data: Any) -> Bins:
        from wavespectra.input.ncswan import from_ncswan

        cartesian = _is_cartesian(data)
        converted = from_ncswan(data)
        directions = np.asarray(converted["dir"].values, dtype=np.float64)
        density = np.asarray(converted["efth"].transpose("freq", "dir").values, dtype=np.float64)
        return Bins(
            np.asarray(converted["freq"].values, dtype=np.float64), (270.0 - directions) % 360.0 if cartesian else directions, density
        )

    reader("read_ncswan")
    return held_by(path, "density", convert)


def _is_cartesian(data: Any) -> bool:
    """Return true where directions are those waves travel TO, counter-clockwise from east; nautical is the default."""
    said = {str(name).lower(): str(value).lower() for name, value in data.attrs.items()}.get("directional_convention", "")
    standard = str(data["direction"].attrs.get("standard_name", "")).lower()
    return said.startswith("cartesian") or (not said and "to_direction" in standard)
