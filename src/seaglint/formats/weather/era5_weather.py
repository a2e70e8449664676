"""Reader of ERA5 single levels: NetCDF before and after the new layout of September 2024, and GRIB by cfgrib.

Before: dimension ``time``, packed shorts with scale and offset, and a dimension ``expver`` where final (1) and preliminary (5) months meet,
each empty where the other has values. After: dimension ``valid_time``, floats, ``expver`` and ``number`` beside it. Latitudes descend,
longitudes run 0 to 359.75 or -180 to 179.75. Winds are components that the air blows towards; the sea's temperature and waves are masked on
land. Waves come in separate files, on a grid half as fine: they are joined by time and nearest place.

References
----------
ECMWF, "ERA5: data documentation" and "GRIB to netCDF conversion on new CDS and ADS systems".
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError, SeaglintError
from seaglint.base.optional import missing
from seaglint.climate.weather_columns import relative_humidity, west_east, wind_from_components
from seaglint.climate.weather_selection import Selection, covered
from seaglint.formats.weather.weather_cells import WeatherSource, order_of
from seaglint.store.netcdf import drop_quietly
from seaglint.store.outputs import reason_of

#: Variables that are read, and the spellings allowed of the unit of each.
UNITS: Final = {
    "u10": ("m s**-1", "m s-1", "m/s"),
    "v10": ("m s**-1", "m s-1", "m/s"),
    "tcc": ("(0 - 1)", "1", "0-1", "~"),
    "sst": ("K", "kelvin"),
    "t2m": ("K", "kelvin"),
    "d2m": ("K", "kelvin"),
    "swh": ("m", "metre", "meter"),
}

MOST_ROWS: Final = 20_000_000  #: Largest number of rows of a grid: a dozen columns of that length are 2 GB.

#: Largest distance of the nearest place of a coarser grid [deg]: half of the 0.5 deg of the wave model, and rounding.
_WAVE_GRID_DEG: Final = 0.26

_TIMES: Final = ("valid_time", "time")
_GRID: Final = frozenset({"time", "latitude", "longitude"})


def is_grib(path: Path) -> bool:
    """Return true where a file begins as GRIB."""
    return _magic(path) == b"GRIB"


def is_netcdf(path: Path) -> bool:
    """Return true where a file begins as NetCDF, classic or 4."""
    return _magic(path)[:3] == b"CDF" or _magic(path) == b"\x89HDF"


def _magic(path: Path) -> bytes:
    try:
        with path.open("rb") as file:
            return file.read(4)
    except OSError as error:
        raise DataError(f"{path}: cannot be read ({error.strerror}); give a file of weather") from None


def open_era5(path: Path) -> tuple[Any, tuple[str, ...]]:
    """Open a file as a dataset over ``time, latitude, longitude``, longitudes in [-180, 180), with notes on it.

    Raises
    ------
    BackendError
        GRIB without cfgrib.
    DataError
        A file that cannot be read, without places or times, with several members, or with a unit that is not known.
    """
    data = _opened(path)
    notes: list[str] = []
    time = next((name for name in _TIMES if name in data.dims), None) or next((name for name in _TIMES if name in data.coords), None)
    if time is None or not {"latitude", "longitude"} <= set(data.coords):
        raise DataError(f"{path}: has {', '.join(map(str, data.coords))}; an ERA5 file of weather has time, latitude and longitude")
    known = [name for name in UNITS if name in data.data_vars]
    if not known:
        raise DataError(f"{path}: has {', '.join(map(str, data.data_vars))}; of an ERA5 file {', '.join(UNITS)} are read")
    data = data[known]
    for name in known:
        unit = data[name].attrs.get("units")
        if unit is not None and unit not in UNITS[name]:
            raise DataError(
                f"{path}: {name} has the unknown unit '{unit}'; allowed are {', '.join(UNITS[name])}: convert it, or use "
                "CSV with map='NAME=COLUMN:UNIT'"
            )
    if time not in data.dims:
        data = data.expand_dims(time)
    if "expver" in data.dims:
        data = _final_first(path, data, notes)
    elif "expver" in data.coords:
        versions = np.atleast_1d(data["expver"].values).astype("U4")
        early = int(np.sum(np.char.lstrip(versions, "0") == "5"))
        if early:
            notes.append(f"{early} of {versions.size} times are preliminary (expver 5)")
    for name in [str(n) for n in data.dims if n not in (time, "latitude", "longitude")]:
        if data.sizes[name] > 1:
            raise DataError(f"{path}: has {data.sizes[name]} entries of '{name}'; select one of them, as in xarray: isel({name}=0)")
        data = data.isel({name: 0}, drop=True)
    for name in ("latitude", "longitude"):
        if name not in data.dims:
            data = data.expand_dims(name)
    if time != "time":
        data = data.drop_vars("time", errors="ignore").rename({time: "time"})
    data = data.assign_coords(longitude=west_east(data["longitude"].values))
    return data.transpose("time", "latitude", "longitude"), (*notes, *order_of(np.asarray(data["time"].values)))


def _opened(path: Path) -> Any:
    import xarray as xr

    if is_grib(path):
        try:
            import cfgrib
        except (ImportError, RuntimeError):  # cfgrib raises the latter where the library ecCodes is not found
            raise missing(f"{path}: GRIB", "cfgrib", "or download NetCDF") from None

        def opened() -> Any:
            # Fields of different steps and grids are separate datasets to cfgrib.
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", FutureWarning)  # of xarray, about cfgrib's own merging
                parts = cfgrib.open_datasets(str(path), backend_kwargs={"indexpath": ""})
            return xr.merge([part.drop_vars(set(part.coords) - _GRID, errors="ignore") for part in parts], compat="override", join="outer")
    else:
        engine = "scipy" if _magic(path)[:3] == b"CDF" else "h5netcdf"

        def opened() -> Any:
            return xr.open_dataset(path, engine=engine)

    try:
        data = opened()
        return data.rename({short: name for short, name in (("lat", "latitude"), ("lon", "longitude")) if short in data.coords})
    except SeaglintError:
        raise
    except Exception as error:  # xarray, h5py and eccodes raise nearly anything
        reason = reason_of(error)
        drop_quietly(error)
        raise DataError(f"{path}: cannot be read as ERA5 ({reason}); is it whole?") from None


def _final_first(path: Path, data: Any, notes: list[str]) -> Any:
    """Return final values where there are any, preliminary ones elsewhere."""
    versions = [int(v) for v in np.atleast_1d(data["expver"].values)]
    if not set(versions) <= {1, 5}:
        raise DataError(f"{path}: has expver {versions}; ERA5 has 1 (final) and 5 (preliminary): select one of them")
    # 1 is final and 5 preliminary: the smaller number takes precedence.
    final = data.isel(expver=versions.index(min(versions)), drop=True)
    if len(versions) == 1:
        return final
    early = data.isel(expver=versions.index(5), drop=True)
    taken = sum(int((final[name].isnull() & early[name].notnull()).any(("latitude", "longitude")).sum()) for name in list(data)[:1])
    notes.append(f"{taken} of {data.sizes[next(n for n in _TIMES if n in data.dims)]} times are preliminary (expver 5)")
    return final.combine_first(early)


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
    data, notes = open_era5(path)
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
    part = data.isel(time=np.flatnonzero(times), latitude=iy, longitude=ix).load()
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
    lacking = [name for name in UNITS if name not in grids]
    if lacking:
        notes += (f"not in the file: {', '.join(lacking)}",)
    return WeatherSource(
        path, "ERA5", columns, total, left_out=left_out, notes=(*notes, "rows weigh as the area of their cell, cos(latitude)")
    ).within_ranges()


def has_wind(path: Path) -> bool:
    """Return true where a file has winds; a file without them is only read together with one that has them."""
    return {"u10", "v10"} <= set(_opened(path).data_vars)


def _joined(part: Any, own: frozenset[str], other: Path) -> tuple[Any, tuple[str, ...]]:
    """Return the dataset with the variables that another file adds; earlier files take precedence."""
    added, notes = open_era5(other)
    new = [str(name) for name in added.data_vars if name not in own]
    common = np.isin(part["time"].values, added["time"].values)
    if not new or not common.any():
        return part, ()
    added = added[new].sortby("latitude").sortby("longitude").drop_duplicates("time").reindex(time=part["time"].values)
    for name in ("latitude", "longitude"):
        added = added.reindex({name: part[name].values}, method="nearest", tolerance=_WAVE_GRID_DEG)
    values = {name: np.asarray(added[name].values, dtype=np.float64) for name in new}
    # Values of earlier files stay; gaps take those of the further file.
    filled = {name: np.where(np.isnan(part[name].values), v, part[name].values) if name in part else v for name, v in values.items()}
    share = f"{int(common.sum())} of {common.size} times"
    notes = (*notes, f"{', '.join(new)} from {other.name}, same time and nearest place, {share}")
    return part.assign({name: (part["u10"].dims, v) for name, v in filled.items()}), notes


def _columns(grids: dict[str, FloatArray], cells: int) -> dict[str, FloatArray]:
    def get(name: str) -> FloatArray:
        return grids.get(name, np.full(cells, np.nan))

    speed, come = wind_from_components(get("u10"), get("v10"))
    cloud = get("tcc")
    # Packing of shares in 65 534 steps leaves values a step beyond 0 and 1.
    cloud = np.where(np.abs(cloud - 0.5) <= 0.5 + 1e-4, np.clip(cloud, 0.0, 1.0), cloud)
    return {
        "wind_speed_m_s": speed,
        "wind_from_deg": come,
        "cloud_cover": cloud,
        "sea_temperature_k": get("sst"),
        "air_temperature_k": get("t2m"),
        "relative_humidity": relative_humidity(get("t2m"), get("d2m")),
        "significant_height_m": get("swh"),
    }
