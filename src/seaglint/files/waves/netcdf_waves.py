"""NetCDF files of spectra: times, places and one record of many, under various names."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError
from seaglint.files.netcdf import open_netcdf
from seaglint.files.waves.bands import Bands
from seaglint.files.waves.wave_file import Held, parsed

_TIMES: Final = ("valid_time", "time", "date")
_SITES: Final = ("station", "site", "points")
_LATITUDES: Final = ("latitude", "lat")
_LONGITUDES: Final = ("longitude", "lon")


def open_dataset(path: Path) -> Any:
    """Open the file as an xarray dataset without reading values."""
    # Groups, calendars or packing that xarray cannot read are reported as any parser's error.
    return parsed(path, "NetCDF", lambda: open_netcdf(path))


def held_by(path: Path, density: str, convert: Callable[[Any], Bands]) -> Held:
    """Return the records of a NetCDF file.

    Parameters
    ----------
    path : Path
        The file.
    density : str
        Name of its spectra; dimensions besides time and place are left to ``convert``.
    convert : callable
        Bands of a dataset that holds one time and one place.
    """
    with open_dataset(path) as data:
        dims = data[density].dims
        time = next((name for name in _TIMES if name in data.variables), None)
        site = next((name for name in _SITES if name in dims), None)
        latitude, longitude = (next((n for n in names if n in data.variables), None) for names in (_LATITUDES, _LONGITUDES))
        times = None if time is None else np.atleast_1d(data[time].values)
        if times is not None and times.dtype.kind != "M":
            raise DataError(
                f"{path}: its times ('{time}') have no units that can be read; allowed: 'seconds since 1970-01-01' and the like"
            )
        count = 1 if times is None else times.size
        grid = site is None and latitude in dims and longitude in dims
        if grid:
            rows, columns = data[latitude].size, data[longitude].size
            north, east = (a.ravel() for a in np.meshgrid(data[latitude].values, data[longitude].values, indexing="ij"))
            names = tuple(f"{n:g},{e:g}" for n, e in zip(north, east, strict=True))
            places: list[FloatArray | None] = [np.broadcast_to(values, (count, rows * columns)) for values in (north, east)]
        else:
            names = _names(data, site)
            places = [_placed(data, name, time, site, (count, len(names))) for name in (latitude, longitude)]

    def bands(moment: int, place: int) -> Bands:
        chosen: dict[str, int] = {}
        if time in dims:
            chosen[str(time)] = moment
        if grid:
            chosen |= {str(latitude): place // columns, str(longitude): place % columns}
        elif site is not None:
            chosen[site] = place
        with open_dataset(path) as data:
            if times is not None and time in dims:
                require_one(data[density], str(time), np.flatnonzero(times == times[moment]), path)
            return convert(data.isel(chosen).load())

    return Held(bands, None if times is None else times.astype("datetime64[ns]"), names, *places)


def require_one(density: Any, time: str, indices: NDArray[np.intp], path: Path) -> None:
    """Refuse records of one time whose spectra differ."""
    records = [density.isel({time: int(index)}).values for index in indices] if indices.size > 1 else []
    if any(not np.array_equal(records[0], record, equal_nan=True) for record in records[1:]):
        moment = np.datetime_as_string(np.atleast_1d(density[time].values)[indices[0]], unit="s")
        raise DataError(
            f"{path} has {indices.size} records of {moment}Z that differ (numbers {', '.join(map(str, indices + 1))}); remove all but one"
        )


def _names(data: Any, site: str | None) -> tuple[str, ...]:
    """Return the names of the sites; numbers from 1 where the file has none."""
    if site is None:
        return ("1",)
    for name in ("station_name", site):
        if name in data.variables:
            values = data[name].values
            if values.ndim == 2:  # one letter a cell
                values = np.array([b"".join(row) if values.dtype.kind == "S" else "".join(row) for row in values])
            if values.ndim == 1:
                return tuple(v.decode("utf-8", "replace").strip() if isinstance(v, bytes) else str(v).strip() for v in values)
    return tuple(str(i + 1) for i in range(data.sizes[site]))


def _placed(data: Any, name: str | None, time: str | None, site: str | None, shape: tuple[int, int]) -> FloatArray | None:
    """Return a coordinate of every record and site [deg]."""
    if name is None:
        return None
    values = data[name]
    order = [dim for dim in (time, site) if dim in values.dims]
    values = values.transpose(*order, ...).values.astype(np.float64)
    if time not in order and site not in order:
        values = values.reshape(-1)[:1]
    if time in order and site not in order:
        values = values.reshape(-1, 1)
    return np.broadcast_to(values, shape)
