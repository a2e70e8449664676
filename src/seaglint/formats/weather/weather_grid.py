"""Grids of weather over time, latitude and longitude of any centre: NetCDF, and GRIB by cfgrib, under the names and in the units of ERA5.

Names are those of ECMWF (``10u``, ``u10``), or of NCEP as wgrib2 (``UGRD_10maboveground``), GrADS Data Servers (``ugrd10m``) and THREDDS
(``u-component_of_wind_height_above_ground``) write them; where none of them is in the file, standard names of CF with a stated height.
The time is the valid time, or the reference time plus the step. Nothing is guessed from values: the attribute ``units`` decides.

References
----------
ECMWF, "ERA5: data documentation" and "GRIB to netCDF conversion on new CDS and ADS systems". NetCDF Climate and Forecast conventions 1.11.
"""

from __future__ import annotations

import re
import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, Literal

import numpy as np
from numpy.typing import ArrayLike

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError, SeaglintError
from seaglint.base.optional import missing
from seaglint.climate.weather_columns import ICE_POINT, SHARE_UNITS
from seaglint.store.netcdf import drop_quietly
from seaglint.store.outputs import reason_of

Line = tuple[float, float]  #: Factor and offset from the unit of a file to ours.

_METRES: Final[Mapping[str, Line]] = dict.fromkeys(("m", "metre", "meter", "metres", "meters"), (1.0, 0.0))
_KELVIN: Final[Mapping[str, Line]] = {
    **dict.fromkeys(("K", "kelvin", "Kelvin"), (1.0, 0.0)),
    **dict.fromkeys(("degC", "Celsius", "degree_Celsius", "degrees_Celsius"), (1.0, ICE_POINT)),
}
_SPEED: Final[Mapping[str, Line]] = {
    **dict.fromkeys(("m s**-1", "m s-1", "m/s", "m.s-1", "m s^-1", "meters/second", "m/sec"), (1.0, 0.0)),
    **dict.fromkeys(("kn", "kt", "knot", "knots"), (1852.0 / 3600.0, 0.0)),
    "km/h": (1.0 / 3.6, 0.0),
}
#: ERA5 writes the share of cloud as (0 - 1), its oldest files as ~.
_SHARE: Final[Mapping[str, Line]] = {
    **dict.fromkeys(("(0 - 1)", "0-1", "~"), (1.0, 0.0)),
    **{unit: (factor, 0.0) for unit, factor in SHARE_UNITS.items()},
}

#: Share by which packed and interpolated covers may be beyond 0 and 1; more is another unit than the file states.
_ROUNDING: Final = 1e-3


@dataclass(frozen=True)
class GridQuantity:
    """Quantity that is read from grids."""

    units: Mapping[str, Line]  #: Spellings of its units.
    names: tuple[str, ...]  #: Names in files, compared without case and signs, the first one first.
    standard: str  #: Standard name of CF.
    height: float | None = None  #: Height above the surface [m].


#: Quantities that are read, by the names of ERA5.
QUANTITIES: Final[Mapping[str, GridQuantity]] = {
    "u10": GridQuantity(
        _SPEED, ("u10", "10u", "UGRD_10maboveground", "ugrd10m", "u-component_of_wind_height_above_ground", "UGRD"), "eastward_wind", 10.0
    ),
    "v10": GridQuantity(
        _SPEED, ("v10", "10v", "VGRD_10maboveground", "vgrd10m", "v-component_of_wind_height_above_ground", "VGRD"), "northward_wind", 10.0
    ),
    "tcc": GridQuantity(
        _SHARE,
        (
            "tcc",
            "TCDC_entireatmosphere",
            "TCDC_entireatmosphere_consideredasasinglelayer_",
            "tcdcclm",
            "Total_cloud_cover_entire_atmosphere",
            "Total_cloud_cover_entire_atmosphere_single_layer",
            "TCDC",
        ),
        "cloud_area_fraction",
    ),
    "sst": GridQuantity(_KELVIN, ("sst",), "sea_surface_temperature"),
    "t2m": GridQuantity(_KELVIN, ("t2m", "2t", "TMP_2maboveground", "tmp2m", "Temperature_height_above_ground"), "air_temperature", 2.0),
    "d2m": GridQuantity(
        _KELVIN, ("d2m", "2d", "DPT_2maboveground", "dpt2m", "Dewpoint_temperature_height_above_ground"), "dew_point_temperature", 2.0
    ),
    "swh": GridQuantity(_METRES, ("swh", "HTSGW_surface", "htsgwsfc"), "sea_surface_wave_significant_height"),
    "r2": GridQuantity(_SHARE, ("r2", "2r", "RH_2maboveground", "rh2m", "Relative_humidity_height_above_ground"), "relative_humidity", 2.0),
}

_WIND: Final = ("u10", "v10")
_MEMBERS: Final = ("member", "number", "realization", "ensemble", "ensemble_member", "ens")  #: Names of the dimension of an ensemble.
_PLACES: Final = {"latitude": ("lat", "degrees_north"), "longitude": ("lon", "degrees_east")}

#: Kinds of level that fields at the surface have in GRIB; clouds have the whole atmosphere.
_LEVELS: Final = ("surface", "heightAboveGround", "meanSea", "atmosphere", "entireAtmosphere", "atmosphereSingleLayer", "unknown")

_STATED_HEIGHT: Final = re.compile(r"(\d+(?:\.\d+)?)[ -]*m(?:et(?:er|re)s?)?\b")


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


@dataclass(frozen=True, eq=False)
class WeatherGrid:
    """Grid of weather that is read piece by piece. Made by ``open_grid``."""

    path: Path  #: The file.
    data: Any  #: Dataset over ``time, member`` of an ensemble, ``latitude, longitude``; numbers as in the file.
    units: Mapping[str, str]  #: Unit of each quantity in the file.
    names: Mapping[str, str]  #: Names in the file by ours, with ``member``, the dimension of an ensemble.
    notes: tuple[str, ...]  #: Sentences on what was assumed.

    def converted(self, name: str, values: ArrayLike) -> FloatArray:
        """Return numbers of the file in our unit; shares beyond 0 to 1 by rounding are limited to it.

        Raises
        ------
        DataError
            A cover beyond 1: its unit is another one than the file states.
        """
        factor, offset = QUANTITIES[name].units[self.units[name]]
        out = factor * np.asarray(values, dtype=np.float64) + offset
        if name != "tcc":
            return out
        wrong = out[np.abs(out - 0.5) > 0.5 + _ROUNDING]
        if wrong.size:
            raise DataError(
                f"{self.path}: {self.names[name]} is {wrong[0] / factor:g} in the unit '{self.units[name]}', a cover outside 0 to 1; "
                "correct its attribute units (percent, okta or 1) or the value"
            )
        return np.clip(out, 0.0, 1.0)

    def loaded(self, **places: Any) -> Any:
        """Return the part at indices by dimension as a dataset of numbers in our units."""
        part = self.data.isel(places).load()
        return part.assign({name: (part[name].dims, self.converted(name, part[name].values)) for name in map(str, part.data_vars)})


def open_grid(path: Path, *, join: Literal["outer", "inner"] = "outer") -> WeatherGrid:
    """Open a file of weather; ``join`` keeps times and places of any of its fields, or those of all of them.

    Raises
    ------
    BackendError
        GRIB without cfgrib.
    DataError
        A file that cannot be read, without places or times, with several forecasts, without the height of a wind, or with a unit that is
        missing or unknown.
    """
    import xarray as xr

    notes: list[str] = []
    names: dict[str, str] = {}
    fields: dict[str, Any] = {}
    units: dict[str, str] = {}
    for name, field in (_grib_fields if is_grib(path) else _netcdf_fields)(path, notes):
        names.setdefault(name, str(field.name))
        units[name] = _unit(path, name, field)
        names.update(("member", dim) for dim in _MEMBERS if field.sizes.get(dim, 1) > 1)
        field = _with_dimensions(path, name, field)
        fields[name] = fields[name].combine_first(field) if name in fields else field
    # Numbers of fields at the same place are the same to the last bit: grids of one file need no tolerance.
    data = xr.merge([field.rename(name) for name, field in fields.items()], join=join, compat="override", combine_attrs="drop")
    if not all(data.sizes.values()):
        raise DataError(
            f"{path}: {', '.join(names[name] for name in fields)} have no times and places in common; bring a file in which they have"
        )
    order = [dim for dim in ("time", "member", "latitude", "longitude") if dim in data.dims]
    return WeatherGrid(path, data[[name for name in QUANTITIES if name in fields]].transpose(*order), units, names, tuple(notes))


def _netcdf_fields(path: Path, notes: list[str]) -> list[tuple[str, Any]]:
    """Return the fields of a NetCDF file by our names."""
    data = _opened(path, lambda: _decoded(path))
    data = data.rename(_place_names(path, data))
    found = _named(path, data, notes)
    data = data[list(found.values())]
    if "expver" in data.dims:
        data = _final_first(path, data, notes)
    elif "expver" in data.coords:
        versions = np.atleast_1d(data["expver"].values).astype("U4")
        early = int(np.sum(np.char.lstrip(versions, "0") == "5"))
        if early:
            notes.append(f"{early} of {versions.size} times are preliminary (expver 5)")
    return [(ours, data[name]) for ours, name in found.items()]


def _decoded(path: Path) -> Any:
    import xarray as xr

    raw = xr.open_dataset(path, engine="scipy" if _magic(path)[:3] == b"CDF" else "h5netcdf", decode_cf=False)
    for name in map(str, raw.variables):
        # GrADS Data Servers count days from year 1 of the calendar that changes from Julian to Gregorian in 1582, as CF's standard one.
        since = re.fullmatch(r"days since 0*1-0?1-0?1(\D.*)?", str(raw[name].attrs.get("units", "")))
        if since and raw[name].attrs.get("calendar", "standard") in ("standard", "gregorian"):
            days = raw[name].values.astype(np.float64) - 719_164.0
            raw = raw.assign({name: (raw[name].dims, days, {"units": "days since 1970-01-01"})})
    return xr.decode_cf(raw, decode_timedelta=True)


def _opened(path: Path, opened: Any) -> Any:
    try:
        return opened()
    except SeaglintError:
        raise
    except Exception as error:  # xarray, h5py and eccodes raise nearly anything
        reason = reason_of(error)
        drop_quietly(error)
        raise DataError(f"{path}: cannot be read as a grid of weather ({reason}); is it whole?") from None


def _place_names(path: Path, data: Any) -> dict[str, str]:
    """Return the names of latitude and longitude to be changed to ours."""
    out = {}
    for name, (short, unit) in _PLACES.items():
        if name in data.coords:
            continue
        alike = [str(n) for n in data.coords if str(n).lower() in (name, short)]
        alike = alike or [str(n) for n in data.coords if data[n].attrs.get("standard_name") == name or data[n].attrs.get("units") == unit]
        if not alike:
            coords = ", ".join(map(str, data.coords))
            raise DataError(f"{path}: has {coords or 'no coordinates'}; a file of weather has time, latitude and longitude")
        out[alike[0]] = name
    return out


def _named(path: Path, data: Any, notes: list[str]) -> dict[str, str]:
    """Return the variables that are read, by our names."""
    plain = {_plain(str(name)): str(name) for name in data.data_vars}
    found = {}
    for ours, quantity in QUANTITIES.items():
        # Ensembles of THREDDS end in _ens.
        alike = [plain[key] for name in quantity.names for key in (_plain(name), _plain(name) + "ens") if key in plain]
        if alike and (ours in _WIND or _fits(data[alike[0]], quantity)):
            found[ours] = alike[0]
            if alike[0].lower() in ("ugrd", "vgrd") and not _heights(data[alike[0]]):
                notes.append(f"{alike[0]} states no height: taken as the wind at 10 m")
            continue
        named = [str(name) for name, field in data.data_vars.items() if field.attrs.get("standard_name") == quantity.standard]
        if quantity.height is not None:
            named = [name for name in named if quantity.height in _heights(data[name])]
        if len(named) > 1:
            raise DataError(f"{path}: {', '.join(named)} are all {quantity.standard}; remove all but one of them")
        if named:
            found[ours] = named[0]
    if not found:
        known = ", ".join(QUANTITIES)
        raise DataError(f"{path}: has {', '.join(map(str, data.data_vars)) or 'no variables'}; of a file of weather {known} are read")
    return found


def _plain(name: str) -> str:
    return re.sub(r"[^a-z0-9]", "", name.lower())


def _fits(field: Any, quantity: GridQuantity) -> bool:
    """Return true where a field is at the height of its quantity, or states none."""
    heights = _heights(field)
    return quantity.height is None or not heights or quantity.height in heights


def _heights(field: Any) -> list[float]:
    """Return the heights above the surface that a field states [m]: by a coordinate, else by its level or description."""
    # Coordinates of a single value are those of every field to xarray; the field itself names its own ones.
    own = {*map(str, field.dims), *str(field.encoding.get("coordinates", "")).split()}
    for name in map(str, field.coords):
        if name in own and str(field[name].attrs.get("units", "")) in _METRES:
            return [round(float(value), 3) for value in np.atleast_1d(field[name].values)]
    text = " ".join(str(field.attrs.get(key, "")) for key in ("level", "long_name"))
    return [float(number) for number in _STATED_HEIGHT.findall(text)]


def _grib_fields(path: Path, notes: list[str]) -> list[tuple[str, Any]]:
    """Return the fields of a GRIB file by our names: those of a moment where there are averages too."""
    try:
        import cfgrib
    except (ImportError, RuntimeError):  # cfgrib raises the latter where the library ecCodes is not found
        raise missing(f"{path}: GRIB", "cfgrib", "or download NetCDF") from None

    def opened() -> Any:
        # Fields of different steps, levels and grids are separate datasets to cfgrib.
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", FutureWarning)  # of xarray, about cfgrib's own merging
            return cfgrib.open_datasets(str(path), backend_kwargs={"indexpath": ""})

    parts = _opened(path, opened)
    by_name = {name: ours for ours, quantity in QUANTITIES.items() for name in quantity.names[:2]}
    fields = [(by_name[str(n)], field) for part in parts for n, field in part.data_vars.items() if str(n) in by_name]
    fields = [(ours, field) for ours, field in fields if field.attrs.get("GRIB_typeOfLevel", "unknown") in _LEVELS]
    if not fields:
        there = ", ".join(str(name) for part in parts for name in part.data_vars)
        raise DataError(f"{path}: has {there or 'no fields'} at the surface; of a file of weather {', '.join(QUANTITIES)} are read")
    if any(not set(_PLACES) <= set(field.dims) for _, field in fields):
        raise DataError(f"{path}: is no grid along latitudes and longitudes; interpolate it to one, e.g. cdo -f nc remapbil,r1440x721")
    instant = {ours for ours, field in fields if field.attrs.get("GRIB_stepType") == "instant"}
    for ours in sorted({ours for ours, _ in fields} - instant):
        notes.append(f"{ours} is an average over the time before each step")
    return [(ours, field) for ours, field in fields if ours not in instant or field.attrs.get("GRIB_stepType") == "instant"]


def _unit(path: Path, name: str, field: Any) -> str:
    """Return the unit that a field states, as one of its quantity."""
    unit, allowed = field.attrs.get("units"), QUANTITIES[name].units
    if unit is None:
        # GrADS Data Servers write the unit at the end of the description: "... u-component of wind [m/s]".
        stated = re.search(r"\[([^\]]+)\]\s*$", str(field.attrs.get("long_name", "")))
        unit = None if stated is None else stated[1]
    if unit is None or str(unit).strip() not in allowed:
        what = "no attribute units" if unit is None else f"the unknown unit '{unit}'"
        raise DataError(
            f"{path}: {field.name} has {what}; allowed are {', '.join(allowed)}: convert it, or use CSV with map='NAME=COLUMN:UNIT'"
        )
    return str(unit).strip()


def _with_dimensions(path: Path, name: str, field: Any) -> Any:
    """Return a field over time, member where there is one, latitude and longitude."""
    field = _timed(path, _at_height(path, name, field))
    for dim in _MEMBERS[1:]:
        if field.sizes.get(dim, 1) > 1 and "member" not in field.dims:
            field = field.drop_vars("member", errors="ignore").rename({dim: "member"})
    for dim in map(str, field.dims):
        if dim in ("time", "member", *_PLACES):
            continue
        if field.sizes[dim] > 1:
            raise DataError(f"{path}: has {field.sizes[dim]} entries of '{dim}'; select one of them, as in xarray: isel({dim}=0)")
        field = field.isel({dim: 0}, drop=True)
    for place in _PLACES:
        if field[place].ndim > 1:
            raise DataError(f"{path}: {place} has {field[place].ndim} dimensions; interpolate to a grid of latitudes and longitudes")
        if place not in field.dims:
            field = field.expand_dims(place)
    return field.drop_vars([n for n in field.coords if n not in ("time", "member", *_PLACES)])


def _at_height(path: Path, name: str, field: Any) -> Any:
    """Return a field at the height of its quantity; one at other heights is refused."""
    height = QUANTITIES[name].height
    if height is None:
        return field
    if not _fits(field, QUANTITIES[name]):
        there = ", ".join(f"{value:g}" for value in _heights(field))
        raise DataError(f"{path}: {field.name} is at the height {there} m; {height:g} m is needed: bring a file that has it")
    for dim in map(str, field.dims):
        if dim in field.coords and str(field[dim].attrs.get("units", "")) in _METRES:
            field = field.isel({dim: _heights(field).index(height)}, drop=True)
    return field


def _timed(path: Path, field: Any) -> Any:
    """Return a field over its valid time."""
    if {"time", "step"} <= set(field.dims):
        if field.sizes["time"] > 1 and field.sizes["step"] > 1:
            n, steps = field.sizes["time"], field.sizes["step"]
            raise DataError(f"{path}: has {n} forecasts of {steps} steps each; select one of them, as in xarray: isel(time=0)")
        field = field.isel({"time" if field.sizes["time"] == 1 else "step": 0})
    if {"time", "step"} <= set(field.coords) and "valid_time" not in field.coords:
        field = field.assign_coords(valid_time=field["time"] + field["step"])
    moments = [str(n) for n in field.coords if np.issubdtype(field[n].dtype, np.datetime64) and field[n].ndim <= 1]
    along = [n for n in moments if n in field.dims or field[n].ndim == 1]
    name = next((n for n in ("valid_time", *along, "time", *moments) if n in moments), None)
    if name is None:
        raise DataError(
            f"{path}: {field.name} has {', '.join(map(str, field.coords))} and no time that can be read; a file of weather has time, "
            "latitude and longitude, the time as 'hours since 2026-06-20' or the like"
        )
    if field[name].ndim == 0:
        field = field.expand_dims(name)
    elif name not in field.dims:
        field = field.swap_dims({field[name].dims[0]: name})
    if name == "time":
        return field
    return field.drop_vars("time", errors="ignore").rename({name: "time"})


def _final_first(path: Path, data: Any, notes: list[str]) -> Any:
    """Return final values of ERA5 where there are any, preliminary ones elsewhere."""
    versions = [int(v) for v in np.atleast_1d(data["expver"].values)]
    if not set(versions) <= {1, 5}:
        raise DataError(f"{path}: has expver {versions}; ERA5 has 1 (final) and 5 (preliminary): select one of them")
    # 1 is final and 5 preliminary: the smaller number takes precedence.
    final = data.isel(expver=versions.index(min(versions)), drop=True)
    if len(versions) == 1:
        return final
    early = data.isel(expver=versions.index(5), drop=True)
    taken = sum(int((final[name].isnull() & early[name].notnull()).any(("latitude", "longitude")).sum()) for name in list(data)[:1])
    notes.append(f"{taken} of {data.sizes[next(n for n in ('valid_time', 'time') if n in data.dims)]} times are preliminary (expver 5)")
    out = final.combine_first(early)
    for name in map(str, out.data_vars):
        out[name].attrs = data[name].attrs
    return out
