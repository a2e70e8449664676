"""Reader of WAVEWATCH III: NetCDF of the point output and text files of stations.

Both have directions waves travel TO, clockwise from north; wavespectra turns them to where they come FROM, also for NetCDF whose attribute
says that they do so already. Text rounds directions to three digits of a radian: they are put back on their even grid.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, Final

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError
from seaglint.files.waves.bands import Bins
from seaglint.files.waves.netcdf_waves import held_by
from seaglint.files.waves.wave_file import Held, parsed, reader

_ROUNDED: Final = 0.6  # largest distance of a printed direction from its even grid [deg]: 0.005 rad and the offset's own


def read_text(path: Path) -> Held:
    """Read the records of a station's text file with one point."""
    header = parsed(path, "a WAVEWATCH III station file", lambda: path.read_text(encoding="utf-8").partition("\n")[0])
    points = parsed(path, "a WAVEWATCH III station file", lambda: int(header.split("'")[2].split()[2]))
    if points != 1:
        raise DataError(f"{path}: has {points} points, and files of one are read; split it by point, or write NetCDF (ww3_ounp)")
    read = reader("read_ww3_station")
    data = parsed(path, "a WAVEWATCH III station file", lambda: read(str(path)))
    density = np.asarray(data["efth"].values, dtype=np.float64).reshape(-1, data.sizes["freq"], data.sizes["dir"])
    directions = _even(np.asarray(data["dir"].values, dtype=np.float64), path)
    frequency = np.asarray(data["freq"].values, dtype=np.float64)
    names = ("1",) if "site" not in data.coords else tuple(str(name) for name in np.atleast_1d(data["site"].values))
    places = [np.broadcast_to(np.ravel(data[name].values)[:1], (density.shape[0], 1)) for name in ("lat", "lon")]
    times = np.asarray(data["time"].values).astype("datetime64[ns]")
    return Held(lambda moment, _: Bins(frequency, directions, density[moment]), times, names, *places)


def _even(directions: FloatArray, path: Path) -> FloatArray:
    """Return exact directions of a whole turn that were rounded when printed [deg]."""
    step = 360.0 / directions.size
    turn = np.sign(np.median((np.diff(directions) + 180.0) % 360.0 - 180.0)) * step
    away = (directions - turn * np.arange(directions.size) + 180.0 - directions[0]) % 360.0 - 180.0
    if np.ptp(away) > 2.0 * _ROUNDED:
        raise DataError(f"{path}: its {directions.size} directions are not even steps of {step:g} deg over the whole turn; check the file")
    return np.asarray((directions[0] + away.mean() + turn * np.arange(directions.size)) % 360.0)


def read_netcdf(path: Path) -> Held:
    """Read the records of WAVEWATCH III's NetCDF."""

    def convert(data: Any) -> Bins:
        from wavespectra.input.ww3 import from_ww3

        already_from = "from_direction" in str(data["direction"].attrs.get("standard_name", ""))
        converted = from_ww3(data)
        directions = np.asarray(converted["dir"].values, dtype=np.float64) + (180.0 if already_from else 0.0)
        density = np.asarray(converted["efth"].transpose("freq", "dir").values, dtype=np.float64)
        return Bins(np.asarray(converted["freq"].values, dtype=np.float64), directions % 360.0, density)

    reader("read_ww3")
    return held_by(path, "efth", convert)
