"""Rows of weather from a grid: ERA5 single levels, NetCDF before and after the new layout of September 2024, and GRIB; also other centres'.

ERA5 before: dimension ``time``, packed shorts with scale and offset, and a dimension ``expver`` where final (1) and preliminary (5) months
meet, each empty where the other has values. After: dimension ``valid_time``, floats, ``expver`` and ``number`` beside it. Latitudes fall,
longitudes run 0 to 359.75 or -180 to 179.75. Winds are components that the air blows towards; the sea's temperature and waves are masked on
land. Waves come in separate files, on a grid half as fine: they are joined by time and nearest place.

References
----------
ECMWF, "ERA5: data documentation" and "GRIB to netCDF conversion on new CDS and ADS systems".
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, Final

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError
from seaglint.climate.weather_columns import relative_humidity, west_east, wind_from_components
from seaglint.climate.weather_selection import Selection, covered
from seaglint.formats.weather.weather_cells import WeatherSource, order_of
from seaglint.formats.weather.weather_grid import QUANTITIES, WeatherGrid, open_grid

MOST_ROWS: Final = 20_000_000  #: Largest number of rows of a grid: a dozen columns of that length are 2 GB.

#: Largest distance of the nearest place of a coarser grid [deg]: half of the 0.5 deg of the wave model, and rounding.
_WAVE_GRID_DEG: Final = 0.26


def read_era5(path: Path, selection: Selection, *, beside: Sequence[Path] = ()) -> WeatherSource:
    """Read the rows of a grid: one for each time and sea point.

    Parameters
    ----------
    path : Path
        A file with winds.
    selection : Selection
        Requested places and times: only those are read.
    beside : sequence of Path
        Files without winds (waves, sea temperature), from which variables that this one lacks are taken at the same time and nearest place.

    Raises
    ------
    DataError
        A file without winds, nothing selected, or too many rows.
    """
    grid, notes = _one_state(path)
    data = grid.data
    if not {"u10", "v10"} <= set(data.data_vars):
        raise DataError(f"{path}: has {', '.join(map(str, data.data_vars))} and no wind; give u10 and v10, or a file with them beside it")
    total = int(np.prod([data.sizes[n] for n in ("time", "latitude", "longitude")]))
    stamps = np.asarray(data["time"].values).astype("datetime64[ns]")
    months = (stamps.astype("datetime64[M]").astype(np.int64) % 12 + 1).astype(np.float64)
    hours = (stamps - stamps.astype("datetime64[D]")) / np.timedelta64(1, "h")
    latitude, longitude = np.meshgrid(data["latitude"].values.astype(float), data["longitude"].values.astype(float), indexing="ij")
    times, places = selection.times(months, hours), selection.places(latitude, longitude)
    if not times.any() or not places.any():
        there = {"latitude_deg": latitude.ravel(), "longitude_deg": longitude.ravel(), "month": months, "hour_utc": hours}
        raise DataError(f"{path}: nothing in {' and '.join(selection.words)}; the file covers {covered(there)}; choose inside it")
    cells = int(times.sum() * places.sum())
    if cells > MOST_ROWS:
        raise DataError(f"{path}: {cells} rows are more than {MOST_ROWS}; choose a smaller box, fewer months, or hours='0,6,12,18'")
    # Only the rows and columns of the grid that hold a selected place are read from the file.
    iy, ix = np.flatnonzero(places.any(1)), np.flatnonzero(places.any(0))
    part = grid.loaded(time=np.flatnonzero(times), latitude=iy, longitude=ix)
    own = frozenset(map(str, part.data_vars))
    for other in beside:
        part, more = _joined(part, own, other)
        notes += more
    inside = places[np.ix_(iy, ix)]
    grids = {name: np.asarray(part[name].values, dtype=np.float64)[:, inside].ravel() for name in part.data_vars}
    count = int(times.sum())
    columns = _columns(grids, cells)
    columns |= {
        "month": np.repeat(months[times], inside.sum()),
        "hour_utc": np.repeat(hours[times], inside.sum()),
        "latitude_deg": np.tile(latitude[np.ix_(iy, ix)][inside], count),
        "longitude_deg": np.tile(longitude[np.ix_(iy, ix)][inside], count),
    }
    columns["weight"] = np.cos(np.radians(columns["latitude_deg"]))  # cells of a regular grid shrink towards the poles
    left_out = {"outside the times and places wanted": total - cells} if total > cells else {}
    if "sst" in grids:
        sea = ~np.isnan(grids["sst"])  # ERA5 masks the sea's temperature on land
        if not sea.any():
            raise DataError(f"{path}: has no sea temperature in what is selected: all land; choose a place at sea")
        left_out |= {"on land (no sea temperature)": int(np.sum(~sea))} if not sea.all() else {}
        columns = {name: values[sea] for name, values in columns.items()}
    else:
        notes += ("no sst in the file: points on land cannot be told from the sea and are kept",)
    # The humidity follows from the dew point where it is not in the file itself.
    needless = ("r2", "d2m") if "r2" in grids else ("r2",)
    lacking = [name for name in QUANTITIES if name not in (*grids, *needless)]
    if lacking:
        notes += (f"not in the file: {', '.join(lacking)}",)
    era5 = all(grid.names[name] == name for name in own)
    return WeatherSource(
        path,
        "ERA5" if era5 else "weather grid",
        columns,
        total,
        left_out=left_out,
        notes=(*notes, "rows weigh as the area of their cell, cos(latitude)"),
    ).within_ranges()


def _one_state(path: Path) -> tuple[WeatherGrid, tuple[str, ...]]:
    """Return a grid without members, longitudes in [-180, 180), and notes on it."""
    grid = open_grid(path)
    if "member" in grid.data.dims:
        name = grid.names["member"]
        raise DataError(f"{path}: has {grid.data.sizes['member']} entries of '{name}'; select one of them, as in xarray: isel({name}=0)")
    data = grid.data.assign_coords(longitude=west_east(grid.data["longitude"].values))
    return replace(grid, data=data), (*grid.notes, *order_of(np.asarray(data["time"].values)))


def has_wind(path: Path) -> bool:
    """Return true where a file has winds; a file without them is only read together with one that has them."""
    return {"u10", "v10"} <= set(open_grid(path).data.data_vars)


def _joined(part: Any, own: frozenset[str], other: Path) -> tuple[Any, tuple[str, ...]]:
    """Return the dataset with the variables that another file adds; earlier files take precedence."""
    grid, notes = _one_state(other)
    added = grid.data
    new = [str(name) for name in added.data_vars if name not in own]
    common = np.isin(part["time"].values, added["time"].values)
    if not new or not common.any():
        return part, ()
    added = added[new].sortby("latitude").sortby("longitude").drop_duplicates("time").reindex(time=part["time"].values)
    for name in ("latitude", "longitude"):
        added = added.reindex({name: part[name].values}, method="nearest", tolerance=_WAVE_GRID_DEG)
    values = {name: grid.converted(name, added[name].values) for name in new}
    # Values of earlier files stay; gaps take those of the further file.
    filled = {name: np.where(np.isnan(part[name].values), v, part[name].values) if name in part else v for name, v in values.items()}
    share = f"{int(common.sum())} of {common.size} times"
    notes = (*notes, f"{', '.join(new)} from {other.name}, same time and nearest place, {share}")
    return part.assign({name: (part["u10"].dims, v) for name, v in filled.items()}), notes


def _columns(grids: dict[str, FloatArray], cells: int) -> dict[str, FloatArray]:
    def get(name: str) -> FloatArray:
        return grids.get(name, np.full(cells, np.nan))

    speed, come = wind_from_components(get("u10"), get("v10"))
    return {
        "wind_speed_m_s": speed,
        "wind_from_deg": come,
        "cloud_cover": get("tcc"),
        "sea_temperature_k": get("sst"),
        "air_temperature_k": get("t2m"),
        "relative_humidity": grids["r2"] if "r2" in grids else relative_humidity(get("t2m"), get("d2m")),
        "significant_height_m": get("swh"),
    }
