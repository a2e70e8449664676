"""Soundings of the air as people have them: tables, lists of stations and archives, NetCDF of sondes and of ERA5."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from datetime import datetime
from pathlib import Path
from typing import Final

import numpy as np

from seaglint.air.profile.air_profile import AirProfile, sounding_profile
from seaglint.air.profile.humidity_above import continued_humidity
from seaglint.base.constants import GRAVITY
from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError
from seaglint.files.failures import storage_errors
from seaglint.files.netcdf import NETCDF_MAGIC
from seaglint.files.soundings.level_order import in_order, upwards
from seaglint.files.soundings.ozone_columns import with_ozone_in_ppmv
from seaglint.files.soundings.raw_sounding import RawSounding
from seaglint.files.soundings.sounding_checks import DRY_AIR, check_hydrostatics, virtual_temperature, whole_humidity
from seaglint.files.soundings.unit_suspicions import check_units

#: Largest height of the lowest level [m]; it is continued to the sea with its own temperature and humidity.
HIGHEST_FIRST_LEVEL: Final = 500.0

LOW_TOP: Final = 20e3  #: Height below which the end of a sounding is noted [m].

TOP_M: Final = 100e3  #: Heights above are left out [m].

MOST_LEVELS: Final = 2_000_000  #: Largest number of levels that a file may have.


@dataclass(frozen=True, eq=False)
class Sounding:
    """Sounding from the sea up, as understood."""

    #: ``path``, ``kind``: File and format.
    path: str
    kind: str
    #: ``height``, ``pressure``, ``temperature``: Ascending levels from the sea: [m], [hPa], [K]; (levels,).
    height: FloatArray
    pressure: FloatArray
    temperature: FloatArray
    #: Over water [%, (levels,)]; NaN above the highest level that has one, where a model atmosphere continues it.
    relative_humidity: FloatArray
    notes: tuple[str, ...]  #: What was chosen, left out, turned, filled or continued, a sentence each.
    reported: tuple[str, ...]  #: Those of the notes that a user of the result needs to see.
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
        """Relative humidity over water [%, (levels,)], continued by a model atmosphere above the highest level that has one."""
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


PLACE_OF_SCENARIO: Final = "give [place] latitude_deg and longitude_deg"  #: Remedy for a file of many places in a scenario.


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
        In one line: what cannot be used, and what is suspected.
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
    """Rows of the file by the reader of its layout, which its content shows."""
    if content.startswith(NETCDF_MAGIC) or path.suffix.lower() in (".nc", ".nc4", ".cdf"):
        from seaglint.files.soundings.era5_levels import read_netcdf_sounding

        return read_netcdf_sounding(path, place, time, remedy)
    from seaglint.files.soundings import sounding_lists, station_lists
    from seaglint.files.soundings.sounding_table import read_sounding_table

    text = sounding_text(path, content)
    lines = text.splitlines()
    if sounding_lists.is_igra(lines):
        return sounding_lists.read_igra(path, lines, time)
    if sounding_lists.is_wyoming_list(lines):
        return sounding_lists.read_wyoming_list(path, lines, time)
    if station_lists.is_sharppy(lines):
        return station_lists.read_sharppy(path, lines, time)
    if station_lists.is_bufkit(lines):
        return station_lists.read_bufkit(path, lines, place, time)
    if station_lists.is_avaps_record(lines):
        return station_lists.read_avaps_record(path, lines)
    if station_lists.is_iem_json(text):
        return station_lists.read_iem_json(path, text, time)
    return read_sounding_table(path, text)


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
        controls = sum(content[:4096].count(bytes([code])) for code in (*range(9), *range(14, 32)))
        if controls:
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
    check_units(path, raw)
    raw = with_ozone_in_ppmv(path, raw)
    raw, turned = upwards(path, raw)
    if turned:
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
        raw, humidity = raw.kept(inside), humidity[inside]
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
    if lowest > 0.0:
        warm = float(virtual_temperature(kelvin[0], pressure[0], humidity[0]))
        at_sea = float(pressure[0]) * math.exp(GRAVITY * lowest / (DRY_AIR * warm))
        height, pressure = np.append(0.0, height), np.append(at_sea, pressure)
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
    """Leave out the levels without pressure or temperature, which hold nothing of the air."""
    no_pressure, no_kelvin = ~np.isfinite(raw.pressure), ~np.isfinite(raw.temperature)
    left = no_pressure | no_kelvin
    usable = int(np.sum(~left & np.isfinite(raw.humidity_value)))
    if usable < 2:
        raise DataError(f"{path}: has {usable} levels with pressure, temperature and humidity; a sounding needs 2 at least")
    if left.any():
        reasons = [
            f"{int(np.sum(where))} {what}"
            for where, what in (
                (no_pressure & no_kelvin, "pressure and temperature"),
                (no_pressure & ~no_kelvin, "pressure"),
                (no_kelvin & ~no_pressure, "temperature"),
            )
            if where.any()
        ]
        report(f"{int(left.sum())} of {left.size} levels have missing values and are left out ({', '.join(reasons)} missing)")
    return raw.kept(~left)


def _with_heights(path: Path, raw: RawSounding, humidity: FloatArray) -> tuple[RawSounding, int]:
    """Fill missing heights hydrostatically between those given."""
    known = np.isfinite(raw.height)
    if known.all():
        return raw, 0
    if not known.any():
        raise DataError(f"{path}: has no heights; give them for one level at least, in metres above the sea")
    warm = virtual_temperature(raw.temperature, raw.pressure, whole_humidity(raw.pressure, humidity))
    step = DRY_AIR / GRAVITY * 0.5 * (warm[1:] + warm[:-1]) * np.log(raw.pressure[:-1] / raw.pressure[1:])
    own = np.maximum.accumulate(np.concatenate([[0.0], np.cumsum(step)]))
    if not raw.geopotential:
        own = geometric_height(own)
    offset = np.interp(own, own[known], (raw.height - own)[known])
    return replace(raw, height=np.where(known, raw.height, own + offset)), int((~known).sum())


def _without_gaps(path: Path, height: FloatArray, humidity: FloatArray, report: Callable[[str], None]) -> FloatArray:
    """Relative humidity [%], linear in height between known levels and constant below the first; NaN above the last."""
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
    """Ozone [1e-6 of the volume], linear in height between known levels and constant below the first; NaN above the last."""
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
    # most of the ozone lies around 22 km: a sounding that ends below gives the smaller part of it
    (report if top < LOW_TOP else note)(f"ozone ends at {1e-3 * top:.1f} km; the model atmosphere's goes on above, joined to it over 5 km")
    out = np.interp(height, height[known], ozone[known])
    out[last + 1 :] = np.nan
    return out


def geometric_height(geopotential: FloatArray) -> FloatArray:
    """Height [m] of a geopotential height H [m]: ``R H / (R - H)``, R = 6356.766 km (US Standard Atmosphere 1976, Eq. 19).

    >>> round(float(geometric_height(np.array(10_000.0))), 1)
    10015.8
    """
    radius = 6_356_766.0
    return np.asarray(radius * geopotential / (radius - geopotential))
