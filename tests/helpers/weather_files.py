"""Files of weather in the exact layouts of ERA5, ICOADS and NDBC, made for the tests."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import xarray as xr

ERA5_LATITUDES = np.array([50.25, 50.0, 49.75])
ERA5_LONGITUDES = np.array([0.0, 0.25, 359.5, 359.75])
ERA5_TIMES = np.array(["2019-01-31T23", "2019-07-01T06", "2019-07-01T18"], dtype="datetime64[ns]")


def era5_fields(seed: int = 3) -> dict[str, np.ndarray]:
    """Values before packing; sea temperature and waves are masked at one point of land."""
    rng = np.random.default_rng(seed)
    shape = (ERA5_TIMES.size, ERA5_LATITUDES.size, ERA5_LONGITUDES.size)
    fields = {
        "u10": rng.normal(0.0, 8.0, shape),
        "v10": rng.normal(0.0, 8.0, shape),
        "tcc": rng.random(shape),
        "sst": rng.uniform(280.0, 290.0, shape),
        "t2m": rng.uniform(278.0, 288.0, shape),
        "d2m": rng.uniform(270.0, 277.0, shape),
        "swh": rng.uniform(0.5, 6.0, shape),
    }
    fields["tcc"][0, 0, 0], fields["tcc"][0, 0, 1] = 0.0, 1.0
    for name in ("sst", "swh"):
        fields[name][:, 2, 1] = np.nan
    return fields


_UNITS = {"u10": "m s**-1", "v10": "m s**-1", "tcc": "(0 - 1)", "sst": "K", "t2m": "K", "d2m": "K", "swh": "m"}


def _packing(values: np.ndarray) -> dict[str, object]:
    """Scale and offset as ECMWF's converter chooses them: the range in 65 534 steps of a signed short."""
    low, high = np.nanmin(values), np.nanmax(values)
    scale = (high - low) / 65532.0
    return {
        "dtype": "int16",
        "scale_factor": scale,
        "add_offset": 0.5 * (low + high),
        "_FillValue": np.int16(-32767),
        "missing_value": np.int16(-32767),
    }


def write_era5_old(path: Path, fields: dict[str, np.ndarray], *, expver: bool = False) -> Path:
    """Layout before September 2024: classic NetCDF, packed shorts, dimension ``time`` in hours since 1900, perhaps ``expver``."""
    dims = ("time", "latitude", "longitude")
    data = {name: (dims, values, {"units": _UNITS[name]}) for name, values in fields.items()}
    out = xr.Dataset(data, {"time": ERA5_TIMES, "latitude": ERA5_LATITUDES.astype("f4"), "longitude": ERA5_LONGITUDES.astype("f4")})
    if expver:
        # The last time is preliminary: version 1 lacks it, version 5 lacks the others.
        late = xr.DataArray(np.arange(ERA5_TIMES.size) == ERA5_TIMES.size - 1, dims="time")
        out = xr.concat([out.where(~late), out.where(late)], xr.IndexVariable("expver", np.array([1, 5], dtype="i4"))).transpose(
            "time", "expver", ...
        )
        for name in fields:
            out[name].attrs["units"] = _UNITS[name]
    encoding: dict[str, dict[str, object]] = {name: _packing(values) for name, values in fields.items()}
    encoding["time"] = {"units": "hours since 1900-01-01 00:00:00.0", "dtype": "int32"}
    out.to_netcdf(path, engine="scipy", format="NETCDF3_64BIT", encoding=encoding)
    return path


def write_era5_new(path: Path, fields: dict[str, np.ndarray], *, west_east: bool = False) -> Path:
    """Layout since September 2024: NetCDF 4, floats, ``valid_time`` in seconds since 1970, ``number`` and ``expver`` beside it."""
    dims = ("valid_time", "latitude", "longitude")
    units = {**_UNITS, "tcc": "(0 - 1)"}
    data = {name: (dims, values.astype("f4"), {"units": units[name]}) for name, values in fields.items()}
    longitudes = (ERA5_LONGITUDES + 180.0) % 360.0 - 180.0 if west_east else ERA5_LONGITUDES
    coords = {
        "valid_time": ERA5_TIMES,
        "latitude": ERA5_LATITUDES,
        "longitude": longitudes,
        "number": 0,
        "expver": ("valid_time", np.array(["0001", "0001", "0005"])),
    }
    encoding = {"valid_time": {"units": "seconds since 1970-01-01", "dtype": "int64"}, "expver": {"dtype": "S4"}}
    xr.Dataset(data, coords).to_netcdf(path, engine="h5netcdf", encoding=encoding)
    return path


_GRIB_CODES = {"u10": 165, "v10": 166, "tcc": 164, "sst": 34, "t2m": 167, "d2m": 168, "swh": 140229}
ERA5_GRIB_LONGITUDES = np.array([350.0, 350.25, 350.5, 350.75])


def write_era5_grib(path: Path, fields: dict[str, np.ndarray]) -> Path:
    """GRIB 1 messages of 16 bits, one a field and time, land masked by a bitmap; needs ecCodes."""
    import eccodes as ec

    lats, lons = ERA5_LATITUDES, ERA5_GRIB_LONGITUDES
    with path.open("wb") as file:
        for name, field in fields.items():
            for moment, values in zip(ERA5_TIMES.astype(str), field, strict=False):
                message = ec.codes_grib_new_from_samples("regular_ll_sfc_grib1")
                keys = {
                    "Ni": lons.size,
                    "Nj": lats.size,
                    "latitudeOfFirstGridPointInDegrees": lats[0],
                    "latitudeOfLastGridPointInDegrees": lats[-1],
                    "longitudeOfFirstGridPointInDegrees": lons[0],
                    "longitudeOfLastGridPointInDegrees": lons[-1],
                    "iDirectionIncrementInDegrees": 0.25,
                    "jDirectionIncrementInDegrees": 0.25,
                    "paramId": _GRIB_CODES[name],
                    "dataDate": int(moment[:10].replace("-", "")),
                    "dataTime": 100 * int(moment[11:13]),
                    "bitmapPresent": 1,
                    "missingValue": 9999.0,
                    "bitsPerValue": 16,
                }
                for key, value in keys.items():
                    ec.codes_set(message, key, value.item() if isinstance(value, np.generic) else value)
                ec.codes_set_values(message, np.where(np.isnan(values), 9999.0, values).ravel())
                ec.codes_write(message, file)
                ec.codes_release(message)
    return path


def imma(
    *,
    yr: str = "2005",
    mo: str = " 7",
    dy: str = "14",
    hr: str = " 650",
    lat: str = " 4512",
    lon: str = " 33075",
    d: str = "270",
    w: str = "103",
    vv: str = "97",
    ww: str = "02",
    at: str = " 152",
    dpt: str = " 101",
    sst: str = " 164",
    n: str = "6",
    wh: str = " 3",
    sh: str = " 4",
) -> str:
    """One record: the 108 characters of the core, and a piece of an attachment behind it."""
    location = f"{yr:4}{mo:2}{dy:2}{hr:4}{lat:5}{lon:6}" + " 1" + "3" + "0" + "4" + " " + " " + "  " + " 1" + "SHIP12345"[:9] + "  "
    regular = (
        " "
        + f"{d:3}"
        + "4"
        + f"{w:3}"
        + "0"
        + f"{vv:2}"
        + f"{ww:2}"
        + "1"
        + "10132"
        + "2"
        + "  5"
        + "3"
        + f"{at:4}"
        + " "
        + "    "
        + "0"
        + f"{dpt:4}"
        " 0" + f"{sst:4}" + f"{n:1}" + "5" + "5" + "0" + "4" + "7" + "0" + "26" + " 6" + f"{wh:2}" + "27" + " 9" + f"{sh:2}"
    )
    assert (len(location), len(regular)) == (45, 63)
    return location + regular + " 165 ATTACHMENT"


NDBC_2019 = """\
#YY  MM DD hh mm WDIR WSPD GST  WVHT   DPD   APD MWD   PRES  ATMP  WTMP  DEWP  VIS  TIDE
#yr  mo dy hr mn degT m/s  m/s     m   sec   sec degT   hPa  degC  degC  degC  nmi    ft
2019 01 01 00 50 310 12.3 15.0  3.21  9.09  6.50 300 1012.3   4.1   8.2   1.0  1.6 99.00
2019 01 01 01 50 999 99.0 99.0 99.00 99.00 99.00 999 9999.0 999.0   8.3 999.0 99.0 99.00
2019 07 01 02 50 180  0.0  1.0  0.51  5.09  4.50 170 1010.0  18.0  17.2  16.5 99.0 99.00
"""

NDBC_1996 = """\
YY MM DD hh WD   WSPD GST  WVHT  DPD   APD  MWD  BAR    ATMP  WTMP  DEWP  VIS
96 12 31 23 290 08.7 10.1 02.50 09.10 06.60 999 1008.4 002.1 007.5 999.0 99.0
96 06 01 00 045 03.1 04.0 99.00 99.00 99.00 999 1015.4 010.1 009.5 008.0 99.0
"""

NDBC_REALTIME = """\
#YY  MM DD hh mm WDIR WSPD GST  WVHT   DPD   APD MWD   PRES  ATMP  WTMP  DEWP  VIS PTDY  TIDE
#yr  mo dy hr mn degT m/s  m/s     m   sec   sec degT   hPa  degC  degC  degC  nmi  hPa    ft
2026 03 02 11 50 230  7.0  9.0   1.8     8   5.2 220 1016.2   6.0   5.5   3.1   MM -1.2    MM
2026 03 02 10 50  MM   MM   MM   1.8     8   5.2 220 1016.2   6.0    MM   3.1   MM   MM    MM
"""
