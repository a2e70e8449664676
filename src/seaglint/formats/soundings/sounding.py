"""Soundings of the air from files of any known format, checked and made levels from the sea up.

Formats are tables, lists of stations and archives, and NetCDF: a sonde's ascent or descent, one level a record (ARM's ``sondewnpn``, AVAPS
drops and similar files), or ERA5's pressure levels at a place, as the Climate Data Store writes them.

A model atmosphere continues the air above the last level, and humidity above its last value; below its first value humidity is constant.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, Final

import numpy as np

from seaglint.air.profile.air_profile import AirProfile, continued_humidity, sounding_profile
from seaglint.base.constants import GRAVITY
from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError
from seaglint.formats.soundings.sounding_checks import (
    DRY_AIR,
    check_hydrostatics,
    check_units,
    in_order,
    upwards,
    virtual_temperature,
    whole_humidity,
)
from seaglint.formats.soundings.sounding_columns import (
    Humidity,
    OzoneColumn,
    RawSounding,
    SoundingColumn,
    others_left,
    ozone_columns,
    plain_unit,
    sounding_column,
    sounding_of,
    with_ozone,
    with_ozone_in_ppmv,
)
from seaglint.store.netcdf import NETCDF_MAGIC, open_netcdf
from seaglint.store.outputs import storage_errors

#: Dimensions of gridded analyses, which are no sondes.
LEVEL_DIMENSIONS: Final = ("pressure_level", "level", "isobaricInhPa", "plev", "isobaric")

ROUNDED: Final = {"pressure": 0.1, "height": 1.0}  #: Steps to which sondes' pressures [hPa] and heights [m] are rounded at most.

TIMES: Final = ("valid_time", "time")
HEIGHTS: Final = ("z", "gh", "geopotential", "geopotential_height")
TEMPERATURES: Final = ("t", "ta", "temperature")
MOISTURES: Final[dict[str, Humidity]] = {
    "q": "specific_humidity", "hus": "specific_humidity", "specific_humidity": "specific_humidity",
    "r": "relative_humidity_percent", "hur": "relative_humidity_percent", "relative_humidity": "relative_humidity_percent",
}  # fmt: skip

#: Largest height of the lowest level [m]; it is continued to the sea with its own temperature and humidity.
HIGHEST_FIRST_LEVEL: Final = 500.0

LOW_TOP: Final = 20e3  #: Height below which the end of a sounding is noted [m].

TOP_M: Final = 100e3  #: Heights above are left out [m].

MOST_LEVELS: Final = 2_000_000  #: Largest number of levels that a file may have.

PLACE_OF_SCENARIO: Final = "give [place] latitude_deg and longitude_deg"  #: Remedy for a file of many places in a scenario.


def is_sonde(data: Any) -> bool:
    """Return true for a dataset whose pressures and temperatures are records along one dimension."""
    if any(name in data.dims and name in data.variables for name in LEVEL_DIMENSIONS):
        return False
    return {"pressure", "temperature"} <= {column.kind for column in _columns(data)}


def _columns(data: Any) -> list[SoundingColumn]:
    """Return the variables that hold a quantity of a sounding, by name and unit."""
    out = []
    for place, name in enumerate(map(str, data.variables)):
        variable = data[name]
        if variable.ndim == 0 or not np.issubdtype(variable.dtype, np.number):
            continue
        unit = str(variable.attrs.get("units", ""))
        column = sounding_column(place, name, plain_unit(unit))
        if column is None:
            column = sounding_column(place, str(variable.attrs.get("standard_name", "")), plain_unit(unit))
        if column is not None:
            out.append(replace(column, name=name))
    return out


def numeric_variables(data: Any) -> tuple[list[str], list[str]]:
    """Return the names of all variables of a dataset, empty for those without levels of numbers, and their units."""
    names, units = [], []
    for name in map(str, data.variables):
        names.append(name if data[name].ndim > 0 and np.issubdtype(data[name].dtype, np.number) else "")
        units.append(str(data[name].attrs.get("units", "")))
    return names, units


def read_sonde(path: Path, data: Any) -> RawSounding:
    """Read the records of one sonde.

    Raises
    ------
    DataError
        Variables missing, or several sondes in one file.
    """
    columns, numbers = _columns(data), {}
    names, units = numeric_variables(data)
    ozone = ozone_columns(path, names, units, what="variable")
    read: list[SoundingColumn | OzoneColumn] = [*columns, *ozone]
    for column in read:
        variable = data[column.name]
        long = [str(name) for name in variable.dims if variable.sizes[name] > 1]
        if len(long) > 1:
            raise DataError(f"{path}: {column.name} has the dimensions {', '.join(long)}; give a file of one sonde")
        numbers[column.place] = _floats(data, column.name)
    missing = [what for what in ("pressure", "height", "temperature", "humidity") if what not in {c.quantity for c in columns}]
    if missing:
        raise DataError(f"{path}: variables are {', '.join(str(v) for v in data.variables)}; missing: {', '.join(missing)}")
    if len({v.size for v in numbers.values()}) > 1:
        sizes = ", ".join(f"{column.name} {numbers[column.place].size}" for column in read)
        raise DataError(f"{path}: its variables differ in length ({sizes}); give a file of one sonde")
    geopotential = any(
        "geopotential" in str(data[column.name].attrs.get("long_name", "")).lower() for column in columns if column.kind == "height"
    )
    steps = {column.place: ROUNDED.get(column.kind, 1.0) / column.factor for column in columns}
    attributes = " ".join(str(value) for value in data.attrs.values() if isinstance(value, str)).lower()
    form = "AVAPS (NetCDF)" if "avaps" in attributes else "ARM sonde (NetCDF)" if "base_time" in data.variables else "sonde (NetCDF)"
    return with_ozone(sounding_of(form, columns, numbers, steps, geopotential=geopotential), ozone, numbers)


def read_netcdf_sounding(path: Path, place: tuple[float, float] | None, time: datetime | None, remedy: str) -> RawSounding:
    """Read the levels of a sonde, or the column of the nearest grid point and hour.

    Raises
    ------
    DataError
        Variables missing, or many places and no requested one.
    """
    with open_netcdf(path, decode_times=False) as plain:
        if is_sonde(plain):
            return read_sonde(path, plain)
    with open_netcdf(path, decode_times=True) as data:
        needed = {"level": LEVEL_DIMENSIONS, "height": HEIGHTS, "temperature": TEMPERATURES}
        names = {what: next((name for name in known if name in data.variables), None) for what, known in needed.items()}
        moist = next((name for name in MOISTURES if name in data), None)
        missing = [f"{what} ({', '.join(known[:2])})" for what, known in needed.items() if names[what] is None]
        missing += [] if moist else ["humidity (q, r)"]
        if missing or moist is None:
            raise DataError(f"{path}: variables are {', '.join(str(v) for v in data.variables)}; missing: {', '.join(missing)}")
        at, notes = _selected(path, data, place, time, remedy)
        column = {what: _floats(at, name) for what, name in names.items() if name is not None}
        height = column["height"]
        if names["height"] in ("z", "geopotential") and str(data[names["height"]].attrs.get("units", "")) != "m":
            height = height / 9.80665  # geopotential [m2 s-2] over standard gravity is geopotential height
        pressure = column["level"]
        if str(data[names["level"]].attrs.get("units", "hPa")) == "Pa" or pressure.max() > 2000.0:
            pressure = 0.01 * pressure
        humidity = _floats(at, moist)
        ozone = ozone_columns(path, *numeric_variables(data), what="variable")
        amounts = {one.place: _floats(at, one.name) for one in ozone}
        if len({values.size for values in (pressure, height, humidity, column["temperature"], *amounts.values())}) > 1:
            raise DataError(f"{path}: its variables have more dimensions than level, time, latitude and longitude; select one member")
        relative = MOISTURES[moist] == "relative_humidity_percent"
        raw = RawSounding(
            kind="ERA5 pressure levels", pressure=pressure, height=height, temperature=column["temperature"], humidity=MOISTURES[moist],
            # Packing makes dry air slightly drier than 0.
            humidity_value=humidity if relative else np.maximum(humidity, 0.0), geopotential=True,
            names={"pressure": str(names["level"]), "humidity": moist} | {what: str(names[what]) for what in ("height", "temperature")},
            notes=notes, resolution=(0.01, 5.0),
        )  # fmt: skip
        return with_ozone(raw, ozone, amounts, packed=True)


def _floats(data: Any, name: str) -> FloatArray:
    return np.asarray(data[name].values, dtype=np.float64).ravel()


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
    # The nearest point of a grid that covers the place is at most half a step away; coarse grids get some room.
    step = float(np.max(np.abs(np.diff(lats)))) if lats.size > 1 else 0.25
    away = max(abs(float(lats[i]) - place[0]), abs((float(lons[j]) - place[1] + 180.0) % 360.0 - 180.0))
    if away > max(1.0, 2.0 * step):
        raise DataError(
            f"{path}: its nearest place, {lats[i]:g}, {lons[j]:g} deg, is {away:.1f} deg from {place[0]:g}, {place[1]:g}; get another file"
        )
    notes.append(f"the grid point {lats[i]:g}, {lons[j]:g} deg is taken")
    return data.isel({latitude: i, longitude: j}), tuple(notes)


@dataclass(frozen=True, eq=False)
class Sounding:
    """Sounding from the sea up, after all checks."""

    path: str  #: Path of the file.
    kind: str  #: Format of the file.
    height: FloatArray  #: Heights of the levels, ascending from the sea [m, (levels,)].
    pressure: FloatArray  #: Pressure [hPa, (levels,)].
    temperature: FloatArray  #: Temperature [K, (levels,)].
    #: Relative humidity over water [%, (levels,)]; NaN above its highest value, where a model atmosphere continues it.
    relative_humidity: FloatArray
    notes: tuple[str, ...]  #: Sentences on levels that were chosen, left out, reordered, filled or continued.
    reported: tuple[str, ...]  #: Notes that a user of the result needs to read.
    digest: str  #: SHA-256 of the file.
    lowest_given: float  #: Height of the file's own lowest level [m].
    given: int  #: Number of levels of the file that are used.
    humidity_begins: float | None = None  #: Height of the lowest level with humidity [m], where levels below it have none.
    #: Ozone [1e-6 of the volume, (levels,)]; NaN above the highest level that has it, where a model atmosphere continues it. None for files
    #: without ozone.
    ozone_ppmv: FloatArray | None = None

    @property
    def top(self) -> float:
        """Height of the highest level [m]."""
        return float(self.height[-1])

    @property
    def humidity_top(self) -> float:
        """Height of the highest level with humidity [m]."""
        return float(self.height[np.isfinite(self.relative_humidity)][-1])

    @property
    def ozone_top(self) -> float | None:
        """Height of the highest level with ozone [m]; None for files without ozone."""
        return None if self.ozone_ppmv is None else float(self.height[np.isfinite(self.ozone_ppmv)][-1])

    def humidity(self, model: str) -> FloatArray:
        """Return relative humidity over water [%, (levels,)], continued by a model atmosphere above its highest value."""
        return continued_humidity(model, self.height, self.pressure, self.temperature, self.relative_humidity)

    def profile(self, model: str) -> AirProfile:
        """Return the profile up to 100 km, continued by a model atmosphere."""
        air = (self.height, self.pressure, self.temperature, self.humidity(model))
        return sounding_profile(self.path, model, *air, ozone_ppmv=self.ozone_ppmv)

    @property
    def provenance(self) -> dict[str, str]:
        """File, format, digest and notes, for results."""
        return {
            "sounding": self.path,
            "sounding_format": self.kind,
            "sounding_sha256": self.digest,
            "sounding_notes": "; ".join(self.notes),
        }


def read_sounding(
    path: str | Path, place: tuple[float, float] | None = None, time: datetime | None = None, *, remedy: str = PLACE_OF_SCENARIO
) -> Sounding:
    """Read a sounding in any of the formats known.

    Parameters
    ----------
    path : str or Path
        The file.
    place : (float, float), optional
        Latitude and longitude [deg], for files that hold many places.
    time : datetime, optional
        For files that hold many times; without it the first is taken.
    remedy : str
        Words of the error for a file of many places without ``place``.

    Raises
    ------
    DataError
        In one line: the value that cannot be used, and the suspected reason.
    """
    path = Path(path)
    with storage_errors(path, "give a file that can be read"):
        content = _bytes_of(path)
    raw = _raw(path, content, place, time, remedy)
    if raw.pressure.size > MOST_LEVELS:
        raise DataError(f"{path}: has {raw.pressure.size} levels; at most {MOST_LEVELS} are read")
    return _understood(path, raw, hashlib.sha256(content).hexdigest())


def _bytes_of(path: Path) -> bytes:
    if not path.exists():
        raise DataError(f"{path}: no such file; give that of a sounding")
    if path.is_dir():
        raise DataError(f"{path}: is a folder; give the file of a sounding")
    return path.read_bytes()


def _raw(path: Path, content: bytes, place: tuple[float, float] | None, time: datetime | None, remedy: str) -> RawSounding:
    """Return the rows of the file by the reader of its layout, which is recognised by its content."""
    if content.startswith(NETCDF_MAGIC) or path.suffix.lower() in (".nc", ".nc4", ".cdf"):
        return read_netcdf_sounding(path, place, time, remedy)
    from seaglint.formats.soundings import text_soundings

    text = sounding_text(path, content)
    lines = text.splitlines()
    if text_soundings.is_igra(lines):
        return text_soundings.read_igra(path, lines, time)
    if text_soundings.is_wyoming_list(lines):
        return text_soundings.read_wyoming_list(path, lines, time)
    if text_soundings.is_sharppy(lines):
        return text_soundings.read_sharppy(path, lines, time)
    if text_soundings.is_bufkit(lines):
        return text_soundings.read_bufkit(path, lines, place, time)
    if text_soundings.is_avaps_record(lines):
        return text_soundings.read_avaps_record(path, lines)
    if text_soundings.is_iem_json(text):
        return text_soundings.read_iem_json(path, text, time)
    return text_soundings.read_sounding_table(path, text)


def sounding_text(path: Path, content: bytes) -> str:
    """Return the text of a file in UTF-8, UTF-16 with its mark, or Latin-1, in which older ground stations write signs of degrees.

    Raises
    ------
    DataError
        It is no text.
    """
    if content.startswith((b"\xff\xfe", b"\xfe\xff")):
        return content.decode("utf-16", errors="replace")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        if sum(content[:4096].count(bytes([code])) for code in (*range(9), *range(14, 32))):
            raise DataError(
                f"{path}: is no text (byte {error.start}); it needs levels of pressure, height, temperature and humidity"
            ) from None
        return content.decode("latin-1")


def _understood(path: Path, raw: RawSounding, digest: str) -> Sounding:
    notes, reported = list(raw.notes), list(raw.notes)

    def report(text: str) -> None:
        notes.append(text)
        reported.append(text)

    raw = _with_values(path, raw, report)
    # Units come first: all further checks compare values in their units.
    check_units(path, raw)
    raw = with_ozone_in_ppmv(path, raw)
    raw, reversed_order = upwards(path, raw)
    if reversed_order:
        notes.append("levels stand from the top down in the file and are turned round")
    humidity = raw.relative_humidity()
    raw, filled = _with_heights(path, raw, humidity)
    if filled:
        notes.append(f"{filled} heights are missing and follow from the pressures")
    if raw.geopotential:
        raw = replace(raw, height=geometric_height(raw.height))
        notes.append("heights are geopotential and are made geometric")
    inside = (raw.height >= 0.0) & (raw.height <= TOP_M)
    if not inside.all():
        report(f"{int((~inside).sum())} of {inside.size} levels lie below the sea or above 100 km and are left out")
        raw, humidity = raw.at(inside), humidity[inside]
    if raw.height.size:
        raw, humidity, done, lost = in_order(path, raw, humidity)
        notes.extend(done)
        for text in lost:
            report(text)
    if raw.height.size < 2:
        raise DataError(f"{path}: has no two levels from the sea to 100 km; give heights above the sea in metres")
    known = np.flatnonzero(np.isfinite(humidity))
    begins = float(raw.height[known[0]]) if known.size and known[0] > 0 else None
    if begins is not None:
        notes.append(f"humidity begins at {begins:.0f} m; below it is the relative humidity of that level")
    humidity = _without_gaps(path, raw.height, humidity, report)
    ozone = None if raw.ozone is None else _whole_ozone(raw.height, raw.ozone, notes.append, report)
    check_hydrostatics(path, raw, whole_humidity(raw.pressure, humidity))
    lowest = float(raw.height[0])
    if lowest > HIGHEST_FIRST_LEVEL:
        raise DataError(
            f"{path}: the lowest level lies at {lowest:.0f} m; it must lie within {HIGHEST_FIRST_LEVEL:g} m of the sea: add a level, "
            "or take a station at the coast"
        )
    height, pressure, kelvin, given = raw.height, raw.pressure, raw.temperature, raw.height.size
    # The air between the sea and the first level is continued with its temperature and humidity, hydrostatically.
    if lowest > 0.0:
        warm = float(virtual_temperature(kelvin[0], pressure[0], humidity[0]))
        height, pressure = np.append(0.0, height), np.append(float(pressure[0]) * math.exp(GRAVITY * lowest / (DRY_AIR * warm)), pressure)
        kelvin, humidity = np.append(kelvin[0], kelvin), np.append(humidity[0], humidity)
        ozone = None if ozone is None else np.append(ozone[0], ozone)
        if lowest > 2.0:
            notes.append(f"the lowest level, at {lowest:.0f} m, is continued to the sea with its temperature and humidity")
    top = float(height[np.isfinite(humidity)][-1])
    if top < height[-1]:
        notes.append(f"humidity ends at {1e-3 * top:.1f} km; the model atmosphere's goes on above")
    if height[-1] < LOW_TOP:
        notes.append(f"the sounding ends at {1e-3 * height[-1]:.1f} km; the model atmosphere goes on above")
    air = (height, pressure, kelvin, humidity)
    return Sounding(str(path), raw.kind, *air, tuple(notes), tuple(reported), digest, lowest, given, begins, ozone)


def _with_values(path: Path, raw: RawSounding, report: Callable[[str], None]) -> RawSounding:
    """Leave out the levels without pressure or temperature."""
    no_pressure, no_kelvin = ~np.isfinite(raw.pressure), ~np.isfinite(raw.temperature)
    unusable = no_pressure | no_kelvin
    usable = int(np.sum(~unusable & np.isfinite(raw.humidity_value)))
    if usable < 2:
        raise DataError(f"{path}: has {usable} levels with pressure, temperature and humidity; a sounding needs 2 at least")
    if unusable.any():
        reasons = [
            f"{int(np.sum(where))} {what}"
            for where, what in (
                (no_pressure & no_kelvin, "pressure and temperature"),
                (no_pressure & ~no_kelvin, "pressure"),
                (no_kelvin & ~no_pressure, "temperature"),
            )
            if where.any()
        ]
        report(f"{int(unusable.sum())} of {unusable.size} levels have missing values and are left out ({', '.join(reasons)} missing)")
    return raw.at(~unusable)


def _with_heights(path: Path, raw: RawSounding, humidity: FloatArray) -> tuple[RawSounding, int]:
    """Fill missing heights hydrostatically between those given."""
    known = np.isfinite(raw.height)
    if known.all():
        return raw, 0
    if not known.any():
        raise DataError(f"{path}: has no heights; give them for one level at least, in metres above the sea")
    warm = virtual_temperature(raw.temperature, raw.pressure, whole_humidity(raw.pressure, humidity))
    step = DRY_AIR / GRAVITY * 0.5 * (warm[1:] + warm[:-1]) * np.log(raw.pressure[:-1] / raw.pressure[1:])
    by_pressure = np.maximum.accumulate(np.concatenate([[0.0], np.cumsum(step)]))
    if not raw.geopotential:
        by_pressure = geometric_height(by_pressure)
    # The difference to the given heights is interpolated, so that the filled heights join them.
    offset = np.interp(by_pressure, by_pressure[known], (raw.height - by_pressure)[known])
    return replace(raw, height=np.where(known, raw.height, by_pressure + offset)), int((~known).sum())


def _without_gaps(path: Path, height: FloatArray, humidity: FloatArray, report: Callable[[str], None]) -> FloatArray:
    """Return relative humidity [%], linear in height between known levels and constant below the first; NaN above the last."""
    known = np.isfinite(humidity)
    if known.all():
        return humidity
    if not known.any():
        raise DataError(f"{path}: has no humidity from the sea to 100 km; give it at two levels at least")
    first, last = (int(i) for i in np.flatnonzero(known)[[0, -1]])
    gaps = int(np.sum(~known[first:last]))
    if gaps:
        report(f"{gaps} of {known.size} levels lack humidity between others; their relative humidity is interpolated in height")
    out = np.interp(height, height[known], humidity[known])
    out[last + 1 :] = np.nan
    return out


def _whole_ozone(height: FloatArray, ozone: FloatArray, note: Callable[[str], None], report: Callable[[str], None]) -> FloatArray | None:
    """Return ozone [1e-6 of the volume], linear in height between known levels and constant below the first; NaN above the last."""
    known = np.flatnonzero(np.isfinite(ozone))
    if not known.size:
        report("ozone is missing from the sea to 100 km; it is that of the model atmosphere")
        return None
    first, last = int(known[0]), int(known[-1])
    gaps = last + 1 - first - known.size
    if gaps:
        report(f"{gaps} of {ozone.size} levels lack ozone between others; it is interpolated in height")
    if first:
        note(f"ozone begins at {height[first]:.0f} m; below it is that of this level")
    top = float(height[last])
    # Most of the ozone lies around 22 km: a sounding that ends below has the smaller part of it, which is reported.
    (report if top < LOW_TOP else note)(f"ozone ends at {1e-3 * top:.1f} km; the model atmosphere's goes on above, joined to it over 5 km")
    out = np.interp(height, height[known], ozone[known])
    out[last + 1 :] = np.nan
    return out


def geometric_height(geopotential: FloatArray) -> FloatArray:
    """Return the height [m] of a geopotential height H [m]: ``R H / (R - H)``, R = 6356.766 km (US Standard Atmosphere 1976, Eq. 19).

    >>> round(float(geometric_height(np.array(10_000.0))), 1)
    10015.8
    """
    radius = 6_356_766.0
    return np.asarray(radius * geopotential / (radius - geopotential))


@dataclass(frozen=True)
class Continuation:
    """Part of the air outside the sounding."""

    height: float  #: Lower end of the part, or its upper end [m].
    share: float  #: Share of the precipitable water there [1].
    text: str  #: Sentence on the end of the sounding, with the share.
    below: bool = False  #: True for the part below that height.


def percent(share: float) -> str:
    """Return a share in per cent, with two figures.

    >>> percent(0.1432), percent(2e-5), percent(0.0)
    ('14 %', '0.002 %', '0 %')
    """
    return f"{float(f'{100.0 * share:.2g}'):.6g} %"


def continuations(sounding: Sounding, profile: AirProfile, model: str, sensor: float | None = None) -> tuple[Continuation, ...]:
    """Return the parts of a sounding's profile that a model atmosphere continues; those above 20 km without humidity of the sounding too.

    Parameters
    ----------
    sounding : Sounding
        The sounding.
    profile : AirProfile
        Its profile up to 100 km.
    model : str
        The model atmosphere.
    sensor : float, optional
        Height of a sensor [m]; a sounding that ends below it is noted at any height.
    """
    out = []
    whole, humid, top = profile.precipitable_water, sounding.humidity_top, sounding.top
    begins = sounding.humidity_begins
    if begins is not None:
        share = 1.0 - profile.water_above(begins) / whole
        text = f"humidity begins at {begins:.0f} m; below it is the relative humidity of that level, {percent(share)} of the water vapour"
        out.append(Continuation(begins, share, text, below=True))
    if humid < top:
        share = profile.water_above(humid) / whole
        text = f"humidity ends at {1e-3 * humid:.1f} km; above it is that of {model}, {percent(share)} of the water vapour"
        out.append(Continuation(humid, share, text))
    below = sensor is not None and sensor > top
    if top < LOW_TOP or below:
        share = profile.water_above(top) / whole
        where = f", below the sensor at {1e-3 * sensor:.1f} km" if below and sensor is not None else ""
        text = f"the sounding ends at {1e-3 * top:.1f} km{where}; above it is the air of {model}, {percent(share)} of the water vapour"
        out.append(Continuation(top, share, text))
    return tuple(out)
