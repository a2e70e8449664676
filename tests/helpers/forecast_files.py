"""Files of forecasts in the layouts of ECMWF, wgrib2, GrADS Data Servers, THREDDS and GRIB, made for the tests."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np
import xarray as xr

DIMS = ("time", "latitude", "longitude")
METRES = {"units": "m/s"}


class Fields(NamedTuple):
    """Wind components [m/s] and cover [1] over time, perhaps members, latitude and longitude."""

    time: np.ndarray
    latitude: np.ndarray
    longitude: np.ndarray
    u: np.ndarray
    v: np.ndarray
    cover: np.ndarray


def fields(seed: int = 1, *, latitude=(52.0, 51.0, 50.0), longitude=(358.0, 359.0, 0.0, 1.0), steps: int = 4, members: int = 0) -> Fields:
    """Random fields every six hours; covers are quarters, exact in percent as well."""
    rng = np.random.default_rng(seed)
    time = np.datetime64("2026-06-20T00", "ns") + 6 * np.arange(steps) * np.timedelta64(1, "h")
    shape = (steps, *((members,) if members else ()), len(latitude), len(longitude))
    wind = np.float64(np.float32(rng.normal(0.0, 6.0, (2, *shape))))
    return Fields(time, np.array(latitude), np.array(longitude), wind[0], wind[1], rng.integers(0, 5, shape) / 4.0)


def ecmwf(path: Path, of: Fields, names: tuple[str, str, str] = ("u10", "v10", "tcc"), **units: str) -> Path:
    """Valid times, names of ERA5 and of the open data, members as ``number``."""
    dims = ("valid_time", *(("number",) if of.u.ndim == 4 else ()), "latitude", "longitude")
    unit = {"u10": "m s**-1", "v10": "m s**-1", "tcc": "(0 - 1)"} | units
    data = {n: (dims, v, {"units": unit[k]}) for n, k, v in zip(names, ("u10", "v10", "tcc"), (of.u, of.v, of.cover), strict=True)}
    coords = {"valid_time": of.time, "latitude": of.latitude, "longitude": of.longitude}
    xr.Dataset(data, coords).to_netcdf(path, engine="h5netcdf", encoding={"valid_time": {"units": "seconds since 1970-01-01"}})
    return path


def wgrib2(path: Path, of: Fields) -> Path:
    """``wgrib2 -netcdf``: latitudes ascend, longitudes 0-360 ascend, level in an attribute, cloud in percent, NetCDF 3."""
    low = {"level": "10 m above ground"}
    data = {
        "UGRD_10maboveground": (DIMS, of.u, METRES | low | {"long_name": "U-Component of Wind", "short_name": "UGRD_10maboveground"}),
        "VGRD_10maboveground": (DIMS, of.v, METRES | low | {"long_name": "V-Component of Wind"}),
        "TCDC_entireatmosphere": (DIMS, 100.0 * of.cover, {"units": "percent", "level": "entire atmosphere"}),
        "TCDC_lowcloudlayer": (DIMS, 0.0 * of.cover, {"units": "percent", "level": "low cloud layer"}),
    }
    coords = {"time": of.time, "latitude": of.latitude, "longitude": of.longitude % 360.0}
    out = xr.Dataset(data, coords).sortby(["latitude", "longitude"])
    encoding = {name: {"_FillValue": 9.999e20, "dtype": "f8"} for name in data}
    encoding["time"] = {"units": "seconds since 1970-01-01 00:00:00.0 0:00", "dtype": "f8"}
    out.to_netcdf(path, engine="scipy", encoding=encoding)
    return path


def grads(path: Path, of: Fields) -> Path:
    """GrADS Data Server, saved as NetCDF: no attribute units, days since year 1 of the mixed calendar."""
    stated = {"ugrd10m": "10 m above ground u-component of wind [m/s]", "vgrd10m": "10 m above ground v-component of wind [m/s]"}
    stated["tcdcclm"] = "entire atmosphere total cloud cover [%]"
    values = {"ugrd10m": of.u, "vgrd10m": of.v, "tcdcclm": 100.0 * of.cover}
    data = {name: (("time", "lat", "lon"), values[name], {"long_name": f"** {text} "}) for name, text in stated.items()}
    # 2026-06-20 is the Julian day 2461211.5, and the first of January of the year 1 of the Julian calendar 1721423.5.
    days = 2461211.5 - 1721423.5 + (of.time - of.time[0]) / np.timedelta64(1, "D")
    coords = {
        "time": ("time", days, {"units": "days since 1-1-1 00:00:0.0", "grads_min": "00z20jun2026"}),
        "lat": ("lat", of.latitude, {"units": "degrees_north"}),
        "lon": ("lon", of.longitude % 360.0, {"units": "degrees_east"}),
    }
    xr.Dataset(data, coords).sortby("lat").to_netcdf(path, engine="h5netcdf")
    return path


def thredds(path: Path, of: Fields, heights: tuple[float, ...] = (10.0, 80.0)) -> Path:
    """NetCDF subset of a THREDDS server: names of NetCDF-Java, a dimension of heights, reference time beside the valid one."""
    dims = ("time1", "height_above_ground2", "lat", "lon")
    level = np.array([1.0 if height == 10.0 else 1.7 for height in heights])[None, :, None, None]
    data = {
        "u-component_of_wind_height_above_ground": (dims, of.u[:, None] * level, METRES),
        "v-component_of_wind_height_above_ground": (dims, of.v[:, None] * level, METRES),
        "Total_cloud_cover_entire_atmosphere": (("time1", "lat", "lon"), 100.0 * of.cover, {"units": "%"}),
        "Total_cloud_cover_entire_atmosphere_Mixed_intervals_Average": (("time1", "lat", "lon"), 50.0 * of.cover, {"units": "%"}),
    }
    coords = {
        "time1": ("time1", of.time, {"standard_name": "time"}),
        "reftime": of.time[0] - np.timedelta64(6, "h"),
        "height_above_ground2": ("height_above_ground2", np.array(heights), {"units": "m"}),
        "lat": ("lat", of.latitude, {"units": "degrees_north"}),
        "lon": ("lon", of.longitude, {"units": "degrees_east"}),
    }
    encoding = {"time1": {"units": "Hour since 2026-06-20T00:00:00Z"}, "reftime": {"units": "Hour since 2026-06-20T00:00:00Z"}}
    xr.Dataset(data, coords).to_netcdf(path, engine="h5netcdf", encoding=encoding)
    return path


def steps(path: Path, of: Fields) -> Path:
    """What xarray writes of cfgrib's dataset: reference time and steps, here without the valid time."""
    dims = ("step", "latitude", "longitude")
    data = {name: (dims, values, {"units": unit}) for name, values, unit in
            (("u10", of.u, "m s**-1"), ("v10", of.v, "m s**-1"), ("tcc", 100.0 * of.cover, "%"))}  # fmt: skip
    coords = {"time": of.time[0], "step": of.time - of.time[0], "latitude": of.latitude, "longitude": of.longitude}
    xr.Dataset(data, coords).to_netcdf(path, engine="h5netcdf")
    return path


def standard_names(path: Path, of: Fields) -> Path:
    """CF: names of a centre's own, standard names, the height as a scalar coordinate; another wind at 100 m beside it."""
    data = {
        "wx": (DIMS, of.u, {"standard_name": "eastward_wind", "units": "m s-1", "coordinates": "height"}),
        "wy": (DIMS, of.v, {"standard_name": "northward_wind", "units": "m s-1", "coordinates": "height"}),
        "wx100": (DIMS, 2.0 * of.u, {"standard_name": "eastward_wind", "units": "m s-1", "long_name": "wind at 100 m"}),
        "n": (DIMS, 8.0 * of.cover, {"standard_name": "cloud_area_fraction", "units": "okta"}),
    }
    out = xr.Dataset(data, {"time": of.time, "latitude": of.latitude, "longitude": of.longitude})
    out["height"] = ((), 10.0, {"units": "m"})
    out.to_netcdf(path, engine="h5netcdf")
    return path


LAYOUTS = {
    "10u": lambda path, of: ecmwf(path, of, ("10u", "10v", "tcc")),
    "wgrib2": wgrib2,
    "grads": grads,
    "thredds": thredds,
    "steps": steps,
    "standard names": standard_names,
}


def grib(path: Path, of: Fields, members: int = 0) -> Path:
    """GRIB 2 as GFS writes it: steps of one reference time, wind at 10 and 100 m, cover in percent; needs ecCodes."""
    import eccodes as ec

    def write(file, name, values, step, level, height, member=None):
        message = ec.codes_grib_new_from_samples("regular_ll_pl_grib2")
        keys = {
            "Ni": of.longitude.size, "Nj": of.latitude.size,
            "latitudeOfFirstGridPointInDegrees": float(of.latitude[0]), "latitudeOfLastGridPointInDegrees": float(of.latitude[-1]),
            "longitudeOfFirstGridPointInDegrees": float(of.longitude[0]), "longitudeOfLastGridPointInDegrees": float(of.longitude[-1]),
            "iDirectionIncrementInDegrees": 1.0, "jDirectionIncrementInDegrees": 1.0,
            "centre": "kwbc", "dataDate": 20260620, "dataTime": 0, "stepUnits": 1,
        }  # fmt: skip
        if member is not None:
            keys |= {"productDefinitionTemplateNumber": 1, "perturbationNumber": member, "numberOfForecastsInEnsemble": members}
        discipline, category, number = {"u": (0, 2, 2), "v": (0, 2, 3), "cover": (0, 6, 1)}[name]
        keys |= {"discipline": discipline, "parameterCategory": category, "parameterNumber": number}
        keys |= {"typeOfFirstFixedSurface": level, "scaleFactorOfFirstFixedSurface": 0, "scaledValueOfFirstFixedSurface": height}
        keys |= {"forecastTime": step, "bitsPerValue": 24}
        for key, value in keys.items():
            ec.codes_set(message, key, value)
        ec.codes_set_values(message, np.ascontiguousarray(values, dtype=float).ravel())
        ec.codes_write(message, file)
        ec.codes_release(message)

    with path.open("wb") as file:
        for i in range(of.time.size):
            for m in range(members) if members else (None,):
                at = i if m is None else (i, m)
                for name, values in (("u", of.u[at]), ("v", of.v[at])):
                    write(file, name, values, 6 * i, 103, 10, m)
                    write(file, name, 2.0 * values, 6 * i, 103, 100, m)
                write(file, "cover", 100.0 * of.cover[at], 6 * i, 10, 0, m)
                write(file, "cover", 0.0 * of.cover[at], 6 * i, 100, 50000, m)
    return path


def way(path: Path, hours=range(5, 18)) -> Path:
    """A ship's way on the day of the fields, one row an hour."""
    path.write_text("time_utc,latitude_deg,longitude_deg\n" + "".join(f"2026-06-20T{h:02d}:00:00Z,51,{-1 + h / 20}\n" for h in hours))
    return path
