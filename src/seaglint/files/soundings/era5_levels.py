"""Reader of soundings in NetCDF: ERA5's pressure levels at a place, as the Climate Data Store writes them; sondes by their own reader."""

from __future__ import annotations

from datetime import UTC, datetime
from pathlib import Path
from typing import Any, Final

import numpy as np

from seaglint.base.errors import DataError
from seaglint.files.netcdf import open_netcdf
from seaglint.files.soundings.ozone_columns import ozone_columns, with_ozone
from seaglint.files.soundings.raw_sounding import Humidity, RawSounding, others_left
from seaglint.files.soundings.sonde_netcdf import is_sonde, numeric_variables, read_sonde

LEVELS: Final = ("pressure_level", "level", "isobaricInhPa", "plev", "isobaric")
TIMES: Final = ("valid_time", "time")
HEIGHTS: Final = ("z", "gh", "geopotential", "geopotential_height")
TEMPERATURES: Final = ("t", "ta", "temperature")
MOISTURES: Final[dict[str, Humidity]] = {
    "q": "specific_humidity", "hus": "specific_humidity", "specific_humidity": "specific_humidity",
    "r": "relative_humidity_percent", "hur": "relative_humidity_percent", "relative_humidity": "relative_humidity_percent",
}  # fmt: skip


def read_netcdf_sounding(path: Path, place: tuple[float, float] | None, time: datetime | None, remedy: str) -> RawSounding:
    """Read the levels of a sonde, or the column of the nearest grid point and hour.

    Raises
    ------
    DataError
        Variables missing, or many places without one that was asked for.
    """
    with open_netcdf(path, decode_times=False) as plain:
        if is_sonde(plain):
            return read_sonde(path, plain)
    with open_netcdf(path, decode_times=True) as data:
        names = {what: _first(data, known) for what, known in (("level", LEVELS), ("height", HEIGHTS), ("temperature", TEMPERATURES))}
        moist = next((name for name in MOISTURES if name in data), None)
        missing = [
            f"{what} ({', '.join(known[:2])})"
            for what, known in (("level", LEVELS), ("height", HEIGHTS), ("temperature", TEMPERATURES))
            if names[what] is None
        ] + ([] if moist else ["humidity (q, r)"])
        if missing or moist is None:
            raise DataError(f"{path}: variables are {', '.join(str(v) for v in data.variables)}; missing: {', '.join(missing)}")
        at, notes = _selected(path, data, place, time, remedy)
        column = {what: np.asarray(at[name].values, dtype=np.float64).ravel() for what, name in names.items() if name is not None}
        height = column["height"]
        units = str(data[names["height"]].attrs.get("units", ""))
        if names["height"] in ("z", "geopotential") and units != "m":
            height = height / 9.80665
        pressure = column["level"]
        if str(data[names["level"]].attrs.get("units", "hPa")) == "Pa" or pressure.max() > 2000.0:
            pressure = 0.01 * pressure
        humidity = np.asarray(at[moist].values, dtype=np.float64).ravel()
        ozone = ozone_columns(path, *numeric_variables(data), what="variable")
        amounts = {one.place: np.asarray(at[one.name].values, dtype=np.float64).ravel() for one in ozone}
        if not pressure.size == height.size == humidity.size == column["temperature"].size or any(
            v.size != pressure.size for v in amounts.values()
        ):
            raise DataError(f"{path}: its variables have more dimensions than level, time, latitude and longitude; select one member")
        raw = RawSounding(
            "ERA5 pressure levels",
            pressure,
            height,
            column["temperature"],
            MOISTURES[moist],
            humidity if MOISTURES[moist] == "relative_humidity_percent" else np.maximum(humidity, 0.0),
            True,
            {"pressure": str(names["level"]), "height": str(names["height"]), "temperature": str(names["temperature"]), "humidity": moist},
            notes,
            resolution=(0.01, 5.0),
        )
        return with_ozone(raw, ozone, amounts, packed=True)


def _first(data: Any, known: tuple[str, ...]) -> str | None:
    return next((name for name in known if name in data.variables), None)


def _selected(path: Path, data: Any, place: tuple[float, float] | None, time: datetime | None, remedy: str) -> tuple[Any, tuple[str, ...]]:
    notes = []
    for name in TIMES:
        if name in data.dims and data.sizes[name] > 0:
            stamps = np.asarray(data[name].values)
            i = 0
            if time is not None and np.issubdtype(stamps.dtype, np.datetime64):
                i = int(np.argmin(np.abs(stamps - np.datetime64(time.astimezone(UTC).replace(tzinfo=None)))))
            if stamps.size > 1:
                first = ", the first," if time is None else ""
                notes.append(f"the hour {str(stamps[i])[:16]}{first} is taken, {others_left(stamps.size - 1)}")
            data = data.isel({name: i})
    latitude = next((name for name in ("latitude", "lat") if name in data.dims), None)
    longitude = next((name for name in ("longitude", "lon") if name in data.dims), None)
    if latitude is None or longitude is None or data.sizes[latitude] * data.sizes[longitude] == 1:
        return data.squeeze(), tuple(notes)
    if place is None:
        raise DataError(f"{path}: holds {data.sizes[latitude] * data.sizes[longitude]} places; {remedy}")
    lats, lons = np.asarray(data[latitude].values), np.asarray(data[longitude].values)
    i = int(np.argmin(np.abs(lats - place[0])))
    j = int(np.argmin(np.abs((lons - place[1] + 180.0) % 360.0 - 180.0)))
    step = float(np.max(np.abs(np.diff(lats)))) if lats.size > 1 else 0.25
    away = max(abs(float(lats[i]) - place[0]), abs((float(lons[j]) - place[1] + 180.0) % 360.0 - 180.0))
    if away > max(1.0, 2.0 * step):
        raise DataError(
            f"{path}: its nearest place, {lats[i]:g}, {lons[j]:g} deg, is {away:.1f} deg from {place[0]:g}, {place[1]:g}; get another file"
        )
    notes.append(f"the grid point {lats[i]:g}, {lons[j]:g} deg is taken")
    return data.isel({latitude: i, longitude: j}), tuple(notes)
